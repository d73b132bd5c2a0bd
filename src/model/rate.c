// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns (ln v, ln theta): the balance differentiated in time; docs/theory/creep.md eqs. 2, 3, 5.
#include <math.h>
#include <string.h>

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

static void start(const lac_problem *problem, double *x)
{
    memcpy(x, problem->log_rate0, problem->n * sizeof *x);
}

static lac_motion move(const lac_problem *problem, const lac_drive *drive, const double *y,
                       const lac_workspace *ws, bool keep)
{
    (void)drive;
    (void)keep;
    double mean = lac_problem_exp_sum(problem->n, y, ws->v) / (double)problem->n;
    return (lac_motion){.u = y, .v = ws->v, .mean = mean};
}

// What the rates of every block are made from.
typedef struct rate_field {
    const lac_motion *motion;
    const double *w, *kv; // [n] ln theta, K v
    double loading;       // dq/dt that all cells have in common [Pa/s]
    double *ydot;
} rate_field;

// The rates of one block of cells. Gives back 0 where all are finite, NaN elsewhere.
static double block_rates(const lac_problem *problem, const lac_drive *drive,
                          const rate_field *field, size_t first)
{
    lac_block s;
    size_t length = lac_block_friction(problem, drive, field->motion, field->w, first, &s, NULL);
    const double *p = problem->pressure + first;
    const double *kv = field->kv + first;
    double *du = field->ydot + first;
    double *dw = field->ydot + problem->n + first;
    double check = 0.0;

    // (p f_u + eta v) du/dt = dq/dt - f dp/dt - K v - p f_w dw/dt
    for (size_t i = 0; i < length; i++) {
        double pe = p[i] * drive->share;
        double drop = s.f[i] * p[i] * drive->share_rate + kv[i] + pe * s.f_w[i] * s.g[i];
        double force = p[i] * drive->ratio_rate + field->loading - drop;
        du[i] = force / (pe * s.f_u[i] + problem->damping * s.speed[i]);
        dw[i] = s.g[i];
        check += du[i] * 0.0 + dw[i] * 0.0;
    }
    return check;
}

static bool derivative(const lac_problem *problem, const lac_drive *drive, const double *y,
                       double *ydot, const lac_workspace *ws)
{
    lac_motion motion = move(problem, drive, y, ws, true);
    lac_problem_couple(problem, drive->far_rate, motion.v, ws->kv, ws->scratch);
    rate_field field = {.motion = &motion,
                        .w = y + problem->n,
                        .kv = ws->kv,
                        .loading = drive->spring_rate - drive->spring_stiffness * motion.mean,
                        .ydot = ydot};
    double check = 0.0;
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        check += block_rates(problem, drive, &field, first);
    }
    return check == 0.0;
}

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

// What one solve works on.
typedef struct solve_field {
    const lac_motion *motion;
    const double *w;
    const lac_workspace *ws;
    double *b;
    double loading, gamma;
} solve_field;

// Fills D and the right-hand side of one block. False where ln theta cannot be eliminated.
static bool reduce_block(const lac_problem *problem, const lac_drive *drive,
                         const solve_field *field, size_t first)
{
    size_t n = problem->n;
    const lac_workspace *ws = field->ws;
    lac_block s;
    lac_block_slopes d;
    size_t length = lac_block_friction(problem, drive, field->motion, field->w, first, &s, &d);
    bool good = true;
    for (size_t i = 0; i < length; i++) {
        size_t k = first + i;
        double p = problem->pressure[k];
        cell_point c = {.p = p * drive->share,
                        .p_rate = p * drive->share_rate,
                        .v = s.speed[i],
                        .eta = problem->damping,
                        .gamma = field->gamma,
                        .force = p * drive->ratio_rate + field->loading - ws->kv[k],
                        .b_u = field->b[k],
                        .b_w = field->b[n + k]};
        cell_row row = reduce(&c, &s, &d, i);
        good = good && row.back > 0.0;
        ws->diagonal[k] = row.diagonal;
        field->b[k] = row.rhs;
        field->b[n + k] = row.back * c.b_w;
        // Back-substitution: x_u = dv/v, x_w = b_w + slope x_u; 1/v and slope take the place of
        // K v and v, which are used up.
        ws->kv[k] = 1.0 / c.v;
        ws->v[k] = row.back * row.evolve;
    }
    return good;
}

static bool newton(const lac_problem *problem, const lac_drive *drive, const double *y,
                   double gamma, double *b, const lac_workspace *ws)
{
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    lac_motion motion = move(problem, drive, y, ws, true);
    lac_problem_couple(problem, drive->far_rate, motion.v, ws->kv, ws->scratch);
    solve_field field = {.motion = &motion, .w = y + n, .ws = ws, .b = b, .gamma = gamma};
    field.loading = drive->spring_rate - drive->spring_stiffness * motion.mean;

    bool good = true;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        good = reduce_block(problem, drive, &field, first) && good;
    }
    if (!good || !transfer->kind->solve(transfer->state, drive->spring_stiffness, ws->diagonal, b,
                                        b, ws->scratch)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        b[i] *= ws->kv[i];
        b[n + i] += ws->v[i] * b[i];
    }
    return true;
}

static double scale(const lac_problem *problem, size_t cell)
{
    (void)problem;
    (void)cell;
    return 1.0;
}

static bool jump(const lac_problem *problem, const lac_jump *jump, double *y)
{
    for (size_t i = 0; i < problem->n; i++) {
        double p = problem->pressure[i];
        double w = y[problem->n + i];
        double f = lac_friction_coefficient(problem->friction, i, y[i], w);
        double held = p * jump->share_before * f + problem->damping * exp(y[i]);
        w = lac_friction_state_after(problem->friction, i, w,
                                     jump->share_after / jump->share_before);
        double u = lac_friction_rate_for(problem->friction, i, w,
                                         held + lac_problem_gain(problem, jump, i),
                                         p * jump->share_after, problem->damping);
        if (!isfinite(u)) {
            return false;
        }
        y[i] = u;
    }
    return true;
}

const lac_formulation_kind lac_formulation_rate = {.id = LAC_FORMULATION_RATE,
                                                   .name = "rate",
                                                   .unknown = "ln v",
                                                   .unknowns = 2,
                                                   .arrays = 3,
                                                   .start = start,
                                                   .move = move,
                                                   .derivative = derivative,
                                                   .newton = newton,
                                                   .scale = scale,
                                                   .jump = jump};
