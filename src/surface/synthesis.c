// SPDX-License-Identifier: GPL-3.0-or-later
// Heights from a spectrum, and what becomes of waves too short for the grid.
#include "surface/synthesis.h"

#include <math.h>

const char *const lac_sampling_words[] = {"low-pass", "point", "block-mean", NULL};

// Waves of a band that are summed one by one.
static const double most_waves = 1e9;

typedef double _Complex (*mode_function)(const void *of, double kx, double ky);

// Folds all waves of a band onto the wavenumbers of a grid.
typedef struct folding {
    mode_function mode;
    const void *of;
    double nx, ny;           // cells
    double kx_last, ky_last; // of the band
    bool mean;               // over the cell; else at its node
} folding;

// The grid after which a surface repeats: that of the interface and its margin.
static lac_status find_whole(const lac_synthesis *how, const lac_grid *grid, lac_grid *whole,
                             lac_error *err)
{
    size_t sides = (size_t)how->margin + 1;
    *whole = *grid;
    LAC_FAIL_IF(how->margin > 0 && grid->periodic, err, LAC_EINPUT,
                "%s: margin is for free boundaries: on a periodic one the surface must repeat with "
                "the interface",
                how->source);
    whole->nx = grid->nx > 1 ? grid->nx * sides : 1;
    whole->ny = grid->ny > 1 ? grid->ny * sides : 1;
    return LAC_OK;
}

lac_status lac_synthesis_band(const lac_synthesis *how, const lac_waves *waves,
                              const lac_grid *grid, lac_band *band, lac_error *err)
{
    lac_grid whole;
    lac_status status = find_whole(how, grid, &whole, err);
    return status == LAC_OK ? lac_band_of(waves, &whole, band, err) : status;
}

static lac_status check(const lac_synthesis *how, const lac_band *b, lac_error *err)
{
    if (how->sampling == LAC_SAMPLING_LOW_PASS) {
        return LAC_OK;
    }
    LAC_FAIL_IF(!how->bounded, err, LAC_EINPUT,
                "%s: sampling needs shortest: without it the band ends with the waves of the grid",
                how->source);
    double waves_x = b->dqx > 0.0 ? 2.0 * b->q_shortest / b->dqx : 1.0;
    double waves_y = b->dqy > 0.0 ? 2.0 * b->q_shortest / b->dqy : 1.0;
    LAC_FAIL_IF(waves_x * waves_y > most_waves, err, LAC_EINPUT,
                "%s: sampling has to add %g waves; at most %g are added: choose a longer shortest, "
                "or low-pass",
                how->source, waves_x * waves_y, most_waves);
    return LAC_OK;
}

// Mean of exp(i q x) over a cell, over its value at the node the cell begins at.
static double _Complex cell_mean(double turn)
{
    double half = M_PI * turn;
    double part = half == 0.0 ? 1.0 : sin(half) / half;
    return part * cos(half) + part * sin(half) * I;
}

static double _Complex wave(const folding *f, double kx, double ky)
{
    bool given = kx > 0.0 || (kx == 0.0 && ky > 0.0);
    if (kx == 0.0 && ky == 0.0) {
        return 0.0;
    }
    // the field is real
    double _Complex a = given ? f->mode(f->of, kx, ky) : conj(f->mode(f->of, -kx, -ky));
    return f->mean ? a * cell_mean(kx / f->nx) * cell_mean(ky / f->ny) : a;
}

// The first of k, k + n, k + 2 n ... at or above -last; a direction of one cell has no waves.
static double lowest(double k, double n, double last)
{
    return n > 1.0 ? k + n * ceil((-last - k) / n) : k;
}

static double _Complex folded(const folding *f, double kx, double ky)
{
    double _Complex sum = 0.0;
    double step_x = f->nx > 1.0 ? f->nx : 1.0;
    double step_y = f->ny > 1.0 ? f->ny : 1.0;
    for (double y = lowest(ky, f->ny, f->ky_last); y <= f->ky_last; y += step_y) {
        for (double x = lowest(kx, f->nx, f->kx_last); x <= f->kx_last; x += step_x) {
            sum += wave(f, x, y);
        }
    }
    return sum;
}

static void fill(lac_fft *fft, const folding *f)
{
    ptrdiff_t rows = (ptrdiff_t)fft->ny;
#pragma omp parallel for schedule(static)
    for (ptrdiff_t j = 0; j < rows; j++) {
        double ky = lac_fft_frequency((size_t)j, fft->ny);
        for (size_t i = 0; i < fft->nkx; i++) {
            fft->spectrum[(size_t)j * fft->nkx + i] = folded(f, (double)i, ky);
        }
    }
}

// The corner of the whole, without the mean that it or its short waves may have.
static void take(const lac_synthesis *how, const lac_fft *fft, const lac_grid *grid,
                 double *heights)
{
    size_t n = lac_grid_cells(grid);
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        heights[i] = fft->real[i / grid->nx * fft->nx + i % grid->nx];
        sum += heights[i];
    }
    bool none = how->sampling == LAC_SAMPLING_LOW_PASS && how->margin == 0;
    for (size_t i = 0; !none && !how->with_mean && i < n; i++) {
        heights[i] -= sum / (double)n;
    }
}

lac_status lac_synthesise(const lac_synthesis *how, const lac_band *band, const lac_grid *grid,
                          double _Complex (*mode)(const void *of, double kx, double ky),
                          const void *of, double *heights, lac_error *err)
{
    lac_fft *fft = NULL;
    lac_grid whole;
    lac_status status;
    LAC_TRY(find_whole(how, grid, &whole, err));
    LAC_TRY(check(how, band, err));
    LAC_TRY(lac_fft_create(whole.nx, whole.ny, &fft, err));
    if (how->sampling == LAC_SAMPLING_LOW_PASS) {
        lac_band_fill(fft, mode, of);
    } else {
        const double edge = 1.0 + 1e-9;
        const folding f = {
            .mode = mode,
            .of = of,
            .nx = (double)whole.nx,
            .ny = (double)whole.ny,
            .kx_last = band->dqx > 0.0 ? floor(edge * band->q_shortest / band->dqx) : 0.0,
            .ky_last = band->dqy > 0.0 ? floor(edge * band->q_shortest / band->dqy) : 0.0,
            .mean = how->sampling == LAC_SAMPLING_BLOCK_MEAN,
        };
        fill(fft, &f);
    }
    lac_fft_inverse(fft);
    take(how, fft, grid, heights);
out:
    lac_fft_free(fft);
    return status;
}
