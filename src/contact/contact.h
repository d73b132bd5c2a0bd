/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/grid.h"
#include "base/param.h"
#include "base/strip.h"

/// What is given: the load or how near the bodies are.
typedef enum lac_contact_control { LAC_CONTROL_LOAD, LAC_CONTROL_APPROACH } lac_contact_control;

/// A rough rigid surface pressed on an elastic half-space (normal contact).
typedef struct lac_contact_def {
    lac_grid grid;         ///< periodic; else faces that end at its border, free beyond
    lac_team *team;        ///< each rank has the rows of lac_strip_rows, here and in what follows;
                           ///< NULL: all are here
    const double *heights; ///< [ny * nx] composite height, peaks up [m]
    double e_star;         ///< contact modulus E* = G/(1-nu) of two equal half-spaces [Pa]
    lac_contact_control control;
    double mean_pressure;   ///< load control: over the nominal area [Pa], > 0
    double approach;        ///< approach control: as in the report [m]; periodic: > 0
    const double *start;    ///< [ny * nx] first guess of the pressures [Pa], may be `pressure`
                            ///< itself; NULL or all 0: from coarser grids
    double tolerance;       ///< on complementarity, penetration and load, relative
    int64_t max_iterations; ///< of the finest grid
} lac_contact_def;

/// How the solution was reached and how good it is.
typedef struct lac_contact_stats {
    size_t n_cells;               ///< cells with p > 0
    int64_t iterations;           ///< conjugate gradient steps on the finest grid
    int64_t products;             ///< applications of the elastic operator there
    double complementarity_error; ///< sum p |g| / (sum p * h_rms) [1]
    double penetration;           ///< deepest negative gap outside the contact [m], >= 0
    double load_error;    ///< |mean p - mean_pressure| / mean_pressure [1]; 0 where not given
    double mean_pressure; ///< [Pa]
    double max_pressure;  ///< [Pa]
    double approach;      ///< far (mean) plane of the body minus mean of the heights [m]
} lac_contact_stats;

/// A def with tolerance 1e-8 and 1000 iterations; the rest is the caller's.
lac_contact_def lac_contact_default(void);

/// How far the highest peak stands above the mean of the heights [m].
double lac_contact_peak(const lac_contact_def *def);

/// Solves for pressures p >= 0 and gaps g >= 0 with p g = 0 and the given load or approach.
/// u_hat = 2 p_hat / (E* |q|); free: u = sum of Love's solution; docs/theory/contact.md.
/// @param pressure  [ny * nx] [Pa]; overwritten; exactly 0 outside the contact
/// @param gap       [ny * nx] [m], 0 in contact within the tolerance; NULL if not wanted
lac_status lac_contact_solve(const lac_contact_def *def, double *pressure, double *gap,
                             lac_contact_stats *report, lac_error *err);

/// The contact domain: the cells that touch, in Morton (hierarchy) order. Immutable.
typedef struct lac_domain {
    lac_grid grid;
    size_t n;         ///< contact cells
    uint32_t *index;  ///< [n] grid index of each contact cell, Morton order
    double *pressure; ///< [n] normal pressure [Pa], > 0
    double *weight;   ///< [n] how many contact cells each stands for, over their mean; NULL: each
                      ///< is itself
    double each;      ///< that mean, with weights
} lac_domain;

/// Contact cells that a domain stands for.
static inline double lac_domain_cells(const lac_domain *domain)
{
    return domain->weight != NULL ? (double)domain->n * domain->each : (double)domain->n;
}

/// Collects the cells with p > 0.
/// @param pressure  [ny * nx] [Pa]
lac_status lac_domain_create(const lac_grid *grid, const double *pressure, lac_domain **domain,
                             lac_error *err);

/// The same, on every rank, from the rows of lac_strip_rows of each.
lac_status lac_domain_gather(const lac_grid *grid, lac_team *team, const double *pressure,
                             lac_domain **domain, lac_error *err);
void lac_domain_free(lac_domain *domain);

/// Morton code of a grid cell: the bits of iy and ix interleaved, x lowest.
uint64_t lac_morton(uint32_t ix, uint32_t iy);

/// Where a contact domain comes from when no surface is pressed.
typedef struct lac_domain_source {
    lac_model_info info;
    /// @param occupied  [ny * nx] set to 1 in contact cells, 0 elsewhere
    /// NULL: the cells are read from a file, which is the scene's part
    lac_status (*fill)(const void *params, const lac_grid *grid, uint8_t *occupied, lac_error *err);
    bool full; ///< every cell is in contact, whatever the parameters
} lac_domain_source;

/// Parameters of `cascade`: a random dyadic cascade of the given dimension.
typedef struct lac_cascade {
    double dimension; ///< fractal dimension; each block keeps 2^D of its four children on average
    int64_t seed;
} lac_cascade;

/// What becomes of the pressures of a file.
typedef enum lac_file_pressures {
    LAC_PRESSURES_KEPT = 0, ///< as they are
    LAC_PRESSURES_SCALED,   ///< in proportion, to carry the load
    LAC_PRESSURES_EQUAL,    ///< none of them: the load in equal parts
} lac_file_pressures;

/// Parameters of `file`: contact cells that were computed or measured elsewhere.
typedef struct lac_domain_file {
    char *path;
    int pressures; ///< lac_file_pressures
} lac_domain_file;

extern const lac_domain_source lac_domain_from_file;

/// The index-th domain source in the registry, NULL past the end.
const lac_domain_source *lac_domain_source_get(size_t index);

/// A domain from a source, every contact cell at the same pressure so that the load is held.
lac_status lac_domain_from_source(const lac_model *model, const lac_grid *grid,
                                  double mean_pressure, lac_domain **domain, lac_error *err);
