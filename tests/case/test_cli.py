#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The program as its users meet it: exit statuses, error lines, signals, JSON.

usage: test_cli.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import pty
import re
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from math import exp, log

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "support"))
import completed  # noqa: E402

PROGRAM, SOURCE = "", ""

BLOCK = """\
lacuna: 1
title: a block
interface: {size: "1 m", levels: 0}
load: {normal: {pressure: "3 MPa"}}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "0.1 mm", v0: "1 um/s"}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.9}}
time: {start: "2024-01-01T00:00:00Z", end: "30 day"}
"""

# Cells that nothing holds together fail one by one: a run of minutes, to be stopped.
LONG = """\
lacuna: 1
interface: {size: "1 m", levels: 7, domain: {full: {}}}
load: {normal: {pressure: "3 MPa"}}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "0.1 mm", v0: "1 um/s"}}
initial:
  slip_rate: "1 cm/week"
  state: {ratio_to_steady: 0.9}
  spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}
material: {shear_modulus: "20 GPa", poisson: 0.25, shear_speed: "3 km/s"}
time: {end: "30 day", failure: {mean_slip_rate: "1 km/s"}}
solver: {rtol: 1e-9}
"""

SERIES = """\
# Made for this test. Licence: none needed.
date,rate_mm_per_day,disp_mm
2024-01-01T12:00:00Z,1.4,0
2024-01-02T00:00:00Z,NA,1.1
2024-01-03T00:00:00Z,2.1,3
2030-01-01T00:00:00Z,3,9
"""


class Case(unittest.TestCase):
    """A folder of its own, and ways to call the program in it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="lacuna-cli-")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.write("block.yaml", BLOCK)

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def path(self, name):
        return os.path.join(self.folder, name)

    def exists(self, name):
        return os.path.exists(self.path(name))

    def files(self):
        return sorted(os.listdir(self.folder))

    def lacuna(self, *words, **options):
        options.setdefault("stdout", subprocess.PIPE)
        return subprocess.run([PROGRAM, *words], cwd=self.folder, stderr=subprocess.PIPE,
                              stdin=subprocess.DEVNULL, timeout=120, text=True, check=False,
                              **options)

    def start(self, *words):
        process = subprocess.Popen([PROGRAM, *words], cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def expect(self, status, *words, **options):
        done = self.lacuna(*words, **options)
        self.assertEqual(done.returncode, status, f"{words}\n{done.stdout}\n{done.stderr}")
        return done

    def expect_line(self, status, line, *words):
        """Exit status, exactly this one line on stderr, nothing on stdout."""
        done = self.expect(status, *words)
        self.assertEqual(done.stderr, f"lacuna: {line}\n")
        self.assertEqual(done.stdout, "")

    def status_attribute(self, name):
        """The file's own word on whether it is whole."""
        if shutil.which("ncdump"):
            text = subprocess.run(["ncdump", "-h", self.path(name)], capture_output=True,
                                  text=True, check=True).stdout
            return re.search(r':status = "(\w+)"', text).group(1)
        with open(self.path(name), "rb") as file:
            data = file.read()
        found = [s for s in ("complete", "failed", "interrupted") if s.encode() in data]
        return found[0] if found else "running"


class Usage(Case):
    def test_no_command(self):
        self.expect_line(2, "no command given; see lacuna --help")

    def test_unknown_command_names_the_nearest(self):
        self.expect_line(2, '"rnu" is no command; did you mean "run"?', "rnu", "block.yaml")

    def test_unknown_option_names_the_nearest(self):
        self.expect_line(2, '"--forse" is no option; did you mean "--force"?', "run", "--forse",
                         "block.yaml")
        self.expect_line(2, '"--outptu" is no option; did you mean "--output"?', "run",
                         "--outptu=x.nc", "block.yaml")
        self.expect_line(2, '"-x" is no option; see lacuna --help', "-x", "run", "block.yaml")

    def test_missing_value(self):
        self.expect_line(2, "--output: needs a value: --output FILE", "run", "block.yaml", "-o")
        self.expect_line(2, "--set: needs a value: --set KEY=VALUE", "check", "block.yaml",
                         "--set")

    def test_value_where_none_belongs(self):
        self.expect_line(2, '--json: takes no value, not "yes"', "check", "--json=yes",
                         "block.yaml")

    def test_option_of_another_command(self):
        self.expect_line(2, "--force: not an option of check; see lacuna check --help", "check",
                         "block.yaml", "--force")
        for words in (["--sizes", "1 m"], ["--fit", "x.nc"], ["--sigma", "mm:mm"], ["--raw"], ["--failed-at", "1"],
                      ["--horizon=1 day"], ["--reach", "1%"], ["--crossed"], ["--jobs", "2"], ["--view", "0"]):
            self.expect_line(2, words[0].split("=")[0] + ": not an option of check; see lacuna check --help",
                             "check", "block.yaml", *words)

    def test_arguments(self):
        self.expect_line(2, "run: CASE is missing; see lacuna run --help", "run")
        self.expect_line(2, 'check: "b" is one argument too many', "check", "block.yaml", "b")

    def test_threads_must_be_a_number(self):
        for wrong in ("0", "-1", "x", "1.5", "99999999999999999999"):
            self.expect_line(2, f'--threads: "{wrong}" must be a number from 1 to 1024', "check",
                             "block.yaml", f"--threads={wrong}")

    def test_set_needs_an_equals_sign(self):
        self.expect_line(2, '--set: "solver" must be key.path=value', "check", "block.yaml",
                         "--set", "solver")

    def test_version_names_the_libraries(self):
        out = self.expect(0, "--version").stdout
        self.assertRegex(out, r"^lacuna \d+\.\d+\.\d+\n")
        for library in ("SUNDIALS", "netCDF", "FFTW", "GSL", "libyaml"):
            self.assertRegex(out, library + r" \d+\.\d+")
        told = json.loads(self.expect(0, "--version", "--json").stdout)
        self.assertEqual(out, "lacuna {version}\n{libraries}, netCDF {netcdf}\n".format(**told))

    def test_help_has_an_example(self):
        commands = completed.commands(PROGRAM)
        texts = [self.expect(0, "--help").stdout]
        texts += [self.expect(0, command, "--help").stdout for command in commands]
        self.assertEqual(self.expect(0, "help", "run").stdout, texts[1])
        for text in texts:
            self.assertRegex(text, r"example: (source <\()?lacuna")
            self.assertLessEqual(max(map(len, text.splitlines())), 80, text)
        for command in commands:
            self.assertIn(f"  {command} ", texts[0])


