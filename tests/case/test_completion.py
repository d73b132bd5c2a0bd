#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shells complete every command, every option of each, every model and every key of a case; bash
(and fish, zsh, where they are installed) do so in fact, at a terminal, by the Tab key.

usage: test_completion.py PROGRAM SOURCE_FOLDER
"""

import glob
import json
import os
import pty
import re
import select
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


def typed(shell, script, line):
    """The words of a command line that was typed at a terminal, with Tab where it has one."""
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "script")
        with open(file, "w", encoding="utf-8") as out:
            out.write(script)
        begin = {"bash": ["bash", "--norc", "--noprofile", "-i"], "zsh": ["zsh", "-f", "-i"]}[shell]
        ready = {"bash": f"source {file}", "zsh": f"autoload -U compinit; compinit -D; source {file}"}
        child, end = pty.fork()
        if child == 0:
            os.chdir(SOURCE)
            os.environ.update(PS1="$ ", TERM="dumb", HOME=folder)
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
    assert found, text.decode()
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

    def bash(self, *words):
        """What bash offers for the last word."""
        quoted = " ".join(f"'{word}'" for word in words)
        text = (f"{self.script['bash']}\nCOMP_WORDS=(lacuna {quoted}); COMP_CWORD={len(words)}\n"
                "COMP_LINE=\"${COMP_WORDS[*]}\"; COMP_POINT=${#COMP_LINE}\n"
                "_lacuna; printf '%s\\n' \"${COMPREPLY[@]}\"")
        return set(call("bash", "-c", text, cwd=SOURCE).split("\n")) - {""}

    def test_bash_knows_every_command(self):
        self.assertGreater(len(self.listed), 7)
        self.assertEqual(self.bash(""), set(self.listed))
        self.assertEqual(self.bash("-"), self.common)
        self.assertEqual(self.bash("--json", "che"), {"check"})

    def test_bash_knows_the_options_of_each(self):
        for command in self.listed:
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
        self.assertEqual(self.bash("report", "x.nc", "--compare", "cases/data/cr"),
                         {"cases/data/creep.csv"})
        self.assertEqual(self.bash("run", "cases/data/"), set())  # no case is there
        self.assertEqual(self.bash("completion", ""), {"bash", "zsh", "fish"})

    def test_bash_keeps_names_with_spaces_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "two words.yaml"), "w", encoding="utf-8"):
                pass
            self.assertEqual(self.bash("check", folder + "/two"), {folder + "/two words.yaml"})

    def keys(self):
        """All keys, as each shell's script lists them."""
        found = {"bash": re.search(r"^_lacuna_keys='(.*)'$", self.script["bash"], re.MULTILINE),
                 "zsh": re.search(r"^    keys=\( *(.*)\)$", self.script["zsh"], re.MULTILINE),
                 "fish": re.search(r"string replace .0. .* -- (.*) \|", self.script["fish"])}
        keys = {shell: match.group(1).split() for shell, match in found.items()}
        self.assertEqual(keys["bash"], keys["zsh"])
        self.assertEqual(keys["bash"], keys["fish"])
        self.assertEqual(len(keys["bash"]), len(set(keys["bash"])))
        return keys["bash"]

    def test_every_key_is_one(self):
        """The program knows each key: what it says of a wrong value is never that there is no such."""
        keys = self.keys()
        self.assertGreater(len(keys), 300)
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

    def test_keys_of_the_bundled_cases_are_offered(self):
        import yaml  # of python3-yaml
        keys = set(self.keys())
        for path in glob.glob(os.path.join(SOURCE, "cases", "**", "*.yaml"), recursive=True):
            with open(path, encoding="utf-8") as file:
                case = flattened(yaml.safe_load(file))
            for key in case:
                key = re.sub(r"(spread\.\w+)\.0\.", r"\1.", key)  # a list of models, or one
                self.assertTrue(key in keys or any(k.startswith(key + ".") or key.startswith(k + ".")
                                                   for k in keys), f"{path}: {key}")

    def test_bash_keys_part_by_part(self):
        self.assertEqual(self.bash("run", "--set", "solver.me"), {"solver.method="})
        self.assertEqual(self.bash("run", "--set", "interface.d"), {"interface.domain."})
        self.assertEqual(self.bash("run", "--set", "load.shear.3.ra"),
                         {"load.shear.3.ratio.", "load.shear.3.ramp."})
        self.assertEqual(self.bash("run", "--set=output.ever"), {"output.every=", "output.every."})

    def test_bash_at_a_terminal(self):
        for line, words in self.lines.items():
            with self.subTest(line):
                self.assertEqual(typed("bash", self.script["bash"], line), words)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_at_a_terminal(self):
        for line, words in self.lines.items():
            if "'" not in line:
                with self.subTest(line):
                    self.assertEqual(typed("zsh", self.script["zsh"], line), words)

    lines = {
        "lacuna desc\tfric\tag\t": ["describe", "friction", "aging"],
        "lacuna check cases/bl\t": ["check", "cases/block.yaml"],
        "lacuna rg cases/peers/plane-patch.n\t": ["rg", "cases/peers/plane-patch.nc"],
        "lacuna run x --set solver.met\tad\t": ["run", "x", "--set", "solver.method=adams"],
        "lacuna run x --set=solver.met\tad\t": ["run", "x", "--set=solver.method=adams"],
        "lacuna run x --set load.sh\t2.rat\tv\t3": ["run", "x", "--set", "load.shear.2.ratio.value=3"],
        "lacuna run x --set 'solver.method=b\t": ["run", "x", "--set", "solver.method=bdf"],
        "lacuna run x --set interface.sur\tfile.pa\tREAD\t":
            ["run", "x", "--set", "interface.surface.file.path=README.md"],
        "lacuna fit x --set fit.errors=ar\t--json": ["fit", "x", "--set", "fit.errors=ar1", "--json"],
    }

    def test_zsh_and_fish_list_the_same(self):
        for shell, form in (("zsh", "'*?{}[+=\\[]"), ("fish", "-l {} ")):
            for command in self.listed:
                for name in self.common | options_of(command):
                    word = name if shell == "zsh" else name.lstrip("-")
                    if name.startswith("--"):
                        self.assertRegex(self.script[shell], form.format(re.escape(word)))
            for word in self.listed:
                self.assertRegex(self.script[shell], rf"\b{word}\b")
            for kind in self.models["kinds"]:
                for model in kind["models"]:
                    self.assertIn(model["name"], self.script[shell])

    def test_zsh_completes_values(self):
        """Keys after --set alone, files after -o, nothing after a number."""
        found = {}
        for name, action in re.findall(r"'\*?(--?[a-z-]+)[=+]\[[^]]*\]:[^:]*:(.*)'", self.script["zsh"]):
            found.setdefault(action, set()).add(name)
        self.assertEqual(found["_lacuna_set"], {"--set"})
        self.assertLessEqual({"-o", "--output"}, found["_files"])
        self.assertIn("--threads", found[""])

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish(self):
        def offered(line):
            lines = call("fish", "--no-config", "-c", self.script["fish"] +
                         f"\ncomplete -C '{line}'").splitlines()
            return {text.split("\t")[0] for text in lines}
        self.assertEqual(offered("lacuna "), set(self.listed))
        for command in self.listed:
            self.assertEqual({o for o in offered(f"lacuna {command} --")},
                             {o for o in self.common | options_of(command) if o[:2] == "--"})
        self.assertEqual(offered("lacuna describe friction ag"), {"aging"})
        self.assertEqual(offered("lacuna run x --set solver.met"), {"solver.method="})
        self.assertEqual(offered("lacuna run x --set solver.method=a"), {"solver.method=adams"})
        self.assertEqual(offered("lacuna run x --set load.shear.2.ratio.v"), {"load.shear.2.ratio.value="})

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
