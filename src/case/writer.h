/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CASE_WRITER_H
#define LACUNA_CASE_WRITER_H

#include <stdbool.h>
#include <stddef.h>

/// A text that grows; `failed` once memory was short.
typedef struct lac_writer {
    char *text;
    size_t used, size;
    bool failed;
    size_t folder; ///< length of the folder that relative paths start from
    const char *name;
} lac_writer;

/// Writes at most 511 characters.
void lac_put(lac_writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
