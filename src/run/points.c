// SPDX-License-Identifier: GPL-3.0-or-later
// Places at which a run is watched: which contact cells tell of them.
#include "run/points.h"

// From one place to another along an axis, the short way round where the interface repeats.
static double apart(double from, double to, double length, bool periodic)
{
    const double d = fabs(to - from);
    return periodic ? fmin(d, fabs(length - d)) : d;
}

// How far a place is from a cell along both axes.
typedef struct offset {
    double x, y; // [m]
} offset;

static offset offset_of(const lac_domain *domain, const lac_point *p, size_t cell)
{
    const lac_grid *g = &domain->grid;
    const size_t at = domain->index[cell];
    return (offset){apart(p->x, lac_grid_x(g, at), (double)g->nx * g->dx, g->periodic),
                    apart(p->y, lac_grid_y(g, at), (double)g->ny * g->dy, g->periodic)};
}

// The nearest cell, and how many lie within the radius.
static size_t look_around(const lac_domain *domain, const lac_point *p, double radius,
                          size_t *within)
{
    double least = INFINITY;
    size_t nearest = 0;
    *within = 0;
    for (size_t i = 0; i < domain->n; i++) {
        const offset d = offset_of(domain, p, i);
        const double away = hypot(d.x, d.y);
        *within += away <= radius ? 1 : 0;
        if (away < least) {
            least = away;
            nearest = i;
        }
    }
    return nearest;
}

static lac_status find(const lac_domain *domain, const lac_point_def *def, lac_point *p,
                       lac_error *err)
{
    const lac_grid *g = &domain->grid;
    size_t within = 0;
    p->x = isnan(def->x) ? 0.5 * (double)g->nx * g->dx : def->x;
    p->y = isnan(def->y) ? 0.5 * (double)g->ny * g->dy : def->y;
    p->name = strdup(def->name);
    const size_t nearest = look_around(domain, p, def->radius, &within);
    const offset d = offset_of(domain, p, nearest);
    p->cell_x = lac_grid_x(g, domain->index[nearest]);
    p->cell_y = lac_grid_y(g, domain->index[nearest]);
    // The rounding of a cell's edge is no distance, nor is anything from a block, which is its
    // points.
    const double least = lac_grid_cells(g) > 1 ? 1e-9 * fmin(g->dx, g->dy) : INFINITY;
    p->distance = hypot(fmax(0.0, d.x - 0.5 * g->dx), fmax(0.0, d.y - 0.5 * g->dy));
    p->distance = p->distance > least ? p->distance : 0.0;
    p->cell = malloc((within + 1) * sizeof *p->cell);
    LAC_FAIL_MEMORY_IF(p->name == NULL || p->cell == NULL, err);
    for (size_t i = 0; i < domain->n && within > 0; i++) {
        const offset at = offset_of(domain, p, i);
        if (hypot(at.x, at.y) <= def->radius) {
            p->cell[p->cells++] = i;
        }
    }
    p->beside = p->cells == 0 && p->distance > 0.0;
    if (p->cells == 0) {
        p->cell[p->cells++] = nearest;
    }
    return LAC_OK;
}

lac_status lac_points_create(const lac_domain *domain, size_t n, const lac_point_def *def,
                             lac_points **out, lac_error *err)
{
    lac_status status;
    lac_points *points = *out = calloc(1, sizeof *points);
    LAC_FAIL_MEMORY_IF(points == NULL, err);
    points->point = calloc(n + 1, sizeof *points->point);
    LAC_TRY(points->point != NULL ? LAC_OK : lac_fail_memory(err));
    for (; points->n < n; points->n++) {
        lac_point *p = &points->point[points->n];
        LAC_TRY(find(domain, &def[points->n], p, err));
    }
out:
    LAC_MADE(status, out, lac_points_free);
}

void lac_points_free(lac_points *points)
{
    if (points == NULL) {
        return;
    }
    // One that failed stands behind the others.
    for (size_t i = 0; points->point != NULL && i <= points->n; i++) {
        free(points->point[i].name);
        free(points->point[i].cell);
    }
    free(points->point);
    free(points);
}

double lac_point_mean(const lac_point *point, const double *field)
{
    double sum = 0.0;
    for (size_t k = 0; k < point->cells; k++) {
        sum += field[point->cell[k]];
    }
    return sum / (double)point->cells;
}

// A field over the cells, each value its exponential.
static double mean_exp(const lac_point *point, const double *log_field)
{
    double sum = 0.0;
    for (size_t k = 0; k < point->cells; k++) {
        sum += exp(log_field[point->cell[k]]);
    }
    return sum / (double)point->cells;
}

void lac_points_read(const lac_points *points, const double *const *fields, double *value)
{
    for (size_t i = 0; i < points->n; i++, value += LAC_POINT_VALUES) {
        for (size_t k = 0; k < LAC_POINT_VALUES; k++) {
            value[k] = k == LAC_POINT_STATE ? mean_exp(&points->point[i], fields[k])
                                            : lac_point_mean(&points->point[i], fields[k]);
        }
    }
}
