// SPDX-License-Identifier: GPL-3.0-or-later
// What lacuna run says of a run that is over, on the terminal and in JSON.
#include "cli/run/run_outcome.h"

#include <sys/resource.h>

#include "cli/common/progress.h"
#include "cli/common/words.h"
#include "cli/contact/contact.h"

const char *const cli_failure_lowered =
    "a p/eta: damping holds the joint below that of the case; judged by all cells as one";

void cli_failure_warn(const lac_failure *failure)
{
    // a decade: what accelerates by less has hardly left creep
    const double clear = 10.0;
    const cli_text reach = cli_amount(failure->reach, "m/s");
    const cli_text rate = cli_amount(failure->rate, "m/s");
    if (failure->lowered && failure->rate < clear * failure->start) {
        cli_note("warning: the failure rate, %s, is only %.2g times the slip rate at the start: "
                 "radiation damping holds so light a joint at some %s; give it its mass (inertia)",
                 rate.s, failure->rate / failure->start, reach.s);
    } else if (!failure->lowered && failure->reach > 0.0 && failure->reach < failure->rate) {
        cli_note("warning: time.failure.mean_slip_rate: %s is out of reach, radiation damping "
                 "holds the joint at some %s from the start; only time.failure.mean_slip counts, "
                 "or give it its mass (inertia)",
                 rate.s, reach.s);
    }
}

// Linux counts in KiB.
static int64_t peak_memory(void)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    return (int64_t)usage.ru_maxrss * 1024;
}

static double apparent_friction(const lac_record *record)
{
    return record->observation.shear_force / record->observation.normal_force;
}

// NaN: there is no water, or no record.
static double effective_ratio(const cli_outcome *outcome, const lac_record *record)
{
    const bool wet = outcome->of->scene->loads.pore > 0;
    return wet ? record->observation.shear_force / record->observation.effective_force : NAN;
}

// Whether the computation broke, or its file is not whole.
static bool broke(const cli_outcome *outcome) { return strcmp(outcome->status, "failed") == 0; }

bool cli_outcome_failed(const cli_outcome *outcome)
{
    return outcome->of->run.failed && !broke(outcome);
}

static double failure_time(const cli_outcome *outcome)
{
    const lac_run_result *result = &outcome->of->run;
    return cli_outcome_failed(outcome) ? result->failure_origin + result->failure_local : NAN;
}

// "" where the run has no date or there is no such time.
static cli_text date_of(const cli_outcome *outcome, double time)
{
    const lac_case *c = outcome->of->source;
    return c->dated ? cli_date(c->start_date + time) : cli_format("%s", "");
}

// "after 3.2 day, on 1963-..."
static cli_text moment(const cli_outcome *outcome, double time)
{
    const cli_text date = date_of(outcome, time);
    return cli_format("after %s%s%s", cli_exact(time, "s").s, date.s[0] != '\0' ? ", on " : "",
                      date.s);
}

static void print_safety(const cli_outcome *outcome)
{
    const lac_safety_summary *s = &outcome->of->run.safety;
    const double rate = outcome->of->source->safety.reference_rate;
    if (isnan(s->start)) {
        return;
    }
    cli_row("factor of safety", "%.4g at the start, %.4g at the end, strength at %s", s->start,
            s->end, rate > 0.0 ? cli_amount(rate, "m/s").s : "v0 of the friction");
    if (s->least_time > 0.0) {
        cli_row("  least", "%.4g, %s", s->least, moment(outcome, s->least_time).s);
    }
    if (isnan(s->below_time)) {
        cli_row("  below 1", "never");
    } else if (s->below_time > 0.0) {
        cli_row("  below 1", "first %s", moment(outcome, s->below_time).s);
    } else {
        cli_row("  below 1", "from the start");
    }
}

static const char *formulation(const cli_outcome *outcome)
{
    return lac_formulation_name(lac_problem_formulation(outcome->of->scene->problem));
}

static const char *fidelity(const cli_outcome *outcome)
{
    return lac_fidelity_name(outcome->of->source->run.fidelity);
}

