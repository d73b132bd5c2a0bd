// SPDX-License-Identifier: GPL-3.0-or-later
// A cell over one step: ln v is taken as linear in slip, v = v0/(1 - c t), which self-acceleration
// and healing both follow. Slip and state are then closed forms of h and rho = ln(v1/v0), and the
// balance at the end of the step is one equation for rho; docs/theory/fidelity-events.md, eqs. 3-6.
#include "async/tree.h"

#include "base/phi.h"

enum { MOST_NEWTON = 30, MOST_STEPS = 100000 };

#define LONGEST 3.0  // step of Newton's method, in ln v
#define SETTLED 1e-9 // and one after which it stops
#define LARGEST 300.0
#define STRAIGHT 0.2 // part of what an error of slip may cost that a line off the curve may

typedef struct strength {
    double f, f_u, f_w;
} strength;

// Both forms: with F = constant + a u + b w, f = F or a asinh(exp(F/a)/2).
static strength strength_at(const lac_async_rules *rules, const lac_async_cell *c, double u,
                            double w)
{
    const double same = 20.0; // where the two forms agree to the last bit
    double plain = c->constant + c->a * u + c->b * w;
    if (!rules->regularised || plain > same * c->a) {
        return (strength){plain, c->a, c->b};
    }
    double x = 0.5 * exp(plain / c->a);
    double slope = x / sqrt(1.0 + x * x);
    return (strength){c->a * asinh(x), c->a * slope, c->b * slope};
}

// dw/dt
static double evolution(const lac_async_rules *rules, const lac_async_cell *c)
{
    return rules->law->change(c->u, c->w, c->ln_dc, c->v / c->dc);
}

// The start of a step and its length, and as far as its end has been sought.
typedef struct start {
    lac_lone_step lone;
    double v, slip;
} start;

// The end of a step at rho = ln(v1/v0), and derivatives by rho.
typedef struct finish {
    double v, slip, dslip; // slip of the step alone [m]
    double w, dw;
    double slope; // of the balance by rho [Pa]
} finish;

static finish finish_at(const lac_async_rules *rules, const lac_async_cell *c, start *s, double rho)
{
    double em = expm1(-rho);
    double phi = lac_phi(rho, em);
    double g = -lac_phi_slope(rho, em, phi) / phi;
    finish end = {.v = s->v / (1.0 + em),
                  .slip = (1.0 + s->lone.uneven) * s->lone.length * s->v / phi};
    end.dslip = end.slip * g;
    s->lone.rho = rho;
    s->lone.em = em;
    s->lone.phi = phi;
    s->lone.z = end.slip / c->dc;
    s->lone.dz = s->lone.z * g;
    rules->law->step(&s->lone, &end.w, &end.dw);
    return end;
}

// Solves the balance p f + eta v = A - K slip at the end of the step for rho. False where it is not
// found, as in a step across an instability.
static bool balance(const lac_async_rules *rules, const lac_async_cell *c, start *s,
                    const lac_async_span *at, double *rho, finish *end)
{
    for (int k = 0; k < MOST_NEWTON; k++) {
        *end = finish_at(rules, c, s, *rho);
        strength f = strength_at(rules, c, s->lone.u + *rho, end->w);
        double off =
            at->pressure1 * f.f + c->damping * end->v - at->pull1 + at->own * (s->slip + end->slip);
        double slope =
            at->pressure1 * (f.f_u + f.f_w * end->dw) + c->damping * end->v + at->own * end->dslip;
        end->slope = slope;
        if (!(slope > 0.0) || !isfinite(off)) {
            return false;
        }
        double by = fmin(fmax(off / slope, -LONGEST), LONGEST);
        *rho = fmin(fmax(*rho - by, -LARGEST), LARGEST);
        if (fabs(by) < SETTLED) {
            // What the last correction still moves.
            end->slip -= end->dslip * by;
            end->w -= end->dw * by;
            end->v *= 1.0 - by;
            return true;
        }
    }
    return false;
}

// ln(v1/v0) of v = v0/(1 - rise t), continued beyond its pole by an exponential.
static double foreseen(double rise, double h)
{
    const double most = 0.9;
    double x = rise * h;
    return x < most ? -log1p(-x) : -log1p(-most) + (x - most);
}

