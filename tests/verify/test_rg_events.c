// SPDX-License-Identifier: GPL-3.0-or-later
// The pass over the tree against simulations, on random trees: slip after slip as the load rises,
// and every threshold by bisection. And the symmetries that the rules have.

#include <math.h>
#include <stdlib.h>

#include "rg/rg.h"
#include "support/test.h"
#include "support/trees.h"

enum { MOST = 64, LEVELS = 40 };

static const double far = 1e3; // no threshold of these trees is larger

typedef struct scene {
    lac_domain *domain;
    lac_hierarchy *h;
    size_t n, levels;
    double beta;
    double strength[MOST], drop[MOST], shear[MOST];
} scene;

static void scene_fill(scene *s, uint64_t seed)
{
    s->domain = random_domain(seed, MOST);
    s->h = hierarchy_of(s->domain);
    s->n = s->domain->n;
    s->levels = lac_hierarchy_levels(s->h);
    s->beta = seed % 7 == 0 ? 0.0 : draw_uniform(seed, 1000001, 0.0, 1.0);
    bool ties = seed % 5 == 0;
    for (size_t i = 0; i < s->n; i++) {
        double x = draw_log(seed, 2000000 + i, 0.1, 10);
        double y = draw_uniform(seed, 3000000 + i, 0.0, 1.0);
        s->strength[i] = ties ? ceil(x) : x;
        s->drop[i] = (1.0 - s->beta) * s->strength[i];
        s->shear[i] = s->strength[i] * (ties ? floor(4 * y) / 4 : y);
    }
}

static void scene_clear(scene *s)
{
    lac_hierarchy_free(s->h);
    lac_domain_free(s->domain);
}

static lac_rg_tree *scene_tree(const scene *s)
{
    lac_rg_tree *tree = NULL;
    lac_error err = {""};
    assert_int_equal(lac_rg_tree_create(s->h, s->strength, s->drop, &tree, &err), LAC_OK);
    return tree;
}

static void assert_near(double x, double expected, double tolerance)
{
    if (!(fabs(x - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g +- %g", x, expected, tolerance);
    }
}

static double sum(const double *x, uint32_t begin, uint32_t end)
{
    double total = 0.0;
    for (uint32_t i = begin; i < end; i++) {
        total += x[i];
    }
    return total;
}

// --- By bisection: a block is whole under R where its children, weakest first, all are.

static double by_bisection(const scene *s, lac_rg_rule rule, size_t level, uint32_t begin,
                           uint32_t end);

// The children of [begin, end): their first cells, and how many.
static size_t children_of(const scene *s, size_t level, uint32_t begin, uint32_t end,
                          uint32_t first[5])
{
    const uint32_t *fine = lac_hierarchy_offsets(s->h, level - 1);
    size_t n = 0;
    for (size_t b = 0; b < lac_hierarchy_blocks(s->h, level - 1); b++) {
        if (fine[b] >= begin && fine[b] < end) {
            first[n++] = fine[b];
        }
    }
    first[n] = end;
    return n;
}

typedef struct child {
    double gap, strength;
    uint32_t begin, end;
} child;

static int by_gap(const void *a, const void *b)
{
    const child *x = a;
    const child *y = b;
    if (x->gap != y->gap) {
        return x->gap < y->gap ? -1 : 1;
    }
    if (x->strength != y->strength) {
        return x->strength < y->strength ? -1 : 1;
    }
    return x->begin < y->begin ? -1 : 1;
}

static bool whole(const scene *s, lac_rg_rule rule, const child *c, size_t n, double R)
{
    double cells = 0.0;
    for (size_t i = 0; i < n; i++) {
        cells += (double)(c[i].end - c[i].begin);
    }
    double received = R;
    double left = cells;
    double force = R * cells;
    for (size_t i = 0; i < n; i++) {
        double share = rule == LAC_RG_FIX ? received : force / left;
        if (c[i].gap > share) {
            return false;
        }
        double kept = s->beta * sum(s->strength, c[i].begin, c[i].end);
        left -= (double)(c[i].end - c[i].begin);
        force += sum(s->shear, c[i].begin, c[i].end) - kept;
        received += left > 0 ? sum(s->drop, c[i].begin, c[i].end) / left : 0.0;
    }
    return true;
}

static double by_bisection(const scene *s, lac_rg_rule rule, size_t level, uint32_t begin,
                           uint32_t end)
{
    if (level == 0) {
        return s->strength[begin] - s->shear[begin];
    }
    uint32_t first[5];
    size_t n = children_of(s, level, begin, end, first);
    child c[4];
    for (size_t i = 0; i < n; i++) {
        double gap = by_bisection(s, rule, level - 1, first[i], first[i + 1]);
        // What differs by rounding only is the same.
        c[i] = (child){round(gap * 1e10) / 1e10, sum(s->strength, first[i], first[i + 1]), first[i],
                       first[i + 1]};
    }
    qsort(c, n, sizeof *c, by_gap);
    double low = -far;
    double high = far;
    for (int step = 0; step < 70; step++) {
        double middle = 0.5 * (low + high);
        bool slips = whole(s, rule, c, n, middle);
        low = slips ? low : middle;
        high = slips ? middle : high;
    }
    return high;
}

static void test_thresholds_by_bisection(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 1500; seed++) {
        scene s;
        scene_fill(&s, seed);
        lac_rg_tree *tree = scene_tree(&s);
        for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_CONS; rule++) {
            double root = lac_rg_pass(tree, rule, s.shear, NULL);
            assert_near(root, by_bisection(&s, rule, s.levels, 0, (uint32_t)s.n), 1e-8);
        }
        lac_rg_tree_free(tree);
        scene_clear(&s);
    }
}

