#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The study of verdicts: the slopes that it draws, what it counts, and that it goes on where it was stopped.

usage: test_verdicts.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest

import numpy

PROGRAM, SOURCE = "", ""


class Slopes(unittest.TestCase):
    def test_the_same_arguments_give_the_same_slope(self):
        words = [sys.executable, os.path.join(SOURCE, "tools/studies/slopes.py"), "survey", "driven-fail", "--seed"]
        first, again, other = (subprocess.run([*words, seed], capture_output=True, text=True, check=True).stdout
                               for seed in ("5", "5", "6"))
        self.assertEqual(first, again)
        self.assertNotEqual(first, other)
        self.assertEqual(first.splitlines()[0], "time_s,displacement_m,rain_mm")

    def test_every_kind_is_read_in_order_until_it_fails(self):
        for kind in (*slopes.FAILING, *slopes.LASTING):
            for instrument in ("satellite", "survey"):
                with self.subTest(kind=kind, instrument=instrument):
                    slope = slopes.draw(instrument, kind, 3)
                    time = slope["time"]
                    self.assertTrue((numpy.diff(time) > 0).all() and numpy.isfinite(slope["displacement"]).all())
                    self.assertEqual(len(time), len(slope["displacement"]))
                    self.assertEqual(slope["failure"] is None, kind in slopes.LASTING)
                    self.assertLess(time[-1], slope["meta"]["life"])
                    self.assertEqual(bool(slope["drivers"]), kind in ("driven", "driven-fail"))

    def test_laws_of_one_exponent_are_their_closed_forms(self):
        for kind, law in (("log", numpy.log), ("power13", lambda r: 1 - r ** (-7 / 3)), ("power3", lambda r: r ** 0.5 - 1)):
            slope = slopes.draw("radar", kind, 2)
            meta = slope["meta"]
            s = slope["time"] / slope["failure"]
            of = law(1 - s) / law(numpy.array(0.02))
            want = meta["total"] * ((1 - meta["creep_share"]) * of + meta["creep_share"] * s)
            self.assertLess(numpy.abs(meta["true"] - want).max(), 1e-3 * meta["total"])

    def test_what_is_seen_is_the_motion_but_for_the_noise(self):
        for instrument, kind in (("prism", "late"), ("survey", "seasonal")):
            slope = slopes.draw(instrument, kind, 4)
            off = slope["displacement"] - slope["meta"]["true"]
            self.assertLess(off.std(), 2 * slope["meta"]["noise"])
            self.assertGreater(off.std(), 0.7 * slope["meta"]["noise"])

    def test_an_extensometer_is_put_back_to_zero(self):
        shown, resets = slopes.with_resets(numpy.array([0, 0.04, 0.09, 0.12, 0.15, 0.19, 0.9]), 0.1)
        numpy.testing.assert_allclose(shown, [0, 0.04, 0.09, 0, 0.03, 0.07], atol=1e-12)
        self.assertEqual(resets, 1)


class Counts(unittest.TestCase):
    def test_reentries_within_a_horizon_are_one(self):
        row = {"issues": [{"time": day, "level": level} for day, level in
                          enumerate([0, 2, 0, 3, 2, 0, 0, 0, 0, 0, 2, 2])]}
        self.assertEqual(verdicts.entries(row, lambda issue: issue["level"] >= 2, 3), 2)
        self.assertEqual(verdicts.entries(row, lambda issue: issue["level"] >= 2, 0.5), 3)
        self.assertEqual(verdicts.entries(row, lambda issue: issue["level"] >= 2, 9), 1)

    def test_bounds_are_those_of_poisson(self):
        self.assertAlmostEqual(verdicts.upper(0, 10), numpy.log(10) / 10, places=9)
        self.assertAlmostEqual(verdicts.upper(2, 1), 5.3223, places=4)

    def test_plain_inverse_velocity_finds_the_time_of_its_own_law(self):
        time = numpy.linspace(0, 0.97, 400)
        self.assertAlmostEqual(verdicts.plain(time, -3 * numpy.log(1 - time)), 1, places=2)
        self.assertAlmostEqual(verdicts.plain(time, -numpy.log(1 - time), 0.01), 1, places=2)
        self.assertIsNone(verdicts.plain(time, numpy.log(1 + time)))


class Study(unittest.TestCase):
    def run_it(self, folder, *words, status=0):
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tools/studies/verdicts.py"), "--program", PROGRAM,
                               "--only", "survey/log,survey/creep", "--slopes", "2", "--processes", "1", "--cache",
                               folder, *words], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def test_a_study_that_was_stopped_goes_on(self):
        with tempfile.TemporaryDirectory() as folder:
            whole = self.run_it(folder).stdout
            path = os.path.join(folder, "survey-log.jsonl")
            with open(path, encoding="utf-8") as data:
                lines = data.read().splitlines(keepends=True)
            self.assertEqual(len(lines), 3)
            for row in map(json.loads, lines[1:]):
                slope = slopes.draw("survey", "log", row["seed"])
                self.assertLess(row["issues"][-1]["time"], row["failure"] * 0.98)
                self.assertTrue({issue["time"] for issue in row["issues"]} <= set(slope["time"]))
            for text in ("".join(lines[:2]) + lines[2][:40], lines[0][:30]):
                with open(path, "w", encoding="utf-8") as out:
                    out.write(text)
                self.assertEqual(self.run_it(folder).stdout, whole)
            for title in ("Slopes that fail: share at warning", "true times inside the intervals", "median |log10",
                          "Slopes that never fail: entries", "Detection against false alarms"):
                self.assertIn(title, whole)
            rows = [line.split(" | ") for line in whole.splitlines() if line.startswith("| survey | creep")]
            years = sum(slopes.draw("survey", "creep", 1000000 + k)["time"][-1] for k in range(2)) / slopes.YEAR
            self.assertEqual([row[2] for row in rows], ["2", "2"])
            self.assertEqual({row[3] for row in rows}, {f"{years:.3g}"})
            self.assertIn("of another program, generator or options", self.run_it(folder, "--horizon", "3", status=1).stderr)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    sys.path.insert(0, os.path.join(SOURCE, "tools", "studies"))
    import slopes
    import verdicts
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
