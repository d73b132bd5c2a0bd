// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/half_space.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/free_slip.h"
#include "support/trees.h"

static const double pi = 3.14159265358979323846;

// Plane strain through a layer: U sin kx, W cos kx, T sin kx, N cos kx (displacements, tractions).
typedef struct layer {
    double g, lame, k;
} layer;

static void layer_rates(const layer *l, const double *s, double *rate)
{
    double stiff = l->lame + 2 * l->g;
    rate[0] = s[2] / l->g + l->k * s[1];
    rate[1] = (s[3] - l->lame * l->k * s[0]) / stiff;
    rate[2] = l->k * (stiff * l->k * s[0] + l->lame * rate[1]);
    rate[3] = -l->k * s[2];
}

static void layer_step(const layer *l, double h, double *s)
{
    double k[4][4], at[4];
    static const double part[] = {0, 0.5, 0.5, 1}, weight[] = {1, 2, 2, 1};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 4; i++) {
            at[i] = s[i] + (stage > 0 ? h * part[stage] * k[stage - 1][i] : 0);
        }
        layer_rates(l, at, k[stage]);
    }
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < 4; i++) {
            s[i] += h / 6 * weight[stage] * k[stage][i];
        }
    }
}

// From the rigid far face to the interface, whose normal traction vanishes by antisymmetry.
static double layer_stiffness(const rock_def *rock, double k)
{
    layer l = {rock->g, 2 * rock->g * rock->nu / (1 - 2 * rock->nu), k};
    double s[2][4] = {{0, 0, 1, 0}, {0, 0, 0, 1}};
    const int steps = 4000;
    for (int i = 0; i < steps; i++) {
        layer_step(&l, -rock->height / steps, s[0]);
        layer_step(&l, -rock->height / steps, s[1]);
    }
    double c = -s[0][3] / s[1][3];
    return fabs((s[0][2] + c * s[1][2]) / (s[0][0] + c * s[1][0])) / 2;
}

double wave_stiffness(const rock_def *rock, const lac_grid *grid, size_t p, size_t q)
{
    double fx = 2 * p <= grid->nx ? (double)p : (double)p - (double)grid->nx;
    double fy = 2 * q <= grid->ny ? (double)q : (double)q - (double)grid->ny;
    double kx = 2 * pi * fx / ((double)grid->nx * grid->dx);
    double ky = 2 * pi * fy / ((double)grid->ny * grid->dy);
    double k = sqrt(kx * kx + ky * ky);
    if (k == 0) {
        return isinf(rock->height) ? 0 : rock->g / (2 * rock->height);
    }
    bool slab = isfinite(rock->height) && k * rock->height < 20;
    double across = slab ? rock->g / 2 * k / tanh(k * rock->height) : rock->g / 2 * k;
    if (rock->nu == 0) {
        return across;
    }
    double along = slab ? layer_stiffness(rock, k) : rock->g / 2 * k / (1 - rock->nu);
    return (ky * ky * across + kx * kx * along) / (k * k);
}

// Slip of a cell under unit traction on another, from their distances; 1/N sum of cos(k x)/S.
static double wave_slip(const double *softness, const lac_grid *grid, double di, double dj)
{
    double sum = 0;
    size_t cells = lac_grid_cells(grid);
    for (size_t mode = 0; mode < cells; mode++) {
        double p = (double)(mode % grid->nx), q = (double)(mode / grid->nx);
        sum +=
            cos(2 * pi * (p * di / (double)grid->nx + q * dj / (double)grid->ny)) * softness[mode];
    }
    return sum / (double)cells;
}

// -2 (1 - nu)/(pi g) times the integral of ln|x - s| over the cell, by midpoints off the cell
static double line_slip(const rock_def *rock, double dx, double x)
{
    double sum = 2 * (0.5 * dx * log(0.5 * dx) - 0.5 * dx);
    const int parts = 20000;
    for (int i = 0; i < parts && x != 0; i++) {
        sum = i == 0 ? 0 : sum;
        sum += log(fabs(x + dx * ((i + 0.5) / parts - 0.5))) * dx / parts;
    }
    return -2 * (1 - rock->nu) / (pi * rock->g) * sum;
}

