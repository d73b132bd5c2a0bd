/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "run/engine.h"
#include "run/sensitivity.h"

// A problem on its way with its sensitivities. The state is y and, behind it, the mean slip and,
// where a point is seen, that of the point; time
// is origin + t, t the integrator's own, which begins anew where the loads break.
typedef struct lac_sensitivity_state {
    const lac_sensitivity_def *def;
    lac_sensitivity *out;
    size_t n, m;       // cells; components
    size_t mean, seen; // places of the mean slip, and of the slip that is seen, the last one
    SUNContext sun;
    void *mem; // CVODES
    SUNLinearSolver linear;
    N_Vector y, observation; // the state reached, a state looked at
    N_Vector *s, *seen_s;    // [perturbations] its derivatives; NULL: none
    double *work;            // lac_problem_work of any of the problems
    double *probe;           // [3 m]
    double *scale;           // [m] what each component is worth an e-fold of rate or state
    double slip_scale;       // slip that counts as an e-fold does [m]
    lac_failure failure;     // what counts as it
    double origin, limit;
    double rtol;        // what a step is held to: lac_engine_rtol
    int64_t beginnings; // breaks crossed
} lac_sensitivity_state;

// The loads' time at an integrator's time: within a segment they are seen from below its end.
static inline double lac_sensitivity_state_clock(const lac_sensitivity_state *f, double t)
{
    double now = f->origin + t;
    return now < f->limit ? now : f->limit;
}

// d(y, slip)/dt of one of the problems. @return false where a rate is not finite
bool lac_sensitivity_state_derivative(lac_sensitivity_state *f, const lac_problem *problem,
                                      double t, const double *y, double *ydot);

// Slip rates of the components from `mean` to `seen`, signed [m/s]. @param rate  [2]
// @return that of the last one
double lac_sensitivity_state_rates(lac_sensitivity_state *f, const lac_problem *problem, double t,
                                   const double *y, double *rate);

// What is seen of a state whose derivatives are wanted.
typedef double (*lac_sensitivity_state_measure)(lac_sensitivity_state *f,
                                                const lac_problem *problem, double t,
                                                const double *y);

// ln of the size of the slip rate that is seen, and lac_problem_past_failure.
double lac_sensitivity_state_log_rate(lac_sensitivity_state *f, const lac_problem *problem,
                                      double t, const double *y);
// And what stands for slip where friction is seen.
double lac_sensitivity_state_friction(lac_sensitivity_state *f, const lac_problem *problem,
                                      double t, const double *y);
double lac_sensitivity_state_past(lac_sensitivity_state *f, const lac_problem *problem, double t,
                                  const double *y);

// A step along s that moves no component by more than a small part of an e-fold; 0 where s is 0.
double lac_sensitivity_state_reach(const lac_sensitivity_state *f, const double *s);

// ds/dt = J s + df/dp of the k-th perturbation.
bool lac_sensitivity_state_sensitivity(lac_sensitivity_state *f, size_t k, double t,
                                       const double *y, const double *s, double *sdot);

// Derivative of a measure by the k-th perturbation. @param s  [m]
double lac_sensitivity_state_by(lac_sensitivity_state *f, lac_sensitivity_state_measure measure,
                                size_t k, double t, const double *y, const double *s);

// Takes state and sensitivities across a jump of the loads at time t.
bool lac_sensitivity_state_jump(lac_sensitivity_state *f, double t);
