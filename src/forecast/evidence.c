// SPDX-License-Identifier: GPL-3.0-or-later
// How far the motion speaks for a law that ends in failure soon, against what looks like
// acceleration too and does not end so: a line, a step that relaxes, a rate that goes over to
// another as in a wet season.
#include "forecast/kinds.h"

enum { GROUPS = 96, LEAST = 6, LEAST_PART = 10, LEFT = 32, POWERS = 7, PLACES = 24, TIMES = 9 };
enum { MOST = PLACES * TIMES > LEFT *POWERS ? PLACES *TIMES : LEFT *POWERS };
static const double coarse = 1.0 / 15.0; // length of a group over its distance from now
static const double most_counts = 8.0;   // readings of a group that count as independent
static const double model = 1e-2;        // of the range: what no law need explain
static const double soon = 0.25;         // of the window: failures so near are what is asked for
static const double shorter = 1.0 / 3.0; // from one window to the next
static const double most_alike = 0.95;
static const double parameters = 4.0;
// of the rate on 1/(tc - t): Voight's alpha = 1 + 1/power from 3 to 1.3
static const double power[POWERS] = {0.5, 2.0 / 3.0, 1.0, 1.5, 2.0, 2.5, 10.0 / 3.0};

// The motion back from now, in means that reach the longer the longer ago they are.
typedef struct sample {
    size_t n;
    double t[GROUPS], y[GROUPS], weight[GROUPS];
    double even[GROUPS], steady[GROUPS]; // 1 and t, orthonormal by weight
    double squares, floor;               // of y off a line; what is never explained
    double step;                         // the last interval [s]
} sample;

// Curves of one kind: what each leaves unexplained, and the residuals of the best.
typedef struct family {
    size_t count;
    double best, rest[MOST], residual[GROUPS];
} family;

static void take(const lac_motion *m, size_t n, sample *s)
{
    const double now = m->time[n - 1];
    size_t i = n;
    s->n = 0;
    s->step = now - m->time[n - 2];
    while (i > 0 && s->n < GROUPS) {
        const double newest = now - m->time[i - 1];
        const size_t g = s->n++;
        double count = 0.0, t = 0.0, y = 0.0;
        for (; i > 0 && (count == 0.0 || now - m->time[i - 1] <= (1.0 + coarse) * newest); i--) {
            count += 1.0;
            t += now - m->time[i - 1];
            y += m->displacement[i - 1] - m->displacement[n - 1];
        }
        s->t[g] = t / count;
        s->y[g] = y / count;
        s->weight[g] = fmin(count, most_counts);
    }
}

static double product(const sample *s, const double *x, const double *y)
{
    double sum = 0.0;
    for (size_t i = 0; i < s->n; i++) {
        sum += s->weight[i] * x[i] * y[i];
    }
    return sum;
}

// Takes the line out of x.
static void level(const sample *s, double *x)
{
    lac_take_off(s->n, product(s, x, s->even), s->even, x);
    lac_take_off(s->n, product(s, x, s->steady), s->steady, x);
}

// The part of a sample that lies within `span` before now, ready for curves.
static void cut(const sample *all, double span, double resolution, sample *s)
{
    double low = INFINITY, high = -INFINITY;
    *s = *all;
    for (s->n = 0; s->n < all->n && all->t[s->n] <= span; s->n++) {
        low = fmin(low, all->y[s->n]);
        high = fmax(high, all->y[s->n]);
    }
    const double one = 1.0 / sqrt(lac_sum(s->n, s->weight));
    for (size_t g = 0; g < s->n; g++) {
        s->even[g] = one;
        s->steady[g] = s->t[g];
    }
    lac_take_off(s->n, product(s, s->steady, s->even), s->even, s->steady);
    const double length = sqrt(product(s, s->steady, s->steady));
    for (size_t g = 0; g < s->n; g++) {
        s->steady[g] /= length;
    }
    level(s, s->y);
    s->squares = product(s, s->y, s->y);
    s->floor = (double)s->n *
               fmax(model * model * (high - low) * (high - low), resolution * resolution / 12.0);
}

