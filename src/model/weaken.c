// SPDX-License-Identifier: GPL-3.0-or-later
// Unknowns of the cells besides slip and state: what a case's weakening leaves of pressures and
// cohesion, its rates, and Newton's system with those unknowns eliminated cell by cell, exactly;
// docs/theory/weakening.md.
#include "model/weaken.h"
#include "model/internal.h"

enum { MOST = LAC_MOST_WEAKENINGS };

size_t lac_weaken_work(const lac_problem *problem)
{
    return problem->weak == NULL ? 0 : (3 * problem->weak->count + 4) * problem->n;
}

lac_weak_arrays lac_weaken_split(const lac_problem *problem, double *work)
{
    const size_t n = problem->n, all = problem->weak->count * n;
    return (lac_weak_arrays){.z = work,
                             .rest = work + all,
                             .slope = work + 2 * all,
                             .shares = work + 3 * all,
                             .rates = work + 3 * all + n,
                             .before = work + 3 * all + 2 * n,
                             .bond = work + 3 * all + 3 * n};
}

// z of every mechanism and cell.
static void add_up(const lac_problem *problem, const double *y, double *z)
{
    const size_t n = problem->n;
    const double *x = y + lac_weaken_place(problem);
    for (size_t k = 0; k < problem->weak->count; k++, z += n) {
        memset(z, 0, n * sizeof *z);
        for (size_t j = 0; j < problem->weak->item[k].modes.n; j++, x += n) {
            for (size_t i = 0; i < n; i++) {
                z[i] += x[i];
            }
        }
    }
}

// Pore pressure of a cell in excess of that of the loads [Pa].
static double excess_of(const lac_problem *problem, const double *z, size_t i)
{
    double excess = 0.0;
    for (size_t k = 0; k < problem->weak->count; k++) {
        excess += problem->weak->item[k].kind->pore ? z[k * problem->n + i] : 0.0;
    }
    return excess;
}

// Shares of pressures from which an excess is taken.
typedef struct excess_field {
    const lac_problem *problem;
    const double *z;
    const lac_problem_loads_at *drive;
    double *shares, *rates; // [n]; rates NULL: they are not asked for
} excess_field;

static void add_excess(const void *context, size_t first, size_t end, double *sums)
{
    const excess_field *f = context;
    const lac_problem *problem = f->problem;
    const lac_problem_loads_at *drive = f->drive;
    for (size_t i = first; i < end; i++) {
        double part = excess_of(problem, f->z, i) / problem->mean_pressure;
        double rate = drive->shares != NULL ? drive->share_rates[i] : drive->share_rate;
        f->shares[i] = lac_problem_share_of(drive, i) - part;
        sums[0] += lac_problem_weight(problem, i) * problem->pressure[i] * part;
        if (f->rates != NULL) {
            f->rates[i] = rate;
        }
    }
}

// Takes the excess off the shares of the pressures that the loads leave.
// @param shares, rates  [n] overwritten; rates NULL: they are not asked for
static bool take_excess(const lac_problem *problem, const double *z, lac_problem_loads_at *drive,
                        double *shares, double *rates)
{
    const excess_field field = {problem, z, drive, shares, rates};
    double off, least = INFINITY;
    lac_range_sums(&problem->range, 1, add_excess, &field, &off);
    for (size_t i = 0; i < problem->n; i++) {
        least = fmin(least, shares[i]);
    }
    drive->least = lac_team_least(problem->range.team, least);
    drive->share -= off / problem->sum_pressure;
    drive->shares = shares;
    drive->share_rates = rates;
    return drive->least > 0.0 && isfinite(drive->share);
}

bool lac_weaken_look_at(lac_look *at)
{
    const lac_problem *problem = at->problem;
    const lac_weak_arrays a = lac_weaken_split(problem, at->ws.weak);
    add_up(problem, at->y, a.z);
    for (size_t k = 0; k < problem->weak->count; k++) {
        if (!problem->weak->item[k].kind->pore) {
            at->broken = a.z + k * problem->n;
        }
    }
    return !problem->weak->pore || take_excess(problem, a.z, &at->drive, a.shares, a.rates);
}

