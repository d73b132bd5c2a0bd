// SPDX-License-Identifier: GPL-3.0-or-later
// The cascade against closed forms.

#include <math.h>
#include <stdlib.h>

#include "rg/rg.h"
#include "support/test.h"
#include "support/trees.h"

enum { MOST = 256 };

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

// A tree of depth `levels` in which every block has n children, n^levels <= MOST cells.
typedef struct full_tree {
    size_t count[10];
    uint32_t first[10][MOST + 1];
    const uint32_t *pointer[10];
    lac_rg_blocks blocks;
} full_tree;

static void fill_full(full_tree *t, size_t n, size_t levels)
{
    size_t cells = 1;
    for (size_t l = 0; l < levels; l++) {
        cells *= n;
    }
    assert_true(cells <= MOST && levels < 10);
    size_t side = 1;
    for (size_t l = 0; l <= levels; l++) {
        t->count[l] = cells / side;
        for (size_t b = 0; b <= t->count[l]; b++) {
            t->first[l][b] = (uint32_t)(b * side);
        }
        t->pointer[l] = t->first[l];
        side *= n;
    }
    t->blocks = (lac_rg_blocks){levels, t->count, t->pointer};
}

static lac_rg_tree *tree_of(const lac_rg_blocks *blocks, const double *strength, double beta)
{
    lac_rg_tree *tree = NULL;
    lac_error err = {""};
    double *drop = new_doubles(blocks->count[0]);
    for (size_t i = 0; i < blocks->count[0]; i++) {
        drop[i] = (1.0 - beta) * strength[i];
    }
    assert_int_equal(lac_rg_tree_from_blocks(blocks, strength, drop, &tree, &err), LAC_OK);
    free(drop);
    return tree;
}

static lac_rg_tree *full_tree_of(size_t n, size_t levels, const double *strength, double beta)
{
    full_tree *t = calloc(1, sizeof *t);
    assert_non_null(t);
    fill_full(t, n, levels);
    lac_rg_tree *tree = tree_of(&t->blocks, strength, beta);
    free(t);
    return tree;
}

// Threshold of the unloaded root.
static double unloaded(lac_rg_tree *tree, lac_rg_rule rule)
{
    double zero[MOST] = {0};
    return lac_rg_pass(tree, rule, zero, NULL);
}

// Q/Q_nom at which the root slips under q = min(tau, f p), by bisection on tau.
static double equal_critical(lac_rg_tree *tree, lac_rg_rule rule, size_t n, const double *strength)
{
    double low = 0.0;
    double high = 0.0;
    double total = 0.0;
    double shear[MOST];
    double gap[MOST];
    for (size_t i = 0; i < n; i++) {
        high = fmax(high, strength[i]);
        total += strength[i];
    }
    for (int step = 0; step < 60; step++) {
        double tau = 0.5 * (low + high);
        for (size_t i = 0; i < n; i++) {
            shear[i] = fmin(tau, strength[i]);
            gap[i] = strength[i] - tau;
        }
        bool slips = lac_rg_slips(tree, lac_rg_pass(tree, rule, shear, gap));
        low = slips ? low : tau;
        high = slips ? tau : high;
    }
    double q = 0.0;
    for (size_t i = 0; i < n; i++) {
        q += fmin(high, strength[i]);
    }
    return q / total;
}

static void test_two_by_two(void **state)
{
    (void)state;
    const double p[4] = {1, 2, 3, 4};
    const struct {
        double beta, threshold, fix, cons;
    } row[] = {{0.8, 47.0 / 15, 137.0 / 150, 0.88}, {0.6, 37.0 / 15, 119.0 / 150, 0.78}};
    for (size_t i = 0; i < 2; i++) {
        lac_rg_tree *tree = full_tree_of(4, 1, p, row[i].beta);
        assert_near(unloaded(tree, LAC_RG_FIX), row[i].threshold, 2e-12);
        assert_near(equal_critical(tree, LAC_RG_FIX, 4, p), row[i].fix, 2e-12);
        assert_near(equal_critical(tree, LAC_RG_CONS, 4, p), row[i].cons, 2e-12);
        lac_rg_tree_free(tree);
    }
}

static void test_uniform_load_slips_at_coulombs(void **state)
{
    (void)state;
    double p[64];
    for (size_t i = 0; i < 64; i++) {
        p[i] = 3.0;
    }
    const lac_rg_rule rules[] = {LAC_RG_FIX, LAC_RG_CONS, LAC_RG_LUMP};
    for (size_t r = 0; r < 3; r++) {
        for (double beta = 0.0; beta <= 1.0; beta += 0.25) {
            lac_rg_tree *tree = full_tree_of(4, 3, p, beta);
            assert_near(equal_critical(tree, rules[r], 64, p), 1.0, 1e-11);
            lac_rg_tree_free(tree);
        }
    }
}

// One cell of a full tree at its strength, all others at x of theirs: the x at which all slip.
static double critical_rest(lac_rg_tree *tree, lac_rg_rule rule, size_t cells)
{
    double low = 0.0;
    double high = 1.0;
    double shear[MOST];
    for (int step = 0; step < 60; step++) {
        double x = 0.5 * (low + high);
        for (size_t i = 0; i < cells; i++) {
            shear[i] = i == cells / 3 ? 1.0 : x;
        }
        bool slips = lac_rg_slips(tree, lac_rg_pass(tree, rule, shear, NULL));
        low = slips ? low : x;
        high = slips ? x : high;
    }
    return high;
}

