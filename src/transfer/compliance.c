// SPDX-License-Identifier: GPL-3.0-or-later
// The slip of half-spaces under tractions on the contact cells, and its inverse by iteration.
#include "transfer/compliance.h"

#include "base/range.h"
#include "base/statistics.h"

enum { MAX_ITERATIONS = 1000 };
static const size_t most_table = (size_t)1 << 29; // numbers

struct lac_compliance {
    size_t n;
    lac_strip rows; // of the grid, that are here
    size_t own;     // cells in them
    uint32_t *cell; // [own] which they are; NULL: all
    size_t *at;     // [own] index of each in the transform's rows
    size_t gap;     // first column of a row that holds nothing: zeros; 0: no row is full
    bool in_order;  // at[i] = i
    bool by_rows;   // the stiffness is a matrix of rows for each wave along x
    lac_fft *fft;
    double *stiffness, *compliance; // [nkx * ny] of each mode: lac_kernels_fill
    double *vectors;                // [4][n] of the conjugate gradients
};

// Where the cells lie in the transform's grid.
static void place_cells(lac_compliance *c, const lac_domain *domain)
{
    const lac_grid *grid = &domain->grid;
    c->gap = c->n == lac_grid_cells(grid) ? grid->nx : 0;
    c->in_order = c->cell == NULL;
    size_t own = 0;
    for (size_t i = 0; i < c->n; i++) {
        size_t x = domain->index[i] % grid->nx, y = domain->index[i] / grid->nx;
        if (c->cell != NULL && (y < c->rows.first || y >= c->rows.first + c->rows.n)) {
            continue;
        }
        if (c->cell != NULL) {
            c->cell[own] = (uint32_t)i;
        }
        c->at[own] = (y - c->rows.first) * c->fft->nx + x;
        c->in_order = c->in_order && c->at[own] == i;
        own++;
    }
}

// How many cells are in the rows here.
static size_t count_own(const lac_domain *domain, const lac_strip *rows)
{
    const size_t first = rows->first * domain->grid.nx, n = rows->n * domain->grid.nx;
    size_t own = 0;
    for (size_t i = 0; rows->team != NULL && i < domain->n; i++) {
        own += domain->index[i] - first < n; // below the first it wraps round
    }
    return rows->team != NULL ? own : domain->n;
}

static lac_status make_room(lac_compliance *c, const lac_domain *domain, size_t depths,
                            lac_error *err)
{
    const size_t modes = c->fft->ny * c->fft->columns.n;
    c->own = count_own(domain, &c->rows);
    c->at = malloc((c->own + 1) * sizeof *c->at);
    c->cell = c->rows.team != NULL ? malloc((c->own + 1) * sizeof *c->cell) : NULL;
    c->stiffness = malloc((modes * depths + 1) * sizeof *c->stiffness);
    c->compliance = malloc((modes + 1) * sizeof *c->compliance);
    c->vectors = malloc(4 * c->n * sizeof *c->vectors);
    const bool room = c->at != NULL && (c->rows.team == NULL || c->cell != NULL) &&
                      c->stiffness != NULL && c->compliance != NULL && c->vectors != NULL;
    return room ? LAC_OK : lac_fail_memory(err);
}

// Ranks share the rows of a plane, but those of a small one each has as a whole.
static lac_team *team_of(const lac_grid *grid, const lac_rock *rock)
{
    const bool plane = grid->ny > 1 && !rock->surface;
    return plane && lac_grid_cells(grid) >= LAC_RANGE_ALONE ? rock->team : NULL;
}

lac_status lac_compliance_create(const lac_domain *domain, const lac_rock *rock,
                                 lac_compliance **out, lac_error *err)
{
    *out = NULL;
    double g = rock->shear_modulus, nu = rock->poisson;
    LAC_FAIL_IF(!(g > 0 && isfinite(g)) || !(nu > -1 && nu <= 0.5), err, LAC_EINPUT,
                "needs a material with a shear modulus > 0 Pa and a Poisson ratio in (-1, 0.5], "
                "not %g Pa and %g",
                g, nu);
    const lac_grid *grid = &domain->grid;
    size_t n = domain->n;
    const bool mirror = rock->surface && rock->line;
    const bool deep = rock->surface && !rock->line; // depths are not alike
    size_t mx = grid->periodic || (grid->nx == 1 && !mirror) ? 1 : 2;
    size_t my = grid->periodic || grid->ny == 1 || deep ? 1 : 2;
    lac_status status = LAC_OK;
    lac_compliance *c = *out = calloc(1, sizeof *c);
    LAC_FAIL_MEMORY_IF(c == NULL, err);
    c->n = n;
    c->rows = lac_strip_rows(team_of(grid, rock), grid->ny);
    lac_team *team = c->rows.team;
    LAC_TRY(team != NULL
                ? lac_fft_share_filter(mx * grid->nx, my * grid->ny, grid->ny, team, &c->fft, err)
                : lac_fft_create(mx * grid->nx, my * grid->ny, &c->fft, err));
    if (mirror) {
        lac_fft_mirror(c->fft);
    }
    c->by_rows = deep;
    size_t modes = c->fft->ny * c->fft->nkx;
    const size_t depths = deep ? grid->ny : 1;
    LAC_TRY(
        modes <= most_table / depths
            ? LAC_OK
            : lac_fail(err, LAC_EINPUT,
                       "a free surface beside %zu x %zu cells takes a table of %.0f GB, at most "
                       "%.0f are allowed: fewer cells of depth",
                       grid->nx, grid->ny, 8e-9 * (double)modes * (double)depths,
                       8e-9 * (double)most_table));
    status = make_room(c, domain, depths, err);
    LAC_TRY(lac_team_agree(team, status, err)); // what follows all ranks do together
    place_cells(c, domain);
    if (team == NULL) {
        c->fft->measure = rock->measure;
        LAC_TRY(lac_fft_plan_filter(c->fft, grid->ny, err));
    }
    LAC_TRY(lac_kernels_fill(c->fft, grid, rock, c->stiffness, c->compliance, err));
out:
    LAC_MADE(status, out, lac_compliance_free);
}

