// SPDX-License-Identifier: GPL-3.0-or-later
// Pressures of a partial contact by conjugate gradients, most of it in single precision.
#include "contact/solve_descent.h"

// Minimises p.Sp/2 - h.p over p >= 0 with a given mean. The gradient S p - h, less its mean over
// the contact I = {p > 0}, is the gap g. docs/theory/contact.md, "Solver".
//
// p is kept in double precision; the gap, whose relative error is what counts, the directions and
// the changes of the gap in single. The gap is brought up to date by single-precision products of
// the changes of p, and computed anew in double precision before the errors of that show.
//
// Free faces are half of their transform's sides, and done with least memory: products by parts of
// the wavenumbers, the step in the place of the direction, no change of the gap.
//
// Each stage is one sweep over rows that are on their way into or out of a transform; sums are
// kept row by row and added in order, so that they do not depend on threads.

enum { MOST_UPDATES = 64 };
enum { PIECE = 512 }; // cells of a row whose sums are taken in single precision

// What the error of a single-precision product is at most, of its rms.
static const double single_error = 2e-7;

// Sweeps: what is done to one row each, on its way into or out of a transform. Those of pieces
// write the sums they name, a, b ... in order.

static void sum_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    sums all = {0};
    for (size_t i = 0; i < it->nx; i += PIECE) {
        size_t n = it->nx - i < PIECE ? it->nx - i : PIECE;
        add_sums(&all, it->piece(it, n, j * it->nx + i, (float *)row + i));
    }
    it->rows[j] = all;
}

// Takes S d, d the change of p, or its first part: g <- g + S d + (scale - 1) (u + S d); sums:
// cells of I, g over I, -, square of S d.
static sums update_piece(const iteration *it, size_t n, size_t at, float *restrict du)
{
    const double *restrict p = &it->p[at];
    const lac_heights h = it->h;
    float *restrict g = gap_at(it, at);
    float *dg = it->dg != NULL ? &it->dg[at] : du;
    float g_mean = (float)it->g_mean;
    float level = (float)it->level;
    float more = (float)(it->scale - 1.0);
    float cells = 0.0F, sum_g = 0.0F, du2 = 0.0F;
#pragma omp simd safelen(4) reduction(+ : cells, sum_g, du2)
    for (size_t i = 0; i < n; i++) {
        float gap = g[i] - g_mean;
        float height = (float)lac_heights_at(h, at + i);
        float change = du[i] + more * (du[i] + (gap + (height + level)));
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        g[i] = gap + change;
        cells += in;
        sum_g += in * (gap + change);
        du2 += du[i] * du[i];
        dg[i] = change;
    }
    return (sums){.a = (double)cells, .b = (double)sum_g, .d = (double)du2};
}

// Takes a further part of S d: g <- g + scale S d; the same sums.
static sums further_piece(const iteration *it, size_t n, size_t at, float *restrict du)
{
    const double *restrict p = &it->p[at];
    float *restrict g = gap_at(it, at);
    float scale = (float)it->scale;
    float cells = 0.0F, sum_g = 0.0F, du2 = 0.0F;
#pragma omp simd safelen(4) reduction(+ : cells, sum_g, du2)
    for (size_t i = 0; i < n; i++) {
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        g[i] += scale * du[i];
        cells += in;
        sum_g += in * g[i];
        du2 += du[i] * du[i];
    }
    return (sums){.a = (double)cells, .b = (double)sum_g, .d = (double)du2};
}

// The gap of the contact into the transform; sums: p |g|, g^2, g over I.
static sums gap_piece(const iteration *it, size_t n, size_t at, float *restrict into)
{
    const double *restrict p = &it->p[at];
    const float *restrict g = gap_at(it, at);
    float g_mean = (float)it->g_mean;
    double pg = 0.0;
    float g2 = 0.0F, sum_g = 0.0F;
#pragma omp simd safelen(4) reduction(+ : pg, g2, sum_g)
    for (size_t i = 0; i < n; i++) {
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        float gap = in * (g[i] - g_mean);
        into[i] = gap;
        pg += p[i] * (double)fabsf(gap);
        g2 += gap * gap;
        sum_g += gap;
    }
    return (sums){.a = pg, .b = (double)g2, .c = (double)sum_g};
}

