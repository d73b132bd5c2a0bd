// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns (x, ln theta, slip) of cells that carry the mass of a block: momentum in the place of
// the balance; docs/theory/momentum.md. v = exp(x) where friction has the plain form, which knows
// v > 0 only, and v = 2 v_s sinh(x) of either sign where it is regularised.
#include "base/vmath.h"
#include "base/vsum.h"
#include "model/internal.h"
#include "model/weaken.h"

// Where regularised friction turns linear in v, less what healing may take off it: the x of a cell
// at rest then goes with its traction.
static double slow_scale(const lac_problem *problem, const lac_problem_def *def)
{
    const double healing = 20.0; // e-folds of v
    const double least = LAC_AT_REST, greatest = -10.0;
    double scale = greatest;
    for (size_t i = 0; i < def->domain->n; i++) { // ranks have no part of their own yet
        double u = def->log_rate[i];
        double a = lac_cellwise_of(&problem->friction->column[LAC_A], i);
        double f = lac_friction_plain(problem->friction, i, u, def->log_state[i]);
        scale = fmin(scale, a > 0.0 ? u - f / a - healing : least);
    }
    return exp(fmax(scale, least));
}

lac_status lac_inertia_init(lac_problem *problem, const lac_problem_def *def, lac_error *err)
{
    bool named = def->formulation == LAC_FORMULATION_INERTIA;
    LAC_FAIL_IF(def->mass == 0.0 && lac_friction_flashes(def->friction), err, LAC_EINPUT,
                "flash_rate of the friction law needs inertia: where friction falls at a given "
                "state no slip rate balances the load");
    if (def->mass == 0.0 && !named) {
        return LAC_OK;
    }
    LAC_FAIL_IF(
        !(def->mass > 0.0) || !isfinite(def->mass) || !(def->columns > 0.0 && def->columns <= 1.0),
        err, LAC_EINPUT,
        "a block of %g kg/m2 with %g of it in columns: the mass must be > 0, the part in (0, 1]",
        def->mass, def->columns);
    LAC_FAIL_IF(def->formulation != LAC_FORMULATION_AUTO && !named, err, LAC_EINPUT,
                "the formulation \"%s\" knows no inertia", problem->kind->name);
    problem->kind = &lac_formulation_inertia;
    problem->mass = def->mass * problem->spring_share;
    problem->columns = problem->range.all == 1 ? 1.0 : def->columns;
    problem->slow = problem->friction->form == LAC_FORM_PLAIN ? 0.0 : slow_scale(problem, def);
    return LAC_OK;
}

// dv/dt of a cell out of balance by `force` where the mean cell is by `mean`: the inverse of
// M = columns m diag(s) + (1 - columns) m s s^T/n, whose shares s have the mean 1.
static double acceleration(const lac_problem *problem, size_t i, double force, double mean)
{
    double m = problem->mass;
    return mean / m + (force / lac_problem_share(problem, i) - mean) / (problem->columns * m);
}

static void start(const lac_problem *problem, double *x)
{
    size_t n = problem->n;
    memcpy(x, problem->log_rate0, n * sizeof *x);
    for (size_t i = 0; problem->slow > 0.0 && i < n; i++) {
        x[i] = asinh(exp(x[i]) / (2.0 * problem->slow));
    }
    memset(x + 2 * n, 0, n * sizeof *x);
}

// v = 2 v_s sinh x and ln|v| of a block of cells. |v| is held away from 0, where ln|v| is not.
static void turn_back(double slow, size_t n, const double *x, double *u, double *v)
{
    const double least = exp(LAC_SLOWEST);
    for (size_t i = 0; i < n; i++) {
        u[i] = fabs(x[i]);
    }
    lac_vexp(n, u, v);
    for (size_t i = 0; i < n; i++) {
        double size = u[i] < 0.5 ? 2.0 * sinh(u[i]) : v[i] - 1.0 / v[i];
        size = slow * size;
        u[i] = size < least ? least : size; // a NaN stays
        v[i] = copysign(u[i], x[i]);
    }
    lac_vlog(n, u, u);
}

static void add_turned(const void *context, size_t from, size_t end, double *sums)
{
    const lac_look *at = context;
    const lac_workspace *ws = &at->ws;
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(end, first);
        turn_back(at->problem->slow, length, at->y + first, ws->u + first, ws->v + first);
        sums[0] += lac_vsum(length, ws->v + first);
    }
}

static lac_motion move(const lac_look *at, bool keep)
{
    (void)keep;
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    const double *y = at->y;
    if (problem->slow == 0.0) {
        double total = lac_problem_exp_sum(at->problem, y, ws->v);
        return (lac_motion){.u = y, .v = ws->v, .mean = total / lac_problem_all(problem)};
    }
    double total;
    lac_range_sums(&problem->range, 1, add_turned, at, &total);
    return (lac_motion){.u = ws->u, .v = ws->v, .mean = total / lac_problem_all(problem)};
}

