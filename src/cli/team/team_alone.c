// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna: a program that is alone, and knows nothing of MPI.
#include "cli/team/team.h"

const char cli_team_help[] = "";

lac_status cli_team_join(lac_team **out, lac_error *err)
{
    (void)err;
    *out = NULL;
    return LAC_OK;
}

lac_status cli_team_end(lac_team *team, lac_status status, lac_error *err)
{
    (void)team, (void)err;
    return status;
}

void cli_team_leave(void) {}
