#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The factor of safety and what stands beside it, against closed forms and the balance of the cells.

usage: test_safety.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import csv
import itertools
import json
import math
import os
import re
import sys
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

DAY, G = 86400.0, 9.80665
LAWS = list(itertools.product(("aging", "slip"), ("plain", "regularised")))

SLOPE = """\
lacuna: 1
load:
  normal: {slope: {thickness: "%(h)r m", angle: "%(beta)r degree"}}
  shear: [{slope: {angle: "%(beta)r degree"}}]
  pore_pressure: [{constant: {value: "%(u)r Pa"}}]
material: {density: "%(density)r kg/m3"}
friction: {%(law)s: {f0: %(f0)r, a: 0.010, b: 0.008, dc: "1 mm", v0: "1 mm/day", form: %(form)s, cohesion: "%(c)r Pa"}}
initial: {state: "1 day"}
time: {end: "1 day"}
"""

BLOCK = """\
lacuna: 1
load:
  normal: {pressure: "3 MPa"}
  pore_pressure: [{constant: {value: "0.4 MPa"}}, {ramp: {rate: "2 kPa/day"}}]
friction: {%(law)s: {f0: 0.6, a: 0.010, b: 0.015, dc: "1 mm", v0: "1 um/s", form: %(form)s}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.7}}
time: {end: "%(end)s"}
output: {factor_of_safety: {reference_rate: "1 cm/week"}}
"""

ROUGH = """\
lacuna: 1
interface:
  size: "32 m"
  levels: 5
  surface: {self-affine: {hurst: 0.8, rms_height: "1 cm", shortest: "4 m", seed: 1}}
material: {shear_modulus: "2 GPa", poisson: 0.25}
load:
  normal: {pressure: "3 MPa"}
  pore_pressure: [{constant: {value: "0.4 MPa"}}, {ramp: {rate: "2 kPa/day"}}]
friction:
  %(law)s: {f0: 0.6, a: 0.010, b: 0.015, dc: "1 mm", v0: "1 um/s", form: %(form)s}
  %(spread)s
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.7}, %(more)s}
transfer: {hierarchy: {stiffness: elastic}}
time: {end: "3 day"}
solver: {formulation: %(formulation)s, projection: true, rtol: 1e-8}
output: {factor_of_safety: {reference_rate: "%(reference)s"}, fields: [slip_rate, traction], fields_every: "1 day"}
"""


class Safety(Case):
    def follow(self, text, *words):
        """Runs a case, or one of `cases`: its summary, and its variables and attributes."""
        path = os.path.join(test_cli.SOURCE, "cases", text) if text.endswith(".yaml") else "case.yaml"
        if path == "case.yaml":
            self.write(path, text)
        done = self.expect(0, "run", path, "--json", "--force", "-o", "out.nc", *words)
        with netCDF4.Dataset(self.path("out.nc")) as data:
            data.set_auto_mask(False)
            series = {name: numpy.array(v[...]) for name, v in data.variables.items()}
            self.units = {name: v.units for name, v in data.variables.items()}
            self.attributes = {name: data.getncattr(name) for name in data.ncattrs()}
        return json.loads(done.stdout), series


