#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""solver.fidelity: auto takes events where it should and nowhere else, says so, and is right on random scenes.

usage: test_fidelity.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import signal
import subprocess
import sys
import time
import unittest

import netCDF4

import test_cli
from test_cli import Case

# Cells that slip one by one, 106 of them, until the whole goes.
SOFT = """\
lacuna: 1
interface: {size: "16 m", levels: 4, domain: {cascade: {dimension: 1.7, seed: 5}}}
material: {shear_modulus: "10 GPa", poisson: 0.25, shear_speed: "2 km/s"}
load: {normal: {pressure: "5 MPa"}}
friction:
  aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "10 um", v0: "1 um/s"}
  spread: {dc: {lognormal: {sigma: 0.3, seed: 4}}}
initial: {slip_rate: "1 nm/s", state: {ratio_to_steady: 0.9}, spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}}
transfer: {hierarchy: {k0: "1 GPa/m", ratio: 0.5}}
time: {end: "1 year", failure: {mean_slip_rate: "0.1 m/s"}}
solver: {fidelity: auto}
output: {file: soft.nc, every: {per_decade: 5}}
"""
SMALL = "interface.levels=3"
EVENTS = "cells slip one by one (k_0/k_crit"


class Fidelity(Case):
    def setUp(self):
        super().setUp()
        with open(self.path("soft.yaml"), "w", encoding="utf-8") as file:
            file.write(SOFT)

    def words(self, settings):
        return [word for setting in settings for word in ("--set", setting)]

    def chosen(self, *settings):
        """What `check` says would be taken, and why."""
        said = json.loads(self.expect(0, "check", self.path("soft.yaml"), "--json",
                                      *self.words(settings)).stdout)["estimate"]
        return said["fidelity"], said["fidelity_why"]

    def run_of(self, *settings, out="soft.nc"):
        return json.loads(self.expect(0, "run", self.path("soft.yaml"), "-q", "--json", "--force", "-o", self.path(out),
                                      *self.words(settings)).stdout)

    def attributes(self, out="soft.nc"):
        with netCDF4.Dataset(self.path(out)) as data:
            return {name: data.getncattr(name) for name in data.ncattrs()}


