// SPDX-License-Identifier: GPL-3.0-or-later
// Critical slowing down: variance and autocorrelation of the velocity rise before some transitions.
// A single block shows none before runaway; what a rise means belongs to many cells.
#include <math.h>
#include <stdlib.h>

#include "base/least_squares.h"
#include "base/rng.h"
#include "precursor/kinds.h"

enum { LEAST = 24, MOST = 200 };

// One series on its way: what is left of it, and the two indicators of its windows.
typedef struct passage {
    size_t n, window;
    double *rest;                // [n]
    double *column;              // [3 n]
    double *variance, *relation; // [n - window + 1]
} passage;

static lac_status create(passage *p, size_t n, lac_error *err)
{
    *p = (passage){.n = n, .window = n / 2};
    p->rest = malloc(6 * n * sizeof *p->rest);
    if (p->rest == NULL) {
        return lac_fail_memory(err);
    }
    p->column = p->rest + n;
    p->variance = p->column + 3 * n;
    p->relation = p->variance + n;
    return LAC_OK;
}

// rest -= the parabola through it
static void straighten(passage *p)
{
    double c[3];
    for (size_t i = 0; i < p->n; i++) {
        const double t = 2.0 * (double)i / (double)(p->n - 1) - 1.0;
        p->column[i] = 1.0;
        p->column[p->n + i] = t;
        p->column[2 * p->n + i] = t * t;
    }
    (void)lac_least_squares(p->n, 3, p->column, p->rest, c);
}

// Variance of n values and their correlation with those one later.
static void relate(size_t n, const double *x, double *variance, double *relation)
{
    double mean = 0.0;
    double square = 0.0;
    double product = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean += x[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        square += (x[i] - mean) * (x[i] - mean);
        product += i > 0 ? (x[i] - mean) * (x[i - 1] - mean) : 0.0;
    }
    *variance = square / (double)(n - 1);
    *relation = square > 0.0 ? product / square : 0.0;
}

static void pass(passage *p, double *variance_tau, double *relation_tau)
{
    const size_t windows = p->n - p->window + 1;
    straighten(p);
    for (size_t i = 0; i < windows; i++) {
        relate(p->window, p->rest + i, &p->variance[i], &p->relation[i]);
    }
    *variance_tau = lac_kendall(windows, p->variance);
    *relation_tau = lac_kendall(windows, p->relation);
}

// Autocorrelation less its bias in short series (Kendall 1954): r = phi - (1 + 4 phi)/n with a mean
// and trend taken off.
static double without_bias(double r, size_t n)
{
    const double count = (double)n;
    const double phi = (r + 1.0 / count) / (1.0 - 4.0 / count);
    return fmax(-0.99, fmin(0.99, phi));
}

static void fill_surrogate(passage *p, double phi, uint64_t seed, size_t index)
{
    double before = 0.0;
    double pair[2];
    for (size_t i = 0; i < p->n; i++) {
        if (i % 2 == 0) {
            lac_random_normal(seed, LAC_STREAM_SURROGATE, index, i / 2, pair);
        }
        before = i == 0 ? pair[0] / sqrt(1.0 - phi * phi) : phi * before + pair[i % 2];
        p->rest[i] = before;
    }
}

lac_status lac_slowing_measure(size_t n, const double *values, uint64_t seed, size_t surrogates,
                               lac_slowing *out, lac_error *err)
{
    passage p;
    double all = 0.0;
    double relation = 0.0;
    size_t above[2] = {0, 0};
    lac_status status = create(&p, n, err);
    if (status != LAC_OK) {
        return status;
    }
    for (size_t i = 0; i < n; i++) {
        p.rest[i] = values[i];
    }
    pass(&p, &out->variance_tau, &out->autocorrelation_tau);
    out->variance = p.variance[n - p.window];
    out->autocorrelation = p.relation[n - p.window];
    relate(n, p.rest, &all, &relation);
    for (size_t s = 0; s < surrogates; s++) {
        double tau[2];
        fill_surrogate(&p, without_bias(relation, n), seed, s);
        pass(&p, &tau[0], &tau[1]);
        above[0] += tau[0] >= out->variance_tau ? 1 : 0;
        above[1] += tau[1] >= out->autocorrelation_tau ? 1 : 0;
    }
    out->variance_p = (double)(1 + above[0]) / (double)(1 + surrogates);
    out->autocorrelation_p = (double)(1 + above[1]) / (double)(1 + surrogates);
    free(p.rest);
    return LAC_OK;
}

// Velocities at even times, linear between those there are, from the first to the last.
static void resample(const lac_motion *m, size_t n, double *even)
{
    const double first = m->velocity_time[0];
    const double length = m->velocity_time[m->velocities - 1] - first;
    size_t at = 0;
    for (size_t i = 0; i < n; i++) {
        const double t = first + length * ((double)i / (double)(n - 1));
        while (at + 2 < m->velocities && m->velocity_time[at + 1] < t) {
            at++;
        }
        const double step = m->velocity_time[at + 1] - m->velocity_time[at];
        const double w = fmin(1.0, fmax(0.0, (t - m->velocity_time[at]) / step));
        even[i] = (1.0 - w) * m->velocity[at] + w * m->velocity[at + 1];
    }
}

static lac_status look(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    const lac_motion *m = seen->motion;
    double even[MOST];
    lac_slowing slowing;
    if (m->velocities < LEAST) {
        return lac_finding_refuse(found, "too few velocities: %zu, at least %d", m->velocities,
                                  (int)LEAST);
    }
    found->points = m->velocities < MOST ? m->velocities : MOST;
    resample(m, found->points, even);
    lac_status status =
        lac_slowing_measure(found->points, even, seen->seed, seen->surrogates, &slowing, err);
    if (status == LAC_OK) {
        lac_finding_add(found, "variance_m2_s2", slowing.variance);
        lac_finding_add(found, "variance_tau", slowing.variance_tau);
        lac_finding_add(found, "variance_p", slowing.variance_p);
        lac_finding_add(found, "autocorrelation", slowing.autocorrelation);
        lac_finding_add(found, "autocorrelation_tau", slowing.autocorrelation_tau);
        lac_finding_add(found, "autocorrelation_p", slowing.autocorrelation_p);
    }
    return status;
}

const lac_precursor_kind lac_precursor_slowing = {
    .about = {.name = "slowing",
              .summary = "variance and autocorrelation of the velocity, with Kendall's tau",
              .reference = "Dakos et al. (2008), Proc. Natl Acad. Sci. 105, 14308, doi "
                           "10.1073/pnas.0802430105"},
    .needs = LAC_NEEDS_MOTION,
    .estimator = "velocities at as many even times, at most 200, less a parabola; trailing windows "
                 "of half of them; tau over the windows; p among first-order autoregressions",
    .look = look,
};
