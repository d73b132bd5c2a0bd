// SPDX-License-Identifier: GPL-3.0-or-later
// How a variable of a dataset is laid out in a netCDF-4 file: type, chunks, compression, checksums,
// attributes.
#include <assert.h>

#include "base/range.h"
#include "base/temp_file.h"
#include "store/writer.h"

enum {
    DEFLATE_MIN = 512,  // bytes of a chunk below which zlib's 270 kB of scratch win nothing
    COMPACT_MAX = 4096, // bytes of a variable that needs no chunk, no filters and no index
    MAX_RANK = LAC_MOST_DIMS + 1,
    MEANINGS = 512,
    MOST_MEANINGS = 64,
    CHUNK = 1 << 18,              // values of a map, about 2 MB
    CHUNK_CELLS = LAC_RANGE_PIECE // cells: 8 MB, within netCDF's cache
};

static bool grows(const lac_item *item) { return item->rank > 0 && item->length[0] == LAC_GROWS; }

nc_type lac_writer_type(const lac_writer *w, const lac_item *item)
{
    const unsigned flags = item->row->flags;
    if (item->is_text && (flags & LAC_MEANINGS) == 0) {
        return (flags & LAC_CHARS) != 0 ? NC_CHAR : NC_STRING;
    }
    if (item->row->held == LAC_HELD_BYTES) {
        return NC_BYTE;
    }
    if ((flags & (LAC_WHOLE | LAC_MEANINGS)) != 0) {
        return (flags & LAC_LONG) != 0 ? NC_INT64 : NC_INT;
    }
    return (flags & LAC_FLOAT) != 0 || (w->single && (flags & LAC_ROUGH) != 0) ? NC_FLOAT
                                                                               : NC_DOUBLE;
}

size_t lac_item_longest_text(const lac_item *item)
{
    char room[LAC_TEXT_ROOM];
    size_t longest = 1;
    for (size_t i = 0; i < item->count; i++) {
        const char *text = lac_item_text(item, i, room);
        const size_t length = text != NULL ? strlen(text) : 0;
        longest = length > longest ? length : longest;
    }
    return longest;
}

// Chunks grow at their end, so the cache holds one: netCDF's own table of 4133 places for them
// takes 33 kB a variable. Those of cells are written whole, once, and none is kept in memory.
// @param appended  grows by parts of a chunk
static int define_chunks(int file, int id, size_t chunk_bytes, int deflate, bool cells,
                         bool appended)
{
    int code = nc_set_var_chunk_cache(file, id, cells ? 1 : chunk_bytes, 1, 1.0F);
    if (code == NC_NOERR && deflate > 0 && chunk_bytes >= DEFLATE_MIN) {
        code = nc_def_var_deflate(file, id, NC_SHUFFLE, 1, deflate);
    }
    // A flipped bit in the data becomes an error of the reader instead of a wrong number. But a
    // chunk that is written again and again can be torn by a kill, and would then be lost whole.
    if (code == NC_NOERR && !appended) {
        code = nc_def_var_fletcher32(file, id, NC_FLETCHER32);
    }
    return code;
}

static int size_of(int file, nc_type type, int rank, const size_t *count, size_t *bytes)
{
    int code = nc_inq_type(file, type, NULL, bytes);
    for (int d = 0; d < rank; d++) {
        *bytes *= count[d];
    }
    return code;
}

// Of cells or a map: whole rows.
static void chunk_cells(size_t rank, const size_t *length, size_t cells, size_t *chunk)
{
    const size_t across = length[rank - 1];
    const size_t most = rank > 1 ? CHUNK : cells;
    chunk[rank - 1] = across < most ? across : most;
    if (rank > 1) {
        const size_t rows = CHUNK / across;
        chunk[0] = rows < 1 ? 1 : rows < length[0] ? rows : length[0];
    }
}

// @return false: netCDF chooses
static bool choose_chunk(const lac_writer *w, const lac_item *item, size_t chunk[MAX_RANK])
{
    const bool cells = (item->row->flags & LAC_CELLS) != 0;
    if (!grows(item)) {
        const bool large = item->rank == 2 && !item->is_text && item->count > CHUNK;
        if (cells || large) {
            chunk_cells(item->rank, item->length, SIZE_MAX, chunk);
        }
        return cells || large;
    }
    chunk[0] = cells ? 1 : w->chunk;
    for (size_t d = 1; d < item->rank; d++) {
        chunk[d] = item->length[d];
    }
    if (cells) {
        chunk_cells(item->rank - 1, item->length + 1, CHUNK_CELLS, chunk + 1);
    }
    return true;
}

