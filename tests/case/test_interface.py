#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interfaces of any shape through the whole program, against closed forms; and bad contact cases.

usage: test_interface.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import struct
import sys
import unittest

import test_cli

MODULUS = 20e9
POISSON = 0.25
E_STAR = MODULUS / (1 - POISSON)

CASE = """\
lacuna: 1
interface: {{size: "1 m", {interface}}}
material: {{shear_modulus: "20 GPa", poisson: 0.25}}
load: {{normal: {{{normal}}}}}
"""

# What a run needs beside.
RUN = """\
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "0.1 mm", v0: "1 um/s"}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.9}}
transfer: {hierarchy: {stiffness: elastic}}
time: {end: "30 day"}
"""


def write_npy(path, nx, ny, height):
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({ny}, {nx}), }}"
    head += " " * (-(11 + len(head)) % 64) + "\n"
    values = [height(i, j) for j in range(ny) for i in range(nx)]
    with open(path, "wb") as file:
        file.write(b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head)) + head.encode())
        file.write(struct.pack(f"<{len(values)}d", *values))


class Interfaces(test_cli.Case):
    def heights(self, nx, ny, height):
        write_npy(self.path("heights.npy"), nx, ny, height)

    def case(self, interface, normal='pressure: "3 MPa"', more=""):
        self.write("c.yaml", CASE.format(interface=interface, normal=normal) + more)

    def contact(self, interface, normal='pressure: "3 MPa"', *words):
        self.case(interface, normal)
        return json.loads(self.expect(0, "contact", "c.yaml", "--force", "--json", *words).stdout)

    def pressed(self, interface, normal='pressure: "3 MPa"', *words):
        return self.contact(interface + ", surface: {file: {path: heights.npy}}", normal, *words)

    def near(self, value, exact, part):
        self.assertLessEqual(abs(value / exact - 1), part, f"{value} is not {exact}")


