#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that the documentation states are those of the program, both ways: options and JSON keys of
the manual pages, variables, dimensions and attributes of docs/format.md, keys of a case.

usage: test_names.py PROGRAM SOURCE_FOLDER [FOLDER_OF_FILES]

The folder holds what the bundled cases wrote (tests/programs.cmake); other files are made here.
"""

import glob
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
FILES = os.path.abspath(sys.argv[3]) if len(sys.argv) > 3 else ""
sys.path.insert(0, os.path.join(SOURCE, "tests", "support"))
import completed  # noqa: E402
import doc_commands  # noqa: E402

# (command, its words): between them they print every key and write every variable.
CALLS = (
    ("run", "cases/block.yaml -o block.nc --set institution=Somewhere"),
    ("run", "cases/block.yaml -o picked.nc --accuracy 1%"),
    ("run", "cases/block.yaml -o few.nc --set solver.fidelity=lumped"),
    ("run", "cases/block.yaml -o open.nc --set solver.fidelity=auto"),
    ("run", "cases/block.yaml -o kept.nc --set 'output.fields=[slip, slip_rate, state]'"),
    ("run", "--from kept.nc --at 3 -o branch.nc --set solver.rtol=1e-7"),
    ("check", "--from kept.nc --at 3"),
    ("run", "cases/transfer/micro-slips.yaml -o run.nc --set analysis.rg.field=equal --set "
            "output.fields=[slip,slip_rate,state,traction,pore_pressure] --set output.fields_every.steps=200 "
            "--set 'output.points=[{name: A, x: 1 mm, y: 1 mm}]'"),
    ("run", "cases/load/reservoir.yaml -o lake.nc --set output.fields=[factor_of_safety] --set "
            "'output.factor_of_safety.reference_rate=0.5 mm/day'"),
    ("run", "cases/load/turning.yaml -o turned.nc --set interface.levels=3 --set 'output.points=[{name: A, x: 1 m, y: 1 m}]'"),
    ("run", "cases/load/rain.yaml -o rain.nc"),
    ("run", "cases/weakening/pressurization.yaml -o hot.nc --set output.fields=[excess_pore_pressure,temperature]"),
    ("run", "cases/weakening/bridges.yaml -o broken.nc --set output.fields=[broken_cohesion]"),
    ("run", "cases/load/water-table.yaml -o table.nc"),
    ("run", "cases/load/chair.yaml -o chair.nc"),
    ("run", "cases/load/toe.yaml -o toe.nc"),
    ("contact", "cases/surface/joint.yaml -o joint.nc"),
    ("contact", "cases/surface/file.yaml -o file.nc"),
    ("contact", "cases/contact/self-affine.yaml -o contact.nc"),
    ("contact", "cases/shear-cycle.yaml -o cycle.nc --set interface.levels=6"),
    ("rg", "cases/rg/fix.yaml -o rg.nc"),
    ("rg", "run.nc -o now.nc"),
    ("precursors", "cases/data/creep.csv --displacement disp_mm:mm --driver cases/data/creep.csv/disp_mm:mm -o series.nc --rolling --failed-at "
                   "2020-08-12"),
    ("precursors", "run.nc -o run-precursors.nc"),
    ("precursors", "cases/data/creep.csv --case cases/fit/block.yaml -o fitted.nc --set fit.steps=8 "
                   "--set fit.burn=2 --set fit.starts=2 --onset 5,20"),
    ("fit", "cases/vajont-lake.yaml cases/data/vajont_rates.csv -o stated.nc --set fit.steps=8 --set fit.burn=2 "
            "--set fit.rounds=0 --set fit.starts=2 --set fit.walkers=12"),
    ("fit", "cases/fit/block.yaml cases/data/creep.csv -o fit.nc --set fit.steps=8 --set fit.burn=2 "
            "--set fit.starts=2 --set 'output.points=[{name: A}]' --set fit.point=A"),
    ("fit", "cases/fit/velocity-step.yaml cases/data/velocity_step.csv -o step.nc --set fit.starts=2 --set fit.steps=8 "
            "--set fit.burn=2 --set fit.rounds=0"),
    ("trade", "cases/block.yaml -o trade.nc --dials rtol=1e-3:1e-5 --reach 1%"),
    ("sweep", "cases/block.yaml -o sweep.nc --design saltelli --members 8 --over friction.aging.dc='uniform(1 mm, 2 mm)' "
              "--over friction.aging.a='uniform(0.009, 0.01)'"),
    ("sweep", "cases/block.yaml -o tornado.nc --design tornado --over friction.aging.dc='1 mm, 2 mm'"),
    ("check", "cases/vajont.yaml"),
    ("run", "cases/century.yaml -o compared.nc --set 'output.points=[{name: A}]' --set compare.0.point=A"),
    ("report", "block.nc"),
    ("export", "run.nc"),
    ("new", "slope"),
    ("new", "fitted --kind fit"),
    ("describe", ""),
    ("describe", "water"),
    ("describe", "rock limestone"),
    ("completion", "bash"),
)


def call(words, folder=SOURCE, status=0):
    done = subprocess.run([PROGRAM, *words], capture_output=True, text=True, check=False, timeout=200,
                          cwd=folder, stdin=subprocess.DEVNULL)
    if done.returncode != status:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stderr}")
    return done.stdout


def manual(command):
    name = f"lacuna-{command}" if command else "lacuna"
    return doc_commands.read(os.path.join(SOURCE, "docs", "man", f"{name}.1.scd"))


def section(text, heading):
    match = re.search(rf"^# {heading}\n(.*?)(?=^# |\Z)", text, re.DOTALL | re.MULTILINE)
    return match.group(1) if match else ""


# Values under these are named by the user, or by `lacuna describe indicator`.
OPEN = ("values", "parameters", "settings", "scene")
# Keys that no call above prints, and where they are tested.
ELSEWHERE = {
    "run": {"resumed_at_s", "resumed_from",  # case.test_resume
            "date", "modelled_slip_m", "modelled_slip_rate_m_s", "observed_slip_m",
            "observed_slip_rate_m_s"},  # case.cases.vajont: readings of dates
    "precursors": {"stations", "station", "error"},  # case.test_readings: several columns
}
# In tables of docs/format.md, written only where errors of these are estimated: case.test_fit.
UNSEEN = {"error_time", "error_velocity", "resumed"}


def keys(value):
    """All keys of a JSON value but those of OPEN."""
    if isinstance(value, dict):
        return set(value) | {key for name, inner in value.items()
                             if not (name in OPEN and isinstance(inner, dict)) for key in keys(inner)}
    if isinstance(value, list):
        return {key for inner in value for key in keys(inner)}
    return set()


def helped(*command):
    """(name, value) of every option of a help text, letters among them."""
    found = {}
    for line in call([*command, "--help"]).split("\n"):
        match = re.match(r" +(?:(-\w), +)?(--[\w-]+)(?: ([A-Z][\w:=,/]*))?(?: |$)", line)
        if match:
            for name in match.group(1, 2):
                if name:
                    found[name] = match.group(3) or ""
    return found


def stated(text):
    """Names of the options that the heads of a manual page's lists state."""
    heads = re.findall(r"^(\*-[^\n]*)\n\t", text, re.MULTILINE)
    return {name for head in heads for name in re.findall(r"\*(--?[\w-]+)\*", head)}


