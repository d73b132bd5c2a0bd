#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the file of `lacuna precursors ... --rolling -o FORECASTS.nc`.

    plot_precursors.py FORECASTS.nc [-o PICTURE.png]

Displacement, rate and inverse rate, with the level at each time of issue as a band above them; what drives the slope,
where the file holds it; the time left as forecast against the time of issue, with the 50 % intervals of each method, that
of 90 % of all together and, where the time of failure is known, the line of the truth; the failure windows of all methods
at the last issue, 50 % and 90 %, and theirs together; the indicators at each time of issue, and the chance that each rises as much without a
cause, against the time left where it is known. `lacuna report` makes the same as a page.
"""

import argparse
import os
import sys
import textwrap

# first: it says what is missing
from figures import COLOURS, DAY, QUIET, date_ticks, np as numpy, open_file, plain_ticks, plt, save, stop, use_screen_style

# what is drawn of an indicator, if the file has it
SIZES = {"slipping fraction": "slip_fraction_slip_fraction", "fixed point C": "slip_fraction_critical_fraction",
         "correlation length (m)": "correlation_length_length_m", "b-value": "b_value_b",
         "b-positive": "b_positive_b", "moment (N m)": "moment_moment_N_m",
         "autocorrelation": "slowing_autocorrelation", "variance (m2/s2)": "slowing_variance_m2_s2"}
CHANCES = {"slip fraction": "slip_fraction_rise_p", "correlation length": "correlation_length_rise_p",
           "event rate": "event_rate_rise_p", "moment": "moment_rise_p", "b-value": "b_value_fall_p",
           "variance": "slowing_variance_p", "variance, phases": "slowing_variance_phase_p",
           "autocorrelation": "slowing_autocorrelation_p",
           "autocorrelation, phases": "slowing_autocorrelation_phase_p", "log-periodicity": "log_periodicity_p"}


LEVELS = ("#c3cad1", "#f0d050", "#e07b00", "#7a1f5c")  # as on the page: each darker than the one before
NINTHS = 0.9  # of the inverse rates stand on their axis: slow times would press the last ones together


def drivers_of(data, start):
    """Variables driver_* with their times: [(label, days, values)]."""
    found = []
    for name, variable in data.variables.items():
        if not name.startswith("driver_") or name.endswith("time") or len(variable.dims) != 1:
            continue
        times = [other for other, v in data.variables.items() if v.dims == variable.dims and other.endswith("time")]
        if times and numpy.issubdtype(variable.dtype, numpy.number):
            unit = variable.attrs.get("units", "1")
            label = name[len("driver_"):] + ("" if unit == "1" else f" ({unit})")
            found.append((label, (data[times[0]].values.astype(float) - start) / DAY, variable.values.astype(float)))
    return found


class Forecasts:
    """The file's variables, missing ones NaN; times in days from 1970, or without dates from the first reading."""

    def __init__(self, path):
        with open_file(path, "reading_time", "issue_time", "failure_time") as data:
            take = lambda name: data[name].values.astype(float)  # noqa: E731
            if not data.sizes["reading"]:
                stop(f"{path}: no readings in it")
            self.zone = "the file's clock" if data.attrs.get("time_zone") == "not stated" else "UTC"
            self.dated = "since" in data["reading_time"].attrs["units"]
            self.start = 0.0 if self.dated else take("reading_time")[0]
            for name in ("reading_time", "velocity_time", "issue_time", "failure_time",
                         "failure_time_low50", "failure_time_high50", "failure_time_low90",
                         "failure_time_high90"):
                setattr(self, name, (take(name) - self.start) / DAY)
            self.displacement, self.velocity = take("displacement"), take("velocity") * DAY
            self.issued = take("issued") > 0
            self.methods = data["method"].attrs["flag_meanings"].split()
            failed = data.attrs.get("failed_at_s")
            self.failed = None if failed is None else (failed - self.start) / DAY
            self.source = data.attrs["source_file"]
            self.level = take("alarm_level") if "alarm_level" in data.variables else None
            self.levels = data["alarm_level"].attrs["flag_meanings"].split() if self.level is not None else []
            self.pooled = (take("pooled_time") - self.start) / DAY if "pooled_time" in data.variables else None
            self.raw = (take("failure_time_raw") - self.start) / DAY if "failure_time_raw" in data.variables else None
            self.verdict = data.attrs.get("verdict", "")
            self.drivers = drivers_of(data, self.start)
            self.sizes, self.chances = ({label: take(name) for label, name in names.items() if name in data.variables}
                                        for names in (SIZES, CHANCES))

    def span(self):
        """What the axes over time show: the readings, and the failure where that is near."""
        first, last = self.reading_time[0], self.reading_time[-1]
        near = self.failed is not None and last < self.failed < last + 0.35 * (last - first)
        last = self.failed if near else last
        return first - 0.01 * (last - first), last + 0.01 * (last - first)

    def dates(self, axes):
        """Says what the axis over time counts."""
        if self.dated:
            date_ticks(axes.xaxis, 3, 8)
        axes.set_xlabel(f"date ({self.zone})" if self.dated else "days since the first reading")


