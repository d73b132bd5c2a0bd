// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>

#include "base/vsum.h"
#include "model/internal.h"

// With r = q - K slip - p f - damping, E = p f_u + eta |v|, D = E/(|slip| + dc) and, where the mean
// is damped, c = eta_m v/(|slip| + dc), the linear system
//   (D + K + 1 c^T/n) dslip = r,   E dln v = D dslip
// moves both sides of the balance together: what stiffly tied cells are off by goes into the small
// differences of their slip, what they are off by in common into the rates.
static void residual_block(const lac_problem *problem, const lac_drive *drive,
                           const lac_motion *motion, const double *y, const double *slip,
                           const lac_workspace *ws, size_t first)
{
    lac_block s;
    const double *w = y + problem->n;
    bool damped = problem->mean_damping != 0.0;
    size_t length = lac_block_friction(problem, drive, motion, w, first, &s, NULL);
    for (size_t i = 0; i < length; i++) {
        size_t k = first + i;
        double p = problem->pressure[k] * drive->share;
        double e = p * s.f_u[i] + problem->damping * s.speed[i];
        double held = copysign(p * s.f[i], motion->v[k]) + problem->damping * motion->v[k];
        double gone = fabs(slip[k]) + lac_cellwise_of(&problem->friction->column[LAC_DC], k);
        ws->kv[k] -= held;
        ws->diagonal[k] = e / gone;
        if (damped) {
            ws->kv[k] -= problem->mean_damping * motion->mean;
            ws->lean[k] = problem->mean_damping * motion->v[k] / gone;
        }
        ws->v[k] = e;
    }
}

// dslip, in the place of r. @param common  what it adds to the damping of the mean [Pa]
static bool solve(const lac_problem *problem, const lac_drive *drive, const lac_workspace *ws,
                  double *common)
{
    size_t n = problem->n;
    if (problem->mean_damping == 0.0) {
        return problem->transfer.kind->solve(problem->transfer.state, drive->spring_stiffness,
                                             ws->diagonal, ws->kv, ws->kv, ws->scratch);
    }
    double *rise = ws->lean;
    double mean = lac_vsum(n, rise) / (double)n;
    for (size_t i = 0; i < n; i++) {
        rise[i] -= mean;
    }
    if (!lac_problem_solve_leaning(problem, drive->spring_stiffness + mean, ws->diagonal, rise,
                                   ws->kv, ws->scratch)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        *common += (rise[i] + mean) * ws->kv[i];
    }
    *common /= (double)n;
    return true;
}

bool lac_problem_project(const lac_problem *problem, double t, double *y, double *slip,
                         double *work)
{
    size_t n = problem->n;
    lac_workspace ws = lac_problem_split(problem, work);
    lac_drive drive;
    if (problem->kind->has_slip) {
        return true;
    }
    (void)lac_problem_drive(problem, t, &drive);
    lac_motion motion = problem->kind->move(problem, &drive, y, &ws, false);
    lac_problem_pull(problem, &drive, slip, ws.kv, ws.scratch);
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        residual_block(problem, &drive, &motion, y, slip, &ws, first);
    }
    double common = 0.0;
    if (!solve(problem, &drive, &ws, &common)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        double force = ws.diagonal[i] * ws.kv[i];
        slip[i] += ws.kv[i];
        y[i] += problem->kind->solved ? force + common : force / ws.v[i];
    }
    return true;
}
