#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How good forecasts are on simulated failures, of which the time is known.

    forecast_coverage.py [--runs 500] [--trees 100] [--cases 40] [--seed 1] [--calibrate] [--program build/lacuna]

Simulates failures, cuts each at a random time, adds noise and gaps, and has `lacuna precursors`
forecast from what is left: blocks of rate-and-state friction in closed form (docs/theory/creep.md), and
joints of many cells run by `lacuna run`, one stretch of some also forecast by the joint's own case (its
dc, first slip rate and first state unknown). Prints tables, in Markdown, of coverage and errors, and of
how late inverse velocity is. With --calibrate it prints the intervals' quantiles instead, as they
stand in src/forecast and src/fit/model_forecast.c; the tables must then be made with another seed. The same
seed gives the same series.
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

import calibration

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

UNKNOWN = """fit:
  parameters:
    friction.aging.dc: {range: ["1 mm", "0.3 m"]}
    initial.slip_rate: {range: ["0.1 mm/day", "10 mm/day"]}
    initial.state.ratio_to_steady: {range: [0.2, 0.97], prior: {uniform: {}}}
  displacement: "d:m"
  time: t
  steps: 0
"""


def whole_block(m, x):
    """Times before failure (falling), displacements and velocities of one block: O1 to O3 in s."""
    y = x ** (m - 1)
    alpha = m / (m - 1)
    s = numpy.concatenate([numpy.linspace(numpy.log((1 - y) / y), 40, 40001)])
    rate = numpy.exp(-alpha * numpy.logaddexp(0, s)) / (m - 1)
    tail = numpy.exp(-alpha * s[-1]) / m
    step = numpy.diff(s) * (rate[1:] + rate[:-1]) / 2
    left = numpy.concatenate([numpy.cumsum(step[::-1])[::-1], [0]]) + tail
    return left, s / (m - 1), numpy.exp(alpha * numpy.logaddexp(0, s))


def block(rng):
    """Of a block drawn at random."""
    return whole_block(rng.uniform(1.1, 2.5), rng.uniform(0.05, 0.97))[:2]


def tree(rng, program, folder, index):
    """The same of a joint of many cells, and its case; None where it does not fail."""
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
    with open(case, "a", encoding="utf-8") as out:
        out.write(UNKNOWN)
    return failed - time[keep], slip[keep], case


def observe(rng, left, slip, scaled):
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
    if not scaled:
        return times, displacement, failure
    scale = 86400 * 30 / failure  # a month
    return times * scale, (displacement - displacement[0]) / way, failure * scale


def ask(job):
    """What the program forecasts of one simulated series."""
    program, folder, index, seed, trees, case = job
    rng = numpy.random.default_rng([seed, index])
    motion = tree(rng, program, folder, index) if trees else block(rng)
    if motion is None or len(motion[0]) < 30:
        return []
    answers = []
    for stretch in range(3 if trees else 1):
        times, displacement, failure = observe(rng, *motion[:2], not trees)
        model = ["--case", motion[2]] if case and stretch == 0 else []
        path = os.path.join(folder, f"series-{index}.csv")
        with open(path, "w", encoding="utf-8") as out:
            out.write("t,d\n" + "".join(f"{t:.6f},{d:.12g}\n" for t, d in zip(times, displacement)))
        done = subprocess.run([program, "precursors", path, "--displacement", "d:m", "--json", *model],
                              capture_output=True, text=True, check=True)
        answer = json.loads(done.stdout)
        for f in answer["forecasts"]:
            f["window_start_s"] = answer["window_start_s"] or 0.0  # the first reading
        answers.append((failure, times[-1], answer["forecasts"], trees))
    return answers


def simulate(arguments):
    with tempfile.TemporaryDirectory(prefix="lacuna-coverage-") as folder:
        # chunks of one: a joint takes far longer than a block
        jobs = [(arguments.program, folder, i, arguments.seed, i < arguments.trees, i < arguments.cases)
                for i in range(arguments.runs)]
        with concurrent.futures.ProcessPoolExecutor(arguments.threads) as pool:
            return [answer for answers in pool.map(ask, jobs) for answer in answers]


def gather(answers):
    """{method: [(true remaining, time of issue, forecast)]} of those issued, {method: number asked}"""
    found, asked = {}, {}
    for failure, now, forecasts, _ in answers:
        for f in forecasts:
            asked[f["method"]] = asked.get(f["method"], 0) + 1
            if f["issued"]:
                found.setdefault(f["method"], []).append((failure - now, now, f))
    return found, asked


def calibrate(answers):
    for method, rows in gather(answers)[0].items():
        seen = [(remaining, calibration.seen(now, f["window_start_s"], f["tc_raw_s"], f["relative_error"], f["posterior_s"]))
                for remaining, now, f in rows]
        truth = numpy.log([remaining for remaining, found in seen if found is not None])
        x, window, errors = (numpy.array(part) for part in zip(*(found for _, found in seen if found is not None)))
        # the case knows more than the window's length
        pulls = (0.0,) if method == "case" else calibration.PULLS
        loss, *values = calibration.best(truth, x, window, errors, numpy.ones(len(truth)), pulls)
        print(f"{method:12s} n {len(truth):5d}, loss {loss:.3f}  {calibration.row(*values)}")


