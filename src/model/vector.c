// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns (slip along x, ln theta, slip along y): slip in two directions. Friction opposes the
// slip rate, and its size is that of the same law: docs/theory/vector.md. What does not know of
// directions sees sizes: |v|, |tau|.
#include "base/statistics.h"
#include "base/vsum.h"
#include "model/internal.h"

// Behind the parts of the work that all formulations have.
typedef struct plane {
    double *v[2];   // slip rate
    double *q[2];   // traction
    double *d[3];   // a cell's 2 x 2 block: xx, xy, yy
    double *net[2]; // what of the traction friction holds
    double *size;   // of net
    double *hold;   // |net|/|v|: what holds a rate that turns
    double *mean_y; // [1] as lac_workspace.mean, along y
} plane;

enum { ARRAYS = 5, PLANE = 11 };

static plane plane_of(const lac_look *at)
{
    const size_t n = at->problem->n;
    double *a = at->ws.v + ARRAYS * n;
    return (plane){.v = {a, a + n},
                   .q = {a + 2 * n, a + 3 * n},
                   .d = {a + 4 * n, a + 5 * n, a + 6 * n},
                   .net = {a + 7 * n, a + 8 * n},
                   .size = a + 9 * n,
                   .hold = a + 10 * n,
                   .mean_y = at->ws.mean + 2}; // also where no cell is here
}

// What a direction has of its own: the loads, and the tractions at the start. The rest it shares.
static lac_status make_side(const lac_problem *problem, lac_problem **out, lac_error *err)
{
    const size_t bytes = problem->n * sizeof(double);
    lac_problem *side = *out = malloc(sizeof *side);
    LAC_FAIL_MEMORY_IF(side == NULL, err);
    *side = *problem;
    side->traction0 = malloc(bytes);
    LAC_FAIL_MEMORY_IF(side->traction0 == NULL, err);
    memcpy(side->traction0, problem->traction0, bytes);
    side->loads = lac_load_set_along(&problem->loads, 0.0, 1.0);
    side->varies = false; // pore pressures know no direction
    lac_load_evaluate(&side->loads, 0.0, &side->at_start);
    return LAC_OK;
}

static void turn(lac_problem *problem, double part)
{
    for (size_t i = 0; i < problem->n; i++) {
        problem->traction0[i] *= part;
    }
    problem->sum_traction0 *= part;
}

lac_status lac_vector_init(lac_problem *problem, double heading, lac_error *err)
{
    LAC_FAIL_IF(problem->transfer.kind->pair == NULL, err, LAC_EINPUT,
                "transfer %s: knows slip along x only", problem->transfer.kind->info.name);
    LAC_FAIL_IF(
        problem->bond > 0.0 || problem->loads.shape != NULL || problem->weak != NULL, err,
        LAC_EINPUT,
        "slip in two directions knows no cohesion, no load that rock shares and no weakening");
    LAC_TRY_RETURN(make_side(problem, &problem->across, err));
    lac_problem_lay_out(problem);
    turn(problem->across, sin(heading));
    turn(problem, cos(heading));
    return LAC_OK;
}

void lac_vector_clear(lac_problem *problem)
{
    if (problem->across != NULL) {
        free(problem->across->traction0);
        free(problem->across);
    }
}

lac_look lac_look_along(const lac_look *at, int direction)
{
    lac_look side = *at;
    if (direction == 1) {
        side.problem = at->problem->across;
        (void)lac_problem_drive_into(side.problem, at->t, (lac_gone){0}, NULL, &side.drive);
    }
    return side;
}

const double *lac_vector_slip(const lac_problem *problem, const double *slip, int direction)
{
    return direction == 0 ? slip - 2 * problem->n : slip;
}

