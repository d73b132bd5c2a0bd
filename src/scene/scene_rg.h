/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/scene.h"
#include "store/store_cells.h"

/// A joint as it is, before the further load of lac_scene_rg_cells.
typedef struct lac_scene_rg_now {
    bool loaded;        ///< the rest holds
    double load;        ///< Q/Q_nom [1]
    double share;       ///< effective normal pressure over the total one [1]
    double weakest_gap; ///< least further stress that makes a cell slip [Pa]; <= 0: it slips now
    double weakest[2];  ///< centre of that cell [m]
} lac_scene_rg_now;

/// The cascade of a case: a study for each beta, over all seeds and places.
typedef struct lac_scene_rg {
    size_t betas;                                ///< 1 where it follows from the friction law
    double beta[LAC_MOST_BETAS];                 ///< [betas]; from the law: mean over cells, seeds
    lac_rg_study *study[LAC_MOST_BETAS];         ///< [betas]
    const lac_rg_result *result[LAC_MOST_BETAS]; ///< [betas]
    lac_grid grid;
    size_t seeds;
    lac_rg_interface *interface; ///< [seeds]
    lac_rg_interface mean;       ///< of these
    double strength;             ///< Q_nom over the nominal area, mean over the seeds [Pa]
    lac_domain *domain;          ///< of the last seed
    lac_scene_rg_now now;        ///< of lac_scene_rg_cells
} lac_scene_rg;

/// Asked before each seed and told how many are done.
typedef struct lac_rg_watch {
    void *context;
    /// @return false to end here
    bool (*go_on)(void *context, size_t done, size_t seeds);
    /// What lac_scene_rg_part made of a seed but the last, which is taken over. NULL: none was made
    const void *(*made)(void *context, size_t seed);
} lac_rg_watch;

/// Runs the cascade of a case.
/// @return LAC_OK; LAC_EINPUT (no beta follows from the friction law, no contact ...);
///         LAC_ENUMERIC; LAC_EINTERRUPT where the watch ended it; LAC_ENOMEM
/// @cost   with `elastic` 24 contacts a seed; some 300 passes a place and beta
lac_status lac_scene_rg_run(const lac_case *c, const lac_rg_watch *watch, lac_scene_rg *out,
                            lac_error *err);

/// The cascade over one interface of the ensemble, maybe in another process, for `made` of a watch:
/// the result is the same to the bit.
/// @param seed  its place in the ensemble, from 0
/// @param part  [lac_scene_rg_part_size] plain memory without pointers
/// @return as lac_scene_rg_run
lac_status lac_scene_rg_part(const lac_case *c, size_t seed, void *part, lac_error *err);
size_t lac_scene_rg_part_size(const lac_case *c);

/// Cells and tractions that are known, such as those of a snapshot.
typedef struct lac_rg_cells {
    const lac_domain *domain; ///< pressures before pore pressure
    const double *shear;      ///< [n] traction of each cell [Pa]
    double time;              ///< at which the case's pore pressure acts [s]; NaN: none acts
} lac_rg_cells;

/// Runs the cascade on known cells: a further load is laid on, the same stress on all cells up to
/// their caps (lac_rg_path_further), f and beta from the case.
/// @param c  read for LAC_FOR_CELLS; its rg.field and rg.seeds do not matter
/// @return LAC_OK; LAC_EINPUT (no beta follows from the friction law; pore pressure as high as the
///         normal stress); LAC_ENOMEM
lac_status lac_scene_rg_cells(const lac_case *c, const lac_rg_cells *cells, lac_scene_rg *out,
                              lac_error *err);

/// The names of rule and field as a case has them.
const char *lac_scene_rg_rule(const lac_case *c);
const char *lac_scene_rg_field(const lac_case *c);

/// The cell of the last interface that slips at the least load, of ties the one that is pressed
/// least.
/// @param place  its centre [m]; NaN where none slips
/// @return SIZE_MAX where none slips
size_t lac_scene_rg_first(const lac_scene_rg *rg, const lac_rg_result *r, double place[2]);

/// A cascade as it is told.
typedef struct lac_rg_outcome {
    const lac_case *source;
    const lac_scene_rg *rg;
    const char *file;              ///< whose cells were followed
    const lac_stored_cells *cells; ///< of it; NULL: of a case
} lac_rg_outcome;

/// Its variables, for a file or JSON; docs/format.md.
/// @param outcome  with all that it points to must outlive the dataset
lac_status lac_scene_rg_describe(const lac_rg_outcome *outcome, lac_dataset **out, lac_error *err);

void lac_scene_rg_clear(lac_scene_rg *rg);
