#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmarks of the earthquake-cycle community (cases/seas) against what others found, and their stations.

usage: test_seas.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import subprocess
import sys
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

YEAR = 365.25 * 86400
HALF_DAMPING = 32.038120320e9 / (2 * 3464)


class Seas(Case):
    def follow(self, name, *words):
        """Runs a benchmark; its summary."""
        done = self.expect(0, "run", os.path.join(test_cli.SOURCE, "cases", "seas", name + ".yaml"), "--json", "--quiet",
                           "-o", "out.nc", *words)
        return json.loads(done.stdout)

    def earthquakes(self, name, *words):
        return [e["time_s"] / YEAR for e in self.follow(name, *words)["slip_events"] if e["time_s"] is not None]

    def test_bp1(self):
        """A half-space, exactly: 196.389 and 271.906 years by a code that has its own, at rtol 1e-4 on as many cells."""
        found = self.earthquakes("bp1", "--set", "time.end=280 year")
        self.assertEqual(len(found), 2)
        for at, known in zip(found, (196.389, 271.906)):
            self.assertLess(abs(at - known), 2e-3)

    def test_text_says_when(self):
        said = self.expect(0, "run", os.path.join(test_cli.SOURCE, "cases", "seas", "bp1.yaml"), "-q", "-o", "out.nc", "--set", "time.end=280 year",
                           "--set", "solver.rtol=1e-3").stdout
        self.assertRegex(said, r"slip events +2 above 1 mm/s: after 196\.\d+ year, the last after 27[12]\.\d+ year; --json has all\n")

    def test_bp5(self):
        """The second earthquake of an independent program with Okada's half-space on the same cells: after 235.82 years."""
        found = self.earthquakes("bp5", "--set", "solver.rtol=1e-4")
        self.assertEqual(len(found), 1)
        self.assertLess(abs(found[0] - 235.82), 0.02)

    def test_bp6(self):
        """6.56 MPa at the line when pumping ends; slip spreads alike to both sides and stays behind the water."""
        self.follow("bp6", "--set", "interface.cells_x=500", "--set", "output.fields=[slip, pore_pressure]", "--set",
                    "output.fields_every=100 day", "--set", "time.end=200 day")
        with netCDF4.Dataset(self.path("out.nc")) as data:
            pore, slip = data["cell_pore_pressure"][1], data["cell_slip"][-1]
        z = 40.0  # the two cells beside the line
        root = math.sqrt(4 * 0.1 * 8.64e6)
        k = z / root
        g = math.sqrt(8.64e6) * (math.exp(-k * k) / math.sqrt(math.pi) - k * math.erfc(k))
        self.assertLess(abs(pore.max() / (1.25e-6 / (1e-8 * 0.1 * math.sqrt(0.1)) * g) - 1), 1e-9)
        self.assertLess(abs(slip - slip[::-1]).max(), 1e-9)
        self.assertGreater(slip.max(), 0.02)

    def test_bp8_and_stations(self):
        """The slip of the centre, 38.17 mm on ever finer grids, within 2 % on a coarse one; its file for the community."""
        self.follow("bp8", "--set", "interface.cells_x=21")
        self.expect(0, "export", "out.nc", "--stations", "-o", "stations")
        with netCDF4.Dataset(self.path("out.nc")) as data:
            which = list(data["point_name"][:]).index("fltst_strk+000dp+000")
            time = numpy.array(data["time"][:])
            slip, rate, traction, state = (numpy.array(data["point_" + n][:, which]) for n in (
                "slip", "slip_rate", "traction", "state"))
        self.assertLess(abs(slip[-1] / 38.17e-3 - 1), 0.02)
        with open(self.path("stations/fltst_strk+000dp+000.dat"), encoding="utf-8") as text:
            rows = [line.split() for line in text if line[0] != "#"]
        self.assertEqual(rows[0], ["t", "slip", "slip_rate", "shear_stress", "state"])
        table = numpy.array(rows[1:], float).T
        for column, own in zip(table, (time, slip, numpy.log10(rate), (traction - HALF_DAMPING * rate) / 1e6,
                                       numpy.log10(state))):
            self.assertTrue(numpy.allclose(column, own, rtol=1e-9, atol=1e-30))

    def test_other_cells(self):
        """The tool that makes the maps of BP5 makes those of the case again, and a coarse case that runs."""
        tool = os.path.join(test_cli.SOURCE, "tools", "studies", "peers_maps.py")
        for cell in ("1000", "4000"):
            subprocess.run([sys.executable, tool, "--cell", cell, "--folder", self.path(cell), "bp5"], check=True)
        known = os.path.join(test_cli.SOURCE, "cases", "seas", "bp5")
        with open(known + ".yaml", encoding="utf-8") as bundled, open(self.path("1000/bp5.yaml"), encoding="utf-8") as made:
            self.assertEqual(bundled.read(), made.read())
        with netCDF4.Dataset(known + ".nc") as bundled, netCDF4.Dataset(self.path("1000/bp5.nc")) as made:
            for name in ("a", "dc", "state", "slip_rate"):
                self.assertTrue(numpy.allclose(bundled[name][:], made[name][:], rtol=1e-14, atol=0), name)
        self.assertIn(" 25 x 10 cells of 4 km", self.expect(0, "run", "4000/bp5.yaml", "-q", "--set", "time.end=1 day").stdout)

    def test_stations_are_refused(self):
        block = os.path.join(test_cli.SOURCE, "cases", "block.yaml")
        self.expect(0, "run", block, "-o", "block.nc", "--quiet")
        for words, says in ((("block.nc",), "output.points"), (("block.nc", "--csv"), "--csv")):
            done = self.expect(2, "export", *words, "--stations", "-o", "none")
            self.assertIn(says, done.stderr)
            self.assertFalse(os.path.exists(self.path("none")))


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
