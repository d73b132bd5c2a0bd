// SPDX-License-Identifier: GPL-3.0-or-later
// What a run goes on from. The checkpoint beside its file: mark, size and checksum of what follows,
// then who made it of what, how much of the file it counts on, and the state. And the file: netCDF
// cannot take records back, so that those up to the checkpoint are copied into a new one, which
// then takes the old one's name.
#include <ctype.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/date.h"
#include "base/temp_file.h"
#include "lacuna/version.h"
#include "store/input.h"
#include "store/internal.h"

enum { AT_ONCE = 1 << 20 }; // values of cells that are copied in one piece, else place by place

typedef struct head {
    char mark[8];
    uint64_t size, sum; // of what follows
} head;

static const char mark[8] = {'L', 'A', 'C', 'C', 'K', 'P', 'T', '2'};

const char *lac_checkpoint_file_program(void) { return "Lacuna " LACUNA_VERSION; }

// FNV-1a, the high half folded in. @param sum  to go on from, the size of all at first
static uint64_t sum_of(uint64_t sum, const unsigned char *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        sum = (sum ^ bytes[i]) * UINT64_C(0x100000001b3);
        sum ^= sum >> 32;
    }
    return sum;
}

static void pass_about(lac_archive *archive, lac_checkpoint_file *c)
{
    LAC_PASS(archive, c->from.planned);
    LAC_PASS(archive, c->from.time);
    LAC_PASS_RUN(archive, c->records, c->last_time);
    lac_archive_text(archive, &c->program);
    lac_archive_text(archive, &c->libraries);
    lac_archive_text(archive, &c->case_text);
}

// @param archive  what comes before the state, which is large: it is not copied
static lac_status write_file(const char *name, const char *part, const lac_archive *archive,
                             const lac_checkpoint *checkpoint, lac_error *err)
{
    const size_t about = archive->size - sizeof(head);
    head h = {.size = about + checkpoint->size};
    h.sum = sum_of(sum_of(h.size, archive->bytes + sizeof h, about), checkpoint->state,
                   checkpoint->size);
    memcpy(h.mark, mark, sizeof mark);
    memcpy(archive->bytes, &h, sizeof h);
    if ((unlink(part) != 0 && errno != ENOENT) ||
        !lac_temp_file_fill(part, archive->bytes, archive->size, checkpoint->state,
                            checkpoint->size) ||
        rename(part, name) != 0) {
        const int reason = errno;
        (void)unlink(part);
        return lac_fail(err, LAC_EIO, "%s: cannot write: %s", name, strerror(reason));
    }
    lac_temp_file_sync_folder(name);
    return LAC_OK;
}

lac_status lac_store_put_checkpoint(const lac_store *s, const lac_checkpoint *checkpoint,
                                    lac_error *err)
{
    lac_checkpoint_file info = {.from = *checkpoint,
                                .records = lac_writer_places(&s->writer, "time"),
                                .snapshots = lac_writer_places(&s->writer, "snapshot"),
                                .events = lac_writer_places(&s->writer, "event"),
                                .begun = s->begun,
                                .last_time = s->last_origin + s->last_local,
                                .program = (char *)lac_checkpoint_file_program(),
                                .libraries = s->libraries,
                                .case_text = s->case_text};
    lac_archive archive = {.loading = false};
    head later = {.size = 0};
    char *name = lac_text_join(s->file.path, "", ".checkpoint");
    char *part = lac_text_join(s->file.path, "", ".checkpoint.part");
    LAC_PASS(&archive, later);
    pass_about(&archive, &info);
    const bool good = name != NULL && part != NULL && !archive.no_memory;
    const lac_status status =
        good ? write_file(name, part, &archive, checkpoint, err) : lac_fail_memory(err);
    free(name);
    free(part);
    free(archive.bytes);
    return status;
}

void lac_store_remove_checkpoint(const char *path)
{
    static const char *const endings[] = {".checkpoint", ".checkpoint.part"};
    char name[PATH_MAX + 32]; // no allocation: nothing here may fail unsaid
    for (size_t i = 0; i < 2; i++) {
        int length = snprintf(name, sizeof name, "%s%s", path, endings[i]);
        if (length > 0 && (size_t)length < sizeof name) {
            (void)unlink(name);
        }
    }
}

