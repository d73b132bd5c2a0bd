#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that go on from another one: with nothing changed against that one, with another load against closed forms; and refusals.

usage: test_branch.py PROGRAM SOURCE_FOLDER AT_CALL [unittest options]

AT_CALL is the library of tests/stop.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import shutil
import unittest

import netCDF4
import numpy as np

import test_resume
from test_resume import kinds

# Counted from the start of the run, or of the step before.
COUNTED = {"rhs_evaluations", "step_size", "order"}

KEPT = ["output.fields=[slip, slip_rate, state]"]

JUMP = """\
lacuna: 1
interface: {size: "8 m", levels: 3, domain: {full: {}}}
load:
  normal: {pressure: "3 MPa"}
  %(load)s
friction: {%(friction)s, spread: {f0: {normal: {sigma: 0.01, seed: 4}}}}
initial: {state: 20 day}
material: {shear_modulus: "10 GPa", poisson: 0.25, density: "2500 kg/m3"}
transfer: {hierarchy: {stiffness: elastic}}
time: {end: "10 day"}
solver: {rtol: 1e-8}
output: {every: 6 hour, fields: [slip, slip_rate, state], fields_every: 15 hour}
"""


def sets(settings):
    return [word for setting in settings for word in ("--set", setting)]


class Branch(unittest.TestCase):
    path, start, start_at_call, start_to_stop = test_resume.Resume.path, test_resume.Resume.start, test_resume.Resume.start_at_call, test_resume.Resume.start_to_stop
    kill_after_checkpoints, write_record = test_resume.Resume.kill_after_checkpoints, test_resume.Resume.write_record

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)

    def lacuna(self, *words, status=0):
        done = subprocess.run([test_resume.PROGRAM, *words], cwd=self.folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout if status == 0 else done.stderr

    def refused(self, pattern, *words, status=2):
        err = self.lacuna("run", "-q", *words, status=status)
        self.assertRegex(err, pattern)
        self.assertEqual(err.count("\n"), 1, err)

    def case(self, name):
        return os.path.join(test_resume.SOURCE, "cases", name)

    def branch(self, source, at, *settings, out="b.nc", more=()):
        self.lacuna("run", "-q", "--from", source, "--at", at, "-o", out, "--force", *sets(settings), *more)

    def goes_on_as(self, whole, part, compare):
        """Every record of the run that went on is that of the branch, from its time on."""
        with netCDF4.Dataset(self.path(whole)) as a, netCDF4.Dataset(self.path(part)) as b:
            a.set_auto_mask(False)
            b.set_auto_mask(False)
            begin = float(b.branch_time_s)
            for along, times in (("time", "time"), ("snapshot", "snapshot_time")):
                if along not in a.dimensions:
                    continue
                left, right = a[times][:] > begin, b[times][:] > begin
                self.assertEqual(right.sum(), right.size - 1)
                for name, variable in a.variables.items():
                    if variable.dimensions[:1] == (along,) and name in b.variables and name not in COUNTED:
                        compare(name, variable[...][left], b[name][...][right])
            return begin, a["time"][-1]

    def equal(self, name, a, b):
        self.assertEqual(a.shape, b.shape, name)
        self.assertEqual(a.tobytes(), b.tobytes(), name)

    def from_checkpoint(self, case, settings):
        more = {"case": self.case(case)}
        settings = [setting.replace("RECORD", self.path("record.nc")) for setting in settings]
        words = sets(settings)
        self.lacuna("run", "-q", self.case(case), "-o", "whole.nc", *words)
        self.kill_after_checkpoints(2, "-o", "out.nc", "-q", *words, **more)
        self.lacuna("run", "-q", self.case(case), *words, "--from", "out.nc", "-o", "b.nc")
        begin, end = self.goes_on_as("whole.nc", "b.nc", self.equal)
        self.assertTrue(0 < begin < end)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_every_kind_from_its_checkpoint_to_the_bit(self):
        for name, (case, settings) in kinds(1, few=True):  # test_resume goes on from all of them
            with self.subTest(name):
                self.setUp()
                self.write_record()
                # what an indicator knows of the past is left behind
                settings = ["analysis={}" if s.startswith("analysis") else s for s in settings]
                self.from_checkpoint(case, settings)


    def test_events_that_begin_later_are_the_same(self):
        self.from_checkpoint("events.yaml", ["analysis={events: {slip_rate: 1 mm/s}}", "interface.levels=3", "time.end=4 s",
                                             "output.checkpoint={steps: 1500}"])
        with netCDF4.Dataset(self.path("whole.nc")) as a, netCDF4.Dataset(self.path("b.nc")) as b:
            later, own = (file["event_time"][:] > b.branch_time_s for file in (a, b))
            self.assertGreater(later.sum(), 10)
            for name in a.variables:
                if a[name].dimensions == ("event",):
                    np.testing.assert_array_equal(a[name][...][later], b[name][...][own], name)

    # From a snapshot: whatever the unknowns, the run that went on to its tolerance. What the balance has drifted by is left behind.
    def from_snapshot(self, case, settings):
        dropped = ("output.fields", "output.checkpoint", "output.every", "output.precision", "analysis")
        settings = [s.replace("RECORD", self.path("record.nc")) for s in settings if not s.startswith(dropped)]
        kept = {"weakening/bridges.yaml": ", broken_cohesion", "weakening/dilatancy.yaml": ", excess_pore_pressure"}.get(case, "")
        settings += [KEPT[0].replace("]", kept + "]"), "output.every={steps: 1}", "output.fields_every={per_decade: 8, steps: 30}", "solver.rtol=1e-8"]
        self.lacuna("run", "-q", self.case(case), "-o", "whole.nc", *sets(settings))
        with netCDF4.Dataset(self.path("whole.nc")) as a:
            at = len(a["snapshot_time"]) // 2
            self.lacuna("run", "-q", self.case(case), *sets(settings), "--from", "whole.nc", "--at", str(at), "-o", "b.nc")
            with netCDF4.Dataset(self.path("b.nc")) as b:
                self.assertEqual(b.branch_time_s, a["snapshot_time"][at])
                self.assertEqual(b["time"][0], a["snapshot_time"][at])
                np.testing.assert_allclose(b["slip"][0], a["slip"][np.searchsorted(a["time"][:], b["time"][0])], rtol=1e-12)
                np.testing.assert_allclose(b["time"][-1], a["time"][-1], rtol=1e-6)
                np.testing.assert_allclose(b["slip"][-1], a["slip"][-1], rtol=1e-4)

    def test_every_kind_from_a_snapshot(self):
        for name, (case, settings) in kinds(2):
            if name != "hot water":
                with self.subTest(name):
                    self.setUp()
                    self.write_record()
                    self.from_snapshot(case, settings)

    def test_waves_of_heat_are_in_no_snapshot(self):
        self.lacuna("run", "-q", self.case("weakening/pressurization.yaml"), "-o", "a.nc", *sets(KEPT))
        self.refused("a.nc: weakening depends on more than its snapshots can keep: only the checkpoint", "--from", "a.nc", "--at", "1",
                     "-o", "b.nc")
        self.lacuna("run", "-q", self.case("weakening/bridges.yaml"), "-o", "a.nc", "--force", *sets(KEPT))
        self.refused("a.nc: keeps no field that its weakening needs: output.fields: with broken_cohesion; and output.fields_every",
                     "--from", "a.nc", "--at", "1", "-o", "b.nc")

    # A load that jumps at the time of the branch, in the case of a run that never stopped: another way to the same.
    def jumps_alike(self, friction, load, *settings):
        more = JUMP % {"friction": friction, "load": load}
        for name, value in (("calm", "0 Pa"), ("jump", "80 kPa")):
            with open(self.path(name + ".yaml"), "w", encoding="utf-8") as file:
                file.write(more.replace("VALUE", value))
        self.lacuna("run", "-q", "jump.yaml", *sets(settings))
        self.lacuna("run", "-q", "calm.yaml", *sets(settings))
        list_name = next((name for name in ("pore_pressure", "normal_stress") if name in load), "shear")
        key = "load.%s.%d.step.value=80 kPa" % (list_name, 1 if list_name == "shear" else 0)
        for at in ("30 hour", "2"):
            self.branch("calm.nc", at, key, *settings)
            with netCDF4.Dataset(self.path("jump.nc")) as a, netCDF4.Dataset(self.path("b.nc")) as b:
                self.assertEqual(b.branch_time_s, 108000)
                later = a["time"][:] > 108000  # the record at the jump is of what held before it
                np.testing.assert_array_equal(a["time"][:][later], b["time"][1:])
                for name in ("slip", "slip_rate", "max_slip_rate", "shear_force", "effective_normal_force"):
                    np.testing.assert_allclose(b[name][1:], a[name][:][later], rtol=2e-5, err_msg=name)

    def test_another_load_is_a_jump(self):
        pore, shear, normal = "pore_pressure: [%s]", "shear: [{ratio: {value: 0.55}}, %s]", "normal_stress: [%s]"
        step = "{step: {value: VALUE, at: 30 hour}}"
        law, alpha = "aging: {f0: 0.6, a: 0.015, b: 0.010, dc: 1 mm, v0: 1 um/s%s}", ", alpha: 0.2"
        plain, form = law % "", law % ", form: regularised"
        ratio = "shear: [{ratio: {value: 0.55}}]\n  "
        for name, friction, load, settings in (
                ("pore, rate", plain, ratio + pore, ()),
                ("shear, rate", plain, shear, ()),
                ("shear, traction", form, shear, ("solver.formulation=traction",)),
                ("pore, slip", plain, ratio + pore, ("solver.formulation=slip",)),
                ("shear, adams", plain, shear, ("solver.method=adams",)),
                ("pore, erk", plain, ratio + pore, ("solver.method=erk",)),
                ("normal, alpha", law % alpha, ratio + normal, ()),
                ("normal, alpha, slip", law % alpha, ratio + normal, ("solver.formulation=slip",)),
                ("shear, mass", plain, shear, ("inertia={thickness: 20 m}",)),
                ("shear, elastic", plain, shear, ("transfer={elastic: {}}",)),
                ("pore, vector", plain, ratio + pore, ("interface.slip=vector",)),
                ("shear, damped", plain, shear, ("material.shear_speed=3 km/s",))):
            with self.subTest(name):
                self.setUp()
                self.jumps_alike(friction, load % step, *settings)

    def same_values(self, one, other):
        a, b = (test_resume.contents(self.path(name))[0] for name in (one, other))
        self.assertEqual(a, b)

    def calm(self):
        """A run of 10 days that keeps its cells every 15 hours: calm.nc."""
        text = JUMP % {"friction": "aging: {f0: 0.6, a: 0.015, b: 0.010, dc: 1 mm, v0: 1 um/s}",
                       "load": "shear: [{ratio: {value: 0.55}}]\n  pore_pressure: [{constant: {value: 10 kPa}}]"}
        with open(self.path("calm.yaml"), "w", encoding="utf-8") as file:
            file.write(text)
        self.lacuna("run", "-q", "calm.yaml")

    def test_what_is_refused(self):
        self.calm()
        last = len(netCDF4.Dataset(self.path("calm.nc"))["snapshot_time"]) - 1
        out = ("-o", "b.nc", "--from", "calm.nc")
        kept = "cannot become .* keeps its cells"
        for pattern, words in (
                (r'initial.run.at: "11 day", 950400 s, is not within the run in calm.nc, from 0 s to 864000 s', ("--at", "11 day")),
                ('"-1 s", -1 s, is not within', ("--at", "-1 s")),
                ("has no such snapshot as initial.run.at: %d: they are 0 to %d" % (last + 1, last), ("--at", str(last + 1))),
                ('"soon" must be last, a time such as "30 day" or the number of a snapshot', ("--at", "soon")),
                ("time.end: the run would end at 864000 s and goes on from calm.nc at 864000 s", ("--at", "last")),
                ('interface.levels: "3" ' + kept, ("--at", "1 day", "--set", "interface.levels=4")),
                ('interface.size: "8 m" ' + kept, ("--at", "1 day", "--set", "interface.size=9 m")),
                ('load.normal.pressure.*' + kept, ("--at", "1 day", "--set", "load.normal.pressure=4 MPa")),
                ('initial.state: .*' + kept, ("--at", "1 day", "--set", "initial.state=3 day")),
                ('time.start: .*' + kept, ("--at", "1 day", "--set", "time.start=2 day")),
                ('weakening: .*' + kept, ("--at", "1 day", "--set",
                                          "weakening=[{dilatancy: {dilatancy: 1e-5, compressibility: 1e-9 1/Pa, drainage_time: 1 day}}]")),
                ("the mean slip at the start, .* m, is not below the one to stop at, 1e-09 m",
                 ("--at", "1 day", "--set", "time.stop_when.mean_slip=1 nm")),
                ("the mean slip at the start, .* m, is not below that of failure, 1e-09 m",
                 ("--at", "1 day", "--set", "time.failure.mean_slip=1 nm")),
                ("time.end, 10 day|--until", ("--at", "1 day", "--until", "11 day"))):
            with self.subTest(pattern):
                self.refused(pattern, *out, *words)
        self.refused("--at: says when of --from", "calm.yaml", "--at", "1 day")
        self.refused("initial.run.file: is missing", "calm.yaml", "--set", "initial.run={at: 3 day}", "-o", "b.nc")
        self.refused("is read by this case, must not be the output", "--from", "calm.nc", "--at", "1 day", "-o", "calm.nc", "--force")
        self.refused("no.nc: No such file", "--from", "no.nc", "-o", "b.nc", status=3)
        self.refused("calm.yaml: is not a netCDF file", "--from", "calm.yaml", "-o", "b.nc", status=3)
        self.assertFalse(os.path.exists(self.path("b.nc")))

    def test_what_a_file_lacks(self):
        self.calm()
        for setting, pattern in (
                ("output.fields=[slip]", r"keeps no fields \[slip_rate, state\] of its cells: output.fields: \[slip, slip_rate, state\]; "
                 "and output.fields_every: .* or output.checkpoint"),
                ("output.precision=float", "keeps its cells in single precision: output.precision: double")):
            self.lacuna("run", "-q", "calm.yaml", "--force", "-o", "less.nc", "--set", setting)
            self.refused("less.nc: " + pattern, "--from", "less.nc", "--at", "1 day", "-o", "b.nc")
        self.lacuna("contact", "-q", "calm.yaml", "-o", "contact.nc")
        self.refused("contact.nc: is no run to go on from", "--from", "contact.nc", "-o", "b.nc")
        with open(self.path("calm.nc"), "rb") as file:
            whole = file.read()
        for share in (0.3, 0.9):
            with open(self.path("cut.nc"), "wb") as file:
                file.write(whole[:int(share * len(whole))])
            self.refused("cut.nc: is damaged", "--from", "cut.nc", "--at", "1 day", "-o", "b.nc", status=3)
        with netCDF4.Dataset(self.path("calm.nc"), "a") as file:
            file["cell_state"][3, 5] = -1.0
        self.refused("damaged", "--from", "calm.nc", "--at", "3", "-o", "b.nc", status=3)

    def test_slip_rate_and_state_that_fix_the_load(self):
        self.lacuna("run", "-q", self.case("block.yaml"), "-o", "a.nc", *sets(KEPT))
        self.branch("a.nc", "5 day", "load.pore_pressure=[{step: {value: 1 MPa, at: 3 day}}]")
        self.refused("initial.slip_rate and initial.state fix the shear load", "--from", "a.nc", "--at", "5 day", "-o", "c.nc",
                     "--set", "friction.aging.f0=0.5")

    def test_between_snapshots_the_old_loads_hold(self):
        """One block at constant load, and from 5 days on another a: closed form of docs/theory/creep.md, b = 0."""
        text = ("lacuna: 1\nload: {normal: {pressure: 5 MPa}, shear: [{ratio: {value: 0.5}}, {step: {value: 0 Pa, at: 7 day}}]}\n"
                "friction: {aging: {f0: 0.6, a: 0.01, b: 0, dc: 1 mm, v0: 1 um/s}}\ninitial: {state: 1 day}\n"
                "time: {end: 20 day}\nsolver: {rtol: 1e-9}\n"
                "output: {every: 1 day, fields: [slip, slip_rate, state], fields_every: 4 day}\n")
        with open(self.path("a.yaml"), "w", encoding="utf-8") as file:
            file.write(text)
        self.lacuna("run", "-q", "a.yaml")
        before = 1e-6 * math.exp((0.5 - 0.6) / 0.01)
        for settings, after, jump in ((["load.shear.0.ratio.value=0.52"], 1e-6 * math.exp((0.52 - 0.6) / 0.01), 7),
                                      (["friction.aging.a=0.02"], 1e-6 * math.exp((0.5 - 0.6) / 0.02), 7),
                                      (["load.shear.1.step.value=50 kPa"], 1e-6 * math.exp((0.51 - 0.6) / 0.01), 7),
                                      (["load.shear.1.step={value: 50 kPa, at: 5 day}"], 1e-6 * math.exp((0.51 - 0.6) / 0.01), 6)):
            self.branch("a.nc", "6 day", *settings)
            with netCDF4.Dataset(self.path("b.nc")) as b:
                days = b["time"][:] / 86400
                self.assertEqual(days[0], 6)
                np.testing.assert_allclose(days, np.arange(6, 21), rtol=1e-14)
                step = "step.value" in settings[0]
                begins = 7 if step else 6
                rate = np.where(days > begins, after, after if begins == 6 else before)
                slip = 86400 * (before * np.minimum(days, begins) + after * np.maximum(days - begins, 0))
                np.testing.assert_allclose(b["slip"][:], slip, rtol=1e-8)
                np.testing.assert_allclose(b["slip_rate"][1:][days[1:] != begins], rate[1:][days[1:] != begins], rtol=1e-8)

    def test_what_the_file_says(self):
        self.calm()
        text = self.lacuna("check", "--from", "calm.nc", "--at", "20 hour", "--set", "load.shear.0.ratio.value=0.56")
        plan = " ".join(text.split("# Branch")[1].replace("#", " ").split())
        self.assertEqual(plan, "goes on from calm.nc at 72000 s (0.833333 day), from its snapshot 1 at 54000 s, run on to there under its "
                               "own loads; changed: load.shear.0.ratio.value: 0.55 -> 0.56")
        said = json.loads(self.lacuna("check", "--from", "calm.nc", "--at", "20 hour", "--json"))
        self.assertRegex(said["branch"], "nothing is changed$")
        done = subprocess.run([test_resume.PROGRAM, "run", "--from", "calm.nc", "--at", "20 hour", "--set", "load.shear.0.ratio.value=0.56",
                               "--no-progress"], cwd=self.folder, capture_output=True, text=True, check=True)
        self.assertIn("lacuna: goes on from calm.nc", done.stderr)
        with netCDF4.Dataset(self.path("calm-branch.nc")) as b, netCDF4.Dataset(self.path("calm.nc")) as a:
            self.assertEqual((b.branch_file, b.branch_time_s, b.branch_changes),
                             ("calm.nc", 72000, "load.shear.0.ratio.value: 0.55 -> 0.56"))
            self.assertRegex(b.branch_case_sum, "^[0-9a-f]{16}$")
            self.assertRegex(b.branch, "mean slip rate .* -> .* m/s, shear force .* -> .* N, slip and state of the cells as they were$")
            self.assertIn('at: "20 hour"', b.case)
            self.assertEqual(b["time"][0], 72000)
            self.assertAlmostEqual(b["shear_force"][0] / a["shear_force"][0], 0.56 / 0.55, 12)
            self.assertLess(b["balance_residual"][0], 1e-9)

    def test_a_branch_is_a_run(self):
        """It is kept, stopped and gone on with, branched off again, and made again by the case that its file holds."""
        self.calm()
        more = ("load.shear.0.ratio.value=0.56", "output.checkpoint={steps: 25}")
        self.branch("calm.nc", "20 hour", *more, out="whole.nc")
        words = ("--from", "calm.nc", "--at", "20 hour", "-o", "out.nc", "-q", *sets(more))
        self.kill_after_checkpoints(2, *words, case="calm.yaml")
        self.lacuna("run", "calm.yaml", "--resume", *words)
        self.same_values("whole.nc", "out.nc")
        with netCDF4.Dataset(self.path("whole.nc")) as file:
            with open(self.path("again.yaml"), "w", encoding="utf-8") as text:
                text.write(file.case)
        self.lacuna("run", "-q", "again.yaml", "-o", "again.nc")
        self.same_values("whole.nc", "again.nc")
        self.branch("whole.nc", "3 day", "load.shear.0.ratio.value=0.55", out="second.nc")
        with netCDF4.Dataset(self.path("second.nc")) as b:
            self.assertEqual(b.branch_file, "whole.nc")
            self.assertEqual(b["time"][0], 3 * 86400)
        self.branch("calm.nc", "20 hour", "load.shear.0.ratio.value=0.56", "solver.accuracy=1%", out="near.nc")
        with netCDF4.Dataset(self.path("near.nc")) as b, netCDF4.Dataset(self.path("whole.nc")) as a:
            self.assertLess(abs(b["slip"][-1] / a["slip"][-1] - 1), 0.01)


if __name__ == "__main__":
    test_resume.PROGRAM, test_resume.SOURCE, test_resume.STOP = (os.path.abspath(argument) for argument in sys.argv[1:4])
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
