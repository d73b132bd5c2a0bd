// SPDX-License-Identifier: GPL-3.0-or-later
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka needs the headers above first
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "lacuna/friction.h"
#include "support/slot.h"

static lac_slot aging_slot(void)
{
    lac_slot slot;
    assert_int_equal(lac_slot_create(&lac_friction_law_at(0)->about, &slot, NULL), LAC_OK);
    assert_string_equal(slot.about->name, "aging");
    return slot;
}

static void required_parameters_have_no_default(void **state)
{
    (void)state;
    lac_slot slot = aging_slot();
    lac_friction *friction;
    lac_error err;
    assert_int_equal(lac_friction_create(&slot, 1, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.a: must be given");
    assert_null(friction);
    test_slot_set(&slot, "a", 0.01);
    test_slot_set(&slot, "b", 0.01);
    test_slot_set(&slot, "dc", 0);
    assert_int_equal(lac_friction_create(&slot, 1, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.dc: must be > 0 m");
    test_slot_set(&slot, "dc", 1e-4);
    assert_int_equal(lac_friction_create(&slot, 1, &friction, &err), LAC_OK);
    assert_true(friction->column[LAC_F0][0] == 0.6 && friction->column[LAC_V0][0] == 1e-6);
    assert_int_equal(friction->form, LAC_FORM_PLAIN);
    lac_friction_free(friction);
    lac_slot_clear(&slot);
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    lac_slot slot = aging_slot();
    lac_friction *friction;
    lac_error err;
    test_slot_set(&slot, "a", 0.01);
    test_slot_set(&slot, "b", 0.01);
    test_slot_set(&slot, "dc", 1e-4);
    assert_int_equal(lac_friction_create(&slot, 0, &friction, &err), LAC_EINPUT);
    assert_int_equal(lac_friction_create(&(lac_slot){0}, 1, &friction, &err), LAC_EINPUT);
    assert_int_equal(lac_friction_create(&slot, SIZE_MAX / 16, &friction, &err), LAC_ENOMEM);
    test_slot_set(&slot, "form", 2);
    assert_int_equal(lac_friction_create(&slot, 1, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.form: must be plain or regularised");
    lac_friction_free(NULL);
    lac_slot_clear(&slot);
}

static void a_bad_cell_is_named_and_changes_nothing(void **state)
{
    (void)state;
    lac_slot slot = aging_slot();
    lac_friction *friction;
    lac_error err;
    test_slot_set(&slot, "a", 0.01);
    test_slot_set(&slot, "b", 0.015);
    test_slot_set(&slot, "dc", 1e-4);
    assert_int_equal(lac_friction_create(&slot, 3, &friction, &err), LAC_OK);
    double before = lac_friction_coefficient(friction, 0, -20, 10);
    assert_int_equal(lac_friction_set(friction, "dc", (double[]){1, 1, -2}, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.dc of cell 2: -2 must be > 0 m");
    assert_int_equal(lac_friction_set(friction, "a", (double[]){1, NAN, 1}, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.a of cell 1: nan must be a finite number");
    assert_true(lac_friction_coefficient(friction, 0, -20, 10) == before);
    assert_int_equal(lac_friction_set(friction, "form", (double[]){1, 1, 1}, &err), LAC_EINPUT);
    assert_int_equal(lac_friction_set(friction, "A", (double[]){1, 1, 1}, &err), LAC_EINPUT);
    lac_friction_free(friction);
    lac_slot_clear(&slot);
}

// The weakening law is the slip law where that weakens, and holds still where it would heal.
static void weakening_never_heals(void **state)
{
    (void)state;
    lac_friction *pair[2] = {NULL};
    for (size_t law = 1; law <= 2; law++) {
        lac_slot slot;
        assert_int_equal(lac_slot_create(&lac_friction_law_at(law)->about, &slot, NULL), LAC_OK);
        assert_string_equal(slot.about->name, law == 1 ? "slip" : "weakening");
        test_slot_set(&slot, "a", 0.01);
        test_slot_set(&slot, "b", 0.015);
        test_slot_set(&slot, "dc", 1e-4);
        assert_int_equal(lac_friction_create(&slot, 1, &pair[law - 1], NULL), LAC_OK);
        lac_slot_clear(&slot);
    }
    for (double w = -5; w <= 25; w += 0.5) {
        double u = -20, v = exp(u), f[2], f_u[2], f_w[2], g[2], none[3], g_u[2], g_w[2];
        for (size_t k = 0; k < 2; k++) {
            lac_friction_cells cell = {0, 1, &u, &w, &v};
            lac_friction_values values = {&f[k], &f_u[k], &f_w[k], &g[k]};
            lac_friction_slopes slopes = {&none[0], &none[1], &none[2], &g_u[k], &g_w[k]};
            lac_friction_evaluate(pair[k], &cell, &values, &slopes);
        }
        bool weakens = u + w > log(1e-4);
        assert_true(f[0] == f[1] && (g[0] < 0) == weakens);
        assert_true(g[1] == (weakens ? g[0] : 0));
        assert_true(g_u[1] == (weakens ? g_u[0] : 0) && g_w[1] == (weakens ? g_w[0] : 0));
    }
    lac_friction_free(pair[0]);
    lac_friction_free(pair[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(required_parameters_have_no_default),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(a_bad_cell_is_named_and_changes_nothing),
        cmocka_unit_test(weakening_never_heals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
