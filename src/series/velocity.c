// SPDX-License-Identifier: GPL-3.0-or-later
// Velocities from displacements: secants, means, windows or polynomials; none looks ahead.
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "base/fail.h"
#include "base/least_squares.h"
#include "series/clean.h"

static void add(lac_motion *m, double time, double velocity, double rounding)
{
    m->rounding[m->velocities] = rounding + 4.0 * DBL_EPSILON * fabs(velocity);
    m->velocity_time[m->velocities] = time;
    m->velocity[m->velocities++] = velocity;
}

// Velocities of what falls are turned with it, speeds are not.
static void take_given(const lac_readings *r, lac_motion *m)
{
    double sum = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        sum += isnan(r->velocity[i]) ? 0.0 : r->velocity[i];
    }
    const double sign = m->falling && sum < 0.0 ? -1.0 : 1.0;
    for (size_t i = 0; i < r->n; i++) {
        if (!isnan(r->velocity[i])) {
            add(m, r->time[i], sign * r->velocity[i], r->velocity_digit);
        }
    }
}

// How far the last digits of two displacements, and the last bits of their times, move their
// secant.
static double secant_rounding(const lac_motion *m, size_t from, size_t to)
{
    const double *t = m->time;
    const double late = fmax(fabs(t[from]), fabs(t[to]));
    const double step = fabs(m->displacement[to] - m->displacement[from]);
    return (m->resolution + 2.0 * DBL_EPSILON * late * step / (t[to] - t[from])) /
           (t[to] - t[from]);
}

// v = (d_i - d_{i-1})/(t_i - t_{i-1}) at (t_i + t_{i-1})/2
static void take_secants(lac_motion *m)
{
    const double *t = m->time;
    for (size_t i = 1; i < m->n; i++) {
        add(m, t[i - 1] + 0.5 * (t[i] - t[i - 1]),
            (m->displacement[i] - m->displacement[i - 1]) / (t[i] - t[i - 1]),
            secant_rounding(m, i - 1, i));
    }
}

// Means of `points` velocities each, in place.
static void average(size_t points, lac_motion *m)
{
    const size_t before = points - 1;
    if (m->velocities < points) {
        m->velocities = 0;
        return;
    }
    for (size_t i = 0; i + before < m->velocities; i++) {
        double time = 0.0;
        double sum = 0.0;
        double squares = 0.0;
        for (size_t j = 0; j < points; j++) {
            time += m->velocity_time[i + j] - m->velocity_time[i];
            sum += m->velocity[i + j];
            squares += m->rounding[i + j] * m->rounding[i + j];
        }
        m->velocity_time[i] += time / (double)points;
        m->velocity[i] = sum / (double)points;
        m->rounding[i] = sqrt(squares) / (double)points;
    }
    m->velocities -= before;
}

// Slope of the readings first ... last at the mean of their times.
static void add_slope(lac_motion *m, size_t first, size_t last)
{
    const double *t = m->time + first;
    const double *d = m->displacement + first;
    const size_t n = last - first + 1;
    double mean = 0.0;
    double tt = 0.0;
    double td = 0.0;
    for (size_t i = 0; i < n; i++) {
        mean += (t[i] - t[0]) / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        const double x = t[i] - t[0] - mean;
        tt += x * x;
        td += x * (d[i] - d[0]);
    }
    add(m, t[0] + mean, td / tt, secant_rounding(m, first, last));
}

// Windows reach a whole `window` back, and hold two readings or more.
static void take_windows(double window, lac_motion *m)
{
    size_t first = 0;
    for (size_t i = 1; i < m->n; i++) {
        const double start = m->time[i] - window * (1.0 + 1e-9);
        for (; m->time[first] < start; first++) {
        }
        if (m->time[0] <= m->time[i] - window * (1.0 - 1e-9) && first < i) {
            add_slope(m, first, i);
        }
    }
}

// Slope at its last reading of the polynomial through `points` readings.
static lac_status take_polynomials(size_t points, size_t order, lac_motion *m, lac_error *err)
{
    const size_t k = order + 1;
    double c[LAC_LEAST_SQUARES_MAX];
    double *columns = malloc((k + 1) * points * sizeof *columns);
    LAC_FAIL_MEMORY_IF(columns == NULL, err);
    double *y = columns + k * points;
    for (size_t last = points - 1; last < m->n; last++) {
        const double *t = m->time + (last + 1 - points);
        const double span = t[points - 1] - t[0];
        for (size_t i = 0; i < points; i++) {
            double power = 1.0;
            for (size_t j = 0; j < k; j++, power *= (t[i] - t[points - 1]) / span) {
                columns[j * points + i] = power;
            }
            y[i] = m->displacement[last + 1 - points + i];
        }
        (void)lac_least_squares(points, k, columns, y, c);
        // |p'| <= 2 k^2 max|p|/span of a polynomial of order k (Markov)
        add(m, m->time[last], c[1] / span,
            (double)(order * order) * secant_rounding(m, last + 1 - points, last));
    }
    free(columns);
    return LAC_OK;
}

lac_status lac_motion_differentiate(const lac_motion_def *def, const lac_readings *readings,
                                    lac_motion *m, lac_error *err)
{
    const size_t most = readings->n > 0 ? readings->n : 1;
    m->velocity_time = malloc(most * sizeof *m->velocity_time);
    m->velocity = malloc(most * sizeof *m->velocity);
    m->rounding = malloc(most * sizeof *m->rounding);
    LAC_FAIL_MEMORY_IF(m->velocity_time == NULL || m->velocity == NULL || m->rounding == NULL, err);
    switch (def->smoothing) {
    case LAC_SMOOTH_WINDOW:
        take_windows(def->window, m);
        return LAC_OK;
    case LAC_SMOOTH_SAVGOL:
        return take_polynomials(def->points, def->order, m, err);
    case LAC_SMOOTH_NONE:
    case LAC_SMOOTH_AVERAGE:
        break;
    }
    if (readings->velocity != NULL) {
        take_given(readings, m);
    } else {
        take_secants(m);
    }
    if (def->smoothing == LAC_SMOOTH_AVERAGE) {
        average(def->points, m);
    }
    return LAC_OK;
}