// q - K slip of every cell.
static void find_tractions(const lac_look *at, const double *slip, double *const q[2])
{
    const lac_problem *problem = at->problem;
    const size_t n = problem->n;
    const double *const of[2] = {lac_vector_slip(problem, slip, 0), slip};
    const lac_transfer *transfer = &problem->transfer;
    transfer->kind->pair->apply(transfer->state, of, q, at->ws.scratch);
    for (int c = 0; c < 2; c++) {
        const lac_look side = lac_look_along(at, c);
        const double mean = lac_problem_plain_mean(problem, of[c]);
        const double common = side.drive.spring - side.drive.spring_stiffness * mean;
        for (size_t i = 0; i < n; i++) {
            const double load =
                side.problem->traction0[i] + problem->pressure[i] * side.drive.ratio;
            q[c][i] = load + common - q[c][i];
        }
    }
}

void lac_vector_traction(const lac_look *at, const double *slip, double *traction)
{
    const plane p = plane_of(at);
    find_tractions(at, slip, p.q);
    for (size_t i = 0; i < at->problem->n; i++) {
        traction[i] = hypot(p.q[0][i], p.q[1][i]);
    }
}

static void start(const lac_problem *problem, double *x)
{
    memset(x, 0, problem->n * sizeof *x);
    memset(x + 2 * problem->n, 0, problem->n * sizeof *x);
}

// Rates where the mean rate `taken` damps them; their own is `found`.
static void rates_under(const lac_look *at, const plane *p, const double taken[2], double *u,
                        double found[2])
{
    const lac_problem *problem = at->problem;
    const size_t n = problem->n;
    for (size_t i = 0; i < n; i++) {
        const double drag = lac_problem_drag(problem, i);
        p->net[0][i] = p->q[0][i] - drag * taken[0];
        p->net[1][i] = p->q[1][i] - drag * taken[1];
        p->size[i] = hypot(p->net[0][i], p->net[1][i]);
    }
    (void)lac_problem_rates_under(at, p->size, 0.0, u);
    for (int c = 0; c < 2; c++) {
        for (size_t i = 0; i < n; i++) {
            const double part = p->size[i] != 0.0 ? p->net[c][i] / p->size[i] : 0.0;
            p->v[c][i] = at->ws.v[i] * part;
        }
        found[c] = lac_problem_plain_mean(problem, p->v[c]);
    }
}

typedef struct eases {
    const lac_look *at;
    const plane *p;
} eases;

// What drag takes off a rate: xx, xy, yy.
static void add_eases(const void *context, size_t first, size_t end, double *sums)
{
    const lac_look *at = ((const eases *)context)->at;
    const plane *p = ((const eases *)context)->p;
    const double *ease = at->ws.diagonal;
    for (size_t i = first; i < end; i++) {
        if (!(p->size[i] > 0.0)) {
            continue; // no direction, and at rest
        }
        const double x = p->net[0][i] / p->size[i], y = p->net[1][i] / p->size[i];
        const double across = lac_problem_drag(at->problem, i) * (at->ws.v[i] / p->size[i]);
        sums[0] += ease[i] * x * x + across * y * y;
        sums[1] += (ease[i] - across) * x * y;
        sums[2] += ease[i] * y * y + across * x * x;
    }
}

// Newton's step from `taken` to the mean rate that is found where it is taken: (1 + E) step =
// found - taken, E the mean over the cells of what drag takes off a rate, along it and across.
static void find_step(const lac_look *at, const plane *p, const double *u, const double off[2],
                      double step[2])
{
    const double n = lac_problem_all(at->problem);
    double sums[3];
    lac_problem_find_ease(at, u, at->ws.diagonal);
    lac_range_sums(&at->problem->range, 3, add_eases, &(eases){at, p}, sums);
    const double a = 1.0 + sums[0] / n, b = sums[1] / n, d = 1.0 + sums[2] / n;
    const double det = a * d - b * b;
    step[0] = (d * off[0] - b * off[1]) / det;
    step[1] = (a * off[1] - b * off[0]) / det;
}

