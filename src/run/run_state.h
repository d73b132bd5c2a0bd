/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "run/engine.h"

static inline lac_run_clock lac_clock_start(lac_cadence every, double mean_rate)
{
    return (lac_run_clock){.every = every, .count = 1, .last_log_rate = log10(mean_rate)};
}

// The next exact time at which it is due [s]; INFINITY if it is not due by time.
static inline double lac_clock_next(const lac_run_clock *clock)
{
    return isnan(clock->every.time) ? INFINITY : (double)clock->count * clock->every.time;
}

// Whether it is due at the end of this step; by steps or by rate, not by time.
static inline bool lac_clock_due(lac_run_clock *clock, double mean_rate)
{
    double log_rate = log10(mean_rate);
    clock->steps++;
    bool by_steps = clock->every.steps > 0 && clock->steps >= clock->every.steps;
    bool by_rate = !isnan(clock->every.per_decade) &&
                   fabs(log_rate - clock->last_log_rate) * clock->every.per_decade >= 1.0;
    if (by_steps || by_rate) {
        clock->steps = 0;
        clock->last_log_rate = log_rate;
    }
    return by_steps || by_rate;
}

// When something was last put out.
typedef struct lac_instant {
    bool set;
    double origin, local;
} lac_instant;

// What the sink of a run takes, which the rank that leads has.
enum { LAC_TAKES_RECORD = 1, LAC_TAKES_SNAPSHOT = 2, LAC_TAKES_STEP = 4, LAC_TAKES_CHECKPOINT = 8 };

enum { LAC_GATHERED = 10 }; // arrays of all cells at once, at most

// A run on its way.
typedef struct lac_run_state {
    const lac_problem *problem;
    const lac_run_def *def;
    const lac_sink *sink;
    uint64_t takes;    // LAC_TAKES_*
    double cells_from; // of the sink
    bool stepped;      // its last step had cells
    double *all; // [LAC_GATHERED][all cells] where ranks share them, at the one that leads; NULL
    lac_engine *engine;
    lac_run_result *result;
    lac_run_clock record_clock, snapshot_clock, checkpoint_clock;
    lac_instant last_record, last_snapshot;
    double safety_time; // of the last record whose factor of safety is known [s]
    lac_instant looked; // whether time goes on; `local`: time gone since
    double
        *between; // [unknowns + n] state and slip within a step, where records fall there; or NULL
    double *fields;  // [4n], or up to [8n], of a snapshot, where snapshots are kept; of slip in two
                     // directions [6n] components behind; or NULL
    double *aside;   // lac_problem_work, for what is only looked at; NULL: nothing is
    double unseen;   // time stepped since stability was last looked at [s]
    double *watched; // [points][LAC_POINT_VALUES], [points][LAC_POINT_ALONG], and [n] tractions;
                     // NULL: no points
    double *onto; // [unknowns + n] state and slip on the balance, where projection is asked for; or
                  // NULL
    double next_break;
    double mean_rate, max_rate; // at the time reached [m/s]
    bool measured;              // the work still holds the rates of the state reached
    double first_step;          // that the integrator last began anew with [s]
    int64_t steps;
    lac_end end;
    bool done;
    bool broken; // the step ended where the loads jump or bend
    bool bends;  // the base does
} lac_run_state;

// An array of the cells, of all of them at the rank that leads; at others no more than those here.
// @param place  of those arrays; each is used once for what is put out
const double *lac_run_state_gather(const lac_run_state *r, const double *x, size_t place);

// Whether the sink looks at the cells at such a largest rate; one that has them here always can.
static inline bool lac_run_state_shows(const lac_run_state *r, double max_rate)
{
    return r->engine->range->team == NULL || !(max_rate < r->cells_from);
}

// Whether this rank has the sink; what it says, to all ranks.
static inline bool lac_run_state_leads(const lac_run_state *r)
{
    return lac_team_leads(r->engine->range->team);
}
static inline lac_status lac_run_state_agree(const lac_run_state *r, lac_status status,
                                             lac_error *err)
{
    return lac_team_agree(r->engine->range->team, status, err);
}

// Hands one line of the time series to the sink; a time already recorded is passed over.
// @param t, y, slip  of the engine's own time, its state then
lac_status lac_run_state_record(lac_run_state *r, double t, const double *y, const double *slip,
                                lac_error *err);

// The same of the cells.
lac_status lac_run_state_snapshot(lac_run_state *r, double t, const double *y, const double *slip,
                                  lac_error *err);

// Before a step: whether another one is allowed, and time still goes on.
lac_status lac_run_state_check(lac_run_state *r, lac_error *err);

// Shows a sink that asks for every step the state reached; its rates are those in engine->work.
// @param step  length of the step that ended here; 0 at the start and beyond a jump [s]
lac_status lac_run_state_watch(lac_run_state *r, double step, lac_error *err);

// Takes the factor of safety of a record at time t, NaN where there is none, into the result. Where
// the loads jump it has come to its value at once.
void lac_run_state_keep_safety(lac_run_state *r, double t, double now);

// Takes the mean slip rate at the time reached into the result, where the base bends.
void lac_run_state_keep_peak(lac_run_state *r);

// Whether a jump of the loads at time t has come to a limit of time.stop_when.
bool lac_run_state_stops(const lac_run_state *r, double t);

// Where a sweep has to end for what is put out at stated times; INFINITY for engines that know all
// of a step.
double lac_run_state_sweep_end(const lac_run_state *r);

// Whether the case plans checkpoints.
bool lac_run_state_plans(const lac_run_def *def);

// Whether a planned checkpoint is due at the end of this step; asked once a step.
bool lac_run_state_checkpoint_due(lac_run_state *r);

// Hands a checkpoint to the sink, the integrator having begun anew there.
lac_status lac_run_state_checkpoint(lac_run_state *r, bool planned, lac_error *err);

// Puts the run where its def's start is, which does not begin at t = 0.
lac_status lac_run_state_start(lac_run_state *r, lac_error *err);

// The clocks of what is put out from there on: those of a run that goes on where all is the same.
void lac_run_state_start_clocks(lac_run_state *r);

// Fills def->reached at the end of the run.
lac_status lac_run_state_reach(lac_run_state *r, lac_error *err);

// Puts the run where its def's checkpoint left it, up to where the integrator begins anew.
lac_status lac_run_state_resume(lac_run_state *r, lac_error *err);

typedef enum lac_crossing_kind {
    LAC_CROSSING_NONE = 0,
    LAC_CROSSING_FAILURE, // mean slip rate, lac_problem_past_failure
    LAC_CROSSING_RATE,    // largest slip rate
    LAC_CROSSING_SLIP,    // mean slip
    LAC_CROSSING_SAFETY,  // factor of safety, downwards
    LAC_CROSSING_GONE,    // mean slip, of failure
    LAC_CROSSING_REST,    // no limit: a block came to rest, lac_problem_settles
} lac_crossing_kind;

// Looks for the first limit crossed upwards within the step just made; where one was, the
// engine's time, state and slip are taken back to the crossing.
// @param speed  mean and largest slip rate at the end of the step [m/s]
lac_status lac_crossing_find(lac_engine *engine, const lac_run_def *def, const double speed[2],
                             lac_crossing_kind *found, lac_error *err);

// Why a run ends with it.
lac_end lac_crossing_end(lac_crossing_kind kind);
