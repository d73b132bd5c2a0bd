#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The interfaces of a cascade in processes: the same to the bit however many these are, and whatever stops them.

usage: test_rg_parts.py PROGRAM SOURCE_FOLDER LIBRARY_THAT_STOPS [unittest options]
"""

import os
import signal
import subprocess
import sys
import tempfile
import unittest

import netCDF4

PROGRAM, SOURCE, STOP = "", "", ""
CASE = ["cases/rg/rough-joint.yaml", "--set", "interface.levels=6", "--set", "rg.shifts=3", "--set", "rg.loads=20"]
FRICTION = ["--set", "friction={slip: {f0: 0.6, a: 0.01, b: 0.02, dc: 10 um, v0: 1 um/s}}", "--set", "rg.beta=from-friction",
            "--set", "material.density=2700 kg/m3", "--set", "rg.field=equal"]


def content(file):
    """All that a dataset holds but when and how it was made, to the bit."""
    file.set_auto_mask(False)
    own = ("history", "date_created")
    return ({name: v[:].tolist() if v.dtype == str else v[:].tobytes() for name, v in file.variables.items()},
            {name: str(file.getncattr(name)) for name in file.ncattrs() if name not in own})


class Parts(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.out = os.path.join(place.name, "out.nc")
        self.done = os.path.join(self.out + ".runs", "done")

    def rg(self, *words, seeds=5, status=0, at=None, log=""):
        stop = {} if at is None else {
            "LD_PRELOAD": STOP, "AT_CALL": at + ":write:.runs/done", "AT_CALL_LOG": log,
            "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0"}
        done = subprocess.run([PROGRAM, "rg", *CASE, "--set", f"rg.seeds={seeds}", "-q", "-o", self.out, *words],
                              cwd=SOURCE, capture_output=True, text=True, check=False, env={**os.environ, **stop})
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stderr

    def content(self, *words, **named):
        self.rg(*words, "--force", **named)
        self.assertFalse(os.path.exists(self.out + ".runs"))
        with netCDF4.Dataset(self.out) as file:
            return content(file)

    def test_jobs(self):
        """Any number of processes, and of threads in each: one result, of several betas and from the friction law."""
        for words in (["--set", "rg.beta=[0.7, 0.4]"], FRICTION):
            one = self.content(*words, "--jobs", "1")
            for more in (["--jobs", "2"], ["--jobs", "3", "--threads", "2"]):
                self.assertEqual(self.content(*words, *more), one, more)
            for name in "interface_seed", "d_blocks":  # no interface stands for another
                self.assertEqual(len({one[0][name][i:i + 8] for i in range(0, 40, 8)}), 5)

    def test_killed(self):
        """Killed, torn or interrupted while it keeps an interface, it makes only the rest."""
        whole = self.content()
        os.remove(self.out)
        for at, what, status, left in ((2, "kill", -9, 4), (5, "tear", -9, 3), (8, "kill", -9, 1),
                                       (4, f"signal={int(signal.SIGINT)}", 4, 2), (4, f"signal={int(signal.SIGTERM)}", 4, 2)):
            with self.subTest(at=at, what=what):
                said, log = self.rg("--jobs", "2", status=status, at=f"{at}:{what}"), self.out + ".log"
                self.assertFalse(os.path.exists(self.out))
                self.assertEqual("--resume goes on" in said, status == 4)
                self.assertEqual(self.content("--resume", at="0:kill", log=log), whole)
                with open(log, encoding="utf-8") as calls:  # a record and its sum for each that was not kept
                    self.assertEqual(sum(line.endswith(".runs/done\n") for line in calls), 2 * left)
                os.remove(self.out)
                os.remove(log)

    def test_refused(self):
        """What has nothing kept, or something else, or is at work, is said."""
        self.assertIn("of one interface nothing is kept", self.rg("--resume", seeds=1, status=2))
        self.assertIn("No such file", self.rg("--resume", status=3))
        self.assertIn("--jobs: \"0\" must be", self.rg("--jobs", "0", status=2))
        self.rg("--jobs", "1", status=-9, at="6:kill")
        self.assertIn("is of another case", self.rg("--resume", "--set", "rg.beta=0.5", status=2))
        with open(self.done, "rb") as kept:
            self.assertGreater(len(kept.read()), 1000)
        self.content()

    def test_broken(self):
        """An interface that cannot be followed ends it as one that is alone; nothing is kept that would not help."""
        wrong = [word.replace("b: 0.02", "b: 0.7") for word in FRICTION]
        alone = self.rg(*wrong, seeds=1, status=2)
        self.assertIn("arrests at no strength", alone)
        self.assertEqual(self.rg(*wrong, "--jobs", "1", status=2), alone)
        self.assertFalse(os.path.exists(self.out + ".runs"))


if __name__ == "__main__":
    PROGRAM, SOURCE, STOP = map(os.path.abspath, sys.argv[1:4])
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
