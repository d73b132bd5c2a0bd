#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`solver.fidelity: lumped` from the command line: what it says, what it writes, what it refuses.

usage: test_lumped.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy as np

PROGRAM, SOURCE = "", ""

SCENE = """
lacuna: 1
interface: {size: 64 m, levels: 5, domain: {cascade: {dimension: 1.8, seed: 3}}}
load: {normal: {pressure: 3 MPa}}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: 1 mm, v0: 1 um/s},
           spread: {dc: {lognormal: {sigma: 0.5, seed: 2}}}}
initial: {slip_rate: 1 cm/day, state: {ratio_to_steady: 0.6}}
transfer: {hierarchy: {k0: 3e10, ratio: 0.5}}
time: {end: 200 day}
output: {fields: [slip, traction, state], fields_every: {per_decade: 2}, every: {per_decade: 20}}
"""

# Twice as loose, its leaves end further from where all cells do.
TIED = """
lacuna: 1
interface: {size: 100 m, levels: 4, domain: {full: {}}}
load: {normal: {pressure: 1.0207 MPa}, shear: [{sine: {amplitude: 2562 Pa, period: 880500 s}}], pore_pressure: [{constant: {value: 0.1722 MPa}}]}
friction: {composite: {f0: 0.345, a: 0.02798, b: 0.05627, dc: 4.381 mm, v0: 1 um/s, form: regularised, vc: 7.87e-10 m/s},
           spread: {dc: {weibull: {shape: 1.738, seed: 121560}}, f0: {normal: {sigma: 0.0305, seed: 451031}}, b: {uniform: {half_width: 0.215, seed: 519993}}}}
initial: {slip_rate: 1.598e-09 m/s, state: {ratio_to_steady: 2.427}, spread: {state: {lognormal: {sigma: 0.835, seed: 891770}}}}
transfer: {hierarchy: {k0: 2.3401e+09, ratio: 0.3}}
time: {end: 2203900 s}
"""

# Cells start at rates e-folds apart. Leaves are ahead of all cells soon, and lose most of that on their way.
APART = """
lacuna: 1
interface: {size: 100 m, levels: 4, domain: {full: {}}}
load: {normal: {pressure: 9.9646 MPa}, pore_pressure: [{constant: {value: 2.031 MPa}}, {step: {value: 1028 Pa, at: 22320000 s}}]}
friction: {slip: {f0: 0.556, a: 0.01979, b: 0.03129, dc: 3.311 mm, v0: 1 um/s, form: regularised},
           spread: {b: {uniform: {half_width: 0.106, seed: 244987}}}}
initial: {slip_rate: 3.144e-08 m/s, state: {ratio_to_steady: 0.851}, spread: {slip_rate: {lognormal: {sigma: 2.749, seed: 73688}}}}
transfer: {hierarchy: {k0: 3.2261e+09, ratio: 0.7}}
time: {end: 32205000 s}
"""

# All creep for 600 dc along the kink of their law: long steps come to a time of failure 22 % too late.
KINK = """
lacuna: 1
interface: {size: 100 m, levels: 4, domain: {full: {}}}
load: {normal: {pressure: 4.1006 MPa}, pore_pressure: [{ramp: {rate: 0.005039 Pa/s}}]}
friction: {weakening: {f0: 0.548, a: 0.01824, b: 0.0333, dc: 5.742 mm, v0: 1 um/s, form: regularised},
           spread: {dc: {lognormal: {sigma: 0.573, seed: 207298}}, a: {uniform: {half_width: 0.133, seed: 946900}}}}
initial: {slip_rate: 6.743e-07 m/s, state: {ratio_to_steady: 1.298}}
transfer: {hierarchy: {k0: 5.465e+08, ratio: 0.85}}
time: {end: 80608000 s}
"""


