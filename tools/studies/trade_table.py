#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The measured trade of every bundled case, as a table in markdown.

    tools/studies/trade_table.py [--page PAGE.md] [--resume] [--jobs N] [--lacuna PROGRAM] [CASE ...]

Calls `lacuna trade --json` on each case of the folder cases/ and says which settings reach 1 % and
1e-4 for the least CPU time, and what the case's own settings do. What is asked of a case is what
`lacuna trade` asks of it by itself, but for those that ASKED names, each with its reason, which the
page has too. --page writes the table between the markers of that page, after every case; a case that
could not be measured keeps the row that stands there. What was measured is kept in --keep FOLDER:
with --resume a case is measured anew only where it, the program or the question is another. Some
six minutes of one core.
"""

import argparse
import datetime
import glob
import hashlib
import json
import os
import re
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CONTACT = "a contact: what its grid gives away"
# Words for `lacuna trade`, and why: the other cases are asked with none.
ASKED = {
    "contact/j07.yaml": ("--quantity contact-fraction", CONTACT),
    "contact/joint.yaml": ("--quantity contact-fraction", CONTACT),
    "contact/self-affine.yaml": ("--quantity contact-fraction", CONTACT),
    "normal/dimension.yaml": ("--quantity pressure", "its dimension is given, the load follows"),
    "one-by-one.yaml": ("--dials rtol,fidelity", "made for fidelity: events"),
    "peers/plane-patch.yaml": (
        "--dials rtol=1e-3:1e-4:1e-5 --until '1.1e9 s'",
        "128 x 128 elastic cells, 13 s a run to the end: the first of its three earthquakes"),
    "rg/creep-to-failure.yaml": (
        "--dials rtol,formulation",
        "three seconds a run: methods are left out"),
    "shear-cycle.yaml": ("--quantity work", "the work of a cycle of shear is what it shows"),
    "solver/lumped.yaml": ("--dials fidelity=lumped:ode,rtol", "lumped cells are compared with all cells"),
    "transfer/micro-slips.yaml": ("--quantity events", "its catalogue is what it shows"),
}
BEGIN, END = "<!-- trade table -->", "<!-- end of the trade table -->"
HEAD = ("| case | quantity | cells | reference's own error | the case as it is | for 1 % | for 1e-4 | "
        "runs, of which given up or broken | measured |\n" + "|" + " --- |" * 9)
REACH = (1e-2, 1e-4)


def find_cases():
    """Names of all bundled cases, below cases/."""
    folder = os.path.join(ROOT, "cases")
    return sorted(os.path.relpath(path, folder) for path in
                  glob.glob(os.path.join(folder, "**", "*.yaml"), recursive=True))


def words_of(name):
    return re.findall(r"'[^']*'|\S+", ASKED.get(name, ("", ""))[0])


def digest(options, name):
    """Stands for all that a measurement depends on."""
    total = hashlib.sha256(" ".join(words_of(name)).encode())
    for path in (options.lacuna, os.path.join(ROOT, "cases", name)):
        with open(path, "rb") as file:
            total.update(file.read())
    return total.hexdigest()


def trade(options, name, out):
    """What `lacuna trade` says; None and why where it has no answer."""
    words = [options.lacuna, "trade", os.path.join(ROOT, "cases", name), "--json", "--quiet",
             "--force", "-o", out, "--jobs", str(options.jobs)]
    words += [word.strip("'") for word in words_of(name)]
    if options.resume and os.path.exists(out + ".runs"):
        words.append("--resume")
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return None, (done.stderr.strip().splitlines() or ["no message"])[-1]
    return json.loads(done.stdout), None


def measure(options, name):
    """The trade of a case with its date: the one that is kept, where it still holds."""
    place = os.path.join(options.keep, name.replace("/", "-"))
    mark = digest(options, name)
    if options.resume and os.path.exists(place + ".json"):
        with open(place + ".json", encoding="utf-8") as file:
            kept = json.load(file)
        if kept["digest"] == mark:
            return kept, None
    found, why = trade(options, name, place + ".nc")
    if found is None:
        return None, why
    kept = {"digest": mark, "date": datetime.date.today().isoformat(), "trade": found}
    with open(place + ".part", "w", encoding="utf-8") as file:
        json.dump(kept, file)
    os.replace(place + ".part", place + ".json")
    return kept, None


def error_text(error):
    return f"{100 * error:.2g} %" if error >= 9.95e-4 else f"{error:.0e}" if error > 0 else "0"


def describe(run):
    """Settings of a run in a few words: names as they are, numbers after their key."""
    words = []
    for key, value in run["settings"].items():
        short = key.rsplit(".", maxsplit=1)[-1]
        if isinstance(value, str):
            words += [value] if value not in ("static", "-") else []
        else:
            words.append(f"{short} {value:g}")
    return ", ".join(words)


def cheapest(found, reach):
    sure = found["reference"]["error_uncertainty"] or 0.0
    good = [r for r in found["runs"] if r["end"] == "done" and r["error"] is not None
            and r["error"] + sure <= reach]
    if not good:
        return "none"
    run = min(good, key=lambda r: r["cpu_time_s"])
    return f"{describe(run)}: {error_text(run['error'])}, {run['cpu_time_s']:.3g} s"


def row(name, kept):
    found = kept["trade"]
    reference = found["reference"]
    own = [r for r in found["runs"] if r["options"] == "" and r["end"] == "done"]
    mine = f"{error_text(own[0]['error'])}, {own[0]['cpu_time_s']:.3g} s" if own else "-"
    cut = sum(r["end"] != "done" for r in found["runs"])
    sure = reference["error_uncertainty"]
    star = " \\*" if name in ASKED else ""
    return (f"| {name}{star} | {found['quantity']} | "
            f"{reference['n_cells']} | {'-' if sure is None else error_text(sure)} | {mine} | "
            + " | ".join(cheapest(found, reach) for reach in REACH)
            + f" | {len(found['runs'])}, {cut} | {kept['date']} |")


def reasons():
    """What was asked otherwise, and why."""
    return "\n".join(f"- {name}: `{asked}`; {why}." for name, (asked, why) in sorted(ASKED.items()))


def case_of(line):
    """The case that a row is of."""
    return line.split("|")[1].strip().split(" ")[0]


def rows_of(page):
    """The rows that stand between the markers, by case."""
    lines = page.split(BEGIN)[1].split(END)[0].splitlines()
    return {case_of(line): line for line in lines
            if line.startswith("| ") and ".yaml" in case_of(line)}


def compose(rows):
    lines = [rows[name] for name in find_cases() if name in rows]
    return (HEAD + "\n" + "\n".join(lines)
            + "\n\nAsked otherwise than by themselves (\\*), by these words:\n\n" + reasons())


def write_page(path, rows):
    with open(path, encoding="utf-8") as file:
        page = file.read()
    before, rest = page.split(BEGIN)
    part = path + ".part"
    with open(part, "w", encoding="utf-8") as file:
        file.write(before + BEGIN + "\n\n" + compose(rows) + "\n\n" + END + rest.split(END)[1])
    os.replace(part, path)


def read_rows(options):
    if options.page is None:
        return {}
    with open(options.page, encoding="utf-8") as file:
        page = file.read()
    if page.count(BEGIN) != 1 or page.count(END) != 1:
        sys.exit(f"trade_table: {options.page}: has no place for the table, from {BEGIN} to {END}")
    return rows_of(page)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("case", nargs="*", help="names below cases/; all if none")
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build", "lacuna"))
    parser.add_argument("--page")
    parser.add_argument("--keep", default=os.path.join(ROOT, "build", "trade-table"))
    parser.add_argument("--resume", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    unknown = set(options.case) - set(find_cases())
    if unknown:
        parser.error(f"no bundled case: {', '.join(sorted(unknown))}")
    os.makedirs(options.keep, exist_ok=True)
    return options


def main():
    options = arguments()
    rows, failed = read_rows(options), 0
    names = options.case or find_cases()
    for count, name in enumerate(names, 1):
        kept, why = measure(options, name)
        print(f"trade_table: {count} of {len(names)}: {name}: {why or 'done'}", file=sys.stderr)
        failed += kept is None
        if kept is not None:
            rows[name] = row(name, kept)
        if options.page is not None and kept is not None:
            write_page(options.page, rows)
    if options.page is None:
        print(compose(rows))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
