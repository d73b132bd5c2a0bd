/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "forecast/hindcast.h"
#include "lacuna/dataset.h"
#include "series/series.h"

/// Catalogue of events of a run.
typedef struct lac_event_list {
    size_t n;
    const double *time;   ///< [n] start [s], never decreasing
    const double *moment; ///< [n] [N m]; NaN where not known
    const double *end;    ///< [n] [s], from when on it is known; NULL: at once
} lac_event_list;

/// What slips in a run, record by record.
typedef struct lac_slip_history {
    size_t n, levels;         ///< records; levels of blocks
    const double *time;       ///< [n] [s]
    const double *n_slip;     ///< [n][levels] slipping blocks
    const double *n_tot;      ///< [levels]
    const double *length;     ///< [n] correlation length [m]
    double critical_fraction; ///< fixed point of the cascade; NaN: none
} lac_slip_history;

/// What indicators look at: all of it up to the present. What a source does not have is NULL.
typedef struct lac_precursor_inputs {
    const lac_motion *motion;
    const lac_event_list *events;
    const lac_slip_history *slip;
    double tc;     ///< time of failure as the log law has it now [s]; NaN: it has none
    double start;  ///< of the acceleration [s]; NaN: none
    uint64_t seed; ///< of surrogates
    size_t surrogates;
} lac_precursor_inputs;

typedef enum lac_needs { LAC_NEEDS_MOTION = 0, LAC_NEEDS_EVENTS, LAC_NEEDS_CELLS } lac_needs;

/// What an indicator says now.
typedef struct lac_precursor {
    const struct lac_precursor_kind *kind;
    lac_forecast_fit found; ///< value[0 ... count - 1], points; reason: why there is none
} lac_precursor;

/// A number that an indicator can give.
typedef struct lac_precursor_value {
    const char *key;  ///< ends in its unit where there is one
    const char *unit; ///< UDUNITS
    const char *text; ///< what it is
} lac_precursor_value;

/// An indicator: a row of a table.
typedef struct lac_precursor_kind {
    lac_model_info info;
    lac_needs needs;
    const char *estimator; ///< exactly what is computed from what
    size_t value_count;
    const lac_precursor_value *value; ///< [value_count] all that it can give, in this order
    size_t headline;                  ///< which of them a table shows
    bool page; ///< the page of a run tells it of the whole catalogue, of which it needs no more
    /// Looks at what there is; needs are met.
    /// @return LAC_OK; LAC_ENOMEM
    lac_status (*evaluate)(const lac_precursor_inputs *in, lac_forecast_fit *found, lac_error *err);
} lac_precursor_kind;

/// The index-th indicator in the registry, NULL past the end.
const lac_precursor_kind *lac_precursor_kind_get(size_t index);

/// What a kind needs: "series", "events" or "cells".
const char *lac_needs_name(lac_needs needs);

/// All indicators.
enum { LAC_PRECURSORS_MAX = 16 };
lac_status lac_precursors_evaluate(const lac_precursor_inputs *in, lac_precursor *out,
                                   size_t *count, lac_error *err);

/// What a source holds besides its motion, all of it: the past of each time is cut from it.
typedef struct lac_indicator_inputs {
    const lac_event_list *events; ///< NULL: none
    const lac_slip_history *slip; ///< NULL: none
    uint64_t seed;                ///< of surrogates
    size_t surrogates;
} lac_indicator_inputs;

/// No events, no cells; seed 1, 199 surrogates.
lac_indicator_inputs lac_evidence_default(void);

/// All indicators as of the forecasts' time of issue: from the motion it saw, the events that had
/// ended and the records that had been made, tc and start as its log law has them if it issues.
lac_status lac_precursors_at(const lac_indicator_inputs *inputs, const lac_forecast_set *forecasts,
                             lac_precursor *out, size_t *count, lac_error *err);

/// Indicators in time.
typedef struct lac_indicator_series {
    const lac_indicator_inputs *inputs;
    size_t issues, kinds;
    lac_precursor found[]; ///< [issues][kinds]
} lac_indicator_series;

/// b-value of a catalogue, as the indicator of that name has it. @return LAC_OK; LAC_ENOMEM
/// @param b  NaN where too few events have a moment
lac_status lac_events_b_value(const lac_event_list *events, double *b, lac_error *err);

/// b-value of magnitudes at or above mc (Aki 1965, Utsu 1965), log10(e)/(mean - mc).
/// @param error  Shi & Bolt (1982): 2.30 b^2 (variance of the mean)^(1/2)
/// @return b; NaN where fewer than two magnitudes count
double lac_b_value(size_t n, const double *magnitude, double mc, double *error, size_t *used);

/// b-value of the positive differences of successive magnitudes, at least `least` (van der Elst
/// 2021): log10(e)/(mean - least). Knows nothing of a completeness that changes in time.
/// @return b; NaN where fewer than two differences count
double lac_b_positive(size_t n, const double *magnitude, double least, double *error, size_t *used);

/// Kendall's tau of values against their order, tau-a.
double lac_kendall(size_t n, const double *values);

