// SPDX-License-Identifier: GPL-3.0-or-later
// Tractions moved back within the friction limits of their cells, with the sum that the load asks.
#include "base/statistics.h"
#include "contact/tangential_solve.h"

// lambda is the minimum of the convex function of two variables
//   Phi = sum h(|y_i + lambda|) - load.lambda,  h(v) = v^2/2 inside the disc, r v - r^2/2 beyond,
// whose gradient F = sum disc(y_i + lambda) - load has to vanish. Newton's method, damped by a
// multiple of 1 that follows F down to 0 and how well the last step went.

typedef struct state {
    double phi, size;  // Phi, and the sum of its terms' sizes
    double f[2];       // F along the axes held, else 0
    double xx, yy, xy; // Jacobian
    double pull;       // sum of |disc(y_i + lambda)| and the load
} state;

static state evaluate(const lac_shear_problem *p, const double *restrict y, const double lambda[2])
{
    const double *restrict limit = p->limit;
    const size_t n = p->n;
    const double lx = lambda[0], ly = lambda[1];
    double phi = 0.0, fx = 0.0, fy = 0.0, xx = 0.0;
    double yy = 0.0, xy = 0.0, pull = 0.0;
#pragma omp simd safelen(2) reduction(+ : phi, fx, fy, xx, yy, xy, pull)
    for (size_t i = 0; i < n; i++) {
        double vx = y[i] + lx, vy = y[n + i] + ly;
        double v = sqrt(vx * vx + vy * vy);
        double c = v > limit[i] ? limit[i] / v : 1.0;
        double w = v > limit[i] ? c / (v * v) : 0.0;
        phi += c * v * (v - 0.5 * c * v);
        fx += c * vx;
        fy += c * vy;
        xx += c - w * vx * vx;
        yy += c - w * vy * vy;
        xy -= w * vx * vy;
        pull += c * v;
    }
    pull += fabs(p->load[0]) + fabs(p->load[1]);
    double given = p->load[0] * lx + p->load[1] * ly;
    state s = {phi - given, phi + fabs(given), {fx - p->load[0], fy - p->load[1]}, xx, yy, xy,
               pull};
    s.f[0] = p->held[0] ? s.f[0] : 0.0;
    s.f[1] = p->held[1] ? s.f[1] : 0.0;
    return s;
}

static double size(const state *s) { return hypot(s->f[0], s->f[1]); }

// d = -(J + damping)^-1 F along the axes held
static void newton(const lac_shear_problem *p, const state *s, double damping, double d[2])
{
    double xx = s->xx + damping;
    double yy = s->yy + damping;
    double xy = p->held[0] && p->held[1] ? s->xy : 0.0;
    double det = xx * yy - xy * xy;
    if (!(det > 0.0)) {
        xy = 0.0;
        det = xx * yy;
    }
    d[0] = (-yy * s->f[0] + xy * s->f[1]) / det;
    d[1] = (xy * s->f[0] - xx * s->f[1]) / det;
}

// How near to 0 F has to come: the limits' rounding, or the tractions', where they are far below
static double enough(const state *s, double strength)
{
    return 4.0 * DBL_EPSILON * fmin(strength, 64.0 * s->pull);
}

// Without limits: F is linear
static void spread(const lac_shear_problem *p, const double *y, double lambda[2])
{
    for (size_t axis = 0; axis < 2; axis++) {
        double sum = 0.0;
        for (size_t i = 0; i < p->n; i++) {
            sum += y[axis * p->n + i];
        }
        lambda[axis] = p->held[axis] ? (p->load[axis] - sum) / (double)p->n : lambda[axis];
    }
}

static void find_lambda(const lac_shear_problem *p, const double *y, double lambda[2])
{
    enum { MOST = 200 };
    double strength = lac_sum(p->n, p->limit);
    if (!isfinite(strength)) {
        spread(p, y, lambda);
        return;
    }
    double damping = 0.01 * (double)p->n / strength;
    state s = evaluate(p, y, lambda);
    for (int k = 0; k < MOST && size(&s) > enough(&s, strength); k++) {
        double d[2];
        newton(p, &s, damping * size(&s) + DBL_MIN, d);
        double at[2] = {lambda[0] + d[0], lambda[1] + d[1]};
        if (at[0] == lambda[0] && at[1] == lambda[1]) {
            break;
        }
        state next = evaluate(p, y, at);
        if (next.phi < s.phi || (next.phi <= s.phi + 1e-12 * s.size && size(&next) < size(&s))) {
            lambda[0] = at[0];
            lambda[1] = at[1];
            s = next;
            damping *= 0.1;
        } else {
            damping *= 100.0;
        }
    }
}

void lac_shear_project(const lac_shear_problem *p, const double *y, double *tau, uint8_t *limited,
                       double lambda[2])
{
    if (p->held[0] || p->held[1]) {
        find_lambda(p, y, lambda);
    }
    for (size_t i = 0; i < p->n; i++) {
        double vx = y[i] + lambda[0], vy = y[p->n + i] + lambda[1];
        double v = hypot(vx, vy);
        limited[i] = v >= p->limit[i];
        double c = v > p->limit[i] ? p->limit[i] / v : 1.0;
        tau[i] = c * vx;
        tau[p->n + i] = c * vy;
    }
}
