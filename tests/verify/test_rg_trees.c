// SPDX-License-Identifier: GPL-3.0-or-later
// Random trees with any number of children: rule LUMP against a simulation, event after event, and
// what must not depend on the order of children or on units.

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "rg/tree.h"
#include "support/blocks.h"
#include "support/test.h"
#include "support/trees.h"

enum { MOST = BLOCKS_CELLS, TREES = 3000 };

typedef struct scene {
    test_blocks t;
    size_t n, levels;
    double beta;
    double strength[MOST], drop[MOST], shear[MOST];
} scene;

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

static void scene_fill(scene *s, uint64_t seed)
{
    blocks_draw(&s->t, seed);
    s->n = s->t.count[0];
    s->levels = s->t.blocks.levels;
    s->beta = seed % 9 == 0 ? 0.0 : draw_uniform(seed, 20001, 0.0, 1.0);
    double filled = draw_uniform(seed, 20002, 0.0, 1.0);
    for (size_t i = 0; i < s->n; i++) {
        s->strength[i] = draw_log(seed, 30000 + i, 0.1, 10);
        s->drop[i] = (1.0 - s->beta) * s->strength[i];
        double u = draw_uniform(seed, 40000 + i, filled, 1.0);
        s->shear[i] = s->strength[i] * (draw_uniform(seed, 50000 + i, 0, 1) < 0.2 ? 1.0 : u);
    }
}

static lac_rg_tree *tree_of(const lac_rg_blocks *blocks, const double *strength, const double *drop)
{
    lac_rg_tree *tree = NULL;
    lac_error err = {""};
    assert_int_equal(lac_rg_tree_from_blocks(blocks, strength, drop, &tree, &err), LAC_OK);
    return tree;
}

// Of the blocks of a level after a pass.
static const double *thresholds(const lac_rg_tree *tree, size_t level)
{
    return tree->layer[tree->of_level[level]].gap;
}

static double sum(const double *x, uint32_t begin, uint32_t end)
{
    double total = 0.0;
    for (uint32_t i = begin; i < end; i++) {
        total += x[i];
    }
    return total;
}

// --- LUMP by events: points with loads of their own; one slips, and hands on what it sheds.

typedef struct lump_point {
    double load, strength;
    bool hollow, slipped; // its own points have all slipped; it has itself
} lump_point;

static size_t next_to_slip(const lump_point *p, size_t n)
{
    size_t at = n;
    double best = 0.0;
    for (size_t i = 0; i < n; i++) {
        double ratio = p[i].hollow ? INFINITY : p[i].load / p[i].strength;
        if (!p[i].slipped && ratio >= 1.0 - 1e-12 && (at == n || ratio > best)) {
            at = i;
            best = ratio;
        }
    }
    return at;
}

static bool brute_slips(const scene *s, const double *shear, size_t level, uint32_t begin,
                        uint32_t end)
{
    if (level == 0) {
        return s->strength[begin] - shear[begin] <=
               1e-12 * sum(s->strength, 0, (uint32_t)s->n) / (double)s->n;
    }
    lump_point p[MOST] = {0};
    size_t n = 0;
    for (size_t b = 0; b < s->t.count[level - 1]; b++) {
        uint32_t from = s->t.first[level - 1][b];
        uint32_t to = s->t.first[level - 1][b + 1];
        if (from >= begin && from < end) {
            p[n++] = (lump_point){sum(shear, from, to), sum(s->strength, from, to),
                                  brute_slips(s, shear, level - 1, from, to), false};
        }
    }
    if (n == 1) {
        return p[0].hollow; // the same block at both levels
    }
    size_t left = n;
    for (size_t at = next_to_slip(p, n); at < n; at = next_to_slip(p, n)) {
        p[at].slipped = true;
        left--;
        for (size_t i = 0; i < n; i++) {
            p[i].load += p[i].slipped ? 0.0 : (1.0 - s->beta) * p[at].strength / (double)left;
        }
    }
    return left == 0;
}

static void test_lump_event_after_event(void **state)
{
    (void)state;
    size_t slid = 0;
    for (uint64_t seed = 0; seed < TREES; seed++) {
        scene s;
        scene_fill(&s, seed);
        lac_rg_tree *tree = tree_of(&s.t.blocks, s.strength, s.drop);
        slid += lac_rg_slips(tree, lac_rg_pass(tree, LAC_RG_LUMP, s.shear, NULL)) ? 1 : 0;
        for (size_t level = 0; level <= s.levels; level++) {
            for (size_t b = 0; b < s.t.count[level]; b++) {
                bool expected =
                    brute_slips(&s, s.shear, level, s.t.first[level][b], s.t.first[level][b + 1]);
                bool slips = lac_rg_slips(tree, thresholds(tree, level)[b]);
                assert_int_equal(slips, expected);
            }
        }
        lac_rg_tree_free(tree);
    }
    assert_true(slid > TREES / 20 && slid < TREES / 20 * 19);
}

// The critical load under equal stress, by the same scan and plain bisection.
static double brute_critical(const scene *s, const lac_rg_path *path)
{
    double shear[MOST];
    double gap[MOST];
    double low = 0.0;
    double high = 0.0;
    bool slides = false;
    for (int i = 1; i <= 60 && !slides; i++) {
        low = high;
        high = (double)i / 60;
        lac_rg_path_eval(path, high, shear, gap);
        slides = brute_slips(s, shear, s->levels, 0, (uint32_t)s->n);
    }
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (low + high);
        lac_rg_path_eval(path, middle, shear, gap);
        slides = brute_slips(s, shear, s->levels, 0, (uint32_t)s->n);
        low = slides ? low : middle;
        high = slides ? middle : high;
    }
    return high;
}

