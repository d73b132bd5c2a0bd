// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/view_inbox.h"

#include <stdlib.h>
#include <string.h>

#include "lacuna/store.h"

// A viewer that is busy for long must not eat the run's memory.
static const size_t most_bytes = (size_t)1 << 28;

typedef enum kind { RECORD, SNAPSHOT, EVENT } kind;

typedef struct entry {
    kind what;
    size_t size; // of all that follows [bytes]
} entry;

enum { FIELDS = 4 };
static const unsigned flags[FIELDS] = {LAC_FIELD_SLIP, LAC_FIELD_RATE, LAC_FIELD_STATE,
                                       LAC_FIELD_TRACTION};

bool cli_inbox_create(cli_inbox *inbox)
{
    *inbox = (cli_inbox){.most = most_bytes};
    return pthread_mutex_init(&inbox->lock, NULL) == 0;
}

void cli_inbox_clear(cli_inbox *inbox)
{
    (void)pthread_mutex_destroy(&inbox->lock);
    free(inbox->bytes);
}

// A piece of what is kept.
typedef struct piece {
    const void *at;
    size_t size;
} piece;

static bool make_room(cli_inbox *inbox, size_t more)
{
    size_t room = inbox->room > 0 ? inbox->room : (size_t)1 << 16;
    if (inbox->used + more > inbox->most && inbox->used > 0) {
        return false;
    }
    while (room - inbox->used < more) {
        room *= 2;
    }
    if (room > inbox->room) {
        unsigned char *grown = realloc(inbox->bytes, room);
        if (grown == NULL) {
            return false;
        }
        inbox->bytes = grown;
        inbox->room = room;
    }
    return true;
}

static void put(cli_inbox *inbox, kind what, size_t count, const piece *pieces)
{
    entry head = {.what = what};
    for (size_t i = 0; i < count; i++) {
        head.size += pieces[i].size;
    }
    (void)pthread_mutex_lock(&inbox->lock);
    if (make_room(inbox, sizeof head + head.size)) {
        memcpy(inbox->bytes + inbox->used, &head, sizeof head);
        inbox->used += sizeof head;
        for (size_t i = 0; i < count; i++) {
            if (pieces[i].size > 0) {
                memcpy(inbox->bytes + inbox->used, pieces[i].at, pieces[i].size);
            }
            inbox->used += pieces[i].size;
        }
    } else {
        inbox->missing = true;
    }
    (void)pthread_mutex_unlock(&inbox->lock);
}

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    cli_inbox *inbox = context;
    const lac_status status = inbox->next.record(inbox->next.context, record, err);
    if (status == LAC_OK) {
        const size_t extras = record->extra != NULL ? inbox->extras : 0;
        const piece pieces[] = {{record, sizeof *record},
                                {record->extra, extras * sizeof *record->extra}};
        put(inbox, RECORD, 2, pieces);
    }
    return status;
}

// The fields that are kept, in their order.
static size_t fields_of(const cli_inbox *inbox, const lac_snapshot *snapshot, piece *pieces)
{
    const double *const all[FIELDS] = {snapshot->slip, snapshot->slip_rate, snapshot->state,
                                       snapshot->traction};
    size_t n = 0;
    for (size_t f = 0; f < FIELDS; f++) {
        if ((inbox->fields & flags[f]) != 0) {
            pieces[n++] = (piece){all[f], inbox->cells * sizeof(double)};
        }
    }
    return n;
}

static lac_status on_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    cli_inbox *inbox = context;
    const lac_status status = inbox->next.snapshot(inbox->next.context, snapshot, err);
    if (status == LAC_OK && inbox->cells > 0 && inbox->fields != 0) {
        piece pieces[1 + FIELDS] = {{&snapshot->time, sizeof snapshot->time}};
        put(inbox, SNAPSHOT, 1 + fields_of(inbox, snapshot, pieces + 1), pieces);
    }
    return status;
}

static lac_status on_event(void *context, const lac_event *event, lac_error *err)
{
    cli_inbox *inbox = context;
    const lac_status status = inbox->next.event(inbox->next.context, event, err);
    if (status == LAC_OK) {
        const piece pieces[] = {{event, sizeof *event}};
        put(inbox, EVENT, 1, pieces);
    }
    return status;
}

// The viewer is no part of what a checkpoint keeps.
static void on_keep(void *context, lac_tape *tape)
{
    cli_inbox *inbox = context;
    inbox->next.keep(inbox->next.context, tape);
}

