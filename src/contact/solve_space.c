// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic displacements under given pressures by Fourier transforms, periodic or with free edges.
#include "base/fft.h"
#include "base/vmath.h"
#include "contact/solve.h"

// Symbols of the two filters, over the number of cells of the transform (a pair of transforms
// multiplies by it). kappa comes from two lines of wavenumbers rather than from a table.

static double column_start(const lac_half_space *s, size_t k)
{
    return (double)k * s->dqx * ((double)k * s->dqx);
}

static double cells_of(const lac_half_space *s) { return (double)s->mx * (double)s->my; }

// of q2, the square of kappa; nothing at kappa = 0. A bare `reals restrict w` reads as a product to
// lint.
#define SYMBOL(name, reals, result)                               \
    static void name(const void *context, size_t k, void *factor) \
    {                                                             \
        const lac_half_space *s = context;                        \
        const double *restrict qy2 = s->qy2;                      \
        __typeof__(reals) restrict w = factor;                    \
        const double qx2 = column_start(s, k);                    \
        for (size_t j = 0; j <= s->my / 2; j++) {                 \
            const double q2 = qx2 + qy2[j];                       \
            w[j] = (result);                                      \
        }                                                         \
        w[0] = k > 0 ? w[0] : 0;                                  \
    }

SYMBOL(stiffness_single, float *, (float)(1.0 / cells_of(s)) * sqrtf((float)q2))
SYMBOL(stiffness_double, double *, sqrt(q2) / cells_of(s))
SYMBOL(periodic_single, float *, (float)(1.0 / cells_of(s)) / sqrtf((float)q2))
SYMBOL(periodic_double, double *, 1.0 / (sqrt(q2) * cells_of(s)))

// Love's kernel in column k. Of a square grid of square cells it is the same along both axes: kept
// is each column down to the diagonal, and it goes on along that row.
#define FREE(name, reals)                                                             \
    static void name(const void *context, size_t k, void *factor)                     \
    {                                                                                 \
        const lac_half_space *s = context;                                            \
        const size_t n = s->my / 2 + 1, straight = s->triangle ? k + 1 : n;           \
        const size_t at = s->triangle ? k * (k + 1) / 2 : (k - s->columns.first) * n; \
        const double *restrict from = &s->compliance[at];                             \
        __typeof__(reals) restrict w = factor;                                        \
        for (size_t j = 0; j < straight; j++) {                                       \
            w[j] = (__typeof__(*w))from[j];                                           \
        }                                                                             \
        from += k;                                                                    \
        for (size_t j = straight; j < n; j++) {                                       \
            from += j;                                                                \
            w[j] = (__typeof__(*w))*from;                                             \
        }                                                                             \
    }

FREE(free_single, float *)
FREE(free_double, double *)

// A cell's displacement under its own pressure is the mean of the compliance over the spectrum.
static double periodic_self(const lac_half_space *s)
{
    double self = 0.0;
    for (size_t k = 0; k < s->nkx; k++) {
        double column = 0.0;
        for (size_t j = k > 0 ? 0 : 1; j <= s->my / 2; j++) {
            double kappa = sqrt(column_start(s, k) + s->qy2[j]);
            column += (j > 0 && 2 * j < s->my ? 2.0 : 1.0) / kappa;
        }
        self += (k > 0 && 2 * k < s->mx ? 2.0 : 1.0) * column / cells_of(s);
    }
    return self;
}

// The integral of 1/r from the origin to the corners (x, (j - 1/2) dy), j = 0 ... n - 1, is
// x asinh(y/|x|) + y asinh(x/|y|). @param work [2 * n]
static void love_corners(size_t n, double x, double dy, double *corner, double *work)
{
    double *first = work;
    double *second = &work[n];
    for (size_t j = 0; j < n; j++) {
        double y = ((double)j - 0.5) * dy;
        first[j] = y / fabs(x);
        second[j] = x / fabs(y);
    }
    lac_vasinh(2 * n, work, work);
    for (size_t j = 0; j < n; j++) {
        corner[j] = x * first[j] + ((double)j - 0.5) * dy * second[j];
    }
}

// u at every distance from a cell under unit pressure, that is the integral of 1/r over a cell at
// that distance, by columns; distances beyond half the transform are mirror images.
static lac_status fill_kernel(lac_half_space *s, double dx, double dy, lac_error *err)
{
    size_t n = s->my / 2 + 1, first = s->columns.first;
    size_t corners = n + 1;
    double *low = malloc(4 * corners * sizeof *low);
    LAC_FAIL_MEMORY_IF(low == NULL, err);
    double *high = &low[corners];
    double *work = &high[corners];
    love_corners(corners, ((double)first - 0.5) * dx, dy, low, work);
    for (size_t k = first; k < first + s->columns.n; k++) {
        double *column = &s->compliance[(k - first) * n];
        love_corners(corners, ((double)k + 0.5) * dx, dy, high, work);
        for (size_t j = 0; j < n; j++) {
            column[j] = (high[j + 1] - high[j]) - (low[j + 1] - low[j]);
        }
        memcpy(low, high, corners * sizeof *low);
    }
    free(low);
    return LAC_OK;
}

