// SPDX-License-Identifier: GPL-3.0-or-later
// What a trade has measured so far, kept in a folder beside its output until that is written.
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

#include "cli/trade/trade.h"

static const char heading[] = "lacuna trade 1\n";

// Whether a trade gives a file this name: of a run, while it is made, and what stands beside it.
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

// Removes what a trade puts there, nothing else.
static void sweep(const char *folder, bool done_too)
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

// Whether `done` is a trade's, or as far as its first line got.
static bool is_done_ours(int folder)
{
    char begins[sizeof heading] = "";
    struct stat info;
    int fd = openat(folder, "done", O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) {
        return false;
    }
    const ssize_t n = fstat(fd, &info) == 0 && S_ISREG(info.st_mode)
                          ? pread(fd, begins, sizeof begins - 1, 0)
                          : -1;
    (void)close(fd);
    return n >= 0 && strncmp(begins, heading, (size_t)n) == 0;
}

// A folder that was there: all in it must be a trade's, since what it has is taken away in the end.
static lac_status check_folder(const char *folder, bool resume, lac_error *err)
{
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    DIR *files = fd >= 0 ? fdopendir(fd) : NULL;
    LAC_FAIL_IF(files == NULL, err, LAC_EIO, "%s%s: %s", resume ? "--resume: " : "", folder,
                strerror(errno));
    lac_status status = LAC_OK;
    const bool ours = is_done_ours(fd);
    const struct dirent *file;
    while (status == LAC_OK && (file = readdir(files)) != NULL) {
        const char *name = file->d_name;
        const bool done = strcmp(name, "done") == 0;
        if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0 ||
            (ours && (done || is_of_run(name))) || (done && resume)) {
            continue; // what `done` holds --resume says itself
        }
        status =
            lac_fail(err, LAC_EINPUT, "%s/%s: no trade wrote that; move it away", folder, name);
    }
    (void)closedir(files);
    return status;
}

// A line: the key, how the run ended, its numbers, its message.
static void take_over(cli_trade_job *job, const char *line)
{
    char *at, *end;
    lac_trade_measure m;
    double number[sizeof m / sizeof(double)];
    const uint64_t key = strtoull(line, &at, 16);
    const long how = strtol(at, &end, 10);
    bool good = at == line + 16 && end != at && how >= LAC_TRADE_DONE && how <= LAC_TRADE_GIVEN_UP;
    for (size_t i = 0; good && i < sizeof number / sizeof number[0]; i++) {
        number[i] = strtod(at = end, &end);
        good = end != at;
    }
    for (size_t i = 0; good && i < job->trade.runs; i++) {
        lac_trade_run *run = &job->trade.run[i];
        if (run->end == LAC_TRADE_PENDING && run->key == key) {
            run->end = (lac_trade_end)how;
            memcpy(&run->m, number, sizeof number);
            (void)snprintf(run->message, sizeof run->message, "%s", end + (*end == ' '));
        }
    }
}

// Reads what a trade before this one has done; a line that was torn when it was killed is dropped.
static lac_status read_kept(cli_trade_job *job, const char *path, lac_error *err)
{
    char *line = NULL;
    size_t size = 0;
    off_t whole = 0;
    FILE *file = fopen(path, "r");
    LAC_FAIL_IF(file == NULL, err, LAC_EIO, "--resume: %s: %s", path, strerror(errno));
    for (ssize_t n = 0; (n = getline(&line, &size, file)) > 0 && line[n - 1] == '\n';) {
        if (whole == 0 && strcmp(line, heading) != 0) {
            break;
        }
        whole += n;
        line[n - 1] = '\0';
        take_over(job, line);
    }
    free(line);
    (void)fclose(file);
    LAC_FAIL_IF(whole == 0, err, LAC_EINPUT, "--resume: %s: holds no runs of a trade", path);
    return ftruncate(job->kept, whole) == 0
               ? LAC_OK
               : lac_fail(err, LAC_EIO, "%s: %s", path, strerror(errno));
}

static lac_status put(const cli_trade_job *job, const char *text, lac_error *err)
{
    const size_t n = strlen(text);
    errno = 0;
    LAC_FAIL_IF(write(job->kept, text, n) != (ssize_t)n || fsync(job->kept) != 0, err, LAC_EIO,
                "%s/done: %s", job->folder, errno != 0 ? strerror(errno) : "could not be written");
    return LAC_OK;
}

static lac_status open_done(cli_trade_job *job, lac_error *err)
{
    char path[4096];
    const bool resume = cli_given(job->request, CLI_OPT_RESUME);
    (void)snprintf(path, sizeof path, "%s/done", job->folder);
    job->kept =
        open(path, O_RDWR | O_APPEND | O_CLOEXEC | O_NOFOLLOW | (resume ? 0 : O_CREAT), 0666);
    LAC_FAIL_IF(job->kept < 0, err, LAC_EIO, "%s%s: %s", resume ? "--resume: " : "", path,
                strerror(errno));
    if (flock(job->kept, LOCK_EX | LOCK_NB) != 0) {
        (void)close(job->kept);
        job->kept = -1; // what is there belongs to the other one
        return lac_fail(err, LAC_EINPUT, "%s: another trade is at work there", path);
    }
    sweep(job->folder, false);
    if (resume) {
        return read_kept(job, path, err);
    }
    LAC_FAIL_IF(ftruncate(job->kept, 0) != 0, err, LAC_EIO, "%s: %s", path, strerror(errno));
    return put(job, heading, err);
}

lac_status cli_trade_keep_open(cli_trade_job *job, lac_error *err)
{
    const bool resume = cli_given(job->request, CLI_OPT_RESUME);
    if (resume || mkdir(job->folder, 0777) != 0) {
        LAC_FAIL_IF(!resume && errno != EEXIST, err, LAC_EIO, "%s: %s", job->folder,
                    strerror(errno));
        LAC_TRY_RETURN(check_folder(job->folder, resume, err));
    }
    return open_done(job, err);
}

lac_status cli_trade_keep(const cli_trade_job *job, const lac_trade_run *run, lac_error *err)
{
    char line[1024];
    double number[sizeof run->m / sizeof(double)];
    memcpy(number, &run->m, sizeof number);
    int n = snprintf(line, sizeof line, "%016" PRIx64 " %d", run->key, (int)run->end);
    for (size_t i = 0; i < sizeof number / sizeof number[0]; i++) {
        n += snprintf(line + n, sizeof line - (size_t)n, " %.17g", number[i]);
    }
    (void)snprintf(line + n, sizeof line - (size_t)n, " %s\n", run->message);
    return put(job, line, err);
}

void cli_trade_keep_close(cli_trade_job *job, bool remove)
{
    if (job->kept >= 0) {
        sweep(job->folder, remove);
        (void)close(job->kept);
        job->kept = -1;
        if (remove) {
            (void)rmdir(job->folder);
        }
    }
}
