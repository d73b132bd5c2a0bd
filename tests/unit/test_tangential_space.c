// SPDX-License-Identifier: GPL-3.0-or-later
#include <stdlib.h>
#include <string.h>

#include <math.h>

#include "contact/tangential_solve.h"
#include "support/test.h"

enum { MOST = 64 };

static const double pi = 3.14159265358979323846;

// Displacements of all cells of a small grid by tractions, all x first, then all y
static void displace(lac_shear_space *s, const double *tau, double *u)
{
    const size_t n = s->nx * s->ny;
    for (size_t axis = 0; axis < 2; axis++) {
        lac_fft *fft = s->fft[axis];
        memset(fft->real, 0, fft->nx * fft->ny * sizeof(double));
        for (size_t i = 0; i < n; i++) {
            fft->real[i / s->nx * fft->nx + i % s->nx] = tau[axis * n + i];
        }
    }
    lac_shear_space_displace(s);
    for (size_t k = 0; k < 2 * n; k++) {
        const lac_fft *fft = s->fft[k / n];
        size_t i = k % n;
        u[k] = fft->real[i / s->nx * fft->nx + i % s->nx];
    }
}

static double energy(lac_shear_space *s, const double *tau)
{
    const size_t n = s->nx * s->ny;
    for (size_t axis = 0; axis < 2; axis++) {
        lac_fft *fft = s->fft[axis];
        memset(fft->real, 0, fft->nx * fft->ny * sizeof(double));
        for (size_t i = 0; i < n; i++) {
            fft->real[i / s->nx * fft->nx + i % s->nx] = tau[axis * n + i];
        }
    }
    return lac_shear_space_energy(s);
}

static lac_shear_space *create(const lac_grid *grid, double nu)
{
    lac_shear_space *s = NULL;
    assert_int_equal(lac_shear_space_create(grid, nu, &s, NULL), LAC_OK);
    return s;
}

static void fill(double *x, size_t n, uint64_t seed)
{
    for (size_t i = 0; i < n; i++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        x[i] = (double)(seed >> 11) / 9007199254740992.0 - 0.5;
    }
}

