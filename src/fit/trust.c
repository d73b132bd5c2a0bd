// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a fit is to be relied on.
#include <math.h>
#include <stdio.h>

#include "fit/fit.h"

// The unknown with the largest R-hat, and the parameter most correlated with it; itself if none is.
static void find_worst(const lac_fit_result *r, size_t *worst, size_t *partner)
{
    *worst = 0;
    for (size_t k = 1; k < r->unknowns; k++) {
        *worst = r->unknown[k].converged.rhat > r->unknown[*worst].converged.rhat ? k : *worst;
    }
    *partner = *worst;
    double most = 0.0;
    for (size_t k = 0; *worst < r->parameters && k < r->parameters; k++) {
        double c = fabs(r->correlation[*worst][k]);
        if (k != *worst && c > most) {
            most = c;
            *partner = k;
        }
    }
}

lac_status lac_fit_trust(const lac_fit_result *r, lac_error *err)
{
    size_t worst, partner;
    char with[200] = "";
    if (!r->sampled || r->converged) {
        return LAC_OK;
    }
    find_worst(r, &worst, &partner);
    if (partner != worst) {
        (void)snprintf(with, sizeof with, ", whose correlation with %s is %.3f",
                       r->unknown[partner].key, r->correlation[worst][partner]);
    }
    return lac_fail(
        err, LAC_ENUMERIC,
        "the sampler has not converged: R-hat %.2f (wanted: below %.2f) of %s%s; its intervals are "
        "not to be relied on: take more fit.rounds, or hold what trades off",
        r->unknown[worst].converged.rhat, LAC_FIT_RHAT, r->unknown[worst].key, with);
}
