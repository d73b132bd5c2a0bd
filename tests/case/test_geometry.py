#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A base whose dip and thickness follow the slip: closed forms, the plane as its limit, arrest, restart, refusals.

usage: test_geometry.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import math
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli
from test_cli import Case

G = 9.80665
UM = 1e-6

CREEP = """\
lacuna: 1
interface: {geometry: {angle: "%(angle)r degree", radius: "%(radius)r m", thickness: "%(thickness)r m"}}
material: {density: "2500 kg/m3"}
friction: {aging: {f0: 0.6, a: 0.01, b: 0, dc: "1 mm", v0: "1 um/s", form: %(form)s}}
time: {end: "20 year", failure: {mean_slip: "1 km"}}
solver: {rtol: 1e-8}
"""

# a = b: steady friction is f0 at any rate, and a tenth of a millimetre of slip away from the old state at the start.
SLIDE = """\
lacuna: 1
interface: {geometry: {angle: "45 degree", radius: "200 m", thickness: "50 m"}}
material: {density: "2500 kg/m3"}
friction: {aging: {f0: 0.6, a: %(a)r, b: %(a)r, dc: "%(dc)s", v0: "1 um/s"}}
initial: {slip_rate: "1 mm/s"}
inertia: {thickness: "%(mass)r m"}
time: {end: "%(end)s", failure: {mean_slip: "1 km", mean_slip_rate: "1 km/s"}}
solver: {rtol: 1e-9}
"""

ROUGH = """\
lacuna: 1
interface:
  size: "128 m"
  levels: 4
  domain: {cascade: {dimension: 1.7, seed: 3}}
  %(geometry)s
material: {density: "2500 kg/m3", shear_modulus: "5 GPa", shear_speed: "1.5 km/s"}
load:
  %(normal)s
  shear: [%(shear)s{sine: {amplitude: "3 kPa", period: "20 day"}}]
  pore_pressure: [{constant: {value: "0.1 MPa"}}, {ramp: {rate: "0.1 kPa/day"}}]
friction: {aging: {f0: 0.6, a: 0.012, b: %(b)s, dc: "5 mm", v0: "1 mm/day"}, spread: {f0: {normal: {sigma: 0.02, seed: 4}}}}
%(more)s
transfer: {hierarchy: {stiffness: elastic}}
time: {end: "60 day", failure: {mean_slip: "1 km"}}
solver: {formulation: %(formulation)s}
output: {fields: [slip, slip_rate, traction], fields_every: "15 day", checkpoint: {steps: 40}}
"""

FEW = ROUGH.replace("levels: 4", "levels: 3")

CHAIR = """geometry:
    slip: [0 m, 0.5 m, 2 m]
    angle: [32 degree, 30 degree, 25 degree]
    thickness: [50 m, 48 m, 40 m]"""


def fill(text, **of):
    return text % {"geometry": CHAIR, "normal": "", "shear": "", "b": 0.008, "more": "", "formulation": "auto", **of}


class Geometry(Case):
    def follow(self, text, *words):
        self.write("case.yaml", text)
        done = self.expect(0, "run", "case.yaml", "--json", "--force", "-o", "out.nc", *words)
        with netCDF4.Dataset(self.path("out.nc")) as data:
            data.set_auto_mask(False)
            series = {name: numpy.array(v[...]) for name, v in data.variables.items()}
            self.attributes = {name: data.getncattr(name) for name in data.ncattrs()}
        return json.loads(done.stdout), series


