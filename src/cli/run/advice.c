// SPDX-License-Identifier: GPL-3.0-or-later
// The advice of `check` on fidelity: the other one, where it is known to be the faster.
#include "cli/run/advice.h"

#include <math.h>
#include <string.h>

#include "friction/friction.h"
#include "load/load.h"
#include "transfer/transfer.h"

// Fidelity events was 3 to 100 times faster below twice k_crit, ode 5 times from five times k_crit
// on and 40 times where b <= a: no cell slips by itself (docs/choosing.md). Few cells cost nothing
// either way. Where next to nothing holds cells or blocks once they slip, they slide so far that
// ode is the faster one again.
enum { FEWEST_EVENTS_CELLS = 64 };
static const double soft_ratio = 1, stiff_ratio = 5, least_ratio = 0.01, least_level_ratio = 0.3;

// No cell weakens as it slips faster.
static bool strengthens(const lac_case *c)
{
    const lac_friction_params *law = c->friction.params;
    return law->b <= law->a && !lac_spread_has(&c->friction_spread, "a") &&
           !lac_spread_has(&c->friction_spread, "b");
}

static bool linear_loads(const lac_slot_list *loads)
{
    for (size_t i = 0; i < loads->count; i++) {
        const lac_load_kind *kind = (const void *)loads->item[i].about;
        if (!kind->linear) {
            return false;
        }
    }
    return true;
}

static bool has_cut_off(const lac_case *c)
{
    const lac_friction_params *law = c->friction.params;
    return !isnan(law->v1) || !isnan(law->v2) || !isnan(law->alpha) ||
           lac_spread_has(&c->friction_spread, "v1") || lac_spread_has(&c->friction_spread, "v2") ||
           lac_spread_has(&c->friction_spread, "alpha");
}

// Whether the case, of transfer hierarchy, runs as fidelity events with nothing else changed.
static bool could_have_own_steps(const lac_case *c)
{
    const lac_events_scene scene = {.transfer = (const void *)c->transfer.about,
                                    .law = c->friction.about,
                                    .cut_off = has_cut_off(c),
                                    .linear = linear_loads(&c->shear) && linear_loads(&c->pore),
                                    .formulation = (lac_formulation)c->formulation};
    return lac_case_admits_events(c) && lac_run_events_follows(&scene, NULL) == LAC_OK;
}

// Of the springs on the mean slip [Pa/m].
static double spring_stiffness(const lac_case *c)
{
    double sum = 0;
    for (size_t i = 0; i < c->shear.count; i++) {
        const lac_load_kind *kind = (const void *)c->shear.item[i].about;
        sum += kind->stiffness != NULL ? kind->stiffness(c->shear.item[i].params) : 0;
    }
    return sum;
}

// Softly held by each other, yet never let go.
static bool slips_one_by_one(const lac_case *c, const cli_estimate *e)
{
    const lac_transfer_kind *kind = (const void *)c->transfer.about;
    lac_transfer_outline outline;
    return lac_transfer_outline_of(&c->transfer, &outline) && kind->blocks != NULL &&
           spring_stiffness(c) < e->critical && e->stiffness_ratio < soft_ratio &&
           e->stiffness_ratio > least_ratio &&
           (outline.rock != NULL || !(outline.ratio < least_level_ratio));
}

const char *cli_faster_fidelity(const lac_case *c, double cells, const cli_estimate *e)
{
    if (e->own_steps) {
        return e->stiffness_ratio > stiff_ratio || strengthens(c) ? "ode" : NULL;
    }
    bool events = cells >= FEWEST_EVENTS_CELLS && slips_one_by_one(c, e) && could_have_own_steps(c);
    return events ? "events" : NULL;
}
