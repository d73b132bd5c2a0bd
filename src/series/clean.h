/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "series/motion.h"

/// Noise, intervals and gaps of the motion's readings, into it.
/// @pre   resolution is set
/// @param work  [n]
void lac_motion_measure(lac_motion *motion, double *work);

/// Whether the readings fall by more than their noise.
/// @param work  [n]
bool lac_motion_falls(const lac_motion *motion, double *work);

/// Drops outliers and takes resets out.
/// @return whether so many resets are believed
bool lac_motion_clean(lac_motion *motion);

/// Velocities, as the definition says.
/// @param readings  what was given
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_motion_differentiate(const lac_motion_def *def, const lac_readings *readings,
                                    lac_motion *motion, lac_error *err);
