// SPDX-License-Identifier: GPL-3.0-or-later
// The case of a member is that which is read with its values, also where reading makes others from
// them.
#include "support/test.h"
#include "sweep/ensemble.h"

#define CREEP LACUNA_SOURCE_DIR "/cases/rg/creep-to-failure.yaml"

// rg.friction is f0 where the case does not say; a number that nothing follows from is set alone.
static void test_what_follows(void **state)
{
    (void)state;
    static const lac_override sets[] = {{"interface.levels", "2"}, {"rg.rule", "cons"}};
    static const char *const over[] = {"friction.aging.f0=0.4, 0.6",
                                       "friction.aging.dc=4 um, 8 um"};
    const lac_sweep_request ask = {.path = CREEP,
                                   .overrides = sets,
                                   .count = 2,
                                   .over = over,
                                   .varied = 2,
                                   .until = (double)NAN};
    lac_sweep *sweep = NULL;
    lac_error err = {""};
    if (lac_sweep_create(&ask, &sweep, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    assert_true(sweep->param[0].anew && !sweep->param[1].anew);
    for (size_t member = 0; member < 4; member++) {
        const lac_case *c = NULL;
        assert_int_equal(lac_sweep_case(sweep, member, &c, &err), LAC_OK);
        const lac_friction_params *law = c->friction.params;
        assert_true(law->f0 == (member < 2 ? 0.4 : 0.6));
        assert_true(c->rg.friction == law->f0);
        assert_true(law->dc == (member % 2 == 0 ? 4e-6 : 8e-6));
    }
    lac_sweep_free(sweep);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_follows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
