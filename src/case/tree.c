// SPDX-License-Identifier: GPL-3.0-or-later
// The values of a case file as a tree, in which each knows its line and its dotted key; and a
// `--set KEY=VALUE`, whose value is put into the tree as if the file had held it.
#include "case/sections.h"

static bool append(lac_node *parent, lac_node *node)
{
    if (lac_grow((void *)&parent->child, &parent->room, parent->count + 1, sizeof(lac_node *),
                 NULL) != LAC_OK) {
        return false;
    }
    parent->child[parent->count++] = node;
    node->parent = parent;
    return true;
}

lac_node *lac_node_create(lac_node *parent, lac_node_kind kind, const char *key, const char *text,
                          size_t text_size)
{
    lac_node *node = calloc(1, sizeof *node);
    if (node == NULL) {
        return NULL;
    }
    node->kind = kind;
    node->plain = true;
    node->key = key == NULL ? NULL : strdup(key);
    node->text = text == NULL ? NULL : strndup(text, text_size);
    bool whole = (key == NULL || node->key != NULL) && (text == NULL || node->text != NULL);
    if (!whole || (parent != NULL && !append(parent, node))) {
        lac_node_free(node);
        return NULL;
    }
    return node;
}

void lac_node_free(lac_node *node)
{
    if (node == NULL) {
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        lac_node_free(node->child[i]);
    }
    free(node->child);
    free(node->key);
    free(node->text);
    free(node);
}

lac_node *lac_node_child(const lac_node *node, const char *key)
{
    if (node == NULL || node->kind != LAC_NODE_MAP) {
        return NULL;
    }
    for (size_t i = 0; i < node->count; i++) {
        if (!node->child[i]->ignored && strcmp(node->child[i]->key, key) == 0) {
            return node->child[i];
        }
    }
    return NULL;
}

lac_node *lac_node_at(const lac_node *root, const char *path)
{
    const lac_node *at = root;
    while (at != NULL && *path != '\0') {
        char key[64];
        size_t n = strcspn(path, ".");
        if (n >= sizeof key) {
            return NULL;
        }
        memcpy(key, path, n);
        key[n] = '\0';
        if (at->kind == LAC_NODE_LIST) {
            bool number = key[0] != '\0' && key[strspn(key, "0123456789")] == '\0';
            size_t index = (size_t)strtoul(key, NULL, 10);
            at = number && index < at->count ? at->child[index] : NULL;
        } else {
            at = lac_node_child(at, key);
        }
        path += n + (path[n] == '.' ? 1 : 0);
    }
    return (lac_node *)at;
}

bool lac_node_is_null(const lac_node *node)
{
    if (node->kind != LAC_NODE_SCALAR || !node->plain) {
        return false;
    }
    return node->text[0] == '\0' || strcmp(node->text, "~") == 0 || strcmp(node->text, "null") == 0;
}

const char *lac_node_path(const lac_node *node, char *text, size_t size)
{
    const lac_node *chain[LAC_TREE_DEPTH + 2];
    size_t n = 0;
    for (; node != NULL && node->parent != NULL && n < LAC_TREE_DEPTH + 2; node = node->parent) {
        chain[n++] = node;
    }
    text[0] = '\0';
    while (n-- > 0) {
        const char *dot = text[0] == '\0' ? "" : ".";
        size_t index = 0;
        while (chain[n]->key == NULL && chain[n]->parent->child[index] != chain[n]) {
            index++;
        }
        if (chain[n]->key != NULL) {
            lac_append(text, size, "%s%.60s", dot, chain[n]->key);
        } else {
            lac_append(text, size, "%s%zu", dot, index);
        }
    }
    return text;
}

static bool is_index(const char *part)
{
    size_t n = strspn(part, "0123456789");
    return n > 0 && n < 6 && part[n] == '\0';
}

