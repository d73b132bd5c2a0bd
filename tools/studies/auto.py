#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Random scenes under a fidelity, each against `ode` at rtol 1e-9, as a table in markdown.

    tools/studies/auto.py [--fidelity NAME] [--scenes N] [--seed S] [--keep FILE] [--tail] [--errors] [--scene I]

Draws N scenes (200) from the seed: planes of 1 to some 2 000 cells, full or lacunar, tied from a
thousandth to a thousand times k_crit; all laws; loads of all kinds; spreads; rtol 1e-5 to 1e-7; a few
that put out fields. Runs each under NAME (auto), the other of ode and events at its own rtol, and
`ode` at 1e-9. Error: of the time of failure, of the mean slip at the end where nothing fails,
relative to it or to dc, if that is more; where but one of the two fails, what at least it is off by in time. Bound: what the fidelity
that was chosen promises, as the run's JSON says. A scene is right where

    it is computed, or refused in words where NAME was named,
    error <= bound,
    and CPU <= 1.5 times that of the other one, where that one keeps its bound too.

Runs end after 30 s of CPU, the other one where it takes longer than what it is compared with.
CPU times are the whole program's, the least of three where they decide, less than 0.1 s apart being
alike. Exit status 1 where a scene is not right. --keep: a file that the runs with fidelity ode go
into, to be there the next time. --tail: only what is not right, and the sums. --errors:
costs are not looked at. --scene: prints that
scene's case.
"""

import argparse
import collections
import json
import math
import os
import random
import resource
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
REFERENCE = 1e-9
ALIKE = 0.1  # s of CPU that count for nothing
DEARER = 1.5
LONGEST = 30  # s of CPU of a run


def text_of(value):
    """As flow YAML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {text_of(v)}" for key, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(text_of, value)) + "]"
    return f"{value:.10g}" if isinstance(value, float) else json.dumps(value)


def log_uniform(draw, least, most):
    """Even over the decades."""
    return 10 ** draw.uniform(math.log10(least), math.log10(most))


def spread(draw, widest):
    """One of the random factors."""
    seed = draw.randrange(1, 10**6)
    sigma = round(draw.uniform(0.05, widest), 3)
    if draw.random() < 0.8:
        return {"lognormal": {"sigma": sigma, "seed": seed}}
    return {"uniform": {"half_width": min(sigma, 0.9), "seed": seed}}


def draw_load(draw, law, critical, time, pressure):
    """The loads beyond the normal one, and a name of them; time: dc over the slip rate at the start."""
    kind = draw.choices(["none", "ratio", "ramp", "step", "spring", "pore ramp", "pore step", "sine"],
                        [30, 10, 15, 10, 15, 8, 8, 4])[0]
    direct = law["a"] * pressure
    at = f"{time * log_uniform(draw, 0.1, 3):.6g} s"
    loads = {
        "ratio": {"shear": [{"ratio": law["f0"] + round(draw.uniform(-0.03, 0.03), 4)}]},
        "ramp": {"shear": [{"ramp": {"rate": f"{direct / time * log_uniform(draw, 0.01, 3):.6g} Pa/s"}}]},
        "step": {"shear": [{"step": {"value": f"{direct * draw.uniform(-1, 2):.6g} Pa", "at": at}}]},
        "spring": {"shear": [{"spring": {
            "stiffness": f"{critical * log_uniform(draw, 0.003, 3):.6g} Pa/m",
            "speed": f"{law['dc'] / time * log_uniform(draw, 1, 30):.6g} m/s"}}]},
        "pore ramp": {"pore_pressure": [{"ramp": {
            "rate": f"{direct / law['f0'] / time * log_uniform(draw, 0.01, 1):.6g} Pa/s"}}]},
        "pore step": {"pore_pressure": [{"step": {
            "value": f"{direct / law['f0'] * draw.uniform(0, 2):.6g} Pa", "at": at}}]},
        "sine": {"shear": [{"sine": {"amplitude": f"{direct * draw.uniform(0.1, 1):.6g} Pa",
                                     "period": f"{time * log_uniform(draw, 0.3, 3):.6g} s"}}]},
    }
    return kind, loads.get(kind, {})


