#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`domain: {file: ...}`: what goes in by a file is what the surface itself gives, to the bit.

usage: test_domain_file.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

REST = """material: {shear_modulus: 20 GPa, poisson: 0.25, shear_speed: 3 km/s}
load: {normal: {pressure: 90 MPa}}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: 0.1 mm, v0: 1 um/s}}
initial:
  slip_rate: 1 cm/week
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 2}}}
transfer: {hierarchy: {stiffness: elastic}}
time: {end: 1 hour}
output: {fields: [traction, slip_rate], fields_every: {time: 30 min}}
rg: {field: equal, beta: 0.7}
"""
JOINT = "{size: 32, levels: 5, surface: {self-affine: {hurst: 0.8, rms_slope: 0.1, seed: 1}}}"
FILE = "{size: 32, levels: 5, domain: {file: {path: %s, pressures: %s}}}"


def case(interface):
    return f"lacuna: 1\ninterface: {interface}\n{REST}"


class DomainFile(Case):
    def setUp(self):
        super().setUp()
        self.write("joint.yaml", case(JOINT))

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def file_case(self, path, pressures="kept"):
        self.write("file.yaml", case(FILE % (path, pressures)))

    def follow(self, name, out, command="run", *words):
        self.expect(0, command, name, "-o", out, "--force", "-q", *words)

    def same(self, one, other, skip=()):
        with netCDF4.Dataset(self.path(one)) as a, netCDF4.Dataset(self.path(other)) as b:
            self.assertEqual(sorted(a.variables), sorted(b.variables))
            for name in set(a.variables) - set(skip):
                self.assertEqual(a[name][:].tobytes(), b[name][:].tobytes(), name)

    def pressures(self, name):
        with netCDF4.Dataset(self.path(name)) as data:
            return numpy.array(data["pressure"][:]).ravel()

    def test_a_run_on_the_file_is_the_run_on_the_surface(self):
        self.follow("joint.yaml", "contact.nc", "contact")
        self.follow("joint.yaml", "joint.nc")
        for source in ("contact.nc", "joint.nc"):
            with self.subTest(source):
                self.file_case(source)
                self.follow("file.yaml", "file.nc")
                self.same("joint.nc", "file.nc")

    def test_contact_and_cascade_too(self):
        self.follow("joint.yaml", "contact.nc", "contact")
        self.file_case("contact.nc")
        self.follow("file.yaml", "again.nc", "contact")
        self.assertEqual(self.pressures("contact.nc").tobytes(), self.pressures("again.nc").tobytes())
        self.follow("joint.yaml", "joint-rg.nc", "rg")
        self.follow("file.yaml", "file-rg.nc", "rg")
        self.same("joint-rg.nc", "file-rg.nc", skip=["interface_seed"])
        done = json.loads(self.expect(0, "check", "file.yaml", "--json").stdout)
        self.assertTrue(done["estimate"]["contact_cells_exact"])
        self.assertEqual(done["estimate"]["contact_cells"],
                         numpy.count_nonzero(self.pressures("contact.nc")))

    def test_the_last_step_of_a_history(self):
        history = JOINT + "\n"
        self.write("history.yaml", case(history).replace(
            "load: {normal: {pressure: 90 MPa}}", "load: {normal: {pressure: 50 MPa}, history: "
            "{friction: 0.6, steps: [{ratio_x: 0.1}, {pressure: 90 MPa}]}}"))
        self.follow("history.yaml", "history.nc", "contact")
        self.file_case("history.nc")
        self.follow("file.yaml", "file.nc", "contact")
        with netCDF4.Dataset(self.path("history.nc")) as data:
            last = numpy.array(data["step_pressure"][-1]).ravel()
        self.assertEqual(self.pressures("file.nc").tobytes(), last.tobytes())

    def test_pressures_scaled_or_equal(self):
        self.follow("joint.yaml", "contact.nc", "contact")
        given = self.pressures("contact.nc")
        for how, expected in (("scaled", given * 0.5),
                              ("equal", (given > 0) * 45e6 * 1024 / numpy.count_nonzero(given))):
            self.file_case("contact.nc", how)
            self.follow("file.yaml", "half.nc", "contact", "--set", "load.normal.pressure=45 MPa")
            numpy.testing.assert_allclose(self.pressures("half.nc"), expected, rtol=1e-12)

    def test_a_grid_of_numbers(self):
        mask = numpy.zeros((32, 32))
        mask[3:9, 20:30] = 1
        numpy.save(self.path("mask.npy"), mask)
        self.file_case("mask.npy", "scaled")
        self.follow("file.yaml", "file.nc", "contact")
        numpy.testing.assert_allclose(self.pressures("file.nc"), mask.ravel() * 90e6 * 1024 / 60,
                                      rtol=1e-12)
        self.expect_line(2, "interface.spread: needs interface.domain.file.pressures: equal to vary",
                         "run", "file.yaml", "--set",
                         "interface.spread={pressure: {lognormal: {sigma: 1}}}")
        self.follow("file.yaml", "spread.nc", "contact", "--set", "interface.domain.file.pressures=equal",
                    "--set", "interface.spread={pressure: {lognormal: {sigma: 1}}}")

    def expect_line(self, status, says, *words):
        error = self.expect(status, *words).stderr
        self.assertEqual(error.count("\n"), 1, error)
        self.assertIn(says, error)

    def test_messes_are_one_line(self):
        self.follow("joint.yaml", "contact.nc", "contact")
        self.follow("joint.yaml", "run.nc", "run")
        with open(self.path("contact.nc"), "rb") as file:
            whole = file.read()
        with open(self.path("cut.nc"), "wb") as file:
            file.write(whole[:len(whole) // 2])
        with open(self.path("empty.nc"), "wb"):
            pass
        with netCDF4.Dataset(self.path("other.nc"), "w") as data:
            data.createDimension("z", 3)
        numpy.save(self.path("negative.npy"), numpy.full((32, 32), -1.0))
        numpy.save(self.path("nothing.npy"), numpy.zeros((32, 32)))
        numpy.save(self.path("small.npy"), numpy.ones((16, 32)))
        numpy.save(self.path("tiny.npy"), numpy.full((32, 32), 5e-324))
        os.mkfifo(self.path("pipe.nc"))
        with open(self.path("kilos.nc"), "wb") as file:
            file.write(whole)
        with netCDF4.Dataset(self.path("kilos.nc"), "a") as data:
            data["pressure"].units = "kg"
        for path, status, says in (
                ("pipe.nc", 3, "is no file"), ("kilos.nc", 2, 'pressure is in "kg": must be in Pa'),
                ("gone.nc", 3, "No such file"), (".", 3, "is no file"),
                ("joint.yaml", 2, "none of the formats"),
                ("cut.nc", 3, ""), ("empty.nc", 2, ""), ("other.nc", 3, "other.nc"),
                ("negative.npy", 2, "cell (0, 0) is -1 Pa"), ("nothing.npy", 2, "no cell is in contact"),
                ("small.npy", 2, "has 32 x 16 cells, the interface 32 x 32"),
                ("tiny.npy", 2, "carry a mean of")):
            for command in ("run", "check", "contact", "rg"):
                with self.subTest(path=path, command=command):
                    self.file_case(path)
                    words = ["-o", "out.nc", "--force"] if command != "check" else []
                    self.expect_line(status, says, command, "file.yaml", *words)
        self.file_case("contact.nc")
        for change, says in (("interface.levels=4", "has 32 x 32 cells, the interface 16 x 16"),
                             ("interface.size=64", "its cells are 1 m x 1 m, those of the interface 2 m x 2 m"),
                             ("load.normal.pressure=1 MPa", "carry a mean of 90000000 Pa"),
                             ("rg.seeds=2", "does not depend on a seed"),
                             ("rg.field=elastic", "needs interface.surface")):
            self.expect_line(2, says, "rg", "file.yaml", "-o", "out.nc", "--force", "--set", change)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
