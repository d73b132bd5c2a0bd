// SPDX-License-Identifier: GPL-3.0-or-later
// Convolutions of large fields by FFTW: in single or double precision, and with the same bits for
// any number of threads.
#include "base/filter.h"

#include <fftw3.h>
#include <omp.h>

#include "base/statistics.h"

enum {
    BLOCK = 16,          // columns at a time
    GRAIN = 2 * BLOCK,   // of those that a rank has: in both halves a block
    LINE = 64,           // bytes of a cache line; everything begins at one
    AHEAD = 8,           // pairs of rows that are fetched before they are gathered
    THREAD_CELLS = 32768 // fewer are not worth another thread
};

// What differs between the precisions.
typedef struct kernels {
    size_t size; // of a real number
    void *(*plan)(size_t n, int sign, void *from, void *to);
    void (*execute)(void *plan, void *from, void *to);
    void (*destroy)(void *plan);
    void (*weave)(size_t n, const void *row, size_t apart, void *pair);
    void (*unweave)(size_t n, const void *pair, size_t apart, void *row);
    void (*gather)(const lac_filter *f, size_t first, size_t width, size_t lead, void *columns);
    void (*scatter)(const lac_filter *f, size_t first, size_t width, size_t lead,
                    const void *columns);
    void (*mirror)(size_t n, void *factor);
    void (*multiply)(size_t n, const void *factor, void *column);
    double (*power)(size_t n, const void *factor, const void *column);
} kernels;

typedef struct plans {
    void *row_forward, *row_inverse, *column_forward, *column_inverse;
} plans;

// A thread's part of the scratch, in bytes. Transforms out of place are faster.
typedef struct room {
    size_t first;  // at 0: a block of columns, or two rows
    size_t second; // the block transformed, or the two rows as one complex one
    size_t factor; // [my]
    size_t share;  // all of it
} room;

struct lac_filter {
    size_t nx, ny;      // the field; rows here
    size_t mx, my, nkx; // the transform; nkx = mx/2 + 1 columns are kept
    size_t pairs;       // of rows here
    size_t all;         // rows of the field
    size_t length;      // of the rows' transform: mx, or half of it
    size_t columns;     // kept of that
    size_t pitch;       // complex numbers from pair to pair
    size_t lead;        // from column to column in a block
    char *buffer;       // [pairs * pitch] complex
    char *scratch;      // [threads * share] bytes: see room
    room room;
    double *column_power; // [nkx]
    double *twist;        // [nx] complex exp(-i pi j/nx): even wavenumbers to odd; or NULL
    int threads;
    lac_turn *shared;   // NULL: all columns are here
    lac_strip wide;     // those here
    lac_precision mode; // of what the buffer holds
    bool odd;           // mode is LAC_ODD
    const kernels *now;
    plans plans[3]; // as enum lac_precision; both halves have the same
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
                                            [LAC_DOUBLE] = &double_kernels,
                                            [LAC_EVEN] = &double_kernels,
                                            [LAC_ODD] = &double_kernels};

static const plans *current(const lac_filter *f) { return &f->plans[f->odd ? LAC_EVEN : f->mode]; }

// Complex numbers, so that the next row begins at a cache line and not a power of two away, where
// columns would fall on the same few lines of the cache.
static size_t padded(size_t n) { return (n + 7) / 8 * 8 + 8; }

static size_t larger(size_t a, size_t b) { return a > b ? a : b; }

static void choose(lac_filter *f, lac_precision mode)
{
    const bool half = mode >= LAC_EVEN;
    f->mode = mode;
    f->odd = mode == LAC_ODD;
    f->now = precisions[mode];
    f->length = half ? f->nx : f->mx;
    f->columns = half ? (f->nx - (f->odd ? 1 : 0)) / 2 + 1 : f->nkx;
    f->pitch = padded(f->length);
}

