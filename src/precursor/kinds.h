/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"
#include "precursor/precursor.h"

extern const lac_precursor_kind lac_precursor_slowing, lac_precursor_log_periodicity,
    lac_precursor_b_value, lac_precursor_b_positive, lac_precursor_event_rate, lac_precursor_moment,
    lac_precursor_slip_fraction, lac_precursor_length;

/// The values of a row, for its descriptor.
#define LAC_PRECURSOR_VALUES(list) .value_count = sizeof(list) / sizeof *(list), .value = (list)

/// A stationary first-order autoregression with coefficient phi and innovations of variance 1.
void lac_surrogate_red(size_t n, double phi, uint64_t seed, size_t index, double *x);

/// Adds what the drivers of a set of forecasts explain: variables over `reading`, and JSON.
lac_status lac_drivers_describe(const lac_forecast_set *forecasts, bool json, lac_dataset *dataset,
                                lac_error *err);

/// Adds the JSON of one verdict, over `span`.
lac_status lac_verdict_describe(const lac_verdict *verdict, lac_dataset *dataset, lac_error *err);

/// Adds those of all issue times: variables over `issue`, `span` and `quantile`, the words of the
/// last one, and JSON under `rolling`.
lac_status lac_verdicts_describe(const lac_forecast_outcome *outcome, lac_dataset *dataset,
                                 lac_error *err);
