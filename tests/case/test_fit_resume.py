#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A fit that is killed goes on, to the bit: what it keeps beside its output.

usage: test_fit_resume.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4

PROGRAM, SOURCE = "", ""
CASE, SERIES = "cases/fit/block.yaml", "cases/data/creep.csv"
SHORT = ["--set", "fit.starts=2", "--set", "fit.burn=10", "--set", "fit.walkers=16"]


def rounds(steps, count):
    return [*SHORT, "--set", f"fit.steps={steps}", "--set", f"fit.rounds={count}"]


class Resume(unittest.TestCase):
    words = None  # of another command than fit

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.out = os.path.join(self.folder, "out.nc")
        self.kept = self.out + ".chains"

    def tearDown(self):
        shutil.rmtree(self.folder)

    def command(self, *args, out=None):
        return [PROGRAM, *(self.words or ("fit", CASE, SERIES)), "-o", out or self.out, *args]

    def fit(self, *args, status=1, out=None):
        done = subprocess.run(self.command(*args, out=out), cwd=SOURCE, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stderr

    def same(self, one, other):
        """Every value of every variable, as bits."""
        with netCDF4.Dataset(one) as a, netCDF4.Dataset(other) as b:
            self.assertEqual(list(a.variables), list(b.variables))
            for name in a.variables:
                a[name].set_auto_mask(False)
                b[name].set_auto_mask(False)
                if a[name].dtype is not str:
                    self.assertEqual(a[name][:].tobytes(), b[name][:].tobytes(), name)

    def stop_at(self, size, sent, *args):
        """Ends the fit once so many bytes are kept. Its exit status."""
        with subprocess.Popen(self.command(*args), cwd=SOURCE, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL) as program:
            while program.poll() is None and not (os.path.exists(self.kept) and os.path.getsize(self.kept) > size):
                time.sleep(0.002)
            program.send_signal(sent)
            return program.wait()

    def test_killed_anywhere(self):
        """kill -9 in the least squares, the burn, a round and the next one, one after the other; then a torn end."""
        whole = os.path.join(self.folder, "whole.nc")
        asked = rounds(20, 1)
        self.fit(*asked, out=whole)
        size = os.path.getsize(whole + ".chains")
        self.assertEqual(self.stop_at(1, signal.SIGKILL, *asked), -signal.SIGKILL)
        for share in (0.02, 0.2, 0.4, 0.8):
            self.assertEqual(self.stop_at(share * size, signal.SIGKILL, *asked, "--resume"), -signal.SIGKILL)
            self.assertGreater(os.path.getsize(self.kept), share * size)
            self.assertFalse(os.path.exists(self.out))
        with open(self.kept, "r+b") as file:
            file.truncate(int(0.7 * size))
            file.seek(int(0.6 * size))
            file.write(b"torn")
        self.fit(*asked, "--resume")
        self.same(whole, self.out)
        with open(self.kept, "rb") as kept, open(whole + ".chains", "rb") as other:
            self.assertEqual(kept.read(), other.read())

    def test_interrupted(self):
        """After Ctrl-C --resume replaces what was written, without --force; the number of threads does not matter."""
        whole = os.path.join(self.folder, "whole.nc")
        asked = rounds(30, 0)
        self.fit(*asked, out=whole)
        half = os.path.getsize(whole + ".chains") // 2
        self.assertEqual(self.stop_at(half, signal.SIGINT, *asked), 4)
        with netCDF4.Dataset(self.out) as file:
            self.assertEqual(file.status, "interrupted")
            self.assertLess(file.dimensions["draw"].size, 30)
        self.fit(*asked, "--resume", "--jobs", "2")
        self.same(whole, self.out)

    def test_more_rounds(self):
        """What has not converged stays, and says how to go on; more rounds of it are those of one go."""
        whole = os.path.join(self.folder, "whole.nc")
        self.fit(*rounds(10, 2), out=whole)
        said = self.fit(*rounds(10, 0))
        self.assertIn("with --set fit.rounds=1 --resume goes on from " + self.kept, said)
        self.fit(*rounds(10, 2), "--resume")
        self.same(whole, self.out)
        with netCDF4.Dataset(self.out) as file:
            self.assertEqual(file.dimensions["draw"].size, 40)

    def test_bent_valley(self):
        """Rounds with a straightened valley go on to the bit too: Vajont's two numbers lie on a bent line."""
        whole = os.path.join(self.folder, "whole.nc")
        asked = [*rounds(10, 1), "--set", "fit.walkers=12", "--set", "fit.starts=1"]
        command = ["fit", "cases/vajont-lake.yaml", "cases/data/vajont_rates.csv"]
        self.command = lambda *args, out=None: [PROGRAM, *command, "-o", out or self.out, *args]
        self.fit(*asked, out=whole)
        self.stop_at(0.75 * os.path.getsize(whole + ".chains"), signal.SIGKILL, *asked)
        self.fit(*asked, "--resume")
        self.same(whole, self.out)
        with netCDF4.Dataset(self.out) as file:
            self.assertGreater(file["acceptance"][:].mean(), 0.25)

    def test_converged_leaves_nothing(self):
        """A fit that is done keeps nothing beside its files."""
        held = ["--set", "fit.parameters={initial.slip_rate: {range: [0.5 mm/day, 20 mm/day]}}", "--set", "friction.aging.dc=12 cm",
                "--set", "initial.state.ratio_to_steady=0.6"]
        self.fit(*rounds(300, 3), *held, status=0)
        self.assertEqual(sorted(os.listdir(self.folder)), ["out.nc", "out.yaml"])
        self.fit(*rounds(300, 3), *held, "--resume", status=3)

    def test_refused(self):
        """Steps of something else, a file that no fit wrote, one that another fit holds."""
        asked = rounds(10, 0)
        self.fit(*asked)
        with open(self.kept, "rb") as file:
            kept = file.read()
        for change in ("fit.seed=2", "friction.aging.b=0.014", "fit.walkers=18"):
            self.assertIn("is of another case", self.fit(*asked, "--resume", "--set", change, status=2))
        begin = kept.index(b"\n") + 1
        size = 16 * (4 + 1) * 8 + 16  # places and densities of 16 walkers in four coordinates, and whether they moved
        record = bytearray(kept[begin:begin + size])
        record[0] ^= 1  # as if they had begun elsewhere
        total = 0xcbf29ce484222325
        for byte in record:
            total = (total ^ byte) * 0x100000001b3 % 2 ** 64
        with open(self.kept, "wb") as file:
            file.write(kept[:begin] + record + total.to_bytes(8, "little"))
        self.assertIn("began elsewhere", self.fit(*asked, "--resume", status=2))
        with open(self.kept, "wb") as file:
            file.write(b"mine")
        self.assertIn("was not written by fit", self.fit(*asked, "--force", status=2))
        with open(self.kept, "rb") as file:
            self.assertEqual(file.read(), b"mine")
        os.remove(self.kept)
        self.assertIn("--resume", self.fit(*asked, "--resume", status=3))
        with subprocess.Popen(self.command(*rounds(4000, 0), "--force"), cwd=SOURCE, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL) as program:
            while not (os.path.exists(self.kept) and os.path.getsize(self.kept)):  # its head is written under the lock
                time.sleep(0.002)
            self.assertIn("another fit is at work", self.fit(*asked, "--force", status=2))
            program.kill()

    def test_forecasts(self):
        """precursors --case at the end of the readings, then all along them: killed, then interrupted, it goes on."""
        self.words = "precursors", SERIES, "--case", CASE, "--onset", "5,20"
        whole, asked = os.path.join(self.folder, "whole.nc"), [*rounds(20, 0), "--rolling", "--issues", "2"]
        self.fit(*asked, status=0, out=whole)
        self.assertEqual(os.listdir(self.folder), ["whole.nc"])
        record = 16 * (4 * 8 + 1) + 8  # a step of 16 walkers of three numbers
        self.assertEqual(self.stop_at(25 * record, signal.SIGKILL, *asked), -signal.SIGKILL)
        kept = os.path.getsize(self.kept)
        self.assertIn("of other readings or options", self.fit(*asked, "--until", "2020-06-10T00:00", "--resume", status=2))
        self.assertIn("is of another case", self.fit(*asked, "--set", "fit.seed=7", "--resume", status=2))
        self.assertEqual(os.path.getsize(self.kept), kept)
        self.assertEqual(self.stop_at(75 * record, signal.SIGINT, *asked, "--resume"), 4)
        self.fit(*asked, "--resume", "--jobs", "2", status=0)
        self.same(whole, self.out)
        self.assertEqual(sorted(os.listdir(self.folder)), ["out.nc", "whole.nc"])
        self.assertIn("goes on with the sampler", self.fit("--set", "fit.steps=0", "--resume", status=2))
        self.assertIn("No such file", self.fit(*asked, "--resume", status=3))


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
