#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the tables of docs/case.md, or docs/rocks.md, from the program's own, between their markers.

    tools/dev/case_tables.py [--check] [--program build/lacuna] [--page docs/case.md] [--rocks]

A marker `<!-- lacuna describe NAME -->` begins a table, `<!-- -->` ends it; NAME is a kind of model or
a section. What stands outside is written by hand. --check says what would change, and exits 1 then.
"""

import argparse
import difflib
import json
import re
import subprocess
import sys

BLOCK = re.compile(r"(<!-- lacuna describe ([\w.-]+) -->\n).*?(<!-- -->)", re.DOTALL)
HEAD = "| key | unit | range | default | meaning |\n| --- | --- | --- | --- | --- |\n"
LISTED = 12  # choices; of more the program has a list of its own
COMMON = 3  # models that share a row before it is listed for all of them at once


def number(value):
    whole = value == int(value) and abs(value) < 1e8
    return f"{value:.0f}" if whole and (abs(value) < 1e5 or value % 1000) else f"{value:.6g}"


def limits(row):
    """ "> 0, ≤ 1e+09"; the choices; nothing where anything goes."""
    if row["type"] == "choice" and len(row["choices"]) > LISTED:
        return f"one of `lacuna describe {row['key']}`"
    if row["type"] == "choice":
        return ", ".join(row["choices"])
    if row["type"] == "path":
        return "file"
    parts = []
    if row["min"] is not None:
        parts.append(("> " if row["above_min"] else "≥ ") + number(row["min"]))
    if row["max"] is not None:
        parts.append("≤ " + number(row["max"]))
    return ", ".join(parts)


def fallback(row):
    if row["required"]:
        return "required"
    if row["default"] is None:
        return ""
    return row["default"] if row["type"] == "choice" else number(row["default"])


def line(row):
    unit = "" if row["unit"] in (None, "1") else row["unit"]
    meaning = row["doc"] + (" (may vary by cell)" if row["cellwise"] else "")
    cells = [f"`{row['key']}`", unit, limits(row), fallback(row), meaning]
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |\n"


def table(rows):
    return HEAD + "".join(line(row) for row in rows) if rows else ""


def linked(reference):
    """Pages of docs/ as links from a page there."""
    return re.sub(r"docs/([\w/-]+\.md)", r"[\1](\1)", reference)


def shared_rows(models):
    """Rows that several models have, each with the models' names."""
    rows = []
    for model in models:
        for row in model["parameters"]:
            names = [other["name"] for other in models if row in other["parameters"]]
            if len(names) >= COMMON and (row, names) not in rows:
                rows.append((row, names))
    return rows


def describe_kind(kind):
    models = kind["models"]
    shared = shared_rows(models)
    groups = {}
    for row, names in shared:
        groups.setdefault(tuple(names), []).append(row)
    parts = []
    for names, rows in groups.items():
        whose = "all" if len(names) == len(models) else ", ".join(f"`{name}`" for name in names)
        parts.append(f"Common to {whose}:\n\n{table(rows)}")
    common = [row for row, _ in shared]
    for model in models:
        own = [row for row in model["parameters"] if row not in common]
        text = f"**`{model['name']}`**: {model['summary']}. *{linked(model['reference'])}*\n"
        parts.append(text + ("\n" + table(own) if own else ""))
    return "\n".join(parts)


def describe(tables):
    """The text of every kind and section by its name."""
    texts = {section["name"]: table(section["parameters"]) for section in tables["sections"]}
    texts.update({kind["name"]: describe_kind(kind) for kind in tables["kinds"] if kind["command"] is None})
    return texts


def quantity(told):
    """ "0.601 (0.51–0.754)", "6.1 µm (5.9–8.3)"; nothing where it is not stated."""
    if told["value"] is None:
        return ""
    scale = 1e6 if told["unit"] == "m" else 1
    value, low, high = (f"{scale * told[key]:.3g}" for key in ("value", "low", "high"))
    unit = " µm" if told["unit"] == "m" else ""
    return f"{value}{unit}" + (f" ({low}–{high})" if low != high else "")


def rock_table(rocks):
    text = "| rock | what | f0 | a | b | dc | a - b |\n" + "| --- " * 7 + "|\n"
    for rock in rocks:
        numbers = [quantity(rock[key]) for key in ("f0", "a", "b", "dc", "a_minus_b")]
        text += f"| `{rock['name']}` | " + " | ".join([rock["summary"], *numbers]) + " |\n"
    text += "\n| rock | found | conditions | source |\n" + "| --- " * 4 + "|\n"
    for rock in rocks:
        source = f"{rock['source']} ([read here]({rock['read_at']}))"
        text += f"| `{rock['name']}` | " + " | ".join([rock["found"], rock["conditions"], source]) + " |\n"
    return text


def fill(page, texts):
    found = BLOCK.findall(page)
    names = [name for _, name, _ in found]
    for name in sorted(set(texts) - set(names)):
        raise SystemExit(f"no marker for `lacuna describe {name}`")
    for name in names:
        if name not in texts:
            raise SystemExit(f"a marker names {name}, which `lacuna describe` does not know")
    return BLOCK.sub(lambda m: f"{m.group(1)}\n{texts[m.group(2)]}\n{m.group(3)}", page)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if it would")
    parser.add_argument("--program", default="build/lacuna")
    parser.add_argument("--page", default="docs/case.md")
    parser.add_argument("--rocks", action="store_true", help="the table of rocks")
    given = parser.parse_args()
    what = ["rock"] if given.rocks else []
    told = subprocess.run([given.program, "describe", *what, "--json"], check=True, capture_output=True)
    tables = json.loads(told.stdout)
    with open(given.page, encoding="utf-8") as file:
        page = file.read()
    filled = fill(page, {"rock": rock_table(tables["rocks"])} if given.rocks else describe(tables))
    if given.check:
        changes = difflib.unified_diff(page.splitlines(), filled.splitlines(), given.page,
                                       "tools/dev/case_tables.py", lineterm="", n=0)
        shown = list(changes)
        print("\n".join(shown[:40]))
        sys.exit(1 if shown else 0)
    with open(given.page, "w", encoding="utf-8") as file:
        file.write(filled)


if __name__ == "__main__":
    main()