class ClosedForms(Interfaces):
    def hertz(self, nx, ny, length_y, more):
        """A sphere on a free half-space, contact radius 0.15 m."""
        dx, dy, radius, a = 1 / nx, length_y / ny, 2.0, 0.15
        load = 4 / 3 * E_STAR * a ** 3 / radius
        top = (nx // 2 * dx, ny // 2 * dy)

        def height(i, j):
            x, y = (i + 0.5) * dx - top[0], (j + 0.5) * dy - top[1]
            return -(x * x + y * y) / (2 * radius)

        self.heights(nx, ny, height)
        done = self.pressed(f"cells_x: {nx}, cells_y: {ny}, boundary: free{more}",
                            f"pressure: {load / length_y}")
        self.near(done["max_pressure_Pa"], 3 * load / (2 * math.pi * a * a), 15 / nx ** 2)
        self.near(done["contact_fraction"] * length_y, math.pi * a * a, 0.02)
        values = [height(i, j) for j in range(ny) for i in range(nx)]
        sunk = max(values) - sum(values) / len(values) - done["approach_m"]
        self.near(sunk, a * a / radius, 15 / nx ** 2)
        self.assertEqual(done["boundary"], "free")
        return done

    def test_sphere_on_oblong_and_uneven_grids(self):
        self.hertz(120, 80, 80 / 120, "")
        self.hertz(100, 90, 0.5, ', width: "0.5 m"')

    def test_approach_gives_the_load_back(self):
        done = self.hertz(60, 48, 48 / 60, "")
        again = self.pressed("cells_x: 60, cells_y: 48, boundary: free",
                             f"approach: {done['approach_m']!r}")
        self.assertEqual(again["n_cells"], done["n_cells"])
        self.near(again["mean_pressure_Pa"], done["mean_pressure_Pa"], 1e-6)
        self.near(again["max_pressure_Pa"], done["max_pressure_Pa"], 1e-6)

    def wave(self, nx, ny, interface, load):
        """Westergaard's sinusoid; load in units of the one that closes it."""
        depth = 1e-3
        closing = math.pi * E_STAR * depth
        self.heights(nx, ny, lambda i, j: depth * math.cos(2 * math.pi * i / nx))
        done = self.pressed(interface, f"pressure: {load * closing}")
        if load >= 1:
            self.assertEqual(done["contact_fraction"], 1)
            self.assertEqual(done["iterations"], 0)
            self.near(done["max_pressure_Pa"], (load + 1) * closing, 1e-9)
        else:
            area = 2 / math.pi * math.asin(math.sqrt(load))
            self.assertAlmostEqual(done["contact_fraction"], area, delta=2 / nx)
            self.near(done["max_pressure_Pa"], 2 * math.sqrt(load) * closing, 1e-3)

    def test_wave_on_grids_of_any_shape(self):
        for load in (0.05, 0.5, 0.9, 1.0001, 40):
            self.wave(150, 4, "cells_x: 150, cells_y: 4", load)
            self.wave(150, 6, "cells_x: 150, cells_y: 6, width: 2", load)
            self.wave(150, 1, "cells_x: 150, cells_y: 1", load)
            self.wave(150, 1, "cells_x: 150, shape: line", load)

    def test_a_flat_surface_touches_everywhere(self):
        self.heights(30, 20, lambda i, j: 7.5)
        for boundary in ("periodic", "free"):
            done = self.pressed(f"cells_x: 30, cells_y: 20, boundary: {boundary}")
            self.assertEqual(done["contact_fraction"], 1)
            self.near(done["mean_real_pressure_Pa"], 3e6, 1e-9)
        # A punch carries its load at its border, a periodic face everywhere alike.
        self.assertGreater(done["max_pressure_Pa"], 9e6)
        self.near(self.pressed("cells_x: 30, cells_y: 20")["max_pressure_Pa"], 3e6, 1e-12)

    def test_one_asperity_carries_all(self):
        self.heights(24, 18, lambda i, j: 0.5 if (i, j) == (5, 7) else 0)
        for boundary in ("periodic", "free"):
            done = self.pressed(f"cells_x: 24, cells_y: 18, boundary: {boundary}")
            self.assertEqual(done["n_cells"], 1)
            self.near(done["max_pressure_Pa"], 3e6 * 24 * 18, 1e-9)

    def test_levels_and_cells_are_the_same_grid(self):
        surface = ", surface: {self-affine: {rms_height: 1e-3, seed: 5}}"
        for boundary in ("", ", boundary: free"):
            one = self.contact("levels: 5" + boundary + surface)
            for cells in ("cells_x: 32", "cells_x: 32, cells_y: 32",
                          "cells_x: 32, cells_y: 32, width: 1"):
                two = self.contact(cells + boundary + surface)
                one["cpu_time_s"] = two["cpu_time_s"] = 0
                self.assertEqual(one, two)

    def test_turned_round_it_is_the_same(self):
        bumps = [[math.sin(1.7 * i + 0.3 * j * j) * 1e-3 for i in range(40)] for j in range(25)]
        for boundary in ("periodic", "free"):
            self.heights(40, 25, lambda i, j: bumps[j][i])
            one = self.pressed(f"cells_x: 40, cells_y: 25, width: 0.5, boundary: {boundary}")
            self.heights(25, 40, lambda i, j: bumps[i][j])
            two = self.pressed(f"cells_x: 25, cells_y: 40, boundary: {boundary}, width: 1",
                               'pressure: "3 MPa"', "--set", "interface.size=0.5 m")
            self.assertEqual(one["n_cells"], two["n_cells"])
            self.near(one["max_pressure_Pa"], two["max_pressure_Pa"], 1e-6)

    def test_a_uniform_joint_fails_as_a_block(self):
        """Uniform slip costs the hierarchy nothing, whatever its grid."""
        self.case("levels: 0", more=RUN)
        block = json.loads(self.expect(0, "run", "c.yaml", "--json").stdout)
        self.assertTrue(block["failed"])
        for grid in ("cells_x: 12, cells_y: 10, boundary: free", "cells_x: 7, cells_y: 1, width: 3",
                     "cells_x: 1, cells_y: 9, boundary: free", "cells_x: 30, shape: line"):
            self.case(grid + ", domain: {full: {}}", more=RUN)
            done = json.loads(self.expect(0, "run", "c.yaml", "--json", "--force").stdout)
            self.near(done["failure_time_s"], block["failure_time_s"], 1e-4)

    def test_a_free_joint_runs(self):
        self.case("cells_x: 48, cells_y: 36, boundary: free, surface: {self-affine: "
                  "{rms_height: 1e-3}}", more=RUN)
        done = json.loads(self.expect(0, "run", "c.yaml", "--json").stdout)
        self.assertEqual(done["status"], "complete")
        self.assertLessEqual(done["balance_residual"], 0.01)
        check = json.loads(self.expect(0, "check", "c.yaml", "--json").stdout)
        self.assertIn("boundary: free", check["scene"])
        self.write("again.yaml", check["scene"])
        again = json.loads(self.expect(0, "run", "again.yaml", "--json").stdout)
        self.assertEqual(again["failure_time_s"], done["failure_time_s"])

    def test_area_scaling_needs_halvings(self):
        surface = (", surface: {self-affine: {hurst: 0.8, rms_slope: 0.1, rolloff: 0.25, "
                   "shortest: 0.01}}")
        done = self.contact("cells_x: 320, cells_y: 272" + surface, 'pressure: "100 MPa"')
        self.assertTrue(1 < done["delta_s"] < 2)
        # The load that follows from an approach is the one at every resolution.
        near = self.contact("cells_x: 320, cells_y: 272" + surface,
                            f"approach: {done['approach_m']!r}")
        self.near(near["mean_pressure_Pa"], 100e6, 1e-6)
        self.assertAlmostEqual(near["delta_s"], done["delta_s"], delta=1e-3)
        for cells in ("cells_x: 320, cells_y: 160", "cells_x: 300, cells_y: 270", "cells_x: 320, "
                      "cells_y: 1, boundary: free"):
            self.assertIsNone(self.contact(cells + surface)["delta_s"])


class Bad(Interfaces):
    def refuse(self, line, interface, normal='pressure: "3 MPa"'):
        """One line, exit 2, and no file."""
        self.case(interface, normal)
        before = self.files()
        self.expect_line(2, line, "contact", "c.yaml")
        self.assertEqual(self.files(), before)

    def refuse_file(self, line, interface="cells_x: 12, cells_y: 8", normal='pressure: "3 MPa"'):
        for boundary in ("periodic", "free"):
            self.refuse(f"c.yaml: {line}", f"{interface}, boundary: {boundary}, "
                        "surface: {file: {path: heights.npy}}", normal)

    def test_heights_that_are_none(self):
        self.heights(12, 8, lambda i, j: math.nan)
        self.refuse_file("interface.surface: heights.npy: all 96 heights are missing")
        self.heights(12, 8, lambda i, j: math.nan if i == j == 3 else i)
        self.refuse_file("interface.surface: heights.npy: 1 of the 96 cells of the interface have "
                         "no height (no data in 1 samples of the file); choose a smaller "
                         "interface, or use `nodata: nearest`, `mean` or `mask`")
        self.heights(12, 8, lambda i, j: math.inf if i == j == 3 else i)
        self.refuse_file("interface.surface: heights.npy: the height in column 4 of row 4 (from "
                         "the smallest y) is infinite; must be finite, or NaN where there is none")
        os.remove(self.path("heights.npy"))
        self.case("cells_x: 12, surface: {file: {path: heights.npy}}")
        self.assertIn("heights.npy", self.expect(3, "contact", "c.yaml").stderr)

    def test_a_note_is_one_line_whatever_a_file_is_called(self):
        self.case(r'cells_x: 12, surface: {file: {path: "no\nsuch.npy"}}')
        self.expect_line(3, "c.yaml: interface.surface: no?such.npy: No such file or directory",
                         "contact", "c.yaml")

    def test_seeds_that_doubles_cannot_tell_apart(self):
        surface = "cells_x: 12, surface: {self-affine: {rms_height: 1e-3, seed: %d}}"
        self.refuse('c.yaml:2: interface.surface.self-affine.seed: "9007199254740993" must be a '
                    'whole number', surface % (2 ** 53 + 1))
        self.contact(surface % (2 ** 53 - 1))

    def test_file_smaller_than_the_grid(self):
        self.heights(12, 8, lambda i, j: 1e-3 * (i % 3))
        self.refuse_file("interface.surface: heights.npy: it has 8 samples along y, but the "
                         "interface 12 cells; make the interface smaller, or use `fit: pad` or "
                         "`fit: resample`", "cells_x: 12")

    def test_loads_that_press_nothing(self):
        surface = "cells_x: 12, surface: {self-affine: {rms_height: 1e-3}}"
        for value in ("0", "-3 MPa"):
            self.refuse(f'c.yaml:4: load.normal.pressure: "{value}" must be > 0 Pa', surface,
                        f'pressure: "{value}"')

    def test_beyond_full_contact_all_is_closed(self):
        done = self.contact("cells_x: 12, surface: {self-affine: {rms_height: 1e-3}}",
                            'pressure: "1e6 GPa"')
        self.assertEqual(done["contact_fraction"], 1)
        self.assertEqual(done["iterations"], 0)

    def test_approach(self):
        self.heights(12, 8, lambda i, j: 1e-3 * ((i + j) % 2))
        self.refuse_file("contact: the faces do not touch: at an approach of 0.002 m the highest "
                         "peak, 0.0005 m above the mean of the heights, is short of it",
                         normal='approach: "2 mm"')
        self.refuse('c.yaml:4: load.normal.approach: "0" must be > 0 m between periodic faces: '
                    "without a gap any load would do",
                    "cells_x: 12, surface: {self-affine: {rms_height: 1e-3}}", "approach: 0")
        self.refuse('c.yaml:4: load.normal.approach: "1 mm" needs interface.surface: only heights '
                    "tell the load that follows", "cells_x: 12, domain: {full: {}}",
                    'approach: "1 mm"')
        self.case("cells_x: 12, surface: {self-affine: {rms_height: 1e-3}}", 'approach: "1 mm"',
                  RUN)
        self.expect_line(2, 'c.yaml:4: load.normal.approach: "1 mm" is for statics (lacuna '
                         "contact); a run needs a load: pressure, depth or slope", "run", "c.yaml")

    def test_surfaces_that_a_grid_cannot_hold(self):
        self.refuse("c.yaml: interface.surface: benchmark: defined on a square of square cells, "
                    "not on 16 x 8 cells of 0.0625 x 0.0625 m",
                    "cells_x: 16, cells_y: 8, surface: {benchmark: {name: A08}}")
        self.refuse("c.yaml:2: interface.surface: needs interface.levels > 0, or more cells_x or "
                    "cells_y: a single "
                    "block has no cells", "cells_x: 1, surface: {benchmark: {name: A08}}")
        self.refuse("c.yaml: domain cascade: dimension 1.5: must be > 0 and <= 1 on a line",
                    "cells_x: 16, shape: line, domain: {cascade: {dimension: 1.5}}")

    def test_large_grids(self):
        """Accepted up to 32768 x 32768; one that memory does not hold is refused before it is made."""
        self.case("levels: 15, domain: {cascade: {dimension: 1.2}}", more=RUN)
        done = json.loads(self.expect(0, "check", "c.yaml", "--json").stdout)
        self.assertEqual(done["estimate"]["grid_cells"], 32768 ** 2)
        self.assertGreater(done["estimate"]["memory_bytes"], 13 * 32768 ** 2)
        if os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") < 48e9:
            self.case("levels: 15, boundary: free, "
                      "surface: {self-affine: {hurst: 0.8, rms_height: 1 mm}}")
            self.assertRegex(self.expect(1, "contact", "c.yaml").stderr,
                             r"^lacuna: c.yaml: interface: 32768 x 32768 cells take at least "
                             r"48.3 GB of memory, [0-9.]+ GB are free\n$")
        self.case("cells_x: 32768, cells_y: 32769, domain: {full: {}}", more=RUN)
        self.expect_line(2, 'c.yaml:2: interface.cells_y: "32769" makes 1073774592 cells; at most '
                         "1073741824 (32768 x 32768) are possible", "check", "c.yaml")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = map(os.path.abspath, sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
