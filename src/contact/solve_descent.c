// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "contact/solve.h"

// Minimises p.Sp/2 - h.p over p >= 0 with a given mean. The gradient g = S p - h, less its mean
// over the contact I = {p > 0}, is the gap. docs/theory/contact.md, "Solver".
//
// Each stage is one sweep over rows; sums are taken row by row, which keeps their rounding small.

typedef struct iteration {
    lac_half_space *s;
    size_t nx, ny;
    const double *h;    // [ny * nx]
    double *p;          // [ny * nx]
    double *g, *g_old;  // [ny * nx] gradient before its mean is taken off
    double *t;          // [ny * nx] search direction, 0 outside I
    double g_mean;      // over I
    double g_old_mean;  // over the I of then
    double cells;       // in I
    double g2;          // sum over I of the gap squared
    double G_old;       // z.g of the step before; 0 to start afresh
    double tau, tau_ov; // step along t; step of the cells that open or close
    double scale;       // brings p back to the load, not yet applied
    bool held;          // the load is given: directions keep it, and the gap has mean 0 over I
} iteration;

bool lac_residual_holds(const lac_residual *r, double tolerance)
{
    return r->complementarity < tolerance && r->penetration < tolerance && r->load < tolerance;
}

typedef struct sums {
    double a, b, c, d, e, f;
} sums;

static void add(sums *total, sums row)
{
    total->a += row.a;
    total->b += row.b;
    total->c += row.c;
    total->d += row.d;
    total->e += row.e;
    total->f += row.f;
}

// p <- scale p, g = scale u - h; sums: cells of I, sum of g over I, sum of p
static sums gradient_row(size_t n, double scale, double *restrict p, const double *restrict u,
                         const double *restrict h, double *restrict g)
{
    double cells = 0.0;
    double sum_g = 0.0;
    double sum_p = 0.0;
#pragma omp simd reduction(+ : cells, sum_g, sum_p)
    for (size_t i = 0; i < n; i++) {
        p[i] *= scale;
        g[i] = scale * u[i] - h[i];
        cells += p[i] > 0.0 ? 1.0 : 0.0;
        sum_g += p[i] > 0.0 ? g[i] : 0.0;
        sum_p += p[i];
    }
    return (sums){.a = cells, .b = sum_g, .c = sum_p};
}

// g = S p - h on a fresh product, from the p in the transform; returns the sum of p
static double gradient(iteration *it)
{
    size_t n = it->nx;
    size_t stride = it->s->fft->nx;
    double *real = it->s->fft->real;
    double *swap = it->g_old;
    it->g_old = it->g;
    it->g_old_mean = it->g_mean;
    it->g = swap;
    lac_half_space_displace(it->s);
    sums total = {0};
    for (size_t j = 0; j < it->ny; j++) {
        size_t r = j * n;
        add(&total, gradient_row(n, it->scale, &it->p[r], &real[j * stride], &it->h[r], &it->g[r]));
    }
    it->cells = total.a;
    if (it->held) {
        it->g_mean = total.b / total.a;
    }
    return total.c;
}

// The gap of the contact goes into the transform; sums: p |g|, g^2 over I
static sums residual_row(size_t n, double g_mean, const double *restrict p,
                         const double *restrict g, double *restrict real)
{
    double pg = 0.0;
    double g2 = 0.0;
#pragma omp simd reduction(+ : pg, g2)
    for (size_t i = 0; i < n; i++) {
        double gap = g[i] - g_mean;
        double inside = p[i] > 0.0 ? gap : 0.0;
        real[i] = inside;
        pg += p[i] * fabs(inside);
        g2 += inside * inside;
    }
    return (sums){.a = pg, .b = g2};
}

static void residual(iteration *it, double sum_p, lac_descent *d)
{
    size_t n = it->nx;
    size_t stride = it->s->fft->nx;
    double *real = it->s->fft->real;
    sums total = {0};
    for (size_t j = 0; j < it->ny; j++) {
        size_t r = j * n;
        add(&total, residual_row(n, it->g_mean, &it->p[r], &it->g[r], &real[j * stride]));
    }
    double n_all = (double)n * (double)it->ny;
    it->g2 = total.b;
    d->closest = -it->g_mean;
    d->residual.complementarity = sum_p > 0.0 ? total.a / sum_p : 0.0;
    d->residual.load = it->held ? fabs(sum_p / n_all / d->mean_pressure - 1.0) : 0.0;
}

