# SPDX-License-Identifier: GPL-3.0-or-later
"""Small random scenes for studies: any law, transfer and load, as a case and the files that it reads."""
import math

def pick(rng, *of):
    return of[rng.randrange(len(of))]

def log(rng, low, high):
    return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.4g}")

def text(value, unit):
    return f"{value:.6g} {unit}"

def draw(rng):
    """A scene as a case, and the files it reads: any law, transfer and load, small."""
    law = pick(rng, "aging", "aging", "aging", "slip", "composite", "weakening")
    kind = pick(rng, "block", "block", "hierarchy", "hierarchy", "hierarchy", "elastic", "elastic", "elastic", "line",
                "none")
    a = log(rng, 0.004, 0.02)
    m = pick(rng, rng.uniform(0.5, 0.95), rng.uniform(1.1, 2.5), rng.uniform(1.1, 2.5))  # b/a
    dc, p, v = log(rng, 1e-5, 1e-2), log(rng, 2e5, 2e7), log(rng, 1e-10, 1e-6)
    b = a * m
    friction = {"f0": 0.6, "a": a, "b": float(f"{b:.4g}"), "dc": text(dc, "m"), "v0": "1 um/s"}
    if rng.random() < 0.4:
        friction["form"] = "regularised"
    case = {"lacuna": 1, "title": f"{kind}, {law}", "load": {"normal": {"pressure": text(p, "Pa")}}, "friction": {law: friction}}
    if law == "composite":
        friction["vc"] = text(log(rng, 0.01 * v, v), "m/s")
    case["material"] = {"shear_modulus": "20 GPa", "poisson": 0.25, "shear_speed": "3 km/s"}
    ratio = rng.uniform(0.3, 0.95) if rng.random() < 0.7 else rng.uniform(1.0, 3.0)
    if law == "weakening":
        ratio = rng.uniform(0.4, 0.95) if rng.random() < 0.5 else rng.uniform(1.1, 3.0)
    case["initial"] = {"slip_rate": text(v, "m/s"), "state": {"ratio_to_steady": round(ratio, 3)}}
    # the time that a block would take to fail, or to settle
    span = dc / v * rng.uniform(5, 60)
    files = {}
    if kind != "block":
        spread(rng, case, dc)
        joint(rng, case, kind, p * abs(b - a) / dc)
    loads(rng, case, files, kind, span, {"a": a, "p": p, "v": v, "k": p * abs(b - a) / dc})
    case["time"] = {"end": text(span, "s")}
    if rng.random() < 0.15:
        case["time"]["stop_when"] = {"mean_slip": text(dc * rng.uniform(1, 5), "m")}
    if kind == "block" and rng.random() < 0.2:
        case["material"] = {"density": "2500 kg/m3"}
        case["inertia"] = {"thickness": text(log(rng, 5, 200), "m")}
    case["output"] = {"file": "run.nc", "every": {"per_decade": 20}}
    return case, files

def spread(rng, case, dc):
    case["initial"]["spread"] = {"slip_rate": {"lognormal": {"sigma": round(rng.uniform(0.1, 1.0), 2), "seed": rng.randrange(1000)}}}
    if rng.random() < 0.6:
        case["friction"]["spread"] = {"dc": {"lognormal": {"sigma": round(rng.uniform(0.1, 0.6), 2), "seed": rng.randrange(1000)}}}

def joint(rng, case, kind, critical):
    """Where cells touch and how they hold each other: k_0 a multiple of k_crit."""
    levels = rng.randrange(2, 6 if kind == "hierarchy" else 5)
    held = log(rng, 2, 2000)
    stiffness = held * critical
    size = 20e9 / stiffness * 2**levels  # k_0 is some G over the side of a cell
    domain = {"full": {}} if rng.random() < 0.4 else {"cascade": {"dimension": round(rng.uniform(1.4, 1.9), 2), "seed": rng.randrange(1000)}}
    case["interface"] = {"size": text(size, "m"), "levels": levels, "domain": domain}
    if kind == "line" or (kind == "hierarchy" and rng.random() < 0.2):
        case["interface"] = {"size": text(size, "m"), "shape": "line", "levels": levels + 2, "domain": {"full": {}}}
    if kind == "hierarchy":
        case["transfer"] = {"hierarchy": pick(rng, {"stiffness": "elastic"}, {"k0": text(stiffness, "Pa/m"), "ratio": round(rng.uniform(0.2, 0.7), 2)})}
    elif kind == "none":
        case["transfer"] = {"none": {}}
    else:
        own = {} if rng.random() < 0.6 else {"thickness": text(size * rng.uniform(0.3, 2), "m")}
        if kind == "line" and own:
            own["mode"] = pick(rng, "antiplane", "inplane")
        elif kind == "elastic" and not own and rng.random() < 0.3:
            case["interface"]["boundary"] = "free"
        case["transfer"] = {"elastic": own}

def loads(rng, case, files, kind, span, scale):
    """None, or some: drives over stretches of the time span, waves, jumps, readings with many breaks."""
    a, p, v = scale["a"], scale["p"], scale["v"]
    shear, pore = [], []
    what = pick(rng, "none", "none", "ramp", "step", "sine", "readings", "readings", "spring", "mixed")
    if what in ("ramp", "mixed"):
        shear.append({"ramp": {"rate": text(a * p * rng.uniform(-0.5, 3) / span, "Pa/s")}})
    if what in ("step", "mixed"):
        pore.append({"step": {"value": text(a * p * rng.uniform(0.1, 1), "Pa"), "at": text(span * rng.uniform(0.05, 0.6), "s")}})
    if what in ("sine", "mixed"):
        pore.append({"sine": {"amplitude": text(a * p * log(rng, 0.03, 0.5), "Pa"), "period": text(span / log(rng, 3, 200), "s")}})
    if what == "readings":
        n = int(log(rng, 30, 1500))
        level = a * p * log(rng, 0.05, 1)
        rows = [f"{i * span / n:.9g},{level * rng.random():.6g}" for i in range(n + 1)]
        files["p.csv"] = "t,p\n" + "\n".join(rows) + "\n"
        pore.append({"series": {"file": "p.csv", "time": "t", "value": "p:Pa", "outside": "hold"}})
    if what == "spring":
        drive = v * log(rng, 0.3, 30)
        if "elastic" in case.get("transfer", {}) and case["transfer"]["elastic"]:
            shear.append({"back-slip": {"rate": text(drive, "m/s")}})
        else:
            shear.append({"spring": {"stiffness": text(scale["k"] * log(rng, 0.1, 3), "Pa/m"), "speed": text(drive, "m/s")}})
    if shear:
        case["load"]["shear"] = shear
    if pore:
        case["load"]["pore_pressure"] = pore
