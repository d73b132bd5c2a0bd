#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`analysis: {events: ...}`: the catalogue in the file against one built from every step's fields.

usage: test_events.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4
import numpy as np

PROGRAM, SOURCE = "", ""
RISE, HOLD, MODULUS = 1e-3, 0.5, 15e9

# Cells that slip by turns, some together, held by neighbours too soft to keep them.
PATCHES = """
lacuna: 1
interface: {size: 1 m, levels: LEVELS, boundary: BOUNDARY, SHAPE
            domain: {cascade: {dimension: DIMENSION, seed: 3}}}
material: {shear_modulus: 15 GPa, poisson: 0.25, shear_speed: 1 km/s}
load: {normal: {pressure: 10 MPa}, shear: [{spring: {stiffness: 2 GPa/m, speed: 10 um/s}}]}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: 4 um, v0: 1 um/s},
           spread: {dc: {lognormal: {sigma: 0.3, seed: 4}}}}
initial: {slip_rate: 1 um/s, state: {ratio_to_steady: 0.9},
          spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}}
transfer: {hierarchy: {k0: 1e10, ratio: 0.5}}
time: {end: END s, failure: {mean_slip_rate: 1000 m/s}}
solver: {method: bdf}
analysis: {events: {slip_rate: 1 mm/s}}
output: {fields: [slip, slip_rate], fields_every: {steps: 1}, every: {steps: 1}}
"""


def patches(levels=4, boundary="periodic", shape="", dimension=1.8, end=3):
    text = PATCHES.replace("LEVELS", str(levels)).replace("BOUNDARY", boundary)
    text = text.replace("SHAPE", shape).replace("DIMENSION", str(dimension))
    return text.replace("END", str(end))


def motions(time_of, rate, slip):
    """Of one cell: (start, end, slip) of each stretch of motion, and whether it was cut."""
    speed, found, since = np.abs(rate), [], None
    for k, v in enumerate(speed):
        if since is None and v >= RISE:
            since = (time_of[k], slip[k], 1)
            if k > 0:
                u = speed[k - 1]
                at = np.log(RISE / u) / np.log(v / u)
                gone = (RISE - u) / (v - u)
                since = (time_of[k - 1] + at * (time_of[k] - time_of[k - 1]),
                         slip[k - 1] + gone * (slip[k] - slip[k - 1]), 0)
        elif since is not None and v < HOLD * RISE:
            u = speed[k - 1]
            at = np.log(HOLD * RISE / u) / np.log(v / u)
            gone = (HOLD * RISE - u) / (v - u)
            end = time_of[k - 1] + at * (time_of[k] - time_of[k - 1])
            total = slip[k - 1] + gone * (slip[k] - slip[k - 1]) - since[1]
            found.append((since[0], end, total, since[2]))
            since = None
    if since is not None:
        found.append((since[0], time_of[-1], slip[-1] - since[1], since[2] + 2))
    return found


def side(lines, n, periodic):
    """Lines from the first to the last of a connected set: without the widest gap."""
    lines = np.unique(lines)
    gap = np.diff(np.append(lines, lines[0] + n)) if periodic else np.diff(lines)
    if periodic:
        return n - (gap.max() - 1) if len(lines) else 0
    return lines[-1] - lines[0] + 1