// The rates whose own mean is the one that damps them. The cells' rates are gradients of convex
// functions of what is taken off them, so that there is one such mean; a step that leads away from
// it is halved.
static void rates_together(const lac_look *at, const plane *p, double *u, double mean[2])
{
    const lac_problem *problem = at->problem;
    const double linear = 2e-8; // its square is rounding
    double found[2], off[2], step[2] = {0.0, 0.0};
    double before = INFINITY;
    for (int k = 0; k < 400; k++) {
        rates_under(at, p, mean, u, found);
        off[0] = found[0] - mean[0];
        off[1] = found[1] - mean[1];
        const double left = hypot(off[0], off[1]);
        if (!isfinite(left)) {
            break;
        }
        const bool away = left > before;
        if (away) {
            step[0] *= -0.5;
            step[1] *= -0.5;
        } else {
            before = left;
            find_step(at, p, u, off, step);
        }
        mean[0] += step[0];
        mean[1] += step[1];
        const double moved = hypot(step[0], step[1]);
        step[0] = away ? -step[0] : step[0];
        step[1] = away ? -step[1] : step[1];
        const bool small =
            problem->drag * moved <= linear * problem->least_direct * at->drive.least;
        if (small || moved <= DBL_EPSILON * hypot(mean[0], mean[1])) {
            break;
        }
    }
    rates_under(at, p, mean, u, found);
    mean[0] = found[0];
    mean[1] = found[1];
}

static lac_motion move(const lac_look *at, bool keep)
{
    const lac_workspace *ws = &at->ws;
    const plane p = plane_of(at);
    double *u = keep ? ws->guess : ws->u;
    double mean[2] = {0.0, 0.0};
    find_tractions(at, at->y + 2 * at->problem->n, p.q);
    if (!keep) {
        memcpy(u, ws->guess, at->problem->n * sizeof *u);
    }
    if (at->problem->drag == 0.0) {
        rates_under(at, &p, mean, u, mean);
        return (lac_motion){.u = u, .v = ws->v, .mean = hypot(mean[0], mean[1])};
    }
    mean[0] = *ws->mean;
    mean[1] = *p.mean_y;
    rates_together(at, &p, u, mean);
    const double size = hypot(mean[0], mean[1]);
    if (keep && isfinite(size)) {
        *ws->mean = mean[0];
        *p.mean_y = mean[1];
    }
    return (lac_motion){.u = u, .v = ws->v, .mean = size};
}

static bool derivative(const lac_look *at, double *ydot)
{
    const plane p = plane_of(at);
    const size_t n = at->problem->n;
    const bool good = lac_problem_evolve(at, ydot + n);
    memcpy(ydot, p.v[0], n * sizeof *ydot);
    memcpy(ydot + 2 * n, p.v[1], n * sizeof *ydot);
    return lac_problem_agree(at->problem,
                             lac_vfinite(n, ydot) && lac_vfinite(n, ydot + 2 * n) && good);
}

// D of every cell: along its rate what lac_implicit_reduce leaves, across it |net|/(|v| gamma), for
// friction turns with the rate. The directions take the place of `net`.
static bool find_blocks(const lac_look *at, const plane *p, double gamma, double *b_w)
{
    const size_t n = at->problem->n;
    for (size_t i = 0; i < n; i++) {
        p->hold[i] = fmin(p->size[i] / at->ws.v[i], LAC_STIFFEST) / gamma;
    }
    if (!lac_implicit_reduce(at, gamma, NULL, b_w)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        const double size = p->size[i] > 0.0 ? p->size[i] : 1.0;
        const double x = p->net[0][i] /= size, y = p->net[1][i] /= size;
        const double along = at->ws.diagonal[i], across = p->hold[i];
        p->d[0][i] = along * x * x + across * y * y;
        p->d[1][i] = (along - across) * x * y;
        p->d[2][i] = along * y * y + across * x * x;
    }
    return true;
}

