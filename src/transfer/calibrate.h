/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "transfer/transfer.h"

/// Stiffness of one level as the elastic half-space has it on a domain.
typedef struct lac_calibration {
    double stiffness; ///< k_l [Pa/m]; 0 where the level ties no blocks
    double error;     ///< standard error of the random probes [Pa/m]; 0 where all vectors were used
    size_t solves;    ///< inversions of the compliance
} lac_calibration;

/// k_l = trace((P_l - P_{l+1}) K)/rank(P_l - P_{l+1}) with the K of the elastic half-space on the
/// scene's contact domain; docs/theory/transfer.md, equation 13. About 1 % accurate.
/// @param seed    of the random probes
lac_status lac_calibrate_elastic(const lac_transfer_scene *scene, uint64_t seed,
                                 lac_calibration *levels, lac_error *err);

/// The stiffnesses alone. @param k  [lac_hierarchy_levels]; overwritten
lac_status lac_calibrate_stiffness(const lac_transfer_scene *scene, uint64_t seed, double *k,
                                   lac_error *err);
