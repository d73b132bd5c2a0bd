// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/settle_copies.h"

#define LAC_CLONES TEST_VMATH_TARGET("arch=x86-64-v3")
#define lac_friction_solve_rates test_v3_settle
#include "friction/solve_rates.c"
