#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`lacuna fit` of friction in a laboratory: velocity steps of a machine, against an integration of its own.

usage: test_fit_friction.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import netCDF4
import numpy

PROGRAM, SOURCE = "", ""
CASE, SERIES, MACHINE = "cases/fit/velocity-step.yaml", "cases/data/velocity_step.csv", "velocity_step_load.csv"
TRUTH = {"f0": 0.61, "a": 0.0085, "b": 0.0100, "dc": 7e-6, "stiffness": 90e9}
PRESSURE, SPEED, STEP, END = 20e6, 3e-6, 8.0, 28.0


def slides(law, times, f0, a, b, dc, stiffness):
    """Friction of a block behind a spring, by Runge and Kutta: dmu/dt = k (V - v)/p."""
    def rates(t, mu, log_theta):
        v = SPEED * math.exp((mu - f0 - b * (log_theta + math.log(SPEED / dc))) / a)
        x = v * math.exp(log_theta) / dc
        far = SPEED if t < STEP else 10 / 3 * SPEED
        theta = (1 - x) / math.exp(log_theta) if law == "aging" else -v / dc * math.log(x)
        return stiffness * (far - v) / PRESSURE, theta

    mu, w, t, out = f0, math.log(dc / SPEED), STEP, [f0] * int(numpy.sum(times <= STEP))
    h = 2e-3  # it begins steady; the step is where a step begins
    for reading in times[times > STEP]:
        n = max(1, math.ceil((reading - t) / h))
        d = (reading - t) / n
        for _ in range(n):
            k1 = rates(t, mu, w)
            k2 = rates(t + d / 2, mu + d / 2 * k1[0], w + d / 2 * k1[1])
            k3 = rates(t + d / 2, mu + d / 2 * k2[0], w + d / 2 * k2[1])
            k4 = rates(t + d, mu + d * k3[0], w + d * k3[1])
            mu += d / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
            w += d / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
            t += d
        out.append(mu)
    return numpy.array(out)


