// SPDX-License-Identifier: GPL-3.0-or-later
// What slip or traction of a wave, or of a single cell, does to elastic rock, in closed form.
#include "transfer/compliance.h"

// What a slab adds to the stiffness of a half-space under a wave with q = |k| H. Beyond q = 30 the
// factors are 1 to the last bit, and cosh need not be computed.
static const double deep = 30;

static double slab_antiplane(double q) { return q > deep ? 1 : 1 / tanh(q); }

// In plane strain, the far face rigid and the near one free to open: equation 10a.
static double slab_in_plane(double nu, double q)
{
    if (q > deep) {
        return 1;
    }
    double c = 3 - 4 * nu;
    double rest = 2 * q * q + 5 + nu * (8 * nu - 12);
    return (c * cosh(2 * q) + rest) / (c * sinh(2 * q) + 2 * q);
}

// Stiffness of a wave of slip along x, with its traction along x held in mind:
// S = G/2 (ky^2 + kx^2/(1-nu))/|k|; on slabs docs/theory/transfer.md, equation 10a. [Pa/m]; at k =
// 0 that of the slabs, 0 for half-spaces.
static double wave_stiffness(const lac_rock *rock, double kx, double ky)
{
    double k = hypot(kx, ky);
    if (!(k > 0)) {
        return rock->shear_modulus / (2 * rock->thickness);
    }
    double q = k * rock->thickness, nu = rock->poisson;
    if (rock->antiplane) {
        return rock->shear_modulus / 2 * k * slab_antiplane(q);
    }
    if (rock->across) {
        double along_slip = ky;
        ky = kx;
        kx = along_slip;
    }
    double across = ky * (ky / k), along = kx * (kx / k) / (1 - nu);
    return rock->shear_modulus / 2 * (across * slab_antiplane(q) + along * slab_in_plane(nu, q));
}

// Traction along y under slip along x, S = G/2 (1/(1-nu) - 1) kx ky/|k|: odd in each, so that the
// shortest wave, which stands for both signs, has none.
static double cross_stiffness(const lac_rock *rock, double kx, double ky)
{
    double k = hypot(kx, ky);
    if (!(k > 0)) {
        return 0;
    }
    double q = k * rock->thickness, nu = rock->poisson;
    double apart = slab_in_plane(nu, q) / (1 - nu) - slab_antiplane(q);
    return rock->shear_modulus / 2 * kx * (ky / k) * apart;
}

static void fill_waves(const lac_fft *fft, const lac_grid *grid, const lac_rock *rock,
                       double *stiffness, double *compliance)
{
    double cells = (double)fft->nx * (double)fft->ny;
    for (size_t j = 0; j < fft->ny; j++) {
        double ky = 2 * M_PI * lac_fft_frequency(j, fft->ny) / ((double)fft->ny * grid->dy);
        for (size_t k = 0; k < fft->columns.n; k++) {
            const size_t i = fft->columns.first + k;
            double kx = 2 * M_PI * (double)i / ((double)fft->nx * grid->dx);
            bool shortest = 2 * i == fft->nx || 2 * j == fft->ny;
            double s = !rock->cross ? wave_stiffness(rock, kx, ky)
                       : shortest   ? 0
                                    : cross_stiffness(rock, kx, ky);
            stiffness[k * fft->ny + j] = s / cells;
            compliance[k * fft->ny + j] = s > 0 ? 1 / (s * cells) : 0;
        }
    }
}

// sqrt(q) atan(sqrt(q) s), which goes on smoothly to q < 0
static double arc(double q, double s)
{
    double root = sqrt(fabs(q));
    return q < 0 ? -root * atanh(root * s) : root * atan(root * s);
}

// A double primitive of what a point does, at the corner (x, y) of a cell, neither 0.
typedef double corner_function(double nu, double x, double y);

// Slip under traction: the integral of r/(x^2 + y^2/(1 - nu)) from the origin to a corner;
// docs/theory/transfer.md, equation 12b.
static double slip_to_corner(double nu, double x, double y)
{
    double ax = fabs(x), ay = fabs(y), r = hypot(x, y);
    double sum = (1 - nu) * ax * (asinh(ay / ax) + arc(nu / (1 - nu), ay / r)) +
                 ay * (asinh(ax / ay) + arc(-nu, ax / r));
    return (x < 0) == (y < 0) ? sum : -sum;
}

