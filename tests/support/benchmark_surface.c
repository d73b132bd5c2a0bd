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

static double phase(long kx, long ky)
{
    const long shift = 1L << 20;
    uint64_t key = UINT64_C(0x9E3779B97F4A7C15) + ((uint64_t)(kx + shift) << 32);
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

int benchmark_surface(size_t n, double *heights)
{
    lac_fft *fft = NULL;
    if (lac_fft_create(n, n, &fft, NULL) != LAC_OK) {
        return -1;
    }
    memset(fft->spectrum, 0, fft->nkx * n * sizeof *fft->spectrum);
    long most = (long)n / 8;
    double slope2 = 0.0;
    for (long kx = 0; kx <= most; kx++) {
        for (long ky = kx > 0 ? -most : 1; ky <= most; ky++) {
            double k = hypot((double)kx, (double)ky);
            if (k > (double)most) {
                continue;
            }
            double a = k < 4.0 ? 1.0 : pow(k / 4.0, -1.8);
            double phi = phase(kx, ky);
            put(fft, kx, ky, 0.5 * a * (cos(phi) + sin(phi) * I));
            put(fft, -kx, -ky, 0.5 * a * (cos(phi) - sin(phi) * I));
            slope2 += 0.5 * (a * tau * k) * (a * tau * k);
        }
    }
    lac_fft_inverse(fft);
    for (size_t i = 0; i < n * n; i++) {
        heights[i] = fft->real[i] * 0.1 / sqrt(slope2);
    }
    lac_fft_free(fft);
    return 0;
}
