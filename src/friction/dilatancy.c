// SPDX-License-Identifier: GPL-3.0-or-later
// Gouge that dilates as it slides faster and sucks its pore water thin, until water flows in.
#include "base/units.h"
#include "friction/weakening.h"

typedef struct dilatancy_params {
    double dilatancy, compressibility, drainage_time;
} dilatancy_params;

static void modes(const void *params, lac_weakening_modes *modes)
{
    const dilatancy_params *p = params;
    *modes = (lac_weakening_modes){
        .n = 1, .decay = {1 / p->drainage_time}, .gain = {p->dilatancy / p->compressibility}};
}

// Porosity phi = phi0 - eps ln(v0 theta/dc), so that for the pore pressure x in excess
//   dx/dt = -x/t_d - (1/beta) dphi/dt = -x/t_d + (eps/beta) d ln theta/dt
static void source(const void *params, const lac_weakening_cells *c,
                   const lac_weakening_sources *out)
{
    (void)params;
    memcpy(out->s, c->g, c->n * sizeof *out->s);
    if (out->s_u != NULL) {
        memcpy(out->s_u, c->g_u, c->n * sizeof *out->s);
        memcpy(out->s_w, c->g_w, c->n * sizeof *out->s);
        memset(out->s_normal, 0, c->n * sizeof *out->s);
        memset(out->s_cohesion, 0, c->n * sizeof *out->s);
    }
}

static void words(const void *params, const lac_weakening_joint *joint, char *text, size_t size)
{
    const dilatancy_params *p = params;
    char sucked[60], drives[60], drained[60];
    (void)snprintf(text, size,
                   "Dilatancy holds back f0 epsilon/beta = %s per e-fold of slip rate, against the "
                   "(b - a) p = %s that weakening gives, in whatever is faster than %s; what is "
                   "slower drains.",
                   lac_units_format(joint->f0 * p->dilatancy / p->compressibility, "Pa", sucked,
                                    sizeof sucked),
                   lac_units_format(joint->excess * joint->normal, "Pa", drives, sizeof drives),
                   lac_units_format(p->drainage_time, "s", drained, sizeof drained));
}

#define AT(name) offsetof(dilatancy_params, name)

static const lac_param params[] = {
    LAC_REAL("dilatancy", "1", AT(dilatancy), NAN, 0, 1, 0,
             "epsilon: porosity gained per e-fold of slip rate in steady sliding; about 1e-4 of "
             "gouges"),
    LAC_REAL("compressibility", "1/Pa", AT(compressibility), NAN, 0, 1, LAC_ABOVE_MIN,
             "beta: of the pores and their water, porosity gained per pascal; about 1e-11 to 1e-9 "
             "per Pa"),
    LAC_REAL("drainage_time", "s", AT(drainage_time), NAN, 1e-9, 1e18, 0,
             "t_d: in which the excess falls by an e-fold as water flows in or out"),
};

const lac_weakening_kind lac_weakening_dilatancy = {
    .info = LAC_ABOUT("dilatancy",
                      "pore pressure that falls as gouge dilates with slip rate: dp/dt = -p/t_d + "
                      "(epsilon/beta) d ln(theta)/dt",
                      "Segall & Rice (1995) J. Geophys. Res. 100, 22155, doi 10.1029/95JB02403; "
                      "docs/theory/weakening.md",
                      LAC_ROWS(params, dilatancy_params)),
    .pore = true,
    .modes = modes,
    .source = source,
    .words = words,
};
