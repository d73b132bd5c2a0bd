// SPDX-License-Identifier: GPL-3.0-or-later
// Ruina's slip law: contacts change only while they slip, so that nothing heals at rest. And that
// law without its healing: strength that slip has taken never comes back.
#include "base/phi.h"
#include "friction/law.h"

// dtheta/dt = -(v theta/dc) ln(v theta/dc), for w = ln theta:  g = -(v/dc) (u + w - ln dc)
static void evolve(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                   double *g_u, double *g_w)
{
    size_t n = cells->n;
    const double *u = cells->u, *w = cells->w, *v = cells->v;
    const double *inv_dc = lac_cellwise_from(&friction->inv_dc, cells->first);
    const double *ln_dc = lac_cellwise_from(&friction->ln_dc, cells->first);
    for (size_t i = 0; i < n; i++) {
        g[i] = -v[i] * inv_dc[i] * (u[i] + w[i] - ln_dc[i]);
    }
    if (g_u != NULL) {
        for (size_t i = 0; i < n; i++) {
            g_w[i] = -v[i] * inv_dc[i];
            g_u[i] = g[i] + g_w[i];
        }
    }
}

static double change(double u, double w, double ln_dc, double renewal)
{
    return -renewal * (u + w - ln_dc);
}

// What a bend of ln v over a step of slip z dc leaves in O at its end, and its derivative:
// (2 - 2 phi - z phi)/z = z/6 - z^2/12 ... of it.
static double left_of_bend(double z, double phi, double slope, double *derivative)
{
    if (z < 1e-3) {
        *derivative = (1.0 - z) / 6.0;
        return (1.0 - 0.5 * z) * z / 6.0;
    }
    double left = (2.0 - 2.0 * phi - z * phi) / z;
    *derivative = -(2.0 * slope + phi + z * slope + left) / z;
    return left;
}

// With O = u + w - ln dc, O1 = O0 e^-z + rho phi(z) - late (1 - e^-z) + bend (2 - 2 phi - z phi)/z,
// late what of `uneven` is not of the bend.
static void step(const lac_lone_step *s, double *w, double *dw)
{
    double em = expm1(-s->z);
    double phi = lac_phi(s->z, em);
    double slope = lac_phi_slope(s->z, em, phi);
    double dleft;
    double left = left_of_bend(s->z, phi, slope, &dleft);
    double late = s->uneven + s->bend / 6.0;
    double before = s->u + s->w - s->ln_dc;
    double after = before * (1.0 + em) + s->rho * phi + late * em + s->bend * left;
    *w = after - (s->u + s->rho) + s->ln_dc;
    *dw = ((s->rho * slope + s->bend * dleft) - (before + late) * (1.0 + em)) * s->dz + phi - 1.0;
}

static const lac_friction_lone lone = {.change = change, .step = step};

static const lac_param params[] = {LAC_FRICTION_COMMON_ROWS};

const lac_friction_law lac_friction_slip = {
    .info =
        LAC_ABOUT("slip", "state changes only with slip: dtheta/dt = -(v theta/dc) ln(v theta/dc)",
                  "Ruina (1983) J. Geophys. Res. 88, 10359, doi 10.1029/JB088iB12p10359; "
                  "regularised: " LAC_RICE_BEN_ZION "; " LAC_LAPUSTA,
                  LAC_ROWS(params, lac_friction_params), .validate = lac_law_validate,
                  .complete = lac_law_complete),
    .evolve = evolve,
    .steady_state = lac_law_steady_renewal,
    .lone = &lone,
};

// The slip law above steady state, phi = u + w - ln dc > 0, nothing below it.
static void evolve_above(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                         double *g_u, double *g_w)
{
    const double *ln_dc = lac_cellwise_from(&friction->ln_dc, cells->first);
    evolve(friction, cells, g, g_u, g_w);
    for (size_t i = 0; i < cells->n; i++) {
        bool weakens = cells->u[i] + cells->w[i] > ln_dc[i];
        g[i] = weakens ? g[i] : 0;
        if (g_u != NULL) {
            g_u[i] = weakens ? g_u[i] : 0;
            g_w[i] = weakens ? g_w[i] : 0;
        }
    }
}

const lac_friction_law lac_friction_weakening = {
    .info = LAC_ABOUT("weakening",
                      "as slip where v theta > dc, and no change where not: strength that slip "
                      "takes never comes back",
                      "docs/theory/bridge.md", LAC_ROWS(params, lac_friction_params),
                      .validate = lac_law_validate, .complete = lac_law_complete),
    .evolve = evolve_above,
    .steady_state = lac_law_steady_renewal,
};
