#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What forecasts are worth on slopes that rain drives, with and without being told of the rain.

    driven_failures.py [--runs 200] [--seed 1] [--choose] [--program build/lacuna]

Simulates slopes that fail, v = v0 (1 - t/tc)^-n, and slopes that only creep, each with a reservoir that
random rain fills and whose level adds to v; cuts each at a random time, adds noise, and has `lacuna
precursors` forecast, without and with --driver. Prints tables, in Markdown: what is said of the rain,
how many forecasts are issued, and how many failures lie in the intervals, with standard errors by
resampling slopes. With --choose instead how many lie in 90 % intervals widened by more and more, which is
where driven_spread of src/forecast/driven.c is from; the tables must then be made with another seed. The
same seed gives the same slopes.
"""

import argparse
import concurrent.futures
import json
import os
import subprocess
import tempfile

import numpy

SPREADS = numpy.array([0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5])
NORMAL = 1.6448536269514722


def rain(rng, days):
    """Of each day [mm]: storms of some days, their amounts exponential."""
    wet = numpy.zeros(days, bool)
    for i in range(1, days):
        wet[i] = rng.random() < (0.6 if wet[i - 1] else 0.15)
    return numpy.where(wet, rng.exponential(10, days), 0)


def reservoir(fell, memory):
    """Its mean level over each day, in parts of its mean over all days."""
    stays, level, mean = numpy.exp(-1 / memory), 0.0, numpy.zeros(len(fell))
    for i, amount in enumerate(fell):
        mean[i] = amount + (level - amount) * memory * (1 - stays)
        level = stays * level + (1 - stays) * amount
    return mean / mean.mean()


def slope(rng, fails):
    """Days, displacements [m], rain of the day before each [mm], time of failure [day]."""
    days = int(rng.integers(60, 250))
    life = days / (1 - 10 ** rng.uniform(-2, -0.3))  # half to 99 % of it has passed
    fell = rain(rng, days)
    edge = numpy.arange(days + 1)
    if fails:
        n = rng.uniform(0.5, 1.5)  # 1/(alpha - 1) of Voight's law
        way = (lambda t: -life * numpy.log(1 - t / life)) if abs(n - 1) < 1e-3 else (
            lambda t: life * (1 - (1 - t / life) ** (1 - n)) / (1 - n))
        own = numpy.diff(way(edge))
    else:
        own = numpy.ones(days)
    own = own + 10 ** rng.uniform(-0.5, 1) * reservoir(fell, 10 ** rng.uniform(0, 1.3))
    displacement = numpy.concatenate([[0], numpy.cumsum(own)]) * 1e-3
    noise = displacement[-1] * 10 ** rng.uniform(-4, -2.3)
    return edge, displacement + rng.normal(0, noise, days + 1), numpy.concatenate([[0], fell]), life


def ask(job):
    program, folder, index, seed, fails = job
    rng = numpy.random.default_rng([seed, index, fails])
    time, displacement, fell, life = slope(rng, fails)
    path = os.path.join(folder, f"slope-{index}-{fails}.csv")
    with open(path, "w", encoding="utf-8") as out:
        out.write("day,d_m,rain_mm\n" + "".join(f"{t},{d:.6f},{r:.1f}\n" for t, d, r in zip(time, displacement, fell)))
    answers = []
    for words in ([], ["--driver", "rain_mm:mm:sum"]):
        done = subprocess.run([program, "precursors", path, "--displacement", "d_m:m", "--time-format", "day",
                               "--json", *words], capture_output=True, text=True, check=True)
        answers.append(json.loads(done.stdout))
    os.remove(path)
    return life * 86400, time[-1] * 86400, *answers


def simulate(arguments, fails):
    with tempfile.TemporaryDirectory(prefix="lacuna-driven-") as folder:
        jobs = [(arguments.program, folder, i, arguments.seed, fails) for i in range(arguments.runs)]
        with concurrent.futures.ProcessPoolExecutor(arguments.threads) as pool:
            return list(pool.map(ask, jobs))


def issued(answer):
    return [f for f in answer["forecasts"] if f["issued"] and f["method"] != "persistence"]


def share(rng, counts):
    """Of [(hits, of)] a slope, all in all, and its standard error by resampling slopes."""
    counts = numpy.array([c for c in counts if c[1] > 0]).reshape(-1, 2)
    if len(counts) == 0:
        return "-"
    again = [counts[rng.integers(0, len(counts), len(counts))].sum(axis=0) for _ in range(1000)]
    error = numpy.std([a[0] / a[1] for a in again])
    return f"{100 * counts[:, 0].sum() / counts[:, 1].sum():.0f} ± {100 * error:.0f} %"


def inside(f, failure, interval):
    return f[interval][0] <= failure <= f[interval][1]


def verdict(answer):
    d = answer["drivers"][0]
    return d["verdict"] if d["verdict"] != "explains" else f"explains, rest: {d['what_remains']}"


def print_verdicts(failing, creeping):
    names = sorted({verdict(a[3]) for a in failing + creeping})
    print("| what is said of the rain | failing | creeping |\n| --- | --- | --- |")
    for name in names + ["of these withheld"]:
        said = [sum(a[3]["drivers"][0]["withholds"] if name.startswith("of") else verdict(a[3]) == name for a in of)
                for of in (failing, creeping)]
        print(f"| {name} | {said[0]} | {said[1]} |")


def print_coverage(failing, creeping):
    rng = numpy.random.default_rng(1)
    told = [a for a in failing if a[3]["drivers"][0]["verdict"] == "explains"]
    print("\n| | without the rain | with it |\n| --- | --- | --- |")
    for title, of in (("all failing slopes", failing), ("where the rain explains", told)):
        for interval in (50, 90):
            cells = [share(rng, [(sum(inside(f, a[0], f"interval{interval}_s") for f in issued(a[k])), len(issued(a[k])))
                                 for a in of]) for k in (2, 3)]
            print(f"| failures in {interval} %, {title} | {cells[0]} | {cells[1]} |")
    for title, of in (("failing", failing), ("creeping", creeping)):
        cells = [share(rng, [(len(issued(a[k])) > 0, 1) for a in of]) for k in (2, 3)]
        print(f"| {title} slopes with a forecast | {cells[0]} | {cells[1]} |")
    for early, late in ((0, 0.05), (0.05, 0.15), (0.15, 0.35), (0.35, 1)):
        of = [a for a in failing if early <= 1 - a[1] / a[0] < late]
        cells = [share(rng, [(len(issued(a[k])) > 0, 1) for a in of]) for k in (2, 3)]
        print(f"| failing slopes with a forecast, {100 * early:.0f}-{100 * late:.0f} % of the life left | {cells[0]} | {cells[1]} |")


def widened(f, now, spread):
    """The logarithms of the ends of a forecast's 90 % interval with a spread added."""
    low50, high50 = numpy.log(numpy.array(f["interval50_s"]) - now)
    middle = (low50 + high50) / 2
    low, high = numpy.log(numpy.array(f["interval90_s"]) - now) - middle
    return middle - numpy.hypot(low, NORMAL * spread), middle + numpy.hypot(high, NORMAL * spread)


def choose(arguments, failing):
    rng = numpy.random.default_rng(1)
    of = [a for a in failing if a[3]["drivers"][0]["verdict"] == "explains" and not a[3]["drivers"][0]["withholds"]]
    print(f"{len(of)} failing slopes of which the rain explains the rate, and is not all that rises\n")
    print("| spread | in 90 % |\n| --- | --- |")
    for spread in SPREADS:
        counts = []
        for a in of:
            left = numpy.log(a[0] - a[1])
            ends = [widened(f, a[1], spread) for f in issued(a[2])]
            counts.append((sum(low <= left <= high for low, high in ends), len(ends)))
        print(f"| {spread:g} | {share(rng, counts)} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--choose", action="store_true")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--program", default="build/lacuna")
    arguments = parser.parse_args()
    failing = simulate(arguments, True)
    if arguments.choose:
        choose(arguments, failing)
        return
    creeping = simulate(arguments, False)
    print_verdicts(failing, creeping)
    print_coverage(failing, creeping)


if __name__ == "__main__":
    main()
