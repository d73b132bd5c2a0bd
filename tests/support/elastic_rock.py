# SPDX-License-Identifier: GPL-3.0-or-later
"""The elastic half-spaces by dense matrices, with kernels of their own: what the program must find.

Slip is along x; C takes the tractions of the contact cells to their slip, gaps free of traction.
"""

import math

import numpy


def waves(nx, ny, dx, dy):
    """Wave numbers kx, ky of a periodic grid, [ny, nx] each."""
    kx = 2 * math.pi * numpy.fft.fftfreq(nx, dx)
    ky = 2 * math.pi * numpy.fft.fftfreq(ny, dy)
    return numpy.meshgrid(kx, ky)


def wave_stiffness(grid, g, nu=0.0, height=math.inf):
    """Traction per slip of every wave; nu = 0 is antiplane. Slabs: antiplane only."""
    kx, ky = waves(*grid)
    k = numpy.hypot(kx, ky)
    with numpy.errstate(invalid="ignore", divide="ignore"):
        s = g / 2 * (ky ** 2 + kx ** 2 / (1 - nu)) / k
        if math.isfinite(height):
            s /= numpy.tanh(k * height)
    s[0, 0] = g / (2 * height)
    return s


def columns(grid, index, symbol):
    """R F^-1 symbol F R^T, one unit cell after the other."""
    nx, ny = grid[:2]
    out = numpy.empty((index.size, index.size))
    for j, cell in enumerate(index):
        unit = numpy.zeros((ny, nx))
        unit.flat[cell] = 1
        out[:, j] = numpy.fft.ifft2(symbol * numpy.fft.fft2(unit)).real.flat[index]
    return out


def periodic(grid, index, g, nu=0.0, height=math.inf):
    """C of an interface that repeats; of half-spaces without the mean."""
    s = wave_stiffness(grid, g, nu, height)
    with numpy.errstate(divide="ignore"):
        return columns(grid, index, numpy.where(s > 0, 1 / s, 0))


def glued(grid, index, g, nu=0.0):
    """Stiffness of the cells where the gaps do not slip."""
    return columns(grid, index, wave_stiffness(grid, g, nu))


def gauss(low, high, n=24):
    """Points and weights of quadrature."""
    x, w = numpy.polynomial.legendre.leggauss(n)
    return 0.5 * (low + high) + 0.5 * (high - low) * x, 0.5 * (high - low) * w


def own_slip(dx, dy, nu):
    """Integral of the point's slip over its own cell, by angle: f(phi) times the way to the border."""
    corner, total = math.atan2(dy, dx), 0.0
    for low, high, side in ((0, corner, "x"), (corner, math.pi / 2, "y")):
        phi, w = gauss(low, high, 60)
        way = dx / 2 / numpy.cos(phi) if side == "x" else dy / 2 / numpy.sin(phi)
        total += (w * way / (numpy.cos(phi) ** 2 + numpy.sin(phi) ** 2 / (1 - nu))).sum()
    return 4 * total


def alone(grid, index, g, nu=0.0):
    """C of a plane patch that is alone on half-spaces: the point's slip integrated over each cell."""
    nx, ny, dx, dy = grid
    table = numpy.empty((ny, nx))
    for j in range(ny):
        for i in range(nx):
            if i == j == 0:
                table[j, i] = own_slip(dx, dy, nu)
                continue
            x, wx = gauss((i - 0.5) * dx, (i + 0.5) * dx)
            y, wy = gauss((j - 0.5) * dy, (j + 0.5) * dy)
            x, y = numpy.meshgrid(x, y)
            slip = numpy.hypot(x, y) / (x * x + y * y / (1 - nu))
            table[j, i] = wy @ slip @ wx
    x, y = index % nx, index // nx
    return table[abs(y[:, None] - y), abs(x[:, None] - x)] / (math.pi * g)


def alone_line(grid, index, g, nu=0.0):
    """C of a line that is alone, up to a constant: 2 (1-nu)/(pi G) times the integral of -ln|x|."""
    dx = grid[2]
    x = (index[:, None] - index) * dx

    def primitive(x):
        return x * numpy.log(abs(x)) - x

    return -2 * (1 - nu) / (math.pi * g) * (primitive(x + dx / 2) - primitive(x - dx / 2))


def creeping_line(grid, g, nu=0.0):
    """K of a line whose surroundings slip alike: two dislocations at the ends of each cell."""
    nx, dx = grid[0], grid[2]
    x = numpy.subtract.outer(numpy.arange(nx), numpy.arange(nx)) * dx
    return g / (2 * math.pi * (1 - nu)) * (1 / (x + dx / 2) - 1 / (x - dx / 2))


def stiffness(compliance):
    """K: the tractions of a slip, its mean left free: C^-1 - C^-1 1 1^T C^-1 / (1^T C^-1 1)."""
    n = len(compliance)
    saddle = numpy.zeros((n + 1, n + 1))
    saddle[:n, :n] = compliance
    saddle[:n, n] = saddle[n, :n] = numpy.abs(compliance).max()
    return numpy.linalg.inv(saddle)[:n, :n]


def tied(compliance):
    """Tractions of mean 1 under which the cells slip alike, wherever they slip to."""
    n = len(compliance)
    saddle = numpy.zeros((n + 1, n + 1))
    saddle[:n, :n] = compliance
    saddle[:n, n] = saddle[n, :n] = numpy.abs(compliance).max()
    load = numpy.zeros(n + 1)
    load[n] = n * saddle[n, 0]
    return numpy.linalg.solve(saddle, load)[:n]


def levels(grid, index):
    """P_0 ... P_m: means over the cells of each block of 2^l cells a side."""
    nx = grid[0]
    x, y, out = index % nx, index // nx, []
    while not out or not (out[-1] > 0).all():
        block = (y >> len(out)) * nx + (x >> len(out))
        same = (block[:, None] == block).astype(float)
        out.append(same / same.sum(axis=1))
    return out