// Of cells that were taken together.
static void print_lump(const lac_outcome *of)
{
    const lac_lump *lump = of->scene->lump;
    if (lump == NULL) {
        return;
    }
    cli_row("  cells", "%zu stand for %zu, in blocks of level %zu", lump->domain->n,
            of->scene->contact.domain->n, lump->level);
    if (isfinite(of->run.lump_error_estimated)) {
        cli_row("  error", "%.2g of %s by estimate; %g is allowed (solver.lump.error)",
                of->run.lump_error_estimated,
                of->run.failed                ? "the time of failure"
                : of->run.end == LAC_END_STOP ? "the time of the limit"
                                              : "the mean slip",
                of->source->lump.error);
    } else {
        cli_row("  error", "cannot be told; %g is allowed (solver.lump.error)",
                of->source->lump.error);
    }
}

static bool together(const cli_outcome *outcome)
{
    return outcome->of->source->run.fidelity == LAC_FIDELITY_ODE;
}

static void print_failure(const cli_outcome *outcome)
{
    const lac_run_result *result = &outcome->of->run;
    const cli_text time = cli_exact(result->time, "s");
    if (result->failed) {
        cli_row("failure", "%s%s", moment(outcome, failure_time(outcome)).s,
                result->end == LAC_END_SLIP ? ", by slip (time.failure.mean_slip)" : "");
    } else if (strcmp(outcome->status, "complete") != 0) {
        cli_row("failure", "none by %s, where the run was %s", time.s,
                broke(outcome) ? "broken off" : "interrupted");
    } else if (result->end == LAC_END_STOP) {
        cli_row("failure", "none; a limit of time.stop_when was reached after %s", time.s);
    } else if (result->end == LAC_END_REST) {
        cli_row("failure", "none; the block came to rest after %s", time.s);
    } else {
        cli_row("failure", "none by the end, after %s", time.s);
    }
    if (result->failure.lowered) {
        cli_row("failure rate", "%s, %s", cli_exact(result->failure.rate, "m/s").s,
                cli_failure_lowered);
    }
}

// Of a base that bends: what it has come to, and whether the joint came to rest on it.
static void print_arrest(const cli_outcome *outcome)
{
    const double degree = M_PI / 180.0;
    const lac_geometry *geometry = outcome->of->scene->loads.geometry;
    const lac_run_result *result = &outcome->of->run;
    const lac_arrest *a = &result->arrest;
    if (geometry == NULL || isnan(a->largest)) {
        return;
    }
    const lac_slab first = lac_geometry_at(geometry, 0.0);
    const lac_slab last = lac_geometry_at(geometry, result->mean_slip);
    cli_row("dip of the base", "%.4g degree at the start, %.4g degree at the end",
            first.angle / degree, last.angle / degree);
    if (!isnan(first.thickness)) {
        cli_row("thickness", "%s at the start, %s at the end", cli_amount(first.thickness, "m").s,
                cli_amount(last.thickness, "m").s);
    }
    if (result->failed || strcmp(outcome->status, "complete") != 0) {
        return;
    }
    cli_row("arrest",
            a->arrested ? "arrested: %s, slowed to %s by the end" : "none: %s, %s at the end",
            cli_format("at most %s %s", cli_amount(a->largest, "m/s").s,
                       a->largest_time > 0.0 ? moment(outcome, a->largest_time).s : "at the start")
                .s,
            cli_amount(a->end, "m/s").s);
}

static void print_cost(const cli_outcome *outcome)
{
    const lac_run_result *result = &outcome->of->run;
    const char *why = outcome->of->fidelity_why, *name = fidelity(outcome);
    const cli_text chosen = cli_format("%s, error at most %.1g: %s; fewer records than by ode",
                                       name, outcome->of->fidelity_error, why != NULL ? why : "");
    cli_row("steps", "%" PRId64 " (%" PRId64 " evaluations)", result->steps,
            result->rhs_evaluations);
    if (outcome->of->accuracy != NULL) {
        cli_row_wrap("accuracy", outcome->of->accuracy->text);
    }
    // That all cells go together is as it always is where nothing else is named.
    cli_row_wrap("fidelity", why != NULL && !together(outcome) ? chosen.s : name);
    print_lump(outcome->of);
    cli_row("formulation", "%s", formulation(outcome));
    cli_row("balance residual", "%.2g at worst", result->balance_residual);
    cli_row("time taken", "%s, CPU %s", cli_amount(outcome->wall_time, "s").s,
            cli_amount(cli_cpu_time(), "s").s);
    cli_row("peak memory", "%.3g MB", (double)peak_memory() / 1e6);
    if (outcome->resumed != NULL) {
        cli_row("resumed", "at %s, %s", cli_exact(outcome->resumed->time, "s").s,
                outcome->resumed->planned ? "a planned checkpoint: the same to the last bit"
                                          : "a forced checkpoint: the same within solver.rtol");
    }
    cli_row("file", "%s (%s)", outcome->path, outcome->status);
}