def over_time(axes, f):
    axes.set_xlim(*f.span())
    f.dates(axes)
    if f.failed is not None and f.span()[0] <= f.failed <= f.span()[1]:
        axes.axvline(f.failed, color="k", linewidth=1, linestyle="--")
        axes.annotate("failure", (f.failed, 1), xycoords=("data", "axes fraction"), xytext=(-3, -10),
                      textcoords="offset points", ha="right", fontsize=7)


def draw_levels(axes, f):
    """A band above the axes, the level's name in it wherever it changes and there is room."""
    if f.level is None:
        return
    ends = numpy.append(f.issue_time[1:], max(f.issue_time[-1], f.reading_time[-1]))
    wide, named, shown = f.span()[1] - f.span()[0], -numpy.inf, None
    for start, end, level in zip(f.issue_time, ends, f.level):
        if not numpy.isfinite(level):
            continue
        axes.axvspan(start, end, ymin=1.01, ymax=1.06, color=LEVELS[int(level) % len(LEVELS)], clip_on=False, linewidth=0)
        if level != shown and start - named > 0.09 * wide:
            axes.annotate(f.levels[int(level)], (start, 1.07), xycoords=("data", "axes fraction"), fontsize=7, va="bottom",
                          annotation_clip=False)
            named = start
        shown = level


def draw_displacement(axes, f):
    axes.plot(f.reading_time, f.displacement, "-", color=QUIET, linewidth=0.8)
    axes.plot(f.reading_time, f.displacement, "o", color=COLOURS[2], markersize=3, markerfacecolor="none")
    axes.set_ylabel("displacement (m)")
    over_time(axes, f)
    draw_levels(axes, f)


def draw_rate(axes, f):
    axes.plot(f.velocity_time, 1e3 * f.velocity, "o", color=COLOURS[2], markersize=3, markerfacecolor="none")
    axes.set_ylabel("rate (mm/day)")
    over_time(axes, f)


def draw_inverse(axes, f):
    rising = f.velocity > 0
    axes.plot(f.velocity_time[rising], 1 / f.velocity[rising], "o", color=COLOURS[2], markersize=3, markerfacecolor="none")
    axes.set_ylabel("1/rate (day/m)")
    shown = numpy.sort(1 / f.velocity[rising])
    if len(shown):
        axes.set_ylim(0, 1.1 * shown[int(NINTHS * (len(shown) - 1))])
    over_time(axes, f)


def draw_driver(which):
    def draw(axes, f):
        label, time, values = f.drivers[which]
        now_and_then = (values == 0).sum() > len(values) / 4 and numpy.nanmin(values) >= 0
        if now_and_then:  # as rain does
            axes.vlines(time, 0, values, color=COLOURS[0], linewidth=1.2)
            axes.set_ylim(0, None)
        else:
            axes.plot(time, values, "-", color=COLOURS[0], linewidth=1)
        axes.set_ylabel(label)
        over_time(axes, f)
    return draw


