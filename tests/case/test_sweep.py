#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna sweep` from the case to the file, its answers against closed forms, and its page.

usage: test_sweep.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE = "", ""
BLOCK = "cases/block.yaml"
DC, RATE = "friction.aging.dc", "initial.slip_rate"


class Sweep(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.out = os.path.join(self.folder, "out.nc")

    def tearDown(self):
        shutil.rmtree(self.folder)

    def call(self, *words, status=0):
        done = subprocess.run([PROGRAM, *words], cwd=SOURCE, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stderr if status else done.stdout

    def sweep(self, *words, over=(), case=BLOCK):
        """The answers and the variables of the file."""
        varied = [w for o in over for w in ("--over", o)]
        text = self.call("sweep", case, "-o", self.out, "--force", "-q", "--json", *varied, *words)
        with netCDF4.Dataset(self.out) as file:
            values = {name: v[:].filled(numpy.nan) if v.dtype != str and v[:].dtype.kind == "f" else v[:] for name, v in file.variables.items()}
        return json.loads(text), values

    def refuse(self, said, *words):
        self.assertIn(said, self.call("sweep", BLOCK, "-o", self.out, *words, status=2))
        self.assertFalse(os.path.exists(self.out))

    def test_a_member_is_the_run(self):
        """Of a grid each member fails when `lacuna run` says, and the last parameter goes fastest."""
        _, v = self.sweep(over=[f"{DC}=1 mm, 2 mm", f"{RATE}=1 mm/week, 5 mm/week, 1 mm/day"])
        self.assertEqual(len(v["realization"]), 6)
        numpy.testing.assert_array_equal(v["friction_aging_dc"], [1e-3] * 3 + [2e-3] * 3)
        run = json.loads(self.call("run", BLOCK, "--json", "-q", "-o", self.folder + "/run.nc", "--set", f"{DC}=2 mm", "--set", f"{RATE}=5 mm/week"))
        self.assertEqual(v["failure_time"][4], run["failure_time_s"])
        self.assertEqual(v["mean_slip"][4], run["mean_slip_m"])
        self.assertEqual(v["steps"][4], run["steps"])

    def test_the_same_whoever_computes(self):
        """Any number of processes, and any number of members: the same bits."""
        over = [f"{DC}=uniform(1 mm, 3 mm)", f"{RATE}=loguniform(1 mm/week, 1 cm/week)"]
        _, one = self.sweep("--members", "12", "--jobs", "1", over=over)
        _, two = self.sweep("--members", "12", "--jobs", "2", over=over)
        for name in one:
            numpy.testing.assert_array_equal(one[name], two[name], name)
        _, more = self.sweep("--members", "20", over=over)
        numpy.testing.assert_array_equal(more["failure_time"][:12], one["failure_time"])
        _, other = self.sweep("--members", "12", "--seed", "2", over=over)
        self.assertFalse(numpy.any(other["friction_aging_dc"] == one["friction_aging_dc"]))

    def test_indices_of_a_block(self):
        """The time to failure of a block goes with dc/v: a product, whose indices are known."""
        sums, v = self.sweep("--design", "saltelli", "--members", "4000", over=[f"{DC}=uniform(1 mm, 3 mm)", f"{RATE}=loguniform(1 mm/week, 1 cm/week)"])
        ratio = v["failure_time"] * v["initial_slip_rate"] / v["friction_aging_dc"]
        self.assertLess(numpy.ptp(ratio) / ratio.mean(), 1e-3)
        wide = math.log(10)  # E(1/v) = 0.9/ln 10, E(1/v^2) = 0.495/ln 10, in weeks a mm
        dc, rate = (2 ** 2 / 12) / 2 ** 2, (0.495 / wide) / (0.9 / wide) ** 2 - 1
        whole = (1 + dc) * (1 + rate) - 1
        known = {DC: (dc / whole, dc * (1 + rate) / whole), RATE: (rate / whole, rate * (1 + dc) / whole)}
        self.assertEqual(sums["answers"]["influence_rows"], 1000)
        for one in sums["answers"]["influences"]:
            first, total = known[one["parameter"]]
            self.assertLess(abs(one["first"] - first), 4 * one["first_error"], one)
            self.assertLess(abs(one["total"] - total), 4 * one["total_error"], one)
            self.assertLess(one["total_error"], 0.06)
        self.assertEqual(sums["answers"]["influences"][0]["parameter"], RATE)

    def test_distributions(self):
        """A Latin hypercube has each of its parts once: the quantiles of what is drawn are the distribution's."""
        laws = {"uniform(1 mm, 3 mm)": lambda u: 1e-3 + 2e-3 * u, "loguniform(1 mm, 4 mm)": lambda u: 1e-3 * 4 ** u,
                "triangular(1 mm, 1 mm, 2 mm)": lambda u: 2e-3 - 1e-3 * numpy.sqrt(1 - u)}
        for law, inverse in laws.items():
            _, v = self.sweep("--design", "lhs", "--members", "20", "--set", "time.end=1 s", over=[f"{DC}={law}"])
            drawn, edges = numpy.sort(v["friction_aging_dc"]), inverse(numpy.arange(21) / 20)
            self.assertTrue(numpy.all((drawn >= edges[:-1]) & (drawn <= edges[1:])), law)
        for law, median in (("normal(2 mm, 0.1 mm)", 2e-3), ("lognormal(2 mm, 0.2)", 2e-3)):
            _, v = self.sweep("--design", "sobol", "--members", "32", "--set", "time.end=1 s", over=[f"{DC}={law}"])
            self.assertEqual((v["friction_aging_dc"] < median).sum(), 16, law)

    def test_never_is_said_and_kept(self):
        """Members that do not fail within their time count; the probability is the share that does."""
        sums, v = self.sweep("--by", "10 day", "--set", "time.end=30 day", over=[f"{DC}=1 mm", f"{RATE}=0.2 mm/week, 0.5 mm/week, 1 mm/week, 2 mm/week"])
        answers = sums["answers"]
        never = int(numpy.isnan(v["failure_time"]).sum())
        self.assertEqual((answers["never"], answers["broken"], never), (2, 0, 2))
        self.assertEqual(answers["probability"]["failed"], int((v["failure_time"] <= 10 * 86400).sum()))
        self.assertEqual(answers["probability"]["known"], 4)
        self.assertTrue(answers["quantiles"][-1]["never"])
        self.assertIn("2 do not fail within their time", self.call("sweep", BLOCK, "--force", "-q", "-o", self.out, "--set", "time.end=30 day",
                                                                   "--over", f"{RATE}=0.2 mm/week, 0.5 mm/week, 1 mm/week, 2 mm/week"))

    def test_a_broken_member_is_a_row(self):
        """A member that cannot be computed is told, and no other suffers."""
        sums, v = self.sweep("--set", "solver.max_steps=450", over=[f"{RATE}=3 mm/week, 1 mm/week, 2 mm/week"])
        self.assertEqual(sums["answers"]["broken"], 1)
        numpy.testing.assert_array_equal(numpy.isnan(v["failure_time"]), [False, True, False])
        self.assertNotEqual(v["message"][1], "")
        self.assertEqual(sums["answers"]["counted"], 2)

    def test_tornado(self):
        """The case as it is, then each parameter alone at both ends."""
        sums, v = self.sweep("--design", "tornado", over=[f"{DC}=0.9 mm, 1.1 mm", f"{RATE}=uniform(0.5 mm/week, 1.5 mm/week)"])
        self.assertEqual(len(v["realization"]), 5)
        numpy.testing.assert_allclose(v["friction_aging_dc"], [1e-3, 0.9e-3, 1.1e-3, 1e-3, 1e-3])
        numpy.testing.assert_allclose(v["initial_slip_rate"][3:] * 604800, [0.6e-3, 1.4e-3], rtol=1e-12)
        swings = sums["answers"]["swings"]
        self.assertEqual([s["parameter"] for s in swings], [RATE, DC])
        self.assertEqual(swings[1]["result_low"], v["failure_time"][1])
        self.assertEqual(sums["answers"]["base"], v["failure_time"][0])

    def test_answers_of_another_result(self):
        """Quantiles, probabilities and indices of any number that a member has, beside those of failure in the file."""
        over = [f"{DC}=uniform(1 mm, 3 mm)", f"{RATE}=loguniform(1 mm/week, 1 cm/week)"]
        sums, v = self.sweep("--members", "60", "--of", "mean_slip", "--by", "3 cm", over=over)
        answers, slip = sums["answers"], v["mean_slip"]
        self.assertEqual((answers["result"], answers["unit"], answers["missing"], answers["never"]), ("mean_slip", "m", 0, 0))
        self.assertAlmostEqual(answers["quantiles"][2]["value"], numpy.median(slip), 12)
        self.assertEqual(answers["probability"]["failed"], int((slip <= 0.03).sum()))
        course = answers["probability_over_time"]
        self.assertEqual((course[0]["by"], course[-1]["by"], course[-1]["share"]), (slip.min(), slip.max(), 1))
        self.assertEqual(answers["influences"][0]["parameter"], DC)
        self.assertAlmostEqual(v["failure_time_quantile"][2], numpy.median(v["failure_time"]), 6)
        text = self.call("gather", self.out, "--of", "mean_slip")
        self.assertIn("what decides         part of the variance of mean_slip, alone\n    friction.aging.dc\n                       first 0.9", text)
        self.assertIn("50 %", text)
        self.assertNotIn("fail", text)
        self.assertIn("no member has one", self.call("gather", self.out, "--of", "least_factor_of_safety"))
        self.assertIn('"slip" must be one of failure_time, ', self.call("gather", self.out, "--of", "slip", status=2))
        self.assertIn('--by: "1 day"', self.call("gather", self.out, "--of", "mean_slip", "--by", "1 day", status=2))

    def test_indices_of_another_result(self):
        """A block slips dc times what its history asks for, whatever the first rate: the index of dc is nearly all."""
        sums, _ = self.sweep("--design", "saltelli", "--members", "400", "--of", "mean_slip", over=[f"{DC}=uniform(1 mm, 3 mm)", "friction.aging.f0=uniform(0.5, 0.7)"])
        one, other = sums["answers"]["influences"]
        self.assertEqual(one["parameter"], DC)
        self.assertLess(abs(one["total"] - 1), 4 * one["total_error"])
        self.assertLess(abs(other["total"]), 0.01)
        tornado, v = self.sweep("--design", "tornado", "--of", "mean_slip", over=[f"{DC}=1 mm, 3 mm"])
        self.assertEqual(tornado["answers"]["swings"][0]["result_high"], v["mean_slip"][2])

    def test_b_and_balance(self):
        """What a catalogue says is a result of its member; who is off the balance is told."""
        _, v = self.sweep("--set", "interface.levels=4", over=["initial.spread.slip_rate.lognormal.seed=2, 3"], case="cases/one-by-one.yaml")
        self.assertTrue(numpy.all(v["b_value"][v["events"] > 60] > 0.1))
        self.assertTrue(numpy.any(v["events"] > 60))
        self.assertTrue(numpy.all(v["balance_residual"] < 0.01))

    def test_keys_that_go_together(self):
        """Keys joined by + take one value."""
        self.call("new", self.folder + "/slope.yaml", "--kind", "slope")
        _, v = self.sweep("--design", "tornado", over=["load.normal.slope.angle+load.shear.0.slope.angle=26 degree, 28 degree"], case=self.folder + "/slope.yaml")
        self.assertTrue(numpy.isnan(v["failure_time"][1]))
        self.assertAlmostEqual(v["failure_time"][2] / 86400, 1.34064, 4)

    def test_words_have_no_order(self):
        """Of a parameter that is a word nothing says whether more of it is sooner."""
        told, _ = self.sweep("--members", "12", over=["friction.aging.form=plain, regularised", f"{DC}=uniform(0.5 mm, 2 mm)"])
        ranks = {one["parameter"]: one["rank_correlation"] for one in told["answers"]["influences"]}
        self.assertIsNone(ranks["friction.aging.form"])
        self.assertGreater(ranks[DC], 0.5)

    def test_wrong_words(self):
        self.refuse('--over: "dc" must be KEY=VALUES', "--over", "dc")
        self.refuse('--design: "latin" must be one of grid', "--over", f"{DC}=1 mm", "--design", "latin")
        self.refuse('"grid" takes lists', "--over", f"{DC}=uniform(1 mm, 2 mm)", "--design", "grid")
        self.refuse("must be quantities of m", "--over", f"{DC}=uniform(1 mm, 2 s)")
        self.refuse("the second must be larger than the first", "--over", f"{DC}=uniform(2 mm, 1 mm)")
        self.refuse("both must be > 0", "--over", f"{DC}=loguniform(0 mm, 1 mm)")
        self.refuse('did you mean "aging"?', "--over", "friction.agin.dc=uniform(1 mm, 2 mm)")
        self.refuse("must be a whole number", "--over", f"{DC}=1 mm", "--members", "-3")
        self.refuse("--by:", "--over", f"{DC}=1 mm", "--by", "1 mm")
        self.refuse("--pipe: writes no file, so -o must be a folder", "--over", f"{DC}=1 mm", "--pipe")
        self.refuse("with a step towards the last", "--over", "interface.levels=3:1")

    def test_page(self):
        """The page of a sweep is drawn whole, and says what the program says."""
        sums, _ = self.sweep("--members", "40", over=[f"{DC}=uniform(1 mm, 3 mm)", f"{RATE}=uniform(1 mm/week, 5 mm/week)"])
        page = os.path.join(self.folder, "page.html")
        self.call("report", self.out, "-o", page)
        shown = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=5000", "--dump-dom", "file://" + page],
                               capture_output=True, text=True, check=False, timeout=120).stdout
        self.assertIn('data-ready="yes"', shown)
        for title in ("Probability of failure", "Slip rate", "What decides", "Members one by one"):
            self.assertIn(f"<h3>{title}</h3>", shown)
        self.assertGreater(len(re.findall(r'<circle class="dot full', shown)), 100)
        self.assertIn(f"of {sums['answers']['counted']} members", shown)
        self.call("report", self.out, "-o", page, "--force", "--of", "mean_slip")
        shown = subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=5000", "--dump-dom", "file://" + page],
                               capture_output=True, text=True, check=False, timeout=120).stdout
        self.assertIn('data-ready="yes"', shown)
        self.assertIn("<h3>Distribution of mean slip</h3>", shown)
        self.assertIn("is the file of a sweep", self.call("report", self.out, "-o", page, "--force", "--until", "1 day", status=2))
        self.sweep("--design", "tornado", over=[f"{DC}=1 mm, 3 mm"])
        self.call("report", self.out, "-o", page, "--force")
        with open(page, encoding="utf-8") as file:
            self.assertIn('"swings":[{', file.read())


if __name__ == "__main__":
    PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
