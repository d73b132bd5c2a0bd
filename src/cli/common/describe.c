// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna describe [KIND [NAME]]: models and sections of a case, from the library's own tables.
#include <string.h>

#include "cli/common/command.h"
#include "cli/common/parameters.h"
#include "cli/common/words.h"
#include "precursor/precursor.h"

enum { MAX_NAMES = 64 };

static const lac_section *find_section(const char *name)
{
    const lac_section *section;
    for (size_t i = 0; (section = lac_section_at(i)) != NULL; i++) {
        if (strcmp(section->name, name) == 0) {
            return section;
        }
    }
    return NULL;
}

// By its name, or by where it stands in a case, unless plain parameters stand there or a command
// has it.
static const lac_kind *find_kind(const char *name)
{
    const lac_kind *kind;
    bool place = find_section(name) == NULL;
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        bool stands_there = place && kind->command == NULL && strcmp(kind->section, name) == 0;
        if (strcmp(kind->name, name) == 0 || stands_there) {
            return kind;
        }
    }
    return NULL;
}

static const lac_descriptor *find_model(const lac_kind *kind, const char *name)
{
    const lac_descriptor *model;
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        if (strcmp(model->name, name) == 0) {
            return model;
        }
    }
    return NULL;
}

static lac_status unknown_kind(const char *word, lac_error *err)
{
    const char *names[MAX_NAMES];
    size_t n = 0;
    for (size_t i = 0; lac_kind_at(i) != NULL; i++) {
        const lac_kind *kind = lac_kind_at(i);
        if (find_model(kind, word) != NULL) {
            return lac_fail(err, LAC_EINPUT, "describe: \"%s\" is a %s: lacuna describe %s %s",
                            word, kind->name, kind->name, word);
        }
    }
    for (size_t i = 0; n < MAX_NAMES && lac_kind_at(i) != NULL; i++) {
        names[n++] = lac_kind_at(i)->name;
    }
    for (size_t i = 0; n < MAX_NAMES && lac_section_at(i) != NULL; i++) {
        names[n++] = lac_section_at(i)->name;
    }
    return cli_unknown("describe: ", word, "kind or section", names, n, err);
}

static lac_status unknown_model(const lac_kind *kind, const char *word, lac_error *err)
{
    const char *names[MAX_NAMES];
    size_t n = 0;
    while (n < MAX_NAMES && kind->at(n) != NULL) {
        names[n] = kind->at(n)->name;
        n++;
    }
    char what[80];
    (void)snprintf(what, sizeof what, "model of %s", kind->name);
    return cli_unknown("describe: ", word, what, names, n, err);
}

static const lac_precursor_kind *precursor_of(const lac_descriptor *model)
{
    const lac_precursor_kind *kind;
    for (size_t i = 0; (kind = lac_precursor_kind_at(i)) != NULL; i++) {
        if (&kind->about == model) {
            return kind;
        }
    }
    return NULL;
}

static const lac_forecast_kind *forecast_of(const lac_descriptor *model)
{
    const lac_forecast_kind *kind;
    for (size_t i = 0; (kind = lac_forecast_kind_at(i)) != NULL; i++) {
        if (&kind->about == model) {
            return kind;
        }
    }
    return &lac_forecast_case.about == model ? &lac_forecast_case : NULL;
}

static bool forecasts(const lac_kind *kind) { return forecast_of(kind->at(0)) != NULL; }

static void print_gates(void)
{
    const lac_forecast_gate *gate;
    puts("  no forecast is issued where a gate is shut:");
    for (size_t i = 0; (gate = lac_forecast_gate_at(i)) != NULL; i++) {
        cli_row_wrap(gate->name, gate->text);
    }
}

static void print_kind(const lac_kind *kind)
{
    const lac_descriptor *model;
    const char *place = kind->command != NULL ? kind->name : kind->section;
    printf("%s", place);
    if (find_kind(place) != kind) { // plain parameters stand there too
        printf(" (%s)", kind->name);
    }
    printf(": %s\n", kind->summary);
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        const lac_precursor_kind *precursor = precursor_of(model);
        char text[300];
        (void)snprintf(text, sizeof text, "%s%s%s%s", model->summary,
                       precursor != NULL ? " (needs " : "",
                       precursor != NULL ? lac_needs_name(precursor->needs) : "",
                       precursor != NULL ? ")" : "");
        cli_row_wrap(model->name, text);
    }
}

