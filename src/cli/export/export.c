// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna export FILE.nc: what a file holds as tables, one for each set of dimensions.
#define _GNU_SOURCE // asprintf
#include <sys/stat.h>

#include "base/temp_file.h"
#include "cli/common/command.h"
#include "cli/common/output.h"
#include "cli/common/words.h"
#include "cli/export/export.h"

enum { LONGEST_TEXT = 1 << 20 };         // of an attribute: a case
static const size_t most_rows = 1048576; // that a spreadsheet takes

// The command, from its file to where its tables go.
typedef struct export_job {
    const cli_request *request;
    lac_stored_file *file;
    cli_tables of;
    cli_stations stations; // with --stations
    char *folder;          // owned; NULL: one table, to a file or stdout
    lac_json json;
} export_job;

static bool has_dim(const lac_stored_shape *shape, const char *name)
{
    for (size_t d = 0; d < shape->rank; d++) {
        if (strcmp(shape->dim[d].name, name) == 0) {
            return true;
        }
    }
    return false;
}

// Values over the cells at several times, or over a map: too many for a spreadsheet.
static bool is_field(const lac_stored_shape *shape)
{
    return (has_dim(shape, "y") && has_dim(shape, "x")) ||
           (shape->rank > 1 && has_dim(shape, "cell"));
}

static lac_status read_variables(cli_tables *e, lac_error *err)
{
    char name[LAC_STORED_NAME];
    size_t n = 0;
    while (lac_stored_file_variable(e->file, n, name, sizeof name)) {
        n++;
    }
    e->variable = calloc(n + 1, sizeof *e->variable);
    LAC_FAIL_MEMORY_IF(e->variable == NULL, err);
    for (; e->count < n; e->count++) {
        cli_variable *v = &e->variable[e->count];
        (void)lac_stored_file_variable(e->file, e->count, v->name, sizeof v->name);
        LAC_TRY_RETURN(lac_stored_file_shape(e->file, v->name, &v->shape, err));
    }
    return LAC_OK;
}

static lac_status pick(const cli_request *request, cli_tables *e, lac_error *err)
{
    LAC_FAIL_IF(request->stations != NULL && (request->csv != NULL || request->variables.n > 0),
                err, LAC_EINPUT, "--stations: goes without --csv and --variable");
    for (size_t i = 0; i < e->count && request->variables.n == 0; i++) {
        e->variable[i].wanted = !is_field(&e->variable[i].shape);
    }
    const char **names = malloc((e->count + 1) * sizeof *names);
    LAC_FAIL_MEMORY_IF(names == NULL, err);
    lac_status status = LAC_OK;
    for (size_t k = 0; status == LAC_OK && k < request->variables.n; k++) {
        bool found = false;
        for (size_t i = 0; i < e->count; i++) {
            const bool same = strcmp(e->variable[i].name, request->variables.word[k]) == 0;
            e->variable[i].wanted = e->variable[i].wanted || same;
            found = found || same;
            names[i] = e->variable[i].name;
        }
        status = found ? LAC_OK
                       : cli_unknown("--variable: ", request->variables.word[k],
                                     "variable of the file", names, e->count, err);
    }
    free((void *)names);
    return status;
}

// Whether a wanted variable is the first of its table.
static bool leads(const cli_tables *e, size_t i)
{
    for (size_t k = 0; k < i; k++) {
        if (e->variable[k].wanted &&
            cli_export_share(&e->variable[k].shape, &e->variable[i].shape)) {
            return false;
        }
    }
    return e->variable[i].wanted;
}

static bool is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