def draw_together(axes, f):
    """The 90 % interval of all methods but the baseline: pooled, or of an older file all that theirs take in."""
    if f.pooled is not None:
        left = f.pooled - f.issue_time[:, None]
        high = numpy.where(numpy.isnan(left[:, 4]) & numpy.isfinite(left[:, 0]), 1e9, left[:, 4])
        axes.fill_between(f.issue_time, numpy.maximum(0, left[:, 0]), high, color=COLOURS[7], alpha=0.15, linewidth=0,
                          label="90 %, all methods")
        axes.plot(f.issue_time, left[:, 2], "-", color="k", linewidth=1.4, label="middle, all methods")
        return
    ok = f.issued[:, :-1]
    low, high = (numpy.where(ok, times[:, :-1], numpy.nan) for times in (f.failure_time_low90, f.failure_time_high90))
    some = numpy.isfinite(low).any(axis=1)
    ends = numpy.full((2, len(f.issue_time)), numpy.nan)
    ends[0, some] = numpy.nanmin(low[some], axis=1) - f.issue_time[some]
    ends[1, some] = numpy.where(numpy.isnan(high[some]) & ok[some], numpy.inf, high[some]).max(
        axis=1, initial=-numpy.inf, where=ok[some]) - f.issue_time[some]
    ends[1] = numpy.where(numpy.isinf(ends[1]), 1e9, ends[1])
    axes.fill_between(f.issue_time, numpy.maximum(0, ends[0]), ends[1], color=COLOURS[7], alpha=0.15, linewidth=0,
                      label="90 % intervals together")


def draw_life(axes, f):
    lives = []
    draw_together(axes, f)
    for k, method in enumerate(f.methods[:-1]):
        ok = f.issued[:, k]
        if not ok.any():
            continue
        # nothing is drawn across the times at which none was issued
        now = f.issue_time
        left, low, high = (numpy.where(ok, times[:, k] - now, numpy.nan) for times in
                           (f.failure_time, f.failure_time_low50, f.failure_time_high50))
        lives += list(left[ok])
        axes.fill_between(now, low, high,
                          color=COLOURS[k % 8], alpha=0.1, linewidth=0)
        axes.plot(now, left, ".-", color=COLOURS[k % 8], label=method, markersize=4, linewidth=0.8)
    if f.failed is not None:
        axes.plot([f.issue_time[0], f.failed], [f.failed - f.issue_time[0], 0], "k--", linewidth=1,
                  label="what was left")
    if lives:
        top = f.failed - f.issue_time[f.issued[:, :-1].any(axis=1)][0] if f.failed is not None else 0
        axes.set_ylim(0, 1.5 * max(top, numpy.median(lives)))
        axes.legend(fontsize=7, ncol=6, loc="lower left", bbox_to_anchor=(0, 1.0), borderaxespad=0.2)
    else:
        axes.text(0.5, 0.5, "no method issues a forecast", transform=axes.transAxes, ha="center", color=QUIET)
    axes.set_ylabel("time left (day)")
    axes.set_xlabel("time of issue")
    over_time(axes, f)


