// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"
#include "lacuna/fractal.h"

enum { FEW_CELLS = 500, LEAST_SIDES = 3 };
static const double dense_fraction = 0.3;

// One map of occupied cells, coarsened in place: boxes of side 2s are pairs of boxes of side s.
typedef struct map {
    size_t nx, ny;
    uint8_t *occupied; // [ny * nx]
} map;

lac_box_def lac_box_default(void) { return (lac_box_def){.origins = 16, .seed = 1}; }

// The shorter side of a plane, the length of a line [cells].
static size_t extent(const lac_grid *grid)
{
    if (grid->nx == 1 || grid->ny == 1) {
        return grid->nx * grid->ny;
    }
    return grid->nx < grid->ny ? grid->nx : grid->ny;
}

static size_t log2_floor(size_t n)
{
    size_t j = 0;
    while (n >>= 1) {
        j++;
    }
    return j;
}

static bool power_of_two(size_t n) { return n > 0 && (n & (n - 1)) == 0; }

// Range of the fit as indices of sides 2^j.
static lac_status choose_range(const lac_grid *grid, const lac_box_def *def, lac_box_count *r,
                               lac_error *err)
{
    size_t most = log2_floor(extent(grid));
    // Between the cell and the whole: 2 to an eighth, wider where the grid is small.
    size_t first = most >= 6 ? 1 : 0;
    size_t last = most >= 6 ? most - 3 : most - (most > 2 ? 1 : 0);
    if (def->smallest != 0) {
        first = log2_floor(def->smallest);
    }
    if (def->largest != 0) {
        last = log2_floor(def->largest);
    }
    bool powers = (def->smallest == 0 || power_of_two(def->smallest)) &&
                  (def->largest == 0 || power_of_two(def->largest));
    if (!powers) {
        return lac_fail(err, LAC_EINPUT,
                        "box counting: sides of %zu to %zu cells are not powers of "
                        "two",
                        def->smallest, def->largest);
    }
    if (last > most || last < first || last - first + 1 < LEAST_SIDES) {
        return lac_fail(err, LAC_EINPUT,
                        "box counting: at least three sides must fit a grid of %zu x %zu cells",
                        grid->nx, grid->ny);
    }
    r->sizes = most + 1;
    r->fit_first = first;
    r->fit_last = last;
    return LAC_OK;
}

// Puts the domain on a map, shifted; the map is large enough for a shift without wrapping.
static void fill(const lac_domain *domain, size_t ox, size_t oy, map *m)
{
    const lac_grid *grid = &domain->grid;
    memset(m->occupied, 0, m->nx * m->ny);
    for (size_t i = 0; i < domain->n; i++) {
        size_t x = domain->index[i] % grid->nx + ox;
        size_t y = domain->index[i] / grid->nx + oy;
        if (grid->periodic) {
            x %= grid->nx;
            y %= grid->ny;
        }
        m->occupied[y * m->nx + x] = 1;
    }
}

static size_t count(const map *m)
{
    size_t n = 0;
    for (size_t i = 0; i < m->nx * m->ny; i++) {
        n += m->occupied[i];
    }
    return n;
}

// A box is occupied if one of its four is. In place: what is written lies before what is read.
static void coarsen(map *m)
{
    size_t nx = (m->nx + 1) / 2;
    size_t ny = (m->ny + 1) / 2;
    for (size_t y = 0; y < ny; y++) {
        size_t y1 = 2 * y + 1 < m->ny ? 2 * y + 1 : 2 * y;
        for (size_t x = 0; x < nx; x++) {
            size_t x1 = 2 * x + 1 < m->nx ? 2 * x + 1 : 2 * x;
            const uint8_t *row = &m->occupied[2 * y * m->nx];
            const uint8_t *next = &m->occupied[y1 * m->nx];
            uint8_t any = row[2 * x] | row[x1] | next[2 * x] | next[x1];
            m->occupied[y * nx + x] = any;
        }
    }
    m->nx = nx;
    m->ny = ny;
}

// Occupied boxes of every side from one origin.
static void count_from(const lac_domain *domain, size_t ox, size_t oy, uint8_t *work, size_t sizes,
                       double *counts)
{
    const lac_grid *grid = &domain->grid;
    map m = {grid->nx, grid->ny, work};
    if (!grid->periodic) {
        m.nx += ox;
        m.ny += oy;
    }
    fill(domain, ox, oy, &m);
    counts[0] = (double)domain->n;
    for (size_t j = 1; j < sizes; j++) {
        coarsen(&m);
        counts[j] = (double)count(&m);
    }
}

