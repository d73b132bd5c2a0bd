// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/benchmark_surface.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/fft.h"

static const double tau = 6.283185307179586476925286766559;

static uint64_t splitmix64(uint64_t x)
{
    uint64_t z = x + UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

// Amplitude (|k| / plateau)^-(H+1) beyond the plateau, 1 within, for 1 <= |k| <= most.
typedef struct recipe {
    double hurst, plateau;
    long most;
    uint64_t seed;
} recipe;

static double phase(uint64_t seed, long kx, long ky)
{
    const long shift = 1L << 20;
    uint64_t key = seed * UINT64_C(0x9E3779B97F4A7C15) + ((uint64_t)(kx + shift) << 32);
    return tau * (double)(splitmix64(key + (uint64_t)(ky + shift)) >> 11) * 0x1p-53;
}

// kx runs along the slow index (rows), ky along the fast one.
static void put(lac_fft *fft, long kx, long ky, double _Complex a)
{
    long n = (long)fft->nx;
    if (ky >= 0) {
        fft->spectrum[(size_t)((kx + n) % n) * fft->nkx + (size_t)ky] = a;
    }
}

// Sums the modes; what they add to the mean squares of height and slope goes to `squares`.
static lac_fft *synthesise(size_t n, recipe r, double squares[2])
{
    lac_fft *fft = NULL;
    if (lac_fft_create(n, n, &fft, NULL) != LAC_OK) {
        return NULL;
    }
    memset(fft->spectrum, 0, fft->nkx * n * sizeof *fft->spectrum);
    for (long kx = 0; kx <= r.most; kx++) {
        for (long ky = kx > 0 ? -r.most : 1; ky <= r.most; ky++) {
            double k = hypot((double)kx, (double)ky);
            if (k > (double)r.most) {
                continue;
            }
            double a = k < r.plateau ? 1.0 : pow(k / r.plateau, -(r.hurst + 1.0));
            double phi = phase(r.seed, kx, ky);
            put(fft, kx, ky, 0.5 * a * (cos(phi) + sin(phi) * I));
            put(fft, -kx, -ky, 0.5 * a * (cos(phi) - sin(phi) * I));
            squares[0] += 0.5 * a * a;
            squares[1] += 0.5 * (a * tau * k) * (a * tau * k);
        }
    }
    lac_fft_inverse(fft);
    return fft;
}

static void give(const lac_fft *fft, double scale, double *heights)
{
    for (size_t i = 0; i < fft->nx * fft->ny; i++) {
        heights[i] = fft->real[i] * scale;
    }
}

int benchmark_surface(size_t n, double *heights)
{
    double squares[2] = {0.0, 0.0};
    lac_fft *fft = synthesise(n, (recipe){0.8, 4.0, (long)n / 8, 1}, squares);
    if (fft == NULL) {
        return -1;
    }
    give(fft, 0.1 / sqrt(squares[1]), heights);
    lac_fft_free(fft);
    return 0;
}

int joint_surface(size_t n, double *heights)
{
    double squares[2] = {0.0, 0.0};
    lac_fft *fft = synthesise(n, (recipe){0.7, 1.0, (long)n / 2 - 1, 2}, squares);
    if (fft == NULL) {
        return -1;
    }
    give(fft, 0.01 / sqrt(squares[0]), heights);
    lac_fft_free(fft);
    return 0;
}
