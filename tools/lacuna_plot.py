#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures for a publication: of a run, or those of the paper made again.

    tools/lacuna_plot.py RUN.nc [-o FOLDER] [--format pdf|svg|png] [--snapshots N]
    tools/lacuna_plot.py --paper FOLDER [--format pdf|svg|png] [--quick]

Of a run: RUN-motion, RUN-cells, RUN-scales, RUN-events and RUN-solver, 174 mm wide, those for which the
file holds something. The paper is Borri-Brunetto, Carpinteri and Chiaia (2004): Fig. 1 and 3 by
tools/figure1.py and tools/figure3.py, Fig. 2 and 4 here, all from what `lacuna` computes; --quick takes
smaller interfaces and fewer of them. In Python: `import lacuna_plot; lacuna_plot.motion(dataset)`.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile

# first: it says what is missing
from figures import BLUE, GREEN, INK, QUIET, RED, ROOT, SLIP, STYLE, np, plt, xarray
from matplotlib.colors import ListedColormap, LogNorm

WIDTH = 174 / 25.4  # two columns [in]
LENGTHS = (("km", 1e3), ("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("µm", 1e-6))
PRESSURES = (2, 5, 10)  # of Fig. 2 [MPa]
SIZES = (5, 6, 7, 8)  # of Fig. 4: levels of the interfaces that slide


def length(value):
    unit, size = next((u for u in LENGTHS if value >= 0.9995 * u[1]), LENGTHS[-1])
    return f"{value / size:.3g} {unit}"


def label(axes, letter, text):
    axes.set_title(f"({letter}) {text}", loc="left")


# --- A run


def open_run(path):
    """A run's file, times as seconds."""
    try:
        run = xarray.open_dataset(path, decode_times=False)
    except (OSError, ValueError) as wrong:
        sys.exit(f"lacuna_plot: {path}: {wrong}")
    if "slip_rate" not in run or run.sizes.get("time", 0) < 2:
        sys.exit(f"lacuna_plot: {path}: no time series of a run in it")
    return run


def before_end(run):
    """Time before the last record [s], exact to the last step."""
    origin, local = run["time_origin"].values, run["time_local"].values
    return (origin[-1] - origin) + (local[-1] - local)


def end_of(run):
    return "failure" if run.attrs.get("failed", 0) else "the last record"


def time_to_end(axes, run):
    """Time before the end on a logarithmic axis that runs to it."""
    before = before_end(run)
    axes.set_xscale("log")
    axes.set_xlim(before[0], before[before > 0].min())
    axes.set_xlabel(f"time before {end_of(run)} (s)")


def motion(run):
    """Creep curve, slip rate and inverse rate."""
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.2), layout="constrained")
    seconds = run["time_origin"].values + run["time_local"].values
    slip, rate = run["slip"].values, run["slip_rate"].values
    unit, size = next((u for u in (("days", 86400.0), ("h", 3600.0), ("s", 1.0)) if seconds[-1] >= 2 * u[1]), ("s", 1.0))
    axes[0].plot(seconds / size, slip, color=INK)
    # the slip of the failure itself would flatten the creep
    top = np.interp(seconds[-1] - 3e-3 * np.ptp(seconds), seconds, slip)
    if top > 0:
        axes[0].set_ylim(0, 1.15 * top)
    axes[0].set_xlabel(f"time ({unit})")
    axes[0].set_ylabel("mean slip (m)")
    label(axes[0], "a", "creep curve")
    axes[1].plot(before_end(run)[:-1], run["max_slip_rate"].values[:-1], color=SLIP, lw=0.6, label="fastest cell")
    axes[1].plot(before_end(run)[:-1], rate[:-1], color=INK, label="mean")
    axes[1].set_yscale("log")
    axes[1].set_ylabel("slip rate (m/s)")
    axes[1].legend(frameon=False)
    time_to_end(axes[1], run)
    label(axes[1], "b", "slip rate")
    moving = rate > 0
    axes[2].plot(seconds[moving] / size, 1 / rate[moving], color=INK)
    axes[2].set_ylim(0)
    axes[2].set_xlabel(f"time ({unit})")
    axes[2].set_ylabel("inverse rate (s/m)")
    label(axes[2], "c", "inverse rate")
    return figure


def has_cells(run):
    return "cell_slip_rate" in run and run.sizes.get("snapshot", 0) > 0 and run.sizes["cell"] > 1


