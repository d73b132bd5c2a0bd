/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

// What every file has without asking: C's everyday library, and how a function fails.

#include <errno.h>
#include <float.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/fail.h"
