// SPDX-License-Identifier: GPL-3.0-or-later
// The friction coefficient of rate and state, plain or regularised, in forms that never overflow;
// smooth cut-offs: it feels no slip rate far above v1 and no state far below dc/v2.
#include "friction/cutoff.h"

#include "base/clones.h"
#include "base/vmath.h"
#include "base/vmath_kernels.h"
#include "friction/law.h"

// Both cut-offs are one function. With S(d) = ln(1 + e^d),
//   W = w + S(ln_cut - w) = ln(theta + dc/v2),   U = u - S(u - ln_v1) = -ln(1/v + 1/v1),
// so y = x + s S(s (limit - x)) with s = 1 for the state and s = -1 for the rate. With
// d = s (limit - x), y' = 1/(1 + e^d) and y'' = s e^d/(1 + e^d)^2. Only exp(-|d|) is formed, which
// neither overflows nor, where a cell has no cut-off (d = -infinity), is anything but 0.

// One variable, u or w, as the strength sees it beyond a cut-off.
typedef struct softened_variable {
    double value[LAC_FRICTION_BLOCK]; // U or W
    double slope[LAC_FRICTION_BLOCK]; // dU/du or dW/dw, in (0, 1]
    double bend[LAC_FRICTION_BLOCK];  // d2U/du2 or d2W/dw2
} softened_variable;

typedef struct cutoff_variables {
    softened_variable rate, state;
} cutoff_variables;

static void identity(size_t n, const double *x, softened_variable *out)
{
    memcpy(out->value, x, n * sizeof *x);
    for (size_t i = 0; i < n; i++) {
        out->slope[i] = 1;
        out->bend[i] = 0;
    }
}

static void soften(size_t n, const double *x, const double *limit, double s, softened_variable *out)
{
    double *e = out->bend, *log_part = out->slope;
    for (size_t i = 0; i < n; i++) {
        e[i] = -fabs(limit[i] - x[i]);
    }
    lac_vexp(n, e, e);
    for (size_t i = 0; i < n; i++) {
        log_part[i] = 1 + e[i];
    }
    lac_vlog(n, log_part, log_part);
    for (size_t i = 0; i < n; i++) {
        bool beyond = s * limit[i] > s * x[i];
        double part = 1 / (1 + e[i]);
        out->value[i] = (beyond ? limit[i] : x[i]) + s * log_part[i];
        out->slope[i] = beyond ? e[i] * part : part;
        out->bend[i] = s * e[i] * part * part;
    }
}

// U(u) = u - ln(1 + v/v1) and W(w) = ln(theta + dc/v2) of cells first ... first + n - 1.
static void map(const lac_friction *friction, size_t first, size_t n, const double *u,
                const double *w, cutoff_variables *cutoff)
{
    if (friction->ln_v1.value != NULL) {
        soften(n, u, lac_cellwise_from(&friction->ln_v1, first), -1, &cutoff->rate);
    } else {
        identity(n, u, &cutoff->rate);
    }
    if (friction->ln_cut.value != NULL) {
        soften(n, w, lac_cellwise_from(&friction->ln_cut, first), 1, &cutoff->state);
    } else {
        identity(n, w, &cutoff->state);
    }
}

// Turns derivatives by U and W into derivatives by u and w.
static void chain(const cutoff_variables *cutoff, size_t n, const lac_friction_values *values,
                  const lac_friction_slopes *slopes)
{
    const softened_variable *rate = &cutoff->rate, *state = &cutoff->state;
    for (size_t i = 0; slopes != NULL && i < n; i++) {
        double by_u = rate->slope[i], by_w = state->slope[i];
        slopes->f_uu[i] = slopes->f_uu[i] * by_u * by_u + values->f_u[i] * rate->bend[i];
        slopes->f_uw[i] *= by_u * by_w;
        slopes->f_ww[i] = slopes->f_ww[i] * by_w * by_w + values->f_w[i] * state->bend[i];
    }
    for (size_t i = 0; i < n; i++) {
        values->f_u[i] *= rate->slope[i];
        values->f_w[i] *= state->slope[i];
    }
}

double lac_cutoff_rate(const lac_friction *friction, size_t cell, double u)
{
    if (friction->ln_v1.value == NULL) {
        return u;
    }
    softened_variable rate;
    soften(1, &u, lac_cellwise_from(&friction->ln_v1, cell), -1, &rate);
    return rate.value[0];
}

