/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/archive.h"
#include "model/problem.h"
#include "run/points.h"

// Of lacuna/simulation.h, which only those include who look inside.
typedef struct lac_sink lac_sink;
typedef struct lac_record lac_record;
typedef struct lac_snapshot lac_snapshot;
typedef struct lac_step lac_step;
typedef struct lac_event lac_event;
typedef struct lac_extra lac_extra;
typedef struct lac_progress lac_progress;
typedef struct lac_run_result lac_run_result;

/// Per-cell fields that a run may keep.
enum {
    LAC_FIELD_SLIP = 1,
    LAC_FIELD_RATE = 2,
    LAC_FIELD_STATE = 4,
    LAC_FIELD_TRACTION = 8,
    LAC_FIELD_PORE = 16,
    LAC_FIELD_SAFETY = 32,
    LAC_FIELD_EXCESS = 64,
    LAC_FIELD_TEMPERATURE = 128,
    LAC_FIELD_BROKEN = 256
};

/// Name of the field that the bit 1 << index asks for, as a case has it; in a file "cell_" stands
/// before it. NULL: there is none.
const char *lac_run_field(size_t index);

/// What a run puts out.
typedef struct lac_run_output {
    const lac_domain *domain;       ///< NULL: nothing of the cells
    const lac_hierarchy *hierarchy; ///< NULL: no levels
    const lac_transfer *transfer;   ///< of the run, for the stiffness of its levels; NULL: not said
    unsigned fields;                ///< LAC_FIELD_*, of snapshots; 0: there are none
    const lac_load_set *loads;      ///< what they read, and whether there is water; NULL: not said
    lac_safety safety;              ///< asked: the factor of safety comes along
    const lac_weakening_set *weakening; ///< what it comes to comes along; NULL: nothing weakens
    size_t extras;
    const lac_extra *extra;   ///< [extras] what records carry beyond
    const lac_points *points; ///< that records tell of; NULL: none
    bool events;              ///< a catalogue of events comes along
    bool vector;              ///< slip in two directions: components come along
    bool dated;               ///< the run starts at a date
    double start_date;        ///< seconds since 1970 of t = 0
    bool passing;             ///< kept in memory for lac_recording_move alone: only what grows
} lac_run_output;

typedef enum lac_method { LAC_BDF = 0, LAC_ADAMS, LAC_ERK } lac_method;

/// How much is resolved in time; docs/choosing.md.
typedef enum lac_fidelity {
    LAC_FIDELITY_ODE = 0, ///< all cells, at every step
    LAC_FIDELITY_ASYNC,   ///< every cell at steps of its own: docs/theory/fidelity-events.md
    LAC_FIDELITY_STATIC,  ///< no time: the cascade of rg.h, not a run
    LAC_FIDELITY_AUTO,    ///< ODE or ASYNC, as lac_fidelity_choose finds; to lac_run it is ODE
    LAC_FIDELITY_LUMPED,  ///< as ODE, of a scene whose cells were taken together: lump.h
} lac_fidelity;

/// How often something is recorded; the tightest of what is given counts.
typedef struct lac_cadence {
    double time;       ///< [s]; NaN: not by time
    int64_t steps;     ///< 0: not by steps
    double per_decade; ///< records per decade of the mean slip rate; NaN: not by rate
} lac_cadence;

/// Checkpoints closer than so many steps make a run take many times the steps.
enum { LAC_CLOSE_STEPS = 40 };

/// Where a run stands: all that it needs to go on, in another process of the same program too.
typedef struct lac_checkpoint {
    bool planned; ///< the run begins anew there whether or not it is stopped, so that one that goes
                  ///< on from it is the same to the last bit; else to the tolerance
    double time;  ///< [s]
    size_t size;  ///< [bytes]
    const unsigned char *state; ///< the engine's, then the sinks'
} lac_checkpoint;

/// Keeps track of when something is due next.
typedef struct lac_run_clock {
    lac_cadence every;
    int64_t count;        ///< multiples of every.time passed
    int64_t steps;        ///< since the last time it was due
    double last_log_rate; ///< log10 of the mean rate then
} lac_run_clock;

/// Where a run came to, and where another one can begin: in the midst of time.
typedef struct lac_run_start {
    double origin, base; ///< their sum is the time [s]
    lac_problem_state state;
    bool same;        ///< as `y`, of the same problem but for solver and output: to the bit
    double *y, *slip; ///< [unknowns], [n] of `formulation`; NULL: by `state` alone
    lac_formulation formulation;
    double first_step; ///< that the integrator would have begun anew with [s]
    int64_t beginnings;
    lac_run_clock clock[3]; ///< of records, snapshots, checkpoints
} lac_run_start;

