// SPDX-License-Identifier: GPL-3.0-or-later
// A state moved onto the balance of its tractions, slip and rates together, before it is put out.
#include <math.h>

#include "base/vsum.h"
#include "model/internal.h"

// The slip that a cell's correction is relative to.
static double gone_of(const lac_problem *problem, const double *slip, size_t i)
{
    return fabs(slip[i]) + lac_cellwise_of(&problem->friction->column[LAC_DC], i);
}

// With r = q - K slip - p f - damping, E = p f_u + eta |v|, D = E/(|slip| + dc) and, where the mean
// is damped by g a cell, c = v/(|slip| + dc), the linear system
//   (D + K + g c^T/n) dslip = r,   E dln v = D dslip
// moves both sides of the balance together: what stiffly tied cells are off by goes into the small
// differences of their slip, what they are off by in common into the rates.
static void residual_block(const lac_problem *problem, const lac_problem_loads_at *drive,
                           const lac_motion *motion, const double *y, const double *slip,
                           const lac_workspace *ws, size_t first)
{
    lac_block s;
    const double *w = y + problem->n;
    bool damped = problem->drag != 0.0;
    size_t length = lac_block_friction(problem, drive, motion, w, first, &s, NULL);
    for (size_t i = 0; i < length; i++) {
        size_t k = first + i;
        double p = problem->pressure[k] * drive->share;
        double e = p * s.f_u[i] + problem->damping * s.speed[i];
        double held = copysign(p * s.f[i], motion->v[k]) + problem->damping * motion->v[k];
        double gone = gone_of(problem, slip, k);
        ws->kv[k] -= held;
        ws->diagonal[k] = e / gone;
        if (damped) {
            ws->kv[k] -= problem->drag * problem->pressure[k] * motion->mean;
            ws->row[k] = motion->v[k] / gone;
        }
    }
}

// dslip, in the place of r. @param rise  of the mean slip rate that it makes [m/s]
static bool solve(const lac_problem *problem, const lac_problem_loads_at *drive,
                  const lac_workspace *ws, double *rise)
{
    size_t n = problem->n;
    double *row = ws->row;
    bool damped = problem->drag != 0.0;
    double even = 0.0;
    for (size_t i = 0; damped && i < n; i++) {
        even += fabs(row[i]) / (double)n;
    }
    double kappa = problem->drag * (problem->sum_pressure / (double)n) * even;
    lac_sharing on = {0};
    if (even > 0.0) {
        on = (lac_sharing){.kappa = kappa, .row = row, .shares = ws->v}; // v has been used
        for (size_t i = 0; i < n; i++) {
            row[i] /= even;
        }
    }
    if (!lac_problem_solve_sharing(problem, drive->spring_stiffness + kappa, ws->diagonal, &on,
                                   ws->kv, ws->scratch)) {
        return false;
    }
    for (size_t i = 0; on.row != NULL && i < n; i++) {
        *rise += row[i] * ws->kv[i] * (even / (double)n);
    }
    return true;
}

bool lac_problem_project(const lac_problem *problem, double t, double *y, double *slip,
                         double *work)
{
    size_t n = problem->n;
    if (problem->kind->has_slip) {
        return true;
    }
    const lac_look at = lac_problem_look(problem, t, y, work);
    const lac_workspace ws = at.ws;
    lac_problem_elastic_traction(problem, &at.drive, slip, ws.kv, ws.scratch);
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        residual_block(problem, &at.drive, &at.motion, y, slip, &ws, first);
    }
    double rise = 0.0;
    if (!solve(problem, &at.drive, &ws, &rise)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        double gone = gone_of(problem, slip, i);
        double common = problem->drag * problem->pressure[i] * rise;
        y[i] += problem->kind->solved ? ws.diagonal[i] * ws.kv[i] + common : ws.kv[i] / gone;
        slip[i] += ws.kv[i];
    }
    return true;
}
