#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory that is short for one allocation of a command, as it is shipped: libraries opened on demand.

usage: test_every_allocation.py PROGRAM SOURCE_FOLDER FAIL_AT [unittest options]
       test_every_allocation.py PROGRAM SOURCE_FOLDER FAIL_AT --draws N

FAIL_AT is the library of tests/memory. The command ends with one line and exit status 1, or it did without.
unit.test_memory has each allocation of the library fail in turn; here are some of each command's, or N of each.
"""

import collections
import os
import random
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE, LIBRARY = map(os.path.abspath, sys.argv[1:4])
EACH = int(sys.argv.pop(5)) if sys.argv[4:5] == ["--draws"] else 8
CREEP = ["data/creep.csv", "--displacement", "disp_mm:mm"]
COMMANDS = {
    "a block": ["run", "block.yaml", "-o", "out.nc"],
    "inertia": ["run", "momentum/slope.yaml", "--set", "interface.levels=5", "--until", "1 s", "-o", "out.nc"],
    "events": ["run", "transfer/hierarchy.yaml", "--set", "solver.fidelity=events", "--until", "1 second", "-o", "out.nc"],
    "lumped": ["run", "solver/lumped.yaml", "-o", "out.nc"],
    "elastic rock": ["run", "transfer/elastic.yaml", "--set", "interface.levels=4", "--until", "1 second", "-o", "out.nc"],
    "contact": ["contact", "contact/self-affine.yaml", "--set", "interface.levels=5", "-o", "out.nc"],
    "rg": ["rg", "rg/fix.yaml", "-o", "out.nc"],
    "check": ["check", "vajont.yaml"],
    "precursors": ["precursors", *CREEP],
    "report": ["report", "{made}", "-o", "out.html"],
    "export": ["export", "{made}", "-o", "tables"],
    "describe": ["describe", "water"],
    "sweep": ["sweep", "block.yaml", "--over", "friction.aging.dc=1 mm, 2 mm", "--jobs", "1", "-o", "out.nc"],
}


class EveryAllocation(unittest.TestCase):
    def end(self, words, at):
        """Exit status and lines on stderr, in a folder of its own."""
        with tempfile.TemporaryDirectory() as folder:
            words = [os.path.join(SOURCE, "cases", w) if w.endswith((".yaml", ".csv")) else w.format(made=self.made) for w in words]
            done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, check=False, timeout=120,
                                  env=dict(os.environ, LD_PRELOAD=LIBRARY, FAIL_AT=str(at)))
            return done.returncode, [line for line in done.stderr.splitlines() if line.startswith("lacuna: ")]

    def test_one_line_or_done_without(self):
        draw = random.Random(EACH)
        with tempfile.TemporaryDirectory() as folder:
            self.made = os.path.join(folder, "made.nc")
            subprocess.run([PROGRAM, "run", "cases/block.yaml", "-o", self.made, "-q"], cwd=SOURCE, check=True, stdout=subprocess.DEVNULL)
            ends = collections.Counter()
            for name, words in COMMANDS.items():
                self.assertEqual(self.end(words, 10**9), (0, []), name)
                for at in sorted({int(10 ** draw.uniform(0, 4)) for _ in range(EACH)}):
                    with self.subTest(name, at=at):
                        status, lines = self.end(words, at)
                        self.assertIn(status, (0, 1), lines)
                        if status == 1:
                            self.assertEqual(len(lines), 1, lines)
                            self.assertIn("memory", lines[0])
                        ends[status] += 1
            self.assertGreater(ends[1], ends[0] / 10)
            print(f"{ends[1]} ended with a line, {ends[0]} did without")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[5 if EACH != 8 else 4:])
