// SPDX-License-Identifier: GPL-3.0-or-later
// The sink of a run: records buffered and written in batches, snapshots at once.
#include "store/internal.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/date.h"

enum { BATCH_MAX = 512 }; // records kept in memory at most

// "seconds since YYYY-MM-DD hh:mm:ss[.ffffff]"; UTC is CF's default zone.
static lac_status name_time_unit(lac_store *s, const lac_store_def *def, lac_error *err)
{
    if (!def->dated) {
        memcpy(s->time_unit, "s", sizeof "s");
        return LAC_OK;
    }
    char date[32];
    double whole = floor(def->start_date);
    if (*lac_date_format(whole, date, sizeof date) == '\0') {
        return lac_fail(err, LAC_EINPUT, "%s: the start must lie in the years 0 to 9999",
                        s->file.path);
    }
    date[10] = ' ';
    date[19] = '\0';
    char fraction[16] = "";
    long micro = lround((def->start_date - whole) * 1e6);
    if (micro > 0 && micro < 1000000) {
        (void)snprintf(fraction, sizeof fraction, ".%06ld", micro);
    }
    (void)snprintf(s->time_unit, sizeof s->time_unit, "seconds since %s%s", date, fraction);
    return LAC_OK;
}

static lac_status sync_file(lac_store *s, lac_error *err)
{
    s->unsynced = 0;
    s->pending = 0;
    return lac_nc_sync(&s->file, err);
}

// What a checkpoint says of who made it.
static lac_status keep_provenance(lac_store *s, const lac_store_def *def, lac_error *err)
{
    const lac_provenance *from = &def->provenance;
    const char *parts[] = {from->case_text != NULL ? from->case_text : "",
                           def->inputs != NULL ? def->inputs : ""};
    size_t size = strlen(parts[0]) + strlen(parts[1]) + 1;
    s->libraries = strdup(from->libraries != NULL ? from->libraries : "");
    s->case_text = malloc(size);
    if (s->libraries == NULL || s->case_text == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(s->case_text, size, "%s%s", parts[0], parts[1]);
    return LAC_OK;
}

// A new file, or the one that is there up to its checkpoint.
static lac_status begin_file(lac_store *s, const lac_store_def *def, lac_error *err)
{
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_create(&s->file, def->path, def->force || def->resume != NULL, err));
    LAC_TRY(name_time_unit(s, def, err));
    LAC_TRY(lac_store_define(s, def, err));
    if (def->resume != NULL) {
        LAC_TRY(lac_store_take_over(s, def->resume, err));
    }
    LAC_TRY(sync_file(s, err));
    LAC_TRY(lac_nc_keep_journal(&s->file, err));
    LAC_TRY(def->resume != NULL ? lac_nc_to_disk(&s->file, err) : LAC_OK);
    LAC_TRY(lac_nc_publish(&s->file, err));
    if (def->resume == NULL) {
        lac_store_remove_checkpoint(s->file.path); // of the file that was replaced
    }
out:
    return status;
}

