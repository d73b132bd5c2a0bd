/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/range.h"
#include "friction/friction.h"
#include "friction/weakening.h"
#include "load/load.h"
#include "transfer/transfer.h"

// Of lacuna/simulation.h.
typedef struct lac_observation lac_observation;
typedef struct lac_failure lac_failure;

/// The first unknown x of every cell; the second is ln theta. docs/theory/creep.md.
typedef enum lac_formulation {
    LAC_FORMULATION_AUTO = 0, ///< as lac_formulation_choose says; to a problem: RATE
    LAC_FORMULATION_RATE,     ///< ln v: the balance is differentiated in time; needs v > 0
    LAC_FORMULATION_TRACTION, ///< tau = q - K slip, v solved from it, of either sign
    LAC_FORMULATION_SLIP,     ///< slip, v solved from q - K slip, of either sign
    LAC_FORMULATION_INERTIA,  ///< v on a logarithmic scale, and slip, where a block has mass
    LAC_FORMULATION_VECTOR,   ///< slip in two directions, v solved from q - K slip
} lac_formulation;

/// What radiation takes off the traction of cell i under the total normal pressure p_i:
/// cell v_i + (mean + shared p_i) V, V the mean slip rate over the contact cells;
/// docs/theory/momentum.md eqs. 1 and 2.
typedef struct lac_damping {
    double cell;   ///< eta = G/(2 cs) [Pa s/m]
    double mean;   ///< -eta where the block has mass: uniform slip is not damped [Pa s/m]
    double shared; ///< eta (L^2/(n r^2) - 1) over the mean p_i: uniform slip is damped over the
                   ///< nominal area, and as a shear force is shared [s/m]
} lac_damping;

/// Damping of the cells of a domain by eta = G/(2 cs) [Pa s/m].
/// @source Rice (1993), doi 10.1029/93JB00191, for a cell; the mean: docs/theory/momentum.md
lac_damping lac_damping_over(const lac_domain *domain, double eta, bool massive);

/// The factor of safety that is asked of a problem; docs/theory/safety.md.
typedef struct lac_safety {
    bool asked;            ///< lac_problem_observe works it out
    double reference_rate; ///< v_ref, whatever is asked [m/s]; NaN or 0: v0 of each cell's friction
} lac_safety;

/// What a creep problem is made from; everything pointed at must outlive the problem, except the
/// initial arrays, which are copied.
typedef struct lac_problem_def {
    const lac_domain *domain;
    const lac_friction *friction; ///< of domain->n cells
    const lac_transfer *transfer;
    lac_load_set loads;
    double damping;          ///< eta = G/(2 cs) [Pa s/m]; 0: none; lac_damping_over spreads it
    double mass;             ///< of the sliding block, per nominal area [kg/m2]; 0: no inertia
    double columns;          ///< part of it that stands on the cells as free columns, (0, 1]
    const double *log_rate;  ///< [n] ln v at the start
    const double *log_state; ///< [n] ln theta at the start
    lac_formulation formulation;
    double heading; ///< of slip in two directions at the start, from x towards y [rad]
    lac_safety safety;
    const lac_weakening_set *weakening; ///< what weakens the cells besides friction; NULL: nothing
    lac_team *team; ///< each rank makes the problem of its part of the cells, which all others are
                    ///< asked about, so that all call each function; NULL: of all
} lac_problem_def;

/// Rate-and-state creep of the contact cells, unknowns y = (x, ln theta), x as the formulation
/// says: docs/theory/creep.md. With a mass y = (x, ln theta, slip): docs/theory/momentum.md.
/// Immutable.
typedef struct lac_problem lac_problem;

lac_status lac_problem_create(const lac_problem_def *def, lac_problem **out, lac_error *err);
void lac_problem_free(lac_problem *problem);

/// Contact cells n, and components of y: 2n, x of every cell, then ln theta; with a mass 3n, then
/// slip; then n of every unknown of the weakening.
size_t lac_problem_cells(const lac_problem *problem);
const lac_range *lac_problem_range(const lac_problem *problem);
size_t lac_problem_unknowns(const lac_problem *problem);

/// So many arrays of the cells is y.
size_t lac_problem_arrays(const lac_problem *problem);

/// The number, among all cells, of the first of some that every rank has found here.
/// @param cell  of those here; SIZE_MAX: none
/// @return SIZE_MAX: none anywhere
size_t lac_problem_first_cell(const lac_problem *problem, size_t cell);

