// SPDX-License-Identifier: GPL-3.0-or-later
// The posterior of the time of failure: every shape of the fitted curve counts by its weight.
#include "forecast/project.h"

#include <math.h>
#include <stdlib.h>

#include "base/statistics.h"

static const double pace = 0.25;  // of both rules
static const double widest = 3.0; // standard deviation of a rule, in e-folds
static const double narrowest = 1e-9;
static const double negligible = 25.0; // ln of a density over the highest
static const double exactest = 1e-10;  // residuals over the range below which all are 0

// Nodes of the inner and the outer rule on each side, places between two of these, steps at most.
enum { REACH = 6, SIDE = 16, NODES = 2 * SIDE + 1, BETWEEN = 8, CLIMB = 8 };

// What is integrated, and where its ridge was seen last.
typedef struct ridge {
    lac_projection *law;
    double effective, least;
    double x, y, slope, width; // a place on it, dy/dx, standard deviation of y there
} ridge;

static double log_density(const ridge *r, double x, double y)
{
    lac_projection *law = r->law;
    const lac_window *w = law->window;
    const double p[LAC_SHAPES_MAX] = {x, y};
    const double range = w->displacement[w->n - 1] - w->displacement[0];
    const double floor = (double)w->n * exactest * exactest * range * range;
    const double rounding = (double)w->n * lac_projection_rounding(w);
    const double sum = lac_projection_eval(law, p);
    if (!isfinite(sum) || !(law->c[1] > 0.0)) {
        return -INFINITY;
    }
    const double off = (y - law->centre[1]) / law->width[1];
    return -0.5 * fmax(1.0, r->effective - 2.0) *
               log((fmax(sum, rounding) + floor) / (fmax(r->least, rounding) + floor)) -
           0.5 * off * off;
}

static double within(double low, double high, double x) { return fmin(high, fmax(low, x)); }

// Goes up to the ridge at x by parabolas. @return ln of the density on it
static double climb(ridge *r, double x)
{
    double y = r->y + r->slope * (x - r->x);
    double width = r->width;
    double here = log_density(r, x, y);
    double step = width;
    for (int i = 0; i < CLIMB && fabs(step) > 0.2 * width; i++) {
        const double below = log_density(r, x, y - width);
        const double above = log_density(r, x, y + width);
        const double bend = (2.0 * here - below - above) / (width * width);
        const double flattest = 1.0 / (widest * widest);
        step = bend > flattest ? 0.5 * (above - below) / (width * bend)
                               : copysign(4.0 * width, above - below);
        step = within(-8.0 * width, 8.0 * width, isfinite(step) ? step : 0.0);
        double there = log_density(r, x, y + step);
        while (there < here && fabs(step) > 0.1 * width) {
            step *= 0.25;
            there = log_density(r, x, y + step);
        }
        y = there >= here ? y + step : y;
        here = fmax(here, there);
        width = within(narrowest, widest, bend > flattest ? 1.0 / sqrt(bend) : 2.0 * width);
    }
    r->slope = x != r->x ? (y - r->y) / (x - r->x) : r->slope;
    r->x = x;
    r->y = y;
    r->width = width;
    return here;
}

// ln of the integral over y at x: the trapezoidal rule in t, y = ridge + width sinh(2 t), which
// reaches far into slow tails.
static double integral(ridge *r, double x)
{
    const double top = climb(r, x);
    double sum = 0.0;
    if (!(top > -negligible)) {
        return -INFINITY;
    }
    for (int i = -REACH; i <= REACH; i++) {
        const double t = 2.0 * pace * (double)i;
        const double value = i == 0 ? top : log_density(r, x, r->y + r->width * sinh(t));
        sum += cosh(t) * exp(value - top);
    }
    return top + log(2.0 * pace * r->width * sum);
}

