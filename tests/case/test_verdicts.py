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


def issues_of(levels, horizon=3, **more):
    """Hand-made issues, one a day of the slope."""
    return [{"time": day, "level": level, "horizon": horizon, "accelerates": "no", "forecasts": {}, "pooled": None,
             "plain": None, **more} for day, level in enumerate(levels)]


def read_as_a_number(printed):
    return [float(part) for part in printed.split(" ± ")]


class Detectable(unittest.TestCase):
    def told(self, way, noise=1.0):
        slope = {"time": numpy.arange(100.0), "failure": 100.0, "meta": {"true": way, "noise": noise}}
        return detectable.told(slope, 0.05)

    def test_only_what_is_off_its_rivals_can_be_told(self):
        t = numpy.arange(100.0)
        numpy.testing.assert_allclose(self.told(3 * t), 0, atol=1e-9)
        line, rivals = self.told(100 * numpy.log1p(numpy.exp((t - 60) / 5)))  # a rate that goes over to another
        self.assertGreater(line, 20 * rivals)
        line, rivals = self.told(-100 * numpy.log(1 - t / 100))
        self.assertGreater(rivals, 2)
        self.assertGreaterEqual(line, rivals)
        self.assertAlmostEqual(self.told(-100 * numpy.log(1 - t / 100), 2.0)[1], rivals / 2)

    def test_a_parabola_is_off_its_line_by_its_own_size(self):
        t = numpy.arange(96.0)
        off = t ** 2 - numpy.polyval(numpy.polyfit(t, t ** 2, 1), t)
        self.assertAlmostEqual(self.told(numpy.arange(100.0) ** 2)[0] / numpy.sqrt(off @ off), 1, places=2)


class Answers(unittest.TestCase):
    LINE = {"issue_time_s": 9.0, "window_start_s": 1.0,
            "verdict": {"level_number": 2, "accelerates": "yes", "p": 0.01, "log_odds": 3.0, "log_odds_needed": 1.0, "horizon_s": 7.0,
                        "chance_within_horizon": 0.5, "pooled_s": [10, 11, 12, 13, 14]},
            "forecasts": [{"method": "log", "issued": True, "tc_s": 12, "tc_raw_s": 15, "relative_error": 0.2, "posterior_s": None,
                           "interval50_s": [11, 13], "interval90_s": [10, 14]},
                          {"method": "voight", "issued": False}]}

    def test_an_answer_is_read_as_it_stands(self):
        issue = verdicts.issue_of(self.LINE, True)
        self.assertEqual(issue["forecasts"], {"log": [10, 11, 12, 13, 14]})
        self.assertEqual(issue["raw"], {"log": [15, 0.2, None]})
        self.assertEqual((issue["time"], issue["level"], issue["odds"], issue["needed"], issue["start"]), (9, 2, 3, 1, 1))
        self.assertEqual(verdicts.issue_of(self.LINE, False)["forecasts"], {})
        unknown = {**self.LINE, "verdict": {**self.LINE["verdict"], "pooled_s": [None] * 5}}
        self.assertIsNone(verdicts.issue_of(unknown, True)["pooled"])

    def test_nothing_stands_in_for_what_is_missing(self):
        for key in self.LINE["verdict"]:
            verdict = {name: value for name, value in self.LINE["verdict"].items() if name != key}
            with self.assertRaisesRegex(verdicts.Missing, f"has no {key}, "):
                verdicts.issue_of({**self.LINE, "verdict": verdict}, True)
        with self.assertRaisesRegex(verdicts.Missing, "has no tc_raw_s, "):
            cut = {name: value for name, value in self.LINE["forecasts"][0].items() if name != "tc_raw_s"}
            verdicts.issue_of({**self.LINE, "forecasts": [cut]}, True)


