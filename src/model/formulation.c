// SPDX-License-Identifier: GPL-3.0-or-later
// The table of formulations, and what those that solve for the rate have in common.
#include <math.h>
#include <string.h>

#include "base/vsum.h"
#include "model/internal.h"

static const lac_formulation_kind *const kinds[] = {
    &lac_formulation_rate,
    &lac_formulation_traction,
    &lac_formulation_slip,
    &lac_formulation_inertia,
};

const lac_formulation_kind *lac_formulation_kind_of(lac_formulation id)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (kinds[i]->id == id) {
            return kinds[i];
        }
    }
    return &lac_formulation_rate;
}

const char *lac_formulation_name(lac_formulation formulation)
{
    return lac_formulation_kind_of(formulation)->name;
}

// Arrays of n that a matrix needs where the mean is damped: slip as an unknown makes none.
static size_t leaning(const lac_problem *problem)
{
    return problem->drag != 0.0 && !problem->kind->has_slip ? 1 : 0;
}

lac_workspace lac_problem_split(const lac_problem *problem, double *work)
{
    size_t n = problem->n;
    double *scratch = work + (problem->kind->arrays + leaning(problem)) * n;
    return (lac_workspace){.v = work,
                           .kv = work + n,
                           .diagonal = work + 2 * n,
                           .u = work + 3 * n,
                           .guess = work + 4 * n,
                           .bend = work + 4 * n,
                           .slope = work + 5 * n,
                           .row = work + problem->kind->arrays * n,
                           .scratch = scratch,
                           .mean = scratch + problem->transfer.kind->work(problem->transfer.state)};
}

size_t lac_problem_work(const lac_problem *problem)
{
    return (problem->kind->arrays + leaning(problem)) * problem->n +
           problem->transfer.kind->work(problem->transfer.state) + 1;
}

void lac_problem_forget(const lac_problem *problem, double *work)
{
    if (problem->kind->solved) {
        lac_workspace ws = lac_problem_split(problem, work);
        memset(ws.guess, 0, problem->n * sizeof *work);
        *ws.mean = 0.0;
    }
}

size_t lac_block_friction(const lac_problem *problem, const lac_problem_loads_at *drive,
                          const lac_motion *motion, const double *w, size_t first, lac_block *s,
                          lac_block_slopes *d)
{
    size_t length = lac_block_length(problem->n, first);
    lac_vabs(length, motion->v + first, s->speed);
    lac_friction_cells cells = {.first = first,
                                .n = length,
                                .u = motion->u + first,
                                .w = w + first,
                                .v = s->speed,
                                .normal_rate = drive->share_rate / drive->share};
    lac_friction_values values = lac_block_values(s);
    lac_friction_slopes slopes = {0};
    if (d != NULL) {
        slopes = (lac_friction_slopes){
            .f_uu = d->f_uu, .f_uw = d->f_uw, .f_ww = d->f_ww, .g_u = d->g_u, .g_w = d->g_w};
    }
    lac_friction_evaluate(problem->friction, &cells, &values, d != NULL ? &slopes : NULL);
    return length;
}

double lac_problem_unbalanced(const lac_problem *problem, const lac_problem_loads_at *drive,
                              const lac_motion *motion, const double *w, double *traction,
                              double *wdot)
{
    double total = 0.0;
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        lac_block s;
        size_t length = lac_block_friction(problem, drive, motion, w, first, &s, NULL);
        double part = 0.0;
        for (size_t i = 0; i < length; i++) {
            size_t k = first + i;
            double v = motion->v[k];
            double held = copysign(problem->pressure[k] * drive->share * s.f[i], v);
            double common = lac_problem_drag(problem, k) * motion->mean;
            traction[k] -= held + problem->damping * v + common;
            part += traction[k];
        }
        if (wdot != NULL) {
            memcpy(wdot + first, s.g, length * sizeof *wdot);
        }
        total += part;
    }
    return total;
}

bool lac_problem_evolve(const lac_problem *problem, const lac_problem_loads_at *drive,
                        const lac_motion *motion, const double *w, double *wdot)
{
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        double speed[LAC_FRICTION_BLOCK];
        size_t length = lac_block_length(problem->n, first);
        lac_vabs(length, motion->v + first, speed);
        lac_friction_cells cells = {.first = first,
                                    .n = length,
                                    .u = motion->u + first,
                                    .w = w + first,
                                    .v = speed,
                                    .normal_rate = drive->share_rate / drive->share};
        lac_friction_evaluate(problem->friction, &cells, &(lac_friction_values){.g = wdot + first},
                              NULL);
    }
    return lac_vfinite(problem->n, wdot);
}
