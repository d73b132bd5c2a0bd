#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python module: what it gives is what the program writes, and its errors are the library's.

usage: test_python.py PROGRAM SOURCE_FOLDER LIBRARY
"""

import gc
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy
import xarray

PROGRAM, SOURCE, LIBRARY = map(os.path.abspath, sys.argv[1:4])
os.environ["LACUNA_LIBRARY"] = LIBRARY
sys.path.insert(0, os.path.join(SOURCE, "tools", "python"))
import lacuna  # noqa: E402

STOPPED = """
import os, signal, sys
sys.path.insert(0, {path!r})
import lacuna

class Stopped(lacuna._Stop):
    def __enter__(self):
        super().__enter__()
        os.kill(os.getpid(), signal.SIGINT)
        return self

lacuna._Stop = Stopped
try:
    lacuna.run({case!r})
except KeyboardInterrupt:
    print("stopped")
"""

THREADS = """
import sys, threading
sys.path.insert(0, {path!r})
import lacuna
ends = []
def work():
    for _ in range(10):
        ends.append(lacuna.run({case!r}).attrs["failure_time_s"])
threads = [threading.Thread(target=work) for _ in range(6)]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(len(set(ends)))
"""


class Python(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-python-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(SOURCE, "cases", name)

    def compare(self, case, **overrides):
        """Every variable that both have, to the last bit; the program's run beside the module's."""
        sets = [word for key, value in overrides.items() for word in ("--set", f"{key}={value}")]
        file = os.path.join(self.folder, "run.nc")
        done = subprocess.run([PROGRAM, "run", self.path(case), *sets, "-o", file, "--force",
                               "--json"], capture_output=True, text=True, check=True)
        mine = lacuna.run(self.path(case), overrides)
        with xarray.open_dataset(file, decode_times=False) as written:
            for name in mine.variables:
                self.assertIn(name, written.variables)
                self.assertEqual(mine[name].dims, written[name].dims, name)
                numpy.testing.assert_array_equal(mine[name].values,
                                                 written[name].values.astype(float), name)
                if not name.endswith("time"):  # the file's are since the date
                    self.assertEqual(mine[name].attrs["units"], written[name].attrs["units"])
                self.assertTrue(mine[name].attrs["long_name"])
            missing = set(written.variables) - set(mine.variables) - set(mine.attrs)
            scalars = {name for name in missing if written[name].ndim == 0}
            self.assertEqual(missing - scalars, set())
            for name in scalars:
                unit = written[name].attrs["units"]
                key = name if unit == "1" else f"{name}_{unit.replace(' ', '_')}"
                numpy.testing.assert_array_equal(mine.attrs[key], written[name].values)
        return mine, json.loads(done.stdout)

    def test_block(self):
        mine, said = self.compare("block.yaml")
        self.assertEqual(mine.attrs["failed"], 1)
        self.assertAlmostEqual(mine.attrs["failure_time_s"] / said["failure_time_s"], 1, 12)
        self.assertEqual(mine.attrs["steps"], said["steps"])

    def test_factor_of_safety(self):
        mine, said = self.compare("load/reservoir.yaml", **{"output.fields": "[slip]"})
        self.assertEqual(mine.attrs["factor_of_safety_least"], said["least_factor_of_safety"])
        self.assertEqual(mine.attrs["factor_of_safety_start"], said["initial_factor_of_safety"])
        self.assertTrue(numpy.isnan(mine.attrs["factor_of_safety_below_1_time_s"]))
        self.assertTrue({"cell_factor_of_safety", "lake_level", "effective_ratio"} <= set(mine.variables))

    def test_events(self):
        mine, said = self.compare("events.yaml")
        self.assertEqual(mine.sizes["event"], said["events"])
        self.assertEqual(mine.attrs["failed"], 0)
        self.assertTrue(numpy.isnan(mine.attrs["failure_time_s"]))

    def test_levels_and_fields(self):
        fields = "[slip, state, traction]"
        mine, _ = self.compare("rg/creep-to-failure.yaml", **{
            "interface.levels": 4, "output.fields": fields, "time.end": "100 s"})
        self.assertEqual(mine["n_slip"].dims, ("time", "level"))
        self.assertEqual(mine["cell_state"].dims, ("snapshot", "cell"))
        self.assertNotIn("cell_slip_rate", mine)

    def test_case_in_memory(self):
        """A mapping gives what the same case gives from its file, numpy's numbers and truth values included."""
        case = {"lacuna": 1, "load": {"normal": {"pressure": numpy.float64(3e6)}},
                "friction": {"aging": {"f0": 0.6, "a": 0.01, "b": 0.015, "dc": "5 mm", "v0": "1 um/s"}},
                "initial": {"slip_rate": "1 cm/week", "state": {"ratio_to_steady": 0.5}},
                "time": {"end": "30 day"}, "output": {"fields": []}}
        path = os.path.join(self.folder, "same.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(json.dumps({**case, "load": {"normal": {"pressure": "3 MPa"}}}))
        mine, same = lacuna.run(case), lacuna.run(path)
        self.assertTrue(mine.identical(same))
        other = lacuna.run(case, {"initial.state": {"ratio_to_steady": 0.4}, "friction.aging.dc": 0.004})
        self.assertFalse(mine.equals(other))
        for wrong, kind in (({}, "input"), ({**case, "frictoin": 1}, "input")):
            with self.assertRaises(lacuna.Error) as caught:
                lacuna.run(wrong)
            self.assertEqual(caught.exception.kind, kind)
            self.assertTrue(str(caught.exception).startswith("case"), str(caught.exception))
        for wrong in (None, 3):
            with self.assertRaises(TypeError):
                lacuna.run(wrong)

    def test_values_as_text(self):
        for value, text in ((True, "true"), ("4 cm", "4 cm"), (numpy.float64(0.25), "0.25"), (numpy.array([1, 2]), "[1, 2]"),
                            ({"a": None}, '{"a": null}')):
            self.assertEqual(lacuna._text(value), text)

    def test_memory(self):
        """Arrays are the recording's own memory: they outlive the Dataset, and it is freed with the last of them."""
        freed = []
        free = lacuna._library.lac_dataset_free

        class Watched(lacuna._Recording):
            def __del__(self):
                freed.append(True)
                free(self.handle)

        before, lacuna._Recording = lacuna._Recording, Watched
        self.addCleanup(setattr, lacuna, "_Recording", before)
        run = lacuna.run(self.path("block.yaml"))
        values = run["slip"].values
        self.assertFalse(values.flags.owndata)
        kept = values.copy()
        del run
        gc.collect()
        self.assertEqual(freed, [])
        numpy.testing.assert_array_equal(values, kept)
        values[0] = 1.0  # it is the caller's
        del values
        gc.collect()
        self.assertEqual(freed, [True])

    def test_no_library(self):
        for path in ("/none/liblacuna.so", "libm.so.6"):
            done = subprocess.run([sys.executable, "-c", "import lacuna"], capture_output=True, text=True, check=False, env={
                **os.environ, "LACUNA_LIBRARY": path, "PYTHONPATH": os.path.join(SOURCE, "tools", "python")})
            self.assertIn("ImportError", done.stderr.splitlines()[-1])
            self.assertIn(path, done.stderr.splitlines()[-1])

    def test_errors(self):
        for case, overrides, kind, message in (
                ("block.yaml", {"friction.aging.dx": 1}, "input", 'did you mean "dc"'),
                ("block.yaml", {"friction.aging.dc": "-1 um"}, "input", "must be >= 1e-18 m"),
                ("block.yaml", {"": 1}, "input", "must be key.path=value"),
                ("nowhere.yaml", None, "file", "nowhere.yaml")):
            with self.assertRaises(lacuna.Error) as caught:
                lacuna.run(self.path(case), overrides)
            self.assertEqual(caught.exception.kind, kind)
            self.assertIn(message, str(caught.exception))

    def test_odd_bytes(self):
        """A message with bytes that are no text is still the library's."""
        for case in (b"/none/\xe9.yaml", "/none/\udce9.yaml"):
            with self.assertRaises(lacuna.Error) as caught:
                lacuna.run(case)
            self.assertEqual(caught.exception.kind, "file")
        with self.assertRaises(ValueError):
            lacuna.run(self.path("block.yaml") + "\0x")

    def test_threads(self):
        text = THREADS.format(path=os.path.join(SOURCE, "tools", "python"), case=self.path("block.yaml"))
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False, timeout=120)
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("1\n", "", 0))

    def test_accuracy(self):
        """Pilot runs pick the settings, as for the command."""
        self.compare("block.yaml", **{"solver.accuracy": "1%"})
        loose = lacuna.run(self.path("block.yaml"), {"solver.accuracy": 0.01})
        self.assertLess(loose.attrs["steps"], 0.5 * lacuna.run(self.path("block.yaml")).attrs["steps"])

    def test_interrupted(self):
        text = STOPPED.format(path=os.path.join(SOURCE, "tools", "python"),
                              case=self.path("block.yaml"))
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True,
                              check=False, timeout=120)
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("stopped\n", "", 0))

    def test_version(self):
        said = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True)
        self.assertEqual(said.stdout.split()[1], lacuna.version())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
