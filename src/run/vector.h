/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/range.h"
#include "run/compat.h"

// A vector with kernels of our own: Debian builds SUNDIALS without optimisation. Clones inherit
// them. Reductions sum in a fixed order. Its components are so many arrays of the cells here; norms
// are of those of all cells. NULL where memory is short.
// `waits`: sums and multiples of it and its clones are made later, many in one pass over memory
// (run/pending.h), at the latest where something else is asked of one of them. A pointer taken
// before shows nothing of them until then.
N_Vector lac_vector_create(const lac_range *range, size_t arrays, bool waits, SUNContext sun);

// Whether memory was too short for the vector or one of its clones. A clone is never NULL for that,
// as SUNDIALS would not survive it; nobody may look at components then.
bool lac_vector_lacks(N_Vector x);

// The vector's components, everything that waited made but for others that are one number.
double *lac_vector_data(N_Vector x);

// The same with only what has to do with x made: other pointers taken before may not be good.
double *lac_vector_alone(N_Vector x);

// The same to be read alone, there or in another array that has the same (run/pending.h).
const double *lac_vector_look(N_Vector x);

// Whatever x waits to become nobody asks for any more: it will be written anew.
void lac_vector_forget(N_Vector x);

// A clone without components; NULL where memory is short.
N_Vector lac_vector_clone_empty(N_Vector like);

// Gives such a vector its components, which stay the lender's.
void lac_vector_lend(N_Vector x, double *components);
