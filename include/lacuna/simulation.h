/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_SIMULATION_H
#define LACUNA_SIMULATION_H

#include <stdint.h>

#include "lacuna/case.h"
#include "lacuna/dataset.h"

LAC_BEGIN_C

/// A case that is run: scene, pilot runs for solver.accuracy, indicators, run. Nothing that the
/// case names of these is left out.
typedef struct lac_simulation lac_simulation;

// What the library tells of a run. Only it makes these, and they may grow at their ends.

/// What is seen of a state.
typedef struct lac_observation {
    double mean_rate;        ///< over contact cells, of either sign [m/s]
    double max_rate;         ///< largest |v| [m/s]
    double mean_slip;        ///< [m]
    double shear_force;      ///< Q [N]
    double normal_force;     ///< P, total [N]
    double effective_force;  ///< P - u L^2 [N]
    double balance_residual; ///< max |q - K slip - p f - damping - inertia| / (f0 p) [1]
    double rate_drift; ///< |sum (q - K slip - p f - damping - inertia)| / sum (a p + eta |v|): how
                       ///< far the mean slip rate is off the balance, relative to itself [1]
    size_t fastest;    ///< cell with the largest rate
    const double *points; ///< [points][4] slip [m], slip rate [m/s], traction [Pa] and state [s] at
                          ///< the case's output.points, until the sink returns; NULL: none
    double factor_of_safety; ///< strength at the reference rate over Q [1]; NaN: not asked, or
                             ///< nothing drives
    double excess_pore;      ///< pore pressure in excess of that of the loads, mean by the normal
                             ///< force of the cells [Pa]; NaN: nothing weakens, as below
    double temperature;      ///< largest rise of a cell's temperature [K]
    double broken;           ///< part of the cohesion that is broken [1]
    double slip_along[2], rate_along[2], shear_along[2]; ///< with interface.slip: vector, where
                                                         ///< what is above are sizes, along x and
                                                         ///< y: mean slip [m], mean rate [m/s],
                                                         ///< Q [N]; else not set
    const double *points_along; ///< [points][6] of such slip: slip, slip rate and traction as
                                ///< above, each along x and y; NULL: none
} lac_observation;

/// The contact cells at a record; the arrays hold until the sink returns. It does not grow.
typedef struct lac_record_cells {
    size_t n;
    const double *slip_rate; ///< [n] [m/s]
    const double *log_state; ///< [n] ln theta, theta in s
} lac_record_cells;

/// One line of the time series. What is new comes at the end of lac_observation.
typedef struct lac_record {
    double time_origin, time_local; ///< t = origin + local since the start [s]
    double step_size; ///< of the step that ended here or that this time lies in [s]; NaN at t = 0
    int64_t order;    ///< of that step; 0 at the start
    int64_t rhs_evaluations;
    lac_record_cells cells;
    const double *extra; ///< values that an analysis adds, in the order of its quantities that run
                         ///< over time; NULL: none
    lac_observation observation;
} lac_record;

/// What a quantity beyond those of every run runs over.
typedef enum lac_extra_over {
    LAC_OVER_NOTHING = 0, ///< one value, known before the run or after it
    LAC_OVER_TIME,        ///< one value a record
    LAC_OVER_LEVELS,      ///< one value a record and level of the hierarchy
} lac_extra_over;

/// A quantity beyond those of every run: what a file says of it.
typedef struct lac_extra {
    const char *name, *unit, *long_name, *comment;
    const char *cell_methods; ///< NULL: none
    lac_extra_over over;
    bool count; ///< a whole number, never missing
} lac_extra;

