// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers by Philox: each follows from seed and counter alone, in any order and thread.
#include "base/rng.h"

#include <Random123/philox.h>

void lac_random(uint64_t seed, uint64_t stream, uint64_t c0, uint64_t c1, uint64_t out[4])
{
    philox4x64_key_t key = {{seed, stream}};
    philox4x64_ctr_t counter = {{c0, c1, 0, 0}};
    philox4x64_ctr_t numbers = philox4x64(counter, key);
    memcpy(out, numbers.v, sizeof numbers.v);
}

// 53 bits and a half: (k + 1/2) 2^-53 lies strictly between 0 and 1.
static double uniform(uint64_t bits) { return ((double)(bits >> 11) + 0.5) * 0x1p-53; }

double lac_random_uniform(uint64_t seed, uint64_t stream, uint64_t c0, uint64_t c1)
{
    uint64_t bits[4];
    lac_random(seed, stream, c0, c1, bits);
    return uniform(bits[0]);
}

void lac_random_normal(uint64_t seed, uint64_t stream, uint64_t c0, uint64_t c1, double out[2])
{
    uint64_t bits[4];
    lac_random(seed, stream, c0, c1, bits);
    double radius = sqrt(-2.0 * log(uniform(bits[0])));
    double angle = 2.0 * M_PI * uniform(bits[1]);
    out[0] = radius * cos(angle);
    out[1] = radius * sin(angle);
}
