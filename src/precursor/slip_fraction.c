// SPDX-License-Identifier: GPL-3.0-or-later
// What slips at each scale, against the fixed point of the static cascade
// (docs/theory/rg-in-time.md).
#include <math.h>
#include <stdlib.h>

#include "precursor/kinds.h"

enum { BEFORE_LEVELS = 4 };

#define LEVEL(k)                                                     \
    {                                                                \
        "level_" #k, "1", "slipping part of the blocks of level " #k \
    }
static const lac_precursor_value numbers[] = {
    {"slip_fraction", "1", "slipping part of the cells"},
    {"critical_fraction", "1", "fixed point of the cascade"},
    {"distance", "1", "fixed point less the slipping part of the cells"},
    {"rise_p", "1", "chance of as much in the last twentieth of the time, if time did not matter"},
    {"level_0", "1", "slipping part of the blocks of level 0, the cells"},
    LEVEL(1),
    LEVEL(2),
    LEVEL(3),
    LEVEL(4),
    LEVEL(5),
    LEVEL(6),
    LEVEL(7),
    LEVEL(8),
    LEVEL(9),
    LEVEL(10),
    LEVEL(11),
    LEVEL(12),
    LEVEL(13),
    LEVEL(14),
    LEVEL(15),
};
static const size_t named = sizeof numbers / sizeof *numbers - BEFORE_LEVELS;

// Of the slipping cells, record by record.
static lac_status add_rise(const lac_slip_history *s, lac_forecast_fit *found, lac_error *err)
{
    double *cells = malloc(s->n * sizeof *cells);
    LAC_FAIL_MEMORY_IF(cells == NULL, err);
    for (size_t i = 0; i < s->n; i++) {
        cells[i] = s->n_slip[i * s->levels];
    }
    const double p = lac_rise_p(s->n, s->time, cells);
    if (isfinite(p)) {
        lac_forecast_fit_add(found, "rise_p", p);
    }
    free(cells);
    return LAC_OK;
}

static lac_status look(const lac_precursor_inputs *observation, lac_forecast_fit *found,
                       lac_error *err)
{
    const lac_slip_history *s = observation->slip;
    if (s->n == 0) {
        return lac_forecast_fit_refuse(found, "no record holds slipping blocks");
    }
    const double *now = s->n_slip + (s->n - 1) * s->levels;
    const double cells = now[0] / s->n_tot[0];
    found->points = s->n;
    lac_forecast_fit_add(found, "slip_fraction", cells);
    if (isfinite(s->critical_fraction)) {
        lac_forecast_fit_add(found, "critical_fraction", s->critical_fraction);
        lac_forecast_fit_add(found, "distance", s->critical_fraction - cells);
    }
    lac_status status = add_rise(s, found, err);
    for (size_t level = 0; level < s->levels && level < named; level++) {
        lac_forecast_fit_add(found, numbers[BEFORE_LEVELS + level].key,
                             now[level] / s->n_tot[level]);
    }
    return status;
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