class ClosedForm(Safety):
    def test_a_block_under_a_water_table(self):
        """F = [c + (gamma h cos^2(beta) - u) tan(phi)] / (gamma h sin(beta) cos(beta)), u = gamma_w h_w cos^2(beta), where
        the state at the start is that of steady slip at v0, the reference."""
        slopes = ((25, 30, 5, 32, 2200, 0), (12.5, 8, 7.5, 20, 1900, 5e3), (40, 200, 0, 45, 2650, 1e6))
        for (law, form), (beta, h, h_w, phi, density, c) in itertools.product(LAWS, slopes):
            with self.subTest(law=law, form=form, beta=beta):
                cos, sin = math.cos(math.radians(beta)), math.sin(math.radians(beta))
                u, gamma, tan = G * 1000 * h_w * cos**2, density * G, math.tan(math.radians(phi))
                expected = (c + (gamma * h * cos**2 - u) * tan) / (gamma * h * sin * cos)
                text = SLOPE % {"c": c, "h": h, "beta": beta, "u": u, "density": density, "law": law, "form": form, "f0": tan}
                summary, run = self.follow(text)
                for value in (summary["initial_factor_of_safety"], run["factor_of_safety"][0],
                              self.attributes["factor_of_safety_start"]):
                    self.assertLess(abs(value / expected - 1), 1e-12)
                effective = math.tan(math.radians(beta)) / (1 - u / (gamma * h * cos**2))
                self.assertLess(abs(summary["initial_effective_ratio"] / effective - 1), 1e-12)
                self.assertLess(abs(run["pore_pressure"][0] - u), 1e-9 * gamma * h)

    def test_the_bundled_case(self):
        summary, run = self.follow("load/safety.yaml")
        cos, sin = math.cos(math.radians(25)), math.sin(math.radians(25))
        expected = (2200 * G * 30 * cos**2 - 40275) * 0.62487 / (2200 * G * 30 * sin * cos)
        self.assertLess(abs(summary["initial_factor_of_safety"] / expected - 1), 1e-12)
        self.assertEqual(summary["ended_by"], "stop_when")
        self.assertLess(abs(summary["factor_of_safety"] / 1.05 - 1), 1e-12)
        self.assertLess(numpy.abs(run["pore_pressure"] - 40275 - 805.5 / DAY * run["time"]).max(), 1e-6)


