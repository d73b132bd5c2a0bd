// SPDX-License-Identifier: GPL-3.0-or-later
// The table of surfaces that a case can name: a new one needs its row here.
#include "base/rows.h"
#include "surface/surface.h"

static const lac_surface_source *const sources[] = {
    &lac_surface_self_affine,
    &lac_surface_joint,
    &lac_surface_benchmark,
    &lac_surface_from_file,
};

LAC_KINDS_AT(lac_surface_source, lac_surface_source_get, sources)