// du/dt
static double rise_of(const lac_async_rules *rules, const lac_async_cell *c,
                      const lac_async_push *push, double *outside)
{
    strength f = strength_at(rules, c, c->u, c->w);
    double weight = push->pressure * f.f_u + c->damping * c->v;
    double drive = push->pull_rate - f.f * push->pressure_rate;
    *outside = drive / weight;
    return (drive - push->own * c->v - push->pressure * f.f_w * evolution(rules, c)) / weight;
}

// What an error of slip over dc is worth in ln v, in a step of slip z dc: the state forgets.
static double gain(const lac_async_cell *c, double own, double pressure, double z)
{
    double direct = c->a * pressure + c->damping * c->v;
    return (c->b * pressure / fmax(1.0, z) + own * c->dc) / direct;
}

// d ln v/d slip at the end of a step [1/m]
static double slope_after(const lac_async_rules *rules, const lac_async_cell *c,
                          const lac_async_push *push, const lac_async_span *at, const finish *end,
                          double rho)
{
    lac_async_cell after = *c;
    lac_async_push then = *push;
    double outside;
    after.u += rho;
    after.w = end->w;
    after.v = end->v;
    then.pressure = at->pressure1;
    return rise_of(rules, &after, &then, &outside) / end->v;
}

// One step from the cell's state over `at`; gives back its error over the tolerance.
static double attempt(const lac_async_rules *rules, const lac_async_cell *c,
                      const lac_async_span *at, finish *end, double *rho)
{
    const lac_async_push push = {.pull_rate = (at->pull1 - at->pull0) / at->length,
                                 .pressure = at->pressure0,
                                 .pressure_rate = (at->pressure1 - at->pressure0) / at->length,
                                 .own = at->own};
    double direct = c->a * at->pressure1 + c->damping * c->v;
    start s = {.lone = {.length = at->length,
                        .u = c->u,
                        .w = c->w,
                        .ln_dc = c->ln_dc,
                        .uneven = fmin(fmax(at->skew / direct, -0.5), 1.0)},
               .v = c->v,
               .slip = c->slip};
    double outside;
    double rise = rise_of(rules, c, &push, &outside);
    *rho = foreseen(rise, at->length);
    double expected = (1.0 + s.lone.uneven) * s.lone.length * s.v / lac_phi(*rho, expm1(-*rho));
    if (!balance(rules, c, &s, at, rho, end)) {
        return INFINITY;
    }
    // ln v bends: with its slopes in slip at both ends, its mean over slip is off that of the line
    // between them by a twelfth of how much they differ.
    const double bend =
        0.5 * (slope_after(rules, c, &push, at, end, *rho) - rise / s.v) * end->slip;
    s.lone.bend = (1.0 + s.lone.uneven) * fmin(fmax(bend, -1.0), 1.0);
    s.lone.uneven -= s.lone.bend / 6.0;
    double first = end->slip;
    if (!balance(rules, c, &s, at, rho, end)) {
        return INFINITY;
    }
    double z = end->slip / c->dc;
    // The balance answers by its slope, which weakening over many dc takes down.
    double off = fabs(first - expected) / c->dc * direct / end->slope;
    return off * gain(c, at->own, at->pressure1, z) / rules->tolerance;
}

static lac_async_span part_of(const lac_async_span *span, double from, double h)
{
    double x = from / span->length;
    double y = fmin((from + h) / span->length, 1.0);
    double pull = span->pull1 - span->pull0;
    double pressure = span->pressure1 - span->pressure0;
    return (lac_async_span){.length = h,
                            .pull0 = span->pull0 + x * pull,
                            .pull1 = span->pull0 + y * pull,
                            .pressure0 = span->pressure0 + x * pressure,
                            .pressure1 = span->pressure0 + y * pressure,
                            .own = span->own,
                            .skew = span->skew};
}

// The slip of the next step from the error of one of third order.
static void adapt(lac_async_cell *c, double z, double error)
{
    const double most = 3.0, least = 0.2;
    double factor = 0.9 * cbrt(1.0 / fmax(error, 1e-6));
    factor = fmin(fmax(factor, least), most);
    // A step cut short says nothing of longer ones.
    if (z > 0.5 * c->z || factor < 1.0) {
        c->z = fmin(z * factor, most * c->z);
    }
}

