#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures for a publication: of a run, or those of the paper made again.

    tools/plot/lacuna_plot.py RUN.nc [-o FOLDER] [--format pdf|svg|png] [--compare SERIES.csv ...]
    tools/plot/lacuna_plot.py --paper FOLDER [--format pdf|svg|png] [--quick]

Of a run: RUN-motion, -forecasts, -cells, -scales, -events and -solver, 174 mm wide, those for which the file holds
something. Readings, forecasts and the b-value are those of the page of `lacuna report`, which is called for them;
--no-forecasts leaves them out. The paper is Borri-Brunetto, Carpinteri and Chiaia (2004), docs/paper-figures.md.
In Python: `import lacuna_plot; lacuna_plot.motion(dataset)`.
"""

import argparse
import os
import sys

# first: it says what is missing
from figures import (BLUE, DAY, INK, LENGTHS, QUIET, RED, ROOT, SLIP, SPANS, STYLE, WIDTH, YEAR, length, matplotlib, np,
                     open_file, panel, plain_ticks, plt, save, span, stop, unit_of)
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.patches import Patch
from plot_forecasts import Clock, before_end, draw_window, forecasts, has_failed, has_forecasts, page_of, readings, seconds_of

INVERSE = {"year/m": YEAR, "day/m": DAY, "h/m": 3600.0, "s/m": 1.0}
SLIPS = 10  # a cell slips where it is as many times faster than the mean at the start, as on the page


# --- What is drawn


def open_run(path):
    """A run's file, times in seconds."""
    run = open_file(path, "slip_rate", "time")
    if run.sizes["time"] < 2:
        stop(f"{path}: fewer than two records: nothing to draw")
    return run


def time_to_end(axes, run, first=None):
    """Time before the end, logarithmic where that is more than a decade; the records to be drawn on it."""
    before = before_end(run)
    least, most = before[before > 0].min(), first or before[0]
    wide = most > 10 * least
    if wide:
        axes.set_xscale("log")
        axes.xaxis.set_major_locator(matplotlib.ticker.LogLocator(numticks=5))
        axes.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    axes.set_xlim(most, least if wide else 0)
    axes.set_xlabel(f"time before {'failure' if has_failed(run) else 'the last record'} (s)")
    return np.flatnonzero(before > 0) if wide else np.arange(len(before))


def line(axes, x, y, **how):
    """A line; where there are few points, with the points."""
    axes.plot(x, y, marker="o" if np.isfinite(y).sum() <= 12 else None, ms=2.5, **how)


def motion(run, page=None):
    """Creep curve, slip rate and inverse rate; readings and the window of failure where `page` has them."""
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.5), layout="constrained")
    clock = Clock(run)
    draw_creep(axes[0], run, page, clock)
    draw_rate(axes[1], run, page, clock)
    draw_inverse(axes[2], run, page, clock)
    return figure


def mark_failure(axes, run, clock):
    if has_failed(run):
        axes.axvline(clock.at(clock.last), color=INK, lw=0.7, ls=(0, (5, 2)), zorder=1)


def draw_creep(axes, run, page, clock):
    seconds, slip = seconds_of(run), run["slip"].values
    # the slip of the failure itself would flatten the creep
    top = np.nanmax(slip) if not has_failed(run) else np.interp(seconds[-1] - 3e-3 * np.ptp(seconds), seconds, slip)
    time, value, name = readings(page, clock, "displacement")
    low = min(0, np.nanmin(slip))
    if time is not None:
        top, low = max(top, np.nanmax(value)), min(low, 1.05 * np.nanmin(value))
    unit, size = unit_of(1.15 * top, LENGTHS)
    if time is not None:
        axes.plot(clock.at(time), value / size, "o", ms=2.5, mfc="none", mec=RED, mew=0.7, label=name)
    line(axes, clock.at(seconds), slip / size, color=INK, label="run")
    axes.set_ylim(low / size, 1.15 * top / size if top > 0 else 1)
    axes.set_ylabel(f"mean slip ({unit})")
    clock.axis(axes)
    mark_failure(axes, run, clock)
    window = draw_window(axes, page, clock)
    if time is not None or window:
        handles, names = axes.get_legend_handles_labels()
        axes.legend(handles + ([window[0]] if window else []), names + (["failure as forecast"] if window else []), loc="upper left",
                    handlelength=1.2, borderaxespad=0.1)
    panel(axes, "a", "creep")


