#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""a, b and dc of a laboratory fault from one velocity step, as docs/rocks.md states two of them.

    tools/studies/velocity_step.py FILE --before V --after V --at T [--span S] [--steady FROM TO]

FILE has lines of time [s], displacement [um], friction, normal stress [MPa], and a line of names first, as
the velocity steps of https://github.com/pgiacomel/steadystate have (Giacomel, Faulkner, Lambert & Allen 2024,
Geosphere 20, 965, doi 10.1130/GES02739.1). V in um/s, T about when the step comes, since the first line.

A block on a spring, pulled at V before and V after the step: dmu/dt = k (V - v), mu = mu0 + a ln(v/V_before)
+ b ln(V_before theta/dc), with the aging and with the slip law. a, b, dc, k, mu0, a slope in time and the time of
the step are fitted by least squares (Levenberg and Marquardt) to the readings within S seconds of T. --steady: no fit,
but a - b from the mean before the step and that between FROM and TO um of slip behind it.

    velocity_step.py velstep4_BRAVA_expb819_basalt.txt --before 3 --after 10.1 --at 68.6 --span 16
    velocity_step.py velstep3_TR2_exp013_sepiolite.txt --before 0.2 --after 2 --at 1234 --steady 250 2000
"""

import argparse
import sys

import numpy

PACE = 0.002  # s, of the Runge-Kutta steps


def changes(u, w, law, given, pull):
    """d ln v/dt and d ln theta/dt, u and w of what they were before the step."""
    a, b, dc, k, before = given
    rate = before * numpy.exp(u)
    renewed = rate / dc
    dw = before / dc * numpy.exp(-w) - renewed if law == "aging" else -renewed * (u + w)
    return (k * (pull - rate) - b * dw) / a, dw


def friction(p, times, law, before, after):
    mu0, a, b, log_dc, log_k, slope, at = p
    given = (a, b, numpy.exp(log_dc), numpy.exp(log_k), before)
    clock = at + numpy.arange(int((times[-1] - at) / PACE) + 2) * PACE
    gain, u, w = numpy.empty(len(clock)), 0.0, 0.0
    for i in range(len(clock)):
        gain[i] = a * u + b * w
        u1, w1 = changes(u, w, law, given, after)
        u2, w2 = changes(u + PACE / 2 * u1, w + PACE / 2 * w1, law, given, after)
        u3, w3 = changes(u + PACE / 2 * u2, w + PACE / 2 * w2, law, given, after)
        u4, w4 = changes(u + PACE * u3, w + PACE * w3, law, given, after)
        u += PACE / 6 * (u1 + 2 * u2 + 2 * u3 + u4)
        w += PACE / 6 * (w1 + 2 * w2 + 2 * w3 + w4)
    return mu0 + numpy.where(times < at, 0, numpy.interp(times, clock, gain)) + slope * (times - at)


def fit(times, mu, at, law, before, after):
    p = numpy.array([mu[times < at].mean(), 0.008, 0.009, numpy.log(5.0), numpy.log(0.003), 0.0, at])
    small = numpy.array([1e-5, 1e-5, 1e-5, 1e-3, 1e-3, 1e-7, 1e-3])
    rest, damping = mu - friction(p, times, law, before, after), 1e-2
    for _ in range(60):
        base = friction(p, times, law, before, after)
        rows = [(friction(p + small * one, times, law, before, after) - base) / h
                for one, h in zip(numpy.eye(len(p)), small)]
        matrix = numpy.array(rows) @ numpy.array(rows).T
        pull = numpy.array(rows) @ rest
        for _ in range(8):
            tried = p + numpy.linalg.solve(matrix + damping * numpy.diag(numpy.diag(matrix)), pull)
            left = mu - friction(tried, times, law, before, after)
            if left @ left < rest @ rest:
                break
            damping *= 4
        else:
            break
        gained = 1 - (left @ left) / (rest @ rest)
        p, rest, damping = tried, left, 0.3 * damping
        if gained < 1e-9:
            break
    error = numpy.sqrt(numpy.diag(numpy.linalg.inv(matrix)) * (rest @ rest) / (len(mu) - len(p)))
    dc = numpy.exp(p[3])
    print(f"{law}: f0 {p[0]:.4f} at {before:g} um/s, a {p[1]:.5f} +- {error[1]:.5f}, b {p[2]:.5f} +- {error[2]:.5f}, "
          f"a - b {p[1] - p[2]:.5f}, dc {dc:.2f} +- {dc * error[3]:.2f} um, k {numpy.exp(p[4]):.4f}/um, "
          f"rms {numpy.sqrt(rest @ rest / len(mu)):.5f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("file")
    parser.add_argument("--before", type=float, required=True)
    parser.add_argument("--after", type=float, required=True)
    parser.add_argument("--at", type=float, required=True)
    parser.add_argument("--span", type=float, default=16.0)
    parser.add_argument("--steady", type=float, nargs=2)
    given = parser.parse_args()
    readings = numpy.loadtxt(given.file, skiprows=1)
    times, slip, mu = readings[:, 0] - readings[0, 0], readings[:, 1] - readings[0, 1], readings[:, 2]
    if given.steady:
        slip = slip - numpy.interp(given.at, times, slip)
        low, high = mu[slip < -1].mean(), mu[(slip > given.steady[0]) & (slip < given.steady[1])].mean()
        print(f"{low:.4f} before, {high:.4f} after: a - b {(high - low) / numpy.log(given.after / given.before):.4f}")
        return
    near = abs(times - given.at) < given.span
    for law in ("aging", "slip"):
        fit(times[near], mu[near], given.at, law, given.before, given.after)


if __name__ == "__main__":
    sys.exit(main())
