#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads that bend at every reading of a long series: the error of a run must not grow with their number.

Compared with an integration of its own: Runge and Kutta's method between the readings, the slip rate from the balance.

usage: test_breaks.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli

A, DC, V0, F0, P = 0.010, 1e-3, 1e-6, 0.6, 5e6

CASE = """\
lacuna: 1
load:
  normal: {{pressure: "5 MPa"}}
  pore_pressure: [{{series: {{file: p.csv, time: t, value: "p:Pa", outside: hold}}}}]
friction: {{aging: {{f0: 0.6, a: 0.010, b: {b}, dc: "{dc} m", v0: "1 um/s"}}}}
initial: {{slip_rate: "{v} m/s", state: {{ratio_to_steady: {ratio}}}{spread}}}
time: {{end: "{end} s", failure: {{mean_slip_rate: "1 m/s"}}}}
solver: {{rtol: 1e-6, {solver}}}
output: {{file: run.nc, fields: [slip_rate, state], fields_every: {{steps: 100000000}}}}
{more}
"""

TIDES = """\
lacuna: 1
load:
  normal: {{pressure: "5 MPa"}}
  pore_pressure: [{{sine: {{amplitude: "20 kPa", period: "12 hour"}}}}]
friction: {{aging: {{f0: 0.6, a: 0.010, b: 0.008, dc: "1 mm", v0: "1 um/s"}}}}
initial: {{slip_rate: "1e-9 m/s", state: steady}}
time: {{end: "5 year"}}
solver: {{{solver}}}
output: {{file: run.nc, every: {{steps: 1000}}}}
"""

FOUR = """\
interface: {{size: "2 m", levels: 1, domain: {{full: {{}}}}}}
transfer: {{hierarchy: {{k0: "{k} Pa/m"}}}}
"""


def pressures(n):
    return 1e4 * (7919 * numpy.arange(n + 1) % 13) / 13


def reference(n, end, b, v, theta, k=0.0, substeps=1, dc=DC):
    """Mean slip of cells tied to their mean by k, at each reading; no number from where it runs away."""
    h, cells = end / n / substeps, len(v)
    share = (1 - pressures(n) / P).tolist()
    start = (P * share[0] * (F0 + A * numpy.log(v / V0) + b * numpy.log(V0 * theta / dc))).tolist()
    level = F0 + b * math.log(V0 / dc)

    def rates(y, share):
        """Of the slips and then the logarithms of the states; plain numbers are faster than arrays of few."""
        mean = sum(y[:cells]) / cells
        speed = [V0 * math.exp(((start[i] - k * (y[i] - mean)) / (P * share) - level - b * y[cells + i]) / A)
                 for i in range(cells)]
        return speed + [math.exp(-y[cells + i]) - speed[i] / dc for i in range(cells)]

    def moved(y, h, by):
        return [one + h * rate for one, rate in zip(y, by)]

    y, slip = [0.0] * cells + numpy.log(theta).tolist(), numpy.full(n + 1, numpy.nan)
    slip[0] = 0.0
    for i in range(n):
        try:
            for j in range(substeps):
                at = [share[i] + (share[i + 1] - share[i]) * (j + part) / substeps for part in (0, 0.5, 1)]
                k1 = rates(y, at[0])
                k2 = rates(moved(y, h / 2, k1), at[1])
                k3 = rates(moved(y, h / 2, k2), at[1])
                k4 = rates(moved(y, h, k3), at[2])
                y = [one + h / 6 * (r1 + 2 * r2 + 2 * r3 + r4) for one, r1, r2, r3, r4 in zip(y, k1, k2, k3, k4)]
        except OverflowError:
            break
        slip[i + 1] = sum(y[:cells]) / cells
    return slip


