#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The small cases of one model each show what their first lines say, by closed forms.

usage: test_small_cases.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

A_MINUS_B, P, DAY = 0.005, 5e6, 86400.0


class Small(Case):
    def case(self, name):
        return os.path.join(test_cli.SOURCE, "cases", name + ".yaml")

    def follow(self, name, *words):
        """Runs a case; the summary and the series of its file."""
        done = self.expect(0, "run", self.case(name), "--json", "--force", "-o", "out.nc", *words)
        with netCDF4.Dataset(self.path("out.nc")) as data:
            series = {key: numpy.array(data[key][:]) for key in ("time", "slip_rate", "shear_force",
                                                                 "apparent_friction")}
        return json.loads(done.stdout), series

    def press(self, name, *words):
        return json.loads(self.expect(0, "contact", self.case(name), "--json", "--force", "-o",
                                      "out.nc", *words).stdout)

    def near(self, value, expected, relative):
        self.assertLess(abs(value / expected - 1), relative, (value, expected))


class Loads(Small):
    def test_creep_comes_to_the_rate_of_its_load(self):
        slope = 1e-3 / DAY * math.exp((math.tan(math.radians(30)) - 0.58) / A_MINUS_B)
        for name, rate in (("ratio", 1e-6 / math.e), ("constant", 1e-6 / math.e), ("slope", slope)):
            with self.subTest(name):
                self.near(self.follow("load/" + name)[1]["slip_rate"][-1], rate, 1e-4)

    def test_a_stiff_spring_holds_and_a_soft_one_does_not(self):
        _, held = self.follow("load/spring")
        self.near(held["slip_rate"][-1], 1e-6, 1e-4)
        self.near(held["apparent_friction"][-1], 0.6, 1e-6)
        summary, _ = self.follow("load/spring", "--set", "load.shear.0.spring.stiffness=0.1 GPa/m")
        self.assertGreater(summary["max_slip_rate_m_s"], 1e-3)

    def test_a_ramp_gains_by_the_rate(self):
        _, run = self.follow("load/ramp")
        during = (run["time"] > 3 * DAY) & (run["time"] < 11 * DAY)
        gain = numpy.diff(numpy.log(run["slip_rate"][during])) / numpy.diff(run["time"][during])
        numpy.testing.assert_allclose(gain, 2.5e3 / DAY / (A_MINUS_B * P), rtol=1e-3)
        self.near(run["slip_rate"][-1], 1e-6 * math.e, 1e-4)

    def test_a_step_acts_at_once_and_fades(self):
        _, run = self.follow("load/step")
        self.near(run["slip_rate"][run["time"] == 3600][-1], 1e-6 * math.e, 1e-6)
        self.near(run["slip_rate"][-1], 1e-6 * math.exp(3), 1e-4)

    def test_a_slow_swing_is_followed(self):
        _, run = self.follow("load/sine", "--set", "output.every=1 hour")
        swing = numpy.sin(2 * math.pi * run["time"] / (10 * DAY))
        numpy.testing.assert_allclose(numpy.log(run["slip_rate"] / 1e-6), swing, atol=3e-3)

    def test_a_plate_carries_the_fault_along(self):
        _, run = self.follow("load/back-slip")
        self.near(run["slip_rate"][-1], 1e-9, 1e-3)
        self.near(run["apparent_friction"][-1], 0.6, 1e-4)

    def test_creep_follows_the_piezometer(self):
        _, run = self.follow("load/piezometer")
        # friction is in proportion to the effective pressure's inverse
        head = numpy.interp(run["time"] / DAY, range(11),
                            [4, 4, 4.6, 6.1, 6.4, 6, 5.4, 4.9, 4.5, 4.2, 4])
        total = 2500 * 9.80665 * 40 * math.cos(math.radians(20)) ** 2
        rise = (total - 4 * 9807) / (total - head * 9807) - 1
        self.assertLess(abs(run["time"][run["slip_rate"].argmax()] - 4 * DAY), 0.1 * DAY)
        # between that of the contacts as they were, and of contacts that had time to renew
        peak = math.log(run["slip_rate"].max() / run["slip_rate"][0])
        self.assertTrue(0.4 * rise.max() / 0.015 < peak < 0.4 * rise.max() / 0.010, peak)


