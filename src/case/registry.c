// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>

#include "case/schema.h"
#include "lacuna/analysis.h"
#include "lacuna/surface.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

// clang-format off
#define SEED_ROW                                                                                  \
    {.key = "seed", .unit = "1", .fallback = 1, .min = 0, .max = 0x1p53,                          \
     .offset = offsetof(lac_spread_params, seed), .type = LAC_INTEGER,                            \
     .doc = "of the random numbers"}
// clang-format on

static const lac_param lognormal_params[] = {
    {.key = "sigma",
     .unit = "1",
     .fallback = NAN,
     .min = 0,
     .max = 20,
     .offset = offsetof(lac_spread_params, width),
     .doc = "standard deviation of the logarithm"},
    SEED_ROW,
};

static const lac_param normal_params[] = {
    {.key = "sigma",
     .unit = "1",
     .fallback = NAN,
     .min = 0,
     .max = 1,
     .offset = offsetof(lac_spread_params, width),
     .doc = "standard deviation relative to the nominal value"},
    SEED_ROW,
};

static const lac_param uniform_params[] = {
    {.key = "half_width",
     .unit = "1",
     .fallback = NAN,
     .min = 0,
     .max = 1,
     .offset = offsetof(lac_spread_params, width),
     .doc = "largest deviation relative to the nominal value"},
    SEED_ROW,
};

// In the order of lac_spread_kind.
static const lac_descriptor spreads[] = {
    {.name = "lognormal",
     .summary = "the nominal value times exp(sigma z), z standard normal",
     .reference = "",
     .params = lognormal_params,
     .param_count = COUNT(lognormal_params),
     .params_size = sizeof(lac_spread_params)},
    {.name = "normal",
     .summary = "the nominal value times 1 + sigma z, z standard normal",
     .reference = "",
     .params = normal_params,
     .param_count = COUNT(normal_params),
     .params_size = sizeof(lac_spread_params)},
    {.name = "uniform",
     .summary = "the nominal value times 1 + half_width z, z uniform between -1 and 1",
     .reference = "",
     .params = uniform_params,
     .param_count = COUNT(uniform_params),
     .params_size = sizeof(lac_spread_params)},
};

static const lac_descriptor *spread_at(size_t index)
{
    return index < COUNT(spreads) ? &spreads[index] : NULL;
}

int lac_spread_kind_of(const lac_descriptor *about) { return (int)(about - spreads); }

// The descriptor is the first member of every registry's row.
static const lac_descriptor *surface_at(size_t index)
{
    return (const void *)lac_surface_source_at(index);
}

static const lac_descriptor *domain_at(size_t index)
{
    return (const void *)lac_domain_source_at(index);
}

static const lac_descriptor *normal_at(size_t index)
{
    return (const void *)lac_normal_load_at(index);
}

static const lac_descriptor *shear_at(size_t index)
{
    return (const void *)lac_shear_load_at(index);
}

static const lac_descriptor *pore_at(size_t index) { return (const void *)lac_pore_load_at(index); }

static const lac_descriptor *friction_at(size_t index)
{
    return (const void *)lac_friction_law_at(index);
}

static const lac_descriptor *transfer_at(size_t index)
{
    return (const void *)lac_transfer_kind_at(index);
}

static const lac_descriptor *indicator_at(size_t index)
{
    return (const void *)lac_indicator_kind_at(index);
}

static const lac_kind kinds[] = {
    [LAC_KIND_SURFACE] = {.name = "surface",
                          .section = "interface.surface",
                          .summary = "heights of the rough interface, which are pressed together",
                          .at = surface_at},
    [LAC_KIND_DOMAIN] = {.name = "domain",
                         .section = "interface.domain",
                         .summary = "contact cells given outright, instead of a surface",
                         .at = domain_at},
    [LAC_KIND_NORMAL] = {.name = "normal",
                         .section = "load.normal",
                         .summary = "total normal stress on the interface",
                         .at = normal_at},
    [LAC_KIND_SHEAR] = {.name = "shear",
                        .section = "load.shear",
                        .summary = "shear loads, a list that adds up",
                        .at = shear_at},
    [LAC_KIND_PORE] = {.name = "pore_pressure",
                       .section = "load.pore_pressure",
                       .summary = "pore pressures, a list that adds up",
                       .at = pore_at},
    [LAC_KIND_FRICTION] = {.name = "friction",
                           .section = "friction",
                           .summary = "rate-and-state friction laws",
                           .at = friction_at},
    [LAC_KIND_TRANSFER] = {.name = "transfer",
                           .section = "transfer",
                           .summary = "how the slip of a cell loads the others",
                           .at = transfer_at},
    [LAC_KIND_SPREAD] = {.name = "spread",
                         .section = "friction.spread",
                         .summary =
                             "how a parameter varies from cell to cell (also initial.spread and "
                             "interface.spread)",
                         .at = spread_at},
    [LAC_KIND_INDICATOR] = {.name = "indicator",
                            .section = "analysis",
                            .summary = "what a run follows beside its own quantities",
                            .at = indicator_at},
};

const lac_kind *lac_kind_at(size_t index) { return index < COUNT(kinds) ? &kinds[index] : NULL; }
