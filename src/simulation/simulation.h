/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SIMULATION_SIMULATION_H
#define LACUNA_SIMULATION_SIMULATION_H

#include "analysis/analysis.h"
#include "scene/scene.h"
#include "store/recording.h"

/// A case that is run: scene, pilot runs for solver.accuracy, indicators, run. Nothing that the
/// case names of these is left out.
typedef struct lac_simulation lac_simulation;

enum { LAC_ACCURACY_TEXT = 256 };

/// Settings that pilot runs picked for solver.accuracy, and what these say of them; docs/trade.md.
typedef struct lac_accuracy_pick {
    double asked, estimated; ///< relative errors
    const char
        *of; ///< what they are of: time of failure, time of the limit, mean slip (at the end)
    double rtol;
    const char *method, *formulation;
    int64_t pilots, evaluations;  ///< runs made to find out, and what they took
    char text[LAC_ACCURACY_TEXT]; ///< all of it in one sentence
} lac_accuracy_pick;

/// What a simulation is made of, and what came out so far. All holds until it is freed.
typedef struct lac_outcome {
    const lac_case *source; ///< as it is run: with the settings that were picked
    const lac_scene *scene;
    const lac_accuracy_pick *accuracy; ///< NULL: the case asks for none
    const lac_analysis *analysis;      ///< the indicators; NULL: the case names none
    size_t extras;
    const lac_extra *extra; ///< [extras] their quantities
    const double *once;     ///< values of those over nothing, in their order; NaN: not known (yet);
                            ///< NULL: no indicators
    const char *status;     ///< as in a file: running (also before), complete, interrupted, failed
    lac_run_result run;     ///< as far as it came; zeros before
} lac_outcome;

/// Parts of lac_simulation_create that take their time.
typedef enum lac_stage { LAC_STAGE_SCENE, LAC_STAGE_ACCURACY } lac_stage;

typedef struct lac_simulation_options {
    size_t size;                        ///< of this structure, as the default has it
    bool (*interrupted)(void *context); ///< asked after every step, of pilot runs too; NULL: never
    void *context;
    void (*progress)(void *context, const lac_progress *now); ///< after every step; NULL
    /// A part of the preparation is over; NULL.
    void (*prepared)(void *context, lac_stage stage, const lac_outcome *so_far);
    int threads; ///< of long loops; 0: as many as OpenMP is set to
} lac_simulation_options;

/// No callbacks, threads as they are.
lac_simulation_options lac_simulation_options_default(void);

/// Prepares the run of a case: builds its scene, picks the settings for its solver.accuracy, makes
/// its indicators ready, and sees that the run can start.
/// @param c        must outlive the simulation; stays as it is
/// @param options  NULL: the default
/// @return LAC_OK; LAC_EINPUT (a value of the case, also a start beyond a limit); LAC_EIO;
///         LAC_ENUMERIC (no convergence, no tolerance keeps the accuracy, no slip at the start);
///         LAC_EINTERRUPT; LAC_ENOMEM
/// @cost   of a contact; with an accuracy some four runs; the cascade where the indicator `rg` has
///         no critical_fraction
lac_status lac_simulation_create(const lac_case *c, const lac_simulation_options *options,
                                 lac_simulation **out, lac_error *err);

/// Frees a simulation; NULL is fine.
void lac_simulation_free(lac_simulation *simulation);

/// Lets the run go on from a checkpoint of the same case, which must outlive it; before it is run.
void lac_simulation_resume(lac_simulation *simulation, const lac_checkpoint *from);

/// Runs it to its end, through its indicators, into a sink; once.
/// @param sink  gets all that the case's cadences ask for, each record with the indicators' values;
///              a store's, a recording's, or one's own. NULL: nothing is kept but the outcome
/// @return as lac_run; LAC_EINPUT where it was run before
lac_status lac_simulation_run(lac_simulation *simulation, const lac_sink *sink, lac_error *err);

/// Runs it and keeps everything in memory. Beside the variables of a run's file there are, each one
/// value: `failed` (0 or 1), `failure_time` [s], `steps`, and where the case has a date
/// `start_date` [s since 1970].
/// @param out  NULL unless LAC_OK or LAC_EINTERRUPT, which keeps what was computed
/// @return as lac_simulation_run
/// @cost   8 bytes a variable and record, and the run
lac_status lac_simulation_record(lac_simulation *simulation, lac_recording **out, lac_error *err);

/// What it is made of, and what came out.
const lac_outcome *lac_simulation_result(const lac_simulation *simulation);

/// What the file of the run is made of, as far as the case says: the path is output.file, or NULL.
/// The command line, the libraries, the time of creation, `force`, `inputs` and `resume` are the
/// caller's.
/// @param out  what it points to holds until the simulation is freed
/// @return LAC_OK; LAC_ENOMEM
lac_status lac_simulation_file(lac_simulation *simulation, lac_store_def *out, lac_error *err);

/// Reads a case and records its run, in one call: for languages that cannot mirror a case.
/// @param path  of the case
/// @param sets  [count] "key.path=value", as the option --set
/// @return as lac_simulation_record; LAC_EINPUT with the first error of the case; *out is NULL also
///         where the interruption comes in the pilot runs of solver.accuracy
lac_status lac_record_case(const char *path, size_t count, const char *const *sets,
                           const lac_simulation_options *options, lac_recording **out,
                           lac_error *err);

/// As lac_record_case, of a case that is in memory.
/// @param name  stands for the path in messages; what the case names relatively is looked for
///              beside it
/// @param text  [size] YAML, as in a case file; NULL: it is in the file of that name
/// @return as lac_record_case
lac_status lac_record_case_text(const char *name, const char *text, size_t size, size_t count,
                                const char *const *sets, const lac_simulation_options *options,
                                lac_recording **out, lac_error *err);

#endif
