// SPDX-License-Identifier: GPL-3.0-or-later
// The factor of safety: what friction would hold at a reference slip rate, in the states that the
// cells are in, over what drives; docs/theory/safety.md.
#include "model/internal.h"
#include "model/weaken.h"

lac_safety lac_problem_safety_asked(const lac_problem *problem) { return problem->safety; }

// A state whose rates are not asked for.
static lac_look look_at(const lac_problem *problem, double t, const double *y, double *work)
{
    lac_look at = {
        .problem = problem, .y = y, .w = y + problem->n, .ws = lac_problem_split(problem, work)};
    at.t = t;
    const lac_gone gone = lac_problem_gone_in(problem, y, 0.0);
    (void)lac_problem_drive_into(problem, t, gone, at.ws.shares, &at.drive);
    (void)lac_weaken_look(&at);
    return at;
}

// p_i f(v_ref, theta_i), and cohesion, of the cells from `first` on [Pa]. Gives back how many.
static size_t hold(const lac_look *at, size_t first, double *strength)
{
    const lac_problem *problem = at->problem;
    const lac_friction *friction = problem->friction;
    const size_t length = lac_block_length(problem->n, first);
    double u[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK];
    lac_block s;
    const lac_friction_values values = lac_block_values(&s);
    for (size_t i = 0; i < length; i++) {
        const double named = problem->safety.reference_rate;
        v[i] = named > 0.0 ? named : lac_cellwise_of(&friction->column[LAC_V0], first + i);
        u[i] = log(v[i]);
    }
    const lac_friction_cells cells = {
        .first = first, .n = length, .u = u, .w = at->w + first, .v = v};
    lac_friction_evaluate(friction, &cells, &values, NULL);
    for (size_t i = 0; i < length; i++) {
        strength[i] = lac_problem_effective(problem, &at->drive, first + i) * s.f[i] +
                      lac_problem_cohesion(problem, first + i);
        strength[i] -= at->broken != NULL ? lac_look_lost(at, first + i) : 0.0;
    }
    return length;
}

// Where nothing drives there is no factor.
static double over(double strength, double drives)
{
    const double factor = strength / fabs(drives);
    return isfinite(factor) ? factor : NAN;
}

static void add_strength(const void *context, size_t from, size_t end, double *sums)
{
    const lac_look *at = context;
    double strength[LAC_FRICTION_BLOCK];
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        const size_t length = hold(at, first, strength);
        sums[0] += lac_problem_sum_from(at->problem, first, length, strength);
    }
}

double lac_look_safety(const lac_look *at, const double *slip)
{
    double sum;
    lac_range_sums(&at->problem->range, 1, add_strength, at, &sum);
    if (at->problem->across != NULL) {
        double along[2];
        return over(sum, lac_vector_sheared(at, slip, along));
    }
    return over(sum, lac_look_sheared(at, slip, lac_problem_mean(at->problem, slip)));
}

double lac_problem_safety(const lac_problem *problem, double t, const double *y, const double *slip,
                          double *work)
{
    const lac_look at = look_at(problem, t, y, work);
    return lac_look_safety(&at, slip);
}

void lac_problem_safety_cells(const lac_problem *problem, double t, const double *y,
                              const double *traction, double *safety, double *work)
{
    const lac_look at = look_at(problem, t, y, work);
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        const size_t length = hold(&at, first, safety + first);
        for (size_t i = first; i < first + length; i++) {
            safety[i] = over(safety[i], traction[i]);
        }
    }
}
