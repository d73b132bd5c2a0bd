// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "contact/solve.h"

// Minimises p.Sp/2 - h.p over p >= 0 with a given mean. The gradient S p - h, less its mean over
// the contact I = {p > 0}, is the gap g. docs/theory/contact.md, "Solver".
//
// p is kept in double precision; the gap, whose relative error is what counts, the directions and
// the changes of the gap in single. The gap is brought up to date by single-precision products of
// the changes of p, and computed anew in double precision before the errors of that show.
//
// Each stage is one sweep over rows that are on their way into or out of a transform; sums are
// kept row by row and added in order, so that they do not depend on threads.

enum {
    MOST_UPDATES = 64,
    APART = 272, // between arrays: no power of two, where they would fall on the same cache lines
    PIECE = 512 // cells of a row whose sums are taken in single precision
};

// What the error of a single-precision product is at most, of its rms.
static const double single_error = 2e-7;

typedef struct sums {
    double a, b, c, d, e, f;
} sums;

typedef struct iteration {
    lac_half_space *s;
    size_t nx, ny;
    const double *h;      // [ny * nx]
    const float *h_short; // [ny * nx] the same
    double *p;            // [ny * nx] pressure over scale
    double *gap;          // [ny * nx] of the last fresh product; or NULL
    float *g;             // [ny * nx] gap plus g_mean
    float *dg;            // [ny * nx] last change of the gap plus g_mean, on I
    float *t;             // [ny * nx] search direction, 0 outside I
    sums *rows;           // [ny]
    double level;         // gap = S p - h - level
    double g_mean;        // of g over I
    double cells;         // in I
    double sum_p;         // over all cells
    double sum_g, g2;     // sums over I of the gap and its square
    double G_old;         // z.g of the step before; 0 to start afresh
    double z_mean, beta;  // of the direction
    double t_mean;        // over I, of the direction before
    double tau, tau_ov;   // step along t; step of the cells that open or close
    double scale;         // brings p back to the load
    double keep;          // 1 where a fresh product goes with the same step, 0 with a new one
    double error;         // of g, about, from updates since the last fresh product
    int updates;          // since then
    bool held;            // the load is given: directions keep it, and the gap has mean 0 over I
} iteration;

bool lac_residual_holds(const lac_residual *r, double tolerance)
{
    return r->complementarity < tolerance && r->penetration < tolerance && r->load < tolerance;
}

// The rows' sums, in order
static sums total(const iteration *it)
{
    sums all = {0};
    for (size_t j = 0; j < it->ny; j++) {
        all.a += it->rows[j].a;
        all.b += it->rows[j].b;
        all.c += it->rows[j].c;
        all.d += it->rows[j].d;
        all.e += it->rows[j].e;
        all.f += it->rows[j].f;
    }
    return all;
}

// p <- scale p, and into the transform
static void pressure_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    double *restrict p = &it->p[j * it->nx];
    double *restrict into = row;
    double scale = it->scale;
    for (size_t i = 0; i < it->nx; i++) {
        p[i] *= scale;
        into[i] = p[i];
    }
}

// Sums: cells of I, sum of u - h over I, sum of p
static void level_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict u = row;
    const double *restrict p = &it->p[j * it->nx];
    const double *restrict h = &it->h[j * it->nx];
    double cells = 0.0;
    double sum_g = 0.0;
    double sum_p = 0.0;
    const size_t n = it->nx;
#pragma omp simd reduction(+ : cells, sum_g, sum_p)
    for (size_t i = 0; i < n; i++) {
        cells += p[i] > 0.0 ? 1.0 : 0.0;
        sum_g += p[i] > 0.0 ? u[i] - h[i] : 0.0;
        sum_p += p[i];
    }
    it->rows[j] = (sums){.a = cells, .b = sum_g, .c = sum_p};
}

// g = u - h - level
static void fresh_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict u = row;
    const double *restrict h = &it->h[j * it->nx];
    float *restrict g = &it->g[j * it->nx];
    float *restrict dg = &it->dg[j * it->nx];
    float keep = (float)it->keep;
    float offset = (float)((1.0 - it->keep) * it->g_mean);
    double level = it->level;
    for (size_t i = 0; i < it->nx; i++) {
        float gap = (float)(u[i] - h[i] - level);
        dg[i] = keep * dg[i] + (gap - g[i] + offset);
        g[i] = gap;
    }
    for (size_t i = 0; i < it->nx && it->gap != NULL; i++) {
        it->gap[j * it->nx + i] = u[i] - h[i] - level;
    }
}

// The gap in double precision.
static void refresh(iteration *it, bool same_step)
{
    it->keep = same_step ? 1.0 : 0.0;
    lac_filter_fill(it->s->filter, LAC_DOUBLE, pressure_row, it);
    lac_half_space_displace(it->s);
    lac_filter_take(it->s->filter, level_row, it);
    sums all = total(it);
    it->cells = all.a;
    it->sum_p = all.c;
    it->level = it->held ? all.b / all.a : it->level;
    lac_filter_take(it->s->filter, fresh_row, it);
    it->g_mean = 0.0;
    it->scale = 1.0;
    it->error = 0.0;
    it->updates = 0;
}

