# SPDX-License-Identifier: GPL-3.0-or-later
"""Readings and forecasts beside a run, as the page of `lacuna report` has them; part of lacuna_plot.py."""

import json
import os
import re
import tempfile

from figures import (COLOURS, DAY, INK, QUIET, RED, SPANS, WIDTH, called, date_ticks, matplotlib, np, panel, plt, span, start_of,
                     unit_of)
from matplotlib.patches import Patch

LEFT, LOW90, LOW50, HIGH50, HIGH90 = range(1, 6)  # of a forecast, from its time of issue [s]
SHADE, DARK = 0.15, 0.3


def page_of(program, path, *words):
    """What the page of `lacuna report` shows of the run, and of the readings that `words` name."""
    with tempfile.TemporaryDirectory(prefix="lacuna-plot-") as folder:
        page = os.path.join(folder, "run.html")
        called(program, "report", path, "-o", page, *words)
        with open(page, encoding="utf-8") as file:
            return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', file.read(), re.DOTALL).group(1))


def numbers(values):
    """JSON's numbers, null as NaN."""
    return np.array([np.nan if v is None else v for v in values], dtype=float)


def seconds_of(run):
    """Time since the start [s]."""
    return run["time_origin"].values + run["time_local"].values


def before_end(run):
    """Time before the last record [s], exact to the last step."""
    origin, local = run["time_origin"].values, run["time_local"].values
    return (origin[-1] - origin) + (local[-1] - local)


def has_failed(run):
    return bool(run.attrs.get("failed", 0))


class Clock:
    """How times since the start stand on an axis: as dates, or in a unit that suits the run."""

    def __init__(self, run):
        self.last = seconds_of(run)[-1]
        self.start = start_of(run) if self.last >= 10 * DAY else None
        self.name, self.unit = unit_of(self.last, SPANS, 2)

    def at(self, seconds):
        if self.start is None:
            return np.asarray(seconds) / self.unit
        return matplotlib.dates.date2num(self.start) + np.asarray(seconds) / DAY

    def axis(self, axes, first=0.0, margin=0.03):
        axes.set_xlim(self.at(first), self.at(self.last + margin * (self.last - first)))
        if self.start is None:
            axes.set_xlabel(f"time ({self.name})")
            return
        date_ticks(axes.xaxis, 2, 4)
        axes.set_xlabel("date (UTC)", loc="left")


def readings(page, clock, key):
    """Times, values and name of the readings within the run, the displacement moved onto its slip as on the page."""
    series = (page or {}).get("series")
    if not series:
        return None, None, None
    time = numbers(series["time" if key == "displacement" else "rate_time"])
    value = numbers(series[key])
    if key == "displacement":
        value = value - (series["offset"] or 0.0)
    seen = np.zeros(0, bool) if len(value) != len(time) else np.isfinite(value) & (time >= -0.02 * clock.last) & (time <= 1.03 * clock.last)
    return (time[seen], value[seen], "readings") if seen.any() else (None, None, None)


def chosen_issue(forecasts, last):
    """Of readings the last issue, of a run the last with a fiftieth of it left: as the page opens."""
    issue = forecasts["issue"]
    issued = [i for i, rows in enumerate(forecasts["forecast"]) if any(row[0] for row in rows)]
    early = [i for i in issued if last - issue[i] > (last - issue[0]) / 50]
    if not issued:
        return None
    return issued[-1] if forecasts["measured"] or not early else early[-1]


def real_methods(forecasts, rows):
    """Forecasts issued, but that of the baseline."""
    return [row for method, row in zip(forecasts["methods"], rows) if row[0] and not method.get("baseline")]


