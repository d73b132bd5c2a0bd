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
  pore_pressure: [{step: {value: "0.02 MPa", at: "3 day"}}]
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "0.1 mm", v0: "1 um/s"}}
initial:
  slip_rate: "1 cm/week"
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 2}}}
material: {shear_modulus: "20 GPa", poisson: 0.25, shear_speed: "3 km/s"}
transfer: {hierarchy: {k0: 10 GPa/m, ratio: 0.5}}
time: {end: "30 day"}
solver: {rtol: 1e-7}
analysis: {rg: {critical_fraction: 0.5}}
output:
  every: {time: 2 hour, steps: 3}
  fields: [slip, slip_rate, state, traction]
  fields_every: {time: 7 hour, per_decade: 2}
  checkpoint: {steps: 40, time: 1 day}
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

    def start(self, *words, **more):
        return subprocess.Popen([PROGRAM, "run", *words, "--no-progress"], cwd=self.folder,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)

    def run_case(self, status, *words, **more):
        process = self.start(*words, **more)
        out, err = process.communicate(timeout=200)
        self.assertEqual(process.returncode, status, err)
        if status in (2, 3):
            self.assertEqual(err.count("\n"), 1, err)
        return out, err

    def stop_when(self, process, name, size, number):
        """Sends a signal once the file has come to a size; False where the run was faster."""
        limit = time.time() + 60
        while process.poll() is None and time.time() < limit:
            if os.path.exists(self.path(name)) and os.path.getsize(self.path(name)) >= size:
                process.send_signal(number)
                break
        process.communicate(timeout=60)
        return process.returncode != 0

    def same(self, one, other):
        a, b = contents(self.path(one)), contents(self.path(other))
        self.assertEqual(list(a[0]), list(b[0]))
        for name in a[0]:
            self.assertEqual(a[0][name], b[0][name], name)
        self.assertEqual({k: str(v) for k, v in a[1].items()},
                         {k: str(v) for k, v in b[1].items()})

    def stop_anywhere(self, number, seed, *words):
        """Stops a run wherever it is, and again, until it gets to its end; then compares."""
        chance = random.Random(seed)
        self.run_case(0, "c.yaml", "-o", "whole.nc", *words)
        size = os.path.getsize(self.path("whole.nc"))
        start = os.path.getsize(self.path("whole.nc")) // 4
        process = self.start("c.yaml", "-o", "out.nc", *words)
        stops = 0
        while self.stop_when(process, "out.nc", chance.randint(start, size), number):
            stops += 1
            self.assertTrue(os.path.exists(self.path("out.nc.checkpoint")))
            if stops == 3:
                self.run_case(0, "c.yaml", "-o", "out.nc", "--resume", *words)
                break
            process = self.start("c.yaml", "-o", "out.nc", "--resume", *words)
        self.same("whole.nc", "out.nc")
        self.assertFalse(os.path.exists(self.path("out.nc.checkpoint")))
        return stops

    def test_killed_at_any_moment(self):
        stops = sum(self.stop_anywhere(signal.SIGKILL, seed, "--force") if seed == 0 else
                    self.again(signal.SIGKILL, seed) for seed in range(4))
        self.assertGreater(stops, 0)

    def again(self, number, seed, *words):
        for name in ("whole.nc", "out.nc"):
            os.remove(self.path(name))
        return self.stop_anywhere(number, seed, *words)


def main():
    global PROGRAM
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()


if __name__ == "__main__":
    main()
