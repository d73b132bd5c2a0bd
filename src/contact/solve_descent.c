// SPDX-License-Identifier: GPL-3.0-or-later
// Pressures of a partial contact by conjugate gradients, most of it in single precision.
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "contact/solve_rows.h"

// Minimises p.Sp/2 - h.p over p >= 0 with a given mean. The gradient S p - h, less its mean over
// the contact I = {p > 0}, is the gap g. docs/theory/contact.md, "Solver".
//
// p is kept in double precision; the gap, whose relative error is what counts, the directions and
// the changes of the gap in single. The gap is brought up to date by single-precision products of
// the changes of p, and computed anew in double precision before the errors of that show.
//
// Each stage is one sweep over rows that are on their way into or out of a transform; sums are
// kept row by row and added in order, so that they do not depend on threads.

enum { MOST_UPDATES = 64 };

// What the error of a single-precision product is at most, of its rms.
static const double single_error = 2e-7;

// The rows' sums, in order
static lac_sums total(const lac_iteration *it)
{
    lac_sums all = {0};
    for (size_t j = 0; j < it->ny; j++) {
        lac_sums_add(&all, it->rows[j]);
    }
    return all;
}

bool lac_residual_holds(const lac_residual *r, double tolerance)
{
    return r->complementarity < tolerance && r->penetration < tolerance && r->load < tolerance;
}

// The gap in double precision.
static void refresh(lac_iteration *it, bool same_step)
{
    it->keep = same_step ? 1.0 : 0.0;
    lac_filter_fill(it->s->filter, LAC_DOUBLE, lac_pressure_row, it);
    lac_half_space_displace(it->s);
    lac_filter_take(it->s->filter, lac_level_row, it);
    lac_sums all = total(it);
    it->cells = all.a;
    it->sum_p = all.c;
    it->level = it->held ? all.b / all.a : it->level;
    lac_filter_take(it->s->filter, lac_fresh_row, it);
    it->g_mean = 0.0;
    it->scale = 1.0;
    it->error = 0.0;
    it->updates = 0;
}

// The gap from the change of p in the transform, in single precision.
static void update(lac_iteration *it)
{
    lac_half_space_displace(it->s);
    lac_filter_take(it->s->filter, lac_update_row, it);
    lac_sums all = total(it);
    it->cells = all.a;
    it->level += it->g_mean; // which lac_update_row took off
    it->g_mean = it->held ? all.b / all.a : 0.0;
    it->error += single_error * sqrt(all.d / ((double)it->nx * (double)it->ny));
    it->updates++;
}

// How far from the solution p is, by the g at hand; leaves the gap in the transform.
static void measure(lac_iteration *it, lac_descent *d)
{
    lac_filter_fill(it->s->filter, LAC_SINGLE, lac_gap_row, it);
    lac_sums all = total(it);
    double n = (double)it->nx * (double)it->ny;
    it->g2 = all.b;
    it->sum_g = all.c;
    d->closest = -it->level;
    d->residual.complementarity = it->sum_p > 0.0 ? it->scale * all.a / it->sum_p : 0.0;
    d->residual.load = it->held ? fabs(it->sum_p / n / d->mean_pressure - 1.0) : 0.0;
}

// Deepest negative gap where p = 0.
static double penetration(const lac_iteration *it)
{
    double least = 0.0;
    for (size_t i = 0; i < it->nx * it->ny; i++) {
        double gap = it->p[i] > 0.0 ? 0.0 : (double)it->g[i] - it->g_mean;
        least = gap < least ? gap : least;
    }
    return -least;
}

static bool balanced(const lac_descent *d)
{
    return d->residual.complementarity < d->tolerance && d->residual.load < d->tolerance;
}

// Whether the solution is reached, which only a fresh product tells. The penetration costs a
// sweep: only where the rest holds.
static bool settled(lac_iteration *it, lac_descent *d)
{
    if (balanced(d) && it->updates > 0) {
        refresh(it, true);
        measure(it, d);
    }
    if (!balanced(d)) {
        return false;
    }
    d->residual.penetration = penetration(it);
    return d->residual.penetration < d->tolerance;
}

