#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Synthetic slopes as instruments see them: of known failure, or none.

    slopes.py INSTRUMENT KIND [--seed 1]        prints one as CSV
    draw(instrument, kind, seed)                the same in Python

A slope is a true motion (its kind) seen by an instrument: its sampling, gaps, noise, resolution. What is not fixed by
the two is drawn from the ranges that stand in `INSTRUMENTS` and beside each kind, over orders of magnitude where
slopes differ by as much. The same three arguments give the same readings. Nothing here knows how anything forecasts.

Motions are given as rates over the share s of the record, 0 to 1; a failing slope fails at s = 1, R = 1 - s is the
life left. Rates are integrated numerically on a grid that is fine towards failure.
"""

import argparse
import sys
import zlib

import numpy

DAY = 86400.0
YEAR = 365.25 * DAY

# step: median between readings; life: range of the record, or of the life of one that fails; noise: range of the
# standard error of a reading; failing, lasting: ranges of the displacement with a fiftieth of life left, and of that of
# a slope that does not fail; season: period of what drives it from outside; digits: that a file would show
INSTRUMENTS = {
    "satellite": {"step": 13 * DAY, "life": (2 * YEAR, 6 * YEAR), "noise": (0.1, 0.4), "failing": (2, 20),
                  "lasting": (0.3, 10), "season": YEAR, "digits": 3},
    "prism": {"step": DAY, "life": (0.3 * YEAR, 3 * YEAR), "noise": (1e-3, 4e-3), "failing": (0.1, 5),
              "lasting": (0.01, 3), "season": YEAR, "digits": 4},
    "radar": {"step": 300.0, "life": (7 * DAY, 7 * DAY), "noise": (5e-5, 2e-4), "failing": (0.02, 2),
              "lasting": (5e-4, 0.3), "season": DAY, "digits": 5},
    "survey": {"step": YEAR / 12, "life": (3 * YEAR, 12 * YEAR), "noise": (3e-3, 8e-3), "failing": (0.2, 5),
               "lasting": (0.05, 3), "season": YEAR, "digits": 3},
    "extensometer": {"step": 6 * 3600.0, "life": (0.2 * YEAR, 2 * YEAR), "noise": (2e-5, 3e-4), "failing": (0.05, 3),
                     "lasting": (5e-3, 1), "season": YEAR, "digits": 6},
}
POWERS = {"log": 2.0, "power13": 1.3, "power15": 1.5, "power25": 2.5, "power3": 3.0}  # exponents of Voight's law
FAILING = (*POWERS, "late", "exponential-then-singular", "staircase", "seasonal-fail", "driven-fail", "block")
LASTING = ("creep", "seasonal", "stepping", "decelerating", "arrest", "noise", "driven")
FULL = 0.02  # life left at which the displacement of a failing slope is what was drawn
LOST = 10.0  # of that displacement: further on the prism has fallen, the radar lost the face


def log_uniform(rng, low, high):
    return float(numpy.exp(rng.uniform(numpy.log(low), numpy.log(high))))


def grid(failing):
    """Shares of the record at which rates are known: evenly, and where it fails evenly in ln R too."""
    even = numpy.linspace(0, 1, 40001)
    if not failing:
        return even
    return numpy.unique(numpy.concatenate([even[even < 0.9995], 1 - numpy.geomspace(1, 1e-6, 20001)]))


def cumulated(s, rate):
    return numpy.concatenate([[0], numpy.cumsum(numpy.diff(s) * (rate[1:] + rate[:-1]) / 2)])


def wander(rng, s, time):
    """A smooth random curve of unit variance that forgets over `time`: a sum of waves of random phase."""
    frequency = numpy.abs(rng.standard_cauchy(24)).clip(0, 8) / (2 * numpy.pi * time)
    phase = rng.uniform(0, 2 * numpy.pi, 24)
    return sum(numpy.cos(2 * numpy.pi * f * s + p) for f, p in zip(frequency, phase)) * numpy.sqrt(2 / 24)


def exponent(rng):
    """That of the rate on the life left, of Voight's exponent between 1.5 and 2.5."""
    return 1 / (rng.uniform(1.5, 2.5) - 1)


