// SPDX-License-Identifier: GPL-3.0-or-later
// The force that slip puts on cells through the rock, less that of far motion and far loads.
#include <stdlib.h>

#include "model/internal.h"

lac_status lac_problem_anchor(lac_problem *problem, lac_error *err)
{
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    double *ones = malloc(n * sizeof *ones);
    double *work = malloc((transfer->kind->work(transfer->state) + 1) * sizeof *work);
    problem->anchor = malloc(n * sizeof *problem->anchor);
    lac_status status = LAC_OK;
    LAC_TRY(ones != NULL && work != NULL && problem->anchor != NULL ? LAC_OK
                                                                    : lac_fail_memory(err));
    for (size_t i = 0; i < n; i++) {
        ones[i] = 1.0;
    }
    transfer->kind->apply(transfer->state, ones, problem->anchor, work);
    for (size_t i = 0; i < n; i++) {
        if (problem->anchor[i] != 0.0) {
            goto out;
        }
    }
    free(problem->anchor);
    problem->anchor = NULL;
out:
    free(ones);
    free(work);
    return status;
}

// force -= scale shape
static void take_off(size_t n, const double *shape, double scale, double *force)
{
    for (size_t i = 0; i < n; i++) {
        force[i] -= scale * shape[i];
    }
}

void lac_problem_couple(const lac_problem *problem, lac_far_field far, const double *x,
                        double *force, double *work)
{
    problem->transfer.kind->apply(problem->transfer.state, x, force, work);
    if (problem->anchor != NULL && far.back != 0.0) {
        take_off(problem->n, problem->anchor, far.back, force);
    }
    if (problem->loads.shape != NULL && far.elastic != 0.0) {
        take_off(problem->n, problem->loads.shape, far.elastic, force);
    }
}

double lac_problem_held(const lac_problem *problem, double back, const double *slip)
{
    if (problem->anchor == NULL) {
        return 0.0;
    }
    double total = 0.0;
    for (size_t i = 0; i < problem->n; i++) {
        total += problem->anchor[i] * (slip[i] - back);
    }
    return total;
}

const char *lac_problem_lost_transfer(const lac_problem *problem, const double *slip, double *work)
{
    lac_workspace ws = lac_problem_split(problem, work);
    const lac_transfer *transfer = &problem->transfer;
    double given = 0.0;
    double found = 0.0;
    transfer->kind->apply(transfer->state, slip, ws.kv, ws.scratch);
    for (size_t i = 0; i < problem->n; i++) {
        given += slip[i] * 0.0;
        found += ws.kv[i] * 0.0;
    }
    return given == 0.0 && found != 0.0 ? transfer->kind->info.name : NULL;
}