static double *softness_of(const rock_def *rock, const lac_grid *grid)
{
    double *softness = new_doubles(lac_grid_cells(grid));
    for (size_t mode = 0; mode < lac_grid_cells(grid); mode++) {
        double s = wave_stiffness(rock, grid, mode % grid->nx, mode / grid->nx);
        softness[mode] = s > 0 ? 1 / s : 0;
    }
    return softness;
}

static double slip_between(const rock_def *rock, const lac_grid *grid, const double *softness,
                           double di, double dj)
{
    if (grid->periodic) {
        return wave_slip(softness, grid, di, dj);
    }
    return rock->line
               ? line_slip(rock, grid->dx, di * grid->dx)
               : free_slip(rock->g, rock->nu, grid->dx, grid->dy, di * grid->dx, dj * grid->dy);
}

static void fill_slips(const rock_def *rock, const lac_domain *domain, size_t m, long double *c)
{
    const lac_grid *grid = &domain->grid;
    double *softness = softness_of(rock, grid);
    double *known = new_doubles(4 * lac_grid_cells(grid)),
           *is = new_doubles(4 * lac_grid_cells(grid));
    for (size_t i = 0; i < domain->n; i++) {
        for (size_t j = 0; j < domain->n; j++) {
            size_t a = domain->index[i], b = domain->index[j];
            size_t di = a % grid->nx + grid->nx - b % grid->nx;
            size_t dj = a / grid->nx + grid->ny - b / grid->nx;
            size_t at = dj * 2 * grid->nx + di;
            if (is[at] == 0) {
                known[at] = slip_between(rock, grid, softness, (double)di - (double)grid->nx,
                                         (double)dj - (double)grid->ny);
                is[at] = 1;
            }
            c[i * m + j] = known[at];
        }
    }
    free(softness);
    free(known);
    free(is);
}

void dense_elastic(const rock_def *rock, const lac_domain *domain, double *dense)
{
    // C bordered by the zero net force; column j of K is the solution for the j-th unit slip.
    bool floating = isinf(rock->height);
    size_t n = domain->n, m = floating ? n + 1 : n;
    long double *c = calloc(m * m, sizeof *c), *a = calloc(m * m, sizeof *a);
    long double *x = calloc(m, sizeof *x);
    if (c == NULL || a == NULL || x == NULL) {
        abort();
    }
    fill_slips(rock, domain, m, c);
    for (size_t i = 0; floating && i < n; i++) {
        c[i * m + n] = c[n * m + i] = 1;
    }
    for (size_t j = 0; j < n; j++) {
        memcpy(a, c, m * m * sizeof *a);
        memset(x, 0, m * sizeof *x);
        x[j] = 1;
        dense_solve(m, a, x);
        for (size_t i = 0; i < n; i++) {
            dense[i * n + j] = (double)x[i];
        }
    }
    free(c);
    free(a);
    free(x);
}

// The traction at a point from unit slip of a unit area at distance r, angle phi, is this over r^3.
static double point_traction(const rock_def *rock, double phi)
{
    double c = cos(phi), s = sin(phi);
    double along = 3 * c * c - 1, across = 3 * s * s - 1;
    return -rock->g / (4 * pi) * (across + along / (1 - rock->nu));
}

// Uniform slip everywhere costs nothing: a cell holds against itself what all others would not.
static double own_traction(const rock_def *rock, double dx, double dy)
{
    const int directions = 40000;
    double sum = 0;
    for (int i = 0; i < directions; i++) {
        double phi = 2 * pi * (i + 0.5) / directions;
        double border = fmin(0.5 * dx / fabs(cos(phi)), 0.5 * dy / fabs(sin(phi)));
        sum -= point_traction(rock, phi) / border * 2 * pi / directions;
    }
    return sum;
}

