#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws slip and its renormalization, after Borri-Brunetto et al. (2004), Fig. 3.

    tools/plot/figure3.py [CASE] [-o FIGURE.png] [--seeds N] [--jobs N] [--set KEY=VALUE]

Calls `lacuna contact` and `lacuna rg` on the case (cases/rg/table.yaml), at dimensions of its own.
(a, b) cells that stick and that slip under two shear forces by the elastic theory, before any drop of
friction; (c) part of (b); (d) the blocks over a part of it, and which have slipped in the cascade;
(e) the drop of friction; (f) the map of slipped fractions from one level to the next and its unstable
fixed point C; (g) the critical shear force over the dimension, mean and standard error over the seeds.
"""

import argparse
import os
import sys
import tempfile

# first: it says what is missing
from figures import BLUE, GREEN, INK, QUIET, RED, ROOT, SLIP, STYLE, WIDTH, json_of, np, open_file, plt, save
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

import rg_table

COLOURS = dict(zip(rg_table.BETAS, (GREEN, BLUE, RED)))
SPARSE = 1.39  # dimension of (a) to (d)
LOADS = (0.3, 0.8)  # Q/Q_nom of (a) and (b)
DIMENSIONS = (1.2, 1.3, 1.39, 1.45, 1.55, 1.65, 1.7, 1.8, 1.85, 1.9)  # of (g)
MAP_BETA = 0.68  # of (f): C is near the 0.62 of the paper's figure
ZOOM, PIECE = 64, 16  # cells a side of (c) and (d)


def settings(*pairs):
    return [word for pair in pairs for word in ("--set", pair)]


class Joint:
    """One contact of dimension SPARSE: what sticks under two shear forces, and its cascade."""

    def __init__(self, arguments, folder):
        path = os.path.join(folder, "joint.nc")
        own = settings(*arguments.set, f"interface.surface.self-affine.seed={arguments.seed}")
        found = json_of(arguments.program, "contact", arguments.case, "--force", "-o", path, *own,
                     *settings(f"load.normal.dimension={SPARSE}"))
        load = f"load.normal={{pressure: {found['mean_pressure_Pa']!r}}}"
        steps = ", ".join(f"{{ratio_x: {ratio}}}" for ratio in LOADS)
        json_of(arguments.program, "contact", arguments.case, "--force", "-o", path, *own,
             *settings(load, f"load.history={{friction: 0.6, steps: [{steps}]}}"))
        with open_file(path) as data:
            self.state = data["state"].values.astype(int)
        rows, columns = self.state.shape[1:]
        if rows != columns or rows < ZOOM or rows % ZOOM:
            sys.exit(f"figure3: {columns} x {rows} cells: as many both ways, a multiple of {ZOOM}, are "
                     "needed to show a part of them")
        self.cell = found["cell_size_m"]
        self.cascade = json_of(arguments.program, "rg", arguments.case, "--force", "-o", path, *own,
                            *settings(load, "rg.seeds=1", "rg.beta=0.7", "rg.shifts=1"))
        self.slip_load = np.full(self.state.shape[1:], np.nan)
        with open_file(path) as data:
            x, y = ((data[name].values / self.cell).astype(int) for name in ("x", "y"))
            self.slip_load[y, x] = data["slip_load"].values[0]

    def densest(self, side, within=None):
        """Corner of the block of the grid that holds most contact: row, column."""
        touching = self.state[0] > 0
        if within is not None:
            row, column, size = within
            mask = np.zeros_like(touching)
            mask[row:row + size, column:column + size] = True
            touching = touching & mask
        n = touching.shape[0] // side
        held = touching.reshape(n, side, n, side).sum((1, 3))
        best = np.unravel_index(np.argmax(held), held.shape)
        return int(best[0]) * side, int(best[1]) * side


def title(ax, letter, text):
    """The panel's letter and title."""
    ax.set_title(f"({letter})", loc="left", fontweight="bold")
    ax.set_title(text, loc="center")


def draw_state(ax, state):
    ax.imshow(state, cmap=ListedColormap(["white", "black", SLIP]), vmin=0, vmax=2,
              origin="lower", interpolation="nearest", extent=(0, state.shape[1], 0, state.shape[0]))
    ax.set_xticks([])
    ax.set_yticks([])
    for spine in ax.spines.values():
        spine.set_visible(True)


def frame(ax, corner, side, colour):
    ax.add_patch(Rectangle(corner[::-1], side, side, fill=False, edgecolor=colour, linewidth=1.2))


def draw_joint(axes, joint):
    """(a, b, c) What sticks and slips."""
    corner = joint.densest(ZOOM)
    for k, (ax, letter) in enumerate(zip(axes, "ab")):
        draw_state(ax, joint.state[k])
        title(ax, letter, f"Q = {LOADS[k]:g} Q$_{{nom}}$")
        side = joint.cell * joint.state.shape[2]
        ax.set_xlabel(f"{side:g} m", labelpad=3)
    frame(axes[1], corner, ZOOM, RED)
    row, column = corner
    draw_state(axes[2], joint.state[1][row:row + ZOOM, column:column + ZOOM])
    title(axes[2], "c", "part of (b)")
    axes[2].set_xlabel(f"{ZOOM * joint.cell:g} m", labelpad=3)
    for spine in axes[2].spines.values():
        spine.set_edgecolor(RED)
    part = joint.densest(PIECE, within=(*corner, ZOOM))
    frame(axes[2], (part[0] - row, part[1] - column), PIECE, BLUE)
    axes[0].legend(handles=[Patch(color="black", label="sticks"), Patch(color=SLIP, label="slips")],
                   loc="upper center", bbox_to_anchor=(0.5, -0.1), ncol=2, frameon=False,
                   handlelength=1)
    return part


