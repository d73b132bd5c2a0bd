// SPDX-License-Identifier: GPL-3.0-or-later
// The table of formulations, and what those that solve for the rate have in common: rates that
// carry given tractions (docs/theory/creep.md eq. 6), and Newton's system with ln theta and the
// balance eliminated beforehand (eq. 8).
#include "base/clones.h"
#include "base/vsum.h"
#include "model/internal.h"
#include "model/weaken.h"

static const lac_formulation_kind *const kinds[] = {
    &lac_formulation_rate,    &lac_formulation_traction, &lac_formulation_slip,
    &lac_formulation_inertia, &lac_formulation_vector,
};

const lac_formulation_kind *lac_formulation_kind_of(lac_formulation id)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (kinds[i]->id == id) {
            return kinds[i];
        }
    }
    return &lac_formulation_rate;
}

const char *lac_formulation_name(lac_formulation formulation)
{
    return lac_formulation_kind_of(formulation)->name;
}

// Arrays of n that a matrix needs where the mean is damped, if slip is no unknown, or where the
// base bends, if it is.
static size_t leaning(const lac_problem *problem)
{
    const bool damped = problem->drag != 0.0 && !problem->kind->has_slip;
    return damped || problem->loads.geometry != NULL ? 1 : 0;
}

void lac_problem_lay_out(lac_problem *problem)
{
    const lac_transfer *transfer = &problem->transfer;
    const size_t scratch = problem->across != NULL ? transfer->kind->pair->work(transfer->state)
                                                   : transfer->kind->work(transfer->state);
    problem->scratch = (problem->kind->arrays + leaning(problem)) * problem->n;
    problem->mean = problem->scratch + scratch;
    problem->weakens = problem->mean + 3 + (problem->varies ? 4 * problem->n : 0);
}

size_t lac_problem_work(const lac_problem *problem)
{
    return problem->weakens + lac_weaken_work(problem);
}

void lac_problem_forget(const lac_problem *problem, double *work)
{
    if (problem->kind->solved) {
        lac_workspace ws = lac_problem_split(problem, work);
        memset(ws.guess, 0, (problem->kind->arrays - 4) * problem->n * sizeof *work);
        ws.mean[0] = ws.mean[2] = 0.0;
    }
}

// A block of cells from `first` on. @param speed  room for |v|; NULL: nothing needs it
// @param rates  [LAC_FRICTION_BLOCK] d ln(pressure)/dt of these cells, where each has its own
static inline lac_friction_cells cells_from(const lac_look *at, size_t first, double *speed,
                                            double *rates)
{
    const lac_problem_loads_at *drive = &at->drive;
    size_t length = lac_block_length(at->problem->n, first);
    bool apart = drive->shares != NULL && at->problem->friction->response.value != NULL;
    for (size_t i = 0; apart && i < length; i++) {
        rates[i] = drive->share_rates[first + i] / drive->shares[first + i];
    }
    const double *v = at->motion.v + first;
    if (speed != NULL && at->problem->kind->either_sign) {
        lac_vabs(length, v, speed);
        v = speed;
    }
    return (lac_friction_cells){.first = first,
                                .n = length,
                                .u = at->motion.u + first,
                                .w = at->w + first,
                                .v = speed != NULL ? v : NULL,
                                .normal_rate = drive->share_rate / drive->share,
                                .normal_rates = apart ? rates : NULL};
}

size_t lac_block_friction(const lac_look *at, size_t first, lac_block *s, lac_block_slopes *d)
{
    double rates[LAC_FRICTION_BLOCK];
    const lac_friction_cells cells = cells_from(at, first, s->room, rates);
    s->speed = cells.v;
    lac_friction_values values = lac_block_values(s);
    lac_friction_slopes slopes = {0};
    if (d != NULL) {
        slopes = (lac_friction_slopes){
            .f_uu = d->f_uu, .f_uw = d->f_uw, .f_ww = d->f_ww, .g_u = d->g_u, .g_w = d->g_w};
    }
    lac_friction_evaluate(at->problem->friction, &cells, &values, d != NULL ? &slopes : NULL);
    return cells.n;
}

