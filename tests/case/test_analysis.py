#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`analysis: {rg: ...}` from the case to the file, against a recount from the cells' own fields.

usage: test_analysis.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4
import numpy as np

PROGRAM, SOURCE = "", ""
LAW = {"f0": 0.6, "a": 0.01, "b": 0.015, "dc": 4e-6, "v0": 1e-6}

LACUNAR = """
lacuna: 1
interface: {size: 1 m, levels: 5, boundary: BOUNDARY, domain: {cascade: {dimension: 1.6, seed: 3}}}
material: {shear_modulus: 15 GPa, poisson: 0.25, shear_speed: 1 km/s}
load: {normal: {pressure: 66 MPa}}
friction: {aging: {f0: 0.6, a: 0.01, b: 0.015, dc: 4 um, v0: 1 um/s}}
initial: {slip_rate: 1 cm/week, state: {ratio_to_steady: 0.7},
          spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}}
transfer: {hierarchy: {k0: 3e12, ratio: 0.5}}
time: {end: 1 day}
rg: {field: equal, beta: 0.6}
analysis: {rg: {}}
output: {fields: [slip_rate, state], fields_every: {steps: 1}, every: {steps: 1}}
"""

# A block on a spring too soft to hold it: it slips, sticks and heals, again and again.
STICK_SLIP = """
lacuna: 1
interface: {size: 2 m}
load: {normal: {pressure: 10 MPa}, shear: [{spring: {stiffness: 1 GPa/m, speed: 1 um/s}}]}
material: {shear_modulus: 15 GPa, shear_speed: 2 km/s}
friction: {aging: {f0: 0.6, a: 0.01, b: 0.015, dc: 10 um, v0: 1 um/s}}
initial: {slip_rate: 0.5 um/s, state: steady}
time: {end: 3 h, failure: {mean_slip_rate: 1000 m/s}}
analysis: {rg: {}}
output: {fields: [slip_rate, state], fields_every: {steps: 1}, every: {steps: 1}}
"""


def strength(state):
    return LAW["f0"] + LAW["b"] * np.log(LAW["v0"] * state / LAW["dc"])


