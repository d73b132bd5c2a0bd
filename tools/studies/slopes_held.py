#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Synthetic slopes of other laws than those of slopes.py, held back from what is tuned on them.

    slopes_held.py INSTRUMENT KIND [--seed 1]        prints one as CSV
    draw(instrument, kind, seed)                     the same in Python

The instruments are those of slopes.py, but they err and pause otherwise: errors have heavier tails and several
memories, gaps are longer and come in winter, wires stick, benchmarks are replaced. Slopes that do not fail have the
names they have there, to be compared, but not the motions; those that fail have other laws and other names. As there,
motions are rates over the share s of the record, R = 1 - s is the life left, the same three arguments give the same
readings, and nothing here knows how anything forecasts.
"""

import argparse
import sys
import zlib

import numpy

from slopes import (DAY, FULL, YEAR, autoregressive, csv, cumulated, grid, log_uniform, rain, reading_times, wander,
                    with_gaps, with_resets)
from slopes import INSTRUMENTS as TUNED

# what differs: shorter and longer records, other sizes
INSTRUMENTS = {
    "satellite": {**TUNED["satellite"], "life": (1.5 * YEAR, 7 * YEAR), "failing": (2.5, 15), "lasting": (0.2, 15)},
    "prism": {**TUNED["prism"], "life": (0.25 * YEAR, 4 * YEAR), "failing": (0.05, 8), "lasting": (5e-3, 4)},
    "radar": {**TUNED["radar"], "life": (4 * DAY, 10 * DAY), "failing": (0.01, 3), "lasting": (1e-3, 0.5)},
    "survey": {**TUNED["survey"], "life": (3 * YEAR, 15 * YEAR), "failing": (0.1, 8), "lasting": (0.03, 4)},
    "extensometer": {**TUNED["extensometer"], "life": (0.15 * YEAR, 2.5 * YEAR), "failing": (0.03, 4),
                     "lasting": (3e-3, 1.5)},
}
VOIGHT = {"voight14": 1.4, "voight18": 1.8, "voight22": 2.2, "voight28": 2.8}
FAILING = (*VOIGHT, "saito", "slip-law", "doubling", "interrupted", "unannounced", "exponential-break", "excavated",
           "melt-fail", "rain-triggered")
LASTING = ("creep", "seasonal", "stepping", "decelerating", "arrest", "noise", "driven")
OWN_CREEP = ("saito", "unannounced", "excavated", "melt-fail", "rain-triggered")  # creep is part of the motion


def exponent(rng):
    """That of the rate on the life left, of Voight's exponent between 1.6 and 2.6."""
    return 1 / (rng.uniform(1.6, 2.6) - 1)


def smooth_step(x):
    return (1 + numpy.tanh(x)) / 2


# ---- what comes each year, or day

def pulses(rng, s, period, first, width, scatter):
    """One each period, the first at `first`: a quick rise and a long decay, of median height 1; some years none."""
    sum_of = numpy.zeros_like(s)
    for year in range(-1, int(1 / period) + 2):
        begin, time = (year + rng.normal(0, 0.03)) * period + first, width * period * rng.uniform(0.7, 1.4)
        since = (s - begin).clip(0) / time
        if rng.random() > 0.08:
            sum_of += rng.lognormal(0, scatter) * since * numpy.exp(1 - since)
    return sum_of


def melt(rng, s, period, strength):
    """Snow melt each spring, and of half the hills weaker rains in autumn."""
    first = rng.uniform(0, 1) * period
    wave, autumn = pulses(rng, s, period, first, rng.uniform(0.02, 0.08), 0.4), first + rng.uniform(0.4, 0.6) * period
    if rng.random() < 0.5:
        wave += rng.uniform(0.2, 0.8) * pulses(rng, s, period, autumn, rng.uniform(0.02, 0.1), 0.6)
    return 1 + (strength - 1) * wave