// traction -= p f + damping, of a block.
LAC_CLONES static void lac_formulation_take_held(const lac_look *at, size_t first, size_t n,
                                                 const double *f, double *traction)
{
    const lac_problem *problem = at->problem;
    const double *p = problem->pressure + first, *v = at->motion.v + first;
    const double eta = problem->damping, drag = problem->drag, mean_damping = problem->mean_damping;
    const double mean = at->motion.mean;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double held = copysign(lac_problem_effective(problem, &at->drive, first + i) * f[i], v[i]);
        double common = (mean_damping + drag * p[i]) * mean;
        traction[i] -= held + eta * v[i] + common;
    }
}

void lac_problem_unbalanced(const lac_look *at, double *traction, double *wdot)
{
    const bool by_speed = wdot != NULL || lac_friction_flashes(at->problem->friction);
    lac_look_add_lost(at, traction);
    for (size_t first = 0; first < at->problem->n; first += LAC_FRICTION_BLOCK) {
        double rates[LAC_FRICTION_BLOCK];
        lac_block s;
        const lac_friction_cells cells = cells_from(at, first, by_speed ? s.room : NULL, rates);
        const lac_friction_values values = {.f = s.f, .g = wdot != NULL ? wdot + first : NULL};
        lac_friction_evaluate(at->problem->friction, &cells, &values, NULL);
        lac_formulation_take_held(at, first, cells.n, s.f, traction + first);
    }
}

bool lac_problem_evolve(const lac_look *at, double *wdot)
{
    size_t n = at->problem->n;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        double speed[LAC_FRICTION_BLOCK];
        double rates[LAC_FRICTION_BLOCK];
        const lac_friction_cells cells = cells_from(at, first, speed, rates);
        lac_friction_evaluate(at->problem->friction, &cells,
                              &(lac_friction_values){.g = wdot + first}, NULL);
    }
    return lac_vfinite(n, wdot);
}

// On a bent base a mean slip greater by x puts C x on cell k, and a mean rate so C_v x: C times the
// mean of b_slip goes to kv, and C + C_v/gamma to row. @param f  what friction takes of p, with its
// sign
static void bend_cell(const lac_look *at, double gamma, double gone, size_t k, double f)
{
    const lac_problem_loads_at *drive = &at->drive;
    double p = at->problem->pressure[k];
    double by_slip = p * (drive->ratio_slope - f * drive->share_slope);
    at->ws.kv[k] -= by_slip * gone;
    at->ws.row[k] = by_slip - p * f * drive->share_by_rate / gamma;
}

// tau = s p f(ln|v|, w) + eta v, s the sign of v, gives with Z = p f_u/|v| + eta
//   x_tau = Z dv + s p f_w x_w,   x_w = back (b_w + gamma (g_u/v) dv),   back = 1/(1 - gamma g_w)
// @param gone  mean of b_slip; NULL: the base does not bend
static bool reduce_block(const lac_look *at, double gamma, const double *gone, double *b_w,
                         size_t first)
{
    lac_block s;
    lac_block_slopes d;
    const lac_problem *problem = at->problem;
    const lac_workspace *ws = &at->ws;
    size_t length = lac_block_friction(at, first, &s, &d);
    bool good = true;
    double diagonal[LAC_FRICTION_BLOCK], rhs[LAC_FRICTION_BLOCK];
    const lac_weak_block weak = {&s, &d, diagonal, rhs};
    if (problem->weak != NULL) {
        good = lac_weaken_reduce(at, gamma, NULL, b_w - problem->n, first, &weak);
    }
    for (size_t i = 0; i < length; i++) {
        size_t k = first + i;
        double p = lac_problem_effective(problem, &at->drive, k);
        double v = at->motion.v[k];
        double z = p * s.f_u[i] / s.speed[i] + problem->damping;
        z = z < LAC_STIFFEST ? z : LAC_STIFFEST;
        double f_w = copysign(p * s.f_w[i], v);
        double back = 1.0 / (1.0 - gamma * d.g_w[i]);
        double slope = back * (d.g_u[i] / v);
        good = good && back > 0.0;
        b_w[k] *= back;
        ws->diagonal[k] = z / gamma + f_w * slope;
        ws->kv[k] = f_w * b_w[k];
        ws->v[k] = gamma * slope;
        if (gone != NULL) {
            bend_cell(at, gamma, *gone, k, copysign(s.f[i], v));
        }
    }
    for (size_t i = 0; problem->weak != NULL && i < length; i++) {
        ws->diagonal[first + i] += diagonal[i];
        ws->kv[first + i] += rhs[i];
    }
    return good;
}

