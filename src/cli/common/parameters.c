// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters with their units, defaults and ranges, as `describe` tells them in words and JSON.
#include "cli/common/parameters.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "cli/common/words.h"

static bool is_required(const lac_param *param)
{
    return (param->flags & LAC_OPTIONAL) == 0 && isnan(param->fallback);
}

static bool is_number(const lac_param *param)
{
    return param->type == LAC_REAL || param->type == LAC_INTEGER;
}

// Ranges beyond what anything measures mean "no limit".
static bool is_bounded(double limit) { return fabs(limit) < DBL_MAX / 2; }

static void print_default(const lac_param *param)
{
    const double value = param->fallback;
    if (isnan(value)) {
        printf("%s", is_required(param) ? "required" : "no default");
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
    for (size_t i = 0; param->type == LAC_CHOICE && param->choices[i] != NULL; i++) {
        printf("%s %s", i > 0 ? " or" : mark, param->choices[i]);
    }
    if (param->type == LAC_PATH) {
        printf("; a path");
    }
    if (is_number(param) && is_bounded(param->min)) {
        printf("; %s %g%s%s", (param->flags & LAC_ABOVE_MIN) != 0 ? ">" : ">=", param->min, gap,
               unit);
        mark = ",";
    }
    if (is_number(param) && is_bounded(param->max)) {
        printf("%s <= %g%s%s", mark, param->max, gap, unit);
    } else if (is_number(param) && mark[0] == ';') {
        printf("; any number");
    }
}

void cli_parameters_print(const lac_param *params, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const lac_param *param = &params[i];
        const bool united = is_number(param) && strcmp(param->unit, "1") != 0;
        printf("  %-14s %-6s ", param->key, united ? param->unit : "");
        print_default(param);
        print_range(param);
        puts((param->flags & LAC_CELLWISE) != 0 ? "; may vary by cell" : "");
        cli_wrap("                        ", param->doc);
    }
}

static const char *type_name(const lac_param *param)
{
    static const char *const names[] = {
        [LAC_REAL] = "real", [LAC_INTEGER] = "integer", [LAC_CHOICE] = "choice",
        [LAC_TEXT] = "text", [LAC_PATH] = "path",
    };
    return names[param->type];
}

static void write_parameter(lac_json *json, const lac_param *param)
{
    const bool number = is_number(param), choice = param->type == LAC_CHOICE;
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "key", param->key);
    lac_json_text(json, "type", type_name(param));
    lac_json_text(json, "unit", number ? param->unit : NULL);
    lac_json_boolean(json, "required", is_required(param));
    if (choice && !isnan(param->fallback)) {
        lac_json_text(json, "default", param->choices[(int)param->fallback]);
    } else {
        lac_json_number(json, "default", number ? param->fallback : NAN);
    }
    lac_json_number(json, "min", number && is_bounded(param->min) ? param->min : NAN);
    lac_json_number(json, "max", number && is_bounded(param->max) ? param->max : NAN);
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

void cli_parameters_json(lac_json *json, const lac_param *params, size_t count)
{
    lac_json_open(json, "parameters", '[');
    for (size_t i = 0; i < count; i++) {
        write_parameter(json, &params[i]);
    }
    lac_json_close(json, ']');
}
