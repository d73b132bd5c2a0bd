// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>

#include "base/fft.h"
#include "base/rng.h"
#include "surface/registry.h"

#define TWO_PI 6.283185307179586476925286766559

// A wavenumber this close to the edge of the band is inside: lengths carry rounding.
static const double edge = 1.0 + 1e-9;
// Modes summed one by one for the variance of the band; those beyond are integrated.
static const double summed_modes = 1e6;

// Spectrum on the modes k of one interface: q = 2 pi (kx/lx, ky/ly).
typedef struct band {
    double dqx, dqy;   // spacing of the wavenumbers; 0 along a direction of one cell [rad/m]
    double q_rolloff;  // [rad/m]
    double q_shortest; // [rad/m]
    double hurst;
    double power; // C = (q / q_rolloff)^-power beyond the rolloff
} band;

// C(q) up to a factor: flat to the rolloff, a power law to the shortest wave, zero beyond.
static double density(const band *b, double q)
{
    if (q > b->q_shortest * edge) {
        return 0.0;
    }
    return q <= b->q_rolloff ? 1.0 : pow(q / b->q_rolloff, -b->power);
}

// Integral of q^(d-1) C(q) from a to the shortest wave, in d dimensions.
static double integral(const band *b, double a, int d)
{
    double sum = 0.0;
    double q_r = b->q_rolloff;
    double end = b->q_shortest;
    double flat = fmin(q_r, end);
    if (a < flat) {
        sum += d == 2 ? 0.5 * (flat * flat - a * a) : flat - a;
        a = flat;
    }
    if (a < end) {
        double h2 = 2.0 * b->hurst;
        sum += pow(q_r, d) / h2 * (pow(a / q_r, -h2) - pow(end / q_r, -h2));
    }
    return sum;
}

// Sum of C over the modes of a line.
static double line_sum(const band *b, double dq)
{
    double modes = floor(b->q_shortest * edge / dq);
    double last = fmin(modes, summed_modes);
    double sum = 0.0;
    for (double k = 1.0; k <= last; k += 1.0) {
        sum += 2.0 * density(b, k * dq);
    }
    return modes <= last ? sum : sum + 2.0 / dq * integral(b, (last + 0.5) * dq, 1);
}

// Sum of C over the modes of a plane, from one quadrant.
static double plane_sum(const band *b)
{
    double q_sum = sqrt(summed_modes * b->dqx * b->dqy * 2.0 / TWO_PI);
    bool all = b->q_shortest * edge <= q_sum;
    double end = all ? b->q_shortest * edge : q_sum;
    double sum = 0.0;
    for (double ky = 0.0; ky * b->dqy <= end; ky += 1.0) {
        double row = 0.0;
        for (double kx = ky > 0.0 ? 0.0 : 1.0; hypot(kx * b->dqx, ky * b->dqy) <= end; kx += 1.0) {
            row += (kx > 0.0 ? 2.0 : 1.0) * density(b, hypot(kx * b->dqx, ky * b->dqy));
        }
        sum += (ky > 0.0 ? 2.0 : 1.0) * row;
    }
    return all ? sum : sum + TWO_PI / (b->dqx * b->dqy) * integral(b, end, 2);
}

// Sum of C over all modes of the full band, whatever the grid resolves of it.
static double band_sum(const band *b)
{
    if (b->dqx > 0.0 && b->dqy > 0.0) {
        return plane_sum(b);
    }
    return line_sum(b, fmax(b->dqx, b->dqy));
}

static lac_status band_of(const lac_self_affine *params, const lac_grid *grid, band *b,
                          lac_error *err)
{
    double lx = grid->nx > 1 ? (double)grid->nx * grid->dx : 0.0;
    double ly = grid->ny > 1 ? (double)grid->ny * grid->dy : 0.0;
    double cell = fmax(grid->nx > 1 ? grid->dx : 0.0, grid->ny > 1 ? grid->dy : 0.0);
    double longest = fmax(lx, ly);
    double rolloff = isnan(params->rolloff) ? longest : params->rolloff;
    double shortest = isnan(params->shortest) ? 2.0 * cell : params->shortest;
    if (shortest > longest * edge) {
        return lac_fail(err, LAC_EINPUT,
                        "self-affine: the shortest wavelength, %g m, is longer than the "
                        "interface, %g m",
                        shortest, longest);
    }
    if (rolloff < shortest) {
        return lac_fail(err, LAC_EINPUT,
                        "self-affine: the rolloff, %g m, must not be shorter than the "
                        "shortest wavelength, %g m%s",
                        rolloff, shortest,
                        isnan(params->shortest) ? " (two cells, as none is given)" : "");
    }
    *b = (band){
        .dqx = lx > 0.0 ? TWO_PI / lx : 0.0,
        .dqy = ly > 0.0 ? TWO_PI / ly : 0.0,
        .q_rolloff = TWO_PI / rolloff,
        .q_shortest = TWO_PI / shortest,
        .hurst = params->hurst,
        .power = 2.0 * params->hurst + (lx > 0.0 && ly > 0.0 ? 2.0 : 1.0),
    };
    return LAC_OK;
}

