/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "model/problem.h"

/// Why a failure rate that is lowered counts in the place of the case's, and how it is judged.
extern const char *const cli_failure_lowered;

/// Warns where damping leaves little or nothing between the slip rate at the start and failure.
void cli_failure_warn(const lac_failure *failure);