void lac_weaken_jump(const lac_problem *problem, const double *y, const lac_workspace *ws,
                     lac_problem_loads_at *before, lac_problem_loads_at *after)
{
    if (problem->weak == NULL || !problem->weak->pore) {
        return;
    }
    const lac_weak_arrays a = lac_weaken_split(problem, ws->weak);
    add_up(problem, y, a.z);
    (void)take_excess(problem, a.z, before, a.before, NULL);
    (void)take_excess(problem, a.z, after, a.shares, NULL);
}

// Sources of a block of cells, and with slopes their derivatives.
typedef struct sources {
    double normal[LAC_FRICTION_BLOCK], cohesion[LAC_FRICTION_BLOCK];
    double s[MOST][LAC_FRICTION_BLOCK], s_u[MOST][LAC_FRICTION_BLOCK];
    double s_w[MOST][LAC_FRICTION_BLOCK], s_normal[MOST][LAC_FRICTION_BLOCK];
    double s_cohesion[MOST][LAC_FRICTION_BLOCK];
} sources;

static void find_sources(const lac_look *at, size_t first, size_t length, const lac_block *s,
                         const lac_block_slopes *d, sources *out)
{
    const lac_problem *problem = at->problem;
    for (size_t i = 0; i < length; i++) {
        double broken = at->broken != NULL ? fmin(at->broken[first + i], 1.0) : 0.0;
        out->normal[i] = problem->mean_pressure * lac_problem_share_of(&at->drive, first + i);
        out->cohesion[i] = problem->friction->cohesion * (1.0 - broken);
    }
    const lac_weakening_cells cells = {.n = length,
                                       .v = s->speed,
                                       .f = s->f,
                                       .f_u = s->f_u,
                                       .f_w = s->f_w,
                                       .g = s->g,
                                       .g_u = d != NULL ? d->g_u : NULL,
                                       .g_w = d != NULL ? d->g_w : NULL,
                                       .normal = out->normal,
                                       .cohesion = out->cohesion};
    for (size_t k = 0; k < problem->weak->count; k++) {
        lac_weakening_sources to = {.s = out->s[k]};
        if (d != NULL) {
            to = (lac_weakening_sources){out->s[k], out->s_u[k], out->s_w[k], out->s_normal[k],
                                         out->s_cohesion[k]};
        }
        const lac_weakening *item = &problem->weak->item[k];
        item->kind->source(item->params, &cells, &to);
    }
}

// dx/dt of one mechanism over a block of cells. @param zdot  [length] overwritten
static void mode_rates(const lac_look *at, const lac_weakening *item, size_t first, size_t length,
                       const double *source, double *xdot, double *zdot)
{
    const size_t n = at->problem->n;
    memset(zdot, 0, length * sizeof *zdot);
    for (size_t j = 0; j < item->modes.n; j++) {
        const size_t row = (item->first + j) * n + first;
        const double *x = at->y + lac_weaken_place(at->problem) + row;
        for (size_t i = 0; i < length; i++) {
            double rate = item->modes.gain[j] * source[i] - item->modes.decay[j] * x[i];
            zdot[i] += rate;
            if (xdot != NULL) {
                xdot[row + i] = rate;
            }
        }
    }
}

static bool block_rates(const lac_look *at, const lac_weak_arrays *a, size_t first, double *xdot)
{
    lac_block s;
    sources from;
    double zdot[LAC_FRICTION_BLOCK];
    const lac_problem *problem = at->problem;
    const size_t length = lac_block_friction(at, first, &s, NULL);
    double check = 0.0;
    find_sources(at, first, length, &s, NULL, &from);
    for (size_t k = 0; k < problem->weak->count; k++) {
        const lac_weakening *item = &problem->weak->item[k];
        mode_rates(at, item, first, length, from.s[k], xdot, zdot);
        for (size_t i = 0; i < length; i++) {
            check += 0.0 * zdot[i];
            if (item->kind->pore) {
                a->rates[first + i] -= zdot[i] / problem->mean_pressure;
            } else {
                bool whole = at->broken[first + i] < 1.0;
                a->bond[first + i] =
                    whole ? problem->pressure[first + i] * problem->bond * zdot[i] : 0.0;
            }
        }
    }
    return check == 0.0;
}

bool lac_weaken_rates_of(const lac_look *at, double *xdot)
{
    bool good = true;
    const lac_weak_arrays a = lac_weaken_split(at->problem, at->ws.weak);
    for (size_t first = 0; first < at->problem->n; first += LAC_FRICTION_BLOCK) {
        good = block_rates(at, &a, first, xdot) && good;
    }
    return lac_problem_agree(at->problem, good);
}

