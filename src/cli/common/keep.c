// SPDX-License-Identifier: GPL-3.0-or-later
// What is done so far, in a folder beside the output until that is written.
#include "cli/common/keep.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/common/progress.h"

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

// Removes what is put there besides `done`, nothing else.
static void clean(const char *folder)
{
    DIR *files = opendir(folder);
    const struct dirent *file;
    while (files != NULL && (file = readdir(files)) != NULL) {
        if (is_of_run(file->d_name)) {
            (void)unlinkat(dirfd(files), file->d_name, 0);
        }
    }
    if (files != NULL) {
        (void)closedir(files);
    }
}

// A folder that was there: all in it must be this command's, since it is taken away in the end.
static lac_status check_folder(const cli_keep *keep, bool resume, lac_error *err)
{
    int fd = open(keep->folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    DIR *files = fd >= 0 ? fdopendir(fd) : NULL;
    LAC_FAIL_IF(files == NULL, err, LAC_EIO, "%s%s: %s", resume ? "--resume: " : "", keep->folder,
                strerror(errno));
    lac_status status = LAC_OK;
    const bool ours = lac_kept_is_of(fd, "done", keep->command);
    const struct dirent *file;
    while (status == LAC_OK && (file = readdir(files)) != NULL) {
        const char *name = file->d_name;
        const bool done = strcmp(name, "done") == 0;
        if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0 ||
            (ours && (done || is_of_run(name))) || (done && resume)) {
            continue; // what `done` holds --resume says itself
        }
        status = lac_fail(err, LAC_EINPUT, "%s/%s: was not written by %s; move it away",
                          keep->folder, name, keep->command);
    }
    (void)closedir(files);
    return status;
}

lac_status cli_keep_open(cli_keep *keep, const char *path, bool resume, cli_keep_take *take,
                         void *context, lac_error *err)
{
    char done[sizeof keep->folder + sizeof "/done"];
    const uint64_t of = lac_sum_bytes(keep->mark, &keep->size, sizeof keep->size);
    (void)snprintf(keep->folder, sizeof keep->folder, "%s.runs", path);
    if (resume || mkdir(keep->folder, 0777) != 0) {
        LAC_FAIL_IF(!resume && errno != EEXIST, err, LAC_EIO, "%s: %s", keep->folder,
                    strerror(errno));
        LAC_TRY_RETURN(check_folder(keep, resume, err));
    }
    (void)snprintf(done, sizeof done, "%s/done", keep->folder);
    LAC_TRY_RETURN(lac_kept_open(done, keep->command, of, resume, &keep->done, err));
    clean(keep->folder);
    uint64_t *record = malloc(sizeof *record + keep->size); // the key, then the content, of each
    LAC_FAIL_MEMORY_IF(record == NULL, err);
    while (resume && lac_kept_read(keep->done, record, sizeof *record + keep->size)) {
        take(context, record[0], record + 1);
    }
    free(record);
    return LAC_OK;
}

lac_status cli_keep_add(cli_keep *keep, uint64_t key, const void *content, lac_error *err)
{
    const double now = cli_clock();
    uint64_t *record = malloc(sizeof key + keep->size);
    LAC_FAIL_MEMORY_IF(record == NULL, err);
    record[0] = key;
    memcpy(record + 1, content, keep->size);
    lac_status status = lac_kept_put(keep->done, record, sizeof key + keep->size, err);
    free(record);
    if (status == LAC_OK && now - keep->synced >= keep->every) {
        status = lac_kept_sync(keep->done, err);
        keep->synced = now;
    }
    return status;
}

void cli_keep_close(cli_keep *keep, bool remove)
{
    if (keep->done != NULL) {
        clean(keep->folder);
        lac_kept_close(keep->done, remove);
        keep->done = NULL;
        if (remove) {
            (void)rmdir(keep->folder);
        }
    }
}
