/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/nearest.h"
#include "base/units.h"
#include "case/case.h"
#include "case/tree.h"

enum {
    LAC_KEY_LENGTH = 200,  ///< of a dotted key in a message
    LAC_MOST_ISSUES = 100, ///< a case with more is told so
};

/// What every part of the reader needs.
typedef struct lac_reader {
    const char *name; ///< of the file, in messages
    lac_case_purpose purpose;
    const lac_units *units;
    lac_case_issues *report;
    const lac_node *root;
    bool no_memory; ///< something could not be kept: the reading fails at its end
} lac_reader;

/// Reports an error at a node, with its dotted key and, of a scalar, its value.
void lac_add_error(lac_reader *reader, const lac_node *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Reports an error at a dotted key where there is one: its line, or that of the nearest node
/// above.
/// @return wrong
bool lac_refuse(lac_reader *reader, bool wrong, const char *key, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Reports a warning at a dotted key.
void lac_warn(lac_reader *reader, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Reports an error of the text as such.
/// @param place  the key of a --set; NULL: the file
void lac_add_error_text(lac_reader *reader, size_t line, const char *place, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Reports a key or model that is none of the known ones, naming the nearest or all of them.
/// @param what  "key", "model" ...
void lac_add_error_unknown(lac_reader *reader, const lac_node *node, const char *what,
                           const char *const *known, size_t count);

/// Puts the issues in the order of the file; those of --set come last.
void lac_case_issues_sort(lac_case_issues *report);

/// Appends "a, b, c" to a list.
void lac_append_names(char *list, size_t size, const char *const *names, size_t count);

/// A copy of a text; NULL, and the reader knows, where memory is short.
char *lac_reader_copy(lac_reader *reader, const char *text, size_t size);