def raster(run, values):
    """Values of the contact cells on their grid, NaN elsewhere."""
    nx, ny = int(run.attrs["grid_nx"]), int(run.attrs["grid_ny"])
    field = np.full((ny, nx), np.nan)
    column = np.clip((run["x"].values / run.attrs["grid_dx_m"]).astype(int), 0, nx - 1)
    row = np.clip((run["y"].values / run.attrs["grid_dy_m"]).astype(int), 0, ny - 1)
    field[row, column] = values
    return field


def cells(run, count=4):
    """Slip rates of the contact domain at times evenly spaced in the logarithm of the time left."""
    times = run["snapshot_time"].values
    left = np.maximum(float(run["time"].values[-1]) - times, 1e-9)
    wanted = np.geomspace(left[0], left[left > 0].min(), count)
    chosen = sorted({int(np.argmin(np.abs(np.log(left / w)))) for w in wanted})
    rates = run["cell_slip_rate"].isel(snapshot=chosen).values
    good = rates[np.isfinite(rates) & (rates > 0)]
    norm = LogNorm(good.min(), max(good.max(), 1.001 * good.min()))
    figure, axes = plt.subplots(1, len(chosen), figsize=(WIDTH, WIDTH / len(chosen) + 0.5), squeeze=False, layout="constrained")
    width, height = run.attrs["grid_nx"] * run.attrs["grid_dx_m"], run.attrs["grid_ny"] * run.attrs["grid_dy_m"]
    for ax, k, rate, letter in zip(axes[0], chosen, rates, "abcdefghijkl"):
        picture = ax.imshow(raster(run, rate), origin="lower", extent=(0, width, 0, height), norm=norm, cmap="viridis",
                            interpolation="nearest", rasterized=True, aspect="auto" if height < width / 8 else "equal")
        label(ax, letter, f"{left[k]:.3g} s before")
        ax.tick_params(labelleft=letter == "a")
        ax.set_xlabel("x (m)")
    axes[0][0].set_ylabel("y (m)")
    figure.colorbar(picture, ax=axes[0], label="slip rate (m/s)", shrink=0.7)
    return figure


def has_scales(run):
    return "n_slip" in run and bool((run["slip_fraction"].fillna(0) > 0).any()) and run.sizes["level"] > 1


def scales(run):
    """Slipping part of the blocks of each size, correlation length, renormalization map."""
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.3), layout="constrained")
    part = (run["n_slip"] / run["n_tot"]).values
    shown = [k for k in range(part.shape[1]) if part[:, k].any()]
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.9, max(1, len(shown))))
    before = before_end(run)
    first = int(np.argmax(part[:, 0] > 0))
    for k, colour in zip(shown, colours):
        axes[0].step(before[:-1], part[:-1, k], where="post", color=colour, lw=0.8, label=length(float(run["block_size"][k])))
    axes[0].set_ylabel("$N_{slip}/N$")
    axes[0].legend(frameon=False, title="blocks of", fontsize=5.5, title_fontsize=6)
    label(axes[0], "a", "slip at each scale")
    axes[1].step(before[:-1], run["correlation_length"].where(run["correlation_length"] > 0).values[:-1], where="post", color=INK)
    axes[1].set_yscale("log")
    axes[1].set_ylabel("correlation length (m)")
    label(axes[1], "b", "correlation length")
    for ax in axes[:2]:
        time_to_end(ax, run)
        ax.set_xlim(min(before[0], 3 * before[first]), before[before > 0].min())
    draw_map(axes[2], run, part, colours)
    return figure


def draw_map(axes, run, part, colours):
    axes.plot((0, 1), (0, 1), color=QUIET, lw=0.6, ls=(0, (4, 3)))
    for k in range(part.shape[1] - 1):
        slips = part[:, k] > 0
        if float(run["n_tot"][k + 1]) >= 8 and slips.any():
            axes.plot(part[slips, k], part[slips, k + 1], color=colours[min(k, len(colours) - 1)], lw=0.6)
    for name, colour, text in (("critical_fraction", RED, "static cascade"), ("run_critical_fraction", GREEN, "this run")):
        value = float(run[name]) if name in run else np.nan
        if np.isfinite(value):
            axes.plot(value, value, "o", ms=5, mfc="none", mec=colour, label=f"C, {text}")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False)
    axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="$s$", ylabel="$s'$ of blocks twice the size")
    label(axes, "c", "renormalization")


