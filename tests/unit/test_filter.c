// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <limits.h>
#include <math.h>
#include <omp.h>
#include <stdbool.h>

#include "base/fft.h"
#include "base/filter.h"
#include "base/rng.h"
#include "support/test.h"

enum { MOST = 96 * 72 };

// A field in the corner of a transform, and what plain transforms make of it.
typedef struct fixture {
    size_t nx, ny, mx, my;
    double x[MOST];        // [ny * nx]
    double filtered[MOST]; // [my * mx] by plain transforms
    double power;          // by plain transforms
    double taken[MOST];    // [ny * nx]
    lac_precision precision;
} fixture;

// Some factor of every wavenumber, even in both
static double factor(size_t k, size_t j) { return 1.0 / (1.0 + (double)(k * k) + 0.5 * (double)j); }

static void symbol_double(const void *context, size_t k, void *column)
{
    const fixture *f = context;
    for (size_t j = 0; j <= f->my / 2; j++) {
        ((double *)column)[j] = factor(k, j);
    }
}

static void symbol_single(const void *context, size_t k, void *column)
{
    const fixture *f = context;
    for (size_t j = 0; j <= f->my / 2; j++) {
        ((float *)column)[j] = (float)factor(k, j);
    }
}

static lac_filter_symbol symbol_of(const fixture *f)
{
    return f->precision == LAC_SINGLE ? symbol_single : symbol_double;
}

static void fill_row(void *context, size_t j, void *row)
{
    const fixture *f = context;
    for (size_t i = 0; i < f->nx; i++) {
        double x = f->x[j * f->nx + i];
        if (f->precision == LAC_SINGLE) {
            ((float *)row)[i] = (float)x;
        } else {
            ((double *)row)[i] = x;
        }
    }
}

static void take_row(void *context, size_t j, void *row)
{
    fixture *f = context;
    for (size_t i = 0; i < f->nx; i++) {
        double x = f->precision == LAC_SINGLE ? (double)((float *)row)[i] : ((double *)row)[i];
        f->taken[j * f->nx + i] += x;
    }
}

static size_t mirrored(size_t j, size_t n) { return 2 * j <= n ? j : n - j; }

static void plain_transforms(fixture *f)
{
    lac_fft *fft = NULL;
    assert_int_equal(lac_fft_create(f->mx, f->my, &fft, NULL), LAC_OK);
    memset(fft->real, 0, f->mx * f->my * sizeof(double));
    for (size_t i = 0; i < f->nx * f->ny; i++) {
        fft->real[i / f->nx * f->mx + i % f->nx] = f->x[i];
    }
    lac_fft_forward(fft);
    f->power = 0.0;
    for (size_t j = 0; j < f->my; j++) {
        for (size_t k = 0; k < fft->nkx; k++) {
            double _Complex *at = &fft->spectrum[j * fft->nkx + k];
            double w = factor(k, mirrored(j, f->my));
            double both = k == 0 || 2 * k == f->mx ? 1.0 : 2.0;
            f->power += both * w * (creal(*at) * creal(*at) + cimag(*at) * cimag(*at));
            *at *= w;
        }
    }
    lac_fft_inverse(fft);
    memcpy(f->filtered, fft->real, f->mx * f->my * sizeof(double));
    lac_fft_free(fft);
}

static fixture *make(size_t nx, size_t ny, bool padded)
{
    fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->nx = nx;
    f->ny = ny;
    f->mx = padded && nx > 1 ? 2 * nx : nx;
    f->my = padded && ny > 1 ? 2 * ny : ny;
    for (size_t i = 0; i < nx * ny; i++) {
        f->x[i] = lac_random_uniform(7, LAC_STREAM_TEST, i, 0) - 0.5;
    }
    plain_transforms(f);
    return f;
}

static void check_taken(const fixture *f, double times)
{
    double cells = (double)(f->mx * f->my);
    double tolerance = times * cells * (f->precision == LAC_SINGLE ? 1e-6 : 1e-14);
    for (size_t i = 0; i < f->nx * f->ny; i++) {
        double expected = times * f->filtered[i / f->nx * f->mx + i % f->nx];
        assert_true(fabs(f->taken[i] - expected) < tolerance);
    }
}

// Filters and takes what there is of a part of a field; returns its power.
static double filter_part(fixture *f, lac_filter *filter, size_t part)
{
    lac_filter_fill(filter, f->precision, part, fill_row, f);
    assert_true(lac_filter_precision(filter) == f->precision);
    // the power leaves what was filled
    double power = lac_filter_power(filter, symbol_of(f), f);
    double same = 0.0;
    lac_filter_multiply(filter, symbol_of(f), f, &same);
    assert_true(same == power);
    lac_filter_take(filter, take_row, f);
    return power;
}

