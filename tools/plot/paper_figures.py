# SPDX-License-Identifier: GPL-3.0-or-later
"""Fig. 1 to 4 of Borri-Brunetto, Carpinteri and Chiaia (2004) from what `lacuna` computes; part of lacuna_plot.py.

Fig. 1 and 3 are of figure1.py and figure3.py. docs/paper-figures.md tells what agrees with the paper and what does not.
"""

import os
import subprocess
import sys
import tempfile

from figures import BLUE, GREEN, INK, QUIET, RED, ROOT, SLIP, WIDTH, json_of, np, open_file, panel, plain_ticks, plt, save, stop
from matplotlib.colors import ListedColormap

PRESSURES = (2, 5, 10)  # of Fig. 2 [MPa]
MORE_PRESSURES = (1, 2, 5, 10, 20, 50, 100)
# A specimen as of Fig. 2: faces of sandstone that fit in waves from 2 cm on.
SPECIMEN = ("interface.size=0.1 m", "material.shear_modulus=8 GPa",
            "interface.surface={joint: {hurst: 0.8, rms_height: 40 um, mating: 20 mm, seed: 1}}")
SIDES = (0.05, 0.1, 0.2, 0.4)  # of the specimens of Fig. 4 [m]
SETS = (("b", "first", 0.77), ("c", "second", 0.61))  # of Bandis et al.; the Hurst exponent 1 - x of their exponent x
COLOURS = (INK, BLUE, GREEN, RED)
STYLES = ("-", (0, (6, 2)), (0, (2, 1)), (0, (6, 2, 1, 2)))


def settings(*pairs):
    return [word for pair in pairs for word in ("--set", pair)]


def case(name):
    return os.path.join(ROOT, "cases", name)


# --- Fig. 2


def press(program, levels, mega, folder):
    """A specimen under a mean pressure: what is printed, and where it touches."""
    path = os.path.join(folder, "pressed.nc")
    found = json_of(program, "contact", case("contact/joint.yaml"), "-o", path, "--force", "--coarsest", str(min(64, 2 ** (levels - 3))),
                    *settings(*SPECIMEN, f"interface.levels={levels}", f"load.normal.pressure={mega} MPa"))
    with open_file(path, "pressure") as data:
        return found, data["pressure"].values > 0


def figure2(program, levels, folder):
    """Contact domains under three mean pressures, their dimensions, and what follows for larger specimens."""
    figure, axes = plt.subplots(2, 3, figsize=(WIDTH, 4.9), layout="constrained", height_ratios=(1.15, 1))
    rows = {}
    for mega in MORE_PRESSURES:
        rows[mega], touches = press(program, levels, mega, folder)
        if mega in PRESSURES:
            k = PRESSURES.index(mega)
            draw_domain(axes[0][k], touches, rows[mega], "abc"[k], mega)
    axes[0][0].set_ylabel("y (cm)")
    draw_dimensions(axes[1][0], rows)
    draw_tilt(axes[1][1], rows)
    draw_strength(axes[1][2], rows)
    return figure


def draw_domain(ax, touches, found, letter, mega):
    side = 100 * found["cell_size_m"] * touches.shape[1]
    ax.imshow(touches, origin="lower", extent=(0, side, 0, side), cmap=ListedColormap(["white", INK]), interpolation="nearest",
              rasterized=True)
    ax.spines[["top", "right"]].set_visible(True)
    panel(ax, letter, f"{mega} MPa, $D$ = {found['d_box']:.2f} ± {found['d_box_error']:.2f}")
    ax.set_xlabel("x (cm)")
    ax.tick_params(labelleft=letter == "a")


def draw_dimensions(ax, rows):
    loads = [mega for mega in rows if rows[mega]["delta_s"] is not None]
    for key, colour, mark, name in (("d_box", INK, "o", "$D$, boxes"), ("delta_s", BLUE, "s", "$\\Delta_S$, area")):
        ax.errorbar(loads, [rows[m][key] for m in loads], [rows[m][key + "_error"] for m in loads], color=colour, marker=mark, ms=3.5,
                    capsize=2, elinewidth=0.7, label=name)
    ax.set(xscale="log", xlabel="mean pressure (MPa)", ylabel="dimension", xticks=[1, 10, 100], xticklabels=["1", "10", "100"])
    ax.legend(loc="upper left")
    panel(ax, "d", "the denser, the nearer to 2")


