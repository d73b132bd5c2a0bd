// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the start of a run, what is kept of it and what is laid beside it.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "case/sections.h"

const lac_param lac_ratio_row =
    LAC_REAL("ratio_to_steady", "1", offsetof(lac_initial_def, state_value), NAN, 0, 1e6,
             LAC_ABOVE_MIN, "theta over theta_ss at the load that follows");

const lac_param lac_state_row =
    LAC_REAL("state", "s", offsetof(lac_initial_def, state_value), NAN, 1e-12, 1e20, 0, "theta");

void lac_read_state(lac_reader *reader, const lac_node *node, lac_case *c)
{
    lac_initial_def *initial = &c->initial;
    const lac_table table = {.params = &lac_ratio_row, .count = 1};
    double seconds;
    if (node->kind == LAC_NODE_MAP) {
        initial->state = LAC_STATE_RATIO;
        lac_read_table(reader, node, &table, initial);
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

void lac_read_cadence(lac_reader *reader, const lac_node *node, lac_cadence *cadence)
{
    lac_table table = lac_section_table("output.every");
    size_t errors = reader->report->errors;
    lac_table_reset(&table, cadence);
    if (node->kind == LAC_NODE_SCALAR) {
        (void)lac_read_param(reader, node, &table.params[0], cadence);
        return;
    }
    if (!lac_expect_map(reader, node, "a time such as \"1 day\", {steps: N} or {per_decade: N}")) {
        return;
    }
    lac_read_table(reader, node, &table, cadence);
    bool never = isnan(cadence->time) && cadence->steps == 0 && isnan(cadence->per_decade);
    if (never && reader->report->errors == errors) {
        lac_add_error(reader, node,
                      "must be a time such as \"1 day\", {steps: N} or {per_decade: N}");
    }
}

void lac_read_fields(lac_reader *reader, const lac_node *node, lac_case *c)
{
    if (node->kind != LAC_NODE_LIST) {
        lac_add_error(reader, node, "must be a list of: slip, slip_rate, state, traction");
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        const lac_node *item = node->child[i];
        unsigned bit = 0;
        for (unsigned k = 0; item->kind == LAC_NODE_SCALAR && lac_field_names[k] != NULL; k++) {
            bit |= strcmp(lac_field_names[k], item->text) == 0 ? 1u << k : 0u;
        }
        if (bit == 0) {
            lac_add_error(reader, item, "must be one of: slip, slip_rate, state, traction");
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

static void read_series(lac_reader *reader, const lac_node *node, lac_compare_def *def)
{
    lac_table table = lac_section_table("compare");
    if (!lac_expect_map(reader, node, "a mapping with file, time, displacement and/or velocity")) {
        return;
    }
    lac_read_table(reader, node, &table, def);
    if (lac_node_child(node, "displacement") == NULL && lac_node_child(node, "velocity") == NULL) {
        lac_add_error(reader, node, "needs displacement or velocity, such as \"disp:mm\"");
    }
}

void lac_read_compare(lac_reader *reader, const lac_node *node, lac_case *c)
{
    if (node->kind != LAC_NODE_LIST) {
        lac_add_error(reader, node, "must be a list such as [{file: a.csv, time: date, ...}]");
        return;
    }
    c->compare = calloc(node->count > 0 ? node->count : 1, sizeof *c->compare);
    if (c->compare == NULL) {
        reader->no_memory = true;
        return;
    }
    c->compare_count = node->count;
    for (size_t i = 0; i < node->count; i++) {
        read_series(reader, node->child[i], &c->compare[i]);
    }
}
