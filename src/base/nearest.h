/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/base.h"

/// The known word that takes the fewest letters added, dropped, changed or swapped.
/// @return NULL where none is near: more than a third of the letters differ
const char *lac_nearest(const char *word, const char *const *known, size_t count);
