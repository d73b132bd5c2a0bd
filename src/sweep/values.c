// SPDX-License-Identifier: GPL-3.0-or-later
// The values that a key takes in a sweep: lists, ranges, columns of a file, and distributions, a
// row each.
#include <ctype.h>

#include <gsl/gsl_cdf.h>

#include "base/units.h"
#include "sweep/sweep.h"

enum { MOST_VALUES = 1 << 20, SHOWN = 80 };

static const char *unordered(const double *a)
{
    return a[0] < a[1] ? NULL : "the second must be larger than the first";
}

static const char *unordered_positive(const double *a)
{
    return a[0] > 0.0 ? unordered(a) : "both must be > 0";
}

static const char *no_spread(const double *a)
{
    return a[1] > 0.0 ? NULL : "the second must be > 0";
}

static const char *no_spread_positive(const double *a)
{
    return a[0] > 0.0 ? no_spread(a) : "the first must be > 0";
}

static const char *no_triangle(const double *a)
{
    return a[0] <= a[1] && a[1] <= a[2] && a[0] < a[2] ? NULL : "they must rise";
}

static double uniform(const double *a, double u) { return a[0] + (a[1] - a[0]) * u; }

static double loguniform(const double *a, double u) { return a[0] * pow(a[1] / a[0], u); }

static double normal(const double *a, double u) { return a[0] + a[1] * gsl_cdf_ugaussian_Pinv(u); }

static double lognormal(const double *a, double u)
{
    return a[0] * exp(a[1] * gsl_cdf_ugaussian_Pinv(u));
}

static double triangular(const double *a, double u)
{
    const double width = a[2] - a[0], rise = a[1] - a[0];
    return u * width < rise ? a[0] + sqrt(u * width * rise)
                            : a[2] - sqrt((1.0 - u) * width * (a[2] - a[1]));
}

static const lac_distribution distributions[] = {
    {"uniform", "low, high", "any value between, alike", 2, false, unordered, uniform},
    {"loguniform", "low, high", "its logarithm uniform", 2, false, unordered_positive, loguniform},
    {"normal", "mean, sigma", "Gauss", 2, false, no_spread, normal},
    {"lognormal", "median, sigma", "its natural logarithm normal, with sigma, a plain number", 2,
     true, no_spread_positive, lognormal},
    {"triangular", "low, mode, high", "rising to the mode, falling behind it", 3, false,
     no_triangle, triangular},
};

static lac_status wrong(const lac_swept *param, const char *what, lac_error *err)
{
    return lac_fail(err, LAC_EINPUT, "--over: %s: \"%.*s\" %s", param->key, SHOWN, param->said,
                    what);
}

static char *trimmed(char *text)
{
    size_t n = strlen(text);
    while (n > 0 && isspace((unsigned char)text[n - 1])) {
        text[--n] = '\0';
    }
    return text + strspn(text, " \t");
}

// Cuts at the next comma that is in no brackets and no quotes. @return what is left; NULL: nothing
static char *cut(char *text, char at)
{
    int depth = 0;
    char quote = '\0';
    for (; *text != '\0'; text++) {
        if (quote != '\0') {
            quote = *text == quote ? '\0' : quote;
        } else if (*text == '"' || *text == '\'') {
            quote = *text;
        } else if (strchr("([{", *text) != NULL) {
            depth++;
        } else if (strchr(")]}", *text) != NULL) {
            depth--;
        } else if (*text == at && depth == 0) {
            *text = '\0';
            return text + 1;
        }
    }
    return NULL;
}

// A number in the unit of the parameter; of a key that is set as a text the first one's unit is
// that of all.
static bool take_number(lac_swept *param, const lac_units *units, char *text, double *value)
{
    char *end = NULL;
    text = trimmed(text);
    const double number = strtod(text, &end);
    if (end == text || !isfinite(number)) {
        return false;
    }
    if (!param->word) {
        return lac_units_parse(units, text, param->unit, value, NULL) == LAC_OK && isfinite(*value);
    }
    end += strspn(end, " \t");
    if (param->unit[0] == '\0' && strlen(end) < sizeof param->unit) {
        (void)snprintf(param->unit, sizeof param->unit, "%s", *end == '\0' ? "1" : end);
    }
    *value = number;
    return strcmp(param->unit, *end == '\0' ? "1" : end) == 0;
}

