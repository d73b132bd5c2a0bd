// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna new [NAME]: writes a commented case of the wanted kind, for the user to start from.
#include <stdlib.h>
#include <string.h>

#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/words.h"
#include "data/json.h"

// NAME, with .yaml where it has no such ending; the caller frees.
static char *file_name(const char *name)
{
    const char *ending = strrchr(name, '.');
    bool whole = ending != NULL && ending > name &&
                 (strcmp(ending, ".yaml") == 0 || strcmp(ending, ".yml") == 0);
    size_t size = strlen(name) + sizeof ".yaml";
    char *path = malloc(size);
    if (path != NULL) {
        (void)snprintf(path, size, "%s%s", name, whole ? "" : ".yaml");
    }
    return path;
}

// A folder's name would make a hidden file in it: "." the file "..yaml".
static bool names_file(const char *given)
{
    const char *slash = strrchr(given, '/');
    const char *last = slash != NULL ? slash + 1 : given;
    return *last != '\0' && strcmp(last, ".") != 0 && strcmp(last, "..") != 0;
}

lac_status cli_new(const cli_request *request, lac_error *err)
{
    const cli_named_text *chosen =
        cli_find("--kind: ", request->kind != NULL ? request->kind : "joint", "kind of case",
                 cli_templates, sizeof *cli_templates, err);
    if (chosen == NULL) {
        return LAC_EINPUT;
    }
    const char *given = request->count > 0 ? request->argument[0] : "case";
    LAC_FAIL_IF(!names_file(given), err, LAC_EINPUT, "\"%s\" is no name for a file", given);
    char *path = file_name(given);
    LAC_FAIL_MEMORY_IF(path == NULL, err);
    lac_status status = lac_write_text(path, chosen->text, cli_given(request, CLI_OPT_FORCE), err);
    if (status == LAC_OK && cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        LAC_JSON_TEXTS(&json, "output", path, "kind", chosen->name);
    } else if (status == LAC_OK) {
        printf("%s written; next: lacuna run %s\n", path, path);
    }
    free(path);
    return status;
}
