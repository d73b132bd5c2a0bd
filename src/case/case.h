/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "analysis/analysis.h"
#include "lacuna/case.h"
#include "lacuna/series.h"

/// A way in which a parameter varies from cell to cell: value = nominal * factor of the cell.
/// docs/theory/friction.md, "From cell to cell".
typedef struct lac_heterogeneity_kind {
    lac_model_info info;
    /// A random factor, the same for the same parameters, place and stream whatever the order.
    /// @param place   index of the cell on the grid
    /// @param stream  of random numbers under the kind's seed
    /// NULL: not random; `map` and `size` are the scene's to work out
    double (*draw)(const void *params, uint64_t place, uint64_t stream);
} lac_heterogeneity_kind;

/// Parameters of every random kind.
typedef struct lac_heterogeneity_random {
    double width; ///< sigma, half width, shape or exponent; unused where the kind has none
    int64_t seed;
    double lowest, highest; ///< range of the factor that is kept; NaN: no limit
} lac_heterogeneity_random;

/// Parameters of `map`.
typedef struct lac_heterogeneity_map {
    char *path;
    char *variable; ///< NULL: the only one that fits the grid
    int as;         ///< lac_map_use
} lac_heterogeneity_map;

typedef enum lac_map_use {
    LAC_MAP_VALUE = 0, ///< the map takes the place of the nominal value
    LAC_MAP_FACTOR,    ///< the map multiplies it
} lac_map_use;

/// Parameters of `size`: factor = (s/reference)^exponent.
typedef struct lac_heterogeneity_size {
    double exponent;
    double reference; ///< [m]
    int of;           ///< lac_size_of
} lac_heterogeneity_size;

/// Whose size a cell has.
typedef enum lac_size_of {
    LAC_SIZE_PATCH = 0, ///< square root of the area of the contact patch that the cell belongs to
    LAC_SIZE_BLOCK,     ///< side of the largest block around the cell that touches everywhere
} lac_size_of;

extern const lac_heterogeneity_kind lac_heterogeneity_map_kind, lac_heterogeneity_size_kind;

/// The index-th kind, NULL past the end.
const lac_heterogeneity_kind *lac_heterogeneity_kind_get(size_t index);

/// One spread of one parameter.
typedef struct lac_heterogeneity {
    char *key;       ///< the parameter that varies
    lac_model model; ///< a lac_heterogeneity_kind and its parameters
    size_t line;
} lac_heterogeneity;

/// Spreads of any parameters; those of one parameter multiply.
typedef struct lac_heterogeneity_list {
    size_t count;
    lac_heterogeneity *item;
} lac_heterogeneity_list;

/// Whether a spread gives values outright instead of factors: a map as `value`.
bool lac_heterogeneity_is_value(const lac_heterogeneity *spread);

/// Whether a list has a spread of a parameter.
bool lac_heterogeneity_has(const lac_heterogeneity_list *list, const char *key);

/// All that is wrong with a case, in the order of the file.
typedef struct lac_case_issues {
    size_t count, errors;
    lac_case_issue *issue;
} lac_case_issues;

void lac_case_issues_clear(lac_case_issues *report);

typedef enum lac_shape { LAC_PLANE = 0, LAC_LINE } lac_shape;

typedef enum lac_boundary { LAC_PERIODIC = 0, LAC_FREE } lac_boundary;

/// Along x, or along x and y.
typedef enum lac_slip { LAC_SLIP_SCALAR = 0, LAC_SLIP_VECTOR } lac_slip;

/// Which grid an interface is: 2^levels cells a side, or cells_x by cells_y.
typedef struct lac_interface_def {
    double size;              ///< length along x [m]
    double width;             ///< length along y [m]; NaN: that of square cells
    int64_t levels;           ///< INT64_MIN where cells_x is given
    int64_t cells_x, cells_y; ///< INT64_MIN where absent; cells_y is then cells_x
    int shape;                ///< lac_shape
    int boundary;             ///< lac_boundary
} lac_interface_def;

/// The grid of an interface. Cells are square unless a width says otherwise; on a line they are a
/// metre wide.
lac_grid lac_interface_grid(const lac_interface_def *def);

