/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

struct lac_units;

/// A quantity over a plane, at one time or at several, as a netCDF file holds it; SI.
typedef struct lac_field {
    size_t nt;     ///< times; 0: the file has none, and one map
    size_t ny, nx; ///< rows and columns of a map
    double *t;     ///< [nt] rising [s], since 1970 UTC where dated
    bool dated;
    double *y, *x; ///< [ny], [nx] where the values stand, rising [m]
    double *value; ///< [max(nt, 1) * ny * nx] x fastest; NaN where the file has none
} lac_field;

/// Reads a variable over (y, x) or (time, y, x), whose coordinates and units the file names.
/// @param si  unit that the values are to have
/// @return LAC_OK; LAC_EINPUT (says what the file must have); LAC_ENOMEM
lac_status lac_field_read(const char *path, const char *variable, const char *si,
                          const struct lac_units *units, lac_field *out, lac_error *err);

void lac_field_clear(lac_field *field);
