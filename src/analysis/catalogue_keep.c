// SPDX-License-Identifier: GPL-3.0-or-later
// A catalogue on its way to a checkpoint and back.
#include <stdlib.h>

#include "analysis/catalogue.h"

// Zeroed room for `count` things that take at least `least` bytes each on the archive; NULL where
// it cannot hold as many.
static void *room_for(lac_archive *archive, size_t count, size_t least, size_t size)
{
    if (!lac_archive_good(archive) || count > (archive->size - archive->at) / least) {
        archive->short_of |= lac_archive_good(archive);
        return NULL;
    }
    void *room = calloc(count + 1, size);
    archive->no_memory = room == NULL;
    return room;
}

// As a byte: not every byte is a bool.
static void pass_bool(lac_archive *archive, bool *value)
{
    uint8_t byte = *value ? 1 : 0;
    LAC_PASS(archive, byte);
    *value = byte != 0;
}

static void pass_event(lac_archive *archive, lac_open_event *e)
{
    LAC_PASS(archive, e->origin);
    LAC_PASS(archive, e->local);
    LAC_PASS(archive, e->first);
    LAC_PASS(archive, e->slip);
    LAC_PASS(archive, e->max_rate);
    LAC_PASS(archive, e->moving);
    LAC_PASS(archive, e->count);
    pass_bool(archive, &e->open);
    pass_bool(archive, &e->before);
    size_t count = e->open ? e->count : 0; // of a vacant place there is but the next one
    if (archive->loading) {
        e->cells = room_for(archive, count, sizeof *e->cells, sizeof *e->cells);
        e->room = e->count = e->cells != NULL ? count : 0;
    }
    lac_archive_pass(archive, e->cells, count * sizeof *e->cells);
}

static void pass_open(lac_catalogue *c, lac_archive *archive)
{
    size_t places = c->places;
    LAC_PASS(archive, c->vacant);
    LAC_PASS(archive, places);
    if (archive->loading) {
        c->open = room_for(archive, places, sizeof c->open->origin, sizeof *c->open);
        c->places = c->open != NULL ? places : 0;
    }
    for (size_t i = 0; i < c->places; i++) {
        pass_event(archive, &c->open[i]);
    }
}

// The cells that move, in their order, with their slip when they began to.
static void pass_moving(lac_catalogue *c, lac_archive *archive)
{
    LAC_PASS(archive, c->actives);
    if (c->actives > c->domain->n) {
        archive->short_of = true;
        c->actives = 0;
    }
    lac_archive_pass(archive, c->active, c->actives * sizeof *c->active);
    for (size_t k = 0; k < c->actives && lac_archive_good(archive); k++) {
        uint32_t cell = c->active[k];
        if (cell >= c->domain->n || (archive->loading && c->moves[cell])) {
            archive->short_of = true;
            return;
        }
        LAC_PASS(archive, c->slip_at_rise[cell]);
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

void lac_catalogue_serialize(lac_catalogue *c, lac_archive *archive)
{
    const size_t n = c->domain->n;
    pass_bool(archive, &c->begun);
    LAC_PASS(archive, c->origin);
    LAC_PASS(archive, c->local);
    lac_archive_pass(archive, c->rate, n * sizeof *c->rate);
    lac_archive_pass(archive, c->slip, n * sizeof *c->slip);
    lac_archive_pass(archive, c->event, n * sizeof *c->event);
    pass_moving(c, archive);
    pass_open(c, archive);
    LAC_PASS(archive, c->events);
    LAC_PASS(archive, c->cut);
    LAC_PASS(archive, c->largest_slip);
    LAC_PASS(archive, c->largest_size);
    LAC_PASS(archive, c->slip_sum);
    if (archive->loading && !(lac_archive_good(archive) && is_sound(c))) {
        archive->short_of |= lac_archive_good(archive);
        forget(c);
    }
}
