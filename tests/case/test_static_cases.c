// SPDX-License-Identifier: GPL-3.0-or-later
// What a case must hold depends on what it is read for; what it does hold must be right.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "scene/scene.h"
#include "support/test.h"

#define HISTORY(keys) \
    "load: {normal: {pressure: 1e5}, history: {" keys "steps: [{ratio_x: 0.3}]}}\n"

#define JOINT                                                                        \
    "lacuna: 1\n"                                                                    \
    "interface: {size: 1, levels: 3, surface: {self-affine: {rms_height: 0.001}}}\n" \
    "material: {shear_modulus: 1e9}\n"

#define CONTACT                                                                      \
    "lacuna: 1\n"                                                                    \
    "interface: {size: 1, levels: 3, surface: {self-affine: {rms_height: 0.001}}}\n" \
    "material: {shear_modulus: 1e9}\n"                                               \
    "load: {normal: {pressure: 1e5}}\n"

static lac_case *read_for(const char *text, lac_case_purpose purpose, char *first, size_t size)
{
    lac_case *c = NULL;
    lac_case_issues report;
    const lac_case_request how = {.purpose = purpose};
    lac_status status = lac_case_read_text("x.yaml", text, strlen(text), &how, &c, &report, NULL);
    assert_int_equal(status, report.errors == 0 ? LAC_OK : LAC_EINPUT);
    first[0] = '\0';
    if (report.errors > 0) {
        lac_case_issue_format(&report.issue[0], first, size);
    }
    lac_case_issues_clear(&report);
    return c;
}

static void refused(const char *text, lac_case_purpose purpose, const char *line)
{
    char first[500];
    assert_null(read_for(text, purpose, first, sizeof first));
    assert_string_equal(first, line);
}

static void statics_leave_out_what_a_run_needs(void **state)
{
    (void)state;
    char first[500];
    lac_case *c = read_for(CONTACT, LAC_FOR_CONTACT, first, sizeof first);
    assert_string_equal(first, "");
    assert_non_null(c);
    assert_null(c->friction.info);
    assert_true(isnan(c->run.end));
    refused(CONTACT, LAC_FOR_RUN,
            "x.yaml:1: friction: is missing: a friction law such as {aging: {...}}");
    refused(CONTACT, LAC_FOR_CHECK,
            "x.yaml:1: friction: is missing: a friction law such as {aging: {...}}");
    lac_case_free(c);
}

static void each_part_of_a_run_may_be_absent_alone(void **state)
{
    (void)state;
    static const char *const parts[] = {
        "friction: {aging: {a: 0.01, b: 0.015, dc: 1e-4}}\n",
        "time: {end: 1}\n",
        "load: {normal: {pressure: 1e5}, shear: [{ratio: 0.5}]}\n",
    };
    const char *const bare = "lacuna: 1\n";
    for (unsigned chosen = 0; chosen < 8; chosen++) {
        char text[1000];
        char first[500];
        strcpy(text, bare);
        for (unsigned i = 0; i < 3; i++) {
            strcat(text, (chosen & 1u << i) != 0 ? parts[i]
                         : i == 2                ? "load: {normal: {pressure: 1e5}}\n"
                                                 : "");
        }
        lac_case *c = read_for(text, LAC_FOR_CONTACT, first, sizeof first);
        assert_string_equal(first, "");
        lac_case_free(c);
        c = read_for(text, LAC_FOR_RUN, first, sizeof first);
        assert_true((c != NULL) == (chosen == 7));
        lac_case_free(c);
    }
}

static void what_is_there_must_be_right(void **state)
{
    (void)state;
    refused(CONTACT "friction: {aging: {a: 0.01, b: 0.015, dc: -1}}\n", LAC_FOR_CONTACT,
            "x.yaml:5: friction.aging.dc: \"-1\" must be >= 1e-18 m");
    refused(CONTACT "time: {start: 0}\n", LAC_FOR_CONTACT,
            "x.yaml:5: time.end: is missing: must be a time such as \"1 day\"");
    refused(CONTACT "frictoin: {}\n", LAC_FOR_CONTACT,
            "x.yaml:5: frictoin: is no key here; did you mean \"friction\"?");
    refused("lacuna: 1\n", LAC_FOR_CONTACT,
            "x.yaml:1: load.normal: is missing: a normal load such as {pressure: \"3 MPa\"}");
}