typedef struct lac_material_def {
    double shear_modulus; ///< [Pa]; NaN: no material
    double poisson;       ///< [1]
    double shear_speed;   ///< [m/s]; NaN: from the density, or no damping
    double density;       ///< [kg/m3]; NaN
} lac_material_def;

/// The mass of the block that slides.
typedef struct lac_inertia_def {
    double thickness;     ///< [m]; NaN where the mass is given
    double mass_per_area; ///< over the nominal area [kg/m2]; NaN where the thickness is given
    double columns;       ///< part that stands on the cells as columns of their own [1]
} lac_inertia_def;

typedef struct lac_model_list {
    size_t count;
    lac_model *item;
} lac_model_list;

typedef struct lac_compare_def {
    char *path;             ///< already relative to the working folder
    lac_series_def columns; ///< texts owned
    char *label;            ///< what to call it; NULL
    char *point;            ///< of output.points that it is of; NULL: of the whole joint
} lac_compare_def;

/// How the shear force spreads over the cells in `rg`.
typedef enum lac_rg_field { LAC_RG_ELASTIC = 0, LAC_RG_EQUAL, LAC_RG_UNIFORM } lac_rg_field;

/// Where the critical force of an elastic joint is looked for.
typedef enum lac_rg_search { LAC_RG_SERIES = 0, LAC_RG_SOLVE } lac_rg_search;

enum { LAC_MOST_BETAS = 32 };

/// What is held about a parameter before the data, on the coordinate that is sampled.
typedef enum lac_prior {
    LAC_PRIOR_FLAT = 0, ///< uniform within the range
    LAC_PRIOR_NORMAL,   ///< normal about a centre, within the range
} lac_prior;

/// A number of the case that `lacuna fit` estimates.
typedef struct lac_fit_parameter {
    char *key;        ///< dotted, such as friction.aging.dc
    const char *unit; ///< SI
    bool log;         ///< the coordinate is ln(value), else the value
    bool ranged;      ///< the case gives the range; else it is the parameter's own
    double low, high; ///< of the value [unit]
    int prior;        ///< lac_prior
    double centre;    ///< median or mean, as a value [unit]; NaN where flat
    double sigma;     ///< on the coordinate
} lac_fit_parameter;

enum { LAC_MOST_FITTED = 16 };

/// How the errors of successive displacements hang together.
typedef enum lac_fit_errors { LAC_ERRORS_WHITE = 0, LAC_ERRORS_AR1 } lac_fit_errors;

/// What `lacuna fit` does; docs/theory/fitting.md.
typedef struct lac_fit_def {
    bool named; ///< the case has the section
    size_t count;
    lac_fit_parameter *parameter; ///< [count]
    lac_series_def columns;       ///< texts owned; `value` is friction, and no default of its own
    char *point;                  ///< of output.points that they are of; NULL: of the whole joint
    double displacement_error;    ///< [m]; NaN: estimated (with a column sigma: its factor is)
    double friction_error;        ///< [1]; NaN: estimated
    double velocity_error;        ///< of ln(velocity) [1], or a factor; NaN: estimated
    double until;                 ///< readings later are left out [s]; NaN: none
    int errors;                   ///< lac_fit_errors, of displacements
    int offset;     ///< 1: displacements have an unknown zero; 0: they start with the run
    int64_t starts; ///< places at which the least squares begin
    int64_t walkers, steps, burn, rounds, seed;
} lac_fit_def;

/// How cells are taken together where the fidelity is lumped; docs/theory/lumped.md.
typedef struct lac_lump_def {
    int64_t level; ///< of the blocks that are taken together; < 0: as coarse as the scene allows
    int64_t nodes; ///< of a quadrature over one parameter; < 0: what was measured to be enough
    double error;  ///< relative, that it may cause [1]
} lac_lump_def;

/// A run that another one goes on from.
typedef struct lac_from_def {
    char *file; ///< already relative to the working folder
    char *at;   ///< last, a time, a date or the number of a snapshot; NULL: last
} lac_from_def;

