// SPDX-License-Identifier: GPL-3.0-or-later
#include "friction/form.h"

#include <math.h>

#include "base/vmath.h"
#include "friction/law.h"

// Both forms are one: with F = constant + a u + b w the plain coefficient, the regularised one is
// a asinh(X), ln X = F/a - ln 2. So X is formed from its logarithm, and neither form overflows.

#define LN_2 0.693147180559945309417232121458 // M_LN2 is not in C11

// Above this X, asinh(X) = ln(2X) to the last bit and f is the plain one.
#define TAIL 4e8
// ln X is held below this, so that X^2 stays finite.
#define LOG_MOST 300.0
// Above this X, curvatures are 0.
#define STRAIGHT 1e130
// Stands in for a = 0, whose limit f = max(F, 0) it reproduces; b^2/a stays finite.
#define SMALLEST_A 1e-290

const char *const lac_friction_form_names[] = {"plain", "regularised", NULL};

// F = constant + a u + b w
static void plain_coefficient(const lac_friction *friction, size_t first, size_t n, const double *u,
                              const double *w, double *f)
{
    const double *constant = friction->constant + first;
    const double *a = friction->column[LAC_A] + first;
    const double *b = friction->column[LAC_B] + first;
    for (size_t i = 0; i < n; i++) {
        f[i] = constant[i] + a[i] * u[i] + b[i] * w[i];
    }
}

static void plain_slopes(const lac_friction *friction, size_t first, size_t n,
                         const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    for (size_t i = 0; i < n; i++) {
        values->f_u[i] = friction->column[LAC_A][first + i];
        values->f_w[i] = friction->column[LAC_B][first + i];
    }
    if (slopes != NULL) {
        for (size_t i = 0; i < n; i++) {
            slopes->f_uu[i] = slopes->f_uw[i] = slopes->f_ww[i] = 0;
        }
    }
}

static double at_least_smallest(double a) { return a > SMALLEST_A ? a : SMALLEST_A; }

// f_uu = a ds,  f_uw = b ds,  f_ww = b^2/a ds  with  ds = ds/dlnX = X/(1 + X^2)^(3/2)
static void regularised_slopes(const double *a, const double *b, size_t n, const double *x,
                               const lac_friction_slopes *slopes)
{
    for (size_t i = 0; i < n; i++) {
        double square = x[i] * x[i];
        double ds = x[i] < STRAIGHT ? x[i] / (sqrt(1 + square) * (1 + square)) : 0;
        slopes->f_uu[i] = a[i] * ds;
        slopes->f_uw[i] = b[i] * ds;
        slopes->f_ww[i] = b[i] / at_least_smallest(a[i]) * b[i] * ds;
    }
}

// f = a asinh(X),  f_u = a s,  f_w = b s  with  s = X/sqrt(1 + X^2)
// On entry values->f holds the plain coefficient; X and asinh(X) pass through f_u and f_w.
static void regularise(const double *a, const double *b, size_t n,
                       const lac_friction_values *values, const lac_friction_slopes *slopes)
{
    double *x = values->f_u, *angle = values->f_w;
    for (size_t i = 0; i < n; i++) {
        double log_x = values->f[i] / at_least_smallest(a[i]) - LN_2;
        x[i] = log_x > LOG_MOST ? LOG_MOST : log_x;
    }
    lac_vexp(n, x, x);
    lac_vasinh(n, x, angle);
    if (slopes != NULL) {
        regularised_slopes(a, b, n, x, slopes);
    }
    for (size_t i = 0; i < n; i++) {
        double s = x[i] / sqrt(1 + x[i] * x[i]);
        values->f[i] = x[i] > TAIL ? values->f[i] : a[i] * angle[i];
        values->f_u[i] = a[i] * s;
        values->f_w[i] = b[i] * s;
    }
}

void lac_form_evaluate(const lac_friction *friction, size_t first, size_t n, const double *u,
                       const double *w, const lac_friction_values *values,
                       const lac_friction_slopes *slopes)
{
    plain_coefficient(friction, first, n, u, w, values->f);
    if (friction->form == LAC_FORM_REGULARISED) {
        regularise(friction->column[LAC_A] + first, friction->column[LAC_B] + first, n, values,
                   slopes);
    } else {
        plain_slopes(friction, first, n, values, slopes);
    }
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
    double a = friction->column[LAC_A][cell];
    return f + a * log(-expm1(-2 * (f / a)));
}
