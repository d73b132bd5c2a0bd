// SPDX-License-Identifier: GPL-3.0-or-later
// One block of rate-and-state friction (aging law) under constant load, m = b/a > 1, on its way
// from steady creep to failure. With y = x^(m-1), x = theta/theta_ss, s = ln((1 - y)/y), T =
// t/theta_ss:
//     displacement  d = A + dc/(m-1) s                                      (O1)
//     velocity      v = dc/theta_ss (1 + e^s)^alpha,  alpha = m/(m-1)       (O2)
//     time left     (tc - t)/theta_ss = 1/(m-1) int_s^inf (1 + e^u)^-alpha du   (O3)
// Every such run follows one curve, whatever state it starts from: m, theta_ss and tc shape it.
#include <math.h>
#include <stdlib.h>

#include "forecast/project.h"

enum { POINTS = 400, STRENGTHS = 6, GRID = 24, STATES = 10 };
static const double first_s = -12.0, last_s = 12.0;
static const double width_of_state = 3.0; // prior of ln(theta_ss/window)

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

// Closed forms beyond the table's ends: a power of the time left, and steady creep.
static double look_up(const table *b, double log_left)
{
    if (log_left <= b->log_left[POINTS - 1]) {
        return -(log_left + log(b->m)) / b->alpha;
    }
    if (log_left >= b->log_left[0]) {
        return first_s - (b->m - 1.0) * (exp(log_left) - exp(b->log_left[0]));
    }
    size_t low = 0;
    size_t high = POINTS - 1;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (b->log_left[middle] >= log_left) {
            low = middle;
        } else {
            high = middle;
        }
    }
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
    for (size_t i = 0; i < w->n; i++) {
        columns[i] = 1.0;
        columns[w->n + i] = look_up(b, log(exp(p[0]) - w->time[i]) - p[1]) / (b->m - 1.0);
    }
}

static void offer_grid(lac_projection *law, lac_starts *starts)
{
    double p[LAC_SHAPES_MAX];
    for (size_t i = 0; i < GRID; i++) {
        for (size_t j = 0; j < STATES; j++) {
            p[0] = lac_projection_start(law->window, i, GRID);
            p[1] = log(-law->window->time[0]) + 8.0 * ((double)j + 0.5) / STATES - 4.0;
            lac_starts_offer(starts, 2, p, lac_projection_at(law, p));
        }
    }
}

static void describe(const lac_projection *law, const double *p, lac_finding *fit)
{
    const table *b = law->context;
    const double s = look_up(b, p[0] - p[1]);
    lac_finding_add(fit, "m", b->m);
    lac_finding_add(fit, "dc_m", law->c[1]);
    lac_finding_add(fit, "theta_ss_s", exp(p[1]));
    lac_finding_add(fit, "combination_1_m", b->m / law->c[1] / (1.0 + exp(-s)));
    if (!(law->c[1] > 0.0)) {
        (void)lac_finding_refuse(fit, "the slope does not accelerate");
    }
}

static lac_status fit_strength(const lac_window *w, const table *b, lac_finding *fit,
                               lac_error *err)
{
    const double centre[2] = {0.0, log(-w->time[0])};
    const double width[2] = {INFINITY, width_of_state};
    lac_projection law = {.window = w,
                          .columns = 2,
                          .shapes = 2,
                          .curve = curve,
                          .context = b,
                          .centre = centre,
                          .width = width};
    lac_starts starts = {0};
    double p[LAC_SHAPES_MAX];
    lac_status status;
    LAC_TRY(lac_projection_create(&law, err));
    offer_grid(&law, &starts);
    law.scale = sqrt(starts.sum[0] / fmax(1.0, (double)w->n - 4.0));
    law.scale = w->noise > 0.0 ? fmin(law.scale, w->noise) : law.scale; // the grid is coarse
    LAC_TRY(lac_projection_refine(&law, &starts, p, fit, err));
    describe(&law, p, fit);
out:
    lac_projection_clear(&law);
    return status;
}

// The error holds what the strengths that fit about as well say apart.
static void combine(size_t n, const lac_finding *each, lac_finding *fit)
{
    size_t best = 0;
    double weights = 0.0;
    double variance = 0.0;
    for (size_t k = 1; k < n; k++) {
        best = each[k].rms < each[best].rms ? k : best;
    }
    *fit = each[best];
    const double free = fmax(1.0, (double)fit->points - 4.0);
    for (size_t k = 0; k < n; k++) {
        const double ratio = each[k].rms / fit->rms;
        const double weight = fit->rms > 0.0 ? exp(-0.5 * free * (ratio * ratio - 1.0)) : k == best;
        const double off = log(each[k].remaining / fit->remaining);
        if (weight > 0.0 && isfinite(off) && isfinite(each[k].error)) {
            weights += weight;
            variance += weight * (each[k].error * each[k].error + off * off);
        }
    }
    fit->error = weights > 0.0 ? sqrt(variance / weights) : fit->error;
}

static lac_status fit_block(const lac_window *w, lac_finding *fit, lac_error *err)
{
    static const double strengths[STRENGTHS] = {1.1, 1.2, 1.35, 1.6, 2.0, 3.0};
    lac_finding each[STRENGTHS] = {{0}};
    table *b = malloc(sizeof *b);
    lac_status status = b != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    for (size_t k = 0; k < STRENGTHS; k++) {
        fill(b, strengths[k]);
        each[k].rms = INFINITY;
        each[k].remaining = NAN;
        LAC_TRY(fit_strength(w, b, &each[k], err));
    }
    combine(STRENGTHS, each, fit);
out:
    free(b);
    return status;
}

const lac_forecast_kind lac_forecast_block = {
    .about = {.name = "block",
              .summary = "one block of rate-and-state friction",
              .reference = "Helmstetter et al. (2004), J. Geophys. Res. 109, B02409, doi "
                           "10.1029/2002JB002160"},
    .estimator =
        "the exact displacement of an aging-law block with b/a in {1.1, 1.2, 1.35, 1.6, 2, "
        "3}: tc and theta_ss by nonlinear least squares over all displacements of the "
        "window, ln theta_ss with a normal prior of width 3 about ln of the window",
    .least = 8,
    .displacements = true,
    .worst = 0.04,
    .calibration = {0.15, -0.824, -0.193, 0.513, 1.174},
    .fit = fit_block,
};
