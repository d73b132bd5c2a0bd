#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What `lacuna precursors` says of synthetic slopes that fail and of such that never do, as tables in Markdown.

    verdicts.py [--slopes 50] [--years 100] [--seed 1] [--cache FOLDER] [--only satellite,prism/log] [--program build/lacuna]
    verdicts.py --calibrate [--slopes 50] [--seed 1] [--cache FOLDER] ...

Slopes are drawn by slopes.py, or by --generator: --slopes for each instrument and failing kind; of each other kind as many,
or more, until they have --years. Failing slopes are asked at chosen shares of life left, a call each; the others at all
readings (radar hourly, extensometers daily) in one call. Beside the program stands plain inverse velocity, computed here.
With --calibrate only failing slopes are drawn, and the rows of src/forecast that fit their forecasts best are printed,
with what they cover of them. With --cache a study that was stopped goes on, and tables are made again without the
program; what another program or other options wrote there is refused. The same seed gives the same slopes.
"""

import argparse
import concurrent.futures
import copy
import functools
import hashlib
import importlib.util
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy

import calibration
import slopes
import verdict_tables as tables

EVERY = {"radar": 3600.0, "extensometer": slopes.DAY}  # issues no closer than this, on average


# ---- the program

class Missing(Exception):
    """The program's JSON lacks what this study reads."""


def need(of, *names):
    """What stands there; no other value takes its place."""
    for k, name in enumerate(names):
        if not isinstance(of, dict) or name not in of:
            raise Missing(f"the program's JSON has no {'.'.join(names[:k + 1])}, which this study reads: name another --program")
        of = of[name]
    return of


def issue_of(answer, failing):
    """The one place that knows the program's JSON, the last forecast's or a line of --jsonl: an issue of a row. Forecasts
    are of failing slopes: of each method issued 5, 25, 50, 75, 95 % of the time of failure, and what its row is made of."""
    verdict = need(answer, "verdict")
    issue = {"time": need(answer, "issue_time_s"), "level": need(verdict, "level_number"),
             "accelerates": need(verdict, "accelerates"), "p": need(verdict, "p"), "odds": need(verdict, "log_odds"),
             "needed": need(verdict, "log_odds_needed"), "horizon": need(verdict, "horizon_s"),
             "chance": need(verdict, "chance_within_horizon"), "pooled": need(verdict, "pooled_s"), "forecasts": {}}
    for key in ("level", "horizon"):
        if not isinstance(issue[key], (int, float)):
            raise Missing(f"the program's JSON has no number as a verdict's {key}")
    if issue["pooled"] is not None and None in issue["pooled"]:
        issue["pooled"] = None
    if failing:
        issued = [f for f in need(answer, "forecasts") if need(f, "issued")]
        issue["forecasts"] = {need(f, "method"): [need(f, "interval90_s")[0], need(f, "interval50_s")[0], need(f, "tc_s"),
                                                  f["interval50_s"][1], f["interval90_s"][1]] for f in issued}
        issue["start"] = need(answer, "window_start_s")
        issue["raw"] = {f["method"]: [need(f, "tc_raw_s"), need(f, "relative_error"), need(f, "posterior_s")] for f in issued}
    return issue


def ask(program, options, path, *words):
    words = [program, "precursors", path, "--time-format", "s", "--displacement", "displacement_m:m", "-q", *options, *words]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(" ".join(words) + ": " + done.stderr.strip())
    return done.stdout


def ask_at(program, options, path, end, failing):
    """The issue at a time."""
    return issue_of(json.loads(ask(program, options, path, "--json", "--until", f"{end:.3f} s")), failing)


def ask_rolling(program, options, path, issues, failing, *words):
    """So many issues in one call, evenly by number of readings."""
    lines = ask(program, options, path, "--rolling", "--jsonl", "--issues", str(issues), *words).splitlines()
    return [issue_of(json.loads(line), failing) for line in lines]


