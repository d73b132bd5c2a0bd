/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "fit/fit.h"

/// Prints what it came to on stdout.
void cli_fit_print(const lac_fit_outcome *outcome, const char *series, double wall_time,
                   bool verbose);