# ---- what comes from outside: shares of a season, rain

def wet_seasons(rng, s, period, low, high):
    """Factors of the rate, 1 in the dry season: each wet one lasts 2 to 3 of 12 months, its own strength and date."""
    factor, first = numpy.ones_like(s), rng.uniform(-1, 0)
    strength = log_uniform(rng, low, high)
    for year in range(int(1 / period) + 3):
        begin = (first + year + rng.uniform(-0.06, 0.06)) * period
        length = rng.uniform(2, 3) / 12 * period
        edge = length * rng.uniform(0.05, 0.25)
        rise = (1 + numpy.tanh((s - begin) / edge)) / 2 * (1 - numpy.tanh((s - begin - length) / edge)) / 2
        factor += max(0.2, strength * rng.uniform(0.6, 1.2) - 1) * rise
    return factor


def harmonics(rng, s, period, low, high):
    """A factor of the rate that goes through its cycle each year, not the same each time."""
    phases, sizes = rng.uniform(0, 2 * numpy.pi, 3), numpy.array([1, rng.uniform(0, 0.5), rng.uniform(0, 0.3)])
    wave = sum(a * numpy.cos(2 * numpy.pi * (k + 1) * s / period + p) for k, (a, p) in enumerate(zip(sizes, phases)))
    swing = numpy.log(log_uniform(rng, low, high)) / 2
    year = 1 + 0.2 * wander(rng, s, period)
    return numpy.exp(swing * wave / numpy.abs(wave).max() * year)


def season(rng, s, of, life):
    """Yearly, or where the record is a week daily and weaker."""
    period = of["season"] / life
    low, high = (1.2, 3) if of["season"] == DAY else (2, 10)
    if rng.random() < 0.5:
        return harmonics(rng, s, period, low, high)
    return wet_seasons(rng, s, period, max(low, 1.5), high)


def rain(rng, s, of, life):
    """Rain in mm in each of the record's steps of the grid, and how full what it drains into is."""
    period = of["season"] / life
    unit = DAY / life if of["season"] == YEAR else 3600 / life  # a storm
    amount = numpy.zeros_like(s)
    wet = 1 + 0.8 * numpy.cos(2 * numpy.pi * s / period + rng.uniform(0, 2 * numpy.pi))
    count = rng.poisson(log_uniform(rng, 30, 120) * max(1.0, 1 / period) if of["season"] == YEAR else rng.poisson(8) + 2)
    begin = rng.choice(s[:-1], size=4 * count, p=(wet[:-1] * numpy.diff(s)) / (wet[:-1] * numpy.diff(s)).sum())[:count]
    for at, size in zip(begin, rng.lognormal(numpy.log(8), 1, count)):
        near = (s >= at) & (s < at + unit * rng.uniform(0.3, 2))
        if near.any():
            amount[near] += size / near.sum()
    tau = log_uniform(rng, 3, 60) * (DAY if of["season"] == YEAR else 3600) / life
    full, level = numpy.zeros_like(s), 0.0
    for k in range(1, len(s)):
        level = level * numpy.exp(-(s[k] - s[k - 1]) / tau) + amount[k]
        full[k] = level
    return amount, full / full.max() if count else full


# ---- motions: (rate over s, drivers) of each kind

def power(rng, s, left, of, life, alpha):
    return left ** (-1 / (alpha - 1)), {}


def late(rng, s, left, of, life):
    """Steady but for the last 10 to 30 % of its life."""
    return (left / rng.uniform(0.1, 0.3)).clip(None, 1) ** -exponent(rng), {}


def exponential(rng, s, left, of, life):
    """Grows by a factor 3 to 50 as an exponential, the last 5 to 25 % of its life as a singularity."""
    width = rng.uniform(0.05, 0.25)
    grown = numpy.log(log_uniform(rng, 3, 50)) * (s / (1 - width)).clip(None, 1)
    return numpy.exp(grown) * (left / width).clip(None, 1) ** -exponent(rng), {}


