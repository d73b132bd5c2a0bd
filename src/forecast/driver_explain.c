// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a driver explains a slope's rate: the best of many ways of answering to it, held against
// the best with the driver rotated in time, which keeps what each is like by itself; and whether
// the rate without the driver's part still rises.
#include "base/statistics.h"
#include "forecast/driver_response.h"

enum {
    MOST = 200,  // intervals that are compared
    FEWEST = 40, // for want of less noise
    BASE = 3,    // columns that stand for what the rate does by itself
    ROUNDS = 20, // of reweighting
    CLOSER = 2,  // searches, each seven times closer
    RISES = 4,   // shapes of an acceleration: a line, and hyperbolas
    END = 3,     // of so many last intervals one must be known
};
static const double fits_well = 0.25; // share of the rate that is not said to be unexplained
static const double known_enough = 0.8, noise_part = 0.5, normal = 1.4826;
static const double clipped = 6.0, huber = 1.345; // in normal deviations
static const double covered = 0.5;                // part of the record that must be known
static const double told = 2.5;                   // errors of a rise that is there
static const double bound = 1.6448536269514722, explained = 0.5;
static const double flat = 1e-9, most_alike = 0.95;
// A hyperbola's singularity is so much of the record behind its end.
static const double behind[RISES] = {INFINITY, 0.3, 0.1, 0.03};

// The rate over intervals of which the driver is known.
typedef struct record {
    const lac_motion *motion;
    size_t n;
    double first, length;
    double from[MOST], to[MOST]; // [s]
    double rate[MOST], weight[MOST];
    double base[BASE][MOST]; // orthonormal, weighted
    double rest[MOST];       // clipped rate off them, weighted
    double squares;          // of rest
    lac_answer answer;       // the best
} record;

static void take_rates(const lac_motion *m, const lac_driver_grid *grid, size_t groups, record *r)
{
    const size_t steps = m->n - 1;
    r->n = 0;
    for (size_t k = 0; k < groups; k++) {
        const size_t i = k * steps / groups, j = (k + 1) * steps / groups;
        if (lac_driver_known(grid, m->time[i], m->time[j]) >= known_enough) {
            r->from[r->n] = m->time[i];
            r->to[r->n] = m->time[j];
            r->rate[r->n++] = (m->displacement[j] - m->displacement[i]) / (m->time[j] - m->time[i]);
        }
    }
}

static double rise(const record *r, size_t shape, size_t i)
{
    const double x = (0.5 * (r->from[i] + r->to[i]) - r->first) / r->length;
    return isinf(behind[shape]) ? x : 1.0 / (1.0 + behind[shape] - x);
}

static double median_distance(size_t n, const double *x, double *centre)
{
    double work[MOST];
    memcpy(work, x, n * sizeof *x);
    *centre = lac_median(n, work);
    for (size_t i = 0; i < n; i++) {
        work[i] = fabs(x[i] - *centre);
    }
    return normal * lac_median(n, work);
}

static double error_of(const lac_motion *m, double length)
{
    return m->noise > 0.0 ? sqrt(2.0) * m->noise / length : 0.0;
}

// Groups are of one interval, or of as many as MOST of them ask for; and of more while most of
// what their rates scatter by is the noise of the readings and FEWEST remain.
static void group(const lac_motion *m, const lac_driver_grid *grid, record *r)
{
    size_t groups = m->n - 1 < MOST ? m->n - 1 : MOST;
    bool noisy = true;
    take_rates(m, grid, groups, r);
    while (noisy && groups / 2 >= FEWEST && r->n > 0) {
        double centre;
        const double spread = median_distance(r->n, r->rate, &centre);
        noisy = error_of(m, r->length / (double)groups) > noise_part * spread;
        if (noisy) {
            groups /= 2;
            take_rates(m, grid, groups, r);
        }
    }
}

// Takes orthonormal columns off one.
static void take_off(size_t n, size_t columns, const double (*base)[MOST], double *x)
{
    for (size_t c = 0; c < columns; c++) {
        lac_take_off(n, lac_dot(n, base[c], x), base[c], x);
    }
}

// A constant, a line and the hyperbola of that shape, and what they leave of the rate.
static void set_base(record *r, size_t shape, const double *clip)
{
    for (size_t c = 0; c < BASE; c++) {
        for (size_t i = 0; i < r->n; i++) {
            r->base[c][i] = r->weight[i] * (c == 0 ? 1.0 : rise(r, c == 1 ? 0 : shape, i));
        }
        take_off(r->n, c, (const double(*)[MOST])r->base, r->base[c]);
        take_off(r->n, c, (const double(*)[MOST])r->base, r->base[c]);
        const double size = sqrt(lac_dot(r->n, r->base[c], r->base[c]));
        for (size_t i = 0; i < r->n; i++) {
            r->base[c][i] = size > flat ? r->base[c][i] / size : 0.0;
        }
    }
    for (size_t i = 0; i < r->n; i++) {
        r->rest[i] = r->weight[i] * clip[i];
    }
    take_off(r->n, BASE, (const double(*)[MOST])r->base, r->rest);
    r->squares = lac_dot(r->n, r->rest, r->rest);
}