double lac_cutoff_state(const lac_friction *friction, size_t cell, double w)
{
    if (friction->ln_cut.value == NULL) {
        return w;
    }
    softened_variable state;
    soften(1, &w, lac_cellwise_from(&friction->ln_cut, cell), 1, &state);
    return state.value[0];
}

// e^-u = e^-U - 1/v1
double lac_cutoff_rate_of(const lac_friction *friction, size_t cell, double softened)
{
    if (friction->ln_v1.value == NULL) {
        return softened;
    }
    double past = softened - lac_cellwise_of(&friction->ln_v1, cell);
    return past < 0 ? softened - log(-expm1(past)) : (double)NAN;
}

// e^w = e^W - dc/v2
double lac_cutoff_state_of(const lac_friction *friction, size_t cell, double softened)
{
    if (friction->ln_cut.value == NULL) {
        return softened;
    }
    double short_of = lac_cellwise_of(&friction->ln_cut, cell) - softened;
    return short_of < 0 ? softened + log(-expm1(short_of)) : (double)NAN;
}

// Both forms are one: with F = constant + a U + b W the plain coefficient (U = u and W = w but for
// cut-offs), the regularised one is a asinh(X), ln X = F/a - ln 2. So X is formed from its
// logarithm, and neither form overflows.

#define LN_2 0.693147180559945309417232121458 // M_LN2 is not in C11

// Above this X, asinh(X) = ln(2X) to the last bit and f is the plain one.
#define TAIL 4e8
// ln X is held below this, so that X^2 stays finite.
#define LOG_MOST 300.0
// Below this 1/sqrt(1 + X^2), curvatures are 0.
#define STRAIGHT 1e-129
// Stands in for a = 0, whose limit f = max(F, 0) it reproduces; b^2/a stays finite.
#define SMALLEST_A 1e-290

const char *const lac_friction_form_names[] = {"plain", "regularised", NULL};

// F = constant + a U + b W
LAC_CLONES static void lac_form_plain_coefficient(const lac_friction *friction, size_t first,
                                                  size_t n, const double *u, const double *w,
                                                  double *f)
{
    const double *constant = lac_cellwise_from(&friction->constant, first);
    const double *a = lac_cellwise_from(&friction->column[LAC_A], first);
    const double *b = lac_cellwise_from(&friction->column[LAC_B], first);
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        f[i] = constant[i] + a[i] * u[i] + b[i] * w[i];
    }
}

static void plain_slopes(const lac_friction *friction, size_t first, size_t n,
                         const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    if (values->f_u == NULL) {
        return;
    }
    memcpy(values->f_u, lac_cellwise_from(&friction->column[LAC_A], first), n * sizeof(double));
    memcpy(values->f_w, lac_cellwise_from(&friction->column[LAC_B], first), n * sizeof(double));
    if (slopes != NULL) {
        memset(slopes->f_uu, 0, n * sizeof(double));
        memset(slopes->f_uw, 0, n * sizeof(double));
        memset(slopes->f_ww, 0, n * sizeof(double));
    }
}

static double at_least_smallest(double a) { return a > SMALLEST_A ? a : SMALLEST_A; }

// With r = 1/sqrt(1 + X^2), s = X r and ds = ds/dlnX = s r^2:
// f_uu = a ds,  f_uw = b ds,  f_ww = b^2/a ds
LAC_CLONES static void lac_form_regularised_slopes(const double *a, const double *b, size_t n,
                                                   const double *s, const double *r,
                                                   const lac_friction_slopes *slopes)
{
    double *f_uu = slopes->f_uu, *f_uw = slopes->f_uw, *f_ww = slopes->f_ww;
    for (size_t i = 0; i < n; i++) {
        double ds = s[i] * r[i] * r[i];
        ds = r[i] > STRAIGHT ? ds : 0;
        f_uu[i] = a[i] * ds;
        f_uw[i] = b[i] * ds;
        f_ww[i] = b[i] / at_least_smallest(a[i]) * b[i] * ds;
    }
}

// How many of the cells are not so far up that f is the plain coefficient: 21 > ln(2 TAIL).
LAC_CLONES static size_t lac_form_count_bent(const double *a, size_t n, const double *f)
{
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        count += f[i] > 21.0 * at_least_smallest(a[i]) ? 0 : 1;
    }
    return count;
}

