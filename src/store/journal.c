// SPDX-License-Identifier: GPL-3.0-or-later
// The journal beside a file that grows: what the file held when it got its name, then every value
// that was put since, each with a checksum. Nothing in it is written over, so that whatever call a
// kill or a full disk comes at, all before it stands. `docs/format.md`, "The journal".
#define _GNU_SOURCE // memmem
#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/temp_file.h"
#include "store/nc.h"

enum {
    MAX_RANK = 4,
    SEARCHED_MAX = 1 << 26, // bytes from the start in which a file's own text is looked for
    AHEAD_MAX = 1 << 20,    // bytes that wait for a sync
};

typedef struct head {
    char mark[8];
    uint64_t owner, base; // bytes of the text that tells whose it is, and of the file that follow
    uint64_t sum;         // of both
} head;

// Before the name of the variable and its values; rank 0 and no name: all before it was synced.
typedef struct entry {
    uint64_t sum; // of where it stands, of what follows in here, of name and values
    uint64_t size;
    uint32_t type, rank, name, unused;
    uint64_t start[MAX_RANK], count[MAX_RANK];
} entry;

static const char ending[] = ".journal";
static const char mark[8] = {'L', 'A', 'C', 'J', 'R', 'N', 'L', '1'};

// A file seen as memory.
typedef struct view {
    const unsigned char *bytes;
    size_t size;
} view;

static bool open_view(const char *path, view *v)
{
    struct stat info;
    *v = (view){.size = 0};
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) {
        return false;
    }
    if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0) {
        void *bytes = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
        if (bytes != MAP_FAILED) {
            *v = (view){.bytes = bytes, .size = (size_t)info.st_size};
        }
    }
    (void)close(fd);
    return v->size > 0;
}

// errno stays.
static void close_view(view *v)
{
    const int reason = errno;
    if (v->size > 0) {
        (void)munmap((void *)v->bytes, v->size);
    }
    errno = reason;
}

static uint64_t sum_of_both(const void *owner, const head *h, const void *base)
{
    return lac_nc_sum(lac_nc_sum(0, owner, (size_t)h->owner), base, (size_t)h->base);
}

bool lac_journal_name(const char *path, char name[LAC_JOURNAL_NAME])
{
    if (realpath(path, name) == NULL) {
        return false;
    }
    memcpy(name + strlen(name), ending, sizeof ending);
    return true;
}

// The head of a journal, its text and its file being sound.
static bool read_head(const view *v, head *h)
{
    if (v->size < sizeof *h) {
        return false;
    }
    memcpy(h, v->bytes, sizeof *h);
    return memcmp(h->mark, mark, sizeof mark) == 0 && h->owner <= v->size - sizeof *h &&
           h->base <= v->size - sizeof *h - h->owner &&
           sum_of_both(v->bytes + sizeof *h, h, v->bytes + sizeof *h + h->owner) == h->sum;
}

// The journal of a file, closed by the caller where it is there and sound. Nothing is allocated:
// one that was not looked at must not seem not to be there.
static bool open_journal(const char *path, view *v, head *h)
{
    char name[LAC_JOURNAL_NAME];
    if (!lac_journal_name(path, name) || !open_view(name, v)) {
        return false;
    }
    if (!read_head(v, h)) {
        close_view(v);
        errno = EIO;
        return false;
    }
    return true;
}

static uint64_t sum_of(const entry *e, uint64_t at, const void *name, const void *values)
{
    entry clean = *e;
    clean.sum = at;
    uint64_t sum = lac_nc_sum(0, &clean, sizeof clean);
    sum = lac_nc_sum(sum, name, e->name);
    return lac_nc_sum(sum, values, (size_t)e->size - e->name);
}

static size_t width_of(uint32_t type)
{
    return type == NC_UBYTE ? 1 : type == NC_INT64 ? sizeof(long long) : sizeof(double);
}

// What can be the beginning of an entry at a place; false also where there is no room for one.
static bool read_beginning(const view *v, size_t at, entry *e)
{
    uint64_t values = 1;
    if (at > v->size || v->size - at < sizeof *e) {
        return false;
    }
    memcpy(e, v->bytes + at, sizeof *e);
    if (e->rank > MAX_RANK || e->name > NC_MAX_NAME || e->size < e->name) {
        return false;
    }
    for (uint32_t d = 0; d < e->rank; d++) {
        values *= e->count[d];
    }
    return e->size - e->name == (e->name > 0 ? values * width_of(e->type) : 0);
}

// The entry at a place; false where what is there is none, or torn.
static bool read_entry(const view *v, size_t at, entry *e)
{
    if (!read_beginning(v, at, e) || e->size > v->size - at - sizeof *e) {
        return false;
    }
    const unsigned char *name = v->bytes + at + sizeof *e;
    return sum_of(e, at, name, name + e->name) == e->sum;
}