// Weights are of rates that scatter by themselves and by the noise of two readings; a rate far off
// all others counts no more than one at some distance. The hyperbola is the one that leaves least.
// @return false: there is nothing to explain
static bool prepare(record *r)
{
    double clip[MOST], centre, largest = 0.0;
    const double spread = median_distance(r->n, r->rate, &centre);
    const double least_spread = fmax(spread, flat * fabs(centre));
    for (size_t i = 0; i < r->n; i++) {
        const double error = error_of(r->motion, r->to[i] - r->from[i]);
        const double far = spread > 0.0 ? clipped * hypot(spread, error) : INFINITY;
        clip[i] = centre + fmin(far, fmax(-far, r->rate[i] - centre));
        r->weight[i] = least_spread > 0.0 ? least_spread / hypot(least_spread, error) : 1.0;
        largest = fmax(largest, fabs(clip[i]));
    }
    size_t best = 1;
    double least = INFINITY;
    for (size_t shape = 1; shape < RISES; shape++) {
        set_base(r, shape, clip);
        best = r->squares < least ? shape : best;
        least = fmin(least, r->squares);
    }
    set_base(r, best, clip);
    return r->squares > flat * flat * largest * largest * (double)r->n;
}

// The part of what is left of the rate that an answer explains.
static double score(const record *r, double *mean)
{
    double whole = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        mean[i] *= r->weight[i];
        whole += mean[i] * mean[i];
    }
    take_off(r->n, BASE, (const double(*)[MOST])r->base, mean);
    const double own = lac_dot(r->n, mean, mean), both = lac_dot(r->n, mean, r->rest);
    return own > flat * whole ? both * both / (own * r->squares) : 0.0;
}

// The best way of answering to the driver, rotated.
static double search(const record *r, const lac_driver_grid *grid, const lac_driver *driver,
                     size_t rotation, lac_answer *best)
{
    double most = -1.0, mean[MOST];
    lac_answer answer;
    for (size_t k = 0; lac_answer_get(grid, driver, k, &answer); k++) {
        lac_answer_mean(grid, answer, rotation, r->n, r->from, r->to, mean);
        const double found = score(r, mean);
        if (found > most) {
            most = found;
            *best = answer;
        }
    }
    return most;
}

static double find_p(const record *r, const lac_driver_grid *grid, const lac_driver *driver,
                     lac_answer *best)
{
    const double found = search(r, grid, driver, 0, best);
    size_t better = 0;
    for (size_t k = 1; k <= LAC_DRIVER_SHIFTS; k++) {
        lac_answer ignored;
        const size_t by = k * LAC_DRIVER_GRID / (LAC_DRIVER_SHIFTS + 1);
        better += search(r, grid, driver, by, &ignored) >= found ? 1 : 0;
    }
    return (1.0 + (double)better) / (1.0 + LAC_DRIVER_SHIFTS);
}

// A line of the rate through up to two columns and a constant.
typedef struct fit {
    double c, error; // of the last column, and its standard error
    double squares;  // weighted, of the residuals
    double weight[MOST], rest[MOST];
} fit;

// c of the last column, others taken off it: [constant, others ..., last].
static void project(const record *r, size_t others, const double *const *column, fit *f)
{
    double base[BASE][MOST], last[MOST], *const rest = f->rest;
    for (size_t k = 0; k <= others + 1; k++) {
        double *to = k <= others ? base[k] : last;
        for (size_t i = 0; i < r->n; i++) {
            to[i] = f->weight[i] * (k == 0 ? 1.0 : column[k - 1][i]);
        }
        const double whole = sqrt(lac_dot(r->n, to, to));
        take_off(r->n, k <= others ? k : others + 1, (const double(*)[MOST])base, to);
        const double size = sqrt(lac_dot(r->n, to, to));
        for (size_t i = 0; i < r->n && k <= others; i++) {
            to[i] = size > flat * whole ? to[i] / size : 0.0;
        }
    }
    for (size_t i = 0; i < r->n; i++) {
        rest[i] = f->weight[i] * r->rate[i];
    }
    take_off(r->n, others + 1, (const double(*)[MOST])base, rest);
    const double own = lac_dot(r->n, last, last);
    f->c = own > 0.0 ? lac_dot(r->n, last, rest) / own : 0.0;
    lac_take_off(r->n, f->c, last, rest);
    f->squares = lac_dot(r->n, rest, rest);
    // residuals as a first-order autoregression
    const double alike = lac_alike(r->n, rest, 0.0, 0.0, most_alike);
    const double freedom = (double)(r->n - others - 2);
    f->error = own > 0.0 ? sqrt(f->squares / freedom / own * (1.0 + alike) / (1.0 - alike)) : 0.0;
}

