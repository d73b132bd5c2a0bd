#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Histories of normal and shear load, from the case to the file, as users meet them.

usage: test_history.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import pty
import select
import signal
import subprocess
import sys
import time
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

# The benchmark surface in its own units: side 1, E* = 1 (docs/theory/contact.md).
A08 = """\
lacuna: 1
title: the benchmark, sheared
interface: {{size: {size}, levels: {levels}, surface: {{benchmark: {{name: A08}}}}}}
material: {{shear_modulus: {modulus}, poisson: {poisson}}}
load:
  normal: {{pressure: 4.9e-3}}
  history: {{friction: 0.5, {keys}steps: [{steps}]}}
"""


def a08(steps, levels=6, poisson=0.0, keys="", size=1):
    return A08.format(size=size, levels=levels, poisson=poisson, modulus=1 - poisson, keys=keys, steps=steps)


def ratios(values):
    return ", ".join(f"{{ratio_x: {value}}}" for value in values)


class History(Case):
    def follow(self, text, *words, status=0):
        self.write("h.yaml", text)
        done = self.expect(status, "contact", "h.yaml", "--json", "--force", *words)
        return json.loads(done.stdout)

    def data(self):
        return netCDF4.Dataset(self.path("h-contact.nc"))

    def check_cf(self, status):
        done = subprocess.run(
            [sys.executable, os.path.join(test_cli.SOURCE, "tests", "support", "check_cf.py"),
             "--status", status, self.path("h-contact.nc")],
            capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)


class Table(History):
    """The cyclic table of the benchmark, made with independent codes: loading, unloading, reversal."""

    LOADS = [0.3, 0.6, 0.2, -0.2, -0.6, -0.2, 0.2, 0.6, 0.8]
    SHIFTS = [2.10696078e-4, 5.46940959e-4, 2.83936403e-4, -5.81727731e-5, -5.46940959e-4,
              -2.83936403e-4, 5.81727731e-5, 5.46940959e-4, 9.65336400e-4]

    def test_shifts(self):
        done = self.follow(a08(ratios(self.LOADS), levels=8))
        steps = done["steps"]
        self.assertEqual(done["n_cells"], 6869)
        self.assertEqual(len(steps), 9)
        for step, load, shift in zip(steps, self.LOADS, self.SHIFTS):
            self.assertAlmostEqual(step["q_N"] / (0.5 * 4.9e-3), load, delta=1e-8)
            self.assertAlmostEqual(step["shift_m"] / shift, 1, delta=1e-6)
            self.assertAlmostEqual(step["q_y_N"], 0, delta=1e-12)
            self.assertEqual(step["stick_cells"] + step["slip_cells"], 6869)
            self.assertEqual(step["contact_iterations"], 0)
        self.assertEqual([s["cycle_start"] for s in steps], [None] * 5 + [4, 3, 2, None])
        # At 0.6 the joint is back where it was: memory is erased, a cycle closed, and only there.
        self.assertLess(steps[7]["cycle_shift_m"], 1e-6 * self.SHIFTS[1])
        self.assertAlmostEqual(
            steps[5]["cycle_shift_m"] / (self.SHIFTS[3] - self.SHIFTS[5]), 1, delta=1e-6)
        work = steps[7]["cumulative_dissipation_J"] - steps[1]["cumulative_dissipation_J"]
        self.assertAlmostEqual(steps[7]["cycle_dissipation_J"] / work, 1, delta=1e-12)
        self.check_cf("complete")


class Energy(History):
    def test_work_of_a_closed_cycle(self):
        """What is put in along a closed loop, the integral of Q over the shift, is dissipated."""
        steps = "{ratio_x: 0.7}, {ratio_x: -0.7, count: 40}, {ratio_x: 0.7, count: 40}"
        done = self.follow(a08(steps, poisson=0.25))["steps"]
        self.assertEqual(done[-1]["cycle_start"], 1)
        put_in = sum((b["q_N"] + a["q_N"]) / 2 * (b["shift_m"] - a["shift_m"])
                     for a, b in zip(done, done[1:]))
        self.assertGreater(put_in, 0)
        self.assertAlmostEqual(done[-1]["cycle_dissipation_J"] / put_in, 1, delta=2e-3)


