// SPDX-License-Identifier: GPL-3.0-or-later
// What the contact solver does to single rows, on their way into or out of a transform.
#include <math.h>

#include "contact/solve_rows.h"

enum { PIECE = 512 }; // cells of a row whose sums are taken in single precision

// The sums of n cells of a row, from `at` of the grid on.
typedef lac_sums piece_sums(const lac_iteration *it, size_t n, size_t at, float *row);

static void sum_row(const lac_iteration *it, size_t j, float *row, piece_sums *of_piece)
{
    lac_sums all = {0};
    for (size_t i = 0; i < it->nx; i += PIECE) {
        size_t n = it->nx - i < PIECE ? it->nx - i : PIECE;
        lac_sums_add(&all, of_piece(it, n, j * it->nx + i, &row[i]));
    }
    it->rows[j] = all;
}

void lac_pressure_row(void *context, size_t j, void *row)
{
    const lac_iteration *it = context;
    double *restrict p = &it->p[j * it->nx];
    double *restrict into = row;
    double scale = it->scale;
    for (size_t i = 0; i < it->nx; i++) {
        p[i] *= scale;
        into[i] = p[i];
    }
}

void lac_level_row(void *context, size_t j, void *row)
{
    const lac_iteration *it = context;
    const double *restrict u = row;
    const double *restrict p = &it->p[j * it->nx];
    const double *restrict h = &it->h[j * it->nx];
    double cells = 0.0;
    double sum_g = 0.0;
    double sum_p = 0.0;
    const size_t n = it->nx;
    // One after the other, as without blends of SSE 4; below with safelen, as many partial sums as
    // the least instruction set has lanes: the same bits whatever this is compiled for.
    for (size_t i = 0; i < n; i++) {
        cells += p[i] > 0.0 ? 1.0 : 0.0;
        sum_g += p[i] > 0.0 ? u[i] - h[i] : 0.0;
        sum_p += p[i];
    }
    it->rows[j] = (lac_sums){.a = cells, .b = sum_g, .c = sum_p};
}

void lac_fresh_row(void *context, size_t j, void *row)
{
    const lac_iteration *it = context;
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

static lac_sums update_piece(const lac_iteration *it, size_t n, size_t at, float *restrict du)
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
#pragma omp simd safelen(4) reduction(+ : cells, sum_g, du2)
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
    return (lac_sums){.a = (double)cells, .b = (double)sum_g, .d = (double)du2};
}

void lac_update_row(void *context, size_t j, void *row) { sum_row(context, j, row, update_piece); }

static lac_sums gap_piece(const lac_iteration *it, size_t n, size_t at, float *restrict into)
{
    const double *restrict p = &it->p[at];
    const float *restrict g = &it->g[at];
    float g_mean = (float)it->g_mean;
    double pg = 0.0;
    float g2 = 0.0F;
    float sum_g = 0.0F;
#pragma omp simd safelen(4) reduction(+ : pg, g2, sum_g)
    for (size_t i = 0; i < n; i++) {
        float in = p[i] > 0.0 ? 1.0F : 0.0F;
        float gap = in * (g[i] - g_mean);
        into[i] = gap;
        pg += p[i] * (double)fabsf(gap);
        g2 += gap * gap;
        sum_g += gap;
    }
    return (lac_sums){.a = pg, .b = (double)g2, .c = (double)sum_g};
}

void lac_gap_row(void *context, size_t j, void *row) { sum_row(context, j, row, gap_piece); }

static lac_sums overlap_piece(const lac_iteration *it, size_t n, size_t at, float *restrict z)
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
#pragma omp simd safelen(4) reduction(+ : sz, zg, zd, sd, st, gt)
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
    return (lac_sums){(double)sz, (double)zg, (double)zd, (double)sd, (double)st, (double)gt};
}

void lac_overlap_row(void *context, size_t j, void *row)
{
    sum_row(context, j, row, overlap_piece);
}

void lac_direction_row(void *context, size_t j, void *row)
{
    const lac_iteration *it = context;
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

void lac_ones_row(void *context, size_t j, void *row)
{
    const lac_iteration *it = context;
    const double *restrict p = &it->p[j * it->nx];
    float *restrict into = row;
    for (size_t i = 0; i < it->nx; i++) {
        into[i] = p[i] > 0.0 ? 1.0F : 0.0F;
    }
}

static lac_sums step_piece(const lac_iteration *it, size_t n, size_t at, float *restrict into)
{
    double *restrict p = &it->p[at];
    const float *restrict g = &it->g[at];
    const float *restrict t = &it->t[at];
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
    return (lac_sums){.a = sum, .b = (double)closing};
}

void lac_step_row(void *context, size_t j, void *row) { sum_row(context, j, row, step_piece); }
