// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit came to, as tables: the variables of its file and the members of its JSON.
#include "data/describe.h"
#include "fit/fit.h"

enum { NAME = 256, TITLE = 300 };

#define RESULT const lac_fit_result *r = of
#define UNKNOWN const lac_fit_unknown *x = of
#define OUTCOME const lac_fit_outcome *o = of

// The draws of one unknown.
static double draw_of(const lac_fit_result *r, size_t chain, size_t step, size_t unknown)
{
    const lac_chain *c = r->chain;
    const double x = c->x[(step * c->walkers + chain) * c->dimension + unknown];
    return r->unknown[unknown].log ? exp(x) : x;
}

LAC_GETTER(double, draw, RESULT, draw_of(r, at[0], at[1], at[2]))
LAC_GETTER(double, best, RESULT, r->unknown[at[0]].best)
LAC_GETTER(double, log_density, RESULT, r->chain->log_density[at[1] * r->chain->walkers + at[0]])
LAC_GETTER(double, acceptance, RESULT, r->chain->acceptance[at[0]])
LAC_GETTER(double, rms_slip, RESULT, r->friction ? NAN : r->displacement_rms)
LAC_GETTER(double, rms_friction, RESULT, r->friction ? r->displacement_rms : NAN)
LAC_GETTER(double, scatter_slip, RESULT, r->friction ? NAN : r->scatter)
LAC_GETTER(double, scatter_friction, RESULT, r->friction ? r->scatter : NAN)
LAC_GETTER(double, offset_slip, RESULT, r->friction ? NAN : r->offset)
LAC_GETTER(bool, is_slip, RESULT, !r->friction)
LAC_GETTER(bool, is_friction, RESULT, r->friction)
LAC_GETTER(bool, has_windows, RESULT, r->windows)
LAC_GETTER(double, walkers, RESULT, (double)r->chain->walkers)
LAC_GETTER(double, steps, RESULT, (double)r->chain->steps)
LAC_GETTER(bool, is_sampled, RESULT, r->chain != NULL)
LAC_GETTER(bool, is_one_block, RESULT, r->one_block)
LAC_GETTER(double, correlation, RESULT, r->correlation[at[0]][at[1]])
LAC_GETTER(double, best_power, RESULT, r->axis[r->parameters - 1].power[at[0]])
LAC_GETTER(double, best_sigma, RESULT, r->axis[r->parameters - 1].sigma)
LAC_TEXT_GETTER(key_of, RESULT, r->unknown[at[0]].key)
LAC_TEXT_GETTER(formula, RESULT; (void)r, "(m/dc)(1 - x^(m-1))")

LAC_GETTER(bool, is_log, UNKNOWN, x->log)
LAC_GETTER(bool, is_plain, UNKNOWN, !x->log)
LAC_GETTER(double, error, UNKNOWN, x->log ? NAN : x->error)
LAC_GETTER(double, log_error, UNKNOWN, x->log ? x->error : NAN)
LAC_TEXT_GETTER(end, UNKNOWN, x->end == 0 ? NULL : x->end < 0 ? "low" : "high")

static const char *const derivatives[] = {"sensitivities", "runs", NULL};

LAC_TEXT_GETTER(point, OUTCOME, o->source->fit.point)
LAC_GETTER(bool, has_point, OUTCOME, o->source->fit.point != NULL)
LAC_GETTER(double, seed, OUTCOME, (double)o->source->fit.seed)

static double share(const void *of, const size_t *at)
{
    static const double quantile[LAC_FIT_QUANTILES] = {0.05, 0.25, 0.5, 0.75, 0.95};
    (void)of;
    return quantile[at[0]];
}

#define X(kind, field) LAC_HELD(kind, lac_fit_unknown, field)
#define R(kind, field) LAC_HELD(kind, lac_fit_result, field)

// Five quantiles of a posterior. A member of a struct cannot stand in parentheses.
// NOLINTBEGIN(bugprone-macro-parentheses)
#define QUANTILES(median, in50, in90, held, q)                                  \
    {.json = (median), held(REAL, q[2])}, {.json = (in50), held(REAL, q[1])},   \
        {.json = (in50), held(REAL, q[3])}, {.json = (in90), held(REAL, q[0])}, \
    {                                                                           \
        .json = (in90), held(REAL, q[4])                                        \
    }
// NOLINTEND(bugprone-macro-parentheses)

// What a file says of an unknown beside its draws.
static const lac_variable beside_draws[] = {
    {.name = "best_fit", X(REAL, best)},
    {.name = "standard_error_of_logarithm", .value = log_error},
    {.name = "standard_error", .value = error},
    {.name = "best_fit_at_end_of_range", X(REAL, limit)},
    {.name = "rhat", X(REAL, converged.rhat)},
    {.name = "effective_sample_size", X(REAL, converged.ess)},
    {.name = "case_key", X(TEXT, key)},
};

