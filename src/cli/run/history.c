// SPDX-License-Identifier: GPL-3.0-or-later
// A sink that stands before the file's: it keeps the motion for the summary and the comparison.
#include "cli/run/history.h"

#include <stdlib.h>

static bool grow(double **array, size_t room)
{
    double *grown = realloc(*array, room * sizeof *grown);
    if (grown == NULL) {
        return false;
    }
    *array = grown;
    return true;
}

static lac_status make_room(cli_history *h, lac_error *err)
{
    if (h->n < h->room) {
        return LAC_OK;
    }
    size_t room = h->room > 0 ? 2 * h->room : 1024;
    if (!grow(&h->time, room) || !grow(&h->slip, room) || !grow(&h->rate, room)) {
        return lac_fail_memory(err);
    }
    h->room = room;
    return LAC_OK;
}

static lac_status keep_record(cli_history *h, const lac_record *record, lac_error *err)
{
    lac_status status = make_room(h, err);
    if (status == LAC_OK) {
        h->time[h->n] = h->clock + record->time_origin + record->time_local;
        h->slip[h->n] = record->seen.mean_slip;
        h->rate[h->n] = record->seen.mean_rate;
        h->n++;
    }
    return status;
}

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    cli_history *h = context;
    if (!h->begun) {
        h->first = *record;
        h->begun = true;
    }
    h->last = *record;
    lac_status status = h->keep ? keep_record(h, record, err) : LAC_OK;
    if (status == LAC_OK && h->next.record != NULL) {
        status = h->next.record(h->next.context, record, err);
    }
    return status;
}

static lac_status on_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    cli_history *h = context;
    return h->next.snapshot != NULL ? h->next.snapshot(h->next.context, snapshot, err) : LAC_OK;
}

static lac_status on_event(void *context, const lac_event *event, lac_error *err)
{
    cli_history *h = context;
    return h->next.event != NULL ? h->next.event(h->next.context, event, err) : LAC_OK;
}

// The kept series, as long as it is.
static void pass_series(cli_history *h, lac_tape *tape)
{
    size_t n = h->n;
    lac_tape_pass(tape, &n, sizeof n);
    if (n > h->room && lac_tape_good(tape)) {
        tape->short_of = n > tape->size / sizeof(double);
        bool room = !tape->short_of && grow(&h->time, n) && grow(&h->slip, n) && grow(&h->rate, n);
        tape->no_memory = !room && !tape->short_of;
        h->room = room ? n : h->room;
    }
    if (!lac_tape_good(tape)) {
        return;
    }
    h->n = n;
    lac_tape_pass(tape, h->time, n * sizeof *h->time);
    lac_tape_pass(tape, h->slip, n * sizeof *h->slip);
    lac_tape_pass(tape, h->rate, n * sizeof *h->rate);
}

// Of the first and the last record only what is seen is told.
static void on_keep(void *context, lac_tape *tape)
{
    cli_history *h = context;
    lac_tape_pass(tape, &h->begun, sizeof h->begun);
    lac_tape_pass(tape, &h->first.seen, sizeof h->first.seen);
    lac_tape_pass(tape, &h->last.seen, sizeof h->last.seen);
    pass_series(h, tape);
    if (h->next.keep != NULL) {
        h->next.keep(h->next.context, tape);
    }
}

static lac_status on_checkpoint(void *context, const lac_checkpoint *checkpoint, lac_error *err)
{
    cli_history *h = context;
    lac_status status = h->next.checkpoint(h->next.context, checkpoint, err);
    if (status == LAC_OK) {
        h->saved = true;
        h->saved_at = checkpoint->time;
    }
    return status;
}

static lac_status on_once(void *context, const double *values, lac_error *err)
{
    cli_history *h = context;
    return h->next.once != NULL ? h->next.once(h->next.context, values, err) : LAC_OK;
}

lac_sink cli_history_sink(cli_history *history)
{
    return (lac_sink){.size = sizeof(lac_sink),
                      .context = history,
                      .record = on_record,
                      .snapshot = on_snapshot,
                      .event = on_event,
                      .keep = on_keep,
                      .checkpoint = history->next.checkpoint != NULL ? on_checkpoint : NULL,
                      .once = on_once};
}

lac_history cli_history_view(const cli_history *history)
{
    return (lac_history){
        .n = history->n, .time = history->time, .slip = history->slip, .rate = history->rate};
}

void cli_history_clear(cli_history *history)
{
    free(history->time);
    free(history->slip);
    free(history->rate);
    *history = (cli_history){0};
}