def parts(page):
    """Sections of docs/format.md by the command that writes the file."""
    found = {"run": page[:page.index("## The file of")]}
    for match in re.finditer(r"^## The file of `lacuna (\w+)`\n(.*?)(?=^##? )", page,
                             re.DOTALL | re.MULTILINE):
        found[match.group(1)] = match.group(2)
    return found


def quoted(text):
    return set(re.findall(r"`(\w+)`", text))


def tabled(text):
    """What the first column of tables of variables, dimensions and attributes quotes."""
    found, inside = set(), False
    for line in text.split("\n"):
        if not line.startswith("|"):
            inside = False
        elif re.match(r"\| (variable|dimension|attribute) \|", line):
            inside = True
        elif inside:
            found |= quoted(line.split("|")[1])
    return found


class Manual(unittest.TestCase):
    commands = [name[len("lacuna-"):-len(".1.scd")] for name in os.listdir(os.path.join(SOURCE, "docs", "man"))
                if name.startswith("lacuna-")]

    def test_all_commands(self):
        listed = completed.commands(PROGRAM)
        self.assertEqual(sorted(listed), sorted(self.commands))
        for command in listed:
            self.assertIn(f"*lacuna-{command}*(1)", manual(""))

    def test_options(self):
        common = helped()
        self.assertEqual(stated(section(manual(""), "COMMON OPTIONS")), set(common) | {"--set"})
        for command in self.commands:
            page = manual(command)
            own = set(helped(command)) - {"--set"}
            written = stated(page) - {"--set"}
            with self.subTest(command):
                self.assertEqual(own, written - (set(common) if "--set" in helped(command) else set()))

    def test_values(self):
        """A value is called in the page what it is called in the help text."""
        for command in self.commands:
            known = helped(command)
            for head in re.findall(r"^(\*--[^\n]*)\n\t", manual(command), re.MULTILINE):
                for name, value in re.findall(r"\*(--[\w-]+)\*(?: _([A-Z][^_ ]*)_)?", head):
                    if name in known and "," not in head:
                        self.assertEqual(bool(value), bool(known[name]), f"{command} {name}")


