// SPDX-License-Identifier: GPL-3.0-or-later
// Blocks laid elsewhere, and the strength of blocks as a function of their size.

#include <math.h>
#include <stdlib.h>

#include "rg/tree.h"
#include "support/test.h"
#include "support/trees.h"

enum { SIDE = 16, CELLS = SIDE * SIDE };

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

static lac_domain *random_pressures(uint64_t seed, bool periodic, double filling)
{
    lac_grid grid = {SIDE, SIDE, 1, 1, periodic};
    double pressure[CELLS];
    for (size_t i = 0; i < CELLS; i++) {
        bool touches = draw_uniform(seed, i, 0, 1) < filling;
        pressure[i] = touches || i == 0 ? draw_log(seed, CELLS + i, 0.1, 10) : 0.0;
    }
    lac_domain *domain = NULL;
    lac_error err = {""};
    assert_int_equal(lac_domain_create(&grid, pressure, &domain, &err), LAC_OK);
    return domain;
}

// The place of a cell whose blocks lie (dx, dy) further, on the grid of the moved domain.
static size_t place(const lac_domain *domain, size_t i, size_t dx, size_t dy, size_t side)
{
    size_t x = (domain->index[i] % SIDE + dx) % side;
    size_t y = (domain->index[i] / SIDE + dy) % side;
    return y * side + x;
}

// The same pressures on a grid where they are moved by hand, and who is who.
static lac_domain *moved_by_hand(const lac_domain *domain, size_t dx, size_t dy, uint32_t *cell)
{
    const size_t side = domain->grid.periodic ? SIDE : 2 * SIDE;
    lac_grid grid = {side, side, 1, 1, domain->grid.periodic};
    double *pressure = new_doubles(side * side);
    lac_domain *there = NULL;
    lac_error err = {""};
    for (size_t i = 0; i < domain->n; i++) {
        pressure[place(domain, i, dx, dy, side)] = domain->pressure[i];
    }
    assert_int_equal(lac_domain_create(&grid, pressure, &there, &err), LAC_OK);
    for (size_t i = 0; i < domain->n; i++) {
        for (size_t j = 0; j < there->n; j++) {
            if (there->index[j] == place(domain, i, dx, dy, side)) {
                cell[j] = (uint32_t)i;
            }
        }
    }
    free(pressure);
    return there;
}

static void settle(lac_rg_tree *tree, const double *shear, double *root, uint8_t *slipped,
                   double *stress)
{
    *root = lac_rg_pass(tree, LAC_RG_FIX, shear, NULL);
    lac_rg_resolve(tree, slipped, stress);
}

static void check_shift(const lac_domain *domain, size_t dx, size_t dy)
{
    uint32_t cell[CELLS];
    double drop[CELLS];
    double shear[CELLS];
    double there_shear[CELLS];
    double there_drop[CELLS];
    double root[2];
    uint8_t slipped[2][CELLS];
    double stress[2][CELLS];
    lac_rg_tree *tree = NULL;
    lac_rg_tree *other = NULL;
    lac_error err = {""};
    lac_domain *there = moved_by_hand(domain, dx, dy, cell);
    lac_hierarchy *h = hierarchy_of(there);
    for (size_t i = 0; i < domain->n; i++) {
        drop[i] = 0.4 * domain->pressure[i];
        shear[i] = domain->pressure[i] * draw_uniform(dx, i, 0.2, 0.95);
    }
    for (size_t i = 0; i < there->n; i++) {
        there_drop[i] = drop[cell[i]];
        there_shear[i] = shear[cell[i]];
    }
    assert_int_equal(lac_rg_tree_create_at(domain, dx, dy, domain->pressure, drop, &tree, &err),
                     LAC_OK);
    assert_int_equal(lac_rg_tree_create(h, there->pressure, there_drop, &other, &err), LAC_OK);
    settle(tree, shear, &root[0], slipped[0], stress[0]);
    settle(other, there_shear, &root[1], slipped[1], stress[1]);
    assert_near(root[0], root[1], 0.0);
    for (size_t i = 0; i < there->n; i++) {
        assert_int_equal(slipped[0][cell[i]], slipped[1][i]);
        assert_near(stress[0][cell[i]], stress[1][i], 0.0);
    }
    lac_rg_tree_free(tree);
    lac_rg_tree_free(other);
    lac_hierarchy_free(h);
    lac_domain_free(there);
}

