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

static char *sums_before(const lac_case *c)
{
    (void)c;
    return strdup("files:\n  a.csv: 12\n  b.csv: 34\n");
}

static char *sums_after(const lac_case *c)
{
    (void)c;
    return strdup("files:\n  a.csv: 12\n  b.csv: 56\n");
}

// A file that is changed while the members are run is named.
static void test_changed_file(void **state)
{
    (void)state;
    static const char *const over[] = {"friction.aging.dc=4 um, 8 um"};
    const lac_sweep_request ask = {
        .path = CREEP, .over = over, .varied = 1, .until = (double)NAN, .files = sums_before};
    lac_sweep *sweep = NULL;
    lac_error err = {""};
    assert_int_equal(lac_sweep_create(&ask, &sweep, &err), LAC_OK);
    assert_int_equal(lac_sweep_check_files(sweep, sums_before, &err), LAC_OK);
    assert_int_equal(lac_sweep_check_files(sweep, sums_after, &err), LAC_EIO);
    assert_non_null(strstr(err.message, "b.csv was changed"));
    lac_sweep_free(sweep);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_follows),
                                       cmocka_unit_test(test_changed_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
