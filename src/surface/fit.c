// SPDX-License-Identifier: GPL-3.0-or-later
// Measured heights laid on the cells of a grid: cropped, padded or resampled, the trend taken off.
#include "surface/fit.h"

#include "base/statistics.h"

// Spacings that agree to this part are one.
static const double agreement = 1e-3;
// How near to a sample a cell is on it [samples].
static const double on_sample = 1e-9;
// How far from the cells the samples of the second face may lie [cells].
static const double off_cell = 0.01;

typedef struct frontier {
    lac_height_map *map;
    size_t *queue, count;
} frontier;

static void reach(frontier *f, size_t to, double height)
{
    if (isnan(f->map->heights[to])) {
        f->map->heights[to] = height;
        f->queue[f->count++] = to;
    }
}

lac_status lac_fill_nearest(lac_height_map *map, lac_error *err)
{
    size_t n = map->nx * map->ny;
    frontier f = {map, malloc(n * sizeof *f.queue), 0};
    LAC_FAIL_MEMORY_IF(f.queue == NULL, err);
    for (size_t i = 0; i < n; i++) {
        if (!isnan(map->heights[i])) {
            f.queue[f.count++] = i;
        }
    }
    for (size_t k = 0; k < f.count && f.count < n; k++) {
        size_t at = f.queue[k];
        size_t ix = at % map->nx;
        double height = map->heights[at];
        if (ix > 0) {
            reach(&f, at - 1, height);
        }
        if (ix + 1 < map->nx) {
            reach(&f, at + 1, height);
        }
        if (at >= map->nx) {
            reach(&f, at - map->nx, height);
        }
        if (at + map->nx < n) {
            reach(&f, at + map->nx, height);
        }
    }
    free(f.queue);
    return LAC_OK;
}

void lac_fill_mean(lac_height_map *map)
{
    size_t n = map->nx * map->ny;
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += isnan(map->heights[i]) ? 0.0 : map->heights[i] / (double)(n - map->masked);
    }
    for (size_t i = 0; i < n; i++) {
        map->heights[i] = isnan(map->heights[i]) ? sum : map->heights[i];
    }
}

// One direction of the map and of the grid.
typedef struct side {
    char name;
    size_t samples, cells;
    double spacing, cell; ///< [m]; spacing is NaN where it is not known
    double centre;        ///< sample at the centre of the interface
    double step;          ///< samples from cell to cell; negative where the map runs backwards
} side;

double lac_fit_spacing(double spacing, size_t n, int fit, size_t cells, double cell)
{
    if (!isnan(spacing)) {
        return spacing;
    }
    return fit == LAC_FIT_RESAMPLE ? (double)cells * cell / (double)n : cell;
}

static double centred(size_t samples, size_t cells, int fit)
{
    double middle = 0.5 * ((double)samples - (double)cells);
    return fit == LAC_FIT_RESAMPLE ? 0.5 * (double)(samples - 1)
                                   : floor(middle) + 0.5 * (double)(cells - 1);
}

lac_placement lac_place_centred(const lac_height_map *map, int fit, const lac_grid *grid)
{
    return (lac_placement){.fit = fit,
                           .centre_x = centred(map->nx, grid->nx, fit),
                           .centre_y = centred(map->ny, grid->ny, fit)};
}

static side side_of(char name, const lac_height_map *map, const lac_placement *place,
                    const lac_grid *grid)
{
    side s = name == 'x' ? (side){'x', map->nx, grid->nx, map->dx, grid->dx, place->centre_x, 1.0}
                         : (side){'y', map->ny, grid->ny, map->dy, grid->dy, place->centre_y, 1.0};
    if (place->fit == LAC_FIT_RESAMPLE) {
        s.step = s.cell / lac_fit_spacing(s.spacing, s.samples, place->fit, s.cells, s.cell);
    }
    s.step = (name == 'x' ? place->mirror_x : place->mirror_y) ? -s.step : s.step;
    return s;
}

static lac_status check_spacing(const char *path, const side *s, lac_error *err)
{
    bool line = s->cells == 1 && s->samples == 1;
    LAC_FAIL_IF(!line && fabs(s->spacing / s->cell - 1.0) > agreement, err, LAC_EINPUT,
                "%s: its samples are %g m apart along %c, but the cells of the interface %g m; "
                "give the interface cells of that size, or use `fit: resample`",
                path, s->spacing, s->name, s->cell);
    return LAC_OK;
}

static lac_status check_size(const char *path, const side *s, int fit, lac_error *err)
{
    double extent = (double)s->samples * s->spacing;
    double wanted = (double)s->cells * s->cell;
    LAC_FAIL_IF(fit == LAC_FIT_RESAMPLE && s->cells > 1 && extent < wanted * (1.0 - agreement), err,
                LAC_EINPUT,
                "%s: it covers %g m along %c, but the interface is %g m; make the interface "
                "smaller, or use `fit: pad` with cells of %g m",
                path, extent, s->name, wanted, s->spacing);
    LAC_FAIL_IF(fit == LAC_FIT_CROP && s->samples < s->cells, err, LAC_EINPUT,
                "%s: it has %zu samples along %c, but the interface %zu cells; make the interface "
                "smaller, or use `fit: pad`%s",
                path, s->samples, s->name, s->cells,
                isnan(s->spacing) ? " or `fit: resample`" : "");
    return fit == LAC_FIT_RESAMPLE ? LAC_OK : check_spacing(path, s, err);
}