// Huber's weights, in rounds; of the last round the weights remain.
static void fit_robustly(const record *r, size_t others, const double *const *column, fit *f)
{
    double weight[MOST], off[MOST];
    memcpy(weight, r->weight, sizeof weight);
    for (int k = 0; k < ROUNDS; k++) {
        memcpy(f->weight, weight, sizeof weight);
        project(r, others, column, f);
        double centre;
        for (size_t i = 0; i < r->n; i++) {
            off[i] = f->rest[i] * r->weight[i] / f->weight[i];
        }
        const double spread = median_distance(r->n, off, &centre);
        for (size_t i = 0; i < r->n && k + 1 < ROUNDS; i++) {
            const double far = fabs(off[i]) / (huber * spread);
            weight[i] = r->weight[i] * (spread > 0.0 && far > 1.0 ? 1.0 / sqrt(far) : 1.0);
        }
    }
}

// Whether the rate still rises, by each shape, with the driver's part beside it.
static void find_rest(const record *r, const double *answer, lac_driver_effect *e)
{
    bool rising = false, open = false;
    for (size_t shape = 0; shape < RISES; shape++) {
        double x[MOST];
        fit alone, beside;
        for (size_t i = 0; i < r->n; i++) {
            x[i] = rise(r, shape, i);
        }
        fit_robustly(r, 0, (const double *const[]){x}, &alone);
        fit_robustly(r, 1, (const double *const[]){answer, x}, &beside);
        rising = rising || beside.c > told * beside.error;
        if (alone.c > told * alone.error) {
            open = open || !(beside.c + bound * beside.error < explained * alone.c);
        }
    }
    e->remains = rising ? LAC_REMAINS_RISING : open ? LAC_REMAINS_UNKNOWN : LAC_REMAINS_LEVEL;
}

// What the best answer amounts to, and what it leaves.
static void measure(const record *r, const lac_driver_grid *grid, lac_answer answer,
                    lac_driver_effect *e)
{
    double mean[MOST], line[MOST], rest[MOST];
    fit f;
    lac_answer_mean(grid, answer, 0, r->n, r->from, r->to, mean);
    lac_answer_add_trend(grid, answer, r->n, r->from, r->to, mean);
    for (size_t i = 0; i < r->n; i++) {
        line[i] = rise(r, 0, i);
    }
    fit_robustly(r, 1, (const double *const[]){line, mean}, &f);
    e->response = answer.response;
    e->scale = answer.scale == SIZE_MAX ? 0.0 : grid->scale[answer.scale];
    e->slope = f.c;
    const double left = f.squares;
    fit without = {.c = 0.0};
    memcpy(without.weight, f.weight, sizeof f.weight);
    memset(rest, 0, sizeof rest);
    project(r, 1, (const double *const[]){line, rest}, &without);
    e->share = without.squares > 0.0 ? fmax(0.0, 1.0 - left / without.squares) : 0.0;
    find_rest(r, mean, e);
}

static void tell_by_readings(const lac_motion *m, const lac_driver_grid *grid, lac_answer answer,
                             lac_driver_effect *e)
{
    (void)lac_driver_mean(e->driver, m->time[m->n - 1], grid->between, m->n - 1, m->time,
                          e->value + 1, e->part + 1);
    for (size_t i = 1; i < m->n; i++) {
        const double *const from = &m->time[i - 1], *const to = &m->time[i];
        const bool known = e->part[i] >= known_enough;
        double part = NAN;
        if (known && e->verdict == LAC_EXPLAINS) {
            lac_answer_mean(grid, answer, 0, 1, from, to, &part);
            lac_answer_add_trend(grid, answer, 1, from, to, &part);
        }
        e->value[i] = known ? e->value[i] : (double)NAN;
        e->part[i] = e->slope * part;
    }
}