// The bytes after the head, sound or not at all.
static lac_status read_bytes(const char *name, int fd, lac_checkpoint_file *out, size_t *size,
                             lac_error *err)
{
    struct stat info = {0};
    head h;
    const size_t word = sizeof mark - 1; // then the format
    LAC_FAIL_IF(fstat(fd, &info) != 0, err, LAC_EIO, "%s: %s", name, strerror(errno));
    LAC_FAIL_IF(!S_ISREG(info.st_mode) || pread(fd, &h, sizeof h, 0) != (ssize_t)sizeof h ||
                    memcmp(h.mark, mark, word) != 0,
                err, LAC_EIO, "%s: is not a checkpoint of Lacuna", name);
    LAC_FAIL_IF(
        h.mark[word] != mark[word], err, LAC_EINPUT,
        "%s: is a checkpoint of another version of Lacuna: its format is '%c', '%c' is read here",
        name, isprint((unsigned char)h.mark[word]) ? h.mark[word] : '?', mark[word]);
    *size = (size_t)info.st_size - sizeof h;
    out->bytes = malloc(*size + 1);
    LAC_FAIL_MEMORY_IF(out->bytes == NULL, err);
    bool whole = h.size == *size;
    for (size_t at = 0; whole && at < *size;) {
        ssize_t got = pread(fd, out->bytes + at, *size - at, (off_t)(sizeof h + at));
        whole = got > 0;
        at += whole ? (size_t)got : 0;
    }
    LAC_FAIL_IF(!whole, err, LAC_EIO, "%s: is damaged: %zu bytes of %llu", name, sizeof h + *size,
                (unsigned long long)h.size + sizeof h);
    LAC_FAIL_IF(sum_of(*size, out->bytes, *size) != h.sum, err, LAC_EIO,
                "%s: is damaged: differs from its checksum", name);
    return LAC_OK;
}

