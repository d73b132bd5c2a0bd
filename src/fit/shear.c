// SPDX-License-Identifier: GPL-3.0-or-later
// A map of the walkers' coordinates that takes the bend out of a valley, from a chain that has not
// converged: z_k - c_k q2(t) - d_k q3(t), t the one coordinate along which the others bend most, q2
// and q3 orthogonal polynomials. It moves no volume, so a density stays what it is. The sampler's
// own moves turn and stretch with the walkers, but know no bend; docs/theory/fitting.md.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fit/internal.h"

enum { MOST = 4096 }; // places that a shear is made of, at the end of a chain

static const double least_gain = 0.7; // of ln of the volume that the places take

// q2 and q3 at t, in `q`.
static void bend_of(const lac_fit_shear *s, double z, double q[2])
{
    const double t = (z - s->mean) / s->width;
    q[0] = t * t - s->third * t - 1.0;
    q[1] = t * t * t - s->third - s->fourth * t - s->share * q[0];
}

void lac_fit_shear_to(const lac_fit_shear *s, double sign, double *z)
{
    double q[2];
    if (s->used) {
        bend_of(s, z[s->pivot], q);
        for (size_t k = 0; k < s->dimension; k++) {
            z[k] -= sign * (s->by[k][0] * q[0] + s->by[k][1] * q[1]);
        }
    }
}

// ln of the square of the volume of places.
static double volume(size_t n, size_t d, const double *z)
{
    double mean[LAC_FIT_UNKNOWNS] = {0}, c[LAC_FIT_UNKNOWNS * LAC_FIT_UNKNOWNS] = {0}, sum = 0.0;
    for (size_t i = 0; i < n * d; i++) {
        mean[i % d] += z[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < d * d; k++) {
            const size_t a = k / d, b = k % d;
            c[k] += (z[i * d + a] - mean[a]) * (z[i * d + b] - mean[b]) / (double)n;
        }
    }
    if (!lac_fit_factor(d, d, c)) {
        return -INFINITY;
    }
    for (size_t k = 0; k < d; k++) {
        sum += 2.0 * log(c[k * d + k]);
    }
    return sum;
}

// The shear along one coordinate, by least squares.
static lac_fit_shear shear_along(size_t n, size_t d, const double *z, size_t pivot)
{
    lac_fit_shear s = {.used = true, .pivot = pivot, .dimension = d};
    double moment[6] = {0}, square[2] = {0}, q[2];
    for (size_t i = 0; i < n; i++) {
        s.mean += z[i * d + pivot] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        s.width += pow(z[i * d + pivot] - s.mean, 2.0) / (double)n;
    }
    s.width = sqrt(s.width);
    for (size_t i = 0; i < n; i++) {
        const double t = (z[i * d + pivot] - s.mean) / s.width;
        for (int k = 3; k < 6; k++) {
            moment[k] += pow(t, k) / (double)n;
        }
    }
    s.third = moment[3];
    s.fourth = moment[4];
    s.share =
        (moment[5] - moment[3] * moment[4] - moment[3]) / (moment[4] - moment[3] * moment[3] - 1.0);
    for (size_t i = 0; i < n; i++) {
        bend_of(&s, z[i * d + pivot], q);
        for (int j = 0; j < 2; j++) {
            square[j] += q[j] * q[j];
            for (size_t k = 0; k < d; k++) {
                s.by[k][j] += k != pivot ? q[j] * z[i * d + k] : 0.0;
            }
        }
    }
    for (size_t k = 0; k < d; k++) {
        s.by[k][0] /= square[0];
        s.by[k][1] /= square[1];
    }
    return s;
}

// Places of the end of a chain, which holds coordinates, on the line. @return how many
static size_t take_places(const lac_fit *fit, double *z)
{
    const lac_chain *chain = fit->chain;
    const size_t d = chain->dimension, all = chain->walkers * chain->steps;
    const size_t last = all / 2 < MOST ? all / 2 : MOST;
    size_t n = 0;
    for (size_t i = all - last; i < all; i++) {
        bool whole = true;
        lac_fit_to_line_unbent(fit, chain->x + i * d, z + n * d);
        for (size_t k = 0; k < d; k++) {
            whole = whole && isfinite(z[n * d + k]);
        }
        n += whole ? 1 : 0;
    }
    return n;
}

lac_status lac_fit_find_shear(lac_fit *fit, lac_error *err)
{
    const size_t d = fit->unknowns;
    double *z = malloc(2 * MOST * d * sizeof *z), best = -least_gain;
    LAC_FAIL_MEMORY_IF(z == NULL, err);
    double *bent = z + MOST * d;
    const size_t n = take_places(fit, z);
    const double before = volume(n, d, z);
    fit->shear.used = false;
    for (size_t pivot = 0; pivot < d && isfinite(before); pivot++) {
        const lac_fit_shear s = shear_along(n, d, z, pivot);
        memcpy(bent, z, n * d * sizeof *z);
        for (size_t i = 0; i < n; i++) {
            lac_fit_shear_to(&s, 1.0, bent + i * d);
        }
        const double gain = 0.5 * (volume(n, d, bent) - before);
        if (isfinite(gain) && gain < best) {
            best = gain;
            fit->shear = s;
        }
    }
    free(z);
    return LAC_OK;
}