class Fields(History):
    STEPS = ("{ratio_x: 0.5}, {pressure: 4e-3, ratio_y: 0.4, count: 2}, "
             "{shift_x: 2e-4, shear_y: 0}, {pressure: 6e-3}")

    def test_maps_agree_with_the_series(self):
        steps = self.follow(a08(self.STEPS, poisson=0.2, size=2))["steps"]
        self.check_cf("complete")
        f, area = 0.5, (2 / 64) ** 2
        with self.data() as data:
            data.set_auto_mask(False)
            self.assertEqual(data["step"][:].tolist(), [1, 2, 3, 4, 5])
            self.assertEqual(data.friction_coefficient, f)
            for i, step in enumerate(steps):
                p, state = data["step_pressure"][i], data["state"][i]
                q = [data["traction_x"][i], data["traction_y"][i]]
                self.assertAlmostEqual(p.sum() * area / step["p_N"], 1, delta=1e-7)
                self.assertAlmostEqual(q[0].sum() * area / step["q_N"], 1, delta=1e-6)
                self.assertAlmostEqual(q[1].sum() * area, step["q_y_N"], delta=1e-9)
                self.assertEqual(numpy.count_nonzero(state == 1), step["stick_cells"])
                self.assertEqual(numpy.count_nonzero(state == 2), step["slip_cells"])
                self.assertTrue(numpy.array_equal(state == 0, p == 0))
                size = numpy.hypot(*q)
                self.assertTrue(numpy.all(size <= f * p * (1 + 1e-6)))
                self.assertTrue(numpy.allclose(size[state == 2], f * p[state == 2], rtol=1e-6))
                self.check_highest(data, i, step, size, f * p, state)
                for name, key in (("normal_force", "p_N"), ("shear_force_x", "q_N"),
                                  ("shear_force_y", "q_y_N"), ("shift_x", "shift_m"),
                                  ("shift_y", "shift_y_m"), ("stick_cells", "stick_cells"),
                                  ("dissipation", "dissipation_J")):
                    self.assertEqual(data[name][i], step[key], name)

    def check_highest(self, data, i, step, size, limit, state):
        """The cell that comes next, by looking at all of them."""
        x = numpy.argmin(abs(data["x"][:] - step["highest_x_m"]))
        y = numpy.argmin(abs(data["y"][:] - step["highest_y_m"]))
        sticking = state == 1
        largest = (size[sticking] / limit[sticking]).max()
        self.assertEqual(state[y, x], 1)
        self.assertAlmostEqual(size[y, x] / limit[y, x] / largest, 1, delta=1e-9)
        self.assertAlmostEqual(step["highest_ratio"], largest, delta=1e-9)
        self.assertEqual(data["highest_ratio"][i], step["highest_ratio"])

    def test_loads_as_asked(self):
        steps = self.follow(a08(self.STEPS, poisson=0.2))["steps"]
        held = 0.5 * 4.9e-3
        for got, wanted in zip([s["p_N"] for s in steps], [4.9e-3, 4.45e-3, 4e-3, 4e-3, 6e-3]):
            self.assertAlmostEqual(got / wanted, 1, delta=1e-12)
        # The traction of step 1 stays where the pressure falls; y goes to 0.4 of the new f P.
        for got, wanted in zip([s["q_N"] for s in steps[:3]], [0.5 * held] * 3):
            self.assertAlmostEqual(got / wanted, 1, delta=1e-8)
        for got, wanted in zip([s["q_y_N"] for s in steps[1:]], [4e-4, 8e-4, 0, 0]):
            self.assertAlmostEqual(got, wanted, delta=1e-10)
        # The shift stays, whatever the pressure.
        for step in steps[3:]:
            self.assertAlmostEqual(step["shift_m"] / 2e-4, 1, delta=1e-8)
        self.assertEqual([s["contact_iterations"] > 0 for s in steps],
                         [False, True, True, False, True])

    def test_last_and_none(self):
        every = self.follow(a08(self.STEPS))["steps"]
        with self.data() as data:
            last = {name: data[name][-1] for name in
                    ("traction_x", "traction_y", "slip_x", "slip_y", "state", "step_pressure")}
            sizes = data["traction_x"].chunking()
        self.assertEqual(sizes, [1, 64, 64])
        self.assertEqual(every, self.follow(a08(self.STEPS, keys="fields: last, "))["steps"])
        self.check_cf("complete")
        with self.data() as data:
            for name, values in last.items():
                self.assertEqual(data[name].dimensions, ("y", "x"))
                self.assertTrue(numpy.array_equal(data[name][:], values), name)
        self.assertEqual(
            every, self.follow(a08(self.STEPS), "--set", "load.history.fields=none")["steps"])
        self.check_cf("complete")
        with self.data() as data:
            self.assertNotIn("state", data.variables)
            self.assertEqual(data.dimensions["step"].size, 5)

    def test_pressure_that_holds_is_written_once(self):
        self.follow(a08(ratios([0.3])))
        with self.data() as data:
            self.assertNotIn("step_pressure", data.variables)
            self.assertEqual(data["state"].flag_meanings, "open stick slip")


