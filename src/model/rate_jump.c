// SPDX-License-Identifier: GPL-3.0-or-later
// ln v across a jump of the loads: the rates that carry what the cells carry then, and their mean,
// which damps them; docs/theory/creep.md.
#include "model/internal.h"

// A jump of the loads, and the mean rate before it.
typedef struct leap {
    const lac_jump *jump;
    const double *y;
    double before; // [m/s]; 0 where it does not count
    const lac_problem *problem;
    double mean; // taken for the rate behind it [m/s]
} leap;

// ln v of cell i behind it, and ln theta, if the mean rate is `mean` then.
static double rate_behind(const lac_problem *problem, const leap *at, size_t i, double mean,
                          double *w)
{
    const lac_jump *jump = at->jump;
    double p = problem->pressure[i];
    double u = at->y[i];
    double f = lac_friction_coefficient(problem->friction, i, u, at->y[problem->n + i]);
    double share_before = lac_problem_share_of(jump->before, i);
    double share_after = lac_problem_share_of(jump->after, i);
    double held = p * share_before * f + problem->damping * exp(u);
    double drag = lac_problem_drag(problem, i) * (mean - at->before);
    *w = lac_friction_state_after(problem->friction, i, at->y[problem->n + i],
                                  share_after / share_before);
    return lac_friction_rate_for(problem->friction, i, *w,
                                 held + lac_problem_gain(problem, jump, i) - drag, p * share_after,
                                 problem->damping);
}

// Sums of v behind the jump and of its ease. A cell that finds no rate under so much drag stands
// still.
static void sum_behind(const leap *at, size_t first, size_t length, double sums[2])
{
    const lac_problem *problem = at->problem;
    double u[LAC_FRICTION_BLOCK], w[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK];
    double ease[LAC_FRICTION_BLOCK];
    for (size_t i = 0; i < length; i++) {
        u[i] = rate_behind(problem, at, first + i, at->mean, &w[i]);
        u[i] = isnan(u[i]) ? LAC_SLOWEST : u[i];
        v[i] = exp(u[i]);
    }
    const lac_friction_cells cells = {.first = first, .n = length, .u = u, .w = w, .v = v};
    lac_block_ease(problem, at->jump->after, &cells, ease);
    sums[0] += lac_problem_sum_from(problem, first, length, v);
    sums[1] += lac_problem_sum_from(problem, first, length, ease);
}

static void add_behind(const void *context, size_t from, size_t end, double *sums)
{
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        sum_behind(context, first, lac_block_length(end, first), sums);
    }
}

// The mean rate behind the jump, which damps all cells.
static double mean_behind(const lac_problem *problem, leap *at)
{
    double n = lac_problem_all(problem);
    lac_mean_search search = lac_mean_search_from(at->before);
    for (int k = 0; k < 200; k++) {
        double sums[2];
        at->mean = search.mean;
        lac_range_sums(&problem->range, 2, add_behind, at, sums);
        double moved = lac_mean_search_on(&search, sums[0] / n, sums[1] / n);
        if (!(fabs(moved) > DBL_EPSILON * fabs(search.mean))) {
            break;
        }
    }
    return search.mean;
}

// A mean's share of each cell.
static void add_before(const void *context, size_t first, size_t end, double *sums)
{
    const leap *at = context;
    for (size_t i = first; i < end; i++) {
        sums[0] +=
            lac_problem_weight(at->problem, i) * exp(at->y[i]) / lac_problem_all(at->problem);
    }
}

bool lac_rate_jump(const lac_problem *problem, const lac_jump *jump, double *y)
{
    leap at = {.jump = jump, .y = y, .problem = problem};
    double mean = 0.0;
    if (problem->drag != 0.0) {
        lac_range_sums(&problem->range, 1, add_before, &at, &at.before);
        mean = mean_behind(problem, &at);
    }
    for (size_t i = 0; i < problem->n; i++) {
        double w;
        double u = rate_behind(problem, &at, i, mean, &w);
        if (!isfinite(u)) {
            return false;
        }
        y[i] = u;
    }
    return true;
}
