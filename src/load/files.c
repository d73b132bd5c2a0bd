// SPDX-License-Identifier: GPL-3.0-or-later
// Readings kept in memory: loads that are made again and again (lacuna fit) read their files once.
#include "load/kinds.h"

// One column of one file, on the clock of the run, without offset; or a doubt about a file.
typedef struct kept {
    char *text; // all that tells the column from another; or what was taken for want of a word
    bool doubt;
    lac_readings readings;
    struct kept *next;
} kept;

struct lac_load_files {
    kept *first;
};

lac_status lac_load_files_create(lac_load_files **out, lac_error *err)
{
    *out = calloc(1, sizeof **out);
    return *out != NULL ? LAC_OK : lac_fail_memory(err);
}

// Adds an entry at the end; takes the text over. @return NULL where memory is short
static kept *add(lac_load_files *files, char *text, bool doubt)
{
    kept *entry = text != NULL ? calloc(1, sizeof *entry) : NULL;
    kept **end = &files->first;
    if (entry == NULL) {
        free(text);
        return NULL;
    }
    *entry = (kept){.text = text, .doubt = doubt};
    while (*end != NULL) {
        end = &(*end)->next;
    }
    *end = entry;
    return entry;
}

lac_status lac_load_files_note(lac_load_files *files, const char *path, const char *text,
                               lac_error *err)
{
    const size_t size = strlen(path) + strlen(text) + 3;
    char *note = malloc(size);
    if (note != NULL) {
        (void)snprintf(note, size, "%s: %s", path, text);
    }
    return add(files, note, true) != NULL ? LAC_OK : lac_fail_memory(err);
}

const char *lac_load_files_doubt(const lac_load_files *files, size_t index)
{
    const kept *entry = files->first;
    while (entry != NULL && !(entry->doubt && index-- == 0)) {
        entry = entry->next;
    }
    return entry != NULL ? entry->text : NULL;
}

void lac_load_files_free(lac_load_files *files)
{
    while (files != NULL && files->first != NULL) {
        kept *entry = files->first;
        files->first = entry->next;
        free(entry->text);
        lac_readings_clear(&entry->readings);
        free(entry);
    }
    free(files);
}

// Path, columns, units and clock, with a byte between them that none of them holds.
static char *name_of(const lac_readings_def *def, const lac_load_clock *clock)
{
    const char *per = def->per != NULL ? def->per : "";
    const size_t size = strlen(def->path) + strlen(def->time) + strlen(def->column) + strlen(per) +
                        strlen(def->si) + 40;
    char *name = malloc(size);
    if (name != NULL) {
        (void)snprintf(name, size, "%s\n%s\n%s\n%s\n%s\n%d %a", def->path, def->time, def->column,
                       per, def->si, clock->dated, clock->start);
    }
    return name;
}

// Reads a column that is not kept yet, and keeps it; takes the name over.
static lac_status keep(const lac_readings_def *def, const lac_load_clock *clock, char *name,
                       const kept **out, lac_error *err)
{
    lac_readings_def plain = *def;
    lac_readings readings;
    plain.offset = 0.0;
    lac_status status = lac_readings_load(&plain, clock, &readings, err);
    if (status != LAC_OK) {
        free(name);
        return status;
    }
    kept *entry = add(clock->files, name, false);
    if (entry == NULL) {
        lac_readings_clear(&readings);
        return lac_fail_memory(err);
    }
    entry->readings = readings;
    *out = entry;
    return LAC_OK;
}

static lac_status copy(const lac_readings *from, double offset, lac_readings *out, lac_error *err)
{
    out->t = malloc((from->n + 1) * sizeof *out->t);
    out->value = malloc((from->n + 1) * sizeof *out->value);
    LAC_FAIL_MEMORY_IF(out->t == NULL || out->value == NULL, err);
    out->n = from->n;
    memcpy(out->value, from->value, from->n * sizeof *out->value);
    for (size_t i = 0; i < from->n; i++) {
        out->t[i] = from->t[i] + offset;
    }
    return LAC_OK;
}

// The column as it is kept, read where it is not yet.
static lac_status look_up(const lac_readings_def *def, const lac_load_clock *clock,
                          lac_readings *out, lac_error *err)
{
    char *name = name_of(def, clock);
    const kept *entry = clock->files->first;
    lac_status status = LAC_OK;
    LAC_FAIL_MEMORY_IF(name == NULL, err);
    while (entry != NULL && (entry->doubt || strcmp(entry->text, name) != 0)) {
        entry = entry->next;
    }
    if (entry == NULL) {
        status = keep(def, clock, name, &entry, err);
    } else {
        free(name);
    }
    return status == LAC_OK ? copy(&entry->readings, def->offset, out, err) : status;
}

lac_status lac_readings_cover(const lac_readings *readings, const char *path,
                              const lac_load_clock *clock, const char *remedy, lac_error *err)
{
    double last = readings->t[readings->n - 1];
    LAC_FAIL_IF(readings->t[0] > 0.0, err, LAC_EINPUT,
                "%s: begins %g s after the run's start; must not begin after it%s", path,
                readings->t[0], remedy);
    LAC_FAIL_IF(last < clock->end, err, LAC_EINPUT,
                "%s: ends %g s before the run's end; must reach it%s", path, clock->end - last,
                remedy);
    return LAC_OK;
}

lac_status lac_readings_read(const lac_readings_def *def, const lac_load_clock *clock,
                             const char *remedy, lac_readings *out, lac_error *err)
{
    lac_status status = LAC_OK;
    *out = (lac_readings){0};
    LAC_TRY(clock->files == NULL ? lac_readings_load(def, clock, out, err)
                                 : look_up(def, clock, out, err));
    if (remedy != NULL) {
        LAC_TRY(lac_readings_cover(out, def->path, clock, remedy, err));
    }
    return LAC_OK;
out:
    lac_readings_clear(out);
    return status;
}