class Control(History):
    def test_shift_and_load_control_agree(self):
        by_load = self.follow(a08(ratios([0.4, 0.7])))["steps"]
        shifts = ", ".join(f"{{shift_x: {s['shift_m']!r}, shift_y: {s['shift_y_m']!r}}}"
                           for s in by_load)
        by_shift = self.follow(a08(shifts))["steps"]
        for a, b in zip(by_load, by_shift):
            self.assertAlmostEqual(b["q_N"] / a["q_N"], 1, delta=1e-6)
            self.assertEqual(a["stick_cells"], b["stick_cells"])

    def test_sliding_under_shift_control(self):
        """Far beyond what sticks the load is f P, and the work f P times the slide."""
        steps = self.follow(a08("{shift_x: 0.01}, {shift_x: 0.03, count: 4}"))["steps"]
        held = 0.5 * 4.9e-3
        for step in steps:
            self.assertEqual(step["stick_cells"], 0)
            self.assertAlmostEqual(step["q_N"] / held, 1, delta=1e-7)
            self.assertIsNone(step["highest_ratio"])
        for step in steps[1:]:
            self.assertAlmostEqual(step["dissipation_J"] / (held * 0.005), 1, delta=1e-6)
        self.check_cf("complete")

    def test_a_domain_in_place_of_a_surface(self):
        """Uniform pressure on the whole periodic interface: rigid until it slides as a whole."""
        text = a08("{ratio_x: 0.9}, {pressure: 9.8e-3, shift_x: 0.1}").replace(
            "surface: {benchmark: {name: A08}}", "domain: {full: {}}")
        steps = self.follow(text)["steps"]
        self.assertEqual(steps[0]["stick_cells"], 64 ** 2)
        self.assertAlmostEqual(steps[0]["shift_m"], 0, delta=1e-12)
        self.assertEqual(steps[1]["slip_cells"], 64 ** 2)
        self.assertAlmostEqual(steps[1]["q_N"] / (0.5 * 9.8e-3), 1, delta=1e-9)


class FirstSlip(History):
    def test_nothing_slips_before_it(self):
        first = self.follow(a08(ratios([0.3])))["first_slip"]
        self.assertAlmostEqual(first["q_N"] / (0.5 * 4.9e-3), first["q_over_fp"], delta=1e-12)
        loads = [0.9 * first["q_over_fp"], 0.999 * first["q_over_fp"], 1.01 * first["q_over_fp"]]
        below, near, above = self.follow(a08(ratios(loads)))["steps"]
        for step, part in ((below, 0.9), (near, 0.999)):
            self.assertEqual(step["slip_cells"], 0)
            self.assertEqual(step["dissipation_J"], 0)
            self.assertAlmostEqual(step["highest_ratio"], part, delta=1e-6)
            self.assertEqual((step["highest_x_m"], step["highest_y_m"]),
                             (first["x_m"], first["y_m"]))
            self.assertAlmostEqual(step["shift_m"] / (part * first["shift_m"]), 1, delta=1e-6)
        self.assertGreater(above["slip_cells"], 0)


