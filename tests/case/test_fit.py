#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna fit` from the case to the files.

usage: test_fit.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import netCDF4
import numpy
import xarray

PROGRAM, SOURCE = "", ""
CASE, SERIES = "cases/fit/block.yaml", "cases/data/creep.csv"
CENTURY, PRISM = "cases/fit/century.yaml", "cases/data/century_prism_31-2008.csv"
CHAMBON = "/work/shared/data/monitoring/chambon_2015_C15.csv"  # may not be shipped
SHORT = ["--set", "fit.starts=8", "--set", "fit.burn=20", "--set", "fit.steps=30",
         "--set", "fit.walkers=16", "--set", "fit.rounds=0"]
BEST = ["--set", "fit.steps=0", "--set", "fit.starts=8"]

SLID = """lacuna: 1
load: {normal: {pressure: "3 MPa"}}
material: {shear_modulus: "4 GPa", poisson: 0.25, density: "2500 kg/m3"}
friction: {aging: {f0: 0.4, a: 0.010, b: 0.0135, dc: "30 cm", v0: "1 cm/week"}}
initial: {slip_rate: "1 cm/week", state: {ratio_to_steady: 0.5}}
time: {start: "1963-05-15T00:00:00Z", end: "2 year"}
fit:
  parameters:
    friction.aging.dc: {range: ["1 cm", "10 m"]}
    initial.slip_rate: {range: ["0.1 mm/day", "10 mm/day"]}
    initial.state.ratio_to_steady: {range: [0.05, 0.999]}
  time: date
  velocity: "rate_cm_per_day:cm/day"
"""


