// SPDX-License-Identifier: GPL-3.0-or-later
// Whatever a registry lists says what it is, what its parameters mean and what to cite, and a case
// under cases/ shows it. Everything here goes by the registries: a new model is asked the same.
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "case/case.h"
#include "precursor/precursor.h"
#include "support/test.h"

#define CASES LACUNA_SOURCE_DIR "/cases"

enum { MOST_CASES = 256 };

static struct {
    lac_case *item[MOST_CASES];
    size_t count;
} cases;

static bool ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), m = strlen(end);
    return n >= m && strcmp(text + n - m, end) == 0;
}

static void read_case(const char *path)
{
    lac_case_issues report;
    lac_error err = {""};
    const lac_case_request how = {.purpose = LAC_FOR_CHECK};
    assert_true(cases.count < MOST_CASES);
    if (lac_case_read(path, &how, &cases.item[cases.count++], &report, &err) != LAC_OK) {
        fail_msg("%s", err.message);
    }
    lac_case_issues_clear(&report);
}

static void walk(const char *folder)
{
    DIR *dir = opendir(folder);
    struct dirent *entry;
    assert_non_null(dir);
    while ((entry = readdir(dir)) != NULL) {
        char path[1000];
        (void)snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (ends_with(path, ".yaml")) {
            read_case(path);
        } else if (strchr(entry->d_name, '.') == NULL) {
            walk(path);
        }
    }
    closedir(dir);
}

static int read_cases(void **state)
{
    (void)state;
    walk(CASES);
    return 0;
}

static int free_cases(void **state)
{
    (void)state;
    for (size_t i = 0; i < cases.count; i++) {
        lac_case_free(cases.item[i]);
    }
    return 0;
}

static bool among(const lac_model_list *list, const lac_model_info *info)
{
    bool found = false;
    for (size_t i = 0; i < list->count; i++) {
        found |= list->item[i].info == info;
    }
    return found;
}

static bool spread_among(const lac_heterogeneity_list *list, const lac_model_info *info)
{
    bool found = false;
    for (size_t i = 0; i < list->count; i++) {
        found |= list->item[i].model.info == info;
    }
    return found;
}

static bool has_model(const lac_case *c, const lac_model_info *info)
{
    return c->surface.info == info || c->domain.info == info || c->normal.info == info ||
           c->friction.info == info || c->transfer.info == info || among(&c->shear, info) ||
           among(&c->pore, info) || among(&c->pressing, info) || among(&c->weakening, info) ||
           among(&c->analysis, info) || spread_among(&c->friction_spread, info) ||
           spread_among(&c->initial_spread, info) || spread_among(&c->interface_spread, info);
}

// Whether a field differs from its row's default, or is there without one.
static bool is_set(const lac_param *row, const void *params)
{
    const char *field = (const char *)params + row->offset;
    if (row->type == LAC_CHOICE) {
        int chosen = *(const int *)(const void *)field;
        return isnan(row->fallback) ? chosen >= 0 : chosen != (int)row->fallback;
    }
    assert_int_equal(row->type, LAC_REAL);
    double value = *(const double *)(const void *)field;
    return !isnan(value) && !(value == row->fallback);
}

// "solver.method" as a row of its section; NULL where it is no key.
static const lac_param *find_row(const char *key)
{
    const char *dot = strrchr(key, '.');
    const lac_section *section;
    for (size_t i = 0; dot != NULL && (section = lac_section_get(i)) != NULL; i++) {
        bool same = strlen(section->name) == (size_t)(dot - key) &&
                    strncmp(section->name, key, (size_t)(dot - key)) == 0;
        for (size_t k = 0; same && k < section->param_count; k++) {
            if (strcmp(section->params[k].key, dot + 1) == 0) {
                return &section->params[k];
            }
        }
    }
    return NULL;
}

// An option is the value of a key, or the parameters that say it: of the friction law or the case.
static bool has_option(const lac_case *c, const lac_kind *kind, const lac_model_info *option)
{
    const lac_param *row = find_row(kind->section);
    if (row != NULL) {
        int chosen = *(const int *)(const void *)((const char *)c + row->offset);
        return strcmp(row->choices[chosen], option->name) == 0;
    }
    const void *params = strncmp(kind->section, "friction", 8) == 0 ? c->friction.params : c;
    bool found = false;
    for (size_t i = 0; params != NULL && i < option->param_count; i++) {
        found |= is_set(&option->params[i], params);
    }
    return found;
}

static void some_case_shows_every_model(void **state)
{
    (void)state;
    const lac_kind *kind;
    const lac_model_info *model;
    int missing = 0;
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        for (size_t k = 0; (model = kind->at(k)) != NULL; k++) {
            bool shown = kind->command != NULL; // by any series; runs below
            for (size_t j = 0; j < cases.count; j++) {
                shown |= kind->option ? has_option(cases.item[j], kind, model)
                                      : has_model(cases.item[j], model);
            }
            if (!shown) {
                print_error("no case under cases/ has %s: %s\n", kind->section, model->name);
                missing++;
            }
        }
    }
    assert_int_equal(missing, 0);
}

