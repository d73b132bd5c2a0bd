// SPDX-License-Identifier: GPL-3.0-or-later
// The slipped fraction of a level from that of the finer one: the map fitted, its fixed point and
// errors by resampling; and the power law of the correlation length near the critical load.
#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include "base/rng.h"
#include "base/statistics.h"
#include "rg/tree.h"

enum { ESTIMATES = 3 };
static const double lowest = 0.05; // below, and above 1 - lowest, counts are too few to tell
static const double ln2 = 0.69314718055994530941723212145818;

static double logit(double s) { return log(s / (1.0 - s)); }

static bool in_range(double s) { return s > lowest && s < 1.0 - lowest; }

lac_status lac_rg_map_fit(size_t n, const double *s, const double *s_next, lac_rg_map *map,
                          lac_error *err)
{
    lac_line line = {0};
    for (size_t i = 0; i < n; i++) {
        if (in_range(s[i]) && in_range(s_next[i])) {
            lac_line_add(&line, logit(s[i]), logit(s_next[i]));
        }
    }
    *map = (lac_rg_map){.points = (size_t)line.n, .fixed_point = NAN, .nu = NAN};
    LAC_FAIL_IF(map->points < 3 || !(line.xx > 1e-12 * line.n), err, LAC_EINPUT,
                "a map needs three pairs of slipped fractions between %g and %g, not %zu", lowest,
                1.0 - lowest, map->points);
    map->lambda = lac_line_slope(&line);
    map->g = lac_line_at(&line, 0.0);
    map->residual = sqrt(line.rest / line.n);
    if (map->lambda > 1.0) {
        map->fixed_point = 1.0 / (1.0 + exp(map->g / (map->lambda - 1.0)));
        map->nu = ln2 / log(map->lambda);
    }
    return LAC_OK;
}

// One resampling: as many groups as there are, drawn with repetition. Returns the pairs drawn.
static size_t resample(uint64_t seed, uint64_t draw, size_t groups, const size_t *first,
                       const double *s, const double *s_next, double *out, double *next)
{
    size_t n = 0;
    for (size_t i = 0; i < groups; i++) {
        double u = lac_random_uniform(seed, LAC_STREAM_BOOTSTRAP, draw, i);
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

lac_status lac_rg_map_resample(size_t groups, const size_t *first, const double *s,
                               const double *s_next, size_t resamplings, uint64_t seed,
                               lac_rg_fit *fit, lac_error *err)
{
    size_t most = 0;
    for (size_t i = 0; i < groups; i++) {
        most = first[i + 1] - first[i] > most ? first[i + 1] - first[i] : most;
    }
    const size_t draws = groups > 1 ? resamplings : 0;
    double *pairs = malloc((2 * groups * most + 1) * sizeof *pairs);
    double *drawn = malloc((ESTIMATES * draws + 1) * sizeof *drawn);
    if (pairs == NULL || drawn == NULL) {
        free(pairs);
        free(drawn);
        return lac_fail_memory(err);
    }
    // Too few pairs for a map is a result, not an error.
    if (lac_rg_map_fit(first[groups], s, s_next, &fit->map, NULL) != LAC_OK) {
        fit->map.lambda = fit->map.g = fit->map.residual = NAN;
    }
    for (size_t d = 0; d < draws; d++) {
        lac_rg_map map;
        size_t n = resample(seed, d, groups, first, s, s_next, pairs, pairs + groups * most);
        bool fits = lac_rg_map_fit(n, pairs, pairs + groups * most, &map, NULL) == LAC_OK;
        drawn[d] = fits ? map.fixed_point : NAN;
        drawn[draws + d] = fits ? map.lambda : NAN;
        drawn[2 * draws + d] = fits ? map.nu : NAN;
    }
    fit->fixed_point = estimate(fit->map.fixed_point, draws, drawn);
    fit->lambda = estimate(fit->map.lambda, draws, drawn + draws);
    fit->nu = estimate(fit->map.nu, draws, drawn + 2 * draws);
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
    double least = INFINITY, most = 0.0;
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
