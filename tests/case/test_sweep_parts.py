#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a sweep, gathered, are the whole; a member is what its own values make it.

usage: test_sweep_parts.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import os
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE = "", ""
BLOCK = "cases/block.yaml"
OVER = ["--over", "friction.aging.dc=loguniform(0.5 mm, 2 mm)", "--over", "initial.slip_rate=normal(1 mm/week, 0.4 mm/week)"]


def content(path):
    """All that a file holds but its history, to the bit."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        values = {name: v[:].tolist() if v.dtype == str else v[:].tobytes() for name, v in file.variables.items()}
        return values, {name: str(file.getncattr(name)) for name in file.ncattrs() if name != "history"}


class Parts(unittest.TestCase):
    def setUp(self):
        self.place = tempfile.TemporaryDirectory()
        self.addCleanup(self.place.cleanup)

    def at(self, name):
        return os.path.join(self.place.name, name)

    def call(self, *words, status=0):
        done = subprocess.run([PROGRAM, *words], cwd=SOURCE, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stderr

    def sweep(self, out, *words, case=BLOCK):
        self.call("sweep", case, "-q", "--jobs", "1", "-o", self.at(out), *words)
        return self.at(out)

    def test_parts_are_the_whole(self):
        """64 members in 1, 4 and 7 parts, of every design that draws: the same bits, those of broken members too."""
        for design in ("random", "lhs", "sobol", "saltelli"):
            words = [*OVER, "--design", design, "--members", "64"]
            whole = content(self.sweep(design + ".nc", *words))
            for n in (4, 7):
                parts = [self.sweep(f"{design}-{n}-{i}.nc", *words, "--shard", f"{i}/{n}") for i in range(n)]
                self.call("gather", *reversed(parts), "-q", "-o", self.at(f"{design}-{n}.nc"))
                self.assertEqual(content(self.at(f"{design}-{n}.nc")), whole, (design, n))

    def test_a_member_alone(self):
        """A member made alone is its row, and the run of its values."""
        with netCDF4.Dataset(self.sweep("all.nc", *OVER, "--members", "40")) as all_of, netCDF4.Dataset(
                self.sweep("one.nc", *OVER, "--members", "40", "--member", "23")) as one:
            for name, v in one.variables.items():
                if v.dimensions[:1] == ("realization",) and name != "message":
                    self.assertEqual(v[0].tolist(), all_of[name][23].tolist(), name)

    def test_gather_refuses(self):
        """Missing and doubled members, and those of another sweep."""
        words = [*OVER, "--members", "6"]
        one, two = (self.sweep(f"{i}.nc", *words, "--shard", f"{i}/2") for i in range(2))
        other = self.sweep("other.nc", *words, "--seed", "2", "--shard", "1/2")
        for files, said in (((one,), "3 of 6 members are in none"), ((one, two, two), "is in"), ((one, other), "is of another sweep")):
            self.assertIn(said, self.call("gather", *files, "-o", self.at("no.nc"), status=2))
        self.assertFalse(os.path.exists(self.at("no.nc")))

    def test_refused_for_itself_alone(self):
        """A value that the case refuses is a row with its message; one that only the member before would not go with is none."""
        with netCDF4.Dataset(self.sweep("list.nc", "--over", "friction.aging.dc=1 mm, -1 mm, 0 mm, 2 mm")) as file:
            self.assertEqual(file["failure_time"][:].mask.tolist(), [False, True, True, False])
            self.assertIn('"-1 mm" must be', str(file["message"][1]))
        with open(self.at("table.csv"), "w", encoding="utf-8") as table:
            table.write("load.shear.0.ramp.start:day,load.shear.0.ramp.end:day\n1,11\n40,50\n2,3\n30,35\n")
        with netCDF4.Dataset(self.sweep("table.nc", "--table", self.at("table.csv"), case="cases/load/ramp.yaml")) as file:
            self.assertFalse(numpy.ma.getmaskarray(file["mean_slip"][:]).any())


if __name__ == "__main__":
    PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
