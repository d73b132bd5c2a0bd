// SPDX-License-Identifier: GPL-3.0-or-later
// The coordinates that walkers live in; docs/theory/fitting.md, "Where the walkers walk".
//
// A bounded coordinate goes over the whole line, u = low + width/(1 + exp(-z)): no move is lost
// beyond an end, and valleys that run along one are straighter.
//
// One block under the aging law moves by (O2 of docs/theory/creep.md, with v_i the rate at the
// start)
//     dv/dt = (S/q) v^2 [1 - (1 - q) (v/v_i)^(-(m-1)/m)],  S = (m/dc) q,  q = 1 - x^(m-1).
// Readings tell S, then q/k with k = (m-1)/m (the bracket is near q + k ln(v/v_i)), and m hardly;
// in dc, x and b their posterior is a thin bent sheet. So where dc and x are both sought and m > 1
// > x, ln S and ln(q/(1-q)) - ln k stand for them.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fit/internal.h"

// A parameter's index among the unknowns; -1: it is none.
static int index_of(const lac_fit *fit, const char *section, const char *name)
{
    char key[80];
    (void)snprintf(key, sizeof key, "%s.%s", section, name);
    for (size_t k = 0; k < fit->def->count; k++) {
        if (strcmp(fit->def->parameter[k].key, key) == 0) {
            return (int)k;
        }
    }
    return -1;
}

// An end of a number of the friction law: of its range, or what the case holds.
static double end_of(const lac_fit *fit, int k, bool high, double held)
{
    return k < 0 ? held : high ? fit->def->parameter[k].high : fit->def->parameter[k].low;
}

bool lac_fit_is_one_block(const lac_case *c)
{
    const lac_friction_law *law = (const void *)c->friction.info;
    const lac_friction_params *numbers = c->friction.params;
    return law->block_form && isnan(numbers->flash_rate) && c->weakening.count == 0 &&
           c->surface.info == NULL && c->domain.info == NULL && c->friction_spread.count == 0 &&
           c->initial.state == LAC_STATE_RATIO && !isnan(c->initial.slip_rate);
}

lac_fit_straight lac_fit_straighten(const lac_fit *fit)
{
    char law_key[60];
    (void)snprintf(law_key, sizeof law_key, "friction.%s", fit->source->friction.info->name);
    lac_fit_straight s = {.dc = index_of(fit, law_key, "dc"),
                          .x = index_of(fit, "initial.state", "ratio_to_steady"),
                          .a = index_of(fit, law_key, "a"),
                          .b = index_of(fit, law_key, "b")};
    if (!lac_fit_is_one_block(fit->source) || s.dc < 0 || s.x < 0) {
        return s;
    }
    const lac_friction_params *law = fit->source->friction.params;
    s.held_a = law->a;
    s.held_b = law->b;
    s.used = end_of(fit, s.b, false, law->b) > end_of(fit, s.a, true, law->a) &&
             fit->def->parameter[s.x].high <= 1.0;
    return s;
}

// m - 1 at coordinates u, of which a and b are read.
static double excess(const lac_fit *fit, const double *u)
{
    const lac_fit_straight *s = &fit->straight;
    const lac_fit_parameter *p = fit->def->parameter;
    double a = s->a < 0 ? s->held_a : lac_fit_value(p[s->a].log, u[s->a]);
    double b = s->b < 0 ? s->held_b : lac_fit_value(p[s->b].log, u[s->b]);
    return b / a - 1.0;
}

// dc and x from ln S and ln(q/(1-q)) - ln k. @return ln of the size of their Jacobian
static double bend(const lac_fit *fit, const double *z, double *u)
{
    const lac_fit_straight *s = &fit->straight;
    const lac_fit_parameter *p = fit->def->parameter;
    double more = excess(fit, u);
    double w = z[s->x] + log(more / (1.0 + more)); // ln(q/(1-q))
    double e = exp(-fabs(w));
    double log_q = fmin(w, 0.0) - log1p(e);
    double log_x = (fmin(-w, 0.0) - log1p(e)) / more; // (1 - q)^(1/(m-1))
    double log_dc = log1p(more) + log_q - z[s->dc];
    u[s->x] = p[s->x].log ? log_x : exp(log_x);
    u[s->dc] = p[s->dc].log ? log_dc : exp(log_dc);
    return log_q - log(more) + (p[s->x].log ? 0.0 : log_x) + (p[s->dc].log ? 0.0 : log_dc);
}

double lac_fit_from_line(const lac_fit *fit, const double *given, double *u)
{
    const lac_fit_straight *s = &fit->straight;
    double log_slope = 0.0, z[LAC_FIT_UNKNOWNS];
    memcpy(z, given, fit->unknowns * sizeof *z);
    lac_fit_shear_to(&fit->shear, -1.0, z);
    for (size_t k = 0; k < fit->unknowns; k++) {
        u[k] = z[k];
        if (lac_fit_bounded(fit, k) && !(s->used && ((int)k == s->dc || (int)k == s->x))) {
            double width = fit->high[k] - fit->low[k];
            double e = exp(-fabs(z[k]));
            double share = (z[k] > 0.0 ? 1.0 : e) / (1.0 + e);
            u[k] = fit->low[k] + share * width;
            log_slope += log(width) - fabs(z[k]) - 2.0 * log1p(e);
        }
    }
    return s->used ? log_slope + bend(fit, z, u) : log_slope;
}

void lac_fit_to_line(const lac_fit *fit, const double *u, double *z)
{
    lac_fit_to_line_unbent(fit, u, z);
    lac_fit_shear_to(&fit->shear, 1.0, z);
}

void lac_fit_to_line_unbent(const lac_fit *fit, const double *u, double *z)
{
    const lac_fit_straight *s = &fit->straight;
    const lac_fit_parameter *p = fit->def->parameter;
    for (size_t k = 0; k < fit->unknowns; k++) {
        z[k] = lac_fit_bounded(fit, k) ? log((u[k] - fit->low[k]) / (fit->high[k] - u[k])) : u[k];
    }
    if (s->used) {
        double more = excess(fit, u);
        double log_x = p[s->x].log ? u[s->x] : log(u[s->x]);
        double log_dc = p[s->dc].log ? u[s->dc] : log(u[s->dc]);
        double q = -expm1(more * log_x);
        z[s->x] = log(q) - more * log_x - log(more / (1.0 + more));
        z[s->dc] = log1p(more) + log(q) - log_dc;
    }
}
