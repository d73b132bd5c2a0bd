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


class Friction(unittest.TestCase):
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

    def test_aging(self):
        done = self.run_case("aging", "--set", "solver.rtol=1e-9")
        self.assertTrue(done["failed"])
        # m = 2: -x - ln(1 - x) times dc/v*, v* = v x^2
        week = 7 * 86400.0
        self.near(done["failure_time_s"], (-0.9 - math.log(0.1)) * 0.7 * week / 0.81, 1e-6)

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


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
