#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pore pressure and normal stress that differ from cell to cell, from the case to the file, as users meet it.

usage: test_loads_over_joint.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import itertools
import json
import math
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

# A lacunar joint whose cells differ in all, damped by radiation.
JOINT = """\
lacuna: 1
interface: {size: "1 m", levels: 3, domain: {cascade: {dimension: 1.8, seed: 3}}}
material: {shear_modulus: "15 GPa", poisson: 0.25, shear_speed: "1 km/s"}
load:
  normal: {pressure: "3 MPa"}
  pore_pressure: [{LOAD}]
friction:
  aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "1 mm", v0: "1 um/s"}
  spread: {dc: {lognormal: {sigma: 0.3, seed: 4}}}
initial:
  slip_rate: "1 mm/day"
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}
transfer: {hierarchy: {k0: "10 GPa/m", ratio: 0.5}}
time: {end: "1 day"}
output: {file: out.nc, fields: [slip, slip_rate, traction], fields_every: {steps: 20}}
"""

FINE = JOINT.replace("levels: 3", "levels: 4")  # what is refused names its cell

# Cells that creep steadily, so much strengthened by rate that no water makes them run.
STILL = """\
lacuna: 1
interface: {INTERFACE, domain: {full: {}}}
load: {normal: {pressure: "50 MPa"}, pore_pressure: [{LOAD}]}
friction: {aging: {f0: 0.6, a: 1, b: 0.01, dc: "1 mm", v0: "1 um/day"}}
initial: {slip_rate: "1 um/day", state: steady}
transfer: {none: {}}
time: {end: "END"}
output: {file: out.nc, fields: [slip, pore_pressure], fields_every: "EVERY"}
"""

REGULARISED = ("--set", "friction.aging.form=regularised")
HOW = {
    "rate": ("--set", "solver.formulation=rate"),
    "traction": ("--set", "solver.formulation=traction", *REGULARISED),
    "slip": ("--set", "solver.formulation=slip", *REGULARISED),
    "inertia": ("--set", "material.density=2700", "--set", "inertia.thickness=100"),
    "alpha": ("--set", "friction.aging.alpha=0.2"),
    "erk": ("--set", "solver.method=erk"),
    "events": ("--set", "solver.fidelity=events"),
}

SMALL = ("--set", "interface.levels=2")  # what cells are told does not hang on how many they are

OWN = {"wall", "cpu", "memory"}


class Fields(Case):
    def field(self, name, t, y, x, p, units="Pa", time="s"):
        with netCDF4.Dataset(self.path(name), "w") as data:
            for axis, values, unit in (("time", t, time), ("y", y, "m"), ("x", x, "m")):
                if values is not None:
                    data.createDimension(axis, len(values))
                    data.createVariable(axis, "f8", (axis,))[:] = values
                    data[axis].units = unit
            over = ("y", "x") if t is None else ("time", "y", "x")
            data.createVariable("p", "f8", over)[:] = p
            data["p"].units = units

    def follow(self, text, *words):
        self.write("c.yaml", text)
        return json.loads(self.expect(0, "run", "c.yaml", "--json", "--force", "-o", "out.nc", *words).stdout)

    def numbers(self):
        """Every number of the file of a run, but for its costs."""
        with netCDF4.Dataset(self.path("out.nc")) as data:
            data.set_auto_mask(False)
            return {name: data[name][...].tobytes() for name in data.variables
                    if data[name].dtype != str and not any(word in name for word in OWN)}

    def snapshots(self, *names):
        with netCDF4.Dataset(self.path("out.nc")) as data:
            data.set_auto_mask(False)
            return [data[name][...] for name in names]


class Uniform(Fields):
    def test_a_uniform_field_is_a_scalar_to_the_bit(self):
        t = numpy.array([0, 1, 2.5, 8, 30]) * 3600.0
        p = numpy.array([1e5, 1.5e5, 1.2e5, 2.1e5, 2e5])
        rows = "".join(f"{a!r},{b!r}\n" for a, b in zip(t.tolist(), p.tolist()))
        self.write("u.csv", "t,p\n" + rows)
        y, x = numpy.linspace(0, 1, 4), numpy.linspace(0, 1, 6)
        self.field("u.nc", t, y, x, numpy.broadcast_to(p[:, None, None], (5, 4, 6)))
        step = "{step: {value: 0.1 MPa, at: 2 hour}}, "
        scalar = JOINT.replace("{LOAD}", step + "{series: {file: u.csv, time: t, value: 'p:Pa'}}")
        field = JOINT.replace("{LOAD}", step + "{field: {file: u.nc, variable: p}}")
        for how, words in HOW.items():
            if how == "events":  # follows no `series`
                scalar = JOINT.replace("{LOAD}", "{ramp: {rate: 1.25 Pa/s}}")
                t, p = numpy.array([0, 65536.0]), numpy.array([0, 81920.0])
                self.field("u.nc", t, y, x, numpy.broadcast_to(p[:, None, None], (2, 4, 6)))
                field = JOINT.replace("{LOAD}", "{field: {file: u.nc, variable: p}}")
                words = (*words, "--set", "time.end=65536")
            once = self.follow(scalar, *SMALL, *words)
            numbers = self.numbers()
            again = self.follow(field, *SMALL, *words)
            with self.subTest(how):
                self.assertTrue(once["failed"])
                self.assertGreater(once["failure_time_s"], 2 * 3600)
                self.assertEqual(once["failure_time_s"], again["failure_time_s"])
                self.assertEqual(numbers, self.numbers())