class Program(History):
    def test_table(self):
        self.write("h.yaml", a08("{ratio_x: 0.5}, {ratio_x: 0}, {ratio_x: 0.5}"))
        out = self.expect(0, "contact", "h.yaml").stdout
        self.assertRegex(out, r"\n +step +P \(mN\) +Q_x \(mN\) +shift_x \(um\) +stick \(%\)")
        self.assertRegex(out, r"\n +3 +4.9 +1.225 ")
        self.assertIn("cycle 1 to 3", out)
        self.assertNotIn("Q_y", out)
        self.assertIn("Q_y", self.expect(0, "contact", "h.yaml", "--force", "--set",
                                         "load.history.steps.1.ratio_y=0.1").stdout)

    def test_run_warns(self):
        self.write("h.yaml", test_cli.BLOCK.replace("levels: 0", "levels: 2, domain: {full: {}}")
                   .replace('"3 MPa"}', '"3 MPa"}, history: {steps: [{ratio_x: 0.3}]}')
                   + 'material: {shear_modulus: "20 GPa"}\n')
        done = self.expect(0, "run", "h.yaml")
        self.assertEqual(done.stderr, "lacuna: warning: h.yaml: load.history is for lacuna "
                                      "contact; run does not use it\n")
        self.assertEqual(self.expect(0, "run", "h.yaml", "--force", "-q").stderr, "")

    def test_static_case_checks(self):
        self.write("h.yaml", a08(ratios([0.3])))
        self.assertEqual(self.expect(0, "check", "h.yaml").stderr, "")
        self.expect(2, "run", "h.yaml")

    def test_check_counts_its_cost(self):
        estimates = []
        for loads in ([0.3], [0.3, 0.5, 0.6]):
            self.write("h.yaml", a08(ratios(loads), levels=9))
            estimates.append(json.loads(self.expect(0, "check", "h.yaml", "--json").stdout)["estimate"])
        once, thrice = estimates
        self.assertTrue(60e6 < once["memory_bytes"] < 150e6)
        self.assertEqual(once["memory_bytes"], thrice["memory_bytes"])
        step = 0.5 * (thrice["cpu_time_most_s"] - once["cpu_time_most_s"])
        self.assertTrue(0.2 < step < 2)

    def begin(self, **options):
        """A history of thousands of steps whose file is there."""
        self.write("h.yaml", a08("{ratio_x: 0.6}, {ratio_x: -0.6, count: 9000}", levels=7))
        process = subprocess.Popen(
            [test_cli.PROGRAM, "contact", "h.yaml", "--json"], cwd=self.folder,
            stdin=subprocess.DEVNULL, text=True, **options)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        deadline = time.monotonic() + 60
        while not self.exists("h-contact.nc") and time.monotonic() < deadline:
            time.sleep(0.02)
        time.sleep(0.5)
        self.assertIsNone(process.poll(), "the long history is over too soon")
        return process

    def test_interrupted_between_steps(self):
        process = self.begin(stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        process.send_signal(signal.SIGUSR1)
        self.assertRegex(process.stderr.readline(),
                         r"^lacuna: \d+ of 9001 steps of the history, .* s so far\n$")
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 4, err)
        done = json.loads(out)
        self.assertEqual(done["status"], "interrupted")
        self.assertGreater(len(done["steps"]), 0)
        self.assertEqual(err, f"lacuna: interrupted after step {len(done['steps'])} of 9001; "
                              "h-contact.nc holds those\n")
        self.check_cf("interrupted")
        with self.data() as data:
            self.assertEqual(data.dimensions["step"].size, len(done["steps"]))
            self.assertEqual(data["shear_force_x"][-1], done["steps"][-1]["q_N"])

    def test_progress(self):
        master, slave = pty.openpty()
        process = self.begin(stdout=subprocess.DEVNULL, stderr=slave,
                             env={"PATH": os.environ["PATH"], "TERM": "xterm"})
        os.close(slave)
        text, deadline = b"", time.monotonic() + 1
        while time.monotonic() < deadline:
            if select.select([master], [], [], 0.1)[0]:
                text += os.read(master, 4096)
        process.kill()
        process.wait()
        os.close(master)
        self.assertRegex(text.decode(), r"\r\[.*\] +\d+ % \d+ of 9001 steps of the history")

    def test_file_too_large_is_an_io_failure(self):
        import resource

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))

        self.write("h.yaml", a08("{ratio_x: 0.6}, {ratio_x: -0.6, count: 500}"))
        done = self.lacuna("contact", "h.yaml", preexec_fn=limit)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(self.status_attribute("h-contact.nc"), "failed")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
