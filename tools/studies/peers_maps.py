#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the maps of cases/peers: direct effect and state at the start of B1 and C1.

    tools/studies/peers_maps.py [FOLDER]

The earthquake-cycle codes' problems: a line of 1024 cells in slabs and a plane of 128 x 128 cells, velocity-weakening inside and
strengthening outside. Both start at the plate's rate under one traction everywhere, that of steady
sliding where a is largest:

    tau0 = a_max asinh(V/(2 v0) exp((f0 + b ln(v0/V))/a_max))              over the normal pressure
    theta = dc/v0 exp((a/b) ln(2 v0/V sinh(tau0/a)) - f0/b)

FOLDER is cases/peers of this tree if absent.
"""

import argparse
import os

import netCDF4
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
F0, B, V0, PLATE = 0.6, 0.015, 1e-6, 1e-9


def state(a, dc):
    """theta [s] that carries the traction of the cell with the largest a at the plate's rate."""
    most = a.max()
    held = most * np.arcsinh(PLATE / (2 * V0) * np.exp((F0 + B * np.log(V0 / PLATE)) / most))
    return dc / V0 * np.exp(a / B * np.log(2 * V0 / PLATE * np.sinh(held / a)) - F0 / B)


def line():
    """a and theta of B1, 1 x 1024 cells of 64 m."""
    x = (np.arange(1024) - 511.5) * 64.0
    inner = np.clip(x, -8000, 8000)
    weak = 0.010 + 0.001 * (inner + 8000) / 16000
    a = weak + (0.025 - weak) * np.minimum(1, (abs(x) - abs(inner)) / 3000)
    return a[np.newaxis, :], state(a, 0.016)[np.newaxis, :]


def plane():
    """a and theta of C1, 128 x 128 cells of 100 m."""
    at = (np.arange(128) + 0.5) * 100.0 - 6400.0
    r = np.hypot(at[np.newaxis, :] - 300, at[:, np.newaxis] - 200)
    a = np.clip(0.008 + 0.014 * (r - 4000) / 500, 0.008, 0.022)
    return a, state(a, 0.010)


def write(path, title, a, theta):
    """One netCDF file, its bytes a function of the values."""
    with netCDF4.Dataset(path, "w", format="NETCDF4_CLASSIC") as out:
        out.title = title
        out.history = "tools/studies/peers_maps.py"
        out.createDimension("y", a.shape[0])
        out.createDimension("x", a.shape[1])
        for name, values, units, text in (("a", a, "1", "direct effect of friction"),
                                          ("state", theta, "s", "state at the start")):
            variable = out.createVariable(name, "f8", ("y", "x"), zlib=True, complevel=9,
                                          shuffle=True)
            variable.units = units
            variable.long_name = text
            variable[:] = values


def main():
    """Writes both files."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", default=os.path.join(ROOT, "cases/peers"))
    folder = parser.parse_args().folder
    write(os.path.join(folder, "periodic-line.nc"), "B1, a periodic line", *line())
    write(os.path.join(folder, "plane-patch.nc"), "C1, a patch in a plane", *plane())


if __name__ == "__main__":
    main()
