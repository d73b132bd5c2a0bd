// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/vmath_copies.h"

size_t test_vmath_copies(test_vmath_copy copies[3])
{
    size_t count = 0;
    copies[count++] =
        (test_vmath_copy){"default", test_default_vexp, test_default_vlog, test_default_vasinh};
#if TEST_VMATH_HAS_TARGETS
    if (__builtin_cpu_supports("x86-64-v3")) {
        copies[count++] =
            (test_vmath_copy){"x86-64-v3", test_v3_vexp, test_v3_vlog, test_v3_vasinh};
    }
    if (__builtin_cpu_supports("x86-64-v4")) {
        copies[count++] =
            (test_vmath_copy){"x86-64-v4", test_v4_vexp, test_v4_vlog, test_v4_vasinh};
    }
#endif
    return count;
}
