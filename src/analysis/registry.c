// SPDX-License-Identifier: GPL-3.0-or-later
// The indicators that a run can follow: a new one is one more row of this table.
#include "analysis/analysis.h"

static const lac_indicator_kind *const kinds[] = {&lac_indicator_rg, &lac_indicator_events};

LAC_KINDS_AT(lac_indicator_kind, lac_indicator_kind_get, kinds)
