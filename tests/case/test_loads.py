#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads that change in time, from the case to the file, as users meet them.

usage: test_loads.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import csv
import datetime
import json
import math
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

START = datetime.date(1961, 1, 1)


def bundled(name):
    return os.path.join(test_cli.SOURCE, "cases", "load", name + ".yaml")


class Loads(Case):
    def follow(self, case, *words):
        done = self.expect(0, "run", case, "--json", "--force", "-o", "out.nc", *words)
        return json.loads(done.stdout)

    def data(self):
        return netCDF4.Dataset(self.path("out.nc"))


class Reservoir(Loads):
    def lake(self):
        with open(os.path.join(test_cli.SOURCE, "cases", "data", "lake.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        days = [(datetime.date.fromisoformat(row["date"]) - START).days for row in rows]
        return numpy.array(days) * 86400.0, numpy.array([float(row["level_m"]) for row in rows])

    STEP = 300.0

    def pore(self, t):
        """The pressure by small steps, 12 an hour, of a straight-line level and a lag of 20 days."""
        times, level = self.lake()
        drive = 0.12 * 9806.65 * numpy.maximum(numpy.interp(t + 0.5 * self.STEP, times, level) - 640, 0)
        gone = -math.expm1(-self.STEP / (20 * 86400.0))
        u, out = 0.0, numpy.empty(t.size)
        for i, p in enumerate(drive):
            out[i] = u
            u += (p - u) * gone
        return out

    def creep(self, ratio):
        """Slip rates of the block by small steps of its state, exact at a constant slip rate."""
        a, b, dc, v0 = 0.012, 0.008, 5e-3, 1e-3 / 86400
        v = 0.05e-3 / 86400
        theta = dc / v
        f0 = ratio[0] - (a - b) * math.log(v / v0)
        out = numpy.empty(ratio.size)
        for i, f in enumerate(ratio):
            v = v0 * math.exp((f - f0 - b * math.log(v0 * theta / dc)) / a)
            out[i] = v
            theta = dc / v + (theta - dc / v) * math.exp(-v * self.STEP / dc)
        return out

    def test_the_water_and_the_slope(self):
        self.assertFalse(self.follow(bundled("reservoir"))["failed"])
        with self.data() as data:
            t, v = data["time"][:].data, data["slip_rate"][:].data
            normal, shear = data["normal_force"][:].data, data["shear_force"][:].data
            pore = normal - data["effective_normal_force"][:].data
        grid = numpy.arange(0, t[-1] + self.STEP, self.STEP)
        water = self.pore(grid)
        self.assertLess(numpy.abs(pore - numpy.interp(t, grid, water)).max(), 1e-4 * pore.max())
        rate = numpy.interp(t, grid, self.creep(shear[0] / (normal[0] - water)))
        self.assertLess(numpy.abs(v / rate - 1).max(), 2e-3)
        # It speeds up with the lake and stops with it.
        self.assertGreater(v.max() / v[0], 15)
        self.assertLess(v[-1] / v[0], 3)


class Triggering(Loads):
    """A pore step on a relaxing block: the threshold of docs/theory/loads.md, from the program's own state."""

    def test_threshold(self):
        self.follow(bundled("pore-step"), "--until", "2 day", "--set", "load.pore_pressure=[]")
        with self.data() as data:
            v = float(data["slip_rate"][-1])
            f = float(data["apparent_friction"][-1])
        # v/v_ss = x^-m, where v_ss is the steady rate at this f
        steady = 1e-6 * math.exp((f - 0.6) / (0.010 - 0.0135))
        rise = (0.0135 - 0.010) * -math.log(v / steady) / 1.35
        for factor in 0.99, 1.01:
            value = 5e6 * (1 - f / (f + factor * rise))
            done = self.follow(bundled("pore-step"), "--set", f"load.pore_pressure.0.step.value={value!r}",
                               "--set", "solver.rtol=1e-9", "--set", "time.end=10 year")
            self.assertEqual(done["failed"], factor > 1)


class Records(Loads):
    def test_a_record_is_its_own_sine(self):
        """`shaking` against the same accelerations read from CSV and from netCDF."""
        case = test_cli.BLOCK.replace("b: 0.015", "b: 0.005").replace("30 day", "12 s").replace(
            "state: {ratio_to_steady: 0.9}", "state: steady")
        t = numpy.arange(0, 10.0005, 0.001)
        a = 0.8 * numpy.sin(2 * numpy.pi * 1.5 * t)
        rows = "".join(f"{x:.3f},{y:.9f}\n" for x, y in zip(t, 100 * a))
        self.write("record.csv", "t,a\n" + rows)
        with netCDF4.Dataset(self.path("record.nc"), "w") as data:
            data.createDimension("t", t.size)
            data.createVariable("t", "f8", ("t",))[:] = t / 60
            data["t"].units = "minutes since 2024-01-01 00:00:00"
            data.createVariable("a", "f8", ("t",))[:] = a / 9.80665
            data["a"].units = "gravity"
        load = {
            "sine": "shaking: {acceleration: 0.8, frequency: 1.5 Hz, mass: 4e4, duration: 10}",
            "csv": "series: {file: record.csv, time: t, value: 'a:cm/s2', per: 4e4 kg/m2, outside: zero}",
            "netcdf": "series: {file: record.nc, time: t, value: 'a:m/s2', per: 4e4 kg/m2, outside: hold}",
        }
        slip = {}
        for name, text in load.items():
            self.write("c.yaml", case.replace("3 MPa\"}", "3 MPa\"}, shear: [{" + text + "}]"))
            slip[name] = self.follow("c.yaml", "--set", "solver.rtol=1e-9")["mean_slip_m"]
        self.assertAlmostEqual(slip["csv"] / slip["sine"], 1, delta=1e-4)
        self.assertAlmostEqual(slip["netcdf"] / slip["csv"], 1, delta=1e-6)
        still = self.write("s.yaml", case) or self.follow("s.yaml")["mean_slip_m"]
        self.assertGreater(abs(slip["sine"] / still - 1), 0.1)


class Refusals(Loads):
    def test_lines(self):
        case = test_cli.BLOCK.replace(
            "3 MPa\"}", "3 MPa\"}, pore_pressure: [{series: {file: p.csv, time: t, value: 'p:kPa'}}]")
        self.write("c.yaml", case)
        self.expect_line(3, "c.yaml: load.pore_pressure.0.series: p.csv: No such file or directory",
                         "run", "c.yaml", "-o", "out.nc")
        self.write("p.csv", "t,p\n0,1\n86400,2\n")
        self.expect_line(2, "c.yaml: load.pore_pressure.0.series: p.csv: ends 2.5056e+06 s before the run's end; "
                         "must reach it, or say outside: hold or zero", "run", "c.yaml", "-o", "out.nc")
        self.assertFalse(self.exists("out.nc"))
        done = self.expect(2, "check", "c.yaml", "--json")
        self.assertIn("ends 2.5056e+06 s", json.loads(done.stdout)["errors"][0]["message"])
        self.write("p.csv", "t,p\n0,4000\n1e9,4000\n")
        self.expect_line(2, "c.yaml: initial: pore pressure 4e+06 Pa is not below the normal pressure 3e+06 Pa at "
                         "the start", "run", "c.yaml", "-o", "out.nc")
        self.write("c.yaml", test_cli.BLOCK.replace(
            "3 MPa\"}", "3 MPa\"}, pore_pressure: [{step: {value: 4 MPa, at: 1 hour}}]"))
        done = self.expect(1, "run", "c.yaml", "-o", "out.nc")
        self.assertIn("the pore pressure reaches the normal pressure at t = ", done.stderr)


    def test_loads_that_cancel(self):
        """Of slip in two directions; the pull at the start is what rounding leaves of it."""
        self.write("c.yaml", """lacuna: 1
interface: {size: 1 m, slip: vector}
load: {normal: {pressure: 1 MPa}, shear: [{ratio: {value: 0.65}}, {ratio: {value: 0.65, azimuth: 180 degree}}]}
friction: {aging: {a: 0.01, b: 0.008, dc: 1 mm}}
initial: {slip_rate: 1 nm/s}
time: {end: 1 day}
""")
        for command in ("check", "run"):
            self.assertIn("load.shear: loads cancel at the start; must give a shear load",
                          self.expect(2, command, "c.yaml").stderr)
        self.expect(0, "check", "c.yaml", "--set", "load.shear.1.ratio.azimuth=179 degree")

    def test_check_opens_files(self):
        """On a grid too large to be built for a check, and a small one: a line for each, as run says it."""
        self.write("p.csv", "t,p\n0,1\n1e9,2\n")
        self.write("high.csv", "t,p\n0,4000\n1e9,4000\n")
        wrong = [("nowhere.csv", "p:kPa", "nowhere.csv: No such file or directory"),
                 ("p.csv", "q:kPa", 'p.csv:1: has no column "q"; its columns are t, p'),
                 ("p.csv", "p:m", '"m"')]
        for levels in (8, 4):
            series = ", ".join(f"{{series: {{file: {file}, time: t, value: '{value}'}}}}" for file, value, _ in wrong)
            case = test_cli.BLOCK.replace("3 MPa\"}", f"3 MPa\"}}, pore_pressure: [{series}]")
            grid = ["--set", f"interface={{size: 10 m, levels: {levels}, domain: {{full: {{}}}}}}"]
            self.write("c.yaml", case)
            done = self.expect(3, "check", "c.yaml", "--json", *grid)
            lines = done.stderr.splitlines()
            self.assertEqual(len(lines), len(wrong), done.stderr)
            found = json.loads(done.stdout)
            self.assertFalse(found["ok"])
            self.assertIsNone(found["estimate"])
            for i, (line, error) in enumerate(zip(lines, found["errors"])):
                key = f"load.pore_pressure.{i}.series"
                self.assertTrue(line.startswith(f"lacuna: c.yaml: {key}: "), line)
                self.assertIn(wrong[i][2], line)
                self.assertEqual([error["file"], error["key"]], ["c.yaml", key])
                self.assertTrue(line.endswith(error["message"]), line)
            self.expect_line(3, lines[0].removeprefix("lacuna: "), "run", "c.yaml", *grid)
            self.write("c.yaml", case.replace(series, "{series: {file: high.csv, time: t, value: 'p:kPa'}}"))
            self.expect_line(2, "c.yaml: initial: pore pressure 4e+06 Pa is not below the normal pressure 3e+06 Pa at "
                             "the start", "check", "c.yaml", *grid)
            self.write("c.yaml", case.replace(series, "{series: {file: p.csv, time: t, value: 'p:kPa'}}"))
            self.expect(0, "check", "c.yaml", *grid)
            self.expect_line(3, "c.yaml: friction.spread.dc: map.nc: No such file or directory", "check", "c.yaml",
                             *grid, "--set", "friction.spread={dc: {map: {file: map.nc}}}")

    def test_a_column_without_a_unit_is_asked_about(self):
        """As SI, with a warning, where its name leaves it open; refused where its name says another unit."""
        says = "load: p.csv: %s: no unit is named: taken as %s"
        loads = (("series: {file: p.csv, time: t, value: '%s'}", "p", "pressure_kPa", "Pa", "kPa"),
                 ("reservoir: {file: p.csv, time: t, level: '%s', elevation: 0 m}", "h", "h_cm", "m", "cm"),
                 ("rain: {file: p.csv, time: t, rain: '%s', rise: 9 kPa/m, drain: 1 day}", "fell", "fell (mm)", "m", "mm"))
        for load, plain, other, unit, wrong in loads:
            for column, given, lines, errors in (
                    (plain, plain, [says % (plain, unit)], []), (plain, f"{plain}:{unit}", [], []),
                    (f"{plain}_{unit}", f"{plain}_{unit}", [], []), (other, f"{other}:{wrong}", [], []),
                    (other, other, [], [f'p.csv:1: {other}: has no unit, and its name says {wrong}: which is it, '
                                        f'"{other}:{wrong}" or "{other}:{unit}"?'])):
                self.write("p.csv", f"t,{column}\n0,1\n1e9,2\n")
                self.write("c.yaml", test_cli.BLOCK.replace(
                    "3 MPa\"}", f"3 MPa\"}}, pore_pressure: [{{{load % given}}}]"))
                done = self.expect(2 if errors else 0, "check", "c.yaml", "--json")
                found = json.loads(done.stdout)
                self.assertEqual([f"{w['key']}: {w['message']}" for w in found["warnings"]], lines)
                self.assertEqual([e["message"] for e in found["errors"]], errors)
                self.assertEqual(done.stderr.count("warning"), len(lines))
                for line in lines:
                    for command in (["check", "c.yaml"], ["run", "c.yaml", "-o", "o.nc", "--force", "--until", "1 hour"]):
                        self.assertEqual(self.expect(0, *command).stderr.splitlines()[0],
                                         "lacuna: warning: c.yaml: " + line)
                        self.assertNotIn("warning", self.expect(0, *command, "-q").stderr)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
