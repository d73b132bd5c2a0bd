// SPDX-License-Identifier: GPL-3.0-or-later
// The size distribution by the differences of successive magnitudes, which a completeness that
// changes does not touch.
#include <math.h>
#include <stdlib.h>

#include "precursor/kinds.h"

enum { FEW = 20 };
static const double least_step = 0.2;

static const lac_precursor_value numbers[] = {
    {"b", "1", "b-value of N(>= M) ~ 10^(-b M)"},
    {"error", "1", "standard error of b"},
};

// The magnitudes from the one on from which the catalogue as a whole is complete, in their order.
static size_t keep_complete(size_t n, double *magnitude)
{
    const double mc = lac_precursor_complete_from(n, magnitude);
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        if (magnitude[i] >= mc) {
            magnitude[kept++] = magnitude[i];
        }
    }
    return kept;
}

static lac_status look(const lac_precursor_inputs *observation, lac_forecast_fit *found,
                       lac_error *err)
{
    double *magnitude = NULL;
    double error = NAN;
    size_t n = 0;
    LAC_TRY_RETURN(lac_precursor_magnitudes(observation->events, &magnitude, &n, err));
    n = n > 0 ? keep_complete(n, magnitude) : 0;
    const double b = lac_b_positive(n, magnitude, least_step, &error, &found->points);
    if (found->points < FEW) {
        (void)lac_forecast_fit_refuse(
            found, "too few events larger by %.1f than the one before: %zu, at least %d",
            least_step, found->points, (int)FEW);
    } else {
        lac_forecast_fit_add(found, "b", b);
        lac_forecast_fit_add(found, "error", error);
    }
    free(magnitude);
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_b_positive = {
    .info = LAC_ABOUT(
        "b_positive", "the same from positive differences of successive magnitudes",
        "van der Elst (2021), J. Geophys. Res. 126, e2020JB021027, doi 10.1029/2020JB021027"),
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "b = log10(e)/(mean - 0.2) over the differences of 0.2 or more of successive "
                 "magnitudes from mc, that of b_value",
    LAC_PRECURSOR_VALUES(numbers),
    .evaluate = look,
};
