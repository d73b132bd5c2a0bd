/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "lacuna/simulation.h"
#include "scene/scene.h"
#include "store/recording.h"

/// What a simulation is made of, and what came out so far. All holds until it is freed.
typedef struct lac_outcome {
    const lac_case *source; ///< as it is run: with the settings that were picked
    const lac_scene *scene;
    const struct lac_branch *branch;   ///< what it goes on from; NULL: nothing
    const char *fidelity_why;          ///< why this fidelity; NULL: the case names it
    double fidelity_error;             ///< that it keeps: lac_fidelity_error
    const lac_accuracy_pick *accuracy; ///< NULL: the case asks for none
    const lac_points *points;          ///< where it is watched; NULL: the case names none
    const lac_analysis *analysis;      ///< the indicators; NULL: the case names none
    size_t extras;
    const lac_extra *extra; ///< [extras] their quantities
    const double *once;     ///< values of those over nothing, in their order; NaN: not known (yet);
                            ///< NULL: no indicators
    const char *status;     ///< as in a file: running (also before), complete, interrupted, failed
    lac_run_result run;     ///< as far as it came; zeros before
} lac_outcome;

/// Lets the run go on from a checkpoint of the same case, which must outlive it; before it is run.
void lac_simulation_resume(lac_simulation *simulation, const lac_checkpoint *from);

/// What it is made of, and what came out.
const lac_outcome *lac_simulation_outcome(const lac_simulation *simulation);

/// What the file of the run is made of, as far as the case says: the path is output.file, or NULL.
/// The command line, the libraries, the time of creation, `force`, `inputs` and `resume` are the
/// caller's.
/// @param out  what it points to holds until the simulation is freed
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_simulation_file(lac_simulation *simulation, lac_store_def *out, lac_error *err);
