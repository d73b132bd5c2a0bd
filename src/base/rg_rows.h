/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// Keys that the section rg of a case and the indicator rg have in common: what each may be is said
// once, here, where both modules see it.

#include "base/rows.h"

/// In the order of lac_rg_rule, and of lac_rg_field; NULL at their ends.
extern const char *const lac_rg_rule_names[], *const lac_rg_field_names[];

#define LAC_RG_RULE_ROW(where, absent, bits, text) \
    LAC_CHOICE("rule", where, absent, lac_rg_rule_names, bits, text)
#define LAC_RG_FIELD_ROW(where, absent, bits, text) \
    LAC_CHOICE("field", where, absent, lac_rg_field_names, bits, text)
#define LAC_RG_BETA_ROW(where, bits, text) LAC_REAL("beta", "1", where, NAN, 0, 1, bits, text)
#define LAC_RG_SHIFTS_ROW(where, absent, bits, text) \
    LAC_INTEGER("shifts", where, absent, 1, 10000, bits, text)
#define LAC_RG_LOADS_ROW(where, absent, bits, text) \
    LAC_INTEGER("loads", where, absent, 10, 10000, bits, text)