// The same under slip along y.
static double slip_across(double nu, double x, double y) { return slip_to_corner(nu, y, x); }

// Traction under slip, equation 12d.
static double traction_to_corner(double nu, double x, double y)
{
    return (x / y + y / (x * (1 - nu))) / (4 * hypot(x, y));
}

static double traction_across(double nu, double x, double y)
{
    return traction_to_corner(nu, y, x);
}

// The same on a line, equations 12c and 12d; constants of the slip are free.
static double line_slip(double nu, double x) { return -2 * (1 - nu) * x * log(fabs(x)); }

static double line_traction(double nu, double x) { return 1 / (2 * (1 - nu) * x); }

static void corners(corner_function *f, double nu, size_t n, double dx, double y, double *corner)
{
    for (size_t i = 0; i < n; i++) {
        corner[i] = f(nu, ((double)i - 0.5) * dx, y);
    }
}

// What a cell does at every distance, the grid in the corner of the transform; distances beyond
// half the transform are negative ones: of the rows here. @param low  [2 (nx/2 + 2)] scratch
static void fill_plane(lac_fft *fft, const lac_grid *grid, corner_function *f, double nu,
                       double scale, double *low)
{
    size_t mx = fft->nx, my = fft->ny, n = mx / 2 + 2, first = fft->strip.first;
    double *high = low + n, *row = fft->real;
    for (size_t j = first; j < first + fft->strip.n; j++, row += mx) {
        const size_t near = 2 * j <= my ? j : my - j;
        if (near < j && near >= first) {
            memcpy(row, fft->real + (near - first) * mx, mx * sizeof *row);
            continue;
        }
        if (j == first || near < j) {
            corners(f, nu, n, grid->dx, ((double)near - 0.5) * grid->dy, low);
        }
        corners(f, nu, n, grid->dx, ((double)near + 0.5) * grid->dy, high);
        for (size_t i = 0; i <= mx / 2; i++) {
            row[i] = ((high[i + 1] - high[i]) - (low[i + 1] - low[i])) * scale;
            row[(mx - i) % mx] = row[i];
        }
        memcpy(low, high, n * sizeof *low);
    }
}

static void fill_line(lac_fft *fft, double dx, double (*f)(double, double), double nu, double scale)
{
    size_t mx = fft->nx;
    for (size_t i = 0; i <= mx / 2; i++) {
        double at = (double)i;
        fft->real[i] = (f(nu, (at + 0.5) * dx) - f(nu, (at - 0.5) * dx)) * scale;
        fft->real[(mx - i) % mx] = fft->real[i];
    }
}

// A line and its mirror image: the transform is of twice the length, of which it holds a half, so
// that the farthest image lies within.
static lac_status fill_mirrored(const lac_fft *fft, double dx, double scale, double *table,
                                lac_error *err)
{
    const size_t n = fft->nx + 1;
    double *half = malloc(n * sizeof *half);
    LAC_FAIL_MEMORY_IF(half == NULL, err);
    for (size_t i = 0; i < n; i++) {
        double at = (double)i;
        half[i] = (line_traction(0, (at + 0.5) * dx) - line_traction(0, (at - 0.5) * dx)) * scale;
    }
    const lac_status status = lac_fft_even(1, n, half, err);
    for (size_t i = 0; status == LAC_OK && i < fft->nx; i++) {
        table[i] = half[i] / (2 * (double)fft->nx);
    }
    free(half);
    return status;
}

// What a surface adds to the traction under slip along it of a rectangle across it: the derivatives
// on the fault of Okada's (1992) displacements, image and rest, at a depth.
// @param y  the corner's depth and the place's together
static double surface_to_corner(double nu, double x, double y, double depth)
{
    double alpha = 1 / (2 * (1 - nu)), r = hypot(x, y), s = r + y, r3 = r * r * r, s2 = s * s;
    double y32 = (2 * r + y) / (r3 * s2);
    double y53 = (8 * r * r + 9 * r * y + 3 * y * y) / (r3 * r * r * s2 * s);
    double shallow = r / (2 * x * y) + (alpha - 1.5) * x / (r * s) + (1 - 2 * nu) * x / s2;
    double rest = depth * (2 * y32 - 3 * y / (r3 * r * r) - x * x * y53) + 2 / r3;
    return (shallow + depth * alpha * x * rest) / 2;
}

