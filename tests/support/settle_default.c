// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/settle_copies.h"

#define LAC_CLONES
#define lac_friction_solve_rates test_default_settle
#define lac_friction_count_cold test_default_count_cold
#include "friction/solve_rates.c"
