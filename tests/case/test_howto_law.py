#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does what docs/howto-friction-law.md says, beside the sources, and builds the result: the page's
law passes the conformance kit, is described, and runs.

usage: test_howto_law.py PROGRAM SOURCE_FOLDER BUILD_FOLDER LIBRARY
"""

import glob
import json
import math
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE, BUILD, LIBRARY = map(os.path.abspath, sys.argv[1:5])


def call(*words, **options):
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=200,
                          stdin=subprocess.DEVNULL, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}\n{done.stdout}{done.stderr}")
    return done.stdout


def read(*path):
    with open(os.path.join(SOURCE, *path), encoding="utf-8") as file:
        return file.read()


class Law(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-law-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.edit()
        cls.compile("my_prz.c")
        cls.compile("registry.c")

    @classmethod
    def edit(cls):
        """The page's file, and its lines put where they belong."""
        blocks = dict(re.findall(r"^```c src/friction/(\S+)\n(.*?)^```$",
                                 read("docs", "howto-friction-law.md"), re.M | re.S))
        header = read("src", "friction", "law.h").replace(
            "    lac_friction_composite;\n", blocks["law.h"])
        registry = read("src", "friction", "registry.c").replace(
            "    &lac_friction_composite,\n", blocks["registry.c"])
        cls.changed = {"my_prz.c": blocks["my_prz.c"], "registry.c": registry, "law.h": header}
        for name, text in cls.changed.items():
            path = os.path.join(cls.folder, "friction", name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)

    @classmethod
    def compile(cls, name):
        with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
            like = next(entry for entry in json.load(file)
                        if entry["file"].endswith("/src/friction/registry.c"))
        words = shlex.split(like["command"])
        words = words[:words.index("-o")]
        call(*words, "-I", cls.folder, "-iquote", cls.folder, "-c",
             os.path.join(cls.folder, "friction", name), "-o",
             os.path.join(cls.folder, name + ".o"), cwd=like["directory"])

    def link(self, target):
        """A program of the build, with the new table before the library and so in place of its own."""
        objects = glob.glob(os.path.join(BUILD, target, "**", "*.o"), recursive=True)
        program = os.path.join(self.folder, os.path.basename(target))
        support = os.path.join(BUILD, "tests", "liblacuna_test_support.a")
        flags = shlex.split(call("pkg-config", "--static", "--libs", "lacuna", env=dict(
            os.environ, PKG_CONFIG_PATH=BUILD)))
        flags = [flag for flag in flags if flag != "-llacuna" and "liblacuna" not in flag]
        own = [os.path.join(self.folder, "my_prz.c.o"), os.path.join(self.folder, "registry.c.o")]
        call("cc", *objects, *own, support, LIBRARY, *flags, "-lcmocka", "-o", program)
        return program

    def test_conformance_kit(self):
        call(self.link("tests/CMakeFiles/conform_test_friction.dir"))

    def test_kit_sees_a_wrong_derivative(self):
        path = os.path.join(self.folder, "friction", "my_prz.c")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.addCleanup(self.replace, path, text)
        self.replace(path, text.replace("-2 * renewal", "-renewal"))
        program = self.link("tests/CMakeFiles/conform_test_friction.dir")
        self.assertNotEqual(subprocess.run([program], capture_output=True, check=False).returncode, 0)

    def replace(self, path, text):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        self.compile("my_prz.c")

    def test_the_program_knows_it(self):
        program = self.link("CMakeFiles/lacuna_program.dir")
        self.assertIn("lac_friction_prz", self.changed["law.h"])
        self.assertIn("renewed with the square of slip", call(program, "describe", "friction", "prz"))
        law = "friction={prz: {f0: 0.6, a: 0.010, b: 0.015, dc: 2 cm, v0: 1 um/s}}"
        case = os.path.join(self.folder, "block.yaml")
        call(program, "new", case, "--kind", "block")
        done = json.loads(call(program, "run", case, "--set", law, "--set",
                               "initial={slip_rate: 1 um/s, state: steady}", "--set",
                               "time.end=1 s", "--json", cwd=self.folder))
        self.assertEqual(done["status"], "complete")
        # Steady at v0: f = f0 + b ln 2, as theta = 2 dc/v0.
        described = call("ncdump", "-v", "apparent_friction", os.path.join(
            self.folder, done["output"]))
        friction = float(re.search(r"apparent_friction = ([\d.]+)", described).group(1))
        self.assertAlmostEqual(friction, 0.6 + 0.015 * math.log(2), 6)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
