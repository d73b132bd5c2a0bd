#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shells are told of every command, every option of each and every model; bash
(and fish, zsh, where they are installed) complete them in fact, bash and zsh at a terminal by the Tab key.

usage: test_completion.py PROGRAM SOURCE_FOLDER
"""

import glob
import json
import os
import pty
import random
import re
import select
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
sys.path.insert(0, os.path.join(SOURCE, "tests", "support"))
import completed  # noqa: E402

WITH_PROGRAM = dict(os.environ, PATH=os.path.dirname(PROGRAM) + os.pathsep + os.environ["PATH"])


def call(*words, **options):
    return subprocess.run(words, capture_output=True, text=True, check=True, timeout=60,
                          stdin=subprocess.DEVNULL, **options).stdout


def options_of(*command):
    """The long options and letters that a help text lists."""
    text = call(PROGRAM, *command, "--help")
    return set(re.findall(r"^ +(?:-\w, )?(--[\w-]+)", text, re.MULTILINE)) | set(
        re.findall(r"^ +(-\w), --", text, re.MULTILINE))


def typed(shell, script, line, *files):
    """The words of a command line that was typed at a terminal, with Tab where it has one."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (("script", script), *((file, "") for file in files)):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as out:
                out.write(text)
        file = os.path.join(folder, "script")
        begin = {"bash": ["bash", "--norc", "--noprofile", "-i"], "zsh": ["zsh", "-f", "-i"]}[shell]
        ready = {"bash": f"source {file}", "zsh": f"autoload -U compinit; compinit -D; source {file}"}
        child, end = pty.fork()
        if child == 0:
            os.chdir(folder if files else SOURCE)
            os.environ.update(WITH_PROGRAM, PS1="$ ", TERM="dumb", HOME=folder)
            os.execvp(begin[0], begin)
        os.write(end, (ready[shell] + "; lacuna() { printf '<%s>' \"$@\"; echo '</END>'; }\n"
                       f"{line}\nexit\n").encode())
        text, deadline = b"", 60
        while select.select([end], [], [], deadline)[0]:
            try:
                text += os.read(end, 65536)
            except OSError:  # the other end is closed
                break
        os.close(end)
        os.waitpid(child, 0)
    found = re.findall(r"(<[^\r\n]*)</END>", text.decode().replace("\b", ""))
    assert found and b"_lacuna" not in text, text.decode()  # nor an error of the script
    return re.findall(r"<([^>]*)>", found[-1])


def flattened(node, path=""):
    """The keys of a resolved case, places in lists as 0."""
    if isinstance(node, dict):
        return {key for name, value in node.items() for key in flattened(value, f"{path}.{name}")}
    if isinstance(node, list) and node and isinstance(node[0], dict):
        return {key for value in node for key in flattened(value, path + ".0")}
    return {path[1:]}


