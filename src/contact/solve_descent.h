/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// What the iterations of solve_descent.c and their fresh products in solve_fresh.c share.
#include "contact/solve.h"

typedef struct sums {
    double a, b, c, d, e, f;
} sums;

static inline void add_sums(sums *all, sums more)
{
    all->a += more.a;
    all->b += more.b;
    all->c += more.c;
    all->d += more.d;
    all->e += more.e;
    all->f += more.f;
}

typedef struct iteration iteration;

// The sums of n cells of a row, from `at` of the grid on.
typedef sums piece_sums(const iteration *it, size_t n, size_t at, float *row);

// State of the iterations. I are the cells in contact, p > 0.
struct iteration {
    lac_half_space *s;
    size_t nx, ny; // cells along x; rows here
    lac_heights h;
    double *p;           // [ny * nx] pressure over scale
    double *gap;         // [ny * nx] of the last fresh product; or NULL
    double *half;        // free: [ny * nx] sum of the parts of a fresh displacement; else NULL
    float *g;            // gap plus g_mean: see gap_at
    float *dg;           // [ny * nx] last change of the gap plus g_mean, on I; then z; free: NULL
    float *t;            // search direction; see turn
    size_t parts;        // of a product in single precision
    size_t part;         // of the one in double precision under way
    piece_sums *piece;   // of the sweep under way
    sums *rows;          // [ny], among those of all ranks
    double level;        // gap = S p - h - level
    double g_mean;       // of g over I
    double cells;        // in I
    double sum_p;        // over all cells
    double sum_g, g2;    // sums over I of the gap and its square
    double G_old;        // z.g of the step before; 0 to start afresh
    double z_mean, beta; // of the direction
    double t_mean;       // over I, of the direction before
    double turn;         // 1, or what makes the direction of the step that t holds in its place
    double gt;           // free: sum over I of the gap times the direction before
    double tst;          // t.St
    double tau, tau_ov;  // step along t; step of the cells that open or close
    double scale;        // brings p back to the load
    double keep;         // 1 where a fresh product goes with the same step, 0 with a new one
    double error;        // of g, about, from updates since the last fresh product
    int updates;         // since then
    bool held;           // the load is given: directions keep it, and the gap has mean 0 over I
};

// Where g and t of a cell are. Of free faces they share the rows of `half`, which is needed only
// while a fresh product is made, and t holds the step once that is known.
static inline size_t place(const iteration *it, size_t cell)
{
    return cell + (it->half != NULL ? cell / it->nx * it->nx : 0);
}

static inline float *gap_at(const iteration *it, size_t cell) { return &it->g[place(it, cell)]; }

static inline float *search_at(const iteration *it, size_t cell) { return &it->t[place(it, cell)]; }

/// The sums of all rows, in order.
sums lac_descent_total(const iteration *it);

/// The gap from a product in double precision.
/// @param same_step  whether p is still that of the last update
void lac_descent_refresh(iteration *it, bool same_step);
