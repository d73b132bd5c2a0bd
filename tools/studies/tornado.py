#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What each cause does to when a slope fails: the case that `lacuna new --kind slope` writes, changed in one thing at a time,
as a table in Markdown.

    tornado.py [--program build/lacuna]
"""

import argparse
import datetime
import json
import math
import os
import subprocess
import sys
import tempfile

WATER = 9806.65 * math.cos(math.radians(27)) ** 2  # pressure on the joint of a metre of water above it [Pa]
RAIN = "date,rain_mm\n" + "".join(f"{datetime.date(2023, 12, 31) + datetime.timedelta(days=day)},{30 if day % 10 == 5 else 0}\n"
                                  for day in range(1200))
RAINS = ", {rain: {file: rain.csv, time: date, rain: 'rain_mm:mm', rise: '0.1 MPa/m', drain: '10 day'}}]"


def angle(degrees):
    return [f"load.normal.slope.angle={degrees} degree", f"load.shear.0.slope.angle={degrees} degree"]


def water(metres):
    return [f"load.pore_pressure.0.constant.value={metres * WATER:.1f} Pa"]


def surface(key, *values):
    return [[f"interface.surface.self-affine.{key}={value}"] for value in values]


# cause, less, more: what is set
CAUSES = (
    ("angle 26 or 28° (27°)", angle(26), angle(28)),
    ("water 19 or 21 m above the joint (20 m)", water(19), water(21)),
    ("friction f0 0.557 or 0.577 (0.567)", ["friction.aging.f0=0.557"], ["friction.aging.f0=0.577"]),
    ("slip distance dc 3.5 or 14 cm (7 cm)", ["friction.aging.dc=3.5 cm"], ["friction.aging.dc=14 cm"]),
    ("rest of the contacts 30 or 40 days (35)", ["initial.state=30 day"], ["initial.state=40 day"]),
    ("Hurst exponent 0.5 or 0.9 (0.8)", *surface("hurst", 0.5, 0.9)),
    ("roughness 0.5 or 2 cm rms (1 cm)", *surface("rms_height", "0.5 cm", "2 cm")),
    ("size 32 or 512 m, as many cells (128 m)", ["interface.size=32 m"], ["interface.size=512 m"]),
    ("other surfaces of the same kind: seeds 2 and 3 (1)", *surface("seed", 2, 3)),
)


def failure(program, folder, changes, case="slope.yaml"):
    """Days until it fails, or None where it does not within the three years of the case."""
    words = [program, "run", case, "--force", "-q", "--json", "-o", "slope.nc", *(w for c in changes for w in ("--set", c))]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    run = json.loads(done.stdout)
    return run["failure_time_s"] / 86400 if run["failed"] else None


def told(days):
    return "stays" if days is None else f"{days:.3g}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/lacuna")
    program = os.path.abspath(parser.parse_args().program)
    with tempfile.TemporaryDirectory(prefix="lacuna-tornado-") as folder:
        subprocess.run([program, "new", "slope", "--kind", "slope"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        print(f"As it stands: {told(failure(program, folder, []))} days.\n")
        print("| what changes (from) | less: days | more: days |\n| --- | --- | --- |")
        for cause, less, more in CAUSES:
            print(f"| {cause} | {told(failure(program, folder, less))} | {told(failure(program, folder, more))} |")
        with open(os.path.join(folder, "rain.csv"), "w", encoding="utf-8") as file:
            file.write(RAIN)
        with open(os.path.join(folder, "slope.yaml"), encoding="utf-8") as file:
            text = file.read()
        with open(os.path.join(folder, "rainy.yaml"), "w", encoding="utf-8") as file:
            file.write(text.replace('{constant: {value: "155.7 kPa"}}]', '{constant: {value: "155.7 kPa"}}' + RAINS))
        print(f"| rain of 30 mm every ten days (none) | | {told(failure(program, folder, [], 'rainy.yaml'))} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
