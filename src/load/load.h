/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/grid.h"
#include "base/param.h"
#include "load/geometry.h"

#define LAC_GRAVITY 9.80665 /* standard gravity [m/s2] */

/// How a shear force reaches the cells.
typedef enum lac_share {
    LAC_SHARE_PRESSURE = 0, ///< q_i in proportion to p_i
    LAC_SHARE_EQUAL,        ///< the same q_i on all
    LAC_SHARE_ELASTIC, ///< q in proportion to C^-1 1: as rock that slips as one puts it on them
} lac_share;

/// The load on the interface at one time, all loads but the normal load summed.
typedef struct lac_load_state {
    double ratio, ratio_rate;   ///< Q/P of the total normal force [1], [1/s]: q_i = p_i Q/P
    double stress, stress_rate; ///< Q over the nominal area [Pa], [Pa/s]: q_i = p_i stress/mean p
    double equal_ratio, elastic_ratio; ///< Q/P shared otherwise, constant in time [1]
    double elastic, elastic_rate;      ///< stress shared as C^-1 1 [Pa], [Pa/s]
    double spring_stiffness;           ///< of the mean slip, over the nominal area [Pa/m]
    double spring_stress;        ///< sum of stiffness * travel of the far ends, and of other loads
                                 ///< that put the same stress on every cell [Pa]
    double spring_rate;          ///< its rate [Pa/s]
    double back_slip, back_rate; ///< slip of the rock around the interface [m], [m/s]
    double pore, pore_rate;      ///< pore pressure [Pa], [Pa/s]
    double normal, normal_rate;  ///< normal stress beyond that of the normal load [Pa], [Pa/s]
    lac_lake lake;               ///< that a base which bends stands in
} lac_load_state;

/// Normal load: the total mean pressure on the interface, constant in time; or, in statics, how
/// near the faces are, or how densely they touch.
typedef struct lac_normal_load {
    lac_model_info info;
    bool needs_density;
    bool slope; ///< the weight of a slope, whose factor of safety is asked for
    /// @param density  of the rock [kg/m3]; NaN where the case names none
    /// @return mean normal stress over the nominal area [Pa]; NaN where it follows from the contact
    double (*pressure)(const void *params, double density);
    /// The approach as in lac_contact_def [m]. NULL: it is not what is given
    double (*approach)(const void *params);
    /// The dimension as in lac_dyadic [1]. NULL: it is not what is given
    double (*dimension)(const void *params);
} lac_normal_load;

/// A quantity and its rate at one time.
typedef struct lac_signal {
    double value, rate;
} lac_signal;

struct lac_load_kind;

/// A load made ready: its row, its parameters and what was prepared from them.
typedef struct lac_load {
    const struct lac_load_kind *kind;
    const void *params; ///< borrowed from the model
    lac_share share;    ///< of a force; LAC_SHARE_PRESSURE where the load has no such key
    double azimuth;     ///< of its shear, from x towards y [rad]; 0 where not named
    void *state;        ///< of its kind; NULL: none
    size_t to;          ///< where in a lac_load_state its signal goes, and behind it the rate
} lac_load;

/// What loads have read from files, kept for when they are made again; for one thread.
typedef struct lac_load_files lac_load_files;

lac_status lac_load_files_create(lac_load_files **out, lac_error *err);

/// The index-th thing that was taken for want of a word in what was read ("p.csv: head: no unit is
/// named: taken as Pa"), and should be asked about; NULL past the last.
const char *lac_load_files_doubt(const lac_load_files *files, size_t index);

void lac_load_files_free(lac_load_files *files);

/// The run that loads belong to.
typedef struct lac_load_clock {
    bool dated;            ///< the run starts at a date
    double start;          ///< that date [s since 1970 UTC]
    double end;            ///< of the run, since its start [s]; NaN where nothing is run
    lac_load_files *files; ///< keeps what is read, which is then not read again; NULL: nothing kept
} lac_load_clock;

/// The cells that loads act on. All is borrowed, and must outlive the loads.
typedef struct lac_load_places {
    const lac_grid *grid;
    const uint32_t *index; ///< [n] grid index of each cell
    size_t n;
} lac_load_places;

/// What a load reads that is no stress itself: the level of a lake, rain.
typedef struct lac_load_driver {
    const char *name, *unit; ///< in a run's file; SI
    const char *long_name, *comment;
    double (*value)(const lac_load *load, double t);
} lac_load_driver;