/// What a formulation is called in a case; the one in use, never AUTO, and what its x is called.
const char *lac_formulation_name(lac_formulation formulation);
lac_formulation lac_problem_formulation(const lac_problem *problem);
const char *lac_problem_unknown(const lac_problem *problem);

/// Whether slip is among the unknowns, so that it need not be integrated beside y, and where it
/// begins there: 0, or 2n after x and ln theta.
bool lac_problem_has_slip(const lac_problem *problem);
size_t lac_problem_slip_place(const lac_problem *problem);

/// Doubles of scratch that the functions below need. Its contents carry over from call to call:
/// where rates are solved for, each solve begins from the last rates. Hand new scratch to
/// lac_problem_forget first.
size_t lac_problem_work(const lac_problem *problem);

/// Makes the next solve begin afresh, so that what follows depends on y alone to the last bit.
void lac_problem_forget(const lac_problem *problem, double *work);

/// y at the start.
void lac_problem_initial(const lac_problem *problem, double *y);

/// Error weights: 1/(rtol * what of each unknown is worth an e-fold of v or theta).
/// That is 1 for ln v and ln theta, a p for a traction; for slip dc, or a p over the stiffness of a
/// cell where that is less; where the rate is solved for and b > 10 a, ln theta counts b/(10 a)
/// times finer, for ln v is b/a times as far off. Slip beside a rate with mass: itself and dc, or a
/// p over the stiffness. An unknown counts no finer than a double resolves it.
void lac_problem_weights(const lac_problem *problem, const double *y, double rtol, double *weight);

/// What all these weights are, where they are alike; else 0.
double lac_problem_even_weight(const lac_problem *problem, const double *y, double rtol);

/// Slip errors that count, for slip integrated beside y, whose errors y does not show: a traction
/// under a given load is known whatever the rate, and where ln v and ln theta follow straight lines
/// a step may be many e-folds of v. rtol dc, and where ln v is the unknown rtol of the slip
/// besides.
/// @param tolerance  [n] absolute [m]
double lac_problem_slip_tolerance(const lac_problem *problem, double rtol, double *tolerance);

/// The least of them, over all cells.
double lac_problem_least_tolerance(const lac_problem *problem, const double *tolerance);

/// dy/dt; false where it is not finite or the effective pressure not positive.
/// @param work  its first n doubles are then the slip rates
bool lac_problem_derivative(const lac_problem *problem, double t, const double *y, double *ydot,
                            double *work);

/// Solves (1 - gamma J) x = b for the Newton iteration, J = d(dy/dt)/dy at (t, y), in O(n) where
/// the transfer's solve is; exactly, but that damping of the mean is left out where it is below a
/// thousandth of what friction holds. False where the matrix is not positive definite: the step is
/// too long.
bool lac_problem_newton(const lac_problem *problem, double t, const double *y, double gamma,
                        double *b, double *work);

/// The same right after lac_problem_derivative of this t and y, from what that left in the work.
bool lac_problem_newton_next(const lac_problem *problem, double t, const double *y, double gamma,
                             double *b, double *work);

/// Whether the slip rates of a state follow from its unknowns alone, so that those that dy/dt left
/// in the work are as good as new.
bool lac_problem_rates_stay(const lac_problem *problem);

/// Takes y across a jump of the loads at time t: the traction jumps, slip does not, nor the rate of
/// what has mass, and the state only where it responds to the normal pressure (alpha) and that
/// jumps. False where no rate balances the traction.
bool lac_problem_jump(const lac_problem *problem, double t, double *y, double *work);

/// A state without its formulation, which another problem of the same cells can go on from.
typedef struct lac_problem_state {
    size_t n, modes;   ///< cells, and unknowns of the weakening
    double *slip[2];   ///< [n] along x and, of slip in two directions, y [m]; the first owns all
    double *rate;      ///< [n] [m/s]
    double *log_state; ///< [n] ln theta
    double *share;     ///< [n] effective over total normal pressure [1]; NaN: not known, as after
                       ///< create
    double *weak;      ///< [modes][n]
} lac_problem_state;

lac_status lac_problem_state_create(const lac_problem *problem, lac_problem_state *state,
                                    lac_error *err);
void lac_problem_state_clear(lac_problem_state *state);

/// What y says, with slip beside it where that is no unknown. @param state  of
/// lac_problem_state_create
void lac_problem_give(const lac_problem *problem, double t, const double *y, const double *slip,
                      lac_problem_state *state, double *work);

