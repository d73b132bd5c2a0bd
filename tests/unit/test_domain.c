// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/contact.h"
#include "support/test.h"

static void morton_interleaves_bits(void **state)
{
    (void)state;
    assert_int_equal(lac_morton(0, 0), 0);
    assert_int_equal(lac_morton(1, 0), 1);
    assert_int_equal(lac_morton(0, 1), 2);
    assert_int_equal(lac_morton(5, 3), 27); // 101, 011 -> 011011
    assert_true(lac_morton(UINT32_MAX, UINT32_MAX) == UINT64_MAX);
    assert_true(lac_morton(UINT32_MAX, 0) == UINT64_C(0x5555555555555555));
}

// 3 x 2 cells; numbers are the order in which they are collected:   2 3 5
// (row iy = 1 on top)                                               0 1 4
static void cells_come_in_morton_order(void **state)
{
    (void)state;
    const double pressure[] = {1, 2, 3, 4, 5, 6};
    lac_grid grid = {3, 2, 1, 1, true};
    lac_domain *domain = NULL;
    assert_int_equal(lac_domain_create(&grid, pressure, &domain, NULL), LAC_OK);
    const uint32_t index[] = {0, 1, 3, 4, 2, 5};
    assert_int_equal(domain->n, 6);
    assert_memory_equal(domain->index, index, sizeof index);
    for (size_t i = 0; i < 6; i++) {
        assert_true(domain->pressure[i] == pressure[index[i]]);
    }
    lac_domain_free(domain);
    lac_domain_free(NULL);
}

static void only_cells_in_contact_are_kept(void **state)
{
    (void)state;
    const double pressure[] = {0, 2, -0.0, 0, 0, 6};
    lac_grid grid = {6, 1, 1, 2, false};
    lac_domain *domain = NULL;
    assert_int_equal(lac_domain_create(&grid, pressure, &domain, NULL), LAC_OK);
    assert_int_equal(domain->n, 2);
    assert_int_equal(domain->index[0], 1);
    assert_int_equal(domain->index[1], 5);
    assert_true(domain->pressure[1] == 6 && domain->grid.dy == 2);
    lac_domain_free(domain);
}

