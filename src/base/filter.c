// SPDX-License-Identifier: GPL-3.0-or-later
// Convolutions of large fields by FFTW: in single or double precision, and with the same bits for
// any number of threads.
#include "base/filter.h"

#include <fftw3.h>
#include <omp.h>

#include "base/statistics.h"

enum {
    BLOCK = 16,          // columns at a time
    GRAIN = 2 * BLOCK,   // of those of all parts that a rank has: a multiple of each modulus
    LINE = 64,           // bytes of a cache line; everything begins at one
    STRETCH = 256,       // of a column whose power is summed in its own precision
    MOST_TERMS = 4,      // of a row of the field that are folded into one
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
    void (*fold)(size_t n, size_t terms, const double *weight, const void *from, void *to);
    void (*unfold)(size_t n, size_t terms, const double (*weight)[MOST_TERMS], size_t apart,
                   void *row);
    void (*turn)(const lac_filter *f, int sign, void *row);
    void (*fill_twist)(size_t n, void *twist);
    void (*gather)(const lac_filter *f, size_t first, size_t width, size_t lead, void *columns);
    void (*scatter)(const lac_filter *f, size_t first, size_t width, size_t lead,
                    const void *columns);
    void (*mirror)(size_t n, void *factor);
    void (*multiply)(size_t n, const void *factor, void *column);
    double (*power)(bool part, size_t n, const void *factor, const void *column);
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
    size_t all;         // rows of the field
    size_t moduli[2];   // of the parts in either precision: see choose
    size_t apart;       // real numbers from row to row of the scratch
    size_t lead;        // from column to column in a block
    char *buffer;       // [rows * pitch] complex
    char *scratch;      // [threads * share] bytes: see room
    room room;
    double *column_power; // [nkx]
    void *twist[2];       // [nx] complex exp(-i pi j/nx); NULL where the transform is no longer
    int threads;
    lac_turn *shared; // NULL: all columns are here
    lac_strip wide;   // those of the whole spectrum here
    // Of what the buffer holds: wavenumbers along x that are `part`, or less it, modulo `modulus`.
    lac_precision mode;
    size_t part, modulus;
    bool single;    // one row of the field is a complex one there; else two are
    bool odd;       // two, and the middle between multiples of the modulus: mirrors are neighbours
    size_t rows;    // in the buffer
    size_t length;  // of their transform: mx/modulus
    size_t columns; // kept of that
    size_t pitch;   // complex numbers from row to row
    size_t terms;   // of a row of the field, folded into one of that length
    double weight[2][MOST_TERMS]; // of these: towards the real, or all; the imaginary part
    const kernels *now;
    plans plans[2]; // as enum lac_precision
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

static const kernels *const precisions[] = {
    [LAC_SINGLE] = &single_kernels, [LAC_DOUBLE] = &double_kernels};

static const plans *current(const lac_filter *f) { return &f->plans[f->mode]; }

// Complex numbers, so that the next row begins at a cache line and not a power of two away, where
// columns would fall on the same few lines of the cache.
static size_t padded(size_t n) { return (n + 7) / 8 * 8 + 8; }

static size_t larger(size_t a, size_t b) { return a > b ? a : b; }

// With x_j = 0 from j = mx/2 on and L = mx/modulus, the wavenumbers k = part, modulo `modulus`, are
// those of one transform of L: of exp(-2 pi i j part/mx) sum_m x_(j + mL) exp(-2 pi i m
// part/modulus). Where that sum is complex, the wavenumbers that are -part go with it: the
// conjugates.
static void choose(lac_filter *f, lac_precision mode, size_t part)
{
    f->mode = mode;
    f->now = precisions[mode];
    f->part = part;
    f->modulus = f->moduli[mode];
    f->single = part > 0 && 2 * part < f->modulus;
    f->odd = part > 0 && 2 * part == f->modulus;
    f->rows = f->single ? f->ny : (f->ny + 1) / 2;
    f->length = f->mx / f->modulus;
    f->columns = f->single ? f->length : (f->length - (f->odd ? 1 : 0)) / 2 + 1;
    f->pitch = padded(f->length);
    f->terms = larger(f->modulus / 2, 1);
    for (size_t m = 0; m < f->terms; m++) {
        double angle = 2.0 * M_PI * (double)(m * part % f->modulus) / (double)f->modulus;
        // twice: as columns of two rows are gathered, and as the conjugates add to the field
        f->weight[0][m] = f->single ? 2.0 * cos(angle) : f->odd && m % 2 == 1 ? -1.0 : 1.0;
        f->weight[1][m] = f->single ? -2.0 * sin(angle) : 0.0;
    }
}

// Of the largest part
static size_t buffer_bytes(lac_filter *f)
{
    size_t most = 0;
    for (lac_precision mode = LAC_SINGLE; mode <= LAC_DOUBLE; mode++) {
        for (size_t part = 0; part < lac_filter_parts(f, mode); part++) {
            choose(f, mode, part);
            most = larger(most, f->rows * f->pitch * 2 * f->now->size);
        }
    }
    return most;
}

lac_strip lac_filter_columns(lac_team *team, size_t nkx) { return lac_strip_of(team, nkx, GRAIN); }

static lac_status allocate(lac_filter *f, lac_error *err)
{
    const size_t complex_size = 2 * sizeof(double);
    size_t half = larger(BLOCK * f->lead, f->apart) * complex_size;
    f->room.second = half;
    f->room.factor = 2 * half;
    f->room.share = 2 * half + padded(f->my) * sizeof(double);
    f->buffer = aligned_alloc(LINE, larger(buffer_bytes(f), LINE));
    f->scratch = aligned_alloc(LINE, (size_t)f->threads * f->room.share);
    f->column_power = malloc(f->nkx * sizeof *f->column_power);
    LAC_FAIL_MEMORY_IF(f->buffer == NULL || f->scratch == NULL || f->column_power == NULL, err);
    for (int k = 0; k < 2 && f->moduli[LAC_SINGLE] > 1; k++) {
        f->twist[k] = malloc(f->nx * 2 * precisions[k]->size);
        LAC_FAIL_MEMORY_IF(f->twist[k] == NULL, err);
        precisions[k]->fill_twist(f->nx, f->twist[k]);
    }
    memset(f->scratch, 0, (size_t)f->threads * f->room.share);
    return LAC_OK;
}

static bool plan(lac_filter *f, lac_precision precision)
{
    const kernels *k = precisions[precision];
    plans *p = &f->plans[precision];
    char *first = f->scratch;
    char *second = &f->scratch[f->room.second];
    choose(f, precision, 0);
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
    lac_filter *f = *out = calloc(1, sizeof *f);
    LAC_FAIL_MEMORY_IF(f == NULL, err);
    f->nx = field[0];
    f->all = field[1];
    f->ny = lac_strip_rows(team, f->all).n;
    f->mx = transform[0];
    f->my = transform[1];
    f->nkx = f->mx / 2 + 1;
    const bool twice = f->mx == 2 * f->nx;
    f->moduli[LAC_SINGLE] = twice ? 2 : 1;
    f->moduli[LAC_DOUBLE] = twice && f->nx % MOST_TERMS == 0 ? 2 * MOST_TERMS : twice ? 2 : 1;
    f->apart = padded(f->mx);
    f->lead = padded(f->my);
    f->threads = useful_threads(f->nx * f->ny);
    LAC_TRY(allocate(f, err));
    f->wide = lac_filter_columns(team, f->nkx);
    if (team != NULL) { // rows are shared in pairs, the last one as a whole
        const lac_strip rows = lac_strip_rows(team, (f->all + 1) / 2 * 2);
        LAC_TRY(lac_turn_create(&rows, f->lead, GRAIN * 2 * sizeof(double), &f->shared, err));
    }
    LAC_TRY(plan(f, LAC_SINGLE) && plan(f, LAC_DOUBLE) ? LAC_OK : lac_fail_memory(err));
out:
    LAC_MADE(status, out, lac_filter_free);
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
    lac_turn_free(f->shared);
    free(f->buffer);
    free(f->scratch);
    free(f->column_power);
    free(f->twist[0]);
    free(f->twist[1]);
    free(f);
}

lac_precision lac_filter_precision(const lac_filter *f) { return f->mode; }

size_t lac_filter_parts(const lac_filter *f, lac_precision precision)
{
    return f->moduli[precision] / 2 + 1;
}

int lac_filter_threads(const lac_filter *f) { return f->threads; }

// This thread's part of the scratch
static char *own_scratch(const lac_filter *f)
{
    return &f->scratch[(size_t)omp_get_thread_num() * f->room.share];
}

static char *row_at(const lac_filter *f, size_t row)
{
    return &f->buffer[row * f->pitch * 2 * f->now->size];
}

// Of the field, in one row of the buffer
static size_t rows_each(const lac_filter *f) { return f->single ? 1 : 2; }

// Rows of the scratch, filled by the caller and zeros beyond, go into the buffer
static void fill_rows(const lac_filter *f, size_t row, lac_filter_row fill, void *context)
{
    const kernels *now = f->now;
    char *rows = own_scratch(f), *second = &rows[f->apart * now->size];
    char *woven = &rows[f->room.second];
    const size_t long_enough = larger(f->nx, f->length);
    for (size_t k = 0; k < rows_each(f); k++) {
        char *to = k == 0 ? rows : second;
        const size_t j = rows_each(f) * row + k, filled = j < f->ny ? f->nx : 0;
        if (filled > 0) {
            fill(context, j, to);
        }
        memset(&to[filled * now->size], 0, (long_enough - filled) * now->size);
    }
    if (f->terms > 1) {
        now->fold(f->length, f->terms, f->weight[f->single ? 1 : 0], f->single ? rows : second,
                  second);
        now->fold(f->length, f->terms, f->weight[0], rows, rows);
    }
    if (f->part > 0) {
        now->turn(f, 1, rows);
    }
    now->weave(f->length, rows, f->apart, woven);
    now->execute(current(f)->row_forward, woven, row_at(f, row));
}

// Rows from the buffer into the scratch
static char *open_rows(const lac_filter *f, size_t row)
{
    const kernels *now = f->now;
    char *rows = own_scratch(f);
    char *woven = &rows[f->room.second];
    now->execute(current(f)->row_inverse, row_at(f, row), woven);
    const size_t n = f->length < f->nx ? f->length : f->nx;
    now->unweave(n, woven, f->apart, rows);
    if (f->part > 0) {
        now->turn(f, -1, rows);
    }
    if (f->terms > 1) {
        now->unfold(n, f->terms, f->weight, f->apart, rows);
        if (!f->single) {
            now->unfold(n, f->terms, f->weight, 0, &rows[f->apart * now->size]);
        }
    }
    return rows;
}

void lac_filter_fill(lac_filter *f, lac_precision precision, size_t part, lac_filter_row fill,
                     void *context)
{
    choose(f, precision, part);
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t row = 0; row < f->rows; row++) {
        fill_rows(f, row, fill, context);
    }
}

