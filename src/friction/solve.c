// SPDX-License-Identifier: GPL-3.0-or-later
// Slip rates of many cells, begun at their last ones: by solve_rates.c where it can, else by
// Newton's method on the cells that are left.
#include <assert.h>

#include "base/roots.h"
#include "base/vmath.h"
#include "friction/cutoff.h"

// h(u) = p f(u, w) + eta e^u - |tau| rises with u = ln|v|. Newton's method on a block of cells at
// once, no step longer than LONGEST: where h bends upwards a step from the left may be far too
// long, one from the right never is. From the last rates two or three steps do; what is left after
// MOST steps is bisected, which cannot fail.

enum { MOST_STEPS = 40, MOST_HALVINGS = 80 };

#define LONGEST 1.5
// Newton's method doubles the digits, the error after a step du is below du^2/2 (h' rises by less
// than an e-fold with u): after one as short as this the next is rounding.
#define CLOSE 3e-8

// f alone, g is not asked for.
static void strength(const lac_friction *friction, size_t first, size_t n, const double *u,
                     const double *w, double *f, double *f_u)
{
    double f_w[LAC_FRICTION_BLOCK];
    lac_form_evaluate(friction, first, n, u, w,
                      &(lac_friction_values){.f = f, .f_u = f_u, .f_w = f_w}, NULL);
}

// One step of every cell. Gives back the longest.
static double newton_step(const lac_friction *friction, const lac_friction_balance *eq, double *u)
{
    double f[LAC_FRICTION_BLOCK], f_u[LAC_FRICTION_BLOCK], viscous[LAC_FRICTION_BLOCK];
    double longest = 0.0;
    strength(friction, eq->first, eq->n, u, eq->w, f, f_u);
    lac_vexp(eq->n, u, viscous);
    for (size_t i = 0; i < eq->n; i++) {
        double p = eq->pressure[i] * eq->share, damped = eq->damping * viscous[i];
        double du = (p * f[i] + damped - fabs(eq->traction[i])) / (p * f_u[i] + damped);
        du = du < LONGEST ? du : LONGEST;
        du = du > -LONGEST ? du : -LONGEST;
        double next = u[i] - du;
        next = next > LAC_SLOWEST ? next : LAC_SLOWEST;
        next = next < LAC_FASTEST ? next : LAC_FASTEST;
        double moved = fabs(next - u[i]);
        longest = moved > longest ? moved : longest;
        u[i] = next;
    }
    return longest;
}

static lac_friction_balance cell_of(const lac_friction_balance *eq, size_t i)
{
    lac_friction_balance one = lac_friction_balance_from(eq, i);
    one.n = 1;
    return one;
}

// One more step of cell i. Whether the next would be rounding.
static bool settles(const lac_friction *friction, const lac_friction_balance *eq, size_t i,
                    double *u)
{
    lac_friction_balance one = cell_of(eq, i);
    return newton_step(friction, &one, u) <= CLOSE;
}

static double bisect(const lac_friction *friction, const lac_friction_balance *eq, size_t i)
{
    double low = LAC_SLOWEST, high = LAC_FASTEST;
    double p = eq->pressure[i] * eq->share;
    for (int k = 0; k < MOST_HALVINGS; k++) {
        double u = 0.5 * (low + high), f, f_u;
        strength(friction, eq->first + i, 1, &u, eq->w + i, &f, &f_u);
        lac_halve(&low, &high, p * f + eq->damping * exp(u) <= fabs(eq->traction[i]));
    }
    return 0.5 * (low + high);
}

// At the scalar solution, or in the midst where there is none.
void lac_friction_warm(const lac_friction *friction, const lac_friction_balance *eq, double *u)
{
    for (size_t i = 0; i < eq->n; i++) {
        if (u[i] != 0.0 && u[i] >= LAC_SLOWEST && u[i] <= LAC_FASTEST) {
            continue;
        }
        double cold =
            lac_friction_rate_for(friction, eq->first + i, eq->w[i], fabs(eq->traction[i]),
                                  eq->pressure[i] * eq->share, eq->damping);
        cold = cold >= LAC_SLOWEST ? cold : LAC_SLOWEST; // also for NaN
        u[i] = cold <= LAC_FASTEST ? cold : LAC_FASTEST;
    }
}

// ln|v| by steps of the general strength.
static void search(const lac_friction *friction, const lac_friction_balance *eq, double *u)
{
    double longest = INFINITY;
    for (int step = 0; step < MOST_STEPS && longest > CLOSE; step++) {
        longest = newton_step(friction, eq, u);
    }
    for (size_t i = 0; longest > CLOSE && i < eq->n; i++) {
        if (!settles(friction, eq, i, &u[i])) {
            u[i] = bisect(friction, eq, i);
        }
    }
}

void lac_friction_search_rest(const lac_friction *friction, const lac_friction_balance *eq,
                              const double *open, double *u, double *v)
{
    for (size_t i = 0; i < eq->n; i++) {
        if (open[i] != 0) {
            lac_friction_balance one = cell_of(eq, i);
            search(friction, &one, &u[i]);
            v[i] = copysign(exp(u[i]), eq->traction[i]);
        }
    }
}

void lac_friction_rates(const lac_friction *friction, const lac_friction_balance *eq, double *u,
                        double *v)
{
    assert(eq->n <= LAC_FRICTION_BLOCK && eq->first + eq->n <= friction->n);
    if (!lac_cutoff_any(friction)) {
        lac_friction_solve_rates(friction, eq, u, v);
        return;
    }
    lac_friction_warm(friction, eq, u);
    search(friction, eq, u);
    lac_vexp(eq->n, u, v);
    for (size_t i = 0; i < eq->n; i++) {
        v[i] = copysign(v[i], eq->traction[i]);
    }
}
