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

/// Whether a row's field is its reader's own.
static inline bool lac_param_owned(const lac_param *param)
{
    return (param->flags & (LAC_OWN_FLAG | LAC_COLUMN_FLAG)) != 0;
}

/// Reads the value of one parameter into its field.
/// @return false where it is wrong, which is then reported
bool lac_read_param(lac_reader *reader, const lac_node *node, const lac_param *param, void *params);

/// Reads a number of the dimension of `unit`; the range is the caller's.
bool lac_read_number(lac_reader *reader, const lac_node *node, const char *unit, double *value);

/// Frees the texts that rows hold but the caller's own.
void lac_table_clear(const lac_model_info *table, void *params);

/// Sets every field of rows but the caller's own to its default.
void lac_table_reset(const lac_model_info *table, void *params);

/// Reads a mapping by rows: unknown keys, wrong values and missing ones are reported.
/// @param own  an optional key that the caller reads itself beside those of LAC_OWN; NULL: none
void lac_read_table(lac_reader *reader, const lac_node *map, const lac_model_info *table,
                    const char *own, void *params);

/// Whether a node is a mapping; reported where not.
bool lac_expect_map(lac_reader *reader, const lac_node *node, const char *allowed);

/// Whether an unknown key of a mapping, reported as such, is near a key that it lacks: that the
/// key is missing need not be said too.
bool lac_key_misspelt(const lac_node *map, const lac_model_info *table, const char *key);

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

struct lac_writer;

typedef enum lac_part_kind {
    LAC_PART_RECORD = 0, ///< rows, whose offsets are in lac_case
    LAC_PART_SLOT,       ///< {MODEL: {...}}
    LAC_PART_SLOTS,      ///< a list of these
    LAC_PART_SPREADS,    ///< models of parameters that vary; `read` reads them
    LAC_PART_CADENCE,    ///< a lac_cadence
    LAC_PART_OWN,        ///< what `read` and `put` make of it
    LAC_PART_ITEMS,      ///< the same; the rows are those of an item, with offsets in its struct
} lac_part_kind;

/// A part of a case that is more than a value: how it is read, kept and written back as text.
/// What walks the table of parts: reading, defaults, text, freeing, lac_case_find,
/// lac_case_validate, lac_case_rebase, `describe` and completion.
typedef struct lac_part {
    lac_section info; ///< its dotted key, "case" the whole; rows and summary where there are any
    lac_part_kind kind;
    int model;         ///< LAC_KIND_* of models
    size_t at;         ///< offset in lac_case: of a model, list or cadence
    const char *after; ///< read after this one: so the errors of a line are ordered; NULL: in place
    const char *such; ///< of a record: an example, for messages; of a model: a key beside the model
    const char *const *varied; ///< of spreads: what may vary; NULL: what the friction law says
    const char *missing;    ///< what is said where its section is there but it isn't; NULL: nothing
    const char *missing_at; ///< of which key; NULL: its own
    bool of_runs;           ///< but only where lac_needs_run
    bool fitted;            ///< lac_case_find knows its rows
    /// Called once the rest is read.
    void (*read)(lac_reader *reader, const lac_node *node, lac_case *c);
    bool (*given)(const lac_case *c); ///< whether it and what is below it are written; NULL: yes
    /// Writes what no row or kind tells; of a record before its rows.
    void (*put)(struct lac_writer *w, const lac_case *c);
} lac_part;

/// The index-th part in the order of a resolved case, NULL past the end.
const lac_part *lac_part_get(size_t index);

/// A section that lac_section_get has.
const lac_section *lac_section_find(const char *name);

/// The index-th key of a case that holds a section, where the table is that of the whole case; NULL
/// past the end.
const char *lac_section_key(const lac_section *table, size_t index);

typedef void lac_part_read(lac_reader *reader, const lac_node *node, lac_case *c);
typedef void lac_part_put(struct lac_writer *w, const lac_case *c);

lac_part_read lac_read_version, lac_read_steps, lac_read_state, lac_read_start, lac_read_fields,
    lac_read_fields_every, lac_read_betas, lac_read_analysis, lac_read_fitted, lac_read_compare;
lac_part_put lac_put_steps, lac_put_state, lac_put_start, lac_put_fields, lac_put_betas,
    lac_put_analysis, lac_put_fitted, lac_put_compare;

/// Names of LAC_FIELD_*, in the order of their bits; NULL at the end.
extern const char *const lac_field_names[];

/// The keys of `material`, of which shear_speed and density stand side by side, and of `inertia`.
enum { LAC_MATERIAL_SHEAR_SPEED = 2, LAC_MATERIAL_ROWS = 4, LAC_INERTIA_ROWS = 3 };
extern const lac_param lac_material_rows[LAC_MATERIAL_ROWS], lac_inertia_rows[LAC_INERTIA_ROWS];

/// What `describe` says of options that are chosen by the value of a key; NULL past the end.
const lac_model_info *lac_momentum_get(size_t index);
const lac_model_info *lac_fidelity_get(size_t index);
const lac_model_info *lac_method_get(size_t index);
const lac_model_info *lac_formulation_get(size_t index);
const lac_model_info *lac_rule_get(size_t index);

/// Reads the sections below the root into a case that holds the defaults.
void lac_read_sections(lac_reader *reader, lac_case *c);

/// What `initial.state` may hold: a time, or a ratio to the steady state; of lac_initial_def.
extern const lac_param lac_state_row, lac_ratio_row;

/// What is wrong with the cascade, and the friction it takes from the law.
void lac_check_rg(lac_reader *reader, lac_case *c);

/// What is wrong with it.
void lac_check_fit(lac_reader *reader, lac_case *c);

/// The rest of a dotted key behind that of a part; NULL where it is not below it.
const char *lac_key_behind(const char *key, const char *part);

/// What is wrong with the indicators; fills in what they take from elsewhere in the case.
void lac_check_analysis(lac_reader *reader, lac_case *c);

/// What is wrong with a history as a whole; fills in its friction coefficient.
/// @param pressure  that it starts from [Pa]; NaN where the case is wrong about it
void lac_check_history(lac_reader *reader, lac_case *c, double pressure);

/// Whether the case must hold what only a run needs: friction, a shear load, an end.
bool lac_needs_run(const lac_reader *reader);

/// Whether the case has a dotted key; where the reader is `reader`.
bool lac_present(const lac_reader *reader, const char *key);
#define HAS(key) lac_present(reader, (key))

/// Coulomb's coefficient where `key`.friction does not give it: f0 of the friction law.
/// @param friction  set; NaN where there is none, which is then reported
void lac_find_coulomb(lac_reader *reader, const lac_case *c, const char *key, double *friction);

/// Whether nothing is wrong below a key: what depends on it can be checked.
bool lac_clean(const lac_reader *reader, const char *key);

/// Cells of 4096 x 4096: what was tried, and what 32-bit counts of doubled grids hold with ease.
#define LAC_MOST_CELLS 16777216

/// What is wrong with the interface as a whole; fills in what is absent.
void lac_check_interface(lac_reader *reader, lac_interface_def *def);

/// What no section sees alone.
void lac_check_case(lac_reader *reader, lac_case *c);

/// Applies one --set to the tree.
void lac_apply_override(lac_reader *reader, lac_node *root, const lac_override *override);

/// lac_case_read_text with a units database that is there already.
lac_status lac_case_build(const lac_units *units, const char *name, const char *text, size_t size,
                          const lac_case_request *how, lac_case **out, lac_case_issues *report,
                          lac_error *err);
