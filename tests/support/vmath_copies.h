/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_SUPPORT_VMATH_COPIES_H
#define TEST_SUPPORT_VMATH_COPIES_H

#include <stddef.h>

typedef void test_vfunction(size_t n, const double *x, double *y);

/// base/vmath.c compiled once more for one instruction set.
typedef struct test_vmath_copy {
    const char *name;
    test_vfunction *exp, *log, *asinh;
} test_vmath_copy;

test_vfunction test_default_vexp, test_default_vlog, test_default_vasinh;
test_vfunction test_v3_vexp, test_v3_vlog, test_v3_vasinh;
test_vfunction test_v4_vexp, test_v4_vlog, test_v4_vasinh;

/// Those copies that this processor can run.
/// @param copies  [3] filled from the front
/// @return how many
size_t test_vmath_copies(test_vmath_copy copies[3]);

/// The target attribute of the copies beyond the default, where the compiler knows it.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define TEST_VMATH_HAS_TARGETS 1
#define TEST_VMATH_TARGET(name) __attribute__((target(name)))
#else
#define TEST_VMATH_HAS_TARGETS 0
#define TEST_VMATH_TARGET(name)
#endif

#endif
