// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade where trees, strengths and residual strengths are as extreme as they come.

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rg/rg.h"
#include "support/blocks.h"
#include "support/test.h"
#include "support/trees.h"

static const double betas[] = {0.0, 1e-12, 0.3, 1.0 - 1e-12, 1.0};
enum { BETAS = sizeof betas / sizeof *betas, CHAIN = 39 };

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

static lac_rg_tree *tree_of(const lac_rg_blocks *blocks, const double *strength, double beta)
{
    const size_t n = blocks->count[0];
    lac_rg_tree *tree = NULL;
    lac_error err = {""};
    double *drop = new_doubles(n);
    for (size_t i = 0; i < n; i++) {
        drop[i] = (1.0 - beta) * strength[i];
    }
    assert_int_equal(lac_rg_tree_from_blocks(blocks, strength, drop, &tree, &err), LAC_OK);
    free(drop);
    return tree;
}

// Q_crit/Q_nom under equal stress.
static double critical(const lac_rg_blocks *blocks, const double *strength, double beta,
                       lac_rg_rule rule)
{
    lac_rg_path *path = NULL;
    lac_error err = {""};
    double *work = new_doubles(2 * blocks->count[0]);
    lac_rg_tree *tree = tree_of(blocks, strength, beta);
    assert_int_equal(lac_rg_path_further(blocks->count[0], strength, NULL, &path, &err), LAC_OK);
    double q = lac_rg_critical(tree, rule, path, work);
    lac_rg_path_free(path);
    lac_rg_tree_free(tree);
    free(work);
    return q;
}

static void test_one_cell_slips_at_coulombs(void **state)
{
    (void)state;
    const size_t count[1] = {1};
    const uint32_t *first[1] = {NULL};
    const lac_rg_blocks one = {0, count, first};
    const double strengths[] = {1e-300, 1.0, 1e300};
    for (size_t k = 0; k < BETAS; k++) {
        for (size_t i = 0; i < 3; i++) {
            for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
                assert_near(critical(&one, &strengths[i], betas[k], rule), 1.0, 2e-9);
            }
        }
    }
}

// The weak cell of two slips at 1 and hands 1 - beta on: all rules say tau_c = 2 + beta. Blocks
// above and below that hold only one block change nothing.
static void test_two_cells_and_chains(void **state)
{
    (void)state;
    const double strength[2] = {1, 3};
    static const uint32_t fine[3] = {0, 1, 2};
    static const uint32_t whole[2] = {0, 2};
    for (size_t levels = 1; levels <= CHAIN; levels += 19) {
        for (size_t joined = 1; joined <= levels; joined++) { // the level at which the two meet
            size_t count[CHAIN + 1];
            const uint32_t *first[CHAIN + 1];
            for (size_t l = 0; l <= levels; l++) {
                count[l] = l < joined ? 2 : 1;
                first[l] = l < joined ? fine : whole;
            }
            const lac_rg_blocks chain = {levels, count, first};
            for (size_t k = 0; k < BETAS; k++) {
                for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
                    assert_near(critical(&chain, strength, betas[k], rule), (3.0 + betas[k]) / 4.0,
                                2e-9);
                }
            }
        }
    }
}

static void test_uniform_trees_slip_at_coulombs(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 100; seed++) {
        test_blocks t;
        double strength[BLOCKS_CELLS];
        blocks_draw(&t, seed);
        for (size_t i = 0; i < t.count[0]; i++) {
            strength[i] = 3.7e6;
        }
        for (size_t k = 0; k < BETAS; k++) {
            for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
                assert_near(critical(&t.blocks, strength, betas[k], rule), 1.0, 2e-9);
            }
        }
    }
}

// T4 and its other end: no drop, Coulomb's friction; a drop of all but a trace, that of all.
static void test_beta_goes_to_its_ends(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 300; seed++) {
        test_blocks t;
        double strength[BLOCKS_CELLS];
        blocks_draw(&t, seed);
        for (size_t i = 0; i < t.count[0]; i++) {
            strength[i] = draw_log(seed, 5000 + i, 0.1, 10);
        }
        for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
            assert_near(critical(&t.blocks, strength, 1.0, rule), 1.0, 2e-9);
            assert_near(critical(&t.blocks, strength, 1.0 - 1e-12, rule), 1.0, 3e-9);
            assert_near(critical(&t.blocks, strength, 1e-12, rule),
                        critical(&t.blocks, strength, 0.0, rule), 3e-9);
        }
    }
}

