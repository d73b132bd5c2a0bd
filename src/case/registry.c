// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of models that a case can choose or that a command has, a row each; and what `describe`
// says of the choices that are no models of their own, whose keys are rows of the sections solver,
// rg and material.
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
MODELS(pressing_at, lac_normal_stress_get)
MODELS(friction_at, lac_friction_law_get)
MODELS(weakening_at, lac_weakening_get)
MODELS(transfer_at, lac_transfer_kind_get)
MODELS(spread_at, lac_heterogeneity_kind_get)
MODELS(analysis_at, lac_indicator_kind_get)
MODELS(precursor_at, lac_precursor_kind_get)

#define CVODES                                                                              \
    "Hindmarsh et al. (2005) ACM Trans. Math. Softw. 31, 363, doi 10.1145/1089014.1089020 " \
    "(CVODES)"
#define PAPER "Borri-Brunetto, Carpinteri & Chiaia (2004) Rock Mech. Rock Eng. 37, 117"

static const lac_model_info momenta[] = {
    LAC_ABOUT("radiation-damping",
              "waves that leave a sliding cell take eta v off its traction, eta = G/(2 cs); with "
              "shear_modulus and a shear speed, given or from the density",
              "Rice (1993) J. Geophys. Res. 98, 9885, doi 10.1029/93JB00191",
              .params = &lac_material_rows[LAC_MATERIAL_SHEAR_SPEED], .param_count = 2),
    LAC_ABOUT("block-inertia",
              "the mass of the block that slides, which what is out of balance accelerates; with "
              "the section inertia",
              "Rice & Ruina (1983) J. Appl. Mech. 50, 343, doi 10.1115/1.3167042; "
              "docs/theory/momentum.md, eq. 1",
              .params = lac_inertia_rows, .param_count = LAC_INERTIA_ROWS),
};

static const lac_model_info fidelities[] = {
    LAC_ABOUT("ode",
              "all cells at every step: cells that hold each other, and what events are judged by",
              "docs/theory/creep.md, eq. 2-5"),
    LAC_ABOUT("events",
              "each cell at steps of its own: cells that slip one by one (k_0 < k_crit) on the "
              "hierarchy, under loads that are linear between jumps",
              "docs/theory/fidelity-events.md; Richards-Dinger & Dieterich (2012) Seismol. "
              "Res. Lett. 83, 983, doi 10.1785/0220120105 (RSQSim)"),
    LAC_ABOUT("static", "no time: the cascade of slip over the blocks, by lacuna rg",
              PAPER "; docs/theory/rg.md"),
    LAC_ABOUT("auto",
              "events where cells slip one by one, it takes the case and nothing is asked of all "
              "cells at every step, else ode; run and check say which and why",
              "docs/choosing.md"),
    LAC_ABOUT("lumped",
              "few cells that stand for all, each counted many times: where all slip together, on "
              "the hierarchy; the run says by how much it may be off",
              "docs/theory/lumped.md"),
};

static const lac_model_info methods[] = {
    LAC_ABOUT("bdf",
              "implicit backward differences of order 1 to 5: stiff problems, the long creep",
              CVODES "; docs/theory/creep.md, eq. 5"),
    LAC_ABOUT(
        "adams",
        "Adams-Moulton of order 1 to 12 by fixed-point iteration: problems that are not stiff",
        CVODES),
    LAC_ABOUT("erk",
              "explicit Runge-Kutta of order 2 to 8, Cash-Karp 5(4) by default, Prince-Dormand "
              "8(7) of order 8: earthquake cycles without stiff ties",
              "Reynolds et al. (2023) ACM Trans. Math. Softw. 49, 19, doi 10.1145/3594632 "
              "(ARKODE); Cash & Karp (1990) ACM Trans. Math. Softw. 16, 201; Prince & "
              "Dormand (1981) J. Comput. Appl. Math. 7, 67"),
};

