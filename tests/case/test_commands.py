#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command that the documentation shows is one: run where it is quick, else asked whether its
words are known.

usage: test_commands.py PROGRAM SOURCE_FOLDER BUILD_FOLDER

Blocks marked ```sh are run by run_page.py, and the commands of README.md; here are the others
(tests/support/doc_commands.py finds them). Each is

  run      the commands of a page one after the other, in a folder of its own
  long     what LONG names, with why: the program takes its options and its case, a tool its options
  named    builds, tests and installs: presets, targets, tests, files and options that they name exist
  pattern  with a name in capitals or `...`, or in running text: options as for the long ones

and one that is none of these fails.
"""

import functools
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

PROGRAM, SOURCE, BUILD = map(os.path.abspath, sys.argv[1:4])
sys.path.insert(0, os.path.join(SOURCE, "tests", "support"))
import doc_commands  # noqa: E402
import run_page  # noqa: E402

# What takes too long for a test, or needs more than the program, and where the same is tested.
LONG = (
    (r"lacuna run .*interface.levels=13", "takes 20 minutes: case.test_ranks runs smaller ones"),
    (r".*\bprz\b", "the law of the how-to: case.test_howto_law adds it"),
    (r"lacuna trade ", "runs a case tens of times: case.test_trade trades small ones"),
    (r"lacuna fit .*cases/(fit/block|fit/century|fit/velocity-step|vajont-lake)", "samples for a minute: case.test_fit*, case.fit.*"),
    (r"lacuna rg .*rg\.seeds=", "an ensemble: case.test_rg has a small one"),
    (r"lacuna run cases/seas/bp[68]\.yaml --set", "fine grids of benchmarks: case.test_seas has coarse ones"),
    (r".*tools/plot/plot_trade\.py", "draws what a long one makes: case.test_trade"),
    (r".*tools/\w+/(bridge|rg_table|forecast_coverage|precursor_ensemble|area_scaling)\.py", "a study"),
    (r".*tools/\w+/(events_statistics|fidelity|fidelity_events|auto|figure1|figure3|accuracy)\.py", "a study"),
    (r".*tools/\w+/(hindcasts|verdicts|driven_failures|recovery|trade_table|rg_rules|costs|vajont)\.py", "a study"),
    (r".*tools/\w+/lacuna_plot\.py .*--(paper|compare)", "half a minute: case.test_pictures"),
)
# What changes the machine, does all that CI does, or serves until it is ended.
OUTSIDE = (r"git clone ", r"sudo ", r"apt ", r"/usr/bin/python3 -m http\.server ")
PATTERN = re.compile(r"(?<![$\w])[A-Z]{3,}\b|\.\.\.|…")
# What `lacuna watch` reads, and readings that examples name.
SMALL = {"fleet.yaml": 'displacement: "way:mm"\n', "readings.csv": "station,time,way\nP1,2024-01-01,0.5\nP2,2024-01-01,1.5\n",
         "prisms.csv": "time,P1 [mm],P2 [mm]\n2024-01-01,0.5,1.5\n2024-01-02,0.7,1.6\n",
         "gnss.csv": "time,e,n,u\n2024-01-01,0.5,1.5,0.1\n2024-01-02,0.7,1.6,0.2\n",
         "rain.csv": "time,rain_mm\n2020-06-01,3\n2020-06-02,0\n"}
# Files of the reader's own that examples name.
OWN = {"slope.yaml": "cases/fit/block.yaml", "joint.yaml": "cases/transfer/patch.yaml"}

# A Python tool up to where its options have been understood.
BEGIN = """
import argparse, runpy, sys
whole = argparse.ArgumentParser.parse_args
def parse(self, *words, **named):
    whole(self, *words, **named)
    print("begins")
    sys.exit(0)
argparse.ArgumentParser.parse_args = parse
sys.argv = sys.argv[1:]
sys.path[:0] = ["tools/plot", "tools/studies"]
runpy.run_path(sys.argv[0], run_name="__main__")
"""


def call(words, **named):
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=250,
                          stdin=subprocess.DEVNULL, cwd=named.pop("cwd", SOURCE), **named)


def source_text(*patterns):
    """The text of all files of these patterns."""
    paths = [path for p in patterns for path in glob.glob(os.path.join(SOURCE, p), recursive=True)]
    return "\n".join(doc_commands.read(path) for path in sorted(paths))


def series(path):
    """Readings under the columns that examples name."""
    with open(os.path.join(SOURCE, "cases", "data", "creep.csv"), encoding="utf-8") as file:
        rows = [line.strip().split(",") for line in file if line[:4] == "2020"]
    with open(path, "w", encoding="utf-8") as file:
        file.write("when;Zeit;d;disp;Weg_mm;d [cm]\n")
        for when, value in rows:
            year, month, day, clock = re.match(r"(\d+)-(\d+)-(\d+)T(.*)", when).groups()
            file.write(f"{when};{day}.{month}.{year} {clock};{value};{value};{value};"
                       f"{float(value) / 10}\n")


@functools.lru_cache(maxsize=None)
def options_of(command):
    text = call([PROGRAM, command, "--help"]).stdout + call([PROGRAM, "--help"]).stdout
    return set(re.findall(r"(?<![\w-])(--?[\w][\w-]*)", text))


@functools.lru_cache(maxsize=None)
def tests():
    """(name, labels) of every test."""
    listed = json.loads(call(["ctest", "--test-dir", BUILD, "--show-only=json-v1"]).stdout)
    return [(test["name"], {label for p in test.get("properties", ()) if p["name"] == "LABELS"
                            for label in p["value"]}) for test in listed["tests"]]


@functools.lru_cache(maxsize=None)
def presets():
    held = json.loads(doc_commands.read(os.path.join(SOURCE, "CMakePresets.json")))
    return {kind: {preset["name"] for preset in held[kind]}
            for kind in ("configurePresets", "buildPresets", "testPresets")}


def word_after(words, option):
    return words[words.index(option) + 1] if option in words[:-1] else None


def wrong_cmake(words):
    build = "--build" in words
    preset = word_after(words, "--preset")
    if preset and preset not in presets()["buildPresets" if build else "configurePresets"]:
        return f"no preset {preset}"
    target = word_after(words, "--target")
    custom = source_text("CMakeLists.txt", "tools/cmake/*.cmake", "tests/*.txt", "tests/*.cmake")
    if target and f"add_custom_target({target} " not in custom:
        return f"no target {target}"
    for option in [word for word in words if word.startswith("-DLACUNA")]:
        if option[2:].split("=")[0] not in custom:
            return f"no option {option}"
    return None


def wrong_ctest(words):
    if "--preset" in words and word_after(words, "--preset") not in presets()["testPresets"]:
        return "no such preset"
    label, name = word_after(words, "-L"), word_after(words, "-R")
    for test, labels in tests():
        if (not label or any(re.search(label, one) for one in labels)) and (
                not name or re.search(name, test)):
            return None
    return "no such test"


def wrong_file(words):
    """A script, or a program of the tests."""
    built = re.fullmatch(r"build/tests/(\w+)", words[0])
    if built:
        name = built.group(1)
        label, _, rest = name.partition("_")
        return None if any(os.path.exists(os.path.join(SOURCE, "tests", path)) for path in (
            f"{label}/{rest}.c", f"bench/{name}.c")) else f"no {words[0]}"
    if not os.path.exists(os.path.join(SOURCE, words[0])):
        return f"no {words[0]}"
    text = doc_commands.read(os.path.join(SOURCE, words[0]))
    for word in words[1:]:
        bench = words[0] == "tools/bench"
        if bench and not os.path.exists(os.path.join(SOURCE, f"tests/bench/bench_{word}.c")):
            return f"no benchmark {word}"
        if word.startswith("--") and word not in text:
            return f"no option {word}"
    return None


def wrong_lacuna(words, folder):
    """Command, options, keys and case of a command that is not run."""
    words = [word for word in words if word not in ("...", "…")]
    if len(words) > 1 and words[1].startswith("-"):
        command, options = "", {word for word in words[1:] if word.startswith("-")}
    else:
        command = words[1]
        options = {word.split("=")[0] for word in words[2:] if re.match(r"--?[A-Za-z]", word)}
    names = [command.split("|")[0]] if command and command != "COMMAND" else []
    for name in names:
        if call([PROGRAM, name, "--help"]).returncode != 0:
            return f"no command {name}"
    known = options_of(names[0]) if names else options_of("run") | options_of("precursors")
    if options - known:
        return f"no option {options - known}"
    case = words[2] if len(words) > 2 and words[2].endswith(".yaml") else ""
    if case and os.path.exists(os.path.join(folder, case)):
        sets = [w for i, word in enumerate(words) if word == "--set" for w in words[i:i + 2]]
        done = call([PROGRAM, "check", "-q", case, *sets], cwd=folder)
        return done.stderr if done.returncode != 0 else None
    return None


def wrong_tool(words):
    """Whether a Python tool takes the words."""
    tool = [word for word in words if word.endswith(".py")][0]
    rest = words[words.index(tool) + 1:]
    if not os.path.exists(os.path.join(SOURCE, tool)):
        return f"no {tool}"
    if "argparse" not in doc_commands.read(os.path.join(SOURCE, tool)):
        return wrong_file([tool, *rest])
    done = call([sys.executable, "-c", BEGIN, tool, *rest])
    return None if done.stdout.endswith("begins\n") else done.stderr or done.stdout


def wrong_names(text, folder):
    """What is wrong with the words of a command that is not run; None where nothing is."""
    for part in re.split(r"&&|\| (?=\w)", text):
        words = shlex.split(part)
        if words[0] in ("cd", "source", "tail", "grep", "export", "ncdump", "jq"):
            continue
        if words[0] == "lacuna":
            found = wrong_lacuna(words, folder)
        elif words[0] == "cmake":
            found = wrong_cmake(words)
        elif words[0] == "ctest":
            found = wrong_ctest(words)
        elif words[0] == "cpack":
            found = None if "include(CPack)" in source_text("CMakeLists.txt", "tools/cmake/*") else "no cpack"
        elif words[0] == "man":
            page = os.path.join(SOURCE, "docs", "man", f"{words[1]}.1.scd")
            found = None if os.path.exists(page) else f"no {page}"
        elif any(word.endswith(".py") for word in words) and words[0] != "tests/support/run_page.py":
            found = wrong_tool(words)
        elif words[0].startswith(("tools/", "tests/", "build/")):
            found = wrong_file(words)
        elif any(re.match(outside, part.strip()) for outside in OUTSIDE):
            found = None
        else:
            found = "is nothing that this test knows"
        if found:
            return found
    return None


def is_long(text):
    return any(re.match(pattern, text) for pattern, _ in LONG)


def runs(command):
    """Whether it is run here."""
    text = command.text
    if is_long(text) or any(re.match(outside, text) for outside in OUTSIDE) or "--view" in text:
        return False  # a page that is served waits for its reader
    if PATTERN.search(text):
        return False
    if command.kind == "text":
        return re.match(r"lacuna (describe|check) ", text)
    return re.match(r"(lacuna|ncdump|source|for|/usr/bin/python3|tools/\w+/\w+\.py) ", text)


class Folder:
    """Where the commands of one page are run."""
    made = {}  # of a command that was run for another page: the files that it made

    def __init__(self, path):
        self.path = path
        for name in ("cases", "docs", "tools", "tests"):
            os.symlink(os.path.join(SOURCE, name), os.path.join(path, name))
        os.symlink(os.path.dirname(PROGRAM), os.path.join(path, "build"))
        for name in ("prism.csv", "series.csv"):
            series(os.path.join(path, name))
        for name, text in SMALL.items():
            with open(os.path.join(path, name), "w", encoding="utf-8") as file:
                file.write(text)

    def shell(self, text):
        if "completion zsh" in text:
            return ["zsh", "-f", "-c", f"autoload -U compinit; compinit -D; {text}"]
        if "completion fish" in text:
            return ["fish", "--no-config", "-c", text]
        return ["bash", "-eu", "-o", "pipefail", "-c", doc_commands.with_this_python(text)]

    def put_own(self, text):
        """The reader's own case, where the command names one that it does not make."""
        for name, case in OWN.items():
            path = os.path.join(self.path, name)
            if name in text and not os.path.exists(path):
                with open(path, "w", encoding="utf-8") as file:
                    file.write(doc_commands.read(os.path.join(SOURCE, case)).replace("../", "cases/"))

    def run(self, text):
        """What went wrong; None where nothing did."""
        self.put_own(text)
        shell = self.shell(text)
        if not shutil.which(shell[0]):
            return None
        if text in self.made:
            for name, path in self.made[text].items():
                if not os.path.exists(os.path.join(self.path, name)):
                    shutil.copy(path, os.path.join(self.path, name))
            return None
        if not shutil.which("jq"):
            shell[-1] = re.sub(r"\| jq \S+", "", shell[-1])
        before = set(os.listdir(self.path))
        path = os.pathsep.join([os.path.dirname(PROGRAM), os.path.dirname(sys.executable), os.environ["PATH"]])
        done = call(shell, cwd=self.path, env=dict(os.environ, PATH=path, MPLBACKEND="Agg"))
        if done.returncode != 0:
            return f"exit {done.returncode}: {done.stderr[-600:]}"
        self.made[text] = {name: os.path.join(self.path, name)
                           for name in set(os.listdir(self.path)) - before}
        return None


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.commands, cls.odd = doc_commands.gather(SOURCE, PROGRAM)
        cls.folder = tempfile.mkdtemp(prefix="lacuna-commands-")
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)

    def test_every_command(self):
        readme = {block.strip() for _, block in
                  run_page.indented(doc_commands.read(os.path.join(SOURCE, "README.md")))}
        folders, ran, named = {}, 0, 0
        for command in self.commands:
            if command.page == "README.md" and command.text in readme:
                continue
            if command.page not in folders:
                path = os.path.join(self.folder, str(len(folders)))
                os.mkdir(path)
                folders[command.page] = Folder(path)
            folder = folders[command.page]
            with self.subTest(f"{command.page}:{command.line}: {command.text}"):
                if runs(command):
                    ran += 1
                    self.assertIsNone(folder.run(command.text))
                else:
                    named += 1
                    folder.put_own(command.text)
                    self.assertIsNone(wrong_names(command.text, folder.path))
        self.assertGreater(ran, 40)
        self.assertGreater(named, 80)

    def test_no_other_lines_look_like_commands(self):
        self.assertEqual([c for c in self.odd if "──►" not in c.text], [])

    def test_long_ones_are_shown(self):
        """LONG names nothing that no page shows."""
        for pattern, _ in LONG:
            self.assertTrue([c for c in self.commands if re.match(pattern, c.text)], pattern)

    def test_first_lines_of_tools(self):
        """Options that a tool's first lines name are options of it."""
        for path in glob.glob(os.path.join(SOURCE, "tools", "*", "*.py")):
            text = doc_commands.read(path)
            head = re.search(r'"""(.*?)"""', text, re.DOTALL).group(1)
            named = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", head))
            own = set(re.findall(r'"(--[a-z][\w-]*)"', text))
            if named - own:  # given by what it imports, or to lacuna
                own |= set(re.findall(r'"(--[a-z][\w-]*)"', source_text("tools/*/*.py")))
                own |= options_of("run") | options_of("precursors") | options_of("trade")
            self.assertFalse(named - own, path)

    def test_what_quickstart_names_next(self):
        text = doc_commands.read(os.path.join(SOURCE, "tools", "quickstart"))
        lines = re.findall(r"^  ((?:lacuna|ncdump|/usr).*)$", text, re.MULTILINE)
        self.assertGreater(len(lines), 4)
        for line in lines:
            self.assertIsNone(wrong_names(re.sub(r" {3,}.*", "", line), SOURCE), line)

    def test_commands_in_cases_are_known(self):
        """What the first lines of a case say to run."""
        for path in glob.glob(os.path.join(SOURCE, "cases", "**", "*.yaml"), recursive=True):
            for text in re.findall(r"^#   (lacuna .*)$", doc_commands.read(path), re.MULTILINE):
                self.assertIsNone(wrong_lacuna(shlex.split(text), SOURCE), path)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
