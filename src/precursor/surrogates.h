/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_PRECURSOR_SURROGATES_H
#define LACUNA_PRECURSOR_SURROGATES_H

#include <stddef.h>
#include <stdint.h>

#include "base/fft.h"

/// A stationary first-order autoregression with coefficient phi and innovations of variance 1.
void lac_surrogate_red(size_t n, double phi, uint64_t seed, size_t index, double *x);

/// A series' Fourier amplitudes, of which surrogates with other phases are made.
typedef struct lac_phases {
    size_t n;
    lac_fft *fft;
    double *amplitude; ///< [n/2 + 1]
} lac_phases;

/// @return LAC_OK; LAC_ENOMEM; phases are to be cleared in any case
lac_status lac_phases_create(size_t n, const double *x, lac_phases *out, lac_error *err);
void lac_phases_clear(lac_phases *phases);

/// A series with the same amplitudes and phases at random.
void lac_phases_draw(const lac_phases *phases, uint64_t seed, size_t index, double *x);

#endif