// What s is besides 1 acts on the mean: kappa (s - 1) 1^T/n of each direction, by Woodbury's
// formula. @param x  the solution without
static bool share_mean(const lac_look *at, const plane *p, double kappa, double *const x[2])
{
    const lac_problem *problem = at->problem;
    const lac_transfer *transfer = &problem->transfer;
    const size_t n = problem->n;
    const double k = at->drive.spring_stiffness + kappa;
    double *const of[2][2] = {{p->size, p->hold}, {p->v[0], p->v[1]}};
    double to[2][2], mean[2];
    for (int c = 0; c < 2; c++) {
        for (size_t i = 0; i < n; i++) {
            of[c][c][i] = lac_problem_share(problem, i) - 1.0;
            of[c][1 - c][i] = 0.0;
        }
        if (!transfer->kind->pair->solve(transfer->state, k, (const double *const *)p->d, of[c],
                                         at->ws.scratch)) {
            return false;
        }
        to[0][c] = kappa * lac_range_sum(&problem->range, of[c][0]) / lac_problem_all(problem);
        to[1][c] = kappa * lac_range_sum(&problem->range, of[c][1]) / lac_problem_all(problem);
        mean[c] = lac_problem_plain_mean(problem, x[c]);
    }
    const double a = 1.0 + to[0][0], d = 1.0 + to[1][1];
    const double det = a * d - to[0][1] * to[1][0];
    const double by[2] = {kappa * (d * mean[0] - to[0][1] * mean[1]) / det,
                          kappa * (a * mean[1] - to[1][0] * mean[0]) / det};
    for (int c = 0; c < 2; c++) {
        for (size_t i = 0; i < n; i++) {
            x[c][i] -= of[0][c][i] * by[0] + of[1][c][i] * by[1];
        }
    }
    return det > 0.0 && isfinite(det);
}

// (D + K + stiffness of the mean, that of its damping included) dv = x
static bool solve(const lac_look *at, const plane *p, double gamma, double *const x[2])
{
    const lac_problem *problem = at->problem;
    const lac_transfer *transfer = &problem->transfer;
    const double kappa = problem->drag * (problem->sum_pressure / lac_problem_all(problem)) / gamma;
    const bool felt = lac_problem_feels_drag(problem, at->drive.least, at->motion.mean);
    return transfer->kind->pair->solve(transfer->state, at->drive.spring_stiffness + kappa,
                                       (const double *const *)p->d, x, at->ws.scratch) &&
           (!felt || share_mean(at, p, kappa, x));
}

// x_slip = b_slip + gamma dv, x_w = back b_w + (v d ln theta/dv) (dv along the rate)
static bool newton(const lac_look *at, double gamma, double *b)
{
    const lac_workspace *ws = &at->ws;
    const lac_transfer *transfer = &at->problem->transfer;
    const plane p = plane_of(at);
    const size_t n = at->problem->n;
    double *const x[2] = {b, b + 2 * n};
    if (!find_blocks(at, &p, gamma, b + n)) {
        return false;
    }
    transfer->kind->pair->apply(transfer->state, (const double *const *)x, p.q, ws->scratch);
    for (int c = 0; c < 2; c++) {
        const double mean = at->drive.spring_stiffness * lac_problem_plain_mean(at->problem, x[c]);
        for (size_t i = 0; i < n; i++) {
            const double rhs = -(p.q[c][i] + mean + p.net[c][i] * ws->kv[i]) / gamma;
            p.q[c][i] = x[c][i];
            x[c][i] = rhs;
        }
    }
    if (!solve(at, &p, gamma, x)) {
        return false;
    }
    for (size_t i = 0; i < n; i++) {
        b[n + i] += ws->v[i] * (p.net[0][i] * x[0][i] + p.net[1][i] * x[1][i]);
        x[0][i] = p.q[0][i] + gamma * x[0][i];
        x[1][i] = p.q[1][i] + gamma * x[1][i];
    }
    return true;
}

void lac_vector_weigh(const lac_problem *problem, const double *y, double rtol, double *weight)
{
    const size_t n = problem->n;
    // The norm is a mean over the unknowns: so a run along x takes the steps of slip along x alone.
    const double thirds = sqrt(1.5);
    for (size_t i = 0; i < n; i++) {
        const double error = rtol * lac_slip_scale(problem, i);
        weight[2 * n + i] = 1.0 / fmax(error, 8.0 * DBL_EPSILON * fabs(y[2 * n + i]));
    }
    for (size_t i = 0; i < 3 * n; i++) {
        weight[i] *= thirds;
    }
}

