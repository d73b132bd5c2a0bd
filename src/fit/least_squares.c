// SPDX-License-Identifier: GPL-3.0-or-later
// The best fit: places drawn from the prior, then GSL's trust region (Levenberg-Marquardt) from the
// best three. A range that is bounded is searched on the whole line: u = low + width/(1 + exp(-z)).
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>

#include "base/rng.h"
#include "fit/internal.h"

enum { BEST_STARTS = 3, MOST_ITERATIONS = 100, MOST_ROUNDS = 8 };

// A residual where the run fails early: whatever comes back is better.
static const double nowhere = 1e8;

// What GSL's functions need.
typedef struct search {
    lac_fit *fit;
    lac_fit_errors_at errors;
    lac_sensitivity seen;
    double *room;                 // what seen points into
    double *r, *by, *white, *one; // white and one lie side by side
    double *rate;                 // [readings] ln v of the last run
    size_t rows;
    const lac_fit_watch *watch;
    const char *stage; // what is being done, and how much of it is
    size_t done, total;
} search;

static double from_line(const lac_fit *fit, size_t k, double z)
{
    double width = fit->high[k] - fit->low[k];
    return lac_fit_bounded(fit, k) ? fit->low[k] + width / (1.0 + exp(-z)) : z;
}

static double to_line(const lac_fit *fit, size_t k, double u)
{
    double width = fit->high[k] - fit->low[k];
    if (!lac_fit_bounded(fit, k)) {
        return u;
    }
    double share = fmin(fmax((u - fit->low[k]) / width, 1e-6), 1.0 - 1e-6);
    return log(share / (1.0 - share));
}

// du/dz
static double slope_of(const lac_fit *fit, size_t k, double u)
{
    double width = fit->high[k] - fit->low[k];
    return lac_fit_bounded(fit, k) ? (u - fit->low[k]) * (fit->high[k] - u) / width : 1.0;
}

static void read_line(const lac_fit *fit, const gsl_vector *z, double *u)
{
    for (size_t k = 0; k < fit->def->count; k++) {
        u[k] = from_line(fit, k, gsl_vector_get(z, k));
    }
}

// Residuals of displacements, whitened, with the best offset taken out; or a column of their
// derivatives, treated alike.
static void project(const search *s, const double *r, double *white)
{
    const lac_fit_data *data = &s->fit->data;
    double offset;
    (void)lac_fit_whiten(data, &s->errors, r, white);
    if (s->fit->offset) {
        (void)lac_fit_take_offset(data->n, s->one, white, &offset);
    }
}

// The rates of rates.c, or where `by` is given their derivatives by what that is of ln v.
static void put_rates(const search *s, const double *by, size_t *row, gsl_vector *out)
{
    const lac_fit_data *data = &s->fit->data;
    const double error = s->errors.velocity;
    for (size_t k = 0; k < data->rates; k++) {
        const lac_fit_rate *rate = &data->rate[k];
        const double value = by == NULL ? lac_fit_rate_residual(data, rate, error, s->rate)
                                        : lac_fit_rate_slope(data, rate, error, s->rate, by, 1);
        gsl_vector_set(out, (*row)++, value);
    }
}

// One column over all rows: displacements, velocities, priors.
// @param by  of ln v, where it is a column of derivatives; else NULL
static void put_column(const search *s, const double *displacement, const double *log_rate,
                       const double *by, const double *prior, gsl_vector *out)
{
    const lac_fit *fit = s->fit;
    const lac_fit_data *data = &fit->data;
    size_t row = 0;
    project(s, displacement, s->white);
    for (size_t i = 0; i < data->n; i++) {
        if (!isnan(data->displacement[i])) {
            gsl_vector_set(out, row++, s->white[i]);
        }
    }
    for (size_t i = 0; i < data->n; i++) {
        if (!isnan(data->log_rate[i])) {
            gsl_vector_set(out, row++, log_rate[i] / s->errors.velocity);
        }
    }
    put_rates(s, by, &row, out);
    for (size_t k = 0; k < fit->def->count; k++) {
        if (fit->def->parameter[k].prior == LAC_PRIOR_NORMAL) {
            gsl_vector_set(out, row++, prior[k]);
        }
    }
}

