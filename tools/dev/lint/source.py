# SPDX-License-Identifier: GPL-3.0-or-later
"""What the checks share: finding files and reading C as far as they need."""

import os
import re
import sys

SKIPPED = {".git", "build", "__pycache__"}


def files(root, folders, endings):
    """Paths relative to root of the files below the folders, in a fixed order."""
    found = []
    for folder in folders:
        for here, names, leaves in os.walk(os.path.join(root, folder)):
            names[:] = sorted(n for n in names if n not in SKIPPED and not n.startswith("build-"))
            found += [
                os.path.relpath(os.path.join(here, leaf), root)
                for leaf in sorted(leaves)
                if leaf.endswith(endings)
            ]
    return found


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return file.read()


TOKEN = re.compile(
    r"//(?:[^\n]|\\\n)*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])*'", re.DOTALL
)
DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", re.MULTILINE)


def blank(match):
    return re.sub(r"[^\n]", " ", match.group())


def without_comments(text):
    """The text with comments blanked; every character keeps its place."""
    return TOKEN.sub(lambda m: blank(m) if m.group()[0] == "/" else m.group(), text)


def code(text):
    """The text with comments, literals and preprocessor lines blanked, everything in place."""
    return DIRECTIVE.sub(blank, TOKEN.sub(blank, text))


def line_of(text, position):
    return text.count("\n", 0, position) + 1


def report(complaints, what):
    """Prints the complaints and gives the exit status."""
    for complaint in complaints:
        print(complaint)
    if complaints:
        print(f"{what}: {len(complaints)} to mend", file=sys.stderr)
    return 1 if complaints else 0
