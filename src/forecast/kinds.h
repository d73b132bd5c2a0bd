/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"
#include "forecast/forecast.h"

extern const lac_forecast_kind lac_forecast_inv8, lac_forecast_inv, lac_forecast_slo,
    lac_forecast_saito, lac_forecast_log, lac_forecast_voight, lac_forecast_block,
    lac_forecast_lppls, lac_forecast_persistence;

/// The methods that a definition asks: the registry's, its own model last but one.
size_t lac_forecast_count(const lac_forecast_def *def);
const lac_forecast_kind *lac_forecast_kind_of(const lac_forecast_def *def, size_t index);

/// Misfit of v = B/(remaining - t) to velocities as inverse velocities: rms and misfit.
void lac_forecast_fit_judge_inverse(size_t n, const double *time, const double *velocity,
                                    double scale, lac_forecast_fit *fit);

/// What stands before any method: whether the slope moves, beyond its noise, and accelerates.
/// @param start         where the acceleration begins, or def->since, which asks for none [s]; set
///                      where there is a window
/// @param accelerating  whether it does, and nothing else keeps the methods from being asked
/// @param reason        [LAC_FORECAST_TEXT] why no method is asked; "": all are
void lac_window_gate(const lac_forecast_def *def, const lac_motion *motion, double *start,
                     bool *accelerating, char *reason);

/// The motion since `start`, thinned to LAC_WINDOW_READINGS displacements by means of consecutive
/// ones, the first and the last apart.
lac_status lac_window_create(const lac_motion *motion, double start, lac_window **out,
                             lac_error *err);
void lac_window_free(lac_window *window);

enum { LAC_WINDOW_READINGS = 200 };
