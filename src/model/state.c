// SPDX-License-Identifier: GPL-3.0-or-later
// A state without its formulation: what another problem of the same cells goes on from. Slip and
// state of the cells stay as they are; what they carry, and with it their slip rates, is the load
// of the problem that takes it; docs/theory/restart.md.
#include "base/vsum.h"
#include "model/internal.h"
#include "model/weaken.h"

static size_t modes_of(const lac_problem *problem)
{
    return problem->weak != NULL ? problem->weak->modes : 0;
}

lac_status lac_problem_state_create(const lac_problem *problem, lac_problem_state *state,
                                    lac_error *err)
{
    const size_t n = problem->n, modes = modes_of(problem);
    double *values = calloc((5 + modes) * n, sizeof *values);
    LAC_FAIL_MEMORY_IF(values == NULL, err);
    *state = (lac_problem_state){.n = n,
                                 .modes = modes,
                                 .slip = {values, values + n},
                                 .rate = values + 2 * n,
                                 .log_state = values + 3 * n,
                                 .share = values + 4 * n,
                                 .weak = values + 5 * n};
    for (size_t i = 0; i < n; i++) {
        state->share[i] = NAN;
    }
    return LAC_OK;
}

void lac_problem_state_clear(lac_problem_state *state)
{
    free(state->slip[0]);
    *state = (lac_problem_state){0};
}

void lac_problem_give(const lac_problem *problem, double t, const double *y, const double *slip,
                      lac_problem_state *state, double *work)
{
    const size_t n = problem->n, bytes = n * sizeof *y;
    lac_look at;
    lac_problem_look(problem, t, y, work, &at);
    for (size_t i = 0; i < n; i++) {
        state->share[i] = lac_problem_share_of(&at.drive, i);
    }
    memcpy(state->log_state, y + n, bytes);
    memcpy(state->weak, y + lac_weaken_place(problem), state->modes * bytes);
    const double *own = problem->kind->has_slip ? y + lac_problem_slip_place(problem) : slip;
    memcpy(state->slip[0], problem->across != NULL ? y : own, bytes);
    if (problem->across != NULL) {
        memcpy(state->slip[1], own, bytes);
    }
    lac_problem_rates(problem, t, y, state->rate, work);
}

// The unknowns that need no balance, in the order of the formulation of `problem`; x is slip.
static void lay(const lac_problem *problem, const lac_problem_state *state, double *y)
{
    const size_t n = problem->n, bytes = n * sizeof *y;
    memcpy(y, state->slip[0], bytes);
    memcpy(y + n, state->log_state, bytes);
    if (problem->kind->unknowns == 3) {
        memcpy(y + 2 * n, state->slip[problem->across != NULL ? 1 : 0], bytes);
    }
    memcpy(y + lac_weaken_place(problem), state->weak, state->modes * bytes);
}

// The state answers to a pressure that is another one at once, as where a load jumps.
static bool respond(const lac_look *at, const lac_problem_state *state, double *w)
{
    bool good = true;
    for (size_t i = 0; i < state->n; i++) {
        if (!isnan(state->share[i])) {
            const double change = lac_problem_share_of(&at->drive, i) / state->share[i];
            w[i] = lac_friction_state_after(at->problem->friction, i, w[i], change);
            good = good && isfinite(exp(w[i]));
        }
    }
    return good;
}

// x of mass: its slip rate, which does not jump.
static bool keep_rates(const lac_problem *problem, const double *rate, double *x)
{
    bool good = true;
    for (size_t i = 0; i < problem->n; i++) {
        x[i] = problem->slow > 0.0 ? asinh(rate[i] / (2.0 * problem->slow)) : log(rate[i]);
        good = good && isfinite(x[i]);
    }
    return good;
}

// x where the rate is solved for, in `as`, a problem of slip that is otherwise the same.
static bool balance(const lac_problem *problem, const lac_look *at, double *slip, double *x)
{
    const size_t n = problem->n;
    bool good = true;
    if (problem->kind->id == LAC_FORMULATION_TRACTION) {
        lac_problem_elastic_traction(at, slip, x);
        return lac_vfinite(n, x);
    }
    for (size_t i = 0; i < n; i++) {
        x[i] = at->motion.u[i];
        good = good && at->motion.v[i] > 0.0 && isfinite(x[i]);
    }
    return good;
}

static lac_status fail_balance(double t, lac_error *err)
{
    return lac_fail(err, LAC_EINPUT,
                    "no slip rate and state that this formulation can follow balance the load at "
                    "t = %.9g s: where it turns slip back, solver.formulation traction or slip "
                    "with the friction law's form regularised does",
                    t);
}

lac_status lac_problem_take(const lac_problem *problem, double t, const lac_problem_state *state,
                            double *y, double *slip, lac_error *err)
{
    lac_problem as = *problem;
    const size_t n = problem->n, bytes = n * sizeof *y;
    const bool balanced = !problem->kind->has_slip;
    as.kind = balanced ? &lac_formulation_slip : problem->kind;
    lac_problem_lay_out(&as);
    const size_t unknowns = lac_problem_unknowns(&as);
    lac_status status = LAC_OK;
    lac_look at;
    double *z = calloc(unknowns + lac_problem_work(&as), sizeof *z);
    double *work = z != NULL ? z + unknowns : NULL;
    LAC_FAIL_MEMORY_IF(z == NULL, err);
    lay(&as, state, z);
    lac_problem_forget(&as, work);
    if (problem->kind->id == LAC_FORMULATION_INERTIA) {
        LAC_TRY(keep_rates(problem, state->rate, z) ? LAC_OK : fail_balance(t, err));
    }
    LAC_TRY(lac_problem_lifted(&as, t, z, 0.0, work, err));
    (void)lac_problem_begin(&as, t, z, false, work, &at);
    LAC_TRY(respond(&at, state, z + n) ? LAC_OK : fail_balance(t, err));
    lac_problem_forget(&as, work);
    LAC_TRY(lac_problem_begin(&as, t, z, false, work, &at) ? LAC_OK : fail_balance(t, err));
    LAC_TRY(lac_vfinite(n, at.motion.v) ? LAC_OK : fail_balance(t, err));
    memcpy(y, z, (balanced ? 0 : unknowns) * sizeof *y);
    if (balanced) {
        memcpy(slip, state->slip[0], bytes);
        memcpy(y + n, z + n, bytes);
        memcpy(y + lac_weaken_place(problem), state->weak, state->modes * bytes);
        LAC_TRY(balance(problem, &at, slip, y) ? LAC_OK : fail_balance(t, err));
    }
out:
    free(z);
    return status;
}
