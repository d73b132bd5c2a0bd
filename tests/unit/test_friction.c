// SPDX-License-Identifier: GPL-3.0-or-later

#include <math.h>
#include <string.h>

#include "friction/friction.h"
#include "support/slot.h"
#include "support/test.h"

static lac_model aging_slot(void)
{
    lac_model model;
    assert_int_equal(lac_model_create(&lac_friction_law_get(0)->info, &model, NULL), LAC_OK);
    assert_string_equal(model.info->name, "aging");
    return model;
}

static void required_parameters_have_no_default(void **state)
{
    (void)state;
    lac_model model = aging_slot();
    lac_friction *friction;
    lac_error err;
    assert_int_equal(lac_friction_create(&model, 1, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.a: must be given");
    assert_null(friction);
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0.01);
    test_slot_set(&model, "dc", 0);
    assert_int_equal(lac_friction_create(&model, 1, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.dc: must be >= 1e-18 m");
    test_slot_set(&model, "dc", 1e-4);
    assert_int_equal(lac_friction_create(&model, 1, &friction, &err), LAC_OK);
    assert_true(lac_cellwise_of(&friction->column[LAC_F0], 0) == 0.6 &&
                lac_cellwise_of(&friction->column[LAC_V0], 0) == 1e-6);
    assert_int_equal(friction->form, LAC_FORM_PLAIN);
    lac_friction_free(friction);
    lac_model_clear(&model);
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    lac_model model = aging_slot();
    lac_friction *friction;
    lac_error err;
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0.01);
    test_slot_set(&model, "dc", 1e-4);
    assert_int_equal(lac_friction_create(&model, 0, &friction, &err), LAC_EINPUT);
    assert_int_equal(lac_friction_create(&(lac_model){0}, 1, &friction, &err), LAC_EINPUT);
    test_slot_set(&model, "form", 2);
    assert_int_equal(lac_friction_create(&model, 1, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.form: must be plain or regularised");
    lac_friction_free(NULL);
    lac_model_clear(&model);
}

static void a_bad_cell_is_named_and_changes_nothing(void **state)
{
    (void)state;
    lac_model model = aging_slot();
    lac_friction *friction;
    lac_error err;
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0.015);
    test_slot_set(&model, "dc", 1e-4);
    assert_int_equal(lac_friction_create(&model, 3, &friction, &err), LAC_OK);
    double before = lac_friction_coefficient(friction, 0, -20, 10);
    assert_int_equal(lac_friction_set(friction, "dc", (double[]){1, 1, -2}, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.dc of cell 2: -2 must be >= 1e-18 m");
    assert_int_equal(lac_friction_set(friction, "a", (double[]){1, NAN, 1}, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging.a of cell 1: nan must be a finite number");
    assert_true(lac_friction_coefficient(friction, 0, -20, 10) == before);
    assert_int_equal(lac_friction_set(friction, "form", (double[]){1, 1, 1}, &err), LAC_EINPUT);
    assert_int_equal(lac_friction_set(friction, "A", (double[]){1, 1, 1}, &err), LAC_EINPUT);
    lac_friction_free(friction);
    lac_model_clear(&model);
}

// What a case does not name takes no memory, and can be given cell by cell later.
static void optional_parameters_may_be_absent(void **state)
{
    (void)state;
    static const char *const keys[] = {"v1", "v2", "alpha"};
    lac_model model = aging_slot();
    lac_friction *friction;
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0.015);
    test_slot_set(&model, "dc", 1e-4);
    assert_int_equal(lac_friction_create(&model, 2, &friction, NULL), LAC_OK);
    assert_true(friction->ln_v1.value == NULL && friction->ln_cut.value == NULL &&
                friction->response.value == NULL);
    for (size_t k = 0; k < 3; k++) {
        assert_null(lac_friction_values_of(friction, keys[k]));
        assert_int_equal(lac_friction_set(friction, keys[k], (double[]){1, 2}, NULL), LAC_OK);
        assert_true(lac_cellwise_of(lac_friction_values_of(friction, keys[k]), 1) == 2);
    }
    assert_true(lac_cellwise_of(lac_friction_values_of(friction, "dc"), 0) == 1e-4);
    assert_null(lac_friction_values_of(friction, "form"));
    assert_null(lac_friction_values_of(friction, "nothing"));
    lac_friction_free(friction);
    lac_model_clear(&model);
}

// Strength and evolution of some cells far into the second and third block.
static void evaluate_some(const lac_friction *friction, double out[4][200])
{
    double u[200], w[200], v[200];
    for (size_t i = 0; i < 200; i++) {
        u[i] = -20.0 + 0.1 * (double)i;
        w[i] = 16.0 - 0.1 * (double)i;
        v[i] = exp(u[i]);
    }
    lac_friction_cells cells = {.first = 450, .n = 200, .u = u, .w = w, .v = v, .normal_rate = 1};
    lac_friction_evaluate(friction, &cells, &(lac_friction_values){out[0], out[1], out[2], out[3]},
                          NULL);
}

// What all cells have is stored for one block, and gives the bits of cells with the same each.
static void alike_cells_are_stored_once(void **state)
{
    (void)state;
    enum { CELLS = 1000 };
    static const char *const keys[] = {"f0", "a", "b", "dc", "v0", "v1", "v2", "alpha"};
    static const double value[] = {0.6, 0.01, 0.015, 1e-4, 1e-6, 1e-2, 1e-3, 0.2};
    static double want[4][200], got[4][200], values[CELLS];
    lac_model model = aging_slot();
    lac_friction *friction;
    for (size_t k = 0; k < 8; k++) {
        test_slot_set(&model, keys[k], value[k]);
    }
    assert_int_equal(lac_friction_create(&model, SIZE_MAX / 16, &friction, NULL), LAC_OK);
    lac_friction_free(friction);
    assert_int_equal(lac_friction_create(&model, CELLS, &friction, NULL), LAC_OK);
    assert_true(friction->constant.mask == 0 && friction->response.mask == 0);
    evaluate_some(friction, want);
    for (size_t k = 0; k < 8; k++) {
        for (size_t i = 0; i < CELLS; i++) {
            values[i] = value[k];
        }
        values[449] = values[650] = 2 * value[k]; // beside those evaluated
        assert_int_equal(lac_friction_set(friction, keys[k], values, NULL), LAC_OK);
        assert_true(lac_cellwise_of(lac_friction_values_of(friction, keys[k]), 650) == values[650]);
        evaluate_some(friction, got);
        assert_memory_equal(got, want, sizeof want);
        assert_true((friction->inv_dc.mask == 0) == (k < 3));
    }
    assert_true(lac_cellwise_of(&friction->ln_cut, 650) == log(2e-4) - log(2e-3));
    lac_friction_free(friction);
    lac_model_clear(&model);
}

static void alpha_needs_b(void **state)
{
    (void)state;
    lac_model model = aging_slot();
    lac_friction *friction;
    lac_error err;
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0);
    test_slot_set(&model, "dc", 1e-4);
    test_slot_set(&model, "alpha", 0.2);
    assert_int_equal(lac_friction_create(&model, 2, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging: alpha needs b > 0, through which the state acts on "
                                     "friction");
    test_slot_set(&model, "alpha", 0); // no response needs no b
    assert_int_equal(lac_friction_create(&model, 2, &friction, &err), LAC_OK);
    assert_int_equal(lac_friction_check(friction, &err), LAC_OK);
    assert_true(lac_friction_state_after(friction, 0, 3, 0.5) == 3);
    assert_int_equal(lac_friction_set(friction, "alpha", (double[]){0, 0.1}, &err), LAC_OK);
    assert_int_equal(lac_friction_check(friction, &err), LAC_EINPUT);
    assert_non_null(strstr(err.message, "aging: cell 1 has alpha = 0.1 and b = 0"));
    lac_friction_free(friction);
    lac_model_clear(&model);
}

// The weakening law is the slip law where that weakens, and holds still where it would heal.
static void weakening_never_heals(void **state)
{
    (void)state;
    lac_friction *pair[2] = {NULL};
    for (size_t law = 1; law <= 2; law++) {
        lac_model model;
        assert_int_equal(lac_model_create(&lac_friction_law_get(law)->info, &model, NULL), LAC_OK);
        assert_string_equal(model.info->name, law == 1 ? "slip" : "weakening");
        test_slot_set(&model, "a", 0.01);
        test_slot_set(&model, "b", 0.015);
        test_slot_set(&model, "dc", 1e-4);
        assert_int_equal(lac_friction_create(&model, 1, &pair[law - 1], NULL), LAC_OK);
        lac_model_clear(&model);
    }
    for (double w = -5; w <= 25; w += 0.5) {
        double u = -20, v = exp(u), f[2], f_u[2], f_w[2], g[2], none[3], g_u[2], g_w[2];
        for (size_t k = 0; k < 2; k++) {
            lac_friction_cells cell = {0, 1, &u, &w, &v, 0, NULL};
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

static lac_friction *flashing(double v_w, double f_w, int form)
{
    lac_model model = aging_slot();
    lac_friction *friction;
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0.015);
    test_slot_set(&model, "dc", 1e-4);
    test_slot_set(&model, "form", form);
    test_slot_set(&model, "flash_rate", v_w);
    test_slot_set(&model, "flash_friction", f_w);
    assert_int_equal(lac_friction_create(&model, 1, &friction, NULL), LAC_OK);
    lac_model_clear(&model);
    return friction;
}

// f, f_u, f_w, f_uu, f_uw, f_ww of one cell.
static void strength_at(const lac_friction *friction, double u, double w, double out[6])
{
    double v = exp(u), g, g_u, g_w;
    const lac_friction_cells cell = {.first = 0, .n = 1, .u = &u, .w = &w, .v = &v};
    const lac_friction_values values = {&out[0], &out[1], &out[2], &g};
    const lac_friction_slopes slopes = {&out[3], &out[4], &out[5], &g_u, &g_w};
    lac_friction_evaluate(friction, &cell, &values, &slopes);
}

// Down to the mean of f and f_w at v_w, to f_w far beyond, with derivatives that are those of it.
static void flash_heating_takes_friction_down(void **state)
{
    (void)state;
    const double v_w = 0.1, f_w = 0.2;
    for (int form = LAC_FORM_PLAIN; form <= LAC_FORM_REGULARISED; form++) {
        lac_friction *flash = flashing(v_w, f_w, form), *cold = flashing(1e300, f_w, form);
        for (double u = -25; u <= 6; u += 0.61) {
            const double w = 3 - u / 3, h = 1e-5;
            double at[6], whole[6], up[6], down[6], above[6], below[6];
            strength_at(flash, u, w, at);
            strength_at(cold, u, w, whole);
            double exact = f_w + (whole[0] - f_w) / (1 + exp(u) / v_w);
            assert_true(fabs(at[0] - exact) <= 1e-14);
            assert_true(at[0] == lac_friction_coefficient(flash, 0, u, w));
            strength_at(flash, u + h, w, up);
            strength_at(flash, u - h, w, down);
            strength_at(flash, u, w + h, above);
            strength_at(flash, u, w - h, below);
            for (int k = 0; k < 2; k++) { // f by u, f_u by u; f by w, f_u by w
                const int by_u[] = {1, 3}, by_w[] = {2, 4};
                assert_true(fabs((up[k] - down[k]) / (2 * h) - at[by_u[k]]) <= 1e-9);
                assert_true(fabs((above[k] - below[k]) / (2 * h) - at[by_w[k]]) <= 1e-9);
            }
            assert_true(fabs((above[2] - below[2]) / (2 * h) - at[5]) <= 1e-9);
            double back = lac_friction_state_for(flash, 0, u, at[0]);
            assert_true(fabs(back - w) <= 1e-9 * (1 + exp(u) / v_w));
        }
        assert_true(fabs(lac_friction_coefficient(flash, 0, log(1e9), 0) - f_w) <= 1e-8);
        lac_friction_free(flash);
        lac_friction_free(cold);
    }
}

// The slowest root, and none where no rate carries so much.
static void flash_heating_leaves_the_slow_rate(void **state)
{
    (void)state;
    lac_friction *flash = flashing(0.1, 0.2, LAC_FORM_PLAIN);
    const double w = log(1.0), p = 2e6;
    for (double u = -30; u <= -4; u += 1.3) {
        double tau = p * lac_friction_coefficient(flash, 0, u, w);
        double slope[6];
        strength_at(flash, u, w, slope);
        double found = lac_friction_rate_for(flash, 0, w, tau, p, 0);
        assert_true(slope[1] <= 0 || fabs(found - u) <= 1e-10 / slope[1]);
    }
    assert_true(isnan(lac_friction_rate_for(flash, 0, w, p * 0.9, p, 0)));
    lac_friction_free(flash);
}

static void flash_heating_is_given_whole(void **state)
{
    (void)state;
    lac_model model = aging_slot();
    lac_friction *friction;
    lac_error err;
    test_slot_set(&model, "a", 0.01);
    test_slot_set(&model, "b", 0.01);
    test_slot_set(&model, "dc", 1e-4);
    test_slot_set(&model, "flash_rate", 0.1);
    assert_int_equal(lac_friction_create(&model, 1, &friction, &err), LAC_EINPUT);
    assert_string_equal(err.message, "aging: flash_rate and flash_friction go together: give both "
                                     "or neither");
    lac_model_clear(&model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flash_heating_takes_friction_down),
        cmocka_unit_test(flash_heating_leaves_the_slow_rate),
        cmocka_unit_test(flash_heating_is_given_whole),
        cmocka_unit_test(required_parameters_have_no_default),
        cmocka_unit_test(nonsense_is_refused),
        cmocka_unit_test(optional_parameters_may_be_absent),
        cmocka_unit_test(alike_cells_are_stored_once),
        cmocka_unit_test(alpha_needs_b),
        cmocka_unit_test(a_bad_cell_is_named_and_changes_nothing),
        cmocka_unit_test(weakening_never_heals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
