#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the commands of a page of the documentation and compares what they print.

    run_page.py PROGRAM SOURCE_FOLDER PAGE.md

Every block marked ```sh is run by a shell, in a folder of its own that holds links to cases/, docs/
and tools/, with the program as `lacuna`. A block marked ```text that follows is what it prints on
stdout: numbers may differ by 1 %, a line `...` stands for any lines, times and paths are not looked
at where the page has `...` within a line. Blocks marked otherwise are not run.
"""

import os
import re
import subprocess
import sys
import tempfile

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


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
    return subprocess.run(["sh", "-eu", "-c", text], cwd=folder, env=environment, text=True,
                          capture_output=True, timeout=250, check=False, stdin=subprocess.DEVNULL)


def check_page(page, program, folder):
    with open(page, encoding="utf-8") as file:
        blocks = BLOCK.findall(file.read())
    printed, ran = None, 0
    for kind, text in blocks:
        if kind == "sh":
            done = run_block(text, folder, program)
            if done.returncode != 0:
                return f"fails with {done.returncode}:\n{text}{done.stderr}"
            printed, ran = done.stdout.splitlines(), ran + 1
        elif kind == "text" and printed is not None:
            wrong = compare(text.splitlines(), printed)
            if wrong:
                return "prints\n    {1}\nwhere the page has\n    {0}".format(*wrong)
            printed = None
    return None if ran else "has no block marked sh"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    program, source, page = map(os.path.abspath, sys.argv[1:])
    with tempfile.TemporaryDirectory(prefix="lacuna-page-") as folder:
        for name in ("cases", "docs", "tools"):
            os.symlink(os.path.join(source, name), os.path.join(folder, name))
        wrong = check_page(page, program, folder)
    if wrong:
        sys.exit(f"{os.path.basename(page)}: {wrong}")


if __name__ == "__main__":
    main()