static void test_shifted_blocks_hold_the_same_cells(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        lac_domain *domain = random_pressures(seed, seed % 2 == 0, 0.3);
        lac_rg_tree *tree = NULL;
        lac_error err = {""};
        check_shift(domain, 0, 0);
        check_shift(domain, seed % SIDE, (7 * seed) % SIDE);
        check_shift(domain, SIDE - 1, SIDE - 1);
        assert_int_equal(
            lac_rg_tree_create_at(domain, SIDE, 0, domain->pressure, domain->pressure, &tree, &err),
            LAC_EINPUT);
        assert_null(tree);
        lac_domain_free(domain);
    }
}

typedef struct joint {
    lac_domain *domain;
    lac_hierarchy *h;
    lac_rg_tree *tree;
    lac_rg_path *path;
} joint;

static void joint_fill(joint *j, lac_domain *domain, double beta)
{
    lac_error err = {""};
    double drop[CELLS];
    j->domain = domain;
    j->h = hierarchy_of(domain);
    for (size_t i = 0; i < domain->n; i++) {
        drop[i] = (1.0 - beta) * domain->pressure[i];
    }
    assert_int_equal(lac_rg_tree_create(j->h, domain->pressure, drop, &j->tree, &err), LAC_OK);
    assert_int_equal(lac_rg_path_further(domain->n, domain->pressure, NULL, &j->path, &err),
                     LAC_OK);
}

static void joint_clear(joint *j)
{
    lac_rg_path_free(j->path);
    lac_rg_tree_free(j->tree);
    lac_hierarchy_free(j->h);
    lac_domain_free(j->domain);
}

// Strength of blocks by their size, from 128 steps along the path.
static void size_effect(const joint *j, lac_rg_rule rule, lac_rg_sizes *sizes)
{
    enum { SCAN = 128 };
    double work[2 * CELLS];
    lac_error err = {""};
    lac_rg_block_state *s = NULL;
    assert_int_equal(lac_rg_states_create(j->tree, &s, &err), LAC_OK);
    double before = lac_rg_path_load(j->path, 0.0);
    for (int i = 0; i <= SCAN; i++) {
        double load = lac_rg_path_load(j->path, (double)i / SCAN);
        (void)lac_rg_root(j->tree, rule, j->path, load, work);
        lac_rg_states_note(j->tree, before, load, s);
        before = load;
    }
    lac_rg_states_summarise(j->tree, s, false, sizes);
    free(s);
}

// The largest block is the joint, and the smallest are its cells, of strength f p each.
static void test_strength_from_cell_to_joint(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        joint j;
        double work[2 * CELLS];
        lac_rg_sizes sizes[8];
        joint_fill(&j, random_pressures(seed, true, 0.1 + 0.04 * (double)seed), 0.7);
        double total = 0.0;
        for (size_t i = 0; i < j.domain->n; i++) {
            total += j.domain->pressure[i];
        }
        for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_CONS; rule++) {
            size_effect(&j, rule, sizes);
            double critical = lac_rg_critical(j.tree, rule, j.path, work);
            size_t top = lac_rg_levels(j.tree);
            assert_int_equal(sizes[top].blocks, 1);
            assert_near(sizes[top].load, critical, 2.0 / 128);
            assert_near(sizes[top].strength * CELLS, sizes[top].load * total, 1e-2 * total);
            assert_int_equal(sizes[0].blocks, j.domain->n);
            assert_near(sizes[0].strength, total / (double)j.domain->n, 1e-2 * total);
        }
        joint_clear(&j);
    }
}

// All alike: Coulomb's friction at every size.
static void test_uniform_joint_has_no_size_effect(void **state)
{
    (void)state;
    joint j;
    lac_rg_sizes sizes[8];
    joint_fill(&j, domain_of(SIDE, SIDE, NULL), 0.7);
    size_effect(&j, LAC_RG_FIX, sizes);
    for (size_t level = 0; level <= lac_rg_levels(j.tree); level++) {
        assert_int_equal(sizes[level].blocks, lac_rg_blocks_at(j.tree, level));
        assert_near(sizes[level].load, 1.0, 1e-9);
        assert_near(sizes[level].strength, 1.0, 1e-9);
        assert_near(sizes[level].spread, 0.0, 1e-7);
    }
    joint_clear(&j);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shifted_blocks_hold_the_same_cells),
        cmocka_unit_test(test_strength_from_cell_to_joint),
        cmocka_unit_test(test_uniform_joint_has_no_size_effect),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
