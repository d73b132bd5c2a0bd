// SPDX-License-Identifier: GPL-3.0-or-later
// Critical slowing down: variance and autocorrelation of the velocity rise before some transitions.
// A single block shows none before runaway; what a rise means belongs to many cells.
#include <complex.h>

#include "base/fft.h"
#include "base/rng.h"
#include "base/roots.h"
#include "base/statistics.h"
#include "precursor/kinds.h"

enum { LEAST = 24, MOST = 200, COLUMNS = 3, HALVINGS = 20 };
static const double steepest = 0.99;

static const lac_precursor_value numbers[] = {
    {"variance_m2_s2", "m2 s-2", "variance of the last window"},
    {"variance_tau", "1", "Kendall's tau of the variance"},
    {"variance_p", "1", "part of autoregressive surrogates with as high a tau"},
    {"variance_phase_p", "1", "part of phase-randomised surrogates with as high a tau"},
    {"autocorrelation", "1", "lag-1 autocorrelation of the last window"},
    {"autocorrelation_tau", "1", "Kendall's tau of the autocorrelation"},
    {"autocorrelation_p", "1", "part of autoregressive surrogates with as high a tau"},
    {"autocorrelation_phase_p", "1", "part of phase-randomised surrogates with as high a tau"},
};

// One series on its way: what is left of it, and the two indicators of its windows.
typedef struct passage {
    size_t n, window;
    double *rest;                // [n]
    double *smooth;              // [3][n] orthonormal parabolas
    double *variance, *relation; // [n - window + 1]
    double *amplitude;           // [n/2 + 1]
} passage;

// x -= its part along the orthonormal columns
static void straighten(const passage *p, size_t columns, double *x)
{
    for (size_t k = 0; k < columns; k++) {
        const double *q = p->smooth + k * p->n;
        lac_take_off(p->n, lac_dot(p->n, q, x), q, x);
    }
}

static lac_status create(passage *p, size_t n, lac_error *err)
{
    *p = (passage){.n = n, .window = n / 2};
    p->rest = calloc(7 * n, sizeof *p->rest);
    LAC_FAIL_MEMORY_IF(p->rest == NULL, err);
    p->smooth = p->rest + n;
    p->variance = p->smooth + COLUMNS * n;
    p->relation = p->variance + n;
    p->amplitude = p->relation + n;
    for (size_t k = 0; k < COLUMNS; k++) { // 1, t, t^2 made orthonormal
        double *q = p->smooth + k * n;
        for (size_t i = 0; i < n; i++) {
            q[i] = pow(2.0 * (double)i / (double)(n - 1) - 1.0, (double)k);
        }
        straighten(p, k, q);
        const double length = sqrt(lac_dot(n, q, q));
        for (size_t i = 0; i < n; i++) {
            q[i] /= length;
        }
    }
    return LAC_OK;
}

// Variance of n values and their correlation with those one later.
static void relate(size_t n, const double *x, double *variance, double *relation)
{
    const double mean = lac_mean(n, x);
    double square = 0.0, product = 0.0;
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
    straighten(p, COLUMNS, p->rest);
    for (size_t i = 0; i < windows; i++) {
        relate(p->window, p->rest + i, &p->variance[i], &p->relation[i]);
    }
    *variance_tau = lac_kendall(windows, p->variance);
    *relation_tau = lac_kendall(windows, p->relation);
}

// w = C q with C_ij = phi^|i - j|, forth and back.
static void correlate(size_t n, double phi, const double *q, double *w)
{
    double carry = 0.0;
    for (size_t i = 0; i < n; i++) {
        carry = q[i] + phi * carry;
        w[i] = carry;
    }
    carry = 0.0;
    for (size_t i = n; i-- > 0;) {
        w[i] += phi * carry; // w(i) = sum over j <= i, and phi times that over j > i
        carry = q[i] + phi * carry;
    }
}

// Mean lagged product over mean square of what is left of a first-order autoregression when a
// parabola is taken off: with M = 1 - Q Q^T, sum_i (M C M)_(i,i+1)/tr(M C).
static double expected_relation(const passage *p, double phi, double *w)
{
    double square = (double)p->n, lagged = phi * (double)(p->n - 1);
    for (size_t k = 0; k < COLUMNS; k++) {
        const double *q = p->smooth + k * p->n;
        correlate(p->n, phi, q, w);
        square -= lac_dot(p->n, q, w);
        lagged -= lac_dot(p->n - 1, q, w + 1) + lac_dot(p->n - 1, w, q + 1);
        for (size_t l = 0; l < COLUMNS; l++) {
            const double *other = p->smooth + l * p->n;
            lagged += lac_dot(p->n, other, w) * lac_dot(p->n - 1, other, q + 1);
        }
    }
    return lagged / square;
}

// The coefficient of which that is expected: an autocorrelation without its bias in short series.
static double without_bias(const passage *p, double relation, double *w)
{
    double low = -steepest, high = steepest;
    for (int i = 0; i < HALVINGS; i++) {
        lac_halve(&low, &high, expected_relation(p, 0.5 * (low + high), w) < relation);
    }
    return 0.5 * (low + high);
}

// The second counter of the numbers that phases are made of: none of an autoregression's.
static const uint64_t phase_counter = 1ULL << 40;