static const lac_variable of_unknowns[] = {
    {.json = "parameters[]/key", X(TEXT, key)},
    {.json = "parameters[]/unit", X(TEXT, unit)},
    {.json = "parameters[]/best", X(REAL, best)},
    {.json = "parameters[]/at_end_of_range", .text = end},
    {.json = "parameters[]/end_of_range", X(REAL, limit)},
    {.json = "parameters[]/error_of_logarithm", X(REAL, error), .has = is_log},
    {.json = "parameters[]/error", X(REAL, error), .has = is_plain},
    {.json = "parameters[]/derivatives", X(INT, by), .names = derivatives},
    QUANTILES("parameters[]/median", "parameters[]/interval50", "parameters[]/interval90", X,
              quantile),
    {.json = "parameters[]/rhat", X(REAL, converged.rhat)},
    {.json = "parameters[]/ess", X(REAL, converged.ess)},
    {.json = "parameters[]/autocorrelation_steps", X(REAL, converged.time)},
};

static const lac_variable of_data[] = {
    {.json = "displacements", R(COUNT, displacements)},
    {.json = "frictions", R(COUNT, frictions)},
    {.json = "velocities", R(COUNT, velocities)},
    {.json = "bounds", R(COUNT, bounds)},
    {.json = "outside", R(COUNT, outside)},
    {.json = "missing", R(COUNT, missing)},
    {.json = "not_positive", R(COUNT, not_positive)},
    {.json = "rms_m", .value = rms_slip},
    {.name = "rms_friction", .json = "rms_friction", .value = rms_friction},
    {.json = "rms_ln_rate", R(REAL, log_rate_rms)},
    {.json = "offset_m", .value = offset_slip},
    {.json = "log_likelihood", R(REAL, log_likelihood)},
    {.name = "bic", .json = "bic", R(REAL, bic)},
    {.name = "log_evidence", .json = "log_evidence", R(REAL, evidence)},
    {.name = "log_evidence_error", .json = "log_evidence_error", R(REAL, evidence_error)},
    {.json = "residual_autocorrelation", R(REAL, autocorrelation)},
    {.json = "scatter_m", .value = scatter_slip},
    {.json = "scatter_friction", .value = scatter_friction},
    {.json = "misfit", R(REAL, misfit)},
    {.json = "excess", R(REAL, excess)},
    {.name = "fits_badly", .json = "fits_badly", R(BOOL, poor)},
    {.json = "readings_fall", R(BOOL, falls)},
};

// Values that may be missing.
#define SERIES(name, dims, unit, field, has_, title) \
    LAC_ROW(name, dims, unit, title, R(REALS, field), .flags = LAC_MISSING, .has = (has_))
#define WAS_READ(what) what " that was read"