class ClosedForm(Geometry):
    def test_creep_on_a_circle(self):
        """Friction that follows the rate alone: v = v0 exp((tan(alpha(slip)) - f0)/a), at every record."""
        for form in ("plain", "regularised"):
            for angle, radius, thickness in ((32.0, 200.0, 50.0), (31.5, 20.0, 5.0), (33.0, 3000.0, 100.0)):
                with self.subTest(form=form, radius=radius):
                    summary, run = self.follow(CREEP % {"angle": angle, "radius": radius, "thickness": thickness, "form": form})
                    alpha = math.radians(angle) - run["slip"] / radius
                    rate = UM * numpy.exp((numpy.tan(alpha) - 0.6) / 0.01)
                    self.assertLess(numpy.abs(run["slip_rate"] / rate - 1).max(), 1e-9)
                    self.assertLess(numpy.abs(run["angle"] - numpy.degrees(alpha)).max(), 1e-12)
                    # the weight stays, so H cos(alpha) does
                    weight = 2500 * G * thickness * math.cos(math.radians(angle))
                    self.assertLess(numpy.abs(run["normal_force"] / (weight * numpy.cos(alpha)) - 1).max(), 1e-12)
                    self.assertLess(numpy.abs(run["shear_force"] / (weight * numpy.sin(alpha)) - 1).max(), 1e-12)
                    kept = run["thickness"] * numpy.cos(alpha) / (thickness * math.cos(math.radians(angle)))
                    self.assertLess(numpy.abs(kept - 1).max(), 1e-12)
                    safety = (0.6) / numpy.tan(alpha)
                    self.assertLess(numpy.abs(run["factor_of_safety"] / safety - 1).max(), 1e-12)
                    # and slip itself: the trapezoid of dt = dslip/v, with as many points as it takes
                    slip = numpy.linspace(0, run["slip"][-1], 200001)
                    slowness = 1 / (UM * numpy.exp((numpy.tan(math.radians(angle) - slip / radius) - 0.6) / 0.01))
                    time = numpy.trapz(slowness, slip)
                    self.assertLess(abs(time / run["time"][-1] - 1), 1e-6)
                    self.assertTrue(summary["arrested"])

    def test_a_block_slides_to_rest_on_a_circle(self):
        """m v dv/dslip = W (sin - f cos) - f m v^2/R has the solution v^2/(g R) = A cos + B sin + C exp(2 f alpha)."""
        f, start, radius = 0.6, math.radians(45), 200.0
        a, b = (2 - 4 * f**2) / (1 + 4 * f**2), 6 * f / (1 + 4 * f**2)
        def energy(alpha):
            return a * numpy.cos(alpha) + b * numpy.sin(alpha)
        weight = 50 * math.cos(start)
        summary, run = self.follow(SLIDE % {"mass": weight, "a": 0.01, "dc": "1 um", "end": "1 min"})
        alpha = start - run["slip"] / radius
        squared = G * radius * (energy(alpha) - energy(start) * numpy.exp(2 * f * (alpha - start)))
        fast = run["slip_rate"] > 0.5
        self.assertGreater(fast.sum(), 100)
        self.assertLess(numpy.abs(run["slip_rate"]**2 - squared)[fast].max() / squared.max(), 1e-5)
        low, high = math.radians(10), math.radians(30)
        for _ in range(60):
            middle = 0.5 * (low + high)
            slides = energy(middle) - energy(start) * math.exp(2 * f * (middle - start)) > 0
            low, high = (low, middle) if slides else (middle, high)
        self.assertLess(abs(summary["mean_slip_m"] / (radius * (start - low)) - 1), 1e-5)
        self.assertTrue(summary["arrested"])
        self.assertLess(abs(summary["largest_mean_slip_rate_m_s"]**2 / squared.max() - 1), 1e-4)
        # where it stops does not depend on the mass that the weight moves
        light, _ = self.follow(SLIDE % {"mass": 0.1 * weight, "a": 0.01, "dc": "1 um", "end": "1 min"})
        self.assertLess(abs(light["mean_slip_m"] / summary["mean_slip_m"] - 1), 1e-5)


