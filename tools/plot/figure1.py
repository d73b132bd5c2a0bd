#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the multiscale contact of a rough interface, after Borri-Brunetto et al. (2004), Fig. 1.

    tools/plot/figure1.py [CASE] [-o FIGURE.png] [--set KEY=VALUE] [--coarsest N]

Calls `lacuna contact` on the case (cases/contact/joint.yaml) for heights, pressures and areas, and
again on its heights sampled at coarser resolutions for their contact domains.
(a) the interface, (b) a cut through it as several resolutions see it, (c, d, e) contact domains at
three resolutions, (f) real area and mean real pressure over the resolution.
"""

import argparse
import math
import os
import sys
import tempfile

# first: it says what is missing
from figures import BLUE, INK, RED, ROOT, STYLE, WIDTH, json_of, length as length_in, matplotlib, np, open_file, plt, save
from matplotlib import ticker
from matplotlib.colors import LightSource, LogNorm


def length(value):
    """A length in metres; no centimetres, since the axes are in millimetres."""
    return length_in(value, {"km": 1e3, "m": 1.0, "mm": 1e-3, "µm": 1e-6})


class Solved:
    """What `lacuna contact` gives: its JSON, and heights and pressures as arrays."""

    def __init__(self, arguments, folder, *overrides):
        path = os.path.join(folder, "contact.nc")
        words = [word for override in [*arguments.set, *overrides] for word in ("--set", override)]
        self.json = json_of(arguments.program, "contact", arguments.case, "--force", "-o", path,
                            "--coarsest", str(arguments.coarsest), *words)
        with open_file(path, "pressure") as data:
            self.heights = data["heights"].values if "heights" in data else None
            self.pressure = data["pressure"].values
            self.periodic = "boundary: periodic" in data.attrs["case"]
        self.cell = self.json["cell_size_m"]


class Interface:
    """The finest resolution, and the contact at coarser ones."""

    def __init__(self, arguments, folder):
        self.arguments, self.folder = arguments, folder
        self.finest = Solved(arguments, folder)
        self.result = self.finest.json
        self.rows = self.result["resolutions"]
        if not self.rows:
            sys.exit(f"figure1: {arguments.case}: {self.result['delta_s_none']}")
        self.heights = self.finest.heights
        self.solved = {}
        self.side = self.finest.cell * self.heights.shape[1]

    def step(self, row):
        """Cells of the finest grid along one of this resolution."""
        return round(row["cell_size_m"] / self.finest.cell)

    def pressure(self, row):
        """Pressures of the heights sampled at one resolution; its area must be the series' own."""
        step = self.step(row)
        if step == 1:
            return self.finest.pressure
        if step in self.solved:
            return self.solved[step]
        path = os.path.join(self.folder, "heights.npy")
        np.save(path, np.ascontiguousarray(self.heights[::step, ::step]))
        levels = round(math.log2(self.heights.shape[0] // step))
        solved = Solved(self.arguments, self.folder, f"interface.levels={levels}",
                        f"interface.surface={{file: {{path: {path}, unit: m}}}}")
        if abs(solved.json["n_cells"] - row["cells"]) > 0.01 * row["cells"] + 1:
            sys.exit(f"figure1: {solved.json['n_cells']} cells touch at {length(row['cell_size_m'])}"
                     f", {row['cells']} did before")
        self.solved[step] = solved.pressure
        return solved.pressure


def window_of(pressure, part, step, periodic):
    """Corner and side of the square of 1/part of the side that holds most of the contact."""
    whole, n = pressure.shape[0], pressure.shape[0] // part
    touching = np.pad(pressure > 0, ((0, n), (0, n)), mode="wrap").astype(np.int64)
    total = np.pad(touching.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
    held = total[n:, n:] - total[:-n, n:] - total[n:, :-n] + total[:-n, :-n]
    most = whole if periodic else whole - n + 1
    held = held[:most:step, :most:step]
    # Of the squares that hold as much the middle one, so that the contact is not at an edge.
    corners = np.argwhere(held >= 0.98 * held.max())
    middle = corners[np.argmin(((corners - np.median(corners, axis=0)) ** 2).sum(1))]
    return int(middle[0]) * step, int(middle[1]) * step, n


def cut_out(values, corner, step):
    """The square of a map at a resolution of `step` finest cells, round the edges."""
    first, start, n = (value // step for value in corner)
    return np.roll(values, (-first, -start), axis=(0, 1))[:n, :n]


def name(ax, letter, text, x=0.0, pad=5):
    """The panel's letter and title."""
    ax.set_title(f"({letter})", loc="left", fontweight="bold", x=x, pad=pad)
    ax.set_title(text, loc="center", pad=pad)


def draw_interface(ax, face):
    """(a) Heights in relief."""
    step = max(1, face.heights.shape[0] // 256)
    z = face.heights[::step, ::step]
    x = (np.arange(z.shape[1]) + 0.5) * step * face.finest.cell
    grid_x, grid_y = np.meshgrid(x, x[:z.shape[0]])
    shade = LightSource(azdeg=315, altdeg=40).shade(
        z, cmap=plt.get_cmap("cividis"), blend_mode="soft", vert_exag=0.12 * face.side / np.ptp(z),
        dx=x[1] - x[0], dy=x[1] - x[0])
    ax.plot_surface(grid_x, grid_y, z * 1e3, facecolors=shade, rcount=256, ccount=256,
                    linewidth=0, antialiased=False, shade=False)
    ax.set_box_aspect((1, 1, 0.22), zoom=1.25)
    ax.view_init(elev=38, azim=-60)
    ax.set_xlabel("x (m)", labelpad=-6)
    ax.set_ylabel("y (m)", labelpad=-6)
    ax.set_zlabel("height (mm)", labelpad=-8)
    ax.tick_params(pad=-3)
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_major_locator(ticker.MaxNLocator(3))
        axis.pane.set_edgecolor("#d9dee4")
        axis.pane.set_facecolor("white")
    ax.grid(False)


def draw_scheme(ax, face, rows, corner):
    """(b) One cut through the interface as each resolution sees it, and where it touches there."""
    coarse, n = face.step(rows[0]), corner[2]
    patch = cut_out(face.finest.pressure, corner, 1) > 0
    line = int(np.argmax(patch.reshape(n // coarse, coarse, n)[:, 0].sum(1))) * coarse
    finest = cut_out(face.heights, corner, 1)[line] * 1e3
    gap = 0.75 * np.ptp(finest)
    for i, row in enumerate(rows):
        step = face.step(row)
        z = finest[::step] - i * gap
        x = np.arange(len(z)) * row["cell_size_m"]
        touches = cut_out(face.pressure(row), corner, step)[line // step] > 0
        few = len(z) <= 20
        ax.plot(x, z, color=BLUE, marker="o" if few else None, markersize=2,
                linewidth=0.9 if few else 0.6)
        width = row["cell_size_m"] / 2
        for at, height in zip(x[touches], z[touches]):
            ax.plot([at - width, at + width], [height + 0.1 * gap] * 2, color=RED, linewidth=2.2,
                    solid_capstyle="butt")
        ax.annotate(f"r = {length(row['cell_size_m'])}", (1.02, z[-1]), fontsize=8, va="center",
                    xycoords=("axes fraction", "data"))
    ax.set_xlabel("x (m)")
    ax.set_xlim(-rows[0]["cell_size_m"] / 2, n * face.finest.cell)
    ax.xaxis.set_major_locator(ticker.MaxNLocator(4))
    ax.set_yticks([])
    ax.spines["left"].set_visible(False)
    low, high = ax.get_ylim()
    ax.set_ylim(low - 0.4 * gap, high + 0.6 * gap)
    bar = 10 ** math.floor(math.log10(0.4 * (high - low)))
    at = 0.01 * n * face.finest.cell
    low -= 0.3 * gap
    ax.plot([at, at], [low, low + bar], color=INK, linewidth=1.5)
    ax.annotate(f"{length(bar * 1e-3)}", (2.5 * at, low + bar / 2), fontsize=8, va="center")
    ax.plot([], [], color=RED, linewidth=2.2, label="contact at this resolution")
    ax.legend(loc="upper right", frameon=False, borderaxespad=0, handlelength=1.2)


def draw_domain(ax, face, row, corner, norm, letter, note=""):
    """(c, d, e) Cells in contact, by their pressure."""
    p = cut_out(face.pressure(row), corner, face.step(row)) * 1e-6
    extent = corner[2] * face.finest.cell
    image = ax.imshow(np.ma.masked_less_equal(p, 0), norm=norm, cmap="viridis_r", origin="lower",
                      extent=(0, extent, 0, extent), interpolation="nearest")
    ax.set_facecolor("#f2f4f6")
    for spine in ax.spines.values():
        spine.set_visible(True)
    name(ax, letter, f"r = {length(row['cell_size_m'])}", pad=14)
    ax.text(0.5, 1.02, f"$A_r$ = {100 * row['area_fraction']:.2f} % of $A_0$, "
            f"$p_r$ = {row['pressure_Pa'] * 1e-6:.0f} MPa", transform=ax.transAxes, ha="center",
            fontsize=8)
    ax.set_xlabel("x (m)" + note)
    ax.xaxis.set_major_locator(ticker.MaxNLocator(3))
    ax.yaxis.set_major_locator(ticker.MaxNLocator(3))
    return image


def draw_law(ax, face, key, scale, label, exponent, colour, text):
    """(f) One measure over the resolution, with the fitted power law."""
    r = np.array([row["cell_size_m"] for row in face.rows])
    y = np.array([row[key] for row in face.rows]) * scale
    fitted = np.array([row["fitted"] for row in face.rows])
    middle = np.exp(np.mean(np.log(r[fitted])))
    level = np.exp(np.mean(np.log(y[fitted])))
    line = np.array([r[fitted].min(), r[fitted].max()])
    ax.loglog(line * 1e3, level * (line / middle) ** exponent, color=colour, linewidth=1.2)
    ax.loglog(r[fitted] * 1e3, y[fitted], "o", color=colour, markersize=5)
    ax.loglog(r[~fitted] * 1e3, y[~fitted], "o", color=colour, markersize=5,
              markerfacecolor="white")
    ax.set_xlabel("resolution r (mm)")
    ax.set_ylabel(label)
    ax.set_xlim(0.7 * r.min() * 1e3, 1.4 * r.max() * 1e3)
    ax.xaxis.set_major_locator(ticker.FixedLocator(r * 1e3))
    ax.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:.3g}"))
    ax.xaxis.set_minor_locator(ticker.NullLocator())
    ax.yaxis.set_minor_formatter(ticker.NullFormatter())
    ax.yaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:.4g}"))
    if math.log10(y.max() / y.min()) < 1:
        ax.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 1.5, 2, 3, 4, 5, 6, 8)))
    ax.set_ylim(0.8 * y.min(), 1.25 * y.max())
    ax.grid(True, which="major", color="#e3e7eb", linewidth=0.5)
    ax.set_axisbelow(True)
    ax.text(0.05 if exponent > 0 else 0.95, 0.95, text, transform=ax.transAxes, va="top",
            ha="left" if exponent > 0 else "right", fontsize=8)


def draw(face):
    """The whole figure."""
    result, rows = face.result, face.rows
    shown = [rows[0], rows[len(rows) // 2], rows[-1]]
    coarse = face.step(rows[0])
    corner = window_of(face.finest.pressure, 4, coarse, face.finest.periodic)
    figure = plt.figure(figsize=(WIDTH, WIDTH * 7.8 / 7.2))
    ax = figure.add_axes((0.0, 0.675, 0.46, 0.295), projection="3d")
    draw_interface(ax, face)
    figure.text(0.02, 0.968, "(a)", fontweight="bold")
    figure.text(0.24, 0.968, "composite surface", ha="center")
    ax = figure.add_axes((0.53, 0.715, 0.34, 0.25))
    draw_scheme(ax, face, rows[:5], corner)
    name(ax, "b", "a cut, coarse to fine", -0.03)
    least = 1e-6 * rows[0]["pressure_Pa"] / 30
    norm = LogNorm(10 ** math.floor(math.log10(least)),
                   10 ** math.ceil(math.log10(1e-6 * result["max_pressure_Pa"])))
    for i, row in enumerate(shown):
        ax = figure.add_axes((0.075 + 0.285 * i, 0.375, 0.25, 0.25 * 7.2 / 7.8))
        note = f"\n$D_{{box}}$ = {result['d_box']:.2f} ± {result['d_box_error']:.2f}"
        image = draw_domain(ax, face, row, corner, norm, "cde"[i], note if i == 2 else "")
        if i == 0:
            ax.set_ylabel("y (m)")
        else:
            ax.set_yticklabels([])
    box = ax.get_position()
    bar = figure.colorbar(image, cax=figure.add_axes((0.905, box.y0, 0.014, box.height)))
    bar.set_label("pressure (MPa)", labelpad=2)
    bar.outline.set_linewidth(0.4)
    left = figure.add_axes((0.075, 0.055, 0.375, 0.205))
    right = figure.add_axes((0.56, 0.055, 0.375, 0.205))
    exponent = 2 - result["delta_s"]
    unit, scale = ("m²", 1.0) if rows[-1]["area_m2"] >= 0.1 else ("cm²", 1e4)
    draw_law(left, face, "area_m2", scale, f"real area $A_r$ ({unit})", exponent, BLUE,
             f"$A_r \\sim r^{{2-\\Delta_S}}$\n$\\Delta_S$ = {result['delta_s']:.2f} ± "
             f"{result['delta_s_error']:.2f}")
    draw_law(right, face, "pressure_Pa", 1e-6, "mean real pressure $p_r$ (MPa)", -exponent, RED,
             "$p_r \\sim r^{\\Delta_S-2}$\n$P = p_r A_r$ = "
             f"{result['load_N'] * 1e-6:.3g} MN")
    name(left, "f", "area and pressure over the resolution")
    right.set_title("open: the surface's cut-off, not fitted")
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("case", nargs="?", default=os.path.join(ROOT, "cases/contact/joint.yaml"))
    parser.add_argument("-o", "--output", default="figure1.png", help="picture to write")
    parser.add_argument("--coarsest", type=int, default=64, help="cells a side of the coarsest grid")
    parser.add_argument("--small", action="store_true", help="a PNG of 256 colours, for the documentation")
    parser.add_argument("--program", default=os.path.join(ROOT, "build/lacuna"))
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE",
                        help="override the case; may be repeated")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="lacuna-figure1-") as folder, \
            matplotlib.rc_context(STYLE):
        face = Interface(arguments, folder)
        save(draw(face), arguments.output, small=arguments.small)
    result = face.result
    print(f"Delta_S {result['delta_s']:.3f} +/- {result['delta_s_error']:.3f}, "
          f"D_box {result['d_box']:.3f} +/- {result['d_box_error']:.3f}")


if __name__ == "__main__":
    main()