class Balance(Safety):
    def test_it_is_one_at_the_present_rate_of_a_block(self):
        """At the start, and anywhere later, of runs that differ in the reference alone."""
        for law, form in LAWS:
            for end in ("2 day", "8 day"):
                with self.subTest(law=law, form=form, end=end):
                    text = BLOCK % {"law": law, "form": form, "end": end}
                    _, run = self.follow(text)
                    self.assertLess(abs(run["factor_of_safety"][0] - 1), 4e-16)
                    now = float(run["slip_rate"][-1])
                    _, again = self.follow(text, "--set", f"output.factor_of_safety.reference_rate={now!r} m/s")
                    self.assertEqual(again["slip_rate"].tobytes(), run["slip_rate"].tobytes())
                    self.assertLess(abs(again["factor_of_safety"][-1] - 1), 2 * again["balance_residual"][-1] + 1e-15)
                    self.assertEqual(self.attributes["factor_of_safety_reference_rate_m_s"], now)

    def test_it_is_one_at_the_present_rate_of_a_rough_joint(self):
        for law, form in LAWS:
            with self.subTest(law=law, form=form):
                _, run = self.follow(ROUGH % {"law": law, "form": form, "formulation": "auto", "spread": "",
                                              "reference": "1 cm/week", "more": ""})
                self.assertGreater(run["pressure"].size, 20)
                self.assertLess(abs(run["factor_of_safety"][0] - 1), 1e-14)
                self.assertLess(numpy.abs(run["cell_factor_of_safety"][0] - 1).max(), 1e-14)

    def test_a_slope_that_starts_at_the_reference_is_not_below_from_the_start(self):
        """Damping and rounding take some 1e-6 off the 1 that is told there."""
        text = (SLOPE % {"h": 60.0, "beta": 31.0, "u": 0.0, "density": 2700.0, "law": "aging", "f0": 0.6, "form": "plain", "c": 0.0}
                ).replace('b: 0.008', 'b: 0.015').replace('v0: "1 mm/day"', 'v0: "1 um/s"')
        text = text.replace('state: "1 day"', 'slip_rate: "1 um/s"').replace("material: {", 'material: {shear_modulus: "10 GPa", ')
        summary, run = self.follow(text)
        self.assertTrue(0 < 1 - run["factor_of_safety"][0] < 1e-5)
        below = summary["factor_of_safety_below_1_time_s"]
        self.assertGreater(below, 1)
        self.assertLess(abs(numpy.interp(below, run["time"], run["factor_of_safety"]) - 1), 1e-4)

    def test_with_cohesion_too(self):
        _, run = self.follow((ROUGH % {"law": "aging", "form": "plain", "formulation": "auto", "spread": "", "more": "",
                                       "reference": "1 cm/week"}).replace("f0: 0.6", "cohesion: 0.3 MPa, f0: 0.5"))
        self.assertLess(numpy.abs(run["cell_factor_of_safety"][0] - 1).max(), 1e-14)
        self.assertLess(abs(run["factor_of_safety"][0] - 1), 1e-14)

    def test_cohesion_under_loads_that_differ_in_time_and_place(self):
        """What holds a cell, at any time: p_i (1 + (s_i - u_i)/P) f + C p_i/P, and nothing of it but p_i feels the loads."""
        text = ROUGH % {"law": "aging", "form": "plain", "formulation": "rate", "spread": "", "more": "", "reference": "1 cm/week"}
        text = text.replace("f0: 0.6", "cohesion: 0.3 MPa, f0: 0.5").replace("fields: [", "fields: [state, pore_pressure, ")
        text = text.replace('{ramp: {rate: "2 kPa/day"}}]', """{ramp: {rate: "2 kPa/day"}},
    {water_table: {file: level.csv, time: t, column: "h:m", elevation: 5 m, angle: 20 degree}}]
  normal_stress: [{field: {file: heap.nc, variable: p}}, {ramp: {rate: "-30 kPa/day", start: "1 day"}}]""")
        self.write("level.csv", "t,h\n0,-5\n172800,5\n259200,0\n")
        with netCDF4.Dataset(self.path("heap.nc"), "w") as data:
            for axis, values, unit in (("time", [0, 259200], "s"), ("y", [0, 32], "m"), ("x", [0, 32], "m")):
                data.createDimension(axis, len(values))
                data.createVariable(axis, "f8", (axis,))[:] = values
                data[axis].units = unit
            data.createVariable("p", "f8", ("time", "y", "x"))[:] = [[[0, 0], [0, 0]], [[0, 4e5], [0, 4e5]]]
            data["p"].units = "Pa"
        _, run = self.follow(text)
        t, x, p = run["snapshot_time"][:, None], run["x"][None, :], run["pressure"][None, :]
        level = numpy.interp(t, [0, 172800, 259200], [-5, 5, 0])
        u = 0.4e6 + 2000 * t / DAY + 9806.65 * numpy.maximum(0, level + x * math.sin(math.radians(20)) - 5)
        s = 4e5 * t / 259200 * x / 32 - 3e4 * numpy.maximum(0, t / DAY - 1)
        self.assertGreater(numpy.ptp(u[-1]) + numpy.ptp(s[-1]), 4e5)
        numpy.testing.assert_allclose(run["cell_pore_pressure"], u, rtol=1e-12)
        effective, bond = p * (1 + (s - u) / 3e6), 3e5 * p / 3e6
        state = 0.015 * numpy.log(1e-6 * run["cell_state"] / 1e-3)
        holds = effective * (0.5 + 0.010 * numpy.log(run["cell_slip_rate"] / 1e-6) + state) + bond
        numpy.testing.assert_allclose(run["cell_traction"], holds, rtol=1e-9)
        strength = effective * (0.5 + 0.010 * math.log(0.01 / (7 * DAY) / 1e-6) + state) + bond
        numpy.testing.assert_allclose(run["cell_factor_of_safety"], strength / run["cell_traction"], rtol=1e-11)
        for k, at in enumerate(run["snapshot_time"]):
            i = int(numpy.argmin(numpy.abs(run["time"] - at)))
            force = (strength[k] * run["cell_area"]).sum()
            self.assertLess(abs(run["factor_of_safety"][i] * run["shear_force"][i] / force - 1), 1e-9)

    def test_under_water_that_differs_from_cell_to_cell(self):
        """A water table over half of the joint: each cell by its own pore pressure, and their mean by what each carries."""
        text = ROUGH % {"law": "aging", "form": "plain", "formulation": "rate", "spread": "", "more": "", "reference": "1 cm/week"}
        text = text.replace('{ramp: {rate: "2 kPa/day"}}', "{water_table: {level: 0 m, elevation: 5 m, angle: 20 degree}}")
        _, run = self.follow(text)
        self.assertTrue((run["water_level"] == 0).all())
        self.assertLess(numpy.abs(run["cell_factor_of_safety"][0] - 1).max(), 1e-14)
        self.assertLess(abs(run["factor_of_safety"][0] - 1), 1e-14)
        u = 0.4e6 + 9806.65 * numpy.maximum(0, run["x"] * math.sin(math.radians(20)) - 5)
        self.assertGreater(numpy.ptp(u), 2e4)
        force = run["pressure"] * run["cell_area"]
        self.assertLess(abs(run["pore_pressure"][0] / ((force * u).sum() / force.sum()) - 1), 1e-9)
        pressure = run["pressure"] * (1 - u * 32.0 ** 2 / force.sum())
        for traction, v, cells in zip(run["cell_traction"], run["cell_slip_rate"], run["cell_factor_of_safety"]):
            expected = 1 + 0.01 * pressure * numpy.log(0.01 / (7 * DAY) / v) / traction
            numpy.testing.assert_allclose(cells, expected, rtol=1e-9)

    def test_of_cells_that_differ(self):
        """Friction at the reference from the traction that each cell carries at its own rate: f grows by
        a ln(v_ref/v) in the plain form, sinh(f/a) in proportion to v in the regularised one."""
        spread = "spread: {f0: {normal: {sigma: 0.01, seed: 2}}, dc: {lognormal: {sigma: 0.3, seed: 3}}}"
        more = "spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 4}}}"
        formulations = {"plain": ("rate", "slip"), "regularised": ("traction",)}
        for law, form in LAWS:
            for formulation in formulations[form]:
                with self.subTest(law=law, form=form, formulation=formulation):
                    _, run = self.follow(ROUGH % {"law": law, "form": form, "formulation": formulation, "more": more,
                                                  "spread": spread, "reference": "1 mm/day"})
                    self.compare(run, form, 1e-3 / DAY)

    def compare(self, run, form, reference):
        area = run["cell_area"]
        nominal, total = 32.0 ** 2, (run["pressure"] * area).sum()
        for k, t in enumerate(run["snapshot_time"]):
            u = 0.4e6 + 2e3 / DAY * t
            pressure = run["pressure"] * (1 - u * nominal / total)
            traction, v = run["cell_traction"][k], run["cell_slip_rate"][k]
            f = traction / pressure
            f = f + 0.01 * numpy.log(reference / v) if form == "plain" else \
                0.01 * numpy.arcsinh(reference / v * numpy.sinh(f / 0.01))
            cells = run["cell_factor_of_safety"][k]
            numpy.testing.assert_allclose(cells, pressure * f / traction, rtol=1e-9)
            record = numpy.argmin(numpy.abs(run["time"] - t))
            if run["time"][record] != t:
                continue
            whole = (pressure * f * area).sum() / (traction * area).sum()
            self.assertLess(abs(run["factor_of_safety"][record] / whole - 1), 1e-9)
            self.assertLess(abs(run["effective_ratio"][record] / ((traction * area).sum() / (pressure * area).sum()) - 1),
                            1e-9)
            self.assertLess(abs(run["pore_pressure"][record] / u - 1), 1e-9)
        self.assertGreater(numpy.ptp(run["cell_factor_of_safety"][0]), 1e-3)

    def test_what_drives_under_a_spring_is_what_it_has_left(self):
        text = BLOCK % {"law": "aging", "form": "plain", "end": "20 day"}
        text = text.replace("  pore_pressure:", "  shear: [{spring: {stiffness: 50 MPa/m, speed: 2 cm/week}}]\n"
                            "  pore_pressure:")
        _, run = self.follow(text)
        now = float(run["slip_rate"][-1])
        _, run = self.follow(text, "--set", f"output.factor_of_safety.reference_rate={now!r} m/s")
        self.assertLess(abs(run["factor_of_safety"][-1] - 1), 2 * run["balance_residual"][-1] + 1e-15)
        driven = run["shear_force"][0] + 50e6 * (0.02 / (7 * DAY) * run["time"][-1] - run["slip"][-1])
        self.assertLess(abs(run["shear_force"][-1] / driven - 1), 1e-9)
        self.assertGreater(abs(driven / run["shear_force"][0] - 1), 0.01)


