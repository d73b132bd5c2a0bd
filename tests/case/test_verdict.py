#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What an engineer is told first: the same in text, JSON, file, lines and page, whatever is missing of it.

usage: test_verdict.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

import report_scenes as scenes

PROGRAM, SOURCE = "", ""
LEVELS = ["quiet", "watch", "warning", "alarm"]
ANSWERS = ["cannot tell", "no", "yes"]
SPANS = ["step", "day", "week", "month"]
# key: what it may be besides null
KEYS = {"level": str, "level_number": int, "rule": str, "accelerates": str, "accelerates_reason": str, "p": float,
        "window_start_s": float, "window_start_date": str, "rate_rise_m_per_s": float, "rate_rise_error_m_per_s": float,
        "position_m": float, "rates": list, "log_odds": float, "log_odds_needed": float, "methods_issued": int,
        "methods_near": int, "horizon_s": float, "chance_within_horizon": float, "pooled_s": list, "pooled_median_date": str}
NEVER_NULL = {"level", "level_number", "accelerates", "rates", "methods_issued", "methods_near"}


def creep(days, rate):
    """A file of daily readings."""
    return "date,d\n" + "".join(f"2020-{1 + day // 28:02}-{1 + day % 28:02}T06:00:00Z,{rate(day):.2f}\n" for day in range(days))


# name: text, and options of its column
FILES = {"failing": (creep(60, lambda day: -200 * math.log(1 - day / 64)), ["--displacement", "d:mm"]),
         "steady": (creep(60, lambda day: 2.5 * day), ["--displacement", "d:mm"]),
         "still": (creep(20, lambda day: 7), ["--displacement", "d:mm"]),
         "two": (creep(2, lambda day: day), ["--displacement", "d:mm"]),
         "one": (creep(1, lambda day: day), ["--displacement", "d:mm"]),
         "clock": ("day,v\n" + "".join(f"{day},{1 / (40 - day):.4f}\n" for day in range(36)),
                   ["--time-format", "day", "--velocity", "v:mm/day"])}


