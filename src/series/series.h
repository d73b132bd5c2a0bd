/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "lacuna/series.h"

struct lac_units;

/// Reads a series, as lac_series_create does.
/// @param units  the units database, for the columns' units
lac_status lac_series_read(const lac_series_def *def, const struct lac_units *units,
                           lac_series **out, lac_error *err);

/// Makes the displacement of its components, which it has; the main direction, where it is taken,
/// by the first n readings.
void lac_series_project(lac_series *series, size_t n);

enum { LAC_SERIES_DIRECTION = 32 };

/// The direction that components were projected on, as def->line_of_sight takes it.
/// @param text  [size] LAC_SERIES_DIRECTION
const char *lac_series_direction(const lac_series *series, char *text, size_t size);

/// A modelled history to lay beside a series.
typedef struct lac_history {
    size_t n;
    const double *time; ///< [n] seconds on the series' clock, never decreasing
    const double *slip; ///< [n] [m]
    const double *rate; ///< [n] [m/s]
} lac_history;

/// How well the two agree over the readings that lie within the modelled history.
typedef struct lac_misfit {
    size_t displacement_count, velocity_count, outside; ///< readings used, and outside the history
    double displacement_rms;                            ///< after the best constant offset [m]
    double displacement_offset;                         ///< observed minus modelled, mean [m]
    double log_rate_rms; ///< rms of log10(observed/modelled) velocity [1]
} lac_misfit;

/// Modelled slip and rate at time t: slip linear, rate linear in its logarithm.
/// @return false outside the history
bool lac_history_eval(const lac_history *history, double t, double *slip, double *rate);

/// Misfit of a history to a series.
void lac_series_compare(const lac_series *series, const lac_history *history, lac_misfit *misfit);