void lac_compliance_free(lac_compliance *c)
{
    if (c != NULL) {
        lac_fft_free(c->fft);
        free(c->at);
        free(c->cell);
        free(c->stiffness);
        free(c->compliance);
        free(c->vectors);
        free(c);
    }
}

static void remove_mean(size_t n, double *x)
{
    double mean = lac_sum(n, x) / (double)n;
    for (size_t i = 0; i < n; i++) {
        x[i] -= mean;
    }
}

static void clear_gaps(const lac_compliance *c)
{
    const lac_fft *fft = c->fft;
    const size_t rest = fft->nx - c->gap;
    for (size_t row = 0; rest > 0 && row < c->rows.n; row++) {
        memset(fft->real + row * fft->nx + c->gap, 0, rest * sizeof *fft->real);
    }
}

// y = R F^-1 symbol F R^T x: zeros in the gaps, restriction R.
static void filter(lac_compliance *c, const double *symbol, const double *x, double *y)
{
    lac_fft *fft = c->fft;
    void (*const by)(lac_fft *, const double *) = c->by_rows ? lac_fft_filter_rows : lac_fft_filter;
    double *real = fft->real;
    clear_gaps(c);
    if (c->in_order) {
        memcpy(real, x, c->n * sizeof *real);
        by(fft, symbol);
        memcpy(y, real, c->n * sizeof *real);
        return;
    }
    for (size_t i = 0; i < c->own; i++) {
        real[c->at[i]] = x[c->cell != NULL ? c->cell[i] : i];
    }
    by(fft, symbol);
    if (c->cell != NULL) {
        memset(y, 0, c->n * sizeof *y);
    }
    for (size_t i = 0; i < c->own; i++) {
        y[c->cell != NULL ? c->cell[i] : i] = real[c->at[i]];
    }
    lac_team_join(c->rows.team, y, c->n);
}

void lac_compliance_slip(lac_compliance *c, const double *traction, double *slip)
{
    filter(c, c->compliance, traction, slip);
}

void lac_compliance_traction(lac_compliance *c, const double *slip, double *traction)
{
    filter(c, c->stiffness, slip, traction);
}

// The inverse on full contact; elsewhere near enough to it to precondition.
static void precondition(lac_compliance *c, const double *slip, double *traction)
{
    filter(c, c->stiffness, slip, traction);
    remove_mean(c->n, traction);
}

lac_status lac_compliance_invert(lac_compliance *c, const double *slip, double tolerance,
                                 double *traction, double *energy, lac_error *err)
{
    size_t n = c->n;
    double *r = c->vectors, *z = r + n, *p = z + n, *q = p + n;
    memset(traction, 0, n * sizeof *traction);
    memcpy(r, slip, n * sizeof *r);
    remove_mean(n, r);
    precondition(c, r, z);
    memcpy(p, z, n * sizeof *p);
    double rho = lac_dot(n, r, z), gain = INFINITY;
    *energy = 0;
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        if (rho == 0) {
            return LAC_OK;
        }
        lac_compliance_slip(c, p, q);
        remove_mean(n, q);
        double step = rho / lac_dot(n, p, q);
        for (size_t j = 0; j < n; j++) {
            traction[j] += step * p[j];
            r[j] -= step * q[j];
        }
        // slip . traction grows by these gains; what is still to come falls off as they do.
        double last = gain;
        gain = step * rho;
        *energy += gain;
        if (!isfinite(gain)) {
            break;
        }
        if (gain + last <= tolerance * *energy || gain <= 1e-15 * *energy) {
            return LAC_OK;
        }
        precondition(c, r, z);
        double before = rho;
        rho = lac_dot(n, r, z);
        for (size_t j = 0; j < n; j++) {
            p[j] = z[j] + rho / before * p[j];
        }
    }
    return lac_fail(err, LAC_ENUMERIC,
                    "the elastic half-space on %zu contact cells did not converge in %d iterations",
                    n, MAX_ITERATIONS);
}