// g <- g + S d + (scale - 1) (u + S d) with d the change of p; sums: cells of I, sum of g over I,
// square of S d
static sums update_piece(const iteration *it, size_t n, size_t at, const float *restrict du)
{
    const double *restrict p = &it->p[at];
    const float *restrict h = &it->h_short[at];
    float *restrict g = &it->g[at];
    float *restrict dg = &it->dg[at];
    float g_mean = (float)it->g_mean;
    float level = (float)it->level;
    float more = (float)(it->scale - 1.0);
    float cells = 0.0F;
    float sum_g = 0.0F;
    float du2 = 0.0F;
#pragma omp simd reduction(+ : cells, sum_g, du2)
    for (size_t i = 0; i < n; i++) {
        float gap = g[i] - g_mean;
        float change = du[i] + more * (du[i] + (gap + (h[i] + level)));
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        g[i] = gap + change;
        dg[i] = change;
        cells += in;
        sum_g += in * (gap + change);
        du2 += du[i] * du[i];
    }
    return (sums){.a = (double)cells, .b = (double)sum_g, .d = (double)du2};
}

static void add(sums *all, sums piece)
{
    all->a += piece.a;
    all->b += piece.b;
    all->c += piece.c;
    all->d += piece.d;
    all->e += piece.e;
    all->f += piece.f;
}

static void update_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const float *du = row;
    sums all = {0};
    for (size_t i = 0; i < it->nx; i += PIECE) {
        size_t n = it->nx - i < PIECE ? it->nx - i : PIECE;
        add(&all, update_piece(it, n, j * it->nx + i, &du[i]));
    }
    it->rows[j] = all;
}

// The gap from the change of p in the transform, in single precision.
static void update(iteration *it)
{
    lac_half_space_displace(it->s);
    lac_filter_take(it->s->filter, update_row, it);
    sums all = total(it);
    it->cells = all.a;
    it->level += it->g_mean; // which update_row took off
    it->g_mean = it->held ? all.b / all.a : 0.0;
    it->error += single_error * sqrt(all.d / ((double)it->nx * (double)it->ny));
    it->updates++;
}

// The gap of the contact goes into the transform; sums: p |g|, g^2, g over I
static void gap_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict p = &it->p[j * it->nx];
    const float *restrict g = &it->g[j * it->nx];
    float *restrict into = row;
    float g_mean = (float)it->g_mean;
    double pg = 0.0;
    double g2 = 0.0;
    double sum_g = 0.0;
    const size_t n = it->nx;
#pragma omp simd reduction(+ : pg, g2, sum_g)
    for (size_t i = 0; i < n; i++) {
        float gap = g[i] - g_mean;
        double inside = p[i] > 0.0 ? (double)gap : 0.0;
        into[i] = (float)inside;
        pg += p[i] * fabs(inside);
        g2 += inside * inside;
        sum_g += inside;
    }
    it->rows[j] = (sums){.a = pg, .b = g2, .c = sum_g};
}

// How far from the solution p is, by the g at hand; leaves the gap in the transform.
static void measure(iteration *it, lac_descent *d)
{
    lac_filter_fill(it->s->filter, LAC_SINGLE, gap_row, it);
    sums all = total(it);
    double n = (double)it->nx * (double)it->ny;
    it->g2 = all.b;
    it->sum_g = all.c;
    d->closest = -it->level;
    d->residual.complementarity = it->sum_p > 0.0 ? it->scale * all.a / it->sum_p : 0.0;
    d->residual.load = it->held ? fabs(it->sum_p / n / d->mean_pressure - 1.0) : 0.0;
}

// Deepest negative gap where p = 0.
static double penetration(const iteration *it)
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
static bool settled(iteration *it, lac_descent *d)
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

// Sums over I: z, z.g, z.dg, dg, t, g.t
static sums overlap_piece(const iteration *it, size_t n, size_t at, const float *restrict z)
{
    const double *restrict p = &it->p[at];
    const float *restrict g = &it->g[at];
    const float *restrict dg = &it->dg[at];
    const float *restrict t = &it->t[at];
    float g_mean = (float)it->g_mean;
    float sz = 0.0F;
    float zg = 0.0F;
    float zd = 0.0F;
    float sd = 0.0F;
    float st = 0.0F;
    float gt = 0.0F;
#pragma omp simd reduction(+ : sz, zg, zd, sd, st, gt)
    for (size_t i = 0; i < n; i++) {
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        float zi = in * z[i];
        float ti = in * t[i];
        float gi = g[i] - g_mean;
        float di = dg[i] - g_mean;
        sz += zi;
        zg += zi * gi;
        zd += zi * di;
        sd += in * di;
        st += ti;
        gt += ti * gi;
    }
    return (sums){(double)sz, (double)zg, (double)zd, (double)sd, (double)st, (double)gt};
}