def draw_rate(axes, run, page, clock):
    rate, fastest = run["slip_rate"].values, run["max_slip_rate"].values
    if has_failed(run):  # decades before it
        shown, x = time_to_end(axes, run), before_end(run)
    else:
        shown, x = slice(None), clock.at(seconds_of(run))
        clock.axis(axes)
    if (fastest > 1.05 * rate).any():
        line(axes, x[shown], fastest[shown], color=SLIP, lw=0.6, label="fastest cell")
    line(axes, x[shown], rate[shown], color=INK, label="mean")
    limits = [rate[rate > 0].min(initial=np.inf), max(fastest.max(), rate.max())]
    time, value, name = readings(page, clock, "rate")
    if time is not None:
        place = clock.last - time if has_failed(run) else clock.at(time)
        there = (value > 0) & (time < clock.last)
        axes.plot(place[there], value[there], "o", ms=2.5, mfc="none", mec=RED, mew=0.7, label=name)
        limits = [min([limits[0], *value[there]]), max([limits[1], *value[there]])]
    if 0 < limits[0] <= limits[1] < np.inf:
        axes.set_yscale("log")
        room = 1 if has_failed(run) else (limits[1] / limits[0]) ** 0.35  # of cycles no place is free but above
        axes.set_ylim(limits[0] / 3, limits[1] * 3 * room)
    axes.set_ylabel("slip rate (m/s)")
    if len(axes.get_lines()) > 1:
        axes.legend(loc="best" if has_failed(run) else "upper left", handlelength=1.2)
    panel(axes, "b", "slip rate")


def draw_inverse(axes, run, page, clock):
    seconds, rate = seconds_of(run), run["slip_rate"].values
    moving = np.flatnonzero(rate > 0)
    if not moving.size:
        panel(axes, "c", "inverse rate")
        axes.text(0.5, 0.5, "nothing moves", ha="center", transform=axes.transAxes)
        return
    top = np.nanmax(1 / rate[moving])
    unit, size = unit_of(top, INVERSE)
    line(axes, clock.at(seconds[moving]), 1 / rate[moving] / size, color=INK)
    time, value, name = readings(page, clock, "rate")
    if time is not None and (value > 0).any():
        axes.plot(clock.at(time[value > 0]), 1 / value[value > 0] / size, "o", ms=2.5, mfc="none", mec=RED, mew=0.7)
    axes.set_ylim(0, 1.08 * top / size)
    axes.set_ylabel(f"inverse rate ({unit})")
    clock.axis(axes)
    mark_failure(axes, run, clock)
    window = draw_window(axes, page, clock)
    panel(axes, "c", f"forecast {window[1]} before" if window else "inverse rate")


# --- Cells and scales


def has_cells(run, _page=None):
    return "cell_slip_rate" in run and run.sizes.get("snapshot", 0) > 0 and run.sizes["cell"] > 1


def raster(run, values):
    """Values of the contact cells on their grid, NaN elsewhere."""
    nx, ny = int(run.attrs["grid_nx"]), int(run.attrs["grid_ny"])
    field = np.full((ny, nx), np.nan)
    column = np.clip((run["x"].values / run.attrs["grid_dx_m"]).astype(int), 0, nx - 1)
    row = np.clip((run["y"].values / run.attrs["grid_dy_m"]).astype(int), 0, ny - 1)
    field[row, column] = values
    return field


def choose_snapshots(run, count):
    """The last one, and others evenly spaced in the logarithm of the time left; the time left of each [s]."""
    left = np.maximum(float(run["time"].values[-1]) - run["snapshot_time"].values, 0.0)
    positive = left[left > 0]
    chosen = {len(left) - 1}
    if count > 1 and positive.size:
        for wanted in np.geomspace(positive.max(), positive.min(), count if left[-1] > 0 else count - 1):
            chosen.add(int(np.argmin(np.abs(np.log(np.maximum(left, 1e-300) / wanted)))))
    return sorted(chosen), left


def norm_of(rates):
    """Colours for slip rates, logarithmic."""
    good = rates[np.isfinite(rates) & (rates > 0)]
    return LogNorm(good.min(), max(good.max(), 1.001 * good.min())) if good.size else LogNorm(1e-12, 1)


def key_of_states(axes, x=0.0):
    """Above the axes."""
    axes.legend(handles=[Patch(color="black", label="sticks"), Patch(color=SLIP, label="slips")], loc="lower left", ncol=2,
                bbox_to_anchor=(x, 1), handlelength=1, borderaxespad=0.2, columnspacing=1)


