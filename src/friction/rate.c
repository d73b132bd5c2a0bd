// SPDX-License-Identifier: GPL-3.0-or-later
#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "friction/form.h"

// Every residual below is convex and increasing in u = ln v, and every start lies at or right of
// its root. There Newton's method falls monotonically onto the root: once it stops falling it has
// arrived. The limit on iterations is never met; it is there because nothing may hang.
enum { MOST_ITERATIONS = 200 };

// One cell's equation  p f(u) + eta e^u = tau.
typedef struct balance {
    const lac_friction *friction;
    size_t cell;
    double w, tau, p, eta;
} balance;

// Whether Newton's step still moves u.
static bool falls(double du, double u) { return du > DBL_EPSILON * fmax(1, fabs(u)); }

// Root of  u + (eta/A) e^u = r,  A = a p > 0: the plain form's balance.
static double plain_rate(double r, double eta, double a_p)
{
    if (!(eta > 0)) {
        return r;
    }
    double k = log(eta) - log(a_p);
    double z = r + k; // s + e^s = z for s = u + k
    double u = z <= 1 ? r : log(z) - k;
    for (int i = 0; i < MOST_ITERATIONS; i++) {
        double e = exp(u + k);
        double du = (u - r + e) / (1 + e);
        u -= du;
        if (!falls(du, u)) {
            break;
        }
    }
    return u;
}

static double regularised_rate(const balance *eq, double start)
{
    double u = start;
    for (int i = 0; i < MOST_ITERATIONS; i++) {
        double f, f_u, f_w, viscous = eq->eta * exp(u);
        lac_form_evaluate(eq->friction, eq->cell, 1, &u, &eq->w,
                          &(lac_friction_values){.f = &f, .f_u = &f_u, .f_w = &f_w}, NULL);
        double du = (eq->p * f + viscous - eq->tau) / (eq->p * f_u + viscous);
        u -= du;
        if (!falls(du, u)) {
            break;
        }
    }
    return u;
}

// No direct effect (a p = 0): only damping can tell the rate.
static double damped_rate(const balance *eq)
{
    double f = lac_friction_coefficient(eq->friction, eq->cell, 0, eq->w);
    double rest = eq->tau - eq->p * f;
    return rest > 0 && eq->eta > 0 ? log(rest) - log(eq->eta) : NAN;
}

double lac_friction_rate_for(const lac_friction *friction, size_t cell, double w, double tau,
                             double pressure, double eta)
{
    balance eq = {friction, cell, w, tau, pressure, eta};
    double a = friction->column[LAC_A][cell], a_p = a * pressure;
    bool regularised = friction->form == LAC_FORM_REGULARISED;
    if (!(pressure >= 0 && eta >= 0) || !isfinite(tau) || !isfinite(w) ||
        (regularised && tau <= 0)) {
        return NAN;
    }
    if (!(a_p > 0)) {
        return damped_rate(&eq);
    }
    double from_state = friction->constant[cell] + friction->column[LAC_B][cell] * w;
    double u_plain = plain_rate((tau / pressure - from_state) / a, eta, a_p);
    if (!regularised) {
        return u_plain;
    }
    // Three upper bounds: f >= the plain form's; without damping; without friction.
    double u_undamped = (lac_form_plain_of(friction, cell, tau / pressure) - from_state) / a;
    if (!(eta > 0)) {
        return u_undamped;
    }
    return regularised_rate(&eq, fmin(fmin(u_plain, u_undamped), log(tau) - log(eta)));
}
