/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef LACUNA_TESTS_SCRATCH_GROUP_H
#define LACUNA_TESTS_SCRATCH_GROUP_H

#include "support/scratch.h"

/// The folder of a test program, and what sets up and tears down its group of tests.
static scratch folder;

static int open_scratch(void **state)
{
    (void)state;
    scratch_create(&folder);
    return 0;
}

static int close_scratch(void **state)
{
    (void)state;
    scratch_remove(&folder);
    return 0;
}

#endif
