#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the 240 runs of docs/howto-sweep.md: time of failure over size, a colour a roughness.

    roughness_and_size.py STUDY.nc docs/images/roughness-and-size.png
"""

import sys

import matplotlib.pyplot as plt
import netCDF4
import numpy

DAY = 86400.0


def main(source, picture):
    with netCDF4.Dataset(source) as file:
        size, rms, time = (file[name][:].filled(numpy.nan) for name in
                           ("interface_size", "interface_surface_self_affine_rms_height", "failure_time"))
    figure, axes = plt.subplots(figsize=(7, 4.2), dpi=130)
    heights, never = numpy.unique(rms), 1.6 * numpy.nanmax(time) / DAY
    for k, height in enumerate(heights):
        of, colour = rms == height, plt.cm.viridis(k / len(heights))
        x = size[of] * 1.06 ** (k - (len(heights) - 1) / 2)  # beside one another
        axes.plot(x, numpy.where(numpy.isnan(time[of]), never, time[of] / DAY), "o", ms=4, alpha=0.7, color=colour, label=f"{100 * height:g} cm rms")
    axes.axhline(never, color="0.8", lw=8, zorder=0)
    axes.text(1100, never, "never (3 years)", va="center", ha="right", fontsize=8)
    axes.set(xscale="log", yscale="log", xlabel="size of the joint (m)", ylabel="time of failure (days)")
    axes.set_xticks(numpy.unique(size), [f"{s:g}" for s in numpy.unique(size)], minor=False)
    axes.set_yticks([20, 50, 100, 200, 500], ["20", "50", "100", "200", "500"], minor=False)
    axes.minorticks_off()
    axes.legend(frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(picture, metadata={"Software": None})


if __name__ == "__main__":
    main(*sys.argv[1:3])
