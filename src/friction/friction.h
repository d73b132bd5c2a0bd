/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/param.h"

/// Kernels work on blocks of at most this many cells, so that scratch stays in the L1 cache.
enum { LAC_FRICTION_BLOCK = 256 };

/// Every law's parameter struct starts with these, in this order.
typedef struct lac_friction_params {
    double f0;             ///< friction coefficient at v0 in steady state [1]
    double a;              ///< direct effect [1]
    double b;              ///< evolution effect [1]
    double dc;             ///< slip to renew the contacts [m]
    double v0;             ///< reference slip rate [m/s]
    int form;              ///< lac_friction_form
    double v1;             ///< cut-off slip rate of the direct effect [m/s]; NaN: none
    double v2;             ///< cut-off slip rate of the evolution effect [m/s]; NaN: none
    double alpha;          ///< response of the state to normal stress [1]; NaN: none
    int rock;              ///< index of lac_rock_get that f0, a, b and dc were taken from; -1: none
    double friction_angle; ///< read into f0, then NaN [rad]
    double cohesion;       ///< strength over the nominal area whatever the pressure [Pa]; NaN: none
    double flash_rate;     ///< v_w, from which flash heating weakens contacts [m/s]; NaN: none
    double flash_friction; ///< f_w, what is left far beyond v_w [1]; NaN
} lac_friction_params;

/// Numbers that a source may state of a rock; the first four as in lac_friction_params.
enum { LAC_ROCK_F0, LAC_ROCK_A, LAC_ROCK_B, LAC_ROCK_DC, LAC_ROCK_A_B, LAC_ROCK_VALUES };

typedef struct lac_rock_quantity {
    const char *key, *unit; ///< SI
} lac_rock_quantity;
extern const lac_rock_quantity lac_rock_quantities[LAC_ROCK_VALUES];

/// What is taken for a number, and between what it lies by the source.
typedef struct lac_rock_value {
    double value, low, high;
} lac_rock_value;

/// A rock or gouge, and what a source states of its friction.
typedef struct lac_rock {
    const char *name, *summary;
    const char *source;     ///< authors, year, journal, doi, table
    const char *read_at;    ///< address of what was opened
    const char *conditions; ///< stress, temperature, slip rate, water; and which value is taken
    bool in_field;          ///< found from a slope that failed, not measured in a laboratory
    bool degrees;           ///< f0 stands as an angle; lac_rock_value_of gives its tangent
    lac_rock_value stated[LAC_ROCK_VALUES];
} lac_rock;

/// The index-th rock, NULL past the end.
const lac_rock *lac_rock_get(size_t index);

/// A number of a rock, SI; NaN where its source does not state it.
/// @param which  LAC_ROCK_F0 ...
lac_rock_value lac_rock_value_of(const lac_rock *rock, int which);

/// How the friction coefficient depends on u = ln v and w = ln theta. Cut-off slip rates put
/// v/(1 + v/v1) in the place of v and theta + dc/v2 in the place of theta, in either form.
typedef enum lac_friction_form {
    LAC_FORM_PLAIN = 0,   ///< f = f0 + a ln(v/v0) + b ln(v0 theta/dc)
    LAC_FORM_REGULARISED, ///< f = a asinh(v/(2 v0) exp((f0 + b ln(v0 theta/dc))/a))
} lac_friction_form;

/// A stretch of cells and the state they are in.
typedef struct lac_friction_cells {
    size_t first, n;            ///< cells first ... first + n - 1, n <= LAC_FRICTION_BLOCK
    const double *u, *w, *v;    ///< [n] ln v, ln theta and v of these cells; v = exp(u)
    double normal_rate;         ///< d ln(effective normal pressure)/dt, the same for all [1/s]
    const double *normal_rates; ///< [n] or of each of these cells instead; NULL
} lac_friction_cells;

/// Friction coefficient and state evolution over a block of cells.
typedef struct lac_friction_values {
    double *f;   ///< friction coefficient [1]
    double *f_u; ///< df/du
    double *f_w; ///< df/dw
    double *g;   ///< dw/dt [1/s]
} lac_friction_values;

/// Derivatives that only a Newton matrix needs.
typedef struct lac_friction_slopes {
    double *f_uu, *f_uw, *f_ww;
    double *g_u, *g_w; ///< [1/s]
} lac_friction_slopes;

