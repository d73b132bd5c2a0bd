// SPDX-License-Identifier: GPL-3.0-or-later
// Ensembles of cascades: what must hold whatever the joints, and joints whose answer is known.

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "rg/rg_study.h"
#include "support/test.h"
#include "support/trees.h"

enum { SIDE = 32, CELLS = SIDE * SIDE };

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

static lac_domain *random_pressures(uint64_t seed, bool periodic, double filling, bool uniform)
{
    lac_grid grid = {SIDE, SIDE, 0.5, 0.5, periodic};
    double *pressure = new_doubles(CELLS);
    lac_domain *domain = NULL;
    lac_error err = {""};
    for (size_t i = 0; i < CELLS; i++) {
        bool touches = draw_uniform(seed, i, 0, 1) < filling;
        double p = uniform ? 2.0 : draw_log(seed, CELLS + i, 0.1, 10);
        pressure[i] = touches ? p : 0.0;
    }
    assert_int_equal(lac_domain_create(&grid, pressure, &domain, &err), LAC_OK);
    free(pressure);
    return domain;
}

static void add(lac_rg_study *study, const lac_domain *domain, double beta)
{
    lac_error err = {""};
    lac_rg_path *path = NULL;
    double *drop = new_doubles(domain->n);
    for (size_t i = 0; i < domain->n; i++) {
        drop[i] = (1.0 - beta) * domain->pressure[i];
    }
    assert_int_equal(lac_rg_path_further(domain->n, domain->pressure, NULL, &path, &err), LAC_OK);
    lac_rg_joint joint = {domain, domain->pressure, drop, path, NULL};
    assert_int_equal(lac_rg_study_add(study, &joint, &err), LAC_OK);
    lac_rg_path_free(path);
    free(drop);
}

static const lac_rg_result *study_of(lac_rg_study **study, const lac_rg_study_def *def,
                                     size_t joints, bool periodic, bool uniform)
{
    lac_error err = {""};
    const lac_rg_result *r = NULL;
    assert_int_equal(lac_rg_study_create(def, study, &err), LAC_OK);
    for (size_t j = 0; j < joints; j++) {
        lac_domain *domain = random_pressures(j, periodic, 0.4, uniform);
        add(*study, domain, 0.7);
        lac_domain_free(domain);
    }
    assert_int_equal(lac_rg_study_finish(*study, &r, &err), LAC_OK);
    return r;
}

static void test_uniform_joint(void **state)
{
    (void)state;
    lac_rg_study *study = NULL;
    lac_rg_study_def def = lac_rg_study_default();
    const lac_rg_result *r = study_of(&study, &def, 1, true, true);
    assert_near(r->critical, 1.0, 1e-9);
    assert_near(r->critical_sd, 0.0, 1e-9);
    assert_int_equal(r->fit.map.points, 0);
    assert_true(isnan(r->fit.fixed_point.value) && isnan(r->fit.fixed_point.error));
    assert_false(r->cluster_law.holds);
    for (size_t i = 0; i + 1 < r->loads; i++) {
        assert_near(r->cluster[i] + r->block[i], 0.0, 0.0);
    }
    assert_near(r->cluster[r->loads - 1], SIDE * 0.5, 0.0);
    assert_near(r->block[r->loads - 1], SIDE * 0.5, 0.0);
    lac_rg_study_free(study);
}

static void check_curve(const lac_rg_result *r)
{
    const size_t levels = r->levels + 1;
    for (size_t level = 0; level < levels; level++) {
        for (size_t i = 0; i < r->loads; i++) {
            double s = r->fraction[i * levels + level];
            assert_true(s >= 0.0 && s <= 1.0 + 1e-12);
            // more load, more slip: equal stresses only grow
            assert_true(i == 0 || s >= r->fraction[(i - 1) * levels + level] - 1e-12);
        }
        assert_near(r->fraction[(r->loads - 1) * levels + level], 1.0, 1e-12);
    }
}

