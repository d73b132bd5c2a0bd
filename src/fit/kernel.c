// SPDX-License-Identifier: GPL-3.0-or-later
// A density made of the walkers' places, from which the sampler draws new places, also far away.
#include "fit/kernel.h"

#include <gsl/gsl_sort.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// Degrees of freedom: tails so long that no walker is stranded where the density has none.
static const double freedom = 4.0;

// Of the walkers' number: how many about one tell its spread. Of that spread: what of it is taken
// alike in all directions, as few walkers know theirs badly; and how wide the t is.
static const double neighbours = 0.3;
static const double alike = 0.2;
static const double width = 0.7;

lac_status lac_kernels_create(size_t count, size_t dimension, lac_kernels *out, lac_error *err)
{
    size_t d = dimension;
    size_t next = (size_t)(neighbours * (double)count);
    *out = (lac_kernels){.count = count, .dimension = d, .next = next > d + 2 ? next : d + 2};
    out->next = out->next < count ? out->next : count - 1;
    double *room = calloc(count * (d + d * d + 3) + d * d + d, sizeof *room);
    LAC_FAIL_MEMORY_IF(room == NULL, err);
    out->place = room;
    out->root = out->place + count * d;
    out->mean = out->root + d * d;
    out->local = out->mean + d;
    out->log_scale = out->local + count * d * d;
    out->away = out->log_scale + count;
    return LAC_OK;
}

void lac_kernels_clear(lac_kernels *k)
{
    free(k->place);
    *k = (lac_kernels){0};
}

bool lac_fit_factor(size_t d, size_t stride, double *a)
{
    bool full = true;
    for (size_t j = 0; j < d; j++) {
        double *pivot = &a[j * stride + j];
        double whole = *pivot;
        for (size_t i = j; i < d; i++) {
            double sum = a[i * stride + j];
            for (size_t k = 0; k < j; k++) {
                sum -= a[i * stride + k] * a[j * stride + k];
            }
            full = full && (i != j || sum > 1e-12 * whole);
            a[i * stride + j] = i == j ? sqrt(fmax(sum, 0.0)) : *pivot > 0.0 ? sum / *pivot : 0.0;
        }
    }
    return full;
}

// x = L^-1 x
static void solve(size_t d, const double *l, double *x)
{
    for (size_t i = 0; i < d; i++) {
        for (size_t k = 0; k < i; k++) {
            x[i] -= l[i * d + k] * x[k];
        }
        x[i] /= l[i * d + i];
    }
}

// x = from + L z
static void multiply(size_t d, const double *l, const double *from, const double *z, double *x)
{
    for (size_t i = 0; i < d; i++) {
        x[i] = from[i];
        for (size_t k = 0; k <= i; k++) {
            x[i] += l[i * d + k] * z[k];
        }
    }
}

// Adds the lower triangle of (x - y)(x - y)^T.
static void add_square(size_t d, const double *x, const double *y, double *sum)
{
    for (size_t i = 0; i < d; i++) {
        for (size_t k = 0; k <= i; k++) {
            sum[i * d + k] += (x[i] - y[i]) * (x[k] - y[k]);
        }
    }
}

static double distance(size_t d, const double *x, const double *y)
{
    double sum = 0.0;
    for (size_t i = 0; i < d; i++) {
        sum += (x[i] - y[i]) * (x[i] - y[i]);
    }
    return sum;
}

// Coordinates in which the walkers have no mean and unit covariance.
static bool set_places(lac_kernels *k, const double *x)
{
    size_t d = k->dimension;
    memset(k->mean, 0, d * sizeof *k->mean);
    memset(k->root, 0, d * d * sizeof *k->root);
    for (size_t i = 0; i < k->count * d; i++) {
        k->mean[i % d] += x[i] / (double)k->count;
    }
    for (size_t i = 0; i < k->count; i++) {
        add_square(d, x + i * d, k->mean, k->root);
    }
    for (size_t i = 0; i < d * d; i++) {
        k->root[i] /= (double)k->count;
    }
    if (!lac_fit_factor(d, d, k->root)) {
        return false;
    }
    for (size_t i = 0; i < k->count * d; i++) {
        k->place[i] = x[i] - k->mean[i % d];
    }
    for (size_t i = 0; i < k->count; i++) {
        solve(d, k->root, k->place + i * d);
    }
    return true;
}

// The spread about a walker, from those next to it.
static bool set_spread(lac_kernels *k, size_t which)
{
    size_t d = k->dimension;
    double *s = k->local + which * d * d;
    const double *at = k->place + which * d;
    double *sorted = k->away + k->count;
    double trace = 0.0;
    for (size_t i = 0; i < k->count; i++) {
        k->away[i] = sorted[i] = distance(d, k->place + i * d, at);
    }
    gsl_sort(sorted, 1, k->count);
    memset(s, 0, d * d * sizeof *s);
    for (size_t i = 0; i < k->count; i++) {
        if (k->away[i] <= sorted[k->next]) {
            add_square(d, k->place + i * d, at, s);
        }
    }
    double share = width / (double)k->next;
    for (size_t i = 0; i < d; i++) {
        trace += share * s[i * d + i];
    }
    for (size_t i = 0; i < d * d; i++) {
        s[i] *= (1.0 - alike) * share;
        s[i] += i % (d + 1) == 0 ? alike * trace / (double)d : 0.0;
    }
    if (!lac_fit_factor(d, d, s)) {
        return false;
    }
    k->log_scale[which] = 0.0;
    for (size_t i = 0; i < d; i++) {
        k->log_scale[which] -= log(s[i * d + i]);
    }
    return true;
}

void lac_kernels_set(lac_kernels *k, const double *x)
{
    k->usable = set_places(k, x);
    for (size_t i = 0; k->usable && i < k->count; i++) {
        k->usable = set_spread(k, i);
    }
}

void lac_kernels_draw(const lac_kernels *k, size_t which, double *z, const double share[2],
                      double *x)
{
    size_t d = k->dimension;
    // chi-squared with four degrees of freedom: two exponentials
    double t = sqrt(freedom / (-2.0 * log(share[0] * share[1])));
    multiply(d, k->local + which * d * d, k->place + which * d, z, x);
    for (size_t i = 0; i < d; i++) {
        z[i] = k->place[which * d + i] + t * (x[i] - k->place[which * d + i]);
    }
    multiply(d, k->root, k->mean, z, x);
}

double lac_kernels_log(const lac_kernels *k, const double *x, double *scratch)
{
    size_t d = k->dimension;
    double *at = scratch;
    double *by = scratch + d;
    double top = -INFINITY;
    double sum = 0.0;
    for (size_t i = 0; i < d; i++) {
        at[i] = x[i] - k->mean[i];
    }
    solve(d, k->root, at);
    for (size_t j = 0; j < k->count; j++) {
        double squares = 0.0;
        for (size_t i = 0; i < d; i++) {
            by[i] = at[i] - k->place[j * d + i];
        }
        solve(d, k->local + j * d * d, by);
        for (size_t i = 0; i < d; i++) {
            squares += by[i] * by[i];
        }
        double term = k->log_scale[j] - 0.5 * (freedom + (double)d) * log1p(squares / freedom);
        sum = term > top ? sum * exp(top - term) + 1.0 : sum + exp(term - top);
        top = fmax(top, term);
    }
    return top + log(sum);
}
