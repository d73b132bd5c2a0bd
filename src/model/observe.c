// SPDX-License-Identifier: GPL-3.0-or-later
// What a state means in rates and forces, how well it balances, what a jump of loads does, and the
// state moved onto the balance before it is put out.
#include "base/clones.h"
#include "base/vsum.h"
#include "lacuna/simulation.h"
#include "model/internal.h"
#include "model/weaken.h"

// What is looked at, but for its loads and motion.
static void set_out(const lac_problem *problem, double t, const double *y, double *work,
                    lac_look *at)
{
    // Not the whole at once: the loads are a long list, and filled in below.
    at->problem = problem;
    at->y = y;
    at->w = y + problem->n;
    at->ws = lac_problem_split(problem, work);
    at->motion = (lac_motion){0};
    at->t = t;
    at->broken = NULL;
    at->coupled = false;
}

bool lac_problem_begin(const lac_problem *problem, double t, const double *y, bool keep,
                       double *work, lac_look *at)
{
    set_out(problem, t, y, work, at);
    // What has mass moves as it does, and how fast it does presses it on a bent base.
    const bool moves = problem->mass > 0.0;
    if (moves) {
        at->motion = problem->kind->move(at, keep);
    }
    const lac_gone gone = lac_problem_gone_in(problem, y, at->motion.mean);
    bool good = lac_problem_drive_into(problem, t, gone, at->ws.shares, &at->drive);
    good = lac_weaken_look(at) && good;
    if (!moves && (good || !keep)) {
        at->motion = problem->kind->move(at, keep);
    }
    at->ws.mean[1] = at->motion.mean;
    return good;
}

void lac_problem_look_again(const lac_problem *problem, double t, const double *y, double *work,
                            lac_look *at)
{
    if (problem->mass > 0.0 || problem->across != NULL) {
        lac_problem_look(problem, t, y, work, at); // whose look leaves more behind
        return;
    }
    set_out(problem, t, y, work, at);
    const lac_gone gone = lac_problem_gone_in(problem, y, 0.0);
    (void)lac_problem_drive_into(problem, t, gone, at->ws.shares, &at->drive);
    (void)lac_weaken_look(at);
    at->motion = (lac_motion){
        .u = problem->kind->solved ? at->ws.u : y, .v = at->ws.v, .mean = at->ws.mean[1]};
}

void lac_problem_rates(const lac_problem *problem, double t, const double *y, double *v,
                       double *work)
{
    lac_look at;
    lac_problem_look(problem, t, y, work, &at);
    memcpy(v, at.ws.v, problem->n * sizeof *v);
}

void lac_problem_speed(const lac_problem *problem, double t, const double *y, bool found,
                       double *mean, double *max, double *work)
{
    lac_look at;
    if (found && problem->kind->solved) { // where those of a look are
        const lac_workspace ws = lac_problem_split(problem, work);
        memcpy(ws.u, ws.guess, problem->n * sizeof *ws.u);
    }
    if (found) {
        lac_problem_look_again(problem, t, y, work, &at);
    } else {
        lac_problem_look(problem, t, y, work, &at);
    }
    *mean = fabs(at.motion.mean);
    *max = lac_problem_most(problem, lac_vmost(problem->n, at.motion.v));
}

void lac_problem_traction(const lac_problem *problem, double t, const double *slip,
                          double *traction, double *work)
{
    lac_look at = {.problem = problem, .ws = lac_problem_split(problem, work), .t = t};
    const lac_gone gone = lac_problem_gone(problem, slip, 0.0);
    (void)lac_problem_drive_into(problem, t, gone, at.ws.shares, &at.drive);
    if (problem->across != NULL) {
        lac_vector_traction(&at, slip, traction);
        return;
    }
    lac_problem_elastic_traction(&at, slip, traction);
    for (size_t i = 0; problem->bond > 0.0 && i < problem->n; i++) {
        traction[i] += lac_problem_cohesion(problem, i);
    }
}

// What every cell is off its balance.
static void find_residuals(const lac_look *at, const double *slip, double *residual)
{
    const lac_problem *problem = at->problem;
    if (problem->across != NULL) {
        lac_vector_unbalanced(at, residual);
        return;
    }
    lac_problem_elastic_traction(at, slip, residual);
    lac_problem_unbalanced(at, residual, NULL);
    if (problem->mass > 0.0) {
        lac_inertia_unexplained(problem, residual);
    }
}

