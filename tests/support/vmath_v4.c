// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/vmath_copies.h"

#define LAC_CLONES TEST_VMATH_TARGET("arch=x86-64-v4")
#define lac_vexp test_v4_vexp
#define lac_vexp_minus test_v4_vexp_minus
#define lac_vlog test_v4_vlog
#define lac_vasinh test_v4_vasinh
#include "base/vmath.c"