static void overlap_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const float *z = row;
    sums all = {0};
    for (size_t i = 0; i < it->nx; i += PIECE) {
        size_t n = it->nx - i < PIECE ? it->nx - i : PIECE;
        add(&all, overlap_piece(it, n, j * it->nx + i, &z[i]));
    }
    it->rows[j] = all;
}

// t = z - z_mean + beta (t - t_mean) on I, 0 elsewhere, also into the transform, which holds z
static void direction_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict p = &it->p[j * it->nx];
    float *restrict t = &it->t[j * it->nx];
    float *restrict z = row;
    float beta = (float)it->beta;
    float offset = (float)(-it->z_mean - it->beta * it->t_mean);
    for (size_t i = 0; i < it->nx; i++) {
        float ti = z[i] + beta * t[i] + offset;
        t[i] = p[i] > 0.0 ? ti : 0.0F;
        z[i] = t[i];
    }
}

// 1 on I, 0 elsewhere
static void ones_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict p = &it->p[j * it->nx];
    float *restrict into = row;
    for (size_t i = 0; i < it->nx; i++) {
        into[i] = p[i] > 0.0 ? 1.0F : 0.0F;
    }
}

// |q| hardly sees the mean over I, which nothing holds under a given approach; without it contacts
// nearly complete converge badly. Its own step: sum of g / 1.S1, the two over I.
static double mean_step(iteration *it)
{
    if (it->held) {
        return 0.0;
    }
    lac_filter_fill(it->s->filter, LAC_SINGLE, ones_row, it);
    double compliance = lac_half_space_energy(it->s);
    lac_filter_fill(it->s->filter, LAC_SINGLE, gap_row, it);
    return compliance > 0.0 ? it->sum_g / compliance : 0.0;
}

// The search direction: |q| preconditioner and PR+; returns g.t
static double direction(iteration *it)
{
    double shift = mean_step(it);
    lac_half_space_unload(it->s);
    lac_filter_take(it->s->filter, overlap_row, it);
    sums all = total(it);
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
    lac_filter_refill(it->s->filter, direction_row, it);
    it->G_old = G;
    return G + it->beta * all.f;
}

// Step tau = g.t / t.St, and tau_ov = (g.t)^2 / (t.St g.g) for the cells that close
static void choose_step(iteration *it, double gt)
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

// p = max(0, p - tau t) in contact, -tau_ov g where the bodies overlap outside; sums: p, and g^2
// of the cells that close. The change of p goes into the transform.
static void step_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    double *restrict p = &it->p[j * it->nx];
    const float *restrict g = &it->g[j * it->nx];
    const float *restrict t = &it->t[j * it->nx];
    float *restrict into = row;
    double tau = it->tau;
    double tau_ov = it->tau_ov;
    double scale = it->scale;
    float g_mean = (float)it->g_mean;
    double sum = 0.0;
    double closing = 0.0;
    const size_t n = it->nx;
#pragma omp simd reduction(+ : sum, closing)
    for (size_t i = 0; i < n; i++) {
        double before = scale * p[i];
        float gap = g[i] - g_mean;
        double overlap = p[i] > 0.0 || gap > 0.0F ? 0.0 : (double)gap;
        double moved = before - tau * (double)t[i] - tau_ov * overlap;
        moved = moved > 0.0 ? moved : 0.0;
        into[i] = (float)(moved - before);
        p[i] = moved;
        sum += moved;
        closing += overlap * overlap;
    }
    it->rows[j] = (sums){.a = sum, .b = closing};
}

// Whether the error of g would show: in the residual, or in the stop test that is near.
static bool stale(const iteration *it, const lac_descent *d)
{
    return it->updates >= MOST_UPDATES || d->residual.complementarity < 30.0 * it->error ||
           d->residual.complementarity < 3.0 * d->tolerance;
}

static void step(iteration *it, const lac_descent *d)
{
    lac_filter_fill(it->s->filter, LAC_SINGLE, step_row, it);
    sums all = total(it);
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

static void iterate(iteration *it, lac_descent *d)
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
    size_t apart = n + APART;
    float *work = calloc(4 * apart, sizeof *work);
    sums *rows = malloc(s->ny * sizeof *rows);
    lac_status status = work != NULL && rows != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    for (size_t i = 0; i < n; i++) {
        work[i] = (float)d->heights[i];
    }
    iteration it = {.s = s,
                    .nx = s->nx,
                    .ny = s->ny,
                    .h = d->heights,
                    .h_short = work,
                    .p = pressure,
                    .gap = gap,
                    .g = &work[apart],
                    .dg = &work[2 * apart],
                    .t = &work[3 * apart],
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
