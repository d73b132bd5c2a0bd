// SPDX-License-Identifier: GPL-3.0-or-later
// A fit from its start to its result: the readings on the clock of a run, unknowns from the case,
// least squares, sampler, predictions; and whether it is to be relied on.
#include "fit/internal.h"

// A row of the file as it is used; what has no logarithm is counted. @return LAC_EINPUT
static lac_status take_row(const lac_case *c, const lac_series *series, size_t i, lac_fit_data *out,
                           lac_fit_seen *row, lac_error *err)
{
    const lac_series_def *columns = &c->fit.columns;
    const bool sized = columns->velocity_sigma != NULL, free = columns->within != NULL;
    *row = (lac_fit_seen){
        .time = series->time[i] - (series->dated ? c->start_date : 0.0),
        .displacement = columns->value != NULL         ? series->value[i]
                        : series->displacement != NULL ? series->displacement[i]
                                                       : NAN,
        .velocity = series->velocity != NULL ? series->velocity[i] : NAN,
        .most = columns->velocity_most != NULL ? series->velocity_most[i] : NAN,
        .sigma = columns->sigma != NULL ? series->value[i] : 1.0,
        .rate_sigma = sized ? series->velocity_sigma[i] : 1.0,
        .within = free && !isnan(series->within[i]) ? series->within[i] : 0.0,
    };
    const bool rated = !isnan(row->velocity) || !isnan(row->most);
    LAC_FAIL_IF(columns->sigma != NULL && !isnan(row->displacement) && !(row->sigma > 0.0), err,
                LAC_EINPUT, "line %zu: %s: the standard error of a displacement must be > 0",
                series->line[i], columns->sigma);
    LAC_FAIL_IF(rated && !(row->rate_sigma > 0.0), err, LAC_EINPUT,
                "line %zu: %s: the standard error of a velocity's logarithm must be > 0",
                series->line[i], columns->velocity_sigma);
    LAC_FAIL_IF(!(row->within >= 0.0), err, LAC_EINPUT,
                "line %zu: %s: how far a time may be off must be >= 0, is %g s", series->line[i],
                columns->within, row->within);
    LAC_FAIL_IF(row->most <= 0.0, err, LAC_EINPUT,
                "line %zu: %s: an upper bound of a velocity must be > 0, is %g m/s",
                series->line[i], columns->velocity_most, row->most);
    out->not_positive += row->velocity <= 0.0 ? 1 : 0;
    row->velocity = row->velocity > 0.0 ? row->velocity : NAN;
    return LAC_OK;
}

static lac_status keep(const lac_case *c, const lac_series *series, lac_fit_data *out,
                       lac_error *err)
{
    const bool rates = lac_fit_has_rates(&c->fit);
    for (size_t i = 0; i < series->n; i++) {
        lac_fit_seen row;
        LAC_TRY_RETURN(take_row(c, series, i, out, &row, err));
        if (!(row.time >= 0.0) || row.time > c->run.end || row.time > c->fit.until) {
            out->outside++;
            continue;
        }
        if (isnan(row.displacement) && isnan(row.velocity) && isnan(row.most)) {
            out->missing += rates ? 1 : 0; // a row has a rate or a bound
            continue;
        }
        out->time[out->n] = row.time;
        out->displacement[out->n] = row.displacement;
        out->log_rate[out->n] = log(row.velocity);
        out->sigma[out->n] = row.sigma;
        out->displacements += isnan(row.displacement) ? 0 : 1;
        out->velocities += isnan(row.velocity) ? 0 : 1;
        out->velocities += isnan(row.most) ? 0 : 1;
        out->bounds += isnan(row.most) ? 0 : 1;
        out->seen[out->rows++] = row;
        out->n++;
    }
    return rates ? lac_fit_look_at_rates(out, c->run.end, err) : LAC_OK;
}