class Stop(Safety):
    def test_it_ends_where_the_factor_comes_down(self):
        for law, form in LAWS:
            text = BLOCK % {"law": law, "form": form, "end": "60 day"}
            _, run = self.follow(text, "--set", "time.stop_when.factor_of_safety=0.97")
            self.assertLess(abs(run["factor_of_safety"][-1] - 0.97), 1e-12)
            self.assertTrue((run["factor_of_safety"][:-1] > 0.97).all())
            summary, fine = self.follow(text, "--set", "time.stop_when.factor_of_safety=0.97", "--set", "solver.rtol=1e-9")
            self.assertLess(abs(run["time"][-1] / fine["time"][-1] - 1), 1e-4)
            self.assertEqual((summary["ended_by"], summary["failed"]), ("stop_when", False))

    def test_a_jump_ends_it_where_it_comes(self):
        text = (BLOCK % {"law": "aging", "form": "plain", "end": "60 day"}).replace(
            "{ramp: {rate: \"2 kPa/day\"}}", "{step: {value: 1 kPa, at: 0.5 day}}, {step: {value: 0.2 MPa, at: 1 day}}")
        summary, run = self.follow(text, "--set", "time.stop_when.factor_of_safety=0.95",
                                   "--set", "output.factor_of_safety.reference_rate=3 cm/week")
        self.assertEqual((summary["ended_by"], summary["time_s"]), ("stop_when", DAY))
        self.assertLess(run["factor_of_safety"][-1], 0.95)
        self.assertTrue((run["factor_of_safety"][:-1] > 1).all())
        self.assertEqual(summary["factor_of_safety_below_1_time_s"], DAY)

    def test_the_first_limit_ends_it(self):
        text = BLOCK % {"law": "aging", "form": "plain", "end": "60 day"}
        stops = ("--set", "time.stop_when.factor_of_safety=0.97", "--set", "time.stop_when.mean_slip=1 mm")
        summary, run = self.follow(text, *stops)
        self.assertLess(abs(summary["mean_slip_m"] - 1e-3), 1e-12)
        self.assertGreater(run["factor_of_safety"][-1], 0.97)

    def refused(self, text, words, *options):
        self.write("case.yaml", text)
        done = self.expect(2, "run", "case.yaml", "-o", "out.nc", *options)
        self.assertRegex(done.stderr, words)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def test_what_cannot_be_is_refused(self):
        text = BLOCK % {"law": "aging", "form": "plain", "end": "60 day"}
        set_stop = "time.stop_when.factor_of_safety="
        rate = "output.factor_of_safety.reference_rate="
        self.refused(text, "the factor of safety at the start, 1, is not above the one to stop at, 1.05",
                     "--set", set_stop + "1.05")
        self.refused(text, r'factor_of_safety: "0" must be > 0', "--set", set_stop + "0")
        self.refused(text, r'factor_of_safety: "nan"', "--set", set_stop + "nan")
        self.refused(text, r'reference_rate: "0 m/s" must be > 0', "--set", rate + "0 m/s")
        self.refused(text, r'reference_rate: "1 kg" must be a speed such as "1 mm/day"', "--set", rate + "1 kg")
        self.refused(text, "output.factor_of_safety.reference_rate must be faster", "--set", rate + "1e-40 m/s")
        self.refused(text.replace('{reference_rate: "1 cm/week"}', "1 cm/week"), r"must be a mapping such as \{reference_rate")
        self.refused(text.replace("reference_rate", "refrence_rate"), 'did you mean "reference_rate"')
        events = ROUGH % {"law": "aging", "form": "plain", "formulation": "auto", "spread": "", "more": "",
                          "reference": "1 mm/day"}
        self.refused(events, "time.stop_when.factor_of_safety: .*goes with fidelity ode, not with events",
                     "--set", "solver.fidelity=events", "--set", set_stop + "0.5")


