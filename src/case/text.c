// SPDX-License-Identifier: GPL-3.0-or-later
// The resolved case as text that reads back to the same case: the table of parts, walked.
#include "base/date.h"
#include "base/hidden.h"
#include "base/temp_file.h"
#include "case/sections.h"

typedef struct lac_writer {
    FILE *out;
    size_t folder; // length of the folder that relative paths start from
    const char *name;
} lac_writer;

#define PRINT(w, ...) (void)fprintf((w)->out, __VA_ARGS__)

// A text as YAML takes it within double quotes: hidden characters and some others are escaped.
static void put_escaped(lac_writer *w, const char *text)
{
    while (*text != '\0') {
        uint32_t c;
        const size_t length = lac_utf8_length((const unsigned char *)text, &c);
        const size_t n = length > 0 ? length : 1; // of what is no UTF-8
        const bool plain =
            c != '"' && c != '\\' && c != 0x7f && c >= 0x20 && c != 0xfffe && c != 0xffff;
        if (plain && lac_hidden_length(text, n) == 0) {
            PRINT(w, "%.*s", (int)n, text);
        } else {
            PRINT(w, c > 0xffff ? "\\U%08X" : "\\u%04X", c);
        }
        text += n;
    }
}

static void put_key(lac_writer *w, int depth, const char *key)
{
    PRINT(w, "%*s%s:", 2 * depth, "", key);
}

static void put_text(lac_writer *w, int depth, const char *key, const char *text)
{
    if (text != NULL) {
        put_key(w, depth, key);
        PRINT(w, " \"");
        put_escaped(w, text);
        PRINT(w, "\"\n");
    }
}

static void put_number(lac_writer *w, int depth, const char *key, double value, const char *unit)
{
    char text[100];
    bool plain = strcmp(unit, "1") == 0;
    put_key(w, depth, key);
    (void)lac_units_exact(value, unit, text, sizeof text);
    PRINT(w, plain ? " %s\n" : " \"%s\"\n", text);
}

static void put_param(lac_writer *w, int depth, const lac_param *param, const void *params)
{
    const void *at = (const char *)params + param->offset;
    const char *text;
    switch (param->type) {
    case LAC_REAL:
        put_number(w, depth, param->key, *(const double *)at, param->unit);
        break;
    case LAC_INTEGER:
        put_key(w, depth, param->key);
        PRINT(w, " %lld\n", (long long)*(const int64_t *)at);
        break;
    case LAC_CHOICE:
        put_key(w, depth, param->key);
        PRINT(w, " %s\n", param->choices[*(const int *)at]);
        break;
    case LAC_PATH:
    case LAC_TEXT:
        text = *(const char *const *)at;
        if (param->type == LAC_PATH && text != NULL && strncmp(text, w->name, w->folder) == 0 &&
            text[w->folder] != '/' && text[w->folder] != '\0') {
            text += w->folder; // as the case names it: from its folder
        }
        put_text(w, depth, param->key, text);
        break;
    }
}

// The values of a table that were given or have a default, behind them columns, "column:unit".
static void put_table(lac_writer *w, int depth, const lac_section *table, const void *params)
{
    for (size_t i = 0; i < table->param_count; i++) {
        const lac_param *param = &table->params[i];
        if (!lac_param_owned(param) && lac_param_given(param, params)) {
            put_param(w, depth, param, params);
        }
    }
    for (size_t i = 0; i < table->param_count; i++) {
        const lac_param *param = &table->params[i];
        const char *const *column = (const void *)((const char *)params + param->offset);
        if ((param->flags & LAC_COLUMN_FLAG) != 0 && lac_param_given(param, params)) {
            put_key(w, depth, param->key);
            PRINT(w, " \"");
            put_escaped(w, column[0]);
            PRINT(w, ":%s\"\n", column[1] != NULL ? column[1] : param->unit); // else SI
        }
    }
}

// "MODEL:" and its parameters below; the caller has written the indentation.
static void put_model(lac_writer *w, int depth, const lac_model *model)
{
    PRINT(w, "%s:", model->info->name);
    const long before = ftell(w->out);
    PRINT(w, "\n");
    put_table(w, depth + 1, model->info, model->params);
    if (ftell(w->out) == before + 1 && fseek(w->out, before, SEEK_SET) == 0) {
        PRINT(w, " {}\n");
    }
}

static void put_slot(lac_writer *w, int depth, const char *key, const lac_model *model)
{
    if (model->info != NULL) {
        put_key(w, depth, key);
        PRINT(w, "\n%*s", 2 * (depth + 1), "");
        put_model(w, depth + 1, model);
    }
}