bool lac_implicit_reduce(const lac_look *at, double gamma, const double *b_slip, double *b_w)
{
    const size_t n = at->problem->n;
    const bool bent = at->problem->loads.geometry != NULL;
    const double mean = bent ? lac_problem_mean(at->problem, b_slip) : 0.0;
    const double *gone = bent ? &mean : NULL;
    bool good = true;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        good = reduce_block(at, gamma, gone, b_w, first) && good;
    }
    return lac_problem_agree(at->problem, good);
}

bool lac_implicit_solve(const lac_look *at, double gamma, double *b)
{
    const lac_problem *problem = at->problem;
    double kappa = problem->drag * (problem->sum_pressure / lac_problem_all(problem)) / gamma;
    double mean = at->drive.spring_stiffness + kappa;
    bool felt = lac_problem_feels_drag(problem, at->drive.least, at->motion.mean);
    const lac_sharing on = {.kappa = felt ? kappa : 0.0,
                            .shares = at->ws.u,
                            .column = problem->loads.geometry != NULL ? at->ws.row : NULL};
    return lac_problem_solve_sharing(problem, mean, at->ws.diagonal, &on, b, at->ws.scratch);
}

// What presses the cells from `first` on: the total pressures, of which all have the same share,
// or in `room` what each has left.
static const double *pressures_from(const lac_look *at, size_t first, size_t length, double *room)
{
    if (at->drive.shares == NULL) {
        return at->problem->pressure + first;
    }
    for (size_t i = 0; i < length; i++) {
        room[i] = lac_problem_effective(at->problem, &at->drive, first + i);
    }
    return room;
}

// What of the tractions the cells' own friction holds: out of line, as most runs need none of it.
static __attribute__((noinline)) void leave(const lac_look *at, const double *traction,
                                            double taken, size_t first, double *left)
{
    const size_t length = lac_block_length(at->problem->n, first);
    for (size_t i = 0; i < length; i++) {
        left[i] = traction[i] - lac_problem_drag(at->problem, first + i) * taken;
        left[i] += at->broken != NULL ? lac_look_lost(at, first + i) : 0.0;
    }
}

// What rates are solved from.
typedef struct balance_field {
    const lac_look *at;
    const double *tractions;
    double taken; // mean rate [m/s]
    double *u;
} balance_field;

// Solves for the rates of some cells and adds them up.
// @param other  what friction holds is not all of the tractions; taken apart for either
static inline __attribute__((always_inline)) double rates_of(const balance_field *field,
                                                             size_t from, size_t end, bool other)
{
    double left[LAC_FRICTION_BLOCK];
    double room[LAC_FRICTION_BLOCK];
    const lac_look *at = field->at;
    const lac_problem *problem = at->problem;
    double *u = field->u, *v = at->ws.v;
    double total = 0.0;
    for (size_t first = from; first < end; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(end, first);
        const double *traction = field->tractions + first;
        if (other) {
            leave(at, traction, field->taken, first, left);
        }
        lac_friction_balance balance = {.first = first,
                                        .n = length,
                                        .w = at->w + first,
                                        .traction = other ? left : traction,
                                        .pressure = pressures_from(at, first, length, room),
                                        .share = at->drive.shares == NULL ? at->drive.share : 1.0,
                                        .damping = problem->damping};
        lac_friction_rates(problem->friction, &balance, u + first, v + first);
        total += lac_problem_sum_from(problem, first, length, v + first);
    }
    return total;
}

