// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns (ln v, ln theta): the balance differentiated in time; docs/theory/creep.md eqs. 2, 3, 5.
#include "base/clones.h"
#include "base/parallel_for.h"
#include "base/vmath.h"
#include "base/vsum.h"
#include "model/internal.h"
#include "model/weaken.h"

// What counts as v where 1/v is wanted [m/s]: exp(u) of a cell that stands still may be 0, and dv,
// which is then as good as nothing, is made dv/v again.
#define LEAST_RATE 1e-250

typedef struct speeds {
    const lac_problem *problem;
    const double *u;
    double *v;
} speeds;

static void add_speeds(const void *context, size_t from, size_t end, double *sums)
{
    const speeds *s = context;
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(end, first);
        lac_vexp(length, s->u + first, s->v + first);
        sums[0] += lac_problem_sum_from(s->problem, first, length, s->v + first);
    }
}

double lac_problem_exp_sum(const lac_problem *problem, const double *u, double *v)
{
    double sum;
    lac_range_sums(&problem->range, 1, add_speeds, &(speeds){problem, u, v}, &sum);
    return sum;
}

static void start(const lac_problem *problem, double *x)
{
    memcpy(x, problem->log_rate0, problem->n * sizeof *x);
}

static lac_motion move(const lac_look *at, bool keep)
{
    (void)keep;
    double mean = lac_problem_exp_sum(at->problem, at->y, at->ws.v) / lac_problem_all(at->problem);
    return (lac_motion){.u = at->y, .v = at->ws.v, .mean = mean};
}

// What the rates of every block are made from.
typedef struct rate_field {
    const lac_look *at; // ws.kv holds K v
    double loading;     // dq/dt that all cells have in common [Pa/s]
    double *du, *dw;    // [n]; dw NULL: not wanted
    double *ease;       // [n] by how much du/dt falls as the mean cell speeds up; NULL: not wanted
    double rise;        // dv/dt of the mean cell
    bool good[LAC_PARTS];
} rate_field;

// What all cells sum up: those that are no number, v du/dt and v ease.
enum { BAD, GAIN, LOSS };

// (p f_u + eta v) du/dt = dq/dt - f dp/dt - K v - p f_w dw/dt
// @param alike  whether all cells have the same share of their pressure left
// @param held   p f_u + eta v; overwritten
static inline __attribute__((always_inline)) void rates_of(const rate_field *field, size_t first,
                                                           size_t length, const lac_block *s,
                                                           bool alike, double *held)
{
    const lac_problem_loads_at *drive = &field->at->drive;
    const double *p = field->at->problem->pressure + first;
    const double *kv = field->at->ws.kv + first;
    double *du = field->du + first;
    const double *shares = alike ? &drive->share : drive->shares + first;
    const double *share_rates = alike ? &drive->share_rate : drive->share_rates + first;
    double share = drive->share;
    double share_rate = drive->share_rate;
    double ratio_rate = drive->ratio_rate;
    double common = field->loading;
    double eta = field->at->problem->damping;
    LAC_INDEPENDENT
    for (size_t i = 0; i < length; i++) {
        double pe = p[i] * (alike ? share : shares[i]);
        double p_rate = alike ? share_rate : share_rates[i];
        double drop = s->f[i] * p[i] * p_rate + kv[i] + pe * s->f_w[i] * s->g[i];
        double force = p[i] * ratio_rate + common - drop;
        held[i] = pe * s->f_u[i] + eta * s->speed[i];
        du[i] = force / held[i];
    }
}

LAC_CLONES static void lac_rate_rates(const rate_field *field, size_t first, size_t length,
                                      const lac_block *s, double *held)
{
    rates_of(field, first, length, s, true, held);
}

LAC_CLONES static void lac_rate_rates_apart(const rate_field *field, size_t first, size_t length,
                                            const lac_block *s, double *held)
{
    rates_of(field, first, length, s, false, held);
}

// What damping of the mean takes off the rates of a block, and what it comes from.
LAC_CLONES static void lac_rate_ease(const rate_field *field, size_t first, size_t length,
                                     const double *held, double gained[], double lost[])
{
    const double *p = field->at->problem->pressure + first;
    const double *v = field->at->motion.v + first;
    const double *du = field->du + first;
    double *ease = field->ease + first;
    double drag = field->at->problem->drag;
    LAC_INDEPENDENT
    for (size_t i = 0; i < length; i++) {
        ease[i] = drag * p[i] / held[i];
        gained[i] = v[i] * du[i];
        lost[i] = v[i] * ease[i];
    }
}