static int residuals(const gsl_vector *z, void *context, gsl_vector *f)
{
    search *s = context;
    lac_fit *fit = s->fit;
    const lac_fit_data *data = &fit->data;
    double u[LAC_MOST_FITTED];
    double prior[LAC_MOST_FITTED];
    if (lac_fit_interrupted(s->watch)) {
        return GSL_EFAILED;
    }
    lac_fit_tell(s->watch, s->stage, s->done, s->total);
    read_line(fit, z, u);
    double *slip = s->seen.slip, *log_rate = s->seen.log_rate;
    fit->runs++;
    if (lac_fit_model_read(&fit->model[0], u, slip, log_rate, NULL) != LAC_OK) {
        gsl_vector_set_all(f, nowhere);
        return GSL_SUCCESS;
    }
    for (size_t i = 0; i < data->n; i++) {
        s->r[i] = slip[i] - data->displacement[i];
        s->rate[i] = log_rate[i];
        log_rate[i] -= data->log_rate[i];
    }
    for (size_t k = 0; k < fit->def->count; k++) {
        prior[k] = lac_fit_prior_residual(&fit->def->parameter[k], u[k]);
    }
    put_column(s, s->r, log_rate, NULL, prior, f);
    return GSL_SUCCESS;
}

// Derivatives by the coordinate k of all rows.
static void derivative(search *s, size_t k, gsl_vector *out)
{
    const lac_fit *fit = s->fit;
    size_t n = fit->data.n;
    size_t count = fit->def->count;
    double prior[LAC_MOST_FITTED] = {0};
    prior[k] =
        fit->def->parameter[k].prior == LAC_PRIOR_NORMAL ? 1.0 / fit->def->parameter[k].sigma : 0.0;
    for (size_t i = 0; i < n; i++) {
        s->r[i] = s->seen.slip_by[i * count + k];
        s->by[i] = s->seen.log_rate_by[i * count + k];
    }
    put_column(s, s->r, s->by, s->by, prior, out);
}

static int jacobian(const gsl_vector *z, void *context, gsl_matrix *out)
{
    search *s = context;
    lac_fit *fit = s->fit;
    double u[LAC_MOST_FITTED] = {0};
    lac_fit_tell(s->watch, s->stage, s->done, s->total);
    read_line(fit, z, u);
    fit->runs++;
    if (lac_fit_model_differentiate(&fit->model[0], u, &s->seen, fit->by, NULL) != LAC_OK) {
        return GSL_EFAILED;
    }
    memcpy(s->rate, s->seen.log_rate, fit->data.n * sizeof *s->rate);
    for (size_t k = 0; k < fit->def->count; k++) {
        gsl_vector_view column = gsl_matrix_column(out, k);
        derivative(s, k, &column.vector);
        gsl_vector_scale(&column.vector, slope_of(fit, k, u[k]));
    }
    return GSL_SUCCESS;
}

static lac_status search_create(lac_fit *fit, const lac_fit_watch *watch, search *s, lac_error *err)
{
    size_t n = fit->data.n;
    size_t count = fit->def->count;
    *s = (search){.fit = fit, .watch = watch};
    s->room = calloc((7 + 2 * count) * n, sizeof *s->room);
    LAC_FAIL_MEMORY_IF(s->room == NULL, err);
    double *at = s->room;
    double **parts[] = {&s->seen.slip, &s->seen.log_rate, &s->r,   &s->by,
                        &s->white,     &s->one,           &s->rate};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++, at += n) {
        *parts[i] = at;
    }
    s->seen.slip_by = at;
    s->seen.log_rate_by = at + count * n;
    s->rows = fit->data.displacements + fit->data.velocities;
    for (size_t k = 0; k < count; k++) {
        s->rows += fit->def->parameter[k].prior == LAC_PRIOR_NORMAL ? 1 : 0;
    }
    return LAC_OK;
}

// Unknown errors as the residuals of a run have them.
static void estimate_errors(search *s, const double *slip, const double *log_rate, double *x)
{
    const lac_fit_data *data = &s->fit->data;
    for (size_t i = 0; i < data->n; i++) {
        s->r[i] = data->displacement[i] - slip[i];
        s->by[i] = data->log_rate[i] - log_rate[i];
    }
    lac_fit_likeliest_errors(s->fit, s->r, s->by, log_rate, s->white, x);
    s->errors = lac_fit_errors_of(s->fit, x);
    lac_fit_whiten_one(data, &s->errors, s->one);
}

