// SPDX-License-Identifier: GPL-3.0-or-later
// The lazy sums of cells at steps of their own, against K from its definition: random trees, random
// increments at random times. No cell may be pushed beyond its margin before it is due.

#include <math.h>
#include <stdlib.h>

#include "async/tree.h"
#include "support/test.h"
#include "support/trees.h"

enum { LEVELS = 40, TREES = 24, ROUNDS = 60, CELLS = 60 };

typedef struct scene {
    lac_domain *domain;
    lac_hierarchy *hierarchy;
    lac_async_tree tree;
    long double *dense; // [n n]
    double k_mean;
    uint64_t seed, draws;
    double *slip, *since; // [n] as told, and since when
    double *observation;  // [n] E of each cell when it was last updated
} scene;

static double draw(scene *s, double low, double high)
{
    return draw_uniform(s->seed, s->draws++, low, high);
}

static void make(uint64_t seed, scene *s)
{
    double k[LEVELS];
    lac_error err;
    *s = (scene){.seed = seed, .domain = random_domain(seed, CELLS)};
    size_t n = s->domain->n;
    s->hierarchy = hierarchy_of(s->domain);
    size_t levels = lac_hierarchy_levels(s->hierarchy);
    for (size_t l = 0; l < levels; l++) {
        k[l] = draw_log(seed, 1000 + l, 1e-2, 1e2);
    }
    s->k_mean = seed % 2 == 0 ? 0.0 : draw_log(seed, 2000, 1e-2, 1e2);
    s->dense = calloc(n * n, sizeof *s->dense);
    dense_hierarchy(s->domain, levels, k, s->dense);
    for (size_t i = 0; i < n * n; i++) {
        s->dense[i] += s->k_mean / (double)n;
    }
    assert_int_equal(lac_async_tree_create(s->hierarchy, k, &s->tree, &err), LAC_OK);
    lac_async_tree_anchor(&s->tree, s->k_mean, 0.0);
    s->slip = new_doubles(n);
    s->since = new_doubles(n);
    s->observation = new_doubles(n);
}

static void clear(scene *s)
{
    lac_async_tree_clear(&s->tree);
    lac_hierarchy_free(s->hierarchy);
    lac_domain_free(s->domain);
    free(s->dense);
    free(s->slip);
    free(s->since);
    free(s->observation);
}

static double told_at(const scene *s, size_t i, double t)
{
    return s->slip[i] + s->tree.cell[i].told * (t - s->since[i]);
}

// E of a cell from K itself: what its block does to it, -K slip with its own tie given back.
static double dense_outer(const scene *s, size_t i, double t)
{
    long double sum = s->tree.cell[i].stiffness * told_at(s, i, t);
    size_t n = s->domain->n;
    for (size_t j = 0; j < n; j++) {
        sum -= s->dense[i * n + j] * told_at(s, j, t);
    }
    return (double)sum;
}

static void draw_margin(scene *s, lac_async_cell *c)
{
    c->high = draw_log(s->seed, s->draws++, 1e-3, 1e2);
    c->low = draw(s, 0, 1) < 0.3 ? -INFINITY : -draw_log(s->seed, s->draws++, 1e-3, 1e2);
}

static void start(scene *s)
{
    size_t n = s->domain->n;
    for (size_t i = 0; i < n; i++) {
        lac_async_cell *c = &s->tree.cell[i];
        s->slip[i] = c->slip = draw(s, -1, 1);
        s->since[i] = 0.0;
        c->told = draw(s, 0, 1);
        c->due = INFINITY;
        draw_margin(s, c);
    }
    lac_async_tree_fill(&s->tree);
    lac_async_tree_propagate(&s->tree, 0.0);
    for (size_t i = 0; i < n; i++) {
        s->observation[i] = dense_outer(s, i, 0.0);
    }
}

// A cell jumps and goes on at another rate.
static void change(scene *s, uint32_t i, double t, double jump, double rate)
{
    lac_async_cell *c = &s->tree.cell[i];
    s->slip[i] = told_at(s, i, t) + jump;
    s->since[i] = t;
    double before = c->told;
    c->told = rate;
    c->due = INFINITY;
    draw_margin(s, c);
    lac_async_tree_add(&s->tree, i, t, jump, rate - before);
    s->observation[i] = dense_outer(s, i, t);
}

// Every cell's E is that of K and, where nothing is due at this very time, within its margin.
static void look(const scene *s, double t)
{
    bool waiting = s->tree.node[s->tree.nodes - 1].due <= t;
    for (size_t i = 0; i < s->domain->n; i++) {
        const lac_async_cell *c = &s->tree.cell[i];
        double outer = dense_outer(s, i, t);
        double lazy = lac_async_tree_view(&s->tree, c->parent, t).outer;
        double scale = 1e4 * (1.0 + t);
        assert_true(fabs(lazy - outer) < 1e-12 * scale);
        double by = outer - s->observation[i];
        assert_true(waiting || (by <= c->high + 1e-11 * scale && by >= c->low - 1e-11 * scale));
    }
}

// Opens blocks and wakes cells up to a time, and looks between.
static void go_to(scene *s, double end)
{
    const lac_async_node *root = &s->tree.node[s->tree.nodes - 1];
    double t = root->t;
    for (int steps = 0; root->due <= end; steps++) {
        assert_true(steps < 100000); // no block opens for ever
        t = fmax(root->due, t);
        uint32_t who = root->who;
        if (steps % 64 == 0) {
            look(s, t);
        }
        if (who < s->tree.n) {
            change(s, who, t, 0.0, s->tree.cell[who].told);
        } else {
            lac_async_tree_open(&s->tree, who - s->tree.n, t);
        }
    }
    look(s, end);
}

static void nothing_is_late_and_sums_are_those_of_k(void **state)
{
    (void)state;
    for (uint64_t seed = 1; seed <= TREES; seed++) {
        scene s;
        make(seed, &s);
        start(&s);
        double t = 0.0;
        for (int round = 0; round < ROUNDS; round++) {
            t += draw_log(s.seed, s.draws++, 1e-6, 1e-1);
            go_to(&s, t);
            uint32_t i = (uint32_t)(draw(&s, 0, 1) * (double)s.domain->n);
            bool jumps = draw(&s, 0, 1) < 0.5;
            change(&s, i, t, jumps ? draw(&s, -0.1, 0.1) : 0.0, draw(&s, 0, 2));
            look(&s, t);
            go_to(&s, t);
        }
        clear(&s);
    }
}

// Times may begin anew at any instant.
static void shifting_time_changes_nothing(void **state)
{
    (void)state;
    scene s;
    make(7, &s);
    start(&s);
    go_to(&s, 0.05);
    const lac_async_node *root = &s.tree.node[s.tree.nodes - 1];
    double due = root->due;
    double outer = lac_async_tree_view(&s.tree, s.tree.cell[0].parent, 0.05).outer;
    lac_async_tree_shift(&s.tree, 0.05);
    assert_true(fabs(root->due + 0.05 - due) < 1e-14 || due == INFINITY);
    double now = lac_async_tree_view(&s.tree, s.tree.cell[0].parent, 0.0).outer;
    assert_true(fabs(now - outer) <= 1e-12 * fabs(outer));
    clear(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_late_and_sums_are_those_of_k),
        cmocka_unit_test(shifting_time_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
