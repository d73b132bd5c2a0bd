// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/filter.h"

#include <fftw3.h>
#include <limits.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum {
    BLOCK = 16,          // columns at a time
    LINE = 64,           // bytes of a cache line; everything begins at one
    THREAD_CELLS = 32768 // fewer are not worth another thread
};

// What differs between the precisions.
typedef struct kernels {
    size_t size; // of a real number
    void *(*plan)(size_t n, int sign, void *at);
    void (*execute)(void *plan, void *at);
    void (*destroy)(void *plan);
    void (*weave)(size_t n, const void *row, size_t apart, void *pair);
    void (*unweave)(size_t n, const void *pair, size_t apart, void *row);
    void (*gather)(const lac_filter *f, size_t first, size_t width, void *columns);
    void (*scatter)(const lac_filter *f, size_t first, size_t width, const void *columns);
    void (*mirror)(size_t n, void *factor);
    void (*multiply)(size_t n, const void *factor, void *column);
    double (*power)(size_t n, const void *factor, const void *column);
} kernels;

typedef struct plans {
    void *row_forward, *row_inverse, *column_forward, *column_inverse;
} plans;

struct lac_filter {
    size_t nx, ny;           // the field
    size_t mx, my, nkx;      // the transform; nkx = mx/2 + 1 columns are kept
    size_t pairs;            // of rows
    size_t pitch;            // complex numbers from pair to pair
    size_t lead;             // from column to column in a block
    char *buffer;            // [pairs * pitch] complex
    char *scratch;           // [threads * share] bytes: a block, factors; or two rows
    size_t share, factor_at; // in bytes
    double *column_power;    // [nkx]
    int threads;
    const kernels *now; // the precision of what the buffer holds
    plans plans[2];
};

#define REAL float
#define FFT(x) fftwf_##x
#define NAME(x) single_##x
#include "base/filter_kernels.h"
#undef REAL
#undef FFT
#undef NAME
#define REAL double
#define FFT(x) fftw_##x
#define NAME(x) double_##x
#include "base/filter_kernels.h"
#undef REAL
#undef FFT
#undef NAME

static const kernels *const precisions[] = {[LAC_SINGLE] = &single_kernels,
                                            [LAC_DOUBLE] = &double_kernels};

static const plans *current(const lac_filter *f)
{
    return &f->plans[lac_filter_precision(f)];
}

// Complex numbers, so that the next row begins at a cache line and not a power of two away, where
// columns would fall on the same few lines of the cache.
static size_t padded(size_t n) { return (n + 7) / 8 * 8 + 8; }

static lac_status allocate(lac_filter *f, lac_error *err)
{
    size_t complex_size = 2 * sizeof(double);
    size_t block = BLOCK * f->lead * complex_size;
    size_t rows = 2 * padded(f->mx) * sizeof(double);
    f->factor_at = block > rows ? block : rows;
    f->share = f->factor_at + padded(f->my) * sizeof(double);
    f->buffer = aligned_alloc(LINE, f->pairs * f->pitch * complex_size);
    f->scratch = aligned_alloc(LINE, (size_t)f->threads * f->share);
    f->column_power = malloc(f->nkx * sizeof *f->column_power);
    if (f->buffer == NULL || f->scratch == NULL || f->column_power == NULL) {
        return lac_fail_memory(err);
    }
    memset(f->scratch, 0, (size_t)f->threads * f->share);
    return LAC_OK;
}

static bool plan(lac_filter *f, lac_precision precision)
{
    const kernels *k = precisions[precision];
    plans *p = &f->plans[precision];
    p->row_forward = k->plan(f->mx, FFTW_FORWARD, f->buffer);
    p->row_inverse = k->plan(f->mx, FFTW_BACKWARD, f->buffer);
    p->column_forward = k->plan(f->my, FFTW_FORWARD, f->scratch);
    p->column_inverse = k->plan(f->my, FFTW_BACKWARD, f->scratch);
    return p->row_forward != NULL && p->row_inverse != NULL && p->column_forward != NULL &&
           p->column_inverse != NULL;
}

static int useful_threads(size_t cells)
{
    size_t most = cells / THREAD_CELLS;
    size_t there = (size_t)omp_get_max_threads();
    return most < 2 ? 1 : (int)(there < most ? there : most);
}

lac_status lac_filter_create(const size_t field[2], const size_t transform[2], lac_filter **out,
                             lac_error *err)
{
    lac_status status;
    *out = NULL;
    if (transform[0] == 0 || transform[1] == 0 || transform[0] > INT_MAX ||
        transform[1] > INT_MAX) {
        return lac_fail(err, LAC_EINPUT, "a transform of %zu x %zu cells is not possible",
                        transform[0], transform[1]);
    }
    lac_filter *f = calloc(1, sizeof *f);
    if (f == NULL) {
        return lac_fail_memory(err);
    }
    f->nx = field[0];
    f->ny = field[1];
    f->mx = transform[0];
    f->my = transform[1];
    f->nkx = f->mx / 2 + 1;
    f->pairs = (f->ny + 1) / 2;
    f->pitch = padded(f->mx);
    f->lead = padded(f->my);
    f->threads = useful_threads(f->nx * f->ny);
    LAC_TRY(allocate(f, err));
    if (!plan(f, LAC_SINGLE) || !plan(f, LAC_DOUBLE)) {
        status = lac_fail_memory(err);
        goto out;
    }
    *out = f;
    return LAC_OK;
out:
    lac_filter_free(f);
    return status;
}