# ---- plain inverse velocity

def repaired(rise):
    """Without falls of ten times the median step: resets of the sensor."""
    moved = numpy.abs(rise[rise != 0])
    return numpy.where(rise < -10 * (numpy.median(moved) if len(moved) else 0), 0, rise)


def plain(time, displacement, every=None):
    """When it foretells failure from these readings, or None: its onset is the mean of the last 3 velocities above that
    of 7 (Carla et al. 2017), its answer where the straight line through the inverse of the last 8 velocities, each a mean
    of 3, meets zero. Instruments that read more often are averaged over `every` first, as is usual for them."""
    time, displacement = time[-1000:], displacement[-1000:]
    displacement = numpy.concatenate([[0], numpy.cumsum(repaired(numpy.diff(displacement)))])
    now = time[-1]
    if every is not None:
        _, part, count = numpy.unique(numpy.floor((time - now) / every - 1e-9), return_inverse=True, return_counts=True)
        time, displacement = (numpy.bincount(part, value) / count for value in (time, displacement))
    v, at = numpy.diff(displacement) / numpy.diff(time), time[1:]
    if len(v) < 10 or not v[-3:].mean() > v[-7:].mean():
        return None
    mean = numpy.convolve(v, numpy.ones(3) / 3, "valid")[-8:]
    middle = numpy.convolve(at, numpy.ones(3) / 3, "valid")[-8:]
    if (mean <= 0).any():
        return None
    slope, start = numpy.polyfit(middle - now, 1 / mean, 1)
    return max(now, now - start / slope) if slope < 0 else None


# ---- one slope

