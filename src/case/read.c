// SPDX-License-Identifier: GPL-3.0-or-later
// A case from a file or from memory: made, read, checked, freed; and as users of the library have
// it, with its numbers by their keys.
#include "base/ask.h"
#include "case/sections.h"

enum { LARGEST_FILE = 4 * 1024 * 1024 };

static lac_case *new_case(lac_reader *reader)
{
    lac_case *c = calloc(1, sizeof *c);
    char *path = lac_reader_copy(reader, reader->name, strlen(reader->name));
    if (c == NULL || path == NULL) {
        reader->no_memory = true;
        free(path);
        free(c);
        return NULL;
    }
    c->path = path;
    c->run = lac_run_default();
    const lac_part *part;
    for (size_t i = 0; (part = lac_part_get(i)) != NULL; i++) {
        if (part->kind == LAC_PART_RECORD) {
            lac_table_reset(&part->info, c);
        }
    }
    c->rg.betas = 1;
    c->rg.beta[0] = 0.7;
    c->initial.state = LAC_STATE_STEADY;
    c->initial.state_value = NAN;
    return c;
}

static void clear_slots(lac_model_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        lac_model_clear(&list->item[i]);
    }
    free(list->item);
}

void lac_case_free(lac_case *c)
{
    const lac_part *part;
    if (c == NULL) {
        return;
    }
    for (size_t i = 0; (part = lac_part_get(i)) != NULL; i++) {
        void *at = (char *)c + part->at;
        if (part->kind == LAC_PART_RECORD) {
            lac_table_clear(&part->info, c);
        } else if (part->kind == LAC_PART_SLOT) {
            lac_model_clear(at);
        } else if (part->kind == LAC_PART_SLOTS) {
            clear_slots(at);
        } else if (part->kind == LAC_PART_SPREADS) {
            lac_heterogeneity_clear(at);
        }
    }
    if (c->use != NULL && c->use->simulations > 0) {
        c->use->freed = true;
    } else {
        free(c->use);
    }
    clear_slots(&c->analysis);
    for (size_t i = 0; i < c->compare_count; i++) {
        lac_table_clear(lac_section_find("compare"), &c->compare[i]);
    }
    free(c->compare);
    for (size_t i = 0; i < c->points; i++) {
        lac_table_clear(lac_section_find("output.points"), &c->point[i]);
    }
    free(c->point);
    for (size_t i = 0; i < c->fit.count; i++) {
        free(c->fit.parameter[i].key);
    }
    free(c->fit.parameter);
    free(c->history.step);
    free(c->path);
    free(c);
}

// The tree of a whole file, or NULL with the reason reported.
static lac_node *parse_file(lac_reader *reader, const char *text, size_t size)
{
    const char *binary = size > 0 ? memchr(text, '\0', size) : NULL;
    if (size > LARGEST_FILE) {
        lac_add_error_text(reader, 1, NULL, "is larger than 4 MiB, which no case is");
        return NULL;
    }
    if (binary != NULL) {
        lac_add_error_text(reader, 1, NULL, "is binary, not a case in text");
        return NULL;
    }
    lac_node *root = lac_tree_parse(reader, text, size, NULL);
    bool empty =
        root == NULL ? reader->report->count == 0 && !reader->no_memory : lac_node_is_null(root);
    if (empty) {
        lac_add_error_text(reader, 1, NULL, "is empty; a case starts with lacuna: 1");
    } else if (root != NULL && root->kind != LAC_NODE_MAP) {
        lac_add_error_text(reader, root->line, NULL,
                           "must be a mapping of sections, starting with lacuna: 1");
    } else {
        return root;
    }
    lac_node_free(root);
    return NULL;
}

// Says the first error of a report, and how many more there are.
static void summarise(const lac_case_issues *report, lac_error *err)
{
    char text[900];
    for (size_t i = 0; i < report->count; i++) {
        if (!report->issue[i].warning) {
            size_t others = report->errors - 1;
            (void)lac_case_issue_format(&report->issue[i], text, sizeof text);
            (void)(others == 0 ? lac_fail(err, LAC_EINPUT, "%s", text)
                               : lac_fail(err, LAC_EINPUT, "%s (and %zu more)", text, others));
            return;
        }
    }
}

