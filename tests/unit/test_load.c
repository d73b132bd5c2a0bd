// SPDX-License-Identifier: GPL-3.0-or-later

#include <math.h>
#include <string.h>

#include "load/load.h"
#include "support/slot.h"
#include "support/test.h"

enum { DAY = 86400 };

static const lac_load_kind *shear_named(const char *name)
{
    for (size_t i = 0; lac_shear_load_get(i) != NULL; i++) {
        if (strcmp(lac_shear_load_get(i)->info.name, name) == 0) {
            return lac_shear_load_get(i);
        }
    }
    fail_msg("no shear load %s", name);
    return NULL;
}

static double mean_pressure(const char *name, const char *key, double value, const char *other,
                            double other_value, double density)
{
    for (size_t i = 0; lac_normal_load_get(i) != NULL; i++) {
        const lac_normal_load *load = lac_normal_load_get(i);
        if (strcmp(load->info.name, name) == 0) {
            lac_model model;
            assert_int_equal(lac_model_create(&load->info, &model, NULL), LAC_OK);
            test_slot_set(&model, key, value);
            if (other != NULL) {
                test_slot_set(&model, other, other_value);
            }
            double pressure = load->pressure(model.params, density);
            assert_int_equal(load->needs_density, !isnan(density));
            lac_model_clear(&model);
            return pressure;
        }
    }
    fail_msg("no normal load %s", name);
    return NAN;
}

static void normal_loads(void **state)
{
    (void)state;
    assert_true(mean_pressure("pressure", "value", 3e6, NULL, 0, NAN) == 3e6);
    double overburden = mean_pressure("depth", "value", 100, NULL, 0, 2700);
    assert_true(fabs(overburden - 2647795.5) < 1e-6);
    // a level slope is an overburden; at 60 degrees a quarter of it is left
    double level = mean_pressure("slope", "thickness", 100, "angle", 0, 2700);
    assert_true(fabs(level - overburden) < 1e-6);
    double steep = mean_pressure("slope", "thickness", 100, "angle", acos(0.5), 2700);
    assert_true(fabs(steep - overburden / 4) < 1e-6);
}

static lac_model slot_of(const char *name)
{
    lac_model model;
    assert_int_equal(lac_model_create(&shear_named(name)->info, &model, NULL), LAC_OK);
    return model;
}

static lac_load_state shear_at(const lac_model *model, double t)
{
    lac_load_state sum;
    lac_load_set set = test_load_set(&(lac_load_models){.shear = model, .shear_count = 1});
    lac_load_evaluate(&set, t, &sum);
    lac_load_set_clear(&set);
    return sum;
}

static double break_after(const lac_model *model, double t)
{
    lac_load_set set = test_load_set(&(lac_load_models){.shear = model, .shear_count = 1});
    double next = lac_load_next_break(&set, t);
    lac_load_set_clear(&set);
    return next;
}

static void constant_loads(void **state)
{
    (void)state;
    lac_model ratio = slot_of("ratio"), slope = slot_of("slope"), pore;
    test_slot_set(&ratio, "value", 0.58);
    test_slot_set(&slope, "angle", atan(0.75));
    lac_load_state sum = shear_at(&ratio, 5);
    assert_true(sum.ratio == 0.58 && sum.ratio_rate == 0 && sum.stress == 0);
    assert_true(fabs(shear_at(&slope, 5).ratio - 0.75) < 1e-15);
    assert_true(shear_named("ratio")->fixes_shear && shear_named("slope")->fixes_shear);
    assert_false(shear_named("ramp")->fixes_shear || shear_named("spring")->fixes_shear);
    assert_true(break_after(&ratio, -1) == INFINITY);

    assert_int_equal(lac_model_create(&lac_pore_load_get(0)->info, &pore, NULL), LAC_OK);
    test_slot_set(&pore, "value", 2e5);
    lac_load_set set = test_load_set(&(lac_load_models){.pore = &pore, .pore_count = 1});
    lac_load_evaluate(&set, 3, &sum);
    lac_load_set_clear(&set);
    assert_true(sum.pore == 2e5 && sum.pore_rate == 0 && sum.ratio == 0);
    lac_model_clear(&ratio);
    lac_model_clear(&slope);
    lac_model_clear(&pore);
}

