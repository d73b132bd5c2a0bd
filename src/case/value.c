// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of a case by their dotted keys.
#include "case/sections.h"

const char *lac_key_behind(const char *key, const char *part)
{
    size_t n = strlen(part);
    return strncmp(key, part, n) == 0 && key[n] == '.' ? key + n + 1 : NULL;
}

static bool find_in(const lac_param *params, size_t count, const char *key, void *at,
                    lac_case_value *out)
{
    const lac_param *param = lac_param_find(params, count, key);
    bool found = param != NULL && param->type == LAC_REAL && lac_param_given(param, at);
    if (found) {
        *out = (lac_case_value){(double *)(void *)((char *)at + param->offset), param};
    }
    return found;
}

static bool find_in_slot(const lac_model *model, const char *key, lac_case_value *out)
{
    const char *rest =
        model->info != NULL && key != NULL ? lac_key_behind(key, model->info->name) : NULL;
    return rest != NULL &&
           find_in(model->info->params, model->info->param_count, rest, model->params, out);
}

static bool find_in_slots(const lac_model_list *list, const char *key, lac_case_value *out)
{
    char *end = NULL;
    if (key == NULL || key[0] < '0' || key[0] > '9') {
        return false;
    }
    unsigned long index = strtoul(key, &end, 10);
    return *end == '.' && index < list->count && find_in_slot(&list->item[index], end + 1, out);
}

static bool find_state(lac_case *c, const char *key, lac_case_value *out)
{
    bool time = c->initial.state == LAC_STATE_TIME && strcmp(key, "initial.state") == 0;
    bool ratio =
        c->initial.state == LAC_STATE_RATIO && strcmp(key, "initial.state.ratio_to_steady") == 0;
    out->at = &c->initial.state_value;
    out->param = time ? &lac_state_row : &lac_ratio_row;
    return time || ratio;
}

bool lac_case_find(lac_case *c, const char *key, lac_case_value *out)
{
    const lac_part *part;
    bool found = find_state(c, key, out);
    for (size_t i = 0; !found && (part = lac_part_get(i)) != NULL; i++) {
        const char *rest = lac_key_behind(key, part->info.name);
        const void *at = (const char *)c + part->at;
        if (rest != NULL && part->kind == LAC_PART_RECORD && part->fitted) {
            found = find_in(part->info.params, part->info.param_count, rest, c, out);
        } else if (rest != NULL && part->kind == LAC_PART_SLOT) {
            found = find_in_slot(at, rest, out);
        } else if (rest != NULL && part->kind == LAC_PART_SLOTS) {
            found = find_in_slots(at, rest, out);
        }
    }
    return found;
}

// The index-th model that a case names, on request with those of spreads; NULL past the end.
static const lac_model *slot_at(const lac_case *c, bool spreads, size_t index)
{
    const lac_part *part;
    for (size_t i = 0; (part = lac_part_get(i)) != NULL; i++) {
        const void *at = (const char *)c + part->at;
        const lac_model_list *list = at;
        const lac_heterogeneity_list *spread = at;
        if (part->kind == LAC_PART_SLOT && index-- == 0) {
            return at;
        }
        if (part->kind == LAC_PART_SLOTS) {
            if (index < list->count) {
                return &list->item[index];
            }
            index -= list->count;
        }
        if (spreads && part->kind == LAC_PART_SPREADS) {
            if (index < spread->count) {
                return &spread->item[index].model;
            }
            index -= spread->count;
        }
    }
    return NULL;
}

const char *lac_case_validate(const lac_case *c)
{
    const lac_model *model;
    const char *fault = NULL;
    for (size_t i = 0; fault == NULL && (model = slot_at(c, false, i)) != NULL; i++) {
        bool judged = model->info != NULL && model->info->validate != NULL;
        fault = judged ? model->info->validate(model->params) : NULL;
    }
    return fault;
}

// The index-th of the files that a model's parameters name; their number is taken off the index.
static char **path_in(const lac_model *model, size_t *index)
{
    for (size_t i = 0; model->info != NULL && i < model->info->param_count; i++) {
        const lac_param *param = &model->info->params[i];
        char **path = (char **)(void *)((char *)model->params + param->offset);
        if (param->type == LAC_PATH && *path != NULL && (*index)-- == 0) {
            return path;
        }
    }
    return NULL;
}

char **lac_case_file(const lac_case *c, size_t index)
{
    const lac_model *model;
    for (size_t i = 0; (model = slot_at(c, true, i)) != NULL; i++) {
        char **path = path_in(model, &index);
        if (path != NULL) {
            return path;
        }
    }
    if (index == c->compare_count && c->from.file != NULL) {
        return (char **)&c->from.file;
    }
    return index < c->compare_count ? &c->compare[index].path : NULL;
}

lac_status lac_case_rebase(lac_case *c, const char *folder, lac_error *err)
{
    char **path;
    for (size_t i = 0; (path = lac_case_file(c, i)) != NULL; i++) {
        char *whole =
            (*path)[0] == '/' ? strdup(*path) : lac_path_below(folder, strlen(folder), *path);
        LAC_FAIL_MEMORY_IF(whole == NULL, err);
        free(*path);
        *path = whole;
    }
    return LAC_OK;
}

int64_t *lac_model_seed(const lac_model *model)
{
    const lac_model_info *info = model->info;
    const lac_param *seed =
        info != NULL ? lac_param_find(info->params, info->param_count, "seed") : NULL;
    return seed != NULL ? (int64_t *)(void *)((char *)model->params + seed->offset) : NULL;
}
