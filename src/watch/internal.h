/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <locale.h>
#include <sys/types.h>

#include "base/archive.h"
#include "data/json.h"
#include "series/line.h"
#include "watch/watch.h"

/// What became of a reading.
typedef enum lac_taken {
    LAC_TAKEN = 0,
    LAC_TAKEN_LATE,    ///< put before others, or the value of a reading that had none
    LAC_TAKEN_DOUBLED, ///< not: there is one of that time
    LAC_TAKEN_OLD,     ///< not: what is known begins later
    LAC_TAKEN_AHEAD,   ///< not: the clock is not as far
    LAC_TAKINGS,
} lac_taken;

/// A station and what is known of it.
typedef struct lac_station {
    char *name;
    size_t n, room;
    double *time, *displacement, *sigma, *digit; ///< [room], in one piece from `time`
    uint64_t taken[LAC_TAKINGS];                 ///< of each lac_taken; of LAC_TAKEN the late too
    double rate;                                 ///< the last velocity [m/s]; NaN
    int issued, alarms;
    lac_level level;
    double chance; ///< of failure within the horizon; NaN
    bool accelerating;
} lac_station;

typedef struct lac_stations {
    size_t n, room;
    lac_station **at; ///< [n] by name
} lac_stations;

/// The station of a name, made where there is none; NULL where `most` are there.
lac_status lac_stations_find(lac_stations *stations, const char *name, size_t most,
                             lac_station **out, lac_error *err);
void lac_stations_clear(lac_stations *stations);

/// Puts a reading in its place, and drops what is out of the window then.
/// @param latest  a date that is later is not taken; NaN: none is too late
lac_status lac_station_take(lac_station *station, const lac_line *line, const lac_fleet *fleet,
                            double latest, lac_taken *out, lac_error *err);

/// Room for so many readings, at most `count`.
lac_status lac_station_reserve(lac_station *station, size_t n, size_t count, lac_error *err);

/// How far a file was followed.
typedef struct lac_progress {
    ino_t inode;
    int64_t offset; ///< behind the last whole line that was taken
    size_t before;  ///< last bytes before it
    uint64_t tail;  ///< and their sum
    uint64_t lines;
    bool cut; ///< the offset is within a line that is too long
} lac_progress;

/// A file that is followed.
typedef struct lac_followed {
    char *station, *path;
    int fd; ///< -1: closed
    lac_progress at;
    lac_line_reader *reader;
} lac_followed;

struct lac_watch {
    lac_watch_def def;
    locale_t plain;
    FILE *out;
    bool owned;     ///< `out` is the output's own
    uint64_t since; ///< lines since the last checkpoint
    bool opened;    ///< a file began: the state must know which
    bool told;      ///< the file for Prometheus knows all
    bool known, dated;
    double now; ///< seconds since 1970 UTC; NaN: not told
    lac_stations stations;
    lac_watch_counts counts;
    lac_line_reader *reader; ///< of standard input
    uint64_t sum, skip;      ///< of all its lines; those still to be skipped
    uint64_t skipped;        ///< sum of those that were
    char *pending;           ///< the begin of a line
    size_t waiting, room;
    uint64_t generation;
    int lock, journal; ///< -1: none
    size_t files;
    lac_followed *file; ///< [files]
};

enum { LAC_WATCH_LINE = 65536 }; ///< bytes of a line at most, its end included
extern const char lac_watch_too_long[];

/// Takes a whole line of a source.
/// @param station  of the source; NULL: the line names it
/// @param where    for messages; number: of the line
lac_status lac_watch_line(lac_watch *watch, lac_line_reader *reader, const char *station,
                          char *text, const char *where, uint64_t number, lac_error *err);

/// Says in a line of the output what was wrong, and counts it.
void lac_watch_blame(lac_watch *watch, const char *where, uint64_t number, const char *station,
                     const char *why, const char *text);

lac_status lac_watch_reader(const lac_watch *watch, bool of_many, const char *where,
                            lac_line_reader **out, lac_error *err);

/// Opens what is kept: lock, output, state and journal.
lac_status lac_watch_open(lac_watch *watch, lac_error *err);
/// Adds whole lines to the journal, before they are looked at, with the time that it is.
lac_status lac_watch_note(lac_watch *watch, const char *bytes, size_t n, lac_error *err);
/// Empties the journal: what is in it was not taken.
void lac_watch_forget(lac_watch *watch);
/// Hands on what was put out. @param sync  and waits until it is on the disk
lac_status lac_watch_flush(lac_watch *watch, bool sync, lac_error *err);
/// Reads and writes the state; a checksum guards it.
lac_status lac_state_read(lac_watch *watch, const char *path, bool *found, int64_t *output,
                          lac_error *err);
lac_status lac_state_write(lac_watch *watch, const char *path, int64_t output, lac_error *err);

/// Finds the files to follow; those of the state are known before.
lac_status lac_watch_find_files(lac_watch *watch, lac_error *err);
lac_status lac_watch_add_file(lac_watch *watch, const char *station, const char *path,
                              lac_followed **out, lac_error *err);
void lac_watch_close_files(lac_watch *watch);
