// SPDX-License-Identifier: GPL-3.0-or-later
// The rock under slip in two directions, on full contact that repeats: the tensor of each wave, a
// filter; its systems by conjugate gradients, with the hierarchy near their inverse.
#include "base/statistics.h"
#include "base/vsum.h"
#include "transfer/calibrate.h"
#include "transfer/elastic_solve.h"

lac_status lac_elastic_direct(const lac_transfer_scene *scene, const lac_rock *rock, lac_elastic *e,
                              lac_error *err)
{
    lac_rock across = *rock, cross = *rock;
    across.across = true;
    cross.cross = true;
    LAC_FAIL_IF(!e->direct || !scene->domain->grid.periodic || rock->antiplane, err, LAC_EINPUT,
                "knows slip in two directions in-plane and on full contact that repeats only");
    e->k_across = calloc(lac_hierarchy_levels(scene->hierarchy) + 1, sizeof *e->k_across);
    LAC_FAIL_MEMORY_IF(e->k_across == NULL, err);
    LAC_TRY_RETURN(lac_compliance_create(scene->domain, &across, &e->across, err));
    LAC_TRY_RETURN(lac_compliance_create(scene->domain, &cross, &e->cross, err));
    return lac_calibrate_elastic(scene, true, 1, e->k_across, err);
}

// One system (D + K + k_mean P) x = y; vectors have the components along x, then those along y.
typedef struct pair_job {
    const lac_elastic *e;
    const double *const *d;
    double k_mean;
    double *v;       // [n]
    double *scratch; // lac_hierarchy_pair_work
} pair_job;

size_t lac_elastic_pair_work(const void *state)
{
    const lac_elastic *e = state;
    return 11 * e->n + lac_hierarchy_pair_work(e->h) + lac_elastic_work(e);
}

// y += S x of one component of the tensor.
static void add_filtered(lac_compliance *rock, size_t n, const double *x, double *y, double *v)
{
    lac_compliance_traction(rock, x, v);
    for (size_t i = 0; i < n; i++) {
        y[i] += v[i];
    }
}

static void add_mean(size_t n, double value, double *x)
{
    for (size_t i = 0; i < n; i++) {
        x[i] += value;
    }
}

void lac_elastic_pair_apply(const void *state, const double *const slip[2], double *const force[2],
                            double *v)
{
    const lac_elastic *e = state;
    const size_t n = e->n;
    lac_compliance_traction(e->rock, slip[0], force[0]);
    lac_compliance_traction(e->across, slip[1], force[1]);
    add_filtered(e->cross, n, slip[1], force[0], v);
    add_filtered(e->cross, n, slip[0], force[1], v);
    for (int c = 0; c < 2 && e->floating; c++) {
        add_mean(n, -lac_sum(n, force[c]) / (double)n, force[c]);
    }
}

static void multiply(void *self, const double *x, double *y)
{
    const pair_job *j = self;
    const size_t n = j->e->n;
    const double *const slip[2] = {x, x + n};
    double *const force[2] = {y, y + n};
    lac_elastic_pair_apply(j->e, slip, force, j->v);
    for (size_t i = 0; i < n; i++) {
        y[i] += j->d[0][i] * x[i] + j->d[1][i] * x[n + i];
        y[n + i] += j->d[1][i] * x[i] + j->d[2][i] * x[n + i];
    }
    for (int c = 0; c < 2; c++) {
        add_mean(n, j->k_mean * (lac_sum(n, slip[c]) / (double)n), force[c]);
    }
}

// (D + K_h + (k_mean + anchor) P) z = r
static double precondition(void *self, const double *r, double *z)
{
    const pair_job *j = self;
    const lac_elastic *e = j->e;
    const size_t n = e->n;
    const double *const k[2] = {e->k, e->k_across};
    double *const x[2] = {z, z + n};
    const double k_mean = j->k_mean + (e->floating ? 0.0 : e->anchor);
    memcpy(z, r, 2 * n * sizeof *z);
    return lac_hierarchy_solve_pair(e->h, k, k_mean, j->d, x, j->scratch) ? lac_vdot(2 * n, r, z)
                                                                          : (double)NAN;
}

// From x = M y, whose forces balance, so that those of all that follow do.
bool lac_elastic_pair_solve(const void *state, double k_mean, const double *const diagonal[3],
                            double *const x[2], double *work)
{
    const lac_elastic *e = state;
    const size_t n = e->n;
    pair_job j = {.e = e, .d = diagonal, .k_mean = k_mean, .v = work, .scratch = work + n};
    double *start = j.scratch + lac_hierarchy_pair_work(e->h), *r = start + 2 * n;
    const lac_krylov system = {2 * n, &j, multiply, precondition};
    memcpy(r, x[0], n * sizeof *r);
    memcpy(r + n, x[1], n * sizeof *r);
    const double size = precondition(&j, r, start);
    if (isnan(size)) {
        return false;
    }
    double *product = r + 2 * n; // of iterate's own
    multiply(&j, start, product);
    for (size_t i = 0; i < 2 * n; i++) {
        r[i] -= product[i];
    }
    const int iterations =
        lac_elastic_iterate(&system, start, r, size, e->newton_tolerance, r + 2 * n);
    memcpy(x[0], start, n * sizeof *r);
    memcpy(x[1], start + n, n * sizeof *r);
    return iterations >= 0;
}
