// SPDX-License-Identifier: GPL-3.0-or-later
// What `describe` says of the choices that are no models of their own. The keys that choose them
// are rows of the sections solver, rg and material.
#include "case/sections.h"

#define CVODES                                                                              \
    "Hindmarsh et al. (2005) ACM Trans. Math. Softw. 31, 363, doi 10.1145/1089014.1089020 " \
    "(CVODES)"
#define PAPER "Borri-Brunetto, Carpinteri & Chiaia (2004) Rock Mech. Rock Eng. 37, 117"

static const lac_model_info momenta[] = {
    {.name = "radiation-damping",
     .summary = "waves that leave a sliding cell take eta v off its traction, eta = G/(2 cs); with "
                "shear_modulus and a shear speed, given or from the density",
     .reference = "Rice (1993) J. Geophys. Res. 98, 9885, doi 10.1029/93JB00191",
     .params = &lac_material_rows[LAC_MATERIAL_SHEAR_SPEED],
     .param_count = 2},
    {.name = "block-inertia",
     .summary = "the mass of the block that slides, which what is out of balance accelerates; with "
                "the section inertia",
     .reference = "Rice & Ruina (1983) J. Appl. Mech. 50, 343, doi 10.1115/1.3167042; "
                  "docs/theory/momentum.md, eq. 1",
     .params = lac_inertia_rows,
     .param_count = LAC_INERTIA_ROWS},
};

static const lac_model_info fidelities[] = {
    {.name = "ode",
     .summary =
         "all cells at every step: cells that hold each other, and what events are judged by",
     .reference = "docs/theory/creep.md, eq. 2-5"},
    {.name = "events",
     .summary = "each cell at steps of its own: cells that slip one by one (k_0 < k_crit) on the "
                "hierarchy, under loads that are linear between jumps",
     .reference = "docs/theory/fidelity-events.md; Richards-Dinger & Dieterich (2012) Seismol. "
                  "Res. Lett. 83, 983, doi 10.1785/0220120105 (RSQSim)"},
    {.name = "static",
     .summary = "no time: the cascade of slip over the blocks, by lacuna rg",
     .reference = PAPER "; docs/theory/rg.md"},
};

static const lac_model_info methods[] = {
    {.name = "bdf",
     .summary = "implicit backward differences of order 1 to 5: stiff problems, the long creep",
     .reference = CVODES "; docs/theory/creep.md, eq. 5"},
    {.name = "adams",
     .summary =
         "Adams-Moulton of order 1 to 12 by fixed-point iteration: problems that are not stiff",
     .reference = CVODES},
    {.name = "erk",
     .summary = "explicit Runge-Kutta of order 2 to 8, Cash-Karp 5(4) by default: earthquake "
                "cycles without stiff ties",
     .reference = "Reynolds et al. (2023) ACM Trans. Math. Softw. 49, 19, doi 10.1145/3594632 "
                  "(ARKODE); Cash & Karp (1990) ACM Trans. Math. Softw. 16, 201"},
};

static const lac_model_info formulations[] = {
    {.name = "rate",
     .summary = "ln v: the balance of traction differentiated in time; slip that does not reverse",
     .reference = "docs/theory/creep.md, eq. 2-3"},
    {.name = "traction",
     .summary = "tau: the rate follows from the strength cell by cell; slip may reverse",
     .reference = "docs/theory/creep.md, eq. 6"},
    {.name = "slip",
     .summary = "slip: the balance of traction holds to rounding; slip may reverse",
     .reference = "docs/theory/creep.md, eq. 7"},
    {.name = "inertia",
     .summary = "slip and its rate: momentum in the place of the balance; with the section inertia",
     .reference = "docs/theory/momentum.md, eq. 1-2"},
};

static const lac_model_info rules[] = {
    {.name = "fix",
     .summary = "the drop of its strength, (1 - beta) f p, as the paper has it",
     .reference = PAPER "; docs/theory/rg.md, eq. 1"},
    {.name = "cons",
     .summary = "all above its residual strength beta f p: no force is made or lost",
     .reference = "docs/theory/rg.md, eq. 2"},
    {.name = "lump",
     .summary = "the drop of its strength, as a point with the sums of its cells",
     .reference = "Smalley, Turcotte & Solla (1985) J. Geophys. Res. 90, 1894, doi "
                  "10.1029/JB090iB02p01894; docs/theory/rg.md, \"Pass\""},
};

LAC_ROWS_AT(lac_model_info, lac_momentum_get, momenta)
LAC_ROWS_AT(lac_model_info, lac_fidelity_get, fidelities)
LAC_ROWS_AT(lac_model_info, lac_method_get, methods)
LAC_ROWS_AT(lac_model_info, lac_formulation_get, formulations)
LAC_ROWS_AT(lac_model_info, lac_rule_get, rules)
