// SPDX-License-Identifier: GPL-3.0-or-later
// What is done so far, in a folder beside the output until that is written.
#include "cli/common/keep.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/archive.h"
#include "cli/common/progress.h"

enum { HEADING = 128 };

// Before the content of a record.
typedef struct label {
    uint64_t key, sum; // sum: of the key and the content
} label;

// The first line of `done`; @return how much of it says whose it is
static size_t heading(const cli_keep *keep, char text[HEADING])
{
    const int whose = snprintf(text, HEADING, "lacuna %s: ", keep->command);
    (void)snprintf(text + whose, (size_t)(HEADING - whose), "records of %zu, %016" PRIx64 "\n",
                   keep->size, keep->mark);
    return (size_t)whose;
}

static uint64_t sum(const cli_keep *keep, uint64_t key, const void *content)
{
    return lac_sum_bytes(lac_sum_bytes(LAC_SUM_OF_NOTHING, &key, sizeof key), content, keep->size);
}

// Whether a command gives a file this name: of a run, while it is made, and what stands beside it.
static bool is_of_run(const char *name)
{
    static const char *const endings[] = {".checkpoint", ".journal", ".lacuna-", ".mended.lacuna-"};
    int n = 0;
    name += *name == '.';
    (void)sscanf(name, "run-%*[0-9].nc%n", &n);
    bool fits = n > 0 && name[n] == '\0';
    for (size_t i = 0; n > 0 && i < sizeof endings / sizeof endings[0]; i++) {
        fits |= strncmp(name + n, endings[i], strlen(endings[i])) == 0;
    }
    return fits;
}

// Removes what is put there, nothing else.
static void clean(const char *folder, bool done_too)
{
    DIR *files = opendir(folder);
    const struct dirent *file;
    while (files != NULL && (file = readdir(files)) != NULL) {
        if (is_of_run(file->d_name) || (done_too && strcmp(file->d_name, "done") == 0)) {
            (void)unlinkat(dirfd(files), file->d_name, 0);
        }
    }
    if (files != NULL) {
        (void)closedir(files);
    }
}

