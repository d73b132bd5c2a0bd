#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the program opens when it starts: netCDF and SUNDIALS only where a command uses them, and one line
where they cannot be opened.

usage: test_start.py PROGRAM SOURCE_FOLDER
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
BLOCK = os.path.join(SOURCE, "cases", "block.yaml")
READINGS = os.path.join(SOURCE, "cases", "data", "century_prism_31-2008.csv")


def linked():
    """Whether the program links them, as one with sanitizers does."""
    return "libnetcdf" in subprocess.run(["readelf", "-d", PROGRAM], capture_output=True, text=True, check=True).stdout


@unittest.skipIf(linked(), "this build links netCDF and SUNDIALS (LACUNA_LAZY=OFF)")
class Start(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-start-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def run_program(self, *words, **environment):
        return subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False, cwd=self.folder,
                              stdin=subprocess.DEVNULL, env={**os.environ, **environment})

    def opened(self, *words):
        """Which of the two the dynamic linker opens, as it tells itself."""
        done = self.run_program(*words, LD_DEBUG="files")
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])
        self.assertIn("libyaml", done.stderr)
        return {name for name in ("netcdf", "sundials") if f"file=lib{name}" in done.stderr}

    def test_only_what_a_command_uses(self):
        for words in (["--version"], ["check", BLOCK], ["describe", "friction", "aging"], ["new", "my-slope"],
                      ["precursors", READINGS, "--displacement", "displacement_mm:mm", "--until", "2013-12-01"]):
            with self.subTest(words[0]):
                self.assertEqual(self.opened(*words), set())
        self.assertEqual(self.opened("run", BLOCK, "-o", "block.nc"), {"netcdf", "sundials"})
        self.assertEqual(self.opened("export", "block.nc", "--csv"), {"netcdf"})

    def test_one_that_cannot_be_opened_is_one_line(self):
        soname = next(word.split("/")[-1] for word in self.run_program(
            "run", BLOCK, "-o", "block.nc", LD_DEBUG="files").stderr.split() if "/libnetcdf.so" in word)
        with open(os.path.join(self.folder, soname), "w", encoding="utf-8") as file:
            file.write("no library")
        done = self.run_program("run", BLOCK, "-o", "other.nc", LD_LIBRARY_PATH=self.folder)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertRegex(done.stderr, f"^lacuna: .*cannot open {soname}: ")
        self.assertNotIn("other.nc", os.listdir(self.folder))
        self.assertEqual(self.run_program("check", BLOCK, LD_LIBRARY_PATH=self.folder).returncode, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
