// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the slope goes much faster, either way, than it ever mostly did: a rate that has changed
// at once is no trend, so that the longer it lasts the less a test of trends sees of it.
#include "forecast/kinds.h"

enum {
    LEAST = 5,    // readings before the window
    ENOUGH = 256, // rates before it tell what is usual
    SPACED = 4,   // rates before it that are looked at begin this part of a half apart
    WINDOW = 2000 // readings that are looked at, no more
};
static const double clear = 5.0;     // errors by which the rate is off that before
static const double as_much = 0.7;   // of a shorter window's factor: the longer one is told
static const double normal = 1.4826; // standard deviations of a normal in its median deviation

static double rate_to(const lac_motion *m, size_t i, size_t h)
{
    return (m->displacement[i] - m->displacement[i - h]) / (m->time[i] - m->time[i - h]);
}

// Median rate over h intervals before reading `end`, and how far rates mostly are from it.
static double usual_rate(const lac_motion *m, size_t first, size_t end, size_t h, double *spread)
{
    double rate[2 * ENOUGH];
    const size_t least = h > SPACED ? h / SPACED : 1, few = (end - first) / ENOUGH;
    const size_t step = least > few ? least : few;
    size_t n = 0;
    for (size_t i = end; i >= first + h && n < 2 * ENOUGH; i -= step) {
        rate[n++] = rate_to(m, i, h);
        if (i < step) {
            break;
        }
    }
    const double usual = lac_median(n, rate);
    for (size_t k = 0; k < n; k++) {
        rate[k] = fabs(rate[k] - usual);
    }
    *spread = normal * lac_median(n, rate);
    return usual;
}

// Over the last 2h intervals: the slower half counts, so that no one bad reading, and no one jump,
// makes it.
static lac_surge look(const lac_motion *m, size_t first, size_t h)
{
    const size_t last = m->n - 1, middle = last - h, start = middle - h;
    const double halves[] = {rate_to(m, middle, h), rate_to(m, last, h)};
    const double shorter = fmin(m->time[last] - m->time[middle], m->time[middle] - m->time[start]);
    const double slower = fabs(halves[0]) < fabs(halves[1]) ? halves[0] : halves[1];
    double spread = 0.0;
    const double usual = usual_rate(m, first, start, h, &spread);
    const double error = fmax(spread, sqrt(2.0) * m->noise / shorter);
    lac_surge s = {.factor = 1.0, .rate = slower, .before = usual, .since = m->time[start]};
    if (halves[0] * halves[1] > 0.0 && fabs(slower - usual) > clear * error) {
        s.factor = fabs(slower) / fmax(fabs(usual), error / clear);
    }
    return s;
}

lac_surge lac_surge_find(const lac_motion *m)
{
    lac_surge most = {.factor = 1.0, .rate = NAN, .before = NAN, .since = NAN};
    const size_t first = m->n > WINDOW ? m->n - WINDOW : 0;
    if (!(m->noise > 0.0)) {
        return most;
    }
    for (size_t h = 1; first + 3 * h + LEAST < m->n; h *= 2) {
        const lac_surge s = look(m, first, h);
        most = s.factor > 1.0 && s.factor > as_much * most.factor ? s : most;
    }
    return most;
}