// |q| hardly sees the mean over I, which nothing holds under a given approach; without it contacts
// nearly complete converge badly. Its own step: sum of g / 1.S1, the two over I.
static double mean_step(lac_iteration *it)
{
    if (it->held) {
        return 0.0;
    }
    lac_filter_fill(it->s->filter, LAC_SINGLE, lac_ones_row, it);
    double compliance = lac_half_space_energy(it->s);
    lac_filter_fill(it->s->filter, LAC_SINGLE, lac_gap_row, it);
    return compliance > 0.0 ? it->sum_g / compliance : 0.0;
}

// The search direction: |q| preconditioner and PR+; returns g.t
static double direction(lac_iteration *it)
{
    double shift = mean_step(it);
    lac_half_space_unload(it->s);
    lac_filter_take(it->s->filter, lac_overlap_row, it);
    lac_sums all = total(it);
    it->z_mean = it->held ? all.a / it->cells : -shift;
    it->t_mean = it->held ? all.e / it->cells : 0.0;
    double G = all.b + shift * it->sum_g;
    it->beta = 0.0;
    if (it->G_old > 0.0) {
        it->beta = fmax(0.0, (all.c - it->z_mean * all.d) / it->G_old);
    }
    // beta > 2 or a direction that does not descend: start afresh
    if (!(it->beta <= 2.0) || !(G + it->beta * all.f > 0.0)) {
        it->beta = 0.0;
    }
    lac_filter_refill(it->s->filter, lac_direction_row, it);
    it->G_old = G;
    return G + it->beta * all.f;
}

// Step tau = g.t / t.St, and tau_ov = (g.t)^2 / (t.St g.g) for the cells that close
static void choose_step(lac_iteration *it, double gt)
{
    double tst = lac_half_space_energy(it->s);
    it->tau = gt / tst;
    it->tau_ov = it->tau * gt / it->g2;
    if (!(gt > 0.0 && tst > 0.0 && it->g2 > 0.0 && isfinite(it->tau) && isfinite(it->tau_ov))) {
        // The pressures in contact are in balance: only cells outside can still move.
        it->tau = 0.0;
        it->tau_ov = 1.0 / it->s->self;
    }
}

// Whether the error of g would show: in the residual, or in the stop test that is near.
static bool stale(const lac_iteration *it, const lac_descent *d)
{
    return it->updates >= MOST_UPDATES || d->residual.complementarity < 30.0 * it->error ||
           d->residual.complementarity < 3.0 * d->tolerance;
}

static void step(lac_iteration *it, const lac_descent *d)
{
    lac_filter_fill(it->s->filter, LAC_SINGLE, lac_step_row, it);
    lac_sums all = total(it);
    it->scale = it->held ? d->mean_pressure * (double)it->nx * (double)it->ny / all.a : 1.0;
    it->sum_p = it->scale * all.a;
    // New cells change the problem: the directions so far are conjugate no more.
    if (all.b > 0.01 * it->g2) {
        it->G_old = 0.0;
    }
    if (stale(it, d)) {
        refresh(it, false);
    } else {
        update(it);
    }
}

static void iterate(lac_iteration *it, lac_descent *d)
{
    refresh(it, false);
    measure(it, d);
    d->iterations = 0;
    d->products = 1;
    while (!settled(it, d) && d->iterations < d->max_iterations) {
        choose_step(it, direction(it));
        step(it, d);
        measure(it, d);
        d->iterations++;
        d->products += it->held ? 2 : 3;
    }
    if (it->updates > 0) { // out of iterations
        refresh(it, true);
        measure(it, d);
    }
    d->residual.penetration = penetration(it);
}

lac_status lac_descend(lac_half_space *s, lac_descent *d, double *pressure, double *gap,
                       lac_error *err)
{
    size_t n = s->nx * s->ny;
    float *work = calloc(4 * n, sizeof *work);
    lac_sums *rows = malloc(s->ny * sizeof *rows);
    lac_status status = work != NULL && rows != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    for (size_t i = 0; i < n; i++) {
        work[i] = (float)d->heights[i];
    }
    lac_iteration it = {.s = s,
                        .nx = s->nx,
                        .ny = s->ny,
                        .h = d->heights,
                        .h_short = work,
                        .p = pressure,
                        .gap = gap,
                        .g = &work[n],
                        .dg = &work[2 * n],
                        .t = &work[3 * n],
                        .rows = rows,
                        .scale = 1.0,
                        .level = -d->approach,
                        .held = d->control == LAC_CONTROL_LOAD};
    iterate(&it, d);
out:
    free(work);
    free(rows);
    return status;
}