// A curve over the groups, which must rise; where it falls the line is as good.
static void add(const sample *s, double *x, family *f)
{
    level(s, x);
    const double xx = product(s, x, x);
    const double c = xx > 0.0 ? fmax(0.0, product(s, x, s->y) / xx) : 0.0;
    const double rest = fmax(0.0, s->squares - c * c * xx) + s->floor;
    if (f->count == 0 || rest < f->best) {
        f->best = rest;
        for (size_t i = 0; i < s->n; i++) {
            f->residual[i] = s->y[i] - c * x[i];
        }
    }
    f->rest[f->count++] = rest;
}

// Voight's law: rates (left + t)^-power, t back from now.
static void add_laws(const sample *s, double span, family *f)
{
    const double first = 0.3 * s->step, last = soon * span;
    double x[GROUPS];
    for (size_t k = 0; k < LEFT; k++) {
        const double left = first * pow(last / first, ((double)k + 0.5) / (double)LEFT);
        for (size_t j = 0; j < POWERS; j++) {
            for (size_t i = 0; i < s->n; i++) {
                const double l = log1p(s->t[i] / left);
                x[i] = power[j] == 1.0 ? -l : expm1((1.0 - power[j]) * l) / (power[j] - 1.0);
            }
            add(s, x, f);
        }
    }
}

static double relaxing(double since, double time)
{
    return since > 0.0 ? -expm1(-since / time) : 0.0;
}

// A rate that goes over to another.
static double passing(double since, double time)
{
    const double u = since / time;
    return u > 30.0 ? u : log1p(exp(u));
}

static void add_changes(const sample *s, double span, double (*curve)(double, double), family *f)
{
    const double first = 0.2 * s->step;
    double x[GROUPS];
    for (size_t k = 0; k < PLACES; k++) {
        const double place = first * pow(span / first, (double)k / (double)PLACES);
        for (size_t j = 0; j < TIMES; j++) {
            const double time = first * pow(span / first, (double)j / (double)(TIMES - 1));
            for (size_t i = 0; i < s->n; i++) {
                x[i] = curve(place - s->t[i], time);
            }
            add(s, x, f);
        }
    }
}

static void add_line(const sample *s, family *f)
{
    double x[GROUPS] = {0.0};
    add(s, x, f);
}

// ln of the family's mean likelihood over that of `least`; errors of unknown size integrated out.
static double likelihood(const family *f, double half, double least)
{
    double sum = 0.0;
    for (size_t k = 0; k < f->count; k++) {
        sum += exp(-half * log(f->rest[k] / least));
    }
    return log(sum / (double)f->count);
}

// Half the number of residuals, as many as independent ones would tell.
static double half_count(const sample *s, const double *residual)
{
    const double alike = lac_alike(s->n, residual, s->floor, 0.0, most_alike);
    return 0.5 * fmax(0.0, (double)s->n * (1.0 - alike) / (1.0 + alike) - parameters);
}

// ln odds over the strongest of what does not fail, in one window.
static double weigh(const sample *s)
{
    enum { RIVALS = 3 };
    const double span = s->t[s->n - 1];
    family law = {0}, rival[RIVALS] = {{0}};
    add_laws(s, span, &law);
    add_line(s, &rival[0]);
    add_changes(s, span, relaxing, &rival[1]);
    add_changes(s, span, passing, &rival[2]);
    const family *best = &law;
    for (size_t k = 0; k < RIVALS; k++) {
        best = rival[k].best < best->best ? &rival[k] : best;
    }
    const double half = half_count(s, best->residual), least = best->best;
    double odds = INFINITY;
    for (size_t k = 0; k < RIVALS; k++) {
        odds = fmin(odds, likelihood(&law, half, least) - likelihood(&rival[k], half, least));
    }
    return odds;
}

double lac_evidence_find(const lac_motion *motion, size_t n)
{
    double most = NAN;
    sample all, s;
    if (n < LEAST) {
        return NAN;
    }
    take(motion, n, &all);
    const double whole = all.t[all.n - 1];
    for (double span = whole; span > 0.0; span *= shorter) {
        cut(&all, span, motion->resolution, &s);
        if (s.n < (span == whole ? LEAST : LEAST_PART)) {
            break;
        }
        most = fmax(most, weigh(&s)); // passes NaN over
    }
    return most;
}
