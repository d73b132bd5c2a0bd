// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna describe [KIND [NAME]]: models and sections of a case, from the library's own tables.
#include "cli/common/describe.h"
#include "base/nearest.h"
#include "case/levels.h"
#include "cli/common/words.h"
#include "precursor/precursor.h"

enum { MAX_NAMES = 64 };

static void print_default(const lac_param *param)
{
    const double value = param->fallback;
    if (isnan(value)) {
        printf("%s", lac_param_required(param) ? "required" : "no default");
    } else if (param->type == LAC_CHOICE) {
        printf("default %s", param->choices[(int)value]);
    } else if (param->type == LAC_REAL && strcmp(param->unit, "1") != 0) {
        printf("default %s", cli_exact(value, param->unit).s);
    } else {
        printf("default %.10g", value);
    }
}

// "a or b", "> 0 m, <= 1000 m"; nothing for texts, whose doc says what they are. In SI: limits are
// often absurd numbers, which no unit makes readable.
static void print_range(const lac_param *param)
{
    const bool bare = strcmp(param->unit, "1") == 0;
    const char *gap = bare ? "" : " ", *unit = bare ? "" : param->unit, *mark = ";";
    const bool listed = (param->flags & LAC_TELLS) != 0; // they are many
    if (listed) {
        printf("; one of lacuna describe %s", param->key);
    }
    for (size_t i = 0; !listed && param->type == LAC_CHOICE && param->choices[i] != NULL; i++) {
        printf("%s %s", i > 0 ? " or" : mark, param->choices[i]);
    }
    if (param->type == LAC_PATH) {
        printf("; a path");
    }
    if (cli_param_is_bounded(param, param->min)) {
        printf("; %s %g%s%s", (param->flags & LAC_ABOVE_MIN) != 0 ? ">" : ">=", param->min, gap,
               unit);
        mark = ",";
    }
    if (cli_param_is_bounded(param, param->max)) {
        printf("%s <= %g%s%s", mark, param->max, gap, unit);
    } else if (cli_param_is_number(param) && mark[0] == ';') {
        printf("; any number");
    }
}

// Two lines a parameter: key, default, range; what it is.
static void print_parameters(const lac_param *params, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const lac_param *param = &params[i];
        const bool united = cli_param_is_number(param) && strcmp(param->unit, "1") != 0;
        printf("  %-14s %-6s ", param->key, united ? param->unit : "");
        print_default(param);
        print_range(param);
        puts((param->flags & LAC_CELLWISE) != 0 ? "; may vary by cell" : "");
        cli_wrap("                        ", param->doc);
    }
}

static void write_parameter(lac_json *json, const lac_param *param)
{
    const bool number = cli_param_is_number(param), choice = param->type == LAC_CHOICE;
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "key", param->key);
    lac_json_text(json, "type", cli_param_type(param));
    lac_json_text(json, "unit", number ? param->unit : NULL);
    lac_json_boolean(json, "required", lac_param_required(param));
    if (choice && !isnan(param->fallback)) {
        lac_json_text(json, "default", param->choices[(int)param->fallback]);
    } else {
        lac_json_number(json, "default", number ? param->fallback : NAN);
    }
    lac_json_number(json, "min", cli_param_is_bounded(param, param->min) ? param->min : NAN);
    lac_json_number(json, "max", cli_param_is_bounded(param, param->max) ? param->max : NAN);
    lac_json_boolean(json, "above_min", (param->flags & LAC_ABOVE_MIN) != 0);
    lac_json_boolean(json, "cellwise", (param->flags & LAC_CELLWISE) != 0);
    if (choice) {
        lac_json_open(json, "choices", '[');
        for (size_t i = 0; param->choices[i] != NULL; i++) {
            lac_json_text(json, NULL, param->choices[i]);
        }
        lac_json_close(json, ']');
    }
    lac_json_text(json, "doc", param->doc);
    lac_json_close(json, '}');
}

static void write_parameters(lac_json *json, const lac_param *params, size_t count)
{
    lac_json_open(json, "parameters", '[');
    for (size_t i = 0; i < count; i++) {
        write_parameter(json, &params[i]);
    }
    lac_json_close(json, ']');
}

// What is asked about.
typedef struct subject {
    bool all;
    const lac_kind *kind;
    const lac_model_info *model;
    const lac_section *section;
    bool levels; ///< thresholds, which are of no case
    bool other;  ///< a word that is near to no name
} subject;