class Completion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.common = options_of()
        cls.listed = re.findall(r"^  ([a-z]+) ", call(PROGRAM, "--help"), re.MULTILINE)
        cls.models = json.loads(call(PROGRAM, "describe", "--json"))
        cls.script = {}
        for shell in ("bash", "zsh", "fish"):
            cls.script[shell] = call(PROGRAM, "completion", shell)

    def offered(self, *words):
        return set(completed.offered(PROGRAM, *words))

    def test_every_command(self):
        self.assertGreater(len(self.listed), 7)
        self.assertEqual(self.offered(), set(self.listed))
        self.assertEqual(self.offered(""), set(self.listed))
        self.assertEqual(self.offered("-"), self.common)
        self.assertEqual(self.offered("--json", "che"), {"check"})
        self.assertEqual(self.offered("-o", "run", "che"), {"check"})  # run is a file

    def test_options_of_each(self):
        for command in self.listed:
            with self.subTest(command):
                self.assertEqual(self.offered(command, "-"), self.common | options_of(command))
        self.assertEqual(self.offered("run", "x", "--", "-"), set())

    def test_meanings_are_those_of_the_help_texts(self):
        told = completed.offered(PROGRAM, "run", "-")
        for option, meaning in told.items():
            self.assertIn(meaning, call(PROGRAM, "run", "--help") + call(PROGRAM, "--help"), option)
        for command, meaning in completed.offered(PROGRAM, "").items():
            self.assertIn(meaning, call(PROGRAM, command, "--help"))

    def test_every_model(self):
        kinds = {kind["name"] for kind in self.models["kinds"]}
        sections = {section["name"] for section in self.models["sections"]}
        self.assertEqual(self.offered("describe", ""), kinds | sections | {"levels", "rock"})
        for kind in self.models["kinds"]:
            names = {model["name"] for model in kind["models"]}
            self.assertEqual(self.offered("describe", kind["name"], ""), names)
        self.assertEqual(self.offered("describe", "friction", "aging", ""), set())
        rocks = {r["name"] for r in json.loads(call(PROGRAM, "describe", "rock", "--json"))["rocks"]}
        self.assertGreaterEqual(len(rocks), 12)
        self.assertEqual(self.offered("describe", "rock", ""), rocks)
        self.assertEqual(self.offered("describe", "rock", "limestone", ""), set())

    def test_values(self):
        """Of files a line says what stands before them in the word, and their endings."""
        def files(*words):
            return completed.offered(PROGRAM, *words)
        self.assertEqual(files("run", ""), {":": "yaml"})
        self.assertEqual(files("rg", "c"), {":": "yaml|nc"})
        self.assertEqual(files("report", "c"), {":": ""})
        self.assertEqual(files("export", "c"), {":": "nc"})
        self.assertEqual(files("fit", "c"), {":": "yaml"})
        self.assertEqual(files("fit", "x.yaml", "c"), {":": ""})
        self.assertEqual(files("precursors", ""), {":": ""})
        self.assertEqual(files("precursors", "x", "--case", ""), {":": "yaml"})
        self.assertEqual(files("run", "x.yaml", "-o", "READ"), {":": ""})
        self.assertEqual(files("run", "x.yaml", "-qoREAD"), {})
        self.assertEqual(files("run", "x.yaml", "-oREAD"), {":-o": ""})
        self.assertEqual(files("run", "x.yaml", "--output=READ"), {":--output=": ""})
        for words in (["run", "--until", ""], ["run", "--until=1"], ["run", "--force=1"], ["run", "x", ""],
                      ["run", "--nothing=1"], ["new", ""], ["run", "--threads", ""], ["run", "-x1"]):
            self.assertEqual(files(*words), {}, words)
        self.assertEqual(files("run", "--view", ""), {":": "yaml"})  # it needs no value
        self.assertEqual(self.offered("new", "--kind", ""), {"block", "fit", "injection", "joint", "laboratory", "reservoir", "slope"})
        self.assertEqual(self.offered("new", "--kind=s"), {"--kind=slope"})
        self.assertEqual(self.offered("completion", ""), {"bash", "zsh", "fish"})

    def test_words_as_bash_cuts_them(self):
        """At = and :, with quotes; an empty word stands behind a blank."""
        for words in (["--kind", "=", "sl"], ["'--kind=sl"], ["'--kind", "=", "sl"], ["--ki\\nd=sl"]):
            self.assertEqual(self.offered("new", "x", *words), {"--kind=slope"})
        self.assertEqual(self.offered("precursors", "--sigma", "mm", ":", "mm", "--ra"), {"--raw"})
        self.assertEqual(self.offered("'describe'", '"friction"', "'a"), {"aging"})

    def test_nothing_but_candidates(self):
        """Whatever stands on the line: exit status 0, no error, and no word of it comes back."""
        strange = ["", "=", ":", "==", "=:=", "-", "--", "---", "--=", "-=", "--set", "--set=", "--set==", "-o",
                   "-o=", "'", '"', "\\", "'\"", "$(touch x)", "`touch x`", "a\nb", "\n", "\t", "\x1b[2J", "\x7f",
                   "%s%n", "run", "help", "describe", "friction", ".", "..", "0", "solver.", "solver..",
                   "load.shear.", "load.shear.=", "load.shear.99999999999999999999999.", "é\u202e",
                   "load.shear." + "9" * 5000, "load.shear." + "9" * 5000 + ".", "x" * 100000, "--" + "x" * 100000,
                   "--set=" + "x" * 100000, "0.ratio", ".0.", "output.every.", "*", "?", "~", "&"]
        known = [*self.listed, *sorted(self.common), "--set", "friction"]
        chance = random.Random(1)
        pools = [strange, known, [f"{word}=" for word in strange]]
        lines = [[word] for word in strange] + [["run", "x", "--set", word] for word in strange]
        lines += [[chance.choice(chance.choice(pools)) for _ in range(chance.randint(1, 7))] for _ in range(150)]
        for words in lines:
            done = subprocess.run([PROGRAM, "__complete", *words], capture_output=True, check=False, timeout=60)
            self.assertEqual((done.returncode, done.stderr), (0, b""), words)
            for line in done.stdout.decode("ascii").splitlines():
                self.assertRegex(line, r"^(:?[-a-z][\w.=-]*\t[ -~]*|:\t[a-z|]*)$", words)

    def test_it_is_told_even_where_output_fails(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([PROGRAM, "__complete", ""], stdout=full, stderr=subprocess.PIPE, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, b""))

    def test_every_key_is_one(self):
        """The program knows each key: what it says of a wrong value is never that there is no such."""
        keys = completed.keys(PROGRAM)
        self.assertGreater(len(keys), 300)
        self.assertEqual(len(keys), len(set(keys)))
        seen = {}
        for key in keys:  # one model at a place
            place = re.sub(r"^(friction\.spread|initial\.spread|interface\.spread)\.\w+\..*", r"\1", key)
            seen.setdefault(place.rsplit(".", 1)[0] if place == key else key.rsplit(".", 1)[0],
                            []).append(key)
        laws = {model["name"]: model for kind in self.models["kinds"] if kind["name"] == "friction"
                for model in kind["models"]}
        for group in seen.values():
            if group[0].startswith("friction.spread."):
                parameter = group[0].split(".")[2]
                law, = [name for name, model in laws.items()
                        if parameter in [p["key"] for p in model["parameters"]]][-1:]
                before = f"friction: {{{law}: {{}}}}\n"
            else:
                before = ""
            with tempfile.NamedTemporaryFile("w", suffix=".yaml") as case:
                case.write("lacuna: 1\n" + before)
                case.flush()
                words = [word for key in group for word in ("--set", f"{key}={{}}")]
                done = subprocess.run([PROGRAM, "check", case.name, *words], check=False, text=True,
                                      capture_output=True, timeout=60)
            self.assertEqual(done.returncode, 2)
            self.assertNotRegex(done.stderr, "is no |unknown", group)

    def test_keys_of_the_bundled_cases_are_described(self):
        import yaml  # of python3-yaml
        keys = set(completed.keys(PROGRAM))
        for path in glob.glob(os.path.join(SOURCE, "cases", "**", "*.yaml"), recursive=True):
            with open(path, encoding="utf-8") as file:
                case = flattened(yaml.safe_load(file))
            for key in case:
                key = re.sub(r"(spread\.\w+)\.0\.", r"\1.", key)  # a list of models, or one
                self.assertTrue(key in keys or any(k.startswith(key + ".") or key.startswith(k + ".")
                                                   for k in keys), f"{path}: {key}")

    def bash(self, line):
        """What bash is told of the last word of a line without quotes."""
        words = re.findall(r"[=:]+|(?:[^\s=:\\]|\\.)+", line) + [""] * (line[-1] in " =:")
        quoted = " ".join(map(shlex.quote, words[:-1] if line[-1] in "=:" else words))
        text = (f"{self.script['bash']}\nCOMP_WORDS=({quoted}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n"
                f"COMP_LINE={shlex.quote(line)}; COMP_POINT=${{#COMP_LINE}}; compopt() {{ :; }}\n"
                f"_lacuna {words[0]} {shlex.quote(words[-1])}; printf '%s\\n' \"${{COMPREPLY[@]}}\"")
        return set(call("bash", "-c", text, cwd=SOURCE, env=WITH_PROGRAM).split("\n")) - {""}

    def test_bash_is_told(self):
        self.assertEqual(self.bash("lacuna "), set(self.listed))
        self.assertEqual(self.bash("lacuna run -"), self.common | options_of("run"))
        self.assertEqual(self.bash("lacuna run case"), {"cases"})
        self.assertEqual(self.bash("lacuna run cases/block"), {"cases/block.yaml"})
        self.assertEqual(self.bash(f"{PROGRAM} run x.yaml -o READ"), {"README.md"})
        self.assertEqual(self.bash("lacuna run x.yaml --output=READ"), {"README.md"})
        self.assertEqual(self.bash("lacuna run x.yaml -oREAD"), {"-oREADME.md"})
        self.assertEqual(self.bash("lacuna report x.nc --compare cases/data/cr"), {"cases/data/creep.csv"})
        self.assertEqual(self.bash("lacuna run cases/data/"), set())  # no case is there
        self.assertEqual(self.bash("lacuna run --until "), set())
        self.assertEqual(self.bash("lacuna new --kind=s"), {"slope"})
        self.assertEqual(self.bash("nothing run "), set())  # which is no program

    def at_a_terminal(self, shell, *without):
        for line, words in self.lines.items():
            if not set(without) & set(line):
                with self.subTest(line):
                    self.assertEqual(typed(shell, self.script[shell], line), words)
        for line, words in self.with_blanks.items():
            if not set(without) & set(line):
                with self.subTest(line):
                    self.assertEqual(typed(shell, self.script[shell], line, "two words.yaml", "other.txt"), words)

    def test_bash_at_a_terminal(self):
        self.at_a_terminal("bash")
        self.assertEqual(typed("bash", self.script["bash"], "lacuna check o\t", "other.txt"), ["check", "o"])

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_at_a_terminal(self):
        self.at_a_terminal("zsh")

    lines = {
        "lacuna desc\tfric\tag\t": ["describe", "friction", "aging"],
        "lacuna check cases/bl\t": ["check", "cases/block.yaml"],
        "lacuna rg cases/peers/plane-patch.n\t": ["rg", "cases/peers/plane-patch.nc"],
        "lacuna new --kind sl\t--force": ["new", "--kind", "slope", "--force"],
        "lacuna new --kind=sl\t--force": ["new", "--kind=slope", "--force"],
        "lacuna new '--kind=sl\t": ["new", "--kind=slope"],
        "lacuna run x --output=READ\t--json": ["run", "x", "--output=README.md", "--json"],
        "lacuna run x --outp\tREAD\t": ["run", "x", "--output", "README.md"],
    }
    with_blanks = {
        "lacuna check tw\t--json": ["check", "two words.yaml", "--json"],
        "lacuna check 'two w\t": ["check", "two words.yaml"],
        "lacuna check two\\ w\t": ["check", "two words.yaml"],
        "lacuna check o -o o\t": ["check", "o", "-o", "other.txt"],
    }

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish(self):
        def offered(line):
            lines = call("fish", "--no-config", "-c", self.script["fish"] + f"\ncomplete -C {shlex.quote(line)}",
                         env=WITH_PROGRAM, cwd=SOURCE).splitlines()
            return {text.split("\t")[0] for text in lines}
        self.assertEqual(offered("lacuna "), set(self.listed))
        for command in self.listed:
            self.assertEqual({o for o in offered(f"lacuna {command} --")},
                             {o for o in self.common | options_of(command) if o[:2] == "--"})
        self.assertEqual(offered("lacuna describe friction ag"), {"aging"})
        self.assertEqual(offered("lacuna new --kind s"), {"slope"})
        self.assertEqual(offered(f"{PROGRAM} run cases/blo"), {"cases/block.yaml"})
        self.assertEqual(offered("lacuna run x -o READ"), {"README.md"})
        self.assertEqual(offered("lacuna run x --output=READ"), {"--output=README.md"})
        self.assertEqual(offered("lacuna run x --until READ"), set())

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_reads_it(self):
        call("zsh", "-f", "-c", "autoload -U compinit; compinit -D; eval \"$0\"; whence _lacuna",
             self.script["zsh"])

    def test_json_holds_the_script(self):
        for shell, script in self.script.items():
            done = json.loads(call(PROGRAM, "completion", shell, "--json"))
            self.assertEqual(done, {"shell": shell, "script": script})

    def test_unknown_shell(self):
        done = subprocess.run([PROGRAM, "completion", "bsh"], capture_output=True, text=True,
                              check=False)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn('"bsh" is no shell; did you mean "bash"?', done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
