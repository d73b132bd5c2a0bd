// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>

#include "base/vmath.h"
#include "model/internal.h"

double lac_problem_exp_sum(size_t n, const double *u, double *v)
{
    double total = 0.0;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(n, first);
        lac_vexp(length, u + first, v + first);
        double part = 0.0;
        for (size_t i = first; i < first + length; i++) {
            part += v[i];
        }
        total += part;
    }
    return total;
}

void lac_problem_rates(const lac_problem *problem, const double *y, double *v)
{
    lac_vexp(problem->n, y, v);
}

// What the rates of every block are made from.
typedef struct rate_field {
    const double *y;
    const double *v, *kv; // [n] slip rate, K (v - that of the rock around)
    double loading;       // dq/dt that all cells have in common [Pa/s]
    double *ydot;
} rate_field;

// The rates of one block of cells. Gives back 0 where all are finite, NaN elsewhere.
static double block_rates(const lac_problem *problem, const lac_drive *drive,
                          const rate_field *field, size_t first)
{
    lac_block s;
    lac_friction_values values = lac_block_values(&s);
    lac_friction_cells cells = lac_block_cells(problem->n, first, field->y, field->v);
    const double *p = problem->pressure + first;
    const double *v = field->v + first;
    const double *kv = field->kv + first;
    double *du = field->ydot + first;
    double *dw = field->ydot + problem->n + first;
    double check = 0.0;

    lac_friction_evaluate(problem->friction, &cells, &values, NULL);
    // (p f_u + eta v) du/dt = dq/dt - f dp/dt - K v - p f_w dw/dt
    for (size_t i = 0; i < cells.n; i++) {
        double pe = p[i] * drive->share;
        double drop = s.f[i] * p[i] * drive->share_rate + kv[i] + pe * s.f_w[i] * s.g[i];
        double force = p[i] * drive->ratio_rate + field->loading - drop;
        du[i] = force / (pe * s.f_u[i] + problem->damping * v[i]);
        dw[i] = s.g[i];
        check += du[i] * 0.0 + dw[i] * 0.0;
    }
    return check;
}

bool lac_problem_derivative(const lac_problem *problem, double t, const double *y, double *ydot,
                            double *work)
{
    size_t n = problem->n;
    double *v = work;
    double *kv = work + n;
    lac_drive drive;
    if (!lac_problem_drive(problem, t, &drive)) {
        return false;
    }
    double mean = lac_problem_exp_sum(n, y, v) / (double)n;
    lac_problem_couple(problem, drive.back_rate, v, kv, work + 3 * n);
    double loading = drive.spring_rate - drive.spring_stiffness * mean;
    rate_field field = {.y = y, .v = v, .kv = kv, .loading = loading, .ydot = ydot};

    double check = 0.0;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        check += block_rates(problem, &drive, &field, first);
    }
    return check == 0.0;
}

double lac_problem_first_step(const lac_problem *problem, const double *y)
{
    size_t n = problem->n;
    double fastest = 0.0;
    double v[LAC_FRICTION_BLOCK];
    lac_block s;
    lac_friction_values values = lac_block_values(&s);
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(n, first);
        lac_vexp(length, y + first, v);
        lac_friction_cells cells = {first, length, y + first, y + n + first, v};
        lac_friction_evaluate(problem->friction, &cells, &values, NULL);
        for (size_t i = 0; i < length; i++) {
            double slip = v[i] * problem->friction->inv_dc[first + i];
            fastest = fmax(fastest, fmax(fabs(s.g[i]), slip));
        }
    }
    return 1e-3 / fastest;
}