void lac_fit_draw_prior(const lac_fit *fit, uint64_t which, double *x)
{
    const uint64_t apart = UINT64_C(1) << 62; // from the numbers of the sampler
    for (size_t k = 0; k < fit->unknowns; k++) {
        uint64_t seed = (uint64_t)fit->def->seed;
        double share = lac_random_uniform(seed, LAC_STREAM_SAMPLER, apart + which, k);
        double normal[2];
        lac_random_normal(seed, LAC_STREAM_SAMPLER, apart + which, k, normal);
        const lac_fit_parameter *p = k < fit->def->count ? &fit->def->parameter[k] : NULL;
        if (p != NULL && p->prior == LAC_PRIOR_NORMAL) {
            double u = (p->log ? log(p->centre) : p->centre) + p->sigma * normal[0];
            x[k] = fmin(fmax(u, fit->low[k]), fit->high[k]);
        } else {
            x[k] = fit->low[k] + share * (fit->high[k] - fit->low[k]);
        }
    }
}

// Sets the unknown errors to what suits coordinates x and gives the posterior there.
static double rate_start(search *s, double *x)
{
    lac_fit *fit = s->fit;
    const lac_fit_data *data = &fit->data;
    double *slip = s->seen.slip, *log_rate = s->seen.log_rate;
    lac_fit_tell(s->watch, s->stage, s->done, s->total);
    fit->runs++;
    if (lac_fit_model_read(&fit->model[0], x, slip, log_rate, NULL) != LAC_OK) {
        return -INFINITY;
    }
    estimate_errors(s, slip, log_rate, x);
    lac_fit_misfit misfit =
        lac_fit_likelihood(fit, &s->errors, slip, log_rate, fit->model[0].scratch + 2 * data->n);
    double all = misfit.log_likelihood + lac_fit_log_prior(fit, x);
    return isnan(all) ? -INFINITY : all;
}

// One run of the trust region with the errors held. @return false where it was interrupted
static bool descend(search *s, double *x)
{
    lac_fit *fit = s->fit;
    size_t count = fit->def->count;
    gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
    how.solver = gsl_multifit_nlinear_solver_svd;
    gsl_multifit_nlinear_fdf fdf = {
        .f = residuals, .df = jacobian, .n = s->rows, .p = count, .params = s};
    gsl_multifit_nlinear_workspace *w =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, s->rows, count);
    double place[LAC_MOST_FITTED];
    int info = 0;
    if (w != NULL) {
        for (size_t k = 0; k < count; k++) {
            place[k] = to_line(fit, k, x[k]);
        }
        gsl_vector_const_view z = gsl_vector_const_view_array(place, count);
        if (gsl_multifit_nlinear_init(&z.vector, &fdf, w) == GSL_SUCCESS) {
            (void)gsl_multifit_nlinear_driver(MOST_ITERATIONS, 1e-8, 1e-10, 0.0, NULL, NULL, &info,
                                              w);
            read_line(fit, gsl_multifit_nlinear_position(w), x);
        }
        gsl_multifit_nlinear_free(w);
    }
    return !lac_fit_interrupted(s->watch);
}

// Errors and parameters in turn: what the errors are changes the weight of displacements against
// velocities and priors.
static double refine(search *s, double *x)
{
    double best = rate_start(s, x);
    for (int round = 0; round < MOST_ROUNDS; round++) {
        double tried[LAC_FIT_UNKNOWNS];
        memcpy(tried, x, sizeof tried);
        if (!descend(s, tried)) {
            break;
        }
        double found = rate_start(s, tried);
        if (!(found > best)) {
            break;
        }
        bool settled = found - best < 1e-6;
        best = found;
        memcpy(x, tried, sizeof tried);
        if (settled) {
            break;
        }
    }
    return best;
}

// The best three of the starts, best first. @return how many have a likelihood
static size_t find_starts(search *s, double start[BEST_STARTS][LAC_FIT_UNKNOWNS], size_t *alive)
{
    lac_fit *fit = s->fit;
    double value[BEST_STARTS];
    size_t kept = 0;
    *alive = 0;
    s->stage = "starts tried";
    s->total = (size_t)fit->def->starts;
    for (int64_t i = 0; i < fit->def->starts && !lac_fit_interrupted(s->watch); i++, s->done++) {
        double x[LAC_FIT_UNKNOWNS];
        memcpy(x, fit->best, sizeof x);
        if (i > 0) {
            lac_fit_draw_prior(fit, (uint64_t)i, x);
        }
        double found = rate_start(s, x);
        if (!isfinite(found)) {
            continue;
        }
        ++*alive;
        size_t at = kept < BEST_STARTS ? kept++ : BEST_STARTS;
        while (at > 0 && value[at - 1] < found) {
            at--;
            if (at + 1 < BEST_STARTS) {
                value[at + 1] = value[at];
                memcpy(start[at + 1], start[at], sizeof x);
            }
        }
        if (at < BEST_STARTS) {
            value[at] = found;
            memcpy(start[at], x, sizeof x);
        }
    }
    return kept;
}