class Fit(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.out = os.path.join(self.folder, "out.nc")

    def tearDown(self):
        shutil.rmtree(self.folder)

    def run_program(self, *args, status=0):
        done = subprocess.run([PROGRAM, *args], cwd=SOURCE, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def fit(self, case, series, *args, status=0):
        done = self.run_program("fit", case, series, "-o", self.out, "--force", "--json", *args,
                                status=status)
        return json.loads(done.stdout) if done.stdout else done.stderr

    def test_files(self):
        """What JSON says stands in the file; the fitted case runs and is as far from the readings."""
        said = self.fit(CASE, SERIES, *SHORT, status=1)
        with netCDF4.Dataset(self.out) as file:
            file.set_auto_mask(False)
            draws = file["friction_aging_dc"][:]
            self.assertEqual(draws.shape, (16, 30))
            quantiles = numpy.quantile(draws, [0.05, 0.25, 0.5, 0.75, 0.95])
            dc = said["parameters"][0]
            self.assertEqual(dc["key"], "friction.aging.dc")
            numpy.testing.assert_allclose(quantiles[[0, 4]], dc["interval90"], rtol=1e-12)
            numpy.testing.assert_allclose(quantiles[2], dc["median"], rtol=1e-12)
            failures = file["failure_time"][:]
            failures = numpy.where(failures > 1e30, numpy.inf, failures)
            self.assertAlmostEqual(numpy.quantile(failures, 0.5) / said["tc_s"], 1.0, places=9)
            self.assertEqual(file.status, "complete")
            self.assertEqual(file.dimensions["reading"].size, 47)
            spread = file["predicted_displacement"][:]
            self.assertTrue(numpy.all(numpy.diff(spread[:, :100], axis=0) >= 0))
        subprocess.run([sys.executable, os.path.join(SOURCE, "tests/support/check_cf.py"), "--status",
                        "complete", self.out], check=True)
        self.assertEqual(said["case_output"], os.path.join(self.folder, "out.yaml"))
        done = self.run_program("run", said["case_output"], "--json", "-o",
                                os.path.join(self.folder, "run.nc"))
        run = json.loads(done.stdout)
        # the run's records are joined by straight lines
        self.assertAlmostEqual(run["compare"][0]["slip_rms_m"] / said["rms_m"], 1.0, places=1)
        self.assertAlmostEqual(run["failure_time_s"] / said["best_failure_time_s"], 1.0, places=3)

    def test_groups(self):
        """The file as ArviZ reads it: groups, dimensions and names of InferenceData, the values those of the plain variables;
        what the posterior predicts scatters about the readings as these do; LOO's input is the likelihood."""
        for errors in ("white", "ar1"):
            said = self.fit(CASE, SERIES, *SHORT, "--set", "fit.steps=80", "--set", "fit.errors=" + errors, status=1)
            groups = {}
            for name in ("posterior", "sample_stats", "observed_data", "posterior_predictive", "log_likelihood"):
                groups[name] = xarray.open_dataset(self.out, group=name)
            posterior, stats = groups["posterior"], groups["sample_stats"]
            with netCDF4.Dataset(self.out) as file:
                file.set_auto_mask(False)
                self.assertEqual(set(file.groups), set(groups))
                keys = [p["key"].replace(".", "_") for p in said["parameters"]]
                self.assertEqual(sorted(posterior.data_vars), sorted(keys))
                for key in keys:
                    self.assertEqual(posterior[key].dims, ("chain", "draw"))
                    self.assertEqual(posterior[key].values.tobytes(), file[key][:].tobytes())
                    self.assertEqual(posterior[key].attrs["units"], file[key].units)
                self.assertEqual(stats["lp"].values.tobytes(), file["log_posterior"][:].tobytes())
                numpy.testing.assert_allclose(stats["accepted"].mean("draw"), file["acceptance"][:])
                numpy.testing.assert_array_equal(groups["observed_data"]["displacement"], file["observed_displacement"][:])
                self.assertEqual(file["posterior"].dimensions["chain"].size, 16)
            for name in ("posterior", "sample_stats"):
                numpy.testing.assert_array_equal(groups[name]["chain"], range(16))
                numpy.testing.assert_array_equal(groups[name]["draw"], range(80))
            told, likely = groups["posterior_predictive"]["displacement"], groups["log_likelihood"]["displacement"]
            self.assertEqual((told.dims, likely.dims), (("chain", "draw", "reading"),) * 2)
            self.assertEqual(told.shape, (1, 1000, 47))
            read = groups["observed_data"]["displacement"]
            below = (told.squeeze("chain") < read).mean("draw").values
            self.assertTrue(0.3 < below.mean() < 0.7 and below.min() < 0.2 and below.max() > 0.8, below)
            error = {p["key"]: p for p in said["parameters"]}["error.displacement"]["median"]
            self.assertAlmostEqual(float(told.std("draw").median()) / error, 1, delta=0.35)
            # 47 normal readings: -n/2 (1 + ln 2 pi s^2) at the best fit, less half of what each parameter takes
            total = float(likely.sum("reading").mean())
            self.assertAlmostEqual(total, said["log_likelihood"], delta=12)
            if errors == "white":
                normal = -0.5 * 47 * (1 + numpy.log(2 * numpy.pi * error ** 2))
                self.assertAlmostEqual(total, normal, delta=5)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_truth(self):
        """Rate, errors and time of failure of the made-up readings are within the intervals."""
        said = self.fit(CASE, SERIES, "--set", "fit.walkers=32", "--set", "fit.steps=300", "--set",
                        "fit.burn=150", "--set", "fit.starts=8", "--set", "fit.rounds=0", status=1)
        by = {p["key"]: p for p in said["parameters"]}
        low, high = by["initial.slip_rate"]["interval90"]
        self.assertTrue(low < 3e-3 / 86400 < high)
        low, high = by["error.displacement"]["interval90"]
        self.assertTrue(low < 1e-3 < high)
        low, high = said["shape"]["interval90_1_m"]
        self.assertTrue(low < 1.35 / 0.12 * (1 - 0.6 ** 0.35) < high)
        self.assertTrue(said["interval90_s"][0] < 102.72 * 86400 < said["interval90_s"][1])
        self.assertFalse(said["fits_badly"])
        self.assertEqual(by["friction.aging.dc"]["derivatives"], "sensitivities")

    def test_the_end_of_a_range_is_told(self):
        """The readings were made with dc 12 cm: where 30 cm to 3 m are allowed the best stands at the lower end."""
        words = ["--set", "fit.steps=0", "--set", "fit.starts=8", "--set",
                 "fit.parameters={friction.aging.dc: {range: [30 cm, 3 m]}, initial.slip_rate: {range: "
                 "[0.3 mm/day, 3 cm/day]}}", "--set", "friction.aging.dc=60 cm"]
        said = {p["key"]: p for p in self.fit(CASE, SERIES, *words)["parameters"]}
        self.assertEqual(said["friction.aging.dc"]["at_end_of_range"], "low")
        self.assertAlmostEqual(said["friction.aging.dc"]["end_of_range"], 0.3, places=12)
        self.assertAlmostEqual(said["friction.aging.dc"]["best"], 0.3, delta=0.01)
        self.assertIsNone(said["initial.slip_rate"]["at_end_of_range"])
        self.assertIsNone(said["initial.slip_rate"]["end_of_range"])
        with netCDF4.Dataset(self.out) as file:
            self.assertAlmostEqual(file["friction_aging_dc"].best_fit_at_end_of_range, 0.3, places=12)
            self.assertNotIn("best_fit_at_end_of_range", file["initial_slip_rate"].ncattrs())
        text = self.run_program("fit", CASE, SERIES, "-o", self.out, "--force", *words).stdout
        self.assertRegex(text, r"at its end +the best fit of friction.aging.dc stands at the lower end of its range, "
                               r"30 cm")
        self.assertEqual(text.count("at its end"), 1)
        forecast = next(f for f in json.loads(self.run_program(
            "precursors", SERIES, "--case", CASE, "--onset", "5,20", "--json", *words).stdout)["forecasts"]
                        if f["method"] == "case")
        self.assertEqual(forecast["at_end_of_range"], ["friction.aging.dc"])
        inside = self.fit(CASE, SERIES, *BEST)
        self.assertEqual([p["at_end_of_range"] for p in inside["parameters"]], [None] * len(inside["parameters"]))

    def test_columns(self):
        """Options name the columns in place of the case, which is written so; times have a format."""
        other = os.path.join(self.folder, "other.csv")
        with open(os.path.join(SOURCE, SERIES), encoding="utf-8") as file:
            rows = [line.strip().split(",") for line in file if line[0] not in "#d"]
        with open(other, "w", encoding="utf-8") as file:
            file.write("d'x [cm],when\n")
            for date, reading in rows:
                day = date[8:10] + "/" + date[5:7] + "/" + date[:4] + date[10:].replace("T", " ")
                file.write(f"{0.1 * float(reading):.9g},{day}\n")
        told = ["--time", "when", "--displacement", "d'x [cm]:cm", "--time-format", "%d/%m/%Y %H:%M"]
        same = self.fit(CASE, SERIES, *BEST)
        said = self.fit(CASE, other, *BEST, *told)
        self.assertAlmostEqual(said["rms_m"] / same["rms_m"], 1.0, places=6)
        again = self.fit(said["case_output"], other, "--set", "fit.starts=1", "-o",
                         os.path.join(self.folder, "again.nc"))
        self.assertAlmostEqual(again["rms_m"] / same["rms_m"], 1.0, places=4)
        self.assertIn("fit.displacement", self.fit(CASE, SERIES, "--displacement", "disp_mm:s",
                                                   status=2))

    def test_readings_that_fall(self):
        """Settlement, or a line of sight from above: no joint's slip does that, which is said."""
        falling, reset = (os.path.join(self.folder, name) for name in ("falling.csv", "reset.csv"))
        with open(os.path.join(SOURCE, SERIES), encoding="utf-8") as rows, open(falling, "w", encoding="utf-8") as out, \
                open(reset, "w", encoding="utf-8") as back:
            for row in rows:
                date, comma, value = row.partition(",")
                out.write(f"{date},{-float(value)}\n" if date[:1] == "2" else row)
                back.write(f"{date},{float(value) + 1000}\n" if "2020-05" in date else row)
        said = self.run_program("fit", CASE, reset, *BEST, "-o", self.out, "--force").stdout
        self.assertIn("the model fits badly", said)  # a sensor that was set back
        for series, falls in ((falling, True), (SERIES, False)):
            said = self.run_program("fit", CASE, series, *BEST, "-o", self.out, "--force").stdout
            self.assertEqual("the readings fall" in said, falls, said)
            found = self.fit(CASE, series, *BEST)
            self.assertEqual((found["readings_fall"], found["fits_badly"]), (falls, falls))

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_convergence(self):
        """A chain that has not converged is an error, after its draws are written; with rounds it
        goes on until it has."""
        args = ["--set", "fit.starts=8", "--set", "fit.walkers=20", "--set", "fit.burn=0", "--set",
                "fit.steps=20"]
        done = self.run_program("fit", CASE, SERIES, "-o", self.out, "--force", "--json", *args,
                                "--set", "fit.rounds=0", "-q", status=1)
        self.assertIn("lacuna: the sampler has not converged", done.stderr)
        told = self.run_program("fit", CASE, SERIES, "-o", self.out, "--force", *args, "--set", "fit.rounds=0", status=1)
        self.assertRegex(told.stdout.splitlines()[1], "do not rely on it +the sampler has not converged")
        with netCDF4.Dataset(self.out) as file:
            self.assertEqual(file.status, "complete")
        self.assertFalse(json.loads(done.stdout)["sampler"]["converged"])
        done = self.run_program("fit", CASE, SERIES, "-o", self.out, "--force", "--json", *args,
                                "--set", "fit.rounds=8")
        said = json.loads(done.stdout)
        self.assertEqual(done.stderr.count("converged"), 0)
        self.assertTrue(said["sampler"]["converged"])
        self.assertEqual(said["sampler"]["burn"], said["sampler"]["steps"] - 20)
        self.assertLess(max(p["rhat"] for p in said["parameters"]), 1.05)

    def test_an_end_before_failure(self):
        """Intervals of a time of failure that is beyond the end are no ranges."""
        text = self.run_program("fit", CASE, SERIES, "-o", self.out, *SHORT, "--set",
                                "time.end=60 day", status=1).stdout
        self.assertIn(" 50 %: not by time.end\n", text)
        self.assertNotIn("not by time.end to", text)

    def test_threads(self):
        """The same numbers for any number of threads."""
        one, two = (self.fit(CASE, SERIES, *SHORT, "--jobs", n, status=1) for n in ("1", "3"))
        for said in (one, two):
            for key in ("wall_time_s", "cpu_time_s"):
                del said[key]
        self.assertEqual(one, two)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_rain(self):
        """The rain-driven block follows the prism better than the undriven one; that one is flagged."""
        driven = self.fit(CENTURY, PRISM, *BEST)
        undriven = self.fit(CENTURY, PRISM, *BEST, "--set", "load.pore_pressure=[]", "--set",
                            "friction.aging.a=0.010", "--set", "friction.aging.b=0.0135", "--set",
                            "friction.aging.dc=7 mm", "--set", "initial.slip_rate=0.12 mm/day",
                            "--set", "initial.state={ratio_to_steady: 0.3}", "--set",
                            "fit.parameters={friction.aging.dc: {range: [1 mm, 1 m]}, "
                            "initial.slip_rate: {range: [0.01 mm/day, 5 mm/day]}, "
                            "initial.state.ratio_to_steady: {range: [0.01, 0.99]}}")
        self.assertLess(driven["rms_m"], 0.0050)
        self.assertLess(driven["rms_m"], 0.8 * undriven["rms_m"])
        self.assertFalse(driven["fits_badly"])
        self.assertTrue(undriven["fits_badly"])

    @unittest.skipUnless(os.path.exists(CHAMBON), "no Chambon data here")
    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "numbers: the plain build's")
    def test_chambon(self):
        """From 13 June: rms 2.4 mm and 4 July 05 h, as an independent program has them."""
        case = os.path.join(self.folder, "chambon.yaml")
        with open(os.path.join(SOURCE, CASE), encoding="utf-8") as file:
            text = file.read()
        with open(case, "w", encoding="utf-8") as file:
            file.write(text[:text.index("compare:")])
        said = self.fit(case, CHAMBON, *BEST, "--set", "time.start=2015-06-13T09:40", "--set",
                        "fit.time=datetime", "--set", "fit.displacement=displacement_mm:mm", "--set",
                        "initial.slip_rate=36 mm/day", "--set", "friction.aging.dc=1 m", "--set",
                        "fit.parameters={friction.aging.dc: {range: [1 cm, 100 m]}, "
                        "friction.aging.b: {range: [0.0105, 0.03]}, "
                        "initial.slip_rate: {range: [1 mm/day, 100 mm/day]}, "
                        "initial.state.ratio_to_steady: {range: [0.01, 0.99]}}")
        self.assertAlmostEqual(1e3 * said["rms_m"], 2.4, delta=0.1)
        begin = numpy.datetime64("2015-06-13T09:40")
        fails = begin + numpy.timedelta64(round(said["best_failure_time_s"]), "s")
        self.assertLess(abs(fails - numpy.datetime64("2015-07-04T05:00")), numpy.timedelta64(3, "h"))

    def test_a_joint_that_slid_away(self):
        """Damping holds the fitted block at a tenth of the failure rate that the case names: it has
        failed when damping, not friction, holds it, or when it has slid its own length."""
        case = os.path.join(self.folder, "case.yaml")
        with open(case, "w", encoding="utf-8") as file:
            file.write(SLID)
        said = self.fit(case, "cases/data/vajont_anchors.csv", *BEST)
        self.assertIsNotNone(said["best_failure_time_s"])
        run = self.run_program("run", case, "-o", self.out, "--force", "--json")
        run = json.loads(run.stdout)
        self.assertEqual((run["failed"], run["ended_by"]), (True, "rate"))
        eta = 0.5 * (4e9 * 2500) ** 0.5
        self.assertAlmostEqual(run["failure_rate_m_s"] / (0.01 * 3e6 / eta), 1, places=9)
        with netCDF4.Dataset(self.out) as file:
            self.assertEqual(file.ended_by, "rate")
            self.assertEqual(file.failure_rate_m_s, run["failure_rate_m_s"])
            self.assertIn("a p/eta", file.failure_rate_comment)
        by_slip = self.run_program("run", case, "-o", self.out, "--force", "--json", "--set",
                                   "time.failure.mean_slip=1 m")
        by_slip = json.loads(by_slip.stdout)
        self.assertEqual((by_slip["failed"], by_slip["ended_by"]), (True, "slip"))
        self.assertAlmostEqual(by_slip["mean_slip_m"], 1, places=9)
        self.assertLess(by_slip["failure_time_s"], run["failure_time_s"])
        said_run = self.run_program("run", case, "-o", self.out, "--force")
        words = "a p/eta: damping holds the joint below that of the case; judged by all cells as one"
        self.assertIn(words, said_run.stdout)
        self.assertNotIn("warning", said_run.stderr)
        checked = self.run_program("check", case).stdout.split("failure rate")[1]
        self.assertIn(words, " ".join(checked.replace("#", "").split()))
        checked = json.loads(self.run_program("check", case, "--json").stdout)["estimate"]
        self.assertEqual((checked["failure_rate_m_s"], checked["failure_rate_lowered"]),
                         (run["failure_rate_m_s"], True))

    def test_what_texts_state(self):
        """Vajont's three fillings: all rates that texts state to a factor of 2.2, the bounds kept, the failure of 1963; what
        was known at an issue; and columns that do not go together."""
        lake, rates = "cases/vajont-lake.yaml", "cases/data/vajont_rates.csv"
        best = ["--set", "fit.steps=0", "--set", "fit.starts=1"]
        said = self.fit(lake, rates, *best)
        self.assertEqual((said["velocities"], said["bounds"], said["outside"], said["missing"]), (9, 2, 0, 0))
        self.assertLess(said["rms_ln_rate"], numpy.log(2.2))
        self.assertEqual(said["best_failure_date"][:7], "1963-10")
        with netCDF4.Dataset(self.out) as file:
            most = file["observed_slip_rate_most"][:] * 8.64e6
            numpy.testing.assert_allclose(most.compressed(), [0.2, 0.3])
            numpy.testing.assert_allclose(file["reading_time_within"][1], 45 * 86400)
        done = self.run_program("fit", lake, rates, "-o", self.out, "--force", *best)
        self.assertIn("2 of the velocities are upper bounds", done.stdout)
        late = self.run_program("fit", lake, rates, "-o", self.out, "--force", *best, "--set", "fit.until=1000 day", status=2).stderr
        self.assertIn("4 readings between time.start and time.end (5 lie outside)", late)
        for words, message in ((["fit.displacement=sigma:m"], "fit.time_within"),
                               (["fit.time_within=within_days:m"], "must be a time"),
                               (["fit.velocity_sigma=source:1"], "vajont_rates.csv"),
                               (["fit.until=-1 day"], "fit.until")):
            done = self.run_program("fit", lake, rates, "-o", self.out, "--force", *[w for word in words for w in ("--set", word)], status=2)
            self.assertIn(message, done.stderr)
            self.assertLessEqual(len(done.stderr.strip().splitlines()), 2, done.stderr)
        refused = self.run_program("precursors", SERIES, "--displacement", "disp_mm:mm", "--case", lake, "--json").stdout
        refused = next(f["reason"] for f in json.loads(refused)["forecasts"] if f["method"] == "case")
        self.assertIn("are of lacuna fit", refused)

    def test_wrong_requests(self):
        """Each says in one line what is wrong, and leaves no file."""
        wrong = [
            (["--set", "fit.parameters={friction.aging.dcc: {range: [1, 2]}}"], "fit.parameters.friction"),
            (["--set", "fit.parameters={friction.aging.dc: {range: [2 m, 1 m]}}"], "must rise"),
            (["--set", "fit.parameters={friction.aging.dc: {range: [1 s, 1 m]}}"], "length"),
            (["--set", "fit.parameters={friction.aging.dc: {}}"], "needs a range"),
            (["--set", "fit.parameters={friction.aging.dc: {range: [1 m, 2 m]}}"], "leaves out"),
            (["--set", "fit.parameters={friction.aging.dc: {prior: {cauchy: {}}}}"], "cauchy"),
            (["--set", "fit.parameters={friction.aging.dc: {prior: {lognormal: {median: 0, sigma: 1}}}}"],
             "median > 0"),
            (["--set", "fit.parameters={}"], "at least one"),
            (["--set", "fit.walkers=15"], "even"),
            (["--set", "fit.steps=3"], "at least 8"),
            (["--set", "fit.displacement=nothing:mm"], "nothing"),
            (["--set", "fit.displacement=disp_mm:s"], "fit.displacement"),
            (["--set", "time.start=2021-01-01T00:00"], "too few"),
            (["--set", "time.start=0 s"], "must be a date"),
            (["--set", "fit.sampel=1"], "fit.sampel"),
        ]
        for args, says in wrong:
            said = self.fit(CASE, SERIES, *args, status=2)
            self.assertIn(says, said)
            self.assertEqual(os.listdir(self.folder), [])
        self.assertIn("fit", self.fit("cases/block.yaml", SERIES, status=2))
        self.fit(CASE, "no-such.csv", status=3)
        done = self.run_program("fit", CASE, SERIES, "-o", os.path.join(self.folder, "no", "o.nc"),
                                status=3)
        self.assertIn("no/o.nc", done.stderr)

    def test_says_what_it_leaves_out(self):
        """What a case asks of its run and a fit does without is said, before any other fault too."""
        asked = ["--set", "time.stop_when.mean_slip=1 cm", "--set", "analysis={events: {slip_rate: 1 mm/s}}",
                 "--set", "solver.fidelity=events"]
        few = ["--set", "time.start=2021-01-01T00:00", "-q"]
        said = self.fit(CASE, SERIES, *asked, *few[:2], status=2).splitlines()
        self.assertEqual([line.split(": ")[3] for line in said if "warning" in line],
                         ["time.stop_when", "solver.fidelity", "analysis"])
        self.assertNotIn("warning", self.fit(CASE, SERIES, *few[:2], status=2))
        self.assertNotIn("warning", self.fit(CASE, SERIES, *asked, *few, status=2))

    def test_spares_what_it_reads(self):
        """--force replaces neither the series nor the case, whatever they are called."""
        case, series = os.path.join(self.folder, "mine.yaml"), os.path.join(self.folder, "readings")
        shutil.copy(os.path.join(SOURCE, CASE), case)
        shutil.copy(os.path.join(SOURCE, SERIES), series)
        as_case = os.path.join(self.folder, "series.yaml")
        shutil.copy(series, as_case)
        for read, out in ((series, series), (series, os.path.join(self.folder, ".", "mine.nc")),
                          (as_case, os.path.join(self.folder, "series.nc"))):
            done = self.run_program("fit", case, read, "-o", out, "--force", "--set", "compare=[]", status=2)
            self.assertIn("must not be the output", done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertEqual(sorted(os.listdir(self.folder)), ["mine.yaml", "readings", "series.yaml"])

    def test_odd_names(self):
        """The fitted case can be read whatever the series is called."""
        for name in ("a\nx: [1.csv", "b\u2028c.csv", "s\u00fcd.csv", os.fsdecode(b"\xe9.csv")):
            shutil.copy(os.path.join(SOURCE, SERIES), os.path.join(self.folder, name))
            done = subprocess.run([PROGRAM, "fit", os.path.join(SOURCE, CASE), name, "-o", "out.nc", "--force", "--set",
                                   "compare=[]", "--set", "fit.walkers=12", "--set", "fit.steps=8", "--set", "fit.burn=0",
                                   "--set", "fit.rounds=1"], cwd=self.folder, capture_output=True, check=False)
            self.assertIn(b"has not converged", done.stderr)
            with open(os.path.join(self.folder, "out.yaml"), "rb") as file:
                self.assertIn(b" by lacuna fit: ", file.readline())
            self.run_program("check", os.path.join(self.folder, "out.yaml"))

    def test_hopeless(self):
        """Every run fails before the last reading: exit 1, nothing written."""
        said = self.fit(CASE, SERIES, "--set", "fit.parameters={friction.aging.dc: {range: [1 um, "
                        "10 um]}}", "--set", "friction.aging.dc=5 um", status=1)
        self.assertIn("fails before", said)
        self.assertEqual(os.listdir(self.folder), [])

    def test_interrupt(self):
        """SIGINT: what was drawn is written whole, exit 4."""
        with subprocess.Popen([PROGRAM, "fit", CASE, SERIES, "-o", self.out, "--set", "fit.starts=4",
                               "--set", "fit.burn=0", "--set", "fit.steps=100000"], cwd=SOURCE,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
            time.sleep(4)
            program.send_signal(signal.SIGINT)
            program.communicate(timeout=200)
        self.assertEqual(program.returncode, 4)
        if os.path.exists(self.out):  # a slow machine is still at the least squares
            with netCDF4.Dataset(self.out) as file:
                self.assertEqual(file.status, "interrupted")
                self.assertGreaterEqual(file.dimensions["draw"].size, 8)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