def draw_tilt(ax, rows):
    """Angle at which specimens tilt off, that of 10 cm at 40 degrees: eq. 3 of the paper."""
    side = np.geomspace(0.05, 1, 40)
    for mega, colour, style in zip(PRESSURES, (INK, BLUE, RED), STYLES):
        if rows[mega]["delta_s"] is not None:
            angle = np.degrees(np.arctan(np.tan(np.radians(40)) * (side / 0.1) ** (rows[mega]["delta_s"] - 2)))
            ax.plot(100 * side, angle, color=colour, ls=style, label=f"{mega} MPa")
    ax.set(xscale="log", xlabel="side of the specimen (cm)", ylabel="angle of sliding (degrees)")
    plain_ticks(ax.xaxis)
    ax.legend()
    panel(ax, "e", "tilt, if 40° at 10 cm")


def draw_strength(ax, rows):
    """Shear strength of a large specimen over the load: Coulomb's line and eq. 3."""
    loads = np.array([mega for mega in rows if rows[mega]["delta_s"] is not None and mega <= 20], float)
    drop = np.array([10 ** (rows[mega]["delta_s"] - 2) for mega in loads])
    ax.plot(loads, 0.6 * loads, color=QUIET, ls=(0, (4, 3)), label="10 cm, $f$ = 0.6")
    ax.plot(loads, 0.6 * loads * drop, "o-", ms=3.5, color=INK, label="1 m, by eq. 3")
    ax.set(xlim=0, ylim=0, xlabel="mean pressure (MPa)", ylabel="shear strength (MPa)")
    ax.legend(loc="upper left")
    panel(ax, "f", "strength over the load")


# --- Fig. 4


def shear(program, level, side, folder):
    """A specimen of a side sheared by a stiff machine: displacement [m] and friction coefficient."""
    path = os.path.join(folder, "sheared.nc")
    json_of(program, "run", case("lab-shear.yaml"), "-o", path, "--force", *settings(
        f"interface.size={side} m", f"interface.levels={level}", "friction.aging.b=0.02", "load.shear.0.spring.stiffness=10 TPa/m",
        "time.end=120 s", "output.every=0.5 s", "output.fields=[slip_rate]"))
    with open_file(path, "slip", "apparent_friction") as run:
        return run["slip"].values, run["apparent_friction"].values


def draw_shear(ax, program, quick, folder):
    """Shear curves: one friction law on all specimens, and their friction coefficient as eq. 3 has it."""
    exponent = 2 - 1.77
    for k, (side, colour, style) in enumerate(zip(SIDES, COLOURS, STYLES)):
        if quick and k > 1:
            break
        slip, friction = shear(program, 5 + k, side, folder)
        ax.plot(slip * 1e6, friction, color=SLIP, lw=3, zorder=0, label="one law for all" if k == 0 else None)
        ax.plot(slip * 1e6, friction * (side / SIDES[0]) ** -exponent, color=colour, ls=style, label=f"{100 * side:g} cm")
    ax.set(xlim=0, ylim=(0, 0.8), xlabel="displacement (µm)", ylabel="shear over normal force")
    ax.legend(ncol=2, loc="lower right")
    panel(ax, "a", "shear tests; lines: $f$ by eq. 3, 1.77")


def fractal_series(program, hurst, seeds, levels, folder):
    """Exponents 2 - Delta_S of interfaces of one Hurst exponent, pressed to where a tenth or more touches."""
    found = [json_of(program, "contact", case("contact/self-affine.yaml"), "-o", os.path.join(folder, "sizes.nc"), "--force",
                     "--coarsest", str(min(64, 2 ** (levels - 3))), *settings(
                         f"interface.levels={levels}",
                         f"interface.surface={{self-affine: {{hurst: {hurst}, rms_height: 10 mm, seed: {seed}}}}}"))
             for seed in range(1, seeds + 1)]
    return np.array([2 - one["delta_s"] for one in found]), found[0]["published_exponents"]


