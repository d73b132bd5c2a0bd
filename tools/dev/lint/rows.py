# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows know what they can do: no model's name is compared outside its row.

    rows.py [ROOT]

A model is a row of a table (a law, a load, a transfer, an indicator, a method ...). What differs from model to model is
a member of the row, so that a row added tomorrow is asked too. Refused in src: comparing what `info` names, and
comparing anything with a row's name, but in the file of the row.
"""

import re
import sys

import source

ROW = re.compile(r'(?:\{\s*\.name\s*=\s*(?="[^"]+",\s*\.(?:summary|key|doc)\b)|\b(?:LAC_ABOUT|DIAL|RANDOM_KIND)\((?:\w+,)?\s*)"([^"]+)"')
COMPARE = re.compile(r"\b(?:str(?:n?case)?n?cmp|find_\w+|is_\w+|named)\s*\(")
INFO = re.compile(r"\binfo\s*(?:->|\.)\s*name\b")
LITERAL = re.compile(r'"([^"]*)"')

# Tables of other things than models: commands, their options, sections of a case, columns of a file.
OTHER_TABLES = ("src/cli/", "src/case/registry.c", "src/store/", "src/case/sections.c")

# Words that are a model's name too and mean something else there.
OTHER_WORDS = {
    ("src/case/value.c", "transfer"),  # a section
    ("src/case/read_sections.c", "case"),  # the whole
    ("src/case/check.c", "rg"),  # a section
    ("src/cli/common/new.c", "joint"),  # a kind of case file
    ("src/cli/precursors/precursors_read.c", "none"),  # no onset
}


def names(texts):
    """The names of all rows, each with the files that hold one of it."""
    found = {}
    for path, text in texts.items():
        if not path.startswith(OTHER_TABLES):
            for name in ROW.findall(source.without_comments(text)):
                found.setdefault(name, set()).add(path)
    return found


def arguments(text, start):
    """The text between the parenthesis that opens before `start` and the one that closes it."""
    depth, end = 1, start
    while end < len(text) and depth > 0:
        depth += {"(": 1, ")": -1}.get(text[end], 0)
        end += 1
    return text[start : end - 1]


def check(path, text, rows):
    """Complaints about one file."""
    complaints = []
    visible = source.without_comments(text)
    for match in COMPARE.finditer(visible):
        inside = arguments(visible, match.end())
        words = [w for w in LITERAL.findall(inside)
                 if w in rows and path not in rows[w] and (path, w) not in OTHER_WORDS]
        if words or (match.group().startswith("str") and INFO.search(inside)):
            what = f'"{words[0]}"' if words else "what info names"
            complaints.append(f"{path}:{source.line_of(visible, match.start())}: compares {what}, a model's name: "
                              "let the row say what it can do")
    return complaints


def main(root):
    texts = {path: source.read(root, path) for path in source.files(root, ["include", "src"], (".c", ".h"))}
    rows = names(texts)
    complaints = [] if rows else ["rows: no row found"]
    for path, text in texts.items():
        complaints += check(path, text, rows)
    return source.report(complaints, "rows")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "."))
