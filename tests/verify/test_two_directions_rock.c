// SPDX-License-Identifier: GPL-3.0-or-later
// What ties cells that slip in two directions: the rock under waves of slip against the tensor of a
// half-space, and the solves of all transfers against dense ones.
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>
#include <math.h>

#include "base/rng.h"
#include "support/slot.h"
#include "support/test.h"
#include "transfer/transfer.h"

typedef struct ties {
    lac_domain *domain;
    lac_hierarchy *h;
    lac_model model;
    lac_transfer transfer;
    double *work;
} ties;

static const double g = 3.0, nu = 0.3;

static double uniform(uint64_t i, uint64_t k)
{
    return lac_random_uniform(5, LAC_STREAM_TEST, i, k);
}

// A grid of cells 1 m by 1.5 m, some without contact.
static void make(const char *name, size_t nx, size_t ny, double contact, const char *key,
                 double value, ties *out)
{
    lac_error err;
    const lac_transfer_kind *kind;
    size_t i = 0;
    *out = (ties){0};
    lac_grid grid = {.nx = nx, .ny = ny, .dx = 1.0, .dy = 1.5, .periodic = true};
    double pressure[256];
    for (size_t k = 0; k < nx * ny; k++) {
        pressure[k] = k > 0 && uniform(k, 9) > contact ? 0.0 : 1e6;
    }
    while ((kind = lac_transfer_kind_get(i)) != NULL && strcmp(kind->info.name, name) != 0) {
        i++;
    }
    assert_non_null(kind);
    assert_int_equal(lac_domain_create(&grid, pressure, &out->domain, &err), LAC_OK);
    assert_int_equal(lac_hierarchy_create(out->domain, &out->h, &err), LAC_OK);
    assert_int_equal(lac_model_create(&kind->info, &out->model, &err), LAC_OK);
    if (key != NULL) {
        test_slot_set(&out->model, key, value);
    }
    lac_transfer_scene scene = {out->domain, out->h, g, nu, false, false, NULL};
    assert_int_equal(lac_transfer_create(&out->model, &scene, &out->transfer, &err), LAC_OK);
    assert_int_equal(lac_transfer_direct(&out->model, &scene, &out->transfer, &err), LAC_OK);
    out->work = calloc(kind->pair->work(out->transfer.state) + 1, sizeof *out->work);
}

static void clear(ties *t)
{
    free(t->work);
    lac_transfer_clear(&t->transfer);
    lac_model_clear(&t->model);
    lac_hierarchy_free(t->h);
    lac_domain_free(t->domain);
}

static void apply(const ties *t, const double *x, double *y)
{
    const size_t n = t->domain->n;
    const double *const slip[2] = {x, x + n};
    double *const force[2] = {y, y + n};
    t->transfer.kind->pair->apply(t->transfer.state, slip, force, t->work);
}

// S = G/2 |k| (1 + nu/(1 - nu) e e^T), e along the wave.
static void waves_feel_the_tensor_of_the_rock(void **state)
{
    (void)state;
    enum { NX = 12, NY = 10 };
    static const double waves[][2] = {{1, 0}, {0, 1}, {2, 3}, {-4, 1}, {5, -4}, {3, 4}};
    ties t;
    make("elastic", NX, NY, 1.0, NULL, 0.0, &t);
    const size_t n = t.domain->n;
    for (size_t w = 0; w < sizeof waves / sizeof *waves; w++) {
        const double kx = 2.0 * M_PI * waves[w][0] / NX, ky = 2.0 * M_PI * waves[w][1] / (1.5 * NY);
        const double k = hypot(kx, ky), ex = kx / k, ey = ky / k, more = nu / (1.0 - nu);
        const double ax = 0.7, ay = -1.9;
        const double along = more * (ex * ax + ey * ay);
        double x[2 * NX * NY], y[2 * NX * NY];
        for (size_t i = 0; i < n; i++) {
            const size_t at = t.domain->index[i];
            const double phase = kx * (double)(at % NX) + ky * 1.5 * (double)(at / NX) + 0.4;
            x[i] = ax * cos(phase);
            x[n + i] = ay * cos(phase);
        }
        apply(&t, x, y);
        for (size_t i = 0; i < n; i++) {
            const double s = 0.5 * g * k;
            assert_true(fabs(y[i] - s * (ax + along * ex) * x[i] / ax) < 1e-12 * s);
            assert_true(fabs(y[n + i] - s * (ay + along * ey) * x[n + i] / ay) < 1e-12 * s);
        }
    }
    clear(&t);
}

