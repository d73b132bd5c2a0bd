// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of models that a case can choose or that a command has, a row each.
#include "analysis/analysis.h"
#include "base/rows.h"
#include "case/sections.h"
#include "precursor/precursor.h"
#include "surface/surface.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

// The descriptor is the first member of every registry's row.
#define MODELS(name, registry) \
    static const lac_model_info *name(size_t index) { return (const void *)registry(index); }

MODELS(surface_at, lac_surface_source_get)
MODELS(domain_at, lac_domain_source_get)
MODELS(normal_at, lac_normal_load_get)
MODELS(shear_at, lac_shear_load_get)
MODELS(pore_at, lac_pore_load_get)
MODELS(friction_at, lac_friction_law_get)
MODELS(transfer_at, lac_transfer_kind_get)
MODELS(spread_at, lac_heterogeneity_kind_get)
MODELS(analysis_at, lac_indicator_kind_get)
MODELS(precursor_at, lac_precursor_kind_get)

// Behind those of the registry the one that a case is.
static const lac_model_info *forecast_at(size_t index)
{
    const lac_forecast_kind *kind = lac_forecast_kind_get(index);
    const bool next = kind == NULL && index > 0 && lac_forecast_kind_get(index - 1) != NULL;
    return (const void *)(next ? &lac_forecast_case : kind);
}

#define ROW(called, where, models, text) \
    .name = (called), .section = (where), .summary = (text), .at = (models)
#define KIND(of, ...) [LAC_KIND_##of] = {ROW(__VA_ARGS__)}
#define OPTION(of, ...) [LAC_KIND_##of] = {ROW(__VA_ARGS__), .option = true}
#define COMMAND(of, called, where, models, text) \
    [LAC_KIND_##of] = {ROW(called, where, models, text), .command = (where)}

static const lac_kind kinds[] = {
    KIND(SURFACE, "surface", "interface.surface", surface_at,
         "heights of the rough interface, which are pressed together"),
    KIND(DOMAIN, "domain", "interface.domain", domain_at,
         "contact cells given outright, instead of a surface"),
    KIND(NORMAL, "normal", "load.normal", normal_at, "total normal stress on the interface"),
    KIND(SHEAR, "shear", "load.shear", shear_at, "shear loads, a list that adds up"),
    KIND(PORE, "pore_pressure", "load.pore_pressure", pore_at,
         "pore pressures, a list that adds up"),
    KIND(FRICTION, "friction", "friction", friction_at, "rate-and-state friction laws"),
    KIND(TRANSFER, "transfer", "transfer", transfer_at, "how the slip of a cell loads the others"),
    KIND(SPREAD, "spread", "friction.spread", spread_at,
         "how a parameter varies from cell to cell (also initial.spread and interface.spread)"),
    KIND(ANALYSIS, "analysis", "analysis", analysis_at,
         "what a run follows beside its own quantities"),
    OPTION(STRENGTH, "strength", "friction.LAW", lac_friction_option_get,
           "what any friction law can have besides"),
    OPTION(MOMENTUM, "momentum", "material", lac_momentum_get,
           "what a cell that is out of balance is held back by"),
    OPTION(FIDELITY, "fidelity", "solver.fidelity", lac_fidelity_get, "what is resolved in time"),
    OPTION(METHOD, "method", "solver.method", lac_method_get, "of integration in time"),
    OPTION(FORMULATION, "formulation", "solver.formulation", lac_formulation_get,
           "the unknown of a cell besides ln theta"),
    OPTION(RULE, "rule", "rg.rule", lac_rule_get,
           "what a block that slips hands on in the cascade"),
    COMMAND(PRECURSOR, "indicator", "precursors", precursor_at,
            "what a motion, events and slipping cells say of a failure to come"),
    COMMAND(FORECAST, "forecast", "precursors", forecast_at,
            "methods of forecasting the time of failure"),
};

LAC_ROWS_AT(lac_kind, lac_kind_get, kinds)