def edges_between(values, scale=np.asarray, back=np.asarray):
    """Where one value's part ends and the next one's begins, halfway on a scale."""
    at = scale(np.asarray(values, dtype=float))
    middle = (at[1:] + at[:-1]) / 2
    return back(np.concatenate(([at[0]], middle, [at[-1]])))


def line_cells(run):
    """Of a line: place across, time up, of a run that failed the time left, logarithmic; all snapshots."""
    rates = run["cell_slip_rate"].values
    left = np.maximum(float(run["time"].values[-1]) - run["snapshot_time"].values, 0.0)
    failed = has_failed(run) and (left > 0).sum() > 1
    if failed:  # the failure itself stands a half decade past the last before it
        upright = edges_between(np.where(left > 0, left, left[left > 0].min() / 3), np.log, np.exp)
    else:
        name, size = unit_of(float(run["snapshot_time"].values[-1]), SPANS, 2)
        upright = edges_between(run["snapshot_time"].values / size)
    unit, metres = unit_of(run.attrs["grid_nx"] * run.attrs["grid_dx_m"], LENGTHS)
    across = np.arange(int(run.attrs["grid_nx"]) + 1) * run.attrs["grid_dx_m"] / metres
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 2.9), sharex=True, sharey=True, layout="constrained")
    rows = np.array([raster(run, rate)[0] for rate in rates])
    states = np.where(np.isfinite(rows), (rows > SLIPS * float(run["slip_rate"].values[0])).astype(float), np.nan)
    picture = axes[0].pcolormesh(across, upright, rows, norm=norm_of(rates), cmap="viridis", rasterized=True)
    axes[1].pcolormesh(across, upright, states, cmap=ListedColormap(["black", SLIP]), vmin=0, vmax=1, rasterized=True)
    if failed:
        axes[0].set_yscale("log")
        axes[0].set_ylim(upright[0], upright[-1])
    axes[0].set_ylabel("time before failure (s)" if failed else f"time ({name})")
    for ax, letter, text in zip(axes, "ab", ("slip rate", "")):
        ax.set_xlabel(f"x ({unit})")
        panel(ax, letter, text)
    figure.colorbar(picture, ax=axes[0], label="slip rate (m/s)", pad=0.02)
    key_of_states(axes[1], 0.08)
    return figure


def cells(run, page=None, count=4):
    """Slip rates of the contact domain on the way to the end, and which cells stick and slip."""
    if run.attrs["grid_ny"] == 1 and run.sizes["snapshot"] > 1:
        return line_cells(run)
    chosen, left = choose_snapshots(run, count)
    rates = run["cell_slip_rate"].isel(snapshot=chosen).values
    norm = norm_of(rates)
    width, height = run.attrs["grid_nx"] * run.attrs["grid_dx_m"], run.attrs["grid_ny"] * run.attrs["grid_dy_m"]
    unit, size = unit_of(width, LENGTHS)
    strip = height < width / 8
    columns = max(len(chosen), 2)
    tall = 0.9 if strip else min(3.0, 0.76 * WIDTH / columns * height / width)
    figure, axes = plt.subplots(2, len(chosen), figsize=(WIDTH if len(chosen) > 1 else WIDTH / 2, 2 * tall + 0.8), squeeze=False, sharex=True,
                                sharey=True, layout="constrained")
    how = {"origin": "lower", "extent": (0, width / size, 0, height / size), "interpolation": "nearest", "rasterized": True,
           "aspect": "auto" if strip else "equal"}
    limit = SLIPS * float(run["slip_rate"].values[0])
    for column, (k, rate) in enumerate(zip(chosen, rates)):
        picture = axes[0][column].imshow(raster(run, rate), norm=norm, cmap="viridis", **how)
        state = np.where(np.isfinite(rate), (rate > limit).astype(float), np.nan)
        axes[1][column].imshow(raster(run, state), cmap=ListedColormap(["black", SLIP]), vmin=0, vmax=1, **how)
        end = "failure" if has_failed(run) else "the end"
        panel(axes[0][column], "abcdefghijkl"[column], f"{span(left[k])} left" if left[k] > 0 else f"at {end}")
        axes[1][column].set_xlabel(f"x ({unit})")
        for ax in axes[:, column]:
            ax.spines[["top", "right"]].set_visible(True)
    for row in axes:
        row[0].set_ylabel(f"y ({unit})")
    figure.colorbar(picture, ax=axes, label="slip rate (m/s)", aspect=24, pad=0.02)
    key_of_states(axes[1][0])
    return figure


def has_scales(run, _page=None):
    return "n_slip" in run and bool((run["slip_fraction"].fillna(0) > 0).any()) and run.sizes["level"] > 1


