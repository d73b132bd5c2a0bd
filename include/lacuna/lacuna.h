/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LACUNA_H
#define LACUNA_LACUNA_H

/// Lacuna: creep, acceleration and failure of rough rock joints. All public headers.
///
/// Threads: one thread of a process at a time may load or change a case, create a simulation, call
/// a function that ends in _compute or write a file, as UDUNITS, FFTW's planner and netCDF are not
/// made for more. Simulations that are there may run at once, each in a thread of its own.
/// GSL's error handler is the program's; as it stands by default an error within GSL ends the
/// process, so a program that must not end calls gsl_set_error_handler_off first.
#include "lacuna/case.h"
#include "lacuna/contact.h"
#include "lacuna/dataset.h"
#include "lacuna/error.h"
#include "lacuna/fit.h"
#include "lacuna/forecast.h"
#include "lacuna/linkage.h"
#include "lacuna/param.h"
#include "lacuna/rg.h"
#include "lacuna/series.h"
#include "lacuna/simulation.h"
#include "lacuna/version.h"

#endif
