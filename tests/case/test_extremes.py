#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of extreme numbers through the program: no NaN or infinity in a file, exit statuses, the
time of failure against a closed form (m = 2: x + ln(1 - x)), one line where a run cannot go on.

usage: test_extremes.py PROGRAM SOURCE_FOLDER [unittest options]
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

PROGRAM, SOURCE = "", ""

BLOCK = """lacuna: 1
load: {{normal: {{pressure: "{pressure} Pa"}}{shear}}}
friction: {{aging: {{f0: 0.6, a: {a}, b: {b}, dc: "{dc} m", v0: "1 um/s", form: {form}}}}}
initial: {{slip_rate: "{v} m/s", state: {state}}}
{more}
time: {{end: "{end} s", failure: {{mean_slip_rate: "{failure} m/s"}}}}
solver: {{rtol: {rtol}, max_steps: {steps}, formulation: {formulation}, method: {method}, fidelity: {fidelity}}}
output: {{file: out.nc, fields: [slip, slip_rate, state, traction], fields_every: "{every} s"}}
"""
PLAIN = {"pressure": 1e6, "shear": "", "a": 0.01, "b": 0.02, "dc": 1e-3, "form": "plain", "v": 1e-9,
         "state": "{ratio_to_steady: 0.5}", "more": "", "end": 1e13, "failure": 1, "rtol": 1e-8,
         "steps": 20000, "formulation": "rate", "method": "bdf", "every": 1e12,
         "fidelity": "ode"}


