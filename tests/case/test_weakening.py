#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What weakens cells besides friction, from the case to the file, against closed forms.

usage: test_weakening.py PROGRAM SOURCE_FOLDER [unittest options]
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
DAY = 86400.0


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.case = os.path.join(self.folder, "case.yaml")
        self.output = os.path.join(self.folder, "out.nc")

    def call(self, *words):
        return subprocess.run([PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True)

    def run_file(self, path, *words):
        done = self.call("run", path, "-o", self.output, "--force", "--json", "--no-progress", *words)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def bundled(self, name, *words):
        return self.run_file(os.path.join(SOURCE, "cases", "weakening", name + ".yaml"), *words)

    def run_text(self, text, *words):
        with open(self.case, "w", encoding="utf-8") as file:
            file.write("lacuna: 1\n" + text)
        return self.run_file(self.case, *words)

    def refused(self, text):
        with open(self.case, "w", encoding="utf-8") as file:
            file.write("lacuna: 1\n" + text)
        done = self.call("check", self.case)
        self.assertEqual(done.returncode, 2, done.stdout)
        return done.stderr

    def variable(self, name):
        with netCDF4.Dataset(self.output) as file:
            return numpy.array(file.variables[name][:])

    def time(self):
        return self.variable("time_origin") + self.variable("time_local")


class Bridges(Case):
    # Under a constant stress dD/dt is constant, and the bridges last (tau_c/tau)^n/A.
    def test_time_to_break(self):
        for formulation in ("rate", "traction", "slip"):
            self.bundled("bridges", "--set", "solver.rtol=1e-9", "--set", f"solver.formulation={formulation}")
            lasts = (1.0 / 0.9) ** 20 * 10 * DAY
            t, broken, v = self.time(), self.variable("broken_cohesion"), self.variable("slip_rate")
            numpy.testing.assert_allclose(broken, numpy.minimum(t / lasts, 1.0), rtol=1e-6, atol=1e-9)
            self.assertEqual(broken[-1], 1.0)
            # what is left of cohesion sets the rate of a block that slides steadily in its state
            held = (9e5 - 5e4 * (1 - broken)) / 1e6
            steady = 1e-6 * numpy.exp((held - 0.9) / 0.01)
            late = t > 5 * DAY
            numpy.testing.assert_allclose(v[late], steady[late], rtol=0.02)
            self.assertLess(abs(v[-1] / 1e-6 - 1), 1e-6)

    # Whatever the grid and the pressures of the cells, which share cohesion as they share the load.
    def test_cells_that_are_alike_in_all_but_pressure_break_together(self):
        joint = ('interface: {size: "8 m", levels: 3, domain: {cascade: {dimension: 1.7, seed: 3}},'
                 ' spread: {pressure: {lognormal: {sigma: 0.5, seed: 4}}}}\n')
        with open(os.path.join(SOURCE, "cases", "weakening", "bridges.yaml"), encoding="utf-8") as file:
            text = file.read().replace("lacuna: 1\n", "")
        ends = []
        for form in ("", joint):
            self.run_text(form + text, "--set", "output.fields=[broken_cohesion]", "--set", "time.end=20 day")
            ends.append((self.variable("broken_cohesion")[-1], self.variable("slip")[-1]))
            cells = self.variable("cell_broken_cohesion")[-1]
            numpy.testing.assert_allclose(cells, ends[0][0], rtol=1e-5)
        numpy.testing.assert_allclose(ends[1], ends[0], rtol=1e-5)

    def test_the_factor_of_safety_falls_with_them(self):
        self.bundled("bridges", "--set", "output.factor_of_safety.reference_rate=1 um/s")
        safety, broken = self.variable("factor_of_safety"), self.variable("broken_cohesion")
        self.assertLess(safety[-1], safety[0] - 0.04)
        # steady at 1 um/s at the end; v_ref is the rate there
        self.assertLess(abs(safety[-1] - 1), 1e-6)
        self.assertTrue(numpy.all(numpy.diff(broken) >= 0))


class Dilatancy(Case):
    """A block behind a spring, steady but for a small push: oscillations that grow or die out.

    With omega = v/dc, c = 1/(omega t_d), E = eps/beta, kappa = k dc, s in units of omega, the linear
    stability of steady sliding (Segall & Rice 1995) is
        sigma a s^3 + (kappa + sigma (a - b) + sigma a c + f E) s^2 + (kappa (1 + c) + sigma c (a - b)) s + kappa c = 0
    which has roots on the imaginary axis where the product of the middle terms is that of the outer ones.
    """
    SIGMA, F, A, B, DC, V = 5e6, 0.6, 0.010, 0.015, 1e-3, 1e-6

    def cubic(self, kappa, c, suction):
        s, a, b, f = self.SIGMA, self.A, self.B, self.F
        return (s * a, kappa + s * (a - b) + s * a * c + f * suction, kappa * (1 + c) + s * c * (a - b), kappa * c)

    def critical(self, c, suction):
        s, a, b, f = self.SIGMA, self.A, self.B, self.F
        one, two = s * (a - b) + s * a * c + f * suction, s * c * (a - b)
        roots = numpy.roots([1 + c, two + one * (1 + c) - s * a * c, one * two])
        return float(max(roots.real))

    def growth(self, kappa, c, suction, formulation):
        """Real and imaginary part of the leading root, in units of v/dc: by the run, and in closed form."""
        text = f"""interface: {{size: "1 m"}}
load:
  normal: {{pressure: "{self.SIGMA} Pa"}}
  shear: [{{spring: {{stiffness: "{kappa / self.DC} Pa/m", speed: "{self.V} m/s"}}}}]
friction: {{aging: {{f0: {self.F}, a: {self.A}, b: {self.B}, dc: "{self.DC} m", v0: "{self.V} m/s"}}}}
weakening: [{{dilatancy: {{dilatancy: 1e-4, compressibility: "{1e-4 / suction} 1/Pa",
                           drainage_time: "{self.DC / self.V / c} s"}}}}]
initial: {{slip_rate: "{self.V} m/s", state: {{ratio_to_steady: 1.002}}}}
time: {{end: "{120 * self.DC / self.V} s"}}
"""
        self.run_text(text, "--set", "solver.rtol=1e-10", "--set", f"solver.formulation={formulation}")
        t, u = self.time() * self.V / self.DC, numpy.log(self.variable("slip_rate") / self.V)
        top = (u[1:-1] > u[:-2]) & (u[1:-1] >= u[2:]) & (u[1:-1] > 0)
        tops = []
        for i in numpy.nonzero(top)[0] + 1:  # a parabola through the peak
            fit = numpy.polyfit(t[i - 1:i + 2] - t[i], u[i - 1:i + 2], 2)
            tops.append((t[i] - fit[1] / (2 * fit[0]), fit[2] - fit[1] ** 2 / (4 * fit[0])))
        tops = numpy.array(tops)[1:]
        self.assertGreater(len(tops), 3)
        slope = numpy.polyfit(tops[:, 0], numpy.log(tops[:, 1]), 1)[0]
        turn = 2 * math.pi / numpy.mean(numpy.diff(tops[:, 0]))
        lead = max(numpy.roots(self.cubic(kappa, c, suction)), key=lambda root: (root.real, root.imag))
        return slope, turn, lead

    def test_critical_stiffness(self):
        s, a, b, f = self.SIGMA, self.A, self.B, self.F
        # drained at once friction alone decides; not at all, suction counts in full
        self.assertLess(abs(self.critical(1e6, 1e4) / (s * (b - a)) - 1), 1e-4)
        self.assertLess(abs(self.critical(1e-9, 1e4) / (s * (b - a) - f * 1e4) - 1), 1e-4)
        for c, suction, formulation in ((0.3, 1e4, "rate"), (3.0, 2e4, "traction"), (0.1, 2e4, "slip")):
            critical = self.critical(c, suction)
            self.assertLess(critical, 0.99 * s * (b - a))
            for part in (0.97, 1.03):
                slope, turn, lead = self.growth(part * critical, c, suction, formulation)
                self.assertEqual(slope > 0, part < 1, f"c = {c}, {part} of the critical stiffness: {slope}")
                self.assertLess(abs(slope - lead.real), 0.05 * abs(lead.real) + 2e-4)
                self.assertLess(abs(turn / lead.imag - 1), 0.01)

    def test_bundled_case_is_steady_where_it_would_not_be(self):
        self.bundled("dilatancy")
        self.assertLess(abs(self.variable("slip_rate")[-1] / 1e-6 - 1), 1e-3)
        self.assertLess(numpy.max(self.variable("slip_rate")), 1e-5)
        self.assertLess(numpy.min(self.variable("excess_pore_pressure")), -1e3)


class Pressurization(Case):
    """Slip at a given rate, by a stiff spring, with friction that does not depend on it."""
    F, SIGMA, V, CAPACITY, PRESSURIZATION = 0.6, 5e6, 0.01, 2.7e6, 3e5

    def shear(self, thickness, thermal, hydraulic, slip, *words):
        text = f"""interface: {{size: "1 m"}}
load:
  normal: {{pressure: "{self.SIGMA} Pa"}}
  shear: [{{spring: {{stiffness: "1e12 Pa/m", speed: "{self.V} m/s"}}}}]
friction: {{aging: {{f0: {self.F}, a: 0.001, b: 0.001, dc: "1 mm", v0: "{self.V} m/s"}}}}
weakening:
  - thermal-pressurization: {{thickness: "{thickness} m", heat_capacity: {self.CAPACITY},
      pressurization: "{self.PRESSURIZATION} Pa/K", thermal_diffusivity: {thermal}, hydraulic_diffusivity: {hydraulic}}}
initial: {{slip_rate: "{self.V} m/s", state: {{ratio_to_steady: 1.0000001}}}}
time: {{end: "{slip / self.V} s", failure: {{mean_slip_rate: "1 km/s", mean_slip: "1 km"}}}}
"""
        self.run_text(text, "--set", "solver.rtol=1e-8", *words)
        return self.variable("slip"), self.variable("shear_force"), self.variable("temperature_rise")

    # Undrained and adiabatic: tau = f sigma exp(-f Lambda slip/(rho c h)), all work is heat.
    def test_undrained_adiabatic(self):
        h = 0.05
        for formulation in ("traction", "slip", "rate"):
            slip, tau, hot = self.shear(h, 1e-15, 3e-15, 2.0, "--set", f"solver.formulation={formulation}")
            length = self.CAPACITY * h / (self.F * self.PRESSURIZATION)
            exact = self.F * self.SIGMA * numpy.exp(-slip / length)
            self.assertLess(exact[-1], 0.1 * exact[0])
            numpy.testing.assert_allclose(tau, exact, rtol=1e-4, err_msg=formulation)
            work = self.F * self.SIGMA * length * -numpy.expm1(-slip / length)
            numpy.testing.assert_allclose(hot, work / (self.CAPACITY * h), rtol=1e-4, atol=1e-3)

    # Slip on a plane: tau = f sigma exp(x) erfc(sqrt(x)), x = slip/L*,
    # L* = (4/f^2)(rho c/Lambda)^2 (sqrt(alpha_th) + sqrt(alpha_hy))^2/v (Mase & Smith 1987; Rice 2006, eq. 12)
    def test_slip_on_a_plane(self):
        for thermal, hydraulic in ((1e-6, 4e-6), (2e-6, 0.5e-6)):
            slip, tau, _ = self.shear(5e-5, thermal, hydraulic, 0.5)
            both = (math.sqrt(thermal) + math.sqrt(hydraulic)) ** 2
            length = 4 / self.F ** 2 * (self.CAPACITY / self.PRESSURIZATION) ** 2 * both / self.V
            x = slip / length
            exact = self.F * self.SIGMA * numpy.array([math.exp(k) * math.erfc(math.sqrt(k)) for k in x])
            late = slip > 0.02  # the layer, 50 um thick, is felt no more
            self.assertLess(exact[-1], 0.6 * exact[0])
            numpy.testing.assert_allclose(tau[late], exact[late], rtol=2e-3)

    def test_bundled_case(self):
        done = self.bundled("pressurization")
        self.assertTrue(done["failed"])
        self.assertGreater(done["max_slip_rate_m_s"], 30)
        excess = self.variable("excess_pore_pressure")
        self.assertGreater(excess[-1], 1.5e6)
        numpy.testing.assert_allclose(self.variable("pore_pressure"), excess, rtol=1e-6, atol=1)


class Together(Case):
    """All mechanisms on a lacunar joint whose cells differ, under water that rises and jumps."""
    JOINT = """interface: {size: "8 m", levels: 4, domain: {cascade: {dimension: 1.8, seed: 3}}, spread: {pressure: {lognormal: {sigma: 0.5, seed: 4}}}}
material: {shear_modulus: "15 GPa", poisson: 0.25, shear_speed: "1 km/s"}
load:
  normal: {pressure: "3 MPa"}
  shear: [{ratio: {value: 0.62}}]
  pore_pressure: [{ramp: {rate: "10 kPa/day", end: "10 day"}}, {step: {value: "5 kPa", at: "2 day"}}]
friction:
  aging: {f0: 0.6, a: 0.010, b: 0.012, dc: "1 mm", v0: "1 um/s", cohesion: "60 kPa"}
  spread: {dc: {lognormal: {sigma: 0.3, seed: 4}}}
weakening:
  - bridges: {rate: "0.05 1/day", stress: "1.8 MPa", exponent: 20}
  - dilatancy: {dilatancy: 1e-4, compressibility: "1e-9 1/Pa", drainage_time: "1 hour"}
  - thermal-pressurization: {thickness: "1 mm", pressurization: "0.3 MPa/K", hydraulic_diffusivity: "1e-8 m2/s"}
initial: {slip_rate: "1 nm/s", spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}}
transfer: {hierarchy: {k0: "1 GPa/m", ratio: 0.5}}
time: {end: "20 day"}
output: {fields: [slip, temperature, excess_pore_pressure, broken_cohesion]}
"""

    # The balance holds to rounding where slip is the unknown; the others come to the same.
    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_formulations_agree(self):
        failures, maps = [], []
        for formulation in ("slip", "rate", "traction"):
            done = self.run_text(self.JOINT, "--set", "solver.rtol=1e-8", "--set", f"solver.formulation={formulation}")
            self.assertLess(done["balance_residual"], 1e-13 if formulation == "slip" else 1e-6)
            failures.append(done["failure_time_s"])
            maps.append([self.variable("cell_" + name)[2] for name in ("slip", "temperature", "excess_pore_pressure",
                                                                      "broken_cohesion")])
            numpy.testing.assert_allclose(failures[-1], failures[0], rtol=1e-6)
        self.assertGreater(numpy.ptp(maps[0][0]), 0)
        self.assertLess(numpy.min(maps[0][2]), -100)

    def test_what_check_says(self):
        with open(self.case, "w", encoding="utf-8") as file:
            file.write("lacuna: 1\n" + self.JOINT)
        words = json.loads(self.call("check", self.case, "--json").stdout)["estimate"]["regime_words"]
        # (1.8/1.86)^20/0.05 day; f0 eps/beta; rho c h/(f0 Lambda)
        for said in ("Its bridges last 10.3", "f0 epsilon/beta = 60 kPa", "each 15 mm of slip takes an e-fold"):
            self.assertIn(said, words)


class Refused(Case):
    LOADS = 'load: {normal: {pressure: "5 MPa"}, shear: [{ratio: {value: 0.58}}]}\n'
    LAW = 'friction: {aging: {a: 0.01, b: 0.015, dc: "1 mm"%s}}\ninitial: {slip_rate: "1 nm/s"}\ntime: {end: "1 day"}\n'
    BRIDGES = 'weakening: [{bridges: {rate: "1 1/day", stress: "5 MPa", exponent: 20}}]\n'
    DILATANCY = '{dilatancy: {dilatancy: 1e-4, compressibility: "1e-10 1/Pa", drainage_time: "1 hour"}}'

    def test_bridges_need_cohesion(self):
        said = self.refused(self.LOADS + self.LAW % "" + self.BRIDGES)
        self.assertIn("weakening.0.bridges: needs a cohesion that can break", said)

    def test_pore_pressure_and_alpha(self):
        said = self.refused(self.LOADS + self.LAW % ", alpha: 0.3" + f"weakening: [{self.DILATANCY}]\n")
        self.assertIn("weakening.0.dilatancy: does not go with alpha", said)

    def test_twice(self):
        said = self.refused(self.LOADS + self.LAW % "" + f"weakening: [{self.DILATANCY}, {self.DILATANCY}]\n")
        self.assertIn("weakening.1.dilatancy: stands twice", said)

    def test_events(self):
        said = self.refused(self.LOADS + self.LAW % "" + f"weakening: [{self.DILATANCY}]\n" +
                            "solver: {fidelity: events}\n")
        self.assertIn("weakening: goes with fidelity ode, not with events", said)

    def test_faster_than_steps(self):
        said = self.refused(self.LOADS + self.LAW % "" + "weakening: [" + self.DILATANCY.replace("1 hour", "1e-18 s") + "]\n")
        self.assertIn('drainage_time: "1e-18 s" must be >= 1e-09 s', said)
        with open(self.case, "w", encoding="utf-8") as file:
            file.write("lacuna: 1\n" + self.LOADS + self.LAW % ", cohesion: 50 kPa" + self.BRIDGES.replace("5 MPa", "1 kPa").replace("20", "200"))
        done = self.call("run", self.case, "-o", self.output, "--force")
        self.assertEqual(done.returncode, 1)
        self.assertIn("what weakens the joint may do so faster than steps can follow", done.stderr)

    def test_fields_of_what_is_not_there(self):
        said = self.refused(self.LOADS + self.LAW % "" + f"weakening: [{self.DILATANCY}]\n" +
                            "output: {fields: [temperature]}\n")
        self.assertIn("temperature needs thermal-pressurization", said)


if __name__ == "__main__":
    PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