class Differing(Fields):
    def uneven(self):
        t = numpy.array([0, 0.05, 0.1, 12.0])
        x, y = numpy.linspace(0, 1, 6), numpy.linspace(0, 1, 4)
        here = x[None, :] * y[:, None]
        self.field("n.nc", t, y, x, numpy.array([1e2 + 0 * here, 2e2 + 6e2 * here, 1e2 + 3e2 * here, 2e2 + 8e2 * here]),
                   "kPa", "hours")
        return JOINT.replace("{LOAD}", "{field: {file: n.nc, variable: p}}").replace("1 day", "12 hour")

    def test_formulations_agree_and_balance(self):
        when = {}
        case = self.uneven()
        for how in "rate", "traction", "slip", "erk", "events":
            words = () if how == "events" else ("--set", "solver.rtol=1e-8")
            done = self.follow(case, *HOW[how], *words)
            self.assertTrue(done["failed"])
            when[how] = done["failure_time_s"]
            residual, = self.snapshots("balance_residual")
            self.assertLess(residual.max(), {"slip": 1e-13, "events": 1e-3}.get(how, 1e-7))
        self.assertGreater(when["rate"], 360)  # beyond the bends
        for how, t in when.items():
            self.assertAlmostEqual(t / when["rate"], 1, delta=1e-4 if how == "events" else 1e-6, msg=how)

    def test_each_cell_is_a_block_under_its_own_water(self):
        """Cells that nothing ties follow a block each: pressures are even, so that p_i - u_i is what holds a cell."""
        y = x = numpy.array([0.25, 0.75])
        p = 1e3 * numpy.array([[[0, 4], [8, 2]], [[6, 10], [0, 15]], [[6, 10], [0, 15]]])
        t = numpy.array([0, 5, 10]) * 86400.0
        self.field("f.nc", t, y, x, p)
        case = """\
lacuna: 1
interface: {size: "1 m", levels: LEVELS, domain: {full: {}}}
load: {normal: {pressure: "3 MPa"}, pore_pressure: [{LOAD}]}
friction: {aging: {f0: 0.6, a: 0.012, b: 0.008, dc: "0.1 mm", v0: "1 um/s", alpha: 0.1}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.9}}
transfer: {none: {}}
time: {end: "10 day"}
solver: {rtol: 1e-9}
output: {file: out.nc, fields: [slip, pore_pressure], fields_every: "5 day"}
"""
        self.follow(case.replace("LEVELS", "1").replace("{LOAD}", "{field: {file: f.nc, variable: p}}"))
        slip, pore, at_x, at_y = self.snapshots("cell_slip", "cell_pore_pressure", "x", "y")
        for i, (column, row) in enumerate(zip(numpy.searchsorted(x, at_x), numpy.searchsorted(y, at_y))):
            own = p[:, row, column]
            self.assertTrue(numpy.allclose(pore[:3, i], own, rtol=1e-12))
            self.write("s.csv", "t,p\n" + "".join(f"{a!r},{b!r}\n" for a, b in zip(t.tolist(), own.tolist())))
            block = case.replace("LEVELS, domain: {full: {}}", "0")
            self.follow(block.replace("{LOAD}", "{series: {file: s.csv, time: t, value: 'p:Pa'}}"))
            alone, = self.snapshots("cell_slip")
            self.assertTrue(numpy.allclose(slip[-1, i], alone[-1, 0], rtol=1e-6))
        self.assertGreater(slip[-1].max() / slip[-1].min(), 1.2)

    def test_a_map_with_a_factor(self):
        y, x = numpy.array([0.0, 1.0]), numpy.array([0.0, 0.4, 1.0])
        p = numpy.array([[1.0, 2.0, 3.0], [2.0, 2.0, 5.0]])
        self.field("m.nc", None, y, x, p, "MPa")
        self.write("f.csv", "t,f\n0,0\n86400,2\n172800,1\n")
        load = "{field: {file: m.nc, variable: p, series: f.csv, time: t, factor: 'f:1', scale: 0.5}}, " \
               "{constant: {value: 1 MPa}}"
        case = STILL.replace("INTERFACE", 'size: "1 m", levels: 3')
        self.follow(case.replace("{LOAD}", load).replace("END", "2 day").replace("EVERY", "0.5 day"))
        t, pore, at_x, at_y = self.snapshots("snapshot_time", "cell_pore_pressure", "x", "y")
        factor = 0.5 * numpy.interp(t, [0, 86400, 172800], [0, 2, 1])
        low, high = numpy.interp(at_x, x, p[0]), numpy.interp(at_x, x, p[1])
        shape = low + at_y * (high - low)
        self.assertEqual(len(t), 5)
        self.assertTrue(numpy.allclose(pore, 1e6 + 1e6 * factor[:, None] * shape[None, :], rtol=1e-12))
        effective, normal = self.snapshots("effective_normal_force", "normal_force")
        mean = pore.mean(axis=1)  # pressures are even
        self.assertAlmostEqual(effective[0] / normal[0], 1 - mean[0] / 50e6, delta=1e-12)
        self.assertAlmostEqual(effective[-1] / normal[-1], 1 - mean[-1] / 50e6, delta=1e-12)