def draw_law(draw):
    """A law with its parameters."""
    name = draw.choices(["aging", "slip", "composite"], [60, 33, 7])[0]
    a = round(draw.uniform(0.004, 0.014), 5)
    law = {"f0": round(draw.uniform(0.4, 0.7), 3), "a": a,
           "b": round(a * draw.choices([draw.uniform(1.1, 2.5), draw.uniform(0.5, 1)], [93, 7])[0], 5),
           "dc": log_uniform(draw, 1e-6, 1e-3), "v0": 1e-6}
    if draw.random() < 0.25:
        law["form"] = "regularised"
    if name == "composite":
        law["vc"] = 1e-8
    return name, law


def draw_scene(seed, index):
    """A scene as the sections of a case, and what it is of."""
    draw = random.Random(f"{seed}:{index}")
    ratio = log_uniform(draw, 1e-3, 1e3)
    one_by_one = ratio < 5
    levels = draw.choices(range(1, 6), [1, 2, 3, 4, 0 if one_by_one else 3])[0]
    dimension = 2 if draw.random() < 0.3 else round(draw.uniform(1.5, 1.95), 3)
    levels += dimension < 1.8
    fraction = 2 ** (levels * (dimension - 2))
    name, law = draw_law(draw)
    pressure = log_uniform(draw, 3e5, 3e7)
    excess = abs(law["b"] - law["a"]) or 1e-4
    critical = pressure / fraction * excess / law["dc"]
    rate = log_uniform(draw, 1e-11, 1e-7)
    time = law["dc"] / rate
    modulus = log_uniform(draw, 1e9, 4e10)
    elastic = draw.random() < 0.3
    cell = modulus / (ratio * critical) if elastic else log_uniform(draw, 0.1, 10)
    hierarchy = {"stiffness": "elastic"} if elastic else {
        "k0": f"{ratio * critical:.6g} Pa/m",
        "ratio": round(draw.choices([0.5, draw.uniform(0.3, 0.9), draw.uniform(0.05, 0.3)],
                                    [60, 28, 12])[0], 3)}
    kind, load = draw_load(draw, law, pressure * excess / law["dc"], time, pressure)
    rested = {"state": f"{time * log_uniform(draw, 0.1, 10):.6g} s"}
    scene = {
        "lacuna": 1,
        "interface": {"size": f"{cell * 2**levels:.6g} m", "levels": levels,
                      "domain": {"full": {}} if dimension == 2 else
                      {"cascade": {"dimension": dimension, "seed": draw.randrange(1, 10**6)}}},
        "material": {"shear_modulus": f"{modulus:.6g} Pa", "poisson": 0.25,
                     **({"shear_speed": "2 km/s"} if draw.random() < 0.85 else {})},
        "load": {"normal": {"pressure": f"{pressure:.6g} Pa"}, **load},
        "friction": {name: law},
        "initial": rested if kind == "ratio" else {
            "slip_rate": f"{rate:.6g} m/s", "state": {"ratio_to_steady": round(draw.uniform(0.3, 1.3), 3)}},
        "transfer": {"hierarchy": hierarchy},
        "time": {"end": f"{time * log_uniform(draw, 1, 300):.6g} s"},
        "solver": {"rtol": draw.choices([1e-5, 1e-6, 1e-7], [25, 60, 15])[0]},
        "output": {"file": "auto.nc", "every": {"per_decade": 1}},
    }
    if draw.random() < 0.5:
        scene["time"]["failure"] = {"mean_slip_rate": "0.1 m/s"}
    if draw.random() < 0.7:
        scene["friction"]["spread"] = {"dc": spread(draw, 0.8)}
    if draw.random() < 0.3:
        scene["interface"]["spread"] = {"pressure": spread(draw, 0.8)}
    if kind != "ratio":
        scene["initial"]["spread"] = {"slip_rate": spread(draw, 1.5)}
    if draw.random() < 0.06:
        scene["output"].update({"fields": ["slip"], "fields_every": {"per_decade": 1}})
    case = "".join(f"{key}: {text_of(value)}\n" for key, value in scene.items())
    return case, {"law": name, "load": kind, "ratio": ratio, "rtol": scene["solver"]["rtol"], "dc": law["dc"]}