static void print_overview(void)
{
    const lac_kind *kind;
    const lac_section *section;
    puts("What a case can choose (lacuna describe KIND NAME has parameters and references):\n");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        if (kind->command == NULL) {
            print_kind(kind);
        }
    }
    puts("\nWhat lacuna precursors computes:");
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        if (kind->command != NULL) {
            print_kind(kind);
        }
    }
    puts("\nSections of plain parameters (lacuna describe SECTION):");
    for (size_t i = 0; (section = lac_section_at(i)) != NULL; i++) {
        cli_row_wrap(section->name, section->summary);
    }
}

// How a case names it: a model, the value of a key, or the keys that say it.
static void print_use(const lac_kind *kind, const lac_descriptor *model)
{
    if (kind->command != NULL) {
        printf("lacuna %s: %s\n", kind->command, model->name);
    } else if (!kind->option) {
        printf("%s: {%s: {...}}\n", kind->section, model->name);
    } else if (model->param_count == 0) {
        printf("%s: %s\n", kind->section, model->name);
    } else {
        printf("%s: {", kind->section);
        for (size_t i = 0; i < model->param_count; i++) {
            printf("%s%s: ...", i > 0 ? ", " : "", model->params[i].key);
        }
        puts("}");
    }
}

// What is computed and from what, of an indicator or a method of forecasting; NULL: neither.
static const char *estimator_of(const lac_descriptor *model)
{
    const lac_precursor_kind *precursor = precursor_of(model);
    const lac_forecast_kind *forecast = forecast_of(model);
    if (forecast != NULL) {
        return forecast->estimator;
    }
    return precursor != NULL ? precursor->estimator : NULL;
}

// What it needs and the numbers that it gives.
static void print_precursor(const lac_precursor_kind *kind)
{
    if (kind == NULL) {
        return;
    }
    printf("  needs %s\n", lac_needs_name(kind->needs));
    for (size_t i = 0; i < kind->value_count; i++) {
        const lac_precursor_value *value = &kind->value[i];
        char text[200];
        (void)snprintf(text, sizeof text, "%s%s%s", value->text,
                       strcmp(value->unit, "1") == 0 ? "" : ", ",
                       strcmp(value->unit, "1") == 0 ? "" : value->unit);
        cli_row_wrap(value->key, text);
    }
}

// What it needs, when it is refused, and how its error becomes intervals.
static void print_forecast(const lac_forecast_kind *kind)
{
    char text[300];
    if (kind == NULL) {
        return;
    }
    const lac_calibration *c = &kind->calibration;
    printf("  needs at least %zu readings and velocities since the onset\n", kind->least);
    printf("  not issued above a misfit of %g\n", kind->worst);
    (void)snprintf(
        text, sizeof text,
        "intervals: 5, 25, 75 and 95 %% of failures come before t + R exp(q E), R = tc - t (of "
        "a posterior its median), E^2 = error^2 + %.3g^2, q = %.3g, %.3g, %.3g, %.3g",
        c->spread, c->low90, c->low50, c->high50, c->high90);
    cli_wrap("  ", text);
}

static void print_model(const lac_kind *kind, const lac_descriptor *model)
{
    print_use(kind, model);
    cli_wrap("  ", model->summary);
    if (estimator_of(model) != NULL) {
        cli_wrap("  ", estimator_of(model));
    }
    print_precursor(precursor_of(model));
    print_forecast(forecast_of(model));
    cli_parameters_print(model->params, model->param_count);
    if (model->reference != NULL && model->reference[0] != '\0') {
        puts("  reference:");
        cli_wrap("    ", model->reference);
    }
}

static void write_precursor(lac_json *json, const lac_precursor_kind *kind)
{
    lac_json_text(json, "needs", lac_needs_name(kind->needs));
    lac_json_open(json, "values", '[');
    for (size_t i = 0; i < kind->value_count; i++) {
        lac_json_open(json, NULL, '{');
        lac_json_text(json, "key", kind->value[i].key);
        lac_json_text(json, "unit", kind->value[i].unit);
        lac_json_text(json, "text", kind->value[i].text);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}

static void write_forecast(lac_json *json, const lac_forecast_kind *kind)
{
    const lac_calibration *c = &kind->calibration;
    lac_json_integer(json, "needs_points", (int64_t)kind->least);
    lac_json_number(json, "worst_misfit", kind->worst);
    lac_json_number(json, "spread", c->spread);
    lac_json_number(json, "low90", c->low90);
    lac_json_number(json, "low50", c->low50);
    lac_json_number(json, "high50", c->high50);
    lac_json_number(json, "high90", c->high90);
}

static void write_gates(lac_json *json)
{
    const lac_forecast_gate *gate;
    lac_json_open(json, "gates", '[');
    for (size_t i = 0; (gate = lac_forecast_gate_at(i)) != NULL; i++) {
        lac_json_open(json, NULL, '{');
        lac_json_text(json, "name", gate->name);
        lac_json_text(json, "text", gate->text);
        lac_json_close(json, '}');
    }
    lac_json_close(json, ']');
}

static void write_model(lac_json *json, const lac_descriptor *model)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "name", model->name);
    lac_json_text(json, "summary", model->summary);
    lac_json_text(json, "reference", model->reference);
    cli_parameters_json(json, model->params, model->param_count);
    if (estimator_of(model) != NULL) {
        lac_json_text(json, "estimator", estimator_of(model));
    }
    if (precursor_of(model) != NULL) {
        write_precursor(json, precursor_of(model));
    }
    if (forecast_of(model) != NULL) {
        write_forecast(json, forecast_of(model));
    }
    lac_json_close(json, '}');
}

