#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums that are vectorised, compiled for this machine's own instruction set, give the same bits as for
the least one: elastic contact, tangential histories, elastic rock.

usage: test_vector_width.py PROGRAM SOURCE_FOLDER BUILD_FOLDER LIBRARY
"""

import glob
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE, BUILD, LIBRARY = map(os.path.abspath, sys.argv[1:5])
# Each with what makes it short.
CASES = {
    "contact/joint.yaml": ("contact", "--set", "interface.levels=8"),
    "shear-cycle.yaml": ("contact",),
    "transfer/patch.yaml": ("run",),
}
SUMS = {"filter.c", "solve_descent.c", "tangential_project.c", "tangential_space.c", "vsum.c"}
OWN = ("time", "memory", "output")  # of a result: not the computation's


def call(*words, **options):
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=300,
                          stdin=subprocess.DEVNULL, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def sums(path):
    """Whether a unit has such sums, in itself or in the kernels that it includes."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    return "omp simd" in text or "filter_kernels.h" in text


class Width(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-width-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.own = cls.program("-march=native")

    @classmethod
    def program(cls, *flags):
        """The program of the build, with units that have sums compiled once more, with flags."""
        with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
            units = [entry for entry in json.load(file) if "/src/" in entry["file"]
                     and "lacuna_objects" in entry["command"] and sums(entry["file"])]
        names = {os.path.basename(unit["file"]) for unit in units}
        assert names == SUMS, names
        made = []
        for unit in units:
            words = shlex.split(unit["command"])
            made.append(os.path.join(cls.folder, os.path.basename(unit["file"]) + ".o"))
            words[words.index("-o") + 1] = made[-1]
            call(*words, *flags, cwd=unit["directory"])
        objects = [path for target in ("lacuna_program", "lacuna_cli")
                   for path in glob.glob(os.path.join(BUILD, "CMakeFiles", target + ".dir", "**", "*.o"), recursive=True)]
        flags = shlex.split(call("pkg-config", "--static", "--libs", "lacuna",
                                 env=dict(os.environ, PKG_CONFIG_PATH=BUILD)))
        path = os.path.join(cls.folder, "lacuna")
        call("cc", *objects, *made, LIBRARY, *[f for f in flags if f != "-llacuna"], "-o", path)
        return path

    def test_same_results(self):
        for case, words in CASES.items():
            results = []
            for program in (PROGRAM, self.own):
                found = json.loads(call(program, words[0], os.path.join(SOURCE, "cases", case), *words[1:],
                                        "--json", "-q", "--force", "-o", os.path.join(self.folder, "x.nc")))
                results.append({k: v for k, v in found.items() if not any(own in k for own in OWN)})
            self.assertGreater(len(results[0]), 5)
            self.assertEqual(*results, case)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
