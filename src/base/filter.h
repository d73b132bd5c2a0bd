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

typedef enum lac_precision { LAC_SINGLE, LAC_DOUBLE } lac_precision;

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

/// A transform twice as long as the field is taken part by part, in the memory of half of it: what
/// is filled is filled for each of them, and what is taken, and the powers, are to be added. Of two
/// parts the first holds the even wavenumbers along x.
size_t lac_filter_parts(const lac_filter *f, lac_precision precision);

/// Fills all rows and transforms them along x. Each row begins undefined.
/// @param part  < lac_filter_parts
void lac_filter_fill(lac_filter *f, lac_precision precision, size_t part, lac_filter_row fill,
                     void *context);

/// Multiplies the spectrum of what was filled by a symbol, unnormalised.
/// @param power  what lac_filter_power would have said before; NULL if not wanted
void lac_filter_multiply(lac_filter *f, lac_filter_symbol symbol, const void *context,
                         double *power);

/// Sum over all its wavenumbers of symbol |F x|^2 of what was filled, which stays.
double lac_filter_power(lac_filter *f, lac_filter_symbol symbol, const void *context);

/// Transforms the rows back, unnormalised, and gives a copy of each to the caller; they stay, to
/// be taken again.
void lac_filter_take(lac_filter *f, lac_filter_row take, void *context);

/// The precision of what was filled last.
lac_precision lac_filter_precision(const lac_filter *f);

/// In how many threads a pass runs.
int lac_filter_threads(const lac_filter *f);
