# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands that the documentation shows: of Markdown pages, manual pages and help texts.

Blocks marked ```sh are not among them: run_page.py runs them, page by page. What is left are indented
lines and examples of manual pages (kind `block`), examples of help texts (`help`), and what running
text quotes (`text`).
"""

import glob
import os
import re
import shlex
import subprocess
import sys
from collections import namedtuple

import completed

Command = namedtuple("Command", "page line kind text")

# What begins a command. A line that looks like one and begins otherwise is told by `strangers`.
FIRST = (r"lacuna|ncdump|/usr/bin/python3|source|tools/(?:\w+/)?[\w-]+(?:\.py)?|tests/support/\w+\.py|build/[^\s`]+|"
         r"cmake|ctest|cpack|sudo|git|export|man|apt|for \w+ in")
BLOCK = re.compile(rf"^(?: {{4}}|\t)((?:{FIRST})(?: .*)?)$")
QUOTED = re.compile(rf"`((?:{FIRST}) [^`\n]+)`")
STRANGER = re.compile(r"^(?: {4}|\t)(\S+ .*\.(?:nc|yaml|csv)\b.*)$")


def with_this_python(text):
    """A command of the documentation, run by the Python of the tests; the pages name Debian's own."""
    return text.replace("/usr/bin/python3", shlex.quote(sys.executable))


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def without_fences(text):
    """The text with blocks between ``` emptied, lines kept."""
    return re.sub(r"^```.*?^```$", lambda match: "\n" * match.group().count("\n"), text,
                  flags=re.DOTALL | re.MULTILINE)


def joined(text):
    """(line number, line), those that end in a backslash joined with the next."""
    number, found, held = 0, [], ""
    for line in text.split("\n"):
        number += 1
        held += line if not held else line.strip()
        if held.endswith("\\"):
            held = held[:-1]
            continue
        found.append((number, held))
        held = ""
    return found


def uncommented(text):
    return re.sub(r"\s+#(?: .*)?$", "", text).strip()


def of_markdown(page, text):
    for number, line in joined(without_fences(text)):
        block = BLOCK.match(line)
        if block:
            yield Command(page, number, "block", uncommented(block.group(1)))
            continue
        for quoted in QUOTED.findall(line):
            yield Command(page, number, "text", quoted)


def strangers(page, text):
    """Indented lines that name a file as commands do and are neither one nor Python."""
    for number, line in joined(without_fences(text)):
        match = STRANGER.match(line)
        if match and not BLOCK.match(line) and not re.search(r"[(\[=|]", match.group(1)):
            yield Command(page, number, "block", match.group(1))


def of_manual(page, text):
    """The blocks below EXAMPLES and whatever else a page has in blocks; a loop is one command."""
    for match in re.finditer(r"^```\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
        first = text[:match.start()].count("\n") + 2
        block = match.group(1).replace("\\\\", "\\")
        if block.startswith("for "):
            yield Command(page, first, "block", block.strip())
            continue
        for number, line in joined(block):
            if line.strip():
                yield Command(page, first + number - 1, "block", uncommented(line))


def of_help(program):
    for name in [""] + completed.commands(program):
        words = [program, name, "--help"] if name else [program, "--help"]
        text = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        example, = re.findall(r"^example: (.*)$", text, re.MULTILINE)
        yield Command("--help", 0, "help", example)


def pages(source):
    """Markdown and manual pages, relative to the folder."""
    found = ["README.md", "CONTRIBUTING.md", "ARCHITECTURE.md", "cases/data/README.md"]
    for pattern in ("docs/**/*.md", "docs/man/*.scd"):
        found += sorted(glob.glob(pattern, root_dir=source, recursive=True))
    return found


def gather(source, program):
    """All commands, page by page in their order; lines that should be one and are not."""
    found, odd = [], []
    for page in pages(source):
        text = read(os.path.join(source, page))
        if page.endswith(".scd"):
            found += of_manual(page, text)
        else:
            found += of_markdown(page, text)
            odd += strangers(page, text)
    return found + list(of_help(program)), odd
