#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The elastic transfer against the hierarchy on the same contact, as a table in markdown.

    tools/studies/fidelity.py [CASE] [--contact X ...] [--dc LENGTH ...] [--failure RATE] [--seeds N]
                      [--ramp RATE] [--set KEY=VALUE]

Calls `lacuna run --json` on the case (cases/transfer/elastic.yaml) with either transfer, at contact
fractions of 1, 0.8 and 0.2 (cascades of the dimension that gives them on the case's levels) and
values of dc, which set how strongly the cells hold each other. Columns: contact cells; times of
failure; their difference, and the largest among contacts of the seeds 1 to N; the same where cells
do not feel each other (none); steps; CPU time of both and their ratio. All but the differences are
means over the seeds.

--ramp: the joint, at first as good as still (1e-13 m/s), is pulled ever harder at that rate until it
fails, and the columns of the time of failure hold Q_crit/P instead, the force that it fails at.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
TRANSFERS = {
    "elastic": "{elastic: {}}",
    "hierarchy": "{hierarchy: {stiffness: elastic}}",
    "none": "{none: {}}",
}


def run(options, folder, settings):
    """What `lacuna run` says of the case under some settings."""
    words = [options.lacuna, "run", options.case, "-o", os.path.join(folder, "run.nc"), "--force",
             "--quiet", "--json", "--set", "output.every={per_decade: 1}"]
    for setting in settings + options.set:
        words += ["--set", setting]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"fidelity: {' '.join(settings)}: {done.stderr.strip()}")
    found = json.loads(done.stdout)
    if not found["failed"]:
        sys.exit(f"fidelity: {' '.join(settings)}: no failure before the end")
    return found


def domain(fraction, levels, seed):
    """The setting of a contact domain that covers this part of the interface on average."""
    if fraction >= 1:
        return "interface.domain={full: {}}"
    dimension = 2 + math.log2(fraction) / levels
    return f"interface.domain={{cascade: {{dimension: {dimension:.4f}, seed: {seed}}}}}"


def row(options, folder, fraction, length):
    """One line of the table."""
    runs = {name: [] for name in TRANSFERS}
    for seed in range(1, options.seeds + 1):
        shared = [domain(fraction, options.levels, seed), f"friction.aging.dc={length}",
                  f"friction.spread.dc.lognormal.seed={seed}",
                  f"initial.spread.slip_rate.lognormal.seed={seed + 1000}"]
        for name, transfer in TRANSFERS.items():
            runs[name].append(run(options, folder, shared + [f"transfer={transfer}"]))

    def mean(name, key):
        return statistics.mean(found[key] for found in runs[name])

    key, unit = ("apparent_friction", 1) if options.ramp else ("failure_time_s", 86400)

    def differences(name):
        return [a[key] / b[key] - 1 for a, b in zip(runs[name], runs["elastic"])]

    off = differences("hierarchy")
    cpu = [mean(name, "cpu_time_s") for name in ("elastic", "hierarchy")]
    cells = [f"{fraction:g}", length, f"{mean('elastic', 'n_cells'):.0f}",
             f"{mean('elastic', key) / unit:.4g}", f"{mean('hierarchy', key) / unit:.4g}",
             f"{100 * statistics.mean(off):+.3g}", f"{100 * max(map(abs, off)):.2g}",
             f"{100 * statistics.mean(differences('none')):+.2g}",
             f"{mean('elastic', 'steps'):.0f}", f"{mean('hierarchy', 'steps'):.0f}",
             f"{cpu[0]:.2f}", f"{cpu[1]:.3f}", f"{cpu[0] / cpu[1]:.0f}"]
    print("| " + " | ".join(cells) + " |", flush=True)


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", nargs="?",
                        default=os.path.join(ROOT, "cases/transfer/elastic.yaml"))
    parser.add_argument("--contact", nargs="+", type=float, default=[1, 0.8, 0.2], metavar="X")
    parser.add_argument("--dc", nargs="+", default=["1 mm", "0.1 mm", "0.02 mm"], metavar="LENGTH")
    parser.add_argument("--levels", type=int, default=6, help="of the interface (6)")
    parser.add_argument("--failure", default="0.1 mm/s", metavar="RATE",
                        help="mean slip rate that is failure (0.1 mm/s, one cell running away)")
    parser.add_argument("--seeds", type=int, default=5, metavar="N")
    parser.add_argument("--ramp", metavar="RATE",
                        help='of the shear stress, such as "10 kPa/day": find Q_crit')
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build/lacuna"),
                        help="the program (build/lacuna)")
    options = parser.parse_args()
    options.set += [f"interface.levels={options.levels}",
                    f"time.failure.mean_slip_rate={options.failure}"]
    if options.ramp:
        options.set += [f"load.shear=[{{ramp: {{rate: {options.ramp}}}}}]",
                        "initial.slip_rate=1e-13 m/s"]
    what = "Q_crit/P" if options.ramp else "day"
    titles = ["contact", "dc", "cells", f"elastic, {what}", f"hierarchy, {what}", "off, %", "at most, %",
              "none off, %", "steps", "steps, hierarchy", "CPU s", "CPU s, hierarchy", "ratio"]
    print("| " + " | ".join(titles) + " |")
    print("|" + " --- |" * len(titles))
    with tempfile.TemporaryDirectory() as folder:
        for length in options.dc:
            for fraction in options.contact:
                row(options, folder, fraction, length)


if __name__ == "__main__":
    main()
