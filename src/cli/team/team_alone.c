// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna: a program that is alone, and knows nothing of MPI.
#include "cli/team/team.h"

const char cli_team_help[] = "";

lac_status cli_team_join(int (*exit_status)(lac_status status),
                         void (*remedy)(char *out, size_t room), void (*hush)(bool parent),
                         lac_team **out, lac_error *err)
{
    (void)exit_status, (void)remedy, (void)hush, (void)err;
    *out = NULL;
    return LAC_OK;
}

lac_status cli_team_end(lac_team *team, lac_status status, lac_error *err)
{
    (void)team, (void)err;
    return status;
}

void cli_team_leave(lac_team *team) { (void)team; }
