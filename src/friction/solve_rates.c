// SPDX-License-Identifier: GPL-3.0-or-later
// The balance  p f(u, w) + eta e^u = |tau|  of many cells, in instructions that take several cells
// at a time. With F the plain coefficient, which is linear in u, the unknown is s = asinh(X), the
// regularised form's f/a; ln X = F/a - ln 2. Over p a the balance is
//
//     s + kappa v = t,   v = e^(s - shift) (1 - e^(-2 s))
//     kappa = eta/(p a),  t = |tau|/(p a),  shift = (F - a u)/a
//
// and in the plain form, s = F/a, the same without the bracket, which from s = BENT on is 1 to the
// last bit. So a step takes one exp, where f and f_u of u would take an exp, an asinh and a root.
//
// All derivatives by s come from v and v_s = e^(s - shift) (1 + e^(-2 s)), and Householder's
// iteration with three of them is of fourth order: after a step d the error is below 0.006 d^4, as
// every derivative of kappa v is below 1 + kappa v_s. v follows the last step by its series.
#include "friction/cutoff.h"

#include "base/vmath_kernels.h"
#include "friction/law.h"

// Cells at a time: as many iterations as the slowest of them needs.
enum { CHUNK = 64, MOST_STEPS = 30 };

// Variables, as compilers make a way of its own for what is at a bound that they know.
typedef struct bounds {
    double longest;          // step
    double most;             // |log v|: beyond no cell settles
    double slowest, fastest; // log v that counts
} bounds;

static const bounds all_bounds = {2.0, 700.0, LAC_SLOWEST, LAC_FASTEST};

#define CLOSE 5e-4 // 0.006 CLOSE^4 is rounding
#define BENT 20.0

// One chunk on its way. Nothing of a cell that is done changes, so that no cell's result depends on
// its neighbours.
typedef struct chunk {
    double s[CHUNK], t[CHUNK], kappa[CHUNK], shift[CHUNK], v[CHUNK];
    double open[CHUNK]; // 1; 0: done
} chunk;

// How many cells of a chunk are something or other.
typedef struct counts {
    uint64_t open, bent, cold;
} counts;

// sinh s for 0 <= s < 1
LAC_KERNEL small_sinh(double s)
{
    double z = s * s;
    double sum = 1.0 / 362880 + z * (1.0 / 39916800 + z * (1.0 / 6227020800 + z / 1307674368000.0));
    return s * (1 + z * (1.0 / 6 + z * (1.0 / 120 + z * (1.0 / 5040 + z * sum))));
}

// And where to begin: the s of the last rate, and no more than without damping.
LAC_CLONES static counts lac_solve_rates_prepare(const lac_friction *friction,
                                                 const lac_friction_balance *eq, const double *u,
                                                 chunk *c)
{
    const double *constant = lac_cellwise_from(&friction->constant, eq->first);
    const double *a = lac_cellwise_from(&friction->column[LAC_A], eq->first);
    const double *b = lac_cellwise_from(&friction->column[LAC_B], eq->first);
    const double *pressure = eq->pressure, *traction = eq->traction, *w = eq->w;
    double share = eq->share, eta = eq->damping;
    uint64_t bent = 0, cold = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < eq->n; i++) {
        double p = pressure[i] * share;
        double per = 1 / (p * a[i]);
        double t = fabs(traction[i]) * per;
        double kappa = eta * per;
        double shift = (constant[i] + b[i] * w[i]) * (p * per);
        double s = u[i] + shift;
        s = s < t ? s : t;
        s = kappa > 0 ? s : t;
        c->t[i] = t;
        c->kappa[i] = kappa;
        c->shift[i] = shift;
        c->s[i] = s;
        c->open[i] = 1;
        bent += s >= BENT ? 0 : 1;
        cold += ((u[i] != 0.0) & (u[i] >= LAC_SLOWEST) & (u[i] <= LAC_FASTEST)) ? 0 : 1;
    }
    return (counts){.open = eq->n, .bent = bent, .cold = cold};
}

// The same where some cells are bent.
LAC_CLONES static void lac_solve_rates_begin_bent(size_t n, chunk *c)
{
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double s = c->s[i];
        double small = 0.5 * lac_exp_one(s < 1 ? s : 1);
        c->s[i] = s > 1 || !(c->kappa[i] > 0) ? s : small < c->t[i] ? small : c->t[i];
    }
}

// The step of one cell from s, where v and v_s are `v` and `rise`.
LAC_KERNEL householder(double s, double v, double rise, double kappa, double t, double longest)
{
    double over = kappa * v;
    double steep = kappa * rise;
    double f = s + over - t;
    double f_s = 1 + steep;
    double up = f * (f_s * f_s - 0.5 * f * over);
    double down = f_s * f_s * f_s - f * f_s * over + f * f * steep * (1.0 / 6);
    double d = -up / down;
    d = d < longest ? d : longest;
    d = d > -longest ? d : -longest;
    return d < t - s ? d : t - s;
}

