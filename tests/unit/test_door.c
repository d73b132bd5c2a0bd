// SPDX-License-Identifier: GPL-3.0-or-later
// The public functions as users of the library may call them wrongly: NULL, a size that never was,
// in a wrong order. Each refuses in words, hands out nothing and leaves all as it was.
#include <lacuna/lacuna.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "support/test.h"

#define BLOCK LACUNA_SOURCE_DIR "/cases/block.yaml"

static const char joint[] = "lacuna: 1\n"
                            "interface: {size: 1 m, levels: 2, domain: {full: {}}}\n"
                            "load: {normal: {pressure: 1 MPa}}\n"
                            "friction: {aging: {a: 0.01, b: 0.015, dc: 5 mm}}\n"
                            "initial: {slip_rate: 1 um/s, state: steady}\n"
                            "time: {end: 1 s}\n";

// A call that must be refused in words that hold some text.
#define REFUSES(call, words)                                            \
    do {                                                                \
        lac_error err = {""};                                           \
        assert_int_equal(call, LAC_EINPUT);                             \
        if (strstr(err.message, words) == NULL) {                       \
            fail_msg("\"%s\" does not say \"%s\"", err.message, words); \
        }                                                               \
    } while (0)

static lac_case *read_joint(lac_case_purpose purpose)
{
    lac_case_options options = lac_case_options_default();
    lac_case *c = NULL;
    lac_error err = {""};
    options.purpose = purpose;
    if (lac_case_parse("joint", joint, sizeof joint - 1, &options, &c, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    return c;
}

static void test_null(void **state)
{
    (void)state;
    lac_case *c = read_joint(LAC_FOR_RUN), *read = c;
    lac_simulation *simulation = NULL;
    lac_dataset *dataset = NULL;
    lac_series *series = NULL;
    const lac_series_def def = lac_series_def_default();
    const lac_series none = {0};
    double value;
    char *text, room[8];
    REFUSES(lac_case_load(NULL, NULL, &read, &err), "\"path\" must not be NULL");
    REFUSES(lac_case_load(BLOCK, NULL, NULL, &err), "\"out\"");
    REFUSES(lac_case_parse("x", NULL, 3, NULL, &read, &err), "lac_case_parse: \"text\"");
    REFUSES(lac_case_parse(NULL, "x", 1, NULL, &read, &err), "\"name\"");
    REFUSES(lac_case_get(NULL, "time.end", &value, &err), "\"c\"");
    REFUSES(lac_case_get(c, NULL, &value, &err), "\"key\"");
    REFUSES(lac_case_get(c, "friction.aging.a", NULL, &err), "\"value\"");
    REFUSES(lac_case_set(NULL, "friction.aging.a", 1, &err), "\"c\"");
    REFUSES(lac_case_set(c, NULL, 1, &err), "\"key\"");
    REFUSES(lac_simulation_create(NULL, NULL, &simulation, &err), "\"c\"");
    REFUSES(lac_simulation_create(c, NULL, NULL, &err), "\"out\"");
    REFUSES(lac_simulation_run(NULL, NULL, &err), "\"simulation\"");
    REFUSES(lac_simulation_record(NULL, &dataset, &err), "\"simulation\"");
    REFUSES(lac_simulation_write(NULL, "x.nc", NULL, &err), "\"simulation\"");
    REFUSES(lac_contact_compute(NULL, NULL, &dataset, &err), "\"c\"");
    REFUSES(lac_contact_compute(c, NULL, NULL, &err), "\"out\"");
    REFUSES(lac_rg_compute(NULL, NULL, &dataset, &err), "\"c\"");
    REFUSES(lac_rg_compute(c, NULL, NULL, &err), "\"out\"");
    REFUSES(lac_series_create(NULL, &series, &err), "\"def\"");
    REFUSES(lac_series_create(&def, NULL, &err), "\"out\"");
    REFUSES(lac_series_create(&def, &series, &err), "path");
    REFUSES(lac_forecast_compute(NULL, NULL, &dataset, &err), "\"series\"");
    REFUSES(lac_forecast_compute(&none, NULL, NULL, &err), "\"out\"");
    REFUSES(lac_forecast_compute(&none, NULL, &dataset, &err), "no reading");
    lac_forecast_options thresholds = lac_forecast_options_default();
    thresholds.levels = BLOCK;
    REFUSES(lac_forecast_compute(&none, &thresholds, &dataset, &err), "is no key here");
    REFUSES(lac_fit_series(NULL, "x.csv", &series, &err), "\"c\"");
    REFUSES(lac_fit_series(c, NULL, &series, &err), "\"path\"");
    REFUSES(lac_fit_compute(c, NULL, NULL, &dataset, &err), "\"series\"");
    REFUSES(lac_fit_compute(NULL, &none, NULL, &dataset, &err), "\"c\"");
    REFUSES(lac_dataset_values(NULL, "x", 1, &value, &err), "\"dataset\"");
    REFUSES(lac_dataset_text(NULL, "x", 0, room, sizeof room, &err), "\"dataset\"");
    REFUSES(lac_dataset_to_json(NULL, &text, &err), "\"dataset\"");
    REFUSES(lac_dataset_write(NULL, "x.nc", NULL, &err), "\"dataset\"");
    assert_true(read == NULL || read == c);
    assert_int_equal(lac_case_load(NULL, NULL, NULL, NULL), LAC_EINPUT); // also without an error
    lac_case_free(c);
}

static void test_nothing(void **state)
{
    (void)state;
    size_t length = 7;
    char line[80];
    lac_case_free(NULL);
    lac_simulation_free(NULL);
    lac_dataset_free(NULL);
    lac_series_free(NULL);
    assert_null(lac_case_text(NULL));
    assert_null(lac_case_issue_format(NULL, line, sizeof line));
    assert_null(lac_simulation_result(NULL));
    assert_null(lac_simulation_accuracy(NULL));
    assert_null(lac_simulation_extra(NULL, 0));
    assert_null(lac_end_name((lac_end)99));
    assert_null(lac_dataset_name(NULL, 0));
    assert_null(lac_dataset_unit(NULL, "x"));
    assert_null(lac_dataset_long_name(NULL, "x"));
    assert_null(lac_dataset_dim(NULL, "x", 0, &length));
    assert_int_equal(length, 0);
    assert_int_equal(lac_dataset_count(NULL, "x"), 0);
    assert_false(lac_dataset_is_text(NULL, "x"));
    assert_null(lac_dataset_array(NULL, "x"));
    assert_null(lac_model_find(NULL, "aging"));
    assert_null(lac_model_find("friction", NULL));
    assert_null(lac_model_find("friction", "no such law"));
    assert_null(lac_model_find("no such kind", "aging"));
    assert_null(lac_model_param(NULL, 0));
    assert_null(lac_kind_get(1000));
    assert_null(lac_section_get(1000));
    assert_true(strlen(lac_version()) > 0);
    assert_int_equal(lac_fail(NULL, LAC_EIO, "%d", 1), LAC_EIO);
    assert_int_equal(lac_fail_within(NULL, LAC_EIO, "%d", 1), LAC_EIO);
    assert_int_equal(lac_fail_memory(NULL), LAC_ENOMEM);
}

// What a program was compiled with: nothing, half a member, more than is known.
static void test_sizes(void **state)
{
    (void)state;
    lac_case *c = read_joint(LAC_FOR_RUN), *read = NULL;
    lac_simulation *simulation = NULL, *other = NULL;
    lac_dataset *dataset = NULL;
    lac_series *series = NULL;
    const lac_series none = {0};
    assert_int_equal(lac_simulation_create(c, NULL, &simulation, NULL), LAC_OK);
    for (int k = 0; k < 3; k++) {
#define SIZED(type, call)                                                   \
    do {                                                                    \
        lac_##type options = lac_##type##_default();                        \
        const size_t sizes[] = {0, sizeof(size_t) + 1, sizeof options + 8}; \
        options.size = sizes[k];                                            \
        REFUSES(call, "start from lac_" #type "_default");                  \
    } while (0)
        SIZED(case_options, lac_case_load(BLOCK, &options, &read, &err));
        SIZED(simulation_options, lac_simulation_create(c, &options, &other, &err));
        SIZED(sink, lac_simulation_run(simulation, &options, &err));
        SIZED(write_options, lac_simulation_write(simulation, "x.nc", &options, &err));
        SIZED(contact_options, lac_contact_compute(c, &options, &dataset, &err));
        SIZED(rg_options, lac_rg_compute(c, &options, &dataset, &err));
        SIZED(series_def, lac_series_create(&options, &series, &err));
        SIZED(forecast_options, lac_forecast_compute(&none, &options, &dataset, &err));
        SIZED(fit_options, lac_fit_compute(c, &none, &options, &dataset, &err));
    }
    assert_true(read == NULL && other == NULL && dataset == NULL && series == NULL);
    // None of it ran the simulation.
    assert_int_equal(lac_simulation_run(simulation, NULL, NULL), LAC_OK);
    lac_simulation_free(simulation);
    lac_case_free(c);
}

// A case for one thing and then another; a simulation twice.
static void test_order(void **state)
{
    (void)state;
    lac_case *statics = read_joint(LAC_FOR_CONTACT), *c = read_joint(LAC_FOR_RUN);
    lac_simulation *simulation = NULL;
    lac_dataset *dataset = NULL, *again = NULL;
    lac_series *series = NULL;
    const lac_series none = {0};
    lac_case_options options = lac_case_options_default();
    lac_case *read = NULL;
    REFUSES(lac_simulation_create(statics, NULL, &simulation, &err), "LAC_FOR_RUN");
    REFUSES(lac_rg_compute(c, NULL, &dataset, &err), "LAC_FOR_RG");
    REFUSES(lac_fit_compute(c, &none, NULL, &dataset, &err), "LAC_FOR_FIT");
    REFUSES(lac_fit_series(c, "x.csv", &series, &err), "LAC_FOR_FIT");
    options.purpose = (lac_case_purpose)17;
    REFUSES(lac_case_load(BLOCK, &options, &read, &err), "purpose 17");
    options.purpose = LAC_FOR_RUN;
    options.count = 1; // and no overrides
    REFUSES(lac_case_load(BLOCK, &options, &read, &err), "key.path=value");
    assert_int_equal(lac_simulation_create(c, NULL, &simulation, NULL), LAC_OK);
    REFUSES(lac_simulation_write(simulation, NULL, NULL, &err), "output.file");
    assert_int_equal(lac_simulation_record(simulation, &dataset, NULL), LAC_OK);
    REFUSES(lac_simulation_record(simulation, &again, &err), "was run already");
    REFUSES(lac_simulation_run(simulation, NULL, &err), "was run already");
    assert_null(again);
    lac_simulation_free(simulation);
    lac_case_free(c); // the recording needs neither
    double slip[2];
    char text[8];
    assert_true(lac_dataset_count(dataset, "slip") > 2);
    REFUSES(lac_dataset_values(dataset, "slip", 2, slip, &err), "asked for 2");
    REFUSES(lac_dataset_values(dataset, "slop", 2, slip, &err), "no variable \"slop\"");
    REFUSES(lac_dataset_text(dataset, "slip", 0, text, sizeof text, &err), "numbers, no texts");
    lac_dataset_free(dataset);
    lac_case_free(statics);
}

// Numbers by their keys, within what their rows allow.
static void test_numbers(void **state)
{
    (void)state;
    lac_case *c = read_joint(LAC_FOR_RUN);
    double value = 0;
    assert_int_equal(lac_case_get(c, "friction.aging.dc", &value, NULL), LAC_OK);
    assert_true(value == 0.005);
    assert_int_equal(lac_case_set(c, "friction.aging.dc", 0.004, NULL), LAC_OK);
    REFUSES(lac_case_set(c, "friction.aging.dc", -1, &err), "must be");
    REFUSES(lac_case_set(c, "friction.aging.dc", NAN, &err), "must be");
    REFUSES(lac_case_set(c, "friction.aging.dx", 1, &err), "friction.aging.dx");
    assert_int_equal(lac_case_get(c, "friction.aging.dc", &value, NULL), LAC_OK);
    assert_true(value == 0.004);
    char *text = lac_case_text(c);
    assert_non_null(strstr(text, "dc: \"0.004 m\""));
    free(text);
    // What runs does not change under way, so that its file says what was run.
    lac_simulation *simulation = NULL;
    assert_int_equal(lac_simulation_create(c, NULL, &simulation, NULL), LAC_OK);
    REFUSES(lac_case_set(c, "friction.aging.dc", 0.003, &err), "is not freed yet");
    lac_simulation_free(simulation);
    assert_int_equal(lac_case_set(c, "friction.aging.dc", 0.003, NULL), LAC_OK);
    lac_case_free(c);
}

// What there is to choose from, and what of it.
static void test_models(void **state)
{
    (void)state;
    const lac_param *param = NULL;
    const lac_model_info *aging = lac_model_find("friction", "aging");
    assert_non_null(aging);
    assert_string_equal(aging->name, "aging");
    size_t n = 0;
    bool found = false;
    while ((param = lac_model_param(aging, n)) != NULL) {
        found = found || (strcmp(param->key, "dc") == 0 && strcmp(param->unit, "m") == 0);
        n++;
    }
    assert_true(found);
    assert_true(lac_model_find(lac_kind_get(0)->name, lac_kind_get(0)->at(0)->name) ==
                lac_kind_get(0)->at(0));
    assert_string_equal(lac_section_get(1)->name, "interface");
    assert_non_null(lac_model_param(lac_section_get(1), 0)->doc);
}

static void note(void *context, const lac_case_issue *issue)
{
    (void)lac_case_issue_format(issue, context, 200);
}

// What is wrong with a case is told thing by thing.
static void test_issues(void **state)
{
    (void)state;
    char line[200] = "";
    lac_case *c = NULL;
    lac_error err = {""};
    const lac_override set = {"friction.aging.dx", "1"};
    lac_case_options options = lac_case_options_default();
    options.overrides = &set;
    options.count = 1;
    options.issue = note;
    options.context = line;
    assert_int_equal(lac_case_load(BLOCK, &options, &c, &err), LAC_EINPUT);
    assert_null(c);
    assert_non_null(strstr(line, "friction.aging.dx"));
    assert_non_null(strstr(line, "did you mean \"dc\""));
}

// A contact as a dataset: read, as JSON, as a file that is not replaced unasked.
static void test_result(void **state)
{
    (void)state;
    char path[] = "/tmp/lacuna-door-XXXXXX", name[80], status[16], *json = NULL;
    lac_case *c = read_joint(LAC_FOR_CONTACT);
    lac_dataset *dataset = NULL;
    size_t length = 0;
    double cells = 0;
    assert_non_null(mkdtemp(path));
    assert_int_equal(lac_contact_compute(c, NULL, &dataset, NULL), LAC_OK);
    assert_int_equal(lac_dataset_count(dataset, "largest_cluster_cells"), 1);
    assert_int_equal(lac_dataset_values(dataset, "largest_cluster_cells", 1, &cells, NULL), LAC_OK);
    assert_true(cells == 16);
    // A unit that a name ends in is the unit.
    const char *said;
    for (size_t i = 0; (said = lac_dataset_name(dataset, i)) != NULL; i++) {
        const char *end = strrchr(said, '_');
        if (end != NULL && (strcmp(end, "_Pa") == 0 || strcmp(end, "_m") == 0)) {
            assert_string_equal(lac_dataset_unit(dataset, said), end + 1);
        }
    }
    assert_string_equal(lac_dataset_dim(dataset, "pressure", 0, &length), "y");
    assert_int_equal(length, 4);
    assert_true(lac_dataset_is_text(dataset, "status"));
    assert_int_equal(lac_dataset_text(dataset, "status", 0, status, sizeof status, NULL), LAC_OK);
    assert_string_equal(status, "complete");
    REFUSES(lac_dataset_text(dataset, "status", 0, status, 3, &err), "takes 9 bytes");
    REFUSES(lac_dataset_text(dataset, "status", 1, status, sizeof status, &err), "none at 1");
    REFUSES(lac_dataset_values(dataset, "status", 1, &cells, &err), "texts, no numbers");
    assert_int_equal(lac_dataset_to_json(dataset, &json, NULL), LAC_OK);
    assert_non_null(strstr(json, "\"contact_fraction\""));
    free(json);
    (void)snprintf(name, sizeof name, "%s/c.nc", path);
    assert_int_equal(lac_dataset_write(dataset, name, NULL, NULL), LAC_OK);
    REFUSES(lac_dataset_write(dataset, name, NULL, &err), "exists");
    (void)unlink(name);
    (void)rmdir(path);
    lac_dataset_free(dataset);
    lac_case_free(c);
}

static bool stop_at_third(void *context) { return ++*(int *)context == 3; }

// A history of loads: what its steps ask for is what they have, cell by cell too; ended, and left
// out.
static void test_history(void **state)
{
    (void)state;
    static const char sheared[] =
        "lacuna: 1\n"
        "interface: {size: 1, levels: 3, surface: {self-affine: {rms_height: 0.001}}}\n"
        "material: {shear_modulus: 1e9, poisson: 0.2}\n"
        "load: {normal: {pressure: 1e6}, history: {friction: 0.5, steps: [{ratio_x: 0.2}, "
        "{ratio_x: 0.6, count: 3}, {pressure: 8e5}]}}\n";
    static const double asked[] = {0.2, 1.0 / 3.0, 1.4 / 3.0, 0.6, 0.6};
    lac_case_options how = lac_case_options_default();
    lac_contact_options options = lac_contact_options_default();
    lac_case *c = NULL;
    lac_dataset *d = NULL;
    double force[5], map[5 * 64];
    int calls = 0;
    how.purpose = LAC_FOR_CONTACT;
    assert_int_equal(lac_case_parse("x", sheared, sizeof sheared - 1, &how, &c, NULL), LAC_OK);
    assert_int_equal(lac_contact_compute(c, NULL, &d, NULL), LAC_OK);
    assert_int_equal(lac_dataset_values(d, "shear_force_x", 5, force, NULL), LAC_OK);
    assert_int_equal(lac_dataset_values(d, "traction_x", 5 * 64, map, NULL), LAC_OK);
    for (size_t i = 0; i < 5; i++) {
        double sum = 0;
        for (size_t k = 0; k < 64; k++) {
            sum += map[64 * i + k] / 64;
        }
        // the pressure is relieved at the shear that is held
        assert_true(fabs(force[i] - asked[i] * 0.5 * 1e6) < 1.0);
        assert_true(fabs(sum - force[i]) < 1.0);
    }
    lac_dataset_free(d);
    options.interrupted = stop_at_third;
    options.context = &calls;
    assert_int_equal(lac_contact_compute(c, &options, &d, NULL), LAC_EINTERRUPT);
    assert_null(d);
    options.quick = true;
    assert_int_equal(lac_contact_compute(c, &options, &d, NULL), LAC_OK);
    assert_int_equal(lac_dataset_count(d, "shear_force_x"), 0);
    lac_dataset_free(d);
    options.boxes = "3:5";
    REFUSES(lac_contact_compute(c, &options, &d, &err), "boxes: \"3:5\" must be two sides");
    lac_case_free(c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_null),    cmocka_unit_test(test_nothing),
        cmocka_unit_test(test_sizes),   cmocka_unit_test(test_order),
        cmocka_unit_test(test_numbers), cmocka_unit_test(test_models),
        cmocka_unit_test(test_issues),  cmocka_unit_test(test_result),
        cmocka_unit_test(test_history),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
