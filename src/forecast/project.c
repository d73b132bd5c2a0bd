// SPDX-License-Identifier: GPL-3.0-or-later
// A curve fitted to displacements: only its time of failure and shape are searched, as the best
// linear parameters follow from them; and the posterior of its time of failure, where every shape
// counts by its weight.
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_statistics_double.h>

#include "forecast/kinds.h"

enum { STARTS = 4, ITERATIONS = 100 };
static const double farthest = 20.0;   // remaining time over the window's length
static const double most_alike = 0.95; // residuals, which widens errors 6 times
static const double at_an_end = 1e-4;  // of the steepest shape: one that has no say is held

// The best places so far, in the order of their sums.
typedef struct places {
    size_t count;
    double sum[STARTS], p[STARTS][LAC_SHAPES_MAX];
} places;

// Variance of a displacement rounded to its last digit, which is what residuals count at least.
static double rounding_of(const lac_window *window)
{
    return window->resolution * window->resolution / 12.0;
}

void lac_projection_clear(lac_projection *self) { free(self->column); }

double lac_projection_eval(lac_projection *self, const double *p)
{
    const lac_window *w = self->window;
    self->curve(self, p, self->column);
    for (size_t j = 0; j < self->columns; j++) {
        for (size_t i = 0; i < w->n; i++) {
            self->column[j * w->n + i] *= w->weight[i];
        }
    }
    for (size_t i = 0; i < w->n; i++) {
        self->residual[i] = w->weight[i] * w->displacement[i];
    }
    const double sum =
        lac_least_squares(w->n, self->columns, self->column, self->residual, self->c);
    return isfinite(sum) ? sum : INFINITY;
}

static void offer(places *s, size_t shapes, const double *p, double sum)
{
    if (s->count == STARTS && !(sum < s->sum[STARTS - 1])) {
        return;
    }
    size_t at = s->count < STARTS ? s->count++ : STARTS - 1;
    for (; at > 0 && s->sum[at - 1] > sum; at--) {
        s->sum[at] = s->sum[at - 1];
        memcpy(s->p[at], s->p[at - 1], sizeof s->p[at]);
    }
    s->sum[at] = sum;
    memcpy(s->p[at], p, shapes * sizeof *p);
}

// ln of the remaining time at `part` of the way.
static double place_time(const lac_window *w, double part)
{
    const double low = log(-w->time[w->n - 2] / 30.0);
    const double high = log(-w->time[0] * 30.0);
    return low + (high - low) * part;
}

static void look_around(lac_projection *self, places *best)
{
    size_t all = 1;
    double p[LAC_SHAPES_MAX];
    for (size_t j = 0; j < self->shapes; j++) {
        all *= self->grid[j];
    }
    for (size_t k = 0; k < all; k++) {
        size_t rest = k;
        for (size_t j = self->shapes; j-- > 0;) {
            const double part = ((double)(rest % self->grid[j]) + 0.5) / (double)self->grid[j];
            p[j] = j == 0 ? place_time(self->window, part) : self->place(self, j, part);
            rest /= self->grid[j];
        }
        offer(best, self->shapes, p, lac_projection_eval(self, p));
    }
}

// Residuals, then one for each shape that has a prior.
static int residuals(const gsl_vector *x, void *context, gsl_vector *f)
{
    lac_projection *self = context;
    const size_t n = self->window->n;
    double p[LAC_SHAPES_MAX];
    for (size_t j = 0; j < self->shapes; j++) {
        p[j] = gsl_vector_get(x, j);
    }
    if (!isfinite(lac_projection_eval(self, p))) {
        return GSL_EDOM;
    }
    for (size_t i = 0; i < n; i++) {
        gsl_vector_set(f, i, self->residual[i]);
    }
    for (size_t j = 0; j < self->shapes; j++) {
        const bool free = self->width == NULL || isinf(self->width[j]);
        const double off = free ? 0.0 : (p[j] - self->centre[j]) / self->width[j];
        gsl_vector_set(f, n + j, off * self->scale);
    }
    return GSL_SUCCESS;
}

static void judge(lac_projection *self, const gsl_multifit_nlinear_workspace *work,
                  gsl_matrix *covariance, const double *p, lac_forecast_fit *fit)
{
    const lac_window *w = self->window;
    const double sum = lac_projection_eval(self, p);
    const double free = fmax(1.0, (double)w->n - (double)(self->shapes + self->columns));
    const double r = lac_alike(w->n, self->residual, 0.0, 0.0, most_alike);
    double low, high;
    gsl_stats_minmax(&low, &high, w->displacement, 1, w->n);
    (void)gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(work), at_an_end, covariance);
    self->effective = (double)w->n * (1.0 - r) / (1.0 + r);
    const double variance = fmax(sum / free, rounding_of(w)) * (1.0 + r) / (1.0 - r);
    for (size_t i = 0; i < self->shapes; i++) {
        for (size_t j = 0; j < self->shapes; j++) {
            self->covariance[i][j] = variance * gsl_matrix_get(covariance, i, j);
        }
    }
    fit->remaining = exp(p[0]);
    fit->error = sqrt(fmax(0.0, self->covariance[0][0]));
    fit->points = w->n;
    fit->rms_unit = "m";
    lac_forecast_fit_weigh(fit, sqrt(sum / (double)w->n), high - low, w->error, free);
    if (fit->remaining > -farthest * w->time[0]) {
        (void)lac_forecast_fit_refuse(fit, "no finite time fits better than one %.0f windows away",
                                      farthest);
    }
}