static lac_status add_value(lac_swept *param, const char *text, double value, lac_error *err)
{
    if ((param->values & (param->values - 1)) == 0) {
        const size_t room = param->values == 0 ? 1 : 2 * param->values;
        char **grown = realloc(param->text, room * sizeof *grown);
        param->text = grown != NULL ? grown : param->text;
        double *numbers = realloc(param->value, room * sizeof *numbers);
        param->value = numbers != NULL ? numbers : param->value;
        LAC_FAIL_MEMORY_IF(grown == NULL || numbers == NULL, err);
    }
    param->text[param->values] = strdup(text);
    LAC_FAIL_MEMORY_IF(param->text[param->values] == NULL, err);
    param->value[param->values++] = value;
    return LAC_OK;
}

static lac_status add_text(lac_swept *param, const lac_units *units, char *text, lac_error *err)
{
    double value = NAN;
    char *item = trimmed(text);
    if (*item == '\0') {
        return wrong(param, "has an empty value", err);
    }
    const lac_swept before = *param;
    char *copy = strdup(item);
    LAC_FAIL_MEMORY_IF(copy == NULL, err);
    const bool number = take_number(param, units, copy, &value);
    free(copy);
    if (!number) {
        memcpy(param->unit, before.unit, sizeof param->unit);
        LAC_FAIL_IF(!param->word, err, LAC_EINPUT,
                    "--over: %s: \"%.*s\" must be a quantity of unit %s", param->key, SHOWN, item,
                    param->unit);
        value = NAN;
    }
    param->number = param->number && number;
    return add_value(param, item, value, err);
}

// "1:100", "0.4:0.9:0.1". @return whether it is a range
static bool read_range(lac_swept *param, const lac_units *units, const char *said, double range[3])
{
    char copy[256], *part = copy;
    size_t n = 0;
    range[2] = NAN;
    if (strlen(said) >= sizeof copy) {
        return false;
    }
    (void)snprintf(copy, sizeof copy, "%s", said);
    while (part != NULL && n < 3) {
        char *next = cut(part, ':');
        if (!take_number(param, units, part, &range[n++])) {
            return false;
        }
        part = next;
    }
    return part == NULL && n >= 2;
}

static lac_status add_range(lac_swept *param, const double range[3], lac_error *err)
{
    const double step = isnan(range[2]) ? 1.0 : range[2];
    const double steps = floor((range[1] - range[0]) / step * (1.0 + 1e-12) + 1e-9);
    char text[64];
    if (!(step != 0.0) || !(steps >= 0.0)) {
        return wrong(param, "must be FIRST:LAST or FIRST:LAST:STEP with a step towards the last",
                     err);
    }
    if (steps >= MOST_VALUES) {
        return wrong(param, "has more than a million values", err);
    }
    for (size_t i = 0; i <= (size_t)steps; i++) {
        const double value = range[0] + (double)i * step;
        // 0.1 + 2 * 0.1 is what was meant by 0.3, not the number beside it.
        (void)snprintf(text, sizeof text, "%.12g", value);
        const double round = strtod(text, NULL);
        (void)lac_units_exact(round, param->unit, text, sizeof text);
        LAC_TRY_RETURN(add_value(param, text, round, err));
    }
    param->number = true;
    return LAC_OK;
}

static lac_status read_distribution(lac_swept *param, const lac_units *units, char *arguments,
                                    lac_error *err)
{
    const lac_distribution *d = param->drawn;
    char must[160];
    size_t n = 0;
    (void)snprintf(must, sizeof must, "must be %s(%s)", d->name, d->arguments);
    for (char *part = arguments; part != NULL; n++) {
        char *next = cut(part, ',');
        char *end = NULL;
        if (n >= d->count) {
            return wrong(param, must, err);
        }
        if (n + 1 == d->count && d->last_plain) {
            param->argument[n] = strtod(part, &end);
            if (end == part || *trimmed(end) != '\0' || !isfinite(param->argument[n])) {
                return wrong(param, must, err);
            }
        } else if (!take_number(param, units, part, &param->argument[n])) {
            LAC_FAIL_IF(true, err, LAC_EINPUT, "--over: %s: \"%.*s\" must be quantities of %s",
                        param->key, SHOWN, param->said, param->word ? "one unit" : param->unit);
        }
        part = next;
    }
    if (n != d->count) {
        return wrong(param, must, err);
    }
    const char *why = d->wrong(param->argument);
    return why == NULL ? LAC_OK : wrong(param, why, err);
}

// The arguments between the brackets, cut out of a copy. @return NULL: it is no such call
static char *arguments_of(char *text, const char *name)
{
    const size_t n = strlen(name), length = strlen(text);
    if (strncmp(text, name, n) != 0 || text[n] != '(' || text[length - 1] != ')') {
        return NULL;
    }
    text[length - 1] = '\0';
    return text + n + 1;
}

