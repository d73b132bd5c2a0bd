/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/range.h"
#include "base/vsum.h"
#include "model/problem.h"

struct lac_problem {
    size_t n;           // cells here: range.n
    lac_range range;    // of all cells
    lac_friction *part; // what friction is of a range; NULL: all is here
    lac_transfer part_transfer;
    const double *weight;   // [n] of each in sums and means, mean 1; NULL: 1
    const double *pressure; // [n] total normal pressure of each cell [Pa]
    const lac_friction *friction;
    lac_transfer transfer;
    lac_load_set loads;
    const struct lac_formulation_kind *kind;
    double damping;       // eta [Pa s/m]
    double mean_damping;  // what the mean slip rate takes off every cell besides [Pa s/m]
    double drag;          // what it takes off per pressure [s/m]: lac_damping.shared
    double least_direct;  // least a of the cells
    double bond;          // cohesion over the mean pressure: it carries p_i bond of q_i [1]
    double cell_area;     // r^2; of a cell of weight 1 [m2]
    double nominal_area;  // L^2 [m2]
    double length;        // a slip that is long gone: the longer side; of one block 10 m
    double mean_pressure; // P/L^2 [Pa]
    double sum_pressure;  // sum of p_i [Pa]
    double spring_share;  // L^2/(n r^2): nominal stress of a spring -> traction of a cell
    double stiffness;     // of a cell against its neighbours and springs, where slip is unknown
    double mass;          // m: of the block, per area of its contact cells [kg/m2]; 0: none
    double columns;       // part of it that stands on the cells as columns of their own
    double slow;          // v_s: v = 2 v_s sinh x where a massive cell may turn back [m/s]
    double sum_traction0; // sum of the tractions at t = 0 [Pa]
    bool varies;          // what the loads take off the pressure differs from cell to cell
    bool still;           // loads are at all times what drive0 tells
    double pull0;         // of the weight on a bent base over P at the start; 0: none
    double slide;         // most that a bent base puts on a cell or takes off it [Pa/m]; 0: none
    lac_load_state at_start;
    lac_problem_loads_at drive0; // at t = 0
    lac_safety safety;
    const lac_weakening_set *weak;  // NULL: nothing weakens but friction
    double *traction0;              // [n] q_i at t = 0 [Pa]; owns the two last
    double *anchor;                 // [n] K 1: what holds uniform slip [Pa/m]; NULL: nothing does
    double *log_rate0, *log_state0; // [n]
    double *shares0;                // [2n] of drive0; NULL where all cells are alike
    size_t scratch, mean, weakens;  // where these parts of the work begin: lac_problem_lay_out
    struct lac_problem *across;     // slip along y, which shares all but what make_side gives it;
                                    // NULL: slip is along x
};

// Weight of cell i.
static inline double lac_problem_weight(const lac_problem *problem, size_t i)
{
    return problem->weight == NULL ? 1.0 : problem->weight[i];
}

// Sum of x over `length` cells from `first` on, each with its weight. @param x  of these cells
static inline double lac_problem_sum_from(const lac_problem *problem, size_t first, size_t length,
                                          const double *x)
{
    return problem->weight == NULL ? lac_vsum(length, x)
                                   : lac_vdot(length, problem->weight + first, x);
}

// Whether it is so with all cells, and the largest: of those here, and of others.
static inline bool lac_problem_agree(const lac_problem *problem, bool good)
{
    return lac_team_all(problem->range.team, good);
}
static inline double lac_problem_most(const lac_problem *problem, double most)
{
    return lac_team_most(problem->range.team, most);
}

// What the first of all cells has.
static inline double lac_problem_first(const lac_problem *problem, const double *x)
{
    double first = lac_team_leads(problem->range.team) ? x[0] : 0.0;
    lac_team_follow(problem->range.team, &first);
    return first;
}

// All cells.
static inline double lac_problem_all(const lac_problem *problem)
{
    return (double)problem->range.all;
}

// Sum and mean over all cells, each with its weight; the mean of x as it is.
double lac_problem_sum(const lac_problem *problem, const double *x);
static inline double lac_problem_mean(const lac_problem *problem, const double *x)
{
    return lac_problem_sum(problem, x) / lac_problem_all(problem);
}
static inline double lac_problem_plain_mean(const lac_problem *problem, const double *x)
{
    return lac_range_sum(&problem->range, x) / lac_problem_all(problem);
}

