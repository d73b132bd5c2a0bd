/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "scene/estimate.h"

/// How a lumped run of a case went.
typedef struct cli_lumped_try {
    bool made;
    size_t cells;
    double error, time; ///< by estimate; CPU [s]
} cli_lumped_try;

/// Runs a case lumped, where it takes it as it stands and its cells slip together: that takes less
/// than to build its scene. What does not come to an end, or not to its error, is not told of.
void cli_try_lumped(const lac_case *c, const lac_estimate *e, cli_lumped_try *out);