def blocks_that_slip(x, y, slips, side):
    """Of squares of `side` cells: those all of whose cells slip, and how many there are."""
    block = (y // side) * 100000 + x // side
    _, number = np.unique(block, return_inverse=True)
    cells = np.bincount(number)
    return int((np.bincount(number, weights=slips) == cells).sum()), len(cells)


def longest(x, y, slips, nx, ny, periodic):
    """Longest side of a cluster of slipping cells [cells], by flooding."""
    left = set(zip(x[slips], y[slips]))
    best = 0
    while left:
        cluster = [left.pop()]
        for cx, cy in cluster:
            for dx in (-1, 0, 1):
                for dy in (-1, 0, 1):
                    near = (cx + dx, cy + dy)
                    near = (near[0] % nx, near[1] % ny) if periodic else near
                    if near in left:
                        left.remove(near)
                        cluster.append(near)
        # a connected set leaves out no line between its ends
        best = max(best, len({c[0] for c in cluster}), len({c[1] for c in cluster}))
    return best


def fitted_map(n_slip, n_tot):
    """lambda and C of the pairs as the slip fraction first comes to each 1/64."""
    s = n_slip / n_tot
    reached, first, second = 0, [], []
    for row in s:
        now = int(64 * row[0])
        if now > reached:
            reached = now
            for level in range(len(n_tot) - 1):
                if n_tot[level + 1] >= 8:
                    first.append(row[level])
                    second.append(row[level + 1])
    first, second = np.array(first), np.array(second)
    use = (first > 0.05) & (first < 0.95) & (second > 0.05) & (second < 0.95)
    u, w = (np.log(q[use] / (1 - q[use])) for q in (first, second))
    slope, shift = np.polyfit(u, w, 1)
    return use.sum(), slope, 1 / (1 + np.exp(shift / (slope - 1))) if slope > 1 else None


class Analysis(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-analysis-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, text, name="case.yaml"):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)
        return name

    def call(self, *words, status=0):
        done = subprocess.run([PROGRAM, *words], text=True, capture_output=True, cwd=self.folder,
                              check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def run_case(self, text, *settings, words=()):
        name = self.write(text.replace("BOUNDARY", "periodic"))
        sets = [word for setting in settings for word in ("--set", setting)]
        done = self.call("run", name, "-o", "out.nc", "--force", "--json", *words, *sets)
        return json.loads(done.stdout)

    def file(self, name="out.nc"):
        return netCDF4.Dataset(os.path.join(self.folder, name))

    def check_file(self):
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tests/support/check_cf.py"),
                               "--status", "complete", os.path.join(self.folder, "out.nc")],
                              text=True, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def recount(self, slipping, periodic=True, most=40):
        """Compares a file's counts with those of its own snapshots; returns the slip fractions."""
        with self.file() as data:
            nx, ny = int(data.grid_nx), int(data.grid_ny)
            x = np.floor(data["x"][:] / data.grid_dx_m).astype(int)
            y = np.floor(data["y"][:] / data.grid_dy_m).astype(int)
            n_slip, n_tot = data["n_slip"][:], data["n_tot"][:]
            records = len(data["time"])
            self.assertEqual(len(data["snapshot_time"]), records)
            state, rate = data["cell_state"][:], data["cell_slip_rate"][:]
            extents = data["correlation_length"][:]
            self.assertTrue(np.array_equal(data["slip_fraction"][:], n_slip[:, 0] / n_tot[0]))
            for k in range(0, records, max(1, records // most)):
                slips = slipping(state, rate, k)
                for level in range(len(n_tot)):
                    count, total = blocks_that_slip(x, y, slips, 2 ** level)
                    self.assertEqual((count, total), (n_slip[k, level], n_tot[level]), (k, level))
                side = data.grid_dx_m * longest(x, y, slips, nx, ny, periodic)
                if not np.ma.is_masked(extents[k]):  # not found anew yet
                    self.assertAlmostEqual(extents[k], side, delta=1e-12, msg=f"record {k}")
            self.assertGreater(extents.count(), 0.8 * records)
            return np.array(data["slip_fraction"][:])

    def test_by_strength(self):
        done = self.run_case(LACUNAR, "time.failure.mean_slip_rate=1 km/s")  # goes on to its own length
        fraction = self.recount(lambda s, v, k: strength(s[k]) <= 0.8 * strength(s[0]))
        self.assertEqual(fraction[0], 0)
        self.assertGreater(fraction[-1], 0.5)
        self.assertEqual(done["slip_fraction"], fraction[-1])
        self.assertIn("at most 0.8 of", done["slipping_cell"])
        self.check_file()

    def test_free_boundary_and_other_strength(self):
        self.run_case(LACUNAR.replace("BOUNDARY", "free"), "analysis.rg.slipping_strength=0.9")
        self.recount(lambda s, v, k: strength(s[k]) <= 0.9 * strength(s[0]), False)

    def test_by_rate(self):
        self.run_case(LACUNAR, "analysis.rg.slipping_rate=1 mm/s")
        self.recount(lambda s, v, k: v[k] >= 1e-3)
        done = self.run_case(LACUNAR, "analysis.rg.slipping_rate=2.5 cm/week")
        fraction = self.recount(lambda s, v, k: v[k] >= 0.025 / (7 * 86400))
        self.assertGreater(fraction[0], 0)  # the rates differ from the start
        self.assertTrue(np.any(np.diff(fraction) < 0))  # some cells slow down
        self.assertIn("at least 4.13", done["slipping_cell"])

    def test_line(self):
        self.run_case(LACUNAR.replace("boundary", "shape: line, boundary").replace("1.6", "0.8")
                      .replace("levels: 5", "levels: 7"))
        self.recount(lambda s, v, k: strength(s[k]) <= 0.8 * strength(s[0]))

    def test_sticking_again(self):
        done = self.run_case(STICK_SLIP)
        global LAW
        kept, LAW = LAW, dict(LAW, dc=10e-6)
        try:
            fraction = self.recount(lambda s, v, k: strength(s[k]) <= 0.85 * strength(s[0]),
                                    most=1000)
        finally:
            LAW = kept
        starts = int((np.diff(fraction) > 0).sum())
        ends = int((np.diff(fraction) < 0).sum())
        self.assertGreaterEqual(starts, 3)
        self.assertGreaterEqual(ends, starts - 1)
        # a block has no fixed point, which is no number
        self.assertIsNone(done["critical_fraction"])
        self.assertIsNone(done["criticality_max"])
        self.assertIsNone(done["run_lambda"])
        self.assertIn("a single block", done["critical_fraction_source"])
        self.assertEqual(done["correlation_length_max_m"], 2)
        with self.file() as data:
            self.assertTrue(np.ma.is_masked(data["critical_fraction"][:]))
            self.assertTrue(np.all(np.ma.getmaskarray(data["criticality"][:])))
            self.assertIn("a single block", data["critical_fraction"].comment)
            self.assertEqual(data["n_slip"].shape[1], 1)
        self.check_file()

    def test_load_drop_heals(self):
        """Cells that have lost their strength stick again where the load is taken back."""
        text = LACUNAR.replace("domain: {cascade: {dimension: 1.6, seed: 3}}", "domain: {full: {}}")
        text = text.replace("load: {normal: {pressure: 66 MPa}}",
                            "load: {normal: {pressure: 66 MPa}, "
                            "shear: [{ramp: {rate: -100 kPa/s, start: 900 s, end: 920 s}}]}")
        text = text.replace("k0: 1e12", "k0: 1e14")
        done = self.run_case(text, "analysis.rg.slipping_strength=0.97")
        self.assertFalse(done["failed"])
        fraction = self.recount(lambda s, v, k: strength(s[k]) <= 0.97 * strength(s[0]))
        self.assertGreater(fraction.max(), 0.3)
        self.assertEqual(fraction[-1], 0)

    def test_full_domain(self):
        text = LACUNAR.replace("domain: {cascade: {dimension: 1.6, seed: 3}}", "domain: {full: {}}")
        text = text.replace("spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}", "")
        done = self.run_case(text)
        with self.file() as data:
            self.assertEqual(set(np.unique(data["slip_fraction"][:])), {0, 1})
            at = data["slip_fraction"][:] == 1
            self.assertTrue(np.all(data["n_slip"][:][at] == data["n_tot"][:]))
            self.assertTrue(np.all(data["correlation_length"][:][at] == 1))
            self.assertTrue(np.all(data["correlation_length"][:][~at] == 0))
        self.assertIsNone(done["critical_fraction"])  # uniform: all slips at once, no map
        self.assertIn("too few", done["critical_fraction_source"])

    def test_critical_fraction(self):
        rough = ("interface.levels=5", "interface.surface.self-affine.seed=3")
        with open(os.path.join(SOURCE, "cases/rg/creep-to-failure.yaml"), encoding="utf-8") as file:
            done = self.run_case(file.read(), *rough, "output.every={steps: 1}",
                                 "rg.beta=0.5", "rg.shifts=5")
        sets = [word for setting in (*rough, "rg={field: equal, beta: 0.5, shifts: 5}")
                for word in ("--set", setting)]
        static = self.call("rg", "case.yaml", "--json", "-o", "rg.nc", *sets)
        static = json.loads(static.stdout)
        self.assertEqual(done["critical_fraction"], static["critical_fraction"])
        low, high = static["results"][0]["critical_fraction_interval95"]
        self.assertEqual((done["critical_fraction_low"], done["critical_fraction_high"]),
                         (low, high))
        self.assertIn("rule fix, field equal, beta 0.5, 5 places", done["critical_fraction_source"])
        with self.file() as data:
            c = float(data["critical_fraction"][:])
            self.assertEqual(c, static["critical_fraction"])
            ratio, fraction = data["criticality"][:], data["slip_fraction"][:]
            self.assertTrue(np.allclose(ratio, fraction / c, rtol=1e-15))
            self.assertEqual(done["criticality_max"], ratio.max())
            at = int(np.argmax(ratio >= 1))
            reached = data["time_origin"][at] + data["time_local"][at]
            self.assertGreater(ratio.max(), 1)
            self.assertEqual(done["critical_time_s"], reached)
            lead = (data["time_origin"][-1] - data["time_origin"][at] + data["time_local"][-1]
                    - data["time_local"][at])
            self.assertAlmostEqual(done["critical_lead_time_s"], lead, delta=1e-9 * lead)

    def test_every_field_of_the_cascade(self):
        with open(os.path.join(SOURCE, "cases/rg/creep-to-failure.yaml"), encoding="utf-8") as file:
            text = file.read()
        short = ("interface.levels=5", "interface.surface.self-affine.seed=3", "time.end=1 s")
        for field, section in (
                ("elastic", "{beta: 0.5, shifts: 5}"),  # as where no field is named
                ("elastic", "{beta: 0.5, shifts: 5, contacts: 40, path: solve}"),
                ("equal", "{field: equal, beta: 0.5, shifts: 5}"),
                ("uniform", "{field: uniform, beta: 0.5, shifts: 5}")):
            done = self.run_case(text, *short, f"rg={section}")
            static = [word for setting in (*short, "analysis={}", f"rg={section}")
                      for word in ("--set", setting)]
            static = self.call("rg", "case.yaml", "--json", "--force", "-o", "rg.nc", *static)
            static = json.loads(static.stdout)["critical_fraction"]
            self.assertIsNotNone(static)
            self.assertEqual(done["critical_fraction"], static)
            self.assertIn(f"field {field}, beta 0.5", done["critical_fraction_source"])

    def test_map_of_the_run(self):
        done = self.run_case(LACUNAR, "interface.levels=7", "output.fields=[]",
                             "transfer.hierarchy.k0=2e13")
        with self.file() as data:
            points, slope, fixed = fitted_map(data["n_slip"][:], data["n_tot"][:])
            self.assertEqual(done["run_map_points"], points)
            self.assertAlmostEqual(done["run_lambda"], slope, delta=1e-9)
            self.assertAlmostEqual(float(data["run_lambda"][:]), slope, delta=1e-9)
            if fixed is None:
                self.assertIsNone(done["run_critical_fraction"])
            else:
                self.assertAlmostEqual(done["run_critical_fraction"], fixed, delta=1e-9)
        self.assertLess(done["run_lambda_low"], slope)
        self.assertGreater(done["run_lambda_high"], slope)

    def test_given_fraction(self):
        done = self.run_case(LACUNAR, "analysis={rg: {critical_fraction: 0.25}}",
                             "rg.beta=0.7", "output.fields=[]")
        self.assertEqual(done["critical_fraction"], 0.25)
        self.assertIsNone(done["critical_fraction_low"])
        self.assertEqual(done["critical_fraction_source"], "given in the case")
        self.assertEqual(done["criticality_max"], 4 * done["slip_fraction"])
        self.assertIn("at most 0.85 of", done["slipping_cell"])  # halfway between 0.7 and 1

    def test_no_fixed_point_is_no_number(self):
        done = self.run_case(LACUNAR, "rg.beta=0.95", "output.fields=[]")
        self.assertIsNone(done["critical_fraction"])
        self.assertTrue(done["critical_fraction_source"].startswith("none: "))
        self.assertIsNone(done["critical_time_s"])
        with self.file() as data:
            self.assertTrue(np.all(np.ma.getmaskarray(data["criticality"][:])))

    def test_beta_from_friction(self):
        done = self.run_case(LACUNAR, "rg.beta=from-friction", "output.fields=[]",
                             "friction.aging.b=0.02", "analysis.rg.slipping_rate=1 mm/s")
        self.assertIn("(from the friction law, mean)", done["critical_fraction_source"])

    def test_one_cell(self):
        text = LACUNAR.replace("levels: 5", "cells_x: 2, cells_y: 2")
        text = text.replace("domain: {cascade: {dimension: 1.6, seed: 3}}", "domain: {full: {}}")
        text = text.replace("full: {}", "cascade: {dimension: 0.01, seed: 1}")
        done = self.run_case(text)
        self.assertEqual(done["n_cells"], 1)
        self.assertEqual(done["slip_fraction"], 1)
        self.assertEqual(done["correlation_length_m"], 0.5)
        self.assertIsNone(done["critical_fraction"])
        with self.file() as data:
            self.assertEqual(data["n_tot"][:].tolist(), [1, 1])

    def test_summary_and_resolved_case(self):
        name = self.write(LACUNAR.replace("BOUNDARY", "periodic"))
        said = self.call("run", name, "-o", "out.nc", "--no-progress").stdout
        for words in ("slipping at the end", "critical fraction", "criticality", "longest cluster"):
            self.assertIn(words, said)
        with self.file() as data:
            text, n_slip = data.case, np.array(data["n_slip"][:])
        self.assertIn("slipping_strength: 0.8", text)
        self.write(text, "again.yaml")
        self.call("run", "again.yaml", "-o", "again.nc", "--no-progress")
        with self.file("again.nc") as data:
            self.assertTrue(np.array_equal(data["n_slip"][:], n_slip))

    def test_defaults_come_from_rg(self):
        resolved = self.call("check", self.write(LACUNAR.replace("BOUNDARY", "periodic")),
                             "--set", "rg={field: equal, beta: [0.5, 0.4]}").stdout
        self.assertIn("slipping_strength: 0.75", resolved[resolved.index("analysis:"):])

    def test_not_asked_for(self):
        name = self.write(LACUNAR.replace("BOUNDARY", "periodic")
                          .replace("analysis: {rg: {}}", ""))
        done = json.loads(self.call("run", name, "-o", "out.nc", "--json").stdout)
        self.assertNotIn("slip_fraction", done)
        with self.file() as data:
            self.assertNotIn("n_slip", data.variables)
            self.assertIn("n_tot", data.variables)

    def test_wrong_requests(self):
        name = self.write(LACUNAR.replace("BOUNDARY", "periodic"))
        wrong = {
            "analysis={cluster: {}}": "analysis.cluster",
            "analysis=[rg]": "analysis",
            "analysis.rg=often": "analysis.rg",
            "analysis.rg.slipping_strenght=0.8": 'did you mean "slipping_strength"',
            "analysis.rg.slipping_strength=1": "must be beta = 0.6 < slipping_strength < 1",
            "analysis.rg.slipping_strength=0.5": "must be beta = 0.6 < slipping_strength < 1",
            "analysis.rg.slipping_strength=nan": "analysis.rg.slipping_strength",
            "analysis.rg.slipping_rate=0 m/s": 'analysis.rg.slipping_rate: "0 m/s" must be > 0',
            "analysis.rg.slipping_rate=1 m": "analysis.rg.slipping_rate",
            "analysis.rg={slipping_rate: 1 mm/s, slipping_strength: 0.8}": "at most one of",
            "analysis.rg.critical_fraction=0": "must be > 0",
            "analysis.rg.critical_fraction=1.1": "must be <= 1",
            "analysis.rg.beta=0.6": "analysis.rg.beta: is no key here",
            "rg.beta=1": "rg.beta",
            "rg.field=elastic": "a domain goes with equal",
            "friction.aging.b=0": "never drops with b = 0",
        }
        for setting, words in wrong.items():
            with self.subTest(setting):
                done = self.call("run", name, "--set", setting, "-o", "none.nc", status=2)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertIn(words, done.stderr)
                self.assertFalse(os.path.exists(os.path.join(self.folder, "none.nc")))

    def stop(self, number, until):
        """Stops a long run once it has written some records; returns its exit status."""
        sets = ("output.every={steps: 1}", "interface.levels=6", "friction.aging.dc=0.4 um",
                "rg.beta=0.5")
        words = [word for setting in sets for word in ("--set", setting)]
        case = os.path.join(SOURCE, "cases/rg/creep-to-failure.yaml")
        process = subprocess.Popen([PROGRAM, "run", case, "-o", "out.nc", "--no-progress", *words],
                                   cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        self.addCleanup(process.kill)
        path = os.path.join(self.folder, "out.nc")
        end = time.monotonic() + 60
        while time.monotonic() < end and process.poll() is None:
            if os.path.exists(path) and os.path.getsize(path) > until:
                break
            time.sleep(0.02)
        process.send_signal(number)
        return process.wait(timeout=60)

    def test_stopped_runs_keep_their_records(self):
        for number, status in ((signal.SIGINT, "interrupted"), (signal.SIGKILL, "running")):
            with self.subTest(status):
                self.stop(number, 250000)
                with self.file() as data:
                    self.assertEqual(data.status, status)
                    n_slip, fraction = data["n_slip"][:], data["slip_fraction"][:]
                    there = ~np.ma.getmaskarray(n_slip).any(axis=1) & ~np.ma.getmaskarray(fraction)
                    whole = int(np.sum(there))  # a kill in the midst of a sync leaves records out, at the end
                    self.assertGreater(whole, 0)
                    self.assertTrue(there[:whole].all())
                    self.assertTrue(status == "running" or whole == len(n_slip))
                    self.assertTrue(np.array_equal(fraction[:whole], n_slip[:whole, 0] / data["n_tot"][0]))
                    self.assertGreater(float(data["critical_fraction"][:]), 0)
                os.remove(os.path.join(self.folder, "out.nc"))


if __name__ == "__main__":
    PROGRAM, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
