// SPDX-License-Identifier: GPL-3.0-or-later
#include "forecast/posterior.h"

#include <math.h>
#include <stdlib.h>

static const double pi = 3.14159265358979323846;
static const double widest = 5.0; // of a proposal, in e-folds
static const double narrowest = 1e-9;
static const double wider = 1.3;      // proposal over the spread that it stands for
static const double exactest = 1e-10; // residuals over the range below which all are 0

// A t distribution of 4 degrees of freedom: centre and lower triangle.
typedef struct proposal {
    double centre[2], l00, l10, l11;
} proposal;

static void spread(double c00, double c01, double c11, proposal *q)
{
    q->l00 = fmin(widest, fmax(narrowest, wider * sqrt(fmax(0.0, c00))));
    q->l10 = fmin(widest, fmax(-widest, wider * wider * c01 / q->l00));
    const double left = wider * wider * c11 - q->l10 * q->l10;
    q->l11 = fmin(widest, fmax(narrowest, sqrt(fmax(0.0, left))));
}

static double fraction(double x) { return x - floor(x); }

// The i-th point (its radius by inversion) and ln of the proposal's density there.
static double point(const proposal *q, size_t i, double *p)
{
    const double u = fraction(0.5 + 0.7548776662466927 * (double)(i + 1));
    const double angle = 2.0 * pi * fraction(0.5 + 0.5698402909980532 * (double)(i + 1));
    const double square = 4.0 * (1.0 / sqrt(fmax(u, 1e-12)) - 1.0);
    const double r = sqrt(square);
    p[0] = q->centre[0] + q->l00 * r * cos(angle);
    p[1] = q->centre[1] + q->l10 * r * cos(angle) + q->l11 * r * sin(angle);
    return -3.0 * log1p(square / 4.0) - log(q->l00 * q->l11);
}

static double log_posterior(lac_projection *law, const double *p, double effective, double least)
{
    const lac_window *w = law->window;
    const double range = w->displacement[w->n - 1] - w->displacement[0];
    const double floor = (double)w->n * exactest * exactest * range * range;
    if (p[0] > log(-lac_projection_farthest() * w->time[0])) {
        return -INFINITY;
    }
    const double sum = lac_projection_at(law, p);
    if (!isfinite(sum) || !(law->c[1] > 0.0)) {
        return -INFINITY;
    }
    const double off = (p[1] - law->centre[1]) / law->width[1];
    return -0.5 * fmax(1.0, effective - 2.0) * log((sum + floor) / (least + floor)) -
           0.5 * off * off;
}

// Moves the proposal to mean and covariance of what was drawn from it.
static void move(size_t n, const double (*p)[2], const lac_draw *draw, proposal *q)
{
    double highest = -INFINITY;
    double all = 0.0;
    double mean[2] = {0.0, 0.0};
    double c[3] = {0.0, 0.0, 0.0};
    for (size_t i = 0; i < n; i++) {
        highest = fmax(highest, draw[i].weight);
    }
    for (size_t i = 0; isfinite(highest) && i < n; i++) {
        const double weight = exp(draw[i].weight - highest);
        const double x = p[i][0] - q->centre[0];
        const double y = p[i][1] - q->centre[1];
        all += weight;
        mean[0] += weight * x;
        mean[1] += weight * y;
        c[0] += weight * x * x;
        c[1] += weight * x * y;
        c[2] += weight * y * y;
    }
    if (all > 0.0) {
        mean[0] /= all;
        mean[1] /= all;
        spread(c[0] / all - mean[0] * mean[0], c[1] / all - mean[0] * mean[1],
               c[2] / all - mean[1] * mean[1], q);
        q->centre[0] += mean[0];
        q->centre[1] += mean[1];
    }
}

void lac_posterior_draw(lac_projection *law, const double *p, double effective, double least,
                        lac_draw *draw)
{
    double at[LAC_POSTERIOR_DRAWS][2];
    proposal q = {.centre = {p[0], p[1]}};
    spread(law->covariance[0][0], law->covariance[0][1], law->covariance[1][1], &q);
    for (int round = 0; round < 2; round++) {
        for (size_t i = 0; i < LAC_POSTERIOR_DRAWS; i++) {
            const double log_proposal = point(&q, i, at[i]);
            draw[i].x = at[i][0];
            draw[i].weight = log_posterior(law, at[i], effective, least) - log_proposal;
        }
        if (round == 0) {
            move(LAC_POSTERIOR_DRAWS, at, draw, &q);
        }
    }
}

static int compare(const void *left, const void *right)
{
    const double a = ((const lac_draw *)left)->x;
    const double b = ((const lac_draw *)right)->x;
    return (a > b) - (a < b);
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

void lac_posterior_finish(size_t n, lac_draw *draw, lac_finding *fit)
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
    qsort(draw, n, sizeof *draw, compare);
    for (size_t k = 0; k < LAC_FORECAST_LEVELS; k++) {
        fit->quantile[k] = quantile(n, draw, share[k]);
    }
    fit->posterior = true;
    fit->error = (fit->quantile[4] - fit->quantile[0]) / (2.0 * 1.6448536269514722);
}
