#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shells complete every command, every option of each and every model; bash (and fish, zsh, where
they are installed) do so in fact.

usage: test_completion.py PROGRAM SOURCE_FOLDER
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])


def call(*words, **options):
    return subprocess.run(words, capture_output=True, text=True, check=True, timeout=60,
                          stdin=subprocess.DEVNULL, **options).stdout


def options_of(*command):
    """The long options and letters that a help text lists."""
    text = call(PROGRAM, *command, "--help")
    return set(re.findall(r"^ +(?:-\w, )?(--[\w-]+)", text, re.MULTILINE)) | set(
        re.findall(r"^ +(-\w), --", text, re.MULTILINE))


class Completion(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.common = options_of()
        cls.listed = re.findall(r"^  ([a-z]+) ", call(PROGRAM, "--help"), re.MULTILINE)
        cls.models = json.loads(call(PROGRAM, "describe", "--json"))
        cls.script = {}
        for shell in ("bash", "zsh", "fish"):
            cls.script[shell] = call(PROGRAM, "completion", shell)

    def bash(self, *words):
        """What bash offers for the last word."""
        quoted = " ".join(f"'{word}'" for word in words)
        text = (f"{self.script['bash']}\nCOMP_WORDS=(lacuna {quoted}); COMP_CWORD={len(words)}\n"
                "_lacuna; printf '%s\\n' \"${COMPREPLY[@]}\"")
        return set(call("bash", "-c", text, cwd=SOURCE).split("\n")) - {""}

    def test_bash_knows_every_command(self):
        self.assertGreater(len(self.listed), 7)
        self.assertEqual(self.bash(""), set(self.listed) | {"completion"})
        self.assertEqual(self.bash("-"), self.common)
        self.assertEqual(self.bash("--json", "che"), {"check"})

    def test_bash_knows_the_options_of_each(self):
        for command in self.listed + ["completion"]:
            with self.subTest(command):
                offered = self.bash(command, "-")
                self.assertEqual(offered, self.common | options_of(command))

    def test_bash_knows_every_model(self):
        kinds = {kind["name"] for kind in self.models["kinds"]}
        sections = {section["name"] for section in self.models["sections"]}
        self.assertEqual(self.bash("describe", ""), kinds | sections)
        for kind in self.models["kinds"]:
            names = {model["name"] for model in kind["models"]}
            self.assertEqual(self.bash("describe", kind["name"], ""), names)

    def test_bash_values(self):
        self.assertEqual(self.bash("run", "case"), {"cases"})
        self.assertEqual(self.bash("run", "cases/block"), {"cases/block.yaml"})
        self.assertEqual(self.bash("run", "x.yaml", "-o", "READ"), {"README.md"})
        self.assertEqual(self.bash("new", "--kind", ""), {"block", "joint", "slope"})
        self.assertEqual(self.bash("run", "--until", ""), set())
        self.assertEqual(self.bash("completion", ""), {"bash", "zsh", "fish"})

    def test_bash_keeps_names_with_spaces_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "two words.yaml"), "w", encoding="utf-8"):
                pass
            self.assertEqual(self.bash("check", folder + "/two"), {folder + "/two words.yaml"})

    def test_zsh_and_fish_list_the_same(self):
        for shell, form in (("zsh", "'*?{}[+=\\[]"), ("fish", "-l {} ")):
            for command in self.listed:
                for name in self.common | options_of(command):
                    word = name if shell == "zsh" else name.lstrip("-")
                    if name.startswith("--"):
                        self.assertRegex(self.script[shell], form.format(re.escape(word)))
            for word in self.listed + ["completion"]:
                self.assertRegex(self.script[shell], rf"\b{word}\b")
            for kind in self.models["kinds"]:
                for model in kind["models"]:
                    self.assertIn(model["name"], self.script[shell])

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish(self):
        def offered(line):
            lines = call("fish", "--no-config", "-c", self.script["fish"] +
                         f"\ncomplete -C '{line}'").splitlines()
            return {text.split("\t")[0] for text in lines}
        self.assertEqual(offered("lacuna "), set(self.listed) | {"completion"})
        for command in self.listed:
            self.assertEqual({o for o in offered(f"lacuna {command} --")},
                             {o for o in self.common | options_of(command) if o[:2] == "--"})
        self.assertEqual(offered("lacuna describe friction ag"), {"aging"})

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_reads_it(self):
        call("zsh", "-f", "-c", "autoload -U compinit; compinit -D; eval \"$0\"; whence _lacuna",
             self.script["zsh"])

    def test_unknown_shell(self):
        done = subprocess.run([PROGRAM, "completion", "bsh"], capture_output=True, text=True,
                              check=False)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn('"bsh" is no shell; did you mean "bash"?', done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
