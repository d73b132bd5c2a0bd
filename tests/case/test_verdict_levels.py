#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Thresholds of the level: `--levels`, `describe levels`, `levels` of a fleet; what wrong ones are told.

usage: test_verdict_levels.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = "", ""
DATA = ("precursors", "slope.csv", "--displacement", "way:mm", "--time-format", "day")
WRONG = (  # a line of a file, what is said of it
    ("watch_p: 0", 'watch_p: "0" must be > 0'),
    ("watch_p: 1", 'watch_p: "1" must be < 1'),
    ("watch_p: 1.5", 'watch_p: "1.5" must be <= 1'),
    ("odds: -51", 'odds: "-51" must be >= -50'),
    ("odds: high", 'odds: "high" must be'),
    ("odds_dense: .nan", 'odds_dense: ".nan" must be'),
    ("odds_sudden: 1 mm", 'odds_sudden: "1 mm" must be'),
    ("running: 0", 'running: "0" must be >= 1'),
    ("running: 2.5", 'running: "2.5" must be a whole number'),
    ("hold: -1", 'hold: "-1" must be >= 0'),
    ("hold: 51", 'hold: "51" must be <= 50'),
    ("horizon: 0 day", 'horizon: "0 day" must be >= 600 s'),
    ("horizon: 7 mm", 'horizon: "7 mm" must be a time'),
    ("chance: 1.01", 'chance: "1.01" must be <= 1'),
    ("agree: [1]", "agree: must be"),
    ("watch_rate: 0 mm/day", 'watch_rate: "0 mm/day" must be > 0 m/s'),
    ("alarm_rate: 5", 'alarm_rate: "5" must be <= 0.01 m/s'),
    ("alarm_rate: -.inf", 'alarm_rate: "-.inf" must be a speed'),
    ("warning_rte: 5 mm/day", 'warning_rte: is no key here; did you mean "warning_rate"?'),
    ("hold: 1\nhold: 2", "hold"),
)


