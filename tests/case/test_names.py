#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names that the documentation states are those of the program, both ways: options and JSON keys of
the manual pages, attributes of docs/format.md, variables of docs/tables/files.md, keys of a case.

usage: test_names.py PROGRAM SOURCE_FOLDER [FOLDER_OF_FILES]

The folder holds what the bundled cases wrote (tests/programs.cmake); other files are made here.
"""

import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
FILES = os.path.abspath(sys.argv[3]) if len(sys.argv) > 3 else ""
sys.path[:0] = [os.path.join(SOURCE, "tests", "support"), os.path.join(SOURCE, "tools", "dev")]
import completed  # noqa: E402
import doc_commands  # noqa: E402
import tables  # noqa: E402

def call(words, folder=SOURCE, status=0):
    return tables.call(PROGRAM, words, folder, status)


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
    """Sections of a page by the command that writes the file; of docs/format.md that of a run is first."""
    found = {"run": page[:page.index("## The file of")]}
    for match in re.finditer(r"^## The file of `lacuna (\w+)`\n(.*?)(?=^##? |\Z)", page,
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
        cls.printed, cls.files, cls.written = {}, {}, []
        for command, text, path in tables.make_files(PROGRAM, cls.folder):
            cls.printed.setdefault(command, set()).update(keys(json.loads(text)))
            if path:
                cls.files[path] = command
                cls.written.append((command, path))
        wrong = os.path.join(SOURCE, "tests", "case", "wrong", "alpha-without-b.yaml")
        cls.printed["check"] |= keys(json.loads(call(["check", wrong, "--json"], status=2)))
        for path in glob.glob(os.path.join(FILES, "*-*.nc")) if FILES else ():
            with netCDF4.Dataset(path) as file:
                cls.files[path] = re.match(r".*?lacuna(?: -\S+)* (\w+)", file.history).group(1)
        cls.page, listed = (parts(doc_commands.read(os.path.join(SOURCE, "docs", *path)))
                            for path in (("format.md",), ("tables", "files.md")))
        cls.known = {command: text + listed.get(command, "") for command, text in cls.page.items()}
        cls.indicated = tables.of_indicators(PROGRAM)

    def test_variables(self):
        """The page of variables is what the files say of them."""
        self.assertEqual(tables.difference("files", tables.files_page(self.written, self.indicated)), [])

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
        everywhere = quoted(self.known["run"])
        for path, command in self.files.items():
            known = quoted(self.known[command])
            with self.subTest(path), netCDF4.Dataset(path) as file:
                names = {tables.named(*item, self.indicated) for item in file.variables.items()} - {None}
                self.assertEqual(names - known, set())
                self.assertEqual(set(file.ncattrs()) - known - everywhere, set())
                for name in file.dimensions:
                    self.assertRegex(self.known[command], rf"\b{name}\b")

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
