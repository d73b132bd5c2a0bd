/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RUN_RUN_H
#define LACUNA_RUN_RUN_H

#include "base/tape.h"
#include "model/problem.h"

typedef enum lac_method { LAC_BDF = 0, LAC_ADAMS, LAC_ERK } lac_method;

/// How much is resolved in time; docs/choosing.md.
typedef enum lac_fidelity {
    LAC_FIDELITY_ODE = 0, ///< all cells, at every step
    LAC_FIDELITY_EVENTS,  ///< every cell at steps of its own: docs/theory/fidelity-events.md
    LAC_FIDELITY_STATIC,  ///< no time: the cascade of rg.h, not a run
} lac_fidelity;

/// How often something is recorded; the tightest of what is given counts.
typedef struct lac_cadence {
    double time;       ///< [s]; NaN: not by time
    int64_t steps;     ///< 0: not by steps
    double per_decade; ///< records per decade of the mean slip rate; NaN: not by rate
} lac_cadence;

/// The contact cells at a record; the arrays hold until the sink returns.
typedef struct lac_record_cells {
    size_t n;
    const double *slip_rate; ///< [n] [m/s]
    const double *log_state; ///< [n] ln theta, theta in s
} lac_record_cells;

/// One line of the time series.
typedef struct lac_record {
    double time_origin, time_local; ///< t = origin + local since the start [s]
    lac_observation seen;
    double step_size; ///< of the step that ended here or that this time lies in [s]; NaN at t = 0
    int64_t order;    ///< of that step; 0 at the start
    int64_t rhs_evaluations;
    lac_record_cells cells;
    const double *extra; ///< values that an analysis adds, in the order of its quantities that run
                         ///< over time; NULL: none
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
    double time;             ///< [s]
    const double *slip;      ///< [n] [m]
    const double *slip_rate; ///< [n] [m/s]
    const double *state;     ///< [n] [s]
    const double *traction;  ///< [n] [Pa]
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
    double max_rate;                ///< of any of its cells at the end of a step [m/s]
    int64_t cut;                    ///< LAC_EVENT_*; 0: whole
} lac_event;

/// Where a run stands: all that it needs to go on, in another process of the same program too.
typedef struct lac_checkpoint {
    bool planned; ///< the run begins anew there whether or not it is stopped, so that one that goes
                  ///< on from it is the same to the last bit; else to the tolerance
    double time;  ///< [s]
    size_t size;  ///< [bytes]
    const unsigned char *state; ///< the engine's, then the sinks'
} lac_checkpoint;

/// Where a run's results go. Members may be NULL.
typedef struct lac_sink {
    void *context;
    lac_status (*record)(void *context, const lac_record *record, lac_error *err);
    lac_status (*snapshot)(void *context, const lac_snapshot *snapshot, lac_error *err);
    /// After every step, also at the start and on both sides of a jump of loads.
    lac_status (*step)(void *context, const lac_step *step, lac_error *err);
    /// As an event ends; from an analysis that keeps a catalogue.
    lac_status (*event)(void *context, const lac_event *event, lac_error *err);
    /// Passes what the sink, then those behind it, must know to go on; NULL: nothing.
    void (*keep)(void *context, lac_tape *tape);
    /// Stores a checkpoint; NULL: none is made. All that was put out before must last as long.
    lac_status (*checkpoint)(void *context, const lac_checkpoint *checkpoint, lac_error *err);
    /// Values of the extra quantities over nothing, in their order, NaN: not known (yet): from a
    /// simulation, before the first record and again when the run is over.
    lac_status (*once)(void *context, const double *values, lac_error *err);
} lac_sink;

/// How far a run has come.
typedef struct lac_progress {
    double time, end;    ///< [s]
    double mean_rate;    ///< [m/s]
    double failure_rate; ///< [m/s]
    int64_t steps;
} lac_progress;

/// What a case can ask of its run that lac_run does not do, and a simulation does: bits of
/// lac_run_def.beyond.
enum {
    LAC_BEYOND_ACCURACY = 1, ///< solver.accuracy: the settings that pilot runs pick
    LAC_BEYOND_ANALYSIS = 2, ///< analysis: a sink by lac_analysis_sink
    LAC_BEYOND_OUTPUT = 4,   ///< keys of output but `every`: what a sink does with what it gets
};