def lake(rng, s, period, strength):
    """A reservoir at the toe: the rate follows how fast it is drawn down, or how full it is."""
    down, low, up = rng.uniform(0.1, 0.35), rng.uniform(0.05, 0.2), rng.uniform(0.1, 0.35)
    start, at, level = rng.uniform(-1, 0), [], []
    for year in range(int(1 / period) + 3):
        begin, depth = start + year + rng.normal(0, 0.03), rng.uniform(0.5, 1)
        at += [begin, begin + down, begin + down + low, begin + down + low + up]
        level += [1, 1 - depth, 1 - depth, 1]
    height = numpy.interp(s, numpy.array(at) * period, level)
    if rng.random() < 0.5:
        drop = (-numpy.gradient(height, s)).clip(0) * down * period
        return 1 + (strength - 1) * numpy.interp(s - rng.uniform(0.01, 0.08) * period, s, drop)
    return strength ** height


def saw(rng, s, period, strength):
    """Rises within a tenth to a half of the period and falls in the rest, or in a day of sun the reverse."""
    rise, phase = rng.uniform(0.1, 0.5), (s / period + rng.uniform(0, 1)) % 1
    if rng.random() < 0.5:
        phase = 1 - phase
    wave = numpy.where(phase < rise, phase / rise, (1 - phase) / (1 - rise))
    return strength ** (wave * (1 + 0.25 * wander(rng, s, 1.5 * period)).clip(0.2))


def season(rng, s, of, life):
    period, daily = of["season"] / life, of["season"] == DAY
    strength = log_uniform(rng, 1.15, 4) if daily else log_uniform(rng, 1.5, 15)
    shape = saw if daily else (melt, lake, saw)[rng.integers(3)]
    return shape(rng, s, period, strength)


# ---- motions that fail: (rate over s, drivers)

def voight(rng, s, left, of, life, alpha):
    """A singularity, its rate wandering by 2 to 15 %."""
    return left ** (-1 / (alpha - 1)) * numpy.exp(log_uniform(rng, 0.02, 0.15) * wander(rng, s, 0.1)), {}


def saito(rng, s, left, of, life):
    """Primary creep that decays, a secondary one at its least rate, a tertiary one as 1/R in the last 8 to 60 %."""
    begin = rng.uniform(0.08, 0.6)
    primary = log_uniform(rng, 1, 20) / (1 + s / log_uniform(rng, 0.005, 0.1)) ** rng.uniform(0.7, 1.3)
    return primary + 1 + (begin / left - 1).clip(0), {}


def slip_law(rng, s, left, of, life):
    """One block of rate-and-state friction, slip law: y = theta/theta_ss, y' = (m-1) y^(1-m) ln y, v ~ y^-m."""
    m, first = rng.uniform(1.2, 5), rng.uniform(0.3, 0.99)
    y = numpy.geomspace(1e-8 ** (1 / m), 1, 40001) * first
    remaining = cumulated(y, y ** (m - 1) / -numpy.log(y))
    remaining += y[0] ** m / -m / numpy.log(y[0])
    return numpy.interp(left, remaining / remaining[-1], y) ** -m, {}


def doubling(rng, s, left, of, life):
    """Steady for a while, then for a shorter one at about twice the rate, and again; each 0.4 to 0.75 of the last."""
    ratio, at, rate, total = rng.uniform(0.4, 0.75), rng.uniform(0.5, 0.95), numpy.ones_like(s), 1.0
    while at > 1e-5:
        more = total * (rng.uniform(1.8, 2.2) - 1)
        rate += more * smooth_step((s - 1 + at) / (at * (1 - ratio) * rng.uniform(0.02, 0.2)))
        total, at = total + more, at * ratio * rng.uniform(0.9, 1.1)
    return rate, {}


