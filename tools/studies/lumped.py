# SPDX-License-Identifier: GPL-3.0-or-later
"""What lumping costs in accuracy, and whether its estimate holds: random scenes, each run lumped and with all cells.

    lumped.py PROGRAM [--first N] [--count N] [--hard SEED] [--error X] [--rtol X] [-o TABLE.csv] [--show N]

Scenes have 60 to 4096 contact cells, k_0/k_crit from 3 to 1e5, all laws and loads; from 3000 on some are pressed surfaces, and some
end by their slip. Scene N depends on N alone: 3000 to 3059, 5000 to 5099, 7000 to 7099 and 9000 to 9099 set the estimate, 21000 to
21099 mended it, 22000 to 22099 tested it. With --hard scenes are drawn to break it (lumped_hard.py): b2x is the draw that set what is asked
of the way's end, b3y tested it. Of a pressed surface k_0/k_crit is about what it was drawn for. Prints a line a scene and a summary; --show prints a scene.
"""

import argparse
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile

import lumped_hard

YEAR = 365.25 * 86400
WIDE = 3000  # from this scene on surfaces are pressed too, and some runs end by their slip


def log_uniform(draw, low, high):
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def spread_of(draw, widest, seed):
    """A distribution whose deviation is at most some `widest` of the value."""
    kind = draw.choice(["lognormal", "lognormal", "uniform", "weibull"])
    size = draw.uniform(0.1, 1) * widest
    return {"lognormal": f"lognormal: {{sigma: {size:.3f}, seed: {seed}}}",
            "uniform": f"uniform: {{half_width: {min(1.5 * size, 0.9):.3f}, seed: {seed}}}",
            "weibull": f"weibull: {{shape: {max(1.2 / size, 1.6):.3f}, seed: {seed}}}"}[kind]


def friction(draw, dc, a, b):
    law = draw.choice(["aging", "aging", "aging", "slip", "composite", "weakening"])
    form = draw.choice(["plain", "plain", "regularised"])
    spreads = []
    if draw.random() < 0.85:
        spreads.append(f"dc: {{{spread_of(draw, 0.6, draw.randrange(10**6))}}}")
    if draw.random() < 0.4:
        spreads.append(f"f0: {{normal: {{sigma: {draw.uniform(0.002, 0.02):.4f}, seed: {draw.randrange(10**6)}}}}}")
    if draw.random() < 0.2:
        spreads.append(f"a: {{uniform: {{half_width: {draw.uniform(0.02, 0.2):.3f}, seed: {draw.randrange(10**6)}}}}}")
    if draw.random() < 0.2:
        spreads.append(f"b: {{uniform: {{half_width: {draw.uniform(0.02, 0.2):.3f}, seed: {draw.randrange(10**6)}}}}}")
    more = ', vc: "1e-8 m/s"' if law == "composite" else ""
    text = f'friction:\n  {law}: {{f0: 0.6, a: {a:.4g}, b: {b:.4g}, dc: "{dc:.4g} m", v0: "1 um/s", form: {form}{more}}}\n'
    if spreads:
        text += "  spread:\n" + "".join(f"    {line}\n" for line in spreads)
    return text


def initial(draw, loaded):
    if loaded:
        return ""
    state = f"ratio_to_steady: {draw.uniform(0.3, 0.95):.3f}"
    text = f'initial:\n  slip_rate: "{log_uniform(draw, 1e-9, 1e-6):.4g} m/s"\n  state: {{{state}}}\n'
    spreads = []
    if draw.random() < 0.3:
        spreads.append(f"slip_rate: {{lognormal: {{sigma: {draw.uniform(0.1, 1):.3f}, seed: {draw.randrange(10**6)}}}}}")
    if draw.random() < 0.3:
        spreads.append(f"state: {{lognormal: {{sigma: {draw.uniform(0.05, 0.4):.3f}, seed: {draw.randrange(10**6)}}}}}")
    if spreads:
        text += "  spread:\n" + "".join(f"    {line}\n" for line in spreads)
    return text


def shear(draw, pressure, end):
    """Loads on top of those that the start fixes."""
    kinds = {
        "none": "",
        "ramp": f'ramp: {{rate: "{draw.uniform(0.002, 0.03) * pressure / end:.4g} Pa/s"}}',
        "step": f'step: {{value: "{draw.uniform(-0.01, 0.02) * pressure:.4g} Pa", at: "{draw.uniform(0.01, 0.2) * end:.4g} s"}}',
        "sine": f'sine: {{amplitude: "{draw.uniform(0.001, 0.01) * pressure:.4g} Pa", period: "{draw.uniform(0.05, 0.5) * end:.4g} s"}}',
        "spring": f'spring: {{stiffness: "{log_uniform(draw, 1e-4, 1e-2) * pressure:.4g} Pa/m", speed: "{log_uniform(draw, 1e-9, 1e-7):.4g} m/s"}}',
    }
    kind = draw.choice(list(kinds))
    return f"  shear:\n    - {kinds[kind]}\n" if kinds[kind] else ""


