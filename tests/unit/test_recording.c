// SPDX-License-Identifier: GPL-3.0-or-later
// A run kept in memory: what it holds, what is refused, and a stop.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "base/fail.h"
#include "simulation/simulation.h"
#include "support/test.h"

#define BLOCK LACUNA_SOURCE_DIR "/cases/block.yaml"

// A variable of a dataset: what it is, and where its values are.
typedef struct variable {
    const char *unit, *dimension;
    size_t count;
    const double *values;
} variable;

static variable find(const lac_dataset *dataset, const char *name)
{
    const variable v = {lac_dataset_unit(dataset, name), lac_dataset_dim(dataset, name, 0, NULL),
                        lac_dataset_count(dataset, name), lac_dataset_array(dataset, name)};
    assert_non_null(v.unit);
    assert_non_null(v.values);
    return v;
}

static lac_run_result ended; // how the last one did

// A case, in memory where there is a text of it, run into memory.
static lac_status record(const char *name, const char *text, size_t size,
                         const lac_case_options *how, const lac_simulation_options *options,
                         lac_dataset **out, lac_error *err)
{
    lac_case *c = NULL;
    lac_simulation *simulation = NULL;
    lac_status status;
    *out = NULL;
    LAC_TRY(text == NULL ? lac_case_load(name, how, &c, err)
                         : lac_case_parse(name, text, size, how, &c, err));
    LAC_TRY(lac_simulation_create(c, options, &simulation, err));
    status = lac_simulation_record(simulation, out, err);
    ended = *lac_simulation_result(simulation);
out:
    lac_simulation_free(simulation);
    lac_case_free(c);
    return status;
}

static lac_case_options overriding(size_t count, const lac_override *set)
{
    lac_case_options options = lac_case_options_default();
    options.overrides = set;
    options.count = count;
    return options;
}

static void test_a_block(void **state)
{
    (void)state;
    lac_dataset *recording = NULL;
    lac_error err = {0};
    const lac_override sets[] = {{"friction.aging.dc", "2 um"}, {"time.end", "1 s"}};
    const lac_case_options how = overriding(2, sets);
    assert_int_equal(record(BLOCK, NULL, 0, &how, NULL, &recording, &err), LAC_OK);
    const variable time = find(recording, "time"), slip = find(recording, "slip");
    assert_string_equal(time.dimension, "time");
    assert_string_equal(slip.unit, "m");
    assert_int_equal(time.count, slip.count);
    assert_true(time.values[0] == 0 && time.values[time.count - 1] == 1);
    assert_true(slip.values[0] == 0 && slip.values[slip.count - 1] > 0);
    assert_int_equal(time.count, (size_t)ended.steps + 1);
    assert_true(isnan(find(recording, "order").values[0]));
    assert_true(!ended.failed && isnan(ended.failure_local));
    assert_int_equal(find(recording, "pressure").count, 1);
    assert_null(lac_dataset_unit(recording, "event_time"));
    assert_null(lac_dataset_name(recording, 1000));
    lac_dataset_free(recording);
}

static void expect_refused(const char *path, const char *key, const char *value, lac_status status,
                           const char *why)
{
    const lac_override set = {key, value};
    const lac_case_options how = overriding(1, &set);
    lac_dataset *recording = NULL;
    lac_error err = {0};
    assert_int_equal(record(path, NULL, 0, &how, NULL, &recording, &err), status);
    assert_null(recording);
    if (strstr(err.message, why) == NULL) {
        fail_msg("\"%s\" does not say \"%s\"", err.message, why);
    }
}

static void test_refused(void **state)
{
    (void)state;
    expect_refused(BLOCK, "friction.aging.dc", "-1 um", LAC_EINPUT, "must be >= 1e-18 m");
    expect_refused(BLOCK, "friction.aging.dx", "1", LAC_EINPUT, "did you mean \"dc\"?");
    expect_refused(BLOCK, "", "1", LAC_EINPUT, "key.path=value");
    expect_refused(BLOCK, "title", NULL, LAC_EINPUT, "key.path=value");
    expect_refused(BLOCK, "solver.max_steps", "3", LAC_ENUMERIC, "3 steps");
    expect_refused(BLOCK "s", "title", "x", LAC_EIO, "block.yamls");
}

