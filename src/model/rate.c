// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns (ln v, ln theta): the balance differentiated in time; docs/theory/creep.md eqs. 2, 3, 5.
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/clones.h"
#include "base/parts.h"
#include "base/vmath.h"
#include "base/vsum.h"
#include "model/internal.h"

typedef struct speeds {
    const double *u;
    double *v;
    double sum[LAC_PARTS];
} speeds;

static void add_speeds(void *context, size_t part, size_t from, size_t end)
{
    speeds *s = context;
    double total = 0.0;
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(end, first);
        lac_vexp(length, s->u + first, s->v + first);
        total += lac_vsum(length, s->v + first);
    }
    s->sum[part] = total;
}

double lac_problem_exp_sum(size_t n, const double *u, double *v)
{
    speeds s = {.u = u, .v = v};
    size_t parts = lac_parts_run(n, add_speeds, &s);
    return lac_parts_sum(parts, s.sum);
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
    double *held; // [n] p f_u + eta v; NULL: not wanted
    const lac_problem *problem;
    const lac_drive *drive;
    bool good[LAC_PARTS];
} rate_field;

// (p f_u + eta v) du/dt = dq/dt - f dp/dt - K v - p f_w dw/dt
LAC_CLONES static void lac_rate_rates(const lac_problem *problem, const lac_drive *drive,
                                      const rate_field *field, size_t first, size_t length,
                                      const lac_block *s)
{
    const double *p = problem->pressure + first;
    const double *kv = field->kv + first;
    double *du = field->ydot + first;
    double share = drive->share;
    double share_rate = drive->share_rate;
    double ratio_rate = drive->ratio_rate;
    double loading = field->loading;
    double eta = problem->damping;
    LAC_INDEPENDENT
    for (size_t i = 0; i < length; i++) {
        double pe = p[i] * share;
        double drop = s->f[i] * p[i] * share_rate + kv[i] + pe * s->f_w[i] * s->g[i];
        double force = p[i] * ratio_rate + loading - drop;
        du[i] = force / (pe * s->f_u[i] + eta * s->speed[i]);
    }
}

// p f_u + eta v
LAC_CLONES static void lac_rate_held(const lac_problem *problem, const lac_drive *drive,
                                     size_t first, size_t length, const lac_block *s, double *held)
{
    const double *p = problem->pressure + first;
    double share = drive->share;
    double eta = problem->damping;
    LAC_INDEPENDENT
    for (size_t i = 0; i < length; i++) {
        held[i] = p[i] * share * s->f_u[i] + eta * s->speed[i];
    }
}

// The rates of one block of cells; false where one is not finite.
static bool block_rates(const lac_problem *problem, const lac_drive *drive, const rate_field *field,
                        size_t first)
{
    lac_block s;
    size_t length = lac_block_friction(problem, drive, field->motion, field->w, first, &s, NULL);
    double *du = field->ydot + first;
    double *dw = field->ydot + problem->n + first;
    lac_rate_rates(problem, drive, field, first, length, &s);
    if (field->held != NULL) {
        lac_rate_held(problem, drive, first, length, &s, field->held + first);
    }
    memcpy(dw, s.g, length * sizeof *dw);
    return lac_vfinite(length, du) && lac_vfinite(length, dw);
}

