// SPDX-License-Identifier: GPL-3.0-or-later
// One table of all kinds of models, which `describe`, completion and the reader of cases walk.
#include "case/schema.h"
#include "case/sections.h"
#include "lacuna/analysis.h"
#include "lacuna/precursor.h"
#include "lacuna/surface.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

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

static const lac_descriptor *spread_at(size_t index)
{
    return (const void *)lac_spread_kind_at(index);
}

static const lac_descriptor *analysis_at(size_t index)
{
    return (const void *)lac_indicator_kind_at(index);
}

static const lac_descriptor *precursor_at(size_t index)
{
    return (const void *)lac_precursor_kind_at(index);
}

// Behind those of the registry the one that a case is.
static const lac_descriptor *forecast_at(size_t index)
{
    const lac_forecast_kind *kind = lac_forecast_kind_at(index);
    const bool next = kind == NULL && index > 0 && lac_forecast_kind_at(index - 1) != NULL;
    return (const void *)(next ? &lac_forecast_case : kind);
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
    [LAC_KIND_ANALYSIS] = {.name = "analysis",
                           .section = "analysis",
                           .summary = "what a run follows beside its own quantities",
                           .at = analysis_at},
    [LAC_KIND_STRENGTH] = {.name = "strength",
                           .section = "friction.LAW",
                           .summary = "what any friction law can have besides",
                           .option = true,
                           .at = lac_friction_option_at},
    [LAC_KIND_MOMENTUM] = {.name = "momentum",
                           .section = "material",
                           .summary = "what a cell that is out of balance is held back by",
                           .option = true,
                           .at = lac_momentum_at},
    [LAC_KIND_FIDELITY] = {.name = "fidelity",
                           .section = "solver.fidelity",
                           .summary = "what is resolved in time",
                           .option = true,
                           .at = lac_fidelity_at},
    [LAC_KIND_METHOD] = {.name = "method",
                         .section = "solver.method",
                         .summary = "of integration in time",
                         .option = true,
                         .at = lac_method_at},
    [LAC_KIND_FORMULATION] = {.name = "formulation",
                              .section = "solver.formulation",
                              .summary = "the unknown of a cell besides ln theta",
                              .option = true,
                              .at = lac_formulation_at},
    [LAC_KIND_RULE] = {.name = "rule",
                       .section = "rg.rule",
                       .summary = "what a block that slips hands on in the cascade",
                       .option = true,
                       .at = lac_rule_at},
    [LAC_KIND_PRECURSOR] = {.name = "indicator",
                            .section = "precursors",
                            .summary = "what a motion, events and slipping cells say of a failure "
                                       "to come",
                            .command = "precursors",
                            .at = precursor_at},
    [LAC_KIND_FORECAST] = {.name = "forecast",
                           .section = "precursors",
                           .summary = "methods of forecasting the time of failure",
                           .command = "precursors",
                           .at = forecast_at},
};

const lac_kind *lac_kind_at(size_t index) { return index < COUNT(kinds) ? &kinds[index] : NULL; }
