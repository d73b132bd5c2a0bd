#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Synthetic creep series whose parameters are known, fitted by `lacuna fit`: are its intervals right?

    recovery.py [--program lacuna] [--fits 200] [--jobs 2] [--seed 1] [--model free|fixed]

Parameters are drawn from the prior of the fit, the block is solved here (closed forms, not Lacuna), 40
readings in 40 days get normal errors, and the fit is asked for its intervals; starts that fail
within the 40 days are drawn again, as the fit gives them no likelihood. Prints a table of how many
truths lie within the 50 % and 90 % intervals, for docs/theory/fitting.md. Exits 1 where something
that readings can tell (IDENTIFIABLE) is covered by more than --within points too many or too few.
"""
import argparse
import concurrent.futures
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy

DAY = 86400.0
IDENTIFIABLE = ("rate", "sigma", "shape", "tc")  # dc and x trade off
DAYS, END, FAST = 40, 20000, 1.0  # days read, days run, m/s that is failure
CASE = """\
lacuna: 1
title: synthetic
load: {{normal: {{pressure: "1 MPa"}}}}
friction: {{aging: {{f0: 0.6, a: 0.010, b: {b}, dc: "0.15 m", v0: "1 um/s"}}}}
initial: {{slip_rate: "3 mm/day", state: {{ratio_to_steady: 0.6}}}}
time: {{end: "{end} day", failure: {{mean_slip_rate: "{fast} m/s"}}}}
fit:
  parameters:
    friction.aging.dc: {{range: ["0.05 m", "0.5 m"]}}
    initial.slip_rate: {{range: ["1 mm/day", "10 mm/day"]}}
    initial.state.ratio_to_steady: {{range: [0.3, 0.95], prior: {{uniform: {{}}}}}}
{more}  time: t
  displacement: "d:mm"
  walkers: 40
  burn: {burn}
  steps: {steps}
  starts: 24
