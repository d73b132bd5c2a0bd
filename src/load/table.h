/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_LOAD_TABLE_H
#define LACUNA_LOAD_TABLE_H

#include "load/load.h"

struct lac_units;

/// A column of a monitoring file on the clock of a run; missing readings left out.
typedef struct lac_readings {
    size_t n;
    double *t;     ///< [n] since the start of the run [s], rising
    double *value; ///< [n] SI
} lac_readings;

/// What is read.
typedef struct lac_readings_def {
    const char *path, *time;
    const char *column; ///< "name" or "name:unit"
    const char *per;    ///< what one unit of the column makes, "9810 Pa/m"; NULL: 1
    const char *si;     ///< unit of the product
    double offset;      ///< laid on the run this much later [s]
} lac_readings_def;

/// Reads a column, or takes it from what the clock's `files` keep. One without a unit, and without
/// `per`, is asked about as that of a monitoring series is (lac_series_read): taken as SI, which
/// `files` keep as a doubt, or refused.
/// @param remedy  what the user may do, for the message, where they do not cover the run; NULL:
///                they need not
lac_status lac_readings_read(const lac_readings_def *def, const lac_load_clock *clock,
                             const char *remedy, lac_readings *out, lac_error *err);

/// The same without a look at what `files` keep.
lac_status lac_readings_load(const lac_readings_def *def, const lac_load_clock *clock,
                             lac_readings *out, lac_error *err);

/// Keeps a doubt about a file that was read: lac_load_files_doubt.
lac_status lac_load_files_note(lac_load_files *files, const char *path, const char *text,
                               lac_error *err);

void lac_readings_clear(lac_readings *readings);

/// Index of the last reading at or before t; SIZE_MAX before the first.
size_t lac_readings_before(const double *t, size_t n, double at);

/// First of the times after `at`; INFINITY beyond the last.
double lac_readings_next(const double *t, size_t n, double at);

#endif
