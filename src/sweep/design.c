// SPDX-License-Identifier: GPL-3.0-or-later
// Distributions that values are drawn from, and designs that say which members there are. A place
// follows from seed, member and parameter alone, so that any part of a sweep has the same bits.
#include "sweep/design.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>

#include "base/fail.h"
#include "base/rng.h"

static double uniform(const double *g, double u) { return g[0] + (g[1] - g[0]) * u; }

static double loguniform(const double *g, double u) { return g[0] * pow(g[1] / g[0], u); }

static double normal(const double *g, double u) { return g[0] + gsl_cdf_gaussian_Pinv(u, g[1]); }

static double lognormal(const double *g, double u)
{
    return g[0] * exp(gsl_cdf_gaussian_Pinv(u, g[1]));
}

static double triangular(const double *g, double u)
{
    const double wide = g[2] - g[0], turn = (g[1] - g[0]) / wide;
    return u < turn ? g[0] + sqrt(u * wide * (g[1] - g[0]))
                    : g[2] - sqrt((1.0 - u) * wide * (g[2] - g[1]));
}

static const char *ordered(const double *g) { return g[0] < g[1] ? NULL : "must have a < b"; }

static const char *positive(const double *g)
{
    return g[0] > 0.0 && g[0] < g[1] ? NULL : "must have 0 < a < b";
}

static const char *spread(const double *g)
{
    return g[1] > 0.0 ? NULL : "must have a standard deviation > 0";
}

static const char *median(const double *g)
{
    return g[0] > 0.0 && g[1] > 0.0 ? NULL : "must have a median > 0 and a sigma > 0";
}

static const char *three(const double *g)
{
    return g[0] <= g[1] && g[1] <= g[2] && g[0] < g[2] ? NULL : "must have a <= mode <= b, a < b";
}

const lac_distribution lac_distributions[] = {
    {"uniform", "a, b", 2, {0}, uniform, ordered},
    {"loguniform", "a, b", 2, {0}, loguniform, positive},
    {"normal", "mean, sd", 2, {0}, normal, spread},
    {"lognormal", "median, sd of ln", 2, {false, true}, lognormal, median},
    {"triangular", "a, mode, b", 3, {0}, triangular, three},
    {0},
};

static double draw(const lac_sweep *s, size_t member, size_t column)
{
    return lac_random_uniform(s->seed, LAC_STREAM_SWEEP, member, column);
}

static size_t grid_members(const lac_sweep *s, size_t asked)
{
    size_t n = 1;
    (void)asked;
    for (size_t p = 0; p < s->params; p++) {
        n = s->param[p].values == 0 || n > (size_t)1 << 40 ? 0 : n * s->param[p].values;
    }
    return n;
}

// The last parameter fastest.
static lac_status grid(lac_sweep *s, lac_error *err)
{
    (void)err;
    for (size_t i = 0; i < s->members; i++) {
        size_t rest = i;
        for (size_t p = s->params; p-- > 0;) {
            const size_t n = s->param[p].values;
            s->place[p * s->members + i] = ((double)(rest % n) + 0.5) / (double)n;
            rest /= n;
        }
    }
    return LAC_OK;
}

static size_t as_asked(const lac_sweep *s, size_t asked)
{
    (void)s;
    return asked > 0 ? asked : 100;
}

static lac_status at_random(lac_sweep *s, lac_error *err)
{
    (void)err;
    for (size_t k = 0; k < s->params * s->members; k++) {
        s->place[k] = draw(s, k % s->members, k / s->members);
    }
    return LAC_OK;
}

// One member in each of as many equal parts, in an order of random numbers, anywhere in its part.
static lac_status lhs(lac_sweep *s, lac_error *err)
{
    const size_t n = s->members;
    size_t *order = malloc((n + 1) * sizeof *order);
    LAC_FAIL_MEMORY_IF(order == NULL, err);
    (void)at_random(s, err);
    for (size_t p = 0; p < s->params; p++) {
        double *place = s->place + p * n;
        gsl_sort_index(order, place, 1, n);
        for (size_t k = 0; k < n; k++) {
            place[order[k]] = ((double)k + draw(s, order[k], s->params + p)) / (double)n;
        }
    }
    free(order);
    return LAC_OK;
}

// The sequence of Sobol', shifted by a random vector (Cranley & Patterson 1976).
static lac_status sobol(lac_sweep *s, lac_error *err)
{
    double point[40] = {0.0};
    LAC_FAIL_IF(s->params > 40, err, LAC_EINPUT, "--design: sobol takes at most 40 parameters");
    gsl_qrng *q = s->params > 0 ? gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)s->params) : NULL;
    LAC_FAIL_MEMORY_IF(q == NULL && s->params > 0, err);
    for (size_t i = 0; i < s->members && q != NULL; i++) {
        if (i > 0) { // GSL leaves out the first point, at zero
            (void)gsl_qrng_get(q, point);
        }
        for (size_t p = 0; p < s->params; p++) {
            const double u = point[p] + draw(s, SIZE_MAX, p);
            s->place[p * s->members + i] = u < 1.0 ? u : u - 1.0;
        }
    }
    gsl_qrng_free(q);
    return LAC_OK;
}

static size_t whole_rows(const lac_sweep *s, size_t asked)
{
    const size_t wide = s->params + 2;
    return (as_asked(s, asked > 0 ? asked : 100 * wide) + wide - 1) / wide * wide;
}

// Of each row A, B, and A with each parameter of B: Saltelli et al. (2010).
static lac_status saltelli(lac_sweep *s, lac_error *err)
{
    (void)err;
    for (size_t i = 0; i < s->members; i++) {
        const size_t row = i / (s->params + 2), k = i % (s->params + 2);
        for (size_t p = 0; p < s->params; p++) {
            const bool other = k == 1 || k == 2 + p;
            s->place[p * s->members + i] = draw(s, row, p + (other ? s->params : 0));
        }
    }
    return LAC_OK;
}

static size_t two_each(const lac_sweep *s, size_t asked)
{
    (void)asked;
    return 2 * s->params + 1;
}

// The case as it is; then of each parameter its tenth and ninetieth percent, first and last value.
static lac_status tornado(lac_sweep *s, lac_error *err)
{
    (void)err;
    for (size_t k = 0; k < s->params * s->members; k++) {
        s->place[k] = NAN;
    }
    for (size_t p = 0; p < s->params; p++) {
        const bool list = s->param[p].values > 0;
        s->place[p * s->members + 1 + 2 * p] = list ? 0.0 : 0.1;
        s->place[p * s->members + 2 + 2 * p] = list ? 1.0 : 0.9;
    }
    return LAC_OK;
}

const lac_design lac_designs[] = {
    {"grid", grid_members, grid},
    {"random", as_asked, at_random},
    {"lhs", as_asked, lhs},
    {"sobol", as_asked, sobol},
    {"saltelli", whole_rows, saltelli},
    {"tornado", two_each, tornado},
    {0},
};
