// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a case by the table of its parts, and what single parts need besides.
#include "base/date.h"
#include "case/sections.h"

enum { FORMAT_VERSION = 1, MOST_FIELDS = 8 * sizeof(unsigned) }; // a bit each

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
    if (!lac_refuse(reader, node == NULL, "lacuna",
                    "is missing: a case starts with its format's version, lacuna: %d",
                    FORMAT_VERSION) &&
        (node->kind != LAC_NODE_SCALAR || strcmp(node->text, "1") != 0)) {
        lac_add_error(reader, node, "must be %d, the version of the format that is read here",
                      FORMAT_VERSION);
    }
}

// A date, or a time in seconds.
void lac_read_start(lac_reader *reader, const lac_node *node, lac_case *c)
{
    char text[32];
    double seconds;
    if (node->kind == LAC_NODE_SCALAR && lac_date_parse(node->text, &seconds)) {
        if (lac_date_format(floor(seconds), text, sizeof text)[0] == '\0') {
            lac_add_error(reader, node, "must be in the years 0 to 9999");
        }
        c->dated = true;
        c->start_date = seconds;
        return;
    }
    if (node->kind != LAC_NODE_SCALAR ||
        lac_units_parse(reader->units, node->text, "s", &c->start_date, NULL) != LAC_OK) {
        lac_add_error(reader, node,
                      "must be a date such as 1963-10-09T22:39:00Z, or a time such as \"1 day\"");
    }
}

const lac_param lac_ratio_row =
    LAC_REAL("ratio_to_steady", "1", offsetof(lac_initial_def, state_value), NAN, 0, 1e6,
             LAC_ABOVE_MIN, "theta over theta_ss at the load that follows");

const lac_param lac_state_row =
    LAC_REAL("state", "s", offsetof(lac_initial_def, state_value), NAN, 1e-12, 1e20, 0, "theta");

void lac_read_state(lac_reader *reader, const lac_node *node, lac_case *c)
{
    lac_initial_def *initial = &c->initial;
    const lac_section ratio = {.params = &lac_ratio_row, .param_count = 1};
    double seconds;
    if (node->kind == LAC_NODE_MAP) {
        initial->state = LAC_STATE_RATIO;
        lac_read_table(reader, node, &ratio, NULL, initial);
    } else if (node->kind == LAC_NODE_SCALAR && strcmp(node->text, "steady") == 0) {
        initial->state = LAC_STATE_STEADY;
    } else if (node->kind == LAC_NODE_SCALAR &&
               lac_units_parse(reader->units, node->text, "s", &seconds, NULL) == LAC_OK) {
        initial->state = LAC_STATE_TIME;
        (void)lac_read_param(reader, node, &lac_state_row, initial);
    } else {
        lac_add_error(reader, node,
                      "must be steady, a time such as \"2 year\", or {ratio_to_steady: 0.9}");
    }
}

// A time, or a mapping of one or more of time, steps and per_decade.
static void read_cadence(lac_reader *reader, const lac_node *node, lac_cadence *cadence)
{
    const lac_section *table = lac_section_find("output.every");
    size_t errors = reader->report->errors;
    lac_table_reset(table, cadence);
    if (node->kind == LAC_NODE_SCALAR) {
        (void)lac_read_param(reader, node, &table->params[0], cadence);
        return;
    }
    if (!lac_expect_map(reader, node, "a time such as \"1 day\", {steps: N} or {per_decade: N}")) {
        return;
    }
    lac_read_table(reader, node, table, NULL, cadence);
    bool never = isnan(cadence->time) && cadence->steps == 0 && isnan(cadence->per_decade);
    if (never && reader->report->errors == errors) {
        lac_add_error(reader, node,
                      "must be a time such as \"1 day\", {steps: N} or {per_decade: N}");
    }
}

void lac_read_safety(lac_reader *reader, const lac_node *node, lac_case *c)
{
    (void)reader;
    (void)node;
    c->safety.asked = true;
}

void lac_read_fields(lac_reader *reader, const lac_node *node, lac_case *c)
{
    char known[200] = "";
    const char *name[MOST_FIELDS];
    size_t names = 0;
    while ((name[names] = lac_run_field(names)) != NULL) {
        names++;
    }
    lac_append_names(known, sizeof known, name, names);
    if (node->kind != LAC_NODE_LIST) {
        lac_add_error(reader, node, "must be a list of: %s", known);
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        const lac_node *item = node->child[i];
        unsigned bit = 0;
        for (size_t k = 0; item->kind == LAC_NODE_SCALAR && k < names; k++) {
            bit |= strcmp(name[k], item->text) == 0 ? 1u << k : 0u;
        }
        if (bit == 0) {
            lac_add_error(reader, item, "must be one of: %s", known);
        }
        c->fields |= bit;
    }
    c->run.snapshots = c->fields != 0;
}