// One table and no folder named: a file or stdout. Else -o, or a folder called after the file.
static lac_status find_folder(export_job *job, lac_error *err)
{
    const char *output = job->request->output, *name = lac_path_last(job->request->argument[0]);
    const size_t written = output != NULL ? strlen(output) : 0;
    const bool named = written > 0 && (output[written - 1] == '/' || is_folder(output));
    const bool stations = job->request->stations != NULL;
    size_t tables = job->stations.count;
    for (size_t i = 0; !stations && i < job->of.count; i++) {
        tables += leads(&job->of, i) ? 1 : 0;
    }
    LAC_FAIL_IF(tables == 0, err, LAC_EINPUT, "%s: holds no table, only fields over the cells",
                job->request->argument[0]);
    if (tables == 1 && job->request->variables.n > 0 && !named) {
        return LAC_OK;
    }
    LAC_FAIL_IF(!stations && written > 0 && cli_stem(output, ".csv") < written, err, LAC_EINPUT,
                "-o %s: these are %zu tables: name a folder, or pick one by --variable", output,
                tables + (job->request->variables.n == 0));
    const int bare = written > 1 && output[written - 1] == '/' ? (int)written - 1 : (int)written;
    const int good = output != NULL ? asprintf(&job->folder, "%.*s", bare, output)
                                    : asprintf(&job->folder, "%.*s-%s", (int)cli_stem(name, ".nc"),
                                               name, stations ? "stations" : "tables");
    if (good < 0) {
        job->folder = NULL;
        return lac_fail_memory(err);
    }
    LAC_FAIL_IF(!is_folder(job->folder) && mkdir(job->folder, 0777) != 0, err, LAC_EIO,
                "%s: cannot make the folder: %s", job->folder, strerror(errno));
    return LAC_OK;
}

// FOLDER/issue-method.csv; of single values FOLDER/values.csv. To be freed.
static char *path_of(const export_job *job, const lac_stored_shape *shape)
{
    char name[(LAC_STORED_NAME + 1) * LAC_STORED_RANK] = "";
    char *path = NULL;
    for (size_t d = 0; d < shape->rank; d++) {
        lac_append(name, sizeof name, "%s%s", d > 0 ? "-" : "", shape->dim[d].name);
    }
    if (job->folder == NULL) {
        return strdup(job->request->output);
    }
    return asprintf(&path, "%s/%s.csv", job->folder, name[0] != '\0' ? name : "values") >= 0 ? path
                                                                                             : NULL;
}

// To a file of its own, once it is whole in memory. @param out  closed here
static lac_status put(export_job *job, FILE *out, char **text, const char *path, size_t rows,
                      size_t columns, lac_error *err)
{
    LAC_FAIL_IF(fclose(out) != 0 || path == NULL, err, LAC_ENOMEM, "out of memory");
    LAC_TRY_RETURN(cli_output_check(job->request, NULL, path, err));
    LAC_TRY_RETURN(lac_write_text(path, *text, cli_given(job->request, CLI_OPT_FORCE), err));
    if (cli_given(job->request, CLI_OPT_JSON)) {
        lac_json_open(&job->json, NULL, '{');
        lac_json_text(&job->json, "path", path);
        lac_json_integer(&job->json, "rows", (int64_t)rows);
        lac_json_integer(&job->json, "columns", (int64_t)columns);
        lac_json_close(&job->json, '}');
    } else {
        cli_row("table", "%s: %zu rows of %zu columns", path, rows, columns);
    }
    if (rows >= most_rows && !cli_given(job->request, CLI_OPT_QUIET)) {
        cli_note("warning: %s: has more rows than the %zu that a spreadsheet takes", path,
                 most_rows);
    }
    return LAC_OK;
}

// Writes the table of a shape, or with NULL that of the attributes.
static lac_status write_table(export_job *job, const lac_stored_shape *shape, lac_error *err)
{
    char *path = NULL, *text = NULL, *room = NULL;
    size_t size = 0, columns = 2, rows = 0;
    FILE *out = open_memstream(&text, &size);
    lac_status status;
    LAC_TRY(out != NULL ? LAC_OK : lac_fail_memory(err));
    if (shape != NULL) {
        LAC_TRY(cli_export_write(&job->of, shape, out, &columns, err));
        rows = shape->count;
        path = path_of(job, shape);
    } else {
        room = malloc(LONGEST_TEXT);
        LAC_TRY(room != NULL ? LAC_OK : lac_fail_memory(err));
        cli_export_attributes(&job->of, out, room, LONGEST_TEXT);
        char name[LAC_STORED_NAME];
        while (lac_stored_file_attribute(job->file, NULL, rows, name, sizeof name)) {
            rows++;
        }
        path = lac_text_join(job->folder, "/", "attributes.csv");
    }
    status = put(job, out, &text, path, rows, columns, err);
    out = NULL;
out:
    if (out != NULL) {
        (void)fclose(out);
    }
    free(text);
    free(room);
    free(path);
    return status;
}

