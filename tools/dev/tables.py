#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pages of docs/tables that say what the program says of itself.

    tools/dev/tables.py [--check] [--program build/lacuna] [keys | rocks | files ...]

keys: every key of a case, and rocks: what is known of their friction, both from `lacuna describe`;
files: the variables of the files that the commands of CALLS write, some two minutes. All where none is
named. --check changes nothing, says what would change, and exits 1 then.
"""

import argparse
import difflib
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MADE = "Made by `tools/dev/tables.py {}`; do not edit."
HEAD = "| key | unit | range | default | meaning |\n| --- | --- | --- | --- | --- |\n"
LISTED = 12  # choices; of more the program has a list of its own
COMMON = 3  # models that share a row before it is listed for all of them at once

# Comments that tell of the case at hand: what they tell in general.
OF_THE_CASE = {
    "n_slip": "the comment says when a cell slips",
    "slip_fraction": "N_slip/N_tot of the cells; the comment says when a cell slips",
    "critical_fraction": "of the static cascade, or as given; the comment says where it is from, or why there is none",
    "lake_level": "on the scale of the load; a second one is lake_level_2",
}

# (command, its words): between them they write every variable, and print every key of JSON.
CALLS = (
    ("run", "cases/block.yaml -o block.nc --set institution=Somewhere"),
    ("run", "cases/block.yaml -o picked.nc --accuracy 1%"),
    ("run", "cases/block.yaml -o few.nc --set solver.fidelity=lumped"),
    ("run", "cases/block.yaml -o open.nc --set solver.fidelity=auto"),
    ("run", "cases/block.yaml -o kept.nc --set 'output.fields=[slip, slip_rate, state]'"),
    ("run", "--from kept.nc --at 3 -o branch.nc --set solver.rtol=1e-7"),
    ("check", "--from kept.nc --at 3"),
    ("run", "cases/transfer/micro-slips.yaml -o run.nc --set rg.field=equal --set analysis.rg={} --set "
            "output.fields=[slip,slip_rate,state,traction,pore_pressure] --set output.fields_every.steps=200 "
            "--set 'output.points=[{name: A, x: 1 mm, y: 1 mm}]'"),
    ("run", "cases/load/reservoir.yaml -o lake.nc --set output.fields=[factor_of_safety] --set "
            "'output.factor_of_safety.reference_rate=0.5 mm/day'"),
    ("run", "cases/load/turning.yaml -o turned.nc --set interface.levels=3 --set 'output.points=[{name: A, x: 1 m, y: 1 m}]'"),
    ("run", "cases/load/rain.yaml -o rain.nc"),
    ("run", "cases/weakening/pressurization.yaml -o hot.nc --set output.fields=[excess_pore_pressure,temperature]"),
    ("run", "cases/weakening/bridges.yaml -o broken.nc --set output.fields=[broken_cohesion]"),
    ("run", "cases/load/water-table.yaml -o table.nc"),
    ("run", "cases/load/chair.yaml -o chair.nc"),
    ("run", "cases/load/toe.yaml -o toe.nc"),
    ("contact", "cases/surface/joint.yaml -o joint.nc"),
    ("contact", "cases/surface/file.yaml -o file.nc"),
    ("contact", "cases/contact/self-affine.yaml -o contact.nc"),
    ("contact", "cases/shear-cycle.yaml -o cycle.nc --set interface.levels=6"),
    ("rg", "cases/rg/fix.yaml -o rg.nc"),
    ("rg", "run.nc -o now.nc"),
    ("precursors", "cases/data/creep.csv --displacement disp_mm:mm --driver cases/data/creep.csv/disp_mm:mm -o series.nc --rolling --failed-at "
                   "2020-08-12"),
    ("precursors", "run.nc -o run-precursors.nc"),
    ("precursors", "cases/data/creep.csv --case cases/fit/block.yaml -o fitted.nc --set fit.steps=8 "
                   "--set fit.burn=2 --set fit.starts=2 --onset 5,20"),
    ("fit", "cases/vajont-lake.yaml cases/data/vajont_rates.csv -o stated.nc --set fit.steps=8 --set fit.burn=2 "
            "--set fit.rounds=0 --set fit.starts=2 --set fit.walkers=12"),
    ("fit", "cases/fit/block.yaml cases/data/creep.csv -o fit.nc --set fit.steps=8 --set fit.burn=2 "
            "--set fit.starts=2 --set 'output.points=[{name: A}]' --set fit.point=A"),
    ("fit", "cases/fit/velocity-step.yaml cases/data/velocity_step.csv -o step.nc --set fit.starts=2 --set fit.steps=8 "
            "--set fit.burn=2 --set fit.rounds=0"),
    ("trade", "cases/block.yaml -o trade.nc --dials rtol=1e-3:1e-5 --reach 1%"),
    ("sweep", "cases/block.yaml -o sweep.nc --design saltelli --members 8 --over friction.aging.dc='uniform(1 mm, 2 mm)' "
              "--over friction.aging.a='uniform(0.009, 0.01)'"),
    ("sweep", "cases/block.yaml -o tornado.nc --design tornado --over friction.aging.dc='1 mm, 2 mm'"),
    ("check", "cases/vajont.yaml"),
    ("run", "cases/century.yaml -o compared.nc --set 'output.points=[{name: A}]' --set compare.0.point=A"),
    ("report", "block.nc"),
    ("export", "run.nc"),
    ("new", "slope"),
    ("new", "fitted --kind fit"),
    ("describe", ""),
    ("describe", "water"),
    ("describe", "rock limestone"),
    ("completion", "bash"),
)


def call(program, words, folder=ROOT, status=0):
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False, timeout=200, cwd=folder,
                          stdin=subprocess.DEVNULL)
    if done.returncode != status:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stderr}")
    return done.stdout



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
    """Pages of docs/ as links from a page of docs/tables."""
    return re.sub(r"docs/([\w/-]+\.md)", r"[\1](../\1)", reference)


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


def keys_page(program):
    """Every section and kind of model under a heading, its key in a case."""
    told = json.loads(call(program, ["describe", "--json"]))
    kinds = [kind for kind in told["kinds"] if kind["command"] is None]
    parts = ["# Keys of a case\n\nEvery key of a [case file](../case.md), with the unit of a bare number, its range, "
             "default and meaning, from\n`lacuna describe`. " + MADE.format("keys") + "\n"]
    for about in told["sections"]:
        shown = table(about["parameters"])
        parts.append(f"## `{about['name']}`\n\n{sentence(about['summary'])}\n" + ("\n" + shown if shown else ""))
    for kind in kinds:
        name = f"`{kind['section']}`" + (f": {kind['name']}" if kind["option"] else ", its models")
        parts.append(f"## {name}\n\n{sentence(kind['summary'])}\n\n{describe_kind(kind)}")
    return "\n".join(parts)


def sentence(text):
    return text[0].upper() + text[1:] + "."


def quantity(told):
    """ "0.601 (0.51–0.754)", "6.1 µm (5.9–8.3)"; nothing where it is not stated."""
    if told["value"] is None:
        return ""
    scale = 1e6 if told["unit"] == "m" else 1
    value, low, high = (f"{scale * told[key]:.3g}" for key in ("value", "low", "high"))
    unit = " µm" if told["unit"] == "m" else ""
    return f"{value}{unit}" + (f" ({low}–{high})" if low != high else "")


def rocks_page(program):
    rocks = json.loads(call(program, ["describe", "rock", "--json"]))["rocks"]
    text = ("# What is known of the friction of rocks\n\nHow to use these numbers: [rocks](../rocks.md). "
            + MADE.format("rocks") + "\n\n")
    text += "| rock | what | f0 | a | b | dc | a - b |\n" + "| --- " * 7 + "|\n"
    for rock in rocks:
        numbers = [quantity(rock[key]) for key in ("f0", "a", "b", "dc", "a_minus_b")]
        text += f"| `{rock['name']}` | " + " | ".join([rock["summary"], *numbers]) + " |\n"
    text += "\n| rock | found | conditions | source |\n" + "| --- " * 4 + "|\n"
    for rock in rocks:
        source = f"{rock['source']} ([read here]({rock['read_at']}))"
        text += f"| `{rock['name']}` | " + " | ".join([rock["found"], rock["conditions"], source]) + " |\n"
    return text


def make_files(program, folder):
    """Runs CALLS in a folder: (command, what it printed as JSON, its file or None) of each."""
    os.symlink(os.path.join(ROOT, "cases"), os.path.join(folder, "cases"))
    for command, words in CALLS:
        words = shlex.split(words)
        # of eight steps no sampler converges: what it drew is written all the same
        printed = call(program, [command, *words, "--json"], folder, 1 if command == "fit" else 0)
        yield command, printed, os.path.join(folder, words[words.index("-o") + 1]) if "-o" in words else None


def of_indicators(program):
    """Names of the variables of the indicators, which `lacuna describe indicator` lists."""
    models = json.loads(call(program, ["describe", "indicator", "--json"]))["kinds"][0]["models"]
    return {f"{m['name']}_{v['key']}" for m in models for v in m["values"]} | {f"{m['name']}_points" for m in models}


def named(name, variable, indicators):
    """A variable's name on the page; None where the user or an indicator names it."""
    if {"case_key", "sweep_key"} & set(variable.ncattrs()) or re.sub(r"level_\d+$", "level_0", name) in indicators:
        return None
    return re.sub(r"^driver_\w+?(_rate)?$", r"driver_NAME\1", name)


