#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that are stopped and go on: the file against that of a run that was not stopped.

usage: test_resume.py PROGRAM SOURCE_FOLDER AT_CALL [unittest options]

AT_CALL is the library of tests/stop.
"""

import errno
import fcntl
import json
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4
import numpy as np

PROGRAM, SOURCE, STOP = "", "", ""

# A slope of 64 cells under a load that jumps, to failure: hundreds of steps.
CASE = """\
lacuna: 1
interface: {size: "1 m", levels: 3, domain: {full: {}}}
load:
  normal: {pressure: "3 MPa"}
  pore_pressure: [{step: {value: "0.005 MPa", at: "4 hour"}}]
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "0.1 mm", v0: "1 um/s"}}
initial:
  slip_rate: "1 cm/week"
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 0.5, seed: 2}}}
material: {shear_modulus: "20 GPa", poisson: 0.25, shear_speed: "3 km/s"}
transfer: {hierarchy: {k0: 10 GPa/m, ratio: 0.5}}
time: {end: "30 day", failure: {mean_slip_rate: "10 um/s"}}
solver: {rtol: 1e-7}
analysis: {rg: {critical_fraction: 0.5}}
output:
  every: {time: 10 min, steps: 3}
  fields: [slip, slip_rate, state, traction, factor_of_safety]
  fields_every: {time: 30 min, per_decade: 2}
  checkpoint: {steps: 40, time: 1 hour}
  points: [{name: A, x: 10 cm, y: 90 cm}, {name: B, x: 50 cm, y: 50 cm, radius: 30 cm}]
