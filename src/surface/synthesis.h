/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/rows.h"
#include "surface/band.h"

/// What a cell holds of a surface of which the grid may not resolve all waves.
enum { LAC_SAMPLING_LOW_PASS, LAC_SAMPLING_POINT, LAC_SAMPLING_BLOCK_MEAN };

/// The words of these, for parameter tables; NULL at their end.
extern const char *const lac_sampling_words[];

/// Rows of what a synthesis is told beside its band.
#define LAC_SAMPLING_ROWS(holder)                                                              \
    LAC_CHOICE(                                                                                \
        "sampling", offsetof(holder, sampling), LAC_SAMPLING_LOW_PASS, lac_sampling_words, 0,  \
        "of waves too short for the grid: left out (low-pass), folded back as taking every "   \
        "m-th height of a finer grid does (point), or averaged over the cell (block-mean); "   \
        "the last two need shortest"),                                                         \
        LAC_INTEGER(                                                                           \
            "margin", offsetof(holder, margin), 0, 0, 7, 0,                                    \
            "sides by which the surface goes on beyond the interface before it repeats: 1 or " \
            "more makes opposite sides of free boundaries strangers")

/// How heights are taken from a band.
typedef struct lac_synthesis {
    const char *source; ///< its name, for messages
    int sampling;       ///< LAC_SAMPLING_...
    int64_t margin;     ///< sides by which the surface goes on before it repeats
    bool bounded;       ///< the shortest wave is stated, not that of the grid
    bool with_mean;     ///< leave the heights the mean that they have on this grid
} lac_synthesis;

/// The band of the grid after which a surface repeats: the interface and its margin.
lac_status lac_synthesis_band(const lac_synthesis *how, const lac_waves *waves,
                              const lac_grid *grid, lac_band *band, lac_error *err);

/// Heights of the interface: h = sum over k of mode(k) exp(i q_k x).
/// @param band  of the whole grid
/// @param mode  as lac_band_fill
lac_status lac_synthesise(const lac_synthesis *how, const lac_band *band, const lac_grid *grid,
                          double _Complex (*mode)(const void *of, double kx, double ky),
                          const void *of, double *heights, lac_error *err);
