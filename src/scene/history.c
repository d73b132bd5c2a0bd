// SPDX-License-Identifier: GPL-3.0-or-later
// The static history of a case: what each step asks for, the contact at its pressure, its shear.
#include "scene/internal.h"

// What a step came to, as far as a cycle goes.
typedef struct history_state {
    double pressure, traction[2], shift[2], dissipated;
} history_state;

typedef struct history {
    const lac_case *source;
    const lac_scene_contact *contact;
    const lac_history_sink *sink;
    lac_tangential *shear;
    double *pressure, *next;      // [ny * nx] of the last step and of the one being solved [Pa]
    double mean;                  // pressure of the last step [Pa]
    lac_tangential_target target; // of the last step
    lac_tangential_stats reached; // by it
    history_state *state;         // [planned + 1] the start and what each step came to
    double highest_held;          // largest f P on the way [Pa]
    double longest_shift;         // [m]
    bool sought_first_slip;
    lac_history_result *result;
} history;

size_t lac_scene_history_steps(const lac_case *c)
{
    size_t n = 0;
    for (size_t i = 0; i < c->history.count; i++) {
        n += (size_t)c->history.step[i].count;
    }
    return n;
}

bool lac_scene_history_presses(const lac_case *c)
{
    bool presses = false;
    for (size_t i = 0; i < c->history.count; i++) {
        presses = presses || !isnan(c->history.step[i].pressure);
    }
    return presses;
}

// Pressures of another load: of a surface from the contact before, of a domain in proportion.
static lac_status press(history *h, double mean, lac_history_record *record, lac_error *err)
{
    const lac_scene_contact *contact = h->contact;
    size_t cells = lac_grid_cells(&contact->grid);
    memcpy(h->next, h->pressure, cells * sizeof *h->next);
    if (mean == h->mean) {
        return LAC_OK;
    }
    if (!contact->solved) {
        for (size_t i = 0; i < cells; i++) {
            h->next[i] = contact->pressure[i] * (mean / contact->mean_pressure);
        }
        return LAC_OK;
    }
    lac_contact_stats report = {0};
    lac_contact_def def = lac_scene_contact_def(contact);
    def.mean_pressure = mean;
    def.start = h->next;
    lac_status status = lac_contact_solve(&def, h->next, NULL, &report, err);
    record->contact_iterations = report.iterations;
    record->contact_products = report.products;
    return lac_fail_within(err, status, "contact");
}

// Where an axis stands in the terms of another control.
static double stands_at(const history *h, int axis, lac_tangential_control control)
{
    if (h->target.control[axis] == control) {
        return h->target.value[axis];
    }
    return control == LAC_SHEAR_LOAD ? h->reached.traction[axis] : h->reached.shift[axis];
}

// The end of an entry of the case: its pressure and its target.
static double find_end(const history *h, const lac_history_step *step, lac_tangential_target *end)
{
    double pressure = isnan(step->pressure) ? h->mean : step->pressure;
    *end = h->target;
    for (int i = 0; i < 2; i++) {
        double ratio = step->ratio[i] * h->source->history.friction * pressure;
        double shear = isnan(step->ratio[i]) ? step->shear[i] : ratio;
        if (!isnan(shear)) {
            end->control[i] = LAC_SHEAR_LOAD;
            end->value[i] = shear;
        } else if (!isnan(step->shift[i])) {
            end->control[i] = LAC_SHEAR_SHIFT;
            end->value[i] = step->shift[i];
        }
    }
    return pressure;
}

// Whether pressure and controlled quantities of the step that was solved are those of another.
static bool same_controls(const history *h, const history_state *a, const history_state *now)
{
    const double tolerance = 1e-6;
    if (!(fabs(a->pressure - now->pressure) <= tolerance * now->pressure)) {
        return false;
    }
    for (int i = 0; i < 2; i++) {
        bool load = h->target.control[i] == LAC_SHEAR_LOAD;
        double away = load ? a->traction[i] - now->traction[i] : a->shift[i] - now->shift[i];
        double scale = load ? h->highest_held : h->longest_shift;
        if (!(fabs(away) <= tolerance * scale)) {
            return false;
        }
    }
    return true;
}