class Breaks(test_cli.Case):
    def run_case(self, n, end=1.5e6, b=0.015, v=1e-9, ratio=0.9, solver="", more="", spread="", dc=DC):
        with open(self.path("p.csv"), "w", encoding="ascii") as file:
            file.write("t,p\n")
            for t, value in zip(numpy.arange(n + 1) * (end / n), pressures(n)):
                file.write(f"{t:.17g},{value:.17g}\n")
        self.write("c.yaml", CASE.format(b=b, dc=dc, v=v, ratio=ratio, end=end, solver=solver, more=more,
                                        spread=spread))
        result = self.expect(0, "run", "c.yaml", "--json", "--force")
        self.assertNotIn("warning", result.stderr)
        return json.loads(result.stdout)

    def start(self):
        """Slip rates and states of the last run."""
        with netCDF4.Dataset(self.path("run.nc")) as data:
            return numpy.array(data["cell_slip_rate"][0]), numpy.array(data["cell_state"][0])

    def test_one_block(self):
        """Every method and formulation, from 150 readings to 15 000."""
        solvers = ("method: bdf", "method: adams", "formulation: traction", "formulation: slip", "method: erk")
        for n in 150, 1500, 15000:
            exact = None
            for solver in solvers:
                done = self.run_case(n, solver=solver)
                exact = exact or reference(n, 1.5e6, 0.015, *self.start(), substeps=2)[-1]
                self.assertLess(abs(done["mean_slip_m"] / exact - 1), 1e-7, (n, solver))
                self.assertLess(done["rate_drift"], 1e-9)

    def test_stretches_of_some_steps(self):
        """Too long for ten explicit steps: from some readings on they are the cheaper way all the same."""
        n, b = 400, 0.008
        dc = 1e-9 * 1.5e6 / n / 45  # some 45 e-foldings from one reading to the next
        exact, steps = None, {}
        for solver in "method: erk", "method: bdf", "formulation: traction", "formulation: slip":
            done = self.run_case(n, b=b, dc=dc, solver=solver)
            exact = exact or reference(n, 1.5e6, b, *self.start(), substeps=100, dc=dc)[-1]
            self.assertLess(abs(done["mean_slip_m"] / exact - 1), 1e-5, solver)
            steps[solver] = done["steps"]
            self.assertLess(done["steps"], 2.5 * steps["method: erk"], solver)

    def test_failure_under_hourly_readings_of_years(self):
        """150 000 readings; the block fails among them."""
        n = 150000
        done = self.run_case(n, ratio=0.45)
        reached = int(1.2e6 / 1.5e6 * n)
        exact = reference(n, 1.5e6, 0.015, *self.start())
        with netCDF4.Dataset(self.path("run.nc")) as data:
            slip = numpy.interp(reached * 1.5e6 / n, data["time"][:], data["slip"][:])
        self.assertLess(abs(slip / exact[reached] - 1), 1e-6)
        # slip grows as -dc a/(b - a) ln(time left) near the end: the reference runs into it at the same reading
        gone = numpy.argmax(~(exact < 20 * DC)) * 1.5e6 / n
        self.assertTrue(done["failed"])
        self.assertLess(abs(done["failure_time_s"] / gone - 1), 2e-5)

    def test_stiff_cells(self):
        """Ties far stiffer than k_crit and readings far apart: the implicit method begins anew at each."""
        n, end, k, b, exact = 250, 5e6, 800 * P * 0.005 / DC, 0.008, None
        more = FOUR.format(k=k)
        spread = ", spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 3}}}"
        for solver in "formulation: rate", "formulation: traction", "formulation: slip", "method: adams":
            done = self.run_case(n, end, b, 1e-8, 1.0, solver, more, spread)
            self.assertEqual(done["n_cells"], 4)
            self.assertGreater(done["newton_iterations"], 10 * n)
            exact = exact or reference(n, end, b, *self.start(), k, substeps=100)[-1]
            self.assertLess(abs(done["mean_slip_m"] / exact - 1), 1e-5, solver)

    def test_swings_that_add_up_are_warned_of(self):
        """A smooth load has no breaks: 3650 tides cost BDF its accuracy, which is said; the explicit method keeps it."""
        slip = {}
        for solver in "method: bdf, rtol: 1e-6", "method: bdf, rtol: 1e-10", "method: erk, rtol: 1e-6":
            self.write("c.yaml", TIDES.format(solver=solver))
            done = self.expect(0, "run", "c.yaml", "--json", "--force")
            slip[solver] = json.loads(done.stdout)["mean_slip_m"]
            self.assertEqual("warning: the mean slip rate is off" in done.stderr, solver == "method: bdf, rtol: 1e-6")
            self.assertEqual("take method: erk" in done.stderr, solver == "method: bdf, rtol: 1e-6")
        exact = slip["method: erk, rtol: 1e-6"]
        self.assertLess(abs(slip["method: bdf, rtol: 1e-10"] / exact - 1), 1e-5)
        self.assertGreater(abs(slip["method: bdf, rtol: 1e-6"] / exact - 1), 1e-3)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
