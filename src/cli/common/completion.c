// SPDX-License-Identifier: GPL-3.0-or-later
// The scripts that shells read: each asks the program (complete.c) what may stand at the cursor,
// and completes names of files itself. Bash cuts words at = and :, so what it is told begins behind
// those.
#include "cli/common/command.h"
#include "cli/common/texts.h"
#include "cli/common/words.h"
#include "data/json.h"

lac_status cli_completion(const cli_request *request, lac_error *err)
{
    const cli_named_text *shell = cli_find("completion: ", request->argument[0], "shell",
                                           cli_shells, sizeof *cli_shells, err);
    if (shell == NULL) {
        return LAC_EINPUT;
    }
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        LAC_JSON_TEXTS(&json, "shell", shell->name, "script", shell->text);
    } else {
        (void)fputs(shell->text, stdout);
    }
    return LAC_OK;
}
