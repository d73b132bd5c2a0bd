// SPDX-License-Identifier: GPL-3.0-or-later
// What a sweep varies: keys with lists, ranges or distributions, read against the case.
#define _GNU_SOURCE // asprintf
#include "sweep/sweep.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/fail.h"
#include "base/units.h"
#include "sweep/design.h"

enum { MOST_VALUES = 1000000 };

static void trim(char *text)
{
    size_t from = strspn(text, " \t"), n = strlen(text);
    while (n > from && isspace((unsigned char)text[n - 1])) {
        n--;
    }
    memmove(text, text + from, n - from);
    text[n - from] = '\0';
}

// The value as a number, NaN where it is none, or of another dimension.
static double number_of(const lac_units *units, const lac_sweep_param *p, const char *text)
{
    double value = NAN;
    (void)lac_units_parse(units, text, p->unit, &value, NULL);
    return value;
}

static lac_status add_value(lac_sweep_param *p, const lac_units *units, const char *text,
                            lac_error *err)
{
    const size_t n = p->values;
    LAC_FAIL_IF(strlen(text) >= LAC_SWEEP_TEXT || *text == '\0', err, LAC_EINPUT,
                "--over %s: \"%s\" must be a value of 1 to %d bytes", p->key, text,
                LAC_SWEEP_TEXT - 1);
    void *text_room = realloc(p->text, (n + 1) * sizeof *p->text);
    p->text = text_room != NULL ? text_room : p->text;
    double *numbers = realloc(p->number, (n + 1) * sizeof *numbers);
    p->number = numbers != NULL ? numbers : p->number;
    LAC_FAIL_MEMORY_IF(text_room == NULL || numbers == NULL, err);
    (void)snprintf(p->text[n], LAC_SWEEP_TEXT, "%s", text);
    trim(p->text[n]);
    p->number[n] = number_of(units, p, p->text[n]);
    p->values++;
    return LAC_OK;
}

// first:last or first:last:step, whole or not, without a unit.
static bool read_range(const char *text, double *first, double *last, double *step)
{
    char rest;
    *step = 1.0;
    const int two = sscanf(text, "%lf:%lf%c", first, last, &rest);
    return two == 2 || (sscanf(text, "%lf:%lf:%lf%c", first, last, step, &rest) == 3);
}

static lac_status read_list(lac_sweep_param *p, const lac_units *units, const char *text,
                            lac_error *err)
{
    double first, last, step;
    if (read_range(text, &first, &last, &step)) {
        const double count = floor((last - first) / step * (1.0 + 1e-12)) + 1.0;
        LAC_FAIL_IF(!(count >= 1.0 && count <= MOST_VALUES), err, LAC_EINPUT,
                    "--over %s: \"%s\" must be a:b or a:b:step with a value at least", p->key,
                    text);
        for (size_t k = 0; k < (size_t)count; k++) {
            char value[LAC_SWEEP_TEXT];
            (void)snprintf(value, sizeof value, "%.15g", first + (double)k * step);
            LAC_TRY_RETURN(add_value(p, units, value, err));
        }
        return LAC_OK;
    }
    char *copy = strdup(text), *rest = copy;
    lac_status status = copy != NULL ? LAC_OK : lac_fail_memory(err);
    for (char *one; status == LAC_OK && (one = strsep(&rest, ",")) != NULL;) {
        trim(one);
        status = add_value(p, units, one, err);
    }
    free(copy);
    return status;
}

static const lac_distribution *find_distribution(const char *text)
{
    for (const lac_distribution *d = lac_distributions; d->name != NULL; d++) {
        const size_t n = strlen(d->name);
        if (strncmp(text, d->name, n) == 0 && text[n + strspn(text + n, " ")] == '(') {
            return d;
        }
    }
    return NULL;
}

static lac_status read_arguments(lac_sweep_param *p, const lac_units *units, const char *text,
                                 lac_error *err)
{
    const lac_distribution *d = p->distribution;
    char *copy = strdup(strchr(text, '(') + 1), *rest = copy;
    LAC_FAIL_MEMORY_IF(copy == NULL, err);
    char *end = strrchr(copy, ')');
    size_t n = 0;
    bool sound = end != NULL && end[1 + strspn(end + 1, " ")] == '\0';
    if (sound) {
        *end = '\0';
    }
    for (char *one; sound && (one = strsep(&rest, ",")) != NULL; n++) {
        sound = n < d->count && lac_units_parse(units, one, d->bare[n] ? "1" : p->unit,
                                                &p->given[n], NULL) == LAC_OK;
    }
    free(copy);
    LAC_FAIL_IF(!sound || n != d->count, err, LAC_EINPUT,
                "--over %s: \"%s\" must be %s(%s), with a unit of the dimension of %s", p->key,
                text, d->name, d->arguments, p->unit);
    LAC_FAIL_IF(d->wrong(p->given) != NULL, err, LAC_EINPUT, "--over %s: \"%s\" %s", p->key, text,
                d->wrong(p->given));
    return LAC_OK;
}

