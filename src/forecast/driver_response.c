// SPDX-License-Identifier: GPL-3.0-or-later
// A driver on even cells, off its own line; reservoirs that it fills; means of these over intervals
// while the driver is rotated in time. Reservoirs are linear, so that one for ever fed by the same
// cells, rotated, less what it held at the start, is one that starts empty.
#include "forecast/driver_response.h"

#include "base/statistics.h"

static const double day = 86400.0;
static const double forgotten = 40.0;    // memories
static const double half = 0.5;          // of a cell that counts as known
static const double joined = 2.0;        // median steps: longer ones are gaps
static const double longest = 1.0 / 3.0; // part of the record that a memory may be

static double median_step(const lac_driver *d, double *work)
{
    for (size_t i = 1; i < d->n; i++) {
        work[i - 1] = d->time[i] - d->time[i - 1];
    }
    return d->n > 1 ? lac_median(d->n - 1, work) : day;
}

// The time that value i is of.
static void cover(const lac_driver *d, size_t i, double step, double *from, double *to)
{
    const double before = i > 0 ? d->time[i] - d->time[i - 1] : step;
    *to = d->days ? d->time[i] + day : d->time[i];
    *from = d->days ? d->time[i] : d->time[i] - (before > joined * step ? step : before);
}

static double place(const lac_driver_grid *g, double t)
{
    return fmin(LAC_DRIVER_GRID, fmax(0.0, (t - g->left) / g->step));
}

// Cells that values are laid on, in the order of time.
typedef struct cells {
    size_t n, at;       // the first cell that may still be met
    const double *edge; // [n + 1]
    double *mean, *known;
} cells;

static void lay(cells *c, double from, double to, double value)
{
    while (c->at < c->n && c->edge[c->at + 1] <= from) {
        c->at++;
    }
    for (size_t i = c->at; i < c->n && c->edge[i] < to; i++) {
        const double part =
            (fmin(to, c->edge[i + 1]) - fmax(from, c->edge[i])) / (c->edge[i + 1] - c->edge[i]);
        c->mean[i] += part * value;
        c->known[i] += part;
    }
}

double lac_driver_mean(const lac_driver *d, double now, double step, size_t n, const double *edge,
                       double *mean, double *known)
{
    cells c = {.n = n, .edge = edge, .mean = mean, .known = known};
    double done = INFINITY, end = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        mean[i] = known[i] = 0.0;
    }
    for (size_t i = 0; i < d->n; i++) {
        double from, to;
        cover(d, i, step, &from, &to);
        if (to > now) {
            break;
        }
        if (!isnan(d->value[i])) {
            if (d->sum && done < from) { // what the file does not name did not fall
                lay(&c, done, from, 0.0);
            }
            lay(&c, from, to, d->sum ? d->value[i] / (to - from) : d->value[i]);
            end = to;
        }
        done = to;
    }
    for (size_t i = 0; i < n; i++) {
        known[i] = fmin(known[i], 1.0);
        mean[i] = known[i] > 0.0 ? mean[i] / known[i] : NAN;
    }
    return end;
}

// Cells become what they are off their line, which is of those that are known.
static void take_line_off(lac_driver_grid *g, double *known)
{
    lac_line line = {0};
    g->low = INFINITY;
    g->high = -INFINITY;
    for (size_t i = 0; i < LAC_DRIVER_GRID; i++) {
        if (known[i] > half) {
            g->low = fmin(g->low, g->off[i]);
            g->high = fmax(g->high, g->off[i]);
            lac_line_add(&line, (double)i + 0.5, g->off[i]);
        } else {
            known[i] = 0.0;
        }
    }
    g->known[0] = 0.0;
    const double slope = line.xx > 0.0 ? lac_line_slope(&line) : 0.0;
    g->at_left = line.n > 0.0 ? lac_line_at(&line, 0.0) : 0.0;
    g->trend = slope / g->step;
    for (size_t i = 0; i < LAC_DRIVER_GRID; i++) {
        g->off[i] = known[i] > 0.0 ? g->off[i] - (g->at_left + slope * ((double)i + 0.5)) : 0.0;
        g->sum[i + 1] = g->sum[i] + g->off[i];
        g->known[i + 1] = g->known[i] + known[i];
    }
}

// y_i = a y_(i-1) + (1-a) off_i, from the y that comes back after one round.
static void hold(lac_driver_grid *g, size_t k)
{
    const double a = exp(-g->step / g->scale[k]);
    double y = 0.0;
    for (size_t i = 0; i < LAC_DRIVER_GRID; i++) {
        y = a * y + (1.0 - a) * g->off[i];
    }
    y /= 1.0 - pow(a, LAC_DRIVER_GRID);
    for (size_t i = 0; i < LAC_DRIVER_GRID; i++) {
        y = a * y + (1.0 - a) * g->off[i];
        g->held[k][i] = y;
        g->held_sum[k][i + 1] = g->held_sum[k][i] + y;
    }
}

static void set_scales(lac_driver_grid *g, size_t scales, double least, double most)
{
    g->scales = scales;
    for (size_t k = 0; k < scales; k++) {
        const double part = scales > 1 ? (double)k / (double)(scales - 1) : 1.0;
        g->scale[k] = least * pow(most / least, part);
        hold(g, k);
    }
}

