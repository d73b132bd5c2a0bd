/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_FRICTION_LAW_H
#define LACUNA_FRICTION_LAW_H

#include <math.h>
#include <stddef.h>

#include "lacuna/friction.h"

extern const lac_friction_law lac_friction_aging, lac_friction_slip, lac_friction_weakening;

/// Names of lac_friction_form, in its order.
extern const char *const lac_friction_form_names[];

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
    {.key = "dc", .unit = "m", .fallback = NAN, .min = 0, .max = INFINITY,                        \
     .offset = offsetof(lac_friction_params, dc), .flags = LAC_CELLWISE | LAC_ABOVE_MIN,          \
     .doc = "slip over which the contacts, and with them the state, are renewed"},                \
    {.key = "v0", .unit = "m/s", .fallback = 1e-6, .min = 0, .max = INFINITY,                     \
     .offset = offsetof(lac_friction_params, v0), .flags = LAC_CELLWISE | LAC_ABOVE_MIN,          \
     .doc = "reference slip rate, at which the steady coefficient is f0"},                        \
    {.key = "form", .unit = "1", .fallback = LAC_FORM_PLAIN, .min = 0, .max = 1,                  \
     .offset = offsetof(lac_friction_params, form), .type = LAC_CHOICE,                           \
     .choices = lac_friction_form_names,                                                          \
     .doc = "strength: logarithms as measured (plain), or finite at v = 0 (regularised)"}
// clang-format on

#endif