// The rates of one block of cells.
static void block_rates(const rate_field *field, size_t first, double *sums)
{
    lac_block s;
    double held[LAC_FRICTION_BLOCK];
    size_t length = lac_block_friction(field->at, first, &s, NULL);
    double *du = field->du + first;
    if (field->at->drive.shares == NULL) {
        lac_rate_rates(field, first, length, &s, held);
    } else {
        lac_rate_rates_apart(field, first, length, &s, held);
    }
    if (field->dw != NULL) {
        memcpy(field->dw + first, s.g, length * sizeof *du);
    }
    if (field->ease != NULL) { // f and f_w have been used
        lac_rate_ease(field, first, length, held, s.f, s.f_w);
        const lac_problem *problem = field->at->problem;
        sums[GAIN] += lac_problem_sum_from(problem, first, length, s.f);
        sums[LOSS] += lac_problem_sum_from(problem, first, length, s.f_w);
    }
    sums[BAD] += lac_vfinite(length, du) ? 0.0 : 1.0; // so is g, which stands in du
}

static void add_rates(const void *context, size_t from, size_t end, double *sums)
{
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        block_rates(context, first, sums);
    }
}

static bool all_good(size_t parts, const bool *good)
{
    bool all = true;
    for (size_t i = 0; i < parts; i++) {
        all = all && good[i];
    }
    return all;
}

LAC_CLONES static void lac_rate_take_off(void *context, size_t part, size_t first, size_t end)
{
    rate_field *field = context;
    double *du = field->du;
    const double *ease = field->ease;
    double rise = field->rise;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        du[i] -= rise * ease[i];
    }
    field->good[part] = lac_vfinite(end - first, du + first);
}

// K v of all cells, less what cohesion loses.
static void couple(const lac_look *at)
{
    if (at->coupled) {
        return;
    }
    lac_problem_couple(at->problem, at->drive.far_rate, at->motion.v, at->ws.kv, at->ws.scratch);
    lac_weaken_take_off(at, at->ws.kv);
}

static double loading(const lac_look *at)
{
    return at->drive.spring_rate - at->drive.spring_stiffness * at->motion.mean;
}

// d(ln v, ln theta)/dt of all cells; false where it is not finite. Damping of the mean takes g A
// off E du/dt, g the drag of a cell and A = dv/dt of the mean cell, which is the mean of v du/dt
// itself: with the du/dt that there are without,
//   A = sum of v du/dt/(n + sum of v g/E)
// @param rise  A where damping of the mean counts; else untouched
static bool find_rates(const lac_look *at, double *du, double *dw, double *rise)
{
    const lac_problem *problem = at->problem;
    rate_field field = {.at = at,
                        .loading = loading(at),
                        .du = du,
                        .dw = dw,
                        .ease = problem->drag != 0.0 ? at->ws.diagonal : NULL};
    couple(at);
    double sums[3];
    lac_range_sums(&problem->range, field.ease == NULL ? 1 : 3, add_rates, &field, sums);
    if (sums[BAD] > 0.0 || field.ease == NULL) {
        return sums[BAD] == 0.0;
    }
    field.rise = *rise = sums[GAIN] / (lac_problem_all(problem) + sums[LOSS]);
    size_t parts = lac_parallel_for(problem->n, lac_rate_take_off, &field);
    return lac_problem_agree(problem, all_good(parts, field.good));
}

static bool derivative(const lac_look *at, double *ydot)
{
    double rise;
    return find_rates(at, ydot, ydot + at->problem->n, &rise);
}

// What one solve works on.
typedef struct solve_field {
    const lac_look *at;
    double *b;
    double loading, gamma;
} solve_field;

