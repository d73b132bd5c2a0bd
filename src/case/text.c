// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "base/hidden.h"
#include "case/sections.h"

// A text that grows; `failed` once memory was short.
typedef struct writer {
    char *text;
    size_t used, size;
    bool failed;
    size_t folder; // length of the folder that relative paths start from
    const char *name;
} writer;

static void put_bytes(writer *w, const char *bytes, size_t n)
{
    if (!w->failed && w->used + n + 1 > w->size) {
        size_t size = 2 * (w->used + n + 1) + 1024;
        char *grown = realloc(w->text, size);
        w->failed = grown == NULL;
        w->text = grown != NULL ? grown : w->text;
        w->size = grown != NULL ? size : w->size;
    }
    if (!w->failed) {
        memcpy(w->text + w->used, bytes, n);
        w->used += n;
        w->text[w->used] = '\0';
    }
}

static void put(writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(writer *w, const char *format, ...)
{
    char line[512];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(line, sizeof line, format, args);
    va_end(args);
    put_bytes(w, line, strlen(line));
}

// One character of valid UTF-8; its length in `n`.
static unsigned decode(const unsigned char *p, size_t *n)
{
    unsigned c = p[0];
    *n = c < 0x80 ? 1 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : 4;
    if (*n == 1) {
        return c;
    }
    c &= 0xffu >> (*n + 1);
    for (size_t i = 1; i < *n; i++) {
        c = (c << 6) | (p[i] & 0x3fu);
    }
    return c;
}

// Whether YAML takes the character, which is not hidden, as it is within double quotes.
static bool is_printable(unsigned c)
{
    return c != '"' && c != '\\' && c != 0x7f && c >= 0x20 && c != 0xfffe && c != 0xffff;
}

static void put_quoted(writer *w, const char *text)
{
    put(w, "\"");
    while (*text != '\0') {
        size_t n;
        unsigned c = decode((const unsigned char *)text, &n);
        if (is_printable(c) && lac_hidden_length(text, n) == 0) {
            put_bytes(w, text, n);
        } else {
            put(w, c > 0xffff ? "\\U%08X" : "\\u%04X", c);
        }
        text += n;
    }
    put(w, "\"");
}

static void put_key(writer *w, int depth, const char *key) { put(w, "%*s%s:", 2 * depth, "", key); }

static void put_text(writer *w, int depth, const char *key, const char *text)
{
    if (text != NULL) {
        put_key(w, depth, key);
        put(w, " ");
        put_quoted(w, text);
        put(w, "\n");
    }
}

static void put_number(writer *w, int depth, const char *key, double value, const char *unit)
{
    char text[100];
    bool plain = strcmp(unit, "1") == 0;
    put_key(w, depth, key);
    (void)lac_units_exact(value, unit, text, sizeof text);
    put(w, plain ? " %s\n" : " \"%s\"\n", text);
}

// A path as the case names it: from the case's folder.
static const char *from_folder(const writer *w, const char *path)
{
    bool below = path != NULL && strncmp(path, w->name, w->folder) == 0 && path[w->folder] != '/' &&
                 path[w->folder] != '\0';
    return below ? path + w->folder : path;
}

static void put_param(writer *w, int depth, const lac_param *param, const void *params)
{
    const char *at = (const char *)params + param->offset;
    switch (param->type) {
    case LAC_REAL: {
        double value;
        memcpy(&value, at, sizeof value);
        put_number(w, depth, param->key, value, param->unit);
        return;
    }
    case LAC_INTEGER: {
        int64_t value;
        memcpy(&value, at, sizeof value);
        put_key(w, depth, param->key);
        put(w, " %lld\n", (long long)value);
        return;
    }
    case LAC_CHOICE: {
        int value;
        memcpy(&value, at, sizeof value);
        put_key(w, depth, param->key);
        put(w, " %s\n", param->choices[value]);
        return;
    }
    case LAC_TEXT:
    case LAC_PATH:
        break;
    }
    char *text;
    memcpy(&text, at, sizeof text);
    put_text(w, depth, param->key, param->type == LAC_PATH ? from_folder(w, text) : text);
}

// The values of a table that were given or have a default.
static void put_table(writer *w, int depth, const lac_table *table, const void *params)
{
    for (size_t i = 0; i < table->count; i++) {
        const lac_param *param = &table->params[i];
        if (!lac_table_owns(table, param->key) && lac_param_given(param, params)) {
            put_param(w, depth, param, params);
        }
    }
}

static void put_section(writer *w, int depth, int section, const void *params)
{
    lac_table table = lac_section_table(section);
    put_table(w, depth, &table, params);
}

static bool any_given(int section, const void *params)
{
    lac_table table = lac_section_table(section);
    for (size_t i = 0; i < table.count; i++) {
        if (lac_param_given(&table.params[i], params)) {
            return true;
        }
    }
    return false;
}

// "MODEL:" and its parameters below; the caller has written the indentation.
static void put_model(writer *w, int depth, const lac_slot *slot)
{
    const lac_table table = {.params = slot->about->params, .count = slot->about->param_count};
    put(w, "%s:", slot->about->name);
    size_t before = w->used;
    put(w, "\n");
    put_table(w, depth + 1, &table, slot->params);
    if (w->used == before + 1 && !w->failed) {
        w->used = before;
        put(w, " {}\n");
    }
}

static void put_slot(writer *w, int depth, const char *key, const lac_slot *slot)
{
    if (slot->about != NULL) {
        put_key(w, depth, key);
        put(w, "\n%*s", 2 * (depth + 1), "");
        put_model(w, depth + 1, slot);
    }
}

static void put_slots(writer *w, int depth, const char *key, const lac_slot_list *list)
{
    if (list->count > 0) {
        put_key(w, depth, key);
        put(w, "\n");
    }
    for (size_t i = 0; i < list->count; i++) {
        put(w, "%*s- ", 2 * (depth + 1), "");
        put_model(w, depth + 2, &list->item[i]);
    }
}

static bool same_key(const lac_spread_list *list, size_t i, size_t j)
{
    return i < list->count && j < list->count && strcmp(list->item[i].key, list->item[j].key) == 0;
}

// Spreads of one parameter stand together: one as a model, several as a list.
static void put_spreads(writer *w, const lac_spread_list *list)
{
    if (list->count > 0) {
        put_key(w, 1, "spread");
        put(w, "\n");
    }
    for (size_t i = 0; i < list->count; i++) {
        const lac_spread *spread = &list->item[i];
        bool begun = i > 0 && same_key(list, i - 1, i);
        if (!begun && !same_key(list, i, i + 1)) {
            put_slot(w, 2, spread->key, &spread->slot);
            continue;
        }
        if (!begun) {
            put_key(w, 2, spread->key);
            put(w, "\n");
        }
        put(w, "%*s- ", 2 * 3, "");
        put_model(w, 4, &spread->slot);
    }
}

static void put_cadence(writer *w, const char *key, const lac_cadence *cadence)
{
    put_key(w, 1, key);
    put(w, "\n");
    put_section(w, 2, LAC_SECTION_CADENCE, cadence);
}

static void put_initial(writer *w, const lac_case *c)
{
    const lac_initial_def *initial = &c->initial;
    bool given = initial->state != LAC_STATE_STEADY || !isnan(initial->slip_rate) ||
                 c->initial_spread.count > 0;
    if (c->friction.about == NULL && !given) {
        return; // a static case
    }
    put(w, "initial:\n");
    put_section(w, 1, LAC_SECTION_INITIAL, c);
    if (initial->state == LAC_STATE_STEADY) {
        put(w, "  state: steady\n");
    } else if (initial->state == LAC_STATE_TIME) {
        put_number(w, 1, "state", initial->state_value, "s");
    } else if (initial->state == LAC_STATE_RATIO) {
        put(w, "  state:\n");
        put_number(w, 2, "ratio_to_steady", initial->state_value, "1");
    }
    put_spreads(w, &c->initial_spread);
}

// A date keeps its fraction of a second.
static void put_start(writer *w, const lac_case *c)
{
    char text[32];
    char fraction[32];
    if (!c->dated) {
        put_number(w, 1, "start", c->start_date, "s");
        return;
    }
    double whole = floor(c->start_date);
    (void)lac_date_format(whole, text, sizeof text);
    if (c->start_date == whole) {
        put(w, "  start: \"%s\"\n", text);
        return;
    }
    text[strlen(text) - 1] = '\0';
    (void)snprintf(fraction, sizeof fraction, "%.15f", c->start_date - whole);
    put(w, "  start: \"%s.%sZ\"\n", text, fraction + strlen(fraction) - 15);
}

static void put_friction(writer *w, const lac_case *c)
{
    if (c->friction.about != NULL) {
        put(w, "friction:\n  ");
        put_model(w, 1, &c->friction);
        put_spreads(w, &c->friction_spread);
    }
}

static void put_time(writer *w, const lac_case *c)
{
    if (isnan(c->run.end)) {
        return; // a static case
    }
    put(w, "time:\n");
    put_start(w, c);
    put_section(w, 1, LAC_SECTION_TIME, c);
    put(w, "  failure:\n");
    put_section(w, 2, LAC_SECTION_FAILURE, c);
    if (any_given(LAC_SECTION_STOP, c)) {
        put(w, "  stop_when:\n");
        put_section(w, 2, LAC_SECTION_STOP, c);
    }
}

static void put_output(writer *w, const lac_case *c)
{
    put(w, "output:\n");
    put_section(w, 1, LAC_SECTION_OUTPUT, c);
    put_cadence(w, "every", &c->run.record);
    const lac_cadence *save = &c->run.checkpoint;
    if (!isnan(save->time) || save->steps > 0 || !isnan(save->per_decade)) {
        put_cadence(w, "checkpoint", save);
    }
    if (c->fields == 0) {
        return;
    }
    const char *comma = "";
    put(w, "  fields: [");
    for (unsigned k = 0; lac_field_names[k] != NULL; k++) {
        if ((c->fields & (1u << k)) != 0) {
            put(w, "%s%s", comma, lac_field_names[k]);
            comma = ", ";
        }
    }
    put(w, "]\n");
    put_cadence(w, "fields_every", &c->run.snapshot);
}

// A step holds only what it names, so that the longest history stays within what is read.
static void put_history(writer *w, const lac_case *c)
{
    if (c->history.count > 0) {
        put(w, "  history:\n");
        put_section(w, 2, LAC_SECTION_HISTORY, c);
        put(w, "    steps:\n");
    }
    for (size_t i = 0; i < c->history.count; i++) {
        lac_history_step step = c->history.step[i];
        step.count = step.count == 1 ? INT64_MIN : step.count;
        put(w, "      -\n");
        put_section(w, 4, LAC_SECTION_STEP, &step);
    }
}

// "column:unit", SI where no unit was given.
static void put_column(writer *w, int depth, const char *key, const char *column, const char *unit,
                       const char *si)
{
    if (column != NULL) {
        put_key(w, depth, key);
        put(w, " ");
        size_t n = strlen(column);
        put_quoted(w, column);
        if (n > 0 && !w->failed) {
            w->used--; // the unit goes inside the quotes
        }
        put(w, ":%s\"\n", unit != NULL ? unit : si);
    }
}

static void put_compare(writer *w, const lac_case *c)
{
    if (c->compare_count > 0) {
        put(w, "compare:\n");
    }
    for (size_t i = 0; i < c->compare_count; i++) {
        const lac_compare_def *def = &c->compare[i];
        put(w, "  -\n");
        put_section(w, 2, LAC_SECTION_COMPARE, def);
        put_column(w, 2, "displacement", def->displacement, def->displacement_unit, "m");
        put_column(w, 2, "velocity", def->velocity, def->velocity_unit, "m/s");
    }
}

static void put_rg(writer *w, const lac_case *c)
{
    if (!c->rg.named) {
        return;
    }
    put(w, "rg:\n");
    put_section(w, 1, LAC_SECTION_RG, c);
    put_key(w, 1, "beta");
    put(w, c->rg.betas == 0 ? " from-friction" : " [");
    for (size_t i = 0; i < c->rg.betas; i++) {
        char text[100];
        (void)lac_units_exact(c->rg.beta[i], "1", text, sizeof text);
        put(w, i > 0 ? ", %s" : "%s", text);
    }
    put(w, c->rg.betas == 0 ? "\n" : "]\n");
}

static void put_analysis(writer *w, const lac_case *c)
{
    if (c->analysis.count > 0) {
        put(w, "analysis:\n");
    }
    for (size_t i = 0; i < c->analysis.count; i++) {
        const lac_slot *slot = &c->analysis.item[i];
        put(w, "  ");
        put_model(w, 1, slot);
        const lac_analysis_rg *rg = lac_analysis_cascade(slot);
        if (rg != NULL && rg->beta_from_friction) {
            put(w, "    beta: from-friction\n");
        }
    }
}

static void put_fit(writer *w, const lac_case *c)
{
    if (!c->fit.named) {
        return;
    }
    char *parameters = lac_fit_text(&c->fit);
    w->failed = w->failed || parameters == NULL;
    put(w, "fit:\n");
    if (parameters != NULL) {
        put_bytes(w, parameters, strlen(parameters));
    }
    put_section(w, 1, LAC_SECTION_FIT, c);
    put_column(w, 1, "displacement", c->fit.displacement, c->fit.displacement_unit, "m");
    put_column(w, 1, "velocity", c->fit.velocity, c->fit.velocity_unit, "m/s");
    put_column(w, 1, "sigma", c->fit.sigma, c->fit.sigma_unit, "m");
    free(parameters);
}

char *lac_case_text(const lac_case *c)
{
    writer w = {.name = c->path, .folder = lac_folder_length(c->path)};
    put(&w, "lacuna: 1\n");
    put_section(&w, 0, LAC_SECTION_CASE, c);
    put(&w, "interface:\n");
    put_section(&w, 1, LAC_SECTION_INTERFACE, c);
    put_slot(&w, 1, "surface", &c->surface);
    put_slot(&w, 1, "domain", &c->domain);
    put_spreads(&w, &c->interface_spread);
    put(&w, "material:\n");
    put_section(&w, 1, LAC_SECTION_MATERIAL, c);
    if (lac_inertia_mass(c) > 0.0) {
        put(&w, "inertia:\n");
        put_section(&w, 1, LAC_SECTION_INERTIA, c);
    }
    put(&w, "load:\n");
    put_slot(&w, 1, "normal", &c->normal);
    put_slots(&w, 1, "shear", &c->shear);
    put_slots(&w, 1, "pore_pressure", &c->pore);
    put_history(&w, c);
    put_friction(&w, c);
    put_initial(&w, c);
    put_slot(&w, 0, "transfer", &c->transfer);
    put_time(&w, c);
    put(&w, "solver:\n");
    put_section(&w, 1, LAC_SECTION_SOLVER, c);
    put_output(&w, c);
    put_rg(&w, c);
    put_analysis(&w, c);
    put_fit(&w, c);
    put_compare(&w, c);
    if (w.failed) {
        free(w.text);
        return NULL;
    }
    return w.text;
}
