// SPDX-License-Identifier: GPL-3.0-or-later
// The slip of half-spaces under tractions on the contact cells, and its inverse by iteration.
#include "transfer/compliance.h"

#include "base/range.h"
#include "base/statistics.h"

enum { MAX_ITERATIONS = 1000 };
#define ELSEWHERE UINT32_MAX
static const size_t most_table = (size_t)1 << 29; // numbers

struct lac_compliance {
    size_t n;
    lac_strip rows; // of the grid, that are here
    uint32_t *at;   // [n] index of each cell in the transform's rows; ELSEWHERE: in no row here
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
    c->in_order = c->rows.team == NULL;
    for (size_t i = 0; i < c->n; i++) {
        const size_t x = domain->index[i] % grid->nx;
        const size_t y = domain->index[i] / grid->nx - c->rows.first; // before it, more than n
        c->at[i] = y < c->rows.n ? (uint32_t)(y * c->fft->nx + x) : ELSEWHERE;
        c->in_order = c->in_order && c->at[i] == i;
    }
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
    // Ranks share the rows of a plane, but those of a small one each has as a whole.
    const bool shared = grid->ny > 1 && !rock->surface && lac_grid_cells(grid) >= LAC_RANGE_ALONE;
    lac_team *team = shared ? rock->team : NULL;
    c->rows = lac_strip_rows(team, grid->ny);
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
    modes = c->fft->ny * c->fft->columns.n;
    c->at = lac_team_alloc(team, n * sizeof *c->at);
    c->stiffness = lac_team_alloc(team, modes * depths * sizeof *c->stiffness);
    c->compliance = lac_team_alloc(team, modes * sizeof *c->compliance);
    c->vectors = lac_team_alloc(team, 4 * n * sizeof *c->vectors);
    const bool room =
        c->at != NULL && c->stiffness != NULL && c->compliance != NULL && c->vectors != NULL;
    LAC_TRY(room ? LAC_OK : lac_fail_memory(err));
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
    for (size_t i = 0; i < c->n; i++) {
        if (c->at[i] != ELSEWHERE) {
            real[c->at[i]] = x[i];
        }
    }
    by(fft, symbol);
    for (size_t i = 0; i < c->n; i++) {
        y[i] = c->at[i] != ELSEWHERE ? real[c->at[i]] : 0.0;
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
