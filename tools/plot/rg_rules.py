#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what the rules FIX, CONS and LUMP do on 2 x 2 and on 8 x 8 cells.

    tools/plot/rg_rules.py [-o FIGURE.png] [--beta B] [--seed N] [--dimension D]

Above: four cells of pressures 1 to 4 (a surface made for that), the stresses that all bear alike,
and what each holds as one after the other slips, at the critical force that `lacuna rg` finds; the
stresses are worked out here, and the tool ends where they do not lead to that force. Below: the
contact of cases/rg/table.yaml on 8 x 8 cells and the load at which `lacuna rg` has each cell slip.
"""

import argparse
import os
import sys
import tempfile

# first: it says what is missing
from figures import BLUE, INK, QUIET, RED, ROOT, SLIP, STYLE, json_of, np, open_file, plt, save
from matplotlib.patches import Patch, Rectangle

FOUR = """lacuna: 1
interface: {{size: "1 m", levels: 1, surface: {{file: {{path: {path}, unit: m, spacing: "0.5 m"}}}}}}
material: {{shear_modulus: "{modulus} Pa", poisson: 0}}
load: {{normal: {{pressure: "2.5 Pa"}}}}
rg: {{rule: {rule}, field: equal, beta: {beta}, friction: 1, shifts: 1}}
"""


def cascade(arguments, folder, case, *overrides):
    """Q_crit/Q_nom, and pressure and slip load of each cell by its row and column."""
    path = os.path.join(folder, "rg.nc")
    words = [word for override in overrides for word in ("--set", override)]
    result = json_of(arguments.program, "rg", case, "--force", "-o", path, *words)
    with open_file(path, "slip_load") as data:
        side = result["results"][0]["levels"][0]["block_size_m"]
        n = round(result["results"][0]["levels"][-1]["block_size_m"] / side)
        pressure, slip_load = np.zeros((n, n)), np.full((n, n), np.nan)
        x, y = ((data[name].values / side).astype(int) for name in ("x", "y"))
        pressure[y, x] = data["pressure"].values
        slip_load[y, x] = data["slip_load"].values[0]
    return result["q_crit_over_q_nom"], pressure, slip_load


def four_cells(folder):
    """Heights that press 2 x 2 cells with 1 to 4 Pa: their own elastic deflection."""
    modulus = 1e5
    pressure = np.array([[1.0, 2.0], [3.0, 4.0]])
    waves = 2 * np.pi * np.hypot(*np.meshgrid([0, 1], [0, 1], indexing="ij"))
    waves[0, 0] = np.inf
    heights = np.fft.ifft2(np.fft.fft2(pressure) * 2 / (modulus * waves)).real
    path = os.path.join(folder, "four.npy")
    np.save(path, heights)
    return path, modulus


def equal_stress(strength, force):
    """tau of springs of one stiffness with caps."""
    low, high = 0.0, force
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if np.minimum(middle, strength).sum() < force else (low, middle)
    return high


def stages(rule, beta, strength, critical):
    """[(stress that each cell carries of its own, received)] as 0 ... 4 of them have slipped."""
    tau = equal_stress(strength, critical * strength.sum())
    own = np.minimum(tau, strength)
    received = np.zeros(4)
    slipped = np.zeros(4, dtype=bool)
    out = [(own.copy(), received.copy())]
    for i in range(4):  # the weakest has the smallest gap
        if strength[i] - tau - received[i] > 1e-6:
            sys.exit(f"rg_rules: cell {i + 1} would not slip at the force that the program found")
        shed = (1 - beta) * strength[i]
        if rule == "cons":
            shed = own[i] + received[i] - beta * strength[i]
        slipped[i] = True
        own[i], received[i] = beta * strength[i], 0.0
        left = 4 - slipped.sum()
        if left > 0:
            received[~slipped] += shed / left
        out.append((own.copy(), received.copy()))
    return out


def draw_stage(ax, strength, stage, gone):
    """Bars in the four corners: outline f p, filled what the cell holds."""
    own, received = stage
    ax.set_xlim(0, 2)
    ax.set_ylim(0, 2)
    ax.set_aspect("equal")
    ax.set_xticks([])
    ax.set_yticks([])
    for spine in ax.spines.values():
        spine.set_visible(True)
    ax.axhline(1, color=QUIET, linewidth=0.6)
    ax.axvline(1, color=QUIET, linewidth=0.6)
    scale = 0.8 / 4.2
    for i in range(4):
        x, y = i % 2 + 0.1, i // 2 + 0.08
        if i < gone:
            ax.add_patch(Rectangle((i % 2, i // 2), 1, 1, color="#e9ecef", zorder=0))
        ax.add_patch(Rectangle((x, y), 0.3, own[i] * scale, linewidth=0,
                               facecolor=SLIP if i < gone else BLUE))
        ax.add_patch(Rectangle((x, y + own[i] * scale), 0.3, received[i] * scale, linewidth=0,
                               facecolor=RED))
        ax.add_patch(Rectangle((x, y), 0.3, strength[i] * scale, fill=False, edgecolor=INK,
                               linewidth=0.9))
        ax.text(x + 0.42, y + 0.02, f"{own[i] + received[i]:.2f}", fontsize=7, va="bottom")
        ax.text(x + 0.42, y + 0.3, f"f p = {strength[i]:.0f}", fontsize=6.5, va="bottom",
                color=QUIET)


def draw_four(figure, rows, arguments, folder):
    path, modulus = four_cells(folder)
    for r, (rule, name) in enumerate((("fix", "FIX, LUMP"), ("cons", "CONS"))):
        case = os.path.join(folder, "four.yaml")
        with open(case, "w", encoding="utf-8") as out:
            out.write(FOUR.format(path=path, modulus=modulus, rule=rule,
                                  beta=arguments.beta))
        critical, pressure, _ = cascade(arguments, folder, case)
        strength = pressure.ravel()
        if rule == "fix" and abs(cascade(arguments, folder, case, "rg.rule=lump")[0]
                                 - critical) > 1e-6:
            sys.exit("rg_rules: FIX and LUMP differ on a single block")
        all_stages = stages(rule, arguments.beta, strength, critical)
        for k in range(4):
            ax = figure.add_subplot(rows[r, k])
            draw_stage(ax, strength, all_stages[k], k)
            if k == 0:
                ax.set_ylabel(f"{name}\nQ$_{{crit}}$ = {critical:.4g} Q$_{{nom}}$")
            if r == 0:
                ax.set_title(("before any slips", "one has slipped", "two", "three: the last follows")
                             [k])


def draw_eight(figure, rows, arguments, folder):
    case = os.path.join(ROOT, "cases/rg/table.yaml")
    own = ("interface.levels=3", "rg.seeds=1", f"rg.beta={arguments.beta}",
           f"interface.surface.self-affine.seed={arguments.seed}",
           "interface.surface.self-affine.shortest=0.3 m",
           f"load.normal.dimension={arguments.dimension}")
    axes = [figure.add_subplot(rows[0, k]) for k in range(4)]
    image = None
    for ax, rule in zip(axes[1:], ("fix", "cons", "lump")):
        critical, pressure, slip_load = cascade(arguments, folder, case, *own, f"rg.rule={rule}")
        image = ax.imshow(slip_load, origin="lower", extent=(0, 8, 0, 8), cmap="viridis", vmin=0,
                          vmax=1)
        ax.set_title(f"{rule.upper()}: Q$_{{crit}}$ = {critical:.2f} Q$_{{nom}}$")
    shown = axes[0].imshow(np.where(pressure > 0, pressure / pressure.max(), np.nan), vmin=0,
                           origin="lower", extent=(0, 8, 0, 8), cmap="Blues", vmax=1.2)
    axes[0].set_title(f"pressure of {int((pressure > 0).sum())} cells")
    for ax in axes:
        ax.set_xticks([])
        ax.set_yticks([])
        for i in range(1, 8):
            width = {4: 1.6, 2: 0.8, 6: 0.8}.get(i, 0.25)
            ax.axhline(i, color=INK, linewidth=width)
            ax.axvline(i, color=INK, linewidth=width)
        for spine in ax.spines.values():
            spine.set_visible(True)
    for ax, drawn, label in ((axes[0], shown, "p / max p"),
                             (axes[2], image, "Q / Q$_{nom}$ at which the cell has slipped")):
        box = ax.get_position()
        wide = 1.0 if ax is axes[0] else 2.0
        bar = figure.add_axes((box.x0 + (1 - wide) * box.width / 2, box.y0 - 0.035,
                               box.width * wide, 0.013))
        figure.colorbar(drawn, cax=bar, orientation="horizontal", label=label)
        bar.set_xlim(0, 1)


def draw(arguments, folder):
    figure = plt.figure(figsize=(7.2, 6.3))
    above = figure.add_gridspec(2, 4, left=0.085, right=0.985, top=0.955, bottom=0.46, wspace=0.1,
                                hspace=0.08)
    draw_four(figure, above, arguments, folder)
    figure.legend(handles=[Patch(facecolor="white", edgecolor=INK, label="strength f p"),
                           Patch(color=BLUE, label="stress q"), Patch(color=RED, label="received"),
                           Patch(color=SLIP, label=f"slipped: β f p, β = {arguments.beta:g}")],
                  loc="upper center", bbox_to_anchor=(0.535, 0.455), ncol=4, frameon=False,
                  handlelength=1)
    draw_eight(figure, figure.add_gridspec(1, 4, left=0.085, right=0.985, top=0.385, bottom=0.115,
                                           wspace=0.1), arguments, folder)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--output", default="rg-rules.png")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    parser.add_argument("--beta", type=float, default=0.6)
    parser.add_argument("--seed", type=int, default=6, help="of the 8 x 8 cells")
    parser.add_argument("--dimension", type=float, default=1.6, help="of the 8 x 8 cells")
    arguments = parser.parse_args()
    plt.rcParams.update(STYLE)
    with tempfile.TemporaryDirectory(prefix="lacuna-rg-rules-") as folder:
        save(draw(arguments, folder), arguments.output)


if __name__ == "__main__":
    main()