"""
FREE = "    friction.aging.b: {prior: {normal: {mean: 0.0135, sigma: 0.0005}}, range: [0.0115, 0.016]}\n"


def draw(rng, free):
    """Parameters from the prior."""
    b = 0.0135
    while free:
        b = rng.normal(0.0135, 0.0005)
        if 0.0115 <= b <= 0.016:
            break
    return {"dc": math.exp(rng.uniform(math.log(0.05), math.log(0.5))),
            "rate": math.exp(rng.uniform(math.log(1e-3 / DAY), math.log(1e-2 / DAY))),
            "x": rng.uniform(0.3, 0.95), "m": b / 0.010, "b": b}


def left(x, m):
    """Time to failure from the state x over the steady state's: the integral from 0 to x of
    y^(m-1)/(1 - y^(m-1)) dy, as a series of powers (O3 of docs/theory/creep.md)."""
    x = numpy.atleast_1d(x)
    terms = int(40.0 / -((m - 1.0) * math.log(x.max()))) + 2
    power = (m - 1.0) * numpy.arange(1, terms) + 1.0
    return (numpy.exp(numpy.outer(numpy.log(x), power)) / power).sum(axis=1)


def solve(p, times):
    """Slip at the times [m], None where it fails before the last; the time of failure [s]. Aging
    law, load held: the time gives x by bisection, x gives the slip (O1)."""
    m, steady = p["m"], p["rate"] * p["x"] ** p["m"]
    scale = p["dc"] / steady
    whole = left(p["x"], m)[0]
    if whole * scale <= times[-1]:
        return None, whole * scale
    low, high = numpy.full(len(times), -60.0), numpy.full(len(times), math.log(p["x"]))
    for _ in range(60):
        middle = 0.5 * (low + high)
        early = left(numpy.exp(middle), m) > whole - times / scale
        low, high = numpy.where(early, low, middle), numpy.where(early, middle, high)
    slip = p["dc"] / (m - 1.0) * numpy.log(numpy.expm1((1.0 - m) * low) /
                                           math.expm1((1.0 - m) * math.log(p["x"])))
    return slip, whole * scale


def make(seed, free):
    """A truth and its readings."""
    rng = numpy.random.default_rng(seed)
    times = (numpy.arange(DAYS + 1) + rng.uniform(-0.2, 0.2, DAYS + 1)) * DAY
    times[0], times[-1] = 0.0, DAYS * DAY
    while True:
        truth = draw(rng, free)
        slip, truth["tc"] = solve(truth, times)
        if slip is not None:
            break
    sigma = math.exp(rng.uniform(math.log(0.5e-3), math.log(2e-3)))
    truth["shape"] = truth["m"] / truth["dc"] * (1.0 - truth["x"] ** (truth["m"] - 1.0))
    truth["sigma"] = sigma
    return truth, times, slip + rng.normal(0.0, sigma, len(times)) + rng.uniform(-0.1, 0.1)


def fit(job):
    """The truth and what the program says."""
    program, seed, free, steps = job
    truth, times, readings = make(seed, free)
    with tempfile.TemporaryDirectory() as folder:
        case, series = os.path.join(folder, "case.yaml"), os.path.join(folder, "series.csv")
        with open(case, "w", encoding="ascii") as file:
            file.write(CASE.format(b=0.0135, end=END, fast=FAST, more=FREE if free else "",
                                   steps=steps, burn=steps // 2))
        with open(series, "w", encoding="ascii") as file:
            file.write("t,d\n")
            for t, d in zip(times, readings):
                file.write(f"{t:.6f},{1e3 * d:.9f}\n")
        done = subprocess.run([program, "fit", case, series, "--json", "-o",
                               os.path.join(folder, "out.nc")], capture_output=True, text=True,
                              check=False)
    # A sampler that has not converged ends with status 1 after it has written what it has.
    if not done.stdout.lstrip().startswith("{") or "parameters" not in done.stdout:
        return truth, None, done.stderr.strip()
    return truth, json.loads(done.stdout), ""


def inside(interval, value):
    low, high = (math.inf if end is None else end for end in interval)
    return low <= value <= high


def judge(truth, got):
    """{name: (within 50 %, within 90 %, error of the median or None)}"""
    by = {p["key"]: p for p in got["parameters"]}
    names = {"dc": "friction.aging.dc", "rate": "initial.slip_rate",
             "x": "initial.state.ratio_to_steady", "b": "friction.aging.b",
             "sigma": "error.displacement"}
    out = {}
    for name, key in names.items():
        if key in by:
            p = by[key]
            out[name] = (inside(p["interval50"], truth[name]), inside(p["interval90"], truth[name]),
                         p["median"] / truth[name] - 1.0)
    shape = got["shape"]
    out["shape"] = (inside(shape["interval50_1_m"], truth["shape"]),
                    inside(shape["interval90_1_m"], truth["shape"]),
                    shape["median_1_m"] / truth["shape"] - 1.0)
    if math.isfinite(truth["tc"]):
        tc = got["tc_s"]
        out["tc"] = (inside(got["interval50_s"], truth["tc"]),
                     inside(got["interval90_s"], truth["tc"]),
                     None if tc is None else tc / truth["tc"] - 1.0)
    return out


def table(rows, rhat, failed):
    """What was found so far."""
    print(f"{len(rhat)} fits, {len(failed)} without result; worst R-hat of a fit: median "
          f"{numpy.median(rhat):.3f}, 95 % below {numpy.quantile(rhat, 0.95):.3f}, "
          f"{sum(r >= 1.05 for r in rhat)} not converged")
    for why in sorted(set(failed)):
        print("  " + why)
    print("| quantity | within 50 % | within 90 % | median size of the error |")
    print("| --- | --- | --- | --- |")
    for name, found in rows.items():
        half, most = (100.0 * numpy.mean([f[i] for f in found]) for i in (0, 1))
        errors = [abs(f[2]) for f in found if f[2] is not None]
        print(f"| {name} | {half:.1f} % | {most:.1f} % | {100.0 * numpy.median(errors):.2g} % |",
              flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/lacuna")
    parser.add_argument("--fits", type=int, default=200)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--steps", type=int, default=300)
    parser.add_argument("--within", type=float, default=5.0)
    parser.add_argument("--model", choices=("fixed", "free"), default="fixed",
                        help="b known, or estimated too")
    parser.add_argument("--every", type=int, default=50, help="fits between tables")
    args = parser.parse_args()
    jobs = [(args.program, 1000003 * args.seed + i, args.model == "free", args.steps)
            for i in range(args.fits)]
    rows, rhat, failed = {}, [], []
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        for truth, got, why in pool.map(fit, jobs):
            if got is None:
                failed.append(why)
                continue
            rhat.append(max(p["rhat"] for p in got["parameters"]))
            for name, row in judge(truth, got).items():
                rows.setdefault(name, []).append(row)
            if len(rhat) % args.every == 0 or len(rhat) == args.fits:
                table(rows, rhat, failed)
    off = [abs(100.0 * numpy.mean([f[i] for f in rows[name]]) - nominal)
           for name in IDENTIFIABLE if name in rows for i, nominal in ((0, 50.0), (1, 90.0))]
    sys.exit(0 if rows and max(off) <= args.within else 1)


if __name__ == "__main__":
    main()