// At the depth of row i under slip of a cell in row j: at all distances along x.
static void fill_depth(const lac_grid *grid, double nu, double scale, size_t i, size_t j, size_t n,
                       double *out)
{
    const double dy = grid->dy, depth = ((double)i + 0.5) * dy;
    double last = 0;
    for (size_t k = 0; k <= n; k++) {
        const double x = ((double)k - 0.5) * grid->dx, y = (double)j * dy - depth;
        const double at = traction_to_corner(nu, x, y + dy) - traction_to_corner(nu, x, y) +
                          surface_to_corner(nu, x, y + dy + 2 * depth, depth) -
                          surface_to_corner(nu, x, y + 2 * depth, depth);
        if (k > 0) {
            out[k - 1] += (at - last) * scale;
        }
        last = at;
    }
}

// Below a surface: a matrix of rows for each wave along x, the mean of either way between two rows.
static lac_status fill_depths(const lac_fft *fft, const lac_grid *grid, const lac_rock *rock,
                              double *table, lac_error *err)
{
    const size_t n = fft->nkx, rows = grid->ny;
    const double scale = rock->shear_modulus / M_PI / (2 * (double)fft->nx);
    double *half = malloc(n * sizeof *half);
    LAC_FAIL_MEMORY_IF(half == NULL, err);
    lac_status status = LAC_OK;
    for (size_t pair = 0; pair < rows * rows && status == LAC_OK; pair++) {
        const size_t i = pair / rows, j = pair % rows;
        if (i > j) {
            continue;
        }
        memset(half, 0, n * sizeof *half);
        fill_depth(grid, rock->poisson, scale, i, j, n, half);
        fill_depth(grid, rock->poisson, scale, j, i, n, half);
        status = lac_fft_even(1, n, half, err);
        for (size_t k = 0; k < n; k++) {
            table[(k * rows + i) * rows + j] = table[(k * rows + j) * rows + i] = half[k];
        }
    }
    free(half);
    return status;
}

// Free boundaries: an interface that is alone.
// @param fft  of the whole transform: shared by ranks, its rows here
static void fill_alone(lac_fft *fft, const lac_grid *grid, const lac_rock *rock, double *low,
                       double *stiffness, double *compliance)
{
    // Slip across a line is antiplane.
    double g = rock->shear_modulus, nu = rock->across && rock->line ? 0 : rock->poisson;
    if (rock->line) {
        // Lengths in cells: the logarithm of a unit would only add a constant.
        fill_line(fft, 1, line_slip, nu, grid->dx / (M_PI * g));
    } else {
        fill_plane(fft, grid, rock->across ? slip_across : slip_to_corner, nu, 1 / (M_PI * g), low);
    }
    lac_fft_table(fft, compliance);
    if (rock->creeping && rock->line) {
        fill_line(fft, grid->dx, line_traction, nu, g / M_PI);
        lac_fft_table(fft, stiffness);
    } else if (rock->creeping) {
        fill_plane(fft, grid, rock->across ? traction_across : traction_to_corner, nu, g / M_PI,
                   low);
        lac_fft_table(fft, stiffness);
    }
}

static lac_status transform_alone(lac_fft *fft, const lac_grid *grid, const lac_rock *rock,
                                  double *stiffness, double *compliance, lac_error *err)
{
    lac_status status = LAC_OK;
    lac_fft *whole = NULL;
    double *low = malloc(2 * (fft->nx / 2 + 2) * sizeof *low);
    LAC_FAIL_MEMORY_IF(low == NULL, err);
    if (fft->shared != NULL) {
        LAC_TRY(lac_fft_share(fft->nx, fft->ny, fft->strip.team, &whole, err));
    }
    fill_alone(whole != NULL ? whole : fft, grid, rock, low, stiffness, compliance);
out:
    lac_fft_free(whole);
    free(low);
    return status;
}

lac_status lac_kernels_fill(lac_fft *fft, const lac_grid *grid, const lac_rock *rock,
                            double *stiffness, double *compliance, lac_error *err)
{
    if (rock->surface) {
        memset(compliance, 0, fft->nkx * fft->ny * sizeof *compliance);
        return rock->line ? fill_mirrored(fft, grid->dx, rock->shear_modulus / M_PI, stiffness, err)
                          : fill_depths(fft, grid, rock, stiffness, err);
    }
    fill_waves(fft, grid, rock, stiffness, compliance);
    return grid->periodic ? LAC_OK : transform_alone(fft, grid, rock, stiffness, compliance, err);
}