// Amplitude of mode (kx, ky): complex normal of variance scale^2 C, a function of the seed and
// the mode alone, so that every grid and every thread finds the same.
static double _Complex amplitude(const band *b, uint64_t seed, double kx, double ky, double scale)
{
    double c = density(b, hypot(kx * b->dqx, ky * b->dqy));
    if (c == 0.0) {
        return 0.0;
    }
    double n[2];
    lac_random_normal(seed, LAC_STREAM_SURFACE, (uint64_t)(int64_t)kx, (uint64_t)(int64_t)ky, n);
    double size = scale * sqrt(0.5 * c);
    return size * n[0] + size * n[1] * I;
}

// The modes that the grid resolves; its Nyquist lines stay empty.
static void fill_spectrum(const band *b, uint64_t seed, double scale, lac_fft *fft)
{
    ptrdiff_t rows = (ptrdiff_t)fft->ny;
#pragma omp parallel for schedule(static) if (fft->nkx * fft->ny > 16384)
    for (ptrdiff_t j = 0; j < rows; j++) {
        double ky = lac_fft_frequency((size_t)j, fft->ny);
        bool nyquist = 2 * (size_t)j == fft->ny && j > 0;
        for (size_t i = 0; i < fft->nkx; i++) {
            double kx = (double)i;
            double _Complex a = 0.0;
            if (nyquist || 2 * i == fft->nx || (i == 0 && j == 0)) {
                a = 0.0;
            } else if (i == 0 && ky < 0.0) {
                a = conj(amplitude(b, seed, 0.0, -ky, scale)); // the field is real
            } else {
                a = amplitude(b, seed, kx, ky, scale);
            }
            fft->spectrum[(size_t)j * fft->nkx + i] = a;
        }
    }
}

// h(x) = sum over k of a_k exp(i q.x), with <|a_k|^2> = rms^2 C(q_k) / sum C.
static lac_status generate(const void *params, const lac_grid *grid, double *heights,
                           lac_error *err)
{
    const lac_self_affine *p = params;
    size_t n = lac_grid_cells(grid);
    if (n == 1) {
        heights[0] = 0.0; // one cell has no roughness
        return LAC_OK;
    }
    lac_fft *fft = NULL;
    band b;
    lac_status status;
    LAC_TRY(band_of(p, grid, &b, err));
    LAC_TRY(lac_fft_create(grid->nx, grid->ny, &fft, err));
    fill_spectrum(&b, (uint64_t)p->seed, p->rms_height / sqrt(band_sum(&b)), fft);
    lac_fft_inverse(fft);
    for (size_t i = 0; i < n; i++) {
        heights[i] = fft->real[i];
    }
out:
    lac_fft_free(fft);
    return status;
}

#define FIELD(name) offsetof(lac_self_affine, name)

static const lac_param self_affine_params[] = {
    {"hurst", "1", 0.8, 0.0, 1.0, FIELD(hurst), "Hurst exponent", .flags = LAC_ABOVE_MIN},
    {"rms_height", "m", NAN, 0.0, 1e6, FIELD(rms_height),
     "rms height expected of the full band, rolloff to shortest, also where a coarse grid leaves "
     "part of it out",
     .flags = LAC_ABOVE_MIN},
    {"rolloff", "m", NAN, 0.0, 1e9, FIELD(rolloff),
     "wavelength above which the spectrum is flat; the longest side if absent",
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN},
    {"shortest", "m", NAN, 0.0, 1e9, FIELD(shortest),
     "shortest wavelength of the interface; if absent two cells of the grid, to which rms_height "
     "then refers",
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN},
    {"seed", "1", 1.0, 0.0, 9007199254740992.0, FIELD(seed),
     "of the random numbers: the same interface at every resolution", .type = LAC_INTEGER},
};

const lac_surface_source lac_surface_self_affine = {
    .about =
        {
            .name = "self-affine",
            .summary = "random self-affine heights, periodic, by spectral synthesis",
            .reference = "Jacobs, Junge & Pastewka (2017), Surf. Topogr. 5:013001, "
                         "doi 10.1088/2051-672X/aa51f8",
            .params = self_affine_params,
            .param_count = sizeof self_affine_params / sizeof self_affine_params[0],
            .params_size = sizeof(lac_self_affine),
        },
    .generate = generate,
};