// What forbids an answer.
static void look(const lac_motion *m, const lac_driver_grid *grid, const record *r,
                 lac_driver_effect *e)
{
    double time = 0.0;
    for (size_t i = 0; i < r->n; i++) {
        time += r->to[i] - r->from[i];
    }
    const double late = m->time[m->n - 1] - fmax(END * m->interval, END * grid->between);
    const char *name = e->driver->name;
    if (m->n <= LAC_DRIVER_LEAST) {
        (void)snprintf(e->reason, sizeof e->reason,
                       "too few readings: %zu intervals since %.60s begins, at least %d", m->n - 1,
                       name, (int)LAC_DRIVER_LEAST);
    } else if (grid->end < late) {
        (void)snprintf(e->reason, sizeof e->reason, "%s ends before the readings", name);
    } else if (r->n < LAC_DRIVER_LEAST || time < covered * (m->time[m->n - 1] - m->time[0])) {
        (void)snprintf(e->reason, sizeof e->reason,
                       "too many gaps: %s is known over %zu intervals of the readings, %.0f %% of "
                       "their time",
                       name, r->n, 100.0 * time / (m->time[m->n - 1] - m->time[0]));
    } else if (!(grid->high - grid->low > flat * fmax(fabs(grid->low), fabs(grid->high)))) {
        (void)snprintf(e->reason, sizeof e->reason, "%s is constant", name);
    }
}

static void explain(lac_driver_grid *grid, double level, record *r, lac_driver_effect *e)
{
    lac_answer *const answer = &r->answer;
    bool at_end = false; // of the scales
    if (e->reason[0] == '\0' && !prepare(r)) {
        (void)snprintf(e->reason, sizeof e->reason, "the rate is constant");
    }
    if (e->reason[0] == '\0') {
        e->p = find_p(r, grid, e->driver, answer);
        e->verdict = e->p <= level ? LAC_EXPLAINS : LAC_EXPLAINS_NOT;
        at_end = answer->scale != SIZE_MAX && answer->scale + 1 == grid->scales;
        for (int k = 0; k < CLOSER && answer->scale != SIZE_MAX; k++) {
            lac_driver_grid_refine(grid, answer->scale);
            (void)search(r, grid, e->driver, 0, answer);
        }
        measure(r, grid, *answer, e);
    }
    if (e->verdict == LAC_EXPLAINS_NOT && e->share > fits_well) {
        e->verdict = LAC_EXPLAINS_UNKNOWN;
        (void)snprintf(
            e->reason, sizeof e->reason,
            "it fits %.0f %% of the rate, but it would fit as well at other times (p %.2g)",
            100.0 * e->share, e->p);
    }
    if (e->verdict == LAC_EXPLAINS && at_end) {
        e->verdict = LAC_EXPLAINS_UNKNOWN;
        (void)snprintf(e->reason, sizeof e->reason,
                       "too short a record: the best %s is a third of it or more",
                       answer->response == LAC_RESPONSE_LAG ? "lag" : "memory");
    }
}

// The motion since the reading before which nothing is known of the driver.
static lac_motion since_driver(const lac_motion *m, const lac_driver *driver)
{
    lac_motion since = *m;
    while (since.n > 1 && driver->n > 0 && since.time[1] <= driver->time[0]) {
        since.n--;
        since.time++;
        since.displacement++;
    }
    return since;
}

lac_status lac_driver_explain(const lac_motion *motion, const lac_driver *driver, double level,
                              lac_driver_effect *out, lac_error *err)
{
    const size_t n = motion->n;
    lac_status status = LAC_OK;
    lac_driver_grid *grid = NULL;
    record *r = calloc(1, sizeof *r);
    *out = (lac_driver_effect){.driver = driver, .p = NAN, .share = NAN, .slope = NAN, .n = n};
    out->scale = NAN;
    out->value = calloc(n + 1, 2 * sizeof *out->value);
    LAC_TRY(r != NULL && out->value != NULL ? LAC_OK : lac_fail_memory(err));
    out->part = out->value + n;
    for (size_t i = 0; i < 2 * n; i++) {
        out->value[i] = NAN;
    }
    const lac_motion seen = since_driver(motion, driver);
    if (seen.n < 2) {
        (void)snprintf(out->reason, sizeof out->reason, "too few readings since %.60s begins",
                       driver->name);
        goto out;
    }
    const double first = seen.time[0], last = seen.time[seen.n - 1];
    LAC_TRY(lac_driver_grid_create(driver, first, last, last, seen.interval, &grid, err));
    *r = (record){.motion = &seen, .first = first, .length = last - first};
    group(&seen, grid, r);
    look(&seen, grid, r, out);
    out->intervals = r->n;
    explain(grid, level, r, out);
    tell_by_readings(motion, grid, r->answer, out);
out:
    free(grid);
    free(r);
    return status;
}

void lac_driver_effect_clear(lac_driver_effect *effect)
{
    free(effect->value);
    *effect = (lac_driver_effect){0};
}

bool lac_driver_withholds(const lac_driver_effect *e)
{
    return e->verdict == LAC_EXPLAINS && e->remains == LAC_REMAINS_LEVEL;
}
