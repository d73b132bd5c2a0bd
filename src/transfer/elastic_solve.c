// SPDX-License-Identifier: GPL-3.0-or-later
// The three systems of the elastic transfer; docs/theory/transfer.md, equations 16 to 20.
#include "transfer/elastic_solve.h"

#include "base/statistics.h"
#include "base/vsum.h"

enum { KRYLOV_WORK = 3 }; // vectors of scratch

static bool positive(double x) { return x > 0 && x <= DBL_MAX; }

// x += step p, r -= step q
static void advance(size_t n, double step, const double *restrict p, const double *restrict q,
                    double *restrict x, double *restrict r)
{
    for (size_t i = 0; i < n; i++) {
        x[i] += step * p[i];
        r[i] -= step * q[i];
    }
}

int lac_elastic_iterate(const lac_krylov *a, double *x, double *r, double size, double tolerance,
                        double *work)
{
    size_t n = a->n;
    double *z = work, *p = z + n, *q = p + n;
    double error = a->precondition(a->self, r, z);
    if (isnan(error)) {
        return -1; // z may hold nothing
    }
    double goal = tolerance * tolerance * (isnan(size) ? error : size);
    double rho = lac_vdot(n, r, z);
    memcpy(p, z, n * sizeof *p);
    for (int i = 0; i <= LAC_ELASTIC_ITERATIONS; i++) {
        if (error <= goal || rho == 0) {
            return i;
        }
        a->multiply(a->self, p, q);
        double curvature = lac_vdot(n, p, q);
        if (!positive(curvature) || !positive(rho)) {
            return -1;
        }
        advance(n, rho / curvature, p, q, x, r);
        error = a->precondition(a->self, r, z);
        if (isnan(error)) {
            return -1;
        }
        double before = rho;
        rho = lac_vdot(n, r, z);
        for (size_t j = 0; j < n; j++) {
            p[j] = z[j] + rho / before * p[j];
        }
    }
    return -1;
}

// One system (D + K + k_mean P) x = y while it is solved.
typedef struct job {
    const lac_elastic *e;
    const double *d;
    double k_mean;
    double sum_d;    // sum of D + n k_mean
    double *v, *w;   // [n] each
    double *scratch; // lac_hierarchy_work
} job;

static void add(size_t n, double value, double *x)
{
    for (size_t i = 0; i < n; i++) {
        x[i] += value;
    }
}

static void take_mean_off(const lac_elastic *e, double *x)
{
    if (e->floating) {
        add(e->n, -lac_sum(e->n, x) / (double)e->n, x);
    }
}

// y = (K_h + anchor P) x: the hierarchy's part of the stiffness.
static void stiffen(const lac_elastic *e, const double *x, double *y, double *scratch)
{
    lac_hierarchy_apply(e->h, e->k, x, y, scratch);
    if (!e->floating) {
        add(e->n, e->anchor * (lac_sum(e->n, x) / (double)e->n), y);
    }
}

// y = (D + k_mean P) x
static void diagonal_times(const job *j, const double *x, double *y)
{
    size_t n = j->e->n;
    double mean = j->k_mean * (lac_sum(n, x) / (double)n);
    for (size_t i = 0; i < n; i++) {
        y[i] = j->d[i] * x[i] + mean;
    }
}

// y = (D + k_mean P)^-1 x
static void diagonal_inverse(const job *j, const double *x, double *y)
{
    size_t n = j->e->n;
    double g = 0, gx = 0;
    for (size_t i = 0; i < n; i++) {
        g += 1 / j->d[i];
        gx += x[i] / j->d[i];
    }
    double mean = j->k_mean * gx / ((double)n + j->k_mean * g);
    for (size_t i = 0; i < n; i++) {
        y[i] = (x[i] - mean) / j->d[i];
    }
}

// (D + K_h + (k_mean + anchor) P) x = y
static bool near_inverse(const job *j, const double *y, double *x)
{
    const lac_elastic *e = j->e;
    double k_mean = j->k_mean + (e->floating ? 0 : e->anchor);
    return lac_hierarchy_solve(e->h, e->k, k_mean, j->d, y, x, j->scratch);
}

// 1. K is a filter: x itself is iterated.

static void multiply_slip(void *self, const double *x, double *y)
{
    const job *j = self;
    lac_compliance_traction(j->e->rock, x, j->v);
    take_mean_off(j->e, j->v);
    diagonal_times(j, x, y);
    for (size_t i = 0; i < j->e->n; i++) {
        y[i] += j->v[i];
    }
}

