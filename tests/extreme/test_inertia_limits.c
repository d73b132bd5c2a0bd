// SPDX-License-Identifier: GPL-3.0-or-later
// Masses over sixty decades, with and without damping, of one cell and of many: the right answer,
// or an error that says what happened.
#include <string.h>

#include <math.h>

#include "support/one_cell.h"
#include "support/test.h"
#include "support/tree.h"

static const double masses[] = {0.0, 1e-30, 1e-10, 1.0, 1e4, 1e10, 1e30};
enum { MASSES = sizeof masses / sizeof masses[0] };

static one_cell_outcome creep(const tree_def *def, double end)
{
    tree t;
    lac_run_def how = lac_run_default();
    how.end = end;
    how.rtol = 1e-6;
    how.max_steps = 100000;
    tree_create(def, &t);
    one_cell_outcome out = watched_run(t.problem, &how);
    tree_clear(&t);
    return out;
}

// Cells that creep to failure: a light mass fails with those that have none, a heavy one later, the
// heaviest goes on as it was.
static void masses_of_every_size(void **state)
{
    (void)state;
    const double parts[] = {1.0, 1e-6};
    for (size_t i = 0; i < 2 * 2 * 3; i++) {
        tree_def def = tree_default((int)(i % 3), 1); // 1, a few, some ten cells
        def.damping = i / 3 % 2 == 0 ? 0.0 : def.damping;
        def.columns = parts[i / 6];
        def.state = 3e4;
        double last = 0.0;
        double without = 0.0;
        for (size_t m = 0; m < MASSES; m++) {
            def.mass = masses[m];
            if (def.levels > 0 && masses[m] == 1e10) {
                continue; // cells swing against each other for hours, every swing resolved
            }
            one_cell_outcome out = creep(&def, 2e4);
            if (out.status != LAC_OK) {
                fail_msg("mass %g, damping %g, columns %g: %s", masses[m], def.damping, def.columns,
                         out.message);
            }
            assert_true(out.finite);
            assert_true(out.result.failed == (masses[m] < 1e30));
            without = m == 0 ? out.result.time : without;
            if (masses[m] > 0.0 && masses[m] <= 1e-10) {
                assert_true(fabs(out.result.time / without - 1.0) < 1e-4);
            }
            assert_true(out.result.time >= last * (1.0 - 1e-4));
            last = out.result.time;
        }
        assert_true(fabs(last / 2e4 - 1.0) < 1e-12); // the heaviest: to the end
    }
}

// What a mass cannot be, and what does not go with one.
static void wrong_masses(void **state)
{
    (void)state;
    const struct {
        double mass, columns;
        lac_formulation formulation;
        const char *message;
    } wrong[] = {
        {-1.0, 1.0, LAC_FORMULATION_AUTO, "a block of -1 kg/m2"},
        {NAN, 1.0, LAC_FORMULATION_AUTO, "a block of nan kg/m2"},
        {INFINITY, 1.0, LAC_FORMULATION_AUTO, "a block of inf kg/m2"},
        {1.0, 0.0, LAC_FORMULATION_AUTO, "with 0 of it in columns"},
        {1.0, 1.5, LAC_FORMULATION_AUTO, "with 1.5 of it in columns"},
        {1.0, NAN, LAC_FORMULATION_AUTO, "with nan of it in columns"},
        {0.0, 1.0, LAC_FORMULATION_INERTIA, "a block of 0 kg/m2"},
        {1.0, 1.0, LAC_FORMULATION_SLIP, "the formulation \"slip\" knows no inertia"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        lac_error err = {""};
        lac_problem *problem = NULL;
        tree_def def = tree_default(1, 1);
        tree t;
        tree_create(&def, &t);
        double start[8] = {0};
        lac_problem_def made = {.domain = t.domain,
                                .friction = t.friction,
                                .transfer = &t.transfer,
                                .mass = wrong[i].mass,
                                .columns = wrong[i].columns,
                                .log_rate = start,
                                .log_state = start + 4,
                                .formulation = wrong[i].formulation};
        assert_int_equal(lac_problem_create(&made, &problem, &err), LAC_EINPUT);
        assert_null(problem);
        if (strstr(err.message, wrong[i].message) == NULL) {
            fail_msg("%s", err.message);
        }
        tree_clear(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(masses_of_every_size),
        cmocka_unit_test(wrong_masses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
