// SPDX-License-Identifier: GPL-3.0-or-later
// A catalogue on its way to a checkpoint and back.
#include <stdlib.h>

#include "analysis/catalogue.h"

#define PASS(tape, thing) lac_tape_pass(tape, &(thing), sizeof(thing))

// Zeroed room for `count` things that take at least `least` bytes each on the tape; NULL where it
// cannot hold as many.
static void *room_for(lac_tape *tape, size_t count, size_t least, size_t size)
{
    if (!lac_tape_good(tape) || count > (tape->size - tape->at) / least) {
        tape->short_of |= lac_tape_good(tape);
        return NULL;
    }
    void *room = calloc(count + 1, size);
    tape->no_memory = room == NULL;
    return room;
}

// As a byte: not every byte is a bool.
static void pass_bool(lac_tape *tape, bool *value)
{
    uint8_t byte = *value ? 1 : 0;
    PASS(tape, byte);
    *value = byte != 0;
}

static void pass_event(lac_tape *tape, lac_open_event *e)
{
    PASS(tape, e->origin);
    PASS(tape, e->local);
    PASS(tape, e->first);
    PASS(tape, e->slip);
    PASS(tape, e->max_rate);
    PASS(tape, e->moving);
    PASS(tape, e->count);
    pass_bool(tape, &e->open);
    pass_bool(tape, &e->before);
    size_t count = e->open ? e->count : 0; // of a vacant place there is but the next one
    if (tape->loading) {
        e->cells = room_for(tape, count, sizeof *e->cells, sizeof *e->cells);
        e->room = e->count = e->cells != NULL ? count : 0;
    }
    lac_tape_pass(tape, e->cells, count * sizeof *e->cells);
}

static void pass_open(lac_catalogue *c, lac_tape *tape)
{
    size_t places = c->places;
    PASS(tape, c->vacant);
    PASS(tape, places);
    if (tape->loading) {
        c->open = room_for(tape, places, sizeof c->open->origin, sizeof *c->open);
        c->places = c->open != NULL ? places : 0;
    }
    for (size_t i = 0; i < c->places; i++) {
        pass_event(tape, &c->open[i]);
    }
}

// The cells that move, in their order, with their slip when they began to.
static void pass_moving(lac_catalogue *c, lac_tape *tape)
{
    PASS(tape, c->actives);
    if (c->actives > c->domain->n) {
        tape->short_of = true;
        c->actives = 0;
    }
    lac_tape_pass(tape, c->active, c->actives * sizeof *c->active);
    for (size_t k = 0; k < c->actives && lac_tape_good(tape); k++) {
        uint32_t cell = c->active[k];
        if (cell >= c->domain->n || (tape->loading && c->moves[cell])) {
            tape->short_of = true;
            return;
        }
        PASS(tape, c->slip_at_rise[cell]);
        c->moves[cell] = 1;
        c->place[cell] = (uint32_t)k;
    }
}

// Whether every number that is used as an index is one.
static bool is_sound(const lac_catalogue *c)
{
    const size_t n = c->domain->n;
    bool sound = c->vacant == UINT32_MAX || c->vacant < c->places;
    for (size_t i = 0; i < n; i++) {
        sound &= c->event[i] == UINT32_MAX || c->event[i] < c->places;
        sound &= !c->moves[i] || c->event[i] != UINT32_MAX;
    }
    for (size_t i = 0; i < c->places; i++) {
        const lac_open_event *e = &c->open[i];
        sound &= e->open ? e->first < n : e->first == UINT32_MAX || e->first < c->places;
        for (size_t k = 0; k < e->count; k++) {
            sound &= e->cells[k] < n;
        }
    }
    return sound;
}

// A run that cannot go on from what came is summed up all the same: nothing of it is under way.
static void forget(lac_catalogue *c)
{
    c->actives = 0;
    for (size_t i = 0; i < c->places; i++) {
        c->open[i].open = false;
    }
}

void lac_catalogue_keep(lac_catalogue *c, lac_tape *tape)
{
    const size_t n = c->domain->n;
    pass_bool(tape, &c->begun);
    PASS(tape, c->origin);
    PASS(tape, c->local);
    lac_tape_pass(tape, c->rate, n * sizeof *c->rate);
    lac_tape_pass(tape, c->slip, n * sizeof *c->slip);
    lac_tape_pass(tape, c->event, n * sizeof *c->event);
    pass_moving(c, tape);
    pass_open(c, tape);
    PASS(tape, c->events);
    PASS(tape, c->cut);
    PASS(tape, c->largest_slip);
    PASS(tape, c->largest_size);
    PASS(tape, c->slip_sum);
    if (tape->loading && !(lac_tape_good(tape) && is_sound(c))) {
        tape->short_of |= lac_tape_good(tape);
        forget(c);
    }
}