def draw_orders(axes, joint, corner):
    """(d) Blocks of increasing order; what slips as a whole takes all of its blocks along."""
    critical = joint.cascade["q_crit_over_q_nom"]
    piece = joint.slip_load[corner[0]:corner[0] + PIECE, corner[1]:corner[1] + PIECE]
    load = 0.97 * critical
    for order, ax in enumerate(axes):
        step = 2 ** order
        n = PIECE // step
        blocks = piece.reshape(n, step, n, step)
        with np.errstate(all="ignore"):
            last = np.nanmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=(1, 3))
        state = np.where(np.isinf(last), 0, np.where(last <= load, 2, 1))
        draw_state(ax, state)
        for i in range(n + 1):
            ax.axhline(i, color=QUIET, linewidth=0.4 if n > 8 else 0.7)
            ax.axvline(i, color=QUIET, linewidth=0.4 if n > 8 else 0.7)
        ax.set_xlabel(f"order {order + 1}: {(state == 2).sum()} of {(state > 0).sum()}", labelpad=3)
    axes[0].set_title("(d)", loc="left", fontweight="bold")
    axes[1].set_title(f"slipped blocks of (c): FIX, β = 0.7, Q = {load:.2f} Q$_{{nom}}$",
                      loc="left", x=-0.5)


def draw_drop(ax):
    """(e) What a cell holds as it slips."""
    ax.plot([0, 1, 1], [0, 1, 1], color=INK)
    for beta, colour in COLOURS.items():
        ax.plot([1, 1.02, 2.75], [1, beta, beta], color=colour)
        ax.text(2.82, beta, f"β = {beta:g}", color=colour, va="center", fontsize=8)
    ax.annotate("", (1.55, 1.0), (1.55, 0.6), arrowprops={"arrowstyle": "<->", "color": QUIET,
                                                        "linewidth": 0.7, "shrinkA": 0,
                                                        "shrinkB": 0})
    ax.plot([1, 2.75], [1, 1], color=QUIET, linewidth=0.6, linestyle=":")
    ax.text(1.62, 0.89, "(1 - β) f p", fontsize=8, va="center")
    ax.set_xlim(0, 3.65)
    ax.set_ylim(0, 1.15)
    ax.set_xticks([])
    ax.set_yticks([0, 0.6, 0.7, 0.8, 1])
    ax.set_xlabel("displacement of the cell")
    ax.set_ylabel("q / (f p)")
    title(ax, "e", "drop of friction")


def stairs(ax, s, slope, intercept, colour, label):
    """The map applied again and again."""
    ax.plot([s], [s], "o", color=colour, markersize=3.5)
    ax.annotate(label, (s, s), (6, -8), textcoords="offset points", color=INK, fontsize=8)
    for _ in range(40):
        above = 1 / (1 + np.exp(-slope * np.log(s / (1 - s)) - intercept))
        ax.plot([s, s, above], [s, above, above], color=colour, linewidth=0.7)
        if not 1e-3 < above < 1 - 1e-3:
            break
        s = above


def draw_map(ax, runs, levels_least=8):
    """(f) N_slip/N_tot from one level to the next."""
    ax.plot([0, 1], [0, 1], color=QUIET, linewidth=0.7)
    s = np.linspace(1e-4, 1 - 1e-4, 400)
    for (field, colour, marker), path in runs.items():
        with open_file(path) as data:
            fraction = data["slip_fraction"].values[0]
            keep = np.flatnonzero(data["n_tot"].values[1:] >= levels_least)
            slope, intercept = (float(data[name][0]) for name in ("map_slope", "map_intercept"))
            fixed = float(data["critical_fraction"][0])
        ax.plot(fraction[:, keep].ravel(), fraction[:, keep + 1].ravel(), marker, color=colour,
                markersize=2, alpha=0.35, markeredgewidth=0)
        ax.plot(s, 1 / (1 + np.exp(-slope * np.log(s / (1 - s)) - intercept)), color=colour,
                label=f"{field}: λ {slope:.2f}, C {fixed:.2f}")
        if field == "equal":
            ax.plot([fixed], [fixed], "D", color=INK, markersize=4, zorder=5)
            ax.annotate("C", (fixed, fixed), (-11, 4), textcoords="offset points")
            stairs(ax, 0.4, slope, intercept, INK, "A")
            stairs(ax, 0.8, slope, intercept, INK, "B")
    ax.set_xlim(0, 1)
    ax.set_ylim(0, 1)
    ax.set_aspect("equal")
    ax.set_xlabel("N$_{slip}$/N$_{tot}$ of a level")
    ax.set_ylabel("of the next")
    ax.legend(loc="upper left", frameon=False, handlelength=1.2, borderaxespad=0)
    title(ax, "f", f"FIX, β = {MAP_BETA}, D = 1.55")


