/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>

#include "contact/solve.h"

// The sweeps of the conjugate gradients over one row each, on its way into or out of a transform:
// lac_filter_row whose context is a lac_iteration. Each writes the sums it names, a, b ... in
// order, where the row has its place.

typedef struct lac_sums {
    double a, b, c, d, e, f;
} lac_sums;

static inline void lac_sums_add(lac_sums *all, lac_sums more)
{
    all->a += more.a;
    all->b += more.b;
    all->c += more.c;
    all->d += more.d;
    all->e += more.e;
    all->f += more.f;
}

// State of the iterations. I are the cells in contact, p > 0.

typedef struct lac_iteration {
    lac_half_space *s;
    size_t nx, ny;
    const double *h;      // [ny * nx]
    const float *h_short; // [ny * nx] the same
    double *p;            // [ny * nx] pressure over scale
    double *gap;          // [ny * nx] of the last fresh product; or NULL
    float *g;             // [ny * nx] gap plus g_mean
    float *dg;            // [ny * nx] last change of the gap plus g_mean, on I
    float *t;             // [ny * nx] search direction, 0 outside I
    lac_sums *rows;       // [ny]
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
} lac_iteration;

/// p <- scale p, and into the transform (double).
void lac_pressure_row(void *context, size_t j, void *row);

/// Takes u (double); sums: cells of I, u - h over I, p.
void lac_level_row(void *context, size_t j, void *row);

/// Takes u (double): g = u - h - level; and into gap.
void lac_fresh_row(void *context, size_t j, void *row);

/// Takes S d, d the change of p: g <- g + S d + (scale - 1) (u + S d); sums: cells of I, g over I,
/// -, square of S d.
void lac_update_row(void *context, size_t j, void *row);

/// The gap of the contact into the transform; sums: p |g|, g^2, g over I.
void lac_gap_row(void *context, size_t j, void *row);

/// Takes z; sums over I: z, z.g, z.dg, dg, t, g.t.
void lac_overlap_row(void *context, size_t j, void *row);

/// t = z - z_mean + beta (t - t_mean) on I, 0 elsewhere, also into the transform in place of z.
void lac_direction_row(void *context, size_t j, void *row);

/// 1 on I, 0 elsewhere, into the transform.
void lac_ones_row(void *context, size_t j, void *row);

/// p = max(0, p - tau t) on I, -tau_ov g where the bodies overlap outside; the change of p into the
/// transform; sums: p, and g^2 of the cells that close.
void lac_step_row(void *context, size_t j, void *row);