/// y of a problem whose slip and state are those. Its loads at t act at once, as where they jump:
/// traction is q - K slip, and the slip rate what balances it, but of mass, whose rate stays;
/// the state is another one where it responds to the normal pressure and that is another one.
/// @param slip  [n] overwritten where it is no unknown
/// @return LAC_OK; LAC_EINPUT where no rate balances the load; LAC_ENUMERIC where pore pressure
///         lifts a cell; LAC_ENOMEM
lac_status lac_problem_take(const lac_problem *problem, double t, const lac_problem_state *state,
                            double *y, double *slip, lac_error *err);

/// Moves y and slip onto the traction balance, which holds but for the drift of the integration:
/// a cell's slip and slip rate change by the same fraction, docs/theory/creep.md eq. 10.
/// Nothing where slip is an unknown: the balance holds. False where the transfer's solve fails.
bool lac_problem_project(const lac_problem *problem, double t, double *y, double *slip,
                         double *work);

/// The transfer's name where a finite slip [m], or slip rate [m/s], has no finite stress; else
/// NULL.
const char *lac_problem_lost_transfer(const lac_problem *problem, const double *slip, double *work);

/// Slip rate v of every cell [m/s].
void lac_problem_rates(const lac_problem *problem, double t, const double *y, double *v,
                       double *work);

/// Size of the mean slip rate, and the largest |v|, over the cells [m/s].
/// @param found  the work still holds the rates of this state, as lac_problem_derivative left them
void lac_problem_speed(const lac_problem *problem, double t, const double *y, bool found,
                       double *mean, double *max, double *work);

/// Traction of every cell from the balance's elastic side, q - K slip [Pa].
void lac_problem_traction(const lac_problem *problem, double t, const double *slip,
                          double *traction, double *work);

/// Size of the mean slip over the cells; of slip along x with its sign [m].
/// @param slip  here and elsewhere what stands in y from lac_problem_slip_place on: of slip in two
///              directions that along y, and that along x is found in y before it
double lac_problem_mean_slip(const lac_problem *problem, const double *slip);

/// Whether slip has two directions. Rates, tractions and means are then sizes, never negative.
bool lac_problem_is_vector(const lac_problem *problem);

/// Components along x [0] and y [1].
typedef struct lac_components {
    const double *slip[2], *rate[2], *traction[2]; ///< [n] [m], [m/s], [Pa]
} lac_components;

/// Those of slip, of the rates found last and of the tractions found last; they hold until `work`
/// is used again. Only of slip in two directions.
lac_components lac_problem_components(const lac_problem *problem, const double *slip, double *work);

/// Size of the slip of every cell [m]: `slip` itself where slip is along x, else in the work until
/// that is used again.
const double *lac_problem_slip_size(const lac_problem *problem, const double *slip, double *work);

/// Pore pressure of every cell [Pa].
void lac_problem_pore(const lac_problem *problem, double t, double *pore, double *work);

/// What weakens the cells besides friction; NULL: nothing.
const lac_weakening_set *lac_problem_weakening(const lac_problem *problem);

/// What it has come to in every cell: pore pressure in excess of that of the loads [Pa], rise of
/// the temperature [K], part of the cohesion that is broken [1]; 0 of what there is not.
/// @param pore, temperature, broken  [n] overwritten
/// @source docs/theory/weakening.md, eq. 1
void lac_problem_weakened(const lac_problem *problem, const double *y, double *pore,
                          double *temperature, double *broken);

/// Whether there is cohesion; of a cell, c_i [Pa], shared as pressures are;
/// docs/theory/friction.md, eq. 10.
bool lac_problem_coheres(const lac_problem *problem);
double lac_problem_cohesion(const lac_problem *problem, size_t cell);

/// Means, extremes, forces and the balance residual.
/// @param again  this very state was the last whose speed was asked for, or that was observed, with
///               this work
/// @param work   its first n hold the cells' slip rates afterwards [m/s]
void lac_problem_observe(const lac_problem *problem, double t, const double *y, const double *slip,
                         bool again, lac_observation *observation, double *work);

/// What is asked of it: lac_problem_def.safety.
lac_safety lac_problem_safety_asked(const lac_problem *problem);

/// Factor of safety of the joint: what friction would hold if all cells slid at the reference rate
/// in the states that they are in, over the shear force Q that drives,
///     F = sum of [p_i (1 - u L^2/P) f(v_ref, theta_i) + c_i] r^2 / |Q|, c_i the cohesion;
/// Q is lac_observation.shear_force. Where v_ref is the slip rate of every cell the balance makes
/// it 1, but for damping and inertia. @return NaN where nothing drives
/// @cost  that of one evaluation of friction
/// @source docs/theory/safety.md, eq. 1
double lac_problem_safety(const lac_problem *problem, double t, const double *y, const double *slip,
                          double *work);

