/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "model/problem.h"
#include "run/points.h"

/// A parameter that a run is differentiated by: the same problem made with a little less and a
/// little more of it. The three problems have the same cells and formulation, and their loads break
/// at the same times.
typedef struct lac_perturbation {
    const lac_problem *low, *high;
    double step; ///< half of the parameter's difference between the two, in its own unit
} lac_perturbation;

/// What is followed and for how long.
typedef struct lac_sensitivity_def {
    const lac_problem *problem;
    size_t perturbations;
    const lac_perturbation *perturbation; ///< [perturbations]; NULL: none
    const lac_point *point; ///< whose slip and rate are seen; NULL: the means over all cells
    bool friction;          ///< of one cell: its shear over its effective normal force is seen
    double rtol;            ///< on slip rate, state and their sensitivities
    double end;             ///< [s]
    double failure_rate;    ///< mean slip rate and
    double failure_slip;    ///< mean slip that count as failure, which ends it [m/s], [m]; both as
                            ///< lac_problem_failure takes them
    int64_t max_steps;
    size_t n;
    const double *time; ///< [n] rising, within [0, end] [s]
} lac_sensitivity_def;

/// What is seen at the wanted times. The arrays are the caller's; entries from `reached` on are not
/// set.
typedef struct lac_sensitivity {
    double *slip;        ///< [n] mean, or of the point [m]; or friction [1]
    double *log_rate;    ///< [n] ln of the size of its rate [m/s]
    double *slip_by;     ///< [n][perturbations] derivatives; NULL where there are no perturbations
    double *log_rate_by; ///< [n][perturbations]
    double *failure_by;  ///< [perturbations] of the time of failure [s]
    size_t reached;      ///< wanted times up to the end or the failure
    bool failed;
    double failure_time; ///< [s]; NaN where none
    int64_t steps;
} lac_sensitivity;

/// Integrates a problem by BDF with the derivatives of what is seen by the parameters: CVODES'
/// staggered forward sensitivities, their J s + df/dp by central differences;
/// docs/theory/fitting.md eq. 2. Nothing carries over from call to call: the same def gives the
/// same bits.
lac_status lac_sensitivity_run(const lac_sensitivity_def *def, lac_sensitivity *out,
                               lac_error *err);
