// SPDX-License-Identifier: GPL-3.0-or-later
// What integrators ask of a problem: dy/dt, Newton's system, allowed errors, a first step.
#include "model/internal.h"

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

// What ln theta is worth in ln v under constant traction is b/a. Up to this it passes for one, so
// that ordinary friction needs no care.
#define MOST_WORTH 10.0

// Error of ln theta that counts as rtol where v is solved for.
static double state_scale(const lac_problem *problem, size_t cell)
{
    double a = lac_cellwise_of(&problem->friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&problem->friction->column[LAC_B], cell);
    bool counts = problem->kind->solved && a > 0.0 && b > MOST_WORTH * a;
    return counts ? MOST_WORTH * a / b : 1.0;
}

void lac_problem_weights(const lac_problem *problem, const double *y, double rtol, double *weight)
{
    for (size_t i = 0; i < problem->n; i++) {
        double error =
            problem->kind->scale != NULL ? rtol * problem->kind->scale(problem, i) : rtol;
        weight[i] = 1.0 / fmax(error, 8.0 * DBL_EPSILON * fabs(y[i]));
        double state = rtol * state_scale(problem, i);
        weight[problem->n + i] = 1.0 / fmax(state, 8.0 * DBL_EPSILON);
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

double lac_problem_slip_tolerance(const lac_problem *problem, double rtol, double *tolerance)
{
    for (size_t i = 0; i < problem->n; i++) {
        tolerance[i] = rtol * lac_cellwise_of(&problem->friction->column[LAC_DC], i);
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
    return most;
}

double lac_problem_first_step(const lac_problem *problem, double t, const double *y, double *work)
{
    return 1e-3 / fastest(problem, t, y, false, work);
}

double lac_problem_fastest(const lac_problem *problem, double t, const double *y, double *work)
{
    return fastest(problem, t, y, true, work);
}