class NormalStress(Fields):
    """What presses on top of the normal load, or takes from it."""

    # A step for all cells, and what a file says of each: at the start, and in time.
    UNIFORM = JOINT.replace("pore_pressure: [{LOAD}]", "pore_pressure: [{constant: {value: 0.2 MPa}}]\n"
                            "  normal_stress: [{step: {value: -0.1 MPa, at: 2 hour}}, {LOAD}]")

    def test_a_uniform_field_is_a_scalar_to_the_bit(self):
        t = numpy.array([0, 1, 2.5, 8, 30]) * 3600.0
        p = numpy.array([0, -0.5e5, -0.2e5, -1.1e5, -1e5])
        self.write("u.csv", "t,p\n" + "".join(f"{a!r},{b!r}\n" for a, b in zip(t.tolist(), p.tolist())))
        y, x = numpy.linspace(0, 1, 4), numpy.linspace(0, 1, 6)
        self.field("u.nc", t, y, x, numpy.broadcast_to(p[:, None, None], (5, 4, 6)))
        for how, words in HOW.items():
            loads = ["{series: {file: u.csv, time: t, value: 'p:Pa'}}", "{field: {file: u.nc, variable: p}}"]
            if how == "events":  # follows no `series`
                loads[0] = "{ramp: {rate: -1.25 Pa/s}}"
                ends = numpy.array([0, -81920.0])
                self.field("u.nc", numpy.array([0, 65536.0]), y, x, numpy.broadcast_to(ends[:, None, None], (2, 4, 6)))
                words = (*words, "--set", "time.end=65536")
            once = self.follow(self.UNIFORM.replace("{LOAD}", loads[0]), *SMALL, *words)
            numbers = self.numbers()
            again = self.follow(self.UNIFORM.replace("{LOAD}", loads[1]), *SMALL, *words)
            with self.subTest(how):
                self.assertTrue(once["failed"])
                self.assertGreater(once["failure_time_s"], 2 * 3600)
                self.assertEqual(once["failure_time_s"], again["failure_time_s"])
                self.assertEqual(numbers, self.numbers())

    def test_what_presses_is_water_that_draws(self):
        """p_i(t) = p_i (1 + (s_i - u_i) L^2/P): a stress is a suction of its size, but for what the file calls it."""
        x, y = numpy.linspace(0, 1, 6), numpy.linspace(0, 1, 4)
        here = x[None, :] * y[:, None]
        self.field("n.nc", numpy.array([0, 1, 24.0]), y, x, numpy.array([1e2 + 0 * here, 2e2 + 6e2 * here, 1e2 - 3e2 * here]),
                   "kPa", "hours")
        load = "{field: {file: n.nc, variable: p%s}}"
        wet = JOINT.replace("{LOAD}", load % ", scale: -1")
        dry = JOINT.replace("pore_pressure: [{LOAD}]", "normal_stress: [" + load % "" + "]")
        named = ("normal_force", "apparent_friction", "pore_pressure", "effective_ratio")
        for how in "rate", "traction", "events":
            words = (*HOW[how], "--set", "output.fields=[slip, slip_rate, traction, pore_pressure]")
            self.follow(wet, *words)
            numbers = self.numbers()
            self.follow(dry, *words)
            now = self.numbers()
            for name in numbers.keys() & now.keys() - {*named, "cell_pore_pressure"}:
                self.assertEqual(numbers[name], now[name], (how, name))
            t, normal, effective, ratio, shear, pore, p, at_x, at_y = self.snapshots(
                "time", "normal_force", "effective_normal_force", "apparent_friction", "shear_force",
                "cell_pore_pressure", "pressure", "x", "y")
            self.assertTrue((pore == 0).all() and "pore_pressure" not in now)
            # the force over the joint, summed here; s follows straight lines
            shape = at_x * at_y
            inner, tilt = numpy.interp(t / 3600, [0, 1, 24], [1e5, 2e5, 1e5]), numpy.interp(t / 3600, [0, 1, 24], [0, 6e5, -3e5])
            added = p[None, :] * (inner[:, None] + tilt[:, None] * shape[None, :]) / 3e6
            total = ((p[None, :] + added) / 64).sum(axis=1)
            self.assertLess(numpy.abs(normal / total - 1).max(), 1e-12)
            self.assertLess(numpy.abs(effective / normal - 1).max(), 1e-12)
            self.assertLess(numpy.abs(ratio * normal / shear - 1).max(), 1e-12)

    def test_each_cell_is_a_block_under_its_own_stress(self):
        """Cells that nothing ties follow a block each, whose normal load is what presses them."""
        y = x = numpy.array([0.25, 0.75])
        p = 1e3 * numpy.array([[0, 400], [-800, 200]])
        self.field("f.nc", None, y, x, p)
        case = """\
lacuna: 1
interface: {size: "1 m", levels: LEVELS, domain: {full: {}}}
load: {normal: {pressure: PRESSURE}, pore_pressure: [{ramp: {rate: "1 kPa/day"}}]STRESS}
friction: {aging: {f0: 0.6, a: 0.012, b: 0.008, dc: "0.1 mm", v0: "1 um/s", alpha: 0.1}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.9}}
transfer: {none: {}}
time: {end: "10 day"}
solver: {rtol: 1e-9}
output: {file: out.nc, fields: [slip, traction], fields_every: "5 day"}
"""
        self.follow(case.replace("LEVELS", "1").replace("PRESSURE", "3 MPa")
                    .replace("STRESS", ", normal_stress: [{field: {file: f.nc, variable: p}}]"))
        slip, traction, at_x, at_y = self.snapshots("cell_slip", "cell_traction", "x", "y")
        for i, (column, row) in enumerate(zip(numpy.searchsorted(x, at_x), numpy.searchsorted(y, at_y))):
            self.follow(case.replace("LEVELS, domain: {full: {}}", "0").replace("STRESS", "")
                        .replace("PRESSURE", repr(3e6 + p[row, column])))
            alone, load = self.snapshots("cell_slip", "cell_traction")
            self.assertTrue(numpy.allclose(slip[-1, i], alone[-1, 0], rtol=1e-6))
            self.assertTrue(numpy.allclose(traction[0, i], load[0, 0], rtol=1e-12))
        self.assertGreater(slip[-1].max() / slip[-1].min(), 1.02)


