#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a sheared contact: which cells stick and slip at chosen steps, and the loop of shear load
against shift.

    tools/plot/plot_contact.py CASE-contact.nc [-o CASE-contact.png]
    tools/plot/plot_contact.py CASE-contact.nc --steps 2 4 6

Sticking cells are black, slipping ones grey, open ones white; the circle is the cell of the highest
q/(f p) that still sticks. Without --steps, up to four steps are drawn, turning points of the shear
load first. A file without a history shows its contact cells.
"""

import argparse
import os
import textwrap

# first: it says what is missing
from figures import FAINT, FAST, INK, QUIET, SEEN, np, open_file, plt, save, stop, use_screen_style
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

MARK, OTHER = SEEN, FAST
OPEN, STICK, SLIP = 0, 1, 2
COLOURS = ListedColormap(["#ffffff", "#000000", "#b0b0b0"])
MOST = 4
LETTER, KEY = 0.1, 4.6  # inches: of a title a character, at most; of the key
PREFIXES = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")]


class Contact:
    """What is drawn of a file."""

    def __init__(self, path):
        with open_file(path) as data:
            if "pressure" not in data or "x" not in data:
                stop(f"{path}: no contact in it")
            data = data.load()
        self.title = data.attrs.get("title", os.path.basename(path))
        self.status = data.attrs.get("status", "unknown")
        self.x, self.y = data["x"].values, data["y"].values
        self.count = data.sizes.get("step", 0)
        self.data = data
        self.start = np.where(data["pressure"].values > 0, STICK, OPEN)

    def kept(self):
        """The steps, from 1, whose states are in the file."""
        if "state" not in self.data or self.count == 0:
            return []
        every = "step" in self.data["state"].dims
        return list(range(1, self.count + 1)) if every else [self.count]

    def state(self, step):
        state = self.data["state"]
        return (state[step - 1] if "step" in state.dims else state).values

    def series(self, name):
        """From the start, where every load and shift is 0."""
        return np.concatenate([[0.0], self.data[name].values])

    def highest(self, step):
        return (float(self.data["highest_x"][step - 1]), float(self.data["highest_y"][step - 1]))


def scale_of(values, first=0):
    """The prefix in which the largest value is at least 1."""
    largest = np.max(np.abs(values), initial=0.0)
    if not largest > 0:
        return 1.0, ""
    return next((p for p in PREFIXES[first:] if largest >= p[0]), PREFIXES[-1])


def choose_steps(contact):
    """Turning points of the load, then the end, then the steps between."""
    kept = contact.kept()
    if len(kept) <= MOST:
        return kept
    qx, qy = contact.series("shear_force_x"), contact.series("shear_force_y")
    turned = []
    for i in range(1, contact.count):
        before = (qx[i] - qx[i - 1], qy[i] - qy[i - 1])
        after = (qx[i + 1] - qx[i], qy[i + 1] - qy[i])
        if before[0] * after[0] + before[1] * after[1] < 0:
            turned.append(i)
    spread = [int(round(s)) for s in np.linspace(1, contact.count, MOST + 2)]
    chosen = []
    for step in [*turned[: MOST - 1], contact.count, *spread]:
        if step not in chosen and len(chosen) < MOST:
            chosen.append(step)
    return sorted(chosen)


def draw_map(axes, contact, state, title, mark=None):
    side, prefix = scale_of(contact.x, 3)
    half = (contact.x[0], contact.y[0])  # the first centre is half a cell from the edge
    extent = [0, (contact.x[-1] + half[0]) / side, 0, (contact.y[-1] + half[1]) / side]
    axes.imshow(state, cmap=COLOURS, vmin=OPEN, vmax=SLIP, origin="lower", extent=extent,
                interpolation="nearest", aspect="equal")
    if mark is not None and np.all(np.isfinite(mark)):
        axes.plot(mark[0] / side, mark[1] / side, "o", ms=9, mfc="none", mec=MARK, mew=1.4,
                  clip_on=False)
    axes.set_title(title)
    axes.set_xlabel(f"x ({prefix}m)")
    axes.set_ylabel(f"y ({prefix}m)")


def describe_step(contact, step):
    data = contact.data
    stick, slip = int(data["stick_cells"][step - 1]), int(data["slip_cells"][step - 1])
    return f"step {step}: {100 * stick / max(stick + slip, 1):.0f} % stick"


def label_points(axes, x, y, chosen):
    """The numbers of the steps, those of one point together."""
    reach = (np.ptp(x) or 1.0, np.ptp(y) or 1.0)
    groups = []
    for step in chosen:
        for group in groups:
            first = group[0]
            if abs(x[step] - x[first]) < 0.03 * reach[0] and abs(y[step] - y[first]) < 0.03 * reach[1]:
                group.append(step)
                break
        else:
            groups.append([step])
    for group in groups:
        axes.annotate(", ".join(map(str, group)), (x[group[0]], y[group[0]]), xytext=(6, -11),
                      textcoords="offset points", color=MARK, fontsize=8.5)


def draw_loop(axes, contact, chosen):
    force, force_prefix = scale_of(
        np.concatenate([contact.series("shear_force_x"), contact.series("shear_force_y")]))
    length, length_prefix = scale_of(
        np.concatenate([contact.series("shift_x"), contact.series("shift_y")]), 3)
    for axis, colour in (("x", INK), ("y", OTHER)):
        q, shift = contact.series(f"shear_force_{axis}"), contact.series(f"shift_{axis}")
        if axis == "y" and np.max(np.abs(q)) < 1e-6 * force:
            continue
        axes.plot(shift / length, q / force, "o-", color=colour, lw=1.4, ms=3, label=f"along {axis}")
        if axis == "x":
            label_points(axes, shift / length, q / force, chosen)
    axes.axhline(0, color=FAINT, lw=0.8, zorder=0)
    axes.axvline(0, color=FAINT, lw=0.8, zorder=0)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlabel(f"shift ({length_prefix}m)")
    axes.set_ylabel(f"shear load ({force_prefix}N)")
    axes.set_title("shear load and shift")
    if len(axes.get_lines()) > 3:
        axes.legend(loc="lower right")


def draw_key(figure):
    """What the shades and the circle stand for."""
    handles = [
        Patch(facecolor=COLOURS(STICK), label="stick"),
        Patch(facecolor=COLOURS(SLIP), label="slip"),
        Line2D([], [], ls="", marker="o", ms=8, mfc="none", mec=MARK, mew=1.4,
               label="next to slip: highest q/(f p) that sticks"),
    ]
    figure.legend(handles=handles, loc="upper right", ncol=3, borderaxespad=0.2)


def fold(title, width, keyed):
    """A title in as many lines as it takes, the first of them free where the key is in its way."""
    if LETTER * len(title) <= width - (KEY if keyed else 0):
        return title
    return ("\n" if keyed else "") + textwrap.fill(title, int(width / LETTER))


def draw(contact, chosen, path):
    use_screen_style()
    plt.rcParams.update({"axes.spines.top": True, "axes.spines.right": True})
    maps = max(len(chosen), 0 if contact.count else 1)
    rows = 1 if maps <= 2 else 2
    columns = -(-maps // rows)
    loop = 1.5 if contact.count else 0
    figure = plt.figure(figsize=(0.5 + 2.9 * (columns + loop), 0.9 + 2.9 * rows),
                        layout="constrained")
    whole = contact.status == "complete"
    title = contact.title if whole else f"{contact.title} (file {contact.status})"
    figure.suptitle(fold(title, figure.get_figwidth(), contact.count > 0), x=0.008, ha="left",
                    fontsize=11, fontweight="bold")
    widths = [1.0] * columns + ([loop] if loop else [])
    grid = figure.add_gridspec(rows, len(widths), width_ratios=widths)
    if not contact.count:
        share = 100 * np.mean(contact.start == STICK)
        draw_map(figure.add_subplot(grid[0, 0]), contact, contact.start,
                 f"contact: {share:.3g} % of the area")
    for i, step in enumerate(chosen):
        axes = figure.add_subplot(grid[i // columns, i % columns])
        draw_map(axes, contact, contact.state(step), describe_step(contact, step),
                 contact.highest(step))
    if contact.count:
        draw_loop(figure.add_subplot(grid[:, -1]), contact, chosen)
        draw_key(figure)
    save(figure, path, 160)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("contact", metavar="CONTACT.nc")
    parser.add_argument("-o", "--output", help="PNG, SVG or PDF; CONTACT.png unless said")
    parser.add_argument("--steps", type=int, nargs="+", metavar="N", help="steps to draw, from 1")
    options = parser.parse_args()
    try:
        contact = Contact(options.contact)
    except (OSError, ValueError) as wrong:
        stop(f"{str(wrong).splitlines()[0]}")
    chosen = options.steps or choose_steps(contact)
    for step in chosen:
        if step not in contact.kept():
            kept = contact.kept()
            holds = f"states of steps {kept[0]} to {kept[-1]}" if kept else "no states of steps"
            stop(f"{options.contact}: no step {step}; it holds {holds}")
    output = options.output or os.path.splitext(options.contact)[0] + ".png"
    draw(contact, chosen, output)


if __name__ == "__main__":
    main()
