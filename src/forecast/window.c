// SPDX-License-Identifier: GPL-3.0-or-later
// The readings that methods are fitted to, thinned where they are many.
#include "forecast/kinds.h"

enum { WINDOW_READINGS = 200, STEPS = 5 };

size_t lac_first_at(size_t n, const double *time, double start)
{
    size_t i = 0;
    while (i < n && time[i] < start) {
        i++;
    }
    return i;
}

// How many groups n readings make, and where group g begins: the first and the last are alone.
static size_t group_start(size_t n, size_t groups, size_t g)
{
    if (g == 0 || g >= groups) {
        return g == 0 ? 0 : n;
    }
    return 1 + (size_t)((double)(n - 2) * ((double)(g - 1) / (double)(groups - 2)) + 0.5);
}

static void take_group(const lac_motion *m, size_t first, size_t last, lac_window *w)
{
    const double count = (double)(last - first);
    const size_t k = w->n++;
    w->time[k] = 0.0;
    w->displacement[k] = 0.0;
    w->weight[k] = 0.0;
    for (size_t i = first; i < last; i++) {
        const double sigma = m->sigma[i] > 0.0 ? m->sigma[i] : m->noise;
        w->time[k] += (m->time[i] - w->now) / count;
        w->displacement[k] += m->displacement[i] / count;
        w->weight[k] += (sigma > 0.0 ? 1.0 / sigma : 1.0) / sqrt(count);
    }
}

// How often readings came of late: those of the motion, not their means.
static double step_of(size_t n, const double *time)
{
    double step[STEPS];
    size_t k = 0;
    for (; k < STEPS && k + 1 < n; k++) {
        step[k] = time[n - 1 - k] - time[n - 2 - k];
    }
    return k > 0 ? lac_median(k, step) : 0.0;
}

// Displacements count from the first; weights have a mean of 1, so that residuals stay metres. They
// are one over the error where the noise is known.
static void normalise(lac_window *w)
{
    double mean = 0.0;
    const size_t n = w->n;
    for (size_t i = n; i-- > 0;) {
        w->displacement[i] -= w->displacement[0];
        mean += w->weight[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        w->weight[i] /= mean;
    }
    w->error = w->noise > 0.0 ? 1.0 / mean : (double)NAN;
}

static void fill(const lac_motion *m, double start, lac_window *w)
{
    const size_t first = lac_first_at(m->n, m->time, start);
    const size_t n = m->n - first;
    const size_t groups = n > WINDOW_READINGS ? WINDOW_READINGS : n;
    for (size_t g = 0; g < groups; g++) {
        const bool all = groups == n;
        take_group(m, first + (all ? g : group_start(n, groups, g)),
                   first + (all ? g + 1 : group_start(n, groups, g + 1)), w);
    }
    if (n > 0) {
        normalise(w);
    }
    for (size_t i = lac_first_at(m->velocities, m->velocity_time, start); i < m->velocities; i++) {
        w->velocity_time[w->velocities] = m->velocity_time[i] - w->now;
        w->velocity_error[w->velocities] = m->velocity_error[i];
        w->velocity[w->velocities++] = m->velocity[i];
    }
}

lac_status lac_window_create(const lac_motion *m, double start, lac_window **out, lac_error *err)
{
    lac_window *w =
        calloc(1, sizeof *w + (3 * (WINDOW_READINGS + 1) + 3 * m->velocities) * sizeof *w->time);
    *out = w;
    LAC_FAIL_MEMORY_IF(w == NULL, err);
    *w = (lac_window){.start = start,
                      .noise = m->noise,
                      .error = NAN,
                      .resolution = m->resolution,
                      .integrated = m->integrated,
                      .time = (double *)(w + 1)};
    w->now = fmax(m->n > 0 ? m->time[m->n - 1] : -INFINITY,
                  m->velocities > 0 ? m->velocity_time[m->velocities - 1] : -INFINITY);
    w->step = m->n > 1 ? step_of(m->n, m->time) : step_of(m->velocities, m->velocity_time);
    w->displacement = w->time + WINDOW_READINGS + 1;
    w->weight = w->displacement + WINDOW_READINGS + 1;
    w->velocity_time = w->weight + WINDOW_READINGS + 1;
    w->velocity = w->velocity_time + m->velocities;
    w->velocity_error = w->velocity + m->velocities;
    fill(m, start, w);
    return LAC_OK;
}