static lac_status read_data(const lac_case *c, const lac_series *series, lac_fit_data *out,
                            lac_error *err)
{
    *out = (lac_fit_data){.missing = lac_fit_has_rates(&c->fit) ? 0 : series->missing,
                          .digit = series->displacement_digit};
    LAC_FAIL_IF(series->dated && !c->dated, err, LAC_EINPUT,
                "the series has dates, so time.start of %s must be a date", c->path);
    LAC_FAIL_IF((c->fit.columns.velocity_sigma != NULL && series->velocity_sigma == NULL) ||
                    (c->fit.columns.velocity_most != NULL && series->velocity_most == NULL) ||
                    (c->fit.columns.within != NULL && series->within == NULL),
                err, LAC_EINPUT, "the series was read without columns that the case's fit names");
    const size_t looks = lac_fit_has_rates(&c->fit) ? 1 + 2 * LAC_FIT_NODES : 1;
    const size_t room = looks * series->n + 1;
    out->time = malloc(4 * room * sizeof *out->time);
    out->seen = malloc((series->n + 1) * sizeof *out->seen);
    LAC_FAIL_MEMORY_IF(out->time == NULL || out->seen == NULL, err);
    out->displacement = out->time + room;
    out->log_rate = out->displacement + room;
    out->sigma = out->log_rate + room;
    LAC_TRY_RETURN(keep(c, series, out, err));
    size_t readings = out->displacements + out->velocities;
    size_t least = c->fit.count + 3;
    LAC_FAIL_IF(readings < least, err, LAC_EINPUT,
                "%zu readings between time.start and time.end (%zu lie outside) are too few for "
                "%zu parameters: at least %zu",
                readings, out->outside, c->fit.count, least);
    return LAC_OK;
}

static bool begins(const char *key, const char *part)
{
    return strncmp(key, part, strlen(part)) == 0;
}

// Whether a parameter changes only what is cheap to make again.
static void sort_parameters(lac_fit *fit)
{
    for (size_t k = 0; k < fit->def->count; k++) {
        const char *key = fit->def->parameter[k].key;
        bool loads = begins(key, "load.shear") || begins(key, "load.pore_pressure") ||
                     begins(key, "load.normal_stress");
        bool motion = begins(key, "friction.") || begins(key, "initial.");
        fit->moves_loads = fit->moves_loads || loads;
        fit->moves_all = fit->moves_all || (!loads && !motion);
    }
}

// Ranges and starting values of the parameters' coordinates.
static lac_status set_parameters(lac_fit *fit, lac_case *c, lac_error *err)
{
    for (size_t k = 0; k < fit->def->count; k++) {
        const lac_fit_parameter *p = &fit->def->parameter[k];
        lac_case_value value;
        LAC_FAIL_IF(!lac_case_find(c, p->key, &value), err, LAC_EINPUT,
                    "fit.parameters.%s: is not in the case", p->key);
        fit->low[k] = p->log ? log(p->low) : p->low;
        fit->high[k] = p->log ? log(p->high) : p->high;
        fit->best[k] = p->log ? log(*value.at) : *value.at;
    }
    fit->unknowns = fit->def->count;
    return LAC_OK;
}

static int add_unknown(lac_fit *fit, double low, double high)
{
    size_t k = fit->unknowns++;
    fit->low[k] = log(low);
    fit->high[k] = log(high);
    fit->best[k] = 0.5 * (fit->low[k] + fit->high[k]);
    return (int)k;
}

// Errors that are unknown: flat in their logarithm, from far below what the data span to ten times
// that.
static void set_errors(lac_fit *fit)
{
    const lac_fit_data *data = &fit->data;
    double low = INFINITY;
    double high = -INFINITY;
    fit->unknown_displacement = fit->unknown_velocity = fit->unknown_time = -1;
    for (size_t i = 0; i < data->n; i++) {
        low = fmin(low, data->displacement[i]);
        high = fmax(high, data->displacement[i]);
    }
    double span = fit->def->columns.sigma != NULL ? 10.0 : high > low ? high - low : 1e-3;
    if (data->displacements > 0 && isnan(fit->held_error)) {
        fit->unknown_displacement = add_unknown(fit, 1e-5 * span, 10.0 * span);
    }
    if (data->velocities > 0 && isnan(fit->def->velocity_error)) {
        fit->unknown_velocity = add_unknown(fit, 1e-4, 10.0);
    }
    if (data->displacements > 1 && fit->def->errors == LAC_ERRORS_AR1) {
        double length = data->time[data->n - 1] - data->time[0];
        fit->unknown_time = add_unknown(fit, 0.1 * length / (double)data->n, length);
    }
}