// Fourier amplitudes of what is left, of which surrogates with other phases are made.
static void find_amplitudes(const passage *p, lac_fft *fft)
{
    memcpy(fft->real, p->rest, p->n * sizeof *p->rest);
    lac_fft_forward(fft);
    for (size_t k = 0; k < fft->nkx; k++) {
        p->amplitude[k] = cabs(fft->spectrum[k]) / (double)p->n;
    }
}

// A series with these amplitudes and phases at random.
static void draw_phases(const passage *p, lac_fft *fft, uint64_t seed, size_t index)
{
    for (size_t k = 0; k < fft->nkx; k++) {
        const double turn =
            lac_random_uniform(seed, LAC_STREAM_SURROGATE, index, phase_counter + k);
        fft->spectrum[k] = p->amplitude[k] * cexp(I * 2.0 * M_PI * turn);
        if (k == 0 || 2 * k == p->n) { // real ones have a sign for a phase
            fft->spectrum[k] = p->amplitude[k] * (turn < 0.5 ? -1.0 : 1.0);
        }
    }
    lac_fft_inverse(fft);
    memcpy(p->rest, fft->real, p->n * sizeof *p->rest);
}

// How many surrogates have a tau as high, of either indicator.
typedef struct ranks {
    size_t variance, relation;
} ranks;

static void compare(passage *p, const lac_slowing *with, ranks *above)
{
    double variance_tau, relation_tau;
    pass(p, &variance_tau, &relation_tau);
    above->variance += variance_tau >= with->variance_tau ? 1 : 0;
    above->relation += relation_tau >= with->autocorrelation_tau ? 1 : 0;
}

static double share(size_t above, size_t surrogates)
{
    return (double)(1 + above) / (double)(1 + surrogates);
}

// p among both kinds of surrogates of the residuals that p->rest holds.
static lac_status rank(passage *p, uint64_t seed, size_t surrogates, lac_slowing *out,
                       lac_error *err)
{
    ranks red = {0};
    ranks phase = {0};
    double all = 0.0, relation = 0.0;
    lac_fft *fft = NULL;
    LAC_TRY_RETURN(lac_fft_create(p->n, 1, &fft, err));
    find_amplitudes(p, fft);
    relate(p->n, p->rest, &all, &relation);
    const double phi = without_bias(p, relation, p->variance); // as scratch
    for (size_t s = 0; s < surrogates; s++) {
        lac_surrogate_red(p->n, phi, seed, s, p->rest);
        compare(p, out, &red);
        draw_phases(p, fft, seed, s);
        compare(p, out, &phase);
    }
    out->variance_p = share(red.variance, surrogates);
    out->variance_phase_p = share(phase.variance, surrogates);
    out->autocorrelation_p = share(red.relation, surrogates);
    out->autocorrelation_phase_p = share(phase.relation, surrogates);
    lac_fft_free(fft);
    return LAC_OK;
}

lac_status lac_slowing_measure(size_t n, const double *values, uint64_t seed, size_t surrogates,
                               lac_slowing *out, lac_error *err)
{
    passage p;
    LAC_TRY_RETURN(create(&p, n, err));
    memcpy(p.rest, values, n * sizeof *values);
    pass(&p, &out->variance_tau, &out->autocorrelation_tau);
    out->variance = p.variance[n - p.window];
    out->autocorrelation = p.relation[n - p.window];
    const lac_status status = rank(&p, seed, surrogates, out, err);
    free(p.rest);
    return status;
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

static lac_status look(const lac_precursor_inputs *in, lac_forecast_fit *found, lac_error *err)
{
    const lac_motion *m = in->motion;
    double even[MOST];
    lac_slowing slowing = {0};
    if (m->velocities < LEAST) {
        return lac_forecast_fit_refuse(found, "too few velocities: %zu, at least %d", m->velocities,
                                       (int)LEAST);
    }
    found->points = m->velocities < MOST ? m->velocities : MOST;
    resample(m, found->points, even);
    lac_status status =
        lac_slowing_measure(found->points, even, in->seed, in->surrogates, &slowing, err);
    const double values[] = {slowing.variance,          slowing.variance_tau,
                             slowing.variance_p,        slowing.variance_phase_p,
                             slowing.autocorrelation,   slowing.autocorrelation_tau,
                             slowing.autocorrelation_p, slowing.autocorrelation_phase_p};
    for (size_t k = 0; status == LAC_OK && k < sizeof values / sizeof *values; k++) {
        lac_forecast_fit_add(found, numbers[k].key, values[k]);
    }
    return status;
}

const lac_precursor_kind lac_precursor_slowing = {
    .info = LAC_ABOUT("slowing", "variance and autocorrelation of the velocity, with Kendall's tau",
                      "Dakos et al. (2008), Proc. Natl Acad. Sci. 105, 14308, doi "
                      "10.1073/pnas.0802430105; Theiler et al. (1992), Physica D 58, 77"),
    .needs = LAC_NEEDS_MOTION,
    .estimator = "velocities at as many even times, at most 200, less a parabola; trailing windows "
                 "of half of them; tau over the windows; p among first-order autoregressions, "
                 "phase_p among series of the same spectrum",
    LAC_PRECURSOR_VALUES(numbers),
    .headline = 6,
    .evaluate = look,
};
