// SPDX-License-Identifier: GPL-3.0-or-later
// Maps from level to level in closed form: at least k of n points, or points that share load.
#include <math.h>
#include <stdbool.h>

#include "base/roots.h"
#include "rg/rg_map.h"

enum { MOST_POINTS = 64, MOST_SHARING = 16 };
static const double ln2 = 0.69314718055994530941723212145818;

typedef struct closure_map {
    size_t n, k; // k > 0: at least k of n
    double m;    // else: Weibull modulus
} closure_map;

static double choose(size_t n, size_t j)
{
    double c = 1.0;
    for (size_t i = 1; i <= j; i++) {
        c = c * (double)(n - j + i) / (double)i;
    }
    return c;
}

double lac_rg_all_below(size_t n, const double *bound)
{
    double g[MOST_SHARING + 1] = {1.0};
    for (size_t m = 1; m <= n && m <= MOST_SHARING; m++) {
        double sum = 0.0;
        for (size_t j = 0; j < m; j++) {
            double sign = (m - j) % 2 == 1 ? 1.0 : -1.0;
            sum += sign * choose(m, j) * pow(bound[j], (double)(m - j)) * g[j];
        }
        g[m] = sum;
    }
    return n <= MOST_SHARING ? g[n] : NAN;
}

static double at_least(size_t n, size_t k, double s)
{
    double sum = 0.0;
    for (size_t j = k; j <= n; j++) {
        sum += choose(n, j) * pow(s, (double)j) * pow(1.0 - s, (double)(n - j));
    }
    return sum;
}

// k points have failed: the others carry n/(n - k) of what they did, and F(c x) = 1 - (1 - F)^(c^m)
static double sharing(size_t n, double m, double p)
{
    double bound[MOST_SHARING];
    for (size_t k = 0; k < n; k++) {
        double c = pow((double)n / (double)(n - k), m);
        bound[k] = -expm1(c * log1p(-p));
    }
    return lac_rg_all_below(n, bound);
}

static double map(const closure_map *f, double s)
{
    return f->k > 0 ? at_least(f->n, f->k, s) : sharing(f->n, f->m, s);
}

// Between 0 and 1 the map starts below the diagonal and ends above it, or has no fixed point there.
static void find(const closure_map *f, lac_rg_closure *out)
{
    const double edge = 1e-6;
    double low = edge;
    double high = 1.0 - edge;
    *out = (lac_rg_closure){NAN, NAN, NAN};
    if (!(map(f, low) < low && map(f, high) > high)) {
        return;
    }
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);
        lac_halve(&low, &high, map(f, middle) < middle);
    }
    const double h = 1e-4 * fmin(low, 1.0 - low);
    double near = (map(f, low + h) - map(f, low - h)) / (2.0 * h);
    double far = (map(f, low + 2.0 * h) - map(f, low - 2.0 * h)) / (4.0 * h);
    out->fixed_point = 0.5 * (low + high);
    out->lambda = (4.0 * near - far) / 3.0;
    out->nu = ln2 / log(out->lambda);
}

lac_status lac_rg_closure_points(size_t n, size_t k, lac_rg_closure *closure, lac_error *err)
{
    if (!(k >= 1 && k <= n && n <= MOST_POINTS)) {
        return lac_fail(err, LAC_EINPUT, "%zu of %zu points is not possible: 1 <= k <= n <= %d", k,
                        n, MOST_POINTS);
    }
    find(&(closure_map){.n = n, .k = k}, closure);
    return LAC_OK;
}

lac_status lac_rg_closure_weibull(size_t n, double m, lac_rg_closure *closure, lac_error *err)
{
    if (!(n >= 2 && n <= MOST_SHARING && m > 0.0 && isfinite(m))) {
        return lac_fail(err, LAC_EINPUT,
                        "%zu points of modulus %g are not possible: 2 to %d points, modulus > 0", n,
                        m, MOST_SHARING);
    }
    find(&(closure_map){.n = n, .m = m}, closure);
    return LAC_OK;
}
