#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The library's results in one call each are those of the program: contact, rg, precursors, fit, as JSON
and as files.

usage: test_door.py PROGRAM SOURCE_FOLDER LIBRARY
"""

import ctypes
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy
import xarray

PROGRAM, SOURCE, LIBRARY = map(os.path.abspath, sys.argv[1:4])
CONTACT, RG, FIT = 1, 2, 3  # lac_case_purpose


class Error(ctypes.Structure):
    _fields_ = [("message", ctypes.c_char * 1024)]


class Override(ctypes.Structure):
    _fields_ = [("key", ctypes.c_char_p), ("value", ctypes.c_char_p)]


class CaseOptions(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("purpose", ctypes.c_int),
                ("overrides", ctypes.POINTER(Override)), ("count", ctypes.c_size_t)]


class SeriesDef(ctypes.Structure):
    _fields_ = [("size", ctypes.c_size_t), ("path", ctypes.c_char_p), ("time", ctypes.c_char_p),
                ("time_format", ctypes.c_char_p), ("displacement", ctypes.c_char_p),
                ("displacement_unit", ctypes.c_char_p)]


class Door(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-door-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.library = ctypes.CDLL(LIBRARY)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(SOURCE)

    def call(self, name, *given, status=0):
        """A function that hands out an object and has a place for a message."""
        out, error = ctypes.c_void_p(), Error()
        self.assertEqual(getattr(self.library, "lac_" + name)(*given, ctypes.byref(out), ctypes.byref(error)),
                         status, error.message)
        return out

    def read(self, path, purpose, **sets):
        pairs = [(key.encode(), value.encode()) for key, value in sets.items()]
        how = CaseOptions(ctypes.sizeof(CaseOptions), purpose, (Override * len(pairs))(*pairs), len(pairs))
        return self.call("case_load", path.encode(), ctypes.byref(how))

    def compare(self, dataset, *words, status=0, json_is_all=True):
        """With what the program says, and writes, of the same."""
        theirs, mine = (os.path.join(self.folder, name) for name in ("theirs.nc", "mine.nc"))
        done = subprocess.run([PROGRAM, *words, "-o", theirs, "--json"], check=False, capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, status, done.stderr)
        error, text = Error(), ctypes.c_char_p()
        self.assertEqual(self.library.lac_dataset_write(dataset, mine.encode(), None, ctypes.byref(error)), 0,
                         error.message)
        with xarray.open_dataset(theirs, decode_times=False) as wanted, \
                xarray.open_dataset(mine, decode_times=False) as got:
            self.assertEqual(set(got.variables), set(wanted.variables))
            for name in wanted.variables:
                self.assertTrue(got[name].identical(wanted[name]), name)
            own = {"history", "libraries", "date_created", "source_file", "title"}
            numpy.testing.assert_equal({k: v for k, v in got.attrs.items() if k not in own},
                                       {k: v for k, v in wanted.attrs.items() if k not in own})
        if json_is_all:
            self.assertEqual(self.library.lac_dataset_to_json(dataset, ctypes.byref(text), None), 0)
            said = json.loads(text.value)
            self.assertEqual({k: v for k, v in json.loads(done.stdout).items() if k in said}, said)
            self.assertGreater(len(said), 5)
        self.library.lac_dataset_free(dataset)

    def test_contact(self):
        case = "cases/contact/self-affine.yaml"
        c = self.read(case, CONTACT, **{"interface.levels": "6"})
        self.compare(self.call("contact_compute", c, None), "contact", case, "--set", "interface.levels=6")

    def test_rg(self):
        c = self.read("cases/rg/cons.yaml", RG)
        self.compare(self.call("rg_compute", c, None), "rg", "cases/rg/cons.yaml")

    def test_forecast(self):
        series = SeriesDef(ctypes.sizeof(SeriesDef), b"cases/data/creep.csv", None, None, b"disp_mm", b"mm")
        read = self.call("series_create", ctypes.byref(series))
        self.compare(self.call("forecast_compute", read, None), "precursors", "cases/data/creep.csv",
                     "--displacement", "disp_mm:mm", json_is_all=False)

    def test_fit(self):
        sets = {"fit.steps": "0", "fit.starts": "8"}
        c = self.read("cases/fit/block.yaml", FIT, **sets)
        series = self.call("fit_series", c, b"cases/data/creep.csv")
        words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        self.compare(self.call("fit_compute", c, series, None), "fit", "cases/fit/block.yaml",
                     "cases/data/creep.csv", *words)

    def test_fit_that_has_not_converged(self):
        """Says so, and hands out what there is."""
        c = self.read("cases/fit/block.yaml", FIT, **{
            "fit.starts": "8", "fit.burn": "20", "fit.steps": "30", "fit.walkers": "16", "fit.rounds": "0"})
        series = self.call("fit_series", c, b"cases/data/creep.csv")
        dataset = self.call("fit_compute", c, series, None, status=4)
        self.assertTrue(dataset)
        self.library.lac_dataset_free(dataset)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
