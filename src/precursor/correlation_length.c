// SPDX-License-Identifier: GPL-3.0-or-later
// The longest cluster of slipping cells, and how it grows: xi ~ (tc - t)^-nu.
#include <math.h>

#include "precursor/kinds.h"

enum { FEW = 5 };

static const lac_precursor_value numbers[] = {
    {"length_m", "m", "longest cluster of slipping cells"},
    {"rise_p", "1",
     "chance of one as long in the last twentieth of the time, if time did not "
     "matter"},
    {"growth_exponent", "1", "nu of length ~ (tc - t)^-nu"},
    {"growth_error", "1", "standard error of nu"},
};

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

static lac_status look(const lac_observed *seen, lac_finding *found, lac_error *err)
{
    const lac_slip_history *s = seen->slip;
    double nu = NAN;
    double error = NAN;
    (void)err;
    if (s->n == 0) {
        return lac_finding_refuse(found, "no record holds slipping blocks");
    }
    lac_finding_add(found, "length_m", s->length[s->n - 1]);
    const double p = lac_rise_p(s->n, s->time, s->length);
    if (isfinite(p)) {
        lac_finding_add(found, "rise_p", p);
    }
    found->points = fit_growth(s, seen->tc, &nu, &error);
    if (found->points >= FEW && isfinite(nu)) {
        lac_finding_add(found, "growth_exponent", nu);
        lac_finding_add(found, "growth_error", error);
    }
    return LAC_OK;
}

const lac_precursor_kind lac_precursor_length = {
    .about = {.name = "correlation_length",
              .summary = "longest cluster of slipping cells, and its growth",
              .reference = "Borri-Brunetto, Carpinteri & Chiaia (2004), Rock Mech. Rock Eng. 37, "
                           "117"},
    .needs = LAC_NEEDS_CELLS,
    .estimator = "of the last record; rise_p by ranks of 20 equal parts of the time; ln xi on "
                 "-ln(tc - t) by ordinary least squares, tc of the log law",
    LAC_PRECURSOR_VALUES(numbers),
    .look = look,
};
