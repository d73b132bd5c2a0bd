// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns (slip, ln theta): the traction is the loads' less K slip, v is solved from the balance,
// which holds by construction; docs/theory/creep.md eqs. 6, 7 and 9.
#include "base/vsum.h"
#include "model/internal.h"
#include "model/weaken.h"

static void start(const lac_problem *problem, double *x) { memset(x, 0, problem->n * sizeof *x); }

static lac_motion move(const lac_look *at, bool keep)
{
    lac_problem_elastic_traction(at, at->y, at->ws.kv);
    return lac_problem_solve_rates(at, at->ws.kv, keep);
}

static bool derivative(const lac_look *at, double *ydot)
{
    size_t n = at->problem->n;
    bool good = lac_problem_evolve(at, ydot + n);
    memcpy(ydot, at->motion.v, n * sizeof *ydot);
    return lac_problem_agree(at->problem, lac_vfinite(n, ydot) && good);
}

// x_slip = b_slip + gamma dv
static bool newton(const lac_look *at, double gamma, double *b)
{
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    if (!lac_implicit_reduce(at, gamma, b, b + n)) {
        return false;
    }
    // ws->u is free where rates are kept: K b_slip.
    double mean = at->drive.spring_stiffness * lac_problem_mean(problem, b);
    transfer->kind->apply(transfer->state, b, ws->u, ws->scratch);
    for (size_t i = 0; i < n; i++) {
        double rhs = -(ws->u[i] + mean + ws->kv[i]) / gamma;
        ws->kv[i] = b[i];
        b[i] = rhs;
    }
    if (!lac_implicit_solve(at, gamma, b)) {
        return false;
    }
    lac_weaken_finish(at, gamma, b);
    for (size_t i = 0; i < n; i++) {
        double dv = b[i];
        b[i] = ws->kv[i] + gamma * dv;
        b[n + i] += ws->v[i] * dv;
    }
    return true;
}

// Slip counts as the state that it renews and the traction that it takes off: dc, or the slip that
// takes a p off against the cell's stiffness, whichever is less.
double lac_slip_scale(const lac_problem *problem, size_t cell)
{
    double dc = lac_cellwise_of(&problem->friction->column[LAC_DC], cell);
    double traction = lac_implicit_traction_scale(problem, cell);
    return traction < problem->stiffness * dc ? traction / problem->stiffness : dc;
}

void lac_slip_scales(const lac_problem *problem, size_t first, size_t n, double *scale)
{
    for (size_t i = 0; i < n; i++) {
        scale[i] = lac_slip_scale(problem, first + i);
    }
}

const lac_formulation_kind lac_formulation_slip = {.id = LAC_FORMULATION_SLIP,
                                                   .name = "slip",
                                                   .unknown = "slip",
                                                   .unknowns = 2,
                                                   .arrays = 5,
                                                   .solved = true,
                                                   .either_sign = true,
                                                   .has_slip = true,
                                                   .start = start,
                                                   .move = move,
                                                   .derivative = derivative,
                                                   .newton = newton,
                                                   .scale = lac_slip_scales};