def draw_force(ax, found):
    """(g) Q_crit/Q_nom over the dimension."""
    style = {"fix": {"fmt": "o-", "markersize": 3.5}, "lump": {"fmt": "s--", "markersize": 2.5,
                                                              "markerfacecolor": "white"},
             "cons": {"fmt": ":", "markersize": 0}}
    for rule, how in style.items():
        rows = {d: one["results"] for (r, d), one in found.items() if r == rule}
        for k, (beta, colour) in enumerate(COLOURS.items()):
            at = sorted(rows)
            values = np.array([rg_table.mean_and_error(rows[d][k]) for d in at])
            ax.errorbar(at, values[:, 0], values[:, 1], color=colour, capsize=2, elinewidth=0.8,
                        linewidth=0.9, **how)
    for beta, value in rg_table.PAPER.items():
        ax.plot([1.955], [value], "<", color=COLOURS[beta], markersize=5, clip_on=False)
    ax.text(1.955, 0.925, "paper", ha="center", fontsize=8)
    ax.set_xlim(1.17, 1.98)
    ax.set_ylim(0.37, 1)
    ax.set_xlabel("dimension D of the contact domain")
    ax.set_ylabel("Q$_{crit}$ / Q$_{nom}$")
    rules = [Line2D([], [], color=QUIET, marker=marker, linestyle=line, markersize=3.5,
                    markerfacecolor=face, label=label)
             for marker, line, face, label in (("o", "-", QUIET, "FIX"), ("s", "--", "white", "LUMP"),
                                               ("", ":", QUIET, "CONS"))]
    betas = [Line2D([], [], color=colour, label=f"β = {beta:g}") for beta, colour in COLOURS.items()]
    ax.legend(handles=[*rules, *betas], loc="lower left", frameon=False, ncol=2, handlelength=2.2,
              columnspacing=1.2, borderaxespad=0.2)
    title(ax, "g", "critical shear force")


def find_force(run, arguments):
    return {(rule, d): run.of(arguments.levels, arguments.seeds, d, rule=rule)
            for d in DIMENSIONS for rule in ("fix", "lump", "cons")
            if rule == "fix" or d in rg_table.DIMENSIONS}


def draw(arguments, folder):
    run = rg_table.Runner(arguments, folder)
    joint = Joint(arguments, folder)
    force = find_force(run, arguments)
    maps = {("elastic", BLUE, "o"): {}, ("equal", RED, "^"): {}}
    for key in maps:
        path = os.path.join(folder, f"map-{key[0]}.nc")
        json_of(arguments.program, "rg", arguments.case, "-o", path, "--jobs", str(arguments.jobs), *settings(
            *arguments.set, f"rg.seeds={arguments.seeds}", f"rg.beta={MAP_BETA}", f"rg.field={key[0]}"))
        maps[key] = path
    figure = plt.figure(figsize=(WIDTH, WIDTH * 7.9 / 7.2))
    rows = figure.add_gridspec(3, 1, left=0.075, right=0.975, top=0.965, bottom=0.06, hspace=0.42,
                               height_ratios=(1, 0.72, 1.15))
    top = rows[0].subgridspec(1, 3, wspace=0.12)
    part = draw_joint([figure.add_subplot(cell) for cell in top], joint)
    middle = rows[1].subgridspec(1, 5, width_ratios=(1, 1, 1, 0.3, 1.35), wspace=0.12)
    draw_orders([figure.add_subplot(middle[i]) for i in range(3)], joint, part)
    draw_drop(figure.add_subplot(middle[4]))
    bottom = rows[2].subgridspec(1, 2, width_ratios=(1, 1.25), wspace=0.25)
    draw_map(figure.add_subplot(bottom[0]), maps)
    draw_force(figure.add_subplot(bottom[1]), force)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("case", nargs="?", default=os.path.join(ROOT, "cases/rg/table.yaml"))
    parser.add_argument("-o", "--output", default="figure3.png")
    parser.add_argument("--small", action="store_true", help="a PNG of 256 colours, for the documentation")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    parser.add_argument("--seeds", type=int, default=12, help="interfaces of (f) and (g)")
    parser.add_argument("--seed", type=int, default=3, help="of the interface of (a) to (d)")
    parser.add_argument("--levels", type=int, default=8, help="2^levels cells a side in (g)")
    parser.add_argument("--jobs", type=int, default=min(os.cpu_count() or 1, 64), help="interfaces at a time")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="override the case; may be repeated")
    arguments = parser.parse_args()
    if arguments.seeds < 2 or arguments.jobs < 1:
        parser.error("--seeds must be at least 2 and --jobs 1")
    plt.rcParams.update(STYLE)
    with tempfile.TemporaryDirectory(prefix="lacuna-figure3-") as folder:
        save(draw(arguments, folder), arguments.output, small=arguments.small)


if __name__ == "__main__":
    main()
