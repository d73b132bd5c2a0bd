// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "fractal/fractal.h"
#include "support/benchmark_surface.h"
#include "support/sets.h"
#include "support/test.h"

enum { CELLS = 1024 * 1024 };

static int set_up(void **state)
{
    *state = calloc(CELLS, 1);
    return *state == NULL ? -1 : 0;
}

static int tear_down(void **state)
{
    free(*state);
    return 0;
}

static lac_grid grid_of(size_t nx, size_t ny, bool periodic)
{
    return (lac_grid){nx, ny, 1.0, 1.0, periodic};
}

static lac_box_count dimension_of(lac_grid grid, const uint8_t *occupied, lac_box_def def)
{
    lac_box_count result;
    lac_error err = {""};
    lac_domain *domain = set_domain(&grid, occupied);
    assert_non_null(domain);
    lac_status status = lac_box_dimension(domain, &def, &result, &err);
    set_domain_free(domain);
    if (status != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return result;
}

static void full_square_has_dimension_two(void **state)
{
    uint8_t *occupied = *state;
    memset(occupied, 1, 256 * 256);
    lac_box_count r = dimension_of(grid_of(256, 256, true), occupied, lac_box_default());
    assert_true(fabs(r.dimension - 2.0) < 1e-12);
    assert_true(r.error < 1e-6);
    assert_true(r.dense && !r.few_cells);
    assert_int_equal(r.sizes, 9);
    assert_int_equal(r.fit_first, 1);
    assert_int_equal(r.fit_last, 5);
    for (size_t j = 0; j < r.sizes; j++) {
        assert_true(r.side[j] == exp2((double)j));
        assert_true(r.count[j] == r.minimum[j]);
        assert_true(fabs(r.count[j] - exp2(16.0 - 2.0 * (double)j)) < 1e-9);
        assert_true(j + 1 == r.sizes || fabs(r.slope[j] + 2.0) < 1e-12);
    }
}

// Boxes stick out over a free edge: the dimension is 2 within an error that admits it.
static void free_square_is_two_within_its_error(void **state)
{
    uint8_t *occupied = *state;
    memset(occupied, 1, 300 * 300);
    lac_box_count r = dimension_of(grid_of(300, 300, false), occupied, lac_box_default());
    print_message("free square %.4f +- %.4f\n", r.dimension, r.error);
    assert_true(fabs(r.dimension - 2.0) < 2.0 * r.error);
    assert_true(r.error > 0.005 && r.error < 0.15);
}

static void line_of_cells_has_dimension_one(void **state)
{
    uint8_t *occupied = *state;
    memset(&occupied[100 * 512], 1, 512);
    lac_box_count r = dimension_of(grid_of(512, 512, true), occupied, lac_box_default());
    assert_true(fabs(r.dimension - 1.0) < 1e-12);
    assert_true(!r.dense && !r.few_cells);
    memset(occupied, 1, 4096);
    r = dimension_of(grid_of(4096, 1, true), occupied, lac_box_default());
    assert_true(fabs(r.dimension - 1.0) < 1e-12);
    r = dimension_of(grid_of(1, 4096, true), occupied, lac_box_default());
    assert_true(fabs(r.dimension - 1.0) < 1e-12);
}

// A free line has two ends and no sides, whichever way it runs.
static void free_line_is_one_within_its_error(void **state)
{
    uint8_t *occupied = *state;
    memset(occupied, 1, 300);
    for (int along_y = 0; along_y < 2; along_y++) {
        lac_grid grid = along_y ? grid_of(1, 300, false) : grid_of(300, 1, false);
        lac_box_count r = dimension_of(grid, occupied, lac_box_default());
        print_message("free line %.4f +- %.4f\n", r.dimension, r.error);
        assert_true(fabs(r.dimension - 1.0) < 2.0 * r.error);
        assert_true(r.error < 0.15);
    }
}

static void single_cell_has_dimension_zero(void **state)
{
    uint8_t *occupied = *state;
    occupied[77] = 1;
    lac_box_count r = dimension_of(grid_of(64, 64, true), occupied, lac_box_default());
    assert_true(r.dimension == 0.0);
    assert_true(r.few_cells);
}

// How often the stated interval, two errors to either side, holds the exact dimension.
typedef struct coverage {
    size_t sets, held;
    double mean, error;
} coverage;

static void add(coverage *c, const lac_box_count *r, double exact)
{
    c->sets++;
    c->held += fabs(r->dimension - exact) <= 2.0 * r->error;
    c->mean += r->dimension;
    c->error += r->error;
}

static void expect_held(const char *set, coverage c, double exact, double widest)
{
    double mean = c.mean / (double)c.sets;
    double error = c.error / (double)c.sets;
    print_message("%s: %.3f +- %.3f (%.3f), held %zu of %zu\n", set, mean, error, exact, c.held,
                  c.sets);
    assert_true(c.sets >= 150);
    assert_true(10 * c.held >= 9 * c.sets);
    assert_true(fabs(mean - exact) < 0.1);
    assert_true(error < widest);
}

// Boxes of 2^j cells on a set of threes, from 200 sets of origins.
static void carpets(void **state)
{
    uint8_t *occupied = *state;
    const double exact = log(8.0) / log(3.0);
    const size_t depth[] = {5, 5, 6};
    const size_t side[] = {243, 243, 729};
    for (size_t k = 0; k < 3; k++) {
        coverage c = {0};
        lac_box_def def = lac_box_default();
        set_carpet(depth[k], occupied);
        for (def.seed = 1; def.seed <= 200; def.seed++) {
            lac_box_count r = dimension_of(grid_of(side[k], side[k], k == 0), occupied, def);
            add(&c, &r, exact);
        }
        expect_held(k == 0 ? "carpet, periodic" : "carpet, free", c, exact, 0.07);
    }
}

static void fill_from_source(lac_grid grid, double dimension, int64_t seed, uint8_t *occupied)
{
    const lac_domain_source *source = lac_domain_source_get(1);
    lac_cascade params = {.dimension = dimension, .seed = seed};
    assert_string_equal(source->info.name, "cascade");
    assert_int_equal(source->fill(&params, &grid, occupied, NULL), LAC_OK);
}

// Cascades of 200 seeds, those that may die (a kind of their own) and those of the domain source.
static void random_cascades(void **state)
{
    uint8_t *occupied = *state;
    const double dimensions[] = {1.3, 1.6, 1.8};
    const lac_grid grid = grid_of(256, 256, true);
    for (size_t k = 0; k < 6; k++) {
        coverage c = {0};
        double exact = dimensions[k % 3];
        for (uint64_t seed = 1; seed <= 200; seed++) {
            if (k < 3) {
                fill_from_source(grid, exact, (int64_t)seed, occupied);
            } else {
                set_cascade(8, exact, seed, occupied);
                occupied[0] |= memchr(occupied, 1, 256 * 256) == NULL; // it died
            }
            lac_box_count r = dimension_of(grid, occupied, lac_box_default());
            if (!r.few_cells) {
                add(&c, &r, exact);
            }
        }
        expect_held(k < 3 ? "cascade of the source" : "cascade that may die", c, exact, 0.15);
    }
}

// Contact of the joint-like benchmark surface J07_1024 at 1e-2 E*: 1.481 over sides 2 ... 32 by
// another code (and other origins).
static void rough_contact(void **state)
{
    uint8_t *occupied = *state;
    double *h = malloc(2 * CELLS * sizeof *h);
    assert_non_null(h);
    double *p = h + CELLS;
    lac_error err = {""};
    lac_contact_stats report;
    lac_contact_def def = lac_contact_default();
    assert_int_equal(joint_surface(1024, h), 0);
    def.grid = (lac_grid){1024, 1024, 1.0 / 1024.0, 1.0 / 1024.0, true};
    def.heights = h;
    def.e_star = 1.0;
    def.mean_pressure = 1e-2;
    assert_int_equal(lac_contact_solve(&def, p, NULL, &report, &err), LAC_OK);
    for (size_t i = 0; i < CELLS; i++) {
        occupied[i] = p[i] > 0.0;
    }
    free(h);
    lac_box_count r = dimension_of(
        def.grid, occupied, (lac_box_def){.smallest = 2, .largest = 32, .origins = 16, .seed = 1});
    print_message("J07 1024^2: contact fraction %.6f (0.046990), D_box %.4f +- %.4f (1.481)\n",
                  (double)report.n_cells / CELLS, r.dimension, r.error);
    assert_true(fabs((double)report.n_cells / CELLS - 0.046990) < 2e-6);
    assert_true(fabs(r.dimension - 1.481) < 0.01);
    assert_true(fabs(r.dimension - 1.481) < r.error);
    assert_true(fabs(r.regression_error - 0.005) < 1e-3);
}

static void range_and_seed_are_obeyed(void **state)
{
    uint8_t *occupied = *state;
    set_cascade(8, 1.6, 3, occupied);
    lac_box_def def = {.smallest = 4, .largest = 64, .origins = 20, .seed = 9};
    lac_box_count a = dimension_of(grid_of(256, 256, true), occupied, def);
    lac_box_count b = dimension_of(grid_of(256, 256, true), occupied, def);
    assert_int_equal(a.fit_first, 2);
    assert_int_equal(a.fit_last, 6);
    assert_true(a.dimension == b.dimension && a.error == b.error);
    def.seed = 10;
    b = dimension_of(grid_of(256, 256, true), occupied, def);
    assert_true(a.dimension != b.dimension);
    assert_true(fabs(a.dimension - b.dimension) < 2.0 * a.error);
    for (size_t j = 0; j < a.sizes; j++) {
        assert_true(a.minimum[j] <= a.count[j]);
    }
}

// Moving a periodic set changes nothing but the luck of the origins.
static void counts_of_the_whole_grid_wrap(void **state)
{
    uint8_t *occupied = *state;
    for (size_t i = 0; i < 64; i++) { // a square of 8 x 8 across the corner
        occupied[(i / 8 + 60) % 64 * 64 + (i % 8 + 60) % 64] = 1;
    }
    lac_box_def def = lac_box_default();
    def.origins = 4000;
    lac_box_count r = dimension_of(grid_of(64, 64, true), occupied, def);
    // A random origin cuts a side of 8 cells into 1 + 7/s boxes of side s on average.
    for (size_t j = 0; j < 6; j++) {
        double cuts = 1.0 + 7.0 / r.side[j];
        assert_true(fabs(r.count[j] / (cuts * cuts) - 1.0) < 0.05);
    }
    assert_true(r.minimum[3] == 1.0);
}

static void refuse(lac_grid grid, const uint8_t *occupied, lac_box_def def, const char *word)
{
    lac_box_count result;
    lac_error err = {""};
    lac_domain *domain = set_domain(&grid, occupied);
    assert_non_null(domain);
    lac_status status = lac_box_dimension(domain, &def, &result, &err);
    set_domain_free(domain);
    assert_int_equal(status, LAC_EINPUT);
    assert_non_null(strstr(err.message, word));
}

static void what_cannot_be_measured_is_refused(void **state)
{
    uint8_t *occupied = *state;
    lac_box_def def = lac_box_default();
    refuse(grid_of(8, 8, true), occupied, def, "no cell");
    memset(occupied, 1, 1024 * 8);
    refuse(grid_of(1, 1, true), occupied, def, "three");
    refuse(grid_of(3, 3, true), occupied, def, "three");
    refuse(grid_of(1024, 3, true), occupied, def, "three");
    refuse(grid_of(64, 64, true), occupied, (lac_box_def){3, 24, 16, 1}, "powers");
    refuse(grid_of(64, 64, true), occupied, (lac_box_def){2, 128, 16, 1}, "three");
    refuse(grid_of(64, 64, true), occupied, (lac_box_def){16, 2, 16, 1}, "three");
    refuse(grid_of(64, 64, true), occupied, (lac_box_def){2, 16, 0, 1}, "origin");
    for (size_t n = 4; n <= 70; n++) {
        lac_box_count r = dimension_of(grid_of(n, n, true), occupied, def);
        assert_true(isfinite(r.dimension) && isfinite(r.error));
        assert_true(n < 64 || r.fit_first == 1);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(full_square_has_dimension_two),
        TEST(free_square_is_two_within_its_error),
        TEST(line_of_cells_has_dimension_one),
        TEST(free_line_is_one_within_its_error),
        TEST(single_cell_has_dimension_zero),
        TEST(carpets),
        TEST(random_cascades),
        TEST(rough_contact),
        TEST(range_and_seed_are_obeyed),
        TEST(counts_of_the_whole_grid_wrap),
        TEST(what_cannot_be_measured_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