def recount(data):
    """The events of a file, from its snapshots: dicts in the order of their starts."""
    periodic = data.boundary == "periodic"
    nx, ny = int(data.grid_nx), int(data.grid_ny)
    x = np.floor(data["x"][:] / data.grid_dx_m).astype(int)
    y = np.floor(data["y"][:] / data.grid_dy_m).astype(int)
    times = np.array(data["time_origin"][:] + data["time_local"][:])
    rate, slip = np.array(data["cell_slip_rate"][:]), np.array(data["cell_slip"][:])
    found = [(i, m) for i in range(len(x)) for m in motions(times, rate[:, i], slip[:, i])]
    parent = list(range(len(found)))

    def root(k):
        while parent[k] != k:
            k = parent[k]
        return k

    for a, (i, m) in enumerate(found):
        for b, (j, w) in enumerate(found[:a]):
            dx, dy = abs(x[i] - x[j]), abs(y[i] - y[j])
            if periodic:
                dx, dy = min(dx, nx - dx), min(dy, ny - dy)
            if i != j and max(dx, dy) == 1 and m[0] <= w[1] and w[0] <= m[1]:
                parent[root(a)] = root(b)
    events = []
    for r in sorted({root(k) for k in range(len(found))}):
        part = [found[k] for k in range(len(found)) if root(k) == r]
        cells = sorted({i for i, _ in part})
        first = min(part, key=lambda one: (one[1][0], one[0]))
        size = side(x[cells], nx, periodic) * data.grid_dx_m
        if ny > 1:
            size = max(size, side(y[cells], ny, periodic) * data.grid_dy_m)
        fastest = max(np.abs(rate[(times >= m[0]) & (times <= m[1]), i]).max(initial=0)
                      for i, m in part)
        events.append({"time": first[1][0], "end": max(m[1] for _, m in part),
                       "fastest": fastest,
                       "cells": len(cells), "size": size, "x": data["x"][first[0]],
                       "y": data["y"][first[0]],
                       "potency": sum(abs(m[2]) for _, m in part)
                       * data.grid_dx_m * data.grid_dy_m,
                       "cut": np.bitwise_or.reduce([m[3] for _, m in part])})
    return sorted(events, key=lambda e: e["time"])


