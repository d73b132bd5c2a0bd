#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How good forecasts are on simulated failures, of which the time is known.

    forecast_coverage.py [--runs 500] [--trees 100] [--seed 1] [--calibrate] [--program build/lacuna]

Simulates failures, cuts each at a random time, adds noise and gaps, and has `lacuna precursors`
forecast from what is left: blocks of rate-and-state friction in closed form (docs/theory/creep.md), and
joints of many cells run by `lacuna run`. Prints a table, in Markdown, of coverage and errors. With
--calibrate it prints the intervals' quantiles instead, as they stand in src/forecast; the table
must then be made with another seed. The same seed gives the same series.
"""

import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile

import netCDF4
import numpy

TREE = """lacuna: 1
interface:
  size: "{size} m"
  levels: {levels}
  domain: {{cascade: {{dimension: {dimension}, seed: {seed}}}}}
material: {{shear_modulus: "20 GPa", poisson: 0.25, shear_speed: "3 km/s", density: "2700 kg/m3"}}
load:
  normal: {{pressure: "3 MPa"}}
friction: {{aging: {{f0: 0.6, a: 0.010, b: {b}, dc: "{dc} m", v0: "1 um/s"}}}}
initial:
  slip_rate: "1 mm/day"
  state: {{ratio_to_steady: {ratio}}}
  spread: {{slip_rate: {{lognormal: {{sigma: {sigma}, seed: {seed}}}}}}}