void lac_run_start_clear(lac_run_start *start);

/// y of a problem at the start, and slip where it is no unknown; as lac_problem_take.
lac_status lac_run_start_take(const lac_run_start *start, const lac_problem *problem, double *y,
                              double *slip, lac_error *err);

typedef struct lac_run_def {
    lac_fidelity fidelity;
    lac_method method;   ///< of fidelity ODE
    double rtol;         ///< relative on v and theta, whatever the formulation
    int projection;      ///< 1: records and snapshots are moved onto the balance; 0: as integrated
    int64_t max_order;   ///< 0: the method's own
    double first_step;   ///< [s]; NaN: from the problem's time scales, which also bound it
    int64_t max_steps;   ///< of the whole run
    double most_stiff;   ///< give up, LAC_ENUMERIC, after so many steps where stability asks an
                         ///< explicit method for as many, and for half of all; INFINITY: only count
                         ///< them; 0: they are not looked at
    double end;          ///< [s]
    double failure_rate; ///< mean slip rate that is failure [m/s]; INFINITY: none is
    double failure_slip; ///< mean slip that is failure [m]; both as lac_problem_failure takes them
    double stop_slip;    ///< end the run at this mean slip [m]; NaN: no
    double stop_rate;    ///< end the run at this largest slip rate of a cell [m/s]; NaN: no
    double stop_safety;  ///< end the run where the factor of safety falls to this [1]; NaN: no
    lac_cadence record;
    const lac_points *points; ///< that records tell of, in cells of the problem; NULL: none
    bool snapshots;
    bool cell_safety; ///< with the factor of safety of every cell
    lac_cadence snapshot;
    lac_cadence checkpoint;       ///< planned ones, at the ends of steps; nothing set: none
    const lac_checkpoint *resume; ///< go on from it; NULL: from the start
    const lac_run_start *start;   ///< begin there; NULL: at t = 0, as the problem does
    lac_run_start *reached; ///< filled where the run comes to its `end`, which may be where it
                            ///< goes on from, and to be cleared; NULL: not asked
    bool (*interrupted)(void *context); ///< asked after every step; NULL: never
    void (*progress)(void *context, const lac_progress *progress); ///< after every step; NULL
    void *context;
} lac_run_def;

/// A def with BDF, rtol 1e-6, every step recorded, no snapshots, failure at 1 m/s and at no slip
/// (a case has that of its interface); `end` is the caller's.
lac_run_def lac_run_default(void);

/// What it is called in a case.
const char *lac_fidelity_name(lac_fidelity fidelity);

/// What fidelity EVENTS asks of a scene, besides a > 0 in every cell.
typedef struct lac_async_scene {
    const lac_transfer_kind *transfer;
    const lac_model_info *law;
    bool cut_off; ///< the friction of some cell has a v1, v2 or alpha
    bool linear;  ///< the loads are linear in time between their breaks
    lac_formulation formulation;
} lac_async_scene;

/// Whether fidelity EVENTS follows such a scene.
lac_status lac_run_async_follows(const lac_async_scene *scene, lac_error *err);

/// The formulation where none is asked for, by measurement (docs/choosing.md): RATE under BDF, SLIP
/// under Adams, TRACTION under explicit methods and where the form lets slip turn back.
lac_formulation lac_formulation_choose(int asked, lac_method method, lac_friction_form form);

/// Whether a run can start: what lac_run would refuse before its first step.
lac_status lac_run_check(const lac_problem *problem, const lac_run_def *def, lac_error *err);

/// A sink that passes all on. Who stands before another one begins its context with that one, and
/// sets the members that look at something.
lac_sink lac_sink_before(lac_sink *next);

enum { LAC_SNAPSHOT_FIELDS = 15 };

/// Where a snapshot has its fields, those that it lacks, too.
void lac_snapshot_fields(lac_snapshot *snapshot, const double **field[LAC_SNAPSHOT_FIELDS]);

/// Integrates a problem in time. At planned checkpoints the integrator begins anew from what is
/// saved. A run without planned ones that is interrupted makes a forced one.
/// @param sink    gets the records, the first at t = 0; NULL drops them
/// @param result  filled as far as the run came, whatever the status
lac_status lac_run(const lac_problem *problem, const lac_run_def *def, const lac_sink *sink,
                   lac_run_result *result, lac_error *err);
