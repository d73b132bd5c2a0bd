// SPDX-License-Identifier: GPL-3.0-or-later
// A mapping of a case, read by the rows of its table: values, units, ranges, unknown keys.
#define _GNU_SOURCE // asprintf
#include "base/temp_file.h"
#include "case/sections.h"

enum {
    MAX_KNOWN = 64,
    MOST_LISTED = 12, // choices of which the nearest is not named besides
};

static const double largest_whole = 0x1p53 - 1.0; // beyond it doubles stand for several

bool lac_read_number(lac_reader *reader, const lac_node *node, const char *unit, double *value)
{
    lac_error err = {""};
    bool scalar = node->kind == LAC_NODE_SCALAR;
    if (lac_units_parse(reader->units, scalar ? node->text : "", unit, value, &err) == LAC_OK) {
        return true;
    }
    lac_add_error(reader, node, "%s", err.message);
    return false;
}

bool lac_in_range(lac_reader *reader, const lac_node *node, const lac_param *param, double value)
{
    char why[160];
    bool allowed = lac_param_allows(param, value, why, sizeof why);
    if (!allowed) {
        lac_add_error(reader, node, "%s", why);
    }
    return allowed;
}

static bool read_real(lac_reader *reader, const lac_node *node, const lac_param *param,
                      double *value)
{
    double number = NAN;
    bool good = lac_read_number(reader, node, param->unit, &number) &&
                lac_in_range(reader, node, param, number);
    *value = good ? number : *value;
    return good;
}

static bool read_integer(lac_reader *reader, const lac_node *node, const lac_param *param,
                         int64_t *value)
{
    double number = NAN;
    bool scalar = node->kind == LAC_NODE_SCALAR;
    if (scalar && (param->flags & LAC_OPEN) != 0 && strcmp(node->text, "auto") == 0) {
        return true;
    }
    if (!scalar || lac_units_parse(reader->units, node->text, "1", &number, NULL) != LAC_OK ||
        number != floor(number) || fabs(number) > largest_whole) {
        lac_add_error(reader, node, "must be a whole number");
        return false;
    }
    bool good = lac_in_range(reader, node, param, number);
    *value = good ? (int64_t)number : *value;
    return good;
}

static bool read_choice(lac_reader *reader, const lac_node *node, const lac_param *param,
                        int *value)
{
    char text[500];
    size_t n = 0;
    for (; param->choices[n] != NULL; n++) {
        if (node->kind == LAC_NODE_SCALAR && strcmp(param->choices[n], node->text) == 0) {
            *value = (int)n;
            return true;
        }
    }
    // a word that is near one of many is not easily found among them
    const bool scalar = node->kind == LAC_NODE_SCALAR;
    const char *near =
        scalar && n > MOST_LISTED ? lac_nearest(node->text, param->choices, n) : NULL;
    if (near != NULL) {
        (void)snprintf(text, sizeof text,
                       "is unknown; did you mean \"%s\"? It must be one of: ", near);
    } else {
        (void)snprintf(text, sizeof text, "must be %s", n > 1 ? "one of: " : "");
    }
    lac_append_names(text, sizeof text, param->choices, n);
    lac_add_error(reader, node, "%s", text);
    return false;
}

// A text that is not empty; NULL where it is wrong, which is then reported.
static char *read_text(lac_reader *reader, const lac_node *node, const char *allowed)
{
    if (node->kind != LAC_NODE_SCALAR || node->text[0] == '\0' || lac_node_is_null(node) ||
        node->bad) {
        lac_add_error(reader, node, "must be %s", allowed);
        return NULL;
    }
    return lac_reader_copy(reader, node->text, strlen(node->text));
}

char *lac_path_below(const char *folder, size_t length, const char *path)
{
    char *whole = NULL;
    return asprintf(&whole, "%.*s%s", (int)length, folder, path) >= 0 ? whole : NULL;
}