// Mean over all cells of exp(u), one cell after the other.
double lac_problem_exp_mean(const lac_problem *problem, const double *u);

// Effective normal pressure of cell i [Pa]: the one place where it is made of what the loads leave.
static inline double lac_problem_effective(const lac_problem *problem,
                                           const lac_problem_loads_at *drive, size_t i)
{
    return problem->pressure[i] * lac_problem_share_of(drive, i);
}

// What the mean slip rate takes off the traction of cell i, per metre per second [Pa s/m].
static inline double lac_problem_drag(const lac_problem *problem, size_t i)
{
    return problem->mean_damping + problem->drag * problem->pressure[i];
}

// Whether Newton's method feels that the mean rate is damped: what it takes off a mean rate over
// what friction holds of it.
static inline bool lac_problem_feels_drag(const lac_problem *problem, double share, double mean)
{
    const double felt = 1e-3; // so much of its last correction Newton's method may leave
    return problem->drag * fabs(mean) > felt * share * problem->least_direct;
}

// The parts of lac_problem_work, [n] each but the last.
typedef struct lac_workspace {
    double *v, *kv, *diagonal;
    double *u;     // ln|v|, where it is not an unknown
    double *guess; // where ln|v| is solved for: where the next solve begins
    double *bend;  // with inertia: what a step does to dv/dx, in the place of guess
    double *slope; // with inertia: dv/dx
    double *row;   // [n] where damping of the mean counts, and slip is no unknown; of a bent base
                   // what a step of the mean slip puts on each cell
    double *mean;  // [3] where rates are solved for: the mean rate that the next solve begins from;
                   // that of the last look; the first along y
    double *scratch; // of the transfer
    double *shares;  // [4n] where cells have shares of their own: shares and rates; before a jump
    double *weak;    // of lac_weaken_split, where a case names weakening
} lac_workspace;

// How far the cells have come together, where the base bends: else 0.
typedef struct lac_gone {
    double slip, rate; // means [m], [m/s]; the rate where the block has mass
} lac_gone;

// Of slips, or of those in y. @param rate  mean
lac_gone lac_problem_gone(const lac_problem *problem, const double *slip, double rate);
static inline lac_gone lac_problem_gone_in(const lac_problem *problem, const double *y, double rate)
{
    return problem->loads.geometry == NULL
               ? (lac_gone){0}
               : lac_problem_gone(problem, y + lac_problem_slip_place(problem), rate);
}

// Takes the base that bends, where there is one, and says what cannot follow it.
lac_status lac_problem_geometry_init(lac_problem *problem, lac_error *err);

// What the base has come to, beside the loads of the moment, whose pore pressure a lake raises:
// `normal`, its part of ratio, and the slopes.
void lac_problem_bend(const lac_problem *problem, lac_gone gone, lac_load_state *now,
                      lac_problem_loads_at *drive);

// lac_problem_drive. @param shares  [2n] where the cells differ
bool lac_problem_drive_into(const lac_problem *problem, double t, lac_gone gone, double *shares,
                            lac_problem_loads_at *drive);

// How the cells move in a state.
typedef struct lac_motion {
    const double *u, *v; // [n] ln|v|, v
    double mean;         // of v [m/s]
} lac_motion;

// A state looked at: all that is made of it is made from this.
typedef struct lac_look {
    const lac_problem *problem;
    const double *y, *w; // [n] w: ln theta
    lac_workspace ws;
    lac_problem_loads_at drive;
    lac_motion motion;
    double t;             // [s]
    const double *broken; // [n] part of the cohesion that is broken, 1 or more: all; NULL: none is
    bool coupled;         // ws.kv holds K v of these rates
} lac_look;

// Of q_i the part of cohesion that is broken, which nothing carries any more [Pa].
static inline double lac_look_lost(const lac_look *at, size_t i)
{
    return at->problem->pressure[i] * at->problem->bond * fmin(at->broken[i], 1.0);
}