void lac_weaken_take_off(const lac_look *at, double *kv)
{
    if (at->broken == NULL) {
        return;
    }
    const double *bond = lac_weaken_split(at->problem, at->ws.weak).bond;
    for (size_t i = 0; i < at->problem->n; i++) {
        kv[i] -= bond[i];
    }
}

// A cell's z_k = rest_k + slope_k x_u while x_u = d ln|v| is not known.
typedef struct response {
    double rest[MOST], slope[MOST];
    double given[MOST]; // sum of the right-hand sides of the unknowns of each
} response;

// Solves a x = rest and a x = slope in place, a of `count` rows; false where it is singular.
static bool solve_small(size_t count, double a[MOST][MOST], response *r)
{
    for (size_t p = 0; p < count; p++) {
        if (!(fabs(a[p][p]) > 0.0)) {
            return false;
        }
        for (size_t k = 0; k < count; k++) {
            double by = k == p ? 0.0 : a[k][p] / a[p][p];
            for (size_t m = p; m < count; m++) {
                a[k][m] -= by * a[p][m];
            }
            r->rest[k] -= by * r->rest[p];
            r->slope[k] -= by * r->slope[p];
        }
    }
    for (size_t k = 0; k < count; k++) {
        r->rest[k] /= a[k][k];
        r->slope[k] /= a[k][k];
    }
    return true;
}

// What one step asks of the unknowns of a cell.
typedef struct elimination {
    const lac_look *at;
    const double *b; // right-hand sides of all unknowns
    double gamma;
    double gain[MOST]; // sum of gamma gain/(1 + gamma decay)
} elimination;

static elimination begin(const lac_look *at, double gamma, const double *b)
{
    elimination e = {.at = at, .b = b, .gamma = gamma};
    for (size_t k = 0; k < at->problem->weak->count; k++) {
        const lac_weakening_modes *modes = &at->problem->weak->item[k].modes;
        for (size_t j = 0; j < modes->n; j++) {
            e.gain[k] += gamma * modes->gain[j] / (1.0 + gamma * modes->decay[j]);
        }
    }
    return e;
}

// dS_k/dz_m
static double coupling(const elimination *e, const sources *from, size_t k, size_t m, size_t first,
                       size_t i)
{
    const lac_problem *problem = e->at->problem;
    if (problem->weak->item[m].kind->pore) {
        return -from->s_normal[k][i];
    }
    bool whole = e->at->broken[first + i] < 1.0;
    return whole ? -from->s_cohesion[k][i] * problem->friction->cohesion : 0.0;
}

// x_j = (b_j + gamma gain_j x_S)/(1 + gamma decay_j),  x_S = s_u x_u + s_w x_w + sum of s_z z_m,
// x_w = w + evolve x_u; x_S goes to the arrays, per x_u/per.
static bool respond(const elimination *e, const sources *from, size_t first, size_t i,
                    const double ln_theta[2], double per, response *r)
{
    const lac_problem *problem = e->at->problem;
    const size_t n = problem->n, count = problem->weak->count;
    const lac_weak_arrays out = lac_weaken_split(problem, e->at->ws.weak);
    const double *b = e->b + lac_weaken_place(problem) + first + i;
    double a[MOST][MOST];
    for (size_t k = 0; k < count; k++) {
        const lac_weakening *item = &problem->weak->item[k];
        r->rest[k] = e->gain[k] * from->s_w[k][i] * ln_theta[0];
        r->slope[k] = e->gain[k] * (from->s_u[k][i] + from->s_w[k][i] * ln_theta[1]);
        r->given[k] = 0.0;
        for (size_t j = 0; j < item->modes.n; j++) {
            double given = b[(item->first + j) * n];
            r->given[k] += given;
            r->rest[k] += given / (1.0 + e->gamma * item->modes.decay[j]);
        }
        for (size_t m = 0; m < count; m++) {
            a[k][m] = (k == m ? 1.0 : 0.0) - e->gain[k] * coupling(e, from, k, m, first, i);
        }
    }
    bool good = solve_small(count, a, r);
    for (size_t k = 0; k < count; k++) {
        double rest = from->s_w[k][i] * ln_theta[0];
        double slope = from->s_u[k][i] + from->s_w[k][i] * ln_theta[1];
        for (size_t m = 0; m < count; m++) {
            double by = coupling(e, from, k, m, first, i);
            rest += by * r->rest[m];
            slope += by * r->slope[m];
        }
        out.rest[k * n + first + i] = rest;
        out.slope[k * n + first + i] = slope * per;
    }
    return good;
}

