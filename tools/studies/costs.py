#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a scene costs by what it names, as a table in markdown.

    tools/studies/costs.py [--lacuna PROGRAM] [--count COUNT_BYTES.so] [--check | --quick]

Runs scenes that name more and more parts and counts bytes (the library build/tests/libcount_bytes.so
that the tests build is loaded into the program) and, with valgrind, instructions: of the program's start before main, of
the database of units, of the scene, of FFT plans, of opening the file, of an evaluation of the right-hand side a cell. Counts are
the same on a busy machine; the CPU time is the least of many runs. --check: what the tests hold to; exit 1 where a block
allocates 4 MiB, held or in all, or takes more instructions than 20 ms allow, or a thread is begun that `lacuna --version` does not
begin. --quick: exit 1 where a block takes 20 ms of CPU from start to end, 77 where the machine is too slow or busy to tell.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
with open(os.path.join(ROOT, "cases/block.yaml"), encoding="utf-8") as bundled:
    BLOCK = bundled.read()
PLANE = BLOCK + 'material: {shear_modulus: "20 GPa"}\n'
FULL = PLANE + 'interface: {size: "16 m", levels: 4, domain: {full: {}}}\n'
HIERARCHY = "transfer: {hierarchy: {k0: 1 GPa/m, ratio: 0.5}}\n"
SURFACE = ('interface: {size: "16 m", levels: 4, surface: {self-affine: {hurst: 0.8, '
           'rms_height: "2 cm", rolloff: "8 m", shortest: "2 m", seed: 1}}}\n')
SCENES = [
    ("a block", BLOCK),
    ("with a unit that is not usual", BLOCK.replace("5 MPa", "50 bar")),
    ("and events", BLOCK + "analysis: {events: {slip_rate: 1 mm/s}}\n"),
    ("256 cells that do not feel each other", FULL),
    ("and the hierarchy", FULL + HIERARCHY),
    ("and its stiffness from the rock", FULL + "transfer: {hierarchy: {stiffness: elastic}}\n"),
    ("and snapshots of them", FULL.replace("output: {", "output: {every: {per_decade: 4}, "
                                           "fields: [slip_rate], ") + HIERARCHY),
    ("elastic rock instead", FULL + "transfer: {elastic: {}}\n"),
    ("contact cells of a rough surface", PLANE + SURFACE + HIERARCHY),
]
# Instructions that a block may take after the libraries are loaded, which is the dynamic linker's share:
# 31 million on Debian 12, where with these all are 18 ms at the 0.22 ns that one takes on a quiet
# machine of 2023; on Debian 13 SUNDIALS brings MPI along, which takes 53 million and begins a thread.
MOST_INSTRUCTIONS = 49e6
MOST_TIME = 0.020
# What `lacuna --version` with all libraries, hardly more than the dynamic linker, takes there. Where it takes more,
# the machine is slower or busy, and nothing can be said of 20 ms.
YARDSTICK = 0.0084
UNKNOWN = 77
PARTS = ["ut_read_xml", "lac_scene_create", "lac_store_create", "lac_problem_derivative"]


def call(options, case, folder, environment=None, before=()):
    words = [*before, *run_words(options, case, folder)]
    done = subprocess.run(words, capture_output=True, text=True, check=False,
                          env={**os.environ, **(environment or {})})
    if done.returncode != 0:
        sys.exit(f"costs: {done.stderr.strip()}")
    return json.loads(done.stdout)


def opened(options, case, folder):
    """LD_PRELOAD with what the program opens while it runs: so it is loaded before main, and its share is told."""
    done = subprocess.run(run_words(options, case, folder), capture_output=True, text=True, check=True,
                          env={**os.environ, "LD_DEBUG": "files"})
    names = re.findall(r"file=(lib(?:netcdf|sundials)\S+) \[0\];  dynamically loaded", done.stderr)
    return " ".join(dict.fromkeys(names))


def counted(path):
    with open(path, encoding="ascii") as file:
        return [int(x) for x in file.read().split()]


def count_bytes(options, case, folder):
    """What the run says; bytes held and in all, threads that the libraries do not begin as they are loaded."""
    path = os.path.join(folder, "bytes")
    environment = {"LD_PRELOAD": f"{options.count} {options.opened}", "COUNT_BYTES": path}
    subprocess.run([options.lacuna, "--version"], env={**os.environ, **environment}, check=True,
                   stdout=subprocess.DEVNULL)
    before = counted(path)
    found = call(options, case, folder, environment)
    peak, total, threads = counted(path)
    return found, [peak, total, threads - before[2]]


