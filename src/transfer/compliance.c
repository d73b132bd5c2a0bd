// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/compliance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/fft.h"

enum { MAX_ITERATIONS = 1000 };

struct lac_compliance {
    size_t n;
    uint32_t *at; // [n] index of each contact cell in the transform's grid
    lac_fft *fft;
    double *stiffness;               // [ny * nkx] S of each mode [Pa/m], 0 for the mean
    double *vectors, *r, *z, *p, *q; // [n] each, of the conjugate gradients
};

// S = G/2 (ky^2 + kx^2/(1 - nu))/|k|
static void fill_stiffness(lac_compliance *c, const lac_grid *grid, double g, double nu)
{
    const double tau = 6.283185307179586476925286766559;
    const lac_fft *fft = c->fft;
    for (size_t j = 0; j < fft->ny; j++) {
        double ky = tau * lac_fft_frequency(j, fft->ny) / ((double)fft->ny * grid->dy);
        for (size_t i = 0; i < fft->nkx; i++) {
            double kx = tau * (double)i / ((double)fft->nx * grid->dx);
            double k = hypot(kx, ky);
            c->stiffness[j * fft->nkx + i] = k > 0 ? g / 2 * (ky * ky + kx * kx / (1 - nu)) / k : 0;
        }
    }
}

lac_status lac_compliance_create(const lac_domain *domain, double shear_modulus, double poisson,
                                 lac_compliance **out, lac_error *err)
{
    *out = NULL;
    const lac_grid *grid = &domain->grid;
    size_t n = domain->n, pad = grid->periodic ? 1 : 2;
    lac_status status = LAC_OK;
    lac_compliance *c = calloc(1, sizeof *c);
    if (c == NULL) {
        return lac_fail_memory(err);
    }
    c->n = n;
    LAC_TRY(lac_fft_create(pad * grid->nx, grid->ny > 1 ? pad * grid->ny : 1, &c->fft, err));
    c->at = malloc(n * sizeof *c->at);
    c->stiffness = malloc(c->fft->ny * c->fft->nkx * sizeof *c->stiffness);
    c->vectors = malloc(4 * n * sizeof *c->vectors);
    if (c->at == NULL || c->stiffness == NULL || c->vectors == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    c->r = c->vectors;
    c->z = c->r + n;
    c->p = c->z + n;
    c->q = c->p + n;
    for (size_t i = 0; i < n; i++) {
        size_t x = domain->index[i] % grid->nx, y = domain->index[i] / grid->nx;
        c->at[i] = (uint32_t)(y * c->fft->nx + x);
    }
    fill_stiffness(c, grid, shear_modulus, poisson);
    *out = c;
    c = NULL;
out:
    lac_compliance_free(c);
    return status;
}

void lac_compliance_free(lac_compliance *c)
{
    if (c != NULL) {
        lac_fft_free(c->fft);
        free(c->at);
        free(c->stiffness);
        free(c->vectors);
        free(c);
    }
}

static void remove_mean(size_t n, double *x)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i];
    }
    double mean = sum / (double)n;
    for (size_t i = 0; i < n; i++) {
        x[i] -= mean;
    }
}

static double dot(size_t n, const double *x, const double *y)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

static void to_spectrum(lac_compliance *c, const double *x)
{
    lac_fft *fft = c->fft;
    memset(fft->real, 0, fft->nx * fft->ny * sizeof *fft->real);
    for (size_t i = 0; i < c->n; i++) {
        fft->real[c->at[i]] = x[i];
    }
    lac_fft_forward(fft);
}

static void from_spectrum(lac_compliance *c, double *y)
{
    lac_fft *fft = c->fft;
    lac_fft_inverse(fft);
    double scale = 1 / ((double)fft->nx * (double)fft->ny);
    for (size_t i = 0; i < c->n; i++) {
        y[i] = scale * fft->real[c->at[i]];
    }
    remove_mean(c->n, y);
}

// y = Q R F^-1 S^-1 F R^T x: slip under a traction, less its mean.
static void comply(lac_compliance *c, const double *x, double *y)
{
    to_spectrum(c, x);
    for (size_t i = 0; i < c->fft->ny * c->fft->nkx; i++) {
        c->fft->spectrum[i] *= c->stiffness[i] > 0 ? 1 / c->stiffness[i] : 0;
    }
    from_spectrum(c, y);
}

// y = Q R F^-1 S F R^T x: the inverse on full contact, the preconditioner elsewhere.
static void precondition(lac_compliance *c, const double *x, double *y)
{
    to_spectrum(c, x);
    for (size_t i = 0; i < c->fft->ny * c->fft->nkx; i++) {
        c->fft->spectrum[i] *= c->stiffness[i];
    }
    from_spectrum(c, y);
}

lac_status lac_compliance_invert(lac_compliance *c, const double *slip, double tolerance,
                                 double *traction, double *energy, lac_error *err)
{
    size_t n = c->n;
    double *r = c->r, *z = c->z, *p = c->p, *q = c->q;
    memset(traction, 0, n * sizeof *traction);
    memcpy(r, slip, n * sizeof *r);
    remove_mean(n, r);
    precondition(c, r, z);
    memcpy(p, z, n * sizeof *p);
    double rho = dot(n, r, z), gain = INFINITY;
    *energy = 0;
    for (int i = 0; i < MAX_ITERATIONS; i++) {
        if (rho == 0) {
            return LAC_OK;
        }
        comply(c, p, q);
        double step = rho / dot(n, p, q);
        for (size_t j = 0; j < n; j++) {
            traction[j] += step * p[j];
            r[j] -= step * q[j];
        }
        // slip . traction grows by these gains; what is still to come falls off as they do.
        double last = gain;
        gain = step * rho;
        *energy += gain;
        if (!isfinite(gain)) {
            break;
        }
        if (gain + last <= tolerance * *energy || gain <= 1e-15 * *energy) {
            return LAC_OK;
        }
        precondition(c, r, z);
        double before = rho;
        rho = dot(n, r, z);
        for (size_t j = 0; j < n; j++) {
            p[j] = z[j] + rho / before * p[j];
        }
    }
    return lac_fail(err, LAC_ENUMERIC,
                    "the elastic half-space on %zu contact cells did not converge in %d iterations",
                    n, MAX_ITERATIONS);
}