static const lac_model_info formulations[] = {
    LAC_ABOUT("rate",
              "ln v: the balance of traction differentiated in time; slip that does not reverse",
              "docs/theory/creep.md, eq. 2-3"),
    LAC_ABOUT("traction", "tau: the rate follows from the strength cell by cell; slip may reverse",
              "docs/theory/creep.md, eq. 6"),
    LAC_ABOUT("slip", "slip: the balance of traction holds to rounding; slip may reverse",
              "docs/theory/creep.md, eq. 7"),
    LAC_ABOUT("inertia",
              "slip and its rate: momentum in the place of the balance; with the section inertia",
              "docs/theory/momentum.md, eq. 1-2"),
    LAC_ABOUT("vector",
              "slip along x and y, which may turn: friction opposes the slip rate; with "
              "interface.slip: vector",
              "docs/theory/vector.md, eq. 1-2"),
};

static const lac_model_info rules[] = {
    LAC_ABOUT("fix", "the drop of its strength, (1 - beta) f p, as the paper has it",
              PAPER "; docs/theory/rg.md, eq. 1"),
    LAC_ABOUT("cons", "all above its residual strength beta f p: no force is made or lost",
              "docs/theory/rg.md, eq. 2"),
    LAC_ABOUT("lump", "the drop of its strength, as a point with the sums of its cells",
              "Smalley, Turcotte & Solla (1985) J. Geophys. Res. 90, 1894, doi "
              "10.1029/JB090iB02p01894; docs/theory/rg.md, \"Pass\""),
};

// Behind those of the registry the one that a case is.
static const lac_model_info *forecast_at(size_t index)
{
    const lac_forecast_kind *kind = lac_forecast_kind_get(index);
    const bool next = kind == NULL && index > 0 && lac_forecast_kind_get(index - 1) != NULL;
    return (const void *)(next ? &lac_forecast_case : kind);
}

// clang-format off
static LAC_ROWS_AT(lac_model_info, momentum_at, momenta)
static LAC_ROWS_AT(lac_model_info, fidelity_at, fidelities)
static LAC_ROWS_AT(lac_model_info, method_at, methods)
static LAC_ROWS_AT(lac_model_info, formulation_at, formulations)
static LAC_ROWS_AT(lac_model_info, rule_at, rules)
// clang-format on

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
        KIND(PRESSING, "normal_stress", "load.normal_stress", pressing_at,
             "normal stresses that come on top of load.normal, a list that adds up"),
        KIND(FRICTION, "friction", "friction", friction_at, "rate-and-state friction laws"),
        KIND(WEAKENING, "weakening", "weakening", weakening_at,
             "what weakens the cells besides friction, a list of mechanisms"),
        KIND(TRANSFER, "transfer", "transfer", transfer_at,
             "how the slip of a cell loads the others"),
        KIND(SPREAD, "spread", "friction.spread", spread_at,
             "how a parameter varies from cell to cell (also initial.spread and interface.spread)"),
        KIND(ANALYSIS, "analysis", "analysis", analysis_at,
             "what a run follows beside its own quantities"),
        OPTION(STRENGTH, "strength", "friction.LAW", lac_friction_option_get,
               "what any friction law can have besides"),
        OPTION(MOMENTUM, "momentum", "material", momentum_at,
               "what a cell that is out of balance is held back by"),
        OPTION(FIDELITY, "fidelity", "solver.fidelity", fidelity_at, "what is resolved in time"),
        OPTION(METHOD, "method", "solver.method", method_at, "of integration in time"),
        OPTION(FORMULATION, "formulation", "solver.formulation", formulation_at,
               "the unknown of a cell besides ln theta"),
        OPTION(RULE, "rule", "rg.rule", rule_at, "what a block that slips hands on in the cascade"),
        COMMAND(PRECURSOR, "indicator", "precursors", precursor_at,
                "what a motion, events and slipping cells say of a failure to come"),
        COMMAND(FORECAST, "forecast", "precursors", forecast_at,
                "methods of forecasting the time of failure"),
};

LAC_ROWS_AT(lac_kind, lac_kind_get, kinds)