// Where in its parent a part of the key points: an existing node, or one past the last.
// Returns false, reported, where it can point nowhere.
static bool locate(lac_reader *reader, const lac_override *override, const lac_node *parent,
                   const char *part, size_t *at)
{
    if (parent->kind == LAC_NODE_MAP) {
        for (*at = 0; *at < parent->count; (*at)++) {
            if (!parent->child[*at]->ignored && strcmp(parent->child[*at]->key, part) == 0) {
                return true;
            }
        }
        if (parent->count < LAC_TREE_KEYS) {
            return true;
        }
    } else if (parent->kind == LAC_NODE_LIST && is_index(part)) {
        *at = (size_t)strtoul(part, NULL, 10);
        if (*at <= parent->count) {
            return true;
        }
        lac_add_error_text(reader, 0, override->key, "names item %s of a list of %zu", part,
                           parent->count);
        return false;
    }
    lac_add_error_text(reader, 0, override->key, "names \"%.60s\" below %s", part,
                       parent->kind == LAC_NODE_LIST ? "a list, whose items are numbers from 0"
                                                     : "a value, which has no keys");
    return false;
}

// The child that a part of the key names, made where it is missing.
static lac_node *descend(lac_reader *reader, const lac_override *override, lac_node *parent,
                         const char *part)
{
    size_t at;
    if (lac_node_is_null(parent)) { // it becomes what its next key needs
        parent->kind = is_index(part) ? LAC_NODE_LIST : LAC_NODE_MAP;
    }
    if (!locate(reader, override, parent, part, &at)) {
        return NULL;
    }
    if (at < parent->count) {
        return parent->child[at];
    }
    const char *key = parent->kind == LAC_NODE_MAP ? part : NULL;
    lac_node *node = lac_node_create(parent, LAC_NODE_SCALAR, key, "", 0);
    reader->no_memory = reader->no_memory || node == NULL;
    return node;
}

// Gives a node the contents of another, which is freed; key and place stay.
static void replace(lac_node *node, lac_node *by)
{
    lac_node old = *node;
    node->kind = by->kind;
    node->text = by->text;
    node->plain = by->plain;
    node->bad = by->bad;
    node->line = 0;
    node->count = by->count;
    node->child = by->child;
    for (size_t i = 0; i < node->count; i++) {
        node->child[i]->parent = node;
    }
    by->text = old.text;
    by->count = old.count;
    by->child = old.child;
    lac_node_free(by);
}

static size_t depth_below(const lac_node *node)
{
    size_t deepest = 0;
    for (size_t i = 0; i < node->count; i++) {
        size_t depth = 1 + depth_below(node->child[i]);
        deepest = depth > deepest ? depth : deepest;
    }
    return deepest;
}

void lac_apply_override(lac_reader *reader, lac_node *root, const lac_override *override)
{
    size_t errors = reader->report->errors;
    const char *path = override->key;
    char part[64];
    lac_node *value =
        lac_tree_parse(reader, override->value, strlen(override->value), override->key);
    if (value == NULL && reader->report->errors == errors && !reader->no_memory) {
        value = lac_node_create(NULL, LAC_NODE_SCALAR, NULL, "", 0);
        reader->no_memory = value == NULL;
    }
    if (value == NULL) {
        return;
    }
    lac_node *at = root;
    size_t depth = depth_below(value);
    do {
        const size_t n = strcspn(path, ".");
        if (n == 0 || n >= sizeof part || strcmp(path + n, ".") == 0 || ++depth >= LAC_TREE_DEPTH) {
            lac_add_error_text(reader, 0, override->key,
                               "is no dotted key such as friction.aging.dc");
            at = NULL;
            break;
        }
        memcpy(part, path, n);
        part[n] = '\0';
        at = descend(reader, override, at, part);
        path += n + (path[n] == '.' ? 1 : 0);
    } while (at != NULL && *path != '\0');
    if (at == NULL) {
        lac_node_free(value);
        return;
    }
    replace(at, value);
}