static void test_one_cell_at_its_strength(void **state)
{
    (void)state;
    double p[MOST];
    for (size_t i = 0; i < MOST; i++) {
        p[i] = 1.0;
    }
    const double betas[] = {0.8, 0.6, 0.3};
    for (size_t n = 2; n <= 5; n++) {
        size_t cells = 1;
        for (size_t depth = 1; cells * n <= MOST; depth++) {
            double m = (double)cells; // n^(depth - 1)
            double k = (double)n;
            cells *= n;
            for (size_t i = 0; i < 3; i++) {
                double beta = betas[i];
                lac_rg_tree *tree = full_tree_of(n, depth, p, beta);
                assert_near(critical_rest(tree, LAC_RG_FIX, cells), 1.0 - (1.0 - beta) / (k - 1.0),
                            1e-11);
                assert_near(critical_rest(tree, LAC_RG_CONS, cells),
                            (k * m - m + beta * m - 1.0) / (k * m - 1.0), 1e-11);
                lac_rg_tree_free(tree);
            }
        }
    }
}

// K slipped points of four bring the others down at load x where x + h_K (1 - beta) >= 1.
static void test_lump_needs_k_of_n(void **state)
{
    (void)state;
    const double h[] = {0.0, 1.0 / 3.0, 5.0 / 6.0, 11.0 / 6.0};
    const double p[4] = {1, 1, 1, 1};
    for (double beta = 0.05; beta < 1.0; beta += 0.1) {
        lac_rg_tree *tree = full_tree_of(4, 1, p, beta);
        for (double x = 0.013; x < 1.0; x += 0.02) {
            for (size_t k = 0; k < 4; k++) {
                double shear[4];
                for (size_t i = 0; i < 4; i++) {
                    shear[i] = i < k ? 1.0 : x;
                }
                bool expected = x + h[k] * (1.0 - beta) >= 1.0;
                bool slips = lac_rg_slips(tree, lac_rg_pass(tree, LAC_RG_LUMP, shear, NULL));
                assert_int_equal(slips, expected);
            }
        }
        lac_rg_tree_free(tree);
    }
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return x < y ? -1 : x > y ? 1 : 0;
}

static void test_one_democratic_cell(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 200; seed++) {
        size_t n = 1 + (size_t)draw_uniform(seed, 0, 0, 200);
        double beta = draw_uniform(seed, 1, 0, 1);
        double t[MOST];
        for (size_t i = 0; i < n; i++) {
            t[i] = draw_log(seed, 10 + i, 0.01, 10);
        }
        lac_rg_tree *tree = full_tree_of(n, 1, t, beta);
        double fix = unloaded(tree, LAC_RG_FIX);
        double cons = unloaded(tree, LAC_RG_CONS);
        lac_rg_tree_free(tree);
        qsort(t, n, sizeof *t, ascending);
        double best_fix = 0.0;
        double best_cons = 0.0;
        double shed = 0.0;
        double held = 0.0;
        for (size_t k = 0; k < n; k++) {
            best_fix = fmax(best_fix, t[k] - shed);
            best_cons = fmax(best_cons, (double)(n - k) * t[k] + beta * held);
            held += t[k];
            shed += k + 1 < n ? (1.0 - beta) * t[k] / (double)(n - k - 1) : 0.0;
        }
        assert_near(fix, best_fix, 1e-12 * best_fix);
        assert_near(cons * (double)n, best_cons, 1e-12 * best_cons);
    }
}

// Q_crit over the mean strength of one block of many cells whose strengths are the quantiles of a
// distribution, CONS.
static double many_cells(double (*quantile)(double p), double mean, double beta)
{
    const size_t n = 200000;
    const uint32_t whole[2] = {0, (uint32_t)n};
    const size_t count[2] = {n, 1};
    const uint32_t *first[2] = {NULL, whole};
    double *strength = new_doubles(n);
    double *zero = new_doubles(n);
    for (size_t i = 0; i < n; i++) {
        strength[i] = quantile(((double)i + 0.5) / (double)n);
    }
    lac_rg_tree *tree = tree_of(&(lac_rg_blocks){1, count, first}, strength, beta);
    double threshold = lac_rg_pass(tree, LAC_RG_CONS, zero, NULL);
    lac_rg_tree_free(tree);
    free(zero);
    free(strength);
    return threshold / mean;
}

static double uniform(double p) { return p; }
static double exponential(double p) { return -log1p(-p); }
static double weibull2(double p) { return sqrt(-log1p(-p)); }
static double weibull5(double p) { return pow(-log1p(-p), 0.2); }

// T8 in the limit of many cells: uniform 1/(2 - beta); Weibull (m e)^(-1/m)/Gamma(1 + 1/m), beta 0.
static void test_many_cells_in_one_block(void **state)
{
    (void)state;
    for (double beta = 0.0; beta <= 1.0; beta += 0.25) {
        assert_near(many_cells(uniform, 0.5, beta), 1.0 / (2.0 - beta), 2e-5);
    }
    assert_near(many_cells(exponential, 1.0, 0.8), 0.80135, 2e-5);
    const double e = exp(1.0);
    assert_near(many_cells(weibull2, tgamma(1.5), 0.0), pow(2 * e, -0.5) / tgamma(1.5), 2e-5);
    assert_near(many_cells(weibull5, tgamma(1.2), 0.0), pow(5 * e, -0.2) / tgamma(1.2), 2e-5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_by_two),
        cmocka_unit_test(test_uniform_load_slips_at_coulombs),
        cmocka_unit_test(test_one_cell_at_its_strength),
        cmocka_unit_test(test_lump_needs_k_of_n),
        cmocka_unit_test(test_one_democratic_cell),
        cmocka_unit_test(test_many_cells_in_one_block),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
