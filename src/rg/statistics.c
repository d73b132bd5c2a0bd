// SPDX-License-Identifier: GPL-3.0-or-later
// Errors by resampling, and the power law of the correlation length near the critical load.
#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include "base/rng.h"
#include "base/statistics.h"
#include "rg/study.h"

enum { ESTIMATES = 3 };

// One resampling: as many groups as there are, drawn with repetition. Returns the pairs drawn.
static size_t resample(const lac_rg_study_def *def, uint64_t draw, size_t groups,
                       const size_t *first, const double *s, const double *s_next, double *out)
{
    size_t n = 0;
    size_t most = 0;
    for (size_t i = 0; i < groups; i++) {
        most = first[i + 1] - first[i] > most ? first[i + 1] - first[i] : most;
    }
    double *next = out + groups * most;
    for (size_t i = 0; i < groups; i++) {
        double u = lac_random_uniform(def->seed, LAC_STREAM_BOOTSTRAP, draw, i);
        size_t g = (size_t)(u * (double)groups);
        g = g < groups ? g : groups - 1;
        for (size_t k = first[g]; k < first[g + 1]; k++, n++) {
            out[n] = s[k];
            next[n] = s_next[k];
        }
    }
    return n;
}

// Error and interval of the resampled values; not where a tenth of them or more have none.
static lac_rg_estimate estimate(double value, size_t draws, double *drawn)
{
    lac_rg_estimate e = {value, NAN, NAN, NAN};
    size_t n = 0;
    for (size_t i = 0; i < draws; i++) {
        if (isfinite(drawn[i])) {
            drawn[n++] = drawn[i];
        }
    }
    if (n >= 20 && 10 * n > 9 * draws && isfinite(value)) {
        gsl_sort(drawn, 1, n);
        e.error = gsl_stats_sd(drawn, 1, n);
        e.low = gsl_stats_quantile_from_sorted_data(drawn, 1, n, 0.025);
        e.high = gsl_stats_quantile_from_sorted_data(drawn, 1, n, 0.975);
    }
    return e;
}

lac_status lac_rg_bootstrap(const lac_rg_study_def *def, size_t groups, const size_t *first,
                            const double *s, const double *s_next, lac_rg_result *result,
                            lac_error *err)
{
    size_t most = 0;
    for (size_t i = 0; i < groups; i++) {
        most = first[i + 1] - first[i] > most ? first[i + 1] - first[i] : most;
    }
    const size_t draws = groups > 1 ? def->resamplings : 0;
    double *pairs = malloc((2 * groups * most + 1) * sizeof *pairs);
    double *drawn = malloc((ESTIMATES * draws + 1) * sizeof *drawn);
    if (pairs == NULL || drawn == NULL) {
        free(pairs);
        free(drawn);
        return lac_fail_memory(err);
    }
    // Too few pairs for a map is a result, not an error.
    lac_rg_map none = {.lambda = NAN, .g = NAN, .fixed_point = NAN, .nu = NAN, .residual = NAN};
    if (lac_rg_map_fit(first[groups], s, s_next, &result->map, NULL) != LAC_OK) {
        none.points = result->map.points;
        result->map = none;
    }
    for (size_t d = 0; d < draws; d++) {
        lac_rg_map map;
        size_t n = resample(def, d, groups, first, s, s_next, pairs);
        bool fits = lac_rg_map_fit(n, pairs, pairs + groups * most, &map, NULL) == LAC_OK;
        drawn[d] = fits ? map.fixed_point : NAN;
        drawn[draws + d] = fits ? map.lambda : NAN;
        drawn[2 * draws + d] = fits ? map.nu : NAN;
    }
    result->fixed_point = estimate(result->map.fixed_point, draws, drawn);
    result->lambda = estimate(result->map.lambda, draws, drawn + draws);
    result->nu = estimate(result->map.nu, draws, drawn + 2 * draws);
    free(pairs);
    free(drawn);
    return LAC_OK;
}

// Whether a point is fitted: x = ln(1 - Q/Q_crit), y = ln xi.
static bool is_fitted(double load, double xi, double critical)
{
    return load < critical && xi > 0.0;
}

// Curvature of the parabola through the points over its standard error: the slope of what the line
// leaves of y on what a line leaves of x^2.
static double curvature(size_t n, const double *load, const double *xi, double critical,
                        const lac_line *line)
{
    const double mean = line->x0 + line->x;
    lac_line square = {0};
    lac_line bend = {0};
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < n; i++) {
            if (is_fitted(load[i], xi[i], critical)) {
                const double x = log(1.0 - load[i] / critical);
                const double by = (x - mean) * (x - mean);
                if (pass == 0) {
                    lac_line_add(&square, x, by);
                } else {
                    lac_line_add(&bend, by - lac_line_at(&square, x),
                                 log(xi[i]) - lac_line_at(line, x));
                }
            }
        }
    }
    return lac_line_slope(&bend) / sqrt(bend.rest / (bend.n - 3.0) / bend.xx);
}

lac_rg_power lac_rg_power_fit(size_t n, const double *load, const double *xi, double critical)
{
    lac_rg_power law = {.exponent = NAN, .error = NAN, .curvature = NAN};
    lac_line line = {0};
    double least = INFINITY;
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (is_fitted(load[i], xi[i], critical)) {
            lac_line_add(&line, log(1.0 - load[i] / critical), log(xi[i]));
            least = fmin(least, xi[i]);
            most = fmax(most, xi[i]);
        }
    }
    law.points = (size_t)line.n;
    if (line.n < 4.0 || !(line.xx > 0.0)) {
        return law;
    }
    law.exponent = -lac_line_slope(&line);
    law.error = lac_line_error(&line);
    law.curvature = curvature(n, load, xi, critical, &line);
    law.holds = most >= 4.0 * least && law.exponent > 2.0 * law.error && fabs(law.curvature) < 2.0;
    return law;
}

// For pairs that do not come from a study, such as those of a run.
lac_status lac_rg_map_resample(size_t groups, const size_t *first, const double *s,
                               const double *s_next, size_t resamplings, lac_rg_fit *fit,
                               lac_error *err)
{
    const lac_rg_study_def def = {.resamplings = resamplings, .seed = 1};
    lac_rg_result result = {0};
    lac_status status = lac_rg_bootstrap(&def, groups, first, s, s_next, &result, err);
    *fit = (lac_rg_fit){.map = result.map,
                        .fixed_point = result.fixed_point,
                        .lambda = result.lambda,
                        .nu = result.nu};
    return status;
}