void lac_filter_take(lac_filter *f, lac_filter_row take, void *context)
{
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t row = 0; row < f->rows; row++) {
        char *rows = open_rows(f, row);
        for (size_t k = 0; k < rows_each(f) && rows_each(f) * row + k < f->ny; k++) {
            take(context, rows_each(f) * row + k, &rows[k * f->apart * f->now->size]);
        }
    }
}

static char *column_of(const lac_filter *f, char *block, size_t c)
{
    return &block[c * f->lead * 2 * f->now->size];
}

static const void *factors(const lac_filter *f, lac_filter_symbol symbol, const void *context,
                           size_t k)
{
    char *factor = own_scratch(f) + f->room.factor;
    const size_t wave = k * f->modulus + f->part;
    symbol(context, wave < f->nkx ? wave : f->mx - wave, factor);
    f->now->mirror(f->my, factor);
    return factor;
}

// What is done to columns.
typedef struct columns_use {
    lac_filter *f;
    lac_filter_symbol symbol;
    const void *context;
    bool back;    // they are multiplied and go back
    bool adds;    // their powers are wanted
    bool mirrors; // shared ones are counted from the last down
} columns_use;

// Column k, which is the c-th of a block.
static void do_column(const columns_use *use, size_t k, size_t c, char *block)
{
    const lac_filter *f = use->f;
    const size_t size = 2 * f->now->size;
    char *field = column_of(f, block, c);
    char *column = column_of(f, own_scratch(f) + f->room.second, c % BLOCK);
    memset(&field[f->all * size], 0, (f->my - f->all) * size); // beyond it are zeros
    f->now->execute(current(f)->column_forward, field, column);
    const void *factor = factors(f, use->symbol, use->context, k);
    if (use->adds) {
        bool alone = !f->single && k == (f->odd ? f->length - 1 - k : (f->length - k) % f->length);
        f->column_power[k] =
            (alone ? 1.0 : 2.0) * f->now->power(f->modulus > 1, f->my, factor, column);
    }
    if (use->back) {
        f->now->multiply(f->my, factor, column);
        f->now->execute(current(f)->column_inverse, column, field);
    }
}

