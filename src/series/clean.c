// SPDX-License-Identifier: GPL-3.0-or-later
// Readings that are none of the slope's motion: outliers are dropped, resets of the sensor taken
// out, each by what came before it and the reading after it.
#include "base/statistics.h"
#include "series/motion.h"

// In noises, unless said.
static const double outlier = 8.0, fall = 10.0;
static const double agree = 0.5;   // part of an outlier's distance
static const double lost = 0.2;    // part of the way so far that a reset takes back
static const double unusual = 2.5; // times the rise that nine of ten do not exceed

enum { BELIEVED = 10 }; // of so many readings one may be a reset

// Distance of reading i from the line between readings a and b; the noise of it is `scale` times
// that of a reading.
static double off_line(const lac_motion *m, size_t a, size_t i, size_t b, double *scale)
{
    const double w = (m->time[i] - m->time[a]) / (m->time[b] - m->time[a]);
    *scale = sqrt(1.0 + (1.0 - w) * (1.0 - w) + w * w);
    return m->displacement[i] - (1.0 - w) * m->displacement[a] - w * m->displacement[b];
}

// Whether reading i leaves the line between its neighbours, which agree with each other.
static bool is_outlier(const lac_motion *m, size_t before, size_t i)
{
    double scale;
    const double off = fabs(off_line(m, before, i, i + 1, &scale));
    const double step = fabs(m->displacement[i + 1] - m->displacement[before]);
    return off > outlier * scale * m->noise && step < agree * off;
}

// What nine of ten rises do not exceed: noise rises as often as it falls, a reset does not.
static double usual_rise(const lac_motion *m, double *work)
{
    size_t n = 0;
    for (size_t i = 1; i < m->n; i++) {
        const double step = m->displacement[i] - m->displacement[i - 1];
        if (step > 0.0) {
            work[n++] = step;
        }
    }
    qsort(work, n, sizeof *work, lac_by_first);
    return n > 0 ? lac_quantile(n, work, 0.9) : 0.0;
}

// The readings kept are 0 ... kept - 1; i comes next, and has been moved by `shift`.
static bool falls(const lac_motion *m, size_t kept, size_t i, double way, double shift,
                  double usual)
{
    const double back = m->displacement[kept - 1] - m->displacement[i];
    const double zero = fabs(m->displacement[i] - shift - m->displacement[0]);
    return kept >= 3 && back > fmax(fall * m->noise, unusual * usual) &&
           (back > lost * way || zero < fmax(fall * m->noise, usual));
}

// Whether the next reading falls as far once more: a slope that goes back, and no reset, after
// which it would go on.
static bool falls_on(const lac_motion *m, size_t i, double usual)
{
    return i + 1 < m->n &&
           m->displacement[i] - m->displacement[i + 1] > fmax(fall * m->noise, unusual * usual);
}

// What the slope would have reached by the time of reading i.
static double go_on(const lac_motion *m, size_t kept, size_t i)
{
    const double *t = m->time, *d = m->displacement;
    const double rate = (d[kept - 1] - d[kept - 2]) / (t[kept - 1] - t[kept - 2]);
    return d[kept - 1] + rate * (t[i] - t[kept - 1]);
}

static void keep(lac_motion *m, size_t at, size_t i)
{
    m->time[at] = m->time[i];
    m->displacement[at] = m->displacement[i];
    m->sigma[at] = m->sigma[i];
}

bool lac_motion_clean(lac_motion *m, double *work)
{
    const double usual = usual_rise(m, work);
    const size_t all = m->n;
    size_t kept = 0;
    double way = 0.0, shift = 0.0; // by which what follows a reset is moved
    bool back = false;             // the reading before went back, as a slope does
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
        const bool fell = kept > 0 && falls(m, kept, i, way, shift, usual);
        back = fell && (back || falls_on(m, i, usual));
        if (fell && !back) {
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
