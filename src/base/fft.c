// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms of real fields in two dimensions by FFTW, and products with a table in between.
#include "base/fft.h"

#include <fftw3.h>

#include "base/clones.h"

enum { BLOCK = 16 }; // columns at a time

lac_status lac_fft_create(size_t nx, size_t ny, lac_fft **out, lac_error *err)
{
    *out = NULL;
    LAC_FAIL_IF(nx == 0 || ny == 0 || nx > INT_MAX || ny > INT_MAX, err, LAC_EINPUT,
                "a transform of %zu x %zu cells is not possible", nx, ny);
    lac_fft *fft = *out = calloc(1, sizeof *fft);
    LAC_FAIL_MEMORY_IF(fft == NULL, err);
    fft->nx = nx;
    fft->ny = ny;
    fft->nkx = nx / 2 + 1;
    fft->strip = lac_strip_of(NULL, ny, 1);
    fft->columns = lac_strip_of(NULL, fft->nkx, 1);
    fft->real = fftw_alloc_real(nx * ny);
    fft->spectrum = (double _Complex *)fftw_alloc_complex(fft->nkx * ny);
    if (fft->real != NULL && fft->spectrum != NULL) {
        fft->forward = fftw_plan_dft_r2c_2d((int)ny, (int)nx, fft->real,
                                            (fftw_complex *)fft->spectrum, FFTW_ESTIMATE);
        fft->inverse = fftw_plan_dft_c2r_2d((int)ny, (int)nx, (fftw_complex *)fft->spectrum,
                                            fft->real, FFTW_ESTIMATE);
    }
    const bool planned = fft->forward != NULL && fft->inverse != NULL;
    const lac_status status = planned ? LAC_OK : lac_fail_memory(err);
    LAC_MADE(status, out, lac_fft_free);
}

void lac_fft_free(lac_fft *fft)
{
    if (fft == NULL) {
        return;
    }
    void *plans[] = {fft->forward,      fft->inverse,       fft->rows_forward,
                     fft->rows_inverse, fft->block_forward, fft->block_inverse};
    for (size_t i = 0; i < sizeof plans / sizeof *plans; i++) {
        if (plans[i] != NULL) {
            fftw_destroy_plan(plans[i]);
        }
    }
    lac_turn_free(fft->shared);
    fftw_free(fft->block);
    fftw_free(fft->real);
    fftw_free(fft->spectrum);
    free(fft);
}

void lac_fft_mirror(lac_fft *fft)
{
    fft->mirrored = true;
    fft->nkx = fft->nx; // real numbers, in the room of half as many pairs
    fft->columns = lac_strip_of(NULL, fft->nkx, 1);
}

void lac_fft_forward(lac_fft *fft) { fftw_execute(fft->forward); }

void lac_fft_inverse(lac_fft *fft)
{
    fft->shared != NULL ? lac_fft_share_inverse(fft) : fftw_execute(fft->inverse);
}

void lac_fft_table(lac_fft *fft, double *table)
{
    if (fft->shared != NULL) {
        lac_fft_share_table(fft, table);
        return;
    }
    lac_fft_forward(fft);
    double cells = (double)fft->nx * (double)fft->ny;
    for (size_t i = 0; i < fft->nkx; i++) {
        for (size_t j = 0; j < fft->ny; j++) {
            table[i * fft->ny + j] = creal(fft->spectrum[j * fft->nkx + i]) / cells;
        }
    }
}

// Rows to wavenumbers along x and back: of a line that is mirrored by cosines.
static void plan_rows(lac_fft *fft, unsigned planning)
{
    const int nx = (int)fft->nx, nkx = (int)fft->nkx, rows = (int)fft->rows;
    fftw_complex *spectrum = (fftw_complex *)fft->spectrum;
    if (fft->mirrored) {
        fft->rows_forward =
            fftw_plan_r2r_1d(nx, fft->real, (double *)spectrum, FFTW_REDFT10, planning);
        fft->rows_inverse =
            fftw_plan_r2r_1d(nx, (double *)spectrum, fft->real, FFTW_REDFT01, planning);
        return;
    }
    fft->rows_forward = fftw_plan_many_dft_r2c(1, &nx, rows, fft->real, NULL, 1, nx, spectrum, NULL,
                                               1, nkx, planning);
    fft->rows_inverse = fftw_plan_many_dft_c2r(1, &nx, rows, spectrum, NULL, 1, nkx, fft->real,
                                               NULL, 1, nx, planning);
}

lac_status lac_fft_plan_filter(lac_fft *fft, size_t rows, lac_error *err)
{
    const unsigned planning = fft->measure ? FFTW_MEASURE : FFTW_ESTIMATE;
    fft->rows = rows;
    fft->lead = fft->ny + 4; // columns a power of two apart would fall on the same cache lines
    fft->block = (double _Complex *)fftw_alloc_complex(BLOCK * fft->lead);
    LAC_FAIL_MEMORY_IF(fft->block == NULL, err);
    plan_rows(fft, planning);
    fftw_complex *block = (fftw_complex *)fft->block;
    const int ny = (int)fft->ny, lead = (int)fft->lead;
    fft->block_forward = fftw_plan_many_dft(1, &ny, BLOCK, block, NULL, 1, lead, block, NULL, 1,
                                            lead, FFTW_FORWARD, planning);
    fft->block_inverse = fftw_plan_many_dft(1, &ny, BLOCK, block, NULL, 1, lead, block, NULL, 1,
                                            lead, FFTW_BACKWARD, planning);
    memset(fft->block, 0, BLOCK * fft->lead * sizeof *fft->block);
    bool planned = fft->rows_forward != NULL && fft->rows_inverse != NULL &&
                   fft->block_forward != NULL && fft->block_inverse != NULL;
    return planned ? LAC_OK : lac_fail_memory(err);
}

