# SPDX-License-Identifier: GPL-3.0-or-later
"""What the house may cost: numbers that grow unseen, each with its budget.

    budgets.py [ROOT] [--names LIBRARY] [--pages]     LIBRARY: the shared one, for what it exports;
                                                      --pages: the words of each page, too

A budget is raised only in a commit that says why; it is lowered with each commit that saves.
"""

import collections
import os
import re
import subprocess
import sys

import layers
import source

BUDGETS = {
    "lines of src and include": 96373,
    "lines that only present results": 23782,
    "public headers": 13,
    "exported names": 44,
    "circles of includes": 0,
    "files without an opening comment": 0,
    "objects that one field more in a record compiles anew": 51,
    "words that people write and read": 74870,
}

PRESENTING = re.compile(r"src/(cli|store|report|data)/|src/\w+/describe\w*\.[ch]$")
RECORD = "include/lacuna/simulation.h"  # where lac_record is
PAGES = ("README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md")
MADE = "docs/tables/"  # by commands
PRINTED = re.compile(r"^```text\n.*?^```$", re.MULTILINE | re.DOTALL)  # by the program: tests/support/run_page.py --update
WORD = re.compile(r"[^\W_]")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', re.MULTILINE)


def included(path, name):
    """The file that an #include in a file of the project names."""
    if name.startswith("lacuna/"):
        return "include/" + name
    return "src/" + name if "/" in name else os.path.dirname(path) + "/" + name


def unit(path):
    """What is one thing: a .c file with its header; what a module shares is a thing of its own."""
    stem, _ = os.path.splitext(path)
    module, _, rest = path.replace("src/", "", 1).partition("/")
    if path.endswith(".h") and module in layers.SHARED.keys() | layers.USES.keys() and layers.SHARED.get(module, ()) is not None:
        return path if layers.shared(module, module + "/" + rest) else stem
    return stem


def circles(graph):
    """How many sets of units include one another in a circle (Tarjan)."""
    order, low, stack, found = {}, {}, [], 0

    def visit(unit):
        nonlocal found
        order[unit] = low[unit] = len(order)
        stack.append(unit)
        for other in sorted(graph.get(unit, ())):
            if other not in order:
                visit(other)
            if other in stack:
                low[unit] = min(low[unit], low[other])
        if low[unit] == order[unit]:
            at = stack.index(unit)
            found += len(stack) - at > 1
            del stack[at:]

    sys.setrecursionlimit(10000)
    for unit in sorted(graph):
        if unit not in order:
            visit(unit)
    return found


def reached(texts, start):
    """The .c files that include a header, directly or not."""
    users = collections.defaultdict(set)
    for path, text in texts.items():
        for name in INCLUDE.findall(text):
            users[included(path, name)].add(path)
    seen, todo = set(), [start]
    while todo:
        for user in users[todo.pop()] - seen:
            seen.add(user)
            todo.append(user)
    return {path for path in seen if path.endswith(".c")}


def words(root):
    """The words of each page, what has a letter or a digit; commands count, what they print (```text) does not."""
    pages = [p for p in source.files(root, ["docs"], (".md",)) if not p.startswith(MADE)]
    pages += [p for p in PAGES if os.path.exists(os.path.join(root, p))]
    written = {page: PRINTED.sub("", source.read(root, page)) for page in pages}
    return {page: sum(WORD.search(word) is not None for word in text.split()) for page, text in written.items()}


def unopened(text):
    """Whether a file does not say, under its licence, what it is for."""
    return not text.split("\n", 2)[1].startswith("//")


def measure(root):
    texts = {p: source.read(root, p) for p in source.files(root, ["include", "src"], (".c", ".h"))}
    graph = collections.defaultdict(set)
    for path, text in texts.items():
        for name in INCLUDE.findall(text):
            graph[unit(path)] |= {unit(included(path, name))} - {unit(path)}
    lines = {path: text.count("\n") for path, text in texts.items()}
    silent = [p for p in texts if p.endswith(".c") and unopened(texts[p])]
    for path in silent:
        print(f"{path}:2: no comment that says what the file is for")
    return {
        "lines of src and include": sum(lines.values()),
        "lines that only present results": sum(n for p, n in lines.items() if PRESENTING.match(p)),
        "public headers": sum(p.startswith("include/") for p in texts),
        "circles of includes": circles(graph),
        "files without an opening comment": len(silent),
        "objects that one field more in a record compiles anew": len(reached(texts, RECORD)),
        "words that people write and read": sum(words(root).values()),
    }


def exported(library):
    listing = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True,
                             check=True).stdout
    return sum(line.split()[-1].startswith("lac_") for line in listing.splitlines())


def main(given):
    root, pages = ".", False
    numbers = {}
    while given:
        word = given.pop(0)
        if word == "--names":
            numbers["exported names"] = exported(given.pop(0))
        elif word == "--pages":
            pages = True
        else:
            root = word
    numbers.update(measure(root))
    for page, number in sorted(words(root).items(), key=lambda item: -item[1]) if pages else ():
        print(f"{number:6}  {page}")
    for what, number in numbers.items():
        print(f"{number:6} of {BUDGETS[what]:6}  {what}")
    over = [f"{what}: {n}, {n - BUDGETS[what]} over" for what, n in numbers.items() if n > BUDGETS[what]]
    return source.report(over, "budgets")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
