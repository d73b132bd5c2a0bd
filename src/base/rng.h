/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// What a stream of random numbers is for: numbers of different streams are independent.
typedef enum lac_stream {
    LAC_STREAM_SURFACE = 1,
    LAC_STREAM_DOMAIN,
    LAC_STREAM_SPREAD,
    LAC_STREAM_PROBE,
    LAC_STREAM_BOX_ORIGIN,
    LAC_STREAM_TEST,
    LAC_STREAM_SURFACE_LOWER,
    LAC_STREAM_PLACE,
    LAC_STREAM_BOOTSTRAP,
    LAC_STREAM_SURROGATE,
    LAC_STREAM_SAMPLER,
    LAC_STREAM_SWEEP, // new ones last, for the numbers of the others must stay
} lac_stream;

/// Four numbers of 64 bits from seed, stream and counter, in any order and on any thread:
/// Philox4x64-10 (Salmon et al. 2011, doi 10.1145/2063384.2063405).
void lac_random(uint64_t seed, uint64_t stream, uint64_t c0, uint64_t c1, uint64_t out[4]);

/// Uniform in (0, 1), never 0 or 1.
double lac_random_uniform(uint64_t seed, uint64_t stream, uint64_t c0, uint64_t c1);

/// Two independent standard normal numbers (Box-Muller).
void lac_random_normal(uint64_t seed, uint64_t stream, uint64_t c0, uint64_t c1, double out[2]);