/// Rise of values that hold until the next: chance, if time did not matter, that the last of 20
/// equal parts of the time has the largest value of all, or its rank. 5 % of false alarms
/// where the largest may fall anywhere, fewer where values are equal.
/// @param time  [n] never decreasing
/// @return from 1/20 to 1; NaN where no time passes
enum { LAC_RISE_PARTS = 20 };
double lac_rise_p(size_t n, const double *time, const double *values);

/// Chance that as many of n events as `late` fall into the last half of a time in which they come
/// at a constant rate.
double lac_half_p(size_t n, size_t late);

/// Rising variance and lag-1 autocorrelation before a transition (Dakos et al. 2008): Kendall's
/// tau and the share of surrogates with one as high.
typedef struct lac_slowing {
    double variance_tau, variance_p, variance_phase_p;
    double autocorrelation_tau, autocorrelation_p, autocorrelation_phase_p;
    double autocorrelation; ///< of the last window
    double variance;        ///< same, of the values' unit squared
} lac_slowing;

/// Of evenly spaced values: a parabola is taken off, variance and autocorrelation are those of
/// trailing windows of half the length, tau is over the windows. The surrogates are first-order
/// autoregressions of the autocorrelation of what is left, and (`phase`) what is left with the
/// phases of its Fourier transform at random (Theiler et al. 1992), all put through the same.
/// @pre n >= 12
lac_status lac_slowing_measure(size_t n, const double *values, uint64_t seed, size_t surrogates,
                               lac_slowing *out, lac_error *err);

/// Forecasts and indicators as they are told.
typedef struct lac_forecast_outcome {
    const char *source;                          ///< the file that they are of
    const lac_series *series;                    ///< NULL: the file is a run's
    char run_status[16];                         ///< as the file of a run says; "": a series
    const lac_readings *readings;                ///< NULL: there is no JSON
    bool dated;                                  ///< times are seconds since 1970 UTC
    double failed_at;                            ///< [s]; NaN: not known; INFINITY: never
    double horizon;                              ///< of alarms [s]
    lac_forecast_set *forecasts;                 ///< at the last reading
    size_t indicators;                           ///< kinds of them; 0: none
    lac_precursor indicator[LAC_PRECURSORS_MAX]; ///< [indicators] at the last reading
    lac_rolling *rolling;                        ///< NULL: the last forecasts alone are told
    bool interrupted;                       ///< rolling has not all issue times that it should have
    lac_indicator_series *indicator_series; ///< of the same issue times; NULL: as rolling, or none
    lac_skill *skill;                       ///< [methods]; NULL: no time of failure
} lac_forecast_outcome;

/// Forecasts, also what methods would say without the gates, and indicators as of the last reading;
/// then at `issues` readings at most (0: none), with their skill where the failure is known.
/// @param inputs  must outlive the outcome
/// @param watch   NULL: nobody; where it sees, nobody keeps indicators in time
/// @param of      has readings, failed_at and horizon
/// @return LAC_OK; LAC_EINPUT; LAC_ENOMEM; LAC_EINTERRUPT (`interrupted`: what was done is there)
lac_status lac_forecast_look(const lac_forecast_def *def, const lac_indicator_inputs *inputs,
                             size_t issues, const lac_rolling_watch *watch,
                             lac_forecast_outcome *of, lac_error *err);

/// Frees what it made.
void lac_forecast_outcome_clear(lac_forecast_outcome *of);

/// A time of its clock: "2015-07-05 09:54", or a number in the unit that the file counts in, of a
/// run in the unit that reads best; "-" where there is none.
/// @return text
const char *lac_outcome_time(const lac_forecast_outcome *outcome, double t, char *text,
                             size_t size);

/// Whether its dates are of a known zone, UTC; those that say none are taken as they are.
bool lac_outcome_zoned(const lac_forecast_outcome *outcome);

/// The verdict in words: the level and its rule, whether it accelerates, how far it moved, its rate
/// over each span, when it fails; and bytes that hold any of these lines.
enum { LAC_VERDICT_LINES = 5, LAC_VERDICT_LONGEST = 512 };

/// What a line is about: "level" ...
extern const char *const lac_verdict_about[LAC_VERDICT_LINES];

/// One line of it, of the verdict at the last reading. Its dates say their zone.
/// @return text
const char *lac_verdict_line(const lac_forecast_outcome *outcome, size_t line, char *text,
                             size_t size);

/// Their variables, for a file or JSON; docs/format.md.
/// @param outcome  with all that it points to must outlive the dataset
lac_status lac_forecast_describe(const lac_forecast_outcome *outcome, lac_dataset **out,
                                 lac_error *err);

/// What is told of one time of issue, for JSON: when it was, and each method's answer with its
/// reason. A line of `precursors --rolling --jsonl` and one of `watch` are both this.
/// @param forecasts  must outlive the dataset
lac_status lac_issue_describe(const lac_forecast_set *forecasts, bool dated, lac_dataset **out,
                              lac_error *err);
