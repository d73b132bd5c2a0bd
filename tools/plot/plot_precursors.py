#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the file of `lacuna precursors ... --rolling -o FORECASTS.nc`.

    plot_precursors.py FORECASTS.nc [-o PICTURE.png]

Displacement and inverse velocity; life expectancy against the time of issue, with the 50 % intervals and, where the time
of failure is known, the 45 degree line of the truth; the failure windows of all methods at the last
issue, 50 % and 90 %; the indicators at each time of issue, and the chance that each rises as much without a cause,
against the time left where it is known.
"""

import argparse
import datetime
import os
import sys

# first: it says what is missing
from figures import COLOURS, DAY, np as numpy, open_file, plt, save, stop

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


class Forecasts:
    """The file's variables in days from the first reading, missing ones NaN."""

    def __init__(self, path):
        with open_file(path, "reading_time", "issue_time", "failure_time") as data:
            take = lambda name: data[name].values.astype(float)  # noqa: E731
            if not data.sizes["reading"]:
                stop(f"{path}: no readings in it")
            self.start = take("reading_time")[0]
            self.dated = "since" in data["reading_time"].attrs["units"]
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
            self.sizes, self.chances = ({label: take(name) for label, name in names.items() if name in data.variables}
                                        for names in (SIZES, CHANCES))

    def axis(self):
        if not self.dated:
            return "days since the first reading"
        at = datetime.datetime.fromtimestamp(self.start, datetime.timezone.utc)
        return f"days since {at:%Y-%m-%d %H:%M} UTC"


def draw_motion(axes, f):
    axes.plot(f.reading_time, f.displacement, "k.-", markersize=4, linewidth=0.8)
    axes.set_ylabel("displacement (m)")
    right = axes.twinx()
    rising = f.velocity > 0
    right.plot(f.velocity_time[rising], 1 / f.velocity[rising], "o", color=COLOURS[0], markersize=3,
               markerfacecolor="none")
    right.set_ylabel("1/v (day/m)", color=COLOURS[0])
    shown = numpy.sort(1 / f.velocity[rising])
    if len(shown):
        right.set_ylim(0, 1.1 * shown[int(0.9 * (len(shown) - 1))])


def draw_life(axes, f):
    lives = []
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
                  label="true (45 degrees)")
    if lives:
        top = f.failed - f.issue_time[f.issued[:, :-1].any(axis=1)][0] if f.failed is not None else 0
        axes.set_ylim(0, 1.5 * max(top, numpy.median(lives)))
        axes.legend(fontsize=7, ncol=2)
    axes.set_ylabel("life expectancy (day)")


def draw_windows(axes, f):
    last = len(f.issue_time) - 1
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
    axes.axvline(f.issue_time[last], color="k", linewidth=0.8, linestyle=":")
    if f.failed is not None:
        axes.axvline(f.failed, color="k", linewidth=1, linestyle="--")
    axes.set_yticks(range(len(f.methods) - 1), f.methods[:-1])
    axes.set_ylim(len(f.methods) - 1.5, -0.5)
    axes.set_title("failure windows at the last issue: 50 % (thick), 90 % (thin), | the fit", fontsize=9)


def issues(axes, f):
    """Where indicators are drawn: the time of issue, or on a logarithmic axis what was left."""
    if f.failed is None:
        axes.set_xlabel(f.axis())
        return f.issue_time
    axes.set_xscale("log")
    axes.invert_xaxis()
    axes.set_xlabel("days left")
    return numpy.where(f.issue_time < f.failed, f.failed - f.issue_time, numpy.nan)


def draw_sizes(axes, f):
    """Each over its largest value, which the legend names: they have nothing else in common."""
    at = issues(axes, f)
    for k, (label, values) in enumerate(f.sizes.items()):
        most = numpy.nanmax(numpy.abs(values))
        if most > 0:
            axes.plot(at, values / most, ".-", color=COLOURS[k % 8], markersize=4, linewidth=0.8,
                      label=f"{label}, to {most:.3g}")
    axes.set_ylabel("indicators, over their largest")
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
    axes.legend(fontsize=7, ncol=2, loc="lower left")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("file")
    parser.add_argument("-o", "--output", help="else the file's name with .png")
    arguments = parser.parse_args()
    f = Forecasts(arguments.file)
    panels = [draw_motion, draw_life, draw_windows] + ([draw_sizes] if f.sizes else []) + ([draw_chances] if f.chances else [])
    figure, axes = plt.subplots(len(panels), 1, figsize=(8, 10 / 3 * len(panels)), constrained_layout=True)
    for panel, draw in zip(axes, panels):
        draw(panel, f)
    axes[0].set_title(os.path.basename(f.source), fontsize=9)
    axes[2].set_xlabel(f.axis())
    output = arguments.output or os.path.splitext(arguments.file)[0] + ".png"
    save(figure, output, 110)
    return 0


if __name__ == "__main__":
    sys.exit(main())
