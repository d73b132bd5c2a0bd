// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns (tau, ln theta), tau = q - K slip: v of either sign is solved from the balance;
// docs/theory/creep.md eqs. 6 to 8.
#include "base/clones.h"
#include "model/internal.h"
#include "model/weaken.h"

static void start(const lac_problem *problem, double *x)
{
    memcpy(x, problem->traction0, problem->n * sizeof *x);
}

static lac_motion move(const lac_look *at, bool keep)
{
    return lac_problem_solve_rates(at, at->y, keep);
}

// Whether all are finite.
LAC_CLONES static bool lac_traction_rates(size_t n, const double *p, double ratio_rate,
                                          double loading, const double *kv, double *ydot)
{
    uint64_t bad = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double rate = p[i] * ratio_rate + loading - kv[i];
        ydot[i] = rate;
        bad += fabs(rate) <= DBL_MAX ? 0 : 1;
    }
    return bad == 0;
}

// dtau/dt = dq/dt - K v
static bool derivative(const lac_look *at, double *ydot)
{
    const lac_problem *problem = at->problem;
    const lac_problem_loads_at *drive = &at->drive;
    size_t n = problem->n;
    lac_problem_couple(problem, drive->far_rate, at->motion.v, at->ws.kv, at->ws.scratch);
    double loading = drive->spring_rate - drive->spring_stiffness * at->motion.mean;
    bool good = lac_problem_evolve(at, ydot + n);
    good = lac_traction_rates(n, problem->pressure, drive->ratio_rate, loading, at->ws.kv, ydot) &&
           good;
    return lac_problem_agree(problem, good);
}

// x_tau = b_tau - gamma K dv, which is gamma D dv + f_w's part + drag mean dv by the row itself.
static bool newton(const lac_look *at, double gamma, double *b)
{
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    size_t n = problem->n;
    if (!lac_implicit_reduce(at, gamma, NULL, b + n)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        b[i] = (b[i] - ws->kv[i]) / gamma;
    }
    if (!lac_implicit_solve(at, gamma, b)) {
        return false;
    }
    lac_weaken_finish(at, gamma, b);
    double rise = lac_problem_mean(problem, b);
    for (size_t i = 0; i < n; i++) {
        double dv = b[i];
        double common = lac_problem_drag(problem, i) * rise;
        b[i] = gamma * ws->diagonal[i] * dv + ws->kv[i] + common;
        b[n + i] += ws->v[i] * dv;
    }
    return true;
}

static bool jump(const lac_problem *problem, const lac_jump *jump, double *y)
{
    for (size_t i = 0; i < problem->n; i++) {
        y[i] += lac_problem_gain(problem, jump, i);
    }
    return true;
}

// d tau = a p d ln v
LAC_CLONES static void lac_traction_scale(const lac_problem *problem, size_t first, size_t n,
                                          double *scale)
{
    const double *a = lac_cellwise_from(&problem->friction->column[LAC_A], first);
    const double *b = lac_cellwise_from(&problem->friction->column[LAC_B], first);
    const double *p = problem->pressure + first;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double effect = a[i] > 0.0 ? a[i] : b[i];
        scale[i] = (effect > 0.0 ? effect : 1.0) * p[i];
    }
}

const lac_formulation_kind lac_formulation_traction = {.id = LAC_FORMULATION_TRACTION,
                                                       .name = "traction",
                                                       .unknown = "traction",
                                                       .unknowns = 2,
                                                       .arrays = 5,
                                                       .solved = true,
                                                       .either_sign = true,
                                                       .start = start,
                                                       .move = move,
                                                       .derivative = derivative,
                                                       .newton = newton,
                                                       .scale = lac_traction_scale,
                                                       .jump = jump};