// --- CONS, slip after slip: no thresholds, only forces.

typedef struct events {
    const scene *s;
    bool slipped[MOST];
    double share[MOST], weight[MOST]; // stress received = share + weight * tau
} events;

static bool gone(const events *e, uint32_t begin, uint32_t end)
{
    bool all = true;
    for (uint32_t i = begin; i < end; i++) {
        all = all && e->slipped[i];
    }
    return all;
}

// Hands what a block of `level` has received on to its cells.
static void hand_down(events *e, size_t level, uint32_t begin, uint32_t end, const double got[2])
{
    if (level == 0) {
        e->share[begin] = got[0];
        e->weight[begin] = got[1];
        return;
    }
    uint32_t first[5];
    size_t n = children_of(e->s, level, begin, end, first);
    double all = (double)(end - begin);
    double left = 0.0;
    double force = got[0] * all;
    for (size_t i = 0; i < n; i++) {
        if (gone(e, first[i], first[i + 1])) {
            force += sum(e->s->shear, first[i], first[i + 1]) -
                     e->s->beta * sum(e->s->strength, first[i], first[i + 1]);
        } else {
            left += (double)(first[i + 1] - first[i]);
        }
    }
    const double each[2] = {force / left, got[1] * all / left};
    for (size_t i = 0; i < n; i++) {
        if (!gone(e, first[i], first[i + 1])) {
            hand_down(e, level - 1, first[i], first[i + 1], each);
        }
    }
}

// The load at which the last cell slips.
static double by_events(const scene *s)
{
    events e = {.s = s};
    double tau = -far;
    for (size_t slips = 0; slips < s->n; slips++) {
        const double start[2] = {0.0, 1.0};
        hand_down(&e, s->levels, 0, (uint32_t)s->n, start);
        double next = INFINITY;
        size_t at = 0;
        for (size_t i = 0; i < s->n; i++) {
            double needed = (s->strength[i] - s->shear[i] - e.share[i]) / e.weight[i];
            if (!e.slipped[i] && needed < next) {
                next = needed;
                at = i;
            }
        }
        tau = fmax(tau, next);
        e.slipped[at] = true;
    }
    return tau;
}

static void test_cons_slip_after_slip(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 1500; seed++) {
        scene s;
        scene_fill(&s, seed);
        lac_rg_tree *tree = scene_tree(&s);
        assert_near(lac_rg_pass(tree, LAC_RG_CONS, s.shear, NULL), by_events(&s), 1e-9);
        lac_rg_tree_free(tree);
        scene_clear(&s);
    }
}

// --- What settles.

static void test_forces_balance_and_nothing_is_overloaded(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 1500; seed++) {
        scene s;
        scene_fill(&s, seed);
        lac_rg_tree *tree = scene_tree(&s);
        double scale = seed % 3 == 0 ? 1.0 : 0.8;
        double given = 0.0;
        double whole_strength = sum(s.strength, 0, (uint32_t)s.n);
        for (size_t i = 0; i < s.n; i++) {
            s.shear[i] *= scale;
            given += s.shear[i];
        }
        bool slides = lac_rg_slips(tree, lac_rg_pass(tree, LAC_RG_CONS, s.shear, NULL));
        uint8_t slipped[MOST];
        double stress[MOST];
        lac_rg_resolve(tree, slipped, stress);
        double carried = 0.0;
        size_t sticking = 0;
        for (size_t i = 0; i < s.n; i++) {
            double q = s.shear[i] + stress[i];
            sticking += slipped[i] == 0;
            assert_true(slipped[i] != 0 || q < s.strength[i]);
            carried += slipped[i] != 0 ? s.beta * s.strength[i] : q;
        }
        assert_int_equal(sticking == 0, slides);
        if (!slides) {
            assert_near(carried, given, 1e-12 * whole_strength);
        }
        lac_rg_tree_free(tree);
        scene_clear(&s);
    }
}

// Stress added everywhere comes off the threshold. Not where thresholds tie: rounding decides then
// which slips first, and with FIX that matters.
static void test_translation_and_scaling(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 500; seed++) {
        scene s;
        scene_fill(&s, 5 * seed + 1 + seed % 4);
        lac_rg_tree *tree = scene_tree(&s);
        for (lac_rg_rule rule = LAC_RG_FIX; rule <= LAC_RG_CONS; rule++) {
            double before = lac_rg_pass(tree, rule, s.shear, NULL);
            double moved[MOST];
            for (size_t i = 0; i < s.n; i++) {
                moved[i] = s.shear[i] + 0.37;
            }
            assert_near(lac_rg_pass(tree, rule, moved, NULL), before - 0.37, 1e-11);
            scene t = s;
            for (size_t i = 0; i < s.n; i++) {
                t.strength[i] *= 1e9;
                t.drop[i] *= 1e9;
                t.shear[i] *= 1e9;
            }
            lac_rg_tree *large = scene_tree(&t);
            assert_near(lac_rg_pass(large, rule, t.shear, NULL) / 1e9, before, 1e-11);
            lac_rg_tree_free(large);
        }
        lac_rg_tree_free(tree);
        scene_clear(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_thresholds_by_bisection),
        cmocka_unit_test(test_cons_slip_after_slip),
        cmocka_unit_test(test_forces_balance_and_nothing_is_overloaded),
        cmocka_unit_test(test_translation_and_scaling),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
