#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Critical shear force over rules, dimensions and beta, beside other values, in markdown.

    tools/plot/rg_table.py [CASE] [--seeds N] [--jobs N] [--parts table,variants,grids,places,map,paper]
                      [--levels N] [--dimensions D ...] [--grids N ...] [--json FILE]

Calls `lacuna rg --json` on the case (cases/rg/table.yaml), whose normal load is chosen for each
interface so that the slope of log2 N on all dyadic levels is the stated dimension; waves run from
the side to n/2 - 1 a side on n x n cells.
  table     Q_crit/Q_nom of FIX, CONS and LUMP with the elastic field, mean +- standard error; the
            values of another implementation in another language (12 interfaces of its own); how
            many combined standard errors lie between them; and what the paper states
  variants  H = 1, and the field `equal`, likewise
  grids     FIX and LUMP on grids of 2^N cells a side, likewise
  places    scatter among interfaces, and among 16 places of the blocks on each
  map       slope lambda and fixed point C of the map of slipped fractions, fitted to the pairs of
            each interface, and to those of the mean over the interfaces (needs numpy, netCDF4)
  paper     the paper's three values among the interfaces of each reading of its text: rule, field,
            H, D, Q_crit where the joint slides or where a part C of the cells has slipped; how many
            standard deviations of one interface they lie off, and how often one interface would lie
            further (Hotelling's T^2; needs numpy, netCDF4)
"""

import argparse
import importlib
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BETAS = (0.8, 0.7, 0.6)
DIMENSIONS = (1.2, 1.39, 1.55, 1.7, 1.85)
PARTS = ("table", "variants", "grids", "places", "map", "paper")
# Another implementation: 12 interfaces of 256^2 cells, H = 0.8, one place of the blocks.
OTHER = {
    ("fix", 1.2): (.964, .865, .694), ("fix", 1.39): (.962, .823, .627),
    ("fix", 1.55): (.955, .795, .554), ("fix", 1.7): (.945, .745, .505),
    ("fix", 1.85): (.919, .647, .427), ("cons", 1.39): (.800, .701, .602),
    ("cons", 1.7): (.800, .700, .601), ("lump", 1.39): (.919, .871, .829),
    ("lump", 1.7): (.906, .858, .810),
}
OTHER_HURST_1 = (.905, .702, .505)
OTHER_EQUAL = {1.39: (.894, .730, .601), 1.7: (.867, .693, .563)}
OTHER_GRIDS = {5: (None, None, .746), 8: (.955, .795, .554), 10: (None, None, .449)}
# Its standard deviation among interfaces; that of CONS was not stated: that of this one.
OTHER_SD = dict(zip(BETAS, (.02, .04, .05)))
OTHER_INTERFACES = 12
PAPER = dict(zip(BETAS, (.89, .76, .49)))


class Runner:
    """Calls the program; what was asked for before is not computed again."""

    def __init__(self, arguments, folder):
        self.arguments, self.folder, self.done = arguments, folder, {}

    def of(self, levels, seeds, dimension, **settings):
        """What a run gives; keys of `settings` have _ for the dot."""
        waves = max(2, 2 ** (levels - 1) - 1)
        values = {"interface.levels": levels, "rg.seeds": seeds, "load.normal.dimension": dimension,
                  # a little shorter, lest rounding drops the last waves
                  "interface.surface.self-affine.shortest": f"{(1 - 1e-7) / waves:.10g}",
                  "rg.beta": f"[{', '.join(map(str, BETAS))}]", "rg.shifts": 1}
        names = {"rule": "rg.rule", "field": "rg.field", "shifts": "rg.shifts",
                 "hurst": "interface.surface.self-affine.hurst", "contacts": "rg.contacts"}
        values.update({names[key]: value for key, value in settings.items()})
        key = tuple(sorted(values.items()))
        if key not in self.done:
            self.done[key] = self.call(key, len(self.done))
        return self.done[key]

    def call(self, key, number):
        words = [self.arguments.program, "rg", self.arguments.case, "--json", "--no-progress",
                 "--jobs", str(self.arguments.jobs), "-o", os.path.join(self.folder, f"{number}.nc")]
        for name, value in key:
            words += ["--set", f"{name}={value}"]
        for override in self.arguments.set:
            words += ["--set", override]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise SystemExit(f"rg_table: {done.stderr.strip()}")
        return json.loads(done.stdout)


def mean_and_error(result):
    """Of the interfaces; a single one has no error."""
    values = result["q_crit_of_interfaces"]
    error = statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else math.nan
    return statistics.mean(values), error


def beside(result, other, rule):
    """A cell: this value, the other one and what lies between them."""
    mean, error = mean_and_error(result)
    text = f"{mean:.3f} ± {error:.3f}"
    if other is None:
        return text, None
    count = len(result["q_crit_of_interfaces"])
    sd = error * math.sqrt(count) if rule == "cons" else OTHER_SD[round(result["beta"], 3)]
    combined = math.hypot(error, sd / math.sqrt(OTHER_INTERFACES), 0.0005 / math.sqrt(3))
    away = (mean - other) / combined
    return f"{text} ({other:.3f}, {away:+.1f})", away


class Table:
    """Rows in markdown; keeps what lies between this and the other implementation."""

    def __init__(self, names):
        self.away = []
        print("\n| " + " | ".join(names) + " |")
        print("| " + " | ".join("---" for _ in names) + " |")

    def row(self, *cells):
        print("| " + " | ".join(cells) + " |", flush=True)

    def cell(self, result, other, rule):
        text, away = beside(result, other, rule)
        if away is not None:
            self.away.append(away)
        return text

    def sum_up(self):
        if self.away:
            rms = math.sqrt(statistics.mean(x * x for x in self.away))
            inside = sum(abs(x) <= 2 for x in self.away)
            print(f"\n{inside} of {len(self.away)} within two combined standard errors; rms "
                  f"{rms:.2f} of them.")


def main_table(run, arguments):
    found = {(rule, d): run.of(arguments.levels, arguments.seeds, d, rule=rule)
            for d in arguments.dimensions for rule in ("fix", "cons", "lump")}
    table = Table(["rule", "β", *(f"D {d:g}" for d in arguments.dimensions), "paper"])
    for rule in ("fix", "cons", "lump"):
        for k, beta in enumerate(BETAS):
            cells = []
            for d in arguments.dimensions:
                other = OTHER.get((rule, d)) if arguments.levels == 8 else None
                cells.append(table.cell(found[rule, d]["results"][k],
                                        other and other[k], rule))
            table.row(rule.upper(), f"{beta:g}", *cells, f"{PAPER[beta]:g}")
    table.sum_up()


def variants(run, arguments):
    found = [("H 1, elastic, D 1.5", OTHER_HURST_1, run.of(arguments.levels, arguments.seeds, 1.5,
                                                             hurst=1))]
    found += [(f"H 0.8, equal, D {d:g}", other, run.of(arguments.levels, arguments.seeds, d,
                                                         field="equal"))
             for d, other in OTHER_EQUAL.items()]
    table = Table(["FIX", *(f"β {beta:g}" for beta in BETAS)])
    for name, other, one in found:
        table.row(name, *(table.cell(one["results"][k],
                                     other[k] if arguments.levels == 8 else None, "fix")
                          for k in range(len(BETAS))))
    table.sum_up()


def grids(run, arguments):
    found = {}
    for levels in sorted(arguments.grids):
        seeds = max(2, arguments.seeds // 2 ** max(0, levels - 8))
        for rule in ("fix", "lump"):
            found[levels, rule] = run.of(levels, seeds, 1.55, rule=rule)
    table = Table(["cells", "interfaces", *(f"FIX β {b:g}" for b in BETAS),
                   *(f"LUMP β {b:g}" for b in BETAS)])
    for levels in sorted(arguments.grids):
        done = {rule: found[levels, rule] for rule in ("fix", "lump")}
        other = OTHER_GRIDS.get(levels, (None,) * 3)
        cells = [table.cell(done["fix"]["results"][k], other[k], "fix") for k in range(len(BETAS))]
        cells += [table.cell(done["lump"]["results"][k], None, "lump") for k in range(len(BETAS))]
        table.row(f"{2 ** levels}²", f"{done['fix']['interfaces']}", *cells)
    table.sum_up()


def places(run, arguments):
    found = {(d, shifts): run.of(arguments.levels, max(2, arguments.seeds // (shifts // 4 or 1)),
                                   d, rule="fix", shifts=shifts)
            for d in arguments.dimensions for shifts in (1, 16)}
    table = Table(["FIX", "β", *(f"D {d:g}" for d in arguments.dimensions)])
    for k, beta in enumerate(BETAS):
        rows = {"one place, sd of interfaces": [], "16 places, mean": [],
                "sd of interfaces": [], "sd of places": []}
        for d in arguments.dimensions:
            one, many = (found[d, shifts]["results"][k] for shifts in (1, 16))
            rows["one place, sd of interfaces"].append(f"{one['q_crit_sd']:.3f}")
            rows["16 places, mean"].append(table.cell(many, None, "fix"))
            rows["sd of interfaces"].append(f"{many['q_crit_sd']:.3f}")
            rows["sd of places"].append(f"{many['q_crit_sd_of_places']:.3f}")
        for name, cells in rows.items():
            table.row(name, f"{beta:g}", *cells)


def mean_map(path, beta):
    """lambda and C of the mean curves in a file, from the same pairs as the program's own."""
    import netCDF4
    import numpy

    with netCDF4.Dataset(path) as data:
        fraction, blocks = data["slip_fraction"][beta], data["n_tot"][:]
    pairs = [(s, up) for row in fraction for level, (s, up) in enumerate(zip(row, row[1:]))
             if blocks[level + 1] >= 8 and 0.05 < s < 0.95 and 0.05 < up < 0.95]
    s, up = (numpy.log(x / (1 - x)) for x in numpy.array(pairs).T)
    slope, intercept = numpy.polyfit(s, up, 1)
    fixed = 1 / (1 + math.exp(intercept / (slope - 1))) if slope > 1 else math.nan
    return f"{slope:.3f}; {fixed:.2f}" if slope > 1 else f"{slope:.3f}; none"


def maps(run, arguments):
    def number(result, name, places):
        value, error = result[name], result[name + "_error"]
        if value is None:
            return "none"
        return f"{value:.{places}f}" + ("" if error is None else f" ± {error:.{places}f}")

    wanted = [("fix", "elastic"), ("cons", "elastic"), ("lump", "elastic"), ("fix", "equal"),
              ("cons", "equal"), ("lump", "equal")]
    found = {(rule, field, d): run.of(arguments.levels, arguments.seeds, d, rule=rule,
                                        **({"field": field} if field == "equal" else {}))
            for d in arguments.dimensions for rule, field in wanted}
    table = Table(["rule, field", "β", *(f"D {d:g}: λ; C (of the means)" for d in
                                         arguments.dimensions)])
    for rule, field in wanted:
        for k, beta in enumerate(BETAS):
            cells = []
            for d in arguments.dimensions:
                done = found[rule, field, d]
                r = done["results"][k]
                cells.append(f"{number(r, 'lambda', 3)}; {number(r, 'critical_fraction', 2)} "
                             f"({mean_map(done['output'], k)})")
            table.row(f"{rule.upper()}, {field}", f"{beta:g}", *cells)


def further(off, dimensions, count):
    """How often one more draw lies further off than T^2: an F distribution, summed up to 1e4."""
    import numpy

    a, b = dimensions, count - dimensions
    at = off * b / (a * (count - 1))
    x = numpy.geomspace(max(at, 1e-9), max(at, 1) * 1e4, 20001)
    log = (math.lgamma((a + b) / 2) - math.lgamma(a / 2) - math.lgamma(b / 2) + a / 2 * math.log(a / b)
           + (a / 2 - 1) * numpy.log(x) - (a + b) / 2 * numpy.log1p(a * x / b))
    density = numpy.exp(log)
    return float(numpy.sum((density[1:] + density[:-1]) / 2 * numpy.diff(x)))


def at_fixed_point(path, k):
    """The load at which a part C of the cells has slipped, of the means over the interfaces."""
    import netCDF4
    import numpy

    with netCDF4.Dataset(path) as data:
        c = float(numpy.ma.filled(data["critical_fraction"][k], math.nan))
        return float(numpy.interp(c, data["slip_fraction"][k, :, 0], data["load"][:])), c


def paper(run, arguments):
    """Where the paper's three values lie, reading by reading."""
    import numpy

    readings = [("fix", "elastic", hurst, d) for hurst, d in ((1, 1.39), (0.9, 1.39), (0.8, 1.39), (0.8, 1.6), (0.5, 1.39))]
    readings += [("fix", "equal", hurst, 1.39) for hurst in (1, 0.8)]
    readings += [(rule, field, hurst, 1.39) for rule in ("cons", "lump") for field in ("elastic", "equal")
                 for hurst in (1, 0.8)]
    stated = numpy.array([PAPER[beta] for beta in BETAS])
    table = Table(["rule, field", "H", "D", *(f"β {beta:g} (off by)" for beta in BETAS), "p", "nearest",
                   "where C has slipped"])
    for rule, field, hurst, d in readings:
        done = run.of(arguments.levels, arguments.seeds, d, rule=rule, field=field, hurst=hurst, contacts=48)
        values = numpy.array([one["q_crit_of_interfaces"] for one in done["results"]])
        count, mean, sd = values.shape[1], values.mean(axis=1), values.std(axis=1, ddof=1)
        away = stated - mean
        p = further(away @ numpy.linalg.solve(numpy.cov(values), away) * count / (count + 1), 3, count)
        near = values[:, numpy.argmin(((values.T - stated) ** 2).sum(axis=1))]
        fixed = (at_fixed_point(done["output"], k)[0] for k in range(len(BETAS)))
        table.row(f"{rule.upper()}, {field}", f"{hurst:g}", f"{d:g}",
                  *(f"{m:.3f} ± {s:.3f} ({a / s:+.1f})" for m, s, a in zip(mean, sd, away)),
                  f"{p:.2g}", ", ".join(f"{x:.2f}" for x in near),
                  ", ".join("none" if math.isnan(x) else f"{x:.2f}" for x in fixed))


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("case", nargs="?", default=os.path.join(ROOT, "cases/rg/table.yaml"))
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    parser.add_argument("--seeds", type=int, default=24, help="interfaces, half for each "
                        "doubling beyond 256 cells")
    parser.add_argument("--jobs", type=int, default=min(os.cpu_count() or 1, 64), help="interfaces at a time")
    parser.add_argument("--levels", type=int, default=8, help="2^levels cells a side")
    parser.add_argument("--dimensions", nargs="+", type=float, default=DIMENSIONS, metavar="D")
    parser.add_argument("--grids", nargs="+", type=int, default=(5, 6, 7, 8, 9, 10), metavar="N")
    parser.add_argument("--parts", default=",".join(PARTS), help="which tables")
    parser.add_argument("--json", metavar="FILE", help="keep what all runs gave")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="override the case; may be repeated")
    arguments = parser.parse_args()
    unknown = set(arguments.parts.split(",")) - set(PARTS)
    if unknown:
        parser.error(f"--parts: {', '.join(sorted(unknown))}: must be of {', '.join(PARTS)}")
    reading = [part for part in ("map", "paper") if part in arguments.parts.split(",")]
    if reading:
        try:  # now, not after the rest
            for name in ("netCDF4", "numpy"):
                importlib.import_module(name)
        except ImportError as missing:
            parser.error(f"the part {reading[0]} needs {missing.name}, which is not installed for {sys.executable}; on "
                         "Debian it comes with tools/install-packages and is seen by Debian's own "
                         "interpreter: /usr/bin/python3 tools/plot/rg_table.py ...; other --parts do without")
    if arguments.seeds < 2 or arguments.jobs < 1:
        parser.error("--seeds must be at least 2 and --jobs 1")
    return arguments


def main():
    arguments = read_arguments()
    makers = dict(zip(PARTS, (main_table, variants, grids, places, maps, paper)))
    with tempfile.TemporaryDirectory(prefix="lacuna-rg-table-") as folder:
        run = Runner(arguments, folder)
        for part in arguments.parts.split(","):
            makers[part](run, arguments)
        if arguments.json is not None:
            with open(arguments.json, "w", encoding="utf-8") as out:
                json.dump([{"settings": dict(key), **found} for key, found in run.done.items()], out, indent=1)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(4)
