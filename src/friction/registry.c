// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the laws that a case can name, and of what any law can have besides, by the
// parameters that every law shares.
#include "friction/law.h"

static const lac_friction_law *const laws[] = {LAC_FRICTION_LAWS(LAC_ROW_ADDRESS)};

LAC_KINDS_AT(lac_friction_law, lac_friction_law_get, laws)

static const lac_param rows[] = {LAC_FRICTION_COMMON_ROWS};

// Their places in the rows.
enum { FORM = 5, V1, V2, ALPHA, ROCK, ANGLE, COHESION, FLASH_RATE };

static const lac_model_info options[] = {
    LAC_ABOUT("regularised",
              "strength a asinh(...) that vanishes at rest and lets slip reverse, instead of the "
              "plain logarithm: form",
              LAC_RICE_BEN_ZION "; " LAC_LAPUSTA "; docs/theory/friction.md, \"Strength\"",
              .params = &rows[FORM], .param_count = 1),
    LAC_ABOUT("cut-off",
              "slip rates beyond which the direct effect (v1) and the evolution effect (v2) end: "
              "v/(1 + v/v1) stands in the place of v, theta + dc/v2 in that of theta",
              "Dieterich (1979) J. Geophys. Res. 84, 2161, doi 10.1029/JB084iB05p02161; Okubo "
              "(1989) J. Geophys. Res. 94, 12321, doi 10.1029/JB094iB09p12321; "
              "docs/theory/friction.md, \"Cut-off slip rates\"",
              .params = &rows[V1], .param_count = 2),
    LAC_ABOUT("normal-stress", "state that answers to the effective normal pressure at once: alpha",
              "Linker & Dieterich (1992) J. Geophys. Res. 97, 4923, doi 10.1029/92JB00017; "
              "docs/theory/friction.md, \"Normal stress\"",
              .params = &rows[ALPHA], .param_count = 1),
    LAC_ABOUT("rock",
              "numbers taken from a rock, where a source states them, and f0 as an angle: rock, "
              "friction_angle",
              "docs/rocks.md", .params = &rows[ROCK], .param_count = 2),
    LAC_ABOUT("cohesion",
              "strength over the nominal area that no pressure changes, of what slides forward: "
              "cohesion",
              "Coulomb's law; docs/theory/friction.md, \"Cohesion\"", .params = &rows[COHESION],
              .param_count = 1),
    LAC_ABOUT("flash",
              "contacts that melt or decay as they slide fast: friction falls to f_w beyond v_w, "
              "f_w + (f - f_w)/(1 + v/v_w): flash_rate, flash_friction",
              "Rice (2006) J. Geophys. Res. 111, B05311, doi 10.1029/2005JB004006; "
              "docs/theory/friction.md, \"Flash heating\"",
              .params = &rows[FLASH_RATE], .param_count = 2),
};

LAC_ROWS_AT(lac_model_info, lac_friction_option_get, options)
