// SPDX-License-Identifier: GPL-3.0-or-later
// The friction coefficient of rate and state, plain or regularised, in forms that never overflow.
#include "friction/cutoff.h"

#include <math.h>
#include <string.h>

#include "base/clones.h"
#include "base/vmath.h"
#include "friction/law.h"

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

// f = a asinh(X),  f_u = a s,  f_w = b s
// On entry values->f holds the plain coefficient. X, then s, pass through f_u, and asinh(X), then
// r, through f_w.
static void regularise(const double *a, const double *b, size_t n,
                       const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    double *f = values->f, *f_u = values->f_u, *f_w = values->f_w;
    for (size_t i = 0; i < n; i++) {
        double log_x = f[i] / at_least_smallest(a[i]) - LN_2;
        f_u[i] = log_x > LOG_MOST ? LOG_MOST : log_x;
    }
    lac_vexp(n, f_u, f_u);
    lac_vasinh(n, f_u, f_w);
    for (size_t i = 0; i < n; i++) {
        double x = f_u[i], r = 1 / sqrt(1 + x * x);
        double plain = f[i], bent = a[i] * f_w[i];
        f[i] = x > TAIL ? plain : bent;
        f_u[i] = x * r;
        f_w[i] = r;
    }
    if (slopes != NULL) {
        lac_form_regularised_slopes(a, b, n, f_u, f_w, slopes);
    }
    for (size_t i = 0; i < n; i++) {
        f_w[i] = b[i] * f_u[i];
        f_u[i] = a[i] * f_u[i];
    }
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
    lac_cutoff cutoff;
    lac_cutoff_map(friction, first, n, u, w, &cutoff);
    strength(friction, first, n, cutoff.rate.value, cutoff.state.value, values, slopes);
    lac_cutoff_chain(&cutoff, n, values, slopes);
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
