#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws how a run's slip spreads from scale to scale as its end comes near.

    tools/studies/rg_in_time.py RUN.nc [-o RUN-rg.png]

The run must have been made with `analysis: {rg: ...}`. Time is counted back from failure, or from
the last record where the run did not fail.
"""

import argparse
import os
import sys

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import netCDF4
    import numpy as np
except ImportError as missing:
    sys.exit(
        f"rg_in_time: {missing.name} is not installed for {sys.executable}; on Debian it comes with\n"
        "  tools/install-packages\n"
        "and is seen by Debian's own interpreter: /usr/bin/python3 tools/studies/rg_in_time.py ..."
    )

INK, QUIET, FAINT, FAST = "#1d2733", "#6b7785", "#d9dee4", "#c8761a"
UNITS = [(1e3, "km"), (1.0, "m"), (1e-2, "cm"), (1e-3, "mm"), (1e-6, "um")]


def length(value):
    scale, unit = next((u for u in UNITS if value >= u[0]), UNITS[-1])
    return f"{value / scale:.3g} {unit}"


def read(path):
    with netCDF4.Dataset(path) as data:
        if "n_slip" not in data.variables or len(data.dimensions["time"]) < 2:
            sys.exit(f"rg_in_time: {path}: no slipping blocks in it; the case needs analysis: {{rg: {{}}}}")
        names = ("slip_fraction", "correlation_length", "criticality", "slip_rate")
        run = {name: np.ma.filled(data[name][:], np.nan) for name in names}
        run["fraction"] = np.ma.filled(data["n_slip"][:] / data["n_tot"][:], np.nan)
        run["side"] = data["block_size"][:]
        run["size"] = data["block_size"][0] * max(data.grid_nx, data.grid_ny)
        critical = data["critical_fraction"]
        run["critical"] = float(np.ma.filled(critical[:], np.nan))
        run["source"] = critical.comment
        run["definition"] = data["slip_fraction"].comment
        origin, local = data["time_origin"][:], data["time_local"][:]
        run["before"] = (origin[-1] - origin) + (local[-1] - local)
        run["end"] = "failure" if getattr(data, "failed", 0) else "the last record"
    return run


def axis(ax, label):
    ax.set_ylabel(label, color=INK)
    ax.grid(color=FAINT, linewidth=0.6)
    ax.tick_params(colors=QUIET)
    for spine in ax.spines.values():
        spine.set_color(FAINT)


def draw_levels(ax, run, t):
    shown = [k for k in range(run["fraction"].shape[1]) if run["fraction"][:, k].any()]
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.9, max(1, len(shown))))
    for k, colour in zip(shown, colours):
        ax.step(t, run["fraction"][:-1, k], where="post", color=colour, linewidth=1.2,
                label=length(run["side"][k]))
    if np.isfinite(run["critical"]):
        ax.axhline(run["critical"], color=FAST, linewidth=1, linestyle="--")
        ax.annotate(f"fixed point {run['critical']:.2f}", (0.01, run["critical"]),
                    xycoords=("axes fraction", "data"), va="bottom", color=FAST, fontsize=8)
    ax.legend(title="blocks of", fontsize=8, title_fontsize=8, frameon=False, loc="upper left",
              bbox_to_anchor=(1.0, 1.02))
    axis(ax, "N_slip / N_tot")


def draw(run, path):
    t = run["before"][:-1]  # the last record is time 0, which has no logarithm
    first = np.argmax(run["slip_fraction"] > 0)
    figure, (top, middle, bottom) = plt.subplots(3, 1, figsize=(8, 8), sharex=True)
    draw_levels(top, run, t)
    top.set_title(run["definition"], fontsize=9, color=QUIET, loc="left")
    middle.step(t, run["correlation_length"][:-1], where="post", color=INK, linewidth=1.2)
    middle.axhline(run["size"], color=QUIET, linewidth=0.8, linestyle=":")
    middle.set_yscale("log")
    axis(middle, "longest cluster ξ (m)")
    bottom.plot(t, run["slip_rate"][:-1], color=INK, linewidth=0.8)
    bottom.set_yscale("log")
    axis(bottom, "mean slip rate (m/s)")
    bottom.set_xscale("log")
    bottom.set_xlim(3 * run["before"][first], max(t[-1], 1e-9))
    bottom.set_xlabel(f"time before {run['end']} (s)", color=INK)
    figure.align_ylabels()
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", metavar="RUN.nc")
    parser.add_argument("-o", "--output", metavar="PNG")
    options = parser.parse_args()
    output = options.output or os.path.splitext(options.run)[0] + "-rg.png"
    try:
        run = read(options.run)
    except OSError as wrong:
        sys.exit(f"rg_in_time: {options.run}: {wrong.strerror or wrong}")
    if not run["slip_fraction"].any():
        sys.exit(f"rg_in_time: {options.run}: no cell slips in it")
    try:
        draw(run, output)
    except OSError as wrong:
        sys.exit(f"rg_in_time: {output}: {wrong.strerror}")
    print(output)


if __name__ == "__main__":
    main()
