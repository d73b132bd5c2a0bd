#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a run: the creep curve, the slip rate, and the inverse rate on the way to failure.

    tools/plot/plot_run.py RUN.nc [-o RUN.png]
    tools/plot/plot_run.py RUN.nc --observed prism.csv --time date --displacement disp_mm:mm
    tools/plot/plot_run.py RUN.nc --observed anchors.csv --time date --velocity rate:cm/day

Observations are CSV with a header and # comment lines; dates are ISO 8601, read as UTC.
"""

import argparse
import csv
import os
from datetime import timedelta

# first: it says what is missing
from figures import DAY, FAINT, FAST, INK, QUIET, SEEN, YEAR, date_ticks, matplotlib, np, open_file, parse_date, plt, save, start_of, stop, use_screen_style

WEEK = 7 * DAY
LENGTHS = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3}
TIMES = {"s": 1.0, "min": 60.0, "h": 3600.0, "hour": 3600.0, "day": DAY, "week": WEEK, "year": YEAR}
LANDMARKS = [
    (1e-2 / YEAR, "1 cm/year"),
    (1e-2 / WEEK, "1 cm/week"),
    (1e-2 / DAY, "1 cm/day"),
    (1.0 / DAY, "1 m/day"),
    (1.0 / 3600.0, "1 m/h"),
    (1.0, "1 m/s"),
]


class Run:
    """What is drawn of a run; times in seconds since its start."""

    def __init__(self, path):
        with open_file(path) as data:
            if "slip_rate" not in data or data.sizes.get("time", 0) < 2:
                stop(f"{path}: no time series of a run in it")
            self.seconds = (data["time_origin"] + data["time_local"]).values
            self.before_last = (
                data["time_origin"][-1] - data["time_origin"] + data["time_local"][-1]
            ).values - data["time_local"].values
            self.slip = data["slip"].values
            self.rate = data["slip_rate"].values
            self.fastest = data["max_slip_rate"].values
            self.title = data.attrs.get("title", os.path.basename(path))
            self.status = data.attrs.get("status", "unknown")
            self.failed = bool(data.attrs.get("failed", 0))
            self.start = start_of(data)
        self.unit = 1.0 if self.start else scale_of(self.seconds[-1], TIMES, ("s", "h", "day", "year"))

    def axis(self, seconds):
        """Times as the axis shows them: dates, or a unit that suits the run."""
        if self.start is None:
            return np.asarray(seconds) / self.unit
        origin = matplotlib.dates.date2num(self.start)
        return origin + np.asarray(seconds) / DAY


class Observed:
    """A monitoring series; times in seconds since the run's start."""

    def __init__(self, run, path, time, displacement, velocity, label):
        self.label = label or os.path.splitext(os.path.basename(path))[0]
        with open(path, encoding="utf-8-sig", newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        if not rows:
            stop(f"{path}: no readings")
        for column in filter(None, (time, displacement and displacement[0], velocity and velocity[0])):
            if column not in rows[0]:
                stop(f'{path}: no column "{column}"; it has: {", ".join(rows[0])}')
        self.seconds = np.array([self.when(run, row[time]) for row in rows])
        self.slip = self.column(rows, displacement)
        self.rate = self.column(rows, velocity)
        read = [np.isfinite(values) for values in (self.slip, self.rate) if values is not None]
        given = self.seconds[np.logical_or.reduce(read) & np.isfinite(self.seconds)]
        if not given.size:
            stop(f"{path}: no readings in the columns named")
        self.first, self.last = given.min(), given.max()

    @staticmethod
    def when(run, text):
        if run.start is None:
            return float(text)
        date = parse_date(text)
        return (date - run.start).total_seconds() if date else np.nan

    @staticmethod
    def column(rows, named):
        if named is None:
            return None
        name, factor = named
        values = []
        for row in rows:
            try:
                values.append(float(row[name]) * factor)
            except (TypeError, ValueError):
                values.append(np.nan)
        return np.array(values)


def named_column(text):
    """NAME:UNIT, the unit a length or a length per time."""
    name, _, unit = text.rpartition(":")
    length, _, time = unit.partition("/")
    if not name or length not in LENGTHS or (time and time not in TIMES):
        raise argparse.ArgumentTypeError(f'"{text}" must be NAME:UNIT, such as disp:mm or rate:cm/day')
    return name, LENGTHS[length] / (TIMES[time] if time else 1.0)


def scale_of(value, table, names):
    """The largest of the named units in which the value is at least 2."""
    fitting = [table[name] for name in names if value >= 2 * table[name]]
    return fitting[-1] if fitting else table[names[0]]


def name_of(value, table):
    return next(name for name, size in table.items() if size == value)


def time_axis(axes, run, seconds):
    axes.set_xlim(*run.axis(seconds))
    if run.start is None:
        axes.set_xlabel(f"time ({name_of(run.unit, TIMES)})")
        return
    date_ticks(axes.xaxis, 3, 5)


def mark_failure(axes, run):
    if run.failed:
        axes.axvline(run.axis(run.seconds[-1]), color=SEEN, lw=0.8, ls=(0, (4, 3)), zorder=1)


def draw_slip(axes, run, observed, window):
    # The slip of the failure itself would flatten the creep: the axis ends just before it.
    creep = np.interp(run.seconds[-1] - 3e-3 * np.ptp(run.seconds), run.seconds, run.slip)
    top = 1.15 * max(creep, 1e-12)
    seen = observed is not None and observed.slip is not None
    if seen:
        top = max(top, 1.1 * np.nanmax(observed.slip))
    unit = scale_of(top, LENGTHS, ("um", "mm", "cm", "m"))
    axes.plot(run.axis(run.seconds), run.slip / unit, color=INK, lw=1.6, label="model", zorder=3)
    if seen:
        axes.plot(run.axis(observed.seconds), observed.slip / unit, "o", ms=3.2, mfc="none",
                  mec=SEEN, mew=0.9, label=observed.label, zorder=2)
        axes.legend(loc="upper left")
    axes.set_ylim(min(0, np.nanmin(observed.slip) / unit if seen else 0), top / unit)
    axes.set_ylabel(f"mean slip ({name_of(unit, LENGTHS)})")
    axes.set_title("creep")
    time_axis(axes, run, window)
    mark_failure(axes, run)


def draw_rate(axes, run, observed, window):
    if np.any(run.fastest > 1.05 * run.rate):
        axes.plot(run.axis(run.seconds), run.fastest, color=FAST, lw=1.0, label="fastest cell")
    axes.plot(run.axis(run.seconds), run.rate, color=INK, lw=1.6, label="mean")
    values = [run.rate[run.rate > 0].min(), run.fastest.max()]
    if observed is not None and observed.rate is not None:
        axes.plot(run.axis(observed.seconds), observed.rate, "o", ms=4.5, mfc="white", mec=SEEN,
                  mew=1.2, label=observed.label, zorder=4)
        shown = observed.rate[observed.rate > 0]
        values += [shown.min(), shown.max()] if shown.size else []
    axes.set_yscale("log")
    axes.set_ylim(min(values) / 3, max(values) * 3)
    last = -np.inf
    for rate, name in LANDMARKS:
        if axes.get_ylim()[0] < rate < axes.get_ylim()[1] and rate > 4 * last:
            axes.axhline(rate, color=FAINT, lw=0.8, zorder=0)
            axes.annotate(name, (1.02, rate), xycoords=("axes fraction", "data"), va="center",
                          fontsize=7.5, color=QUIET, annotation_clip=False)
            last = rate
    axes.set_ylabel("slip rate (m/s)")
    axes.set_title("slip rate")
    axes.legend(loc="best")
    time_axis(axes, run, window)
    mark_failure(axes, run)


def draw_inverse(axes, run):
    before = run.before_last
    # From where the rate has left its least value for good, to the end.
    low = int(np.argmin(run.rate))
    risen = np.nonzero(run.rate[low:] > 3 * run.rate[low])[0]
    first = low + int(risen[0]) if risen.size and run.failed else 0
    span = max(before[first], 1e-12)
    unit = scale_of(span, TIMES, ("s", "min", "h", "day", "year"))
    inverse = 1.0 / run.rate
    per = scale_of(inverse[first], {"s/m": 1.0, "h/m": 3600.0, "day/m": DAY, "year/m": YEAR},
                   ("s/m", "h/m", "day/m", "year/m"))
    per_name = {1.0: "s/m", 3600.0: "h/m", DAY: "day/m", YEAR: "year/m"}[per]
    axes.plot(before[first:] / unit, inverse[first:] / per, color=INK, lw=1.6)
    axes.set_xlim(span / unit, 0)
    axes.set_ylim(0, 1.08 * inverse[first:].max() / per)
    last = "failure" if run.failed else "the end"
    axes.set_xlabel(f"time before {last} ({name_of(unit, TIMES)})")
    axes.set_ylabel(f"1 / mean slip rate ({per_name})")
    axes.set_title("inverse rate")


def describe(run):
    length = run.seconds[-1]
    unit = scale_of(length, TIMES, ("s", "min", "h", "day", "year"))
    text = f"{length / unit:.4g} {name_of(unit, TIMES)}"
    if not run.failed:
        return f"no failure in {text} (run {run.status})"
    if run.start is None:
        return f"failure after {text}"
    date = run.start + timedelta(seconds=float(length))
    return f"failure after {text}, on {date:%Y-%m-%d %H:%M} UTC"


def draw(run, observed, path):
    use_screen_style()
    window = [run.seconds[0], run.seconds[-1] + 0.03 * np.ptp(run.seconds)]
    if observed is not None:
        window[0] = min(window[0], observed.first)
        window[1] = max(window[1], observed.last + 0.03 * np.ptp(run.seconds))
    figure, panels = plt.subplots(1, 3, figsize=(10.5, 3.5), layout="constrained")
    figure.suptitle(run.title, x=0.008, ha="left", fontsize=11, fontweight="bold")
    figure.get_layout_engine().set(wspace=0.06)
    draw_slip(panels[0], run, observed, window)
    draw_rate(panels[1], run, observed, window)
    draw_inverse(panels[2], run)
    figure.text(0.992, 0.985, describe(run), ha="right", va="top", fontsize=9.5,
                color=SEEN if run.failed else QUIET)
    save(figure, path, 160)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("run", metavar="RUN.nc")
    parser.add_argument("-o", "--output", help="PNG, SVG or PDF; RUN.png unless said")
    parser.add_argument("--observed", metavar="CSV", help="monitoring series to lay over it")
    parser.add_argument("--time", default="time", help="its time column")
    parser.add_argument("--displacement", type=named_column, metavar="NAME:UNIT")
    parser.add_argument("--velocity", type=named_column, metavar="NAME:UNIT")
    parser.add_argument("--label", help="what to call it; its file name unless said")
    options = parser.parse_args()
    if options.observed and not (options.displacement or options.velocity):
        parser.error("--observed needs --displacement or --velocity")
    try:
        run = Run(options.run)
        observed = None
        if options.observed:
            observed = Observed(
                run, options.observed, options.time, options.displacement, options.velocity,
                options.label,
            )
    except (OSError, ValueError) as wrong:
        stop(f"{str(wrong).splitlines()[0]}")
    output = options.output or os.path.splitext(options.run)[0] + ".png"
    draw(run, observed, output)


if __name__ == "__main__":
    main()