def has_events(run):
    return run.sizes.get("event", 0) > 0


def events(run):
    """The catalogue in time, and how many events are larger than what."""
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 2.3), layout="constrained")
    potency = run["event_potency"].values
    failed = bool(run.attrs.get("failed", 0))
    time = run["event_time"].values
    axes[0].scatter(np.maximum(float(run["time"].values[-1]) - time, 1e-9) if failed else time, potency, s=2 + 30 * run["event_size"].values / np.nanmax(run["event_size"].values),
                    color=BLUE, alpha=0.5, lw=0)
    axes[0].set(yscale="log", xlabel="time before failure (s)" if failed else "time (s)", ylabel="potency (m³)")
    if failed:
        axes[0].set_xscale("log")
        axes[0].invert_xaxis()
    label(axes[0], "a", f"{len(potency)} events")
    ordered = np.sort(potency[potency > 0])[::-1]
    axes[1].plot(ordered, np.arange(1, len(ordered) + 1), ".", ms=3, color=BLUE)
    axes[1].set(xscale="log", yscale="log", xlabel="potency (m³)", ylabel="events at least as large")
    label(axes[1], "b", "sizes")
    return figure


def solver(run):
    """Step size, order and balance residual."""
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.0), layout="constrained")
    before = before_end(run)[:-1]
    for ax, name, text, scale, letter in ((axes[0], "step_size", "step (s)", "log", "a"), (axes[1], "order", "order", "linear", "b"),
                                          (axes[2], "balance_residual", "balance residual", "log", "c")):
        values = run[name].values[:-1].astype(float)
        ax.plot(before, np.where(values > 0, values, np.nan), color=INK, lw=0.7)
        ax.set_yscale(scale)
        ax.set_ylabel(text)
        time_to_end(ax, run)
        label(ax, letter, text.split(" (")[0])
    return figure


FIGURES = (("motion", lambda run: True, motion), ("cells", has_cells, cells), ("scales", has_scales, scales),
           ("events", has_events, events), ("solver", lambda run: "step_size" in run, solver))


def save(figure, path):
    try:
        figure.savefig(path)
    except OSError as wrong:
        sys.exit(f"lacuna_plot: {path}: {wrong.strerror}")
    plt.close(figure)
    print(path)


def draw_run(options):
    run = open_run(options.run)
    stem = os.path.splitext(os.path.basename(options.run))[0]
    for name, there, draw in FIGURES:
        if there(run):
            figure = draw(run, options.snapshots) if name == "cells" else draw(run)
            save(figure, os.path.join(options.output, f"{stem}-{name}.{options.format}"))


# --- The paper


