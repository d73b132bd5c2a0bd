/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "friction/friction.h"
#include "hierarchy/hierarchy.h"

/// Creep of cells coupled by a hierarchy, each cell with steps of its own, so that what stands
/// still costs nothing while its neighbour slips: docs/theory/fidelity-events.md.
typedef struct lac_async lac_async;

/// What such cells are made from; all but `k` must outlive them.
typedef struct lac_async_def {
    const lac_hierarchy *hierarchy;
    const double *k;              ///< [levels] stiffness of each level [Pa/m]
    const lac_friction *friction; ///< aging or slip law, a > 0, without cut-off rates
    const double *pressure;       ///< [n] total normal pressure [Pa]
    double damping;               ///< eta [Pa s/m]
    double drag;                  ///< of the mean slip rate, per pressure of a cell [s/m]; 0: none
    double tolerance;             ///< error of ln v over a step of a cell
} lac_async_def;

/// Loads that are linear in time: q_i = traction_i + p_i ratio + common - k_mean mean slip, and
/// effective normal pressure p_i share.
typedef struct lac_async_load {
    double ratio, ratio_rate;           ///< at t = 0 [1], [1/s]
    double common, common_rate;         ///< [Pa], [Pa/s]
    double share, share_rate;           ///< [1], [1/s]
    const double *shares, *share_rates; ///< [n] of each cell instead; NULL: all are alike
    double k_mean;                      ///< [Pa/m]
} lac_async_load;

/// The state of all cells at one time.
typedef struct lac_async_state {
    double *log_rate, *log_state, *slip; ///< [n] ln v, ln theta, slip [m]
} lac_async_state;

/// An update of one cell.
typedef struct lac_async_update {
    uint32_t cell;
    double t, step;    ///< its time and what has passed since the cell's last one [s]
    double rate, slip; ///< of the cell at t [m/s], [m]
} lac_async_update;

/// Where an advance ends.
typedef struct lac_async_limits {
    double stop;                           ///< not beyond this time [s]
    double mean_rate, max_rate, mean_slip; ///< nor beyond the update that comes to one of these
    int64_t updates;                       ///< nor after more updates than this
    lac_status (*observation)(void *context, const lac_async_update *update, lac_error *err);
    void *context; ///< of seen, which is told of every update; NULL: nobody is
} lac_async_limits;

/// What has been done.
typedef struct lac_async_counts {
    int64_t updates;  ///< of cells
    int64_t steps;    ///< of cells: one an update, more where the tolerance asked for it
    int64_t openings; ///< of blocks: a change of traction handed down to their children
    int64_t wakings;  ///< of cells before their step was over
} lac_async_counts;

/// Whether friction of this law can be followed; with cut_off some cell has a v1, v2 or alpha.
lac_status lac_async_follows(const lac_model_info *law, bool cut_off, lac_error *err);

/// Whether the cells' friction is one that this can follow: its law, and a > 0 everywhere.
lac_status lac_async_supports(const lac_friction *friction, lac_error *err);

lac_status lac_async_create(const lac_async_def *def, lac_async **out, lac_error *err);
void lac_async_free(lac_async *micro);

/// Begins at t = 0 from a state and the cells' traction [Pa].
void lac_async_start(lac_async *micro, const lac_async_load *load, const double *traction,
                     const lac_async_state *state);

/// Updates cells one after the other, whichever is due, up to a limit.
lac_status lac_async_advance(lac_async *micro, const lac_async_limits *limits, lac_error *err);

/// Time reached since the last start or shift [s], and what the steps left of the digits of a
/// double: a shift by the time reached makes it 0 again.
double lac_async_time(const lac_async *micro);
bool lac_async_wants_shift(const lac_async *micro);
double lac_async_shift(lac_async *micro);

/// The state at the time reached, every cell taken there from its own time; nothing is changed by
/// looking.
lac_status lac_async_evaluate(const lac_async *micro, const lac_async_state *state, lac_error *err);

/// Whether the last advance ended at a limit of rate or slip.
bool lac_async_at_limit(const lac_async *micro);

/// Mean slip rate as the cells have told it [m/s]: of each that which it foresees for its step.
double lac_async_told(const lac_async *micro);

/// Largest slip rate of any update since the last call [m/s].
double lac_async_peak(lac_async *micro);

lac_async_counts lac_async_count(const lac_async *micro);
