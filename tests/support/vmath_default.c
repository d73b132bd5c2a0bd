// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/vmath_copies.h"

#define LAC_CLONES
#define lac_vexp test_default_vexp
#define lac_vexp_minus test_default_vexp_minus
#define lac_vlog test_default_vlog
#define lac_vasinh test_default_vasinh
#include "base/vmath.c"