bool lac_async_cell_advance(const lac_async_rules *rules, const lac_async_span *span,
                            lac_async_cell *cell, int64_t *steps)
{
    double done = 0.0, h = span->length;
    for (int k = 0; k < MOST_STEPS && done < span->length; k++) {
        bool last = done + h >= span->length * (1.0 - 1e-12);
        h = last ? span->length - done : h;
        finish end;
        double rho;
        const lac_async_span part = part_of(span, done, h);
        double error = attempt(rules, cell, &part, &end, &rho);
        ++*steps;
        if (!(error <= 1.0)) {
            h *= error < 64.0 ? 0.5 : 0.1;
            continue;
        }
        cell->u += rho;
        cell->w = end.w;
        cell->v = end.v;
        cell->slip += end.slip;
        adapt(cell, end.slip / cell->dc, error);
        if (last) {
            return true;
        }
        done += h;
        h *= fmin(0.9 * cbrt(1.0 / fmax(error, 1e-3)), 3.0);
    }
    return span->length == 0.0;
}

// How long a step of slip z dc takes: v = v0/(1 - rise t), ln(v1/v0) within bounds.
static double time_for(double rise, double v, double slip)
{
    const double up = 0.7, down = 3.0;
    double rho = fmin(fmax(rise / v * slip, -down), up);
    return fabs(rho) < 1e-9 ? slip / v : -expm1(-rho) / rise;
}

// How long slip takes where v grows as e^(rise t).
static double time_under(double rise, double v, double slip)
{
    return rise > 0.0 ? log1p(rise / v * slip) / rise : slip / v;
}

// Slip in h where v grows as e^(rise t).
static double slip_under(double rise, double v, double h)
{
    return rise > 0.0 ? v * expm1(fmin(rise * h, LARGEST)) / rise : v * h;
}

// Friction above where a cell counts as let go; as lac_problem_slips.
static double held(const lac_async_rules *rules, const lac_async_cell *c)
{
    const double folds = 20.0;
    return c->constant + c->a * c->u + c->b * c->w + (rules->regularised ? folds * c->a : 0.0);
}

bool lac_async_cell_let_go(const lac_async_rules *rules, const lac_async_cell *c)
{
    return held(rules, c) <= 0.0;
}

// Just beyond the time at which what unloads the cell has let it go.
static double time_to_let_go(const lac_async_rules *rules, const lac_async_cell *c,
                             const lac_async_push *push)
{
    const double beyond = 1.001;
    return push->pull_rate < 0.0 ? beyond * push->pressure * held(rules, c) / -push->pull_rate
                                 : INFINITY;
}

// Mean over a step of the slip of v = v0/(1 - c t), less that of a line between its ends; over its
// slip.
static double chord_gap(double rho)
{
    return fabs(rho) < 1e-3 ? -rho / 12.0 : (1.0 - 0.5 * rho / tanh(0.5 * rho)) / rho;
}

// What the others are told of a step of length h that ln v rises in: a line, which may lie off the
// curve by `most` in the mean [m]. Gives back h, or less of it where the curve bends too much.
static double tell(lac_async_cell *c, double rise, double h, double most)
{
    c->told = c->v;
    c->ahead = 0.0;
    for (int k = 0; isfinite(h) && k < 3; k++) {
        double rho = foreseen(rise, h);
        c->told = c->v / lac_phi(rho, expm1(-rho));
        c->ahead = c->told * h * chord_gap(rho);
        double off = fabs(c->ahead) / most;
        if (off <= 1.0 || k == 2) {
            break;
        }
        h *= fmax(sqrt(1.0 / off), 0.1);
    }
    return h;
}

double lac_async_cell_plan(const lac_async_rules *rules, const lac_async_push *push,
                           lac_async_cell *c)
{
    double outside;
    double rise = rise_of(rules, c, push, &outside);
    double worth = gain(c, push->own, push->pressure, c->z);
    double small = rules->tolerance / worth;
    double h = time_for(rise, c->v, c->z * c->dc);
    // A locked cell that is loaded: its slip is nothing until v has grown.
    h = fmax(h, time_under(rise, c->v, 0.1 * small * c->dc));
    // And it may not outlast its healing unseen.
    h = fmin(h, time_under(outside, c->v, fmax(2.0 * c->z, small) * c->dc));
    h = fmin(h, fmin(c->reach, time_to_let_go(rules, c, push)));
    h = tell(c, rise, h, STRAIGHT * small * c->dc);
    double direct = c->a * push->pressure + c->damping * c->v;
    double z = slip_under(outside, c->v, h) / c->dc;
    c->high = direct * log1p(small / z);
    c->low = small < z ? direct * log1p(-small / z) : -INFINITY;
    return h;
}
