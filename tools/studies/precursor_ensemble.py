#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How early each precursor shows before an ensemble of rough joints fails, and how often it lies.

    precursor_ensemble.py [--joints 52] [--relieved 20] [--seed 1] [--threads 2]
                          [--picture PNG] [--program build/lacuna]

Each joint is pressed, creeps and fails cell by cell (the case of cases/rg/creep-to-failure.yaml, with fewer
cells and a surface of its own). `lacuna precursors` looks at it when a half, a fifth ... of its life is
left. Its control is the same joint from the state nearest to failing from which it does not (found by
bisection), asked at 24 of its records. The first joints are also relieved of a part of their shear load, to find the
last moment at which that still saves them. Prints Markdown.
"""

import argparse
import concurrent.futures
import json
import math
import os
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import netCDF4  # noqa: E402
import numpy  # noqa: E402

CASE = """lacuna: 1
interface:
  size: "0.5 m"
  levels: 6
  surface: {{self-affine: {{hurst: 0.8, rms_slope: 0.1, seed: {seed}}}}}
material: {{shear_modulus: "15 GPa", poisson: 0.25, shear_speed: "1 km/s"}}
load:
  normal: {{pressure: "66 MPa"}}{relief}
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
RELIEF = '\n  shear: [{{step: {{value: "{value} Pa", at: "{at!r} s"}}}}]'
LEFT = (0.5, 0.2, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5)
SHOWN = (0.5, 0.1, 0.03, 0.01, 1e-3, 1e-4, 1e-5)
RELIEFS = (0.01, 0.03, 0.1)
LAST = -9  # log10 of the life left when the last relief is tried
GRID = 10 ** numpy.linspace(-0.3, -8, 78)  # life left, of the picture's curves
# what alarms: an indicator, and its p that is then at most 0.05
P = {"slip fraction rises": ("slip_fraction", "rise_p"),
     "correlation length rises": ("correlation_length", "rise_p"),
     "event rate rises": ("event_rate", "rise_p"),
     "moment release rises": ("moment", "rise_p"),
     "b-value falls": ("b_value", "fall_p"),
     "variance": ("slowing", "variance_p"),
     "variance, random phases": ("slowing", "variance_phase_p"),
     "autocorrelation": ("slowing", "autocorrelation_p"),
     "autocorrelation, random phases": ("slowing", "autocorrelation_phase_p"),
     "log-periodicity": ("log_periodicity", "p")}
CRITICAL, FORECAST = "slip fraction >= C", "a forecast within 20 %"
TESTS = (CRITICAL, *P, FORECAST)


def alarms(answer, failure):
    """{test: whether it alarms}; an indicator with nothing to say does not."""
    found = {i["indicator"]: i["values"] for i in answer["indicators"]}
    said = [f for f in answer["forecasts"][:-1] if f["issued"]]
    now = answer["issue_time_s"]
    if failure is not None:
        said = [f for f in said if abs(f["tc_s"] - failure) <= 0.2 * (failure - now)]
    fraction = found["slip_fraction"]
    out = {test: found[name].get(key, 1) <= 0.05 for test, (name, key) in P.items()}
    out[CRITICAL] = fraction.get("distance", 1) <= 0
    out[FORECAST] = bool(said)
    return out


def run(program, folder, name, **words):
    """The file of a run, and its result."""
    case, output = (os.path.join(folder, f"{name}.{kind}") for kind in ("yaml", "nc"))
    with open(case, "w", encoding="utf-8") as out:
        out.write(CASE.format(**{"relief": "", "end": "1 day", **words}))
    done = subprocess.run([program, "run", case, "-o", output, "--force", "--json", "--no-progress",
                           "--threads", "1"], capture_output=True, text=True, check=False)
    return output, json.loads(done.stdout) if done.returncode == 0 else None


def ask(program, path, *words):
    done = subprocess.run([program, "precursors", path, "--json", "-q", *words], capture_output=True,
                          text=True, check=True)
    return json.loads(done.stdout)