static char *read_path(lac_reader *reader, const lac_node *node)
{
    char *path = read_text(reader, node, "a file name");
    size_t folder = lac_folder_length(reader->name);
    if (path == NULL || path[0] == '/' || folder == 0) {
        return path;
    }
    char *whole = lac_path_below(reader->name, folder, path);
    reader->no_memory = reader->no_memory || whole == NULL;
    free(path);
    return whole;
}

bool lac_read_param(lac_reader *reader, const lac_node *node, const lac_param *param, void *params)
{
    void *at = (char *)params + param->offset;
    switch (param->type) {
    case LAC_REAL:
        return read_real(reader, node, param, at);
    case LAC_INTEGER:
        return read_integer(reader, node, param, at);
    case LAC_CHOICE:
        return read_choice(reader, node, param, at);
    case LAC_PATH:
        return (*(char **)at = read_path(reader, node)) != NULL;
    case LAC_TEXT:
        break;
    }
    return (*(char **)at = read_text(reader, node, "a text that is not empty")) != NULL;
}

// "column:unit", split at its last colon.
static void read_column(lac_reader *reader, const lac_node *node, const char *si, char **column)
{
    lac_error err = {""};
    double scale, offset;
    char *text = read_text(reader, node, "a column and its unit such as \"disp:mm\"");
    char *colon = text == NULL ? NULL : strrchr(text, ':');
    column[0] = text;
    if (colon == NULL) {
        return; // no unit: it is SI
    }
    *colon = '\0';
    if (colon == text) {
        lac_add_error(reader, node, "must be a column and its unit such as \"disp:mm\"");
    } else if (lac_units_convert(reader->units, colon + 1, si, &scale, &offset, &err) != LAC_OK ||
               offset != 0.0) {
        lac_add_error(reader, node, "the unit of the column %s", err.message);
    } else {
        column[1] = lac_reader_copy(reader, colon + 1, strlen(colon + 1));
    }
}

void lac_table_clear(const lac_model_info *table, void *params)
{
    for (size_t i = 0; i < table->param_count; i++) {
        const lac_param *param = &table->params[i];
        char **at = (char **)(void *)((char *)params + param->offset);
        bool text = param->type == LAC_TEXT || param->type == LAC_PATH;
        if (text && (param->flags & LAC_OWN_FLAG) == 0) {
            free(at[0]);
            free((param->flags & LAC_COLUMN_FLAG) != 0 ? at[1] : NULL);
        }
    }
}

void lac_table_reset(const lac_model_info *table, void *params)
{
    for (size_t i = 0; i < table->param_count; i++) {
        if (!lac_param_owned(&table->params[i])) {
            lac_param_reset(&table->params[i], params);
        }
    }
}

static void blame_unknown_key(lac_reader *reader, const lac_node *node, const lac_model_info *table)
{
    const char *known[MAX_KNOWN];
    const char *section;
    size_t n = 0;
    for (size_t i = 0; i < table->param_count && n < MAX_KNOWN; i++) {
        known[n++] = table->params[i].key;
    }
    for (size_t i = 0; n < MAX_KNOWN && (section = lac_section_key(table, i)) != NULL; i++) {
        known[n++] = section;
    }
    lac_add_error_unknown(reader, node, "key", known, n);
}

// Whether a key has no row but is that of a section.
static bool is_section(const lac_model_info *table, const char *key)
{
    const char *section;
    bool found = false;
    for (size_t i = 0; !found && (section = lac_section_key(table, i)) != NULL; i++) {
        found = strcmp(section, key) == 0;
    }
    return found;
}

bool lac_key_misspelt(const lac_node *map, const lac_model_info *table, const char *key)
{
    for (size_t i = 0; i < map->count; i++) {
        const char *given = map->child[i]->key;
        bool known = lac_param_find(table->params, table->param_count, given) != NULL ||
                     is_section(table, given);
        if (!known && lac_nearest(given, &key, 1) != NULL) {
            return true;
        }
    }
    return false;
}