def pore(draw, pressure, end):
    kinds = {
        "none": "",
        "constant": f'constant: {{value: "{draw.uniform(0.05, 0.5) * pressure:.4g} Pa"}}',
        "ramp": f'ramp: {{rate: "{draw.uniform(0.005, 0.05) * pressure / end:.4g} Pa/s"}}',
        "step": f'step: {{value: "{draw.uniform(0.002, 0.02) * pressure:.4g} Pa", at: "{draw.uniform(0.01, 0.2) * end:.4g} s"}}',
        "sine": f'sine: {{amplitude: "{draw.uniform(0.001, 0.01) * pressure:.4g} Pa", period: "{draw.uniform(0.1, 0.5) * end:.4g} s"}}',
    }
    kind = draw.choice(list(kinds) + ["none"])
    return f"  pore_pressure:\n    - {kinds[kind]}\n" if kinds[kind] else ""


def scene(number):
    """The text of a case, and its k_0/k_crit."""
    draw = random.Random(f"lumped {number}")
    pressure, a = log_uniform(draw, 3e5, 1e7), draw.uniform(0.006, 0.02)
    b = a * draw.uniform(1.1, 2.0)
    dc = log_uniform(draw, 1e-4, 0.1)
    line = draw.random() < 0.15
    levels = draw.randrange(8, 11) if line else draw.randrange(4, 7)
    fractal = not line and levels >= 5 and draw.random() < 0.35
    pressed = number >= WIDE and not line and levels == 6 and not fractal
    domain = f"cascade: {{dimension: {draw.uniform(1.5, 1.9):.3f}, seed: {draw.randrange(10**6)}}}" if fractal else "full: {}"
    stiff = log_uniform(draw, 3, 1e5)
    fraction = 1.0 if not fractal else 0.5
    k0 = stiff * pressure / fraction * (b - a) / dc
    end = draw.uniform(0.5, 2) * YEAR
    text = f'lacuna: 1\ntitle: lumped {number}\ninterface: {{size: "100 m", levels: {levels}, shape: {"line" if line else "plane"}, domain: {{{domain}}}}}\n'
    text += 'material: {shear_modulus: "10 GPa", poisson: 0.25, density: "2500 kg/m3"}\n' if draw.random() < 0.6 else ""
    text += f'load:\n  normal: {{pressure: "{pressure:.5g} Pa"}}\n' + shear(draw, pressure, end) + pore(draw, pressure, end)
    text += friction(draw, dc, a, b) + initial(draw, False)
    if pressed:  # cells that differ in pressure, some dc by the size of their contact
        height = 20 * pressure / 2.7e10 / draw.uniform(0.15, 0.7)
        text = text.replace("domain: {full: {}}", f'surface: {{self-affine: {{hurst: {draw.uniform(0.6, 0.9):.2f}, rms_height: "{height:.4g} m", '
                            f'rolloff: "50 m", shortest: "6.25 m", seed: {draw.randrange(10**6)}}}}}')
        text = text if "material" in text else text + 'material: {shear_modulus: "10 GPa", poisson: 0.25, density: "2500 kg/m3"}\n'
        if draw.random() < 0.25 and "    dc:" in text:
            text = "\n".join(f'    dc: {{size: {{of: patch, reference: "10 m", exponent: {draw.uniform(-0.5, 0.5):.2f}}}}}' if line.startswith("    dc:") else line
                             for line in text.split("\n"))
    if number >= WIDE and draw.random() < 0.2:  # another end than failure
        text += f'time: {{end: "{end:.5g} s", stop_when: {{mean_slip: "{log_uniform(draw, 0.2, 3) * dc:.4g} m"}}}}\n'
    text += f'transfer: {{hierarchy: {{k0: "{k0:.5g} Pa/m", ratio: {draw.choice([0.5, 0.5, 0.5, 0.35, 0.7])}}}}}\n'
    text += "" if "\ntime:" in text else f'time: {{end: "{end:.5g} s"}}\n'
    text += f'output: {{every: {{steps: 100000}}}}\n'
    return text, stiff