transfer: {{hierarchy: {{stiffness: elastic}}}}
time: {{end: "100 year", failure: {{mean_slip_rate: "1 cm/s"}}}}
solver: {{rtol: 1e-6}}
"""


def block(rng):
    """Times before failure (falling) and displacements of one block: O1 and O3 in s."""
    m, x = rng.uniform(1.1, 2.5), rng.uniform(0.05, 0.97)
    y = x ** (m - 1)
    alpha = m / (m - 1)
    s = numpy.concatenate([numpy.linspace(numpy.log((1 - y) / y), 40, 40001)])
    rate = numpy.exp(-alpha * numpy.logaddexp(0, s)) / (m - 1)
    tail = numpy.exp(-alpha * s[-1]) / m
    step = numpy.diff(s) * (rate[1:] + rate[:-1]) / 2
    left = numpy.concatenate([numpy.cumsum(step[::-1])[::-1], [0]]) + tail
    return left, s / (m - 1)


def tree(rng, program, folder, index):
    """The same of a joint of many cells; None where it does not fail."""
    levels = int(rng.integers(2, 5))
    text = TREE.format(size=2 ** levels * rng.uniform(1, 20), levels=levels, seed=int(rng.integers(1, 10**6)),
                       dimension=rng.uniform(1.4, 1.9), b=rng.uniform(0.012, 0.02),
                       dc=10 ** rng.uniform(-2.5, -1), ratio=rng.uniform(0.3, 0.95),
                       sigma=rng.uniform(0.1, 0.8))
    case, output = (os.path.join(folder, f"tree-{index}.{end}") for end in ("yaml", "nc"))
    with open(case, "w", encoding="utf-8") as out:
        out.write(text)
    done = subprocess.run([program, "run", case, "-o", output, "--force", "--json", "--no-progress"],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0 or not json.loads(done.stdout)["failed"]:
        return None
    with netCDF4.Dataset(output) as data:
        time, slip = data["time"][:].filled(), data["slip"][:].filled()
        failed = float(data.failure_time_s)
    os.remove(output)
    keep = time < failed
    return failed - time[keep], slip[keep]


def observe(rng, left, slip):
    """Readings until a random time, with noise and gaps; (times, displacements, failure)."""
    failure = left[0]
    end = failure * (1 - 10 ** rng.uniform(-2, -0.3))
    n = int(rng.integers(25, 121))
    times = numpy.sort((numpy.arange(n) + rng.uniform(-0.3, 0.3, n)).clip(0)) * end / n
    if rng.random() < 0.3:  # a gap
        at = rng.integers(0, n)
        times = numpy.delete(times, slice(at, at + n // 6))
    times = times[numpy.concatenate([[True], numpy.diff(times) > 0])]
    displacement = numpy.interp(failure - times, left[::-1], slip[::-1])
    way = displacement[-1] - displacement[0]
    displacement = displacement + rng.normal(0, way * 10 ** rng.uniform(-3.5, -1.8), len(times))
    scale = 86400 * 30 / failure  # a month
    return times * scale, (displacement - displacement[0]) / way, failure * scale


def ask(job):
    """What the program forecasts of one simulated series."""
    program, folder, index, seed, trees = job
    rng = numpy.random.default_rng([seed, index])
    motion = tree(rng, program, folder, index) if trees else block(rng)
    if motion is None or len(motion[0]) < 30:
        return []
    answers = []
    for _ in range(3 if trees else 1):
        times, displacement, failure = observe(rng, *motion)
        path = os.path.join(folder, f"series-{index}.csv")
        with open(path, "w", encoding="utf-8") as out:
            out.write("t,d\n" + "".join(f"{t:.6f},{d:.9f}\n" for t, d in zip(times, displacement)))
        done = subprocess.run([program, "precursors", path, "--displacement", "d:m", "--json"],
                              capture_output=True, text=True, check=True)
        answers.append((failure, times[-1], json.loads(done.stdout)["forecasts"]))
    return answers


def simulate(arguments):
    with tempfile.TemporaryDirectory(prefix="lacuna-coverage-") as folder:
        jobs = [(arguments.program, folder, i, arguments.seed, i < arguments.trees)
                for i in range(arguments.runs)]
        with concurrent.futures.ProcessPoolExecutor(arguments.threads) as pool:
            return [answer for answers in pool.map(ask, jobs, chunksize=4) for answer in answers]


def gather(answers, issued_only=True):
    """{method: [(true remaining, forecast)]}"""
    found = {}
    for failure, now, forecasts in answers:
        for f in forecasts:
            if f["issued"] or not issued_only:
                found.setdefault(f["method"], []).append((failure - now, now, f))
    return found


def calibrate(answers):
    for method, rows in gather(answers).items():
        true = numpy.array([row[0] for row in rows])
        guess = numpy.array([row[2]["tc_s"] - row[1] for row in rows])
        error = numpy.array([row[2]["relative_error"] for row in rows])
        off, best = numpy.log(true / guess), None
        for spread in (0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8, 1.2):
            scale = numpy.hypot(error, spread)
            q = numpy.quantile(off / scale, [0.05, 0.25, 0.75, 0.95])
            width = numpy.mean(scale) * (q[3] - q[0])
            if best is None or width < best[0]:
                best = width, spread, q
        print(f"{method:12s} n {len(rows):5d}  {{{best[1]}, "
              + ", ".join(f"{v:.3f}" for v in best[2]) + "}")


def table(answers):
    leads = ((0, 0.05), (0.05, 0.15), (0.15, 0.35), (0.35, 1))
    head = ["method", "issued", "in 50 %", "in 90 %", "median error"]
    head += [f"at {100 * a:.0f}-{100 * b:.0f} %" for a, b in leads] + ["late or early"]
    print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for method, rows in gather(answers).items():
        true = numpy.array([row[0] for row in rows])
        span = true + numpy.array([row[1] for row in rows])
        guess = numpy.array([row[2]["tc_s"] - row[1] for row in rows])
        inside = {key: numpy.mean([f[f"interval{key}_s"][0] <= r + now <= f[f"interval{key}_s"][1]
                                   for r, now, f in rows]) for key in (50, 90)}
        relative = numpy.abs(guess - true) / true
        cells = [method, f"{len(rows)}/{len(answers)}", f"{100 * inside[50]:.0f} %",
                 f"{100 * inside[90]:.0f} %", f"{100 * numpy.median(relative):.0f} %"]
        for a, b in leads:
            part = (true / span > a) & (true / span <= b)
            cells.append(f"{100 * numpy.median(relative[part]):.0f} %" if part.sum() > 4 else "-")
        cells.append(f"{numpy.median(guess / true):.2f}")
        print("| " + " | ".join(cells) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--trees", type=int, default=100, help="of the runs: joints of many cells")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--calibrate", action="store_true")
    parser.add_argument("--program", default="build/lacuna")
    arguments = parser.parse_args()
    answers = simulate(arguments)
    (calibrate if arguments.calibrate else table)(answers)
    return 0


if __name__ == "__main__":
    sys.exit(main())
