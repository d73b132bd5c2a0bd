// SPDX-License-Identifier: GPL-3.0-or-later
// What the sensitivities of a followed problem need of it. Every derivative is a central difference
// of the problem's own functions: along a direction s by a step that moves no unknown by more than
// a few millionths of an e-fold, and by a parameter between the two problems made for it.
#include "base/statistics.h"
#include "run/sensitivity_state.h"

// The cube root of the rounding error, where the two errors of a central difference meet.
static const double reach = 6e-6;

static double mean_of(const lac_sensitivity_state *f, const lac_problem *problem, const double *x)
{
    const double *weight = lac_problem_parts_of(problem).weight;
    const double sum = weight == NULL ? lac_sum(f->n, x) : lac_dot(f->n, weight, x);
    return sum / (double)f->n;
}

bool lac_sensitivity_state_derivative(lac_sensitivity_state *f, const lac_problem *problem,
                                      double t, const double *y, double *ydot)
{
    if (!lac_problem_derivative(problem, lac_sensitivity_state_clock(f, t), y, ydot, f->work)) {
        return false;
    }
    const double mean = mean_of(f, problem, f->work);
    ydot[f->mean] = mean;
    if (f->seen > f->mean) {
        ydot[f->seen] = lac_point_mean(f->def->point, f->work);
    }
    return isfinite(mean);
}

double lac_sensitivity_state_rates(lac_sensitivity_state *f, const lac_problem *problem, double t,
                                   const double *y, double *rate)
{
    double *v = f->probe + 2 * f->m;
    lac_problem_rates(problem, lac_sensitivity_state_clock(f, t), y, v, f->work);
    rate[0] = mean_of(f, problem, v);
    if (f->seen > f->mean) {
        rate[1] = lac_point_mean(f->def->point, v);
    }
    return rate[f->seen - f->mean];
}

double lac_sensitivity_state_log_rate(lac_sensitivity_state *f, const lac_problem *problem,
                                      double t, const double *y)
{
    double rate[2];
    return log(fabs(lac_sensitivity_state_rates(f, problem, t, y, rate)));
}

double lac_sensitivity_state_friction(lac_sensitivity_state *f, const lac_problem *problem,
                                      double t, const double *y)
{
    lac_observation seen;
    lac_problem_observe(problem, lac_sensitivity_state_clock(f, t), y, y + f->mean, false, &seen,
                        f->work);
    return seen.shear_force / seen.effective_force;
}

// A parameter moves what counts as failure where that is a p/eta.
double lac_sensitivity_state_past(lac_sensitivity_state *f, const lac_problem *problem, double t,
                                  const double *y)
{
    lac_failure failure = f->failure;
    if (failure.lowered && problem != f->def->problem) {
        failure = lac_problem_failure(problem, f->def->failure_rate, f->def->failure_slip);
    }
    return lac_problem_past_failure(problem, &failure, lac_sensitivity_state_clock(f, t), y,
                                    f->work);
}

double lac_sensitivity_state_reach(const lac_sensitivity_state *f, const double *s)
{
    double largest = 0.0;
    for (size_t i = 0; i < f->m; i++) {
        largest = fmax(largest, fabs(s[i]) / f->scale[i]);
    }
    return largest > 0.0 ? reach / largest : 0.0;
}

static void move(const lac_sensitivity_state *f, const double *y, double by, const double *s,
                 double *out)
{
    for (size_t i = 0; i < f->m; i++) {
        out[i] = y[i] + by * s[i];
    }
}

bool lac_sensitivity_state_sensitivity(lac_sensitivity_state *f, size_t k, double t,
                                       const double *y, const double *s, double *sdot)
{
    const lac_perturbation *perturbation = &f->def->perturbation[k];
    double *there = f->probe;
    double *rates = f->probe + f->m;
    double by = lac_sensitivity_state_reach(f, s);
    memset(sdot, 0, f->m * sizeof *sdot);
    for (int side = -1; by > 0.0 && side <= 1; side += 2) {
        move(f, y, side * by, s, there);
        if (!lac_sensitivity_state_derivative(f, f->def->problem, t, there, rates)) {
            return false;
        }
        move(f, sdot, side / (2.0 * by), rates, sdot);
    }
    for (int side = -1; side <= 1; side += 2) {
        if (!lac_sensitivity_state_derivative(f, side < 0 ? perturbation->low : perturbation->high,
                                              t, y, rates)) {
            return false;
        }
        move(f, sdot, side / (2.0 * perturbation->step), rates, sdot);
    }
    return true;
}

double lac_sensitivity_state_by(lac_sensitivity_state *f, lac_sensitivity_state_measure measure,
                                size_t k, double t, const double *y, const double *s)
{
    const lac_perturbation *perturbation = &f->def->perturbation[k];
    double by = lac_sensitivity_state_reach(f, s);
    double slope = 0.0;
    for (int side = -1; by > 0.0 && side <= 1; side += 2) {
        move(f, y, side * by, s, f->probe);
        slope += side / (2.0 * by) * measure(f, f->def->problem, t, f->probe);
    }
    double change = measure(f, perturbation->high, t, y) - measure(f, perturbation->low, t, y);
    return slope + change / (2.0 * perturbation->step);
}

// J(y, p) is the state behind the jump: dJ/dy s + dJ/dp takes the place of s.
static bool jump_sensitivity(lac_sensitivity_state *f, size_t k, double t, const double *y,
                             double *s)
{
    const lac_perturbation *perturbation = &f->def->perturbation[k];
    double *there = f->probe;
    double *sum = f->probe + f->m;
    double by = lac_sensitivity_state_reach(f, s);
    memset(sum, 0, f->m * sizeof *sum);
    for (int side = -1; side <= 1; side += 2) {
        if (by > 0.0) {
            move(f, y, side * by, s, there);
            if (!lac_problem_jump(f->def->problem, t, there, f->work)) {
                return false;
            }
            move(f, sum, side / (2.0 * by), there, sum);
        }
        memcpy(there, y, f->m * sizeof *there);
        if (!lac_problem_jump(side < 0 ? perturbation->low : perturbation->high, t, there,
                              f->work)) {
            return false;
        }
        move(f, sum, side / (2.0 * perturbation->step), there, sum);
    }
    for (size_t i = f->mean; i <= f->seen; i++) {
        sum[i] = s[i]; // slip does not jump
    }
    memcpy(s, sum, f->m * sizeof *s);
    return true;
}

bool lac_sensitivity_state_jump(lac_sensitivity_state *f, double t)
{
    double *y = lac_vector_data(f->y);
    for (size_t k = 0; k < f->def->perturbations; k++) {
        if (!jump_sensitivity(f, k, t, y, lac_vector_data(f->s[k]))) {
            return false;
        }
    }
    return lac_problem_jump(f->def->problem, t, y, f->work);
}
