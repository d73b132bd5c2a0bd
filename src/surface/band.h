/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/fft.h"
#include "base/grid.h"
#include "base/rng.h"

/// Wavelengths of an interface, as a source states them.
typedef struct lac_waves {
    const char *source; ///< its name, for messages
    double hurst;       ///< [1]
    double rolloff;     ///< [m]; NaN: the longest side
    double shortest;    ///< [m]; NaN: two cells
    double anisotropy;  ///< stretch of all lengths along `direction` [1]; 1: isotropic
    double direction;   ///< from x towards y [rad]
} lac_waves;

/// Spectrum on the modes k of one interface: q = 2 pi (kx/lx, ky/ly).
typedef struct lac_band {
    double dqx, dqy;   ///< spacing of the wavenumbers; 0 along a direction of one cell [rad/m]
    double q_rolloff;  ///< [rad/m]
    double q_shortest; ///< [rad/m]
    double hurst;
    double power; ///< C = (q' / q_rolloff)^-power beyond the rolloff
    double stretch, cosine, sine;
} lac_band;

/// The band of a grid of more than one cell.
lac_status lac_band_of(const lac_waves *waves, const lac_grid *grid, lac_band *out, lac_error *err);

/// Sum of C |q|^moment over all modes of the full band, whatever a grid resolves of it.
/// @param moment  0 (heights) or 2 (slopes)
double lac_band_sum(const lac_band *b, int moment);

/// Amplitude of mode (kx, ky): complex normal of variance scale^2 C, a function of the seed, the
/// stream and the mode alone, so that every grid and every thread finds the same.
double _Complex lac_band_amplitude(const lac_band *b, uint64_t seed, lac_stream stream, double kx,
                                   double ky, double scale);

/// Fills the spectrum with the modes that the grid resolves; its Nyquist lines stay empty.
/// @param mode  amplitude of (kx, ky), called from several threads
void lac_band_fill(lac_fft *fft, double _Complex (*mode)(const void *of, double kx, double ky),
                   const void *of);
