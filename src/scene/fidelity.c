// SPDX-License-Identifier: GPL-3.0-or-later
// Which fidelity a case is run with that leaves it open, by its regime: docs/choosing.md.
#include "scene/estimate.h"

#include "scene/internal.h"

// Fidelity events is the faster one where cells slip by themselves and each for itself, below
// k_crit; somewhat above it is either. A few cells cost nothing either way. Where b <= a no cell
// slips by itself. Where next to nothing holds cells or blocks once they slip they slide so far
// that ode is the faster one again. At a coarser rtol than this events is off by more than it
// promises (docs/choosing.md).
enum { FEWEST_EVENTS_CELLS = 16 };
static const double soft_ratio = 1, stiff_ratio = 5, least_ratio = 0.002, least_level_ratio = 0.3,
                    coarsest_rtol = 1.001e-5;

bool lac_case_spreads(const lac_case *c, const char *const keys[])
{
    while (*keys != NULL && !lac_heterogeneity_has(&c->friction_spread, *keys)) {
        keys++;
    }
    return *keys != NULL;
}

static bool changes(const lac_case *c)
{
    const lac_load_models loads = lac_case_loads(c);
    return !lac_load_models_constant(&loads);
}

static bool strengthens(const lac_case *c)
{
    static const char *const weakening[] = {"a", "b", NULL};
    const lac_friction_params *law = c->friction.params;
    return law->b <= law->a && !lac_case_spreads(c, weakening);
}

// What events refuses of transfer, law and loads.
static lac_status follow(const lac_case *c, lac_error *err)
{
    static const char *const cut_offs[] = {"v1", "v2", "alpha", NULL};
    const lac_friction_params *law = c->friction.params;
    lac_async_scene scene = {.transfer = (const void *)c->transfer.info,
                             .law = c->friction.info,
                             .cut_off = !isnan(law->v1) || !isnan(law->v2) || !isnan(law->alpha) ||
                                        lac_case_spreads(c, cut_offs),
                             .linear = true,
                             .formulation = LAC_FORMULATION_RATE};
    const lac_model_list *loads[] = {&c->shear, &c->pore, &c->pressing};
    for (size_t k = 0; k < 3; k++) {
        for (size_t i = 0; i < loads[k]->count; i++) {
            scene.linear &= lac_load_model_is_linear(&loads[k]->item[i]);
        }
    }
    LAC_FAIL_IF(scene.transfer == NULL, err, LAC_EINPUT, "no transfer ties cells to each other");
    return lac_run_async_follows(&scene, err);
}

// The first key that asks for what only all cells at every step give, or for steps of all cells;
// NULL: none.
static const char *asks_for_all(const lac_case *c)
{
    const lac_run_def usual = lac_run_default(), *run = &c->run;
    const struct {
        bool asked;
        const char *key;
    } table[] = {
        {c->slip == LAC_SLIP_VECTOR, "interface.slip: vector"},
        {c->geometry.angles > 0, "interface.geometry"},
        {c->fields != 0, "output.fields"},
        {c->points > 0, "output.points"},
        {c->analysis.count > 0, "analysis"},
        {!isnan(c->accuracy), "solver.accuracy"},
        {run->projection != 0, "solver.projection"},
        {run->max_steps != usual.max_steps, "solver.max_steps"},
        {run->record.steps > 1, "output.every in steps"},
        {run->checkpoint.steps > 0, "output.checkpoint in steps"},
    };
    const size_t rows = sizeof table / sizeof *table;
    size_t i = 0;
    while (i < rows && !table[i].asked) {
        i++;
    }
    return i < rows ? table[i].key : NULL;
}

static bool needs_all(const char *key, char why[LAC_FIDELITY_ROOM])
{
    if (key != NULL) {
        (void)snprintf(why, LAC_FIDELITY_ROOM, "%s needs all cells at every step", key);
    }
    return key != NULL;
}

bool lac_fidelity_refused(const lac_case *c, char why[static LAC_FIDELITY_ROOM])
{
    lac_error refusal;
    if (needs_all(lac_case_bars_events(c), why)) {
        return true;
    }
    const bool refused = follow(c, &refusal) != LAC_OK;
    (void)snprintf(why, LAC_FIDELITY_ROOM, "%.200s", refused ? refusal.message : "");
    return refused;
}

// Of the springs on the mean slip [Pa/m].
static double spring_stiffness(const lac_case *c)
{
    double sum = 0;
    for (size_t i = 0; i < c->shear.count; i++) {
        const lac_load_kind *kind = (const void *)c->shear.item[i].info;
        sum += kind->stiffness != NULL ? kind->stiffness(c->shear.item[i].params) : 0;
    }
    return sum;
}

static void say(char why[LAC_FIDELITY_ROOM], const char *words, const lac_estimate *e)
{
    char ratio[40] = "";
    if (!isnan(e->stiffness_ratio)) {
        (void)snprintf(ratio, sizeof ratio, "k_0/k_crit %.2g, ", e->stiffness_ratio);
    }
    (void)snprintf(why, LAC_FIDELITY_ROOM, "%s (%s%.0f cell%s)", words, ratio, e->cells,
                   e->cells > 1 ? "s" : "");
}