class Domains(Small):
    def test_equal_cells_fail_with_the_block(self):
        exact = 1.40259 * 0.7e-3 / (0.81e-3 / (7 * DAY))
        for name in ("full", "cascade"):
            with self.subTest(name):
                self.near(self.follow("domain/" + name)[0]["failure_time_s"], exact, 1e-4)


class Friction(Small):
    def test_weakening_is_the_slip_law_above_steady_state(self):
        weakening, slip = (self.follow("friction/" + law)[0]["failure_time_s"]
                           for law in ("weakening", "slip"))
        self.assertEqual(weakening, slip)

    def test_tails_are_cut_where_said(self):
        self.follow("friction/tails")
        with netCDF4.Dataset(self.path("out.nc")) as data:
            rate, state = (numpy.array(data[key][0]) for key in ("cell_slip_rate", "cell_state"))
        # at the start theta = x^(1 - b/a) dc/v
        dc = state * rate * 0.8 ** 0.4 / 1e-4
        self.assertGreaterEqual(rate.min(), 0.01 * 1e-3 / DAY * (1 - 1e-9))
        self.assertTrue(0.1 * (1 - 1e-9) < dc.min() < 0.15 and 10 < dc.max() < 100)
        # 256 draws of shape 0.6, of which half are beyond m: exp(-m^0.6) is half of exp(-0.1^0.6), the part that was kept
        self.near(numpy.median(dc), (math.log(2) + 0.1 ** 0.6) ** (1 / 0.6), 0.15)


class Solvers(Small):
    def test_every_way_finds_the_first_event(self):
        for name in ("bdf", "adams", "erk", "slip", "traction"):
            with self.subTest(name):
                _, run = self.follow("solver/" + name)
                k = numpy.argmax(run["slip_rate"] > 1e-3)
                u = numpy.log(run["slip_rate"][k - 1:k + 1] / 1e-3)
                t = run["time"][k - 1:k + 1]
                self.near(t[0] - u[0] * (t[1] - t[0]) / (u[1] - u[0]), 5.615967767843e6, 1e-5)


class Estimates(Small):
    """What `check` says of the steps holds; of what it cannot know it says so."""

    NAMES = ("block", "century", "measured", "friction/spread", "friction/tails", "transfer/none",
             "transfer/hierarchy", "domain/full", "load/tides", "load/ratio", "solver/bdf", "bridge")

    def estimate(self, name, *words):
        return json.loads(self.expect(0, "check", self.case(name), "--json", *words).stdout)["estimate"]

    def test_steps_are_in_the_range(self):
        for name in self.NAMES:
            with self.subTest(name):
                said, (took, _) = self.estimate(name), self.follow(name)
                self.assertGreaterEqual(took["steps"], said["steps_least"])
                known = said["steps_most"] is not None
                self.assertEqual(known, said["cpu_time_most_s"] is not None)
                self.assertEqual(known, said["steps_class"] != "not estimated")
                if known:
                    self.assertLessEqual(took["steps"], said["steps_most"])

    def test_what_turns_or_drives_is_not_estimated(self):
        for name, known in (("load/tides", False), ("peers/spring-slider", False), ("events", False),
                            ("load/constant", True), ("vajont", True)):
            self.assertEqual(self.estimate(name)["steps_class"] != "not estimated", known, name)

    def test_the_faster_fidelity(self):
        """events where cells are softly held, ode where stiffly; nothing where the case has it."""
        for fidelity, k0, faster in (("ode", 1, "events"), ("events", 1, None), ("events", 1000, "ode"),
                                     ("ode", 1000, None)):
            said = self.estimate("one-by-one", "--set", f"solver.fidelity={fidelity}",
                                 "--set", f"transfer.hierarchy.k0={k0} GPa/m")
            self.assertEqual(said["faster_fidelity"], faster)

    def test_no_fidelity_is_advised_that_refuses_the_case(self):
        """Nor one that is slower: loads, law and method that events does not follow; cells that slip
        without end, as nothing holds them; cells that do not weaken."""
        for fidelity, setting, faster in (
                ("ode", "load.shear=[{sine: {amplitude: 1 kPa, period: 1 hour}}]", None),
                ("ode", "load.shear=[{ramp: {rate: 1 Pa/s}}]", "events"),
                ("ode", "load.shear=[{spring: {stiffness: 1 GPa/m, speed: 1 nm/s}}]", "events"),
                ("ode", "load.shear=[{spring: {stiffness: 1e12, speed: 1 nm/s}}]", None),
                ("ode", "load.pore_pressure=[{sine: {amplitude: 1 kPa, period: 1 hour}}]", None),
                ("ode", "friction.aging.alpha=0.2", None), ("ode", "friction.aging.v2=1 m/s", None),
                ("ode", "solver.method=adams", None), ("ode", "solver.max_order=2", None),
                ("ode", "solver.formulation=slip", None), ("ode", "transfer.hierarchy.k0=0", None),
                ("ode", "transfer.hierarchy.ratio=0.1", None), ("events", "friction.aging.b=0", "ode"),
                ("events", "friction.aging.a=0.02", "ode")):
            with self.subTest(setting):
                said = self.estimate("one-by-one", "--set", f"solver.fidelity={fidelity}", "--set", setting)
                self.assertEqual(said["faster_fidelity"], faster)

    def test_a_search_and_the_cascade_count(self):
        press, search = self.estimate("normal/pressure"), self.estimate("normal/dimension")
        self.assertIsNone(press["cascade_time_s"])
        self.assertGreater(search["cpu_time_most_s"], search["cpu_time_least_s"])
        one, seeds = (self.estimate("rg/rough-joint", "--set", f"rg.seeds={n}") for n in (1, 4))
        self.near(seeds["cascade_time_s"], 4 * one["cascade_time_s"], 1e-9)
        self.assertIsNone(self.estimate("vajont")["cascade_time_s"])
        self.assertGreater(self.estimate("rg/creep-to-failure")["cascade_time_s"], 0)


