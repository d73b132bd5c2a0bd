#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Area scaling of an interface under several loads, as a table in markdown.

    tools/studies/area_scaling.py [CASE] [--loads X ...] [--coarsening HOW] [--boxes S:S] [--seeds N] [--set KEY=VALUE]

Calls `lacuna contact --json` on the case (cases/contact/j07.yaml) at mean pressures of X times its
contact modulus E* = G/(1 - nu), 5e-4 to 0.1 unless said. Columns: the contact fraction at each
resolution; Delta_S of all resolutions, and without the finest, +- its error;
2 - d ln h'/d ln(1/r) from the heights alone; D_box on sides 2 to 32 +- its error. In brackets the
standard error of the regression alone. With --seeds each row is the mean over surfaces of the seeds
1 to N, +- the standard deviation among them.
"""

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LOADS = [5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 0.1]


def call(program, *words):
    """The JSON that a command prints."""
    done = subprocess.run([program, *words, "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"area_scaling: {' '.join(words)}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def modulus(program, case):
    """E* of the case, from the resolved scene that `check` prints [Pa]."""
    done = subprocess.run([program, "check", case], capture_output=True, text=True, check=False)
    values = [re.search(rf"^\s*{key}: \"?([-+.\deE]+)", done.stdout, re.M)
              for key in ("shear_modulus", "poisson")]
    if done.returncode != 0 or None in values:
        sys.exit(f"area_scaling: {case}: no elastic material in it {done.stderr.strip()}")
    shear, poisson = (float(value.group(1)) for value in values)
    return shear / (1.0 - poisson)


def number(value, error=None, regression=None):
    """Text of a number that may be missing, with its errors."""
    if value is None:
        return "-"
    text = f"{value:.3f}"
    if error is not None:
        text += f" ± {error:.3f}"
    return text if regression is None else f"{text} ({regression:.3f})"


def dimension(done, name):
    """A dimension with its errors."""
    return number(*(done[name + end] for end in ("", "_error", "_regression_error")))


def row(load, done):
    """One row of the table, of one surface."""
    areas = [f"{at['area_fraction']:.6f}" for at in done["resolutions"]]
    return [f"{load:g}", *areas,
            dimension(done, "delta_s_all"),
            dimension(done, "delta_s") + (", weak" if done["delta_s_weak"] else ""),
            number(done["delta_s_from_slopes"]),
            dimension(done, "d_box") + (", weak" if done["d_box_weak"] else "")]


def mean_row(load, all_done):
    """One row of the table, of several surfaces."""
    areas = [[at["area_fraction"] for at in done["resolutions"]] for done in all_done]
    names = ("delta_s_all", "delta_s", "delta_s_from_slopes", "d_box")
    columns = [[done[name] for done in all_done] for name in names]
    return [f"{load:g}", *(f"{statistics.mean(area):.6f}" for area in zip(*areas)),
            *("-" if None in column else
              number(statistics.mean(column), statistics.stdev(column)) for column in columns)]


def heading(done):
    """The names of the columns."""
    size = done["cell_size_m"] * done["grid"][0]
    cells = [f"A at 1/{size / at['cell_size_m']:.0f}" for at in done["resolutions"]]
    n = len(cells)
    return ["p̄/E*", *cells, f"Δ_S, {n} resolutions", "without the finest",
            "from slopes", "D_box"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("case", nargs="?", default=os.path.join(ROOT, "cases/contact/j07.yaml"))
    parser.add_argument("--loads", nargs="+", type=float, default=LOADS, metavar="X",
                        help="mean pressure over E*")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    parser.add_argument("--coarsening", default="sample", help="sample or block-mean")
    parser.add_argument("--boxes", default="2:32", help="sides that D_box is fitted to")
    parser.add_argument("--seeds", type=int, default=0, metavar="N", help="surfaces to average over")
    parser.add_argument("--seed-key", default="interface.surface.self-affine.seed", metavar="KEY",
                        help="what --seeds sets")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="override the case; may be repeated")
    arguments = parser.parse_args()
    others = ["--coarsening", arguments.coarsening, "--boxes", arguments.boxes]
    for override in arguments.set:
        others += ["--set", override]
    e_star = modulus(arguments.program, arguments.case)
    with tempfile.TemporaryDirectory(prefix="lacuna-area-scaling-") as folder:
        for i, load in enumerate(arguments.loads):
            words = ["contact", arguments.case, "--force", "-o", os.path.join(folder, "contact.nc"),
                     "--set", f"load.normal.pressure={load * e_star:.17g} Pa", *others]
            seeds = [["--set", f"{arguments.seed_key}={seed + 1}"]
                     for seed in range(arguments.seeds)] or [[]]
            done = [call(arguments.program, *words, *seed) for seed in seeds]
            for one in done:
                if not one["resolutions"]:
                    sys.exit(f"area_scaling: {arguments.case}: no Delta_S: {one['delta_s_none']}")
            if i == 0:
                names = heading(done[0])
                print("| " + " | ".join(names) + " |")
                print("| " + " | ".join("---" for _ in names) + " |")
            cells = mean_row(load, done) if len(done) > 1 else row(load, done[0])
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
