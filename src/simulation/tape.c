// SPDX-License-Identifier: GPL-3.0-or-later
// What a run puts out, in memory one after the other: of each piece its kind, its struct, and the
// arrays that the struct points to.
#include "simulation/tape.h"

#include "run/points.h"

typedef enum piece { PIECE_RECORD, PIECE_SNAPSHOT, PIECE_EVENT, PIECE_STEP } piece;

enum { MOST_ARRAYS = 15 };

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

static arrays of_record(const lac_tape *tape, lac_record *r)
{
    arrays a = {0};
    list(&a, &r->cells.slip_rate, r->cells.n);
    list(&a, &r->cells.log_state, r->cells.n);
    list(&a, &r->extra, tape->values);
    list(&a, &r->observation.points, LAC_POINT_VALUES * tape->points);
    list(&a, &r->observation.points_along, LAC_POINT_ALONG * tape->points);
    return a;
}

static arrays of_snapshot(lac_snapshot *s)
{
    const double **at[] = {&s->slip,        &s->slip_rate,        &s->state,
                           &s->traction,    &s->factor_of_safety, &s->pore,
                           &s->excess_pore, &s->temperature,      &s->broken};
    arrays a = {0};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        list(&a, at[i], s->n);
    }
    for (size_t i = 0; i < LAC_POINT_ALONG; i++) {
        list(&a, &s->along[i], s->n);
    }
    return a;
}

static lac_status put(lac_tape *tape, piece kind, void *thing, size_t size, const arrays *a,
                      lac_error *err)
{
    uint64_t word = kind; // as wide as a double, so that arrays stand where they may
    if (tape->over) {
        return LAC_OK;
    }
    LAC_PASS(&tape->kept, word);
    lac_archive_pass(&tape->kept, thing, size);
    for (size_t i = 0; i < a->n; i++) {
        if (*a->at[i] != NULL) {
            lac_archive_pass(&tape->kept, (void *)*a->at[i], a->length[i] * sizeof **a->at[i]);
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
    lac_record own = *record;
    own.cells = tape->cells ? own.cells : (lac_record_cells){0};
    const arrays a = of_record(tape, &own);
    return put(tape, PIECE_RECORD, &own, sizeof own, &a, err);
}

static lac_status put_snapshot(void *context, const lac_snapshot *snapshot, lac_error *err)
{
    lac_snapshot own = *snapshot;
    const arrays a = of_snapshot(&own);
    return put(context, PIECE_SNAPSHOT, &own, sizeof own, &a, err);
}

static lac_status put_event(void *context, const lac_event *event, lac_error *err)
{
    lac_event own = *event;
    return put(context, PIECE_EVENT, &own, sizeof own, &(arrays){0}, err);
}

static arrays of_step(lac_step *s)
{
    arrays a = {0};
    list(&a, &s->slip_rate, s->n);
    list(&a, &s->slip, s->n);
    return a;
}

static lac_status put_step(void *context, const lac_step *step, lac_error *err)
{
    lac_step own = *step;
    const arrays a = of_step(&own);
    return put(context, PIECE_STEP, &own, sizeof own, &a, err);
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

static lac_status play_record(const lac_tape *tape, lac_archive *from, const lac_sink *to,
                              lac_error *err)
{
    lac_record record;
    LAC_PASS(from, record);
    const arrays a = of_record(tape, &record);
    find(from, &a);
    return to->record != NULL ? to->record(to->context, &record, err) : LAC_OK;
}

static lac_status play_snapshot(lac_archive *from, const lac_sink *to, lac_error *err)
{
    lac_snapshot snapshot;
    LAC_PASS(from, snapshot);
    const arrays a = of_snapshot(&snapshot);
    find(from, &a);
    return to->snapshot != NULL ? to->snapshot(to->context, &snapshot, err) : LAC_OK;
}

static lac_status play_event(lac_archive *from, const lac_sink *to, lac_error *err)
{
    lac_event event;
    LAC_PASS(from, event);
    return to->event != NULL ? to->event(to->context, &event, err) : LAC_OK;
}

static lac_status play_step(lac_archive *from, const lac_sink *to, lac_error *err)
{
    lac_step step;
    LAC_PASS(from, step);
    const arrays a = of_step(&step);
    find(from, &a);
    return to->step != NULL ? to->step(to->context, &step, err) : LAC_OK;
}

lac_status lac_tape_play(const lac_tape *tape, const lac_sink *to, lac_error *err)
{
    lac_archive from = tape->kept;
    from.loading = true;
    while (from.at < from.size) {
        uint64_t kind;
        LAC_PASS(&from, kind);
        const lac_status status = kind == PIECE_RECORD     ? play_record(tape, &from, to, err)
                                  : kind == PIECE_SNAPSHOT ? play_snapshot(&from, to, err)
                                  : kind == PIECE_STEP     ? play_step(&from, to, err)
                                                           : play_event(&from, to, err);
        LAC_TRY_RETURN(status);
    }
    return LAC_OK;
}

void lac_tape_clear(lac_tape *tape)
{
    free(tape->kept.bytes);
    tape->kept = (lac_archive){0};
}