def draw_windows(axes, f):
    last = len(f.issue_time) - 1
    if not f.issued[last, :-1].any():
        axes.text(0.5, 0.5, "no method issues a forecast at the last issue", transform=axes.transAxes, ha="center", color=QUIET)
        over_time(axes, f)
        axes.set_yticks([])
        return
    rows = list(f.methods[:-1])
    if f.pooled is not None and numpy.isfinite(f.pooled[last, 2]):
        rows.append("all")
        for low, high, width in ((0, 4, 1), (1, 3, 5)):
            axes.plot(f.pooled[last, [low, high]], [len(rows) - 1] * 2, color="k", linewidth=width, solid_capstyle="butt")
        axes.plot(f.pooled[last, 2], len(rows) - 1, "w|", markersize=5)
    for k, method in enumerate(f.methods[:-1]):
        if not f.issued[last, k]:
            axes.text(f.issue_time[last], k, " not issued", va="center", fontsize=7)
            continue
        colour = COLOURS[k % 8]
        axes.plot([f.failure_time_low90[last, k], f.failure_time_high90[last, k]], [k, k], color=colour,
                  linewidth=1)
        axes.plot([f.failure_time_low50[last, k], f.failure_time_high50[last, k]], [k, k], color=colour,
                  linewidth=5, solid_capstyle="butt")
        axes.plot(f.failure_time[last, k], k, "k|", markersize=9)
        if f.raw is not None:
            axes.plot(f.raw[last, k], k, "kx", markersize=4)
    axes.axvline(f.issue_time[last], color="k", linewidth=0.8, linestyle=":")
    if f.failed is not None:
        axes.axvline(f.failed, color="k", linewidth=1, linestyle="--")
    axes.set_yticks(range(len(rows)), rows)
    axes.set_ylim(len(rows) - 0.5, -0.5)
    raw = "" if f.raw is None else ", x by the fit itself"
    axes.set_title(f"failure windows at the last issue: 50 % (thick), 90 % (thin), | the time{raw}", fontsize=9)


def issues(axes, f):
    """Where indicators are drawn: the time of issue, or on a logarithmic axis what was left."""
    if f.failed is None:
        over_time(axes, f)
        return f.issue_time
    axes.set_xscale("log")
    axes.set_xlabel("days left")
    return numpy.where(f.issue_time < f.failed, f.failed - f.issue_time, numpy.nan)


def turn(axes, f):
    """Once all is drawn: time left runs to the right."""
    if f.failed is not None:
        axes.get_xlim()
        plain_ticks(axes.xaxis)
        axes.invert_xaxis()


def draw_sizes(axes, f):
    """Each over its largest value, which the legend names: they have nothing else in common."""
    at = issues(axes, f)
    for k, (label, values) in enumerate(f.sizes.items()):
        most = numpy.nanmax(numpy.abs(values))
        if most > 0:
            axes.plot(at, values / most, ".-", color=COLOURS[k % 8], markersize=4, linewidth=0.8,
                      label=f"{label}, to {most:.3g}")
    axes.set_ylabel("indicators, over their largest")
    turn(axes, f)
    axes.legend(fontsize=7, ncol=2)


def draw_chances(axes, f):
    at = issues(axes, f)
    for k, (label, values) in enumerate(f.chances.items()):
        axes.plot(at, numpy.maximum(values, 1.2e-4), ".-" if k < 8 else ".--", color=COLOURS[k % 8], markersize=4,
                  linewidth=0.8, label=label)
    axes.axhline(0.05, color="k", linestyle=":", linewidth=0.8)
    axes.set_yscale("log")
    axes.set_ylim(1e-4, 1.3)
    axes.set_ylabel("chance without a cause (p)")
    turn(axes, f)
    axes.legend(fontsize=7, ncol=2, loc="lower left")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("file")
    parser.add_argument("-o", "--output", help="else the file's name with .png")
    arguments = parser.parse_args()
    f = Forecasts(arguments.file)
    use_screen_style()
    panels = [draw_displacement, draw_rate, draw_inverse, *(draw_driver(k) for k in range(len(f.drivers))), draw_life,
              draw_windows] + ([draw_sizes] if f.sizes else []) + ([draw_chances] if f.chances else [])
    figure, axes = plt.subplots(len(panels), 1, figsize=(8, 2.6 * len(panels)), constrained_layout=True)
    for place, draw in zip(axes, panels):
        draw(place, f)
    f.dates(axes[panels.index(draw_windows)])
    said = "\n" + textwrap.fill(f.verdict, 100) if f.verdict else ""
    axes[0].set_title(os.path.basename(f.source) + said, pad=20 if f.level is not None else 6)
    output = arguments.output or os.path.splitext(arguments.file)[0] + ".png"
    save(figure, output, 110)
    return 0


if __name__ == "__main__":
    sys.exit(main())
