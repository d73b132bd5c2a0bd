// SPDX-License-Identifier: GPL-3.0-or-later
// A run kept in memory: what it holds, what is refused, and a stop.
#include <stdio.h>
#include <string.h>

#include <math.h>

#include "simulation/simulation.h"
#include "support/test.h"

#define BLOCK LACUNA_SOURCE_DIR "/cases/block.yaml"

static lac_recorded find(const lac_recording *recording, const char *name)
{
    lac_recorded seen = {0};
    assert_true(lac_recording_find(recording, name, &seen));
    return seen;
}

static void test_a_block(void **state)
{
    (void)state;
    lac_recording *recording = NULL;
    lac_error err = {0};
    const char *const sets[] = {"friction.aging.dc=2 um", "time.end=1 s"};
    assert_int_equal(lac_record_case(BLOCK, 2, sets, NULL, &recording, &err), LAC_OK);
    lac_recorded time = find(recording, "time"), slip = find(recording, "slip"), last;
    assert_string_equal(time.dimensions, "time");
    assert_string_equal(slip.unit, "m");
    assert_int_equal(time.count, slip.count);
    assert_int_equal(time.count, (size_t)find(recording, "steps").values[0] + 1);
    assert_true(time.values[0] == 0 && time.values[time.count - 1] == 1);
    assert_true(slip.values[0] == 0 && slip.values[slip.count - 1] > 0);
    assert_true(isnan(find(recording, "order").values[0]));
    assert_true(find(recording, "failed").values[0] == 0);
    assert_true(isnan(find(recording, "failure_time").values[0]));
    assert_int_equal(find(recording, "pressure").count, 1);
    assert_false(lac_recording_find(recording, "event_time", &last));
    assert_false(lac_recording_at(recording, 1000, &last));
    lac_recording_free(recording);
}

static void expect_refused(const char *path, const char *set, lac_status status, const char *why)
{
    lac_recording *recording = NULL;
    lac_error err = {0};
    assert_int_equal(lac_record_case(path, 1, &set, NULL, &recording, &err), status);
    assert_null(recording);
    if (strstr(err.message, why) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", err.message, why);
    }
}

static void test_refused(void **state)
{
    (void)state;
    expect_refused(BLOCK, "friction.aging.dc=-1 um", LAC_EINPUT, "must be >= 1e-18 m");
    expect_refused(BLOCK, "friction.aging.dx=1", LAC_EINPUT, "did you mean \"dc\"?");
    expect_refused(BLOCK, "=1", LAC_EINPUT, "key.path=value");
    expect_refused(BLOCK, "title", LAC_EINPUT, "key.path=value");
    expect_refused(BLOCK, "solver.max_steps=3", LAC_ENUMERIC, "3 steps");
    expect_refused(BLOCK "s", "title=x", LAC_EIO, "block.yamls");
}

// A case from memory is that from its file; messages name it as the caller does.
static void test_from_memory(void **state)
{
    (void)state;
    static const char text[] =
        "{\"lacuna\": 1, \"load\": {\"normal\": {\"pressure\": 3e6}}, \"friction\": {\"aging\": "
        "{\"a\": 0.01, \"b\": 0.015, \"dc\": \"5 mm\"}}, \"time\": {\"end\": \"2 s\"}}, left out";
    const size_t size = sizeof text - sizeof ", left out";
    const char *const sets[] = {"time.end=1 s", "initial={slip_rate: 1 cm/week, state: steady}"};
    lac_recording *recording = NULL;
    lac_error err = {0};
    assert_int_equal(lac_record_case_text("mine", text, size, 2, sets, NULL, &recording, &err),
                     LAC_OK);
    const lac_recorded time = find(recording, "time"), rate = find(recording, "slip_rate");
    assert_true(time.values[time.count - 1] == 1);
    assert_true(fabs(rate.values[0] - 0.01 / (7 * 86400.0)) < 1e-12 * rate.values[0]);
    lac_recording_free(recording);
    assert_int_equal(lac_record_case_text("mine", "a: [", 4, 0, NULL, NULL, &recording, &err),
                     LAC_EINPUT);
    assert_null(recording);
    assert_int_equal(strncmp(err.message, "mine:", 5), 0);
}

