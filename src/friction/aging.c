// SPDX-License-Identifier: GPL-3.0-or-later
// Dieterich's aging law: contacts grow old also at rest.
#include "base/clones.h"
#include "base/phi.h"
#include "base/vmath.h"
#include "base/vmath_kernels.h"
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

// g where no exponential leaves the normal numbers; how many do.
LAC_CLONES static uint64_t lac_aging_rates(size_t n, const double *v, const double *w,
                                           const double *inv_dc, double *g)
{
    uint64_t far = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        far += fabs(w[i]) < 700 ? 0 : 1;
        g[i] = lac_exp_normal(-w[i]) - v[i] * inv_dc[i];
    }
    return far;
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
    if (g_u == NULL && lac_aging_rates(cells->n, cells->v, cells->w, inv_dc, g) == 0) {
        return;
    }
    lac_vexp_minus(cells->n, cells->w, g);
    if (g_u != NULL) {
        lac_aging_slopes(cells->n, cells->v, inv_dc, g, g_u, g_w);
    }
    lac_aging_renew(cells->n, cells->v, inv_dc, g);
}

static double change(double u, double w, double ln_dc, double renewal)
{
    (void)u;
    (void)ln_dc;
    return exp(-w) - renewal;
}

// theta1 = e^-z theta0 + h E/phi(rho), E = (e^-z - e^-rho)/(rho - z).
static void step(const lac_lone_step *s, double *w, double *dw)
{
    double e = 1.0 + s->em;
    double g = -lac_phi_slope(s->rho, e - 1.0, s->phi) / s->phi; // d ln(1/phi)/drho
    double ez = exp(-s->z);
    double d = s->rho - s->z;
    double mean, dmean;
    if (fabs(d) < 1e-4) {
        mean = ez * (1.0 - d * (0.5 - d / 6.0));
        dmean = -s->dz * mean + ez * (-0.5 + d / 3.0) * (1.0 - s->dz);
    } else {
        mean = (ez - e) / d;
        dmean = ((e - s->dz * ez) - mean * (1.0 - s->dz)) / d;
    }
    double old = exp(s->w) * ez;
    double theta = old + s->length * mean / s->phi;
    *w = log(theta);
    *dw = (-s->dz * old + s->length * (dmean + mean * g) / s->phi) / theta;
}

static const lac_friction_lone lone = {.change = change, .step = step};

static const lac_param params[] = {LAC_FRICTION_COMMON_ROWS};

const lac_friction_law lac_friction_aging = {
    .info = LAC_ABOUT(
        "aging", "state grows with time at rest: dtheta/dt = 1 - v theta/dc",
        "Dieterich (1979) J. Geophys. Res. 84, 2161, doi 10.1029/JB084iB05p02161; Ruina (1983) J. "
        "Geophys. Res. 88, 10359, doi 10.1029/JB088iB12p10359; regularised: " LAC_RICE_BEN_ZION
        "; " LAC_LAPUSTA,
        LAC_ROWS(params, lac_friction_params), .validate = lac_law_validate,
        .complete = lac_law_complete),
    .evolve = evolve,
    .steady_state = lac_law_steady_renewal,
    .lone = &lone,
    .block_form = true,
};
