#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Catalogues of fidelity `events` against those of `ode` on the same scenes, as a table in markdown.

    tools/studies/events_statistics.py [CASE] [--seeds N] [--runs FIDELITY:RTOL FIDELITY:RTOL]
                               [--keep FOLDER] [--set KEY=VALUE]

Runs the case (cases/one-by-one.yaml) as events:1e-6 and ode:1e-6, the reference, and with other seeds of its contact, dc
and first slip rates where N > 1 (the first are its own). First what each scene came to; then, of all
scenes' whole events together, each quantity with its sampling error (its spread over 400 catalogues
drawn from the events with replacement, of Poissonian numbers) and how far the two are apart, over
the error of that difference, p the chance of more. Both see the same scenes, so that they hang
together and the errors are upper ones. For distributions: the largest distance between the two,
and p of as much from one distribution (Kolmogorov and Smirnov).

    slope      of moments above the median, N(> M) ~ M^-slope (Hill 1975)
    interval   between the beginnings of events in a row, over the time to failure
    late       share of the events in the second half of the time from the first to the failure

--keep: the runs' files stay in this folder, and runs that it holds are not run again.
"""

import argparse
import json
import math
import os
import tempfile

import numpy

import fidelity
import fidelity_events

SEEDS = {"interface.domain.cascade.seed": 5, "friction.spread.dc.lognormal.seed": 4,
         "initial.spread.slip_rate.lognormal.seed": 2}
DRAWN = 400


def run(options, folder, scene, name, rtol):
    """What a run came to, and its catalogue, sorted by time."""
    place = os.path.join(folder, f"{scene}-{name}-{rtol}")
    told = os.path.join(place, "run.json")
    if not os.path.exists(told):
        os.makedirs(place, exist_ok=True)
        settings = [f"{key}={seed + 10 * scene}" for key, seed in SEEDS.items()]
        found = fidelity.run(options, place, settings + [f"solver.fidelity={name}",
                                                         f"solver.rtol={rtol}"])
        with open(told, "w", encoding="utf-8") as file:
            json.dump(found, file)
    with open(told, encoding="utf-8") as file:
        found = json.load(file)
    events = fidelity_events.catalogue(os.path.join(place, "run.nc"))
    order = events["time"].argsort()
    events = {key: value[order] for key, value in events.items()}
    end = found["failure_time_s"]
    events["interval"] = numpy.diff(events["time"], prepend=numpy.nan) / end
    first = events["time"][0]
    events["late"] = (events["time"] > 0.5 * (first + end)).astype(float)
    return found, events


QUANTITIES = {
    "events": lambda e: e["moment"].size,
    "moment of all, N m": lambda e: e["moment"].sum(),
    "median moment, N m": lambda e: numpy.median(e["moment"]),
    "mean log10 moment": lambda e: numpy.log10(e["moment"]).mean(),
    "slope": lambda e: fidelity_events.slope(e["moment"]),
    "cells, mean": lambda e: e["cells"].mean(),
    "of one cell": lambda e: (e["cells"] == 1).mean(),
    "median interval": lambda e: numpy.nanmedian(e["interval"]),
    "late": lambda e: e["late"].mean(),
}


def sampling_error(events, quantity, draw):
    """Standard deviation over catalogues drawn from this one."""
    n = events["moment"].size
    found = []
    for _ in range(DRAWN):
        taken = draw.integers(n, size=max(draw.poisson(n), 1))
        found.append(quantity({key: value[taken] for key, value in events.items()}))
    return numpy.std(found)


def chance(apart):
    """Of a normal variable beyond so many of its standard deviations."""
    return math.erfc(apart / math.sqrt(2))


def kolmogorov(one, other):
    """Largest distance of two distributions, and the chance of more from one."""
    both = numpy.concatenate([one, other])
    ranks = [numpy.searchsorted(numpy.sort(x), both, side="right") / x.size for x in (one, other)]
    distance = abs(ranks[0] - ranks[1]).max()
    scaled = distance * math.sqrt(one.size * other.size / (one.size + other.size))
    k = numpy.arange(1, 101)
    p = 2 * ((-1.0) ** (k - 1) * numpy.exp(-2 * (k * scaled) ** 2)).sum() if scaled > 0.2 else 1.0
    return distance, min(max(p, 0.0), 1.0)


def scenes_table(runs):
    """What each scene came to; returns nothing."""
    print("| scene | cells | failure, s | off, % | events | CPU s | ratio |")
    print("|" + " --- |" * 7)
    off = []
    for scene, pair in enumerate(runs):
        ours, theirs = (found for found, _ in pair)
        off.append(ours["failure_time_s"] / theirs["failure_time_s"] - 1)
        cpu = [found["cpu_time_s"] for found in (ours, theirs)]
        print(f"| {scene} | {ours['n_cells']} | {theirs['failure_time_s']:.1f} | {100 * off[-1]:+.3f} | "
              f"{theirs['events']} / {ours['events']} | {cpu[1]:.1f} / {cpu[0]:.2f} | "
              f"{cpu[1] / cpu[0]:.0f} |")
    print(f"\nfailure off by {100 * max(map(abs, off)):.2g} % at most\n")


def statistics_table(options, runs):
    """All scenes' events together."""
    ours, theirs = ({key: numpy.concatenate([pair[side][1][key] for pair in runs])
                     for key in runs[0][side][1]} for side in (0, 1))
    draw = numpy.random.default_rng(1)
    print(f"| | {options.runs[1]} | {options.runs[0]} | apart | p |")
    print("|" + " --- |" * 5)
    for name, quantity in QUANTITIES.items():
        values = [quantity(events) for events in (theirs, ours)]
        errors = [sampling_error(events, quantity, draw) for events in (theirs, ours)]
        apart = abs(values[0] - values[1]) / math.hypot(*errors)
        print(f"| {name} | {values[0]:.4g} ± {errors[0]:.2g} | {values[1]:.4g} ± {errors[1]:.2g} | "
              f"{apart:.2f} | {chance(apart):.2f} |")
    for name in ("moment", "interval"):
        samples = [events[name][~numpy.isnan(events[name])] for events in (theirs, ours)]
        distance, p = kolmogorov(*samples)
        print(f"| distribution: {name} | {samples[0].size} | {samples[1].size} | {distance:.3f} | {p:.2f} |")


def main():
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    root = fidelity.ROOT
    parser.add_argument("case", nargs="?", default=os.path.join(root, "cases/one-by-one.yaml"))
    parser.add_argument("--seeds", type=int, default=8, metavar="N")
    parser.add_argument("--runs", nargs=2, default=["events:1e-6", "ode:1e-6"],
                        metavar="FIDELITY:RTOL", help="what is compared, with what")
    parser.add_argument("--keep", metavar="FOLDER")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--lacuna", default=os.path.join(root, "build/lacuna"),
                        help="the program (build/lacuna)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.keep or scratch
        runs = [[run(options, folder, scene, *how.split(":")) for how in options.runs]
                for scene in range(options.seeds)]
        scenes_table(runs)
        statistics_table(options, runs)


if __name__ == "__main__":
    main()
