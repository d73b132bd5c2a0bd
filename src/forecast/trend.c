// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the rate of a slope rises: a robust parabola over windows that all end now, the chance
// that its bend is noise, and what to say where noise forbids an answer.
#include <gsl/gsl_cdf.h>

#include "forecast/kinds.h"

enum { LEAST = 6, GROUPS = 48, HUBER_STEPS = 3, TERMS = 3, WINDOWS = 64 };
static const double huber = 1.345;     // standard deviations (Huber 1964: 95 % efficient)
static const double normal = 1.4826;   // standard deviation over the median distance
static const double longer = 1.5;      // from one window to the next
static const double model = 0.01;      // of a window's range: what a parabola need not explain
static const double own_noise = 0.5;   // of the motion's: what residuals count at least
static const double most_alike = 0.95; // neighbouring residuals
static const double sure = 0.01;       // p of "yes"
static const double hint = 0.05;       // p below which "no" is not said
static const double as_clear = 0.7;    // of the clearest window: the longest such is taken
static const double noticed = 0.5;     // rise of the rate over its mean that "no" excludes
static const double missed = 0.05;     // chance that "no" is said of such a rise

// How a rate may rise over a window, of displacements and of velocities.
typedef struct shape {
    double (*moved)(double t), (*rate)(double t); // t from -1 to 1
} shape;

static double square(double t) { return t * t; }
static double straight(double t) { return 2.0 * t; }
// of a failure a tenth of the window after its end
static double late(double t) { return -log(1.2 - t); }
static double late_rate(double t) { return 1.0 / (1.2 - t); }