class Levels(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-levels-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.write("slope.csv", "day,way\n" + "".join(f"{k},{-300 * math.log(1 - k / 50):.1f}\n" for k in range(45)))
        cls.write("default.yaml", cls.call("describe", "levels").stdout)

    @classmethod
    def write(cls, name, text):
        with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as out:
            out.write(text)

    @classmethod
    def call(cls, *words, status=0, stdin=""):
        done = subprocess.run([PROGRAM, *words], input=stdin, capture_output=True, text=True, cwd=cls.folder, check=False)
        if done.returncode != status:
            raise AssertionError(f"{words}: {done.returncode}\n{done.stderr}")
        return done

    def watched(self, fleet, state, status=0, **more):
        self.write("fleet.yaml", 'displacement: "way:mm"\n' + fleet)
        lines = "station,time,way\n" + "".join(f"A,{k},{k}\n" for k in range(3))
        return self.call("watch", "fleet.yaml", "--state", state, "-o", state + ".jsonl", stdin=lines, status=status,
                         **more)

    def test_default_reads_back(self):
        self.assertEqual(self.call(*DATA, "--levels", "default.yaml").stdout, self.call(*DATA).stdout)
        # a state goes on with the same numbers only, to the last bit
        self.watched("", "default")
        self.watched("levels: default.yaml\n", "default")
        self.watched("levels: {horizon: 7 day, alarm_rate: .inf}\nstream: live\n", "default")

    def test_description(self):
        described = json.loads(self.call("describe", "levels", "--json").stdout)
        self.assertEqual(described["kinds"], [])
        rows = described["sections"][0]["parameters"]
        lines = self.call("describe", "levels").stdout.splitlines()
        keys = [line.split(":")[0] for line in lines if line[0] != "#"]
        self.assertEqual(keys, [row["key"] for row in rows])
        self.assertEqual([line for line in lines[1:] if line[0] == "#"], ["# " + row["doc"] for row in rows])
        self.assertEqual({row["key"]: row["default"] for row in rows}["horizon"], 7 * 86400)
        self.assertIn("\n  levels ", self.call("describe").stdout)
        self.assertIn("levels", self.call("describe", "level", status=2).stderr)
        self.assertIn("levels has no models", self.call("describe", "levels", "odds", status=2).stderr)

    def test_horizon_of_the_options_wins(self):
        self.write("horizon.yaml", "horizon: 3 day\n")
        rolling = (*DATA, "--rolling", "--failed-at", "50 day", "--json", "--levels", "horizon.yaml")
        for words, days in (((), 3), (("--horizon", "9 day"), 9)):
            got = json.loads(self.call(*rolling, *words).stdout)
            self.assertEqual(got["rolling"]["horizon_s"], days * 86400)

    def test_good(self):
        self.write("good.yaml", "# all\nwatch_p: 0.999\nodds: -50\nrunning: 1\nhold: 0\nhorizon: 1 h\nchance: 1\nagree: 1\n"
                                'watch_rate: "1 mm/day"\nwarning_rate: .inf\nalarm_rate: 0.1 mm/h\n')
        self.call(*DATA, "--levels", "good.yaml")
        self.call("report", "slope.csv", *DATA[2:], "--levels", "good.yaml", "-o", "slope.html")

    def test_wrong(self):
        for line, said in WRONG:
            self.write("wrong.yaml", f"# a comment\n{line}\n")
            place = 3 if "\n" in line else 2
            error = self.call(*DATA, "--levels", "wrong.yaml", status=2).stderr
            self.assertIn(f"lacuna: wrong.yaml:{place}: {said}", error)
            self.assertEqual(error.count("\n"), 1, error)
            self.write("fleet.yaml", 'displacement: "way:mm"\nlevels: wrong.yaml\n')
            error = self.call("watch", "fleet.yaml", status=2).stderr
            self.assertIn(f'fleet.yaml:2: levels: "wrong.yaml" is wrong: wrong.yaml:{place}: {said}', error)
        self.write("wrong.yaml", "watch_rate: 5 mm/day\nalarm_rate: 3 mm/day\n")
        self.assertIn('wrong.yaml:2: alarm_rate: "3 mm/day" must be >= the rate of the level below, 5 mm/day',
                      self.call(*DATA, "--levels", "wrong.yaml", status=2).stderr)
        for text, said in (("", "must be a mapping of keys"), ("- 1\n", "must be a mapping of keys"), ("a: [\n", "wrong.yaml:")):
            self.write("wrong.yaml", text)
            self.assertIn(said, self.call(*DATA, "--levels", "wrong.yaml", status=2).stderr)
        self.assertIn("none.yaml: cannot be opened", self.call(*DATA, "--levels", "none.yaml", status=3).stderr)

    def test_fleet(self):
        self.write("fleet.yaml", 'displacement: "way:mm"\nlevels:\n  odds: 2\n  hold: 1.5\n')
        self.assertIn('fleet.yaml:4: levels.hold: "1.5" must be a whole number',
                      self.call("watch", "fleet.yaml", status=2).stderr)
        self.write("fleet.yaml", 'displacement: "way:mm"\nlevels: [1]\n')
        self.assertIn("fleet.yaml:2: levels: must be a file name, or a mapping",
                      self.call("watch", "fleet.yaml", status=2).stderr)

    def test_state_refuses_others(self):
        self.watched("levels: {odds: 2}\nhorizon: 3 day\n", "other")
        for fleet, then, now in (("levels: {odds: 3}\nhorizon: 3 day\n", "levels.odds: 2", "levels.odds: 3"),
                                 ("levels: {odds: 2, horizon: 3 day}\nhorizon: 4 day\n", "levels.horizon: 259200",
                                  "levels.horizon: 345600"),
                                 ("levels: {odds: 2, horizon: 3 day, alarm_rate: 5 mm/day}\n", "levels.alarm_rate: inf",
                                  "levels.alarm_rate: 5.787")):
            error = self.watched(fleet, "other", status=2).stderr
            self.assertIn(f'was made with other settings: "{then}", which is "{now}', error)
        self.watched("levels: {odds: 2, horizon: 3 day}\n", "other")


if __name__ == "__main__":
    PROGRAM, SOURCE = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