// exp(-i pi j/nx)
static void fill_twist(const lac_filter *f)
{
    for (size_t j = 0; f->twist != NULL && j < f->nx; j++) {
        f->twist[2 * j] = cos(M_PI * (double)j / (double)f->nx);
        f->twist[2 * j + 1] = -sin(M_PI * (double)j / (double)f->nx);
    }
}

lac_strip lac_filter_columns(lac_team *team, size_t nkx) { return lac_strip_of(team, nkx, GRAIN); }

static lac_status allocate(lac_filter *f, lac_error *err)
{
    size_t complex_size = 2 * sizeof(double);
    bool halves = f->mx == 2 * f->nx;
    size_t half = larger(BLOCK * f->lead, padded(f->mx)) * complex_size;
    size_t row = halves ? larger(padded(f->nx) * complex_size, padded(f->mx) * 2 * sizeof(float))
                        : padded(f->mx) * complex_size;
    f->room.second = half;
    f->room.factor = 2 * half;
    f->room.share = 2 * half + padded(f->my) * sizeof(double);
    f->buffer = aligned_alloc(LINE, larger(f->pairs, 1) * row);
    f->scratch = aligned_alloc(LINE, (size_t)f->threads * f->room.share);
    f->column_power = malloc(f->nkx * sizeof *f->column_power);
    f->twist = halves ? malloc(f->nx * complex_size) : NULL;
    LAC_FAIL_MEMORY_IF(f->buffer == NULL || f->scratch == NULL || f->column_power == NULL ||
                           (halves && f->twist == NULL),
                       err);
    fill_twist(f);
    memset(f->scratch, 0, (size_t)f->threads * f->room.share);
    return LAC_OK;
}

static bool plan(lac_filter *f, lac_precision precision)
{
    const kernels *k = precisions[precision];
    plans *p = &f->plans[precision];
    char *first = f->scratch;
    char *second = &f->scratch[f->room.second];
    choose(f, precision);
    p->row_forward = k->plan(f->length, FFTW_FORWARD, second, f->buffer);
    p->row_inverse = k->plan(f->length, FFTW_BACKWARD, f->buffer, second);
    p->column_forward = k->plan(f->my, FFTW_FORWARD, first, second);
    p->column_inverse = k->plan(f->my, FFTW_BACKWARD, second, first);
    return p->row_forward != NULL && p->row_inverse != NULL && p->column_forward != NULL &&
           p->column_inverse != NULL;
}

static int useful_threads(size_t cells)
{
    size_t most = cells / THREAD_CELLS;
    size_t there = (size_t)omp_get_max_threads();
    return most < 2 ? 1 : (int)(there < most ? there : most);
}

