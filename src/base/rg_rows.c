// SPDX-License-Identifier: GPL-3.0-or-later
// What a case calls the rules of the cascade and the ways in which shear spreads over the cells.
#include "base/rg_rows.h"

const char *const lac_rg_rule_names[] = {"fix", "cons", "lump", NULL};
const char *const lac_rg_field_names[] = {"elastic", "equal", "uniform", NULL};
