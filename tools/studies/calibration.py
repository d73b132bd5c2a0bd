# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantiles of a method's intervals from forecasts of failures whose time is known, as src/forecast applies them.

With R the time left, x = ln R of the method's own time, W the window's length: the centre is c = x + pull (ln W - x), and
ln R at a level is c + E q with E = hypot(error, spread), the error of the fit. Of a method with a posterior x is its
median, and the error at another level is how far that quantile is from the median, over the normal distribution's.
"""

import numpy

SHARES = numpy.array([0.05, 0.25, 0.5, 0.75, 0.95])
NORMAL = numpy.array([1.6448536269514722, 0.6744897501960817, 1.0, 0.6744897501960817, 1.6448536269514722])
NAMES = ("low90", "low50", "median", "high50", "high90")
PULLS = numpy.arange(5) / 10  # more tells of the population, and would move the times of laws that fit exactly
SPREADS = (0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.4, 0.55, 0.75, 1.0, 1.3, 1.6)


def seen(now, start, raw, error, posterior):
    """(x, ln W, the five errors) of a forecast; None where a number of them is not finite."""
    errors = numpy.full(5, error, float)
    with numpy.errstate(invalid="ignore", divide="ignore"):
        x, window = numpy.log(raw - now), numpy.log(now - start)
        if posterior is not None:
            left = numpy.log(numpy.array(posterior, float) - now)
            x, errors = left[2], numpy.where(SHARES == 0.5, error, numpy.abs(left - left[2]) / NORMAL)
    return (x, window, errors) if numpy.isfinite([x, window, *errors]).all() else None


def weighted_quantile(values, weights, share):
    order = numpy.argsort(values)
    weight = weights[order] / weights.sum()
    return numpy.interp(share, numpy.cumsum(weight) - weight / 2, values[order])


def pinball(off, weights, share):
    """Mean loss of a quantile at this share from which the truth is off by so much."""
    return numpy.average(numpy.where(off >= 0, share * off, (share - 1) * off), weights=weights)


def places(x, window, errors, pull, spread, q):
    """ln R at the five levels, of all forecasts."""
    return (x + pull * (window - x))[:, None] + numpy.hypot(errors, spread) * q


def best(truth, x, window, errors, weights, pulls=PULLS, spreads=SPREADS):
    """(loss, pull, spread, the five q) of the least mean loss; `truth` is ln R. Of a method without errors of its own, the
    baseline, any spread does as well."""
    found = None
    if not errors.any():
        spreads = (1.0,)
    for pull in pulls:
        off = truth - x - pull * (window - x)
        for spread in spreads:
            scale = numpy.hypot(errors, spread)
            q = numpy.array([weighted_quantile(off / scale[:, k], weights, share) for k, share in enumerate(SHARES)])
            loss = sum(pinball(off - scale[:, k] * q[k], weights, share) for k, share in enumerate(SHARES)) / 5
            if found is None or loss < found[0] - 1e-9:
                found = loss, float(pull), spread, q
    return found


def row(pull, spread, q):
    """As the method's row in src/forecast has it."""
    return "{" + ", ".join([f".pull = {pull:g}", f".spread = {spread:g}",
                            *(f".{name} = {value:.3f}" for name, value in zip(NAMES, q))]) + "}"
