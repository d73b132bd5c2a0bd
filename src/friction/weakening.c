// SPDX-License-Identifier: GPL-3.0-or-later
// The slip law without its healing: strength that slip has taken never comes back.
#include <stdbool.h>

#include "friction/law.h"

// The slip law above steady state, phi = u + w - ln dc > 0, nothing below it.
static void evolve(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                   double *g_u, double *g_w)
{
    const double *ln_dc = lac_cellwise_from(&friction->ln_dc, cells->first);
    lac_friction_slip.evolve(friction, cells, g, g_u, g_w);
    for (size_t i = 0; i < cells->n; i++) {
        bool weakens = cells->u[i] + cells->w[i] > ln_dc[i];
        g[i] = weakens ? g[i] : 0;
        if (g_u != NULL) {
            g_u[i] = weakens ? g_u[i] : 0;
            g_w[i] = weakens ? g_w[i] : 0;
        }
    }
}

static const lac_param params[] = {LAC_FRICTION_COMMON_ROWS};

const lac_friction_law lac_friction_weakening = {
    .info = LAC_ABOUT("weakening",
                      "as slip where v theta > dc, and no change where not: strength that slip "
                      "takes never comes back",
                      "docs/theory/bridge.md", LAC_ROWS(params, lac_friction_params),
                      .validate = lac_law_validate),
    .evolve = evolve,
    .steady_state = lac_law_steady_renewal,
};
