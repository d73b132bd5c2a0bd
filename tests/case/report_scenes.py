# SPDX-License-Identifier: GPL-3.0-or-later
"""Small runs whose pages the tests look at, and how to read a page's data."""

import datetime
import json
import os
import re
import subprocess

import netCDF4
import numpy

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
  rg: {slipping_strength: 0.8, critical_fraction: 0.6}
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

# A load that is taken back: some cells slip backwards then, others forwards.
TURNED = (JOINT[:JOINT.index("analysis:")] + JOINT[JOINT.index("output:"):]).replace(
    'v0: "1 um/s"', 'v0: "1 um/s", form: regularised').replace("rtol: 1e-4", "rtol: 1e-4, formulation: traction").replace(
    '"1 day"', '"2 min"').replace('"200 MPa"}', '"200 MPa"}\n  shear: [{step: {value: "-125 MPa", at: "1 min"}}]')

# Its load changes.
STEP = BLOCK.replace('constant: {value: "0.2 MPa"}', 'step: {value: "0.02 MPa", at: "1 day"}')

# A dated run beyond all dates.
FAR = BLOCK.replace("1 cm/week", "1e-20 m/s").replace("200 day", "1e6 year")

# A line in slabs whose every record keeps its cells.
LINE = """lacuna: 1
title: A line
interface: {shape: line, size: "16 km", cells_x: 60, domain: {full: {}}}
material: {shear_modulus: "30 GPa", shear_speed: "3 km/s"}
load:
  normal: {pressure: "50 MPa"}
  shear: [{back-slip: {rate: "1e-9 m/s"}}]
friction:
  aging: {f0: 0.6, a: 0.010, b: 0.015, dc: "16 mm", v0: "1 um/s", form: regularised}
initial:
  slip_rate: "1e-10 m/s"
  state: {ratio_to_steady: 0.5}
  spread: {slip_rate: {lognormal: {sigma: 0.1, seed: 1}}}
transfer: {elastic: {mode: antiplane, thickness: "8 km"}}
time: {end: "1000 year", failure: {mean_slip_rate: "1 cm/s"}}
output: {every: {per_decade: 10}, fields: [slip_rate, slip], fields_every: {per_decade: 20}}
"""

# What a block is fitted to: made-up readings of one, over a part of its life.
FIT = """fit:
  parameters:
    initial.slip_rate: {range: ["0.1 mm/day", "20 mm/day"]}
  time: date
  displacement: "move_mm:mm"
  starts: 1
  walkers: 8
  steps: 16
  burn: 8
  rounds: 1
"""


def fit(program, text, series, path, *words):
    """Fits a case to a series into path (.nc); the fitted case stands beside it (.yaml)."""
    case = path[:-3] + "-case.yaml"
    with open(case, "w", encoding="utf-8") as file:
        file.write(text + FIT)
    done = subprocess.run([program, "fit", case, series, "-o", path, "--force", "-q", *words], stdout=subprocess.DEVNULL,
                          stderr=subprocess.DEVNULL, check=False)
    assert done.returncode in (0, 1), done  # so short a chain may not have converged


def readings(path, time, slip):
    """Displacements of a dated run as a series: whole seconds since its start on 2020-01-01, mm past a zero of 7."""
    with open(path, "w", encoding="utf-8") as file:
        file.write("# made up\ndate,move_mm\n")
        for t, d in zip(time, slip):
            day, second = divmod(int(t), 86400)
            file.write(f"{datetime.date(2020, 1, 1) + datetime.timedelta(day)}T{second // 3600:02}:{second // 60 % 60:02}:{second % 60:02},{1e3 * d + 7:.9f}\n")


def forecasts(program, source, path, *words):
    """The forecasts of the made-up readings of a block, to path (.nc)."""
    series = os.path.join(source, "cases", "data", "creep.csv")
    subprocess.run([program, "precursors", series, "--displacement", "disp_mm:mm", "--rolling", "--issues", "20",
                    "--failed-at", "2020-08-12", "-o", path, "--force", *words], check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)


def driven(path):
    """Adds to a file of forecasts what drives the slope, the level and words, where the program has written none."""
    with netCDF4.Dataset(path, "a") as file:
        for name in [name for name in file.ncattrs() if name.startswith("verdict")]:
            file.delncattr(name)
        if "alarm_level" not in file.variables:
            level = file.createVariable("alarm_level", "i4", ("issue",))
            level.flag_values, level.flag_meanings = numpy.arange(4, dtype="i4"), "quiet watch warning alarm"
        n = file.dimensions["issue"].size
        file["alarm_level"][:] = numpy.minimum(3, numpy.arange(n) // 5)
        file.createDimension("driver_reading", 50)
        time = file.createVariable("driver_time", "f8", ("driver_reading",))
        time.units = file["reading_time"].units
        time[:] = file["reading_time"][0] + 86400 * numpy.arange(50)
        rain = file.createVariable("driver_rain", "f8", ("driver_reading",))
        rain.units, rain.long_name = "mm", "rain"
        rain[:] = numpy.where(numpy.arange(50) % 4 == 0, 3.5 * numpy.arange(50), 0)
        lake = file.createVariable("driver_lake", "f8", ("driver_reading",))
        lake.units, lake[:] = "m", 640 + numpy.arange(50) / 7
        file.verdict = "Alarm: <b>it</b> accelerates, and most methods agree."
        file.verdict_p = 0.25


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