def staircase(rng, s, left, of, life):
    """Crises, each a quick rise and a relaxation, at intervals that shrink by 15 to 45 % from one to the next."""
    ratio, growth = rng.uniform(0.55, 0.85), exponent(rng) - 1
    rate, at = numpy.zeros_like(s), rng.uniform(0.8, 1)
    while at > 1e-4:
        interval = at * (1 - ratio)
        begin, decay = 1 - at * rng.uniform(0.95, 1.05), interval * rng.uniform(0.1, 0.4)
        since = (s - begin) / decay
        size = at ** -growth * rng.lognormal(0, 0.3)
        rate += numpy.where(since > 0, size / decay * numpy.exp(-since.clip(0, 700)), 0)
        at *= ratio
    return rate, {}


def seasonal_fail(rng, s, left, of, life):
    return left ** -exponent(rng) * season(rng, s, of, life), {}


def driven_fail(rng, s, left, of, life):
    """What the rain adds, up to 1 to 10 times the rate, grows with it."""
    amount, full = rain(rng, s, of, life)
    return left ** -exponent(rng) * (1 + log_uniform(rng, 1, 10) * full), {"rain": amount}


def block(rng, s, left, of, life):
    """One block of rate-and-state friction, aging law: y = theta/theta_ss, y' = (1 - y^(1-m))/T, v ~ y^-m."""
    m, first = rng.uniform(1.1, 2.5), rng.uniform(0.05, 0.97)
    y = numpy.geomspace(1e-7, 1, 40001) * first
    gone = y ** (m - 1) / (1 - y ** (m - 1))  # dR/dy
    remaining = cumulated(y, gone) + y[0] ** m / m
    return numpy.interp(left, remaining / remaining[-1], y) ** -m, {}


def creep(rng, s, left, of, life):
    """Steady, but for slow changes by 2 to 30 %."""
    return numpy.exp(log_uniform(rng, 0.02, 0.3) * wander(rng, s, rng.uniform(0.3, 1))), {}


def seasonal(rng, s, left, of, life):
    return season(rng, s, of, life), {}


def stepping(rng, s, left, of, life):
    """Crises at random times over a steady creep of 5 to 70 %: each a rise and a relaxation over 0.5 to 20 readings."""
    count = 1 + rng.poisson(log_uniform(rng, 2, 20))
    step, rate = of["step"] / life, numpy.zeros_like(s)
    for at, size in zip(rng.uniform(0, 1, count), rng.lognormal(0, 1, count)):
        decay = log_uniform(rng, 0.5, 20) * step
        rise = decay * rng.uniform(0.02, 0.5)
        since = (s - at).clip(0)
        rate += size / (decay - rise) * (numpy.exp(-since / decay) - numpy.exp(-since / rise))
    share = log_uniform(rng, 0.05, 0.7)
    return share + (1 - share) * rate / cumulated(s, rate)[-1], {}


def decelerating(rng, s, left, of, life):
    """Primary creep, v ~ 1/(t + t0); of half of them a second time after an event in the record."""
    rate = 1 / (s + log_uniform(rng, 3e-3, 0.3))
    if rng.random() < 0.5:
        since, start = s - rng.uniform(0.1, 0.7), log_uniform(rng, 3e-3, 0.1)
        rate += numpy.where(since > 0, log_uniform(rng, 0.2, 3) / (since.clip(0) + start), 0)
    return rate, {}


def arrest(rng, s, left, of, life):
    """As towards a failure, until 5 to 30 % of that life are left; then it slows down and stops."""
    remaining, end = log_uniform(rng, 0.05, 0.3), rng.uniform(0.4, 0.8)
    last = end / (1 - remaining)
    p, after, decay = exponent(rng), (s - end).clip(0), log_uniform(rng, 0.01, 0.15)
    rising = (1 - s.clip(None, end) / last) ** -p
    return rising / (1 + after / decay) ** rng.uniform(1, 3), {}


def noise(rng, s, left, of, life):
    return numpy.zeros_like(s), {}


def driven(rng, s, left, of, life):
    """The rain's response, 1 to 20 times a steady creep."""
    amount, full = rain(rng, s, of, life)
    return 1 + log_uniform(rng, 1, 20) * full, {"rain": amount}


