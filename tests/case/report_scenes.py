# SPDX-License-Identifier: GPL-3.0-or-later
"""Small runs whose pages the tests look at, and how to read a page's data."""

import json
import re
import subprocess

JOINT = """lacuna: 1
title: A joint & its <b>page</b></script><script>alert(1)</script>
interface:
  size: "1 m"
  levels: 5
  surface: {self-affine: {hurst: 0.8, rms_slope: 0.1, seed: 1}}
material: {shear_modulus: "15 GPa", poisson: 0.25, shear_speed: "1 km/s"}
load:
  normal: {pressure: "200 MPa"}
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "4 um", v0: "1 um/s"}}
initial:
  slip_rate: "1 cm/week"
  state: {ratio_to_steady: 0.7}
  spread: {slip_rate: {lognormal: {sigma: 1, seed: 2}}}
transfer: {hierarchy: {stiffness: elastic}}
time: {end: "1 day"}
solver: {rtol: 1e-4}
analysis:
  rg: {rule: fix, field: equal, beta: 0.6, critical_fraction: 0.6}
  events: {slip_rate: "1 mm/s"}
output: {every: {steps: 2}, fields: [slip_rate, slip], fields_every: {per_decade: 2}}
"""

BLOCK = """lacuna: 1
title: A block
load:
  normal: {pressure: "3 MPa"}
  pore_pressure: [{constant: {value: "0.2 MPa"}}]
friction: {aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "5 mm", v0: "1 um/s"}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.5}}
time: {start: "2020-01-01", end: "200 day"}
"""

# Cells, but neither snapshots nor an analysis; and a run of few records that does not fail.
BARE = JOINT[:JOINT.index("analysis:")].replace("title:", "references: none\ntitle:")
BRIEF = BLOCK.replace("200 day", "1 s")


def run(program, text, path):
    """Runs a case into path (.nc); the case stands beside it."""
    case = path[:-3] + ".yaml"
    with open(case, "w", encoding="utf-8") as file:
        file.write(text)
    subprocess.run([program, "run", case, "-o", path, "--force", "-q"], check=True, stdout=subprocess.DEVNULL)


def report(program, *words):
    """What `lacuna report` does: its exit status, what it prints, what it complains of."""
    done = subprocess.run([program, "report", *words], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def data_of(path):
    """The data that a page holds."""
    with open(path, encoding="utf-8") as file:
        page = file.read()
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL).group(1))


def output(program, *words):
    """What a command prints."""
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout
