// SPDX-License-Identifier: GPL-3.0-or-later
// Bridges of rock that break under the stress that they help to carry, by which cohesion is lost.
#include "base/units.h"
#include "friction/weakening.h"

typedef struct bridges_params {
    double rate, stress, exponent;
} bridges_params;

static void modes(const void *params, lac_weakening_modes *modes)
{
    (void)params;
    *modes = (lac_weakening_modes){.n = 1, .gain = {1}};
}

// dD/dt = A (tau/tau_c)^n, tau = sigma f + C (1 - D) what the cell carries over the nominal area:
// Charles' law of subcritical crack growth for the part D of the bridges that is broken. At a
// constant tau they last (tau_c/tau)^n/A.
static void source(const void *params, const lac_weakening_cells *c,
                   const lac_weakening_sources *out)
{
    const bridges_params *p = params;
    for (size_t i = 0; i < c->n; i++) {
        double tau = c->normal[i] * c->f[i] + c->cohesion[i];
        tau = tau > 0 ? tau : 0;
        out->s[i] = p->rate * pow(tau / p->stress, p->exponent);
        if (out->s_u != NULL) {
            double by_tau = tau > 0 ? p->exponent * out->s[i] / tau : 0;
            out->s_u[i] = by_tau * c->normal[i] * c->f_u[i];
            out->s_w[i] = by_tau * c->normal[i] * c->f_w[i];
            out->s_normal[i] = by_tau * c->f[i];
            out->s_cohesion[i] = by_tau;
        }
    }
}

static void words(const void *params, const lac_weakening_joint *joint, char *text, size_t size)
{
    const bridges_params *p = params;
    const double tau = joint->f0 * joint->normal + joint->cohesion;
    char carried[60], lasting[60];
    (void)snprintf(
        text, size,
        "Its bridges last %s under the shear stress that they carry with f0, %s: the "
        "less of it, the longer, by the power %g.",
        lac_units_format(pow(p->stress / tau, p->exponent) / p->rate, "s", lasting, sizeof lasting),
        lac_units_format(tau, "Pa", carried, sizeof carried), p->exponent);
}

#define AT(name) offsetof(bridges_params, name)

static const lac_param params[] = {
    LAC_REAL("rate", "1/s", AT(rate), NAN, 0, 1e9, LAC_ABOVE_MIN,
             "A: part of the bridges that breaks in a second under the shear stress `stress`"),
    LAC_REAL("stress", "Pa", AT(stress), NAN, 0, 1e15, LAC_ABOVE_MIN,
             "tau_c: shear stress over the nominal area at which the bridges break at the rate "
             "`rate`"),
    LAC_REAL("exponent", "1", AT(exponent), NAN, 0, 200, 0,
             "n: how much faster they break under more stress, as the index of subcritical crack "
             "growth; 20 to 50 of rock"),
};

const lac_weakening_kind lac_weakening_bridges = {
    .info = LAC_ABOUT("bridges",
                      "the cohesion of rock bridges that break: C (1 - D), dD/dt = A (tau/tau_c)^n",
                      "Charles (1958) J. Appl. Phys. 29, 1554, doi 10.1063/1.1722992; Atkinson "
                      "(1984) J. Geophys. Res. 89, 4077, doi 10.1029/JB089iB06p04077; "
                      "docs/theory/weakening.md",
                      LAC_ROWS(params, bridges_params)),
    .modes = modes,
    .source = source,
    .words = words,
};