// The shortest wave goes both ways along its axis, so that slip along x pulls no more up than down.
static void the_shortest_wave_pulls_no_way_across(void **state)
{
    (void)state;
    enum { NX = 12, NY = 10 };
    double x[2 * NX * NY] = {0}, y[2 * NX * NY];
    ties t;
    make("elastic", NX, NY, 1.0, NULL, 0.0, &t);
    for (size_t i = 0; i < NX * NY; i++) {
        const size_t at = t.domain->index[i];
        x[i] = cos(2.0 * M_PI * 3.0 / NX * (double)(at % NX)) * (at / NX % 2 == 0 ? 1.0 : -1.0);
    }
    apply(&t, x, y);
    for (size_t i = 0; i < NX * NY; i++) {
        assert_true(fabs(y[NX * NY + i]) < 1e-12 && y[i] * x[i] > -1e-12);
    }
    clear(&t);
}

// Rock of a thickness holds uniform slip by G/(2 thickness), whichever way.
static void slabs_hold_uniform_slip(void **state)
{
    (void)state;
    double x[2 * 36], y[2 * 36];
    ties t;
    make("elastic", 6, 6, 1.0, "thickness", 5.0, &t);
    for (size_t i = 0; i < 36; i++) {
        x[i] = 2.0;
        x[36 + i] = -3.0;
    }
    apply(&t, x, y);
    for (size_t i = 0; i < 36; i++) {
        assert_true(fabs(y[i] - 2.0 * g / 10.0) < 1e-12 &&
                    fabs(y[36 + i] + 3.0 * g / 10.0) < 1e-12);
    }
    clear(&t);
}

// Slip across a wave is held by G/2 |k|, slip along it by 1/(1 - nu) times as much: blocks of a row
// of cells have two stiffnesses.
static void blocks_of_a_row_are_stiffer_along_it(void **state)
{
    (void)state;
    double x[32], y[32];
    ties t;
    make("hierarchy", 16, 1, 1.0, "stiffness", 0.0, &t);
    for (size_t i = 0; i < 16; i++) {
        x[i] = x[16 + i] = uniform(i, 3) - 0.5;
    }
    apply(&t, x, y);
    for (size_t i = 0; i < 16; i++) {
        assert_true(fabs(y[i] * (1.0 - nu) - y[16 + i]) < 1e-2 * fabs(y[i]) + 1e-12);
        assert_true(fabs(y[i]) > 0.0);
    }
    clear(&t);
}

// D of each cell: of eigenvalues apart by decades, its directions at random, some below nothing
// along one of them where what ties the cells makes up for it.
static void fill_blocks(size_t n, bool soft, double *d)
{
    for (size_t i = 0; i < n; i++) {
        const double way = 7.0 * uniform(i, 0), x = cos(way), y = sin(way);
        const double across = pow(10.0, 4.0 * uniform(i, 1) - 1.0);
        const double along = soft && i % 5 == 0 ? -0.05 : across * pow(10.0, -2.0 * uniform(i, 2));
        d[i] = along * x * x + across * y * y;
        d[n + i] = (along - across) * x * y;
        d[2 * n + i] = along * y * y + across * x * x;
    }
}

static gsl_matrix *dense(const ties *t, const double *d, double k_mean)
{
    const size_t n = t->domain->n;
    gsl_matrix *a = gsl_matrix_alloc(2 * n, 2 * n);
    double x[512], y[512];
    for (size_t k = 0; k < 2 * n; k++) {
        memset(x, 0, sizeof x);
        x[k] = 1.0;
        apply(t, x, y);
        for (size_t i = 0; i < 2 * n; i++) {
            const bool own = i % n == k % n;
            const double block = !own ? 0.0 : d[(i / n + k / n) * n + i % n];
            const double mean = i / n == k / n ? k_mean / (double)n : 0.0;
            gsl_matrix_set(a, i, k, y[i] + block + mean);
        }
    }
    return a;
}