// Why ode is as fast as events, or faster; false: events is.
static bool gains_nothing(const lac_case *c, const lac_estimate *e, char why[LAC_FIDELITY_ROOM])
{
    lac_transfer_outline outline;
    (void)lac_transfer_outline_of(&c->transfer, &outline);
    const struct {
        bool so;
        const char *words;
    } table[] = {
        {strengthens(c), "b <= a, so that no cell slips by itself"},
        {e->cells < FEWEST_EVENTS_CELLS, "few cells cost little either way"},
        {isnan(e->stiffness_ratio), "k_0/k_crit is not known"},
        {!(e->stiffness_ratio < soft_ratio), "the cells hold one another"},
        {!(e->stiffness_ratio > least_ratio), "nothing holds a cell that slips"},
        {outline.rock == NULL && outline.ratio < least_level_ratio,
         "little holds a block that slips"},
        {!(spring_stiffness(c) < e->critical), "a stiff spring ties all cells"},
        {c->run.rtol > coarsest_rtol, "rtol is too coarse for events"},
    };
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        if (table[i].so) {
            say(why, table[i].words, e);
            return true;
        }
    }
    return false;
}

lac_fidelity_choice lac_fidelity_choose(const lac_case *c, const lac_estimate *e)
{
    lac_fidelity_choice out = {.fidelity = c->run.fidelity};
    if (c->run.fidelity != LAC_FIDELITY_AUTO) {
        return out;
    }
    out.fidelity = LAC_FIDELITY_ODE;
    if (!needs_all(asks_for_all(c), out.why) && !lac_fidelity_refused(c, out.why) &&
        !gains_nothing(c, e, out.why)) {
        out.fidelity = LAC_FIDELITY_ASYNC;
        say(out.why, "cells slip one by one", e);
    }
    return out;
}

const char *lac_fidelity_faster(const lac_case *c, const lac_estimate *e)
{
    char why[LAC_FIDELITY_ROOM];
    if (c->run.fidelity == LAC_FIDELITY_ASYNC) {
        return e->stiffness_ratio > stiff_ratio || strengthens(c)
                   ? lac_fidelity_name(LAC_FIDELITY_ODE)
                   : NULL;
    }
    return c->run.fidelity == LAC_FIDELITY_ODE && !lac_fidelity_refused(c, why) &&
                   !gains_nothing(c, e, why)
               ? lac_fidelity_name(LAC_FIDELITY_ASYNC)
               : NULL;
}

double lac_fidelity_error(const lac_case *c, const lac_estimate *e, lac_fidelity fidelity)
{
    const double together = 400.0, by_themselves = 2000.0;
    const bool alone =
        lac_regime_of(e) == LAC_REGIME_SINGLE || lac_regime_of(e) == LAC_REGIME_PATCHES;
    return fidelity == LAC_FIDELITY_ASYNC || (alone && changes(c))
               ? 1.25 * pow(c->run.rtol, 0.3)
               : (alone ? by_themselves : together) * c->run.rtol;
}

// Takes events where the scene itself is not refused, of some cell's friction.
static lac_status take_events(lac_scene *scene, lac_case *c, lac_fidelity_choice *out,
                              lac_error *err)
{
    const int formulation = c->formulation;
    const bool other = formulation != LAC_FORMULATION_RATE;
    lac_error refusal;
    c->run.fidelity = LAC_FIDELITY_ASYNC;
    c->formulation = LAC_FORMULATION_RATE;
    LAC_TRY_RETURN(other ? lac_scene_renew(scene, NULL, false, err) : LAC_OK);
    if (lac_run_check(scene->problem, &c->run, &refusal) == LAC_OK) {
        return LAC_OK;
    }
    out->fidelity = c->run.fidelity = LAC_FIDELITY_ODE;
    c->formulation = formulation;
    (void)snprintf(out->why, sizeof out->why, "%.200s", refusal.message);
    return other ? lac_scene_renew(scene, NULL, false, err) : LAC_OK;
}

lac_status lac_fidelity_settle(lac_scene *scene, lac_case *c, lac_fidelity_choice *out,
                               lac_error *err)
{
    const lac_scene_contact *contact = &scene->contact;
    lac_estimate e = {.grid = contact->grid,
                      .pressure = contact->mean_pressure,
                      .grid_cells = (double)lac_grid_cells(&contact->grid),
                      .contact_cells = (double)contact->domain->n,
                      .length = fmax((double)contact->grid.nx * contact->grid.dx,
                                     (double)contact->grid.ny * contact->grid.dy),
                      .critical = NAN,
                      .patch = NAN,
                      .stiffness_ratio = NAN};
    lac_status status = LAC_OK;
    e.cells = e.contact_cells;
    lac_estimate_stability(c, &e);
    *out = lac_fidelity_choose(c, &e);
    if (c->run.fidelity == LAC_FIDELITY_AUTO) {
        c->run.fidelity = out->fidelity;
        status = out->fidelity == LAC_FIDELITY_ASYNC ? take_events(scene, c, out, err) : LAC_OK;
    }
    out->error = lac_fidelity_error(c, &e, out->fidelity);
    return status;
}