static void refuse(const lac_grid *grid, const double *pressure, const char *says)
{
    lac_domain *domain = (lac_domain *)&domain;
    lac_error err = {""};
    assert_int_equal(lac_domain_create(grid, pressure, &domain, &err), LAC_EINPUT);
    assert_null(domain);
    if (strstr(err.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", err.message, says);
    }
}

static void bad_input_is_refused(void **state)
{
    (void)state;
    lac_grid grid = {2, 2, 1, 1, true};
    refuse(&grid, (double[]){0, 0, 0, 0}, "no cell is in contact");
    refuse(&grid, (double[]){1, 0, NAN, 0}, "cell (0, 1)");
    refuse(&grid, (double[]){1, INFINITY, 0, 0}, "cell (1, 0)");
    refuse(&grid, (double[]){1, 0, 0, -1}, "-1 Pa");
    refuse(&(lac_grid){0, 2, 1, 1, true}, NULL, "0 x 2");
    const double nothing = NAN; // of cells that can be counted the first is looked at
    refuse(&(lac_grid){1 << 15, 1 << 16, 1, 1, true}, &nothing, "cell (0, 0)");
    refuse(&(lac_grid){2, INT32_MAX, 1, 1, true}, &nothing, "cell (0, 0)");   // 2^32 - 2
    refuse(&(lac_grid){UINT16_MAX, (1 << 16) + 1, 1, 1, true}, NULL, "2^32"); // less one
    refuse(&(lac_grid){1 << 16, 1 << 16, 1, 1, true}, NULL, "2^32");
    refuse(&(lac_grid){641, 6700417, 1, 1, true}, NULL, "2^32"); // and one
    refuse(&(lac_grid){SIZE_MAX, 2, 1, 1, true}, NULL, "2^32");
    refuse(&(lac_grid){1, 1, NAN, 1, true}, (double[]){1}, "must be > 0");
    refuse(&(lac_grid){1, 1, 1, 0, true}, (double[]){1}, "must be > 0");
}

static const lac_domain_source *source(const char *name)
{
    for (size_t i = 0; lac_domain_source_get(i) != NULL; i++) {
        if (strcmp(lac_domain_source_get(i)->info.name, name) == 0) {
            return lac_domain_source_get(i);
        }
    }
    fail_msg("no domain source %s", name);
    return NULL;
}

static lac_domain *make(const char *name, lac_cascade cascade, lac_grid grid)
{
    lac_model model = {&source(name)->info, &cascade};
    lac_domain *domain = NULL;
    lac_error err = {""};
    if (lac_domain_from_source(&model, &grid, 3e6, &domain, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return domain;
}

static void load_is_spread_equally(void **state)
{
    (void)state;
    lac_domain *domain = make("full", (lac_cascade){0}, (lac_grid){5, 3, 2, 1, true});
    assert_int_equal(domain->n, 15);
    assert_true(domain->pressure[14] == 3e6);
    lac_domain_free(domain);

    domain = make("cascade", (lac_cascade){1.5, 9}, (lac_grid){64, 64, 2, 1, true});
    assert_true(domain->n < 64 * 64);
    double sum = 0;
    for (size_t i = 0; i < domain->n; i++) {
        assert_true(domain->pressure[i] == domain->pressure[0]);
        sum += domain->pressure[i];
    }
    assert_true(fabs(sum / (64 * 64) / 3e6 - 1) < 1e-12);
    lac_domain_free(domain);
}

// The mean number of cells is (2^D)^levels: every block keeps 2^D of its children on average.
static void check_dimension(double dimension, lac_grid grid, int levels)
{
    const int seeds = 600;
    double sum = 0, squares = 0;
    for (int seed = 0; seed < seeds; seed++) {
        lac_domain *domain = make("cascade", (lac_cascade){dimension, seed}, grid);
        sum += (double)domain->n;
        squares += (double)domain->n * (double)domain->n;
        lac_domain_free(domain);
    }
    double mean = sum / seeds;
    double error = sqrt((squares / seeds - mean * mean) / seeds);
    print_message("D %.2f: mean number of cells %.3f +- %.3f, expected %.3f\n", dimension, mean,
                  error, exp2(dimension * levels));
    assert_true(fabs(mean - exp2(dimension * levels)) <= 4 * error);
}

static void cascade_has_its_dimension(void **state)
{
    (void)state;
    const double dimensions[] = {0.1, 0.5, 1, 1.5, 1.8, 2};
    for (size_t i = 0; i < 6; i++) {
        check_dimension(dimensions[i], (lac_grid){32, 32, 1, 1, true}, 5);
    }
    check_dimension(0.3, (lac_grid){256, 1, 1, 1, true}, 8);
    check_dimension(0.8, (lac_grid){256, 1, 1, 1, true}, 8);
    check_dimension(1, (lac_grid){256, 1, 1, 1, true}, 8);
}

// Cells of the fine domain, seen at the coarse grid's resolution, are the coarse domain.
static void check_nested(lac_cascade cascade, lac_grid coarse, lac_grid fine)
{
    lac_domain *a = make("cascade", cascade, coarse);
    lac_domain *b = make("cascade", cascade, fine);
    uint8_t observation[1024] = {0};
    size_t distinct = 0;
    for (size_t i = 0; i < b->n; i++) {
        size_t x = b->index[i] % fine.nx / (fine.nx / coarse.nx);
        size_t y = b->index[i] / fine.nx / (fine.ny / coarse.ny);
        distinct += observation[y * coarse.nx + x] == 0;
        observation[y * coarse.nx + x] = 1;
    }
    assert_int_equal(distinct, a->n);
    for (size_t i = 0; i < a->n; i++) {
        assert_int_equal(observation[a->index[i]], 1);
    }
    lac_domain_free(a);
    lac_domain_free(b);
}

static void cascade_is_the_same_at_every_resolution(void **state)
{
    (void)state;
    for (int seed = 0; seed < 20; seed++) {
        check_nested((lac_cascade){1.4, seed}, (lac_grid){16, 16, 1, 1, true},
                     (lac_grid){128, 128, 1, 1, true});
        check_nested((lac_cascade){0.7, seed}, (lac_grid){20, 12, 1, 1, true},
                     (lac_grid){80, 48, 1, 1, true});
        check_nested((lac_cascade){0.7, seed}, (lac_grid){64, 1, 1, 1, true},
                     (lac_grid){1024, 1, 1, 1, true});
    }
}

static void seeds_give_different_domains(void **state)
{
    (void)state;
    lac_grid grid = {64, 64, 1, 1, true};
    lac_domain *a = make("cascade", (lac_cascade){1.5, 1}, grid);
    lac_domain *b = make("cascade", (lac_cascade){1.5, 2}, grid);
    lac_domain *c = make("cascade", (lac_cascade){1.5, 1}, grid);
    assert_true(a->n != b->n || memcmp(a->index, b->index, a->n * sizeof *a->index) != 0);
    assert_int_equal(a->n, c->n);
    assert_memory_equal(a->index, c->index, a->n * sizeof *a->index);
    lac_domain_free(a);
    lac_domain_free(b);
    lac_domain_free(c);
}

static void refuse_source(const lac_model_info *info, lac_cascade cascade, lac_grid grid,
                          double pressure, const char *says)
{
    lac_model model = {info, &cascade};
    lac_domain *domain = NULL;
    lac_error err = {""};
    assert_int_equal(lac_domain_from_source(&model, &grid, pressure, &domain, &err), LAC_EINPUT);
    assert_null(domain);
    if (strstr(err.message, says) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", err.message, says);
    }
}

static void bad_sources_are_refused(void **state)
{
    (void)state;
    const lac_model_info *info = &source("cascade")->info;
    lac_grid plane = {8, 8, 1, 1, true}, line = {8, 1, 1, 1, true};
    refuse_source(info, (lac_cascade){0, 1}, plane, 1, "must be > 0");
    refuse_source(info, (lac_cascade){2.01, 1}, plane, 1, "<= 2");
    refuse_source(info, (lac_cascade){NAN, 1}, plane, 1, "must be > 0");
    refuse_source(info, (lac_cascade){1.5, 1}, line, 1, "on a line");
    refuse_source(info, (lac_cascade){1.5, 1}, plane, NAN, "mean pressure");
    refuse_source(info, (lac_cascade){1.5, 1}, plane, 0, "mean pressure");
    refuse_source(info, (lac_cascade){1.5, 1}, (lac_grid){0, 8, 1, 1, true}, 1, "0 x 8");
    refuse_source(NULL, (lac_cascade){1.5, 1}, plane, 1, "no contact domain");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(morton_interleaves_bits),
        cmocka_unit_test(cells_come_in_morton_order),
        cmocka_unit_test(only_cells_in_contact_are_kept),
        cmocka_unit_test(bad_input_is_refused),
        cmocka_unit_test(load_is_spread_equally),
        cmocka_unit_test(cascade_has_its_dimension),
        cmocka_unit_test(cascade_is_the_same_at_every_resolution),
        cmocka_unit_test(seeds_give_different_domains),
        cmocka_unit_test(bad_sources_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
