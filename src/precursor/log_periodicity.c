// SPDX-License-Identifier: GPL-3.0-or-later
// Oscillations in ln(tc - t) about the log law. A dyadic hierarchy might show omega = 2 pi/ln 2 k.
#include "base/statistics.h"
#include "precursor/kinds.h"

enum { LEAST = 20, MOST = 200, FREQUENCIES = 60, SMOOTH = 2, SURROGATES = 99 };
static const size_t first_surrogate = 1U << 20;  // none of another indicator's
static const double highest = 20.0, turns = 1.5; // least turns of the lowest frequency

static const lac_precursor_value numbers[] = {
    {"omega", "1", "angular frequency in ln(tc - t) of the largest peak"},
    {"lambda", "1", "ratio of scales, exp(2 pi/omega)"},
    {"power", "1", "part of the squares that the oscillation takes"},
    {"p", "1", "part of autoregressive surrogates with as large a peak"},
};

typedef struct lomb {
    size_t n;
    double u[MOST], d[MOST], r[MOST]; // ln(tc - t), displacement, what the log law leaves
    double column[SMOOTH * MOST];
    double low;                        // frequency
    double wave[FREQUENCIES][2][MOST]; // orthonormal, and to 1 and u
} lomb;

// x -= c_0 + c_1 u by least squares; returns what is left of its squares.
static double straighten(lomb *l, double *x)
{
    double c[SMOOTH];
    for (size_t i = 0; i < l->n; i++) {
        l->column[i] = 1.0;
        l->column[l->n + i] = l->u[i];
    }
    return lac_least_squares(l->n, SMOOTH, l->column, x, c);
}

// To length 1; to nothing where hardly anything is left of it.
static void normalise(size_t n, double *x)
{
    const double length = sqrt(lac_dot(n, x, x) / (double)n);
    for (size_t i = 0; i < n; i++) {
        x[i] = length > 1e-9 ? x[i] / (length * sqrt((double)n)) : 0.0;
    }
}

static double frequency(const lomb *l, size_t k)
{
    return l->low + (highest - l->low) * ((double)k + 0.5) / FREQUENCIES;
}

// cos and sin of each frequency, made orthogonal to 1, u and each other.
static void make_waves(lomb *l)
{
    for (size_t k = 0; k < FREQUENCIES; k++) {
        double *even = l->wave[k][0], *odd = l->wave[k][1];
        for (size_t i = 0; i < l->n; i++) {
            even[i] = cos(frequency(l, k) * l->u[i]);
            odd[i] = sin(frequency(l, k) * l->u[i]);
        }
        (void)straighten(l, even);
        (void)straighten(l, odd);
        normalise(l->n, even);
        const double along = lac_dot(l->n, even, odd);
        lac_take_off(l->n, along, even, odd);
        normalise(l->n, odd);
    }
}

// Largest share of the squares of x that one frequency takes; x is straightened.
static double peak(lomb *l, double *x, double *omega)
{
    const double all = straighten(l, x);
    double best = 0.0;
    *omega = NAN;
    for (size_t k = 0; k < FREQUENCIES && all > 0.0; k++) {
        const double even = lac_dot(l->n, l->wave[k][0], x);
        const double odd = lac_dot(l->n, l->wave[k][1], x);
        const double power = (even * even + odd * odd) / all;
        if (power > best) {
            best = power;
            *omega = frequency(l, k);
        }
    }
    return best;
}

static double significance(lomb *l, const lac_precursor_inputs *in, double power)
{
    const double phi = lac_alike(l->n, l->r, 0.0, -0.99, 0.99);
    const size_t surrogates = in->surrogates < SURROGATES ? in->surrogates : SURROGATES;
    size_t above = 0;
    double omega;
    for (size_t s = 0; s < surrogates; s++) {
        lac_surrogate_red(l->n, phi, in->seed, first_surrogate + s, l->d);
        above += peak(l, l->d, &omega) >= power ? 1 : 0;
    }
    return (double)(1 + above) / (double)(1 + surrogates);
}

static void gather(lomb *l, const lac_precursor_inputs *in)
{
    const lac_motion *m = in->motion;
    size_t first = 0;
    while (first < m->n && m->time[first] < in->start) {
        first++;
    }
    const size_t all = m->n - first;
    const size_t n = all < MOST ? all : MOST;
    for (size_t k = 0; k < n; k++) {
        const size_t i = first + (n > 1 ? k * (all - 1) / (n - 1) : 0);
        if (m->time[i] < in->tc) {
            l->u[l->n] = log(in->tc - m->time[i]);
            l->d[l->n++] = m->displacement[i];
        }
    }
}

static lac_status look(const lac_precursor_inputs *in, lac_forecast_fit *found, lac_error *err)
{
    double omega = NAN;
    if (!isfinite(in->tc)) {
        return lac_forecast_fit_refuse(found, "the log law has no time of failure to count from");
    }
    lomb *l = calloc(1, sizeof *l);
    LAC_FAIL_MEMORY_IF(l == NULL, err);
    gather(l, in);
    found->points = l->n;
    const double span = l->n > 1 ? l->u[0] - l->u[l->n - 1] : 0.0;
    l->low = 2.0 * M_PI * turns / span;
    if (l->n < LEAST || !(l->low < highest)) {
        (void)lac_forecast_fit_refuse(found, "%zu readings over %.2g e-folds of tc - t are too few",
                                      l->n, span);
    } else {
        make_waves(l);
        memcpy(l->r, l->d, l->n * sizeof *l->r);
        const double power = peak(l, l->r, &omega);
        lac_forecast_fit_add(found, "omega", omega);
        lac_forecast_fit_add(found, "lambda", exp(2.0 * M_PI / omega));
        lac_forecast_fit_add(found, "power", power);
        lac_forecast_fit_add(found, "p", significance(l, in, power));
    }
    free(l);
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_log_periodicity = {
    .info = LAC_ABOUT("log_periodicity", "oscillations in ln(tc - t) about the log law",
                      "Zhou & Sornette (2002), Int. J. Mod. Phys. C 13, 137; Lomb (1976), "
                      "Astrophys. Space Sci. 39, 447"),
    .needs = LAC_NEEDS_MOTION,
    .estimator = "least-squares spectrum in u = ln(tc - t) beside 1 and u, tc of the log law, of "
                 "the displacements since the onset, at most 200; power: the largest share of the "
                 "squares; p among first-order autoregressions",
    LAC_PRECURSOR_VALUES(numbers),
    .headline = 3,
    .evaluate = look,
};
