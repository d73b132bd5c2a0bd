#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is left where a program is killed, or a file call fails, at each of its file calls in turn.

usage: test_every_call.py PROGRAM SOURCE_FOLDER AT_CALL [unittest options]
       test_every_call.py PROGRAM SOURCE_FOLDER AT_CALL --step N
       test_every_call.py PROGRAM SOURCE_FOLDER AT_CALL --all [SCENE ...]

AT_CALL is the library of tests/stop. With --all every command and every way to fail, which takes an
hour, and counts; else a run with checkpoints, killed and torn, at every call, or every N-th.

After each of them the output is absent or the one that was there before; or it opens in netCDF4 with
all that was synced; or Lacuna reads it with all that was synced, says so in one line that names
`lacuna mend`, and that makes it such a file. Where a checkpoint is there, `--resume` goes on to the
same bits.
"""

import collections
import multiprocessing
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import netCDF4

from test_resume import CASE, OWN

PROGRAM, SOURCE, LIBRARY, STEP = "", "", "", 1
EIO, ENOSPC = 5, 28
ALL_WAYS = ["kill", "tear", f"fail={EIO}", f"fail={ENOSPC}", f"full={ENOSPC}"]

# The cascade of the first step of a history.
CASCADE = ["rg", "out.nc", "-o", "cascade.nc", "--set", "rg.friction=0.6", "--snapshot", "0"]

GROWING = ("time", "step", "snapshot", "event")

# The slope of test_resume.py, smaller.
RUN = CASE[:CASE.index("analysis:")].replace("levels: 3", "levels: 2").replace("1e-7", "1e-5")
CHECKPOINTS = """\
output: {every: {steps: 2}, checkpoint: {steps: 110}}
"""
FIELDS = """\
analysis: {rg: {critical_fraction: 0.5}, events: {slip_rate: 1 um/s}}
output:
  every: {steps: 1}
  fields: [slip, slip_rate]
  fields_every: {steps: 20}
