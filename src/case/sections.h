/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/schema.h"

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

/// The keys of a section that lac_section_get has, by its name or by itself.
lac_table lac_section_table(const char *name);
lac_table lac_part_table(const lac_section *info);

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

/// What is wrong with the solver; chooses the formulation where the case leaves it open.
void lac_check_solver(lac_reader *reader, lac_case *c);

/// What is wrong with the mass of the block; it chooses the formulation.
/// @param pressure  mean normal stress [Pa]; NaN where the case is wrong about it
void lac_check_inertia(lac_reader *reader, lac_case *c, double pressure);

/// Reads a strength left after slip.
/// @return false where it is wrong, which is then reported
bool lac_read_beta(lac_reader *reader, const lac_node *node, double *beta);

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

/// Refuses a material that has no wave resistance, which a beta from the friction law needs.
void lac_check_waves(lac_reader *reader, const lac_material_def *m, const char *key);

/// Warns that a beta from the friction law is that of the nominal b and v0 where these vary.
void lac_warn_nominal_beta(lac_reader *reader, const lac_case *c, const char *key);

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
/// @param root  may come to hold another node
void lac_apply_override(lac_reader *reader, lac_node **root, const lac_override *override);

/// A case in memory and what changes it.
typedef struct lac_case_source {
    const char *name; ///< stands for the path
    const char *text; ///< [size]
    size_t size;
    const lac_override *overrides; ///< [count]
    size_t count;
    lac_case_purpose purpose;
} lac_case_source;

/// lac_case_read_text with a units database that is there already.
lac_status lac_case_build(const lac_units *units, const lac_case_source *from, lac_case **out,
                          lac_case_issues *report, lac_error *err);