/// One number of every cell. Where all are alike it is stored once for a block of cells, which
/// kernels read as they read the cells' own.
typedef struct lac_cellwise {
    double *value; ///< [n], or [min(n, LAC_FRICTION_BLOCK)] where alike; NULL: no cell has one
    size_t mask;   ///< of a cell's number: all ones, or 0 where alike
} lac_cellwise;

/// What one cell has; there must be values.
static inline double lac_cellwise_of(const lac_cellwise *column, size_t cell)
{
    return column->value[cell & column->mask];
}

/// What the cells from `first` on have, LAC_FRICTION_BLOCK of them at most.
static inline const double *lac_cellwise_from(const lac_cellwise *column, size_t first)
{
    return column->value + (first & column->mask);
}

/// The cells' parameters. Transparent to laws; others go through the functions below.
typedef struct lac_friction {
    const struct lac_friction_law *law;
    int form;
    size_t n;              ///< cells
    double cohesion;       ///< over the nominal area, whatever the pressure [Pa]; 0: none
    size_t columns;        ///< cell-wise parameters of the law, in the order of its table
    lac_cellwise *column;  ///< [columns] SI; without values: optional, and no cell has it
    lac_cellwise constant; ///< f0 + (b - a) ln v0 - b ln dc: F = constant + a U + b W
    lac_cellwise ln_dc;    ///< ln dc
    lac_cellwise inv_dc;   ///< [1/m]
    lac_cellwise ln_v1;    ///< U = u - ln(1 + v/v1); without values: U = u
    lac_cellwise ln_cut;   ///< ln(dc/v2): W = ln(theta + dc/v2); without values: W = w
    lac_cellwise response; ///< alpha/b: dw/dt falls by this times normal_rate; may have no values
} lac_friction;

/// Columns that every law has.
enum {
    LAC_F0,
    LAC_A,
    LAC_B,
    LAC_DC,
    LAC_V0,
    LAC_V1,
    LAC_V2,
    LAC_ALPHA,
    LAC_FLASH_RATE,
    LAC_FLASH_FRICTION,
    LAC_COMMON_COLUMNS
};

/// One cell by itself over a step in which ln v is linear in slip; docs/theory/fidelity-events.md,
/// eqs. 3-6.
typedef struct lac_lone_step {
    double length;       ///< h [s]
    double u, w, ln_dc;  ///< ln v and ln theta at its start; ln dc
    double rho, em, phi; ///< ln(v1/v0); e^-rho - 1; (1 - e^-rho)/rho
    double z, dz;        ///< slip over dc, and its derivative by rho
    double uneven;       ///< mean of ln v over the step less that of its ends
    double bend; ///< what ln v is below its line of slip at its middle, times 4; -6 times its part
                 ///< of `uneven`
} lac_lone_step;

/// How a cell takes steps of its own, as fidelity events has them.
typedef struct lac_friction_lone {
    /// dw/dt [1/s]. @param renewal  v/dc [1/s]
    double (*change)(double u, double w, double ln_dc, double renewal);
    /// @param w, dw  ln theta at the end, and its derivative by rho; overwritten
    void (*step)(const lac_lone_step *step, double *w, double *dw);
} lac_friction_lone;

/// A friction law: how the state evolves. The strength is one of the forms.
typedef struct lac_friction_law {
    lac_model_info info;
    /// g = dw/dt of the cells at constant normal stress, and its derivatives.
    /// @param g         [n]; overwritten
    /// @param g_u, g_w  [n]; overwritten, or NULL where not wanted (both)
    void (*evolve)(const lac_friction *friction, const lac_friction_cells *cells, double *g,
                   double *g_u, double *g_w);
    /// ln theta at which a cell sliding at ln v = u is steady.
    double (*steady_state)(const lac_friction *friction, size_t cell, double u);
    const lac_friction_lone *lone; ///< NULL: fidelity events cannot follow it
    bool block_form; ///< a block by itself moves by (O2) of docs/theory/creep.md, a closed form
} lac_friction_law;

/// The index-th law, NULL past the end.
const lac_friction_law *lac_friction_law_get(size_t index);

/// The index-th thing that any law can have besides (cut-off ...), with those of the common
/// parameters that say so; NULL past the end.
const lac_model_info *lac_friction_option_get(size_t index);

/// Cells that all have the parameters of the model.
lac_status lac_friction_create(const lac_model *model, size_t n, lac_friction **out,
                               lac_error *err);
void lac_friction_free(lac_friction *friction);

/// Some of the cells. @param cell  [n] which
lac_status lac_friction_pick(const lac_friction *of, const uint32_t *cell, size_t n,
                             lac_friction **out, lac_error *err);

