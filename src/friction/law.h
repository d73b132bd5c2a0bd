/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"
#include "friction/friction.h"

// The friction laws that a case can name: a new one is one more line here.
// clang-format off
#define LAC_FRICTION_LAWS(_)    \
    _(lac_friction_aging),      \
    _(lac_friction_slip),       \
    _(lac_friction_weakening),  \
    _(lac_friction_composite)
// clang-format on

extern const lac_friction_law LAC_FRICTION_LAWS(LAC_ROW_ITSELF);

/// Steady state of a law that renews the contacts over dc: theta = dc/v.
double lac_law_steady_renewal(const lac_friction *friction, size_t cell, double u);

/// What is wrong with the common parameters taken together; NULL where nothing is.
const char *lac_law_validate(const void *params);

/// Turns friction_angle into f0, and fills in what a rock tells and the case does not name.
const char *lac_law_complete(void *params, uint64_t given);

/// Row of friction_angle in every law's table, as LAC_F0 to LAC_DC are those of f0 to dc.
enum { LAC_ROW_ANGLE = 10 };

/// Names of the rocks, in the order of lac_rock_get; NULL at the end.
extern const char *const lac_rock_names[];

/// Names of lac_friction_form, in its order.
extern const char *const lac_friction_form_names[];

// A thousandth of a proton [m], far below any contact: as far down as runs were measured to be
// right (docs/limits.md).
#define LAC_LEAST_DC 1e-18

// Steepest angle of friction [rad], as of slopes: beyond, its tangent is no coefficient.
#define LAC_STEEPEST 1.55

// Of the regularised form, which any law may have.
#define LAC_RICE_BEN_ZION \
    "Rice & Ben-Zion (1996) Proc. Natl. Acad. Sci. 93, 3811, doi 10.1073/pnas.93.9.3811"
#define LAC_LAPUSTA "Lapusta et al. (2000) J. Geophys. Res. 105, 23765, doi 10.1029/2000JB900250"

#define LAC_COMMON(name) offsetof(lac_friction_params, name)

// First rows of every law's parameter table, in the order of LAC_F0, LAC_A ...; rows of the law's
// own follow them. Offsets hold because every law's struct starts with lac_friction_params.
// clang-format off
#define LAC_FRICTION_COMMON_ROWS                                                                  \
    LAC_REAL("f0", "1", LAC_COMMON(f0), 0.6, 0, 1e3, LAC_CELLWISE,                                \
             "friction coefficient in steady sliding at v0"),                                     \
    LAC_REAL("a", "1", LAC_COMMON(a), NAN, 0, 1e3, LAC_CELLWISE,                                  \
             "direct effect: gain of friction per e-fold of slip rate, at once"),                 \
    LAC_REAL("b", "1", LAC_COMMON(b), NAN, 0, 1e3, LAC_CELLWISE,                                  \
             "evolution effect: gain of friction per e-fold of state; b > a weakens with rate"),  \
    LAC_REAL("dc", "m", LAC_COMMON(dc), NAN, LAC_LEAST_DC, INFINITY, LAC_CELLWISE,                \
             "slip over which the contacts, and with them the state, are renewed"),               \
    LAC_REAL("v0", "m/s", LAC_COMMON(v0), 1e-6, 0, INFINITY, LAC_CELLWISE | LAC_ABOVE_MIN,        \
             "reference slip rate, at which the steady coefficient is f0"),                       \
    LAC_CHOICE("form", LAC_COMMON(form), LAC_FORM_PLAIN, lac_friction_form_names, 0,              \
               "strength: logarithms as measured (plain), or finite at v = 0 (regularised)"),     \
    LAC_REAL("v1", "m/s", LAC_COMMON(v1), NAN, 0, INFINITY,                                       \
             LAC_CELLWISE | LAC_ABOVE_MIN | LAC_OPTIONAL,                                         \
             "cut-off of the direct effect: faster than v1 it adds no more; no cut-off if absent"), \
    LAC_REAL("v2", "m/s", LAC_COMMON(v2), NAN, 0, INFINITY,                                       \
             LAC_CELLWISE | LAC_ABOVE_MIN | LAC_OPTIONAL,                                         \
             "cut-off of the evolution effect: states younger than dc/v2 weaken no further; "     \
             "v2 < v1 turns weakening into strengthening at speed; no cut-off if absent"),        \
    LAC_REAL("alpha", "1", LAC_COMMON(alpha), NAN, 0, 1e3, LAC_CELLWISE | LAC_OPTIONAL,           \
             "state response to normal stress: friction lost per e-fold of effective normal "     \
             "pressure, at once (Linker & Dieterich 1992); none if absent"),                      \
    LAC_CHOICE("rock", LAC_COMMON(rock), NAN, lac_rock_names, LAC_OPTIONAL | LAC_TELLS,           \
               "gives those of f0, a, b and dc that its source states and the case does not name"), \
    LAC_REAL("friction_angle", "rad", LAC_COMMON(friction_angle), NAN, 0, LAC_STEEPEST,           \
             LAC_OPTIONAL, "f0 as the angle whose tangent it is"),                                \
    LAC_REAL("cohesion", "Pa", LAC_COMMON(cohesion), NAN, 0, 1e12, LAC_OPTIONAL,                  \
             "strength over the nominal area that no pressure changes, while cells slide forward; " \
             "none if absent"),                                                                    \
    LAC_REAL("flash_rate", "m/s", LAC_COMMON(flash_rate), NAN, 0, INFINITY,                       \
             LAC_CELLWISE | LAC_ABOVE_MIN | LAC_OPTIONAL,                                         \
             "v_w of flash heating, f_w + (f - f_w)/(1 + v/v_w): slip rate at which the contacts " \
             "are down to the mean of f and f_w; with inertia; none if absent"),                  \
    LAC_REAL("flash_friction", "1", LAC_COMMON(flash_friction), NAN, 0, 1e3,                      \
             LAC_CELLWISE | LAC_OPTIONAL,                                                         \
             "f_w of flash heating: coefficient of contacts that slide much faster than flash_rate")
// clang-format on