// (J^T J)^-1 = V S^-2 V^T; a direction that no reading tells of counts as known to 1e8 only.
static void invert(const gsl_matrix *v, const gsl_vector *sigma,
                   double covariance[LAC_MOST_FITTED][LAC_MOST_FITTED])
{
    size_t count = sigma->size;
    for (size_t k = 0; k < count; k++) {
        for (size_t l = 0; l < count; l++) {
            covariance[k][l] = 0.0;
            for (size_t i = 0; i < count; i++) {
                double s = fmax(gsl_vector_get(sigma, i), 1e-8);
                covariance[k][l] += gsl_matrix_get(v, k, i) * gsl_matrix_get(v, l, i) / (s * s);
            }
        }
    }
}

static lac_status find_covariance(search *s, lac_error *err)
{
    lac_fit *fit = s->fit;
    size_t count = fit->def->count;
    double room[LAC_MOST_FITTED * (LAC_MOST_FITTED + 2)];
    gsl_matrix_view v = gsl_matrix_view_array(room, count, count);
    gsl_vector_view sigma = gsl_vector_view_array(room + count * count, count);
    gsl_vector_view work = gsl_vector_view_array(room + count * (count + 1), count);
    LAC_TRY_RETURN(lac_fit_model_differentiate(&fit->model[0], fit->best, &s->seen, fit->by, err));
    gsl_matrix *j = gsl_matrix_alloc(s->rows, count);
    LAC_FAIL_MEMORY_IF(j == NULL, err);
    memcpy(s->rate, s->seen.log_rate, fit->data.n * sizeof *s->rate);
    for (size_t k = 0; k < count; k++) {
        gsl_vector_view column = gsl_matrix_column(j, k);
        derivative(s, k, &column.vector);
    }
    const int failed = gsl_linalg_SV_decomp(j, &v.matrix, &sigma.vector, &work.vector);
    gsl_matrix_free(j);
    LAC_FAIL_IF(failed != GSL_SUCCESS, err, LAC_ENUMERIC,
                "the least squares have no normal equations");
    invert(&v.matrix, &sigma.vector, fit->covariance);
    return LAC_OK;
}

lac_status lac_fit_least_squares(lac_fit *fit, const lac_fit_watch *watch, lac_fit_result *result,
                                 lac_error *err)
{
    search s;
    double start[BEST_STARTS][LAC_FIT_UNKNOWNS];
    double best = -INFINITY;
    lac_status status = LAC_OK;
    LAC_TRY_RETURN(search_create(fit, watch, &s, err));
    size_t kept = find_starts(&s, start, &result->alive);
    result->tried = (size_t)fit->def->starts;
    fit->model[0].rtol = LAC_FIT_TIGHT;
    s.stage = "least-squares descents";
    s.total = kept;
    s.done = 0;
    for (size_t i = 0; i < kept && !lac_fit_interrupted(watch); i++, s.done++) {
        double found = refine(&s, start[i]);
        if (found > best) {
            best = found;
            memcpy(fit->best, start[i], sizeof start[i]);
        }
    }
    if (lac_fit_interrupted(watch)) {
        status = lac_fail(err, LAC_EINTERRUPT, "interrupted in the least squares");
    } else if (kept == 0) {
        // A file that a load reads and that is wrong is so for all starts.
        const lac_status own =
            lac_fit_model_read(&fit->model[0], fit->best, s.seen.slip, s.seen.log_rate, err);
        status = own == LAC_EINPUT || own == LAC_EIO
                     ? own
                     : lac_fail(err, LAC_ENUMERIC,
                                "none of %zu starts can be followed to the last reading: every run "
                                "fails before it, or "
                                "cannot be computed; look at the ranges and the case's own values",
                                result->tried);
    } else {
        (void)rate_start(&s, fit->best);
        status = find_covariance(&s, err);
    }
    fit->model[0].rtol = LAC_FIT_LOOSE;
    free(s.room);
    return status;
}
