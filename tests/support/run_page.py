#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the commands of a page of the documentation and compares what they print.

    run_page.py PROGRAM SOURCE_FOLDER PAGE.md [--update]

Every block marked ```sh is run by a shell, in a folder of its own that holds links to cases/, docs/
and tools/ and to the program's folder as build/, with the program as `lacuna`. A block marked ```text
that follows is what it prints on stdout: numbers may differ by 1 %, a line `...` stands for any
lines, times and paths are not looked at where the page has `...` within a line. --update writes what
is printed into the page instead, but where a line of a block ends in `...`. Blocks marked ```python are one program,
run at the end of the page. Blocks marked otherwise are not run.

Of a page without such blocks, as README.md is, the lines indented by four that begin with one of
COMMANDS are run, in their order; one that holds a name in capitals (CASE.yaml) is a pattern, and `#`
begins a comment.
"""

import os
import re
import subprocess
import sys
import tempfile

import doc_commands

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
BLOCK = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMANDS = ("lacuna ", "ncdump ", "/usr/bin/python3 ")
INDENTED = re.compile(r"^    (?=" + "|".join(COMMANDS) + r")(.*)$", re.MULTILINE)
PATTERN = re.compile(r"\b[A-Z]{3,}\b")


def same_line(wanted, got):
    if wanted.rstrip().endswith("..."):
        stem = wanted.rstrip()[:-3].rstrip()
        return same_line(stem, got[: len(stem)])
    if NUMBER.sub("#", wanted).split() != NUMBER.sub("#", got).split():
        return False
    pairs = zip(NUMBER.findall(wanted), NUMBER.findall(got))
    return all(abs(float(a) - float(b)) <= 0.01 * max(abs(float(a)), abs(float(b))) for a, b in pairs)


def compare(wanted, got):
    """The first wanted line that is not there; None where all are."""
    at, free = 0, False
    for line in wanted:
        if line.strip() == "...":
            free = True
            continue
        while free and at < len(got) and not same_line(line, got[at]):
            at += 1
        if at >= len(got) or not same_line(line, got[at]):
            return line, got[at] if at < len(got) else "the end"
        at, free = at + 1, False
    return None if free or at == len(got) else ("the end", got[at])


def run_block(text, folder, program):
    environment = dict(os.environ, PATH=os.path.dirname(program) + os.pathsep + os.environ["PATH"])
    return subprocess.run(["sh", "-eu", "-c", doc_commands.with_this_python(text)], cwd=folder, env=environment, text=True,
                          capture_output=True, timeout=250, check=False, stdin=subprocess.DEVNULL)


def indented(text):
    """The commands of a page without blocks, each as a block."""
    lines = [re.sub(r"\s+# .*", "", line) for line in INDENTED.findall(text)]
    return [("sh", line + "\n") for line in lines if not PATTERN.search(line)]


def check_page(text, program, folder):
    """What is wrong with a page; None where nothing is."""
    blocks = BLOCK.findall(text)
    if not any(kind == "sh" for kind, _ in blocks):
        blocks = indented(text)
    printed, ran = None, 0
    python = "".join(block for kind, block in blocks if kind == "python")
    for kind, block in blocks:
        if kind == "sh":
            done = run_block(block, folder, program)
            if done.returncode != 0:
                return f"fails with {done.returncode}:\n{block}{done.stderr}"
            printed, ran = done.stdout.splitlines(), ran + 1
        elif kind == "text" and printed is not None:
            wrong = compare(block.splitlines(), printed)
            if wrong:
                return "prints\n    {1}\nwhere the page has\n    {0}".format(*wrong)
            printed = None
    if python:
        done = subprocess.run([sys.executable, "-c", python], cwd=folder, text=True,
                              capture_output=True, timeout=250, check=False)
        if done.returncode != 0:
            return f"its Python fails:\n{done.stderr}"
    return None if ran else "has no command to run"


def updated(text, program, folder):
    """The page with what its blocks print now."""
    printed = [""]

    def renew(match):
        kind, block = match.groups()
        if kind == "sh":
            printed[0] = run_block(block, folder, program).stdout
        elif kind == "text" and not re.search(r"\.\.\.[ \t]*$", block, re.MULTILINE) and printed[0]:
            return f"```text\n{printed[0].rstrip()}\n```"
        return match.group()
    return BLOCK.sub(renew, text)


def main():
    words = [word for word in sys.argv[1:] if word != "--update"]
    if len(words) != 3:
        sys.exit(__doc__)
    program, source, page = map(os.path.abspath, words)
    with open(page, encoding="utf-8") as file:
        text = file.read()
    with tempfile.TemporaryDirectory(prefix="lacuna-page-") as folder:
        for name in ("cases", "docs", "tools"):
            os.symlink(os.path.join(source, name), os.path.join(folder, name))
        os.symlink(os.path.dirname(program), os.path.join(folder, "build"))
        if len(words) < len(sys.argv) - 1:
            text = updated(text, program, folder)  # a page stays whole where this is interrupted
            with open(page, "w", encoding="utf-8") as file:
                file.write(text)
            return
        wrong = check_page(text, program, folder)
    if wrong:
        sys.exit(f"{os.path.basename(page)}: {wrong}")


if __name__ == "__main__":
    main()
