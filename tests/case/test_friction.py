#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases of cases/friction show what they say, against closed forms and quadratures.

usage: test_friction.py PROGRAM SOURCE_FOLDER [unittest options]
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
F0, A, V0 = 0.6, 0.010, 1e-6


def integral(f, low, high, pieces=400):
    """Of f over [low, high] by Gauss's rule in ln x."""
    nodes, weights = numpy.polynomial.legendre.leggauss(12)
    ends = numpy.linspace(math.log(low), math.log(high), pieces + 1)
    total = 0.0
    for a, b in zip(ends[:-1], ends[1:]):
        x = numpy.exp(0.5 * (a + b) + 0.5 * (b - a) * nodes)
        total += 0.5 * (b - a) * float(numpy.sum(weights * x * f(x)))
    return total


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def run_case(self, name, *words):
        case = os.path.join(SOURCE, "cases", "friction", name + ".yaml")
        self.output = os.path.join(self.folder, name + ".nc")
        done = subprocess.run(
            [PROGRAM, "run", case, "-o", self.output, "--force", "--json", "--no-progress", *words],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def variable(self, name):
        with netCDF4.Dataset(self.output) as file:
            return numpy.array(file.variables[name][:])

    def near(self, value, exact, part):
        self.assertLess(abs(value / exact - 1), part, f"{value}, not {exact}")


class Friction(Case):
    def test_aging(self):
        done = self.run_case("aging", "--set", "solver.rtol=1e-9")
        self.assertTrue(done["failed"])
        # m = 2: -x - ln(1 - x) times dc/v*, v* = v x^2
        week = 7 * 86400.0
        self.near(done["failure_time_s"], (-0.9 - math.log(0.1)) * 0.7 * week / 0.81, 1e-6)

    def test_rock(self):
        self.assertFalse(self.run_case("rock", "--set", "solver.rtol=1e-9")["failed"])
        # steady: f0 + (a - b) ln(v/v0) is the load
        self.near(self.variable("slip_rate")[-1], 1e-6 * math.exp((0.6082 - 0.608) / (0.00913 - 0.00907)), 1e-6)

    def test_cohesion(self):
        self.run_case("cohesion", "--set", "solver.rtol=1e-9", "--set", "time.end=100 day")
        # steady again after ten days of rising water: (0.57 P - C)/(P - u) = f0 + (a - b) ln(v/v0)
        f = (0.57 * 5e6 - 1e5) / (5e6 - 1e5)
        self.near(self.variable("slip_rate")[-1], 1e-6 * math.exp((f - math.tan(math.pi / 6)) / 0.002), 1e-6)

    def test_slip(self):
        done = self.run_case("slip", "--set", "solver.rtol=1e-9")
        low = -2 * math.log(0.9)
        e1 = integral(lambda x: numpy.exp(-x) / x, low, 60.0)
        week = 7 * 86400.0
        self.near(done["failure_time_s"], e1 * 0.7 * week / 0.81, 1e-6)

    def test_composite(self):
        done = self.run_case("composite", "--set", "solver.rtol=1e-9")
        v, dc = 1e-8, 1e-4

        def pace(theta):
            rate = v * (2e4 / theta) ** 1.5
            z = rate * theta / dc
            return 1 / (z * numpy.log(z) - numpy.exp(-rate / v))

        end = 2e4 * (v / 1.0) ** (1 / 1.5)  # at 1 m/s
        self.near(done["failure_time_s"], integral(pace, end, 2e4), 1e-6)

    def test_regularised(self):
        self.run_case("regularised", "--set", "solver.rtol=1e-9")
        theta, b, dc = 3600.0, 0.015, 1e-4

        def rate(age):
            psi = F0 + b * math.log(V0 * age / dc)
            return 2 * V0 * math.sinh(0.06 / A) * math.exp(-psi / A)

        seen, times = self.variable("slip_rate"), self.variable("time")
        self.near(seen[0], rate(theta), 1e-9)
        self.near(seen[-1], rate(theta + times[-1]), 1e-5)

    # A block of constant friction f0 that flash heating takes down to f_w, under the load mu of its weight:
    # m dv/dt = p (mu - f_w - (f0 - f_w)/(1 + v/v_w)), which is integrated in closed form.
    def test_flash(self):
        done = self.run_case("flash", "--set", "solver.rtol=1e-7", "--set", "friction.aging.a=1e-5", "--set",
                             "friction.aging.b=1e-5", "--set", "friction.aging.f0=0.58")
        self.assertEqual(done["ended_by"], "slip")
        p, m, v_w, f_w, mu = 2e6, 2.6e5, 0.1, 0.2, 0.58 + 3e5 / 2e6
        f0 = 0.58
        strong, lost = mu - f_w, f0 - f_w

        def time(v):
            x = 1 + v / v_w
            return m * v_w / (p * strong) * (x + lost / strong * numpy.log(strong * x - lost))

        t, v = self.variable("time_origin") + self.variable("time_local"), self.variable("slip_rate")
        fast = v > 0.01
        self.assertGreater(v[-1], 50)
        self.assertGreater(numpy.count_nonzero(fast), 100)
        gone, exact = t[fast] - t[fast][0], time(v[fast]) - time(v[fast][0])
        self.assertLess(numpy.max(numpy.abs(gone - exact)), 1e-4 * gone[-1])

    def test_flash_needs_inertia(self):
        case = os.path.join(self.folder, "case.yaml")
        with open(os.path.join(SOURCE, "cases/friction/flash.yaml"), encoding="utf-8") as source:
            text = "".join(line for line in source if not line.startswith("inertia"))
        with open(case, "w", encoding="utf-8") as file:
            file.write(text)
        done = subprocess.run([PROGRAM, "check", case], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("friction.aging.flash_rate: \"10 cm/s\" needs the section inertia", done.stderr)

    def test_cut_off(self):
        done = self.run_case("cut-off", "--set", "solver.rtol=1e-9")
        self.assertFalse(done["failed"])
        b, dc, v2 = 0.015, 1e-4, 1e-4

        def f(v, theta):
            return F0 + A * math.log(v / V0) + b * math.log(V0 * theta / dc + V0 / v2)

        with netCDF4.Dataset(self.output) as file:
            load = float(file.variables["apparent_friction"][0])
        low, high = v2 * (b / A - 1), 1.0  # rising from the least steady friction
        for _ in range(100):
            middle = math.sqrt(low * high)
            low, high = (middle, high) if f(middle, dc / middle) < load else (low, middle)
        self.near(self.variable("slip_rate")[-1], low, 1e-6)

    def test_normal_stress(self):
        self.assertFalse(self.run_case("normal-stress", "--set", "solver.rtol=1e-9")["failed"])
        self.run_case("normal-stress", "--set", "solver.rtol=1e-9", "--set", "time.end=3 day", "--set",
                      "output.every=1 minute")
        # the step jumps the rate by [q/p1 - q/p0 + alpha ln(p1/p0)]/a
        rate, normal = self.variable("slip_rate"), self.variable("effective_normal_force")
        after = int(numpy.argmax(normal < normal[0]))
        shear = self.variable("shear_force")[0]
        p0, p1 = normal[0], normal[after]
        gain = shear / p1 - shear / p0 + 0.2 * math.log(p1 / p0)
        times = self.variable("time")
        order = slice(after - 3, after)  # records before, from which ln v goes on to the step
        before = numpy.polyfit(times[order] - times[after], numpy.log(rate[order]), 2)[-1]
        self.near(math.log(rate[after]) - before, gain / A, 0.01)
        done = self.run_case("normal-stress", "--set", "friction.aging.alpha=0")
        self.assertTrue(done["failed"])

    def start_states(self):
        """dc of every cell, from states that start proportional to it."""
        state = self.variable("cell_state")[0]
        return state / (0.8 ** (1 - 0.014 / 0.010) / (1e-3 / 86400))

    def test_map(self):
        self.run_case("map", "--until", "1 s", "--set",
                      "friction.spread.dc={map: {file: ../data/dc_16.nc, variable: dc}}")
        with netCDF4.Dataset(os.path.join(SOURCE, "cases", "data", "dc_16.nc")) as file:
            dc = 1e-3 * numpy.array(file.variables["dc"][:], dtype=float)
        x, y = self.variable("x").astype(int), self.variable("y").astype(int)
        self.assertLess(numpy.max(numpy.abs(self.start_states() / dc[y, x] - 1)), 1e-6)
        # times a distribution, as the case has it
        self.run_case("map", "--until", "1 s")
        self.near(float(numpy.std(numpy.log(self.start_states() / dc[y, x]))), 0.05, 0.2)

    def test_size(self):
        self.run_case("size", "--until", "1 s")
        side = 32.0 / 64
        place = [(int(x / side), int(y / side))
                 for x, y in zip(self.variable("x"), self.variable("y"))]
        patch, left = {}, set(place)
        while left:  # flood fill over sides and corners, round the edges
            found, front = set(), [left.pop()]
            while front:
                here = front.pop()
                found.add(here)
                for dx in (-1, 0, 1):
                    for dy in (-1, 0, 1):
                        there = ((here[0] + dx) % 64, (here[1] + dy) % 64)
                        if there in left:
                            left.remove(there)
                            front.append(there)
            patch.update({here: len(found) for here in found})
        dc = numpy.array([1e-4 * side * math.sqrt(patch[here]) for here in place])
        self.assertLess(numpy.max(numpy.abs(self.start_states() / dc - 1)), 1e-6)
        self.assertGreater(len(set(patch.values())), 3)

    def test_spread(self):
        done = self.run_case("spread")
        self.assertTrue(done["failed"])
        slip = self.variable("cell_slip")[-1]
        self.assertGreater(float(slip.max() / slip.min()), 1.0001)




class Stated(Case):
    """Strength as an engineer states it, against the same stated otherwise and a slider of its own."""

    def setUp(self):
        super().setUp()
        self.case = os.path.join(self.folder, "case.yaml")
        self.output = os.path.join(self.folder, "out.nc")

    def run_law(self, law, loads, *words, status=0):
        with open(self.case, "w", encoding="utf-8") as file:
            file.write('lacuna: 1\nload:\n  normal: {pressure: "5 MPa"}\n' + loads + "friction: {aging: {" + law +
                       '}}\ninitial: {slip_rate: "1 nm/s"}\ntime: {end: "20 day"}\nsolver: {rtol: 1e-9}\n')
        done = subprocess.run([PROGRAM, "run", self.case, "-o", self.output, "--force", "--no-progress", *words],
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def everything(self):
        return {name: self.variable(name) for name in ("time", "slip", "slip_rate", "shear_force")}

    RATIO = "  shear: [{ratio: {value: 0.57}}]\n"
    RAMP = RATIO + '  pore_pressure: [{ramp: {rate: "10 kPa/day", end: "10 day"}}]\n'
    JOINT = """interface: {size: "8 m", levels: 3, domain: {cascade: {dimension: 1.7, seed: 3}},
  spread: {pressure: {lognormal: {sigma: 0.5, seed: 4}}}}
transfer: {hierarchy: {k0: "1 GPa/m", ratio: 0.5}}
"""

    def describe(self, *words):
        return subprocess.run([PROGRAM, "describe", "rock", *words], check=True, stdout=subprocess.PIPE,
                              universal_newlines=True).stdout

    def test_every_rock_names_what_was_read(self):
        rocks, listed = json.loads(self.describe("--json"))["rocks"], self.describe()
        names = [rock["name"] for rock in rocks]
        self.assertEqual(names, sorted(set(names)))
        self.assertGreaterEqual(len(names), 12)
        for rock in rocks:
            self.assertEqual(json.loads(self.describe(rock["name"], "--json"))["rocks"], [rock])
            self.assertIn(f"\n  {rock['name']} ", listed)
            self.assertRegex(rock["read_at"], r"^https?://\S+$")
            self.assertRegex(rock["source"], r"(19|20)\d\d|doi 10\.")
            self.assertTrue(rock["summary"] and rock["conditions"])
            self.assertIn(rock["found"], ("laboratory", "back-analysed in the field"))
            told = [rock[key] for key in ("f0", "a", "b", "dc", "a_minus_b") if rock[key]["value"] is not None]
            self.assertIn(rock["f0"], told)
            for number in told:
                self.assertTrue(number["low"] <= number["value"] <= number["high"], rock)
        limestone = rocks[names.index("limestone")]["f0"]  # 31 degree, between 27 wet and 37 dry
        for key, angle in (("value", 31), ("low", 27), ("high", 37)):
            self.near(limestone[key], math.tan(math.radians(angle)), 1e-12)

    def test_angle_is_f0(self):
        self.run_law('friction_angle: "30 degree", a: 0.02, b: 0.01, dc: "1 mm"', self.RATIO)
        angle = self.everything()
        self.run_law(f'f0: {math.tan(math.pi / 6):.17g}, a: 0.02, b: 0.01, dc: "1 mm"', self.RATIO)
        for name, values in self.everything().items():
            numpy.testing.assert_allclose(values, angle[name], rtol=1e-9, err_msg=name)

    def test_rock_tells_what_the_case_does_not(self):
        self.run_law("rock: basalt-fault, b: 0.008", self.RATIO)
        with netCDF4.Dataset(self.output) as file:
            text = file.case
        told = json.loads(subprocess.run([PROGRAM, "describe", "rock", "basalt-fault", "--json"], check=True,
                                         stdout=subprocess.PIPE).stdout)["rocks"][0]
        for line in ("rock: basalt-fault", f"f0: {told['f0']['value']!r}", f"a: {told['a']['value']!r}", "b: 0.008"):
            self.assertIn("    " + line + "\n", text)
        self.assertIn(f"dc: \"{told['dc']['value']!r} m\"\n", text)

    def test_rock_tells_the_other_of_a_and_b(self):
        self.run_law('rock: talc-gouge, a: 0.03, dc: "1 mm"', "  shear: [{ratio: {value: 0.2}}]\n")
        with netCDF4.Dataset(self.output) as file:
            text = file.case
        self.near(float(text.split("    b: ")[1].split()[0]), 0.03 - 0.025, 1e-12)
        self.run_law('rock: talc-gouge, b: 0.03, dc: "1 mm"', "  shear: [{ratio: {value: 0.2}}]\n")
        with netCDF4.Dataset(self.output) as file:
            text = file.case
        self.near(float(text.split("    a: ")[1].split()[0]), 0.03 + 0.025, 1e-12)

    # Under a constant normal load cohesion is friction: C/p more of f0, also of cells whose pressures differ.
    def test_cohesion_is_friction_under_constant_load(self):
        for joint in ("", self.JOINT):
            self.run_law('f0: 0.55, cohesion: "100 kPa", a: 0.02, b: 0.01, dc: "1 mm"', self.RATIO + joint)
            with_cohesion = self.everything()
            self.run_law('f0: 0.57, a: 0.02, b: 0.01, dc: "1 mm"', self.RATIO + joint)
            for name, values in self.everything().items():
                numpy.testing.assert_allclose(with_cohesion[name][-1], values[-1], rtol=1e-7, err_msg=name)

    # Pore pressure takes off friction, not cohesion: a slider of one unknown, theta.
    def test_cohesion_does_not_feel_pore_pressure(self):
        f0, a, b, dc, v0, cohesion, sigma = 0.55, 0.02, 0.01, 1e-3, 1e-6, 1e5, 5e6
        for formulation in ("rate", "traction", "slip"):
            self.run_law('f0: 0.55, cohesion: "100 kPa", a: 0.02, b: 0.01, dc: "1 mm", v0: "1 um/s"' +
                         (", form: regularised" if formulation != "rate" else ""), self.RAMP,
                         "--set", "solver.formulation=" + formulation)
            time, slip = self.variable("time"), self.variable("slip")
            numpy.testing.assert_allclose(self.variable("shear_force"), 0.57 * sigma, rtol=1e-9)  # of 1 m2

            def rate(t, log_theta):
                effective = sigma - 1e4 * min(t, 864e3) / 86400
                f = (0.57 * sigma - cohesion) / effective
                return v0 * math.exp((f - f0 - b * (math.log(v0 / dc) + log_theta)) / a)

            def change(t, y):
                v = rate(t, y[0])
                return numpy.array([math.exp(-y[0]) - v / dc, v])

            y = numpy.array([((0.57 * sigma - cohesion) / sigma - f0 - a * math.log(1e-9 / v0)) / b -
                             math.log(v0 / dc), 0.0])
            steps, t = 20000, 0.0
            pace = time[-1] / steps
            for _ in range(steps):
                k1 = change(t, y)
                k2 = change(t + pace / 2, y + pace / 2 * k1)
                k3 = change(t + pace / 2, y + pace / 2 * k2)
                k4 = change(t + pace, y + pace * k3)
                y, t = y + pace / 6 * (k1 + 2 * k2 + 2 * k3 + k4), t + pace
            self.near(slip[-1], y[1], 1e-6)

    def test_tractions_add_up_to_the_force(self):
        self.run_law('f0: 0.55, cohesion: "100 kPa", a: 0.02, b: 0.01, dc: "1 mm"', self.RAMP + self.JOINT,
                     "--set", "output.fields=[traction]")
        force, area = self.variable("shear_force"), self.variable("cell_area")
        sums = (self.variable("cell_traction") * area).sum(axis=1)
        numpy.testing.assert_allclose(sums[[0, -1]], force[[0, -1]], rtol=1e-8)
        numpy.testing.assert_allclose(force, 0.57 * 5e6 * 64, rtol=1e-8)

    # Limit equilibrium: ((p - u) f + C)/tau, f at v0 in the state that carries the load at the rate of the start.
    def test_cohesion_counts_in_the_factor_of_safety(self):
        self.run_law('f0: 0.55, cohesion: "100 kPa", a: 0.02, b: 0.01, dc: "1 mm", v0: "1 um/s"', self.RAMP,
                     "--set", "output.factor_of_safety.reference_rate=1 nm/s")
        safety, rate = self.variable("factor_of_safety"), self.variable("slip_rate")
        self.near(safety[0], 1.0, 1e-12)
        self.assertLess(safety[-1], 1.0)
        effective = self.variable("effective_normal_force")  # friction.md (1): f(v_ref) = f - a ln(v/v_ref)
        f = (0.57 * 5e6 - 1e5) / effective - 0.02 * numpy.log(rate / 1e-9)
        numpy.testing.assert_allclose(safety, (effective * f + 1e5) / (0.57 * 5e6), rtol=1e-7)

    def test_what_cohesion_holds_is_said(self):
        said = self.run_law('f0: 0.55, cohesion: "3 MPa", a: 0.02, b: 0.01, dc: "1 mm"', self.RATIO, status=2)
        self.assertIn("cohesion 3e+06 Pa holds the shear load of 2.85e+06 Pa", said)
        falls = '  shear: [{ratio: {value: 0.4}}, {ramp: {rate: "-1 MPa/day"}}]\n'
        for form, formulation in (("plain", "rate"), ("regularised", "traction"), ("regularised", "slip")):
            said = self.run_law(f'f0: 0.4, cohesion: "1 MPa", a: 0.02, b: 0.01, dc: "1 mm", form: {form}', falls,
                                "--set", "solver.formulation=" + formulation, status=1)
            self.assertIn("falls to its cohesion", said)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
