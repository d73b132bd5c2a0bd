/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_FIT_FIT_H
#define LACUNA_CLI_FIT_FIT_H

#include "fit/fit.h"

/// Prints what it came to on stdout.
void cli_fit_print(const lac_fit_outcome *outcome, const char *series, double wall_time,
                   bool verbose);

#endif
