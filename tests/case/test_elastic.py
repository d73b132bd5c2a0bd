#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Elastic rock through the whole program: the stress that slip takes off the cells, and how a force reaches them.

usage: test_elastic.py PROGRAM SOURCE_FOLDER [unittest options]
"""

import json
import os
import sys
import unittest

import netCDF4
import numpy

import test_cli

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support"))
import elastic_rock as rock  # noqa: E402  pylint: disable=wrong-import-position

G, NU = 20e9, 0.25

CASE = """\
lacuna: 1
title: Elastic
interface: {{{interface}}}
material: {{shear_modulus: "20 GPa", poisson: 0.25, shear_speed: "3 km/s"}}
load:
  normal: {{pressure: "3 MPa"}}
  shear: {shear}
  {pore}
friction: {{{law}: {{f0: 0.6, a: 0.012, b: 0.010, dc: "1 mm", v0: "1 um/s"}}}}
initial: {initial}
transfer: {transfer}
time: {{end: "2 day", failure: {{mean_slip: "1 m"}}}}
solver: {{rtol: 1e-8, formulation: {formulation}}}
output: {{file: run.nc, every: {{steps: 1000}}, fields: [slip, traction], fields_every: {{steps: 1000}}}}
"""

MASK = "domain: {cascade: {dimension: 1.6, seed: 5}}"
UNEVEN = "spread: {pressure: {lognormal: {sigma: 0.3, seed: 2}}}"
PLANE = 'size: "8 m", levels: 3'
LINE = 'size: "16 m", levels: 4, shape: line'
MASKED_LINE = LINE + ", domain: {cascade: {dimension: 0.7, seed: 4}}, " + UNEVEN
CREEP = ('{slip_rate: "1 mm/week", state: {ratio_to_steady: 1}, '
         "spread: {slip_rate: {lognormal: {sigma: 1, seed: 3}}}}")
RAMP = '[{ramp: {rate: "20 kPa/day", share: elastic}}]'


class Elastic(test_cli.Case):
    def run_case(self, interface, shear=RAMP, initial=CREEP, transfer="elastic: {tolerance: 1e-13}", **how):
        pore = f"pore_pressure: {how['pore']}" if "pore" in how else ""
        self.write("c.yaml", CASE.format(interface=interface, shear=shear, initial=initial, pore=pore,
                                         transfer="{" + transfer + "}", law=how.get("law", "aging"),
                                         formulation=how.get("formulation", "traction")))
        self.report = json.loads(self.expect(0, "run", "c.yaml", "--json", "--force").stdout)
        with netCDF4.Dataset(self.path("run.nc")) as data:
            data.set_auto_mask(False)
            grid = tuple(data.getncattr("grid_" + key) for key in ("nx", "ny", "dx_m", "dy_m"))
            x, y = data["x"][:], data["y"][:]
            index = numpy.floor(y / grid[3]).astype(int) * grid[0] + numpy.floor(x / grid[2]).astype(int)
            if "shape: line" in interface:
                index = numpy.floor(x / grid[2]).astype(int)
            return {"grid": grid, "index": index, "slip": data["cell_slip"][-1], "p": data["pressure"][:],
                    "traction": data["cell_traction"][:], "area": data["cell_area"][0],
                    "force": data["shear_force"][:]}

    def check_balance(self, seen, stiffness, tied, tolerance):
        """tau(end) - tau(0) = shape Q/(n A) - K slip, Q the ramp's at the end; tied None: no load."""
        n = seen["index"].size
        taken = stiffness @ seen["slip"]
        gained = seen["traction"][-1] - seen["traction"][0] + taken
        brought = numpy.zeros(n) if tied is None else tied * 40e3 * seen["grid"][0] * seen["grid"][1] / n
        self.assertGreater(abs(taken).max(), 1e3)
        self.assertLess(abs(gained - brought).max(), tolerance * (abs(taken).max() + abs(brought).max()))
        self.assertLess(abs(gained.sum() - brought.sum()), 1e-12 * abs(seen["traction"]).sum())


