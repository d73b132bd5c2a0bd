/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_MODEL_IMPLICIT_H
#define LACUNA_MODEL_IMPLICIT_H

#include "model/internal.h"

// The state at which (1 - gamma J) is taken, for formulations that solve for v.
typedef struct lac_implicit {
    const lac_drive *drive;
    const lac_motion *motion;
    const double *w;
    double gamma;
} lac_implicit;

// Eliminates ln theta and the balance from the Newton system; docs/theory/creep.md eq. 8.
// @param b_w  [n] right-hand side of ln theta; overwritten by back b_w
// @param ws   diagonal is set to D, kv to p f_w back b_w, v to d ln theta/dv: x_w = back b_w + v dv
// @return false where ln theta cannot be eliminated
bool lac_implicit_reduce(const lac_problem *problem, const lac_implicit *at, double *b_w,
                         const lac_workspace *ws);

// (D + K + stiffness of the mean, that of its damping included) dv = b, once they are eliminated.
// ws->u is used up.
// @return false where the transfer's solve fails
bool lac_implicit_solve(const lac_problem *problem, const lac_implicit *at, double *b,
                        const lac_workspace *ws);

// Traction that is worth an e-fold of slip rate: a p, and b p where a = 0 [Pa].
double lac_implicit_traction_scale(const lac_problem *problem, size_t cell);

#endif