static lac_rg_path *equal_path(const scene *s)
{
    lac_error err = {""};
    lac_rg_path *path = NULL;
    assert_int_equal(lac_rg_path_further(s->n, s->strength, NULL, &path, &err), LAC_OK);
    return path;
}

static double critical_by(const scene *s, lac_rg_rule rule, const lac_rg_path *path)
{
    double work[2 * MOST];
    lac_rg_tree *tree = tree_of(&s->t.blocks, s->strength, s->drop);
    const double critical = lac_rg_critical(tree, rule, path, work);
    lac_rg_tree_free(tree);
    return critical;
}

static void test_lump_critical_load(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 300; seed++) {
        scene s;
        scene_fill(&s, seed);
        lac_rg_path *path = equal_path(&s);
        assert_near(critical_by(&s, LAC_RG_LUMP, path), brute_critical(&s, path), 1.1e-9);
        lac_rg_path_free(path);
    }
}

// --- T5: forces balance at full slip only where Q >= beta Q_nom.

static void test_cons_lies_between_beta_and_one(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 1000; seed++) {
        scene s;
        scene_fill(&s, seed);
        lac_rg_path *path = equal_path(&s);
        const double critical = critical_by(&s, LAC_RG_CONS, path);
        assert_true(critical >= s.beta - 1e-9 && critical <= 1.0 + 1e-12);
        lac_rg_path_free(path);
    }
}

// --- T10

// Strengths and tractions of the scene for the cells of a relabelled tree.
static lac_rg_tree *relabelled(const scene *s, uint64_t seed, test_blocks *t, uint32_t *cell,
                               double *shear)
{
    double strength[MOST];
    double drop[MOST];
    blocks_relabel(&s->t, seed, t, cell);
    for (size_t i = 0; i < s->n; i++) {
        strength[i] = s->strength[cell[i]];
        drop[i] = s->drop[cell[i]];
        shear[i] = s->shear[cell[i]];
    }
    return tree_of(&t->blocks, strength, drop);
}

// Blocks of the two trees are the same where their first cells lie in the same block.
static size_t same_block(const scene *s, size_t level, uint32_t cell)
{
    size_t b = 0;
    while (s->t.first[level][b + 1] <= cell) {
        b++;
    }
    return b;
}

// LUMP is left out: of points whose own have all slipped the first by place goes first.
static void test_order_of_children_does_not_matter(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 1500; seed++) {
        scene s;
        test_blocks t;
        uint32_t cell[MOST];
        double shear[MOST];
        scene_fill(&s, seed);
        lac_rg_tree *tree = tree_of(&s.t.blocks, s.strength, s.drop);
        lac_rg_tree *other = relabelled(&s, seed, &t, cell, shear);
        for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_CONS; rule++) {
            (void)lac_rg_pass(tree, rule, s.shear, NULL);
            (void)lac_rg_pass(other, rule, shear, NULL);
            for (size_t level = 0; level <= s.levels; level++) {
                for (size_t b = 0; b < t.count[level]; b++) {
                    size_t was = same_block(&s, level, cell[t.first[level][b]]);
                    double before = thresholds(tree, level)[was];
                    double after = thresholds(other, level)[b];
                    assert_near(after, before, 1e-11);
                }
            }
        }
        lac_rg_tree_free(other);
        lac_rg_tree_free(tree);
    }
}

// With CONS the order does not matter where thresholds tie either; sums of whole numbers are exact.
static void test_cons_order_of_ties_does_not_matter(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 1500; seed++) {
        scene s;
        test_blocks t;
        uint32_t cell[MOST];
        double shear[MOST];
        scene_fill(&s, seed);
        s.beta = 0.5;
        for (size_t i = 0; i < s.n; i++) {
            s.strength[i] = 2.0 * ceil(draw_uniform(seed, 60000 + i, 0, 3));
            s.drop[i] = 0.5 * s.strength[i];
            s.shear[i] = floor(draw_uniform(seed, 70000 + i, 0, s.strength[i]));
        }
        lac_rg_tree *tree = tree_of(&s.t.blocks, s.strength, s.drop);
        lac_rg_tree *other = relabelled(&s, seed, &t, cell, shear);
        double before = lac_rg_pass(tree, LAC_RG_CONS, s.shear, NULL);
        assert_near(lac_rg_pass(other, LAC_RG_CONS, shear, NULL), before, 1e-12);
        lac_rg_tree_free(other);
        lac_rg_tree_free(tree);
    }
}

static void test_units_do_not_matter(void **state)
{
    (void)state;
    const double scales[] = {1e-250, 1e-9, 1e9, 1e250};
    for (uint64_t seed = 0; seed < 400; seed++) {
        scene s;
        scene_fill(&s, seed);
        lac_rg_tree *tree = tree_of(&s.t.blocks, s.strength, s.drop);
        for (size_t k = 0; k < 4; k++) {
            scene u = s;
            for (size_t i = 0; i < s.n; i++) {
                u.strength[i] *= scales[k];
                u.drop[i] *= scales[k];
                u.shear[i] *= scales[k];
            }
            lac_rg_tree *other = tree_of(&s.t.blocks, u.strength, u.drop);
            for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_CONS; rule++) {
                double before = lac_rg_pass(tree, rule, s.shear, NULL);
                double after = lac_rg_pass(other, rule, u.shear, NULL);
                assert_near(after / scales[k], before, 1e-11);
            }
            lac_rg_tree_free(other);
        }
        lac_rg_tree_free(tree);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lump_event_after_event),
        cmocka_unit_test(test_lump_critical_load),
        cmocka_unit_test(test_cons_lies_between_beta_and_one),
        cmocka_unit_test(test_order_of_children_does_not_matter),
        cmocka_unit_test(test_cons_order_of_ties_does_not_matter),
        cmocka_unit_test(test_units_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