static const lac_model_info *find_model(const lac_kind *kind, const char *name, lac_error *err)
{
    const lac_model_info *model = lac_model_find(kind->name, name);
    const char *names[MAX_NAMES];
    size_t n = 0;
    for (; model == NULL && n < MAX_NAMES && kind->at(n) != NULL; n++) {
        names[n] = kind->at(n)->name;
    }
    if (model == NULL) {
        const cli_text what = cli_format("model of %s", kind->name);
        (void)cli_unknown("describe: ", name, what.s, names, n, err);
    }
    return model;
}

// A kind by its name, or by where it stands in a case, unless plain parameters stand there or a
// command has it; and a section.
static lac_status find_subject(const char *name, subject *s, lac_error *err)
{
    const char *names[MAX_NAMES];
    const lac_kind *kind;
    const lac_section *section;
    size_t kinds = 0, n = 0;
    for (; (kind = lac_kind_get(kinds)) != NULL; kinds++) {
        names[n++] = kind->name;
    }
    for (size_t i = 0; n < MAX_NAMES - 2 && (section = lac_section_get(i)) != NULL; i++) {
        names[n++] = section->name;
        s->section = strcmp(section->name, name) == 0 ? section : s->section;
    }
    names[n++] = CLI_ROCK;
    names[n++] = lac_levels_table.name;
    s->levels = strcmp(names[n - 1], name) == 0;
    for (size_t i = kinds; i-- > 0;) { // of several the first
        kind = lac_kind_get(i);
        bool stands_there = s->section == NULL && kind->command == NULL;
        if (strcmp(kind->name, name) == 0 || (stands_there && strcmp(kind->section, name) == 0)) {
            s->kind = kind;
        }
    }
    const bool known = s->kind != NULL || s->section != NULL || s->levels;
    for (size_t i = 0; !known && i < kinds; i++) {
        kind = lac_kind_get(i);
        LAC_FAIL_IF(lac_model_find(kind->name, name) != NULL, err, LAC_EINPUT,
                    "describe: \"%s\" is a %s: lacuna describe %s %s", name, kind->name, kind->name,
                    name);
    }
    s->other = lac_nearest(name, names, n) == NULL;
    return known ? LAC_OK : cli_unknown("describe: ", name, "kind or section", names, n, err);
}

// A model of these kinds is the first member of what more is told of it; NULL: it is of another.
static const lac_precursor_kind *precursor_of(const lac_kind *kind, const lac_model_info *model)
{
    return kind->at(0) == &lac_precursor_kind_get(0)->info ? (const void *)model : NULL;
}

static const lac_forecast_kind *forecast_of(const lac_kind *kind, const lac_model_info *model)
{
    return kind->at(0) == &lac_forecast_kind_get(0)->info ? (const void *)model : NULL;
}

static void print_kind(const lac_kind *kind)
{
    const lac_model_info *model;
    const char *place = kind->command != NULL ? kind->name : kind->section;
    subject there = {0};
    (void)find_subject(place, &there, NULL);
    printf("%s", place);
    if (there.kind != kind) { // plain parameters stand there too
        printf(" (%s)", kind->name);
    }
    printf(": %s\n", kind->summary);
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        const lac_precursor_kind *precursor = precursor_of(kind, model);
        cli_row_wrap(
            model->name,
            precursor == NULL
                ? model->summary
                : cli_format("%s (needs %s)", model->summary, lac_needs_name(precursor->needs)).s);
    }
}

static void print_overview(void)
{
    const lac_section *section;
    const lac_kind *kind;
    bool of_command = false; // they stand last
    puts("What a case can choose (lacuna describe KIND NAME has parameters and references):\n");
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        if (kind->command != NULL && !of_command) {
            puts("\nWhat lacuna precursors computes:");
            of_command = true;
        }
        print_kind(kind);
    }
    puts("\nSections of plain parameters (lacuna describe SECTION):");
    for (size_t i = 0; (section = lac_section_get(i)) != NULL; i++) {
        cli_row_wrap(section->name, section->summary);
    }
    puts("\nWhat a friction law can take its numbers from (lacuna describe rock):");
    cli_row_wrap(CLI_ROCK, CLI_ROCK_SUMMARY);
    puts("\nThe file of lacuna precursors --levels, as it is by default:");
    cli_row_wrap(lac_levels_table.name, lac_levels_table.summary);
}

// How a case names it: a model, the value of a key, or the keys that say it.
static void print_use(const lac_kind *kind, const lac_model_info *model)
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

