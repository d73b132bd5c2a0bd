# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tools that draw share: libraries, colours, style, units, files, calls of the program."""

import io
import json
import logging
import os
import re
import subprocess
import sys
from datetime import datetime, timezone

logging.getLogger("fontTools").setLevel(logging.ERROR)  # it says that PDF files have no date
TOOL = os.path.splitext(os.path.basename(sys.argv[0]))[0]

try:
    import matplotlib

    if "ipykernel" not in sys.modules:
        matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    import xarray
    from PIL import Image
except ImportError as missing:
    sys.exit(
        f"{TOOL}: {missing.name} is not installed for {sys.executable}; on Debian it comes with\n"
        "  tools/install-packages\n"
        f"and is seen by Debian's own interpreter: /usr/bin/python3 {sys.argv[0]} ..."
    )

__all__ = ["BLUE", "COLOURS", "DAY", "FAINT", "FAST", "GREEN", "INK", "LENGTHS", "QUIET", "RED", "ROOT", "SEEN",
           "SLIP", "SPANS", "STYLE", "TOOL", "WIDTH", "YEAR", "called", "date_ticks", "json_of", "length", "matplotlib", "np", "open_file",
           "panel", "parse_date", "plain_ticks", "plt", "save", "span", "start_of", "stop", "unit_of", "use_screen_style", "xarray"]

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
WIDTH = 174 / 25.4  # of two columns [in]
# Okabe and Ito's colours, which the colour-blind tell apart.
INK, QUIET, BLUE, RED, GREEN = "#1d2733", "#6b7785", "#0072b2", "#d55e00", "#009e73"
COLOURS = (BLUE, "#56b4e9", GREEN, "#e69f00", RED, "#cc79a7", "#000000", "#7f7f7f")
SLIP = "#a9b0b8"  # grey, as in the paper; black sticks
FAINT, SEEN, FAST = "#d9dee4", "#b3262e", "#c8761a"  # of pictures for the screen
STYLE = {  # for print: no letter is below 8 points
    "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "xtick.labelsize": 8,
    "ytick.labelsize": 8, "legend.fontsize": 8, "legend.title_fontsize": 8, "font.family": "DejaVu Sans",
    "axes.edgecolor": QUIET, "axes.labelcolor": INK, "text.color": INK, "xtick.color": QUIET,
    "ytick.color": QUIET, "xtick.labelcolor": INK, "ytick.labelcolor": INK,
    "axes.linewidth": 0.6, "lines.linewidth": 1.0, "axes.spines.top": False,
    "axes.spines.right": False, "legend.frameon": False, "savefig.dpi": 200,
    "pdf.fonttype": 42, "svg.hashsalt": "lacuna",  # letters that can be searched; the same file twice
}
DAY, YEAR = 86400.0, 31556926.0
LENGTHS = {"km": 1e3, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9}
SPANS = {"years": YEAR, "days": DAY, "h": 3600.0, "min": 60.0, "s": 1.0, "ms": 1e-3, "µs": 1e-6, "ns": 1e-9}


def use_screen_style():
    """For pictures of documentation and screen, a little larger than print."""
    plt.rcParams.update({
        "font.size": 9, "font.family": "DejaVu Sans", "text.color": INK, "axes.edgecolor": QUIET,
        "axes.labelcolor": INK, "axes.titlesize": 9, "axes.titleweight": "bold", "axes.titlelocation": "left",
        "axes.spines.top": False, "axes.spines.right": False, "xtick.color": QUIET, "ytick.color": QUIET,
        "xtick.labelcolor": INK, "ytick.labelcolor": INK, "legend.frameon": False, "legend.fontsize": 8,
    })


def stop(text):
    """One line that says what is wrong, and the end."""
    sys.exit(f"{TOOL}: {text}")


def open_file(path, *variables):
    """A netCDF file that must hold these variables; times stay the numbers that they are."""
    try:
        data = xarray.open_dataset(path, decode_times=False, decode_timedelta=False)
    except (OSError, ValueError) as wrong:
        reason = wrong.strerror if isinstance(wrong, OSError) and wrong.strerror else "no netCDF file"
        stop(f"{path}: {reason}")
    for name in variables:
        if name not in data:
            stop(f'{path}: no "{name}" in it')
    return data