class Program:
    """`lacuna` on cases, with what is kept of its runs."""

    def __init__(self, options, folder):
        self.options, self.folder, self.kept, self.dirty = options, folder, {}, False
        if options.keep and os.path.exists(options.keep):
            with open(options.keep, encoding="utf-8") as file:
                self.kept = json.load(file)

    def save(self):
        """Keeps the runs."""
        if self.options.keep and self.dirty:
            with open(self.options.keep, "w", encoding="utf-8") as file:
                json.dump(self.kept, file)

    def fresh(self, case, fidelity, rtol, limit=LONGEST):
        """What `lacuna run --json` says; of one that cannot be computed, in so many CPU seconds, why."""
        path = os.path.join(self.folder, "auto.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(case)
        done = subprocess.run(
            [self.options.lacuna, "run", path, "-o", os.path.join(self.folder, "auto.nc"), "--force", "--quiet",
             "--json", "--set", f"solver.fidelity={fidelity}", "--set", f"solver.rtol={rtol}"],
            capture_output=True, text=True, check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)))
        if done.returncode < 0:
            return {"exit": done.returncode, "why": f"not within {limit} s"}
        if done.returncode != 0:
            return {"exit": done.returncode, "why": done.stderr.strip().splitlines()[-1]}
        said = json.loads(done.stdout)
        keys = ("failed", "failure_time_s", "time_s", "mean_slip_m", "cpu_time_s", "fidelity", "fidelity_why",
                "fidelity_error", "n_cells", "steps")
        told = {key: said.get(key) for key in keys}
        if told["fidelity_error"] is None:
            told["fidelity_error"] = said.get("lump_error_estimated")
        return {"exit": 0, **told}

    def run(self, case, fidelity, rtol, limit=LONGEST):
        """The same; runs of `ode` are kept."""
        key = f"{fidelity} {rtol:g}\n{case}"
        if key not in self.kept:
            said = self.fresh(case, fidelity, rtol, limit)
            if fidelity != "ode":
                return said
            self.kept[key], self.dirty = said, True
        return self.kept[key]


def error_of(said, true, length):
    """Relative, of slips less than dc to that; what at least it is where but one of them fails."""
    if said["failed"] and true["failed"]:
        return abs(said["failure_time_s"] / true["failure_time_s"] - 1)
    if said["failed"] != true["failed"]:
        return abs(said["time_s"] - true["time_s"]) / min(said["time_s"], true["time_s"])
    return abs(said["mean_slip_m"] - true["mean_slip_m"]) / max(true["mean_slip_m"], length)


def cheaper(program, case, about, one, other):
    """CPU times of two fidelities, the least of three each where one run each says that the first is dearer."""
    times = [one[1]["cpu_time_s"], other[1]["cpu_time_s"]]
    for _ in range(2):
        if times[0] - times[1] < ALIKE or times[0] < DEARER * times[1]:
            break
        for k, (fidelity, _) in enumerate((one, other)):
            times[k] = min(times[k], program.fresh(case, fidelity, about["rtol"])["cpu_time_s"])
    return times


