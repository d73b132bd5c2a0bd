/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_FIELD_FILE_H
#define LACUNA_TESTS_FIELD_FILE_H

#include <stddef.h>

/// Writes the variable "v" [kPa] over 3 rows and columns from -1 to 13 m, at `times` times from -5
/// s on, 4.3 s apart; 0: one map without times. Stops the program where it cannot.
/// @param values  [times * 9], or [9]
void field_file_write(const char *path, size_t times, const double *values);

#endif