// A case from memory is that from its file; messages name it as the caller does.
static void test_from_memory(void **state)
{
    (void)state;
    static const char text[] =
        "{\"lacuna\": 1, \"load\": {\"normal\": {\"pressure\": 3e6}}, \"friction\": {\"aging\": "
        "{\"a\": 0.01, \"b\": 0.015, \"dc\": \"5 mm\"}}, \"time\": {\"end\": \"2 s\"}}, left out";
    const size_t size = sizeof text - sizeof ", left out";
    const lac_override sets[] = {{"time.end", "1 s"},
                                 {"initial", "{slip_rate: 1 cm/week, state: steady}"}};
    const lac_case_options how = overriding(2, sets);
    lac_dataset *recording = NULL;
    lac_error err = {0};
    assert_int_equal(record("mine", text, size, &how, NULL, &recording, &err), LAC_OK);
    const variable time = find(recording, "time"), rate = find(recording, "slip_rate");
    assert_true(time.values[time.count - 1] == 1);
    assert_true(fabs(rate.values[0] - 0.01 / (7 * 86400.0)) < 1e-12 * rate.values[0]);
    lac_dataset_free(recording);
    assert_int_equal(record("mine", "a: [", 4, NULL, NULL, &recording, &err), LAC_EINPUT);
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
    lac_dataset *recording = NULL;
    lac_error err = {0};
    assert_int_equal(record("cells", text, sizeof text - 1, NULL, NULL, &recording, &err), LAC_OK);
    const variable x = find(recording, "x"), y = find(recording, "y");
    assert_int_equal(x.count, 8);
    assert_int_equal(y.count, 8);
    for (unsigned c = 0; c < 8; c++) {
        const unsigned column = (c & 1) | (c >> 1 & 2), row = c >> 1 & 1;
        assert_true(x.values[c] == column + 0.5);
        assert_true(y.values[c] == 3 * (row + 0.5));
        assert_true(find(recording, "pressure").values[c] == 1e6);
    }
    lac_dataset_free(recording);
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
    lac_dataset *recording = NULL;
    stop.interrupted = after_five;
    stop.context = &asked;
    assert_int_equal(record(BLOCK, NULL, 0, NULL, &stop, &recording, NULL), LAC_EINTERRUPT);
    assert_int_equal(ended.steps, 5);
    assert_int_equal(find(recording, "slip_rate").count, 6);
    lac_dataset_free(recording);
}

// What a case asks for beyond a run is done too.
static void test_accuracy(void **state)
{
    (void)state;
    lac_error err = {0};
    // theta_ss = (dc/v) x^-(b/a), times the published time for b/a = 1.35 and x = 0.5
    const double exact = 604800 * pow(2, 1.35) * 0.856272305814;
    lac_dataset *recording = NULL;
    const lac_override set = {"solver.accuracy", "1e-6"};
    const lac_case_options how = overriding(1, &set);
    assert_int_equal(record(BLOCK, NULL, 0, &how, NULL, &recording, &err), LAC_OK);
    assert_true(fabs((ended.failure_origin + ended.failure_local) / exact - 1) < 1e-6);
    lac_dataset_free(recording);
}

// Names of points are kept as texts, though what they are of is gone; a sink has the same values.
static void test_points(void **state)
{
    (void)state;
    const lac_override sets[] = {{"output.points", "[{name: north}, {name: \"P 2\"}]"},
                                 {"time.end", "1 day"}};
    const lac_case_options how = overriding(2, sets);
    lac_dataset *recording = NULL;
    lac_error err = {0};
    char name[16];
    size_t points = 0;
    assert_int_equal(record(BLOCK, NULL, 0, &how, NULL, &recording, &err), LAC_OK);
    assert_true(lac_dataset_is_text(recording, "point_name"));
    assert_int_equal(lac_dataset_count(recording, "point_name"), 2);
    assert_int_equal(lac_dataset_text(recording, "point_name", 1, name, sizeof name, &err), LAC_OK);
    assert_string_equal(name, "P 2");
    const variable slip = find(recording, "slip"), at = find(recording, "point_slip");
    assert_string_equal(lac_dataset_dim(recording, "point_slip", 1, &points), "point");
    assert_int_equal(points, 2);
    assert_int_equal(at.count, 2 * slip.count);
    for (size_t i = 0; i < at.count; i++) {
        assert_true(at.values[i] == slip.values[i / 2]);
    }
    char *json = NULL;
    assert_int_equal(lac_dataset_to_json(recording, &json, &err), LAC_OK);
    assert_non_null(strstr(json, "\"north\""));
    free(json);
    lac_dataset_free(recording);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_block),     cmocka_unit_test(test_refused),
        cmocka_unit_test(test_from_memory), cmocka_unit_test(test_cells),
        cmocka_unit_test(test_stopped),     cmocka_unit_test(test_accuracy),
        cmocka_unit_test(test_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