static double precondition_slip(void *self, const double *r, double *z)
{
    const job *j = self;
    return near_inverse(j, r, z) ? lac_vdot(j->e->n, r, z) : (double)NAN;
}

// From x = M y, whose forces balance, so that those of all that follow do.
static int solve_slip(job *j, const double *y, double *x, double *work)
{
    size_t n = j->e->n;
    double *r = work, *start = r + n;
    lac_krylov system = {n, j, multiply_slip, precondition_slip};
    if (!near_inverse(j, y, start)) {
        return -1;
    }
    double size = lac_vdot(n, y, start);
    multiply_slip(j, start, r);
    for (size_t i = 0; i < n; i++) {
        r[i] = y[i] - r[i];
    }
    memcpy(x, start, n * sizeof *x);
    return lac_elastic_iterate(&system, x, r, size, j->e->newton_tolerance, work + n);
}

// 2. K is the inverse of C, D > 0: (C + D^-1) tau = D^-1 y, x = C tau + m.

static void multiply_traction(void *self, const double *x, double *y)
{
    const job *j = self;
    lac_compliance_slip(j->e->rock, x, j->v);
    diagonal_inverse(j, x, y);
    for (size_t i = 0; i < j->e->n; i++) {
        y[i] += j->v[i];
    }
    take_mean_off(j->e, y);
}

// The error that is left in x = C tau + w: (D + K)^-1 (K_h - K) w, K_h being as far from K as K is
// from nothing. From z = K_h w, squared and in the norm of D + K, it is less than either of these.
static double error_left(const job *j, const double *z)
{
    double by_diagonal = 0;
    for (size_t i = 0; i < j->e->n; i++) {
        by_diagonal += z[i] * z[i] / j->d[i];
    }
    return fmin(by_diagonal, lac_vdot(j->e->n, j->w, z));
}

// rho = D r is the residual of x, once the mean of r balances the forces; w = M rho is what x
// still lacks, K_h w what tau does.
static double precondition_traction(void *self, const double *r, double *z)
{
    const job *j = self;
    const lac_elastic *e = j->e;
    diagonal_times(j, r, j->v);
    if (e->floating) {
        double off = lac_sum(e->n, j->v) / j->sum_d;
        for (size_t i = 0; i < e->n; i++) {
            j->v[i] -= (j->d[i] + j->k_mean) * off;
        }
    }
    if (!near_inverse(j, j->v, j->w)) {
        return NAN;
    }
    stiffen(e, j->w, z, j->scratch);
    return error_left(j, z);
}

// tau from r, of an error of `size`; x = C tau
static int find_traction(const job *j, lac_krylov *system, double *r, double size, double *x)
{
    const lac_elastic *e = j->e;
    double *tau = r + e->n;
    memset(tau, 0, e->n * sizeof *tau);
    int iterations = lac_elastic_iterate(system, tau, r, size, e->newton_tolerance, tau + e->n);
    lac_compliance_slip(e->rock, tau, x);
    return iterations;
}

static int solve_traction(job *j, const double *y, double *x, double *work)
{
    const lac_elastic *e = j->e;
    size_t n = e->n;
    double *r = work, *tau = r + n;
    lac_krylov system = {n, j, multiply_traction, precondition_traction};
    diagonal_inverse(j, y, r);
    take_mean_off(e, r);
    memset(tau, 0, n * sizeof *tau);
    double rigid = e->floating ? lac_sum(n, y) : 0;
    (void)precondition_traction(j, r, tau);
    double size = lac_vdot(n, j->v, j->w) + rigid * rigid / j->sum_d;
    int iterations = find_traction(j, &system, r, size, x);
    for (size_t i = 0; i < n; i++) {
        x[i] += j->w[i];
    }
    return iterations;
}

// 3. Some D <= 0: (C D C + C) tau = C y, x = C tau + m, m balancing the forces.

// y = C (D x + t), forces balanced
static void bring_home(const job *j, const double *x, const double *t, double *y)
{
    const lac_elastic *e = j->e;
    diagonal_times(j, x, j->w);
    double off = e->floating ? lac_sum(e->n, j->w) / j->sum_d : 0;
    for (size_t i = 0; i < e->n; i++) {
        j->w[i] += t[i] - (j->d[i] + j->k_mean) * off;
    }
    lac_compliance_slip(e->rock, j->w, y);
    take_mean_off(e, y);
}

static void multiply_squared(void *self, const double *x, double *y)
{
    const job *j = self;
    lac_compliance_slip(j->e->rock, x, j->v);
    take_mean_off(j->e, j->v);
    bring_home(j, j->v, x, y);
}

