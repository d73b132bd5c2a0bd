#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna export`: every number of its tables against netCDF4, bit for bit, and what it refuses.

usage: test_export.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import csv
import datetime
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

import report_scenes as scenes

PROGRAM, SOURCE, FOLDER = "", "", ""


def export(*words, status=0):
    done = subprocess.run([PROGRAM, "export", *words], capture_output=True, text=True, check=False, cwd=FOLDER,
                          stdin=subprocess.DEVNULL)
    if done.returncode != status:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stderr}")
    return done.stdout if status == 0 else done.stderr


def table_of(text):
    rows = list(csv.reader(text.splitlines(keepends=True), strict=True))
    return {name: [row[k] for row in rows[1:]] for k, name in enumerate(rows[0])}


def headed(table, name):
    """The column of a variable: its header is its name and, in brackets, its unit."""
    found = [head for head in table if head == name or head.startswith(name + " [")]
    return table[found[0]] if len(found) == 1 else None


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        run = os.path.join(FOLDER, "joint.nc")
        scenes.run(PROGRAM, scenes.JOINT.replace("steps: 2}", "steps: 200}").replace("{per_decade: 2}", "{steps: 8000}"), run)
        series = os.path.join(SOURCE, "cases", "data", "creep.csv")
        subprocess.run([PROGRAM, "precursors", series, "--displacement", "disp_mm:mm", "--rolling", "--issues", "12",
                        "--failed-at", "2020-08-12", "-o", os.path.join(FOLDER, "series.nc")], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        scenes.run(PROGRAM, scenes.BLOCK, os.path.join(FOLDER, "block.nc"))
        contact = os.path.join(SOURCE, "cases", "surface", "joint.yaml")
        subprocess.run([PROGRAM, "contact", contact, "-o", os.path.join(FOLDER, "contact.nc")], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def check(self, cells, values, name):
        """Cells are empty where a value is missing, else the same to the last bit, also told anew by 17 digits."""
        own = numpy.ma.filled(values.astype(float), math.nan).ravel()
        read = numpy.array([float(cell) if cell else math.nan for cell in cells])
        self.assertEqual(read.tobytes(), own.tobytes(), name)
        self.assertTrue(all(float("%.17g" % x) == x for x in read[::97] if not math.isnan(x)), name)

    def check_file(self, name):
        """Every variable that is no field stands in the table of its dimensions, once, bit for bit."""
        folder = name[:-3] + "-tables"
        export(name)
        seen = 0
        with netCDF4.Dataset(os.path.join(FOLDER, name)) as file:
            file.set_auto_chartostring(False)
            for key, variable in file.variables.items():
                dims = [d for d in variable.dimensions if not (variable.dtype == "S1" and d == variable.dimensions[-1])]
                path = os.path.join(FOLDER, folder, ("-".join(dims) or "values") + ".csv")
                if {"y", "x"} <= set(dims) or ("cell" in dims and len(dims) > 1):
                    self.assertFalse(os.path.exists(path), path)
                    continue
                with open(path, encoding="utf-8", newline="") as text:
                    cells = headed(table_of(text.read()), key)
                self.assertIsNotNone(cells, f"{key} in {path}")
                seen += 1
                if variable.dtype == "S1":
                    rows = [b"".join(row).decode().rstrip("\0") for row in
                            numpy.ma.filled(variable[:], b"\0").reshape(-1, variable.shape[-1])]
                    self.assertEqual(cells, rows)
                else:
                    self.check(cells, variable[:], key)
            with open(os.path.join(FOLDER, folder, "attributes.csv"), encoding="utf-8", newline="") as text:
                attributes = table_of(text.read())
            self.assertEqual(attributes["attribute"], file.ncattrs())
            for key, value in zip(attributes["attribute"], attributes["value"]):
                own = file.getncattr(key)
                self.assertTrue(value == own if isinstance(own, str) else float(value) == own, key)
        return seen

    def test_run(self):
        self.assertGreater(self.check_file("joint.nc"), 25)

    def test_dated_run(self):
        self.check_file("block.nc")
        with open(os.path.join(FOLDER, "block-tables", "time.csv"), encoding="utf-8") as text:
            table = table_of(text.read())
        start = datetime.datetime(2020, 1, 1)
        for time, date in zip(headed(table, "time"), table["time (date UTC)"]):
            told = datetime.datetime.strptime(date, "%Y-%m-%dT%H:%M:%SZ")
            self.assertLessEqual(abs((told - start).total_seconds() - float(time)), 0.51)

    def test_contact(self):
        self.check_file("contact.nc")

    def test_forecasts(self):
        self.check_file("series.nc")
        with open(os.path.join(FOLDER, "series-tables", "issue-method.csv"), encoding="utf-8", newline="") as text:
            table = table_of(text.read())
        with netCDF4.Dataset(os.path.join(FOLDER, "series.nc")) as file:
            methods = file["method"].flag_meanings.split()
            issues = file["issue_time"][:]
            self.assertEqual(table["method (meaning)"], methods * len(issues))
            self.check(headed(table, "issue_time"), numpy.repeat(issues, len(methods)), "issue_time")

    def test_one_table_goes_to_stdout(self):
        table = table_of(export("joint.nc", "--csv", "--variable", "slip", "--variable", "slip_rate"))
        self.assertEqual(list(table), ["time [s]", "slip [m]", "slip_rate [m s-1]"])
        with netCDF4.Dataset(os.path.join(FOLDER, "joint.nc")) as file:
            self.check(table["slip [m]"], file["slip"][:], "slip")
            self.check(table["time [s]"], file["time"][:], "time")
        export("joint.nc", "--variable", "slip", "--variable", "slip_rate", "-o", "one.csv")
        with open(os.path.join(FOLDER, "one.csv"), encoding="utf-8") as text:
            self.assertEqual(table_of(text.read()), table)

    def test_a_field_that_is_named(self):
        told = json.loads(export("joint.nc", "--json", "-o", "fields/"))
        self.assertIn("cell_slip", told["left_out"])
        self.assertIn("left out", export("joint.nc", "-o", "fields/", "--force"))
        table = table_of(export("joint.nc", "--variable", "cell_slip"))
        with netCDF4.Dataset(os.path.join(FOLDER, "joint.nc")) as file:
            shape = file["cell_slip"].shape
            self.check(headed(table, "cell_slip"), file["cell_slip"][:], "cell_slip")
            self.check(headed(table, "snapshot_time"), numpy.repeat(file["snapshot_time"][:], shape[1]), "snapshot_time")
            for key in ("x", "y"):
                self.check(headed(table, key), numpy.tile(file[key][:], shape[0]), key)

    def test_refused(self):
        text = os.path.join(FOLDER, "text.nc")
        with open(text, "w", encoding="utf-8") as file:
            file.write("no netCDF\n")
        other = os.path.join(FOLDER, "other.nc")
        with netCDF4.Dataset(other, "w") as file:
            file.createDimension("time", 2)
            file.createVariable("slip", "f8", ("time",))[:] = [1, 2]
        classic = os.path.join(FOLDER, "classic.nc")
        with netCDF4.Dataset(classic, "w", format="NETCDF3_CLASSIC") as file:
            file.lacuna_format_version = "1"  # which no file has: netCDF takes the memory that such a header asks for
        broken = os.path.join(FOLDER, "broken.nc")
        with open(os.path.join(FOLDER, "joint.nc"), "rb") as whole, open(broken, "wb") as file:
            bytes_ = bytearray(whole.read())
            bytes_[len(bytes_) // 2] ^= 1
            file.write(bytes_)
        for words, status, said in ((["text.nc"], 3, "text.nc: is not a netCDF file"),
                                    (["other.nc"], 3, "other.nc: is not a file of Lacuna"),
                                    (["classic.nc"], 3, "classic.nc: is not a file of Lacuna"),
                                    (["broken.nc"], 3, "broken.nc: is damaged"),
                                    (["none.nc"], 3, "none.nc: "),
                                    (["joint.nc", "--variable", "slop"], 2, '"slop"'),
                                    (["joint.nc", "-o", "many.csv"], 2, "name a folder"),
                                    (["joint.nc", "--variable", "slip", "--json"], 2, "-o"),
                                    (["joint.nc", "--variable", "slip", "-o", "text.nc"], 2, "--force")):
            wrong = export(*words, status=status)
            self.assertEqual(wrong.count("\n"), 1, wrong)
            self.assertIn(said, wrong)


    def test_its_own_input_is_kept(self):
        """--force replaces tables, not the file that they are made of, by whatever name it is called."""
        with open(os.path.join(FOLDER, "series.nc"), "rb") as file:
            before = file.read()
        for link in ("series-link.csv", "series-hard.csv"):
            (os.symlink if "link" in link else os.link)(os.path.join(FOLDER, "series.nc"), os.path.join(FOLDER, link))
        for output in ("series.nc", "./series.nc", "series-link.csv", "series-hard.csv"):
            error = export("series.nc", "--variable", "alarm_level", "-o", output, "--force", status=2)
            self.assertEqual(error, f"lacuna: {output}: is read by this command, must not be the output\n")
        with open(os.path.join(FOLDER, "series.nc"), "rb") as file:
            self.assertEqual(file.read(), before)


def main():
    global PROGRAM, SOURCE, FOLDER
    PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
    FOLDER = tempfile.mkdtemp(prefix="lacuna-export-")
    try:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
    finally:
        shutil.rmtree(FOLDER, ignore_errors=True)


if __name__ == "__main__":
    main()
