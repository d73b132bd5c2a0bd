// SPDX-License-Identifier: GPL-3.0-or-later
// The state as a file: settings that the numbers depend on, then what is known, then a checksum of
// all before. Numbers are as they are in memory.
#include <fcntl.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "case/levels.h"
#include "watch/internal.h"

enum { COLUMNS = 4, LONGEST = 1 << 20 };
static const char mark[8] = {'L', 'A', 'C', 'W', 'A', 'T', 'C', '2'};

// Writes and reads alike: each thing is named once.
typedef struct archive {
    FILE *file;
    bool writes, bad;
    uint64_t sum;
} archive;

static void bytes(archive *a, void *at, size_t n)
{
    if (!a->bad && n > 0) {
        a->bad = (a->writes ? fwrite(at, 1, n, a->file) : fread(at, 1, n, a->file)) != n;
        a->sum = a->bad ? a->sum : lac_sum_bytes(a->sum, at, n);
    }
}

#define PUT(a, thing) bytes(a, &(thing), sizeof(thing))

// A text that is owned, NULL as an empty one.
static void text(archive *a, char **owned)
{
    uint64_t n = *owned != NULL ? strlen(*owned) : 0;
    PUT(a, n);
    a->bad = a->bad || n > LONGEST;
    if (a->bad) {
        return;
    }
    if (!a->writes) {
        free(*owned);
        *owned = calloc(1, (size_t)n + 1);
        a->bad = *owned == NULL;
    }
    bytes(a, *owned, (size_t)n);
}

static void put_word(FILE *out, const char *key, const char *value)
{
    (void)fprintf(out, "%s: %s\n", key, value != NULL ? value : "");
}

// What the numbers of the output depend on, a line each.
static char *settings(const lac_watch *w)
{
    const lac_fleet *f = w->def.fleet;
    char *made = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&made, &size);
    if (out == NULL) {
        return NULL;
    }
    put_word(out, "station", f->station);
    put_word(out, "time", f->time);
    put_word(out, "time_format", f->time_format);
    put_word(out, "displacement", f->displacement);
    put_word(out, "displacement (unit)", f->displacement_unit);
    put_word(out, "sigma", f->sigma);
    put_word(out, "sigma (unit)", f->sigma_unit);
    for (size_t i = 0; i < f->columns; i++) {
        put_word(out, "columns", f->column[i]);
    }
    put_word(out, "smooth", f->smooth);
    put_word(out, "onset", f->onset);
    (void)fprintf(
        out, "window.count: %" PRId64 "\nwindow.time: %.17g\nahead: %.17g\nraw: %d\nstream: %d\n",
        f->window_count, f->window_time, f->ahead, f->raw, f->stream);
    for (size_t i = 0; i < lac_levels_table.param_count; i++) {
        const lac_param *row = &lac_levels_table.params[i];
        const double *value = (const void *)((const char *)&w->def.forecast.levels + row->offset);
        (void)fprintf(out, "levels.%s: %.17g\n", row->key, *value);
    }
    return lac_text_made(out, &made);
}

static lac_status put_station(archive *a, lac_watch *w, size_t i, lac_error *err)
{
    lac_station *s = a->writes ? w->stations.at[i] : NULL;
    char *name = a->writes ? s->name : NULL;
    uint64_t n = a->writes ? s->n : 0;
    const size_t count = (size_t)w->def.fleet->window_count;
    lac_status status = LAC_OK;
    text(a, &name);
    PUT(a, n);
    if (!a->writes && !a->bad && n <= count) {
        status = lac_stations_find(&w->stations, name, SIZE_MAX, &s, err);
        status = status == LAC_OK ? lac_station_reserve(s, (size_t)n, count, err) : status;
    }
    if (!a->writes) {
        free(name);
        LAC_TRY_RETURN(status);
        a->bad = a->bad || s == NULL;
    }
    if (a->bad) {
        return LAC_OK;
    }
    s->n = (size_t)n;
    double *const column[COLUMNS] = {s->time, s->displacement, s->sigma, s->digit};
    for (size_t c = 0; c < COLUMNS; c++) {
        bytes(a, column[c], s->n * sizeof(double));
    }
    PUT(a, s->readings);
    PUT(a, s->late);
    PUT(a, s->doubled);
    PUT(a, s->old);
    PUT(a, s->ahead);
    PUT(a, s->rate);
    PUT(a, s->issued);
    PUT(a, s->alarms);
    PUT(a, s->level);
    PUT(a, s->chance);
    PUT(a, s->accelerating);
    return LAC_OK;
}

static lac_status put_file(archive *a, lac_watch *w, size_t i, lac_error *err)
{
    lac_followed file = {0}, *f = a->writes ? &w->file[i] : &file;
    lac_status status = LAC_OK;
    text(a, &f->station);
    text(a, &f->path);
    PUT(a, f->inode);
    PUT(a, f->offset);
    PUT(a, f->before);
    PUT(a, f->tail);
    PUT(a, f->lines);
    PUT(a, f->cut);
    if (!a->writes) {
        lac_followed *made = NULL;
        status = a->bad ? LAC_OK : lac_watch_add_file(w, f->station, f->path, &made, err);
        if (made != NULL) {
            made->inode = f->inode;
            made->offset = f->offset;
            made->before = f->before;
            made->tail = f->tail;
            made->lines = f->lines;
            made->cut = f->cut;
        }
        free(file.station);
        free(file.path);
    }
    return status;
}

