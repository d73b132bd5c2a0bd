// SPDX-License-Identifier: GPL-3.0-or-later
// The file that a command writes: chosen and checked before the work, signed with what made it; and
// the files that a case reads.
#define _GNU_SOURCE // asprintf
#include "cli/common/output.h"

#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "cli/common/progress.h"
#include "lacuna/version.h"
#include "scene/scene.h"

char *cli_name_after(const char *path, const char *ending)
{
    const char *name = lac_path_last(path);
    const char *dot = strrchr(name, '.');
    const size_t stem = dot == NULL || dot == name ? strlen(name) : (size_t)(dot - name);
    char *made = NULL;
    return asprintf(&made, "%.*s%s", (int)stem, name, ending) >= 0 ? made : NULL;
}

size_t cli_stem(const char *name, const char *ending)
{
    const size_t length = strlen(name), of = strlen(ending);
    return length > of && strcmp(name + length - of, ending) == 0 ? length - of : length;
}

cli_request cli_request_anew(const cli_request *request, bool replaces)
{
    cli_request own = *request;
    own.given |= replaces && cli_given(request, CLI_OPT_RESUME) ? (unsigned)CLI_OPT_FORCE : 0U;
    own.given &= ~(unsigned)CLI_OPT_RESUME;
    return own;
}

static bool is_same(const char *path, const struct stat *file)
{
    struct stat one;
    return path != NULL && stat(path, &one) == 0 && one.st_dev == file->st_dev &&
           one.st_ino == file->st_ino;
}

// Whether --driver takes its column from a file: from FILE of FILE/COLUMN.
static bool is_driver(const char *driver, const struct stat *file)
{
    bool found = false;
    char *path = strdup(driver);
    for (char *slash = path != NULL ? strrchr(path, '/') : NULL; slash != NULL && !found;
         slash = strrchr(path, '/')) {
        *slash = '\0';
        found = is_same(path, file);
    }
    free(path);
    return found;
}

// Whether a command reads a file: one that its words name, the case, or one that the case names.
// @param c  NULL: the command reads no case
static bool is_read(const cli_request *request, const lac_case *c, const struct stat *file)
{
    const char *const named[] = {request->argument[0],
                                 request->argument[1],
                                 request->compare,
                                 request->sweep.table,
                                 request->fit,
                                 request->forecast.case_file,
                                 request->forecast.levels,
                                 c != NULL ? c->path : NULL};
    char **path;
    bool found = false;
    for (size_t i = 0; i < sizeof named / sizeof *named; i++) {
        found |= is_same(named[i], file);
    }
    for (size_t i = 0; i < request->files.n; i++) {
        found |= is_same(request->files.word[i], file);
    }
    for (size_t i = 0; i < request->drivers.n; i++) {
        found |= is_driver(request->drivers.word[i], file);
    }
    for (size_t i = 0; c != NULL && (path = lac_case_file(c, i)) != NULL; i++) {
        found |= is_same(*path, file);
    }
    return found;
}

// FNV-1a; 0 where the file cannot be read, which the run then says, or is a pipe, whose content
// would be gone.
static uint64_t sum_file(const char *path)
{
    struct stat info;
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode)) {
        return 0;
    }
    unsigned char block[1 << 14];
    uint64_t sum = LAC_SUM_OF_NOTHING;
    size_t got = 0;
    FILE *file = fopen(path, "rb");
    while (file != NULL && (got = fread(block, 1, sizeof block, file)) > 0) {
        sum = lac_sum_bytes(sum, block, got);
    }
    bool whole = file != NULL && ferror(file) == 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    return whole ? sum : 0;
}

char *cli_inputs_sums(const lac_case *c)
{
    char *sums = NULL, **path;
    size_t size = 0;
    FILE *text = open_memstream(&sums, &size);
    if (text == NULL) {
        return NULL;
    }
    for (size_t i = 0; (path = lac_case_file(c, i)) != NULL; i++) {
        (void)fprintf(text, "%s  %s: %016" PRIx64 "\n", i == 0 ? "files:\n" : "",
                      lac_path_last(*path), sum_file(*path));
    }
    return lac_text_made(text, &sums);
}

static uint64_t add(uint64_t sum, const char *text)
{
    return lac_sum_bytes(sum, text, strlen(text));
}