// Columns first ... first + width of the spectrum into the block; inline for a constant width
static inline void gather(lac_fft *fft, size_t first, size_t width)
{
    double _Complex *restrict block = fft->block;
    const double _Complex *restrict from = &fft->spectrum[first];
    const size_t lead = fft->lead;
    for (size_t j = 0; j < fft->rows; j++) {
        for (size_t k = 0; k < width; k++) {
            block[k * lead + j] = from[j * fft->nkx + k];
        }
    }
}

static inline void scatter(lac_fft *fft, size_t first, size_t width)
{
    const double _Complex *restrict block = fft->block;
    double _Complex *restrict to = &fft->spectrum[first];
    const size_t lead = fft->lead;
    for (size_t j = 0; j < fft->rows; j++) {
        for (size_t k = 0; k < width; k++) {
            to[j * fft->nkx + k] = block[k * lead + j];
        }
    }
}

// Columns from first on into the block; returns how many
static size_t take_columns(lac_fft *fft, size_t first)
{
    size_t width = fft->nkx - first < BLOCK ? fft->nkx - first : BLOCK;
    if (width == BLOCK) {
        gather(fft, first, BLOCK);
    } else {
        gather(fft, first, width);
    }
    return width;
}

LAC_CLONES static void lac_fft_multiply(size_t n, const double *restrict factor, double *restrict x)
{
    for (size_t j = 0; j < n; j++) {
        x[2 * j] *= factor[j];
        x[2 * j + 1] *= factor[j];
    }
}

void lac_fft_columns(const lac_fft *fft, double _Complex *block, size_t width, const double *table)
{
    for (size_t k = 0; k < width; k++) {
        memset(&block[k * fft->lead + fft->rows], 0, (fft->ny - fft->rows) * sizeof *block);
    }
    fftw_execute(fft->block_forward);
    for (size_t k = 0; k < width; k++) {
        lac_fft_multiply(fft->ny, &table[k * fft->ny], (double *)&block[k * fft->lead]);
    }
    fftw_execute(fft->block_inverse);
}

void lac_fft_filter(lac_fft *fft, const double *table)
{
    if (fft->shared != NULL) {
        lac_fft_share_through(fft, table);
        return;
    }
    fftw_execute(fft->rows_forward);
    if (fft->mirrored) {
        for (size_t i = 0; i < fft->nx; i++) {
            ((double *)fft->spectrum)[i] *= table[i];
        }
    } else if (fft->ny == 1) { // a line has no columns to transform
        lac_fft_multiply(fft->nkx, table, (double *)fft->spectrum);
    }
    for (size_t first = 0; fft->ny > 1 && first < fft->nkx; first += BLOCK) {
        const size_t width = take_columns(fft, first);
        lac_fft_columns(fft, fft->block, width, &table[first * fft->ny]);
        if (width == BLOCK) {
            scatter(fft, first, BLOCK);
        } else {
            scatter(fft, first, width);
        }
    }
    fftw_execute(fft->rows_inverse);
}

// y += m x of a column's real and imaginary parts
LAC_CLONES static void lac_fft_add(size_t n, const double *restrict m, double real,
                                   double imaginary, double *restrict y, double *restrict z)
{
    for (size_t i = 0; i < n; i++) {
        y[i] += m[i] * real;
        z[i] += m[i] * imaginary;
    }
}

void lac_fft_filter_rows(lac_fft *fft, const double *table)
{
    const size_t n = fft->rows;
    double *y = (double *)fft->block, *z = y + n;
    fftw_execute(fft->rows_forward);
    for (size_t k = 0; k < fft->nkx; k++) {
        memset(y, 0, 2 * n * sizeof *y);
        for (size_t j = 0; j < n; j++) {
            const double _Complex x = fft->spectrum[j * fft->nkx + k];
            lac_fft_add(n, &table[(k * n + j) * n], creal(x), cimag(x), y, z);
        }
        for (size_t j = 0; j < n; j++) {
            fft->spectrum[j * fft->nkx + k] = y[j] + z[j] * I;
        }
    }
    fftw_execute(fft->rows_inverse);
}

lac_status lac_fft_even(size_t n0, size_t n1, double *quarter, lac_error *err)
{
    int sides[2];
    int rank = 0;
    for (int k = 0; k < 2; k++) {
        size_t n = k == 0 ? n0 : n1;
        if (n > 1) {
            sides[rank++] = (int)n;
        }
    }
    if (rank == 0) {
        return LAC_OK;
    }
    const fftw_r2r_kind kinds[] = {FFTW_REDFT00, FFTW_REDFT00};
    fftw_plan plan = fftw_plan_r2r(rank, sides, quarter, quarter, kinds, FFTW_ESTIMATE);
    LAC_FAIL_MEMORY_IF(plan == NULL, err);
    fftw_execute(plan);
    fftw_destroy_plan(plan);
    return LAC_OK;
}
