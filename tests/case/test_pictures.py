#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The notebook runs, and tools/lacuna_plot.py draws what a run holds and the paper's figures.

usage: test_pictures.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import base64
import io
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import matplotlib.image
import numpy

import report_scenes as scenes

PROGRAM, SOURCE, FOLDER = "", "", ""


def drawn(data):
    """Whether a picture (PNG) shows something."""
    return numpy.std(matplotlib.image.imread(io.BytesIO(data), format="png")[..., :3]) > 0.02


class Notebook(unittest.TestCase):
    path = "docs/notebook/joint.ipynb"

    def test_is_kept_without_results(self):
        with open(os.path.join(SOURCE, self.path), encoding="utf-8") as file:
            cells = json.load(file)["cells"]
        self.assertTrue(all(not cell.get("outputs") and cell.get("execution_count") is None for cell in cells))

    def test_runs(self):
        done = subprocess.run(
            [sys.executable, "-m", "nbconvert", "--to", "notebook", "--execute", "--output-dir", FOLDER, "--output", "done.ipynb",
             os.path.join(SOURCE, self.path)],
            env={**os.environ, "LACUNA": PROGRAM, "TMPDIR": FOLDER}, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(FOLDER, "done.ipynb"), encoding="utf-8") as file:
            outputs = [output for cell in json.load(file)["cells"] for output in cell.get("outputs", [])]
        pictures = [base64.b64decode(o["data"]["image/png"]) for o in outputs if "image/png" in o.get("data", {})]
        self.assertEqual(len(pictures), 4)
        self.assertTrue(all(drawn(picture) for picture in pictures))
        text = "".join("".join(output.get("text", "")) for output in outputs)
        self.assertIn("s from failure", text)
        self.assertIn("joint.html", text)


class Plots(unittest.TestCase):
    def plot(self, *words):
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "tools/lacuna_plot.py"), *words], capture_output=True, text=True,
                              check=False)
        return done.returncode, done.stdout.split(), done.stderr

    def test_runs(self):
        for name, text, figures in (("joint", scenes.JOINT, ["motion", "cells", "scales", "events", "solver"]),
                                    ("block", scenes.BLOCK, ["motion", "solver"])):
            path = os.path.join(FOLDER, name + ".nc")
            scenes.run(PROGRAM, text, path)
            status, made, wrong = self.plot(path, "-o", FOLDER, "--format", "png")
            self.assertEqual((status, wrong), (0, ""))
            self.assertEqual(made, [os.path.join(FOLDER, f"{name}-{figure}.png") for figure in figures])
            for picture in made:
                with open(picture, "rb") as file:
                    self.assertTrue(drawn(file.read()), picture)

    def test_paper(self):
        """Fig. 2 and 4 on small interfaces; 1 and 3 are of tools with tests of their own."""
        sys.path.insert(0, os.path.join(SOURCE, "tools"))
        import lacuna_plot

        for name, figure in (("2", lacuna_plot.figure2(PROGRAM, 6, FOLDER)), ("4", lacuna_plot.figure4(PROGRAM, True, FOLDER))):
            path = os.path.join(FOLDER, f"figure{name}.png")
            figure.savefig(path)
            with open(path, "rb") as file:
                self.assertTrue(drawn(file.read()), path)

    def test_refusals(self):
        text = os.path.join(FOLDER, "no.nc")
        with open(text, "w", encoding="utf-8") as file:
            file.write("no")
        for words in ((text,), (os.path.join(FOLDER, "nothing.nc"),), ("--paper", os.path.join(FOLDER, "nowhere")), ()):
            status, made, wrong = self.plot(*words)
            self.assertNotEqual((status, wrong), (0, ""), words)
            self.assertEqual(made, [])
            self.assertNotIn("Traceback", wrong)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    FOLDER = tempfile.mkdtemp(prefix="lacuna-pictures-")
    try:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
    finally:
        shutil.rmtree(FOLDER)