def draw_window(axes, page, clock):
    """Light, the 90 % intervals of the methods together; darker, the span of their times. Gives a key and the time left."""
    forecasts = (page or {}).get("forecasts")
    k = chosen_issue(forecasts, clock.last) if forecasts else None
    rows = real_methods(forecasts, forecasts["forecast"][k]) if k is not None else []
    if not rows:
        return None
    right = axes.get_xlim()[1]
    at = forecasts["issue"][k]
    for low, high, alpha in ((LOW90, HIGH90, SHADE), (LEFT, LEFT, DARK)):
        least = min(row[low] or 0.0 for row in rows)
        ends = [row[high] for row in rows]
        most = right if None in ends else min(right, float(clock.at(at + max(ends))))
        axes.axvspan(min(float(clock.at(at + least)), right), most, color=RED, alpha=alpha, lw=0, zorder=0)
    axes.axvline(clock.at(at), color=QUIET, lw=0.7, ls=(0, (2, 2)), zorder=1)
    return Patch(color=RED, alpha=DARK, lw=0), span(clock.last - at)


def has_forecasts(_run, page):
    return bool(page and page.get("forecasts")) and any(real_methods(page["forecasts"], rows) for rows in page["forecasts"]["forecast"])


def forecasts(run, page):
    """Time left as forecast at each time of issue, and the intervals of all methods at one of them."""
    figure, axes = plt.subplots(1, 2, figsize=(WIDTH, 2.7), layout="constrained")
    clock, found = Clock(run), page["forecasts"]
    issue = numbers(found["issue"])
    draw_life(axes[0], found, issue, clock, has_failed(run))
    draw_methods(axes[1], found, chosen_issue(found, clock.last), clock, has_failed(run))
    return figure


def draw_life(axes, found, issue, clock, failed):
    left = clock.last - issue
    for m, method in enumerate(found["methods"]):
        rows = [rows[m] for rows in found["forecast"]]
        said = numbers([row[LEFT] if row[0] else None for row in rows])
        if np.isfinite(said).any() and not method.get("baseline"):
            axes.plot(left, np.where(said > 0, said, np.nan), ".-", ms=3, lw=0.6, color=COLOURS[m % len(COLOURS)], label=method["name"])
    axes.set(xscale="log", yscale="log")
    there = left[left > 0]
    if there.size:
        axes.set_xlim(there.max(), there.min())
        axes.set_ylim(there.min() / 5, there.max() * 5)
        if failed:
            axes.plot(there, there, color=INK, lw=0.8, ls=(0, (5, 2)), label="true")
    axes.set_xlabel(f"time before {'failure' if failed else 'the end'}, at issue (s)")
    axes.set_ylabel("time left as forecast (s)")
    axes.legend(ncol=3, handlelength=1, columnspacing=0.8, loc="lower left", borderaxespad=0.4)
    panel(axes, "a", "forecasts, each from what came before it")


def draw_methods(axes, found, k, clock, failed):
    rows, at = found["forecast"][k], found["issue"][k]
    left = clock.last - at
    ends = [row[HIGH90] for row in rows if row[0] and row[HIGH90] is not None] + [row[LEFT] for row in rows if row[0]]
    name, unit = unit_of(max(left, 1e-9), SPANS)
    most = 1.1 * min(max([*filter(None, ends), left]), 5 * max(left, 1e-9))
    for m, row in enumerate(rows):
        colour = QUIET if found["methods"][m].get("baseline") else COLOURS[m % len(COLOURS)]
        if not row[0]:
            axes.text(most / unit, m, "none issued", va="center", ha="right", color=QUIET)
            continue
        for low, high, width in ((LOW90, HIGH90, 1), (LOW50, HIGH50, 5)):
            axes.plot([(row[low] or 0) / unit, (most if row[high] is None else row[high]) / unit], [m, m], color=colour, lw=width,
                      solid_capstyle="butt")
        axes.plot(row[LEFT] / unit, m, "|", color=INK, ms=9)
    if failed:
        axes.axvline(left / unit, color=INK, lw=0.8, ls=(0, (5, 2)))
    axes.set_yticks(range(len(rows)), [method["name"] for method in found["methods"]])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(0, most / unit)
    axes.set_xlabel(f"time from issue to failure ({name})")
    panel(axes, "b", f"windows, {span(left)} before {'failure' if failed else 'the end'}")
