#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna precursors --driver`: columns and files, what is said of them, and how wrong ones are refused.

usage: test_driver.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import datetime
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE = "", ""
DAYS, MEMORY = 100, 5
START = datetime.datetime(2024, 1, 1)


def rain():
    """Of each day [mm], five times as much in the last third."""
    draw = random.Random(3)
    return [draw.expovariate(0.1) * (5 if 3 * i > 2 * DAYS else 1) if draw.random() < 0.3 else 0 for i in range(DAYS)]


def displacement(fell):
    """Of a slope that creeps by 1 mm/day and 0.3 for each mm/day that a reservoir holds, before and after each day."""
    stays, level, way = math.exp(-1 / MEMORY), 0.0, [0.0]
    for amount in fell:
        held = amount + (level - amount) * MEMORY * (1 - stays)
        level = stays * level + (1 - stays) * amount
        way.append(way[-1] + 1 + 0.3 * held)
    return way


class Driver(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-driver-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.fell = rain()
        cls.way = displacement(cls.fell)
        noise = random.Random(4)
        lines = ["time,d,rain,mm/d,level"]
        for i, d in enumerate(cls.way):
            day = (START + datetime.timedelta(days=i)).isoformat()
            fell = cls.fell[i - 1] if i > 0 else 0
            lines.append(f"{day},{d + noise.gauss(0, 0.02):.3f},{fell:.2f},{fell:.2f},7")
        cls.write("slope.csv", "\n".join(lines))
        # a gauge by the date of the day, which begins then
        cls.write("gauge.csv", "date,rain_mm\n" + "\n".join(
            f"{(START + datetime.timedelta(days=i)).date()},{x:.2f}" for i, x in enumerate(cls.fell)))

    @classmethod
    def write(cls, name, text):
        with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as out:
            out.write(text)

    def call(self, *words, status=0, name="slope.csv"):
        done = subprocess.run([PROGRAM, "precursors", name, "--displacement", "d:mm", *words], text=True,
                              capture_output=True, cwd=self.folder, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def ask(self, *words, name="slope.csv"):
        return json.loads(self.call(*words, "--json", name=name).stdout)

    def test_a_column_and_a_file_say_the_same(self):
        column = self.ask("--driver", "rain:mm:sum")["drivers"]
        file = self.ask("--driver", "gauge.csv/rain_mm:mm:sum")["drivers"]
        for said in column + file:
            self.assertEqual(said["verdict"], "explains")
            self.assertEqual(said["response"], "memory")
            self.assertLess(said["p"], 0.02)
            self.assertGreater(said["share"], 0.9)
            self.assertAlmostEqual(said["response_time_s"] / 86400 / MEMORY, 1, delta=0.15)
            # 0.3 of the reservoir's mm/day: of mm/s as the gauge's amounts are
            self.assertAlmostEqual(said["rate_per_response"], 0.3e-3, delta=0.03e-3)
            self.assertEqual(said["what_remains"], "does not accelerate")
            self.assertTrue(said["withholds"])
        for key in ("p", "share", "response_time_s"):
            self.assertAlmostEqual(column[0][key], file[0][key], delta=1e-3 * abs(file[0][key]))
        self.assertEqual((column[0]["driver"], file[0]["driver"], file[0]["unit"]), ("rain", "rain_mm", "mm"))

    def test_words_and_withheld_forecasts(self):
        since = ["--since", "2024-01-01"]
        told = self.call("--driver", "rain:mm:sum", *since).stdout
        self.assertRegex(told, r"\n  rain: explains (9\d|100) % of the rate \(p 0\.0\d+\), memory [45]\.\d day; "
                               r"what remains does not accelerate\n")
        without, answer = self.ask(*since), self.ask("--driver", "rain:mm:sum", *since)
        self.assertEqual(without["drivers"], [])
        issued = 0
        for f, g in zip(without["forecasts"], answer["forecasts"]):
            self.assertEqual(f["tc_s"], g["tc_s"])
            self.assertEqual(f["interval90_s"], g["interval90_s"])
            if f["issued"] and f["method"] != "persistence":
                issued += 1
                self.assertFalse(g["issued"])
                self.assertRegex(g["reason"], r"^withheld: rain explains (9\d|100) % of the rate \(p 0\.\d+\), and what remains")
            else:
                self.assertEqual((f["issued"], f["reason"]), (g["issued"], g["reason"]))
        self.assertGreater(issued, 0)

    def test_rolling_forecasts_see_the_driver_of_their_time(self):
        rolled = self.ask("--driver", "rain:mm:sum", "--rolling", "--issues", "6", "--since", "2024-01-01")
        then = rolled["rolling"]["issues"][3]
        until = datetime.datetime.fromtimestamp(then["issue_time_s"], datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M")
        alone = self.ask("--driver", "rain:mm:sum", "--until", until, "--since", "2024-01-01")
        self.assertEqual(then["forecasts"], alone["forecasts"])

    def test_the_file_has_the_driver_on_the_readings_times(self):
        self.call("--driver", "gauge.csv/rain_mm:mm:sum", "--driver", "level:m", "-o", "out.nc", "--force")
        with netCDF4.Dataset(os.path.join(self.folder, "out.nc")) as data:
            value = data["driver_rain_mm"]
            self.assertEqual((value.dimensions, value.units), (("reading",), "(mm) s-1"))
            self.assertTrue(numpy.ma.getmaskarray(value[:])[0])
            self.assertTrue(numpy.allclose(value[1:] * 86400, numpy.round(self.fell, 2), atol=1e-9))
            self.assertEqual((value.explains_the_rate, value.response, value.what_remains),
                             ("explains", "memory", "does not accelerate"))
            self.assertLess(value.p, 0.02)
            part = data["driver_rain_mm_rate"][1:] * 86400e3
            self.assertEqual(data["driver_rain_mm_rate"].units, "m s-1")
            rate = numpy.diff(self.way) - 1
            self.assertLess(numpy.sqrt(numpy.mean((part - rate) ** 2)), 0.15 * rate.std())
            self.assertEqual(data["driver_level"].explains_the_rate, "cannot tell")
            self.assertEqual(data["driver_level"].reason, "level is constant")
            self.assertNotIn("driver_level_rate", data.variables)

    def test_what_cannot_be_told(self):
        early = [f"{(START + datetime.timedelta(days=i)).date()},{x}" for i, x in enumerate(self.fell[:60])]
        self.write("short.csv", "date,rain_mm\n" + "\n".join(early))
        gaps = [f"{(START + datetime.timedelta(days=i)).date()},{'NA' if i % 3 else 5 + i}" for i in range(DAYS)]
        self.write("gaps.csv", "date,rain_mm\n" + "\n".join(gaps))
        for words, says in (("short.csv/rain_mm:mm:sum", "rain_mm ends before the readings"),
                            ("gaps.csv/rain_mm:mm", "too many gaps: rain_mm is known over"),
                            ("level:m", "level is constant")):
            said = self.call("--driver", words).stdout
            self.assertIn(f": cannot tell: {says}", said)
            driver = self.ask("--driver", words)["drivers"][0]
            self.assertEqual((driver["verdict"], driver["p"], driver["withholds"]), ("cannot tell", None, False))
        few = self.call("--driver", "rain:mm:sum", "--until", "2024-01-10").stdout
        self.assertIn("rain: cannot tell: too few readings: 9 intervals", few)

    def test_amounts_at_uneven_times_are_asked_about(self):
        rows = [f"{(START + datetime.timedelta(days=i)).date()},{x:.2f}" for i, x in enumerate(self.fell) if x > 0 or i % 2]
        self.write("uneven.csv", "date,rain_mm\n" + "\n".join(rows))
        warned = self.call("--driver", "uneven.csv/rain_mm:mm").stderr
        self.assertIn('warning: --driver: "uneven.csv/rain_mm:mm": taken as means since the value before', warned)
        for words in (["uneven.csv/rain_mm:mm:sum"], ["gauge.csv/rain_mm:mm"], ["uneven.csv/rain_mm:mm", "-q"]):
            self.assertEqual(self.call("--driver", *words).stderr, "")
        said = self.ask("--driver", "uneven.csv/rain_mm:mm:sum")["drivers"][0]
        self.assertEqual((said["verdict"], said["response"]), ("explains", "memory"))

    def test_names_may_have_slashes(self):
        said = self.ask("--driver", "slope.csv/mm/d:mm/day")["drivers"][0]
        self.assertEqual((said["driver"], said["unit"], said["verdict"]), ("mm/d", "mm/day", "explains"))

    def test_wrong_words_are_one_line(self):
        self.write("elsewhere.csv", "date,rain_mm\n2020-01-01,3\n2020-01-02,4\n")
        self.write("seconds.csv", "t,rain_mm\n" + "".join(f"{i * 86400},{i}\n" for i in range(30)))
        self.write("word.csv", "date,rain_mm\n2024-01-01,3\n2024-01-02,wet\n")
        must = " must be COLUMN:UNIT or FILE/COLUMN:UNIT, for amounts with \":sum\" behind it, such as " \
               "\"lake_m:m\" or \"rain.csv/rain_mm:mm:sum\""
        for words, says in (
                (["rain"], '--driver: "rain"' + must),
                (["rain:"], '--driver: "rain:"' + must),
                ([":mm"], '--driver: ":mm"' + must),
                (["rain:sum"], '--driver: "rain:sum"' + must),
                (["gauge.csv/:mm"], '--driver: "gauge.csv/:mm"' + must),
                (["snow:mm"], 'slope.csv:1: has no column "snow"; its columns are time, d, rain, mm/d, level'),
                (["gauge.csv/snow:mm"], 'gauge.csv:1: has no column "snow"; its columns are date, rain_mm'),
                (["rain:millimetre of rain"], "slope.csv: rain: unit"),
                (["word.csv/rain_mm:mm"], 'word.csv:3: rain_mm: "wet" must be a number'),
                (["elsewhere.csv/rain_mm:mm"], '--driver: "elsewhere.csv/rain_mm:mm": its times, 2020-01-01 00:00 to '
                 "2020-01-02 00:00, have none in common with the readings', 2024-01-01 00:00 to 2024-04-10 00:00"),
                (["seconds.csv/rain_mm:mm"], '--driver: "seconds.csv/rain_mm:mm": its times are no dates, those of '
                 "slope.csv are dates"),
                (["rain:mm", "--driver", "slope.csv/rain:mm"],
                 '--driver: "slope.csv/rain:mm" is the second driver named rain: rename a column'),
                (["rain:mm"] + ["--driver", "rain:mm"] * 8, "--driver: 9 drivers, at most 8")):
            done = self.call("-q", "--driver", *words, status=2)
            self.assertTrue(done.stderr.startswith("lacuna: " + says), done.stderr)
            self.assertEqual((done.stderr.count("\n"), done.stdout), (1, ""))
        done = self.call("--driver", "none.csv/rain:mm", status=3)
        self.assertEqual(done.stderr, "lacuna: --driver: none.csv: No such file or directory\n")

    def test_a_run_knows_its_loads(self):
        subprocess.run([PROGRAM, "run", os.path.join(SOURCE, "cases/block.yaml"), "-q", "-o", "block.nc"], check=True,
                       cwd=self.folder, capture_output=True)
        done = subprocess.run([PROGRAM, "precursors", "block.nc", "--driver", "gauge.csv/rain_mm:mm"], text=True,
                              capture_output=True, cwd=self.folder, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--driver: is of monitoring files: block.nc is a run", done.stderr)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