class Written(Safety):
    SLOPE = {"c": 0, "h": 30, "beta": 25, "u": 4e4, "density": 2200, "law": "aging", "form": "plain", "f0": 0.62}

    def test_only_where_asked(self):
        plain = re.sub(r"output: .*\n", "", BLOCK % {"law": "aging", "form": "plain", "end": "1 day"})
        summary, run = self.follow(plain)
        self.assertFalse([name for name in [*run, *summary, *self.attributes] if "factor_of_safety" in name])
        self.assertTrue({"effective_ratio", "pore_pressure"} <= set(run))
        summary, run = self.follow(re.sub(r"  pore_pressure: .*\n", "", plain))
        self.assertEqual({"effective_ratio", "pore_pressure", "factor_of_safety"} & set(run), set())
        self.assertFalse([name for name in summary if "effective_ratio" in name])
        for asked in ("output: {factor_of_safety: {}}", "output: {fields: [factor_of_safety], fields_every: 1 day}",
                      "load: {normal: {depth: {value: 100 m}}, shear: [{slope: {angle: 25 degree}}]}\n"
                      "material: {density: 2200 kg/m3}\ninitial: {state: 1 day}"):
            text = plain + asked + "\n"
            if asked.startswith("load"):
                text = re.sub(r"(load:\n(  .*\n)*|initial: .*\n)", "", plain) + asked + "\n"
            _, run = self.follow(text)
            self.assertIn("factor_of_safety", run, asked)
            self.assertEqual("cell_factor_of_safety" in run, "fields" in asked)
            self.assertNotIn("factor_of_safety_reference_rate_m_s", self.attributes)

    def test_maps_of_a_slope_have_it(self):
        _, run = self.follow(SLOPE % self.SLOPE + "output: {fields: [slip]}\n")
        self.assertEqual(run["cell_factor_of_safety"].shape, run["cell_slip"].shape)
        self.assertLess(abs(run["cell_factor_of_safety"][0, 0] / run["factor_of_safety"][0] - 1), 1e-14)

    def test_the_resolved_case_asks_the_same(self):
        for text in (SLOPE % self.SLOPE, BLOCK % {"law": "aging", "form": "plain", "end": "1 day"},
                     (BLOCK % {"law": "aging", "form": "plain", "end": "1 day"}).replace("reference_rate: \"1 cm/week\"", "")):
            _, run = self.follow(text)
            _, again = self.follow(self.attributes["case"])
            self.assertEqual(run["factor_of_safety"].tobytes(), again["factor_of_safety"].tobytes())

    def test_it_sums_up_what_the_records_have(self):
        text = BLOCK % {"law": "aging", "form": "plain", "end": "60 day"}
        summary, run = self.follow(text, "--set", "output.factor_of_safety.reference_rate=3 cm/week")
        factor, t = run["factor_of_safety"], run["time"]
        low = int(numpy.argmin(factor))
        first = int(numpy.argmax(factor < 1))
        crossed = numpy.interp(1.0, [factor[first], factor[first - 1]], [t[first], t[first - 1]])
        self.assertGreater(first, 0)
        self.assertEqual((summary["least_factor_of_safety"], summary["least_factor_of_safety_time_s"]), (factor[low], t[low]))
        self.assertEqual((summary["initial_factor_of_safety"], summary["factor_of_safety"]), (factor[0], factor[-1]))
        self.assertLess(abs(summary["factor_of_safety_below_1_time_s"] / crossed - 1), 1e-12)
        # the block reaches the reference where its factor is 1
        self.assertLess(abs(numpy.interp(crossed, t, run["slip_rate"]) / (0.03 / (7 * DAY)) - 1), 0.02)
        said = self.expect(0, "run", "case.yaml", "--force", "-o", "out.nc").stdout
        self.assertRegex(said, r"factor of safety     1 at the start, .* at the end, strength at 1 cm/week")
        self.assertRegex(said, r"  below 1            from the start")
        said = self.expect(0, "run", "case.yaml", "--force", "-o", "out.nc", "--set",
                           "output.factor_of_safety.reference_rate=3 cm/week").stdout
        self.assertRegex(said, r"  below 1            first after ")