static void part_rates(void *context, size_t part, size_t from, size_t end)
{
    rate_field *field = context;
    field->good[part] = true;
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        bool good = block_rates(field->problem, field->drive, field, first);
        field->good[part] = good && field->good[part];
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

// Damping of the mean takes eta_m A off E du/dt, A = dv/dt of the mean cell, which is the mean of
// v du/dt itself: with the du/dt that there are without,
//   A = sum of v du/dt/(n + eta_m sum of v/E)
static double damp_mean(const lac_problem *problem, const rate_field *field)
{
    size_t n = problem->n;
    double damped = problem->mean_damping;
    const double *v = field->motion->v;
    double gain = 0.0;
    double ease = 0.0;
    for (size_t i = 0; i < n; i++) {
        gain += v[i] * field->ydot[i];
        ease += v[i] / field->held[i];
    }
    double rise = gain / ((double)n + damped * ease);
    for (size_t i = 0; i < n; i++) {
        field->ydot[i] -= damped * rise / field->held[i];
    }
    return rise;
}

// d(ln v, ln theta)/dt in ydot [2n]; false where it is not finite. @param rise  dv/dt of the mean
// cell, where its damping counts; else untouched
static bool find_rates(const lac_problem *problem, const lac_drive *drive, const lac_motion *motion,
                       const double *w, const lac_workspace *ws, double *ydot, double *rise)
{
    bool damped = problem->mean_damping != 0.0;
    lac_problem_couple(problem, drive->far_rate, motion->v, ws->kv, ws->scratch);
    rate_field field = {.motion = motion,
                        .w = w,
                        .kv = ws->kv,
                        .loading = drive->spring_rate - drive->spring_stiffness * motion->mean,
                        .ydot = ydot,
                        .held = damped ? ws->diagonal : NULL,
                        .problem = problem,
                        .drive = drive};
    size_t parts = lac_parts_run(problem->n, part_rates, &field);
    bool good = all_good(parts, field.good);
    if (damped && good) {
        *rise = damp_mean(problem, &field);
        good = lac_vfinite(problem->n, ydot);
    }
    return good;
}

static bool derivative(const lac_problem *problem, const lac_drive *drive, const double *y,
                       double *ydot, const lac_workspace *ws)
{
    double rise;
    lac_motion motion = move(problem, drive, y, ws, true);
    return find_rates(problem, drive, &motion, y + problem->n, ws, ydot, &rise);
}

// What one solve works on.
typedef struct solve_field {
    const lac_motion *motion;
    const double *w;
    const lac_workspace *ws;
    double *b;
    double loading, gamma;
    const lac_problem *problem;
    const lac_drive *drive;
    bool good[LAC_PARTS];
} solve_field;

// Rows of (1 - gamma J) x = b with ln theta eliminated; docs/theory/creep.md. The unknown is
// dv = v x_u:  (D + K) dv = rhs,  x_w = back (b_w + gamma g_u x_u). D goes to ws->diagonal, the
// right-hand side and back b_w to b; and for the way back 1/v and back gamma g_u to ws->kv and
// ws->v, whose K v and v are used up. Gives back how many rows have back <= 0.
LAC_CLONES static size_t lac_rate_reduce(const lac_problem *problem, const lac_drive *drive,
                                         const solve_field *field, size_t first, size_t length,
                                         const lac_block *s, const lac_block_slopes *d)
{
    const double *pressure = problem->pressure + first;
    double *kv = field->ws->kv + first;
    double *v_out = field->ws->v + first;
    double *diagonal = field->ws->diagonal + first;
    double *b_u = field->b + first;
    double *b_w = field->b + problem->n + first;
    double share = drive->share;
    double share_rate = drive->share_rate;
    double ratio_rate = drive->ratio_rate;
    double loading = field->loading;
    double gamma = field->gamma;
    double inv_gamma = 1 / gamma;
    double eta = problem->damping;
    size_t bad = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < length; i++) {
        double p = pressure[i] * share;
        double p_rate = pressure[i] * share_rate;
        double damped = eta * s->speed[i];
        double e = p * s->f_u[i] + damped;
        double force = pressure[i] * ratio_rate + loading - kv[i];
        double du = (force - s->f[i] * p_rate - p * s->f_w[i] * s->g[i]) / e;
        double n_u = -s->f_u[i] * p_rate - p * (d->f_uw[i] * s->g[i] + s->f_w[i] * d->g_u[i]);
        double n_w = -s->f_w[i] * p_rate - p * (d->f_ww[i] * s->g[i] + s->f_w[i] * d->g_w[i]);
        double a_u = n_u - du * (p * d->f_uu[i] + damped);
        double a_w = n_w - du * p * d->f_uw[i];
        double back = 1 / (1 - gamma * d->g_w[i]);
        double evolve = back * (gamma * d->g_u[i]);
        double inv_v = 1 / s->speed[i];
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

// x_u = dv/v, x_w = b_w + slope x_u
LAC_CLONES static void lac_rate_bring_back(void *context, size_t part, size_t first, size_t end)
{
    const solve_field *field = context;
    const double *inv_v = field->ws->kv;
    const double *slope = field->ws->v;
    double *b = field->b;
    double *b_w = b + field->problem->n;
    (void)part;
    LAC_INDEPENDENT
    for (size_t i = first; i < end; i++) {
        b[i] *= inv_v[i];
        b_w[i] += slope[i] * b[i];
    }
}

// Fills D and the right-hand side of one block. False where ln theta cannot be eliminated.
static bool reduce_block(const lac_problem *problem, const lac_drive *drive,
                         const solve_field *field, size_t first)
{
    lac_block s;
    lac_block_slopes d;
    size_t length = lac_block_friction(problem, drive, field->motion, field->w, first, &s, &d);
    return lac_rate_reduce(problem, drive, field, first, length, &s, &d) == 0;
}

static void reduce_part(void *context, size_t part, size_t from, size_t end)
{
    solve_field *field = context;
    field->good[part] = true;
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        bool good = reduce_block(field->problem, field->drive, field, first);
        field->good[part] = good && field->good[part];
    }
}

// What damping of the mean adds to a Newton solve.
typedef struct mean_term {
    double rise;  // dv/dt of the mean cell [m/s2]
    double stiff; // stiffness of the mean [Pa/m]
    double push;  // on the right-hand side [Pa/s]
} mean_term;

// Beside E du/dt stands eta_m A, A the mean of v du/dt. A step dv = v x_u changes A by the mean of
// (1/gamma + du/dt) dv - v b_u/gamma. With du/dt that of the mean cell that is a stiffness of the
// mean; what each cell's is besides goes to ws->lean.
static bool damp_solve(const lac_problem *problem, const lac_drive *drive, const lac_motion *motion,
                       const solve_field *field, mean_term *out)
{
    size_t n = problem->n;
    double damped = problem->mean_damping;
    double *lean = field->ws->lean;
    *out = (mean_term){0};
    if (damped == 0.0) {
        return true;
    }
    if (!find_rates(problem, drive, motion, field->w, field->ws, lean, &out->rise)) {
        return false;
    }
    double common = out->rise / motion->mean;
    double given = 0.0;
    for (size_t i = 0; i < n; i++) {
        lean[i] = damped * (lean[i] - common);
        given += motion->v[i] * field->b[i];
    }
    out->stiff = damped * (1.0 / field->gamma + common);
    out->push = damped * given / (double)n / field->gamma;
    return isfinite(out->stiff) && isfinite(out->push);
}

static bool newton(const lac_problem *problem, const lac_drive *drive, const double *y,
                   double gamma, double *b, const lac_workspace *ws)
{
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    bool damped = problem->mean_damping != 0.0;
    lac_motion motion = move(problem, drive, y, ws, true);
    solve_field field = {.motion = &motion,
                         .w = y + n,
                         .ws = ws,
                         .b = b,
                         .gamma = gamma,
                         .problem = problem,
                         .drive = drive};
    mean_term term;
    if (!damp_solve(problem, drive, &motion, &field, &term)) {
        return false;
    }
    if (!damped) { // else it has been done
        lac_problem_couple(problem, drive->far_rate, motion.v, ws->kv, ws->scratch);
    }
    field.loading = drive->spring_rate - drive->spring_stiffness * motion.mean;
    field.loading -= problem->mean_damping * term.rise;

    size_t parts = lac_parts_run(n, reduce_part, &field);
    if (!all_good(parts, field.good)) {
        return false;
    }
    double mean = drive->spring_stiffness + term.stiff;
    for (size_t i = 0; damped && i < n; i++) {
        b[i] += term.push;
    }
    bool solved =
        damped ? lac_problem_solve_leaning(problem, mean, ws->diagonal, ws->lean, b, ws->scratch)
               : transfer->kind->solve(transfer->state, mean, ws->diagonal, b, b, ws->scratch);
    if (!solved) {
        return false;
    }
    (void)lac_parts_run(n, lac_rate_bring_back, &field);
    return true;
}

static double scale(const lac_problem *problem, size_t cell)
{
    (void)problem;
    (void)cell;
    return 1.0;
}

// A jump of the loads, and the mean rate before it.
typedef struct leap {
    const lac_jump *jump;
    const double *y;
    double before; // [m/s]; 0 where it does not count
} leap;

// ln v of cell i behind it, and ln theta, if the mean rate is `mean` then.
static double rate_behind(const lac_problem *problem, const leap *at, size_t i, double mean,
                          double *w)
{
    const lac_jump *jump = at->jump;
    double p = problem->pressure[i];
    double u = at->y[i];
    double f = lac_friction_coefficient(problem->friction, i, u, at->y[problem->n + i]);
    double held = p * jump->share_before * f + problem->damping * exp(u);
    double drag = problem->mean_damping * (mean - at->before);
    *w = lac_friction_state_after(problem->friction, i, at->y[problem->n + i],
                                  jump->share_after / jump->share_before);
    return lac_friction_rate_for(problem->friction, i, *w,
                                 held + lac_problem_gain(problem, jump, i) - drag,
                                 p * jump->share_after, problem->damping);
}

// Sums over a block of v behind the jump and of dv/dtau. A cell that finds no rate under so much
// drag stands still.
static void sum_behind(const lac_problem *problem, const leap *at, double mean, size_t first,
                       double sums[2])
{
    double u[LAC_FRICTION_BLOCK], w[LAC_FRICTION_BLOCK], v[LAC_FRICTION_BLOCK];
    double ease[LAC_FRICTION_BLOCK];
    size_t length = lac_block_length(problem->n, first);
    for (size_t i = 0; i < length; i++) {
        u[i] = rate_behind(problem, at, first + i, mean, &w[i]);
        u[i] = isnan(u[i]) ? LAC_SLOWEST : u[i];
        v[i] = exp(u[i]);
    }
    const lac_friction_cells cells = {.first = first, .n = length, .u = u, .w = w, .v = v};
    lac_block_ease(problem, at->jump->share_after, &cells, ease);
    sums[0] += lac_vsum(length, v);
    sums[1] += lac_vsum(length, ease);
}

// The mean rate behind the jump, which damps all cells.
static double mean_behind(const lac_problem *problem, const leap *at)
{
    double n = (double)problem->n;
    lac_mean_search search = lac_mean_search_from(at->before);
    for (int k = 0; k < 200; k++) {
        double sums[2] = {0.0, 0.0};
        for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
            sum_behind(problem, at, search.mean, first, sums);
        }
        double moved =
            lac_mean_search_on(&search, sums[0] / n, problem->mean_damping * sums[1] / n);
        if (!(fabs(moved) > DBL_EPSILON * fabs(search.mean))) {
            break;
        }
    }
    return search.mean;
}

static bool jump(const lac_problem *problem, const lac_jump *jump, double *y)
{
    leap at = {.jump = jump, .y = y};
    double mean = 0.0;
    if (problem->mean_damping != 0.0) {
        for (size_t i = 0; i < problem->n; i++) {
            at.before += exp(y[i]) / (double)problem->n;
        }
        mean = mean_behind(problem, &at);
    }
    for (size_t i = 0; i < problem->n; i++) {
        double w;
        double u = rate_behind(problem, &at, i, mean, &w);
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