typedef struct lac_run_def {
    lac_fidelity fidelity;
    lac_method method;   ///< of fidelity ODE
    double wake;         ///< of fidelity EVENTS: what an unforeseen change of traction may cost a
                         ///< cell before it is looked at, over its error a step
    double rtol;         ///< relative on v and theta, whatever the formulation
    int projection;      ///< 1: records and snapshots are moved onto the balance; 0: as integrated
    int64_t max_order;   ///< 0: the method's own
    double first_step;   ///< [s]; NaN: from the problem's time scales, which also bound it
    int64_t max_steps;   ///< of the whole run
    double end;          ///< [s]
    double failure_rate; ///< mean slip rate that is failure [m/s]; INFINITY: none is
    double failure_slip; ///< mean slip that is failure [m]; both as lac_problem_failure takes them
    double stop_slip;    ///< end the run at this mean slip [m]; NaN: no
    double stop_rate;    ///< end the run at this largest slip rate of a cell [m/s]; NaN: no
    lac_cadence record;
    bool snapshots;
    lac_cadence snapshot;
    lac_cadence checkpoint;             ///< planned ones, at the ends of steps; nothing set: none
    const lac_checkpoint *resume;       ///< go on from it; NULL: from the start
    bool (*interrupted)(void *context); ///< asked after every step; NULL: never
    void (*progress)(void *context, const lac_progress *progress); ///< after every step; NULL
    void *context;
    unsigned beyond; ///< LAC_BEYOND_*, set where a case is read; lac_run refuses what is set, so a
                     ///< caller that does it clears the bit; simulation.h does all
} lac_run_def;

/// Why a run ended.
typedef enum lac_end {
    LAC_END_TIME = 0,
    LAC_END_FAILURE, ///< the mean slip rate rose through that of failure
    LAC_END_SLIP,    ///< the mean slip came to that of failure
    LAC_END_STOP,
    LAC_END_INTERRUPT,
    LAC_END_ERROR, ///< the computation broke
} lac_end;

/// One word for it: end, rate, slip, stop_when, interrupted, error.
const char *lac_end_name(lac_end end);

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
} lac_run_result;

/// A def with BDF, rtol 1e-6, every step recorded, no snapshots, failure at 1 m/s and at no slip
/// (a case has that of its interface); `end` is the caller's.
lac_run_def lac_run_default(void);

/// What a fidelity is called in a case: "ode" ...
const char *lac_fidelity_name(lac_fidelity fidelity);

/// What fidelity EVENTS asks of a scene, besides a > 0 in every cell.
typedef struct lac_events_scene {
    const lac_transfer_kind *transfer;
    const lac_descriptor *law;
    bool cut_off; ///< the friction of some cell has a v1, v2 or alpha
    bool linear;  ///< the loads are linear in time between their breaks
    lac_formulation formulation;
} lac_events_scene;

/// Whether fidelity EVENTS follows such a scene.
lac_status lac_run_events_follows(const lac_events_scene *scene, lac_error *err);

/// The formulation where none is asked for, by measurement (docs/choosing.md): RATE under BDF, SLIP
/// under Adams, TRACTION under explicit methods and where the form lets slip turn back.
lac_formulation lac_formulation_choose(int asked, lac_method method, lac_friction_form form);

/// Whether a run can start: what lac_run would refuse before its first step.
lac_status lac_run_check(const lac_problem *problem, const lac_run_def *def, lac_error *err);

/// Integrates a problem in time. At planned checkpoints the integrator begins anew from what is
/// saved. A run without planned ones that is interrupted makes a forced one.
/// @param sink    gets the records, the first at t = 0; NULL drops them
/// @param result  filled as far as the run came, whatever the status
lac_status lac_run(const lac_problem *problem, const lac_run_def *def, const lac_sink *sink,
                   lac_run_result *result, lac_error *err);

#endif