// The largest of a block's residuals, relative to f0 p; NaN where one is. An f0 below a says little
// of the strength, which an e-fold of the rate changes by a p: all that holds goes to `holds`.
LAC_CLONES static double lac_observe_worst(const lac_look *at, size_t first, size_t n,
                                           const double *residual, double *restrict holds)
{
    const lac_problem *problem = at->problem;
    const double *f0 = lac_cellwise_from(&problem->friction->column[LAC_F0], first);
    const double *a = lac_cellwise_from(&problem->friction->column[LAC_A], first);
    const double *v = at->motion.v + first;
    const double damping = problem->damping, mean = fabs(at->motion.mean);
    double relative[LAC_FRICTION_BLOCK];
    long long numbers = 0;
    for (size_t i = 0; i < n; i++) {
        double p = lac_problem_effective(problem, &at->drive, first + i);
        double f = fabs(f0[i]) > a[i] ? fabs(f0[i]) : a[i];
        double off = fabs(residual[i]) / (p * (f0[i] == 0.0 ? 1.0 : f));
        relative[i] = off < 0.0 ? 0.0 : off; // a cell that is lifted ends the run by itself
        numbers += relative[i] >= 0.0 ? 1 : 0;
    }
    for (size_t i = 0; i < n; i++) {
        double p = lac_problem_effective(problem, &at->drive, first + i);
        holds[i] = a[i] * p + damping * fabs(v[i]) + lac_problem_drag(problem, first + i) * mean;
    }
    return numbers == (long long)n ? lac_vmost(n, relative) : (double)NAN;
}

// A state and what is summed of its cells.
typedef struct observed {
    const lac_look *at;
    const double *residual; // [n]
    double *worst;          // [LAC_RANGE_BLOCKS]
} observed;

// The greater, or what is not a number.
static double worse(double one, double other) { return one > other || isnan(one) ? one : other; }

// What cells are off together, and what holds them; on the way how far the worst is off.
static void add_balance(const void *context, size_t first, size_t end, double *sums)
{
    const observed *o = context;
    const lac_problem *problem = o->at->problem;
    double *worst = &o->worst[first / problem->range.block];
    for (size_t from = first; from < end; from += LAC_FRICTION_BLOCK) {
        double holds[LAC_FRICTION_BLOCK];
        const size_t n = lac_block_length(end, from);
        *worst = worse(lac_observe_worst(o->at, from, n, o->residual + from, holds), *worst);
        sums[0] += lac_problem_sum_from(problem, from, n, o->residual + from);
        sums[1] += lac_problem_sum_from(problem, from, n, holds);
    }
}

// How far the cells are off their balance, each and together.
// @param traction  overwritten
static void measure_balance(const lac_look *at, const double *slip, double *traction,
                            lac_observation *observation)
{
    const lac_problem *problem = at->problem;
    double worst[LAC_RANGE_BLOCKS] = {0.0}, sums[2];
    find_residuals(at, slip, traction);
    lac_range_sums(&problem->range, 2, add_balance, &(observed){at, traction, worst}, sums);
    for (size_t i = 1; i < lac_range_blocks(&problem->range); i++) {
        worst[0] = worse(worst[i], worst[0]);
    }
    observation->balance_residual = lac_problem_most(problem, worst[0]);
    observation->rate_drift = sums[1] > 0.0 ? fabs(sums[0]) / sums[1] : 0.0;
}

double lac_look_sheared(const lac_look *at, const double *slip, double mean)
{
    const lac_problem *problem = at->problem;
    const lac_problem_loads_at *drive = &at->drive;
    double spring = drive->spring - drive->spring_stiffness * mean;
    double alike = spring + drive->far.elastic; // the mean of the shape is 1
    double total = problem->sum_traction0 + problem->sum_pressure * (drive->ratio + problem->bond) +
                   lac_problem_all(problem) * alike;
    return total - lac_problem_held(problem, drive->far.back, slip);
}

// Mean slip and shear force; of slip in two directions with their components, and the rate's.
static void observe_slip(const lac_look *at, const double *slip, lac_observation *seen)
{
    const lac_problem *problem = at->problem;
    if (problem->across == NULL) {
        seen->mean_slip = lac_problem_mean(problem, slip);
        seen->shear_force = problem->cell_area * lac_look_sheared(at, slip, seen->mean_slip);
        return;
    }
    const lac_components of = lac_problem_components(problem, slip, at->ws.v);
    seen->shear_force = problem->cell_area * lac_vector_sheared(at, slip, seen->shear_along);
    for (int c = 0; c < 2; c++) {
        seen->slip_along[c] = lac_problem_mean(problem, of.slip[c]);
        seen->rate_along[c] = lac_problem_mean(problem, of.rate[c]);
        seen->shear_along[c] *= problem->cell_area;
    }
    seen->mean_slip = hypot(seen->slip_along[0], seen->slip_along[1]);
}

// Of each cell, by the force that it carries.
typedef struct carried {
    const lac_problem *problem;
    const double *x, *y; // [n]
    double least;        // that is left out of x
} carried;

