// SPDX-License-Identifier: GPL-3.0-or-later
// What holds of a case before it is run: how its cells hold one another, which fidelity is the
// faster, what the loads come to at the start and what counts as failure.
#include <math.h>

#include "friction/friction.h"
#include "scene/estimate.h"
#include "scene/internal.h"
#include "transfer/transfer.h"

// A cell is taken not to fail alone where its neighbours hold it so many times k_crit (where a, b
// or dc are spread, the second): gaps and pressures leave some much less than G/cell.
static const double safe_ratio = 30, safe_spread_ratio = 300;

// Fidelity events was 3 to 100 times faster below twice k_crit, ode 5 times from five times k_crit
// on and 40 times where b <= a: no cell slips by itself (docs/choosing.md). Few cells cost nothing
// either way. Where next to nothing holds cells or blocks once they slip, they slide so far that
// ode is the faster one again.
enum { FEWEST_EVENTS_CELLS = 64 };
static const double soft_ratio = 1, stiff_ratio = 5, least_ratio = 0.01, least_level_ratio = 0.3;

// A scene of up to this many grid cells is built whole: quick, and the surest check.
static const double small_grid = 4096;

// Whether the friction of cells differs in any of these. @param keys  NULL at the end
static bool spreads(const lac_case *c, const char *const keys[])
{
    while (*keys != NULL && !lac_heterogeneity_has(&c->friction_spread, *keys)) {
        keys++;
    }
    return *keys != NULL;
}

// Of the finest level [Pa/m].
static double finest_stiffness(const lac_case *c, const lac_grid *grid)
{
    lac_transfer_outline outline;
    (void)lac_transfer_outline_of(&c->transfer, &outline);
    return outline.rock != NULL ? c->material.shear_modulus / grid->dx : outline.k0;
}

void lac_judge_stability(const lac_case *c, lac_estimate *e)
{
    static const char *const holding[] = {"a", "b", "dc", NULL};
    const lac_friction_params *law = c->friction.params;
    const bool several = !(e->contact_cells <= 1);
    e->integrated = law != NULL && !isnan(c->run.end);
    e->stable = true;
    if (!e->integrated) {
        return;
    }
    double real_pressure = e->pressure * e->grid_cells / e->contact_cells;
    e->critical = real_pressure * (law->b - law->a) / law->dc;
    if (e->critical > 0 && several) {
        e->stiffness_ratio = finest_stiffness(c, &e->grid) / e->critical;
    }
    double safe = spreads(c, holding) ? safe_spread_ratio : safe_ratio;
    e->stable = !several || !(e->stiffness_ratio < safe);
}

// No cell weakens as it slips faster.
static bool strengthens(const lac_case *c)
{
    static const char *const weakening[] = {"a", "b", NULL};
    const lac_friction_params *law = c->friction.params;
    return law->b <= law->a && !spreads(c, weakening);
}

// Whether the case, of transfer hierarchy, runs as fidelity events with nothing else changed.
static bool could_have_own_steps(const lac_case *c)
{
    static const char *const cut_offs[] = {"v1", "v2", "alpha", NULL};
    const lac_friction_params *law = c->friction.params;
    lac_async_scene scene = {.transfer = (const void *)c->transfer.info,
                             .law = c->friction.info,
                             .cut_off = !isnan(law->v1) || !isnan(law->v2) || !isnan(law->alpha) ||
                                        spreads(c, cut_offs),
                             .linear = true,
                             .formulation = (lac_formulation)c->formulation};
    const lac_model_list *loads[] = {&c->shear, &c->pore};
    for (size_t k = 0; k < 2; k++) {
        for (size_t i = 0; i < loads[k]->count; i++) {
            scene.linear &= ((const lac_load_kind *)(const void *)loads[k]->item[i].info)->linear;
        }
    }
    return lac_case_admits_events(c) && lac_run_async_follows(&scene, NULL) == LAC_OK;
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

// Softly held by each other, yet never let go.
static bool slips_one_by_one(const lac_case *c, const lac_estimate *e)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.info;
    lac_transfer_outline outline;
    return lac_transfer_outline_of(&c->transfer, &outline) && kind->blocks != NULL &&
           spring_stiffness(c) < e->critical && e->stiffness_ratio < soft_ratio &&
           e->stiffness_ratio > least_ratio &&
           (outline.rock != NULL || !(outline.ratio < least_level_ratio));
}

