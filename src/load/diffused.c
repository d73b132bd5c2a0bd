// SPDX-License-Identifier: GPL-3.0-or-later
// The pressure in rock at some distance from a face whose pressure changes, by an exact solution.
#include "load/diffused.h"

#include <math.h>
#include <stdlib.h>

#include "load/kinds.h"

lac_status lac_diffused_create(const lac_lagged *face, double distance, double diffusivity,
                               lac_diffused *out, lac_error *err)
{
    *out = (lac_diffused){.first = face->drive[0]};
    out->t = malloc(2 * face->n * sizeof *out->t);
    if (out->t == NULL) {
        return lac_fail_memory(err);
    }
    out->n = face->n;
    out->bend = out->t + face->n;
    out->time = 0.25 * distance / diffusivity * distance;
    double before = 0.0;
    for (size_t k = 0; k < face->n; k++) {
        out->t[k] = face->t[k];
        out->bend[k] = face->slope[k] - before;
        before = face->slope[k];
    }
    return LAC_OK;
}

lac_signal lac_diffused_at(const lac_diffused *diffused, double t)
{
    const double two_over_root_pi = 2.0 / sqrt(LAC_PI);
    lac_signal sum = {diffused->first, 0.0};
    for (size_t k = 0; k < diffused->n && diffused->t[k] < t; k++) {
        double tau = t - diffused->t[k];
        double x2 = diffused->time / tau;
        if (x2 > 700.0) {
            continue; // exp(-x^2) is nothing, and x^2 may be infinite
        }
        double x = sqrt(x2);
        double step = erfc(x);
        double ramp = tau * ((1.0 + 2.0 * x2) * step - two_over_root_pi * x * exp(-x2));
        sum.value += diffused->bend[k] * ramp;
        sum.rate += diffused->bend[k] * step;
    }
    return sum;
}

void lac_diffused_clear(lac_diffused *diffused)
{
    free(diffused->t);
    *diffused = (lac_diffused){0};
}
