/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_CASE_SECTIONS_H
#define LACUNA_CASE_SECTIONS_H

#include "case/schema.h"

enum {
    LAC_SECTION_CASE = 0, ///< indices of lac_section_at
    LAC_SECTION_INTERFACE,
    LAC_SECTION_MATERIAL,
    LAC_SECTION_INERTIA,
    LAC_SECTION_LOAD,
    LAC_SECTION_HISTORY,
    LAC_SECTION_INITIAL,
    LAC_SECTION_TIME,
    LAC_SECTION_FAILURE,
    LAC_SECTION_STOP,
    LAC_SECTION_SOLVER,
    LAC_SECTION_OUTPUT,
    LAC_SECTION_RG,
    LAC_SECTION_FIT,
    LAC_SECTION_CADENCE,
    LAC_SECTION_COMPARE,
    LAC_SECTION_STEP,
};

/// The keys of a section. Offsets are in lac_case; of LAC_SECTION_CADENCE in lac_cadence, of
/// LAC_SECTION_COMPARE in lac_compare_def, of LAC_SECTION_STEP in lac_history_step.
lac_table lac_section_table(int section);

/// Names of LAC_FIELD_*, in the order of their bits; NULL at the end.
extern const char *const lac_field_names[];

/// The keys of `material`, of which shear_speed and density stand side by side.
extern const lac_param lac_material_rows[];
enum { LAC_MATERIAL_SHEAR_SPEED = 2 }; ///< its index

/// What `describe` says of options that are chosen by the value of a key; NULL past the end.
const lac_descriptor *lac_momentum_at(size_t index);
const lac_descriptor *lac_fidelity_at(size_t index);
const lac_descriptor *lac_method_at(size_t index);
const lac_descriptor *lac_formulation_at(size_t index);
const lac_descriptor *lac_rule_at(size_t index);

/// Reads the sections below the root into a case that holds the defaults.
void lac_read_sections(lac_reader *reader, lac_case *c);

/// What `initial.state` may hold: a time, or a ratio to the steady state; of lac_initial_def.
extern const lac_param lac_state_row, lac_ratio_row;

/// Reads `initial`.
void lac_read_initial(lac_reader *reader, const lac_node *node, lac_case *c);

/// Reads `output`.
void lac_read_output(lac_reader *reader, const lac_node *node, lac_case *c);

/// Reads `compare`.
void lac_read_compare(lac_reader *reader, const lac_node *node, lac_case *c);

/// The keys of `solver`.
enum { LAC_SOLVER_ROWS = 12 };
extern const lac_param lac_solver_rows[LAC_SOLVER_ROWS];

/// What is wrong with the solver; chooses the formulation where the case leaves it open.
void lac_check_solver(lac_reader *reader, lac_case *c);

/// The keys of `inertia`.
enum { LAC_INERTIA_ROWS = 3 };
extern const lac_param lac_inertia_rows[LAC_INERTIA_ROWS];

/// What is wrong with the mass of the block; it chooses the formulation.
/// @param pressure  mean normal stress [Pa]; NaN where the case is wrong about it
void lac_check_inertia(lac_reader *reader, lac_case *c, double pressure);

/// A key of those whose friction is Coulomb's: lac_find_coulomb.
#define LAC_COULOMB_ROW(where)                                                   \
    LAC_REAL("friction", "1", where, NAN, 0, 1000, LAC_OPTIONAL | LAC_ABOVE_MIN, \
             "Coulomb's coefficient f; f0 of the friction law if absent")

/// The keys of `rg`.
enum { LAC_RG_ROWS = 9 };
extern const lac_param lac_rg_rows[LAC_RG_ROWS];
extern const char *const lac_rg_own[];

/// Reads a strength left after slip.
/// @return false where it is wrong, which is then reported
bool lac_read_beta(lac_reader *reader, const lac_node *node, double *beta);

/// Reads `rg`; NULL: the defaults.
void lac_read_rg(lac_reader *reader, const lac_node *node, lac_case *c);

/// What is wrong with the cascade, and the friction it takes from the law.
void lac_check_rg(lac_reader *reader, lac_case *c);

/// The keys of `fit`.
enum { LAC_FIT_ROWS = 16 };
extern const lac_param lac_fit_rows[LAC_FIT_ROWS];
extern const char *const lac_fit_own[];

/// Reads `fit`; NULL: none. The rest of the case has been read.
void lac_read_fit(lac_reader *reader, const lac_node *node, lac_case *c);

/// What is wrong with it.
void lac_check_fit(lac_reader *reader, lac_case *c);

/// Frees what the section owns.
void lac_fit_clear(lac_fit_def *fit);

/// The parameters of `fit` as YAML, indented; the caller frees. NULL where memory is short.
char *lac_fit_text(const lac_fit_def *fit);

/// Splits "column:unit" at its last colon.
void lac_read_column(lac_reader *reader, const lac_node *node, const char *si, char **column,
                     char **unit);

/// Reads `analysis`; NULL: none.
void lac_read_analysis(lac_reader *reader, const lac_node *node, lac_case *c);

/// What is wrong with the indicators; fills in what they take from elsewhere in the case.
void lac_check_analysis(lac_reader *reader, lac_case *c);

/// Reads `load.history`.
void lac_read_history(lac_reader *reader, const lac_node *node, lac_case *c);

/// What is wrong with a history as a whole; fills in its friction coefficient.
/// @param pressure  that it starts from [Pa]; NaN where the case is wrong about it
void lac_check_history(lac_reader *reader, lac_case *c, double pressure);

/// Whether the case must hold what only a run needs: friction, a shear load, an end.
bool lac_needs_run(const lac_reader *reader);

/// Whether the case has a dotted key.
bool lac_present(const lac_reader *reader, const char *key);

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
                          lac_case_report *report, lac_error *err);

#endif
