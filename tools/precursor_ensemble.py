#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How early each precursor shows before an ensemble of rough joints fails, and how often it lies.

    precursor_ensemble.py [--joints 50] [--seed 1] [--threads 2] [--program build/lacuna]

Each joint is pressed, creeps and fails cell by cell (the case of cases/rg/creep-to-failure.yaml, with fewer
cells and a surface of its own). `lacuna precursors` looks at it when a half, a fifth ... of its life is left, and at
a control, the same joint from a state at which it relaxes, at the same times. Prints Markdown.
"""

import argparse
import concurrent.futures
import json
import math
import os
import subprocess
import sys
import tempfile

import netCDF4
import numpy

CASE = """lacuna: 1
interface:
  size: "0.5 m"
  levels: 6
  surface: {{self-affine: {{hurst: 0.8, rms_slope: 0.1, seed: {seed}}}}}
material: {{shear_modulus: "15 GPa", poisson: 0.25, shear_speed: "1 km/s"}}
load: {{normal: {{pressure: "66 MPa"}}}}
friction: {{aging: {{f0: 0.6, a: 0.010, b: 0.015, dc: "4 um", v0: "1 um/s"}}}}
initial:
  slip_rate: "1 cm/week"
  state: {{ratio_to_steady: {ratio}}}
  spread: {{slip_rate: {{lognormal: {{sigma: 1, seed: {seed}}}}}}}
transfer: {{hierarchy: {{stiffness: elastic}}}}
time: {{end: "{end}"}}
analysis:
  rg: {{rule: fix, field: equal, beta: 0.6}}
  events: {{slip_rate: "0.1 mm/s"}}
output: {{every: {{steps: 3}}}}
"""
LEFT = (0.5, 0.2, 0.1, 0.03, 0.01, 1e-3, 1e-4)
TESTS = ("slip fraction >= C", "event rate rises", "variance", "autocorrelation", "log-periodicity",
         "a forecast within 20 %")


def rises(values, points):
    """More events in the last half of the time than a constant rate gives in one of twenty."""
    late = round(values["share_of_the_last_half"] * points)
    tail = sum(math.comb(points, k) for k in range(late, points + 1)) / 2 ** points
    return tail <= 0.05


def alarms(answer, failure):
    """{test: 1, 0, or None where it has nothing to say}"""
    found = {i["indicator"]: i for i in answer["indicators"]}
    fraction, rate = found["slip_fraction"]["values"], found["event_rate"]
    slowing, waves = found["slowing"]["values"], found["log_periodicity"]["values"]
    critical = fraction.get("critical_fraction")
    close = [abs(f["tc_s"] - failure) <= 0.2 * (failure - answer["issue_time_s"])
             for f in answer["forecasts"][:-1] if f["issued"]] if failure else []
    said = any(f["issued"] for f in answer["forecasts"][:-1])
    return {TESTS[0]: None if critical is None else fraction["slip_fraction"] >= critical,
            TESTS[1]: not rate["reason"] and rises(rate["values"], rate["points"]),
            TESTS[2]: slowing["variance_p"] <= 0.05 if slowing else None,
            TESTS[3]: slowing["autocorrelation_p"] <= 0.05 if slowing else None,
            TESTS[4]: waves["p"] <= 0.05 if waves else False,
            TESTS[5]: any(close) if failure else said}


def run(program, folder, seed, ratio, end):
    case, output = (os.path.join(folder, f"{seed}-{ratio}.{kind}") for kind in ("yaml", "nc"))
    with open(case, "w", encoding="utf-8") as out:
        out.write(CASE.format(seed=seed, ratio=ratio, end=end))
    done = subprocess.run([program, "run", case, "-o", output, "--json", "--no-progress"],
                          capture_output=True, text=True, check=False)
    return output, json.loads(done.stdout) if done.returncode == 0 else {"failed": False}


def ask(program, path, until):
    done = subprocess.run([program, "precursors", path, "--json", "--until", f"{until} s"],
                          capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def study(job):
    """Of one joint: alarms at each part of its life left, those of its control, when C was reached."""
    program, folder, seed = job
    path, result = run(program, folder, seed, 0.7, "1 day")
    if not result["failed"]:
        return None
    failure = result["failure_time_s"]
    control, calm = run(program, folder, seed, 1.5, f"{failure} s")
    with netCDF4.Dataset(path) as data:
        time, criticality = data["time"][:].filled(), data["criticality"][:].filled(numpy.nan)
    with netCDF4.Dataset(control) as data:
        most = numpy.nanmax(data["slip_fraction"][:].filled(numpy.nan))
    at = numpy.flatnonzero(criticality >= 1)
    reached = 1 - time[at[0]] / failure if len(at) else None
    before = [alarms(ask(program, path, (1 - left) * failure), failure) for left in LEFT]
    calm_alarms = [alarms(ask(program, control, (1 - left) * failure), None) for left in LEFT]
    return before, calm_alarms, reached, calm["failed"], most


def share(rows, test, k, which):
    said = [row[which][k][test] for row in rows if row[which][k][test] is not None]
    return f"{100 * sum(said) / len(said):.0f} %" if said else "-"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--joints", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--program", default="build/lacuna")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="lacuna-ensemble-") as folder:
        jobs = [(os.path.abspath(arguments.program), folder, arguments.seed + i)
                for i in range(arguments.joints)]
        with concurrent.futures.ProcessPoolExecutor(arguments.threads) as pool:
            rows = [row for row in pool.map(study, jobs) if row is not None]
    print(f"{len(rows)} of {arguments.joints} joints failed (the others' runs broke off or went on); of their controls "
          f"{sum(row[3] for row in rows)} did.\n")
    print("| life left | " + " | ".join(f"{100 * left:g} %" for left in LEFT) + " | in controls |")
    print("|" + " --- |" * (len(LEFT) + 2))
    for test in TESTS:
        lies = [share(rows, test, k, 1) for k in range(len(LEFT))]
        worst = max((int(lie[:-2]) for lie in lies if lie != "-"), default=None)
        print(f"| {test} | " + " | ".join(share(rows, test, k, 0) for k in range(len(LEFT)))
              + f" | {'-' if worst is None else f'at most {worst} %'} |")
    reached = sorted(100 * row[2] for row in rows if row[2] is not None)
    if reached:
        print(f"\nThe slipping fraction came to the fixed point C in {len(reached)} joints, with "
              f"{numpy.median(reached):.2g} % of the life left (median; {reached[0]:.2g} to "
              f"{reached[-1]:.2g} %). The largest slipping fraction of any control: "
              f"{max(row[4] for row in rows):.2f}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
