#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what `lacuna trade` wrote: error against CPU time, the front, and what is recommended.

    tools/plot/plot_trade.py TRADE.nc [-o TRADE.png]

Every setting that is turned but the first ladder (rtol, levels, contacts, shifts) is a series of its
own; its points are joined from coarse to fine, with the ladder's position at its ends. Bars are the
reference's own error, filled points are on the front. Errors within the reference's own are drawn at
its edge. Settings that were given up stand at the upper edge, from the time that they had taken on.
"""

import argparse

# first: it says what is missing
from figures import FAINT, INK, QUIET, np, open_file, plt, stop

from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator
from matplotlib.transforms import Bbox

COLOURS = ["#2f6f9f", "#c8761a", "#4d8f5b", "#8a5aa8", "#b3262e", "#5f6b2d", "#20908c", "#97694f"]
MARKS = "osD^vP<>X"
LADDERS = ("rtol", "levels", "contacts", "shifts")
UNITS = ((1e-6, "µs"), (1e-3, "ms"), (1.0, "s"), (60.0, "min"), (3600.0, "h"))


def words(settings):
    """Settings of a run as a dictionary."""
    return dict(word.split("=", 1) for word in str(settings).split() if "=" in word)


def short(key):
    return key.rsplit(".", maxsplit=1)[-1]


class Trade:
    """The runs that were done."""

    def __init__(self, path):
        with open_file(path) as data:
            if "cpu_time" not in data or "settings" not in data:
                stop(f"{path}: no trade in it")
            self.about = dict(data.attrs)
            done = np.isfinite(data["error"].values)
            self.settings = [words(s) for s, good in zip(data["settings"].values, done) if good]
            self.error, self.cpu = (data[name].values[done] for name in ("error", "cpu_time"))
            self.front = data["on_front"].values[done] == 1
            told = zip(data["settings"].values, data["cpu_time"].values, data["end"].values)
            self.given_up = [(words(s), t) for s, t, end in told if str(end) == "given up" and t > 0]
        if not self.settings:
            stop(f"{path}: no run of it has the quantity")
        self.floor = float(self.about.get("reference_uncertainty", 0.0))
        self.drawn = np.maximum(self.error, max(self.floor, 1e-16))
        every = self.settings + [settings for settings, _ in self.given_up]
        self.keys = [k for k in self.settings[0] if len({s[k] for s in every}) > 1]
        self.ladder = next((k for name in LADDERS for k in self.keys if short(k) == name), None)

    def rung(self, i):
        """Place on the ladder, from coarse to fine."""
        if self.ladder is None:
            return 0.0
        value = float(self.settings[i][self.ladder])
        return -value if short(self.ladder) == "rtol" else value

    def series(self):
        """Indices of the runs of each series, from coarse to fine, by its name."""
        found = {}
        for i in sorted(range(len(self.settings)), key=self.rung):
            found.setdefault(self.name(self.settings[i]), []).append(i)
        return dict(sorted(found.items()))

    def name(self, settings):
        """Of the series that they belong to."""
        return ", ".join(settings[k] for k in self.keys if k != self.ladder) or "the case"


def time_text(seconds, _=None):
    """20 ms, 1.5 s, 3 min"""
    factor, unit = next(((f, u) for f, u in reversed(UNITS) if seconds >= 0.9995 * f), UNITS[0])
    return f"{seconds / factor:.3g} {unit}"


def error_text(error, _=None):
    """10 %, 0.1 %, then powers of ten."""
    if error <= 0:
        return ""
    if error >= 0.9e-3:
        return f"{100 * error:.3g} %"
    power = int(np.floor(np.log10(error) + 1e-9))
    times = f"{error / 10.0**power:.2g}"
    return f"$10^{{{power}}}$" if times == "1" else f"${times}\\times10^{{{power}}}$"


def set_ticks(axis, low, high, text):
    """Ticks that do not run into one another, whether the range is narrow or many decades."""
    decades = np.log10(high / low)
    if decades < 0.7:
        axis.set_major_locator(MaxNLocator(5))
        axis.set_minor_locator(NullLocator())
    else:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if decades < 2.5 else (1,), numticks=9))
        axis.set_minor_locator(LogLocator(subs=range(2, 10), numticks=99))
    axis.set_major_formatter(FuncFormatter(text))
    axis.set_minor_formatter(NullFormatter())


def draw_runs(axes, trade):
    for k, (name, members) in enumerate(trade.series().items()):
        colour, mark = COLOURS[k % len(COLOURS)], MARKS[k % len(MARKS)]
        x, y = trade.cpu[members], trade.drawn[members]
        if trade.floor > 0:
            axes.errorbar(x, y, yerr=trade.floor, fmt="none", ecolor=colour, elinewidth=1,
                          capsize=2.5, alpha=0.55, zorder=2)
        axes.plot(x, y, lw=1.1, color=colour, alpha=0.8, zorder=2)
        axes.plot([], [], marker=mark, ms=6, lw=1.1, color=colour, label=name)
        for i in members:
            axes.plot(trade.cpu[i], trade.drawn[i], marker=mark, ms=6, mec=colour, mew=1.2, zorder=3,
                      mfc=colour if trade.front[i] else "white")


def draw_given_up(axes, trade):
    """The time is known, and no error: it would have ended further right."""
    longest = {}
    for settings, time in trade.given_up:
        name = trade.name(settings)
        longest[name] = max(time, longest.get(name, 0.0))
    edge = axes.get_xaxis_transform()
    names = list(dict.fromkeys([*trade.series(), *sorted(longest)]))
    for name, time in longest.items():
        k = names.index(name)  # a series that has points keeps its colour
        colour, mark = COLOURS[k % len(COLOURS)], MARKS[k % len(MARKS)]
        axes.plot(time, 0.96, marker=mark, ms=6, mec=colour, mew=1.2, mfc="white", ls="none", transform=edge,
                  label=f"{name}: given up", zorder=5)
        axes.annotate("", (1.25 * time, 0.96), (time, 0.96), xycoords=edge, textcoords=edge, zorder=4,
                      arrowprops={"arrowstyle": "->", "color": colour})


def draw_front(axes, trade):
    order = np.argsort(trade.cpu[trade.front])
    axes.plot(trade.cpu[trade.front][order], trade.drawn[trade.front][order],
              drawstyle="steps-post", color=INK, lw=3.5, alpha=0.22, zorder=1,
              label="front (filled points)")
    chosen = words(trade.about.get("recommended_settings", ""))
    for i, settings in enumerate(trade.settings):
        if settings == chosen:
            axes.plot(trade.cpu[i], trade.drawn[i], marker="o", ms=15, mfc="none", mec=INK, mew=1.4,
                      ls="none", label="recommended", zorder=4)
            break


def write_rungs(figure, axes, trade):
    """The ladder's position at the ends of each series, where there is room for it."""
    figure.canvas.draw()
    renderer = figure.canvas.get_renderer()
    points = axes.transData.transform(np.column_stack([trade.cpu, trade.drawn]))
    taken = [Bbox.from_bounds(x - 7, y - 7, 14, 14) for x, y in points]
    for members in trade.series().values():
        for i in dict.fromkeys((members[0], members[-1])):
            for x, y, side in ((8, 4, "left"), (8, -11, "left"), (-8, 4, "right"), (-8, -11, "right"),
                               (0, 9, "center"), (0, -16, "center")):
                text = axes.annotate(
                    f"{float(trade.settings[i][trade.ladder]):g}", (trade.cpu[i], trade.drawn[i]),
                    xytext=(x, y), ha=side, textcoords="offset points", fontsize=8, color=QUIET,
                    path_effects=[withStroke(linewidth=2.5, foreground="white")], zorder=5)
                box = text.get_window_extent(renderer)
                if not any(box.overlaps(other) for other in taken):
                    taken.append(box)
                    break
                text.remove()