// The least of those columns that are shared as first ... first + width - 1
static size_t least(const columns_use *use, size_t first, size_t width)
{
    return use->mirrors ? use->f->columns - first - width : first;
}

static void pack(void *context, size_t first, size_t width, void *packet, bool back)
{
    const columns_use *use = context;
    const size_t from = least(use, first, width), rows = (use->f->ny + 1) / 2 * 2; // in pairs
    back ? use->f->now->scatter(use->f, from, width, rows, packet)
         : use->f->now->gather(use->f, from, width, rows, packet);
}

static void work(void *context, size_t first, size_t width, void *plane)
{
    const columns_use *use = context;
#pragma omp parallel for schedule(static) num_threads(use->f->threads)
    for (size_t c = 0; c < width; c++) {
        do_column(use, least(use, first, width) + c, c, plane);
    }
}

// Columns that other ranks have rows of. Their wavenumbers, as factors are asked for, rise; of
// single rows they fall again from mx/2 on, so that a rank has some of either slope.
static void share_columns(columns_use *use)
{
    const lac_filter *f = use->f;
    const lac_turn_use shared = {use, pack, NULL, 0, work, use->back};
    const size_t rise = f->single ? (f->nkx - f->part + f->modulus - 1) / f->modulus : f->columns;
    memset(f->column_power, 0, f->columns * sizeof *f->column_power);
    for (int slope = 0; slope < (f->single ? 2 : 1); slope++) {
        use->mirrors = slope == 1;
        const lac_strip columns =
            lac_strip_like(&f->wide, use->mirrors ? f->columns - rise : rise, GRAIN / f->modulus);
        lac_turn_pass(f->shared, &columns, 2 * f->now->size, &shared);
    }
    if (use->adds) {
        lac_team_join(f->wide.team, f->column_power, f->columns);
    }
}

