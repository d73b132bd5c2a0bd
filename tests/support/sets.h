/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SETS_H
#define LACUNA_TESTS_SETS_H

#include <stdint.h>

#include "contact/contact.h"

/// Sets of cells of known dimension, one byte a cell: 1 in the set, 0 outside.

/// Sierpinski's carpet on a square of 3^depth cells: ln 8 / ln 3.
void set_carpet(size_t depth, uint8_t *occupied);

/// A random dyadic cascade on a square of 2^depth cells: each of the four quarters of a block is
/// kept with probability 2^(dimension - 2).
void set_cascade(size_t depth, double dimension, uint64_t seed, uint8_t *occupied);

/// A domain of these cells in row order with unit pressure; NULL where memory is short.
lac_domain *set_domain(const lac_grid *grid, const uint8_t *occupied);

/// Frees a domain made by set_domain; NULL is fine.
void set_domain_free(lac_domain *domain);

#endif
