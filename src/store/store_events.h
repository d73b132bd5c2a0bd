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

/// Frees the values; nothing read is fine.
void lac_stored_values_clear(lac_stored_values *values);

#endif