def meaning(name, variable):
    attributes = {key: variable.getncattr(key) for key in ("long_name", "comment", "flag_meanings", "flag_values")
                  if key in variable.ncattrs()}
    parts = [attributes.get("long_name", ""), OF_THE_CASE.get(name, attributes.get("comment", ""))]
    if "flag_meanings" in attributes:
        words = attributes["flag_meanings"].split()
        parts.append(", ".join(f"{value} {word}" for value, word in zip(attributes["flag_values"], words)))
    return re.sub(r"\bdisp_mm\b", "NAME", "; ".join(part for part in parts if part)).replace("|", r"\|")


def files_page(written, indicators):
    """The variables and attributes of files, (command, path) of each, a table a command."""
    import netCDF4
    tables, attributes = {}, {}
    for command, path in written:
        with netCDF4.Dataset(path) as file:
            attributes.setdefault(command, {}).update(dict.fromkeys(file.ncattrs()))
            for name, variable in file.variables.items():
                shown = named(name, variable, indicators)
                if shown is None:
                    continue
                unit = getattr(variable, "units", "")
                unit = "s or a date" if " since " in unit else "" if unit == "1" else unit
                row = [", ".join(variable.dimensions), "the driver's" if shown == "driver_NAME" else unit, meaning(name, variable)]
                known = tables.setdefault(command, {}).setdefault(shown, row)
                if unit == "s or a date":
                    known[1] = unit
    text = ("# Variables of the files\n\nWhat each command writes, by the words of its files; what is beside the variables: "
            "[the output files](../format.md).\n" + MADE.format("files") + "\n")
    for command, rows in tables.items():
        text += f"\n## The file of `lacuna {command}`\n\n| variable | dimensions | unit | meaning |\n" + "| --- " * 4 + "|\n"
        text += "".join(f"| `{name}` | " + " | ".join(row) + " |\n" for name, row in rows.items())
        own = [name for name in attributes[command] if command == "run" or name not in attributes["run"]]
        text += "\nAttributes: " + ", ".join(f"`{name}`" for name in own) + ".\n"
    return text