def judge(program, case, about):
    """One scene: a row, and whether it is right."""
    name, rtol = program.options.fidelity, about["rtol"]
    true = program.run(case, "ode", REFERENCE)
    said = program.run(case, name, rtol)
    row = {"cells": true.get("n_cells"), "true": true, "said": said, "chosen": said.get("fidelity")}
    if true["exit"] != 0:
        return row, None, f"no reference: {true['why']}"
    if said["exit"] != 0:
        refused = said["exit"] == 2 and name != "auto"
        return row, None if refused else False, said["why"]
    row["error"], row["bound"] = error_of(said, true, about["dc"]), said["fidelity_error"]
    if not row["error"] <= row["bound"]:
        return row, False, "off"
    if program.options.errors:
        return row, True, ""
    second = "events" if row["chosen"] == "ode" else "ode"
    other = program.run(case, second, rtol, math.ceil(said["cpu_time_s"]))
    row["cpu"] = [said["cpu_time_s"], other.get("cpu_time_s")]
    if other["exit"] != 0 or not error_of(other, true, about["dc"]) <= other["fidelity_error"]:
        return row, True, f"{second} " + (
            "off" if other["exit"] == 0 else "refused" if other["exit"] == 2 else
            "slower" if other["exit"] < 0 else "fails")
    row["cpu"] = cheaper(program, case, about, (name, said), (second, other))
    dear = row["cpu"][0] > DEARER * row["cpu"][1] and row["cpu"][0] - row["cpu"][1] > ALIKE
    return row, not dear, "dear" if dear else ""


def figure(value, form):
    """Blank where there is none."""
    return "" if value is None else format(value, form)


def line(index, about, row, right, why):
    """One line of the table."""
    cpu = row.get("cpu", [None, None])
    cells = [str(index), figure(row["cells"], "d"), f"{about['ratio']:.2g}", about["law"], about["load"],
             f"{about['rtol']:g}", row["chosen"] or "", figure(row.get("error"), ".1e"),
             figure(row.get("bound"), ".1e"), figure(cpu[0], ".2f"), figure(cpu[1], ".2f"),
             {True: "right", False: "WRONG", None: "-"}[right], why]
    return "| " + " | ".join(cells) + " |"


def sums(rows):
    """What the fidelities that were chosen came to."""
    print("\n| fidelity | scenes | error over bound: median | worst | both computed | CPU s | other, s | times dearer, worst |")
    print("|" + " --- |" * 8)
    for name in sorted({row["chosen"] for row in rows if row["chosen"]}):
        own = [row for row in rows if row["chosen"] == name]
        off = sorted(row["error"] / row["bound"] for row in own if "error" in row)
        cpu = [row["cpu"] for row in own if None not in row.get("cpu", [None])]
        total = [sum(one) for one in zip(*cpu)] or [0, 0]
        worst = max((a / b for a, b in cpu if a - b > ALIKE), default=1)
        print(f"| {name} | {len(own)} | {off[len(off) // 2]:.2g} | {off[-1]:.2g} | {len(cpu)} | {total[0]:.1f} | "
              f"{total[1]:.1f} | {worst:.2g} |")


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fidelity", default="auto", metavar="NAME", help="auto, events, lumped (auto)")
    parser.add_argument("--scenes", type=int, default=200, metavar="N")
    parser.add_argument("--first", type=int, default=0, metavar="I", help="scene to begin with")
    parser.add_argument("--seed", default="1", metavar="S")
    parser.add_argument("--keep", metavar="FILE", help="runs with fidelity ode")
    parser.add_argument("--tail", action="store_true", help="only what is not right")
    parser.add_argument("--errors", action="store_true", help="judge errors alone, not costs")
    parser.add_argument("--scene", type=int, metavar="I", help="print the case of this one")
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build/lacuna"), help="the program (build/lacuna)")
    options = parser.parse_args()
    if options.scene is not None:
        print(draw_scene(options.seed, options.scene)[0], end="")
        return 0
    titles = ["scene", "cells", "k_0/k_crit", "law", "load", "rtol", "fidelity", "error", "bound", "CPU s",
              "other, s", "", ""]
    print("| " + " | ".join(titles) + " |\n|" + " --- |" * len(titles))
    count, rows = collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        program = Program(options, folder)
        for index in range(options.first, options.first + options.scenes):
            case, about = draw_scene(options.seed, index)
            row, right, why = judge(program, case, about)
            count[right] += 1
            rows.append(row)
            if not (options.tail and right):
                print(line(index, about, row, right, why), flush=True)
            program.save()
    sums(rows)
    print(f"\n{count[True]} right, {count[False]} not, {count[None]} without an answer")
    return 1 if count[False] else 0


if __name__ == "__main__":
    sys.exit(main())
