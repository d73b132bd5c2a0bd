#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of each series at hand, failing or not, by the same rules; and methods beside an independent program.

    hindcasts.py [--program build/lacuna] [--data FOLDER]

Prints Markdown for docs/tables/theory-forecasting.md. FOLDER has series that may not be shipped; those that are not there are
left out. Rules: a series is read whole, with the columns, units and drivers of SERIES below, at default thresholds, at
each of its readings from what was known then. No window, onset or smoothing is chosen. A file of cases/data stands for one
of the same name in FOLDER, and a file that is not named below is named in the output. The comparisons after that use
the windows that the independent program used.
"""

import argparse
import csv
import datetime
import json
import os
import subprocess
import sys
import tempfile

import slopes
import verdict_tables
from verdicts import Missing, issue_of, need

CASES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "cases", "data")

CENTURY_RAIN = "century_rain_2013-12_2014-02.csv"
# title: (file, words to read it, failure or None, what is known). {folder} is where the file is. A word "steps:NAME" stands for
# a column whose values are displacements since the reading before: their sum is read.
SERIES = {
    "Century Mine 31-2008": ("century_prism_31-2008.csv", ["--displacement", "displacement_mm:mm", "--driver",
                             f"{{folder}}/{CENTURY_RAIN}/rain_mm:mm:sum"], "2014-02-23",
                             "failure began on 23 February 2014, after 115 mm of rain"),
    "Century Mine 31-2007": ("century_prism_31-2007_tail.csv", ["--displacement", "displacement_mm:mm"], "2014-02-23",
                             "the same wall, 7 readings"),
    "Vajont": ("vajont_anchors.csv", ["--velocity", "rate_cm_per_day:cm/day"], "1963-10-09T21:39",
               "failed on 9 October 1963; statements of texts, not measured"),
    "made-up block": ("creep.csv", ["--displacement", "disp_mm:mm"], "2020-08-12", "fails on 12 August 2020"),
    "made-up prism": ("prism.csv", ["--time-format", "%d.%m.%Y %H:%M", "--displacement", "Weg_mm:mm"], "2024-03-18T14:20",
                      "fails on 18 March 2024"),
    "Chambon, crisis": ("chambon_2015_C15.csv", ["--displacement", "displacement_mm:mm"], "2015-07-05",
                        "1 to 2 m/day on 4 and 5 July 2015, blocks of hundreds of m3, then slower"),
    "Chambon, collapse": ("chambon_2015_C15.csv", ["--displacement", "displacement_mm:mm"], "2015-07-27",
                          "broke up in the night of 26 July 2015"),
    "Baijiabao": ("baijiabao_daily_2017-10_2018-08.csv", ["--displacement", "displacement_mm:mm", "--driver", "rain_mm:mm:sum",
                  "--driver", "reservoir_m:m"], None, "did not fail"),
    "Lamosano": ("lamosano_p5_rain_2015_2020.csv", ["--displacement", "p5:mm", "--driver", "rain:mm:sum"], None, "did not fail"),
    "Lamosano, steps added up": ("lamosano_p5_rain_2015_2020.csv", ["--displacement", "steps:p5", "--driver", "rain:mm:sum"],
                                 None, "did not fail"),
}
NO_MOTION = {CENTURY_RAIN, "lake.csv", "piezometer.csv", "shaking.csv", "size_effect.csv",
             "vajont_lake.csv", "vajont_rates.csv"}  # the last is of vajont.py

# Of an independent Python program on the same data: to the hour, in 2015 and in the data's own clock.
CHAMBON = {"inv8": "2015-07-05T09:00", "log": "2015-07-05T11:00", "voight": "2015-07-04T00:00",
           "block": "2015-07-04T05:00", "lppls": "2015-07-04T12:00"}
CHAMBON_ALPHA = 1.91  # slope of ln(dv/dt) on ln v since 10 June
CHAMBON_RMS = {"log": 6.0, "voight": 2.3, "block": 2.4, "lppls": 1.08}
INV8 = {"2015-06-21": "2015-07-03T22:00", "2015-06-23": "2015-07-05T16:00",
        "2015-06-25": "2015-07-06T08:00", "2015-06-27": "2015-07-06T17:00",
        "2015-06-29": "2015-07-07T04:00", "2015-07-01": "2015-07-05T09:00"}


def seconds(text):
    return datetime.datetime.fromisoformat(text).replace(tzinfo=datetime.timezone.utc).timestamp()


def length(value):
    """A time in its usual unit."""
    for name, size in (("year", slopes.YEAR), ("day", slopes.DAY), ("hour", 3600.0)):
        if abs(value) >= 2 * size:
            break
    return f"{value / size:.3g} {name}{'' if f'{value / size:.3g}' == '1' else 's'}"


def date(value):
    if value is None or abs(value) > 6e10:
        return "-"
    at = datetime.datetime.fromtimestamp(value, datetime.timezone.utc)
    return f"{at:%Y-%m-%d %H} h"


def interval(pair):
    return "-" if pair is None else f"{date(pair[0])} to {date(pair[1])}"


class Program:
    def __init__(self, path):
        self.path = path

    def ask(self, data, *options):
        done = subprocess.run([self.path, "precursors", data, "--json", *options], check=True,
                              capture_output=True, text=True)
        return json.loads(done.stdout)


# ---- every series, by one rule

def summed(path, words, folder):
    """The series with displacements where it has steps, and how it is read."""
    name = next((word[6:] for word in words if word.startswith("steps:")), None)
    if name is None:
        return path, words
    with open(path, encoding="utf-8") as data:
        rows = list(csv.DictReader(line for line in data if not line.startswith("#")))
    total = 0.0
    for row in rows:
        total += float(row[name])
        row[name] = f"{total:.6f}"
    path = os.path.join(folder, os.path.basename(path))
    with open(path, "w", encoding="utf-8", newline="") as out:
        writer = csv.DictWriter(out, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    return path, [f"{name}:mm" if word.startswith("steps:") else word for word in words]


def first_of(issues, failure, warned):
    """How long before the failure it first was in force."""
    times = [issue["time"] for issue in issues if warned(issue)]
    return length(failure - times[0]) + " before" if times else "none"


def told(issues, failure):
    """What a row says of the issues: at the last, then of a failure or of the absence of one."""
    last = issues[-1]
    p = "" if last["p"] is None else f", p {last['p']:.2g}"
    cells = [verdict_tables.LEVELS[last["level"]], last["accelerates"] + p]
    if failure is None:
        years = (last["time"] - issues[0]["time"]) / slopes.YEAR
        count = verdict_tables.entries({"issues": issues}, verdict_tables.is_warned)
        return [*cells, "-", "-", "-", "-", f"{count / years:.2g} ({count} in {years:.2g} years)"]
    median = f"{length(last['pooled'][2] - failure)}" if last["pooled"] else "no forecast"
    return [*cells, length(failure - last["time"]), first_of(issues, failure, verdict_tables.is_warned),
            first_of(issues, failure, verdict_tables.is_alarmed), median, "-"]


def every_series(program, folder):
    read, rows = [], []
    for title, (name, words, failed, known) in SERIES.items():
        place = next((place for place in (CASES, folder) if os.path.exists(os.path.join(place, name))), None)
        if place is None:
            continue
        with tempfile.TemporaryDirectory(prefix="lacuna-hindcasts-") as work:
            path, used = summed(os.path.join(place, name), words, work)
            answer = program.ask(path, *(word.format(folder=place) for word in used), "--rolling", "--issues", "100000", "-q")
        failure = seconds(failed) if failed else None
        issues = [issue_of(issue, False) for issue in need(answer, "rolling", "issues")]
        issues = [issue for issue in issues if failure is None or issue["time"] < failure]
        noise = answer["series"]["noise_m"]
        shown = " ".join(f'"{word}"' if " " in word else word for word in used).replace("{folder}/", "")
        read.append([title, f"`lacuna precursors {name} {shown} --rolling`" + (" of the sums" if used != words else ""), known])
        rows.append([title, len(issues), "-" if noise is None else f"{1e3 * noise:.2g} mm", *told(issues, failure)])
    verdict_tables.table("How each series is read", ["series", "command", "what is known"], read)
    verdict_tables.table("What was said", ["series", "readings", "noise", "level at the last", "accelerates", "failed after the last",
                         "first warning", "first alarm", "pooled median less the failure, at the last",
                         "entries into warning a year"], rows)
    named = {of[0] for of in SERIES.values()} | NO_MOTION
    others = [name for place in (CASES, folder) if os.path.isdir(place) for name in sorted(os.listdir(place))
              if name.endswith(".csv") and name not in named]
    print(f"No motion: {', '.join(sorted(NO_MOTION))}." + (f" Not read: {', '.join(others)}." if others else "") + "\n")


# ---- methods beside an independent program

def of_method(answer, method):
    return next(f for f in answer["forecasts"] if f["method"] == method)


def rms(f):
    if f["rms"] is None:
        return "-"
    return f"{1e3 * f['rms']:.2f} mm" if f["rms_unit"] == "m" else f"{f['rms'] / 8.64e6:.2g} day/cm"


def print_forecasts(answer, references=None, reference_rms=None):
    references, reference_rms = references or {}, reference_rms or {}
    print("| method | its own time | reference | difference | rms | reference | 50 % | 90 % or why not |\n"
          "|" + " --- |" * 8)
    for f in answer["forecasts"]:
        reference = references.get(f["method"])
        off = (f"{(f['tc_raw_s'] - seconds(reference)) / 86400:+.2f} day" if reference else "")
        known = reference_rms.get(f["method"])
        print(f"| {f['method']} | {date(f['tc_raw_s'])} | {date(seconds(reference)) if reference else ''} | "
              f"{off} | {rms(f)} | {f'{known} mm' if known else ''} | "
              f"{interval(f['interval50_s'])} | "
              f"{interval(f['interval90_s']) if f['issued'] else f['reason']} |")
    print()


def chambon(program, folder):
    data = os.path.join(folder, "chambon_2015_C15.csv")
    column = ("--displacement", "displacement_mm:mm")
    print("### Chambon 2015, target C15, issued at the last reading, fitted since 13 June\n")
    print_forecasts(program.ask(data, *column, "--since", "2015-06-13"), CHAMBON, CHAMBON_RMS)
    fitted = of_method(program.ask(data, *column, "--since", "2015-06-10"), "voight")["parameters"]
    print(f"Voight's exponent on the plane of ln v and ln dv/dt since 10 June: {fitted['alpha_plane']:.2f}, "
          f"reference {CHAMBON_ALPHA}; of the power law fitted to these displacements: {fitted['alpha']:.2f}\n")
    print("### Chambon, fitted since the onset of acceleration, here the first reading\n")
    print_forecasts(program.ask(data, *column), {"inv": "2015-07-03T13:00", "inv8": CHAMBON["inv8"]})
    print("### Chambon, eight-point inverse velocity as issued\n")
    print("| issued | failure | reference | difference |\n| --- | --- | --- | --- |")
    for day, reference in INV8.items():
        f = of_method(program.ask(data, *column, "--until", day + "T23:59"), "inv8")
        print(f"| {day} | {date(f['tc_raw_s'])} | {date(seconds(reference))} | "
              f"{(f['tc_raw_s'] - seconds(reference)) / 86400:+.2f} day |")
    print()


def century(program):
    data = os.path.join(CASES, "century_prism_31-2008.csv")
    column = ("--displacement", "displacement_mm:mm")
    print("### Century Mine, prism 31-2008, from day 80 (failure began 23 February 2014, driven by rain)\n")
    print_forecasts(program.ask(data, *column, "--since", "2014-02-08T12:54"),
                    {"log": "2014-02-20T00:00"})
    print("The same wall over all its readings, one block, without the mine's rain and with it:\n")
    print("| model | rms | misfit | failure | why not |\n| --- | --- | --- | --- | --- |")
    for name, case, settings in (("constant load", "century-undriven.yaml", ()), ("rain", "century.yaml", ())):
        path = os.path.join(CASES, "..", "fit", case)
        f = of_method(program.ask(data, "--case", path, "--set", "fit.steps=0", *settings), "case")
        print(f"| {name} | {rms(f)} | {f['misfit']:.3f} | {date(f['tc_raw_s'])} | {f['reason'] or ''} |")
    print()


def vajont(program):
    data = os.path.join(CASES, "vajont_anchors.csv")
    options = ("--velocity", "rate_cm_per_day:cm/day", "--since", "1963-05-01", "--onset", "1,2")
    for title, until in (("to 8 October: 20 cm/day", "1963-10-08"),
                         ("to 9 October: 80 cm/day", "1963-10-09")):
        print(f"### Vajont, rates that texts state, {title} (failed 9 October 1963, 21:39 UTC)\n")
        print_forecasts(program.ask(data, *options, "--until", until))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/lacuna")
    parser.add_argument("--data", default=os.path.join(CASES, "..", "..", "..", "shared", "data",
                                                       "monitoring"))
    arguments = parser.parse_args()
    program = Program(arguments.program)
    try:
        every_series(program, arguments.data)
    except Missing as missing:
        sys.exit(f"hindcasts.py: {missing}")
    if os.path.exists(os.path.join(arguments.data, "chambon_2015_C15.csv")):
        chambon(program, arguments.data)
    century(program)
    vajont(program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
