#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of readings as loggers, total stations and GNSS write them: each is read by one line.

A file of tests/case/series has beside it NAME.txt: the options, what is to be found in it, and what is said of it.

usage: test_readings.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4

PROGRAM, SOURCE = "", ""


class Readings(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-readings-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.series = os.path.join(SOURCE, "tests/case/series")

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as out:
            out.write(text)

    def call(self, *words, status=0, folder=None, **more):
        done = subprocess.run([PROGRAM, *words], text=True, capture_output=True, cwd=folder or self.folder, check=False,
                              **more)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def prisms(self):
        """Two prisms that move alike but for a factor, and one that was lost."""
        rows = [f"2020-01-{day:02d},{3 * day + 0.1 * day ** 2:.2f},{6 * day + 0.2 * day ** 2:.2f}," for day in range(1, 26)]
        self.write("prisms.csv", "\n".join(["t,P1 [mm],P2 [mm],P3 [mm]", *rows]) + "\n")
        return ["precursors", "prisms.csv", "--displacement", "P1", "--displacement", "P3", "--displacement", "P2"]

    def test_each_is_read_by_one_line(self):
        names = sorted(name[:-4] for name in os.listdir(self.series) if name.endswith(".csv"))
        self.assertGreaterEqual(len(names), 25)
        for name in names:
            with open(os.path.join(self.series, name + ".txt"), encoding="utf-8") as file:
                options, found, *said = file.read().rstrip("\n").split("\n")
            path = os.path.join(self.folder, name + ".nc")
            done = self.call("precursors", name + ".csv", *shlex.split(options), "--raw", "--json", "-o", path, folder=self.series)
            series = json.loads(done.stdout)["series"]
            with netCDF4.Dataset(path) as data:
                moved = 1000 * (data["displacement"][-1] - data["displacement"][0])
            first, last = (series.get(f"{end}_date") or f"{series[f'{end}_s']:g}" for end in ("first", "last"))
            self.assertEqual(f"{series['readings']} readings from {first} to {last}, moved {moved:.6g} mm", found, name)
            self.assertEqual(series["warnings"], said, name)
            self.assertEqual(done.stderr, "".join(f"lacuna: warning: {name}.csv: {one}\n" for one in said))

    def test_a_column_a_station(self):
        words = self.prisms()
        done = self.call(*words, status=2)
        self.assertEqual([line for line in done.stdout.splitlines() if line.startswith("station")],
                         ["station P1", "station P3", "station P2"])
        self.assertEqual(done.stderr, "lacuna: prisms.csv: P3: every reading is missing\nlacuna: 1 of 3 columns have no answer\n")
        stations = json.loads(self.call(*words, "--json", status=2).stdout)["stations"]
        self.assertEqual([one["station"] for one in stations], ["P1", "P3", "P2"])
        self.assertEqual(stations[1], {"station": "P3", "error": "prisms.csv: P3: every reading is missing"})
        for k, name in ((0, "P1"), (2, "P2")):  # each as if it were alone
            alone = json.loads(self.call("precursors", "prisms.csv", "--displacement", name, "--json").stdout)
            self.assertEqual({**alone, "station": name}, stations[k])

    def test_several_columns_are_refused_elsewhere(self):
        words = self.prisms()
        for more, says in ((["-o", "x.nc"], "-o: a file holds one column of displacements, and 3 were named"),
                           (["--velocity", "P1:mm/day"], "--velocity: goes with one column")):
            self.assertIn(says, self.call(*words, *more, status=2).stderr)
        with open(os.path.join(self.folder, "prisms.csv"), encoding="utf-8") as file:
            done = self.call("precursors", "/dev/stdin", *words[2:], status=2, input=file.read())
        self.assertIn("/dev/stdin: is no file, and each of 3 columns reads it anew", done.stderr)
        self.assertIn("--displacement: fit takes one column, and 2 were named",
                      self.call("fit", "a.yaml", "b.csv", *words[4:], status=2).stderr)

    def test_a_pipe_loses_nothing(self):
        self.prisms()
        words = ["--displacement", "P1", "--json"]
        with open(os.path.join(self.folder, "prisms.csv"), encoding="utf-8") as file:
            piped = json.loads(self.call("precursors", "/dev/stdin", *words, input=file.read()).stdout)
        read = json.loads(self.call("precursors", "prisms.csv", *words).stdout)
        piped["series"]["path"] = "prisms.csv"
        self.assertEqual(piped, read)

    def test_answers_are_in_the_unit_of_the_file(self):
        self.write("days.csv", "day,d\n" + "".join(f"{i},{1000 / (70 - i):.2f}\n" for i in range(60)))
        said = self.call("precursors", "days.csv", "--time-format", "day", "--displacement", "d:mm").stdout
        self.assertRegex(said, r"(?m)^  readings +60 from 0 day to 59 day$")
        self.assertRegex(said, r"(?m)^  voight +[67]\d\.\d+ day ")
        self.assertNotIn("year", said)

    def test_the_direction_of_later_readings_is_not_used(self):
        rows = [(day, 2 * day, 0.5 * day if day < 20 else 10 + 9 * (day - 20)) for day in range(40)]
        for name, most in (("all.csv", 40), ("early.csv", 20)):
            self.write(name, "day,e,n\n" + "".join("%d,%.3f,%.3f\n" % row for row in rows[:most]))
        words = ["--time-format", "day", "--components", "e:mm,n:mm"]
        cut = self.call("precursors", "all.csv", *words, "--until", "19 day", "-o", "all.nc")
        self.assertIn("direction of motion, 0.970,0.243: 100 %", cut.stderr)
        self.call("precursors", "early.csv", *words, "-o", "early.nc")
        with netCDF4.Dataset(os.path.join(self.folder, "all.nc")) as one, \
                netCDF4.Dataset(os.path.join(self.folder, "early.nc")) as other:
            self.assertEqual(list(one["displacement"][:]), list(other["displacement"][:]))
        refused = self.call("precursors", "all.csv", *words, "--rolling", status=2).stderr
        self.assertIn('--rolling: the main direction of motion is that of all readings', refused)
        sight = refused.split('"')[1]
        self.call("precursors", "all.csv", *words, "--rolling", "--line-of-sight", sight)

    def test_words_that_make_no_sense(self):
        self.prisms()
        for words, says in ((["--skip", "x"], '--skip: "x" must be a number of lines'),
                            (["--skip", "-1"], '--skip: "-1" must be a number of lines'),
                            (["--components", "P1,P2"], "name the one or the other"),
                            (["--line-of-sight", "1,2,3"], "a line of sight goes with components")):
            done = self.call("precursors", "prisms.csv", "--displacement", "P1", *words, status=2)
            self.assertIn(says, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)

    def test_a_fit_reads_them_too(self):
        """Titles, a unit in brackets and components; what was named stands in the case beside the fit."""
        with open(os.path.join(SOURCE, "cases/data/creep.csv"), encoding="utf-8") as file:
            rows = [line.rstrip("\n").split(",") for line in file if line[0] == "2"]
        self.write("creep.csv", "Prism 4\n\nday,e [mm],n [mm]\n" + "".join(f"{t},{0.6 * float(d)},{0.8 * float(d)}\n" for t, d in rows))
        case = os.path.join(SOURCE, "cases/fit/block.yaml")
        with open(case, encoding="utf-8") as file:
            text = file.read()
        self.assertIn('\n  displacement: "disp_mm:mm"\n', text)
        with open(os.path.join(self.folder, "c.yaml"), "w", encoding="utf-8") as out:
            out.write(text.replace('\n  displacement: "disp_mm:mm"\n', "\n").split("compare:")[0])
        words = ["c.yaml", "creep.csv", "--set", "fit.steps=0", "--time", "day", "--skip", "2", "--components", "e,n",
                 "--line-of-sight", "0.6,0.8", "--json"]
        ours = json.loads(self.call("fit", *words).stdout)
        theirs = json.loads(self.call("fit", case, os.path.join(SOURCE, "cases/data/creep.csv"), "--set", "fit.steps=0", "--json").stdout)
        for one, other in zip(ours["parameters"], theirs["parameters"]):
            self.assertAlmostEqual(one["best"] / other["best"], 1, places=3)
        with open(os.path.join(self.folder, "c-fit.yaml"), encoding="utf-8") as file:
            made = file.read()
        for line in ("skip: 2", "line_of_sight: "):
            self.assertIn(line, made)


if __name__ == "__main__":
    PROGRAM, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