// Dimension over sides first ... last: minus the least-squares slope of ln N on ln s; the standard
// error of the regression goes to `error` (0 for two sides).
static double fit(const double *counts, size_t first, size_t last, double *error)
{
    double n = (double)(last - first + 1);
    double mean_x = 0.5 * (double)(first + last) * log(2.0);
    double mean_y = 0.0;
    for (size_t j = first; j <= last; j++) {
        mean_y += log(counts[j]) / n;
    }
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (size_t j = first; j <= last; j++) {
        double x = (double)j * log(2.0) - mean_x;
        double y = log(counts[j]) - mean_y;
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    double slope = xy / xx;
    double rest = fmax(0.0, yy - slope * xy);
    *error = n > 2.0 ? sqrt(rest / (n - 2.0) / xx) : 0.0;
    return -slope;
}

// rms departure of the dimension over all runs of at least half of the sides (and two).
static double range_spread(const lac_box_count *r)
{
    size_t sides = r->fit_last - r->fit_first + 1;
    size_t least = (sides + 1) / 2;
    double sum = 0.0;
    double runs = 0.0;
    double ignored;
    for (size_t a = r->fit_first; a + least <= r->fit_last + 1; a++) {
        for (size_t b = a + least - 1; b <= r->fit_last; b++) {
            double departure = fit(r->count, a, b, &ignored) - r->dimension;
            sum += departure * departure;
            runs += 1.0;
        }
    }
    return sqrt(sum / runs);
}

// Mean and least counts over the origins; returns the variance of the dimension among them.
static double count_boxes(const lac_domain *domain, const lac_box_def *def, uint8_t *work,
                          lac_box_count *r)
{
    const lac_grid *grid = &domain->grid;
    uint64_t shifts = (uint64_t)1 << r->fit_last;
    double sum = 0.0;
    double sum2 = 0.0;
    for (size_t k = 0; k < def->origins; k++) {
        uint64_t bits[4];
        double counts[LAC_BOX_SIZES];
        double ignored;
        lac_random(def->seed, LAC_STREAM_BOX_ORIGIN, k, 0, bits);
        size_t ox = grid->nx > 1 ? (size_t)(bits[0] % (grid->periodic ? grid->nx : shifts)) : 0;
        size_t oy = grid->ny > 1 ? (size_t)(bits[1] % (grid->periodic ? grid->ny : shifts)) : 0;
        count_from(domain, ox, oy, work, r->sizes, counts);
        for (size_t j = 0; j < r->sizes; j++) {
            r->count[j] += counts[j] / (double)def->origins;
            r->minimum[j] = k == 0 ? counts[j] : fmin(r->minimum[j], counts[j]);
        }
        double dimension = fit(counts, r->fit_first, r->fit_last, &ignored);
        sum += dimension;
        sum2 += dimension * dimension;
    }
    double mean = sum / (double)def->origins;
    return fmax(0.0, sum2 / (double)def->origins - mean * mean);
}

static void measure(const lac_domain *domain, double origin_variance, lac_box_count *r)
{
    for (size_t j = 0; j < r->sizes; j++) {
        r->side[j] = (double)((size_t)1 << j);
        r->slope[j] = j + 1 < r->sizes ? log2(r->count[j + 1] / r->count[j]) : (double)NAN;
    }
    double regression;
    double ignored;
    r->dimension = fit(r->count, r->fit_first, r->fit_last, &regression);
    double ranges = range_spread(r);
    // Boxes that stick out over an edge make the mean differ from the least cover.
    double cover = fit(r->minimum, r->fit_first, r->fit_last, &ignored) - r->dimension;
    r->error = sqrt(origin_variance + ranges * ranges + cover * cover + regression * regression);
    r->few_cells = domain->n < FEW_CELLS;
    r->dense = (double)domain->n > dense_fraction * (double)lac_grid_cells(&domain->grid);
}

lac_status lac_box_dimension(const lac_domain *domain, const lac_box_def *def,
                             lac_box_count *result, lac_error *err)
{
    const lac_grid *grid = &domain->grid;
    uint8_t *work = NULL;
    *result = (lac_box_count){0};
    lac_status status;
    if (domain->n == 0 || lac_grid_cells(grid) == 0) {
        return lac_fail(err, LAC_EINPUT, "box counting: no cell is in contact");
    }
    if (def->origins == 0) {
        return lac_fail(err, LAC_EINPUT, "box counting: at least one origin is needed");
    }
    LAC_TRY(choose_range(grid, def, result, err));
    // Room for the largest shift where nothing wraps.
    size_t room = grid->periodic ? 0 : (size_t)1 << result->fit_last;
    size_t nx = grid->nx + (grid->nx > 1 ? room : 0);
    size_t ny = grid->ny + (grid->ny > 1 ? room : 0);
    work = malloc(nx * ny);
    if (work == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    measure(domain, count_boxes(domain, def, work, result), result);
out:
    free(work);
    return status;
}
