/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// Rows of parameter tables in a line or two: the key stands first, what it says of itself last.
// Each is named after the type that it makes. `where` is the offset in the struct, `bits` are
// LAC_OPTIONAL | ...; a fallback of NAN: it must be given, unless LAC_OPTIONAL.

#include "base/param.h"

// clang-format off
#define LAC_REAL(name, si, where, absent, low, high, bits, text)                                  \
    {.key = (name), .unit = (si), .fallback = (absent), .min = (low), .max = (high),              \
     .offset = (where), .flags = (bits), .doc = (text)}

#define LAC_INTEGER(name, where, absent, low, high, bits, text)                                   \
    {.key = (name), .unit = "1", .fallback = (absent), .min = (low), .max = (high),               \
     .offset = (where), .flags = (bits), .doc = (text), .type = LAC_INTEGER}

/// A seed: whole numbers that a double tells from their neighbours.
#define LAC_SEED(where, absent, bits, text)                                                       \
    LAC_INTEGER("seed", where, absent, 0, 9007199254740991, bits, text)

#define LAC_CHOICE(name, where, absent, words, bits, text)                                        \
    {.key = (name), .unit = "1", .fallback = (absent), .choices = (words), .offset = (where),     \
     .flags = (bits), .doc = (text), .type = LAC_CHOICE}

#define LAC_TEXT(name, where, bits, text)                                                         \
    {.key = (name), .unit = "1", .fallback = NAN, .offset = (where), .flags = (bits),             \
     .doc = (text), .type = LAC_TEXT}

#define LAC_PATH(name, where, bits, text)                                                         \
    {.key = (name), .unit = "1", .fallback = NAN, .offset = (where), .flags = (bits),             \
     .doc = (text), .type = LAC_PATH}

/// What a descriptor says of its table of rows, whose offsets are in `holder`.
#define LAC_ROWS(rows, holder)                                                                    \
    .params = (rows), .param_count = sizeof(rows) / sizeof(rows)[0], .params_size = sizeof(holder)

/// A descriptor; behind what all say of themselves LAC_ROWS, .validate ...
#define LAC_ABOUT(title, text, source, ...)                                                       \
    {.name = (title), .summary = (text), .reference = (source), __VA_ARGS__}

/// What a list of rows, `#define LIST(_) _(a), _(b)`, is asked for: to declare them, `extern const
/// TYPE LIST(LAC_ROW_ITSELF);`, and for their table, `{LIST(LAC_ROW_ADDRESS)}`.
#define LAC_ROW_ITSELF(row)  row
#define LAC_ROW_ADDRESS(row) &row

/// Defines the function that gives the index-th of a list of pointers to rows, or of rows; NULL past
/// the end.
#define LAC_KINDS_AT(type, name, list)                                                            \
    const type *name(size_t index)                                                                \
    {                                                                                             \
        return index < sizeof(list) / sizeof *(list) ? (list)[index] : NULL;                      \
    }
#define LAC_ROWS_AT(type, name, list)                                                             \
    const type *name(size_t index)                                                                \
    {                                                                                             \
        return index < sizeof(list) / sizeof *(list) ? &(list)[index] : NULL;                     \
    }
// clang-format on
