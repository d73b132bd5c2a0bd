// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>

#include "model/internal.h"

void lac_problem_speed(const lac_problem *problem, const double *y, double *mean, double *max,
                       double *work)
{
    size_t n = problem->n;
    *mean = lac_problem_exp_sum(n, y, work) / (double)n;
    *max = work[0];
    for (size_t i = 1; i < n; i++) {
        *max = work[i] > *max ? work[i] : *max;
    }
}

void lac_problem_traction(const lac_problem *problem, double t, const double *slip,
                          double *traction, double *work)
{
    lac_drive drive;
    (void)lac_problem_drive(problem, t, &drive);
    double mean = lac_problem_sum(problem->n, slip) / (double)problem->n;
    double common = drive.spring - drive.spring_stiffness * mean;
    lac_problem_couple(problem, drive.back, slip, traction, work + 3 * problem->n);
    for (size_t i = 0; i < problem->n; i++) {
        double q = problem->traction0[i] + problem->pressure[i] * drive.ratio + common;
        traction[i] = q - traction[i];
    }
}

// Worst relative error of the balance: |q - K slip - p f - eta v| / (f0 p).
static double balance_residual(const lac_problem *problem, const lac_drive *drive, const double *y,
                               const double *v, const double *traction)
{
    size_t n = problem->n;
    const double *f0 = problem->friction->column[LAC_F0];
    double worst = 0.0;
    lac_block s;
    lac_friction_values values = lac_block_values(&s);
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        lac_friction_cells cells = lac_block_cells(n, first, y, v);
        lac_friction_evaluate(problem->friction, &cells, &values, NULL);
        for (size_t i = 0; i < cells.n; i++) {
            size_t k = first + i;
            double p = problem->pressure[k] * drive->share;
            double off = traction[k] - p * s.f[i] - problem->damping * v[k];
            double scale = p * (f0[k] != 0.0 ? fabs(f0[k]) : 1.0);
            double relative = fabs(off) / scale;
            worst = relative > worst || isnan(relative) ? relative : worst;
        }
    }
    return worst;
}

void lac_problem_observe(const lac_problem *problem, double t, const double *y, const double *slip,
                         lac_observation *seen, double *work)
{
    size_t n = problem->n;
    double *v = work;
    double *traction = work + n;
    lac_drive drive;
    (void)lac_problem_drive(problem, t, &drive);

    seen->mean_rate = lac_problem_exp_sum(n, y, v) / (double)n;
    seen->fastest = 0;
    for (size_t i = 1; i < n; i++) {
        seen->fastest = v[i] > v[seen->fastest] ? i : seen->fastest;
    }
    seen->max_rate = v[seen->fastest];
    seen->mean_slip = lac_problem_sum(n, slip) / (double)n;

    double spring = drive.spring - drive.spring_stiffness * seen->mean_slip;
    double total =
        problem->sum_traction0 + problem->sum_pressure * drive.ratio + (double)n * spring;
    total -= lac_problem_held(problem, drive.back, slip);
    seen->shear_force = problem->cell_area * total;
    seen->normal_force = problem->cell_area * problem->sum_pressure;
    seen->effective_force = seen->normal_force * drive.share;

    lac_problem_traction(problem, t, slip, traction, work);
    seen->balance_residual = balance_residual(problem, &drive, y, v, traction);
}

bool lac_problem_slips(const lac_problem *problem, const double *y, size_t *cell)
{
    // Regularised, f falls to nothing as exp of this sum over a; plain, f is the sum.
    const lac_friction *friction = problem->friction;
    const double *a = friction->column[LAC_A];
    const double *b = friction->column[LAC_B];
    const double *u = y;
    const double *w = y + problem->n;
    double folds = friction->form == LAC_FORM_REGULARISED ? -20.0 : 0.0;
    for (size_t i = 0; i < problem->n; i++) {
        if (friction->constant[i] + a[i] * u[i] + b[i] * w[i] <= folds * a[i]) {
            *cell = i;
            return false;
        }
    }
    return true;
}

bool lac_problem_jump(const lac_problem *problem, double t, double *y)
{
    lac_drive before;
    lac_drive after;
    if (!lac_problem_drive(problem, nextafter(t, -INFINITY), &before) ||
        !lac_problem_drive(problem, t, &after)) {
        return false;
    }
    double ratio = after.ratio - before.ratio;
    double spring = after.spring - before.spring;
    // A load that only bends has changed by no more than its rate times one rounding of t.
    double slack = 16.0 * (nextafter(fabs(t), INFINITY) - fabs(t));
    bool jumps = fabs(ratio) > slack * fabs(before.ratio_rate) ||
                 fabs(spring) > slack * fabs(before.spring_rate) ||
                 fabs(after.share - before.share) > slack * fabs(before.share_rate);
    if (!jumps) {
        return true;
    }
    for (size_t i = 0; i < problem->n; i++) {
        double p = problem->pressure[i];
        double w = y[problem->n + i];
        double f = lac_friction_coefficient(problem->friction, i, y[i], w);
        double held = p * before.share * f + problem->damping * exp(y[i]);
        double u = lac_friction_rate_for(problem->friction, i, w, held + p * ratio + spring,
                                         p * after.share, problem->damping);
        if (!isfinite(u)) {
            return false;
        }
        y[i] = u;
    }
    return true;
}
