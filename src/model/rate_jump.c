// SPDX-License-Identifier: GPL-3.0-or-later
// ln v across a jump of the loads: the rates that carry what the cells carry then, and their mean,
// which damps them; docs/theory/creep.md.
#include "base/vsum.h"
#include "model/internal.h"

// A jump of the loads, and the mean rate before it.
typedef struct leap {
    const lac_jump *jump;
    const double *y;
    double before; // [m/s]; 0 where it does not count
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

// Sums over a block of v behind the jump and of its ease. A cell that finds no rate under so much
// drag stands still.
static void sum_behind(const lac_problem *problem, const leap *at, double mean, size_t first,
                       double sums[2])
{
    double u[LAC_FRICTION_BLOCK], w[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK];
    double ease[LAC_FRICTION_BLOCK];
    size_t length = lac_block_length(problem->n, first);
    for (size_t i = 0; i < length; i++) {
        u[i] = rate_behind(problem, at, first + i, mean, &w[i]);
        u[i] = isnan(u[i]) ? LAC_SLOWEST : u[i];
        v[i] = exp(u[i]);
    }
    const lac_friction_cells cells = {.first = first, .n = length, .u = u, .w = w, .v = v};
    lac_block_ease(problem, at->jump->after, &cells, ease);
    sums[0] += lac_problem_sum_from(problem, first, length, v);
    sums[1] += lac_problem_sum_from(problem, first, length, ease);
}

// The mean rate behind the jump, which damps all cells.
static double mean_behind(const lac_problem *problem, const leap *at)
{
    double n = (double)problem->n;
    lac_mean_search search = lac_mean_search_from(at->before);
    for (int k = 0; k < 200; k++) {
        double sums[2] = {0.0, 0.0};
        for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
            sum_behind(problem, at, search.mean, first, sums);
        }
        double moved = lac_mean_search_on(&search, sums[0] / n, sums[1] / n);
        if (!(fabs(moved) > DBL_EPSILON * fabs(search.mean))) {
            break;
        }
    }
    return search.mean;
}

bool lac_rate_jump(const lac_problem *problem, const lac_jump *jump, double *y)
{
    leap at = {.jump = jump, .y = y};
    double mean = 0.0;
    if (problem->drag != 0.0) {
        for (size_t i = 0; i < problem->n; i++) {
            at.before += lac_problem_weight(problem, i) * exp(y[i]) / (double)problem->n;
        }
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
