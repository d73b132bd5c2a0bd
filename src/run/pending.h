/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/range.h"
#include "run/pass.h"

// Linear combinations of vectors of one length that wait, to be made together in one pass over
// memory: block by block, each block through all of them in their order while it is in the cache.
// Every element goes through the same operations in the same order as if nothing had waited, so
// the bits are the same. CVODE's prediction is 15 sums of two arrays at order 5.
typedef struct lac_pending lac_pending;

/// @param arrays  of the cells that a vector is made of, one after the other
/// @param waits   false: each is made at once
/// @return NULL where memory is short
lac_pending *lac_pending_create(const lac_range *range, size_t arrays, bool waits);

/// What waits is not made; NULL is fine.
void lac_pending_free(lac_pending *p);

/// Components here, and of all cells.
size_t lac_pending_length(const lac_pending *p);
size_t lac_pending_all(const lac_pending *p);

/// Who has the others; NULL: nobody.
const lac_team *lac_pending_team(const lac_pending *p);

/// Makes nothing from now on: all arrays count as empty, as if n were 0.
void lac_pending_close(lac_pending *p);

/// z = c_0 x_0 + c_1 x_1 + ..., added up in this order; z = c_0 where there is no x. z may be one
/// of them. Nobody may look into these arrays, nor write there, before they are finished. A sum of
/// two that still holds is not made again.
void lac_pending_add(lac_pending *p, int count, const double *c, const double *const *x, double *z);

/// Makes all that waits, but for other arrays that are one number. x may then be read and written.
void lac_pending_finish(lac_pending *p, const double *x);

/// Makes what x waits for and what waits for x, so that it may be read and written. Where vectors
/// are long the rest goes on waiting, for a pass that it can share.
void lac_pending_finish_one(lac_pending *p, const double *x);

/// The same to be read alone, until something is added. What x waits to become may have been made
/// elsewhere: a state that CVODE corrects is the one that it has tried. Who writes to a sum of two
/// finishes it before that, or before more is added.
/// @return where to read it
const double *lac_pending_look(lac_pending *p, const double *x);

/// Whatever x waits to become nobody asks for any more: it will be written anew.
void lac_pending_forget(lac_pending *p, const double *x);

/// Makes what x and w wait for, and sums (x w)^2 on the way, in an order that depends on the length
/// alone. An x that waits to be 0, or a w that waits to be one number, is not made; w is finite.
double lac_pending_squares(lac_pending *p, const double *x, const double *w);

/// Sum of x y, in such an order; nothing waits.
double lac_pending_dot(const lac_pending *p, const double *x, const double *y);
