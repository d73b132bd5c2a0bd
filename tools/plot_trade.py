#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what `lacuna trade` wrote: error against CPU time, the front, and what is recommended.

    tools/plot_trade.py TRADE.nc [-o TRADE.png]

Every setting that is turned but the first ladder is a series of its own; its points are joined from
coarse to fine. Errors within the reference's own are drawn at its edge.
"""

import argparse

# first: it says what is missing
from figures import FAINT, INK, QUIET, np, open_file, plt, stop

COLOURS = ["#2f6f9f", "#c8761a", "#4d8f5b", "#8a5aa8", "#b3262e", "#5f6b2d", "#20908c", "#97694f"]
MARKS = "osD^vP<>"


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
            self.error, self.cpu, self.memory = (
                data[name].values[done] for name in ("error", "cpu_time", "peak_memory"))
            self.front = data["on_front"].values[done] == 1
        if not self.settings:
            stop(f"{path}: no run of it has the quantity")
        self.floor = float(self.about.get("reference_uncertainty", 0.0))
        self.drawn = np.maximum(self.error, max(self.floor, 1e-16))
        self.keys = [k for k in self.settings[0] if len({s[k] for s in self.settings}) > 1]
        self.ladder = self.find_ladder()

    def find_ladder(self):
        """The key with the most positions that are numbers; None where there is none."""
        def is_number(text):
            try:
                return float(text) is not None
            except ValueError:
                return False

        ladders = [k for k in self.keys if all(is_number(s[k]) for s in self.settings)]
        return max(ladders, key=lambda k: len({s[k] for s in self.settings}), default=None)

    def series(self):
        """Indices of the runs of each series, by its name."""
        found = {}
        for i, settings in enumerate(self.settings):
            name = ", ".join(settings[k] for k in self.keys if k != self.ladder)
            found.setdefault(name or "the case", []).append(i)
        return found


def draw_runs(axes, trade):
    for k, (name, members) in enumerate(trade.series().items()):
        colour, mark = COLOURS[k % len(COLOURS)], MARKS[k % len(MARKS)]
        axes.plot(trade.cpu[members], trade.drawn[members], marker=mark, ms=6, lw=1, color=colour,
                  label=name, alpha=0.9)
        if trade.ladder:
            for i in (members[0], members[-1]):
                axes.annotate(trade.settings[i][trade.ladder], (trade.cpu[i], trade.drawn[i]),
                              xytext=(6, 3), textcoords="offset points", fontsize=7, color=QUIET)


def draw_front(axes, trade):
    order = np.argsort(trade.cpu[trade.front])
    axes.plot(trade.cpu[trade.front][order], trade.drawn[trade.front][order],
              drawstyle="steps-post", color=INK, lw=2.2, alpha=0.25, zorder=0, label="front")
    chosen = words(trade.about.get("recommended_settings", ""))
    for i, settings in enumerate(trade.settings):
        if settings == chosen:
            axes.plot(trade.cpu[i], trade.drawn[i], marker="o", ms=15, mfc="none", mec=INK, mew=1.5,
                      ls="none", label="recommended")
            break


def finish(axes, trade):
    axes.set_xscale("log")
    axes.set_yscale("log")
    if trade.floor > 0:
        low = min(axes.get_ylim()[0], trade.floor / 3)
        axes.axhspan(low, trade.floor, color=FAINT, zorder=-1, lw=0)
        axes.set_ylim(bottom=low)
        axes.annotate("within the reference's own error", (0.99, trade.floor), fontsize=7,
                      xycoords=("axes fraction", "data"), xytext=(0, -9),
                      textcoords="offset points", ha="right", color=QUIET)
    axes.set_xlabel("CPU time (s)")
    axes.set_ylabel(f"relative error of the {trade.about['quantity_long_name']}")
    axes.grid(True, which="major", color=FAINT, lw=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    title = ", ".join(short(k) for k in trade.keys if k != trade.ladder)
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.01, 1.0),
                title=title or None, title_fontsize=8)
    axes.set_title(trade.about.get("title", ""), fontsize=11, color=INK, loc="left")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("trade", metavar="TRADE.nc")
    parser.add_argument("-o", "--output")
    options = parser.parse_args()
    trade = Trade(options.trade)
    figure, axes = plt.subplots(figsize=(8.4, 4.8), constrained_layout=True)
    draw_runs(axes, trade)
    draw_front(axes, trade)
    finish(axes, trade)
    name = options.trade[:-3] if options.trade.endswith(".nc") else options.trade
    figure.savefig(options.output or name + ".png", dpi=150)


if __name__ == "__main__":
    main()
