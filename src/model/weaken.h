/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// The part of internal.h, which brings it, that is of weakening.
#include "model/internal.h"

// Unknowns of the weakening, whose mechanisms add up to K: their place in y, and scratch.
static inline size_t lac_weaken_place(const lac_problem *problem)
{
    return problem->kind->unknowns * problem->n;
}

typedef struct lac_weak_arrays {
    double *z;             // [K n] of docs/theory/weakening.md
    double *rest, *slope;  // [K n] Newton's: what sources change by is rest + slope x
    double *shares;        // [n] of the pressure that loads and excess leave
    double *rates;         // [n] and their rates [1/s]
    double *before, *bond; // [n] shares before a jump; what cohesion loses [Pa/s]
} lac_weak_arrays;

size_t lac_weaken_work(const lac_problem *problem); // doubles
lac_weak_arrays lac_weaken_split(const lac_problem *problem, double *work);

// LAC_EINPUT where the weakening does not go with the friction law.
lac_status lac_weaken_check(const lac_problem *problem, lac_error *err);

// Takes what y says of pressures and cohesion into a state whose loads are known. False where an
// effective pressure is not positive. Nothing where nothing weakens, as of all below.
bool lac_weaken_look_at(lac_look *at);
static inline bool lac_weaken_look(lac_look *at)
{
    return at->problem->weak == NULL || lac_weaken_look_at(at);
}

// The same of the loads on both sides of a jump.
void lac_weaken_jump(const lac_problem *problem, const double *y, const lac_workspace *ws,
                     lac_problem_loads_at *before, lac_problem_loads_at *after);

// traction += what is broken of cohesion, beside which friction stands alone. @param traction  [n]
static inline void lac_look_add_lost(const lac_look *at, double *traction)
{
    for (size_t i = 0; at->broken != NULL && i < at->problem->n; i++) {
        traction[i] += lac_look_lost(at, i);
    }
}

// Rates of the unknowns, from which those of the shares follow and of the cohesion; false where one
// is not finite. @param xdot  [n] each; NULL: not wanted
bool lac_weaken_rates_of(const lac_look *at, double *xdot);
static inline bool lac_weaken_rates(const lac_look *at, double *xdot)
{
    return at->problem->weak == NULL || lac_weaken_rates_of(at, xdot);
}

// kv -= what cohesion loses in a second.
void lac_weaken_take_off(const lac_look *at, double *kv);

// A block of cells in Newton's system: what the eliminated unknowns add to its diagonal, by the
// formulation's own x of d ln v (rate) or dv, and to its right-hand side.
typedef struct lac_weak_block {
    const lac_block *s;
    const lac_block_slopes *d;
    double *diagonal, *rhs; // [LAC_FRICTION_BLOCK] overwritten
} lac_weak_block;

// With (1 - gamma J) x = b, b that of all unknowns, ln theta of which is not yet eliminated. False
// where the system has no solution. @param loading  where ln v is the unknown; NULL: v is solved
// for
bool lac_weaken_reduce(const lac_look *at, double gamma, const double *loading, const double *b,
                       size_t first, const lac_weak_block *block);

// The unknowns themselves, once b begins with what the diagonal is by.
void lac_weaken_finish(const lac_look *at, double gamma, double *b);

// Error weights of y, the unknowns' own included; lac_problem_weights.
void lac_weaken_weigh(const lac_problem *problem, const double *y, double rtol, double *weight);

// The fastest decay [1/s].
double lac_weaken_fastest(const lac_problem *problem);
