/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_RUN_VECTOR_H
#define LACUNA_RUN_VECTOR_H

#include "run/compat.h"

// A serial vector with kernels of our own: Debian builds SUNDIALS without optimisation. Clones
// inherit them. Reductions sum in a fixed order. NULL where memory is short.
N_Vector lac_vector_create(size_t n, SUNContext sun);

// The vector's components.
double *lac_vector_data(N_Vector x);

// Gives a vector made by N_VCloneEmpty its components, which stay the lender's.
void lac_vector_lend(N_Vector x, double *components);

#endif