void lac_read_fields_every(lac_reader *reader, const lac_node *node, lac_case *c)
{
    (void)c;
    if (!HAS("output.fields")) {
        lac_add_error(reader, node, "needs output.fields, which says what to keep");
    }
}

void lac_read_compare(lac_reader *reader, const lac_node *node, lac_case *c)
{
    if (node->kind != LAC_NODE_LIST) {
        lac_add_error(reader, node, "must be a list such as [{file: a.csv, time: date, ...}]");
        return;
    }
    c->compare = lac_reader_array(reader, node->count, sizeof *c->compare);
    c->compare_count = c->compare != NULL ? node->count : 0;
    for (size_t i = 0; i < c->compare_count; i++) {
        const lac_node *of = node->child[i];
        if (!lac_expect_map(reader, of,
                            "a mapping with file, time, displacement and/or velocity")) {
            continue;
        }
        lac_read_table(reader, of, lac_section_find("compare"), NULL, &c->compare[i]);
        if (lac_node_child(of, "displacement") == NULL && lac_node_child(of, "velocity") == NULL) {
            lac_add_error(reader, of, "needs displacement or velocity, such as \"disp:mm\"");
        }
    }
}

// Reads a section that holds parameters; NULL where it is none.
static const lac_node *read_record(lac_reader *reader, const lac_node *node, const lac_part *part,
                                   lac_case *c)
{
    char allowed[100] = "a mapping of keys and values";
    if (part->such != NULL) {
        (void)snprintf(allowed, sizeof allowed, "a mapping such as %s", part->such);
    }
    if (node->bad || !lac_expect_map(reader, node, allowed)) {
        return NULL;
    }
    lac_read_table(reader, node, &part->info, NULL, c);
    return node;
}

// Whether a part that must be there isn't, nor is misspelt, which was reported.
static bool lacks(const lac_reader *reader, const lac_part *part)
{
    char above[LAC_KEY_LENGTH] = "";
    const char *name = part->info.name, *dot = strrchr(name, '.');
    (void)snprintf(above, sizeof above, "%.*s", dot != NULL ? (int)(dot - name) : 0, name);
    const lac_section *table = lac_section_find(dot != NULL ? above : "case");
    const lac_node *map = lac_node_at(reader->root, above);
    return map != NULL && map->kind == LAC_NODE_MAP &&
           !lac_key_misspelt(map, table, dot != NULL ? dot + 1 : name) &&
           (part->unless == NULL || !HAS(part->unless)) &&
           (!part->of_runs || lac_needs_run(reader));
}

static void read_part(lac_reader *reader, const lac_part *part, lac_case *c)
{
    const char *key = part->info.name;
    const lac_node *node = lac_node_at(reader->root, strcmp(key, "case") == 0 ? "" : key);
    void *at = (char *)c + part->at;
    if (node == NULL) {
        (void)lac_refuse(reader, part->missing != NULL && lacks(reader, part),
                         part->missing_at != NULL ? part->missing_at : key, "is missing: %s",
                         part->missing);
        return;
    }
    if (part->kind == LAC_PART_RECORD) {
        node = read_record(reader, node, part, c);
    } else if (part->kind == LAC_PART_SLOT) {
        lac_read_slot(reader, node, part->model, part->such, at);
    } else if (part->kind == LAC_PART_SLOTS) {
        lac_read_slots(reader, node, part->model, at);
    } else if (part->kind == LAC_PART_SPREADS && part->varied != NULL) {
        lac_read_spreads(reader, node, NULL, part->varied, at);
    } else if (part->kind == LAC_PART_SPREADS && c->friction.info != NULL) {
        lac_read_spreads(reader, node, &c->friction, NULL, at);
    } else if (part->kind == LAC_PART_CADENCE) {
        read_cadence(reader, node, at);
    }
    if (part->read != NULL && node != NULL) {
        part->read(reader, node, c);
    }
}

void lac_read_sections(lac_reader *reader, const char *key, lac_case *c)
{
    const lac_part *part;
    for (size_t i = 0; (part = lac_part_get(i)) != NULL; i++) {
        if (strcmp(part->after != NULL ? part->after : "", key) == 0) {
            read_part(reader, part, c);
            lac_read_sections(reader, part->info.name, c);
        }
    }
}