static lac_status read_csv(const char *path, lac_sweep *sweep, lac_swept *only, const char *column,
                           lac_case *base, const lac_units *units, lac_error *err);

static lac_status read_values(lac_swept *param, char *text, const lac_units *units, lac_error *err)
{
    double range[3];
    for (size_t i = 0; i < sizeof distributions / sizeof *distributions; i++) {
        char *arguments = arguments_of(text, distributions[i].name);
        if (arguments != NULL) {
            param->drawn = &distributions[i];
            return read_distribution(param, units, arguments, err);
        }
    }
    char *file = arguments_of(text, "column");
    if (file != NULL) {
        char *name = cut(file, ',');
        if (name == NULL) {
            return wrong(param, "must be column(FILE.csv, NAME)", err);
        }
        return read_csv(trimmed(file), NULL, param, trimmed(name), NULL, units, err);
    }
    if (read_range(param, units, text, range)) {
        return add_range(param, range, err);
    }
    for (char *part = text; part != NULL;) {
        char *next = cut(part, ',');
        LAC_TRY_RETURN(add_text(param, units, part, err));
        part = next;
    }
    return LAC_OK;
}

bool lac_swept_key(const lac_swept *param, size_t index, char key[LAC_SWEEP_KEY])
{
    const char *at = param->key;
    for (; index > 0 && at != NULL; index--) {
        at = strchr(at, '+');
        at = at != NULL ? at + 1 : NULL;
    }
    if (at != NULL) {
        (void)snprintf(key, LAC_SWEEP_KEY, "%.*s", (int)strcspn(at, "+"), at);
    }
    return at != NULL;
}

// Its unit, where the case has it as a number that can be set.
static void find_unit(lac_swept *param, lac_case *base)
{
    lac_case_value found;
    char key[LAC_SWEEP_KEY];
    for (size_t i = 0; lac_swept_key(param, i, key); i++) {
        param->word = param->word || !lac_case_find(base, key, &found);
        if (!param->word) {
            (void)snprintf(param->unit, sizeof param->unit, "%s", found.param->unit);
        }
    }
    param->number = true;
}

static lac_status read_swept(lac_swept *param, const char *key, size_t length, const char *values,
                             lac_case *base, lac_error *err)
{
    *param = (lac_swept){.key = strndup(key, length), .said = strdup(values)};
    LAC_FAIL_MEMORY_IF(param->key == NULL || param->said == NULL, err);
    for (const char *at = param->key; at != NULL; at = strchr(at + 1, '+')) {
        const size_t longest = strcspn(at + 1, "+");
        LAC_FAIL_IF(longest == 0 || longest + 2 > LAC_SWEEP_KEY, err, LAC_EINPUT,
                    "--over: \"%.*s\" must be a key of the case, or several with + between them",
                    SHOWN, param->key);
    }
    find_unit(param, base);
    return LAC_OK;
}

lac_status lac_swept_read(lac_swept *param, const char *said, lac_case *base, lac_error *err)
{
    const char *equals = strchr(said, '=');
    lac_units *units = NULL;
    char *text = NULL;
    lac_status status;
    LAC_FAIL_IF(equals == NULL || equals == said || equals[1 + strspn(equals + 1, " ")] == '\0',
                err, LAC_EINPUT,
                "--over: \"%.*s\" must be KEY=VALUES, such as "
                "\"friction.aging.dc=uniform(1 cm, 5 cm)\"",
                SHOWN, said);
    LAC_TRY(read_swept(param, said, (size_t)(equals - said), equals + 1, base, err));
    text = strdup(param->said);
    LAC_TRY(text == NULL ? lac_fail_memory(err) : LAC_OK);
    LAC_TRY(lac_units_create(&units, err));
    LAC_TRY(read_values(param, trimmed(text), units, err));
    if (param->unit[0] == '\0') {
        (void)snprintf(param->unit, sizeof param->unit, "1");
    }
out:
    lac_units_free(units);
    free(text);
    return status;
}