"""

# What a command does: its words, its output, what made the folder as it is before.
Scene = collections.namedtuple("Scene", "words output before stopped", defaults=(None, None))


def bundled(name):
    return os.path.join(SOURCE, "cases", name)


def scenes():
    run = ["run", "run.yaml", "-o", "out.nc"]
    joint = ["--set", "interface.levels=4", "-o", "out.nc"]
    sweep = ["sweep", bundled("block.yaml"), "--over", "friction.aging.dc=0.1 m, 0.2 m", "--jobs", "1"]
    return {
        "run": Scene(["run", "fields.yaml", "-o", "out.nc"], "out.nc"),
        "run, checkpoints": Scene(run, "out.nc"),
        "run --force": Scene([*run, "--force"], "out.nc", [*run, "--set", "time.end=1 day"]),
        "run --resume": Scene([*run, "--resume"], "out.nc", run, "2:kill:rename:.checkpoint"),
        "run --resume, torn": Scene([*run, "--resume"], "out.nc", run, "100:tear"),
        "contact": Scene(["contact", bundled("contact/self-affine.yaml"), *joint], "out.nc"),
        "contact, history": Scene(["contact", bundled("shear-cycle.yaml"), *joint], "out.nc"),
        "rg": Scene(["rg", bundled("rg/rough-joint.yaml"), *joint], "out.nc"),
        "precursors": Scene(["precursors", bundled("data/creep.csv"), "--displacement",
                             "disp_mm:mm", "-o", "out.nc"], "out.nc"),
        "fit": Scene(["fit", bundled("fit/block.yaml"), bundled("data/creep.csv"), "--set",
                      "fit.steps=0", "-o", "out.nc"], "out.nc"),
        "trade": Scene(["trade", bundled("block.yaml"), "--dials", "rtol=1e-3:1e-4", "--jobs", "1",
                        "-o", "out.nc"], "out.nc"),
        "sweep": Scene([*sweep, "-o", "out.nc"], "out.nc"),
        "gather": Scene(["gather", "part.nc", "-o", "out.nc"], "out.nc", [*sweep, "-o", "part.nc"]),
        "export": Scene(["export", "done.nc", "--variable", "slip", "-o", "out.csv"], "out.csv",
                        ["run", "run.yaml", "-o", "done.nc"]),
        "report": Scene(["report", "done.nc", "-o", "out.html"], "out.html",
                        ["run", "run.yaml", "-o", "done.nc"]),
        "new": Scene(["new", "out"], "out.yaml"),
    }


def fill(folder):
    for name, output in (("run.yaml", CHECKPOINTS), ("fields.yaml", FIELDS)):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(RUN + output)


def call(folder, words, at=None):
    """Runs the program, with something done at a file call: its status and its lines of error."""
    environment = dict(os.environ)
    if at is not None:
        environment.update(LD_PRELOAD=LIBRARY, AT_CALL=at, AT_CALL_UNDER=folder,
                           AT_CALL_LOG=os.path.join(folder, "log"),
                           ASAN_OPTIONS=os.environ.get("ASAN_OPTIONS", "")
                           + ":verify_asan_link_order=0")
    done = subprocess.run([PROGRAM, *words], cwd=folder, env=environment, capture_output=True,
                          text=True, timeout=300, check=False)
    return done.returncode, done.stderr


def log(folder, until=None):
    """How many calls there were, and what had been synced by then along each dimension.

    What a sync says after a call that failed is no promise: the program has ended by then.
    """
    calls, synced = 0, {}
    path = os.path.join(folder, "log")
    if os.path.exists(path):
        with open(path, encoding="utf-8") as file:
            for line in file:
                words = line.split()
                if words[0] == "synced":
                    if until is None or calls < until:
                        synced[words[1]] = int(words[2])
                else:
                    calls = max(calls, int(words[0]))
        os.remove(path)
    return calls, synced


def read(path):
    """All that a file holds: {name: (dimensions, values)} and its attributes."""
    if not path.endswith(".nc"):
        with open(path, "rb") as file:
            text = re.sub(rb'"made":"[^"]*"', b"", file.read())  # when a page was made
            return {"bytes": ((), text)}, {}
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        return ({name: (v.dimensions, v[...]) for name, v in file.variables.items()},
                {name: str(file.getncattr(name)) for name in file.ncattrs() if name not in OWN})


def read_safely(path):
    """The same from a process of its own, which a damaged file may break; None where it does."""
    come, go = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            signal.alarm(20)
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            with os.fdopen(go, "wb") as pipe:
                pickle.dump(read(path), pipe)
        finally:
            os._exit(0)
    os.close(go)
    with os.fdopen(come, "rb") as pipe:
        data = pipe.read()
    os.waitpid(child, 0)
    try:
        return pickle.loads(data)
    except (EOFError, pickle.UnpicklingError):
        return None


def values_of(value):
    texts = not isinstance(value, bytes) and value.dtype == object
    return repr(value.tolist()) if texts else value if isinstance(value, bytes) else value.tobytes()


def same(one, other, but=()):
    return (one is not None and list(one[0]) == list(other[0]) and
            all(values_of(one[0][name][1]) == values_of(other[0][name][1])
                for name in one[0] if name not in but) and
            {k: v for k, v in one[1].items() if k not in but} ==
            {k: v for k, v in other[1].items() if k not in but})


def begins(part, whole, synced):
    """Whether a file holds what the whole one begins with, at least as far as it was synced."""
    if part is None or list(part[0]) != list(whole[0]):
        return False
    for name, (dims, values) in part[0].items():
        full = whole[0][name][1]
        if dims[:1] and dims[0] in GROWING:
            n = synced.get(dims[0], 0)
            if len(values) < n or values[:n].tobytes() != full[:n].tobytes():
                return False
        elif not dims or values.tobytes() != full.tobytes():
            # What is of one value is known only in the end.
            if dims:
                return False
    return True


class Study:
    """One scene: its whole output, the folder before it, and how many file calls it makes."""

    def __init__(self, name, scene):
        self.name, self.scene = name, scene
        self.base = tempfile.mkdtemp()
        fill(self.base)
        self.synced = {}
        if scene.before is not None:
            call(self.base, scene.before, scene.stopped)
            self.synced = log(self.base)[1]
        whole = self.copy()
        words = [word for word in scene.words if word != "--resume"]
        status, err = call(whole, [*words, "--force"] if scene.before else words, "0:kill")
        assert status == 0, err
        self.whole = read(os.path.join(whole, scene.output))
        log(whole)
        shutil.rmtree(whole)
        again = self.copy()
        status, err = call(again, scene.words, "0:kill")
        assert status == 0, err
        self.calls = log(again)[0]
        self.listing = sorted(os.listdir(again))
        shutil.rmtree(again)
        old = os.path.join(self.base, scene.output)
        self.old = read_safely(old) if os.path.exists(old) else None
        # Of a trade, what follows from measured costs is each trade's own.
        self.but = set(self.whole[0]) - {"end", "value"} | set(self.whole[1]) \
            if name == "trade" else set()

    def copy(self):
        return shutil.copytree(self.base, tempfile.mkdtemp(), dirs_exist_ok=True)

    def close(self):
        shutil.rmtree(self.base)

    def is_run(self):
        return self.scene.words[0] == "run"

    def look(self, folder, synced):
        """What there is after a stop: (what it is, what is wrong with it or None)."""
        path = os.path.join(folder, self.scene.output)
        if not os.path.exists(path):
            fresh = not os.path.exists(os.path.join(self.base, self.scene.output))
            return "absent", None if fresh and not any(synced.values()) else "the output is gone"
        found = read_safely(path)
        if same(found, self.whole, self.but):
            return "whole", None
        broke = {"trade": lambda values: set(values["end"][1]) != {"done"},
                 "sweep": lambda values: any(values["message"][1])}.get(self.name)
        if broke and found is not None and list(found[0]) == list(self.whole[0]) and broke(found[0]):
            return "a run broke, and it says so", None
        if self.old is not None and not any(synced.values()) and same(found, self.old, self.but):
            return "as before", None
        if not self.is_run() and self.name != "contact, history":
            return "wrong", "the output is neither whole nor what it was"
        if begins(found, self.whole, synced):
            return "opens in netCDF4", None
        return "read by Lacuna", self.look_by_lacuna(folder, synced)

    def look_by_lacuna(self, folder, synced):
        words = ["report", "out.nc", "-o", "page.html"] if self.is_run() else CASCADE
        status, err = call(folder, words)
        # A history without a step has no cells whose slip could be followed.
        empty = not self.is_run() and not any(synced.values()) and "holds no snapshot yet" in err
        if "lacuna mend" not in err or (status, err.count("\n")) != ((2, 2) if empty else (0, 1)):
            return f"{words[0]}: {status}: {err}"
        copy = shutil.copytree(folder, tempfile.mkdtemp(), dirs_exist_ok=True)
        try:
            status, err = call(copy, ["mend", "out.nc"])
            if status != 0 or os.path.exists(os.path.join(copy, "out.nc.journal")):
                return f"mend: {status}: {err}"
            if not begins(read_safely(os.path.join(copy, "out.nc")), self.whole, synced):
                return "mended, it lacks what was synced"
        finally:
            shutil.rmtree(copy)
        return None

    def go_on(self, folder, what):
        """Ends what was begun: wrong or None."""
        if self.is_run() and os.path.exists(os.path.join(folder, "out.nc.checkpoint")) and \
                what not in ("whole", "absent"):
            words = [word for word in self.scene.words if word not in ("--resume", "--force")]
            status, err = call(folder, [*words, "--resume"])
            # The checkpoint may be that of the file which was to be replaced.
            if status == 2 and "is of another run" in err or self.name == "run --force" and \
                    what == "as before":
                return None
        elif what in ("whole", "as before", "a run broke, and it says so"):
            return None
        else:
            words = [word for word in self.scene.words if word != "--resume"]
            # A sweep can be given again whatever it had done.
            status, err = call(folder, [*words, "--resume" if self.name == "sweep" else "--force"])
        path = os.path.join(folder, self.scene.output)
        if status != 0 or not same(read_safely(path), self.whole, self.but):
            return f"it does not go on: {status}: {err}"
        return None

    def attempt(self, how, k):
        """(what is left, what is wrong or None)"""
        folder = self.copy()
        try:
            status, err = call(folder, self.scene.words, f"{k}:{how}")
            killed = how in ("kill", "tear")
            made, synced = log(folder, None if killed else k)
            # The runs of a trade or a sweep are processes of their own.
            if killed != (status == -signal.SIGKILL) and made >= k and \
                    self.name not in ("trade", "sweep") and (killed or status not in (0, 1, 3)):
                return "ended", f"status {status}: {err}"
            if not killed and status != 0 and sum(
                    line.startswith("lacuna: ") for line in err.splitlines()) < 1:
                return "ended", f"status {status} without a line"
            # Going on, a run begins with what its checkpoint counts on.
            synced = {} if self.name == "trade" else synced or self.synced
            what, wrong = self.look(folder, synced)
            if not killed and status == 0 and what not in ("whole", "a run broke, and it says so"):
                wrong = wrong or f"exit 0, but the output is {what}"
            return what, wrong or self.go_on(folder, what)
        except subprocess.TimeoutExpired:
            return "ended", "it hangs"
        finally:
            shutil.rmtree(folder)


# Where syncs cost nothing: no power is lost here.
if os.access("/dev/shm", os.W_OK):
    tempfile.tempdir = "/dev/shm"

STUDY = None


def attempt(task):
    return task, STUDY.attempt(*task)


def try_all(name, ways):
    """Every way at every call of a scene: how many calls, what was left how often, what is wrong."""
    global STUDY
    STUDY = Study(name, scenes()[name])
    counts, wrong = collections.Counter(), []
    tasks = [(how, k) for how in ways for k in range(1, STUDY.calls + 1, STEP)]
    with multiprocessing.Pool(min(4, os.cpu_count() or 1)) as pool:
        for (how, k), (what, fault) in pool.imap_unordered(attempt, tasks, chunksize=4):
            counts[what] += 1
            if fault is not None:
                wrong.append(f"{name}: {how} at {k}: {what}: {fault}")
    calls = STUDY.calls
    STUDY.close()
    return calls, counts, wrong


class EveryCall(unittest.TestCase):
    def test_a_sweep_is_given_again_whatever_it_had_done(self):
        calls, _, wrong = try_all("sweep", ["kill"])
        self.assertGreater(calls, 20)
        self.assertEqual(wrong, [])

    def test_run_with_checkpoints(self):
        calls, counts, wrong = try_all("run, checkpoints", ["kill", "tear"])
        print(calls, "calls:", dict(counts))
        self.assertGreater(calls, 100)
        self.assertEqual(wrong, [])

    def test_a_history_is_read_with_its_maps_or_this_is_said(self):
        # Its steps and their maps are synced as one, or the maps come last.
        for fields, calls, status in (("all", 150, 0), ("last", 150, 2)):
            with self.subTest(fields=fields), tempfile.TemporaryDirectory() as folder:
                words = [*scenes()["contact, history"].words, "--set", f"load.history.fields={fields}"]
                self.assertEqual(call(folder, words, f"{calls}:kill")[0], -signal.SIGKILL)
                self.assertGreater(log(folder)[1]["step"], 0)
                ended, err = call(folder, CASCADE)
                self.assertEqual((ended, "not all of the map" in err), (status, status == 2), err)


def try_everything(names):
    faults = 0
    for name in names or scenes():
        for how in ALL_WAYS:
            calls, counts, wrong = try_all(name, [how])
            faults += len(wrong)
            print(f"{name:20} {how:9} {calls:5} calls  {len(wrong):4} wrong  ",
                  ", ".join(f"{what} {n}" for what, n in sorted(counts.items())), flush=True)
            for line in sorted(wrong)[:5]:
                print("    " + line.strip())
    return faults


def main():
    global PROGRAM, SOURCE, LIBRARY, STEP
    PROGRAM, SOURCE, LIBRARY = (os.path.abspath(sys.argv.pop(1)) for _ in range(3))
    if sys.argv[1:2] == ["--all"]:
        sys.exit(try_everything(sys.argv[2:]) > 0)
    if sys.argv[1:2] == ["--step"]:
        STEP = int(sys.argv.pop(2))
        del sys.argv[1]
    unittest.main()


if __name__ == "__main__":
    main()
