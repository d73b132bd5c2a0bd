#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether lacuna-mpi keeps the bits of lacuna: on all numbers of ranks, when resumed on others, and when ranks are killed.

    ranks.py [square] [chain] [kills] [--build build] [--kills 50] [--seed 1]

square: all cases of tests/case/test_ranks.py on 1, 2, 3, 5 and 8 ranks. chain: a run begun on 8 ranks, stopped, resumed on 3,
stopped, ended on one. kills: SIGKILL to a random rank of a run on 2, 3, 5 or 8 at a random time; what `lacuna mend` makes of its
file must be the beginning of the unbroken run's, and `--resume` on 1, 2, 3, 5 or 8 ranks must come to its bits. Without a word: all
three. Prints what docs/howto-cluster.md says; exits 1 where a bit differs.
"""

import argparse
import collections
import importlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

import netCDF4
import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NUMBERS = (1, 2, 3, 5, 8)


class Study:
    """The tests' cases and how they run them, and the files of one run alone and one on ranks."""

    def __init__(self, build, folder):
        words = ["lacuna", ROOT, "lacuna-mpi", "tests/libwrong_order.so", "tests/libcount_messages.so", "tests/libfail_at.so",
                 ""]
        sys.argv[1:] = [word if word == ROOT else os.path.join(build, word) for word in words]
        sys.path.insert(0, os.path.join(ROOT, "tests", "case"))
        self.tests = importlib.import_module("test_ranks")
        self.one, self.many = (os.path.join(folder, name) for name in ("one.nc", "many.nc"))
        self.wrong, self.takes = 0, {}
        self.case = [*self.tests.HIERARCHY, "--set", "solver.method=adams", "--until", "5 hour", "--set",
                     "output.checkpoint={steps: 20}"]

    def alone(self, case, action="run"):
        self.must(self.tests.run([self.tests.PROGRAM, action, *case, "-o", self.one, "--force", "-q"]))
        return self.tests.read(self.one)

    @staticmethod
    def must(done):
        if done.returncode != 0:
            raise SystemExit(f"{' '.join(done.args)}: {done.stderr}")

    def compare(self, expected, what):
        found = self.tests.read(self.many)
        others = [key for key in expected if expected[key] != found.get(key)]
        if others or found.keys() - expected.keys() - {"@resumed"}:
            self.wrong += 1
            print(f"{what}: other bits: {others or sorted(found.keys() - expected.keys())}")

    def on_ranks(self, ranks, words):
        self.must(self.tests.run(self.tests.command(ranks, *words, "-o", self.many, "-q")))

    def begin(self, ranks, *more):
        """@return the job, once it has a journal, and the processes of its ranks"""
        job = subprocess.Popen(self.tests.command(ranks, "run", *self.case, "-o", self.many, "-q", *more), cwd=ROOT,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        before = os.stat(self.many).st_ino if os.path.exists(self.many) else 0
        while job.poll() is None and not (os.path.exists(self.many) and os.stat(self.many).st_ino != before):
            time.sleep(0.002)
        children = subprocess.run(["pgrep", "-P", str(job.pid)], capture_output=True, text=True, check=False).stdout.split()
        return job, [int(child) for child in children]

    def time(self, numbers):
        """Finds what the run takes once it is begun, of which stops are fractions."""
        for ranks in numbers:
            self.clear()
            job, _ = self.begin(ranks)
            begun = time.time()
            job.wait()
            self.takes[ranks] = time.time() - begun

    def clear(self):
        for ending in ("", ".journal", ".checkpoint"):
            if os.path.exists(self.many + ending):
                os.remove(self.many + ending)


def square(study):
    cells = collections.Counter()
    for name, (case, _) in (study.tests.CASES | study.tests.CONTACTS).items():
        action = "run" if name in study.tests.CASES else "contact"
        expected = study.alone(case, action)
        for ranks in NUMBERS:
            study.on_ranks(ranks, [action, *case, "--force"])
            study.compare(expected, f"{name}, {ranks} ranks")
        cells["of more than 2^18 cells"] += expected.get("cell", 0) > 1 << 18
        cells["in all"] += 1
        print(f"  {name}: {expected.get('cell', '-')} cells, {len(expected)} dimensions, attributes and variables", flush=True)
    print(f"square: {cells['in all']} cases, {cells['of more than 2^18 cells']} of more than 2^18 cells, on {NUMBERS} ranks")


def chain(study):
    expected, steps = study.alone(study.case), []
    study.time((8, 3))
    study.clear()
    for ranks, more in ((8, ()), (3, ("--resume",))):
        job, children = study.begin(ranks, *more)
        time.sleep(0.25 * study.takes[ranks])
        os.kill(children[-1], signal.SIGINT)
        if job.wait() != 4:
            raise SystemExit(f"the run on {ranks} ranks ended with {job.returncode}, not as interrupted")
        steps.append(len(netCDF4.Dataset(study.many).dimensions["time"]))
    study.on_ranks(1, ["run", *study.case, "--resume"])
    study.compare(expected, "8, 3 and 1 ranks")
    print(f"chain: on 8 ranks to record {steps[0]}, on 3 to {steps[1]}, on 1 to {expected['time']}")


def is_beginning(expected, path):
    """Whether a file that a kill left is what the unbroken run's begins with. @return its records, or -1"""
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        n = len(file.dimensions["time"])
        good = file.status == "running" and n <= expected["time"]
        for name, v in file.variables.items():
            if v.dimensions[:1] == ("time",) and ("variable " + name) in expected:
                whole = numpy.frombuffer(expected["variable " + name][2], v.dtype)
                values = v[...].ravel()
                good = good and values.tobytes() == whole[:len(values)].tobytes()
    return n if good else -1


def kill_one(study, draw, expected):
    """@return how it went: words, and the records that were left"""
    ranks = draw.choice(NUMBERS[1:])
    study.clear()
    job, children = study.begin(ranks)
    time.sleep(draw.uniform(0.0, 0.9) * study.takes[ranks])
    if job.poll() is not None:
        return "over before the kill", 0
    os.kill(draw.choice(children), signal.SIGKILL)
    if job.wait() == 0:
        return "over before the kill", 0
    resumes = os.path.exists(study.many + ".checkpoint")
    study.must(study.tests.run(["cp", study.many, study.one]))
    study.must(study.tests.run(["cp", study.many + ".journal", study.one + ".journal"]))
    study.must(study.tests.run([study.tests.PROGRAM, "mend", study.one, "-q"]))
    records = is_beginning(expected, study.one)
    if records < 0:
        study.wrong += 1
        return "of other bits when mended", 0
    again = draw.choice(NUMBERS)
    study.on_ranks(again, ["run", *study.case, "--resume" if resumes else "--force"])
    study.compare(expected, f"killed on {ranks}, resumed on {again} ranks")
    return "resumed" if resumes else "killed before the first checkpoint", records


def kills(study, count, seed):
    draw, expected = random.Random(seed), study.alone(study.case)
    went, records = collections.Counter(), []
    study.time(NUMBERS[1:])
    while sum(went[w] for w in went if not w.startswith("over")) < count:
        how, left = kill_one(study, draw, expected)
        went[how] += 1
        records += [left] * (not how.startswith("over"))
    print(f"kills: {dict(went)}; {min(records)} to {max(records)} of {expected['time']} records were left")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="*", help="square, chain, kills")
    parser.add_argument("--build", default=os.path.join(ROOT, "build"))
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        study = Study(os.path.abspath(asked.build), folder)
        for what in asked.what or ("square", "chain", "kills"):
            if what == "kills":
                kills(study, asked.kills, asked.seed)
            else:
                {"square": square, "chain": chain}[what](study)
    print(f"{study.wrong} of them with other bits")
    return 1 if study.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