class Plane(Geometry):
    def test_what_does_not_change_is_the_plane(self):
        """A table of the same values, a number and a very large radius against the loads of a slope: the first two to the bit."""
        slope = {"normal": 'normal: {slope: {thickness: "50 m", angle: "31 degree"}}',
                 "shear": '{slope: {angle: "31 degree"}}, ', "geometry": "boundary: periodic"}
        table = "geometry: {slip: [-1 m, 0 m, 3 m], angle: [31 degree, 31 degree, 31 degree], thickness: [50 m, 50 m, 50 m]}"
        number = "geometry: {angle: 31 degree, thickness: 50 m}"
        for more, formulation in (("", "slip"), ('inertia: {thickness: "40 m"}\ninitial: {slip_rate: "1 mm/day"}', "auto")):
            of = {"more": more, "formulation": formulation}
            _, plane = self.follow(fill(FEW, **slope, **of))
            for geometry in (table, number):
                with self.subTest(geometry=geometry, formulation=formulation):
                    _, bent = self.follow(fill(FEW, **{**of, "geometry": geometry}))
                    for name, values in plane.items():
                        self.assertEqual(values.tobytes(), bent[name].tobytes(), name)
            _, wide = self.follow(fill(FEW, **{**of, "geometry": "geometry: {angle: 31 degree, thickness: 50 m, radius: 1e9 m}"}))
            self.assertLess(abs(wide["slip"][-1] / plane["slip"][-1] - 1), 1e-5)

    def test_pressure_in_the_place_of_a_thickness(self):
        """The weight on the base at the start, given as the normal stress that it makes: the same but for rounding."""
        cos = math.cos(math.radians(32))
        given = 'normal: {pressure: "%r Pa"}' % (2500 * G * 50 * cos**2)
        bent = "geometry: {angle: 32 degree, radius: 40 m%s}"
        _, thick = self.follow(fill(ROUGH, geometry=bent % ", thickness: 50 m"))
        _, pressed = self.follow(fill(ROUGH, geometry=bent % "", normal=given))
        self.assertLess(numpy.abs(pressed["slip"][-1] / thick["slip"][-1] - 1), 1e-6)
        self.assertNotIn("thickness", pressed)


class Chair(Geometry):
    def test_the_forces_follow_the_tables(self):
        """At every record P and Q are those of the dip and thickness that the file has; at the nodes these are the case's, and
        beyond the last they stay."""
        _, run = self.follow(fill(ROUGH), "--set", "time.end=2000 day", "--set", "load.pore_pressure=[]")
        area, swing = 128.0**2, 3e3 * 128.0**2
        alpha, h = numpy.radians(run["angle"]), run["thickness"]
        pressure = 2500 * G * h * numpy.cos(alpha)**2 * area
        self.assertLess(numpy.abs(run["normal_force"] / pressure - 1).max(), 1e-12)
        shear = pressure * numpy.tan(alpha) + swing * numpy.sin(2 * math.pi * run["time"] / (20 * 86400))
        self.assertLess(numpy.abs(run["shear_force"] / shear - 1).max(), 1e-9)
        self.assertTrue((numpy.diff(run["angle"]) <= 0).all() and (numpy.diff(run["thickness"]) <= 0).all())
        self.assertLess(run["balance_residual"].max(), 1e-12)

    def test_slopes_of_the_table(self):
        """Whatever the way: explicit steps, steps of other orders and tolerances come to the same slip."""
        _, bdf = self.follow(fill(FEW), "--set", "solver.rtol=1e-9")
        for words in (("solver.method=erk",), ("solver.method=adams",), ("solver.rtol=1e-6",)):
            with self.subTest(words=words):
                _, other = self.follow(fill(FEW), *(word for w in words for word in ("--set", w)))
                self.assertLess(abs(other["slip"][-1] / bdf["slip"][-1] - 1), 1e-4)

    def test_the_bundled_case(self):
        path = os.path.join(test_cli.SOURCE, "cases", "load", "chair.yaml")
        summary = json.loads(self.expect(0, "run", path, "--json", "-o", "chair.nc").stdout)
        self.assertFalse(summary["failed"])
        self.assertTrue(summary["arrested"])
        self.assertEqual(summary["ended_by"], "end")
        self.assertTrue(1 < summary["largest_mean_slip_rate_m_s"] * 86400 < 2)
        self.assertLess(summary["mean_slip_rate_m_s"] * 86400, 1e-5)
        text = self.expect(0, "run", path, "-o", "chair.nc", "--force").stdout
        self.assertRegex(text, r"arrest  +arrested: at most 1\.5\d* m/day after 94\.\d+ day, slowed to 2\.\d+ mm/year by the end")
        plane = self.expect(0, "run", path, "-o", "chair.nc", "--force", "--set", "interface.geometry={angle: 32 degree, thickness: 60 m}")
        self.assertRegex(plane.stdout, r"failure +after")
        self.assertNotIn("arrest ", plane.stdout)

    def test_a_block_that_rests_ends_the_run(self):
        text = (SLIDE % {"mass": 35.0, "a": 5e-4, "dc": "10 um", "end": "1 day"}).replace("45 degree", "40 degree")
        summary, run = self.follow(text)
        self.assertEqual((summary["ended_by"], summary["status"], summary["arrested"]), ("rest", "complete", True))
        self.assertLess(run["slip_rate"][-1], 1e-25)
        self.assertRegex(self.attributes["arrest"], "^arrested")