class Cases(Case):
    def test_missing_case(self):
        done = self.expect(3, "check", "absent.yaml")
        self.assertRegex(done.stderr, r"^lacuna: .*absent\.yaml: .*\n$")

    def test_options_before_and_after(self):
        self.expect(0, "-q", "check", "block.yaml")
        self.expect(0, "check", "-qv", "--", "block.yaml")

    def test_check_prints_a_case_that_checks(self):
        first = self.expect(0, "check", "block.yaml").stdout
        self.write("again.yaml", first)
        self.assertEqual(self.expect(0, "check", "again.yaml").stdout, first)

    def test_check_json(self):
        done = json.loads(self.expect(0, "check", "block.yaml", "--json").stdout)
        self.assertIs(done["ok"], True)
        self.assertEqual(done["errors"], [])
        self.assertIn("aging", done["scene"])
        self.assertEqual(done["estimate"]["contact_cells"], 1)
        self.assertEqual(done["estimate"]["unknowns"], 2)

    def test_failure_rate_of_a_light_joint(self):
        """a p/eta by hand, 3 um/s at 1 kPa: said, and warned of where it is near the rate at the start, or
        below it; of a grid too large to be built too. Nothing of it with mass, or under a spring."""
        rock = "material={shear_modulus: 20 GPa, poisson: 0.25, shear_speed: 3 km/s, density: 2500 kg/m3}"
        spring = "load.shear=[{spring: {stiffness: 1 GPa/m, speed: 1 nm/s}}]"
        near = "warning: the failure rate, 3 um/s, is only 3 times the slip rate at the start"
        for size in 0, 8:
            for pressure, rate, settings, lowered, said in (
                    ("1 kPa", "1e-9", [], True, None), ("1 kPa", "1e-6", [], True, near),
                    ("1 Pa", "1e-6", [], False, "warning: time.failure.mean_slip_rate: 1 m/s is out of reach"),
                    ("1 kPa", "1e-6", ["inertia={thickness: 1 m}"], False, None), ("1 kPa", "1e-6", [spring], False, None)):
                words = [rock, f"load.normal.pressure={pressure}", f"initial.slip_rate={rate} m/s", *settings,
                         f"interface={{size: 1 m, levels: {size}, domain: {{full: {{}}}}}}"]
                if not size:
                    words[-1] = "interface={size: 1 m, levels: 0}"
                done = self.expect(0, "check", "block.yaml", "--json", *[x for w in words for x in ("--set", w)])
                found = json.loads(done.stdout)["estimate"]
                self.assertEqual(found["failure_rate_lowered"], lowered, words)
                self.assertAlmostEqual(found["failure_rate_m_s"] / (0.01 * 1e3 / (20e9 / 6e3) if lowered else 1), 1)
                self.assertIn(said or "", done.stderr)
                self.assertEqual("warning" in done.stderr, said is not None, done.stderr)

    def test_no_control_characters(self):
        """A title, a column or a file's name is no command to the terminal; other characters stay."""
        self.write("s.csv", "t,d\x1b[2J\x9bx\n0,1\n1,2\n2,3\n")
        shutil.copy(os.path.join(SOURCE, "cases", "contact", "self-affine.yaml"), self.path("s.yaml"))
        title = ["--set", 'title="a\\e[31mb\\x9bc\\a\\x7f \u00e9\u4e2d\U0001f642"']
        small = ["--set", "interface.levels=6", "--set", "solver.contact_tolerance=1e-4"]
        named = "x\x1b[2J\x9b.nc"
        for status, words in [(0, ["run", "block.yaml", "-o", named, *title]), (0, ["check", "block.yaml", *title]),
                              (0, ["contact", "s.yaml", "-o", "c.nc", *small, *title]),
                              (0, ["rg", "s.yaml", "-o", "r.nc", "--force", *small, *title]),
                              (0, ["trade", "block.yaml", "--dials", "rtol=1e-3:1e-4", "-o", "t.nc", *title]),
                              (0, ["report", named, "-o", "x\x1b.html"]),
                              (2, ["run", "block.yaml", "-o", named]), (2, ["precursors", "s.csv", "--displacement", "e:m"])]:
            done = self.expect(status, *words)
            for text in (done.stdout, done.stderr):
                self.assertNotRegex(text, "[\x00-\x08\x0b-\x1f\x7f-\x9f]", words)
            if words[0] == "run" and status == 0:
                self.assertTrue(done.stdout.startswith("a?[31mb?c?? \u00e9\u4e2d\U0001f642\n"), done.stdout)
        whole = "\u00e9\x9b\u00c2" * 10000  # over many blocks of output
        done = self.expect(0, "run", "block.yaml", "-o", "y.nc", "--set", f'title="{whole}"'.replace("\x9b", "\\x9b"))
        self.assertEqual(done.stdout.splitlines()[0], whole.replace("\x9b", "?"))

    def test_no_hidden_characters(self):
        """What turns a line around or has no width is seen as ?, in JSON and in a case as its number; letters stay."""
        hidden = [*range(0x80, 0xa0), 0x61c, 0x180e, *range(0x200b, 0x2010), *range(0x2028, 0x202f), *range(0x2060, 0x2070),
                  0xfeff, *range(0xfff9, 0xfffc), 0xe0000, 0xe0041, 0xe007f]
        seen = "\u00a0\u061b\u061d\u180d\u180f\u200a\u2010\u2027\u202f\u205f\u2070\ufefe\uff00\ufff8\ufffc\u4e2d\U000dffff\U000e0080"
        title = "".join(chr(a) + b for a, b in zip(hidden, seen * 5))
        words = ["--set", "title=\"" + "".join(f"\\U{ord(c):08x}" for c in title) + "\""]
        shown = title.translate({c: "?" for c in hidden})
        self.assertEqual(self.expect(0, "run", "block.yaml", "-o", "x.nc", *words).stdout.split("\n")[0], shown)
        done = self.expect(0, "check", "block.yaml", *words).stdout
        self.assertFalse(set(map(chr, hidden)) & set(done))
        found = self.expect(0, "check", "block.yaml", "--json", *words).stdout
        self.assertFalse(set(map(chr, hidden)) & set(found))
        scene = json.loads(found)["scene"]
        self.write("again.yaml", scene)
        self.assertEqual(self.expect(0, "run", "again.yaml", "-o", "y.nc").stdout.split("\n")[0], shown)
        self.expect(0, "report", "x.nc", "-o", "x.html")
        with open(self.path("x.html"), encoding="utf-8") as file:
            page = file.read()
        self.assertIn(f"<title>{shown}", page)
        self.assertFalse(set(map(chr, hidden[32:])) & set(page[page.index("<title>"):page.index("</title>")]))
        self.assertIn(json.dumps(shown, ensure_ascii=False), page)
        name = "a\u202eb\u200b.yaml"
        self.assertIn("a?b?.yaml", self.expect(3, "run", name).stderr)
        for n in range(4080, 4100):  # a character on the border of a block of output
            done = self.expect(0, "run", "block.yaml", "-o", "z.nc", "--force", "--set",
                               f'title="{"x" * n}\\u202e{"y" * 8}"')
            self.assertEqual(done.stdout.split("\n")[0], "x" * n + "?" + "y" * 8)

    def test_check_counts_the_output(self):
        """Records and fields at stated times stand in the estimate as in the file; too fine ones are refused."""
        for key in ("every", "fields_every", "checkpoint"):
            done = self.expect(2, "check", "block.yaml", "--set", "output.fields=[slip]", "--set",
                               f"output.{key}=1e-300 s")
            self.assertIn(f"output.{key}: ", done.stderr)
            self.assertIn("is finer than times are told apart by time.end: must be >= ", done.stderr)
        self.expect(0, "run", "block.yaml", "-o", "out.nc", "--set", "output.every=1 s", "--set", "time.end=1 hour")
        found = json.loads(self.expect(0, "check", "block.yaml", "--json", "--set", "output.every=1 s", "--set",
                                       "time.end=1 hour").stdout)["estimate"]
        self.assertEqual(found["records_at_times"], 3600)
        size = os.path.getsize(self.path("out.nc"))
        self.assertTrue(size / 2 < found["file_most_bytes"] < 2 * size, size)
        fine = self.expect(0, "check", "block.yaml", "--set", "output.every=1 us").stdout
        self.assertRegex(fine, r"time +[\d.]+ to 5000000 s on one core|time +about 5000000 s")
        self.assertRegex(fine, r"file +up to 290000000 MB: 2.59e\+12 records at stated times")

    def test_json_numbers(self):
        """Whole numbers are written as such, others so that they read back with the fewest digits."""
        shutil.copy(os.path.join(SOURCE, "cases", "contact", "self-affine.yaml"), self.path("s.yaml"))
        small = ["--set", "interface.levels=6", "--set", "solver.contact_tolerance=1e-4"]
        seen = set()
        for words in [["check", "block.yaml"], ["run", "block.yaml", "-o", "out.nc"], ["describe", "solver"],
                      ["contact", "s.yaml", "-o", "c.nc", *small], ["describe", "friction", "aging"]]:
            out = self.expect(0, *words, "--json").stdout
            for text in re.findall(r'[\[:,]\s+(-?\d[\d.e+-]*)', out):
                value = float(text)
                seen.add(text)
                if value.is_integer() and abs(value) < 2**53:
                    self.assertRegex(text, r"^-?\d+$", words)
                else:
                    digits = lambda number: len(re.sub(r"e.*|\D", "", number).strip("0"))
                    self.assertEqual(digits(text), digits(repr(value)), text)
        self.assertTrue({"3000000", "64"} <= seen, seen)  # Pa, cells a side

    def test_check_json_lists_errors(self):
        self.write("bad.yaml", BLOCK.replace("0.1 mm", "-1 um").replace("title", "titel"))
        out = self.expect(2, "check", "bad.yaml", "--json")
        done = json.loads(out.stdout)
        self.assertIs(done["ok"], False)
        self.assertEqual(len(done["errors"]), 2)
        self.assertEqual(len(out.stderr.splitlines()), 2)
        error = done["errors"][1]
        self.assertEqual((error["file"], error["line"], error["key"], error["value"]),
                         ("bad.yaml", 5, "friction.aging.dc", "-1 um"))
        self.assertIn(">= 1e-18 m", error["message"])
        self.assertIn('lacuna: bad.yaml:5: friction.aging.dc: "-1 um" must be >= 1e-18 m', out.stderr)

    def test_set(self):
        out = self.expect(0, "check", "block.yaml", "--set", "friction.aging.dc=7 mm", "--set",
                          "title=changed", "--json").stdout
        scene = json.loads(out)["scene"]
        self.assertIn("changed", scene)
        self.assertRegex(scene, r"dc: .*0?\.?007|dc: .*7e-0?3")

    def test_what_only_the_scene_shows(self):
        """A wrong surface stands at no line of the case, but the case is named."""
        self.expect(0, "new", "joint")
        for command in ("check", "run", "contact"):
            done = self.expect(2, command, "joint.yaml", "--set",
                               "interface.surface.self-affine.shortest=9 m")
            self.assertRegex(done.stderr, r"^lacuna: joint.yaml: .*9 m.*\n$")
        self.assertEqual(self.files(), ["block.yaml", "joint.yaml"])
        done = self.expect(2, "check", "joint.yaml", "--json", "--set",
                           "interface.surface.self-affine.shortest=9 m")
        error = json.loads(done.stdout)["errors"][0]
        self.assertIn("9 m", error["message"])
        self.assertIsNone(error["line"])

    def test_set_reports_its_key(self):
        done = self.expect(2, "check", "block.yaml", "--set", "friction.aging.dcc=1")
        self.assertIn("friction.aging.dcc", done.stderr)
        self.assertIn("dc", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_wrong_cases(self):
        """Beside each file of tests/case/wrong stands what is wrong: LINE: KEY: "VALUE" ..."""
        folder = os.path.join(SOURCE, "tests", "case", "wrong")
        names = sorted(n for n in os.listdir(folder) if n.endswith(".yaml"))
        self.assertGreaterEqual(len(names), 30)
        shutil.copytree(folder, self.path("wrong"))
        for name in names:
            with self.subTest(name):
                self.check_wrong_case(self.path("wrong"), name)

    def test_contact_needs_nothing_of_a_run(self):
        for name in ("missing-friction.yaml", "missing-time.yaml", "no-shear.yaml"):
            shutil.copy(os.path.join(SOURCE, "tests", "case", "wrong", name), self.folder)
            self.expect(0, "contact", name)
            self.assertTrue(self.exists(name.replace(".yaml", "-contact.nc")))

    def check_wrong_case(self, folder, name):
        expected = []
        with open(os.path.join(folder, name[:-5] + ".txt"), encoding="utf-8") as file:
            for line in file.read().splitlines():
                warning, rest = re.fullmatch("(warning: )?(.*)", line).groups()
                expected.append(f"lacuna: {warning or ''}{name}:{rest}")
        errors = [line for line in expected if not line.startswith("lacuna: warning: ")]
        before = sorted(os.listdir(folder))
        requests = [(["check", name], expected)]
        if "LACUNA_SANITIZED" not in os.environ:  # what all commands read a case by
            requests.append((["run", name, "-q", "-o", "out.nc"], errors))
        if len(requests) > 1 and name not in ("missing-friction.yaml", "missing-time.yaml", "no-shear.yaml"):
            requests.append((["contact", "-q", name], errors))
        for words, lines in requests:
            done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, timeout=60,
                                  check=False)
            said = done.stderr.decode("utf-8").splitlines()
            for i, line in enumerate(lines[:len(said)]):
                if line.endswith("...") and said[i].startswith(line[:-3]):
                    said[i] = line  # lists of models grow
            self.assertEqual(said, lines)
            self.assertEqual(done.returncode, 2)
            self.assertEqual(done.stdout, b"")
        self.assertEqual(sorted(os.listdir(folder)), before)


