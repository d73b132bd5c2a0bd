#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Asked against achieved error of `lacuna run --accuracy`, as a table in markdown.

    tools/studies/accuracy.py [--lacuna PROGRAM] [--asked X ...] [SCENE ...]
    tools/studies/accuracy.py --random 40 --seed 2000 [--asked 0.01 0.001] [--instructions 8]

Runs each scene with each accuracy asked for, and once with bdf at rtol 1e-10 (of fidelity events:
1e-8) for a reference, and prints what was picked and how far the result is from the reference: of the
time of failure, of the time at which a limit is reached, or of the mean slip at the end. A scene is a
case and what is set in it. Exit status 1 where an error is larger than was asked. Two minutes of one
core.

With --random the scenes are drawn (accuracy_scenes.py: seed, seed + 1 ...), the reference is erk or bdf at
1e-10, and what all runs of --accuracy took is told in that of the cheapest setting that keeps the error, out
of bdf, adams and erk at rtol 1e-3, 1e-4 ... 1e-7: what `lacuna trade` would try. A scene that cannot be run,
or of which the reference does not know 1e-5 of its result, is passed over, which is said. Cost is counted as
--accuracy does, in evaluations; with --instructions that ratio is shown beside that of instructions within lac_run,
by callgrind, for the first so many scenes. 40 scenes: two minutes of one core, and half a minute a scene by callgrind.
"""

import argparse
import json
import os
import random
import re
import subprocess
import sys
import tempfile

import accuracy_scenes

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCENES = [
    ("vajont.yaml", "interface.levels=6"),
    ("vajont.yaml", "interface.levels=6", "interface.surface.self-affine.seed=9"),
    ("century.yaml",),
    ("lab-shear.yaml",),
    ("bridge.yaml", "interface.spread.pressure.uniform.seed=5"),
    ("events.yaml",),
    ("one-by-one.yaml", "interface.levels=4"),
    ("friction/slip.yaml",),
    ("friction/composite.yaml",),
    ("friction/cut-off.yaml",),
    ("friction/spread.yaml",),
    ("friction/tails.yaml",),
    ("load/pore-step.yaml",),
    ("load/ramp.yaml",),
    ("load/rain.yaml",),
    ("load/reservoir.yaml",),
    ("load/shaking.yaml",),
    ("load/tides.yaml",),
    ("transfer/elastic.yaml",),
    ("transfer/hierarchy.yaml", "interface.domain.cascade.seed=8"),
    ("transfer/line.yaml",),
    ("momentum/runaway.yaml",),
    ("momentum/swing.yaml",),
    ("domain/file.yaml",),
    ("peers/spring-slider.yaml", "time.end=3e7 s"),
]


def run(program, folder, case, settings):
    """What `lacuna run` says."""
    words = [program, "run", case, "-o", os.path.join(folder, "run.nc"), "--force", "--quiet",
             "--json"]
    for setting in settings:
        words += ["--set", setting]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"accuracy: {case} {' '.join(settings)}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def value(found):
    """What an accuracy is held to."""
    if found["failed"]:
        return found["failure_time_s"]
    return found["time_s"] if found["ended_by"] == "stop_when" else found["mean_slip_m"]


def scene_rows(options, folder, scene):
    """Lines of the table, and whether all errors are kept."""
    case, settings = os.path.join(ROOT, "cases", scene[0]), list(scene[1:])
    plain = run(options.lacuna, folder, case, settings + ["solver.accuracy=0.5"])
    tight = "1e-8" if plain["fidelity"] == "events" else "1e-10"
    reference = run(options.lacuna, folder, case, settings + [f"solver.rtol={tight}"])
    kept, lines = True, []
    for asked in options.asked:
        found = run(options.lacuna, folder, case, settings + [f"solver.accuracy={asked}"])
        error = abs(value(found) / value(reference) - 1)
        pick = found["accuracy"]
        kept = kept and error <= asked
        name = scene[0] + (" (" + ", ".join(s.split(".")[-1] for s in settings) + ")" if settings
                           else "")
        lines.append(f"| {name} | {pick['quantity']} | {asked:g} | {error:.1e} | "
                     f"{pick['estimated']:.1e} | {pick['method']}, {pick['rtol']:g} | "
                     f"{found['rhs_evaluations']} | {pick['pilot_rhs_evaluations']} | "
                     f"{reference['rhs_evaluations']} |")
    return lines, kept


METHODS = {"bdf": 4.2, "adams": 4.2, "erk": 2.2}  # what a step counts, in evaluations
SOLVE = 2.2


class Scene:
    """A drawn scene, in a folder of its own."""

    def __init__(self, program, folder, seed):
        self.program, self.folder, self.seed = program, folder, seed
        case, files = accuracy_scenes.draw(random.Random(seed))
        self.title, self.massive = case["title"], "inertia" in case
        for name, text in {**files, "case.yaml": json.dumps(case)}.items():
            with open(os.path.join(folder, name), "w", encoding="ascii") as file:
                file.write(text)

    def run(self, *settings, under=()):
        """What `lacuna run` says; None where it fails."""
        words = [*under, self.program, "run", "case.yaml", "-o", "run.nc", "--force", "--quiet", "--json"]
        for setting in settings:
            words += ["--set", setting]
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=self.folder, env=environment)
        return json.loads(done.stdout) if done.returncode == 0 else None

    def instructions(self, *settings):
        """Of all runs within one of the program."""
        self.run(*settings, under=("valgrind", "--quiet", "--tool=callgrind", "--toggle-collect=lac_run",
                                   "--callgrind-out-file=counted"))
        with open(os.path.join(self.folder, "counted"), encoding="ascii") as file:
            return int(re.search(r"^totals: (\d+)", file.read(), re.MULTILINE)[1])

    def reference(self):
        """A result of the method whose last two decades agree best, and how well they do."""
        best = None
        for method in ("bdf",) if self.massive else ("erk", "bdf"):
            pair = [self.run(f"solver.method={method}", f"solver.rtol={rtol}", "solver.max_steps=100000")
                    for rtol in ("1e-9", "1e-10")]
            if None not in pair and off(*pair) < (best[1] if best else 1e-5):
                best = pair[1], off(*pair)
        return best

    def tried(self):
        """Settings, what they count and what comes out."""
        first = self.run("solver.method=bdf", "solver.rtol=1e-3", "solver.max_steps=50000")
        most = max(2000, 20 * first["steps"]) if first else 0
        for method in METHODS if not self.massive else ("bdf",):
            for rtol in ("1e-3", "1e-4", "1e-5", "1e-6", "1e-7"):
                limit = 100000 if method == "bdf" else most
                found = self.run(f"solver.method={method}", f"solver.rtol={rtol}", f"solver.max_steps={limit}")
                if found is None and method != "bdf":
                    break
                if found is not None:
                    yield method, rtol, count(method, found), found


def count(method, found):
    return found["rhs_evaluations"] + SOLVE * found["linear_solves"] + METHODS[method] * found["steps"]


def off(found, reference):
    """Relative error; infinite where they end by other reasons."""
    if (found["failed"], found["ended_by"]) != (reference["failed"], reference["ended_by"]):
        return float("inf")
    exact = value(reference)
    return abs(value(found) - exact) / (abs(exact) or 1)


def drawn_rows(options, scene):
    """Lines of the table of a drawn scene with ratio and whether its error is kept; None: passed over."""
    reference = scene.reference()
    if reference is None:
        return None
    reference, rows = reference[0], []
    tried = list(scene.tried())
    for asked in options.asked:
        found = scene.run(f"solver.accuracy={asked}")
        error = off(found, reference)
        pick = found["accuracy"]
        method, rtol, least, _ = min((t for t in tried if off(t[3], reference) <= asked), key=lambda t: t[2])
        ratio = pick["pilot_work"] / least
        counted = ""
        if scene.seed < options.seed + options.instructions:
            counted = scene.instructions(f"solver.accuracy={asked}") / scene.instructions(
                f"solver.method={method}", f"solver.rtol={rtol}")
            counted = f" {counted:.2f} |"
        elif options.instructions:
            counted = " |"
        rows.append((ratio, error, pick["estimated"], asked,
                     f"| {scene.seed} | {scene.title}, {found['n_cells']} | {pick['quantity']} | {asked:g} | {error:.1e} | "
                     f"{pick['estimated']:.1e} | {pick['method']}, {pick['rtol']:g} | {pick['pilots']} | "
                     f"{method}, {rtol} | {ratio:.2f} |{counted}"))
    return rows


def drawn(options):
    """The table of drawn scenes, and what is common to them; whether all errors are kept."""
    print("| seed | transfer, law, cells | of | asked | achieved | estimated | picked | runs | cheapest | cost over its |"
          + (" by instructions |" if options.instructions else ""))
    print("| --- " * (11 if options.instructions else 10) + "|")
    rows, seed, passed = [], options.seed, []
    while len(rows) < options.random * len(options.asked):
        with tempfile.TemporaryDirectory() as folder:
            found = drawn_rows(options, Scene(os.path.abspath(options.lacuna), folder, seed))
        if found is None:
            passed.append(str(seed))
        for row in found or []:
            rows.append(row)
            print(row[4], flush=True)
        seed += 1
    print(f"\nPassed over: {', '.join(passed) or 'none'}.")
    for asked in options.asked:
        of = sorted(row for row in rows if row[3] == asked)
        kept = sum(row[1] <= asked for row in of)
        known = sum(row[1] <= row[2] for row in of)
        print(f"{asked:g}: {kept} of {len(of)} kept, {known} within the estimate, cost over the cheapest "
              f"{of[len(of) // 2][0]:.2f} in the middle, {of[-1][0]:.2f} at most")
    return all(row[1] <= row[3] for row in rows)


def chosen(names):
    """Scenes of these cases, as they stand in the list or else as they are; all of the list if none."""
    listed = [scene for scene in SCENES if not names or scene[0] in names]
    known = {scene[0] for scene in listed}
    return listed + [(name,) for name in names if name not in known]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("scene", nargs="*", help="cases below cases/; those of the list if none")
    parser.add_argument("--lacuna", default=os.path.join(ROOT, "build", "lacuna"))
    parser.add_argument("--asked", type=float, nargs="+", default=[0.05, 0.01, 0.001])
    parser.add_argument("--random", type=int, default=0, metavar="N", help="so many drawn scenes instead")
    parser.add_argument("--seed", type=int, default=2000, help="of the first of them")
    parser.add_argument("--instructions", type=int, default=0, metavar="N", help="count them too for so many seeds")
    options = parser.parse_args()
    if options.random:
        return 0 if drawn(options) else 1
    print("| case | of | asked | achieved | estimated | picked | evaluations | of pilots "
          "| of the reference |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    kept = True
    with tempfile.TemporaryDirectory() as folder:
        for scene in chosen(options.scene):
            lines, good = scene_rows(options, folder, scene)
            print("\n".join(lines), flush=True)
            kept = kept and good
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