// One kind with all its models, or only the given one.
static void write_kind(lac_json *json, const lac_kind *kind, const lac_descriptor *only)
{
    const lac_descriptor *model;
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "name", kind->name);
    lac_json_text(json, "section", kind->section);
    lac_json_text(json, "summary", kind->summary);
    lac_json_boolean(json, "option", kind->option);
    lac_json_text(json, "command", kind->command);
    lac_json_open(json, "models", '[');
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        if (only == NULL || only == model) {
            write_model(json, model);
        }
    }
    lac_json_close(json, ']');
    if (forecasts(kind)) {
        write_gates(json);
    }
    lac_json_close(json, '}');
}

static void write_section(lac_json *json, const lac_section *section)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "name", section->name);
    lac_json_text(json, "summary", section->summary);
    cli_parameters_json(json, section->params, section->param_count);
    lac_json_close(json, '}');
}

// What is asked about; all NULL: everything.
typedef struct subject {
    const lac_kind *kind;
    const lac_descriptor *model;
    const lac_section *section;
} subject;

static void write_json(const subject *s)
{
    lac_json json = {.out = stdout};
    bool all = s->kind == NULL && s->section == NULL;
    const lac_kind *kind;
    const lac_section *section;
    lac_json_open(&json, NULL, '{');
    lac_json_open(&json, "kinds", '[');
    for (size_t i = 0; (kind = lac_kind_at(i)) != NULL; i++) {
        if (all || kind == s->kind) {
            write_kind(&json, kind, s->model);
        }
    }
    lac_json_close(&json, ']');
    lac_json_open(&json, "sections", '[');
    for (size_t i = 0; (section = lac_section_at(i)) != NULL; i++) {
        if (all || section == s->section) {
            write_section(&json, section);
        }
    }
    lac_json_close(&json, ']');
    lac_json_close(&json, '}');
}

static void print_text(const subject *s)
{
    if (s->model != NULL) {
        print_model(s->kind, s->model);
        return;
    }
    if (s->kind != NULL) {
        print_kind(s->kind);
    }
    if (s->kind != NULL && forecasts(s->kind)) {
        print_gates();
    }
    if (s->section != NULL) {
        printf("%s: %s\n", s->section->name, s->section->summary);
        cli_parameters_print(s->section->params, s->section->param_count);
    }
    if (s->kind == NULL && s->section == NULL) {
        print_overview();
    }
}

static lac_status find_subject(const cli_request *request, subject *s, lac_error *err)
{
    if (request->count == 0) {
        return LAC_OK;
    }
    s->kind = find_kind(request->argument[0]);
    s->section = find_section(request->argument[0]);
    if (s->kind == NULL && s->section == NULL) {
        return unknown_kind(request->argument[0], err);
    }
    if (request->count == 1) {
        return LAC_OK;
    }
    if (s->kind == NULL) {
        return lac_fail(err, LAC_EINPUT, "describe: %s is a section, it has no models",
                        request->argument[0]);
    }
    s->section = NULL;
    s->model = find_model(s->kind, request->argument[1]);
    return s->model != NULL ? LAC_OK : unknown_model(s->kind, request->argument[1], err);
}

lac_status cli_describe(const cli_request *request, lac_error *err)
{
    subject s = {0};
    lac_status status = find_subject(request, &s, err);
    if (status == LAC_OK && cli_given(request, CLI_OPT_JSON)) {
        write_json(&s);
    } else if (status == LAC_OK) {
        print_text(&s);
    }
    return status;
}
