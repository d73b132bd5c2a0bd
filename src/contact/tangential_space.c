// SPDX-License-Identifier: GPL-3.0-or-later
// Elastic displacements under shear tractions by Fourier transforms: x and y act on each other.
#include "contact/tangential_solve.h"

// Wavenumbers in units of 2 pi / longest side, so that
//   u = 1/kappa [I - nu k k^T / kappa^2] tau                                          periodic
//   u_x = (I0 - nu Iyy) tau_x + nu Ixy tau_y,  u_y likewise                           free
// both in the same unit. docs/theory/tangential.md, "Operator".

typedef struct spacing {
    double dx, dy; // of cells, in units of the longest side
} spacing;

static void fill_waves(lac_shear_space *s, bool periodic, spacing d, double nu)
{
    const lac_fft *fft = s->fft[0];
    const double cells = (double)fft->nx * (double)fft->ny;
    for (size_t i = 0; i < fft->nkx; i++) {
        for (size_t j = 0; j < fft->ny; j++) {
            double qx = (double)i / (d.dx * (double)fft->nx);
            double qy = lac_fft_frequency(j, fft->ny) / (d.dy * (double)fft->ny);
            double kappa = hypot(qx, qy);
            double w = i + j > 0 ? 1.0 / kappa : 0.0;
            size_t at = j * fft->nkx + i;
            s->stiffness[i * fft->ny + j] = kappa / cells;
            if (periodic) {
                // odd in both wavenumbers: the Nyquist lines, their own mirror images, have none
                bool nyquist = 2 * i == fft->nx || 2 * j == fft->ny;
                s->xx[at] = w * (1.0 - nu * qx * qx * w * w) / cells;
                s->yy[at] = w * (1.0 - nu * qy * qy * w * w) / cells;
                s->xy[at] = nyquist ? 0.0 : -nu * qx * qy * w * w * w / cells;
            }
        }
    }
    // where the shift is given the mean counts, too: as stiff as half a wave
    s->stiffness[0] = 0.5 / cells;
}

typedef enum part { WHOLE_X, WHOLE_Y, CROSS } part;

// Antiderivatives at a corner (x, y), not 0: of 1/r less nu times its parts along y or x, and of
// the coupling x y / r^3.
static double corner(part which, double nu, double x, double y)
{
    if (which == CROSS) {
        return -nu * hypot(x, y);
    }
    double ixx = y * asinh(x / fabs(y));
    double iyy = x * asinh(y / fabs(x));
    return ixx + iyy - nu * (which == WHOLE_X ? iyy : ixx);
}

static double cell_integral(part which, double nu, spacing d, double i, double j)
{
    double x0 = (i - 0.5) * d.dx, x1 = (i + 0.5) * d.dx;
    double y0 = (j - 0.5) * d.dy, y1 = (j + 0.5) * d.dy;
    return (corner(which, nu, x1, y1) - corner(which, nu, x0, y1)) -
           (corner(which, nu, x1, y0) - corner(which, nu, x0, y0));
}

// One kernel at every distance; those beyond half the transform are negative ones.
static void fill_kernel(lac_fft *fft, part which, double nu, spacing d)
{
    const size_t mx = fft->nx, my = fft->ny;
    const double mirror = which == CROSS ? -1.0 : 1.0;
    for (size_t j = 0; j <= my / 2; j++) {
        for (size_t i = 0; i <= mx / 2; i++) {
            double k = cell_integral(which, nu, d, (double)i, (double)j);
            // half the transform away is no distance within the grid, and its own mirror image
            if (which == CROSS && (2 * i == mx || 2 * j == my || i == 0 || j == 0)) {
                k = 0.0;
            }
            size_t left = (mx - i) % mx;
            size_t down = (my - j) % my;
            fft->real[j * mx + i] = k;
            fft->real[j * mx + left] = mirror * k;
            fft->real[down * mx + i] = mirror * k;
            fft->real[down * mx + left] = k;
        }
    }
}

static void fill_free(lac_shear_space *s, part which, double nu, spacing d, double *table)
{
    lac_fft *fft = s->fft[0];
    const double cells = (double)fft->nx * (double)fft->ny;
    fill_kernel(fft, which, nu, d);
    lac_fft_forward(fft);
    for (size_t at = 0; at < fft->nkx * fft->ny; at++) {
        table[at] = creal(fft->spectrum[at]) / cells;
    }
}

static void fill_tables(lac_shear_space *s, const lac_grid *grid, double nu)
{
    spacing d = {grid->dx / s->length, grid->dy / s->length};
    fill_waves(s, grid->periodic, d, nu);
    if (!grid->periodic) {
        fill_free(s, WHOLE_X, nu, d, s->xx);
        fill_free(s, WHOLE_Y, nu, d, s->yy);
        fill_free(s, CROSS, nu, d, s->xy);
    }
}

// Of one cell; and the largest eigenvalue.
static void measure(lac_shear_space *s)
{
    const lac_fft *fft = s->fft[0];
    double self = 0.0, most = 0.0;
    for (size_t i = 0; i < fft->nkx; i++) {
        for (size_t j = 0; j < fft->ny; j++) {
            size_t at = j * fft->nkx + i;
            double xx = s->xx[at], yy = s->yy[at];
            self += (i > 0 && 2 * i < fft->nx ? 2.0 : 1.0) * 0.5 * (xx + yy);
            most = fmax(most, 0.5 * (xx + yy) + hypot(0.5 * (xx - yy), s->xy[at]));
        }
    }
    // one periodic cell: whatever moves it, it moves as a whole
    s->self = self > 0.0 ? self : 1.0;
    s->most = most * (double)fft->nx * (double)fft->ny;
}