/// What `lacuna rg` does with the interface.
typedef struct lac_rg_def {
    bool named;       ///< the case has the section
    int rule;         ///< lac_rg_rule
    int field;        ///< lac_rg_field
    int path;         ///< lac_rg_search
    int64_t contacts; ///< solved along the path of an elastic joint
    int64_t shifts;   ///< places of the grid of blocks
    int64_t seeds;    ///< surfaces or domains: the case's seed and those that follow it
    int64_t loads;    ///< Q/Q_nom along the path
    double friction;  ///< Coulomb's f [1]
    size_t betas;     ///< 0: from the friction law
    double beta[LAC_MOST_BETAS];
} lac_rg_def;

/// One entry of a history; NaN: stays as it was. Of each axis (0: x, 1: y) at most one is given.
typedef struct lac_history_step {
    double pressure; ///< mean over the nominal area [Pa]
    double ratio[2]; ///< shear load over f P [1]
    double shear[2]; ///< mean traction over the nominal area [Pa]
    double shift[2]; ///< of one body against the other [m]
    int64_t count;   ///< equal increments to get there
} lac_history_step;

/// A static history of normal and shear load.
typedef struct lac_history_def {
    int fields;      ///< lac_history_keep
    double friction; ///< Coulomb's coefficient f [1]
    size_t count;    ///< 0: no history
    lac_history_step *step;
} lac_history_def;

/// How many simulations of a case there are; outlives the case where they do.
typedef struct lac_case_use {
    _Atomic size_t simulations;
    bool freed; ///< the case is
} lac_case_use;

/// Text turned into one def per stage. Everything is SI and checked.
struct lac_case {
    char *path;
    lac_case_use *use; ///< of a case that its user may change; NULL
    lac_team *team;    ///< who share its runs; set by who has them. NULL: nobody
    char *title, *references, *institution; ///< NULL where absent
    lac_interface_def interface;
    int slip;                                ///< lac_slip; -1 where absent
    lac_model surface, domain;               ///< at most one is set
    lac_heterogeneity_list interface_spread; ///< key pressure, of a domain's cells
    lac_geometry_def geometry;               ///< no angles: the base is a plane
    lac_material_def material;
    lac_inertia_def inertia; ///< thickness and mass NaN: none
    lac_model normal;
    lac_model_list shear, pore, pressing; ///< the last: normal stresses on top of the normal load
    lac_history_def history;
    lac_model friction; ///< `info` is NULL where a static case names none
    lac_heterogeneity_list friction_spread;
    lac_model_list weakening; ///< besides friction
    lac_initial_def initial;  ///< rates and states are NULL: the scene makes them from the spread
    lac_heterogeneity_list initial_spread; ///< keys slip_rate and state
    lac_from_def from;                     ///< a run to go on from; file NULL: none
    double initial_azimuth; ///< of a slip rate given with the state [rad]; NaN: along x
    lac_model transfer;
    bool dated;
    double start_date;        ///< seconds since 1970 of t = 0; 0 where not dated
    lac_run_def run;          ///< `end` is NaN where a static case names none
    lac_case_purpose purpose; ///< that it was read for
    int formulation;          ///< lac_formulation, never AUTO once read
    double accuracy; ///< relative error to keep, by which rtol and what solver leaves open are
                     ///< picked [1]; NaN: as given
    lac_lump_def lump;
    bool method_given, formulation_given;
    double contact_tolerance; ///< relative, of pressed contacts and static histories [1]
    int fft_planning;         ///< 0: estimate, reproducible to the bit; 1: measure
    char *output_file;        ///< NULL: named after the case
    unsigned fields;          ///< LAC_FIELD_* of store.h
    size_t points;
    lac_point_def *point; ///< [points] at which a run is watched
    lac_safety safety;    ///< asked for, by name or by what lac_case_implies_safety says
    int64_t compression;
    int single; ///< 1: what is written of slips, rates, forces is of single precision
    lac_rg_def rg;
    lac_fit_def fit;
    lac_model_list analysis; ///< indicators to follow
    size_t compare_count;
    lac_compare_def *compare;
};

/// The loads that a case names, borrowed from it.
static inline lac_load_models lac_case_loads(const lac_case *c)
{
    return (lac_load_models){c->shear.item, c->shear.count,   c->pore.item,
                             c->pore.count, c->pressing.item, c->pressing.count};
}

