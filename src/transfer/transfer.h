/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "hierarchy/classes.h"
#include "hierarchy/hierarchy.h"

/// What a stress transfer is made from. The domain and hierarchy must outlive the transfer.
typedef struct lac_transfer_scene {
    const lac_domain *domain;
    const lac_hierarchy *hierarchy;
    double shear_modulus; ///< G [Pa]; NaN where the case names no material
    double poisson;       ///< nu [1]
    bool line;            ///< a row of cells is a line in plane strain, not a strip as wide
    bool measure;         ///< Fourier transforms are planned by measuring: quicker, not to the bit
    lac_team *team;       ///< who share the transforms of the elastic rock, and make it and call it
                          ///< together; NULL: one alone
} lac_transfer_scene;

/// What a transfer's parameters say of its stiffness, before one is made.
typedef struct lac_transfer_outline {
    const char *rock; ///< it is that of the elastic rock, whose shear modulus it needs: the part of
                      ///< the parameters that says so (".stiffness: elastic"); NULL: it is not
    double k0;        ///< where it is not: of the finest cells [Pa/m]
    double ratio;     ///< and of a level over that of the next finer one [1]; NaN: not given
    bool anchored;    ///< rock that stays behind holds the mean slip
    bool surface;     ///< rock ends at a free surface: on a plane a table over pairs of rows
} lac_transfer_outline;

/// Where a transfer is to act.
typedef struct lac_transfer_place {
    bool periodic, full, line; ///< the interface repeats; all its cells touch; it is a line
} lac_transfer_place;

enum { LAC_TRANSFER_FAULTS = 3 };

/// What is wrong with a parameter: its key below the transfer's (".ratio"), and words; NULL:
/// nothing.
typedef struct lac_transfer_validate {
    const char *key, *text;
} lac_transfer_validate;

/// K of slip in two directions, along x [0] and along y [1], of a state that has been `direct`ed.
typedef struct lac_transfer_pair {
    /// Readies a state that `create` has made.
    lac_status (*direct)(const void *params, const lac_transfer_scene *scene, void *state,
                         lac_error *err);
    size_t (*work)(const void *state); ///< doubles of scratch that apply and solve need
    /// force = K slip; [n] each [m] -> [Pa]
    void (*apply)(const void *state, const double *const slip[2], double *const force[2],
                  double *work);
    /// (D + K + k_mean P_m) x = y, y in the place of x, D of symmetric 2 x 2 blocks: xx, xy, yy;
    /// false as `solve`
    bool (*solve)(const void *state, double k_mean, const double *const diagonal[3],
                  double *const x[2], double *work);
} lac_transfer_pair;

/// A stress transfer: slip -> stress taken off each cell, K, symmetric positive semidefinite. Zero
/// for uniform slip, unless rock that stays behind holds the mean slip (`elastic` with a thickness
/// or creeping surroundings).
typedef struct lac_transfer_kind {
    lac_model_info info;
    lac_status (*create)(const void *params, const lac_transfer_scene *scene, void **state,
                         lac_error *err);
    void (*free)(void *state);
    size_t (*work)(const void *state); ///< doubles of scratch that apply and solve need
    /// force = K slip; [n] each [m] -> [Pa]
    void (*apply)(const void *state, const double *slip, double *force, double *work);
    /// (D + K + k_mean P_m) x = y; x may be y; false where it is not positive definite, or an
    /// iteration does not end
    bool (*solve)(const void *state, double k_mean, const double *diagonal, const double *y,
                  double *x, double *work);
    /// The same of the cells of a rank, slip along x, from a state of all, which must outlive it.
    /// NULL: every rank has the whole
    lac_status (*part)(const void *state, const lac_range *range, void **out, lac_error *err);
    const lac_transfer_pair *pair; ///< NULL: it knows slip along x only
    /// Stiffness of a level [Pa/m]; 0 where the kind has no levels
    double (*stiffness)(const void *state, size_t level);
    /// The blocks, where K is sum_l stiffness(l) (P_l - P_{l+1}) over them. NULL: it is not
    const lac_hierarchy *(*blocks)(const void *state);
    bool transforms; ///< applies by Fourier transforms of the grid, and its solve iterates
    /// NULL: cells do not feel each other's slip.
    lac_transfer_outline (*outline)(const void *params);
    /// Whether parameters go together, and with the place. NULL: they always do.
    /// @param fault  [LAC_TRANSFER_FAULTS] empty; filled in
    void (*check)(const void *params, const lac_transfer_place *place,
                  lac_transfer_validate *fault);
} lac_transfer_kind;

