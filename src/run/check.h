/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RUN_CHECK_H
#define LACUNA_RUN_CHECK_H

#include "run/run.h"

// Whether a run can be asked for like this.
lac_status lac_check_def(const lac_run_def *def, lac_error *err);

// Whether a run can start from y: below its limits, and slipping.
lac_status lac_check_start(const lac_problem *problem, const lac_run_def *def,
                           const lac_failure *failure, const double *y, double *work,
                           lac_error *err);

// The largest slip rate must be one that every formulation can hold. @param v  [n] of all cells
lac_status lac_check_rates(const lac_problem *problem, double max, double t, const double *v,
                           lac_error *err);

// Slip that stops or turns back at time t must be one that the formulation can follow.
lac_status lac_check_slipping(const lac_problem *problem, const double *y, double t, double *work,
                              lac_error *err);

#endif