static const lac_variable of_result[] = {
    {.json = "correlation[][]", .dims = "parameter parameter", .value = correlation},
    {.json = "known_best/powers{}", .dims = "parameter", .value = best_power, .label = key_of},
    {.json = "known_best/sigma_of_logarithm", .value = best_sigma},
    {.json = "known_least/powers{}", .dims = "parameter", R(REAL, axis[0].power), .label = key_of},
    {.json = "known_least/sigma_of_logarithm", R(REAL, axis[0].sigma)},
    {.json = "shape/formula", .text = formula, .has = is_one_block},
    QUANTILES("shape/median_1_m", "shape/interval50_1_m", "shape/interval90_1_m", R,
              shape.quantile),
    {.json = "shape/sigma_of_logarithm", R(REAL, shape_sigma)},
    {.json = "best_failure_time_s", R(REAL, failure)},
    {.json = "best_failure_error_s", R(REAL, failure_error)},
    QUANTILES("tc_s", "interval50_s", "interval90_s", R, failures.quantile),
    {.json = "share_failing", R(REAL, failing)},
    {.json = "sampler/walkers", .value = walkers, .has = is_sampled},
    {.json = "sampler/steps", .value = steps},
    {.json = "sampler/burn", R(COUNT, dropped)},
    {.json = "sampler/converged", R(BOOL, converged)},
    {.json = "sampler/acceptance", R(REAL, acceptance)},
    {.json = "runs", R(INT64, runs)},
    {.json = "best_failure_date", R(REAL, failure), .flags = LAC_DATE},
    {.json = "tc_date", R(REAL, failures.quantile[2]), .flags = LAC_DATE},
    LAC_ROW("log_posterior", "chain draw", "1",
            "logarithm of the posterior density of the coordinates, up to a constant",
            .value = log_density),
    LAC_ROW("acceptance", "chain", "1", "share of a walker's moves that were accepted",
            .value = acceptance),
    LAC_ROW("quantile", "quantile", "1", "share of the posterior below", .value = share),
    LAC_ROW("prediction_time", "prediction", NULL, "time of a prediction", R(REALS, time),
            .flags = LAC_TIME),
    SERIES("best_displacement", "prediction", "m", fitted, is_slip,
           "displacement of the best fit, its zero that of the data"),
    SERIES("best_friction", "prediction", "1", fitted, is_friction, "friction of the best fit"),
    SERIES("predicted_displacement", "quantile prediction", "m", displacement, is_slip,
           "quantiles of the posterior's displacement; missing beyond failure"),
    SERIES("predicted_friction", "quantile prediction", "1", displacement, is_friction,
           "quantiles of the posterior's friction; missing beyond failure"),
    SERIES("predicted_slip_rate", "quantile prediction", "m s-1", rate, NULL,
           "quantiles of the posterior's slip rate; missing beyond failure"),
    LAC_ROW("reading_time", "reading", NULL, "time of a reading", R(REALS, reading_time),
            .flags = LAC_TIME),
    SERIES("observed_displacement", "reading", "m", observed, is_slip, WAS_READ("displacement")),
    SERIES("observed_friction", "reading", "1", observed, is_friction,
           WAS_READ("friction coefficient")),
    SERIES("observed_slip_rate", "reading", "m s-1", observed_rate, NULL, WAS_READ("velocity")),
    SERIES("observed_slip_rate_most", "reading", "m s-1", observed_most, has_windows,
           "upper bound of the velocity that was stated"),
    LAC_ROW("reading_time_within", "reading", "s",
            "how far the time of a reading may be off, to either side", R(REALS, reading_within),
            .has = has_windows),
    SERIES("observed_slip_rate_rank", "reading", "1", rate_rank, has_windows,
           "share of what the posterior predicts of a reading of the velocity that lies below it"),
    SERIES("observed_slip_rate_most_kept", "reading", "1", most_kept, has_windows,
           "probability under the posterior that the upper bound is kept"),
    LAC_ROW("failure_time", "sample", NULL,
            "time of failure of draws that were run on; missing where none by the end of the run",
            R(REALS, draw_failure), .flags = LAC_TIME | LAC_MISSING),
};

LAC_GETTER(double, place, RESULT; (void)r, (double)at[0])
LAC_GETTER(double, accepted, RESULT, r->chain->moved[at[1] * r->chain->walkers + at[0]] ? 1 : 0)
LAC_GETTER(bool, has_moves, RESULT, r->chain != NULL && r->chain->moved != NULL)
LAC_GETTER(bool, has_slip, RESULT, r->displacements > 0)
LAC_GETTER(bool, has_rate, RESULT, r->velocities > 0 && !r->windows)

#define PLACE(group, dim, title) \
    LAC_ROW(group "/" dim, dim, "1", title, .value = place, .flags = LAC_WHOLE)
#define OF_DRAWS "predictive/chain predictive/draw reading"
#define PREDICTED(group, title, metre, speed, reading, rate)                                    \
    LAC_ROW(group "/chain", "predictive/chain", "1", "all walkers together", .value = place,    \
            .flags = LAC_WHOLE),                                                                \
        LAC_ROW(group "/draw", "predictive/draw", "1", "draw, evenly taken", .value = place,    \
                .flags = LAC_WHOLE),                                                            \
        LAC_ROW(group "/reading", "reading", NULL, "time of a reading", R(REALS, reading_time), \
                .flags = LAC_TIME),                                                             \
        SERIES(group "/displacement", OF_DRAWS, metre, reading, has_slip,                       \
               title " of a displacement"),                                                     \
        SERIES(group "/friction", OF_DRAWS, "1", reading, is_friction,                          \
               title " of a friction coefficient"),                                             \
        SERIES(group "/slip_rate", OF_DRAWS, speed, rate, has_rate, title " of a velocity")

