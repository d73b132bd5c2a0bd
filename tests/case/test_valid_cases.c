// SPDX-License-Identifier: GPL-3.0-or-later
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case/sections.h"
#include "fit/fit.h"
#include "store/store.h"
#include "support/slot.h"
#include "support/test.h"
#include "surface/surface.h"

#define VALID LACUNA_SOURCE_DIR "/tests/case/valid"

static lac_case *read_or_fail(const char *path, const lac_override *overrides, size_t count)
{
    lac_case *c = NULL;
    lac_case_issues report;
    lac_error err = {""};
    const lac_case_request how = {.purpose = LAC_FOR_CHECK, .overrides = overrides, .count = count};
    if (lac_case_read(path, &how, &c, &report, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    lac_case_issues_clear(&report);
    return c;
}

static void is_nearly(double value, double expected)
{
    if (!(fabs(value - expected) <= 1e-12 * fabs(expected))) {
        fail_msg("%.17g is not %.17g", value, expected);
    }
}

static lac_load_state loads_at(const lac_case *c, double t)
{
    lac_load_state load;
    lac_load_set set = test_load_set((lac_load_models[]){lac_case_loads(c)});
    lac_load_evaluate(&set, t, &load);
    lac_load_set_clear(&set);
    return load;
}

static void the_example_reads_in_si(void **state)
{
    (void)state;
    lac_case *c = read_or_fail(VALID "/full.yaml", NULL, 0);
    const lac_self_affine *surface = c->surface.params;
    const lac_friction_params *law = c->friction.params;
    const lac_transfer_hierarchy *transfer = c->transfer.params;
    lac_load_state load = loads_at(c, 0.0);

    assert_string_equal(c->title, "A rough joint under its own slope");
    assert_null(c->references);
    assert_true(c->interface.size == 256.0 && c->interface.levels == 8);
    assert_true(c->interface.shape == LAC_PLANE && c->interface.boundary == 0);
    assert_string_equal(c->surface.info->name, "self-affine");
    assert_true(surface->hurst == 0.8 && surface->rms_height == 0.5 && surface->rolloff == 64.0);
    assert_true(surface->shortest == 2.0 && surface->seed == 1);
    assert_null(c->domain.info);
    is_nearly(c->material.shear_modulus, 2e10);
    is_nearly(c->material.shear_speed, 3e3);
    assert_true(c->material.poisson == 0.25 && c->material.density == 2700.0);
    is_nearly(((const lac_normal_load *)c->normal.info)->pressure(c->normal.params, NAN), 3e6);
    assert_int_equal(c->shear.count, 0);
    is_nearly(load.pore, 2e5);
    assert_string_equal(c->friction.info->name, "aging");
    assert_true(law->f0 == 0.6 && law->a == 0.01 && law->b == 0.015);
    is_nearly(law->dc, 1e-4);
    is_nearly(law->v0, 1e-6);
    is_nearly(c->initial.slip_rate, 0.01 / (7 * 86400.0));
    assert_true(c->initial.state == LAC_STATE_RATIO && c->initial.state_value == 0.9);
    assert_int_equal(c->initial_spread.count, 1);
    assert_string_equal(c->initial_spread.item[0].key, "slip_rate");
    const lac_heterogeneity_random *spread = c->initial_spread.item[0].model.params;
    assert_string_equal(c->initial_spread.item[0].model.info->name, "lognormal");
    assert_true(spread->width == 0.5 && spread->seed == 2 && isnan(spread->lowest));
    assert_true(transfer->stiffness == 0 && isnan(transfer->k0));
    assert_true(c->dated && c->start_date == -205286400.0); // date -d 1963-07-01Z +%s
    is_nearly(c->run.end, 200 * 86400.0);
    assert_true(c->run.failure_rate == 1.0 && isnan(c->run.stop_slip) && isnan(c->run.stop_rate));
    assert_true(c->run.method == LAC_BDF && c->run.rtol == 1e-6 && c->run.max_steps == 10000000);
    assert_true(c->formulation == LAC_FORMULATION_RATE && c->run.projection == 0);
    assert_true(c->run.record.steps == 1 && isnan(c->run.record.time));
    assert_true(c->fields == 0 && !c->run.snapshots && c->compression == 1);
    assert_string_equal(c->output_file, "out.nc");
    lac_case_free(c);
}

static void every_key_reads(void **state)
{
    (void)state;
    lac_case *c = read_or_fail(VALID "/every-key.yaml", NULL, 0);
    lac_load_state load = loads_at(c, 2 * 86400.0);
    assert_string_equal(c->title, "Everything: \"quoted\", \xc3\xa9t\xc3\xa9, tab\t, back\\slash, "
                                  "\x07 and \xe2\x80\xa8");
    assert_string_equal(c->references, "First line\nsecond line\n");
    is_nearly(c->material.density, 2600.0);
    is_nearly(load.ratio, 0.36397023426620234); // tan 20 degree
    // of the ramp, a day of it, and of the spring, two
    is_nearly(load.spring_stress, -1.0 + 1e3 * 2.0 / 365.24219878125);
    assert_true(load.stress == 0.0);
    is_nearly(load.spring_stiffness, 1e6);
    is_nearly(load.pore, 1.03e5);
    assert_int_equal(c->friction_spread.count, 9);
    const lac_friction_params *law = c->friction.params;
    assert_true(law->v1 == 1.0 && law->alpha == 0.2);
    is_nearly(law->v2, 0.01);
    const lac_heterogeneity_map *map = c->friction_spread.item[2].model.params;
    assert_string_equal(c->friction_spread.item[2].key, "dc");
    assert_string_equal(map->path, VALID "/data/dc.nc");
    assert_true(map->as == LAC_MAP_FACTOR &&
                !lac_heterogeneity_is_value(&c->friction_spread.item[2]));
    assert_true(lac_heterogeneity_is_value(&c->friction_spread.item[3]));
    assert_int_equal(c->interface_spread.count, 1);
    assert_true(c->initial.state == LAC_STATE_FROM_LOAD);
    is_nearly(c->start_date, 981169506.789); // date -d 2001-02-03T03:05:06Z +%s
    is_nearly(c->run.stop_rate, 3.0);
    assert_true(c->run.method == LAC_ERK && c->run.max_order == 8 && c->run.max_steps == 1000000);
    assert_true(c->formulation == LAC_FORMULATION_SLIP && c->run.projection == 1);
    is_nearly(c->run.record.time, 3600.0);
    assert_true(c->run.record.steps == 100 && c->run.record.per_decade == 20.0);
    assert_true(c->run.snapshots &&
                c->fields == (LAC_FIELD_SLIP | LAC_FIELD_TRACTION | LAC_FIELD_SAFETY));
    assert_true(c->safety.asked && c->run.cell_safety);
    is_nearly(c->safety.reference_rate, 1e-3 / 86400.0);
    is_nearly(c->run.stop_safety, 0.9);
    is_nearly(c->run.snapshot.time, 7 * 86400.0);
    assert_true(c->run.snapshot.steps == 0 && isnan(c->run.snapshot.per_decade));
    assert_int_equal(c->compare_count, 2);
    assert_string_equal(c->compare[0].path, VALID "/data/prisms.csv");
    assert_string_equal(c->compare[0].columns.displacement, "disp: down");
    assert_string_equal(c->compare[0].columns.displacement_unit, "mm");
    assert_string_equal(c->compare[0].columns.velocity_unit, "cm/day");
    assert_string_equal(c->compare[0].label, "Prism 7");
    assert_string_equal(c->compare[1].path, "/absolute/path.csv");
    assert_null(c->compare[1].columns.displacement);
    assert_null(c->compare[1].columns.velocity_unit);
    lac_case_free(c);
}

static void a_history_reads(void **state)
{
    (void)state;
    const lac_override overrides[] = {{"load.history.steps.0.ratio_x", "0.4"},
                                      {"load.history.steps.4.pressure", "5 kPa"},
                                      {"load.history.fields", "none"}};
    lac_case *c = read_or_fail(VALID "/history.yaml", NULL, 0);
    const lac_history_step *step = c->history.step;
    assert_int_equal(c->history.fields, LAC_KEEP_LAST);
    assert_true(c->history.friction == 0.7); // f0 of the friction law
    assert_int_equal(c->history.count, 4);
    is_nearly(step[0].ratio[0], 0.3);
    assert_true(isnan(step[0].ratio[1]) && isnan(step[0].pressure) && step[0].count == 1);
    is_nearly(step[1].pressure, 4e3);
    is_nearly(step[1].shear[0], 1e3);
    assert_true(step[1].shear[1] == 0.0 && isnan(step[1].shift[0]) && isnan(step[1].ratio[0]));
    is_nearly(step[2].shift[0], 1e-3);
    assert_int_equal(step[2].count, 10);
    assert_true(step[3].ratio[1] == -0.5 && step[3].shear[0] == 0.0);
    lac_case_free(c);

    c = read_or_fail(VALID "/history.yaml", overrides, 3);
    assert_true(c->history.step[0].ratio[0] == 0.4 && c->history.step[4].pressure == 5e3);
    assert_true(c->history.count == 5 && c->history.fields == LAC_KEEP_NONE);
    lac_case_free(c);
}

static void same_param(const lac_param *param, const void *a, const void *b)
{
    const char *x = (const char *)a + param->offset;
    const char *y = (const char *)b + param->offset;
    if (!lac_param_given(param, a)) {
        assert_false(lac_param_given(param, b));
    } else if (param->type == LAC_TEXT || param->type == LAC_PATH) {
        char *text[2];
        memcpy(&text[0], x, sizeof text[0]);
        memcpy(&text[1], y, sizeof text[1]);
        assert_string_equal(text[0], text[1]);
    } else {
        assert_memory_equal(x, y, param->type == LAC_CHOICE ? sizeof(int) : sizeof(double));
    }
}

static void same_table(const lac_section *table, const void *a, const void *b)
{
    for (size_t i = 0; i < table->param_count; i++) {
        if (!lac_param_owned(&table->params[i])) {
            same_param(&table->params[i], a, b);
        }
    }
}

static void same_slot(const lac_model *a, const lac_model *b)
{
    assert_ptr_equal(a->info, b->info);
    if (a->info != NULL) {
        same_table(a->info, a->params, b->params);
    }
}

static void same_slots(const lac_model_list *a, const lac_model_list *b)
{
    assert_int_equal(a->count, b->count);
    for (size_t i = 0; i < a->count; i++) {
        same_slot(&a->item[i], &b->item[i]);
    }
}

static void same_spreads(const lac_heterogeneity_list *a, const lac_heterogeneity_list *b)
{
    assert_int_equal(a->count, b->count);
    for (size_t i = 0; i < a->count; i++) {
        assert_string_equal(a->item[i].key, b->item[i].key);
        same_slot(&a->item[i].model, &b->item[i].model);
    }
}

static void same_section(const char *section, const void *a, const void *b)
{
    same_table(lac_section_find(section), a, b);
}

static void same_case(const lac_case *a, const lac_case *b)
{
    size_t records = 0;
    for (size_t i = 0; lac_part_get(i) != NULL; i++) {
        const lac_part *part = lac_part_get(i);
        if (part->kind == LAC_PART_RECORD) {
            same_section(part->info.name, a, b);
            records++;
        }
    }
    assert_true(records > 10);
    same_section("output.every", &a->run.record, &b->run.record);
    same_section("output.every", &a->run.snapshot, &b->run.snapshot);
    same_slot(&a->surface, &b->surface);
    same_slot(&a->domain, &b->domain);
    same_slot(&a->normal, &b->normal);
    same_slot(&a->friction, &b->friction);
    same_slot(&a->transfer, &b->transfer);
    same_slots(&a->shear, &b->shear);
    same_slots(&a->pore, &b->pore);
    same_slots(&a->pressing, &b->pressing);
    assert_int_equal(a->history.count, b->history.count);
    for (size_t i = 0; i < a->history.count; i++) {
        same_section("load.history.steps", &a->history.step[i], &b->history.step[i]);
    }
    same_spreads(&a->interface_spread, &b->interface_spread);
    same_spreads(&a->friction_spread, &b->friction_spread);
    same_spreads(&a->initial_spread, &b->initial_spread);
    assert_true(a->initial.state == b->initial.state && a->run.snapshots == b->run.snapshots);
    assert_memory_equal(&a->initial.state_value, &b->initial.state_value, sizeof(double));
    assert_true(a->dated == b->dated && a->start_date == b->start_date && a->fields == b->fields);
    assert_int_equal(a->compare_count, b->compare_count);
    for (size_t i = 0; i < a->compare_count; i++) {
        same_section("compare", &a->compare[i], &b->compare[i]);
        assert_true((a->compare[i].columns.velocity == NULL) ==
                    (b->compare[i].columns.velocity == NULL));
        assert_true((a->compare[i].columns.displacement == NULL) ==
                    (b->compare[i].columns.displacement == NULL));
    }
}

static void reads_back(const char *path)
{
    lac_case *c = read_or_fail(path, NULL, 0);
    char *text = lac_case_text(c);
    lac_case *again = NULL;
    lac_case_issues report;
    lac_error err = {""};
    const lac_case_request how = {.purpose = LAC_FOR_CHECK};
    assert_non_null(text);
    if (lac_case_read_text(path, text, strlen(text), &how, &again, &report, &err) != LAC_OK) {
        fail_msg("the text of %s: %s\n%s", path, err.message, text);
    }
    char *second = lac_case_text(again);
    assert_string_equal(text, second);
    same_case(c, again);
    lac_case_issues_clear(&report);
    lac_case_free(again);
    lac_case_free(c);
    free(second);
    free(text);
}

static size_t all_read_back(const char *folder_path)
{
    DIR *folder = opendir(folder_path);
    size_t checked = 0;
    if (folder == NULL) {
        return 0;
    }
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        const char *dot = strrchr(entry->d_name, '.');
        char path[600];
        if (dot != NULL && strcmp(dot, ".yaml") == 0) {
            (void)snprintf(path, sizeof path, "%s/%s", folder_path, entry->d_name);
            reads_back(path);
            checked++;
        }
    }
    (void)closedir(folder);
    return checked;
}

static void resolved_text_is_the_same_case(void **state)
{
    (void)state;
    assert_true(all_read_back(VALID) >= 3);
    (void)all_read_back(LACUNA_SOURCE_DIR "/cases");
}

// The case with a fitted value of its initial state, as text, read again.
static lac_status read_fitted(const char *form, const char *key, double best)
{
    const lac_override state = {"initial.state", form};
    const lac_case_request how = {.purpose = LAC_FOR_CHECK};
    lac_case_issues report;
    lac_case *c = read_or_fail(LACUNA_SOURCE_DIR "/cases/block.yaml", &state, 1), *again = NULL;
    lac_case_value value;
    static lac_fit_result fitted;
    fitted.parameters = 1;
    fitted.unknown[0] = (lac_fit_unknown){.key = key, .best = best};
    assert_true(lac_case_find(c, key, &value));
    lac_fit_apply(&fitted, c);
    char *text = lac_case_text(c);
    lac_status status =
        lac_case_read_text("fitted", text, strlen(text), &how, &again, &report, NULL);
    assert_true(status != LAC_OK || again->initial.state_value == c->initial.state_value);
    lac_case_issues_clear(&report);
    lac_case_free(again);
    lac_case_free(c);
    free(text);
    return status;
}

// One range of the initial state, for the reader and for a fit: docs/case.md.
static void fitted_states_read_back(void **state)
{
    (void)state;
    static const struct {
        const char *form, *key;
        double low, high;
    } forms[] = {{"2 day", "initial.state", 1e-12, 1e20},
                 {"{ratio_to_steady: 2}", "initial.state.ratio_to_steady", 1e-300, 1e6}};
    for (size_t i = 0; i < 2; i++) {
        const double ends[] = {forms[i].low, forms[i].high, exp(log(forms[i].high)),
                               1e3 * forms[i].high};
        for (size_t k = 0; k < 4; k++) {
            assert_int_equal(read_fitted(forms[i].form, forms[i].key, ends[k]), LAC_OK);
        }
        const lac_override beyond[] = {
            {i == 0 ? "initial.state" : "initial.state.ratio_to_steady", i == 0 ? "1e21" : "1e7"}};
        const lac_case_request how = {.overrides = beyond, .count = 1};
        lac_case_issues report;
        lac_case *c = NULL;
        assert_int_equal(
            lac_case_read(LACUNA_SOURCE_DIR "/cases/block.yaml", &how, &c, &report, NULL),
            LAC_EINPUT);
        lac_case_issues_clear(&report);
    }
}

static void overrides_apply(void **state)
{
    (void)state;
    const lac_override overrides[] = {
        {"friction.aging.dc", "3 um"},
        {"load.pore_pressure.0.constant.value", "0.3 MPa"},
        {"load.pore_pressure.1.constant.value", "0.4 MPa"},
        {"time.stop_when.mean_slip", "2 m"},
        {"solver.method", "adams"},
        {"interface.surface", "{self-affine: {rms_height: 1 mm}}"},
        {"title", "x"},
        {"title", "a: b"},
        {"title", "'a: b'"},
    };
    size_t count = sizeof overrides / sizeof overrides[0];
    lac_case *c = read_or_fail(VALID "/full.yaml", overrides, count);
    is_nearly(((const lac_friction_params *)c->friction.params)->dc, 3e-6);
    assert_int_equal(c->pore.count, 2);
    is_nearly(c->run.stop_slip, 2.0);
    assert_true(c->run.method == LAC_ADAMS);
    is_nearly(((const lac_self_affine *)c->surface.params)->rms_height, 1e-3);
    assert_true(isnan(((const lac_self_affine *)c->surface.params)->rolloff));
    assert_string_equal(c->title, "a: b");
    lac_case_free(c);
}

static void wrong_overrides_are_blamed(void **state)
{
    (void)state;
    static const struct {
        lac_override override;
        const char *line;
    } wrong[] = {
        {{"friction.aging.dc", "-1 um"}, "--set: friction.aging.dc: \"-1 um\" must be >= 1e-18 m"},
        {{"friction.aging.dcc", "1"},
         "--set: friction.aging.dcc: is no key here; did you mean \"dc\"?"},
        {{"load.pore_pressure.2.constant.value", "1"},
         "--set: load.pore_pressure.2.constant.value: names item 2 of a list of 1"},
        {{"load.pore_pressure.x.constant.value", "1"},
         "--set: load.pore_pressure.x.constant.value: names \"x\" below a list, whose items are "
         "numbers from 0"},
        {{"title.x", "1"}, "--set: title.x: names \"x\" below a value, which has no keys"},
        {{"title", ""}, "--set: title: must be a text that is not empty"},
        {{"title", "["},
         "--set: title: is not valid YAML: while parsing a flow node, did not "
         "find expected node content"},
        {{"", "1"}, "--set: is no dotted key such as friction.aging.dc"},
        {{"a..b", "1"}, "--set: a..b: is no dotted key such as friction.aging.dc"},
        {{"title.", "1"}, "--set: title.: is no dotted key such as friction.aging.dc"},
        {{".title", "1"}, "--set: .title: is no dotted key such as friction.aging.dc"},
        {{"friction.slip.a", "1"},
         "--set: friction.slip: is a second model beside aging; exactly one is allowed"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        lac_case *c = NULL;
        lac_case_issues report;
        char line[2000];
        const lac_case_request how = {.overrides = &wrong[i].override, .count = 1};
        assert_int_equal(lac_case_read(VALID "/full.yaml", &how, &c, &report, NULL), LAC_EINPUT);
        assert_true(report.count >= 1);
        assert_string_equal(lac_case_issue_format(&report.issue[0], line, sizeof line),
                            wrong[i].line);
        assert_int_equal(report.issue[0].line, 0);
        lac_case_issues_clear(&report);
    }
}

// Every beginning of a case, and every case with one byte changed: an error or a case.
static void cut_and_changed_cases_are_survived(void **state)
{
    (void)state;
    static char text[10000];
    lac_units *units = NULL;
    FILE *file = fopen(VALID "/every-key.yaml", "rb");
    assert_non_null(file);
    size_t size = fread(text, 1, sizeof text, file);
    (void)fclose(file);
    assert_int_equal(lac_units_create(&units, NULL), LAC_OK);
    for (size_t i = 0; i < 2 * size; i++) {
        lac_case *c = NULL;
        lac_case_issues report;
        lac_error err = {""};
        char kept = text[i % size];
        unsigned flipped = (unsigned char)kept ^ (i < size ? 0u : 1u << i % 7);
        text[i % size] = (char)(unsigned char)flipped;
        const lac_case_request how = {.purpose = LAC_FOR_RUN};
        lac_status status =
            lac_case_build(units, "x.yaml", text, i < size ? i : size, &how, &c, &report, &err);
        text[i % size] = kept;
        assert_true((status == LAC_OK) == (c != NULL));
        assert_true((status == LAC_OK) == (report.errors == 0));
        assert_true(status == LAC_OK || err.message[0] != '\0');
        lac_case_issues_clear(&report);
        lac_case_free(c);
    }
    lac_units_free(units);
}

static void tables_describe_themselves(void **state)
{
    (void)state;
    size_t kinds = 0;
    size_t rows = 0;
    for (; lac_kind_get(kinds) != NULL; kinds++) {
        const lac_kind *kind = lac_kind_get(kinds);
        assert_true(kind->name[0] != '\0' && kind->summary[0] != '\0');
        assert_non_null(kind->at(0));
    }
    assert_int_equal(kinds, LAC_KINDS);
    for (size_t i = 0; lac_section_get(i) != NULL; i++) {
        const lac_section *section = lac_section_get(i);
        for (size_t k = 0; k < section->param_count; k++, rows++) {
            assert_true(section->params[k].doc[0] != '\0');
            assert_non_null(section->params[k].unit);
        }
    }
    assert_true(rows > 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_example_reads_in_si),
        cmocka_unit_test(every_key_reads),
        cmocka_unit_test(a_history_reads),
        cmocka_unit_test(resolved_text_is_the_same_case),
        cmocka_unit_test(fitted_states_read_back),
        cmocka_unit_test(overrides_apply),
        cmocka_unit_test(wrong_overrides_are_blamed),
        cmocka_unit_test(cut_and_changed_cases_are_survived),
        cmocka_unit_test(tables_describe_themselves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