// Every kind of side: even, odd, prime, one cell; alone, and with zeros around by two parts or, in
// double precision and of sides that are multiples of four, five.
static void filter_equals_plain_transforms(void **state)
{
    (void)state;
    const size_t sides[][2] = {{16, 8},  {15, 9},  {7, 12}, {1, 16}, {16, 1}, {1, 1},
                               {2, 2},   {33, 31}, {48, 3}, {3, 48}, {40, 1}, {1, 5},
                               {34, 17}, {17, 34}, {2, 1},  {1, 3},  {4, 5},  {36, 7}};
    for (size_t k = 0; k < 4 * sizeof sides / sizeof sides[0]; k++) {
        fixture *f = make(sides[k / 4][0], sides[k / 4][1], k % 4 > 1);
        lac_filter *filter = NULL;
        f->precision = k % 2 == 0 ? LAC_SINGLE : LAC_DOUBLE;
        double close = f->precision == LAC_SINGLE ? 1e-5 : 1e-12;
        const size_t field[] = {f->nx, f->ny};
        const size_t transform[] = {f->mx, f->my};
        assert_int_equal(lac_filter_create(field, transform, NULL, &filter, NULL), LAC_OK);
        const size_t parts = lac_filter_parts(filter, f->precision);
        const bool many = f->precision == LAC_DOUBLE && f->nx % 4 == 0;
        assert_int_equal(parts, f->mx == f->nx ? 1 : many ? 5 : 2);
        double power = 0.0;
        for (size_t part = 0; part < parts; part++) {
            power += filter_part(f, filter, part);
        }
        assert_true(fabs(power / f->power - 1.0) < close);
        check_taken(f, 1.0);
        // taken once more
        for (int j = 2; parts == 1 && j < 4; j++) {
            lac_filter_take(filter, take_row, f);
            check_taken(f, j);
        }
        lac_filter_free(filter);
        free(f);
    }
}

static void only_large_grids_are_worth_threads(void **state)
{
    (void)state;
    const size_t sides[][2] = {{128, 128}, {256, 255}, {256, 256}, {384, 256}, {512, 512}};
    const int expected[] = {1, 1, 2, 3, 3};
    const int before = omp_get_max_threads();
    omp_set_num_threads(3);
    for (size_t k = 0; k < 5; k++) {
        lac_filter *filter = NULL;
        assert_int_equal(lac_filter_create(sides[k], sides[k], NULL, &filter, NULL), LAC_OK);
        assert_int_equal(lac_filter_threads(filter), expected[k]);
        lac_filter_free(filter);
    }
    omp_set_num_threads(before);
}

static void impossible_transforms_are_refused(void **state)
{
    (void)state;
    lac_filter *filter = NULL;
    lac_error err = {""};
    const size_t field[] = {1, 1};
    const size_t bad[][2] = {{0, 4}, {4, 0}, {(size_t)INT_MAX + 1, 1}, {1, (size_t)INT_MAX + 1}};
    for (size_t k = 0; k < 4; k++) {
        assert_int_equal(lac_filter_create(field, bad[k], NULL, &filter, &err), LAC_EINPUT);
        assert_null(filter);
        assert_non_null(strstr(err.message, "not possible"));
    }
    lac_filter_free(NULL);
}

// lac_fft_filter, whose tables are held by columns.
static void filter_by_table_equals_plain_transforms(void **state)
{
    (void)state;
    const size_t sides[][2] = {{16, 8}, {15, 9}, {1, 16}, {16, 1}, {48, 36}, {33, 31}};
    for (size_t k = 0; k < 2 * sizeof sides / sizeof sides[0]; k++) {
        fixture *f = make(sides[k / 2][0], sides[k / 2][1], k % 2 == 1);
        lac_fft *fft = NULL;
        assert_int_equal(lac_fft_create(f->mx, f->my, &fft, NULL), LAC_OK);
        assert_int_equal(lac_fft_plan_filter(fft, f->ny, NULL), LAC_OK);
        double *table = malloc(fft->nkx * f->my * sizeof *table);
        assert_non_null(table);
        for (size_t i = 0; i < fft->nkx * f->my; i++) {
            table[i] = factor(i / f->my, mirrored(i % f->my, f->my));
        }
        memset(fft->real, 0, f->mx * f->ny * sizeof(double));
        for (size_t i = 0; i < f->nx * f->ny; i++) {
            fft->real[i / f->nx * f->mx + i % f->nx] = f->x[i];
        }
        lac_fft_filter(fft, table);
        for (size_t i = 0; i < f->mx * f->ny; i++) {
            assert_true(fabs(fft->real[i] - f->filtered[i]) < 1e-14 * (double)(f->mx * f->my));
        }
        free(table);
        lac_fft_free(fft);
        free(f);
    }
}

// A quarter of an even field transforms like the whole of it.
static void even_field_from_its_quarter(void **state)
{
    (void)state;
    const size_t sides[][2] = {{5, 4}, {1, 9}, {9, 1}, {1, 1}, {2, 3}, {3, 2}};
    for (size_t k = 0; k < sizeof sides / sizeof sides[0]; k++) {
        size_t n0 = sides[k][0];
        size_t n1 = sides[k][1];
        size_t m0 = n0 > 1 ? 2 * (n0 - 1) : 1;
        size_t m1 = n1 > 1 ? 2 * (n1 - 1) : 1;
        double quarter[45];
        lac_fft *fft = NULL;
        for (size_t i = 0; i < n0 * n1; i++) {
            quarter[i] = lac_random_uniform(3, LAC_STREAM_TEST, i, 0);
        }
        assert_int_equal(lac_fft_create(m1, m0, &fft, NULL), LAC_OK);
        for (size_t i = 0; i < m0 * m1; i++) {
            fft->real[i] = quarter[mirrored(i / m1, m0) * n1 + mirrored(i % m1, m1)];
        }
        lac_fft_forward(fft);
        assert_int_equal(lac_fft_even(n0, n1, quarter, NULL), LAC_OK);
        for (size_t i = 0; i < n0 * n1; i++) {
            double _Complex whole = fft->spectrum[i / n1 * fft->nkx + i % n1];
            assert_true(fabs(quarter[i] - creal(whole)) < 1e-13 && fabs(cimag(whole)) < 1e-13);
        }
        lac_fft_free(fft);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filter_equals_plain_transforms),
        cmocka_unit_test(only_large_grids_are_worth_threads),
        cmocka_unit_test(impossible_transforms_are_refused),
        cmocka_unit_test(filter_by_table_equals_plain_transforms),
        cmocka_unit_test(even_field_from_its_quarter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