static lac_status write_station(export_job *job, size_t which, lac_error *err)
{
    const cli_stations *s = &job->stations;
    char *path = NULL, *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    LAC_FAIL_MEMORY_IF(out == NULL, err);
    cli_stations_write(&job->of, s, which, out);
    if (asprintf(&path, "%s/%s.dat", job->folder, s->name[which]) < 0) {
        path = NULL;
    }
    const lac_status status = put(job, out, &text, path, s->value[0].n, 5, err);
    free(text);
    free(path);
    return status;
}

static void tell_fields(export_job *job)
{
    const bool json = cli_given(job->request, CLI_OPT_JSON);
    const char *first = NULL;
    size_t n = 0;
    for (size_t i = 0; i < job->of.count; i++) {
        if (is_field(&job->of.variable[i].shape) && !job->of.variable[i].wanted) {
            first = first == NULL ? job->of.variable[i].name : first;
            n++;
            if (json) {
                lac_json_text(&job->json, NULL, job->of.variable[i].name);
            }
        }
    }
    if (n > 0 && !json && job->request->variables.n == 0) {
        cli_row("left out", "%zu fields over the cells; to write one: --variable %s", n, first);
    }
}

static lac_status write_all(export_job *job, lac_error *err)
{
    const bool json = cli_given(job->request, CLI_OPT_JSON);
    if (json) {
        lac_json_open(&job->json, NULL, '{');
        lac_json_text(&job->json, "file", job->request->argument[0]);
        lac_json_open(&job->json, "tables", '[');
    }
    const bool stations = job->request->stations != NULL;
    for (size_t i = 0; i < job->stations.count; i++) {
        LAC_TRY_RETURN(write_station(job, i, err));
    }
    for (size_t i = 0; !stations && i < job->of.count; i++) {
        if (leads(&job->of, i)) {
            LAC_TRY_RETURN(write_table(job, &job->of.variable[i].shape, err));
        }
    }
    if (!stations && job->request->variables.n == 0) {
        LAC_TRY_RETURN(write_table(job, NULL, err));
    }
    if (json) {
        lac_json_close(&job->json, ']');
        lac_json_open(&job->json, "left_out", '[');
    }
    if (!stations) {
        tell_fields(job);
    }
    if (json) {
        lac_json_close(&job->json, ']');
        lac_json_close(&job->json, '}');
    }
    return LAC_OK;
}

lac_status cli_export(const cli_request *request, lac_error *err)
{
    export_job job = {.request = request, .json = {.out = stdout}};
    lac_status status;
    LAC_TRY(lac_stored_file_open(request->argument[0], &job.file, err));
    job.of.file = job.file;
    LAC_TRY(read_variables(&job.of, err));
    LAC_TRY(pick(request, &job.of, err));
    if (request->stations != NULL) {
        LAC_TRY(cli_stations_read(&job.of, &job.stations, err));
    }
    LAC_TRY(find_folder(&job, err));
    if (job.folder != NULL || request->output != NULL) {
        LAC_TRY(write_all(&job, err));
        goto out;
    }
    LAC_LEAVE_IF(cli_given(request, CLI_OPT_JSON), err, LAC_EINPUT,
                 "--json tells which files were written: name one with -o");
    size_t columns = 0, first = 0;
    while (!leads(&job.of, first)) {
        first++;
    }
    LAC_TRY(cli_export_write(&job.of, &job.of.variable[first].shape, stdout, &columns, err));
out:
    cli_stations_clear(&job.stations);
    free(job.folder);
    free(job.of.variable);
    lac_stored_file_close(job.file);
    return status;
}
