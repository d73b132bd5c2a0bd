/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/strip.h"

/// A convolution of a real field, in single or double precision: rows are filled and transformed,
/// columns go forth, through a symbol and back, rows are transformed back and taken.
///
/// Two real rows travel as the real and the imaginary part of one complex transform. The field sits
/// in the corner of a transform that may be longer, zeros around it. Rows and columns are shared
/// out among threads; results are the same bits for any number of them.
typedef struct lac_filter lac_filter;

/// The precision of a field and its transform. A transform twice as long as the field is taken by
/// halves in double precision, with half the memory: the even and the odd wavenumbers along x,
/// whose results are to be added.
typedef enum lac_precision { LAC_SINGLE, LAC_DOUBLE, LAC_EVEN, LAC_ODD } lac_precision;

/// The columns of a spectrum whose symbol is asked for here, in full.
lac_strip lac_filter_columns(lac_team *team, size_t nkx);

/// Fills or takes row j of those here: nx floats or doubles. Called by several threads at once.
typedef void (*lac_filter_row)(void *context, size_t j, void *row);

/// Writes the real factors of column k of the spectrum, for the wavenumbers 0 ... my/2 along y
/// (the others are their mirror images): floats or doubles. Called by several threads at once.
typedef void (*lac_filter_symbol)(const void *context, size_t k, void *factor);

/// Plans (ESTIMATE: reproducible) for ny rows of nx in a transform of my rows of mx.
/// Uses as many threads as omp_get_max_threads says, one on small grids.
/// @param team  each rank fills and takes the rows of lac_strip_rows, and all functions are called
///              by all ranks: the same bits on any number of them; NULL: one alone
/// @pre   mx >= nx, my >= ny
lac_status lac_filter_create(const size_t field[2], const size_t transform[2], lac_team *team,
                             lac_filter **out, lac_error *err);
void lac_filter_free(lac_filter *f);

/// Fills all rows and transforms them along x. Each row begins undefined.
/// @pre  LAC_EVEN and LAC_ODD, and not LAC_DOUBLE, where mx = 2 nx
void lac_filter_fill(lac_filter *f, lac_precision precision, lac_filter_row fill, void *context);

/// Multiplies the spectrum of what was filled by a symbol, unnormalised.
void lac_filter_multiply(lac_filter *f, lac_filter_symbol symbol, const void *context);

/// Sum over all its wavenumbers of symbol |F x|^2 of what was filled, which stays.
double lac_filter_power(lac_filter *f, lac_filter_symbol symbol, const void *context);

/// Transforms the rows back, unnormalised, and gives a copy of each to the caller; they stay, to
/// be taken again.
void lac_filter_take(lac_filter *f, lac_filter_row take, void *context);

/// The precision of what was filled last.
lac_precision lac_filter_precision(const lac_filter *f);

/// In how many threads a pass runs.
int lac_filter_threads(const lac_filter *f);