// Takes z, which it keeps in the place of dg; sums over I: z, z.g, z.dg, dg, t, g.t.
static sums overlap_piece(const iteration *it, size_t n, size_t at, float *restrict z)
{
    const double *restrict p = &it->p[at];
    const float *restrict g = gap_at(it, at);
    float *restrict dg = &it->dg[at];
    const float *restrict t = search_at(it, at);
    float g_mean = (float)it->g_mean;
    float sz = 0.0F, zg = 0.0F, zd = 0.0F, sd = 0.0F;
    float st = 0.0F, gt = 0.0F;
#pragma omp simd safelen(4) reduction(+ : sz, zg, zd, sd, st, gt)
    for (size_t i = 0; i < n; i++) {
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        float zi = in * z[i], ti = in * t[i], gi = g[i] - g_mean;
        float di = dg[i] - g_mean;
        sz += zi;
        zg += zi * gi;
        zd += zi * di;
        sd += in * di;
        st += ti;
        gt += ti * gi;
        dg[i] = z[i];
    }
    return (sums){(double)sz, (double)zg, (double)zd, (double)sd, (double)st, (double)gt};
}

// gap_piece, and the sum of g.t over I.
static sums slope_piece(const iteration *it, size_t n, size_t at, float *restrict into)
{
    sums all = gap_piece(it, n, at, into);
    const float *restrict t = search_at(it, at);
    float gt = 0.0F;
#pragma omp simd safelen(4) reduction(+ : gt)
    for (size_t i = 0; i < n; i++) {
        gt += into[i] * t[i];
    }
    all.f = (double)gt;
    return all;
}

// t = z - z_mean + beta (t - t_mean) on I, 0 elsewhere, also into the transform.
static void direction_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict p = &it->p[j * it->nx];
    const float *restrict z = &it->dg[j * it->nx];
    float *restrict t = search_at(it, j * it->nx);
    float *restrict into = row;
    float beta = (float)it->beta;
    float offset = (float)(-it->z_mean - it->beta * it->t_mean);
    for (size_t i = 0; i < it->nx; i++) {
        float ti = z[i] + beta * t[i] + offset;
        t[i] = p[i] > 0.0 ? ti : 0.0F;
        into[i] = t[i];
    }
}

// The same of free faces, in whose t all but the mean is already.
static void level_search_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict p = &it->p[j * it->nx];
    float *restrict t = search_at(it, j * it->nx);
    float *restrict into = row;
    float z_mean = (float)it->z_mean;
    for (size_t i = 0; i < it->nx; i++) {
        t[i] = p[i] > 0.0 ? t[i] - z_mean : 0.0F;
        into[i] = t[i];
    }
}

// t into the transform
static void search_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    memcpy(row, search_at(it, j * it->nx), it->nx * sizeof *it->t);
}

// Takes the first part of z: t = z + beta t.
static void search_first_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const float *restrict z = row;
    float *restrict t = search_at(it, j * it->nx);
    const float keep = (float)(it->beta * it->turn);
    for (size_t i = 0; i < it->nx; i++) {
        t[i] = z[i] + keep * t[i];
    }
}

// Takes the other part of z, which it adds to t; sums: t over I.
static sums search_piece(const iteration *it, size_t n, size_t at, float *restrict z)
{
    const double *restrict p = &it->p[at];
    float *restrict t = search_at(it, at);
    float st = 0.0F;
#pragma omp simd safelen(4) reduction(+ : st)
    for (size_t i = 0; i < n; i++) {
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        t[i] += z[i];
        st += in * t[i];
    }
    return (sums){.a = (double)st};
}

// 1 on I, 0 elsewhere, into the transform.
static void ones_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict p = &it->p[j * it->nx];
    float *restrict into = row;
    for (size_t i = 0; i < it->nx; i++) {
        into[i] = p[i] > 0.0 ? 1.0F : 0.0F;
    }
}

// p = max(0, p - tau t) on I, -tau_ov g where the bodies overlap outside; the change of p into the
// transform, of free faces also into t; sums: p, and g^2 of the cells that close.
static sums step_piece(const iteration *it, size_t n, size_t at, float *restrict into)
{
    double *restrict p = &it->p[at];
    const float *restrict g = gap_at(it, at);
    float *restrict t = search_at(it, at);
    float tau = (float)it->tau;
    float tau_ov = (float)it->tau_ov;
    double scale = it->scale;
    float g_mean = (float)it->g_mean;
    double sum = 0.0;
    float closing = 0.0F;
#pragma omp simd safelen(4) reduction(+ : sum, closing)
    for (size_t i = 0; i < n; i++) {
        float out = p[i] > 0.0 ? 0.0F : 1.0F;
        float gap = g[i] - g_mean;
        float overlap = out * (gap < 0.0F ? gap : 0.0F);
        double before = scale * p[i];
        double moved = before - (double)(tau * t[i] + tau_ov * overlap);
        moved = moved > 0.0 ? moved : 0.0;
        into[i] = (float)(moved - before);
        p[i] = moved;
        sum += moved;
        closing += overlap * overlap;
    }
    if (it->dg == NULL) {
        memcpy(t, into, n * sizeof *t);
    }
    return (sums){.a = sum, .b = (double)closing};
}

