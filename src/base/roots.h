/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// Bisection, a step: what is looked for lies above the middle of [low, high], or not. Unlike GSL's
/// solvers it needs no room, takes what rises or falls as its caller says, and goes on to the last
/// bit.
static inline void lac_halve(double *low, double *high, bool above)
{
    *(above ? low : high) = 0.5 * (*low + *high);
}
