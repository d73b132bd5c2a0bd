// SPDX-License-Identifier: GPL-3.0-or-later
// The state as a file: settings that the numbers depend on, then what is known, then a checksum of
// all before. Numbers are as they are in memory.
#include <sys/stat.h>

#include "base/temp_file.h"
#include "case/levels.h"
#include "watch/internal.h"

enum { COLUMNS = 4 };
static const char mark[8] = {'L', 'A', 'C', 'W', 'A', 'T', 'C', '2'};

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
    if (f->clock != NULL) { // a state of before has no line for it
        put_word(out, "clock", f->clock);
    }
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

// All that follows writes and reads alike.
static lac_status put_station(lac_archive *a, lac_watch *w, size_t i, lac_error *err)
{
    lac_station *s = a->loading ? NULL : w->stations.at[i];
    char *name = s != NULL ? s->name : NULL;
    uint64_t n = s != NULL ? s->n : 0;
    const size_t count = (size_t)w->def.fleet->window_count;
    lac_status status = LAC_OK;
    lac_archive_text(a, &name);
    LAC_PASS(a, n);
    if (a->loading) {
        if (lac_archive_good(a) && n <= count) {
            status = lac_stations_find(&w->stations, name, SIZE_MAX, &s, err);
            status = status == LAC_OK ? lac_station_reserve(s, (size_t)n, count, err) : status;
        }
        free(name);
        LAC_TRY_RETURN(status);
        a->short_of = a->short_of || s == NULL;
    }
    if (!lac_archive_good(a)) {
        return LAC_OK;
    }
    s->n = (size_t)n;
    double *const column[COLUMNS] = {s->time, s->displacement, s->sigma, s->digit};
    for (size_t c = 0; c < COLUMNS; c++) {
        lac_archive_pass(a, column[c], s->n * sizeof(double));
    }
    LAC_PASS_RUN(a, s->taken, s->level);
    LAC_PASS(a, s->chance);
    LAC_PASS(a, s->accelerating);
    return LAC_OK;
}

static lac_status put_file(lac_archive *a, lac_watch *w, size_t i, lac_error *err)
{
    lac_followed file = {0}, *f = a->loading ? &file : &w->file[i], *made = NULL;
    lac_status status = LAC_OK;
    lac_archive_text(a, &f->station);
    lac_archive_text(a, &f->path);
    LAC_PASS_RUN(a, f->at.inode, f->at.lines);
    LAC_PASS(a, f->at.cut);
    if (a->loading && lac_archive_good(a)) {
        status = lac_watch_add_file(w, f->station, f->path, &made, err);
    }
    if (made != NULL) {
        made->at = f->at;
    }
    free(file.station);
    free(file.path);
    return status;
}

static void put_header(lac_archive *a, lac_watch *w)
{
    lac_line unused;
    const char *known = lac_line_header(w->reader);
    char *header = !a->loading && known != NULL ? strdup(known) : NULL;
    lac_archive_text(a, &header);
    if (a->loading && lac_archive_good(a) && header[0] != '\0') {
        (void)lac_line_read(w->reader, header, &unused);
    }
    free(header);
}

// @param output  bytes of it
static lac_status put(lac_archive *a, lac_watch *w, int64_t *output, lac_error *err)
{
    uint64_t stations = w->stations.n, files = w->files;
    lac_status status = LAC_OK;
    LAC_PASS(a, w->generation);
    LAC_PASS(a, *output);
    LAC_PASS(a, w->counts);
    LAC_PASS(a, w->sum);
    LAC_PASS(a, w->known);
    LAC_PASS(a, w->dated);
    put_header(a, w);
    LAC_PASS(a, stations);
    for (uint64_t i = 0; i < stations && status == LAC_OK && lac_archive_good(a); i++) {
        status = put_station(a, w, (size_t)i, err);
    }
    LAC_PASS(a, files);
    for (uint64_t i = 0; i < files && status == LAC_OK && lac_archive_good(a); i++) {
        status = put_file(a, w, (size_t)i, err);
    }
    return status;
}

lac_status lac_state_write(lac_watch *w, const char *path, int64_t output, lac_error *err)
{
    lac_archive a = {.loading = false};
    char *how = settings(w), head[sizeof mark];
    lac_status status = how != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    memcpy(head, mark, sizeof head);
    LAC_PASS(&a, head);
    lac_archive_text(&a, &how);
    LAC_TRY(put(&a, w, &output, err));
    uint64_t sum = lac_sum_bytes(0, a.bytes, a.size);
    LAC_PASS(&a, sum);
    LAC_TRY(lac_archive_good(&a) ? lac_write_bytes(path, a.bytes, a.size, true, err)
                                 : lac_fail_memory(err));
    lac_temp_file_sync_folder(path);
out:
    free(how);
    free(a.bytes);
    return status;
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

static lac_status read_all(lac_watch *w, const char *path, lac_archive *a, int64_t *output,
                           lac_error *err)
{
    char head[sizeof mark] = "";
    char *then = NULL, *now = settings(w);
    uint64_t sum = 0;
    lac_status status = now != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_PASS(a, head);
    a->short_of = a->short_of || memcmp(head, mark, sizeof mark) != 0;
    lac_archive_text(a, &then);
    if (status == LAC_OK && lac_archive_good(a)) {
        status = compare(w, path, then, now, err);
    }
    if (status == LAC_OK && lac_archive_good(a)) {
        status = put(a, w, output, err);
    }
    const uint64_t expected = lac_sum_bytes(0, a->bytes, a->at);
    LAC_PASS(a, sum);
    if (status == LAC_OK && (!lac_archive_good(a) || sum != expected)) {
        status = lac_fail(err, LAC_EINPUT, "%s: is damaged, or no state of lacuna watch", path);
    }
    free(then);
    free(now);
    return status;
}

lac_status lac_state_read(lac_watch *w, const char *path, bool *found, int64_t *output,
                          lac_error *err)
{
    struct stat info;
    lac_archive a = {.loading = true};
    FILE *file = fopen(path, "rbe");
    *found = file != NULL;
    LAC_FAIL_IF(file == NULL && errno != ENOENT, err, LAC_EIO, "%s: %s", path, strerror(errno));
    if (file == NULL) {
        return LAC_OK;
    }
    a.size = fstat(fileno(file), &info) == 0 ? (size_t)info.st_size : 0;
    a.bytes = malloc(a.size + 1);
    if (a.bytes != NULL) {
        a.size = fread(a.bytes, 1, a.size, file);
    }
    const lac_status status =
        a.bytes != NULL ? read_all(w, path, &a, output, err) : lac_fail_memory(err);
    free(a.bytes);
    (void)fclose(file);
    return status;
}
