// SPDX-License-Identifier: GPL-3.0-or-later
// The table of the friction laws that a case can name, from the list of law.h.
#include "base/rows.h"
#include "friction/law.h"

static const lac_friction_law *const laws[] = {LAC_FRICTION_LAWS(LAC_ROW_ADDRESS)};

LAC_KINDS_AT(lac_friction_law, lac_friction_law_get, laws)
