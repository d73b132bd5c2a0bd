// SPDX-License-Identifier: GPL-3.0-or-later
// --keep-fields: the runs of some members of a sweep, each as a file of its own.
#define _GNU_SOURCE // asprintf
#include "cli/sweep/kept_runs.h"

#include <unistd.h>

#include "cli/common/output.h"
#include "sweep/ensemble.h"

// "0, 7, 20:30"; "" behind the last.
static bool read_range(const char **at, size_t range[2])
{
    for (size_t k = 0; k < 2; k++) {
        char *end = NULL;
        *at += strspn(*at, " ");
        if (**at < '0' || **at > '9') {
            return false;
        }
        range[k] = range[1] = strtoull(*at, &end, 10);
        *at = end + strspn(end, " ");
        if (k == 0 && **at != ':') {
            break;
        }
        *at += k == 0 ? 1 : 0;
    }
    const bool more = **at == ',';
    *at += more ? 1 : 0;
    return range[0] <= range[1] && (more || **at == '\0');
}

lac_status cli_kept_runs_read(const lac_sweep *sweep, cli_kept_runs *runs, lac_error *err)
{
    const char *text = runs->request->sweep.keep, *at = text;
    size_t range[2];
    if (text == NULL) {
        return LAC_OK;
    }
    LAC_FAIL_IF(sweep->base->fields == 0, err, LAC_EINPUT,
                "--keep-fields: the case keeps no fields: output.fields names them");
    runs->wanted = calloc(runs->n + 1, sizeof *runs->wanted);
    LAC_FAIL_MEMORY_IF(runs->wanted == NULL, err);
    while (*at != '\0') {
        LAC_FAIL_IF(!read_range(&at, range) || range[1] >= sweep->members, err, LAC_EINPUT,
                    "--keep-fields: \"%.40s\" must be members from 0 to %zu, such as 0, 7, 20:30",
                    text, sweep->members - 1);
        for (size_t k = 0; k < runs->n; k++) {
            const size_t member = runs->first + k * runs->stride;
            runs->wanted[k] = runs->wanted[k] || (member >= range[0] && member <= range[1]);
        }
    }
    return LAC_OK;
}

static char *path_of(const cli_kept_runs *runs, size_t task)
{
    char *path = NULL;
    const int length = asprintf(&path, "%.*s-member-%zu.nc", (int)cli_stem(runs->path, ".nc"),
                                runs->path, runs->first + task * runs->stride);
    return length >= 0 ? path : NULL;
}

static bool wants(const cli_kept_runs *runs, size_t task)
{
    return runs->wanted != NULL && runs->wanted[task];
}

lac_status cli_kept_runs_check(const cli_kept_runs *runs, const lac_sweep *sweep, lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t k = 0; k < runs->n && status == LAC_OK; k++) {
        if (wants(runs, k)) {
            char *path = path_of(runs, k);
            status = path != NULL ? cli_output_check(runs->request, sweep->base, path, err)
                                  : lac_fail_memory(err);
            free(path);
        }
    }
    return status;
}

bool cli_kept_runs_lacks(const cli_kept_runs *runs, size_t task)
{
    char *path = wants(runs, task) ? path_of(runs, task) : NULL;
    const bool lacks = path != NULL && access(path, F_OK) != 0;
    free(path);
    return lacks;
}

lac_status cli_kept_runs_write(const cli_kept_runs *runs, lac_sweep *sweep, size_t task,
                               lac_error *err)
{
    lac_write_options how = lac_write_options_default();
    how.force = true; // what may be replaced was seen before
    how.command_line = runs->request->command_line;
    how.libraries = runs->request->libraries;
    if (!wants(runs, task)) {
        return LAC_OK;
    }
    char *path = path_of(runs, task);
    LAC_FAIL_MEMORY_IF(path == NULL, err);
    const lac_status status =
        lac_member_write(sweep, runs->first + task * runs->stride, path, &how, err);
    free(path);
    return status;
}
