// SPDX-License-Identifier: GPL-3.0-or-later
// The friction laws that a case can name: a new one is one more row of this table.
#include "base/rows.h"
#include "friction/law.h"

static const lac_friction_law *const laws[] = {
    &lac_friction_aging,
    &lac_friction_slip,
    &lac_friction_weakening,
    &lac_friction_composite,
};

LAC_KINDS_AT(lac_friction_law, lac_friction_law_get, laws)
