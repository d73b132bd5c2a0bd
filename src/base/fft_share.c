// SPDX-License-Identifier: GPL-3.0-or-later
// Transforms in two dimensions of which each rank has some rows, by FFTW's transforms in one. They
// have the bits of its plans in two, as these are made of the same: rows two at a time, columns
// side by side (in the other order, or one by one, last digits differ); tests/unit/test_strip.c.
#include <fftw3.h>

#include "base/fft.h"
#include "base/filter.h"

enum { SIDE_BY_SIDE = 16 }; // columns

// Plans of a plane of columns, beside those of rows; stride and distance as FFTW counts.
static lac_status plan_columns(lac_fft *fft, int stride, int apart, lac_error *err)
{
    const int n = (int)fft->ny, many = SIDE_BY_SIDE;
    fftw_complex *plane = (fftw_complex *)(void *)fft->shared->plane;
    fft->block_forward = fftw_plan_many_dft(1, &n, many, plane, NULL, stride, apart, plane, NULL,
                                            stride, apart, FFTW_FORWARD, FFTW_ESTIMATE);
    fft->block_inverse = fftw_plan_many_dft(1, &n, many, plane, NULL, stride, apart, plane, NULL,
                                            stride, apart, FFTW_BACKWARD, FFTW_ESTIMATE);
    const bool planned = fft->rows_forward != NULL && fft->rows_inverse != NULL &&
                         fft->block_forward != NULL && fft->block_inverse != NULL;
    return planned ? LAC_OK : lac_fail_memory(err);
}

// Room for the rows here and plans.
// @param lead  of the columns' plane
static lac_status prepare(const size_t sides[2], size_t rows, size_t lead, lac_team *team,
                          lac_fft **out, lac_error *err)
{
    const int n = (int)sides[0], two = 2;
    lac_fft *fft = *out = calloc(1, sizeof *fft);
    LAC_FAIL_MEMORY_IF(fft == NULL, err);
    *fft = (lac_fft){.nx = sides[0],
                     .ny = sides[1],
                     .nkx = sides[0] / 2 + 1,
                     .strip = lac_strip_rows(team, rows),
                     .rows = rows,
                     .lead = lead};
    fft->columns = lac_strip_of(team, fft->nkx, SIDE_BY_SIDE);
    const size_t pairs = (fft->strip.n + 2) / 2; // one at least
    fft->real = fftw_alloc_real(fft->nx * 2 * pairs);
    fft->spectrum = (double _Complex *)fftw_alloc_complex(fft->nkx * 2 * pairs);
    LAC_FAIL_MEMORY_IF(fft->real == NULL || fft->spectrum == NULL, err);
    memset(fft->real, 0, fft->nx * 2 * pairs * sizeof *fft->real);
    LAC_TRY_RETURN(lac_turn_create(&fft->strip, lead, SIDE_BY_SIDE * sizeof *fft->spectrum,
                                   &fft->shared, err));
    fftw_complex *spectrum = (fftw_complex *)fft->spectrum;
    fft->rows_forward = fftw_plan_many_dft_r2c(1, &n, two, fft->real, NULL, 1, n, spectrum, NULL, 1,
                                               (int)fft->nkx, FFTW_ESTIMATE);
    fft->rows_inverse = fftw_plan_many_dft_c2r(1, &n, two, spectrum, NULL, 1, (int)fft->nkx,
                                               fft->real, NULL, 1, n, FFTW_ESTIMATE);
    return plan_columns(fft, lead > 0 ? 1 : SIDE_BY_SIDE, lead > 0 ? (int)lead : 1, err);
}

static lac_status share(size_t nx, size_t ny, size_t rows, size_t lead, lac_team *team,
                        lac_fft **out, lac_error *err)
{
    const lac_status status = prepare((const size_t[]){nx, ny}, rows, lead, team, out, err);
    return lac_team_agree(team, status, err); // none waits for one without memory
}

lac_status lac_fft_share(size_t nx, size_t ny, lac_team *team, lac_fft **out, lac_error *err)
{
    return team == NULL ? lac_fft_create(nx, ny, out, err) : share(nx, ny, ny, 0, team, out, err);
}

lac_status lac_fft_share_filter(size_t nx, size_t ny, size_t rows, lac_team *team, lac_fft **out,
                                lac_error *err)
{
    return share(nx, ny, rows, ny + 4, team, out, err); // as lac_fft_plan_filter
}

static void rows_forth(lac_fft *fft)
{
    for (size_t j = 0; j < fft->strip.n; j += 2) {
        fftw_execute_dft_r2c(fft->rows_forward, &fft->real[j * fft->nx],
                             (fftw_complex *)&fft->spectrum[j * fft->nkx]);
    }
}

static void rows_back(lac_fft *fft)
{
    for (size_t j = 0; j < fft->strip.n; j += 2) {
        fftw_execute_dft_c2r(fft->rows_inverse, (fftw_complex *)&fft->spectrum[j * fft->nkx],
                             &fft->real[j * fft->nx]);
    }
}

// What is done to columns: a table that is made, or multiplied by.
typedef struct tabled {
    lac_fft *fft;
    double *made;
    const double *given;
} tabled;

static void turn(tabled *t, void (*work)(void *context, size_t first, size_t width, void *plane),
                 bool returns)
{
    const lac_turn_use use = {t, NULL, t->fft->spectrum, t->fft->nkx, work, returns};
    lac_turn_pass(t->fft->shared, &t->fft->columns, sizeof *t->fft->spectrum, &use);
}

static void work(void *context, size_t first, size_t width, void *plane)
{
    (void)first, (void)width, (void)plane; // which it was planned for
    fftw_execute(((const tabled *)context)->fft->block_inverse);
}

void lac_fft_share_inverse(lac_fft *fft)
{
    turn(&(tabled){fft, NULL, NULL}, work, true);
    rows_back(fft);
}

static void work_table(void *context, size_t first, size_t width, void *plane)
{
    const tabled *t = context;
    const lac_fft *fft = t->fft;
    const double _Complex *from = plane;
    const double cells = (double)fft->nx * (double)fft->ny;
    fftw_execute(fft->block_forward);
    for (size_t k = 0; k < width; k++) {
        double *to = &t->made[(first + k - fft->columns.first) * fft->ny];
        for (size_t j = 0; j < fft->ny; j++) {
            to[j] = creal(from[j * SIDE_BY_SIDE + k]) / cells;
        }
    }
}

void lac_fft_share_table(lac_fft *fft, double *table)
{
    rows_forth(fft);
    turn(&(tabled){fft, table, NULL}, work_table, false);
}

static void work_lines(void *context, size_t first, size_t width, void *plane)
{
    const tabled *t = context;
    const size_t at = (first - t->fft->columns.first) * t->fft->ny;
    lac_fft_columns(t->fft, plane, width, &t->given[at]);
}

void lac_fft_share_through(lac_fft *fft, const double *table)
{
    rows_forth(fft);
    turn(&(tabled){fft, NULL, table}, work_lines, true);
    rows_back(fft);
}

// An even field.
typedef struct even {
    const lac_strip *rows;
    size_t n1, lead;
    double *quarter;
    lac_status status;
    lac_error *err;
} even;

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
    const lac_turn_use transform = {&e, NULL, quarter, n1, work_even, true};
    const lac_turn_use mirror = {&e, NULL, quarter, n1, mirror_even, false};
    lac_status status = lac_turn_create(rows, e.lead, rows->grain * sizeof(double), &shared, err);
    status = lac_team_agree(rows->team, status, err);
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
