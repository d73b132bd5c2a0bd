/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RUN_ADVICE_H
#define LACUNA_CLI_RUN_ADVICE_H

#include "cli/run/estimate.h"

/// The solver.fidelity that would be faster than the case's and takes the case as it stands.
/// @param estimate  its stiffness_ratio and own_steps
/// @return NULL where none is known to be
const char *cli_faster_fidelity(const lac_case *c, double cells, const cli_estimate *estimate);

#endif