class Verdict(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-verdict-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.told = {}
        for name, (text, words) in FILES.items():
            with open(os.path.join(cls.folder, name + ".csv"), "w", encoding="utf-8") as out:
                out.write(text)
            cls.told[name] = json.loads(cls.call("precursors", name + ".csv", *words, "--rolling", "--issues", "12", "--json",
                                                 "-o", name + ".nc"))

    @classmethod
    def call(cls, *words):
        return subprocess.run([PROGRAM, *words], text=True, capture_output=True, cwd=cls.folder, check=True).stdout

    def verdicts(self):
        """(where, verdict) of each file, now and at each time of issue."""
        for name, told in self.told.items():
            yield name, told["verdict"]
            for i, issue in enumerate(told["rolling"]["issues"]):
                yield f"{name} {i}", issue["verdict"]

    def test_every_key_is_there_or_null(self):
        for where, verdict in self.verdicts():
            with self.subTest(where):
                self.assertEqual(list(verdict), list(KEYS))
                for key, kind in KEYS.items():
                    value = verdict[key]
                    if value is None:
                        self.assertNotIn(key, NEVER_NULL)
                    else:
                        self.assertIsInstance(value, (int, float) if kind is float else kind, key)
                self.assertEqual(LEVELS[verdict["level_number"]], verdict["level"])
                self.assertIn(verdict["accelerates"], ANSWERS)
                self.assertEqual([one["span"] for one in verdict["rates"]], SPANS)
                for one in verdict["rates"]:
                    self.assertEqual(list(one), ["span", "rate_m_per_s", "change_m_per_s"])
                self.assertEqual(len(verdict["pooled_s"] or range(5)), 5)

    def test_it_stands_first_and_is_that_of_the_last_issue(self):
        for name, told in self.told.items():
            self.assertEqual(next(iter(told)), "verdict")
            self.assertEqual(told["verdict"], told["rolling"]["issues"][-1]["verdict"], name)

    def test_lines_hold_the_same(self):
        for name, (_, words) in FILES.items():
            lines = self.call("precursors", name + ".csv", *words, "--rolling", "--issues", "12", "--jsonl").splitlines()
            self.assertEqual([json.loads(line)["verdict"] for line in lines],
                             [issue["verdict"] for issue in self.told[name]["rolling"]["issues"]])

    def test_the_file_holds_the_same(self):
        for name, told in self.told.items():
            with self.subTest(name), netCDF4.Dataset(os.path.join(self.folder, name + ".nc")) as file:
                verdicts = [issue["verdict"] for issue in told["rolling"]["issues"]]
                same = lambda variable, values: numpy.testing.assert_array_equal(  # noqa: E731
                    file[variable][:].astype(float).filled(math.nan), numpy.array(values, float), variable)
                same("alarm_level", [v["level_number"] for v in verdicts])
                same("accelerates", [ANSWERS.index(v["accelerates"]) for v in verdicts])
                for variable, key in (("acceleration_p", "p"), ("log_odds_of_failing", "log_odds"), ("horizon", "horizon_s"),
                                      ("chance_within_horizon", "chance_within_horizon")):
                    same(variable, [v[key] for v in verdicts])
                for variable, key in (("rate", "rate_m_per_s"), ("rate_change", "change_m_per_s")):
                    same(variable, [[one[key] for one in v["rates"]] for v in verdicts])
                same("pooled_time", [v["pooled_s"] or [None] * 5 for v in verdicts])
                self.assertEqual(file["alarm_level"].flag_meanings.split(), LEVELS)
                self.assertEqual(file["accelerates"].flag_meanings, "cannot_tell no yes")
                self.assertEqual(file["span"].flag_meanings.split(), SPANS)
                self.assertEqual(file["quantile"][:].tolist(), [0.05, 0.25, 0.5, 0.75, 0.95])

    def test_text_says_it_first(self):
        for name, (_, words) in FILES.items():
            with self.subTest(name):
                text = self.call("precursors", name + ".csv", *words, "--rolling", "--issues", "12")
                verdict, rolled = self.told[name]["verdict"], self.told[name]["rolling"]["issues"]
                head, rest = text.split("\n\n", 1)
                rows = [line.split()[0] for line in head.split("\n")[1:] if line[2] != " "]
                self.assertEqual(rows, ["level", "accelerates", "moved", "rate", "failure"])
                unknown = verdict["level"] == "quiet" and verdict["accelerates"] == "cannot tell"
                word = "CANNOT TELL" if unknown else verdict["level"].upper()
                self.assertIn(f"  level                {word} as of ", head)
                self.assertIn(f"  accelerates          {verdict['accelerates']}", head)
                self.assertNotIn("nan", head)
                self.assertNotIn("inf", head)
                self.assertTrue(rest.startswith("  readings "))
                changes = [one["verdict"]["level"] for i, one in enumerate(rolled)
                           if i == 0 or one["verdict"]["level"] != rolled[i - 1]["verdict"]["level"]]
                table = rest.split("  levels ", 1)[1].split("\n\n")[0].split("\n")[1:]
                self.assertEqual([row[25:].split()[0] for row in table if row], changes)

    def test_words_of_the_file_are_those_of_the_text(self):
        for name, (_, words) in FILES.items():
            text = " ".join(self.call("precursors", name + ".csv", *words).split())
            with netCDF4.Dataset(os.path.join(self.folder, name + ".nc")) as file:
                for key, about in (("verdict", "level"), *((f"verdict_{one}", one) for one in
                                                          ("accelerates", "moved", "rate", "failure"))):
                    self.assertIn(f"{about} {file.getncattr(key)}", text)

    def test_a_date_says_its_zone(self):
        for end, zone in (("Z", "UTC"), ("+02:00", "UTC"), ("", "on the file's clock")):
            path = os.path.join(self.folder, "zone.csv")
            with open(path, "w", encoding="utf-8") as out:
                out.write("date,d\n" + "".join(f"2020-01-{day:02}T06:00{end},{day}\n" for day in range(1, 20)))
            moved = next(line for line in self.call("precursors", "zone.csv", "--displacement", "d:mm").split("\n")
                         if line.startswith("  moved"))
            self.assertTrue(moved.endswith(f" {'04' if end[:1] == '+' else '06'}:00 {zone}"), moved)
        self.assertNotIn("UTC", self.call("precursors", "clock.csv", *FILES["clock"][1]).split("\n\n", 1)[0])

    def test_the_page_shows_it(self):
        self.call("report", "failing.nc", "-o", "failing.html")
        page = scenes.data_of(os.path.join(self.folder, "failing.html"))
        with netCDF4.Dataset(os.path.join(self.folder, "failing.nc")) as file:
            self.assertEqual(page["verdict"], [[name, file.getncattr(name)] for name in file.ncattrs() if name.startswith("verdict")])
            self.assertEqual(page["verdict"][0][0], "verdict")
            self.assertEqual(page["alarm"]["level"], file["alarm_level"][:].tolist())
            left = (file["pooled_time"][:] - file["issue_time"][:][:, None]).filled(math.nan)
            told = numpy.array([[math.nan if one is None else one for one in row] for row in page["forecasts"]["pooled"]])
            numpy.testing.assert_allclose(told, left, rtol=1e-5)


if __name__ == "__main__":
    PROGRAM, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
