/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/nearest.h"
#include "base/units.h"
#include "case/case.h"
#include "forecast/verdict.h"

enum {
    LAC_TREE_DEPTH = 32,    ///< no case is deeper
    LAC_TREE_NODES = 20000, ///< nor larger
    LAC_TREE_KEYS = 256,    ///< nor has a mapping more keys
};

typedef enum lac_node_kind { LAC_NODE_SCALAR = 0, LAC_NODE_LIST, LAC_NODE_MAP } lac_node_kind;

/// A value of a case file and where it stands.
typedef struct lac_node {
    lac_node_kind kind;
    struct lac_node *parent; ///< NULL: the root
    char *key;               ///< in a mapping; NULL elsewhere
    char *text;              ///< of a scalar
    bool plain;              ///< a scalar without quotes
    bool ignored;            ///< a second value of the same key: reported, not read
    bool bad;                ///< reported already: whoever reads it says no more
    size_t line;             ///< 1-based, of the key where there is one; 0: from --set
    size_t count, room;
    struct lac_node **child; ///< [count]
} lac_node;

enum {
    LAC_KEY_LENGTH = 200,  ///< of a dotted key in a message
    LAC_MOST_ISSUES = 100, ///< a case with more is told so
};

/// What every part of the reader needs.
typedef struct lac_reader {
    const char *name; ///< of the file, in messages
    lac_case_purpose purpose;
    const lac_units *units;
    lac_case_issues *report;
    const lac_node *root;
    bool no_memory; ///< something could not be kept: the reading fails at its end
} lac_reader;

/// Reads YAML into nodes. What is wrong goes into the reader's report.
/// @param place  NULL: the text is a whole file; else a --set value, to be blamed on this key
/// @return the root; NULL where there is none or the text cannot be read on (then reported)
lac_node *lac_tree_parse(lac_reader *reader, const char *text, size_t size, const char *place);

/// A new node with copies of `key` and `text`, at the end of its parent where there is one; NULL
/// where memory is short.
lac_node *lac_node_create(lac_node *parent, lac_node_kind kind, const char *key, const char *text,
                          size_t text_size);
void lac_node_free(lac_node *node);

/// The value of a key of a mapping; NULL where it isn't one or has no such key.
lac_node *lac_node_child(const lac_node *node, const char *key);

/// The node at a dotted key below `root`; NULL where there is none.
lac_node *lac_node_at(const lac_node *root, const char *path);

/// Whether a scalar is YAML's null: nothing, ~ or null.
bool lac_node_is_null(const lac_node *node);

/// The dotted key of a node, list items by index; "" for the root.
const char *lac_node_path(const lac_node *node, char *text, size_t size);

