#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of lacuna-mpi against those of lacuna: the same bits on any number of ranks; what it refuses, how it
ends, and that lacuna knows nothing of MPI.

usage: test_ranks.py PROGRAM SOURCE_FOLDER MPI_PROGRAM WRONG_ORDER COUNT_MESSAGES FAIL_AT BUILD_FOLDER [unittest options]

MPI_PROGRAM: none where MPI is not there. WRONG_ORDER and COUNT_MESSAGES are the libraries of tests/ranks, FAIL_AT that of tests/memory. All ranks are on this machine,
more of them than it has processors.
"""

import glob
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE, RANKS, WRONG, COUNTER, FAIL_AT, BUILD = sys.argv[1:8]
OWN = re.compile(r"wall|cpu|memory|history|date_created|date_modified")
FIELDS = "output.fields=[slip, slip_rate, state, traction]"
FULL = ["--set", "interface.levels=8", "--set", "interface.domain={full: {}}"]
LACUNAR = ["--set", "interface.levels=9", "--set", "interface.domain.cascade.dimension=1.8"]
LARGE = ["--set", "interface.levels=10", "--set", "interface.domain.cascade.dimension=1.81"]
HIERARCHY = ["cases/transfer/hierarchy.yaml", *LACUNAR]

# A bundled case with what is set in it, and on how many ranks. FULL has 16 blocks of sums, LACUNAR 20, LARGE 74 of
# 301 720 cells; the last one has one, and two ranks without a cell.
# Contacts are those of `lacuna contact`.
CASES = {
    "rate, bdf": (["cases/transfer/hierarchy.yaml", *LARGE, "--until", "10 minute"], (2,)),
    "rate, bdf, spread, catalogue, points": (
        HIERARCHY + ["--until", "1 hour", "--set", "output.fields_every={per_decade: 1}", "--set", FIELDS, "--set",
                     "analysis={events: {slip_rate: 1 um/s}}", "--set",
                     "friction.spread={dc: {uniform: {half_width: 0.3, seed: 2}}}", "--set",
                     "output.points=[{name: A, x: 100 m, y: 30 m, radius: 20 m}]"], (8,)),
    "slip, adams": (HIERARCHY + ["--set", "solver.method=adams", "--until", "1 hour"], (2,)),
    "traction, erk": (HIERARCHY + ["--set", "solver.method=erk", "--until", "1 hour"], (5,)),
    "inertia": (["cases/momentum/slope.yaml", "--set", "interface.levels=8", "--until", "1 s"], (3,)),
    "two directions": (["cases/load/turning.yaml", *FULL, "--until", "1 hour"], (2,)),
    "elastic": (["cases/transfer/elastic.yaml", *LACUNAR, "--until", "1 second"], (2,)),
    "weakening": (["cases/weakening/dilatancy.yaml", *FULL, "--until", "1 minute"], (2,)),
    "bent base": (["cases/load/chair.yaml", *FULL, "--set", "interface.size=256 m", "--until", "10 day"], (2,)),
    "loads over the joint": (["cases/load/injection.yaml", "--set", "interface.levels=8", "--set",
                              "transfer={hierarchy: {stiffness: elastic}}", "--until", "1 hour"], (3,)),
    "no transfer": (["cases/transfer/none.yaml", *LARGE, "--until", "10 minute"], (2,)),
    "rough surface, one block": (["cases/vajont.yaml", "--set", "interface.levels=7", "--until", "1 day"], (3,)),
}
CONTACTS = {
    "free": (["cases/contact/self-affine.yaml", "--set", "interface.levels=6", "--set", "interface.boundary=free"], (5,)),
    "periodic, more ranks than rows in pairs": (["cases/contact/self-affine.yaml", "--set", "interface.levels=3"], (8,)),
    "approach": (["cases/normal/approach.yaml", "--set", "interface.levels=6"], (2,)),
    "benchmark": (["cases/contact/j07.yaml", "--set", "interface.levels=6"], (3,)),
}


MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1"]


def command(ranks, *words, preload=None):
    loaded = ["env", f"LD_PRELOAD={preload}"] if preload else []
    return [*MPIRUN, "-np", str(ranks), *loaded, RANKS, *words]


def run(words, **more):
    return subprocess.run(words, cwd=SOURCE, capture_output=True, text=True, timeout=600, **more)


def read(path):
    """All of a file but what tells of its making."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        seen = {"@" + name: str(file.getncattr(name)) for name in file.ncattrs() if not OWN.search(name)}
        seen.update({name: len(d) for name, d in file.dimensions.items()})
        for name, v in file.variables.items():
            if not OWN.search(name):
                values = numpy.asarray(v[...])
                bits = values.tobytes() if values.dtype != object else values.tolist()
                seen["variable " + name] = (v.dimensions, {k: str(v.getncattr(k)) for k in v.ncattrs()}, bits)
    return seen


