#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How early each precursor shows before an ensemble of rough joints fails, and how often it lies.

    precursor_ensemble.py [--joints 52] [--relieved 20] [--seed 1] [--threads 2]
                          [--picture PNG] [--program build/lacuna]
    precursor_ensemble.py --ensembles [--joints 4] ...

Each joint is pressed, creeps and fails cell by cell (the case of cases/rg/creep-to-failure.yaml, with fewer
cells and a surface of its own). `lacuna precursors` looks at it when a half, a fifth ... of its life is
left. Its control is the same joint from the state nearest to failing from which it does not (found by
bisection), asked at 24 of its records. The first joints are also relieved of a part of their shear load, to find the
last moment at which that still saves them. With --ensembles only that is done, of joints of other friction and size
too, and of such as a load that rises makes fail: that load then stops as the relief comes. Prints Markdown.
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
  size: "{size} m"
  levels: {levels}
  surface: {{self-affine: {{hurst: 0.8, rms_slope: 0.1, seed: {seed}}}}}
material: {{shear_modulus: "15 GPa", poisson: 0.25, shear_speed: "1 km/s"}}
load:
  normal: {{pressure: "66 MPa"}}{shear}
friction: {{aging: {{f0: {f0}, a: 0.010, b: {b}, dc: "{dc} um", v0: "1 um/s"}}}}
initial:
  slip_rate: "1 cm/week"
  state: {{ratio_to_steady: {ratio}}}
  spread: {{slip_rate: {{lognormal: {{sigma: 1, seed: {seed}}}}}}}
transfer: {{hierarchy: {{stiffness: elastic}}}}
time: {{end: "{end}"}}
rg: {{rule: fix, field: equal, beta: 0.6}}
analysis:
  rg: {{}}
  events: {{slip_rate: "0.1 mm/s"}}
