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


# A state that saturates, dtheta/dt = 1 - theta/theta_max - v theta/dc, by the steps of the page: its
# steady state levels off at theta_max.
SATURATING = r'''// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/vmath.h"
#include "friction/law.h"

typedef struct saturating_params {
    lac_friction_params common;
    double theta_max;
} saturating_params;

static void evolve(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                   double *g_u, double *g_w)
{
    const double *inv_dc = lac_cellwise_from(&friction->inv_dc, cells->first);
    const double *most = lac_cellwise_from(&friction->column[LAC_COMMON_COLUMNS], cells->first);
    lac_vexp_minus(cells->n, cells->w, g);
    for (size_t i = 0; i < cells->n; i++) {
        double healing = g[i];
        double renewal = cells->v[i] * inv_dc[i];
        g[i] = healing - 1 / most[i] - renewal;
        if (g_u != NULL) {
            g_u[i] = -renewal;
            g_w[i] = -healing;
        }
    }
}

static double steady_state(const lac_friction *friction, size_t cell, double u)
{
    double renewal = exp(u) * lac_cellwise_of(&friction->inv_dc, cell);
    return -log(1 / lac_cellwise_of(&friction->column[LAC_COMMON_COLUMNS], cell) + renewal);
}

static const lac_param params[] = {
    LAC_FRICTION_COMMON_ROWS,
    LAC_REAL("theta_max", "s", offsetof(saturating_params, theta_max), NAN, 1, 1e12, LAC_CELLWISE,
             "state at which contacts no longer heal"),
};

const lac_friction_law lac_friction_saturating = {
    .info = {.name = "saturating",
              .summary = "heals up to theta_max: dtheta/dt = 1 - theta/theta_max - v theta/dc",
              .reference = "a law of this test",
              LAC_ROWS(params, saturating_params),
              .validate = lac_law_validate},
    .evolve = evolve,
    .steady_state = steady_state,
};
'''

LAWS = ["my_prz.c", "my_saturating.c"]


class Law(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-law-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.edit()
        for name in [*LAWS, "registry.c"]:
            cls.compile(name)

    @classmethod
    def edit(cls):
        """The page's file, and its lines put where they belong."""
        blocks = dict(re.findall(r"^```c src/friction/(\S+)\n(.*?)^```$",
                                 read("docs", "howto-friction-law.md"), re.M | re.S))
        head, last = re.fullmatch(r"(.*\n)(    _\(lac_friction_\w+\)\n.*)", read("src", "friction", "law.h"), re.S).groups()
        header = head + blocks["law.h"] + blocks["law.h"].replace("prz", "saturating") + last
        cls.changed = {"my_prz.c": blocks["my_prz.c"], "my_saturating.c": SATURATING, "law.h": header,
                       "registry.c": read("src", "friction", "registry.c")}
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

    def link(self, *targets):
        """A program of the build, with the new table before the library and so in place of its own."""
        objects = [path for target in targets for path in glob.glob(os.path.join(BUILD, target, "**", "*.o"), recursive=True)]
        program = os.path.join(self.folder, os.path.basename(targets[0]))
        support = os.path.join(BUILD, "tests", "liblacuna_test_support.a")
        flags = shlex.split(call("pkg-config", "--static", "--libs", "lacuna", env=dict(
            os.environ, PKG_CONFIG_PATH=BUILD)))
        flags = [flag for flag in flags if flag != "-llacuna" and "liblacuna" not in flag]
        own = [os.path.join(self.folder, name + ".o") for name in [*LAWS, "registry.c"]]
        call("cc", *objects, *own, support, LIBRARY, *flags, "-lcmocka", "-o", program)
        return program

    def test_conformance_kit(self):
        call(self.link("tests/CMakeFiles/conform_test_friction.dir"))

    def test_kit_says_what_is_wrong(self):
        """A derivative, a steady state, a rate of evolution: the law, its values and where it was."""
        for name, right, wrong, said in [
                ("my_prz.c", "-2 * renewal", "-renewal", "g_u = "),
                ("my_prz.c", "log(2) +", "log(3) +", "the state changes in its steady state"),
                ("my_saturating.c", "-log(1 / lac", "-log(2 / lac", "the state changes in its steady state"),
                ("my_saturating.c", "double healing = g[i];", "double healing = g[i] + 1e300 / g[0] * 1e300;",
                 "not finite")]:
            with self.subTest(wrong):
                text = self.changed[name]
                self.assertEqual(text.count(right), 1)
                self.addCleanup(self.replace, name, text)
                self.replace(name, text.replace(right, wrong))
                program = self.link("tests/CMakeFiles/conform_test_friction.dir")
                done = subprocess.run([program], capture_output=True, text=True, check=False)
                self.assertNotEqual(done.returncode, 0)
                law = re.match(r"my_(\w+)\.c", name).group(1)
                self.assertRegex(done.stderr, rf"law {law}, form plain: .*{said}.* at v \S+ m/s, "
                                              r"theta \S+ s; f0 \S+ a \S+ b \S+ dc ")
                self.replace(name, text)

    def replace(self, name, text):
        with open(os.path.join(self.folder, "friction", name), "w", encoding="utf-8") as file:
            file.write(text)
        self.compile(name)

    def test_warns_of_a_ratio_without_effect(self):
        """Where b = a the state is that of any ratio under prz, 2 dc/v; not under a law that saturates."""
        program = self.link("CMakeFiles/lacuna_program.dir", "CMakeFiles/lacuna_cli.dir")
        case = os.path.join(self.folder, "ratio.yaml")
        call(program, "new", case, "--kind", "block")
        for law, idle in [("prz", True), ("saturating", False)]:
            own = ", theta_max: 1 day" if law == "saturating" else ""
            words = [case, "--set", f"friction={{{law}: {{f0: 0.6, a: 0.01, b: 0.01, dc: 1 mm{own}}}}}",
                     "--set", "output.fields=[state]", "--set", "time.end=1 s", "--set"]
            states = []
            for ratio in (0.5, 0.9):
                start = f"initial={{slip_rate: 1 mm/week, state: {{ratio_to_steady: {ratio}}}}}"
                done = subprocess.run([program, "check", *words, start], capture_output=True, text=True,
                                      check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual("has no effect where b = a: theta is 2 week" in done.stderr, idle, done.stderr)
                self.assertEqual("has no effect" in done.stderr, idle, done.stderr)
                call(program, "run", *words, start, "--force", "-o", os.path.join(self.folder, "ratio.nc"))
                seen = call("ncdump", "-v", "cell_state", os.path.join(self.folder, "ratio.nc"))
                states.append(float(re.search(r"cell_state =\s+([\d.]+)", seen).group(1)))
            self.assertEqual(abs(states[0] / states[1] - 1) < 1e-9, idle, states)

    def test_the_program_knows_it(self):
        program = self.link("CMakeFiles/lacuna_program.dir", "CMakeFiles/lacuna_cli.dir")
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