static lac_status grow(lac_sweep *sweep, lac_error *err)
{
    lac_swept *grown = realloc(sweep->param, (sweep->params + 1) * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    sweep->param = grown;
    sweep->param[sweep->params++] = (lac_swept){0};
    return LAC_OK;
}

// A column "key:unit" of a table, whose unit stands behind each of its numbers.
typedef struct column {
    size_t param; // SIZE_MAX: not wanted
    char unit[32];
} column;

enum { MOST_COLUMNS = 256 };

typedef struct header {
    column of[MOST_COLUMNS]; // [count]
    size_t count;
} header;

// The header: what each column is.
static lac_status read_header(const char *path, char *line, lac_sweep *sweep, lac_swept *only,
                              const char *name, lac_case *base, header *columns, lac_error *err)
{
    bool found = false;
    columns->count = 0;
    for (char *part = line; part != NULL;) {
        char *next = cut(part, ',');
        char *head = trimmed(part), *colon = strrchr(head, ':');
        LAC_FAIL_IF(columns->count >= MOST_COLUMNS, err, LAC_EINPUT,
                    "%s:1: has more than %d columns", path, MOST_COLUMNS);
        column *c = &columns->of[columns->count++];
        *c = (column){.param = SIZE_MAX};
        if (colon != NULL) {
            *colon = '\0';
            (void)snprintf(c->unit, sizeof c->unit, "%s", trimmed(colon + 1));
        }
        if (only != NULL && strcmp(head, name) == 0) {
            c->param = 0;
            found = true;
        } else if (only == NULL) {
            LAC_TRY_RETURN(grow(sweep, err));
            c->param = sweep->params - 1;
            LAC_TRY_RETURN(
                read_swept(&sweep->param[c->param], head, strlen(head), path, base, err));
        }
        part = next;
    }
    LAC_FAIL_IF(only != NULL && !found, err, LAC_EINPUT, "--over: %s: %s:1: has no column \"%s\"",
                only->key, path, name);
    return LAC_OK;
}

static lac_status read_row(const char *path, size_t line, char *row, lac_swept *params,
                           const header *columns, const lac_units *units, lac_error *err)
{
    size_t n = 0;
    char text[256];
    for (char *part = row; part != NULL; n++) {
        char *next = cut(part, ',');
        if (n < columns->count && columns->of[n].param != SIZE_MAX) {
            const char *unit = columns->of[n].unit;
            (void)snprintf(text, sizeof text, "%s%s%s", trimmed(part), unit[0] != '\0' ? " " : "",
                           unit);
            lac_error why = {""};
            const lac_status status = add_text(&params[columns->of[n].param], units, text, &why);
            LAC_FAIL_IF(status != LAC_OK, err, status, "%s:%zu: %s", path, line, why.message);
        }
        part = next;
    }
    LAC_FAIL_IF(n != columns->count, err, LAC_EINPUT,
                "%s:%zu: has %zu values, the header %zu names", path, line, n, columns->count);
    return LAC_OK;
}

// A table of values; of `only` one column.
static lac_status read_csv(const char *path, lac_sweep *sweep, lac_swept *only, const char *name,
                           lac_case *base, const lac_units *units, lac_error *err)
{
    header columns = {.count = 0};
    size_t number = 0, rows = 0, size = 0;
    char *line = NULL;
    lac_status status = LAC_OK;
    FILE *file = fopen(path, "r");
    LAC_FAIL_IF(file == NULL, err, LAC_EIO, "%s: %s", path, strerror(errno));
    while (status == LAC_OK && getline(&line, &size, file) > 0) {
        char *text = trimmed(line);
        number++;
        if (*text == '\0' || *text == '#') {
            continue;
        }
        if (columns.count == 0) {
            status = read_header(path, text, sweep, only, name, base, &columns, err);
        } else if (++rows > MOST_VALUES) {
            status = lac_fail(err, LAC_EINPUT, "%s: has more than a million rows", path);
        } else {
            status = read_row(path, number, text, only != NULL ? only : sweep->param, &columns,
                              units, err);
        }
    }
    free(line);
    (void)fclose(file);
    LAC_FAIL_IF(status == LAC_OK && rows == 0, err, LAC_EINPUT, "%s: holds no rows of values",
                path);
    return status;
}

lac_status lac_swept_table(lac_sweep *sweep, const char *path, lac_error *err)
{
    lac_units *units = NULL;
    const size_t first = sweep->params;
    lac_status status;
    LAC_TRY(lac_units_create(&units, err));
    LAC_TRY(read_csv(path, sweep, NULL, NULL, sweep->base, units, err));
    for (size_t p = first; p < sweep->params; p++) {
        if (sweep->param[p].unit[0] == '\0') {
            (void)snprintf(sweep->param[p].unit, sizeof sweep->param[p].unit, "1");
        }
    }
out:
    lac_units_free(units);
    return status;
}
