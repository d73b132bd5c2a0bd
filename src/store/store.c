// SPDX-License-Identifier: GPL-3.0-or-later
// The sink of a run: records buffered and written in batches, snapshots at once.
#include "store/internal.h"

#include <assert.h>

#include "base/temp_file.h"

enum {
    BATCH_MAX = 512, // records kept in memory at most
    CHUNK = 512      // records a chunk: 4 kB, what a sync rewrites of each variable
};

static lac_status sync_file(lac_store *s, lac_error *err)
{
    LAC_TRY_RETURN(lac_writer_sync(&s->writer, err));
    s->unsynced = 0;
    return LAC_OK;
}

// A new file, or the one that is there up to its checkpoint.
static lac_status begin_file(lac_store *s, const lac_store_def *def, lac_error *err)
{
    LAC_TRY_RETURN(lac_nc_create(&s->file, def->path, def->force || def->resume != NULL, err));
    LAC_TRY_RETURN(lac_provenance_put(&def->provenance, s->dataset->summary, lac_nc_put_attribute,
                                      &s->file, err));
    LAC_TRY_RETURN(lac_nc_text(&s->file, NC_GLOBAL, "status", "running", err));
    LAC_TRY_RETURN(lac_writer_begin(&s->writer, err));
    if (def->resume != NULL) {
        LAC_TRY_RETURN(lac_store_take_over(s, def->resume, err));
    }
    LAC_TRY_RETURN(sync_file(s, err));
    LAC_TRY_RETURN(lac_nc_keep_journal(&s->file, err));
    LAC_TRY_RETURN(def->resume != NULL ? lac_nc_to_disk(&s->file, err) : LAC_OK);
    LAC_TRY_RETURN(lac_nc_publish(&s->file, err));
    if (def->resume == NULL) {
        lac_store_remove_checkpoint(s->file.path); // of the file that was replaced
    }
    return LAC_OK;
}

lac_status lac_store_create(const lac_store_def *def, lac_store **out, lac_error *err)
{
    const lac_provenance *from = &def->provenance;
    assert(def->of.fields == 0 || def->of.domain != NULL);
    lac_status status = LAC_OK;
    lac_store *s = *out = calloc(1, sizeof *s);
    LAC_FAIL_MEMORY_IF(s == NULL, err);
    s->place.of = def->of;
    s->now = def->provenance.now;
    s->begun = def->resume != NULL ? def->resume->begun : s->now;
    s->sync_every = def->sync_every > 1 ? (size_t)def->sync_every : 1;
    s->file.fd = -1;
    LAC_TRY(lac_run_describe(&s->place, &s->dataset, err));
    s->writer = (lac_writer){.file = &s->file,
                             .dataset = s->dataset,
                             .single = def->single,
                             .deflate = (int)def->compression,
                             .chunk = CHUNK,
                             .batch = s->sync_every < BATCH_MAX ? s->sync_every : BATCH_MAX};
    s->libraries = lac_text_join("", "", from->libraries != NULL ? from->libraries : "");
    s->case_text = lac_text_join(from->case_text != NULL ? from->case_text : "", "",
                                 def->inputs != NULL ? def->inputs : "");
    LAC_TRY(s->libraries != NULL && s->case_text != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(begin_file(s, def, err));
out:
    LAC_MADE(status, out, lac_store_free);
}

// Counts what was put out; syncs the file when there is enough of it.
static lac_status count(lac_store *s, lac_error *err)
{
    s->unsynced++;
    return s->unsynced < s->sync_every ? LAC_OK : sync_file(s, err);
}

static lac_status put_record(void *context, const lac_record *record, lac_error *err)
{
    lac_store *s = context;
    lac_run_place_record(&s->place, record);
    double ahead = record->time_origin - s->last_origin + (record->time_local - s->last_local);
    if (s->has_last && ahead <= 0) {
        // The same instant again says nothing new; the series stays strictly increasing.
        return ahead == 0 ? LAC_OK
                          : lac_fail(err, LAC_ENUMERIC, "%s: time goes back at t = %.9g s",
                                     s->file.path, record->time_origin + record->time_local);
    }
    s->has_last = true;
    s->last_origin = record->time_origin;
    s->last_local = record->time_local;
    const char *lacks = NULL; // only what a table says may be missing
    const lac_status status = lac_writer_put(&s->writer, "time", &lacks, err);
    LAC_FAIL_IF(lacks != NULL, err, LAC_ENUMERIC, "%s: %s is not a number at t = %.9g s",
                s->file.path, lacks, record->time_origin + record->time_local);
    return status == LAC_OK ? count(s, err) : status;
}

static lac_status put_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    lac_store *s = context;
    s->place.snapshot = *snapshot;
    if (isnan(snapshot->time)) {
        return lac_writer_put_part(&s->writer, "snapshot", snapshot->first, snapshot->n, err);
    }
    lac_status status = lac_writer_put(&s->writer, "snapshot", NULL, err);
    return status == LAC_OK && s->place.of.fields != 0 ? count(s, err) : status;
}

