// SPDX-License-Identifier: GPL-3.0-or-later
// In which regime a scene moves, in words for who set it up: whether its cells go as one, and with
// that what roughness, size, load and water can and cannot do in it, and which fidelity it is run
// with where the case leaves that open (docs/choosing.md).
#include "scene/estimate.h"
#include "scene/internal.h"

const char *lac_regime_name(lac_regime regime)
{
    static const char *const names[] = {NULL,       "one block", "creep",
                                        "together", "patches",   "one by one"};
    return names[regime];
}

lac_regime lac_regime_of(const lac_estimate *e)
{
    return !e->integrated            ? LAC_REGIME_NONE
           : e->cells <= 1           ? LAC_REGIME_BLOCK
           : !(e->critical > 0)      ? LAC_REGIME_CREEP
           : e->stiffness_ratio <= 1 ? LAC_REGIME_SINGLE
           : e->patch < e->length    ? LAC_REGIME_PATCHES
                                     : LAC_REGIME_TOGETHER;
}

bool lac_scene_load_given(const lac_case *c)
{
    return isnan(c->initial.slip_rate) || c->initial.state == LAC_STATE_FROM_LOAD;
}

#define ADD(text, ...) lac_append((text), LAC_REGIME_ROOM, __VA_ARGS__)

// What roughness and size do where all cells move alike.
static void say_together(const lac_case *c, const lac_estimate *e, char *words)
{
    if (isfinite(e->patch)) {
        ADD(words,
            "A patch slips by itself from a width of some %.2g m on, and the joint is %.4g m: ",
            e->patch, e->length);
    }
    ADD(words, "all cells creep as one. Roughness and size act %s",
        c->friction_spread.count > 0
            ? "only through friction.spread, by what it makes of the patches."
            : "on nothing that decides when it fails. Name friction.spread, such as a dc by the "
              "size of the patch, and they do.");
    if (isfinite(e->patch)) {
        ADD(words, " With a dc below %.2g of this one, patches would slip by themselves.",
            e->length / e->patch);
    }
}

static void say_weakening(const lac_case *c, const lac_estimate *e, char *words)
{
    const lac_friction_params *law = c->friction.params;
    for (size_t i = 0; c->friction.info != NULL && i < c->weakening.count; i++) {
        const lac_weakening_kind *kind = (const void *)c->weakening.item[i].info;
        const lac_weakening_joint joint = {.normal = e->pressure,
                                           .f0 = law->f0,
                                           .excess = law->b - law->a,
                                           .cohesion = law->cohesion > 0 ? law->cohesion : 0};
        char text[400];
        kind->words(c->weakening.item[i].params, &joint, text, sizeof text);
        ADD(words, " %s", text);
    }
}

// The slip at which the dip comes down to that which friction at v0 holds dry; INFINITY: never.
static double slip_where_held(const lac_geometry *g, double from, double to, double f0)
{
    const int parts = 4000; // and no more than that of the way is told wrong
    for (int k = 0; k <= parts; k++) {
        const double slip = from + (to - from) * k / parts;
        if (tan(lac_geometry_at(g, slip).angle) <= f0) {
            return slip;
        }
    }
    return INFINITY;
}

static void say_geometry(const lac_case *c, char *words)
{
    const lac_geometry_def *def = &c->geometry;
    const lac_friction_params *law = c->friction.params;
    const double degrees = 180.0 / M_PI;
    lac_geometry *g;
    if (def->angles == 0 || law == NULL || lac_geometry_create(def, &g, NULL) != LAC_OK) {
        return;
    }
    const double start = lac_geometry_at(g, 0.0).angle;
    const double bent = isnan(def->radius) ? 0.0 : def->radius * (start + 1.5);
    const double far = fmax(def->angles > 1 ? def->slip[def->nodes - 1] : bent, 0.0);
    const double held = slip_where_held(g, 0.0, far, law->f0);
    ADD(words, " The base dips by %.4g degree", start * degrees);
    if (far > 0.0) {
        const double shown = isnan(def->radius) ? far : def->radius / 10.0;
        ADD(words, " at the start and %.4g after %.4g m of slip",
            lac_geometry_at(g, shown).angle * degrees, shown);
    }
    if (held > 0.0 && isfinite(held)) {
        ADD(words,
            ": dry, friction at v0 (%.3g degree) holds its weight from %.3g m on. There it slows, "
            "unless weakening or water carry it over.",
            atan(law->f0) * degrees, held);
    } else {
        ADD(words,
            held > 0.0 ? ": more than friction at v0 holds (%.3g degree), so that the base "
                         "arrests nothing."
                       : ": dry, friction at v0 (%.3g degree) holds its weight from the start.",
            atan(law->f0) * degrees);
    }
    lac_geometry_free(g);
}