typedef struct slips {
    const double *weight, *x; // [n] weights, NULL: all 1
} slips;

static void add_slips(const void *context, size_t first, size_t end, double *sums)
{
    const slips *s = context;
    sums[0] += s->weight == NULL ? lac_sum(end - first, s->x + first)
                                 : lac_vdot(end - first, s->weight + first, s->x + first);
}

double lac_problem_mean_slip(const lac_problem *problem, const double *slip)
{
    double along[2] = {0.0, 0.0};
    lac_range_sums(&problem->range, 1, add_slips, &(slips){problem->weight, slip}, &along[1]);
    if (problem->across != NULL) {
        const slips x = {NULL, lac_vector_slip(problem, slip, 0)};
        lac_range_sums(&problem->range, 1, add_slips, &x, &along[0]);
    }
    return (problem->across == NULL ? along[1] : hypot(along[0], along[1])) /
           lac_problem_all(problem);
}

double lac_vector_sheared(const lac_look *at, const double *slip, double along[2])
{
    for (int c = 0; c < 2; c++) {
        const lac_look side = lac_look_along(at, c);
        const double *of = lac_vector_slip(at->problem, slip, c);
        along[c] = lac_look_sheared(&side, of, lac_problem_plain_mean(at->problem, of));
    }
    return hypot(along[0], along[1]);
}

void lac_vector_unbalanced(const lac_look *at, double *residual)
{
    const lac_problem *problem = at->problem;
    const plane p = plane_of(at);
    const double mean[2] = {lac_problem_plain_mean(problem, p.v[0]),
                            lac_problem_plain_mean(problem, p.v[1])};
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        lac_block s;
        const size_t length = lac_block_friction(at, first, &s, NULL);
        for (size_t i = 0; i < length; i++) {
            const size_t k = first + i;
            const double held = lac_problem_effective(problem, &at->drive, k) * s.f[i] / s.speed[i];
            const double drag = lac_problem_drag(problem, k);
            double off[2];
            for (int c = 0; c < 2; c++) {
                off[c] = p.q[c][k] - (held + problem->damping) * p.v[c][k] - drag * mean[c];
            }
            residual[k] = hypot(off[0], off[1]);
        }
    }
}

lac_components lac_problem_components(const lac_problem *problem, const double *slip, double *work)
{
    const lac_look at = {.problem = problem, .ws = lac_problem_split(problem, work)};
    const plane p = plane_of(&at);
    return (lac_components){.slip = {lac_vector_slip(problem, slip, 0), slip},
                            .rate = {p.v[0], p.v[1]},
                            .traction = {p.q[0], p.q[1]}};
}

bool lac_problem_is_vector(const lac_problem *problem) { return problem->across != NULL; }

const double *lac_problem_slip_size(const lac_problem *problem, const double *slip, double *work)
{
    if (problem->across == NULL) {
        return slip;
    }
    const lac_look at = {.problem = problem, .ws = lac_problem_split(problem, work)};
    double *size = plane_of(&at).hold;
    const double *x = lac_vector_slip(problem, slip, 0);
    for (size_t i = 0; i < problem->n; i++) {
        size[i] = hypot(x[i], slip[i]);
    }
    return size;
}

const lac_formulation_kind lac_formulation_vector = {.id = LAC_FORMULATION_VECTOR,
                                                     .name = "vector",
                                                     .unknown = "slip",
                                                     .unknowns = 3,
                                                     .arrays = ARRAYS + PLANE,
                                                     .solved = true,
                                                     .either_sign = true,
                                                     .has_slip = true,
                                                     .start = start,
                                                     .move = move,
                                                     .derivative = derivative,
                                                     .newton = newton,
                                                     .scale = lac_slip_scales};
