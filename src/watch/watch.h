/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/fleet.h"
#include "forecast/forecast.h"

// Readings of many stations as they come, and a line of JSON for each: the forecasts of
// lac_forecast_set_create from what is known of its station by then. Nothing here reads a clock:
// lac_watch_clock tells it.

typedef struct lac_watch_def {
    const lac_fleet *fleet; ///< outlives the watch
    const lac_units *units; ///< the same
    lac_forecast_def forecast;
    const char *state;  ///< folder; NULL: none is kept
    const char *output; ///< file; NULL: `out`
    bool force;         ///< replaces a file that is there, where no state goes on from it
    FILE *out;
    bool (*stop)(void *context); ///< asked with NULL between files; NULL: never
} lac_watch_def;

/// What was taken, since the beginning of the state.
typedef struct lac_watch_counts {
    uint64_t lines;    ///< of standard input
    uint64_t readings; ///< that were new to a station
    uint64_t late;     ///< of which came behind a later one
    uint64_t doubled, old, ahead, bad;
    size_t stations;
    uint64_t restored; ///< lines that were done again from the journal
    double memory;     ///< that the stations may take at most [bytes]
} lac_watch_counts;

typedef struct lac_watch lac_watch;

/// Begins, or goes on from the state: the output is cut to what the state knows of it, and lines
/// that were taken since are done again from the journal.
/// @return LAC_OK; LAC_EINPUT (the state is of other settings; the output exists, or is not that of
///         the state; a column is missing); LAC_EIO (also where another holds the state);
///         LAC_ENOMEM
lac_status lac_watch_create(const lac_watch_def *def, lac_watch **out, lac_error *err);
void lac_watch_free(lac_watch *watch);

/// Tells what the time is, in seconds since 1970 UTC: of what is taken from here on, dates that are
/// further ahead than the fleet says are dropped. Until it is told none is.
void lac_watch_clock(lac_watch *watch, double now);

/// Takes bytes of standard input, cut anywhere; a line without its end waits.
/// @return LAC_OK; LAC_EINPUT (no line can be read; not the stream that the state is of); LAC_EIO;
///         LAC_ENOMEM
lac_status lac_watch_stream(lac_watch *watch, const char *bytes, size_t n, lac_error *err);

/// Bytes of the last line that wait for its end.
size_t lac_watch_waiting(const lac_watch *watch);

/// Lines of a replayed stream that the state has and that were not sent again yet.
uint64_t lac_watch_missing(const lac_watch *watch);

/// Whether files are followed; and takes what they have more.
/// @param more  whether there was something
bool lac_watch_follows(const lac_watch *watch);
lac_status lac_watch_poll(lac_watch *watch, bool *more, lac_error *err);

/// Whether so many lines came since the last checkpoint as the fleet says; whether any did.
bool lac_watch_is_due(const lac_watch *watch);
bool lac_watch_has_news(const lac_watch *watch);

/// Makes what was put out, and then the state, stand on the disk.
lac_status lac_watch_checkpoint(lac_watch *watch, lac_error *err);

/// Writes the file for Prometheus, where the fleet names one.
lac_status lac_watch_tell(lac_watch *watch, lac_error *err);

lac_watch_counts lac_watch_count(const lac_watch *watch);
