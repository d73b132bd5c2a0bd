// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's system where v is solved for: ln theta and the balance are eliminated beforehand.
#include "model/internal.h"

#include <math.h>

// dtau/dv where v is as good as nothing.
#define STIFFEST 1e250

// tau = s p f(ln|v|, w) + eta v, s the sign of v, gives with Z = p f_u/|v| + eta
//   x_tau = Z dv + s p f_w x_w,   x_w = back (b_w + gamma (g_u/v) dv),   back = 1/(1 - gamma g_w)
static bool reduce_block(const lac_problem *problem, const lac_implicit *at, double *b_w,
                         const lac_workspace *ws, size_t first)
{
    lac_block s;
    lac_block_slopes d;
    size_t length = lac_block_friction(problem, at->drive, at->motion, at->w, first, &s, &d);
    bool good = true;
    for (size_t i = 0; i < length; i++) {
        size_t k = first + i;
        double p = problem->pressure[k] * at->drive->share;
        double v = at->motion->v[k];
        double z = p * s.f_u[i] / s.speed[i] + problem->damping;
        z = z < STIFFEST ? z : STIFFEST;
        double f_w = copysign(p * s.f_w[i], v);
        double back = 1.0 / (1.0 - at->gamma * d.g_w[i]);
        double slope = back * (d.g_u[i] / v);
        good = good && back > 0.0;
        b_w[k] *= back;
        ws->diagonal[k] = z / at->gamma + f_w * slope;
        ws->kv[k] = f_w * b_w[k];
        ws->v[k] = at->gamma * slope;
    }
    return good;
}

bool lac_implicit_reduce(const lac_problem *problem, const lac_implicit *at, double *b_w,
                         const lac_workspace *ws)
{
    bool good = true;
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        good = reduce_block(problem, at, b_w, ws, first) && good;
    }
    return good;
}

bool lac_implicit_solve(const lac_problem *problem, const lac_implicit *at, double *b,
                        const lac_workspace *ws)
{
    double kappa = problem->drag * (problem->sum_pressure / (double)problem->n) / at->gamma;
    double mean = at->drive->spring_stiffness + kappa;
    bool felt = lac_problem_feels_drag(problem, at->drive->share, at->motion->mean);
    const lac_sharing on = {.kappa = felt ? kappa : 0.0, .shares = ws->u};
    return lac_problem_solve_sharing(problem, mean, ws->diagonal, &on, b, ws->scratch);
}

double lac_implicit_traction_scale(const lac_problem *problem, size_t cell)
{
    double a = lac_cellwise_of(&problem->friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&problem->friction->column[LAC_B], cell);
    double effect = a > 0.0 ? a : b;
    return (effect > 0.0 ? effect : 1.0) * problem->pressure[cell];
}