class Alone(unittest.TestCase):
    def test_lacuna_knows_nothing_of_mpi(self):
        for file in [PROGRAM, *glob.glob(os.path.join(BUILD, "liblacuna.*"))]:
            named = run(["nm", file]).stdout + run(["nm", "-D", file]).stdout
            self.assertIn("lac_", named + "lac_" * ("lacuna.so" in file))
            self.assertEqual(re.findall(r"\bP?MPI_\w+|\bompi_\w+", named), [], file)


    def test_check_says_how_many_ranks(self):
        case = ["cases/transfer/hierarchy.yaml", "--json"]
        for words, ranks in ((LACUNAR, 20), (LARGE, 74), (["--set", "interface.levels=7"], 1),
                             (LACUNAR + ["--set", "solver.fidelity=events"], 1)):
            said = run([PROGRAM, "check", *case, *words])
            estimate = json.loads(said.stdout)["estimate"]
            self.assertEqual(estimate["ranks_most"], ranks, words)
            self.assertEqual(estimate["memory_rank_bytes"] < estimate["memory_bytes"], ranks > 1, words)


@unittest.skipIf(RANKS == "none", "MPI is not there (tools/install-packages --test brings it)")
class Ranks(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.one, self.many = (os.path.join(self.folder.name, name) for name in ("one.nc", "many.nc"))

    def tearDown(self):
        self.folder.cleanup()

    def alone(self, case, *more, action="run"):
        done = run([PROGRAM, action, *case, "-o", self.one, "--force", "-q", *more])
        self.assertEqual(done.returncode, 0, done.stderr)
        return read(self.one)

    def test_every_number_of_ranks_gives_the_bits_of_one(self):
        for name, (case, numbers) in (CASES | CONTACTS).items():
            action = "run" if name in CASES else "contact"
            expected = self.alone(case, action=action)
            for ranks in numbers:
                with self.subTest(name, ranks=ranks):
                    done = run(command(ranks, action, *case, "-o", self.many, "--force", "-q"))
                    self.assertEqual(done.returncode, 0, done.stderr)
                    found = read(self.many)
                    self.assertEqual([k for k in expected if expected[k] != found.get(k)], [])
                    self.assertEqual(expected.keys(), found.keys())

    def test_a_sum_in_another_order_is_noticed(self):
        case = HIERARCHY + ["--until", "1 hour"]
        expected = self.alone(case)
        done = run(command(2, "run", *case, "-o", self.many, "--force", "-q", preload=WRONG))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(expected != read(self.many))

    def test_a_step_tells_what_the_page_says(self):
        counts = os.path.join(self.folder.name, "counts")
        given = "transfer={hierarchy: {k0: 40 GPa/m}}"  # its calibration tells more, once
        done = run(command(3, "run", "cases/transfer/hierarchy.yaml", *LARGE, "--until", "10 minute", "-o", self.many, "-q",
                           "--set", given, preload=COUNTER), env={**os.environ, "COUNTS": counts})
        self.assertEqual(done.returncode, 0, done.stderr)
        with netCDF4.Dataset(self.many) as file:
            evaluations, solves, steps = file.rhs_evaluations, file.linear_solves, file.steps
            cells, records = len(file.dimensions["cell"]), len(file.dimensions["time"])
        with open(counts, encoding="utf-8") as lines:
            found = {key: int(value) for key, value in (line.split() for line in lines)}
        received = found.pop("received")
        found = {int(key): value for key, value in found.items()}
        leaves = max(set(found) - {74, 2 * 74, 3 * 74})  # words of a join of them
        self.assertLess(leaves, 2 * 2 * 3 * 10)  # a border cuts ten levels
        model = {1: evaluations + steps, 3: 7 * steps + 21, 74: 6 * evaluations + 5 * steps, 2 * 74: records,
                 3 * 74: evaluations, leaves: evaluations + solves + steps}
        self.assertEqual(set(found), set(model))
        for what, of in (("collectives", 1), ("bytes", 8)):
            counted, said = (sum(n * (of if of == 1 else of * words) for words, n in each.items())
                             for each in (found, model))
            self.assertLess(abs(counted / said - 1), 0.05, f"{what}: {counted}, not {said}")
        self.assertLess(received, 8 * 2 * 1.01 * cells)  # of the first step alone
        self.assertGreater(received, 0)

    def test_help_says_how_to_start_ranks(self):
        own, other = (run([program, "--help"]).stdout for program in (RANKS, PROGRAM))
        self.assertIn("mpirun -np 8 lacuna-mpi run CASE", own)
        self.assertNotIn("mpirun", other)

    def lines(self, done):
        return [line for line in done.stderr.splitlines() if line.startswith("lacuna")]

    def test_what_is_not_shared_is_refused_in_one_line(self):
        case = "cases/transfer/hierarchy.yaml"
        for words, says in ((["rg", case], "rg is not shared by ranks: do it on one, with lacuna rg"),
                            (["run", case, "--set", "solver.fidelity=events"], "solver.fidelity other than ode is not"),
                            (["run", case, "--accuracy", "1e-4"], "solver.accuracy is not shared by ranks")):
            with self.subTest(words[0]):
                done = run(command(2, *words, "-o", self.many))
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertEqual(len(self.lines(done)), 1, done.stderr)
                self.assertIn(says, self.lines(done)[0])
                self.assertFalse(os.path.exists(self.many))

    def test_an_error_of_one_rank_is_one_line_and_one_status(self):
        words = ["run", HIERARCHY[0], "--set", "interface.levels=7", "--force", "-o"]  # one that was ended may have begun a file
        early, late, *later = (["env", f"LD_PRELOAD={FAIL_AT}", f"FAIL_AT={at}"] for at in (40, 195, 172, 175, 178, 181))
        lost, ended = ["env", "-C", self.folder.name], []
        for rank, fault, to, status, says in (
                (0, [], "/nowhere/run.nc", 3, "lacuna: /nowhere/run.nc"),  # the others wait to be told
                (0, early, self.many, 1, "out of memory"),  # these for something else
                *((1, at, self.many, 1, "out of memory") for at in later),  # mpirun may stop rank 0, which says no more
                (1, late, self.many, 1, "out of memory"),
                (2, lost, self.many, 3, f"{HIERARCHY[0]}: cannot be opened")):
            with self.subTest(says, rank=rank):
                each = [[":", "-np", "1", *(fault if r == rank else []), RANKS, *words, to] for r in range(3)]
                done = run([*MPIRUN, *sum(each, [])[1:]])
                self.assertEqual(done.returncode, status, done.stderr)
                self.assertEqual(len(self.lines(done)), 1, done.stderr)
                self.assertIn(says, self.lines(done)[0])
                ended += [line for line in self.lines(done) if "all ranks end" in line and os.path.exists(self.many)]
        self.assertEqual([line for line in ended if f"`lacuna mend {self.many}`" not in line], [])
        self.assertNotEqual(ended, [])

    def begin(self, ranks, case, *more):
        """A run under way, and the processes of its ranks."""
        job = subprocess.Popen(command(ranks, "run", *case, "-o", self.many, "-q", *more), cwd=SOURCE,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        for _ in range(6000):
            journal = self.many + ".journal"
            if os.path.exists(journal) and os.path.getsize(journal) > self.size:
                break
            self.assertIsNone(job.poll(), "it ended too soon")
            time.sleep(0.01)
        children = run(["pgrep", "-P", str(job.pid)]).stdout.split()
        self.assertEqual(len(children), ranks)
        return job, [int(child) for child in children]

    def test_stopped_and_killed_it_goes_on_with_other_ranks(self):
        case = HIERARCHY + ["--set", "solver.method=adams", "--until", "5 hour", "--set",
                            "output.checkpoint={steps: 60}"]
        self.size = 60000
        expected = self.alone(case)
        job, ranks = self.begin(8, case)
        os.kill(ranks[1], signal.SIGINT)  # all end after the step
        said = job.communicate(timeout=300)[1]
        self.assertEqual(job.returncode, 4, said)
        with netCDF4.Dataset(self.many) as file:
            self.assertEqual(file.status, "interrupted")
        self.size = 0
        job, ranks = self.begin(3, case, "--resume")
        os.kill(ranks[1], signal.SIGKILL)
        job.communicate(timeout=300)
        self.assertNotEqual(job.returncode, 0)
        done = run([PROGRAM, "run", *case, "-o", self.many, "--resume", "-q"])
        self.assertEqual(done.returncode, 0, done.stderr)
        found = read(self.many)
        self.assertEqual([k for k in expected if expected[k] != found.get(k)], [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[8:])
