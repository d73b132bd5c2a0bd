// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms in two dimensions of which each rank has some rows, by FFTW's transforms in one. They
// have the bits of its plans in two, as these are made of the same: rows two at a time, columns
// side by side (in the other order, or one by one, last digits differ); tests/unit/test_strip.c.
#include <fftw3.h>

#include "base/fft.h"
#include "base/filter.h"

enum { SIDE_BY_SIDE = 16 }; // columns

lac_status lac_fft_share(size_t nx, size_t ny, lac_team *team, lac_fft **out, lac_error *err)
{
    const int sides[] = {(int)nx, (int)ny}, two = 2, many = SIDE_BY_SIDE;
    if (team == NULL) {
        return lac_fft_create(nx, ny, out, err);
    }
    lac_fft *fft = *out = calloc(1, sizeof *fft);
    LAC_FAIL_MEMORY_IF(fft == NULL, err);
    *fft = (lac_fft){.nx = nx, .ny = ny, .nkx = nx / 2 + 1, .strip = lac_strip_rows(team, ny)};
    const size_t rows = (fft->strip.n + 2) / 2 * 2; // pairs, one at least
    fft->real = fftw_alloc_real(nx * rows);
    fft->spectrum = (double _Complex *)fftw_alloc_complex(fft->nkx * rows);
    LAC_FAIL_MEMORY_IF(fft->real == NULL || fft->spectrum == NULL, err);
    LAC_TRY_RETURN(
        lac_turn_create(&fft->strip, 0, SIDE_BY_SIDE * sizeof *fft->spectrum, &fft->shared, err));
    fftw_complex *plane = (fftw_complex *)(void *)fft->shared->plane;
    fft->rows_inverse =
        fftw_plan_many_dft_c2r(1, &sides[0], two, (fftw_complex *)fft->spectrum, NULL, 1,
                               (int)fft->nkx, fft->real, NULL, 1, sides[0], FFTW_ESTIMATE);
    fft->block_inverse = fftw_plan_many_dft(1, &sides[1], many, plane, NULL, many, 1, plane, NULL,
                                            many, 1, FFTW_BACKWARD, FFTW_ESTIMATE);
    return fft->rows_inverse != NULL && fft->block_inverse != NULL ? LAC_OK : lac_fail_memory(err);
}

static void pack(void *context, size_t first, size_t width, void *packet)
{
    const lac_fft *fft = context;
    double _Complex *to = packet;
    memset(to, 0, fft->strip.n * SIDE_BY_SIDE * sizeof *to);
    for (size_t j = 0; j < fft->strip.n; j++) {
        memcpy(&to[j * SIDE_BY_SIDE], &fft->spectrum[j * fft->nkx + first], width * sizeof *to);
    }
}

static void unpack(void *context, size_t first, size_t width, const void *packet)
{
    const lac_fft *fft = context;
    const double _Complex *from = packet;
    for (size_t j = 0; j < fft->strip.n; j++) {
        memcpy(&fft->spectrum[j * fft->nkx + first], &from[j * SIDE_BY_SIDE], width * sizeof *from);
    }
}

static void work(void *context, size_t first, size_t width, void *plane)
{
    (void)first, (void)width, (void)plane; // which it was planned for
    fftw_execute(((const lac_fft *)context)->block_inverse);
}

void lac_fft_share_inverse(lac_fft *fft)
{
    const lac_turn_use use = {fft, pack, work, unpack};
    const lac_strip columns = lac_strip_of(fft->strip.team, fft->nkx, SIDE_BY_SIDE);
    lac_turn_pass(fft->shared, &columns, sizeof *fft->spectrum, &use);
    for (size_t j = 0; j < fft->strip.n; j += 2) {
        fftw_execute_dft_c2r(fft->rows_inverse, (fftw_complex *)&fft->spectrum[j * fft->nkx],
                             &fft->real[j * fft->nx]);
    }
}

// An even field.
typedef struct even {
    const lac_strip *rows;
    size_t n1, lead;
    double *quarter;
    lac_status status;
    lac_error *err;
} even;

static void pack_even(void *context, size_t first, size_t width, void *packet)
{
    const even *e = context;
    double *to = packet;
    for (size_t k = 0; k < width; k++) {
        for (size_t j = 0; j < e->rows->n; j++) {
            *to++ = e->quarter[j * e->n1 + first + k];
        }
    }
}

static void unpack_even(void *context, size_t first, size_t width, const void *packet)
{
    const even *e = context;
    const double *from = packet;
    for (size_t k = 0; k < width; k++) {
        for (size_t j = 0; j < e->rows->n; j++) {
            e->quarter[j * e->n1 + first + k] = *from++;
        }
    }
}

// Lines one by one.
static void transform_lines(even *e, size_t n, double *line, size_t lines, size_t apart)
{
    for (size_t k = 0; e->status == LAC_OK && k < lines; k++) {
        e->status = lac_fft_even(1, n, line + k * apart, e->err);
    }
}

static void work_even(void *context, size_t first, size_t width, void *plane)
{
    even *e = context;
    (void)first;
    transform_lines(e, e->rows->all, plane, width, e->lead);
}

// Columns here, of which the rows here take the place: on and right of the diagonal.
static void mirror_even(void *context, size_t first, size_t width, void *plane)
{
    const even *e = context;
    for (size_t k = 0; k < width; k++) {
        double *row = &e->quarter[(first + k - e->rows->first) * e->n1];
        const double *line = (const double *)plane + k * e->lead;
        memcpy(&row[first + k], &line[first + k], (e->n1 - first - k) * sizeof *row);
    }
}

lac_status lac_fft_share_even(const lac_strip *rows, size_t n1, bool mirrored, double *quarter,
                              lac_error *err)
{
    if (rows->team == NULL) {
        return lac_fft_even(rows->all, n1, quarter, err);
    }
    lac_turn *shared = NULL;
    even e = {rows, n1, (rows->all + 9) / 8 * 8, quarter, LAC_OK, err};
    const lac_strip columns = lac_strip_of(rows->team, n1, rows->grain);
    const lac_turn_use transform = {&e, pack_even, work_even, unpack_even};
    const lac_turn_use mirror = {&e, pack_even, mirror_even, NULL};
    lac_status status = lac_turn_create(rows, e.lead, rows->grain * sizeof(double), &shared, err);
    if (status == LAC_OK) {
        transform_lines(&e, n1, quarter, rows->n, n1);
        lac_turn_pass(shared, &columns, sizeof *quarter, &transform);
        if (mirrored) {
            lac_turn_pass(shared, &columns, sizeof *quarter, &mirror);
        }
        status = e.status;
    }
    lac_turn_free(shared);
    return status;
}