// What might have told a value and does not: " (rock talc-gouge does not tell it)"; NULL: it is
// wrong, which is reported, and nobody knows what it would tell.
static const char *not_told(const lac_node *map, const lac_model_info *table, const void *params,
                            char *text, size_t size)
{
    text[0] = '\0';
    for (size_t i = 0; i < table->param_count; i++) {
        const lac_param *param = &table->params[i];
        if ((param->flags & LAC_TELLS) == 0 || lac_node_child(map, param->key) == NULL) {
            continue;
        }
        if (!lac_param_given(param, params)) {
            return NULL;
        }
        const int *chosen = (const void *)((const char *)params + param->offset);
        (void)snprintf(text, size, " (%s %s does not tell it)", param->key,
                       param->choices[*chosen]);
    }
    return text;
}

// Says what is wanted in the words of the error that another value would get.
static void blame_missing(lac_reader *reader, const lac_node *map, const lac_param *param,
                          const char *why)
{
    lac_error err = {""};
    double ignored;
    char path[LAC_KEY_LENGTH];
    const bool root = *lac_node_path(map, path, sizeof path) == '\0';
    lac_append(path, sizeof path, "%s%s", root ? "" : ".", param->key);
    if (param->type == LAC_REAL) {
        (void)lac_units_parse(reader->units, "", param->unit, &ignored, &err);
    }
    (void)lac_refuse(reader, true, path, "is missing%s%s%s", why,
                     err.message[0] == '\0' ? "" : ": ", err.message);
}

static void blame_all_missing(lac_reader *reader, const lac_node *map, const lac_model_info *table,
                              const void *params)
{
    char text[100];
    const char *why = not_told(map, table, params, text, sizeof text);
    for (size_t i = 0; why != NULL && i < table->param_count; i++) {
        const lac_param *param = &table->params[i];
        const bool follows = table->complete != NULL && lac_param_given(param, params);
        if (lac_param_required(param) && lac_node_child(map, param->key) == NULL && !follows &&
            !lac_key_misspelt(map, table, param->key)) {
            blame_missing(reader, map, param, why);
        }
    }
}

static void complete(lac_reader *reader, const lac_node *map, const lac_model_info *table,
                     void *params)
{
    uint64_t given = 0;
    for (size_t i = 0; i < table->param_count && i < 64; i++) {
        const lac_node *node = lac_node_child(map, table->params[i].key);
        given |= (uint64_t)(node != NULL) << i;
    }
    const char *fault = table->complete != NULL ? table->complete(params, given) : NULL;
    if (fault != NULL) {
        lac_add_error(reader, map, "%s", fault);
    }
}

void lac_read_table(lac_reader *reader, const lac_node *map, const lac_model_info *table,
                    const char *own, void *params)
{
    for (size_t i = 0; i < map->count; i++) {
        const lac_node *node = map->child[i];
        const lac_param *param = lac_param_find(table->params, table->param_count, node->key);
        bool mine = param != NULL ? lac_param_owned(param) : is_section(table, node->key);
        if (node->ignored || node->bad || mine || (own != NULL && strcmp(own, node->key) == 0)) {
            continue;
        }
        if (param == NULL) {
            blame_unknown_key(reader, node, table);
        } else {
            (void)lac_read_param(reader, node, param, params);
        }
    }
    complete(reader, map, table, params);
    blame_all_missing(reader, map, table, params);
    for (size_t i = 0; i < table->param_count; i++) {
        const lac_param *param = &table->params[i];
        const lac_node *node = lac_node_child(map, param->key);
        if ((param->flags & LAC_COLUMN_FLAG) != 0 && node != NULL) {
            read_column(reader, node, param->unit, (void *)((char *)params + param->offset));
        }
    }
}

bool lac_expect_map(lac_reader *reader, const lac_node *node, const char *allowed)
{
    if (node->kind != LAC_NODE_MAP) {
        lac_add_error(reader, node, "must be %s", allowed);
        return false;
    }
    return true;
}