/// The same of every cell by itself: [p_i (1 - u L^2/P) f(v_ref, theta_i) + c_i] / |tau_i|.
/// @param traction  [n] of lac_problem_traction [Pa]
/// @param safety    [n] NaN where a cell carries nothing; overwritten
/// @source docs/theory/safety.md, eq. 2
void lac_problem_safety_cells(const lac_problem *problem, double t, const double *y,
                              const double *traction, double *safety, double *work);

/// As lac_load_next_break, and lac_load_longest_step: a cell at rest does not feel a swing that a
/// step leaps over.
double lac_problem_next_break(const lac_problem *problem, double t);
double lac_problem_longest_step(const lac_problem *problem, double t);

/// A thousandth of the fastest cell's own time scale: that of its state, which counts b/(10 a)
/// times where b > 10 a (with damping less), or of dc/v [s].
double lac_problem_first_step(const lac_problem *problem, double t, const double *y, double *work);

/// How fast the fastest of a state changes [1/s]: the inverse of that time scale, or the decay of
/// what a cell is behind its neighbours, v k/(p df/dln v + eta v) with the stiffest level's k. An
/// explicit method of fifth order takes steps of at most some three times its inverse.
double lac_problem_fastest(const lac_problem *problem, double t, const double *y, double *work);

/// What a problem is made of, for those who treat its cells one by one.
typedef struct lac_problem_parts {
    const double *pressure;             ///< [n] total normal pressure [Pa]
    const double *traction;             ///< [n] at t = 0 [Pa]
    const double *weight;               ///< [n] of each in sums and means, mean 1; NULL: 1
    const double *log_rate, *log_state; ///< [n] ln v and ln theta at t = 0
    const lac_friction *friction;
    const lac_transfer *transfer;
    lac_damping damping;
    bool linear; ///< the loads are linear in time between their breaks
} lac_problem_parts;

lac_problem_parts lac_problem_parts_of(const lac_problem *problem);

/// What acts on the cells neither alike nor as their pressures do.
typedef struct lac_far_field {
    double back;    ///< slip of the rock around, since the start [m]
    double elastic; ///< mean traction of what is shared as C^-1 1, since the start [Pa]
} lac_far_field;

/// What the loads do at one time, as the cells feel it.
typedef struct lac_problem_loads_at {
    double ratio;                ///< (Q/P)(t) - (Q/P)(0), force loads included: q_i gains p_i ratio
    double ratio_rate;           ///< [1/s]
    double spring;               ///< traction of each cell from the far ends' travel [Pa]
    double spring_rate;          ///< [Pa/s]
    double spring_stiffness;     ///< traction lost per metre of mean slip [Pa/m]
    lac_far_field far, far_rate; ///< and its rate
    double share;      ///< effective over total normal force: p_i -> p_i share where all are alike
    double share_rate; ///< [1/s]
    double least;      ///< share of the cell that has the least of its pressure left
    const double *shares, *share_rates; ///< [n] of each cell, in the work; NULL: all are alike
    double normal;                      ///< total normal force over that at the start [1]
    double ratio_slope, share_slope;    ///< with the mean slip [1/m]
    double share_by_rate;               ///< with the mean slip rate [s/m]
} lac_problem_loads_at;

/// What a cell has of its total normal pressure.
static inline double lac_problem_share_of(const lac_problem_loads_at *drive, size_t i)
{
    return drive->shares != NULL ? drive->shares[i] : drive->share;
}

/// Evaluates the loads of a state; false where the effective normal pressure of a cell is not
/// positive.
/// @param work  as of the functions above; holds what differs from cell to cell, until it is used
///              again. Of no other part of it is anything used
bool lac_problem_drive(const lac_problem *problem, double t, const double *y, double *work,
                       lac_problem_loads_at *drive);

/// Says when, and of which cell, pore pressure leaves no more than `near` of the normal pressure.
/// @param near  part of the total normal pressure; 0: where lac_problem_drive says false
/// @return LAC_OK where more is left; LAC_ENUMERIC
lac_status lac_problem_lifted(const lac_problem *problem, double t, const double *y, double near,
                              double *work, lac_error *err);

/// A mean slip rate that rock does not come to: whoever names it, or more, wants none to be
/// failure.
#define LAC_NO_FAILURE_RATE 1e3