static double precondition_squared(void *self, const double *r, double *z)
{
    const job *j = self;
    stiffen(j->e, r, j->v, j->scratch);
    if (!near_inverse(j, j->v, j->w)) {
        return NAN;
    }
    stiffen(j->e, j->w, z, j->scratch);
    return lac_vdot(j->e->n, r, z);
}

static int solve_squared(job *j, const double *y, double *x, double *work)
{
    const lac_elastic *e = j->e;
    size_t n = e->n;
    double *r = work, *tau = r + n;
    lac_krylov system = {n, j, multiply_squared, precondition_squared};
    double off = e->floating ? lac_sum(n, y) / j->sum_d : 0;
    for (size_t i = 0; i < n; i++) {
        tau[i] = y[i] - (j->d[i] + j->k_mean) * off;
    }
    lac_compliance_slip(e->rock, tau, r);
    take_mean_off(e, r);
    memset(tau, 0, n * sizeof *tau);
    double size = precondition_squared(j, r, tau);
    size += e->floating ? off * off * j->sum_d : 0;
    return find_traction(j, &system, r, size, x);
}

size_t lac_elastic_work(const lac_elastic *e)
{
    return (size_t)(KRYLOV_WORK + 5) * e->n + lac_hierarchy_work(e->h);
}

// The mean slip that balances the forces: sum of (D + k_mean) x = sum of y, to rounding.
static void balance(const job *j, double force, double *x)
{
    size_t n = j->e->n;
    double held = j->k_mean * lac_sum(n, x) + lac_vdot(n, j->d, x);
    add(n, (force - held) / j->sum_d, x);
}

int lac_elastic_solve(const lac_elastic *e, double k_mean, const double *diagonal, const double *y,
                      double *x, double *work)
{
    size_t n = e->n;
    job j = {.e = e, .d = diagonal, .k_mean = k_mean, .v = work, .w = work + n};
    j.scratch = work + 2 * n;
    work = j.scratch + lac_hierarchy_work(e->h);
    bool soft = false;
    for (size_t i = 0; i < n; i++) {
        soft = soft || !(diagonal[i] > 0);
    }
    j.sum_d = lac_sum(n, diagonal) + (double)n * k_mean;
    if (!isfinite(j.sum_d) || (e->floating && !(j.sum_d > 0))) {
        return -1;
    }
    double force = lac_sum(n, y), *found = work;
    int iterations = e->direct ? solve_slip(&j, y, found, work + n)
                     : soft    ? solve_squared(&j, y, found, work + n)
                               : solve_traction(&j, y, found, work + n);
    if (e->floating) {
        balance(&j, force, found);
    }
    memcpy(x, found, n * sizeof *x);
    return iterations;
}

// K slip = tau with C tau = slip, the mean of the slip apart.

static void multiply_compliance(void *self, const double *x, double *y)
{
    const job *j = self;
    lac_compliance_slip(j->e->rock, x, y);
    take_mean_off(j->e, y);
}

static double precondition_compliance(void *self, const double *r, double *z)
{
    const job *j = self;
    const lac_elastic *e = j->e;
    if (e->k != NULL) {
        stiffen(e, r, z, j->scratch);
    } else {
        lac_compliance_traction(e->rock, r, z);
        take_mean_off(e, z);
    }
    return lac_vdot(e->n, r, z);
}

int lac_elastic_apply(const lac_elastic *e, const double *slip, double *force, double *work)
{
    size_t n = e->n;
    double *r = work, *tau = r + n;
    job j = {.e = e, .scratch = tau + n};
    if (e->direct && !e->floating) {
        lac_compliance_traction(e->rock, slip, force);
        return 0;
    }
    memcpy(r, slip, n * sizeof *r);
    take_mean_off(e, r);
    if (e->direct) {
        lac_compliance_traction(e->rock, r, force);
        take_mean_off(e, force);
        return 0;
    }
    take_mean_off(e, r); // what rounding left: of slips all but alike as much as they differ by
    lac_krylov system = {n, &j, multiply_compliance, precondition_compliance};
    memset(tau, 0, n * sizeof *tau);
    int iterations = lac_elastic_iterate(&system, tau, r, NAN, e->tolerance,
                                         j.scratch + lac_hierarchy_work(e->h));
    take_mean_off(e, tau);
    for (size_t i = 0; i < n; i++) {
        force[i] = iterations < 0 ? (double)NAN : tau[i];
    }
    return iterations;
}
