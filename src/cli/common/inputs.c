// SPDX-License-Identifier: GPL-3.0-or-later
// The files that a case reads.
#include "cli/common/inputs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef void visitor(void *context, const char *path);

static void visit_slot(const lac_slot *slot, visitor *visit, void *context)
{
    for (size_t i = 0; slot->about != NULL && i < slot->about->param_count; i++) {
        const lac_param *param = &slot->about->params[i];
        const char *path = NULL;
        if (param->type == LAC_PATH) {
            memcpy(&path, (const char *)slot->params + param->offset, sizeof path);
        }
        if (path != NULL) {
            visit(context, path);
        }
    }
}

static void visit_slots(const lac_slot_list *list, visitor *visit, void *context)
{
    for (size_t i = 0; i < list->count; i++) {
        visit_slot(&list->item[i], visit, context);
    }
}

static void visit_spreads(const lac_spread_list *list, visitor *visit, void *context)
{
    for (size_t i = 0; i < list->count; i++) {
        visit_slot(&list->item[i].slot, visit, context);
    }
}

// Every file that a case names, in one order.
static void visit_all(const lac_case *c, visitor *visit, void *context)
{
    const lac_slot *slots[] = {&c->surface, &c->domain, &c->normal, &c->friction, &c->transfer};
    const lac_slot_list *lists[] = {&c->shear, &c->pore, &c->analysis};
    const lac_spread_list *spreads[] = {&c->interface_spread, &c->friction_spread,
                                        &c->initial_spread};
    for (size_t i = 0; i < sizeof slots / sizeof slots[0]; i++) {
        visit_slot(slots[i], visit, context);
    }
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        visit_slots(lists[i], visit, context);
    }
    for (size_t i = 0; i < sizeof spreads / sizeof spreads[0]; i++) {
        visit_spreads(spreads[i], visit, context);
    }
    for (size_t i = 0; i < c->compare_count; i++) {
        visit(context, c->compare[i].path);
    }
}

typedef struct search {
    const struct stat *file;
    bool found;
} search;

static void look_for(void *context, const char *path)
{
    search *s = context;
    struct stat one;
    s->found |= path != NULL && stat(path, &one) == 0 && one.st_dev == s->file->st_dev &&
                one.st_ino == s->file->st_ino;
}

bool cli_inputs_has(const cli_request *request, const lac_case *c, const struct stat *file)
{
    search s = {.file = file};
    for (size_t i = 0; i < request->count; i++) {
        look_for(&s, request->argument[i]);
    }
    look_for(&s, request->compare);
    look_for(&s, request->fit);
    look_for(&s, request->forecast.case_file);
    if (c != NULL) {
        look_for(&s, c->path);
        visit_all(c, look_for, &s);
    }
    return s.found;
}

// FNV-1a; 0 where the file cannot be read, which the run then says, or is a pipe, whose content
// would be gone.
static uint64_t sum_file(const char *path)
{
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode)) {
        return 0;
    }
    unsigned char block[1 << 14];
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    size_t got = 0;
    FILE *file = fopen(path, "rb");
    while (file != NULL && (got = fread(block, 1, sizeof block, file)) > 0) {
        for (size_t i = 0; i < got; i++) {
            sum = (sum ^ block[i]) * UINT64_C(0x100000001b3);
        }
    }
    bool whole = file != NULL && ferror(file) == 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    return whole ? sum : 0;
}

static void put_sum(void *context, const char *path)
{
    FILE *text = context;
    const char *slash = strrchr(path, '/');
    if (ftell(text) == 0) {
        (void)fputs("files:\n", text);
    }
    (void)fprintf(text, "  %s: %016" PRIx64 "\n", slash != NULL ? slash + 1 : path, sum_file(path));
}

char *cli_inputs_sums(const lac_case *c)
{
    char *sums = NULL;
    size_t size = 0;
    FILE *text = open_memstream(&sums, &size);
    if (text == NULL) {
        return NULL;
    }
    visit_all(c, put_sum, text);
    bool good = ferror(text) == 0;
    if (fclose(text) != 0 || !good) {
        free(sums);
        return NULL;
    }
    return sums;
}
