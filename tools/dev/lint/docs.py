# SPDX-License-Identifier: GPL-3.0-or-later
"""What the documentation names exists.

    docs.py [ROOT]

In the Markdown pages: names that begin with lac_ or LAC_, files of the project, tests
(`unit/test_x`), links and their headings; and in the tables of symbols and equations whatever the
column `code` quotes. In the sources: the pages, headings and equations that references name. Each
page of docs/theory that is in PAGES has a table of symbols with their units and one of its
numbered equations with where they are in the code and where they come from.
"""

import os
import re
import sys

import source

PAGES = ("creep friction loads transfer events rg rg-in-time contact tangential fractal "
         "surface").split()

QUOTED = re.compile(r"`([^`\n]+)`")
NAME = re.compile(r"\b(?:lac|LAC)_\w+\b(?![*…])")
PATH = re.compile(r"(?<![\w./-])((?:src|include|tests|tools|cases|docs)/[\w./-]*\w/?)(?![\w*{<])")
C_FILE = re.compile(r"(?<![\w./*-])(\w+\.[ch])(?!\w)")
TEST = re.compile(r"(?<![\w/])((?:unit|conform|verify|extreme|case)/test_\w+)")
LINK = re.compile(r"\]\(([^)#\s:]*)(?:#([^)\s]*))?\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
EQUATION = re.compile(r"^ {2,}.*\((\d+[a-z]?)\)[ \t]*$", re.MULTILINE)
REFERENCE = re.compile(r'(docs/[\w/-]+\.md)(?:, (?:\\"([^"\\]+)\\"|eq\. (\d+[a-z]?)))?')
WORD = re.compile(r"[A-Za-z_]\w*")


def anchor(heading):
    """The name by which a page's heading is linked to."""
    kept = re.sub(r"[^\w\- ]", "", heading.strip().lower())
    return kept.replace(" ", "-")


def tables(text):
    """(line, header cells, rows of cells) of every table."""
    found, lines = [], text.split("\n")
    for i, line in enumerate(lines):
        if re.match(r"\|[ :|-]*---", line) and i > 0:
            rows = []
            for row in lines[i + 1:]:
                if not row.startswith("|"):
                    break
                rows.append(cells(row))
            found.append((i, cells(lines[i - 1]), rows))
    return found


def cells(row):
    return [cell.strip() for cell in row.replace(r"\|", "\0").strip().strip("|").split("|")]


class Project:
    """What there is to be named."""

    def __init__(self, root):
        self.root = root
        self.sources = source.files(root, ["include", "src"], (".c", ".h"))
        self.c_files = {os.path.basename(path) for path in source.files(
            root, ["include", "src", "tests", "tools"], (".c", ".h"))}
        text = "\n".join(source.read(root, path) for path in self.sources)
        tests = source.files(root, ["tests"], (".c", ".h", ".py"))
        self.words = set(WORD.findall(text)) | set(re.findall(r'"([\w-]+)"', text))
        self.all_words = self.words | {
            word for path in tests for word in WORD.findall(source.read(root, path))}

    def exists(self, path):
        return os.path.exists(os.path.join(self.root, path))

    def test_exists(self, name):
        return any(self.exists(f"tests/{name}{ending}") for ending in ("", ".c", ".py"))


def check_names(project, path, text):
    complaints = []

    def complain(position, what):
        complaints.append(f"{path}:{source.line_of(text, position)}: {what}")

    for match in NAME.finditer(text):
        if match.group() not in project.all_words:
            complain(match.start(), f"{match.group()} is nowhere in the sources")
    for match in PATH.finditer(text):
        name = match.group(1).rstrip(".")
        if "/my_" in name:  # the example's own
            continue
        if not project.exists(name) and not project.exists(f"{name}.c"):
            complain(match.start(), f"{name} does not exist")
    for quoted in QUOTED.finditer(text):
        for match in C_FILE.finditer(quoted.group(1)):
            if match.group(1) not in project.c_files:
                complain(quoted.start(), f"there is no {match.group(1)}")
    for match in TEST.finditer(text):
        if not project.test_exists(match.group(1)):
            complain(match.start(), f"there is no tests/{match.group(1)}")
    return complaints


def check_links(project, path, text):
    complaints = []
    for match in LINK.finditer(text):
        target, part = match.groups()
        line = source.line_of(text, match.start())
        page = os.path.normpath(os.path.join(os.path.dirname(path), target)) if target else path
        if not project.exists(page):
            complaints.append(f"{path}:{line}: the link {target} leads nowhere")
        elif part and page.endswith(".md"):
            headings = HEADING.findall(source.read(project.root, page))
            if part not in [anchor(heading) for heading in headings]:
                complaints.append(f"{path}:{line}: {page} has no heading #{part}")
    return complaints


def code_words(cell):
    """Identifiers that a cell quotes; of `struct.member` both, of `x[i]` x."""
    found = []
    for quoted in QUOTED.findall(cell):
        if re.fullmatch(r"[\w.>\-\[\] +*()/,&]+", quoted) and "/" not in quoted:
            quoted = re.sub(r"\[[^\]]*\]|\b\w+\.[ch]\b", "", quoted)
            found += [word for word in WORD.findall(quoted) if not re.fullmatch(r"[A-Za-z]", word)]
    return found


def check_tables(project, path, text):
    complaints = []
    for line, header, rows in tables(text):
        columns = [i for i, name in enumerate(header) if re.search(r"\bcode\b", name)]
        for k, row in enumerate(rows):
            for column in columns:
                for word in code_words(row[column] if column < len(row) else ""):
                    if word not in project.words:
                        complaints.append(f"{path}:{line + 2 + k}: {word} is nowhere in src/")
    return complaints


def check_page(path, text):
    """Whether a page of theory has its two tables, and every equation a row."""
    complaints = []
    headers = [header for _, header, _ in tables(text) if header[0] != "equation"]
    if not any({"unit"} <= set(h) and any("code" in c for c in h) for h in headers):
        complaints.append(f"{path}:1: has no table of symbols with code and unit")
    numbered = set(EQUATION.findall(text))
    listed = set()
    for _, header, rows in tables(text):
        if header[0] == "equation" and {"code", "unit", "source"} <= set(header):
            for row in rows:
                listed |= set(re.findall(r"\((\d+[a-z]?)\)", row[0]))
    for number in sorted(numbered - listed):
        complaints.append(f"{path}:1: eq. ({number}) is in no table of equation, code, unit, source")
    for number in sorted(number for number in listed if text.count(f"({number})") < 2):
        complaints.append(f"{path}:1: the table has eq. ({number}), which the page has not")
    for number in sorted(numbered):
        if EQUATION.findall(text).count(number) > 1:
            complaints.append(f"{path}:1: two equations are ({number})")
    return complaints


def check_references(project, path, text):
    """Pages, headings and equations that a string of the sources names."""
    complaints = []
    joined = re.sub(r'"\s*\n\s*"', "", text)
    for match in REFERENCE.finditer(joined):
        page, heading, number = match.groups()
        if not project.exists(page):
            complaints.append(f"{path}: {page} does not exist")
            continue
        there = source.read(project.root, page)
        if heading and not any(h.startswith(heading) for h in HEADING.findall(there)):
            complaints.append(f'{path}: {page} has no heading "{heading}"')
        if number and number not in EQUATION.findall(there):
            complaints.append(f"{path}: {page} has no equation ({number})")
    return complaints


def check_map(project, path, text):
    """Whether the code map has a row for every module, and every public header."""
    modules = {name.split("/")[1] for name in project.sources if name.startswith("src/")}
    wanted = {f"src/{name}": f"| `{name}` |" for name in modules}
    headers = source.files(project.root, ["include"], (".h",))
    wanted |= {name: f"`{name.rsplit('/', maxsplit=1)[1]}`" for name in headers if not name.endswith("/lacuna.h")}
    return [f"{path}:1: the code map has no {name}" for name, there in sorted(wanted.items()) if there not in text]


def main(root):
    project = Project(root)
    complaints = []
    pages = source.files(root, ["docs"], (".md", ".scd"))
    for path in pages + ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md",
                         "cases/data/README.md"]:
        text = source.read(root, path)
        complaints += check_names(project, path, text)
        complaints += check_links(project, path, text) if path.endswith(".md") else []
        complaints += check_tables(project, path, text)
    complaints += check_map(project, "ARCHITECTURE.md", source.read(root, "ARCHITECTURE.md"))
    for name in PAGES:
        path = f"docs/theory/{name}.md"
        complaints += check_page(path, source.read(root, path))
    for path in project.sources:
        complaints += check_references(project, path, source.read(root, path))
    return source.report(complaints, "docs")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "."))
