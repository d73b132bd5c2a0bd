// SPDX-License-Identifier: GPL-3.0-or-later
// The table of stress transfers that a case can name: a new one needs its row here.
#include "base/rows.h"
#include "transfer/kinds.h"

static const lac_transfer_kind *const registry[] = {
    &lac_hierarchy_kind,
    &lac_elastic_kind,
    &lac_none_kind,
};

LAC_KINDS_AT(lac_transfer_kind, lac_transfer_kind_get, registry)