static void a_ramp_starts_holds_and_ends(void **state)
{
    (void)state;
    lac_model ramp = slot_of("ramp");
    test_slot_set(&ramp, "rate", 2);
    assert_true(shear_at(&ramp, 10).stress == 20 && shear_at(&ramp, 1e9).stress_rate == 2);
    assert_true(break_after(&ramp, -1) == 0 && break_after(&ramp, 0) == INFINITY);
    test_slot_set(&ramp, "start", 100);
    test_slot_set(&ramp, "end", 150);
    assert_true(shear_at(&ramp, 99).stress == 0 && shear_at(&ramp, 99).stress_rate == 0);
    assert_true(shear_at(&ramp, 100).stress == 0 && shear_at(&ramp, 100).stress_rate == 2);
    assert_true(shear_at(&ramp, 120).stress == 40);
    assert_true(shear_at(&ramp, 150).stress == 100 && shear_at(&ramp, 150).stress_rate == 0);
    assert_true(shear_at(&ramp, 1e9).stress == 100);
    assert_true(break_after(&ramp, 0) == 100 && break_after(&ramp, 100) == 150);
    assert_true(break_after(&ramp, 150) == INFINITY);
    test_slot_set(&ramp, "share", 1); // the same on every cell, as a spring's
    lac_load_state equal = shear_at(&ramp, 120);
    assert_true(equal.spring_stress == 40 && equal.spring_rate == 2 && equal.spring_stiffness == 0);
    assert_true(equal.stress == 0 && equal.stress_rate == 0);
    assert_true(shear_at(&ramp, 1e9).spring_stress == 100 && shear_at(&ramp, 1e9).spring_rate == 0);
    test_slot_set(&ramp, "end", 50); // ends before it starts: it never is
    assert_true(shear_at(&ramp, 120).stress == 0 && break_after(&ramp, 0) == INFINITY);
    lac_model_clear(&ramp);
}

static void a_spring_is_pulled(void **state)
{
    (void)state;
    lac_model spring = slot_of("spring");
    test_slot_set(&spring, "stiffness", 1e8);
    test_slot_set(&spring, "speed", 1e-9);
    lac_load_state sum = shear_at(&spring, DAY);
    assert_true(sum.spring_stiffness == 1e8);
    assert_true(fabs(sum.spring_stress - 8640) < 1e-9 && fabs(sum.spring_rate - 0.1) < 1e-15);
    assert_true(sum.stress == 0 && sum.ratio == 0);
    lac_model_clear(&spring);
}

static void loads_add_up(void **state)
{
    (void)state;
    lac_model shear[4] = {slot_of("spring"), slot_of("ramp"), slot_of("ramp"), slot_of("spring")};
    test_slot_set(&shear[0], "stiffness", 3);
    test_slot_set(&shear[0], "speed", 2);
    test_slot_set(&shear[1], "rate", 5);
    test_slot_set(&shear[2], "rate", -1);
    test_slot_set(&shear[2], "start", 7);
    test_slot_set(&shear[3], "stiffness", 4);
    test_slot_set(&shear[3], "speed", 0);
    lac_load_set set = test_load_set(&(lac_load_models){.shear = shear, .shear_count = 4});
    lac_load_state sum;
    lac_load_evaluate(&set, 10, &sum);
    assert_true(sum.stress == 47 && sum.stress_rate == 4);
    assert_true(sum.spring_stiffness == 7 && sum.spring_stress == 60 && sum.spring_rate == 6);
    assert_true(lac_load_next_break(&set, 1) == 7 && lac_load_next_break(&set, 7) == INFINITY);
    lac_load_set_clear(&set);
    for (size_t i = 0; i < 4; i++) {
        lac_model_clear(&shear[i]);
    }
    lac_load_evaluate(&(lac_load_set){0}, 10, &sum);
    assert_true(sum.stress == 0 && lac_load_next_break(&(lac_load_set){0}, 0) == INFINITY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normal_loads),
        cmocka_unit_test(constant_loads),
        cmocka_unit_test(a_ramp_starts_holds_and_ends),
        cmocka_unit_test(a_spring_is_pulled),
        cmocka_unit_test(loads_add_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