def call(program, *words):
    """The JSON that a command prints."""
    done = subprocess.run([program, *words, "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"lacuna_plot: {done.stderr.strip()}")
    return json.loads(done.stdout)


def figure2(program, levels, folder):
    """Contact domains of a rough joint under three mean pressures, with their box dimensions."""
    figure, axes = plt.subplots(1, len(PRESSURES), figsize=(WIDTH, WIDTH / 3 + 0.4), layout="constrained")
    case = os.path.join(ROOT, "cases/contact/joint.yaml")
    for ax, mega, letter in zip(axes, PRESSURES, "abc"):
        path = os.path.join(folder, f"contact-{mega}.nc")
        found = call(program, "contact", case, "--set", f"load.normal.pressure={mega} MPa", "--set", f"interface.levels={levels}",
                     "-o", path, "--force")
        with xarray.open_dataset(path) as data:
            size = float(data.attrs["grid_nx"] * data.attrs["grid_dx_m"]) if "grid_nx" in data.attrs else 1.0
            ax.imshow(data["pressure"].values > 0, origin="lower", extent=(0, size, 0, size), cmap=ListedColormap(["white", INK]),
                      interpolation="nearest", rasterized=True)
        label(ax, letter, f"{mega} MPa, $D$ = {found['d_box']:.2f} ± {found['d_box_error']:.2f}")
        ax.set_xlabel("x (m)")
        ax.tick_params(labelleft=letter == "a")
    axes[0].set_ylabel("y (m)")
    return figure


def draw_sizes(axes, found):
    """Strength over size from the measured dimension, beside the exponents that the paper fitted."""
    exponent, error = 2 - found["delta_s"], found["delta_s_error"]
    side = np.geomspace(0.05, 1, 30) / 0.05
    axes.plot(0.05 * side, side**-exponent, color=INK, label=f"this joint, $\\Delta_S$ = {found['delta_s']:.2f}")
    axes.fill_between(0.05 * side, side ** -(exponent + error), side ** -(exponent - error), color=INK, alpha=0.15, lw=0)
    sets = [row for row in found["published_exponents"] if "Bandis et al. 1981" in row["source"]]
    for row, colour, name in zip(sets, (BLUE, RED), ("first", "second")):
        axes.plot(0.05 * side, side ** -row["exponent_low"], color=colour, ls=(0, (4, 3)),
                  label=f"Bandis, {name} set: {2 - row['exponent_low']:.2f}")
    axes.set(xscale="log", yscale="log", xlabel="side of the specimen (m)", ylabel="strength over that of 5 cm")
    axes.legend(frameon=False)
    label(axes, "a", "size effect")


def draw_onset(axes, program, levels, folder):
    """How the part that sticks falls with the load, in the cascade on interfaces of several sizes."""
    case = os.path.join(ROOT, "cases/rg/rough-joint.yaml")
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(levels)))
    for level, colour in zip(levels, colours):
        path = os.path.join(folder, f"rg-{level}.nc")
        call(program, "rg", case, "--set", f"interface.levels={level}", "-o", path, "--force")
        with xarray.open_dataset(path) as data:
            axes.plot(data["load"].values, 1 - data["slip_fraction"].isel(beta=0, level=0).values, color=colour,
                      label=f"{2**level} cells a side")
    axes.set(xlabel="$Q/Q_{nom}$", ylabel="part that sticks", ylim=(0, 1.02))
    axes.legend(frameon=False)
    label(axes, "b", "the end of sticking")


def figure4(program, quick, folder):
    """The size effect on strength, and how sticking ends on interfaces of several sizes."""
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 2.6), layout="constrained")
    case = os.path.join(ROOT, "cases/contact/self-affine.yaml")
    found = call(program, "contact", case, "--set", f"interface.levels={9 if quick else 10}", "-o",
                 os.path.join(folder, "sizes.nc"), "--force")
    draw_sizes(axes[0], found)
    draw_onset(axes[1], program, SIZES[:3] if quick else SIZES, folder)
    return figure


def run_tool(name, *words):
    done = subprocess.run([sys.executable, os.path.join(ROOT, "tools", name), *words], check=False)
    if done.returncode != 0:
        sys.exit(f"lacuna_plot: tools/{name} failed")


def draw_paper(options):
    def path(k):
        return os.path.join(options.paper, f"figure{k}.{options.format}")

    quick1 = ("--set", "interface.levels=8", "--coarsest", "32") if options.quick else ()
    quick3 = ("--seeds", "2", "--levels", "6") if options.quick else ()
    with tempfile.TemporaryDirectory(prefix="lacuna-plot-") as folder:
        run_tool("figure1.py", "--program", options.program, "-o", path(1), *quick1)
        save(figure2(options.program, 8 if options.quick else 10, folder), path(2))
        run_tool("figure3.py", "--program", options.program, "-o", path(3), *quick3)
        save(figure4(options.program, options.quick, folder), path(4))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", nargs="?", metavar="RUN.nc")
    parser.add_argument("-o", "--output", default=".", metavar="FOLDER", help="where figures of a run go")
    parser.add_argument("--paper", metavar="FOLDER", help="make the paper's Fig. 1 to 4 there")
    parser.add_argument("--quick", action="store_true", help="smaller interfaces for --paper")
    parser.add_argument("--format", choices=("pdf", "svg", "png"), default="pdf")
    parser.add_argument("--snapshots", type=int, default=4, help="maps of the contact domain")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    options = parser.parse_args()
    if (options.run is None) == (options.paper is None):
        parser.error("either RUN.nc or --paper FOLDER")
    if not 1 <= options.snapshots <= 12:
        parser.error(f'--snapshots: "{options.snapshots}" must be from 1 to 12')
    folder = options.paper or options.output
    if not os.path.isdir(folder):
        sys.exit(f"lacuna_plot: {folder}: no such folder")
    plt.rcParams.update(STYLE)
    draw_paper(options) if options.paper else draw_run(options)


if __name__ == "__main__":
    main()