static lac_status plan(lac_shear_space *s, bool periodic, lac_error *err)
{
    size_t mx = periodic || s->nx == 1 ? 1 : 2;
    size_t my = periodic || s->ny == 1 ? 1 : 2;
    for (int axis = 0; axis < 2; axis++) {
        LAC_TRY_RETURN(lac_fft_create(mx * s->nx, my * s->ny, &s->fft[axis], err));
        LAC_TRY_RETURN(lac_fft_plan_filter(s->fft[axis], s->ny, err));
    }
    return LAC_OK;
}

lac_status lac_shear_space_create(const lac_grid *grid, double poisson, lac_shear_space **out,
                                  lac_error *err)
{
    lac_status status;
    lac_shear_space *s = *out = calloc(1, sizeof *s);
    LAC_FAIL_MEMORY_IF(s == NULL, err);
    s->nx = grid->nx;
    s->ny = grid->ny;
    s->length = fmax((double)grid->nx * grid->dx, (double)grid->ny * grid->dy);
    LAC_TRY(plan(s, grid->periodic, err));
    size_t modes = s->fft[0]->nkx * s->fft[0]->ny;
    s->xx = malloc(4 * modes * sizeof *s->xx);
    LAC_TRY(s->xx != NULL ? LAC_OK : lac_fail_memory(err));
    s->stiffness = s->xx + modes;
    s->yy = s->stiffness + modes;
    s->xy = s->yy + modes;
    fill_tables(s, grid, poisson);
    measure(s);
out:
    LAC_MADE(status, out, lac_shear_space_free);
}

void lac_shear_space_free(lac_shear_space *s)
{
    if (s == NULL) {
        return;
    }
    free(s->xx);
    lac_fft_free(s->fft[0]);
    lac_fft_free(s->fft[1]);
    free(s);
}

// (x, y) <- [xx xy; xy yy] (x, y), of n complex numbers
static void couple(const lac_shear_space *s, size_t n, double *restrict x, double *restrict y)
{
    const double *restrict xx = s->xx;
    const double *restrict yy = s->yy;
    const double *restrict xy = s->xy;
    for (size_t k = 0; k < n; k++) {
        for (size_t c = 2 * k; c < 2 * k + 2; c++) {
            double a = x[c], b = y[c];
            x[c] = xx[k] * a + xy[k] * b;
            y[c] = xy[k] * a + yy[k] * b;
        }
    }
}

void lac_shear_space_displace(lac_shear_space *s)
{
    lac_fft_forward(s->fft[0]);
    lac_fft_forward(s->fft[1]);
    couple(s, s->fft[0]->nkx * s->fft[0]->ny, (double *)s->fft[0]->spectrum,
           (double *)s->fft[1]->spectrum);
    lac_fft_inverse(s->fft[0]);
    lac_fft_inverse(s->fft[1]);
}

void lac_shear_space_unload(lac_shear_space *s)
{
    lac_fft_filter(s->fft[0], s->stiffness);
    lac_fft_filter(s->fft[1], s->stiffness);
}

// sum of xx |x|^2 + yy |y|^2 + 2 xy Re(x conj y) over n wavenumbers of a row
static double row_energy(const lac_shear_space *s, size_t row, size_t n, const double *restrict x,
                         const double *restrict y)
{
    const double *restrict xx = &s->xx[row];
    const double *restrict yy = &s->yy[row];
    const double *restrict xy = &s->xy[row];
    double sum = 0.0;
#pragma omp simd safelen(2) reduction(+ : sum)
    for (size_t k = 0; k < n; k++) {
        double x2 = x[2 * k] * x[2 * k] + x[2 * k + 1] * x[2 * k + 1];
        double y2 = y[2 * k] * y[2 * k] + y[2 * k + 1] * y[2 * k + 1];
        double cross = x[2 * k] * y[2 * k] + x[2 * k + 1] * y[2 * k + 1];
        sum += xx[k] * x2 + yy[k] * y2 + 2.0 * xy[k] * cross;
    }
    return sum;
}

double lac_shear_space_energy(lac_shear_space *s)
{
    const lac_fft *fft = s->fft[0];
    const double *x = (const double *)s->fft[0]->spectrum;
    const double *y = (const double *)s->fft[1]->spectrum;
    const size_t last = fft->nkx - 1;
    double total = 0.0;
    lac_fft_forward(s->fft[0]);
    lac_fft_forward(s->fft[1]);
    for (size_t j = 0; j < fft->ny; j++) {
        size_t row = j * fft->nkx;
        // inner columns stand for their mirror images, too
        double sum = 2.0 * row_energy(s, row, fft->nkx, &x[2 * row], &y[2 * row]);
        sum -= row_energy(s, row, 1, &x[2 * row], &y[2 * row]);
        if (last > 0 && 2 * last == fft->nx) {
            size_t end = row + last;
            sum -= row_energy(s, end, 1, &x[2 * end], &y[2 * end]);
        }
        total += sum;
    }
    return total;
}
