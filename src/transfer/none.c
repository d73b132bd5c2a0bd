// SPDX-License-Identifier: GPL-3.0-or-later
// Cells that do not feel each other: only the load moves them.
#include "base/rows.h"
#include "transfer/transfer.h"

typedef struct none {
    lac_range range;
    const lac_hierarchy *h; // for slip in two directions
} none;

static lac_status create(const void *params, const lac_transfer_scene *scene, void **state,
                         lac_error *err)
{
    (void)params;
    none *self = malloc(sizeof *self);
    LAC_FAIL_MEMORY_IF(self == NULL, err);
    self->range = lac_range_whole(scene->domain->n);
    self->h = scene->hierarchy;
    *state = self;
    return LAC_OK;
}

static size_t work(const void *state)
{
    (void)state;
    return 0;
}

static void apply(const void *state, const double *slip, double *force, double *scratch)
{
    const none *self = state;
    (void)slip;
    (void)scratch;
    memset(force, 0, self->range.n * sizeof *force);
}

static bool good(double pivot) { return pivot > 0 && pivot <= DBL_MAX; }

typedef struct equation {
    const double *diagonal, *y;
} equation;

// g, g y, and how many g are not good.
static void add_pivots(const void *context, size_t first, size_t end, double *sums)
{
    const equation *e = context;
    for (size_t i = first; i < end; i++) {
        double g = 1 / e->diagonal[i];
        sums[0] += g;
        sums[1] += g * e->y[i];
        sums[2] += good(e->diagonal[i]) ? 0.0 : 1.0;
    }
}

// (D + k_mean P_m) x = y. The cells together act as one of D = t = n / sum g, g = 1/D, and
// right-hand side sum g y / sum g: m = mean x = sum g y / sum g / (t + k_mean), then
// x = g (y - k_mean m). Sums of positive g only, so nothing cancels (Sherman-Morrison would).
static bool solve(const void *state, double k_mean, const double *diagonal, const double *y,
                  double *x, double *scratch)
{
    const none *self = state;
    (void)scratch;
    if (self->range.n == 1) {
        x[0] = y[0] / (diagonal[0] + k_mean);
        return good(diagonal[0] + k_mean);
    }
    double sums[3];
    lac_range_sums(&self->range, 3, add_pivots, &(equation){diagonal, y}, sums);
    double pivot = (double)self->range.n / sums[0] + k_mean;
    if (sums[2] > 0.0 || !good(pivot)) {
        return false;
    }
    double mu = -k_mean * (sums[1] / sums[0] / pivot);
    for (size_t i = 0; i < self->range.n; i++) {
        x[i] = (y[i] + mu) / diagonal[i];
    }
    return true;
}

static lac_status direct(const void *params, const lac_transfer_scene *scene, void *state,
                         lac_error *err)
{
    (void)params, (void)scene, (void)state, (void)err;
    return LAC_OK;
}

static size_t pair_work(const void *state)
{
    const none *self = state;
    return lac_hierarchy_pair_work(self->h);
}

static void pair_apply(const void *state, const double *const slip[2], double *const force[2],
                       double *scratch)
{
    apply(state, slip[0], force[0], scratch);
    apply(state, slip[1], force[1], scratch);
}

// Blocks that nothing ties.
static bool pair_solve(const void *state, double k_mean, const double *const diagonal[3],
                       double *const x[2], double *scratch)
{
    static const double loose[64] = {0}; // more levels than any grid has
    const double *const k[2] = {loose, loose};
    return lac_hierarchy_solve_pair(((const none *)state)->h, k, k_mean, diagonal, x, scratch);
}

static const lac_transfer_pair pair = {
    .direct = direct, .work = pair_work, .apply = pair_apply, .solve = pair_solve};

static double stiffness(const void *state, size_t level)
{
    (void)state;
    (void)level;
    return 0;
}

const lac_transfer_kind lac_none_kind = {
    .info = LAC_ABOUT("none", "cells do not feel each other's slip",
                      "docs/theory/transfer.md, \"The operator\""),
    .create = create,
    .free = free,
    .work = work,
    .apply = apply,
    .solve = solve,
    .pair = &pair,
    .stiffness = stiffness,
};