/// Gives the cells values of their own for one LAC_CELLWISE parameter of the law, checked against
/// its range.
lac_status lac_friction_set(lac_friction *friction, const char *key, const double *values,
                            lac_error *err);

/// What the cells have of one parameter; NULL where the law has no such cell-wise one, or no cell.
const lac_cellwise *lac_friction_values_of(const lac_friction *friction, const char *key);

/// Whether the cells weaken by flash heating, f_w + (f - f_w)/(1 + v/v_w): at a state that stays
/// their friction then falls with v beyond some rate, so that no balance tells the rate there.
bool lac_friction_flashes(const lac_friction *friction);

/// Whether the parameters of every cell go together: alpha > 0 needs b > 0.
lac_status lac_friction_check(const lac_friction *friction, lac_error *err);

/// Evaluates strength and evolution over some cells.
/// At fixed w, f rises with u without end where a > 0 and there is no v1; with v1 it still rises,
/// but f_u falls to a v1/v and f stays below its value at v >> v1: no rate carries more than that
/// without damping, and f is not convex in u. f rises with w where b > 0. With flash heating f
/// falls to f_w beyond v_w.
/// @param values  [n] arrays; overwritten; f NULL: g alone, no strength is worked out
/// @param slopes  [n] arrays; overwritten; NULL where not wanted, as it must be where f is
void lac_friction_evaluate(const lac_friction *friction, const lac_friction_cells *cells,
                           const lac_friction_values *values, const lac_friction_slopes *slopes);

/// Friction coefficient of one cell; and the plain one, F = constant + a U + b W, whatever the
/// form.
double lac_friction_coefficient(const lac_friction *friction, size_t cell, double u, double w);
double lac_friction_plain(const lac_friction *friction, size_t cell, double u, double w);

double lac_friction_steady_state(const lac_friction *friction, size_t cell, double u);

/// ln theta of a cell that slides at ln v = u and whose state is x times the one that would be
/// steady under the same friction coefficient; docs/theory/friction.md eq. 7.
/// @return NaN where there is none (cut-off slip rates)
double lac_friction_state_at_ratio(const lac_friction *friction, size_t cell, double u, double x);

/// ln theta after the effective normal pressure has jumped; the state w before it.
/// theta falls by (pressure after/pressure before)^(alpha/b).
/// @source Linker & Dieterich (1992), doi 10.1029/92JB00017
double lac_friction_state_after(const lac_friction *friction, size_t cell, double w,
                                double pressure_ratio);

/// ln theta at which the cell has coefficient f at ln v = u; NaN where there is none (b = 0; f
/// below what v2 leaves).
double lac_friction_state_for(const lac_friction *friction, size_t cell, double u, double f);

/// ln v at which the cell in state w carries traction tau: p f(u, w) + eta e^u = tau.
/// Where flash heating leaves several, the slowest.
/// @return NaN where there is none (a = 0 and eta = 0, tau <= 0 regularised, tau beyond what v1
///         or flash heating lets friction reach)
double lac_friction_rate_for(const lac_friction *friction, size_t cell, double w, double tau,
                             double pressure, double eta);

/// Bounds of the ln|v| that lac_friction_rates gives: a traction that would take it beyond is
/// met by the bound, so that no trial step of an integrator has to fail; a run that comes to the
/// upper one ends with an error.
#define LAC_SLOWEST (-600.0)
#define LAC_FASTEST 40.0

/// Cells whose rates are sought from what they carry.
typedef struct lac_friction_balance {
    size_t first, n;        ///< as in lac_friction_cells
    const double *w;        ///< [n] ln theta
    const double *traction; ///< [n] of either sign [Pa]
    const double *pressure; ///< [n] total normal pressure [Pa]
    double share;           ///< effective over total normal pressure [1]
    double damping;         ///< eta [Pa s/m]
} lac_friction_balance;

/// Slip rates, of either sign, at which cells carry given tractions:
/// p f(ln|v|, w) + eta |v| = |tau|, v of the sign of tau; docs/theory/friction.md, eq. 5.
/// A NaN in w or the traction comes out as NaN or as a bound, never as a hang.
/// @param u  [n] ln|v|; on entry where to begin, 0: nowhere in particular. The result depends on
///           it by rounding only
/// @param v  [n] [m/s]; overwritten; never 0
/// @cost  two evaluations of the strength from a close start; allocates nothing
void lac_friction_rates(const lac_friction *friction, const lac_friction_balance *balance,
                        double *u, double *v);