static void own_columns(const columns_use *use)
{
    const lac_filter *f = use->f;
#pragma omp parallel for schedule(static) num_threads(f->threads)
    for (size_t first = 0; first < f->columns; first += BLOCK) {
        char *block = own_scratch(f);
        const size_t width = f->columns - first < BLOCK ? f->columns - first : BLOCK;
        f->now->gather(f, first, width, f->lead, block);
        for (size_t c = 0; c < width; c++) {
            do_column(use, first + c, c, block);
        }
        if (use->back) {
            f->now->scatter(f, first, width, f->lead, block);
        }
    }
}

// Returns the sum of powers, where it is wanted.
static double do_columns(columns_use use)
{
    use.f->shared != NULL ? share_columns(&use) : own_columns(&use);
    return use.adds ? lac_sum(use.f->columns, use.f->column_power) : 0.0;
}

void lac_filter_multiply(lac_filter *f, lac_filter_symbol symbol, const void *context,
                         double *power)
{
    const double sum = do_columns((columns_use){f, symbol, context, true, power != NULL, false});
    if (power != NULL) {
        *power = sum;
    }
}

double lac_filter_power(lac_filter *f, lac_filter_symbol symbol, const void *context)
{
    return do_columns((columns_use){f, symbol, context, false, true, false});
}
