// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps under the pressures of a contact by a product in double precision: of free faces by parts,
// some wavenumbers along x after the other in the same memory.
#include "contact/solve_descent.h"

sums lac_descent_total(const iteration *it)
{
    const lac_strip *here = &it->s->rows;
    sums all = {0}, *rows = it->rows - here->first;
    if (here->team != NULL) {
        const size_t end = here->first + here->n;
        memset(rows, 0, here->first * sizeof *rows);
        memset(rows + end, 0, (here->all - end) * sizeof *rows);
        lac_team_join(here->team, &rows->a, here->all * sizeof *rows / sizeof rows->a);
    }
    for (size_t j = 0; j < here->all; j++) {
        add_sums(&all, rows[j]);
    }
    return all;
}

// p <- scale p, and into the transform (double).
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

// Takes a part of u (double) into half, in which g and t were, or adds it there.
static void half_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const double *restrict u = row;
    double *restrict sum = &it->half[j * it->nx];
    for (size_t i = 0; i < it->nx; i++) {
        sum[i] = (it->part > 0 ? sum[i] : 0.0) + u[i];
    }
}

// Adds the parts before to the last.
static void add_half(const iteration *it, size_t j, double *restrict u)
{
    for (size_t i = 0; it->half != NULL && i < it->nx; i++) {
        u[i] += it->half[j * it->nx + i];
    }
}

// Takes u (double); sums: cells of I, u - h over I, p.
static void level_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    add_half(it, j, row);
    const double *restrict u = row;
    const double *restrict p = &it->p[j * it->nx];
    const lac_heights h = it->h;
    const size_t n = it->nx, at = j * n;
    sums all = {0};
    // One after the other, as without blends of SSE 4; below with safelen, as many partial sums as
    // the least instruction set has lanes: the same bits whatever this is compiled for.
    for (size_t i = 0; i < n; i++) {
        all.a += p[i] > 0.0 ? 1.0 : 0.0;
        all.b += p[i] > 0.0 ? u[i] - lac_heights_at(h, at + i) : 0.0;
        all.c += p[i];
    }
    it->rows[j] = all;
}

// Takes u (double): g = u - h - level; and into gap.
static void fresh_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    add_half(it, j, row);
    const double *restrict u = row;
    const lac_heights h = it->h;
    const size_t at = j * it->nx;
    float *restrict g = gap_at(it, at);
    double level = it->level;
    if (it->dg != NULL) {
        float *restrict dg = &it->dg[at];
        const float keep = (float)it->keep, offset = (float)((1.0 - it->keep) * it->g_mean);
        for (size_t i = 0; i < it->nx; i++) {
            float gap = (float)(u[i] - lac_heights_at(h, at + i) - level);
            dg[i] = keep * dg[i] + (gap - g[i] + offset);
        }
    }
    for (size_t i = 0; i < it->nx; i++) {
        g[i] = (float)(u[i] - lac_heights_at(h, at + i) - level);
    }
    if (it->half != NULL) {
        memset(search_at(it, at), 0, it->nx * sizeof *it->t);
    }
    for (size_t i = 0; i < it->nx && it->gap != NULL; i++) {
        it->gap[at + i] = u[i] - lac_heights_at(h, at + i) - level;
    }
}

void lac_descent_refresh(iteration *it, bool same_step)
{
    lac_filter *filter = it->s->filter;
    const size_t last = lac_filter_parts(filter, LAC_DOUBLE) - 1;
    it->keep = same_step ? 1.0 : 0.0;
    for (it->part = 0; it->part <= last; it->part++) {
        lac_filter_fill(filter, LAC_DOUBLE, it->part, pressure_row, it);
        it->scale = 1.0; // p has it
        lac_half_space_displace(it->s);
        if (it->part < last) {
            lac_filter_take(filter, half_row, it);
        }
    }
    lac_filter_take(filter, level_row, it);
    sums all = lac_descent_total(it);
    it->cells = all.a;
    it->sum_p = all.c;
    it->level = it->held ? all.b / all.a : it->level;
    lac_filter_take(filter, fresh_row, it);
    it->g_mean = 0.0;
    it->G_old = it->half != NULL ? 0.0 : it->G_old; // t has gone
    it->error = 0.0;
    it->updates = 0;
}
