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

#define LONGEST 2.0
#define CLOSE 5e-4 // 0.006 CLOSE^4 is rounding
#define BENT 20.0

// One chunk on its way. Nothing of a cell that is done changes, so that no cell's result depends on
// its neighbours.
typedef struct chunk {
    double s[CHUNK], t[CHUNK], kappa[CHUNK], shift[CHUNK], v[CHUNK];
    uint64_t open[CHUNK]; // 0: done
} chunk;

// sinh s for 0 <= s < 1
LAC_KERNEL small_sinh(double s)
{
    double z = s * s;
    double sum = 1.0 / 362880 + z * (1.0 / 39916800 + z * (1.0 / 6227020800 + z / 1307674368000.0));
    return s * (1 + z * (1.0 / 6 + z * (1.0 / 120 + z * (1.0 / 5040 + z * sum))));
}

LAC_CLONES static void lac_solve_rates_prepare(const lac_friction *friction,
                                               const lac_friction_balance *eq, size_t first,
                                               size_t n, chunk *c)
{
    const double *constant = lac_cellwise_from(&friction->constant, eq->first + first);
    const double *a = lac_cellwise_from(&friction->column[LAC_A], eq->first + first);
    const double *b = lac_cellwise_from(&friction->column[LAC_B], eq->first + first);
    const double *pressure = eq->pressure + first;
    const double *traction = eq->traction + first;
    const double *w = eq->w + first;
    double share = eq->share, eta = eq->damping;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double p = pressure[i] * share;
        double per = 1 / (p * a[i]);
        c->t[i] = fabs(traction[i]) * per;
        c->kappa[i] = eta * per;
        c->shift[i] = (constant[i] + b[i] * w[i]) * (p * per);
        c->open[i] = 1;
    }
}

// Where to begin: the s of the last rate, and no more than without damping. How many are bent.
LAC_CLONES static uint64_t lac_solve_rates_begin(size_t n, const double *u, chunk *c)
{
    uint64_t count = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double s = u[i] + c->shift[i];
        s = s < c->t[i] ? s : c->t[i];
        s = c->kappa[i] > 0 ? s : c->t[i];
        c->s[i] = s;
        count += s >= BENT ? 0 : 1;
    }
    return count;
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
LAC_KERNEL householder(double s, double v, double rise, double kappa, double t)
{
    double over = kappa * v;
    double steep = kappa * rise;
    double f = s + over - t;
    double f_s = 1 + steep;
    double up = f * (f_s * f_s - 0.5 * f * over);
    double down = f_s * f_s * f_s - f * f_s * over + f * f * steep * (1.0 / 6);
    double d = -up / down;
    d = d < LONGEST ? d : LONGEST;
    d = d > -LONGEST ? d : -LONGEST;
    return d < t - s ? d : t - s;
}

// One step of every cell that is not done; how many are left then.
static inline __attribute__((always_inline)) uint64_t step_all(size_t n, bool bent, bool odd,
                                                               chunk *c)
{
    uint64_t left = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double s = c->s[i];
        double log_v = s - c->shift[i]; // beyond these no cell settles
        log_v = log_v > -700 ? log_v : -700;
        double e = lac_exp_normal(log_v < 700 ? log_v : 700);
        double v = e, rise = e;
        if (bent) {
            double y = lac_exp_one(-s);
            double bracket = s < 1 ? 2 * y * small_sinh(s) : 1 - y * y;
            v = e * bracket;
            rise = e * (1 + y * y);
        }
        double d = householder(s, v, rise, c->kappa[i], c->t[i]);
        double least = odd ? -0.875 * s : -LONGEST; // s stays positive
        d = d > least ? d : least;
        double scale = odd && s < 1 ? s : 1;
        double z = d * d;
        double next = v * (1 + z * (0.5 + z * (1.0 / 24))) + rise * (d * (1 + z * (1.0 / 6)));
        bool open = c->open[i] != 0;
        c->s[i] = open ? s + d : s;
        c->v[i] = open ? next : c->v[i];
        uint64_t still = open && !(fabs(d) <= CLOSE * scale) ? 1 : 0;
        c->open[i] = still;
        left += still;
    }
    return left;
}