// What the indicators say.
static void print_analysis(const lac_analysis *analysis)
{
    const lac_indicator *indicator;
    for (size_t i = 0; (indicator = lac_analysis_get(analysis, i)) != NULL; i++) {
        for (size_t k = 0; k < indicator->lines; k++) {
            cli_row(indicator->line[k].label, "%s", indicator->line[k].text);
        }
    }
}

// Where the mean slip has gone, and goes: from x towards y.
static void print_direction(const cli_outcome *outcome)
{
    const double degree = 180.0 / M_PI;
    const lac_observation *last = &outcome->history.last.observation;
    if (outcome->history.begun && lac_problem_is_vector(outcome->of->scene->problem)) {
        cli_row("slip direction", "%.4g degree from x towards y, at the end towards %.4g",
                degree * atan2(last->slip_along[1], last->slip_along[0]),
                degree * atan2(last->rate_along[1], last->rate_along[0]));
    }
}

// What a seismologist looks for; where a run fails, the failure says it.
static void print_slip_events(const lac_slip_events *all)
{
    if (all->count == 0) {
        return;
    }
    const double first = all->event[0].start, last = all->event[all->count - 1].start;
    const cli_text from = cli_exact(first, "s"), to = cli_exact(last, "s");
    cli_row("slip events", "%zu above 1 mm/s: %s%s%s%s; --json has all", all->count,
            isnan(first) ? "one as the run begins" : "after ", isnan(first) ? "" : from.s,
            all->count > 1 ? ", the last after " : "", all->count > 1 ? to.s : "");
}

void cli_outcome_print(const cli_outcome *outcome)
{
    if (outcome->of->source->title != NULL) {
        puts(outcome->of->source->title);
    }
    cli_measures_print(&outcome->of->scene->contact);
    if (outcome->history.begun) {
        cli_row("apparent friction", "%.4g at the start, %.4g at the end",
                apparent_friction(&outcome->history.first),
                apparent_friction(&outcome->history.last));
    }
    if (outcome->history.begun && outcome->of->scene->loads.pore > 0) {
        cli_row("effective ratio", "%.4g at the start, %.4g at the end",
                effective_ratio(outcome, &outcome->history.first),
                effective_ratio(outcome, &outcome->history.last));
    }
    print_safety(outcome);
    print_failure(outcome);
    print_arrest(outcome);
    cli_row_quantity("mean slip", outcome->of->run.mean_slip, "m");
    print_direction(outcome);
    cli_row_quantity("largest slip rate", outcome->of->run.max_slip_rate, "m/s");
    if (!outcome->of->run.failed && together(outcome)) {
        print_slip_events(&outcome->history.slip_events);
    }
    print_analysis(outcome->of->analysis);
    print_cost(outcome);
    cli_compare_print(&outcome->compare, &outcome->history.kept);
}

static void write_failure(lac_json *json, const cli_outcome *outcome)
{
    const cli_text date = date_of(outcome, failure_time(outcome));
    if (broke(outcome)) {
        lac_json_null(json, "failed");
    } else {
        lac_json_boolean(json, "failed", outcome->of->run.failed);
    }
    lac_json_number(json, "failure_time_s", failure_time(outcome));
    lac_json_text(json, "failure_date", date.s[0] != '\0' ? date.s : NULL);
    lac_json_text(json, "ended_by",
                  lac_end_name(broke(outcome) ? LAC_END_ERROR : outcome->of->run.end));
    lac_json_number(json, "failure_rate_m_s", outcome->of->run.failure.rate);
    lac_json_number(json, "failure_slip_m", outcome->of->run.failure.slip);
    lac_json_number(json, "time_s", outcome->of->run.time);
}

