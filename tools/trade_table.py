#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The measured trade of every bundled case, as a table in markdown.

    tools/trade_table.py [--lacuna PROGRAM] [--page PAGE.md] [--jobs N] [CASE ...]

Calls `lacuna trade --json` on each case of the folder cases/ that has a run in time or a cascade, all
but those that LEFT_OUT names, and says which settings reach 1 % and 1e-4 for the least CPU time, and
what the case's own settings do. --page writes the table between the markers of that page. Three
minutes of one core.
"""

import argparse
import glob
import json
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LEFT_OUT = {
    "contact/j07.yaml": "49 273 contact cells, eight seconds a run",
    "contact/joint.yaml": "made to be pressed, not to be run",
    "contact/self-affine.yaml": "made to be pressed, not to be run",
    "peers/plane-patch.yaml": "128 x 128 elastic cells, a minute a run",
    "peers/periodic-line.yaml": "1 024 elastic cells over 475 years, some seconds a run",
    "rg/creep-to-failure.yaml": "a run and a cascade each, seconds a run",
    "rg/table.yaml": "two interfaces with three beta each, many seconds a run",
    "transfer/micro-slips.yaml": "20 000 steps of elastic cells a run",
    "transfer/elastic.yaml": "1 075 elastic cells to failure, some seconds a run; at levels 4",
}
SET = {"transfer/elastic.yaml": ["interface.levels=4"]}
DIALS = {"one-by-one.yaml": "rtol,fidelity"}
BEGIN, END = "<!-- trade table -->", "<!-- end of the trade table -->"
REACH = (1e-2, 1e-4)


def find_cases():
    """Bundled cases that can be traded, by their names below cases/."""
    found = []
    for path in sorted(glob.glob(os.path.join(ROOT, "cases", "**", "*.yaml"), recursive=True)):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        name = os.path.relpath(path, os.path.join(ROOT, "cases"))
        kind = "run" if re.search(r"^time:", text, re.M) else "rg" if "\nrg:" in text else None
        if kind and not name.startswith("fit/"):
            found.append((name, kind))
    return found


def trade(options, folder, name, kind, settings):
    words = [options.lacuna, "trade", os.path.join(ROOT, "cases", name), "--json", "--quiet",
             "--force", "-o", os.path.join(folder, "trade.nc"), "--jobs", str(options.jobs)]
    if kind == "rg":
        words += ["--quantity", "q-crit"]
    if name in DIALS:
        words += ["--dials", DIALS[name]]
    for setting in settings:
        words += ["--set", setting]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None, done.stderr.strip().splitlines()[-1]
    return json.loads(done.stdout), None


def error_text(error):
    return f"{100 * error:.2g} %" if error >= 9.95e-4 else f"{error:.0e}"


def describe(run):
    """Settings of a run in a few words."""
    def value(x):
        return f"{x:g}" if isinstance(x, float | int) else x

    settings = run["settings"]
    words = [value(settings[k]) for k in ("solver.method", "solver.formulation", "solver.fidelity")
             if k in settings and not (k == "solver.fidelity" and settings[k] == "static")]
    words += [f"{k.rsplit('.', maxsplit=1)[-1]} {value(v)}" for k, v in settings.items()
              if k in ("solver.rtol", "rg.contacts", "rg.shifts")]
    return ", ".join(words)


def cheapest(found, reach):
    sure = found["reference"]["error_uncertainty"] or 0.0
    good = [r for r in found["runs"] if r["end"] == "done" and r["error"] is not None
            and r["error"] + sure <= reach]
    if not good:
        return "none"
    run = min(good, key=lambda r: r["cpu_time_s"])
    return f"{describe(run)}: {error_text(run['error'])}, {run['cpu_time_s']:.3g} s"


def row(name, settings, found):
    reference = found["reference"]
    own = [r for r in found["runs"] if r["options"] == "" and r["end"] == "done"]
    mine = f"{error_text(own[0]['error'])}, {own[0]['cpu_time_s']:.3g} s" if own else "-"
    short = name + (f" ({', '.join(s.rsplit('.', maxsplit=1)[-1] for s in settings)})" if settings
                    else "")
    cut = sum(r["end"] != "done" for r in found["runs"])
    return (f"| {short} | {found['quantity']} | {reference['n_cells']} | "
            f"{error_text(reference['error_uncertainty'] or 0.0)} | {mine} | "
            + " | ".join(cheapest(found, reach) for reach in REACH)
            + f" | {len(found['runs'])}, {cut} |")


def table(options):
    lines = ["| case | quantity | cells | reference's own error | the case as it is | for 1 % | "
             "for 1e-4 | runs, of which given up or broken |", "|" + " --- |" * 8]
    names = [(n, k) for n, k in find_cases() if not options.case or n in options.case]
    with tempfile.TemporaryDirectory() as folder:
        for name, kind in names:
            settings = SET.get(name, [])
            if name in LEFT_OUT and not settings:
                continue
            found, why = trade(options, folder, name, kind, settings)
            print(f"trade_table: {name}: {why or 'done'}", file=sys.stderr)
            if found is not None:
                lines.append(row(name, settings, found))
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("case", nargs="*", help="names below cases/; all if none")
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build", "lacuna"))
    parser.add_argument("--page")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    text = table(options)
    if options.page is None:
        print(text)
        return
    with open(options.page, encoding="utf-8") as file:
        page = file.read()
    before, rest = page.split(BEGIN)
    with open(options.page, "w", encoding="utf-8") as file:
        file.write(before + BEGIN + "\n\n" + text + "\n\n" + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
