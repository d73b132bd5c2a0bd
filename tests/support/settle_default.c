// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/settle_copies.h"

#define LAC_CLONES
#define lac_friction_solve_rates test_default_settle
#include "friction/solve_rates.c"
