/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "rg/rg_study.h"
#include "run/run.h"

enum { LAC_ANALYSIS_TEXT = 320 };

/// The slipped fraction at which a joint is critical, and where it is from.
typedef struct lac_critical_fraction {
    double value, low, high;        ///< [1]; low and high: 95 % interval; NaN: none
    double beta;                    ///< of the cascade, the mean over the cells; NaN: no cascade
    char source[LAC_ANALYSIS_TEXT]; ///< where it is from, or why there is none
} lac_critical_fraction;

/// What a study of the static cascade says of it. No value where the map has too few pairs, does
/// not cross the diagonal, or crosses it outside the range it was fitted to.
/// @param how  what the cascade was, for the source
lac_critical_fraction lac_critical_fraction_of(const lac_rg_result *result, const char *how,
                                               double beta);

/// Parameters of the indicator `rg`: one of the first two is given, or none, which is a strength
/// halfway between beta and 1. Absent: NaN.
typedef struct lac_analysis_rg {
    double slipping_strength; ///< part of its strength at the start [1]
    double slipping_rate;     ///< [m/s]
    double critical_fraction; ///< [1]; NaN: from the static cascade
} lac_analysis_rg;

/// Parameters of the indicator `events`.
typedef struct lac_analysis_events {
    double slip_rate; ///< at which a cell begins to move [m/s]
    double hold;      ///< part of it below which the cell ceases [1]
} lac_analysis_events;

/// What the indicators of a run are made for. All must outlive them.
typedef struct lac_analysis_scene {
    const lac_domain *domain;
    const lac_hierarchy *hierarchy;
    const lac_friction *friction;
    lac_critical_fraction critical; ///< for `rg`
    double shear_modulus;           ///< for the moment of `events` [Pa]; NaN: none
} lac_analysis_scene;

/// One thing that an indicator says when the run is over.
typedef struct lac_analysis_result {
    const char *key;  ///< SI; ends in the unit where there is one
    double value;     ///< NaN: not applicable
    const char *text; ///< instead of the value; NULL
} lac_analysis_result;

/// One line of the summary.
typedef struct lac_analysis_line {
    const char *label;
    char text[LAC_ANALYSIS_TEXT];
} lac_analysis_line;

/// An indicator at work: its quantities, and what it says in the end.
typedef struct lac_indicator {
    const struct lac_indicator_kind *kind;
    void *state;
    size_t extras;
    const lac_extra *extra; ///< [extras]
    double *once;           ///< values of those over nothing, in their order; NaN: not known (yet)
    size_t results, lines;  ///< once the run is over
    const lac_analysis_result *result;
    const lac_analysis_line *line;
} lac_indicator;

/// A kind of indicator: something followed while a run goes on.
typedef struct lac_indicator_kind {
    lac_model_info info;
    size_t state_size;
    /// Fills in the state, which is zero, extra and once.
    lac_status (*create)(const lac_analysis_scene *scene, const void *params, lac_indicator *self,
                         lac_error *err);
    void (*clear)(void *state); ///< frees what it holds, also where `create` failed
    /// Looks at a step; the events that end go to `next`. NULL: steps do not matter, and events
    /// never come.
    lac_status (*step)(lac_indicator *self, const lac_step *step, const lac_sink *next,
                       lac_error *err);
    /// Looks at a record, the first at t = 0; NULL: records do not matter.
    /// @param values  of the quantities over time, in their order, those over levels level by
    ///                level; overwritten
    void (*observe)(lac_indicator *self, const lac_record *record, double *values);
    /// When the run is over: results, lines, the last values over nothing, the last events.
    lac_status (*finish)(lac_indicator *self, const lac_run_result *result, const lac_sink *next,
                         lac_error *err);
    /// Passes what it has seen so far, to or from a checkpoint: all that observe and finish read
    /// and observe changes. NULL: a run with it makes no checkpoints.
    void (*serialize)(lac_indicator *self, lac_archive *archive);
    bool cascade; ///< needs the critical fraction; its parameters are lac_analysis_rg
} lac_indicator_kind;

/// The index-th kind in the registry, NULL past the end.
const lac_indicator_kind *lac_indicator_kind_get(size_t index);

/// The parameters of an indicator that needs the critical fraction; NULL: it does not.
lac_analysis_rg *lac_analysis_cascade(const lac_model *indicator);

/// The indicators of a run.
typedef struct lac_analysis lac_analysis;

/// @param models  [count] kinds and their parameters
lac_status lac_analysis_create(const lac_analysis_scene *scene, size_t count,
                               const lac_model *models, lac_analysis **out, lac_error *err);
void lac_analysis_free(lac_analysis *analysis);

/// A sink that has the indicators look at each record and passes it on with their values; it asks
/// for steps only where an indicator or `next` does.
/// @param next  where records, snapshots, steps and events go then
lac_sink lac_analysis_sink(lac_analysis *analysis, const lac_sink *next);

/// Whether an indicator keeps a catalogue of events; not where `analysis` is NULL.
bool lac_analysis_has_events(const lac_analysis *analysis);

/// All quantities of all indicators.
/// @param once  values of those over nothing, in their order; NaN: not known
/// @return how many
size_t lac_analysis_extras(const lac_analysis *analysis, const lac_extra **extra,
                           const double **once);

/// Values that they add to a record; 0 where `analysis` is NULL.
size_t lac_analysis_values(const lac_analysis *analysis);

/// Lets the indicators sum up when the run is over, however it ended. The last events go to the
/// sink's `next`.
lac_status lac_analysis_finish(lac_analysis *analysis, const lac_run_result *result,
                               lac_error *err);

/// The index-th indicator, NULL past the end or where `analysis` is NULL.
const lac_indicator *lac_analysis_get(const lac_analysis *analysis, size_t index);

/// The rows of the registry.
extern const lac_indicator_kind lac_indicator_rg, lac_indicator_events;
