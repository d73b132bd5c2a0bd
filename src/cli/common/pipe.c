// SPDX-License-Identifier: GPL-3.0-or-later
// --pipe: a dataset on standard output with all that its file would say of it, for programs; what
// else the command would print is dropped. docs/format.md.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "cli/common/output.h"
#include "data/dataset.h"
#include "data/json.h"

// A line that is being written, and what was told for it.
typedef struct line {
    lac_json json;
    bool numbers; // they follow the line
} line;

// No file is written: -o is a folder, and what a command keeps while it works is kept in there.
static lac_status place_work(cli_request *request, lac_error *err)
{
    struct stat info;
    if (request->output == NULL) {
        return LAC_OK;
    }
    LAC_FAIL_IF(stat(request->output, &info) != 0 || !S_ISDIR(info.st_mode), err, LAC_EINPUT,
                "--pipe: writes no file, so -o must be a folder, for what is kept meanwhile: %s is "
                "none",
                request->output);
    request->work = lac_text_join(request->output, "/", "result.nc");
    LAC_FAIL_MEMORY_IF(request->work == NULL, err);
    request->output = request->work;
    return LAC_OK;
}

lac_status cli_pipe_open(cli_request *request, lac_error *err)
{
    LAC_TRY_RETURN(place_work(request, err));
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    request->pipe = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    const bool good = nowhere >= 0 && request->pipe >= 0 && dup2(nowhere, STDOUT_FILENO) >= 0;
    if (nowhere >= 0) {
        (void)close(nowhere);
    }
    return good ? LAC_OK : lac_fail(err, LAC_EIO, "--pipe: %s", strerror(errno));
}

static void tell(void *context, const char *name, const char *text, size_t n, const double *number,
                 bool whole)
{
    line *l = context;
    l->numbers = l->numbers || (name == NULL && strcmp(text, "attribute") != 0);
    lac_json_open(&l->json, NULL, '[');
    lac_json_text(&l->json, NULL, name);
    if (n == 0) {
        lac_json_text(&l->json, NULL, text);
    } else {
        lac_json_boolean(&l->json, NULL, whole);
    }
    for (size_t i = 0; i < n; i++) {
        lac_json_number(&l->json, NULL, number[i]);
    }
    lac_json_close(&l->json, ']');
}

static void put_texts(line *l, const lac_item *item)
{
    char room[LAC_TEXT_ROOM];
    lac_json_open(&l->json, NULL, '[');
    for (size_t i = 0; i < item->count; i++) {
        const char *text = lac_item_text(item, i, room);
        lac_json_text(&l->json, NULL, text != NULL ? text : "");
    }
    lac_json_close(&l->json, ']');
}

// [name, {dimension: length}, its texts or null, [null, type], [attribute, text], [attribute,
// whether whole, numbers ...] ...], then its numbers.
static lac_status put_variable(FILE *out, const lac_dataset *dataset, const lac_item *item,
                               lac_error *err)
{
    line l = {.json = {.out = out, .line = true}};
    lac_json_open(&l.json, NULL, '[');
    lac_json_text(&l.json, NULL, item != NULL ? item->name : NULL);
    lac_json_open(&l.json, NULL, '{');
    for (size_t d = 0; item != NULL && d < item->rank; d++) {
        lac_json_integer(&l.json, item->dim[d], (int64_t)item->length[d]);
    }
    lac_json_close(&l.json, '}');
    if (item != NULL && item->is_text) {
        put_texts(&l, item);
    } else {
        lac_json_null(&l.json, NULL);
    }
    LAC_TRY_RETURN(lac_dataset_tell(dataset, item != NULL ? item->name : NULL, tell, &l, err));
    lac_json_close(&l.json, ']');
    if (!l.numbers || item->is_text) {
        return LAC_OK;
    }
    double *values = malloc((item->count + 1) * sizeof *values);
    LAC_FAIL_MEMORY_IF(values == NULL, err);
    lac_item_values(item, values);
    (void)fwrite(values, sizeof *values, item->count, out);
    free(values);
    return LAC_OK;
}

lac_status cli_put_dataset(const cli_request *request, bool force, const lac_provenance *made,
                           const char *path, lac_dataset *dataset, lac_error *err)
{
    if (request->pipe == 0) {
        return lac_store_dataset(path, force, made, dataset, err);
    }
    lac_provenance own = *made;
    own.command_line = NULL; // that of a file
    dataset->made = &own;
    errno = 0;
    FILE *out = fdopen(request->pipe, "wb");
    LAC_FAIL_IF(out == NULL, err, LAC_EIO, "--pipe: %s", strerror(errno));
    lac_item item = {0};
    lac_status status = put_variable(out, dataset, NULL, err);
    while (status == LAC_OK && lac_dataset_next(dataset, &item)) {
        status = put_variable(out, dataset, &item, err);
    }
    const bool whole = ferror(out) == 0;
    dataset->made = NULL;
    LAC_FAIL_IF((fclose(out) != 0 || !whole) && status == LAC_OK, err, LAC_EIO,
                "standard output: %s", errno != 0 ? strerror(errno) : "could not be written");
    return status;
}