class Events(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-events-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def call(self, *words, status=0):
        done = subprocess.run([PROGRAM, *words], text=True, capture_output=True, cwd=self.folder,
                              check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def write(self, text):
        with open(os.path.join(self.folder, "case.yaml"), "w", encoding="utf-8") as file:
            file.write(text)

    def run_case(self, text, *settings, output="out.nc"):
        self.write(text)
        sets = [word for setting in settings for word in ("--set", setting)]
        done = self.call("run", "case.yaml", "-o", output, "--force", "--json", *sets)
        return json.loads(done.stdout)

    def file(self, name="out.nc"):
        return netCDF4.Dataset(os.path.join(self.folder, name))

    def check_cf(self, status="complete"):
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tests/support/check_cf.py"),
                               "--status", status, os.path.join(self.folder, "out.nc")],
                              text=True, capture_output=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def compare(self, result):
        """Each event of the file is one of the recount's; returns those."""
        with self.file() as data:
            expected = recount(data)
            order = np.argsort(data["event_time"][:], kind="stable")
            self.assertEqual(len(order), len(expected))
            self.assertEqual(result["events"], len(expected))
            ends = data["event_time"][:] + data["event_duration"][:]
            self.assertTrue(np.all(np.diff(ends) > -1e-9), "in the order in which they end")
            for k, event in zip(order, expected):
                said = {name: float(data["event_" + name][k]) for name in
                        ("time", "duration", "cells", "size", "x", "y", "potency", "moment", "cut")}
                for name in ("cells", "cut", "x", "y"):
                    self.assertEqual(said[name], event[name], (name, event))
                self.assertAlmostEqual(said["time"], event["time"], delta=1e-10)
                self.assertAlmostEqual(said["duration"], event["end"] - event["time"], delta=1e-10)
                self.assertAlmostEqual(said["size"], event["size"], delta=1e-12)
                self.assertAlmostEqual(said["potency"] / event["potency"], 1, delta=1e-9)
                self.assertAlmostEqual(said["moment"] / said["potency"] / MODULUS, 1, delta=1e-14)
                # between the ends of steps a rate comes a little above what it is at these
                above = float(data["event_max_slip_rate"][k]) / event["fastest"] - 1
                self.assertGreater(above, -1e-12)
                self.assertLess(above, 0.1)
            area = data.grid_dx_m * data.grid_dy_m
            total = area * np.abs(data["cell_slip"][-1]).sum()
            self.assertLess(data["event_potency"][:].sum(), total)
            self.assertAlmostEqual(data["event_potency"][:].sum() / result["event_potency_m3"], 1,
                                   delta=1e-12)
        return expected

    def test_recount_periodic(self):
        result = self.run_case(patches())
        events = self.compare(result)
        self.assertGreater(len(events), 20)
        self.assertGreater(max(e["cells"] for e in events), 3)
        together = sum(b["time"] < a["end"] for a, b in zip(events, events[1:]))
        self.assertGreater(together, 0, "some overlap in time")
        self.check_cf()

    def test_recount_free_and_line(self):
        self.compare(self.run_case(patches(3, "free", end=4)))
        self.compare(self.run_case(patches(5, "periodic", "shape: line,", 0.9, end=6)))

    def test_cut_by_both_ends(self):
        result = self.run_case(patches(3), "initial.slip_rate=0.8 mm/s", "time.end=2 ms",
                               "analysis.events.slip_rate=1 mm/s")
        events = self.compare(result)
        self.assertGreater(result["events_cut"], 0)
        self.assertTrue(any(e["cut"] & 1 for e in events))
        self.assertTrue(any(e["cut"] & 2 for e in events))

    def test_costs_nothing_elsewhere(self):
        """The series is the same to the last bit with and without a catalogue."""
        text = patches(3, end=1)
        self.run_case(text, output="with.nc")
        without = self.run_case(text.replace("analysis: {events: {slip_rate: 1 mm/s}}\n", ""))
        self.assertIsNone(without["events"])
        with self.file("with.nc") as a, self.file() as b:
            self.assertNotIn("event", b.dimensions)
            self.assertNotIn("event_time", b.variables)
            for name in ("time", "slip", "max_slip_rate", "shear_force", "balance_residual"):
                self.assertTrue(np.array_equal(a[name][:], b[name][:]), name)

    def test_published_times(self):
        """A spring slider's five events (reference: Dormand-Prince 8(7), 1e-10 to 1e-13)."""
        published = [5.615967767843e6, 1.851449733346e7, 3.141302690505e7, 4.431155647664e7,
                     5.721008604823e7]
        with open(os.path.join(SOURCE, "cases/peers/spring-slider.yaml"), encoding="utf-8") as file:
            text = file.read() + "analysis: {events: {slip_rate: 1 mm/s}}\n"
        result = self.run_case(text, "solver.rtol=1e-10", "output.every={steps: 1000}")
        self.assertEqual(result["events"], 5)
        with self.file() as data:
            error = np.abs(data["event_time"][:] / published - 1)
            self.assertLess(error.max(), 5e-11)
            self.assertTrue(np.all(data["event_cells"][:] == 1))
            self.assertAlmostEqual(data["event_max_slip_rate"][-1], 0.227808, delta=1e-6)
            fastest = list(data["event_max_slip_rate"][:])
        self.assertEqual([e["max_slip_rate_m_s"] for e in result["slip_events"]], fastest)
        for e, start in zip(result["slip_events"], published):
            self.assertLess(abs(e["time_s"] / start - 1), 5e-11)
            self.assertLess(e["time_s"], e["max_slip_rate_time_s"])
            self.assertLess(e["max_slip_rate_time_s"], e["end_time_s"])
        self.check_cf()

    def test_crest_between_steps(self):
        """At a loose tolerance the ends of steps miss what is between them."""
        with open(os.path.join(SOURCE, "cases/peers/periodic-line.yaml"), encoding="utf-8") as file:
            text = file.read().replace("file: periodic-line.nc",
                                       "file: " + SOURCE + "/cases/peers/periodic-line.nc")
        result = self.run_case(text, "time.end=5.923e9", "output.every={steps: 1}")
        (event,) = result["slip_events"]
        self.assertLess(abs(event["max_slip_rate_m_s"] / 1.400123 - 1), 5e-6)
        self.assertLess(abs(event["time_s"] / 5.922698259157e9 - 1), 1e-9)
        result = self.run_case(text, "time.end=5.923e9", "solver.rtol=1e-6")
        self.assertGreater(abs(result["max_slip_rate_m_s"] / 1.400123 - 1), 5e-5)
        self.assertLess(abs(result["slip_events"][0]["max_slip_rate_m_s"] / 1.400123 - 1), 5e-6)

    def test_no_modulus_no_moment(self):
        text = patches(3, end=1).replace("{shear_modulus: 15 GPa, poisson: 0.25, "
                                         "shear_speed: 1 km/s}", "{}")
        text = text.replace("f0: 0.6", "form: regularised, f0: 0.6")
        result = self.run_case(text, "analysis.events.slip_rate=2 um/s",
                               "time.failure.mean_slip_rate=1 mm/s")
        self.assertIsNone(result["event_moment_N_m"])
        with self.file() as data:
            self.assertGreater(len(data["event_moment"]), 0)
            self.assertTrue(np.all(np.ma.getmaskarray(data["event_moment"][:])))
            self.assertFalse(np.any(np.ma.getmaskarray(data["event_potency"][:])))
        self.check_cf()

    def test_nothing_moves(self):
        result = self.run_case(patches(2), "analysis.events.slip_rate=1000 m/s",
                               "time.end=0.1 s")
        self.assertEqual((result["events"], result["event_size_max_m"]), (0, 0))
        with self.file() as data:
            self.assertEqual(len(data.dimensions["event"]), 0)
        self.check_cf()

    def broken_off(self, how):
        """A run ended from outside after some events were on disk."""
        self.write(patches(4, end=1000).replace("fields: [slip, slip_rate], fields_every: "
                                                "{steps: 1}, ", ""))
        with subprocess.Popen([PROGRAM, "run", "case.yaml", "-o", "out.nc", "-q"],
                              cwd=self.folder) as run:
            path, size = os.path.join(self.folder, "out.nc"), None
            for _ in range(600):
                time.sleep(0.05)
                size = size or (os.path.exists(path) and os.path.getsize(path))
                if size and os.path.getsize(path) > size + 500000:
                    break
            run.send_signal(how)
            return run.wait()

    def test_interrupted_run_is_whole(self):
        self.assertEqual(self.broken_off(signal.SIGINT), 4)
        with self.file() as data:
            self.assertEqual(data.status, "interrupted")
            cut = data["event_cut"][:]
            end = data["event_time"][:] + data["event_duration"][:]
            self.assertGreater(len(cut), 3)
            self.assertTrue(np.all(end[cut == 2] == data["time"][-1]))
            self.assertTrue(np.all(end[cut == 0] <= data["time"][-1]))
        self.check_cf("interrupted")

    def test_killed_run_keeps_its_events(self):
        self.assertEqual(self.broken_off(signal.SIGKILL), -signal.SIGKILL)
        with self.file() as data:
            self.assertEqual(data.status, "running")
            times = data["event_time"][:]
            self.assertGreater(len(times), 3)
            self.assertFalse(np.any(np.ma.getmaskarray(times[:-1])))
            self.assertTrue(np.all(data["event_cells"][:-1] >= 1))

    def test_wrong_keys(self):
        for given, says in (("{sliprate: 1}", 'did you mean "slip_rate"?'),
                            ("{slip_rate: 0}", '"0" must be > 0 m/s'),
                            ("{slip_rate: 1 m}", '"1 m" must be a speed'),
                            ("{hold: 1.5}", '"1.5" must be <= 1'),
                            ("{hold: 0}", '"0" must be > 0'),
                            ("3", "must be a mapping")):
            self.write(patches(2).replace("{slip_rate: 1 mm/s}", given))
            done = self.call("check", "case.yaml", status=2)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(says, done.stderr)
            self.assertIn("analysis.events", done.stderr)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