// Free boundaries: Love's solution for a uniform pressure on each cell. It is even in both
// directions, so that a quarter of it and of its transform are all there is.
static lac_status fill_free(lac_half_space *s, const lac_extent *extent, lac_error *err)
{
    size_t n = s->columns.n * (s->my / 2 + 1);
    s->compliance = malloc((n + 1) * sizeof *s->compliance);
    lac_status status = s->compliance == NULL
                            ? lac_fail_memory(err)
                            : fill_kernel(s, 1.0 / (extent->dqx * (double)s->nx),
                                          1.0 / (extent->dqy * (double)s->ny), err);
    LAC_TRY_RETURN(lac_team_agree(s->rows.team, status, err)); // what follows all do together
    s->self = s->columns.first == 0 && n > 0 ? s->compliance[0] : 0.0;
    lac_team_join(s->rows.team, &s->self, 1);
    const size_t column = s->my / 2 + 1;
    const bool square = s->nkx == column && extent->dqx == extent->dqy;
    LAC_TRY_RETURN(lac_fft_share_even(&s->columns, column, square, s->compliance, err));
    s->triangle = square && s->rows.team == NULL;
    size_t next = 0; // in place: nothing is written beyond what is read
    for (size_t i = 0; i < n; i++) {
        if (!s->triangle || i % column <= i / column) {
            s->compliance[next++] = s->compliance[i] / cells_of(s);
        }
    }
    double *less = realloc(s->compliance, (next + 1) * sizeof *less);
    LAC_FAIL_MEMORY_IF(less == NULL, err);
    s->compliance = less;
    return LAC_OK;
}

static lac_status fill_wavenumbers(lac_half_space *s, const lac_extent *extent, lac_error *err)
{
    s->nkx = s->mx / 2 + 1;
    s->dqx = extent->dqx * (double)s->nx / (double)s->mx;
    double dqy = extent->dqy * (double)s->ny / (double)s->my;
    s->qy2 = malloc((s->my / 2 + 1) * sizeof *s->qy2);
    LAC_FAIL_MEMORY_IF(s->qy2 == NULL, err);
    for (size_t j = 0; j <= s->my / 2; j++) {
        s->qy2[j] = (double)j * dqy * ((double)j * dqy);
    }
    return LAC_OK;
}

lac_status lac_half_space_create(const lac_extent *extent, lac_half_space **out, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_half_space *s = *out = calloc(1, sizeof *s);
    LAC_TRY(s != NULL ? LAC_OK : lac_fail_memory(err));
    s->nx = extent->nx;
    s->ny = extent->ny;
    s->mx = extent->periodic || s->nx == 1 ? s->nx : 2 * s->nx;
    s->my = extent->periodic || s->ny == 1 ? s->ny : 2 * s->ny;
    s->rows = extent->rows;
    LAC_TRY(lac_filter_create((const size_t[]){s->nx, s->ny}, (const size_t[]){s->mx, s->my},
                              s->rows.team, &s->filter, err));
    LAC_TRY(fill_wavenumbers(s, extent, err));
    s->columns = lac_filter_columns(s->rows.team, s->nkx);
    if (extent->periodic) {
        s->self = periodic_self(s);
    } else {
        LAC_TRY(fill_free(s, extent, err));
    }
out:
    status = lac_team_agree(extent->rows.team, status, err);
    LAC_MADE(status, out, lac_half_space_free);
}

void lac_half_space_free(lac_half_space *s)
{
    if (s == NULL) {
        return;
    }
    free(s->qy2);
    free(s->compliance);
    lac_filter_free(s->filter);
    free(s);
}

static lac_filter_symbol compliance_of(const lac_half_space *s)
{
    bool single = lac_filter_precision(s->filter) == LAC_SINGLE;
    if (s->compliance != NULL) {
        return single ? free_single : free_double;
    }
    return single ? periodic_single : periodic_double;
}

void lac_half_space_displace(lac_half_space *s)
{
    lac_filter_multiply(s->filter, compliance_of(s), s, NULL);
}

static lac_filter_symbol stiffness_of(const lac_half_space *s)
{
    bool single = lac_filter_precision(s->filter) == LAC_SINGLE;
    return single ? stiffness_single : stiffness_double;
}

void lac_half_space_unload(lac_half_space *s, double *power)
{
    lac_filter_multiply(s->filter, stiffness_of(s), s, power);
}

double lac_half_space_energy(lac_half_space *s)
{
    return lac_filter_power(s->filter, compliance_of(s), s);
}
