#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What `lacuna contact` says of the fractal measures, and the tools that read it.

usage: test_fractal.py PROGRAM SOURCE_FOLDER [unittest options]

Every number is worked out again here from the others.
"""

import csv
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from math import exp, isclose, log, sqrt

PROGRAM, SOURCE = "", ""
J07 = "cases/contact/j07.yaml"
SMALL = ["--set", "interface.levels=9"]


def line(x, y):
    """Slope and intercept by least squares, and the standard error of the slope."""
    n, mean_x, mean_y = len(x), sum(x) / len(x), sum(y) / len(y)
    xx = sum((a - mean_x) ** 2 for a in x)
    slope = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / xx
    rest = sum((b - mean_y - slope * (a - mean_x)) ** 2 for a, b in zip(x, y))
    return slope, mean_y - slope * mean_x, sqrt(rest / (n - 2) / xx) if n > 2 else 0.0


class Case(unittest.TestCase):
    """A folder of its own, and ways to call the program in it."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-fractal-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)

    @classmethod
    def call(cls, *words, program=None):
        return subprocess.run([*(program or [PROGRAM]), *words], capture_output=True, text=True,
                              cwd=cls.folder, check=False)

    @classmethod
    def contact(cls, case, *words):
        done = cls.call("contact", os.path.join(SOURCE, case), "--force", "-o", "out.nc", *words)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        return done.stdout

    def refuse(self, word, *words):
        done = self.call("contact", os.path.join(SOURCE, J07), *SMALL, "-o", "none.nc", *words)
        self.assertEqual(done.returncode, 2)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertIn(word, done.stderr)
        self.assertFalse(os.path.exists(os.path.join(self.folder, "none.nc")))