double held_traction(const rock_def *rock, double dx, double dy, double x, double y)
{
    const int parts = dy > 0 ? 200 : 20000;
    double sum = 0;
    if (dy == 0) {
        double scale = rock->g / (2 * pi * (1 - rock->nu));
        for (int i = 0; i < parts && x != 0; i++) {
            sum -= scale * dx / parts / pow(x + dx * ((i + 0.5) / parts - 0.5), 2);
        }
        return x != 0 ? sum : scale * 2 / (0.5 * dx); // 2 int of scale/x^2 from dx/2 on
    }
    if (x == 0 && y == 0) {
        return own_traction(rock, dx, dy);
    }
    for (int i = 0; i < parts * parts; i++) {
        double px = x + dx * ((i % parts + 0.5) / parts - 0.5);
        double py = y + dy * ((i / parts + 0.5) / parts - 0.5);
        sum += point_traction(rock, atan2(py, px)) / pow(hypot(px, py), 3);
    }
    return sum * dx * dy / parts / parts;
}

// Okada's components 1 and 3 at a corner of a vertical fault, without U/(2 pi): the displacements
// along the fault and, with the opposite sign, across it.
// @param q     distance from the fault, 0 of the real source: its sign is minus
static void okada_at(double nu, double x, double y, double q, double z, bool image, double u[2])
{
    const double a = 1 / (2 * (1 - nu)), k = (1 - a) / a, r = sqrt(x * x + y * y + q * q),
                 s = r + y;
    const double y11 = 1 / (r * s), angle = atan(x * y / (q * r));
    u[0] = angle / 2 + a / 2 * x * q * y11;
    u[1] = (1 - a) / 2 * log(s) - a / 2 * q * q * y11;
    if (!image) {
        u[0] = -u[0];
        u[1] = -u[1];
        return;
    }
    const double i4 = x * q / (s * s) / 2, i3 = (y / s + q * q / (s * s) - log(s)) / 2;
    const double z32 = 1 / pow(r, 3) + z * (2 * r + y) / (pow(r, 3) * s * s);
    u[0] += -x * q * y11 - angle + k * i4 - z * a * x * q * z32;
    u[1] +=
        q * q * y11 - k * (log(s) + i3) - z * a * ((y + z) * y / pow(r, 3) - z * y11 + x * x * z32);
}

// Of a rectangle from 0 to dx along strike and from `top` down by dy.
static void okada(double nu, double dx, double dy, double x, double q, double depth, double top,
                  double u[2])
{
    u[0] = u[1] = 0;
    for (int k = 0; k < 8; k++) {
        const double at = k & 1 ? x - dx : x, edge = k & 2 ? top : top + dy;
        const bool image = (k & 4) != 0;
        const double sign = ((k & 1) != 0) == ((k & 2) != 0) ? 1 : -1;
        double corner[2];
        okada_at(nu, at, image ? edge + depth : edge - depth, q, -depth, image, corner);
        u[0] += sign * corner[0];
        u[1] += sign * corner[1];
    }
}

// At a depth, x apart from a cell whose upper side is at `top`.
static double held_below_surface(const rock_def *rock, double dx, double dy, double x, double depth,
                                 double top)
{
    const double h = 1e-3 * fmin(dx, dy), on = 1e-10 * dx;
    double u[3][2], left[2], right[2];
    x += dx / 2;
    for (int k = 0; k < 3; k++) {
        okada(rock->nu, dx, dy, x, k == 0 ? on : k * h, depth, top, u[k]);
    }
    okada(rock->nu, dx, dy, x - h, on, depth, top, left);
    okada(rock->nu, dx, dy, x + h, on, depth, top, right);
    const double across = (-3 * u[0][0] + 4 * u[1][0] - u[2][0]) / (2 * h);
    return rock->g / (2 * 3.14159265358979323846) * (across - (right[1] - left[1]) / (2 * h));
}

double traction_below_surface(const rock_def *rock, const lac_grid *grid, size_t a, size_t b)
{
    if (rock->line) {
        const double x = ((double)a - (double)b) * grid->dx,
                     image = ((double)(a + b) + 1) * grid->dx;
        return held_traction(rock, grid->dx, 0, x, 0) + held_traction(rock, grid->dx, 0, image, 0);
    }
    const double x = ((double)(a % grid->nx) - (double)(b % grid->nx)) * grid->dx;
    const double at = (double)(a / grid->nx) * grid->dy, other = (double)(b / grid->nx) * grid->dy;
    return (held_below_surface(rock, grid->dx, grid->dy, x, at + grid->dy / 2, other) +
            held_below_surface(rock, grid->dx, grid->dy, x, other + grid->dy / 2, at)) /
           2;
}
