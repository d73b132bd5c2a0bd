/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RUN_NEWTON_H
#define LACUNA_RUN_NEWTON_H

#include <sundials/sundials_nonlinearsolver.h>

#include "run/engine.h"

// Newton's iteration of a CVODE step with the problem's exact solve. To the bit what SUNDIALS' own
// makes of a solver that brings its matrix along, but without two vectors: the residual is formed
// and solved for in place of dy/dt, which nobody reads after it. NULL where memory is short.
SUNNonlinearSolver lac_newton_create(lac_engine *engine, void *cvode);

// dy/dt evaluated since this was last asked, which CVODE does not count.
int64_t lac_newton_evaluations(SUNNonlinearSolver solver);

#endif