class Scaling(Case):
    """J07 at a hundredth of E* on 512 cells a side."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.done = json.loads(cls.contact(J07, *SMALL, "--json", "--boxes", "2:16"))
        cls.rows = cls.done["resolutions"]

    def close(self, a, b, tolerance=1e-9):
        self.assertTrue(isclose(a, b, rel_tol=tolerance, abs_tol=1e-14), f"{a} is not {b}")

    def test_areas_are_those_of_another_code(self):
        for row, area in zip(self.rows, (0.104736, 0.086121, 0.068253, 0.055264)):
            self.assertAlmostEqual(row["area_fraction"], area, delta=1e-6)
        self.assertEqual(len(self.rows), 4)
        self.assertEqual(self.done["coarsening"], "point sampling")

    def test_load_is_the_same_at_every_resolution(self):
        for row in self.rows:
            self.close(row["pressure_Pa"] * row["area_m2"], 1e7, 1e-7)
            self.close(row["area_m2"], row["cells"] * row["cell_size_m"] ** 2)
        self.close(self.done["load_N"], 1e7, 1e-7)
        self.assertLess(self.done["load_spread"], 1e-7)
        self.assertEqual(self.rows[-1]["cells"], self.done["n_cells"])

    def test_dimension_follows_from_the_areas(self):
        fitted = [row for row in self.rows if row["fitted"]]
        self.assertEqual(len(fitted), 3)
        for rows, name in ((fitted, "delta_s"), (self.rows, "delta_s_all")):
            r = [log(row["cell_size_m"]) for row in rows]
            slope, intercept, error = line(r, [log(row["area_m2"]) for row in rows])
            self.close(self.done[name], 2 - slope)
            self.close(self.done[name + "_regression_error"], error, 1e-6)
            self.assertGreaterEqual(self.done[name + "_error"], error)
            if name == "delta_s":
                self.close(self.done["fractal_area"], exp(intercept))
                self.close(self.done["fractal_pressure"], 1e7 / exp(intercept), 1e-7)
                self.assertEqual(self.done["fractal_area_unit"], f"m^{2 - slope:.3f}")
                self.assertEqual(self.done["fractal_pressure_unit"], f"N m^-{2 - slope:.3f}")

    def test_other_slopes(self):
        fitted = [row for row in self.rows if row["fitted"]]
        r = [log(row["cell_size_m"]) for row in fitted]
        slope = line(r, [log(row["rms_slope"]) for row in fitted])[0]
        self.close(self.done["delta_s_from_slopes"], 2 + slope)
        for row, finer in zip(self.rows, self.rows[1:]):
            local = log(row["area_m2"] / finer["area_m2"]) / log(2)
            self.close(row["local_delta_s"], 2 - local)
        self.assertIsNone(self.rows[-1]["local_delta_s"])
        for row in self.rows:
            self.close(row["kappa"], row["area_m2"] * row["rms_slope"] * 1e9 / 1e7, 1e-7)

    def test_boxes(self):
        boxes = self.done["boxes"]
        self.assertEqual([box["side_cells"] for box in boxes], [2 ** j for j in range(10)])
        fitted = [box for box in boxes if box["fitted"]]
        self.assertEqual([box["side_cells"] for box in fitted], [2, 4, 8, 16])
        slope, _, error = line([log(box["side_m"]) for box in fitted],
                               [log(box["count"]) for box in fitted])
        self.close(self.done["d_box"], -slope)
        self.close(self.done["d_box_regression_error"], error, 1e-6)
        self.assertEqual(boxes[0]["count"], self.done["n_cells"])
        self.assertIsNone(boxes[-1]["local_d_box"])
        for box, larger in zip(boxes, boxes[1:]):
            self.close(box["local_d_box"], log(box["count"] / larger["count"]) / log(2))

    def test_clusters(self):
        clusters = self.done["clusters"]
        octaves = clusters["octaves"]
        self.assertEqual(sum(octave["number"] for octave in octaves), clusters["number"])
        self.assertEqual(sum(octave["cells"] for octave in octaves), self.done["n_cells"])
        for octave in octaves:
            least = octave["from_cells"]
            self.assertTrue(octave["number"] * least <= octave["cells"])
            self.assertTrue(octave["cells"] <= octave["number"] * (2 * least - 1))
        self.assertTrue(octaves[-1]["from_cells"] <= clusters["largest_cells"]
                        < 2 * octaves[-1]["from_cells"])
        self.close(clusters["mean_cells"], self.done["n_cells"] / clusters["number"])
        self.assertGreaterEqual(clusters["widest_m"], clusters["largest_extent_m"])

    def test_size_effect(self):
        rows = self.done["size_effect"]
        self.assertEqual([row["size_m"] for row in rows],
                         [0.05, 0.1, 0.2, 0.4, 1, 10, 100, 1000])
        for row in rows:
            # The interface is 1 m wide.
            want = row["size_m"] ** (self.done["delta_s"] - 2)
            self.close(row["relative_strength"], want)
            self.close(row["mean_pressure_Pa"], 1e7 * want, 1e-7)
            spread = row["size_m"] ** self.done["delta_s_error"]
            self.close(row["relative_strength_low"], want * min(spread, 1 / spread))
            self.close(row["relative_strength_high"], want * max(spread, 1 / spread))
        with open(os.path.join(SOURCE, "cases/data/size_effect.csv"), encoding="utf-8") as file:
            table = list(csv.DictReader(row for row in file if not row.startswith("#")))
        published = self.done["published_exponents"]
        self.assertEqual([row["source"] for row in table], [row["source"] for row in published])
        for row, known in zip(table, published):
            self.assertEqual(float(row["exponent_low"]), known["exponent_low"])
            self.assertEqual(float(row["longest_m"] or "nan") if row["longest_m"] else None,
                             known["longest_m"])

    def test_file_holds_the_same(self):
        import netCDF4
        with netCDF4.Dataset(os.path.join(self.folder, "out.nc")) as data:
            for key in ("delta_s", "delta_s_error", "fractal_pressure", "load_N",
                        "fractal_pressure_unit", "coarsening", "d_box", "d_box_error"):
                self.assertEqual(data.getncattr(key), self.done[key])
            self.assertEqual(data.clusters, self.done["clusters"]["number"])
            for name, list_name, key in (
                    ("resolution", "resolutions", "cell_size_m"),
                    ("resolution_area", "resolutions", "area_m2"),
                    ("resolution_pressure", "resolutions", "pressure_Pa"),
                    ("resolution_cells", "resolutions", "cells"),
                    ("resolution_slope", "resolutions", "rms_slope"),
                    ("resolution_local_dimension", "resolutions", "local_delta_s"),
                    ("box_side", "boxes", "side_cells"), ("box_count", "boxes", "count"),
                    ("box_minimum", "boxes", "minimum"),
                    ("box_local_dimension", "boxes", "local_d_box"),
                    ("specimen_size", "size_effect", "size_m"),
                    ("specimen_strength", "size_effect", "relative_strength"),
                    ("specimen_strength_low", "size_effect", "relative_strength_low"),
                    ("specimen_strength_high", "size_effect", "relative_strength_high"),
                    ("specimen_pressure", "size_effect", "mean_pressure_Pa")):
                self.assertEqual(data[name][:].tolist(),
                                 [row[key] for row in self.done[list_name]], name)
            for name, key in (("cluster_size", "from_cells"), ("cluster_count", "number"),
                              ("cluster_cells", "cells")):
                self.assertEqual(data[name][:].tolist(),
                                 [row[key] for row in self.done["clusters"]["octaves"]])


class Options(Case):
    def test_block_means_and_sizes(self):
        done = json.loads(self.contact(J07, *SMALL, "--json", "--coarsening", "block-mean",
                                       "--sizes", "30 cm,2 m", "--coarsest", "32"))
        self.assertEqual(done["coarsening"], "block means")
        self.assertEqual([row["size_m"] for row in done["size_effect"]], [0.3, 2])
        self.assertEqual(len(done["resolutions"]), 5)
        # Block means flatten: more area at the same load. The finest is what it is.
        self.assertGreater(done["resolutions"][1]["area_fraction"], 0.115)
        self.assertAlmostEqual(done["resolutions"][-1]["area_fraction"], 0.055264, delta=1e-6)

    def test_wrong_ones_are_refused(self):
        for boxes in ("2", "2:", ":4", "2:3x", "8:2", "0:4", "2-32", "-2:8"):
            self.refuse("two sides in cells", "--boxes", boxes)
        for boxes in ("3:48", "2:48", "2:99999999999999999999"):
            self.refuse(f'--boxes: "{boxes}" must be two sides', "--boxes", boxes)
        self.refuse("three sides", "--boxes", "2:1024")
        self.refuse("sample or block-mean", "--coarsening", "mean")
        for cells in ("1", "0", "x", "64x", "-8", "99999999999"):
            self.refuse("number of cells", "--coarsest", cells)
        self.refuse("must be a length", "--sizes", "1 m,2 s")
        self.refuse("must be > 0", "--sizes", "1 m,0 m")
        self.refuse("one more than 32", "--sizes", ",".join(["1 m"] * 33))
        self.refuse("--sizes", "--sizes", "1 m,")
        done = self.call("check", os.path.join(SOURCE, J07), "--sizes", "1 m")
        self.assertEqual(done.returncode, 2)

    def test_tables_only_where_asked_for(self):
        short = self.contact(J07, *SMALL)
        for label in ("clusters", "Delta_S", "fractal pressure", "size effect", "D_box"):
            self.assertIn(label, short)
        for label in ("Published", "Bandis"):
            self.assertNotIn(label, short)
            self.assertIn(label, self.contact(J07, *SMALL, "-v"))

    def test_small_grid_says_why_it_has_none(self):
        done = json.loads(self.contact("cases/measured.yaml", "--json"))
        self.assertIsNone(done["delta_s"])
        self.assertIsNone(done["fractal_pressure"])
        self.assertIn("halve 0 times", done["delta_s_none"])
        for key in ("resolutions", "size_effect", "published_exponents"):
            self.assertEqual(done[key], [])
        self.assertGreater(done["clusters"]["number"], 0)
        self.assertIn("take 512", self.contact("cases/measured.yaml"))

    def test_weak_and_lawless_areas(self):
        self.assertTrue(self.scaling("0.5 MPa")["delta_s_weak"])
        self.assertFalse(self.scaling("10 MPa")["delta_s_weak"])
        done = self.scaling("1e-9 MPa")  # one cell at every resolution
        self.assertIsNone(done["delta_s"])
        self.assertIn("no law", done["delta_s_none"])
        self.assertEqual(done["n_cells"], 1)

    @classmethod
    def scaling(cls, pressure):
        return json.loads(cls.contact(J07, *SMALL, "--json", "--set",
                                      f"load.normal.pressure={pressure}"))

    def test_without_a_surface(self):
        done = json.loads(self.contact("cases/block.yaml", "--json"))
        self.assertEqual(done["clusters"]["number"], 1)
        self.assertEqual(done["boxes"], [])
        self.assertIsNone(done["e_star_Pa"])
        self.assertNotIn("Delta_S", self.contact("cases/block.yaml", "-v"))
        path = os.path.join(self.folder, "cascade.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write("lacuna: 1\ninterface: {size: 1 m, levels: 7, domain: {cascade: "
                       "{dimension: 1.6}}}\nload: {normal: {pressure: 1 MPa}}\n")
        done = json.loads(self.contact(path, "--json"))
        self.assertEqual(done["delta_s_none"], "no surface is pressed")
        self.assertEqual(sum(octave["cells"] for octave in done["clusters"]["octaves"]),
                         done["n_cells"])
        self.assertEqual(done["boxes"][0]["count"], done["n_cells"])


class Tools(Case):
    def test_area_scaling(self):
        done = self.call("--program", PROGRAM, *SMALL, "--loads", "0.01", "0.1",
                         program=[sys.executable, os.path.join(SOURCE, "tools/studies/area_scaling.py")])
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(len(lines), 4)
        cells = [cell.strip() for cell in lines[2].split("|")[1:-1]]
        self.assertEqual(cells[:5], ["0.01", "0.104736", "0.086121", "0.068253", "0.055264"])
        self.assertEqual(len(cells), len(lines[0].split("|")) - 2)
        done = self.call("--program", PROGRAM, "--set", "interface.levels=6",
                         program=[sys.executable, os.path.join(SOURCE, "tools/studies/area_scaling.py")])
        self.assertEqual(done.returncode, 1)
        self.assertIn("halve", done.stderr)

    def test_figure(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("matplotlib is not installed")
        picture = os.path.join(self.folder, "figure.png")
        done = self.call("--program", PROGRAM, "-o", picture, "--set", "interface.levels=7",
                         "--coarsest", "16",
                         program=[sys.executable, os.path.join(SOURCE, "tools/plot/figure1.py")])
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Delta_S", done.stdout)
        with open(picture, "rb") as file:
            self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
        self.assertGreater(os.path.getsize(picture), 50000)
        done = self.call("--program", PROGRAM, "-o", picture, "--set", "interface.levels=6",
                         program=[sys.executable, os.path.join(SOURCE, "tools/plot/figure1.py")])
        self.assertEqual(done.returncode, 1)
        self.assertIn("halve", done.stderr)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