// 4 x 2 cells of 1 m by 3 m, in Morton order: of a cell's number the even bits are its column.
static void test_cells(void **state)
{
    (void)state;
    static const char text[] =
        "lacuna: 1\n"
        "interface: {size: \"4 m\", width: \"6 m\", cells_x: 4, cells_y: 2, domain: {full: {}}}\n"
        "load: {normal: {pressure: \"1 MPa\"}}\n"
        "friction: {aging: {a: 0.01, b: 0.015, dc: \"5 mm\"}}\n"
        "initial: {slip_rate: \"1 um/s\", state: steady}\n"
        "time: {end: \"1 s\"}\n";
    lac_recording *recording = NULL;
    lac_error err = {0};
    assert_int_equal(
        lac_record_case_text("cells", text, sizeof text - 1, 0, NULL, NULL, &recording, &err),
        LAC_OK);
    const lac_recorded x = find(recording, "x"), y = find(recording, "y");
    assert_int_equal(x.count, 8);
    assert_int_equal(y.count, 8);
    for (unsigned c = 0; c < 8; c++) {
        const unsigned column = (c & 1) | (c >> 1 & 2), row = c >> 1 & 1;
        assert_true(x.values[c] == column + 0.5);
        assert_true(y.values[c] == 3 * (row + 0.5));
        assert_true(find(recording, "pressure").values[c] == 1e6);
    }
    lac_recording_free(recording);
}

static bool after_five(void *context)
{
    int *asked = context;
    return ++*asked >= 5;
}

static void test_stopped(void **state)
{
    (void)state;
    int asked = 0;
    lac_simulation_options stop = lac_simulation_options_default();
    lac_recording *recording = NULL;
    stop.interrupted = after_five;
    stop.context = &asked;
    assert_int_equal(lac_record_case(BLOCK, 0, NULL, &stop, &recording, NULL), LAC_EINTERRUPT);
    assert_int_equal(find(recording, "steps").values[0], 5);
    assert_int_equal(find(recording, "slip_rate").count, 6);
    lac_recording_free(recording);
}

// Runs the block stage by stage, with one more setting.
static lac_status run_by_hand(const char *key, const char *value, lac_error *err)
{
    const lac_override set = {key, value};
    const lac_case_request request = {.overrides = &set, .count = 1};
    lac_case_report report = {0};
    lac_case *c = NULL;
    lac_scene *scene = NULL;
    lac_run_result result;
    assert_int_equal(lac_case_read(BLOCK, &request, &c, &report, err), LAC_OK);
    lac_case_report_clear(&report);
    assert_true((c->run.beyond & LAC_BEYOND_OUTPUT) != 0);
    c->run.beyond &= ~(unsigned)LAC_BEYOND_OUTPUT;
    assert_int_equal(lac_scene_create(c, &scene, err), LAC_OK);
    lac_status status = lac_run(scene->problem, &c->run, NULL, &result, err);
    lac_scene_free(scene);
    lac_case_free(c);
    return status;
}

// What a case asks for and lac_run does not do is not left out in silence.
static void test_beyond_a_run(void **state)
{
    (void)state;
    static const struct {
        const char *key, *value;
        bool done;
    } beyond[] = {{"solver.accuracy", "1e-6", false},
                  {"analysis.events.slip_rate", "1 mm/s", false},
                  {"output.file", "all.nc", true},
                  {"output.every", "1 day", true}};
    lac_error err = {0};
    for (size_t i = 0; i < 4; i++) {
        const bool done = beyond[i].done;
        lac_status status = run_by_hand(beyond[i].key, beyond[i].value, &err);
        assert_int_equal(status, done ? LAC_OK : LAC_EINPUT);
        assert_true(done || strstr(err.message, "lac_simulation_run") != NULL);
        assert_true(done || strncmp(err.message, beyond[i].key, 8) == 0);
    }
    // theta_ss = (dc/v) x^-(b/a), times the published time for b/a = 1.35 and x = 0.5
    const double exact = 604800 * pow(2, 1.35) * 0.856272305814;
    lac_recording *recording = NULL;
    const char *const sets[] = {"solver.accuracy=1e-6"};
    assert_int_equal(lac_record_case(BLOCK, 1, sets, NULL, &recording, &err), LAC_OK);
    assert_true(fabs(find(recording, "failure_time").values[0] / exact - 1) < 1e-6);
    lac_recording_free(recording);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_block),     cmocka_unit_test(test_refused),
        cmocka_unit_test(test_from_memory), cmocka_unit_test(test_cells),
        cmocka_unit_test(test_stopped),     cmocka_unit_test(test_beyond_a_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
