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
from test_resume import TABLE

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

    def test_every_kind_from_its_checkpoint_to_the_bit(self):
        for name, (case, settings) in TABLE.items():
            with self.subTest(name):
                self.setUp()
                self.write_record()
                # what an indicator knows of the past is left behind
                settings = ["analysis={}" if s.startswith("analysis") else s for s in settings]
                self.from_checkpoint(case, settings)


    # From a snapshot: whatever the unknowns, the run that went on to its tolerance. What the balance has drifted by is left behind.
    def from_snapshot(self, case, settings):
        dropped = ("output.fields", "output.checkpoint", "output.every", "output.precision", "analysis")
        settings = [s.replace("RECORD", self.path("record.nc")) for s in settings if not s.startswith(dropped)]
        settings += [*KEPT, "output.fields_every={per_decade: 8, steps: 30}", "solver.rtol=1e-8"]
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
        for name, (case, settings) in TABLE.items():
            if not case.startswith("weakening"):
                with self.subTest(name):
                    self.setUp()
                    self.write_record()
                    self.from_snapshot(case, settings)

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

if __name__ == "__main__":
    test_resume.PROGRAM, test_resume.SOURCE, test_resume.STOP = (os.path.abspath(argument) for argument in sys.argv[1:4])
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