// dv/dx
static double slope(const lac_problem *problem, double v)
{
    return problem->slow == 0.0 ? v : hypot(v, 2.0 * problem->slow);
}

// Takes what is left of a balance for none, and adds up the rest.
static void add_forces(const void *context, size_t first, size_t end, double *sums)
{
    const lac_look *at = context;
    const lac_problem *problem = at->problem;
    const double *slip = at->y + 2 * problem->n;
    double *force = at->ws.kv;
    for (size_t i = first; i < end; i++) {
        double size =
            problem->pressure[i] + fabs(problem->traction0[i]) + problem->stiffness * fabs(slip[i]);
        if (fabs(force[i]) <= 2.0 * DBL_EPSILON * size) {
            force[i] = 0.0;
        }
        sums[0] += force[i];
    }
}

// q - K slip - p f - damping of every cell, in ws.kv; gives back the mean. What is left of a
// balance is rounding and taken for none: over a small mass it would be an acceleration without
// bounds.
// @param wdot  [n] d ln theta/dt; NULL where not wanted
static double find_forces(const lac_look *at, double *wdot)
{
    const lac_problem *problem = at->problem;
    double total;
    lac_problem_elastic_traction(at, at->y + 2 * problem->n, at->ws.kv);
    lac_problem_unbalanced(at, at->ws.kv, wdot);
    lac_range_sums(&problem->range, 1, add_forces, at, &total);
    return total / lac_problem_all(problem);
}

static bool derivative(const lac_look *at, double *ydot)
{
    const lac_problem *problem = at->problem;
    size_t n = problem->n;
    double mean = find_forces(at, ydot + n);
    double check = 0.0;
    for (size_t i = 0; i < n; i++) {
        double v = at->motion.v[i];
        ydot[i] = acceleration(problem, i, at->ws.kv[i], mean) / slope(problem, v);
        ydot[2 * n + i] = v;
        check += ydot[i] * 0.0 + ydot[n + i] * 0.0 + v * 0.0;
    }
    return lac_problem_agree(problem, check == 0.0);
}

// slope = dv/dx and bend = 1 + gamma (dx/dt) (d2v/dx2)/(dv/dx) at the state.
static void linearise(const lac_look *at, double gamma)
{
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    double mean = find_forces(at, NULL);
    for (size_t i = 0; i < problem->n; i++) {
        double v = at->motion.v[i];
        ws->slope[i] = slope(problem, v);
        double rate = acceleration(problem, i, ws->kv[i], mean) / ws->slope[i];
        ws->bend[i] = 1.0 + gamma * rate * (v / ws->slope[i]);
    }
}

typedef struct pushes {
    const lac_look *at;
    double *b;
} pushes;

static void add_push(const void *context, size_t first, size_t end, double *sums)
{
    const pushes *p = context;
    for (size_t i = first; i < end; i++) {
        p->b[i] *= p->at->ws.slope[i];
        sums[0] += lac_problem_share(p->at->problem, i) * p->b[i];
    }
}

// The system for dv, in ws->diagonal and b; eq. 5 of docs/theory/momentum.md.
// @return false where ln theta cannot be eliminated
static bool reduce(const lac_look *at, double gamma, double *b)
{
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    size_t n = problem->n;
    const lac_transfer *transfer = &problem->transfer;
    double own = problem->columns * problem->mass / gamma / gamma;
    double common = (1.0 - problem->columns) * problem->mass / gamma / gamma;
    if (!lac_implicit_reduce(at, gamma, b + 2 * n, b + n)) {
        return false;
    }
    // ln|v| has been used: its place holds K b_slip.
    double held = at->drive.spring_stiffness * lac_problem_plain_mean(problem, b + 2 * n);
    transfer->kind->apply(transfer->state, b + 2 * n, ws->u, ws->scratch);
    double push;
    lac_range_sums(&problem->range, 1, add_push, &(pushes){at, b}, &push);
    push = common * push / lac_problem_all(problem);
    for (size_t i = 0; i < n; i++) {
        double s = lac_problem_share(problem, i);
        b[i] = s * (own * b[i] + push) - (ws->u[i] + held + ws->kv[i]) / gamma;
        ws->diagonal[i] += own * s * ws->bend[i];
    }
    return true;
}

// (D + K + kappa s (s bend)^T/n) dv = b
static bool solve(const lac_look *at, double gamma, double *b)
{
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    double kappa = (1.0 - problem->columns) * problem->mass / gamma / gamma;
    double mean = at->drive.spring_stiffness + kappa + problem->mean_damping / gamma;
    for (size_t i = 0; i < problem->n; i++) {
        ws->bend[i] *= lac_problem_share(problem, i);
    }
    const lac_sharing on = {.kappa = kappa,
                            .row = ws->bend,
                            .shares = ws->kv, // used up, as is
                            .ones = ws->u,
                            .column = problem->loads.geometry != NULL ? ws->row : NULL};
    return lac_problem_solve_sharing(problem, mean, ws->diagonal, &on, b, ws->scratch);
}

