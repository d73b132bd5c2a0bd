// SPDX-License-Identifier: GPL-3.0-or-later
// The run of a member: what came of it, and its slip rates on the axis that all members share.
#include "precursor/precursor.h"
#include "simulation/simulation.h"
#include "sweep/ensemble.h"
#include "trade/probe.h"

size_t lac_member_size(const lac_sweep *sweep)
{
    return (sizeof(lac_member) + sweep->records * sizeof(float) + 7) / 8 * 8;
}

// All records of a run, of which the series is made when it is over.
typedef struct track {
    struct {
        double time, log_rate;
    } * at; // [n]
    size_t n, room;
    double *moment; // [events] of the catalogue
    size_t events, event_room;
} track;

static lac_status on_record(void *context, const lac_record *record, lac_error *err)
{
    track *all = context;
    LAC_TRY_RETURN(lac_grow(&all->at, &all->room, all->n + 1, sizeof *all->at, err));
    all->at[all->n].time = record->time_origin + record->time_local;
    all->at[all->n++].log_rate = log(fabs(record->observation.mean_rate));
    return LAC_OK;
}

static lac_status on_event(void *context, const lac_event *event, lac_error *err)
{
    track *all = context;
    LAC_TRY_RETURN(
        lac_grow(&all->moment, &all->event_room, all->events + 1, sizeof *all->moment, err));
    all->moment[all->events++] = event->moment;
    return LAC_OK;
}

// Of straight lines ln v over t between records.
static double rate_at(const track *all, double time)
{
    size_t i = 0;
    if (all->n == 0 || time < all->at[0].time || time > all->at[all->n - 1].time) {
        return NAN;
    }
    while (i + 2 < all->n && all->at[i + 1].time < time) {
        i++;
    }
    const size_t k = all->n > 1 ? i + 1 : i;
    const double width = all->at[k].time - all->at[i].time;
    const double part = width > 0.0 ? (time - all->at[i].time) / width : 0.0;
    // A rest has no logarithm.
    if (!isfinite(all->at[i].log_rate) || !isfinite(all->at[k].log_rate)) {
        return exp(all->at[part < 0.5 ? i : k].log_rate);
    }
    return exp(all->at[i].log_rate + part * (all->at[k].log_rate - all->at[i].log_rate));
}

// When a rate is first passed.
static double time_of(const track *all, double rate)
{
    const double wanted = log(rate);
    size_t i = 0;
    while (i < all->n && !(all->at[i].log_rate >= wanted)) {
        i++;
    }
    if (i == all->n) {
        return NAN;
    }
    const double rise = i > 0 ? all->at[i].log_rate - all->at[i - 1].log_rate : 0.0;
    const double part = rise > 0.0 && isfinite(rise) ? (all->at[i].log_rate - wanted) / rise : 0.0;
    return i == 0 ? all->at[0].time
                  : all->at[i].time - part * (all->at[i].time - all->at[i - 1].time);
}

static void fill_series(const lac_sweep *sweep, const track *all, lac_member *out)
{
    for (size_t i = 0; i < sweep->records; i++) {
        const double at = sweep->place[i];
        const double value = sweep->series == LAC_SERIES_TIME ? rate_at(all, at)
                             : sweep->series == LAC_SERIES_RATE
                                 ? time_of(all, at)
                                 : rate_at(all, out->failure_time - at);
        out->series[i] = (float)value;
    }
}

static void take(const lac_trade_probe *probe, const lac_outcome *of, lac_member *out)
{
    double value[LAC_QUANTITIES];
    const lac_run_result *run = &of->run;
    lac_trade_probe_values(probe, run, true, value);
    out->ended = (int32_t)run->end;
    out->failure_time = value[LAC_QUANTITY_FAILURE];
    out->end_time = run->time;
    out->mean_slip = run->mean_slip;
    out->end_rate = probe->rate;
    out->max_rate = run->max_slip_rate;
    out->max_ratio = probe->load;
    out->safety = run->safety.least;
    out->events = of->source->analysis.count > 0 && probe->events > 0 ? (double)probe->events : NAN;
    out->steps = (double)run->steps;
    out->balance_residual = run->balance_residual;
    for (size_t i = 0, k = 0; i < of->extras && of->once != NULL; i++) {
        if (of->extra[i].over == LAC_OVER_NOTHING && k < LAC_MEMBER_EXTRAS) {
            out->extra[k] = of->once[k];
            k++;
        }
    }
}