class Sources(Fields):
    def test_gaussian_source(self):
        """BP8-QD-GS: 13.06 MPa at the well after 100 h, 7.357, 2.563 and 0.795 at 100, 200 and 300 m; and the sum of
        Gaussians that were let go one after the other, by quadrature."""
        load = "{injection: {rate: 0.003 m3/s, x: 750 m, y: 850 m, radius: 50 m, thickness: 1 m, diffusivity: " \
               "0.05 m2/s, compressibility: 1e-8 Pa-1, porosity: 0.1, start: 20 hour, stop: 120 hour}}"
        case = STILL.replace("INTERFACE", 'size: "1.6 km", levels: 4').replace("{LOAD}", load)
        self.follow(case.replace("END", "220 hour").replace("EVERY", "20 hour"))
        t, pore, x, y = self.snapshots("snapshot_time", "cell_pore_pressure", "x", "y")
        r = numpy.hypot(x - 750, y - 850)
        at = {d: pore[:, numpy.abs(r - d) < 1e-6][:, 0] for d in (0, 100, 200, 300)}
        self.assertTrue((pore[t <= 72000] == 0).all())
        end = int(numpy.argmin(numpy.abs(t - 432000)))
        for d, value in ((0, 13.06e6), (100, 7.357e6), (200, 2.563e6), (300, 0.795e6)):
            self.assertAlmostEqual(at[d][end], value, delta={0: 5e3, 300: 500}.get(d, 500))
        # at pumping for tau, and when it has ended: Gaussians of variance L^2 + 2 alpha age
        nodes, weights = numpy.polynomial.legendre.leggauss(200)
        for k in (end - 3, end, end + 3):
            first, last = max(0.0, t[k] - 432000), t[k] - 72000
            age = first + 0.5 * (last - first) * (nodes + 1)
            s = 2500 + 2 * 0.05 * age
            for d in at:
                shape = numpy.exp(-d * d / (2 * s)) / (2 * math.pi * s)
                exact = 0.003 / (1e-8 * 0.1 * 1) * 0.5 * (last - first) * (weights * shape).sum()
                self.assertAlmostEqual(at[d][k] / exact, 1, delta=1e-9)

    def test_line_source(self):
        """BP6-QD: 6.56 MPa at the line when pumping ends after 100 d, and the sum of the sources of all moments."""
        load = "{line_injection: {flux: 1.25e-6 m/s, x: 2.05 km, diffusivity: 0.1 m2/s, compressibility: 1e-8 Pa-1, " \
               "porosity: 0.1, stop: 100 day}}"
        case = STILL.replace("INTERFACE", 'size: "6.4 km", levels: 6, shape: line').replace("{LOAD}", load)
        for formulation in "rate", "traction":
            self.follow(case.replace("END", "150 day").replace("EVERY", "50 day"), "--set", "solver.rtol=1e-9",
                        *HOW[formulation])
            pore, x, residual = self.snapshots("cell_pore_pressure", "x", "balance_residual")
            self.assertLess(residual.max(), 1e-5)
            source = int(numpy.argmin(numpy.abs(x - 2050)))
            self.assertAlmostEqual(pore[2, source], 6.56e6, delta=5e3)
            # p = q0/(beta phi) int exp(-z^2/4 alpha s)/sqrt(4 pi alpha s) ds over the ages s = a^2 of what came
            nodes, weights = numpy.polynomial.legendre.leggauss(300)
            for k, (young, old) in {1: (0, 50), 2: (0, 100), 3: (50, 150)}.items():
                low, high = math.sqrt(young * 86400), math.sqrt(old * 86400)
                a = low + 0.5 * (high - low) * (nodes + 1)
                for i in (source, source + 1, source + 5, source - 12):
                    z = x[i] - 2050
                    shape = 2 * numpy.exp(-z * z / (0.4 * a * a)) / math.sqrt(0.4 * math.pi)
                    exact = 1.25e-6 / 1e-9 * 0.5 * (high - low) * (weights * shape).sum()
                    self.assertAlmostEqual(pore[k, i], exact, delta=1e-7 * exact + 1e-3)


