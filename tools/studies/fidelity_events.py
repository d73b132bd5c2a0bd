#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The events of a joint on elastic rock against those on the hierarchy, as tables in markdown.

    tools/studies/fidelity_events.py [CASE] [--contact X ...] [--dc LENGTH ...] [--seeds N] [--levels M]
                             [--set KEY=VALUE]

Runs the case (cases/transfer/micro-slips.yaml), which is pulled until it fails, with either transfer
on the same cells, at contact fractions of 1, 0.8 and 0.2; dc is that at full contact and is divided
by the fraction, so that k_0/k_crit, k_crit = p (b - a)/dc, stays. Events are those of the run's own
catalogue (docs/theory/events.md), but for the one that is the failure. One table for each dc, a line
for each quantity, means over the seeds 1 to N with their standard errors:

    slope      of the distribution of moments above their median, N(> M) ~ M^-slope (Hill 1975)
    late       share of the events in the second half of the time between the first and the failure;
               0.5 where they do not come faster
    matched    share of the elastic run's events to which one of the other run belongs, one to one:
               begun within 1 % of the time to failure, at most 1 cell apart
    by chance  the same with the other run's events moved half way round the interface
    again      the same for elastic rock itself, integrated with another rtol (1e-4)
"""

import argparse
import math
import os
import statistics
import tempfile

import netCDF4
import numpy

import fidelity

TRANSFERS = {"elastic": "{elastic: {}}", "hierarchy": "{hierarchy: {stiffness: elastic}}"}


def catalogue(path):
    """Events that ended before the run did: time, place, moment and cells."""
    with netCDF4.Dataset(path) as data:
        data.set_auto_mask(False)
        whole = data["event_cut"][:] == 0
        return {key: data["event_" + key][:][whole] for key in ("time", "x", "y", "moment", "cells")}


def run(options, folder, settings):
    """What a run came to, and its catalogue."""
    found = fidelity.run(options, folder, settings)
    return found, catalogue(os.path.join(folder, "run.nc"))


def matched(one, other, end, size, cell):
    """Share of the events of one to which an event of the other belongs."""
    if one["time"].size == 0:
        return math.nan
    if other["time"].size == 0:
        return 0.0
    off = abs(one["time"][:, None] - other["time"]) / (0.01 * end)
    for axis in "xy":
        apart = abs(one[axis][:, None] - other[axis])
        off = numpy.maximum(off, numpy.minimum(apart, size - apart) / (1.001 * cell))
    count = 0
    while off.size and off.min() <= 1:
        i, j = numpy.unravel_index(off.argmin(), off.shape)
        off = numpy.delete(numpy.delete(off, i, 0), j, 1)
        count += 1
    return count / one["time"].size


def slope(moment):
    """Hill's estimate above the median; NaN of fewer than twenty events."""
    above = numpy.sort(moment)[moment.size // 2:]
    return math.nan if moment.size < 20 else 1 / numpy.log(above / above[0])[1:].mean()


def late(time, end):
    """Share of the second half of the time that the events take to the failure; NaN of fewer than ten."""
    return math.nan if time.size < 10 else (time > 0.5 * (time.min() + end)).mean()


def quantities(found, events):
    """The lines of the table for one run."""
    end, moment, cells = found["failure_time_s"], events["moment"], events["cells"]
    some = moment.size > 0
    return {
        "failure, s": end,
        "Q_crit/P": found["apparent_friction"],
        "events": moment.size,
        "moment of all, N m": moment.sum(),
        "largest moment, N m": moment.max() if some else math.nan,
        "mean moment, N m": moment.mean() if some else math.nan,
        "median moment, N m": numpy.median(moment) if some else math.nan,
        "slope": slope(moment),
        "cells, mean": cells.mean() if some else math.nan,
        "cells, largest": cells.max() if some else math.nan,
        "median time before failure, s": end - numpy.median(events["time"]) if some else math.nan,
        "late": late(events["time"], end),
        "steps": found["steps"],
        "CPU s": found["cpu_time_s"],
    }


def compare(options, folder, fraction, length, seed):
    """Either transfer on the contact of one seed: the lines of both, and how their events match."""
    value, unit = length.split()
    shared = [fidelity.domain(fraction, options.levels, seed),
              f"friction.aging.dc={float(value) / fraction} {unit}",
              f"interface.spread.pressure.lognormal.seed={seed}"]
    runs = {name: run(options, folder, shared + [f"transfer={transfer}"])
            for name, transfer in TRANSFERS.items()}
    again = run(options, folder, shared + ["transfer={elastic: {}}", f"solver.rtol={options.again}"])
    found, events = runs["elastic"]
    size, cell = found["grid"][0] * found["cell_size_m"], found["cell_size_m"]
    end, other = found["failure_time_s"], runs["hierarchy"][1]
    moved = dict(other, x=(other["x"] + size / 2) % size, y=(other["y"] + size / 2) % size)
    lines = {name: quantities(*runs[name]) for name in TRANSFERS}
    lines["hierarchy"].update({"matched": matched(events, other, end, size, cell),
                               "by chance": matched(events, moved, end, size, cell)})
    lines["elastic"]["again"] = matched(events, again[1], end, size, cell)
    return lines


def mean_with_error(values):
    """As text; those that do not exist left out."""
    values = [float(value) for value in values if not math.isnan(value)]
    if not values:
        return ""
    mean = statistics.mean(values)
    if len(values) < 2:
        return f"{mean:.3g}"
    error = statistics.stdev(values) / math.sqrt(len(values))
    return f"{mean:.4g} ± {error:.2g}" if error > 0 else f"{mean:.4g}"


def table(options, folder, length):
    """One table."""
    print(f"\ndc = {length} at full contact\n")
    titles, columns = [""], []
    for fraction in options.contact:
        seeds = [compare(options, folder, fraction, length, seed)
                 for seed in range(1, options.seeds + 1)]
        for name in TRANSFERS:
            titles.append(f"{fraction:g}: {name}")
            columns.append([lines[name] for lines in seeds])
    print("| " + " | ".join(titles) + " |")
    print("|" + " --- |" * len(titles))
    keys = [key for column in columns[:2] for key in column[0]]
    for key in dict.fromkeys(keys):
        cells = [mean_with_error([lines.get(key, math.nan) for lines in column]) for column in columns]
        print(f"| {key} | " + " | ".join(cells) + " |", flush=True)


def main():
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    root = fidelity.ROOT
    parser.add_argument("case", nargs="?",
                        default=os.path.join(root, "cases/transfer/micro-slips.yaml"))
    parser.add_argument("--contact", nargs="+", type=float, default=[1, 0.8, 0.2], metavar="X")
    parser.add_argument("--dc", nargs="+", default=["1 um", "2 um", "20 um"], metavar="LENGTH")
    parser.add_argument("--levels", type=int, default=5, help="of the interface (5: 32 x 32 cells)")
    parser.add_argument("--seeds", type=int, default=8, metavar="N")
    parser.add_argument("--again", default="1e-4", help="the other rtol (1e-4)")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--lacuna", default=os.path.join(root, "build/lacuna"),
                        help="the program (build/lacuna)")
    options = parser.parse_args()
    options.set += [f"interface.levels={options.levels}", f"interface.size={4 * 2 ** options.levels} m"]
    with tempfile.TemporaryDirectory() as folder:
        for length in options.dc:
            table(options, folder, length)


if __name__ == "__main__":
    main()
