#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What `lacuna precursors` says of synthetic slopes that fail and of such that never do, as tables in Markdown.

    verdicts.py [--slopes 50] [--years 100] [--seed 1] [--cache FOLDER] [--only satellite,prism/log] [--program build/lacuna]

Slopes are drawn by slopes.py: --slopes for each instrument and failing kind; of each kind that never fails as many,
or more, until they have --years. Failing slopes are asked at chosen shares of life left, the others at all readings
(radar hourly, extensometers daily). Beside the program stands plain inverse velocity, computed here. With --cache a
study that was stopped goes on, and tables are made again without the program; what another program or other options
wrote there is refused. The same seed gives the same slopes.
"""

import argparse
import concurrent.futures
import hashlib
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy

import slopes

LEFT = (0.20, 0.10, 0.05, 0.02)  # shares of life left at which levels are asked
STEPS = (0.30, 0.20, 0.14, 0.10, 0.07, 0.05, 0.035, 0.025)  # and forecasts judged: equal steps of log time left
EVERY = {"radar": 3600.0, "extensometer": slopes.DAY}  # issues no closer than this, on average
LEVELS = ("quiet", "watch", "warning", "alarm")
WARNING, ALARM = 2, 3
PLAIN = "plain inverse velocity"
FRACTIONS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)  # of the record so far: thresholds of the trade-off


# ---- the program

def column(rolling, name):
    """What the rolling forecasts say by this name: a list beside the issues, or a member of each."""
    if name in rolling:
        return rolling[name]
    return [issue.get(name) for issue in rolling["issues"]]


def level_of_methods(issue, horizon):
    """Stands in where the program gives no level: warning where any method alarms, alarm where most do."""
    issued = [f for f in issue["forecasts"] if f["issued"] and f["method"] != "persistence"]
    near = sum(f["interval50_s"][1] <= issue["issue_time_s"] + horizon for f in issued)
    return ALARM if near > len(issue["forecasts"]) / 2 else WARNING if near else int(bool(issued))


def trend_of_reasons(issue):
    reasons = [f["reason"] or "" for f in issue["forecasts"] if f["method"] != "persistence"]
    if any("cannot tell" in reason for reason in reasons):
        return "unknown"
    return "no" if all("no acceleration" in reason for reason in reasons) else "yes"


def read_rolling(answer):
    """The one place that knows what the program's JSON looks like: a list of issues, each with time, level 0 to 3,
    trend (yes, no, unknown), pooled (5, 25, 50, 75, 95 % or None) and of each method issued the same five times."""
    rolling, issues = answer["rolling"], []
    rows = zip(rolling["issues"], column(rolling, "alarm_level"), column(rolling, "trend"), column(rolling, "pooled_s"))
    for issue, level, trend, pooled in rows:
        if isinstance(trend, dict):
            trend = trend["accelerates"]
        forecasts = {f["method"]: [f["interval90_s"][0], f["interval50_s"][0], f["tc_s"], f["interval50_s"][1],
                                   f["interval90_s"][1]] for f in issue["forecasts"] if f["issued"]}
        if isinstance(level, str):
            level = LEVELS.index(level)
        issues.append({"time": issue["issue_time_s"], "pooled": pooled, "forecasts": forecasts,
                       "trend": trend if trend is not None else trend_of_reasons(issue),
                       "level": level if level is not None else level_of_methods(issue, rolling["horizon_s"])})
    return issues


def ask(program, options, path, issues, until=None):
    words = [program, "precursors", path, "--time-format", "s", "--displacement", "displacement_m:m", "--rolling",
             "--issues", str(issues), "--json", "-q", *options]
    if until is not None:
        words += ["--until", f"{until:.3f} s"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(" ".join(words) + ": " + done.stderr.strip())
    return read_rolling(json.loads(done.stdout))


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


def warns(issue, rule, horizon):
    """Whether plain inverse velocity warns at this issue."""
    reach = horizon if rule == "horizon" else 0.1 * issue["time"]
    return issue["plain"] is not None and issue["plain"] - issue["time"] <= reach


# ---- one slope

def follow(job):
    """The row of one slope: what was issued when, by the program and by plain inverse velocity."""
    program, options, instrument, kind, seed, every_reading = job
    slope = slopes.draw(instrument, kind, seed)
    time, displacement, failure = slope["time"], slope["displacement"], slope["failure"]
    words = [word for word in options if word != "--driver"]
    if "--driver" in options:
        words += [word for name in slope["drivers"] for word in ("--driver", f"{name}:mm:sum")]
    with tempfile.TemporaryDirectory(prefix="lacuna-verdicts-") as folder:
        path = os.path.join(folder, "slope.csv")
        with open(path, "w", encoding="utf-8") as out:
            out.write(slopes.csv(slope))
        if failure is None or every_reading:
            span = time[-1] - time[0]
            number = math.ceil(span / EVERY[instrument]) if instrument in EVERY else len(time)
            until = None if failure is None else failure * (1 - min(LEFT))
            issues = ask(program, words, path, min(number, len(time)), until)
        else:
            ends = {time[time <= failure * (1 - left)][-1] for left in (*LEFT, *STEPS)}
            issues = [ask(program, words, path, 1, end)[-1] for end in sorted(ends)]
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
    years = arguments.years if kind in slopes.LASTING else 0
    while True:
        seeds = [arguments.seed * 1000000 + k for k in range(len(rows), wanted)]
        jobs = [(arguments.program, arguments.options, instrument, kind, seed, arguments.every_reading)
                for seed in seeds if seed not in known]
        for row in pool.map(follow, jobs):
            cache.add(instrument, kind, row)
            known[row["seed"]] = row
        rows += [known[seed] for seed in seeds]
        have = sum(row["span"] for row in rows) / slopes.YEAR
        if have >= years:
            return rows
        wanted = len(rows) + max(1, math.ceil((years - have) / have * len(rows) * 1.02))


# ---- numbers

def at_left(row, left):
    """The last issue with at least this share of the life left."""
    return [issue for issue in row["issues"] if issue["time"] <= row["failure"] * (1 - left) + 1e-6][-1]


def share(values):
    """A share in percent and its binomial standard error."""
    n = len(values)
    if n == 0:
        return "-"
    p = sum(values) / n
    return f"{100 * p:.0f} ± {100 * math.sqrt(p * (1 - p) / n):.0f}"


def upper(count, years):
    """The rate a year that gives no more than so many in one of ten."""
    low, high = 0.0, count + 10 + 5 * math.sqrt(count + 1)
    for _ in range(80):
        middle = (low + high) / 2
        terms = [-middle + k * math.log(middle) - math.lgamma(k + 1) for k in range(count + 1)]
        below = sum(math.exp(term) for term in terms)
        low, high = (middle, high) if below > 0.1 else (low, middle)
    return high / years


def entries(row, warned, horizon):
    """How often it was entered: again within a horizon after it was last in force is the same."""
    count, last = 0, -math.inf
    inside = False
    for issue in row["issues"]:
        if warned(issue):
            count += not inside and issue["time"] - last > horizon
            last, inside = issue["time"], True
        else:
            inside = False
    return count


def table(title, head, rows):
    print(f"### {title}\n\n| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print()


def levels_of(rows, warned):
    return [share([warned(at_left(row, left)) for row in rows]) for left in LEFT]


def rate(rows, warned, horizon):
    years = sum(row["span"] for row in rows) / slopes.YEAR
    count = sum(entries(row, warned, horizon) for row in rows)
    return [count, f"{count / years:.3g}", f"{upper(count, years):.3g}"]


def detection(found, horizon):
    """Tables of slopes that fail."""
    percent = [f"at {100 * left:.0f} % left" for left in LEFT]
    rows = []
    for (instrument, kind), of in found.items():
        late = [at_left(row, 0.05) for row in of]
        forecast = [not (set(issue["forecasts"]) - {"persistence"} or issue["pooled"]) for issue in late]
        rows.append([instrument, kind, len(of), *levels_of(of, lambda issue: issue["level"] >= WARNING),
                     share([issue["level"] >= ALARM for issue in late]), share(forecast),
                     share([issue["trend"] == "unknown" for issue in late])])
    table("Slopes that fail: share at warning or above, %", ["instrument", "kind", "n", *percent, "alarm at 5 % left",
          "no forecast at 5 % left", "cannot tell at 5 % left"], rows)
    rows = []
    for (instrument, kind), of in found.items():
        none = share([at_left(row, 0.05)["plain"] is None for row in of])
        rows.append([instrument, kind, len(of), *levels_of(of, lambda issue: warns(issue, "horizon", horizon)),
                     *levels_of(of, lambda issue: warns(issue, "share", horizon)), none])
    table("The same, plain inverse velocity: its time within the horizon, or within a tenth of the record so far",
          ["instrument", "kind", "n", *percent, *(f"tenth, {name}" for name in percent), "no forecast at 5 % left"], rows)


def false_alarms(title, found, horizon):
    rows, beside = [], []
    for (instrument, kind), of in found.items():
        years = f"{sum(row['span'] for row in of) / slopes.YEAR:.3g}"
        unknown = [issue["trend"] == "unknown" for row in of for issue in row["issues"]]
        rows.append([instrument, kind, len(of), years, *rate(of, lambda issue: issue["level"] >= WARNING, horizon),
                     *rate(of, lambda issue: issue["level"] >= ALARM, horizon), f"{100 * numpy.mean(unknown):.0f}"])
        beside.append([instrument, kind, len(of), years, *rate(of, lambda issue: warns(issue, "horizon", horizon), horizon),
                       *rate(of, lambda issue: warns(issue, "share", horizon), horizon)])
    head = ["instrument", "kind", "n", "slope-years"]
    table(f"{title}: entries into warning or above, and into alarm", [*head, "warnings", "a year", "90 % bound", "alarms",
          "a year", "90 % bound", "cannot tell, % of readings"], rows)
    table(f"{title}, plain inverse velocity: within the horizon, or within a tenth of the record so far",
          [*head, "horizon", "a year", "90 % bound", "tenth", "a year", "90 % bound"], beside)


def judged(found):
    """(slope, method, issue time, five times or plain's one, failure) of the issues at equal steps of log time left."""
    for name, of in found.items():
        for row in of:
            seen = {}
            for left in STEPS:
                issue = at_left(row, left)
                seen[issue["time"]] = issue
            for now, issue in seen.items():
                everything = dict(issue["forecasts"])
                if issue["pooled"]:
                    everything["pooled"] = issue["pooled"]
                if issue["plain"] is not None:
                    everything[PLAIN] = [None, None, issue["plain"], None, None]
                for method, times in everything.items():
                    yield (*name, row["seed"]), method, now, times, row["failure"]


def lead_name(k):
    days = 2.0 ** k
    for unit, size in (("year", 365.25), ("day", 1.0), ("hour", 1 / 24), ("minute", 1 / 1440)):
        if days >= size or unit == "minute":
            return f"{days / size:.3g} to {2 * days / size:.3g} {unit}"
    return ""


def coverage(found, seed):
    rng, classes = numpy.random.default_rng(seed), {}
    for slope, method, now, times, failure in judged(found):
        if times[0] is None or times[2] <= now:
            continue
        k = math.floor(math.log2((times[2] - now) / slopes.DAY))
        inside = (times[1] <= failure <= times[3], times[0] <= failure <= times[4])
        classes.setdefault((method, k), {}).setdefault(slope, []).append(inside)
    rows, all_of = [], {}
    for (method, k), of in sorted(classes.items()):
        one = numpy.array([of[slope][rng.integers(len(of[slope]))] for slope in sorted(of)], float)
        rows.append([method, lead_name(k), len(one), *covered(rng, one)])
        for slope, inside in of.items():
            all_of.setdefault(method, {}).setdefault(slope, []).extend(inside)
    for method, of in all_of.items():
        one = numpy.array([of[slope][rng.integers(len(of[slope]))] for slope in sorted(of)], float)
        rows.append([method, "all", len(one), *covered(rng, one)])
    table("Slopes that fail: true times inside the intervals, %, by the forecast's own lead, one of each slope in a class",
          ["method", "lead", "slopes", "in 50 %", "in 90 %"], rows)


def covered(rng, inside):
    """Means in percent with their standard errors, by drawing the slopes again."""
    again = inside[rng.integers(0, len(inside), (1000, len(inside)))].mean(axis=1)
    return [f"{100 * mean:.0f} ± {100 * error:.0f}" for mean, error in zip(inside.mean(axis=0), again.std(axis=0))]


def errors(found):
    """Median |log10| of predicted over true remaining time, and skill where both were issued."""
    of = {}
    for slope, method, now, times, failure in judged(found):
        if times[2] > now:
            of.setdefault((slope[0], method), {})[(slope, now)] = abs(math.log10((times[2] - now) / (failure - now)))
    rows = []
    for (instrument, method), off in sorted(of.items()):
        cells = [instrument, method, len(off), f"{numpy.median(list(off.values())):.2f}"]
        for beside in ("persistence", PLAIN):
            other = of.get((instrument, beside), {})
            both = sorted(set(off) & set(other))
            if method == beside or not both:
                cells += ["-", ""]
                continue
            skill = 1 - numpy.median([off[key] for key in both]) / numpy.median([other[key] for key in both])
            cells += [f"{skill:+.2f}", len(both)]
        rows.append(cells)
    table("Slopes that fail: median |log10(predicted / true time left)|, and 1 - its ratio to that of a baseline where both "
          "were issued", ["instrument", "method", "n", "median", "over persistence", "n", f"over {PLAIN}", "n"], rows)


def thresholds():
    """(name, rule) of the points of the trade-off."""
    for level in (1, WARNING, ALARM):
        yield f"level {LEVELS[level]}", lambda issue, level=level: issue["level"] >= level
    for part in FRACTIONS:
        yield (f"pooled 75 % within {part:g} of the record", lambda issue, part=part: bool(issue["pooled"])
               and issue["pooled"][3] - issue["time"] <= part * issue["time"])
    for part in FRACTIONS:
        yield (f"{PLAIN} within {part:g} of the record", lambda issue, part=part: issue["plain"] is not None
               and issue["plain"] - issue["time"] <= part * issue["time"])


def trade(failing, lasting, horizon):
    rows = []
    for instrument in slopes.INSTRUMENTS:
        fail = [row for (name, _), of in failing.items() if name == instrument for row in of]
        last = [row for (name, kind), of in lasting.items() if name == instrument and kind != "arrest" for row in of]
        pooled = any(issue["pooled"] for row in fail for issue in row["issues"])
        if not fail or not last:
            continue
        for name, warned in thresholds():
            if pooled or not name.startswith("pooled"):
                rows.append([instrument, name, *levels_of(fail, warned), *rate(last, warned, horizon)[1:]])
    table("Detection against false alarms, all kinds together (arrest left out)", ["instrument", "threshold",
          *(f"found at {100 * left:.0f} % left, %" for left in LEFT), "false alarms a year", "90 % bound"], rows)


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
    parser.add_argument("--only", help="instruments, kinds, or INSTRUMENT/KIND, with commas")
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
    arguments.program = os.path.abspath(arguments.program)
    arguments.options = options_of(arguments)
    return arguments


def main():
    arguments = arguments_of()
    horizon = (arguments.horizon or 7.0) * slopes.DAY
    levels = [digest(arguments.levels)] if arguments.levels else []
    made_by = {"program": digest(arguments.program), "slopes": digest(slopes.__file__), "study": digest(__file__),
               "options": [os.path.basename(word) for word in arguments.options] + levels,
               "every_reading": arguments.every_reading}
    cache, found = Cache(arguments.cache, made_by), {}
    with concurrent.futures.ProcessPoolExecutor(arguments.processes) as pool:
        for instrument in slopes.INSTRUMENTS:
            for kind in (*slopes.FAILING, *slopes.LASTING):
                if wanted(arguments.only, instrument, kind):
                    found[instrument, kind] = population(arguments, pool, cache, instrument, kind)
                    print(f"{instrument} {kind}: {len(found[instrument, kind])}", file=sys.stderr, flush=True)
    failing = {name: of for name, of in found.items() if name[1] in slopes.FAILING}
    lasting = {name: of for name, of in found.items() if name[1] in slopes.LASTING and name[1] != "arrest"}
    arrests = {name: of for name, of in found.items() if name[1] == "arrest"}
    print(f"Seed {arguments.seed}, horizon {horizon / slopes.DAY:g} days; shares are given with their standard errors.\n")
    if failing:
        detection(failing, horizon)
        coverage(failing, arguments.seed)
        errors(failing)
    for title, of in (("Slopes that never fail", lasting), ("Slopes that accelerate and come to rest", arrests)):
        if of:
            false_alarms(title, of, horizon)
    trade(failing, lasting, horizon)
    return 0


if __name__ == "__main__":
    sys.exit(main())
