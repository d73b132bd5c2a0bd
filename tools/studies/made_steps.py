#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the readings of a velocity-step experiment, as docs/howto-laboratory.md fits them.

    tools/studies/made_steps.py [--law aging|slip] [--noise 3e-4] [--seed 1] [-o steps.csv]

A sample under 10 MPa on a spring, whose load point moves at 1 um/s, 10 um/s and 1 um/s again. The friction follows from

    dmu/dt = k (V - v)/p,   mu = f0 + a ln(v/V0) + b ln(V0 theta/dc)
    dtheta/dt = 1 - v theta/dc (aging),   -(v theta/dc) ln(v theta/dc) (slip)

by scipy's Radau, not by Lacuna; normal errors are added to it. Prints, or writes, a CSV of time, load point and friction.
"""

import argparse
import math
import sys

import numpy
from scipy.integrate import solve_ivp

F0, A, B, DC, V0 = 0.6, 0.010, 0.012, 5e-6, 1e-6
PRESSURE, STIFFNESS = 10e6, 100e9
STEPS = ((0.0, 1e-6), (20.0, 1e-5), (30.0, 1e-6), (70.0, None))  # from when on the load point moves how fast


def friction(law, times):
    """Of the sample, at rising times within the experiment."""
    out, state = numpy.empty(len(times)), [F0, math.log(DC / V0)]
    for (start, pulled), (end, _) in zip(STEPS, STEPS[1:]):
        def rates(_, y, pulled=pulled):
            v = V0 * math.exp((y[0] - F0 - B * (y[1] + math.log(V0 / DC))) / A)
            x = v * math.exp(y[1]) / DC
            healing = math.exp(-y[1])
            return [STIFFNESS * (pulled - v) / PRESSURE, healing * (1 - x) if law == "aging" else -healing * x * math.log(x)]

        here = (times >= start) & (times <= end)
        run = solve_ivp(rates, (start, end), state, "Radau", dense_output=True, rtol=1e-9, atol=1e-12)
        out[here], state = run.sol(times[here])[0], run.y[:, -1]
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--law", choices=("aging", "slip"), default="slip")
    parser.add_argument("--noise", type=float, default=3e-4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("-o", "--output")
    given = parser.parse_args()
    near = numpy.concatenate([numpy.arange(0, 2, 0.1), numpy.arange(2, 8, 0.5)])  # where the friction moves
    times = numpy.unique(numpy.concatenate([numpy.arange(0, 70.5, 1), 20 + near, 30 + near]).round(6))
    mu = friction(given.law, times) + given.noise * numpy.random.default_rng(given.seed).standard_normal(len(times))
    point = numpy.interp(times, [start for start, _ in STEPS], [0, 20, 120, 160])
    text = "time_s,load_point_um,friction\n" + "".join(f"{t:.1f},{x:.1f},{m:.5f}\n" for t, x, m in zip(times, point, mu))
    if given.output is None:
        sys.stdout.write(text)
        return
    with open(given.output, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main()