static double cost(const gsl_multifit_nlinear_workspace *work)
{
    const gsl_vector *f = gsl_multifit_nlinear_residual(work);
    return lac_dot(f->size, f->data, f->data);
}

// From one start; the workspace is at the minimum afterwards.
static bool descend(lac_projection *self, gsl_multifit_nlinear_workspace *work, const double *start)
{
    gsl_multifit_nlinear_fdf system = {
        .f = residuals, .n = self->window->n + self->shapes, .p = self->shapes, .params = self};
    double copy[LAC_SHAPES_MAX];
    memcpy(copy, start, self->shapes * sizeof *copy);
    const gsl_vector_const_view x = gsl_vector_const_view_array(copy, self->shapes);
    int info = 0;
    if (gsl_multifit_nlinear_init(&x.vector, &system, work) != GSL_SUCCESS) {
        return false;
    }
    (void)gsl_multifit_nlinear_driver(ITERATIONS, 1e-10, 1e-12, 0.0, NULL, NULL, &info, work);
    return isfinite(cost(work));
}

static void read_position(const lac_projection *self, const gsl_multifit_nlinear_workspace *work,
                          double *p)
{
    for (size_t j = 0; j < self->shapes; j++) {
        p[j] = gsl_vector_get(gsl_multifit_nlinear_position(work), j);
    }
}

static lac_status refine(lac_projection *self, const places *starts, double *p,
                         lac_forecast_fit *fit, lac_error *err)
{
    const size_t rows = self->window->n + self->shapes;
    const gsl_multifit_nlinear_parameters settings = gsl_multifit_nlinear_default_parameters();
    gsl_multifit_nlinear_workspace *work =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &settings, rows, self->shapes);
    gsl_matrix *covariance = gsl_matrix_calloc(self->shapes, self->shapes);
    double best = INFINITY;
    lac_status status = work != NULL && covariance != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    for (size_t k = 0; k < starts->count; k++) {
        if (descend(self, work, starts->p[k]) && cost(work) < best) {
            best = cost(work);
            read_position(self, work, p);
        }
    }
    if (!isfinite(best) || !descend(self, work, p)) { // back there: the workspace has gone on
        (void)lac_forecast_fit_refuse(fit, "no fit was found");
        goto out;
    }
    read_position(self, work, p);
    judge(self, work, covariance, p, fit);
out:
    gsl_multifit_nlinear_free(work);
    gsl_matrix_free(covariance);
    return status;
}

lac_status lac_projection_fit(lac_projection *self, double *p, lac_forecast_fit *fit,
                              lac_error *err)
{
    const lac_window *w = self->window;
    places best = {0};
    self->column = malloc((self->columns + 1) * w->n * sizeof *self->column);
    LAC_FAIL_MEMORY_IF(self->column == NULL, err);
    self->residual = self->column + self->columns * w->n;
    look_around(self, &best);
    if (self->width != NULL) {
        const double free = (double)w->n - (double)(self->shapes + self->columns);
        self->scale = sqrt(best.sum[0] / fmax(1.0, free));
        self->scale = w->noise > 0.0 ? fmin(self->scale, w->noise) : self->scale; // a coarse grid
    }
    return refine(self, &best, p, fit, err);
}

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
    const double rounding = (double)w->n * rounding_of(w);
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
    const double a = value[i], b = value[i + 1];
    if (!isfinite(a) || !isfinite(b)) {
        return -INFINITY;
    }
    const double before = i > 0 && isfinite(value[i - 1]) ? value[i - 1] : 2.0 * a - b;
    const double after = i + 2 < NODES && isfinite(value[i + 2]) ? value[i + 2] : 2.0 * b - a;
    const double rise = 0.5 * (b - before), last = 0.5 * (after - a);
    return a + u * rise +
           u * u * (3.0 * (b - a) - 2.0 * rise - last + u * (rise + last - 2.0 * (b - a)));
}

void lac_posterior_draw(lac_projection *law, const double *p, double effective, double least,
                        lac_draw *draw)
{
    const double width = within(narrowest, widest, sqrt(law->covariance[0][0]));
    const double left =
        law->covariance[1][1] - law->covariance[0][1] * law->covariance[0][1] / (width * width);
    const double end = log(-farthest * law->window->time[0]);
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
            last = x < end && isfinite(last) ? integral(&r, x) : -INFINITY;
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
    double highest = -INFINITY, all = 0.0;
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