class Runs(Case):
    def test_run_writes_a_whole_file_and_a_summary(self):
        out = self.expect(0, "run", "block.yaml").stdout
        self.assertEqual(self.status_attribute("block.nc"), "complete")
        for label in ("contact cells", "apparent friction", "failure", "balance residual",
                      "largest slip rate", "peak memory", "block.nc (complete)"):
            self.assertIn(label, out)
        self.assertRegex(out, r"failure +after .* on 2024-01-\d\dT\d\d:\d\d:\d\dZ")

    def test_run_json(self):
        done = json.loads(self.expect(0, "run", "block.yaml", "--json").stdout)
        for key in ("status", "failed", "failure_time_s", "failure_date", "n_cells", "steps",
                    "rhs_evaluations", "max_slip_rate_m_s", "mean_slip_m", "events",
                    "balance_residual", "wall_time_s", "cpu_time_s", "peak_memory_bytes",
                    "output", "compare"):
            self.assertIn(key, done)
        self.assertEqual(done["status"], "complete")
        self.assertIs(done["failed"], True)
        self.assertEqual(done["n_cells"], 1)
        self.assertGreaterEqual(done["max_slip_rate_m_s"], 0.999)
        self.assertTrue(0 < done["failure_time_s"] < 30 * 86400)
        self.assertEqual(done["output"], "block.nc")

    def test_json_escapes(self):
        title = 'quote " backslash \\ tab \t new\nline \u00e9 \u2192 \U0001f600'
        text = json.dumps(title, ensure_ascii=False)
        done = json.loads(self.expect(0, "run", "block.yaml", "--json", "--set",
                                      "title=" + text).stdout)
        self.assertEqual(done["title"], title)

    def test_failure_time_of_a_block(self):
        done = json.loads(self.expect(0, "run", "block.yaml", "--json", "--set",
                                      "solver.rtol=1e-10").stdout)
        self.assertAlmostEqual(done["failure_time_s"] / block_failure_time(), 1, delta=1e-5)

    def test_a_computation_that_breaks(self):
        done = self.expect(1, "run", "block.yaml", "--json", "--set", "solver.max_steps=10")
        self.assertEqual(self.status_attribute("block.nc"), "failed")
        result = json.loads(done.stdout)
        self.assertEqual((result["status"], result["failed"], result["steps"]),
                         ("failed", None, 10))
        self.assertRegex(done.stderr, r"^lacuna: .*steps.*\n$")

    def test_no_failure_is_said(self):
        out = self.expect(0, "run", "block.yaml", "--set", "initial.state.ratio_to_steady=1.5")
        self.assertRegex(out.stdout, r"failure +none by the end, after 30 day")

    def test_until(self):
        done = json.loads(self.expect(0, "run", "block.yaml", "--until", "1 hour",
                                      "--json").stdout)
        self.assertAlmostEqual(done["time_s"], 3600, delta=1e-3)
        self.assertIs(done["failed"], False)
        self.assertIsNone(done["failure_time_s"])
        self.assertIsNone(done["failure_date"])
        done = json.loads(self.expect(0, "run", "block.yaml", "--until", "2024-01-01T02:00:00Z",
                                      "--json", "--force").stdout)
        self.assertAlmostEqual(done["time_s"], 7200, delta=1e-3)

    def test_wrong_until(self):
        for wrong in ("0 s", "-1 day", "31 day", "2023-01-01", "3 MPa", "nan", "soon"):
            done = self.expect(2, "run", "block.yaml", "--until", wrong)
            self.assertTrue(done.stderr.startswith(f'lacuna: --until: "{wrong}"'), done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertFalse(self.exists("block.nc"))

    def test_existing_output_is_kept(self):
        self.write("block.nc", "precious")
        line = "block.nc: exists already; --force replaces it, -o names another file"
        self.expect_line(2, line, "run", "block.yaml")
        with open(self.path("block.nc"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "precious")
        self.expect(0, "run", "block.yaml", "--force")
        self.assertEqual(self.status_attribute("block.nc"), "complete")

    def test_output_must_not_be_an_input(self):
        self.expect_line(2, "block.yaml: is read by this case, must not be the output", "run",
                         "block.yaml", "--force", "-o", "block.yaml")

    def test_unwritable_output(self):
        for name in ("absent/x.nc", ".", "block.yaml/x.nc"):
            done = self.expect(3, "run", "block.yaml", "-o", name, "--force")
            self.assertTrue(done.stderr.startswith(f"lacuna: {name}: "), done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1)

    def test_output_file_of_the_case(self):
        self.expect(0, "run", "block.yaml", "--set", "output.file=named.nc", "--until", "1 hour")
        self.assertTrue(self.exists("named.nc"))

    def test_file_too_large_is_an_io_failure(self):
        """A disk that fills up: the file must not pass for a whole one."""
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        done = self.lacuna("run", "block.yaml", preexec_fn=limit)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_stdout_that_takes_nothing(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = self.expect(3, "describe", stdout=full)
        self.assertEqual(done.stderr, "lacuna: standard output: No space left on device\n")
        done = self.lacuna("describe", stdout=None, preexec_fn=lambda: os.close(1))
        self.assertEqual(done.returncode, 3)
        self.assertIn("lacuna: standard output: ", done.stderr)
        read, write = os.pipe()
        os.close(read)
        done = self.expect(3, "describe", "--json", stdout=write)
        os.close(write)
        self.assertEqual(done.stderr, "lacuna: standard output: Broken pipe\n")

    def test_closed_stdout_does_not_reach_the_file(self):
        done = self.lacuna("run", "block.yaml", stdout=None, preexec_fn=lambda: os.close(1))
        self.assertEqual(done.returncode, 3)
        self.assertEqual(self.status_attribute("block.nc"), "complete")

    def test_threads_do_not_change_the_result(self):
        results = []
        for n in ("1", "2"):
            text = self.expect(0, "run", "block.yaml", "--threads", n, "--json", "--force").stdout
            results.append(json.loads(text)["failure_time_s"])
        self.assertEqual(results[0], results[1])

    def test_quiet_and_verbose(self):
        self.assertEqual(self.expect(0, "run", "block.yaml", "-q").stderr, "")
        self.assertIn("lacuna: integrating", self.expect(0, "run", "block.yaml", "-v",
                                                         "--force").stderr)


class Compare(Case):
    def setUp(self):
        super().setUp()
        self.write("series.csv", SERIES)
        self.write("compare.yaml", BLOCK.replace("0.1 mm", "1 mm") + 'compare: [{file: series.csv, time: date, velocity: '
                   '"rate_mm_per_day:mm/day", displacement: "disp_mm:mm", label: a prism}]\n')

    def test_table(self):
        out = self.expect(0, "run", "compare.yaml").stdout
        self.assertIn("beside a prism: a scene with stated assumptions, not a fit", out)
        self.assertIn("modelled/observed", out)
        self.assertIn("2024-01-03T00:00:00Z", out)
        self.assertIn("Made for this test", out)
        self.assertRegex(out, r"rate misfit +rms of log10 .* over 2 readings")

    def test_json(self):
        done = json.loads(self.expect(0, "run", "compare.yaml", "--json").stdout)
        beside = done["compare"][0]
        self.assertEqual(beside["label"], "a prism")
        self.assertEqual(len(beside["readings"]), 4)
        self.assertEqual(beside["rate_readings"], 2)
        self.assertEqual(beside["slip_readings"], 3)
        self.assertIsNone(beside["readings"][3]["modelled_slip_m"])
        self.assertAlmostEqual(beside["readings"][0]["observed_slip_rate_m_s"], 1.4e-3 / 86400)

    def test_missing_series(self):
        os.remove(self.path("series.csv"))
        done = self.lacuna("run", "compare.yaml")
        self.assertIn(done.returncode, (2, 3))
        self.assertIn("series.csv", done.stderr)
        self.assertFalse(self.exists("compare.nc"))

    def test_dates_beside_a_run_without(self):
        done = self.expect(2, "run", "compare.yaml", "--set", "time.start=0")
        self.assertIn("time.start", done.stderr)
        self.assertFalse(self.exists("compare.nc"))


class Signals(Case):
    def begin(self, *words):
        """A long run whose file is there."""
        self.write("long.yaml", LONG)
        process = self.start("run", "long.yaml", *words)
        deadline = time.monotonic() + 60
        while not self.exists("long.nc") and time.monotonic() < deadline:
            time.sleep(0.02)
        time.sleep(0.5)
        self.assertIsNone(process.poll(), "the long run is over too soon")
        return process

    def interrupt(self, number):
        process = self.begin("--json")
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 4, err)
        self.assertEqual(self.status_attribute("long.nc"), "interrupted")
        done = json.loads(out)
        self.assertEqual(done["status"], "interrupted")
        self.assertGreater(done["steps"], 0)
        self.assertRegex(err, r"^lacuna: interrupted at .*; long.nc holds the run up to there, and --resume goes on\n$")

    def test_sigint(self):
        self.interrupt(signal.SIGINT)

    def test_sigterm(self):
        self.interrupt(signal.SIGTERM)

    def test_sigusr1_prints_progress(self):
        process = self.begin()
        process.send_signal(signal.SIGUSR1)
        self.assertTrue(select.select([process.stderr], [], [], 30)[0])
        self.assertRegex(process.stderr.readline(),
                         r"^lacuna: .* of 30 day, mean slip rate .*, \d+ steps, .* s so far\n$")
        self.assertIsNone(process.poll())

    def test_interrupted_before_the_run(self):
        self.write("long.yaml", LONG.replace("levels: 7", "levels: 10").replace(
            "domain: {full: {}}",
            'surface: {self-affine: {hurst: 0.8, rms_height: "1 mm", seed: 1}}'))
        process = self.start("contact", "long.yaml")
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 4)
        self.assertEqual(err, "lacuna: interrupted before anything was written\n")
        self.assertEqual(self.files(), ["block.yaml", "long.yaml"])


class Terminal(Case):
    """The progress bar, on a terminal only."""

    def stderr_of_run(self, *words, until=None, **environment):
        """What comes within three seconds, or up to a pattern."""
        self.write("long.yaml", LONG)
        master, slave = pty.openpty()
        process = subprocess.Popen([PROGRAM, "run", "long.yaml", *words], cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=slave,
                                   env={"PATH": os.environ["PATH"], "TERM": "xterm",
                                        **environment})
        os.close(slave)
        text, deadline = b"", time.monotonic() + 3
        while time.monotonic() < deadline and not (until and re.search(until, text.decode(errors="replace"))):
            if select.select([master], [], [], 0.1)[0]:
                text += os.read(master, 4096)
        process.kill()
        process.wait()
        os.close(master)
        return text.decode()

    def test_bar(self):
        bar = r"\r\[.*\] +\d+ % .* of 30 day"
        text = self.stderr_of_run(until=bar)
        self.assertRegex(text, bar)
        self.assertIn("\033[32m", text)

    def test_no_colour(self):
        bar = r"\r\[[#-]*\] +\d+ %"
        text = self.stderr_of_run(until=bar, NO_COLOR="1")
        self.assertRegex(text, bar)
        self.assertNotIn("\033[32m", text)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_no_bar(self):
        self.assertEqual(self.stderr_of_run("--no-progress"), "")
        self.assertEqual(self.stderr_of_run("--quiet", "--force"), "")
        self.assertEqual(self.stderr_of_run("--force", TERM="dumb"), "")


class Contact(Case):
    def setUp(self):
        super().setUp()
        self.write("joint.yaml", LONG.replace("levels: 7", "levels: 6").replace(
            "domain: {full: {}}",
            'surface: {self-affine: {hurst: 0.8, rms_height: "1 mm", seed: 1}}'))

    def test_text_and_file(self):
        out = self.expect(0, "contact", "joint.yaml").stdout
        for label in ("contact cells", "mean real pressure", "iterations", "D_box"):
            self.assertIn(label, out)
        self.assertTrue(self.exists("joint-contact.nc"))
        self.expect(2, "contact", "joint.yaml")
        self.expect(0, "contact", "joint.yaml", "-o", "other.nc")

    def test_json(self):
        done = json.loads(self.expect(0, "contact", "joint.yaml", "--json").stdout)
        for key in ("n_cells", "grid", "contact_fraction", "max_pressure_Pa",
                    "mean_real_pressure_Pa", "iterations", "complementarity_error",
                    "penetration_m", "delta_s", "delta_s_error", "d_box", "d_box_error",
                    "cpu_time_s"):
            self.assertIn(key, done)
        self.assertIsNone(done["delta_s"])
        self.assertLessEqual(done["complementarity_error"], 1e-8)
        # Every newton of the nominal load is carried by the cells that touch.
        self.assertAlmostEqual(done["mean_real_pressure_Pa"] * done["contact_fraction"] / 3e6, 1,
                               delta=1e-7)
        self.assertAlmostEqual(done["n_cells"] / 64 ** 2, done["contact_fraction"], delta=1e-12)

    def test_area_scaling_of_a_fine_grid(self):
        # J07 at p/E* = 0.01: the areas at 64, 128 and 256 cells a side (docs/tables/theory-fractal.md).
        done = json.loads(self.expect(
            0, "contact", "joint.yaml", "--json", "--set", "interface.levels=9", "--set",
            "interface.surface={benchmark: {name: J07}}", "--set",
            "load.normal.pressure=266.66667 MPa").stdout)
        slope = math.log(0.104736 / 0.068253) / math.log(4)
        self.assertAlmostEqual(done["delta_s"], 2 - slope, delta=0.005)
        self.assertGreater(done["delta_s_error"], 0)

    def test_what_the_surface_is_like(self):
        done = json.loads(self.expect(0, "contact", "joint.yaml", "--json").stdout)["surface"]
        self.assertEqual((done["measured"], done["files"]), ("interface", []))
        self.assertLess(abs(done["hurst"] - 0.8), 3 * done["hurst_error"])
        self.assertGreater(done["rms_height_m"], 3e-4)
        self.assertAlmostEqual(done["jrc"], 32.2 + 32.47 * math.log10(done["z2"]), delta=1e-9)
        out = self.expect(0, "contact", "joint.yaml", "--force").stdout
        for label in ("rms height", "rms slopes x, y", "Hurst exponent", "Z2, JRC"):
            self.assertIn(label, out)

    def test_two_measured_faces(self):
        def grid(heights):
            lines = "".join(" ".join(map(str, row)) + "\n" for row in heights)
            return f"ncols {len(heights[0])}\nnrows {len(heights)}\ncellsize 0,5\n" + lines
        rows = [[(3 * i * i + 5 * j * i + 7 * j) % 11 for i in range(17)] for j in range(16)]
        self.write("upper.asc", grid([[-h for h in row[:16]] for row in rows]))
        self.write("lower.asc", grid(rows))
        faces = ["--set", "interface={size: 8 mm, levels: 4, surface: {file: {path: upper.asc, "
                 "lower: lower.asc, unit: um, lateral_unit: mm, offset: -0.25 mm, fit: resample, "
                 "detrend: none}}}"]
        done = json.loads(self.expect(0, "contact", "joint.yaml", "--json", *faces).stdout)
        surface = done["surface"]
        self.assertEqual(surface["measured"], "composite")
        self.assertEqual([f["nx"] for f in surface["files"]], [16, 17])
        self.assertEqual(surface["files"][1]["path"], "lower.asc")
        self.assertEqual([f["height_unit"] for f in surface["files"]], ["um", "um"])
        self.assertEqual([p["step_m"] for p in surface["profiles"]], [0.0005, 0.001])
        out = self.expect(0, "contact", "joint.yaml", "--force", *faces).stdout
        self.assertRegex(out, r"upper face +upper.asc \(ESRI ASCII grid\)\n +16 x 16 samples "
                              r"500 um apart, heights in um; resampled\n")
        self.assertIn("both faces on the interface", out)
        head = subprocess.run(["ncdump", "-h", self.path("joint-contact.nc")],
                              capture_output=True, check=False).stdout.decode()
        if head:
            self.assertIn('surface_measured = "composite"', head)
            self.assertIn('surface_lower_path = "lower.asc"', head)
        self.expect_line(2, "lower.asc: is read by this case, must not be the output", "contact",
                         "joint.yaml", "--force", "-o", "lower.asc", *faces)
        line = self.expect(2, "check", "joint.yaml", "--set",
                           "interface.surface={file: {path: upper.asc, offset: 1 mm}}").stderr
        self.assertIn("need lower", line)

    def test_a_block_has_no_surface(self):
        done = json.loads(self.expect(0, "contact", "block.yaml", "--json").stdout)
        self.assertEqual(done["n_cells"], 1)
        self.assertIsNone(done["surface"])
        self.assertIsNone(done["iterations"])
        self.assertIsNone(done["d_box"])


class Regime(Case):
    SCENE = """\
lacuna: 1
title: cells of 4 m on a joint of 64 m
interface: {size: "64 m", levels: 4, domain: {full: {}}}
material: {shear_modulus: "10 GPa", poisson: 0.25}
load: {normal: {pressure: "1 MPa"}, shear: [{ratio: {value: 0.6}}]}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "1 mm", v0: "1 um/s"}}
transfer: {hierarchy: {stiffness: elastic}}
initial: {state: "1 hour"}
time: {end: "1 day"}
"""

    def regime(self, *sets):
        words = [word for one in sets for word in ("--set", one)]
        return json.loads(self.expect(0, "check", "scene.yaml", "--json", *words).stdout)["estimate"]

    def test_the_width_of_a_patch_that_slips_by_itself_decides(self):
        self.write("scene.yaml", self.SCENE)
        for width, regime in ((1000, "together"), (65, "together"), (63, "patches"), (5, "patches"), (3, "one by one")):
            dc = width * 1e6 * 0.005 / 1e10  # G dc/(p (b - a))
            with self.subTest(width):
                found = self.regime(f"friction.aging.dc={dc!r}")
                self.assertEqual(found["regime"], regime)
                if width >= 4:
                    self.assertAlmostEqual(found["patch_width_m"], width, delta=1e-9 * width)

    def test_what_does_not_run_away_and_one_block(self):
        self.write("scene.yaml", self.SCENE)
        self.assertEqual(self.regime("friction.aging.b=0.005")["regime"], "creep")
        self.write("scene.yaml", BLOCK)
        found = self.regime()
        self.assertEqual(found["regime"], "one block")
        self.assertIn("follows from initial.slip_rate", found["regime_words"])

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_the_words_are_true(self):
        """The stock slope feels its roughness by friction.spread alone."""
        self.expect(0, "new", "slope", "--kind", "slope")
        with open(os.path.join(self.folder, "slope.yaml"), encoding="utf-8") as file:
            lines = [line for line in file if not line.lstrip().startswith("spread:")]
        self.write("even.yaml", "".join(lines))
        for name, feels, f0 in (("slope", True, 0.567), ("even", False, 0.55)):
            words = json.loads(self.expect(0, "check", name + ".yaml", "--json").stdout)["estimate"]["regime_words"]
            self.assertIn("only through friction.spread" if feels else "Name friction.spread", words)
            smooth, rough = (json.loads(self.expect(0, "run", name + ".yaml", "--json", "--force", "--set", f"friction.aging.f0={f0}", "--set",
                                                    f"interface.surface.self-affine.rms_height={height} cm").stdout)
                             for height in (0.5, 1))
            change = rough["failure_time_s"] / smooth["failure_time_s"] - 1
            (self.assertGreater if feels else self.assertLess)(abs(change), 0.1 if feels else 1e-3)


class New(Case):
    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_new_check_run(self):
        for kind in ("block", "fit", "injection", "joint", "laboratory", "reservoir", "slope"):
            with self.subTest(kind):
                self.expect(0, "new", "my-" + kind, "--kind", kind)
                self.assertEqual(self.expect(0, "check", f"my-{kind}.yaml").stderr, "")
                out = self.expect(0, "run", f"my-{kind}.yaml", "--json").stdout
                done = json.loads(out)
                self.assertEqual(done["status"], "complete")
                self.assertIs(done["failed"], True)
                self.assertLess(done["cpu_time_s"], 10)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_an_injection_fails_or_comes_to_rest_as_its_words_say(self):
        self.expect(0, "new", "x", "--kind", "injection")
        well = "load.pore_pressure.1.injection."
        for change, failed in (("rate=1 l/s", True), ("rate=0.7 l/s", False), ("stop=5 day", False)):
            done = json.loads(self.expect(0, "run", "x.yaml", "--json", "--force", "--set", well + change).stdout)
            with self.subTest(change):
                self.assertIs(done["failed"], failed)
                self.assertGreater(done["mean_slip_m"], 1e-3)
                self.assertEqual(failed and int(done["failure_time_s"] / 86400), 5 if failed else False)

    def test_default_name_and_overwriting(self):
        self.expect(0, "new")
        self.assertTrue(self.exists("case.yaml"))
        self.expect_line(2, "case.yaml: exists already; --force replaces it", "new")
        self.expect(0, "new", "--force")
        self.expect(0, "new", "case.yaml", "--force")
        self.assertFalse(self.exists("case.yaml.yaml"))

    def test_json(self):
        done = json.loads(self.expect(0, "new", "x", "--json").stdout)
        self.assertEqual(done["output"], "x.yaml")

    def test_a_case_to_fit_comes_with_readings(self):
        done = json.loads(self.expect(0, "new", "x", "--kind", "fit", "--json").stdout)
        self.assertEqual((done["output"], done["readings"]), ("x.yaml", "x.csv"))
        read = json.loads(self.expect(0, "precursors", "x.csv", "--displacement", "disp_mm:mm", "--json").stdout)
        with open(self.path("x.yaml"), encoding="utf-8") as file:  # what the readings are of, as their first line says
            self.assertIn('start: "' + read["series"]["first_date"][:16], file.read())
        self.write("y.yaml", "kept\n")
        self.expect_line(2, "y.yaml: exists already; --force replaces it", "new", "y", "--kind", "fit")
        self.assertFalse(self.exists("y.csv"))

    def test_wrong(self):
        self.expect(3, "new", "absent/x")
        for name in ("", ".", "..", "absent/", "./..", "-", "./-"):
            self.expect_line(2, f'"{name}" is no name for a file', "new", name)
        self.expect_line(2, '--kind: "blok" is no kind of case; did you mean "block"?', "new",
                         "--kind", "blok")
        self.expect_line(2, '--kind: "dam" is no kind of case; known: block, fit, injection, joint, laboratory, reservoir, slope', "new",
                         "--kind", "dam")


class Describe(Case):
    def test_everything(self):
        whole = json.loads(self.expect(0, "describe", "--json").stdout)
        overview = self.expect(0, "describe").stdout
        self.assertGreaterEqual(len(whole["kinds"]), 5)
        self.assertGreaterEqual(len(whole["sections"]), 4)
        for kind in whole["kinds"]:
            self.assertTrue(kind["summary"])
            self.describe_kind(kind, overview)
            heading = re.search(rf"^(\S+)( \(\S+\))?: {re.escape(kind['summary'])}", overview, re.MULTILINE)
            known = heading[2].strip(" ()") if heading[2] else heading[1]  # what the overview names is understood
            self.assertEqual(self.expect(0, "describe", known).stdout,
                             self.expect(0, "describe", kind["name"]).stdout)
        for section in whole["sections"]:
            self.assertIn(section["name"], overview)
            self.check_parameters(section, self.expect(0, "describe", section["name"]).stdout)

    def describe_kind(self, kind, overview):
        listing = self.expect(0, "describe", kind["name"]).stdout
        self.assertGreaterEqual(len(kind["models"]), 1)
        for model in kind["models"]:
            self.assertIn(model["name"], overview)
            self.assertIn(model["name"], listing)
            text = self.expect(0, "describe", kind["name"], model["name"]).stdout
            self.check_parameters(model, text)
            if kind["command"] is not None:
                self.assertTrue(model["estimator"])
            for value in model.get("values", []):
                self.assertIn(value["key"], text)
                self.assertIn(f"needs {model['needs']}", text)

    def check_parameters(self, owner, text):
        for parameter in owner["parameters"]:
            self.assertIn(parameter["key"], text)
            self.assertTrue(parameter["doc"], parameter)
            if parameter["type"] in ("real", "integer"):
                self.assertTrue(parameter["unit"], parameter)
        self.assertLessEqual(max(map(len, text.splitlines())), 100, text)

    def test_one_model(self):
        done = json.loads(self.expect(0, "describe", "friction", "aging", "--json").stdout)
        model = done["kinds"][0]["models"][0]
        keys = {p["key"]: p for p in model["parameters"]}
        self.assertEqual(keys["dc"]["unit"], "m")
        self.assertIs(keys["dc"]["cellwise"], True)

    def test_forecasts(self):
        kind = json.loads(self.expect(0, "describe", "forecast", "--json").stdout)["kinds"][0]
        text = self.expect(0, "describe", "forecast").stdout
        self.assertIn("case", [model["name"] for model in kind["models"]])
        for gate in ("resets", "range", "acceleration", "points", "fit", "misfit", "vagueness", "driver"):
            self.assertIn(gate, [g["name"] for g in kind["gates"]])
            self.assertIn(f"\n  {gate} ", text)
        for model in kind["models"]:
            self.assertLess(model["low90"], model["low50"])
            text = self.expect(0, "describe", "forecast", model["name"]).stdout
            self.assertIn(f"needs at least {model['needs_points']} readings", text)
            self.assertIn(f"by more than {model['worst_excess']:g} of the range", text)

    def test_unknown(self):
        done = self.expect(2, "describe", "frction")
        self.assertEqual(done.stderr,
                         'lacuna: describe: "frction" is no kind or section; did you mean '
                         '"friction"?\n')
        done = self.expect(2, "describe", "friction", "ageing")
        self.assertIn('did you mean "aging"?', done.stderr)
        done = self.expect(2, "describe", "voight")
        self.assertEqual(done.stderr, 'lacuna: describe: "voight" is a forecast: lacuna describe forecast voight\n')

    def test_word(self):
        text = self.expect(0, "describe", "water").stdout
        self.assertIn("\n  pore_pressure rain\n      water that rain brings", text)
        self.assertNotIn("\n  shear", text)
        found = json.loads(self.expect(0, "describe", "Angle", "--json").stdout)["found"]
        self.assertIn(("normal", "slope", "angle"), {(hit["kind"], hit["name"], hit["key"]) for hit in found})
        found = json.loads(self.expect(0, "describe", "rest", "--json").stdout)["found"]
        for hit in found:  # words begin so, they do not merely hold it: "the rest", not "forest"
            self.assertRegex(" ".join((hit["name"], hit["key"], hit["text"])), r"(?i)(?<![a-z0-9])rest")
        self.expect(2, "describe", "no")           # in no text as two letters
        self.expect(2, "describe", "water", "--pipe")


def block_failure_time():
    """Constant load, aging law, no damping: f fixed, so v = v_i (theta_i/theta)^(b/a), and
    theta follows one equation, integrated here by Runge-Kutta in x = theta/theta_i."""
    a, b, dc, ratio = 0.010, 0.015, 1e-4, 0.9
    v = 0.01 / (7 * 86400)
    theta = ratio ** (1 - b / a) * dc / v
    target, t, log_theta = 1.0, 0.0, 0.0

    def rate(y):
        return exp(-y) / theta - v / dc * exp(-b / a * y)

    end = -a / b * log(target / v)
    while True:
        step = 1e-3 / abs(rate(log_theta))
        k1 = rate(log_theta)
        k2 = rate(log_theta + step / 2 * k1)
        k3 = rate(log_theta + step / 2 * k2)
        k4 = rate(log_theta + step * k3)
        following = log_theta + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        if following <= end:
            return t + (end - log_theta) / rate(end)
        log_theta, t = following, t + step


def main():
    global PROGRAM, SOURCE
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
