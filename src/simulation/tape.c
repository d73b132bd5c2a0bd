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
    if (tape->over) {
        return LAC_OK;
    }
    if (kind == PIECE_RECORD && !tape->cells) {
        own.record.cells = (lac_record_cells){0};
    }
    const arrays a = arrays_of(tape, kind, &own);
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

// How a piece comes in, and goes out where somebody takes it.
#define PIECE(kind, what)                                                               \
    static lac_status put_##what(void *context, const lac_##what *from, lac_error *err) \
    {                                                                                   \
        return put(context, (kind), (thing){.what = *from}, err);                       \
    }                                                                                   \
    static lac_status play_##what(const lac_sink *to, const thing *t, lac_error *err)   \
    {                                                                                   \
        return to->what != NULL ? to->what(to->context, &t->what, err) : LAC_OK;        \
    }
PIECE(PIECE_RECORD, record)
PIECE(PIECE_SNAPSHOT, snapshot)
PIECE(PIECE_EVENT, event)
PIECE(PIECE_STEP, step)

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

lac_status lac_tape_play(const lac_tape *tape, const lac_sink *to, lac_error *err)
{
    static lac_status (*const play[])(const lac_sink *, const thing *,
                                      lac_error *) = {[PIECE_RECORD] = play_record,
                                                      [PIECE_SNAPSHOT] = play_snapshot,
                                                      [PIECE_EVENT] = play_event,
                                                      [PIECE_STEP] = play_step};
    lac_archive from = tape->kept;
    from.loading = true;
    while (from.at < from.size) {
        uint64_t kind;
        thing t;
        LAC_PASS(&from, kind);
        lac_archive_pass(&from, &t, sizes[kind]);
        const arrays a = arrays_of(tape, kind, &t);
        find(&from, &a);
        LAC_TRY_RETURN(play[kind](to, &t, err));
    }
    return LAC_OK;
}

void lac_tape_clear(lac_tape *tape)
{
    free(tape->kept.bytes);
    tape->kept = (lac_archive){0};
}
