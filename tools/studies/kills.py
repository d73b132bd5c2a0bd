#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stops every command at every call that changes a file, and looks at what it leaves, as a table in markdown.

    kills.py [--lacuna PROGRAM] [--library LIBRARY] [--every N] [COMMAND ...]

At each of the calls (every N-th; at least the first and the last) a command is killed before it, is killed in it with half of what it writes, and is
told that the disk is full. Right is: no output; the whole output; or a file of a run that says that it is not whole and that `mend` can make readable.
After a full disk the command says so in one line and ends with a status other than 0, or it has its output. Then the command is given once more, with
--resume where it has that and there is something to go on from, else with --force, and must come to the output that it has undisturbed. Exit status 1 where something is not right.
LIBRARY: tests/stop/at_call.c as build/tests/libat_call.so.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile

import netCDF4
import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CASES = os.path.join(ROOT, "cases")
SHORT = ["--set", "time.end=20 day", "--set", "output.checkpoint={steps: 40}"]
PRISM = [os.path.join(CASES, "data/prism.csv"), "--time-format", "%d.%m.%Y %H:%M", "--displacement", "Weg_mm:mm"]
RESUMED = ("run", "sweep", "trade", "fit")
CHANGING = ("cpu", "wall", "peak_memory")  # what differs from run to run
ACTIONS = ("kill", "tear", "full=28")


def commands(made):
    """A name, the output, and the words of each command. made: a folder with what other commands wrote."""
    block = os.path.join(CASES, "block.yaml")
    return {
        "run": ("out.nc", ["run", block, *SHORT, "-o", "out.nc"]),
        "contact": ("out.nc", ["contact", os.path.join(CASES, "shear-cycle.yaml"), "--set", "interface.levels=5", "-o", "out.nc"]),
        "rg": ("out.nc", ["rg", os.path.join(CASES, "rg/cons.yaml"), "-o", "out.nc"]),
        "sweep": ("out.nc", ["sweep", block, "--over", "friction.aging.dc=0.1 m, 0.2 m", "--jobs", "1", "-o", "out.nc"]),
        "gather": ("out.nc", ["gather", made + "/part0.nc", made + "/part1.nc", "-o", "out.nc"]),
        "trade": ("out.nc", ["trade", block, "--dials", "rtol=1e-3:1e-4", "--jobs", "1", "-o", "out.nc"]),
        "fit": ("out.nc", ["fit", os.path.join(CASES, "fit/block.yaml"), os.path.join(CASES, "data/creep.csv"), "--set", "fit.steps=0", "--set", "fit.starts=1", "-o", "out.nc"]),
        "precursors": ("out.nc", ["precursors", *PRISM, "-o", "out.nc"]),
        "report": ("out.html", ["report", made + "/run.nc", "-o", "out.html"]),
        "export": ("out.csv", ["export", made + "/run.nc", "--csv", "--variable", "slip", "-o", "out.csv"]),
        "new": ("out.yaml", ["new", "out", "--kind", "slope"]),
    }


def same(path, other):
    """Whether two files hold the same but for times that they took."""
    if not path.endswith(".nc"):
        with open(path, "rb") as a, open(other, "rb") as b:
            return [line for line in a if b"date" not in line] == [line for line in b if b"date" not in line]
    with netCDF4.Dataset(path) as a, netCDF4.Dataset(other) as b:
        return alike(a, b)


def alike(a, b):
    """The same of two groups of netCDF."""
    if set(a.variables) != set(b.variables) or set(a.groups) != set(b.groups):
        return False
    if "on_front" in a.variables:
        return True  # of a trade, which tells a run that was killed as broken
    for name in a.variables:
        if any(word in name for word in CHANGING):
            continue
        one, two = numpy.ma.filled(a[name][:], 0), numpy.ma.filled(b[name][:], 0)
        if one.shape != two.shape or not (one == two).all() if one.dtype.kind in "OSU" else not numpy.array_equal(one, two, equal_nan=True):
            return False
    return all(alike(a.groups[name], b.groups[name]) for name in a.groups)