// A sweep of rows into a part of the transform, in single precision, or out of it, by pieces.
static sums fill(iteration *it, size_t part, piece_sums *piece)
{
    it->piece = piece;
    lac_filter_fill(it->s->filter, LAC_SINGLE, part, sum_row, it);
    return lac_descent_total(it);
}

static sums take(iteration *it, piece_sums *piece)
{
    it->piece = piece;
    lac_filter_take(it->s->filter, sum_row, it);
    return lac_descent_total(it);
}

bool lac_residual_holds(const lac_residual *r, double tolerance)
{
    return r->complementarity < tolerance && r->penetration < tolerance && r->load < tolerance;
}

// The gap from the change of p in the transform, in single precision.
static void update(iteration *it)
{
    lac_half_space_displace(it->s);
    sums all = take(it, update_piece);
    double du2 = all.d;
    for (size_t part = 1; part < it->parts; part++) {
        lac_filter_fill(it->s->filter, LAC_SINGLE, part, search_row, it);
        lac_half_space_displace(it->s);
        all = take(it, further_piece);
        du2 += all.d;
    }
    it->cells = all.a;
    it->level += it->g_mean; // which update_piece took off
    it->g_mean = it->held ? all.b / all.a : 0.0;
    it->error += single_error * sqrt(du2 / ((double)it->nx * (double)it->s->ny));
    it->updates++;
}

// x.S x of the rows x; of a further part of the transform by another function.
static double energy(iteration *it, lac_filter_row row, lac_filter_row again)
{
    double sum = 0.0;
    for (size_t part = 0; part < it->parts; part++) {
        lac_filter_fill(it->s->filter, LAC_SINGLE, part, part > 0 ? again : row, it);
        sum += lac_half_space_energy(it->s);
    }
    return sum;
}

// How far from the solution p is, by the g at hand; leaves the gap in the transform.
static void measure(iteration *it, lac_descent *d)
{
    sums all = fill(it, 0, it->dg != NULL ? gap_piece : slope_piece);
    double n = (double)it->nx * (double)it->s->ny;
    it->g2 = all.b;
    it->gt = it->turn * all.f;
    it->sum_g = all.c;
    d->closest = -it->level;
    d->residual.complementarity = it->sum_p > 0.0 ? it->scale * all.a / it->sum_p : 0.0;
    d->residual.load = it->held ? fabs(it->sum_p / n / d->mean_pressure - 1.0) : 0.0;
}

// Deepest negative gap where p = 0.
static double penetration(const iteration *it)
{
    double least = 0.0;
    for (size_t j = 0; j < it->ny; j++) {
        const double *p = &it->p[j * it->nx];
        const float *g = gap_at(it, j * it->nx);
        for (size_t i = 0; i < it->nx; i++) {
            double gap = p[i] > 0.0 ? 0.0 : (double)g[i] - it->g_mean;
            least = gap < least ? gap : least;
        }
    }
    return lac_team_most(it->s->rows.team, -least);
}

// Whether all but the penetration, which is still that of another p, is within the tolerance.
static bool balanced(const lac_descent *d)
{
    return d->residual.complementarity < d->tolerance && d->residual.load < d->tolerance;
}

// Whether the solution is reached, which only a fresh product tells. The penetration costs a
// sweep: only where the rest holds.
static bool settled(iteration *it, lac_descent *d)
{
    if (balanced(d) && it->updates > 0) {
        lac_descent_refresh(it, true);
        measure(it, d);
    }
    d->residual.penetration = balanced(d) ? penetration(it) : INFINITY;
    return d->residual.penetration < d->tolerance;
}

// |q| hardly sees the mean over I, which nothing holds under a given approach; without it contacts
// nearly complete converge badly. Its own step: sum of g / 1.S1, the two over I.
static double mean_step(iteration *it)
{
    if (it->held) {
        return 0.0;
    }
    double compliance = energy(it, ones_row, ones_row);
    (void)fill(it, 0, gap_piece);
    return compliance > 0.0 ? it->sum_g / compliance : 0.0;
}

// beta of G = z.g, of its change to the step before, and of g.t of that; returns g.t of the new.
static double conjugate(iteration *it, double G, double change, double gt)
{
    it->beta = it->G_old > 0.0 ? fmax(0.0, change / it->G_old) : 0.0;
    // beta > 2 or a direction that does not descend: start afresh
    if (!(it->beta <= 2.0) || !(G + it->beta * gt > 0.0)) {
        it->beta = 0.0;
    }
    it->G_old = G;
    return G + it->beta * gt;
}

