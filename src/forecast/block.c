// SPDX-License-Identifier: GPL-3.0-or-later
// One block of rate-and-state friction (aging law) under constant load, m = b/a > 1, on its way
// from steady creep to failure. With y = x^(m-1), x = theta/theta_ss, s = ln((1 - y)/y), T =
// t/theta_ss:
//     displacement  d = A + dc/(m-1) s                                      (O1)
//     velocity      v = dc/theta_ss (1 + e^s)^alpha,  alpha = m/(m-1)       (O2)
//     time left     (tc - t)/theta_ss = 1/(m-1) int_s^inf (1 + e^u)^-alpha du   (O3)
// Every such run follows one curve, whatever state it starts from: m, theta_ss and tc shape it.
#include "base/vmath.h"
#include "forecast/kinds.h"

enum { POINTS = 400, STRENGTHS = 6, GRID = 24, STATES = 10 };
static const double first_s = -12.0, last_s = 12.0;
static const double strengths[STRENGTHS] = {1.1, 1.2, 1.35, 1.6, 2.0, 3.0}; // b/a
static const double width_of_state = 3.0; // prior of ln(theta_ss/window)
static const double negligible = 9.0;     // ln of a likelihood ratio

// s as a function of ln of the time left, at even steps of s.
typedef struct table {
    double m, alpha;
    double log_left[POINTS]; // falls
    double slope[POINTS];    // ds/d ln(left)
} table;

static double rate(const table *b, double s)
{
    return exp(-b->alpha * (s > 30.0 ? s : log1p(exp(s)))) / (b->m - 1.0);
}

static double step_of(void) { return (last_s - first_s) / (POINTS - 1); }

// From the far end, where the integral is exp(-alpha s)/m, by Simpson's rule of halved steps.
static void fill(table *b, double m)
{
    const double h = step_of();
    b->m = m;
    b->alpha = m / (m - 1.0);
    double left = 0.0;
    for (size_t i = POINTS; i-- > 0;) {
        const double s = first_s + h * (double)i;
        if (i == POINTS - 1) {
            left = exp(-b->alpha * s) / m;
        } else {
            left += h / 12.0 *
                    (rate(b, s) + 4.0 * rate(b, s + 0.25 * h) + 2.0 * rate(b, s + 0.5 * h) +
                     4.0 * rate(b, s + 0.75 * h) + rate(b, s + h));
        }
        b->log_left[i] = log(left);
        b->slope[i] = -left / rate(b, s);
    }
}

// Closed forms beyond the table's ends: a power of the time left, and steady creep. `at` is where
// the last one was found, as readings follow one another: the search goes on from there.
static double look_up(const table *b, double log_left, size_t *at)
{
    if (log_left <= b->log_left[POINTS - 1]) {
        return -(log_left + log(b->m)) / b->alpha;
    }
    if (log_left >= b->log_left[0]) {
        return first_s - (b->m - 1.0) * (exp(log_left) - exp(b->log_left[0]));
    }
    size_t low = *at;
    while (b->log_left[low] < log_left) {
        low--;
    }
    while (b->log_left[low + 1] >= log_left) {
        low++;
    }
    const size_t high = low + 1;
    *at = low;
    const double length = b->log_left[high] - b->log_left[low];
    const double u = (log_left - b->log_left[low]) / length;
    const double h = step_of();
    const double before = length * b->slope[low] - h;
    const double after = h - length * b->slope[high];
    return first_s + h * (double)low + u * h + u * (1.0 - u) * ((1.0 - u) * before + u * after);
}

// p[1] is ln theta_ss
static void curve(const lac_projection *self, const double *p, double *columns)
{
    const lac_window *w = self->window;
    const table *b = self->context;
    const double remaining = exp(p[0]);
    double *state = columns + w->n;
    size_t at = 0;
    for (size_t i = 0; i < w->n; i++) {
        columns[i] = 1.0;
        state[i] = remaining - w->time[i];
    }
    lac_vlog(w->n, state, state);
    for (size_t i = 0; i < w->n; i++) {
        state[i] = look_up(b, state[i] - p[1], &at) / (b->m - 1.0);
    }
}

static double place(const lac_projection *self, size_t shape, double part)
{
    (void)shape;
    return log(-self->window->time[0]) + 8.0 * part - 4.0;
}

