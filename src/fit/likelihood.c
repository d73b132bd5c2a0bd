// SPDX-License-Identifier: GPL-3.0-or-later
// What the readings say of the unknowns; docs/theory/fitting.md eqs 3 to 5.
#include "base/statistics.h"
#include "fit/internal.h"

static const double log_two_pi = 1.8378770664093454836;

lac_fit_errors_at lac_fit_errors_of(const lac_fit *fit, const double *x)
{
    const lac_fit_def *def = fit->def;
    return (lac_fit_errors_at){
        .displacement =
            fit->unknown_displacement < 0 ? fit->held_error : exp(x[fit->unknown_displacement]),
        .velocity = fit->unknown_velocity < 0 ? def->velocity_error : exp(x[fit->unknown_velocity]),
        .time = fit->unknown_time < 0 ? 0.0 : exp(x[fit->unknown_time]),
    };
}

double lac_fit_prior_residual(const lac_fit_parameter *p, double u)
{
    return p->prior == LAC_PRIOR_NORMAL ? (u - (p->log ? log(p->centre) : p->centre)) / p->sigma
                                        : 0.0;
}

double lac_fit_log_prior(const lac_fit *fit, const double *x)
{
    double sum = 0.0;
    for (size_t k = 0; k < fit->unknowns; k++) {
        if (!(x[k] >= fit->low[k] && x[k] <= fit->high[k])) {
            return -INFINITY;
        }
    }
    for (size_t k = 0; k < fit->def->count; k++) {
        double z = lac_fit_prior_residual(&fit->def->parameter[k], x[k]);
        sum -= 0.5 * z * z;
    }
    return sum;
}

// An Ornstein-Uhlenbeck process seen at uneven times: z_k = rho z_(k-1) + sqrt(1 - rho^2) w_k,
// rho = exp(-(t_k - t_(k-1))/tau), w white.
double lac_fit_whiten(const lac_fit_data *data, const lac_fit_errors_at *errors, const double *r,
                      double *white)
{
    double log_det = 0.0;
    double before = 0.0;
    double last = -INFINITY;
    for (size_t i = 0; i < data->n; i++) {
        if (isnan(data->displacement[i])) {
            white[i] = 0.0;
            continue;
        }
        double s = errors->displacement * data->sigma[i];
        double z = r[i] / s;
        double rho = errors->time > 0.0 ? exp(-(data->time[i] - last) / errors->time) : 0.0;
        double rest = 1.0 - rho * rho;
        white[i] = (z - rho * before) / sqrt(rest);
        log_det += 2.0 * log(s) + log(rest);
        before = z;
        last = data->time[i];
    }
    return log_det;
}

void lac_fit_whiten_one(const lac_fit_data *data, const lac_fit_errors_at *errors, double *one)
{
    for (size_t i = 0; i < data->n; i++) {
        one[i] = 1.0;
    }
    (void)lac_fit_whiten(data, errors, one, one);
}

double lac_fit_take_offset(size_t n, const double *one, double *white, double *offset)
{
    const double ee = lac_dot(n, one, one);
    *offset = ee > 0.0 ? lac_dot(n, one, white) / ee : 0.0;
    lac_take_off(n, *offset, one, white);
    return ee;
}

// Displacements: r^T C^-1 r after the best offset, which is integrated over.
static lac_fit_misfit displacements(const lac_fit *fit, const lac_fit_errors_at *errors,
                                    const double *slip, double *scratch)
{
    const lac_fit_data *data = &fit->data;
    size_t n = data->n;
    double *r = scratch;
    double *w = scratch + n;
    double *e = scratch + 2 * n;
    for (size_t i = 0; i < n; i++) {
        r[i] = data->displacement[i] - slip[i];
    }
    double log_det = lac_fit_whiten(data, errors, r, w);
    lac_fit_misfit out = {.peak = -0.5 * (log_det + (double)data->displacements * log_two_pi)};
    if (fit->offset) {
        lac_fit_whiten_one(data, errors, e);
        const double ee = lac_fit_take_offset(n, e, w, &out.offset);
        out.log_likelihood = 0.5 * (log_two_pi - log(ee));
    }
    for (size_t i = 0; i < n; i++) {
        out.peak -= 0.5 * w[i] * w[i];
    }
    out.log_likelihood += out.peak;
    return out;
}

lac_fit_misfit lac_fit_likelihood(const lac_fit *fit, const lac_fit_errors_at *errors,
                                  const double *slip, const double *log_rate, double *scratch)
{
    const lac_fit_data *data = &fit->data;
    lac_fit_misfit out = {0};
    if (data->displacements > 0) {
        out = displacements(fit, errors, slip, scratch);
    }
    if (data->rates > 0) {
        const double rates = lac_fit_rates_likelihood(data, errors->velocity, log_rate);
        out.log_likelihood += rates;
        out.peak += rates;
    }
    for (size_t i = 0; i < data->n && data->velocities > 0; i++) {
        if (!isnan(data->log_rate[i])) {
            double z = (data->log_rate[i] - log_rate[i]) / errors->velocity;
            double term = 0.5 * (z * z + log_two_pi) + log(errors->velocity);
            out.log_likelihood -= term;
            out.peak -= term;
        }
    }
    return out;
}

