/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/units.h"
#include "forecast/verdict.h"

// What `lacuna watch` is told of its stations: a small file in the manner of a case.

/// A file that grows, of one station.
typedef struct lac_fleet_file {
    char *station, *path;
} lac_fleet_file;

/// Who may have sent what comes on the stream before.
typedef enum lac_fleet_stream {
    LAC_STREAM_LIVE = 0, ///< nobody: it begins with what is new
    LAC_STREAM_REPLAYED, ///< the sender begins anew at each start
} lac_fleet_stream;

typedef struct lac_fleet {
    char *path;
    char *station, *time, *time_format; ///< names of columns; NULL: "station", "time", ISO or s
    char *clock;                        ///< of the time of day; NULL: `time` has it
    char *displacement, *displacement_unit;
    char *sigma, *sigma_unit;
    size_t columns;
    char **column; ///< [columns] in the order of the lines; 0: a header names them
    int64_t most;  ///< stations at most
    int64_t window_count;
    double window_time; ///< [s]; INFINITY
    double ahead;       ///< of the clock, that a date may be [s]; INFINITY
    char *smooth, *onset;
    size_t smooth_line, onset_line;
    int raw;
    lac_levels levels; ///< its horizon is that of alarms
    char *prometheus;
    int64_t checkpoint_lines;
    double checkpoint_time; ///< [s]
    int stream;             ///< lac_fleet_stream
    size_t files;
    lac_fleet_file *file; ///< [files]
    char *files_pattern;  ///< a path with one *, which stands for the station; NULL
} lac_fleet;

/// Reads and checks it.
/// @return LAC_OK; LAC_EINPUT (the first error with its line and key); LAC_EIO; LAC_ENOMEM
lac_status lac_fleet_read(const char *path, const lac_units *units, lac_fleet **out,
                          lac_error *err);
void lac_fleet_free(lac_fleet *fleet);

/// Whether a name is that of a pattern with one *. @param star  what it stands for
bool lac_fleet_matches(const char *pattern, const char *name, size_t *star, size_t *length);
