// SPDX-License-Identifier: GPL-3.0-or-later
// Loops that run in threads where there are many cells: rates, Newton solves and whole steps have
// the same bits with one thread as with three.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <omp.h>

#include "base/parallel_for.h"
#include "lacuna/simulation.h"
#include "support/test.h"
#include "support/tree.h"
#include "support/trees.h"

enum { LEVELS = 9 }; // 262 144 cells: above LAC_PARTS_ALONE

static tree many_cells(void)
{
    tree_def def = tree_default(LEVELS, 3);
    def.keep = 0.99;
    tree t;
    tree_create(&def, &t);
    assert_true(t.domain->n > LAC_PARTS_ALONE);
    return t;
}

static void rates_and_solves(const tree *t, int threads, double *rates, double *solved)
{
    size_t n = t->domain->n;
    double *y = new_doubles(2 * n), *work = new_doubles(lac_problem_work(t->problem));
    omp_set_num_threads(threads);
    lac_problem_initial(t->problem, y);
    assert_true(lac_problem_derivative(t->problem, 0, y, rates, work));
    for (size_t i = 0; i < 2 * n; i++) {
        solved[i] = 1e-3 * sin((double)i);
    }
    assert_true(lac_problem_newton(t->problem, 0, y, 10.0, solved, work));
    omp_set_num_threads(1);
    free(y);
    free(work);
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    tree t = many_cells();
    size_t n = t.domain->n;
    double *one[] = {new_doubles(2 * n), new_doubles(2 * n)};
    double *three[] = {new_doubles(2 * n), new_doubles(2 * n)};
    rates_and_solves(&t, 1, one[0], one[1]);
    rates_and_solves(&t, 3, three[0], three[1]);
    for (int k = 0; k < 2; k++) {
        assert_memory_equal(one[k], three[k], 2 * n * sizeof(double));
        free(one[k]);
        free(three[k]);
    }
    tree_clear(&t);
}

static double time_after_steps(const tree *t, int threads)
{
    lac_error err;
    lac_run_result result;
    lac_run_def how = lac_run_default();
    how.end = 1e10;
    how.max_steps = 6;
    how.snapshots = false;
    omp_set_num_threads(threads);
    assert_int_equal(lac_run(t->problem, &how, NULL, &result, &err), LAC_ENUMERIC); // of the steps
    omp_set_num_threads(1);
    assert_int_equal(result.steps, 6);
    return result.mean_slip;
}

static void a_run_does_not_either(void **state)
{
    (void)state;
    tree t = many_cells();
    double one = time_after_steps(&t, 1), three = time_after_steps(&t, 3);
    assert_memory_equal(&one, &three, sizeof one);
    tree_clear(&t);
}

// Every element belongs to one part, and parts do not depend on the threads.
typedef struct observation {
    unsigned char *times;
    size_t first[LAC_PARTS];
} observation;

static void look(void *context, size_t part, size_t first, size_t end)
{
    observation *s = context;
    s->first[part] = first;
    for (size_t i = first; i < end; i++) {
        s->times[i]++;
    }
}

static void parts_cover_all(void **state)
{
    (void)state;
    const size_t sizes[] = {1,     255, LAC_PARTS_ALONE - 1, LAC_PARTS_ALONE, LAC_PARTS_ALONE + 1,
                            300001};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        observation one = {calloc(sizes[k], 1), {0}}, two = {calloc(sizes[k], 1), {0}};
        omp_set_num_threads(1);
        size_t parts = lac_parallel_for(sizes[k], look, &one);
        omp_set_num_threads(2);
        assert_int_equal(lac_parallel_for(sizes[k], look, &two), parts);
        omp_set_num_threads(1);
        assert_memory_equal(one.first, two.first, sizeof one.first);
        for (size_t i = 0; i < sizes[k]; i++) {
            assert_int_equal(one.times[i], 1);
            assert_int_equal(two.times[i], 1);
        }
        free(one.times);
        free(two.times);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_cover_all),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(a_run_does_not_either),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
