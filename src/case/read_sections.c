// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a case by the table of its parts, and what single parts need besides.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "case/sections.h"

enum { FORMAT_VERSION = 1 };

// Whether a section that must be there isn't, nor is misspelt, which was reported.
static bool section_lacks(const lac_reader *reader, const char *key)
{
    lac_table table = lac_section_table("case");
    return lac_node_child(reader->root, key) == NULL &&
           !lac_key_misspelt(reader->root, &table, key);
}

bool lac_needs_run(const lac_reader *reader)
{
    // What names a case as static: an approach or a dimension for a load, or a history or a
    // cascade and no time to run through.
    bool timeless = lac_node_child(reader->root, "time") == NULL;
    bool statics = lac_node_at(reader->root, "load.history") != NULL ||
                   lac_node_child(reader->root, "rg") != NULL;
    bool is_static = lac_node_at(reader->root, "load.normal.approach") != NULL ||
                     lac_node_at(reader->root, "load.normal.dimension") != NULL ||
                     (timeless && statics);
    return reader->purpose == LAC_FOR_RUN || reader->purpose == LAC_FOR_FIT ||
           (reader->purpose == LAC_FOR_CHECK && !is_static);
}

void lac_read_version(lac_reader *reader, const lac_node *root, lac_case *c)
{
    const lac_node *node = lac_node_child(root, "lacuna");
    (void)c;
    if (node == NULL) {
        lac_blame_missing(reader, reader->root, "lacuna",
                          "is missing: a case starts with its format's version, lacuna: %d",
                          FORMAT_VERSION);
    } else if (node->kind != LAC_NODE_SCALAR || strcmp(node->text, "1") != 0) {
        lac_blame(reader, node, "must be %d, the version of the format that is read here",
                  FORMAT_VERSION);
    }
}

void lac_read_interface_spread(lac_reader *reader, const lac_node *node, lac_case *c)
{
    static const lac_spreadable varied[] = {{"pressure", true}};
    lac_read_spreads(reader, node, varied, 1, &c->interface_spread);
}

void lac_read_load(lac_reader *reader, const lac_node *node, lac_case *c)
{
    const lac_table table = lac_section_table("load");
    (void)c;
    bool lacks_normal = node != NULL && lac_node_child(node, "normal") == NULL &&
                        !lac_key_misspelt(node, &table, "normal");
    if (section_lacks(reader, "load") || lacks_normal) {
        lac_blame_key(reader, "load.normal",
                      "is missing: a normal load such as {pressure: \"3 MPa\"}");
    }
}

// The parameters of a law that may vary from cell to cell.
static size_t cellwise(const lac_slot *law, lac_spreadable *known, size_t most)
{
    size_t n = 0;
    for (size_t i = 0; i < law->about->param_count && n < most; i++) {
        const lac_param *param = &law->about->params[i];
        if ((param->flags & LAC_CELLWISE) != 0) {
            known[n++] = (lac_spreadable){param->key, lac_param_given(param, law->params)};
        }
    }
    return n;
}

void lac_read_friction(lac_reader *reader, const lac_node *node, lac_case *c)
{
    (void)c;
    if (node == NULL && section_lacks(reader, "friction") && lac_needs_run(reader)) {
        lac_blame_missing(reader, reader->root, "friction",
                          "is missing: a friction law such as {aging: {...}}");
    }
}

void lac_read_friction_spread(lac_reader *reader, const lac_node *node, lac_case *c)
{
    lac_spreadable known[32];
    if (c->friction.about != NULL) {
        size_t n = cellwise(&c->friction, known, sizeof known / sizeof known[0]);
        lac_read_spreads(reader, node, known, n, &c->friction_spread);
    }
}

// A date, or a time in seconds.
void lac_read_start(lac_reader *reader, const lac_node *node, lac_case *c)
{
    char text[32];
    double seconds;
    if (node->kind == LAC_NODE_SCALAR && lac_date_parse(node->text, &seconds)) {
        if (lac_date_format(floor(seconds), text, sizeof text)[0] == '\0') {
            lac_blame(reader, node, "must be in the years 0 to 9999");
        }
        c->dated = true;
        c->start_date = seconds;
        return;
    }
    if (node->kind != LAC_NODE_SCALAR ||
        lac_units_parse(reader->units, node->text, "s", &c->start_date, NULL) != LAC_OK) {
        lac_blame(reader, node,
                  "must be a date such as 1963-10-09T22:39:00Z, or a time such as \"1 day\"");
    }
}

void lac_read_time(lac_reader *reader, const lac_node *node, lac_case *c)
{
    (void)c;
    if (node == NULL && section_lacks(reader, "time") && lac_needs_run(reader)) {
        lac_blame_key(reader, "time.end", "is missing: must be a time such as \"1 day\"");
    }
}

// Reads a section that holds parameters; NULL where it is absent or none.
static const lac_node *read_record(lac_reader *reader, const lac_node *node, const lac_part *part,
                                   lac_case *c)
{
    char allowed[100] = "a mapping of keys and values";
    const lac_table table = lac_part_table(&part->about);
    if (part->such != NULL) {
        (void)snprintf(allowed, sizeof allowed, "a mapping such as %s", part->such);
    }
    if (node == NULL || node->bad || !lac_expect_map(reader, node, allowed)) {
        return NULL;
    }
    lac_read_table(reader, node, &table, c);
    return node;
}

static void read_part(lac_reader *reader, const lac_part *part, lac_case *c)
{
    const char *key = part->about.name;
    const lac_node *node = lac_node_at(reader->root, strcmp(key, "case") == 0 ? "" : key);
    void *at = (char *)c + part->at;
    if (part->kind == LAC_PART_RECORD) {
        node = read_record(reader, node, part, c);
    } else if (part->kind == LAC_PART_SLOT && node != NULL) {
        lac_read_slot(reader, node, part->model, part->such, at);
    } else if (part->kind == LAC_PART_SLOTS && node != NULL) {
        lac_read_slots(reader, node, part->model, at);
    } else if (part->kind == LAC_PART_CADENCE && node != NULL) {
        lac_read_cadence(reader, node, at);
    } else if (part->kind == LAC_PART_COLUMN && node != NULL) {
        lac_read_column(reader, node, part->such, at, (void *)((char *)c + part->unit_at));
    }
    bool always = part->kind == LAC_PART_RECORD || part->kind == LAC_PART_SLOT;
    if (part->read != NULL && (always || node != NULL)) {
        part->read(reader, node, c);
    }
}

// Reads the parts that come after one, each with those that come after it.
static void read_after(lac_reader *reader, const char *key, lac_case *c)
{
    const lac_part *part;
    for (size_t i = 0; (part = lac_part_at(i)) != NULL; i++) {
        if (strcmp(part->after != NULL ? part->after : "", key) == 0) {
            read_part(reader, part, c);
            read_after(reader, part->about.name, c);
        }
    }
}

void lac_read_sections(lac_reader *reader, lac_case *c) { read_after(reader, "", c); }
