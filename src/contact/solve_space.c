// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "contact/solve.h"

static void fill_tables(lac_half_space *s, double dqx, double dqy)
{
    const lac_fft *fft = s->fft;
    double cells = (double)fft->nx * (double)fft->ny;
    double self = 0.0;
    for (size_t j = 0; j < fft->ny; j++) {
        double qy = lac_fft_frequency(j, fft->ny) * dqy;
        for (size_t i = 0; i < fft->nkx; i++) {
            double kappa = hypot((double)i * dqx, qy);
            double compliance = i + j > 0 ? 1.0 / (kappa * cells) : 0.0;
            s->compliance[j * fft->nkx + i] = compliance;
            s->stiffness[j * fft->nkx + i] = kappa / cells;
            self += (i > 0 && 2 * i < fft->nx ? 2.0 : 1.0) * compliance;
        }
    }
    s->self = self;
}

lac_status lac_half_space_create(size_t nx, size_t ny, double dqx, double dqy, lac_half_space **out,
                                 lac_error *err)
{
    lac_status status;
    lac_half_space *s = calloc(1, sizeof *s);
    *out = NULL;
    if (s == NULL) {
        return lac_fail_memory(err);
    }
    LAC_TRY(lac_fft_create(nx, ny, &s->fft, err));
    size_t modes = s->fft->nkx * ny;
    s->compliance = malloc(modes * sizeof(double));
    s->stiffness = malloc(modes * sizeof(double));
    if (s->compliance == NULL || s->stiffness == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    fill_tables(s, dqx, dqy);
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

static void filter(lac_fft *fft, const double *table)
{
    lac_fft_forward(fft);
    size_t modes = fft->nkx * fft->ny;
    for (size_t k = 0; k < modes; k++) {
        fft->spectrum[k] *= table[k];
    }
    lac_fft_inverse(fft);
}

void lac_half_space_displace(lac_half_space *s) { filter(s->fft, s->compliance); }

void lac_half_space_unload(lac_half_space *s) { filter(s->fft, s->stiffness); }

// sum of |x_k|^2 w_k over a run of modes
static double power(size_t n, const double *x, const double *w)
{
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (size_t k = 0; k < n; k++) {
        sum += w[k] * (x[2 * k] * x[2 * k] + x[2 * k + 1] * x[2 * k + 1]);
    }
    return sum;
}

double lac_half_space_energy(lac_half_space *s)
{
    lac_fft *fft = s->fft;
    lac_fft_forward(fft);
    double energy = 0.0;
    for (size_t j = 0; j < fft->ny; j++) {
        size_t row = j * fft->nkx;
        const double *x = (const double *)&fft->spectrum[row];
        const double *w = &s->compliance[row];
        // Half of the spectrum stands for the whole: its inner columns count twice.
        double ends = power(1, x, w);
        if (fft->nx % 2 == 0) {
            size_t last = fft->nkx - 1;
            ends += power(1, &x[2 * last], &w[last]);
        }
        energy += 2.0 * power(fft->nkx, x, w) - ends;
    }
    return energy;
}
