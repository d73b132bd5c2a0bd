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

static void to_line_unbent(const lac_fit *fit, const double *u, double *z)
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

void lac_fit_to_line(const lac_fit *fit, const double *u, double *z)
{
    to_line_unbent(fit, u, z);
    lac_fit_shear_to(&fit->shear, 1.0, z);
}

// A map of the walkers' coordinates that takes the bend out of a valley, from a chain that has not
// converged: z_k - c_k q2(t) - d_k q3(t), t the one coordinate along which the others bend most, q2
// and q3 orthogonal polynomials. It moves no volume, so a density stays what it is. The sampler's
// own moves turn and stretch with the walkers, but know no bend; docs/theory/fitting.md.

enum { MOST = 4096 }; // places that a shear is made of, at the end of a chain

static const double least_gain = 0.7; // of ln of the volume that the places take

// q2 and q3 at t, in `q`.
static void polynomials_of(const lac_fit_shear *s, double z, double q[2])
{
    const double t = (z - s->mean) / s->width;
    q[0] = t * t - s->third * t - 1.0;
    q[1] = t * t * t - s->third - s->fourth * t - s->share * q[0];
}

void lac_fit_shear_to(const lac_fit_shear *s, double sign, double *z)
{
    double q[2];
    if (s->used) {
        polynomials_of(s, z[s->pivot], q);
        for (size_t k = 0; k < s->dimension; k++) {
            z[k] -= sign * (s->by[k][0] * q[0] + s->by[k][1] * q[1]);
        }
    }
}

// ln of the square of the volume of places.
static double volume(size_t n, size_t d, const double *z)
{
    double mean[LAC_FIT_UNKNOWNS] = {0}, c[LAC_FIT_UNKNOWNS * LAC_FIT_UNKNOWNS] = {0}, sum = 0.0;
    for (size_t i = 0; i < n * d; i++) {
        mean[i % d] += z[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < d * d; k++) {
            const size_t a = k / d, b = k % d;
            c[k] += (z[i * d + a] - mean[a]) * (z[i * d + b] - mean[b]) / (double)n;
        }
    }
    if (!lac_fit_factor(d, d, c)) {
        return -INFINITY;
    }
    for (size_t k = 0; k < d; k++) {
        sum += 2.0 * log(c[k * d + k]);
    }
    return sum;
}

// The shear along one coordinate, by least squares.
static lac_fit_shear shear_along(size_t n, size_t d, const double *z, size_t pivot)
{
    lac_fit_shear s = {.used = true, .pivot = pivot, .dimension = d};
    double moment[6] = {0}, square[2] = {0}, q[2];
    for (size_t i = 0; i < n; i++) {
        s.mean += z[i * d + pivot] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        s.width += pow(z[i * d + pivot] - s.mean, 2.0) / (double)n;
    }
    s.width = sqrt(s.width);
    for (size_t i = 0; i < n; i++) {
        const double t = (z[i * d + pivot] - s.mean) / s.width;
        for (int k = 3; k < 6; k++) {
            moment[k] += pow(t, k) / (double)n;
        }
    }
    s.third = moment[3];
    s.fourth = moment[4];
    s.share =
        (moment[5] - moment[3] * moment[4] - moment[3]) / (moment[4] - moment[3] * moment[3] - 1.0);
    for (size_t i = 0; i < n; i++) {
        polynomials_of(&s, z[i * d + pivot], q);
        for (int j = 0; j < 2; j++) {
            square[j] += q[j] * q[j];
            for (size_t k = 0; k < d; k++) {
                s.by[k][j] += k != pivot ? q[j] * z[i * d + k] : 0.0;
            }
        }
    }
    for (size_t k = 0; k < d; k++) {
        s.by[k][0] /= square[0];
        s.by[k][1] /= square[1];
    }
    return s;
}

// Places of the end of a chain, which holds coordinates, on the line. @return how many
static size_t take_places(const lac_fit *fit, double *z)
{
    const lac_chain *chain = fit->chain;
    const size_t d = chain->dimension, all = chain->walkers * chain->steps;
    const size_t last = all / 2 < MOST ? all / 2 : MOST;
    size_t n = 0;
    for (size_t i = all - last; i < all; i++) {
        bool whole = true;
        to_line_unbent(fit, chain->x + i * d, z + n * d);
        for (size_t k = 0; k < d; k++) {
            whole = whole && isfinite(z[n * d + k]);
        }
        n += whole ? 1 : 0;
    }
    return n;
}

lac_status lac_fit_find_shear(lac_fit *fit, lac_error *err)
{
    const size_t d = fit->unknowns;
    double *z = calloc(2 * MOST * d, sizeof *z), best = -least_gain;
    LAC_FAIL_MEMORY_IF(z == NULL, err);
    double *bent = z + MOST * d;
    const size_t n = take_places(fit, z);
    const double before = volume(n, d, z);
    fit->shear.used = false;
    for (size_t pivot = 0; pivot < d && isfinite(before); pivot++) {
        const lac_fit_shear s = shear_along(n, d, z, pivot);
        memcpy(bent, z, n * d * sizeof *z);
        for (size_t i = 0; i < n; i++) {
            lac_fit_shear_to(&s, 1.0, bent + i * d);
        }
        const double gain = 0.5 * (volume(n, d, bent) - before);
        if (isfinite(gain) && gain < best) {
            best = gain;
            fit->shear = s;
        }
    }
    free(z);
    return LAC_OK;
}