/// A transfer kind made for one domain. Immutable but for scratch of its own: one thread at a time.
typedef struct lac_transfer {
    const lac_transfer_kind *kind;
    void *state;
} lac_transfer;

/// Parameters of `hierarchy`: stiffness calibrated from the elastic half-space on this domain,
/// or given as k_l = k0 * ratio^l.
typedef struct lac_transfer_hierarchy {
    int stiffness; ///< 0: elastic; -1 (absent) where k0 is given
    double k0;     ///< stiffness of the finest level [Pa/m]; NaN where elastic
    double ratio;  ///< k_{l+1}/k_l [1]
    int64_t seed;  ///< of the calibration's random probes
} lac_transfer_hierarchy;

/// Parameters of `elastic`.
typedef struct lac_transfer_elastic {
    int mode;                ///< 0: in-plane, 1: antiplane
    int outside;             ///< beyond a free border 0: free of traction, 1: creeping
    int boundary;            ///< 1: a free surface beside the first row (of a line: cell)
    double thickness;        ///< of the rock on either side [m]; NaN: half-spaces
    double tolerance;        ///< of the stress, relative [1]
    double newton_tolerance; ///< of solve, relative [1]
} lac_transfer_elastic;

/// What the model of a case says of its transfer's stiffness; an empty one: none.
/// @return false: cells do not feel each other's slip, and the outline is empty
bool lac_transfer_outline_of(const lac_model *model, lac_transfer_outline *outline);

/// The index-th kind, NULL past the end.
const lac_transfer_kind *lac_transfer_kind_get(size_t index);

/// Makes the chosen transfer for a domain; an empty model means `none`.
lac_status lac_transfer_create(const lac_model *model, const lac_transfer_scene *scene,
                               lac_transfer *transfer, lac_error *err);

/// Readies a transfer that was made of the same for slip in two directions.
/// @return LAC_OK; LAC_EINPUT (the kind knows slip along x only); LAC_ENUMERIC; LAC_ENOMEM
lac_status lac_transfer_direct(const lac_model *model, const lac_transfer_scene *scene,
                               lac_transfer *transfer, lac_error *err);

/// Tractions of cells tied to one another, which slip alike: C^-1 1, scaled to a mean of 1. How
/// rock shares a force by the contact cells, gaps free; cells at edges carry more. 1 on full
/// periodic contact. Their sum is n to rounding. The rock is that of an `elastic` model; else
/// half-spaces, slip along x. docs/theory/transfer.md, equation 21.
lac_status lac_transfer_tied(const lac_model *model, const lac_transfer_scene *scene, double *share,
                             lac_error *err);

/// The transfer of classes of cells, which it owns then.
lac_transfer lac_transfer_of_classes(lac_classes *classes);

/// A transfer as a rank has it, who calls all its functions with all others: of its cells, to the
/// bits that `of` gives. @param of  of all cells; must outlive it
/// @param both  slip has two directions
lac_status lac_transfer_part(const lac_transfer *of, bool both, const lac_range *range,
                             lac_transfer *out, lac_error *err);

void lac_transfer_clear(lac_transfer *transfer);

/// The rows of the registry.
extern const lac_transfer_kind lac_hierarchy_kind, lac_elastic_kind, lac_none_kind;
