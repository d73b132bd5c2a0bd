// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna new [NAME]: writes a commented case of the wanted kind, for the user to start from.
#include <stdlib.h>
#include <string.h>

#include "base/part.h"
#include "cli/common/command.h"
#include "cli/common/templates.h"
#include "cli/common/words.h"
#include "data/json.h"

static const cli_template *find_template(const char *kind, lac_error *err)
{
    const char *names[8];
    size_t n = 0;
    for (; n < 8 && cli_templates[n].kind != NULL; n++) {
        names[n] = cli_templates[n].kind;
        if (strcmp(names[n], kind) == 0) {
            return &cli_templates[n];
        }
    }
    (void)cli_unknown("--kind: ", kind, "kind of case", names, n, err);
    return NULL;
}

static bool ends_with(const char *text, const char *ending)
{
    size_t n = strlen(text), m = strlen(ending);
    return n > m && strcmp(text + n - m, ending) == 0;
}

// NAME, with .yaml where it has no such ending; the caller frees.
static char *file_name(const char *name)
{
    bool whole = ends_with(name, ".yaml") || ends_with(name, ".yml");
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
    const cli_template *chosen =
        find_template(request->kind != NULL ? request->kind : "joint", err);
    if (chosen == NULL) {
        return LAC_EINPUT;
    }
    const char *given = request->count > 0 ? request->argument[0] : "case";
    if (!names_file(given)) {
        return lac_fail(err, LAC_EINPUT, "\"%s\" is no name for a file", given);
    }
    char *path = file_name(given);
    if (path == NULL) {
        return lac_fail_memory(err);
    }
    lac_status status = lac_write_text(path, chosen->text, cli_given(request, CLI_OPT_FORCE), err);
    if (status == LAC_OK && cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        lac_json_open(&json, NULL, '{');
        lac_json_text(&json, "output", path);
        lac_json_text(&json, "kind", chosen->kind);
        lac_json_close(&json, '}');
    } else if (status == LAC_OK) {
        printf("%s written; next: lacuna run %s\n", path, path);
    }
    free(path);
    return status;
}