// The text of a static case is one, too: it asks for nothing more.
static void text_of_a_static_case_reads_back(void **state)
{
    (void)state;
    char first[500];
    lac_case *c = read_for(CONTACT, LAC_FOR_CONTACT, first, sizeof first);
    char *text = lac_case_text(c);
    lac_case *again = read_for(text, LAC_FOR_CONTACT, first, sizeof first);
    assert_string_equal(first, "");
    char *second = lac_case_text(again);
    assert_string_equal(text, second);
    assert_null(strstr(text, "friction"));
    assert_null(strstr(text, "initial"));
    assert_null(strstr(text, "time:"));
    free(text);
    free(second);
    lac_case_free(c);
    lac_case_free(again);
}

// A history is statics: a case that has one and no time is checked as such, and a run refuses it.
static void a_history_makes_a_case_static(void **state)
{
    (void)state;
    static const char law[] = "friction: {aging: {f0: 0.7, a: 0.01, b: 0.015, dc: 1e-4}}\n";
    char first[500];
    char text[1000];
    static const lac_case_purpose purposes[] = {LAC_FOR_CHECK, LAC_FOR_CONTACT};
    for (size_t i = 0; i < 2; i++) {
        lac_case *c = read_for(JOINT HISTORY("friction: 0.5, "), purposes[i], first, sizeof first);
        assert_string_equal(first, "");
        assert_true(c->history.friction == 0.5 && isnan(c->run.end));
        lac_case_free(c);
        (void)snprintf(text, sizeof text, "%s%s", JOINT HISTORY(""), law);
        c = read_for(text, purposes[i], first, sizeof first);
        assert_string_equal(first, "");
        assert_true(c->history.friction == 0.7);
        lac_case_free(c);
        refused(JOINT HISTORY(""), purposes[i],
                "x.yaml:4: load.history.friction: is missing: Coulomb's coefficient, which no "
                "friction law gives either");
    }
    refused(
        JOINT "load: {normal: {approach: 1}, history: {friction: 0.5, steps: [{ratio_x: 0.3}]}}\n",
        LAC_FOR_CONTACT,
        "x.yaml:4: load.normal.approach: \"1\" is no load, from which load.history could start: "
        "pressure, depth or slope");
    refused(JOINT HISTORY("friction: 0.5, "), LAC_FOR_RUN,
            "x.yaml:1: friction: is missing: a friction law such as {aging: {...}}");
    (void)snprintf(text, sizeof text, "%stime: {end: 1}\n", JOINT HISTORY("friction: 0.5, "));
    refused(text, LAC_FOR_CHECK,
            "x.yaml:1: friction: is missing: a friction law such as {aging: {...}}");
}

// An approach names a case as static, to `check` too; a run has no use for it.
static void an_approach_is_static(void **state)
{
    (void)state;
    const char *const text =
        "lacuna: 1\n"
        "interface: {size: 1, levels: 3, surface: {self-affine: {rms_height: 0.001}}}\n"
        "material: {shear_modulus: 1e9}\n"
        "load: {normal: {approach: 1e-3}}\n";
    char first[500];
    const lac_case_purpose purposes[] = {LAC_FOR_CONTACT, LAC_FOR_CHECK};
    for (size_t i = 0; i < 2; i++) {
        lac_case *c = read_for(text, purposes[i], first, sizeof first);
        assert_string_equal(first, "");
        const lac_normal_load *normal = (const void *)c->normal.info;
        assert_true(normal->approach(c->normal.params) == 1e-3);
        assert_true(isnan(normal->pressure(c->normal.params, 2700)));
        lac_case_free(c);
    }
    assert_null(read_for(text, LAC_FOR_RUN, first, sizeof first));
}