lac_status cli_case_sum(const cli_request *request, const lac_case *c, uint64_t *sum,
                        lac_error *err)
{
    char *text = lac_case_text(c), *files = cli_inputs_sums(c);
    const lac_status status = text == NULL || files == NULL ? lac_fail_memory(err) : LAC_OK;
    if (status == LAC_OK) {
        *sum = add(add(LAC_SUM_OF_NOTHING, text), files);
        *sum = add(add(*sum, LACUNA_VERSION), request->libraries);
    }
    free(text);
    free(files);
    return status;
}

static lac_status check_existing(const cli_request *request, const lac_case *c, const char *path,
                                 const struct stat *file, lac_error *err)
{
    LAC_FAIL_IF(S_ISDIR(file->st_mode), err, LAC_EIO, "%s: is a folder, cannot be written", path);
    if (!S_ISREG(file->st_mode)) { // said before the work, not after it
        return lac_fail(err, LAC_EIO, "%s: is not a regular file", path);
    }
    if (is_read(request, c, file)) { // --force must not destroy what the command reads
        return lac_fail(err, LAC_EINPUT, "%s: is read by this %s, must not be the output", path,
                        c != NULL ? "case" : "command");
    }
    LAC_FAIL_IF(!cli_given(request, CLI_OPT_FORCE | CLI_OPT_RESUME), err, LAC_EINPUT,
                "%s: exists already; --force replaces it, -o names another file", path);
    LAC_FAIL_IF(access(path, W_OK) != 0, err, LAC_EIO, "%s: %s", path, strerror(errno));
    return LAC_OK;
}

static lac_status check_folder(const char *path, lac_error *err)
{
    char *folder = strdup(path);
    LAC_FAIL_MEMORY_IF(folder == NULL, err);
    char *slash = strrchr(folder, '/');
    if (slash != NULL) {
        slash[slash == folder ? 1 : 0] = '\0';
    }
    int failed = access(slash == NULL ? "." : folder, W_OK | X_OK);
    free(folder);
    return failed == 0 ? LAC_OK : lac_fail(err, LAC_EIO, "%s: %s", path, strerror(errno));
}

lac_status cli_output_check(const cli_request *request, const lac_case *c, const char *path,
                            lac_error *err)
{
    struct stat file;
    cli_signals_writing(path);
    if (stat(path, &file) == 0) {
        return check_existing(request, c, path, &file, err);
    }
    LAC_FAIL_IF(errno != ENOENT, err, LAC_EIO, "%s: %s", path, strerror(errno));
    if (lstat(path, &file) == 0) { // said before the work, not after it
        return lac_fail(err, LAC_EIO, "%s: is a link to a file that does not exist", path);
    }
    return cli_given(request, CLI_OPT_RESUME)
               ? lac_fail(err, LAC_EIO, "--resume: %s: %s", path, strerror(errno))
               : check_folder(path, err);
}

lac_status cli_output_path(const cli_request *request, const lac_case *c, const char *configured,
                           const char *ending, char **path, lac_error *err)
{
    const char *given = request->output != NULL ? request->output : configured;
    *path = given != NULL ? strdup(given) : cli_name_after(c->path, ending);
    return *path != NULL ? cli_output_check(request, c, *path, err) : lac_fail_memory(err);
}

void cli_sign(const cli_request *request, lac_provenance *provenance)
{
    provenance->command_line = request->command_line;
    provenance->libraries = request->libraries;
    provenance->now = (double)time(NULL);
}

lac_provenance cli_provenance(const cli_request *request, const lac_case *c, const char *case_text)
{
    lac_provenance provenance = lac_case_provenance(c, case_text);
    cli_sign(request, &provenance);
    return provenance;
}

lac_status cli_store_dataset(const cli_request *request, const lac_case *c, int64_t seed,
                             const char *path, lac_dataset *dataset, lac_error *err)
{
    char *text = lac_case_text(c);
    LAC_FAIL_MEMORY_IF(text == NULL, err);
    lac_provenance provenance = cli_provenance(request, c, text);
    provenance.seed = seed != INT64_MIN ? seed : provenance.seed;
    const lac_status status = cli_put_dataset(request, cli_given(request, CLI_OPT_FORCE),
                                              &provenance, path, dataset, err);
    free(text);
    return status;
}

void cli_print_json(const lac_dataset *dataset, const char *path)
{
    lac_json json = {.out = stdout};
    lac_json_open(&json, NULL, '{');
    lac_dataset_json(dataset, &json);
    lac_json_number(&json, "cpu_time_s", cli_cpu_time());
    lac_json_text(&json, "output", path);
    lac_json_close(&json, '}');
}