static int define_storage(const lac_writer *w, const lac_item *item, int id, nc_type type, int rank,
                          const int *dims)
{
    const int file = w->file->id;
    const bool cells = (item->row->flags & LAC_CELLS) != 0;
    const int deflate = grows(item) ? (cells ? w->deflate : 0) : cells || rank > 1;
    size_t count[MAX_RANK], chunk[MAX_RANK];
    size_t bytes = 0;
    int code = NC_NOERR;
    for (int d = 0; code == NC_NOERR && d < rank; d++) {
        code = nc_inq_dimlen(file, dims[d], &count[d]); // an unlimited one is still empty
    }
    code = code == NC_NOERR ? size_of(file, type, rank, count, &bytes) : code;
    if (code == NC_NOERR && bytes > 0 && bytes <= COMPACT_MAX) {
        // Small and of a fixed size: the header, which has a checksum, holds it.
        return nc_def_var_chunking(file, id, NC_COMPACT, NULL);
    }
    const size_t *chosen = choose_chunk(w, item, chunk) ? chunk : NULL;
    code = code == NC_NOERR ? nc_def_var_chunking(file, id, NC_CHUNKED, chosen) : code;
    code = code == NC_NOERR ? nc_inq_var_chunking(file, id, NULL, count) : code;
    code = code == NC_NOERR ? size_of(file, type, rank, count, &bytes) : code;
    const bool filtered = type != NC_STRING; // which no filter takes
    return code == NC_NOERR && filtered
               ? define_chunks(file, id, bytes, deflate, cells, grows(item) && !cells)
               : code;
}

// The file, or the group that a name stands in, made where it is the first there.
static int find_group(int file, const char *name, int *group)
{
    char *of = strdup(name);
    int code = of == NULL ? NC_ENOMEM : NC_NOERR;
    *group = file;
    if (code == NC_NOERR && lac_path_last(name) != name) {
        of[lac_path_last(name) - name - 1] = '\0';
        code = nc_inq_grp_ncid(file, of, group);
        code = code == NC_ENOGRP ? nc_def_grp(file, of, group) : code;
    }
    free(of);
    return code;
}

// One of a file or group itself, not of what the group is in.
static bool has_dim(int file, const char *name, int *dim)
{
    int known[NC_MAX_DIMS], count = 0;
    bool own = false;
    if (nc_inq_dimid(file, name, dim) == NC_NOERR &&
        nc_inq_dimids(file, &count, known, 0) == NC_NOERR) {
        for (int i = 0; i < count; i++) {
            own = own || known[i] == *dim;
        }
    }
    return own;
}

// One that only JSON knows stands in no file. A group has dimensions of its own.
static lac_status find_dim(const lac_writer *w, const char *name, size_t length, int *dim,
                           lac_error *err)
{
    name = lac_path_last(name);
    if (has_dim(w->file->id, name, dim)) {
        return LAC_OK;
    }
    length = length == LAC_GROWS ? NC_UNLIMITED : length;
    return lac_nc_check(w->file->path, nc_def_dim(w->file->id, name, length, dim), err,
                        "define the dimension", name);
}

// CF's way to say what the numbers 0, 1 ... of a variable stand for.
static lac_status put_flags(nc_type type, const char *meanings, lac_put_numbers *put, void *to,
                            lac_error *err)
{
    double values[MOST_MEANINGS];
    size_t n = 0;
    for (const char *at = meanings; at != NULL && n < MOST_MEANINGS; n++) {
        values[n] = (double)n;
        at = strchr(at, ' ');
        at = at != NULL ? at + 1 : NULL;
    }
    LAC_TRY_RETURN(put(to, "flag_values", NULL, n, values, type, err));
    return put(to, "flag_meanings", meanings, 0, NULL, NC_CHAR, err);
}

// The places of a dimension as flags: readers of netCDF-3 and -4 alike take them.
static lac_status put_meanings(const lac_item *item, lac_put_numbers *put, void *to, lac_error *err)
{
    char meanings[MEANINGS] = "", room[LAC_TEXT_ROOM];
    for (size_t i = 0; i < item->count; i++) {
        const size_t used = strlen(meanings);
        const char *text = lac_item_text(item, i, room);
        LAC_FAIL_IF(i == MOST_MEANINGS || used + strlen(text) + 2 > sizeof meanings, err,
                    LAC_EINPUT, "%s has too many meanings", item->name);
        (void)snprintf(meanings + used, sizeof meanings - used, "%s%s", i > 0 ? " " : "", text);
    }
    return put_flags(NC_INT, meanings, put, to, err);
}

static lac_status put_fill(const lac_item *item, nc_type type, lac_put_numbers *put, void *to,
                           lac_error *err)
{
    const double fill = type == NC_INT ? NC_FILL_INT : NC_FILL_DOUBLE;
    return (item->row->flags & (LAC_MISSING | LAC_FILLED)) != 0
               ? put(to, "_FillValue", NULL, 1, &fill, type, err)
               : LAC_OK;
}

