#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna trade` and `lacuna run --accuracy` from the case to the files.

usage: test_trade.py PROGRAM SOURCE_FOLDER AT_CALL [unittest options]
"""

import fcntl
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE, STOP = "", "", ""
BLOCK, JOINT = "cases/block.yaml", "cases/transfer/hierarchy.yaml"
DIALS = ["--dials", "rtol=1e-3:1e-4:1e-5,method=bdf:erk"]


def block_failure():
    """Time of failure of cases/block.yaml, by quadrature."""
    a, b, dc = 0.010, 0.0135, 1e-3
    v = 1e-3 / 604800
    # a ln v + b ln theta stays as it is: u = ln v from the start to 1 m/s
    theta = 0.5 ** (1 - b / a) * dc / v
    u = numpy.linspace(math.log(v), 0.0, 2_000_001)
    w = math.log(theta) - a / b * (u - u[0])
    y = 1 / (-b / a * (numpy.exp(-w) - numpy.exp(u) / dc))  # dt/du
    h = u[1] - u[0]
    return h / 3 * (y[0] + y[-1] + 4 * y[1:-1:2].sum() + 2 * y[2:-1:2].sum())


def stopped(count, number):
    """Environment in which a trade gets a signal once it has kept so many runs."""
    options = os.environ.get("ASAN_OPTIONS", "")
    return {"LD_PRELOAD": STOP, "AT_CALL": f"{count}:signal={int(number)}:fsync:.runs/done",
            "ASAN_OPTIONS": options + ":verify_asan_link_order=0"}


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.out = os.path.join(self.folder, "out.nc")
        self.runs = self.out + ".runs"

    def tearDown(self):
        shutil.rmtree(self.folder)

    def call(self, *args, status=0, environment=None):
        done = subprocess.run([PROGRAM, *args], cwd=SOURCE, capture_output=True, text=True,
                              check=False, env={**os.environ, **(environment or {})})
        self.assertEqual(done.returncode, status, done.stderr + done.stdout)
        return done


class Trade(Program):
    def trade(self, case, *args, status=0, environment=None):
        done = self.call("trade", case, "-o", self.out, "--force", "--json", *args, status=status,
                         environment=environment)
        return json.loads(done.stdout) if status == 0 else done.stderr

    def refused(self, words, *args):
        said = self.trade(*args, status=2)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn(words, said)
        self.assertFalse(os.path.exists(self.runs))

    def test_block(self):
        """Errors against the closed form are those that are said, within their uncertainty."""
        exact = block_failure()
        said = self.trade(BLOCK, *DIALS, "--reach", "0.1%")
        self.assertEqual(said["quantity"], "failure")
        self.assertEqual(len(said["runs"]), 6)
        sure = said["reference"]["error_uncertainty"]
        self.assertLess(abs(said["reference"]["value"] / exact - 1), sure)
        for run in said["runs"]:
            self.assertEqual(run["end"], "done")
            self.assertLess(abs(abs(run["value"] / exact - 1) - run["error"]), sure)
            self.assertGreater(run["cpu_time_s"], 0)
            self.assertGreater(run["peak_memory_bytes"], 1 << 20)
            self.assertGreater(run["steps"], 10)
        best = said["recommended"]
        self.assertLessEqual(best["error"] + sure, 1e-3)
        good = [r for r in said["runs"] if r["error"] + sure <= 1e-3]
        self.assertEqual(best["cpu_time_s"], min(r["cpu_time_s"] for r in good))
        front = [r for r in said["runs"] if r["on_front"]]
        for run in said["runs"]:
            beaten = any(f["cpu_time_s"] <= run["cpu_time_s"] and
                         max(f["error"], sure) <= max(run["error"], sure) and f is not run
                         for f in front)
            self.assertEqual(run["on_front"], not beaten)
        self.assertFalse(os.path.exists(self.runs))
        # what is recommended is what a run with it does
        run = json.loads(self.call("run", BLOCK, "-o", os.path.join(self.folder, "run.nc"),
                                   "--json", "-q", *best["options"].split()).stdout)
        self.assertEqual(run["failure_time_s"], best["value"])
        self.assertEqual(run["steps"], best["steps"])

    def test_file(self):
        """The netCDF file holds what JSON says."""
        said = self.trade(BLOCK, "--dials", "rtol=1e-3:1e-4", "--jobs", "1")
        with netCDF4.Dataset(self.out) as file:
            self.assertEqual(file.status, "complete")
            self.assertEqual(file.quantity, "failure")
            self.assertEqual(file["value"].units, "s")
            self.assertEqual(list(file["error"][:]), [r["error"] for r in said["runs"]])
            self.assertEqual(list(file["peak_memory"][:]),
                             [r["peak_memory_bytes"] for r in said["runs"]])
            self.assertEqual([bool(x) for x in file["on_front"][:]],
                             [r["on_front"] for r in said["runs"]])
            self.assertEqual(list(file["settings"][:]), ["solver.rtol=0.001", "solver.rtol=0.0001"])
            self.assertEqual(file.recommendation, said["recommendation"])

    def test_columns(self):
        """Each setting stands below its name, as far right as the longest before it asks for."""
        rows = self.call("trade", BLOCK, "-o", self.out, "--dials", "rtol=1e-3:1e-4,method=bdf:erk").stdout.splitlines()
        at = next(i for i, row in enumerate(rows) if row.split()[:2] == ["rtol", "method"])
        self.assertEqual(rows[at].index("rtol"), 3)
        self.assertEqual(rows[at].index("method"), 3 + len("0.0001 "))
        self.assertEqual({(row[2:10], row[10:14]) for row in rows[at + 1:at + 5]},
                         {(f" {rtol:6} ", f"{method} ") for rtol in ("0.001", "0.0001") for method in ("bdf", "erk")})

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_picture(self):
        """tools/plot/plot_trade.py draws the file."""
        self.trade(BLOCK, *DIALS)
        done = subprocess.run(
            [sys.executable, os.path.join(SOURCE, "tools/plot/plot_trade.py"), self.out],
            capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.out[:-3] + ".png", "rb") as picture:
            self.assertEqual(picture.read(8), b"\x89PNG\r\n\x1a\n")

    def test_quantities(self):
        """Slip, rate and peak rate at a time are those of a run that ends there."""
        run = json.loads(self.call("run", BLOCK, "-o", os.path.join(self.folder, "run.nc"), "--json",
                                   "-q", "--until", "10 day", "--set", "solver.rtol=1e-5").stdout)
        for name, key in (("slip", "mean_slip_m"), ("peak-rate", "max_slip_rate_m_s"),
                          ("rate", "max_slip_rate_m_s")):
            said = self.trade(BLOCK, "--dials", "rtol=1e-5:1e-6", "--until", "10 day", "--quantity",
                              name)
            self.assertEqual(said["runs"][0]["value"], run[key])
        said = self.trade(BLOCK, "--dials", "rtol=1e-5", "--until", "10 day", "--quantity",
                          "failure", status=2)
        self.assertIn("does not fail", said)

    def test_events(self):
        """Events of the catalogue, by either fidelity."""
        said = self.trade("cases/one-by-one.yaml", "--dials", "rtol=1e-3,fidelity", "--quantity",
                          "events", "--set", "interface.levels=2",
                          "--set", "analysis={events: {slip_rate: 1 mm/s}}")
        self.assertEqual(said["unit"], "1")
        for run in said["runs"]:
            self.assertEqual(run["value"], round(run["value"]))
            self.assertGreater(run["value"], 0)

    def test_cascade(self):
        """Q_crit of the cascade, and the largest Q of a run of the same contacts."""
        said = self.trade("cases/bridge.yaml", "--quantity", "q-crit", "--dials", "fidelity")
        value = {r["settings"]["solver.fidelity"]: r for r in said["runs"]}
        found = json.loads(self.call("rg", "cases/bridge.yaml", "--json", "-o",
                                     os.path.join(self.folder, "rg.nc")).stdout)
        self.assertEqual(value["static"]["value"], found["q_crit_over_q_nom"])
        self.assertLess(value["static"]["error"], 0.01)
        self.assertEqual(value["events"]["end"], "broken")
        self.assertIn("weakening", value["events"]["message"])
        self.assertEqual(said["reference"]["settings"]["solver.fidelity"], "ode")

    def contact(self, case, *args):
        return json.loads(self.call("contact", case, "--json", "-q", "--force", "-o",
                                    os.path.join(self.folder, "contact.nc"), *args).stdout)

    def test_contact(self):
        """What a grid gives away of a contact: values are those of `lacuna contact`."""
        said = self.trade("cases/normal/approach.yaml")
        self.assertEqual(said["quantity"], "contact-fraction")
        self.assertEqual([r["settings"]["interface.levels"] for r in said["runs"]], [3, 4, 5])
        for run in said["runs"]:
            found = self.contact("cases/normal/approach.yaml", *run["options"].split())
            self.assertEqual(run["command"], "contact")
            self.assertEqual(run["value"], found["contact_fraction"])
            self.assertEqual(run["n_cells"], found["n_cells"])
            self.assertEqual((run["steps"], run["rhs_evaluations"]),
                             (found["iterations"], found["products"]))
        dimension = self.trade("cases/normal/dimension.yaml", "--quantity", "pressure", "--dials",
                               "levels=4:5", "--reach", "100%")
        found = self.contact("cases/normal/dimension.yaml")
        self.assertEqual(dimension["reference"]["value"], found["mean_pressure_Pa"])
        self.assertIn("lacuna contact with --set interface.levels=4", dimension["recommendation"])
        box = self.trade("cases/normal/approach.yaml", "--quantity", "dimension", "--set",
                         "interface.levels=6", "--dials", "levels=6")
        found = self.contact("cases/normal/approach.yaml", "--set", "interface.levels=6")
        self.assertEqual(box["reference"]["value"], found["d_box"])
        self.assertIsNone(box["reference"]["error_uncertainty"])
        self.assertIn("own error is not known", box["recommendation"])

    def test_history(self):
        """The work of a history, of which only the grid can be coarser."""
        said = self.trade("cases/shear-cycle.yaml", "--quantity", "work", "--set",
                          "interface.levels=5")
        self.assertEqual(said["unit"], "J")
        for run in said["runs"]:
            found = self.contact("cases/shear-cycle.yaml", "--set",
                                 f"interface.levels={run['settings']['interface.levels']:g}")
            work = found["steps"][-1]["cumulative_dissipation_J"]
            self.assertAlmostEqual(run["value"] / work, 1, places=12)
        self.assertEqual({len(run["settings"]) for run in said["runs"]}, {1})
        self.assertEqual(said["refused"], [])

    def test_scene(self):
        """Grids, transfers, planning and precision."""
        said = self.trade(JOINT, "--dials", "levels,transfer", "--set", "solver.rtol=1e-4", "--set",
                          "interface.levels=3")
        self.assertEqual(said["reference"]["settings"]["interface.levels"], 3)
        self.assertEqual(said["reference"]["settings"]["transfer"], "elastic")
        self.assertEqual({r["settings"]["interface.levels"] for r in said["runs"]}, {1, 2, 3})
        said = self.trade(JOINT, "--dials", "planning,precision", "--set", "solver.rtol=1e-4",
                          "--set", "interface.levels=3", "--set", "transfer={elastic: {}}",
                          "--quantity", "slip")
        kinds = {(r["settings"]["solver.fft_planning"], r["settings"]["output.precision"]): r
                 for r in said["runs"]}
        double = kinds["estimate", "double"]
        self.assertEqual(set(kinds), {("estimate", "double"), ("measure", "double"),
                                      ("estimate", "float")})
        self.assertLess(abs(kinds["measure", "double"]["value"] / double["value"] - 1), 1e-3)
        self.assertEqual(kinds["estimate", "float"]["value"], numpy.float32(double["value"]))

    def test_resume(self):
        """A trade that is killed or stopped goes on, and makes no run twice."""
        whole = self.trade(BLOCK, *DIALS, "--jobs", "1")
        for number, status in ((signal.SIGKILL, -signal.SIGKILL), (signal.SIGINT, 4),
                               (signal.SIGTERM, 4)):
            self.trade(BLOCK, *DIALS, "--jobs", "1", status=status,
                       environment=stopped(3, number))
            with open(os.path.join(self.runs, "done"), "r+b") as done:
                heading = done.readline()
                self.assertTrue(heading.startswith(b"lacuna trade 1 "), heading)
                records = done.read()
                size = len(records) // 3
                self.assertEqual(len(records), 3 * size)
                done.write(records[:size - 1])  # torn
            said = self.trade(BLOCK, *DIALS, "--jobs", "1", "--resume")
            times = {r["cpu_time_s"] for r in (*said["runs"], said["reference"])}
            self.assertEqual(sum(struct.pack("d", time) in records for time in times), 3)
            for one, other in zip(whole["runs"], said["runs"]):
                self.assertEqual(one["value"], other["value"])
                self.assertEqual(one["settings"], other["settings"])
            self.assertFalse(os.path.exists(self.runs))

    def test_deletes_only_what_a_trade_wrote(self):
        """Files that stand in OUT.nc.runs, and where a link there leads, stay as they are."""
        notes = os.path.join(self.folder, "notes")
        with open(notes, "w", encoding="ascii") as file:
            file.write("mine\n")
        for name, make in (("run-of-may.nc", shutil.copy), ("run-1.nc", shutil.copy),
                           ("done", shutil.copy), ("done", os.symlink)):
            with self.subTest(name=name, make=make.__name__):
                os.mkdir(self.runs)
                make(notes, os.path.join(self.runs, name))
                said = self.trade(BLOCK, *DIALS, status=2)
                self.assertRegex(said, f"^lacuna: .*runs/{name}: was not written by trade; move it away\n$")
                with open(os.path.join(self.runs, name), encoding="ascii") as file:
                    self.assertEqual(file.read(), "mine\n")
                with open(notes, encoding="ascii") as file:
                    self.assertEqual(file.read(), "mine\n")
                shutil.rmtree(self.runs)
        os.symlink(self.folder, self.runs)
        self.assertIn("out.nc.runs: Not a directory\n", self.trade(BLOCK, *DIALS, status=3))
        os.remove(self.runs)

    def test_takes_away_a_reader_s_copy(self):
        """Of a run's file that was not closed, left by a reader that was killed."""
        os.mkdir(self.runs)
        for name in ("done", ".run-0.nc.mended.lacuna-1.part"):
            with open(os.path.join(self.runs, name), "wb"):
                pass
        self.trade(BLOCK, *DIALS)
        self.assertFalse(os.path.exists(self.runs))

    def test_jobs(self):
        """No more runs at once than asked for, by when each begins and ends with its file."""
        for jobs in 1, 2:
            log, spans = os.path.join(self.folder, f"log-{jobs}"), {}
            self.trade(BLOCK, *DIALS, "--jobs", str(jobs), environment={**stopped(0, 0), "AT_CALL": "0:kill", "AT_CALL_LOG": log})
            with open(log, encoding="utf-8") as file:
                for at, line in enumerate(file):
                    for run in re.findall(r"/run-(\d+)\.nc\n", line):
                        spans[run] = (spans.get(run, (at,))[0], at)
            self.assertEqual(len(spans), 7)
            for begun, _ in spans.values():
                self.assertLessEqual(sum(first <= begun <= last for first, last in spans.values()), jobs)

    def test_resume_refused(self):
        self.assertIn("No such file", self.trade(BLOCK, "--resume", status=3))
        os.mkdir(self.runs)
        with open(os.path.join(self.runs, "done"), "w", encoding="ascii") as done:
            done.write("something else\n")
        self.assertIn("was not written by trade", self.trade(BLOCK, "--resume", status=2))
        with open(os.path.join(self.runs, "done"), encoding="ascii") as done:
            self.assertEqual(done.read(), "something else\n")

    def test_two_at_once(self):
        """A trade on a file that another one makes is refused, and takes nothing away from it."""
        os.mkdir(self.runs)
        left = os.path.join(self.runs, "run-7.nc")
        with open(left, "wb"), open(os.path.join(self.runs, "done"), "wb") as done:
            fcntl.flock(done, fcntl.LOCK_EX)
            for more in ((), ("--resume",)):
                said = self.trade(BLOCK, *DIALS, *more, status=2)
                self.assertIn("another trade is at work there", said)
                self.assertTrue(os.path.exists(left))

    def test_another_case(self):
        """Runs of another case are not taken over."""
        self.trade(BLOCK, *DIALS, "--jobs", "1", status=4,
                   environment=stopped(3, signal.SIGINT))
        other = self.trade(BLOCK, *DIALS, "--set", "friction.aging.dc=2 mm", "--resume")
        plain = self.trade(BLOCK, *DIALS, "--set", "friction.aging.dc=2 mm")
        self.assertEqual([r["value"] for r in other["runs"]], [r["value"] for r in plain["runs"]])

    def test_broken_runs(self):
        """Settings that do not go together are left out; a run that breaks ends no trade."""
        said = self.trade(BLOCK, "--dials", "rtol=1e-3:1e-4,method", "--set", "solver.max_order=5",
                          "--set", "solver.max_steps=215")
        ends = {(r["settings"]["solver.rtol"], r["settings"]["solver.method"]): r["end"]
                for r in said["runs"]}
        self.assertIn("broken", ends.values())
        self.assertIn("done", ends.values())
        said = self.trade(BLOCK, "--dials", "rtol=1e-3,method", "--set", "solver.max_order=7",
                          "--set", "solver.method=erk")
        self.assertEqual(len(said["refused"]), 1)
        self.assertIn("max_order", said["refused"][0])
        stuck = self.trade(BLOCK, "--dials", "rtol=1e-3", "--set", "solver.max_steps=3", status=1)
        self.assertIn("no run that could be the reference", stuck)

    def test_full_disk(self):
        """A file that cannot be written ends the trade, and is no verdict on the settings."""
        words = ["trade", BLOCK, "-o", self.out, "--json", *DIALS, "--jobs", "1"]
        done = subprocess.run(["bash", "-c", 'ulimit -f 20; exec "$@" 2>"$0"', os.path.join(self.folder, "said"), PROGRAM,
                               *words], cwd=SOURCE, stdout=subprocess.DEVNULL, check=False)
        self.assertEqual(done.returncode, 3)
        with open(os.path.join(self.folder, "said"), encoding="utf-8") as file:
            self.assertRegex(file.read(), r"^lacuna: .*run-0.nc: .*File too large; --resume goes on\n$")
        said = json.loads(self.call(*words, "--resume").stdout)
        self.assertEqual({run["end"] for run in said["runs"]}, {"done"})

    def test_wrong(self):
        self.refused('"speed" is no dial', BLOCK, "--dials", "speed")
        self.refused("nothing to turn", BLOCK, "--dials", "levels")
        self.refused('--dials: method=bfd: solver.method: "bfd" must be', BLOCK, "--dials", "method=bfd:bdf")
        self.refused('--dials: rtol=1e-30: solver.rtol: "1e-30" must be', BLOCK, "--dials", "rtol=1e-3:1e-30")
        self.refused('--dials: precision=half: output.precision: "half" must be', BLOCK, "--dials", "precision=half,rtol")
        self.refused('--reach: "-1%" must be', BLOCK, "--reach=-1%")
        self.refused('--reach: "3 m" must be', BLOCK, "--reach", "3 m", "--quantity", "failure")
        self.refused('--reach: "3 Pa" must be', BLOCK, "--reach", "3 Pa")
        self.refused('--spend: "1 m" must be', BLOCK, "--spend", "1 m")
        self.refused('--jobs: "0" must be', BLOCK, "--jobs", "0")
        self.refused('"speed" is no quantity', BLOCK, "--quantity", "speed")
        self.refused("must be > 0 and <= time.end", BLOCK, "--until", "3 year")
        self.refused("solver.rtol", BLOCK, "--set", "solver.rtol=-1")
        self.refused("solver.accuracy is for lacuna run", BLOCK, "--set", "solver.accuracy=1e-3")
        pressed = "cases/normal/approach.yaml"
        self.refused("rtol turns nothing in a contact", pressed, "--dials", "rtol")
        self.refused("shifts turns nothing but a cascade", BLOCK, "--dials", "shifts")
        self.refused("rtol turns nothing in a cascade", "cases/rg/cons.yaml", "--dials", "rtol")
        self.refused("the case has no time", pressed, "--until", "1 day")
        self.refused("there is no dial to turn", BLOCK, "--quantity", "contact-fraction")
        pipe = os.path.join(self.folder, "pipe")
        os.mkfifo(pipe)
        self.call("trade", BLOCK, "-o", pipe, "--force", status=3)
        self.assertFalse(os.path.exists(pipe + ".runs"))  # nothing was computed for it
        self.assertIn("no load.history", self.trade(pressed, "--quantity", "work", status=2))
        said = self.trade(BLOCK, "--dials", "rtol=1e-3:1e-4", "--quantity", "events", status=2)
        self.assertIn("keeps no catalogue", said)
        self.trade(BLOCK, "--dials", "rtol=1e-3:1e-4", "--resume")  # asked anew, nothing lost
        with open(self.out, "rb") as file:
            before = file.read()
        self.call("trade", BLOCK, "-o", self.out, status=2)
        with open(self.out, "rb") as file:
            self.assertEqual(file.read(), before)

    def test_reach_in_units(self):
        """An amount is one of the quantity that is traded, named or not."""
        words = "cases/load/sine.yaml", "--dials", "rtol=1e-3:1e-4"
        self.assertIn("For 1 mm:", self.trade(*words, "--reach", "1 mm")["recommendation"])
        said = self.trade(*words, "--reach", "1 h", status=2)
        self.assertIn("--reach: is in s, but the quantity is the mean slip at the end, in m", said)

    def test_critical_of_a_run(self):
        """Without a section rg q-crit is the largest load of a run, cells given or not."""
        words = "domain/cascade.yaml", "--quantity", "q-crit", "--dials", "rtol=1e-3:1e-4"
        said = self.trade("cases/" + words[0], *words[1:])
        self.assertEqual({run["command"] for run in said["runs"]}, {"run"})

    def test_words(self):
        """The table and the sentence that people read."""
        said = self.call("trade", BLOCK, *DIALS, "-o", self.out, "--reach", "1e-12").stdout
        self.assertIn("Nothing tried keeps to", said)
        said = self.call("trade", BLOCK, *DIALS, "-o", self.out, "--force", "--spend",
                         "1 min").stdout
        self.assertIn("For 1 min", said)
        self.assertTrue(all(len(line) < 100 for line in said.splitlines()), said)