def interrupted(rng, s, left, of, life):
    """Accelerates, stops once or twice at all but 0 to 20 % of its rate, and goes on where it was or slower."""
    rate, at = left ** -exponent(rng), log_uniform(rng, 0.05, 0.4)
    for _ in range(rng.integers(1, 3)):
        length, kept = rng.uniform(0.2, 0.5) * at, rng.uniform(0, 0.2)
        edge = length * rng.uniform(0.03, 0.15)
        stopped = smooth_step((s - 1 + at) / edge) * smooth_step((1 - at + length - s) / edge)
        rate = rate * (1 - (1 - kept) * stopped)
        rate = numpy.where(s > 1 - at + length / 2, rng.uniform(0.5, 1), 1) * rate
        at = (at - length) * rng.uniform(0.2, 0.6)
    return rate, {}


def unannounced(rng, s, left, of, life):
    """Creep that wanders and grows by at most three times, and goes within its last 0.1 to 2 %."""
    grown = numpy.exp(rng.uniform(0, 1.1) * s ** rng.uniform(1, 6) + 0.15 * wander(rng, s, rng.uniform(0.1, 0.5)))
    return grown * (left / log_uniform(rng, 1e-3, 2e-2)).clip(None, 1) ** -exponent(rng), {}


def exponential_break(rng, s, left, of, life):
    """Grows by a factor 10 to 3000 as an exponential and breaks off at a finite rate."""
    return numpy.exp(numpy.log(log_uniform(rng, 10, 3000)) * s ** rng.uniform(0.9, 1.5)), {}


def excavated(rng, s, left, of, life):
    """Cut back step by step: it answers each cut, the more the later, and calms down, but not after the last one."""
    last = log_uniform(rng, 0.03, 0.25)
    cuts = numpy.sort(rng.uniform(0, 1 - 1.2 * last, rng.integers(2, 9)))
    rate, growth = numpy.ones_like(s), rng.uniform(1.05, 1.5)
    for number, cut in enumerate(cuts):
        decay = log_uniform(rng, 0.01, 0.1)
        answer = log_uniform(rng, 2, 10) * growth ** number * numpy.exp(-(s - cut).clip(0) / decay)
        rate += numpy.where(s > cut, answer, 0)
    quick = log_uniform(rng, 1.5, 6) * (left / last).clip(None, 1) ** -exponent(rng)
    return rate + numpy.where(left < last, quick, 0), {}


def melt_fail(rng, s, left, of, life):
    """More with each melt by 1 to 60 %, until it fails in the days or months after one has begun."""
    period = of["season"] / life
    last = min(0.5, period * log_uniform(rng, 0.05, 0.4))
    wave = pulses(rng, s, period, (1 - last) % period, rng.uniform(0.03, 0.08), 0.4)
    rate = (1 + log_uniform(rng, 2, 12) * wave) * rng.uniform(1.01, 1.6) ** (s / period).clip(None, 8)
    return rate * (left / last).clip(None, 1) ** -exponent(rng), {}


def rain_triggered(rng, s, left, of, life):
    """Creep that rain drives, and a storm from which it does not recover, 0.5 to 12 % before its end."""
    amount, full = rain(rng, s, of, life)
    last = log_uniform(rng, 5e-3, 0.12)
    unit = DAY / life if of["season"] == YEAR else 3600 / life
    near = (s >= 1 - last) & (s < 1 - last + min(unit * rng.uniform(1, 3), last / 2))
    amount[near] += rng.uniform(40, 200) / near.sum()
    rate = 1 + log_uniform(rng, 0.5, 8) * full ** rng.uniform(1, 2)
    jump = 1 + rng.uniform(0, 4) * smooth_step((s - 1 + last) / (0.1 * last))
    return rate * jump * (left / last).clip(None, 1) ** -exponent(rng), {"rain": amount}


# ---- motions that do not

def creep(rng, s, left, of, life):
    """Steady, but for a trend to half or twice the rate, slow wander and quick one."""
    slow = log_uniform(rng, 0.03, 0.35) * wander(rng, s, rng.uniform(0.1, 0.6))
    quick = log_uniform(rng, 0.02, 0.3) * wander(rng, s, rng.uniform(0.005, 0.05))
    return numpy.exp(rng.normal(0, 0.3) * s + slow + quick), {}


