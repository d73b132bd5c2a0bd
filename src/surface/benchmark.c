// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that anyone can make again to the last wave, to compare contact solvers.
#include "base/fft.h"
#include "base/rows.h"
#include "surface/surface.h"

// A(|k|) = 1 within the plateau, (|k| / plateau)^-(H+1) beyond, for 1 <= |k| <= most.
typedef struct recipe {
    double hurst, plateau;
    long most;
    uint64_t seed;
} recipe;

// Mean squares that the modes add up to on the unit square.
typedef struct squares {
    double height, slope;
} squares;

// Steele, Lea & Flood (2014), doi 10.1145/2660193.2660195
static uint64_t splitmix64(uint64_t x)
{
    uint64_t z = x + UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static double phase(uint64_t seed, long kx, long ky)
{
    const long shift = 1L << 20;
    uint64_t key = seed * UINT64_C(0x9E3779B97F4A7C15) + ((uint64_t)(kx + shift) << 32);
    return (2.0 * M_PI) * (double)(splitmix64(key + (uint64_t)(ky + shift)) >> 11) * 0x1p-53;
}

// Adds a mode where its nodes' heights put it: a wave too short for the grid folds back, which is
// what taking every m-th node of a fine grid does. kx runs along the rows, ky within one.
static void add(lac_fft *fft, long kx, long ky, double _Complex a)
{
    long n = (long)fft->nx;
    size_t row = (size_t)((kx % n + n) % n), column = (size_t)((ky % n + n) % n);
    if (column < fft->nkx) {
        fft->spectrum[row * fft->nkx + column] += a;
    }
}

static squares fill_spectrum(recipe r, lac_fft *fft)
{
    squares sum = {0.0, 0.0};
    memset(fft->spectrum, 0, fft->nkx * fft->ny * sizeof *fft->spectrum);
    for (long kx = 0; kx <= r.most; kx++) {
        for (long ky = kx > 0 ? -r.most : 1; ky <= r.most; ky++) {
            double k = hypot((double)kx, (double)ky);
            if (k > (double)r.most) {
                continue;
            }
            double a = k < r.plateau ? 1.0 : pow(k / r.plateau, -(r.hurst + 1.0));
            double phi = phase(r.seed, kx, ky);
            add(fft, kx, ky, 0.5 * a * (cos(phi) + sin(phi) * I));
            add(fft, -kx, -ky, 0.5 * a * (cos(phi) - sin(phi) * I));
            sum.height += 0.5 * a * a;
            sum.slope += 0.5 * (a * (2.0 * M_PI) * k) * (a * (2.0 * M_PI) * k);
        }
    }
    return sum;
}

static recipe recipe_of(const lac_benchmark *p, const lac_grid *grid)
{
    recipe r = p->name == LAC_BENCHMARK_A08 ? (recipe){0.8, 4.0, (long)grid->nx / 8, 1}
                                            : (recipe){0.7, 1.0, 511, 2};
    if (p->seed != INT64_MIN) {
        r.seed = (uint64_t)p->seed;
    }
    return r;
}

// Factor from the sum of the modes to heights over the side.
static double scale_of(const lac_benchmark *p, squares sum)
{
    if (!isnan(p->rms_slope)) {
        return p->rms_slope / sqrt(sum.slope);
    }
    if (!isnan(p->height_ratio)) {
        return p->height_ratio / sqrt(sum.height);
    }
    return p->name == LAC_BENCHMARK_A08 ? 0.1 / sqrt(sum.slope) : 0.01 / sqrt(sum.height);
}

static lac_status check(const lac_benchmark *p, const lac_grid *grid, lac_error *err)
{
    LAC_FAIL_IF(
        !isnan(p->rms_slope) && !isnan(p->height_ratio), err, LAC_EINPUT,
        "benchmark: give rms_slope or height_ratio, not both: each fixes the scale of the heights");
    LAC_FAIL_IF(
        grid->nx != grid->ny || fabs(grid->dx / grid->dy - 1.0) > 1e-9, err, LAC_EINPUT,
        "benchmark: defined on a square of square cells, not on %zu x %zu cells of %g x %g m",
        grid->nx, grid->ny, grid->dx, grid->dy);
    LAC_FAIL_IF(grid->nx % 8 != 0, err, LAC_EINPUT,
                "benchmark: the cells along a side must be a multiple of 8, not %zu", grid->nx);
    return LAC_OK;
}

// h(i, j) = L c sum over k of A(|k|) cos(2 pi (kx i + ky j) / N + phi_k), i the row
static lac_status generate(const void *params, const lac_grid *grid, lac_team *team,
                           double *heights, lac_surface_stats *report, lac_error *err)
{
    const lac_benchmark *p = params;
    (void)report;
    (void)team;
    size_t n = lac_grid_cells(grid);
    lac_fft *fft = NULL;
    LAC_TRY_RETURN(check(p, grid, err));
    LAC_TRY_RETURN(lac_fft_create(grid->nx, grid->ny, &fft, err));
    double scale =
        (double)grid->nx * grid->dx * scale_of(p, fill_spectrum(recipe_of(p, grid), fft));
    lac_fft_inverse(fft);
    for (size_t i = 0; i < n; i++) {
        heights[i] = fft->real[i] * scale;
    }
    lac_fft_free(fft);
    return LAC_OK;
}

static lac_wave_range waves(const void *params, const lac_grid *grid)
{
    const lac_benchmark *p = params;
    double side = (double)grid->nx * grid->dx;
    return p->name == LAC_BENCHMARK_A08 ? (lac_wave_range){side / 4.0, 8.0 * grid->dx}
                                        : (lac_wave_range){side, side / 511.0};
}

#define FIELD(name) offsetof(lac_benchmark, name)

static const char *const names[] = {"A08", "J07", NULL};

static const lac_param benchmark_params[] = {
    LAC_CHOICE(
        "name", FIELD(name), LAC_BENCHMARK_A08, names, 0,
        "A08: Hurst 0.8, flat to a quarter of the side, shortest wave of 8 cells; J07: Hurst 0.7, "
        "no flat part, 511 waves a side, of which a grid takes the heights at its nodes"),
    LAC_REAL("rms_slope", "1", FIELD(rms_slope), NAN, 0, 1e3, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "spectral rms slope of all waves; 0.1 for A08 if neither scale is given"),
    LAC_REAL("height_ratio", "1", FIELD(height_ratio), NAN, 0, 1e3, LAC_OPTIONAL | LAC_ABOVE_MIN,
             "rms height of all waves over the side of the interface; 0.01 for J07 if neither "
             "scale is given"),
    LAC_SEED(FIELD(seed), NAN, LAC_OPTIONAL, "of the phases; 1 for A08 and 2 for J07 if absent"),
};

const lac_surface_source lac_surface_benchmark = {
    .info =
        LAC_ABOUT("benchmark", "surfaces that anyone can make again, to compare contact solvers",
                  "docs/theory/surface.md, eq. 3-5", LAC_ROWS(benchmark_params, lac_benchmark)),
    .generate = generate,
    .waves = waves,
};
