// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters with their units, defaults and ranges, as `describe` tells them in words and JSON.
#include "cli/common/parameters.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/units.h"
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

static const char *format_number(const lac_param *param, double value, char *text, size_t size)
{
    if (param->type == LAC_REAL && strcmp(param->unit, "1") != 0) {
        return lac_units_format(value, param->unit, text, size);
    }
    (void)snprintf(text, size, "%.10g", value);
    return text;
}

static const char *format_default(const lac_param *param, char *text, size_t size)
{
    if (is_required(param)) {
        return "required";
    }
    if (isnan(param->fallback)) {
        return "no default";
    }
    char value[64];
    if (param->type == LAC_CHOICE) {
        (void)snprintf(value, sizeof value, "%s", param->choices[(int)param->fallback]);
    } else {
        (void)format_number(param, param->fallback, value, sizeof value);
    }
    (void)snprintf(text, size, "default %s", value);
    return text;
}

static void append(char *text, size_t size, const char *more)
{
    size_t used = strlen(text);
    (void)snprintf(text + used, size - used, "%s", more);
}

// In SI: limits are often absurd numbers, which no unit makes readable.
static void append_limit(char *text, size_t size, const char *sign, const lac_param *param,
                         double limit)
{
    char one[64];
    bool bare = strcmp(param->unit, "1") == 0;
    (void)snprintf(one, sizeof one, "%s%s %g%s%s", text[0] != '\0' ? ", " : "", sign, limit,
                   bare ? "" : " ", bare ? "" : param->unit);
    append(text, size, one);
}

// "a or b", "> 0 m, <= 1 km"; nothing for texts, whose doc says what they are
static void format_range(const lac_param *param, char *text, size_t size)
{
    text[0] = '\0';
    if (param->type == LAC_CHOICE) {
        for (size_t i = 0; param->choices[i] != NULL; i++) {
            append(text, size, i > 0 ? " or " : "");
            append(text, size, param->choices[i]);
        }
        return;
    }
    if (!is_number(param)) {
        append(text, size, param->type == LAC_PATH ? "a path" : "");
        return;
    }
    if (is_bounded(param->min)) {
        append_limit(text, size, (param->flags & LAC_ABOVE_MIN) != 0 ? ">" : ">=", param,
                     param->min);
    }
    if (is_bounded(param->max)) {
        append_limit(text, size, "<=", param, param->max);
    }
    append(text, size, text[0] != '\0' ? "" : "any number");
}

void cli_parameters_print(const lac_param *params, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const lac_param *param = &params[i];
        bool cellwise = (param->flags & LAC_CELLWISE) != 0;
        const char *unit = strcmp(param->unit, "1") == 0 ? "" : param->unit;
        char fallback[96], range[256];
        format_range(param, range, sizeof range);
        printf("  %-14s %-6s %s%s%s%s\n", param->key, is_number(param) ? unit : "",
               format_default(param, fallback, sizeof fallback), range[0] != '\0' ? "; " : "",
               range, cellwise ? "; may vary by cell" : "");
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

static void write_limits(lac_json *json, const lac_param *param)
{
    bool number = is_number(param);
    if (param->type == LAC_CHOICE && !isnan(param->fallback)) {
        lac_json_text(json, "default", param->choices[(int)param->fallback]);
    } else {
        lac_json_number(json, "default", number ? param->fallback : NAN);
    }
    lac_json_number(json, "min", number && is_bounded(param->min) ? param->min : NAN);
    lac_json_number(json, "max", number && is_bounded(param->max) ? param->max : NAN);
    lac_json_boolean(json, "above_min", (param->flags & LAC_ABOVE_MIN) != 0);
}

static void write_parameter(lac_json *json, const lac_param *param)
{
    lac_json_open(json, NULL, '{');
    lac_json_text(json, "key", param->key);
    lac_json_text(json, "type", type_name(param));
    lac_json_text(json, "unit", is_number(param) ? param->unit : NULL);
    lac_json_boolean(json, "required", is_required(param));
    write_limits(json, param);
    lac_json_boolean(json, "cellwise", (param->flags & LAC_CELLWISE) != 0);
    if (param->type == LAC_CHOICE) {
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
