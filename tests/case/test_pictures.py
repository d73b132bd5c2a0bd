#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebooks hold what they give, and tools/plot/lacuna_plot.py draws what a run holds and the paper's figures.

usage: test_pictures.py PROGRAM SOURCE_FOLDER LIBRARY [unittest options]
"""

import base64
import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import matplotlib.image
import matplotlib.text
import numpy

import report_scenes as scenes

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
import run_notebook  # noqa: E402

PROGRAM, SOURCE, LIBRARY, FOLDER = "", "", "", ""
SERIES = "time (s),disp (mm)\n" + "".join(f"{100000 * k},{0.002 * 1.08**k:.6f}\n" for k in range(60))


def drawn(data):
    """Whether a picture (PNG) shows something."""
    return numpy.std(matplotlib.image.imread(io.BytesIO(data), format="png")[..., :3]) > 0.02


def words_of(figure):
    """All texts of a figure that show."""
    return [t for t in figure.findobj(matplotlib.text.Text) if t.get_visible() and t.get_text().strip()]


class Notebook(unittest.TestCase):
    """Each runs, and holds what its cells give."""

    def check(self, name, pictures):
        path = os.path.join(SOURCE, "docs", "notebook", name)
        self.assertLess(os.path.getsize(path), 400000)
        with open(path, encoding="utf-8") as file:
            held = json.load(file)
        given = run_notebook.run(PROGRAM, LIBRARY, path)
        self.assertEqual(run_notebook.differences(held, given), [])
        for notebook in held, given:
            outputs = [output for cell in notebook["cells"] for output in cell.get("outputs", [])]
            self.assertFalse([o for o in outputs if o.get("name") == "stderr" or o["output_type"] == "error"])
            drawings = [base64.b64decode(o["data"]["image/png"]) for o in outputs if "image/png" in o.get("data", {})]
            self.assertEqual(len(drawings), pictures)
            self.assertTrue(all(map(drawn, drawings)))
        return held, given

    def test_joint(self):
        self.check("joint.ipynb", 6)

    def test_sweep(self):
        held, given = self.check("sweep.ipynb", 3)
        # what is not of the code is seen: another number, another word, an output too few
        cell = next(c for c in held["cells"] if "fails after" in str(c.get("outputs")))
        text = cell["outputs"][0]["text"]
        for wrong in (text.replace("fails after 3", "fails after 4"), text.replace("day", "week")):
            cell["outputs"][0]["text"] = wrong
            self.assertEqual(len(run_notebook.differences(held, given)), 1)
        cell["outputs"] = []
        self.assertEqual(len(run_notebook.differences(held, given)), 1)


class Plots(unittest.TestCase):
    """What is drawn against the file and the page; figures are those of the module, looked into."""

    @classmethod
    def setUpClass(cls):
        sys.path.insert(0, os.path.join(SOURCE, "tools", "plot"))
        import lacuna_plot
        from figures import STYLE, plt

        plt.rcParams.update(STYLE)
        cls.plot, cls.close = lacuna_plot, plt.close
        cls.paths = {}
        for name, text in (("joint", scenes.JOINT), ("block", scenes.BLOCK), ("bare", scenes.BARE), ("brief", scenes.BRIEF),
                           ("line", scenes.LINE), ("calm", scenes.LINE.replace("1000 year", "1 year"))):
            cls.paths[name] = os.path.join(FOLDER, name + ".nc")
            scenes.run(PROGRAM, text, cls.paths[name])

    def tearDown(self):
        type(self).close("all")

    def opened(self, name):
        run = self.plot.open_run(self.paths[name])
        self.addCleanup(run.close)
        return run

    def check(self, figure, letters):
        """Panel letters, labels with units, no letter below 8 points, none beyond the edge or on another's tick label."""
        figure.canvas.draw()
        renderer = figure.canvas.get_renderer()
        for text in words_of(figure):
            self.assertGreaterEqual(text.get_fontsize(), 8, text.get_text())
            box = text.get_window_extent(renderer)
            inside = box.x0 > -2 and box.y0 > -2 and box.x1 < figure.bbox.x1 + 2 and box.y1 < figure.bbox.y1 + 2
            self.assertTrue(inside or not text.axes or text in text.axes.get_xticklabels() + text.axes.get_yticklabels(), text.get_text())
        found = [re.search(r"\{\((\w)\)\}", ax.get_title(loc="left")).group(1) for ax in figure.axes if ax.get_title(loc="left")]
        self.assertEqual("".join(found), letters)
        for ax in figure.axes:
            low, high = sorted(ax.get_xlim())
            boxes = [label.get_window_extent(renderer) for tick, label in zip(ax.get_xticks(), ax.get_xticklabels())
                     if label.get_text() and low <= tick <= high]
            for one, other in zip(boxes, boxes[1:]):
                self.assertFalse(one.overlaps(other), ax.get_xlabel())

    def test_motion(self):
        run = self.opened("joint")
        page = self.plot.page_of(PROGRAM, self.paths["joint"])
        figure = self.plot.motion(run, page)
        self.check(figure, "abc")
        creep, rate, inverse = figure.axes
        self.assertEqual(creep.get_ylabel(), "mean slip (µm)")
        line = next(one for one in creep.lines if one.get_label() == "run")
        numpy.testing.assert_allclose(line.get_ydata(), run["slip"].values * 1e6)
        line = next(one for one in rate.lines if one.get_label() == "mean")
        numpy.testing.assert_array_equal(line.get_ydata(), run["slip_rate"].values[:-1])
        self.assertEqual(inverse.get_ylabel(), "inverse rate (year/m)")
        # the window of failure is that of the page at the issue with a fiftieth left
        found = page["forecasts"]
        last = self.plot.seconds_of(run)[-1]
        issue = [i for i, rows in enumerate(found["forecast"]) if any(row[0] for row in rows)
                 and last - found["issue"][i] > (last - found["issue"][0]) / 50][-1]
        rows = [row for row, method in zip(found["forecast"][issue], found["methods"]) if row[0] and not method["baseline"]]
        low, high = min(row[2] or 0 for row in rows), max(row[5] for row in rows)
        edges = inverse.patches[0].get_extents().transformed(inverse.transData.inverted())
        self.assertAlmostEqual(60 * edges.x0, found["issue"][issue] + low, 3)
        self.assertAlmostEqual(60 * edges.x1, min(found["issue"][issue] + high, 1.03 * last), 3)
        without = self.plot.motion(run)
        self.assertFalse(without.axes[2].patches)
        self.check(without, "abc")

    def test_forecasts(self):
        run = self.opened("joint")
        page = self.plot.page_of(PROGRAM, self.paths["joint"])
        figure = self.plot.forecasts(run, page)
        self.check(figure, "ab")
        found = page["forecasts"]
        issued = {method["name"]: sum(rows[m][0] for rows in found["forecast"]) for m, method in enumerate(found["methods"])
                  if not method["baseline"]}
        for line in figure.axes[0].lines[:-1]:
            self.assertLessEqual(numpy.isfinite(line.get_ydata()).sum(), issued[line.get_label()])
        truth = figure.axes[0].lines[-1]
        numpy.testing.assert_array_equal(truth.get_xdata(), truth.get_ydata())
        self.assertEqual([t.get_text() for t in figure.axes[1].get_yticklabels()], [m["name"] for m in found["methods"]])
        with unittest.mock.patch("plot_forecasts.span", return_value="3.62 days"):  # as wide as it gets
            self.check(self.plot.forecasts(run, page), "ab")

    def test_dates(self):
        """The month stands at the end of an axis only where it is that of all ticks."""
        from datetime import datetime
        from figures import date_ticks, plt

        for last, words in ((datetime(2024, 3, 9), "2024"), (datetime(2024, 1, 9), "2024-Jan"), (datetime(2025, 3, 9), "")):
            figure, axes = plt.subplots()
            axes.set_xlim(datetime(2024, 1, 1), last)
            date_ticks(axes.xaxis, 3, 5)
            figure.canvas.draw()
            self.assertEqual(axes.xaxis.get_offset_text().get_text(), words, last)

    def test_readings(self):
        path = os.path.join(FOLDER, "a series of a name as long as those of monitoring are.csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write(SERIES)
        run = self.opened("block")
        words = ("--compare", path, "--time-format", "s", "--displacement", "disp (mm):mm")
        page = self.plot.page_of(PROGRAM, self.paths["block"], *words)
        self.assertEqual(page["series"]["readings"], 60)
        figure = self.plot.motion(run, {"series": page["series"]})
        self.check(figure, "abc")
        for ax in figure.axes[:2]:
            box = ax.get_legend().get_window_extent()
            self.assertTrue(ax.bbox.x0 - 2 < box.x0 and box.x1 < ax.bbox.x1 + 2, box)
        seen = next(line for line in figure.axes[0].lines if line.get_label() == "readings")
        self.assertGreater(seen.get_ydata().min(), figure.axes[0].get_ylim()[0])
        time = numpy.array([100000.0 * k for k in range(60)])
        value = numpy.array([0.002 * 1.08**k for k in range(60)]) - 1e3 * (page["series"]["offset"] or 0)
        kept = time <= 1.03 * self.plot.seconds_of(run)[-1]
        unit = {"µm": 1e3, "mm": 1, "cm": 0.1, "m": 1e-3}[figure.axes[0].get_ylabel().split("(")[1].rstrip(")")]
        numpy.testing.assert_allclose(seen.get_ydata(), value[kept] * unit, atol=1e-3 * abs(value[kept] * unit).max())

    def test_cells(self):
        run = self.opened("joint")
        figure = self.plot.cells(run)
        self.check(figure, "abcd")
        maps = [ax for ax in figure.axes if ax.images]
        self.assertEqual(len(maps), 8)
        for ax in maps:
            self.assertEqual(numpy.isfinite(ax.images[0].get_array().filled(numpy.nan)).sum(), run.sizes["cell"])
        last = maps[3].images[0].get_array()
        self.assertEqual(last.max(), run["cell_slip_rate"].values[-1].max())
        slips = maps[7].images[0].get_array()
        self.assertEqual((slips == 1).sum(), (run["cell_slip_rate"].values[-1] > 10 * run["slip_rate"].values[0]).sum())
        for count in (1, 6):
            self.check(self.plot.cells(run, count=count), "abcdef"[:count])

    def test_cells_of_a_line(self):
        """Place and time: each record's cells at the time that they had, and time goes up."""
        for name, label in (("line", "time before failure (s)"), ("calm", "time (days)")):
            run = self.opened(name)
            figure = self.plot.cells(run)
            self.check(figure, "ab")
            rates, states = (ax.collections[0].get_array().reshape(run.sizes["snapshot"], -1) for ax in figure.axes[:2])
            numpy.testing.assert_array_equal(rates, run["cell_slip_rate"].values)
            numpy.testing.assert_array_equal(states == 1, rates > 10 * run["slip_rate"].values[0])
            axes = figure.axes[0]
            self.assertEqual(axes.get_ylabel(), label)
            upright = axes.collections[0].get_coordinates()[:, 0, 1]
            at = run["snapshot_time"].values
            left = run["time"].values[-1] - at
            for k in range(1, len(at) - 1):
                value = at[k] / 86400 if name == "calm" else left[k]
                self.assertTrue(min(upright[k:k + 2]) <= value <= max(upright[k:k + 2]), (name, k))
            places = axes.transData.transform([(0, upright[0]), (0, upright[-1])])[:, 1]
            self.assertLess(*places)

    def test_scales_and_events(self):
        run = self.opened("joint")
        page = self.plot.page_of(PROGRAM, self.paths["joint"])
        figure = self.plot.scales(run)
        self.check(figure, "abc")
        end = (run["n_slip"] / run["n_tot"]).values[-1]
        marks = [line for line in figure.axes[2].lines if line.get_marker() == "o"]
        numpy.testing.assert_allclose([m.get_xydata()[0] for m in marks], [(end[k], end[k + 1]) for k in range(len(marks))])
        points = [line for line in figure.axes[2].lines if "C" in str(line.get_label())]
        self.assertEqual([p.get_xdata()[0] for p in points], [0.6, float(run["run_critical_fraction"])])
        figure = self.plot.events(run, page)
        self.check(figure, "ab")
        counts, law = figure.axes[1].lines
        self.assertEqual(counts.get_ydata()[-1], run.sizes["event"])
        moments = run["event_moment"].values
        for x, y in counts.get_xydata()[::50]:
            self.assertEqual((moments >= x).sum(), y)
        slope = numpy.diff(numpy.log10(law.get_ydata())) / numpy.diff(numpy.log10(law.get_xdata()))
        self.assertAlmostEqual(-1.5 * slope[0], page["events"]["b_value"]["b"], 6)

    def test_solver(self):
        for name in ("joint", "block", "bare", "brief"):
            run = self.opened(name)
            self.check(self.plot.solver(run), "abc")
            self.check(self.plot.motion(run), "abc")

    def command(self, *words):
        """The tool as called, in this process: its exit status, what it prints, what it complains of."""
        out, wrong, status = io.StringIO(), io.StringIO(), 0
        before, sys.argv = sys.argv, ["lacuna_plot.py", "--program", PROGRAM, *words]
        try:
            with contextlib.redirect_stdout(out), contextlib.redirect_stderr(wrong):
                self.plot.main()
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 1
            wrong.write("" if isinstance(end.code, int) else f"{end.code}\n")
        finally:
            sys.argv = before
        return status, out.getvalue().split(), wrong.getvalue()

    def test_as_a_program(self):
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tools/plot/lacuna_plot.py"), "--program", PROGRAM, self.paths["brief"], "-o",
                               FOLDER], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.split(), [os.path.join(FOLDER, f"brief-{name}.pdf") for name in ("motion", "solver")])

    def test_files(self):
        everything = ["motion", "forecasts", "cells", "scales", "events", "solver"]
        for name, suffix, start, figures, words in (
                ("joint", "pdf", b"%PDF", everything, ()), ("joint", "svg", b"<?xml", everything[:1] + everything[2:], ("--no-forecasts",)),
                ("block", "png", b"\x89PNG", ["motion", "forecasts", "solver"], ()), ("brief", "png", b"\x89PNG", ["motion", "solver"], ())):
            status, made, wrong = self.command(self.paths[name], "-o", FOLDER, "--format", suffix, *words)
            self.assertEqual((status, wrong), (0, ""))
            self.assertEqual(made, [os.path.join(FOLDER, f"{name}-{figure}.{suffix}") for figure in figures])
            for picture in made:
                with open(picture, "rb") as file:
                    data = file.read()
                self.assertTrue(data.startswith(start), picture)
                self.assertTrue(suffix != "png" or drawn(data), picture)

    def test_paper(self):
        """Fig. 2 and 4 on small interfaces; 1 and 3 are of tools with tests of their own."""
        import paper_figures

        figure = paper_figures.figure2(PROGRAM, 7, FOLDER)
        self.check(figure, "abcdef")
        parts = [ax.images[0].get_array().mean() for ax in figure.axes[:3]]
        self.assertEqual(parts, sorted(parts))
        for part, mega in zip(parts, paper_figures.PRESSURES):
            said = json.loads(scenes.output(PROGRAM, "contact", os.path.join(SOURCE, "cases/contact/joint.yaml"), "--json", "-o",
                                            os.path.join(FOLDER, "p.nc"), "--force", *paper_figures.settings(
                                                *paper_figures.SPECIMEN, "interface.levels=7", f"load.normal.pressure={mega} MPa")))
            self.assertAlmostEqual(part, said["contact_fraction"], 12)
        figure = paper_figures.figure4(PROGRAM, True, FOLDER)
        self.check(figure, "abcd")
        curves = {line.get_label(): line.get_ydata() for line in figure.axes[0].lines if line.get_label().endswith("cm")}
        self.assertAlmostEqual(curves["10 cm"].max() / curves["5 cm"].max(), 2**-0.23, 2)  # eq. 3 with the paper's 1.77
        fit = next(line for line in figure.axes[2].lines if "Bandis" in line.get_label())
        self.assertAlmostEqual(fit.get_ydata()[-1], 8 ** (1.61 - 2), 9)

    def test_refusals(self):
        text, blind = os.path.join(FOLDER, "no.nc"), self.paths["block"]
        with open(text, "w", encoding="utf-8") as file:
            file.write("no")
        for words, expected in (
                ((text,), "no netCDF file"), ((os.path.join(FOLDER, "nothing.nc"),), "No such file"),
                (("--paper", os.path.join(FOLDER, "nowhere")), "no such folder"), ((), "either RUN.nc or --paper"),
                ((blind, "--snapshots", "0"), "must be from 1 to 6"), ((blind, "--compare", os.path.join(FOLDER, "no.csv")), "no.csv"),
                ((blind, "--program", os.path.join(FOLDER, "none")), "--program names another")):
            status, made, wrong = self.command(*words)
            self.assertNotEqual(status, 0, words)
            self.assertEqual(made, [])
            self.assertIn(expected, wrong)
            self.assertTrue(words == () or len(wrong.splitlines()) == 1 or "usage" in wrong, wrong)


if __name__ == "__main__":
    PROGRAM, SOURCE, LIBRARY = map(os.path.abspath, sys.argv[1:4])
    FOLDER = tempfile.mkdtemp(prefix="lacuna-pictures-")
    try:
        unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
    finally:
        shutil.rmtree(FOLDER)
