/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_MODEL_INTERNAL_H
#define LACUNA_MODEL_INTERNAL_H

#include "lacuna/problem.h"

struct lac_problem {
    size_t n;
    const double *pressure; // [n] total normal pressure of each cell [Pa]
    const lac_friction *friction;
    lac_transfer transfer;
    lac_load_set loads;
    double damping;       // eta [Pa s/m]
    double cell_area;     // r^2 [m2]
    double nominal_area;  // L^2 [m2]
    double mean_pressure; // P/L^2 [Pa]
    double sum_pressure;  // sum of p_i [Pa]
    double spring_share;  // L^2/(n r^2): nominal stress of a spring -> traction of a cell
    double sum_traction0; // sum of the tractions at t = 0 [Pa]
    lac_load_state at_start;
    double *traction0;              // [n] q_i at t = 0 [Pa]
    double *anchor;                 // [n] K 1: what holds uniform slip [Pa/m]; NULL: nothing does
    double *log_rate0, *log_state0; // [n]
};

// Sum in the order of the cells.
double lac_problem_sum(size_t n, const double *x);

// What the loads do at one time, as the cells feel it.
typedef struct lac_drive {
    double ratio;            // (Q/P)(t) - (Q/P)(0), force loads included: q_i gains p_i ratio
    double ratio_rate;       // [1/s]
    double spring;           // traction of each cell from the far ends' travel [Pa]
    double spring_rate;      // [Pa/s]
    double spring_stiffness; // traction lost per metre of mean slip [Pa/m]
    double back;             // slip of the rock around, since the start [m]
    double back_rate;        // [m/s]
    double share;            // effective over total normal pressure: p_i -> p_i share
    double share_rate;       // [1/s]
} lac_drive;

// Evaluates the loads; false where the effective normal pressure is not positive.
bool lac_problem_drive(const lac_problem *problem, double t, lac_drive *drive);

// Finds out what the transfer does to uniform slip.
lac_status lac_problem_anchor(lac_problem *problem, lac_error *err);

// force = K (x - back): what a slip, or a rate, takes off each cell where the rock around has gone
// `back` itself. @param work  of the transfer
void lac_problem_couple(const lac_problem *problem, double back, const double *x, double *force,
                        double *work);

// Sum over the cells of K (slip - back): what the rock around holds [Pa].
double lac_problem_held(const lac_problem *problem, double back, const double *slip);

// v = exp(u) of every cell, and its sum in a fixed order.
double lac_problem_exp_sum(size_t n, const double *u, double *v);

// Scratch of one block of cells for the friction kernels, on the caller's stack.
typedef struct lac_block {
    double f[LAC_FRICTION_BLOCK], f_u[LAC_FRICTION_BLOCK], f_w[LAC_FRICTION_BLOCK];
    double g[LAC_FRICTION_BLOCK];
} lac_block;

typedef struct lac_block_slopes {
    double f_uu[LAC_FRICTION_BLOCK], f_uw[LAC_FRICTION_BLOCK], f_ww[LAC_FRICTION_BLOCK];
    double g_u[LAC_FRICTION_BLOCK], g_w[LAC_FRICTION_BLOCK];
} lac_block_slopes;

static inline lac_friction_values lac_block_values(lac_block *s)
{
    return (lac_friction_values){.f = s->f, .f_u = s->f_u, .f_w = s->f_w, .g = s->g};
}

static inline lac_friction_slopes lac_block_slope_arrays(lac_block_slopes *s)
{
    return (lac_friction_slopes){
        .f_uu = s->f_uu, .f_uw = s->f_uw, .f_ww = s->f_ww, .g_u = s->g_u, .g_w = s->g_w};
}

static inline size_t lac_block_length(size_t n, size_t first)
{
    return n - first < LAC_FRICTION_BLOCK ? n - first : LAC_FRICTION_BLOCK;
}

// The cells of a block at y, with v = exp(u) of all n cells at hand.
static inline lac_friction_cells lac_block_cells(size_t n, size_t first, const double *y,
                                                 const double *v)
{
    return (lac_friction_cells){.first = first,
                                .n = lac_block_length(n, first),
                                .u = y + first,
                                .w = y + n + first,
                                .v = v + first};
}

#endif