lac_status lac_checkpoint_file_read(const char *path, lac_checkpoint_file *out, lac_error *err)
{
    lac_status status = LAC_OK;
    size_t size = 0;
    *out = (lac_checkpoint_file){.records = 0};
    char *place = realpath(path, NULL); // through the links, as the file itself is written
    char *name = lac_text_join(place != NULL ? place : path, "", ".checkpoint");
    int fd = name != NULL ? open(name, O_RDONLY | O_CLOEXEC) : -1;
    LAC_TRY(name != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_LEAVE_IF(fd < 0 && errno == ENOENT, err, LAC_EINPUT, "%s: has no checkpoint to go on from",
                 path);
    LAC_LEAVE_IF(fd < 0, err, LAC_EIO, "%s: %s", name, strerror(errno));
    LAC_TRY(read_bytes(name, fd, out, &size, err));
    lac_archive archive = {.loading = true, .bytes = out->bytes, .size = size};
    pass_about(&archive, out);
    if (!lac_archive_good(&archive)) {
        status = archive.no_memory ? lac_fail_memory(err)
                                   : lac_fail(err, LAC_EIO, "%s: is damaged", name);
    }
    out->from.state = out->bytes + archive.at;
    out->from.size = size - archive.at;
out:
    lac_temp_file_close(fd);
    free(place);
    free(name);
    return status;
}

void lac_checkpoint_file_clear(lac_checkpoint_file *checkpoint)
{
    free(checkpoint->program);
    free(checkpoint->libraries);
    free(checkpoint->case_text);
    free(checkpoint->bytes);
    *checkpoint = (lac_checkpoint_file){.records = 0};
}

static lac_status fail_damaged(const lac_stored_file *in, const char *name, lac_error *err)
{
    return lac_fail(err, LAC_EIO,
                    "%s: is damaged: lacks values of %s that the checkpoint counts on", in->path,
                    name);
}

// Copies the first places of a variable, or that of a row.
static lac_status copy_places(const lac_store *s, const lac_stored_file *in, const lac_column *c,
                              ptrdiff_t row, size_t n, bool never_missing, lac_error *err)
{
    const char *name = c->item.name;
    const size_t first = row != LAC_INPUT_ALL ? (size_t)row : 0;
    lac_stored_values old;
    lac_status status = lac_stored_file_row(in, name, row, &old, err);
    if (status == LAC_OK || status == LAC_EINPUT) { // no such row
        bool whole = status == LAC_OK && old.n >= n && old.width == c->item.count;
        for (size_t i = 0; never_missing && whole && i < n * old.width; i++) {
            whole = !isnan(old.value[i]);
        }
        status = whole ? lac_writer_put_values(&s->writer, c, first, n, old.value, err)
                       : fail_damaged(in, name, err);
    }
    lac_stored_values_clear(&old);
    return status;
}

// The old file must have the variable as the new one does.
static lac_status copy_series(const lac_store *s, const lac_stored_file *in, const lac_column *c,
                              size_t n, bool never_missing, lac_error *err)
{
    const lac_item *item = &c->item;
    const bool by_row = (item->row->flags & LAC_CELLS) != 0 && n * item->count > AT_ONCE;
    int id = 0, rank = 0;
    nc_type type = NC_NAT;
    lac_status status = LAC_OK;
    if (nc_inq_varid(in->id, item->name, &id) != NC_NOERR ||
        nc_inq_var(in->id, id, NULL, &type, &rank, NULL, NULL) != NC_NOERR ||
        (size_t)rank != item->rank || type != lac_writer_type(&s->writer, item)) {
        return fail_damaged(in, item->name, err);
    }
    for (size_t i = 0; i < n && status == LAC_OK; i += by_row ? 1 : n) {
        status = copy_places(s, in, c, by_row ? (ptrdiff_t)i : LAC_INPUT_ALL, by_row ? 1 : n,
                             never_missing, err);
    }
    return status;
}

static lac_status copy_all(lac_store *s, const lac_stored_file *in, const lac_checkpoint_file *from,
                           lac_error *err)
{
    const lac_columns *all = &s->writer.columns;
    const size_t time = lac_columns_along(all, "time");
    for (size_t along = 0; along < LAC_MOST_GROWING; along++) {
        const char *name = all->growth[along].name != NULL ? all->growth[along].name : "";
        s->writer.columns.growth[along].written = (size_t)(along == time  ? from->records
                                                           : *name == 's' ? from->snapshots
                                                           : *name == 'e' ? from->events
                                                                          : 0);
    }
    for (const lac_column *c = all->column; c < all->column + all->n; c++) {
        const bool real = (c->item.row->flags & (LAC_WHOLE | LAC_MISSING)) == 0;
        if (c->along != LAC_ONCE) {
            LAC_TRY_RETURN(copy_series(s, in, c, all->growth[c->along].written,
                                       c->along == time && real, err));
        }
    }
    return LAC_OK;
}

// Puts what an attribute of the old file says before `more`.
static lac_status extend(const lac_store *s, const lac_stored_file *in, const char *name,
                         const char *between, const char *more, lac_error *err)
{
    char *old = lac_nc_text_of(in->id, name, in->size);
    char *text = old != NULL ? lac_text_join(old, between, more) : NULL;
    const lac_status status =
        text != NULL ? lac_nc_text(&s->file, NC_GLOBAL, name, text, err) : lac_fail_memory(err);
    free(old);
    free(text);
    return status;
}

static lac_status put_past(const lac_store *s, const lac_stored_file *in,
                           const lac_checkpoint_file *from, lac_error *err)
{
    char resumed[96];
    lac_status status = LAC_OK;
    char *command = lac_nc_text_of(s->file.id, "history", SIZE_MAX);
    LAC_FAIL_MEMORY_IF(command == NULL, err);
    (void)snprintf(resumed, sizeof resumed, "%s checkpoint at %.17g s",
                   from->from.planned ? "planned" : "forced", from->from.time);
    LAC_TRY(extend(s, in, "history", "\n", command, err));
    LAC_TRY(extend(s, in, "resumed", "; ", resumed, err));
    LAC_TRY(extend(s, in, "date_created", "", "", err));
out:
    free(command);
    return status;
}

// Whether the file is the one that the checkpoint was made beside. It may have grown since.
static lac_status check_pair(const lac_stored_file *in, const lac_checkpoint_file *from,
                             lac_error *err)
{
    char date[32];
    double last = NAN;
    size_t records = 0;
    int id = 0;
    const size_t at = from->records > 0 ? (size_t)from->records - 1 : 0;
    char *made = lac_nc_text_of(in->id, "date_created", in->size);
    (void)lac_date_format(from->begun, date, sizeof date);
    bool same = made != NULL && strcmp(made, date) == 0;
    free(made);
    LAC_FAIL_MEMORY_IF(made == NULL, err);
    int code = nc_inq_dimid(in->id, "time", &id);
    code = code == NC_NOERR ? nc_inq_dimlen(in->id, id, &records) : code;
    LAC_FAIL_IF(same && code == NC_NOERR && records <= at && from->records > 0, err, LAC_EINPUT,
                "%s%s: %zu records of %llu", in->path,
                in->loss.damaged
                    ? ": lacks what its checkpoint counts on, its journal being damaged"
                    : ": is older than its checkpoint",
                records, (unsigned long long)from->records);
    code = code == NC_NOERR ? nc_inq_varid(in->id, "time", &id) : code;
    code =
        code == NC_NOERR && from->records > 0 ? nc_get_var1_double(in->id, id, &at, &last) : code;
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, "time");
    }
    LAC_FAIL_IF(!same || (from->records > 0 && last != from->last_time && last != NC_FILL_DOUBLE),
                err, LAC_EINPUT, "%s: its checkpoint is of another run, begun %s", in->path, date);
    return LAC_OK;
}

lac_status lac_store_take_over(lac_store *s, const lac_checkpoint_file *from, lac_error *err)
{
    lac_stored_file *in = NULL;
    lac_status status = LAC_OK;
    LAC_TRY(lac_stored_file_open(s->file.path, &in, err));
    LAC_TRY(check_pair(in, from, err));
    LAC_TRY(lac_nc_reserve(&s->file, in->size, err));
    LAC_TRY(copy_all(s, in, from, err));
    LAC_TRY(put_past(s, in, from, err));
    s->has_checkpoint = true;
out:
    lac_stored_file_close(in);
    return status;
}