/// What acts on the mean slip of a joint at the start, over the nominal area.
typedef struct lac_failure_start {
    double rate;   ///< mean slip rate [m/s]
    double direct; ///< a p [Pa]
    double excess; ///< (b - a) p [Pa]
    double eta;    ///< what uniform slip is damped by [Pa s/m]; 0: nothing
    bool held;     ///< by a spring, rock that stays behind, or a base that bends
    double length; ///< slip that is failure where none is named [m]
} lac_failure_start;

/// The one definition of failure, for runs, fits, forecasts and trades; docs/theory/creep.md.
/// Weakening leaves (b - a) p ln(rate/rate at the start) to drive a joint, p the effective normal
/// force at the start over the nominal area; radiation holds that at a speed of as much over eta.
/// Where this is below the rate, a p/eta counts instead: from there on damping, not friction, holds
/// the joint. So it is only where uniform slip is damped (a block with mass is not), nothing else
/// holds it (a spring, rock that stays behind), and the joint starts slower.
/// @param rate  asked for [m/s]; LAC_NO_FAILURE_RATE or more: no a p/eta in its place
/// @param slip  asked for [m]; INFINITY: none; NaN or 0: the longer side of the interface, of one
///              block 10 m
/// @source derived from Rice (1993), doi 10.1029/93JB00191: the damping of plane waves
lac_failure lac_problem_failure(const lac_problem *problem, double rate, double slip);

/// The same of a joint whose cells are not known.
lac_failure lac_failure_from(const lac_failure_start *start, double rate, double slip);

/// How far a state is past the rate of failure, the one measure of runs, fits and forecasts: the
/// logarithm of the mean slip rate over it. One cell that slips alone carries the mean of n cells
/// past a rate that is lowered, and stops; so there it is no more than
///     [sum p (f(v) - f(rate)) + n eta (mean - rate)]/[sum a p + n eta rate],
/// which is >= 0 just where all cells, sliding as one with the states that they have under the load
/// that they carry, would slide at `rate` or faster. Of cells that slip alike, or one, that is the
/// same.
/// @param work  its first n doubles are then the slip rates
/// @return < 0 before failure; NaN where a rate is
/// @source derived here; docs/theory/creep.md, eq. 11
double lac_problem_past_failure(const lac_problem *problem, const lac_failure *failure, double t,
                                const double *y, double *work);

/// Whether the formulation can follow every cell: where its shear traction vanishes, slip stops or
/// turns back, which ln v cannot do, nor the plain form of friction, infinite at v = 0.
/// @param cell  the first that does not; untouched where all do
bool lac_problem_slips(const lac_problem *problem, double t, const double *y, size_t *cell,
                       double *work);

/// ln|v| below which a cell with mass is at rest: slower, m/step^2 soon leaves the numbers.
#define LAC_AT_REST (-300.0)

/// Whether a cell with mass comes to rest for good: its friction, so little of it direct effect,
/// would hold it below LAC_AT_REST only.
/// @param cell  the first that does; untouched where none does
bool lac_problem_rests(const lac_problem *problem, double t, const double *y, size_t *cell,
                       double *work);

/// Whether the dip or thickness of the base follows slip; and whether such a joint, which has mass,
/// rests for good: lac_problem_rests, and no cell moves faster than that means.
bool lac_problem_bends(const lac_problem *problem);
bool lac_problem_settles(const lac_problem *problem, double t, const double *y, double *work);

/// What is asked of the initial rate and state (a case's section `initial`).
typedef enum lac_initial_state {
    LAC_STATE_FROM_LOAD, ///< theta balances the load at the given rate
    LAC_STATE_STEADY,    ///< theta steady at the given rate, or rate and state steady under load
    LAC_STATE_TIME,      ///< theta given [s]
    LAC_STATE_RATIO,     ///< theta = x theta_ss at the load that follows
} lac_initial_state;

typedef struct lac_initial_def {
    double slip_rate; ///< [m/s]; NaN: follows from the load
    lac_initial_state state;
    double state_value;   ///< theta [s] or x [1]
    const double *rates;  ///< [n] slip rate of each cell instead of slip_rate; NULL
    const double *states; ///< [n] theta or x of each cell instead of state_value; NULL
} lac_initial_def;

/// Initial ln v and ln theta of every cell, from what is given and the loads at t = 0.
lac_status lac_initial_solve(const lac_initial_def *initial, const lac_domain *domain,
                             const lac_friction *friction, const lac_load_set *loads,
                             lac_damping damping, double *log_rate, double *log_state,
                             lac_error *err);