static void test_nothing_slips_without_load(void **state)
{
    (void)state;
    const double zero[BLOCKS_CELLS] = {0};
    for (uint64_t seed = 0; seed < 200; seed++) {
        test_blocks t;
        double strength[BLOCKS_CELLS];
        uint8_t slipped[BLOCKS_CELLS];
        double stress[BLOCKS_CELLS];
        blocks_draw(&t, seed);
        for (size_t i = 0; i < t.count[0]; i++) {
            strength[i] = draw_log(seed, 5000 + i, 0.1, 10);
        }
        lac_rg_tree *tree = tree_of(&t.blocks, strength, betas[seed % BETAS]);
        for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_LUMP; rule++) {
            assert_false(lac_rg_slips(tree, lac_rg_pass(tree, rule, zero, NULL)));
            lac_rg_resolve(tree, slipped, stress);
            for (size_t level = 0; level <= lac_rg_levels(tree); level++) {
                assert_int_equal(lac_rg_slipping(tree, level), 0);
            }
            for (size_t i = 0; i < t.count[0]; i++) {
                assert_int_equal(slipped[i], 0);
                assert_near(stress[i], 0.0, 0.0);
            }
        }
        lac_rg_tree_free(tree);
    }
}

static void test_what_cannot_be_added_up_is_refused(void **state)
{
    (void)state;
    const double large[2] = {DBL_MAX, DBL_MAX};
    const double shear[2] = {1, NAN};
    lac_rg_path *path = NULL;
    lac_error err = {""};
    assert_int_equal(lac_rg_path_further(2, large, NULL, &path, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_path_further(2, shear, shear, &path, &err), LAC_EINPUT);
    assert_int_equal(lac_rg_path_further(0, large, NULL, &path, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "no cell is in contact"));
    assert_null(path);
}

// Ten children a block, seven levels: 11 million blocks. One cell at its strength, the others at x:
// the root slips at x >= 1 - (1 - beta)/9 (FIX), (9 m - 1 + beta m)/(10 m - 1), m = 10^6 (CONS).
static void test_ten_million_cells(void **state)
{
    (void)state;
    enum { LEVELS = 7, TEN = 10 };
    const size_t n = 10000000;
    size_t count[LEVELS + 1] = {n};
    uint32_t *own[LEVELS + 1] = {NULL};
    const uint32_t *first[LEVELS + 1] = {NULL};
    size_t side = 1;
    for (size_t l = 1; l <= LEVELS; l++) {
        side *= TEN;
        count[l] = n / side;
        own[l] = malloc((count[l] + 1) * sizeof *own[l]);
        assert_non_null(own[l]);
        for (size_t b = 0; b <= count[l]; b++) {
            own[l][b] = (uint32_t)(b * side);
        }
        first[l] = own[l];
    }
    double *strength = new_doubles(n);
    for (size_t i = 0; i < n; i++) {
        strength[i] = 1.0;
    }
    lac_rg_tree *tree = NULL;
    lac_error err = {""};
    const lac_rg_blocks blocks = {LEVELS, count, first};
    // all of the strength is lost: beta = 0
    assert_int_equal(lac_rg_tree_from_blocks(&blocks, strength, strength, &tree, &err), LAC_OK);
    const double m = 1e6;
    const double bound[2] = {1.0 - 1.0 / 9.0, (10.0 * m - m - 1.0) / (10.0 * m - 1.0)};
    for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_CONS; rule++) {
        for (int above = 0; above < 2; above++) {
            for (size_t i = 0; i < n; i++) {
                strength[i] = bound[rule] + (above ? 1e-10 : -1e-10);
            }
            strength[n / 3] = 1.0;
            assert_int_equal(lac_rg_slips(tree, lac_rg_pass(tree, rule, strength, NULL)), above);
        }
    }
    lac_rg_tree_free(tree);
    free(strength);
    for (size_t l = 1; l <= LEVELS; l++) {
        free(own[l]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_cell_slips_at_coulombs),
        cmocka_unit_test(test_two_cells_and_chains),
        cmocka_unit_test(test_uniform_trees_slip_at_coulombs),
        cmocka_unit_test(test_beta_goes_to_its_ends),
        cmocka_unit_test(test_nothing_slips_without_load),
        cmocka_unit_test(test_what_cannot_be_added_up_is_refused),
        cmocka_unit_test(test_ten_million_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