lac_status lac_filter_create(const size_t field[2], const size_t transform[2], lac_team *team,
                             lac_filter **out, lac_error *err)
{
    lac_status status;
    *out = NULL;
    LAC_FAIL_IF(transform[0] == 0 || transform[1] == 0 || transform[0] > INT_MAX ||
                    transform[1] > INT_MAX,
                err, LAC_EINPUT, "a transform of %zu x %zu cells is not possible", transform[0],
                transform[1]);
    lac_filter *f = calloc(1, sizeof *f);
    LAC_FAIL_MEMORY_IF(f == NULL, err);
    f->nx = field[0];
    f->all = field[1];
    f->ny = lac_strip_rows(team, f->all).n;
    f->mx = transform[0];
    f->my = transform[1];
    f->nkx = f->mx / 2 + 1;
    f->pairs = (f->ny + 1) / 2;
    f->lead = padded(f->my);
    f->threads = useful_threads(f->nx * f->ny);
    LAC_TRY(allocate(f, err));
    f->wide = lac_filter_columns(team, f->nkx);
    if (team != NULL) { // rows are shared in pairs, the last one as a whole
        const lac_strip rows = lac_strip_rows(team, (f->all + 1) / 2 * 2);
        LAC_TRY(lac_turn_create(&rows, f->lead, GRAIN * 2 * sizeof(double), &f->shared, err));
    }
    if (!plan(f, LAC_SINGLE) || !plan(f, f->twist != NULL ? LAC_EVEN : LAC_DOUBLE)) {
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
    for (int k = 0; k < 3; k++) {
        precisions[k]->destroy(f->plans[k].row_forward);
        precisions[k]->destroy(f->plans[k].row_inverse);
        precisions[k]->destroy(f->plans[k].column_forward);
        precisions[k]->destroy(f->plans[k].column_inverse);
    }
    lac_turn_free(f->shared);
    free(f->buffer);
    free(f->scratch);
    free(f->column_power);
    free(f->twist);
    free(f);
}

lac_precision lac_filter_precision(const lac_filter *f) { return f->mode; }

int lac_filter_threads(const lac_filter *f) { return f->threads; }

// This thread's part of the scratch
static char *own_scratch(const lac_filter *f)
{
    return &f->scratch[(size_t)omp_get_thread_num() * f->room.share];
}

static char *pair_at(const lac_filter *f, size_t pair)
{
    return &f->buffer[pair * f->pitch * 2 * f->now->size];
}

// Multiplies by the twist, or with sign -1 by its conjugate.
static void turn(const lac_filter *f, double sign, double *restrict z)
{
    const double *restrict w = f->twist;
    for (size_t j = 0; j < 2 * f->nx; j += 2) {
        double re = z[j], im = z[j + 1], sine = sign * w[j + 1];
        z[j] = re * w[j] - im * sine;
        z[j + 1] = im * w[j] + re * sine;
    }
}

// Two rows of the scratch, filled by the caller and zeros beyond, go into the buffer
static void fill_pair(const lac_filter *f, size_t pair, lac_filter_row fill, void *context)
{
    size_t size = f->now->size;
    char *rows = own_scratch(f);
    char *woven = &rows[f->room.second];
    for (size_t k = 0; k < 2; k++) {
        char *row = &rows[k * f->pitch * size];
        bool there = 2 * pair + k < f->ny;
        size_t filled = there ? f->nx : 0;
        if (there) {
            fill(context, 2 * pair + k, row);
        }
        memset(&row[filled * size], 0, (f->length - filled) * size);
    }
    f->now->weave(f->length, rows, f->pitch, woven);
    if (f->odd) {
        turn(f, 1.0, (double *)woven);
    }
    f->now->execute(current(f)->row_forward, woven, pair_at(f, pair));
}

// Two rows from the buffer into the scratch
static char *open_pair(const lac_filter *f, size_t pair)
{
    char *rows = own_scratch(f);
    char *woven = &rows[f->room.second];
    f->now->execute(current(f)->row_inverse, pair_at(f, pair), woven);
    if (f->odd) {
        turn(f, -1.0, (double *)woven);
    }
    f->now->unweave(f->nx, woven, f->pitch, rows);
    return rows;
}

void lac_filter_fill(lac_filter *f, lac_precision precision, lac_filter_row fill, void *context)
{
    choose(f, precision);
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t pair = 0; pair < f->pairs; pair++) {
        fill_pair(f, pair, fill, context);
    }
}

void lac_filter_take(lac_filter *f, lac_filter_row take, void *context)
{
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t pair = 0; pair < f->pairs; pair++) {
        char *rows = open_pair(f, pair);
        for (size_t j = 2 * pair; j < 2 * pair + 2 && j < f->ny; j++) {
            take(context, j, &rows[(j - 2 * pair) * f->pitch * f->now->size]);
        }
    }
}

static char *column_of(const lac_filter *f, char *block, size_t c)
{
    return &block[c * f->lead * 2 * f->now->size];
}

// A column, zeros beyond the field, to its wavenumbers along y
static char *transform_column(const lac_filter *f, size_t c, char *block)
{
    char *column = column_of(f, block, c), *spectrum = own_scratch(f) + f->room.second;
    const size_t size = 2 * f->now->size;
    spectrum = column_of(f, spectrum, c % BLOCK);
    memset(&column[f->all * size], 0, (f->my - f->all) * size);
    f->now->execute(current(f)->column_forward, column, spectrum);
    return spectrum;
}