class Rule(Fidelity):
    def test_events_where_cells_slip_one_by_one(self):
        for settings in ([], ["solver.fidelity=auto"], ["solver.rtol=1e-7"],
                         ["load.shear=[{ramp: {rate: 1 Pa/s}}]"], ["interface.levels=3"], ["friction.aging.form=regularised"],
                         ["load.shear=[{spring: {stiffness: 1 MPa/m, speed: 1 nm/s}}]"],
                         ["transfer={hierarchy: {stiffness: elastic}}", "friction.aging.dc=1 um"]):
            with self.subTest(settings):
                fidelity, why = self.chosen(*settings)
                self.assertEqual(fidelity, "events", why)
                self.assertTrue(why.startswith(EVENTS), why)

    def test_ode_where_events_gains_nothing(self):
        for settings, why in ((["transfer.hierarchy.k0=100 GPa/m"], "the cells hold one another"),
                              (["transfer.hierarchy.k0=1e6"], "nothing holds a cell"),
                              (["transfer.hierarchy.k0=8 GPa/m"], "the cells hold one another"),
                              (["transfer.hierarchy.ratio=0.1"], "little holds a block"),
                              (["interface.levels=2"], "few cells"),
                              (["solver.rtol=1e-5"], "rtol is too coarse"),
                              (["friction.aging.b=0.009"], "b <= a"),
                              (["load.shear=[{spring: {stiffness: 1e12, speed: 1 nm/s}}]"], "a stiff spring")):
            with self.subTest(settings):
                fidelity, said = self.chosen(*settings)
                self.assertEqual(fidelity, "ode")
                self.assertTrue(said.startswith(why), said)

    def test_ode_where_all_cells_are_asked_for(self):
        for setting, why in (("output.fields=[slip]", "output.fields goes with ode, not with events"),
                             ("output.points=[{name: A, x: 1 m, y: 1 m}]", "output.points"),
                             ("analysis={events: {slip_rate: 1 mm/s}}", "analysis"),
                             ("solver.accuracy=1e-3", "solver.accuracy"), ("solver.projection=true", "solver.projection"),
                             ("solver.max_steps=100000", "solver.max_steps"),
                             ("output.every={steps: 10}", "output.every in steps"),
                             ("output.checkpoint={steps: 10}", "output.checkpoint in steps"),
                             ("time.stop_when.factor_of_safety=0.5", "time.stop_when.factor_of_safety")):
            with self.subTest(setting):
                fidelity, said = self.chosen(setting)
                self.assertEqual(fidelity, "ode")
                self.assertTrue(said.startswith(why), said)

    def test_ode_where_events_is_refused(self):
        """Whatever events refuses when it is named, auto runs by ode."""
        for setting in ("solver.method=adams", "solver.max_order=3", "solver.first_step=1 s", "solver.formulation=slip",
                        "load.shear=[{sine: {amplitude: 1 kPa, period: 1 hour}}]", "friction.aging.alpha=0.2",
                        "load.pore_pressure=[{sine: {amplitude: 1 kPa, period: 1 hour}}]",
                        "friction.aging.v2=1 m/s", "transfer={elastic: {}}", "transfer={none: {}}",
                        "inertia={mass_per_area: 1e5}",
                        "weakening=[{dilatancy: {dilatancy: 1e-4, compressibility: 1e-9 1/Pa, drainage_time: 1 hour}}]",
                        "friction={composite: {a: 0.010, b: 0.015, dc: 10 um, v0: 1 um/s, vc: 1 nm/s}}"):
            with self.subTest(setting):
                named = self.lacuna("check", self.path("soft.yaml"), "--set", "solver.fidelity=events", "--set", setting)
                self.assertEqual(named.returncode, 2, setting)
                fidelity, said = self.chosen(setting)
                self.assertEqual((fidelity, bool(said)), ("ode", True))

    def test_check_refuses_what_a_run_does(self):
        """Of a grid too large for the scene to be made too."""
        for command in "check", "run":
            done = self.expect(2, command, self.path("soft.yaml"), *self.words(
                ["solver.fidelity=events", "transfer={elastic: {}}", "interface.levels=9", "interface.domain={full: {}}"]))
            self.assertIn("solver.fidelity events goes with transfer hierarchy, not with elastic", done.stderr)

    def test_a_cell_that_events_refuses(self):
        """Of a that falls to 0 in some cell the scene tells, not the case."""
        with_zero = "friction.spread={a: {uniform: {half_width: 1, seed: 1}}}"
        fidelity, why = self.chosen(with_zero)
        self.assertIn(fidelity, ("ode", "events"))
        said = self.run_of(with_zero, "time.end=1 s")
        self.assertEqual(said["status"], "complete")
        self.assertTrue(why and said["fidelity_why"])

    def test_what_either_costs_and_keeps(self):
        said = json.loads(self.expect(0, "check", self.path("soft.yaml"), "--json").stdout)["estimate"]
        both = said["fidelities"]
        self.assertLess(both["events"]["cpu_time_most_s"], both["ode"]["cpu_time_most_s"] * 3)
        self.assertEqual(said["cpu_time_most_s"], both["events"]["cpu_time_most_s"])
        self.assertAlmostEqual(both["events"]["error"], 1.25 * 1e-6 ** 0.3)
        self.assertAlmostEqual(both["ode"]["error"], 2e-3)
        text = self.expect(0, "check", self.path("soft.yaml")).stdout
        self.assertRegex(text, r"# +fidelity +events, chosen\n# +cells slip one by one")
        self.assertRegex(text, r"# +ode +error at most 0.002, .* s\n# +events +error at most 0.02, .* s")
        barred = json.loads(self.expect(0, "check", self.path("soft.yaml"), "--json", "--set", "transfer={none: {}}").stdout)
        self.assertEqual(set(barred["estimate"]["fidelities"]["events"].values()), {None})


