#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that netCDF files of Lacuna keep to CF-1.10 and ACDD-1.3 as far as these can be tested.

    check_cf.py [--status STATUS] FILE...

For each file: the global attributes that every file must have; for each variable a long_name and
units that UDUNITS reads; standard names that exist, with a unit of their dimension; coordinates,
cell_measures and cell_methods that resolve; no _FillValue on coordinates; time that never
decreases and, as time_origin + time_local, strictly increases; no missing value where none may be;
and that xarray opens the file as it is. Prints one line per fault; exits 1 if there is any.
"""
import argparse
import ctypes
import ctypes.util
import re
import sys
from fractions import Fraction

import netCDF4
import numpy
import xarray

GLOBALS = ["Conventions", "title", "summary", "source", "history", "date_created", "libraries",
           "lacuna_format_version", "status"]
RUN_GLOBALS = ["case"]
ENDED_GLOBALS = ["wall_time_s", "failed"]
STATUS = {"running", "complete", "failed", "interrupted"}
STANDARD_NAMES = {"time": "s", "cell_area": "m2"}  # the names in use, with their canonical units
MAY_BE_MISSING = {"step_size", "order", "hierarchy_stiffness", "box_local_dimension",
                  "resolution_local_dimension",
                  "cycle_start", "cycle_dissipation", "cycle_shift", "highest_ratio", "highest_x",
                  "highest_y", "critical_fraction", "critical_fraction_error", "map_slope",
                  "map_slope_error", "map_slope_low", "map_slope_high", "map_intercept", "exponent",
                  "exponent_error", "exponent_low", "exponent_high", "q_crit_error", "q_crit_sd",
                  "q_crit_sd_of_places",
                  "cluster_exponent", "strength", "slip_load", "criticality",
                  "correlation_length", "interface_seed", "d_box", "d_blocks",
                  "critical_fraction_low", "critical_fraction_high", "run_critical_fraction",
                  "run_critical_fraction_low", "run_critical_fraction_high", "run_lambda",
                  "run_lambda_low", "run_lambda_high", "event_moment", "failure_time",
                  "failure_time_raw", "pooled_time", "rate", "rate_change",
                  "failure_time_low50", "failure_time_high50", "failure_time_low90",
                  "failure_time_high90", "window_start", "rms", "misfit", "excess",
                  "relative_error",
                  "best_displacement", "predicted_displacement", "predicted_slip_rate",
                  "observed_displacement", "observed_slip_rate"}
# What xarray does not show of a file unless asked: a copy for ArviZ of what the file itself holds.
INFERENCE = {"posterior", "sample_stats", "observed_data", "posterior_predictive", "log_likelihood"}
CELL_METHOD = re.compile(
    r"^(?:(?:time|area|cell|snapshot): )+(?:point|mean|sum|maximum|minimum)"
    r"(?: (?:(?:time|area|cell|snapshot): )+(?:point|mean|sum|maximum|minimum))*$")


class Udunits:
    """The few calls of libudunits2 that tell whether a unit can be read and converted."""

    def __init__(self):
        self.lib = ctypes.CDLL(ctypes.util.find_library("udunits2"))
        self.lib.ut_set_error_message_handler.argtypes = [ctypes.c_void_p]
        ignore = ctypes.cast(self.lib.ut_ignore, ctypes.c_void_p)
        self.lib.ut_set_error_message_handler(ignore)
        self.lib.ut_read_xml.restype = ctypes.c_void_p
        self.lib.ut_read_xml.argtypes = [ctypes.c_char_p]
        self.lib.ut_parse.restype = ctypes.c_void_p
        self.lib.ut_parse.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
        self.lib.ut_are_convertible.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
        self.system = self.lib.ut_read_xml(None)

    def parse(self, text):
        return self.lib.ut_parse(self.system, text.strip().encode(), 2)  # 2: UTF-8

    def convertible(self, a, b):
        ua, ub = self.parse(a), self.parse(b)
        return bool(ua and ub and self.lib.ut_are_convertible(ua, ub))


class Checker:
    def __init__(self, path, units, status):
        self.path, self.units, self.status = path, units, status
        self.faults = []

    def fault(self, text):
        self.faults.append(f"{self.path}: {text}")

    def check(self):
        with netCDF4.Dataset(self.path) as data:
            data.set_auto_maskandscale(False)
            self.check_globals(data)
            for var in data.variables.values():
                self.check_variable(data, var)
            self.check_time(data)
            self.check_missing(data)
        self.check_xarray()
        return self.faults

    def check_globals(self, data):
        wanted = GLOBALS + (RUN_GLOBALS if "time" in data.dimensions else [])
        status = getattr(data, "status", None)
        if "time" in data.dimensions and status == "complete":
            wanted = wanted + ENDED_GLOBALS
        for name in wanted:
            if str(getattr(data, name, "")).strip() == "":
                self.fault(f"global attribute {name} is missing")
        if "CF-1.10" not in getattr(data, "Conventions", ""):
            self.fault("Conventions does not name CF-1.10")
        if status not in STATUS:
            self.fault(f"status is {status!r}")
        if self.status is not None and status != self.status:
            self.fault(f"status is {status!r}, not {self.status!r}")
        if set(data.groups) - INFERENCE:
            self.fault("groups, which xarray does not show")

    def check_variable(self, data, var):
        name, attributes = var.name, var.ncattrs()
        if not re.match(r"^[A-Za-z][A-Za-z0-9_]*$", name):
            self.fault(f"{name}: not a CF name")
        text = var.dtype == "S1"
        for wanted in ("long_name",) if text else ("long_name", "units"):
            if not str(getattr(var, wanted, "")).strip():
                self.fault(f"{name}: has no {wanted}")
        unit = getattr(var, "units", "")
        if unit and not self.units.parse(unit):
            self.fault(f"{name}: UDUNITS does not read {unit!r}")
        self.check_standard_name(var, unit)
        for coordinate in getattr(var, "coordinates", "").split():
            self.check_coordinate(data, var, coordinate)
        for measure in re.findall(r"\w+: (\w+)", getattr(var, "cell_measures", "")):
            self.check_coordinate(data, var, measure)
        if hasattr(var, "cell_methods") and not CELL_METHOD.match(var.cell_methods):
            self.fault(f"{name}: cell_methods {var.cell_methods!r}")
        if "flag_values" in attributes or "flag_meanings" in attributes:
            self.check_flags(var)
        if var.dimensions == (name,) and "_FillValue" in attributes:
            self.fault(f"{name}: a coordinate has no missing values")
        if "_FillValue" in attributes and getattr(var, "_FillValue").dtype != var.dtype:
            self.fault(f"{name}: _FillValue is of another type")

    def check_flags(self, var):
        values = numpy.atleast_1d(getattr(var, "flag_values", []))
        meanings = str(getattr(var, "flag_meanings", "")).split()
        if len(values) != len(meanings) or len(set(values.tolist())) != len(values):
            self.fault(f"{var.name}: flag_values and flag_meanings do not pair")
        elif values.dtype != var.dtype:
            self.fault(f"{var.name}: flag_values are of another type")
        elif not numpy.all(numpy.isin(var[:], values)):
            self.fault(f"{var.name}: holds a value that is no flag")

    def check_standard_name(self, var, unit):
        standard = getattr(var, "standard_name", None)
        if standard is None:
            return
        if standard not in STANDARD_NAMES:
            self.fault(f"{var.name}: {standard!r} is not a standard name in use")
        elif standard == "time":
            if " since " not in unit or not hasattr(var, "calendar"):
                self.fault(f"{var.name}: standard_name time without a date and a calendar")
        elif not self.units.convertible(unit, STANDARD_NAMES[standard]):
            self.fault(f"{var.name}: {unit!r} is no unit of {standard}")

    def check_coordinate(self, data, var, coordinate):
        other = data.variables.get(coordinate)
        if other is None:
            self.fault(f"{var.name}: names {coordinate}, which is not there")
        elif not set(other.dimensions[:-1] if other.dtype == "S1" else other.dimensions) <= set(var.dimensions):
            self.fault(f"{var.name}: {coordinate} has dimensions that it lacks")

    def check_time(self, data):
        if "time" not in data.dimensions:
            return
        time = data["time"][:]
        if not numpy.all(numpy.isfinite(time)) or numpy.any(numpy.diff(time) < 0):
            self.fault("time decreases or is not finite")
        origin, local = data["time_origin"][:], data["time_local"][:]
        exact = [Fraction(o) + Fraction(l) for o, l in zip(origin.tolist(), local.tolist())]
        if any(b <= a for a, b in zip(exact, exact[1:])):
            self.fault("time_origin + time_local does not increase strictly")
        if any(abs(float(e) - t) > 1e-15 * max(1.0, abs(t)) for e, t in zip(exact, time.tolist())):
            self.fault("time is not time_origin + time_local")

    def check_missing(self, data):
        for var in data.variables.values():
            indicator = var.dimensions == ("issue",) and "_FillValue" in var.ncattrs()
            if var.name in MAY_BE_MISSING or indicator or var.dtype.kind not in "fi" or var.size == 0:
                continue
            fill = netCDF4.default_fillvals[var.dtype.str[1:]]
            values = var[:]
            if numpy.any(values == fill) or not numpy.all(numpy.isfinite(values)):
                self.fault(f"{var.name}: has missing or non-finite values")

    def check_xarray(self):
        with xarray.open_dataset(self.path) as data:
            for name, var in data.variables.items():
                if var.dtype.kind == "m":
                    self.fault(f"{name}: xarray makes a timedelta of it")
            repr(data)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--status", help="the status that every file must have")
    parser.add_argument("files", nargs="+", metavar="FILE")
    arguments = parser.parse_args()
    units = Udunits()
    faults = []
    for path in arguments.files:
        try:
            faults += Checker(path, units, arguments.status).check()
        except (OSError, KeyError, IndexError, ValueError) as error:
            faults.append(f"{path}: {error}")
    for text in faults:
        print(text, file=sys.stderr)
    print(f"{len(arguments.files)} files, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
