// SPDX-License-Identifier: GPL-3.0-or-later
// Events are the connected components of {(cell, t): the cell moves at t}, cells being connected
// while both move and touch. They are built as time goes on: a cell that begins to move joins the
// events of its moving neighbours, which so become one.
#include "analysis/catalogue.h"

#include "analysis/slipping.h"
#include "lacuna/simulation.h"

static const uint32_t none = UINT32_MAX;

lac_status lac_catalogue_create(const lac_domain *domain, double rise, double fall, double modulus,
                                lac_catalogue *out, lac_error *err)
{
    const size_t n = domain->n;
    *out = (lac_catalogue){
        .domain = domain, .rise = rise, .fall = fall, .modulus = modulus, .vacant = none};
    out->neighbour = lac_neighbours_find(domain);
    out->slip = calloc(2 * n, sizeof *out->slip);
    out->moves = calloc(n, sizeof *out->moves);
    out->event = calloc(4 * n + domain->grid.nx + domain->grid.ny, sizeof *out->event);
    out->change = malloc(n * sizeof *out->change);
    const bool past = lac_crest_create(n, &out->past, err) == LAC_OK;
    LAC_FAIL_MEMORY_IF(!past || out->neighbour == NULL || out->slip == NULL || out->moves == NULL ||
                           out->event == NULL || out->change == NULL,
                       err);
    out->slip_at_rise = out->slip + n;
    out->active = out->event + n;
    out->place = out->active + n;
    out->cell_mark = out->place + n;
    out->x_mark = out->cell_mark + n;
    out->y_mark = out->x_mark + domain->grid.nx;
    memset(out->event, 0xff, n * sizeof *out->event);
    return LAC_OK;
}

void lac_catalogue_clear(lac_catalogue *c)
{
    for (size_t i = 0; i < c->places; i++) {
        free(c->open[i].cells);
    }
    free(c->open);
    free(c->neighbour);
    free(c->slip);
    lac_crest_clear(&c->past);
    free(c->moves);
    free(c->event);
    free(c->change);
    *c = (lac_catalogue){0};
}

