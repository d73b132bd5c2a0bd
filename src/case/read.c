// SPDX-License-Identifier: GPL-3.0-or-later
// A case from a file or from memory: made, read, checked, freed.
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
        lac_table table = lac_part_table(&part->info);
        if (part->kind == LAC_PART_RECORD) {
            lac_table_reset(&table, c);
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

static void clear_part(const lac_part *part, lac_case *c)
{
    void *at = (char *)c + part->at;
    const lac_table table = lac_part_table(&part->info);
    if (part->kind == LAC_PART_RECORD) {
        lac_table_clear(&table, c);
    } else if (part->kind == LAC_PART_SLOT) {
        lac_model_clear(at);
    } else if (part->kind == LAC_PART_SLOTS) {
        clear_slots(at);
    } else if (part->kind == LAC_PART_SPREADS) {
        lac_heterogeneity_clear(at);
    }
}

void lac_case_free(lac_case *c)
{
    const lac_part *part;
    if (c == NULL) {
        return;
    }
    for (size_t i = 0; (part = lac_part_get(i)) != NULL; i++) {
        clear_part(part, c);
    }
    if (c->use != NULL && c->use->simulations > 0) {
        c->use->freed = true;
    } else {
        free(c->use);
    }
    clear_slots(&c->analysis);
    const lac_table table = lac_section_table("compare");
    for (size_t i = 0; i < c->compare_count; i++) {
        lac_table_clear(&table, &c->compare[i]);
    }
    free(c->compare);
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

static void summarise(const lac_reader *reader, lac_error *err)
{
    char text[900];
    const lac_case_issues *report = reader->report;
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

lac_status lac_case_build(const lac_units *units, const lac_case_source *from, lac_case **out,
                          lac_case_issues *report, lac_error *err)
{
    *out = NULL;
    *report = (lac_case_issues){0};
    lac_reader reader = {
        .name = from->name, .purpose = from->purpose, .units = units, .report = report};
    lac_case *c = NULL;
    lac_node *root = parse_file(&reader, from->text, from->size);
    for (size_t i = 0; root != NULL && i < from->count; i++) {
        lac_apply_override(&reader, &root, &from->overrides[i]);
    }
    if (root != NULL) {
        reader.root = root;
        c = new_case(&reader);
    }
    if (c != NULL) {
        lac_read_sections(&reader, c);
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
    summarise(&reader, err);
    return LAC_EINPUT;
}

lac_status lac_case_read_text(const char *name, const char *text, size_t size,
                              const lac_case_request *request, lac_case **out,
                              lac_case_issues *report, lac_error *err)
{
    static const lac_case_request plain = {0};
    const lac_case_request *how = request != NULL ? request : &plain;
    lac_units *units = NULL;
    *out = NULL;
    *report = (lac_case_issues){0};
    lac_status status = lac_units_create(&units, err);
    if (status == LAC_OK) {
        lac_case_source from = {name, text, size, how->overrides, how->count, how->purpose};
        status = lac_case_build(units, &from, out, report, err);
    }
    if (status == LAC_OK) {
        (*out)->purpose = how->purpose;
    }
    lac_units_free(units);
    return status;
}

// Reads to the end of the file, or to one byte more than a case may have.
static lac_status read_all(FILE *file, const char *path, char **buffer, size_t *size,
                           lac_error *err)
{
    for (size_t room = 16 * 1024;; room *= 2) {
        room = room < LARGEST_FILE ? room : LARGEST_FILE + 1;
        char *grown = realloc(*buffer, room);
        LAC_FAIL_MEMORY_IF(grown == NULL, err);
        *buffer = grown;
        *size += fread(grown + *size, 1, room - *size, file);
        LAC_FAIL_IF(ferror(file), err, LAC_EIO, "%s: cannot be read: %s", path, strerror(errno));
        if (*size < room || room > LARGEST_FILE) {
            return LAC_OK;
        }
    }
}

static lac_status read_file(const char *path, char **text, size_t *size, lac_error *err)
{
    char *buffer = NULL;
    FILE *file = fopen(path, "rb");
    lac_status status =
        file != NULL ? read_all(file, path, &buffer, size, err)
                     : lac_fail(err, LAC_EIO, "%s: cannot be opened: %s", path, strerror(errno));
    if (file != NULL) {
        (void)fclose(file);
    }
    if (status != LAC_OK) {
        free(buffer);
        buffer = NULL;
    }
    *text = buffer;
    return status;
}

lac_status lac_case_read(const char *path, const lac_case_request *request, lac_case **out,
                         lac_case_issues *report, lac_error *err)
{
    char *text = NULL;
    size_t size = 0;
    *out = NULL;
    *report = (lac_case_issues){0};
    lac_status status = read_file(path, &text, &size, err);
    if (status == LAC_OK) {
        status = lac_case_read_text(path, text, size, request, out, report, err);
    }
    free(text);
    return status;
}
