#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the maps of cases/peers and cases/seas: what varies over the cells of a fault.

    tools/studies/peers_maps.py [--cell METRES] [--box TIMES] [--folder FOLDER] [NAME ...]

NAME is a file's, such as bp5; all are made if none is named, each for the cells that its case has and
into the case's folder; with --cell, --box and --folder for other cells or a larger fault, elsewhere. Unless
the fault is larger, the case goes along, with so many cells: lacuna run FOLDER/bp5.yaml -o coarse.nc. A file
holds of the direct effect a, the slip dc, and the slip rate and the state at the start what varies. Where
all slides at the plate's rate V under one traction, that of steady sliding where a is largest, the state is

    tau0 = a_max asinh(V/(2 v0) exp((f0 + b ln(v0/V))/a_max))              over the normal pressure
    theta = dc/v0 exp((a/b) ln(2 v0/V sinh(tau0/a)) - f0/b)
"""

import argparse
import os
import re

import netCDF4
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
F0, V0, PLATE = 0.6, 1e-6, 1e-9


def state(a, b, dc):
    """theta [s] that carries the traction of the cell with the largest a at the plate's rate."""
    most = a.max()
    held = most * np.arcsinh(PLATE / (2 * V0) * np.exp((F0 + b * np.log(V0 / PLATE)) / most))
    return dc / V0 * np.exp(a / b * np.log(2 * V0 / PLATE * np.sinh(held / a)) - F0 / b)


def centres(length, cell, zero=0.0):
    """Of the cells along an axis that begins `zero` before its origin [m]."""
    return (np.arange(round(length / cell)) + 0.5) * cell - zero


def periodic_line(cell, box):
    """B1, 65 536 m."""
    x = centres(65536 * box, cell, 32768 * box)
    inner = np.clip(x, -8000, 8000)
    weak = 0.010 + 0.001 * (inner + 8000) / 16000
    a = (weak + (0.025 - weak) * np.minimum(1, (abs(x) - abs(inner)) / 3000))[np.newaxis, :]
    return {"a": a, "state": state(a, 0.015, 0.016)}


def plane_patch(cell, box):
    """C1, 12 800 m a side."""
    at = centres(12800 * box, cell, 6400 * box)
    r = np.hypot(at[np.newaxis, :] - 300, at[:, np.newaxis] - 200)
    a = np.clip(0.008 + 0.014 * (r - 4000) / 500, 0.008, 0.022)
    return {"a": a, "state": state(a, 0.015, 0.010)}


def bp1(cell, box):
    """BP1-QD: a over 40 km of depth."""
    z = centres(40e3 * box, cell)[np.newaxis, :]
    a = 0.010 + 0.015 * np.clip((z - 15e3) / 3e3, 0, 1)
    return {"a": a, "state": state(a, 0.015, 0.008)}


def beyond(x, y, half_x, half_y):
    """How far a place lies outside a rectangle about the origin, along the axis of which it is more [m]."""
    return np.maximum(abs(x) - half_x, abs(y) - half_y)


def bp4(cell, box):
    """BP4-QD: 200 x 80 km about a patch of 60 x 30 km, and a square that slides at the start."""
    x, y = np.meshgrid(centres(200e3 * box, cell, 100e3 * box), centres(80e3 * box, cell, 40e3 * box))
    a = 0.0065 + 0.0185 * np.clip(beyond(x, y, 30e3, 15e3) / 3e3, 0, 1)
    quick = beyond(x + 22.5e3, y + 7.5e3, 6e3, 6e3) < 0
    return {"a": a, "state": state(a, 0.013, 0.04), "slip_rate": np.where(quick, 0.03, PLATE)}


def bp5(cell, box):
    """BP5-QD: 100 km of strike x 40 km of depth; the state is steady at the plate's rate."""
    x, z = np.meshgrid(centres(100e3 * box, cell, 50e3 * box), centres(40e3 * box, cell))
    a = 0.004 + 0.036 * np.clip(beyond(x, z - 10e3, 30e3, 6e3) / 2e3, 0, 1)
    quick = beyond(x + 24e3, z - 10e3, 6e3, 6e3) < 0
    dc = np.where(quick, 0.13, 0.14)
    return {"a": a, "dc": dc, "state": dc / PLATE, "slip_rate": np.where(quick, 0.03, PLATE)}


PROBLEMS = {  # folder, cells of the case [m], title, what makes it
    "periodic-line": ("peers", 64, "B1, a periodic line", periodic_line),
    "plane-patch": ("peers", 100, "C1, a patch in a plane", plane_patch),
    "bp1": ("seas", 100, "BP1-QD", bp1),
    "bp4": ("seas", 1000, "BP4-QD", bp4),
    "bp5": ("seas", 1000, "BP5-QD", bp5),
}
MEANINGS = {
    "a": ("1", "direct effect of friction"),
    "dc": ("m", "slip that renews the state"),
    "slip_rate": ("m s-1", "slip rate at the start"),
    "state": ("s", "state at the start"),
}


def write(path, title, maps):
    """One netCDF file, its bytes a function of the values."""
    with netCDF4.Dataset(path, "w", format="NETCDF4_CLASSIC") as out:
        out.title = title
        out.history = "tools/studies/peers_maps.py"
        rows, columns = maps["a"].shape
        out.createDimension("y", rows)
        out.createDimension("x", columns)
        for name, values in maps.items():
            variable = out.createVariable(name, "f8", ("y", "x"), zlib=True, complevel=9,
                                          shuffle=True)
            variable.units, variable.long_name = MEANINGS[name]
            variable[:] = values


def bring(case, folder, refined):
    """Copies a case to the folder of its maps, with so many times the cells along a side."""
    with open(case, encoding="utf-8") as file:
        text = re.sub(r"(cells_[xy]: )(\d+)", lambda key: f"{key[1]}{round(int(key[2]) * refined)}", file.read())
    with open(os.path.join(folder, os.path.basename(case)), "w", encoding="utf-8") as file:
        file.write(text)


def main():
    """Writes the files that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cell", type=float, help="side of a cell [m]")
    parser.add_argument("--box", type=float, default=1, help="sides over those of the problem")
    parser.add_argument("--folder", help="where the files go")
    parser.add_argument("name", nargs="*", choices=[*PROBLEMS, []])
    given = parser.parse_args()
    for name in given.name or PROBLEMS:
        group, cell, title, maps = PROBLEMS[name]
        home = os.path.join(ROOT, "cases", group)
        folder = given.folder or home
        os.makedirs(folder, exist_ok=True)
        write(os.path.join(folder, name + ".nc"), title, maps(given.cell or cell, given.box))
        if given.box == 1 and not os.path.samefile(folder, home):
            bring(os.path.join(home, name + ".yaml"), folder, cell / (given.cell or cell))


if __name__ == "__main__":
    main()