def scales(run, page=None):
    """Slipping part of the blocks of each size, correlation length, renormalization map."""
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.6), layout="constrained")
    part = (run["n_slip"] / run["n_tot"]).values
    levels = [k for k in range(part.shape[1]) if part[:, k].any()]
    colours = dict(zip(levels, plt.get_cmap("viridis")(np.linspace(0, 0.9, len(levels)))))
    before = before_end(run)
    first = min(before[0], 3 * max(before[int(np.argmax(part[:, 0] > 0))], before[before > 0].min()))
    shown = time_to_end(axes[0], run, first)
    for k in levels:
        axes[0].step(before[shown], part[shown, k], where="post", color=colours[k], lw=0.8, label=length(float(run["block_size"][k])))
    axes[0].set_ylabel("$N_{slip}/N_{tot}$")
    axes[0].set_ylim(0, 1.02)
    axes[0].legend(title="blocks of", ncol=2 if len(levels) > 4 else 1, handlelength=1, columnspacing=0.8, labelspacing=0.2,
                   loc="upper left", borderaxespad=0)
    panel(axes[0], "a", "slip at each scale")
    time_to_end(axes[1], run, first)
    axes[1].step(before[shown], run["correlation_length"].where(run["correlation_length"] > 0).values[shown], where="post", color=INK, lw=0.8)
    axes[1].set_yscale("log")
    plain_ticks(axes[1].yaxis)
    axes[1].set_ylabel("correlation length (m)")
    panel(axes[1], "b", "correlation length")
    draw_map(axes[2], run, part, colours)
    return figure


def draw_map(axes, run, part, colours):
    axes.plot((0, 1), (0, 1), color=QUIET, lw=0.6, ls=(0, (4, 3)))
    for k, colour in colours.items():
        slips = part[:, k] > 0
        if k + 1 < part.shape[1] and float(run["n_tot"][k + 1]) >= 8 and slips.any():
            axes.plot(part[slips, k], part[slips, k + 1], color=colour, lw=0.7)
            axes.plot(part[slips, k][-1], part[slips, k + 1][-1], "o", ms=3, color=colour)
    given = "given" in run["critical_fraction"].attrs.get("comment", "") if "critical_fraction" in run else False
    for name, colour, mark, text in (("critical_fraction", RED, "D", "given" if given else "cascade"),
                                     ("run_critical_fraction", BLUE, "s", "run")):
        value = float(run[name]) if name in run else np.nan
        if np.isfinite(value):
            axes.plot(value, value, mark, ms=5, mfc="white", mec=colour, mew=1.2, label=f"$C$ = {value:.2f}, {text}", clip_on=False, zorder=5)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper left", handlelength=0.8, borderaxespad=0)
    axes.set(xlim=(0, 1), ylim=(0, 1), xlabel="$s$ of blocks of a size", ylabel="$s'$ of blocks twice the size")
    axes.set_box_aspect(1)
    panel(axes, "c", "renormalization")


# --- Events and the integrator


def has_events(run, _page=None):
    return run.sizes.get("event", 0) > 0


def events(run, page=None):
    """The catalogue in time, and how many events are at least as large as what."""
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 2.6), layout="constrained")
    moment = "event_moment" in run and bool(np.isfinite(run["event_moment"].values).any())
    size = run["event_moment" if moment else "event_potency"].values
    name = "moment (N m)" if moment else "potency (m³)"
    left = clip_positive(before_of_events(run))
    extent = run["event_size"].values
    axes[0].scatter(left, size, s=2 + 30 * np.nan_to_num(extent / np.nanmax(extent)), color=BLUE, alpha=0.5, lw=0, rasterized=len(size) > 2000)
    axes[0].set(xscale="log", yscale="log", ylabel=name, xlabel=f"time before {'failure' if has_failed(run) else 'the last record'} (s)")
    axes[0].invert_xaxis()
    panel(axes[0], "a", f"{len(size)} events, circles grow with their length")
    ordered = np.sort(size[size > 0])[::-1]
    axes[1].plot(ordered, np.arange(1, len(ordered) + 1), ".", ms=3, color=BLUE, rasterized=len(size) > 5000)
    axes[1].set(xscale="log", yscale="log", xlabel=name, ylabel="events at least as large")
    found = (page or {}).get("events", {}).get("b_value", {})
    if moment and not found.get("reason", "none") and found.get("b"):
        draw_b(axes[1], ordered, found)
    panel(axes[1], "b", "sizes")
    return figure


def before_of_events(run):
    return float(run["time"].values[-1]) - run["event_time"].values