lac_status lac_writer_attributes(const lac_writer *w, const lac_item *item, lac_put_numbers *put,
                                 void *to, lac_error *err)
{
    const lac_variable *row = item->row;
    const nc_type type = lac_writer_type(w, item);
    const bool is_time = (row->flags & LAC_TIME) != 0;
    const bool dated = is_time && (w->clock == LAC_CLOCK_1970 || w->clock == LAC_CLOCK_DATE);
    const bool axis = dated && w->clock == LAC_CLOCK_DATE && strcmp(item->dims, item->name) == 0;
    const char *unit = is_time ? w->unit : item->unit != NULL ? item->unit : "1";
    const char *const texts[][2] = {
        {"long_name", item->long_name},
        {"units", type != NC_CHAR && type != NC_STRING ? unit : NULL},
        {"standard_name", dated ? "time" : row->standard_name},
        {"cell_methods", row->cell_methods},
        {"coordinates", row->coordinates},
        {"comment", row->comment},
        {"calendar", dated ? "proleptic_gregorian" : NULL},
        {"axis", axis ? "T" : row->axis},
        {"cell_measures", row->cell_measures},
    };
    lac_attribute a = {0};
    LAC_TRY_RETURN(put_fill(item, type, put, to, err));
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        LAC_TRY_RETURN(put(to, texts[i][0], texts[i][1], 0, NULL, NC_CHAR, err));
    }
    LAC_TRY_RETURN(row->meanings != NULL ? put_flags(type, row->meanings, put, to, err) : LAC_OK);
    LAC_TRY_RETURN((row->flags & LAC_MEANINGS) != 0 ? put_meanings(item, put, to, err) : LAC_OK);
    while (item->entry != NULL && lac_item_next_attribute(item, &a)) {
        LAC_TRY_RETURN(
            put(to, a.name, a.text, isfinite(a.number) ? 1 : 0, &a.number, NC_DOUBLE, err));
    }
    return LAC_OK;
}

// A variable of a file.
typedef struct place {
    const lac_nc *file;
    int id;
} place;

static lac_status put_into_file(void *to, const char *name, const char *text, size_t n,
                                const double *number, nc_type type, lac_error *err)
{
    const place *at = to;
    return n == 0 ? lac_nc_text(at->file, at->id, name, text, err)
                  : lac_nc_check(at->file->path,
                                 nc_put_att_double(at->file->id, at->id, name, type, n, number),
                                 err, "write the attribute", name);
}

lac_status lac_writer_define(const lac_writer *writer, lac_column *column, lac_error *err)
{
    const lac_item *item = &column->item;
    lac_nc within = *writer->file; // its group
    lac_writer in_group = *writer;
    const lac_writer *w = &in_group;
    in_group.file = &within;
    const int made = find_group(writer->file->id, item->name, &within.id);
    LAC_TRY_RETURN(lac_nc_check(within.path, made, err, "define the group of", item->name));
    column->file = within.id;
    const nc_type type = lac_writer_type(w, item);
    int dims[MAX_RANK] = {0};
    int rank = (int)item->rank;
    for (int d = 0; d < rank; d++) {
        LAC_TRY_RETURN(find_dim(w, item->dim[d], item->length[d], &dims[d], err));
    }
    if (type == NC_CHAR) { // rows of characters, as long as the longest text needs
        char name[NC_MAX_NAME];
        (void)snprintf(name, sizeof name, "%s_length", item->name);
        LAC_TRY_RETURN(find_dim(w, name, lac_item_longest_text(item), &dims[rank++], err));
    }
    int code = nc_def_var(w->file->id, lac_path_last(item->name), type, rank, dims, &column->id);
    if (code == NC_NOERR && rank > 0) {
        code = define_storage(w, item, column->id, type, rank, dims);
    }
    LAC_TRY_RETURN(lac_nc_check(w->file->path, code, err, "define", item->name));
    place at = {w->file, column->id};
    LAC_TRY_RETURN(lac_writer_attributes(w, item, put_into_file, &at, err));
    return lac_nc_text(w->file, column->id, "_Encoding", type == NC_CHAR ? "utf-8" : NULL, err);
}

lac_status lac_dataset_put_attributes(const lac_dataset *dataset, bool late, lac_put_attribute *put,
                                      void *to, lac_error *err)
{
    lac_item item = {0};
    lac_status status = LAC_OK;
    while (status == LAC_OK && lac_dataset_next(dataset, &item)) {
        char room[LAC_TEXT_ROOM];
        double number = NAN;
        if (!lac_item_is_global(&item) || late != ((item.row->flags & LAC_LATE) != 0)) {
            continue;
        }
        if (!item.is_text) {
            lac_item_values(&item, &number);
        }
        status = put(to, item.name, item.is_text ? lac_item_text(&item, 0, room) : NULL, number,
                     (item.row->flags & LAC_WHOLE) != 0, err);
    }
    return status;
}
