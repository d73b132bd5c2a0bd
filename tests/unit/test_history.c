// SPDX-License-Identifier: GPL-3.0-or-later
// Histories of a joint that is in full contact under uniform pressure: it is rigid until it slides
// as a whole, so that every load, shift and work has a closed form.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/scene.h"
#include "support/test.h"

// Side 2 m, f P = 500 Pa: Q is 2000 N where it slides.
static const double sliding_force = 2000.0, nominal_area = 4.0, held = 500.0;

enum { MOST = 32, CELLS = 16 };

typedef struct witness {
    lac_history_record record[MOST];
    lac_cell_state state[MOST]; // of cell 0 where maps came
    size_t steps, maps, stop_after, fail_after;
} witness;

static lac_status on_step(void *context, const lac_history_record *record, lac_error *err)
{
    witness *w = context;
    assert_true(w->steps < MOST);
    w->record[w->steps++] = *record;
    return w->steps == w->fail_after ? lac_fail(err, LAC_EIO, "no room") : LAC_OK;
}

static lac_status on_maps(void *context, const lac_history_maps *maps, lac_error *err)
{
    witness *w = context;
    double sum = 0;
    (void)err;
    for (size_t i = 0; i < CELLS; i++) {
        sum += maps->traction[0][i] * nominal_area / CELLS;
        assert_true(fabs(maps->pressure[i] / w->record[w->steps - 1].pressure - 1) < 1e-12);
    }
    assert_true(fabs(sum - w->record[w->steps - 1].shear.traction[0] * nominal_area) < 1e-6);
    w->state[w->maps++] = (lac_cell_state)maps->state[0];
    return LAC_OK;
}

static bool on_interrupted(void *context)
{
    const witness *w = context;
    return w->stop_after > 0 && w->steps == w->stop_after;
}

static lac_status follow(const char *keys, const char *steps, witness *w, lac_error *err)
{
    char text[1000];
    lac_case *c = NULL;
    lac_case_issues report;
    lac_scene_contact contact;
    lac_history_result result;
    const lac_case_request how = {.purpose = LAC_FOR_CONTACT};
    (void)snprintf(text, sizeof text,
                   "lacuna: 1\n"
                   "interface: {size: 2, levels: 2, domain: {full: {}}}\n"
                   "material: {shear_modulus: 1e6, poisson: 0.2}\n"
                   "load: {normal: {pressure: 1000}, history: {friction: 0.5, %ssteps: [%s]}}\n",
                   keys, steps);
    lac_status status = lac_case_read_text("x.yaml", text, strlen(text), &how, &c, &report, err);
    lac_case_issues_clear(&report);
    if (status != LAC_OK) {
        fail_msg("%s", err->message);
    }
    assert_int_equal(lac_scene_contact_solve(c, LAC_SCENE_MEASURED, &contact, err), LAC_OK);
    const lac_history_sink sink = {
        .context = w, .step = on_step, .maps = on_maps, .interrupted = on_interrupted};
    status = lac_scene_history_run(c, &contact, &sink, &result, err);
    assert_int_equal(result.steps, w->steps);
    assert_int_equal(result.planned, lac_scene_history_steps(c));
    lac_scene_contact_clear(&contact);
    lac_case_free(c);
    return status;
}

