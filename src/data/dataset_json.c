// SPDX-License-Identifier: GPL-3.0-or-later
// A dataset as members of a JSON object: each row says by its path where its values stand.
#include "data/dataset.h"

// Rows that are written together, all with the same path up to `from`, and where they stand.
typedef struct group {
    const lac_dataset *dataset;
    const lac_entry *const *entry;
    size_t count;
    size_t from; // of their paths: what is yet to be written
    size_t rank; // dimensions that are passed
    size_t at[LAC_MOST_DIMS + 1];
} group;

static const char *path_of(const group *g, size_t row)
{
    return g->entry[row]->row->json + g->from;
}

// A part of a path, up to its '/' or end.
typedef struct part {
    char name[LAC_JSON_NAME];
    size_t length; // with the brackets
    size_t lists;  // pairs of []
    bool object;   // {}: labels and values
    bool last;
} part;

static part read_part(const char *path)
{
    part p = {.length = strcspn(path, "/")};
    const size_t name = strcspn(path, "/[{");
    memcpy(p.name, path, name);
    p.object = path[name] == '{';
    p.lists = p.object ? 0 : (p.length - name) / 2;
    p.last = path[p.length] == '\0';
    return p;
}

static const lac_extent *next_dim(const group *g)
{
    const lac_extent *dim[LAC_MOST_DIMS] = {NULL};
    (void)lac_entry_dims(g->dataset, g->entry[0], dim);
    return dim[g->rank];
}

static size_t place_of(const group *g, const lac_entry *entry)
{
    const lac_extent *dim[LAC_MOST_DIMS];
    size_t place = 0;
    for (size_t d = entry->own, rank = lac_entry_dims(g->dataset, entry, dim); d < rank; d++) {
        place = place * dim[d]->length + g->at[d];
    }
    return place;
}

static void write_value(const group *g, const lac_entry *entry, const char *key, lac_json *json)
{
    char room[LAC_TEXT_ROOM];
    if (lac_entry_is_text(entry)) {
        const char *text = lac_entry_text(entry, g->at, room);
        char *end = "";
        const bool may = (entry->row->flags & LAC_NUMERAL) != 0 && text != NULL && *text != '\0';
        const double number = may ? strtod(text, &end) : NAN;
        if (may && *end == '\0') {
            lac_json_number(json, key, number);
        } else {
            lac_json_text(json, key, text);
        }
    } else if (entry->of == NULL) {
        lac_json_null(json, key);
    } else if (entry->row->held == LAC_HELD_BOOL || (entry->row->flags & LAC_TRUTH) != 0) {
        lac_json_boolean(json, key, lac_entry_number(entry, g->at, 0) != 0.0);
    } else {
        lac_json_number(json, key, lac_entry_number(entry, g->at, place_of(g, entry)));
    }
}

// Values of rows with one path: one stands alone, several are a list.
static void write_leaf(const group *g, const char *key, lac_json *json)
{
    if (g->count == 1) {
        if (g->entry[0]->of == NULL || lac_entry_has(g->entry[0], g->at)) {
            write_value(g, g->entry[0], key, json);
        }
        return;
    }
    if (g->entry[0]->of != NULL && !lac_entry_has(g->entry[0], g->at)) {
        lac_json_null(json, key);
        return;
    }
    lac_json_open(json, key, '[');
    for (size_t i = 0; i < g->count; i++) {
        write_value(g, g->entry[i], NULL, json);
    }
    lac_json_close(json, ']');
}

static void write_labelled(group *g, const char *key, lac_json *json)
{
    const lac_entry *entry = g->entry[0];
    const size_t length = next_dim(g)->length;
    char room[LAC_TEXT_ROOM];
    lac_json_open(json, key, '{');
    for (size_t i = 0; i < length; i++) {
        g->at[g->rank] = i;
        if (lac_entry_has(entry, g->at)) {
            write_value(g, entry, lac_entry_label(entry, g->at, room), json);
        }
    }
    lac_json_close(json, '}');
}

static void write_members(const group *g, lac_json *json);

// As many lists in one another as there are brackets, then what stands in them.
static void write_part(const group *g, const part *p, size_t lists, const char *key, lac_json *json)
{
    group inner = *g;
    if (lists > 0) {
        const size_t length = next_dim(g)->length;
        inner.rank++;
        lac_json_open(json, key, '[');
        for (size_t i = 0; i < length; i++) {
            inner.at[g->rank] = i;
            write_part(&inner, p, lists - 1, NULL, json);
        }
        lac_json_close(json, ']');
    } else if (p->object) {
        write_labelled(&inner, key, json);
    } else if (p->last) {
        write_leaf(g, key, json);
    } else if (!lac_entry_has(g->entry[0], g->at)) {
        lac_json_null(json, key);
    } else {
        inner.from += p->length + 1;
        lac_json_open(json, key, '{');
        write_members(&inner, json);
        lac_json_close(json, '}');
    }
}

// The rows that share the first part of the first of them move to `own`. @return the others
static size_t take(const group *g, const part *p, const lac_entry **rest, group *own,
                   const lac_entry **taken)
{
    size_t left = 0;
    const char *with = path_of(g, 0);
    *own = *g;
    own->entry = taken;
    own->count = 0;
    for (size_t i = 0; i < g->count; i++) {
        const char *path = path_of(g, i);
        if (strncmp(path, with, p->length) == 0 && path[p->length] == with[p->length]) {
            taken[own->count++] = g->entry[i];
        } else {
            rest[left++] = g->entry[i];
        }
    }
    return left;
}

// Paths are a few parts deep.
static void write_members(const group *g, lac_json *json)
{
    const lac_entry *rest[LAC_MOST_ROWS] = {NULL}, *taken[LAC_MOST_ROWS] = {NULL};
    group left = *g;
    while (left.count > 0) {
        group own;
        const part p = read_part(path_of(&left, 0));
        left.count = take(&left, &p, rest, &own, taken);
        left.entry = rest;
        write_part(&own, &p, p.lists, p.name, json);
    }
}

void lac_dataset_json(const lac_dataset *dataset, lac_json *json)
{
    const lac_entry *entry[LAC_MOST_ROWS] = {NULL};
    size_t count = 0;
    for (size_t i = 0; i < dataset->entries; i++) {
        if (dataset->entry[i].row->json != NULL) {
            entry[count++] = &dataset->entry[i];
        }
    }
    const group all = {.dataset = dataset, .entry = entry, .count = count};
    write_members(&all, json);
}
