#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs on elastic rock at the limits: few cells, soft and stiff rock, every law, against an integration of their own.

usage: test_elastic_limits.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
import elastic_rock as rock  # noqa: E402  pylint: disable=wrong-import-position

A, B, DC, V0, F0, VC, NU = 0.010, 0.015, 1e-3, 1e-6, 0.6, 1e-4, 0.25
RATE = 1e-2  # of the mean that is failure
PRESSURE = 3e6

CASE = """\
lacuna: 1
title: Limits
interface: {{{interface}}}
material: {{shear_modulus: {g}, poisson: 0.25}}
load: {{normal: {{pressure: "3 MPa"}}}}
friction: {{{law}: {{f0: 0.6, a: 0.010, b: 0.015, dc: "1 mm", v0: "1 um/s"{more}}}}}
initial:
  slip_rate: "0.01 um/s"
  state: {{ratio_to_steady: 0.7}}
  spread: {{slip_rate: {{lognormal: {{sigma: 0.5, seed: 3}}}}}}
transfer: {{elastic: {{}}}}
time: {{end: "1e9 s", failure: {{mean_slip_rate: "1 cm/s"}}}}
solver: {{rtol: {rtol}, formulation: {formulation}}}
output: {{file: run.nc, fields: [slip_rate, state], fields_every: {{steps: 1000000}}}}
"""

LAWS = {
    "aging": lambda x, v, theta: 1 / theta * (1 - x),
    "slip": lambda x, v, theta: -v / DC * numpy.log(x),
    "composite": lambda x, v, theta: numpy.exp(-v / VC) / theta - v / DC * numpy.log(x),
}