class Counts(unittest.TestCase):
    def test_reentries_within_a_horizon_are_one(self):
        for horizon, count in ((3, 2), (0.5, 3), (9, 1)):
            row = {"issues": issues_of([0, 2, 0, 3, 2, 0, 0, 0, 0, 0, 2, 2], horizon)}
            self.assertEqual(verdict_tables.entries(row, verdict_tables.is_warned), count)
        self.assertEqual(verdict_tables.entries(row, verdict_tables.is_alarmed), 1)

    def test_bounds_are_those_of_poisson(self):
        self.assertAlmostEqual(verdict_tables.upper(0, 10), numpy.log(10) / 10, places=9)
        self.assertAlmostEqual(verdict_tables.upper(2, 1), 5.3223, places=4)
        row = {"issues": issues_of([2, 0, 0, 0, 0, 2]), "span": 10 * slopes.YEAR}
        self.assertEqual(verdict_tables.rate([row], verdict_tables.is_warned), [2, "0.2", "0.532"])

    def test_issues_are_those_at_or_before_a_share_of_life(self):
        row = {"issues": issues_of(range(100)), "failure": 100.0}
        self.assertEqual([verdict_tables.at_left(row, left)["level"] for left in (0.2, 0.055, 0.02)], [80, 94, 98])
        self.assertEqual([issue["time"] for issue in verdict_tables.at_steps(row)], [40, 60, 73, 82, 88, 92, 94, 96, 97, 98, 99])

    def test_plain_inverse_velocity_finds_the_time_of_its_own_law(self):
        time = numpy.linspace(0, 0.97, 400)
        self.assertAlmostEqual(verdicts.plain(time, -3 * numpy.log(1 - time)), 1, places=2)
        self.assertAlmostEqual(verdicts.plain(time, -numpy.log(1 - time), 0.01), 1, places=2)
        self.assertIsNone(verdicts.plain(time, numpy.log(1 + time)))
        issue = {"time": 100.0, "plain": 108.0, "horizon": 7.0}
        self.assertFalse(verdict_tables.plain_within(None)(issue))
        self.assertTrue(verdict_tables.plain_within(0.1)(issue))

    def test_sums_hold_each_slope_once(self):
        found = {("radar", "creep"): [1, 2], ("radar", "noise"): [3], ("prism", "creep"): [4]}
        self.assertEqual(verdict_tables.with_sums(found), {**found, ("radar", "all"): [1, 2, 3], ("all", "creep"): [1, 2, 4]})

    def test_coverage_counts_one_forecast_of_a_slope_in_each_class_of_lead(self):
        """Each of 80 slopes says at each step what is left: 30 of them are right, the others three times too late."""
        rows = []
        for seed in range(80):
            row = {"seed": seed, "failure": 64.0 * slopes.DAY, "issues": issues_of(range(64))}
            for issue in row["issues"]:
                issue["time"] *= slopes.DAY
                left = 64 * slopes.DAY - issue["time"]
                off = 1 if seed < 30 else 3
                issue["forecasts"] = {"log": [issue["time"] + off * left * part for part in (0.5, 0.9, 1.0, 1.1, 1.5)]}
            rows.append(row)
        groups = verdict_tables.inside_of({("radar", "log"): rows})
        leads = {key[1]: len(of) for key, of in groups.items() if key[1] is not None}
        self.assertEqual(leads[4], 80)  # 16 to 32 days: of all, of the others with a third of it left
        self.assertEqual(len(groups["log", None, None]), 80)
        n, ((half, error), (most, _)) = verdict_tables.covered(numpy.random.default_rng(1), groups["log", None, "radar"])
        self.assertEqual((n, half, most), (80, 37.5, 37.5))
        self.assertAlmostEqual(error, 100 * numpy.sqrt(0.375 * 0.625 / 80), delta=0.6)

    def test_shares_have_their_errors(self):
        self.assertEqual(read_as_a_number(verdict_tables.share([True] * 30 + [False] * 70)), [30, 5])