// What only a slope or who asks for it has, and only who has water.
static void write_safety(lac_json *json, const cli_outcome *outcome)
{
    const lac_safety_summary *s = &outcome->of->run.safety;
    const cli_history *history = &outcome->history;
    if (outcome->of->scene->loads.pore > 0) {
        lac_json_number(json, "initial_effective_ratio", effective_ratio(outcome, &history->first));
        lac_json_number(json, "effective_ratio", effective_ratio(outcome, &history->last));
    }
    if (outcome->of->source->safety.asked) {
        lac_json_number(json, "initial_factor_of_safety", s->start);
        lac_json_number(json, "least_factor_of_safety", s->least);
        lac_json_number(json, "least_factor_of_safety_time_s", s->least_time);
        lac_json_number(json, "factor_of_safety", s->end);
        lac_json_number(json, "factor_of_safety_below_1_time_s", s->below_time);
    }
}

static void write_arrest(lac_json *json, const cli_outcome *outcome)
{
    const lac_geometry *geometry = outcome->of->scene->loads.geometry;
    const lac_run_result *result = &outcome->of->run;
    if (geometry == NULL) {
        return;
    }
    const lac_slab last = lac_geometry_at(geometry, result->mean_slip);
    lac_json_boolean(json, "arrested", result->arrest.arrested);
    lac_json_number(json, "largest_mean_slip_rate_m_s", result->arrest.largest);
    lac_json_number(json, "largest_mean_slip_rate_time_s", result->arrest.largest_time);
    lac_json_number(json, "mean_slip_rate_m_s", result->arrest.end);
    lac_json_number(json, "angle_rad", last.angle);
    lac_json_number(json, "thickness_m", last.thickness);
}

static void write_lump(lac_json *json, const lac_outcome *of)
{
    const lac_lump *lump = of->scene->lump;
    const double error = of->run.lump_error_estimated;
    if (lump != NULL) {
        lac_json_open(json, "lump", '{');
        lac_json_integer(json, "cells", (int64_t)lump->domain->n);
        lac_json_integer(json, "level", (int64_t)lump->level);
        lac_json_integer(json, "blocks", (int64_t)lump->blocks);
        lac_json_number(json, "error_asked", of->source->lump.error);
        lac_json_close(json, '}');
        lac_json_number(json, "lump_error_estimated", error > 0.0 ? error : (double)NAN);
    }
}