def shade_floor(axes, trade):
    """What the reference's own error hides."""
    low, high = axes.get_ylim()
    low = min(low, trade.floor / 3)
    axes.axhspan(low, trade.floor, color=FAINT, zorder=-1, lw=0)
    axes.set_ylim(low, high)
    axes.annotate("within the reference's own error", (0.01, low), fontsize=8,
                  xycoords=("axes fraction", "data"), xytext=(0, 5), textcoords="offset points",
                  color=QUIET)


def finish(axes, trade):
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = np.nanmin(trade.drawn), np.nanmax(trade.drawn)
    axes.set_ylim(low / 3, high * 2.5)
    left, right = trade.cpu.min(), max([*trade.cpu, *(1.3 * time for _, time in trade.given_up)])
    margin = max((right / left) ** 0.1, 1.03)
    axes.set_xlim(left / margin, right * margin)
    if trade.floor > 0:
        shade_floor(axes, trade)
    set_ticks(axes.xaxis, *axes.get_xlim(), time_text)
    set_ticks(axes.yaxis, *axes.get_ylim(), error_text)
    axes.set_xlabel("CPU time of a run")
    axes.set_ylabel(f"relative error, {trade.about['quantity_long_name']}")
    axes.grid(True, which="major", color=FAINT, lw=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    title = ", ".join(short(k) for k in trade.keys if k != trade.ladder)
    if trade.ladder:
        title += f"{' ' if title else ''}(numbers: {short(trade.ladder)})"
    axes.legend(fontsize=9, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.02),
                title=title or None, title_fontsize=9, alignment="left")
    axes.set_title(trade.about.get("title", ""), fontsize=11, color=INK, loc="left", wrap=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("trade", metavar="TRADE.nc")
    parser.add_argument("-o", "--output")
    options = parser.parse_args()
    trade = Trade(options.trade)
    figure, axes = plt.subplots(figsize=(8.4, 4.6), layout="constrained", dpi=160)
    draw_runs(axes, trade)
    draw_given_up(axes, trade)
    draw_front(axes, trade)
    finish(axes, trade)
    if trade.ladder:
        write_rungs(figure, axes, trade)
    name = options.trade[:-3] if options.trade.endswith(".nc") else options.trade
    figure.savefig(options.output or name + ".png", dpi=160)


if __name__ == "__main__":
    main()
