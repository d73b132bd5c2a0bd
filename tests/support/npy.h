/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_NPY_H
#define LACUNA_TESTS_NPY_H

#include <stddef.h>

/// Reads n little-endian doubles in C order from a .npy file of version 1.
/// @return 0; -1 where there is no such file or it holds something else
int npy_read(const char *path, size_t n, double *values);

#endif