def seasonal(rng, s, left, of, life):
    return season(rng, s, of, life) * numpy.exp(0.1 * wander(rng, s, 0.5)), {}


def stepping(rng, s, left, of, life):
    """Stick-slip at intervals alike, or crises that come in clusters, of sizes with a heavy tail."""
    step = of["step"] / life
    if rng.random() < 0.5:
        count = int(log_uniform(rng, 3, 25))
        begin = (numpy.arange(count) + rng.normal(0, 0.15, count) + rng.uniform(0, 1)) / count
        size = rng.lognormal(0, 0.3, count)
    else:
        heads = rng.uniform(0, 1, 1 + rng.poisson(3))
        begin = numpy.concatenate([at + numpy.append(0, rng.exponential(0.03, rng.poisson(3))) for at in heads])
        size = (1 + rng.pareto(1.3, len(begin))).clip(None, 30)
    rate = numpy.zeros_like(s)
    for at, much in zip(begin, size):
        width = min(0.05, log_uniform(rng, 0.3, 10) * step)
        since = ((s - at) / width).clip(-30)
        bump, tail = numpy.exp(-0.5 * since ** 2), (since > 0) / (1 + since.clip(0)) ** 1.3
        rate += much / width * (bump if rng.random() < 0.5 else tail)
    share = log_uniform(rng, 0.03, 0.6)
    way = cumulated(s, rate)[-1]
    return share + (1 - share) * rate / way if way > 0 else numpy.ones_like(s), {}


def decelerating(rng, s, left, of, life):
    """After one to four excavations, each time as an exponential or a power, towards creep or to rest."""
    rate = numpy.full_like(s, rng.choice([0, log_uniform(rng, 0.01, 0.3)]))
    for at in [rng.uniform(-0.02, 0.15), *rng.uniform(0, 0.8, rng.integers(0, 4))]:
        since, time, size = (s - at).clip(0), log_uniform(rng, 0.01, 0.3), log_uniform(rng, 0.2, 3)
        kind = numpy.exp(-since / time) if rng.random() < 0.5 else (1 + since / time) ** -rng.uniform(0.7, 2)
        rate += size * smooth_step((s - at) / log_uniform(rng, 1e-3, 2e-2)) * kind
    return rate, {}


def arrest(rng, s, left, of, life):
    """Accelerates by a singular law or an exponential, keeps its rate or not, calms down; of a third, twice."""
    rate = numpy.full_like(s, rng.uniform(0, 0.05))
    begin, end = 0.0, rng.uniform(0.3, 0.8)
    ends = [end * rng.uniform(0.3, 0.6), end] if rng.random() < 1 / 3 else [end]
    for end in ends:
        share = ((s - begin) / (end - begin)).clip(0, 1)
        if rng.random() < 0.6:
            remaining = log_uniform(rng, 0.02, 0.4)
            rising = ((1 - share * (1 - remaining)) / remaining) ** -exponent(rng)
        else:
            rising = log_uniform(rng, 5, 200) ** (share - 1)
        after = (s - end - rng.choice([0, log_uniform(rng, 5e-3, 0.05)])).clip(0)
        decay = log_uniform(rng, 0.003, 0.08)
        falling = numpy.exp(-after / decay) if rng.random() < 0.5 else (1 + after / decay) ** -rng.uniform(1, 3)
        rate += log_uniform(rng, 0.3, 1) * rising * falling * (s >= begin)
        begin = end
    return rate, {}


def noise(rng, s, left, of, life):
    return numpy.zeros_like(s), {}


def driven(rng, s, left, of, life):
    """Answers to rain late, and to much of it only, or more than in proportion."""
    amount, full = rain(rng, s, of, life)
    late = numpy.interp(s - log_uniform(rng, 1e-4, 0.03), s, full)
    threshold = rng.choice([0, rng.uniform(0.1, 0.5)])
    return 1 + log_uniform(rng, 1, 30) * ((late - threshold).clip(0) / (1 - threshold)) ** rng.uniform(0.7, 2), \
        {"rain": amount}


