#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python module: what it gives is what the program writes, and its errors are the library's.

usage: test_python.py PROGRAM SOURCE_FOLDER LIBRARY
"""

import ast
import concurrent.futures
import doctest
import gc
import inspect
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy
import xarray

PROGRAM, SOURCE, LIBRARY = map(os.path.abspath, sys.argv[1:4])
os.environ["LACUNA_LIBRARY"] = LIBRARY
os.environ["LACUNA_PROGRAM"] = PROGRAM
sys.path.insert(0, os.path.join(SOURCE, "tools", "python"))
sys.path.insert(0, os.path.join(SOURCE, "tests", "support"))
import completed  # noqa: E402
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


CLOCK = {"history", "libraries", "date_created", "date_modified", "wall_time_s", "source_file", "title"}


def ends(case):
    """In a process of its own."""
    return float(lacuna.run(case).slip[-1])


def break_down(case):
    return lacuna.run(case, {"friction.aging.dx": 1})


class Python(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-python-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(SOURCE, "cases", name)

    def same(self, mine, words, more=()):
        """Variables, types, attributes and values are those of the file that the program writes, decoded or not."""
        file = os.path.join(self.folder, "theirs.nc")
        done = subprocess.run([PROGRAM, *words, "-o", file, "--force", "--json"], capture_output=True, text=True, check=True,
                              cwd=SOURCE)
        for decode, given in mine.items():
            wanted = xarray.load_dataset(file, decode_times=decode)
            variables = dict(wanted.variables)
            with netCDF4.Dataset(file) as stored:
                groups = list(stored.groups)
            for group in groups:
                within = xarray.load_dataset(file, group=group, decode_times=decode)
                variables |= {f"{group}/{name}": values for name, values in within.variables.items()}
            self.assertEqual(set(given.variables) ^ set(variables), set())
            self.assertEqual(set(given.coords), set(wanted.coords))
            for name, values in variables.items():
                mine = given.variables[name].to_base_variable()
                self.assertTrue(mine.identical(values.to_base_variable()), f"{name}: {mine}, {values}")
                self.assertEqual(mine.dtype, values.dtype, name)
            for key in set(wanted.attrs) - CLOCK:
                numpy.testing.assert_equal(given.attrs.get(key), wanted.attrs[key], key)
            self.assertLessEqual(set(given.attrs) - set(wanted.attrs) - CLOCK, set(more))
        return json.loads(done.stdout)

    def compare(self, case, **overrides):
        """Every variable, to the last bit; the program's run beside the module's."""
        sets = [word for key, value in overrides.items() for word in ("--set", f"{key}={value}")]
        mine = {decode: lacuna.run(self.path(case), overrides, decode_times=decode) for decode in (True, False)}
        said = self.same(mine, ["run", os.path.join("cases", case), *sets])
        return mine[False], said

    def test_block(self):
        mine, said = self.compare("block.yaml")
        self.assertEqual(mine.attrs["failed"], 1)
        self.assertAlmostEqual(mine.attrs["failure_time_s"] / said["failure_time_s"], 1, 12)
        self.assertEqual(mine.attrs["steps"], said["steps"])

    def test_factor_of_safety(self):
        mine, said = self.compare("load/reservoir.yaml", **{"output.fields": "[slip]"})
        self.assertEqual(mine.attrs["factor_of_safety_least"], said["least_factor_of_safety"])
        self.assertEqual(mine.attrs["factor_of_safety_start"], said["initial_factor_of_safety"])
        self.assertNotIn("factor_of_safety_below_1_time_s", mine.attrs)
        self.assertTrue({"cell_factor_of_safety", "lake_level", "effective_ratio"} <= set(mine.variables))

    def test_events(self):
        mine, said = self.compare("events.yaml")
        self.assertEqual(mine.sizes["event"], said["events"])
        self.assertEqual(mine.attrs["failed"], 0)
        self.assertNotIn("failure_time_s", mine.attrs)  # as in a file

    def test_levels_and_fields(self):
        fields = "[slip, state, traction]"
        mine, _ = self.compare("rg/creep-to-failure.yaml", **{
            "interface.levels": 4, "output.fields": fields, "time.end": "100 s"})
        self.assertEqual(mine["n_slip"].dims, ("time", "level"))
        self.assertEqual(mine["cell_state"].dims, ("snapshot", "cell"))
        self.assertNotIn("cell_slip_rate", mine)

    def test_case_in_memory(self):
        """A mapping gives what the same case gives from its file, numpy's numbers and truth values included."""
        case = {"lacuna": 1, "title": "One", "load": {"normal": {"pressure": numpy.float64(3e6)}},
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

    def test_contact(self):
        sets = {"interface.levels": "6"}
        case = "cases/contact/self-affine.yaml"
        words = ["contact", case, "--set", "interface.levels=6"]
        self.same({True: lacuna.contact(os.path.join(SOURCE, case), sets)}, words)
        mine = lacuna.contact(os.path.join(SOURCE, case), sets, boxes="2:16", coarsest=16, coarsening="sample", sizes="5 cm, 1 m")
        self.same({True: mine}, [*words, "--boxes", "2:16", "--coarsest", "16", "--coarsening", "sample", "--sizes", "5 cm, 1 m"])
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.contact(os.path.join(SOURCE, case), sets, boxes="3:16")
        self.assertEqual(str(caught.exception), 'boxes: "3:16" must be two sides in cells, powers of two: 2:32')

    def test_contact_history(self):
        """Steps and maps, of all steps, of the last, of none."""
        for fields in ("all", "last", "none"):
            sets = {"interface.levels": 4, "load.history.fields": fields}
            words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
            mine = lacuna.contact(self.path("shear-cycle.yaml"), sets)
            said = self.same({True: mine}, ["contact", "cases/shear-cycle.yaml", *words])
            self.assertEqual(mine.sizes["step"], len(said["steps"]))
            self.assertEqual(mine.variables.get("traction_x", mine.x).dims,
                             {"all": ("step", "y", "x"), "last": ("y", "x"), "none": ("x",)}[fields])

    def test_rg(self):
        self.same({True: lacuna.rg(self.path("rg/cons.yaml"))}, ["rg", "cases/rg/cons.yaml"])
        # the program follows each interface in a process, the library all in one
        self.same({True: lacuna.rg(self.path("rg/cons.yaml"), {"rg.seeds": 3})}, ["rg", "cases/rg/cons.yaml", "--set", "rg.seeds=3"])

    def test_rg_of_a_file(self):
        file = os.path.join(self.folder, "run.nc")
        subprocess.run([PROGRAM, "run", "cases/rg/creep-to-failure.yaml", "--set", "interface.levels=4", "--set",
                        "output.fields=[slip_rate, state, traction]", "--set", "output.fields_every={per_decade: 2}", "-o", file, "-q"],
                       check=True, cwd=SOURCE, stdout=subprocess.DEVNULL)
        for snapshot in ("0", "last"):
            mine = lacuna.rg(file, {"rg.beta": 0.5}, snapshot=snapshot)
            self.same({True: mine}, ["rg", file, "--set", "rg.beta=0.5", "--snapshot", snapshot])
        self.assertTrue(mine.identical(lacuna.rg(file, {"rg.beta": 0.5})))
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.rg(file, snapshot=10**6)
        self.assertEqual(caught.exception.kind, "input")

    def test_precursors(self):
        series = os.path.join(SOURCE, "cases/data/creep.csv")
        mine = {decode: lacuna.precursors(series, displacement="disp_mm:mm", decode_times=decode) for decode in (True, False)}
        self.same(mine, ["precursors", "cases/data/creep.csv", "--displacement", "disp_mm:mm"])
        self.assertEqual(mine[True].failure_time.dtype.kind, "M")
        self.assertIsInstance(mine[True].reason.values.flat[0], str)
        self.assertTrue(mine[True].identical(lacuna.precursors(series, displacement="disp_mm:mm", until="2100-01-01")))
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.precursors(series, displacement="none:mm")
        self.assertEqual(caught.exception.kind, "input")

    def test_sweep(self):
        over = {"friction.aging.dc": "uniform(0.5 mm, 2 mm)", "initial.slip_rate": ["1 mm/week", "2 mm/week"]}
        mine = lacuna.sweep(self.path("block.yaml"), over, members=6, seed=3, processes=2)
        words = [w for key, value in over.items() for w in ("--over", f"{key}={value if isinstance(value, str) else ', '.join(value)}")]
        self.same({True: mine}, ["sweep", "cases/block.yaml", "--members", "6", "--seed", "3", *words], more=mine.attrs)
        self.assertEqual(mine.sizes["realization"], 6)
        self.assertTrue(bool((mine.friction_aging_dc > 0.5e-3).all()))
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.sweep(self.path("block.yaml"), {"friction.aging.dx": "1, 2"})
        self.assertEqual(caught.exception.kind, "input")

    def test_fit(self):
        sets = {"fit.steps": "0", "fit.starts": "8"}
        words = [word for key, value in sets.items() for word in ("--set", f"{key}={value}")]
        case, series = "cases/fit/block.yaml", "cases/data/creep.csv"
        mine = lacuna.fit(os.path.join(SOURCE, case), os.path.join(SOURCE, series), sets)
        self.same({True: mine}, ["fit", case, series, *words])
        few = {"fit.starts": 8, "fit.burn": 20, "fit.steps": 30, "fit.walkers": 16, "fit.rounds": 0}
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.fit(os.path.join(SOURCE, case), os.path.join(SOURCE, series), few)
        self.assertEqual(caught.exception.kind, "numeric")
        self.assertEqual(caught.exception.dataset.sizes["draw"], 30)

    def test_of_the_program(self):
        """What its pool of processes and its tables are needed for."""
        said = lacuna.check(self.path("block.yaml"))
        theirs = json.loads(subprocess.run([PROGRAM, "check", "cases/block.yaml", "--json"], capture_output=True, text=True,
                                           check=True, cwd=SOURCE).stdout)
        self.assertEqual((said.attrs["ok"], said.attrs["scene"]), (1, theirs["scene"]))
        self.assertEqual(said["memory"].item(), theirs["estimate"]["memory_bytes"])
        self.assertEqual(said["memory"].units, "byte")
        wrong = lacuna.check(self.path("block.yaml"), {"friction.aging.dx": 1, "solver.rtol": 9})
        self.assertEqual((wrong.attrs["ok"], wrong.sizes["error"]), (0, 2))
        self.assertIn('did you mean "dc"', str(wrong.error_message.values))
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.check(self.path("none.yaml"))
        self.assertEqual(caught.exception.kind, "file")
        said = lacuna.describe()
        theirs = json.loads(subprocess.run([PROGRAM, "describe", "--json"], capture_output=True, text=True, check=True).stdout)
        models = [(kind["name"], model) for kind in theirs["kinds"] for model in kind["models"]]
        models += [(section["name"], section) for section in theirs["sections"]]
        self.assertEqual(list(said.model_name.values), [model["name"] for _, model in models])
        rows = [(kind, model["name"], p) for kind, model in models for p in model["parameters"]]
        self.assertEqual(list(zip(said.kind.values, said.of_model.values, said.key.values)),
                         [(kind, model, p["key"]) for kind, model, p in rows])
        for i, (_, _, p) in enumerate(rows):
            default = said.default_choice.values[i] or said.default.values[i]
            self.assertTrue(default == p["default"] or (p["default"] is None and numpy.isnan(default)), p)
            self.assertEqual([said.unit.values[i] or None, said.doc.values[i], bool(said.required[i])],
                             [p["unit"], p["doc"], p["required"]])
        self.assertEqual(lacuna.describe("levels").sizes["model"], 1)
        traded = lacuna.trade(self.path("block.yaml"), dials="rtol=1e-3:1e-4", reach="1%", processes=1)
        self.assertEqual(traded.sizes["run"], 2)
        self.assertEqual(traded.attrs["status"], "complete")
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.trade(self.path("block.yaml"), dials="none")
        self.assertEqual(caught.exception.kind, "input")

    def test_options(self):
        """What the library does not have, the program does: the same as from it."""
        series = os.path.join(SOURCE, "cases/data/creep.csv")
        mine = lacuna.precursors(series, displacement="disp_mm:mm", smooth="average:5")
        self.same({True: mine}, ["precursors", "cases/data/creep.csv", "--displacement", "disp_mm:mm", "--smooth", "average:5"])
        self.assertFalse(mine.identical(lacuna.precursors(series, displacement="disp_mm:mm")))
        parts = [os.path.join(self.folder, f"{i}.nc") for i in range(2)]
        over = {"friction.aging.dc": ["1 mm", "2 mm", "3 mm"]}
        for i, part in enumerate(parts):
            said = lacuna.command("sweep", self.path("block.yaml"), over="friction.aging.dc=1 mm, 2 mm, 3 mm", shard=f"{i}/2",
                                  o=part)
            self.assertEqual(said["output"], part)
        mine, gathered = lacuna.sweep(self.path("block.yaml"), over), os.path.join(self.folder, "all.nc")
        lacuna.command("gather", *parts, o=gathered)
        self.assertTrue(mine.drop_attrs().identical(xarray.load_dataset(gathered).drop_attrs())
                        if hasattr(mine, "drop_attrs") else mine.equals(xarray.load_dataset(gathered)))
        with self.assertRaises(lacuna.Error) as caught:
            lacuna.precursors(series, displacement="disp_mm:mm", smoothness=3)
        self.assertEqual(caught.exception.kind, "input")

    def test_every_command(self):
        """All that the program can do is reached: by a function, or by its name."""
        file, series = os.path.join(self.folder, "run.nc"), os.path.join(SOURCE, "cases/data/creep.csv")
        page, tables, case = (os.path.join(self.folder, name) for name in ("page.html", "tables", "new"))
        self.assertEqual(lacuna.command("run", self.path("block.yaml"), o=file, set="output.fields=[slip, slip_rate, state]")["status"],
                         "complete")
        self.assertEqual(lacuna.command("report", file, output=page)["output"], page)
        self.assertEqual(lacuna.command("report", series, displacement="disp_mm:mm", output=page, force=True)["output"], page)
        self.assertTrue(lacuna.command("export", file, csv=True, o=tables))
        self.assertIn("time.csv", os.listdir(tables))
        self.assertTrue(lacuna.command("mend", file))
        self.assertTrue(lacuna.command("new", case))
        self.assertIn("lacuna", lacuna.command("completion", "bash")["script"])
        fleet = os.path.join(self.folder, "fleet.yaml")
        with open(fleet, "w", encoding="utf-8") as words:
            words.write("lacuna_fleet: 1\n")
        with self.assertRaises(lacuna.Error) as caught:  # test_watch follows one
            lacuna.command("watch", fleet, o=os.path.join(self.folder, "lines.jsonl"))
        self.assertEqual(caught.exception.kind, "input")
        branch = lacuna.run(self.path("block.yaml"), {"initial.run": {"file": file, "at": "1 day"}})
        self.assertIn("run.nc", branch.attrs["branch"])
        reached = {"report", "export", "mend", "new", "completion", "watch", "gather"}
        self.assertEqual(set(completed.commands(PROGRAM)), (set(lacuna.__all__) - {"Error", "command", "version"}) | reached)

    def test_processes(self):
        case = self.path("block.yaml")
        alone = ends(case)
        for way in ("spawn", "fork"):
            with concurrent.futures.ProcessPoolExecutor(2, mp_context=multiprocessing.get_context(way)) as pool:
                self.assertEqual(list(pool.map(ends, [case] * 4)), [alone] * 4)
                whole = pool.submit(lacuna.run, case).result()
                self.assertTrue(whole.identical(lacuna.run(case)))
                with self.assertRaises(lacuna.Error) as caught:
                    pool.submit(break_down, case).result()
                self.assertEqual(caught.exception.kind, "input")

    def test_examples(self):
        """Those of the docstrings."""
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(SOURCE)
        tried = doctest.testmod(lacuna)
        self.assertEqual(tried.failed, 0)
        self.assertGreaterEqual(tried.attempted, 9)
        for name in set(lacuna.__all__) - {"Error"}:
            self.assertTrue(getattr(lacuna, name).__doc__ and getattr(lacuna, name).__annotations__, name)

    def names_of_files(self):
        names = set()
        sets = {"output.fields": "[slip, state]", "interface.levels": 3, "time.end": "1 s"}
        for found in (lacuna.run(self.path("events.yaml"), {"time.end": "1 s"}), lacuna.run(self.path("block.yaml")),
                      lacuna.run(self.path("rg/creep-to-failure.yaml"), sets), lacuna.rg(self.path("rg/cons.yaml")),
                      lacuna.contact(self.path("shear-cycle.yaml"), {"interface.levels": 4}),
                      lacuna.sweep(self.path("block.yaml"), {"friction.aging.dc": ["1 um", "2 um"]}),
                      lacuna.check(self.path("block.yaml")), lacuna.describe(),
                      lacuna.precursors(os.path.join(SOURCE, "cases/data/creep.csv"), displacement="disp_mm:mm")):
            for name in found.variables:
                names |= {name, *found[name].attrs, found[name].attrs.get("units", ""), *found[name].dims}
            names |= set(found.attrs)
        return names

    def test_holds_no_name(self):
        """No second description: no text and no attribute in the module's source is a variable, a dimension, a unit or an
        attribute of a file, but for what names an argument of a function, an option of the program or a member of the
        library's own structures, or is of xarray and numpy."""
        with open(lacuna.__file__, encoding="utf-8") as file:
            source = file.read()
        own = {"", "1", "s", "-", *lacuna.STATUS}
        for name in lacuna.__all__:
            own |= set(inspect.signature(getattr(lacuna, name)).parameters)
        for kind in vars(lacuna).values():
            own |= {field for field, *_ in getattr(kind, "_fields_", ())}
        own |= {*dir(xarray.Dataset), *dir(numpy), *dir(os), *dir(lacuna._Owned(lambda _: None)), *lacuna.__all__}
        names = self.names_of_files()
        self.assertGreater(len(names), 250)

        def held(text):
            tree = ast.parse(text)
            docs = {id(node.body[0].value) for node in ast.walk(tree) if hasattr(node, "body") and isinstance(node.body, list)
                    and node.body and isinstance(node.body[0], ast.Expr)}
            texts = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and id(node) not in docs}
            return (texts | {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}) & names - own

        self.assertEqual(held(source), set())
        for line, name in (("x = run['slip_rate']", "slip_rate"), ("x = run.failure_time", "failure_time"),
                           ("x = {'m s-1': 1}", "m s-1"), ("x = f'{1}ended_by'", "ended_by")):
            self.assertEqual(held(source + line), {name})

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

    def test_interrupted_in_the_program(self):
        """A sweep in the program's pool ends too, and its processes with it, and leaves nothing behind, or what it goes on
        from; a history of loads ends in this one."""
        text = "\n".join((
            "import lacuna, os, signal, sys, threading, time",
            "def stop():",
            "    time.sleep(1.5)",
            "    while {done!r} and not (os.path.exists({done!r}) and os.path.getsize({done!r}) > 1000):",
            "        time.sleep(0.1)",
            "    {kill}",
            "threading.Thread(target=stop, daemon=True).start()",
            "try:", "    {call}", "except KeyboardInterrupt:", "    print('stopped')"))
        alone, terminal = "os.kill(os.getpid(), signal.SIGINT)", "os.killpg(0, signal.SIGINT)"
        work, temporary = os.path.join(self.folder, "work"), os.path.join(self.folder, "temporary")
        sweep = f"lacuna.sweep({self.path('block.yaml')!r}, {{{{'friction.aging.dc': 'uniform(1 mm, 2 mm)'}}}}, members=1000000{{}})"
        kept = os.path.join(work, "result.nc.runs", "done")
        calls = ((sweep.format(""), terminal, ""), (sweep.format(f", output={work!r}"), alone, kept),
                 (f"lacuna.contact({self.path('shear-cycle.yaml')!r}, {{'load.history.steps.0.count': 9000, 'interface.levels': 5}})", alone, ""))
        os.mkdir(temporary)
        os.mkdir(work)
        for call, kill, kept_in in calls:
            done = subprocess.run([sys.executable, "-c", text.format(call=call, kill=kill, done=kept_in)], capture_output=True, text=True,
                                  check=False, timeout=60, start_new_session=True,
                                  env={**os.environ, "PYTHONPATH": os.path.dirname(lacuna.__file__), "TMPDIR": temporary})
            self.assertEqual((done.stdout, done.stderr, done.returncode), ("stopped\n", "", 0))
            self.assertEqual(os.listdir(temporary), [])
        self.assertGreater(os.path.getsize(kept), 1000)

    def test_version(self):
        said = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True)
        self.assertEqual(said.stdout.split()[1], lacuna.version())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