LAC_CLONES static uint64_t lac_solve_rates_step_plain(size_t n, chunk *c)
{
    return step_all(n, false, false, c);
}
LAC_CLONES static uint64_t lac_solve_rates_step_far(size_t n, chunk *c)
{
    return step_all(n, false, true, c);
}
LAC_CLONES static uint64_t lac_solve_rates_step_bent(size_t n, chunk *c)
{
    return step_all(n, true, true, c);
}

// How many cells feel the bracket.
LAC_CLONES static uint64_t lac_solve_rates_count_bent(size_t n, const chunk *c)
{
    uint64_t count = 0;
    for (size_t i = 0; i < n; i++) {
        count += c->s[i] >= BENT ? 0 : 1;
    }
    return count;
}

// Where results go.
typedef struct found {
    const double *traction;
    double *u, *v, *settled;
} found;

// u and v of the cells that have settled within bounds, v of the sign of the traction. How many
// have not.
static inline __attribute__((always_inline)) uint64_t finish_all(size_t n, bool bent,
                                                                 const chunk *c, const found *out)
{
    double *u = out->u, *v = out->v, *settled = out->settled;
    const double *traction = out->traction;
    uint64_t left = 0;
    LAC_INDEPENDENT
    for (size_t i = 0; i < n; i++) {
        double log_v = c->s[i] - c->shift[i];
        if (bent) {
            // where the bracket counts
            log_v = c->s[i] >= BENT ? log_v : lac_log_one(c->v[i]);
        }
        uint64_t good = c->open[i] == 0 && log_v > LAC_SLOWEST && log_v < LAC_FASTEST ? 1 : 0;
        u[i] = good != 0 ? log_v : u[i];
        v[i] = copysign(c->v[i], traction[i]);
        settled[i] = good != 0 ? 1 : 0;
        left += 1 - good;
    }
    return left;
}

LAC_CLONES static uint64_t lac_solve_rates_finish(size_t n, const chunk *c, const found *out)
{
    return finish_all(n, false, c, out);
}

LAC_CLONES static uint64_t lac_solve_rates_finish_bent(size_t n, const chunk *c, const found *out)
{
    return finish_all(n, true, c, out);
}

// @param bent  how many of the cells are bent. @return the same at the end
static uint64_t settle_chunk(size_t n, bool regularised, uint64_t bent, chunk *c)
{
    uint64_t left = n;
    for (int step = 0; step < MOST_STEPS && left > 0; step++) {
        if (!regularised) {
            left = lac_solve_rates_step_plain(n, c);
        } else if (bent == 0) {
            left = lac_solve_rates_step_far(n, c);
        } else {
            left = lac_solve_rates_step_bent(n, c);
        }
        bent = regularised ? lac_solve_rates_count_bent(n, c) : 0;
    }
    return bent;
}

size_t lac_friction_solve_rates(const lac_friction *friction, const lac_friction_balance *eq,
                                double *u, double *v, double *settled)
{
    bool regularised = friction->form == LAC_FORM_REGULARISED;
    size_t left = 0;
    for (size_t first = 0; first < eq->n; first += CHUNK) {
        chunk c;
        size_t n = eq->n - first < CHUNK ? eq->n - first : CHUNK;
        found out = {eq->traction + first, u + first, v + first, settled + first};
        lac_solve_rates_prepare(friction, eq, first, n, &c);
        uint64_t bent = lac_solve_rates_begin(n, u + first, &c);
        if (regularised && bent > 0) {
            lac_solve_rates_begin_bent(n, &c);
        }
        bent = settle_chunk(n, regularised, bent, &c);
        left += bent > 0 ? lac_solve_rates_finish_bent(n, &c, &out)
                         : lac_solve_rates_finish(n, &c, &out);
    }
    return left;
}

LAC_CLONES size_t lac_friction_count_cold(size_t n, const double *u)
{
    size_t count = 0;
    for (size_t i = 0; i < n; i++) {
        count += u[i] != 0.0 && u[i] >= LAC_SLOWEST && u[i] <= LAC_FASTEST ? 0 : 1;
    }
    return count;
}