// A state with its loads and motion. @param keep  the next solve begins from these rates
// @return whether the loads are sound; the motion is there where the loads are not asked to be
bool lac_problem_begin(const lac_problem *problem, double t, const double *y, bool keep,
                       double *work, lac_look *at);

// The same of the state that was looked at last, whose rates the work still holds.
void lac_problem_look_again(const lac_problem *problem, double t, const double *y, double *work,
                            lac_look *at);

// @param work  the rates are in its first n afterwards
static inline void lac_problem_look(const lac_problem *problem, double t, const double *y,
                                    double *work, lac_look *at)
{
    (void)lac_problem_begin(problem, t, y, false, work, at);
}

// What a jump of the loads puts on the cells.
typedef struct lac_jump {
    double ratio, spring, elastic; // lac_problem_gain
    const lac_problem_loads_at *before, *after;
} lac_jump;

// What q_i gains by it [Pa].
static inline double lac_problem_gain(const lac_problem *problem, const lac_jump *jump, size_t i)
{
    double shaped = problem->loads.shape == NULL ? 0.0 : problem->loads.shape[i] * jump->elastic;
    return problem->pressure[i] * jump->ratio + jump->spring + shaped;
}

#define LAC_NOTHING 1e-25 /* slip rate of a cell with mass that may be at rest [m/s] */

// A choice of unknowns y = (x, ln theta), one x a cell, or (x, ln theta, slip);
// docs/theory/creep.md, docs/theory/momentum.md.
typedef struct lac_formulation_kind {
    lac_formulation id;
    const char *name;
    const char *unknown; // what x is, for messages
    size_t unknowns;     // of a cell: 2, or 3 with slip after ln theta
    size_t arrays;       // of n that the work holds before the transfer's
    bool solved;         // v is solved from the traction
    bool either_sign;    // v may have either sign
    bool has_slip;       // slip is an unknown: x, or the third
    void (*start)(const lac_problem *problem, double *x);
    // Rates of all cells, in ws.v and ws.u or y. @param keep  the next solve begins from these
    lac_motion (*move)(const lac_look *at, bool keep);
    // dy/dt; false where it is not finite
    bool (*derivative)(const lac_look *at, double *ydot);
    // (1 - gamma J) x = b; false where the step is too long
    bool (*newton)(const lac_look *at, double gamma, double *b);
    // Change of x of n cells from `first` on that weighs as much as one e-fold of v; NULL: 1
    void (*scale)(const lac_problem *problem, size_t first, size_t n, double *scale);
    // Takes x across a jump of the loads, theta still as before it; false where no rate balances
    // it; NULL: x goes on as it did
    bool (*jump)(const lac_problem *problem, const lac_jump *jump, double *y);
} lac_formulation_kind;

const lac_formulation_kind *lac_formulation_kind_of(lac_formulation id);

// The parts of the work.
static inline lac_workspace lac_problem_split(const lac_problem *problem, double *work)
{
    const size_t n = problem->n;
    return (lac_workspace){.v = work,
                           .kv = work + n,
                           .diagonal = work + 2 * n,
                           .u = work + 3 * n,
                           .guess = work + 4 * n,
                           .bend = work + 4 * n,
                           .slope = work + 5 * n,
                           .row = work + problem->kind->arrays * n,
                           .scratch = work + problem->scratch,
                           .mean = work + problem->mean,
                           .shares = work + problem->mean + 2,
                           .weak = work + problem->weakens};
}

// Finds the places of these parts, when all that they depend on is known.
void lac_problem_lay_out(lac_problem *problem);

extern const lac_formulation_kind lac_formulation_rate, lac_formulation_traction,
    lac_formulation_slip, lac_formulation_inertia, lac_formulation_vector;

// dtau/dv where v is as good as nothing.
#define LAC_STIFFEST 1e250

// Slip that counts as much as the state that it renews and the traction that it takes off.
double lac_slip_scale(const lac_problem *problem, size_t cell);
void lac_slip_scales(const lac_problem *problem, size_t first, size_t n, double *scale);

// Slip in two directions, docs/theory/vector.md: takes the tractions at t = 0 to a heading.
lac_status lac_vector_init(lac_problem *problem, double heading, lac_error *err);
void lac_vector_clear(lac_problem *problem);