static void check_solve(const ties *t, bool soft, double k_mean, double error)
{
    const size_t n = t->domain->n;
    double d[3 * 256], b[512], mine[512];
    fill_blocks(n, soft, d);
    gsl_matrix *a = dense(t, d, k_mean);
    gsl_vector *right = gsl_vector_alloc(2 * n), *x = gsl_vector_alloc(2 * n);
    gsl_permutation *p = gsl_permutation_alloc(2 * n);
    int sign;
    double most = 0.0;
    for (size_t i = 0; i < 2 * n; i++) {
        b[i] = mine[i] = uniform(i, 7) - 0.5;
        gsl_vector_set(right, i, b[i]);
        for (size_t k = 0; k < i; k++) {
            assert_true(fabs(gsl_matrix_get(a, i, k) - gsl_matrix_get(a, k, i)) < 1e-12);
        }
    }
    const double *const blocks[3] = {d, d + n, d + 2 * n};
    double *const solved[2] = {mine, mine + n};
    assert_true(t->transfer.kind->pair->solve(t->transfer.state, k_mean, blocks, solved, t->work));
    gsl_linalg_LU_decomp(a, p, &sign);
    gsl_linalg_LU_solve(a, p, right, x);
    for (size_t i = 0; i < 2 * n; i++) {
        most = fmax(most, fabs(gsl_vector_get(x, i)));
    }
    for (size_t i = 0; i < 2 * n; i++) {
        if (!(fabs(mine[i] - gsl_vector_get(x, i)) < error * most)) {
            fail_msg("%s, unknown %zu: %g, dense %g", t->transfer.kind->info.name, i, mine[i],
                     gsl_vector_get(x, i));
        }
    }
    gsl_permutation_free(p);
    gsl_vector_free(right);
    gsl_vector_free(x);
    gsl_matrix_free(a);
}

static void solves_are_those_of_the_dense_matrix(void **state)
{
    (void)state;
    static const double means[] = {0.0, 0.3};
    for (size_t k = 0; k < 2; k++) {
        ties t;
        make("none", 7, 4, 0.7, NULL, 0.0, &t);
        check_solve(&t, false, means[k], 1e-11);
        clear(&t);
        make("hierarchy", 12, 5, 0.5, "k0", 2.0, &t);
        check_solve(&t, false, means[k], 1e-11);
        check_solve(&t, true, means[k], 1e-11);
        clear(&t);
        make("hierarchy", 11, 6, 0.6, "stiffness", 0.0, &t);
        check_solve(&t, false, means[k], 1e-11);
        check_solve(&t, true, means[k], 1e-11);
        clear(&t);
        make("elastic", 8, 6, 1.0, "newton_tolerance", 1e-13, &t);
        check_solve(&t, false, means[k], 1e-9);
        check_solve(&t, true, means[k], 1e-9);
        clear(&t);
        make("hierarchy", 1, 1, 1.0, "k0", 2.0, &t);
        check_solve(&t, false, means[k], 1e-13);
        clear(&t);
    }
}

// A matrix that is not positive definite is refused; blocks up to the largest of numbers are not.
static void what_cannot_be_solved_is_refused(void **state)
{
    (void)state;
    double d[3] = {1.0, 2.0, 1.0}, x[2] = {1.0, 1.0};
    const double *const blocks[3] = {d, d + 1, d + 2};
    double *const solved[2] = {x, x + 1};
    ties t;
    make("none", 1, 1, 1.0, NULL, 0.0, &t);
    const lac_transfer_pair *pair = t.transfer.kind->pair;
    assert_false(pair->solve(t.transfer.state, 0.5, blocks, solved, t.work));
    assert_true(pair->solve(t.transfer.state, 1.5, blocks, solved, t.work));
    d[0] = d[2] = 1e250;
    d[1] = 0.5e250;
    x[0] = x[1] = 1.5e250;
    assert_true(pair->solve(t.transfer.state, 0.0, blocks, solved, t.work));
    assert_true(fabs(x[0] - 1.0) < 1e-15 && fabs(x[1] - 1.0) < 1e-15);
    d[1] = NAN;
    assert_false(pair->solve(t.transfer.state, 0.0, blocks, solved, t.work));
    clear(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waves_feel_the_tensor_of_the_rock),
        cmocka_unit_test(the_shortest_wave_pulls_no_way_across),
        cmocka_unit_test(slabs_hold_uniform_slip),
        cmocka_unit_test(blocks_of_a_row_are_stiffer_along_it),
        cmocka_unit_test(solves_are_those_of_the_dense_matrix),
        cmocka_unit_test(what_cannot_be_solved_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