@functools.lru_cache
def generator_of(path):
    """slopes.py, or what takes its place: a module with its INSTRUMENTS, FAILING, LASTING, draw and csv."""
    found = importlib.util.spec_from_file_location("generator", path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def follow(job):
    """The row of one slope: what was issued when, by the program and by plain inverse velocity."""
    program, options, generator, instrument, kind, seed, every_reading = job
    slopes_of = generator_of(generator)
    slope = slopes_of.draw(instrument, kind, seed)
    time, displacement, failure = slope["time"], slope["displacement"], slope["failure"]
    words = [word for word in options if word != "--driver"]
    if "--driver" in options:
        words += [word for name in slope["drivers"] for word in ("--driver", f"{name}:mm:sum")]
    with tempfile.TemporaryDirectory(prefix="lacuna-verdicts-") as folder:
        path = os.path.join(folder, "slope.csv")
        with open(path, "w", encoding="utf-8") as out:
            out.write(slopes_of.csv(slope))
        if failure is None or every_reading:
            span = time[-1] - time[0]
            number = math.ceil(span / EVERY[instrument]) if instrument in EVERY else len(time)
            until = [] if failure is None else ["--until", f"{failure * (1 - min(tables.STEPS)):.3f} s"]
            issues = ask_rolling(program, words, path, min(number, len(time)), failure is not None, *until)
        else:
            ends = {time[time <= failure * (1 - left)][-1] for left in (*tables.LEFT, *tables.STEPS)}
            issues = [ask_at(program, words, path, end, True) for end in sorted(ends)]
    for issue in issues:
        known = time <= issue["time"]
        issue["plain"] = plain(time[known], displacement[known], EVERY.get(instrument))
    return {"seed": seed, "failure": failure, "span": float(time[-1] - time[0]), "issues": issues}


# ---- a population, with its cache

class Cache:
    """Rows of slopes, a file an instrument and kind, whose first line says what made them."""

    def __init__(self, folder, made_by):
        self.folder, self.made_by = folder, made_by
        if folder:
            os.makedirs(folder, exist_ok=True)

    def path(self, instrument, kind):
        return os.path.join(self.folder, f"{instrument}-{kind}.jsonl")

    def read(self, instrument, kind):
        if not self.folder or not os.path.exists(self.path(instrument, kind)):
            return {}
        rows, good = {}, 0
        with open(self.path(instrument, kind), "rb") as lines:
            first = lines.readline()
            if not first.endswith(b"\n"):
                return {}
            if json.loads(first) != self.made_by:
                sys.exit(f"{self.path(instrument, kind)}: of another program, generator or options: "
                         "name another folder, or remove it")
            good = lines.tell()
            for line in lines:
                if not line.endswith(b"\n"):  # stopped in the middle
                    break
                row = json.loads(line)
                rows[row["seed"]], good = row, good + len(line)
        os.truncate(self.path(instrument, kind), good)
        return rows

    def add(self, instrument, kind, row):
        if not self.folder:
            return
        path = self.path(instrument, kind)
        whole = os.path.exists(path) and open(path, "rb").readline().endswith(b"\n")
        with open(path, "a" if whole else "w", encoding="utf-8") as out:
            if not whole:
                out.write(json.dumps(self.made_by) + "\n")
            out.write(json.dumps(row) + "\n")


def digest(path):
    with open(path, "rb") as data:
        return hashlib.sha256(data.read()).hexdigest()[:16]


def population(arguments, pool, cache, instrument, kind):
    """Rows of all slopes of a kind, in the order of their seeds."""
    known, wanted, rows = cache.read(instrument, kind), arguments.slopes, []
    years = arguments.years if kind in generator_of(arguments.generator).LASTING else 0
    while True:
        seeds = [arguments.seed * 1000000 + k for k in range(len(rows), wanted)]
        jobs = [(arguments.program, arguments.options, arguments.generator, instrument, kind, seed, arguments.every_reading)
                for seed in seeds if seed not in known]
        for row in pool.map(follow, jobs):
            cache.add(instrument, kind, row)
            known[row["seed"]] = row
        rows += [known[seed] for seed in seeds]
        have = sum(row["span"] for row in rows) / slopes.YEAR
        if have >= years:
            return rows
        wanted = len(rows) + max(1, math.ceil((years - have) / have * len(rows) * 1.02))


# ---- calibration

def gather(failing):
    """{method: {instrument: {slope: [(row, issue, x, ln W, errors), ...]}}} of the forecasts at equal steps of log time left."""
    found = {}
    for (instrument, kind), of in failing.items():
        for row in of:
            for issue in tables.at_steps(row):
                for method, raw in issue["raw"].items():
                    seen = calibration.seen(issue["time"], issue["start"], *raw)
                    if seen is not None:
                        found.setdefault(method, {}).setdefault(instrument, {}).setdefault((kind, row["seed"]), []).append(
                            (row, issue, *seen))
    return found


def calibrate(failing):
    """Prints each method's row: instruments with enough slopes weigh the same, others as they have slopes, and so do slopes in
    each of them. Returns the same population with the intervals that these rows give."""
    failing = copy.deepcopy(failing)
    found = gather(failing)
    for of in failing.values():
        for issue in (issue for row in of for issue in row["issues"]):
            issue.update(forecasts={}, pooled=None, plain=None)
    for method, instruments in found.items():
        samples = [(sample, min(1, tables.ENOUGH / len(of)) / len(samples)) for of in instruments.values() for samples in of.values()
                   for sample in samples]
        rows, issues, x, window, errors = zip(*(sample for sample, _ in samples))
        x, window, errors = numpy.array(x), numpy.array(window), numpy.array(errors)
        truth = numpy.log([row["failure"] - issue["time"] for row, issue in zip(rows, issues)])
        loss, pull, spread, q = calibration.best(truth, x, window, errors, numpy.array([weight for _, weight in samples]))
        print(f"{method:12s} n {len(samples):5d}, loss {loss:.3f}  {calibration.row(pull, spread, q)}")
        for issue, left in zip(issues, numpy.exp(calibration.places(x, window, errors, pull, spread, q))):
            issue["forecasts"][method] = list(issue["time"] + left)
    print()
    return failing


# ---- the study

def wanted(only, instrument, kind):
    return only is None or any(part in (instrument, kind, f"{instrument}/{kind}") for part in only.split(","))


def options_of(arguments):
    """Options that every call has."""
    options = []
    for name, value in (("--levels", arguments.levels), ("--horizon", arguments.horizon)):
        if value is not None:
            options += [name, os.path.abspath(value) if name == "--levels" else f"{value:g} day"]
    if arguments.drivers:
        options.append("--driver")  # each slope's own, where it has one
    return options


def arguments_of():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--slopes", type=int, default=50, help="of each instrument and kind, at least: 50")
    parser.add_argument("--years", type=float, default=0, help="of slopes of each instrument and kind that never fails, at "
                        "least; 100 for the full study")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--calibrate", action="store_true", help="print the rows of src/forecast that fit this population")
    parser.add_argument("--only", help="instruments, kinds, or INSTRUMENT/KIND, with commas")
    parser.add_argument("--generator", default=slopes.__file__, help="another module that draws slopes, as slopes.py does")
    parser.add_argument("--cache", help="folder of JSON lines from which a study goes on")
    parser.add_argument("--every-reading", action="store_true", help="follow failing slopes reading by reading too, so that "
                        "levels have their whole history")
    parser.add_argument("--levels", help="file of thresholds, handed to the program")
    parser.add_argument("--horizon", type=float, help="days, handed to the program: 7")
    parser.add_argument("--drivers", action="store_true", help="hand rain to the program where there is some")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--program", default="build/lacuna")
    arguments = parser.parse_args()
    if arguments.slopes < 1:
        parser.error("--slopes: at least 1")
    arguments.program, arguments.generator = os.path.abspath(arguments.program), os.path.abspath(arguments.generator)
    arguments.options = options_of(arguments)
    return arguments


def draw_all(arguments):
    """{(instrument, kind): rows}"""
    levels = [digest(arguments.levels)] if arguments.levels else []
    made_by = {"program": digest(arguments.program), "slopes": digest(arguments.generator), "study": digest(__file__),
               "options": [os.path.basename(word) for word in arguments.options] + levels,
               "every_reading": arguments.every_reading}
    cache, found = Cache(arguments.cache, made_by), {}
    drawn = generator_of(arguments.generator)
    kinds = drawn.FAILING if arguments.calibrate else (*drawn.FAILING, *drawn.LASTING)
    with concurrent.futures.ProcessPoolExecutor(arguments.processes) as pool:
        for instrument in drawn.INSTRUMENTS:
            for kind in kinds:
                if wanted(arguments.only, instrument, kind):
                    found[instrument, kind] = population(arguments, pool, cache, instrument, kind)
                    print(f"{instrument} {kind}: {len(found[instrument, kind])}", file=sys.stderr, flush=True)
    return found


def main():
    arguments = arguments_of()
    try:
        found = draw_all(arguments)
    except Missing as missing:
        sys.exit(f"verdicts.py: {missing}")
    failing = {name: of for name, of in found.items() if name[1] in generator_of(arguments.generator).FAILING}
    lasting = {name: of for name, of in found.items() if name not in failing and name[1] != "arrest"}
    arrests = {name: of for name, of in found.items() if name[1] == "arrest"}
    if arguments.calibrate:
        tables.coverage(calibrate(failing), arguments.seed)
        return 0
    print(f"Seed {arguments.seed}; shares are given with their standard errors.\n")
    if failing:
        tables.detection(failing)
        tables.coverage(failing, arguments.seed)
        tables.errors(failing)
    for title, of in (("Slopes that never fail", lasting), ("Slopes that accelerate and come to rest", arrests)):
        if of:
            tables.false_alarms(title, of)
    if failing and lasting:
        tables.trade(failing, lasting)
    return 0


if __name__ == "__main__":
    sys.exit(main())