static void add_rates(const void *context, size_t first, size_t end, double *sums)
{
    const balance_field *f = context;
    const bool other = f->taken != 0.0 || f->at->broken != NULL;
    sums[0] += other ? rates_of(f, first, end, true) : rates_of(f, first, end, false);
}

double lac_problem_rates_under(const lac_look *at, const double *tractions, double taken, double *u)
{
    const balance_field field = {at, tractions, taken, u};
    double sum;
    lac_range_sums(&at->problem->range, 1, add_rates, &field, &sum);
    return sum / lac_problem_all(at->problem);
}

void lac_problem_find_ease(const lac_look *at, const double *u, double *ease)
{
    double speed[LAC_FRICTION_BLOCK];
    const lac_problem *problem = at->problem;
    for (size_t first = 0; first < problem->n; first += LAC_FRICTION_BLOCK) {
        size_t length = lac_block_length(problem->n, first);
        lac_vabs(length, at->ws.v + first, speed);
        const lac_friction_cells cells = {
            .first = first, .n = length, .u = u + first, .w = at->w + first, .v = speed};
        lac_block_ease(problem, &at->drive, &cells, ease + first);
    }
}

// Largest part of a rate that a mean rate greater by `moved` would take off it.
static double part_taken(size_t n, double moved, const double *ease, const double *v)
{
    double most = 0.0;
    for (size_t i = 0; i < n; i++) {
        double part = fabs(moved * ease[i] / v[i]);
        most = part > most ? part : most;
    }
    return most;
}

static void take_off(size_t n, double moved, const double *ease, double *u, double *v)
{
    for (size_t i = 0; i < n; i++) {
        double part = moved * ease[i] / v[i];
        u[i] -= part;
        v[i] -= part * v[i];
    }
}

// The rates whose own mean is the one that damps them: one unknown, found by Newton's method. Its
// last step, so small that it is linear, is taken by the rates themselves.
static double rates_together(const lac_look *at, const double *tractions, double *u)
{
    const lac_workspace *ws = &at->ws;
    const double linear = 2e-8; // its square is rounding
    const double near = 0.3;    // a better place to begin the next
    size_t n = at->problem->n;
    double *ease = ws->diagonal;
    lac_mean_search search = lac_mean_search_from(*ws->mean);
    for (int k = 0; k < 200; k++) {
        double found = lac_problem_rates_under(at, tractions, search.mean, u);
        if (!isfinite(found)) {
            return found;
        }
        lac_problem_find_ease(at, u, ease);
        double slope = lac_problem_mean(at->problem, ease);
        double moved = lac_mean_search_on(&search, found, slope);
        double part = lac_problem_most(at->problem, part_taken(n, moved, ease, ws->v));
        if (part <= near) {
            take_off(n, moved, ease, u, ws->v);
        }
        if (part <= linear) {
            break;
        }
        if (fabs(moved) <= DBL_EPSILON * fabs(search.mean)) {
            break;
        }
    }
    return lac_problem_mean(at->problem, ws->v);
}

lac_motion lac_problem_solve_rates(const lac_look *at, const double *traction, bool keep)
{
    const lac_workspace *ws = &at->ws;
    double *u = keep ? ws->guess : ws->u;
    double mean;
    if (!keep) {
        memcpy(u, ws->guess, at->problem->n * sizeof *u);
    }
    if (at->problem->drag == 0.0) {
        mean = lac_problem_rates_under(at, traction, 0.0, u);
    } else {
        mean = rates_together(at, traction, u);
        *ws->mean = keep && isfinite(mean) ? mean : *ws->mean;
    }
    return (lac_motion){.u = u, .v = ws->v, .mean = mean};
}
