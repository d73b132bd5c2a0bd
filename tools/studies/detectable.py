#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What could be told of synthetic slopes that fail by who knew their motion and met white noise alone, as a table.

    detectable.py [--generator tools/studies/slopes_held.py] [--slopes 6] [--seed 8] [--left 0.05]

At a share of life left the true motion is held against the nearest curve of a kind that does not fail, in the windows of
src/forecast/evidence.c: a line, a step that relaxes, a rate that goes over to another. Their distance over the noise,
sqrt(sum of squares)/sigma, is what the best test of these two curves has to go by: of 2 it finds a half at one false
answer in 44. Nothing of the program is used, so no rule for levels finds more than this leaves without calling rates that go over
to others failures.
"""

import argparse

import numpy

import slopes
import verdicts

GROUPS, COARSE, PLACES, TIMES = 96, 1 / 15, 24, 9  # of evidence.c
LEAST, LEAST_PART = 6, 10
DISTANCES = (2, 4)


def means(time, way):
    """The motion back from its end in means, as evidence.c takes them: times back, ways, and how many readings of each."""
    back, found, last = time[-1] - time[::-1], [], 0
    while last < len(back) and len(found) < GROUPS:
        first, last = last, max(last + 1, int(numpy.searchsorted(back, (1 + COARSE) * back[last], "right")))
        found.append((back[first:last].mean(), way[::-1][first:last].mean(), last - first))
    return numpy.array(found, float).T


def changes(back, step):
    """Curves of the two kinds that bend, a row each."""
    span, first = back[-1], 0.2 * step
    since = first * (span / first) ** (numpy.arange(PLACES) / PLACES)
    length = first * (span / first) ** (numpy.arange(TIMES) / (TIMES - 1))
    u = ((since[:, None, None] - back) / length[:, None]).reshape(-1, len(back))
    return numpy.vstack([-numpy.expm1(-u.clip(0)), numpy.where(u > 30, u, numpy.log1p(numpy.exp(u.clip(-700, 30))))])


def off(back, way, count, curves):
    """Distances of the way from the nearest line, and from the nearest curve on a line."""
    root = numpy.sqrt(count)
    line, _ = numpy.linalg.qr(numpy.stack([root, root * back], axis=1))
    y, x = root * way, root * curves
    y, x = y - line @ (line.T @ y), x - (x @ line) @ line.T
    square = (x * x).sum(axis=1)
    along = (x @ y).clip(0) ** 2 / numpy.where(square > 0, square, numpy.inf)
    return numpy.sqrt(y @ y), numpy.sqrt(max(0, y @ y - along.max()))


def told(slope, left):
    """The largest distances over the noise of all windows."""
    known = slope["time"] <= slope["failure"] * (1 - left)
    time, way = slope["time"][known], slope["meta"]["true"][known]
    back, way, count = means(time, way)
    best, span = numpy.zeros(2), back[-1]
    inside, least = back <= span, LEAST
    while inside.sum() >= least:
        curves = changes(back[inside], time[-1] - time[-2])
        best = numpy.maximum(best, off(back[inside], way[inside], count[inside], curves))
        span, least = span / 3, LEAST_PART
        inside = back <= span
    return best / slope["meta"]["noise"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--generator", default=slopes.__file__)
    parser.add_argument("--slopes", type=int, default=6, help="of each instrument and kind: 6")
    parser.add_argument("--seed", type=int, default=8)
    parser.add_argument("--left", type=float, default=0.05, help="share of life left: 0.05")
    arguments = parser.parse_args()
    drawn = verdicts.generator_of(arguments.generator)
    heads = [f"off {what} by {d} and more" for what in ("a line", "any of the three") for d in DISTANCES]
    print("| instrument | n | " + " | ".join(heads) + " |\n|" + " --- |" * (2 + len(heads)))
    for instrument in drawn.INSTRUMENTS:
        found = numpy.array([told(drawn.draw(instrument, kind, arguments.seed * 1000000 + k), arguments.left)
                             for kind in drawn.FAILING for k in range(arguments.slopes)])
        shares = [f"{100 * (found[:, place] >= d).mean():.0f}" for place in (0, 1) for d in DISTANCES]
        print(f"| {instrument} | {len(found)} | " + " | ".join(shares) + " |")


if __name__ == "__main__":
    main()
