#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna run --accuracy`: the pilot run that is kept is the run to the bit, and scenes on which pilot runs agree without
being right, or do not end alike, or break, keep what is asked all the same.

usage: test_accuracy.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import signal
import sys
import unittest

import netCDF4
import numpy

import test_breaks
import test_cli

SAME = (("friction/spread.yaml",), ("transfer/patch.yaml", "interface.cells_x=20", "interface.cells_y=20"),
        ("load/turning.yaml", "interface.levels=3"), ("events.yaml", "interface.levels=3"),
        ("load/field.yaml", "output.points=[{name: a, x: 4 m, y: 4 m}]"),
        ("block.yaml", "analysis.rg.critical_fraction=0.25", "output.every=1 hour"),
        ("one-by-one.yaml", "interface.levels=3", "solver.fidelity=ode"))
MAY_DIFFER = {"history", "wall_time_s", "date_created", "date_modified", "accuracy", "accuracy_asked", "accuracy_estimated",
              "fidelity_why", "fidelity_error"}


class Accuracy(test_cli.Case):
    def run_json(self, *words):
        return json.loads(self.expect(0, "run", *words, "--force", "--json", "--quiet").stdout)

    def block(self, *settings, status=0):
        words = [w for setting in settings for w in ("--set", setting)]
        done = self.expect(status, "run", os.path.join(test_cli.SOURCE, "cases/block.yaml"), "-o", "block.nc", "--force",
                           "--json", "--quiet", *words)
        return json.loads(done.stdout) if status == 0 else done.stderr

    def assert_same(self, one, other):
        with netCDF4.Dataset(self.path(one)) as a, netCDF4.Dataset(self.path(other)) as b:
            self.assertEqual(set(a.variables), set(b.variables))
            for name in a.variables:
                left, right = (numpy.ma.getdata(file[name][...]) for file in (a, b))
                self.assertEqual(left.tobytes(), right.tobytes(), name)
            for name in set(a.ncattrs()) | set(b.ncattrs()):
                if name not in MAY_DIFFER:
                    self.assertEqual(str(a.getncattr(name)), str(b.getncattr(name)), name)

    def compare(self, case, *settings):
        """A run to 1 % beside one with what was picked for it written out."""
        words = [os.path.join(test_cli.SOURCE, "cases", case)] + [w for s in settings for w in ("--set", s)]
        asked = self.run_json(*words, "-o", "asked.nc", "--accuracy", "1%")
        pick = asked["accuracy"]
        plain = self.run_json(*words, "-o", "plain.nc", "--set", f"solver.rtol={pick['rtol']:g}", "--set",
                              f"solver.method={pick['method']}", "--set", f"solver.formulation={pick['formulation']}")
        self.assert_same("asked.nc", "plain.nc")
        for key in set(asked) - {"accuracy", "fidelity_why", "fidelity_error", "wall_time_s", "cpu_time_s", "peak_memory_bytes", "output"}:
            self.assertEqual(asked[key], plain[key], key)
        return pick

    def test_kept_to_the_bit(self):
        """Records, fields, points, events, indicators and the summary are those of a run with the settings written out."""
        for case in SAME:
            self.assertTrue(self.compare(*case)["pilot_kept"], case)

    def test_planned_checkpoints(self):
        """They are of use in a file only: the run is made again, through the same steps."""
        self.assertFalse(self.compare("block.yaml", "output.checkpoint=2 day")["pilot_kept"])

    def jagged(self, n, asked, solver=""):
        """Mean slip of the block of test_breaks with n readings, by pilot runs, and by an integration of its own."""
        end = 1.5e6
        with open(self.path("p.csv"), "w", encoding="ascii") as file:
            file.write("t,p\n")
            for t, value in zip(numpy.arange(n + 1) * (end / n), test_breaks.pressures(n)):
                file.write(f"{t:.17g},{value:.17g}\n")
        self.write("c.yaml", test_breaks.CASE.format(b=0.015, dc=1e-3, v=1e-9, ratio=0.9, end=end, solver=solver, more="",
                                                     spread=""))
        said = self.run_json("c.yaml", "--accuracy", str(asked))
        with netCDF4.Dataset(self.path("run.nc")) as data:
            start = numpy.array(data["cell_slip_rate"][0]), numpy.array(data["cell_state"][0])
        return said, test_breaks.reference(n, end, 0.015, *start, substeps=2)[-1]

    def test_jagged_readings(self):
        """Explicit steps from one reading to the next are the same at many tolerances: that they agree says nothing."""
        for n in 150, 1500:
            for solver in "", "method: bdf", "method: adams":
                for asked in 1e-2, 1e-4:
                    said, exact = self.jagged(n, asked, solver)
                    error = abs(said["mean_slip_m"] / exact - 1)
                    self.assertLessEqual(error, said["accuracy"]["estimated"], (n, solver, asked))
                    self.assertLessEqual(said["accuracy"]["estimated"], asked)

    def test_one_sided_errors(self):
        """What BDF is off by adds up over 3 650 tides, to one side: kept, and cells that are further off are warned of."""
        slip = {}
        for solver in "method: erk, rtol: 1e-7", "method: bdf, accuracy: 10 %":
            self.write("c.yaml", test_breaks.TIDES.format(solver=solver))
            done = self.expect(0, "run", "c.yaml", "--json", "--force")
            slip[solver] = json.loads(done.stdout)["mean_slip_m"]
        self.assertRegex(done.stderr, "is kept, but single cells are further off: ask for a smaller one")
        one, other = slip.values()
        self.assertLessEqual(abs(other / one - 1), 0.1)
        self.assertGreater(abs(other / one - 1), 1e-3)

    def test_end_by_the_failure(self):
        """Coarse runs fail before the end or after it; what is delivered ends as an exact one does, where that can be told."""
        exact = self.block("solver.method=erk", "solver.rtol=1e-10")["failure_time_s"]
        for off in -3e-3, -1e-5, 1e-5, 3e-3:
            for solver in "solver.method=bdf", "solver.max_order=0":
                said = self.block(f"time.end={exact * (1 + off)!r} s", solver, "solver.accuracy=1e-3")
                if abs(off) > 1e-3:
                    self.assertEqual(said["ended_by"], "rate" if off > 0 else "end", (off, solver))
                if said["failed"]:
                    self.assertLessEqual(abs(said["failure_time_s"] / exact - 1), said["accuracy"]["estimated"])

    def test_two_ways_to_fail(self):
        """The slip that is failure is come to just before the rate is, or just after."""
        fails = self.block("solver.method=erk", "solver.rtol=1e-10", "time.failure.mean_slip=1 km")["mean_slip_m"]
        for part in 0.9, 1 - 1e-4, 1 + 1e-4, 1.1:
            limit = f"time.failure.mean_slip={fails * part!r} m"
            exact = self.block("solver.method=erk", "solver.rtol=1e-10", limit)
            self.assertEqual(exact["ended_by"], "slip" if part < 1 else "rate")
            for solver in "solver.method=bdf", "solver.max_order=0":
                said = self.block(limit, solver, "solver.accuracy=1e-3")
                self.assertEqual(said["ended_by"], exact["ended_by"], (part, solver))
                self.assertLessEqual(abs(said["failure_time_s"] / exact["failure_time_s"] - 1),
                                     said["accuracy"]["estimated"])

    def test_pilots_that_break(self):
        """A run of too few steps has no result: another setting is found that has one, or it is said that none does."""
        steps = {}
        for rtol in "1e-4", "1e-6":
            steps[rtol] = self.block("solver.method=erk", f"solver.rtol={rtol}")["steps"]
        self.assertLess(steps["1e-4"], steps["1e-6"])
        said = self.block(f"solver.max_steps={steps['1e-4']}", "solver.accuracy=1%")
        self.assertEqual((said["accuracy"]["method"], said["accuracy"]["rtol"]), ("erk", 1e-4))
        self.assertIn("steps were not enough", self.block(f"solver.max_steps={steps['1e-6']}", "solver.accuracy=1e-9", status=1))
        self.assertTrue(math.isfinite(said["failure_time_s"]))

    def test_a_signal_in_pilot_runs(self):
        """No run was picked yet: the status and a line say so, and no file is left."""
        process = self.start("run", os.path.join(test_cli.SOURCE, "cases/one-by-one.yaml"), "-o", "cut.nc", "-v",
                             "--accuracy", "1e-6", "--set", "solver.fidelity=ode")
        for line in process.stderr:
            if "pilot runs" in line:
                break
        process.send_signal(signal.SIGINT)
        self.assertRegex(process.stderr.read(), "interrupted at .* of a pilot run .* no file was made")
        self.assertEqual((process.wait(), self.exists("cut.nc")), (4, False))


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