def count_instructions(options, case, folder):
    """Instructions in all, of each part and of the plans of transforms, whatever they call included."""
    path = os.path.join(folder, "callgrind.out")
    call(options, case, folder, {"LD_PRELOAD": options.opened}, ["valgrind", "--tool=callgrind", "--quiet",
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


def cpu_time(words, preload=""):
    """User and system time of a program, as the kernel measured them."""
    quiet = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
    process = os.posix_spawn(words[0], words, {**os.environ, "LD_PRELOAD": preload}, file_actions=quiet)
    _, status, used = os.wait4(process, 0)
    if status != 0:
        sys.exit(f"costs: {' '.join(words)}: status {os.waitstatus_to_exitcode(status)}")
    return used.ru_utime + used.ru_stime


def run_words(options, case, folder):
    return [options.lacuna, "run", case, "-o", os.path.join(folder, "run.nc"), "--force", "--quiet",
            "--json"]


def times_of(options, case, folder, runs=25):
    """CPU times of the program's start with all libraries, of it alone, and of the scene, by turns; in order."""
    start = [options.lacuna, "--version"]
    programs = [(start, options.opened), (start,), (run_words(options, case, folder),)]
    times = [[cpu_time(*program) for program in programs] for _ in range(runs)]
    return [sorted(column) for column in zip(*times)]


def check_time(options, case, folder):
    start, _, block = (times[0] for times in times_of(options, case, folder))
    print(f"a block: {block * 1e3:.1f} ms of CPU, {start * 1e3:.1f} ms of it what loads all libraries, "
          f"which takes {YARDSTICK * 1e3:.1f} ms on a quiet machine")
    if block < MOST_TIME:
        return 0
    return UNKNOWN if start > 1.1 * YARDSTICK else 1


def million(count):
    return f"{count / 1e6:.3g}" if count else "0"


def check_counts(name, found, allocated, instructions):
    """Whether a scene keeps what the tests hold to. @param instructions  after the start; 0: not counted"""
    peak, total, threads = allocated
    kept = threads == 0 and found["status"] == "complete"
    if name == "a block":
        kept = kept and peak < 4 << 20 and total < 4 << 20 and instructions < MOST_INSTRUCTIONS
        print(f"a block: {peak} bytes held, {total} in all, {instructions / 1e6:.1f} million "
              "instructions after the start")
    if not kept:
        print(f"{name}: too much, or {threads} threads")
    return kept


def check(options, case, folder):
    kept = True
    for name, text in SCENES:
        write(case, text)
        found, allocated = count_bytes(options, case, folder)
        instructions = 0
        if name == "a block" and shutil.which("valgrind"):
            everything, start, *_ = count_instructions(options, case, folder)
            instructions = everything - start
        kept = check_counts(name, found, allocated, instructions) and kept
    return 0 if kept else 1


def write(case, text):
    with open(case, "w", encoding="utf-8") as file:
        file.write(text)


def print_table(options, case, folder):
    print("| scene | cells | CPU (ms) | held at once (MB) | in all (MB) | threads | resident (MB) "
          "| instructions (10^6) | before main | units | scene | FFT plans | opening the file "
          "| of an evaluation, a cell |")
    print("|" + " --- |" * 14)
    begins = []
    for name, text in SCENES:
        write(case, text)
        found, (peak, total, threads) = count_bytes(options, case, folder)
        everything, start, parts, plans = count_instructions(options, case, folder)
        one = parts[3] / found["rhs_evaluations"] / found["n_cells"]
        *begin, time = (column[0] for column in times_of(options, case, folder))
        begins.append(begin)
        print(f"| {name} | {found['n_cells']} | {time * 1e3:.0f} | {peak / 1e6:.2f} | {total / 1e6:.1f} "
              f"| {threads} | {found['peak_memory_bytes'] / 1e6:.1f} | {million(everything)} "
              f"| {million(start)} | {million(parts[0])} | {million(parts[1])} | {million(plans)} "
              f"| {million(parts[2])} | {one:.0f} |", flush=True)
    every, alone = map(min, zip(*begins))
    print(f"\nThe program's start alone, `lacuna --version`: {alone * 1e3:.1f} ms of CPU, with all libraries "
          f"{every * 1e3:.1f} ms.")
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build", "lacuna"))
    parser.add_argument("--count", default=os.path.join(ROOT, "build/tests/libcount_bytes.so"))
    what = parser.add_mutually_exclusive_group()
    what.add_argument("--check", dest="what", action="store_const", const=check)
    what.add_argument("--quick", dest="what", action="store_const", const=check_time)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        case = os.path.join(folder, "scene.yaml")
        write(case, BLOCK)
        options.opened = opened(options, case, folder)
        return (options.what or print_table)(options, case, folder)


if __name__ == "__main__":
    sys.exit(main())