// One step of every cell that is not done.
static inline __attribute__((always_inline)) counts step_all(size_t n, bool bent,
                                                             const bounds *within, chunk *c)
{
    const double longest = within->longest, most = within->most;
    uint64_t left = 0, count = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double s = c->s[i], before = c->v[i], open = c->open[i];
        double log_v = s - c->shift[i];
        log_v = log_v > -most ? log_v : -most;
        double e = lac_exp_normal(log_v < most ? log_v : most);
        double v = e, rise = e;
        if (bent) {
            double y = lac_exp_one(-s);
            double bracket = s < 1 ? 2 * y * small_sinh(s) : 1 - y * y;
            v = e * bracket;
            rise = e * (1 + y * y);
        }
        double d = householder(s, v, rise, c->kappa[i], c->t[i], longest);
        double least = bent ? -0.875 * s : d; // s stays positive
        d = d > least ? d : least;
        double scale = bent && s < 1 ? s : 1;
        double z = d * d;
        double next = v * (1 + z * (0.5 + z * (1.0 / 24))) + rise * (d * (1 + z * (1.0 / 6)));
        s += open * d;
        c->s[i] = s;
        c->v[i] = open > 0 ? next : before;
        open = fabs(d) <= CLOSE * scale ? 0 : open;
        c->open[i] = open;
        left += open > 0 ? 1 : 0;
        count += s >= BENT ? 0 : 1;
    }
    return (counts){.open = left, .bent = count};
}

// Where no cell is bent, as none is in the plain form.
LAC_CLONES static counts lac_solve_rates_step(size_t n, const bounds *within, chunk *c)
{
    return step_all(n, false, within, c);
}

LAC_CLONES static counts lac_solve_rates_step_bent(size_t n, const bounds *within, chunk *c)
{
    return step_all(n, true, within, c);
}

// Where u and v go.
typedef struct rates {
    const double *traction;
    double *u, *v;
} rates;

// u and v of the cells that have settled within bounds, v of the sign of the traction; the others
// are left open. How many. The u that there were go to s.
static inline __attribute__((always_inline)) uint64_t
finish_all(size_t n, bool bent, const bounds *within, chunk *c, const rates *out)
{
    const double *traction = out->traction;
    const double slowest = within->slowest, fastest = within->fastest;
    double *u = out->u, *v = out->v;
    uint64_t left = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double log_v = c->s[i] - c->shift[i], speed = c->v[i];
        if (bent) {
            // where the bracket counts
            log_v = c->s[i] >= BENT ? log_v : lac_log_one(speed);
        }
        double room = (log_v - slowest) * (fastest - log_v) - c->open[i] * DBL_MAX;
        c->s[i] = u[i];
        u[i] = log_v;
        v[i] = copysign(speed, traction[i]);
        c->open[i] = room > 0 ? 0 : 1;
        left += room > 0 ? 0 : 1;
    }
    return left;
}

LAC_CLONES static uint64_t lac_solve_rates_finish(size_t n, const bounds *within, chunk *c,
                                                  const rates *out)
{
    return finish_all(n, false, within, c, out);
}

LAC_CLONES static uint64_t lac_solve_rates_finish_bent(size_t n, const bounds *within, chunk *c,
                                                       const rates *out)
{
    return finish_all(n, true, within, c, out);
}

// The rates of one chunk.
static void solve_chunk(const lac_friction *friction, const lac_friction_balance *eq, double *u,
                        double *v)
{
    chunk c;
    const bool regularised = friction->form == LAC_FORM_REGULARISED;
    counts now = lac_solve_rates_prepare(friction, eq, u, &c);
    if (now.cold > 0) {
        lac_friction_warm(friction, eq, u);
        now = lac_solve_rates_prepare(friction, eq, u, &c);
    }
    if (regularised && now.bent > 0) {
        lac_solve_rates_begin_bent(eq->n, &c);
    }
    for (int step = 0; step < MOST_STEPS && now.open > 0; step++) {
        now = regularised && now.bent > 0 ? lac_solve_rates_step_bent(eq->n, &all_bounds, &c)
                                          : lac_solve_rates_step(eq->n, &all_bounds, &c);
    }
    const rates out = {eq->traction, u, v};
    const uint64_t left = regularised && now.bent > 0
                              ? lac_solve_rates_finish_bent(eq->n, &all_bounds, &c, &out)
                              : lac_solve_rates_finish(eq->n, &all_bounds, &c, &out);
    for (size_t i = 0; left > 0 && i < eq->n; i++) {
        u[i] = c.open[i] > 0 ? c.s[i] : u[i];
    }
    if (left > 0) {
        lac_friction_search_rest(friction, eq, c.open, u, v);
    }
}

void lac_friction_solve_rates(const lac_friction *friction, const lac_friction_balance *eq,
                              double *u, double *v)
{
    for (size_t first = 0; first < eq->n; first += CHUNK) {
        lac_friction_balance part = lac_friction_balance_from(eq, first);
        part.n = eq->n - first < CHUNK ? eq->n - first : CHUNK;
        solve_chunk(friction, &part, u + first, v + first);
    }
}