// Every step is recorded, so that slip rates are read off between steps.
static lac_status follow(const lac_sweep *sweep, const lac_case *c,
                         const lac_simulation_options *options, lac_member *out, lac_error *err)
{
    lac_simulation *simulation = NULL;
    track all = {0};
    lac_trade_probe probe;
    lac_sink own = lac_sink_default();
    own.context = &all;
    own.record = on_record;
    own.event = on_event;
    lac_case every = *c; // no more than a look: what it points to stays the case's
    every.use = NULL;
    every.run.record = (lac_cadence){.steps = 1, .time = NAN, .per_decade = NAN};
    every.run.snapshots = false;
    every.run.checkpoint = (lac_cadence){.steps = 0, .time = NAN, .per_decade = NAN};
    lac_status status = lac_simulation_create(&every, options, &simulation, err);
    if (status == LAC_OK) {
        const lac_sink sink = lac_trade_probe_start(&probe, c, &own);
        status = lac_simulation_run(simulation, &sink, err);
    }
    if (status == LAC_OK) {
        take(&probe, lac_simulation_outcome(simulation), out);
        fill_series(sweep, &all, out);
        out->state = LAC_MEMBER_DONE;
        const lac_event_list events = {.n = all.events, .moment = all.moment};
        status = lac_events_b_value(&events, &out->b_value, err);
    }
    lac_simulation_free(simulation);
    free(all.at);
    free(all.moment);
    return status;
}

void lac_member_break(const lac_sweep *sweep, size_t index, lac_member *out)
{
    memset((void *)out, 0, lac_member_size(sweep));
    *out = (lac_member){.index = (int64_t)index,
                        .state = LAC_MEMBER_BROKEN,
                        .ended = LAC_END_REST + 1,
                        .failure_time = NAN,
                        .end_time = NAN,
                        .mean_slip = NAN,
                        .end_rate = NAN,
                        .max_rate = NAN,
                        .max_ratio = NAN,
                        .safety = NAN,
                        .events = NAN,
                        .b_value = NAN,
                        .balance_residual = NAN,
                        .steps = NAN};
    for (size_t i = 0; i < LAC_MEMBER_EXTRAS; i++) {
        out->extra[i] = NAN;
    }
    for (size_t i = 0; i < sweep->records; i++) {
        out->series[i] = NAN;
    }
}

lac_status lac_member_run(lac_sweep *sweep, size_t index, const lac_simulation_options *options,
                          lac_member *out, lac_error *err)
{
    const lac_case *c = NULL;
    lac_error why = {""};
    lac_member_break(sweep, index, out);
    lac_status status = lac_sweep_case(sweep, index, &c, &why);
    if (status == LAC_OK) {
        status = follow(sweep, c, options, out, &why);
    }
    if (status == LAC_EINTERRUPT || status == LAC_ENOMEM || status == LAC_EIO) {
        return lac_fail(err, status, "%s", why.message);
    }
    if (status != LAC_OK) {
        (void)snprintf(out->message, sizeof out->message, "%s", why.message);
    }
    return LAC_OK;
}

lac_status lac_member_write(lac_sweep *sweep, size_t index, const char *path,
                            const lac_write_options *how, lac_error *err)
{
    const lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    lac_status status;
    LAC_TRY(lac_sweep_case(sweep, index, &c, err));
    LAC_TRY(lac_simulation_create(c, NULL, &simulation, err));
    LAC_TRY(lac_simulation_write(simulation, path, how, err));
out:
    lac_simulation_free(simulation);
    return status;
}
