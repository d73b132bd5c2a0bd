/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_SUPPORT_SETTLE_COPIES_H
#define TEST_SUPPORT_SETTLE_COPIES_H

#include "friction/friction.h"
#include "support/vmath_copies.h"

typedef void test_settle(const lac_friction *friction, const lac_friction_balance *eq, double *u,
                         double *v);

/// friction/solve_rates.c compiled once more for one instruction set each.
test_settle test_default_settle, test_v3_settle, test_v4_settle;

/// Those copies that this processor can run.
/// @param copies  [3] filled from the front
/// @return how many
size_t test_settle_copies(test_settle *copies[3]);

#endif
