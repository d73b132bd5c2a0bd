/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "cli/common/options.h"

/// How a run's progress is shown on stderr.
typedef struct cli_progress {
    bool bar, colour, drawn; ///< drawn: the bar stands on the terminal
    double started, last;    ///< on the monotonic clock [s]
    bool line_due, bar_due;  ///< to be written after this step
} cli_progress;

/// Seconds on a clock that never goes back.
double cli_clock(void);

/// CPU time of the program so far [s].
double cli_cpu_time(void);

/// A bar only on a terminal that can redraw a line, and where the request wants one.
void cli_progress_start(cli_progress *progress, const cli_request *request);

/// Draws the bar at most ten times a second; prints a line where SIGUSR1 asked for one.
void cli_progress_show(cli_progress *progress, const lac_progress *now);

/// The same for any other work. @param what  "steps of the sampler"
void cli_progress_stage(cli_progress *progress, const char *what, size_t done, size_t total);

/// Takes the bar off the terminal.
void cli_progress_clear(cli_progress *progress);

/// Says what is being done, on stderr, with --verbose.
void cli_say(const cli_request *request, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/// Takes over SIGINT, SIGTERM and SIGUSR1, and ignores SIGPIPE and SIGXFSZ (writing then
/// fails instead).
/// Until cli_signals_hold, SIGINT and SIGTERM end the program at once with exit status 4.
void cli_signals_install(void);

/// Names the file that the program makes: where netCDF breaks down because the system refused to
/// write or close it, the program ends with one line about that file and exit status 3.
void cli_signals_writing(const char *path);

/// How to go on from that file where all ranks end, in words that follow others; "": it is not
/// there.
void cli_signals_remedy(char *out, size_t room);

/// From now on SIGINT and SIGTERM only raise a flag, for what has a file to finish. A second one
/// ends the program the default way.
void cli_signals_hold(void);

/// Whether until then SIGTERM ends it without a word where its parent sends it, as mpirun does
/// after a rank with an error.
void cli_signals_hush(bool parent);

/// Whether SIGINT or SIGTERM came; as what is asked while something goes on.
bool cli_signals_stop(void *context);