MOTIONS = {"late": late, "exponential-then-singular": exponential, "staircase": staircase,
           "seasonal-fail": seasonal_fail, "driven-fail": driven_fail, "block": block, "creep": creep,
           "seasonal": seasonal, "stepping": stepping, "decelerating": decelerating, "arrest": arrest, "noise": noise,
           "driven": driven}


def motion(rng, instrument, kind, life):
    """Shares s, displacement, drivers (cumulated over s), and what was drawn."""
    of, failing = INSTRUMENTS[instrument], kind in FAILING
    s = grid(failing)
    left = (1 - s).clip(1e-6)
    if kind in POWERS:
        rate, drivers = power(rng, s, left, of, life, POWERS[kind])
    else:
        rate, drivers = MOTIONS[kind](rng, s, left, of, life)
    steady, share = numpy.ones_like(s), 0.0
    if instrument == "survey":  # a hill of wet and dry seasons
        steady = wet_seasons(rng, s, YEAR / life, 3, 10)
        if kind == "late":
            rate = rate - 1 + steady
        elif not failing and kind not in ("seasonal", "driven"):
            rate = rate * steady
    way = cumulated(s, rate)
    full = numpy.interp(1 - FULL, s, way) if failing else way[-1]
    total = log_uniform(rng, *of["failing" if failing or kind == "arrest" else "lasting"])
    if full == 0:
        total = 0.0
    else:
        way = way / full
    if failing and kind != "late":  # which has its own
        share = log_uniform(rng, 0.02, 0.5)
        creeping = cumulated(s, steady)
        way = (1 - share) * way + share * creeping / creeping[-1]
    drawn = {"total": total, "creep_share": share}
    return s, total * way, {name: numpy.cumsum(value) for name, value in drivers.items()}, drawn


# ---- instruments: when they read, and how far off

def with_gaps(rng, times, rate, short, long):
    """Without the readings of gaps of random length, `rate` of them in all the record on average."""
    for _ in range(rng.poisson(rate)):
        begin = rng.uniform(times[0], times[-1])
        length = log_uniform(rng, short, long)
        times = times[(times < begin) | (times > begin + length) | (times == times[0])]
    return times


def reading_times(rng, instrument, life):
    years = life / YEAR
    if instrument == "satellite":
        steps = (13 * DAY * numpy.exp(rng.normal(0, 0.45, int(life / (4 * DAY))))).clip(6 * DAY, 30 * DAY)
        return with_gaps(rng, numpy.cumsum(steps) - steps[0], 0.4 * years, 50 * DAY, 150 * DAY)
    if instrument == "prism":
        times = numpy.arange(int(life / DAY) + 1) * DAY + rng.uniform(-3600, 3600, int(life / DAY) + 1)
        return with_gaps(rng, times[rng.random(len(times)) > rng.uniform(0, 0.15)], 1.5 * years, 3 * DAY, 14 * DAY)
    if instrument == "radar":
        times = numpy.arange(0, life, 300.0)
        return with_gaps(rng, times[rng.random(len(times)) > rng.uniform(0, 0.03)], 1.0, 1800, 6 * 3600)
    if instrument == "survey":
        times = numpy.arange(int(life / YEAR * 12) + 1) * YEAR / 12
        return with_gaps(rng, times + rng.uniform(-5, 5, len(times)) * DAY, 0.1 * years, 45 * DAY, 100 * DAY)
    step = 3600.0 * rng.choice([1, 6])
    return with_gaps(rng, numpy.arange(0, life, step), 2 * years, DAY, 10 * DAY)


def autoregressive(rng, times, time):
    """An error of unit variance that forgets over `time`."""
    kept = numpy.exp(-numpy.diff(times) / time)
    drawn, error = rng.normal(size=len(times)), numpy.empty(len(times))
    error[0] = drawn[0]
    for k, keep in enumerate(kept):
        error[k + 1] = keep * error[k] + numpy.sqrt(1 - keep * keep) * drawn[k + 1]
    return error


def satellite_errors(rng, times, sigma):
    bad = rng.random(len(times)) < 0.05
    return sigma * rng.normal(size=len(times)) * numpy.where(bad, 5, 1)