output: {{every: {{steps: 3}}}}
"""
GIVEN = {"size": 0.5, "levels": 6, "f0": 0.6, "b": 0.015, "dc": 4, "ratio": 0.7, "end": "1 day", "shear": ""}
RAMP = '{{ramp: {{rate: "{rate} Pa/s"{end}}}}}'
RELIEF = '{{step: {{value: "{value} Pa", at: "{at!r} s"}}}}'
SMALL = {"size": 0.25, "levels": 5}
ENSEMBLES = (  # what differs, in words and in keys; ramp is in Pa/s
    ("0.25 m, 32 x 32 cells", SMALL),
    ("0.5 m, 64 x 64 cells", {}),
    ("0.25 m, load rises by 2 kPa/s from 1.3 of steady state", {**SMALL, "ratio": 1.3, "ramp": 2000}),
    ("0.25 m, b/a 1.1", {**SMALL, "b": 0.011}),
    ("0.25 m, b/a 2", {**SMALL, "b": 0.020}),
    ("0.25 m, f0 0.3", {**SMALL, "f0": 0.3}),
    ("0.25 m, dc 40 um", {**SMALL, "dc": 40}),
)
LEFT = (0.5, 0.2, 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5)
SHOWN = (0.5, 0.1, 0.03, 0.01, 1e-3, 1e-4, 1e-5)
RELIEFS = (0.01, 0.03, 0.1)
PRESSURE = 66e6  # Pa, of CASE
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
        out.write(CASE.format(**{**GIVEN, **words}))
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


def shear(ramp, end=None, relief=None):
    """The loads of a case: what rises, until `end` if given, and what is taken off then."""
    ends = "" if end is None else f', end: "{end!r} s"'
    loads = ([RAMP.format(rate=ramp, end=ends)] if ramp else []) + ([RELIEF.format(value=-relief, at=end)] if relief else [])
    return f"\n  shear: [{', '.join(loads)}]" if loads else ""


def last_rescue(program, folder, seed, failure, relief, ramp=0, **given):
    """Part of the life left at the last moment at which a relief [Pa] saves the joint, to 1/28 of a decade."""
    low, high = LAST, 0.0  # log10: fails, is saved
    for _ in range(8):
        middle = 0.5 * (low + high)
        loads = shear(ramp, failure * (1 - 10 ** middle), relief)
        _, result = run(program, folder, f"{seed}-relieved", **{**given, "seed": seed, "shear": loads})
        saved = result is not None and not result["failed"]
        low, high = (low, middle) if saved else (middle, high)
    return 10 ** high


def fail(program, folder, seed, ramp=0, **given):
    """A joint's file, its time of failure, what is left of its life at each record, and what is told of its cells and its
    load; None where it does not fail."""
    path, result = run(program, folder, str(seed), **{**given, "seed": seed, "shear": shear(ramp)})
    if result is None or not result["failed"]:
        return None
    failure = result["failure_time_s"]
    with netCDF4.Dataset(path) as data:
        time, slipping = (data[name][:].filled(numpy.nan) for name in ("time", "slip_fraction"))
        critical = float(numpy.ma.filled(data["critical_fraction"][...], numpy.nan))
        stress = float(data["shear_force"][0]) / given.get("size", GIVEN["size"]) ** 2
    left = 1 - time / failure
    reached = numpy.flatnonzero(slipping >= critical)
    return path, failure, left, slipping, {"failure": failure, "critical": critical, "stress": stress,
                                           "reached": left[reached[0]] if len(reached) else None}


def relieve(program, folder, seed, joint, reliefs=RELIEFS, **given):
    """The last moments at which each relief saves a joint, and the cells that slipped then."""
    _, failure, left, slipping, told = joint
    last = [last_rescue(program, folder, seed, failure, relief * told["stress"], **given) for relief in reliefs]
    return {"rescue": last, "rescue slipping": [float(numpy.interp(-part, -left, slipping)) for part in last]}


def study_ensemble(job):
    """Of one joint of another ensemble when a relief still saves it; None where it does not fail."""
    program, folder, seed, which = job
    given = ENSEMBLES[which][1]
    folder = tempfile.mkdtemp(dir=folder)
    joint = fail(program, folder, seed, **given)
    return None if joint is None else {**joint[-1], **relieve(program, folder, seed, joint, RELIEFS[1:], **given), "which": which}


def study(job):
    """Of one joint all that is told of it, or None where its run broke off."""
    program, folder, seed, relieved = job
    joint = fail(program, folder, seed)
    if joint is None:
        return None
    path, failure, left, slipping, told = joint
    out = {**told, "before": [alarms(ask(program, path, "--until", f"{(1 - part) * failure!r} s"), failure)
                      for part in LEFT],
           "slipping": numpy.interp(-GRID, -left, slipping)}
    control, calm, out["ratio"] = find_control(program, folder, seed)
    answer = ask(program, control, "--rolling", "--issues", "24")
    out["calm"] = [alarms({**answer, **issue}, None) for issue in answer["rolling"]["issues"]]
    out["calm events"] = calm["events"]
    with netCDF4.Dataset(control) as data:
        out["most"] = numpy.nanmax(data["slip_fraction"][:].filled(numpy.nan))
    out.update(relieve(program, folder, seed, joint) if relieved else {"rescue": []})
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


def print_ensembles(rows):
    names = [f"{100 * relief:g} %" for relief in RELIEFS[1:]]
    print("| joints | Δ/(b - a) | time to failure, s | came to C, with life left | " + " | ".join(f"last that {n} saves: life left" for n in names)
          + " | slipping then | saved beyond C |\n|" + " --- |" * (len(names) + 6))
    for which, (name, given) in enumerate(ENSEMBLES):
        of = [row for row in rows if row["which"] == which]
        if not of:
            print(f"| {name} | none fails |" + " - |" * (len(names) + 4))
            continue
        came = [row["reached"] for row in of if row["reached"] is not None]
        saved = [sum(row["reached"] is not None and row["reached"] > row["rescue"][k] for row in of) for k in range(len(names))]
        last = [middle([100 * row["rescue"][k] for row in of]) + " %" for k in range(len(names))]
        most = [f"{numpy.median([row['rescue slipping'][k] for row in of]):.2g}" for k in range(len(names))]
        weaker = PRESSURE * (given.get("b", GIVEN["b"]) - 0.010)
        steps = [f"{relief * numpy.mean([row['stress'] for row in of]) / weaker:.1f}" for relief in RELIEFS[1:]]
        print(f"| {name} | {', '.join(steps)} | {middle([row['failure'] for row in of], '{:.0f}')} | {len(came)} of {len(of)}, {middle([100 * c for c in came])} % | "
              + " | ".join(last) + f" | {', '.join(most)} | {', '.join(map(str, saved))} |")


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
    parser.add_argument("--ensembles", action="store_true")
    parser.add_argument("--joints", type=int)
    parser.add_argument("--relieved", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--picture")
    parser.add_argument("--program", default="build/lacuna")
    arguments = parser.parse_args()
    program, wanted = os.path.abspath(arguments.program), arguments.joints or (4 if arguments.ensembles else 52)
    with tempfile.TemporaryDirectory(prefix="lacuna-ensemble-") as folder:
        jobs = [(program, folder, arguments.seed + i, which if arguments.ensembles else i < arguments.relieved)
                for which in (range(len(ENSEMBLES)) if arguments.ensembles else [0]) for i in range(wanted)]
        with concurrent.futures.ProcessPoolExecutor(arguments.threads) as pool:
            done = pool.map(study_ensemble if arguments.ensembles else study, jobs)
            rows = [row for row in done if row is not None]
    if arguments.ensembles:
        print_ensembles(rows)
        return 0
    print(f"{len(rows)} of {wanted} joints failed (the others' runs broke off or went on).\n")
    print_alarms(rows)
    print_critical(rows)
    print_rescues(rows)
    if arguments.picture:
        draw(rows, arguments.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