// The latest step before `now` under the same controls, others having been in between.
static size_t cycle_start(const history *h, size_t now)
{
    bool left = false;
    for (size_t i = now; i-- > 0;) {
        bool same = same_controls(h, &h->state[i], &h->state[now]);
        if (same && left) {
            return i;
        }
        left = left || !same;
    }
    return SIZE_MAX;
}

static void note_state(history *h, size_t at, double dissipated)
{
    const lac_tangential_stats *r = &h->reached;
    h->state[at] = (history_state){.pressure = h->mean,
                                   .traction = {r->traction[0], r->traction[1]},
                                   .shift = {r->shift[0], r->shift[1]},
                                   .dissipated = dissipated};
    h->highest_held = fmax(h->highest_held, h->source->history.friction * h->mean);
    h->longest_shift = fmax(h->longest_shift, hypot(r->shift[0], r->shift[1]));
}

static void find_cycle(const history *h, size_t now, lac_history_record *record)
{
    const size_t start = cycle_start(h, now);
    record->cycle_start = start;
    record->cycle_dissipation = NAN;
    record->cycle_shift = NAN;
    if (start != SIZE_MAX) {
        const history_state *a = &h->state[start], *b = &h->state[now];
        record->cycle_dissipation = b->dissipated - a->dissipated;
        record->cycle_shift = hypot(b->shift[0] - a->shift[0], b->shift[1] - a->shift[1]);
    }
}

// The centre of a cell; NaN where there is none.
static void find_place(const lac_grid *grid, size_t cell, double place[2])
{
    bool found = cell < lac_grid_cells(grid);
    place[0] = found ? lac_grid_x(grid, cell) : NAN;
    place[1] = found ? lac_grid_y(grid, cell) : NAN;
}

static lac_status give_maps(const history *h, lac_error *err)
{
    const lac_history_maps maps = {
        .pressure = h->pressure,
        .traction = {h->shear->traction[0], h->shear->traction[1]},
        .slip = {h->shear->slip[0], h->shear->slip[1]},
        .state = h->shear->state,
        .pressed = lac_scene_history_presses(h->source),
    };
    return h->sink->maps != NULL ? h->sink->maps(h->sink->context, &maps, err) : LAC_OK;
}

// Keeps what a step came to and hands it on.
static lac_status finish_step(history *h, lac_history_record *record, lac_error *err)
{
    size_t now = ++h->result->steps;
    note_state(h, now, h->state[now - 1].dissipated + h->reached.dissipation);
    record->number = now;
    record->area = lac_grid_area(&h->contact->grid);
    record->pressure = h->mean;
    record->shear = h->reached;
    record->dissipated = h->state[now].dissipated;
    find_cycle(h, now, record);
    find_place(&h->contact->grid, h->reached.highest_cell, record->highest);
    if (h->sink->step != NULL) {
        LAC_TRY_RETURN(h->sink->step(h->sink->context, record, err));
    }
    return h->source->history.fields == LAC_KEEP_ALL ? give_maps(h, err) : LAC_OK;
}

static lac_tangential_def shear_def(const history *h)
{
    const lac_material_def *material = &h->source->material;
    lac_tangential_def def = lac_tangential_default();
    def.grid = h->contact->grid;
    def.e_star = material->shear_modulus / (1.0 - material->poisson);
    def.poisson = material->poisson;
    def.friction = h->source->history.friction;
    def.tolerance = h->source->contact_tolerance;
    return def;
}

// Where a joint that sticks everywhere would slip first, once there is a shear load. What cannot be
// solved is left out: the steps stand without it.
static lac_status find_first_slip(history *h, lac_error *err)
{
    const double *direction = h->reached.traction;
    const double loaded = 1e-9 * h->highest_held;
    if (h->sought_first_slip || !(hypot(direction[0], direction[1]) > loaded)) {
        return LAC_OK;
    }
    h->sought_first_slip = true;
    const lac_tangential_def def = shear_def(h);
    lac_first_slip *first = &h->result->first_slip;
    lac_status status = lac_tangential_first_slip(&def, h->pressure, direction, first, err);
    if (status == LAC_OK) {
        h->result->loaded = true;
        find_place(&def.grid, first->cell, h->result->first_place);
    }
    return status == LAC_ENOMEM ? status : LAC_OK;
}