/// Fields of every cell at one time.
typedef struct lac_snapshot {
    double time;                    ///< [s]
    const double *slip;             ///< [n] [m]
    const double *slip_rate;        ///< [n] [m/s]
    const double *state;            ///< [n] [s]
    const double *traction;         ///< [n] [Pa]
    size_t n;                       ///< contact cells
    const double *factor_of_safety; ///< [n] of each cell [1], NaN where it carries nothing; NULL:
                                    ///< not asked
    const double *pore;             ///< [n] pore pressure [Pa]; NULL: not asked
    const double *excess_pore;      ///< [n] in excess of it [Pa]; NULL: nothing weakens, as below
    const double *temperature;      ///< [n] its rise [K]
    const double *broken;           ///< [n] part of the cohesion that is broken [1]
    const double *along[6]; ///< [n] slip, slip rate, traction, each along x and y, where those
                            ///< above are sizes (interface.slip: vector); NULL: slip is along x
    size_t first;           ///< of the cells, where a part of a field comes alone
} lac_snapshot;

/// The state after a step of the integrator; the arrays hold until the sink returns.
typedef struct lac_step {
    double time_origin, time_local; ///< t = origin + local since the start [s]
    double step;                    ///< its length [s]; 0 at the start and beyond a jump of loads
    double max_rate;                ///< largest |v| of a cell [m/s]
    size_t n;
    const double *slip_rate; ///< [n] [m/s]
    const double *slip;      ///< [n] since the start [m]
    const uint32_t *changed; ///< [changes] the only cells that moved on, the others' values are of
                             ///< no meaning; NULL: all did
    size_t changes;
} lac_step;

/// Which ends of an event lie outside the run.
enum { LAC_EVENT_BEGUN_BEFORE = 1, LAC_EVENT_UNENDED = 2 };

/// A micro-slip that has ended: docs/theory/events.md.
typedef struct lac_event {
    double time_origin, time_local; ///< of its start: origin + local [s]
    double duration;                ///< [s]
    int64_t cells;                  ///< different cells that moved
    double potency;                 ///< sum of area times slip [m3]
    double moment;                  ///< G times the potency [N m]; NaN where there is no G
    double size;                    ///< longest side [m]
    double x, y;                    ///< centre of the first cell that moved [m]
    double max_rate;                ///< of any of its cells, also between the ends of steps [m/s]
    int64_t cut;                    ///< LAC_EVENT_*; 0: whole
} lac_event;

/// How far a run has come.
typedef struct lac_progress {
    double time, end;    ///< [s]
    double mean_rate;    ///< [m/s]
    double failure_rate; ///< [m/s]
    int64_t steps;
} lac_progress;

/// Why a run ended.
typedef enum lac_end {
    LAC_END_TIME = 0,
    LAC_END_FAILURE, ///< the mean slip rate rose through that of failure
    LAC_END_SLIP,    ///< the mean slip came to that of failure
    LAC_END_STOP,
    LAC_END_INTERRUPT,
    LAC_END_ERROR, ///< the computation broke
    LAC_END_REST,  ///< a block with mass came to rest on a base that bends
} lac_end;

/// One word for it: end, rate, slip, stop_when, interrupted, error, rest. @return NULL: there is no
/// such
const char *lac_end_name(lac_end end);

/// What counts as failure: the first of the mean slip rate rising through `rate`, where that is
/// lowered of all cells together, and the mean slip, of either sign, coming to `slip`. It does not
/// grow.
typedef struct lac_failure {
    double rate;  ///< [m/s]
    bool lowered; ///< it is a p/eta, as damping holds the joint below the rate asked for
    double slip;  ///< [m]
    double start; ///< mean slip rate at the start [m/s]
    double reach; ///< at which damping holds what weakening drives from there to the rate asked
                  ///< for [m/s]; INFINITY: nothing is in the way
} lac_failure;

/// The factor of safety over the records of a run. NaN: it was not asked for. It does not grow.
typedef struct lac_safety_summary {
    double start, end, least; ///< [1]
    double least_time;        ///< of the record where it was least [s]
    double below_time; ///< when it first was below 1, between records along a line [s]; NaN: never
} lac_safety_summary;

