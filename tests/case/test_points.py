#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""output.points: what a run keeps of places, against the fields of its cells; readings beside a point, fits of
one, and its page.

usage: test_points.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy as np

PROGRAM, SOURCE, FOLDER = "", "", ""

SIZE = 64.0
# Cells of two thirds of the area, at rates far apart.
CASE = """\
lacuna: 1
interface: {size: 64 m, levels: 4, domain: {cascade: {dimension: 1.6, seed: 3}}}
material: {shear_modulus: 20 GPa, shear_speed: 3 km/s}
load: {normal: {pressure: 3 MPa}}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: 0.1 mm, v0: 1 um/s}}
initial: {slip_rate: 1 cm/week, state: {ratio_to_steady: 0.9}, spread: {slip_rate: {lognormal: {sigma: 0.8, seed: 2}}}}
transfer: {hierarchy: {stiffness: elastic}}
time: {end: 40 day}
output:
  fields: [slip, slip_rate, state, traction]
  fields_every: {steps: 1}
"""
# The same held together so weakly that each goes its own way.
LOOSE = CASE.replace("levels: 4", "levels: 3").replace("dc: 0.1 mm", "dc: 1 cm").replace("{stiffness: elastic}", "{k0: 1 MPa/m, ratio: 0.5}")
LOOSE = LOOSE[:LOOSE.index("output:")]
POINTS = [("P1", 12, 3, 0), ("edge", 63.9, 0, 0), ("prism 3", 30, 30, 10), ("far", 0.1, 63.9, 9)]
ASKED = "output.points=[" + ", ".join(f"{{name: {n}, x: {x} m, y: {y} m, radius: {r} m}}" for n, x, y, r in POINTS) + "]"
SEEN = {"point_slip": "cell_slip", "point_slip_rate": "cell_slip_rate", "point_traction": "cell_traction",
        "point_state": "cell_state"}
PLACED = {"point_name", "point_x", "point_y", "point_cell_x", "point_cell_y", "point_distance", "point_cells"}


def call(command, *words, status=0):
    done = subprocess.run([PROGRAM, command, *words], capture_output=True, text=True, check=False, cwd=FOLDER,
                          stdin=subprocess.DEVNULL)
    if done.returncode != status:
        raise AssertionError(f"{command} {words}: {done.returncode}\n{done.stderr}")
    return done