static const shape shapes[] = {{square, straight}, {late, late_rate}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

// Means of consecutive readings of a window, times from -1 to 1.
typedef struct sample {
    const shape *bent;
    size_t n, terms;                // groups; columns
    double half, first;             // of the window's length [s]; its first value
    double t[GROUPS], x[GROUPS];    // x from the first reading
    double weight[GROUPS];          // as many as readings of the usual noise
    double trust[GROUPS];           // Huber's weight
    double column[TERMS][GROUPS];   // orthogonal and of length 1, by weight and trust
    double length[TERMS], c[TERMS]; // of each column before that; coefficient of it
    double residual[GROUPS], floor; // variance that those of weight 1 have at least
} sample;

// What the polynomial tells.
typedef struct bend {
    double rise, error, rate; // of the rate over the window, and its mean [m/s]
    double p, hidden;         // rise that noise may hide in one of the windows [m/s]
    double z;                 // least over the deletion of any one group
} bend;

// Displacements, or velocities where these were read.
typedef struct readings {
    size_t n;
    const double *time, *value;
    double digit, noise; // NaN: not known
    const double *sigma; // NULL: none
} readings;

static readings readings_of(const lac_motion *m)
{
    return m->integrated
               ? (readings){.n = m->velocities,
                            .time = m->velocity_time,
                            .value = m->velocity,
                            .digit = m->velocities > 0 ? m->rounding[m->velocities - 1] : 0.0,
                            .noise = NAN}
               : (readings){.n = m->n,
                            .time = m->time,
                            .value = m->displacement,
                            .digit = m->resolution,
                            .noise = m->noise,
                            .sigma = m->sigma};
}

static double weight_of(const readings *r, size_t i)
{
    const double ratio = r->sigma != NULL && r->sigma[i] > 0.0 ? r->noise / r->sigma[i] : 1.0;
    return ratio > 0.0 ? ratio * ratio : 1.0;
}

static void take(const readings *r, size_t first, size_t terms, sample *s)
{
    const double *time = r->time + first, *value = r->value + first;
    const size_t n = r->n - first;
    double low = 0.0, high = 0.0;
    s->n = n < GROUPS ? n : GROUPS;
    s->terms = terms;
    s->half = 0.5 * (time[n - 1] - time[0]);
    s->first = value[0];
    for (size_t g = 0; g < s->n; g++) {
        s->weight[g] = s->t[g] = s->x[g] = 0.0;
        s->trust[g] = 1.0;
        for (size_t i = g * n / s->n; i < (g + 1) * n / s->n; i++) {
            const double w = weight_of(r, first + i);
            const double x = value[i] - value[0];
            s->weight[g] += w;
            s->t[g] += w * ((time[i] - time[0]) / s->half - 1.0);
            s->x[g] += w * x;
            low = fmin(low, x);
            high = fmax(high, x);
        }
        s->t[g] /= s->weight[g];
        s->x[g] /= s->weight[g];
    }
    const double off = model * (high - low);
    s->floor = fmax(r->digit * r->digit / 12.0, off * off);
    s->floor =
        r->noise > 0.0 ? fmax(s->floor, own_noise * own_noise * r->noise * r->noise) : s->floor;
}

static double product(const sample *s, const double *x, const double *y)
{
    double sum = 0.0;
    for (size_t g = 0; g < s->n; g++) {
        sum += s->weight[g] * s->trust[g] * x[g] * y[g];
    }
    return sum;
}

// Weighted least squares, by columns that are orthogonal. @return whether all of them count
static bool fit(sample *s)
{
    double (*const last)(double) = s->terms == 2 ? s->bent->rate : s->bent->moved;
    memcpy(s->residual, s->x, s->n * sizeof *s->x);
    for (size_t j = 0; j < s->terms; j++) {
        double *q = s->column[j];
        for (size_t g = 0; g < s->n; g++) {
            q[g] = j + 1 == s->terms ? last(s->t[g]) : j == 0 ? 1.0 : s->t[g];
        }
        for (size_t i = 0; i < j; i++) {
            const double along = product(s, q, s->column[i]);
            for (size_t g = 0; g < s->n; g++) {
                q[g] -= along * s->column[i][g];
            }
        }
        s->length[j] = sqrt(product(s, q, q));
        if (!(s->length[j] > 1e-12)) {
            return false;
        }
        for (size_t g = 0; g < s->n; g++) {
            q[g] /= s->length[j];
        }
        s->c[j] = product(s, q, s->residual);
        for (size_t g = 0; g < s->n; g++) {
            s->residual[g] -= s->c[j] * q[g];
        }
    }
    return true;
}

static void trust(sample *s)
{
    double off[GROUPS];
    for (size_t g = 0; g < s->n; g++) {
        off[g] = fabs(s->residual[g]) * sqrt(s->weight[g]);
    }
    const double scale = fmax(normal * lac_median(s->n, off), sqrt(s->floor));
    for (size_t g = 0; g < s->n; g++) {
        const double far = fabs(s->residual[g]) * sqrt(s->weight[g]);
        s->trust[g] = far > huber * scale ? huber * scale / far : 1.0;
    }
}

// First-order autocorrelation of the residuals, from 0; what is below the floor does not count.
static double alike(const sample *s)
{
    double square = (double)s->n * s->floor, product_of = 0.0, before = 0.0;
    for (size_t g = 0; g < s->n; g++) {
        const double off = s->residual[g] * sqrt(s->weight[g] * s->trust[g]);
        square += off * off;
        product_of += off * before;
        before = off;
    }
    return square > 0.0 ? fmin(most_alike, fmax(0.0, product_of / square)) : 0.0;
}

// Variance of a group of weight 1; `out` of the squares is that of a group left out.
static double variance(const sample *s, double squares, double freedom, double out)
{
    return fmax((squares - out) / fmax(1.0, freedom), s->floor);
}

static void judge(const sample *s, size_t windows, bend *b)
{
    const size_t last = s->terms - 1;
    const double *e = s->column[last];
    const double r = alike(s), widened = (1.0 + r) / (1.0 - r);
    const double freedom = (double)(s->n - s->terms);
    const double kept = lac_sum(s->n, s->trust) / (double)s->n;
    double squares = 0.0, least = INFINITY;
    for (size_t g = 0; g < s->n; g++) {
        squares += s->weight[g] * s->trust[g] * s->trust[g] * s->residual[g] * s->residual[g] /
                   (kept * kept);
    }
    for (size_t g = 0; g < s->n; g++) {
        const double w = s->weight[g] * s->trust[g];
        double lever = 0.0;
        for (size_t j = 0; j < s->terms; j++) {
            lever += w * s->column[j][g] * s->column[j][g];
        }
        const double rest = fmax(1e-9, 1.0 - lever);
        const double c = s->c[last] - w * e[g] * s->residual[g] / rest;
        const double spread = 1.0 + w * e[g] * e[g] / rest;
        const double out = w * s->residual[g] * s->residual[g] / rest;
        least = fmin(least, c / sqrt(spread * widened * variance(s, squares, freedom - 1.0, out)));
    }
    const double whole = s->bent->rate(1.0) - s->bent->rate(-1.0);
    const double scale = whole / (last == 2 ? s->half : 1.0) / s->length[last];
    b->rise = scale * s->c[last];
    b->error = scale * sqrt(widened * variance(s, squares, freedom, 0.0));
    b->rate = s->c[last - 1] / s->length[last - 1];
    b->rate = last == 2 ? b->rate / s->half : b->rate + s->first;
    b->z = least;
    const double spare = (double)s->n / widened - (double)s->terms;
    b->p = fmin(1.0, (double)windows * gsl_cdf_tdist_Q(least, fmax(1.0, spare - 1.0)));
    b->hidden = b->error * gsl_cdf_tdist_Qinv(missed * SHAPES / (double)windows, fmax(1.0, spare));
}

// @return whether the window tells anything
static bool look(const readings *r, size_t first, size_t terms, size_t windows, bend *b)
{
    sample s;
    bool found = false;
    take(r, first, terms, &s);
    for (size_t k = 0; k < SHAPES && s.half > 0.0; k++) {
        bend one;
        s.bent = &shapes[k];
        bool fits = fit(&s);
        for (int i = 0; i < HUBER_STEPS && fits; i++) {
            trust(&s);
            fits = fit(&s);
        }
        if (fits) {
            judge(&s, SHAPES * windows, &one);
            if (isfinite(one.z) && isfinite(one.error) && (!found || one.z > b->z)) {
                *b = one;
                found = true;
            }
        }
        for (size_t g = 0; g < s.n; g++) {
            s.trust[g] = 1.0;
        }
    }
    return found;
}

static size_t next_window(size_t n, size_t all)
{
    const size_t next = (size_t)ceil(longer * (double)n);
    return n == all ? all + 1 : next < all ? next : all;
}

// What noise hides in the window that sees best, and how many more readings would show it.
static void explain(const readings *r, size_t n, const bend *b, lac_trend *out)
{
    const double days = (r->time[r->n - 1] - r->time[r->n - n]) / 86400.0;
    const double to_mm_day = 1e3 * 86400.0;
    (void)snprintf(
        out->reason, sizeof out->reason,
        "over the last %zu readings (%.3g days) a rise of the rate by less than %.3g mm/day "
        "would not be seen in the noise; the mean rate is %.3g mm/day",
        n, days, to_mm_day * b->hidden, to_mm_day * b->rate);
    const double more = (double)n * (cbrt(pow(b->hidden / (noticed * b->rate), 2.0)) - 1.0);
    if (b->rate > 0.0 && more >= 0.5 && more < 1000.0) {
        lac_append(out->reason, sizeof out->reason,
                   "; some %.0f more readings would show whether it rises by half", ceil(more));
    }
}

static double upper_rise(const bend *b) { return (b->rise + b->hidden) / fabs(b->rate); }

// What all windows tell, shortest first.
typedef struct windows {
    size_t count, size[WINDOWS];
    bend found[WINDOWS];
} windows;

static windows look_back(const readings *r, size_t terms)
{
    windows w = {0};
    size_t all = 0;
    for (size_t n = LEAST; n <= r->n; n = next_window(n, r->n)) {
        all++;
    }
    for (size_t n = LEAST; n <= r->n && w.count < WINDOWS; n = next_window(n, r->n)) {
        if (look(r, r->n - n, terms, all, &w.found[w.count])) {
            w.size[w.count++] = n;
        }
    }
    return w;
}

static void answer(const readings *r, const windows *w, lac_trend *out)
{
    const bend *found = w->found;
    size_t best = 0, widest = w->count - 1, chosen;
    for (size_t k = 0; k < w->count; k++) {
        best = found[k].p < found[best].p ? k : best;
        widest = upper_rise(&found[k]) < upper_rise(&found[widest]) ? k : widest;
    }
    chosen = best;
    if (found[best].p < sure) {
        out->answer = LAC_DOES;
        for (size_t k = best; k < w->count; k++) {
            const bool clear = found[k].z >= as_clear * found[best].z && found[k].p < sure;
            chosen = clear ? k : chosen;
        }
    } else if (found[best].p >= hint && found[widest].rate > 0.0 &&
               upper_rise(&found[widest]) < noticed) {
        out->answer = LAC_DOES_NOT;
        chosen = widest;
    } else {
        explain(r, w->size[widest], &found[widest], out);
    }
    out->p = found[best].p;
    out->n = w->size[chosen];
    out->start = r->time[r->n - out->n];
    out->rate = found[chosen].rate;
    out->rise = found[chosen].rise;
    out->error = found[chosen].error;
}

lac_trend lac_trend_find(const lac_motion *motion)
{
    const readings r = readings_of(motion);
    lac_trend out = {.p = NAN, .start = NAN, .rate = NAN, .rise = NAN, .error = NAN};
    const windows w = look_back(&r, motion->integrated ? 2 : 3);
    if (w.count > 0) {
        answer(&r, &w, &out);
    } else if (r.n < LEAST) {
        (void)snprintf(out.reason, sizeof out.reason, "too few readings: %zu, at least %d", r.n,
                       (int)LEAST);
    } else {
        (void)snprintf(out.reason, sizeof out.reason, "all readings are of one time");
    }
    return out;
}