/// Whether a joint on a base that bends was arrested: it did not fail, and at the end its mean slip
/// rate is below a tenth of the largest. NaN: the base is a plane. It does not grow.
typedef struct lac_arrest {
    bool arrested;
    double largest, largest_time; ///< mean slip rate after any step [m/s], and when [s]
    double end;                   ///< mean slip rate at the end [m/s]
} lac_arrest;

/// How a run ended and what it took.
typedef struct lac_run_result {
    lac_end end;
    lac_failure failure;                  ///< what counted as it
    bool failed;                          ///< by rate or slip
    double failure_origin, failure_local; ///< time of failure [s], NaN if none
    double time;                          ///< reached [s]
    int64_t steps, rhs_evaluations, newton_iterations, linear_solves;
    int64_t error_test_fails, nonlinear_fails, restarts;
    double max_slip_rate;    ///< of any cell at any record [m/s]
    double mean_slip;        ///< at the end [m]
    double balance_residual; ///< worst over the records
    double rate_drift;       ///< worst over the records
    lac_safety_summary safety;
    lac_arrest arrest;
    double
        stiff_steps; ///< that stability would have asked an explicit method for; 0: not looked at
    double lump_error_estimated; ///< relative, that taking cells together (solver.fidelity: lumped)
                                 ///< may have caused; 0: none were
} lac_run_result;

/// A part of the preparation.
typedef enum lac_stage { LAC_STAGE_SCENE, LAC_STAGE_ACCURACY } lac_stage;

/// How a simulation is prepared and run; from lac_simulation_options_default.
typedef struct lac_simulation_options {
    size_t size;                        ///< of this structure, as the default has it
    bool (*interrupted)(void *context); ///< asked after every step, of pilot runs too; NULL: never
    void *context;
    void (*progress)(void *context, const lac_progress *now); ///< after every step; NULL
    /// A part of the preparation is over; NULL.
    void (*prepared)(void *context, lac_stage stage, const lac_simulation *so_far);
    int threads;       ///< of long loops; 0: as many as OpenMP is set to
    bool cells_unread; ///< nobody looks at the cells of the records: those of a pilot run that is
                       ///< kept as the run then come without them, and it may have more records
    bool steps; ///< they are looked at too, with all cells of fidelity ode: a pilot run keeps them
    bool live;  ///< who gets the records wants them as the run goes on: no pilot run is kept as it
} lac_simulation_options;

/// No callbacks, threads as they are.
static inline lac_simulation_options lac_simulation_options_default(void)
{
    lac_simulation_options options = LAC_ZEROS;
    options.size = sizeof options;
    return options;
}

/// Prepares the run of a case: builds its scene, picks the settings for its solver.accuracy, makes
/// its indicators ready, and sees that the run can start.
/// @param c        read for a run; must outlive the simulation; stays as it is
/// @param options  NULL: the default
/// @return LAC_OK; LAC_EINPUT (a value of the case, also a start beyond a limit); LAC_EIO;
///         LAC_ENUMERIC (no convergence, no tolerance keeps the accuracy, no slip at the start);
///         LAC_EINTERRUPT; LAC_ENOMEM
/// @cost   of a contact; with an accuracy some three runs, after which lac_simulation_run only puts
///         out what the last of them has kept, up to 256 MB of it; the cascade where the indicator
///         `rg` has no critical_fraction
lac_status lac_simulation_create(const lac_case *c, const lac_simulation_options *options,
                                 lac_simulation **out, lac_error *err);

/// Frees a simulation; NULL is fine.
void lac_simulation_free(lac_simulation *simulation);

// Of the library's own sinks.
typedef struct lac_archive lac_archive;
typedef struct lac_checkpoint lac_checkpoint;