static void write_slip_events(lac_json *json, const lac_slip_events *all)
{
    lac_json_open(json, "slip_events", '[');
    for (size_t i = 0; i < all->count; i++) {
        const lac_slip_event *e = &all->event[i];
        lac_json_open(json, NULL, '{');
        lac_json_number(json, "time_s", e->start);
        lac_json_number(json, "end_time_s", e->end);
        lac_json_number(json, "max_slip_rate_m_s", e->max_rate);
        lac_json_number(json, "max_slip_rate_time_s", e->peak);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}

static void write_results(lac_json *json, const cli_outcome *outcome)
{
    const cli_history *history = &outcome->history;
    const lac_run_result *result = &outcome->of->run;
    lac_json_number(json, "max_slip_rate_m_s", result->max_slip_rate);
    lac_json_number(json, "mean_slip_m", result->mean_slip);
    if (lac_problem_is_vector(outcome->of->scene->problem)) {
        lac_json_number(json, "mean_slip_x_m", history->last.observation.slip_along[0]);
        lac_json_number(json, "mean_slip_y_m", history->last.observation.slip_along[1]);
    }
    if (!lac_analysis_has_events(outcome->of->analysis)) {
        lac_json_null(json, "events"); // else the catalogue says how many
    }
    if (together(outcome)) {
        write_slip_events(json, &history->slip_events);
    } else { // cells are together only at the ends of sweeps
        lac_json_null(json, "slip_events");
    }
    lac_json_number(json, "balance_residual", result->balance_residual);
    lac_json_number(json, "rate_drift", result->rate_drift);
    lac_json_text(json, "fidelity", fidelity(outcome));
    lac_json_text(json, "fidelity_why", outcome->of->fidelity_why);
    lac_json_number(json, "fidelity_error", outcome->of->fidelity_error);
    write_lump(json, outcome->of);
    lac_json_text(json, "formulation", formulation(outcome));
    lac_json_number(json, "initial_apparent_friction", apparent_friction(&history->first));
    lac_json_number(json, "apparent_friction", apparent_friction(&history->last));
    write_safety(json, outcome);
    write_arrest(json, outcome);
}

static void write_accuracy(lac_json *json, const lac_accuracy_pick *pick)
{
    if (pick == NULL) {
        lac_json_null(json, "accuracy");
        return;
    }
    lac_json_open(json, "accuracy", '{');
    lac_json_number(json, "asked", pick->asked);
    lac_json_number(json, "estimated", pick->estimated);
    lac_json_text(json, "quantity", pick->of);
    lac_json_number(json, "rtol", pick->rtol);
    lac_json_text(json, "method", pick->method);
    lac_json_text(json, "formulation", pick->formulation);
    lac_json_integer(json, "pilots", pick->pilots);
    lac_json_integer(json, "pilot_rhs_evaluations", pick->evaluations);
    lac_json_number(json, "pilot_work", pick->work);
    lac_json_boolean(json, "pilot_kept", pick->kept);
    lac_json_close(json, '}');
}

static void write_analysis(lac_json *json, const lac_analysis *analysis)
{
    const lac_indicator *indicator;
    for (size_t i = 0; (indicator = lac_analysis_get(analysis, i)) != NULL; i++) {
        for (size_t k = 0; k < indicator->results; k++) {
            const lac_analysis_result *result = &indicator->result[k];
            if (result->text != NULL) {
                lac_json_text(json, result->key, result->text);
            } else if (result->value == rint(result->value) && fabs(result->value) < 1e15) {
                lac_json_integer(json, result->key, (int64_t)result->value); // 40, not 4e+01
            } else {
                lac_json_number(json, result->key, result->value);
            }
        }
    }
}

lac_status cli_outcome_json(const cli_outcome *outcome, lac_error *err)
{
    lac_json json = {.out = stdout};
    const lac_run_result *result = &outcome->of->run;
    lac_json_open(&json, NULL, '{');
    lac_json_text(&json, "title", outcome->of->source->title);
    lac_json_text(&json, "status", outcome->status);
    write_failure(&json, outcome);
    const lac_contact_outcome contact = {.contact = &outcome->of->scene->contact, .brief = true};
    lac_dataset *measures = NULL;
    const lac_status status = lac_contact_describe(&contact, &measures, err);
    if (status == LAC_OK) {
        lac_dataset_json(measures, &json);
    }
    lac_dataset_free(measures);
    write_results(&json, outcome);
    write_accuracy(&json, outcome->of->accuracy);
    write_analysis(&json, outcome->of->analysis);
    lac_json_integer(&json, "steps", result->steps);
    lac_json_integer(&json, "rhs_evaluations", result->rhs_evaluations);
    lac_json_integer(&json, "newton_iterations", result->newton_iterations);
    lac_json_integer(&json, "linear_solves", result->linear_solves);
    lac_json_integer(&json, "error_test_fails", result->error_test_fails);
    lac_json_integer(&json, "nonlinear_fails", result->nonlinear_fails);
    lac_json_number(&json, "wall_time_s", outcome->wall_time);
    lac_json_number(&json, "cpu_time_s", cli_cpu_time());
    lac_json_integer(&json, "peak_memory_bytes", peak_memory());
    if (outcome->resumed != NULL) {
        lac_json_number(&json, "resumed_at_s", outcome->resumed->time);
        lac_json_text(&json, "resumed_from", outcome->resumed->planned ? "planned" : "forced");
    }
    lac_json_text(&json, "output", outcome->path);
    cli_compare_json(&json, &outcome->compare, &outcome->history.kept);
    lac_json_close(&json, '}');
    return status;
}