static lac_status put_event(void *context, const lac_event *event, lac_error *err)
{
    lac_store *s = context;
    s->place.event = *event;
    lac_status status = lac_writer_put(&s->writer, "event", NULL, err);
    return status == LAC_OK ? count(s, err) : status;
}

static lac_status put_once(void *context, const double *once, lac_error *err)
{
    lac_store *s = context;
    s->place.once = once;
    lac_status status = lac_writer_put_late(&s->writer, err);
    s->place.once = NULL;
    return status;
}

static void keep(void *context, lac_archive *archive)
{
    static const char *const dims[] = {"time", "snapshot", "event"};
    lac_store *s = context;
    for (size_t i = 0; i < sizeof dims / sizeof *dims; i++) {
        const uint64_t own = lac_writer_places(&s->writer, dims[i]);
        uint64_t places = own;
        lac_archive_pass(archive, &places, sizeof places);
        archive->short_of |= places != own;
    }
    LAC_PASS(archive, s->has_last);
    LAC_PASS_RUN(archive, s->last_origin, s->last_local);
}

// What was put out before is on disk before the checkpoint counts on it.
static lac_status put_checkpoint(void *context, const lac_checkpoint *checkpoint, lac_error *err)
{
    lac_store *s = context;
    LAC_TRY_RETURN(sync_file(s, err));
    LAC_TRY_RETURN(lac_nc_check_place(&s->file, err));
    LAC_TRY_RETURN(lac_nc_to_disk(&s->file, err));
    LAC_TRY_RETURN(lac_store_put_checkpoint(s, checkpoint, err));
    s->has_checkpoint = true;
    return LAC_OK;
}

lac_sink lac_store_sink(lac_store *store)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = store,
                      .record = put_record,
                      .snapshot = put_snapshot,
                      .event = store->place.of.events ? put_event : NULL,
                      .serialize = keep,
                      .checkpoint = put_checkpoint,
                      .once = put_once,
                      .cells_from = INFINITY};
}

static lac_status put_ending(const lac_store *s, const lac_run_ending *ending, lac_error *err)
{
    lac_dataset *dataset = NULL;
    lac_status status = lac_run_ending_describe(ending, &dataset, err);
    status = status == LAC_OK ? lac_dataset_put_attributes(dataset, false, lac_nc_put_attribute,
                                                           (void *)&s->file, err)
                              : status;
    lac_dataset_free(dataset);
    return status;
}

lac_status lac_store_finish(lac_store *store, const char *status, const lac_run_result *result,
                            double wall_time, lac_error *err)
{
    assert(store->file.open);
    // The records are on disk before the file says that it is whole.
    lac_status first = sync_file(store, err);
    lac_error *later = first == LAC_OK ? err : NULL;
    const lac_run_ending ending = {.result = result,
                                   .status = first == LAC_OK ? status : "failed",
                                   .dated = store->place.of.dated,
                                   .start_date = store->place.of.start_date,
                                   .wall_time = wall_time,
                                   .now = store->now};
    lac_status second = put_ending(store, &ending, later);
    lac_status third = lac_nc_close(&store->file, second == LAC_OK ? later : NULL);
    bool whole = first == LAC_OK && second == LAC_OK && third == LAC_OK;
    if (whole && store->has_checkpoint && strcmp(status, "complete") == 0) {
        lac_store_remove_checkpoint(store->file.path);
    }
    return first != LAC_OK ? first : second != LAC_OK ? second : third;
}

bool lac_store_has_checkpoint(const lac_store *store) { return store->has_checkpoint; }

void lac_store_free(lac_store *store)
{
    if (store == NULL) {
        return;
    }
    if (store->file.open && store->file.published) {
        (void)lac_writer_flush(&store->writer, NULL);
    }
    lac_nc_clear(&store->file);
    lac_writer_clear(&store->writer);
    lac_dataset_free(store->dataset);
    free(store->libraries);
    free(store->case_text);
    free(store);
}
