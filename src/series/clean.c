// SPDX-License-Identifier: GPL-3.0-or-later
// What monitoring series suffer from, found with the past alone: whoever passes readings up to the
// present gets what could be known then.
#include <math.h>

#include "base/statistics.h"
#include "series/clean.h"

// In noises, unless said.
static const double gap = 5.0; // median intervals
static const double outlier = 8.0, fall = 10.0;
static const double agree = 0.5;     // part of an outlier's distance
static const double lost = 0.2;      // part of the way so far that a reset takes back
static const double normal = 1.4826; // standard deviation over the median distance
static const double step_counts = 5.0, error_counts = 3.0, walk_counts = 2.0;

enum { BELIEVED = 20 }; // of so many readings one may be a reset

// Distance of reading i from the line between readings a and b; the noise of it is `scale` times
// that of a reading.
static double off_line(const lac_motion *m, size_t a, size_t i, size_t b, double *scale)
{
    const double w = (m->time[i] - m->time[a]) / (m->time[b] - m->time[a]);
    *scale = sqrt(1.0 + (1.0 - w) * (1.0 - w) + w * w);
    return m->displacement[i] - (1.0 - w) * m->displacement[a] - w * m->displacement[b];
}

static double find_noise(const lac_motion *m, double *work)
{
    size_t n = 0;
    for (size_t i = 0; i < m->n; i++) {
        if (!isnan(m->sigma[i])) {
            work[n++] = m->sigma[i];
        }
    }
    if (n > 0) {
        return lac_median(n, work);
    }
    for (size_t i = 1; i + 1 < m->n && !m->integrated; i++) {
        double scale;
        double off = off_line(m, i - 1, i, i + 1, &scale);
        work[n++] = fabs(off) / scale;
    }
    return normal * lac_median(n, work);
}

void lac_motion_measure(lac_motion *m, double *work)
{
    m->noise = find_noise(m, work);
    m->noise = m->noise < m->resolution ? m->resolution : m->noise;
    for (size_t i = 1; i < m->n; i++) {
        work[i - 1] = m->time[i] - m->time[i - 1];
    }
    m->interval = m->n > 1 ? lac_median(m->n - 1, work) : NAN;
    m->longest_gap = m->n > 1 ? work[m->n - 2] : NAN;
    for (size_t i = 1; i < m->n; i++) {
        m->gaps += work[i - 1] > gap * m->interval ? 1 : 0;
    }
}

// Steps count at most some median ones, so that a reset is no more than a few of them. Errors of
// displacements cancel in their sum but for the first and the last; those of integrated velocities
// add up as a random walk does.
bool lac_motion_falls(const lac_motion *m, double *work)
{
    size_t n = 0;
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 1; i < m->n; i++) {
        const double step = fabs(m->displacement[i] - m->displacement[i - 1]);
        if (step > 0.0) {
            work[n++] = step;
        }
    }
    const double most = n > 0 ? step_counts * lac_median(n, work) : 0.0;
    for (size_t i = 1; i < m->n; i++) {
        const double step = m->displacement[i] - m->displacement[i - 1];
        const double counted = fmin(most, fmax(-most, step));
        sum += counted;
        squares += counted / most * (counted / most);
    }
    return sum < -(m->integrated ? walk_counts * most * sqrt(squares)
                                 : error_counts * sqrt(2.0) * m->noise);
}

// Whether reading i leaves the line between its neighbours, which agree with each other.
static bool is_outlier(const lac_motion *m, size_t before, size_t i)
{
    double scale;
    const double off = fabs(off_line(m, before, i, i + 1, &scale));
    const double step = fabs(m->displacement[i + 1] - m->displacement[before]);
    return off > outlier * scale * m->noise && step < agree * off;
}

// The readings kept are 0 ... kept - 1; i comes next.
static bool falls(const lac_motion *m, size_t kept, size_t i, double way)
{
    const double back = m->displacement[kept - 1] - m->displacement[i];
    return kept >= 3 && back > fall * m->noise && back > lost * way;
}

// What the slope would have reached by the time of reading i.
static double go_on(const lac_motion *m, size_t kept, size_t i)
{
    const double *t = m->time;
    const double *d = m->displacement;
    const double rate = (d[kept - 1] - d[kept - 2]) / (t[kept - 1] - t[kept - 2]);
    return d[kept - 1] + rate * (t[i] - t[kept - 1]);
}

static void keep(lac_motion *m, size_t at, size_t i)
{
    m->time[at] = m->time[i];
    m->displacement[at] = m->displacement[i];
    m->sigma[at] = m->sigma[i];
}

bool lac_motion_clean(lac_motion *m)
{
    const size_t all = m->n;
    size_t kept = 0;
    double way = 0.0;
    double shift = 0.0; // by which what follows a reset is moved
    if (!(m->noise > 0.0)) {
        return true;
    }
    for (size_t i = 0; i < m->n; i++) {
        const bool last = i + 1 == m->n;
        if (!last) {
            m->displacement[i + 1] += shift;
        }
        if (kept > 0 && !last && is_outlier(m, kept - 1, i)) {
            m->outliers++;
            continue;
        }
        if (kept > 0 && falls(m, kept, i, way)) {
            if (last) { // a reset or an outlier: the next reading will tell
                m->outliers++;
                continue;
            }
            const double offset = go_on(m, kept, i) - m->displacement[i];
            m->displacement[i] += offset;
            m->displacement[i + 1] += offset;
            shift += offset;
            m->resets++;
        }
        keep(m, kept++, i);
        way = fmax(way, m->displacement[kept - 1] - m->displacement[0]);
    }
    m->n = kept;
    return m->resets <= 1 || BELIEVED * m->resets <= all;
}
