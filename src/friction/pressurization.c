// SPDX-License-Identifier: GPL-3.0-or-later
// Pore water of a sheared layer that slip heats: it expands, and heat and water diffuse away.
#include "base/units.h"
#include "friction/weakening.h"

typedef struct pressurization_params {
    double thickness, heat_capacity, pressurization, thermal, hydraulic;
} pressurization_params;

// Wave numbers l = e^(x)/s of the distance from the layer's middle, x at even steps: of the layer's
// own thickness, s sqrt(2 pi), to 1e4 of it.
enum { WAVES = 24 };
#define STEP 0.5
#define SHORTEST 6.4

// With a Gaussian layer of standard deviation s = h/sqrt(2 pi), so that its middle has 1/h, heat
// and water follow across it
//   T_t = alpha_th T_yy + (tau v/rho c) G(y),   p_t = alpha_hy p_yy + Lambda T_t
// whose Fourier transforms along y are, each wave number by itself,
//   T_l' = -alpha_th l^2 T_l + (tau v/rho c) e^(-l^2 s^2/2)
//   p_l = A_l + B T_l,  A_l' = -alpha_hy l^2 A_l + (Lambda - B)(tau v/rho c) e^(-l^2 s^2/2)
// with B = -Lambda alpha_th/(alpha_hy - alpha_th). In the middle p = (1/pi) sum of p_l l STEP,
// the trapezoidal rule in x; what is longer than the longest wave counts to it. The sum is scaled
// to be 1/h of the heat where none leaves, from which it is 2e-5 off.
static void modes(const void *params, lac_weakening_modes *modes)
{
    const pressurization_params *p = params;
    const double s = p->thickness / sqrt(2 * M_PI);
    const double b = -p->pressurization * p->thermal / (p->hydraulic - p->thermal);
    *modes = (lac_weakening_modes){.n = 2 * WAVES};
    double whole = 0, part[WAVES];
    for (size_t j = 0; j < WAVES; j++) {
        const double x = SHORTEST * exp(-STEP * (double)j);
        part[j] = x * exp(-0.5 * x * x) * (j + 1 == WAVES ? 1 + 1 / expm1(STEP) : 1);
        whole += part[j];
    }
    for (size_t j = 0; j < WAVES; j++) {
        const double x = SHORTEST * exp(-STEP * (double)j), l = x / s;
        const double weight = part[j] / whole / (p->thickness * p->heat_capacity);
        modes->decay[j] = p->hydraulic * l * l;
        modes->gain[j] = (p->pressurization - b) * weight;
        modes->decay[WAVES + j] = p->thermal * l * l;
        modes->gain[WAVES + j] = b * weight;
        modes->heat[WAVES + j] = 1 / b;
    }
}

// S = tau v, tau = sigma f
static void source(const void *params, const lac_weakening_cells *c,
                   const lac_weakening_sources *out)
{
    (void)params;
    for (size_t i = 0; i < c->n; i++) {
        double sigma = c->normal[i], v = c->v[i];
        out->s[i] = sigma * c->f[i] * v;
        if (out->s_u != NULL) {
            out->s_u[i] = sigma * v * (c->f[i] + c->f_u[i]);
            out->s_w[i] = sigma * v * c->f_w[i];
            out->s_normal[i] = c->f[i] * v;
            out->s_cohesion[i] = 0;
        }
    }
}

static void words(const void *params, const lac_weakening_joint *joint, char *text, size_t size)
{
    const pressurization_params *p = params;
    char slip[60];
    (void)snprintf(
        text, size,
        "Where neither heat nor water leaves the layer, each %s of slip takes an e-fold "
        "off the strength, rho c h/(f0 Lambda).",
        lac_units_format(p->heat_capacity * p->thickness / (joint->f0 * p->pressurization), "m",
                         slip, sizeof slip));
}

static const char *validate(const void *params)
{
    const pressurization_params *p = params;
    return fabs(p->hydraulic / p->thermal - 1) < 0.01
               ? "thermal_diffusivity and hydraulic_diffusivity must differ by 1 % or more"
               : NULL;
}

#define AT(name) offsetof(pressurization_params, name)

static const lac_param params[] = {
    LAC_REAL("thickness", "m", AT(thickness), NAN, 1e-9, 1e3, 0,
             "h: of the layer that is sheared, over which slip spreads its heat"),
    LAC_REAL("heat_capacity", "J/m3/K", AT(heat_capacity), 2.7e6, 0, 1e9, LAC_ABOVE_MIN,
             "rho c: of the wet layer, per volume"),
    LAC_REAL("pressurization", "Pa/K", AT(pressurization), NAN, 0, 1e9, LAC_ABOVE_MIN,
             "Lambda: pore pressure gained per kelvin where no water leaves; 0.1 to 1 MPa/K"),
    LAC_REAL("thermal_diffusivity", "m2/s", AT(thermal), 1e-6, 0, 1, LAC_ABOVE_MIN,
             "alpha_th: of heat, across the layer and beyond"),
    LAC_REAL("hydraulic_diffusivity", "m2/s", AT(hydraulic), NAN, 0, 1e3, LAC_ABOVE_MIN,
             "alpha_hy: of pore pressure, across the layer and beyond"),
};

const lac_weakening_kind lac_weakening_pressurization = {
    .info =
        LAC_ABOUT("thermal-pressurization",
                  "pore water that frictional heat expands, as heat and water diffuse away from "
                  "the sheared layer: rho c dT/dt = tau v/h + ..., dp/dt = Lambda dT/dt + ...",
                  "Rice (2006) J. Geophys. Res. 111, B05311, doi 10.1029/2005JB004006; Noda & "
                  "Lapusta (2010) J. Geophys. Res. 115, B12314, doi 10.1029/2010JB007780; "
                  "docs/theory/weakening.md",
                  LAC_ROWS(params, pressurization_params), .validate = validate),
    .pore = true,
    .warm = true,
    .modes = modes,
    .source = source,
    .words = words,
};