// s and r as below, where f stays as it is.
LAC_CLONES static void lac_form_far(const double *a, size_t n, const double *f, double *s,
                                    double *r)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double log_x = f[i] / at_least_smallest(a[i]) - LN_2;
        double x = lac_exp_one(log_x > LOG_MOST ? LOG_MOST : log_x);
        r[i] = 1 / sqrt(1 + x * x);
        s[i] = x * r[i];
    }
}

// f = a asinh(X) of what is the plain coefficient before, s = X r and r = 1/sqrt(1 + X^2)
// @param r  NULL: f is all that is wanted
static inline __attribute__((always_inline)) void bend_all(const double *a, size_t n, double *f,
                                                           double *s, double *r)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double log_x = f[i] / at_least_smallest(a[i]) - LN_2;
        double x = lac_exp_one(log_x > LOG_MOST ? LOG_MOST : log_x);
        double bent = a[i] * lac_asinh_one(x);
        f[i] = x > TAIL ? f[i] : bent;
        if (r != NULL) {
            r[i] = 1 / sqrt(1 + x * x);
            s[i] = x * r[i];
        }
    }
}

LAC_CLONES static void lac_form_regularise(const double *a, size_t n, double *f, double *s,
                                           double *r)
{
    bend_all(a, n, f, s, r);
}

LAC_CLONES static void lac_form_regularise_alone(const double *a, size_t n, double *f)
{
    bend_all(a, n, f, NULL, NULL);
}

// f_u = a s,  f_w = b s
LAC_CLONES static void lac_form_gains(const double *a, const double *b, size_t n, double *f_u,
                                      double *f_w)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double s = f_u[i];
        f_w[i] = b[i] * s;
        f_u[i] = a[i] * s;
    }
}

// On entry values->f holds the plain coefficient.
static void regularise(const double *a, const double *b, size_t n,
                       const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    double *s = values->f_u, *r = values->f_w;
    const bool bent = lac_form_count_bent(a, n, values->f) > 0;
    if (s == NULL) { // f is all that is wanted
        if (bent) {
            lac_form_regularise_alone(a, n, values->f);
        }
        return;
    }
    if (bent) {
        lac_form_regularise(a, n, values->f, s, r);
    } else {
        lac_form_far(a, n, values->f, s, r);
    }
    if (slopes != NULL) {
        lac_form_regularised_slopes(a, b, n, s, r, slopes);
    }
    lac_form_gains(a, b, n, values->f_u, values->f_w);
}

// Strength as a function of U and W, which stand in u and w.
static void strength(const lac_friction *friction, size_t first, size_t n, const double *u,
                     const double *w, const lac_friction_values *values,
                     const lac_friction_slopes *slopes)
{
    lac_form_plain_coefficient(friction, first, n, u, w, values->f);
    if (friction->form == LAC_FORM_REGULARISED) {
        regularise(lac_cellwise_from(&friction->column[LAC_A], first),
                   lac_cellwise_from(&friction->column[LAC_B], first), n, values, slopes);
    } else {
        plain_slopes(friction, first, n, values, slopes);
    }
}

void lac_form_evaluate(const lac_friction *friction, size_t first, size_t n, const double *u,
                       const double *w, const lac_friction_values *values,
                       const lac_friction_slopes *slopes)
{
    if (!lac_cutoff_any(friction)) {
        strength(friction, first, n, u, w, values, slopes);
        return;
    }
    cutoff_variables cutoff;
    map(friction, first, n, u, w, &cutoff);
    strength(friction, first, n, cutoff.rate.value, cutoff.state.value, values, slopes);
    chain(&cutoff, n, values, slopes);
}

double lac_friction_plain(const lac_friction *friction, size_t cell, double u, double w)
{
    double rate = lac_cutoff_rate(friction, cell, u);
    double state = lac_cutoff_state(friction, cell, w);
    return lac_cellwise_of(&friction->constant, cell) +
           lac_cellwise_of(&friction->column[LAC_A], cell) * rate +
           lac_cellwise_of(&friction->column[LAC_B], cell) * state;
}

double lac_form_plain_of(const lac_friction *friction, size_t cell, double f)
{
    if (friction->form == LAC_FORM_PLAIN) {
        return f;
    }
    if (!(f > 0)) {
        return NAN;
    }
    // a ln(2 sinh(f/a)) = f + a ln(1 - exp(-2 f/a)): no overflow, no cancellation, right at a = 0
    double a = lac_cellwise_of(&friction->column[LAC_A], cell);
    return f + a * log(-expm1(-2 * (f / a)));
}
