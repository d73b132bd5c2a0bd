#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/theory/forecasting.md: what every method says of slopes that failed, or did not.

    hindcasts.py [--program build/lacuna] [--data FOLDER]

Prints Markdown: the Century Mine wall and Vajont from cases/data; from FOLDER, whose data may not be
shipped, the Chambon slide (Desrues et al. 2019) and two slopes that did not fail, Baijiabao and
Lamosano, where the files are there. Beside each method stands what an independent program gave for
the same window and estimator, and the difference.
"""

import argparse
import datetime
import json
import os
import subprocess
import sys

CASES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "cases", "data")

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


def of_method(answer, method):
    return next(f for f in answer["forecasts"] if f["method"] == method)


def rms(f):
    if f["rms"] is None:
        return "-"
    return f"{1e3 * f['rms']:.2f} mm" if f["rms_unit"] == "m" else f"{f['rms'] / 8.64e6:.2g} day/cm"


def print_forecasts(answer, references=None, reference_rms=None):
    references, reference_rms = references or {}, reference_rms or {}
    print("| method | failure | reference | difference | rms | reference | 50 % | 90 % or why not |\n"
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


def controls(program, folder):
    print("### Slopes that did not fail: forecasts issued and alarms over all readings\n")
    print("| slope | method | issued | false alarms |\n| --- | --- | --- | --- |")
    for name, column in (("baijiabao_daily_2017-10_2018-08", "displacement_mm:mm"),
                         ("lamosano_p5_rain_2015_2020", "p5:mm")):
        data = os.path.join(folder, name + ".csv")
        if not os.path.exists(data):
            continue
        answer = program.ask(data, "--displacement", column, "--rolling", "--issues", "1000",
                             "--failed-at", "never")
        horizon, at_once = answer["rolling"]["horizon_s"], 0
        for issue in answer["rolling"]["issues"]:
            alarms = [f for f in issue["forecasts"] if f["issued"]
                      and f["interval50_s"][1] <= issue["issue_time_s"] + horizon]
            at_once = max(at_once, len(alarms))
        print(f"| {name.split('_', maxsplit=1)[0]} | most methods that alarm at once |  | {at_once} |")
        for s in answer["rolling"]["skill"]:
            print(f"| {name.split('_', maxsplit=1)[0]} | {s['method']} | {s['issued']}/{s['asked']} | "
                  f"{s['false_alarms']} |")
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/lacuna")
    parser.add_argument("--data", default=os.path.join(CASES, "..", "..", "..", "shared", "data",
                                                       "monitoring"))
    arguments = parser.parse_args()
    program = Program(arguments.program)
    if os.path.exists(os.path.join(arguments.data, "chambon_2015_C15.csv")):
        chambon(program, arguments.data)
    century(program)
    vajont(program)
    controls(program, arguments.data)
    return 0


if __name__ == "__main__":
    sys.exit(main())
