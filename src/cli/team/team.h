/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once

#include "base/team.h"

/// The processes that this one was started with, all of which do the same command; only the one
/// that leads is heard from then on. NULL: it is alone, as lacuna always is, and lacuna-mpi on one
/// rank.
/// @return LAC_OK; LAC_EINPUT: there are more than LAC_TEAM_MOST
lac_status cli_team_join(lac_team **out, lac_error *err);

/// What --help says of ranks.
extern const char cli_team_help[];

/// The last that it does: takes leave of the others. Where it alone has run out of memory, and they
/// wait for it, all end.
/// @param exit_status  of the program
void cli_team_leave(lac_team *team, lac_status status, const lac_error *err, int exit_status);