// ln of the density k/BETWEEN nodes from the first: a cubic through the four about it.
static double between(const double value[NODES], int k)
{
    const int i = k / BETWEEN;
    const double u = (double)(k % BETWEEN) / BETWEEN;
    if (u == 0.0) {
        return value[i];
    }
    const double a = value[i];
    const double b = value[i + 1];
    if (!isfinite(a) || !isfinite(b)) {
        return -INFINITY;
    }
    const double before = i > 0 && isfinite(value[i - 1]) ? value[i - 1] : 2.0 * a - b;
    const double after = i + 2 < NODES && isfinite(value[i + 2]) ? value[i + 2] : 2.0 * b - a;
    const double rise = 0.5 * (b - before);
    const double last = 0.5 * (after - a);
    return a + u * rise +
           u * u * (3.0 * (b - a) - 2.0 * rise - last + u * (rise + last - 2.0 * (b - a)));
}

void lac_posterior_draw(lac_projection *law, const double *p, double effective, double least,
                        lac_draw *draw)
{
    const double width = within(narrowest, widest, sqrt(law->covariance[0][0]));
    const double left =
        law->covariance[1][1] - law->covariance[0][1] * law->covariance[0][1] / (width * width);
    const double farthest = log(-lac_projection_farthest() * law->window->time[0]);
    const ridge start = {.law = law,
                         .effective = effective,
                         .least = least,
                         .x = p[0],
                         .y = p[1],
                         .slope = law->covariance[0][1] / (width * width),
                         .width = within(narrowest, widest, sqrt(fmax(0.0, left)))};
    double value[NODES];
    for (int way = -1; way <= 1; way += 2) {
        ridge r = start;
        double last = 0.0;
        for (int i = way > 0 ? 0 : 1; i <= SIDE; i++) {
            const double x = p[0] + width * sinh(pace * (double)i * (double)way);
            last = x < farthest && isfinite(last) ? integral(&r, x) : -INFINITY;
            value[SIDE + i * way] = last;
        }
    }
    for (int k = 0; k < LAC_POSTERIOR_DRAWS; k++) {
        const double t = pace * ((double)k / BETWEEN - SIDE);
        draw[k].x = p[0] + width * sinh(t);
        draw[k].weight = between(value, k) + log(width * cosh(t));
    }
}

// Between the draws whose middles of weight lie on both sides.
static double quantile(size_t n, const lac_draw *draw, double share)
{
    double before = 0.0; // weight up to the middle of draw i
    for (size_t i = 0; i < n; i++) {
        const double last = i > 0 ? draw[i - 1].weight : 0.0;
        const double middle = before + 0.5 * (last + draw[i].weight);
        if (middle >= share) {
            const double part = i > 0 ? (share - before) / (middle - before) : 1.0;
            return i > 0 ? draw[i - 1].x + part * (draw[i].x - draw[i - 1].x) : draw[0].x;
        }
        before = middle;
    }
    return draw[n - 1].x;
}

void lac_posterior_finish(size_t n, lac_draw *draw, lac_forecast_fit *fit)
{
    static const double share[LAC_FORECAST_LEVELS] = {0.05, 0.25, 0.5, 0.75, 0.95};
    double highest = -INFINITY;
    double all = 0.0;
    for (size_t i = 0; i < n; i++) {
        highest = fmax(highest, draw[i].weight);
    }
    if (!isfinite(highest)) {
        return;
    }
    for (size_t i = 0; i < n; i++) {
        draw[i].weight = exp(draw[i].weight - highest);
        all += draw[i].weight;
    }
    for (size_t i = 0; i < n; i++) {
        draw[i].weight /= all;
    }
    qsort(draw, n, sizeof *draw, lac_by_first);
    for (size_t k = 0; k < LAC_FORECAST_LEVELS; k++) {
        fit->quantile[k] = quantile(n, draw, share[k]);
    }
    fit->posterior = true;
    fit->error = (fit->quantile[4] - fit->quantile[0]) / (2.0 * 1.6448536269514722);
}
