#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna report`: the numbers on the page against those of the file, and what it refuses.

usage: test_report.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import base64
import json
import os
import shutil
import stat
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

import report_scenes as scenes

PROGRAM, SOURCE, FOLDER = "", "", ""


def made(name, text):
    """The file of a case's run, made once."""
    path = os.path.join(FOLDER, name + ".nc")
    if not os.path.exists(path):
        scenes.run(PROGRAM, text, path)
    return path


def page_of(path, *words):
    """The data of a run's page."""
    html = path[:-3] + ".html"
    status, _, wrong = scenes.report(PROGRAM, path, "-o", html, "--force", *words)
    assert status == 0, wrong
    return scenes.data_of(html)


def column(data, name):
    return numpy.ma.filled(data[name][:].astype(float), numpy.nan)


class Joint(unittest.TestCase):
    """A joint that fails, with cells, scales and events."""

    @classmethod
    def setUpClass(cls):
        cls.path = made("joint", scenes.JOINT)
        cls.page = page_of(cls.path)
        cls.file = netCDF4.Dataset(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.file.close()

    def test_sections(self):
        self.assertEqual(set(self.page), {"about", "motion", "solver", "cells", "levels", "forecasts", "events"})

    def test_records_are_of_the_file(self):
        time, rate = column(self.file, "time"), column(self.file, "slip_rate")
        slip = column(self.file, "slip")
        motion = self.page["motion"]
        self.assertEqual(motion["records"], len(time))
        at = {(f"{r:.6g}", f"{s:.6g}") for r, s in zip(rate, slip)}
        self.assertTrue({(f"{r:.6g}", f"{s:.6g}") for r, s in zip(motion["rate"], motion["slip"])} <= at)
        for key, name in (("rate", "slip_rate"), ("max_rate", "max_slip_rate")):
            numpy.testing.assert_allclose(max(motion[key]), column(self.file, name).max(), rtol=1e-5)
            numpy.testing.assert_allclose(min(motion[key]), column(self.file, name).min(), rtol=1e-5)
        origin, local = column(self.file, "time_origin"), column(self.file, "time_local")
        before = (origin[-1] - origin) + (local[-1] - local)
        numpy.testing.assert_allclose(motion["before"][0], before[0], rtol=1e-5)
        numpy.testing.assert_allclose(motion["before"][-2], before[-2], rtol=1e-5)
        self.assertEqual(motion["before"][-1], 0)

    def test_scales(self):
        levels = self.page["levels"]
        n_slip, n_tot = column(self.file, "n_slip"), column(self.file, "n_tot")
        self.assertEqual(levels["total"], list(n_tot))
        self.assertEqual([one[-1] for one in levels["slipping"]], list(n_slip[-1]))
        self.assertEqual(max(levels["slipping"][0]), n_slip[:, 0].max())
        self.assertEqual(levels["critical_fraction"], 0.6)
        self.assertIn("strength", levels["definition"])

    def test_events(self):
        events = self.page["events"]
        potency = numpy.sort(column(self.file, "event_potency"))
        self.assertEqual(events["all"], len(potency))
        self.assertGreater(len(potency), 5)
        for at_least, count in zip(events["at_least"], events["count"]):
            self.assertEqual(count, numpy.sum(potency >= at_least * (1 - 1e-5)))

    def test_maps(self):
        self.check_maps(self.page["cells"], self.file)

    def test_maps_of_cells_that_slip_backwards(self):
        path = made("turned", scenes.TURNED)
        with netCDF4.Dataset(path) as file:
            self.assertGreater(self.check_maps(page_of(path)["cells"], file), 0)

    def check_maps(self, cells, file):
        """Gives back how many squares slip backwards."""
        rate = column(file, "cell_slip_rate")
        time = column(file, "snapshot_time")
        self.assertLessEqual(len(cells["snapshot_time"]), 40)
        self.assertEqual(cells["block"], 1)
        place = numpy.floor(column(file, "y") / file.grid_dy_m).astype(int) * file.grid_nx
        place += numpy.floor(column(file, "x") / file.grid_dx_m).astype(int)
        self.assertEqual(cells["place"], list(place))
        limit, back = 10 * column(file, "slip_rate")[0], 0
        for k, shown in enumerate(cells["snapshot_time"]):
            which = numpy.argmin(abs(time - shown))
            drawn = cells["rate"][k]
            values = numpy.frombuffer(base64.b64decode(drawn["map"]), numpy.uint8).astype(float)
            values = drawn["low"] + (values - 1) / 254 * (drawn["high"] - drawn["low"])
            candidates = [i for i in range(len(time)) if abs(time[i] - shown) <= 1e-9 * time[which]]
            step = (drawn["high"] - drawn["low"]) / 254
            # what slips backwards has no place on a logarithmic scale, but one of its own
            turned = numpy.frombuffer(base64.b64decode(drawn.get("backwards", "")), numpy.uint8)
            turned = turned if turned.size > 0 else numpy.zeros(len(values))
            back += turned.sum()
            self.assertTrue(any(numpy.array_equal(turned, rate[i] <= 0) for i in candidates))
            near = min(abs(values - numpy.log10(abs(rate[i])))[rate[i] > 0].max() for i in candidates
                       if numpy.array_equal(values < drawn["low"], rate[i] <= 0))
            self.assertLessEqual(near, 0.51 * step + 1e-4)
            self.assertIn(cells["slipping_cells"][k], [numpy.sum(rate[i] >= limit) for i in candidates])
        return back

    def test_forecasts_see_nothing_later(self):
        """A forecast stands as it would from the readings up to its time alone."""
        forecasts = self.page["forecasts"]
        names = [method["name"] for method in forecasts["methods"]]
        self.assertIn("inv", names)
        self.assertFalse(forecasts["measured"])
        self.assertTrue(any(one[0] for row in forecasts["forecast"] for one in row))
        for row in forecasts["forecast"]:
            for method, (issued, left, low90, low50, high50, high90, reason, ends) in zip(names, row):
                self.assertTrue(set(ends) <= {"block": {"m"}, "lppls": {"m", "omega"}}.get(method, set()), (method, ends))
                self.assertEqual(issued, reason == "")
                if issued:
                    self.assertGreater(left, 0)
                    self.assertLessEqual(low90, low50)
                    self.assertTrue(high90 is None or high50 <= high90)


class Block(unittest.TestCase):
    def test_only_what_there_is(self):
        page = page_of(made("block", scenes.BLOCK))
        self.assertEqual(set(page), {"about", "motion", "solver", "forecasts"})
        self.assertTrue(page["about"]["dated"])
        self.assertIn("lacuna: 1", page["about"]["case"])

    def test_long_history(self):
        """Of a run that was resumed again and again."""
        path, history = os.path.join(FOLDER, "history.nc"), "lacuna run --resume\n" * 1000
        shutil.copy(made("brief", scenes.BRIEF), path)
        with netCDF4.Dataset(path, "a") as file:
            file.history = history
        self.assertEqual(page_of(path)["about"]["history"], history)

    def test_without_a_variable(self):
        """What a tool has cut off, or an earlier version did not write, in a run that was killed too: its section
        is left out, the page stands."""
        path = os.path.join(FOLDER, "cut.nc")
        for name, section in (("order", "solver"), ("rhs_evaluations", "solver"), ("normal_force", "forces")):
            Refused.changed(made("step", scenes.STEP), path, name, None, None)
            for status in ("complete", "running"):
                with netCDF4.Dataset(path, "a") as file:
                    file.status = status
                self.assertEqual(set(page_of(path)), {"about", "motion", "safety", "solver", "forces", "forecasts"} - {section})

    def test_what_weakens_and_water_over_the_joint(self):
        """Charts and maps of excess pore pressure, temperature and broken cohesion, and the map of pore pressure."""
        text = """lacuna: 1
interface: {size: 8 m, levels: 3, domain: {full: {}}}
material: {shear_modulus: 10 GPa}
load: {normal: {pressure: 3 MPa}, shear: [{ratio: {value: 0.61}}],
  pore_pressure: [{water_table: {level: 30 m, elevation: 0 m, angle: 60 degree}}]}
friction: {aging: {f0: 0.6, a: 0.012, b: 0.010, dc: 1 mm, cohesion: 20 kPa}}
weakening:
  - bridges: {rate: 1 1/day, stress: 2 MPa, exponent: 10}
  - thermal-pressurization: {thickness: 1 mm, pressurization: 0.3 MPa/K, hydraulic_diffusivity: 1e-5 m2/s}
initial: {slip_rate: 1 um/s}
transfer: {hierarchy: {stiffness: elastic}}
time: {end: 1 hour}
output: {fields: [pore_pressure, excess_pore_pressure, temperature, broken_cohesion]}
"""
        path = made("weakening", text)
        page = page_of(path)
        with netCDF4.Dataset(path) as file:
            for key, name in (("excess", "excess_pore_pressure"), ("heat", "temperature_rise"), ("broken", "broken_cohesion")):
                self.assertAlmostEqual(page["safety"][key][-1] / file[name][-1], 1, 5)
            for key, name in (("pore", "pore_pressure"), ("excess", "excess_pore_pressure"), ("heat", "temperature"),
                              ("broken", "broken_cohesion")):
                values = file["cell_" + name][:]
                self.assertGreater(numpy.ptp(values), 0)
                for end, value in (("low", values.min()), ("high", values.max())):
                    self.assertAlmostEqual(page["cells"][key][-1][end], value, delta=1e-4 * numpy.abs(values).max())

    def test_direction(self):
        """Where slip goes, of a run that slips in two directions; of no other."""
        with open(os.path.join(SOURCE, "cases", "load", "turning.yaml"), encoding="utf-8") as case:
            path = made("turning", case.read())
        shown = page_of(path)["direction"]
        with netCDF4.Dataset(path) as file:
            for key, name in (("x", "slip_x"), ("y", "slip_y"), ("rate_x", "slip_rate_x"), ("rate_y", "slip_rate_y")):
                numpy.testing.assert_allclose(shown[key][-1], column(file, name)[-1], rtol=1e-5)
            size = numpy.hypot(column(file, "cell_traction_x"), column(file, "cell_traction_y"))
            numpy.testing.assert_allclose(column(file, "cell_traction"), size, rtol=1e-14)

    @unittest.skipIf("LACUNA_SANITIZED" in os.environ, "other tests take its ways")
    def test_cells_without_snapshots(self):
        cells = page_of(made("bare", scenes.BARE))["cells"]
        self.assertEqual(cells["snapshot_time"], [])
        self.assertEqual(len(cells["pressure"]), 1)
        self.assertEqual({"rate", "slip", "traction", "slipping"} & set(cells), set())

    def test_series(self):
        path = made("block", scenes.BLOCK)
        with netCDF4.Dataset(path) as file:
            time, slip = column(file, "time"), column(file, "slip")
        at = numpy.linspace(1e5, 0.9 * time[-1], 30)
        series = os.path.join(FOLDER, "prism.csv")
        scenes.readings(series, at, numpy.interp(at, time, slip))
        shown = page_of(path, "--compare", series, "--displacement", "move_mm:mm")["series"]
        self.assertEqual((shown["name"], shown["readings"], shown["attribution"]), ("prism.csv", 30, "made up"))
        numpy.testing.assert_allclose(shown["offset"], 7e-3, rtol=1e-3)
        self.assertLess(shown["slip_rms"], 1e-5)
        numpy.testing.assert_allclose(shown["time"], numpy.floor(at), rtol=1e-9)
        self.assertEqual(len(shown["rate"]), 29)
        self.assertTrue(shown["derived"])
        self.assertFalse(shown["falling"])
        scenes.readings(series, at, -numpy.interp(at, time, slip))
        turned = page_of(path, "--compare", series, "--displacement", "move_mm:mm")["series"]
        self.assertTrue(turned["falling"])
        numpy.testing.assert_allclose(turned["rate"], shown["rate"], rtol=1e-6)
        scenes.readings(series, at, numpy.interp(at, time, slip))

    def test_columns_of_the_case(self):
        text = scenes.BLOCK + "compare: [{file: prism.csv, time: date, displacement: \"move_mm:mm\"}]\n"
        self.test_series()
        shown = page_of(made("with-columns", text), "--compare", os.path.join(FOLDER, "prism.csv"))["series"]
        self.assertEqual(shown["readings"], 30)


class Line(unittest.TestCase):
    def test_every_snapshot_in_one_range(self):
        path = made("line", scenes.LINE)
        cells = page_of(path)["cells"]
        with netCDF4.Dataset(path) as file:
            time, slip = column(file, "snapshot_time"), column(file, "cell_slip")
        self.assertEqual((cells["nx"], cells["ny"], cells["place"]), (60, 1, list(range(60))))
        self.assertGreater(len(time), 60)  # more than of a plane
        self.assertEqual(len(cells["snapshot_time"]), len(time))
        self.assertEqual({(one["low"], one["high"]) for one in cells["slip"]},
                         {(float(f"{slip.min():.5g}"), float(f"{slip.max():.5g}"))})
        for k in (0, len(time) // 2, len(time) - 1):
            bytes_ = numpy.frombuffer(base64.b64decode(cells["slip"][k]["map"]), numpy.uint8)
            shown = slip.min() + (bytes_ - 1.0) / 254 * (slip.max() - slip.min())
            self.assertLess(abs(shown - slip[k]).max(), 0.51 / 254 * (slip.max() - slip.min()) + 1e-5 * slip.max())


class Fit(unittest.TestCase):
    """A block fitted to its readings over most of its life."""

    fit = None

    @classmethod
    def setUpClass(cls):
        path = made("block", scenes.BLOCK)
        with netCDF4.Dataset(path) as file:
            time, slip = column(file, "time"), column(file, "slip")
        cls.at = numpy.floor(numpy.linspace(0, 0.85 * time[-1], 40))
        cls.truth = numpy.interp(cls.at, time, slip)
        noise = 1e-4 * numpy.random.default_rng(1).standard_normal(40)
        cls.series, cls.fit = os.path.join(FOLDER, "fitted.csv"), os.path.join(FOLDER, "fit.nc")
        scenes.readings(cls.series, cls.at, cls.truth + noise)
        scenes.fit(PROGRAM, scenes.BLOCK, cls.series, cls.fit)
        cls.path = path
        cls.page = page_of(path, "--fit", cls.fit)

    def test_band_is_the_file_s(self):
        fit = self.page["fit"]
        with netCDF4.Dataset(self.fit) as file:
            numpy.testing.assert_allclose(fit["time"], column(file, "prediction_time"), rtol=1e-9)
            for key, name in (("slip", "predicted_displacement"), ("rate", "predicted_slip_rate")):
                band = numpy.array([[numpy.nan if v is None else v for v in one] for one in fit[key]])
                numpy.testing.assert_allclose(band, column(file, name), rtol=1e-6)
            failures = numpy.sort(column(file, "failure_time"))
        failures = failures[~numpy.isnan(failures)]
        self.assertEqual(fit["failure"]["failing"], len(failures))
        if len(failures) == fit["failure"]["draws"]:
            numpy.testing.assert_allclose(fit["failure"]["quantile"], numpy.quantile(failures, [0.05, 0.25, 0.5, 0.75, 0.95]), rtol=1e-9)
        for t, share in zip(fit["failure"]["time"], fit["failure"]["share"]):
            draws = round(share * fit["failure"]["draws"])  # of several at one time, any
            self.assertTrue(numpy.sum(failures < t * (1 - 1e-11)) < draws <= numpy.sum(failures <= t * (1 + 1e-11)), (t, share))

    def test_it_saw_nothing_later(self):
        fit = self.page["fit"]
        self.assertEqual((fit["readings"], fit["from"], fit["until"]), (40, 0, self.at[-1]))
        self.assertGreater(fit["time"][-1], fit["until"])  # and looks ahead of it

    def test_its_readings_lie_on_the_run(self):
        series = self.page["series"]
        self.assertEqual(series["name"], "fit.nc")
        numpy.testing.assert_allclose(series["time"], self.at)
        numpy.testing.assert_allclose(series["offset"], 7e-3, atol=1e-4)
        self.assertTrue(series["derived"])  # no velocities were read
        self.assertEqual(len(series["rate"]), 39)
        self.assertTrue(self.page["forecasts"]["measured"])
        fit = self.page["fit"]
        middle = numpy.interp(self.at, fit["time"], numpy.array(fit["slip"][2], float)) - series["offset"]
        self.assertLess(abs(middle - self.truth).max(), 3e-4)

    def test_estimates(self):
        (rate, error) = self.page["fit"]["estimates"]
        self.assertEqual((rate["key"], rate["unit"], error["key"]), ("initial.slip_rate", "m/s", "error.displacement"))
        with netCDF4.Dataset(self.fit) as file:
            draws = column(file, "initial_slip_rate").ravel()
        for key, share in (("low90", 0.05), ("median", 0.5), ("high90", 0.95)):
            numpy.testing.assert_allclose(rate[key], numpy.quantile(draws, share), rtol=1e-4)

    def test_the_end_of_a_range(self):
        self.assertEqual([one["limit"] for one in self.page["fit"]["estimates"]], [None, None])
        path = os.path.join(FOLDER, "at-end.nc")
        shutil.copy(self.fit, path)
        with netCDF4.Dataset(path, "a") as file:
            file["initial_slip_rate"].best_fit_at_end_of_range = 2e-8
        self.assertEqual([one["limit"] for one in page_of(self.path, "--fit", path)["fit"]["estimates"]], [2e-8, None])

    def test_beside_a_longer_series(self):
        path = os.path.join(FOLDER, "longer.csv")
        scenes.readings(path, [*self.at, self.at[-1] + 8e4], [*self.truth, self.truth[-1] + 1e-3])
        page = page_of(made("brief", scenes.BRIEF), "--fit", self.fit, "--compare", path, "--displacement", "move_mm:mm")
        self.assertEqual((page["series"]["readings"], page["fit"]["until"]), (41, self.at[-1]))

    def test_least_squares_alone(self):
        path = os.path.join(FOLDER, "best.nc")
        scenes.fit(PROGRAM, scenes.BLOCK, self.series, path, "--set", "fit.steps=0")
        fit = page_of(made("brief", scenes.BRIEF), "--fit", path)["fit"]
        self.assertEqual((fit["slip"], fit["rate"], "failure" in fit), ([], [], False))
        self.assertEqual(len(fit["best"]), len(fit["time"]))
        self.assertNotIn("median", fit["estimates"][0])


class Readings(unittest.TestCase):
    """The page of readings: of the file of forecasts, and of a series."""

    series = ""

    @classmethod
    def setUpClass(cls):
        cls.series = os.path.join(SOURCE, "cases", "data", "creep.csv")
        cls.path = os.path.join(FOLDER, "readings.nc")
        scenes.forecasts(PROGRAM, SOURCE, cls.path)
        cls.plain = page_of(cls.path)
        scenes.driven(cls.path)
        cls.page = page_of(cls.path)
        cls.file = netCDF4.Dataset(cls.path)
        cls.addClassCleanup(cls.file.close)

    def same(self, shown, values, digits=8):
        values = numpy.ma.filled(numpy.ma.asarray(values).astype(float), numpy.nan)
        shown = numpy.array([numpy.nan if v is None else v for v in shown], float)
        numpy.testing.assert_allclose(shown, values, rtol=10.0 ** (1 - digits))

    def test_motion_and_drivers_are_of_the_file(self):
        r, file = self.page["readings"], self.file
        for key, time, value in (("moved", "reading_time", "displacement"), ("rate", "velocity_time", "velocity")):
            self.same(r[key]["time"], file[time][:], 14)
            self.same(r[key]["value"], file[value][:])
        self.assertEqual([(d["name"], d["unit"]) for d in r["drivers"]], [("rain", "mm"), ("lake", "m")])
        for driver in r["drivers"]:
            self.same(driver["series"]["time"], file["driver_time"][:], 14)
            self.same(driver["series"]["value"], file["driver_" + driver["name"]][:])

    def test_forecasts_are_of_the_file(self):
        f, file = self.page["forecasts"], self.file
        self.assertEqual([m["name"] for m in f["methods"]], file["method"].flag_meanings.split())
        self.assertEqual([m["name"] for m in f["methods"] if m["baseline"]], ["persistence"])
        self.same(f["issue"], file["issue_time"][:], 14)
        self.assertEqual([[one[0] for one in rows] for rows in f["forecast"]], (file["issued"][:] > 0).tolist())
        self.assertTrue((file["issued"][:, :-1] > 0).any())
        for k, name in enumerate(("", "_low90", "_low50", "_high50", "_high90")):
            left = file["failure_time" + name][:] - file["issue_time"][:][:, None]
            self.same(numpy.array([[one[1 + k] for one in rows] for rows in f["forecast"]]).ravel(), left.ravel(), 6)
        self.assertEqual([[one[6] for one in rows] for rows in f["forecast"]], file["reason"][:].tolist())
        about = self.page["about"]
        self.assertTrue(about["failed"])
        self.assertEqual(about["failure_time_s"], file.failed_at_s)

    def test_level_and_verdict_are_shown_as_they_stand(self):
        self.assertEqual(self.page["alarm"]["level"], self.file["alarm_level"][:].tolist())
        self.assertEqual(self.page["alarm"]["meanings"], "quiet watch warning alarm")
        self.assertEqual(self.page["verdict"], [["verdict", self.file.verdict], ["verdict_p", "0.25"]])
        self.assertEqual(self.plain["readings"]["drivers"], [])

    def test_a_series_is_forecast_as_precursors_does(self):
        html = os.path.join(FOLDER, "series.html")
        before = set(os.listdir(FOLDER))
        status, said, wrong = scenes.report(PROGRAM, self.series, "--displacement", "disp_mm:mm", "--issues", "20",
                                            "--failed-at", "2020-08-12", "-o", html)
        self.assertEqual((status, said, wrong), (0, f"  page                 {html}\n", ""))
        self.assertEqual(set(os.listdir(FOLDER)) - before, {"series.html"})
        page = scenes.data_of(html)
        for key in set(self.plain) | set(page):
            if key != "about":
                self.assertEqual(page[key], self.plain[key], key)
        self.assertEqual(page["about"]["file"], "creep.csv")

    def test_no_failure_is_known(self):
        html = os.path.join(FOLDER, "never.html")
        for words in ((), ("--failed-at", "never")):
            status, _, wrong = scenes.report(PROGRAM, self.series, "--displacement", "disp_mm:mm", "--issues", "3", "-o", html,
                                             "--force", *words)
            self.assertEqual(status, 0, wrong)
            self.assertEqual(scenes.data_of(html)["about"]["failed"], False)

    def test_refused(self):
        run = made("block", scenes.BLOCK)
        html = os.path.join(FOLDER, "not-readings.html")
        damaged = os.path.join(FOLDER, "damaged-forecasts.nc")
        shutil.copy(self.path, damaged)
        with open(damaged, "r+b") as file:
            file.truncate(os.path.getsize(damaged) // 2)
        for status, message, *words in ((2, "--failed-at", run, "--failed-at", "2020-08-12"),
                                        (2, "beside a run", self.path, "--compare", self.series),
                                        (2, "how a series is read", self.path, "--displacement", "disp_mm:mm"),
                                        (2, "is no series", self.path, "--until", "2020-06-01"),
                                        (2, "which column is what", self.series),
                                        (2, "is read by this command", self.series, "-o", self.series, "--force"),
                                        (3, "damaged", damaged),
                                        (3, "No such file", os.path.join(FOLDER, "none.csv"), "--displacement", "a:mm")):
            got, said, wrong = scenes.report(PROGRAM, *words, *(() if "-o" in words else ("-o", html)))
            self.assertEqual((got, said, wrong.count("\n")), (status, "", 1), (words, wrong))
            self.assertIn(message, wrong)
        self.assertFalse(os.path.exists(html))


class Refused(unittest.TestCase):
    def refused(self, status, message, *words):
        got, said, wrong = scenes.report(PROGRAM, *words)
        self.assertEqual((got, said), (status, ""), wrong)
        self.assertEqual(wrong.count("\n"), 1, wrong)
        self.assertIn(message, wrong)

    def test_wrong_files(self):
        path = made("block", scenes.BLOCK)
        html = os.path.join(FOLDER, "refused.html")
        csv = os.path.join(FOLDER, "no-run.nc")
        with open(csv, "w", encoding="utf-8") as file:
            file.write("time,slip\n")
        self.refused(3, "No such file", os.path.join(FOLDER, "nothing.nc"), "-o", html)
        self.refused(3, "not a netCDF file", csv, "-o", html)
        self.refused(2, "which column is what", path, "--compare", csv, "-o", html)
        self.refused(2, "--compare", path, "--displacement", "a:mm", "-o", html)
        self.refused(3, "No such file", path, "-o", os.path.join(FOLDER, "no", "page.html"))
        self.assertFalse(os.path.exists(html))

    def test_contact_is_no_run(self):
        case = os.path.join(FOLDER, "contact.yaml")
        with open(case, "w", encoding="utf-8") as file:
            file.write(scenes.JOINT)
        path = os.path.join(FOLDER, "contact.nc")
        subprocess.run([PROGRAM, "contact", case, "-o", path, "-q"], check=True, stdout=subprocess.DEVNULL)
        self.refused(3, "holds no time series", path, "-o", os.path.join(FOLDER, "contact.html"))

    def test_page_that_is_there(self):
        path = made("block", scenes.BLOCK)
        html = os.path.join(FOLDER, "there.html")
        with open(html, "w", encoding="utf-8") as file:
            file.write("mine")
        self.refused(2, "exists already", path, "-o", html)
        with open(html, encoding="utf-8") as file:
            self.assertEqual(file.read(), "mine")
        self.assertEqual([name for name in os.listdir(FOLDER) if name.endswith(".part")], [])

    def test_force_spares_what_is_read_and_what_is_no_file(self):
        path = made("block", scenes.BLOCK)
        series = os.path.join(FOLDER, "spared.csv")
        with open(series, "w", encoding="utf-8") as file:
            file.write("day,move\n1,1\n2,2\n")
        with open(path, "rb") as file:
            before = file.read()
        self.refused(2, "is read by this command", path, "-o", os.path.join(FOLDER, ".", os.path.basename(path)),
                     "--force")
        self.refused(2, "is read by this command", path, "--compare", series, "--displacement", "move:mm",
                     "--time-format", "day", "-o", series, "--force")
        with open(path, "rb") as file:
            self.assertEqual(file.read(), before)
        pipe = os.path.join(FOLDER, "pipe")
        os.mkfifo(pipe)
        self.refused(3, "is not a regular file", path, "-o", pipe, "--force")
        self.assertTrue(stat.S_ISFIFO(os.stat(pipe).st_mode))
        self.refused(3, "is a folder", path, "-o", FOLDER, "--force")

    def test_fits(self):
        run, html = made("block", scenes.BLOCK), os.path.join(FOLDER, "no-fit.html")
        if not os.path.exists(Fit.fit or ""):
            Fit.setUpClass()
        self.refused(2, "is the file of a fit", Fit.fit, "-o", html)
        forecasts = os.path.join(FOLDER, "forecasts.nc")
        subprocess.run([PROGRAM, "precursors", run, "-o", forecasts], check=True, capture_output=True)
        self.refused(2, "lay something beside a run", forecasts, "--fit", Fit.fit, "-o", html)
        self.refused(3, "is not a file of lacuna fit", run, "--fit", made("joint", scenes.JOINT), "-o", html)
        self.refused(3, "No such file", run, "--fit", os.path.join(FOLDER, "nothing.nc"), "-o", html)
        self.refused(2, "has dates", made("joint", scenes.JOINT), "--fit", Fit.fit, "-o", html)
        self.refused(2, "is read by this command", run, "--fit", Fit.fit, "-o", Fit.fit, "--force")
        for name, shape, values in (("quantile", ("quantile",), [0.05, 0.25, 0.5, 0.75, 2e9]),
                                    ("quantile", ("quantile",), [-1, 0.25, 0.5, 0.75, numpy.nan]),
                                    ("quantile", ("quantile", "none"), None),
                                    ("reading_time", ("reading", "none"), None)):
            path = os.path.join(FOLDER, "damaged.nc")
            self.changed(Fit.fit, path, name, shape, values)
            self.refused(3, "is not a file of lacuna fit", run, "--fit", path, "-o", html)
        self.assertFalse(os.path.exists(html))

    @staticmethod
    def changed(source, path, changed, shape, values):
        """A copy of a file with another variable in place of one, or without it; the dimension `none` is empty."""
        with netCDF4.Dataset(source) as old, netCDF4.Dataset(path, "w") as new:
            new.setncatts({k: old.getncattr(k) for k in old.ncattrs()})
            new.createDimension("none", None)
            for name, dimension in old.dimensions.items():
                new.createDimension(name, len(dimension))
            for name, variable in old.variables.items():
                if name == changed and shape is None:
                    continue
                own = new.createVariable(name, variable.dtype, shape if name == changed else variable.dimensions)
                own.setncatts({k: variable.getncattr(k) for k in variable.ncattrs() if k != "_FillValue"})
                if name != changed:
                    own[...] = variable[...]
                elif values is not None:
                    own[:] = values

    def test_dates_beside_a_run_without(self):
        series = os.path.join(FOLDER, "dated.csv")
        with open(series, "w", encoding="utf-8") as file:
            file.write("date,move\n2020-01-01,1\n2020-01-02,2\n")
        self.refused(2, "has dates", made("joint", scenes.JOINT), "--compare", series, "--displacement", "move:mm",
                     "-o", os.path.join(FOLDER, "dated.html"))


class Big(unittest.TestCase):
    """A made-up file of 300 000 records, 262 144 cells and 60 000 events."""

    def test_size_is_bounded_and_peaks_stay(self):
        path = os.path.join(FOLDER, "big.nc")
        source = made("joint", scenes.JOINT)
        self.enlarge(source, path)
        page = page_of(path)
        self.assertLess(os.path.getsize(path[:-3] + ".html"), 4e6)
        self.assertLess(len(page["motion"]["time"]), 7000)
        self.assertEqual(max(page["motion"]["max_rate"]), 77)  # one record of 300 000
        self.assertLessEqual(len(page["cells"]["place"]), 12000)
        self.assertEqual(page["cells"]["cells"], 512 * 512)
        self.assertLessEqual(len(page["events"]["time"]), 3100)
        self.assertEqual(page["events"]["all"], 60000)
        self.assertIn(5e3, page["events"]["potency"])

    @staticmethod
    def enlarge(source, path):
        n, side, random = 300000, 512, numpy.random.default_rng(1)
        with netCDF4.Dataset(source) as old, netCDF4.Dataset(path, "w") as new:
            new.setncatts({k: old.getncattr(k) for k in old.ncattrs()})
            new.setncatts({"grid_nx": side, "grid_ny": side, "grid_dx_m": 1.0, "grid_dy_m": 1.0})
            for name, size in (("time", None), ("cell", side * side), ("snapshot", None), ("event", None)):
                new.createDimension(name, size)
            time = numpy.arange(n) * 10.0
            peak = numpy.full(n, 1e-6)
            peak[123456] = 77
            values = {"time": time, "time_origin": time, "time_local": 0 * time, "slip": 1e-9 * time, "slip_rate": 0 * time + 1e-9,
                      "max_slip_rate": peak}
            for name in ("balance_residual", "step_size", "order", "rhs_evaluations", "shear_force", "normal_force",
                         "effective_normal_force", "apparent_friction"):
                values[name] = random.random(n)
            for name, value in values.items():
                new.createVariable(name, "f8", ("time",))[:] = value
            y, x = numpy.divmod(numpy.arange(side * side), side)
            for name, value in (("x", x + 0.5), ("y", y + 0.5), ("pressure", 1e6 + x)):
                new.createVariable(name, "f8", ("cell",))[:] = value
            new.createVariable("snapshot_time", "f8", ("snapshot",))[:] = [0, 1e6, 2e6]
            new.createVariable("cell_slip_rate", "f8", ("snapshot", "cell"))[:] = 1e-9 * random.random((3, side * side))
            for name in ("event_time", "event_duration", "event_cells", "event_moment", "event_size", "event_max_slip_rate",
                         "event_cut", "event_potency"):
                value = random.random(60000)
                value[777] = 5e3 if name == "event_potency" else value[777]
                new.createVariable(name, "f8", ("event",))[:] = value


class Link(unittest.TestCase):
    """As of every file of lacuna, what a symbolic link leads to is replaced, not the link."""

    def test_page_behind_a_link(self):
        folder = tempfile.mkdtemp(dir=FOLDER)
        page, link = os.path.join(folder, "page.html"), os.path.join(folder, "link.html")
        os.symlink("page.html", link)
        with open(page, "w", encoding="utf-8") as file:
            file.write("old")
        run = made("brief", scenes.BRIEF)
        self.assertEqual(scenes.report(PROGRAM, run, "-o", link)[0], 2)
        self.assertEqual(scenes.report(PROGRAM, run, "-o", link, "--force")[0], 0)
        self.assertTrue(os.path.islink(link))
        self.assertFalse(os.path.islink(page))
        self.assertEqual(scenes.data_of(page)["about"]["title"], "A block")
        self.assertEqual(sorted(os.listdir(folder)), ["link.html", "page.html"])

    def test_runs_do_the_same(self):
        folder = tempfile.mkdtemp(dir=FOLDER)
        case, link = os.path.join(folder, "case.yaml"), os.path.join(folder, "link.nc")
        with open(case, "w", encoding="utf-8") as file:
            file.write(scenes.BRIEF)
        shutil.copy(made("brief", scenes.BRIEF), os.path.join(folder, "run.nc"))
        os.symlink("run.nc", link)
        subprocess.run([PROGRAM, "run", case, "-o", link, "--force", "-q"], check=True, stdout=subprocess.DEVNULL)
        self.assertTrue(os.path.islink(link))


class Json(unittest.TestCase):
    def test_output(self):
        html = os.path.join(FOLDER, "json.html")
        status, said, _ = scenes.report(PROGRAM, made("block", scenes.BLOCK), "--json", "-o", html)
        self.assertEqual((status, json.loads(said)), (0, {"output": html}))


if __name__ == "__main__":
    PROGRAM, SOURCE = sys.argv[1], sys.argv[2]
    FOLDER = tempfile.mkdtemp(prefix="lacuna-report-")
    try:
        unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
    finally:
        shutil.rmtree(FOLDER)
