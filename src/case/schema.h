/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"
#include "case/reader.h"

enum { LAC_OWN_FLAG = 1 << 8, LAC_COLUMN_FLAG = 1 << 9 };

/// A row that is only described: the reader has a function for its key.
#define LAC_OWN(name, text) LAC_TEXT(name, 0, LAC_OPTIONAL | LAC_OWN_FLAG, text)

/// "column:unit", a char * each, one behind the other; read and written after the other rows.
#define LAC_COLUMN(name, where, si, text)                                               \
    {                                                                                   \
        .key = (name), .unit = (si), .fallback = NAN, .offset = (where), .doc = (text), \
        .flags = LAC_OPTIONAL | LAC_COLUMN_FLAG, .type = LAC_TEXT                       \
    }

/// The keys of a mapping.
typedef struct lac_table {
    const lac_param *params; ///< [count]
    size_t count;
    const char *own; ///< a key that the caller reads itself beside those of LAC_OWN; NULL: none
    const char *(*more)(size_t index); ///< others that it reads; NULL past the end. NULL: none
} lac_table;

/// Reads the value of one parameter into its field.
/// @return false where it is wrong, which is then reported
bool lac_read_param(lac_reader *reader, const lac_node *node, const lac_param *param, void *params);

/// Reads a number of the dimension of `unit`; the range is the caller's.
bool lac_read_number(lac_reader *reader, const lac_node *node, const char *unit, double *value);

/// Frees the texts of a table but the caller's own.
void lac_table_clear(const lac_table *table, void *params);

/// Sets every field of a table but the caller's own to its default.
void lac_table_reset(const lac_table *table, void *params);

/// Reads a mapping by its table: unknown keys, wrong values and missing ones are reported.
void lac_read_table(lac_reader *reader, const lac_node *map, const lac_table *table, void *params);

/// Whether a node is a mapping; reported where not.
bool lac_expect_map(lac_reader *reader, const lac_node *node, const char *allowed);

/// Whether a key is among the caller's own.
bool lac_table_owns(const lac_table *table, const char *key);

/// Whether an unknown key of a mapping, reported as such, is near a key that it lacks: that the
/// key is missing need not be said too.
bool lac_key_misspelt(const lac_node *map, const lac_table *table, const char *key);

/// Whether a parameter must be given.
bool lac_param_required(const lac_param *param);

/// Whether a value is in a row's range; reported where not.
bool lac_in_range(lac_reader *reader, const lac_node *node, const lac_param *param, double value);

/// A path below a folder, whose first `length` characters count; the caller frees.
/// @return NULL where memory is short
char *lac_path_below(const char *folder, size_t length, const char *path);

/// Length of the folder that a case's relative paths start from, with its last slash.
size_t lac_folder_length(const char *name);

enum {
    LAC_KIND_SURFACE = 0, ///< indices of lac_kind_get
    LAC_KIND_DOMAIN,
    LAC_KIND_NORMAL,
    LAC_KIND_SHEAR,
    LAC_KIND_PORE,
    LAC_KIND_FRICTION,
    LAC_KIND_TRANSFER,
    LAC_KIND_SPREAD,
    LAC_KIND_ANALYSIS,
    LAC_KIND_STRENGTH, ///< from here on options, which no model holds
    LAC_KIND_MOMENTUM,
    LAC_KIND_FIDELITY,
    LAC_KIND_METHOD,
    LAC_KIND_FORMULATION,
    LAC_KIND_RULE,
    LAC_KIND_PRECURSOR, ///< from here on what commands have
    LAC_KIND_FORECAST,
    LAC_KINDS,
};

/// The model of a kind that a node's key names.
/// @param what  "model", "indicator": what there is none of by this name
/// @return NULL where there is none, which is then reported
const lac_model_info *lac_find_model(lac_reader *reader, const lac_node *node, int kind,
                                     const char *what);

/// Reads `{MODEL: {parameters}}`: exactly one model.
/// @param own   a key beside the model that the caller reads itself; NULL
/// @param model  empty where the node is wrong
void lac_read_slot(lac_reader *reader, const lac_node *node, int kind, const char *own,
                   lac_model *model);

/// Reads `[{MODEL: ...}, ...]`.
void lac_read_slots(lac_reader *reader, const lac_node *node, int kind, lac_model_list *list);

/// Reads `{PARAMETER: {MODEL: ...}, ...}`, or a list of models for a parameter.
/// @param law    whose cell-wise parameters may vary; NULL: `known` may
/// @param known  NULL at its end
void lac_read_spreads(lac_reader *reader, const lac_node *node, const lac_model *law,
                      const char *const *known, lac_heterogeneity_list *list);

void lac_heterogeneity_clear(lac_heterogeneity_list *list);

/// Reads a time, or a mapping of one or more of time, steps and per_decade.
void lac_read_cadence(lac_reader *reader, const lac_node *node, lac_cadence *cadence);
