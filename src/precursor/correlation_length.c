// SPDX-License-Identifier: GPL-3.0-or-later
// The longest cluster of slipping cells, and how it grows: xi ~ (tc - t)^-nu.
#include <math.h>

#include "base/statistics.h"
#include "precursor/kinds.h"

enum { FEW = 5 };

static const lac_precursor_value numbers[] = {
    {"length_m", "m", "longest cluster of slipping cells"},
    {"rise_p", "1",
     "chance of one as long in the last twentieth of the time, if time did not matter"},
    {"growth_exponent", "1", "nu of length ~ (tc - t)^-nu"},
    {"growth_error", "1", "standard error of nu"},
};

// ln xi = c - nu ln(tc - t) by ordinary least squares, where clusters slip.
static lac_line fit_growth(const lac_slip_history *s, double tc)
{
    lac_line line = {0};
    for (size_t i = 0; i < s->n; i++) {
        if (s->length[i] > 0.0 && s->time[i] < tc) {
            lac_line_add(&line, -log(tc - s->time[i]), log(s->length[i]));
        }
    }
    return line;
}

static lac_status look(const lac_precursor_inputs *observation, lac_forecast_fit *found,
                       lac_error *err)
{
    const lac_slip_history *s = observation->slip;
    (void)err;
    if (s->n == 0) {
        return lac_forecast_fit_refuse(found, "no record holds slipping blocks");
    }
    lac_forecast_fit_add(found, "length_m", s->length[s->n - 1]);
    const double p = lac_rise_p(s->n, s->time, s->length);
    if (isfinite(p)) {
        lac_forecast_fit_add(found, "rise_p", p);
    }
    const lac_line growth = fit_growth(s, observation->tc);
    found->points = (size_t)growth.n;
    if (found->points >= FEW && isfinite(lac_line_slope(&growth))) {
        lac_forecast_fit_add(found, "growth_exponent", lac_line_slope(&growth));
        lac_forecast_fit_add(found, "growth_error", lac_line_error(&growth));
    }
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_length = {
    .info = LAC_ABOUT("correlation_length", "longest cluster of slipping cells, and its growth",
                      "Borri-Brunetto, Carpinteri & Chiaia (2004), Rock Mech. Rock Eng. 37, 117"),
    .needs = LAC_NEEDS_CELLS,
    .estimator = "of the last record; rise_p by ranks of 20 equal parts of the time; ln xi on "
                 "-ln(tc - t) by ordinary least squares, tc of the log law",
    LAC_PRECURSOR_VALUES(numbers),
    .evaluate = look,
};