// Events and cells are those of a run whose case asks for them.
static void some_case_has_what_indicators_need(void **state)
{
    (void)state;
    static const char *const analysis[] = {[LAC_NEEDS_EVENTS] = "events", [LAC_NEEDS_CELLS] = "rg"};
    const lac_precursor_kind *kind;
    for (size_t k = 0; (kind = lac_precursor_kind_get(k)) != NULL; k++) {
        bool shown = kind->needs == LAC_NEEDS_MOTION;
        for (size_t j = 0; j < cases.count && !shown; j++) {
            const lac_model_list *asked = &cases.item[j]->analysis;
            for (size_t i = 0; i < asked->count; i++) {
                shown |= strcmp(asked->item[i].info->name, analysis[kind->needs]) == 0;
            }
        }
        if (!shown) {
            fail_msg("no case under cases/ has what %s needs", kind->info.name);
        }
    }
}

static bool is_number(const lac_param *row)
{
    return row->type == LAC_REAL || row->type == LAC_INTEGER;
}

static bool unit_reads(const lac_units *units, const char *unit)
{
    double scale, offset;
    return lac_units_convert(units, unit, unit, &scale, &offset, NULL) == LAC_OK && scale == 1.0;
}

static bool fallback_is_allowed(const lac_param *row)
{
    char why[200];
    return isnan(row->fallback) || lac_param_allows(row, row->fallback, why, sizeof why);
}

// What is wrong with a row; NULL where nothing is.
static const char *row_fault(const lac_units *units, const lac_param *row)
{
    if (row->key == NULL || row->key[0] == '\0' || row->doc == NULL || row->doc[0] == '\0') {
        return "has no key or no description";
    }
    if (row->type == LAC_CHOICE) {
        int last = 0;
        while (row->choices != NULL && row->choices[last] != NULL) {
            last++;
        }
        bool good = last > 0 && (isnan(row->fallback) || (int)row->fallback < last);
        return good ? NULL : "has no choices, or a default that is none of them";
    }
    if (!is_number(row)) {
        return NULL;
    }
    if (row->unit == NULL || !unit_reads(units, row->unit)) {
        return "has no unit that UDUNITS reads";
    }
    // rows that leave out the range have 0 for both
    if (!(row->min < row->max)) {
        return "has no range";
    }
    return fallback_is_allowed(row) ? NULL : "has a default out of its range";
}

static int check_rows(const lac_units *units, const char *where, const lac_param *rows,
                      size_t count)
{
    int wrong = 0;
    for (size_t i = 0; i < count; i++) {
        const char *fault = row_fault(units, &rows[i]);
        for (size_t k = 0; k < i && fault == NULL; k++) {
            fault = strcmp(rows[i].key, rows[k].key) == 0 ? "stands twice" : NULL;
        }
        if (fault != NULL) {
            print_error("%s: %s %s\n", where, rows[i].key, fault);
            wrong++;
        }
    }
    return wrong;
}

// A paper with its year and where it stands, or a page of docs/.
static bool is_reference(const char *text)
{
    int year = 0;
    const char *bracket = text;
    while ((bracket = strchr(bracket, '(')) != NULL && year == 0) {
        year = atoi(++bracket);
    }
    return (year > 1600 && year < 2100) || strstr(text, "docs/") != NULL;
}

static void every_row_is_documented(void **state)
{
    (void)state;
    lac_units *units = NULL;
    const lac_kind *kind;
    const lac_section *section;
    const lac_model_info *model;
    int wrong = 0;
    assert_int_equal(lac_units_create(&units, NULL), LAC_OK);
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        for (size_t k = 0; (model = kind->at(k)) != NULL; k++) {
            if (model->summary == NULL || model->summary[0] == '\0' || model->reference == NULL ||
                !is_reference(model->reference)) {
                print_error("%s: %s lacks a summary or a reference\n", kind->section, model->name);
                wrong++;
            }
            wrong += check_rows(units, model->name, model->params, model->param_count);
        }
    }
    for (size_t i = 0; (section = lac_section_get(i)) != NULL; i++) {
        wrong += check_rows(units, section->name, section->params, section->param_count);
    }
    lac_units_free(units);
    assert_int_equal(wrong, 0);
}

// Options that are the values of a key are described; one that leaves it open may be.
static void every_choice_of_an_option_is_described(void **state)
{
    (void)state;
    const lac_kind *kind;
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        const lac_param *row = kind->option ? find_row(kind->section) : NULL;
        size_t k = 0;
        for (size_t j = 0; row != NULL && row->choices[j] != NULL; j++) {
            const lac_model_info *told = kind->at(k);
            const bool open = strcmp(row->choices[j], "auto") == 0;
            if (!open || (told != NULL && strcmp(told->name, "auto") == 0)) {
                assert_non_null(kind->at(k));
                assert_string_equal(kind->at(k)->name, row->choices[j]);
                k++;
            }
        }
        assert_true(row == NULL || kind->at(k) == NULL);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(some_case_shows_every_model),
        cmocka_unit_test(some_case_has_what_indicators_need),
        cmocka_unit_test(every_row_is_documented),
        cmocka_unit_test(every_choice_of_an_option_is_described),
    };
    return cmocka_run_group_tests(tests, read_cases, free_cases);
}