static bool same_key(const lac_heterogeneity_list *list, size_t i, size_t j)
{
    return i < list->count && j < list->count && strcmp(list->item[i].key, list->item[j].key) == 0;
}

// Spreads of one parameter stand together: one as a model, several as a list.
static void put_spreads(lac_writer *w, const lac_heterogeneity_list *list)
{
    if (list->count > 0) {
        put_key(w, 1, "spread");
        PRINT(w, "\n");
    }
    for (size_t i = 0; i < list->count; i++) {
        const lac_heterogeneity *spread = &list->item[i];
        bool begun = i > 0 && same_key(list, i - 1, i);
        if (!begun && !same_key(list, i, i + 1)) {
            put_slot(w, 2, spread->key, &spread->model);
            continue;
        }
        if (!begun) {
            put_key(w, 2, spread->key);
            PRINT(w, "\n");
        }
        PRINT(w, "%*s- ", 2 * 3, "");
        put_model(w, 4, &spread->model);
    }
}

void lac_put_state(lac_writer *w, const lac_case *c)
{
    const lac_initial_def *initial = &c->initial;
    if (initial->state == LAC_STATE_STEADY) {
        PRINT(w, "  state: steady\n");
    } else if (initial->state == LAC_STATE_TIME) {
        put_number(w, 1, "state", initial->state_value, "s");
    } else if (initial->state == LAC_STATE_RATIO) {
        PRINT(w, "  state:\n");
        put_number(w, 2, "ratio_to_steady", initial->state_value, "1");
    }
}

// A date keeps its fraction of a second.
void lac_put_start(lac_writer *w, const lac_case *c)
{
    char text[32], fraction[32];
    if (!c->dated) {
        put_number(w, 1, "start", c->start_date, "s");
        return;
    }
    double whole = floor(c->start_date);
    (void)lac_date_format(whole, text, sizeof text);
    if (c->start_date == whole) {
        PRINT(w, "  start: \"%s\"\n", text);
        return;
    }
    text[strlen(text) - 1] = '\0';
    (void)snprintf(fraction, sizeof fraction, "%.15f", c->start_date - whole);
    PRINT(w, "  start: \"%s.%sZ\"\n", text, fraction + strlen(fraction) - 15);
}

void lac_put_fields(lac_writer *w, const lac_case *c)
{
    const char *comma = "";
    PRINT(w, "  fields: [");
    const char *name;
    for (unsigned k = 0; (name = lac_run_field(k)) != NULL; k++) {
        if ((c->fields & (1u << k)) != 0) {
            PRINT(w, "%s%s", comma, name);
            comma = ", ";
        }
    }
    PRINT(w, "]\n");
}

// Without a rate an empty mapping, in the line of its key.
void lac_put_safety(lac_writer *w, const lac_case *c)
{
    if (!(c->safety.reference_rate > 0.0) && fseek(w->out, -1, SEEK_CUR) == 0) {
        PRINT(w, " {}\n");
    }
}

// A step holds only what it names, so that the longest history stays within what is read.
void lac_put_steps(lac_writer *w, const lac_case *c)
{
    PRINT(w, "    steps:\n");
    for (size_t i = 0; i < c->history.count; i++) {
        lac_history_step step = c->history.step[i];
        step.count = step.count == 1 ? INT64_MIN : step.count;
        PRINT(w, "      -\n");
        put_table(w, 4, lac_section_find("load.history.steps"), &step);
    }
}

void lac_put_compare(lac_writer *w, const lac_case *c)
{
    if (c->compare_count > 0) {
        PRINT(w, "compare:\n");
    }
    for (size_t i = 0; i < c->compare_count; i++) {
        PRINT(w, "  -\n");
        put_table(w, 2, lac_section_find("compare"), &c->compare[i]);
    }
}

void lac_put_points(lac_writer *w, const lac_case *c)
{
    PRINT(w, "  points:\n");
    for (size_t i = 0; i < c->points; i++) {
        PRINT(w, "    -\n");
        put_table(w, 3, lac_section_find("output.points"), &c->point[i]);
    }
}

void lac_put_list(lac_writer *w, const char *key, const char *unit, const double *value,
                  size_t count)
{
    if (count == 1) {
        put_number(w, 2, key, value[0], unit);
        return;
    }
    put_key(w, 2, key);
    for (size_t i = 0; i < count; i++) {
        char text[100];
        PRINT(w, i == 0 ? " [\"%s\"" : ", \"%s\"",
              lac_units_exact(value[i], unit, text, sizeof text));
    }
    PRINT(w, "]\n");
}

