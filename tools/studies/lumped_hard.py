# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes drawn to break the error that lumping states, for lumped.py --hard SEED: cells start at rates up to three e-folds apart, and
below or above their steady state; parameters are spread as wide as a case may; loads step or set in late; k_0/k_crit is 3 to 500.
"""

import math
import random

YEAR = 365.25 * 86400


def log_uniform(draw, low, high):
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def seed_of(draw):
    return draw.randrange(10**6)


def lognormal(draw, low, high, digits=3):
    return f"{{lognormal: {{sigma: {draw.uniform(low, high):.{digits}f}, seed: {seed_of(draw)}}}}}"


def half_width(draw):
    return f"{{uniform: {{half_width: {draw.uniform(.05, .4):.3f}, seed: {seed_of(draw)}}}}}"


def wide(draw):
    seed, size = seed_of(draw), draw.uniform(0.3, 1)
    return draw.choice([f"{{lognormal: {{sigma: {size:.3f}, seed: {seed}}}}}"] * 2 +
                       [f"{{uniform: {{half_width: {min(1.5 * size, .95):.3f}, seed: {seed}}}}}",
                        f"{{weibull: {{shape: {max(1.2 / size, 1.1):.3f}, seed: {seed}}}}}"])


def interface(draw, line, levels, fractal):
    domain = f"cascade: {{dimension: {draw.uniform(1.5, 1.9):.3f}, seed: {seed_of(draw)}}}" if fractal else "full: {}"
    return f'interface: {{size: 100 m, levels: {levels}, shape: {"line" if line else "plane"}, domain: {{{domain}}}'


def loads(draw, pressure, end):
    kind = draw.choice(["none", "none", "ramp", "step", "sine", "spring"])
    shear = {"none": "", "ramp": f"ramp: {{rate: {draw.uniform(.002, .05) * pressure / end:.4g} Pa/s}}",
             "step": f"step: {{value: {draw.uniform(-.02, .02) * pressure:.4g} Pa, at: {draw.uniform(.05, .9) * end:.4g} s}}",
             "sine": f"sine: {{amplitude: {draw.uniform(.001, .02) * pressure:.4g} Pa, period: {draw.uniform(.05, .8) * end:.4g} s}}",
             "spring": f"spring: {{stiffness: {log_uniform(draw, 1e-4, 1e-2) * pressure:.4g} Pa/m, "
                       f"speed: {log_uniform(draw, 1e-9, 1e-7):.4g} m/s}}"}[kind]
    kind, at = draw.choice(["none", "step", "ramp", "late", "two", "sine", "constant"]), draw.uniform(.2, .9) * end
    water = {"none": "", "constant": f"constant: {{value: {draw.uniform(.05, .6) * pressure:.4g} Pa}}",
             "step": f"step: {{value: {draw.uniform(.005, .06) * pressure:.4g} Pa, at: {at:.4g} s}}",
             "ramp": f"ramp: {{rate: {draw.uniform(.02, .3) * pressure / end:.4g} Pa/s}}",
             "late": f"ramp: {{rate: {draw.uniform(.05, .6) * pressure / end:.4g} Pa/s, start: {at:.4g} s}}",
             "two": f"constant: {{value: {draw.uniform(.1, .4) * pressure:.4g} Pa}}}}, "
                    f"{{step: {{value: {draw.uniform(-.03, .06) * pressure:.4g} Pa, at: {at:.4g} s}}",
             "sine": f"sine: {{amplitude: {draw.uniform(.002, .04) * pressure:.4g} Pa, period: {draw.uniform(.1, 1) * end:.4g} s}}"}[kind]
    return (f"load: {{normal: {{pressure: {pressure:.5g} Pa}}" + (f", shear: [{{{shear}}}]" if shear else "") +
            (f", pore_pressure: [{{{water}}}]" if water else "") + "}\n")


def friction(draw, a, b, dc):
    law = draw.choice(["aging", "aging", "slip", "composite", "weakening"])
    cut_off = f", vc: {log_uniform(draw, 1e-11, 1e-8):.3g} m/s" if law == "composite" else ""
    f0, spreads = draw.uniform(.3, .7), []
    if draw.random() < .9:
        spreads.append(f"dc: {wide(draw)}")
    if draw.random() < .5:
        spreads.append(f"f0: {{normal: {{sigma: {draw.uniform(.005, .04):.4f}, seed: {seed_of(draw)}}}}}")
    spreads += [f"{name}: {half_width(draw)}" for name in "ab" if draw.random() < .35]
    form = draw.choice(["plain", "regularised"])
    return (f"friction: {{{law}: {{f0: {f0:.3f}, a: {a:.4g}, b: {b:.4g}, dc: {dc:.4g} m, v0: 1 um/s, form: {form}{cut_off}}}" +
            (", spread: {" + ", ".join(spreads) + "}" if spreads else "") + "}\n")


def initial(draw):
    state, spreads = draw.choice([draw.uniform(.2, .95), draw.uniform(.2, .95), draw.uniform(.95, 3)]), []
    if draw.random() < .75:
        spreads.append(f"slip_rate: {lognormal(draw, .5, 3)}")
    if draw.random() < .4:
        spreads.append(f"state: {lognormal(draw, .1, 1.2)}")
    return (f"initial: {{slip_rate: {log_uniform(draw, 1e-10, 1e-6):.4g} m/s, state: {{ratio_to_steady: {state:.3f}}}" +
            (", spread: {" + ", ".join(spreads) + "}" if spreads else "") + "}\n")


def scene(seed, number):
    """The text of a case, and its k_0/k_crit."""
    draw = random.Random(f"attack {seed} {number}")
    pressure, a = log_uniform(draw, 3e5, 3e7), draw.uniform(.006, .02)
    b, dc = a * draw.uniform(1.1, 2.2), log_uniform(draw, 1e-4, .1)
    line = draw.random() < .15
    levels = draw.randrange(7, 9) if line else draw.choice([3, 4, 4, 5])
    stiff = log_uniform(draw, 3, 500)
    fractal = not line and levels == 5 and draw.random() < .4
    k0 = stiff * pressure * (b - a) / dc * (2 if fractal else 1)
    text = "lacuna: 1\n" + interface(draw, line, levels, fractal)
    end = draw.uniform(.3, 3) * YEAR
    text += f", spread: {{pressure: {lognormal(draw, .1, .8)}}}}}\n" if draw.random() < .35 else "}\n"
    text += "material: {shear_modulus: 10 GPa, poisson: 0.25, density: 2500 kg/m3}\n" if draw.random() < .5 else ""
    text += loads(draw, pressure, end)
    text += friction(draw, a, b, dc) + initial(draw)
    text += f"transfer: {{hierarchy: {{k0: {k0:.5g}, ratio: {draw.choice([.5, .5, .3, .7, .85])}}}}}\n"
    stop = f", stop_when: {{mean_slip: {log_uniform(draw, .1, 3) * dc:.4g} m}}" if draw.random() < .15 else ""
    return text + f"time: {{end: {end:.5g} s{stop}}}\noutput: {{every: {{steps: 100000}}}}\n", stiff
