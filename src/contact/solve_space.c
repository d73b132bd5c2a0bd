// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "contact/solve.h"

// kappa / N; periodic: and its inverse, the compliance, which the mean has none of
static void fill_tables(lac_half_space *s, const lac_extent *extent)
{
    const lac_fft *fft = s->fft;
    double cells = (double)fft->nx * (double)fft->ny;
    double dqx = extent->dqx * (double)s->nx / (double)fft->nx;
    double dqy = extent->dqy * (double)s->ny / (double)fft->ny;
    double self = 0.0;
    for (size_t i = 0; i < fft->nkx; i++) {
        double qx = (double)i * dqx;
        for (size_t j = 0; j < fft->ny; j++) {
            double qy = lac_fft_frequency(j, fft->ny) * dqy;
            double kappa = hypot(qx, qy);
            double compliance = i + j > 0 ? 1.0 / (kappa * cells) : 0.0;
            s->compliance[i * fft->ny + j] = compliance;
            s->stiffness[i * fft->ny + j] = kappa / cells;
            self += (i > 0 && 2 * i < fft->nx ? 2.0 : 1.0) * compliance;
        }
    }
    s->self = self;
}

// The integral of 1/r from the origin to a corner (x, y), odd in both; x, y not 0.
static double love(double x, double y) { return x * asinh(y / fabs(x)) + y * asinh(x / fabs(y)); }

// love at the corners (i - 1/2, j - 1/2) of the cells of one row; n + 2 of them
static void love_corners(size_t n, double dx, double y, double *corner)
{
    for (size_t i = 0; i < n + 2; i++) {
        corner[i] = love(((double)i - 0.5) * dx, y);
    }
}

// u at every distance from a cell under unit pressure, that is the integral of 1/r over a cell at
// that distance; distances beyond half the transform are negative ones.
static void fill_kernel(lac_half_space *s, double dx, double dy, double *low, double *high)
{
    size_t mx = s->fft->nx;
    size_t my = s->fft->ny;
    double *real = s->fft->real;
    love_corners(mx / 2, dx, -0.5 * dy, low);
    for (size_t j = 0; j <= my / 2; j++) {
        double *row = &real[j * mx];
        love_corners(mx / 2, dx, ((double)j + 0.5) * dy, high);
        for (size_t i = 0; i <= mx / 2; i++) {
            row[i] = (high[i + 1] - high[i]) - (low[i + 1] - low[i]);
            row[(mx - i) % mx] = row[i];
        }
        memmove(&real[(my - j) % my * mx], row, mx * sizeof *row);
        memcpy(low, high, (mx / 2 + 2) * sizeof *low);
    }
}

// Free boundaries: Love's solution for a uniform pressure on each cell.
static lac_status fill_free(lac_half_space *s, const lac_extent *extent, lac_error *err)
{
    const lac_fft *fft = s->fft;
    size_t corners = fft->nx / 2 + 2;
    double *low = malloc(2 * corners * sizeof *low);
    if (low == NULL) {
        return lac_fail_memory(err);
    }
    fill_kernel(s, 1.0 / (extent->dqx * (double)s->nx), 1.0 / (extent->dqy * (double)s->ny), low,
                low + corners);
    free(low);
    s->self = fft->real[0];
    lac_fft_forward(s->fft);
    double cells = (double)fft->nx * (double)fft->ny;
    for (size_t i = 0; i < fft->nkx; i++) {
        for (size_t j = 0; j < fft->ny; j++) {
            s->compliance[i * fft->ny + j] = creal(fft->spectrum[j * fft->nkx + i]) / cells;
        }
    }
    return LAC_OK;
}

lac_status lac_half_space_create(const lac_extent *extent, lac_half_space **out, lac_error *err)
{
    lac_status status;
    lac_half_space *s = calloc(1, sizeof *s);
    *out = NULL;
    if (s == NULL) {
        return lac_fail_memory(err);
    }
    s->nx = extent->nx;
    s->ny = extent->ny;
    size_t mx = extent->periodic || s->nx == 1 ? 1 : 2;
    size_t my = extent->periodic || s->ny == 1 ? 1 : 2;
    LAC_TRY(lac_fft_create(mx * s->nx, my * s->ny, &s->fft, err));
    size_t modes = s->fft->nkx * s->fft->ny;
    s->compliance = malloc(modes * sizeof(double));
    s->stiffness = malloc(modes * sizeof(double));
    if (s->compliance == NULL || s->stiffness == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    fill_tables(s, extent);
    if (!extent->periodic) {
        LAC_TRY(fill_free(s, extent, err));
    }
    LAC_TRY(lac_fft_plan_filter(s->fft, s->ny, err));
    *out = s;
    return LAC_OK;
out:
    lac_half_space_free(s);
    return status;
}

void lac_half_space_free(lac_half_space *s)
{
    if (s == NULL) {
        return;
    }
    free(s->compliance);
    free(s->stiffness);
    lac_fft_free(s->fft);
    free(s);
}

// Nothing presses beyond a free grid; rows below it are not read.
static void clear_padding(const lac_half_space *s)
{
    const lac_fft *fft = s->fft;
    for (size_t j = 0; j < s->ny && fft->nx > s->nx; j++) {
        memset(&fft->real[j * fft->nx + s->nx], 0, (fft->nx - s->nx) * sizeof(double));
    }
}

void lac_half_space_displace(lac_half_space *s)
{
    clear_padding(s);
    lac_fft_filter(s->fft, s->compliance);
}

void lac_half_space_unload(lac_half_space *s)
{
    clear_padding(s);
    lac_fft_filter(s->fft, s->stiffness);
}

double lac_half_space_energy(lac_half_space *s)
{
    clear_padding(s);
    return lac_fft_power(s->fft, s->compliance);
}
