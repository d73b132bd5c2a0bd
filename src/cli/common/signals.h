/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>

/// Takes over SIGINT, SIGTERM and SIGUSR1, and ignores SIGPIPE and SIGXFSZ (writing then
/// fails instead).
/// Until cli_signals_hold, SIGINT and SIGTERM end the program at once with exit status 4.
void cli_signals_install(void);

/// Names the file that the program makes: where netCDF breaks down because the system refused to
/// write or close it, the program ends with one line about that file and exit status 3.
void cli_signals_writing(const char *path);

/// From now on SIGINT and SIGTERM only raise a flag, for what has a file to finish. A second one
/// ends the program the default way.
void cli_signals_hold(void);

/// Whether SIGINT or SIGTERM came.
bool cli_signals_stop(void);

/// Whether SIGUSR1 came since last asked.
bool cli_signals_take_report(void);
