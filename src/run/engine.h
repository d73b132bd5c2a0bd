/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <sundials/sundials_nonlinearsolver.h>

#include "lacuna/simulation.h"
#include "run/run.h"
#include "run/vector.h"

// Which of an engine's two methods has the stretch since the last restart.
typedef enum lac_engine_turn { LAC_TURN_NONE = 0, LAC_TURN_OWN, LAC_TURN_BRIEF } lac_engine_turn;

// What one integrator needs and gives, whichever the method. Time is origin + base + t, t the
// integrator's own: near a failure a double in total time resolves the steps no more, so t begins
// anew and what it had reached moves into base and origin.
typedef struct lac_engine {
    const struct lac_engine_kind *kind;
    const lac_problem *problem;
    const lac_run_def *def;
    lac_failure failure;    // what counts as it
    const lac_range *range; // the cells here, n of them
    size_t n;
    double origin, base, t; // time reached is their sum [s]
    double limit;          // loads are seen from below up to here: the last time before a break [s]
    double step;           // length of the last step [s]
    int64_t order;         // of the last step
    size_t unknowns;       // components of y
    double *y;             // [unknowns] state at the time reached
    double *slip;          // [n] slip at the time reached [m]; part of y where slip is an unknown
    double *work;          // lac_problem_work
    bool found;            // it holds the rates of the state looked at last, as dy/dt left them
    lac_run_result counts; // only the counters are kept here
    lac_run_result before; // those up to the last restart
    SUNContext sun;
    void *inner;          // the kind's own
    const lac_sink *sink; // told of every step by kinds that do so themselves; or NULL
    double peak;          // largest slip rate within the last step, where the kind knows it [m/s]
    double rtol;          // what a step is held to: lac_engine_rtol
    int64_t beginnings;   // anew of a method of many steps so far, where loads break
    double worth; // steps of the one-step method that the stretch since the last restart is worth
    lac_engine_turn turn;
    struct lac_engine *brief; // one-step method for short stretches between breaks; NULL: not yet
} lac_engine;

// A method of integration.
typedef struct lac_engine_kind {
    lac_status (*create)(lac_engine *engine, lac_error *err);
    void (*free)(lac_engine *engine);
    // Begins anew from engine->y and slip at t = 0 with first step h; counts are in `before`.
    lac_status (*restart)(lac_engine *engine, double h, lac_error *err);
    // One step, not beyond the integrator's time `stop`; sets t, step, order; y is current then.
    lac_status (*advance)(lac_engine *engine, double stop, lac_error *err);
    // State and slip at an integrator's time within the last step; seen [unknowns + n]: y, then
    // slip.
    bool (*at)(lac_engine *engine, double t, double *observation);
    // Brings the counters up to date.
    void (*count)(lac_engine *engine);
    // A step is a sweep of which only the end is known: `at` gives that, output times end a step,
    // the kind itself tells the sink of what happens within, and keeps the digits of its time.
    bool sweeps;
} lac_engine_kind;

extern const lac_engine_kind lac_engine_cvode; // BDF and Adams
extern const lac_engine_kind lac_engine_erk;
extern const lac_engine_kind lac_engine_events; // each cell at steps of its own

// Slip in what `at` gives: where it stands in y, or behind y.
static inline const double *lac_engine_slip_in(const lac_engine *engine, const double *seen)
{
    return seen + (lac_problem_has_slip(engine->problem) ? lac_problem_slip_place(engine->problem)
                                                         : engine->unknowns);
}

// Whether lac_engine_events can follow a problem.
lac_status lac_engine_events_check(const lac_problem *problem, lac_error *err);

lac_status lac_engine_create(const lac_problem *problem, const lac_run_def *def, lac_engine **out,
                             lac_error *err);
void lac_engine_free(lac_engine *engine);

/// As lac_problem_longest_step, from where the engine stands.
double lac_engine_longest_step(const lac_engine *engine);

// Begins anew from y and slip alone, at t = 0 with first step h: nothing of the way there carries
// over. Chooses the method: docs/theory/creep.md, "Time".
lac_status lac_engine_restart(lac_engine *engine, double h, lac_error *err);

// The kind's functions of the same names, by the method whose turn it is.
lac_status lac_engine_advance(lac_engine *engine, double stop, lac_error *err);
bool lac_engine_at(lac_engine *engine, double t, double *observation);
void lac_engine_count(lac_engine *engine);

// What a step is held to after a method of many steps has begun anew so often. It begins with short
// steps of low order, whose errors, about rtol together, have one sign and are not forgotten.
// Shares that fall as 1/k let their sum grow as log k, not as k.
double lac_engine_rtol(double rtol, int64_t beginnings);

// The loads' time at an integrator's time: within a segment they are seen from below its end.
static inline double lac_engine_clock(const lac_engine *engine, double t)
{
    double now = engine->origin + (engine->base + t);
    return now < engine->limit ? now : engine->limit;
}

static inline double lac_engine_time(const lac_engine *engine)
{
    return engine->origin + (engine->base + engine->t);
}

// Whether all but nothing of a cell's normal pressure is left: then that is what ends the run.
lac_status lac_engine_lifted(lac_engine *engine, lac_error *err);

// Errors of the kinds. @param name  of SUNDIALS' status, freed; with the transfer, where that
// failed
lac_status lac_engine_gave_up(lac_engine *engine, char *name, double step, int64_t order,
                              lac_error *err);
lac_status lac_engine_cannot_restart(const lac_engine *engine, lac_error *err);

// Mean of the cells' slip [m].
double lac_engine_mean_slip(const lac_engine *engine, const double *slip);

// The integrator's time of a time since the start.
static inline double lac_engine_inner(const lac_engine *engine, double time)
{
    return (time - engine->origin) - engine->base;
}

// Newton's iteration of a CVODE step with the problem's exact solve. To the bit what SUNDIALS' own
// makes of a solver that brings its matrix along, but without two vectors: the residual is formed
// and solved for in place of dy/dt, which nobody reads after it. NULL where memory is short.
SUNNonlinearSolver lac_newton_create(lac_engine *engine, void *cvode);

// dy/dt evaluated since this was last asked, which CVODE does not count.
int64_t lac_newton_evaluations(SUNNonlinearSolver solver);

// Whether a run can be asked for like this.
lac_status lac_check_def(const lac_run_def *def, lac_error *err);

// What a run starts from.
typedef struct lac_start_state {
    double t;
    const double *y, *slip; // slip where it is no unknown; NULL: none yet
} lac_start_state;

// Whether a run can start from it: below its limits, and slipping.
lac_status lac_check_start(const lac_problem *problem, const lac_run_def *def,
                           const lac_failure *failure, const lac_start_state *at, double *work,
                           lac_error *err);

// The largest slip rate must be one that every formulation can hold. @param v  [n] of all cells
lac_status lac_check_rates(const lac_problem *problem, double max, double t, const double *v,
                           lac_error *err);

// Slip that stops or turns back at time t must be one that the formulation can follow.
lac_status lac_check_slipping(const lac_problem *problem, const double *y, double t, double *work,
                              lac_error *err);