class Friction(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.out = os.path.join(self.folder, "out.nc")
        os.mkdir(os.path.join(self.folder, "data"))
        os.mkdir(os.path.join(self.folder, "fit"))
        shutil.copy(os.path.join(SOURCE, "cases/data", MACHINE), os.path.join(self.folder, "data"))
        with open(os.path.join(SOURCE, CASE), encoding="utf-8") as file:
            text = file.read()
        self.case = {}
        for law in ("aging", "slip"):
            self.case[law] = os.path.join(self.folder, "fit", law + ".yaml")
            with open(self.case[law], "w", encoding="utf-8") as file:
                file.write(text.replace("aging", law))

    def tearDown(self):
        shutil.rmtree(self.folder)

    def fit(self, law, series, *args, status=0):
        done = subprocess.run([PROGRAM, "fit", self.case[law], series, "-o", self.out, "--force", "--json", "-q", *args],
                              cwd=SOURCE, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return json.loads(done.stdout) if done.stdout else done.stderr

    def best(self, law, series):
        return self.fit(law, series, "--set", "fit.steps=0", "--set", "fit.starts=16")

    def make(self, law, noise, seed):
        """Readings that the law has made, with errors."""
        times = numpy.concatenate([numpy.arange(0.25, 8, 0.5), numpy.arange(8.05, 11, 0.1), numpy.arange(11.25, 28, 0.5)])
        friction = slides(law, times, *TRUTH.values()) + noise * numpy.random.default_rng(seed).standard_normal(len(times))
        path = os.path.join(self.folder, "made.csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write("time_s,friction\n")
            file.writelines(f"{t:.4f},{f:.12f}\n" for t, f in zip(times, friction))
        return path

    def test_truth(self):
        """What the readings were made with is found, by either law, and derivatives came from sensitivities."""
        for law in ("aging", "slip"):
            said = self.best(law, self.make(law, 0.0, 1))
            self.assertLess(said["rms_friction"], 1e-7)
            self.assertIsNone(said["rms_m"])
            for p, true in zip(said["parameters"], TRUTH.values()):
                self.assertAlmostEqual(p["best"] / true, 1, delta=2e-4, msg=f"{law} {p['key']}")
                self.assertEqual(p["derivatives"], "sensitivities")

    def test_errors_and_law(self):
        """Estimates scatter about the truth as their standard errors say; the law that made them is the likelier."""
        squares = []
        for seed in range(4):
            made = self.make("slip", 2e-4, seed)
            said = self.best("slip", made)
            self.assertAlmostEqual(said["parameters"][5]["best"] / 2e-4, 1, delta=0.25)
            for p, true in zip(said["parameters"], TRUTH.values()):
                plain = p.get("error")
                off = (p["best"] - true) / plain if plain else math.log(p["best"] / true) / p["error_of_logarithm"]
                squares.append(off ** 2)
            if seed < 1:
                self.assertGreater(self.best("aging", made)["bic"], said["bic"] + 6)
        self.assertTrue(0.5 < numpy.mean(squares) < 1.8, numpy.mean(squares))

    def test_evidence(self):
        """ln Z against a quadrature: f0 shifts what a block says, so with f0 and the error unknown Z is known."""
        made = self.make("slip", 1e-3, 3)
        rows = numpy.loadtxt(made, delimiter=",", skiprows=1)
        off = rows[:, 1] - slides("slip", rows[:, 0], **{**TRUTH, "f0": 0.0})
        n, span = len(off), rows[:, 1].max() - rows[:, 1].min()
        f0, log_error = numpy.linspace(0.6, 0.62, 801), numpy.linspace(math.log(1e-5 * span), math.log(10 * span), 1501)
        squares = numpy.sum(off ** 2) - 2 * f0 * numpy.sum(off) + n * f0 ** 2
        cell = (f0[1] - f0[0]) * (log_error[1] - log_error[0]) / (log_error[-1] - log_error[0])
        log_likelihood = -0.5 * squares * numpy.exp(-2 * log_error)[:, None] - n * (log_error + 0.5 * math.log(2 * math.pi))[:, None]
        truth = "{friction: {slip: {f0: 0.61, a: 0.0085, b: 0.0100, dc: 7 um, v0: 3 um/s}}}"
        held = ["--set", f"friction={truth[11:-1]}", "--set", "load.shear.0.machine.stiffness=90 GPa/m", "--set", "fit.starts=4",
                "--set", "fit.walkers=16", "--set", "fit.burn=40", "--set", "fit.steps=120", "--set", "time.end=28 s"]
        normal = -0.5 * ((f0 - 0.6105) / 1e-4) ** 2 - math.log(1e-4 * math.sqrt(2 * math.pi))
        for prior, log_prior in (("{uniform: {}}", -math.log(0.02) + 0 * f0), ("{normal: {mean: 0.6105, sigma: 1e-4}}", normal)):
            most = (log_likelihood + log_prior).max()
            exact = most + math.log(cell * numpy.sum(numpy.exp(log_likelihood + log_prior - most)))
            said = self.fit("slip", made, *held, "--set",
                            f"fit.parameters={{friction.slip.f0: {{range: [0.6, 0.62], prior: {prior}}}}}")
            self.assertLess(abs(said["log_evidence"] - exact), 4 * said["log_evidence_error"] + 0.02, prior)
            self.assertLess(said["log_evidence_error"], 0.1)

    def test_basalt(self):
        """Two laws on a measured step: both fit to the noise; the drop from one steady friction to the other is (a - b) ln 10/3."""
        with netCDF4.Dataset(self.out, "w"):
            pass
        rows = numpy.loadtxt(os.path.join(SOURCE, SERIES), delimiter=",", skiprows=4)
        drop = rows[-30:, 1].mean() - rows[:16, 1].mean()
        bic = {}
        for law in ("aging", "slip"):
            said = self.best(law, SERIES)
            self.assertLess(said["rms_friction"], 4e-4)
            self.assertFalse(said["fits_badly"])
            self.assertEqual((said["frictions"], said["displacements"], said["velocities"]), (80, 0, 0))
            f0, a, b, _, _, error = [p["best"] for p in said["parameters"]]
            self.assertAlmostEqual(f0, rows[:16, 1].mean(), delta=3e-4)
            self.assertAlmostEqual((a - b) * math.log(10 / 3), drop, delta=1.5e-4)
            self.assertEqual(said["parameters"][5]["key"], "error.friction")
            self.assertAlmostEqual(error, said["rms_friction"], delta=5e-5)
            bic[law] = said["bic"]
        self.assertTrue(2 < bic["aging"] - bic["slip"] < 10, bic)
        with netCDF4.Dataset(self.out) as file:
            numpy.testing.assert_allclose(file["observed_friction"][:], rows[:, 1], rtol=1e-9)
            self.assertNotIn("observed_displacement", file.variables)
            self.assertEqual(file["best_friction"].units, "1")
            again = numpy.interp(rows[:, 0], file["prediction_time"][:], file["best_friction"][:])
            self.assertLess(numpy.std(again - rows[:, 1]), 5e-4)
        subprocess.run([sys.executable, os.path.join(SOURCE, "tests/support/check_cf.py"), "--status", "complete", self.out],
                       check=True)

    def test_wrong_requests(self):
        """Each says in one line what is wrong."""
        for change, says in (("fit.displacement=friction:mm", "fit.friction"), ("fit.friction=friction:m", "fit.friction"),
                             ("fit.sigma=friction:m", "fit.sigma"), ("fit.friction_error=0", "fit.friction_error"),
                             ("fit.friction=mu:1", "mu"), ("load.shear.0.machine.displacement=load_point_um:s", "load.shear.0.machine"),
                             ("load.shear.0.machine.file=none.csv", "none.csv"),
                             ("interface={size: 1 m, levels: 3, surface: {self-affine: {hurst: 0.8, rms_height: 1 mm}}}|"
                              "material={shear_modulus: 20 GPa, poisson: 0.25}", "is read for one block")):
            said = self.fit("aging", SERIES, *[w for part in change.split("|") for w in ("--set", part)], status=3 if "none" in change else 2)
            self.assertIn(says, said)
            self.assertLessEqual(len(said.strip().splitlines()), 2, said)
        said = self.fit("aging", SERIES, "--set", "time.end=40 s", status=2)
        self.assertIn(MACHINE, said)


if __name__ == "__main__":
    PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