def dormand_prince(f, y, end, rtol):
    """Integrates y' = f(y) until end(y) is no longer negative; gives back that time."""
    a = [[], [1 / 5], [3 / 40, 9 / 40], [44 / 45, -56 / 15, 32 / 9],
         [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
         [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
         [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84]]
    e = numpy.array([71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])
    t, h = 0.0, 1e-3 / abs(f(y)).max()
    while True:
        k = numpy.empty((7, y.size))
        for i, row in enumerate(a):
            k[i] = f(y + h * (numpy.array(row) @ k[:i]) if i else y)
        new = y + h * (numpy.array(a[6]) @ k[:6])
        off = h * abs(e @ k).max() / rtol
        if not off <= 1:
            h *= max(0.2, 0.9 * off ** -0.2) if math.isfinite(off) else 0.1
            continue
        if end(new) >= 0:
            if h < 1e-9 * t or end(new) < 1e-9:
                # ln v of the mean is as good as straight within so short a step
                return t + h * end(y) / (end(y) - end(new))
            h /= 2
            continue
        t, y, h = t + h, new, h * min(4, 0.9 * max(off, 1e-6) ** -0.2)


class Limits(test_cli.Case):
    def failure(self, interface, g, law="aging", rtol=1e-9, formulation="rate"):
        more = f', vc: "{VC} m/s"' if law == "composite" else ""
        self.write("c.yaml", CASE.format(interface=interface, g=f'"{g} Pa"', law=law, more=more, rtol=rtol,
                                         formulation=formulation))
        done = json.loads(self.expect(0, "run", "c.yaml", "--json", "--force").stdout)
        self.assertTrue(done["failed"])
        return done["failure_time_s"]

    def start(self):
        """Grid, cells, pressures, rates and states of the last run."""
        with netCDF4.Dataset(self.path("run.nc")) as data:
            data.set_auto_mask(False)
            grid = tuple(data.getncattr("grid_" + key) for key in ("nx", "ny", "dx_m", "dy_m"))
            index = numpy.floor(data["x"][:] / grid[2]).astype(int)
            if grid[1] > 1:
                index += numpy.floor(data["y"][:] / grid[3]).astype(int) * grid[0]
            return grid, index, data["pressure"][:], data["cell_slip_rate"][0], data["cell_state"][0]

    def own(self, g, law, compliance):
        """The time of failure, integrated in (ln v, ln theta) with a dense stiffness."""
        grid, index, p, v, theta = self.start()
        n = index.size
        k = rock.stiffness(compliance(grid, index, g, NU)) if n > 1 else numpy.zeros((1, 1))

        def rates(y):
            v, theta = numpy.exp(y[:n]), numpy.exp(y[n:])
            w = LAWS[law](v * theta / DC, v, theta)
            return numpy.concatenate([(-k @ v / p - B * w) / A, w])

        return dormand_prince(rates, numpy.concatenate([numpy.log(v), numpy.log(theta)]),
                              lambda y: math.log(numpy.exp(y[:n]).mean() / RATE), 1e-9)

    def near(self, value, exact, part):
        self.assertLessEqual(abs(value / exact - 1), part, f"{value} is not {exact}")

    def test_few_cells(self):
        """One, two, four cells and a handful far apart; k_0/k_crit about 1, of two also 0.01 and 100; every law."""
        far = 'size: "64 m", levels: 6, domain: {cascade: {dimension: 0.2, seed: 6}}'
        line, plane = 'size: "4 m", shape: line, domain: {full: {}}, ', 'size: "2 m", domain: {full: {}}, '
        cases = [('size: "2 m"', rock.periodic), (line + "cells_x: 2", rock.periodic),
                 (line + "levels: 2", rock.periodic), (plane + "levels: 1", rock.periodic),
                 (line + "levels: 2, boundary: free", rock.alone_line),
                 (plane + "levels: 1, boundary: free", rock.alone), (far, rock.periodic)]
        laws = list(LAWS)
        for i, (interface, compliance) in enumerate(cases):
            law = laws[i % 3]
            for decade in (-2, 0, 2) if i == 1 else (0,):
                g = 10 ** decade * PRESSURE * (B - A) / DC
                found = self.failure(interface, g, law)
                self.assertLessEqual(self.start()[1].size, 6)
                self.near(found, self.own(g, law, compliance), 3e-6)

    def test_every_tolerance(self):
        g = PRESSURE * (B - A) / DC * 3
        interface = 'size: "4 m", levels: 2, domain: {cascade: {dimension: 1.5, seed: 2}}'
        for law, formulation in zip(LAWS, ("rate", "traction", "slip")):
            self.failure(interface, g, law)
            exact = self.own(g, law, rock.periodic)
            for rtol in 1e-2, 1e-4, 1e-7, 1e-10, 1e-13:
                found = self.failure(interface, g, law, rtol, formulation)
                self.near(found, exact, max(1e-7, min(0.2, 1000 * rtol)))

    def test_soft_and_stiff(self):
        """Without rock each cell is alone; with rock beyond 1e6 k_crit all move as one from exp(sum p ln v/sum p)."""
        interface = 'size: "8 m", levels: 3, domain: {cascade: {dimension: 1.6, seed: 5}}'
        k_crit = PRESSURE * (B - A) / DC
        soft = [self.failure(interface, scale * k_crit) for scale in (1e-12, 1e-9, 1e-6)]
        alone = self.own(1e-30 * k_crit, "aging", rock.periodic)
        for found in soft:
            self.near(found, alone, 1e-5)
        stiff = [self.failure(interface, scale * k_crit, formulation=formulation)
                 for scale, formulation in ((1e3, "rate"), (1e5, "rate"), (1e7, "traction"), (1e7, "slip"))]
        _, _, p, v, theta = self.start()
        common = math.exp((p * numpy.log(v)).sum() / p.sum())
        state = numpy.log(theta)

        def rates(y):
            v, w = math.exp(y[0]), 1 / numpy.exp(y[1:]) - math.exp(y[0]) / DC
            return numpy.concatenate([[-B / A * (p * w).sum() / p.sum()], w]) if v > 0 else None

        exact = dormand_prince(rates, numpy.concatenate([[math.log(common)], state]),
                               lambda y: y[0] - math.log(RATE), 1e-10)
        for found, part in zip(stiff, (1e-2, 1e-4, 1e-5, 1e-5)):
            self.near(found, exact, part)

    def test_a_cell_alone(self):
        """One cell of 64^2 is a block of its own; one of 1024^2: extreme/test_elastic_limits.c."""
        sparse = 'size: "64 m", levels: 6, domain: {cascade: {dimension: 0.001, seed: 1}}'
        found = self.failure(sparse, 2e10)
        self.assertEqual(self.start()[1].size, 1)
        self.near(found, self.own(2e10, "aging", rock.periodic), 3e-6)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
