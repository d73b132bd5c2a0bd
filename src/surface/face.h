/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SURFACE_FACE_H
#define LACUNA_SURFACE_FACE_H

#include "surface/surface.h"

/// A file of measured heights, and what a case says of it.
typedef struct lac_face_def {
    const char *path;
    const char *unit, *lateral_unit;   ///< NULL, or what the file must not contradict
    const char *other, *other_lateral; ///< used where the file and those above say nothing; NULL: m
    double spacing;                    ///< [m]; NaN: not given
    double other_spacing;              ///< used where the file and `spacing` say nothing
    int nodata;                        ///< LAC_NODATA_...
} lac_face_def;

/// Reads a file and brings it to metres; fills what has no height as `nodata` says.
/// @param map     lengths and heights in metres; set on success, the caller frees it
/// @param report  what was read, but for `fit`
/// @return as lac_height_map_read; LAC_EINPUT where units are wrong or contradict each other
lac_status lac_face_read(const lac_face_def *def, lac_height_map **map, lac_file_report *report,
                         lac_error *err);

#endif