class Stress(Elastic):
    """What slip takes off: the operator of docs/theory/transfer.md (11), free and periodic, planes and lines."""

    def check(self, interface, compliance, tolerance, transfer="elastic: {tolerance: 1e-13}", nu=NU):
        seen = self.run_case(interface, "[]", transfer=transfer)
        c = compliance(seen["grid"], seen["index"], G, nu)
        self.assertLess(seen["index"].size, seen["grid"][0] * seen["grid"][1])
        self.check_balance(seen, rock.stiffness(c), None, tolerance)

    def test_periodic_planes(self):
        self.check(f"{PLANE}, {MASK}", rock.periodic, 1e-10)
        self.check(f"{PLANE}, {MASK}", rock.periodic, 1e-10, "elastic: {tolerance: 1e-13, mode: antiplane}", 0)
        self.check(f'size: "9 m", cells_x: 9, cells_y: 7, {MASK}', rock.periodic, 1e-10)

    def test_free_planes(self):
        self.check(f"{PLANE}, {MASK}, boundary: free", rock.alone, 1e-9)
        self.check(f"{PLANE}, {MASK}, boundary: free", rock.alone, 1e-9,
                   "elastic: {tolerance: 1e-13, mode: antiplane}", 0)

    def test_lines(self):
        self.check(MASKED_LINE, rock.periodic, 1e-10)
        self.check(MASKED_LINE + ", boundary: free", rock.alone_line, 1e-10)


class Identities(Elastic):
    """docs/theory/transfer.md (9) to (13) on lacunar masks, in another language."""

    def masks(self):
        for seed, (nx, ny) in enumerate([(8, 8), (12, 10), (16, 16)]):
            keep = numpy.random.default_rng(seed).random(nx * ny) < (0.7, 0.5, 0.25)[seed]
            yield (nx, ny, 1.0, 1.0), numpy.flatnonzero(keep)

    def test_stiffness_of_the_cells(self):
        for grid, index in self.masks():
            for nu in 0, NU:
                c = rock.periodic(grid, index, 1, nu) + 1 / index.size  # any stiffness of the mean will do
                inverse = numpy.linalg.inv(c)
                ones = numpy.ones(index.size)
                k = inverse - numpy.outer(inverse @ ones, ones @ inverse) / (ones @ inverse @ ones)
                self.assertLess(abs(k - rock.stiffness(c)).max(), 1e-12)
                self.assertLess(abs(k - k.T).max(), 1e-12)
                self.assertLess(abs(k @ ones).max(), 1e-12)
                self.assertGreater(numpy.linalg.eigvalsh(k)[0], -1e-12)
                self.assertGreater(numpy.linalg.eigvalsh(k)[1], 0.05)

    def test_held_gaps_are_another_operator(self):
        cost = []
        for fraction in 0.8, 0.2, 0.05:
            index = numpy.flatnonzero(numpy.random.default_rng(7).random(64 * 64) < fraction)
            slip = numpy.zeros(64 * 64)
            slip[index] = 1
            s = rock.wave_stiffness((64, 64, 1.0, 1.0), 1)
            held = numpy.fft.ifft2(s * numpy.fft.fft2(slip.reshape(64, 64))).real.flat[index]
            cost.append(held.mean())
        for found, stated in zip(cost, (0.24, 0.98, 1.13)):
            self.assertLess(abs(found - stated), 0.03)

    def calibrated(self, seen):
        """k_l from what the program's hierarchy takes off, and how well they explain it."""
        means = rock.levels(seen["grid"], seen["index"])
        bands = [(low - high) @ seen["slip"] for low, high in zip(means, means[1:])]
        off = seen["traction"][0] - seen["traction"][-1]
        found = numpy.linalg.lstsq(numpy.array(bands).T, off, rcond=None)
        return means, found[0], abs(off - numpy.array(bands).T @ found[0]).max() / abs(off).max()

    def test_calibration(self):
        for interface, compliance in ((f"{PLANE}, {MASK}", rock.periodic),
                                      (f"{PLANE}, {MASK}, boundary: free", rock.alone)):
            seen = self.run_case(interface, "[]", transfer="hierarchy: {stiffness: elastic}")
            means, found, rest = self.calibrated(seen)
            self.assertLess(rest, 1e-9)
            k = rock.stiffness(compliance(seen["grid"], seen["index"], G, NU))
            for low, high, value in zip(means, means[1:], found):
                band = low - high
                trace = (band * k.T).sum() / round(numpy.trace(band))
                self.assertLess(abs(value / trace - 1), 2e-3)


