/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FRICTION_SETTLE_H
#define LACUNA_FRICTION_SETTLE_H

#include "friction/friction.h"

/// Rates of all cells of a balance at once, where no cell has a cut-off.
/// @param u       [n] where to begin, then ln|v| of those that settled
/// @param v       [n] v of those that settled
/// @param settled [n] 1 where u and v are the root's; 0: nothing is known
/// @return how many did not settle
size_t lac_friction_settle(const lac_friction *friction, const lac_friction_balance *eq, double *u,
                           double *v, double *settled);

/// How many of the u are no place to begin: 0, beyond the bounds, NaN.
size_t lac_friction_count_cold(size_t n, const double *u);

#endif