static double dot(const double *x, const double *y, size_t n)
{
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

// Cerruti's point load (Johnson 1985, section 3.2): pi (1-nu) E* u_x = (1-nu)/r + nu x^2/r^3 for a
// force along x, nu x y / r^3 for one along y; midpoints over a cell.
static void cerruti(double nu, double x, double y, const double d[2], double k[3])
{
    enum { PARTS = 40 };
    k[0] = k[1] = k[2] = 0.0;
    const double da = d[0] * d[1] / (PARTS * PARTS);
    for (int j = 0; j < PARTS; j++) {
        for (int i = 0; i < PARTS; i++) {
            double px = x + d[0] * ((i + 0.5) / PARTS - 0.5);
            double py = y + d[1] * ((j + 0.5) / PARTS - 0.5);
            double r = hypot(px, py);
            k[0] += da * ((1.0 - nu) / r + nu * px * px / (r * r * r));
            k[1] += da * ((1.0 - nu) / r + nu * py * py / (r * r * r));
            k[2] += da * nu * px * py / (r * r * r);
        }
    }
}

// One cell pulls; everywhere else its displacements are those of point loads spread over it.
static void free_at(size_t nx, size_t ny, double dx, double dy, double nu)
{
    const lac_grid grid = {nx, ny, dx, dy, false};
    const size_t n = nx * ny;
    lac_shear_space *s = create(&grid, nu);
    const double length = fmax((double)nx * dx, (double)ny * dy);
    const double d[2] = {dx / length, dy / length};
    const size_t from = (ny / 2) * nx + nx / 2;
    for (size_t axis = 0; axis < 2; axis++) {
        double tau[2 * MOST] = {0.0};
        double u[2 * MOST];
        tau[axis * n + from] = 1.0;
        displace(s, tau, u);
        for (size_t i = 0; i < n; i++) {
            double k[3];
            double x = ((double)(i % nx) - (double)(from % nx)) * d[0];
            double y = ((double)(i / nx) - (double)(from / nx)) * d[1];
            cerruti(nu, x, y, d, k);
            double near = i == from ? 0.05 : 1e-3; // midpoints miss some of the singularity
            assert_true(fabs(u[axis * n + i] - k[axis]) < near * k[axis]);
            assert_true(fabs(u[(1 - axis) * n + i] - k[2]) < 1e-3 * k[axis]);
        }
    }
    lac_shear_space_free(s);
}

static void free_operator(void **state)
{
    (void)state;
    free_at(8, 8, 1.0, 1.0, 0.0);
    free_at(8, 8, 1.0, 1.0, 0.3);
    free_at(6, 9, 0.5, 2.0, 0.5);
    free_at(1, 12, 1.0, 0.25, 0.4);
    free_at(12, 1, 1.0, 0.25, 0.4);
}

// A square cell by itself: the integral of 1/r over it is 4 side asinh(1), half of it along x
static void one_cell(void **state)
{
    (void)state;
    for (double nu = 0.0; nu <= 0.5; nu += 0.25) {
        const lac_grid grid = {1, 1, 3.0, 3.0, false};
        lac_shear_space *s = create(&grid, nu);
        double tau[2] = {1.0, -2.0};
        double u[2];
        displace(s, tau, u);
        double self = 4.0 * asinh(1.0) * (1.0 - 0.5 * nu);
        assert_true(fabs(u[0] - self) < 1e-14);
        assert_true(fabs(u[1] + 2.0 * self) < 1e-14);
        lac_shear_space_free(s);
    }
}

// u = sum over wavenumbers of 1/kappa [I - nu k k^T / kappa^2] tau, by its definition
static void periodic_at(size_t nx, size_t ny, double dx, double dy, double nu)
{
    const lac_grid grid = {nx, ny, dx, dy, true};
    const size_t n = nx * ny;
    const double length = fmax((double)nx * dx, (double)ny * dy);
    lac_shear_space *s = create(&grid, nu);
    double tau[2 * MOST];
    double u[2 * MOST];
    double v[2 * MOST] = {0.0};
    fill(tau, 2 * n, 7);
    displace(s, tau, u);
    for (size_t m = 1; m < n; m++) {
        double kx = lac_fft_frequency(m % nx, nx);
        double ky = lac_fft_frequency(m / nx, ny);
        bool nyquist = 2 * (m % nx) == nx || 2 * (m / nx) == ny;
        double qx = kx * length / ((double)nx * dx);
        double qy = ky * length / ((double)ny * dy);
        double kappa = hypot(qx, qy);
        double xy = nyquist ? 0.0 : -nu * qx * qy / (kappa * kappa);
        for (size_t i = 0; i < n * n; i++) {
            double ax = kx * ((double)(i / n % nx) - (double)(i % n % nx)) / (double)nx;
            double ay = ky * ((double)(i / n / nx) - (double)(i % n / nx)) / (double)ny;
            double wave = cos(2.0 * pi * (ax + ay)) / (kappa * (double)n);
            double tx = tau[i % n];
            double ty = tau[n + i % n];
            v[i / n] += wave * ((1.0 - nu * qx * qx / (kappa * kappa)) * tx + xy * ty);
            v[n + i / n] += wave * ((1.0 - nu * qy * qy / (kappa * kappa)) * ty + xy * tx);
        }
    }
    for (size_t k = 0; k < 2 * n; k++) {
        assert_true(fabs(u[k] - v[k]) < 1e-13);
    }
    lac_shear_space_free(s);
}

static void periodic_operator(void **state)
{
    (void)state;
    periodic_at(8, 8, 1.0, 1.0, 0.0);
    periodic_at(8, 8, 1.0, 1.0, 0.35);
    periodic_at(6, 5, 2.0, 0.5, 0.5);
    periodic_at(1, 9, 1.0, 1.0, 0.2);
    periodic_at(16, 1, 1.0, 1.0, 0.2);
}

// x.Cy = y.Cx, x.Cx >= 0, and x.Cx by Parseval's theorem the same
static void symmetric_at(bool periodic, size_t nx, size_t ny, double nu)
{
    const lac_grid grid = {nx, ny, 1.0, 0.75, periodic};
    const size_t n = 2 * nx * ny;
    lac_shear_space *s = create(&grid, nu);
    double x[2 * MOST];
    double y[2 * MOST];
    double cx[2 * MOST];
    double cy[2 * MOST];
    for (uint64_t seed = 1; seed < 20; seed++) {
        fill(x, n, seed);
        fill(y, n, seed + 1000);
        displace(s, x, cx);
        displace(s, y, cy);
        double xcx = dot(x, cx, n);
        assert_true(fabs(dot(x, cy, n) - dot(y, cx, n)) < 1e-13);
        assert_true(xcx > 0.0);
        assert_true(xcx <= s->most * dot(x, x, n) * (1.0 + 1e-12));
        assert_true(fabs(energy(s, x) - xcx) < 1e-13 * xcx);
    }
    lac_shear_space_free(s);
}

static void symmetric_and_positive(void **state)
{
    (void)state;
    const double ratios[] = {0.0, 0.25, 0.5};
    for (int k = 0; k < 3; k++) {
        symmetric_at(false, 8, 8, ratios[k]);
        symmetric_at(true, 8, 8, ratios[k]);
        symmetric_at(false, 7, 3, ratios[k]);
        symmetric_at(true, 5, 6, ratios[k]);
        symmetric_at(true, 9, 7, ratios[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_operator),
        cmocka_unit_test(one_cell),
        cmocka_unit_test(periodic_operator),
        cmocka_unit_test(symmetric_and_positive),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
