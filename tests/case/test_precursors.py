#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna precursors`: what it says of series and runs, and how it refuses wrong ones.

usage: test_precursors.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import datetime
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE = "", ""
METHODS = ["inv8", "inv", "slo", "saito", "log", "voight", "block", "lppls", "persistence"]
LOG_LAW = ["t,d"] + [f"{day},{-0.3 * math.log(1 - day / 40):.6f}" for day in range(36)]


def seconds(text):
    at = datetime.datetime.fromisoformat(text).replace(tzinfo=datetime.timezone.utc)
    return at.timestamp()


def b_value(size, least):
    """b of the sizes from `least` on, its error, and how many they are."""
    above = size[size >= least - 1e-9] - least
    if len(above) < 2:
        return math.nan, math.nan, len(above)
    b = math.log10(math.e) / above.mean()
    return b, math.log(10) * b ** 2 * above.std(ddof=1) / math.sqrt(len(above)), len(above)


def complete_from(size):
    """The fullest bin of 0.1 and 0.2, and on until b is stable over the next half magnitude."""
    lowest = 0.1 * math.floor(size.min() / 0.1)
    first = lowest + 0.1 * numpy.argmax(numpy.bincount(((size - lowest) / 0.1).astype(int))) + 0.2
    for k in range(20):
        found = [b_value(size, first + 0.1 * k + 0.1 * j) for j in range(5)]
        if found[-1][2] >= 50 and abs(numpy.mean([b for b, _, _ in found]) - found[0][0]) <= found[0][1]:
            return first + 0.1 * k
    return first