void lac_put_betas(lac_writer *w, const lac_case *c)
{
    put_key(w, 1, "beta");
    PRINT(w, c->rg.betas == 0 ? " from-friction" : " [");
    for (size_t i = 0; i < c->rg.betas; i++) {
        char text[100];
        (void)lac_units_exact(c->rg.beta[i], "1", text, sizeof text);
        PRINT(w, i > 0 ? ", %s" : "%s", text);
    }
    PRINT(w, c->rg.betas == 0 ? "\n" : "]\n");
}

void lac_put_analysis(lac_writer *w, const lac_case *c)
{
    if (c->analysis.count > 0) {
        PRINT(w, "analysis:\n");
    }
    for (size_t i = 0; i < c->analysis.count; i++) {
        PRINT(w, "  ");
        put_model(w, 1, &c->analysis.item[i]);
    }
}

static const char *quoted(double value, const char *unit, char *text, size_t size)
{
    char plain[80];
    (void)snprintf(text, size, "\"%s\"", lac_units_exact(value, unit, plain, sizeof plain));
    return text;
}

void lac_put_fitted(lac_writer *w, const lac_case *c)
{
    PRINT(w, "  parameters:%s\n", c->fit.count == 0 ? " {}" : "");
    for (size_t i = 0; i < c->fit.count; i++) {
        const lac_fit_parameter *p = &c->fit.parameter[i];
        char low[90], high[90];
        PRINT(w, "    %s: {", p->key);
        if (p->ranged) {
            PRINT(w, "range: [%s, %s], ", quoted(p->low, p->unit, low, sizeof low),
                  quoted(p->high, p->unit, high, sizeof high));
        }
        if (p->prior == LAC_PRIOR_FLAT) {
            PRINT(w, "prior: {%s: {}}}\n", p->log ? "log-uniform" : "uniform");
        } else {
            PRINT(w, "prior: {%s: {%s: %s, sigma: %s}}}\n", p->log ? "lognormal" : "normal",
                  p->log ? "median" : "mean", quoted(p->centre, p->unit, low, sizeof low),
                  quoted(p->sigma, p->log ? "1" : p->unit, high, sizeof high));
        }
    }
}

static void put_part(lac_writer *w, const lac_part *part, const lac_case *c)
{
    const char *key = part->info.name;
    const void *at = (const char *)c + part->at;
    int depth = 0;
    for (const char *dot = strchr(key, '.'); dot != NULL; dot = strchr(key, '.'), depth++) {
        key = dot + 1;
    }
    if (part->kind == LAC_PART_RECORD && lac_section_key(&part->info, 0) == NULL) {
        put_key(w, depth++, key);
        PRINT(w, "\n");
    }
    if (part->put != NULL) {
        part->put(w, c);
    }
    if (part->kind == LAC_PART_RECORD) {
        put_table(w, depth, &part->info, c);
    } else if (part->kind == LAC_PART_SLOT) {
        put_slot(w, depth, key, at);
    } else if (part->kind == LAC_PART_SLOTS) {
        const lac_model_list *list = at;
        if (list->count > 0) {
            put_key(w, depth, key);
            PRINT(w, "\n");
        }
        for (size_t i = 0; i < list->count; i++) {
            PRINT(w, "%*s- ", 2 * (depth + 1), "");
            put_model(w, depth + 2, &list->item[i]);
        }
    } else if (part->kind == LAC_PART_SPREADS) {
        put_spreads(w, at);
    } else if (part->kind == LAC_PART_CADENCE) {
        put_key(w, depth, key);
        PRINT(w, "\n");
        put_table(w, depth + 1, lac_section_find("output.every"), at);
    }
}

char *lac_case_text(const lac_case *c)
{
    const lac_part *part;
    const char *absent = NULL; // what is below it is left out too
    char *text = NULL;
    size_t size = 0;
    FILE *out = c != NULL ? open_memstream(&text, &size) : NULL;
    if (out == NULL) {
        return NULL;
    }
    lac_writer w = {.out = out, .name = c->path, .folder = lac_folder_length(c->path)};
    PRINT(&w, "lacuna: 1\n");
    for (size_t i = 0; (part = lac_part_get(i)) != NULL; i++) {
        if (absent != NULL && lac_key_behind(part->info.name, absent) != NULL) {
            continue;
        }
        if (part->given != NULL && !part->given(c)) {
            absent = part->info.name;
        } else {
            put_part(&w, part, c);
        }
    }
    return lac_text_made(out, &text);
}