void lac_regime_words(const lac_case *c, const lac_estimate *e, char text[static LAC_REGIME_ROOM])
{
    const lac_regime regime = lac_regime_of(e);
    text[0] = '\0';
    if (regime == LAC_REGIME_BLOCK) {
        ADD(text, "One cell has no roughness: load, water, friction and its state set the time.");
    } else if (regime == LAC_REGIME_CREEP) {
        ADD(text, "b <= a: what slips faster is held more. The joint follows its load and does not "
                  "run away by itself.");
    } else if (regime == LAC_REGIME_TOGETHER) {
        say_together(c, e, text);
    } else if (regime == LAC_REGIME_PATCHES) {
        ADD(text,
            "Patches wider than some %.2g m slip by themselves before the joint of %.4g m fails: "
            "roughness, size and dc set when.",
            e->patch, e->length);
    } else if (regime == LAC_REGIME_SINGLE) {
        ADD(text, "Neighbours hold a cell less than it weakens: cells slip one by one before the "
                  "joint fails. Roughness, size, dc and the size of cells set when.");
    }
    if (regime != LAC_REGIME_NONE && !lac_scene_load_given(c)) {
        ADD(text,
            " The load at the start follows from initial.slip_rate and the state: what is "
            "there from the start (angle, weight, water) does not change when it fails. With a "
            "load.shear of kind slope or ratio in the place of initial.slip_rate it does.");
    }
    if (regime != LAC_REGIME_NONE) {
        say_geometry(c, text);
        say_weakening(c, e, text);
    }
}

// --- Which fidelity.

// Fidelity events is the faster one where cells slip by themselves and each for itself, below
// k_crit; near it and somewhat above it is either. A few cells cost nothing either way. Where b <=
// a no cell slips by itself. Where next to nothing holds cells or blocks once they slip they slide
// so far that ode is the faster one again. At a coarser rtol than this events is off by more than
// it promises (docs/choosing.md).
enum { FEWEST_EVENTS_CELLS = 16 };
static const double lump_ratio = 3; // docs/theory/lumped.md
static const double soft_ratio = 0.8, stiff_ratio = 5, least_ratio = 0.002, least_level_ratio = 0.3,
                    coarsest_rtol = 1.001e-6;

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
    return !lac_load_models_traits(&loads).constant;
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
        (void)snprintf(why, LAC_FIDELITY_ROOM, "%s goes with ode, not with events", key);
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

static void say_why(char why[LAC_FIDELITY_ROOM], const char *what, const lac_estimate *e)
{
    char ratio[40] = "";
    if (!isnan(e->stiffness_ratio)) {
        (void)snprintf(ratio, sizeof ratio, "k_0/k_crit %.2g, ", e->stiffness_ratio);
    }
    (void)snprintf(why, LAC_FIDELITY_ROOM, "%s (%s%.0f cell%s)", what, ratio, e->cells,
                   e->cells > 1 ? "s" : "");
}

// Why ode is as fast as events, or faster; false: events is.
static bool gains_nothing(const lac_case *c, const lac_estimate *e, char why[LAC_FIDELITY_ROOM])
{
    lac_transfer_outline outline = {0};
    (void)lac_transfer_outline_of(&c->transfer, &outline);
    const struct {
        bool so;
        const char *why;
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
            say_why(why, table[i].why, e);
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
        say_why(out.why, "cells slip one by one", e);
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
                                     (double)contact->grid.ny * contact->grid.dy)};
    lac_status status = LAC_OK;
    e.cells = e.contact_cells;
    lac_estimate_stability(c, &e);
    *out = lac_fidelity_choose(c, &e);
    LAC_FAIL_IF(c->team != NULL && out->fidelity == LAC_FIDELITY_ASYNC, err, LAC_EINPUT,
                "solver.fidelity auto would take events here, which ranks do not share: run this "
                "case on one, with lacuna, or name ode");
    LAC_FAIL_IF(
        out->fidelity == LAC_FIDELITY_LUMPED && e.stiffness_ratio < lump_ratio, err, LAC_EINPUT,
        "solver.fidelity lumped is for cells that slip together: k_0/k_crit is %.2g, and how "
        "far off it may be is known from %g on; take ode, or auto",
        e.stiffness_ratio, lump_ratio);
    if (c->run.fidelity == LAC_FIDELITY_AUTO) {
        c->run.fidelity = out->fidelity;
        status = out->fidelity == LAC_FIDELITY_ASYNC ? take_events(scene, c, out, err) : LAC_OK;
    }
    const bool told = !isnan(c->accuracy) || out->fidelity == LAC_FIDELITY_LUMPED; // by what is run
    out->error = told ? (double)NAN : lac_fidelity_error(c, &e, out->fidelity);
    return status;
}