TOE = """\
lacuna: 1
interface:
  size: "%(length)r m"
  geometry: %(geometry)s
material: {density: "2400 kg/m3"}
load: {pore_pressure: [{toe: {file: lake.csv, time: time, column: "level:m", elevation: 600 m, outside: hold%(angle)s}}]}
friction: {aging: {f0: %(f0)r, a: 0.05, b: 0, dc: "5 mm", v0: "1 m/day"}}
time: {end: "12 day", failure: {mean_slip: "1 km"}}
solver: {rtol: 1e-7}
"""


class Toe(Geometry):
    def test_against_columns_added_up(self):
        """P - U and Q at every record: of 40 000 columns of the mass each its weight, and the buoyancy of what stands in the lake."""
        self.write("lake.csv", "time,level\n0,590\n86400,690\n432000,605\n864000,640\n")
        circle = "{angle: 25 degree, radius: 300 m, thickness: 40 m}"
        chair = "{slip: [0 m, 5 m, 30 m], angle: [25 degree, 20 degree, -4 degree], thickness: [40 m, 38 m, 20 m]}"
        at = (numpy.arange(40000) + 0.5) / 40000
        for geometry, length, angle, f0 in ((circle, 100.0, None, 0.40), (chair, 150.0, None, 0.35), (chair, 150.0, 3.0, 0.40)):
            with self.subTest(geometry=geometry, angle=angle):
                _, run = self.follow(TOE % {"geometry": geometry, "length": length, "f0": f0,
                                            "angle": "" if angle is None else f", angle: {angle!r} degree"})
                self.assertGreater(run["slip"][-1], 3)
                alpha, h = numpy.radians(run["angle"]), run["thickness"]
                level = numpy.interp(run["time"], [0, 86400, 432000, 864000], [590, 690, 605, 640])
                self.assertLess(numpy.abs(run["lake_level"] - level).max(), 1e-9)
                # how far the mass has come down: on the circle R (cos - cos), on the table by trapezoids of the file's own dip
                fall = numpy.concatenate([[0], numpy.cumsum(numpy.diff(run["slip"]) * numpy.sin(0.5 * (alpha[1:] + alpha[:-1])))])
                exact = geometry == circle
                if exact:
                    fall = 300 * (numpy.cos(alpha) - math.cos(math.radians(25)))
                wet = numpy.array([numpy.clip(z + f - 600 - length * s * at, 0, top).mean()
                                   for z, f, s, top in zip(level, fall, numpy.sin(alpha), h)])
                there = alpha if angle is None else math.radians(angle)
                normal = G * (2400 * h * numpy.cos(alpha)**2 - 1000 * wet * numpy.cos(there)**2) * length**2
                shear = G * (2400 * h * numpy.sin(alpha) * numpy.cos(alpha)
                             - 1000 * wet * numpy.sin(there) * numpy.cos(there)) * length**2
                scale = 2400 * G * h * length**2
                within = 1e-9 if exact else 1e-3
                self.assertLess((numpy.abs(run["effective_normal_force"] - normal) / scale).max(), within)
                self.assertLess((numpy.abs(run["shear_force"] - shear) / scale).max(), within)
                self.assertTrue(wet.min() == 0 and (wet > 0.3 * h).any())

    def test_a_mass_all_under_water(self):
        """(rho - rho_w) g H in the place of rho g H: the ratio Q/(P - U) is that of the dry slope, tan(alpha)."""
        self.write("lake.csv", "time,level\n0,900\n86400,900\n")
        _, run = self.follow(TOE % {"geometry": "{angle: 25 degree, thickness: 40 m}", "length": 100.0, "f0": 0.45, "angle": ""})
        self.assertLess(numpy.abs(run["effective_ratio"] / math.tan(math.radians(25)) - 1).max(), 1e-12)
        cos = math.cos(math.radians(25))
        self.assertLess(numpy.abs(run["effective_normal_force"] / (1400 * G * 40 * cos**2 * 100**2) - 1).max(), 1e-12)

    def test_the_bundled_case(self):
        """A toe on the flat part floats and takes hold off the slope: creep follows the lake."""
        path = os.path.join(test_cli.SOURCE, "cases", "load", "toe.yaml")
        self.expect(0, "run", path, "-o", "toe.nc")
        with netCDF4.Dataset(self.path("toe.nc")) as data:
            level, rate = data["lake_level"][:], data["slip_rate"][:]
            self.assertGreater(rate[level.argmax()], 30 * rate[0])
            self.assertGreater(numpy.corrcoef(level, numpy.log(rate))[0, 1], 0.9)

    def test_refused(self):
        self.write("lake.csv", "time,level\n0,900\n86400,900\n")
        base = TOE % {"geometry": "{angle: 25 degree, thickness: 40 m}", "length": 100.0, "f0": 0.45, "angle": ""}
        for change, said in (
                (('  size: "100.0 m"\n', ""), "load.pore_pressure.0.toe: needs interface.size"),
                (("outside: hold}}", "outside: hold}}, {toe: {level: 3 m, elevation: 1 m}}"), "load.pore_pressure.1.toe: is a second lake")):
            with self.subTest(said=said):
                self.assertIn(change[0], base)
                self.write("case.yaml", base.replace(*change))
                self.assertIn(said, self.expect(2, "check", "case.yaml").stderr)
        plain = base.replace(", thickness: 40 m", "").replace("load: {", "load: {normal: {pressure: 1 MPa}, ")
        for text in (plain, plain.replace("  geometry: {angle: 25 degree}\n", "")):
            self.write("case.yaml", text)
            self.assertIn("load.pore_pressure.0.toe: needs interface.geometry with a thickness", self.expect(2, "check", "case.yaml").stderr)