static lac_status solve_step(history *h, double mean, const lac_tangential_target *target,
                             lac_history_record *record, lac_error *err)
{
    lac_tangential_stats reached;
    double *before = h->pressure;
    LAC_TRY_RETURN(press(h, mean, record, err));
    LAC_TRY_RETURN(lac_tangential_step(h->shear, h->next, target, &reached, err));
    h->pressure = h->next;
    h->next = before;
    h->mean = mean;
    h->target = *target;
    h->reached = reached;
    return LAC_OK;
}

// One entry of the case in its equal increments.
static lac_status follow_entry(history *h, size_t entry, lac_error *err)
{
    const lac_history_step *step = &h->source->history.step[entry];
    lac_tangential_target end, begin;
    const double start = h->mean;
    const double pressure = find_end(h, step, &end);
    begin = end;
    for (int i = 0; i < 2; i++) {
        begin.value[i] = stands_at(h, i, end.control[i]);
    }
    for (int64_t k = 1; k <= step->count; k++) {
        lac_history_record record = {0};
        lac_tangential_target target = end;
        const double left = (double)(step->count - k) / (double)step->count;
        for (int i = 0; i < 2; i++) {
            target.value[i] += left * (begin.value[i] - end.value[i]);
        }
        LAC_FAIL_IF(h->sink->interrupted != NULL && h->sink->interrupted(h->sink->context), err,
                    LAC_EINTERRUPT, "interrupted");
        lac_status status =
            solve_step(h, pressure + left * (start - pressure), &target, &record, err);
        LAC_TRY_RETURN(lac_fail_within(err, status,
                                       "load.history.steps.%zu (increment %lld of %lld)", entry,
                                       (long long)k, (long long)step->count));
        LAC_TRY_RETURN(finish_step(h, &record, err));
        LAC_TRY_RETURN(find_first_slip(h, err));
    }
    return LAC_OK;
}

static lac_status begin(history *h, lac_error *err)
{
    const lac_scene_contact *contact = h->contact;
    const lac_tangential_def def = shear_def(h);
    size_t cells = lac_grid_cells(&contact->grid);
    h->pressure = malloc(cells * sizeof *h->pressure);
    h->next = malloc(cells * sizeof *h->next);
    h->state = calloc(h->result->planned + 1, sizeof *h->state);
    LAC_FAIL_MEMORY_IF(h->pressure == NULL || h->next == NULL || h->state == NULL, err);
    memcpy(h->pressure, contact->pressure, cells * sizeof *h->pressure);
    h->mean = contact->mean_pressure;
    note_state(h, 0, 0.0);
    return lac_tangential_create(&def, &h->shear, err);
}

lac_status lac_scene_history_run(const lac_case *c, const lac_scene_contact *contact,
                                 const lac_history_sink *sink, lac_history_result *result,
                                 lac_error *err)
{
    history h = {.source = c, .contact = contact, .sink = sink, .result = result};
    lac_error late = {""};
    *result = (lac_history_result){.planned = lac_scene_history_steps(c)};
    lac_status status = begin(&h, err);
    for (size_t i = 0; status == LAC_OK && i < c->history.count; i++) {
        status = follow_entry(&h, i, err);
    }
    // What was reached is whole, whatever came after.
    if (result->steps > 0 && c->history.fields == LAC_KEEP_LAST) {
        lac_status kept = give_maps(&h, &late);
        if (kept != LAC_OK && (status == LAC_OK || status == LAC_EINTERRUPT)) {
            *err = late;
            status = kept;
        }
    }
    lac_tangential_free(h.shear);
    free(h.pressure);
    free(h.next);
    free(h.state);
    return status;
}
