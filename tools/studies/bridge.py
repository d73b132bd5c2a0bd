#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The creep of contacts pulled slowly against the cascade of slip: the tables of docs/tables/theory-bridge.md.

    tools/studies/bridge.py [TABLE ...] [--runs N] [--jobs N] [--picture PNG]

Tables: ratio, stiffness, contrast, law, scaling; all of them unless named. Each run is cases/bridge.yaml with
random pressures of its own: `lacuna run` pulls it until the whole slides, `lacuna rg` says at which
force it should. Deviations are (Q_crit of the run - that of the rule)/Q_nom; "rms (mean)" over N runs.
The picture draws one run and the deviations against the ratio of stiffnesses.
"""

import argparse
import concurrent.futures
import functools
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile

import netCDF4

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CASE = os.path.join(ROOT, "cases/bridge.yaml")

# What the case says, SI.
F0, P, ETA, K0, V0, DC = 0.6, 10e6, 5e6, 1e9, 6e-11, 10e-6
SECONDS = 5e6  # in which the ramp adds f0 p


def settings(contacts=16, beta=0.7, ratio=0.01, dc=DC, contrast=0.16, law="weakening", seed=1):
    """The --set of one run."""
    levels = {16: 2, 64: 3, 256: 4}[contacts]
    drop = 1 - beta
    b = drop * F0 / math.log(drop * F0 * P / (ETA * V0))  # the arrest formula, solved for b
    # A cell far from slipping creeps at v0 exp(-gap/a), which a double must hold.
    a = max(0.05 * b, F0 * (1 - 0.9 * (1 - contrast) / (1 + contrast)) / 680)
    slack = 2 * F0 * P / (K0 * ratio ** (levels - 1))
    start = -0.95 * (1 - contrast) * SECONDS
    return {"interface.levels": levels,
            "interface.spread.pressure.uniform": f"{{half_width: {contrast}, seed: {seed}}}",
            "load.shear.0.ramp.start": f"{start:.17g} s",
            "friction": f"{{{law}: {{f0: {F0}, a: {a:.17g}, b: {b:.17g}, dc: {dc:.17g} m, v0: {V0} m/s}}}}",
            "initial.state": f"{dc / V0:.17g} s",
            "transfer.hierarchy": f"{{k0: {K0:.17g} Pa/m, ratio: {ratio}}}",
            "time.stop_when.mean_slip": f"{slack:.17g} m"}


def call(program, command, values, output, *more):
    """The JSON that a command prints for the case under these settings."""
    words = [program, command, CASE, "--json", "--force", "-o", output, *more]
    for key, value in values.items():
        words += ["--set", f"{key}={value}"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"bridge: {' '.join(words)}: {done.stderr.strip()}")
    return json.loads(done.stdout)


class Bridge:
    """Runs and predictions, those of the same settings made once."""

    def __init__(self, program, folder, runs, jobs):
        self.program, self.folder, self.runs, self.jobs = program, folder, runs, jobs
        self.pool = concurrent.futures.ThreadPoolExecutor(jobs)
        self.residual = 0.0
        self.predicted = functools.lru_cache(maxsize=None)(self.predict)

    def predict(self, rule, contacts, beta, contrast, seed):
        """Q_crit/Q_nom of a rule."""
        values = settings(contacts, beta, contrast=contrast, seed=seed)
        values["rg.rule"] = rule
        name = f"{rule}-{contacts}-{beta}-{contrast}-{seed}.nc"
        return call(self.program, "rg", values, os.path.join(self.folder, name))["q_crit_over_q_nom"]

    def deviations(self, **options):
        """Q/Q_nom at which each run slid, less that of CONS; less that of FIX."""
        output, seeds = os.path.join(self.folder, "runs.nc"), range(1, self.runs + 1)
        call(self.program, "sweep", settings(**options), output, "--jobs", str(self.jobs),
             "--over", f"interface.spread.pressure.uniform.seed=1:{self.runs}")
        with netCDF4.Dataset(output) as runs:
            ended = runs["ended_by"].flag_meanings.split().index("stop_when") == runs["ended_by"][:]
            reached = runs["max_load_ratio"][:]
            self.residual = max(self.residual, runs["balance_residual"][:].max())
        if not ended.all():
            sys.exit(f"bridge: seeds of {options} did not all slide")
        key = [options.get(name, usual) for name, usual in (("contacts", 16), ("beta", 0.7), ("contrast", 0.16))]
        rules = [self.pool.map(lambda seed, rule=rule: self.predicted(rule, *key, seed), seeds) for rule in ("cons", "fix")]
        return [[float(q) - p for q, p in zip(reached, predicted)] for predicted in rules]


def text(deviations):
    """rms (mean) in thousandths of Q_nom."""
    rms = math.sqrt(statistics.mean(x * x for x in deviations))
    return f"{rms:.4f} ({statistics.mean(deviations):+.4f})"


def table(names, rows):
    """Prints a table in markdown, row by row."""
    print("\n| " + " | ".join(names) + " |\n| " + " | ".join("---" for _ in names) + " |")
    for row in rows:
        print("| " + " | ".join(row) + " |", flush=True)


def ratio(bridge):
    """Deviation against k_{l+1}/k_l."""
    ratios = (1, 0.1, 0.01)
    for contacts in (16, 64):
        rows = []
        for beta in (0.8, 0.7, 0.6):
            all_of = [bridge.deviations(contacts=contacts, beta=beta, ratio=r) for r in ratios]
            rows.append([f"{beta}", *(text(cons) for cons, _ in all_of), text(all_of[-1][1])])
        table([f"β, {contacts} contacts", *(f"CONS, ratio {r}" for r in ratios), "FIX, 0.01"], rows)


def stiffness(bridge):
    """Deviation against k_0 dc/(f0 p)."""
    rows = []
    for dc in (1e-5, 1e-4, 1e-3, 1e-2):
        cons, _ = bridge.deviations(ratio=0.03, dc=dc)
        rows.append([f"{K0 * dc / (F0 * P):.2g}", text(cons)])
    table(["k_0 dc/(f0 p), ratio 0.03, β 0.7", "CONS"], rows)


def contrast(bridge):
    """Deviation where pressures differ more, so that the rules do too."""
    rows = []
    for width in (0.16, 0.3):
        cons, fix = bridge.deviations(beta=0.6, contrast=width)
        rows.append([f"± {width}", text(cons), text(fix)])
    table(["pressures, β 0.6, ratio 0.01", "CONS", "FIX"], rows)


def law(bridge):
    """Deviation of friction that heals."""
    rows = []
    for name in ("weakening", "slip", "aging"):
        both = [bridge.deviations(law=name, contrast=w, beta=b)[0] for w, b in ((0.16, 0.7), (0.3, 0.6))]
        rows.append([name, *(text(cons) for cons in both)])
    table(["law, ratio 0.01", "CONS, ± 0.16, β 0.7", "CONS, ± 0.3, β 0.6"], rows)


def scaling(bridge):
    """How the deviation goes to its limit with the ratio."""
    rows = []
    for r in (1, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001):
        cons, fix = bridge.deviations(ratio=r)
        spread = statistics.stdev(cons) / math.sqrt(len(cons))
        rows.append((r, statistics.mean(cons), spread, statistics.stdev(cons), statistics.mean(fix)))
    table(["ratio, 16 contacts, β 0.7", "mean from CONS", "its standard error", "scatter"],
          [[f"{r:g}", f"{m:+.4f}", f"{e:.4f}", f"{s:.4f}"] for r, m, e, s, _ in rows])
    return rows


def draw(bridge, path):
    """One run beside its prediction, and the deviations against the ratio."""
    import matplotlib
    import netCDF4
    matplotlib.use("Agg")
    from matplotlib import pyplot

    chosen = {"contacts": 64, "beta": 0.6, "contrast": 0.3}
    output = os.path.join(bridge.folder, "picture.nc")
    call(bridge.program, "run", settings(seed=1, **chosen), output)
    with netCDF4.Dataset(output) as data:
        time = data["time"][:] / 86400
        load = data["shear_force"][:] / data["normal_force"][:] / F0
        rate = data["max_slip_rate"][:]
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    left.plot(time, load, color="black", label="the run, to its end")
    for rule, colour in (("cons", "tab:blue"), ("fix", "tab:orange")):
        left.axhline(bridge.predicted(rule, 64, 0.6, 0.3, 1), color=colour, ls="--", label=rule.upper())
    left.set(xlabel="time [day]", ylabel="$Q/Q_{nom}$")
    low, high = left.get_ylim()
    left.set_ylim(low, high + 0.35 * (high - low))
    left.legend(loc="upper left")
    slips = left.twinx()
    slips.semilogy(time, rate, color="tab:red", lw=0.6)
    slips.set(ylim=(1e-16, 1e14), yticks=[1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 1])
    slips.set_ylabel("fastest contact [m/s]", color="tab:red")
    left.set_title("64 contacts, β 0.6, pressures ± 0.3, ratio 0.01", fontsize=10)
    for contacts, marker in ((16, "o"), (64, "s")):
        ratios = (1, 0.3, 0.1, 0.03, 0.01)
        all_of = [bridge.deviations(contacts=contacts, ratio=r)[0] for r in ratios]
        right.errorbar(ratios, [statistics.mean(d) for d in all_of],
                       [statistics.stdev(d) / math.sqrt(len(d)) for d in all_of], fmt=marker + "-",
                       capsize=3, label=f"mean, {contacts} contacts")
        right.plot(ratios, [math.sqrt(statistics.mean(x * x for x in d)) for d in all_of], marker + ":",
                   color=right.lines[-1].get_color(), mfc="none", label=f"rms, {contacts} contacts")
    right.axhline(0.004, color="grey", lw=0.8)
    right.set(xscale="log", xlabel="$k_{l+1}/k_l$", ylabel="$(Q_{crit} - Q_{CONS})/Q_{nom}$", ylim=(0, None))
    right.legend()
    right.set_title(f"β 0.7, pressures ± 0.16, {bridge.runs} runs", fontsize=10)
    figure.savefig(path, dpi=110)


TABLES = {"ratio": ratio, "stiffness": stiffness, "contrast": contrast, "law": law, "scaling": scaling}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("tables", nargs="*", metavar="TABLE", help=", ".join(TABLES))
    parser.add_argument("--runs", type=int, default=40, metavar="N", help="random trees (40)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="runs at a time")
    parser.add_argument("--picture", metavar="PNG", help="draw it; then no table unless named")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    arguments = parser.parse_args()
    unknown = set(arguments.tables) - set(TABLES)
    if unknown or arguments.runs < 2 or arguments.jobs < 1:
        parser.error(f"no table {sorted(unknown)[0]}" if unknown else "needs 2 runs and 1 job at least")
    with tempfile.TemporaryDirectory(prefix="lacuna-bridge-") as folder:
        bridge = Bridge(arguments.program, folder, arguments.runs, arguments.jobs)
        for name in arguments.tables or ([] if arguments.picture else TABLES):
            TABLES[name](bridge)
        if arguments.picture:
            try:
                draw(bridge, arguments.picture)
            except OSError as wrong:
                sys.exit(f"bridge: {wrong.filename}: {wrong.strerror}")
        print(f"\nworst balance residual of a run: {bridge.residual:.1e} of f0 p")


if __name__ == "__main__":
    main()
