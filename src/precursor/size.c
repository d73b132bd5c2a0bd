// SPDX-License-Identifier: GPL-3.0-or-later
// Size distribution of events: N(>= M) ~ 10^(-b M).
#include <math.h>
#include <stdlib.h>

#include "precursor/kinds.h"

enum { FEW = 20, BINS = 400 };
static const double bin = 0.1, beyond = 0.2, least_step = 0.2;

// Where magnitudes are complete: the fullest bin and 0.2 beyond (Woessner & Wiemer 2005).
static double complete_from(size_t n, const double *magnitude)
{
    size_t count[BINS] = {0};
    size_t best = 0;
    double lowest = magnitude[0];
    for (size_t i = 1; i < n; i++) {
        lowest = fmin(lowest, magnitude[i]);
    }
    lowest = bin * floor(lowest / bin);
    for (size_t i = 0; i < n; i++) {
        const double at = (magnitude[i] - lowest) / bin;
        count[at < BINS ? (size_t)at : BINS - 1]++;
    }
    for (size_t k = 1; k < BINS; k++) {
        best = count[k] > count[best] ? k : best;
    }
    return lowest + bin * (double)best + beyond;
}

static lac_status look_all(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    double *magnitude = NULL;
    double error = NAN;
    size_t n = 0;
    lac_status status = lac_precursor_magnitudes(seen->events, &magnitude, &n, err);
    if (status != LAC_OK) {
        return status;
    }
    if (n < FEW) {
        (void)lac_finding_refuse(found, "too few events with a moment: %zu, at least %d", n,
                                 (int)FEW);
    } else {
        const double mc = complete_from(n, magnitude);
        const double b = lac_b_value(n, magnitude, mc, 0.0, &error, &found->points);
        lac_finding_add(found, "b", b);
        lac_finding_add(found, "error", error);
        lac_finding_add(found, "complete_from", mc);
        if (found->points < FEW) {
            (void)lac_finding_refuse(found, "too few events above %.2f: %zu, at least %d", mc,
                                     found->points, (int)FEW);
        }
    }
    free(magnitude);
    return LAC_OK;
}

static lac_status look_steps(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    double *magnitude = NULL;
    double error = NAN;
    size_t n = 0;
    lac_status status = lac_precursor_magnitudes(seen->events, &magnitude, &n, err);
    if (status != LAC_OK) {
        return status;
    }
    const double b = lac_b_positive(n, magnitude, least_step, &error, &found->points);
    if (found->points < FEW) {
        (void)lac_finding_refuse(found,
                                 "too few events larger by %.1f than the one before: %zu, "
                                 "at least %d",
                                 least_step, found->points, (int)FEW);
    }
    lac_finding_add(found, "b", b);
    lac_finding_add(found, "error", error);
    free(magnitude);
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_b_value = {
    .about = {.name = "b_value",
              .summary = "size distribution of events, by maximum likelihood",
              .reference = "Aki (1965), Bull. Earthq. Res. Inst. 43, 237; Shi & Bolt (1982), Bull. "
                           "Seismol. Soc. Am. 72, 1677"},
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "b = log10(e)/(mean - mc) over magnitudes from mc, the fullest bin of 0.1 and 0.2",
    .look = look_all,
};

const lac_precursor_kind lac_precursor_b_positive = {
    .about = {.name = "b_positive",
              .summary = "the same from positive differences of successive magnitudes",
              .reference = "van der Elst (2021), J. Geophys. Res. 126, e2020JB021027, doi "
                           "10.1029/2020JB021027"},
    .needs = LAC_NEEDS_EVENTS,
    .estimator = "b = log10(e)/(mean - 0.2) over the differences of 0.2 or more",
    .look = look_steps,
};