static void print_precursor(const lac_precursor_kind *kind)
{
    cli_wrap("  ", kind->estimator);
    printf("  needs %s\n", lac_needs_name(kind->needs));
    for (size_t i = 0; i < kind->value_count; i++) {
        const lac_precursor_value *value = &kind->value[i];
        const bool bare = strcmp(value->unit, "1") == 0;
        cli_row_wrap(
            value->key,
            cli_format("%s%s%s", value->text, bare ? "" : ", ", bare ? "" : value->unit).s);
    }
}

static void print_forecast(const lac_forecast_kind *kind)
{
    const lac_calibration *c = &kind->calibration;
    cli_wrap("  ", kind->estimator);
    printf("  needs at least %zu readings and velocities since the onset\n", kind->least);
    printf("  not issued where the residuals exceed their noise by more than %g of the range\n",
           kind->worst);
    cli_wrap("  ",
             cli_format("time told and intervals: 5, 25, 50, 75 and 95 %% of failures come before "
                        "t + R (W/R)^%.3g "
                        "exp(q E), R the method's tc - t (of a posterior its median), W the "
                        "window's length, E^2 = "
                        "error^2 + %.3g^2, q = %.3g, %.3g, %.3g, %.3g, %.3g",
                        c->pull, c->spread, c->low90, c->low50, c->median, c->high50, c->high90)
                 .s);
}

// The gates of forecasts; as JSON, or as text where that is NULL.
static void tell_gates(lac_json *json)
{
    const lac_forecast_gate *gate;
    for (size_t i = 0; (gate = lac_forecast_gate_get(i)) != NULL; i++) {
        if (json != NULL) {
            LAC_JSON_TEXTS(json, "name", gate->name, "text", gate->text);
        } else {
            cli_row_wrap(gate->name, gate->text);
        }
    }
}

static void print_model(const lac_kind *kind, const lac_model_info *model)
{
    print_use(kind, model);
    cli_wrap("  ", model->summary);
    if (precursor_of(kind, model) != NULL) {
        print_precursor(precursor_of(kind, model));
    }
    if (forecast_of(kind, model) != NULL) {
        print_forecast(forecast_of(kind, model));
    }
    print_parameters(model->params, model->param_count);
    if (model->reference != NULL && model->reference[0] != '\0') {
        puts("  reference:");
        cli_wrap("    ", model->reference);
    }
}

static void write_precursor(lac_json *json, const lac_precursor_kind *kind)
{
    lac_json_text(json, "estimator", kind->estimator);
    lac_json_text(json, "needs", lac_needs_name(kind->needs));
    lac_json_open(json, "values", '[');
    for (size_t i = 0; i < kind->value_count; i++) {
        const lac_precursor_value *value = &kind->value[i];
        LAC_JSON_TEXTS(json, "key", value->key, "unit", value->unit, "text", value->text);
    }
    lac_json_close(json, ']');
}

static void write_forecast(lac_json *json, const lac_forecast_kind *kind)
{
    const lac_calibration *c = &kind->calibration;
    lac_json_text(json, "estimator", kind->estimator);
    lac_json_integer(json, "needs_points", (int64_t)kind->least);
    lac_json_number(json, "worst_excess", kind->worst);
    lac_json_number(json, "pull", c->pull);
    lac_json_number(json, "spread", c->spread);
    lac_json_number(json, "low90", c->low90);
    lac_json_number(json, "low50", c->low50);
    lac_json_number(json, "median", c->median);
    lac_json_number(json, "high50", c->high50);
    lac_json_number(json, "high90", c->high90);
}

// @param kind  NULL: it is a section
static void write_model(lac_json *json, const lac_kind *kind, const lac_model_info *model)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "name", model->name);
    lac_json_text(json, "summary", model->summary);
    if (kind != NULL) {
        lac_json_text(json, "reference", model->reference);
    }
    write_parameters(json, model->params, model->param_count);
    if (kind != NULL && precursor_of(kind, model) != NULL) {
        write_precursor(json, precursor_of(kind, model));
    }
    if (kind != NULL && forecast_of(kind, model) != NULL) {
        write_forecast(json, forecast_of(kind, model));
    }
    lac_json_close(json, '}');
}

static void write_kind(lac_json *json, const lac_kind *kind, const lac_model_info *only)
{
    const lac_model_info *model;
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "name", kind->name);
    lac_json_text(json, "section", kind->section);
    lac_json_text(json, "summary", kind->summary);
    lac_json_boolean(json, "option", kind->option);
    lac_json_text(json, "command", kind->command);
    lac_json_open(json, "models", '[');
    for (size_t i = 0; (model = kind->at(i)) != NULL; i++) {
        if (only == NULL || only == model) {
            write_model(json, kind, model);
        }
    }
    lac_json_close(json, ']');
    if (forecast_of(kind, kind->at(0)) != NULL) {
        lac_json_open(json, "gates", '[');
        tell_gates(json);
        lac_json_close(json, ']');
    }
    lac_json_close(json, '}');
}

