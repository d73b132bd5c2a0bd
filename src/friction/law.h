/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FRICTION_LAW_H
#define LACUNA_FRICTION_LAW_H

#include <math.h>
#include <stddef.h>

#include "lacuna/friction.h"

extern const lac_friction_law lac_friction_aging, lac_friction_slip, lac_friction_weakening,
    lac_friction_composite;

/// Steady state of a law that renews the contacts over dc: theta = dc/v.
double lac_law_steady_renewal(const lac_friction *friction, size_t cell, double u);

/// What is wrong with the common parameters taken together; NULL where nothing is.
const char *lac_law_fault(const void *params);

/// Names of lac_friction_form, in its order.
extern const char *const lac_friction_form_names[];

// A thousandth of a proton [m], far below any contact: as far down as runs were measured to be
// right (docs/limits.md).
#define LAC_LEAST_DC 1e-18

// First rows of every law's parameter table, in the order of LAC_F0, LAC_A ...; rows of the law's
// own follow them. Offsets hold because every law's struct starts with lac_friction_params.
// clang-format off
#define LAC_FRICTION_COMMON_ROWS                                                                  \
    {.key = "f0", .unit = "1", .fallback = 0.6, .min = 0, .max = 1e3,                             \
     .offset = offsetof(lac_friction_params, f0), .flags = LAC_CELLWISE,                          \
     .doc = "friction coefficient in steady sliding at v0"},                                      \
    {.key = "a", .unit = "1", .fallback = NAN, .min = 0, .max = 1e3,                              \
     .offset = offsetof(lac_friction_params, a), .flags = LAC_CELLWISE,                           \
     .doc = "direct effect: gain of friction per e-fold of slip rate, at once"},                  \
    {.key = "b", .unit = "1", .fallback = NAN, .min = 0, .max = 1e3,                              \
     .offset = offsetof(lac_friction_params, b), .flags = LAC_CELLWISE,                           \
     .doc = "evolution effect: gain of friction per e-fold of state; b > a weakens with rate"},   \
    {.key = "dc", .unit = "m", .fallback = NAN, .min = LAC_LEAST_DC, .max = INFINITY,             \
     .offset = offsetof(lac_friction_params, dc), .flags = LAC_CELLWISE,                          \
     .doc = "slip over which the contacts, and with them the state, are renewed"},                \
    {.key = "v0", .unit = "m/s", .fallback = 1e-6, .min = 0, .max = INFINITY,                     \
     .offset = offsetof(lac_friction_params, v0), .flags = LAC_CELLWISE | LAC_ABOVE_MIN,          \
     .doc = "reference slip rate, at which the steady coefficient is f0"},                        \
    {.key = "form", .unit = "1", .fallback = LAC_FORM_PLAIN, .min = 0, .max = 1,                  \
     .offset = offsetof(lac_friction_params, form), .type = LAC_CHOICE,                           \
     .choices = lac_friction_form_names,                                                          \
     .doc = "strength: logarithms as measured (plain), or finite at v = 0 (regularised)"},        \
    {.key = "v1", .unit = "m/s", .fallback = NAN, .min = 0, .max = INFINITY,                      \
     .offset = offsetof(lac_friction_params, v1),                                                 \
     .flags = LAC_CELLWISE | LAC_ABOVE_MIN | LAC_OPTIONAL,                                        \
     .doc = "cut-off of the direct effect: faster than v1 it adds no more; no cut-off if absent"}, \
    {.key = "v2", .unit = "m/s", .fallback = NAN, .min = 0, .max = INFINITY,                      \
     .offset = offsetof(lac_friction_params, v2),                                                 \
     .flags = LAC_CELLWISE | LAC_ABOVE_MIN | LAC_OPTIONAL,                                        \
     .doc = "cut-off of the evolution effect: states younger than dc/v2 weaken no further; "      \
            "v2 < v1 turns weakening into strengthening at speed; no cut-off if absent"},         \
    {.key = "alpha", .unit = "1", .fallback = NAN, .min = 0, .max = 1e3,                          \
     .offset = offsetof(lac_friction_params, alpha), .flags = LAC_CELLWISE | LAC_OPTIONAL,        \
     .doc = "state response to normal stress: friction lost per e-fold of effective normal "      \
            "pressure, at once (Linker & Dieterich 1992); none if absent"}
// clang-format on

#endif
