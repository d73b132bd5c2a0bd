/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SUPPORT_TEST_H
#define LACUNA_TESTS_SUPPORT_TEST_H

// cmocka, and the headers that it needs before it; how many cases a test takes.

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#include <stdbool.h>
#include <stdlib.h>

// LACUNA_FEW is set, as under valgrind.
static inline bool test_few(void) { return getenv("LACUNA_FEW") != NULL; }

// Of so many cases a tenth there.
static inline size_t test_some(size_t many) { return test_few() ? (many + 9) / 10 : many; }

#endif