class Lumped(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.write(SCENE)

    def write(self, text):
        with open(os.path.join(self.folder, "case.yaml"), "w", encoding="utf-8") as file:
            file.write(text)

    def lacuna(self, *arguments):
        return subprocess.run([PROGRAM, *arguments], cwd=self.folder, capture_output=True, text=True)

    def run_case(self, *sets, more=("--json",)):
        options = [part for key in sets for part in ("--set", key)]
        return self.lacuna("run", "case.yaml", "-o", "out.nc", *options, *(more if "--resume" in more else ("--force", *more)))

    def test_beside_all_cells(self):
        few = self.run_case("solver.fidelity=lumped")
        self.assertEqual(few.returncode, 0, few.stderr)
        os.rename(os.path.join(self.folder, "out.nc"), os.path.join(self.folder, "few.nc"))
        found = json.loads(few.stdout)
        self.assertEqual(found["fidelity"], "lumped")
        self.assertLess(found["lump"]["cells"], found["n_cells"] / 4)
        self.assertLess(found["lump_error_estimated"], 1e-3)
        all_cells = json.loads(self.run_case("solver.fidelity=ode").stdout)
        self.assertNotIn("lump", all_cells)
        error = abs(found["failure_time_s"] / all_cells["failure_time_s"] - 1)
        self.assertLess(error, found["lump_error_estimated"] + 2e-5)  # and what rtol leaves
        with netCDF4.Dataset(os.path.join(self.folder, "few.nc")) as one, netCDF4.Dataset(os.path.join(self.folder, "out.nc")) as other:
            self.assertEqual(one.lump_error_estimated, found["lump_error_estimated"])
            self.assertNotIn("lump_error_estimated", other.ncattrs())
            self.assertIn("stand for", one.lumped)
            self.assertNotIn("lumped", other.ncattrs())
            self.assertEqual(one["cell_slip"].shape[1], other["cell_slip"].shape[1])
            np.testing.assert_array_equal(one["pressure"][:], other["pressure"][:])
            for name, most in (("cell_slip", 0.02), ("cell_traction", 0.02)):  # at the start of both, and late
                for snapshot in (0, 3):
                    a, b = one[name][snapshot], other[name][snapshot]
                    scale = max(np.abs(b).max(), 1e-9)
                    self.assertLess(np.abs(a - b).max() / scale, most + 1e-3, f"{name} {snapshot}")

    def test_summary_and_check(self):
        said = self.run_case("solver.fidelity=lumped", more=()).stdout
        self.assertIn("stand for", said)
        self.assertIn("solver.lump.error", said)
        check = self.lacuna("check", "case.yaml", "--json")
        lumped = json.loads(check.stdout)["estimate"]["lumped"]
        self.assertLess(lumped["error_estimated"], 1e-3)
        self.assertIn("lumped          would do", self.lacuna("check", "case.yaml").stdout)
        # cells that slip one by one
        soft = self.lacuna("check", "case.yaml", "--set", "transfer.hierarchy.k0=1e6", "--json")
        self.assertIsNone(json.loads(soft.stdout)["estimate"]["lumped"])

    def test_bound_passed(self):
        soft = self.run_case("solver.fidelity=lumped", "transfer.hierarchy.k0=3e8", "solver.lump.level=5", "solver.lump.error=0.005")
        self.assertEqual(soft.returncode, 1)
        self.assertEqual(len(soft.stderr.strip().split("\n")), 1)
        self.assertIn("solver.lump.error 0.005", soft.stderr)
        found = json.loads(soft.stdout)
        self.assertIsNone(found["failure_time_s"])
        self.assertIsNone(found["failed"])
        with netCDF4.Dataset(os.path.join(self.folder, "out.nc")) as file:
            self.assertEqual(file.status, "failed")
            self.assertNotIn("failure_time_s", file.ncattrs())

    def test_cell_that_slips_by_itself(self):
        """Its bond decides whether it runs away: taken together it did, among all cells it does not."""
        text = SCENE.replace("cascade: {dimension: 1.8, seed: 3}", "cascade: {dimension: 1.816, seed: 519240}")
        text = text.replace("64 m, levels: 5", "100 m, levels: 6").replace("3 MPa}", "7.3051 MPa}, shear: [{ramp: {rate: 2.058 mPa/s}}]")
        text = text.replace("f0: 0.6, a: 0.010, b: 0.015, dc: 1 mm", "f0: 0.6, a: 0.01875, b: 0.03586, dc: 1.096 mm, form: regularised")
        text = text.replace("{dc: {lognormal: {sigma: 0.5, seed: 2}}}", "{dc: {weibull: {shape: 2.783, seed: 478468}}, f0: {normal: "
                            "{sigma: 0.0153, seed: 359783}}, b: {uniform: {half_width: 0.103, seed: 670556}}}")
        text = text.replace("1 cm/day, state: {ratio_to_steady: 0.6", "3.759e-09 m/s, state: {ratio_to_steady: 0.789")
        text = text.replace("k0: 3e10", "k0: 6.6865e9").replace("{end: 200 day}", "{end: 2 year, stop_when: {mean_slip: 0.5395 mm}}")
        self.write(text)
        ends = [json.loads(self.run_case(f"solver.fidelity={fidelity}").stdout) for fidelity in ("lumped", "ode")]
        self.assertEqual([end["ended_by"] for end in ends], ["stop_when", "stop_when"])
        self.assertAlmostEqual(ends[0]["time_s"] / ends[1]["time_s"], 1, delta=ends[0]["lump_error_estimated"])
        done = self.run_case("solver.fidelity=lumped", "solver.lump.level=6")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("some cells slip by themselves", done.stderr)

    def test_resumed(self):
        lumped = ("solver.fidelity=lumped", "output.checkpoint.steps=50")
        whole = json.loads(self.run_case(*lumped).stdout)
        stopped = self.run_case(*lumped, "solver.max_steps=180")
        self.assertEqual(stopped.returncode, 1, stopped.stderr)
        resumed = self.run_case(*lumped, more=("--json", "--resume"))
        self.assertEqual(resumed.returncode, 0, resumed.stderr)
        found = json.loads(resumed.stdout)
        for key in ("failure_time_s", "mean_slip_m", "lump_error_estimated"):
            self.assertEqual(found[key], whole[key], key)

    def test_ways_that_come_back(self):
        """Where leaves were further from all cells than they end, that counts too."""
        self.write(APART)
        whole = json.loads(self.run_case("solver.fidelity=ode", "solver.rtol=1e-8").stdout)
        for error in (0.001, 0.01):
            few = json.loads(self.run_case("solver.fidelity=lumped", "solver.rtol=1e-8", f"solver.lump.error={error}").stdout)
            self.assertLess(abs(few["failure_time_s"] / whole["failure_time_s"] - 1), few["lump_error_estimated"], error)

    def test_ways_that_end_elsewhere(self):
        """Where long steps end far from where the run ends, they tell nothing of its error."""
        self.write(KINK)
        done = self.run_case("solver.fidelity=lumped")
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("cannot estimate its error", done.stderr)
        self.assertIsNone(json.loads(done.stdout)["failure_time_s"])
        self.assertEqual(self.run_case("solver.fidelity=lumped", "solver.lump.level=0").returncode, 0)

    def test_resumed_with_other_cells(self):
        """A later end asks for other cells: the line says that, and not that a file has changed."""
        self.write(SCENE.replace("k0: 3e10", "k0: 2e9"))
        lumped = ("solver.fidelity=lumped", "solver.lump.error=1e-4", "output.checkpoint.steps=20")
        self.assertEqual(self.run_case(*lumped, "time.end=1 hour", "solver.max_steps=30").returncode, 1)
        refused = self.run_case(*lumped, "time.end=200 day", more=("--resume",))
        self.assertEqual(refused.returncode, 2, refused.stderr)
        self.assertIn("other cells stand for all: the end of the run", refused.stderr)

    def test_refused(self):
        lumped = "solver.fidelity=lumped"
        for sets, words in (
                ((lumped, "transfer={none: {}}"), "lumped needs transfer"),
                (("solver.lump.error=0.1",), "goes with fidelity lumped"),
                ((lumped, "analysis={events: {slip_rate: 1 mm/s}}"), "which fidelity lumped does not follow"),
                ((lumped, "interface.slip=vector"), "along x only"),
                ((lumped, "output.points=[{name: inclinometer, x: 20 m, y: 30 m}]"), "are single cells"),
                ((lumped, "inertia={mass_per_area: 5e5 kg/m2}"), "knows no inertia"),
                ((lumped, "solver.lump.error=0.7"), "0.5"),
                ((lumped, "solver.lump.nodes=1"), "2"),
                ((lumped, "time.stop_when.max_slip_rate=1 mm/s"), "keeps few"),
                ((lumped, "initial.state={ratio_to_steady: 1}"), "rounding decides")):
            refused = self.run_case(*sets)
            self.assertEqual(refused.returncode, 2, f"{sets}: {refused.stderr}")
            self.assertIn(words, refused.stderr)

    def test_other_ends(self):
        """Means over cells are right where starting rates differ, and pilot runs may be of few cells."""
        spread = "initial.spread={slip_rate: {lognormal: {sigma: 0.8, seed: 5}}}"
        for end in ("time.stop_when.mean_slip=2 mm", "time.end=1 hour"):
            few = json.loads(self.run_case("solver.fidelity=lumped", spread, end).stdout)
            whole = json.loads(self.run_case("solver.fidelity=ode", spread, end).stdout)
            key = "time_s" if "stop" in end else "mean_slip_m"
            self.assertLess(abs(few[key] / whole[key] - 1), few["lump_error_estimated"] + 2e-5, end)
        found = json.loads(self.run_case("solver.fidelity=lumped", "solver.accuracy=0.01", "solver.lump.level=auto").stdout)
        self.assertEqual(found["lump"]["error_asked"], 0.005)
        self.assertEqual(found["accuracy"]["asked"], 0.01)

    def test_levels_of_one_block(self):
        """Contact that lies in one corner has levels that hold what the level below holds."""
        for seed, level in ((195, "auto"), (195, 2), (144, 4)):
            corner = ("interface.domain.cascade.dimension=1.56", f"interface.domain.cascade.seed={seed}")
            few = json.loads(self.run_case("solver.fidelity=lumped", f"solver.lump.level={level}", "solver.lump.error=0.5", *corner).stdout)
            whole = json.loads(self.run_case("solver.fidelity=ode", *corner).stdout)
            self.assertLess(abs(few["failure_time_s"] / whole["failure_time_s"] - 1), few["lump_error_estimated"] + 2e-5)

    def test_ties_that_do_not_help(self):
        """Where leaves tied otherwise end no more as all cells do, or come to no end, the error is that of leaves as they were."""
        self.write(TIED)
        said = [json.loads(self.run_case("solver.fidelity=lumped", "solver.lump.level=4", f"solver.lump.error={error}").stdout)
                ["lump_error_estimated"] for error in (0.02, 0.01)]
        self.assertGreater(said[1], 0.01)
        self.assertAlmostEqual(said[1] / said[0], 1, delta=0.1)

    def test_fit(self):
        """A fit whose trials are lumped finds what readings of all cells were made with."""
        self.run_case("solver.fidelity=ode")
        with netCDF4.Dataset(os.path.join(self.folder, "out.nc")) as file:
            times = np.linspace(0.1, 0.9, 20) * file["time"][-1]
            slips = np.interp(times, file["time"][:], file["slip"][:]) + 1e-6 * np.cos(np.arange(20))
        with open(os.path.join(self.folder, "s.csv"), "w", encoding="utf-8") as file:
            file.write("t (s),s (m)\n" + "".join(f"{t:.3f},{s:.9f}\n" for t, s in zip(times, slips)))
        self.write(SCENE + "fit: {parameters: {friction.aging.dc: {range: [0.5 mm, 2 mm]}}, time: t (s), displacement: s (m), errors: white, steps: 0}\n")
        done = self.lacuna("fit", "case.yaml", "s.csv", "--json", "-o", "f.nc", "--set", "solver.fidelity=lumped")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(done.stdout)
        self.assertLess(abs(found["parameters"][0]["best"] / 1e-3 - 1), 2e-3)

    def test_no_lumped_reference(self):
        for more in (("fidelity=ode:lumped",), ("rtol", "--set", "solver.fidelity=lumped")):
            refused = self.lacuna("trade", "case.yaml", "--dials", *more, "-o", "t.nc")
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertIn("cannot be lumped", refused.stderr)

    def test_no_branch_from_it(self):
        self.assertEqual(self.run_case("solver.fidelity=lumped").returncode, 0)
        os.rename(os.path.join(self.folder, "out.nc"), os.path.join(self.folder, "few.nc"))
        branch = self.lacuna("run", "case.yaml", "--from", "few.nc", "--at", "1 hour", "-o", "b.nc")
        self.assertEqual(branch.returncode, 2, branch.stderr)
        self.assertIn("cells have no state of their own", branch.stderr)


if __name__ == "__main__":
    PROGRAM, SOURCE = sys.argv[1], sys.argv[2]
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
