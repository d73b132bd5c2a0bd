/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_STORE_STORE_EVENTS_H
#define LACUNA_STORE_STORE_EVENTS_H

#include "store/store.h"

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

/// Frees the values; nothing read is fine.
void lac_stored_values_clear(lac_stored_values *values);

#endif
