// SPDX-License-Identifier: GPL-3.0-or-later
// What slips at each scale, against the fixed point of the static cascade
// (docs/theory/rg-in-time.md).
#include <math.h>

#include "precursor/kinds.h"

enum { FEW = 5, NAMED = 12 };

static lac_status look_fraction(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    static const char *const names[NAMED] = {"level_0", "level_1", "level_2",  "level_3",
                                             "level_4", "level_5", "level_6",  "level_7",
                                             "level_8", "level_9", "level_10", "level_11"};
    const lac_slip_history *s = seen->slip;
    (void)err;
    if (s->n == 0) {
        return lac_finding_refuse(found, "no record holds slipping blocks");
    }
    const double *now = s->n_slip + (s->n - 1) * s->levels;
    const double cells = now[0] / s->n_tot[0];
    found->points = s->n;
    lac_finding_add(found, "slip_fraction", cells);
    lac_finding_add(found, "critical_fraction", s->critical_fraction);
    lac_finding_add(found, "distance", s->critical_fraction - cells);
    for (size_t level = 0; level < s->levels && level < NAMED; level++) {
        lac_finding_add(found, names[level], now[level] / s->n_tot[level]);
    }
    return LAC_OK;
}

// ln xi = c - nu ln(tc - t) by ordinary least squares, where clusters slip.
static size_t fit_growth(const lac_slip_history *s, double tc, double *nu, double *error)
{
    double n = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    for (size_t i = 0; i < s->n; i++) { // means and moments, one record at a time
        if (!(s->length[i] > 0.0) || !(s->time[i] < tc)) {
            continue;
        }
        const double u = -log(tc - s->time[i]) - x;
        const double v = log(s->length[i]) - y;
        n += 1.0;
        x += u / n;
        y += v / n;
        xx += u * (u - u / n);
        xy += u * (v - v / n);
        yy += v * (v - v / n);
    }
    *nu = xy / xx;
    *error = n > 2.0 ? sqrt(fmax(0.0, yy - *nu * xy) / (n - 2.0) / xx) : NAN;
    return (size_t)n;
}

static lac_status look_length(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    const lac_slip_history *s = seen->slip;
    double nu = NAN;
    double error = NAN;
    (void)err;
    if (s->n == 0) {
        return lac_finding_refuse(found, "no record holds slipping blocks");
    }
    lac_finding_add(found, "length_m", s->length[s->n - 1]);
    found->points = fit_growth(s, seen->tc, &nu, &error);
    if (found->points >= FEW && isfinite(nu)) {
        lac_finding_add(found, "growth_exponent", nu);
        lac_finding_add(found, "growth_error", error);
    }
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_slip_fraction = {
    .about = {.name = "slip_fraction",
              .summary = "slipping blocks of each level, and how far from the fixed point",
              .reference = "Borri-Brunetto, Carpinteri & Chiaia (2004), Rock Mech. Rock Eng. 37, "
                           "117"},
    .needs = LAC_NEEDS_CELLS,
    .estimator =
        "N_slip/N_tot of the last record; distance: the fixed point less that of the cells",
    .look = look_fraction,
};

const lac_precursor_kind lac_precursor_length = {
    .about = {.name = "correlation_length",
              .summary = "longest cluster of slipping cells, and its growth",
              .reference = "Borri-Brunetto, Carpinteri & Chiaia (2004), Rock Mech. Rock Eng. 37, "
                           "117"},
    .needs = LAC_NEEDS_CELLS,
    .estimator =
        "of the last record; ln xi on -ln(tc - t) by ordinary least squares, tc of the log "
        "law",
    .look = look_length,
};