void lac_filter_free(lac_filter *f)
{
    if (f == NULL) {
        return;
    }
    for (int k = 0; k < 2; k++) {
        precisions[k]->destroy(f->plans[k].row_forward);
        precisions[k]->destroy(f->plans[k].row_inverse);
        precisions[k]->destroy(f->plans[k].column_forward);
        precisions[k]->destroy(f->plans[k].column_inverse);
    }
    free(f->buffer);
    free(f->scratch);
    free(f->column_power);
    free(f);
}

lac_precision lac_filter_precision(const lac_filter *f)
{
    return f->now == &double_kernels ? LAC_DOUBLE : LAC_SINGLE;
}

int lac_filter_threads(const lac_filter *f) { return f->threads; }

// This thread's part of the scratch
static char *own_scratch(const lac_filter *f)
{
    return &f->scratch[(size_t)omp_get_thread_num() * f->share];
}

static char *pair_at(const lac_filter *f, size_t pair)
{
    return &f->buffer[pair * f->pitch * 2 * f->now->size];
}

// Two rows side by side in the scratch, filled by the caller and zeros beyond
static void fill_pair(const lac_filter *f, size_t pair, lac_filter_row fill, void *context)
{
    size_t apart = padded(f->mx);
    size_t size = f->now->size;
    char *rows = own_scratch(f);
    for (size_t k = 0; k < 2; k++) {
        char *row = &rows[k * apart * size];
        bool there = 2 * pair + k < f->ny;
        size_t filled = there ? f->nx : 0;
        if (there) {
            fill(context, 2 * pair + k, row);
        }
        memset(&row[filled * size], 0, (f->mx - filled) * size);
    }
    f->now->weave(f->mx, rows, apart, pair_at(f, pair));
    f->now->execute(current(f)->row_forward, pair_at(f, pair));
}

void lac_filter_fill(lac_filter *f, lac_precision precision, lac_filter_row fill, void *context)
{
    f->now = precisions[precision];
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t pair = 0; pair < f->pairs; pair++) {
        fill_pair(f, pair, fill, context);
    }
}

void lac_filter_refill(lac_filter *f, lac_filter_row fill, void *context)
{
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t pair = 0; pair < f->pairs; pair++) {
        f->now->unweave(f->nx, pair_at(f, pair), padded(f->mx), own_scratch(f));
        fill_pair(f, pair, fill, context);
    }
}

void lac_filter_take(lac_filter *f, lac_filter_row take, void *context)
{
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t pair = 0; pair < f->pairs; pair++) {
        char *rows = own_scratch(f);
        size_t apart = padded(f->mx);
        f->now->execute(current(f)->row_inverse, pair_at(f, pair));
        f->now->unweave(f->nx, pair_at(f, pair), apart, rows);
        for (size_t j = 2 * pair; j < 2 * pair + 2 && j < f->ny; j++) {
            take(context, j, &rows[(j - 2 * pair) * apart * f->now->size]);
        }
    }
}

// Columns from first on into the scratch, and to wavenumbers along y; returns how many
static size_t transform_columns(const lac_filter *f, size_t first, char *block)
{
    size_t width = f->nkx - first < BLOCK ? f->nkx - first : BLOCK;
    f->now->gather(f, first, width, block);
    for (size_t c = 0; c < width; c++) {
        f->now->execute(current(f)->column_forward, &block[c * f->lead * 2 * f->now->size]);
    }
    return width;
}

// The factors of column k, in the scratch
static const void *factors(const lac_filter *f, lac_filter_symbol symbol, const void *context,
                           size_t k)
{
    char *factor = own_scratch(f) + f->factor_at;
    symbol(context, k, factor);
    f->now->mirror(f->my, factor);
    return factor;
}

void lac_filter_multiply(lac_filter *f, lac_filter_symbol symbol, const void *context)
{
    const kernels *now = f->now;
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t first = 0; first < f->nkx; first += BLOCK) {
        char *block = own_scratch(f);
        size_t width = transform_columns(f, first, block);
        for (size_t c = 0; c < width; c++) {
            char *column = &block[c * f->lead * 2 * now->size];
            now->multiply(f->my, factors(f, symbol, context, first + c), column);
            now->execute(current(f)->column_inverse, column);
        }
        now->scatter(f, first, width, block);
    }
}

double lac_filter_power(lac_filter *f, lac_filter_symbol symbol, const void *context)
{
    const kernels *now = f->now;
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t first = 0; first < f->nkx; first += BLOCK) {
        char *block = own_scratch(f);
        size_t width = transform_columns(f, first, block);
        for (size_t c = 0; c < width; c++) {
            size_t k = first + c;
            bool alone = k == 0 || 2 * k == f->mx; // no mirror image
            f->column_power[k] =
                (alone ? 1.0 : 2.0) * now->power(f->my, factors(f, symbol, context, k),
                                                 &block[c * f->lead * 2 * now->size]);
        }
    }
    double total = 0.0;
    for (size_t k = 0; k < f->nkx; k++) {
        total += f->column_power[k];
    }
    return total;
}