lac_status lac_store_create(const lac_store_def *def, lac_store **out, lac_error *err)
{
    assert(def->fields == 0 || def->domain != NULL);
    *out = NULL;
    lac_status status = LAC_OK;
    lac_store *s = calloc(1, sizeof *s);
    if (s == NULL) {
        return lac_fail_memory(err);
    }
    s->fields = def->fields;
    s->cells = def->domain != NULL ? def->domain->n : 0;
    s->dated = def->dated;
    s->start_date = def->start_date;
    s->now = def->provenance.now;
    s->begun = def->resume != NULL ? def->resume->begun : s->now;
    s->sync_every = def->sync_every > 1 ? (size_t)def->sync_every : 1;
    s->capacity = s->sync_every < BATCH_MAX ? s->sync_every : BATCH_MAX;
    s->file.fd = -1;
    s->rows = malloc(s->capacity * sizeof *s->rows);
    if (s->rows == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    LAC_TRY(lac_store_create_extras(s, def, err));
    if (def->events) {
        LAC_TRY(lac_store_create_events(s, err));
    }
    LAC_TRY(keep_provenance(s, def, err));
    LAC_TRY(begin_file(s, def, err));
    *out = s;
    s = NULL;
out:
    lac_store_free(s);
    return status;
}

static const void *at(const lac_row *row, size_t offset) { return (const char *)row + offset; }

static int put_reals(const lac_store *s, size_t column)
{
    double values[BATCH_MAX];
    for (size_t i = 0; i < s->buffered; i++) {
        memcpy(&values[i], at(&s->rows[i], lac_columns[column].offset), sizeof values[i]);
        if (isnan(values[i])) {
            values[i] = NC_FILL_DOUBLE;
        }
    }
    return lac_nc_append(&s->file, NC_DOUBLE, s->columns[column], &s->written, &s->buffered,
                         values);
}

static int put_integers(const lac_store *s, size_t column)
{
    long long values[BATCH_MAX];
    const lac_column *c = &lac_columns[column];
    for (size_t i = 0; i < s->buffered; i++) {
        int64_t value = 0;
        memcpy(&value, at(&s->rows[i], c->offset), sizeof value);
        values[i] = c->var.fill && value == 0 ? NC_FILL_INT : value;
    }
    return lac_nc_append(&s->file, NC_INT64, s->columns[column], &s->written, &s->buffered, values);
}

lac_status lac_store_reserve(lac_store *s, size_t bytes, lac_error *err)
{
    s->pending += bytes;
    return lac_nc_reserve(&s->file, s->pending, err);
}

static lac_status write_rows(lac_store *s, lac_error *err)
{
    if (s->buffered == 0) {
        return LAC_OK;
    }
    size_t bytes = s->buffered * (sizeof *s->rows + s->width * sizeof *s->values);
    lac_status status = lac_store_reserve(s, bytes, err);
    if (status != LAC_OK) {
        return status;
    }
    for (size_t c = 0; c < LAC_COLUMNS; c++) {
        errno = 0;
        int code = lac_columns[c].var.type == NC_DOUBLE ? put_reals(s, c) : put_integers(s, c);
        status = lac_nc_check(s->file.path, code, err, "write", lac_columns[c].var.name);
        if (status != LAC_OK) {
            return status;
        }
    }
    status = lac_store_write_extras(s, err);
    if (status != LAC_OK) {
        return status;
    }
    s->written += s->buffered;
    s->buffered = 0;
    return LAC_OK;
}

lac_status lac_store_count(lac_store *s, lac_error *err)
{
    s->unsynced++;
    if (s->unsynced < s->sync_every) {
        return LAC_OK;
    }
    lac_status status = write_rows(s, err);
    status = status == LAC_OK ? lac_store_write_events(s, err) : status;
    return status == LAC_OK ? sync_file(s, err) : status;
}

// Only step_size may be missing.
static lac_status check_row(const lac_row *row, const char *path, lac_error *err)
{
    for (size_t c = 0; c < LAC_COLUMNS; c++) {
        const lac_column *column = &lac_columns[c];
        double value = 0.0;
        if (column->var.type != NC_DOUBLE ||
            column->offset == offsetof(lac_row, record.step_size)) {
            continue;
        }
        memcpy(&value, at(row, column->offset), sizeof value);
        if (isnan(value)) {
            return lac_fail(err, LAC_ENUMERIC, "%s: %s is not a number at t = %.9g s", path,
                            column->var.name, row->time);
        }
    }
    return LAC_OK;
}

static lac_status put_record(void *context, const lac_record *record, lac_error *err)
{
    lac_store *s = context;
    const lac_row row = {.time = record->time_origin + record->time_local,
                         .apparent_friction = record->seen.shear_force / record->seen.normal_force,
                         .record = *record};
    lac_status status = check_row(&row, s->file.path, err);
    if (status != LAC_OK) {
        return status;
    }
    double ahead = record->time_origin - s->last_origin + (record->time_local - s->last_local);
    if (s->has_last && ahead <= 0) {
        // The same instant again says nothing new; the series stays strictly increasing.
        return ahead == 0 ? LAC_OK
                          : lac_fail(err, LAC_ENUMERIC, "%s: time goes back at t = %.9g s",
                                     s->file.path, row.time);
    }
    s->has_last = true;
    s->last_origin = record->time_origin;
    s->last_local = record->time_local;
    if (s->buffered == s->capacity) {
        status = write_rows(s, err);
    }
    if (status == LAC_OK) {
        lac_store_keep_extras(s, record->extra);
        s->rows[s->buffered++] = row;
        status = lac_store_count(s, err);
    }
    return status;
}

static lac_status put_field(const lac_store *s, size_t field, const lac_snapshot *snapshot,
                            lac_error *err)
{
    const size_t start[2] = {s->snapshots, 0};
    const size_t count[2] = {1, s->cells};
    const double *values = NULL;
    memcpy(&values, (const char *)snapshot + lac_fields[field].offset, sizeof values);
    assert(values != NULL);
    return lac_nc_check(
        s->file.path, lac_nc_append(&s->file, NC_DOUBLE, s->field_ids[field], start, count, values),
        err, "write", lac_fields[field].var.name);
}

static lac_status put_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    lac_store *s = context;
    lac_status status = LAC_OK;
    if (s->fields == 0) {
        return LAC_OK;
    }
    // Incompressible at worst.
    LAC_TRY(lac_store_reserve(s, LAC_FIELDS * s->cells * (sizeof(double) + 1), err));
    errno = 0;
    for (size_t f = 0; f < LAC_FIELDS; f++) {
        if ((s->fields & lac_fields[f].flag) != 0) {
            LAC_TRY(put_field(s, f, snapshot, err));
        }
    }
    const size_t one = 1;
    LAC_TRY(lac_nc_check(
        s->file.path,
        lac_nc_append(&s->file, NC_DOUBLE, s->snapshot_time, &s->snapshots, &one, &snapshot->time),
        err, "write", "snapshot_time"));
    s->snapshots++;
    LAC_TRY(lac_store_count(s, err));
out:
    return status;
}