MOTIONS = {"saito": saito, "slip-law": slip_law, "doubling": doubling, "interrupted": interrupted,
           "unannounced": unannounced, "exponential-break": exponential_break, "excavated": excavated,
           "melt-fail": melt_fail, "rain-triggered": rain_triggered, "creep": creep, "seasonal": seasonal,
           "stepping": stepping, "decelerating": decelerating, "arrest": arrest, "noise": noise, "driven": driven}


def motion(rng, instrument, kind, life):
    """Shares s, displacement, drivers (cumulated over s), and what was drawn."""
    of, failing = INSTRUMENTS[instrument], kind in FAILING
    s = grid(failing)
    left = (1 - s).clip(1e-6)
    if kind in VOIGHT:
        rate, drivers = voight(rng, s, left, of, life, VOIGHT[kind])
    else:
        rate, drivers = MOTIONS[kind](rng, s, left, of, life)
    steady, share = numpy.exp(0.1 * wander(rng, s, 0.2)), 0.0
    if instrument == "survey":  # a hill of seasons; they act on all of it, on some that fail only on their creep
        steady = season(rng, s, of, life)
        if kind not in ("seasonal", "melt-fail", "driven") and (not failing or rng.random() < 0.5):
            rate = rate * steady
    way = cumulated(s, rate)
    full = numpy.interp(1 - FULL, s, way) if failing else way[-1]
    total = log_uniform(rng, *of["failing" if failing or kind == "arrest" else "lasting"]) if full > 0 else 0.0
    way = way / (full or 1)
    if failing and kind not in OWN_CREEP:
        share = log_uniform(rng, 0.01, 0.6)
        creeping = cumulated(s, steady)
        way = (1 - share) * way + share * creeping / creeping[-1]
    return s, total * way, {name: numpy.cumsum(value) for name, value in drivers.items()}, \
        {"total": total, "creep_share": share}


# ---- instruments: when they read, and how far off

def pauses(rng, instrument, times, life):
    """Without the readings of longer gaps, and of winters where there are some."""
    short, long = {"satellite": (60 * DAY, 240 * DAY), "prism": (7 * DAY, 60 * DAY), "radar": (2 * 3600, 24 * 3600),
                   "survey": (60 * DAY, 240 * DAY), "extensometer": (2 * DAY, 40 * DAY)}[instrument]
    times = with_gaps(rng, times, min(2.0, 0.1 * life / short), short, min(long, 0.2 * life))
    if instrument in ("satellite", "survey") and rng.random() < 0.4:
        year = (times / YEAR - rng.uniform(0.1, 0.6)) % 1
        times = times[(year >= rng.uniform(0.15, 0.35)) | (times == times[0])]
    if rng.random() < 0.3:  # a month, or day, when every other reading fails
        begin, length = rng.uniform(0, life), rng.uniform(0.05, 0.2) * life
        bad = (times > begin) & (times < begin + length) & (rng.random(len(times)) < 0.6)
        times = times[~bad | (times == times[0])]
    return times


def cycle(rng, times, period):
    return numpy.sqrt(2) * numpy.sin(2 * numpy.pi * times / period + rng.uniform(0, 2 * numpy.pi))


