/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdbool.h>
#include <stddef.h>

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

struct lac_reader;

/// Reads YAML into nodes. What is wrong goes into the reader's report.
/// @param place  NULL: the text is a whole file; else a --set value, to be blamed on this key
/// @return the root; NULL where there is none or the text cannot be read on (then reported)
lac_node *lac_tree_parse(struct lac_reader *reader, const char *text, size_t size,
                         const char *place);

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