/// A shear load, a pore pressure or a normal stress: adds its part to the sum.
typedef struct lac_load_kind {
    lac_model_info info;
    bool fixes_shear;  ///< gives Q outright (ratio, slope): excluded where `initial` fixes Q
    bool needs_anchor; ///< acts through a transfer that holds uniform slip
    bool linear;       ///< linear in time between its breaks, but where it `bends`
    bool constant;     ///< the same at all times
    bool slope;        ///< gravity on a slope, whose factor of safety is asked for
    bool on_base;      ///< acts on the weight on a base that bends
    const lac_load_driver *driver; ///< what it reads; NULL: no such thing
    /// Whether its parameters make a linear one no longer so. NULL: they never do.
    bool (*bends)(const void *params);
    /// Of the mean slip, which it brings [Pa/m]. NULL: none.
    double (*stiffness)(const void *params);
    size_t state_size; ///< of what it needs besides its parameters; 0: nothing
    /// Fills that state, which is zero: the data of a file. NULL: nothing to do.
    /// @return LAC_OK; LAC_EINPUT; LAC_EIO; LAC_ENOMEM
    lac_status (*prepare)(const void *params, const lac_load_clock *clock, void *state,
                          lac_error *err);
    void (*release)(void *state); ///< frees what the state holds, also where `prepare` failed
    /// Its stress or pressure at time t [s since the start of the run]. NULL: `add` tells.
    lac_signal (*signal)(const lac_load *load, double t);
    /// Adds what is no such stress.
    void (*add)(const lac_load *load, double t, lac_load_state *sum);
    /// Adds what differs from cell to cell, a pressure and its rate at time t; neither `signal` nor
    /// `add` is there then. NULL: all cells feel it alike.
    /// @param value, rate  [places->n] [Pa], [Pa/s]
    void (*cells)(const lac_load *load, const lac_load_places *places, double t, double *value,
                  double *rate);
    /// Readies its state for the cells, before `cells` is asked. NULL: nothing to be done.
    /// @return LAC_OK; LAC_EINPUT (what it has does not cover the cells); LAC_ENOMEM
    lac_status (*place)(const void *params, const lac_load_places *places, void *state,
                        lac_error *err);
    /// The first time after t at which the load or its rate jumps; INFINITY if none. NULL: none.
    double (*next_break)(const lac_load *load, double t);
    /// The longest step from t to the next break that cannot miss a swing [s]; INFINITY where it
    /// does not swing. NULL: it never does.
    double (*longest_step)(const lac_load *load, double t);
} lac_load_kind;

/// Makes the state of a load ready, and frees it again; *state is freed where it fails.
lac_status lac_load_prepare(const lac_load_kind *kind, const void *params,
                            const lac_load_clock *clock, void **state, lac_error *err);
void lac_load_release(const lac_load_kind *kind, void *state);

/// The loads of a scene.
typedef struct lac_load_set {
    lac_load *load; ///< [count]: forces, then pore pressures, then normal stresses
    size_t count, shear, pore;
    bool bends;    ///< one of them is not linear in time between its breaks
    bool changes;  ///< one of them is not the same at all times
    bool shaped;   ///< one of them is shared as C^-1 1, and needs `shape`
    bool varies;   ///< one of them differs from cell to cell, and needs `places`
    double *shape; ///< [contact cells] C^-1 1, its mean 1, owned; NULL where not `shaped`. Whoever
                   ///< knows the contact fills it: lac_transfer_tied
    lac_load_places places; ///< of the cells where a load differs between them: lac_load_set_place
    lac_geometry *geometry; ///< of a base that bends, owned; NULL: the load follows time alone
    double length;          ///< of the mass on it along its dip [m]
    bool directed;   ///< lac_load_evaluate takes of each shear load what it has along `along`
    double along[2]; ///< a unit vector
} lac_load_set;

/// The same loads, borrowed, of which lac_load_evaluate takes what they pull along the unit vector
/// (x, y): x cos(azimuth) + y sin(azimuth) of each, but the stiffness of a spring, which holds
/// every way.
lac_load_set lac_load_set_along(const lac_load_set *set, double x, double y);