class Share(Elastic):
    """`share: elastic`: each cell gets Q (C^-1 1)_i / sum of (C^-1 1)."""

    def check(self, interface, compliance, tolerance, nu=NU, transfer="elastic: {tolerance: 1e-13}"):
        seen = self.run_case(interface, transfer=transfer)
        c = compliance(seen["grid"], seen["index"], G, nu)
        self.check_balance(seen, rock.stiffness(c), rock.tied(c), tolerance)
        gained = seen["force"][-1] - seen["force"][0]
        brought = 40e3 * seen["grid"][0] * seen["grid"][1] * seen["area"]
        self.assertLess(abs(gained / brought - 1), 1e-12)
        return seen, rock.tied(c)

    def test_planes(self):
        self.check(f"{PLANE}, {MASK}, {UNEVEN}", rock.periodic, 1e-9)
        self.check(f"{PLANE}, {MASK}", rock.periodic, 1e-9, 0, "elastic: {tolerance: 1e-13, mode: antiplane}")
        self.check(f"{PLANE}, {MASK}, {UNEVEN}, boundary: free", rock.alone, 1e-9)

    def test_edges_carry_more(self):
        seen, tied = self.check(f"{PLANE}, domain: {{full: {{}}}}, boundary: free", rock.alone, 1e-9)
        x, y = seen["index"] % 8, seen["index"] // 8
        border = numpy.minimum(numpy.minimum(x, 7 - x), numpy.minimum(y, 7 - y))
        means = [tied[border == ring].mean() for ring in range(4)]
        self.assertEqual(means, sorted(means, reverse=True))
        self.assertGreater(tied[(border == 0) & ((x == 0) == (y == 0))].min(), 1.2)
        self.assertTrue((tied > 0).all())

    def test_lines(self):
        self.check(MASKED_LINE, rock.periodic, 1e-9)
        self.check(MASKED_LINE + ", boundary: free", rock.alone_line, 1e-9)

    def test_rock_behind(self):
        """Slabs and creeping surroundings: C has a mean of its own."""
        transfer = 'elastic: {tolerance: 1e-13, mode: antiplane, thickness: "2 m"}'
        seen = self.run_case(MASKED_LINE, transfer=transfer)
        c = rock.periodic(seen["grid"], seen["index"], G, 0, 2)
        tied = numpy.linalg.solve(c, numpy.ones(len(c)))
        self.check_balance(seen, numpy.linalg.inv(c), tied / tied.mean(), 1e-8)
        seen = self.run_case(LINE + ", domain: {full: {}}, boundary: free",
                             transfer="elastic: {outside: creeping}")
        k = rock.creeping_line(seen["grid"], G, NU)
        self.check_balance(seen, k, k.sum(axis=1) / k.sum() * len(k), 1e-8)

    def test_other_transfers(self):
        """The rock shares the load, whatever the model of what slip takes off."""
        seen = self.run_case(f"{PLANE}, {MASK}, {UNEVEN}", transfer="none: {}")
        tied = rock.tied(rock.periodic(seen["grid"], seen["index"], G, NU))
        gained = seen["traction"][-1] - seen["traction"][0]
        self.assertLess(abs(gained / gained.mean() - tied).max(), 1e-9)
        seen = self.run_case(f"{PLANE}, {MASK}, {UNEVEN}", transfer='hierarchy: {k0: "10 GPa/m"}')
        means = rock.levels(seen["grid"], seen["index"])
        k = sum(10e9 * 0.5 ** level * (low - high) for level, (low, high) in enumerate(zip(means, means[1:])))
        self.check_balance(seen, k, tied, 1e-9)

    def test_full_periodic_contact_is_equal(self):
        ends = []
        for share in "elastic", "equal":
            seen = self.run_case(f"{PLANE}, domain: {{full: {{}}}}, {UNEVEN}", RAMP.replace("elastic", share))
            ends.append(seen["traction"][-1])
        self.assertLess(abs(ends[0] / ends[1] - 1).max(), 1e-14)

    def test_formulations_agree(self):
        loads = ('[{ramp: {rate: "20 kPa/day", share: elastic}}, '
                 '{step: {value: "10 kPa", at: "1 day", share: elastic}}, '
                 '{sine: {amplitude: "5 kPa", period: "10 h", share: elastic}}, '
                 '{ramp: {rate: "5 kPa/day", share: equal}}, {sine: {amplitude: "2 kPa", period: "7 h"}}]')
        pore = '[{ramp: {rate: "50 kPa/day"}}]'
        for law in "aging", "slip", "composite":
            ends = []
            for formulation in "rate", "traction", "slip":
                seen = self.run_case(f"{PLANE}, {MASK}, {UNEVEN}", loads, law=law, pore=pore,
                                     formulation=formulation)
                self.assertLess(self.report["balance_residual"], 1e-4)
                ends.append(seen["slip"])
            for end in ends[1:]:
                self.assertLess(abs(end / ends[0] - 1).max(), 1e-5)

    def test_constant_loads(self):
        """Q of ratio and slope is that of P; a pore pressure takes none of it away."""
        for load in "ratio: {value: 0.5, share: elastic}", "slope: {angle: 0.46364760900080615, share: elastic}":
            for pore in "[]", '[{constant: {value: "0.3 MPa"}}]':
                seen = self.run_case(f"{PLANE}, {MASK}, {UNEVEN}", f"[{{{load}}}]", '{state: "1e5 s"}', pore=pore)
                tied = rock.tied(rock.periodic(seen["grid"], seen["index"], G, NU))
                total = 0.5 * seen["p"].sum() * seen["area"]
                self.assertLess(abs(seen["force"] / total - 1).max(), 1e-12)
                first = seen["traction"][0] * tied.size * seen["area"] / total
                self.assertLess(abs(first - tied).max(), 1e-9)
        seen = self.run_case(f"{PLANE}, {MASK}, {UNEVEN}", "[{ratio: {value: 0.5, share: equal}}]",
                             '{state: "1e5 s"}')
        self.assertLess(abs(seen["traction"][0] / seen["traction"][0].mean() - 1).max(), 1e-12)

    def test_wrong(self):
        self.write("c.yaml", CASE.format(interface='size: "1 m"', shear=RAMP, initial=CREEP, pore="",
                                         transfer="{none: {}}", law="aging", formulation="rate"))
        self.expect_line(2, 'c.yaml:7: load.shear.0.ramp.share: "elastic" needs cells to be shared by: '
                            "interface.domain or interface.surface", "check", "c.yaml")
        self.run_case(f"{PLANE}, {MASK}", transfer="none: {}")
        with open(self.path("c.yaml"), encoding="utf-8") as file:
            text = file.read()
        self.write("c.yaml", "".join(row + "\n" for row in text.splitlines() if "material" not in row))
        self.expect_line(2, 'c.yaml:6: load.shear.0.ramp.share: "elastic" needs material.shear_modulus, such as '
                            '"20 GPa"', "check", "c.yaml")


