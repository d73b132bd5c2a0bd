/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/fft.h"
#include "base/grid.h"
#include "base/rng.h"
#include "base/rows.h"

/// What a cell holds of a surface of which the grid may not resolve all waves.
enum { LAC_SAMPLING_LOW_PASS, LAC_SAMPLING_POINT, LAC_SAMPLING_BLOCK_MEAN };

/// The words of these, for parameter tables; NULL at their end.
extern const char *const lac_sampling_words[];

/// Row of what a synthesis is told beside its band.
#define LAC_SAMPLING_ROW(holder)                                                              \
    LAC_CHOICE(                                                                               \
        "sampling", offsetof(holder, sampling), LAC_SAMPLING_LOW_PASS, lac_sampling_words, 0, \
        "of waves too short for the grid: left out (low-pass), folded back as taking every "  \
        "m-th height of a finer grid does (point), or averaged over the cell (block-mean); "  \
        "the last two need shortest")

/// A surface as a source states it.
typedef struct lac_synthesis {
    const char *source; ///< its name, for messages
    double hurst;       ///< [1]
    double rolloff;     ///< [m]; NaN: the longest side
    double shortest;    ///< [m]; NaN: two cells
    double anisotropy;  ///< stretch of all lengths along `direction` [1]; 1: isotropic
    double direction;   ///< from x towards y [rad]
    int sampling;       ///< LAC_SAMPLING_...
    bool with_mean;     ///< leave the heights the mean that they have on this grid
} lac_synthesis;

/// Spectrum on the modes k of one interface: q = 2 pi (kx/lx, ky/ly).
typedef struct lac_band {
    double dqx, dqy;   ///< spacing of the wavenumbers; 0 along a direction of one cell [rad/m]
    double q_rolloff;  ///< [rad/m]
    double q_shortest; ///< [rad/m]
    double hurst;
    double power; ///< C = (q' / q_rolloff)^-power beyond the rolloff
    double stretch, cosine, sine;
} lac_band;

/// The band of a grid.
lac_status lac_synthesis_band(const lac_synthesis *how, const lac_grid *grid, lac_band *band,
                              lac_error *err);

/// Sum of C |q|^moment over all modes of the full band, whatever a grid resolves of it.
/// @param moment  0 (heights) or 2 (slopes)
double lac_band_sum(const lac_band *b, int moment);

/// Amplitude of mode (kx, ky): complex normal of variance scale^2 C, a function of the seed, the
/// stream and the mode alone, so that every grid and every thread finds the same.
double _Complex lac_band_amplitude(const lac_band *b, uint64_t seed, lac_stream stream, double kx,
                                   double ky, double scale);

/// Heights of the interface: h = sum over k of mode(k) exp(i q_k x).
/// @param band  of the grid
/// @param team     who makes the other rows; NULL: all are made here
/// @param mode     amplitude of (kx, ky), called from several threads
/// @param heights  [rows of lac_strip_rows * nx]
lac_status lac_synthesise(const lac_synthesis *how, const lac_band *band, const lac_grid *grid,
                          lac_team *team,
                          double _Complex (*mode)(const void *of, double kx, double ky),
                          const void *of, double *heights, lac_error *err);
