#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lays fits of the same readings beside each other: a table, which case the readings tell, a picture.

    tools/plot/plot_fits.py FIT.nc FIT.nc ... [-o FITS.png]

The files are those of `lacuna fit` with a column of friction, of cases that differ in one thing, such as the friction
law, and have the same ranges and priors. The odds are those of the evidence where all were sampled, else of the BIC,
exp of half its difference: of the best case against the next, if neither was the likelier before. Below 20 to 1 it
says "cannot tell", and where even the best case leaves more than noise it says so.
"""

import argparse
import math
import os
import re

# first: it says what is missing
from figures import COLOURS, INK, QUIET, np, open_file, panel, plt, save, stop, use_screen_style

TOLD = math.log(20)  # of the odds: strong evidence (Kass & Raftery 1995, J. Am. Stat. Assoc. 90, 773)


def name_of(path):
    return os.path.splitext(os.path.basename(path))[0]


class Fit:
    """A file of `lacuna fit`."""

    def __init__(self, path):
        with open_file(path, "best_friction", "observed_friction", "prediction_time", "reading_time") as data:
            self.name, self.bic = name_of(path), data.attrs["bic"]
            self.evidence = data.attrs.get("log_evidence", math.nan)
            self.error = data.attrs.get("log_evidence_error", math.nan)
            self.poor, self.rms = bool(data.attrs["fits_badly"]), data.attrs["rms_friction"]
            self.ranges = dict(re.findall(r"^    (?:friction\.\w+\.)?(\S+): (\{range.*)$", data.attrs["case"], re.MULTILINE))
            self.errors = re.search(r"^  errors: (\w+)", data.attrs["case"], re.MULTILINE)[1]
            self.time, self.read = data["reading_time"].values, data["observed_friction"].values
            self.clock, self.best = data["prediction_time"].values, data["best_friction"].values
            self.band = data["predicted_friction"].values[[0, -1]] if "predicted_friction" in data and math.isfinite(self.evidence) else None
        self.left = 1e3 * (self.read - np.interp(self.time, self.clock, self.best))

    def weight(self, sampled):
        """ln of how likely the readings are, up to what all fits have alike."""
        return self.evidence if sampled else -0.5 * self.bic


def verdict(fits):
    """What the readings tell, in a line or two."""
    sampled = all(math.isfinite(f.evidence) for f in fits)
    best, second = sorted(fits, key=lambda f: -f.weight(sampled))[:2]
    lead = best.weight(sampled) - second.weight(sampled)
    doubt = 2 * math.hypot(best.error, second.error) if sampled else 0.0
    odds = f"{math.exp(lead):.2g} to 1" if lead < 13.8 else "more than a million to 1"
    by = f"{best.name} before {second.name}, odds {odds} by the {'evidence' if sampled else 'BIC'}"
    text = f"cannot tell: {by}; below 20 to 1" if lead - doubt < TOLD else by
    return text + (f"\nno case fits: what {best.name} leaves is not noise; the odds only say which is less wrong" if best.poor else "")


def table(fits):
    print(f"{'fit':<24} {'ln evidence':<18} {'BIC':<10} {'rms':<10} residuals")
    for f in fits:
        evidence = f"{f.evidence:.2f} +- {f.error:.2f}" if math.isfinite(f.evidence) else "not sampled"
        print(f"{f.name:<24} {evidence:<18} {f.bic:<10.1f} {f.rms:<10.3g} "
              f"{'not noise' if f.poor else 'like noise'}")


def draw(fits, path):
    use_screen_style()
    figure, axes = plt.subplots(1 + len(fits), 1, figsize=(7.4, 3.0 + 1.1 * len(fits)), sharex=True, layout="constrained", dpi=130,
                                gridspec_kw={"height_ratios": [3] + [1.1] * len(fits)})
    axes[0].plot(fits[0].time, fits[0].read, "o", ms=2.5, color=QUIET, label="readings")
    most = max(np.abs(f.left).max() for f in fits)
    for k, f in enumerate(fits):
        colour = COLOURS[(0, 4, 2, 3)[k % 4]]
        axes[0].plot(f.clock, f.best, color=colour, lw=1.1, label=f.name)
        if f.band is not None:
            axes[0].fill_between(f.clock, *f.band, color=colour, alpha=0.25, lw=0)
        axes[k + 1].axhline(0, color=INK, lw=0.6)
        axes[k + 1].plot(f.time, f.left, "o", ms=2.5, color=colour)
        axes[k + 1].set(ylim=(-1.1 * most, 1.1 * most), ylabel="10⁻³")
        panel(axes[k + 1], "bcdefgh"[k], f"readings less {f.name}")
    axes[0].set_ylabel("friction coefficient")
    axes[0].legend()
    panel(axes[0], "a", "best fits; shaded: 90 % of the posterior" if any(f.band is not None for f in fits) else "best fits")
    axes[-1].set_xlabel("time (s)")
    save(figure, path, small=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("fits", metavar="FIT.nc", nargs="+")
    parser.add_argument("-o", "--output", metavar="FITS.png")
    options = parser.parse_args()
    fits = [Fit(path) for path in options.fits]
    if len(fits) < 2:
        stop("two fits at least are compared")
    for f in fits[1:]:
        if not (np.array_equal(f.read, fits[0].read) and np.array_equal(f.time, fits[0].time)):
            stop(f"{f.name}: its readings are not those of {fits[0].name}: their evidences cannot be compared")
        if f.errors != fits[0].errors:
            stop(f"{f.name}: its errors are {f.errors}, those of {fits[0].name} are {fits[0].errors}: say the same fit.errors for both")
        other = [key for key in f.ranges if key in fits[0].ranges and f.ranges[key] != fits[0].ranges[key]]
        if other:
            stop(f"{f.name}: the range or prior of {other[0]} is not that of {fits[0].name}: the odds would count that")
    table(fits)
    print(verdict(fits))
    if options.output:
        draw(fits, options.output)


if __name__ == "__main__":
    main()
