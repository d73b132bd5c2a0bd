// SPDX-License-Identifier: GPL-3.0-or-later
// When a joint counts as failed; the rate for it is lowered where damping holds it below that.
#include "lacuna/simulation.h"
#include "model/internal.h"

// What uniform slip takes off all cells together [Pa s/m].
static double damped_together(const lac_problem *problem)
{
    double each = problem->damping + problem->mean_damping;
    return lac_problem_all(problem) * each + problem->drag * problem->sum_pressure;
}

// Mean rate, a p and (b - a) p over the nominal area.
static void add_start(const void *context, size_t first, size_t end, double *sums)
{
    const lac_problem *problem = context;
    const double n = lac_problem_all(problem);
    const double to_nominal = problem->cell_area / problem->nominal_area;
    for (size_t i = first; i < end; i++) {
        const double weight = lac_problem_weight(problem, i);
        double p = weight * lac_problem_effective(problem, &problem->drive0, i) * to_nominal;
        double a = lac_cellwise_of(&problem->friction->column[LAC_A], i);
        double b = lac_cellwise_of(&problem->friction->column[LAC_B], i);
        sums[0] += weight * exp(problem->log_rate0[i]) / n;
        sums[1] += a * p;
        sums[2] += (b - a) * p;
    }
}

static lac_failure_start look_at_start(const lac_problem *problem)
{
    double sums[3];
    double to_nominal = problem->cell_area / problem->nominal_area;
    lac_failure_start s = {.eta = damped_together(problem) * to_nominal,
                           .held = problem->at_start.spring_stiffness > 0.0 ||
                                   problem->anchor != NULL || problem->loads.geometry != NULL,
                           .length = problem->length};
    lac_range_sums(&problem->range, 3, add_start, problem, sums);
    s.rate = sums[0];
    s.direct = sums[1];
    s.excess = sums[2];
    return s;
}

lac_failure lac_failure_from(const lac_failure_start *start, double rate, double slip)
{
    lac_failure failure = {.rate = rate,
                           .slip = slip > 0.0 ? slip : start->length,
                           .start = start->rate,
                           .reach = INFINITY};
    if (start->held || !(start->eta > 0.0) || rate >= LAC_NO_FAILURE_RATE) {
        return failure;
    }
    double counts = start->direct / start->eta;
    failure.reach = start->excess * log(rate / start->rate) / start->eta;
    if (failure.reach < rate && counts < rate && counts > start->rate) {
        failure.rate = counts;
        failure.lowered = true;
    }
    return failure;
}

lac_failure lac_problem_failure(const lac_problem *problem, double rate, double slip)
{
    const lac_failure_start start = look_at_start(problem);
    return lac_failure_from(&start, rate, slip);
}

typedef struct slide {
    const lac_look *at;
    double rate, u; // and its ln
    double eta;     // damped_together
} slide;

// What they carry beyond what would hold them at the rate, and what that is in e-folds of it.
static void add_slide(const void *context, size_t first, size_t end, double *sums)
{
    const slide *s = context;
    const lac_look *at = s->at;
    const lac_problem *problem = at->problem;
    const lac_motion *motion = &at->motion;
    const lac_friction *friction = problem->friction;
    if (problem->range.first + first == 0) {
        sums[0] = s->eta * (fabs(motion->mean) - s->rate);
        sums[1] = s->eta * s->rate;
    }
    for (size_t i = first; i < end; i++) {
        double p = lac_problem_weight(problem, i) * lac_problem_effective(problem, &at->drive, i);
        double f = lac_friction_coefficient(friction, i, motion->u[i], at->w[i]);
        double along = (motion->v[i] < 0.0) == (motion->mean < 0.0) ? f : -f;
        sums[0] += p * (along - lac_friction_coefficient(friction, i, s->u, at->w[i]));
        sums[1] += p * lac_cellwise_of(&friction->column[LAC_A], i);
    }
}

// What all cells would be past the rate of failure if they slid as one: the load that they carry
// against what would hold them then, in e-folds of that rate.
static double past_as_one(const lac_look *at, double rate)
{
    const slide s = {at, rate, log(rate), damped_together(at->problem)};
    double sums[2];
    lac_range_sums(&at->problem->range, 2, add_slide, &s, sums);
    return sums[0] / sums[1];
}

double lac_problem_past_failure(const lac_problem *problem, const lac_failure *failure, double t,
                                const double *y, double *work)
{
    lac_look at;
    lac_problem_look(problem, t, y, work, &at);
    double past = log(fabs(at.motion.mean) / failure->rate);
    if (!failure->lowered || !(past >= 0.0)) {
        return past;
    }
    double as_one = past_as_one(&at, failure->rate);
    return as_one < past ? as_one : past;
}
