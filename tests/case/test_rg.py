#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna rg` from the case to the file, against a cascade of its own.

usage: test_rg.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from math import inf, log

import netCDF4
import numpy

PROGRAM, SOURCE = "", ""
CASE = "cases/rg/rough-joint.yaml"


def blocks(cells):
    """{place: [pressures]} of the next coarser blocks' children, as {parent: [places]}."""
    parents = {}
    for place in sorted(cells, key=lambda xy: morton(*xy)):
        parents.setdefault((place[0] // 2, place[1] // 2), []).append(place)
    return parents


def morton(x, y):
    code = 0
    for bit in range(16):
        code |= (x >> bit & 1) << 2 * bit | (y >> bit & 1) << 2 * bit + 1
    return code


def threshold(rule, beta, level):
    """Of the root, from {place: (gap, cells, strength, shear)} of the cells."""
    while len(level) > 1 or (0, 0) not in level:
        above = {}
        for parent, children in blocks(level).items():
            order = sorted((level[c] for c in children), key=lambda d: (d[0], d[2]))
            cells = left = sum(d[1] for d in order)
            received = excess = 0.0
            best = -inf
            for gap, n, strength, shear in order:
                need = gap - received if rule == "fix" else (left * gap - excess) / cells
                best = max(best, need)
                left -= n
                excess += shear - beta * strength
                received += (1 - beta) * strength / left if left > 0 else 0.0
            above[parent] = (best, cells, sum(d[2] for d in order), sum(d[3] for d in order))
        level = above
    return level[(0, 0)][0]


def equal_stress(strengths, load):
    low, high = 0.0, max(strengths)
    for _ in range(100):
        tau = (low + high) / 2
        less = sum(min(tau, s) for s in strengths) < load * sum(strengths)
        low, high = (tau, high) if less else (low, tau)
    return (low + high) / 2


def critical(rule, beta, strength):
    """Q_crit/Q_nom under equal stress of {place: strength}."""
    low, high = 0.0, 1.0
    for _ in range(40):
        load = (low + high) / 2
        tau = equal_stress(list(strength.values()), load)
        cells = {at: (s - tau, 1, s, min(tau, s)) for at, s in strength.items()}
        slides = threshold(rule, beta, cells) <= 1e-9 * tau
        low, high = (low, load) if slides else (load, high)
    return (low + high) / 2


def dyadic(occupied):
    """Slope of log2 N on the level, over all levels, of a square grid."""
    counts = []
    while True:
        counts.append(occupied.sum())
        if occupied.size == 1:
            return -numpy.polyfit(range(len(counts)), numpy.log2(counts), 1)[0]
        n = len(occupied) // 2
        occupied = occupied.reshape(n, 2, n, 2).any(axis=(1, 3))


class Cascade(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-rg-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)

    def call(self, *words, status=0):
        done = subprocess.run([PROGRAM, "rg", os.path.join(SOURCE, CASE), *words], text=True,
                              capture_output=True, cwd=self.folder, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def rg(self, *settings, levels=6, places=4):
        words = ["--json", "--force", "-o", "out.nc"]
        for setting in (f"interface.levels={levels}", f"rg.shifts={places}", *settings):
            words += ["--set", setting]
        return json.loads(self.call(*words).stdout)

    def file(self):
        return netCDF4.Dataset(os.path.join(self.folder, "out.nc"))

    def test_against_another_cascade(self):
        for rule in ("fix", "cons"):
            for beta in (0.8, 0.5):
                done = self.rg("rg.field=equal", f"rg.rule={rule}", f"rg.beta={beta}", places=1,
                               levels=5)
                with self.file() as data:
                    side = 1 / 32
                    places = zip((data["x"][:] / side).astype(int), (data["y"][:] / side).astype(int))
                    pressure = data["pressure"][:]
                    strength = {at: 0.6 * p for at, p in zip(places, pressure)}
                expected = critical(rule, beta, strength)
                self.assertAlmostEqual(done["q_crit_over_q_nom"], expected, delta=1e-6)

    def test_elastic_rules(self):
        betas = [0.8, 0.7, 0.6]
        for rule in ("fix", "cons", "lump"):
            done = self.rg(f"rg.rule={rule}")
            self.assertEqual([r["beta"] for r in done["results"]], betas)
            crit = [r["q_crit_over_q_nom"] for r in done["results"]]
            self.assertEqual(sorted(crit, reverse=True), crit)
            if rule == "cons":
                for beta, value in zip(betas, crit):
                    self.assertTrue(beta <= value < beta + 0.05, (beta, value))
            for result in done["results"]:
                self.assertEqual(result["rule"], rule)
                self.assertEqual(result["levels"][-1]["n_tot"], 1)
                self.assertEqual(result["levels"][-1]["n_slip_at_q_crit"], 0)
                n_tot = [level["n_tot"] for level in result["levels"]]
                self.assertEqual(sorted(n_tot, reverse=True), n_tot)

    def test_file_holds_what_is_said(self):
        done = self.rg("rg.field=equal", "rg.loads=20")
        with self.file() as data:
            self.assertEqual(data.rule, "fix")
            self.assertEqual(data.status, "complete")
            found = 0
            for k, result in enumerate(done["results"]):
                self.assertAlmostEqual(float(data["q_crit_over_q_nom"][k]),
                                       result["q_crit_over_q_nom"])
                for name, key in (("critical_fraction", "critical_fraction"), ("map_slope", "lambda"),
                                  ("exponent", "exponent")):
                    ends = [data[f"{name}_{end}"][k] for end in ("low", "high")]
                    ends = [None if numpy.ma.is_masked(end) else float(end) for end in ends]
                    self.assertEqual(ends, result[f"{key}_interval95"])
                    self.assertTrue(ends[0] is None or ends[0] <= float(data[name][k]) <= ends[1])
                    found += ends[0] is not None
                for level, row in enumerate(result["levels"]):
                    self.assertAlmostEqual(float(data["strength"][k, level]), row["strength_Pa"])
            self.assertGreater(found, 3)
            fraction = data["slip_fraction"][:]
            self.assertEqual(fraction.shape, (3, 20, 7))
            self.assertTrue(numpy.all(numpy.diff(fraction, axis=1) >= -1e-12))
            self.assertTrue(numpy.allclose(fraction[:, -1], 1))
            loads = data["slip_load"][:]
            self.assertTrue(numpy.all(loads > 0) and numpy.all(loads <= 1))
            for k, result in enumerate(done["results"]):
                first = result["first_to_slip"]
                self.assertAlmostEqual(first["q_over_q_nom"], loads[k].min(), delta=1e-12)
                at = numpy.flatnonzero((numpy.abs(data["x"][:] - first["x_m"]) < 1e-9)
                                       & (numpy.abs(data["y"][:] - first["y_m"]) < 1e-9))
                self.assertEqual(loads[k][at[0]], loads[k].min())
            # what slips alone at a load has slipped at it in the end
            alone = fraction[0, :, 0] * data.dimensions["cell"].size
            final = [(loads[0] <= load + 1e-9).sum() for load in data["load"][:]]
            self.assertTrue(all(a <= f + 1e-6 for a, f in zip(alone, final)))

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_strength_of_blocks_does_not_hang_on_the_loads(self):
        for rule in ("fix", "cons", "lump"):
            few, many = (self.rg(f"rg.rule={rule}", "rg.beta=0.7", f"rg.loads={loads}",
                                 "rg.contacts=60") for loads in (60, 1500))
            with self.file() as data:
                cells = 0.6 * float(numpy.mean(data["pressure"][:]))
            strength, true = ([row["strength_Pa"] for row in done["results"][0]["levels"]]
                              for done in (few, many))
            self.assertAlmostEqual(strength[0] / cells, 1, delta=1e-9)
            self.assertAlmostEqual(strength[-1] / few["q_nom_Pa"], few["q_crit_over_q_nom"],
                                   delta=1e-9)
            for value, expected in zip(strength, true):
                self.assertAlmostEqual(value / expected, 1, delta=0.012)

    def test_one_place_tells_no_error(self):
        result, = self.rg("rg.field=equal", "rg.beta=0.7", places=1)["results"]
        for key in ("q_crit_error", "q_crit_sd", "q_crit_sd_of_places"):
            self.assertIsNone(result[key])
            with self.file() as data:
                self.assertTrue(numpy.ma.is_masked(data[key][0]))
        result, = self.rg("rg.field=equal", "rg.beta=0.7", "rg.seeds=2", places=1)["results"]
        self.assertGreater(result["q_crit_error"], 0)
        self.assertIsNone(result["q_crit_sd_of_places"])
        words = ("--set", "rg.shifts=1", "--set", "interface.levels=5", "--set", "rg.field=equal")
        self.assertNotIn("nan", self.call(*words, "--force", "-o", "out.nc").stdout)

    def test_ensembles_and_threads(self):
        one = self.rg("rg.seeds=3", "rg.field=equal")
        two = self.rg("rg.seeds=3", "rg.field=equal", "rg.loads=60")
        words = ["--json", "--force", "-o", "out.nc", "--threads", "2"]
        for setting in ("interface.levels=6", "rg.shifts=4", "rg.seeds=3", "rg.field=equal"):
            words += ["--set", setting]
        three = json.loads(self.call(*words).stdout)
        for done in (one, two, three):
            del done["cpu_time_s"]
        self.assertEqual(one, two)
        self.assertEqual(one, three)
        self.assertEqual(one["interfaces"], 3)
        sd = one["results"][0]["q_crit_sd"]
        self.assertAlmostEqual(one["results"][0]["q_crit_error"], sd / 3 ** 0.5)
        alone = [self.rg("rg.field=equal", f"interface.surface.self-affine.seed={seed}")
                 ["q_crit_over_q_nom"] for seed in (1, 2, 3)]
        self.assertAlmostEqual(one["q_crit_over_q_nom"], sum(alone) / 3, delta=0.01)

    def test_solved_contacts(self):
        series = self.rg("rg.contacts=300", "rg.shifts=2")
        solved = self.rg("rg.path=solve", "rg.shifts=2")
        for one, other in zip(series["results"], solved["results"]):
            self.assertAlmostEqual(one["q_crit_over_q_nom"], other["q_crit_over_q_nom"],
                                   delta=1e-3)
            self.assertEqual(other["levels"][-1]["n_slip_at_q_crit"], 0)

    def joint(self, *settings, domain="domain: {full: {}}", levels=1, load="pressure: 1 MPa"):
        """A case of its own, without a surface unless `domain` is one."""
        with open(os.path.join(self.folder, "own.yaml"), "w", encoding="utf-8") as out:
            out.write(f"lacuna: 1\ninterface: {{size: 1, levels: {levels}, {domain}}}\n"
                      "material: {shear_modulus: 15 GPa, poisson: 0.25}\n"
                      f"load: {{normal: {{{load}}}}}\nrg: {{friction: 0.6}}\n")
        words = ["rg", "own.yaml", "--json", "--force", "-o", "own.nc"]
        for setting in settings:
            words += ["--set", setting]
        return subprocess.run([PROGRAM, *words], text=True, capture_output=True, cwd=self.folder,
                              check=False)

    ENDS = "rg.beta=[0, 1e-12, 0.5, 0.999999999999, 1]"

    def test_uniform_joints_slip_at_coulombs(self):
        for rule in ("fix", "cons", "lump"):
            for levels in (1, 4):
                done = self.joint("rg.field=equal", f"rg.rule={rule}", self.ENDS, levels=levels)
                self.assertEqual(done.returncode, 0, done.stderr)
                for result in json.loads(done.stdout)["results"]:
                    self.assertAlmostEqual(result["q_crit_over_q_nom"], 1, delta=1e-8)

    SURFACE = "surface: {self-affine: {rms_slope: 0.1, seed: 1}}"

    def test_a_single_cell_slips_at_coulombs(self):
        for field in ("elastic", "equal"):
            for rule in ("fix", "cons", "lump"):
                done = self.joint(f"rg.field={field}", f"rg.rule={rule}", self.ENDS, levels=5,
                                  domain=self.SURFACE, load="pressure: 1 Pa")
                self.assertEqual(done.returncode, 0, done.stderr)
                found = json.loads(done.stdout)
                self.assertEqual(found["contact_fraction"], 1 / 1024)
                for result in found["results"]:
                    self.assertAlmostEqual(result["q_crit_over_q_nom"], 1, delta=1e-8)

    def test_beta_one_is_coulombs(self):
        for field in ("elastic", "equal"):
            for rule in ("fix", "cons", "lump"):
                found = self.rg(f"rg.field={field}", f"rg.rule={rule}", self.ENDS, levels=5)
                crit = [result["q_crit_over_q_nom"] for result in found["results"]]
                self.assertAlmostEqual(crit[4], 1, delta=1e-8)
                self.assertAlmostEqual(crit[3], 1, delta=1e-6)
                self.assertAlmostEqual(crit[1], crit[0], delta=1e-8)
                self.assertTrue(0 <= crit[0] <= crit[2] <= crit[4])

    def test_no_load_and_no_contact(self):
        for domain in (self.SURFACE, "domain: {full: {}}"):
            done = self.joint("rg.field=equal", domain=domain, levels=5, load="pressure: 0 Pa")
            self.assertEqual(done.returncode, 2)
            self.assertIn("load.normal.pressure: \"0 Pa\" must be > 0", done.stderr)
        done = self.joint(domain=self.SURFACE + ", boundary: free", levels=5,
                          load="approach: 1 m")
        self.assertEqual(done.returncode, 2)
        self.assertIn("the faces do not touch", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_beta_from_friction(self):
        law = ("friction={slip: {f0: 0.6, a: 0.01, b: 0.02, dc: 10 um, v0: 1 um/s}}",
               "material.density=2700 kg/m3", "rg.beta=from-friction", "rg.field=equal")
        done = self.rg(*law, levels=5)
        with self.file() as data:
            pressure = data["pressure"][:]
        modulus, density, v0, scale = 15e9, 2700, 1e-6, 0.02 / 0.6
        damping = modulus / (2 * (modulus / density) ** 0.5)
        total = 0.0
        for p in pressure:
            low, high = scale, 1.0
            for _ in range(100):
                x = (low + high) / 2
                right = x > scale * log(x * 0.6 * p / (damping * v0))
                low, high = (low, x) if right else (x, high)
            total += 1 - low
        self.assertAlmostEqual(done["beta"], total / len(pressure), delta=1e-9)

    def test_load_by_dimension(self):
        done = self.rg("load.normal={dimension: 1.5}", "rg.seeds=3", "rg.field=equal", places=1)
        self.assertEqual([one["seed"] for one in done["ensemble"]], [1, 2, 3])
        for one in done["ensemble"]:
            self.assertAlmostEqual(one["d_blocks"], 1.5, delta=2e-3)
        with self.file() as data:
            # of the last interface, from its cells alone
            occupied = numpy.zeros((64, 64), bool)
            x, y = ((data[name][:] * 64).astype(int) for name in ("x", "y"))
            occupied[y, x] = True
            self.assertAlmostEqual(dyadic(occupied), done["ensemble"][2]["d_blocks"], delta=1e-12)
            for name, key in (("mean_pressure", "mean_pressure_Pa"), ("d_blocks", "d_blocks"),
                              ("contact_fraction", "contact_fraction"),
                              ("interface_seed", "seed")):
                self.assertEqual([one[key] for one in done["ensemble"]], list(data[name][:]))
            for k, result in enumerate(done["results"]):
                each = result["q_crit_of_interfaces"]
                self.assertEqual(each, list(data["q_crit_of_interface"][k]))
                self.assertAlmostEqual(sum(each) / 3, result["q_crit_over_q_nom"], delta=1e-12)
            # P = mean pressure times the area
            self.assertAlmostEqual(data["pressure"][:].sum() / 64 ** 2 / data["mean_pressure"][2],
                                   1, delta=1e-9)
        load = done["ensemble"][2]["mean_pressure_Pa"]
        same = self.rg(f"load.normal={{pressure: {load!r} Pa}}", "rg.field=equal", places=1,
                       *["interface.surface.self-affine.seed=3"])
        self.assertAlmostEqual(same["d_blocks"], done["ensemble"][2]["d_blocks"], delta=1e-9)
        self.assertAlmostEqual(same["q_crit_over_q_nom"],
                               done["results"][0]["q_crit_of_interfaces"][2], delta=1e-6)
        done = self.call("--set", "load.normal={dimension: 1.5}", "--set", "interface.levels=6",
                         "--set", "rg.field=equal", "--set", "rg.shifts=1", "-o", "out.nc",
                         "--force")
        self.assertRegex(done.stdout, "D of all blocks +1.[45]")
        self.assertRegex(done.stdout, "nominal pressure +[0-9.]+ MPa")

    def test_dimensions_that_no_load_gives(self):
        for value, words in (("2", 'load.normal.dimension: "2" must be <= 1.9999'),
                             ("0", 'load.normal.dimension: "0" must be > 0'),
                             ("-1", 'load.normal.dimension: "-1" must be > 0'),
                             ("nan", "load.normal.dimension"), ("1e400", "load.normal.dimension"),
                             ("0.1", "no load gives a dimension of 0.1: it jumps from 0 (1 cells)")):
            done = self.call("--set", f"load.normal={{dimension: {value}}}", "-o", "none.nc",
                             "--set", "interface.levels=5", status=2)
            self.assertIn(words, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)

    def tool(self, name, *words, status=0):
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tools", "plot", name), *words,
                               "--program", PROGRAM], text=True, capture_output=True,
                              cwd=self.folder, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_table(self):
        done = self.tool("rg_table.py", "--levels", "6", "--seeds", "2", "--dimensions", "1.55",
                         "--grids", "5", "6", "--parts", "table,grids,map", "--json", "table.json",
                         "--set", "rg.loads=20")
        rows = [[cell.strip() for cell in line.split("|")[1:-1]]
                for line in done.stdout.splitlines() if line.startswith("|")]
        with open(os.path.join(self.folder, "table.json"), encoding="utf-8") as file:
            runs = json.load(file)
        for rule in ("fix", "cons", "lump"):
            run, = (one for one in runs if one["settings"].get("rg.rule") == rule
                    and one["settings"]["interface.levels"] == 6
                    and "rg.field" not in one["settings"])
            for result in run["results"]:
                a, b = result["q_crit_of_interfaces"]
                row, = (cells for cells in rows
                        if cells[:2] == [rule.upper(), f"{result['beta']:g}"])
                # two values: their mean, and half of what lies between them
                self.assertEqual(row[2], f"{(a + b) / 2:.3f} ± {abs(a - b) / 2:.3f}")
                if rule == "cons":
                    self.assertTrue(result["beta"] <= min(a, b) <= result["beta"] + 0.03)
        self.assertIn("32²", done.stdout)
        done = self.tool("rg_table.py", "--parts", "tables", status=2)
        self.assertIn("must be of table, variants", done.stderr)
        with open(os.path.join(self.folder, "netCDF4.py"), "w", encoding="utf-8") as file:
            file.write("raise ModuleNotFoundError('no such module', name='netCDF4')\n")
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tools/plot/rg_table.py")], text=True,
                              env={**os.environ, "PYTHONPATH": self.folder}, capture_output=True,
                              timeout=20, check=False)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("the part map needs netCDF4", done.stderr)
        done = self.tool("rg_table.py", "--set", "rg.rule=fx", "--levels", "5", "--seeds", "2",
                         "--parts", "variants", status=1)
        self.assertIn("must be one of: fix, cons, lump", done.stderr)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "pictures: the plain build's")
    def test_pictures(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("matplotlib is not installed")
        self.tool("rg_rules.py", "-o", "rules.png")
        self.tool("figure3.py", "-o", "figure3.png", "--seeds", "2", "--levels", "5", "--set",
                  "interface.levels=6", "--set", "rg.loads=20")
        for name in ("rules.png", "figure3.png"):
            path = os.path.join(self.folder, name)
            with open(path, "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
            self.assertGreater(os.path.getsize(path), 30000)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "pictures: the plain build's")
    def test_pictures_that_cannot_be(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("matplotlib is not installed")
        away = os.path.join(self.folder, "none", "x.png")
        done = self.tool("rg_rules.py", "-o", away, status=1)
        self.assertEqual(done.stderr, f"rg_rules: {away}: No such file or directory\n")
        for words in (("--jobs", "0"), ("--seeds", "1")):
            done = self.tool("figure3.py", "-o", "x.png", *words, status=2)
            self.assertIn("--seeds must be at least 2 and --jobs 1", done.stderr)
        done = self.tool("figure3.py", "-o", "x.png", "--seeds", "2", "--levels", "4", "--set",
                         "interface.levels=5", "--set", "rg.loads=20", status=1)
        self.assertEqual(done.stderr, "figure3: 32 x 32 cells: as many both ways, a multiple of 64, "
                         "are needed to show a part of them\n")

    def test_beta_of_a_law_that_varies(self):
        law = ("--set", "friction={aging: {a: 0.01, b: 0.015, dc: 1 mm}}", "--set",
               "material.shear_speed=2 km/s", "--set", "interface.levels=4", "--set",
               "rg.beta=from-friction", "--force", "-o", "out.nc")
        self.assertNotIn("nominal", self.call(*law).stderr)
        done = self.call(*law, "--set", "friction.spread={b: {lognormal: {sigma: 0.5}}}")
        self.assertIn("friction.spread.b has no effect on it", done.stderr)

    def test_wrong_requests(self):
        wrong = {
            "rg.beta=1.2": 'rg.beta: "1.2" must be >= 0 and <= 1',
            "rg.beta=often": "rg.beta",
            "rg.rule=fx": 'rg.rule: "fx" must be one of: fix, cons, lump',
            "rg.shifts=0": 'rg.shifts: "0" must be >= 1',
            "interface.levels=0": "interface",
            "rg.beta=from-friction": "rg.beta: \"from-friction\" needs a friction law",
        }
        for setting, words in wrong.items():
            done = self.call("--set", setting, "-o", "none.nc", status=2)
            self.assertIn(words, done.stderr)
            self.assertEqual(done.stdout, "")
            self.assertFalse(os.path.exists(os.path.join(self.folder, "none.nc")))


class Bridge(unittest.TestCase):
    """cases/bridge.yaml: a slow ramp against the cascade of the same pressures."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-bridge-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)

    def call(self, command, *settings, status=0):
        words = [PROGRAM, command, os.path.join(SOURCE, "cases/bridge.yaml"), "--json", "--force",
                 "-o", "out.nc"]
        for setting in settings:
            words += ["--set", setting]
        done = subprocess.run(words, text=True, capture_output=True, cwd=self.folder, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return json.loads(done.stdout) if status == 0 else done.stderr

    def critical(self, *settings):
        return self.call("rg", *settings)["q_crit_over_q_nom"]

    def test_a_slow_ramp_slides_where_the_cascade_does(self):
        seeds = [f"interface.spread.pressure.uniform.seed={seed}" for seed in (1, 2, 3)]
        expected = [self.critical(seed) for seed in seeds]
        self.assertEqual(len(set(expected)), 3)
        for seed, q_crit in zip(seeds, expected):
            done = self.call("run", seed)
            self.assertEqual(done["ended_by"], "stop_when")
            self.assertLess(abs(done["apparent_friction"] / 0.6 - q_crit), 0.004)
        # the seeds that rg goes through are those
        self.assertAlmostEqual(self.critical("rg.seeds=3"), sum(expected) / 3, delta=1e-9)

    def test_the_tool_makes_its_table(self):
        tool = os.path.join(SOURCE, "tools/studies/bridge.py")
        done = subprocess.run([sys.executable, tool, "contrast", "--runs", "2", "--program", PROGRAM],
                              text=True, capture_output=True, cwd=self.folder, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [line.split("|")[1:-1] for line in done.stdout.splitlines() if line.startswith("| ±")]
        self.assertEqual([row[0].strip() for row in rows], ["± 0.16", "± 0.3"])
        for row in rows:
            self.assertLess(float(row[1].split()[0]), 0.005)

    def test_pressures_are_spread_and_their_load_is_held(self):
        self.call("contact")
        with netCDF4.Dataset(os.path.join(self.folder, "out.nc")) as data:
            pressure = data["pressure"][:]
        self.assertAlmostEqual(float(pressure.mean()), 1e7, delta=1e-6)
        self.assertGreater(float(pressure.std()), 0.05e7)
        self.assertLess(float(pressure.max() / pressure.min()), 1.16 / 0.84)

    def test_a_pressure_that_cannot_be_is_refused(self):
        said = self.call("run", "interface.spread={pressure: {normal: {sigma: 1}}}", status=2)
        self.assertIn("interface.spread.pressure", said)
        self.assertIn("must be finite and > 0", said)
        said = self.call("run", "interface.spread={presure: {normal: {sigma: 0.1}}}", status=2)
        self.assertIn('did you mean "pressure"', said)


if __name__ == "__main__":
    PROGRAM, SOURCE = (os.path.abspath(word) for word in sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
