// SPDX-License-Identifier: GPL-3.0-or-later
// What the program keeps of a run's records while it goes on, for what it says afterwards.
#include "cli/run/run_outcome.h"

static size_t columns_of(const cli_kept *kept) { return 3 + 2 * kept->points; }

// Room for so many records: all series in one array.
static lac_status make_room(cli_kept *kept, size_t n, lac_error *err)
{
    const size_t least = kept->room > 0 ? 2 * kept->room : 1024, room = n > least ? n : least;
    if (n <= kept->room) {
        return LAC_OK;
    }
    double *grown = realloc(kept->values, columns_of(kept) * room * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    for (size_t k = columns_of(kept); k-- > 1;) {
        memmove(grown + k * room, grown + k * kept->room, kept->n * sizeof *grown);
    }
    kept->room = room;
    kept->values = grown;
    return LAC_OK;
}

static lac_status keep_record(cli_history *h, const lac_record *record, lac_error *err)
{
    cli_kept *kept = &h->kept;
    LAC_TRY_RETURN(make_room(kept, kept->n + 1, err));
    const double *at_points = record->observation.points;
    double *to = kept->values + kept->n++;
    to[0] = h->clock + record->time_origin + record->time_local;
    to[kept->room] = record->observation.mean_slip;
    to[2 * kept->room] = record->observation.mean_rate;
    for (size_t i = 0; at_points != NULL && i < kept->points; i++, at_points += LAC_POINT_VALUES) {
        to[(3 + 2 * i) * kept->room] = at_points[LAC_POINT_SLIP];
        to[(4 + 2 * i) * kept->room] = at_points[LAC_POINT_RATE];
    }
    return LAC_OK;
}

// Of a record without what holds only as long as it does.
static lac_record lasting(const lac_record *record)
{
    lac_record own = *record;
    own.observation.points = own.observation.points_along = NULL;
    return own;
}

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    cli_history *h = context;
    if (!h->begun) {
        h->first = lasting(record);
        h->begun = true;
    }
    h->last = lasting(record);
    lac_status status = h->keep ? keep_record(h, record, err) : LAC_OK;
    if (status == LAC_OK && h->next.record != NULL) {
        status = h->next.record(h->next.context, record, err);
    }
    return status;
}

// The events of the interface as a whole are followed where all cells are together.
static lac_status on_step(void *context, const lac_step *step, lac_error *err)
{
    cli_history *h = context;
    if (step->changed == NULL) {
        LAC_TRY_RETURN(lac_slip_events_step(&h->slip_events, step, err));
    }
    return h->next.step != NULL ? h->next.step(h->next.context, step, err) : LAC_OK;
}

// Of the first and the last record only what is seen is told; the kept series as long as they are.
static void on_keep(void *context, lac_archive *archive)
{
    cli_history *h = context;
    cli_kept *kept = &h->kept;
    size_t n = kept->n;
    lac_archive_pass(archive, &h->begun, sizeof h->begun);
    lac_archive_pass(archive, &h->first.observation, sizeof h->first.observation);
    lac_archive_pass(archive, &h->last.observation, sizeof h->last.observation);
    lac_archive_pass(archive, &n, sizeof n);
    if (n > kept->room && lac_archive_good(archive)) {
        archive->short_of = n > archive->size / sizeof(double);
        archive->no_memory = !archive->short_of && make_room(kept, n, NULL) != LAC_OK;
    }
    if (lac_archive_good(archive)) {
        kept->n = n;
        for (size_t k = 0; n > 0 && k < columns_of(kept); k++) {
            lac_archive_pass(archive, kept->values + k * kept->room, n * sizeof *kept->values);
        }
    }
    lac_slip_events_serialize(&h->slip_events, archive);
    if (h->next.serialize != NULL) {
        h->next.serialize(h->next.context, archive);
    }
}

lac_sink cli_history_sink(cli_history *history)
{
    lac_sink sink = lac_sink_before(&history->next);
    sink.record = on_record;
    sink.step = on_step;
    sink.serialize = on_keep;
    sink.cells_from = fmin(sink.cells_from, LAC_SLIP_EVENT_FALL);
    return sink;
}