static void add_carried(const void *context, size_t first, size_t end, double *sums)
{
    const carried *c = context;
    const lac_problem *problem = c->problem;
    for (size_t i = first; i < end; i++) {
        const double force = lac_problem_weight(problem, i) * problem->pressure[i];
        sums[0] += force * (c->x[i] - c->least);
        sums[1] += force * c->y[i];
    }
}

// What weakening has come to; NaN where nothing weakens.
static void observe_weakening(const lac_look *at, lac_observation *observation)
{
    const lac_problem *problem = at->problem;
    observation->excess_pore = observation->temperature = observation->broken = NAN;
    if (problem->weak == NULL) {
        return;
    }
    const size_t n = problem->n;
    // Rest and slope are Newton's.
    const lac_weak_arrays a = lac_weaken_split(problem, at->ws.weak);
    double *pore = a.rest, *temperature = a.before, *broken = a.slope;
    double sums[2], hottest = 0.0;
    lac_problem_weakened(problem, at->y, pore, temperature, broken);
    for (size_t i = 0; i < n; i++) {
        hottest = fmax(hottest, temperature[i]);
    }
    lac_range_sums(&problem->range, 2, add_carried, &(carried){problem, pore, broken, 0.0}, sums);
    observation->excess_pore = sums[0] / problem->sum_pressure;
    observation->temperature = lac_problem_most(problem, hottest);
    observation->broken = sums[1] / problem->sum_pressure;
}

// Normal force over that of the normal load at the start. Where what comes on top differs from cell
// to cell, it is weighed by pressure, as what is taken off is. @param base  what the base leaves of
// it, as far as it bends; shares  those of lac_workspace
static double pressed(const lac_problem *problem, double t, double base, double *shares)
{
    const lac_load_set *loads = &problem->loads;
    lac_load_state now;
    double off[2] = {0.0, 0.0};
    if (!lac_load_set_presses(loads)) {
        return base;
    }
    lac_load_evaluate(loads, t, &now);
    if (problem->varies) {
        double *normal = shares + 2 * problem->n; // where a jump would need it
        lac_load_evaluate_normal(loads, t, &now, normal, normal + problem->n);
        now.normal = lac_problem_first(problem, normal);
        lac_range_sums(&problem->range, 2, add_carried,
                       &(carried){problem, normal, normal, now.normal}, off);
    }
    return base + (now.normal + off[0] / problem->sum_pressure) / problem->mean_pressure;
}

// The first of the cells with the largest rate. @param most  becomes that
static size_t find_fastest(const lac_problem *problem, const double *v, double *most)
{
    const size_t n = problem->n;
    size_t i = 0; // begins with the first block that has it
    *most = 0.0;
    for (size_t first = 0; first < n; first += LAC_FRICTION_BLOCK) {
        const double here = lac_vmost(lac_block_length(n, first), v + first);
        i = here > *most ? first : i;
        *most = fmax(*most, here);
    }
    *most = lac_problem_most(problem, *most);
    while (i < n && fabs(v[i]) != *most) {
        i++;
    }
    const size_t first = lac_problem_first_cell(problem, i < n ? i : SIZE_MAX);
    *most = first == SIZE_MAX ? (double)NAN : *most;
    return first == SIZE_MAX ? 0 : first; // not a number
}

void lac_problem_observe(const lac_problem *problem, double t, const double *y, const double *slip,
                         bool again, lac_observation *observation, double *work)
{
    lac_look at;
    if (again) {
        lac_problem_look_again(problem, t, y, work, &at);
    } else {
        lac_problem_look(problem, t, y, work, &at);
    }
    const lac_motion motion = at.motion;
    const lac_problem_loads_at *drive = &at.drive;
    observation->mean_rate = motion.mean;
    observation->fastest = find_fastest(problem, motion.v, &observation->max_rate);
    observe_slip(&at, slip, observation);
    const double force = problem->cell_area * problem->sum_pressure;
    observation->normal_force = force * pressed(problem, t, drive->normal, at.ws.shares);
    observation->effective_force = force * drive->share;

    observation->factor_of_safety = problem->safety.asked ? lac_look_safety(&at, slip) : NAN;

    measure_balance(&at, slip, at.ws.kv, observation);
    observe_weakening(&at, observation);
}

// Whether the plain coefficient of every cell is above nothing, many cells at a time; where that is
// not what friction evaluates, nothing is said.
static bool all_hold(const lac_problem *problem, const double *u, const double *w)
{
    const lac_friction *friction = problem->friction;
    bool all = friction->form == LAC_FORM_PLAIN && !lac_friction_flashes(friction);
    for (size_t first = 0; all && first < problem->n; first += LAC_FRICTION_BLOCK) {
        double f[LAC_FRICTION_BLOCK];
        size_t count = 0;
        const lac_friction_cells cells = {.first = first,
                                          .n = lac_block_length(problem->n, first),
                                          .u = u + first,
                                          .w = w + first};
        lac_friction_evaluate(friction, &cells, &(lac_friction_values){.f = f}, NULL);
        for (size_t i = 0; i < cells.n; i++) {
            count += f[i] > 0.0 ? 1 : 0;
        }
        all = count == cells.n;
    }
    return all;
}

