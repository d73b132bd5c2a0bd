# SPDX-License-Identifier: GPL-3.0-or-later
"""Budgets: what can be read at a glance.

    sizes.py [--table] [ROOT]

Files of at most 500 lines; functions of at most 60 lines, 8 parameters and 4 levels of nested
blocks. Of the page of `lacuna report` files and the lines of functions. --table prints the sizes of all functions.
"""

import re
import statistics
import sys

import source

FILE, FUNCTION, PARAMETERS, NESTING = 500, 60, 8, 4

# Functions whose parameters a library prescribes: CVSensRhsFn, and one of MPI's.
PRESCRIBED = {"src/run/follow.c": "sensitivity_rates", "tests/ranks/test_pieces.c": "MPI_Sendrecv",
              "tests/ranks/count_messages.c": "MPI_Sendrecv"}

ATTRIBUTE = re.compile(r"__attribute__\s*\(\([^()]*(?:\([^()]*\)[^()]*)*\)\)")
BLOCK = re.compile(r"(?:\b(?:else|do)|[;{}:])$")
CONDITION = re.compile(r"\b(?:if|for|while|switch)$")


def opening(text, closing):
    """Position of the parenthesis that the one at `closing` closes; -1 where there is none."""
    depth = 0
    for i in range(closing, -1, -1):
        depth += {")": 1, "(": -1}.get(text[i], 0)
        if depth == 0:
            return i
    return -1


def is_block(text, brace):
    """Whether a brace inside a function opens a block, not an initialiser."""
    before = text[:brace].rstrip()
    if before.endswith(")"):
        return bool(CONDITION.search(before[: opening(before, len(before) - 1)].rstrip()))
    return bool(BLOCK.search(before))


def parameters(head):
    """Number of parameters in `type name(...)`."""
    inside = head[opening(head, len(head) - 1) + 1 : -1].strip()
    if inside in ("", "void"):
        return 0
    depth, count = 0, 1
    for letter in inside:
        depth += {"(": 1, ")": -1}.get(letter, 0)
        count += letter == "," and depth == 0
    return count


def head_of(text, start, brace):
    """The text of a function's head, or None where the brace opens something else."""
    head = ATTRIBUTE.sub(lambda m: " " * len(m.group()), text[start:brace]).rstrip()
    if not head.endswith(")") or re.search(r"\btypedef\b", head):
        return None
    name = head[: opening(head, len(head) - 1)].rstrip()
    if not re.search(r"\w$", name) or "=" in re.sub(r"\([^()]*\)", "", name):
        return None
    return head


def functions(text):
    """(name, line, lines, parameters, nesting) of every function in blanked C.

    Raises ValueError where braces do not pair."""
    found = []
    stack = []  # one entry an open brace: whether it counts as a nested block
    start, head, depth, deepest = 0, None, 0, 0
    for match in re.finditer(r"[{};]", text):
        mark, at = match.group(), match.start()
        if mark == "{":
            if not stack:
                head, depth, deepest = head_of(text, start, at), 0, 0
                stack.append(False)
            else:
                stack.append(head is not None and is_block(text, at))
                depth += stack[-1]
                deepest = max(deepest, depth)
        elif mark == "}":
            if not stack:
                raise ValueError(f"line {source.line_of(text, at)}: a brace too many")
            depth -= stack.pop()
            if not stack and head is not None:
                first = start + len(text[start:]) - len(text[start:].lstrip())
                name = re.search(r"(\w+)\s*$", head[: opening(head, len(head) - 1)]).group(1)
                line = source.line_of(text, first)
                lines = source.line_of(text, at) - line + 1
                found.append((name, line, lines, parameters(head), deepest))
        if not stack:
            start = at + 1
    if stack:
        raise ValueError("a brace is not closed")
    return found


def check(path, text):
    """Complaints about one file."""
    complaints = []
    length = text.count("\n")
    if length > FILE:
        complaints.append(f"{path}:1: {length} lines (at most {FILE})")
    try:
        all_functions = functions(source.code(text))
    except ValueError as wrong:
        return complaints + [f"{path}:1: {wrong}"]
    for name, line, lines, params, nesting in all_functions:
        for value, most, what in (
            (lines, FUNCTION, "lines"),
            (params, PARAMETERS, "parameters"),
            (nesting, NESTING, "levels of nesting"),
        ):
            if what == "parameters" and PRESCRIBED.get(path) == name:
                continue
            if value > most:
                complaints.append(f"{path}:{line}: {name}: {value} {what} (at most {most})")
    return complaints


SCRIPT = re.compile(r"^function (\w+)\(.*?^}$", re.MULTILINE | re.DOTALL)


def check_page(path, text):
    """Complaints about a file of the page: functions of scripts begin and end at the margin."""
    length = text.count("\n")
    complaints = [f"{path}:1: {length} lines (at most {FILE})"] if length > FILE else []
    for match in SCRIPT.finditer(text) if path.endswith(".js") else []:
        lines = match.group().count("\n") + 1
        if lines > FUNCTION:
            line = source.line_of(text, match.start())
            complaints.append(f"{path}:{line}: {match.group(1)}: {lines} lines (at most {FUNCTION})")
    return complaints


def table(root, paths):
    rows = []
    for path in paths:
        rows += [(row[2], path, *row) for row in functions(source.code(source.read(root, path)))]
    for _, path, name, line, lines, params, nesting in sorted(rows):
        print(f"{lines:4} {params:2} {nesting:2}  {path}:{line} {name}")
    if rows:
        lengths = [row[0] for row in rows]
        print(f"{len(rows)} functions, median {statistics.median(lengths)} lines")


def main(arguments):
    roots = [a for a in arguments if not a.startswith("--")]
    root = roots[0] if roots else "."
    paths = source.files(root, ["include", "src", "tests", "tools"], (".c", ".h"))
    if "--table" in arguments:
        table(root, paths)
    complaints = []
    for path in paths:
        complaints += check(path, source.read(root, path))
    for path in source.files(root, ["src/report/page"], (".js", ".css", ".html")):
        complaints += check_page(path, source.read(root, path))
    return source.report(complaints, "sizes")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