class Calibration(unittest.TestCase):
    def setUp(self):
        rng = numpy.random.default_rng(1)
        self.n, self.error = 4000, rng.uniform(0.1, 0.5, 4000)
        self.window = rng.uniform(1, 3, self.n)
        self.x = self.window + rng.normal(0, 1, self.n)
        scale = numpy.hypot(self.error, 0.3)
        self.median = self.x + 0.4 * (self.window - self.x) + 0.5 * scale
        self.truth = self.median + scale * rng.normal(size=self.n)

    def best(self, weights):
        errors = numpy.repeat(self.error[:, None], 5, axis=1)
        return errors, calibration.best(self.truth, self.x, self.window, errors, weights)

    def test_the_values_that_made_the_truth_are_found(self):
        errors, (_, pull, spread, q) = self.best(numpy.ones(self.n))
        self.assertAlmostEqual(pull, 0.4)
        self.assertIn(spread, (0.2, 0.3, 0.4))
        places = calibration.places(self.x, self.window, errors, pull, spread, q)
        numpy.testing.assert_allclose(places[:, 2], self.median, atol=0.1)
        below = (self.truth[:, None] <= places).mean(axis=0)
        numpy.testing.assert_allclose(below, calibration.SHARES, atol=2 / self.n)
        self.assertRegex(calibration.row(pull, spread, q), r"^\{\.pull = 0\.4, \.spread = 0\.\d, \.low90 = -\d\.\d+, .*\.high90 = \d\.\d+\}$")

    def test_what_weighs_nothing_counts_for_nothing(self):
        self.truth[::2] += 9
        weights = numpy.ones(self.n)
        weights[::2] = 0
        self.assertAlmostEqual(self.best(weights)[1][1], 0.4)

    def test_a_posterior_gives_its_own_errors(self):
        left = numpy.exp(2 + 0.3 * numpy.array([-1.6448536269514722, -0.6744897501960817, 0, 0.6744897501960817, 1.6448536269514722]))
        x, window, errors = calibration.seen(10.0, 3.0, 99.0, 0.7, list(10 + left))
        self.assertAlmostEqual(x, 2)
        self.assertAlmostEqual(window, numpy.log(7))
        numpy.testing.assert_allclose(errors, [0.3, 0.3, 0.7, 0.3, 0.3])
        self.assertIsNone(calibration.seen(10.0, 3.0, 9.0, 0.7, None))


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
                self.assertLess(row["issues"][-1]["time"], row["failure"] * (1 - min(verdict_tables.STEPS)) + 1e-6)
                self.assertTrue({issue["time"] for issue in row["issues"]} <= set(slope["time"]))
            for text in ("".join(lines[:2]) + lines[2][:40], lines[0][:30]):
                with open(path, "w", encoding="utf-8") as out:
                    out.write(text)
                self.assertEqual(self.run_it(folder).stdout, whole)
            for title in ("Slopes that fail, all kinds", "of each kind, 5 %", "true times inside the intervals", "by instrument",
                          "median |log10", "Slopes that never fail: entries", "Detection against false alarms"):
                self.assertIn(title, whole)
            rows = [line.split(" | ") for line in whole.splitlines() if line.startswith("| survey | creep")]
            years = sum(slopes.draw("survey", "creep", 1000000 + k)["time"][-1] for k in range(2)) / slopes.YEAR
            self.assertEqual([row[2:4] for row in rows], [["2", f"{years:.3g}"]])
            self.assertIn("of another program, generator or options", self.run_it(folder, "--horizon", "3", status=1).stderr)

    def test_a_level_is_the_same_asked_at_its_time_and_in_the_course_of_all(self):
        """So that failing slopes may be asked at few times."""
        slope = slopes.draw("survey", "log", 2)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "slope.csv")
            with open(path, "w", encoding="utf-8") as out:
                out.write(slopes.csv(slope))
            course = verdicts.ask_rolling(PROGRAM, [], path, len(slope["time"]), True)
            self.assertEqual([issue["time"] for issue in course], list(slope["time"]))
            for issue in course[-1::-6]:
                self.assertEqual(verdicts.ask_at(PROGRAM, [], path, issue["time"], True), issue)

    def test_slopes_may_come_from_another_generator(self):
        with tempfile.TemporaryDirectory() as folder:
            other = os.path.join(folder, "other.py")
            with open(other, "w", encoding="utf-8") as out:
                out.write("from slopes import csv, draw\nINSTRUMENTS, FAILING, LASTING = ['survey'], ['log'], []\n")
            printed = self.run_it(os.path.join(folder, "rows"), "--generator", other).stdout
            self.assertIn("| survey | log | 2 |", printed)
            self.assertNotIn("never fail", printed)

    def test_rows_of_the_table_of_methods_are_printed(self):
        with tempfile.TemporaryDirectory() as folder:
            self.run_it(folder)
            printed = self.run_it(folder, "--calibrate").stdout
            self.assertEqual(self.run_it(folder, "--calibrate").stdout, printed)
            self.assertRegex(printed, r"(?m)^persistence +n +\d+, loss [0-9.]+  \{\.pull = [0-9.]+, \.spread = ")
            self.assertEqual(os.listdir(folder).count("survey-creep.jsonl"), 1)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    sys.path.insert(0, os.path.join(SOURCE, "tools", "studies"))
    import calibration
    import detectable
    import slopes
    import verdict_tables
    import verdicts
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
