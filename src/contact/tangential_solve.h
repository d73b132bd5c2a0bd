/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdint.h>

#include "contact/tangential.h"
#include "contact/tangential_space.h"

/// One step of a sheared contact, on its contact cells only: minimise tau.C tau/2 - tau.(u0 + d)
/// over |tau_i| <= limit_i, d the shift of this step, given or such that the sum of tau is given.
/// Vectors hold all x first, then all y. Tractions in any unit, displacements as lac_shear_space.
typedef struct lac_shear_problem {
    lac_shear_space *space;
    size_t n;             ///< contact cells
    const uint32_t *cell; ///< [n] index in the grid
    const double *limit;  ///< [n] f p > 0; all INFINITY: nothing ever slips
    const double *before; ///< [2n] u0, displacements before the step
    bool held[2];         ///< whether the load is given along an axis
    double load[2];       ///< where it is: sum of the tractions
    double shift[2];      ///< elsewhere given; where the load is, what it takes
    double tolerance;
    int64_t max_iterations;
    double *tau;      ///< [2n] first guess; the tractions
    double *u;        ///< [2n] C tau, a fresh product
    uint8_t *limited; ///< [n] whether |tau| = limit
    double scale;     ///< unit of displacements that the residual is relative to
    double residual;  ///< worst cell: slip where it sticks, slip not along tau where it slips
    int64_t iterations, products;
} lac_shear_problem;

/// The fields of u of all cells are in space->fft[axis]->real at the end, where used.
lac_status lac_shear_solve(lac_shear_problem *p, lac_error *err);

/// tau_i = the point of the disc of radius limit_i nearest to y_i + lambda; lambda, a first guess,
/// is such that tractions sum to `load` along the axes held. `limited`: y_i + lambda lies outside.
void lac_shear_project(const lac_shear_problem *p, const double *y, double *tau, uint8_t *limited,
                       double lambda[2]);

struct lac_tangential {
    lac_tangential_def def;
    lac_shear_space *space;
    double softness; ///< displacements in the unit of space to metres [m/Pa]
    double *tau;     ///< [2 * cells] tractions [Pa]; owns the two below
    double *u;       ///< [2 * cells] displacements, in the unit of space
    double *slip;    ///< [2 * cells] [m]
    uint8_t *state;  ///< [cells]
    double shift[2]; ///< [m]
    bool used[2];    ///< axes that have ever been loaded, or are coupled to one that has
};

/// One step on the contact cells, in tractions of order one.
typedef struct lac_shear_step {
    lac_shear_problem p;
    double unit; ///< of tractions, a power of two [Pa]
    uint32_t *cell;
    double *work; ///< limit, before, tau, u
    uint8_t *limited;
} lac_shear_step;

/// Room for n cells, to be cleared whatever the status.
lac_status lac_shear_step_create(lac_shear_step *s, size_t n, lac_error *err);
void lac_shear_step_clear(lac_shear_step *s);

/// The pressures of a contact: how many press, their mean and the highest.
typedef struct lac_pressed {
    size_t n;
    double mean, most;
} lac_pressed;

/// What all that shears demands of a def.
lac_status lac_tangential_check(const lac_tangential_def *def, lac_error *err);

lac_status lac_tangential_check_pressure(const lac_tangential_def *def, const double *pressure,
                                         lac_pressed *pressed, lac_error *err);

/// Displacements in the unit of lac_shear_space to metres [m/Pa].
double lac_tangential_softness(const lac_tangential_def *def);