static lac_status create_models(lac_fit *fit, int threads, lac_error *err)
{
    lac_status status = LAC_OK;
    fit->threads = threads > 1 ? threads : 1;
    fit->model = calloc((size_t)fit->threads, sizeof *fit->model);
    LAC_FAIL_MEMORY_IF(fit->model == NULL, err);
    for (int i = 0; status == LAC_OK && i < fit->threads; i++) {
        status = lac_fit_model_create(fit, &fit->model[i], err);
    }
    return status;
}

lac_status lac_fit_create(const lac_case *c, const lac_series *series, int threads, lac_fit **out,
                          lac_error *err)
{
    lac_status status = LAC_OK;
    lac_fit *fit = *out = calloc(1, sizeof *fit);
    LAC_FAIL_MEMORY_IF(fit == NULL, err);
    fit->source = c;
    fit->def = &c->fit;
    fit->friction = c->fit.columns.value != NULL;
    fit->offset = c->fit.offset && !fit->friction;
    fit->held_error = fit->friction ? c->fit.friction_error : c->fit.displacement_error;
    fit->text = lac_case_text(c);
    if (fit->text == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    LAC_TRY(read_data(c, series, &fit->data, err));
    sort_parameters(fit);
    LAC_TRY(create_models(fit, threads, err));
    LAC_TRY(set_parameters(fit, fit->model[0].base.c, err));
    set_errors(fit);
out:
    LAC_MADE(status, out, lac_fit_free);
}

void lac_fit_free(lac_fit *fit)
{
    if (fit == NULL) {
        return;
    }
    for (int i = 0; fit->model != NULL && i < fit->threads; i++) {
        if (fit->model[i].fit != NULL) {
            lac_fit_model_clear(&fit->model[i]);
        }
    }
    free(fit->model);
    free(fit->data.time);
    free(fit->data.seen);
    free(fit->data.rate);
    lac_chain_free(fit->chain);
    free(fit->kept);
    free(fit->text);
    free(fit);
}

uint64_t lac_fit_sum(lac_fit *fit)
{
    const lac_fit_data *data = &fit->data;
    lac_fit_def *def = &fit->model[0].base.c->fit;
    const lac_fit_def before = *def;
    def->rounds = 0;
    char *text = lac_case_text(fit->model[0].base.c);
    *def = before;
    if (text == NULL) {
        return 0;
    }
    uint64_t sum = lac_sum_bytes(LAC_SUM_OF_NOTHING, text, strlen(text));
    sum = lac_sum_bytes(sum, data->time, data->n * sizeof *data->time);
    for (size_t i = 0; i < data->rows; i++) {
        sum = lac_sum_bytes(sum, &data->seen[i], sizeof data->seen[i]);
    }
    free(text);
    return sum;
}

// Names and units of the unknowns.
static void name_unknowns(const lac_fit *fit, lac_fit_result *result)
{
    const lac_fit_def *def = fit->def;
    result->parameters = def->count;
    result->unknowns = fit->unknowns;
    for (size_t k = 0; k < fit->unknowns; k++) {
        lac_fit_unknown *x = &result->unknown[k];
        const lac_fit_parameter *p = k < def->count ? &def->parameter[k] : NULL;
        bool displacement = (int)k == fit->unknown_displacement;
        bool time = (int)k == fit->unknown_time;
        x->key = p != NULL      ? p->key
                 : displacement ? (fit->friction ? "error.friction" : "error.displacement")
                 : time         ? "error.time"
                                : "error.velocity";
        x->unit = p != NULL                                                      ? p->unit
                  : displacement && def->columns.sigma == NULL && !fit->friction ? "m"
                  : time                                                         ? "s"
                                                                                 : "1";
        x->log = p == NULL || p->log;
        x->by = LAC_BY_NOTHING;
        x->best = x->error = x->limit = NAN;
        x->end = 0;
        x->converged = (lac_convergence){NAN, NAN, NAN};
        for (size_t q = 0; q < LAC_FIT_QUANTILES; q++) {
            x->quantile[q] = NAN;
        }
    }
}

static void blank(lac_fit_result *result)
{
    *result = (lac_fit_result){0};
    double *numbers[] = {&result->displacement_rms, &result->log_rate_rms, &result->offset,
                         &result->autocorrelation,  &result->failure,      &result->failure_error,
                         &result->log_likelihood,   &result->acceptance,   &result->shape_sigma,
                         &result->failing,          &result->scatter,      &result->bic,
                         &result->misfit,           &result->excess,       &result->evidence,
                         &result->evidence_error};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        *numbers[i] = NAN;
    }
    for (size_t q = 0; q < LAC_FIT_QUANTILES; q++) {
        result->shape.quantile[q] = result->failures.quantile[q] = NAN;
    }
}