// A state as one direction has it, 0 along x, 1 along y: its loads, and its tractions at t = 0.
lac_look lac_look_along(const lac_look *at, int direction);

// Slip along one direction of what stands in y, by where its slip along y begins.
const double *lac_vector_slip(const lac_problem *problem, const double *slip, int direction);

// Size of q - K slip of every cell; its components are then in the work.
void lac_vector_traction(const lac_look *at, const double *slip, double *traction);

// Error weights of all unknowns. @param weight  those of slip along x and ln theta are there
void lac_vector_weigh(const lac_problem *problem, const double *y, double rtol, double *weight);

// Shear force Q over the area of a cell, as lac_look_sheared [Pa]; gives back its size.
double lac_vector_sheared(const lac_look *at, const double *slip, double along[2]);

// Size of what every cell of a state is off its balance.
void lac_vector_unbalanced(const lac_look *at, double *residual);

// Rates where the mean rate `taken` damps them; gives back their mean.
double lac_problem_rates_under(const lac_look *at, const double *tractions, double taken,
                               double *u);

// By how much rates fall as the mean rate rises that damps them.
void lac_problem_find_ease(const lac_look *at, const double *u, double *ease);

// Takes the block's mass: m, how it is spread and the scale of x. Nothing where there is none.
lac_status lac_inertia_init(lac_problem *problem, const lac_problem_def *def, lac_error *err);

// Error weights of the slip of cells with mass, as in lac_problem_weights. @param slip, weight  [n]
void lac_inertia_weigh_slip(const lac_problem *problem, const double *slip, double rtol,
                            double *weight);

// The fastest e-folding of v that forces out of balance bring about [1/s].
double lac_inertia_fastest(const lac_look *at);

// What a force out of balance leaves beside the inertia of the cells that it accelerates: rounding.
// @param force  [n] of every cell [Pa]; overwritten
void lac_inertia_unexplained(const lac_problem *problem, double *force);

// force = traction - p f - damping of every cell: the traction is overwritten.
// @param wdot  [n] d ln theta/dt; NULL where not wanted
void lac_problem_unbalanced(const lac_look *at, double *traction, double *wdot);

// q - K slip of every cell, the springs' part included.
void lac_problem_elastic_traction(const lac_look *at, const double *slip, double *traction);

// Shear force Q on the interface over the area of a cell: the sum of the cells' tractions [Pa].
// @param mean  of the slip
double lac_look_sheared(const lac_look *at, const double *slip, double mean);

// lac_problem_safety of a state that is looked at; its rates do not count.
double lac_look_safety(const lac_look *at, const double *slip);

// Finds out what the transfer does to uniform slip.
lac_status lac_problem_anchor(lac_problem *problem, lac_error *err);

// force = K (x - back) - shape elastic: what a slip, or a rate, takes off each cell where the rock
// around has gone `back` itself, less what comes from afar. @param work  of the transfer
void lac_problem_couple(const lac_problem *problem, lac_far_field far, const double *x,
                        double *force, double *work);

// Sum over the cells of K (slip - back): what the rock around holds [Pa].
double lac_problem_held(const lac_problem *problem, double back, const double *slip);

// v = exp(u) of every cell, and its sum in a fixed order.
double lac_problem_exp_sum(const lac_problem *problem, const double *u, double *v);

// How far a search for the mean rate has come: of cells that all slip the slower the faster their
// mean is taken to be.
typedef struct lac_mean_search {
    double mean;      // taken to be [m/s]
    double low, high; // it lies between
} lac_mean_search;

static inline lac_mean_search lac_mean_search_from(double mean)
{
    return (lac_mean_search){.mean = mean, .low = -INFINITY, .high = INFINITY};
}

// Takes the search on. @param found, slope  the mean rate of the cells then, and how much of it
// they lose as the one that is taken rises. @return by how much it moves; 0: nothing is left to
// find
double lac_mean_search_on(lac_mean_search *search, double found, double slope);

// By how much the rates of a block of cells fall as the mean rate rises that damps them, where
// friction and their own damping hold them: drag/(p f_u/|v| + eta).
void lac_block_ease(const lac_problem *problem, const lac_problem_loads_at *drive,
                    const lac_friction_cells *cells, double *ease);

