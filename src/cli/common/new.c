// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna new [NAME]: writes a commented case of the wanted kind, for the user to start from, and
// the readings that it is about where it is to be fitted.
#define _GNU_SOURCE // asprintf
#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/words.h"
#include "data/json.h"

// NAME with this ending, ".yaml" unless it has one of its kind already; the caller frees.
static char *file_name(const char *name, const char *ending)
{
    const char *dot = strrchr(name, '.');
    const bool whole =
        dot != NULL && dot > name && (strcmp(dot, ".yaml") == 0 || strcmp(dot, ".yml") == 0);
    const int stem = (int)(whole ? (size_t)(dot - name) : strlen(name));
    const char *own = whole && strcmp(ending, ".yaml") == 0 ? dot : ending;
    char *path = NULL;
    return asprintf(&path, "%.*s%s", stem, name, own) >= 0 ? path : NULL;
}

static void tell(const cli_request *request, const char *kind, const char *path,
                 const char *readings)
{
    if (cli_given(request, CLI_OPT_JSON)) {
        lac_json json = {.out = stdout};
        lac_json_open(&json, NULL, '{');
        lac_json_text(&json, "output", path);
        lac_json_text(&json, "kind", kind);
        if (readings != NULL) {
            lac_json_text(&json, "readings", readings);
        }
        lac_json_close(&json, '}');
    } else if (readings != NULL) {
        printf("%s and %s written; next: lacuna fit %s %s\n", path, readings, path, readings);
    } else {
        printf("%s written; next: lacuna run %s\n", path, path);
    }
}

// A folder's name would make a hidden file in it: "." the file "..yaml". "-" means the standard
// output elsewhere, and a file of that name would be taken for an option.
static bool names_file(const char *given)
{
    const char *last = lac_path_last(given);
    return *last != '\0' && strcmp(last, ".") != 0 && strcmp(last, "..") != 0 &&
           strcmp(last, "-") != 0;
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
    const bool replace = cli_given(request, CLI_OPT_FORCE);
    const cli_named_text *about = cli_template_readings; // the readings that it is about, if any
    while (about->name != NULL && strcmp(about->name, chosen->name) != 0) {
        about++;
    }
    const char *rows = about->text;
    char *path = file_name(given, ".yaml"), *readings = file_name(given, ".csv");
    lac_status status = path != NULL && readings != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_TRY(status);
    LAC_TRY(rows != NULL ? lac_write_text(readings, rows, replace, err) : LAC_OK);
    status = lac_write_text(path, chosen->text, replace, err);
    if (status == LAC_OK) {
        tell(request, chosen->name, path, rows != NULL ? readings : NULL);
    } else if (rows != NULL && !replace) {
        (void)remove(readings);
    }
out:
    free(path);
    free(readings);
    return status;
}
