/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "case/case.h"
#include "lacuna/simulation.h"

/// Steps of a run whose cells move together, and of each cell that fails alone
/// (docs/theory/creep.md); updates of a cell with steps of its own, as long as none slips and on
/// the way to failure (docs/theory/fidelity-events.md).
enum {
    LAC_FEWEST_STEPS = 10,
    LAC_STEPS_PER_FAILURE = 80,
    LAC_OWN_FEWEST = 30,
    LAC_OWN_STEPS = 1000
};

typedef struct lac_scene lac_scene;

enum { LAC_FIDELITY_ROOM = 240 };

/// What a case that leaves solver.fidelity open is run with.
typedef struct lac_fidelity_choice {
    lac_fidelity fidelity;
    char why[LAC_FIDELITY_ROOM]; ///< in one line; "": the case names it
    double error;                ///< that it keeps, see lac_fidelity_error
} lac_fidelity_choice;

/// CPU time of a run [s]; most NaN: not estimated.
typedef struct lac_fidelity_cost {
    double least, most;
} lac_fidelity_cost;

/// What a case will cost, and what holds of it before it is run.
typedef struct lac_estimate {
    lac_grid grid;
    double pressure; ///< mean normal stress [Pa]; NaN: it follows from the contact
    double grid_cells;
    double contact_cells;   ///< NaN: not estimated
    double cells;           ///< these, or those of the grid
    bool exact;             ///< contact_cells is a count, not an estimate
    double critical;        ///< k_crit = p (b - a)/dc [Pa/m]; NaN: nothing is integrated
    double stiffness_ratio; ///< k_0/k_crit of the finest level [1]; NaN: does not apply
    double patch;           ///< width from which on one slips by itself, whose level's stiffness is
                            ///< k_crit [m]; INFINITY: none; NaN: does not apply
    double length;          ///< of the joint, its longer side [m]
    bool stable;     ///< one block, b <= a, or k_0 well above k_crit everywhere: no cell fails
                     ///< on its own
    bool integrated; ///< else statics: no steps
    double unknowns; ///< of a contact cell
    bool own_steps;  ///< cells take steps of their own (solver.fidelity: events), each counts
    lac_fidelity_choice choice; ///< what it is run with
    lac_fidelity_cost cost[2];  ///< of fidelity ode and of events
    const char *faster; ///< where the case names its fidelity the other one, if it is known to be
                        ///< the faster one and takes the case as it stands; NULL
    bool changing;      ///< a load changes in time: how often cells slip is not known
    double steps_least, steps_most;       ///< most NaN: not estimated
    double memory;                        ///< peak [bytes], of each rank
    double ranks;                         ///< that can share its cells at most; 1: none can
    double memory_rank;                   ///< of the first where a fourth of these share it [byte]
    double cpu_time_least, cpu_time_most; ///< [s]; most NaN: not estimated
    double records, file_bytes; ///< at stated times up to the end: records; they and the fields
    double cascade_time;        ///< of `lacuna rg`, or of the cascade that a run follows, in
                                ///< the times above then [s]; NaN: none
    lac_failure failure;        ///< what counts as it; rate 0: not known before the run
} lac_estimate;

/// In which regime a scene moves.
typedef enum lac_regime {
    LAC_REGIME_NONE = 0, ///< nothing is integrated
    LAC_REGIME_BLOCK,    ///< one cell
    LAC_REGIME_CREEP,    ///< b <= a: nothing runs away by itself
    LAC_REGIME_TOGETHER, ///< all cells as one
    LAC_REGIME_PATCHES,  ///< patches narrower than the joint slip by themselves
    LAC_REGIME_SINGLE,   ///< cells do
} lac_regime;

lac_regime lac_regime_of(const lac_estimate *estimate);

/// "one block", "creep", "together", "patches", "one by one"; NULL: none.
const char *lac_regime_name(lac_regime regime);

enum { LAC_REGIME_ROOM = 1600 };

/// What roughness, size, load and water can and cannot do there; "" where nothing is integrated.
void lac_regime_words(const lac_case *c, const lac_estimate *estimate,
                      char text[static LAC_REGIME_ROOM]);

/// Whether the load at the start is given, and no rate with a state that it follows from.
bool lac_scene_load_given(const lac_case *c);

/// Whether fidelity events refuses what a case names of solver, law, loads and transfer.
/// @param why  gets the first such, or ""
bool lac_fidelity_refused(const lac_case *c, char why[static LAC_FIDELITY_ROOM]);

/// The fidelity of a case; of one that leaves it open events where cells slip one by one and events
/// is known to be faster than ode and to keep its error, else ode; docs/choosing.md.
/// @param e  with lac_estimate_stability
lac_fidelity_choice lac_fidelity_choose(const lac_case *c, const lac_estimate *e);

/// Of a case that names its fidelity: see lac_estimate.faster.
const char *lac_fidelity_faster(const lac_case *c, const lac_estimate *e);

/// Error of the time of failure, relative, or of the mean slip where nothing fails, relative to it
/// or to dc if that is more, that a fidelity keeps at the case's rtol; docs/choosing.md.
/// @param e  with lac_estimate_stability
double lac_fidelity_error(const lac_case *c, const lac_estimate *e, lac_fidelity fidelity);

/// Settles what a case leaves open by its scene, and sets it: fidelity and formulation.
/// @param c    of the scene
/// @param out  what is chosen; of a case that names its fidelity that
/// @return LAC_OK; LAC_EINPUT: ranks do not share what is chosen; as lac_scene_renew
lac_status lac_fidelity_settle(lac_scene *scene, lac_case *c, lac_fidelity_choice *out,
                               lac_error *err);

/// Finds out how cells hold one another: from the grid, the pressure and the cells of `e`.
void lac_estimate_stability(const lac_case *c, lac_estimate *e);

/// What a case's grid takes at least, whatever is done with it [bytes].
double lac_estimate_least_memory(const lac_case *c);

/// Estimates them, and is a check too: the surface is generated, on a coarser grid where it has
/// more than 2^26 cells, not its contact; a small scene is built whole, of a large one the loads at
/// the start are looked at.
/// @return LAC_OK; what the surface, the domain or the scene returns; LAC_ENOMEM
lac_status lac_estimate_make(const lac_case *c, lac_load_files *files, lac_estimate *out,
                             lac_error *err);
