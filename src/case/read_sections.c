// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/date.h"
#include "case/sections.h"

enum { FORMAT_VERSION = 1 };

// Reads a section that holds parameters; absent ones are fine here.
static const lac_node *read_section(lac_reader *reader, const lac_node *parent, const char *key,
                                    int section, void *into)
{
    const lac_node *node = lac_node_child(parent, key);
    lac_table table = lac_section_table(section);
    if (node == NULL || node->bad ||
        !lac_expect_map(reader, node, "a mapping of keys and values")) {
        return NULL;
    }
    lac_read_table(reader, node, &table, into);
    return node;
}

// Whether a section that must be there isn't, nor is misspelt, which was reported.
static bool section_lacks(const lac_reader *reader, const char *key)
{
    lac_table table = lac_section_table(LAC_SECTION_CASE);
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

static void read_version(lac_reader *reader)
{
    const lac_node *node = lac_node_child(reader->root, "lacuna");
    if (node == NULL) {
        lac_blame_missing(reader, reader->root, "lacuna",
                          "is missing: a case starts with its format's version, lacuna: %d",
                          FORMAT_VERSION);
    } else if (node->kind != LAC_NODE_SCALAR || strcmp(node->text, "1") != 0) {
        lac_blame(reader, node, "must be %d, the version of the format that is read here",
                  FORMAT_VERSION);
    }
}

static void read_interface(lac_reader *reader, lac_case *c)
{
    const lac_node *node =
        read_section(reader, reader->root, "interface", LAC_SECTION_INTERFACE, c);
    if (node == NULL) {
        return;
    }
    static const lac_spreadable varied[] = {{"pressure", true}};
    const lac_node *surface = lac_node_child(node, "surface");
    const lac_node *domain = lac_node_child(node, "domain");
    if (surface != NULL) {
        lac_read_slot(reader, surface, LAC_KIND_SURFACE, NULL, &c->surface);
    }
    if (domain != NULL) {
        lac_read_slot(reader, domain, LAC_KIND_DOMAIN, NULL, &c->domain);
    }
    if (lac_node_child(node, "spread") != NULL) {
        lac_read_spreads(reader, lac_node_child(node, "spread"), varied, 1, &c->interface_spread);
    }
}

static void read_load(lac_reader *reader, lac_case *c)
{
    const lac_node *node = read_section(reader, reader->root, "load", LAC_SECTION_LOAD, c);
    const lac_node *normal = lac_node_child(node, "normal");
    const lac_node *shear = lac_node_child(node, "shear");
    const lac_node *pore = lac_node_child(node, "pore_pressure");
    lac_table table = lac_section_table(LAC_SECTION_LOAD);
    bool lacks_normal = node != NULL && normal == NULL && !lac_key_misspelt(node, &table, "normal");
    if (section_lacks(reader, "load") || lacks_normal) {
        lac_blame_key(reader, "load.normal",
                      "is missing: a normal load such as {pressure: \"3 MPa\"}");
    }
    if (normal != NULL) {
        lac_read_slot(reader, normal, LAC_KIND_NORMAL, NULL, &c->normal);
    }
    if (shear != NULL) {
        lac_read_slots(reader, shear, LAC_KIND_SHEAR, &c->shear);
    }
    if (pore != NULL) {
        lac_read_slots(reader, pore, LAC_KIND_PORE, &c->pore);
    }
    if (lac_node_child(node, "history") != NULL) {
        lac_read_history(reader, lac_node_child(node, "history"), c);
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

static void read_friction(lac_reader *reader, lac_case *c)
{
    lac_spreadable known[32];
    const lac_node *node = lac_node_child(reader->root, "friction");
    if (section_lacks(reader, "friction") && lac_needs_run(reader)) {
        lac_blame_missing(reader, reader->root, "friction",
                          "is missing: a friction law such as {aging: {...}}");
    }
    if (node == NULL) {
        return;
    }
    lac_read_slot(reader, node, LAC_KIND_FRICTION, "spread", &c->friction);
    const lac_node *spread = lac_node_child(node, "spread");
    if (spread != NULL && c->friction.about != NULL) {
        size_t n = cellwise(&c->friction, known, sizeof known / sizeof known[0]);
        lac_read_spreads(reader, spread, known, n, &c->friction_spread);
    }
}

// A date, or a time in seconds.
static void read_start(lac_reader *reader, const lac_node *node, lac_case *c)
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

static void read_time(lac_reader *reader, lac_case *c)
{
    const lac_node *node = read_section(reader, reader->root, "time", LAC_SECTION_TIME, c);
    if (section_lacks(reader, "time") && lac_needs_run(reader)) {
        lac_blame_key(reader, "time.end", "is missing: must be a time such as \"1 day\"");
    }
    if (node == NULL) {
        return;
    }
    if (lac_node_child(node, "start") != NULL) {
        read_start(reader, lac_node_child(node, "start"), c);
    }
    (void)read_section(reader, node, "failure", LAC_SECTION_FAILURE, c);
    (void)read_section(reader, node, "stop_when", LAC_SECTION_STOP, c);
}

void lac_read_sections(lac_reader *reader, lac_case *c)
{
    lac_table table = lac_section_table(LAC_SECTION_CASE);
    lac_read_table(reader, reader->root, &table, c);
    read_version(reader);
    read_interface(reader, c);
    (void)read_section(reader, reader->root, "material", LAC_SECTION_MATERIAL, c);
    (void)read_section(reader, reader->root, "inertia", LAC_SECTION_INERTIA, c);
    read_load(reader, c);
    read_friction(reader, c);
    read_time(reader, c);
    (void)read_section(reader, reader->root, "solver", LAC_SECTION_SOLVER, c);
    const lac_node *transfer = lac_node_child(reader->root, "transfer");
    if (transfer != NULL) {
        lac_read_slot(reader, transfer, LAC_KIND_TRANSFER, NULL, &c->transfer);
    }
    const lac_node *initial = read_section(reader, reader->root, "initial", LAC_SECTION_INITIAL, c);
    if (initial != NULL) {
        lac_read_initial(reader, initial, c);
    }
    const lac_node *output = read_section(reader, reader->root, "output", LAC_SECTION_OUTPUT, c);
    if (output != NULL) {
        lac_read_output(reader, output, c);
    }
    lac_read_rg(reader, lac_node_child(reader->root, "rg"), c);
    lac_read_analysis(reader, lac_node_child(reader->root, "analysis"), c);
    lac_read_fit(reader, lac_node_child(reader->root, "fit"), c);
    const lac_node *compare = lac_node_child(reader->root, "compare");
    if (compare != NULL) {
        lac_read_compare(reader, compare, c);
    }
}