// The first cell here that does not slip on; SIZE_MAX: all do. @param y, motion  as they are looked
// at
static size_t find_stopped(const lac_problem *problem, const double *y, const lac_motion *motion)
{
    if (!problem->kind->solved && all_hold(problem, motion->u, y + problem->n)) {
        return SIZE_MAX;
    }
    // Regularised, f falls to nothing as exp of F over a; plain, f is F.
    const lac_friction *friction = problem->friction;
    const lac_cellwise *a = &friction->column[LAC_A];
    const double *w = y + problem->n;
    const double folds = friction->form == LAC_FORM_REGULARISED ? -20.0 : 0.0;
    for (size_t i = 0; i < problem->n; i++) {
        bool back = problem->kind->solved && motion->v[i] < 0.0;
        double plain = lac_friction_plain(friction, i, motion->u[i], w[i]);
        if (back || plain <= folds * lac_cellwise_of(a, i)) {
            return i;
        }
    }
    return SIZE_MAX;
}

bool lac_problem_slips(const lac_problem *problem, double t, const double *y, size_t *cell,
                       double *work)
{
    const lac_friction *friction = problem->friction;
    bool regularised = friction->form == LAC_FORM_REGULARISED;
    bool reverses = problem->kind->either_sign && regularised;
    if (reverses && !(problem->bond > 0.0)) {
        return true; // cohesion would have to hold the other way then
    }
    // ln v is y itself where the rate is not solved for
    lac_motion motion = {.u = y};
    if (problem->kind->solved) {
        lac_look at;
        lac_problem_look(problem, t, y, work, &at);
        motion = at.motion;
    }
    const size_t stopped = lac_problem_first_cell(problem, find_stopped(problem, y, &motion));
    *cell = stopped == SIZE_MAX ? *cell : stopped;
    return stopped == SIZE_MAX;
}

// Whether the share of a cell jumps: one that only bends has changed by no more than its rate times
// one rounding of t, which is `slack`.
static bool shares_jump(const lac_problem *problem, const lac_problem_loads_at *before,
                        const lac_problem_loads_at *after, double slack)
{
    if (!problem->varies) {
        return fabs(after->share - before->share) > slack * fabs(before->share_rate);
    }
    bool jumps = false;
    for (size_t i = 0; i < problem->n; i++) {
        double moved = fabs(after->shares[i] - before->shares[i]);
        jumps = jumps || moved > slack * fabs(before->share_rates[i]);
    }
    return lac_team_any(problem->range.team, jumps);
}

bool lac_problem_jump(const lac_problem *problem, double t, double *y, double *work)
{
    lac_problem_loads_at before;
    lac_problem_loads_at after;
    const lac_workspace ws = lac_problem_split(problem, work);
    double *shares_before = problem->varies ? ws.shares + 2 * problem->n : NULL;
    const lac_gone gone = lac_problem_gone_in(problem, y, 0.0);
    if (!lac_problem_drive_into(problem, nextafter(t, -INFINITY), gone, shares_before, &before) ||
        !lac_problem_drive_into(problem, t, gone, ws.shares, &after)) {
        return false;
    }
    lac_jump jump = {.ratio = after.ratio - before.ratio,
                     .spring = after.spring - before.spring,
                     .elastic = after.far.elastic - before.far.elastic,
                     .before = &before,
                     .after = &after};
    // A load that only bends has changed by no more than its rate times one rounding of t.
    double slack = 16.0 * (nextafter(fabs(t), INFINITY) - fabs(t));
    bool jumps = fabs(jump.ratio) > slack * fabs(before.ratio_rate) ||
                 fabs(jump.spring) > slack * fabs(before.spring_rate) ||
                 fabs(jump.elastic) > slack * fabs(before.far_rate.elastic) ||
                 shares_jump(problem, &before, &after, slack);
    if (!jumps) {
        return true;
    }
    lac_weaken_jump(problem, y, &ws, &before, &after);
    bool good = problem->kind->jump == NULL || problem->kind->jump(problem, &jump, y);
    for (size_t i = 0; good && i < problem->n; i++) {
        double *w = &y[problem->n + i];
        double change = lac_problem_share_of(&after, i) / lac_problem_share_of(&before, i);
        *w = lac_friction_state_after(problem->friction, i, *w, change);
        good = isfinite(exp(*w)); // alpha/b makes e-folds of theta without bounds
    }
    return lac_problem_agree(problem, good);
}