def write(name, text):
    path = os.path.join(FOLDER, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def run(name, *sets, case=CASE):
    """The opened file of a run of the case, and what was said of it."""
    path = os.path.join(FOLDER, f"{name}.nc")
    done = call("run", write(f"{name}.yaml", case), "-o", path, "--force", *[w for s in sets for w in ("--set", s)])
    return netCDF4.Dataset(path), done


def beside(file, x, y, periodic):
    """Along x and y from a place to every contact cell, the short way."""
    away = [np.abs(file["x"][:] - x), np.abs(file["y"][:] - y)]
    return [np.minimum(d, SIZE - d) if periodic else d for d in away]


class Fields(unittest.TestCase):
    """Points against the fields of all cells at the same records."""

    def compare(self, file, periodic=True):
        np.testing.assert_array_equal(file["time"][:], file["snapshot_time"][:])
        self.assertGreater(file.dimensions["time"].size, 20)
        cell = SIZE / 16
        self.assertEqual(list(file["point_name"][:]), [p[0] for p in POINTS])
        for k, (_, x, y, radius) in enumerate(POINTS):
            dx, dy = beside(file, x, y, periodic)
            away = np.hypot(dx, dy)
            nearest = np.argmin(away)
            cells = np.flatnonzero(away <= radius)
            cells = cells if len(cells) else [nearest]
            self.assertEqual(file["point_cells"][k], len(cells))
            self.assertEqual((file["point_x"][k], file["point_y"][k]), (x, y))
            self.assertEqual((file["point_cell_x"][k], file["point_cell_y"][k]), (file["x"][nearest], file["y"][nearest]))
            gap = np.hypot(max(0, dx[nearest] - cell / 2), max(0, dy[nearest] - cell / 2))
            self.assertAlmostEqual(file["point_distance"][k], gap, delta=1e-8)
            for name, field in SEEN.items():
                want = file[field][:][:, cells]
                got = file[name][:, k]
                if len(cells) == 1:
                    np.testing.assert_array_equal(got, want[:, 0])
                np.testing.assert_allclose(got, want.mean(axis=1), rtol=1e-14)
        self.assertGreater(len(set(file["point_cells"][:])), 2)
        self.assertGreater(file["point_distance"][0], 0)

    def test_methods(self):
        for extra in ([], ["solver.formulation=slip"], ["solver.formulation=traction", "solver.projection=true"],
                      ["solver.method=erk"], ["solver.fidelity=events", "output.every={steps: 60}", "output.fields_every={steps: 60}"], ["transfer={elastic: {}}"],
                      ["inertia={thickness: 10 m}", "material.density=2700 kg/m3"]):
            with self.subTest(extra):
                file, _ = run("method", ASKED, *extra)
                with file:
                    self.compare(file)

    def test_free_border(self):
        file, _ = run("free", ASKED, "interface.boundary=free", "transfer={elastic: {}}")
        with file:
            self.compare(file, periodic=False)

    def test_same_bits_beside_them(self):
        file, done = run("with", ASKED)
        bare, quiet = run("without")
        with file, bare:
            self.assertEqual(set(file.variables) - set(bare.variables), {*SEEN, *PLACED})
            for name in bare.variables:
                np.testing.assert_array_equal(file[name][:], bare[name][:])
        self.assertEqual(quiet.stderr, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertRegex(done.stderr, r"warning: output\.points: P1 is not in contact: .* [\d.]+ m away, at x \d+ m, y")

    def test_a_block_is_its_point(self):
        with open(os.path.join(SOURCE, "cases", "block.yaml"), encoding="utf-8") as text:
            file, done = run("block", "output.points=[{name: A}, {name: B, x: 3 m}]", case=text.read())
        with file:
            for k in range(2):
                np.testing.assert_array_equal(file["point_slip"][:, k], file["slip"][:])
                np.testing.assert_array_equal(file["point_slip_rate"][:, k], file["slip_rate"][:])
        self.assertEqual(done.stderr, "")

    def test_a_line(self):
        file, _ = run("line", "interface.shape=line", "interface.domain={full: {}}",
                      "output.points=[{name: A, x: 9 m}, {name: all, x: 0 m, radius: 1 km}]")
        with file:
            cell = int(np.flatnonzero(np.abs(file["x"][:] - 9) < 2)[0])
            np.testing.assert_array_equal(file["point_slip"][:, 0], file["cell_slip"][:, cell])
            np.testing.assert_allclose(file["point_slip"][1:, 1], file["slip"][1:], rtol=1e-13)
            self.assertEqual(list(file["point_cells"][:]), [1, 16])

    def test_floats(self):
        file, _ = run("floats", ASKED, "output.precision=float")
        with file:
            self.assertEqual(file["point_slip"].dtype, np.float32)
            np.testing.assert_array_equal(file["point_traction"][:, 0],
                                          file["cell_traction"][:, np.argmin(np.hypot(*beside(file, 12, 3, True)))])


class Wrong(unittest.TestCase):
    def test_one_line_each(self):
        case = write("wrong.yaml", CASE)
        for points, said in (
            ("[{name: A, x: 65 m, y: 3 m}]", "0.x: \"65 m\" lies outside of the joint, which reaches from 0 to 64 m"),
            ("[{name: A, x: 3 m, y: -1 mm}]", "0.y: \"-1 mm\" lies outside"),
            ("[{name: A, x: 3 m}]", "0: needs x and y"),
            ("[{x: 3 m, y: 3 m}]", "0.name: is missing"),
            ("[{name: A, x: 3 m, y: 3 m}, {name: A, x: 5 m, y: 3 m}]", "1.name: \"A\" is the name of a point above"),
            ("[{name: \"a\\nb\", x: 3 m, y: 3 m}]", "a name of 1 to 60 bytes that can be seen"),
            (f"[{{name: {'n' * 61}, x: 3 m, y: 3 m}}]", "a name of 1 to 60 bytes"),
            ("{name: A}", "must be a list such as"), ("[A]", "must be a mapping such as"),
            ("[{name: A, x: 3 s, y: 3 m}]", "must be a length"),
            ("[{name: A, x: 3 m, y: 3 m, radius: -1 m}]", "must be >= 0 m"),
            ("[{name: A, x: 3 m, y: 3 m, z: 1 m}]", "known: name, x, y, radius"),
            ("[" + "{name: A, x: 3 m, y: 3 m}," * 1001 + "]", "at most 1000"),
        ):
            with self.subTest(points[:60]):
                done = call("check", case, "--set", f"output.points={points}", status=2)
                self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
                self.assertIn(said, done.stderr)
        done = call("check", case, "--set", "interface.shape=line", "--set", ASKED, status=2)
        self.assertIn("has no place on a line: x alone", done.stderr)

    def test_names_of_none(self):
        case = write("named.yaml", CASE + "compare: [{file: a.csv, time: t, displacement: \"d:mm\", point: P9}]\n")
        done = call("check", case, "--set", ASKED, status=2)
        self.assertIn("compare.0.point: \"P9\" is none of the names in output.points", done.stderr)
        case = write("fitted.yaml", CASE + "fit: {parameters: {friction.aging.dc: {range: [1 mm, 1 m]}}, point: P9}\n")
        self.assertIn("fit.point: \"P9\" is none of", call("check", case, "--set", ASKED, status=2).stderr)

    def test_many_out_of_contact_are_counted(self):
        empty = ", ".join(f"{{name: E{k}, x: 12 m, y: 3 m}}" for k in range(9))
        _, done = run("many", f"output.points=[{empty}]")
        self.assertEqual(done.stderr.count("\n"), 6, done.stderr)
        self.assertIn("with 4 more", done.stderr)


class Readings(unittest.TestCase):
    """Readings made of the series of a point, with noise of 0.02 mm."""

    @classmethod
    def setUpClass(cls):
        file, _ = run("truth", ASKED, case=LOOSE)
        with file:
            cls.time, cls.slip, cls.rate = (file[n][:] for n in ("time", "point_slip", "point_slip_rate"))
            cls.mean = file["slip"][:]
            cls.end = float(file.failure_time_s)
        # The point that leaves the joint's mean the most.
        cls.k = int(np.argmax(np.abs(cls.slip[-1] - cls.mean[-1])))
        cls.at = np.linspace(0, 0.9 * cls.time[-1], 40)
        cls.seen = np.interp(cls.at, cls.time, cls.slip[:, cls.k]) + np.random.default_rng(1).normal(0, 2e-5, 40)
        cls.name = POINTS[cls.k][0]
        cls.csv = write("prism.csv", "t,d\n" + "".join(f"{t / 86400:.9f},{d * 1e3:.9f}\n" for t, d in zip(cls.at, cls.seen)))

    def test_compare(self):
        with open(self.csv, encoding="utf-8") as file:
            write("days.csv", file.read().replace("t,d", "t [day],d"))
        entry = '  - {{file: days.csv, time: "t [day]", displacement: "d:mm", label: here{}}}\n'
        path = write("compare.yaml", LOOSE + "compare:\n" + entry.format(f", point: {self.name}") + entry.format(""))
        words = [path, "-o", "compare.nc", "--force", "--set", ASKED]
        done = json.loads(call("run", *words, "--json").stdout)["compare"]
        self.assertEqual([c.get("point") for c in done], [self.name, None])
        for got, series in zip(done, (self.slip[:, self.k], self.mean)):
            rest = self.seen - np.interp(self.at, self.time, series)
            self.assertAlmostEqual(got["slip_rms_m"] / rest.std(), 1, delta=1e-5)
        self.assertLess(done[0]["slip_rms_m"], 3e-5)
        self.assertGreater(done[1]["slip_rms_m"], 30 * done[0]["slip_rms_m"])
        self.assertIn(f"beside here, at point {self.name}", call("run", *words).stdout)

    def test_fit(self):
        fit = "fit: {parameters: {friction.aging.dc: {range: [1 mm, 10 cm]}, initial.slip_rate: {range: [1 mm/week, " \
              "10 cm/week]}}, time: t, time_format: day, displacement: \"d:mm\", steps: 0, starts: 1, offset: none}\n"
        case = write("readings.yaml", LOOSE.replace("dc: 1 cm", "dc: 15 mm") + fit)
        done = json.loads(call("fit", case, "prism.csv", "-o", "fit.nc", "--force", "--json", "--set", ASKED, "--set",
                               f"fit.point={self.name}").stdout)
        with netCDF4.Dataset(os.path.join(FOLDER, "fit.nc")) as file:
            self.assertEqual(file.point, self.name)
        self.assertEqual(done["point"], self.name)
        best = {p["key"]: p["best"] for p in done["parameters"]}
        self.assertAlmostEqual(best["friction.aging.dc"] / 0.01, 1, delta=0.01)
        self.assertAlmostEqual(best["initial.slip_rate"] / (0.01 / 604800), 1, delta=0.01)
        self.assertAlmostEqual(done["rms_m"], 2e-5, delta=5e-6)
        self.assertFalse(done["fits_badly"])
        self.assertAlmostEqual(done["best_failure_time_s"] / self.end, 1, delta=3e-3)


class Page(unittest.TestCase):
    @staticmethod
    def data(*words):
        call("report", *words, "-o", "page.html", "--force")
        with open(os.path.join(FOLDER, "page.html"), encoding="utf-8") as file:
            return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', file.read(), re.DOTALL)[1])

    def test_points_stand_on_it(self):
        file, _ = run("paged", ASKED)
        with file:
            write("seen.csv", "t,d\n" + "".join(f"{t:.6f},{d * 1e3:.9f}\n" for t, d in zip(file["time"][::9], file["point_slip"][::9, 2])))
            page = self.data("paged.nc")
            points = page["points"]
            self.assertEqual(points["name"], [p[0] for p in POINTS])
            self.assertEqual(points["cells"], list(file["point_cells"][:]))
            np.testing.assert_allclose(points["distance"], file["point_distance"][:], rtol=1e-7)
            for k in range(len(POINTS)):
                want = np.interp(points["time"], file["time"][:], file["point_slip"][:, k])
                np.testing.assert_allclose(points["slip"][k], want, rtol=1e-5, atol=1e-12)
            columns = ["--time", "t", "--displacement", "d:mm", "--compare", "seen.csv"]
            series = self.data("paged.nc", *columns, "--point", "prism 3")["series"]
            self.assertEqual(series["point"], "prism 3")
            self.assertLess(series["slip_rms"], 1e-8)
            self.assertGreater(self.data("paged.nc", *columns)["series"]["slip_rms"], 100 * series["slip_rms"])
        self.assertNotIn("points", self.data(run("bare")[0].filepath()))
        self.assertIn("has no point \"P9\"", call("report", "paged.nc", *columns, "--point", "P9", "-o", "page.html", "--force", status=2).stderr)
        self.assertIn("--compare SERIES", call("report", "paged.nc", "--point", "P1", "-o", "page.html", "--force", status=2).stderr)


class Tables(unittest.TestCase):
    def test_export(self):
        file, _ = run("tabled", ASKED)
        with file:
            text = call("export", "tabled.nc", "--variable", "point_slip").stdout.splitlines()
            self.assertEqual(text[0], "time [s],point_name,point_x [m],point_y [m],point_slip [m]")
            self.assertEqual(len(text), 1 + file["point_slip"].size)
            last = text[-2].split(",")
            self.assertEqual((last[1], float(last[-1])), ("prism 3", file["point_slip"][-1, 2]))


if __name__ == "__main__":
    PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
    FOLDER = tempfile.mkdtemp()
    try:
        unittest.main(argv=sys.argv[:1] + sys.argv[3:], exit=False).result.wasSuccessful() or sys.exit(1)
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)
