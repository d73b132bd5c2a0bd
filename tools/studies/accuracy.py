#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Asked against achieved error of `lacuna run --accuracy`, as a table in markdown.

    tools/studies/accuracy.py [--lacuna PROGRAM] [--asked X ...] [SCENE ...]

Runs each scene with each accuracy asked for, and once with bdf at rtol 1e-10 (of fidelity events:
1e-8) for a reference, and prints what was picked and how far the result is from the reference: of the
time of failure, of the time at which a limit is reached, or of the mean slip at the end. A scene is a
case and what is set in it. Exit status 1 where an error is larger than was asked. Two minutes of one
core.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile

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
    options = parser.parse_args()
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