static void keep(void *context, lac_tape *tape)
{
    lac_store *s = context;
    uint64_t records = s->written + s->buffered;
    uint64_t snapshots = s->snapshots;
    uint64_t events = s->events_written + s->events_buffered;
    lac_tape_pass(tape, &records, sizeof records);
    lac_tape_pass(tape, &snapshots, sizeof snapshots);
    lac_tape_pass(tape, &events, sizeof events);
    lac_tape_pass(tape, &s->has_last, sizeof s->has_last);
    lac_tape_pass(tape, &s->last_origin, sizeof s->last_origin);
    lac_tape_pass(tape, &s->last_local, sizeof s->last_local);
    tape->short_of |= records != s->written + s->buffered || snapshots != s->snapshots ||
                      events != s->events_written + s->events_buffered;
}

// What was put out before is on disk before the checkpoint counts on it.
static lac_status put_checkpoint(void *context, const lac_checkpoint *checkpoint, lac_error *err)
{
    lac_store *s = context;
    lac_status status = LAC_OK;
    LAC_TRY(write_rows(s, err));
    LAC_TRY(lac_store_write_events(s, err));
    LAC_TRY(sync_file(s, err));
    LAC_TRY(lac_nc_check_place(&s->file, err));
    LAC_TRY(lac_nc_to_disk(&s->file, err));
    LAC_TRY(lac_store_put_checkpoint(s, checkpoint, err));
    s->has_checkpoint = true;
out:
    return status;
}

lac_sink lac_store_sink(lac_store *store)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = store,
                      .record = put_record,
                      .snapshot = put_snapshot,
                      .event = store->events != NULL ? lac_store_put_event : NULL,
                      .keep = keep,
                      .checkpoint = put_checkpoint,
                      .once = lac_store_put_once};
}

lac_status lac_store_finish(lac_store *store, const char *status, const lac_run_result *result,
                            double wall_time, lac_error *err)
{
    assert(store->file.open);
    // The records are on disk before the file says that it is whole.
    lac_status first = write_rows(store, err);
    first = first == LAC_OK ? lac_store_write_events(store, err) : first;
    if (first == LAC_OK) {
        first = sync_file(store, err);
    }
    lac_error *later = first == LAC_OK ? err : NULL;
    const char *said = first == LAC_OK ? status : "failed";
    lac_status second = lac_store_put_result(store, said, result, wall_time, later);
    lac_status third = lac_nc_close(&store->file, second == LAC_OK ? later : NULL);
    bool whole = first == LAC_OK && second == LAC_OK && third == LAC_OK;
    if (whole && store->has_checkpoint && strcmp(status, "complete") == 0) {
        lac_store_remove_checkpoint(store->file.path);
    }
    return first != LAC_OK ? first : second != LAC_OK ? second : third;
}

void lac_store_free(lac_store *store)
{
    if (store == NULL) {
        return;
    }
    if (store->file.open && store->file.published) {
        (void)write_rows(store, NULL);
        (void)lac_store_write_events(store, NULL);
    }
    lac_nc_clear(&store->file);
    free(store->rows);
    free(store->libraries);
    free(store->case_text);
    lac_store_clear_extras(store);
    free(store->events);
    free(store);
}
