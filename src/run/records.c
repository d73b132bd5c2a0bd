// SPDX-License-Identifier: GPL-3.0-or-later
// What a run hands to its sink of a state: a record of the time series, a snapshot of the cells.
#include "run/run_state.h"

const double *lac_run_state_gather(const lac_run_state *r, const double *x, size_t place)
{
    const lac_range *range = r->engine->range;
    double *all = r->all != NULL ? r->all + place * range->all : NULL;
    if (range->team != NULL) {
        lac_range_bring(range, x, 0, range->all, all);
    }
    return all != NULL ? all : x;
}

// Whether a time is later than the last one put out, which it then becomes.
static bool moves_on(lac_instant *last, double origin, double local)
{
    if (last->set && (origin - last->origin) + (local - last->local) <= 0.0) {
        return false;
    }
    *last = (lac_instant){.set = true, .origin = origin, .local = local};
    return true;
}

// What is put out of a state: itself, or its projection onto the balance.
static void project(lac_run_state *r, double t, const double **y, const double **slip)
{
    size_t n = r->engine->n, unknowns = r->engine->unknowns;
    if (r->onto == NULL) {
        return;
    }
    memcpy(r->onto, *y, unknowns * sizeof **y);
    memcpy(r->onto + unknowns, *slip, n * sizeof **slip);
    if (lac_problem_project(r->problem, lac_engine_clock(r->engine, t), r->onto, r->onto + unknowns,
                            r->engine->work)) {
        *y = r->onto;
        *slip = r->onto + unknowns;
    }
}

// Of slip in two directions the components besides, of whose means the sizes are told.
static void watch_along(lac_run_state *r, const double *slip, lac_record *line)
{
    const lac_points *points = r->def->points;
    const lac_components of = lac_problem_components(r->problem, slip, r->engine->work);
    const double *fields[] = {of.slip[0], of.slip[1],     of.rate[0],
                              of.rate[1], of.traction[0], of.traction[1]};
    for (size_t k = 0; k < LAC_POINT_ALONG; k++) {
        fields[k] = lac_run_state_gather(r, fields[k], 4 + k);
    }
    if (!lac_run_state_leads(r)) {
        return;
    }
    double *value = r->watched, *along = value + LAC_POINT_VALUES * points->n;
    line->observation.points_along = along;
    for (size_t i = 0; i < points->n; i++, value += LAC_POINT_VALUES, along += LAC_POINT_ALONG) {
        for (size_t k = 0; k < LAC_POINT_ALONG; k++) {
            along[k] = lac_point_mean(&points->point[i], fields[k]);
        }
        value[LAC_POINT_SLIP] = hypot(along[0], along[1]);
        value[LAC_POINT_RATE] = hypot(along[2], along[3]);
        value[LAC_POINT_TRACTION] = hypot(along[4], along[5]);
    }
}

// @param line  whose cells are all of them
static void watch_points(lac_run_state *r, double now, const double *slip, lac_record *line)
{
    const size_t values = LAC_POINT_VALUES + LAC_POINT_ALONG;
    double *traction = r->watched + values * r->def->points->n;
    lac_problem_traction(r->problem, now, slip, traction, r->engine->work);
    const double *fields[] = {lac_run_state_gather(r, slip, 2), line->cells.slip_rate,
                              lac_run_state_gather(r, traction, 3), line->cells.log_state};
    if (lac_run_state_leads(r)) {
        lac_points_read(r->def->points, fields, r->watched);
    }
    line->observation.points = r->watched;
    if (lac_problem_is_vector(r->problem)) {
        watch_along(r, slip, line);
    }
}

lac_status lac_run_state_record(lac_run_state *r, double t, const double *y, const double *slip,
                                lac_error *err)
{
    lac_engine *engine = r->engine;
    double local = engine->base + t;
    if (!moves_on(&r->last_record, engine->origin, local)) {
        return LAC_OK;
    }
    project(r, t, &y, &slip);
    const bool again = r->measured && r->onto == NULL && y == engine->y;
    lac_engine_count(engine);
    lac_record line = {.time_origin = engine->origin,
                       .time_local = local,
                       .step_size = engine->step > 0.0 ? engine->step : NAN,
                       .order = engine->step > 0.0 ? engine->order : 0,
                       .rhs_evaluations = engine->counts.rhs_evaluations};
    lac_problem_observe(r->problem, lac_engine_clock(engine, t), y, slip, again, &line.observation,
                        engine->work);
    if (!(line.observation.balance_residual <= r->result->balance_residual)) {
        r->result->balance_residual = line.observation.balance_residual; // a NaN stays
    }
    r->result->rate_drift = fmax(r->result->rate_drift, line.observation.rate_drift);
    lac_run_state_keep_safety(r, engine->origin + local, line.observation.factor_of_safety);
    if ((r->takes & LAC_TAKES_RECORD) == 0) {
        return LAC_OK;
    }
    line.cells.n = engine->range->all;
    if (r->watched != NULL || lac_run_state_shows(r, line.observation.max_rate)) {
        line.cells.slip_rate = lac_run_state_gather(r, engine->work, 0);
        line.cells.log_state = lac_run_state_gather(r, y + engine->n, 1);
    }
    if (r->watched != NULL) {
        watch_points(r, lac_engine_clock(engine, t), slip, &line);
    }
    return lac_run_state_agree(
        r, lac_run_state_leads(r) ? r->sink->record(r->sink->context, &line, err) : LAC_OK, err);
}

