// SPDX-License-Identifier: GPL-3.0-or-later
// The choice of a model, `{MODEL: {parameters}}`, and lists of such choices, read from a case.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case/schema.h"

enum { MAX_MODELS = 64 };

static size_t model_names(const lac_kind *kind, const char **names)
{
    size_t n = 0;
    while (n < MAX_MODELS && kind->at(n) != NULL) {
        names[n] = kind->at(n)->name;
        n++;
    }
    return n;
}

const lac_descriptor *lac_find_model(lac_reader *reader, const lac_node *node, int kind,
                                     const char *what)
{
    const char *names[MAX_MODELS];
    const lac_kind *models = lac_kind_at((size_t)kind);
    size_t n = model_names(models, names);
    for (size_t i = 0; i < n; i++) {
        if (strcmp(names[i], node->key) == 0) {
            return models->at(i);
        }
    }
    lac_blame_unknown(reader, node, what, names, n);
    return NULL;
}

// "must be {MODEL: {...}} with one model of: a, b"
static void blame_shape(lac_reader *reader, const lac_node *node, int kind)
{
    const char *names[MAX_MODELS];
    char list[300] = "";
    size_t n = model_names(lac_kind_at((size_t)kind), names);
    for (size_t i = 0; i < n; i++) {
        size_t used = strlen(list);
        (void)snprintf(list + used, sizeof list - used, "%s%s", i == 0 ? "" : ", ", names[i]);
    }
    lac_blame(reader, node, "must be {MODEL: {...}} where MODEL is one of: %s", list);
}

// The one model that a mapping names; NULL, and reported, where it isn't one.
static const lac_node *chosen_model(lac_reader *reader, const lac_node *node, int kind,
                                    const char *own, const lac_descriptor **about)
{
    const lac_node *chosen = NULL;
    bool good = true;
    for (size_t i = 0; node->kind == LAC_NODE_MAP && i < node->count; i++) {
        const lac_node *child = node->child[i];
        if (child->ignored || (own != NULL && strcmp(child->key, own) == 0)) {
            continue;
        }
        const lac_descriptor *model = lac_find_model(reader, child, kind, "model");
        if (model == NULL) {
            good = false;
        } else if (chosen != NULL) {
            lac_blame(reader, child, "is a second model beside %s; exactly one is allowed",
                      chosen->key);
            good = false;
        } else {
            chosen = child;
            *about = model;
        }
    }
    if (good && chosen == NULL) {
        blame_shape(reader, node, kind);
    }
    return good ? chosen : NULL;
}

// The only parameter that must be given, if it is one: its value may stand for the mapping.
static const lac_param *single_required(const lac_descriptor *about)
{
    const lac_param *found = NULL;
    for (size_t i = 0; i < about->param_count; i++) {
        if (lac_param_required(&about->params[i])) {
            if (found != NULL) {
                return NULL;
            }
            found = &about->params[i];
        }
    }
    return found;
}

static void read_params(lac_reader *reader, const lac_node *node, const lac_slot *slot)
{
    static const lac_node nothing = {.kind = LAC_NODE_MAP};
    const lac_table table = {.params = slot->about->params, .count = slot->about->param_count};
    const lac_param *single = single_required(slot->about);
    if (node->kind == LAC_NODE_MAP) {
        lac_read_table(reader, node, &table, slot->params);
    } else if (node->kind == LAC_NODE_SCALAR && single != NULL) {
        (void)lac_read_param(reader, node, single, slot->params);
    } else if (lac_node_is_null(node) && single == NULL) {
        lac_node empty = nothing;
        empty.parent = node->parent;
        empty.key = node->key;
        empty.line = node->line;
        lac_read_table(reader, &empty, &table, slot->params);
    } else {
        lac_blame(reader, node, "must be a mapping of the parameters of %s", slot->about->name);
    }
}

void lac_read_slot(lac_reader *reader, const lac_node *node, int kind, const char *own,
                   lac_slot *slot)
{
    const lac_descriptor *about = NULL;
    size_t errors = reader->report->errors;
    const lac_node *model = chosen_model(reader, node, kind, own, &about);
    if (model == NULL) {
        return;
    }
    if (lac_slot_create(about, slot, NULL) != LAC_OK) {
        reader->no_memory = true;
        return;
    }
    read_params(reader, model, slot);
    const char *fault = reader->report->errors == errors && about->fault != NULL
                            ? about->fault(slot->params)
                            : NULL;
    if (fault != NULL) {
        lac_blame(reader, model, "%s", fault);
    }
    if (reader->report->errors > errors) {
        lac_slot_clear(slot);
    }
}

void lac_read_slots(lac_reader *reader, const lac_node *node, int kind, lac_slot_list *list)
{
    if (node->kind != LAC_NODE_LIST) {
        const lac_kind *models = lac_kind_at((size_t)kind);
        lac_blame(reader, node, "must be a list such as [{%s: {...}}]", models->at(0)->name);
        return;
    }
    list->item = calloc(node->count > 0 ? node->count : 1, sizeof *list->item);
    if (list->item == NULL) {
        reader->no_memory = true;
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        lac_slot *slot = &list->item[list->count];
        lac_read_slot(reader, node->child[i], kind, NULL, slot);
        list->count += slot->about != NULL ? 1 : 0;
    }
}