// What strength loses with z_k over the nominal area [Pa per unit of z].
static double loss(const elimination *e, size_t k, size_t cell, double f)
{
    const lac_problem *problem = e->at->problem;
    if (problem->weak->item[k].kind->pore) {
        return f;
    }
    return e->at->broken[cell] < 1.0 ? problem->friction->cohesion : 0.0;
}

// The rate of x_u over what it is held by, p f_u + eta v, where ln v is the unknown.
static double rate_of(const lac_look *at, const lac_weak_block *block, double loading, size_t first,
                      size_t i)
{
    const lac_block *s = block->s;
    const lac_problem *problem = at->problem;
    const size_t c = first + i;
    double pressure = problem->pressure[c];
    double p = lac_problem_effective(problem, &at->drive, c);
    double share_rate = at->drive.shares != NULL ? at->drive.share_rates[c] : at->drive.share_rate;
    double held = p * s->f_u[i] + problem->damping * s->speed[i];
    double force = pressure * at->drive.ratio_rate + loading - at->ws.kv[c];
    return (force - s->f[i] * pressure * share_rate - p * s->f_w[i] * s->g[i]) / held;
}

bool lac_weaken_reduce(const lac_look *at, double gamma, const double *loading, const double *b,
                       size_t first, const lac_weak_block *block)
{
    const lac_problem *problem = at->problem;
    const lac_block *s = block->s;
    const lac_block_slopes *d = block->d;
    const size_t length = lac_block_length(problem->n, first);
    const elimination e = begin(at, gamma, b);
    sources from;
    bool good = true;
    find_sources(at, first, length, s, d, &from);
    for (size_t i = 0; i < length; i++) {
        const size_t c = first + i;
        double back = 1.0 / (1.0 - gamma * d->g_w[i]);
        double v = at->motion.v[c];
        double du = loading != NULL ? rate_of(at, block, *loading, first, i) : 0.0;
        double part = problem->pressure[c] / problem->mean_pressure;
        response r;
        good = respond(&e, &from, first, i,
                       (double[]){back * b[problem->n + c], back * gamma * d->g_u[i]},
                       loading != NULL ? 1.0 : 1.0 / v, &r) &&
               good;
        block->diagonal[i] = block->rhs[i] = 0.0;
        for (size_t k = 0; k < problem->weak->count; k++) {
            if (loading == NULL) {
                double h = loss(&e, k, c, copysign(s->f[i], v));
                block->diagonal[i] -= part * h * r.slope[k] / (gamma * v);
                block->rhs[i] -= part * h * r.rest[k];
                continue;
            }
            double h = loss(&e, k, c, s->f[i]) / gamma;
            bool pore = problem->weak->item[k].kind->pore;
            double worth = h + (pore ? s->f_w[i] * s->g[i] + du * s->f_u[i] : 0.0);
            block->diagonal[i] -= part * worth * r.slope[k];
            block->rhs[i] += part * (worth * r.rest[k] - h * r.given[k]);
        }
    }
    return good;
}

void lac_weaken_finish(const lac_look *at, double gamma, double *b)
{
    const lac_problem *problem = at->problem;
    const size_t n = problem->n;
    if (problem->weak == NULL) {
        return;
    }
    const lac_weak_arrays a = lac_weaken_split(problem, at->ws.weak);
    double *x = b + lac_weaken_place(problem);
    for (size_t k = 0; k < problem->weak->count; k++) {
        const lac_weakening_modes *modes = &problem->weak->item[k].modes;
        for (size_t j = 0; j < modes->n; j++, x += n) {
            double gain = gamma * modes->gain[j], part = 1.0 / (1.0 + gamma * modes->decay[j]);
            for (size_t i = 0; i < n; i++) {
                x[i] = part * (x[i] + gain * (a.rest[k * n + i] + a.slope[k * n + i] * b[i]));
            }
        }
    }
}