class Precursors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-precursors-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.write("log.csv", "\n".join(LOG_LAW))

    @classmethod
    def write(cls, name, text):
        with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as out:
            out.write(text)

    def call(self, *words, status=0, folder=None):
        done = subprocess.run([PROGRAM, "precursors", *words], text=True, capture_output=True,
                              cwd=folder or self.folder, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def ask(self, *words):
        return json.loads(self.call(*words, "--json").stdout)

    def of(self, answer, method):
        return next(f for f in answer["forecasts"] if f["method"] == method)

    def test_wrong_series_name_their_line(self):
        folder = os.path.join(SOURCE, "tests/case/wrong_series")
        names = sorted(name for name in os.listdir(folder) if name.endswith(".csv"))
        self.assertGreaterEqual(len(names), 40)
        for name in names:
            with open(os.path.join(folder, name[:-3] + "txt"), encoding="utf-8") as file:
                options, says = file.read().rstrip("\n").split("\n")
            done = self.call(name, *shlex.split(options), status=2, folder=folder)
            self.assertEqual(done.stderr, f"lacuna: {says}\n", name)
            self.assertRegex(done.stderr, rf"^lacuna: {name}:\d+: ")
            self.assertEqual(done.stdout, "")

    def test_few_readings_print_no_nan(self):
        self.write("one.csv", "t,d\n1,1\n")
        self.write("weak.csv", "t,d\n" + "".join(f"{i},{i**3}e-310\n" for i in range(1, 51)))  # all power underflows
        for name in ("one.csv", "weak.csv"):
            said = self.call(name, "--displacement", "d:m", "--time-format", "day", "-o", name + ".nc").stdout
            self.assertNotRegex(said, r"\bnan\b")
        with netCDF4.Dataset(os.path.join(self.folder, "one.csv.nc")) as data:
            self.assertEqual(data["velocity"].shape, (0,))

    def test_wrong_options(self):
        with open(os.path.join(self.folder, "damaged.nc"), "wb") as file:
            file.write(b"\x89HDF\r\n\x1a\n" + bytes(90))
        self.write("units.csv", "t,b,way [mm],rain [mm]\n1,2,3,4\n")
        data = ["log.csv", "--displacement", "d:m", "--time-format", "day"]
        for words, says in (
                (["log.csv"], "which column is what? --displacement COLUMN:UNIT and/or --velocity COLUMN:UNIT; its columns are t, d"),
                (["units.csv"], r'its columns are t, b, way [mm], rain [mm]; perhaps --displacement "way [mm]"'),
                (["none.csv", "--displacement", "d:m"], "none.csv: No such file"),
                (["none.nc"], "none.nc: No such file"),
                (["damaged.nc"], "damaged.nc: is damaged"),
                (["log.csv", "--displacement", "d:kg"], 'd: unit "kg"'),
                (["log.csv", "--displacement", ":mm"], '--displacement: ":mm" must be COLUMN:UNIT'),
                (["log.csv", "--velocity", "d:m/s", "--sigma", "t:mm"], "--sigma: is of displacements"),
                (data + ["--time-format", "%d/%q"], 'time format "%d/%q" must have each'),
                (data + ["--time-format", "%H:%M"], "must have a year, a month and a day"),
                (data + ["--time-format", "kg"], 'time format "kg" must be iso, unix, excel'),
                (data + ["--smooth", "average"], '--smooth: "average" must be none'),
                (data + ["--smooth", "average:1"], "a moving average must be of 2 or more"),
                (data + ["--smooth", "savgol:3,3"], "a Savitzky-Golay filter must have"),
                (data + ["--smooth", "window:3 kg"], '--smooth: "window:3 kg"'),
                (data + ["--since", "2015-01-01"], '--since: "2015-01-01"'),
                (data + ["--onset", "7,3"], '--onset: "7,3" must be two numbers'),
                (data + ["--issues", "0"], '--issues: "0" must be a number from 1'),
                (data + ["--horizon", "-1 day"], '--horizon: "-1 day" must be a time >= 600 s'),
                (data + ["--rolling", "--failed-at", "-3 day"], "must be later than the first reading"),
                (data + ["--until", "-1 day"], "log.csv: has no reading until -1 day")):
            status = 3 if words[0] in ("none.csv", "none.nc", "damaged.nc") else 2
            done = self.call(*words, status=status)
            self.assertIn(says, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_output_is_looked_at_first(self):
        """Nothing that is read is overwritten, and nothing is computed for a file that is there."""
        data = ["log.csv", "--displacement", "d:m", "--time-format", "day"]
        with open(os.path.join(self.folder, "log.csv"), encoding="utf-8") as file:
            before = file.read()
        for words, says in ((["-o", "./log.csv", "--force"], "./log.csv: is read by this command"),
                            (["-o", "log.csv"], "log.csv: is read by this command"),
                            (["-o", "there.nc"], "there.nc: exists already; --force replaces it")):
            self.write("there.nc", "mine")
            done = self.call(*data, *words, status=2)
            self.assertIn(says, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        with open(os.path.join(self.folder, "log.csv"), encoding="utf-8") as file:
            self.assertEqual(file.read(), before)

    def block(self, *words):
        """The made-up block of cases/fit and its readings."""
        return (os.path.join(SOURCE, "cases/data/creep.csv"), "--case",
                os.path.join(SOURCE, "cases/fit/block.yaml"), "--onset", "5,20", *words)

    def fitted(self, *words, case=None):
        done = subprocess.run([PROGRAM, "fit", case or os.path.join(SOURCE, "cases/fit/block.yaml"),
                               os.path.join(SOURCE, "cases/data/creep.csv"), "-o", "fit.nc", "--force",
                               "--json", *words], text=True, capture_output=True, cwd=self.folder, check=True)
        return json.loads(done.stdout)

    def test_a_case_forecasts(self):
        answer = self.ask(*self.block("--set", "fit.steps=0", "-o", "case.nc"))
        self.assertEqual([f["method"] for f in answer["forecasts"]],
                         METHODS[:-1] + ["case", "persistence"])
        found, fit = self.of(answer, "case"), self.fitted("--set", "fit.steps=0")
        start = seconds("2020-05-01T09:00")
        self.assertTrue(found["issued"], found["reason"])
        self.assertAlmostEqual(found["tc_raw_s"], start + fit["best_failure_time_s"], delta=1.0)
        self.assertAlmostEqual(found["relative_error"] * (found["tc_raw_s"] - answer["issue_time_s"]),
                               fit["best_failure_error_s"], delta=1.0)
        low, high = found["interval90_s"]
        self.assertTrue(low < seconds("2020-08-12") < high)  # when it did fail
        self.assertEqual(found["points"], answer["series"]["readings"])
        with netCDF4.Dataset(os.path.join(self.folder, "case.nc")) as data:
            self.assertIn("case", data["method"].flag_meanings.split())
            self.assertIn('dc: "0.05 m"', data.case)  # the case as it was given, defaults filled in
            self.assertEqual(data.seed, 1)

    def test_a_case_that_fits_badly_says_so(self):
        _, *rest = self.block("--set", "fit.steps=0")
        with open(os.path.join(SOURCE, "cases/data/creep.csv"), encoding="utf-8") as data:
            lines = data.read().split("\n")
        waves = iter(range(len(lines)))  # 6 mm, every 44 readings
        self.write("waves.csv", "\n".join(
            re.sub(r"-?[\d.]+$", lambda x: f"{float(x[0]) + 6 * math.sin(next(waves) / 7):.2f}", line)
            if line[:2] == "20" else line for line in lines))
        for data, badly in (("waves.csv", True), (os.path.join(SOURCE, "cases/data/creep.csv"), False)):
            self.assertIs(self.of(self.ask(data, *rest), "case")["fits_badly"], badly)
            self.assertEqual("  case         fits badly: " in self.call(data, *rest).stdout, badly)

    def test_a_case_says_how_its_times_are_written(self):
        with open(os.path.join(SOURCE, "cases/data/creep.csv"), encoding="utf-8") as data:
            self.write("days.csv", re.sub(r"(?m)^(\d+)-(\d+)-(\d+)T", r"\3.\2.\1 ", data.read()))
        wanted, data = self.ask(*self.block("--set", "fit.steps=0")), "days.csv"
        _, *rest = self.block("--set", "fit.steps=0", "--set", "fit.time_format='%d.%m.%Y %H:%M'")
        self.assertEqual(self.ask(data, *rest)["forecasts"], wanted["forecasts"])

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_a_case_forecasts_by_its_draws(self):
        with open(os.path.join(SOURCE, "cases/fit/block.yaml"), encoding="utf-8") as case:
            lines = [line for line in case.read().split("\n")
                     if "range: [0.3" not in line and "../data" not in line and "compare" not in line]
        self.write("two.yaml", "\n".join(lines))
        words = ("--set", "fit.steps=200", "--set", "fit.burn=100", "--set", "initial.state.ratio_to_steady=0.6")
        data, _, _, *rest = self.block(*words)
        found = self.of(self.ask(data, "--case", "two.yaml", *rest), "case")
        fit = self.fitted(*words, case="two.yaml")
        self.assertIsNotNone(found["posterior_s"], found["reason"])
        start = seconds("2020-05-01T09:00")
        told = fit["interval90_s"] + fit["interval50_s"] + [fit["tc_s"]]
        for drawn, of_fit in zip(found["posterior_s"], sorted(told)):
            self.assertAlmostEqual(drawn, start + of_fit, delta=1.0)
        self.assertTrue(found["interval90_s"][0] < seconds("2020-08-12") < found["interval90_s"][1])

    def test_a_case_that_cannot_forecast_says_why(self):
        for words, says, badly in (
                (["--set", "time.end=60 day"], "the best fit does not fail by time.end", False),
                (["--set", "time.start=2020-06-17"], "too few readings between time.start and time.end", None)):
            data, *rest = self.block("--set", "fit.steps=0", *words)
            found = self.of(self.ask(data, *rest), "case")
            self.assertIn(says, found["reason"])
            self.assertIs(found.get("fits_badly"), badly)  # which nobody knows without a fit
        data = ["log.csv", "--displacement", "d:m", "--time-format", "day"]
        case = os.path.join(SOURCE, "cases/fit/block.yaml")
        for words, says in (
                (data + ["--set", "fit.steps=0"], "--set: overrides a case: --case names one"),
                (data + ["--case", os.path.join(SOURCE, "cases/block.yaml")], "fit"),
                (data + ["--case", case, "--set", "fit.walkers=1"], "fit.walkers"),
                (list(self.block("--set", "time.start=0")), "so time.start of")):
            self.assertIn(says, self.call(*words, status=2).stderr)

    def test_a_log_law(self):
        answer = self.ask("log.csv", "--displacement", "d:m", "--time-format", "day", "--rolling",
                          "--failed-at", "40 day", "-o", "log.nc")
        self.assertEqual([f["method"] for f in answer["forecasts"]], METHODS)
        for method in ("saito", "log", "voight", "block"):
            f = self.of(answer, method)
            self.assertTrue(f["issued"], f["reason"])
            self.assertAlmostEqual(f["tc_raw_s"] / 86400, 40, delta=0.3)
            low, high = f["interval90_s"]
            told = [35 * 86400, low, f["interval50_s"][0], f["tc_s"], f["interval50_s"][1], high]
            self.assertEqual(told, sorted(set(told)))
            self.assertIsNone(f["tc_date"])
        self.assertAlmostEqual(self.of(answer, "log")["parameters"]["scale_m"], 0.3, delta=1e-3)
        self.assertEqual(len(answer["rolling"]["issues"]), 36)
        skill = {s["method"]: s for s in answer["rolling"]["skill"]}
        self.assertLess(skill["log"]["crps_s"], skill["log"]["persistence_crps_s"])
        self.assertGreater(skill["log"]["hits"] + skill["log"]["misses"], 0)
        self.assertEqual(skill["log"]["alarms"], skill["log"]["hits"] + skill["log"]["false_alarms"])
        self.check_file("log.nc", answer)
        text = self.call("log.csv", "--displacement", "d:m", "--time-format", "day", "--rolling",
                         "-v", "--failed-at", "40 day").stdout
        for word in ("life expectancy (days)", "skill", "error (day)", "An alarm", "saito", "40 day"):
            self.assertIn(word, text)

    def falling(self, noise):
        """Settlement 50 ln(1 - i/120) mm, cut at 112 days; it fails on day 120."""
        drawn = numpy.random.default_rng(1).normal(0, 1, 112)
        self.write("falls.csv", "t,d\n" + "".join(
            f"{i},{50 * math.log(1 - i / 120) + noise * drawn[i]:.6f}\n" for i in range(112)))
        return ("falls.csv", "--displacement", "d:mm", "--time-format", "day")

    def test_settlement_is_turned_and_said(self):
        for noise in (0, 0.2):
            words = self.falling(noise)
            answer = self.ask(*words)
            self.assertTrue(answer["series"]["falling"] and answer["accelerating"])
            self.assertEqual((answer["series"]["resets"], answer["series"]["resets_disbelieved"]), (0, 0))
            f = self.of(answer, "log")
            self.assertTrue(f["issued"], f["reason"])
            self.assertAlmostEqual(f["tc_raw_s"] / 86400, 120, delta=0.001 if noise == 0 else 2)
            self.assertIn("falls (settlement, line of sight)", self.call(*words).stdout)
        self.call(*words, "-o", "falls.nc")
        with netCDF4.Dataset(os.path.join(self.folder, "falls.nc")) as data:
            self.assertEqual(data.falling, 1)
            self.assertGreater(data["displacement"][-1], data["displacement"][0])
        rises = self.ask("log.csv", "--displacement", "d:m", "--time-format", "day")
        self.assertFalse(rises["series"]["falling"])

    def test_too_many_resets_are_refused_in_words(self):
        self.write("saw.csv", "t,d\n" + "".join(f"{i},{5 * (i % 4) + 0.001 * (i * i % 7)}\n" for i in range(60)))
        words = ("saw.csv", "--displacement", "d:mm", "--time-format", "day")
        answer = self.ask(*words)
        self.assertEqual(answer["series"]["resets"], 0)
        self.assertGreater(answer["series"]["resets_disbelieved"], 3)
        for f in answer["forecasts"]:
            self.assertRegex(f["reason"], r"of 60 readings would be resets .* --raw takes the readings as they are")
        self.assertNotIn("resets", self.ask(*words, "--raw")["forecasts"][0]["reason"])

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_a_line_is_no_false_alarm(self):
        self.write("line.csv", "t,d\n" + "".join(f"{i},{1000 + 0.7 * i:.3f}\n" for i in range(200)))
        for since in ([], ["--since", "0 s"], ["--since", "20 hour"]):
            answer = self.ask("line.csv", "--displacement", "d:mm", "--time-format", "hour", "--rolling",
                              "--issues", "20", "--failed-at", "never", *since)
            self.assertAlmostEqual(answer["series"]["resolution_m"], 1e-6, delta=1e-18)
            self.assertGreaterEqual(answer["series"]["noise_m"], answer["series"]["resolution_m"])
            for skill in answer["rolling"]["skill"]:
                self.assertEqual((skill["issued"], skill["false_alarms"]), (0, 0), skill["method"])
        self.assertIn("no acceleration: the 180 readings since --since are those of a steady motion",
                      self.of(answer, "block")["reason"])
        self.write("law.csv", "t,d\n" + "".join(f"{i},{1000 - 20 * math.log(1 - i / 240):.3f}\n" for i in range(200)))
        answer = self.ask("law.csv", "--displacement", "d:mm", "--time-format", "hour", "--since", "20 hour")
        for method in ("log", "block", "voight", "persistence"):
            self.assertTrue(self.of(answer, method)["issued"], method)
        self.assertAlmostEqual(self.of(answer, "log")["tc_raw_s"] / 3600, 240, delta=0.1)

    def test_numbers_of_netcdf_have_a_last_digit_too(self):
        law = numpy.array([float(row.split(",")[1]) for row in LOG_LAW[1:]])
        for kind, scale, digit in (("f8", None, numpy.finfo("f8").eps * law.max()), ("f4", None, numpy.finfo("f4").eps * law.max()),
                                   ("i2", 0.002, 0.002)):
            with netCDF4.Dataset(os.path.join(self.folder, "law.nc"), "w") as data:
                data.createDimension("time", len(law))
                time, moved = data.createVariable("time", "f8", "time"), data.createVariable("d", kind, "time")
                time.units, time[:] = "days since 2020-01-01", numpy.arange(len(law))
                if scale is not None:
                    moved.scale_factor = scale
                moved[:] = law
                if kind == "f4":
                    moved.units = "m"
            answer = self.ask("law.nc", "--displacement", "d")
            self.assertAlmostEqual(answer["series"]["resolution_m"] / digit, 1, places=5)
            self.assertEqual(answer["series"]["warnings"], [] if kind == "f4" else ["d: no unit is named: taken as m"])

    def test_what_would_be_left_out_in_silence(self):
        self.write("doors.csv", "date,d,r\n2024-01-01,1,NA\n2024-01-02,2,NA\n2024-01-03,1e10,NA\n")
        for words, says in ((("d:mm", "--horizon", "3"), '--horizon: "3" must be a time >= 600 s'),
                            (("d:um", "--smooth", "window:3"), '"window:3" is 3 s, shorter than every interval'),
                            (("d:um", "--failed-at", "never"), "--failed-at: judges the forecasts of --rolling"),
                            (("d:um", "--driver", "d:mm"), '--driver: "d:mm" is the motion itself'),
                            (("d:um", "--driver", "r:mm"), "doors.csv: r: every reading is missing"),
                            (("d:m",), 'doors.csv:4: d: "1e10" is too large: at most 1e9 m')):
            self.assertIn(says, self.call("doors.csv", "--displacement", *words, status=2).stderr)

    def test_what_is_taken_is_said(self):
        with open(os.path.join(self.folder, "log.csv"), encoding="utf-8") as file:
            head, *rows = file.read().split()
        with open(os.path.join(self.folder, "log10.csv"), "w", encoding="utf-8") as file:
            file.write("\n".join([head, *(row.split(",")[0] + "0," + row.split(",")[1] for row in rows), ""]))
        data = ("log10.csv", "--displacement", "d")
        done = self.call(*data, "--json")
        self.assertEqual(done.stderr, "lacuna: warning: log10.csv: t: no unit is named: taken as s\n"
                                      "lacuna: warning: log10.csv: d: no unit is named: taken as m\n")
        self.assertEqual(json.loads(done.stdout)["series"]["warnings"],
                         ["t: no unit is named: taken as s", "d: no unit is named: taken as m"])
        self.assertEqual(self.call(*data, "-q").stderr, "")
        done = self.call("log.csv", "--displacement", "d:m", "--time-format", "day", "--json")
        self.assertEqual((done.stderr, json.loads(done.stdout)["series"]["warnings"]), ("", []))
        self.write("dst.csv", "t,d\n" + "".join(f"2024-10-27T{h:02}:00,{k}\n"
                                                for k, h in enumerate([0, 1, 2, 2] + list(range(3, 24)))))
        done = self.call("dst.csv", "--displacement", "d:mm", "--json")
        self.assertIn("1 of 25 rows repeat a time with another value", done.stderr)
        self.assertEqual(json.loads(done.stdout)["series"]["conflicts"], 1)

    def test_since_takes_the_gate_of_the_onset_away(self):
        """Ten readings are too few for a rise to be sure of; asked since the start the law is found all the same."""
        self.write("early.csv", "\n".join(LOG_LAW[:11]))
        words = ("early.csv", "--displacement", "d:m", "--time-format", "day")
        shut = self.ask(*words)
        self.assertRegex(self.of(shut, "log")["reason"], "no acceleration|cannot tell whether it accelerates")
        self.assertIsNone(shut["window_start_s"])
        answer = self.ask(*words, "--since", "0 s")
        self.assertFalse(answer["accelerating"])
        self.assertEqual(answer["window_start_s"], 0)
        self.assertAlmostEqual(self.of(answer, "log")["tc_raw_s"] / 86400, 40, delta=1)
        self.assertIn("nothing says that it accelerates", self.call(*words, "--since", "0 s").stdout)

    def test_one_bad_reading_shuts_no_gate(self):
        """It makes one of the last velocities low; the rise is seen and the law found all the same."""
        rows = list(LOG_LAW)
        rows[-4] = rows[-4].split(",")[0] + "," + str(float(rows[-4].split(",")[1]) + 0.05)
        self.write("bad.csv", "\n".join(rows))
        answer = self.ask("bad.csv", "--displacement", "d:m", "--time-format", "day", "--raw")
        self.assertTrue(answer["accelerating"])
        self.assertAlmostEqual(self.of(answer, "log")["tc_raw_s"] / 86400, 40, delta=1)

    def test_times_are_in_the_unit_of_the_file(self):
        text = self.call("log.csv", "--displacement", "d:m", "--time-format", "day").stdout
        self.assertRegex(text, r"readings +36 from 0 day to 35 day\n")
        self.assertRegex(text, r"\n  log +\d+\.?\d* day")
        self.assertNotRegex(text, r"\d (year|hour|week)")
        text = self.call("log.csv", "--displacement", "d:m", "--time-format", "hour").stdout
        self.assertRegex(text, r"readings +36 from 0 hour to 35 hour\n")
        self.assertRegex(self.call("log.csv", "--displacement", "d:m", "--time-format", "s").stdout, "from 0 s to 35 s")
        self.assertRegex(self.call("log.csv", "--displacement", "d:m", "--time-format", "day.second/second").stdout,
                         "from 0 s to 5 week")  # too long a name to stand behind a number

    def test_a_time_after_the_year_9999_is_said(self):
        self.write("far.csv", "t,d\n" + "".join(f"{9900 + i}-01-01,{-0.3 * math.log(1 - i / 110):.6f}\n"
                                                for i in range(95)))
        text = self.call("far.csv", "--displacement", "d:m").stdout
        self.assertRegex(text, r"inv +after year 9999 +99\d\d-\S+ \S+ to after year 9999")
        self.assertNotIn("- to -", text)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_times_to_failure_have_a_unit_of_their_span(self):
        """Times left at the same readings are the same numbers, whatever the clock's unit."""
        tables = {}
        for clock, head, name in (("s", "s", "s"), ("min", "min", "min"), ("hour", "hour", "hour"),
                                  ("day", "days", "day")):
            text = self.call("log.csv", "--displacement", "d:m", "--time-format", clock, "--rolling",
                             "--failed-at", f"40 {clock}").stdout.split("\n  ")
            at = next(i for i, line in enumerate(text) if line.startswith("life expectancy"))
            self.assertTrue(text[at].startswith(f"life expectancy ({head}) "))
            self.assertTrue(any(f"error ({name})" in line and f"CRPS ({name})" in line for line in text))
            tables[clock] = [line.split()[2] for line in text[at + 1:at + 20]]
            for line in text[at + 1:at + 20]:
                self.assertEqual(float(line.split()[0]) + float(line.split()[2]), 40)
        self.assertEqual(tables["s"], tables["day"])

    def check_file(self, name, answer):
        path = os.path.join(self.folder, name)
        with netCDF4.Dataset(path) as data:
            self.assertEqual(data["method"].flag_meanings.split(), METHODS)
            for i, issue in enumerate(answer["rolling"]["issues"]):
                self.assertEqual(data["issue_time"][i], issue["issue_time_s"])
                for k, f in enumerate(issue["forecasts"]):
                    self.assertEqual(data["issued"][i, k], f["issued"])
                    self.assertEqual(data["reason"][i, k], f["reason"] or "")
                    for variable, key in (("failure_time", "tc_s"), ("failure_time_raw", "tc_raw_s")):
                        stored = data[variable][i, k]
                        self.assertEqual(None if numpy.ma.is_masked(stored) else float(stored), f[key])
            self.check_indicators(data, answer)
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tests/support/check_cf.py"),
                               "--status", "complete", path], text=True, capture_output=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stdout)

    def check_indicators(self, data, answer):
        """INDICATOR_KEY(issue) of the file is what the JSON says at each issue time."""
        said = {}
        for i, issue in enumerate(answer["rolling"]["issues"]):
            for found in issue["indicators"]:
                for key, value in found["values"].items():
                    said.setdefault(f"{found['indicator']}_{key}", {})[i] = value
        names = {i["indicator"] for i in answer["indicators"]}
        stored = {name for name in data.variables if any(name.startswith(n + "_") for n in names)}
        self.assertEqual({name for name in stored if not name.endswith("_points")}, set(said))
        for name, values in said.items():
            self.assertTrue(data[name].units and data[name].long_name)
            for i in range(len(data["issue_time"])):
                number = data[name][i]
                self.assertEqual(None if numpy.ma.is_masked(number) else float(number), values.get(i), name)

    def test_rolling_is_what_was_known(self):
        words = ("log.csv", "--displacement", "d:m", "--time-format", "day")
        rolling = self.ask(*words, "--rolling")["rolling"]["issues"]
        for i in (12, 20, 35):
            alone = self.ask(*words, "--until", f"{i} day")
            self.assertEqual(alone["issue_time_s"], i * 86400)
            self.assertEqual(alone["forecasts"], rolling[i]["forecasts"])
            self.assertEqual(alone["indicators"], rolling[i]["indicators"])
        some = self.ask(*words, "--rolling", "--issues", "5")["rolling"]["issues"]
        self.assertEqual([round(issue["issue_time_s"] / 86400) for issue in some], [6, 13, 21, 28, 35])

    def test_the_same_series_written_otherwise(self):
        def written(rows, *words):
            self.write("other.csv", rows)
            return self.ask("other.csv", *words)["forecasts"]
        start = datetime.datetime(2015, 6, 7)
        numbers = [line.split(",") for line in LOG_LAW[1:]]
        dates = [start + datetime.timedelta(days=int(t)) for t, d in numbers]
        plain = written("when,d\n" + "\n".join(f"{at:%Y-%m-%d},{d}" for at, (t, d) in zip(dates, numbers)),
                        "--displacement", "d:m")
        others = (
            ("\ufeffd;t\r\n" + "\r\n".join(f"{d.replace('.', ',')};{at:%d.%m.%y}"
                                           for at, (t, d) in zip(dates, numbers)),
             ("--time", "t", "--displacement", "d:m", "--time-format", "%d.%m.%y")),
            ("# a\nt\td\n" + "\n".join(f"{at:%Y-%m-%dT%H:%M:%S}+00:00\t{float(d) * 1e3:.3f}"
                                       for at, (t, d) in reversed(list(zip(dates, numbers)))),
             ("--displacement", "d:mm")),
            ("t,d\n" + "\n".join(f"{42162 + int(t)},{d}" for t, d in numbers),
             ("--displacement", "d:m", "--time-format", "excel")),
            ("t,d\n" + "\n".join(f"{24 * int(t)},{d}" for t, d in numbers),
             ("--displacement", "d:m", "--time-format", "hours since 2015-06-07")),
        )
        for text, words in others:
            for a, b in zip(plain, written(text, *words)):
                self.assertEqual(a["issued"], b["issued"])
                self.assertEqual(a["tc_date"] is None, b["tc_date"] is None)
                if a["tc_date"] is not None:  # an error of a fit knows fewer digits than its time
                    self.assertLess(abs(seconds(a["tc_date"].strip("Z")) - seconds(b["tc_date"].strip("Z"))), 5)

    def test_a_run(self):
        case = os.path.join(SOURCE, "cases/block.yaml")
        subprocess.run([PROGRAM, "run", case, "-o", "block.nc", "-q"], cwd=self.folder, check=True,
                       capture_output=True)
        with netCDF4.Dataset(os.path.join(self.folder, "block.nc")) as data:
            failure = float(data.failure_time_s)
        answer = self.ask("block.nc", "--until", f"{0.95 * failure} s", "--rolling")
        self.assertEqual(answer["series"]["kind"], "run")
        self.assertEqual(answer["rolling"]["failed_at_s"], failure)
        f = self.of(answer, "block")
        self.assertTrue(f["issued"], f["reason"])
        self.assertAlmostEqual(f["tc_raw_s"] / failure, 1, delta=0.005)

    def test_a_run_that_ended_by_an_error(self):
        case = os.path.join(SOURCE, "cases/block.yaml")
        done = subprocess.run([PROGRAM, "run", case, "-o", "short.nc", "-q", "--set", "solver.max_steps=150"],
                              cwd=self.folder, check=False, capture_output=True)
        self.assertEqual(done.returncode, 1)
        said = self.call("short.nc", "--json")
        self.assertEqual(json.loads(said.stdout)["series"]["run_status"], "failed")
        self.assertIn("warning: short.nc: this run ended by an error", said.stderr)

    def test_indicators_of_a_run(self):
        case = os.path.join(SOURCE, "cases/events.yaml")
        subprocess.run([PROGRAM, "run", case, "-o", "events.nc", "-q", "--set", "time.end=16",
                        "--set", "analysis.events.slip_rate=1e-2",
                        "--set", "rg={rule: fix, field: equal, beta: 0.6}", "--set", "analysis.rg={}"],
                       cwd=self.folder, check=True, capture_output=True)
        with netCDF4.Dataset(os.path.join(self.folder, "events.nc")) as data:
            time, slip = data["time"][:].filled(), data["n_slip"][:].filled() / data["n_tot"][:].filled()
            length = data["correlation_length"][:].filled(numpy.nan)
            starts, moment = data["event_time"][:].filled(), data["event_moment"][:].filled()
            ends = starts + data["event_duration"][:].filled()
        answer = self.ask("events.nc", "--rolling", "--issues", "12", "-o", "events-course.nc")
        with netCDF4.Dataset(os.path.join(self.folder, "events-course.nc")) as data:
            self.check_indicators(data, answer)
        b_values = 0
        for issue in answer["rolling"]["issues"]:
            found = {i["indicator"]: i["values"] for i in issue["indicators"]}
            now = issue["issue_time_s"]
            record = numpy.flatnonzero(time <= now)[-1]
            for level in range(slip.shape[1]):
                self.assertAlmostEqual(found["slip_fraction"][f"level_{level}"], slip[record, level])
            self.assertAlmostEqual(found["correlation_length"]["length_m"], length[record])
            known = ends <= now
            order = numpy.argsort(starts[known], kind="stable")
            b_values += self.check_events(found, now, starts[known][order], moment[known][order])
        self.assertGreater(b_values, 2)
        text = self.call("events.nc", "--rolling", "--issues", "12").stdout
        self.assertRegex(text, r"indicators +slip_fraction +correlation_length +event_rate")

    def check_events(self, found, now, starts, moment):
        """The numbers of events against numpy; whether there is a b-value."""
        if len(starts) < 5:
            self.assertEqual(found["event_rate"], {})
            return 0
        late = starts > 0.5 * now
        self.assertAlmostEqual(found["event_rate"]["rate_1_s"], len(starts) / now)
        self.assertAlmostEqual(found["event_rate"]["rise_p"], sum(
            math.comb(len(starts), k) for k in range(late.sum(), len(starts) + 1)) / 2 ** len(starts))
        self.assertAlmostEqual(found["moment"]["moment_N_m"] / moment.sum(), 1)
        self.assertAlmostEqual(found["moment"]["share_of_the_last_half"], moment[late].sum() / moment.sum())
        size = 2 / 3 * (numpy.log10(moment) - 9.1)
        least = complete_from(size)
        size = size[size >= least]
        steps = numpy.diff(size)
        steps = steps[steps >= 0.2]
        self.assertEqual(len(size) >= 20, "b" in found["b_value"])
        if len(size) >= 20:
            self.assertAlmostEqual(found["b_value"]["complete_from"], least)
            self.assertAlmostEqual(found["b_value"]["b"], b_value(size, least)[0])
        self.assertEqual(len(steps) >= 20, "b" in found["b_positive"])
        if len(steps) >= 20:
            self.assertAlmostEqual(found["b_positive"]["b"], math.log10(math.e) / (steps.mean() - 0.2), delta=1e-9)
        return len(size) >= 20

    def test_indicators_know_no_future(self):
        words = ("--displacement", "d:m", "--time-format", "day")
        self.write("past.csv", "\n".join(LOG_LAW[:32]))
        self.write("wild.csv", "\n".join(LOG_LAW[:32] + ["31,-5", "32,77", "33,NA", "34,1e6"]))
        past = self.ask("past.csv", *words)
        self.assertIsNone(next(i for i in past["indicators"] if i["indicator"] == "slowing")["reason"])
        for found in past["indicators"]:
            says = {"events": "needs a catalogue of events: a run", "cells": "needs cells: a run"}.get(found["needs"])
            self.assertTrue(says is None or found["reason"].startswith(says), found)
        for name in ("log.csv", "wild.csv"):
            until = self.ask(name, *words, "--until", "30 day")
            for key in ("indicators", "forecasts"):
                self.assertEqual(past[key], until[key])

    def test_a_pipe_is_read_as_its_file(self):
        """Whatever its first bytes are: without a header line nothing can be lost unseen."""
        path = os.path.join(SOURCE, "cases/data/creep.csv")
        with open(path, encoding="utf-8") as file:
            lines = [line for line in file if not line.startswith("#")]
        self.write("bare.csv", "".join(lines))
        words = ["--time", lines[0].split(",")[0], "--displacement", "disp_mm:mm", "--json"]
        whole = self.call("bare.csv", *words).stdout
        with open(os.path.join(self.folder, "bare.csv"), "rb") as file:
            piped = subprocess.run(f"cat | {shlex.join([PROGRAM, 'precursors', '/dev/stdin', *words])}",
                                   shell=True, stdin=file, capture_output=True, text=True, check=False)
        self.assertEqual(piped.returncode, 0, piped.stderr)
        self.assertEqual(json.loads(piped.stdout)["forecasts"], json.loads(whole)["forecasts"])

    def hindcasts(self):
        data = os.path.join(SOURCE, "..", "shared", "data", "monitoring")
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tools/studies/hindcasts.py"),
                               "--program", PROGRAM, "--data", data], text=True,
                              capture_output=True, check=True)
        return [[cell.strip() for cell in line.split("|")] for line in done.stdout.splitlines()]

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_hindcasts_agree_with_another_program(self):
        rows = self.hindcasts()
        differences = [float(cell[:-4]) for row in rows for cell in row if cell.endswith(" day")
                       and cell[0] in "+-"]
        self.assertGreaterEqual(len(differences), 1)  # Chambon's data may not be at hand
        self.assertTrue(all(abs(off) < 0.1 for off in differences), differences)
        if len(differences) > 1:
            self.assertEqual(len(differences), 14)
            said = {row[1]: row for row in rows if len(row) == 12}
            for name in ("Baijiabao", "Lamosano"):  # which did not fail
                self.assertEqual(said[name][8], "-", said[name])
                self.assertTrue(said[name][10].startswith("0 ("), said[name])
            self.assertEqual(said["Chambon, crisis"][4], "alarm")

    def test_eight_readings_of_a_wall_that_rain_drove(self):
        """Their noise is a twelfth of the way since: it explains what a law is off, and is said."""
        data = os.path.join(SOURCE, "cases/data/century_prism_31-2008.csv")
        words = (data, "--displacement", "displacement_mm:mm", "--since", "2014-02-08T12:54")
        answer = self.ask(*words)
        log = self.of(answer, "log")
        self.assertGreater(log["misfit"], 0.04)
        self.assertEqual(log["excess"], 0)
        self.assertEqual(log["tc_date"][:10], "2014-02-20")
        with open(data, encoding="utf-8") as rows:
            times = [seconds(row.split(",")[0]) for row in rows if row[0] == "2"]
        step = numpy.median(numpy.diff(times)[-5:])
        self.assertGreaterEqual(log["interval90_s"][1] - log["interval90_s"][0], 0.999 * step)
        for f in answer["forecasts"]:
            self.assertEqual(f["issued"], f["method"] in ("log", "persistence"))


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
