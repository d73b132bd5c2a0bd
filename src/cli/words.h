/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CLI_WORDS_H
#define LACUNA_CLI_WORDS_H

#include <stdbool.h>
#include <stddef.h>

/// The candidate with the fewest letters inserted, dropped, changed or swapped.
/// @param candidates  [count], count >= 1
const char *cli_nearest(const char *word, const char *const *candidates, size_t count);

/// Prints `  label    text` on stdout.
void cli_row(const char *label, const char *format, ...) __attribute__((format(printf, 2, 3)));

/// Prints `  label    value unit` on stdout, the unit chosen to read well.
void cli_row_quantity(const char *label, double value, const char *unit);

/// Prints a text on stdout, wrapped to 79 columns, each line after `indent`.
void cli_wrap(const char *indent, const char *text);

#endif
