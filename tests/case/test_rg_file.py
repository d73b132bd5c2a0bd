#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna rg OUT.nc`: the cells and tractions of a file, against a cascade of its own.

usage: test_rg_file.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE = "", ""

CASE = """lacuna: 1
interface:
  size: 32
  levels: 5
  surface: {self-affine: {hurst: 0.8, rms_slope: 0.1, seed: 1}}
material: {shear_modulus: 20 GPa, poisson: 0.25, shear_speed: 3 km/s}
load:
  normal: {pressure: 90 MPa}
  pore_pressure: [{constant: {value: 5 MPa}}]
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: 0.1 mm, v0: 1 um/s}}
initial:
  slip_rate: 1 cm/week
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 2}}}
transfer: {hierarchy: {stiffness: elastic}}
time: {start: 2020-01-01, end: 5 hour}
output: {fields: [traction], fields_every: {time: 1 hour}}
"""
BLOCK = """lacuna: 1
load: {normal: {pressure: 3 MPa}, shear: [{ratio: 0.58}]}
friction: {aging: {a: 0.010, b: 0.015, dc: 0.1 mm}}
initial: {state: 1 year}
time: {end: 1 day}
output: {fields: [traction]}
"""


# --- The cascade again: thresholds block by block, in numpy and recursion.