static lac_status add_places(lac_catalogue *c, lac_error *err)
{
    size_t places = 2 * c->places + 4;
    lac_open_event *grown = realloc(c->open, places * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    c->open = grown;
    for (size_t i = places; i-- > c->places;) {
        c->open[i] = (lac_open_event){.first = c->vacant};
        c->vacant = (uint32_t)i;
    }
    c->places = places;
    return LAC_OK;
}

static lac_status open_event(lac_catalogue *c, uint32_t cell, double local, uint32_t *place,
                             lac_error *err)
{
    LAC_TRY_RETURN(c->vacant == none ? add_places(c, err) : LAC_OK);
    *place = c->vacant;
    lac_open_event *e = &c->open[*place];
    c->vacant = e->first;
    *e = (lac_open_event){.origin = c->origin,
                          .local = local,
                          .first = cell,
                          .cells = e->cells,
                          .room = e->room,
                          .open = true};
    return LAC_OK;
}

static void vacate(lac_catalogue *c, uint32_t place)
{
    c->open[place].open = false;
    c->open[place].first = c->vacant;
    c->vacant = place;
}

static bool older(const lac_open_event *a, const lac_open_event *b)
{
    double by = (b->origin - a->origin) + (b->local - a->local);
    return by != 0.0 ? by > 0.0 : a->first < b->first;
}

// Makes one event of two, with the start of the older. The one of more cells keeps its place.
static lac_status merge(lac_catalogue *c, uint32_t *into, uint32_t from, lac_error *err)
{
    if (c->open[from].count > c->open[*into].count) {
        uint32_t other = *into;
        *into = from;
        from = other;
    }
    lac_open_event *a = &c->open[*into], *b = &c->open[from];
    LAC_TRY_RETURN(lac_grow(&a->cells, &a->room, a->count + b->count, sizeof *a->cells, err));
    if (older(b, a)) {
        a->origin = b->origin;
        a->local = b->local;
        a->first = b->first;
    }
    a->slip += b->slip;
    a->max_rate = fmax(a->max_rate, b->max_rate);
    a->moving += b->moving;
    a->before |= b->before;
    for (size_t k = 0; k < b->count; k++) {
        uint32_t cell = b->cells[k];
        if (c->event[cell] != *into) {
            a->cells[a->count++] = cell;
        }
        if (c->event[cell] == from) {
            c->event[cell] = *into;
        }
    }
    vacate(c, from);
    return LAC_OK;
}

// The one event of a cell's moving neighbours; none where none moves.
static lac_status join_neighbours(lac_catalogue *c, uint32_t cell, uint32_t *place, lac_error *err)
{
    *place = none;
    for (size_t k = 0; k < LAC_NEIGHBOURS; k++) {
        uint32_t j = c->neighbour[LAC_NEIGHBOURS * cell + k];
        if (j == none || !c->moves[j] || c->event[j] == *place) {
            continue;
        }
        if (*place == none) {
            *place = c->event[j];
        } else {
            LAC_TRY_RETURN(merge(c, place, c->event[j], err));
        }
    }
    return LAC_OK;
}

static lac_status begin_motion(lac_catalogue *c, uint32_t cell, double local, double slip,
                               lac_error *err)
{
    uint32_t place;
    LAC_TRY_RETURN(join_neighbours(c, cell, &place, err));
    if (place == none) {
        LAC_TRY_RETURN(open_event(c, cell, local, &place, err));
    }
    lac_open_event *e = &c->open[place];
    if (c->event[cell] != place) {
        LAC_TRY_RETURN(lac_grow(&e->cells, &e->room, e->count + 1, sizeof *e->cells, err));
        e->cells[e->count++] = cell;
        c->event[cell] = place;
    }
    e->moving++;
    c->moves[cell] = 1;
    c->slip_at_rise[cell] = slip;
    c->place[cell] = (uint32_t)c->actives;
    c->active[c->actives++] = cell;
    return LAC_OK;
}

static void end_motion(lac_catalogue *c, uint32_t cell, double slip)
{
    lac_open_event *e = &c->open[c->event[cell]];
    e->slip += fabs(slip - c->slip_at_rise[cell]);
    e->moving--;
    c->moves[cell] = 0;
    uint32_t last = c->active[--c->actives];
    c->active[c->place[cell]] = last;
    c->place[last] = c->place[cell];
}

// Counts the different cells of an event and the lines that they occupy: they are connected, so
// that no line is left out between the first and the last, even round a periodic edge.
static void survey(lac_catalogue *c, const lac_open_event *e, lac_event *event)
{
    const lac_grid *grid = &c->domain->grid;
    size_t columns = 0, rows = 0;
    c->mark++;
    for (size_t k = 0; k < e->count; k++) {
        uint32_t cell = e->cells[k];
        size_t x = c->domain->index[cell] % grid->nx;
        size_t y = c->domain->index[cell] / grid->nx;
        event->cells += c->cell_mark[cell] != c->mark;
        columns += c->x_mark[x] != c->mark;
        rows += c->y_mark[y] != c->mark;
        c->cell_mark[cell] = c->x_mark[x] = c->y_mark[y] = c->mark;
    }
    event->size = lac_grid_extent(grid, (double)columns, (double)rows);
}

// Puts out an event none of whose cells move any more, or that the run's end cuts off.
static lac_status put_out(lac_catalogue *c, uint32_t place, double local, const lac_sink *sink,
                          lac_error *err)
{
    const lac_grid *grid = &c->domain->grid;
    lac_open_event *e = &c->open[place];
    double potency = e->slip * lac_grid_cell_area(grid);
    uint32_t at = c->domain->index[e->first];
    lac_event event = {.time_origin = e->origin,
                       .time_local = e->local,
                       .duration = (c->origin - e->origin) + (local - e->local),
                       .potency = potency,
                       .moment = c->modulus * potency,
                       .x = lac_grid_x(grid, at),
                       .y = lac_grid_y(grid, at),
                       .max_rate = e->max_rate,
                       .cut = (e->before ? LAC_EVENT_BEGUN_BEFORE : 0) |
                              (e->moving > 0 ? LAC_EVENT_UNENDED : 0)};
    survey(c, e, &event);
    for (size_t k = 0; k < e->count; k++) {
        if (c->event[e->cells[k]] == place) {
            c->event[e->cells[k]] = none;
        }
    }
    c->events++;
    c->cut += event.cut != 0;
    c->slip_sum += e->slip;
    c->largest_slip = fmax(c->largest_slip, e->slip);
    c->largest_size = fmax(c->largest_size, event.size);
    vacate(c, place);
    return sink->event != NULL ? sink->event(sink->context, &event, err) : LAC_OK;
}

static int by_time(const void *left, const void *right)
{
    const lac_motion_change *a = left, *b = right;
    if (a->share != b->share) {
        return a->share < b->share ? -1 : 1;
    }
    if (a->rises != b->rises) {
        return a->rises ? -1 : 1; // cells that meet at one instant are connected
    }
    return a->cell < b->cell ? -1 : a->cell > b->cell;
}

// The cells that the step moved on: all, or those that it lists.
static size_t moved_on(const lac_catalogue *c, const lac_step *step)
{
    return step->changed != NULL ? step->changes : c->domain->n;
}

static size_t cell_of(const lac_step *step, size_t k)
{
    return step->changed != NULL ? step->changed[k] : k;
}

// Collects the cells that begin or cease to move, in the order of time.
static size_t collect(const lac_catalogue *c, const lac_step *step)
{
    size_t changes = 0;
    for (size_t k = 0; k < moved_on(c, step); k++) {
        size_t i = cell_of(step, k);
        double v = fabs(step->slip_rate[i]);
        bool now = v >= (c->moves[i] ? c->fall : c->rise);
        if (now == (bool)c->moves[i]) {
            continue;
        }
        bool whole = !c->begun || step->step == 0.0;
        double limit = now ? c->rise : c->fall;
        c->change[changes++] = (lac_motion_change){
            .share = whole ? 1.0 : lac_crest_share_at(c->past.rate[0][i], v, limit),
            .cell = (uint32_t)i,
            .rises = now,
        };
    }
    if (changes > 1) {
        qsort(c->change, changes, sizeof *c->change, by_time);
    }
    return changes;
}

// Slip of a cell where it crosses a limit: v being exponential in time, slip is linear in v.
static double slip_at(const lac_catalogue *c, const lac_step *step, const lac_motion_change *change)
{
    uint32_t i = change->cell;
    double before = c->past.rate[0][i], after = fabs(step->slip_rate[i]);
    double limit = change->rises ? c->rise : c->fall;
    double rest = c->begun && step->step > 0.0 ? (after - limit) / (after - before) : 0.0;
    return step->slip[i] - rest * (step->slip[i] - c->slip[i]);
}

static lac_status apply(lac_catalogue *c, const lac_step *step, const lac_motion_change *change,
                        const lac_sink *sink, lac_error *err)
{
    double local = step->time_local - (1.0 - change->share) * step->step;
    double slip = slip_at(c, step, change);
    if (change->rises) {
        LAC_TRY_RETURN(begin_motion(c, change->cell, local, slip, err));
        c->open[c->event[change->cell]].before |= !c->begun;
    } else {
        end_motion(c, change->cell, slip);
        if (c->open[c->event[change->cell]].moving == 0) {
            LAC_TRY_RETURN(put_out(c, c->event[change->cell], local, sink, err));
        }
    }
    return LAC_OK;
}

// What the cells that moved at the end of the last step came to about it.
static void seek_crests(lac_catalogue *c, const lac_step *step)
{
    for (size_t k = 0; k < c->actives && step->changed == NULL; k++) {
        lac_open_event *e = &c->open[c->event[c->active[k]]];
        e->max_rate = fmax(e->max_rate, lac_crest_top(&c->past, step, c->active[k], NULL));
    }
}

lac_status lac_catalogue_step(lac_catalogue *c, const lac_step *step, const lac_sink *sink,
                              lac_error *err)
{
    c->origin = step->time_origin;
    c->local = step->time_local;
    seek_crests(c, step);
    if (c->actives > 0 || step->max_rate >= c->rise) {
        size_t changes = collect(c, step);
        for (size_t k = 0; k < changes; k++) {
            LAC_TRY_RETURN(apply(c, step, &c->change[k], sink, err));
        }
    }
    lac_crest_take(&c->past, step);
    for (size_t k = 0; k < moved_on(c, step); k++) {
        size_t i = cell_of(step, k);
        c->slip[i] = step->slip[i];
        if (c->moves[i]) {
            lac_open_event *e = &c->open[c->event[i]];
            e->max_rate = fmax(e->max_rate, c->past.rate[0][i]);
        }
    }
    c->begun = true;
    return LAC_OK;
}

lac_status lac_catalogue_close(lac_catalogue *c, const lac_sink *sink, lac_error *err)
{
    for (size_t k = 0; k < c->actives; k++) {
        uint32_t cell = c->active[k];
        c->open[c->event[cell]].slip += fabs(c->slip[cell] - c->slip_at_rise[cell]);
        c->moves[cell] = 0;
    }
    c->actives = 0;
    for (size_t i = 0; i < c->places; i++) {
        if (c->open[i].open) {
            LAC_TRY_RETURN(put_out(c, (uint32_t)i, c->local, sink, err));
        }
    }
    return LAC_OK;
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
        e->cells = lac_archive_room(archive, count, sizeof *e->cells, sizeof *e->cells);
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
        c->open = lac_archive_room(archive, places, sizeof c->open->origin, sizeof *c->open);
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
    bool sound = c->vacant == none || c->vacant < c->places;
    for (size_t i = 0; i < n; i++) {
        sound &= c->event[i] == none || c->event[i] < c->places;
        sound &= !c->moves[i] || c->event[i] != none;
    }
    for (size_t i = 0; i < c->places; i++) {
        const lac_open_event *e = &c->open[i];
        sound &= e->open ? e->first < n : e->first == none || e->first < c->places;
        for (size_t k = 0; k < e->count; k++) {
            sound &= e->cells[k] < n;
        }
    }
    return sound;
}

void lac_catalogue_serialize(lac_catalogue *c, lac_archive *archive)
{
    const size_t n = c->domain->n;
    pass_bool(archive, &c->begun);
    LAC_PASS(archive, c->origin);
    LAC_PASS(archive, c->local);
    lac_crest_serialize(&c->past, archive);
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
        // A run that cannot go on from what came is summed up all the same: nothing is under way.
        c->actives = 0;
        for (size_t i = 0; i < c->places; i++) {
            c->open[i].open = false;
        }
    }
}