/// Reports an error at a node, with its dotted key and, of a scalar, its value.
void lac_add_error(lac_reader *reader, const lac_node *node, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Reports an error at a dotted key where `wrong`, which it returns: its line, or the nearest
/// above.
bool lac_refuse(lac_reader *reader, bool wrong, const char *key, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Reports a warning at a dotted key.
void lac_warn(lac_reader *reader, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Reports an error of the text as such.
/// @param place  the key of a --set; NULL: the file
void lac_add_error_text(lac_reader *reader, size_t line, const char *place, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Reports a key or model that is none of the known ones, naming the nearest or all of them.
/// @param what  "key", "model" ...
void lac_add_error_unknown(lac_reader *reader, const lac_node *node, const char *what,
                           const char *const *known, size_t count);

/// Puts the issues in the order of the file; those of --set come last.
void lac_case_issues_sort(lac_case_issues *report);

/// Appends "a, b, c" to a list.
void lac_append_names(char *list, size_t size, const char *const *names, size_t count);

/// Room for items, all zero, and a copy of a text; NULL, and the reader knows, where memory is
/// short.
void *lac_reader_array(lac_reader *reader, size_t count, size_t size);
char *lac_reader_copy(lac_reader *reader, const char *text, size_t size);

enum { LAC_OWN_FLAG = 1 << 8, LAC_COLUMN_FLAG = 1 << 9 };

/// A row that is only described: the reader has a function for its key.
#define LAC_OWN(name, text) LAC_TEXT(name, 0, LAC_OPTIONAL | LAC_OWN_FLAG, text)

/// "column:unit", a char * each, one behind the other; read and written after the other rows.
#define LAC_COLUMN(name, where, si, text)                                               \
    {                                                                                   \
        .key = (name), .unit = (si), .fallback = NAN, .offset = (where), .doc = (text), \
        .flags = LAC_OPTIONAL | LAC_COLUMN_FLAG, .type = LAC_TEXT                       \
    }

/// Rows of how the times of a file stand in it; `at` is the place of the record's lac_series_def.
#define LAC_TIMES_ROWS(at)                                                              \
    LAC_TEXT("time_format", (at) + offsetof(lac_series_def, time_format), LAC_OPTIONAL, \
             "how times are written: iso, unix, excel, day, \"%d/%m/%Y %H:%M\" ..."),   \
        LAC_TEXT("clock", (at) + offsetof(lac_series_def, clock), LAC_OPTIONAL,         \
                 "column of the time of day, where dates have their own"),              \
        LAC_INTEGER("skip", (at) + offsetof(lac_series_def, skip), 0, 0, 1e6, 0,        \
                    "lines before the header; 0: it is the first line that names the columns")

/// Whether a row's field is its reader's own.
static inline bool lac_param_owned(const lac_param *param)
{
    return (param->flags & (LAC_OWN_FLAG | LAC_COLUMN_FLAG)) != 0;
}

/// Rows of slip in two directions, of `interface` and of `initial`.
extern const char *const lac_slip_names[];
#define LAC_SLIP_ROW(where)                                                                \
    LAC_CHOICE("slip", where, NAN, lac_slip_names, LAC_OPTIONAL,                           \
               "of a run: scalar, along x, as if absent; vector, along x and y, friction " \
               "against the slip rate")
#define LAC_HEADING_ROW(where)                                                                  \
    LAC_REAL("azimuth", "rad", where, NAN, -6.283185307179586, 6.283185307179586, LAC_OPTIONAL, \
             "of slip rate from x towards y, with interface.slip: vector, where slip_rate and " \
             "state are both given; along x if absent")

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

/// Whether a value is in a row's range; reported where not.
bool lac_in_range(lac_reader *reader, const lac_node *node, const lac_param *param, double value);

/// A path below a folder, whose first `length` characters count; the caller frees.
/// @return NULL where memory is short
char *lac_path_below(const char *folder, size_t length, const char *path);

enum {
    LAC_KIND_SURFACE = 0, ///< indices of lac_kind_get
    LAC_KIND_DOMAIN,
    LAC_KIND_NORMAL,
    LAC_KIND_SHEAR,
    LAC_KIND_PORE,
    LAC_KIND_PRESSING,
    LAC_KIND_FRICTION,
    LAC_KIND_WEAKENING,
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
    const char *unless;     ///< a key that makes up for it; NULL: none
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
    lac_read_fields_every, lac_read_betas, lac_read_analysis, lac_read_fitted, lac_read_compare,
    lac_read_points, lac_read_safety, lac_read_geometry;
lac_part_put lac_put_steps, lac_put_state, lac_put_start, lac_put_fields, lac_put_betas,
    lac_put_analysis, lac_put_fitted, lac_put_compare, lac_put_points, lac_put_safety,
    lac_put_geometry;

/// The keys of `material`, of which shear_speed and density stand side by side, of `inertia` of
/// `interface.geometry` and of an entry of `load.history.steps`.
enum {
    LAC_MATERIAL_SHEAR_SPEED = 2,
    LAC_MATERIAL_ROWS = 4,
    LAC_INERTIA_ROWS = 3,
    LAC_GEOMETRY_ROWS = 4,
    LAC_STEP_ROWS = 8,
    LAC_LUMP_ROWS = 3
};
extern const lac_param lac_material_rows[LAC_MATERIAL_ROWS], lac_inertia_rows[LAC_INERTIA_ROWS],
    lac_geometry_rows[LAC_GEOMETRY_ROWS], lac_step_rows[LAC_STEP_ROWS],
    lac_lump_rows[LAC_LUMP_ROWS];

/// Reads the sections below the root into a case that holds the defaults.
/// @param key  "" for all: of those that come after this one, each with those that come after it
void lac_read_sections(lac_reader *reader, const char *key, lac_case *c);

/// What `initial.state` may hold: a time, or a ratio to the steady state; of lac_initial_def.
extern const lac_param lac_state_row, lac_ratio_row;

/// What is wrong with a section as a whole; they fill in what it takes from elsewhere in the case.
/// @param pressure  that a history starts from [Pa]; NaN where the case is wrong about it
void lac_check_interface(lac_reader *reader, lac_interface_def *def);
/// Whether the section load holds anything.
bool lac_case_has_load(const lac_case *c);

void lac_check_geometry(lac_reader *reader, lac_case *c);
void lac_check_history(lac_reader *reader, lac_case *c, double pressure);
void lac_check_rg(lac_reader *reader, lac_case *c);
void lac_check_analysis(lac_reader *reader, lac_case *c);
void lac_check_fit(lac_reader *reader, lac_case *c);
void lac_check_vector(lac_reader *reader, lac_case *c);
void lac_check_cadences(lac_reader *reader, const lac_case *c);

/// What a case of fidelity events may not ask for; sets its formulation.
void lac_check_events(lac_reader *reader, lac_case *c);
void lac_check_lumped(lac_reader *reader, const lac_case *c);

/// Whether the fidelity is lumped, so that `solver.lump` counts.
bool lac_case_lumps(const lac_case *c);
/// Whether it starts steady with b > a under loads that stay: rounding decides what it does.
bool lac_case_left_to_rounding(const lac_case *c);
void lac_check_weakening(lac_reader *reader, lac_case *c);
void lac_check_points(lac_reader *reader, const lac_case *c);
void lac_check_point_names(lac_reader *reader, const lac_case *c);

/// A list of what stands below a key, as text: "[\"0 m\", \"10 m\"]", of one value without
/// brackets.
void lac_put_list(struct lac_writer *w, const char *key, const char *unit, const double *value,
                  size_t count);

/// The rest of a dotted key behind that of a part; NULL where it is not below it.
const char *lac_key_behind(const char *key, const char *part);

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

/// Cells of 32768 x 32768: a quarter of what 32-bit indices of cells hold.
#define LAC_MOST_CELLS 1073741824

/// What no section sees alone.
void lac_check_case(lac_reader *reader, lac_case *c);

/// Applies one --set to the tree.
void lac_apply_override(lac_reader *reader, lac_node *root, const lac_override *override);

/// Reads a small file that is one mapping of keys, which is the reader's root.
/// @param such  a key and its value, for messages
/// @param read  reports what is wrong with it
/// @return LAC_OK; LAC_EINPUT (the first error with its line and key); LAC_EIO; LAC_ENOMEM
lac_status lac_map_file_read(const char *path, const lac_units *units, const char *such,
                             void (*read)(lac_reader *reader, void *out), void *out,
                             lac_error *err);

/// Reads a mapping of thresholds over those that are there.
void lac_read_levels(lac_reader *reader, const lac_node *map, lac_levels *out);

/// lac_case_read_text with a units database that is there already.
lac_status lac_case_build(const lac_units *units, const char *name, const char *text, size_t size,
                          const lac_case_request *how, lac_case **out, lac_case_issues *report,
                          lac_error *err);
