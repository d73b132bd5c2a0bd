#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a sweep, gathered, are the whole; a member is what its own values make it.

usage: test_sweep_parts.py PROGRAM SOURCE_FOLDER [unittest options]
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
        return done.stdout if status == 0 else done.stderr

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

    def test_files_of_some_members(self):
        """A file that only a member names is the sweep's too: with another content no part of it fits, nor is gone on from."""
        shutil.copy(os.path.join(SOURCE, BLOCK), self.at("case.yaml"))
        for name in "ab":
            with open(self.at(name + ".csv"), "w", encoding="utf-8") as series:
                series.write("time_s,level\n0,0\n4e7,1\n")
        water = ["--set", 'load.pore_pressure=[{series: {file: a.csv, time: time_s, value: "level:kPa"}}]', "--over", "load.pore_pressure.0.series.file=a.csv, b.csv"]
        words = [*water, "--over", "friction.aging.dc=1 mm, 2 mm"]
        one = self.sweep("0.nc", *words, "--shard", "0/2", case=self.at("case.yaml"))
        same = content(self.sweep("1.nc", *words, "--shard", "1/2", case=self.at("case.yaml")))
        with netCDF4.Dataset(one) as file:
            self.assertEqual([line.split(":")[0] for line in file.sweep_files.split("\n")[1:-1]], ["  a.csv", "  b.csv"])
        with open(self.at("b.csv"), "a", encoding="utf-8") as series:
            series.write("5e7,2\n")
        self.assertIn("b.csv was changed since;", self.call("sweep", self.at("case.yaml"), *words, "-o", one, "--shard", "0/2", "--resume", status=2))
        other = self.sweep("1.nc", *words, "--shard", "1/2", "--force", case=self.at("case.yaml"))
        self.assertNotEqual(content(other), same)
        self.assertIn("b.csv was changed between them", self.call("gather", one, other, "-o", self.at("no.nc"), status=2))

    def test_fields_of_some_members(self):
        """The runs of members that are asked for are kept whole, in any part, and made again where they are gone."""
        words = [*OVER, "--members", "12", "--set", "output.fields=[slip]", "--keep-fields", "1, 3:5"]
        whole = content(self.sweep("all.nc", *words))
        names = [f"all-member-{i}.nc" for i in (1, 3, 4, 5)]
        self.assertEqual(sorted(n for n in os.listdir(self.place.name) if "member" in n), names)
        with netCDF4.Dataset(self.at("all.nc")) as sweep:
            drawn = [v for v in sweep.variables.values() if "sweep_key" in v.ncattrs()]
            sets = [word for v in drawn for word in ("--set", f"{v.sweep_key}={float(v[4])!r} {v.units}")]
        self.call("run", BLOCK, "--set", "output.fields=[slip]", *sets, "-o", self.at("run.nc"), "-q")
        of_run, of_sweep = content(self.at("run.nc")), content(self.at("all-member-4.nc"))
        self.assertEqual(of_run[0], of_sweep[0])
        self.assertIn("cell_slip", of_sweep[0])
        parts = [self.sweep(f"{i}.nc", *words, "--shard", f"{i}/3") for i in range(3)]
        self.assertEqual(sorted(n for n in os.listdir(self.place.name) if n[1:8] == "-member"), ["0-member-3.nc", "1-member-1.nc", "1-member-4.nc", "2-member-5.nc"])
        self.call("gather", *parts, "-o", self.at("gathered.nc"))
        self.assertEqual(content(self.at("gathered.nc")), whole)
        os.remove(self.at("all.nc"))
        self.assertIn("all-member-1.nc: exists already", self.call("sweep", BLOCK, *words, "-o", self.at("all.nc"), status=2))
        self.sweep("all.nc", *words, "--force")
        os.remove(self.at("all-member-3.nc"))
        self.sweep("all.nc", *words, "--resume")
        self.assertTrue(os.path.exists(self.at("all-member-3.nc")))
        for said, wrong in (("must be members from 0 to 11", ["--keep-fields", "7:12"]), ("must be members", ["--keep-fields", "4 5"]), ("keeps no fields", ["--set", "output.fields=[]"])):
            self.assertIn(said, self.call("sweep", BLOCK, *words, *wrong, "-o", self.at("no.nc"), status=2))

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
