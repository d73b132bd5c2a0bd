// SPDX-License-Identifier: GPL-3.0-or-later
// Files that grow, one a station: from where the last whole line ended; a file that was rotated
// away is read to its end first.
#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "watch/internal.h"

enum { TAIL = 64 }; // bytes by which a file is known again

static size_t tail_length(size_t line) { return line < TAIL ? line : TAIL; }

// Of the end of a line, its '\n' included.
static uint64_t tail_of(const char *line, size_t n)
{
    const size_t kept = tail_length(n);
    return lac_sum_bytes(0, line + n - kept, kept);
}

static void close_file(lac_followed *f)
{
    if (f->fd >= 0) {
        (void)close(f->fd);
    }
    f->fd = -1;
}

static void clear(lac_followed *f)
{
    close_file(f);
    lac_line_reader_free(f->reader);
    free(f->station);
    free(f->path);
}

// What is written cannot be read as readings too: it would be lost.
static bool is_output(const lac_watch *w, const char *path)
{
    struct stat one, other;
    return w->def.output != NULL && stat(path, &one) == 0 && stat(w->def.output, &other) == 0 &&
           one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

lac_status lac_watch_add_file(lac_watch *w, const char *station, const char *path,
                              lac_followed **out, lac_error *err)
{
    LAC_FAIL_IF(is_output(w, path), err, LAC_EINPUT,
                "%s: is followed by this watch, and cannot be its output too", path);
    for (size_t i = 0; i < w->files; i++) {
        if (strcmp(w->file[i].path, path) == 0) {
            *out = &w->file[i];
            return LAC_OK;
        }
    }
    lac_followed *grown = realloc(w->file, (w->files + 1) * sizeof *grown);
    LAC_FAIL_MEMORY_IF(grown == NULL, err);
    w->file = grown;
    lac_followed *f = *out = &grown[w->files];
    *f = (lac_followed){.station = strdup(station), .path = strdup(path), .fd = -1};
    if (f->station == NULL || f->path == NULL) {
        clear(f);
        return lac_fail_memory(err);
    }
    w->files++;
    return LAC_OK;
}

void lac_watch_close_files(lac_watch *w)
{
    for (size_t i = 0; i < w->files; i++) {
        clear(&w->file[i]);
    }
    free(w->file);
}

// Those of the pattern that are there by now, in any order: each is a station of its own.
static lac_status search(lac_watch *w, lac_error *err)
{
    const char *pattern = w->def.fleet->files_pattern;
    const char *base = lac_path_last(pattern);
    char *folder = lac_folder_of(pattern);
    DIR *list = folder != NULL ? opendir(folder) : NULL;
    const struct dirent *entry = NULL;
    lac_status status = folder != NULL ? LAC_OK : lac_fail_memory(err);
    LAC_LEAVE_IF(status == LAC_OK && list == NULL, err, LAC_EIO, "%s: %s", folder, strerror(errno));
    while (status == LAC_OK && (entry = readdir(list)) != NULL) {
        size_t star = 0, length = 0;
        lac_followed *f = NULL;
        if (entry->d_name[0] == '.' || !lac_fleet_matches(base, entry->d_name, &star, &length) ||
            length == 0 || length >= LAC_LINE_STATION) {
            continue;
        }
        char *path = lac_text_join(folder, "", entry->d_name);
        char *station = strndup(entry->d_name + star, length);
        status = station == NULL || path == NULL ? lac_fail_memory(err)
                                                 : lac_watch_add_file(w, station, path, &f, err);
        free(path);
        free(station);
    }
out:
    if (list != NULL) {
        (void)closedir(list);
    }
    free(folder);
    return status;
}

lac_status lac_watch_find_files(lac_watch *w, lac_error *err)
{
    const lac_fleet *fleet = w->def.fleet;
    lac_followed *f = NULL;
    for (size_t i = 0; i < fleet->files; i++) {
        LAC_TRY_RETURN(lac_watch_add_file(w, fleet->file[i].station, fleet->file[i].path, &f, err));
    }
    return fleet->files_pattern != NULL ? search(w, err) : LAC_OK;
}

bool lac_watch_follows(const lac_watch *w)
{
    return w->def.fleet->files > 0 || w->def.fleet->files_pattern != NULL;
}

// Begins a file: its own header comes first.
static lac_status restart(const lac_watch *w, lac_followed *f, lac_error *err)
{
    f->at = (lac_progress){.inode = f->at.inode, .tail = f->at.tail};
    lac_line_reader_free(f->reader);
    return lac_watch_reader(w, false, f->path, &f->reader, err);
}

// The columns of a file that was begun before, by its header.
static lac_status recall(const lac_watch *w, lac_followed *f, lac_error *err)
{
    const lac_progress kept = f->at;
    lac_line unused;
    LAC_TRY_RETURN(restart(w, f, err));
    if (kept.offset > 0 && w->def.fleet->columns == 0) {
        FILE *file = fdopen(dup(f->fd), "rb");
        char *text = NULL;
        size_t room = 0;
        while (file != NULL && lac_line_header(f->reader) == NULL &&
               getline(&text, &room, file) > 0) {
            text[strcspn(text, "\r\n")] = '\0';
            (void)lac_line_read(f->reader, text, &unused);
        }
        free(text);
        if (file != NULL) {
            (void)fclose(file);
        }
    }
    f->at = kept;
    return LAC_OK;
}

// A file of the folder by its number, under whatever name it has now; -1: none.
static int open_inode(const char *path, ino_t inode)
{
    char *folder = lac_folder_of(path);
    DIR *list = folder != NULL ? opendir(folder) : NULL;
    const struct dirent *entry = NULL;
    int fd = -1;
    while (list != NULL && fd < 0 && (entry = readdir(list)) != NULL) {
        if (entry->d_ino == inode) {
            fd = openat(dirfd(list), entry->d_name, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
        }
    }
    if (list != NULL) {
        (void)closedir(list);
    }
    free(folder);
    return fd;
}

// Opens a file, or what was it when the state was kept; none is there: nothing.
static lac_status open_file(lac_watch *w, lac_followed *f, lac_error *err)
{
    struct stat info;
    const bool begun = f->at.inode != 0;
    f->fd = open(f->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    LAC_FAIL_IF(f->fd < 0 && errno != ENOENT, err, LAC_EIO, "%s: %s", f->path, strerror(errno));
    const bool there = f->fd >= 0 && fstat(f->fd, &info) == 0;
    if (begun && (!there || info.st_ino != f->at.inode)) {
        close_file(f);
        f->fd = open_inode(f->path, f->at.inode);
        if (f->fd >= 0) {
            return recall(w, f, err);
        }
        lac_watch_blame(w, f->path, f->at.lines, f->station,
                        "the file was replaced while nobody watched, and the one before is gone: "
                        "readings that it had beyond these are lost",
                        NULL);
        f->at.inode = 0;
        return LAC_OK; // the new one at the next look
    }
    if (!there) {
        return LAC_OK;
    }
    LAC_FAIL_IF(!S_ISREG(info.st_mode), err, LAC_EIO, "%s: is not a regular file", f->path);
    f->at.inode = info.st_ino;
    w->opened = true;
    return begun ? recall(w, f, err) : restart(w, f, err);
}

// A line of n bytes, the '\n' included, at the offset.
static lac_status take_line(lac_watch *w, lac_followed *f, char *line, size_t n, lac_error *err)
{
    const bool long_line = f->at.cut || n > LAC_WATCH_LINE - 1;
    f->at.tail = tail_of(line, n);
    f->at.before = tail_length(n);
    f->at.offset += (int64_t)n;
    f->at.lines++;
    f->at.cut = false;
    line[n - 1] = '\0';
    if (n > 1 && line[n - 2] == '\r') {
        line[n - 2] = '\0';
    }
    if (long_line) {
        w->since++;
        lac_watch_blame(w, f->path, f->at.lines, f->station, lac_watch_too_long, NULL);
        return LAC_OK;
    }
    return lac_watch_line(w, f->reader, f->station, line, f->path, f->at.lines, err);
}

// Takes the whole lines among bytes that begin at the offset.
static lac_status take(lac_watch *w, lac_followed *f, char *bytes, size_t n, bool *more,
                       lac_error *err)
{
    size_t first = 0;
    for (size_t i = 0; i < n; i++) {
        if (bytes[i] == '\n') {
            LAC_TRY_RETURN(take_line(w, f, bytes + first, i + 1 - first, err));
            first = i + 1;
            *more = true;
        }
    }
    if (n == LAC_WATCH_LINE && first == 0) {
        f->at.cut = *more = true;
        f->at.offset += (int64_t)n;
        f->at.tail = tail_of(bytes, n);
        f->at.before = tail_length(n);
    }
    return LAC_OK;
}

// At the end of what is there: whether another file has its name now, or it was cut.
static lac_status turn(lac_watch *w, lac_followed *f, bool rest, bool *more, lac_error *err)
{
    struct stat info, own;
    if (stat(f->path, &info) != 0 || fstat(f->fd, &own) != 0) {
        return LAC_OK; // between two names
    }
    if (info.st_ino != f->at.inode) {
        if (rest) {
            lac_watch_blame(w, f->path, f->at.lines + 1, f->station,
                            "the last line of the file that was here before does not end", NULL);
        }
        close_file(f);
        f->at.inode = 0;
        *more = true;
    } else if (own.st_size < f->at.offset) {
        *more = true;
        return restart(w, f, err);
    }
    return LAC_OK;
}

static lac_status look(lac_watch *w, lac_followed *f, char *room, bool *more, lac_error *err)
{
    if (f->fd < 0) {
        LAC_TRY_RETURN(open_file(w, f, err));
    }
    if (f->fd < 0) {
        return LAC_OK;
    }
    const size_t known = f->at.before; // of the line before, by which the file is told from another
    const ssize_t n = pread(f->fd, room, known + LAC_WATCH_LINE, f->at.offset - (int64_t)known);
    LAC_FAIL_IF(n < 0, err, LAC_EIO, "%s: %s", f->path, strerror(errno));
    if ((size_t)n >= known && known > 0 && tail_of(room, known) != f->at.tail) {
        *more = true; // cut, and written anew
        return restart(w, f, err);
    }
    const size_t news = (size_t)n > known ? (size_t)n - known : 0;
    bool taken = false;
    LAC_TRY_RETURN(take(w, f, room + known, news, &taken, err));
    *more = *more || taken;
    return taken ? LAC_OK : turn(w, f, news > 0, more, err);
}

lac_status lac_watch_poll(lac_watch *w, bool *more, lac_error *err)
{
    lac_status status;
    *more = false;
    char *room = malloc(LAC_WATCH_LINE + TAIL);
    LAC_FAIL_MEMORY_IF(room == NULL, err);
    LAC_TRY(lac_watch_find_files(w, err));
    for (size_t i = 0; i < w->files && !(w->def.stop != NULL && w->def.stop(NULL)); i++) {
        LAC_TRY(look(w, &w->file[i], room, more, err));
        LAC_TRY(w->since >= (uint64_t)w->def.fleet->checkpoint_lines ? lac_watch_checkpoint(w, err)
                                                                     : LAC_OK);
    }
    LAC_TRY(w->opened ? lac_watch_checkpoint(w, err) : lac_watch_flush(w, false, err));
out:
    free(room);
    return status;
}