def clip_positive(values):
    positive = values[values > 0]
    return np.maximum(values, positive.min() if positive.size else 1e-9)


def draw_b(axes, ordered, found):
    """Gutenberg and Richter's law with the b of the page: magnitude (log10 M - 9.1)/1.5."""
    first = 10 ** (1.5 * found["complete_from"] + 9.1)
    count = int((ordered >= 0.999 * first).sum())
    reach = np.array([first, min(ordered[0], first * count ** (1.5 / found["b"]))])
    axes.plot(reach, count * (reach / first) ** (-found["b"] / 1.5), color=RED, label=f"$b$ = {found['b']:.2f} ± {found['error']:.2f}")
    axes.legend(loc="lower left")


def solver(run, page=None):
    """Step size, order and balance residual."""
    figure, axes = plt.subplots(1, 3, figsize=(WIDTH, 2.3), layout="constrained")
    before = before_end(run)
    for ax, name, text, letter in ((axes[0], "step_size", "step (s)", "a"), (axes[1], "order", "order of the method", "b"),
                                   (axes[2], "balance_residual", "balance residual", "c")):
        shown = time_to_end(ax, run)
        values = run[name].values[shown].astype(float)
        values[~(values > 0)] = np.nan
        line(ax, before[shown], values, color=INK, lw=0.7)
        least, most = np.nanmin(values, initial=np.inf), np.nanmax(values, initial=0)
        if name == "order":
            ax.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True, min_n_ticks=1))
        elif most > 3 * least:
            ax.set_yscale("log")
            plain_ticks(ax.yaxis)
        elif most > 0:
            ax.set_ylim(0, 1.2 * most)
        else:
            ax.set_ylim(0, 1)
            ax.text(0.5, 0.5, "0 throughout", ha="center", transform=ax.transAxes)
        ax.set_ylabel(text)
        panel(ax, letter, text.split(" (")[0])
    return figure


FIGURES = (("motion", lambda run, page: True, motion), ("forecasts", has_forecasts, forecasts), ("cells", has_cells, cells),
           ("scales", has_scales, scales), ("events", has_events, events),
           ("solver", lambda run, page: "step_size" in run and bool(np.isfinite(run["step_size"].values).any()), solver))


def draw_run(options):
    run = open_run(options.run)
    words = [word for name in ("compare", "time", "time_format", "displacement", "velocity") if getattr(options, name)
             for word in ("--" + name.replace("_", "-"), getattr(options, name))]
    page = page_of(options.program, options.run, *words) if options.compare or not options.no_forecasts else None
    if page and options.no_forecasts:
        page.pop("forecasts", None)
    stem = os.path.splitext(os.path.basename(options.run))[0]
    for name, there, draw in FIGURES:
        if there(run, page):
            figure = draw(run, page, options.snapshots) if name == "cells" else draw(run, page)
            save(figure, os.path.join(options.output, f"{stem}-{name}.{options.format}"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", nargs="?", metavar="RUN.nc")
    parser.add_argument("-o", "--output", default=".", metavar="FOLDER", help="where figures of a run go")
    parser.add_argument("--paper", metavar="FOLDER", help="make the paper's Fig. 1 to 4 there")
    parser.add_argument("--quick", action="store_true", help="smaller interfaces for --paper")
    parser.add_argument("--format", choices=("pdf", "svg", "png"), default="pdf")
    parser.add_argument("--snapshots", type=int, default=4, help="maps of the contact domain, 1 to 6")
    parser.add_argument("--no-forecasts", action="store_true", help="without forecasts of the time of failure")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    beside = parser.add_argument_group("readings beside the run, as for `lacuna report`")
    beside.add_argument("--compare", metavar="SERIES.csv")
    for name, value in (("time", "COLUMN"), ("time-format", "FORMAT"), ("displacement", "COL:UNIT"), ("velocity", "COL:UNIT")):
        beside.add_argument("--" + name, metavar=value)
    options = parser.parse_args()
    if (options.run is None) == (options.paper is None):
        parser.error("either RUN.nc or --paper FOLDER")
    if not 1 <= options.snapshots <= 6:
        parser.error(f'--snapshots: "{options.snapshots}" must be from 1 to 6')
    folder = options.paper or options.output
    if not os.path.isdir(folder):
        stop(f"{folder}: no such folder")
    plt.rcParams.update(STYLE)
    if options.paper:
        import paper_figures

        paper_figures.draw_all(options.program, options.paper, options.format, options.quick)
    else:
        draw_run(options)


if __name__ == "__main__":
    sys.exit(main())