class Study:
    """One command, stopped everywhere."""

    def __init__(self, given, name, output, words):
        self.given, self.name, self.output, self.words = given, name, output, words
        self.wrong, self.tried, self.states = [], 0, {"none": 0, "whole": 0, "cut": 0}

    def start(self, folder, at=None, more=(), log=None):
        """The command in a folder."""
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        if at is not None:
            environment.update(LD_PRELOAD=self.given.library, AT_CALL=at, AT_CALL_UNDER=folder + "/", AT_CALL_LOG=log or "/dev/null")
        return subprocess.run([self.given.lacuna, *self.words, *more], cwd=folder, env=environment, capture_output=True, text=True, check=False)

    def state(self, folder, reference):
        """What a folder holds: none, whole, cut, or what is wrong."""
        path = os.path.join(folder, self.output)
        if not os.path.exists(path):
            return "none"
        try:
            if same(path, reference):
                return "whole"
        except OSError:
            pass
        if self.name not in ("run", "contact"):
            return "an output that is neither absent nor whole"
        mended = subprocess.run([self.given.lacuna, "mend", self.output], cwd=folder, capture_output=True, text=True, check=False)
        if mended.returncode != 0:
            return "none" if "holds nothing" in mended.stderr or "no record" in mended.stderr else "a file that mend refuses: " + mended.stderr.strip()
        with netCDF4.Dataset(path) as file:
            return "cut" if file.status != "complete" else "a cut file that says complete"

    def stop_at(self, call, action, reference):
        """One stop, and what comes of it."""
        folder = tempfile.mkdtemp(dir=self.given.scratch)
        done = self.start(folder, f"{call}:{action}")
        state = self.state(folder, reference)
        self.tried += 1
        if action.startswith("full") and done.returncode != 0 and len(done.stderr.strip().splitlines()) != 1:
            self.wrong.append((call, action, f"not one line: {done.stderr.strip()!r}"))
        if done.returncode == 0 and state != "whole":
            self.wrong.append((call, action, f"exit status 0 with {state}"))
        if state not in self.states:
            self.wrong.append((call, action, state))
        else:
            self.states[state] += 1
        if self.name == "new" and state != "none":
            os.remove(os.path.join(folder, self.output))  # `new` replaces nothing
        again = self.start(folder, more=["--resume"] if self.name in RESUMED else [] if self.name == "new" else ["--force"])
        if self.name in RESUMED and again.returncode in (2, 3):  # refused: nothing was kept, or all is there
            again = self.start(folder, more=["--force"])
        if again.returncode != 0 or self.state(folder, reference) != "whole":
            self.wrong.append((call, action, f"given again: exit status {again.returncode}, {self.state(folder, reference)}: {again.stderr.strip()}"))
        shutil.rmtree(folder)

    def run(self):
        """All stops; a row of the table."""
        whole = tempfile.mkdtemp(dir=self.given.scratch)
        log = os.path.join(self.given.scratch, "log-" + self.name)
        done = self.start(whole, "0:kill", log=log)
        if done.returncode != 0:
            sys.exit(f"{self.name}: {done.stderr}")
        with open(log, encoding="utf-8") as file:
            calls = sum(1 for line in file if line[0].isdigit())
        reference = os.path.join(whole, self.output)
        chosen = sorted({*range(1, calls + 1, self.given.every), calls})
        for call in chosen:
            for action in ACTIONS:
                self.stop_at(call, action, reference)
        print(f"| `{self.name}` | {calls} | {self.tried} | {self.states['none']} | {self.states['whole']} | {self.states['cut']} | {len(self.wrong)} |", flush=True)
        for call, action, what in self.wrong:
            print(f"{self.name}, call {call}, {action}: {what}", file=sys.stderr)
        return not self.wrong


def prepare(given):
    """What commands read."""
    made = os.path.join(given.scratch, "made")
    os.mkdir(made)

    def lacuna(*words):
        subprocess.run([given.lacuna, *words], cwd=made, check=True, capture_output=True)

    block = os.path.join(CASES, "block.yaml")
    lacuna("run", block, *SHORT, "-o", "run.nc")
    for k in "01":
        lacuna("sweep", block, "--over", "friction.aging.dc=0.1 m, 0.2 m, 0.15 m, 0.3 m", "--shard", f"{k}/2", "-o", f"part{k}.nc")
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("command", nargs="*", help="all if none")
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build/lacuna"))
    parser.add_argument("--library", default=os.path.join(ROOT, "build/tests/libat_call.so"))
    parser.add_argument("--every", type=int, default=1, metavar="N", help="of so many calls one")
    given = parser.parse_args()
    given.lacuna, given.library = os.path.abspath(given.lacuna), os.path.abspath(given.library)
    with tempfile.TemporaryDirectory() as given.scratch:
        all_of = commands(prepare(given))
        print("| command | calls | stops | no output | whole | cut | wrong |\n| --- | --- | --- | --- | --- | --- | --- |")
        right = [Study(given, name, *all_of[name]).run() for name in given.command or all_of]
    sys.exit(0 if all(right) else 1)


if __name__ == "__main__":
    main()
