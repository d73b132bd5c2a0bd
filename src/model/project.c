// SPDX-License-Identifier: GPL-3.0-or-later
// A state moved onto its balance before it is put out: slip and slip rate by the same fraction.
#include "model/internal.h"
#include "model/weaken.h"

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
static void residual_block(const lac_look *at, const double *slip, size_t first)
{
    lac_block s;
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    const lac_motion *motion = &at->motion;
    bool damped = problem->drag != 0.0;
    size_t length = lac_block_friction(at, first, &s, NULL);
    for (size_t i = 0; i < length; i++) {
        size_t k = first + i;
        double p = lac_problem_effective(problem, &at->drive, k);
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

// A row of the system, of which a part counts.
typedef struct row_field {
    const lac_look *at;
    double part;
} row_field;

static void add_even(const void *context, size_t first, size_t end, double *sums)
{
    const lac_look *at = ((const row_field *)context)->at;
    for (size_t i = first; i < end; i++) {
        sums[0] +=
            lac_problem_weight(at->problem, i) * fabs(at->ws.row[i]) / lac_problem_all(at->problem);
    }
}

static void add_rise(const void *context, size_t first, size_t end, double *sums)
{
    const row_field *f = context;
    const lac_workspace *ws = &f->at->ws;
    for (size_t i = first; i < end; i++) {
        sums[0] += lac_problem_weight(f->at->problem, i) * ws->row[i] * ws->kv[i] * f->part;
    }
}

// dslip, in the place of r. @param rise  of the mean slip rate that it makes [m/s]
static bool solve(const lac_look *at, double *rise)
{
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    size_t n = problem->n;
    double *row = ws->row;
    bool damped = problem->drag != 0.0;
    double even = 0.0;
    if (damped) {
        lac_range_sums(&problem->range, 1, add_even, &(row_field){at, 1.0}, &even);
    }
    double kappa = problem->drag * (problem->sum_pressure / lac_problem_all(problem)) * even;
    lac_sharing on = {0};
    if (even > 0.0) {
        on = (lac_sharing){.kappa = kappa, .row = row, .shares = ws->v}; // v has been used
        for (size_t i = 0; i < n; i++) {
            row[i] /= even;
        }
    }
    if (!lac_problem_solve_sharing(problem, at->drive.spring_stiffness + kappa, ws->diagonal, &on,
                                   ws->kv, ws->scratch)) {
        return false;
    }
    if (on.row != NULL) {
        const row_field field = {at, even / lac_problem_all(problem)};
        lac_range_sums(&problem->range, 1, add_rise, &field, rise);
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
    lac_look at;
    lac_problem_look(problem, t, y, work, &at);
    const lac_workspace ws = at.ws;
    lac_problem_elastic_traction(&at, slip, ws.kv);
    lac_look_add_lost(&at, ws.kv);
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        residual_block(&at, slip, first);
    }
    double rise = 0.0;
    if (!solve(&at, &rise)) {
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
