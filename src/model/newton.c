// SPDX-License-Identifier: GPL-3.0-or-later
#include "model/internal.h"

// One cell's row of (1 - gamma J) x = b with ln theta eliminated; docs/theory/creep.md.
typedef struct cell_row {
    double diagonal; // D: the unknown is dv = v x_u, (D + K) dv = rhs
    double rhs;
    double back;   // x_w = back (b_w + gamma g_u x_u)
    double evolve; // gamma g_u
} cell_row;

// What the reduction of one cell needs besides its friction.
typedef struct cell_point {
    double p, p_rate; // effective normal pressure and its rate
    double v, eta, gamma;
    double force; // dq/dt - K v of the cell
    double b_u, b_w;
} cell_point;

static cell_row reduce(const cell_point *c, const lac_block *s, const lac_block_slopes *d, size_t i)
{
    double e = c->p * s->f_u[i] + c->eta * c->v;
    double du = (c->force - s->f[i] * c->p_rate - c->p * s->f_w[i] * s->g[i]) / e;
    double n_u = -s->f_u[i] * c->p_rate - c->p * (d->f_uw[i] * s->g[i] + s->f_w[i] * d->g_u[i]);
    double n_w = -s->f_w[i] * c->p_rate - c->p * (d->f_ww[i] * s->g[i] + s->f_w[i] * d->g_w[i]);
    double a_u = n_u - du * (c->p * d->f_uu[i] + c->eta * c->v);
    double a_w = n_w - du * c->p * d->f_uw[i];

    cell_row row;
    row.back = 1.0 / (1.0 - c->gamma * d->g_w[i]);
    row.evolve = c->gamma * d->g_u[i];
    row.diagonal = (e / c->gamma - a_u - a_w * row.evolve * row.back) / c->v;
    row.rhs = e * c->b_u / c->gamma + a_w * row.back * c->b_w;
    return row;
}

// The arrays of one solve, [n] each but y and b, [2n].
typedef struct solve_field {
    const double *y;
    double *v, *kv, *diagonal, *b;
    double loading, gamma;
} solve_field;

// Fills D and the right-hand side of one block. False where ln theta cannot be eliminated.
static bool reduce_block(const lac_problem *problem, const lac_drive *drive,
                         const solve_field *field, size_t first)
{
    size_t n = problem->n;
    lac_block s;
    lac_block_slopes d;
    lac_friction_values values = lac_block_values(&s);
    lac_friction_slopes slopes = lac_block_slope_arrays(&d);
    lac_friction_cells cells = lac_block_cells(n, first, field->y, field->v);
    lac_friction_evaluate(problem->friction, &cells, &values, &slopes);
    bool good = true;
    for (size_t i = 0; i < cells.n; i++) {
        size_t k = first + i;
        double p = problem->pressure[k];
        cell_point c = {.p = p * drive->share,
                        .p_rate = p * drive->share_rate,
                        .v = field->v[k],
                        .eta = problem->damping,
                        .gamma = field->gamma,
                        .force = p * drive->ratio_rate + field->loading - field->kv[k],
                        .b_u = field->b[k],
                        .b_w = field->b[n + k]};
        cell_row row = reduce(&c, &s, &d, i);
        good = good && row.back > 0.0;
        field->diagonal[k] = row.diagonal;
        field->b[k] = row.rhs;
        field->b[n + k] = row.back * c.b_w;
        // Back-substitution: x_u = dv/v, x_w = b_w + slope x_u; 1/v and slope take the place of
        // K v and v, which are used up.
        field->kv[k] = 1.0 / c.v;
        field->v[k] = row.back * row.evolve;
    }
    return good;
}

bool lac_problem_newton(const lac_problem *problem, double t, const double *y, double gamma,
                        double *b, double *work)
{
    size_t n = problem->n;
    double *scratch = work + 3 * n;
    const lac_transfer *transfer = &problem->transfer;
    solve_field field = {
        .y = y, .v = work, .kv = work + n, .diagonal = work + 2 * n, .b = b, .gamma = gamma};
    lac_drive drive;
    if (!lac_problem_drive(problem, t, &drive)) {
        return false;
    }
    double mean = lac_problem_exp_sum(n, y, field.v) / (double)n;
    lac_problem_couple(problem, drive.back_rate, field.v, field.kv, scratch);
    field.loading = drive.spring_rate - drive.spring_stiffness * mean;

    bool good = true;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        good = reduce_block(problem, &drive, &field, first) && good;
    }
    if (!good || !transfer->kind->solve(transfer->state, drive.spring_stiffness, field.diagonal, b,
                                        b, scratch)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        b[i] *= field.kv[i];
        b[n + i] += field.v[i] * b[i];
    }
    return true;
}
