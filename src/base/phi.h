/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

// (1 - e^-x)/x and its derivative, from em = e^-x - 1
static inline double lac_phi(double x, double em)
{
    return fabs(x) < 1e-4 ? 1.0 - x * (0.5 - x / 6.0) : -em / x;
}

static inline double lac_phi_slope(double x, double em, double phi)
{
    return fabs(x) < 1e-4 ? -0.5 + x / 3.0 : (1.0 + em - phi) / x;
}