// Deepest negative gap where p = 0.
static double penetration(const iteration *it)
{
    double least = 0.0;
    for (size_t i = 0; i < it->nx * it->ny; i++) {
        double gap = it->p[i] > 0.0 ? 0.0 : it->g[i] - it->g_mean;
        least = gap < least ? gap : least;
    }
    return -least;
}

// Whether the solution is reached. The penetration costs a sweep: only where the rest holds.
static bool settled(const iteration *it, lac_descent *d)
{
    if (d->residual.complementarity < d->tolerance && d->residual.load < d->tolerance) {
        d->residual.penetration = penetration(it);
        return d->residual.penetration < d->tolerance;
    }
    return false;
}

// Sums over I: z, z.g, z.g_old, g_old, t, g.t
static sums overlap_row(const iteration *it, size_t r, const double *restrict z)
{
    const double *restrict p = &it->p[r];
    const double *restrict g = &it->g[r];
    const double *restrict g_old = &it->g_old[r];
    const double *restrict t = &it->t[r];
    const size_t n = it->nx;
    double gm = it->g_mean;
    double gom = it->g_old_mean;
    double sz = 0.0;
    double zg = 0.0;
    double zo = 0.0;
    double so = 0.0;
    double st = 0.0;
    double gt = 0.0;
#pragma omp simd reduction(+ : sz, zg, zo, so, st, gt)
    for (size_t i = 0; i < n; i++) {
        double in = p[i] > 0.0 ? 1.0 : 0.0;
        double zi = in * z[i];
        double ti = in * t[i];
        double gi = g[i] - gm;
        double go = in * (g_old[i] - gom);
        sz += zi;
        zg += zi * gi;
        zo += zi * go;
        so += go;
        st += ti;
        gt += ti * gi;
    }
    return (sums){.a = sz, .b = zg, .c = zo, .d = so, .e = st, .f = gt};
}

// t = z - z_mean + beta (t - t_mean) on I, 0 elsewhere, also into the transform
static void direction_row(size_t n, double z_mean, double beta, double t_mean,
                          const double *restrict p, double *restrict t, double *restrict z)
{
    for (size_t i = 0; i < n; i++) {
        double ti = z[i] - z_mean + beta * (t[i] - t_mean);
        t[i] = p[i] > 0.0 ? ti : 0.0;
        z[i] = t[i];
    }
}

// 1 on I, 0 elsewhere, or the gap there into the transform; returns the sum of the gap over I
static double fill_contact(const iteration *it, bool ones)
{
    const lac_fft *fft = it->s->fft;
    double total = 0.0;
    for (size_t j = 0; j < it->ny; j++) {
        double sum = 0.0;
        for (size_t i = 0; i < it->nx; i++) {
            size_t cell = j * it->nx + i;
            double gap = it->p[cell] > 0.0 ? it->g[cell] - it->g_mean : 0.0;
            fft->real[j * fft->nx + i] = ones && it->p[cell] > 0.0 ? 1.0 : ones ? 0.0 : gap;
            sum += gap;
        }
        total += sum;
    }
    return total;
}

// |q| hardly sees the mean over I, which nothing holds under a given approach; without it contacts
// nearly complete converge badly. Its own step: sum of g / 1.S1, the two over I.
static double mean_step(iteration *it, double *sum_g)
{
    *sum_g = 0.0;
    if (it->held) {
        return 0.0;
    }
    (void)fill_contact(it, true);
    double compliance = lac_half_space_energy(it->s);
    *sum_g = fill_contact(it, false);
    return compliance > 0.0 ? *sum_g / compliance : 0.0;
}