// Rows of (1 - gamma J) x = b with ln theta eliminated; docs/theory/creep.md. The unknown is
// dv = v x_u:  (D + K) dv = rhs,  x_w = back (b_w + gamma g_u x_u). D goes to ws->diagonal, the
// right-hand side and back b_w to b; and for the way back 1/v and back gamma g_u to ws->kv and
// ws->v, whose K v and v are used up. Gives back how many rows have back <= 0.
static inline __attribute__((always_inline)) size_t
reduce_cells(const solve_field *field, size_t first, size_t length, const lac_block *s,
             const lac_block_slopes *d, bool alike)
{
    const lac_problem *problem = field->at->problem;
    const lac_problem_loads_at *drive = &field->at->drive;
    const double *pressure = problem->pressure + first;
    double *kv = field->at->ws.kv + first;
    double *v_out = field->at->ws.v + first;
    double *diagonal = field->at->ws.diagonal + first;
    double *b_u = field->b + first;
    double *b_w = field->b + problem->n + first;
    const double *shares = alike ? &drive->share : drive->shares + first;
    const double *share_rates = alike ? &drive->share_rate : drive->share_rates + first;
    double share = drive->share;
    double share_rate = drive->share_rate;
    double ratio_rate = drive->ratio_rate;
    double common = field->loading;
    double gamma = field->gamma;
    double inv_gamma = 1 / gamma;
    double eta = problem->damping;
    size_t bad = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < length; i++) {
        double p = pressure[i] * (alike ? share : shares[i]);
        double p_rate = pressure[i] * (alike ? share_rate : share_rates[i]);
        double damped = eta * s->speed[i];
        double e = p * s->f_u[i] + damped;
        double force = pressure[i] * ratio_rate + common - kv[i];
        double du = (force - s->f[i] * p_rate - p * s->f_w[i] * s->g[i]) / e;
        double n_u = -s->f_u[i] * p_rate - p * (d->f_uw[i] * s->g[i] + s->f_w[i] * d->g_u[i]);
        double n_w = -s->f_w[i] * p_rate - p * (d->f_ww[i] * s->g[i] + s->f_w[i] * d->g_w[i]);
        double a_u = n_u - du * (p * d->f_uu[i] + damped);
        double a_w = n_w - du * p * d->f_uw[i];
        double back = 1 / (1 - gamma * d->g_w[i]);
        double evolve = back * (gamma * d->g_u[i]);
        double inv_v = 1 / (s->speed[i] < LEAST_RATE ? LEAST_RATE : s->speed[i]);
        double w = back * b_w[i];
        diagonal[i] = (e * inv_gamma - a_u - a_w * evolve) * inv_v;
        b_u[i] = e * b_u[i] * inv_gamma + a_w * w;
        b_w[i] = w;
        kv[i] = inv_v;
        v_out[i] = evolve;
        bad += back > 0 ? 0 : 1;
    }
    return bad;
}

LAC_CLONES static size_t lac_rate_reduce(const solve_field *field, size_t first, size_t length,
                                         const lac_block *s, const lac_block_slopes *d)
{
    return reduce_cells(field, first, length, s, d, true);
}

LAC_CLONES static size_t lac_rate_reduce_apart(const solve_field *field, size_t first,
                                               size_t length, const lac_block *s,
                                               const lac_block_slopes *d)
{
    return reduce_cells(field, first, length, s, d, false);
}

// x_u = dv/v, x_w = b_w + slope x_u
LAC_CLONES static void lac_rate_bring_back(void *context, size_t part, size_t first, size_t end)
{
    const solve_field *field = context;
    const double *inv_v = field->at->ws.kv;
    const double *slope = field->at->ws.v;
    double *b = field->b;
    double *b_w = b + field->at->problem->n;
    (void)part;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        b[i] *= inv_v[i];
        b_w[i] += slope[i] * b[i];
    }
}

// The same where unknowns of the cells' weakening are eliminated besides; what they add is by x_u.
static bool reduce_weak(const solve_field *field, size_t first, const lac_block *s,
                        const lac_block_slopes *d)
{
    const lac_look *at = field->at;
    double diagonal[LAC_FRICTION_BLOCK], rhs[LAC_FRICTION_BLOCK];
    const lac_weak_block weak = {s, d, diagonal, rhs};
    const size_t length = lac_block_length(at->problem->n, first);
    bool good = lac_weaken_reduce(at, field->gamma, &field->loading, field->b, first, &weak);
    good = (at->drive.shares == NULL ? lac_rate_reduce(field, first, length, s, d)
                                     : lac_rate_reduce_apart(field, first, length, s, d)) == 0 &&
           good;
    for (size_t i = 0; i < length; i++) {
        at->ws.diagonal[first + i] += diagonal[i] * at->ws.kv[first + i]; // 1/v
        field->b[first + i] += rhs[i];
    }
    return good;
}

