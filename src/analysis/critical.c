// SPDX-License-Identifier: GPL-3.0-or-later
// The critical slip fraction, from the map of a static cascade, or the reason why there is none.
#include <math.h>
#include <stdio.h>

#include "analysis/analysis.h"

lac_critical_fraction lac_critical_fraction_of(const lac_rg_result *result, const char *how,
                                               double beta)
{
    const double lowest = 0.05; // the map's own range of fit
    const lac_rg_estimate *c = &result->fixed_point;
    lac_critical_fraction out = {.value = NAN, .low = NAN, .high = NAN, .beta = beta};
    if (isnan(result->map.lambda)) {
        (void)snprintf(out.source, sizeof out.source,
                       "none: %zu pairs of slipped fractions are too few for a map (%s)",
                       result->map.points, how);
    } else if (isnan(c->value)) {
        (void)snprintf(out.source, sizeof out.source,
                       "none: the map does not cross the diagonal, lambda = %.4g (%s)",
                       result->map.lambda, how);
    } else if (!(c->value > lowest && c->value < 1.0 - lowest)) {
        (void)snprintf(out.source, sizeof out.source,
                       "none: the map crosses the diagonal at %.3g only, beyond the range from %g "
                       "to %g it was fitted to (%s)",
                       c->value, lowest, 1.0 - lowest, how);
    } else {
        out.value = c->value;
        out.low = c->low;
        out.high = c->high;
        (void)snprintf(out.source, sizeof out.source, "static cascade: %s", how);
    }
    return out;
}
