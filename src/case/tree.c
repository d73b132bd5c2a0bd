// SPDX-License-Identifier: GPL-3.0-or-later
// The values of a case file as a tree, in which each knows its line and its dotted key.
#include "case/tree.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char *copy(const char *text, size_t size)
{
    char *to = malloc(size + 1);
    if (to != NULL) {
        memcpy(to, text, size);
        to[size] = '\0';
    }
    return to;
}

// The array grows whenever its count is a power of two.
static bool append(lac_node *parent, lac_node *node)
{
    size_t n = parent->count;
    if ((n & (n - 1)) == 0) {
        lac_node **grown = realloc(parent->child, (n == 0 ? 1 : 2 * n) * sizeof(lac_node *));
        if (grown == NULL) {
            return false;
        }
        parent->child = grown;
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
    node->key = key == NULL ? NULL : copy(key, strlen(key));
    node->text = text == NULL ? NULL : copy(text, text_size);
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

static size_t index_of(const lac_node *node)
{
    size_t i = 0;
    while (node->parent->child[i] != node) {
        i++;
    }
    return i;
}

const char *lac_node_path(const lac_node *node, char *text, size_t size)
{
    const lac_node *chain[LAC_TREE_DEPTH + 2];
    size_t n = 0;
    for (; node != NULL && node->parent != NULL && n < LAC_TREE_DEPTH + 2; node = node->parent) {
        chain[n++] = node;
    }
    size_t used = 0;
    text[0] = '\0';
    while (n-- > 0 && used < size) {
        const char *dot = used == 0 ? "" : ".";
        int wrote = chain[n]->key != NULL
                        ? snprintf(text + used, size - used, "%s%.60s", dot, chain[n]->key)
                        : snprintf(text + used, size - used, "%s%zu", dot, index_of(chain[n]));
        used += wrote > 0 ? (size_t)wrote : 0;
    }
    return text;
}