def called(program, *words):
    """What a command of the program prints; the end, with what it says, where it fails."""
    try:
        done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    except OSError as wrong:
        stop(f"{program}: {wrong.strerror}; --program names another")
    if done.returncode != 0:
        said = done.stderr.strip().splitlines()
        stop(said[0] if said else f"{program} {words[0]} ended with status {done.returncode}")
    return done.stdout


def json_of(program, *words):
    """The JSON that a command prints."""
    return json.loads(called(program, *words, "--json"))


def unit_of(value, units, least=1.0):
    """Name and size of the largest unit of which the value is at least so many; the smallest if of none."""
    size = abs(value) if np.isfinite(value) else 1.0
    return next((u for u in units.items() if size >= least * u[1] * 0.9995), list(units.items())[-1])


def length(value, units=None):
    """A length in metres with the unit that reads best, of LENGTHS or of these."""
    name, size = unit_of(value, units or LENGTHS)
    return f"{value / size:.3g} {name}"


def span(value):
    """Seconds with the unit that reads best."""
    name, size = unit_of(value, SPANS)
    text = f"{value / size:.3g}"
    return f"{text} {name[:-1] if text == '1' and name.endswith('s') and len(name) > 2 else name}"


def parse_date(text):
    """A date in UTC; None where the text is none."""
    try:
        date = datetime.fromisoformat(text.strip().replace("Z", "+00:00"))
    except ValueError:
        return None
    return date.replace(tzinfo=timezone.utc) if date.tzinfo is None else date.astimezone(timezone.utc)


def start_of(run):
    """The date at which a run's file says that it starts; None where it has none."""
    since = re.match(r"seconds since (\S+)(?:[ T](\S+))?", run["time"].attrs.get("units", ""))
    return parse_date("T".join(filter(None, since.groups()))) if since else None


class _DateTicks(matplotlib.dates.ConciseDateFormatter):
    """At the axis' end the month too only where all ticks are of that month."""

    def format_ticks(self, values):
        labels = super().format_ticks(values)
        if len({date.month for date in matplotlib.dates.num2date(values)}) > 1:
            self.offset_string = self.offset_string.split("-")[0]
        return labels


def date_ticks(axis, least, most):
    """From `least` to `most` ticks at round dates."""
    locator = matplotlib.dates.AutoDateLocator(minticks=least, maxticks=most)
    axis.set_major_locator(locator)
    axis.set_major_formatter(_DateTicks(locator))


def panel(axes, letter, text="", **where):
    """A panel's letter, bold, and what it shows."""
    axes.set_title(rf"$\bf{{({letter})}}$  {text}", loc="left", **where)


def plain_ticks(axis):
    """Numbers instead of powers on a logarithmic axis that spans little."""
    low, high = axis.get_view_interval()
    if 0 < low < high < 100 * low:
        wide = high > 5 * low
        axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5) if wide else (1, 1.5, 2, 3, 4, 5, 6, 8), numticks=99))
        axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:.4g}"))
        axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def save_small(figure, path):
    """A PNG of 256 colours, a third of the size, for the documentation; Pillow comes with matplotlib."""
    data = io.BytesIO()
    figure.savefig(data, format="png")
    Image.open(data).convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, 2, dither=Image.Dither.NONE).save(path, optimize=True)


def save(figure, path, dpi=None, small=False):
    """Writes the figure and says where; of SVG and PDF without a date, so that it is the same twice."""
    undated = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
    try:
        if small and path.endswith(".png"):
            save_small(figure, path)
        else:
            figure.savefig(path, dpi=dpi or plt.rcParams["savefig.dpi"], metadata=undated.get(os.path.splitext(path)[1]))
    except OSError as wrong:
        stop(f"{path}: {wrong.strerror}")
    except ValueError as wrong:  # a suffix that names no format
        stop(f"{path}: {str(wrong).splitlines()[0]}")
    plt.close(figure)
    print(path)