def prism_errors(rng, times, sigma):
    slow = autoregressive(rng, times, log_uniform(rng, 3 * DAY, 30 * DAY))
    return sigma * (rng.normal(size=len(times)) + rng.uniform(0.2, 1) * slow)


def radar_errors(rng, times, sigma):
    air = autoregressive(rng, times, log_uniform(rng, 1800, 2 * 3600))
    return sigma * (rng.normal(size=len(times)) + log_uniform(rng, 0.5, 5) * air)


def survey_errors(rng, times, sigma):
    return sigma * rng.normal(size=len(times))


def extensometer_errors(rng, times, sigma):
    """Noise, and a wire that is longer when it is warm."""
    warm = log_uniform(rng, 1e-5, 5e-4) * numpy.sin(2 * numpy.pi * times / DAY + rng.uniform(0, 2 * numpy.pi))
    return sigma * rng.normal(size=len(times)) + warm


ERRORS = {"satellite": satellite_errors, "prism": prism_errors, "radar": radar_errors, "survey": survey_errors,
          "extensometer": extensometer_errors}


def with_resets(value, span):
    """As a device shows it that is put back to zero when its range is used up, until it breaks; how often."""
    zero, resets, shown = value[0], 0, []
    for k, v in enumerate(value):
        if k > 0 and v - value[k - 1] > span / 2:
            break
        if v - zero > span:
            zero, resets = v, resets + 1
        shown.append(v - zero)
    return numpy.array(shown), resets


def draw(instrument, kind, seed):
    """Readings of one slope: time (s), displacement (m), drivers (sums since the reading before), failure (s) or None."""
    of = INSTRUMENTS[instrument]
    rng = numpy.random.default_rng([zlib.crc32(f"{instrument} {kind}".encode()), seed])
    life = log_uniform(rng, *of["life"])
    s, way, drivers, meta = motion(rng, instrument, kind, life)
    times = reading_times(rng, instrument, life)
    times = times - times[0]
    times = times[times < life]
    true = numpy.interp(times / life, s, way)
    if kind in FAILING:
        kept = numpy.cumsum(true > LOST * meta["total"]) == 0
        times, true = times[kept], true[kept]
    sigma = log_uniform(rng, *of["noise"])
    if instrument == "satellite" and kind in FAILING:
        sigma = meta["total"] * rng.uniform(0.03, 0.05)
    shown = true + ERRORS[instrument](rng, times, sigma)
    meta.update(instrument=instrument, kind=kind, seed=seed, life=life, noise=sigma, resets=0)
    if instrument == "extensometer":
        meta["resolution"] = log_uniform(rng, 5e-5, 5e-4)
        shown = numpy.round(shown / meta["resolution"]) * meta["resolution"]
        span = max(log_uniform(rng, 0.05, 0.5), 40 * meta["resolution"], meta["total"] / 20)
        shown, meta["resets"] = with_resets(shown, span)
        times, true = times[:len(shown)], true[:len(shown)]
    meta["true"] = true
    sums = {name: numpy.diff(numpy.interp(times / life, s, total), prepend=0) for name, total in drivers.items()}
    return {"time": numpy.round(times), "displacement": numpy.round(shown, of["digits"]),
            "drivers": {f"{name}_mm": numpy.round(value, 1) for name, value in sums.items()},
            "failure": life if kind in FAILING else None, "meta": meta}


def csv(slope):
    """The readings as a file's text."""
    digits = INSTRUMENTS[slope["meta"]["instrument"]]["digits"]
    rows = zip(slope["time"], slope["displacement"], *slope["drivers"].values())
    return (",".join(["time_s", "displacement_m", *slope["drivers"]]) + "\n"
            + "".join(f"{row[0]:.0f},{row[1]:.{digits}f}" + "".join(f",{v:.1f}" for v in row[2:]) + "\n"
                      for row in rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("instrument", choices=list(INSTRUMENTS))
    parser.add_argument("kind", choices=[*FAILING, *LASTING])
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    sys.stdout.write(csv(draw(arguments.instrument, arguments.kind, arguments.seed)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