class Extremes(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.output = os.path.join(self.folder, "out.nc")

    def run_case(self, **changes):
        case = os.path.join(self.folder, "case.yaml")
        self.output = os.path.join(self.folder, "out.nc")
        with open(case, "w", encoding="utf-8") as file:
            file.write(BLOCK.format(**{**PLAIN, **changes}).replace(", state: None", ""))
        return subprocess.run(
            [PROGRAM, "run", case, "-o", os.path.join(self.folder, "out.nc"), "--force", "--json", "--no-progress"],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, timeout=120)

    def scan(self):
        """What the file says of its run; every number in it must be finite or missing."""
        with netCDF4.Dataset(self.output) as file:
            for name, variable in file.variables.items():
                if variable.dtype.kind == "f":
                    values = numpy.ma.compressed(numpy.ma.array(variable[:]))
                    self.assertTrue(numpy.isfinite(values).all(), name)
            return file.status

    def completes(self, **changes):
        done = self.run_case(**changes)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.scan(), "complete")
        return json.loads(done.stdout)

    def breaks(self, what, **changes):
        """One line that says what and when, exit 1, a file that says `failed`."""
        done = self.run_case(**changes)
        self.assertEqual(done.returncode, 1, done.stderr + done.stdout)
        lines = done.stderr.strip().splitlines()
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertRegex(lines[0], what)
        self.assertRegex(lines[0], r"t = [-+0-9.e]+ s")
        self.assertEqual(self.scan(), "failed")

    def test_a_run_that_broke_has_not_failed(self):
        """A step of pore pressure to nearly all of the normal one, undamped: the mean rate passes
        that of failure on its way out of the numbers. Nobody knows what the joint does. With ln v as
        the unknown 1e88 m/s would be a number, and is refused alike."""
        step = ", pore_pressure: [{step: {value: 780000, at: 100}}]"
        ways = [{"formulation": way} for way in ("rate", "slip", "traction")]
        ways += [{"method": way, "formulation": "rate"} for way in ("erk", "adams")]
        for way in ways:
            done = self.run_case(shear=step, **way)
            self.assertEqual(done.returncode, 1, way)
            self.assertRegex(done.stderr, r"^[^\n]*overflows at t = 100 s: beyond 2.35e\+17 m/s[^\n]*$")
        said = json.loads(done.stdout)
        self.assertEqual((said["status"], said["ended_by"]), ("failed", "error"))
        for key in ("failed", "failure_time_s", "failure_date"):
            self.assertIsNone(said[key], key)
        self.assertEqual(self.scan(), "failed")
        with netCDF4.Dataset(self.output) as file:
            self.assertEqual(file.ended_by, "error")
            self.assertFalse({"failed", "failure_time_s"} & set(file.ncattrs()))

    def test_a_cell_that_stands_still_heals(self):
        """So little direct effect that v = exp(ln v) is 0: theta grows as time does, in as few steps as ln theta
        needs, and strength with it: FoS = (f0 + b ln(v0 (101 days)/dc))/tan 30 degrees."""
        for a in "1e-6", "1e-10":
            done = subprocess.run(
                [PROGRAM, "run", os.path.join(SOURCE, "cases", "load", "slope.yaml"), "-o", self.output, "--json",
                 "--force", "--set", "solver.max_steps=5000", "--set", "friction.aging.a=" + a],
                capture_output=True, text=True, timeout=120, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(json.loads(done.stdout)["mean_slip_m"], 0)
            with netCDF4.Dataset(self.output) as file:
                strength = 0.58 + 0.01 * math.log(101)
                self.assertAlmostEqual(file["factor_of_safety"][-1] * math.tan(math.pi / 6) / strength, 1, 7)

    def test_state_beyond_numbers(self):
        """ln theta that no double holds e^ of is refused, not written as infinity."""
        done = self.run_case(v=1e-9, state=None, shear=", shear: [{ratio: 30}]")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertRegex(done.stderr, "beyond numbers")

    def test_state_that_jumps_beyond_numbers(self):
        """Pressure that falls to a tenth, with alpha/b = 500: theta gains e^1151."""
        done = self.run_case(b=0.001, form="plain, alpha: 0.5", more="", end=1e4, shear=(
            ", pore_pressure: [{step: {value: 0.9 MPa, at: 100}}]"))
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, "state balance the load that jumps at t = 100 s")
        self.assertEqual(self.scan(), "failed")

    def test_shaking_is_not_leapt_over(self):
        """A locked block that ten seconds of shaking move by 1.157 m, whatever the unknown."""
        load = (", shear: [{ratio: 0.5}, {shaking: {acceleration: 3, mass: 1e5, frequency: 1, "
                "start: 1e6, duration: 10}}]")
        for formulation in "rate", "traction", "slip":
            for method in "bdf", "adams", "erk":
                done = self.completes(
                    shear=load, a=0.01, b=0.015, dc=1e-4, form="regularised", v=1e-14, state=None,
                    end=1.01e6, failure=1e4, rtol=1e-6, steps=50000, formulation=formulation,
                    method=method, more="material: {shear_modulus: 1 GPa, shear_speed: 1 km/s}")
                self.assertLess(abs(done["mean_slip_m"] / 1.15704 - 1), 1e-3, formulation)

    def test_smooth_series_is_not_leapt_over(self):
        """The same of a pulse among readings that are joined smoothly."""
        with open(os.path.join(self.folder, "pulse.csv"), "w", encoding="utf-8") as file:
            file.write("t,q\n0,0\n1e6,0\n1000001,1.2e6\n1000002,0\n2e6,0\n")
        load = (", shear: [{ratio: 0.5}, {series: {file: pulse.csv, time: t, value: 'q:Pa', "
                "interpolation: smooth}}]")
        slip = {}
        for formulation in "rate", "traction", "slip":
            done = self.completes(
                shear=load, a=0.01, b=0.015, dc=1e-4, form="regularised", v=1e-14, state=None,
                end=1.01e6, failure=1e4, rtol=1e-7, steps=50000, formulation=formulation,
                method="bdf", more="material: {shear_modulus: 1 GPa, shear_speed: 1 km/s}")
            slip[formulation] = done["mean_slip_m"]
        self.assertGreater(slip["rate"], 1e-2, slip)
        self.assertLess(abs(slip["traction"] / slip["rate"] - 1), 1e-3)
        self.assertLess(abs(slip["slip"] / slip["rate"] - 1), 1e-3)

    def fails_in_time(self, v, dc, failure, **changes):
        done = self.completes(v=v, dc=dc, failure=failure, **changes)
        self.assertTrue(done["failed"])
        # m = 2, x = 1/2: v theta/dc = 1/x, v x^2 = v*; T = -x - ln(1 - x) between the two x
        x = 0.5 * math.sqrt(v / failure)
        steady = 4 * dc / v
        exact = steady * ((math.log1p(-x) + x) - (math.log(0.5) + 0.5))
        self.assertLess(abs(done["failure_time_s"] / exact - 1), 2e-6)

    def test_rates_from_1e_minus_30(self):
        for formulation in "rate", "traction", "slip":
            self.fails_in_time(1e-30, 1e-17, 1e3, end=1e15, every=1e12, formulation=formulation)

    def test_slip_of_a_nanometre_and_of_a_metre(self):
        for dc in 1e-9, 1:
            self.fails_in_time(1e-9, dc, 1, end=1e10, every=1e9)

    def test_a_millisecond_and_a_million_years(self):
        self.fails_in_time(1, 1e-3, 1e3, end=1, every=1e-4)
        self.fails_in_time(3e-17, 1e-3, 1, end=1e15, every=1e13)

    def test_pressures(self):
        for pressure in 1e-3, 1e9:
            self.fails_in_time(1e-9, 1e-3, 1, pressure=pressure, end=1e8, every=1e6)

    def test_tolerances(self):
        for rtol in 1e-2, 1e-13:
            done = self.completes(rtol=rtol, every=1e5)
            exact = 4e6 * (math.log(2) - 0.5)
            self.assertLess(abs(done["failure_time_s"] / exact - 1), 0.1 if rtol > 1e-3 else 1e-8)

    def test_full_contact_tied_hard(self):
        more = ('interface: {size: "1 m", levels: 5, domain: {full: {}}}\n'
                'transfer: {hierarchy: {k0: "1e16 Pa/m"}}')
        self.fails_in_time(1e-9, 1e-3, 1, more=more, every=1e5)

    def test_a_step_of_ten_strengths(self):
        more = 'material: {shear_modulus: "30 GPa", shear_speed: "3 km/s"}'
        shear = ', shear: [{step: {value: "6 MPa", at: "1 s"}}]'
        for formulation in "rate", "traction", "slip":
            done = self.completes(more=more, shear=shear, every=1, formulation=formulation)
            self.assertTrue(done["failed"])
            self.assertEqual(done["failure_time_s"], 1.0)

    def test_a_step_beyond_numbers(self):
        shear = ', shear: [{step: {value: "600 MPa", at: "1 s"}}]'
        for formulation in "rate", "traction", "slip":
            self.breaks("slip rate of cell 0 overflows", shear=shear, every=1,
                        formulation=formulation)

    def test_too_few_steps(self):
        self.breaks("10 steps were not enough", steps=10)
        more = ('interface: {size: "4 m", levels: 2, domain: {full: {}}}\n'
                'transfer: {hierarchy: {k0: "1 MPa/m"}}')
        self.breaks("1 sweeps over the cells were not enough", steps=1, fidelity="events", more=more)

    def test_a_balance_that_is_off_names_what_mends_it(self):
        """With events neither another formulation nor projection does, which it does not have."""
        done = self.run_case(
            fidelity="events", rtol=0.01, end=4, dc=3e-6, b=0.015, v=1e-6, every=4, pressure=3e6,
            state="{ratio_to_steady: 0.9}, spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}",
            shear=", shear: [{spring: {stiffness: 9e11, speed: 1 um/s}}]",
            more='interface: {size: "8 m", levels: 3, domain: {full: {}}}\n'
                 'transfer: {hierarchy: {k0: "1 MPa/m", ratio: 0.5}}')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, "balance drifted by .* solver.fidelity: ode")
        self.assertNotIn("formulation", done.stderr)

    def test_a_balance_that_is_off_by_the_strength_is_no_result(self):
        """Of a run far too coarse; a tenth as coarse it is one again."""
        case = os.path.join(SOURCE, "cases", "lab-shear.yaml")
        for rtol, status in ("0.1", 1), ("0.001", 0):
            done = subprocess.run([PROGRAM, "run", case, "-o", os.path.join(self.folder, "out.nc"), "--force", "--json", "--set",
                                   f"solver.rtol={rtol}"], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertEqual(self.scan(), "failed" if status else "complete")
            self.assertEqual("mean nothing" in done.stderr, status == 1, done.stderr)
            self.assertEqual(json.loads(done.stdout)["balance_residual"] > 1, status == 1)

    def test_a_friction_of_nothing_at_v0(self):
        """f0 shifts the load at the start alone: the same failure, and a balance that holds."""
        failures = []
        for f0 in "0.6", "1e-300":
            done = subprocess.run([PROGRAM, "run", os.path.join(SOURCE, "cases", "block.yaml"), "-o", os.path.join(self.folder, "out.nc"), "--force",
                                   "--json", "--set", f"friction.aging.f0={f0}"], capture_output=True, text=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            failures.append(json.loads(done.stdout)["failure_time_s"])
            self.assertLess(json.loads(done.stdout)["balance_residual"], 1e-12)
        self.assertAlmostEqual(failures[1] / failures[0], 1, delta=1e-4)

    def test_checkpoints_too_close(self):
        """Told before with check, after with what they cost: nothing of 500 steps."""
        case = os.path.join(SOURCE, "cases", "block.yaml")
        for every, check, run in (("{steps: 10}", "a run can take 10 times the steps", "10 steps apart"),
                                  ("{steps: 500}", None, None),
                                  ("{time: 6 hour}", None, "steps apart")):
            words = ["--set", f"output.checkpoint={every}"]
            before = subprocess.run([PROGRAM, "check", case, *words], capture_output=True, text=True, timeout=60)
            after = subprocess.run([PROGRAM, "run", case, "-o", os.path.join(self.folder, "out.nc"), "--force", *words], capture_output=True,
                                   text=True, timeout=60)
            self.assertEqual((before.returncode, after.returncode), (0, 0))
            self.assertRegex(before.stderr, check or "^$")
            self.assertRegex(after.stderr, run or "^$")

    def test_no_direct_effect_and_no_damping(self):
        done = self.run_case(a=0, v=1e-9, state='"1e6 s"')
        self.assertIn(done.returncode, (1, 2), done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        if os.path.exists(self.output):
            self.assertEqual(self.scan(), "failed")


if __name__ == "__main__":
    PROGRAM, SOURCE = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