def find_control(program, folder, seed):
    """The run with the least ratio to steady state, to 1/64 of 0.7 to 1.2, that does not fail."""
    low, high = 0.7, 1.2
    for _ in range(6):
        middle = 0.5 * (low + high)
        _, result = run(program, folder, f"{seed}-control", seed=seed, ratio=middle)
        fails = result is None or result["failed"]
        low, high = (middle, high) if fails else (low, middle)
    return *run(program, folder, f"{seed}-control", seed=seed, ratio=high), high


def last_rescue(program, folder, seed, failure, relief, force):
    """Part of the life left at the last moment at which a relief saves the joint, to 1/28 of a decade."""
    low, high = LAST, 0.0  # log10: fails, is saved
    for _ in range(8):
        middle = 0.5 * (low + high)
        step = RELIEF.format(value=-relief * force, at=failure * (1 - 10 ** middle))
        _, result = run(program, folder, f"{seed}-relieved", seed=seed, ratio=0.7, relief=step)
        saved = result is not None and not result["failed"]
        low, high = (low, middle) if saved else (middle, high)
    return 10 ** high


def study(job):
    """Of one joint all that is told of it, or None where its run broke off."""
    program, folder, seed, relieved = job
    path, result = run(program, folder, str(seed), seed=seed, ratio=0.7)
    if result is None or not result["failed"]:
        return None
    failure = result["failure_time_s"]
    with netCDF4.Dataset(path) as data:
        time, slipping = (data[name][:].filled(numpy.nan) for name in ("time", "slip_fraction"))
        critical = float(numpy.ma.filled(data["critical_fraction"][...], numpy.nan))
        force = float(data["shear_force"][0]) / 0.25
    left = 1 - time / failure
    reached = numpy.flatnonzero(slipping >= critical)
    out = {"before": [alarms(ask(program, path, "--until", f"{(1 - part) * failure!r} s"), failure)
                      for part in LEFT],
           "critical": critical, "reached": left[reached[0]] if len(reached) else None,
           "slipping": numpy.interp(-GRID, -left, slipping)}
    control, calm, out["ratio"] = find_control(program, folder, seed)
    answer = ask(program, control, "--rolling", "--issues", "24")
    out["calm"] = [alarms({**answer, **issue}, None) for issue in answer["rolling"]["issues"]]
    out["calm events"] = calm["events"]
    with netCDF4.Dataset(control) as data:
        out["most"] = numpy.nanmax(data["slip_fraction"][:].filled(numpy.nan))
    out["rescue"] = [last_rescue(program, folder, seed, failure, relief, force)
                     for relief in RELIEFS] if relieved else []
    out["rescue slipping"] = [float(numpy.interp(-part, -left, slipping)) for part in out["rescue"]]
    os.remove(path)
    return out


def share(values):
    values = list(values)
    return 100 * sum(values) / len(values)


def middle(values, form="{:.2g}"):
    values = sorted(values)
    if not values:
        return "-"
    return (form + " (" + form + " to " + form + ")").format(numpy.median(values), values[0], values[-1])


def print_alarms(rows):
    print("| life left | " + " | ".join(f"{100 * left:g} %" for left in SHOWN)
          + " | controls: of all times | of all controls |")
    print("|" + " --- |" * (len(SHOWN) + 3))
    for test in TESTS:
        shown = [share(row["before"][LEFT.index(left)][test] for row in rows) for left in SHOWN]
        lies = share(calm[test] for row in rows for calm in row["calm"])
        ever = share(any(calm[test] for calm in row["calm"]) for row in rows)
        print(f"| {test} | " + " | ".join(f"{part:.0f} %" for part in shown) + f" | {lies:.1f} % | {ever:.0f} % |")


