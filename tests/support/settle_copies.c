// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/settle_copies.h"

size_t test_settle_copies(test_settle *copies[3])
{
    size_t n = 0;
    copies[n++] = test_default_settle;
#if TEST_VMATH_HAS_TARGETS
    if (__builtin_cpu_supports("x86-64-v3")) {
        copies[n++] = test_v3_settle;
    }
    if (__builtin_cpu_supports("x86-64-v4")) {
        copies[n++] = test_v4_settle;
    }
#endif
    return n;
}
