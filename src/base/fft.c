// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/fft.h"

#include <fftw3.h>
#include <limits.h>
#include <stdlib.h>

static void destroy_plan(void *plan)
{
    if (plan != NULL) {
        fftw_destroy_plan(plan);
    }
}

lac_status lac_fft_create(size_t nx, size_t ny, lac_fft **out, lac_error *err)
{
    *out = NULL;
    if (nx == 0 || ny == 0 || nx > INT_MAX || ny > INT_MAX) {
        return lac_fail(err, LAC_EINPUT, "a transform of %zu x %zu cells is not possible", nx, ny);
    }
    lac_fft *fft = calloc(1, sizeof *fft);
    if (fft == NULL) {
        return lac_fail_memory(err);
    }
    fft->nx = nx;
    fft->ny = ny;
    fft->nkx = nx / 2 + 1;
    fft->real = fftw_alloc_real(nx * ny);
    fft->spectrum = (double _Complex *)fftw_alloc_complex(fft->nkx * ny);
    if (fft->real != NULL && fft->spectrum != NULL) {
        fft->forward = fftw_plan_dft_r2c_2d((int)ny, (int)nx, fft->real,
                                            (fftw_complex *)fft->spectrum, FFTW_ESTIMATE);
        fft->inverse = fftw_plan_dft_c2r_2d((int)ny, (int)nx, (fftw_complex *)fft->spectrum,
                                            fft->real, FFTW_ESTIMATE);
    }
    if (fft->forward == NULL || fft->inverse == NULL) {
        lac_fft_free(fft);
        return lac_fail_memory(err);
    }
    *out = fft;
    return LAC_OK;
}

void lac_fft_free(lac_fft *fft)
{
    if (fft == NULL) {
        return;
    }
    destroy_plan(fft->forward);
    destroy_plan(fft->inverse);
    fftw_free(fft->real);
    fftw_free(fft->spectrum);
    free(fft);
}

void lac_fft_forward(lac_fft *fft) { fftw_execute(fft->forward); }

void lac_fft_inverse(lac_fft *fft) { fftw_execute(fft->inverse); }
