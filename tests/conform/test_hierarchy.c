// SPDX-License-Identifier: GPL-3.0-or-later
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/test.h"
#include "support/trees.h"

enum { TREES = 300, MAX_CELLS = 400, SMALL = 60 };

// Elimination is O(n^3): every eighth tree at full size, the others small.
static lac_domain *to_eliminate(uint64_t seed)
{
    return random_domain(seed, seed % 8 == 0 ? MAX_CELLS : SMALL);
}

typedef struct scene {
    lac_domain *domain;
    lac_hierarchy *h;
    size_t n, levels;
    double k[33];
    double *d, *x, *y, *z, *work;
} scene;

// k_l in [k_low, k_high], D in [d_low, d_high], uniform in their logarithms; y random.
static scene scene_of(lac_domain *domain, uint64_t seed, double k_low, double k_high)
{
    scene s = {.domain = domain, .h = hierarchy_of(domain), .n = domain->n};
    s.levels = lac_hierarchy_levels(s.h);
    s.d = new_doubles(s.n);
    s.x = new_doubles(s.n);
    s.y = new_doubles(s.n);
    s.z = new_doubles(s.n);
    s.work = new_doubles(lac_hierarchy_work(s.h));
    for (size_t l = 0; l < s.levels; l++) {
        s.k[l] = draw_log(seed, 1000 + l, k_low, k_high);
    }
    for (size_t i = 0; i < s.n; i++) {
        s.d[i] = draw_log(seed, 2000 + i, 0.1, 10);
        s.y[i] = draw_uniform(seed, 3000000 + i, -1, 1);
    }
    return s;
}

static void scene_free(scene *s)
{
    lac_hierarchy_free(s->h);
    lac_domain_free(s->domain);
    free(s->d);
    free(s->x);
    free(s->y);
    free(s->z);
    free(s->work);
}

// Numbers of blocks, ranks and offsets against the cells' coordinates.
static void blocks_are_those_of_the_grid(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < test_some(TREES); seed++) {
        scene s = scene_of(random_domain(seed, MAX_CELLS), seed, 1, 1);
        size_t nx = s.domain->grid.nx;
        assert_int_equal(lac_hierarchy_cells(s.h), s.n);
        assert_int_equal(lac_hierarchy_blocks(s.h, s.levels), 1);
        for (size_t l = 0; l <= s.levels; l++) {
            const uint32_t *first = lac_hierarchy_offsets(s.h, l);
            size_t block = 0;
            for (size_t i = 0; i < s.n; i++) {
                size_t a = s.domain->index[i], b = i > 0 ? s.domain->index[i - 1] : 0;
                bool starts = i == 0 || a % nx >> l != b % nx >> l || a / nx >> l != b / nx >> l;
                if (starts) {
                    assert_int_equal(first[block++], i);
                }
            }
            assert_int_equal(first[block], s.n);
            assert_int_equal(lac_hierarchy_blocks(s.h, l), block);
            if (l < s.levels) {
                assert_int_equal(lac_hierarchy_rank(s.h, l),
                                 block - lac_hierarchy_blocks(s.h, l + 1));
            }
        }
        scene_free(&s);
    }
}

// y = P_level x: every cell gets the mean over its block.
static void project(const lac_hierarchy *h, size_t level, const double *x, double *y)
{
    const uint32_t *first = lac_hierarchy_offsets(h, level);
    for (size_t b = 0; b < lac_hierarchy_blocks(h, level); b++) {
        double sum = 0;
        for (uint32_t i = first[b]; i < first[b + 1]; i++) {
            sum += x[i];
        }
        for (uint32_t i = first[b]; i < first[b + 1]; i++) {
            y[i] = sum / (first[b + 1] - first[b]);
        }
    }
}

static void project_is_the_block_mean(void **state)
{
    (void)state;
    scene s = scene_of(random_domain(11, MAX_CELLS), 11, 1, 1);
    long double *dense = calloc(s.n * s.n, sizeof *dense);
    assert_non_null(dense);
    for (size_t level = 0; level <= s.levels; level++) {
        // K with k_j = 1 for j >= level is P_level - P_m.
        double k[33] = {0}, mean = 0;
        for (size_t j = level; j < s.levels; j++) {
            k[j] = 1;
        }
        dense_hierarchy(s.domain, s.levels, k, dense);
        project(s.h, level, s.y, s.x);
        for (size_t i = 0; i < s.n; i++) {
            mean += s.y[i] / (double)s.n;
        }
        for (size_t i = 0; i < s.n; i++) {
            long double p = mean;
            for (size_t j = 0; j < s.n; j++) {
                p += dense[i * s.n + j] * s.y[j];
            }
            assert_true(fabs(s.x[i] - (double)p) < 1e-13);
        }
    }
    free(dense);
    scene_free(&s);
}

