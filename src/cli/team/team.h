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

/// What the command came to, with all: an error of one is that of all, for one to say.
lac_status cli_team_end(lac_team *team, lac_status status, lac_error *err);

/// The last that it does: takes leave of the others.
void cli_team_leave(void);