// What other tools of Bayesian statistics read: the groups of ArviZ's InferenceData.
static const lac_variable of_inference[] = {
    PLACE("posterior", "chain", "walker"),
    PLACE("posterior", "draw", "draw"),
    PLACE("sample_stats", "chain", "walker"),
    PLACE("sample_stats", "draw", "draw"),
    LAC_ROW("sample_stats/lp", "chain draw", "1",
            "logarithm of the posterior density of the coordinates, up to a constant",
            .value = log_density),
    LAC_ROW("sample_stats/accepted", "chain draw", "1",
            "1: the move that led to the draw was accepted", .value = accepted, .flags = LAC_WHOLE,
            .has = has_moves),
    LAC_ROW("observed_data/reading", "reading", NULL, "time of a reading", R(REALS, reading_time),
            .flags = LAC_TIME),
    SERIES("observed_data/displacement", "reading", "m", observed, has_slip,
           WAS_READ("displacement")),
    SERIES("observed_data/friction", "reading", "1", observed, is_friction,
           WAS_READ("friction coefficient")),
    SERIES("observed_data/slip_rate", "reading", "m s-1", observed_rate, has_rate,
           WAS_READ("velocity")),
    PREDICTED("posterior_predictive", "prediction", "m", "m s-1", told_reading, told_rate),
    PREDICTED("log_likelihood", "logarithm of the likelihood", "1", "1", likely_reading,
              likely_rate),
};

static const lac_variable of_outcome[] = {
    {.json = "sampler/seed", .value = seed},
    {.name = "point", .json = "point", .text = point, .has = has_point},
    {.name = "status", .json = "status", LAC_HELD(TEXT, lac_fit_outcome, status)},
};

// "friction.aging.dc" as a name that every tool takes.
static void name_of(char *name)
{
    for (char *c = name; *c != '\0'; c++) {
        *c = *c == '.' || *c == '-' ? '_' : *c;
    }
}

// A variable an unknown: its draws over (chain, draw), or its best value alone.
static lac_status add_draws(lac_dataset *d, const lac_fit_result *r, lac_error *err)
{
    static const lac_variable drawn = {.dims = "chain draw", .value = draw};
    static const lac_variable alone = {.dims = "", .value = best, .flags = LAC_SINGLE};
    const bool any = r->chain != NULL && r->chain->steps > 0;
    const lac_laid beside = {LAC_VARIABLES(beside_draws, "", sizeof(lac_fit_unknown)), r->unknown};
    lac_status status = LAC_OK;
    for (size_t k = 0; k < r->unknowns && status == LAC_OK; k++) {
        char name[NAME], title[TITLE];
        const char *key = r->unknown[k].key;
        (void)snprintf(name, sizeof name, "posterior/%s", key);
        name_of(name);
        (void)snprintf(title, sizeof title, "%s of %s", any ? "posterior draws" : "best fit", key);
        lac_named named = {
            .name = name, .long_name = title, .unit = r->unknown[k].unit, .which = k};
        status = any ? lac_dataset_add_named(d, &drawn, &named, r, err) : LAC_OK;
        LAC_TRY_RETURN(status);
        named.name += sizeof "posterior/" - 1;
        status = lac_dataset_add_named(d, any ? &drawn : &alone, &named, r, err);
        if (status == LAC_OK) {
            lac_dataset_attributes(d, &beside);
        }
    }
    return status;
}

lac_status lac_fit_describe(const lac_fit_outcome *o, lac_dataset **out, lac_error *err)
{
    const lac_fit_result *r = o->result;
    const lac_extent dims[] = {{"chain", r->chain != NULL ? r->chain->walkers : 0},
                               {"draw", r->chain != NULL ? r->chain->steps : 0},
                               {"quantile", LAC_FIT_QUANTILES},
                               {"prediction", r->times},
                               {"reading", r->readings},
                               {"sample", r->draws},
                               {"predictive/chain", r->told > 0 ? 1 : 0},
                               {"predictive/draw", r->told},
                               {"unknown", r->unknowns},
                               {"parameter", r->parameters}};
    const lac_laid laid[] = {
        {LAC_VARIABLES(of_data, "", 0), r},
        {LAC_VARIABLES(of_unknowns, "unknown", sizeof(lac_fit_unknown)), r->unknown},
        {LAC_VARIABLES(of_result, "", 0), r},
        {LAC_VARIABLES(of_inference, "", 0), r},
        {LAC_VARIABLES(of_outcome, "", 0), o}};
    lac_status status;
    LAC_TRY(lac_dataset_create("Parameters of a creep model fitted to a monitoring series: draws "
                               "of the posterior, predicted series and times of failure.",
                               out, err));
    (*out)->clock = o->source->dated ? LAC_CLOCK_START : LAC_CLOCK_NONE;
    (*out)->start = o->source->start_date;
    LAC_TRY(lac_dataset_dims(*out, dims, sizeof dims / sizeof *dims, err));
    LAC_TRY(add_draws(*out, r, err));
    LAC_TRY(lac_dataset_add(*out, laid, sizeof laid / sizeof *laid, err));
out:
    LAC_MADE(status, out, lac_dataset_free);
}