def print_critical(rows):
    reached = [row["reached"] for row in rows if row["reached"] is not None]
    known = [row for row in rows if not math.isnan(row["critical"])]
    print(f"\nC is {middle([row['critical'] for row in known])} in {len(known)} joints; {len(reached)} came to it, with "
          f"{middle([100 * r for r in reached])} % of the life left (median, range). "
          f"Controls: ratio to steady state {middle([row['ratio'] for row in rows])}, "
          f"{sum(row['calm events'] for row in rows)} events in {sum(row['calm events'] > 0 for row in rows)} of them, "
          f"the largest slipping fraction {max(row['most'] for row in rows):.3f}.")


def print_rescues(rows):
    relieved = [row for row in rows if row["rescue"]]
    if not relieved:
        return
    print(f"\n| relief, of {len(relieved)} joints | life left at the last that saves | slipping fraction then | "
          "joints that had come to C |")
    print("| --- | --- | --- | --- |")
    for k, relief in enumerate(RELIEFS):
        past = sum(row["reached"] is not None and row["reached"] > row["rescue"][k] for row in relieved)
        print(f"| {100 * relief:g} % of the shear load | {middle([100 * row['rescue'][k] for row in relieved])} % | "
              f"{middle([row['rescue slipping'][k] for row in relieved])} | {past} |")
    print(f"\n{100 * 10 ** LAST:.2g} % is the last that was tried.")


def draw(rows, path):
    figure, axes = plt.subplots(2, 1, figsize=(8, 8.5), sharex=True, constrained_layout=True)
    left = 100 * numpy.array(LEFT)
    styles = ["-", "--", ":"]
    for k, test in enumerate(TESTS):
        shown = [share(row["before"][i][test] for row in rows) for i in range(len(LEFT))]
        axes[0].plot(left, shown, styles[k // 5], marker="o", markersize=3, linewidth=5 - 0.35 * k, label=test)
    axes[0].set_ylabel("joints in which it shows (%)")
    axes[0].legend(fontsize=7, ncol=2)
    axes[1].fill_between(100 * GRID, *numpy.percentile([row["slipping"] for row in rows], [5, 95], axis=0), color="0.85",
                         label="slipping fraction: 90 % of joints")
    axes[1].plot(100 * GRID, numpy.median([row["slipping"] for row in rows], axis=0), "k-", label="median")
    axes[1].axhline(numpy.nanmedian([row["critical"] for row in rows]), color="k", linestyle="--", linewidth=0.8,
                    label="fixed point C")
    axes[1].plot([100 * row["reached"] for row in rows if row["reached"] is not None],
                 [row["critical"] for row in rows if row["reached"] is not None], "kx", label="C is reached")
    for k, relief in enumerate(RELIEFS):
        axes[1].plot([100 * row["rescue"][k] for row in rows if row["rescue"]],
                     [row["rescue slipping"][k] for row in rows if row["rescue"]], "o", color=f"C{k}",
                     markersize=4, label=f"last at which {100 * relief:g} % less load saves")
    axes[1].axvline(100 * 10 ** LAST, color="k", linestyle=":", linewidth=0.8, label="last that is tried")
    axes[1].set(xlabel="part of the life left (%)", ylabel="slipping fraction", xscale="log")
    axes[1].invert_xaxis()
    axes[1].legend(fontsize=7, loc="upper left")
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--joints", type=int, default=52)
    parser.add_argument("--relieved", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--picture")
    parser.add_argument("--program", default="build/lacuna")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="lacuna-ensemble-") as folder:
        jobs = [(os.path.abspath(arguments.program), folder, arguments.seed + i, i < arguments.relieved)
                for i in range(arguments.joints)]
        with concurrent.futures.ProcessPoolExecutor(arguments.threads) as pool:
            rows = [row for row in pool.map(study, jobs) if row is not None]
    print(f"{len(rows)} of {arguments.joints} joints failed (the others' runs broke off or went on).\n")
    print_alarms(rows)
    print_critical(rows)
    print_rescues(rows)
    if arguments.picture:
        draw(rows, arguments.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
