// SPDX-License-Identifier: GPL-3.0-or-later
// Smooth cut-offs: friction feels no slip rate far above v1 and no state far below dc/v2.
#include "friction/cutoff.h"

#include <math.h>
#include <string.h>

#include "base/vmath.h"

// Both cut-offs are one function. With S(d) = ln(1 + e^d),
//   W = w + S(ln_cut - w) = ln(theta + dc/v2),   U = u - S(u - ln_v1) = -ln(1/v + 1/v1),
// so y = x + s S(s (limit - x)) with s = 1 for the state and s = -1 for the rate. With
// d = s (limit - x), y' = 1/(1 + e^d) and y'' = s e^d/(1 + e^d)^2. Only exp(-|d|) is formed, which
// neither overflows nor, where a cell has no cut-off (d = -infinity), is anything but 0.

static void identity(size_t n, const double *x, lac_softened *out)
{
    memcpy(out->value, x, n * sizeof *x);
    for (size_t i = 0; i < n; i++) {
        out->slope[i] = 1;
        out->bend[i] = 0;
    }
}

static void soften(size_t n, const double *x, const double *limit, double s, lac_softened *out)
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

void lac_cutoff_map(const lac_friction *friction, size_t first, size_t n, const double *u,
                    const double *w, lac_cutoff *cutoff)
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

void lac_cutoff_chain(const lac_cutoff *cutoff, size_t n, const lac_friction_values *values,
                      const lac_friction_slopes *slopes)
{
    const lac_softened *rate = &cutoff->rate, *state = &cutoff->state;
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
    lac_softened rate;
    soften(1, &u, lac_cellwise_from(&friction->ln_v1, cell), -1, &rate);
    return rate.value[0];
}

double lac_cutoff_state(const lac_friction *friction, size_t cell, double w)
{
    if (friction->ln_cut.value == NULL) {
        return w;
    }
    lac_softened state;
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
