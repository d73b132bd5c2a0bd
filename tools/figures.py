# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tools that draw the paper's figures share: libraries, colours, style."""

import os
import sys

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    import xarray
except ImportError as missing:
    tool = os.path.splitext(os.path.basename(sys.argv[0]))[0]
    sys.exit(
        f"{tool}: {missing.name} is not installed for {sys.executable}; on Debian it comes with\n"
        "  tools/install-packages\n"
        f"and is seen by Debian's own interpreter: /usr/bin/python3 tools/{tool}.py ..."
    )

__all__ = ["BLUE", "GREEN", "INK", "QUIET", "RED", "ROOT", "SLIP", "STYLE", "matplotlib", "np", "plt",
           "xarray"]

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Okabe and Ito's colours, which the colour-blind tell apart.
INK, QUIET, BLUE, RED, GREEN = "#1d2733", "#6b7785", "#0072b2", "#d55e00", "#009e73"
SLIP = "#a9b0b8"  # grey, as in the paper; black sticks
STYLE = {
    "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "xtick.labelsize": 7,
    "ytick.labelsize": 7, "legend.fontsize": 7, "font.family": "DejaVu Sans",
    "axes.edgecolor": QUIET, "axes.labelcolor": INK, "text.color": INK, "xtick.color": QUIET,
    "ytick.color": QUIET, "xtick.labelcolor": INK, "ytick.labelcolor": INK,
    "axes.linewidth": 0.6, "lines.linewidth": 1.0, "axes.spines.top": False,
    "axes.spines.right": False, "savefig.dpi": 200,
}
