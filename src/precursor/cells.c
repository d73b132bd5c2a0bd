// SPDX-License-Identifier: GPL-3.0-or-later
// What slips at each scale, against the fixed point of the static cascade
// (docs/theory/rg-in-time.md).
#include "base/statistics.h"
#include "precursor/kinds.h"

enum { BEFORE_LEVELS = 4 };

#define LEVEL(k)                                                     \
    {                                                                \
        "level_" #k, "1", "slipping part of the blocks of level " #k \
    }
#define LEVELS                                                                                \
    LEVEL(1), LEVEL(2), LEVEL(3), LEVEL(4), LEVEL(5), LEVEL(6), LEVEL(7), LEVEL(8), LEVEL(9), \
        LEVEL(10), LEVEL(11), LEVEL(12), LEVEL(13), LEVEL(14), LEVEL(15)

static const lac_precursor_value numbers[] = {
    {"slip_fraction", "1", "slipping part of the cells"},
    {"critical_fraction", "1", "fixed point of the cascade"},
    {"distance", "1", "fixed point less the slipping part of the cells"},
    {"rise_p", "1", "chance of as much in the last twentieth of the time, if time did not matter"},
    {"level_0", "1", "slipping part of the blocks of level 0, the cells"},
    LEVELS,
};
static const size_t named = sizeof numbers / sizeof *numbers - BEFORE_LEVELS;

static void add_rise(const lac_slip_history *s, const double *values, lac_forecast_fit *found)
{
    const double p = lac_rise_p(s->n, s->time, values);
    if (isfinite(p)) {
        lac_forecast_fit_add(found, "rise_p", p);
    }
}

static lac_status look(const lac_precursor_inputs *in, lac_forecast_fit *found, lac_error *err)
{
    const lac_slip_history *s = in->slip;
    if (s->n == 0) {
        return lac_forecast_fit_refuse(found, "no record holds slipping blocks");
    }
    double *slipping = malloc(s->n * sizeof *slipping); // cells, record by record
    LAC_FAIL_MEMORY_IF(slipping == NULL, err);
    for (size_t i = 0; i < s->n; i++) {
        slipping[i] = s->n_slip[i * s->levels];
    }
    const double *now = s->n_slip + (s->n - 1) * s->levels;
    const double cells = now[0] / s->n_tot[0];
    found->points = s->n;
    lac_forecast_fit_add(found, "slip_fraction", cells);
    if (isfinite(s->critical_fraction)) {
        lac_forecast_fit_add(found, "critical_fraction", s->critical_fraction);
        lac_forecast_fit_add(found, "distance", s->critical_fraction - cells);
    }
    add_rise(s, slipping, found);
    free(slipping);
    for (size_t level = 0; level < s->levels && level < named; level++) {
        lac_forecast_fit_add(found, numbers[BEFORE_LEVELS + level].key,
                             now[level] / s->n_tot[level]);
    }
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_slip_fraction = {
    .info = LAC_ABOUT("slip_fraction",
                      "slipping blocks of each level, and how far from the fixed point",
                      "Borri-Brunetto, Carpinteri & Chiaia (2004), Rock Mech. Rock Eng. 37, 117"),
    .needs = LAC_NEEDS_CELLS,
    .estimator = "N_slip/N_tot of the last record; distance: the fixed point less that of the "
                 "cells; rise_p by ranks of 20 equal parts of the time",
    LAC_PRECURSOR_VALUES(numbers),
    .evaluate = look,
};

// The longest cluster of slipping cells, and how it grows: xi ~ (tc - t)^-nu.

enum { FEW = 5 };

static const lac_precursor_value lengths[] = {
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

static lac_status look_at_length(const lac_precursor_inputs *in, lac_forecast_fit *found,
                                 lac_error *err)
{
    const lac_slip_history *s = in->slip;
    (void)err;
    if (s->n == 0) {
        return lac_forecast_fit_refuse(found, "no record holds slipping blocks");
    }
    lac_forecast_fit_add(found, "length_m", s->length[s->n - 1]);
    add_rise(s, s->length, found);
    const lac_line growth = fit_growth(s, in->tc);
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
    LAC_PRECURSOR_VALUES(lengths),
    .evaluate = look_at_length,
};
