/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_BENCHMARK_SURFACE_H
#define LACUNA_TESTS_BENCHMARK_SURFACE_H

#include <stddef.h>

/// Heights of the benchmark surface A08_n on the unit square: Hurst 0.8, plateau to |k| = 4,
/// shortest wave |k| = n/8, rms slope 0.1, seed 1.
/// @param heights  [n * n]; overwritten
/// @return 0, or -1 where memory is short
int benchmark_surface(size_t n, double *heights);

/// Heights of the joint-like surface J07_1024 at the n * n nodes of the unit square: Hurst 0.7, no
/// plateau, modes 1 <= |k| <= 511, rms height 0.01, seed 2.
/// @param heights  [n * n]; overwritten
/// @return 0, or -1 where memory is short
int joint_surface(size_t n, double *heights);

#endif