static bool newton(const lac_look *at, double gamma, double *b)
{
    const lac_workspace *ws = &at->ws;
    size_t n = at->problem->n;
    linearise(at, gamma);
    if (!reduce(at, gamma, b) || !solve(at, gamma, b)) {
        return false;
    }
    lac_weaken_finish(at, gamma, b);
    for (size_t i = 0; i < n; i++) {
        double dv = b[i];
        b[i] = dv / ws->slope[i];
        b[n + i] += ws->v[i] * dv;
        b[2 * n + i] += gamma * dv;
    }
    return true;
}

// v and theta have errors of their own: slip counts as the traction that it takes off, and as
// itself.
void lac_inertia_weigh_slip(const lac_problem *problem, const double *slip, double rtol,
                            double *weight)
{
    for (size_t i = 0; i < problem->n; i++) {
        double worth = lac_cellwise_of(&problem->friction->column[LAC_DC], i) + fabs(slip[i]);
        double traction = lac_implicit_traction_scale(problem, i);
        if (traction < problem->stiffness * worth) {
            worth = traction / problem->stiffness;
        }
        weight[i] = 1.0 / fmax(rtol * worth, 8.0 * DBL_EPSILON * fabs(slip[i]));
    }
}

double lac_inertia_fastest(const lac_look *at)
{
    const lac_problem *problem = at->problem;
    const double *force = at->ws.kv;
    const double felt = 1e-3; // of an e-fold of v that balances
    double fastest = 0.0;
    double mean = find_forces(at, NULL);
    for (size_t i = 0; i < problem->n; i++) {
        double rate = acceleration(problem, i, force[i], mean);
        if (fabs(force[i]) > felt * lac_implicit_traction_scale(problem, i)) {
            fastest = fmax(fastest, fabs(rate) / slope(problem, at->motion.v[i]));
        }
    }
    return fastest;
}

// Whether friction holds a cell below LAC_AT_REST. What drives it besides: traction, and the block
// that it is part of. @param mean  of find_forces
static bool holds(const lac_look *at, size_t i, double mean)
{
    const lac_problem *problem = at->problem;
    const double w = at->w[i];
    double p = lac_problem_effective(problem, &at->drive, i);
    double f = lac_friction_coefficient(problem->friction, i, at->motion.u[i], w);
    double held = copysign(p * f, at->motion.v[i]);
    double driven =
        at->ws.kv[i] + held - (1.0 - problem->columns) * lac_problem_share(problem, i) * mean;
    return fabs(driven) < p * lac_friction_coefficient(problem->friction, i, LAC_AT_REST, w);
}

bool lac_problem_rests(const lac_problem *problem, double t, const double *y, size_t *cell,
                       double *work)
{
    lac_problem_loads_at drive;
    if (problem->mass == 0.0 || !lac_problem_drive(problem, t, y, work, &drive)) {
        return false;
    }
    lac_look at;
    lac_problem_look(problem, t, y, work, &at);
    size_t i = 0;
    while (i < problem->n && !(fabs(at.motion.v[i]) < LAC_NOTHING)) {
        i++;
    }
    const size_t slow = i < problem->n ? i : SIZE_MAX;
    const size_t first = lac_problem_first_cell(problem, slow);
    if (first == SIZE_MAX) {
        return false;
    }
    const double mean = find_forces(&at, NULL);
    const bool here = slow != SIZE_MAX && first == problem->range.first + slow;
    if (!lac_team_any(problem->range.team, here && holds(&at, i, mean))) {
        return false;
    }
    *cell = first;
    return true;
}

typedef struct push_field {
    const lac_problem *problem;
    const double *force; // [n]
    double mean;
} push_field;

static void add_together(const void *context, size_t first, size_t end, double *sums)
{
    const push_field *f = context;
    for (size_t i = first; i < end; i++) {
        sums[0] +=
            lac_problem_share(f->problem, i) * acceleration(f->problem, i, f->force[i], f->mean);
    }
}

void lac_inertia_unexplained(const lac_problem *problem, double *force)
{
    size_t n = problem->n;
    double mean = lac_problem_plain_mean(problem, force);
    double together;
    lac_range_sums(&problem->range, 1, add_together, &(push_field){problem, force, mean},
                   &together);
    together *= (1.0 - problem->columns) / lac_problem_all(problem);
    for (size_t i = 0; i < n; i++) {
        double alone = problem->columns * acceleration(problem, i, force[i], mean);
        force[i] -= problem->mass * lac_problem_share(problem, i) * (alone + together);
    }
}

const lac_formulation_kind lac_formulation_inertia = {.id = LAC_FORMULATION_INERTIA,
                                                      .name = "inertia",
                                                      .unknown = "slip rate",
                                                      .unknowns = 3,
                                                      .arrays = 6,
                                                      .either_sign = true,
                                                      .has_slip = true,
                                                      .start = start,
                                                      .move = move,
                                                      .derivative = derivative,
                                                      .newton = newton};
