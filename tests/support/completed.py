# SPDX-License-Identifier: GPL-3.0-or-later
"""What the program tells shells: `lacuna __complete WORDS...`."""

import json
import subprocess


def offered(program, *words, **options):
    """Candidates for the last word and what they mean; of files what stands before and the endings."""
    done = subprocess.run([program, "__complete", *words], stdin=subprocess.DEVNULL, timeout=60,
                          capture_output=True, text=True, check=True, **options)
    assert done.stderr == "", done.stderr
    return dict(line.split("\t") for line in done.stdout.splitlines())


def commands(program):
    return list(offered(program, ""))


# Where the rows of a section or the models of a kind stand, if not where its name says.
PLACES = {
    "case": [""],
    "output.every": ["output.every", "output.fields_every", "output.checkpoint"],
    "compare": ["compare.0"],
    "output.points": ["output.points.0"],
    "load.history.steps": ["load.history.steps.0"],
    "load.shear": ["load.shear.0"],
    "load.normal_stress": ["load.normal_stress.0"],
    "load.pore_pressure": ["load.pore_pressure.0"],
    "weakening": ["weakening.0"],
    "friction.spread": ["interface.spread.pressure", "initial.spread.slip_rate", "initial.spread.state"],
}


def rows(program):
    """All keys of a case, places in lists as 0, each with what `lacuna describe` says of it."""
    told = json.loads(subprocess.run([program, "describe", "--json"], stdin=subprocess.DEVNULL, timeout=60,
                                     capture_output=True, text=True, check=True).stdout)
    kinds = {kind["name"]: kind for kind in told["kinds"]}
    cellwise = {row["key"] for law in kinds["friction"]["models"] for row in law["parameters"] if row["cellwise"]}
    found = {}

    def add(folder, models):
        for model in models:
            for row in model["parameters"]:
                found[".".join(part for part in (folder, model.get("as", model["name"]), row["key"]) if part)] = row

    for section in told["sections"]:
        for folder in PLACES.get(section["name"], [section["name"]]):
            add(folder, [section | {"as": ""}])
    for kind in told["kinds"]:
        if not kind["option"] and kind["command"] is None:
            for folder in PLACES.get(kind["section"], [kind["section"]]):
                add(folder, kind["models"])
    for key in cellwise:
        add(f"friction.spread.{key}", kinds["spread"]["models"])
    return {key: row for key, row in found.items() if not any(other.startswith(key + ".") for other in found)}


def keys(program):
    return list(rows(program))


def choices(program, key):
    """What the value of a key can be."""
    return rows(program)[key].get("choices", [])
