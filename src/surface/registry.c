// SPDX-License-Identifier: GPL-3.0-or-later
// The table of surfaces that a case can name: a new one needs its row here.
#include "surface/registry.h"

static const lac_surface_source *const sources[] = {
    &lac_surface_self_affine,
    &lac_surface_joint,
    &lac_surface_benchmark,
    &lac_surface_from_file,
};

const lac_surface_source *lac_surface_source_at(size_t index)
{
    return index < sizeof sources / sizeof sources[0] ? sources[index] : NULL;
}