class Refused(Geometry):
    def refuse(self, text, *lines):
        self.write("case.yaml", text)
        said = self.expect(2, "check", "case.yaml").stderr
        for line in lines:
            self.assertIn("lacuna: case.yaml:" + line, said)

    def test_what_says_the_angle_twice(self):
        text = ("lacuna: 1\ninterface:\n  geometry: {angle: 30 degree, thickness: 50 m}\nload:\n"
                "  normal: {slope: {thickness: 50 m, angle: 30 degree}}\n  shear:\n    - slope: {angle: 30 degree}\n"
                "material: {density: 2500 kg/m3}\nfriction: {aging: {f0: 0.6, a: 0.01, b: 0.008, dc: 1 mm, v0: 1 um/s}}\n"
                "time: {end: 1 day}\n")
        self.refuse(text, "5: load.normal.slope: has an angle, which interface.geometry says",
                    "7: load.shear.0.slope: has an angle, which interface.geometry says")

    def test_two_dips_are_doubted(self):
        for pull, doubts in ((30, 0), (35, 1)):
            self.write("case.yaml", "lacuna: 1\nload: {normal: {slope: {thickness: 50 m, angle: 30 degree}}, shear: [{slope: {angle: %d degree}}]}\n"
                       "material: {density: 2500 kg/m3}\nfriction: {aging: {f0: 0.6, a: 0.01, b: 0.008, dc: 1 mm, v0: 1 um/s}}\n"
                       "initial: {slip_rate: 1 mm/day}\ntime: {end: 1 day}\n" % pull)
            self.assertEqual(self.expect(0, "check", "case.yaml").stderr.count(
                "lacuna: warning: case.yaml:2: load.shear.0.slope.angle: \"35 degree\" is not that of load.normal.slope: a joint has one dip"), doubts)

    def test_lists_and_numbers(self):
        base = CREEP % {"angle": 30.0, "radius": 100.0, "thickness": 50.0, "form": "plain"}
        good = 'geometry: {angle: "30.0 degree", radius: "100.0 m", thickness: "50.0 m"}'
        self.assertIn(good, base)
        for geometry, said in (
                ("{angle: [30 degree, 20 degree], thickness: 50 m}", "angle: is a list, which needs interface.geometry.slip"),
                ("{slip: [0 m, 1 m, 2 m], angle: [30 degree, 20 degree], thickness: 50 m}", "angle: has 2 values, and interface.geometry.slip has 3"),
                ("{slip: [0 m, 0 m], angle: [30 degree, 20 degree], thickness: 50 m}", "slip.1: \"0 m\" must be above the one before"),
                ("{slip: [0 m, 1 m], angle: 30 degree, thickness: 50 m}", "slip: has no effect"),
                ("{slip: 1 m, angle: 30 degree, thickness: 50 m}", "slip: \"1 m\" must be a list"),
                ("{slip: [0 m, 1 m], angle: [30 degree, 20 degree], radius: 9 m, thickness: 50 m}", "radius: \"9 m\" goes with one angle"),
                ("{thickness: 50 m}", "angle: is missing"),
                ("{angle: 90 degree, thickness: 50 m}", "angle: \"90 degree\" must be"),
                ("{angle: 30 kg, thickness: 50 m}", "angle: \"30 kg\" must be"),
                ("{angle: 30 degree, thickness: 0 m}", "thickness: \"0 m\" must be > 0"),
                ("{angle: [30 degree], thickness: 50 m}", "angle: has 1 values; a list must have from 2 to 64"),
                ("{angle: 30 degree, thickness: 50 m, depth: 3 m}", "depth: is no key here")):
            with self.subTest(geometry=geometry):
                self.refuse(base.replace(good, "geometry: " + geometry), "2: interface.geometry." + said)

    def test_what_cannot_follow(self):
        base = CREEP % {"angle": 30.0, "radius": 100.0, "thickness": 50.0, "form": "plain"}
        for change, said in (
                (("rtol: 1e-8", "formulation: rate"), "6: solver.formulation: \"rate\" does not hold the slip"),
                (("rtol: 1e-8", "formulation: traction"), "6: solver.formulation: \"traction\" does not hold the slip"),
                (("rtol: 1e-8", "fidelity: events"), "6: solver.fidelity: \"events\" knows no interface.geometry"),
                (("b: 0,", "b: 0.005, alpha: 0.2,"), "4: friction.aging.alpha: \"0.2\" responds to the normal stress"),
                (("friction:", "load: {normal: {pressure: 1 MPa}}\nfriction:"), "4: load.normal.pressure: \"1 MPa\" is given beside interface.geometry.thickness"),
                (('material: {density: "2500 kg/m3"}\n', ""), "material.density: is missing: needed by interface.geometry.thickness"),
                ((', thickness: "50.0 m"', ""), "load.normal: is missing"),
                (("time:", "initial: {slip_rate: 1 mm/day, state: 1 day}\ntime:"), "2: interface.geometry: fixes the shear load")):
            with self.subTest(change=change):
                self.assertIn(change[0], base)
                self.write("case.yaml", base.replace(*change))
                self.assertIn(said, self.expect(2, "check", "case.yaml").stderr)

    def test_what_check_says(self):
        """Of a circle the slip where friction holds is R (alpha - atan f0), of two nodes the middle of their cubic."""
        for geometry, said in (
                ("{angle: 32 degree, radius: 100 m, thickness: 50 m}", "32 degree at the start and 26.27 after 10 m of slip: dry, friction at v0 (31 degree) holds its weight from 1.7"),
                ("{angle: 32 degree, thickness: 50 m}", "32 degree: more than friction at v0 holds (31 degree), so that the base arrests nothing"),
                ("{angle: 25 degree, thickness: 50 m}", "25 degree: dry, friction at v0 (31 degree) holds its weight from the start"),
                ("{slip: [0 m, 8 m], angle: [35 degree, 27 degree], thickness: 50 m}", "35 degree at the start and 27 after 8 m of slip: dry, friction at v0 (31 degree) holds its weight from 4 m")):
            with self.subTest(geometry=geometry):
                text = CREEP % {"angle": 30.0, "radius": 100.0, "thickness": 50.0, "form": "plain"}
                self.write("case.yaml", text.replace('{angle: "30.0 degree", radius: "100.0 m", thickness: "50.0 m"}', geometry)
                           .replace("f0: 0.6,", f"f0: {math.tan(math.radians(31))!r},"))
                words = json.loads(self.expect(0, "check", "case.yaml", "--json").stdout)["estimate"]["regime_words"]
                self.assertIn("The base dips by " + said, words)

    def test_a_lake_that_lifts_the_mass_is_said(self):
        """Rock as light as pumice, and a lake that rises over it."""
        self.write("lake.csv", "t,level\n0,0\n1e7,200\n")
        self.write("case.yaml", "lacuna: 1\ninterface: {size: 100 m, geometry: {angle: 10 degree, thickness: 20 m}}\n"
                   "material: {density: 900 kg/m3}\nload: {pore_pressure: [{toe: {file: lake.csv, time: t, column: 'level:m', elevation: 0 m}}]}\n"
                   "friction: {aging: {f0: 0.6, a: 0.01, b: 0.008, dc: 1 mm}}\ninitial: {slip_rate: 1 nm/s}\ntime: {end: 100 day}\n")
        self.assertIn("the lake at the toe and the pore pressure lift the mass at t = ", self.expect(1, "run", "case.yaml").stderr)

    def test_a_base_that_does_not_pull_is_said(self):
        text = (CREEP % {"angle": 30.0, "radius": 100.0, "thickness": 50.0, "form": "plain"}).replace("30.0 degree", "-5 degree")
        self.write("case.yaml", text)
        self.expect_line(2, "case.yaml:2: interface.geometry.angle: \"-5 degree\" must give a shear load at the start, "
                         "such as [{ratio: {value: 0.58}}], unless initial gives both slip_rate and state",
                         "run", "case.yaml")

    def test_its_text_reads_back(self):
        for text in (fill(ROUGH), CREEP % {"angle": 30.0, "radius": 100.0, "thickness": 50.0, "form": "plain"}):
            self.write("case.yaml", text)
            said = self.expect(0, "check", "case.yaml").stdout.split("\n# ")[0]
            self.write("again.yaml", said)
            self.assertEqual(self.expect(0, "check", "again.yaml").stdout.split("\n# ")[0], said)


if __name__ == "__main__":
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
