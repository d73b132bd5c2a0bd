/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SCENE_RG_H
#define LACUNA_SCENE_RG_H

#include "lacuna/rg_study.h"
#include "lacuna/scene.h"

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
} lac_scene_rg;

/// Asked before each seed and told how many are done.
typedef struct lac_rg_watch {
    void *context;
    /// @return false to end here
    bool (*go_on)(void *context, size_t done, size_t seeds);
} lac_rg_watch;

/// Runs the cascade of a case.
/// @param watch  NULL: not watched
/// @return LAC_OK; LAC_EINPUT (no beta follows from the friction law, no contact ...);
///         LAC_ENUMERIC; LAC_EINTERRUPT where the watch ended it; LAC_ENOMEM
/// @cost   with `elastic` 24 contacts a seed; some 300 passes a place and beta
lac_status lac_scene_rg_run(const lac_case *c, const lac_rg_watch *watch, lac_scene_rg *out,
                            lac_error *err);

/// Frees what it holds.
void lac_scene_rg_clear(lac_scene_rg *rg);

#endif