/// Where the loads pull at t = 0 on cells of one mean normal stress [Pa], from x towards y [rad];
/// 0 where nothing pulls.
/// @return LAC_OK; LAC_EINPUT (loads that the cells share differently pull different ways, or loads
/// cancel)
lac_status lac_load_set_heading(const lac_load_set *set, double pressure, double *heading,
                                lac_error *err);

/// The loads that a case names.
typedef struct lac_load_models {
    const lac_model *shear; ///< [shear_count] of lac_load_kind
    size_t shear_count;
    const lac_model *pore; ///< [pore_count]
    size_t pore_count;
    const lac_model *normal; ///< [normal_count], on top of the normal load
    size_t normal_count;
} lac_load_models;

/// Makes loads ready: reads the files that they name. The models must outlive the set. An error
/// says which load: "load.shear.0: ...".
lac_status lac_load_set_create(const lac_load_models *models, const lac_load_clock *clock,
                               lac_load_set *set, lac_error *err);

/// How the force of a load that a case names is shared by the cells.
lac_share lac_load_models_share(const lac_model *model);

/// The azimuth that a case names of a load [rad]; NaN: none.
double lac_load_model_azimuth(const lac_model *model);

/// Fills what a set knows of its loads: `bends`, `changes`, `shaped`, `varies`.
void lac_load_set_note(lac_load_set *set);

/// Whether a load that a case names is linear in time between its breaks.
bool lac_load_model_is_linear(const lac_model *model);

/// Tells the loads where the cells are; nothing to do where none differs between them. An error
/// says which load.
/// @return LAC_OK; LAC_EINPUT; LAC_ENOMEM
lac_status lac_load_set_place(lac_load_set *set, const lac_load_places *places, lac_error *err);

/// Q over the nominal area, springs' slip apart, under the mean normal stress `pressure` [Pa].
double lac_load_shear(const lac_load_state *state, double pressure);

/// Whether the set holds a normal stress.
bool lac_load_set_presses(const lac_load_set *set);

/// What the loads that all cells feel alike take off the normal stress [Pa].
static inline double lac_load_taken(const lac_load_state *sum) { return sum->pore - sum->normal; }

/// What the index-th of the loads that read something reads, NULL past the end; and its value at
/// time t [unit].
const lac_load_driver *lac_load_set_driver(const lac_load_set *set, size_t index);
double lac_load_set_driver_at(const lac_load_set *set, size_t index, double t);

void lac_load_set_clear(lac_load_set *set);

/// Of loads that a case names: all are constant in time; one is gravity on a slope; one reads a
/// file.
typedef struct lac_load_traits {
    bool constant, slope, files;
} lac_load_traits;
lac_load_traits lac_load_models_traits(const lac_load_models *models);

/// The index-th row of each registry, NULL past the end.
const lac_normal_load *lac_normal_load_get(size_t index);
const lac_load_kind *lac_shear_load_get(size_t index);
const lac_load_kind *lac_pore_load_get(size_t index);
const lac_load_kind *lac_normal_stress_get(size_t index);

/// All loads at time t, but for those that differ from cell to cell.
void lac_load_evaluate(const lac_load_set *set, double t, lac_load_state *sum);

/// What the loads take off the normal stress of every cell at time t, of a set whose cells have
/// their places: its pore pressure less the normal stress that presses it. And each of the two.
/// @param sum          of lac_load_evaluate: what all cells feel alike is part of each
/// @param value, rate  [places.n] [Pa], [Pa/s]; overwritten
void lac_load_evaluate_cells(const lac_load_set *set, double t, const lac_load_state *sum,
                             double *value, double *rate);
void lac_load_evaluate_pore(const lac_load_set *set, double t, const lac_load_state *sum,
                            double *value, double *rate);
void lac_load_evaluate_normal(const lac_load_set *set, double t, const lac_load_state *sum,
                              double *value, double *rate);

/// Says from which cell the loads take all that presses it, where it is, and when.
/// @param taken, normal  of that cell, and the mean normal stress [Pa]
/// @return the status
lac_status lac_load_blame_cell(const lac_load_set *set, size_t cell, double taken, double normal,
                               double t, lac_status status, lac_error *err);

/// The first time after t at which any load or its rate jumps; INFINITY if none.
double lac_load_next_break(const lac_load_set *set, double t);

/// The longest step from t to the next break that misses no swing of a load [s]; INFINITY if none.
double lac_load_longest_step(const lac_load_set *set, double t);
