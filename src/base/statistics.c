// SPDX-License-Identifier: GPL-3.0-or-later
// What numbers have in common: order, middle, straight lines; by GSL where that cannot fail on
// them.
#include "base/statistics.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>

#include "base/vsum.h"

double lac_sum(size_t n, const double *x)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i];
    }
    return sum;
}

double lac_mean(size_t n, const double *x)
{
    double mean = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean += x[i] / (double)n;
    }
    return mean;
}

double lac_dot(size_t n, const double *x, const double *y)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

void lac_take_off(size_t n, double part, const double *y, double *x)
{
    for (size_t i = 0; i < n; i++) {
        x[i] -= part * y[i];
    }
}

double lac_median(size_t n, double *values)
{
    gsl_sort(values, 1, n);
    return n > 0 ? gsl_stats_median_from_sorted_data(values, 1, n) : (double)NAN;
}

// The 99 % quantile of chi-square over its degrees of freedom, to 1 % (Wilson & Hilferty 1931):
// GSL's does not converge for many.
static double chi_square(double degrees)
{
    static const double normal = 2.3263478740408408;
    const double variance = 2.0 / (9.0 * degrees);
    return pow(1.0 - variance + normal * sqrt(variance), 3.0);
}

double lac_unexplained(double rms, double noise, double free)
{
    const double degrees = fmax(1.0, free);
    if (!(noise > 0.0)) {
        return rms;
    }
    const double most = noise * sqrt(chi_square(degrees));
    return rms <= most ? 0.0 : sqrt(rms * rms - noise * noise);
}

double lac_quantile(size_t n, const double *sorted, double share)
{
    const double at = share * (double)(n - 1);
    const size_t low = (size_t)at;
    const size_t high = low + 1 < n ? low + 1 : low;
    const double part = at - (double)low;
    return isinf(sorted[high]) ? sorted[part > 0.5 ? high : low]
                               : sorted[low] + part * (sorted[high] - sorted[low]);
}

double lac_alike(size_t n, const double *x, double floor, double least, double most)
{
    const double square = lac_dot(n, x, x) + floor;
    return square > 0.0 ? fmin(most, fmax(least, lac_dot(n - 1, x, x + 1) / square)) : 0.0;
}

int lac_by_first(const void *left, const void *right)
{
    const double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

// Welford (1962) for the sums; the squares that a point adds to the residuals are those of what it
// is off the line so far, over how much surer that is than the point (Brown et al. 1975, eq. 4).
void lac_line_add(lac_line *l, double x, double y)
{
    if (l->n == 0.0) {
        *l = (lac_line){.n = 1.0, .x0 = x, .y0 = y};
        return;
    }
    const double u = x - l->x0 - l->x, v = y - l->y0 - l->y;
    const double off = l->xx > 0.0 ? v - l->xy / l->xx * u : v;
    const double unsure = l->xx > 0.0 ? u * u / l->xx : u != 0.0 ? (double)INFINITY : 0.0;
    l->rest += off * off / (1.0 + 1.0 / l->n + unsure);
    l->n += 1.0;
    l->x += u / l->n;
    l->y += v / l->n;
    l->xx += u * (u - u / l->n);
    l->xy += u * (v - v / l->n);
    l->yy += v * (v - v / l->n);
}

double lac_line_slope(const lac_line *line) { return line->xy / line->xx; }

double lac_line_at(const lac_line *l, double x)
{
    const double slope = l->xx > 0.0 ? l->xy / l->xx : 0.0;
    return l->y0 + (l->y - slope * (l->x - (x - l->x0)));
}

double lac_line_error(const lac_line *l)
{
    const double rest = fmax(0.0, l->yy - lac_line_slope(l) * l->xy);
    return l->n > 2.0 ? sqrt(rest / (l->n - 2.0) / l->xx) : (double)NAN;
}

lac_line lac_line_fit(size_t n, const double *x, const double *y)
{
    lac_line l = {.n = (double)n, .x = lac_mean(n, x), .y = lac_mean(n, y)};
    for (size_t i = 0; i < n; i++) {
        l.xx += (x[i] - l.x) * (x[i] - l.x);
        l.xy += (x[i] - l.x) * (y[i] - l.y);
        l.yy += (y[i] - l.y) * (y[i] - l.y);
    }
    const double start = lac_line_at(&l, 0.0);
    for (size_t i = 0; i < n; i++) {
        const double off = y[i] - start - lac_line_slope(&l) * x[i];
        l.rest += off * off;
    }
    return l;
}

double lac_line_range_spread(const lac_line *line, const double *x, const double *y)
{
    const size_t n = (size_t)line->n;
    const size_t least = n < 4 ? 2 : (n + 1) / 2;
    double sum = 0.0, runs = 0.0;
    for (size_t a = 0; a + least <= n; a++) {
        for (size_t length = least; a + length <= n; length++) {
            const lac_line run = lac_line_fit(length, &x[a], &y[a]);
            const double departure = lac_line_slope(&run) - lac_line_slope(line);
            sum += departure * departure;
            runs += 1.0;
        }
    }
    return sqrt(sum / runs);
}

// Linear least squares of a few columns by Householder reflections, without memory of its own.

static const double dependent = 1e-12;

// x -= 2 v (v.x) / (v.v)
static void reflect(size_t n, const double *v, double squares, double *x)
{
    lac_take_off(n, 2.0 * lac_vdot(n, v, x) / squares, v, x);
}

double lac_least_squares(size_t n, size_t k, double *columns, double *y, double *c)
{
    double corner[LAC_LEAST_SQUARES_MAX];        // diagonal of R; 0: the column is left out
    double squares[LAC_LEAST_SQUARES_MAX] = {0}; // of each reflection's vector
    for (size_t j = 0; j < k; j++) {
        double *v = columns + j * n;
        double whole = sqrt(lac_vdot(n, v, v));
        double rest = sqrt(lac_vdot(n - j, v + j, v + j));
        corner[j] = 0.0;
        if (!(rest > dependent * whole)) {
            continue;
        }
        corner[j] = v[j] > 0.0 ? -rest : rest;
        v[j] -= corner[j];
        squares[j] = lac_vdot(n - j, v + j, v + j);
        for (size_t l = j + 1; l < k; l++) {
            reflect(n - j, v + j, squares[j], columns + l * n + j);
        }
        reflect(n - j, v + j, squares[j], y + j);
    }
    for (size_t j = k; j-- > 0;) {
        double right = y[j];
        for (size_t l = j + 1; l < k; l++) {
            right -= columns[l * n + j] * c[l];
        }
        bool left_out = corner[j] == 0.0;
        c[j] = left_out ? 0.0 : right / corner[j];
        y[j] = left_out ? y[j] : 0.0;
    }
    for (size_t j = k; j-- > 0;) {
        if (corner[j] != 0.0) {
            reflect(n - j, columns + j * n + j, squares[j], y + j);
        }
    }
    return lac_vdot(n, y, y);
}