/// How a case is to be read.
typedef struct lac_case_request {
    lac_case_purpose purpose;
    const lac_override *overrides; ///< [count] applied in order
    size_t count;
} lac_case_request;

/// Reads a case file, applies the overrides, checks everything.
/// @param path     the file; "-" is not special
/// @param request  NULL: for a run, nothing overridden
/// @param out      the case; NULL where it has errors
/// @param report   all errors and warnings; the caller clears it, whatever the status
/// @return LAC_OK; LAC_EINPUT (see report); LAC_EIO (cannot be read); LAC_ENOMEM
lac_status lac_case_read(const char *path, const lac_case_request *request, lac_case **out,
                         lac_case_issues *report, lac_error *err);

/// The text of a file, of at most 4 MiB and a byte, and a zero behind it.
/// @param text  NULL before; the caller frees it, whatever the status
/// @return LAC_OK; LAC_EIO; LAC_ENOMEM
lac_status lac_case_read_file(const char *path, char **text, size_t *size, lac_error *err);

/// As lac_case_read, from memory (the fuzzer's way in).
/// @param name    stands for the path in messages and for relative paths
/// @param report  NULL: the first error is enough
lac_status lac_case_read_text(const char *name, const char *text, size_t size,
                              const lac_case_request *request, lac_case **out,
                              lac_case_issues *report, lac_error *err);

/// Mass of the sliding block per nominal area [kg/m2]; 0: the case names no inertia.
double lac_inertia_mass(const lac_case *c);

/// Mean normal stress over the nominal area at the start [Pa]; NaN where it follows from the
/// contact, or the case says nothing of it.
double lac_case_pressure(const lac_case *c);

/// Whether a case asks for the factor of safety without naming it in `output`: its loads are
/// gravity on a slope, or a limit of the run or a map of the cells is one.
bool lac_case_implies_safety(const lac_case *c);

/// The first key of what the case names of solver, inertia and the like that is against
/// solver.fidelity events; NULL: none. Of its law, loads and transfer lac_run_async_follows tells.
const char *lac_case_bars_events(const lac_case *c);

/// Whether nothing that the case names is against solver.fidelity lumped, but for loads that differ
/// from cell to cell.
bool lac_case_admits_lumped(const lac_case *c);

/// Told what differs between two cases, keys in order. @param before, after  "" where there is none
typedef void lac_case_change(void *context, const char *key, const char *before, const char *after);

/// Tells what differs between two cases as they are resolved.
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_case_compare(const lac_case *before, const lac_case *after, lac_case_change *change,
                            void *context, lac_error *err);

/// A real number of a case, where it is and what it may be.
typedef struct lac_case_value {
    double *at;
    const lac_param *param;
} lac_case_value;

/// Which of a case's points has a name; c->points: none.
size_t lac_case_point(const lac_case *c, const char *name);

/// Finds a real parameter that the case holds by its dotted key: of the models it names (list items
/// by index), of interface and material, initial.slip_rate, initial.state (where a time) and
/// initial.state.ratio_to_steady.
/// @return false where there is none
bool lac_case_find(lac_case *c, const char *key, lac_case_value *out);

/// The seed among a model's parameters; NULL where it has none.
int64_t *lac_model_seed(const lac_model *model);

/// The row of a key of a section ("solver.rtol"), whose offset is in lac_case; NULL where there is
/// none.
const lac_param *lac_case_row(const char *key);

/// Whether the models' parameters, taken together, are sound: what no single range says.
/// @return NULL, or what is wrong
const char *lac_case_validate(const lac_case *c);

/// The index-th file that a case names, a path from the working folder; NULL past the end.
char **lac_case_file(const lac_case *c, size_t index);

/// Whether a case was read so that it serves a purpose.
/// @return LAC_OK; LAC_EINPUT
lac_status lac_case_serves(const lac_case *c, lac_case_purpose purpose, lac_error *err);

/// Puts a folder before every relative path of a case, which is then to be written elsewhere.
/// @param folder  ends in a slash
lac_status lac_case_rebase(lac_case *c, const char *folder, lac_error *err);

/// A section of plain parameters (interface, material, time, solver ...).
typedef lac_model_info lac_section;