// The thresholds as they are by default. @param rows  [MAX_NAMES] room
static lac_section levels_section(lac_param *rows)
{
    const lac_levels usual = lac_levels_default();
    lac_section table = lac_levels_table;
    for (size_t i = 0; i < table.param_count; i++) {
        rows[i] = table.params[i];
        memcpy(&rows[i].fallback, (const char *)&usual + rows[i].offset, sizeof rows[i].fallback);
    }
    table.params = rows;
    return table;
}

static void write_json(const subject *s)
{
    lac_json json = {.out = stdout};
    const lac_kind *kind;
    const lac_section *section;
    lac_json_open(&json, NULL, '{');
    lac_json_open(&json, "kinds", '[');
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        if (s->all || kind == s->kind) {
            write_kind(&json, kind, s->model);
        }
    }
    lac_json_close(&json, ']');
    lac_json_open(&json, "sections", '[');
    for (size_t i = 0; (section = lac_section_get(i)) != NULL; i++) {
        if (s->all || section == s->section) {
            write_model(&json, NULL, section);
        }
    }
    if (s->levels) {
        lac_param rows[MAX_NAMES];
        const lac_section levels = levels_section(rows);
        write_model(&json, NULL, &levels);
    }
    lac_json_close(&json, ']');
    lac_json_close(&json, '}');
}

// The same as one table of models and one of parameters.
static lac_status put_table(const cli_request *request, const subject *s, lac_error *err)
{
    cli_described table = {0};
    lac_param rows[MAX_NAMES];
    const lac_section levels = levels_section(rows), *section;
    const lac_model_info *model;
    const lac_kind *kind;
    lac_status status = LAC_OK;
    for (size_t i = 0; (kind = lac_kind_get(i)) != NULL; i++) {
        for (size_t k = 0; (model = kind->at(k)) != NULL && (s->all || kind == s->kind); k++) {
            if (s->model == NULL || model == s->model) {
                LAC_TRY(cli_described_add(&table, kind->name, kind->section, model, err));
            }
        }
    }
    for (size_t i = 0; (section = lac_section_get(i)) != NULL; i++) {
        if (s->all || section == s->section) {
            LAC_TRY(cli_described_add(&table, section->name, section->name, section, err));
        }
    }
    LAC_TRY(s->levels ? cli_described_add(&table, levels.name, "", &levels, err) : LAC_OK);
    LAC_TRY(cli_described_put(request, &table, err));
out:
    free(table.model);
    free(table.param);
    return status;
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
    if (s->kind != NULL && forecast_of(s->kind, s->kind->at(0)) != NULL) {
        puts("  no forecast is issued where a gate is shut:");
        tell_gates(NULL);
    }
    if (s->section != NULL) {
        printf("%s: %s\n", s->section->name, s->section->summary);
        print_parameters(s->section->params, s->section->param_count);
    }
    if (s->levels) {
        lac_levels_put_default(stdout);
    } else if (s->all) {
        print_overview();
    }
}

static lac_status find(const cli_request *request, subject *s, lac_error *err)
{
    s->all = request->count == 0;
    LAC_TRY_RETURN(s->all ? LAC_OK : find_subject(request->argument[0], s, err));
    if (request->count < 2) {
        return LAC_OK;
    }
    LAC_FAIL_IF(s->kind == NULL, err, LAC_EINPUT, "describe: %s has no models",
                request->argument[0]);
    s->section = NULL;
    s->model = find_model(s->kind, request->argument[1], err);
    return s->model != NULL ? LAC_OK : LAC_EINPUT;
}

lac_status cli_describe(const cli_request *request, lac_error *err)
{
    subject s = {0};
    if (request->count > 0 && strcmp(request->argument[0], CLI_ROCK) == 0) {
        return cli_describe_rock(request, err);
    }
    lac_status status = find(request, &s, err);
    if (status == LAC_EINPUT && s.other && cli_describe_word(request)) {
        return LAC_OK;
    }
    if (status == LAC_OK && request->pipe != 0) {
        status = put_table(request, &s, err);
    } else if (status == LAC_OK && cli_given(request, CLI_OPT_JSON)) {
        write_json(&s);
    } else if (status == LAC_OK) {
        print_text(&s);
    }
    return status;
}
