// SPDX-License-Identifier: GPL-3.0-or-later
// The slip rate at which one cell balances its shear stress, found without a first guess.
#include "friction/cutoff.h"

// Without a cut-off of the direct effect every residual below is convex and increasing in u = ln v,
// and every start lies at or right of its root. There Newton's method falls monotonically onto the
// root: once it stops falling it has arrived. The limit on iterations is never met; it is there
// because nothing may hang.
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

// p f + eta e^u - tau, and its slope.
static double residual(const balance *eq, double u, double *slope)
{
    double f, f_u, f_w, viscous = eq->eta * exp(u);
    lac_form_evaluate(eq->friction, eq->cell, 1, &u, &eq->w,
                      &(lac_friction_values){.f = &f, .f_u = &f_u, .f_w = &f_w}, NULL);
    *slope = eq->p * f_u + viscous;
    return eq->p * f + viscous - eq->tau;
}

// The slowest rate at which a cell that flash heating weakens balances: from the rate without it,
// which is slower. Up to where friction begins to fall the residual is concave, so that Newton's
// method rises onto the root; past that there is none.
static double flashed_rate(const balance *eq, double start)
{
    double u = start;
    for (int i = 0; i < MOST_ITERATIONS; i++) {
        double f, f_u, f_w, g = 0, v = exp(u);
        const lac_friction_values values = {.f = &f, .f_u = &f_u, .f_w = &f_w, .g = &g};
        const lac_friction_cells one = {.first = eq->cell, .n = 1, .u = &u, .w = &eq->w, .v = &v};
        lac_form_evaluate(eq->friction, eq->cell, 1, &u, &eq->w, &values, NULL);
        lac_flash_weaken(eq->friction, &one, &values, NULL);
        double slope = eq->p * f_u + eq->eta * v;
        double du = (eq->tau - eq->p * f - eq->eta * v) / slope;
        if (!(slope > 0)) {
            return NAN;
        }
        u += du;
        if (!falls(du, u)) {
            return u;
        }
    }
    return NAN;
}

static double regularised_rate(const balance *eq, double start)
{
    double u = start;
    for (int i = 0; i < MOST_ITERATIONS; i++) {
        double slope, rest = residual(eq, u, &slope);
        double du = rest / slope;
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
    double u = lac_friction_flashes(eq->friction) ? LAC_SLOWEST : 0; // cold
    double f = lac_friction_coefficient(eq->friction, eq->cell, u, eq->w);
    double rest = eq->tau - eq->p * f;
    return rest > 0 && eq->eta > 0 ? log(rest) - log(eq->eta) : NAN;
}

// Without a cut-off of the direct effect. `above` is U without damping.
static double convex_rate(const balance *eq, double from_state, double above)
{
    double a = lac_cellwise_of(&eq->friction->column[LAC_A], eq->cell);
    double u_plain = plain_rate((eq->tau / eq->p - from_state) / a, eq->eta, a * eq->p);
    if (eq->friction->form == LAC_FORM_PLAIN) {
        return u_plain;
    }
    if (!(eq->eta > 0)) {
        return above;
    }
    // Three upper bounds: f >= the plain form's; without damping; without friction.
    return regularised_rate(eq, fmin(fmin(u_plain, above), log(eq->tau) - log(eq->eta)));
}

// Newton's method within [low, high], bisection where it would leave them or is slow: beyond a
// cut-off the residual still rises, but is not convex.
static double bracketed_rate(const balance *eq, double low, double high)
{
    double u = high, width = high - low;
    for (int i = 0; i < MOST_ITERATIONS && low < high; i++) {
        double slope, rest = residual(eq, u, &slope);
        *(rest > 0 ? &high : &low) = u;
        double next = u - rest / slope;
        bool slow = i % 4 == 3 && high - low > 0.5 * width;
        width = i % 4 == 3 ? high - low : width;
        next = !slow && next > low && next < high ? next : low + 0.5 * (high - low);
        if (fabs(next - u) <= DBL_EPSILON * fmax(1, fabs(u))) {
            break;
        }
        u = next;
    }
    return u;
}

// With a cut-off of the direct effect. `above` is U without damping; beyond v1 only damping holds.
static double cut_rate(const balance *eq, double from_state, double above)
{
    double undamped = lac_cutoff_rate_of(eq->friction, eq->cell, above);
    if (!(eq->eta > 0)) {
        return undamped;
    }
    bool regularised = eq->friction->form == LAC_FORM_REGULARISED;
    double ln_eta = log(eq->eta), low, high;
    if (regularised) {
        // Below `low`, friction without the cut-off and damping take less than half each.
        double half = lac_form_plain_of(eq->friction, eq->cell, 0.5 * eq->tau / eq->p);
        double a = lac_cellwise_of(&eq->friction->column[LAC_A], eq->cell);
        low = fmin((half - from_state) / a, log(0.5 * eq->tau) - ln_eta);
        high = log(eq->tau) - ln_eta;
    } else {
        // Friction without the cut-off is more, so `low` is too slow; friction is no less than
        // there.
        low = convex_rate(eq, from_state, above);
        double f = lac_friction_coefficient(eq->friction, eq->cell, low, eq->w);
        high = fmax(low, log(eq->tau - eq->p * f) - ln_eta);
    }
    return bracketed_rate(eq, low, isnan(undamped) ? high : fmin(high, undamped));
}

// Whatever flash heating does.
static double cold_rate(const balance *eq)
{
    const lac_friction *friction = eq->friction;
    const size_t cell = eq->cell;
    const double w = eq->w, tau = eq->tau, pressure = eq->p, eta = eq->eta;
    double a = lac_cellwise_of(&friction->column[LAC_A], cell);
    bool regularised = friction->form == LAC_FORM_REGULARISED;
    if (!(pressure >= 0 && eta >= 0) || !isfinite(tau) || !isfinite(w) ||
        (regularised && tau <= 0)) {
        return NAN;
    }
    if (!(a * pressure > 0)) {
        return damped_rate(eq);
    }
    double from_state =
        lac_cellwise_of(&friction->constant, cell) +
        lac_cellwise_of(&friction->column[LAC_B], cell) * lac_cutoff_state(friction, cell, w);
    double above = (lac_form_plain_of(friction, cell, tau / pressure) - from_state) / a;
    if (friction->ln_v1.value != NULL) {
        return cut_rate(eq, from_state, above);
    }
    return convex_rate(eq, from_state, above);
}

double lac_friction_rate_for(const lac_friction *friction, size_t cell, double w, double tau,
                             double pressure, double eta)
{
    const balance eq = {friction, cell, w, tau, pressure, eta};
    double u = cold_rate(&eq);
    return lac_friction_flashes(friction) && isfinite(u) ? flashed_rate(&eq, u) : u;
}
