/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SUPPORT_TEST_H
#define LACUNA_TESTS_SUPPORT_TEST_H

// cmocka, and the headers that it needs before it.

// clang-format off
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
// clang-format on

#endif
