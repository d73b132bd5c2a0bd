// SPDX-License-Identifier: GPL-3.0-or-later
// Box-counting dimension of the contact cells, with an error that counts the choice of boxes.
#include "base/rng.h"
#include "base/statistics.h"
#include "fractal/fractal.h"

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

static bool power_of_two(size_t n) { return n > 0 && (n & (n - 1)) == 0; }

// Range of the fit as indices of sides 2^j.
static lac_status choose_range(const lac_grid *grid, const lac_box_def *def, lac_box_count *r,
                               lac_error *err)
{
    size_t most = lac_octave(extent(grid));
    // Between the cell and the whole: 2 to an eighth, wider where the grid is small.
    size_t first = most >= 6 ? 1 : 0;
    size_t last = most >= 6 ? most - 3 : most - (most > 2 ? 1 : 0);
    if (def->smallest != 0) {
        first = lac_octave(def->smallest);
    }
    if (def->largest != 0) {
        last = lac_octave(def->largest);
    }
    bool powers = (def->smallest == 0 || power_of_two(def->smallest)) &&
                  (def->largest == 0 || power_of_two(def->largest));
    LAC_FAIL_IF(!powers, err, LAC_EINPUT,
                "box counting: sides of %zu to %zu cells are not powers of two", def->smallest,
                def->largest);
    LAC_FAIL_IF(last > most || last < first || last - first + 1 < LEAST_SIDES, err, LAC_EINPUT,
                "box counting: at least three sides must fit a grid of %zu x %zu cells", grid->nx,
                grid->ny);
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
    size_t nx = (m->nx + 1) / 2, ny = (m->ny + 1) / 2;
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

// Logarithms of sides and counts, to be fitted.
typedef struct logs {
    double side[LAC_BOX_SIZES], count[LAC_BOX_SIZES];
} logs;

static logs logs_of(const double *counts, size_t sizes)
{
    logs l;
    for (size_t j = 0; j < sizes; j++) {
        l.side[j] = (double)j * log(2.0);
        l.count[j] = log(counts[j]);
    }
    return l;
}

// Least squares over sides first ... last: the dimension is minus the slope.
static double fit(const double *counts, size_t first, size_t last)
{
    logs l = logs_of(counts, last + 1);
    const lac_line line = lac_line_fit(last - first + 1, &l.side[first], &l.count[first]);
    return -lac_line_slope(&line);
}

// Mean and least counts over the origins; returns the variance of the dimension among them.
static double count_boxes(const lac_domain *domain, const lac_box_def *def, uint8_t *work,
                          lac_box_count *r)
{
    const lac_grid *grid = &domain->grid;
    uint64_t shifts = (uint64_t)1 << r->fit_last;
    double sum = 0.0, sum2 = 0.0;
    // The grid's own blocks are the tightest cover of a set made of them; random origins miss it.
    count_from(domain, 0, 0, work, r->sizes, r->minimum);
    for (size_t k = 0; k < def->origins; k++) {
        uint64_t bits[4];
        double counts[LAC_BOX_SIZES] = {0};
        lac_random(def->seed, LAC_STREAM_BOX_ORIGIN, k, 0, bits);
        size_t ox = grid->nx > 1 ? (size_t)(bits[0] % (grid->periodic ? grid->nx : shifts)) : 0;
        size_t oy = grid->ny > 1 ? (size_t)(bits[1] % (grid->periodic ? grid->ny : shifts)) : 0;
        count_from(domain, ox, oy, work, r->sizes, counts);
        for (size_t j = 0; j < r->sizes; j++) {
            r->count[j] += counts[j] / (double)def->origins;
            r->minimum[j] = fmin(r->minimum[j], counts[j]);
        }
        double dimension = fit(counts, r->fit_first, r->fit_last);
        sum += dimension;
        sum2 += dimension * dimension;
    }
    double mean = sum / (double)def->origins;
    return fmax(0.0, sum2 / (double)def->origins - mean * mean);
}

// What a wider range, the least cover or the edges would change: guesses at one bias, the largest.
static double bias(const lac_grid *grid, const lac_box_count *r)
{
    // Boxes of the next smaller side still see the cells: counts bend most there.
    double finer =
        r->fit_first > 0 ? fit(r->count, r->fit_first - 1, r->fit_last) - r->dimension : 0.0;
    double cover = fit(r->minimum, r->fit_first, r->fit_last) - r->dimension;
    double edge = 0.0;
    if (!grid->periodic) {
        // A side of n cells is cut into 1 + (s - 1)/n times as many boxes as fit it.
        double whole[LAC_BOX_SIZES];
        for (size_t j = 0; j < r->sizes; j++) {
            double along_x = grid->nx > 1 ? 1.0 + (r->side[j] - 1.0) / (double)grid->nx : 1.0;
            double along_y = grid->ny > 1 ? 1.0 + (r->side[j] - 1.0) / (double)grid->ny : 1.0;
            whole[j] = r->count[j] / (along_x * along_y);
        }
        edge = fit(whole, r->fit_first, r->fit_last) - r->dimension;
    }
    return fmax(fabs(finer), fmax(fabs(cover), fabs(edge)));
}

static void measure(const lac_domain *domain, double origin_variance, lac_box_count *r)
{
    for (size_t j = 0; j < r->sizes; j++) {
        r->side[j] = (double)((size_t)1 << j);
        r->slope[j] = j + 1 < r->sizes ? log2(r->count[j + 1] / r->count[j]) : (double)NAN;
    }
    size_t first = r->fit_first;
    logs l = logs_of(r->count, r->sizes);
    lac_line line = lac_line_fit(r->fit_last - first + 1, &l.side[first], &l.count[first]);
    double ranges = lac_line_range_spread(&line, &l.side[first], &l.count[first]);
    r->dimension = -lac_line_slope(&line);
    r->regression_error = lac_line_error(&line);
    double departure = hypot(ranges, bias(&domain->grid, r));
    r->error =
        sqrt(origin_variance + departure * departure + r->regression_error * r->regression_error);
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
    LAC_FAIL_IF(domain->n == 0 || lac_grid_cells(grid) == 0, err, LAC_EINPUT,
                "box counting: no cell is in contact");
    LAC_FAIL_IF(def->origins == 0, err, LAC_EINPUT, "box counting: at least one origin is needed");
    LAC_TRY(choose_range(grid, def, result, err));
    // Room for the largest shift where nothing wraps.
    size_t room = grid->periodic ? 0 : (size_t)1 << result->fit_last;
    size_t nx = grid->nx + (grid->nx > 1 ? room : 0);
    size_t ny = grid->ny + (grid->ny > 1 ? room : 0);
    work = malloc(nx * ny);
    LAC_TRY(work != NULL ? LAC_OK : lac_fail_memory(err));
    measure(domain, count_boxes(domain, def, work, result), result);
out:
    free(work);
    return status;
}
