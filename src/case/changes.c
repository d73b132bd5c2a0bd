// SPDX-License-Identifier: GPL-3.0-or-later
// What differs between two cases: the trees of their resolved texts, walked together.
#include "case/sections.h"

typedef struct walk {
    lac_case_change *change;
    void *context;
} walk;

// A value in a few words: of a list or a mapping its first key.
static const char *words_of(const lac_node *node, char *text, size_t size)
{
    const char *first = node != NULL && node->count > 0 ? node->child[0]->key : NULL;
    (void)snprintf(text, size, "%.90s%s",
                   node == NULL                    ? ""
                   : node->kind == LAC_NODE_SCALAR ? node->text
                   : first != NULL                 ? first
                   : node->count > 0               ? "[...]"
                                                   : "[]",
                   first != NULL ? ": ..." : "");
    return text;
}

static void tell(const walk *w, const lac_node *before, const lac_node *after)
{
    char key[LAC_KEY_LENGTH], then[100], now[100];
    (void)lac_node_path(after != NULL ? after : before, key, sizeof key);
    w->change(w->context, key, words_of(before, then, sizeof then),
              words_of(after, now, sizeof now));
}

// What is at the place of the child of a mapping or list in another one; NULL: nothing.
static const lac_node *twin(const lac_node *child, size_t index, const lac_node *other)
{
    return child->key != NULL     ? lac_node_child(other, child->key)
           : index < other->count ? other->child[index]
                                  : NULL;
}

static void compare(const walk *w, const lac_node *before, const lac_node *after) // no deeper than
{                                                                                 // LAC_TREE_DEPTH
    if (before->kind != after->kind || before->kind == LAC_NODE_SCALAR) {
        if (before->kind != after->kind || strcmp(before->text, after->text) != 0) {
            tell(w, before, after);
        }
        return;
    }
    for (size_t i = 0; i < before->count; i++) {
        const lac_node *other = twin(before->child[i], i, after);
        if (other != NULL) {
            compare(w, before->child[i], other);
        } else {
            tell(w, before->child[i], NULL);
        }
    }
    for (size_t i = 0; i < after->count; i++) {
        if (twin(after->child[i], i, before) == NULL) {
            tell(w, NULL, after->child[i]);
        }
    }
}

lac_status lac_case_compare(const lac_case *before, const lac_case *after, lac_case_change *change,
                            void *context, lac_error *err)
{
    const lac_case *const cases[] = {before, after};
    const walk w = {change, context};
    lac_node *root[2] = {NULL, NULL};
    lac_case_issues report = {0};
    lac_reader reader = {.report = &report};
    for (size_t i = 0; i < 2; i++) {
        char *text = lac_case_text(cases[i]);
        reader.name = cases[i]->path;
        root[i] = text != NULL ? lac_tree_parse(&reader, text, strlen(text), NULL) : NULL;
        free(text);
    }
    const bool good = root[0] != NULL && root[1] != NULL;
    if (good) {
        compare(&w, root[0], root[1]);
    }
    lac_node_free(root[0]);
    lac_node_free(root[1]);
    lac_case_issues_clear(&report);
    return good ? LAC_OK : lac_fail_memory(err);
}
