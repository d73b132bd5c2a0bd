// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients that stop by the preconditioner's own measure of the error.
#include "transfer/krylov.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/vsum.h"

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

int lac_krylov_solve(const lac_krylov *a, double *x, double *r, double size, double tolerance,
                     int most, double *work)
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
    for (int i = 0; i <= most; i++) {
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