def spread(source, widths, cells, alpha, times, stop):
    """Diffusion between closed borders by finite differences of second order, explicit in time; `source` per time and
    area at the centres of the cells. The pressure at each time."""
    steps = [w / n for w, n in zip(widths, cells)]
    longest = 0.5 / sum(2 * alpha / h**2 for h in steps)
    now, p, seen = 0.0, numpy.zeros(source.shape), []
    for end in times:
        for a, b in ((now, min(end, stop)), (max(now, stop), end)):
            count = math.ceil(max(0.0, b - a) / longest)
            for _ in range(count):
                change = source.copy() if b <= stop else 0 * source
                for axis, h in enumerate(steps):
                    flow = numpy.diff(p, axis=axis) * (alpha / h**2)
                    every = (slice(None),) * axis
                    change[(*every, slice(None, -1))] += flow
                    change[(*every, slice(1, None))] -= flow
                p = p + (b - a) / count * change
        now = end
        seen.append(p)
    return numpy.array(seen)


class Borders(Fields):
    """boundary: no-flux, by mirrors early and cosines late."""

    def test_a_well(self):
        """Against finite differences on two grids; what came in is in the joint; until the border is felt, no border."""
        well = {"rate": "0.003 m3/s", "x": "200 m", "y": "350 m", "radius": "60 m", "thickness": "1 m", "boundary": "BORDER",
                "diffusivity": "0.05 m2/s", "compressibility": "1e-8 Pa-1", "porosity": 0.1, "start": "10 hour",
                "stop": "200 hour"}
        load = "{injection: {" + ", ".join(f"{k}: {v}" for k, v in well.items()) + "}}"
        case = STILL.replace("INTERFACE", 'size: "640 m", levels: 5').replace("{LOAD}", load)
        case = case.replace("END", "610 hour").replace("EVERY", "20 hour")
        self.follow(case.replace("BORDER", "none"))
        free, = self.snapshots("cell_pore_pressure")
        self.follow(case.replace("BORDER", "no-flux"))
        t, pore, at_x, at_y = self.snapshots("snapshot_time", "cell_pore_pressure", "x", "y")
        came = 0.003 * (numpy.clip(t, 36000, 720000) - 36000) / (1e-9 * 640**2)
        self.assertLess(numpy.abs(pore.mean(axis=1) - came).max(), 1e-12 * came.max())
        near = numpy.hypot(at_x - 200, at_y - 350) < 40
        felt = numpy.abs(pore[1:, near] / free[1:, near] - 1).max(axis=1)
        self.assertGreater(felt[-1], 1)
        self.assertLess(felt[0], 1e-4)  # exp(-360^2/(2 s)) and less of a mirror, s = 60^2 + 2 alpha 10 h
        grids = []
        for n in (64, 128):
            h = 640 / n
            x = (numpy.arange(n) + 0.5) * h
            shape = sum(numpy.exp(-((x[None, :] - a)**2 + (x[:, None] - b)**2) / 7200)
                        for a in (200, -200, 1080) for b in (350, -350, 930)) / (7200 * math.pi)
            there = spread(0.003 / 1e-9 * shape, (640, 640), (n, n), 0.05, t[1:] - 36000, 684000)
            fine = n // 32  # the centre of a cell is a corner of these: their mean is off by as much at each refinement
            grids.append(there.reshape(len(t) - 1, 32, fine, 32, fine))
        rows, columns = (at_y / 20).astype(int), (at_x / 20).astype(int)
        centre = [g[:, :, g.shape[2] // 2 - 1:g.shape[2] // 2 + 1, :, g.shape[2] // 2 - 1:g.shape[2] // 2 + 1].mean(axis=(2, 4))
                  for g in grids]
        exact = (4 * centre[1] - centre[0])[:, rows, columns] / 3
        for k in range(len(t) - 1):
            self.assertLess(numpy.abs(pore[k + 1] - exact[k]).max(), 2e-4 * pore[k + 1].max(), t[k + 1] / 3600)

    def test_a_line(self):
        line = "{line_injection: {flux: 1.25e-6 m/s, x: 1 km, boundary: no-flux, diffusivity: 0.5 m2/s, compressibility: " \
               "1e-8 Pa-1, porosity: 0.1, stop: 20 day}}"
        case = STILL.replace("INTERFACE", 'size: "3.2 km", levels: 6, shape: line').replace("{LOAD}", line)
        self.follow(case.replace("END", "80 day").replace("EVERY", "4 day"), *HOW["traction"])
        t, pore, at_x = self.snapshots("snapshot_time", "cell_pore_pressure", "x")
        grids = []
        for n in (128, 256):
            source = numpy.zeros(n)
            edge = n * 1000 // 3200  # the line is between two cells
            source[edge - 1:edge + 1] = 0.5 * 1.25e-6 / 1e-9 * n / 3200
            there = spread(source, (3200,), (n,), 0.5, t[1:], 20 * 86400)
            middle = there.reshape(len(t) - 1, 64, n // 64)
            grids.append(middle[:, :, n // 128 - 1:n // 128 + 1].mean(axis=2))
        exact = (4 * grids[1] - grids[0]) / 3
        away = numpy.abs(at_x - 1000) > 60
        for k in range(len(t) - 1):
            here = exact[k][(at_x / 50).astype(int)]
            self.assertLess(numpy.abs(pore[k + 1] - here)[away].max(), 5e-4 * pore[k + 1].max(), t[k + 1] / 86400)
        came = 1.25e-6 * numpy.minimum(t, 20 * 86400) / (1e-9 * 3200)
        bend = 1.25e-6 / (1e-9 * 0.5)  # of the pressure at the line: centres of cells take it for h^2/24 of it
        centres = numpy.where((t > 0) & (t <= 20 * 86400), bend * 50**2 / 24 / 3200, 0)
        self.assertLess(numpy.abs(pore.mean(axis=1) - came + centres).max(), 1e-10 * came[-1])
        self.assertLess(pore[-1].std() / came[-1], 0.1)


class WaterTable(Fields):
    def test_a_lake_over_the_toe(self):
        """The level rises over a joint that falls by 30 degrees: gamma max(0, level - z) at every place."""
        self.write("lake.csv", "t,level\n0,80\n10,95\n20,70\n")
        load = "{water_table: {file: lake.csv, time: t, column: 'level:m', elevation: 100 m, angle: 30 degree}}"
        case = STILL.replace("INTERFACE", 'size: "64 m", levels: 3').replace("{LOAD}", load)
        for how in "rate", "events":
            self.follow(case.replace("END", "20 s").replace("EVERY", "1 s"), *HOW[how],
                        "--set", "transfer={hierarchy: {k0: 1 GPa/m, ratio: 0.5}}")
            t, pore, x = self.snapshots("snapshot_time", "cell_pore_pressure", "x")
            level = numpy.interp(t, [0, 10, 20], [80, 95, 70])
            z = 100 - 0.5 * x
            exact = 9806.65 * numpy.maximum(0, level[:, None] - z[None, :])
            self.assertEqual(len(t), 21)
            self.assertLess(numpy.abs(pore - exact).max(), 1e-6)
            self.assertTrue((pore[0] == 0).any() and (pore[0] > 0).any())

    def test_a_constant_level(self):
        load = "{water_table: {level: 90 m, elevation: 100 m, angle: 30 degree, unit_weight: 10 kPa/m}}"
        case = STILL.replace("INTERFACE", 'size: "64 m", levels: 3').replace("{LOAD}", load)
        self.follow(case.replace("END", "20 s").replace("EVERY", "10 s"))
        pore, x = self.snapshots("cell_pore_pressure", "x")
        self.assertLess(numpy.abs(pore - 1e4 * numpy.maximum(0, 0.5 * x - 10)).max(), 1e-6)


    def test_a_fringe(self):
        """u = gamma w ln(1 + exp(head/w)); readings alone are breaks, so that columns cost no steps."""
        self.write("lake.csv", "t,level\n0,80\n10,95\n20,70\n")
        load = "{water_table: {file: lake.csv, time: t, column: 'level:m', elevation: 100 m, angle: 30 degree, fringe: 0.5 m}}"
        case = STILL.replace("INTERFACE", 'size: "64 m", levels: 5').replace("{LOAD}", load)
        case = case.replace("END", "20 s").replace("EVERY", "1 s")
        self.follow(case)
        t, pore, x = self.snapshots("snapshot_time", "cell_pore_pressure", "x")
        head = numpy.interp(t, [0, 10, 20], [80, 95, 70])[:, None] - (100 - 0.5 * x)[None, :]
        self.assertLess(numpy.abs(pore - 9806.65 * 0.5 * numpy.logaddexp(0, head / 0.5)).max(), 1e-6)
        self.assertIn("solver.fidelity events follows loads that are linear in time",
                      self.expect(2, "run", "c.yaml", "-o", "no.nc", *HOW["events"],
                                  "--set", "transfer={hierarchy: {k0: 1 GPa/m, ratio: 0.5}}").stderr)
        bundled = os.path.join(test_cli.SOURCE, "cases/load/water-table.yaml")
        steps, slip = {}, {}
        for fringe, levels in itertools.product((0, 0.1, 0.5), (4, 6)):
            done = json.loads(self.expect(0, "run", bundled, "-o", "out.nc", "--force", "--json", "--set",
                                          f"interface.levels={levels}", "--set",
                                          f"load.pore_pressure.0.water_table.fringe={fringe} m").stdout)
            steps[fringe, levels], slip[fringe, levels] = done["steps"], done["mean_slip_m"]
        self.assertLess(steps[0.5, 6], 1.3 * steps[0.5, 4])
        self.assertLess(8 * steps[0.5, 6], steps[0, 6])
        for levels in 4, 6:
            self.assertAlmostEqual(slip[0.1, levels] / slip[0, levels], 1, delta=1e-4)
            self.assertAlmostEqual(slip[0.5, levels] / slip[0, levels], 1, delta=2e-3)


class Fitted(Fields):
    def test_a_load_over_the_joint_is_found(self):
        """Readings of a run with water, a well and a heap are fitted by its scene: how heavy the heap is comes back."""
        x, y = numpy.linspace(0, 1, 5), numpy.linspace(0, 1, 5)
        here = numpy.exp(-((x[None, :] - 0.3)**2 + (y[:, None] - 0.6)**2) / 0.1)
        there = numpy.exp(-((x[None, :] - 0.8)**2 + (y[:, None] - 0.2)**2) / 0.1)
        t = numpy.array([0, 5, 10, 40]) * 86400.0
        self.field("w.nc", t, y, x, 4e5 * numpy.array([0, 1, 0, 0])[:, None, None] * here)
        self.field("h.nc", t, y, x, 4e5 * numpy.array([0, 0, 0, 1])[:, None, None] * there)
        case = """\
lacuna: 1
interface: {size: "1 m", levels: 2, domain: {full: {}}}
load:
  normal: {pressure: "3 MPa"}
  pore_pressure:
    - field: {file: w.nc, variable: p, scale: 1.5}
    - injection: {rate: 2e-12, x: 0.7, y: 0.7, radius: 0.1, thickness: 0.01, diffusivity: 2e-7, compressibility: 1e-8,
                  porosity: 0.1, start: 15 day, stop: 20 day, boundary: no-flux}
  normal_stress: [{field: {file: h.nc, variable: p, scale: 0.8}}]
friction: {aging: {f0: 0.6, a: 0.015, b: 0.010, dc: "0.1 mm", v0: "1 um/s"}}
initial: {slip_rate: "0.1 mm/day", state: steady}
transfer: {hierarchy: {k0: "1 GPa/m", ratio: 0.5}}
time: {end: "40 day"}
output: {every: "1 day"}
"""
        self.follow(case)
        time, slip = self.snapshots("time", "slip")
        self.write("s.csv", "t_s,slip_mm\n" + "".join(f"{a!r},{1e3 * b:.2f}\n" for a, b in zip(time.tolist(), slip.tolist())))
        key = "load.normal_stress.0.field.scale"
        self.write("c.yaml", case + "fit:\n  time: t_s\n  displacement: 'slip_mm:mm'\n  steps: 0\n  starts: 3\n  parameters:\n"
                   + f"    {key}: {{range: [0.1, 2]}}\n")
        done = self.expect(0, "fit", "c.yaml", "s.csv", "-o", "fit.nc", "--json", "--force", "--set", f"{key}=1.2")
        found = json.loads(done.stdout)["parameters"][0]
        self.assertEqual(found["key"], key)
        self.assertAlmostEqual(found["best"] / 0.8, 1, delta=2e-3)


class Refusals(Fields):
    def refuse(self, status, message, load, *words):
        self.write("c.yaml", FINE.replace("{LOAD}", load))
        self.expect_line(status, "c.yaml: " + message, "run", "c.yaml", "-o", "no.nc", *words)
        self.assertFalse(self.exists("no.nc"))

    def test_lines(self):
        x, y, q = numpy.linspace(0, 1, 3), numpy.linspace(0, 1, 2), numpy.full((2, 3), 1e5)
        field = "{field: {file: %s, variable: p}}"
        within = "load.pore_pressure.0.field: "
        self.field("half.nc", None, y, 0.5 * x, q)
        self.refuse(2, within + "half.nc: covers x = 0 to 0.5 m, y = 0 to 1 m, and not a cell at x = 0.53125 m, y = "
                    "0.03125 m; must cover the joint, or say outside: hold", field % "half.nc")
        self.expect(0, "run", "c.yaml", "-o", "out.nc", "--set", "load.pore_pressure.0.field.outside=hold")
        self.field("short.nc", numpy.array([0, 43200.0]), y, x, [q, q])
        self.refuse(2, within + "short.nc: ends 43200 s before the run's end; must reach it, or say outside: hold",
                    field % "short.nc")
        self.field("metre.nc", None, y, x, q, "m")
        self.refuse(2, within + 'metre.nc: p: unit "m": must be a pressure such as "1 MPa"', field % "metre.nc")
        self.field("hole.nc", None, y, x, [[1e5, numpy.nan, 1e5], [1e5, 1e5, 1e5]])
        self.refuse(2, within + "hole.nc: p has no value around x = 0.03125 m, y = 0.03125 m, where the faces touch",
                    field % "hole.nc")
        self.field("down.nc", None, y[::-1], x, q)
        self.refuse(2, within + "down.nc: y[1] = 0; must be a number, and above the one before", field % "down.nc")
        self.field("high.nc", None, y, x, 40 * q)
        self.refuse(2, "initial: the pore pressure of cell 0, at x = 0.03125 m, y = 0.03125 m, is 4e+06 Pa at t = 0 s; "
                    "must be below the mean normal stress, 3e+06 Pa", field % "high.nc")

    def test_lines_of_normal_stress(self):
        x = numpy.linspace(0, 1, 3)
        self.field("dug.nc", None, x, x, numpy.full((3, 3), -4e6))
        dug = FINE.replace("pore_pressure: [{LOAD}]", "normal_stress: [{LOAD}]")
        for status, message, case in (
                (2, "initial: the pore pressure less the added normal stress of cell 0, at x = 0.03125 m, y = 0.03125 m, is "
                 "4e+06 Pa at t = 0 s; must be below the mean normal stress, 3e+06 Pa",
                 dug.replace("{LOAD}", "{field: {file: dug.nc, variable: p}}")),
                (2, "load.normal_stress.0.field: dug.nc: has no variable \"q\"; its variables are y, x, p",
                 dug.replace("{LOAD}", "{field: {file: dug.nc, variable: q}}"))):
            with self.subTest(message):
                self.write("c.yaml", case)
                done = self.expect(status, "run", "c.yaml", "-o", "no.nc", "--force")
                self.assertIn(message, done.stderr)
        for message, case in (
                ('load.normal_stress: sums to -4 MPa at the start, which must leave some of the normal stress, 3 MPa',
                 dug.replace("{LOAD}", "{step: {value: -4 MPa, at: 0}}")),
                ('load.pore_pressure: sums to 1 MPa, which must be below the normal stress, 1 MPa',
                 dug.replace("{LOAD}", "{step: {value: -2 MPa, at: 0}}").replace(
                     "  normal_stress", "  pore_pressure: [{constant: {value: 1 MPa}}]\n  normal_stress")),
                ('load.normal_stress: is for runs; a step of load.history names its normal load itself',
                 dug.replace("{LOAD}", "{ramp: {rate: 1 Pa/s}}").replace(
                     "  normal_stress", "  history: {steps: [{ratio_x: 0.3}]}\n  normal_stress"))):
            with self.subTest(message):
                self.write("c.yaml", case)
                self.assertIn(message, self.expect(2, "check", "c.yaml").stderr)
        self.write("c.yaml", test_cli.BLOCK.replace("3 MPa\"}", "3 MPa\"}, normal_stress: [{step: {value: -3 MPa, at: 1 hour}}]"))
        done = self.expect(1, "run", "c.yaml", "-o", "out.nc", "--force")
        self.assertIn("the pore pressure less the added normal stress reaches the normal pressure at t = ", done.stderr)
        self.write("c.yaml", dug.replace("{LOAD}", "{field: {file: dug.nc, variable: p, scale: 0.1}}"))
        self.expect(0, "run", "c.yaml", "-o", "out.nc", "--force")
        self.assertIn("differs from cell to cell, which rg does not follow", self.expect(2, "rg", "out.nc").stderr)

    def test_a_source_within_borders(self):
        load = "{injection: {rate: 1e-9, x: X, y: 0.5, radius: 0.1, thickness: 1, diffusivity: 1e-6, " \
               "compressibility: 1e-8, porosity: 0.1, boundary: no-flux}}"
        within = "load.pore_pressure.0.injection: "
        self.refuse(2, within + "x = 1.5 m lies outside the joint, 0 to 1 m; boundary: no-flux needs it within",
                    load.replace("X", "1.5"))
        self.refuse(2, within + "boundary: no-flux is for a joint of shape plane; a line has line_injection",
                    load.replace("X", "0.5"), "--set", "interface={size: 1 m, levels: 4, shape: line, domain: {full: {}}}")
        self.write("c.yaml", FINE.replace("{LOAD}", load.replace("X", "0")))  # at the border
        self.expect(0, "run", "c.yaml", "-o", "out.nc")

    def test_a_cell_that_the_water_lifts_ends_the_run(self):
        p, x = numpy.zeros((2, 6, 6)), numpy.linspace(0, 1, 6)
        p[1, 5, 5] = 12e6
        self.field("l.nc", numpy.array([0, 86400.0]), x, x, p)
        self.write("c.yaml", FINE.replace("{LOAD}", "{field: {file: l.nc, variable: p}}").replace("b: 0.015",
                                                                                                   "b: 0.005"))
        for how in "rate", "traction", "slip", "events":
            done = self.expect(1, "run", "c.yaml", "-o", "out.nc", "--force", *HOW[how])
            self.assertIn("the pore pressure of cell", done.stderr, how)
            self.assertRegex(done.stderr, r"at x = 0.96875 m, y = 0.96875 m, is 3(.00003)?e\+06 Pa at t = 3034", how)

    def test_what_does_not_follow(self):
        load = "{injection: {rate: 1e-9, x: 0.5, y: 0.5, radius: 0.1, thickness: 1, diffusivity: 1e-6, " \
               "compressibility: 1e-8, porosity: 0.1}}"
        self.write("c.yaml", FINE.replace("{LOAD}", load))
        done = self.expect(2, "run", "c.yaml", "-o", "no.nc", *HOW["events"])
        self.assertIn("solver.fidelity events follows loads that are linear in time", done.stderr)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