lac_status lac_case_build(const lac_units *units, const char *name, const char *text, size_t size,
                          const lac_case_request *how, lac_case **out, lac_case_issues *report,
                          lac_error *err)
{
    *out = NULL;
    *report = (lac_case_issues){0};
    lac_reader reader = {.name = name, .purpose = how->purpose, .units = units, .report = report};
    lac_case *c = NULL;
    lac_node *root = parse_file(&reader, text, size);
    for (size_t i = 0; root != NULL && i < how->count; i++) {
        lac_apply_override(&reader, root, &how->overrides[i]);
    }
    if (root != NULL) {
        reader.root = root;
        c = new_case(&reader);
    }
    if (c != NULL) {
        lac_read_sections(&reader, "", c);
        lac_check_case(&reader, c);
    }
    lac_node_free(root);
    lac_case_issues_sort(report);
    if (report->errors == 0 && !reader.no_memory) {
        *out = c;
        return LAC_OK;
    }
    lac_case_free(c);
    LAC_FAIL_MEMORY_IF(reader.no_memory, err);
    summarise(report, err);
    return LAC_EINPUT;
}

lac_status lac_case_read_text(const char *name, const char *text, size_t size,
                              const lac_case_request *request, lac_case **out,
                              lac_case_issues *report, lac_error *err)
{
    static const lac_case_request plain = {0};
    const lac_case_request *how = request != NULL ? request : &plain;
    lac_units *units = NULL;
    lac_case_issues own, *issues = report != NULL ? report : &own;
    *out = NULL;
    *issues = (lac_case_issues){0};
    lac_status status = lac_units_create(&units, err);
    if (status == LAC_OK) {
        status = lac_case_build(units, name, text, size, how, out, issues, err);
    }
    if (report == NULL) {
        lac_case_issues_clear(&own);
    }
    if (status == LAC_OK) {
        (*out)->purpose = how->purpose;
    }
    lac_units_free(units);
    return status;
}

lac_status lac_case_read_file(const char *path, char **text, size_t *size, lac_error *err)
{
    FILE *file = fopen(path, "rb");
    LAC_FAIL_IF(file == NULL, err, LAC_EIO, "%s: cannot be opened: %s", path, strerror(errno));
    char *grown = NULL;
    size_t room = 8 * 1024;
    do { // up to a byte more than a case may have
        room = 2 * room < LARGEST_FILE ? 2 * room : LARGEST_FILE + 1;
        grown = realloc(*text, room + 1);
        *text = grown != NULL ? grown : *text;
        *size += grown != NULL ? fread(*text + *size, 1, room - *size, file) : 0;
    } while (grown != NULL && *size == room && room <= LARGEST_FILE);
    const int broken = ferror(file) != 0 ? errno : 0;
    (void)fclose(file);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    (*text)[*size] = '\0';
    LAC_FAIL_IF(broken != 0, err, LAC_EIO, "%s: cannot be read: %s", path, strerror(broken));
    return LAC_OK;
}

lac_status lac_map_file_read(const char *path, const lac_units *units, const char *such,
                             void (*read)(lac_reader *reader, void *out), void *out, lac_error *err)
{
    char *text = NULL;
    size_t size = 0;
    lac_case_issues report = {0};
    lac_reader reader = {.name = path, .units = units, .report = &report};
    lac_status status;
    LAC_TRY(lac_case_read_file(path, &text, &size, err));
    lac_node *root = lac_tree_parse(&reader, text, size, NULL);
    if (root != NULL && root->kind == LAC_NODE_MAP) {
        reader.root = root;
        read(&reader, out);
    } else if (report.errors == 0 && !reader.no_memory) {
        lac_add_error_text(&reader, 1, NULL, "must be a mapping of keys, such as %s", such);
    }
    lac_node_free(root);
    lac_case_issues_sort(&report);
    LAC_TRY(reader.no_memory ? lac_fail_memory(err) : LAC_OK);
    if (report.errors > 0) {
        summarise(&report, err);
        status = LAC_EINPUT;
    }
out:
    lac_case_issues_clear(&report);
    free(text);
    return status;
}

lac_status lac_case_read(const char *path, const lac_case_request *request, lac_case **out,
                         lac_case_issues *report, lac_error *err)
{
    char *text = NULL;
    size_t size = 0;
    *out = NULL;
    *report = (lac_case_issues){0};
    lac_status status = lac_case_read_file(path, &text, &size, err);
    if (status == LAC_OK) {
        status = lac_case_read_text(path, text, size, request, out, report, err);
    }
    free(text);
    return status;
}

