/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "friction/friction.h"

// One contact cell with a time of its own; docs/theory/fidelity-events.md.
typedef struct lac_async_cell {
    double a, b, constant, dc, ln_dc; // friction: f = constant + a u + b w
    double pressure;                  // total [Pa]
    double share, share_rate;         // effective over total at t = 0 of the loads [1], [1/s]
    double damping;                   // of its own rate [Pa s/m]
    double traction;                  // q at t = 0 of the loads [Pa]
    double stiffness;                 // ties it to its parent block: K_i of eq. 2 [Pa/m]
    double t;                         // time of the state [s]
    double u, w, v, slip;             // ln v, ln theta, v [m/s], slip [m]
    double told;                      // rate that the others are told from t on [m/s]
    double outer, area;               // E of its parent at t, and its integral over time
    double z;                         // slip over dc that a step may take
    double reach;                     // longest step, where waking cut the last one short [s]
    double due;                       // time of its next update [s]
    double pending;                   // change of E since t that has been handed down [Pa]
    double low, high;                 // change of E that wakes it [Pa]
    uint32_t parent;
} lac_async_cell;

// What all cells have in common.
typedef struct lac_async_rules {
    const lac_friction_lone *law;
    bool regularised;
    double tolerance; // of ln v over a step
    double wake;      // part of it that an unforeseen change of traction may cost
} lac_async_rules;

// A stretch of time of one cell, over which what acts on it from outside is linear.
typedef struct lac_async_span {
    double length;       // [s]
    double pull0, pull1; // traction less own stiffness times slip, at its ends: A of eq. 3 [Pa]
    double pressure0, pressure1; // effective normal pressure [Pa]
    double own;                  // K_ii: own stiffness [Pa/m]
    double skew;                 // mean of A over the span less that of its ends [Pa]
} lac_async_span;

// Takes u, w, v and slip over a span, in as many steps as the tolerance asks for, which it counts.
// False where no slip rate balances the traction.
bool lac_async_cell_advance(const lac_async_rules *rules, const lac_async_span *span,
                            lac_async_cell *cell, int64_t *steps);

// Whether the traction that friction holds has fallen to nothing.
bool lac_async_cell_let_go(const lac_async_rules *rules, const lac_async_cell *cell);

// What acts on a cell at an instant.
typedef struct lac_async_push {
    double pull_rate;               // dA/dt [Pa/s]
    double pressure, pressure_rate; // effective [Pa], [Pa/s]
    double own;                     // K_ii [Pa/m]
} lac_async_push;

// Plans the next step of a cell from its state: its length, the rate that others are told, and the
// change of E that wakes it. Gives back its length [s]; may be INFINITY.
double lac_async_cell_plan(const lac_async_rules *rules, const lac_async_push *push,
                           lac_async_cell *cell);