def joined(level):
    """{place: children} of the blocks of the next level."""
    blocks = {}
    for x, y in sorted(level, key=lambda at: (at[1], at[0])):
        blocks.setdefault((x // 2, y // 2), []).append((x, y))
    return blocks


def threshold(rule, beta, parts):
    """Of a block, from its children's (gap, cells, strength, traction)."""
    parts = sorted(parts, key=lambda part: (part[0], part[2]))
    cells = sum(part[1] for part in parts)
    left, received, excess, needed = cells, 0.0, 0.0, []
    for gap, n, strength, shear in parts:
        needed.append(gap - received if rule == "fix" else (left * gap - excess) / cells)
        left -= n
        excess += shear - beta * strength
        if left > 0:
            received += (1 - beta) * strength / left
    return max(needed)


def whole(beta, parts):
    """LUMP: whether all points of a block slip; gap <= 0 where their own points have."""
    parts, received = list(parts), 0.0
    while parts:
        ratio = [numpy.inf if part[0] <= 0 else (part[3] + received) / part[2] for part in parts]
        at = int(numpy.argmax(ratio))
        if ratio[at] < 1 - 1e-12:
            return numpy.inf
        strength = parts.pop(at)[2]
        received += (1 - beta) * strength / len(parts) if parts else 0.0
    return 0.0


def levels_of(rule, beta, strength, shear, gap, side):
    """[thresholds of each level], from {place: value}."""
    level = {at: (gap[at], 1, strength[at], shear[at]) for at in strength}
    found = [[part[0] for part in level.values()]]
    while side > 1:
        above = {}
        for at, children in joined(level).items():
            parts = [level[child] for child in children]
            one = whole(beta, parts) if rule == "lump" else threshold(rule, beta, parts)
            above[at] = (one, *(sum(part[k] for part in parts) for k in (1, 2, 3)))
        level, side = above, side // 2
        found.append([part[0] for part in level.values()])
    return found


class Joint:
    """The cells of a run's file at a snapshot."""

    def __init__(self, path, index, share, friction):
        with netCDF4.Dataset(path) as data:
            self.side = int(data.grid_nx)
            places = zip(numpy.floor(data["x"][:] / data.grid_dx_m).astype(int).tolist(),
                         numpy.floor(data["y"][:] / data.grid_dy_m).astype(int).tolist())
            self.at = list(places)
            self.q = data["cell_traction"][index].data
            self.s = friction * share * data["pressure"][:].data
        self.nominal = self.s.sum()

    def levels(self, rule, beta, tau):
        shear = numpy.maximum(self.q, numpy.minimum(self.q + tau, self.s))
        gap = self.s - self.q - tau
        named = [dict(zip(self.at, values.tolist())) for values in (self.s, shear, gap)]
        return levels_of(rule, beta, *named, self.side), shear.sum() / self.nominal

    def critical(self, rule, beta):
        """The first load at which the root slips, scanned in loads as fine as the program's."""
        def slides(tau):
            return self.levels(rule, beta, tau)[0][-1][0] <= 1e-12 * self.nominal / len(self.at)

        if slides(0.0):
            return self.q.sum() / self.nominal
        low, most = 0.0, max(self.s - self.q)
        grid = numpy.linspace(0, most, 2000)
        loads = [numpy.maximum(self.q, numpy.minimum(self.q + t, self.s)).sum() for t in grid]
        for load in numpy.linspace(loads[0], loads[-1], 61)[1:]:
            high = numpy.interp(load, loads, grid)
            if slides(high):
                break
            low = high
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (low, middle) if slides(middle) else (middle, high)
        return self.levels(rule, beta, high)[1]


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-rg-file-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.write("run.yaml", CASE)
        cls.write("block.yaml", BLOCK)
        for name in ("run", "block"):
            cls.call_any("run", name + ".yaml", "--no-progress")

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def write(cls, name, text):
        with open(cls.path(name), "w", encoding="utf-8") as out:
            out.write(text)

    @classmethod
    def call_any(cls, *words):
        return subprocess.run([PROGRAM, *words], text=True, capture_output=True, cwd=cls.folder,
                              check=False)

    def call(self, *words, status=0):
        done = self.call_any(*words)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def rg(self, name, *settings, words=()):
        line = ["rg", name, "--json", "--force", "-o", "out.nc", *words]
        for setting in settings:
            line += ["--set", setting]
        return json.loads(self.call(*line).stdout)

    def refused(self, name, says, *words, status=2):
        done = self.call("rg", name, "-o", "none.nc", *words, status=status)
        self.assertIn(says, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertFalse(os.path.exists(self.path("none.nc")))

    def test_against_another_cascade(self):
        share = 1 - 5 / 90
        for index, friction in ((0, 0.7), (3, 0.65), (3, 0.63), (5, 0.6)):
            joint = Joint(self.path("run.nc"), index, share, friction)
            for rule in ("fix", "cons", "lump"):
                for beta in (0.9, 0.6):
                    done = self.rg("run.nc", f"rg.rule={rule}", f"rg.beta={beta}", "rg.shifts=1",
                                   f"rg.friction={friction}", words=("--snapshot", str(index)))
                    now, load = joint.levels(rule, beta, 0.0)
                    self.assertAlmostEqual(done["q_over_q_nom"], load, delta=1e-12)
                    small = 1e-12 * joint.nominal / len(joint.at)
                    slips = [sum(d <= small for d in level) for level in now]
                    self.assertEqual([row["n_slip_now"] for row in done["results"][0]["levels"]],
                                     slips)
                    self.assertEqual(done["results"][0]["slides_now"], slips[-1])
                    critical = joint.critical(rule, beta)
                    self.assertAlmostEqual(done["q_crit_over_q_nom"], critical, delta=3e-9)
                    self.assertAlmostEqual(done["results"][0]["distance_to_q_crit"],
                                           critical - load, delta=3e-9)

    def test_what_the_file_holds(self):
        done = self.rg("run.nc", "rg.friction=0.63", "rg.shifts=1", "rg.loads=40", "rg.beta=0.8")
        joint = Joint(self.path("run.nc"), -1, 1 - 5 / 90, 0.63)
        with netCDF4.Dataset(self.path("out.nc")) as data:
            self.assertEqual(data.source_file, "run.nc")
            self.assertEqual(data.source_status, "complete")
            self.assertEqual(data.snapshot, done["source"]["snapshot"])
            self.assertEqual(data.snapshot_time_s, done["source"]["time_s"])
            self.assertAlmostEqual(data.effective_share, 1 - 5 / 90)
            self.assertIn("lacuna: 1", data.case)
            self.assertIn("lacuna rg run.nc", data.history)
            self.assertTrue(numpy.allclose(0.63 * data["pressure"][:], joint.s, rtol=1e-14))
            load, slip = data["load"][:], data["slip_load"][0]
            self.assertAlmostEqual(load[0], done["q_over_q_nom"])
            # what slips by itself now has slipped at the first load; the weakest is among the first
            own = data["own_level"][0].filled(-1)
            gap = joint.s - joint.q
            self.assertTrue(numpy.array_equal(own >= 0, (gap <= 0) | (own > 0)))
            self.assertTrue(numpy.all(slip[own >= 0] == load[0]))
            weakest = int(numpy.argmin(gap))
            self.assertAlmostEqual(done["weakest"]["gap_Pa"], gap[weakest], delta=1e-3)
            self.assertAlmostEqual(done["weakest"]["x_m"], data["x"][weakest])
            self.assertEqual(slip[weakest], slip.min())
            for level in range(6):
                expected = int(data["n_slip_now"][0, level])
                blocks = {(int(x) >> level, int(y) >> level)
                          for x, y, o in zip(data["x"][:], data["y"][:], own) if o == level}
                self.assertTrue(len(blocks) <= expected)
        self.call("rg", "run.nc", "-v", "--force")
        check = os.path.join(SOURCE, "tests/support/check_cf.py")
        done = subprocess.run([sys.executable, check, "--status", "complete",
                               self.path("out.nc")], text=True, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_floats(self):
        """A file of single precision says the same, to that."""
        whole = self.rg("run.nc")
        self.call("run", "run.yaml", "--no-progress", "-q", "-o", "float.nc", "--force", "--set",
                  "output.precision=float")
        single = self.rg("float.nc")
        for key in ("q_over_q_nom", "q_crit_over_q_nom"):
            self.assertAlmostEqual(single[key] / whole[key], 1, delta=1e-5)

    def test_snapshots_by_number_time_and_date(self):
        last = self.rg("run.nc")["source"]
        self.assertEqual((last["kind"], last["snapshots"]), ("run", last["snapshot"] + 1))
        for words, index in (("0", 0), ("2", 2), ("last", last["snapshot"]), ("2.5 hour", 2),
                             ("2 hour", 2), ("2020-01-01T03:30", 3), ("9 day", last["snapshot"])):
            source = self.rg("run.nc", words=("--snapshot", words))["source"]
            self.assertEqual((source["snapshot"], source["time_s"] // 3600), (index, index))
        self.refused("run.nc", "run.nc: has no such snapshot: they are 0 to 5", "--snapshot", "6")
        self.refused("run.nc", '--snapshot: "often" must be last, a number', "--snapshot", "often")
        self.refused("run.nc", "is later than -1 s", "--snapshot", "-1 s")
        self.refused("run.yaml", "--snapshot: run.yaml is a case", "--snapshot", "1")

    def test_only_rg_can_be_set(self):
        self.refused("run.nc", "--set: load.normal.pressure: cannot be changed", "--set",
                     "load.normal.pressure=1 MPa")
        self.refused("run.nc", 'rg.field: "elastic" must be equal', "--set", "rg.field=elastic")
        self.refused("run.nc", 'rg.seeds: "3" must be 1', "--set", "rg.seeds=3")
        self.refused("run.nc", 'rg.path: "solve" has no meaning', "--set", "rg.path=solve")
        self.refused("run.nc", 'rg.beta: "2" must be >= 0 and <= 1', "--set", "rg.beta=2")
        self.refused("run.nc", "run.nc: is read by this case", "-o", "run.nc")

    def test_one_block(self):
        with netCDF4.Dataset(self.path("block.nc")) as data:
            q, p = float(data["cell_traction"][-1, 0]), float(data["pressure"][0])
        for rule in ("fix", "cons", "lump"):
            done = self.rg("block.nc", f"rg.rule={rule}", "rg.beta=[0, 0.5, 1]")
            for result in done["results"]:
                self.assertAlmostEqual(result["q_crit_over_q_nom"], 1, delta=1e-9)
                self.assertAlmostEqual(result["distance_to_q_crit"], 1 - q / (0.6 * p), delta=1e-9)
                self.assertEqual(result["slides_now"], 0)

    def test_contacts(self):
        self.write("contact.yaml", CASE.split("initial:")[0])
        self.call("contact", "contact.yaml", "--force", "-o", "contact.nc")
        given = self.rg("contact.nc", "rg.shifts=2")
        case = self.rg("contact.yaml", "rg.shifts=2", "rg.field=equal")
        self.assertEqual(given["source"]["kind"], "contact")
        self.assertEqual(given["q_over_q_nom"], 0)
        self.assertAlmostEqual(given["q_crit_over_q_nom"], case["q_crit_over_q_nom"], delta=2e-9)
        self.assertAlmostEqual(given["q_nom_Pa"], case["q_nom_Pa"])
        self.refused("contact.nc", "is a contact, which has no snapshots", "--snapshot", "0")

    def test_histories(self):
        case = CASE.split("  pore_pressure")[0] + """  history: {steps: [{ratio_x: 0.3}, {ratio_x: 0.5}]}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: 0.1 mm, v0: 1 um/s}}
"""
        self.write("history.yaml", case)
        self.call("contact", "history.yaml", "--force", "-o", "history.nc")
        for words, load in ((("--snapshot", "0"), 0.3), ((), 0.5)):
            done = self.rg("history.nc", words=words)
            self.assertEqual(done["source"]["kind"], "history")
            self.assertAlmostEqual(done["q_over_q_nom"], load, delta=1e-6)
            self.assertTrue(load < done["q_crit_over_q_nom"] < 1)
        self.refused("history.nc", "its steps have no times", "--snapshot", "1 s")
        self.call("contact", "history.yaml", "--force", "-o", "across.nc", "--set",
                  "load.history.steps=[{ratio_x: 0.3}, {ratio_y: 0.5}]")
        self.rg("across.nc", words=("--snapshot", "0"))
        self.refused("across.nc", "step 1 carries 0.3 of its normal force along y")

    def test_files_that_do_not_serve(self):
        self.call("run", "run.yaml", "--force", "-o", "bare.nc", "--set", "output={}", "--until",
                  "1 hour")
        self.refused("bare.nc", "bare.nc: holds no tractions of cells: run the case with "
                     "output.fields: [traction]")
        self.rg("run.nc", "rg.shifts=1")
        self.refused("out.nc", "out.nc: is neither a run nor a contact", status=3)
        self.write("text.nc", "lacuna: 1\n")
        self.refused("text.nc", "text.nc: is not a netCDF file", status=3)
        self.refused("missing.nc", "missing.nc: No such file", status=3)
        with netCDF4.Dataset(self.path("alien.nc"), "w") as data:
            data.createDimension("x", 3)
        self.refused("alien.nc", "alien.nc: is not a file of Lacuna", status=3)
        shutil.copy(self.path("run.nc"), self.path("short.nc"))
        os.truncate(self.path("short.nc"), 20000)
        self.refused("short.nc", "short.nc: is damaged", status=3)

    def test_wrong_numbers_in_a_file(self):
        def change(name, edit, says, status=3):
            shutil.copy(self.path("run.nc"), self.path(name))
            with netCDF4.Dataset(self.path(name), "a") as data:
                edit(data)
            self.refused(name, says, status=status)

        def set_value(name, at, value):
            return lambda data: data[name].__setitem__(at, value)

        def set_text(name, value):
            return lambda data: data.setncattr(name, value)

        change("a.nc", set_value("x", 0, 1e9), "its list of cells makes no sense")
        change("b.nc", set_value("y", 1, numpy.nan), "its list of cells makes no sense")
        change("c.nc", set_value("pressure", 2, -1.0), "its pressure makes no sense")
        change("d.nc", set_value("cell_traction", (5, 3), numpy.nan),
               "its last snapshot makes no sense")
        change("e.nc", set_text("grid_nx", -4), "its grid makes no sense")
        change("f.nc", set_text("grid_nx", 1), "its number of cells makes no sense")
        change("h.nc", set_text("grid_nx", numpy.array([32.0, 32.0])), "its grid makes no sense")
        change("i.nc", set_value("cell_traction", (5, slice(None)), -1e307),
               "the tractions are too large", status=2)
        change("g.nc", set_text("case", CASE.replace("aging", "ageing")), "friction", status=2)

    def test_a_traction_far_beyond_the_strengths(self):
        shutil.copy(self.path("run.nc"), self.path("far.nc"))
        with netCDF4.Dataset(self.path("far.nc"), "a") as data:
            data["cell_traction"][5, 3] = -1e300
        self.assertLess(self.rg("far.nc")["q_crit_over_q_nom"], 0)  # and it ends

    def test_a_run_that_was_killed(self):
        shutil.copy(self.path("run.nc"), self.path("killed.nc"))
        with netCDF4.Dataset(self.path("killed.nc"), "a") as data:
            data.status = "running"
            data["cell_traction"][5, 3] = netCDF4.default_fillvals["f8"]
        done = self.rg("killed.nc")
        self.assertEqual((done["source"]["snapshot"], done["source"]["status"]), (4, "running"))
        self.refused("killed.nc", "has no such snapshot: they are 0 to 4", "--snapshot", "5")
        self.refused("killed.nc", "has no such snapshot: they are 0 to 4", "--snapshot", 20 * "9")


if __name__ == "__main__":
    PROGRAM, SOURCE = (os.path.abspath(word) for word in sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
