#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that are stopped and go on: the file against that of a run that was not stopped.

usage: test_resume.py PROGRAM [unittest options]
"""

import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4
import numpy as np

PROGRAM = ""

# A slope of 64 cells under a load that jumps, to failure: hundreds of steps.
CASE = """\
lacuna: 1
interface: {size: "1 m", levels: 3, domain: {full: {}}}
load:
  normal: {pressure: "3 MPa"}
  pore_pressure: [{step: {value: "0.005 MPa", at: "4 hour"}}]
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "0.1 mm", v0: "1 um/s"}}
initial:
  slip_rate: "1 cm/week"
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 2}}}
material: {shear_modulus: "20 GPa", poisson: 0.25, shear_speed: "3 km/s"}
transfer: {hierarchy: {k0: 10 GPa/m, ratio: 0.5}}
time: {end: "30 day", failure: {mean_slip_rate: "10 um/s"}}
solver: {rtol: 1e-7}
analysis: {rg: {critical_fraction: 0.5}}
output:
  every: {time: 10 min, steps: 3}
  fields: [slip, slip_rate, state, traction]
  fields_every: {time: 30 min, per_decade: 2}
  checkpoint: {steps: 40, time: 1 hour}
"""

# Of the file's own making, or of how long it took.
OWN = {"history", "date_created", "date_modified", "wall_time_s", "resumed", "case"}


def contents(path):
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        values = {name: variable[...].tobytes() for name, variable in file.variables.items()}
        attributes = {name: file.getncattr(name) for name in file.ncattrs() if name not in OWN}
    return values, attributes


class Resume(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        with open(self.path("c.yaml"), "w", encoding="utf-8") as file:
            file.write(CASE)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *words, case="c.yaml", **more):
        return subprocess.Popen([PROGRAM, "run", case, *words, "--no-progress"], cwd=self.folder,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)

    def run_case(self, status, *words, **more):
        process = self.start(*words, **more)
        out, err = process.communicate(timeout=200)
        self.assertEqual(process.returncode, status, err)
        if status in (1, 2, 3):
            self.assertEqual(err.count("\n"), 1, err)
        return out, err

    def stop(self, number, after, *words, **more):
        """Starts a run and stops it after some seconds: how it ended, 0 where it was faster."""
        process = self.start(*words, **more)
        try:
            process.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        process.communicate(timeout=60)
        # A signal before there is anything to close ends the program as any other.
        self.assertIn(process.returncode, (0, 4, -number))
        return process.returncode

    def same(self, one, other):
        a, b = contents(self.path(one)), contents(self.path(other))
        self.assertEqual(list(a[0]), list(b[0]))
        for name in a[0]:
            self.assertEqual(a[0][name], b[0][name], name)
        self.assertEqual({k: str(v) for k, v in a[1].items()},
                         {k: str(v) for k, v in b[1].items()})

    def begin_or_resume(self):
        """A kill may have come before the first checkpoint."""
        return "--resume" if os.path.exists(self.path("out.nc.checkpoint")) else "--force"

    def stop_anywhere(self, number, method, formulation):
        """Stops a run wherever it is, twice where that can be, and compares in the end."""
        words = ["-q", "--set", "solver.method=" + method,
                 "--set", "solver.formulation=" + formulation]
        chance = random.Random(method + formulation)
        began = time.time()
        self.run_case(0, "-o", "whole.nc", "--force", *words)
        took = time.time() - began
        for _ in range(2):
            after = took * chance.uniform(0.2, 0.8)
            if self.stop(number, after, "-o", "out.nc", self.begin_or_resume(), *words) == 0:
                break
        else:
            self.run_case(0, "-o", "out.nc", self.begin_or_resume(), *words)
        self.same("whole.nc", "out.nc")
        self.assertEqual(sorted(os.listdir(self.folder)), ["c.yaml", "out.nc", "whole.nc"])

    def test_killed_or_ended_at_any_moment(self):
        for method, formulation in (("bdf", "rate"), ("bdf", "slip"), ("adams", "slip"),
                                    ("erk", "traction")):
            for number in (signal.SIGKILL, signal.SIGTERM):
                with self.subTest(method=method, formulation=formulation, signal=number):
                    self.setUp()
                    self.stop_anywhere(number, method, formulation)

    def fill_disk(self, limit, *words):
        def set_limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        return self.run_case(3, "-q", "-o", "out.nc", *words, preexec_fn=set_limit)

    def test_full_disk(self):
        self.run_case(0, "-q", "-o", "whole.nc")
        # A megabyte beyond what is written must be free at any time.
        limit = (1 << 20) + os.path.getsize(self.path("whole.nc")) * 19 // 20
        _, err = self.fill_disk(limit)
        self.assertEqual(err, "lacuna: out.nc: cannot write: File too large\n")
        self.run_case(0, "-q", "-o", "out.nc", "--resume")
        self.same("whole.nc", "out.nc")

    def write_forced(self):
        """A case that plans nothing, long enough to be stopped in its midst."""
        text = "\n".join(line for line in CASE.splitlines() if "checkpoint" not in line)
        text = text.replace("every: {time: 10 min, steps: 3}", "every: 1 s")
        with open(self.path("f.yaml"), "w", encoding="utf-8") as file:
            file.write(text)

    def test_forced_within_tolerance(self):
        self.write_forced()
        began = time.time()
        self.run_case(0, "-q", "-o", "whole.nc", case="f.yaml")
        took = time.time() - began
        share = 0.5
        while self.stop(signal.SIGTERM, share * took, "-o", "out.nc", "-q", "--force",
                        case="f.yaml") != 4:
            share = 0.1 + 0.8 * random.random()
        out, _ = self.run_case(0, "-o", "out.nc", "--resume", "--json", case="f.yaml")
        self.assertEqual(json.loads(out)["resumed_from"], "forced")
        with netCDF4.Dataset(self.path("whole.nc")) as a, \
                netCDF4.Dataset(self.path("out.nc")) as b:
            self.assertRegex(b.resumed, r"^forced checkpoint at [0-9.e+]+ s$")
            self.assertEqual(b.status, "complete")
            self.assertEqual(len(b.history.splitlines()), 2)
            self.assertLess(abs(a.failure_time_s / b.failure_time_s - 1), 1e-5)
            n = len(a["time"]) - 2
            np.testing.assert_array_equal(a["time"][:n], b["time"][:n])
            np.testing.assert_allclose(a["slip"][1:n], b["slip"][1:n], rtol=1e-3)
        self.assertFalse(os.path.exists(self.path("out.nc.checkpoint")))

    def refused(self, status, line, *words):
        _, err = self.run_case(status, "-q", *words)
        self.assertRegex(err, "^lacuna: " + line + "\n$")

    def test_refused(self):
        self.refused(3, "--resume: none.nc: No such file or directory", "--resume", "-o", "none.nc")
        self.run_case(0, "-q", "-o", "whole.nc")
        self.refused(2, "--resume: whole.nc is complete", "--resume", "-o", "whole.nc")
        self.refused(2, "--resume keeps the file, --force replaces it: not both", "--resume",
                     "--force", "-o", "whole.nc")
        with open(self.path("text.nc"), "w", encoding="utf-8") as file:
            file.write("text")
        self.refused(3, "text.nc: is not a netCDF file", "--resume", "-o", "text.nc")
        size = os.path.getsize(self.path("whole.nc"))
        self.fill_disk((1 << 20) + size * 19 // 20)
        go_on = ["--resume", "-o", "out.nc"]
        self.refused(2, "--resume: out.nc was begun with another case: it said friction: "
                     "a: 0.01, now friction: a: 0.011", *go_on, "--set", "friction.aging.a=0.011")
        self.refused(2, "--resume: the checkpoint of out.nc is at .*, not before the end of the run",
                     *go_on, "--until", "1 s")
        with open(self.path("out.nc.checkpoint"), "r+b") as file:
            file.seek(1000)
            byte = file.read(1)
            file.seek(1000)
            file.write(bytes([byte[0] ^ 1]))
        self.refused(3, ".*out.nc.checkpoint: is damaged: differs from its checksum", *go_on)
        os.remove(self.path("out.nc.checkpoint"))
        self.refused(2, "out.nc: has no checkpoint to go on from", *go_on)


def main():
    global PROGRAM
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()


if __name__ == "__main__":
    main()