"""

# Shipped cases made small, and what is set in them: every kind of load with a memory or a file,
# transfer, formulation, method, indicator and way of output.
EVENTS = ["analysis={events: {slip_rate: 1 mm/s}, rg: {critical_fraction: 0.5}}",
          "interface.levels=3"]
FIELDS = ["output.fields=[slip, slip_rate, state, traction]"]
TABLE = {
    "events": ("events.yaml", [*EVENTS, *FIELDS, "time.end=4 s", "output.checkpoint={time: 0.1 s}",
                               "output.fields_every={steps: 40}"]),
    "events, adams": ("events.yaml", [*EVENTS, "time.end=4 s", "solver.method=adams",
                                      "output.checkpoint={steps: 500}"]),
    "floats": ("events.yaml", [*EVENTS, *FIELDS, "time.end=4 s", "output.precision=float",
                               "output.checkpoint={time: 0.1 s}", "output.fields_every={steps: 40}"]),
    "elastic": ("transfer/elastic.yaml", [*FIELDS, "interface.levels=3",
                                          "output.checkpoint={steps: 60}"]),
    "elastic, adams": ("transfer/elastic.yaml",
                       ["interface.levels=3", "solver.method=adams", "solver.projection=true",
                        "solver.formulation=traction", "output.checkpoint={steps: 40}"]),
    "elastic, slip": ("transfer/line.yaml", ["solver.formulation=slip", "output.every=1 day",
                                             "output.checkpoint={per_decade: 3}"]),
    "two directions": ("load/turning.yaml", [*FIELDS, "interface.levels=3",
                                             "output.checkpoint={steps: 25}"]),
    "map": ("friction/map.yaml", [*FIELDS, "output.checkpoint={per_decade: 2}",
                                  "output.every={per_decade: 10}"]),
    "rain, compared": ("load/rain.yaml", ["output.checkpoint={time: 10 day}",
                                          "output.every=1 hour"]),
    "lagged reservoir": ("load/reservoir.yaml", ["solver.method=adams", "solver.formulation=slip",
                                                 "output.checkpoint={steps: 25}"]),
    "diffused reservoir": ("load/reservoir.yaml",
                           ["load.pore_pressure.0={reservoir: {file: ../data/lake.csv, time: date, "
                            "level: 'level_m:m', elevation: '640 m', share: 0.12, distance: '30 m', "
                            "diffusivity: '1e-4 m2/s'}}", "output.checkpoint={steps: 25}"]),
    "record": ("load/record.yaml", ["solver.method=erk", "output.every={steps: 7}",
                                    "output.checkpoint={steps: 100}"]),
    "record, netCDF": ("load/record.yaml",
                       ["load.shear.0={series: {file: RECORD, time: t, value: 'a:m/s2', "
                        "per: 1e5 kg/m2, offset: 1 hour, outside: zero}}",
                        "output.every={steps: 7}", "output.checkpoint={steps: 60}"]),
    "field": ("load/field.yaml", ["output.fields=[slip, pore_pressure]", "output.checkpoint={steps: 12}"]),
    "field, slip": ("load/field.yaml", ["solver.formulation=slip", "output.checkpoint={steps: 12}"]),
    "well": ("load/injection.yaml", ["interface.levels=3", "output.fields=[slip, pore_pressure]",
                                     "output.checkpoint={steps: 15}"]),
    "well in borders": ("load/injection.yaml", ["interface.levels=3", "load.pore_pressure.0.injection.boundary=no-flux",
                                                "output.checkpoint={steps: 15}"]),
    "water table": ("load/water-table.yaml", ["output.checkpoint={time: 60 day}"]),
    "water table, events": ("load/water-table.yaml", ["solver.fidelity=events", "time.end=200 day",
                                                      "output.checkpoint={time: 20 day}"]),
    "fringe": ("load/water-table.yaml", ["load.pore_pressure.0.water_table.fringe=0.5 m",
                                         "output.checkpoint={time: 60 day}"]),
    "normal stress": ("load/normal-stress.yaml", ["output.checkpoint={time: 5 day}"]),
    "shaking": ("load/shaking.yaml", ["solver.formulation=rate", "output.checkpoint={steps: 90}"]),
    "bent base": ("load/chair.yaml", ["output.checkpoint={steps: 60}", "output.every=1 day"]),
    "bent base in a lake": ("load/toe.yaml", ["output.checkpoint={steps: 30}"]),
    "bent base, mass": ("load/chair.yaml", ["inertia={thickness: 50 m}", "output.checkpoint={steps: 60}"]),
    "bridges": ("weakening/bridges.yaml", ["output.checkpoint={steps: 30}", "output.every=1 day"]),
    "dilatancy, traction": ("weakening/dilatancy.yaml", ["solver.formulation=traction", *FIELDS,
                                                         "output.checkpoint={steps: 25}"]),
    "hot water": ("weakening/pressurization.yaml", ["output.fields=[temperature, excess_pore_pressure]",
                                                    "output.checkpoint={steps: 60}"]),
    "dilatancy, erk": ("weakening/dilatancy.yaml", ["solver.method=erk", "output.checkpoint={steps: 12}"]),
    "anchored block": ("bridge.yaml", ["output.checkpoint={steps: 500}", "output.every=1 day"]),
}

# Of the summary, what is the process's own.
OWN_JSON = {"wall_time_s", "cpu_time_s", "peak_memory_bytes", "output", "resumed_at_s",
            "resumed_from"}

# Of the file's own making, or of how long it took.
OWN = {"history", "date_created", "date_modified", "wall_time_s", "resumed", "case"}


def kinds(which, few="LACUNA_SANITIZED" in os.environ):
    """Of the table all, or a third where each takes long: tests of another `which` take the others."""
    every = list(TABLE.items())
    return every[which::3] if few else every


def contents(path):
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        values = {name: variable[...].tobytes() for name, variable in file.variables.items()}
        attributes = {name: file.getncattr(name) for name in file.ncattrs() if name not in OWN}
    return values, attributes


class Resume(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        with open(self.path("c.yaml"), "w", encoding="utf-8") as file:
            file.write(CASE)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *words, case="c.yaml", **more):
        return subprocess.Popen([PROGRAM, "run", case, *words, "--no-progress"], cwd=self.folder,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)

    def run_case(self, status, *words, **more):
        process = self.start(*words, **more)
        out, err = process.communicate(timeout=200)
        self.assertEqual(process.returncode, status, err)
        if status in (1, 2, 3):
            self.assertEqual(err.count("\n"), 1, err)
        return out, err

    def stop(self, number, after, *words, **more):
        """Starts a run and stops it after some seconds: how it ended, 0 where it was faster."""
        process = self.start(*words, **more)
        try:
            process.communicate(timeout=after)
        except subprocess.TimeoutExpired:
            process.send_signal(number)
        process.communicate(timeout=60)
        # A signal before there is anything to close ends the program as any other.
        self.assertIn(process.returncode, (0, 4, -number))
        return process.returncode

    def same(self, one, other):
        a, b = contents(self.path(one)), contents(self.path(other))
        self.assertEqual(list(a[0]), list(b[0]))
        for name in a[0]:
            self.assertEqual(a[0][name], b[0][name], name)
        self.assertEqual({k: str(v) for k, v in a[1].items()},
                         {k: str(v) for k, v in b[1].items()})

    def begin_or_resume(self):
        """A kill may have come before the first checkpoint."""
        there = os.path.exists(self.path("out.nc.checkpoint"))
        return "--resume" if there and self.is_unfinished() else "--force"

    def stop_anywhere(self, number, method, formulation):
        """Stops a run wherever it is, twice where that can be, and compares in the end."""
        words = ["-q", "--set", "solver.method=" + method,
                 "--set", "solver.formulation=" + formulation]
        if formulation == "inertia":
            words += ["--set", "inertia.mass_per_area=5e5 kg/m2"]
        self.compare_stopped(number, words, method + formulation)

    def compare_stopped(self, number, words, seed):
        chance = random.Random(seed)
        began = time.time()
        self.run_case(0, "-o", "whole.nc", "--force", *words)
        took = time.time() - began
        for _ in range(2):
            after = took * chance.uniform(0.2, 0.8)
            if self.stop(number, after, "-o", "out.nc", self.begin_or_resume(), *words) == 0:
                break
        else:
            self.run_case(0, "-o", "out.nc", self.begin_or_resume(), *words)
        self.same("whole.nc", "out.nc")
        self.assertEqual(sorted(os.listdir(self.folder)), ["c.yaml", "out.nc", "whole.nc"])

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_killed_or_ended_at_any_moment(self):
        for method, formulation in (("bdf", "rate"), ("bdf", "slip"), ("adams", "slip"),
                                    ("erk", "traction"), ("bdf", "inertia")):
            for number in (signal.SIGKILL, signal.SIGTERM):
                with self.subTest(method=method, formulation=formulation, signal=number):
                    self.setUp()
                    self.stop_anywhere(number, method, formulation)

    def test_cells_at_their_own_steps(self):
        """Also where each cell has a time of its own, which a checkpoint makes one again."""
        words = ["-q", "--set", "solver.fidelity=events", "--set", "output.checkpoint={steps: 5}",
                 "--set", "transfer={hierarchy: {k0: 20 MPa/m, ratio: 0.5}}"]
        for number in (signal.SIGKILL, signal.SIGTERM):
            with self.subTest(signal=number):
                self.setUp()
                self.compare_stopped(number, words, "events")

    def start_at_call(self, at, *words, **more):
        """A run to which something happens at a call that changes a file."""
        options = os.environ.get("ASAN_OPTIONS", "")
        environment = {**os.environ, "LD_PRELOAD": STOP, "AT_CALL": at,
                       "AT_CALL_LOG": self.path("log") if at.startswith("0:") else "/dev/null",
                       "ASAN_OPTIONS": options + ":verify_asan_link_order=0"}
        return self.start(*words, env=environment, **more)

    def start_to_stop(self, count, number, *words, **more):
        """A run that gets a signal as soon as it has made so many checkpoints."""
        return self.start_at_call(f"{count}:signal={number}:rename:.checkpoint", *words, **more)

    def kill_after_checkpoints(self, count, *words, **more):
        process = self.start_to_stop(count, int(signal.SIGKILL), *words, **more)
        _, err = process.communicate(timeout=200)
        self.assertEqual(process.returncode, -signal.SIGKILL, "fewer checkpoints: " + err)

    def is_unfinished(self):
        """The kill may have come when all was done but the process's own end."""
        try:
            with netCDF4.Dataset(self.path("out.nc")) as file:
                return file.status != "complete"
        except OSError:
            return False  # half closed

    def summary(self, *words, **more):
        out, _ = self.run_case(0, *words, "--json", **more)
        return {key: value for key, value in json.loads(out).items() if key not in OWN_JSON}

    def write_record(self):
        t = np.arange(0, 20, 0.01)
        with netCDF4.Dataset(self.path("record.nc"), "w") as data:
            data.createDimension("t", t.size)
            data.createVariable("t", "f8", ("t",))[:] = t
            data["t"].units = "s"
            data.createVariable("a", "f8", ("t",))[:] = np.sin(9 * t) * np.exp(-((t - 8) / 4)**2)
            data["a"].units = "m/s2"

    def killed_is_same(self, case, settings):
        """A run killed in two places, against one that was not."""
        more = {"case": os.path.join(SOURCE, "cases", case)}
        settings = [setting.replace("RECORD", self.path("record.nc")) for setting in settings]
        words = [word for setting in settings for word in ("--set", setting)]
        whole = self.summary("-o", "whole.nc", *words, **more)
        self.kill_after_checkpoints(2, "-o", "out.nc", "-q", *words, **more)
        self.kill_after_checkpoints(1, "-o", "out.nc", "-q", "--resume", *words, **more)
        self.assertEqual(whole, self.summary("-o", "out.nc", "--resume", *words, **more))
        self.same("whole.nc", "out.nc")
        with netCDF4.Dataset(self.path("out.nc")) as file:
            self.assertRegex(file.resumed, "^planned checkpoint at [0-9.e+-]+ s")

    def test_every_kind_goes_on_to_the_bit(self):
        for name, (case, settings) in kinds(0):
            with self.subTest(name):
                self.setUp()
                self.write_record()
                self.killed_is_same(case, settings)

    def fill_disk(self, limit, *words, **more):
        def set_limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        return self.run_case(3, "-q", "-o", "out.nc", *words, preexec_fn=set_limit, **more)

    def is_beginning_of_whole(self, grows=("time", "snapshot")):
        """What a full disk left can be read, and says what the whole run's file says."""
        with netCDF4.Dataset(self.path("whole.nc")) as whole, \
                netCDF4.Dataset(self.path("out.nc")) as part:
            self.assertEqual(part.status, "failed")
            self.assertGreater(len(part.dimensions[grows[0]]), 10 if grows[0] == "time" else 0)
            for name, variable in part.variables.items():
                if variable.dimensions[:1] and variable.dimensions[0] in grows:
                    for file in whole, part:
                        file[name].set_auto_mask(False)  # a value that is missing differs
                    np.testing.assert_array_equal(variable[...], whole[name][:len(variable)], name)

    def test_full_disk(self):
        self.run_case(0, "-q", "-o", "whole.nc")
        # A megabyte beyond what is written must be free at any time.
        size = os.path.getsize(self.path("whole.nc"))
        full = "^lacuna: [^ ]*out.nc: cannot write: File too large\n$"
        _, err = self.fill_disk((1 << 20) + size * 19 // 20)
        self.assertRegex(err, full)
        self.is_beginning_of_whole()
        # Going on takes room for both files; where there is none nothing is lost.
        files = {name: self.bytes_of(name) for name in ("out.nc", "out.nc.checkpoint")}
        _, err = self.fill_disk(size // 2, "--resume")
        self.assertRegex(err, full)
        self.assertEqual({name: self.bytes_of(name) for name in files}, files)
        self.run_case(0, "-q", "-o", "out.nc", "--resume")
        self.same("whole.nc", "out.nc")
        self.assertEqual(sorted(os.listdir(self.folder)), ["c.yaml", "out.nc", "whole.nc"])

    def test_full_disk_leaves_no_half_of_a_snapshot(self):
        """The journal, which is not deflated, comes to the limit before the file does."""
        words = ["--set", "interface.levels=9", "--set", "interface.domain.cascade.dimension=1.8", "--until", "10 minute",
                 "--set", "output.fields=[slip, slip_rate, state, traction]", "--set", "output.fields_every={steps: 1}"]
        case = os.path.join(SOURCE, "cases/transfer/hierarchy.yaml")
        self.run_case(0, "-q", "-o", "whole.nc", *words, case=case)
        for limit in (9000, 10000, 14000):
            self.fill_disk(limit << 10, "--force", *words, case=case)
            self.is_beginning_of_whole(("snapshot",))

    def write_forced(self):
        """A case that plans nothing, long enough to be stopped in its midst."""
        text = "\n".join(line for line in CASE.splitlines() if "checkpoint" not in line)
        text = text.replace("every: {time: 10 min, steps: 3}", "every: 1 s")
        with open(self.path("f.yaml"), "w", encoding="utf-8") as file:
            file.write(text)

    def test_forced_within_tolerance(self):
        self.write_forced()
        began = time.time()
        self.run_case(0, "-q", "-o", "whole.nc", case="f.yaml")
        took = time.time() - began
        share = 0.5
        while self.stop(signal.SIGTERM, share * took, "-o", "out.nc", "-q", "--force",
                        case="f.yaml") != 4:
            share = 0.1 + 0.8 * random.random()
        out, _ = self.run_case(0, "-o", "out.nc", "--resume", "--json", case="f.yaml")
        self.assertEqual(json.loads(out)["resumed_from"], "forced")
        with netCDF4.Dataset(self.path("whole.nc")) as a, \
                netCDF4.Dataset(self.path("out.nc")) as b:
            self.assertRegex(b.resumed, r"^forced checkpoint at [0-9.e+]+ s$")
            self.assertEqual(b.status, "complete")
            self.assertEqual(len(b.history.splitlines()), 2)
            self.assertLess(abs(a.failure_time_s / b.failure_time_s - 1), 1e-5)
            n = len(a["time"]) - 2
            np.testing.assert_array_equal(a["time"][:n], b["time"][:n])
            np.testing.assert_allclose(a["slip"][1:n], b["slip"][1:n], rtol=1e-3)
        self.assertFalse(os.path.exists(self.path("out.nc.checkpoint")))

    def refused(self, status, line, *words):
        _, err = self.run_case(status, "-q", *words)
        self.assertRegex(err, "^lacuna: " + line + "\n$")

    def test_refused_without_a_run_to_go_on(self):
        self.refused(3, "--resume: none.nc: No such file or directory", "--resume", "-o", "none.nc")
        self.run_case(0, "-q", "-o", "whole.nc")
        self.refused(2, "--resume: whole.nc is complete", "--resume", "-o", "whole.nc")
        self.refused(2, "--resume keeps the file, --force replaces it: not both", "--resume",
                     "--force", "-o", "whole.nc")
        with open(self.path("text.nc"), "w", encoding="utf-8") as file:
            file.write("text")
        self.refused(3, "text.nc: is not a netCDF file", "--resume", "-o", "text.nc")

    def bytes_of(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def refused_with(self, status, line, name, content):
        """Another content of a file is refused; then the file is what it was."""
        was = self.bytes_of(name)
        with open(self.path(name), "wb") as file:
            file.write(content)
        self.refused(status, line, "--resume", "-o", "out.nc")
        with open(self.path(name), "wb") as file:
            file.write(was)

    def test_refused_checkpoints(self):
        self.kill_after_checkpoints(3, "-o", "out.nc", "-q")
        older = self.bytes_of("out.nc")
        self.kill_after_checkpoints(3, "-o", "out.nc", "-q", "--resume")
        go_on = ["--resume", "-o", "out.nc"]
        self.refused(2, "--resume: out.nc was begun with another case: it said friction: "
                     "a: 0.01, now friction: a: 0.011", *go_on, "--set", "friction.aging.a=0.011")
        self.refused(2, "--resume: the checkpoint of out.nc is at .*, not before the end of the run",
                     *go_on, "--until", "1 s")
        saved = self.bytes_of("out.nc.checkpoint")
        named = "[^ ]*out.nc.checkpoint: "
        for status, line, content in (
                (3, "is damaged: differs from its checksum",
                 saved[:1000] + bytes([saved[1000] ^ 1]) + saved[1001:]),
                (3, f"is damaged: {len(saved) // 2} bytes of {len(saved)}",
                 saved[:len(saved) // 2]),
                (3, "is not a checkpoint of Lacuna", b""),
                (3, "is not a checkpoint of Lacuna", b"CDF" + saved[3:]),
                (2, "is a checkpoint of another version of Lacuna: its format is '1', '2' is read "
                 "here", saved[:7] + b"1" + saved[8:])):
            self.refused_with(status, named + line, "out.nc.checkpoint", content)
        os.remove(self.path("out.nc.journal"))  # with it the older file too has all records
        self.refused_with(2, "[^ ]*out.nc: is older than its checkpoint: [0-9]+ records of [0-9]+",
                          "out.nc", older)
        with netCDF4.Dataset(self.path("out.nc"), "a") as file:
            made = file.date_created
            file.date_created = "2001-02-03T04:05:06Z"
        self.refused(2, f"[^ ]*out.nc: its checkpoint is of another run, begun {made}", *go_on)
        os.remove(self.path("out.nc.checkpoint"))
        self.refused(2, "out.nc: has no checkpoint to go on from", *go_on)

    def test_refused_where_a_file_has_changed(self):
        for name in ("load/record.yaml", "data/shaking.csv"):
            os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
            shutil.copy(os.path.join(SOURCE, "cases", name), self.path(name))
        words = ["-o", "out.nc", "-q", "--set", "output.checkpoint={steps: 50}"]
        more = {"case": "load/record.yaml"}
        self.kill_after_checkpoints(2, *words, **more)
        with open(self.path("data/shaking.csv"), "a", encoding="utf-8") as file:
            file.write("20.00,0.0\n")
        _, err = self.run_case(2, "--resume", *words, **more)
        self.assertRegex(err, "^lacuna: --resume: out.nc was begun with another case: it said "
                         "files: shaking.csv: [0-9a-f]{16}, now files: shaking.csv: [0-9a-f]{16}\n$")
        _, err = self.run_case(2, "-o", "data/shaking.csv", "--force", **more)
        self.assertRegex(err, "data/shaking.csv: is read by this case, must not be the output")

    def hold(self, *words, at="rename:.checkpoint", **more):
        """A run that stands still once it has made a checkpoint, or such another call."""
        process = self.start_at_call(f"1:signal={int(signal.SIGSTOP)}:{at}", *words, **more)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        os.waitid(os.P_PID, process.pid, os.WSTOPPED)
        return process

    def test_refused_while_another_process_writes(self):
        process = self.hold("-o", "out.nc", "-q")
        self.refused(3, "out.nc: another process is writing it", "--resume", "-o",
                     "out.nc")
        self.refused(3, "out.nc: cannot replace: another process is writing it", "--force", "-o",
                     "out.nc")
        # What becomes of the file of a run that has lost its name must not be taken for another's.
        os.remove(self.path("out.nc"))
        process.send_signal(signal.SIGCONT)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 3)
        self.assertRegex(err, "^lacuna: .*out.nc: was replaced or removed while it was being "
                         "written\n$")

    def go_on_and_fail(self, process, line):
        process.send_signal(signal.SIGCONT)
        _, err = process.communicate(timeout=60)
        self.assertIn(process.returncode, (2, 3), err)
        self.assertRegex(err, f"^lacuna: [^ ]*out.nc: {line}\n$")

    def test_a_file_that_is_taken_away_or_replaced(self):
        """Also without a checkpoint that looks for it: by the end at the latest."""
        self.write_forced()
        for replaced in (False, True):
            process = self.hold("-o", "out.nc", "-q", "--force", at="write:.nc.journal",
                                case="f.yaml")
            os.remove(self.path("out.nc"))
            if replaced:
                shutil.copy(self.path("f.yaml"), self.path("out.nc"))
            self.go_on_and_fail(process, "was replaced or removed while it was being written")
            if replaced:
                self.assertEqual(self.bytes_of("out.nc"), self.bytes_of("f.yaml"))

    def test_one_of_several_runs_of_a_name(self):
        """--force of a name that was free replaces nothing that has come since, nor the other way."""
        for before in (False, True):
            if before:
                self.run_case(0, "-q", "-o", "out.nc", "--force")
            process = self.hold("-o", "out.nc", "-q", "--force", at="open:.part")
            self.run_case(0, "-q", "-o", "out.nc", "--force", "--until", "1 day")
            mine = self.bytes_of("out.nc")
            self.go_on_and_fail(process, "was replaced meanwhile by another process")
            self.assertEqual(self.bytes_of("out.nc"), mine)

    def test_a_close_that_fails_is_one_line(self):
        """netCDF breaks down over it."""
        failed = 0
        for k in range(1, 7):
            process = self.start_at_call(f"{k}:fail=5:close", "-o", "out.nc", "-q", "--force",
                                         "--set", "output={every: 1 hour}")
            _, err = process.communicate(timeout=60)
            if process.returncode != 0:
                failed += 1
                self.assertEqual(process.returncode, 3, err)
                self.assertRegex(err, "^lacuna: [^ ]*out.nc[^\n]*\n$")
        self.assertGreater(failed, 0)

    def test_a_link_that_leads_nowhere(self):
        os.symlink("nowhere.nc", self.path("link.nc"))
        self.refused(3, "link.nc: is a link to a file that does not exist", "-o", "link.nc")
        self.assertEqual(sorted(os.listdir(self.folder)), ["c.yaml", "link.nc"])

    def call(self, *words):
        done = subprocess.run([PROGRAM, *words], cwd=self.folder, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def entries(self):
        """Where the entries of the journal begin, after what the file held: docs/format.md."""
        data = self.bytes_of("out.nc.journal")
        owner, base = struct.unpack("<QQ", data[8:24])
        at, found = 32 + owner + base, []
        while at + 96 <= len(data):
            found.append(at)
            at += 96 + struct.unpack("<Q", data[at + 8:at + 16])[0]
        self.assertEqual(at, len(data))
        self.assertGreater(len(found), 40)
        return found, len(data)

    def flip(self, name, at):
        with open(self.path(name), "r+b") as file:
            file.seek(at)
            byte = file.read(1)[0]
            file.seek(at)
            file.write(bytes([byte ^ 64]))

    def damaged(self, end):
        """A reader's line of a damaged journal: the byte and how many are not read."""
        err = self.call("report", "out.nc", "--force").stderr
        line = ("^lacuna: warning: out.nc.journal: is damaged: its last ([0-9]+) bytes, from byte "
                f"([0-9]+) on, cannot be read; out.nc is read {end}, which may lack what was "
                "synced\n$")
        self.assertRegex(err, line)
        unread, at = (int(word) for word in re.match(line, err).groups())
        return at, unread

    def records(self):
        with netCDF4.Dataset(self.path("out.nc")) as file:
            return len(file["time"])

    def mend_refused(self, *has):
        """Nothing changes then."""
        files = {name: self.bytes_of(name) for name in ("out.nc", "out.nc.journal")}
        done = subprocess.run([PROGRAM, "mend", "out.nc"], cwd=self.folder, capture_output=True,
                              text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (3, ""), done.stderr)
        self.assertRegex(done.stderr, "^lacuna: out.nc.journal: is damaged: .*; it gives [0-9]+ "
                         f"records, out.nc {has[0]}, nothing is changed\n$")
        for name, was in files.items():
            self.assertEqual(self.bytes_of(name), was)

    def test_damage_in_a_journal_is_no_torn_end(self):
        """The file itself has all records: it is read, and mend does not make it less."""
        self.run_case(0, "-q", "-o", "whole.nc")
        self.kill_after_checkpoints(3, "-o", "out.nc", "-q")
        found, size = self.entries()
        middle = found[len(found) // 2]
        n = self.records()
        # A value, a size that goes past the end, one within, a mark of a sync; what it begins with.
        for at, first in ((middle + 110, middle), (middle + 13, middle), (middle + 8, middle),
                          (found[-1] + 3, found[-1]), (1000, 0), (3, 0)):
            with self.subTest(at=at - middle):
                self.flip("out.nc.journal", at)
                self.assertEqual(self.damaged("without it"), (first, size - first))
                self.mend_refused(f"shows {n} as it is")
                self.flip("out.nc.journal", at)
        self.flip("out.nc.journal", middle + 110)
        checkpoint = self.bytes_of("out.nc.checkpoint")
        left = {name: self.bytes_of(name) for name in ("out.nc", "out.nc.journal")}
        self.run_case(0, "-q", "-o", "out.nc", "--resume")
        self.same("whole.nc", "out.nc")
        for name, was in {**left, "out.nc.checkpoint": checkpoint}.items():
            with open(self.path(name), "wb") as file:
                file.write(was)
        self.flip("out.nc", 44)  # now netCDF does not open the file
        self.assertEqual(self.damaged("up to there"), (middle, size - middle))
        self.refused(2, "[^ ]*out.nc: lacks what its checkpoint counts on, its journal being "
                     "damaged: [0-9]+ records of [0-9]+", "--resume", "-o", "out.nc")
        done = self.call("mend", "out.nc")
        self.assertEqual(done.stdout, "out.nc: mended (running)\n")
        self.assertRegex(done.stderr, f"out.nc.journal: is damaged: its last {size - middle} bytes, "
                         f"from byte {middle} on, .*; its journal is kept\n$")
        self.assertEqual(self.bytes_of("out.nc.journal"), left["out.nc.journal"])
        self.assertLess(0, self.records())
        self.assertLess(self.records(), n)

    def test_torn_end_of_a_journal_is_no_damage(self):
        """As much of the last write as got there, whatever that is."""
        self.kill_after_checkpoints(2, "-o", "out.nc", "-q")
        found, size = self.entries()
        data = self.bytes_of("out.nc.journal")
        for end in (size - 1, size - 95, found[-2] + 100, found[-2] + 96, found[-2] + 1, found[-2]):
            with open(self.path("out.nc.journal"), "wb") as file:
                file.write(data[:end])
            self.assertIn("all that it left is read", self.call("report", "out.nc",
                                                                   "--force").stderr)

    def test_mend_leaves_a_journal_of_another_file(self):
        """It may be wanted elsewhere; without its own the file is read as HDF5 left it."""
        self.kill_after_checkpoints(2, "-o", "other.nc", "-q", "--until", "20 day")
        self.kill_after_checkpoints(2, "-o", "out.nc", "-q")
        left = self.bytes_of("out.nc")
        shutil.copy(self.path("other.nc.journal"), self.path("out.nc.journal"))
        self.assertEqual(self.call("mend", "out.nc").stdout,
                         "out.nc: is whole, nothing to mend (running)\n")
        self.assertEqual(self.bytes_of("out.nc.journal"), self.bytes_of("other.nc.journal"))
        self.assertEqual(self.bytes_of("out.nc"), left)

    def test_copies_of_a_private_file_are_private(self):
        self.kill_after_checkpoints(2, "-o", "out.nc", "-q")
        os.chmod(self.path("out.nc"), 0o640)
        process = self.hold("-o", "out.nc", "-q", "--resume", at="open:.part")
        copies = [name for name in os.listdir(self.folder) if ".mended.lacuna-" in name]
        self.assertEqual([os.stat(self.path(name)).st_mode & 0o777 for name in copies], [0o600])
        process.kill()
        self.call("mend", "out.nc")
        self.assertEqual(os.stat(self.path("out.nc")).st_mode & 0o777, 0o640)

    def test_a_lock_on_the_folder_stops_nobody(self):
        """Not even where the whole command runs under it."""
        folder = os.open(self.folder, os.O_RDONLY)
        self.addCleanup(os.close, folder)
        fcntl.flock(folder, fcntl.LOCK_EX)
        self.run_case(0, "-q", "-o", "out.nc", "--until", "1 day")
        self.run_case(0, "-q", "-o", "out.nc", "--until", "1 day", "--force")
        # Another one that is about to give the same name.
        with open(self.path("out.nc"), "r+b") as file:
            fcntl.lockf(file, fcntl.LOCK_EX)
            self.refused(3, "[^ ]*out.nc: cannot create: another process is writing there",
                         "-o", "out.nc", "--until", "1 day", "--force")

    def test_file_system_without_locks(self):
        environment = {**os.environ, "LD_PRELOAD": STOP, "HDF5_USE_FILE_LOCKING": "FALSE",
                       "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "")
                       + ":verify_asan_link_order=0"}
        for reason in (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP):
            self.run_case(0, "-q", "-o", "out.nc", "--until", "1 day", "--force", env={
                **environment, "AT_CALL": f"1:fail={reason}:flock:.part"})
        _, err = self.run_case(3, "-q", "-o", "out.nc", "--until", "1 day", "--force", env={
            **environment, "AT_CALL": f"1:fail={errno.EWOULDBLOCK}:flock:.part"})
        self.assertRegex(err, "^lacuna: [^ ]*out.nc.journal: another process is writing it\n$")

    def test_killed_while_closing(self):
        self.start_at_call("0:kill", "-q", "-o", "whole.nc").communicate(timeout=200)
        with open(self.path("log"), encoding="utf-8") as file:
            synced = sum(" fsync " in line and line.endswith(".part\n") for line in file)
        process = self.start_at_call(f"{synced}:kill:fsync:.part", "-q", "-o", "out.nc")
        process.communicate(timeout=200)
        self.assertEqual(process.returncode, -signal.SIGKILL)
        left = self.bytes_of("out.nc")
        err = self.call("report", "out.nc").stderr
        self.assertRegex(err, "^lacuna: warning: out.nc: .*; lacuna mend out.nc [^\n]*\n$")
        self.assertEqual(self.bytes_of("out.nc"), left)  # who reads a file does not change it
        self.run_case(0, "-q", "-o", "out.nc", "--resume")
        self.same("whole.nc", "out.nc")
        self.refused(2, "--resume: out.nc is complete", "--resume", "-o", "out.nc")
        self.assertEqual(self.call("mend", "out.nc").stdout,
                         "out.nc: is whole, nothing to mend (complete)\n")

    def test_reserve_is_given_back_before_hdf5_closes(self):
        """Giving it back takes long, and in HDF5's hands it parts a cut from what is said of it."""
        self.start_at_call("0:kill", "-o", "out.nc", "-q").communicate(timeout=200)
        with open(self.path("log"), encoding="utf-8") as file:
            lines = [line.split() for line in file]
        synced = [i for i, words in enumerate(lines) if words[:2] == ["synced", "time"]]
        # Of all values, and of what is known in the end: HDF5 cuts the file in the second.
        closing = [words[1] for words in lines[synced[-2]:synced[-1]] if words[0].isdigit()]
        self.assertEqual(closing[0], "ftruncate")
        self.assertIn("write", closing[1:])

    def test_end_and_most_steps_may_change(self):
        self.run_case(0, "-q", "-o", "whole.nc")
        self.run_case(1, "-q", "-o", "out.nc", "--set", "solver.max_steps=100")
        self.run_case(0, "-q", "-o", "out.nc", "--resume", "--threads", "2")
        self.same("whole.nc", "out.nc")


def main():
    global PROGRAM, SOURCE, STOP
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    SOURCE = os.path.abspath(sys.argv.pop(1))
    STOP = os.path.abspath(sys.argv.pop(1))
    unittest.main()


if __name__ == "__main__":
    main()
