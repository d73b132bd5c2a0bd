/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "contact/contact.h"

/// A joint in normal contact that is sheared: Coulomb friction on every cell, two equal bodies, so
/// that normal and tangential problems decouple.
typedef struct lac_tangential_def {
    lac_grid grid;
    double e_star;          ///< contact modulus E* = G/(1-nu) [Pa]
    double poisson;         ///< Poisson's ratio nu [1], 0 to 0.5
    double friction;        ///< Coulomb's coefficient f [1], > 0
    double tolerance;       ///< on the conditions of the solution, relative
    int64_t max_iterations; ///< of one step
} lac_tangential_def;

/// What is given along one axis: the shear load or how far the bodies are shifted.
typedef enum lac_tangential_control { LAC_SHEAR_LOAD, LAC_SHEAR_SHIFT } lac_tangential_control;

/// The end of one step of a loading history; index 0 is x, 1 is y.
typedef struct lac_tangential_target {
    lac_tangential_control control[2];
    double value[2]; ///< mean traction over the nominal area [Pa], or shift [m]
} lac_tangential_target;

/// What a cell does at the end of a step. It slips where friction is at its limit and slip along it
/// has grown by more than no slip is held to (tolerance * largest displacement); else it sticks.
typedef enum lac_cell_state { LAC_CELL_OPEN, LAC_CELL_STICK, LAC_CELL_SLIP } lac_cell_state;

/// How a step ended and how good its solution is.
typedef struct lac_tangential_stats {
    size_t contact_cells, stick_cells, slip_cells;
    double traction[2];   ///< mean over the nominal area [Pa]
    double shift[2];      ///< of one body against the other, far away [m]
    double dissipation;   ///< frictional work of this step [J]
    double highest_ratio; ///< q/(f p) of the cell that comes next: the highest that sticks [1]
    size_t highest_cell;  ///< its index in the grid; SIZE_MAX where nothing sticks
    double residual;      ///< how far the conditions of the solution are from holding, relative:
                          ///< largest slip where it sticks, or slip not along q where it slips,
                          ///< over the largest displacement
    int64_t iterations;
    int64_t products; ///< applications of the elastic operator
} lac_tangential_stats;

/// The solver with its memory: what a step left, vectors along x and along y [ny * nx] each.
typedef struct lac_tangential {
    lac_tangential_def def;
    struct lac_shear_space *space;
    double softness;     ///< displacements in the unit of space to metres [m/Pa]
    double *traction[2]; ///< [Pa]; the first owns all vectors
    double *slip[2]; ///< since the history began [m]: 0 where a cell has always stuck, and where
                     ///< it is open
    double *u[2];    ///< displacements, in the unit of space
    uint8_t *state;  ///< [ny * nx] lac_cell_state
    double shift[2]; ///< [m]
} lac_tangential;

/// A def with tolerance 1e-8 and 2000 iterations; the rest is the caller's.
lac_tangential_def lac_tangential_default(void);

/// Starts a history: no tractions, no shift.
lac_status lac_tangential_create(const lac_tangential_def *def, lac_tangential **out,
                                 lac_error *err);
void lac_tangential_free(lac_tangential *t);

/// Goes on to the next load, in one step: displacements of the step before are the memory. Cells
/// that come into contact start without traction; where pressures change, many small steps follow
/// the history more closely.
/// @param pressure  [ny * nx] normal pressures at its end [Pa], >= 0
lac_status lac_tangential_step(lac_tangential *t, const double *pressure,
                               const lac_tangential_target *target, lac_tangential_stats *report,
                               lac_error *err);

/// Where a joint without any slip would first slip.
typedef struct lac_first_slip {
    size_t cell;     ///< the cell with the highest q/(f p), by its index in the grid
    double factor;   ///< Q/(f P) at which it reaches 1 [1]
    double load;     ///< Q then: mean traction along the direction [Pa]
    double shift[2]; ///< of one body against the other then [m]
    double residual; ///< largest slip over the largest displacement [1]
    int64_t iterations, products;
} lac_first_slip;

/// Shears a joint all of whose contact cells stick: linear, so that the traction in the cell with
/// the highest q/(f p) scales to its limit. In the continuum such tractions are infinite at every
/// edge of the contact, and slip begins at once: the factor belongs to the cells, and falls with
/// their size.
/// @param direction  of the load; any length but 0
lac_status lac_tangential_first_slip(const lac_tangential_def *def, const double *pressure,
                                     const double direction[2], lac_first_slip *result,
                                     lac_error *err);