// Whether `done` is this command's, or as far as its first line got.
static bool is_done_ours(const cli_keep *keep, int folder)
{
    char ours[HEADING], begins[HEADING] = "";
    struct stat info;
    const size_t whose = heading(keep, ours);
    int fd = openat(folder, "done", O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const ssize_t n =
        fstat(fd, &info) == 0 && S_ISREG(info.st_mode) ? pread(fd, begins, whose, 0) : -1;
    (void)close(fd);
    return n >= 0 && strncmp(begins, ours, (size_t)n) == 0;
}

// A folder that was there: all in it must be this command's, since it is taken away in the end.
static lac_status check_folder(const cli_keep *keep, bool resume, lac_error *err)
{
    int fd = open(keep->folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    DIR *files = fd >= 0 ? fdopendir(fd) : NULL;
    LAC_FAIL_IF(files == NULL, err, LAC_EIO, "%s%s: %s", resume ? "--resume: " : "", keep->folder,
                strerror(errno));
    lac_status status = LAC_OK;
    const bool ours = is_done_ours(keep, fd);
    const struct dirent *file;
    while (status == LAC_OK && (file = readdir(files)) != NULL) {
        const char *name = file->d_name;
        const bool done = strcmp(name, "done") == 0;
        if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0 ||
            (ours && (done || is_of_run(name))) || (done && resume)) {
            continue; // what `done` holds --resume says itself
        }
        status = lac_fail(err, LAC_EINPUT, "%s/%s: no %s wrote that; move it away", keep->folder,
                          name, keep->command);
    }
    (void)closedir(files);
    return status;
}

// The heading must be ours. @param at  where the records begin
static lac_status check_heading(const cli_keep *keep, FILE *file, const char *path, off_t *at,
                                lac_error *err)
{
    char ours[HEADING], begins[HEADING] = "";
    const size_t whose = heading(keep, ours);
    LAC_FAIL_IF(fgets(begins, sizeof begins, file) == NULL || strncmp(begins, ours, whose) != 0,
                err, LAC_EINPUT, "--resume: %s: holds no runs of a %s", path, keep->command);
    LAC_FAIL_IF(strcmp(begins, ours) != 0, err, LAC_EINPUT,
                "--resume: %s: is of another %s: its case, its options or its lacuna were others",
                path, keep->command);
    *at = (off_t)strlen(ours);
    return LAC_OK;
}

// Reads what was done before; what comes after a record that is not whole is dropped.
static lac_status read_kept(const cli_keep *keep, const char *path, cli_keep_take *take,
                            void *context, lac_error *err)
{
    label of;
    off_t whole = 0;
    lac_status status;
    void *content = malloc(keep->size);
    FILE *file = fopen(path, "r");
    LAC_TRY(content != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(file != NULL ? LAC_OK
                         : lac_fail(err, LAC_EIO, "--resume: %s: %s", path, strerror(errno)));
    LAC_TRY(check_heading(keep, file, path, &whole, err));
    while (fread(&of, sizeof of, 1, file) == 1 && fread(content, keep->size, 1, file) == 1 &&
           of.sum == sum(keep, of.key, content)) {
        whole += (off_t)(sizeof of + keep->size);
        take(context, of.key, content);
    }
    LAC_TRY(ftruncate(keep->file, whole) == 0
                ? LAC_OK
                : lac_fail(err, LAC_EIO, "%s: %s", path, strerror(errno)));
out:
    if (file != NULL) {
        (void)fclose(file);
    }
    free(content);
    return status;
}

static lac_status put(cli_keep *keep, const void *bytes, size_t size, lac_error *err)
{
    const double now = cli_clock();
    errno = 0;
    bool good = write(keep->file, bytes, size) == (ssize_t)size;
    if (good && now - keep->synced >= keep->every) {
        good = fsync(keep->file) == 0;
        keep->synced = now;
    }
    LAC_FAIL_IF(!good, err, LAC_EIO, "%s/done: %s", keep->folder,
                errno != 0 ? strerror(errno) : "could not be written");
    return LAC_OK;
}

lac_status cli_keep_open(cli_keep *keep, const char *path, bool resume, cli_keep_take *take,
                         void *context, lac_error *err)
{
    char done[sizeof keep->folder + sizeof "/done"], first[HEADING];
    (void)snprintf(keep->folder, sizeof keep->folder, "%s.runs", path);
    if (resume || mkdir(keep->folder, 0777) != 0) {
        LAC_FAIL_IF(!resume && errno != EEXIST, err, LAC_EIO, "%s: %s", keep->folder,
                    strerror(errno));
        LAC_TRY_RETURN(check_folder(keep, resume, err));
    }
    (void)snprintf(done, sizeof done, "%s/done", keep->folder);
    keep->file =
        open(done, O_RDWR | O_APPEND | O_CLOEXEC | O_NOFOLLOW | (resume ? 0 : O_CREAT), 0666);
    LAC_FAIL_IF(keep->file < 0, err, LAC_EIO, "%s%s: %s", resume ? "--resume: " : "", done,
                strerror(errno));
    if (flock(keep->file, LOCK_EX | LOCK_NB) != 0) {
        (void)close(keep->file);
        keep->file = -1; // what is there belongs to the other one
        return lac_fail(err, LAC_EINPUT, "%s: another %s is at work there", done, keep->command);
    }
    clean(keep->folder, false);
    if (resume) {
        return read_kept(keep, done, take, context, err);
    }
    LAC_FAIL_IF(ftruncate(keep->file, 0) != 0, err, LAC_EIO, "%s: %s", done, strerror(errno));
    (void)heading(keep, first);
    return put(keep, first, strlen(first), err);
}

lac_status cli_keep_add(cli_keep *keep, uint64_t key, const void *content, lac_error *err)
{
    const label of = {key, sum(keep, key, content)};
    unsigned char *record = malloc(sizeof of + keep->size);
    LAC_FAIL_MEMORY_IF(record == NULL, err);
    memcpy(record, &of, sizeof of);
    memcpy(record + sizeof of, content, keep->size);
    const lac_status status = put(keep, record, sizeof of + keep->size, err);
    free(record);
    return status;
}

void cli_keep_close(cli_keep *keep, bool remove)
{
    if (keep->file >= 0) {
        clean(keep->folder, remove);
        (void)close(keep->file);
        keep->file = -1;
        if (remove) {
            (void)rmdir(keep->folder);
        }
    }
}
