// SPDX-License-Identifier: GPL-3.0-or-later
// What integrators ask of a problem: dy/dt, Newton's system, allowed errors, a first step.
#include "base/clones.h"
#include "model/internal.h"
#include "model/weaken.h"

bool lac_problem_derivative(const lac_problem *problem, double t, const double *y, double *ydot,
                            double *work)
{
    lac_look at;
    return lac_problem_begin(problem, t, y, true, work, &at) &&
           lac_weaken_rates(&at, ydot + lac_weaken_place(problem)) &&
           problem->kind->derivative(&at, ydot);
}

bool lac_problem_newton(const lac_problem *problem, double t, const double *y, double gamma,
                        double *b, double *work)
{
    lac_look at;
    return lac_problem_begin(problem, t, y, true, work, &at) && lac_weaken_rates(&at, NULL) &&
           problem->kind->newton(&at, gamma, b);
}

bool lac_problem_rates_stay(const lac_problem *problem)
{
    return problem->kind->id == LAC_FORMULATION_RATE;
}

bool lac_problem_newton_next(const lac_problem *problem, double t, const double *y, double gamma,
                             double *b, double *work)
{
    if (!lac_problem_rates_stay(problem)) {
        return lac_problem_newton(problem, t, y, gamma, b, work);
    }
    lac_look at;
    lac_problem_look_again(problem, t, y, work, &at);
    at.coupled = true;
    return lac_weaken_rates(&at, NULL) && problem->kind->newton(&at, gamma, b);
}

// What ln theta is worth in ln v under constant traction is b/a. Up to this it passes for one, so
// that ordinary friction needs no care.
#define MOST_WORTH 10.0

static const double resolved = 8.0 * DBL_EPSILON; // of what a double holds

// weight = 1/(rtol scale), no finer than a double resolves y. @param y  NULL: 1
LAC_CLONES static void lac_weigh(size_t n, double rtol, const double *scale, const double *y,
                                 double *weight)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double error = rtol * scale[i];
        double least = resolved * (y != NULL ? fabs(y[i]) : 1.0);
        weight[i] = 1.0 / (least > error ? least : error);
    }
}

// Error of ln theta that counts as rtol where v is solved for.
LAC_CLONES static void lac_weigh_state_scale(size_t n, const double *a, const double *b,
                                             double *scale)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        bool counts = (a[i] > 0.0) & (b[i] > MOST_WORTH * a[i]);
        scale[i] = counts ? MOST_WORTH * a[i] / b[i] : 1.0;
    }
}

void lac_problem_weights(const lac_problem *problem, const double *y, double rtol, double *weight)
{
    const lac_formulation_kind *kind = problem->kind;
    const lac_cellwise *column = problem->friction->column;
    double scale[LAC_FRICTION_BLOCK], state[LAC_FRICTION_BLOCK];
    for (size_t i = 0; i < LAC_FRICTION_BLOCK; i++) {
        scale[i] = state[i] = 1.0;
    }
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        const size_t n = lac_block_length(problem->n, first);
        if (kind->scale != NULL) {
            kind->scale(problem, first, n, scale);
        }
        if (kind->solved) {
            lac_weigh_state_scale(n, lac_cellwise_from(&column[LAC_A], first),
                                  lac_cellwise_from(&column[LAC_B], first), state);
        }
        lac_weigh(n, rtol, scale, y + first, weight + first);
        lac_weigh(n, rtol, state, NULL, weight + problem->n + first);
    }
    if (problem->across != NULL) {
        lac_vector_weigh(problem, y, rtol, weight);
    }
    if (problem->mass > 0.0) {
        lac_inertia_weigh_slip(problem, y + 2 * problem->n, rtol, weight + 2 * problem->n);
    }
    if (problem->weak != NULL) {
        lac_weaken_weigh(problem, y, rtol, weight);
    }
}

double lac_problem_even_weight(const lac_problem *problem, const double *y, double rtol)
{
    const lac_formulation_kind *kind = problem->kind;
    const bool even = kind->scale == NULL && !kind->solved && kind->unknowns == 2 &&
                      problem->weak == NULL &&
                      resolved * fmax(lac_vmost(problem->n, y), 1.0) <= rtol;
    return even ? 1.0 / rtol : 0.0;
}

double lac_problem_least_tolerance(const lac_problem *problem, const double *tolerance)
{
    double least = INFINITY;
    for (size_t i = 0; i < problem->n; i++) {
        least = fmin(least, tolerance[i]);
    }
    return lac_team_least(problem->range.team, least);
}

double lac_problem_slip_tolerance(const lac_problem *problem, double rtol, double *tolerance)
{
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        const double *dc = lac_cellwise_from(&problem->friction->column[LAC_DC], first);
        for (size_t i = 0; i < lac_block_length(problem->n, first); i++) {
            tolerance[first + i] = rtol * dc[i];
        }
    }
    return problem->kind->solved ? 0.0 : rtol;
}

// Stiffest of what holds a cell back [Pa/m].
static double stiffest(const lac_problem *problem, const lac_problem_loads_at *drive)
{
    const size_t levels = 64; // more than any grid has
    const lac_transfer *transfer = &problem->transfer;
    double most = 0.0;
    for (size_t l = 0; l < levels; l++) {
        most = fmax(most, transfer->kind->stiffness(transfer->state, l));
    }
    return most + drive->spring_stiffness + problem->slide;
}

// Fastest e-folding of a cell [1/s], and with a stiffness the fastest decay of what it is behind.
static double fastest(const lac_problem *problem, double t, const double *y, bool held_back,
                      double *work)
{
    lac_look at;
    lac_problem_look(problem, t, y, work, &at);
    double stiffness = held_back ? stiffest(problem, &at.drive) : 0.0;
    double most = problem->mass > 0.0 ? lac_inertia_fastest(&at) : 0.0;
    most = held_back ? fmax(most, lac_weaken_fastest(problem)) : most;
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        lac_block s;
        size_t length = lac_block_friction(&at, first, &s, NULL);
        for (size_t i = 0; i < length; i++) {
            double p = lac_problem_effective(problem, &at.drive, first + i);
            double slip = s.speed[i] * lac_cellwise_of(&problem->friction->inv_dc, first + i);
            double held = fmax(fabs(p * s.f_u[i] + problem->damping * s.speed[i]), DBL_MIN);
            double worth = fmin(fmax(p * s.f_w[i] / (MOST_WORTH * held), 1.0), 1e12);
            double back = stiffness * s.speed[i] / held;
            most = fmax(most, fmax(fmax(fabs(s.g[i]) * worth, slip), back));
        }
    }
    return lac_problem_most(problem, most);
}

double lac_problem_first_step(const lac_problem *problem, double t, const double *y, double *work)
{
    return 1e-3 / fastest(problem, t, y, false, work);
}

double lac_problem_fastest(const lac_problem *problem, double t, const double *y, double *work)
{
    return fastest(problem, t, y, true, work);
}
