/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Standard deviation of the noise of one reading, also where the signal is strong and its steps
/// are uneven: the least of 1.4826 times the median distance of readings from the line through
/// their two neighbours and from the parabola through three, each over its own error. What stands
/// still but for few readings has none.
/// @param time  [n] strictly increasing
/// @param work  [n]
/// @return NaN of fewer than three readings; the parabola is asked of eleven and more
double lac_noise_of(size_t n, const double *time, const double *value, double *work);

/// The same of nine readings, each in its nine, and twice as much, where it is less than `all`: a
/// signal over decades has no noise where it is weak that differences where it is strong tell.
/// @param out  [n]
void lac_noise_at(size_t n, const double *time, const double *value, double all, double *out);