static const void *factors(const lac_filter *f, lac_filter_symbol symbol, const void *context,
                           size_t k)
{
    char *factor = own_scratch(f) + f->room.factor;
    symbol(context, f->mode < LAC_EVEN ? k : 2 * k + (f->odd ? 1 : 0), factor);
    f->now->mirror(f->my, factor);
    return factor;
}

// What is done to columns: those of a block, in one thread.
typedef struct columns_use {
    lac_filter *f;
    lac_filter_symbol symbol;
    const void *context;
    void (*each)(const struct columns_use *use, size_t first, size_t c, char *block);
} columns_use;

static void multiply_column(const columns_use *use, size_t first, size_t c, char *block)
{
    const lac_filter *f = use->f;
    char *column = transform_column(f, c, block);
    f->now->multiply(f->my, factors(f, use->symbol, use->context, first + c), column);
    f->now->execute(current(f)->column_inverse, column, column_of(f, block, c));
}

static void add_column(const columns_use *use, size_t first, size_t c, char *block)
{
    const lac_filter *f = use->f;
    const size_t k = first + c;
    bool alone = k == (f->odd ? f->length - 1 - k : (f->length - k) % f->length);
    char *column = transform_column(f, c, block);
    const void *factor = factors(f, use->symbol, use->context, k);
    f->column_power[k] = (alone ? 1.0 : 2.0) * f->now->power(f->my, factor, column);
}

static void pack(void *context, size_t first, size_t width, void *packet)
{
    const lac_filter *f = ((const columns_use *)context)->f;
    f->now->gather(f, first, width, 2 * f->pairs, packet);
}

static void unpack(void *context, size_t first, size_t width, const void *packet)
{
    const lac_filter *f = ((const columns_use *)context)->f;
    f->now->scatter(f, first, width, 2 * f->pairs, packet);
}

static void work(void *context, size_t first, size_t width, void *plane)
{
    const columns_use *use = context;
#pragma omp parallel for schedule(static) num_threads(use->f->threads)
    for (size_t c = 0; c < width; c++) {
        use->each(use, first, c, plane);
    }
}

// Columns that other ranks have rows of.
static void share_columns(columns_use *use, bool back)
{
    const lac_filter *f = use->f;
    const lac_turn_use shared = {use, pack, work, back ? unpack : NULL};
    const lac_strip columns =
        lac_strip_like(&f->wide, f->columns, f->mode < LAC_EVEN ? GRAIN : BLOCK);
    lac_turn_pass(f->shared, &columns, 2 * f->now->size, &shared);
}

static void do_columns(columns_use *use, bool back)
{
    const lac_filter *f = use->f;
    if (f->shared != NULL) {
        share_columns(use, back);
        return;
    }
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t first = 0; first < f->columns; first += BLOCK) {
        char *block = own_scratch(f);
        const size_t width = f->columns - first < BLOCK ? f->columns - first : BLOCK;
        f->now->gather(f, first, width, f->lead, block);
        for (size_t c = 0; c < width; c++) {
            use->each(use, first, c, block);
        }
        if (back) {
            f->now->scatter(f, first, width, f->lead, block);
        }
    }
}

void lac_filter_multiply(lac_filter *f, lac_filter_symbol symbol, const void *context)
{
    do_columns(&(columns_use){f, symbol, context, multiply_column}, true);
}

double lac_filter_power(lac_filter *f, lac_filter_symbol symbol, const void *context)
{
    memset(f->column_power, 0, f->columns * sizeof *f->column_power);
    do_columns(&(columns_use){f, symbol, context, add_column}, false);
    lac_team_join(f->wide.team, f->column_power, f->columns);
    return lac_sum(f->columns, f->column_power);
}