lac_status lac_fit_run(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                       lac_error *err)
{
    const lac_fit_data *data = &fit->data;
    lac_status status = LAC_OK;
    blank(result);
    name_unknowns(fit, result);
    result->friction = fit->friction;
    result->displacements = fit->friction ? 0 : data->displacements;
    result->frictions = fit->friction ? data->displacements : 0;
    result->velocities = data->velocities;
    result->bounds = data->bounds;
    result->outside = data->outside;
    result->missing = data->missing;
    result->not_positive = data->not_positive;
    LAC_TRY(lac_fit_least_squares(fit, watch, result, err));
    LAC_TRY(lac_fit_judge(fit, result, err));
    lac_status sampled = fit->def->steps > 0 ? lac_fit_sample(fit, watch, result, err) : LAC_OK;
    bool whole = sampled == LAC_OK || (sampled == LAC_EINTERRUPT && result->sampled);
    lac_error *late = sampled == LAC_OK ? err : NULL; // the draws up to an interrupt are whole
    status = sampled;
    if (whole) {
        LAC_TRY(lac_fit_identify(fit, result, late));
        LAC_TRY(lac_fit_predict(fit, watch, result, late));
        status = sampled;
    }
out:
    result->runs = fit->runs;
    return status;
}

void lac_fit_apply(const lac_fit_result *result, lac_case *c)
{
    for (size_t k = 0; k < result->parameters; k++) {
        lac_case_value value;
        if (lac_case_find(c, result->unknown[k].key, &value)) {
            // ln and exp of an end of the range need not give it back
            *value.at = fmin(fmax(result->unknown[k].best, value.param->min), value.param->max);
        }
    }
}

// The unknown with the largest R-hat, and the parameter most correlated with it; itself if none is.
static void find_worst(const lac_fit_result *r, size_t *worst, size_t *partner)
{
    *worst = 0;
    for (size_t k = 1; k < r->unknowns; k++) {
        *worst = r->unknown[k].converged.rhat > r->unknown[*worst].converged.rhat ? k : *worst;
    }
    *partner = *worst;
    double most = 0.0;
    for (size_t k = 0; *worst < r->parameters && k < r->parameters; k++) {
        double c = fabs(r->correlation[*worst][k]);
        if (k != *worst && c > most) {
            most = c;
            *partner = k;
        }
    }
}

lac_status lac_fit_trust(const lac_fit_result *r, lac_error *err)
{
    size_t worst, partner;
    char with[200] = "";
    if (!r->sampled || r->converged) {
        return LAC_OK;
    }
    find_worst(r, &worst, &partner);
    if (partner != worst) {
        (void)snprintf(with, sizeof with, ", whose correlation with %s is %.3f",
                       r->unknown[partner].key, r->correlation[worst][partner]);
    }
    return lac_fail(
        err, LAC_ENUMERIC,
        "the sampler has not converged: R-hat %.3g (wanted: below %.2f) of %s%s; its intervals are "
        "not to be relied on: take more fit.rounds, or hold what trades off",
        r->unknown[worst].converged.rhat, LAC_FIT_RHAT, r->unknown[worst].key, with);
}