static void apply_agrees_with_the_dense_matrix(void **state)
{
    (void)state;
    double worst = 0;
    long double *dense = calloc((size_t)MAX_CELLS * MAX_CELLS, sizeof *dense);
    assert_non_null(dense);
    for (uint64_t seed = 0; seed < test_some(TREES); seed++) {
        scene s = scene_of(random_domain(seed, MAX_CELLS), seed, 1e-3, 1e3);
        dense_hierarchy(s.domain, s.levels, s.k, dense);
        lac_hierarchy_apply(s.h, s.k, s.y, s.x, s.work);
        double scale = 0;
        for (size_t i = 0; i < s.n; i++) {
            long double sum = 0;
            for (size_t j = 0; j < s.n; j++) {
                sum += dense[i * s.n + j] * s.y[j];
            }
            s.z[i] = (double)sum;
            scale = fmax(scale, fabs(s.z[i]));
        }
        for (size_t i = 0; i < s.n && scale > 0; i++) {
            worst = fmax(worst, fabs(s.x[i] - s.z[i]) / scale);
        }
        assert_true(s.n > 1 || s.x[0] == 0);
        scene_free(&s);
    }
    free(dense);
    print_message("apply against the dense matrix: %.1e\n", worst);
    assert_true(worst < 1e-12);
}

static void solve_agrees_with_the_dense_matrix(void **state)
{
    (void)state;
    double worst = 0;
    long double *dense = calloc((size_t)MAX_CELLS * MAX_CELLS, sizeof *dense);
    long double *x = calloc(MAX_CELLS, sizeof *x);
    assert_true(dense != NULL && x != NULL);
    for (uint64_t seed = 0; seed < test_some(TREES); seed++) {
        scene s = scene_of(to_eliminate(seed), seed, 1e-3, 1e3);
        double k_mean = seed % 2 == 0 ? 0 : 7;
        dense_hierarchy(s.domain, s.levels, s.k, dense);
        for (size_t i = 0; i < s.n; i++) {
            dense[i * s.n + i] += s.d[i];
            for (size_t j = 0; j < s.n; j++) {
                dense[i * s.n + j] += (long double)k_mean / (long double)s.n;
            }
            x[i] = s.y[i];
        }
        dense_solve(s.n, dense, x);
        for (size_t i = 0; i < s.n; i++) {
            s.z[i] = (double)x[i];
        }
        assert_true(lac_hierarchy_solve(s.h, s.k, k_mean, s.d, s.y, s.x, s.work));
        worst = fmax(worst, relative_error(s.n, s.x, s.z));
        // In place: the same bits.
        assert_true(lac_hierarchy_solve(s.h, s.k, k_mean, s.d, s.y, s.y, s.work));
        assert_memory_equal(s.x, s.y, s.n * sizeof *s.x);
        scene_free(&s);
    }
    free(dense);
    free(x);
    print_message("solve against the dense matrix: %.1e\n", worst);
    assert_true(worst < 1e-12);
}

// |sum D x - sum y| / sum |y| and the largest error of (D + K + k_mean P_m) x = y.
static void residuals(scene *s, double k_mean, double *balance, double *inverse)
{
    assert_true(lac_hierarchy_solve(s->h, s->k, k_mean, s->d, s->y, s->x, s->work));
    lac_hierarchy_apply(s->h, s->k, s->x, s->z, s->work);
    long double force = 0, sum = 0, size = 0, mean = 0;
    for (size_t i = 0; i < s->n; i++) {
        force += (long double)s->d[i] * s->x[i];
        sum += s->y[i];
        size += fabs(s->y[i]);
        mean += s->x[i];
    }
    mean /= (long double)s->n;
    force += k_mean * mean * (long double)s->n;
    for (size_t i = 0; i < s->n; i++) {
        s->z[i] += s->d[i] * s->x[i] + k_mean * (double)mean;
    }
    *balance = (double)(fabsl(force - sum) / size);
    *inverse = relative_error(s->n, s->z, s->y);
}

static void forces_balance_whatever_the_stiffness(void **state)
{
    (void)state;
    for (double ratio = 1; ratio < 2e15; ratio *= 1e3) {
        double worst = 0;
        for (uint64_t seed = 0; seed < test_some(TREES); seed++) {
            scene s = scene_of(random_domain(seed, MAX_CELLS), seed, ratio, ratio);
            double balance, inverse;
            for (size_t l = 1; l < s.levels && seed % 2 == 0; l++) {
                s.k[l] = s.k[l - 1] / 2;
            }
            for (size_t i = 0; i < s.n && seed % 3 == 0; i++) {
                s.y[i] = fabs(s.y[i]);
            }
            residuals(&s, seed % 5 == 0 ? 0.3 : 0, &balance, &inverse);
            worst = fmax(worst, balance);
            scene_free(&s);
        }
        print_message("k/D %.0e: force balance %.1e\n", ratio, worst);
        assert_true(worst <= 1e-14);
    }
}

