// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps under the pressures of a contact by a product in double precision: of free faces by halves,
// the even and the odd wavenumbers along x one after the other in the same memory.
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

// Takes the even wavenumbers' part of u (double) into half; g makes room, and what it was before
// the step under way goes in the place of dg.
static void half_row(void *context, size_t j, void *row)
{
    const iteration *it = context;
    const float *restrict g = gap_at(it, j * it->nx);
    float *restrict dg = &it->dg[j * it->nx];
    const float keep = (float)it->keep;
    for (size_t i = 0; i < it->nx; i++) {
        dg[i] = g[i] - keep * dg[i];
    }
    memcpy(&it->half[j * it->nx], row, it->nx * sizeof *it->half);
}

// Adds that part to the rest of u.
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
    float *restrict dg = &it->dg[j * it->nx];
    float keep = (float)it->keep;
    float offset = (float)((1.0 - it->keep) * it->g_mean);
    double level = it->level;
    for (size_t i = 0; i < it->nx; i++) {
        float gap = (float)(u[i] - lac_heights_at(h, at + i) - level);
        dg[i] = it->half != NULL ? gap - dg[i] + offset : keep * dg[i] + (gap - g[i] + offset);
        g[i] = gap;
    }
    for (size_t i = 0; i < it->nx && it->gap != NULL; i++) {
        it->gap[at + i] = u[i] - lac_heights_at(h, at + i) - level;
    }
}

void lac_descent_refresh(iteration *it, bool same_step)
{
    it->keep = same_step ? 1.0 : 0.0;
    if (it->half != NULL) {
        lac_filter_fill(it->s->filter, LAC_EVEN, pressure_row, it);
        lac_half_space_displace(it->s);
        lac_filter_take(it->s->filter, half_row, it);
        it->scale = 1.0; // p has it
        lac_filter_fill(it->s->filter, LAC_ODD, pressure_row, it);
    } else {
        lac_filter_fill(it->s->filter, LAC_DOUBLE, pressure_row, it);
    }
    lac_half_space_displace(it->s);
    lac_filter_take(it->s->filter, level_row, it);
    sums all = lac_descent_total(it);
    it->cells = all.a;
    it->sum_p = all.c;
    it->level = it->held ? all.b / all.a : it->level;
    lac_filter_take(it->s->filter, fresh_row, it);
    it->g_mean = 0.0;
    it->scale = 1.0;
    it->error = 0.0;
    it->updates = 0;
}
