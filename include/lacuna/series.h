/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SERIES_H
#define LACUNA_SERIES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "lacuna/error.h"
#include "lacuna/linkage.h"

LAC_BEGIN_C

enum { LAC_SERIES_DOUBTS = 10, LAC_SERIES_DOUBT_TEXT = 160 };

/// How a monitoring file is read; from lac_series_def_default. Texts are borrowed.
typedef struct lac_series_def {
    size_t size; ///< of this structure, as the default has it
    const char *path;
    const char *time;              ///< name of the time column; NULL: the first, in netCDF "time"
    const char *time_format;       ///< how its times are written; NULL: ISO 8601, else seconds
    const char *displacement;      ///< column name; NULL: none
    const char *displacement_unit; ///< as UDUNITS reads it; NULL: m
    const char *velocity;          ///< column name; NULL: none
    const char *velocity_unit;     ///< NULL: m/s
    const char *sigma;             ///< column of a displacement's standard error; NULL: none
    const char *sigma_unit;        ///< NULL: m
    const char *value;             ///< column of any other quantity; NULL: none
    const char *value_unit;        ///< NULL: value_si
    const char *value_si;          ///< SI unit of what is kept
    const char *clock;             ///< column of the time of day where dates have their own; NULL
    const char *components;        ///< "e:mm,n:mm,u:mm", instead of displacement; NULL: none
    const char *line_of_sight;  ///< "E,N,U", that they are projected on; NULL: the main direction
    int64_t skip;               ///< lines before the header that are read over; 0: it is found
    const char *velocity_sigma; ///< column of the error of a velocity's logarithm; NULL: none
    const char *velocity_sigma_unit; ///< NULL: 1
    const char *velocity_most;       ///< column of what a velocity did not exceed; NULL: none
    const char *velocity_most_unit;  ///< NULL: m/s
    const char *within;              ///< column of how far a time may be off; NULL: none
    const char *within_unit;         ///< NULL: s
} lac_series_def;

/// The first column as time; the others are the caller's.
static inline lac_series_def lac_series_def_default(void)
{
    lac_series_def def = LAC_ZEROS;
    def.size = sizeof def;
    return def;
}

/// A monitoring series, in the order of time. Only the library makes it: it may grow at its end.
typedef struct lac_series {
    size_t n;
    bool dated;                ///< times are seconds since 1970 UTC; else seconds as written
    double *time;              ///< [n] strictly increasing [s]
    double *displacement;      ///< [n] [m], NaN where not given; NULL where no column was asked for
    double *velocity;          ///< [n] [m/s], same
    double *value;             ///< [n] [value_si], same
    double *sigma;             ///< [n] [m], > 0, NaN where not given; NULL where not asked for
    size_t *line;              ///< [n] line of the file
    char *attribution;         ///< the file's leading comment lines, joined; may be ""
    size_t missing;            ///< readings that were NA
    size_t duplicates;         ///< readings dropped because their time had been seen
    size_t disordered;         ///< rows earlier than the row before them
    size_t conflicts;          ///< duplicates whose value differs from the one that is kept
    double displacement_digit; ///< least difference of two displacements: what the last digit
                               ///< counts or the step that the sensor counts in [m]; 0: not known
    double velocity_digit;     ///< the same of a velocity [m/s]
    double time_unit;          ///< of what the file counts time in [s]; 0: dates
    char time_name[16];        ///< its name, "day"; of dates "UTC" if they say a zone; else ""
    size_t doubts;             ///< what was taken for want of a word, and should be asked about
    char doubt[LAC_SERIES_DOUBTS][LAC_SERIES_DOUBT_TEXT];
    double *component[3];        ///< [n] that the displacement was made of [m]; NULL: none
    double direction[3];         ///< that they were projected on
    bool sighted;                ///< that was named; else it is the main direction of the motion
    bool projected;              ///< the last doubt says so
    size_t first;                ///< reading that the displacement counts from
    double *displacement_digits; ///< [n] what the last digit of each counts [m]; NULL: not known
    double *velocity_digits;     ///< [n] the same [m/s]
    double *velocity_sigma;      ///< [n] [1], NaN where not given; NULL where not asked for
    double *velocity_most;       ///< [n] [m/s], same
    double *within;              ///< [n] [s], same
} lac_series;

/// Reads a CSV file with a header: comma, semicolon, tab or blanks, decimal comma where these are
/// no commas, BOM, CRLF, Latin-1, `#` comments, quoted fields, NA / NaN / empty / - for a missing
/// value. The header is the first line that names all columns asked for, with their names or these
/// without the unit in brackets that they end in, which is theirs where none is named; rows of
/// units may follow. Times are ISO 8601 (without zone: UTC) or seconds, unless `time_format` says
/// otherwise: "unix", "excel", "decimal-year", a pattern such as "%d/%m/%Y %H:%M" (without a day:
/// the middle of the month), or a unit of time ("day", "hours since 2015-06-07"). Components make
/// one displacement, from the first reading that has all: along a line of sight, or along the
/// direction in which they spread most. Or a netCDF file
/// (known by its first bytes): columns are variables of one dimension that they share, times CF
/// ("days since 2015-06-07") or a time unit; `units` of the file go before those given here,
/// `_FillValue` and NaN are missing. Refused, since it is not what it seems: a column without a
/// unit whose name ends in another one than would be taken ("disp_mm" as metres, "day" as seconds);
/// bare numbers that seem to be years, days of Excel or numbers of rows; thousands with marks;
/// numbers made of nines that stand more than once, further from all others than these are from
/// one another (-9999: a logger's word for no value); a file of which more than a tenth of the rows
/// (and more than one) repeat a time with another value.
/// @return LAC_OK; LAC_EIO; LAC_EINPUT with file, line, column, the value, what is allowed;
///         LAC_ENOMEM
lac_status lac_series_create(const lac_series_def *def, lac_series **out, lac_error *err);

/// Frees a series; NULL is fine.
void lac_series_free(lac_series *series);

/// How velocities come from displacements. None looks ahead.
typedef enum lac_smoothing {
    LAC_SMOOTH_NONE = 0, ///< as given; else secants between readings, at the middle of the interval
    LAC_SMOOTH_AVERAGE,  ///< means of the last `points` of these, at the mean of their times
    LAC_SMOOTH_WINDOW,   ///< least-squares slope of the readings of the last `window` seconds, at
                         ///< the mean of their times
    LAC_SMOOTH_SAVGOL,   ///< slope at its end of the polynomial of `order` through the last
                         ///< `points` readings (Savitzky-Golay with the window behind)
} lac_smoothing;

LAC_END_C

#endif