const char *lac_faster_fidelity(const lac_case *c, const lac_estimate *e)
{
    if (e->own_steps) {
        return e->stiffness_ratio > stiff_ratio || strengthens(c) ? "ode" : NULL;
    }
    bool events =
        e->cells >= FEWEST_EVENTS_CELLS && slips_one_by_one(c, e) && could_have_own_steps(c);
    return events ? "events" : NULL;
}

// What counts as failure of a joint whose cells are not known: of one that slips evenly, by the
// case's own values.
static lac_failure failure_about(const lac_case *c, const lac_load_state *start,
                                 const lac_estimate *e)
{
    const lac_friction_params *law = c->friction.params;
    const double force = e->pressure - start->pore;
    lac_transfer_outline outline;
    (void)lac_transfer_outline_of(&c->transfer, &outline);
    const lac_failure_start at = {
        .rate = c->initial.slip_rate,
        .direct = law->a * force,
        .excess = (law->b - law->a) * force,
        .eta = lac_inertia_mass(c) > 0.0 ? 0.0 : lac_damping_of(&c->material),
        .held = start->spring_stiffness > 0.0 || outline.anchored,
        .length = fmax((double)e->grid.nx * e->grid.dx, (double)e->grid.ny * e->grid.dy)};
    return lac_failure_from(&at, c->run.failure_rate, c->run.failure_slip);
}

// What the loads come to at the start of a run whose scene is too large to be built.
static lac_status try_start(const lac_case *c, lac_load_files *files, lac_estimate *e,
                            lac_error *err)
{
    const bool by_load = isnan(c->initial.slip_rate) || c->initial.state == LAC_STATE_FROM_LOAD;
    lac_load_set loads;
    lac_load_state sum;
    LAC_TRY_RETURN(lac_scene_loads_create(c, files, &loads, err));
    lac_load_evaluate(&loads, 0.0, &sum);
    lac_load_set_clear(&loads);
    LAC_FAIL_IF(!(sum.pore < e->pressure), err, LAC_EINPUT,
                "initial: pore pressure %g Pa is not below the normal pressure %g Pa at the start",
                sum.pore, e->pressure);
    LAC_FAIL_IF(by_load && !(lac_load_shear(&sum, e->pressure) > 0.0), err, LAC_EINPUT,
                "load.shear: comes to %g Pa at the start; must be > 0",
                lac_load_shear(&sum, e->pressure));
    if (!isnan(c->initial.slip_rate)) {
        e->failure = failure_about(c, &sum, e);
    }
    return LAC_OK;
}

lac_status lac_scene_try(const lac_case *c, lac_load_files *files, lac_estimate *e, lac_error *err)
{
    lac_scene_contact contact = {0};
    lac_scene *scene = NULL;
    lac_status status;
    if (e->grid_cells > small_grid) {
        return e->integrated ? try_start(c, files, e, err) : LAC_OK;
    }
    if (!e->integrated) {
        status = lac_scene_contact_solve(c, false, &contact, err);
        lac_scene_contact_clear(&contact);
        return status;
    }
    status = lac_scene_create_with(c, files, &scene, err);
    if (status == LAC_OK) {
        status = lac_run_check(scene->problem, &c->run, err);
        e->failure = lac_problem_failure(scene->problem, c->run.failure_rate, c->run.failure_slip);
    }
    lac_scene_free(scene);
    return status;
}