class Runs(Fidelity):
    def test_auto_is_what_it_took(self):
        auto, named, ode = self.run_of(), self.run_of("solver.fidelity=events", out="n.nc"), self.run_of("solver.fidelity=ode", out="o.nc")
        self.assertEqual((auto["fidelity"], named["fidelity"], ode["fidelity"]), ("events", "events", "ode"))
        self.assertEqual(auto["failure_time_s"], named["failure_time_s"])
        self.assertLess(abs(auto["failure_time_s"] / ode["failure_time_s"] - 1), auto["fidelity_error"])
        self.assertTrue(auto["fidelity_why"].startswith(EVENTS))
        self.assertEqual((named["fidelity_why"], ode["fidelity_why"]), (None, None))
        first, second = self.attributes(), self.attributes("n.nc")
        self.assertEqual(first["fidelity_why"], auto["fidelity_why"])
        self.assertEqual(first["fidelity_error"], auto["fidelity_error"])
        self.assertNotIn("fidelity_why", second)
        self.assertIn("fidelity: events", first["case"])
        summary = self.expect(0, "run", self.path("soft.yaml"), "--force", "-o", self.path("soft.nc")).stdout
        self.assertRegex(summary, r"fidelity +events, error at most 0.02: cells slip one by one")

    def test_ode_is_that_which_is_named(self):
        words = ["transfer.hierarchy.k0=100 GPa/m"]
        auto, named = self.run_of(*words), self.run_of(*words, "solver.fidelity=ode", out="n.nc")
        self.assertEqual(auto["fidelity"], "ode")
        self.assertEqual((auto["failure_time_s"], auto["steps"]), (named["failure_time_s"], named["steps"]))

    def test_the_regularised_form_too(self):
        said = self.run_of("friction.aging.form=regularised")
        self.assertEqual((said["fidelity"], said["formulation"], said["failed"]), ("events", "rate", True))

    def test_a_run_that_is_stopped_goes_on(self):
        """By the fidelity that was chosen, to the bit; and so does one that branches off."""
        words = self.words(["interface.levels=5", "output.checkpoint=10 min"])
        part, case = self.path("part.nc"), self.path("soft.yaml")
        whole = json.loads(self.expect(0, "run", case, "-q", "--json", "-o", self.path("whole.nc"), *words).stdout)
        process = self.start("run", case, "-q", "-o", part, *words)
        while process.poll() is None and not self.exists("part.nc.checkpoint"):
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), 4)
        reached = self.attributes("part.nc")["time_reached_s"]
        branch = json.loads(self.expect(0, "run", case, "-q", "--json", "-o", self.path("branch.nc"), *words,
                                        *self.words([f"initial.run={{file: {part}, at: {reached:.17g} s}}",
                                                     f"time.end={reached + 600} s"])).stdout)
        self.assertEqual(branch["fidelity"], "events")
        self.assertNotIn("solver", self.attributes("branch.nc").get("branch_changes", ""))
        on = json.loads(self.expect(0, "run", case, "-q", "--json", "--resume", "-o", part, *words).stdout)
        self.assertEqual((on["fidelity"], on["fidelity_why"]), ("events", whole["fidelity_why"]))
        self.assertEqual(on["failure_time_s"], whole["failure_time_s"])


class Trade(Fidelity):
    def value(self, dials):
        """Time of failure at rtol 1e-5."""
        said = json.loads(self.expect(0, "trade", self.path("soft.yaml"), "-q", "--json", "--force", "-o", self.path("t.nc"),
                                      "--quantity", "failure", "--dials", dials, *self.words([SMALL])).stdout)
        return {float(run["settings"]["solver.rtol"]): run["value"] for run in said["runs"]}[1e-5]

    def test_all_runs_have_one_fidelity(self):
        """That of a run; ode where settings of ode alone are turned."""
        ode, events = (self.run_of(SMALL, "solver.rtol=1e-5", f"solver.fidelity={one}")["failure_time_s"] for one in ("ode", "events"))
        self.assertEqual(self.value("rtol=1e-5"), events)
        self.assertEqual(self.value("rtol=1e-5,method=bdf"), ode)


class Study(Case):
    def test_random_scenes(self):
        """A handful of those of the study."""
        done = subprocess.run([sys.executable, os.path.join(test_cli.SOURCE, "tools/studies/auto.py"), "--seed", "ci",
                               "--scenes", "12", "--errors", "--lacuna", test_cli.PROGRAM], capture_output=True, text=True, check=False, timeout=250)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("12 right, 0 not", done.stdout)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