static lac_status read_case(const char *name, const char *text, size_t size,
                            const lac_case_options *given, lac_case **out, lac_error *err)
{
    lac_case_options options = lac_case_options_default();
    lac_case_issues report = {0};
    lac_status status;
    *out = NULL;
    LAC_TRY(lac_take_options("lac_case_options", given, &options, sizeof options, err));
    const lac_case_request how = {options.purpose, options.overrides, options.count};
    LAC_TRY(options.purpose >= LAC_FOR_RUN && options.purpose <= LAC_FOR_CHECK
                ? LAC_OK
                : lac_fail(err, LAC_EINPUT, "no case is read for purpose %d", options.purpose));
    for (size_t i = 0; i < options.count; i++) {
        const lac_override *set = options.overrides;
        LAC_TRY(set != NULL && set[i].key != NULL && set[i].key[0] != '\0' && set[i].value != NULL
                    ? LAC_OK
                    : lac_fail(err, LAC_EINPUT, "override %zu must be key.path=value", i));
    }
    status = text == NULL ? lac_case_read(name, &how, out, &report, err)
                          : lac_case_read_text(name, text, size, &how, out, &report, err);
    if (status == LAC_OK && ((*out)->use = calloc(1, sizeof *(*out)->use)) == NULL) {
        lac_case_free(*out);
        *out = NULL;
        status = lac_fail_memory(err);
    }
    for (size_t i = 0; i < report.count && options.issue != NULL; i++) {
        options.issue(options.context, &report.issue[i]);
    }
out:
    lac_case_issues_clear(&report);
    return status;
}

lac_status lac_case_load(const char *path, const lac_case_options *options, lac_case **out,
                         lac_error *err)
{
    lac_status status = LAC_NEED(err, path, out);
    return status == LAC_OK ? read_case(path, NULL, 0, options, out, err) : status;
}

lac_status lac_case_parse(const char *name, const char *text, size_t size,
                          const lac_case_options *options, lac_case **out, lac_error *err)
{
    lac_status status = LAC_NEED(err, name, text, out);
    return status == LAC_OK ? read_case(name, text, size, options, out, err) : status;
}

lac_status lac_case_serves(const lac_case *c, lac_case_purpose purpose, lac_error *err)
{
    static const char *const names[] = {[LAC_FOR_RUN] = "LAC_FOR_RUN",
                                        [LAC_FOR_CONTACT] = "LAC_FOR_CONTACT",
                                        [LAC_FOR_RG] = "LAC_FOR_RG",
                                        [LAC_FOR_FIT] = "LAC_FOR_FIT"};
    const bool runs = c->purpose == LAC_FOR_RUN || c->purpose == LAC_FOR_FIT;
    const bool serves = c->purpose == purpose || (purpose == LAC_FOR_RUN && runs) ||
                        (purpose == LAC_FOR_CONTACT && (runs || c->purpose == LAC_FOR_RG)) ||
                        (purpose == LAC_FOR_RG && runs && c->rg.named) ||
                        (purpose == LAC_FOR_FIT && runs && c->fit.named);
    return serves ? LAC_OK
                  : lac_fail(err, LAC_EINPUT, "%s: must be read with %s", c->path, names[purpose]);
}

static lac_status find_number(const lac_case *c, const char *key, lac_case_value *out,
                              lac_error *err)
{
    return lac_case_find((lac_case *)c, key, out)
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT, "%s: has no number \"%s\"", c->path, key);
}

lac_status lac_case_get(const lac_case *c, const char *key, double *value, lac_error *err)
{
    lac_case_value found;
    LAC_TRY_RETURN(LAC_NEED(err, c, key, value));
    LAC_TRY_RETURN(find_number(c, key, &found, err));
    *value = *found.at;
    return LAC_OK;
}

lac_status lac_case_set(lac_case *c, const char *key, double value, lac_error *err)
{
    char why[200];
    lac_case_value found;
    lac_status status;
    LAC_TRY(LAC_NEED(err, c, key));
    LAC_TRY(find_number(c, key, &found, err));
    LAC_FAIL_IF(c->use != NULL && c->use->simulations > 0, err, LAC_EINPUT,
                "%s: %s: a simulation of the case is not freed yet", c->path, key);
    const double before = *found.at;
    LAC_FAIL_IF(!lac_param_allows(found.param, value, why, sizeof why), err, LAC_EINPUT,
                "%s: %s: %g %s", c->path, key, value, why);
    *found.at = value;
    const char *fault = lac_case_validate(c);
    if (fault != NULL) {
        *found.at = before;
        status = lac_fail(err, LAC_EINPUT, "%s: %s: %g: %s", c->path, key, value, fault);
    }
out:
    return status;
}

const lac_model_info *lac_model_find(const char *kind, const char *name)
{
    const lac_kind *of = NULL;
    for (size_t i = 0; kind != NULL && name != NULL && (of = lac_kind_get(i)) != NULL; i++) {
        const lac_model_info *model = NULL;
        for (size_t k = 0; strcmp(of->name, kind) == 0 && (model = of->at(k)) != NULL; k++) {
            if (strcmp(model->name, name) == 0) {
                return model;
            }
        }
    }
    return NULL;
}

const lac_param *lac_model_param(const lac_model_info *model, size_t index)
{
    return model != NULL && index < model->param_count ? &model->params[index] : NULL;
}
