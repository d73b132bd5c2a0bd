// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/compliance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/fft.h"

enum { MAX_ITERATIONS = 1000 };

struct lac_compliance {
    size_t n;
    size_t *at; // [n] index of each contact cell in the transform's grid
    lac_fft *fft;
    double *stiffness; // [nkx * ny] S/N of each mode [Pa/m], 0 for the mean
    double
        *compliance; // [nkx * ny] 1/(S N) of each mode [m/Pa], 0 for the mean; free: see fill_free
    double *vectors, *r, *z, *p, *q; // [n] each, of the conjugate gradients
};

// S = G/2 (ky^2 + kx^2/(1 - nu))/|k|, with the 1/N of the transforms
static void fill_modes(lac_compliance *c, const lac_grid *grid, double g, double nu)
{
    const double tau = 6.283185307179586476925286766559;
    const lac_fft *fft = c->fft;
    double cells = (double)fft->nx * (double)fft->ny;
    for (size_t j = 0; j < fft->ny; j++) {
        double ky = tau * lac_fft_frequency(j, fft->ny) / ((double)fft->ny * grid->dy);
        for (size_t i = 0; i < fft->nkx; i++) {
            double kx = tau * (double)i / ((double)fft->nx * grid->dx);
            double k = hypot(kx, ky);
            double s = k > 0 ? g / 2 * (ky * ky + kx * kx / (1 - nu)) / k : 0;
            c->stiffness[i * fft->ny + j] = s / cells;
            c->compliance[i * fft->ny + j] = s > 0 ? 1 / (s * cells) : 0;
        }
    }
}

// sqrt(q) atan(sqrt(q) s), which goes on smoothly to q < 0
static double arc(double q, double s)
{
    double root = sqrt(fabs(q));
    return q < 0 ? -root * atanh(root * s) : root * atan(root * s);
}

// The integral of r/(x^2 + y^2/(1 - nu)) from the origin to a corner (x, y), odd in both; x, y not
// 0; docs/theory/transfer.md, equation 12b.
static double to_corner(double nu, double x, double y)
{
    double ax = fabs(x), ay = fabs(y), r = hypot(x, y);
    double sum = (1 - nu) * ax * (asinh(ay / ax) + arc(nu / (1 - nu), ay / r)) +
                 ay * (asinh(ax / ay) + arc(-nu, ax / r));
    return (x < 0) == (y < 0) ? sum : -sum;
}

static void corners(double nu, size_t n, double dx, double y, double *corner)
{
    for (size_t i = 0; i < n; i++) {
        corner[i] = to_corner(nu, ((double)i - 0.5) * dx, y);
    }
}

// Slip at every distance from a cell under unit traction, the grid in the corner of the transform;
// distances beyond half the transform are negative ones.
static void fill_slips(lac_compliance *c, const lac_grid *grid, double g, double nu, double *low)
{
    const double pi = 3.14159265358979323846;
    size_t mx = c->fft->nx, my = c->fft->ny, n = mx / 2 + 2;
    double *high = low + n;
    corners(nu, n, grid->dx, -0.5 * grid->dy, low);
    for (size_t j = 0; j <= my / 2; j++) {
        double *row = c->fft->real + j * mx;
        corners(nu, n, grid->dx, ((double)j + 0.5) * grid->dy, high);
        for (size_t i = 0; i <= mx / 2; i++) {
            row[i] = ((high[i + 1] - high[i]) - (low[i + 1] - low[i])) / (pi * g);
            row[(mx - i) % mx] = row[i];
        }
        memmove(c->fft->real + (my - j) % my * mx, row, mx * sizeof *row);
        memcpy(low, high, n * sizeof *low);
    }
}

// Free boundaries: uniform traction on each cell of an interface that is alone.
static lac_status fill_free(lac_compliance *c, const lac_grid *grid, double g, double nu,
                            lac_error *err)
{
    const lac_fft *fft = c->fft;
    double *low = malloc(2 * (fft->nx / 2 + 2) * sizeof *low);
    if (low == NULL) {
        return lac_fail_memory(err);
    }
    fill_slips(c, grid, g, nu, low);
    free(low);
    lac_fft_forward(c->fft);
    double cells = (double)fft->nx * (double)fft->ny;
    for (size_t i = 0; i < fft->nkx; i++) {
        for (size_t j = 0; j < fft->ny; j++) {
            c->compliance[i * fft->ny + j] = creal(fft->spectrum[j * fft->nkx + i]) / cells;
        }
    }
    return LAC_OK;
}

lac_status lac_compliance_create(const lac_domain *domain, double shear_modulus, double poisson,
                                 lac_compliance **out, lac_error *err)
{
    *out = NULL;
    const lac_grid *grid = &domain->grid;
    size_t n = domain->n;
    size_t mx = grid->periodic || grid->nx == 1 ? 1 : 2;
    size_t my = grid->periodic || grid->ny == 1 ? 1 : 2;
    lac_status status = LAC_OK;
    lac_compliance *c = calloc(1, sizeof *c);
    if (c == NULL) {
        return lac_fail_memory(err);
    }
    c->n = n;
    LAC_TRY(lac_fft_create(mx * grid->nx, my * grid->ny, &c->fft, err));
    c->at = malloc(n * sizeof *c->at);
    size_t modes = c->fft->ny * c->fft->nkx;
    c->stiffness = malloc(modes * sizeof *c->stiffness);
    c->compliance = malloc(modes * sizeof *c->compliance);
    c->vectors = malloc(4 * n * sizeof *c->vectors);
    if (c->at == NULL || c->stiffness == NULL || c->compliance == NULL || c->vectors == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    c->r = c->vectors;
    c->z = c->r + n;
    c->p = c->z + n;
    c->q = c->p + n;
    for (size_t i = 0; i < n; i++) {
        size_t x = domain->index[i] % grid->nx, y = domain->index[i] / grid->nx;
        c->at[i] = y * c->fft->nx + x;
    }
    fill_modes(c, grid, shear_modulus, poisson);
    if (!grid->periodic) {
        LAC_TRY(fill_free(c, grid, shear_modulus, poisson, err));
    }
    LAC_TRY(lac_fft_plan_filter(c->fft, grid->ny, err));
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
        free(c->compliance);
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

// y = Q R F^-1 symbol F R^T x: zeros in the gaps, restriction R, mean removed by Q.
static void filter(lac_compliance *c, const double *symbol, const double *x, double *y)
{
    lac_fft *fft = c->fft;
    memset(fft->real, 0, fft->nx * fft->rows * sizeof *fft->real);
    for (size_t i = 0; i < c->n; i++) {
        fft->real[c->at[i]] = x[i];
    }
    lac_fft_filter(fft, symbol);
    for (size_t i = 0; i < c->n; i++) {
        y[i] = fft->real[c->at[i]];
    }
    remove_mean(c->n, y);
}

// Slip under a traction.
static void comply(lac_compliance *c, const double *traction, double *slip)
{
    filter(c, c->compliance, traction, slip);
}

// The inverse on full contact; elsewhere near enough to it to precondition.
static void precondition(lac_compliance *c, const double *slip, double *traction)
{
    filter(c, c->stiffness, slip, traction);
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