// What acts on the mean of the cells, and as their pressures do: kappa s row^T/n, s the share of a
// cell's pressure, whose mean is 1.
typedef struct lac_sharing {
    double kappa;      // [Pa/m]
    const double *row; // [n], some 1; NULL: 1
    double *shares;    // [n] scratch
    double *ones;      // [n] scratch; NULL: none, at the cost of another solve where there is a row
    double *column;    // [n] taken off as column 1^T/n, used up; NULL: nothing [Pa/m]
} lac_sharing;

// Share of a cell in what acts on the mean as the pressures do.
static inline double lac_problem_share(const lac_problem *problem, size_t i)
{
    return problem->pressure[i] / (problem->sum_pressure / lac_problem_all(problem));
}

// (D + K + k P + kappa s row^T/n - column 1^T/n) x = b, in O(n) as the transfer's solve.
// @param mean  k + kappa [Pa/m]
// @return false where the transfer's solve fails, or the matrix is not positive definite
bool lac_problem_solve_sharing(const lac_problem *problem, double mean, const double *diagonal,
                               const lac_sharing *on, double *b, double *scratch);

// Solves for the rates that carry the tractions, into ws.v and ws.guess, or ws.u where they are not
// kept.
lac_motion lac_problem_solve_rates(const lac_look *at, const double *traction, bool keep);

// dw/dt of every cell; false where one is not finite.
bool lac_problem_evolve(const lac_look *at, double *wdot);

// Scratch of one block of cells for the friction kernels, on the caller's stack.
typedef struct lac_block {
    double f[LAC_FRICTION_BLOCK], f_u[LAC_FRICTION_BLOCK], f_w[LAC_FRICTION_BLOCK];
    double g[LAC_FRICTION_BLOCK];
    double room[LAC_FRICTION_BLOCK];
    const double *speed; // |v|
} lac_block;

typedef struct lac_block_slopes {
    double f_uu[LAC_FRICTION_BLOCK], f_uw[LAC_FRICTION_BLOCK], f_ww[LAC_FRICTION_BLOCK];
    double g_u[LAC_FRICTION_BLOCK], g_w[LAC_FRICTION_BLOCK];
} lac_block_slopes;

static inline lac_friction_values lac_block_values(lac_block *s)
{
    return (lac_friction_values){.f = s->f, .f_u = s->f_u, .f_w = s->f_w, .g = s->g};
}

static inline size_t lac_block_length(size_t n, size_t first)
{
    return n - first < LAC_FRICTION_BLOCK ? n - first : LAC_FRICTION_BLOCK;
}

// Friction of the block of cells from `first` on, in s and d; d may be NULL. Gives back how many.
size_t lac_block_friction(const lac_look *at, size_t first, lac_block *s, lac_block_slopes *d);

// Where v is solved for: eliminates ln theta and the balance from the Newton system;
// docs/theory/creep.md eq. 8: ws.diagonal is D then, kv p f_w back b_w, v d ln theta/dv: x_w = back
// b_w + v dv. False where it cannot be.
// @param b_slip  [n] that of slip; NULL: it is no unknown
bool lac_implicit_reduce(const lac_look *at, double gamma, const double *b_slip, double *b_w);

// (D + K + stiffness of the mean, that of its damping included) dv = b, once they are eliminated.
// ws.u is used up.
// @return false where the transfer's solve fails
bool lac_implicit_solve(const lac_look *at, double gamma, double *b);

// Traction that is worth an e-fold of slip rate: a p, and b p where a = 0 [Pa].
static inline double lac_implicit_traction_scale(const lac_problem *problem, size_t cell)
{
    double a = lac_cellwise_of(&problem->friction->column[LAC_A], cell);
    double b = lac_cellwise_of(&problem->friction->column[LAC_B], cell);
    double effect = a > 0.0 ? a : b;
    return (effect > 0.0 ? effect : 1.0) * problem->pressure[cell];
}

// Takes ln v across a jump of the loads: lac_formulation_kind.jump of the formulation rate.
bool lac_rate_jump(const lac_problem *problem, const lac_jump *jump, double *y);
