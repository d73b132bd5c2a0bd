/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/filter.h"
#include "contact/contact.h"

// The solver works on numbers of order one: heights and gaps in units of the rms height h_rms,
// wavenumbers kappa = |q| length, pressures in units of E* h_rms / (2 length), so that
// u_hat = p_hat / kappa.

/// Where the interface lies and what lies around it.
typedef struct lac_extent {
    size_t nx, ny;
    double dqx, dqy; ///< spacing of kappa along x and y: longest side / side
    bool periodic;   ///< else the faces end at the grid and the half-space goes on, free
    lac_strip rows;  ///< those whose heights and pressures are here
} lac_extent;

/// Cells of it that are here.
static inline size_t lac_extent_cells(const lac_extent *at) { return at->nx * at->rows.n; }

/// The elastic half-space on one grid. Free grids sit in the corner of a transform twice as long.
typedef struct lac_half_space {
    size_t nx, ny;      ///< cells of the grid
    size_t mx, my, nkx; ///< the transform and the columns of its spectrum
    lac_strip rows;     ///< of the grid, those here
    lac_strip columns;  ///< of the spectrum, those whose symbol is asked for here
    lac_filter *filter;
    double dqx;         ///< spacing of kappa along x in the transform
    double *qy2;        ///< [my/2 + 1] square of kappa along y
    double *compliance; ///< [columns.n * (my/2 + 1)] free: Love's kernel over mx my; else NULL
    bool triangle;      ///< of that only what lies on and below the diagonal, the rest is the same
    double self;        ///< displacement of a cell under its own unit pressure
} lac_half_space;

lac_status lac_half_space_create(const lac_extent *extent, lac_half_space **out, lac_error *err);
void lac_half_space_free(lac_half_space *s);

/// What s->filter was filled with, in either precision, becomes S times it, to be taken from
/// there; periodic: with the mean left out.
void lac_half_space_displace(lac_half_space *s);

/// The same with |q|: the inverse of the above, roughly where free.
/// @param power  x . |q| x, of what s->filter was filled with; NULL if not wanted
void lac_half_space_unload(lac_half_space *s, double *power);

/// x . S x of the x that s->filter was filled with, by Parseval's theorem.
double lac_half_space_energy(lac_half_space *s);

/// How far from the solution a pressure is.
typedef struct lac_residual {
    double complementarity; ///< sum p |g| / sum p
    double penetration;     ///< deepest negative gap where p = 0
    double load;            ///< |mean p - mean_pressure| / mean_pressure
} lac_residual;

/// Heights as they are given, and what makes them those of the solver: (z - mean)/unit.
typedef struct lac_heights {
    const double *z; ///< [rows here][nx] [m]
    double mean, unit;
} lac_heights;

static inline double lac_heights_at(lac_heights h, size_t i) { return (h.z[i] - h.mean) / h.unit; }

/// What the conjugate gradients need beside the half-space, and what they say.
typedef struct lac_descent {
    lac_heights heights;
    lac_contact_control control;
    double mean_pressure; ///< given or that of the first guess
    double approach;      ///< given, where it is what is controlled
    double tolerance;
    int64_t max_iterations;
    int64_t iterations, products; ///< done
    lac_residual residual;        ///< on a fresh product of the pressures returned
    double closest;               ///< gap less S p - h: how far the faces stand apart
} lac_descent;

/// Constrained conjugate gradients on the pressures from a first guess.
/// @param pressure  [rows.n * nx] first guess, >= 0, load control: with the given mean; overwritten
/// @param gap       [rows.n * nx] gap of the result; overwritten; NULL if not wanted
lac_status lac_descend(lac_half_space *s, lac_descent *d, double *pressure, double *gap,
                       lac_error *err);

/// Whether a residual is within the tolerance.
bool lac_residual_holds(const lac_residual *r, double tolerance);

/// First guess of the pressures, from ever coarser grids of any sides; load control: of the given
/// mean.
lac_status lac_coarse_guess(const lac_extent *at, lac_heights h, const lac_descent *fine,
                            double *pressure, lac_error *err);
