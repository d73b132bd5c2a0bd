/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_EVENTS_H
#define LACUNA_STORE_EVENTS_H

#include "lacuna/store.h"

/// Numbers of a variable, missing ones NaN.
typedef struct lac_stored_values {
    double *value; ///< [n][width]; owned; NULL: the file has no such variable
    size_t n;      ///< along its first dimension; 1 where it has none
    size_t width;  ///< all others multiplied
} lac_stored_values;

/// Reads a whole variable of a file of Lacuna, of any dimensions: the catalogue of events, the
/// blocks of levels. One that is not there is no error.
/// @param out  cleared by the caller
/// @return LAC_OK; LAC_EIO (not a Lacuna file, damaged); LAC_ENOMEM
lac_status lac_store_read_values(const char *path, const char *variable, lac_stored_values *out,
                                 lac_error *err);

/// The same of one place along the first dimension: the cells of a snapshot.
/// @param row  from 0
/// @param out  n is 1; cleared by the caller
/// @return as lac_store_read_values; LAC_EINPUT (no such row)
lac_status lac_store_read_row(const char *path, const char *variable, size_t row,
                              lac_stored_values *out, lac_error *err);

/// The comment of a variable, which says how it is defined; "" where there is none, or where it is
/// longer than the room for it.
void lac_store_read_comment(const char *path, const char *variable, char *text, size_t size);

/// Frees the values; nothing read is fine.
void lac_stored_values_clear(lac_stored_values *values);

#endif
