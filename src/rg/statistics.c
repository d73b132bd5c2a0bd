// SPDX-License-Identifier: GPL-3.0-or-later
// Errors by resampling, and the power law of the correlation length near the critical load.
#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include "base/rng.h"
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

// Sums of a straight line's and a parabola's least squares in x = ln(1 - Q/Q_crit), y = ln xi.
typedef struct moments {
    double n, x, y, xx, xy, yy, xxx, xxxx, xxy;
} moments;

static moments collect(size_t n, const double *load, const double *xi, double critical)
{
    moments m = {0};
    double mean = 0.0;
    double count = 0.0;
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < n; i++) {
            if (!(load[i] < critical && xi[i] > 0.0)) {
                continue;
            }
            double x = log(1.0 - load[i] / critical) - (pass > 0 ? mean : 0.0);
            double y = log(xi[i]);
            if (pass == 0) {
                mean += x;
                count += 1.0;
                continue;
            }
            m.n += 1.0, m.x += x, m.y += y, m.xx += x * x, m.xy += x * y, m.yy += y * y;
            m.xxx += x * x * x, m.xxxx += x * x * x * x, m.xxy += x * x * y;
        }
        mean = count > 0.0 ? mean / count : 0.0;
    }
    return m;
}

// Curvature of the parabola through the points, over its standard error (x has mean 0).
static double curvature(const moments *m)
{
    double sy = m->yy - m->y * m->y / m->n;
    double sz = m->xxxx - m->xx * m->xx / m->n;
    double szx = m->xxx;
    double szy = m->xxy - m->xx * m->y / m->n;
    double det = sz * m->xx - szx * szx;
    double c = (szy * m->xx - m->xy * szx) / det;
    double b = (m->xy * sz - szx * szy) / det;
    double rest = fmax(0.0, sy - b * m->xy - c * szy) / (m->n - 3.0);
    return c / sqrt(rest * m->xx / det);
}

lac_rg_power lac_rg_power_fit(size_t n, const double *load, const double *xi, double critical)
{
    lac_rg_power law = {.exponent = NAN, .error = NAN, .curvature = NAN};
    const moments m = collect(n, load, xi, critical);
    law.points = (size_t)m.n;
    if (m.n < 4.0 || !(m.xx > 0.0)) {
        return law;
    }
    double slope = m.xy / m.xx;
    double rest = fmax(0.0, m.yy - m.y * m.y / m.n - slope * m.xy);
    law.exponent = -slope;
    law.error = sqrt(rest / (m.n - 2.0) / m.xx);
    law.curvature = curvature(&m);
    double least = INFINITY;
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (load[i] < critical && xi[i] > 0.0) {
            least = fmin(least, xi[i]);
            most = fmax(most, xi[i]);
        }
    }
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
