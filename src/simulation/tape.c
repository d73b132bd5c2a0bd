// SPDX-License-Identifier: GPL-3.0-or-later
// What a run puts out, in memory one after the other: of each piece its kind, its struct, and the
// arrays that the struct points to.
#include "simulation/tape.h"

#include "run/run.h"

typedef enum piece { PIECE_RECORD, PIECE_SNAPSHOT, PIECE_EVENT, PIECE_STEP } piece;

enum { MOST_ARRAYS = LAC_SNAPSHOT_FIELDS };

// Arrays of doubles that a struct points to, NULL where there is none.
typedef struct arrays {
    size_t n, length[MOST_ARRAYS];
    const double **at[MOST_ARRAYS];
} arrays;

static void list(arrays *a, const double **at, size_t length)
{
    a->at[a->n] = at;
    a->length[a->n++] = length;
}

// What is kept of each kind.
typedef union thing {
    lac_record record;
    lac_snapshot snapshot;
    lac_event event;
    lac_step step;
} thing;

static const size_t sizes[] = {[PIECE_RECORD] = sizeof(lac_record),
                               [PIECE_SNAPSHOT] = sizeof(lac_snapshot),
                               [PIECE_EVENT] = sizeof(lac_event),
                               [PIECE_STEP] = sizeof(lac_step)};

static arrays arrays_of(const lac_tape *tape, uint64_t kind, thing *t)
{
    arrays a = {0};
    lac_record *r = &t->record;
    if (kind == PIECE_RECORD) {
        list(&a, &r->cells.slip_rate, r->cells.n);
        list(&a, &r->cells.log_state, r->cells.n);
        list(&a, &r->extra, tape->values);
        list(&a, &r->observation.points, LAC_POINT_VALUES * tape->points);
        list(&a, &r->observation.points_along, LAC_POINT_ALONG * tape->points);
    } else if (kind == PIECE_SNAPSHOT) {
        lac_snapshot_fields(&t->snapshot, a.at);
        for (; a.n < LAC_SNAPSHOT_FIELDS; a.n++) {
            a.length[a.n] = t->snapshot.n;
        }
    } else if (kind == PIECE_STEP) {
        list(&a, &t->step.slip_rate, t->step.n);
        list(&a, &t->step.slip, t->step.n);
    }
    return a;
}

static lac_status put(lac_tape *tape, piece kind, thing own, lac_error *err)
{
    uint64_t word = kind; // as wide as a double, so that arrays stand where they may
    const arrays a = arrays_of(tape, kind, &own);
    if (tape->over) {
        return LAC_OK;
    }
    LAC_PASS(&tape->kept, word);
    lac_archive_pass(&tape->kept, &own, sizes[kind]);
    for (size_t i = 0; i < a.n; i++) {
        if (*a.at[i] != NULL) {
            lac_archive_pass(&tape->kept, (void *)*a.at[i], a.length[i] * sizeof **a.at[i]);
        }
    }
    LAC_FAIL_MEMORY_IF(tape->kept.no_memory, err);
    if (tape->kept.size > tape->most) {
        lac_tape_clear(tape);
        tape->over = true;
    }
    return LAC_OK;
}

static lac_status put_record(void *context, const lac_record *record, lac_error *err)
{
    lac_tape *tape = context;
    thing own = {.record = *record};
    own.record.cells = tape->cells ? record->cells : (lac_record_cells){0};
    return put(tape, PIECE_RECORD, own, err);
}

static lac_status put_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    return put(context, PIECE_SNAPSHOT, (thing){.snapshot = *snapshot}, err);
}

static lac_status put_event(void *context, const lac_event *event, lac_error *err)
{
    return put(context, PIECE_EVENT, (thing){.event = *event}, err);
}

static lac_status put_step(void *context, const lac_step *step, lac_error *err)
{
    return put(context, PIECE_STEP, (thing){.step = *step}, err);
}

lac_sink lac_tape_sink(lac_tape *tape)
{
    lac_sink sink = lac_sink_default();
    sink.context = tape;
    sink.record = put_record;
    sink.snapshot = put_snapshot;
    sink.event = put_event;
    sink.step = tape->steps ? put_step : NULL;
    return sink;
}

// The arrays are used where they are.
static void find(lac_archive *from, const arrays *a)
{
    for (size_t i = 0; i < a->n; i++) {
        if (*a->at[i] != NULL) {
            *a->at[i] = (const double *)(const void *)(from->bytes + from->at);
            from->at += a->length[i] * sizeof **a->at[i];
        }
    }
}

static lac_status hand_on(const lac_sink *to, uint64_t kind, const thing *t, lac_error *err)
{
    if (kind == PIECE_RECORD && to->record != NULL) {
        return to->record(to->context, &t->record, err);
    }
    if (kind == PIECE_SNAPSHOT && to->snapshot != NULL) {
        return to->snapshot(to->context, &t->snapshot, err);
    }
    if (kind == PIECE_EVENT && to->event != NULL) {
        return to->event(to->context, &t->event, err);
    }
    return kind == PIECE_STEP && to->step != NULL ? to->step(to->context, &t->step, err) : LAC_OK;
}

lac_status lac_tape_play(const lac_tape *tape, const lac_sink *to, lac_error *err)
{
    lac_archive from = tape->kept;
    from.loading = true;
    while (from.at < from.size) {
        uint64_t kind;
        thing t;
        LAC_PASS(&from, kind);
        lac_archive_pass(&from, &t, sizes[kind]);
        const arrays a = arrays_of(tape, kind, &t);
        find(&from, &a);
        LAC_TRY_RETURN(hand_on(to, kind, &t, err));
    }
    return LAC_OK;
}

void lac_tape_clear(lac_tape *tape)
{
    free(tape->kept.bytes);
    tape->kept = (lac_archive){0};
}
