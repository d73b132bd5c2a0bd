// SPDX-License-Identifier: GPL-3.0-or-later
// Readings kept in memory: loads that are made again and again (lacuna fit) read their files once.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "load/table.h"

// One column of one file, on the clock of the run, without offset.
typedef struct kept {
    char *name; // all that tells it from another
    double start;
    bool dated;
    lac_readings readings;
    struct kept *next;
} kept;

// What was taken for want of a word.
typedef struct doubt {
    char *text;
    struct doubt *next;
} doubt;

struct lac_load_files {
    kept *first;
    doubt *doubts;
};

lac_status lac_load_files_create(lac_load_files **out, lac_error *err)
{
    *out = calloc(1, sizeof **out);
    return *out != NULL ? LAC_OK : lac_fail_memory(err);
}

static void free_kept(kept *entry)
{
    free(entry->name);
    lac_readings_clear(&entry->readings);
    free(entry);
}

lac_status lac_load_files_note(lac_load_files *files, const char *path, const char *text,
                               lac_error *err)
{
    const size_t size = strlen(path) + strlen(text) + 3;
    doubt *entry = calloc(1, sizeof *entry);
    doubt **end = &files->doubts;
    if (entry == NULL || (entry->text = malloc(size)) == NULL) {
        free(entry);
        return lac_fail_memory(err);
    }
    (void)snprintf(entry->text, size, "%s: %s", path, text);
    while (*end != NULL) {
        end = &(*end)->next;
    }
    *end = entry;
    return LAC_OK;
}

const char *lac_load_files_doubt(const lac_load_files *files, size_t index)
{
    const doubt *entry = files->doubts;
    while (entry != NULL && index-- > 0) {
        entry = entry->next;
    }
    return entry != NULL ? entry->text : NULL;
}

static void free_doubts(doubt *entry)
{
    while (entry != NULL) {
        doubt *next = entry->next;
        free(entry->text);
        free(entry);
        entry = next;
    }
}

void lac_load_files_free(lac_load_files *files)
{
    free_doubts(files != NULL ? files->doubts : NULL);
    while (files != NULL && files->first != NULL) {
        kept *entry = files->first;
        files->first = entry->next;
        free_kept(entry);
    }
    free(files);
}

// Path, columns and units, with a byte between them that none of them holds.
static char *name_of(const lac_readings_def *def)
{
    const char *parts[] = {def->path, def->time, def->column, def->per != NULL ? def->per : "",
                           def->si};
    size_t size = 1;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        size += strlen(parts[i]) + 1;
    }
    char *name = malloc(size);
    if (name == NULL) {
        return NULL;
    }
    char *at = name;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        size_t n = strlen(parts[i]);
        memcpy(at, parts[i], n);
        at[n] = '\n';
        at += n + 1;
    }
    *at = '\0';
    return name;
}

static const kept *find(const lac_load_files *files, const char *name, const lac_load_clock *clock)
{
    for (const kept *entry = files->first; entry != NULL; entry = entry->next) {
        if (strcmp(entry->name, name) == 0 && entry->dated == clock->dated &&
            entry->start == clock->start) {
            return entry;
        }
    }
    return NULL;
}

// Reads a column and keeps it; takes the name over.
static lac_status keep(const lac_readings_def *def, const lac_load_clock *clock, char *name,
                       const kept **out, lac_error *err)
{
    kept *entry = calloc(1, sizeof *entry);
    if (entry == NULL) {
        free(name);
        return lac_fail_memory(err);
    }
    *entry = (kept){.name = name, .start = clock->start, .dated = clock->dated};
    lac_readings_def plain = *def;
    plain.offset = 0.0;
    lac_status status = lac_readings_load(&plain, clock, &entry->readings, err);
    if (status != LAC_OK) {
        free_kept(entry);
        return status;
    }
    entry->next = clock->files->first;
    clock->files->first = entry;
    *out = entry;
    return LAC_OK;
}

static lac_status copy(const lac_readings *from, double offset, lac_readings *out, lac_error *err)
{
    out->t = malloc((from->n + 1) * sizeof *out->t);
    out->value = malloc((from->n + 1) * sizeof *out->value);
    if (out->t == NULL || out->value == NULL) {
        lac_readings_clear(out);
        return lac_fail_memory(err);
    }
    out->n = from->n;
    memcpy(out->value, from->value, from->n * sizeof *out->value);
    for (size_t i = 0; i < from->n; i++) {
        out->t[i] = from->t[i] + offset;
    }
    return LAC_OK;
}

lac_status lac_readings_read(const lac_readings_def *def, const lac_load_clock *clock,
                             lac_readings *out, lac_error *err)
{
    *out = (lac_readings){0};
    if (clock->files == NULL) {
        return lac_readings_load(def, clock, out, err);
    }
    char *name = name_of(def);
    if (name == NULL) {
        return lac_fail_memory(err);
    }
    const kept *entry = find(clock->files, name, clock);
    if (entry != NULL) {
        free(name);
        return copy(&entry->readings, def->offset, out, err);
    }
    lac_status status = keep(def, clock, name, &entry, err);
    return status == LAC_OK ? copy(&entry->readings, def->offset, out, err) : status;
}