class Water(Safety):
    def readings(self, name, column):
        with open(os.path.join(test_cli.SOURCE, "cases", "data", name), encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        dates = numpy.array([row["date"][:10] for row in rows], dtype="datetime64[s]").astype(float)
        return dates, numpy.array([float(row[column]) for row in rows])

    def test_the_level_of_the_lake(self):
        _, run = self.follow("load/reservoir.yaml")
        t, level = self.readings("lake.csv", "level_m")
        start = numpy.datetime64("1961-01-01", "s").astype(float)
        self.assertEqual(self.units["lake_level"], "m")
        numpy.testing.assert_allclose(run["lake_level"], numpy.interp(run["time"], t - start, level), rtol=1e-12)
        self.assertGreater(numpy.ptp(run["lake_level"]), 10)

    def test_below_the_interface_and_of_two_lakes(self):
        """The level is told as it is read, where it is below the interface too; a second lake has its own."""
        self.write("two.csv", "day,a,b\n0,-4,10\n2,4,10\n4,-4,30\n")
        lake = "{reservoir: {file: two.csv, time: day, level: \"%s:m\", elevation: 0 m, share: 0.1}}"
        self.write("two.csv", "s,a,b\n0,-4,10\n172800,4,10\n345600,-4,30\n")
        text = BLOCK.replace("{ramp: {rate: \"2 kPa/day\"}}", ", ".join(lake.replace("day,", "s,") % x for x in "ab"))
        text = text.replace("time: day", "time: s")
        _, run = self.follow(text % {"law": "aging", "form": "plain", "end": "4 day"})
        a = 4 - 4 * numpy.abs(run["time"] / DAY - 2)
        b = 10 + 10 * numpy.maximum(run["time"] / DAY - 2, 0)
        numpy.testing.assert_allclose(run["lake_level"], a, atol=1e-9)
        numpy.testing.assert_allclose(run["lake_level_2"], b, atol=1e-9)
        expected = 0.4e6 + 0.1 * 9806.65 * (numpy.maximum(a, 0) + b)
        numpy.testing.assert_allclose(run["pore_pressure"], expected, rtol=1e-12)

    def test_rain(self):
        """What fell over a day, from its beginning on."""
        self.write("rain.csv", "s,mm\n86400,10\n172800,0\n259200,5\n345600,0\n")
        text = (BLOCK % {"law": "aging", "form": "plain", "end": "4 day"}).replace(
            "{ramp: {rate: \"2 kPa/day\"}}",
            "{rain: {file: rain.csv, time: s, rain: \"mm:mm\", rise: 0 Pa/m, drain: 3 day, interval: 1 day, offset: 0.5 day, "
            "outside: dry}}")
        _, run = self.follow(text)
        self.assertTrue((run["time"] < 0.5 * DAY).any())
        day = numpy.minimum(numpy.floor(run["time"] / DAY - 0.5), 3).astype(int)
        numpy.testing.assert_allclose(run["rain"], numpy.array([10, 0, 5, 0, 0])[day] * 1e-3 / DAY, rtol=1e-12)
        self.assertEqual(self.units["rain"], "m s-1")


class Page(Safety):
    def page(self, case, *words):
        self.follow(case, *words)
        self.expect(0, "report", "out.nc", "-o", "page.html", "--force")
        with open(self.path("page.html"), encoding="utf-8") as file:
            found = re.search(r'<script[^>]*type="application/json"[^>]*>(.*?)</script>', file.read(), re.S)
        return json.loads(found.group(1))

    def test_safety_and_water_stand_below_the_motion(self):
        page = self.page("load/reservoir.yaml")
        keys = list(page)
        self.assertEqual(keys[keys.index("motion") + 1], "safety")
        self.assertEqual(set(page["safety"]) - {"records", "time", "before"}, {"factor", "ratio", "pore", "lake"})
        self.assertEqual(len(page["safety"]["factor"]), len(page["safety"]["time"]))
        self.assertLess(page["about"]["factor_of_safety_least"], 1.01)

    def test_rain(self):
        self.assertEqual(set(self.page("load/rain.yaml")["safety"]) - {"records", "time", "before"}, {"ratio", "pore", "rain"})


if __name__ == "__main__":
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
