// SPDX-License-Identifier: GPL-3.0-or-later
// The critical force on contacts that are solved for it, against contacts solved from nothing and
// against an ever denser series.

#include <math.h>
#include <stdlib.h>

#include "rg/rg.h"
#include "support/test.h"
#include "support/trees.h"
#include "surface/surface.h"

enum { SIDE = 64, CELLS = SIDE * SIDE };
static const double friction = 0.6;

typedef struct joint {
    lac_contact_def contact;
    double *heights, *pressure, *drop;
    lac_domain *domain;
    lac_hierarchy *h;
    lac_rg_tree *tree;
} joint;

static void joint_create(joint *j, int64_t seed, double beta)
{
    lac_error err = {""};
    lac_self_affine params = {.hurst = 0.8,
                              .rms_height = NAN,
                              .rms_slope = 1.0,
                              .rolloff = NAN,
                              .shortest = NAN,
                              .seed = seed,
                              .anisotropy = 1.0};
    const lac_model model = {&lac_surface_source_get(0)->info, &params};
    j->heights = new_doubles(CELLS);
    j->pressure = new_doubles(CELLS);
    j->contact = lac_contact_default();
    j->contact.grid = (lac_grid){SIDE, SIDE, 1.0 / SIDE, 1.0 / SIDE, true};
    j->contact.heights = j->heights;
    j->contact.e_star = 1.0;
    j->contact.mean_pressure = 0.05;
    assert_int_equal(lac_surface_generate(&model, &j->contact.grid, j->heights, NULL, &err),
                     LAC_OK);
    assert_int_equal(lac_contact_solve(&j->contact, j->pressure, NULL, NULL, &err), LAC_OK);
    assert_int_equal(lac_domain_create(&j->contact.grid, j->pressure, &j->domain, &err), LAC_OK);
    j->h = hierarchy_of(j->domain);
    double *strength = new_doubles(j->domain->n);
    j->drop = new_doubles(j->domain->n);
    for (size_t i = 0; i < j->domain->n; i++) {
        strength[i] = friction * j->domain->pressure[i];
        j->drop[i] = (1.0 - beta) * strength[i];
    }
    assert_int_equal(lac_rg_tree_create(j->h, strength, j->drop, &j->tree, &err), LAC_OK);
    free(strength);
}

static void joint_clear(joint *j)
{
    lac_rg_tree_free(j->tree);
    lac_hierarchy_free(j->h);
    lac_domain_free(j->domain);
    free(j->drop);
    free(j->pressure);
    free(j->heights);
}

static lac_rg_path *path_of(const joint *j, size_t loads)
{
    lac_error err = {""};
    lac_rg_path *path = NULL;
    double part[LAC_RG_MOST_LOADS];
    double *pressure = new_doubles(loads * j->domain->n);
    lac_rg_loads(loads, part);
    assert_int_equal(lac_rg_series_solve(&j->contact, j->domain, loads, pressure, &err), LAC_OK);
    const lac_rg_series series = {j->domain->n, loads, part, pressure, friction};
    assert_int_equal(lac_rg_path_elastic(&series, &path, &err), LAC_OK);
    free(pressure);
    return path;
}

// Whether the joint slides at a load, by a contact that is solved from nothing.
static bool slides(const joint *j, lac_rg_rule rule, double load)
{
    lac_error err = {""};
    lac_contact_def def = j->contact;
    double *map = new_doubles(CELLS);
    double *shear = new_doubles(2 * j->domain->n);
    double *gap = shear + j->domain->n;
    def.mean_pressure *= 1.0 - load;
    assert_int_equal(lac_contact_solve(&def, map, NULL, NULL, &err), LAC_OK);
    for (size_t i = 0; i < j->domain->n; i++) {
        gap[i] = friction * map[j->domain->index[i]];
        shear[i] = friction * j->domain->pressure[i] - gap[i];
    }
    bool yes = lac_rg_slips(j->tree, lac_rg_pass(j->tree, rule, shear, gap));
    free(shear);
    free(map);
    return yes;
}

static void test_solved_contacts_bracket_the_critical_force(void **state)
{
    (void)state;
    for (int64_t seed = 1; seed <= 3; seed++) {
        joint j;
        joint_create(&j, seed, 0.5 + 0.1 * (double)seed);
        double *work = new_doubles(2 * j.domain->n);
        lac_rg_path *path = path_of(&j, LAC_RG_LOADS);
        const lac_rg_resolve_def press = {&j.contact, j.domain, friction};
        for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
            lac_error err = {""};
            double critical = NAN;
            assert_int_equal(lac_rg_critical_solved(j.tree, rule, &press, path, &critical, &err),
                             LAC_OK);
            assert_false(slides(&j, rule, critical - 3e-6));
            assert_true(slides(&j, rule, critical + 2e-6));
            assert_true(fabs(critical - lac_rg_critical(j.tree, rule, path, work)) < 0.05);
        }
        lac_rg_path_free(path);
        free(work);
        joint_clear(&j);
    }
}

// Straight lines between contacts miss by the square of their distance.
static void test_a_dense_series_comes_to_the_same(void **state)
{
    (void)state;
    joint j;
    joint_create(&j, 1, 0.7);
    double *work = new_doubles(2 * j.domain->n);
    const lac_rg_resolve_def press = {&j.contact, j.domain, friction};
    lac_rg_path *path = path_of(&j, LAC_RG_MOST_LOADS);
    for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_CONS; rule++) {
        lac_error err = {""};
        double critical = NAN;
        assert_int_equal(lac_rg_critical_solved(j.tree, rule, &press, path, &critical, &err),
                         LAC_OK);
        double dense = lac_rg_critical(j.tree, rule, path, work);
        if (fabs(dense - critical) > 2e-4) {
            fail_msg("%.8g, from 500 contacts %.8g", critical, dense);
        }
    }
    lac_rg_path_free(path);
    free(work);
    joint_clear(&j);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solved_contacts_bracket_the_critical_force),
        cmocka_unit_test(test_a_dense_series_comes_to_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