class ByHand(Elastic):
    """A run on the hierarchy, worked out anew from its file alone: docs/format.md."""

    def taken_off(self, data, slip):
        """K slip = sum of k_l (P_l - P_(l+1)) slip, block by block of the grid."""
        column = numpy.floor(data["x"][:] / data.grid_dx_m).astype(int)
        row = numpy.floor(data["y"][:] / data.grid_dy_m).astype(int)
        means = []
        for level in range(len(data.dimensions["level"])):
            _, block = numpy.unique((row >> level) * 2**20 + (column >> level), return_inverse=True)
            self.assertEqual(block.max() + 1, data["n_tot"][level])
            means.append((numpy.bincount(block, slip) / numpy.bincount(block))[block])
        k = data["hierarchy_stiffness"][:]
        self.assertTrue(numpy.ma.getmaskarray(k).tolist() == [False] * (len(means) - 1) + [True])
        return sum(k[level] * (means[level] - means[level + 1]) for level in range(len(means) - 1))

    def test_the_hierarchy(self):
        case = os.path.join(test_cli.SOURCE, "cases", "transfer", "hierarchy.yaml")
        law = "{f0: 0.6, a: 0.010, b: 0.015, dc: 1 mm, v0: 1 um/s}"
        for transfer in ("{stiffness: elastic}", "{k0: 5 GPa/m, ratio: 0.4}"):
            self.expect(0, "run", case, "-o", "run.nc", "--force", "--set", f"transfer={{hierarchy: {transfer}}}", "--set",
                        f"friction={{aging: {law}}}", "--set", "material={shear_modulus: 20 GPa}", "--set",
                        "solver={rtol: 1e-8, formulation: slip}", "--set",
                        "output={fields: [slip, slip_rate, state, traction], fields_every: {per_decade: 4}}")
            with netCDF4.Dataset(self.path("run.nc")) as data:
                self.assertEqual(data["hierarchy_stiffness"].units, "Pa m-1")
                p, slip, traction = data["pressure"][:], data["cell_slip"][:], data["cell_traction"][:]
                strength = 0.6 + 0.010 * numpy.log(data["cell_slip_rate"][:] / 1e-6) + 0.015 * numpy.log(
                    1e-6 * data["cell_state"][:] / 1e-3)
                if "k0" in transfer:
                    want = 5e9 * 0.4 ** numpy.arange(6)
                    self.assertLess(abs(data["hierarchy_stiffness"][:6] / want - 1).max(), 1e-14)
                for i in range(1, len(slip)):  # under a constant load
                    taken = self.taken_off(data, slip[i])
                    self.assertLess(abs(traction[i] - traction[0] + taken).max(), 1e-9 * p.max())
                    self.assertLess(abs(strength[i] * p - traction[i]).max(), 1e-9 * p.max())
                self.assertGreater(abs(taken).max(), 1e-4 * p.max())
        self.expect(0, "run", os.path.join(test_cli.SOURCE, "cases", "transfer", "none.yaml"), "-o", "run.nc", "--force")
        with netCDF4.Dataset(self.path("run.nc")) as data:
            self.assertNotIn("hierarchy_stiffness", data.variables)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    test_cli.PROGRAM, test_cli.SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])


if __name__ == "__main__":
    main()
