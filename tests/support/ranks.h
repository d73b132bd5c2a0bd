/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/team.h"

/// Ranks that are threads of this process, so that a test needs no MPI: each does `body`, as
/// team->rank; returns when all have. 0 ranks: once, without a team.
/// @return bytes that they exchanged, those of a rank with itself left out
size_t ranks_do(int ranks, void (*body)(lac_team *team, void *context), void *context);
