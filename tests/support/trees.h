/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_TREES_H
#define LACUNA_TESTS_TREES_H

#include "hierarchy/hierarchy.h"

/// A domain whose cells are those with mask != 0 (all where mask is NULL), pressure 1 Pa, cells of
/// 1 m. Stops the test where it cannot be made.
lac_domain *domain_of(size_t nx, size_t ny, const uint8_t *mask);

/// A random lacunar domain of at most max_cells cells: shape (square, oblong, line), size and
/// filling all drawn from the seed, corners (one cell, full grid, far corner only) included.
lac_domain *random_domain(uint64_t seed, size_t max_cells);

/// The hierarchy of a domain. Stops the test where it cannot be made.
lac_hierarchy *hierarchy_of(const lac_domain *domain);

/// K from its definition: block means of the cells' grid coordinates, no tree.
/// @param dense  [n * n]; overwritten
void dense_hierarchy(const lac_domain *domain, size_t levels, const double *k, long double *dense);

/// Solves a x = y by elimination with partial pivoting; a and y are destroyed, y becomes x.
void dense_solve(size_t n, long double *a, long double *y);

/// Whether a symmetric matrix is positive definite (Cholesky); a is destroyed.
bool dense_positive(size_t n, long double *a);

/// A uniform random number in [low, high) and one uniform in its logarithm.
double draw_uniform(uint64_t seed, uint64_t number, double low, double high);
double draw_log(uint64_t seed, uint64_t number, double low, double high);

/// sqrt(sum (x - y)^2 / sum y^2)
double relative_error(size_t n, const double *x, const double *y);

/// malloc that stops the test on failure; always at least one element.
double *new_doubles(size_t n);

#endif