def within(rows, interval):
    """Share of the true times in an interval, in percent."""
    return 100 * numpy.mean([interval(f)[0] <= r + now <= interval(f)[1] for r, now, f in rows])


def table(title, answers):
    print(f"### {title}\n")
    leads = ((0, 0.05), (0.05, 0.15), (0.15, 0.35), (0.35, 1))
    head = ["method", "issued", "in 50 %", "in 90 %", "median error"]
    head += [f"at {100 * a:.0f}-{100 * b:.0f} %" for a, b in leads] + ["late or early"]
    print("| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    found, asked = gather(answers)
    for method, rows in found.items():
        true = numpy.array([row[0] for row in rows])
        span = true + numpy.array([row[1] for row in rows])
        guess = numpy.array([row[2]["tc_s"] - row[1] for row in rows])
        relative = numpy.abs(guess - true) / true
        cells = [method, f"{len(rows)}/{asked[method]}",
                 f"{within(rows, lambda f: f['interval50_s']):.0f} %",
                 f"{within(rows, lambda f: f['interval90_s']):.0f} %", f"{100 * numpy.median(relative):.0f} %"]
        for a, b in leads:
            part = (true / span > a) & (true / span <= b)
            cells.append(f"{100 * numpy.median(relative[part]):.0f} %" if part.sum() > 4 else "-")
        cells.append(f"{numpy.median(guess / true):.2f}")
        print("| " + " | ".join(cells) + " |")
    rows = [row for row in found.get("block", []) if row[2]["posterior_s"]]
    if rows:
        print("\nThe posterior of `block` as it is: "
              f"{within(rows, lambda f: f['posterior_s'][1:4:2]):.0f} % in 50 %, "
              f"{within(rows, lambda f: f['posterior_s'][0:5:4]):.0f} % in 90 %.")
    print()


def late(program):
    """Inverse velocity on exact blocks, m = 1.35: its remaining time over the true one, and the theory's."""
    print("### How late inverse velocity is on a block, b/a = 1.35\n")
    print("| x | theory | inv8 | off |\n| --- | --- | --- | --- |")
    m = 1.35
    for x in (0.1, 0.5, 0.9):
        left, slip, speed = whole_block(m, 0.999 ** (1 / (m - 1)))
        y = x ** (m - 1)
        now = numpy.interp(numpy.log((1 - y) / y), slip * (m - 1), left)
        times = numpy.concatenate([numpy.linspace(1.5 * now, 1.01 * now, 20), now * (1 + 1e-4 * numpy.arange(8)[::-1])])
        rate = numpy.exp(numpy.interp(-times, -left, numpy.log(speed)))
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as out:
            out.write("t,v\n" + "".join(f"{1e6 * (left[0] - t):.17g},{1e-9 * v:.17g}\n" for t, v in zip(times, rate)))
            out.flush()
            done = subprocess.run([program, "precursors", out.name, "--velocity", "v:m/s", "--json", "--since", "0 s"],
                                  capture_output=True, text=True, check=True)
        found = next(f for f in json.loads(done.stdout)["forecasts"] if f["method"] == "inv8")
        theory = x ** m / (m * (1 - y)) / now
        ratio = (found["tc_raw_s"] - 1e6 * (left[0] - now)) / (1e6 * now)
        print(f"| {x} | {theory:.3f} | {ratio:.3f} | {100 * (ratio / theory - 1):+.2f} % |")
    print()


def exact(program):
    """What displacements alone do to each method where v = B/(tc - t) exactly."""
    print("### Bias where v = B/(tc - t), from exact displacements alone, a tenth of the life left\n")
    columns = []
    for n in (15, 30, 60, 120):
        times = numpy.linspace(0, 0.9e6, n + 1)
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as out:
            out.write("t,d\n" + "".join(f"{t:.17g},{-numpy.log1p(-t / 1e6):.17g}\n" for t in times))
            out.flush()
            done = subprocess.run([program, "precursors", out.name, "--displacement", "d:m", "--json", "--since",
                                   "0 s"], capture_output=True, text=True, check=True)
        columns.append({f["method"]: (f["tc_raw_s"] - 1e6) / 1e5 for f in json.loads(done.stdout)["forecasts"]
                        if f["tc_raw_s"] is not None and f["method"] != "persistence"})
    print("| readings | " + " | ".join(columns[0]) + " |\n|" + " --- |" * (len(columns[0]) + 1))
    for n, column in zip((15, 30, 60, 120), columns):
        print(f"| {n} | " + " | ".join(f"{100 * column[name]:+.2g} %" if abs(column[name]) > 1e-6 else "0"
                                       for name in columns[0]) + " |")
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--trees", type=int, default=100, help="of the runs: joints of many cells")
    parser.add_argument("--cases", type=int, default=40, help="of the trees: also forecast by their own case")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--calibrate", action="store_true")
    parser.add_argument("--program", default="build/lacuna")
    arguments = parser.parse_args()
    arguments.cases = min(arguments.cases, arguments.trees)
    answers = simulate(arguments)
    if arguments.calibrate:
        calibrate(answers)
        return 0
    table(f"{arguments.runs} failures, {len(answers)} stretches", answers)
    table("Joints alone", [answer for answer in answers if answer[3]])
    late(arguments.program)
    exact(arguments.program)
    return 0


if __name__ == "__main__":
    sys.exit(main())