def errors(rng, instrument, times, sigma):
    count = len(times)
    degrees = rng.uniform(3, 8)  # of freedom
    error = rng.standard_t(degrees, count) * numpy.sqrt((degrees - 2) / degrees)
    if instrument == "satellite":  # bad orthorectification, and the sun's height
        error = error * numpy.where(rng.random(count) < rng.uniform(0, 0.08), 4, 1)
        error += rng.uniform(0, 0.6) * cycle(rng, times, YEAR)
    elif instrument == "prism":  # weather, the season's refraction
        error += rng.uniform(0.2, 1) * autoregressive(rng, times, log_uniform(rng, 2 * DAY, 10 * DAY))
        error += rng.uniform(0.1, 1) * cycle(rng, times, YEAR)
    elif instrument == "radar":  # air of this hour and of the day
        error += log_uniform(rng, 0.5, 3) * autoregressive(rng, times, log_uniform(rng, 900, 3600))
        error += log_uniform(rng, 0.3, 4) * autoregressive(rng, times, log_uniform(rng, 4 * 3600, DAY))
        error += rng.uniform(0, 2) * cycle(rng, times, DAY)
    elif instrument == "survey":  # a benchmark replaced, of a quarter
        if rng.random() < 0.25:
            error += rng.normal(0, 2) * (times > rng.uniform(0, times[-1]))
    else:  # of the wire in the sun, and in summer
        error += (log_uniform(rng, 1e-5, 3e-4) * cycle(rng, times, DAY) * (1 + 0.4 * rng.normal(size=count))
                  + log_uniform(rng, 2e-5, 1e-3) * cycle(rng, times, YEAR)) / sigma
    return sigma * error


def sticking(value, friction):
    """As a wire shows it that follows only once it is pulled by more than friction."""
    shown, last = numpy.empty(len(value)), value[0]
    for k, v in enumerate(value):
        last = min(max(last, v - friction), v + friction)
        shown[k] = last
    return shown


def draw(instrument, kind, seed):
    """Readings of one slope, as slopes.draw returns them."""
    of, failing = INSTRUMENTS[instrument], kind in FAILING
    rng = numpy.random.default_rng([zlib.crc32(f"held {instrument} {kind}".encode()), seed])
    life = log_uniform(rng, *of["life"])
    s, way, drivers, meta = motion(rng, instrument, kind, life)
    times = reading_times(rng, instrument, life)
    times = times - times[0]
    times = pauses(rng, instrument, times[times < life], life)
    true = numpy.interp(times / life, s, way)
    if failing:  # until it has gone too far to be seen
        kept = numpy.cumsum(true > log_uniform(rng, 2, 20) * meta["total"]) == 0
        times, true = times[kept], true[kept]
    sigma = log_uniform(rng, *of["noise"])
    if instrument == "satellite" and failing:
        sigma = meta["total"] * log_uniform(rng, 0.02, 0.07)
    shown = true + errors(rng, instrument, times, sigma)
    meta.update(instrument=instrument, kind=kind, seed=seed, life=life, noise=sigma, resets=0)
    if instrument == "extensometer":
        meta["resolution"] = log_uniform(rng, 2e-5, 1e-3)
        shown = sticking(shown, rng.choice([0, log_uniform(rng, 5e-5, 1e-3)]))
        shown = numpy.round(shown / meta["resolution"]) * meta["resolution"]
        whole = numpy.diff(shown[times < 0.9 * life] if failing else shown)  # when it does not break
        span = max(log_uniform(rng, 0.03, 0.4), 40 * meta["resolution"], meta["total"] / 15, 2.2 * whole.max(initial=0))
        shown, meta["resets"] = with_resets(shown, span)
        times, true = times[:len(shown)], true[:len(shown)]
    meta["true"] = true
    sums = {name: numpy.diff(numpy.interp(times / life, s, total), prepend=0) for name, total in drivers.items()}
    return {"time": numpy.round(times), "displacement": numpy.round(shown, of["digits"]),
            "drivers": {f"{name}_mm": numpy.round(value, 1) for name, value in sums.items()},
            "failure": life if failing else None, "meta": meta}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("instrument", choices=list(INSTRUMENTS))
    parser.add_argument("kind", choices=[*FAILING, *LASTING])
    parser.add_argument("--seed", type=int, default=1)
    sys.stdout.write(csv(draw(**vars(parser.parse_args()))))


if __name__ == "__main__":
    main()