class Normals(Small):
    def test_the_load_is_what_the_first_lines_say(self):
        rock = 2700 * 9.80665 * 100
        for name, pressure in (("pressure", 3e6), ("depth", rock), ("slope", 0.75 * rock)):
            with self.subTest(name):
                self.near(self.press("normal/" + name)["mean_pressure_Pa"], pressure, 1e-9)

    def test_a_contact_is_solved_to_its_tolerance(self):
        """Pressures come to those of the tightest tolerance, 1e-8 being what no case need name."""
        pressure = {}
        for tolerance in ("1e-12", "1e-8", "1e-4", ""):
            words = ["--set", "solver.contact_tolerance=" + tolerance] if tolerance else []
            said = self.press("normal/pressure", *words)
            self.assertLess(said["complementarity_error"], float(tolerance or 1e-8))
            with netCDF4.Dataset(self.path("out.nc")) as data:
                pressure[tolerance] = numpy.array(data["pressure"][:])
        best = pressure["1e-12"]
        error = {t: abs(p - best).max() / best.max() for t, p in pressure.items()}
        self.assertLess(error["1e-8"], 1e-6)
        self.assertLess(error["1e-4"], 1e-2)
        self.assertGreater(error["1e-4"], 10 * error["1e-8"])
        self.assertTrue((pressure[""] == pressure["1e-8"]).all())

    def test_a_load_that_follows_presses_to_the_same(self):
        for name, key, wanted in (("approach", "approach_m", 0.01), ("dimension", "d_blocks", 1.5)):
            with self.subTest(name):
                found = self.press("normal/" + name)
                self.near(found[key], wanted, 1e-3)
                again = self.press("normal/pressure", "--set", "load.normal="
                                   "{pressure: %.17g}" % found["mean_pressure_Pa"])
                self.assertEqual(again["n_cells"], found["n_cells"])
                self.near(again[key], found[key], 1e-6)


class Rules(Small):
    def test_what_sheds_more_slides_sooner(self):
        found = [json.loads(self.expect(0, "rg", self.case("rg/" + rule), "--json", "--force", "-o",
                                        "out.nc").stdout) for rule in ("fix", "cons", "lump")]
        self.assertEqual([one["rule"] for one in found], ["fix", "cons", "lump"])
        for one in found[1:]:
            self.assertEqual(one["q_nom_Pa"], found[0]["q_nom_Pa"])
            self.assertTrue(0.7 <= one["q_crit_over_q_nom"] <= 1)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
