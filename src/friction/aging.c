// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/clones.h"
#include "base/vmath.h"
#include "friction/law.h"

// g_u = -v/dc, g_w = -exp(-w), which stands in g
LAC_CLONES static void lac_aging_slopes(size_t n, const double *v, const double *inv_dc,
                                        const double *g, double *g_u, double *g_w)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        g_u[i] = -v[i] * inv_dc[i];
        g_w[i] = -g[i];
    }
}

LAC_CLONES static void lac_aging_renew(size_t n, const double *v, const double *inv_dc, double *g)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        g[i] -= v[i] * inv_dc[i];
    }
}

// dtheta/dt = 1 - v theta/dc, for w = ln theta:  g = exp(-w) - v/dc
static void evolve(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                   double *g_u, double *g_w)
{
    const double *inv_dc = lac_cellwise_from(&friction->inv_dc, cells->first);
    lac_vexp_minus(cells->n, cells->w, g);
    if (g_u != NULL) {
        lac_aging_slopes(cells->n, cells->v, inv_dc, g, g_u, g_w);
    }
    lac_aging_renew(cells->n, cells->v, inv_dc, g);
}

static const lac_param params[] = {LAC_FRICTION_COMMON_ROWS};

const lac_friction_law lac_friction_aging = {
    .about = {.name = "aging",
              .summary = "state grows with time at rest: dtheta/dt = 1 - v theta/dc",
              .reference =
                  "Dieterich (1979) J. Geophys. Res. 84, 2161, doi 10.1029/JB084iB05p02161; Ruina "
                  "(1983) J. Geophys. Res. 88, 10359, doi 10.1029/JB088iB12p10359; regularised: "
                  "Rice & Ben-Zion (1996) Proc. Natl. Acad. Sci. 93, 3811, doi "
                  "10.1073/pnas.93.9.3811; Lapusta et al. (2000) J. Geophys. Res. 105, 23765, doi "
                  "10.1029/2000JB900250",
              LAC_ROWS(params, lac_friction_params),
              .fault = lac_law_fault},
    .evolve = evolve,
    .steady_state = lac_law_steady_renewal,
};