// The search direction: |q| preconditioner and PR+; returns g.t
static double direction(iteration *it)
{
    size_t n = it->nx;
    size_t stride = it->s->fft->nx;
    double *real = it->s->fft->real;
    double sum_g;
    double shift = mean_step(it, &sum_g);
    lac_half_space_unload(it->s);
    sums total = {0};
    for (size_t j = 0; j < it->ny; j++) {
        add(&total, overlap_row(it, j * n, &real[j * stride]));
    }
    double z_mean = it->held ? total.a / it->cells : -shift;
    double t_mean = it->held ? total.e / it->cells : 0.0;
    double G = total.b + shift * sum_g;
    double beta = 0.0;
    if (it->G_old > 0.0) {
        beta = fmax(0.0, (G - (total.c - z_mean * total.d)) / it->G_old);
    }
    // beta > 2 or a direction that does not descend: start afresh
    if (!(beta <= 2.0) || !(G + beta * total.f > 0.0)) {
        beta = 0.0;
    }
    for (size_t j = 0; j < it->ny; j++) {
        size_t r = j * n;
        direction_row(n, z_mean, beta, t_mean, &it->p[r], &it->t[r], &real[j * stride]);
    }
    it->G_old = G;
    return G + beta * total.f;
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
// of the cells that close. The new p goes into the transform, too.
static sums step_row(const iteration *it, size_t r, double *restrict real)
{
    double *restrict p = &it->p[r];
    const double *restrict g = &it->g[r];
    const double *restrict t = &it->t[r];
    const size_t n = it->nx;
    double tau = it->tau;
    double tau_ov = it->tau_ov;
    double g_mean = it->g_mean;
    double sum = 0.0;
    double closing = 0.0;
#pragma omp simd reduction(+ : sum, closing)
    for (size_t i = 0; i < n; i++) {
        double gap = g[i] - g_mean;
        double outside = p[i] > 0.0 ? 0.0 : gap;
        double overlap = outside < 0.0 ? outside : 0.0;
        double moved = p[i] - tau * t[i] - tau_ov * overlap;
        moved = moved > 0.0 ? moved : 0.0;
        p[i] = moved;
        real[i] = moved;
        sum += moved;
        closing += overlap * overlap;
    }
    return (sums){.a = sum, .b = closing};
}

static void step(iteration *it, double mean_pressure)
{
    const lac_fft *fft = it->s->fft;
    sums total = {0};
    for (size_t j = 0; j < it->ny; j++) {
        add(&total, step_row(it, j * it->nx, &fft->real[j * fft->nx]));
    }
    if (it->held) {
        it->scale = mean_pressure * (double)it->nx * (double)it->ny / total.a;
    }
    // New cells change the problem: the directions so far are conjugate no more.
    if (total.b > 0.01 * it->g2) {
        it->G_old = 0.0;
    }
}

static void give_gap(const iteration *it, double *gap)
{
    size_t n = it->nx * it->ny;
    for (size_t i = 0; i < n; i++) {
        gap[i] = it->g[i] - it->g_mean;
    }
}

lac_status lac_descend(lac_half_space *s, lac_descent *d, double *pressure, double *gap,
                       lac_error *err)
{
    size_t n = s->nx * s->ny;
    double *g = calloc(n, sizeof *g);
    double *t = calloc(n, sizeof *t);
    lac_status status = LAC_OK;
    if (g == NULL || t == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    memset(gap, 0, n * sizeof *gap);
    iteration it = {.s = s,
                    .nx = s->nx,
                    .ny = s->ny,
                    .h = d->heights,
                    .p = pressure,
                    .g = gap,
                    .g_old = g,
                    .t = t,
                    .scale = 1.0,
                    .g_mean = -d->approach,
                    .g_old_mean = -d->approach,
                    .held = d->control == LAC_CONTROL_LOAD};
    for (size_t j = 0; j < s->ny; j++) {
        memcpy(&s->fft->real[j * s->fft->nx], &pressure[j * s->nx], s->nx * sizeof *pressure);
    }
    residual(&it, gradient(&it), d);
    d->iterations = 0;
    d->products = 1;
    while (!settled(&it, d) && d->iterations < d->max_iterations) {
        choose_step(&it, direction(&it));
        step(&it, d->mean_pressure);
        residual(&it, gradient(&it), d);
        d->iterations++;
        d->products += it.held ? 2 : 3;
    }
    d->residual.penetration = penetration(&it);
    give_gap(&it, gap);
out:
    free(g);
    free(t);
    return status;
}