// Likewise a dimension.
static void a_dimension_is_static(void **state)
{
    (void)state;
    const char *const text =
        "lacuna: 1\n"
        "interface: {size: 1, levels: 3, surface: {self-affine: {rms_height: 0.001}}}\n"
        "material: {shear_modulus: 1e9}\n"
        "load: {normal: {dimension: 1.55}}\n";
    char first[500];
    const lac_case_purpose purposes[] = {LAC_FOR_CONTACT, LAC_FOR_CHECK};
    for (size_t i = 0; i < 2; i++) {
        lac_case *c = read_for(text, purposes[i], first, sizeof first);
        assert_string_equal(first, "");
        const lac_normal_load *normal = (const void *)c->normal.info;
        assert_true(normal->dimension(c->normal.params) == 1.55);
        assert_true(isnan(normal->pressure(c->normal.params, 2700)));
        lac_case_free(c);
    }
    assert_null(read_for(text, LAC_FOR_RUN, first, sizeof first));
    refused("lacuna: 1\n"
            "interface: {size: 1, levels: 3, domain: {full: {}}}\n"
            "load: {normal: {dimension: 1.55}}\n",
            LAC_FOR_CONTACT,
            "x.yaml:3: load.normal.dimension: \"1.55\" needs interface.surface: only heights tell "
            "the load that follows");
    refused(JOINT "load: {normal: {dimension: 1.5}, history: {friction: 0.5, steps: [{ratio_x: "
                  "0.3}]}}\n",
            LAC_FOR_CONTACT,
            "x.yaml:4: load.normal.dimension: \"1.5\" is no load, from which load.history could "
            "start: pressure, depth or slope");
}

// Read for statics, such a case makes no scene to run.
static void a_static_case_makes_no_scene(void **state)
{
    (void)state;
    char first[500];
    lac_error err = {""};
    lac_scene *scene = NULL;
    lac_case *c = read_for(CONTACT, LAC_FOR_CONTACT, first, sizeof first);
    assert_int_equal(lac_scene_create(c, NULL, &scene, &err), LAC_EINPUT);
    assert_string_equal(err.message, "friction: is missing: a static case cannot be run");
    assert_null(scene);
    lac_case_free(c);
}

static void is_grid(lac_interface_def def, size_t nx, size_t ny, double dx, double dy)
{
    lac_grid grid = lac_interface_grid(&def);
    assert_true(grid.nx == nx && grid.ny == ny && grid.dx == dx && grid.dy == dy);
    assert_true(grid.periodic == (def.boundary == LAC_PERIODIC));
}

static void interfaces_are_grids(void **state)
{
    (void)state;
    const int64_t none = INT64_MIN;
    is_grid((lac_interface_def){8, NAN, 5, none, none, LAC_PLANE, LAC_PERIODIC}, 32, 32, 0.25,
            0.25);
    is_grid((lac_interface_def){8, 16, 5, none, none, LAC_PLANE, LAC_FREE}, 32, 32, 0.25, 0.5);
    is_grid((lac_interface_def){9, NAN, none, 3, none, LAC_PLANE, LAC_FREE}, 3, 3, 3, 3);
    is_grid((lac_interface_def){9, NAN, none, 3, 7, LAC_PLANE, LAC_PERIODIC}, 3, 7, 3, 3);
    is_grid((lac_interface_def){9, 14, none, 3, 7, LAC_PLANE, LAC_FREE}, 3, 7, 3, 2);
    is_grid((lac_interface_def){9, NAN, none, 3, none, LAC_LINE, LAC_PERIODIC}, 3, 1, 3, 1);
    is_grid((lac_interface_def){8, NAN, 4, none, none, LAC_LINE, LAC_PERIODIC}, 16, 1, 0.5, 1);
    is_grid((lac_interface_def){.size = 2}, 1, 1, 2, 2); // a block
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(statics_leave_out_what_a_run_needs),
        cmocka_unit_test(each_part_of_a_run_may_be_absent_alone),
        cmocka_unit_test(what_is_there_must_be_right),
        cmocka_unit_test(an_approach_is_static),
        cmocka_unit_test(a_dimension_is_static),
        cmocka_unit_test(a_static_case_makes_no_scene),
        cmocka_unit_test(interfaces_are_grids),
        cmocka_unit_test(text_of_a_static_case_reads_back),
        cmocka_unit_test(a_history_makes_a_case_static),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
