// SPDX-License-Identifier: GPL-3.0-or-later
// Rates that carry given tractions: cell by cell, and where the mean is damped besides, all by the
// one mean that they have together; docs/theory/creep.md eq. 6.
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/vsum.h"
#include "model/internal.h"

// What the cells carry.
typedef struct load_of_cells {
    double share;
    const double *traction, *w; // [n]
} load_of_cells;

// Rates where the mean rate `taken` damps them; gives back their mean.
static double rates_under(const lac_problem *problem, const load_of_cells *on, double taken,
                          double *u, double *v)
{
    double left[LAC_FRICTION_BLOCK];
    size_t n = problem->n;
    double total = 0.0;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(n, first);
        const double *traction = on->traction + first;
        for (size_t i = 0; taken != 0.0 && i < length; i++) {
            left[i] = traction[i] - lac_problem_drag(problem, first + i) * taken;
        }
        lac_friction_balance balance = {.first = first,
                                        .n = length,
                                        .w = on->w + first,
                                        .traction = taken != 0.0 ? left : traction,
                                        .pressure = problem->pressure + first,
                                        .share = on->share,
                                        .damping = problem->damping};
        lac_friction_rates(problem->friction, &balance, u + first, v + first);
        total += lac_vsum(length, v + first);
    }
    return total / (double)n;
}

static void find_ease(const lac_problem *problem, const load_of_cells *on, const double *u,
                      const double *v, double *ease)
{
    double speed[LAC_FRICTION_BLOCK];
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(problem->n, first);
        lac_vabs(length, v + first, speed);
        const lac_friction_cells cells = {
            .first = first, .n = length, .u = u + first, .w = on->w + first, .v = speed};
        lac_block_ease(problem, on->share, &cells, ease + first);
    }
}

// Largest part of a rate that a mean rate greater by `moved` would take off it.
static double part_taken(size_t n, double moved, const double *ease, const double *v)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        double part = fabs(moved * ease[i] / v[i]);
        most = part > most ? part : most;
    }
    return most;
}

static void take_off(size_t n, double moved, const double *ease, double *u, double *v)
{
    for (size_t i = 0; i < n; i++) {
        double part = moved * ease[i] / v[i];
        u[i] -= part;
        v[i] -= part * v[i];
    }
}

// The rates whose own mean is the one that damps them: one unknown, found by Newton's method. Its
// last step, so small that it is linear, is taken by the rates themselves.
static double rates_together(const lac_problem *problem, const load_of_cells *on, double *u,
                             const lac_workspace *ws)
{
    const double linear = 2e-8; // its square is rounding
    const double near = 0.3;    // a better place to begin the next
    size_t n = problem->n;
    double *ease = ws->diagonal;
    lac_mean_search search = lac_mean_search_from(*ws->mean);
    for (int k = 0; k < 200; k++) {
        double found = rates_under(problem, on, search.mean, u, ws->v);
        if (!isfinite(found)) {
            return found;
        }
        find_ease(problem, on, u, ws->v, ease);
        double slope = lac_vsum(n, ease) / (double)n;
        double moved = lac_mean_search_on(&search, found, slope);
        double part = part_taken(n, moved, ease, ws->v);
        if (part <= near) {
            take_off(n, moved, ease, u, ws->v);
        }
        if (part <= linear) {
            break;
        }
        if (fabs(moved) <= DBL_EPSILON * fabs(search.mean)) {
            break;
        }
    }
    return lac_vsum(n, ws->v) / (double)n;
}

lac_motion lac_problem_solve_rates(const lac_problem *problem, double share, const double *traction,
                                   const double *w, const lac_workspace *ws, bool keep)
{
    const load_of_cells on = {.share = share, .traction = traction, .w = w};
    double *u = keep ? ws->guess : ws->u;
    double mean;
    if (!keep) {
        memcpy(u, ws->guess, problem->n * sizeof *u);
    }
    if (problem->drag == 0.0) {
        mean = rates_under(problem, &on, 0.0, u, ws->v);
    } else {
        mean = rates_together(problem, &on, u, ws);
        *ws->mean = keep && isfinite(mean) ? mean : *ws->mean;
    }
    return (lac_motion){.u = u, .v = ws->v, .mean = mean};
}
