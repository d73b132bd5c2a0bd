/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/nearest.h"
#include "base/units.h"
#include "case/case.h"

enum {
    LAC_TREE_DEPTH = 32,    ///< no case is deeper
    LAC_TREE_NODES = 20000, ///< nor larger
    LAC_TREE_KEYS = 256,    ///< nor has a mapping more keys
};

typedef enum lac_node_kind { LAC_NODE_SCALAR = 0, LAC_NODE_LIST, LAC_NODE_MAP } lac_node_kind;

/// A value of a case file and where it stands.
typedef struct lac_node {
    lac_node_kind kind;
    struct lac_node *parent; ///< NULL: the root
    char *key;               ///< in a mapping; NULL elsewhere
    char *text;              ///< of a scalar
    bool plain;              ///< a scalar without quotes
    bool ignored;            ///< a second value of the same key: reported, not read
    bool bad;                ///< reported already: whoever reads it says no more
    size_t line;             ///< 1-based, of the key where there is one; 0: from --set
    size_t count;
    struct lac_node **child; ///< [count]
} lac_node;

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

/// Reads YAML into nodes. What is wrong goes into the reader's report.
/// @param place  NULL: the text is a whole file; else a --set value, to be blamed on this key
/// @return the root; NULL where there is none or the text cannot be read on (then reported)
lac_node *lac_tree_parse(lac_reader *reader, const char *text, size_t size, const char *place);

/// A new node, at the end of its parent where there is one. Owns nothing of `key` and `text`.
/// @return NULL where memory is short
lac_node *lac_node_create(lac_node *parent, lac_node_kind kind, const char *key, const char *text,
                          size_t text_size);

void lac_node_free(lac_node *node);

/// The value of a key of a mapping; NULL where it isn't one or has no such key.
lac_node *lac_node_child(const lac_node *node, const char *key);

/// The node at a dotted key below `root`; NULL where there is none.
lac_node *lac_node_at(const lac_node *root, const char *path);

/// Whether a scalar is YAML's null: nothing, ~ or null.
bool lac_node_is_null(const lac_node *node);

/// The dotted key of a node, list items by index; "" for the root.
const char *lac_node_path(const lac_node *node, char *text, size_t size);

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

/// Room for items, all zero; NULL, and the reader knows, where memory is short.
void *lac_reader_array(lac_reader *reader, size_t count, size_t size);

/// A copy of a text; NULL, and the reader knows, where memory is short.
char *lac_reader_copy(lac_reader *reader, const char *text, size_t size);
