/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "transfer/transfer.h"

/// k_l = trace((P_l - P_{l+1}) K)/rank(P_l - P_{l+1}) with the K of the elastic half-space on the
/// scene's contact domain; docs/theory/transfer.md, equation 13. About 1 % accurate on grids of up
/// to 64 x 64 cells, exact where few blocks are tied; on larger ones 0.5 % of the finest level
/// and some 3 % where few blocks are tied.
/// @param across  of slip along y, else along x
/// @param seed    of the random probes
/// @param k       [lac_hierarchy_levels]; 0 where the level ties no blocks
lac_status lac_calibrate_elastic(const lac_transfer_scene *scene, bool across, uint64_t seed,
                                 double *k, lac_error *err);