def run(program, folder, text, settings):
    case = os.path.join(folder, "case.yaml")
    with open(case, "w", encoding="utf-8") as file:
        file.write(text)
    command = [program, "run", case, "--json", "--force", "-o", os.path.join(folder, "out.nc"), "--no-progress"]
    done = subprocess.run(command + [part for key in settings for part in ("--set", key)], capture_output=True, text=True)
    found = json.loads(done.stdout) if done.stdout.startswith("{") else {}
    return done.returncode, found, done.stderr.strip().split("\n")[-1]


def value_of(found):
    """What an error is of: the time of failure or of a limit, else the mean slip."""
    if found.get("failed"):
        return "failure", found["failure_time_s"]
    return ("limit", found["time_s"]) if found.get("ended_by") == "stop_when" else ("slip", found.get("mean_slip_m"))


def judge(program, folder, number, options):
    text, stiff = lumped_hard.scene(options.hard, number) if options.hard else scene(number)
    row = {"scene": number, "k0_over_kcrit": stiff}
    accuracy = f"solver.rtol={options.rtol}"
    status, found, why = run(program, folder, text, [accuracy, "solver.max_steps=60000"])
    if status != 0:
        return row | {"outcome": "no reference", "why": why}
    lumped = [accuracy, "solver.fidelity=lumped", f"solver.lump.error={options.error}"]
    status, few, why = run(program, folder, text, lumped)
    row["outcome"] = "kept" if status == 0 else "bound passed" if "may be off" in why else "refused"
    if row["outcome"] == "bound passed":
        _, few, _ = run(program, folder, text, lumped + ["solver.lump.error=0.5"])
    row |= {"cells": found["n_cells"], "why": why if status != 0 else "", "steps": found["steps"],
            "leaves": (few.get("lump") or {}).get("cells"), "bound": few.get("lump_error_estimated")}
    of, value = value_of(found)
    of_few, value_few = value_of(few)
    row["of"] = of
    if few.get("status") == "complete" and of == of_few:
        row["error"] = abs(value_few / value - 1)
    elif few.get("status") == "complete":
        row["error"] = math.inf
    return row


def median(values):
    values = sorted(values)
    return values[len(values) // 2] if values else math.nan


def summarise(rows):
    judged = [row for row in rows if row["outcome"] == "kept"]
    held = [row for row in judged if row["error"] <= row["bound"]]
    worst = max((row["error"] / row["bound"] for row in judged), default=math.nan)
    twice = [row for row in judged if row["error"] <= 2 * row["bound"]]
    ratios = [row["bound"] / row["error"] for row in judged if row["error"] > 1e-5]
    print(f"{len(rows)} scenes: " + ", ".join(f"{sum(row['outcome'] == name for row in rows)} {name}" for name in
                                             ("kept", "bound passed", "refused", "no reference")))
    print(f"of those kept: error <= bound in {len(held)} of {len(judged)}, <= twice the bound in {len(twice)}; largest error/bound {worst:.2f}")
    print(f"bound/error where the error is above 1e-5: median {median(ratios):.2f} of {len(ratios)}")
    stiff = [row for row in rows if row["k0_over_kcrit"] >= 50 and row["outcome"] in ("refused", "bound passed")]
    print(f"refused or passed with k_0/k_crit >= 50: {[row['scene'] for row in stiff]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--hard")
    parser.add_argument("--error", type=float, default=0.01)
    parser.add_argument("--rtol", type=float, default=1e-8)
    parser.add_argument("--show", type=int)
    parser.add_argument("-o", "--output")
    options = parser.parse_args()
    if options.show is not None:
        print((lumped_hard.scene(options.hard, options.show) if options.hard else scene(options.show))[0])
        return 0
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for number in range(options.first, options.first + options.count):
            row = judge(options.program, folder, number, options)
            rows.append(row)
            print(f"{number:5d} k0/kcrit {row['k0_over_kcrit']:9.3g} cells {row.get('cells') or '-':>5} leaves {row.get('leaves') or '-':>4} "
                  f"{row['outcome']:12s} {row.get('of', ''):7s} error {row.get('error', math.nan):8.2e} bound {row.get('bound') or math.nan:8.2e}"
                  f"  {row.get('why', '')[:110]}", flush=True)
    summarise(rows)
    if options.output:
        keys = ["scene", "k0_over_kcrit", "cells", "leaves", "steps", "outcome", "of", "error", "bound", "why"]
        with open(options.output, "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, keys, restval="")
            writer.writeheader()
            writer.writerows(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