static void solve_inverts_apply_on_a_million_cells(void **state)
{
    (void)state;
    const size_t side = test_few() ? 256 : 2048;
    lac_grid grid = {side, side, 1, 1, true};
    lac_cascade cascade = {1.84, 5};
    lac_model model = {&lac_domain_source_get(1)->info, &cascade};
    lac_domain *domain = NULL;
    assert_int_equal(lac_domain_from_source(&model, &grid, 1, &domain, NULL), LAC_OK);
    assert_true(domain->n > side * side / 4);
    scene s = scene_of(domain, 1, 0.01, 100);
    double balance, inverse;
    residuals(&s, 0.5, &balance, &inverse);
    print_message("%zu cells: solve inverts apply to %.1e, force balance %.1e\n", s.n, inverse,
                  balance);
    assert_true(inverse < 1e-10 && balance <= 1e-14);

    for (size_t l = 0; l < s.levels; l++) {
        s.k[l] = ldexp(1e15, -(int)l);
    }
    residuals(&s, 0.5, &balance, &inverse);
    print_message("%zu cells: force balance %.1e at k/D 1e15\n", s.n, balance);
    assert_true(balance <= 1e-14);
    scene_free(&s);
}

// With k falling with the level, solve refuses exactly the matrices that Cholesky refuses.
static void indefinite_matrices_are_refused(void **state)
{
    (void)state;
    int refused = 0, accepted_negative = 0;
    long double *dense = calloc((size_t)MAX_CELLS * MAX_CELLS, sizeof *dense);
    assert_non_null(dense);
    for (uint64_t seed = 0; seed < TREES; seed++) {
        scene s = scene_of(random_domain(seed, 60), seed, 0.5, 20);
        for (size_t l = 1; l < s.levels; l++) {
            s.k[l] = s.k[l - 1] * draw_uniform(seed, 500 + l, 0.1, 1);
        }
        bool negative = false;
        for (size_t i = 0; i < s.n; i++) {
            s.d[i] *= draw_uniform(seed, 9000 + i, 0, 1) < 0.2 ? -0.3 : 1;
            negative |= s.d[i] < 0;
        }
        dense_hierarchy(s.domain, s.levels, s.k, dense);
        for (size_t i = 0; i < s.n; i++) {
            dense[i * s.n + i] += s.d[i];
        }
        bool positive = dense_positive(s.n, dense);
        assert_int_equal(lac_hierarchy_solve(s.h, s.k, 0, s.d, s.y, s.x, s.work), positive);
        refused += !positive;
        accepted_negative += positive && negative;
        if (positive) {
            double balance, inverse;
            residuals(&s, 0, &balance, &inverse);
            assert_true(inverse < 1e-9);
        }
        scene_free(&s);
    }
    free(dense);
    print_message("refused %d, solved with negative D %d of %d\n", refused, accepted_negative,
                  TREES);
    assert_true(refused > 20 && accepted_negative > 20);
}

static void bad_diagonals_are_refused(void **state)
{
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY, -1e300};
    for (uint64_t seed = 0; seed < test_some(60); seed++) {
        scene s = scene_of(random_domain(seed, 50), seed, 1, 1);
        size_t at = seed % s.n;
        double d = s.d[at];
        for (size_t b = 0; b < 4; b++) {
            s.d[at] = bad[b];
            assert_false(lac_hierarchy_solve(s.h, s.k, 0, s.d, s.y, s.x, s.work));
        }
        s.d[at] = d;
        assert_false(lac_hierarchy_solve(s.h, s.k, NAN, s.d, s.y, s.x, s.work));
        assert_false(lac_hierarchy_solve(s.h, s.k, -1e9, s.d, s.y, s.x, s.work));
        memset(s.d, 0, s.n * sizeof *s.d); // K alone does not hold the mean
        assert_false(lac_hierarchy_solve(s.h, s.k, 0, s.d, s.y, s.x, s.work));
        assert_true(lac_hierarchy_solve(s.h, s.k, 2, s.d, s.y, s.x, s.work)); // a spring does
        scene_free(&s);
    }
}

static void extreme_diagonals_are_solved(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < test_some(TREES); seed++) {
        scene s = scene_of(random_domain(seed, 200), seed, 1e-8, 1e8);
        for (size_t i = 0; i < s.n; i++) {
            s.d[i] = draw_log(seed, 7000 + i, 1e-150, 1e150);
        }
        double balance, inverse;
        residuals(&s, 0, &balance, &inverse);
        assert_true(balance <= 1e-14);
        scene_free(&s);
    }
}

