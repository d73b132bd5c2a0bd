/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "series/series.h"

// Lines of a stream of readings of many stations, read as lac_series_read reads a file of one.

/// How they are written; texts are borrowed.
typedef struct lac_line_def {
    const char *path;    ///< what the stream is called in messages
    const char *station; ///< name of the column; NULL: the stream is of one station
    const char *time, *time_format;
    const char *clock; ///< column of the time of day, where dates have one of their own; NULL
    const char *displacement, *displacement_unit;
    const char *sigma, *sigma_unit; ///< NULL: none
    const char *const *order;       ///< [columns] names of the columns, in their order
    size_t columns;                 ///< 0: the first line that is no comment names them
} lac_line_def;

enum { LAC_LINE_STATION = 64, LAC_LINE_TEXT = 160 };

/// What a line came to.
typedef enum lac_line_kind {
    LAC_LINE_NOTHING = 0, ///< blank, a comment or a header
    LAC_LINE_READING,
    LAC_LINE_WRONG, ///< `text` says why
    LAC_LINE_LOST,  ///< the same, of a header: no line of the stream can be read
} lac_line_kind;

/// A reading. Values that are NaN are not there.
typedef struct lac_line {
    char station[LAC_LINE_STATION]; ///< "" where there is none
    bool dated;
    double time, displacement, sigma; ///< SI
    double digit;                     ///< what the last digit of the displacement counts [m]
    char text[LAC_LINE_TEXT];
} lac_line;

typedef struct lac_line_reader lac_line_reader;

/// @return LAC_OK; LAC_EINPUT (a unit or a format that is none, a column that `order` lacks);
///         LAC_ENOMEM
lac_status lac_line_reader_create(const lac_line_def *def, const struct lac_units *units,
                                  lac_line_reader **out, lac_error *err);
void lac_line_reader_free(lac_line_reader *reader);

/// Reads a line, which it takes apart.
/// @param text  without its end
/// @pre   the thread's locale is "C"
lac_line_kind lac_line_read(lac_line_reader *reader, char *text, lac_line *out);

/// The header that was read; NULL while none was.
const char *lac_line_header(const lac_line_reader *reader);