def draw_sizes(ax, letter, name, hurst, exponents, published):
    """Strength over the side: the spread of Lacuna's interfaces, and the paper's fit to a set of experiments."""
    side = np.geomspace(SIDES[0], SIDES[-1], 30)
    row = next(r for r in published if f"Bandis et al. 1981, {name}" in r["source"])
    mean, sd = exponents.mean(), exponents.std(ddof=1)
    ratio = side / SIDES[0]
    ax.fill_between(100 * side, ratio ** -(mean + sd), ratio ** -(mean - sd), color=BLUE, alpha=0.25, lw=0)
    ax.plot(100 * side, ratio**-mean, color=BLUE, label=f"$H$ = {hurst}: {2 - mean:.2f} ± {sd:.2f}")
    ax.plot(100 * side, ratio ** -row["exponent_low"], color=RED, ls=(0, (4, 3)), label=f"Bandis, {name}: {2 - row['exponent_low']:.2f}")
    ax.set(xscale="log", yscale="log", xlabel="side of the specimen (cm)", ylabel="strength over that of 5 cm", ylim=(0.4, 1.05))
    plain_ticks(ax.yaxis)
    ax.set_xticks([100 * s for s in SIDES], [f"{100 * s:g}" for s in SIDES])
    ax.minorticks_off()
    ax.legend(loc="lower left", title="$\\Delta_S$", handlelength=1.4)
    panel(ax, letter, f"size effect, {name} set")


def draw_onset(ax, program, levels, seeds, folder):
    """The part that slips over the load, in the cascade on interfaces of several sizes; marks: Q_crit."""
    path = os.path.join(folder, "rg.nc")
    for level, colour, style in zip(levels, COLOURS, STYLES):
        found = json_of(program, "rg", case("rg/table.yaml"), "-o", path, "--force", *settings(
            f"interface.levels={level}", "rg.beta=0.6", f"rg.seeds={seeds}", "rg.contacts=60"))
        with open_file(path, "slip_fraction", "load") as data:
            load, part = data["load"].values, data["slip_fraction"].isel(beta=0, level=0).values
        ax.plot(load, part, color=colour, ls=style, label=f"{2**level}²")
        critical = found["results"][0]["q_crit_over_q_nom"]
        ax.plot(critical, np.interp(critical, load, part), "D", ms=4.5, mfc="white", mec=colour, zorder=5)
    ax.set(xlim=(0, 1), ylim=(0, 1.02), xlabel="$Q/Q_{nom}$", ylabel="part of the cells that slips")
    ax.legend(title="cells", loc="upper left")
    panel(ax, "d", "cascade, β = 0.6; marks: $Q_{crit}$")


def figure4(program, quick, folder):
    """Shear curves, the size effect on strength, and how slip spreads on interfaces of several sizes."""
    figure, axes = plt.subplots(2, 2, figsize=(WIDTH, 4.9), layout="constrained")
    draw_shear(axes[0][0], program, quick, folder)
    for ax, (letter, name, hurst) in zip((axes[0][1], axes[1][0]), SETS):
        exponents, published = fractal_series(program, hurst, 2 if quick else 6, 8 if quick else 10, folder)
        draw_sizes(ax, letter, name, hurst, exponents, published)
    draw_onset(axes[1][1], program, (5, 6) if quick else (5, 6, 7, 8), 2 if quick else 6, folder)
    return figure


# --- All


def run_tool(name, *words):
    done = subprocess.run([sys.executable, os.path.join(ROOT, "tools", name), *words], check=False)
    if done.returncode != 0:
        stop(f"tools/{name} failed")


def draw_all(program, output, suffix, quick):
    """The four figures as files in a folder."""
    def path(k):
        return os.path.join(output, f"figure{k}.{suffix}")

    quick1 = ("--set", "interface.levels=8", "--coarsest", "32") if quick else ()
    quick3 = ("--seeds", "2", "--levels", "6") if quick else ()
    with tempfile.TemporaryDirectory(prefix="lacuna-plot-") as folder:
        run_tool("figure1.py", "--program", program, "-o", path(1), *quick1)
        save(figure2(program, 8 if quick else 10, folder), path(2))
        run_tool("figure3.py", "--program", program, "-o", path(3), *quick3)
        save(figure4(program, quick, folder), path(4))