static void test_ensemble(void **state)
{
    (void)state;
    lac_rg_study *study = NULL;
    lac_rg_study_def def = lac_rg_study_default();
    def.places = 4;
    const lac_rg_result *r = study_of(&study, &def, 12, true, false);
    assert_int_equal(r->levels, 5);
    assert_true(r->critical > 0.3 && r->critical < 1.0);
    assert_near(r->critical_error, r->critical_sd / sqrt(12.0), 1e-15);
    assert_true(r->place_sd > 0.0);
    check_curve(r);
    assert_true(r->fit.map.points > 30);
    assert_near(r->fit.map.fixed_point, r->fit.fixed_point.value, 0.0);
    assert_true(r->fit.lambda.low < r->fit.lambda.value &&
                r->fit.lambda.value < r->fit.lambda.high);
    assert_true(r->fit.lambda.error > 0.0 && r->fit.lambda.error < 0.2);
    double n = 0.0;
    for (size_t i = 0; i < r->last_n; i++) {
        n += isfinite(r->cell_load[i]) ? 1.0 : 0.0;
    }
    assert_near(n, (double)r->last_n, 0.0);
    lac_rg_study_free(study);
}

// The same numbers, to the bit, by one thread and by three.
static void test_threads_do_not_matter(void **state)
{
    (void)state;
    lac_rg_study *one = NULL;
    lac_rg_study *three = NULL;
    lac_rg_study_def def = lac_rg_study_default();
    def.rule = LAC_RG_CONS;
    const int before = omp_get_max_threads();
    omp_set_num_threads(1);
    const lac_rg_result *a = study_of(&one, &def, 2, false, false);
    omp_set_num_threads(3);
    const lac_rg_result *b = study_of(&three, &def, 2, false, false);
    omp_set_num_threads(before);
    assert_int_equal(a->levels, 6); // not periodic: a level more
    assert_memory_equal(&a->critical, &b->critical, sizeof a->critical);
    assert_memory_equal(&a->fit.map, &b->fit.map, sizeof a->fit.map);
    assert_memory_equal(&a->fit.nu, &b->fit.nu, sizeof a->fit.nu);
    assert_memory_equal(a->fraction, b->fraction, a->loads * 7 * sizeof *a->fraction);
    assert_memory_equal(a->cell_load, b->cell_load, a->last_n * sizeof *a->cell_load);
    lac_rg_study_free(one);
    lac_rg_study_free(three);
}

static void test_lump_on_full_independent_trees(void **state)
{
    (void)state;
    lac_rg_study *study = NULL;
    lac_rg_study_def def = lac_rg_study_default();
    def.rule = LAC_RG_LUMP;
    def.places = 2;
    const lac_rg_result *r = study_of(&study, &def, 6, true, false);
    assert_true(r->fit.lambda.value > 1.0);
    assert_true(r->fit.fixed_point.value > 0.0 && r->fit.fixed_point.value < 1.0);
    check_curve(r);
    lac_rg_study_free(study);
}

static void test_what_cannot_be_is_refused(void **state)
{
    (void)state;
    lac_rg_study *study = NULL;
    const lac_rg_result *r = NULL;
    lac_error err = {""};
    lac_rg_study_def def = lac_rg_study_default();
    def.places = 0;
    assert_int_equal(lac_rg_study_create(&def, &study, &err), LAC_EINPUT);
    assert_null(study);
    def = lac_rg_study_default();
    def.loads = 9;
    assert_int_equal(lac_rg_study_create(&def, &study, &err), LAC_EINPUT);
    def = lac_rg_study_default();
    assert_int_equal(lac_rg_study_create(&def, &study, &err), LAC_OK);
    assert_int_equal(lac_rg_study_finish(study, &r, &err), LAC_EINPUT);
    lac_domain *large = random_pressures(1, true, 0.4, false);
    lac_domain *small = domain_of(4, 4, NULL);
    lac_rg_path *path = NULL;
    add(study, large, 0.7);
    assert_int_equal(lac_rg_path_further(small->n, small->pressure, NULL, &path, &err), LAC_OK);
    lac_rg_joint joint = {small, small->pressure, small->pressure, path, NULL};
    assert_int_equal(lac_rg_study_add(study, &joint, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_study_finish(study, &r, &err), LAC_OK);
    assert_int_equal(r->joints, 1);
    lac_rg_path_free(path);
    lac_domain_free(small);
    lac_domain_free(large);
    lac_rg_study_free(study);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uniform_joint),
        cmocka_unit_test(test_ensemble),
        cmocka_unit_test(test_threads_do_not_matter),
        cmocka_unit_test(test_lump_on_full_independent_trees),
        cmocka_unit_test(test_what_cannot_be_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