class Written(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="lacuna-names-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        os.symlink(os.path.join(SOURCE, "cases"), os.path.join(cls.folder, "cases"))
        cls.printed, cls.files = {}, {}
        for command, words in CALLS:
            words = shlex.split(words)
            # of eight steps no sampler converges: what it drew is written all the same
            text = call([command, *words, "--json"], cls.folder, 1 if command == "fit" else 0)
            cls.printed.setdefault(command, set()).update(keys(json.loads(text)))
            if "-o" in words:
                cls.files[os.path.join(cls.folder, words[words.index("-o") + 1])] = command
        wrong = os.path.join(SOURCE, "tests", "case", "wrong", "alpha-without-b.yaml")
        cls.printed["check"] |= keys(json.loads(call(["check", wrong, "--json"], status=2)))
        for path in glob.glob(os.path.join(FILES, "*-*.nc")) if FILES else ():
            with netCDF4.Dataset(path) as file:
                cls.files[path] = re.match(r".*?lacuna(?: -\S+)* (\w+)", file.history).group(1)
        cls.page = parts(doc_commands.read(os.path.join(SOURCE, "docs", "format.md")))
        described = json.loads(call(["describe", "indicator", "--json"]))["kinds"][0]["models"]
        cls.indicated = {f"{m['name']}_{v['key']}" for m in described for v in m["values"]}
        cls.indicated |= {f"{m['name']}_points" for m in described}

    def test_json(self):
        """Every key is in the manual page, and every key of the page is printed."""
        for command, printed in self.printed.items():
            page = set(re.findall(r"\*(\w+)\*", section(manual(command), "JSON")))
            with self.subTest(command):
                self.assertEqual({key for key in printed - page if "." not in key
                                  and key not in ("attribution",)}, set())
                self.assertEqual(page - printed - ELSEWHERE.get(command, set()), set())

    def test_every_name_in_a_file_is_documented(self):
        self.assertGreater(len(self.files), 12)
        everywhere = quoted(self.page["run"])
        for path, command in self.files.items():
            known = quoted(self.page[command])
            with self.subTest(path), netCDF4.Dataset(path) as file:
                own = {name for name, variable in file.variables.items()
                       if {"case_key", "sweep_key"} & set(variable.ncattrs())}
                names = {re.sub(r"level_\d+$", "level_0", name) for name in file.variables}
                self.assertEqual({n for n in names if not n.startswith("driver_")} - known - own - self.indicated, set())
                self.assertEqual(set(file.ncattrs()) - known - everywhere, set())
                for name in file.dimensions:
                    self.assertRegex(self.page[command], rf"\b{name}\b")

    def test_every_documented_name_is_in_a_file(self):
        found = {}
        for path, command in self.files.items():
            with netCDF4.Dataset(path) as file:
                found.setdefault(command, set()).update(file.variables, file.ncattrs(), file.dimensions)
        for command, text in self.page.items():
            unseen = UNSEEN if FILES else UNSEEN | {"seed"}
            wanted = {name for name in tabled(text) if not name.startswith(("INDICATOR", "driver_NAME"))}
            indicators = wanted & self.indicated if command == "precursors" else set()
            with self.subTest(command):
                self.assertEqual(wanted - indicators - found[command] - unseen, set())


class Keys(unittest.TestCase):
    """Keys of a case that pages quote."""

    @classmethod
    def setUpClass(cls):
        cls.keys = {re.sub(r"\.0(?=\.)", "", key) for key in completed.keys(PROGRAM)}
        cls.roots = {key.split(".")[0] for key in cls.keys if "." in key}
        cls.options = set()
        for command in Manual.commands:
            cls.options |= set(helped(command))
        cls.options |= set(helped())

    def known(self, key):
        key = re.sub(r"\.(\d+|LAW|MODEL|PARAMETER)(?=\.|$)", "", key)
        if any(key == k or k.startswith(key + ".") or key.startswith(k + ".") for k in self.keys):
            return True
        return any(re.fullmatch(re.sub(r"\.(aging)\.", r".\\w+.", k), key) for k in self.keys)

    def test_keys(self):
        tried = 0
        for page in doc_commands.pages(SOURCE):
            text = doc_commands.read(os.path.join(SOURCE, page))
            manual_page = page.endswith(".scd")
            marks = r"[*_]([^*\n]+?)[*_](?!\w)" if manual_page else r"`([^`\n]+)`"
            for span in re.findall(marks, text):
                match = re.fullmatch(r"([a-z_]+(?:\.[\w-]+)+)(?:: ?(\S+))?", span)
                if not match or match.group(1).split(".")[0] not in self.roots:
                    continue
                key, value = match.groups()
                if re.search(r"\.(c|h|py|md|nc|yaml|csv|html|txt|so|json)$", key):
                    continue
                tried += 1
                with self.subTest(f"{page}: {span}"):
                    self.assertTrue(self.known(key))
                    if value and value.isalpha():
                        choices = completed.choices(PROGRAM, key)
                        self.assertTrue(not choices or value in choices, choices)
        self.assertGreater(tried, 120)

    def test_data(self):
        """Every file that is shipped as data is in the table of its folder, and nothing else."""
        folder = os.path.join(SOURCE, "cases", "data")
        text = doc_commands.read(os.path.join(folder, "README.md"))
        rows = [line.split("|")[1] for line in text.split("\n") if line.startswith("| `")]
        named = {name for row in rows for name in re.findall(r"`([^`]*)`", row)}
        self.assertEqual(named, set(os.listdir(folder)) - {"README.md"})

    def test_options(self):
        """Options that pages quote are of the program, of a tool, or of what builds and tests."""
        tools = [path for pattern in ("tools/*", "tools/plot/*", "tools/studies/*", "tools/dev/*", "tools/dev/lint/*", "tests/support/*.py")
                 for path in glob.glob(os.path.join(SOURCE, pattern)) if os.path.isfile(path)]
        others = "\n".join(doc_commands.read(path) for path in tools)
        known = self.options | set(re.findall(r"(?<![\w-])--[a-z][\w-]*", others))
        known |= {"--preset", "--build", "--install", "--prefix", "--target", "--config", "--static", "--headless", "--convert-to"}
        for page in doc_commands.pages(SOURCE):
            text = doc_commands.read(os.path.join(SOURCE, page))
            for span in re.findall(r"`([^`\n]+)`", text) if page.endswith(".md") else ():
                for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", span):
                    self.assertIn(option, known, page)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