static void one_cell_in_a_large_grid(void **state)
{
    (void)state;
    uint8_t *mask = calloc((size_t)1024 * 1024, 1);
    assert_non_null(mask);
    mask[777 * 1024 + 333] = 1;
    scene s = scene_of(domain_of(1024, 1024, mask), 3, 1, 1);
    assert_int_equal(s.levels, 10);
    for (size_t l = 0; l < 10; l++) {
        assert_int_equal(lac_hierarchy_rank(s.h, l), 0);
    }
    lac_hierarchy_apply(s.h, s.k, s.y, s.x, s.work);
    assert_true(s.x[0] == 0);
    s.d[0] = -2;
    assert_false(lac_hierarchy_solve(s.h, s.k, 0, s.d, s.y, s.x, s.work));
    assert_true(lac_hierarchy_solve(s.h, s.k, 6, s.d, s.y, s.x, s.work));
    assert_true(s.x[0] == s.y[0] / 4);
    scene_free(&s);

    // Two cells in opposite corners: only the last level ties them; a = D + k/2, b = -k/2.
    mask[777 * 1024 + 333] = 0;
    mask[0] = mask[1024 * 1024 - 1] = 1;
    s = scene_of(domain_of(1024, 1024, mask), 3, 1, 1);
    s.k[9] = 4;
    s.k[0] = NAN; // bands that tie nothing are not read
    s.d[0] = -0.5, s.d[1] = 3;
    assert_true(lac_hierarchy_solve(s.h, s.k, 0, s.d, s.y, s.x, s.work));
    double a = 1.5, b = -2, c = 5, determinant = a * c - b * b;
    assert_true(fabs(s.x[0] - (c * s.y[0] - b * s.y[1]) / determinant) < 1e-15);
    assert_true(fabs(s.x[1] - (a * s.y[1] - b * s.y[0]) / determinant) < 1e-15);
    scene_free(&s);
    free(mask);
}

// Cells 0 and 1 of a line share a block, cell 2 has one of its own: k_0 does not tie it, so its
// D + k_0 < 0 is no reason to refuse a matrix that k_1 makes positive definite.
static void lone_cells_are_not_tied(void **state)
{
    (void)state;
    scene s = scene_of(domain_of(4, 1, (const uint8_t[]){1, 1, 1, 0}), 3, 1, 1);
    s.k[0] = 1, s.k[1] = 40;
    s.d[0] = s.d[1] = 10, s.d[2] = -5;
    long double dense[9], x[3] = {s.y[0], s.y[1], s.y[2]};
    dense_hierarchy(s.domain, 2, s.k, dense);
    for (size_t i = 0; i < 3; i++) {
        dense[4 * i] += s.d[i];
    }
    long double copy[9];
    memcpy(copy, dense, sizeof dense);
    assert_true(dense_positive(3, copy));
    assert_true(lac_hierarchy_solve(s.h, s.k, 0, s.d, s.y, s.x, s.work));
    dense_solve(3, dense, x);
    for (size_t i = 0; i < 3; i++) {
        assert_true(fabs(s.x[i] - (double)x[i]) < 1e-15);
    }
    scene_free(&s);
}

static void small_and_full_grids(void **state)
{
    (void)state;
    const size_t shapes[][3] = {{1, 1, 0}, {2, 1, 1}, {1, 2, 1},   {2, 2, 1},
                                {4, 1, 2}, {3, 3, 2}, {128, 1, 7}, {64, 64, 6}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        scene s = scene_of(domain_of(shapes[i][0], shapes[i][1], NULL), i, 0.1, 10);
        assert_int_equal(s.levels, shapes[i][2]);
        double balance, inverse;
        residuals(&s, 0.2, &balance, &inverse);
        assert_true(balance <= 1e-14 && inverse < 1e-13);
        // Uniform slip costs nothing.
        double size = 0;
        for (size_t j = 0; j < s.n; j++) {
            s.y[j] = 0.7;
        }
        lac_hierarchy_apply(s.h, s.k, s.y, s.x, s.work);
        for (size_t j = 0; j < s.n; j++) {
            size = fmax(size, fabs(s.x[j]));
        }
        assert_true(size < 1e-14);
        scene_free(&s);
    }
    lac_hierarchy_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_are_those_of_the_grid),
        cmocka_unit_test(project_is_the_block_mean),
        cmocka_unit_test(apply_agrees_with_the_dense_matrix),
        cmocka_unit_test(solve_agrees_with_the_dense_matrix),
        cmocka_unit_test(forces_balance_whatever_the_stiffness),
        cmocka_unit_test(solve_inverts_apply_on_a_million_cells),
        cmocka_unit_test(indefinite_matrices_are_refused),
        cmocka_unit_test(bad_diagonals_are_refused),
        cmocka_unit_test(extreme_diagonals_are_solved),
        cmocka_unit_test(one_cell_in_a_large_grid),
        cmocka_unit_test(lone_cells_are_not_tied),
        cmocka_unit_test(small_and_full_grids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
