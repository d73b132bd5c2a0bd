// SPDX-License-Identifier: GPL-3.0-or-later
// The choice of a model, `{MODEL: {parameters}}`, and lists of such choices, read from a case.
#include "case/sections.h"

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

const lac_model_info *lac_find_model(lac_reader *reader, const lac_node *node, int kind,
                                     const char *what)
{
    const char *names[MAX_MODELS];
    const lac_kind *models = lac_kind_get((size_t)kind);
    const lac_model_info *found = lac_model_find(models->name, node->key);
    if (found == NULL) {
        lac_add_error_unknown(reader, node, what, names, model_names(models, names));
    }
    return found;
}

// The one model that a mapping names; NULL, and reported, where it isn't one.
static const lac_node *chosen_model(lac_reader *reader, const lac_node *node, int kind,
                                    const char *own, const lac_model_info **info)
{
    const char *names[MAX_MODELS];
    char list[300] = "";
    const lac_node *chosen = NULL;
    bool good = true;
    for (size_t i = 0; node->kind == LAC_NODE_MAP && i < node->count; i++) {
        const lac_node *child = node->child[i];
        if (child->ignored || (own != NULL && strcmp(child->key, own) == 0)) {
            continue;
        }
        const lac_model_info *named = lac_find_model(reader, child, kind, "model");
        if (named == NULL) {
            good = false;
        } else if (chosen != NULL) {
            lac_add_error(reader, child, "is a second model beside %s; exactly one is allowed",
                          chosen->key);
            good = false;
        } else {
            chosen = child;
            *info = named;
        }
    }
    if (good && chosen == NULL) {
        lac_append_names(list, sizeof list, names, model_names(lac_kind_get((size_t)kind), names));
        lac_add_error(reader, node, "must be {MODEL: {...}} where MODEL is one of: %s", list);
    }
    return good ? chosen : NULL;
}

// The only parameter that must be given, if it is one: its value may stand for the mapping.
static const lac_param *single_required(const lac_model_info *info)
{
    const lac_param *found = NULL;
    for (size_t i = 0; i < info->param_count; i++) {
        if (lac_param_required(&info->params[i])) {
            if (found != NULL) {
                return NULL;
            }
            found = &info->params[i];
        }
    }
    return found;
}

static void read_params(lac_reader *reader, const lac_node *node, const lac_model *model)
{
    const lac_param *single = single_required(model->info);
    if (node->kind == LAC_NODE_MAP) {
        lac_read_table(reader, node, model->info, NULL, model->params);
    } else if (node->kind == LAC_NODE_SCALAR && single != NULL) {
        (void)lac_read_param(reader, node, single, model->params);
    } else if (lac_node_is_null(node) && single == NULL) {
        const lac_node empty = {
            .kind = LAC_NODE_MAP, .parent = node->parent, .key = node->key, .line = node->line};
        lac_read_table(reader, &empty, model->info, NULL, model->params);
    } else {
        lac_add_error(reader, node, "must be a mapping of the parameters of %s", model->info->name);
    }
}

void lac_read_slot(lac_reader *reader, const lac_node *node, int kind, const char *own,
                   lac_model *model)
{
    const lac_model_info *info = NULL;
    size_t errors = reader->report->errors;
    const lac_node *named = chosen_model(reader, node, kind, own, &info);
    if (named == NULL) {
        return;
    }
    if (lac_model_create(info, model, NULL) != LAC_OK) {
        reader->no_memory = true;
        return;
    }
    read_params(reader, named, model);
    const char *fault = reader->report->errors == errors && info->validate != NULL
                            ? info->validate(model->params)
                            : NULL;
    if (fault != NULL) {
        lac_add_error(reader, named, "%s", fault);
    }
    if (reader->report->errors > errors) {
        lac_model_clear(model);
    }
}

void lac_read_slots(lac_reader *reader, const lac_node *node, int kind, lac_model_list *list)
{
    if (node->kind != LAC_NODE_LIST) {
        const lac_kind *models = lac_kind_get((size_t)kind);
        lac_add_error(reader, node, "must be a list such as [{%s: {...}}]", models->at(0)->name);
        return;
    }
    list->item = lac_reader_array(reader, node->count, sizeof *list->item);
    for (size_t i = 0; list->item != NULL && i < node->count; i++) {
        lac_model *model = &list->item[list->count];
        lac_read_slot(reader, node->child[i], kind, NULL, model);
        list->count += model->info != NULL ? 1 : 0;
    }
}
