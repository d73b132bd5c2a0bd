# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of verdicts on synthetic slopes, in Markdown. {(instrument, kind): rows} is what they are made of; a row is one
slope, with its issues in order, as verdicts.py leaves them.

Warned is whoever is at level warning or above. A false alarm is an entry into that by a slope that never fails; again
within a horizon after it was last in force is the same. Shares have their binomial errors, rates their upper 90 % bounds.
"""

import math

import numpy

import slopes

LEFT = (0.20, 0.10, 0.05, 0.02)  # shares of life left at which levels are asked
# and forecasts judged: equal steps of log time left, from before most forecasts to after most. A narrow range would have only
# its own leads: whatever else is forecast is wrong, and coverage by lead is that of the range
STEPS = tuple(round(0.6 / 1.5 ** k, 4) for k in range(12))
LEVELS = ("quiet", "watch", "warning", "alarm")
WARNING, ALARM = 2, 3
PLAIN = "plain inverse velocity"
FRACTIONS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)  # of the record so far: thresholds of the trade-off
ODDS = (-8, -4, -2, -1, 0, 1, 2, 4, 8)  # above those that a warning needs: thresholds too
ENOUGH = 50  # slopes of a class whose coverage is held against its bounds
WITHIN = ((45, 55), (86, 94))  # percent that 50 and 90 % intervals are to hold


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


def entries(row, warned):
    """How often it was entered: again within a horizon after it was last in force is the same."""
    count, last = 0, -math.inf
    inside = False
    for issue in row["issues"]:
        if warned(issue):
            count += not inside and issue["time"] - last > issue["horizon"]
            last, inside = issue["time"], True
        else:
            inside = False
    return count


def is_warned(issue):
    return issue["level"] >= WARNING


def is_alarmed(issue):
    return issue["level"] >= ALARM


def cannot_tell(issue):
    return issue["accelerates"] == "cannot tell"


def has_none(issue):
    """No forecast: no method but the baseline issues one."""
    return not set(issue["forecasts"]) - {"persistence"}


def plain_within(reach):
    """Whether plain inverse velocity warns: its time within a part of the record so far, or the horizon (None)."""
    return lambda issue: issue["plain"] is not None and (
        issue["plain"] - issue["time"] <= (issue["horizon"] if reach is None else reach * issue["time"]))


def has_no_plain(issue):
    return issue["plain"] is None


def table(title, head, rows):
    print(f"### {title}\n\n| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |")
    print()


def years_of(rows):
    return sum(row["span"] for row in rows) / slopes.YEAR


def rate(rows, warned):
    """Entries, those a year, and the bound."""
    count, years = sum(entries(row, warned) for row in rows), years_of(rows)
    return [count, f"{count / years:.3g}", f"{upper(count, years):.3g}"]


def shares_at(rows, left, *asked):
    issues = [at_left(row, left) for row in rows]
    return [share([ask(issue) for issue in issues]) for ask in asked]


def of_instruments(found):
    """{instrument: rows of all its kinds}"""
    together = {}
    for (instrument, _), of in found.items():
        together.setdefault(instrument, []).extend(of)
    return together


# ---- slopes that fail

def detection(found):
    asked = (is_warned, is_alarmed, cannot_tell, has_none, plain_within(None), plain_within(0.1), has_no_plain)
    head = ["n", "warning or above", "alarm", "cannot tell", "no forecast", f"{PLAIN}: within the horizon",
            "within a tenth of the record so far", "no forecast"]
    table("Slopes that fail, all kinds together, %", ["instrument", "life left", *head],
          [[instrument, f"{100 * left:.0f} %", len(of), *shares_at(of, left, *asked)]
           for instrument, of in of_instruments(found).items() for left in LEFT])
    table("The same of each kind, 5 % of life left", ["instrument", "kind", *head],
          [[*name, len(of), *shares_at(of, 0.05, *asked)] for name, of in found.items()])
    table("The same of each kind: warning or above, %", ["instrument", "kind", "n",
          *(f"at {100 * left:.0f} % left" for left in LEFT)],
          [[*name, len(of), *(shares_at(of, left, is_warned)[0] for left in LEFT)] for name, of in found.items()])


def at_steps(row):
    """Issues at equal steps of log time left, each once."""
    return list({issue["time"]: issue for issue in (at_left(row, left) for left in STEPS)}.values())


def judged(found):
    """(slope, method, issue time, five times or plain's one, failure) of the issues at equal steps of log time left."""
    for name, of in found.items():
        for row in of:
            for issue in at_steps(row):
                everything = dict(issue["forecasts"])
                if issue["pooled"]:
                    everything["pooled"] = issue["pooled"]
                if issue["plain"] is not None:
                    everything[PLAIN] = [None, None, issue["plain"], None, None]
                for method, times in everything.items():
                    yield (*name, row["seed"]), method, issue["time"], times, row["failure"]


def lead_name(k):
    days = 2.0 ** k
    for unit, size in (("year", 365.25), ("day", 1.0), ("hour", 1 / 24), ("minute", 1 / 1440)):
        if days >= size or unit == "minute":
            return f"{days / size:.3g} to {2 * days / size:.3g} {unit}"
    return ""


def covered(rng, of):
    """Number of slopes, and the shares inside of one forecast of each in percent with their errors, by drawing the slopes
    again: [(mean, error) of 50 %, of 90 %]."""
    one = numpy.array([of[slope][rng.integers(len(of[slope]))] for slope in sorted(of)], float)
    again = one[rng.integers(0, len(one), (1000, len(one)))].mean(axis=1)
    return len(one), [(100 * mean, 100 * error) for mean, error in zip(one.mean(axis=0), again.std(axis=0))]


def inside_of(found):
    """{(method, lead class or None, instrument or None): {slope: [whether in 50 %, in 90 %]}}"""
    groups = {}
    for slope, method, now, times, failure in judged(found):
        if times[0] is None or times[2] <= now:
            continue
        lead = math.floor(math.log2((times[2] - now) / slopes.DAY))
        inside = (times[1] <= failure <= times[3], times[0] <= failure <= times[4])
        for key in ((method, lead, None), (method, None, slope[0]), (method, None, None)):
            groups.setdefault(key, {}).setdefault(slope, []).append(inside)
    return groups


def coverage(found, seed):
    rng, by_lead, by_instrument, kept = numpy.random.default_rng(seed), [], [], {}
    groups = inside_of(found)
    for method, lead, instrument in sorted(groups, key=lambda key: tuple((part is None, part) for part in key)):
        n, both = covered(rng, groups[method, lead, instrument])
        cells = [f"{mean:.0f} ± {error:.0f}" for mean, error in both]
        if instrument is None:
            by_lead.append([method, "all" if lead is None else lead_name(lead), n, *cells])
        else:
            by_instrument.append([method, instrument, n, *cells])
        if lead is not None and n >= ENOUGH:
            kept.setdefault(method, []).append([low - more * error <= mean <= high + more * error
                                                for (mean, error), (low, high) in zip(both, WITHIN) for more in (0, 2)])
    title = "Slopes that fail: true times inside the intervals, %"
    table(f"{title}, by the forecast's own lead (issue to printed median), one of each slope in a class",
          ["method", "lead", "slopes", "in 50 %", "in 90 %"], by_lead)
    table(f"{title}, by instrument", ["method", "instrument", "slopes", "in 50 %", "in 90 %"], by_instrument)
    table(f"Classes of lead of at least {ENOUGH} slopes, and of them those inside the bounds", ["method", "classes",
          *(f"{low} to {high} %{more}" for low, high in WITHIN for more in ("", ", or within two errors"))],
          [[method, len(of), *(sum(column) for column in zip(*of))] for method, of in kept.items()])


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


# ---- slopes that never fail

def with_sums(found):
    """The kinds of all instruments, and where there are several all instruments of each kind, all kinds of each."""
    groups = dict(found)
    for place in (0, 1):
        for name in dict.fromkeys(name[place] for name in found):
            of = [rows for other, rows in found.items() if other[place] == name]
            if len(of) > 1:
                groups[(name, "all") if place == 0 else ("all", name)] = [row for rows in of for row in rows]
    return groups


def false_alarms(title, found):
    rows = []
    for name, of in with_sums(found).items():
        years = years_of(of)
        warnings = rate(of, is_warned)
        unknown = [cannot_tell(issue) for row in of for issue in row["issues"]]
        rows.append([*name, len(of), f"{years:.3g}", *warnings, f"{20 * warnings[0] / years:.2g}",
                     f"{20 * upper(warnings[0], years):.2g}", *rate(of, is_alarmed), f"{100 * numpy.mean(unknown):.0f}",
                     *rate(of, plain_within(None)), *rate(of, plain_within(0.1))])
    bounded = ["a year", "90 % bound"]
    table(f"{title}: entries into warning or above, into alarm, and of {PLAIN} within the horizon or a tenth of the record",
          ["instrument", "kind", "n", "slope-years", "warnings", *bounded, "in 20 years", "90 % bound", "alarms", *bounded,
           "cannot tell, % of readings", f"{PLAIN}: horizon", *bounded, "tenth", *bounded], rows)


# ---- both

def thresholds():
    """(name, rule) of the points of the trade-off."""
    for level in (1, WARNING, ALARM):
        yield f"level {LEVELS[level]}", lambda issue, level=level: issue["level"] >= level
    for more in ODDS:
        yield (f"ln odds {more:+g} above those of a warning", lambda issue, more=more: issue["odds"] is not None
               and issue["odds"] >= issue["needed"] + more)
    for part in FRACTIONS:
        yield (f"pooled 75 % within {part:g} of the record", lambda issue, part=part: bool(issue["pooled"])
               and issue["pooled"][3] - issue["time"] <= part * issue["time"])
    for part in FRACTIONS:
        yield f"{PLAIN} within {part:g} of the record", plain_within(part)


def trade(failing, lasting):
    fails, lasts, rows = of_instruments(failing), of_instruments(lasting), []
    for instrument in fails:
        if instrument in lasts:
            rows += [[instrument, name, *(shares_at(fails[instrument], left, warned)[0] for left in LEFT),
                      *rate(lasts[instrument], warned)[1:]] for name, warned in thresholds()]
    table("Detection against false alarms, all kinds together (arrest left out)", ["instrument", "threshold",
          *(f"found at {100 * left:.0f} % left, %" for left in LEFT), "false alarms a year", "90 % bound"], rows)