// Of rates and tractions that were found last.
static void keep_components(lac_run_state *r, const double *slip, double *along)
{
    const size_t n = r->engine->n;
    const lac_components of = lac_problem_components(r->problem, slip, r->engine->work);
    for (int c = 0; c < 2; c++) {
        memcpy(along + (size_t)c * n, of.slip[c], n * sizeof *along);
        memcpy(along + (size_t)(2 + c) * n, of.rate[c], n * sizeof *along);
        memcpy(along + (size_t)(4 + c) * n, of.traction[c], n * sizeof *along);
    }
}

void lac_snapshot_fields(lac_snapshot *s, const double **field[LAC_SNAPSHOT_FIELDS])
{
    const double **const all[LAC_SNAPSHOT_FIELDS] = {
        &s->slip,     &s->slip_rate,   &s->state,       &s->traction, &s->factor_of_safety,
        &s->pore,     &s->excess_pore, &s->temperature, &s->broken,   &s->along[0],
        &s->along[1], &s->along[2],    &s->along[3],    &s->along[4], &s->along[5]};
    memcpy((void *)field, all, sizeof all);
}

// Of ranks each field alone, piece by piece, at last the time.
static lac_status put_fields(const lac_run_state *r, lac_snapshot *here, lac_error *err)
{
    const lac_range *range = r->engine->range;
    const bool leads = lac_run_state_leads(r);
    lac_status status = LAC_OK;
    lac_snapshot part = {.time = NAN};
    const double **from[LAC_SNAPSHOT_FIELDS], **to[LAC_SNAPSHOT_FIELDS];
    lac_snapshot_fields(here, from);
    lac_snapshot_fields(&part, to);
    for (size_t k = 0; k < LAC_SNAPSHOT_FIELDS && range->team != NULL; k++) {
        for (size_t at = 0; *from[k] != NULL && at < range->all; at += LAC_RANGE_PIECE) {
            const size_t left = range->all - at;
            part.first = at;
            part.n = left < LAC_RANGE_PIECE ? left : LAC_RANGE_PIECE;
            *to[k] = r->all;
            lac_range_bring(range, *from[k], at, part.n, r->all);
            status = leads && status == LAC_OK ? r->sink->snapshot(r->sink->context, &part, err)
                                               : status;
        }
        *from[k] = *to[k] = NULL;
    }
    status = leads && status == LAC_OK ? r->sink->snapshot(r->sink->context, here, err) : status;
    return lac_run_state_agree(r, status, err);
}

lac_status lac_run_state_snapshot(lac_run_state *r, double t, const double *y, const double *slip,
                                  lac_error *err)
{
    size_t n = r->engine->n;
    double *v = r->fields, *theta = v + n, *traction = theta + n, *pore = traction + n;
    double local = r->engine->base + t;
    if (!moves_on(&r->last_snapshot, r->engine->origin, local) ||
        (r->takes & LAC_TAKES_SNAPSHOT) == 0) {
        return LAC_OK;
    }
    project(r, t, &y, &slip);
    double now = lac_engine_clock(r->engine, t);
    lac_problem_rates(r->problem, now, y, v, r->engine->work);
    for (size_t i = 0; i < n; i++) {
        theta[i] = exp(y[n + i]);
    }
    lac_problem_traction(r->problem, now, slip, traction, r->engine->work);
    double *along = pore + n * (r->def->cell_safety ? 2 : 1);
    if (lac_problem_is_vector(r->problem)) {
        keep_components(r, slip, along);
    }
    lac_problem_pore(r->problem, now, pore, r->engine->work);
    double *safety = r->def->cell_safety ? pore + n : NULL;
    if (safety != NULL) {
        lac_problem_safety_cells(r->problem, now, y, traction, safety, r->engine->work);
    }
    const bool weakens = lac_problem_weakening(r->problem) != NULL;
    double *excess = weakens ? (safety != NULL ? safety : pore) + n : NULL;
    if (weakens) {
        lac_problem_weakened(r->problem, y, excess, excess + n, excess + 2 * n);
    }
    lac_snapshot fields = {.time = r->engine->origin + local,
                           .slip = lac_problem_slip_size(r->problem, slip, r->engine->work),
                           .slip_rate = v,
                           .state = theta,
                           .traction = traction,
                           .n = r->engine->range->all,
                           .factor_of_safety = safety,
                           .pore = pore,
                           .excess_pore = excess,
                           .temperature = weakens ? excess + n : NULL,
                           .broken = weakens ? excess + 2 * n : NULL};
    for (size_t k = 0; k < LAC_POINT_ALONG && lac_problem_is_vector(r->problem); k++) {
        fields.along[k] = along + k * n;
    }
    return put_fields(r, &fields, err);
}
