#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene costs by what it names, as a table in markdown.

    tools/costs.py [--lacuna PROGRAM] [--count COUNT_BYTES.so] [--check]

Runs scenes that name more and more parts and counts bytes (the library build/tests/libcount_bytes.so
that the tests build is loaded into the program) and, with valgrind, instructions: of the program's start before main, of
the database of units, of the scene, of FFT plans, of opening the file, of an evaluation of the right-hand side a cell. Counts, no
times: they are the same on a busy machine. --check: only what the tests hold to, bytes and threads; exit 1 where a block
holds 4 MiB or a thread is begun.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BLOCK = """lacuna: 1
load: {normal: {pressure: "5 MPa"}}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.0135, dc: "1 mm"}}
initial: {slip_rate: "1 mm/week", state: {ratio_to_steady: 0.5}}
time: {end: "1 year"}
output: {every: {per_decade: 4}}
"""
PLANE = BLOCK + 'material: {shear_modulus: "20 GPa"}\n'
FULL = PLANE + 'interface: {size: "16 m", levels: 4, domain: {full: {}}}\n'
HIERARCHY = "transfer: {hierarchy: {k0: 1 GPa/m, ratio: 0.5}}\n"
SURFACE = ('interface: {size: "16 m", levels: 4, surface: {self-affine: {hurst: 0.8, '
           'rms_height: "2 cm", rolloff: "8 m", shortest: "2 m", seed: 1}}}\n')
SCENES = [
    ("a block", BLOCK),
    ("and events", BLOCK + "analysis: {events: {slip_rate: 1 mm/s}}\n"),
    ("256 cells that do not feel each other", FULL),
    ("and the hierarchy", FULL + HIERARCHY),
    ("and its stiffness from the rock", FULL + "transfer: {hierarchy: {stiffness: elastic}}\n"),
    ("and snapshots of them", FULL.replace("per_decade: 4}", "per_decade: 4}, fields: [slip_rate]")
     + HIERARCHY),
    ("elastic rock instead", FULL + "transfer: {elastic: {}}\n"),
    ("contact cells of a rough surface", PLANE + SURFACE + HIERARCHY),
]
PARTS = ["lac_units_create", "lac_scene_create", "lac_store_create", "lac_problem_derivative"]


def call(options, case, folder, environment=None, before=()):
    words = [*before, options.lacuna, "run", case, "-o", os.path.join(folder, "run.nc"), "--force",
             "--quiet", "--json"]
    done = subprocess.run(words, capture_output=True, text=True, check=False,
                          env={**os.environ, **(environment or {})})
    if done.returncode != 0:
        sys.exit(f"costs: {done.stderr.strip()}")
    return json.loads(done.stdout)


def count_bytes(options, case, folder):
    path = os.path.join(folder, "bytes")
    found = call(options, case, folder, {"LD_PRELOAD": options.count, "COUNT_BYTES": path})
    with open(path, encoding="ascii") as file:
        return found, [int(x) for x in file.read().split()]


def count_instructions(options, case, folder):
    """Instructions in all, of each part and of the plans of transforms, whatever they call included."""
    path = os.path.join(folder, "callgrind.out")
    call(options, case, folder, before=["valgrind", "--tool=callgrind", "--quiet",
                                        f"--callgrind-out-file={path}"])
    text = subprocess.run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", path],
                          capture_output=True, text=True, check=True).stdout
    counts = {}
    for line in text.splitlines():
        match = re.match(r"\s*([\d,]+) \([^)]*\)\s+(?:\S*:)?(.+?)(?: \[.*)?$", line)
        if match:
            name = match[2].rsplit(":", maxsplit=1)[-1]
            counts[name] = max(counts.get(name, 0), int(match[1].replace(",", "")))
    plans = sum(n for name, n in counts.items() if re.fullmatch(r"fftw_plan_\w+", name)
                and name in ("fftw_plan_dft_r2c_2d", "fftw_plan_dft_c2r_2d", "fftw_plan_many_dft",
                             "fftw_plan_many_dft_r2c", "fftw_plan_many_dft_c2r"))
    total = counts["PROGRAM TOTALS"]
    return total, total - counts["(below main)"], [counts.get(p, 0) for p in PARTS], plans


def million(count):
    return f"{count / 1e6:.3g}" if count else "0"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build", "lacuna"))
    parser.add_argument("--count", default=os.path.join(ROOT, "build/tests/libcount_bytes.so"))
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    kept = True
    print("| scene | cells | held at once (MB) | in all (MB) | threads | resident (MB) |"
          + ("" if options.check else " instructions (10^6) | before main | units | scene | FFT plans "
             "| opening the file | of an evaluation, a cell |"))
    print("|" + " --- |" * (6 if options.check else 13))
    with tempfile.TemporaryDirectory() as folder:
        case = os.path.join(folder, "scene.yaml")
        for name, text in SCENES:
            with open(case, "w", encoding="utf-8") as file:
                file.write(text)
            found, (peak, total, threads) = count_bytes(options, case, folder)
            kept = kept and threads == 0 and (name != "a block" or peak < 4 << 20)
            line = (f"| {name} | {found['n_cells']} | {peak / 1e6:.2f} | {total / 1e6:.1f} | {threads}"
                    f" | {found['peak_memory_bytes'] / 1e6:.1f} |")
            if not options.check:
                everything, start, parts, plans = count_instructions(options, case, folder)
                one = parts[3] / found["rhs_evaluations"] / found["n_cells"]
                line += (f" {million(everything)} | {million(start)} | {million(parts[0])} | "
                         f"{million(parts[1])} | {million(plans)} | {million(parts[2])} | {one:.0f} |")
            print(line, flush=True)
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
