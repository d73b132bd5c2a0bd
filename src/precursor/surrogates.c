// SPDX-License-Identifier: GPL-3.0-or-later
// Series that are like a given one but for what is tested.
#include "precursor/kinds.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/rng.h"

// The second counter of the numbers that phases are made of: none of an autoregression's.
static const uint64_t phase_counter = 1ULL << 40;
static const double pi = 3.14159265358979323846;

void lac_surrogate_red(size_t n, double phi, uint64_t seed, size_t index, double *x)
{
    double before = 0.0;
    double pair[2];
    for (size_t i = 0; i < n; i++) {
        if (i % 2 == 0) {
            lac_random_normal(seed, LAC_STREAM_SURROGATE, index, i / 2, pair);
        }
        before = i == 0 ? pair[0] / sqrt(1.0 - phi * phi) : phi * before + pair[i % 2];
        x[i] = before;
    }
}

lac_status lac_phases_create(size_t n, const double *x, lac_phases *out, lac_error *err)
{
    lac_status status;
    *out = (lac_phases){.n = n};
    LAC_TRY(lac_fft_create(n, 1, &out->fft, err));
    out->amplitude = malloc(out->fft->nkx * sizeof *out->amplitude);
    LAC_TRY(out->amplitude != NULL ? LAC_OK : lac_fail_memory(err));
    memcpy(out->fft->real, x, n * sizeof *x);
    lac_fft_forward(out->fft);
    for (size_t k = 0; k < out->fft->nkx; k++) {
        out->amplitude[k] = cabs(out->fft->spectrum[k]) / (double)n;
    }
out:
    return status;
}

void lac_phases_clear(lac_phases *phases)
{
    lac_fft_free(phases->fft);
    free(phases->amplitude);
}

void lac_phases_draw(const lac_phases *phases, uint64_t seed, size_t index, double *x)
{
    lac_fft *fft = phases->fft;
    for (size_t k = 0; k < fft->nkx; k++) {
        const double turn =
            lac_random_uniform(seed, LAC_STREAM_SURROGATE, index, phase_counter + k);
        fft->spectrum[k] = phases->amplitude[k] * cexp(I * 2.0 * pi * turn);
        if (k == 0 || 2 * k == phases->n) { // real ones have a sign for a phase
            fft->spectrum[k] = phases->amplitude[k] * (turn < 0.5 ? -1.0 : 1.0);
        }
    }
    lac_fft_inverse(fft);
    memcpy(x, fft->real, phases->n * sizeof *x);
}