// The search direction of free faces. There is no room for z, which is added to beta t part by
// part: for beta the even wavenumbers have half of G, the odd ones in between the other. z.g_old of
// PR+ is z_old.g; taken for it is g.t, which would be 0 if I had not changed: where t has what it
// should not, either way, less of it is kept.
static double free_direction(iteration *it)
{
    double shift = mean_step(it), constant = shift * it->sum_g;
    double even, odd;
    lac_half_space_unload(it->s, &even);
    double about = 2.0 * even + constant;
    (void)conjugate(it, about, about - fabs(it->gt), it->gt);
    lac_filter_take(it->s->filter, search_first_row, it);
    (void)fill(it, 1, gap_piece);
    lac_half_space_unload(it->s, &odd);
    double mean = take(it, search_piece).a / it->cells;
    it->z_mean = it->held ? mean : -shift;
    it->tst = energy(it, level_search_row, search_row);
    it->G_old = even + odd + constant;
    return it->G_old + it->beta * it->gt;
}

// The search direction: |q| preconditioner and PR+; returns g.t
static double direction(iteration *it)
{
    if (it->dg == NULL) {
        return free_direction(it);
    }
    double shift = mean_step(it);
    lac_half_space_unload(it->s, NULL);
    sums all = take(it, overlap_piece);
    it->z_mean = it->held ? all.a / it->cells : -shift;
    it->t_mean = it->held ? all.e / it->cells : 0.0;
    double G = all.b + shift * it->sum_g;
    double gt = conjugate(it, G, all.c - it->z_mean * all.d, all.f);
    it->tst = energy(it, direction_row, NULL);
    return gt;
}

// Step tau = g.t / t.St, and tau_ov = (g.t)^2 / (t.St g.g) for the cells that close
static void choose_step(iteration *it, double gt)
{
    it->tau = gt / it->tst;
    it->tau_ov = it->tau * gt / it->g2;
    if (!(gt > 0.0 && it->tst > 0.0 && it->g2 > 0.0 && isfinite(it->tau) && isfinite(it->tau_ov))) {
        // The pressures in contact are in balance: only cells outside can still move.
        it->tau = 0.0;
        it->tau_ov = 1.0 / it->s->self;
    }
}

// Whether the error of g would show: in the residual, or in the stop test that is near.
static bool stale(const iteration *it, const lac_descent *d)
{
    return it->updates >= MOST_UPDATES || d->residual.complementarity < 30.0 * it->error ||
           d->residual.complementarity < 3.0 * d->tolerance;
}

static void step(iteration *it, const lac_descent *d)
{
    sums all = fill(it, 0, step_piece);
    if (it->dg == NULL) {
        it->turn = it->tau > 0.0 ? -1.0 / it->tau : 0.0;
    }
    it->scale = it->held ? d->mean_pressure * (double)it->nx * (double)it->s->ny / all.a : 1.0;
    it->sum_p = it->scale * all.a;
    // New cells change the problem: the directions so far are conjugate no more.
    if (all.b > 0.01 * it->g2) {
        it->G_old = 0.0;
    }
    if (stale(it, d)) {
        lac_descent_refresh(it, false);
    } else {
        update(it);
    }
}

static void iterate(iteration *it, lac_descent *d)
{
    lac_descent_refresh(it, false);
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
        lac_descent_refresh(it, true);
        measure(it, d);
    }
    d->residual.penetration = penetration(it);
}

lac_status lac_descend(lac_half_space *s, lac_descent *d, double *pressure, double *gap,
                       lac_error *err)
{
    size_t n = s->nx * s->rows.n;
    const size_t parts = lac_filter_parts(s->filter, LAC_SINGLE);
    const bool few = parts > 1; // g and t share the rows of `half`
    float *work = lac_team_alloc(s->rows.team, ((few ? 2 : 3) * n + s->nx) * sizeof *work);
    sums *rows = lac_team_alloc(s->rows.team, s->ny * sizeof *rows);
    lac_status status;
    LAC_TRY(work != NULL && rows != NULL ? LAC_OK : lac_fail_memory(err));
    iteration it = {.s = s,
                    .nx = s->nx,
                    .ny = s->rows.n,
                    .h = d->heights,
                    .p = pressure,
                    .gap = gap,
                    .half = few ? (double *)work : NULL,
                    .g = work,
                    .dg = few ? NULL : &work[n],
                    .t = &work[few ? s->nx : 2 * n],
                    .parts = parts,
                    .rows = rows + s->rows.first,
                    .turn = 1.0,
                    .scale = 1.0,
                    .level = -d->approach,
                    .held = d->control == LAC_CONTROL_LOAD};
    iterate(&it, d);
out:
    free(work);
    free(rows);
    return status;
}
