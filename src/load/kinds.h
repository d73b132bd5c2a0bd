/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LOAD_KINDS_H
#define LACUNA_LOAD_KINDS_H

#include "base/rows.h"
#include "load/load.h"

/// Steepest slope that a load takes [rad]: almost vertical, where tan and 1/cos are still finite.
#define LAC_STEEPEST 1.57

/// What lac_share is called in a case: the choices of a force's key `share`.
extern const char *const lac_share_names[];

/// The row of that key, for an int of the load's parameters. lac_load_set_create reads it.
#define LAC_SHARE_ROW(holder, member)                                                             \
    LAC_CHOICE("share", offsetof(holder, member), LAC_SHARE_PRESSURE, lac_share_names, 0,         \
               "of each cell: in proportion to its pressure, the same stress on all (equal), or " \
               "as elastic rock puts it on them when all slip alike (elastic; needs a material)")

/// Rows of keys that several loads have, by the member of the same name.
#define LAC_START_ROW(holder)                                                  \
    LAC_REAL("start", "s", offsetof(holder, start), 0, -INFINITY, INFINITY, 0, \
             "when it begins, since the start of the run")
#define LAC_TIME_COLUMN_ROW(holder)             \
    LAC_TEXT("time", offsetof(holder, time), 0, \
             "name of the time column: dates, or seconds since the start of the run")

/// LAC_ROWS of a pore pressure that a table shares with a force, whose share comes last: all cells
/// feel it alike.
#define LAC_PORE_ROWS(rows, holder)                                      \
    .params = (rows), .param_count = sizeof(rows) / sizeof(rows)[0] - 1, \
    .params_size = sizeof(holder)

#define LAC_PI 3.14159265358979323846

extern const lac_normal_load lac_normal_pressure, lac_normal_depth, lac_normal_slope,
    lac_normal_approach, lac_normal_dimension;
extern const lac_load_kind lac_shear_ratio, lac_shear_slope, lac_shear_ramp, lac_shear_spring,
    lac_shear_step, lac_shear_sine, lac_shear_shaking, lac_shear_series, lac_shear_back_slip;
extern const lac_load_kind lac_pore_constant, lac_pore_ramp, lac_pore_step, lac_pore_sine,
    lac_pore_series, lac_pore_reservoir, lac_pore_rain;

#endif