/// Where a run's results go; from lac_sink_default. Members may be NULL.
typedef struct lac_sink {
    size_t size; ///< of this structure, as the default has it
    void *context;
    lac_status (*record)(void *context, const lac_record *record, lac_error *err);
    /// Of a run that ranks share parts of one field at a time, whose time is NaN, and at last the
    /// time without fields.
    lac_status (*snapshot)(void *context, const lac_snapshot *snapshot, lac_error *err);
    /// After every step, also at the start and on both sides of a jump of loads.
    lac_status (*step)(void *context, const lac_step *step, lac_error *err);
    /// As an event ends; from an analysis that keeps a catalogue.
    lac_status (*event)(void *context, const lac_event *event, lac_error *err);
    /// Values of the extra quantities over nothing, in their order, NaN: not known (yet): from a
    /// simulation, before the first record and again when the run is over.
    lac_status (*once)(void *context, const double *values, lac_error *err);
    /// Passes what the sink, then those behind it, must know to go on; NULL: nothing.
    void (*serialize)(void *context, lac_archive *archive);
    /// Stores a checkpoint; NULL: none is made. All that was put out before must last as long.
    lac_status (*checkpoint)(void *context, const lac_checkpoint *checkpoint, lac_error *err);
    /// The largest slip rate from which on it looks at the cells of records and steps [m/s]; of a
    /// run that ranks share these are NULL below, but of the first step behind. 0: always.
    double cells_from;
} lac_sink;

/// A sink that drops all.
static inline lac_sink lac_sink_default(void)
{
    lac_sink sink = LAC_ZEROS;
    sink.size = sizeof sink;
    return sink;
}

/// Runs it to its end, through its indicators, into a sink; once.
/// @param sink  gets all that the case's cadences ask for, each record with the indicators' values.
///              NULL: nothing is kept but the result
/// @return LAC_OK (also at failure of the joint); LAC_EINTERRUPT; LAC_ENUMERIC with flag, time,
///         step, order and worst cell, or where a slip rate leaves the numbers; what the sink
///         returns; LAC_ENOMEM; LAC_EINPUT where it was run before
lac_status lac_simulation_run(lac_simulation *simulation, const lac_sink *sink, lac_error *err);

/// Runs it and keeps everything in memory: the variables of a run's file (docs/format.md; times are
/// seconds since the start). How it ended is in lac_simulation_result.
/// @param out  outlives the simulation; NULL unless LAC_OK or LAC_EINTERRUPT, which keeps what was
///             computed
/// @return as lac_simulation_run
/// @cost   8 bytes a variable and record, and the run
lac_status lac_simulation_record(lac_simulation *simulation, lac_dataset **out, lac_error *err);

/// Runs it into a netCDF file, as `lacuna run` does; docs/format.md.
/// @param path     NULL: output.file of the case
/// @param options  NULL: the default
/// @return as lac_simulation_run; LAC_EINPUT where there is no path, or the file exists and `force`
///         is not set; LAC_EIO
lac_status lac_simulation_write(lac_simulation *simulation, const char *path,
                                const lac_write_options *options, lac_error *err);

/// What came out, as far as the run came; zeros before. It holds until the simulation is freed.
/// @return NULL where there is no simulation
const lac_run_result *lac_simulation_result(const lac_simulation *simulation);

/// Settings that pilot runs picked for solver.accuracy, and what these say of them; docs/trade.md.
typedef struct lac_accuracy_pick {
    double asked, estimated; ///< relative errors
    const char
        *of; ///< what they are of: time of failure, time of the limit, mean slip (at the end)
    double rtol;
    const char *method, *formulation;
    int64_t pilots, evaluations; ///< runs made to find out, and what they took
    char text[256];              ///< all of it in one sentence
    double work; ///< what they took in evaluations of the right-hand side, as steps and solves
                 ///< count: docs/trade.md
    bool kept;   ///< the last of them is the run, and is not made again
} lac_accuracy_pick;

/// @return NULL: the case asks for none
const lac_accuracy_pick *lac_simulation_accuracy(const lac_simulation *simulation);

/// The index-th quantity that the case's indicators add. Those over time are `extra` of a record,
/// in this order. @return NULL past the end
const lac_extra *lac_simulation_extra(const lac_simulation *simulation, size_t index);

LAC_END_C

#endif
