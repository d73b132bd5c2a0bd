/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_RUN_HISTORY_H
#define LACUNA_CLI_RUN_HISTORY_H

#include "run/run.h"
#include "series/series.h"

/// A sink that passes everything on and keeps what the summary and the comparison need.
typedef struct cli_history {
    lac_sink next;
    bool keep;                  ///< keep time, slip and rate of every record
    double clock;               ///< added to the kept times [s]
    size_t n, room;             ///< records kept
    double *time, *slip, *rate; ///< [room]
    bool begun;
    lac_record first, last;
    bool saved;      ///< a checkpoint was made
    double saved_at; ///< the time of the last one [s]
} cli_history;

/// The sink; valid while `history` stays where it is.
lac_sink cli_history_sink(cli_history *history);

/// What was kept.
lac_history cli_history_view(const cli_history *history);

void cli_history_clear(cli_history *history);

#endif