// A block of one strength, fitted.
typedef struct block {
    table law;
    lac_projection curve;
    double centre[2], width[2]; // prior of ln remaining and ln theta_ss
    double p[LAC_SHAPES_MAX];
    lac_forecast_fit fit;
} block;

static void describe(block *b)
{
    const lac_projection *law = &b->curve;
    size_t at = 0;
    const double s = look_up(&b->law, b->p[0] - b->p[1], &at);
    lac_forecast_fit_add_within(&b->fit, "m", b->law.m, strengths[0], strengths[STRENGTHS - 1]);
    lac_forecast_fit_add(&b->fit, "dc_m", law->c[1]);
    lac_forecast_fit_add(&b->fit, "theta_ss_s", exp(b->p[1]));
    lac_forecast_fit_add(&b->fit, "combination_1_m", b->law.m / law->c[1] / (1.0 + exp(-s)));
    if (!(law->c[1] > 0.0)) {
        (void)lac_forecast_fit_refuse(&b->fit, "the slope does not accelerate");
    }
}

static lac_status fit_strength(const lac_window *w, double m, block *b, lac_error *err)
{
    fill(&b->law, m);
    b->fit = (lac_forecast_fit){
        .remaining = NAN, .error = NAN, .rms = INFINITY, .misfit = NAN, .excess = NAN};
    b->centre[1] = log(-w->time[0]);
    b->width[0] = INFINITY;
    b->width[1] = width_of_state;
    b->curve = (lac_projection){.window = w,
                                .columns = 2,
                                .shapes = 2,
                                .curve = curve,
                                .place = place,
                                .grid = {GRID, STATES},
                                .context = &b->law,
                                .centre = b->centre,
                                .width = b->width};
    lac_status status = lac_projection_fit(&b->curve, b->p, &b->fit, err);
    if (status == LAC_OK && isfinite(b->fit.rms)) {
        describe(b);
    }
    return status;
}

// The posterior of all strengths, each as likely before the readings, but those that fit far worse.
static void draw(const lac_window *w, block *b, const block *best, lac_draw *draws,
                 lac_forecast_fit *fit)
{
    const double n = (double)w->n;
    const double effective = best->curve.effective;
    size_t count = 0;
    for (size_t k = 0; k < STRENGTHS; k++) {
        const double worse = b[k].fit.rms / best->fit.rms;
        if (isfinite(b[k].fit.rms) && (&b[k] == best || effective * log(worse) < negligible)) {
            lac_posterior_draw(&b[k].curve, b[k].p, effective, n * best->fit.rms * best->fit.rms,
                               draws + count);
            count += LAC_POSTERIOR_DRAWS;
        }
    }
    lac_posterior_finish(count, draws, fit);
}

static lac_status fit_block(const lac_window *w, lac_forecast_fit *fit, lac_error *err)
{
    block *b = calloc(STRENGTHS, sizeof *b);
    lac_draw *draws = malloc((size_t)STRENGTHS * LAC_POSTERIOR_DRAWS * sizeof *draws);
    size_t best = 0;
    lac_status status = b != NULL && draws != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    for (size_t k = 0; k < STRENGTHS; k++) {
        LAC_TRY(fit_strength(w, strengths[k], &b[k], err));
        best = b[k].fit.rms < b[best].fit.rms ? k : best;
    }
    *fit = b[best].fit;
    if (isfinite(fit->rms)) {
        draw(w, b, &b[best], draws, fit);
    }
out:
    for (size_t k = 0; b != NULL && k < STRENGTHS; k++) {
        lac_projection_clear(&b[k].curve);
    }
    free(b);
    free(draws);
    return status;
}

const lac_forecast_kind lac_forecast_block = {
    .info = LAC_ABOUT(
        "block", "one block of rate-and-state friction",
        "Helmstetter et al. (2004), J. Geophys. Res. 109, B02409, doi 10.1029/2002JB002160"),
    .estimator = "the exact displacement of an aging-law block with b/a in {1.1, 1.2, 1.35, 1.6, "
                 "2, 3}: tc and theta_ss by nonlinear least squares over all displacements of the "
                 "window, ln theta_ss with a normal prior of width 3 about ln of the window; "
                 "intervals by the posterior of tc over all of these",
    .least = 8,
    .displacements = true,
    .worst = 0.04,
    .calibration = {0.4, 1.6, -1.452, -0.801, -0.422, 0.077, 0.797},
    .fit = fit_block,
};
