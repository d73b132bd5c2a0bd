/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include <stdint.h> // says which C library this is

// Where the compiler and the C library can, each loop is compiled for three instruction sets and
// the best one is picked when the program starts. Its name is then global, static or not: lac_...
// Sanitizers run before that is possible. Inlined, a clone would be the least of them.
#ifndef LAC_CLONES
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) && \
    __GNUC__ >= 12 && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LAC_CLONES \
    __attribute__((noinline, target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define LAC_CLONES
#endif
#endif

// x and y are the same array or do not overlap, so that no element depends on another.
#if defined(__clang__)
#define LAC_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define LAC_INDEPENDENT _Pragma("GCC ivdep")
#else
#define LAC_INDEPENDENT
#endif
