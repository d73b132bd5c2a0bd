// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna mend FILE.nc: repairs a file whose writer was stopped, from its journal if it has one.
#include "cli/common/command.h"
#include "cli/common/words.h"
#include "store/store_file.h"

lac_status cli_mend(const cli_request *request, lac_error *err)
{
    const char *path = request->argument[0];
    char word[32] = "";
    bool mended = false;
    lac_store_loss loss;
    const bool damaged = lac_store_is_damaged(path, &loss);
    lac_status status = lac_store_mend(path, &mended, err);
    if (status != LAC_OK) {
        return status;
    }
    if (damaged && !cli_given(request, CLI_OPT_QUIET)) {
        cli_note("warning: %s.journal: is damaged: its last %" PRIu64 " bytes, from byte %" PRIu64
                 " on, cannot be read; %s may lack what was synced; its journal is kept",
                 path, loss.unread, loss.at, path);
    }
    // Not every file of Lacuna says how it ended.
    if (lac_store_read_attribute(path, "status", word, sizeof word, NULL) != LAC_OK) {
        word[0] = '\0';
    }
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        lac_json_open(&json, NULL, '{');
        lac_json_text(&json, "file", path);
        lac_json_boolean(&json, "mended", mended);
        lac_json_text(&json, "status", word);
        lac_json_close(&json, '}');
    } else if (!cli_given(request, CLI_OPT_QUIET)) {
        printf("%s: %s%s%s%s\n", path, mended ? "mended" : "is whole, nothing to mend",
               word[0] != '\0' ? " (" : "", word, word[0] != '\0' ? ")" : "");
    }
    return LAC_OK;
}
