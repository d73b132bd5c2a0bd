// SPDX-License-Identifier: GPL-3.0-or-later
// The files of a fit: netCDF, and the fitted case; its JSON.
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hidden.h"
#include "base/part.h"
#include "cli/common/output.h"
#include "cli/fit/fit.h"
#include "cli/precursors/series.h"
#include "cli/run/run_outcome.h"
#include "data/dataset.h"

lac_status cli_fit_store(const cli_request *request, const cli_fit_view *view, lac_error *err)
{
    lac_dataset *dataset = NULL;
    lac_status status = lac_fit_describe(&view->outcome, &dataset, err);
    if (status == LAC_OK) {
        const lac_case *source = view->outcome.source;
        status = cli_store_dataset(request, source, source->fit.seed, view->output, dataset, err);
    }
    lac_dataset_free(dataset);
    return status;
}

lac_status cli_fit_json(const cli_fit_view *view, lac_error *err)
{
    lac_json json = {.out = stdout};
    lac_dataset *dataset = NULL;
    lac_status status = lac_fit_describe(&view->outcome, &dataset, err);
    if (status != LAC_OK) {
        return status;
    }
    lac_json_open(&json, NULL, '{');
    cli_series_warnings(&json, view->readings);
    lac_dataset_json(dataset, &json);
    lac_json_number(&json, "wall_time_s", view->wall_time);
    lac_json_number(&json, "cpu_time_s", cli_cpu_time());
    lac_json_text(&json, "output", view->output);
    lac_json_text(&json, "case_output", view->case_output);
    lac_json_close(&json, '}');
    lac_dataset_free(dataset);
    return LAC_OK;
}

// Files of the case named so that they are found from the folder that the fitted case stands in.
static lac_status move_case(const char *path, lac_case *c, lac_error *err)
{
    char folder[PATH_MAX + 1];
    char *name = strdup(path);
    if (name == NULL) {
        return lac_fail_memory(err);
    }
    free(c->path);
    c->path = name;
    free(c->output_file); // the original's, which a run of this one must not write
    c->output_file = NULL;
    if (strchr(path, '/') == NULL) {
        return LAC_OK;
    }
    if (getcwd(folder, sizeof folder - 1) == NULL) {
        return lac_fail(err, LAC_EIO, "the working folder has no name: %s", strerror(errno));
    }
    size_t n = strlen(folder);
    folder[n] = '/';
    folder[n + 1] = '\0';
    return lac_case_rebase(c, folder, err);
}

static lac_status write_whole(const char *path, const char *head, const char *text, lac_error *err)
{
    const size_t size = strlen(head) + strlen(text) + sizeof "\n";
    char *whole = malloc(size);
    if (whole == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(whole, size, "%s\n%s", head, text);
    const lac_status status = lac_write_text(path, whole, true, err); // asked for before the fit
    free(whole);
    return status;
}

// Whether YAML takes the character of so many bytes in the line of a comment.
static bool is_plain(const unsigned char *s, size_t length)
{
    const bool none = length == 3 && memcmp(s, "\xef\xbf", 2) == 0 && s[2] >= 0xbe; // of Unicode
    const bool plain = length > 1 ? !none && lac_hidden_length((const char *)s, length) == 0
                                  : length == 1 && *s >= 0x20 && *s < 0x7f;
    return plain;
}

// A file's name may hold what would end the comment: '?' instead.
static void make_plain(char *text)
{
    for (unsigned char *s = (unsigned char *)text; *s != '\0';) {
        const size_t length = lac_utf8_length(s);
        const size_t step = length > 0 ? length : 1;
        if (!is_plain(s, length)) {
            memset(s, '?', step);
        }
        s += step;
    }
}

lac_status cli_fit_write_case(const cli_fit_view *view, lac_case *c, lac_error *err)
{
    char head[4 * PATH_MAX];
    lac_fit_apply(view->outcome.result, c);
    lac_status status = move_case(view->case_output, c, err);
    if (status != LAC_OK) {
        return status;
    }
    char *text = lac_case_text(c);
    if (text == NULL) {
        return lac_fail_memory(err);
    }
    (void)snprintf(head, sizeof head,
                   "# %s fitted to %s by lacuna fit: the best fit; its uncertainty is in %s",
                   view->outcome.source->path, view->series, view->output);
    make_plain(head);
    status = write_whole(view->case_output, head, text, err);
    free(text);
    return status;
}