double lac_fit_log_posterior(lac_fit *fit, int thread, const double *x)
{
    lac_fit_model *model = &fit->model[thread];
    const lac_fit_data *data = &fit->data;
    double prior = lac_fit_log_prior(fit, x);
    if (!isfinite(prior)) {
        return -INFINITY;
    }
    double *slip = model->scratch;
    double *log_rate = slip + data->n;
    if (lac_fit_model_read(model, x, slip, log_rate, NULL) != LAC_OK) {
        return -INFINITY;
    }
    lac_fit_errors_at errors = lac_fit_errors_of(fit, x);
    lac_fit_misfit misfit = lac_fit_likelihood(fit, &errors, slip, log_rate, slip + 2 * data->n);
    return prior + misfit.log_likelihood;
}

// The errors of the readings for which given residuals are likeliest, by the likelihood that the
// sampler takes (docs/theory/fitting.md eq. 4).

enum { GRID = 33, NARROWINGS = 40 };

// Residuals of displacements and how likely they are.
typedef struct guess {
    const lac_fit *fit;
    const double *r; // before the offset
    double *scratch; // [2 readings]
    double held;     // standard error, or the factor on a column; NaN: the likeliest is taken
    double scale;    // the one taken
} guess;

// ln of the likelihood but for constants, with errors correlated over `time`; sets the scale.
static double likelihood(guess *g, double time)
{
    const lac_fit_data *data = &g->fit->data;
    const lac_fit_errors_at unit = {.displacement = 1.0, .time = time};
    double *w = g->scratch;
    double *e = g->scratch + data->n;
    double ee = 0.0;
    double log_det = lac_fit_whiten(data, &unit, g->r, w);
    if (g->fit->offset) {
        double offset;
        lac_fit_whiten_one(data, &unit, e);
        ee = lac_fit_take_offset(data->n, e, w, &offset);
    }
    const double squares = lac_dot(data->n, w, w);
    double n = (double)data->displacements - (ee > 0.0 ? 1.0 : 0.0);
    g->scale = isnan(g->held) ? sqrt(squares / n) : g->held;
    return -0.5 * squares / (g->scale * g->scale) - n * log(g->scale) - 0.5 * log_det -
           (ee > 0.0 ? 0.5 * log(ee) : 0.0);
}

// The likeliest correlation time: the best of a grid, then golden sections about it.
static double find_time(guess *g, double low, double high)
{
    const double golden = 0.5 * (sqrt(5.0) - 1.0);
    double step = (high - low) / (GRID - 1);
    double best = -INFINITY;
    double at = low;
    for (int i = 0; i < GRID; i++) {
        double found = likelihood(g, exp(low + step * i));
        at = found > best ? low + step * i : at;
        best = fmax(best, found);
    }
    double left = fmax(at - step, low);
    double right = fmin(at + step, high);
    for (int i = 0; i < NARROWINGS; i++) {
        double a = right - golden * (right - left);
        double b = left + golden * (right - left);
        bool lower = likelihood(g, exp(a)) > likelihood(g, exp(b));
        right = lower ? b : right;
        left = lower ? left : a;
    }
    return 0.5 * (left + right);
}

static double within(const lac_fit *fit, int k, double u)
{
    return fmin(fmax(u, fit->low[k]), fit->high[k]);
}

void lac_fit_likeliest_errors(const lac_fit *fit, const double *r, const double *by_log_rate,
                              const double *log_rate, double *scratch, double *x)
{
    const lac_fit_data *data = &fit->data;
    const int of = fit->unknown_displacement;
    guess g = {.fit = fit, .r = r, .scratch = scratch};
    g.held = of < 0 ? fit->held_error : NAN;
    double time = 0.0;
    if (fit->unknown_time >= 0) {
        int k = fit->unknown_time;
        x[k] = find_time(&g, fit->low[k], fit->high[k]);
        time = exp(x[k]);
    }
    if (of >= 0) {
        (void)likelihood(&g, time);
        x[of] = within(fit, of, log(g.scale));
    }
    if (fit->unknown_velocity >= 0 && data->rates > 0) {
        const int k = fit->unknown_velocity;
        x[k] = lac_fit_likeliest_rate_error(data, log_rate, fit->low[k], fit->high[k]);
    } else if (fit->unknown_velocity >= 0) {
        double squares = 0.0;
        for (size_t i = 0; i < data->n; i++) {
            squares += isnan(by_log_rate[i]) ? 0.0 : by_log_rate[i] * by_log_rate[i];
        }
        x[fit->unknown_velocity] =
            within(fit, fit->unknown_velocity, 0.5 * log(squares / (double)data->velocities));
    }
}
