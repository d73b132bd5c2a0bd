// SPDX-License-Identifier: GPL-3.0-or-later
// Oscillations in ln(tc - t) about the log law. A dyadic hierarchy might show omega = 2 pi/ln 2 k.
#include <math.h>
#include <stdlib.h>

#include "base/least_squares.h"
#include "base/rng.h"
#include "precursor/kinds.h"

enum { LEAST = 20, MOST = 200, FREQUENCIES = 60, SMOOTH = 2, ALL = 4, SURROGATES = 99 };
static const double pi = 3.14159265358979323846;
static const double highest = 20.0, turns = 1.5; // least turns of the lowest frequency

typedef struct lomb {
    size_t n;
    double u[MOST], d[MOST], r[MOST]; // ln(tc - t), displacement, what the log law leaves
    double column[ALL * MOST], y[MOST];
    double low; // frequency
} lomb;

// What is left of `from` after 1, u, and with `columns` = 4 the oscillation of omega.
static double rest(lomb *l, const double *from, size_t columns, double omega)
{
    double c[ALL];
    for (size_t i = 0; i < l->n; i++) {
        l->column[i] = 1.0;
        l->column[l->n + i] = l->u[i];
        l->y[i] = from[i];
        if (columns == ALL) {
            l->column[2 * l->n + i] = cos(omega * l->u[i]);
            l->column[3 * l->n + i] = sin(omega * l->u[i]);
        }
    }
    return lac_least_squares(l->n, columns, l->column, l->y, c);
}

// Largest share of the squares that one frequency takes.
static double peak(lomb *l, const double *from, double *omega)
{
    const double all = rest(l, from, SMOOTH, 0.0);
    double best = 0.0;
    *omega = NAN;
    for (size_t k = 0; k < FREQUENCIES; k++) {
        const double at = l->low + (highest - l->low) * ((double)k + 0.5) / FREQUENCIES;
        const double power = all > 0.0 ? 1.0 - rest(l, from, ALL, at) / all : 0.0;
        if (power > best) {
            best = power;
            *omega = at;
        }
    }
    return best;
}

static double autocorrelation(const lomb *l)
{
    double square = 0.0;
    double product = 0.0;
    for (size_t i = 0; i < l->n; i++) {
        square += l->r[i] * l->r[i];
        product += i > 0 ? l->r[i] * l->r[i - 1] : 0.0;
    }
    return square > 0.0 ? fmin(0.99, fmax(-0.99, product / square)) : 0.0;
}

static double significance(lomb *l, const lac_observed *seen, double power)
{
    const double phi = autocorrelation(l);
    const size_t surrogates = seen->surrogates < SURROGATES ? seen->surrogates : SURROGATES;
    size_t above = 0;
    double omega;
    double pair[2];
    for (size_t s = 0; s < surrogates; s++) {
        double before = 0.0;
        for (size_t i = 0; i < l->n; i++) {
            lac_random_normal(seen->seed, LAC_STREAM_SURROGATE, s, (1U << 20) + i, pair);
            before = i == 0 ? pair[0] / sqrt(1.0 - phi * phi) : phi * before + pair[0];
            l->d[i] = before;
        }
        above += peak(l, l->d, &omega) >= power ? 1 : 0;
    }
    return (double)(1 + above) / (double)(1 + surrogates);
}

static void gather(lomb *l, const lac_observed *seen)
{
    const lac_motion *m = seen->motion;
    size_t first = 0;
    while (first < m->n && m->time[first] < seen->start) {
        first++;
    }
    const size_t all = m->n - first;
    const size_t n = all < MOST ? all : MOST;
    for (size_t k = 0; k < n; k++) {
        const size_t i = first + (n > 1 ? k * (all - 1) / (n - 1) : 0);
        if (m->time[i] < seen->tc) {
            l->u[l->n] = log(seen->tc - m->time[i]);
            l->d[l->n++] = m->displacement[i];
        }
    }
}

static lac_status look(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    double omega = NAN;
    if (!isfinite(seen->tc)) {
        return lac_finding_refuse(found, "the log law has no time of failure to count from");
    }
    lomb *l = calloc(1, sizeof *l);
    if (l == NULL) {
        return lac_fail_memory(err);
    }
    gather(l, seen);
    found->points = l->n;
    const double span = l->n > 1 ? l->u[0] - l->u[l->n - 1] : 0.0;
    l->low = 2.0 * pi * turns / span;
    if (l->n < LEAST || !(l->low < highest)) {
        (void)lac_finding_refuse(found, "%zu readings over %.2g e-folds of tc - t are too few",
                                 l->n, span);
    } else {
        (void)rest(l, l->d, SMOOTH, 0.0);
        for (size_t i = 0; i < l->n; i++) {
            l->r[i] = l->y[i];
        }
        const double power = peak(l, l->r, &omega);
        lac_finding_add(found, "omega", omega);
        lac_finding_add(found, "lambda", exp(2.0 * pi / omega));
        lac_finding_add(found, "power", power);
        lac_finding_add(found, "p", significance(l, seen, power));
    }
    free(l);
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_log_periodicity = {
    .about = {.name = "log_periodicity",
              .summary = "oscillations in ln(tc - t) about the log law",
              .reference = "Zhou & Sornette (2002), Int. J. Mod. Phys. C 13, 137; Lomb (1976), "
                           "Astrophys. Space Sci. 39, 447"},
    .needs = LAC_NEEDS_MOTION,
    .estimator = "least-squares spectrum in u = ln(tc - t) beside 1 and u, tc of the log law, of "
                 "the displacements since the onset, at most 200; power: the largest share of the "
                 "squares; p among first-order autoregressions",
    .look = look,
};
