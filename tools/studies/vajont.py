#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vajont with its lake: the fit, what was to be said at dates of issue, and the picture of both.

    vajont.py fit [--fit FIT.nc]          samples the posterior, FIT.nc; prints tables for docs/tables/vajont.md
    vajont.py issues                      forecasts at 20 August, 20 September and 3 October 1963
    vajont.py picture [--fit FIT.nc] [-o docs/images/vajont-lake.png]
    all with [--program build/lacuna] [--threads 2] [--draws 200]

The fit takes a quarter of an hour of two free cores, the picture one minute.
"""

import argparse
import csv
import datetime
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "plot"))
# first: it says what is missing
from figures import BLUE, DAY, FAINT, GREEN, INK, QUIET, ROOT, SEEN, matplotlib, np, plt, save, stop, use_screen_style, xarray

CASES = os.path.join(ROOT, "cases")
CASE, RATES = os.path.join(CASES, "vajont-lake.yaml"), os.path.join(CASES, "data", "vajont_rates.csv")
LAKE = os.path.join(CASES, "data", "vajont_lake.csv")
LEVELS = "load.pore_pressure.0.reservoir.file"
START, FAILED = datetime.datetime(1960, 9, 4), datetime.datetime(1963, 10, 9, 21, 39)  # UTC
CM_DAY = 1e-2 / DAY
ISSUES = ("1963-08-20", "1963-09-20", "1963-10-03")
SHORT = {"fit.walkers": 16, "fit.steps": 250, "fit.burn": 100, "fit.rounds": 1}  # no failure has to be met: few walkers do


def when(text):
    """UTC of a date of the tables."""
    date = datetime.datetime.fromisoformat(text)
    return date if date.tzinfo is None else date.astimezone(datetime.timezone.utc).replace(tzinfo=None)


def days(date):
    return (date - START).total_seconds() / DAY


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def call(program, *words):
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1) or (done.returncode == 1 and "has not converged" not in done.stderr):
        stop(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
    return done.stdout


def draws_of(path, most):
    """Settings of draws, evenly taken from the chain."""
    with xarray.open_dataset(path, decode_times=False) as data:
        keys = {name: v.attrs["case_key"] for name, v in data.variables.items() if "case_key" in v.attrs}
        drawn = {key: data[name].transpose("draw", "chain").values.ravel() for name, key in keys.items() if "error." not in key}
    every = np.linspace(0, len(next(iter(drawn.values()))) - 1, most).astype(int)
    return [{key: repr(float(x[i])) for key, x in drawn.items()} for i in every]


class Runs:
    """Runs of the case with other values: its rate in time."""

    def __init__(self, program):
        self.program = program
        self.folder = tempfile.TemporaryDirectory(prefix="lacuna-vajont-")
        self.path = os.path.join(self.folder.name, "run.nc")

    def __call__(self, settings):
        words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
        call(self.program, "run", CASE, "-q", "--force", "-o", self.path, *words)
        with xarray.open_dataset(self.path, decode_times=False) as data:
            seconds = (data["time_origin"] + data["time_local"]).values
            failed = bool(data.attrs.get("failed", 0))
            return seconds / DAY, data["slip_rate"].values / CM_DAY, seconds[-1] / DAY if failed else np.inf


def rates_at(grid, runs, draws):
    """ln of the rate [cm/day] of every draw on a grid of days; inf behind its failure."""
    out = np.full((len(draws), len(grid)), np.inf)
    for i, draw in enumerate(draws):
        t, v, _ = runs(draw)
        out[i] = np.where(grid <= t[-1], np.interp(grid, t, np.log(v)), np.inf)
    return out


def fit(arguments):
    print(call(arguments.program, "fit", CASE, RATES, "-o", arguments.fit, "--force", "--threads", arguments.threads))
    with xarray.open_dataset(arguments.fit, decode_times=False) as data:
        rank, kept = data["observed_slip_rate_rank"].values, data["observed_slip_rate_most_kept"].values
    print("| what a text says | rank in the posterior predictive | bound kept with probability |\n| --- | --- | --- |")
    for row, r, k in zip(sorted(rows_of(RATES), key=lambda row: when(row["date"])), rank, kept):
        said = f"{row['cm_per_day']} cm/day" if row["cm_per_day"] else f"at most {row['most_cm_per_day']} cm/day"
        print(f"| {said}, {row['date'][:10]} ± {row['within_days']} d | {'' if np.isnan(r) else f'{r:.2f}'} | {'' if np.isnan(k) else f'{k:.2f}'} |")
    read = rank[~np.isnan(rank)]
    for share in (0.5, 0.9):
        print(f"within {share:.0%}: {np.sum(abs(read - 0.5) <= share / 2)} of {len(read)}")


def known_lake(folder, issue, later=()):
    """The levels that were known at an issue, and a scenario behind them."""
    path = os.path.join(folder, f"lake-{issue}-{len(later)}.csv")
    rows = [(row["date"], row["level_m"]) for row in rows_of(LAKE) if when(row["date"]) <= when(issue)]
    with open(path, "w", encoding="utf-8") as file:
        file.write("date,level_m\n" + "".join(f"{date},{level}\n" for date, level in rows + list(later)))
    return path


def failures(runs, draws, levels, issue):
    """Of draws that have not failed by the issue: the days to failure, inf beyond 60."""
    left = []
    for draw in draws:
        end = runs({**draw, LEVELS: levels})[2] - days(when(issue))
        if end > 0.0:
            left.append(end if end <= 60.0 else np.inf)
    return np.array(left)


def issues(arguments):
    runs = Runs(arguments.program)
    folder = runs.folder.name
    print("| issue | readings | the lake from then on | draws left | fail within 20 days | within 60 days | median, 90 % of those |\n"
          "| --- | --- | --- | --- | --- | --- | --- |")
    for issue in ISSUES:
        path = os.path.join(folder, f"{issue}.nc")
        settings = {LEVELS: known_lake(folder, issue), "fit.until": f"{days(when(issue))} day", **SHORT}
        words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
        call(arguments.program, "fit", CASE, RATES, "-o", path, "--force", "--threads", arguments.threads, *words)
        known = sum(when(row["date"]) <= when(issue) for row in rows_of(RATES))
        draws = draws_of(path, arguments.draws)
        down = (when(issue) + datetime.timedelta(days=15)).isoformat()
        for name, levels in (("stays", known_lake(folder, issue)), ("falls to 695 m in 15 days", known_lake(folder, issue, [(down, 695)])),
                             ("as it was", LAKE)):
            left = failures(runs, draws, levels, issue)
            soon = left[np.isfinite(left)]
            said = "" if len(soon) < 10 else " to ".join(f"{q:.0f}" for q in np.quantile(soon, (0.05, 0.95))) + " days"
            print(f"| {issue} | {known} | {name} | {len(left)} | {np.mean(left <= 20):.0%} | {np.mean(np.isfinite(left)):.0%} | "
                  f"{'' if len(soon) < 10 else f'{np.median(soon):.0f}; {said}'} |", flush=True)


def draw_rates(axes, grid, bands, best):
    dates = matplotlib.dates.date2num(START) + grid
    shown = np.exp(np.minimum(bands, 30.0))
    axes.fill_between(dates, shown[0], shown[4], color=BLUE, alpha=0.16, lw=0, label="90 % of the posterior")
    axes.fill_between(dates, shown[1], shown[3], color=BLUE, alpha=0.34, lw=0, label="50 %")
    axes.plot(matplotlib.dates.date2num(START) + best[0], best[1], color=BLUE, lw=1.6, label="best fit")
    axes.set_yscale("log")
    axes.set_ylim(1e-3, 400)
    axes.grid(axis="y", color=FAINT, lw=0.6)
    axes.set_axisbelow(True)


def draw_said(axes, labels):
    for row in rows_of(RATES):
        date, half, s = matplotlib.dates.date2num(when(row["date"])), float(row["within_days"]), float(row["sigma"])
        if row["cm_per_day"]:
            v = float(row["cm_per_day"])
            axes.errorbar(date, v, xerr=half, yerr=[[v - v * np.exp(-s)], [v * np.exp(s) - v]], color=SEEN, fmt="o", ms=5, lw=1.3, zorder=5,
                          label=None if "read" in labels else "a rate that a text states, ± its taken error and window")
            labels.append("read")
        else:
            most = float(row["most_cm_per_day"])
            axes.plot([date - half, date + half], [most, most], color=SEEN, lw=2, zorder=5, label=None if "most" in labels else "what it did not exceed")
            labels.append("most")
            axes.annotate("", (date, most / 3.2), (date, most), arrowprops={"arrowstyle": "-|>", "color": SEEN, "lw": 1.3}, zorder=5)


def draw_lake(axes):
    rows = rows_of(LAKE)
    dates = [matplotlib.dates.date2num(when(row["date"])) for row in rows]
    levels = [float(row["level_m"]) for row in rows]
    axes.fill_between(dates, levels, 580, color=GREEN, alpha=0.12, lw=0)
    axes.plot(dates, levels, color=GREEN, lw=1.2)
    axes.errorbar(dates, levels, yerr=[float(row["sigma_m"]) for row in rows], color=GREEN, fmt="o", ms=4, lw=1.0, mfc="white", zorder=5)
    axes.set_ylim(580, 725)
    axes.grid(axis="y", color=FAINT, lw=0.6)
    axes.set_axisbelow(True)


def picture(arguments):
    use_screen_style()
    runs = Runs(arguments.program)
    grid = np.concatenate([np.arange(0, 1090, 2.0), np.arange(1090, 1130.9, 0.1)])
    bands = np.quantile(rates_at(grid, runs, draws_of(arguments.fit, arguments.draws)), (0.05, 0.25, 0.5, 0.75, 0.95), axis=0, method="nearest")
    best = runs({})
    figure, axes = plt.subplots(2, 2, figsize=(10.5, 5.6), sharex="col", sharey="row", layout="constrained",
                                gridspec_kw={"width_ratios": (3, 1.15), "height_ratios": (2.1, 1)})
    spans = (("1960-08-15", "1963-10-20"), ("1963-09-20", "1963-10-11"))
    for column, span in enumerate(spans):
        top, low = axes[:, column]
        draw_rates(top, grid, bands, best[:2])
        draw_said(top, [])
        draw_lake(low)
        for one in (top, low):
            one.axvline(matplotlib.dates.date2num(FAILED), color=INK, lw=1.0, ls=(0, (4, 2)))
        low.set_xlim(*(matplotlib.dates.date2num(when(date)) for date in span))
    top, low = axes[:, 0]
    top.set_yticks([1e-3, 1e-2, 0.1, 1, 10, 100], ["0.001", "0.01", "0.1", "1", "10", "100"])
    top.set_ylabel("slip rate [cm/day]")
    low.set_ylabel("lake [m above the sea]")
    top.set_title("Vajont 1960 to 1963: one block, its lake, and nine figures from texts")
    axes[0, 1].set_title("the last three weeks")
    low.set_title("level of the lake: what texts state, straight lines between", color=QUIET, fontweight="normal")
    low.xaxis.set_major_locator(matplotlib.dates.MonthLocator(bymonth=(1, 4, 7, 10)))
    low.xaxis.set_major_formatter(matplotlib.dates.ConciseDateFormatter(low.xaxis.get_major_locator()))
    axes[1, 1].xaxis.set_major_locator(matplotlib.dates.DayLocator(bymonthday=(21, 27, 3, 9)))
    axes[1, 1].xaxis.set_major_formatter(matplotlib.dates.DateFormatter("%-d %b"))
    axes[0, 1].annotate("9 October, 22:39", (matplotlib.dates.date2num(FAILED), 0.0016), (-5, 0), textcoords="offset points", ha="right", color=INK, fontsize=8)
    axes[0, 0].legend(loc="upper center", ncols=2, fontsize=8)
    save(figure, arguments.output, small=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("what", choices=("fit", "issues", "picture"))
    parser.add_argument("--program", default=os.path.join(ROOT, "build", "lacuna"))
    parser.add_argument("--fit", default=os.path.join(ROOT, "build", "vajont-lake-fit.nc"))
    parser.add_argument("--threads", default=2, type=int)
    parser.add_argument("--draws", default=200, type=int)
    parser.add_argument("-o", "--output", default=os.path.join(ROOT, "docs", "images", "vajont-lake.png"))
    arguments = parser.parse_args()
    {"fit": fit, "issues": issues, "picture": picture}[arguments.what](arguments)


if __name__ == "__main__":
    main()