// The unit of the first of its keys that is a number of the case.
static void look_up(const lac_case *c, lac_sweep_param *p)
{
    char key[512];
    lac_case_value found;
    p->unit = "1";
    p->own = NAN;
    (void)snprintf(key, sizeof key, "%.*s", (int)strcspn(p->key, "+"), p->key);
    if (lac_case_find((lac_case *)c, key, &found)) {
        p->unit = found.param->unit;
        p->own = *found.at;
    }
}

static lac_status read_param(const lac_case *c, const lac_units *units, const lac_override *over,
                             lac_sweep_param *p, lac_error *err)
{
    p->key = strdup(over->key);
    p->name = strdup(over->key);
    LAC_FAIL_MEMORY_IF(p->key == NULL || p->name == NULL, err);
    p->name[strcspn(p->name, "+")] = '\0';
    for (char *at = p->name; *at != '\0'; at++) {
        *at = isalnum((unsigned char)*at) ? *at : '_';
    }
    look_up(c, p);
    p->distribution = find_distribution(over->value);
    if (p->distribution == NULL) {
        return read_list(p, units, over->value, err);
    }
    LAC_FAIL_IF(isnan(p->own) && p->unit[0] == '1', err, LAC_EINPUT,
                "--over %s: no number of the case that a distribution could be of; give a list or "
                "a range",
                p->key);
    return read_arguments(p, units, over->value, err);
}

static lac_status find_design(lac_sweep *s, const char *name, lac_error *err)
{
    bool lists = true;
    for (size_t p = 0; p < s->params; p++) {
        lists = lists && s->param[p].values > 0;
    }
    name = name != NULL ? name : lists ? "grid" : "random";
    for (const lac_design *d = lac_designs; d->name != NULL; d++) {
        s->design = strcmp(d->name, name) == 0 ? d : s->design;
    }
    LAC_FAIL_IF(s->design == NULL, err, LAC_EINPUT,
                "--design: \"%s\" must be grid, random, lhs, sobol, saltelli or tornado", name);
    LAC_FAIL_IF(!lists && strcmp(name, "grid") == 0, err, LAC_EINPUT,
                "--design: \"grid\" takes lists and ranges, no distributions");
    return LAC_OK;
}

lac_status lac_sweep_create(const lac_case *c, const lac_sweep_def *def, lac_sweep **out,
                            lac_error *err)
{
    lac_units *units = NULL;
    lac_sweep *s = calloc(1, sizeof *s);
    lac_status status;
    *out = NULL;
    LAC_TRY(s != NULL ? LAC_OK : lac_fail_memory(err));
    s->seed = def->seed;
    s->param = calloc(def->count + 1, sizeof *s->param);
    LAC_TRY(s->param != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_units_create(&units, err));
    for (size_t p = 0; p < def->count; p++) {
        s->params++;
        LAC_TRY(read_param(c, units, &def->over[p], &s->param[p], err));
    }
    LAC_TRY(find_design(s, def->design, err));
    s->members = s->design->members(s, def->members);
    LAC_LEAVE_IF(s->members < 1 || s->members > MOST_VALUES, err, LAC_EINPUT,
                 "the sweep must have 1 to %d members", MOST_VALUES);
    s->place = malloc((s->params * s->members + 1) * sizeof *s->place);
    LAC_TRY(s->place != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(s->design->fill(s, err));
    *out = s;
    s = NULL;
out:
    lac_units_free(units);
    lac_sweep_free(s);
    return status;
}

void lac_sweep_free(lac_sweep *sweep)
{
    for (size_t p = 0; sweep != NULL && p < sweep->params; p++) {
        free(sweep->param[p].key);
        free(sweep->param[p].name);
        free(sweep->param[p].text);
        free(sweep->param[p].number);
    }
    if (sweep != NULL) {
        free(sweep->param);
        free(sweep->place);
        free(sweep);
    }
}

static size_t pick(const lac_sweep_param *p, double place)
{
    const size_t k = (size_t)(place * (double)p->values);
    return k < p->values ? k : p->values - 1;
}

double lac_sweep_value(const lac_sweep *sweep, size_t member, size_t param)
{
    const lac_sweep_param *p = &sweep->param[param];
    const double place = sweep->place[param * sweep->members + member];
    if (isnan(place)) {
        return p->own;
    }
    if (p->distribution != NULL) {
        return p->distribution->at(p->given, place);
    }
    const size_t k = pick(p, place);
    return isnan(p->number[k]) ? (double)k : p->number[k];
}

const char *lac_sweep_text(const lac_sweep *sweep, size_t member, size_t param,
                           char room[LAC_SWEEP_TEXT])
{
    const lac_sweep_param *p = &sweep->param[param];
    const double place = sweep->place[param * sweep->members + member];
    if (isnan(place)) {
        return NULL;
    }
    if (p->distribution == NULL) {
        return p->text[pick(p, place)];
    }
    (void)snprintf(room, LAC_SWEEP_TEXT, "%.17g", p->distribution->at(p->given, place));
    return room;
}

const char *lac_sweep_design(const lac_sweep *sweep) { return sweep->design->name; }