// Fills D and the right-hand side of one block. False where ln theta cannot be eliminated.
static bool reduce_block(const solve_field *field, size_t first)
{
    lac_block s;
    lac_block_slopes d;
    size_t length = lac_block_friction(field->at, first, &s, &d);
    if (field->at->problem->weak != NULL) {
        return reduce_weak(field, first, &s, &d);
    }
    return field->at->drive.shares == NULL
               ? lac_rate_reduce(field, first, length, &s, &d) == 0
               : lac_rate_reduce_apart(field, first, length, &s, &d) == 0;
}

static void add_bad(const void *context, size_t from, size_t end, double *sums)
{
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        sums[BAD] += reduce_block(context, first) ? 0.0 : 1.0;
    }
}

// What a row is over a step gamma, in the place of du/dt, and how much of b it gives the mean.
static void add_given(const void *context, size_t first, size_t end, double *sums)
{
    const solve_field *field = context;
    const lac_look *at = field->at;
    double *row = at->ws.row;
    for (size_t i = first; i < end; i++) {
        row[i] = 1.0 + field->gamma * row[i];
        sums[0] += lac_problem_weight(at->problem, i) * at->motion.v[i] * field->b[i];
    }
}

// Beside E du/dt stands g A, g the drag of a cell and A the mean of v du/dt. A step dv = v x_u
// changes A by the mean of (1/gamma + du/dt) dv - v b_u/gamma: kappa s row^T/n with
// row = 1 + gamma du/dt. What it puts on the right-hand side goes to `push`, per pressure.
// @param rise  A
static bool damp_solve(const solve_field *field, double *rise, double *push)
{
    const lac_problem *problem = field->at->problem;
    double given;
    if (!find_rates(field->at, field->at->ws.row, NULL, rise)) {
        return false;
    }
    lac_range_sums(&problem->range, 1, add_given, field, &given);
    *push = problem->drag * given / lac_problem_all(problem) / field->gamma;
    return isfinite(*push);
}

// Solves the system that reduce_block has left, for dv. Where damping of the mean is felt, 1/v
// gives its place for as long.
static bool solve(const solve_field *field, bool felt, double push)
{
    const lac_problem *problem = field->at->problem;
    const lac_workspace *ws = &field->at->ws;
    size_t n = problem->n;
    lac_sharing on = {0};
    if (felt) {
        on.kappa =
            problem->drag * (problem->sum_pressure / lac_problem_all(problem)) / field->gamma;
        on.row = ws->row;
        on.shares = ws->kv;
    }
    for (size_t i = 0; felt && i < n; i++) {
        field->b[i] += problem->pressure[i] * push;
    }
    double mean = field->at->drive.spring_stiffness + on.kappa;
    if (!lac_problem_solve_sharing(problem, mean, ws->diagonal, &on, field->b, ws->scratch)) {
        return false;
    }
    if (felt) {
        lac_vexp(n, field->at->motion.u, ws->kv);
    }
    for (size_t i = 0; felt && i < n; i++) {
        ws->kv[i] = 1.0 / (ws->kv[i] < LEAST_RATE ? LEAST_RATE : ws->kv[i]);
    }
    return true;
}

static bool newton(const lac_look *at, double gamma, double *b)
{
    size_t n = at->problem->n;
    lac_look held = *at;
    solve_field field = {.at = &held, .b = b, .gamma = gamma};
    bool felt = lac_problem_feels_drag(at->problem, at->drive.least, at->motion.mean);
    double rise = 0.0;
    double push = 0.0;
    if (!felt) {
        couple(at);
    } else if (!damp_solve(&field, &rise, &push)) {
        return false;
    }
    field.loading = loading(at);
    held.drive.ratio_rate -= at->problem->drag * rise; // it is shared as a force is

    double bad;
    lac_range_sums(&at->problem->range, 1, add_bad, &field, &bad);
    if (bad > 0.0 || !solve(&field, felt, push)) {
        return false;
    }
    (void)lac_parallel_for(n, lac_rate_bring_back, &field);
    lac_weaken_finish(at, gamma, b);
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
                                                   .jump = lac_rate_jump};