class Table(Program):
    def table(self, *args, status=0):
        done = subprocess.run(
            [sys.executable, os.path.join(SOURCE, "tools/studies/trade_table.py"), "--lacuna", PROGRAM,
             "--keep", os.path.join(self.folder, "keep"), *args],
            capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done.stdout

    def test_page(self):
        """tools/studies/trade_table.py renews the rows that it measures and leaves the others."""
        page = os.path.join(self.folder, "page.md")
        kept = "| friction/aging.yaml | failure | 1 | 3e-06 | 4e-05 | x | y | 25, 0 | then |"
        with open(page, "w", encoding="utf-8") as file:
            file.write(f"above\n\n<!-- trade table -->\n{kept}\n| block.yaml | old |\n"
                       "<!-- end of the trade table -->\n\nbelow\n")
        self.table("--page", page, "block.yaml", "normal/dimension.yaml")
        with open(page, encoding="utf-8") as file:
            text = file.read()
        rows = [line for line in text.splitlines() if ".yaml" in line and line.startswith("| ")]
        self.assertEqual([row.split(" ")[1] for row in rows],
                         ["block.yaml", "friction/aging.yaml", "normal/dimension.yaml"])
        self.assertEqual(rows[1], kept)
        self.assertIn("| failure | 1 |", rows[0])
        self.assertIn("| pressure |", rows[2])
        self.assertTrue(text.startswith("above") and text.endswith("below\n"))
        measured = os.path.join(self.folder, "keep", "block.yaml.json")
        before = os.stat(measured).st_mtime_ns
        self.table("--page", page, "--resume", "block.yaml")  # nothing to measure anew
        self.assertEqual(os.stat(measured).st_mtime_ns, before)
        with open(page, encoding="utf-8") as file:
            self.assertEqual(file.read(), text)
        self.table("nosuch.yaml", status=2)

    def test_every_case(self):
        """The page has a row for each bundled case."""
        with open(os.path.join(SOURCE, "docs/tables/trade.md"), encoding="utf-8") as file:
            part = file.read().split("<!-- trade table -->")[1]
        rows = {line.split(" ")[1] for line in part.splitlines() if line.startswith("| ")}
        cases = os.path.join(SOURCE, "cases")
        for folder, _, files in os.walk(cases):
            for name in files:
                if name.endswith(".yaml"):
                    self.assertIn(os.path.relpath(os.path.join(folder, name), cases), rows)


class Accuracy(Program):
    def run_case(self, *args, status=0):
        done = self.call("run", BLOCK, "-o", self.out, "--force", "--json", *args, status=status)
        return (json.loads(done.stdout) if status == 0 else None), done.stderr

    def test_block(self):
        """Asked and achieved, against the closed form; the pick is said and stands in the file."""
        exact = block_failure()
        for asked in (0.3, 1e-2, 1e-4, 1e-6):
            said, noted = self.run_case("--accuracy", str(asked))
            pick = said["accuracy"]
            self.assertLessEqual(abs(said["failure_time_s"] / exact - 1), asked)
            self.assertLessEqual(pick["estimated"], asked)
            self.assertIn("accuracy: rtol", noted)
            with netCDF4.Dataset(self.out) as file:
                self.assertEqual(float(re.search(r"rtol: (\S+)", file.case)[1]), pick["rtol"])
                self.assertEqual(file.accuracy_asked, asked)
                self.assertNotIn("accuracy:", file.case)
                self.assertIn("time of failure", file.accuracy)
            plain, _ = self.run_case("--set", f"solver.rtol={pick['rtol']}", "--set",
                                     f"solver.method={pick['method']}")
            self.assertEqual(plain["failure_time_s"], said["failure_time_s"])
            self.assertIsNone(plain["accuracy"])

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_scenes(self):
        """The tool that shows asked against achieved error, on scenes of all kinds: three of its list, the others new to it."""
        scenes = ["friction/tails.yaml", "load/ramp.yaml", "domain/file.yaml", "load/sine.yaml", "load/step.yaml", "friction/weakening.yaml",
                  "friction/size.yaml", "transfer/none.yaml", "momentum/slope.yaml", "domain/cascade.yaml", "measured.yaml"]
        tool = [sys.executable, os.path.join(SOURCE, "tools/studies/accuracy.py"), "--lacuna", PROGRAM, "--asked", "0.01", "--"]
        done = subprocess.run([*tool, *scenes], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual({line.split()[1] for line in done.stdout.splitlines()[2:]}, set(scenes))
        done = subprocess.run([*tool, "nowhere.yaml"], capture_output=True, text=True, check=False)
        self.assertIn("nowhere.yaml: cannot be opened", done.stderr)
        self.assertNotEqual(done.returncode, 0)

    def test_percent_and_case(self):
        said, _ = self.run_case("--accuracy", "1%")
        self.assertEqual(said["accuracy"]["asked"], 0.01)
        said, _ = self.run_case("--set", "solver.accuracy=1e-3", "--set", "solver.method=bdf")
        self.assertEqual(said["accuracy"]["method"], "bdf")

    def test_wrong(self):
        for value in ("2", "0", "1 m", "-1%"):
            _, noted = self.run_case(f"--accuracy={value}", status=2)
            self.assertIn(f'lacuna: --accuracy: "{value}" must be', noted)
            self.assertNotIn("solver.accuracy", noted)
        _, noted = self.run_case("--accuracy", "1%", "--set", "solver.accuracy=2", status=2)
        self.assertIn('lacuna: --set: solver.accuracy: "2" must be', noted)
        _, noted = self.run_case("--accuracy", "1e-9", "--set", "solver.max_steps=50", status=1)
        self.assertIn("50 steps were not enough", noted)

    def test_unstable(self):
        """What rounding decides is refused; where a load decides, it is not."""
        steady = ["--accuracy", "1%", "--set", "initial.state=steady"]
        _, noted = self.run_case(*steady, status=2)
        self.assertIn('lacuna: --accuracy: "1%" cannot be kept: the case starts steady', noted)
        constant = "load.pore_pressure=[{constant: {value: 1 kPa}}]"
        self.run_case(*steady, "--set", constant, status=2)
        ramp = "load.pore_pressure=[{ramp: {rate: 0.1 Pa/s}}]"
        said, noted = self.run_case(*steady, "--set", ramp)
        self.assertTrue(said["failed"])
        self.assertIn("rounding decides when it fails", noted)


if __name__ == "__main__":
    PROGRAM, SOURCE, STOP = sys.argv[1:4]
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