// Not closer than octaves.
static void choose_scales(lac_driver_grid *g, double least, double most)
{
    const double octaves = most > least ? floor(log2(most / least)) + 1.0 : 1.0;
    set_scales(g, octaves < LAC_DRIVER_SCALES ? (size_t)octaves : LAC_DRIVER_SCALES,
               fmin(least, most), most);
}

void lac_driver_grid_refine(lac_driver_grid *g, size_t scale)
{
    set_scales(g, LAC_DRIVER_SCALES, g->scale[scale > 0 ? scale - 1 : 0],
               g->scale[scale + 1 < g->scales ? scale + 1 : scale]);
}

lac_status lac_driver_grid_create(const lac_driver *all, double first, double last, double now,
                                  double least, lac_driver_grid **out, lac_error *err)
{
    lac_driver past = *all, *const driver = &past;
    while (past.n > 0 && past.time[past.n - 1] > now) {
        past.n--;
    }
    const size_t rows = past.n > LAC_DRIVER_GRID ? past.n : LAC_DRIVER_GRID + 1;
    double *work = calloc(rows, sizeof *work), from, to;
    lac_driver_grid *g = *out = calloc(1, sizeof *g);
    if (work == NULL || g == NULL) {
        free(work);
        return lac_fail_memory(err);
    }
    const double step = g->between = median_step(driver, work);
    g->left = first;
    if (past.n > 0) {
        cover(driver, 0, step, &from, &to);
        g->left = fmin(first, fmax(from, first - (last - first)));
    }
    g->step = (last - g->left) / LAC_DRIVER_GRID;
    for (size_t i = 0; i <= LAC_DRIVER_GRID; i++) {
        work[i] = g->left + g->step * (double)i;
    }
    g->end = lac_driver_mean(driver, now, step, LAC_DRIVER_GRID, work, g->off, g->known);
    memcpy(work, g->known, LAC_DRIVER_GRID * sizeof *work);
    take_line_off(g, work);
    choose_scales(g, fmax(least, 2.0 * g->step), longest * (last - first));
    free(work);
    return LAC_OK;
}

bool lac_answer_get(const lac_driver_grid *grid, const lac_driver *driver, size_t index,
                    lac_answer *out)
{
    const size_t k = grid->scales;
    *out = index == 0 ? (lac_answer){LAC_RESPONSE_LAG, SIZE_MAX}
                      : (lac_answer){(lac_response)((index - 1) / k), (index - 1) % k};
    return index <= (driver->sum ? 2 : 3) * k;
}

// Of a running sum over the cells at a place that may lie before the first one: rounds go on.
static double sum_at(const double *sum, double at)
{
    const double all = LAC_DRIVER_GRID, round = floor(at / all), in = at - round * all;
    const size_t i = in < all ? (size_t)in : LAC_DRIVER_GRID - 1;
    return round * sum[LAC_DRIVER_GRID] + sum[i] + (in - (double)i) * (sum[i + 1] - sum[i]);
}

// A reservoir between the ends of cells.
static double held_at(const double *held, double at)
{
    const double all = LAC_DRIVER_GRID, in = at - floor(at / all) * all;
    const size_t i = in < all ? (size_t)in : LAC_DRIVER_GRID - 1;
    const double before = held[i > 0 ? i - 1 : LAC_DRIVER_GRID - 1];
    return before + (in - (double)i) * (held[i] - before);
}

void lac_answer_mean(const lac_driver_grid *g, lac_answer answer, size_t rotation, size_t n,
                     const double *from, const double *to, double *mean)
{
    const bool lags = answer.response == LAC_RESPONSE_LAG;
    const double by = (double)(rotation % LAC_DRIVER_GRID);
    const double scale = answer.scale == SIZE_MAX ? 0.0 : g->scale[answer.scale] / g->step;
    const double *const sum = lags ? g->sum : g->held_sum[answer.scale];
    const double *const held = lags ? NULL : g->held[answer.scale];
    const double start = lags ? 0.0 : held_at(held, -by);
    for (size_t i = 0; i < n; i++) {
        const double a = place(g, from[i]), b = place(g, to[i]), length = b - a;
        if (lags) {
            mean[i] = a < scale
                          ? 0.0
                          : (sum_at(sum, b - by - scale) - sum_at(sum, a - by - scale)) / length;
            continue;
        }
        // what goes, over the interval, of what was there at the start
        const double left = a > forgotten * scale ? 0.0 : exp(-a / scale) - exp(-b / scale);
        mean[i] = answer.response == LAC_RESPONSE_MEMORY
                      ? (sum_at(sum, b - by) - sum_at(sum, a - by) - start * scale * left) / length
                      : (held_at(held, b - by) - held_at(held, a - by) + start * left) /
                            (length * g->step);
    }
}

void lac_answer_add_trend(const lac_driver_grid *g, lac_answer answer, size_t n, const double *from,
                          const double *to, double *mean)
{
    const double late = answer.scale == SIZE_MAX ? 0.0 : g->scale[answer.scale];
    for (size_t i = 0; i < n; i++) {
        mean[i] += answer.response == LAC_RESPONSE_CHANGE
                       ? g->trend
                       : g->at_left + g->trend * (0.5 * (from[i] + to[i]) - g->left - late);
    }
}

double lac_driver_known(const lac_driver_grid *g, double from, double to)
{
    const double a = place(g, from), b = place(g, to);
    return b > a ? (sum_at(g->known, b) - sum_at(g->known, a)) / (b - a) : 0.0;
}
