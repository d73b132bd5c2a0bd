// SPDX-License-Identifier: GPL-3.0-or-later
// When the largest slip rate of the interface is high, and how high it comes: what
// earthquake-cycle codes list as events.
#include "analysis/slip_events.h"

#include "lacuna/simulation.h"

void lac_slip_events_clear(lac_slip_events *s)
{
    free(s->event);
    lac_crest_clear(&s->past);
    *s = (lac_slip_events){0};
}

static lac_status open_event(lac_slip_events *s, size_t n, double start, lac_error *err)
{
    LAC_TRY_RETURN(lac_grow(&s->event, &s->room, s->count + 1, sizeof *s->event, err));
    LAC_TRY_RETURN(s->past.block == NULL ? lac_crest_create(n, &s->past, err) : LAC_OK);
    s->past.known = 0;
    s->event[s->count++] = (lac_slip_event){.start = start, .end = NAN};
    return LAC_OK;
}

// Where cells that are nearly as fast as any so far have come to about the end of the last step.
static void seek_crest(const lac_slip_events *s, const lac_step *step, lac_slip_event *e)
{
    const double near = 0.75 * e->max_rate; // a crest adds below a third
    const double *rate = s->past.rate[0];
    for (size_t i = 0; s->past.known > 1 && i < s->past.n; i++) {
        double since;
        const double top = rate[i] > near ? lac_crest_top(&s->past, step, i, &since) : 0.0;
        if (top > e->max_rate) {
            e->max_rate = top;
            e->peak = step->time_origin + (step->time_local - step->step + since);
        }
    }
}

lac_status lac_slip_events_step(lac_slip_events *s, const lac_step *step, lac_error *err)
{
    const double limit = s->moves ? LAC_SLIP_EVENT_FALL : LAC_SLIP_EVENT_RISE;
    const bool now = step->max_rate >= limit;
    if (s->moves && s->past.n == step->n) {
        seek_crest(s, step, &s->event[s->count - 1]);
    }
    if (now != s->moves) {
        const bool whole = !s->begun || !(step->step > 0.0);
        const double share = whole ? 1.0 : lac_crest_share_at(s->last, step->max_rate, limit);
        const double at = step->time_origin + (step->time_local - (1.0 - share) * step->step);
        if (now) {
            LAC_TRY_RETURN(open_event(s, step->n, s->begun ? at : (double)NAN, err));
        } else {
            s->event[s->count - 1].end = at;
        }
    }
    s->moves = now;
    s->begun = true;
    s->last = step->max_rate;
    if (now && s->past.n == step->n) {
        lac_slip_event *e = &s->event[s->count - 1];
        lac_crest_take(&s->past, step);
        e->peak = step->max_rate > e->max_rate ? step->time_origin + step->time_local : e->peak;
        e->max_rate = fmax(e->max_rate, step->max_rate);
    }
    return LAC_OK;
}

void lac_slip_events_serialize(lac_slip_events *s, lac_archive *archive)
{
    size_t count = s->count, cells = s->moves ? s->past.n : 0;
    uint8_t flags[2] = {s->begun, s->moves};
    LAC_PASS(archive, count);
    LAC_PASS(archive, cells);
    LAC_PASS(archive, flags);
    LAC_PASS(archive, s->last);
    if (archive->loading) {
        s->event = lac_archive_room(archive, count, sizeof *s->event, sizeof *s->event);
        archive->short_of |= cells > archive->size / sizeof(double);
        archive->no_memory |= cells > 0 && lac_archive_good(archive) &&
                              lac_crest_create(cells, &s->past, NULL) != LAC_OK;
    }
    lac_archive_pass(archive, s->event, count * sizeof *s->event);
    if (cells > 0) {
        lac_crest_serialize(&s->past, archive);
    }
    if (archive->loading && lac_archive_good(archive)) {
        s->count = s->room = count;
        s->begun = flags[0] != 0;
        s->moves = flags[1] != 0 && count > 0 && cells > 0;
    }
}
