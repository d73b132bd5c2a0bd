/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/strip.h"
#include <complex.h>

/// A pair of real-to-complex plans of one shape with their own buffers. Reproducible (ESTIMATE),
/// but for filters that were asked to be measured.
typedef struct lac_fft {
    size_t nx, ny, nkx;        ///< nkx = nx/2 + 1 wavenumbers along x
    lac_strip strip;           ///< the rows here, of both
    double *real;              ///< [strip.n * nx]
    double _Complex *spectrum; ///< [strip.n * nkx]; destroyed by the inverse
    lac_strip columns;         ///< the wavenumbers along x whose tables are here
    lac_turn *shared;          ///< NULL: all rows are here
    void *forward, *inverse;
    bool mirrored; ///< the filter is of a line and its mirror image: lac_fft_mirror
    bool measure;  ///< plans of the filter are the quickest of those tried: their last bits differ
                   ///< from run to run; to be set before lac_fft_plan_filter
    size_t rows;   ///< of real that lac_fft_filter reads and writes
    size_t lead;   ///< from column to column in block
    double _Complex *block;
    void *rows_forward, *rows_inverse, *block_forward, *block_inverse;
} lac_fft;

/// Plans transforms of an ny x nx grid (x fastest).
lac_status lac_fft_create(size_t nx, size_t ny, lac_fft **out, lac_error *err);
void lac_fft_free(lac_fft *fft);

/// The same, with the rows of lac_strip_rows on each rank: for lac_fft_inverse and lac_fft_table
/// alone, which all of them call, and which give the bits of one process.
lac_status lac_fft_share(size_t nx, size_t ny, lac_team *team, lac_fft **out, lac_error *err);

/// The same for lac_fft_filter alone: the rows of lac_strip_rows of the first `rows`.
/// @pre  rows > 1: FFTW does a single row in other ways
lac_status lac_fft_share_filter(size_t nx, size_t ny, size_t rows, lac_team *team, lac_fft **out,
                                lac_error *err);

/// Makes of it the filter of a line whose data go on, before the first cell, as their mirror image:
/// cosine transforms with nkx = nx waves cos(pi k (i + 1/2)/nx), of which the pair multiplies by
/// 2 nx. Forward and inverse are not for it. To be called before lac_fft_plan_filter.
void lac_fft_mirror(lac_fft *fft);

/// real -> spectrum, unnormalised.
void lac_fft_forward(lac_fft *fft);

/// spectrum -> real, unnormalised (the pair multiplies by nx * ny).
void lac_fft_inverse(lac_fft *fft);

/// Real part of the transform of real over nx * ny: a table for lac_fft_filter of the wavenumbers
/// here, [columns.n * ny] by columns.
void lac_fft_table(lac_fft *fft, double *table);

/// Plans lac_fft_filter for data in the first rows only, zeros below. Overwrites the buffers.
lac_status lac_fft_plan_filter(lac_fft *fft, size_t rows, lac_error *err);

/// real -> F^-1 (table F real) in the planned rows, unnormalised; table
/// [columns.n * ny], by columns. Columns go forth and back a few at a time, while they are in the
/// cache: cheaper than the pair.
void lac_fft_filter(lac_fft *fft, const double *table);

/// real -> F^-1 (M F real) in the planned rows, F along x alone, unnormalised; table
/// [nkx][rows][rows]: M of each wave, symmetric.
void lac_fft_filter_rows(lac_fft *fft, const double *table);

/// Fourier transform of a real even field of 2 (n0 - 1) x 2 (n1 - 1) cells, unnormalised: from its
/// quarter [n0 * n1], with its origin and both middle lines, to the same quarter of the transform.
lac_status lac_fft_even(size_t n0, size_t n1, double *quarter, lac_error *err);

/// The same with the rows of each rank.
/// @param mirrored  of ranks, where n1 is rows->all: above the diagonal comes what is below it
/// @param quarter   [rows->n * n1]
lac_status lac_fft_share_even(const lac_strip *rows, size_t n1, bool mirrored, double *quarter,
                              lac_error *err);

/// What lac_fft_inverse, lac_fft_table and lac_fft_filter do where rows are shared.
void lac_fft_share_inverse(lac_fft *fft);
void lac_fft_share_table(lac_fft *fft, double *table);
void lac_fft_share_through(lac_fft *fft, const double *table);

/// Columns of a block, which block_forward and block_inverse were planned for: zeros below the rows
/// that are filled, and forth, through their tables and back.
void lac_fft_columns(const lac_fft *fft, double _Complex *block, size_t width, const double *table);

/// Signed index of wavenumber j of n: 0, 1 ... n/2, -(n/2 - 1) ... -1.
static inline double lac_fft_frequency(size_t j, size_t n)
{
    return 2 * j <= n ? (double)j : (double)j - (double)n;
}