def files_of(program):
    with tempfile.TemporaryDirectory(prefix="lacuna-files-") as folder:
        written = [(command, path) for command, _, path in make_files(program, folder) if path]
        return files_page(written, of_indicators(program))


PAGES = {"keys": ("case-keys.md", keys_page), "rocks": ("rocks.md", rocks_page), "files": ("files.md", files_of)}


def difference(name, text):
    """What would change of a page, as lines."""
    path = os.path.join(ROOT, "docs", "tables", PAGES[name][0])
    with open(path, encoding="utf-8") as file:
        return list(difflib.unified_diff(file.read().splitlines(), text.splitlines(), path,
                                         f"tools/dev/tables.py {name}", lineterm="", n=0))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 if it would")
    parser.add_argument("--program", default=os.path.join(ROOT, "build", "lacuna"))
    parser.add_argument("page", nargs="*", help=", ".join(PAGES) + "; all if none")
    given = parser.parse_args()
    if set(given.page) - set(PAGES):
        parser.error(f"a page is one of {', '.join(PAGES)}")
    changed = []
    for name in given.page or PAGES:
        path, make = PAGES[name]
        text = make(os.path.abspath(given.program))
        if given.check:
            changed += difference(name, text)
        else:
            with open(os.path.join(ROOT, "docs", "tables", path), "w", encoding="utf-8") as file:
                file.write(text)
    if changed:
        sys.exit("\n".join(changed[:40]))


if __name__ == "__main__":
    main()