// Where the good entries end, and where the last of them is that marks a sync.
static size_t walk(const view *v, const head *h, size_t *synced)
{
    entry e;
    size_t at = (size_t)(sizeof *h + h->owner + h->base);
    *synced = at;
    for (; read_entry(v, at, &e); at += sizeof e + (size_t)e.size) {
        *synced = e.name == 0 ? at : *synced;
    }
    return at;
}

// Whether a write that was stopped can have left what follows the good entries: as much of one
// entry as it came to, and nothing after it.
static bool is_torn(const view *v, size_t at)
{
    entry e;
    if (v->size - at >= sizeof e &&
        (!read_beginning(v, at, &e) || e.size <= v->size - at - sizeof e)) {
        return false;
    }
    do {
        at++;
    } while (at < v->size && !read_entry(v, at, &e));
    return at >= v->size;
}

static int put_entry(int id, const view *v, size_t at, const entry *e)
{
    char name[NC_MAX_NAME + 1] = "";
    size_t start[MAX_RANK], count[MAX_RANK];
    int var = 0;
    memcpy(name, v->bytes + at + sizeof *e, e->name);
    for (int d = 0; d < MAX_RANK; d++) {
        start[d] = (size_t)e->start[d];
        count[d] = (size_t)e->count[d];
    }
    // Names have any length: what follows one is not aligned.
    const size_t size = (size_t)e->size - e->name;
    void *values = malloc(size + 1);
    if (values == NULL) {
        return NC_ENOMEM;
    }
    memcpy(values, v->bytes + at + sizeof *e + e->name, size);
    int code = nc_inq_varid(id, name, &var);
    if (code == NC_NOERR) {
        code = lac_nc_put_values(id, (nc_type)e->type, var, start, count, values);
    }
    free(values);
    return code;
}

int lac_journal_replay(const char *path, int id)
{
    view v;
    head h;
    entry e;
    int code = NC_NOERR;
    if (!open_journal(path, &v, &h)) {
        return errno;
    }
    size_t synced = 0;
    (void)walk(&v, &h, &synced);
    for (size_t at = (size_t)(sizeof h + h.owner + h.base);
         code == NC_NOERR && at < synced && read_entry(&v, at, &e);
         at += sizeof e + (size_t)e.size) {
        code = e.name > 0 ? put_entry(id, &v, at, &e) : NC_NOERR;
    }
    close_view(&v);
    return code;
}

bool lac_journal_copy_base(const char *path, int to)
{
    view v;
    head h;
    if (!open_journal(path, &v, &h)) {
        return false;
    }
    const bool good = lac_temp_file_write(to, v.bytes + sizeof h + h.owner, (size_t)h.base);
    close_view(&v);
    return good;
}

// A netCDF-4 file that is not closed, as memory; to be closed where it is one.
static bool open_unclosed(const char *path, view *file)
{
    static const unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    bool good = fd >= 0 && open_view(path, file);
    if (good &&
        (file->size < sizeof signature || memcmp(file->bytes, signature, sizeof signature) != 0 ||
         lac_nc_seal_state(fd, file->size) != LAC_SEAL_NONE)) {
        close_view(file);
        good = false;
    }
    lac_temp_file_close(fd);
    return good;
}

// Whether a file is not closed and holds the text that its journal says it does.
static bool belongs(const char *path, const view *journal, const head *h)
{
    view file;
    if (!open_unclosed(path, &file)) {
        return false;
    }
    const size_t searched = file.size < SEARCHED_MAX ? file.size : SEARCHED_MAX;
    const bool good =
        memmem(file.bytes, searched, journal->bytes + sizeof *h, (size_t)h->owner) != NULL;
    close_view(&file);
    return good;
}

// A journal whose head cannot be read: whether it is there, beside a file that is not closed.
static void look_at_lost(const char *path, lac_store_loss *loss)
{
    char name[LAC_JOURNAL_NAME];
    struct stat info;
    view file;
    if (lac_journal_name(path, name) && stat(name, &info) == 0 && S_ISREG(info.st_mode) &&
        open_unclosed(path, &file)) {
        close_view(&file);
        loss->damaged = true;
        loss->unread = (uint64_t)info.st_size;
    }
}

bool lac_journal_waits(const char *path, lac_store_loss *loss)
{
    view v;
    head h;
    *loss = (lac_store_loss){.own = -1};
    if (!open_journal(path, &v, &h)) {
        look_at_lost(path, loss);
        return false;
    }
    const bool waits = belongs(path, &v, &h);
    if (waits) {
        size_t synced = 0;
        const size_t at = walk(&v, &h, &synced);
        loss->damaged = !is_torn(&v, at);
        loss->at = loss->damaged ? at : 0;
        loss->unread = loss->damaged ? v.size - at : 0;
    }
    close_view(&v);
    return waits;
}

// Whether a name is free for a journal: nothing is there, or a journal.
static bool may_take(const char *name)
{
    char found[sizeof mark] = "";
    struct stat info;
    if (lstat(name, &info) != 0) {
        return errno == ENOENT;
    }
    int fd = S_ISREG(info.st_mode) ? open(name, O_RDONLY | O_CLOEXEC) : -1;
    bool good = fd >= 0 && pread(fd, found, sizeof found, 0) == (ssize_t)sizeof found &&
                memcmp(found, mark, sizeof mark - 1) == 0;
    lac_temp_file_close(fd);
    return good;
}

