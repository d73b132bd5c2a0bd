// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdbool.h>

#include "friction/law.h"

// The slip law above steady state, nothing below it: with phi = u + w - ln dc,
// g = -(v/dc) max(phi, 0).
static void evolve(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                   double *g_u, double *g_w)
{
    size_t n = cells->n;
    const double *u = cells->u;
    const double *w = cells->w;
    const double *v = cells->v;
    const double *inv_dc = friction->inv_dc + cells->first;
    const double *ln_dc = friction->ln_dc + cells->first;
    for (size_t i = 0; i < n; i++) {
        g[i] = -v[i] * inv_dc[i] * fmax(u[i] + w[i] - ln_dc[i], 0);
    }
    if (g_u != NULL) {
        for (size_t i = 0; i < n; i++) {
            bool weakens = u[i] + w[i] > ln_dc[i];
            g_w[i] = weakens ? -v[i] * inv_dc[i] : 0;
            g_u[i] = g[i] + g_w[i];
        }
    }
}

static double steady_state(const lac_friction *friction, size_t cell, double u)
{
    return friction->ln_dc[cell] - u;
}

static const lac_param params[] = {LAC_FRICTION_COMMON_ROWS};

const lac_friction_law lac_friction_weakening = {
    .about = {.name = "weakening",
              .summary = "as slip where v theta > dc, and no change where not: strength that slip "
                         "takes never comes back",
              .reference = "docs/theory/bridge.md",
              .params = params,
              .param_count = sizeof params / sizeof params[0],
              .params_size = sizeof(lac_friction_params)},
    .evolve = evolve,
    .steady_state = steady_state,
};