// A map away from the centre may leave part of the interface bare, or lie between its cells.
static lac_status check_place(const char *path, const side *s, int fit, lac_error *err)
{
    double half = 0.5 * (double)s->cells * fabs(s->step);
    double below = s->centre + 0.5;
    double above = (double)s->samples - 0.5 - s->centre;
    double first = s->centre - 0.5 * (double)(s->cells - 1) * s->step;
    if (fit != LAC_FIT_PAD && s->cells > 1 && fmin(below, above) < half * (1.0 - agreement)) {
        double metres = s->cell / fabs(s->step);
        double low = s->step > 0.0 ? half - below : half - above;
        return lac_fail(err, LAC_EINPUT,
                        "%s: it lies from %g to %g m along %c of the interface, which goes from 0 "
                        "to %g m; make the interface or the offset smaller",
                        path, low * metres, (low + (double)s->samples) * metres, s->name,
                        (double)s->cells * s->cell);
    }
    LAC_FAIL_IF(fit != LAC_FIT_RESAMPLE && fabs(first - round(first)) > off_cell, err, LAC_EINPUT,
                "%s: its samples lie %g of a cell off the cells along %c, where those of the other "
                "face lie; use `fit: resample`, or another offset",
                path, fabs(first - round(first)), s->name);
    return LAC_OK;
}

// The samples on either side of a cell's centre, and the weight of the second.
typedef struct weight {
    size_t low, high;
    double part;
} weight;

// Beyond the map its edge goes on.
static weight sample_at(const side *s, int fit, size_t cell)
{
    double u = s->centre + ((double)cell - 0.5 * (double)(s->cells - 1)) * s->step;
    // lengths carry rounding: a cell on a sample takes nothing of the next, which may be masked
    u = fit != LAC_FIT_RESAMPLE || fabs(u - round(u)) < on_sample ? round(u) : u;
    u = fmin(fmax(u, 0.0), (double)(s->samples - 1));
    weight w = {.low = (size_t)u};
    w.part = u - (double)w.low;
    w.high = w.part > 0.0 ? w.low + 1 : w.low;
    return w;
}

static double mix(double a, double b, double part)
{
    // a masked sample of weight zero does no harm
    return part > 0.0 ? a + part * (b - a) : a;
}

lac_status lac_fit_map(const char *path, const lac_height_map *map, const lac_placement *place,
                       const lac_grid *grid, double *heights, lac_error *err)
{
    const side sides[2] = {side_of('x', map, place, grid), side_of('y', map, place, grid)};
    for (size_t k = 0; k < 2; k++) {
        LAC_TRY_RETURN(check_size(path, &sides[k], place->fit, err));
        LAC_TRY_RETURN(check_place(path, &sides[k], place->fit, err));
    }
    for (size_t j = 0; j < grid->ny; j++) {
        weight wy = sample_at(&sides[1], place->fit, j);
        const double *low = map->heights + wy.low * map->nx;
        const double *high = map->heights + wy.high * map->nx;
        for (size_t i = 0; i < grid->nx; i++) {
            weight wx = sample_at(&sides[0], place->fit, i);
            heights[j * grid->nx + i] = mix(mix(low[wx.low], low[wx.high], wx.part),
                                            mix(high[wx.low], high[wx.high], wx.part), wy.part);
        }
    }
    return LAC_OK;
}

// h - mean - gx x - gy y; on a regular grid x and y from its centre are orthogonal.
void lac_detrend(int detrend, const lac_grid *grid, double *heights)
{
    size_t n = lac_grid_cells(grid);
    double hx = 0.0, hy = 0.0, xx = 0.0, yy = 0.0;
    double cx = 0.5 * (double)(grid->nx - 1);
    double cy = 0.5 * (double)(grid->ny - 1);
    if (detrend == LAC_DETREND_NONE) {
        return;
    }
    const double mean = lac_mean(n, heights);
    for (size_t i = 0; i < n; i++) {
        double x = (double)(i % grid->nx) - cx;
        double y = (double)(i / grid->nx) - cy;
        heights[i] -= mean;
        hx += heights[i] * x;
        hy += heights[i] * y;
        xx += x * x;
        yy += y * y;
    }
    bool plane = detrend == LAC_DETREND_PLANE;
    double gx = plane && xx > 0.0 ? hx / xx : 0.0;
    double gy = plane && yy > 0.0 ? hy / yy : 0.0;
    for (size_t i = 0; i < n; i++) {
        double x = (double)(i % grid->nx) - cx;
        double y = (double)(i / grid->nx) - cy;
        heights[i] -= gx * x + gy * y;
    }
}

// 0 at the edge, 1 from `part` of the side inwards.
static double window(size_t cell, size_t cells, double part)
{
    double from_edge = fmin((double)cell, (double)(cells - 1 - cell)) + 0.5;
    double u = from_edge / (part * (double)cells);
    return cells == 1 || u >= 1.0 ? 1.0 : 0.5 * (1.0 - cos(M_PI * u));
}

void lac_taper(double part, const lac_grid *grid, double *heights)
{
    for (size_t i = 0; part > 0.0 && i < lac_grid_cells(grid); i++) {
        heights[i] *= window(i % grid->nx, grid->nx, part) * window(i / grid->nx, grid->ny, part);
    }
}