// Head, text and the file as it is.
static bool write_base(struct lac_journal *j, const char *part, const char *owner)
{
    view file;
    if (!open_view(part, &file)) {
        return false;
    }
    head h = {.owner = strlen(owner), .base = file.size};
    memcpy(h.mark, mark, sizeof mark);
    // A text that HDF5 keeps otherwise cannot be looked for.
    h.owner = memmem(file.bytes, file.size, owner, strlen(owner)) != NULL ? h.owner : 0;
    h.sum = sum_of_both(owner, &h, file.bytes);
    bool good = lac_temp_file_write(j->fd, &h, sizeof h) &&
                lac_temp_file_write(j->fd, owner, (size_t)h.owner) &&
                lac_temp_file_write(j->fd, file.bytes, file.size);
    j->size = (off_t)(sizeof h + h.owner + file.size);
    close_view(&file);
    return good;
}

lac_status lac_nc_keep_journal(lac_nc *file, lac_error *err)
{
    struct lac_journal *j = malloc(sizeof *j);
    // It names the command and the time.
    char *owner = lac_nc_text_of(file->id, "history", SIZE_MAX);
    lac_status status = LAC_OK;
    LAC_TRY(j != NULL ? LAC_OK : lac_fail_memory(err));
    *j = (struct lac_journal){.fd = -1};
    j->name = lac_text_join(file->path, "", ending);
    j->part = j->name != NULL ? lac_temp_file_name(j->name) : NULL;
    LAC_TRY(j->part != NULL && owner != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_LEAVE_IF(!may_take(j->name), err, LAC_EINPUT,
                 "%s: is not a journal of Lacuna, whose name it has; move it away", j->name);
    lac_temp_file_sweep(j->name);
    (void)unlink(j->part);
    j->fd = open(j->part, O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    // Where the file system has no locks, nobody else is told.
    LAC_LEAVE_IF(j->fd >= 0 && flock(j->fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK, err,
                 LAC_EIO, "%s: another process is writing it", j->name);
    LAC_LEAVE_IF(j->fd < 0 || !write_base(j, file->part, owner), err, LAC_EIO,
                 "%s: cannot write: %s", j->name, strerror(errno));
out:
    free(owner);
    if (status != LAC_OK) {
        lac_journal_free(j, true);
        j = NULL;
    }
    file->journal = j;
    return status;
}

lac_status lac_journal_publish(struct lac_journal *j, const char *path, lac_error *err)
{
    LAC_FAIL_IF(rename(j->part, j->name) != 0, err, LAC_EIO, "%s: cannot write its journal: %s",
                path, strerror(errno));
    j->published = true;
    return LAC_OK;
}

// What is not written is lost with the error; what is torn ends the journal for its reader.
static int write_ahead(struct lac_journal *j)
{
    const bool good =
        !j->ahead.no_memory && lac_temp_file_write(j->fd, j->ahead.bytes, j->ahead.size);
    const int reason = j->ahead.no_memory ? ENOMEM : errno;
    if (good) {
        j->size += (off_t)j->ahead.size;
    } else {
        int failed = ftruncate(j->fd, j->size);
        (void)failed;
    }
    j->ahead.size = 0;
    j->ahead.no_memory = false;
    return good ? 0 : reason;
}

int lac_journal_put(struct lac_journal *j, const char *name, nc_type type, int rank,
                    const size_t *start, const size_t *count, const void *values)
{
    uint64_t n = 1;
    entry e = {.type = (uint32_t)type, .rank = (uint32_t)rank, .name = (uint32_t)strlen(name)};
    for (int d = 0; d < rank; d++) {
        e.start[d] = start[d];
        e.count[d] = count[d];
        n *= count[d];
    }
    const size_t size = values != NULL ? (size_t)n * width_of(e.type) : 0;
    e.size = e.name + size;
    e.sum = sum_of(&e, (uint64_t)j->size + j->ahead.size, name, values);
    lac_archive_pass(&j->ahead, &e, sizeof e);
    lac_archive_pass(&j->ahead, (void *)name, e.name); // only read
    lac_archive_pass(&j->ahead, (void *)values, size);
    return values == NULL || j->ahead.no_memory || j->ahead.size > AHEAD_MAX ? write_ahead(j) : 0;
}

void lac_journal_free(struct lac_journal *j, bool remove)
{
    struct stat own;
    struct stat there;
    if (j == NULL) {
        return;
    }
    const char *name = j->published ? j->name : j->part;
    if (remove && j->fd >= 0 && fstat(j->fd, &own) == 0 && stat(name, &there) == 0 &&
        own.st_dev == there.st_dev && own.st_ino == there.st_ino) {
        (void)unlink(name);
    }
    lac_temp_file_close(j->fd);
    free(j->ahead.bytes);
    free(j->name);
    free(j->part);
    free(j);
}