static void follow_all(const char *steps, size_t count, witness *w)
{
    lac_error err = {""};
    *w = (witness){0};
    if (follow("", steps, w, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    assert_int_equal(w->steps, count);
    assert_int_equal(w->maps, count);
}

static void is(double value, double expected, double scale)
{
    if (!(fabs(value - expected) <= 1e-7 * scale)) {
        fail_msg("%.12g is not %.12g", value, expected);
    }
}

// Forces, shifts and work of a step.
static void step_is(const witness *w, size_t at, double qx, double qy, double sx, double sy,
                    double work)
{
    const lac_history_record *r = &w->record[at];
    is(r->shear.traction[0], qx, held);
    is(r->shear.traction[1], qy, held);
    is(r->shear.shift[0], sx, 1e-3);
    is(r->shear.shift[1], sy, 1e-3);
    is(r->shear.dissipation, work, 1.0);
}

static void sticks_below_the_limit_and_slides_at_it(void **state)
{
    (void)state;
    witness w;
    follow_all("{ratio_x: 0.5}, {ratio_y: -0.4}, {shift_x: 1e-3, shift_y: 0}", 3, &w);
    step_is(&w, 0, 250, 0, 0, 0, 0);
    step_is(&w, 1, 250, -200, 0, 0, 0);
    step_is(&w, 2, 500, 0, 1e-3, 0, sliding_force * 1e-3);
    assert_true(w.state[0] == LAC_CELL_STICK && w.state[2] == LAC_CELL_SLIP);
    is(w.record[0].shear.highest_ratio, 0.5, 1);
    is(w.record[1].shear.highest_ratio, hypot(0.5, 0.4), 1);
    assert_true(w.record[0].highest[0] > 0 && w.record[0].highest[0] < 2);
    assert_true(isnan(w.record[2].highest[0]) && isnan(w.record[2].highest[1]));
}

static void increments_divide_loads_and_shifts_equally(void **state)
{
    (void)state;
    witness w;
    follow_all("{shift_x: 1e-3, count: 4}, {ratio_x: 0.2, pressure: 2000, count: 2}", 6, &w);
    for (size_t i = 0; i < 4; i++) {
        step_is(&w, i, 500, 0, 0.25e-3 * (double)(i + 1), 0, sliding_force * 0.25e-3);
        is(w.record[i].dissipated, sliding_force * 0.25e-3 * (double)(i + 1), 1.0);
    }
    // From the load that the slide had come to, half way to 0.2 of the new limit.
    is(w.record[4].pressure, 1500, 1);
    step_is(&w, 4, 350, 0, 1e-3, 0, 0);
    is(w.record[5].pressure, 2000, 1);
    step_is(&w, 5, 200, 0, 1e-3, 0, 0);
}

static void what_a_step_does_not_name_stays(void **state)
{
    (void)state;
    witness w;
    follow_all("{ratio_x: 0.4, ratio_y: 0.2}, {pressure: 3000}, {shift_x: 1e-3}, {pressure: 500}, "
               "{shift_x: -1e-3}",
               5, &w);
    step_is(&w, 0, 200, 100, 0, 0, 0);
    step_is(&w, 1, 200, 100, 0, 0, 0); // the traction, not the ratio
    assert_true(w.record[2].shear.shift[0] > 0.999e-3);
    is(w.record[2].shear.traction[1], 100, held);
    is(hypot(w.record[2].shear.traction[0], 100), 1500, held); // y is held within the limit
    is(w.record[3].shear.shift[0], 1e-3, 1e-3);
    is(hypot(w.record[4].shear.traction[0], 100), 250, held);
    assert_true(w.record[4].shear.traction[0] < 0);
}

static void traction_follows_the_direction_of_slip(void **state)
{
    (void)state;
    witness w;
    follow_all("{shift_x: 3e-3, shift_y: 4e-3}, {shift_y: 6e-3}, {shift_x: 1e-3}", 3, &w);
    step_is(&w, 0, 300, 400, 3e-3, 4e-3, sliding_force * 5e-3);
    step_is(&w, 1, 0, 500, 3e-3, 6e-3, sliding_force * 2e-3);
    step_is(&w, 2, -500, 0, 1e-3, 6e-3, sliding_force * 2e-3);
}

static void cycles_are_told_with_their_work(void **state)
{
    (void)state;
    witness w;
    follow_all("{shift_x: 1e-3}, {shift_x: -1e-3, count: 2}, {shift_x: 1e-3, count: 2}, "
               "{shift_x: 1e-3}, {pressure: 2000}, {pressure: 1000}, {shift_x: 0.5e-3}, "
               "{shift_x: 0, shear_y: 0}",
               10, &w);
    static const size_t starts[] = {SIZE_MAX, 0, SIZE_MAX, 2, 1, 1, SIZE_MAX, 6, SIZE_MAX, 4};
    for (size_t i = 0; i < 10; i++) {
        if (w.record[i].cycle_start != starts[i]) {
            fail_msg("step %zu comes back to %zu", i + 1, w.record[i].cycle_start);
        }
        assert_true(isnan(w.record[i].cycle_dissipation) == (starts[i] == SIZE_MAX));
    }
    is(w.record[4].cycle_dissipation, sliding_force * 4e-3, 1.0);
    is(w.record[5].cycle_dissipation, sliding_force * 4e-3, 1.0);
    is(w.record[4].cycle_shift, 0, 1e-3);
}

static void shift_left_over_by_a_load_cycle(void **state)
{
    (void)state;
    witness w;
    follow_all("{shift_x: 1e-3}, {shear_x: 0}", 2, &w);
    assert_int_equal(w.record[1].cycle_start, 0);
    is(w.record[1].cycle_shift, 1e-3, 1e-3);
    is(w.record[1].cycle_dissipation, sliding_force * 1e-3, 1.0);
}

static void unloading_comes_back_to_the_start(void **state)
{
    (void)state;
    witness w;
    follow_all("{ratio_x: 0.5}, {ratio_x: 0}, {ratio_x: 0}, {ratio_x: 0.5}", 4, &w);
    assert_true(w.record[0].cycle_start == SIZE_MAX);
    assert_int_equal(w.record[1].cycle_start, 0);
    assert_int_equal(w.record[2].cycle_start, 0); // resting closes no cycle of its own
    assert_int_equal(w.record[3].cycle_start, 1);
    is(w.record[3].cycle_dissipation, 0, 1.0);
}

static void what_was_reached_is_kept_when_it_ends_early(void **state)
{
    (void)state;
    static const char steps[] = "{ratio_x: 0.5, count: 5}";
    lac_error err = {""};
    witness w = {.stop_after = 3};
    assert_int_equal(follow("fields: last, ", steps, &w, &err), LAC_EINTERRUPT);
    assert_true(w.steps == 3 && w.maps == 1);
    w = (witness){.stop_after = 3};
    assert_int_equal(follow("fields: none, ", steps, &w, &err), LAC_EINTERRUPT);
    assert_true(w.steps == 3 && w.maps == 0);
    w = (witness){.fail_after = 2};
    assert_int_equal(follow("", steps, &w, &err), LAC_EIO);
    assert_true(w.steps == 2 && w.maps == 1);
    assert_string_equal(err.message, "no room");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sticks_below_the_limit_and_slides_at_it),
        cmocka_unit_test(increments_divide_loads_and_shifts_equally),
        cmocka_unit_test(what_a_step_does_not_name_stays),
        cmocka_unit_test(traction_follows_the_direction_of_slip),
        cmocka_unit_test(cycles_are_told_with_their_work),
        cmocka_unit_test(shift_left_over_by_a_load_cycle),
        cmocka_unit_test(unloading_comes_back_to_the_start),
        cmocka_unit_test(what_was_reached_is_kept_when_it_ends_early),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