static lac_status on_checkpoint(void *context, const lac_checkpoint *checkpoint, lac_error *err)
{
    cli_inbox *inbox = context;
    return inbox->next.checkpoint(inbox->next.context, checkpoint, err);
}

static lac_status on_once(void *context, const double *values, lac_error *err)
{
    cli_inbox *inbox = context;
    return inbox->next.once(inbox->next.context, values, err);
}

lac_sink cli_inbox_sink(cli_inbox *inbox)
{
    const lac_sink *next = &inbox->next;
    return (lac_sink){.context = inbox,
                      .record = on_record,
                      .snapshot = next->snapshot != NULL ? on_snapshot : NULL,
                      .event = next->event != NULL ? on_event : NULL,
                      .keep = next->keep != NULL ? on_keep : NULL,
                      .checkpoint = next->checkpoint != NULL ? on_checkpoint : NULL,
                      .once = next->once != NULL ? on_once : NULL};
}

void cli_inbox_progress(cli_inbox *inbox, const lac_progress *progress)
{
    if (pthread_mutex_trylock(&inbox->lock) == 0) { // else the next step tells
        inbox->progress = *progress;
        inbox->moved = true;
        (void)pthread_mutex_unlock(&inbox->lock);
    }
}

// Values in the order in which fields_of laid them down.
static void lay_out(const cli_inbox *inbox, const double *values, lac_snapshot *snapshot)
{
    const double **const all[FIELDS] = {&snapshot->slip, &snapshot->slip_rate, &snapshot->state,
                                        &snapshot->traction};
    for (size_t f = 0; f < FIELDS; f++) {
        if ((inbox->fields & flags[f]) != 0) {
            *all[f] = values;
            values += inbox->cells;
        }
    }
}

static lac_status pass_record(const unsigned char *at, size_t size, double *extra,
                              const lac_sink *sink)
{
    lac_record record;
    memcpy(&record, at, sizeof record);
    memcpy(extra, at + sizeof record, size - sizeof record);
    record.extra = size > sizeof record ? extra : NULL;
    record.cells = (lac_record_cells){0}; // the run's arrays have moved on
    return sink->record(sink->context, &record, NULL);
}

static lac_status pass_snapshot(const cli_inbox *inbox, const unsigned char *at, size_t size,
                                const lac_sink *sink)
{
    lac_snapshot snapshot = {0};
    lac_status status = LAC_ENOMEM;
    double *values = malloc(size); // aligned
    if (values != NULL) {
        memcpy(values, at, size);
        snapshot.time = values[0];
        lay_out(inbox, values + 1, &snapshot);
        status = sink->snapshot(sink->context, &snapshot, NULL);
    }
    free(values);
    return status;
}

static lac_status pass(const cli_inbox *inbox, const entry *head, const unsigned char *at,
                       double *extra, const lac_sink *sink)
{
    lac_event event;
    switch (head->what) {
    case RECORD:
        return pass_record(at, head->size, extra, sink);
    case SNAPSHOT:
        return pass_snapshot(inbox, at, head->size, sink);
    case EVENT:
        memcpy(&event, at, sizeof event);
        return sink->event(sink->context, &event, NULL);
    }
    return LAC_OK;
}

size_t cli_inbox_empty(cli_inbox *inbox, const lac_sink *sink, lac_progress *progress, bool *moved)
{
    size_t count = 0;
    (void)pthread_mutex_lock(&inbox->lock);
    unsigned char *bytes = inbox->bytes;
    const size_t used = inbox->used;
    inbox->bytes = NULL;
    inbox->used = inbox->room = 0;
    *progress = inbox->progress;
    *moved = inbox->moved;
    inbox->moved = false;
    (void)pthread_mutex_unlock(&inbox->lock);
    double *extra = malloc((inbox->extras + 1) * sizeof *extra);
    bool whole = extra != NULL || used == 0;
    for (size_t at = 0; extra != NULL && at < used; count++) {
        entry head;
        memcpy(&head, bytes + at, sizeof head);
        whole = pass(inbox, &head, bytes + at + sizeof head, extra, sink) == LAC_OK && whole;
        at += sizeof head + head.size;
    }
    free(extra);
    free(bytes);
    if (!whole) {
        (void)pthread_mutex_lock(&inbox->lock);
        inbox->missing = true;
        (void)pthread_mutex_unlock(&inbox->lock);
    }
    return count;
}

bool cli_inbox_missing(cli_inbox *inbox)
{
    (void)pthread_mutex_lock(&inbox->lock);
    const bool missing = inbox->missing;
    (void)pthread_mutex_unlock(&inbox->lock);
    return missing;
}
