#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lacuna built otherwise than by its presets: with one library alone, with a library in a prefix of
its own, without libmicrohttpd, as a part of another project. Each serves a small program.

usage: test_build.py PROGRAM SOURCE_FOLDER
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
BLOCK = os.path.join(SOURCE, "cases", "block.yaml")
EXAMPLE = os.path.join(SOURCE, "docs", "embed")
# Compiled in a hurry: what is looked at is how the parts fit.
QUICK = ("-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS=-O0 -g0 -w")


def call(*words, **options):
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=500,
                          stdin=subprocess.DEVNULL, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


class Build(unittest.TestCase):
    def setUp(self):
        self.folder = os.path.realpath(tempfile.mkdtemp(prefix="lacuna-build-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def at(self, *names):
        return os.path.join(self.folder, *names)

    def serves(self, program, **environment):
        printed = call(program, BLOCK, env={**os.environ, **environment})
        self.assertRegex(printed, r"fails after 15\.278\d day")

    def consumer(self, name, prefix):
        """docs/embed, which finds the package in a prefix; what the dynamic linker reads of it."""
        call("cmake", *QUICK, "-S", EXAMPLE, "-B", self.at(name), f"-DCMAKE_PREFIX_PATH={prefix}")
        call("cmake", "--build", self.at(name))
        self.serves(self.at(name, "creep"))
        return call("readelf", "-d", self.at(name, "creep"))

    def private_yaml(self):
        """libyaml in a prefix of its own, as somebody without root would have it."""
        prefix = self.at("private")
        os.makedirs(os.path.join(prefix, "lib", "pkgconfig"))
        flags = shlex.split(call("pkg-config", "--variable=libdir", "yaml-0.1"))
        library = os.path.realpath(os.path.join(flags[0], "libyaml.so"))
        for name in ("libyaml.so", "libyaml-0.so.2"):
            shutil.copy(library, os.path.join(prefix, "lib", name))
        with open(os.path.join(prefix, "lib", "pkgconfig", "yaml-0.1.pc"), "w", encoding="utf-8") as file:
            file.write(f"libdir={prefix}/lib\nName: yaml\nDescription: private\nVersion: 0.2.5\n"
                       "Libs: -L${libdir} -lyaml\n")
        return prefix

    def test_one_library_alone(self):
        private, tree = self.private_yaml(), self.at("tree")

        def build(kind, prefix, *options):
            call("cmake", *QUICK, "-S", SOURCE, "-B", tree, "-DLACUNA_TESTS=OFF",
                 f"-DCMAKE_PREFIX_PATH={private}", *options)
            call("cmake", "--build", tree)
            call("cmake", "--install", tree, "--prefix", prefix)
            self.assertEqual({name.split(".")[1] for name in os.listdir(os.path.join(prefix, "lib"))
                              if name.startswith("liblacuna")}, {kind})

        still, moving = self.at("still"), self.at("moving")
        build("a", still, "-DLACUNA_SHARED=OFF", "-DLACUNA_VIEW=OFF")
        self.assertNotIn("liblacuna", self.consumer("static", still))
        flags = shlex.split(call("pkg-config", "--cflags", "--libs", "lacuna", env={
            **os.environ, "PKG_CONFIG_PATH": os.path.join(still, "lib", "pkgconfig")}))
        self.assertIn(f"-L{private}/lib", flags)
        call("cc", os.path.join(EXAMPLE, "creep.c"), *flags, "-o", self.at("creep"))
        self.serves(self.at("creep"), LD_LIBRARY_PATH=os.path.join(private, "lib"))
        self.without_microhttpd(os.path.join(still, "bin", "lacuna"))
        self.runpath(os.path.join(still, "bin", "lacuna"), private)

        build("so", moving, "-DLACUNA_SHARED=ON", "-DLACUNA_STATIC=OFF", "-DLACUNA_PROGRAM=OFF")
        self.assertIn("liblacuna.so", self.consumer("shared", moving))
        self.runpath(os.path.join(moving, "lib", "liblacuna.so"), private)

    def runpath(self, binary, private):
        """It names the private prefix, so that libyaml is found there, and no folder of the system."""
        found, = re.findall(r"RUNPATH.*\[(.*)\]", call("readelf", "-d", binary))
        self.assertIn(f"{private}/lib", found.split(":"))
        self.assertFalse([f for f in found.split(":") if f in ("/lib", "/usr/lib", "/usr/local/lib")])
        self.assertIn(f"{private}/lib/libyaml", call("ldd", binary))

    def without_microhttpd(self, program):
        done = subprocess.run([program, "run", BLOCK, "--view", "-o", self.at("x.nc")], check=False,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 3)
        self.assertEqual(done.stderr, "lacuna: --view: this lacuna was built without libmicrohttpd's "
                                      "headers\n")
        self.assertFalse(os.path.exists(self.at("x.nc")))

    def test_part_of_another_project(self):
        """By add_subdirectory, which is what FetchContent does with the sources that it got."""
        os.makedirs(self.at("other"))
        shutil.copy(os.path.join(EXAMPLE, "creep.c"), self.at("other"))
        with open(self.at("other", "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write("cmake_minimum_required(VERSION 3.25)\nproject(other C)\n"
                       f"add_subdirectory({SOURCE} lacuna)\nadd_executable(creep creep.c)\n"
                       "target_link_libraries(creep PRIVATE lacuna::lacuna)\n"
                       "install(TARGETS creep)\n")
        call("cmake", *QUICK, "-S", self.at("other"), "-B", self.at("tree"))
        call("cmake", "--build", self.at("tree"))
        self.serves(self.at("tree", "creep"))
        call("cmake", "--install", self.at("tree"), "--prefix", self.at("there"))
        self.assertEqual(os.listdir(self.at("there")), ["bin"])  # only what is the other's
        self.assertEqual(os.listdir(self.at("there", "bin")), ["creep"])
        self.assertFalse(os.path.exists(self.at("tree", "lacuna", "lacuna")))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