static void put_header(archive *a, lac_watch *w)
{
    lac_line unused;
    const char *known = lac_line_header(w->reader);
    char *header = a->writes && known != NULL ? strdup(known) : NULL;
    text(a, &header);
    if (!a->writes && !a->bad && header[0] != '\0') {
        (void)lac_line_read(w->reader, header, &unused);
    }
    free(header);
}

// @param output  bytes of it
static lac_status put(archive *a, lac_watch *w, int64_t *output, lac_error *err)
{
    uint64_t stations = w->stations.n, files = w->files;
    lac_status status = LAC_OK;
    PUT(a, w->generation);
    PUT(a, *output);
    PUT(a, w->counts);
    PUT(a, w->sum);
    PUT(a, w->known);
    PUT(a, w->dated);
    put_header(a, w);
    PUT(a, stations);
    for (uint64_t i = 0; i < stations && status == LAC_OK && !a->bad; i++) {
        status = put_station(a, w, (size_t)i, err);
    }
    PUT(a, files);
    for (uint64_t i = 0; i < files && status == LAC_OK && !a->bad; i++) {
        status = put_file(a, w, (size_t)i, err);
    }
    return status;
}

static bool write_all(lac_watch *w, FILE *file, int64_t output, lac_error *err)
{
    archive a = {.file = file, .writes = true};
    char *how = settings(w);
    char head[sizeof mark];
    memcpy(head, mark, sizeof head);
    PUT(&a, head);
    text(&a, &how);
    a.bad = a.bad || how == NULL || put(&a, w, &output, err) != LAC_OK;
    const uint64_t sum = a.sum;
    a.bad = a.bad || fwrite(&sum, sizeof sum, 1, file) != 1;
    free(how);
    return !a.bad && fflush(file) == 0 && fsync(fileno(file)) == 0;
}

lac_status lac_state_write(lac_watch *w, const char *path, int64_t output, lac_error *err)
{
    char *part = lac_temp_file_name(path);
    LAC_FAIL_MEMORY_IF(part == NULL, err);
    (void)unlink(part);
    FILE *file = fopen(part, "wbxe");
    bool good = file != NULL && write_all(w, file, output, err);
    int why = errno;
    if (file != NULL && fclose(file) != 0 && good) {
        good = false;
        why = errno;
    }
    if (good && lac_temp_file_publish(part, path, true) != 0) {
        good = false;
        why = errno;
    }
    if (good) {
        lac_temp_file_sync_folder(path);
    } else {
        (void)unlink(part);
        (void)lac_fail(err, LAC_EIO, "%s: cannot be written: %s", path, strerror(why));
    }
    free(part);
    return good ? LAC_OK : LAC_EIO;
}

// The first setting that is another one.
static lac_status compare(const lac_watch *w, const char *path, const char *then, const char *now,
                          lac_error *err)
{
    while (*then != '\0' && *now != '\0') {
        const size_t a = strcspn(then, "\n"), b = strcspn(now, "\n");
        if (a != b || strncmp(then, now, a) != 0) {
            break;
        }
        then += a + (then[a] != '\0');
        now += b + (now[b] != '\0');
    }
    LAC_FAIL_IF(*then != '\0' || *now != '\0', err, LAC_EINPUT,
                "%s: was made with other settings: \"%.*s\", which is \"%.*s\" in %s; another "
                "--state begins anew",
                path, (int)strcspn(then, "\n"), then, (int)strcspn(now, "\n"), now,
                w->def.fleet->path);
    return LAC_OK;
}

static lac_status read_all(lac_watch *w, const char *path, FILE *file, int64_t *output,
                           lac_error *err)
{
    archive a = {.file = file};
    char head[sizeof mark] = "";
    char *then = NULL, *now = settings(w);
    uint64_t sum = 0;
    lac_status status = now != NULL ? LAC_OK : lac_fail_memory(err);
    PUT(&a, head);
    a.bad = a.bad || memcmp(head, mark, sizeof mark) != 0;
    text(&a, &then);
    if (status == LAC_OK && !a.bad) {
        status = compare(w, path, then, now, err);
    }
    if (status == LAC_OK && !a.bad) {
        status = put(&a, w, output, err);
    }
    const uint64_t expected = a.sum;
    if (status == LAC_OK && (a.bad || fread(&sum, sizeof sum, 1, file) != 1 || sum != expected)) {
        status = lac_fail(err, LAC_EINPUT, "%s: is damaged, or no state of lacuna watch", path);
    }
    free(then);
    free(now);
    return status;
}

lac_status lac_state_read(lac_watch *w, const char *path, bool *found, int64_t *output,
                          lac_error *err)
{
    FILE *file = fopen(path, "rbe");
    *found = file != NULL;
    LAC_FAIL_IF(file == NULL && errno != ENOENT, err, LAC_EIO, "%s: %s", path, strerror(errno));
    const lac_status status = file != NULL ? read_all(w, path, file, output, err) : LAC_OK;
    if (file != NULL) {
        (void)fclose(file);
    }
    return status;
}
