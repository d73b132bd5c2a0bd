// SPDX-License-Identifier: GPL-3.0-or-later
// Variables laid out in a netCDF-4 file: chunks, compression, checksums; its errors in words.
#include "store/nc.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    DEFLATE_MIN = 512,  // bytes of a chunk below which zlib's 270 kB of scratch win nothing
    COMPACT_MAX = 4096, // bytes of a variable that needs no chunk, no filters and no index of them
    MAX_RANK = 4,
};

static bool is_disk_error(int code)
{
    return code == ENOSPC || code == EDQUOT || code == EFBIG || code == EIO || code == EROFS ||
           code == ENOENT || code == EACCES;
}

lac_status lac_nc_check(const char *path, int code, lac_error *err, const char *what,
                        const char *name)
{
    // HDF5 says no more than "HDF error"; what the system said is still in errno.
    int reason = errno;
    if (code == NC_NOERR) {
        return LAC_OK;
    }
    if (code == NC_ENOMEM || code == ENOMEM) {
        return lac_fail_memory(err);
    }
    const char *why = nc_strerror(code);
    if (code == NC_EHDFERR) {
        why = is_disk_error(reason) ? strerror(reason) : "the disk is full or the file is damaged";
    }
    return lac_fail(err, LAC_EIO, "%s: cannot %s%s%s: %s", path, what, *name != '\0' ? " " : "",
                    name, why);
}

int lac_nc_put_values(int file, nc_type type, int id, const size_t *start, const size_t *count,
                      const void *values)
{
    return type == NC_UBYTE   ? nc_put_vara_uchar(file, id, start, count, values)
           : type == NC_INT64 ? nc_put_vara_longlong(file, id, start, count, values)
                              : nc_put_vara_double(file, id, start, count, values);
}

lac_status lac_nc_dim(const lac_nc *file, const char *name, size_t length, int *dim, lac_error *err)
{
    return lac_nc_check(file->path, nc_def_dim(file->id, name, length, dim), err,
                        "define the dimension", name);
}

lac_status lac_nc_text(const lac_nc *file, int var, const char *name, const char *text,
                       lac_error *err)
{
    if (text == NULL || *text == '\0') {
        return LAC_OK;
    }
    return lac_nc_check(file->path, nc_put_att_text(file->id, var, name, strlen(text), text), err,
                        "write the attribute", name);
}

lac_status lac_nc_real(const lac_nc *file, int var, const char *name, double value, lac_error *err)
{
    return lac_nc_check(file->path, nc_put_att_double(file->id, var, name, NC_DOUBLE, 1, &value),
                        err, "write the attribute", name);
}

lac_status lac_nc_integer(const lac_nc *file, int var, const char *name, long long value,
                          lac_error *err)
{
    nc_type type = value >= INT32_MIN && value <= INT32_MAX ? NC_INT : NC_INT64;
    return lac_nc_check(file->path, nc_put_att_longlong(file->id, var, name, type, 1, &value), err,
                        "write the attribute", name);
}

static int define_fill(int file, int id, nc_type type)
{
    const double real = NC_FILL_DOUBLE;
    const float single = NC_FILL_FLOAT;
    const int integer = NC_FILL_INT;
    switch (type) {
    case NC_DOUBLE:
        return nc_def_var_fill(file, id, NC_FILL, &real);
    case NC_FLOAT:
        return nc_def_var_fill(file, id, NC_FILL, &single);
    case NC_INT:
        return nc_def_var_fill(file, id, NC_FILL, &integer);
    default:
        return NC_EBADTYPE;
    }
}

// Chunks are written whole, once, or grow at their end, so the cache holds one: netCDF's own table
// of 4133 places for them takes 33 kB a variable.
static int define_chunks(int file, int id, const lac_nc_var *var, size_t chunk_bytes, int deflate)
{
    int code = nc_set_var_chunk_cache(file, id, chunk_bytes, 1, 1.0F);
    if (code == NC_NOERR && deflate > 0 && chunk_bytes >= DEFLATE_MIN) {
        code = nc_def_var_deflate(file, id, NC_SHUFFLE, 1, deflate);
    }
    // A flipped bit in the data becomes an error of the reader instead of a wrong number. But a
    // chunk that is written again and again can be torn by a kill, and would then be lost whole.
    if (code == NC_NOERR && !var->appended) {
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

// @param chunk  NULL: netCDF chooses
static int define_storage(int file, int id, const size_t *chunk, const lac_nc_var *var, int deflate)
{
    size_t count[MAX_RANK];
    size_t bytes = 0;
    int dims[MAX_RANK];
    int rank = 0;
    int code = nc_inq_var(file, id, NULL, NULL, &rank, dims, NULL);
    for (int d = 0; code == NC_NOERR && d < rank; d++) {
        code = nc_inq_dimlen(file, dims[d], &count[d]); // an unlimited one is still empty
    }
    code = code == NC_NOERR ? size_of(file, var->type, rank, count, &bytes) : code;
    if (code == NC_NOERR && bytes > 0 && bytes <= COMPACT_MAX) {
        // Small and of a fixed size: the header, which has a checksum, holds it.
        return nc_def_var_chunking(file, id, NC_COMPACT, NULL);
    }
    code = code == NC_NOERR ? nc_def_var_chunking(file, id, NC_CHUNKED, chunk) : code;
    code = code == NC_NOERR ? nc_inq_var_chunking(file, id, NULL, count) : code;
    code = code == NC_NOERR ? size_of(file, var->type, rank, count, &bytes) : code;
    return code == NC_NOERR ? define_chunks(file, id, var, bytes, deflate) : code;
}

lac_status lac_nc_define(const lac_nc *file, const lac_nc_var *var, int rank, const int *dims,
                         const size_t *chunk, int deflate, int *id, lac_error *err)
{
    lac_status status = LAC_OK;
    assert(rank <= MAX_RANK);
    int code = nc_def_var(file->id, var->name, var->type, rank, dims, id);
    if (code == NC_NOERR && rank > 0) {
        code = define_storage(file->id, *id, chunk, var, deflate);
    }
    if (code == NC_NOERR && var->fill) {
        code = define_fill(file->id, *id, var->type);
    }
    LAC_TRY(lac_nc_check(file->path, code, err, "define", var->name));
    LAC_TRY(lac_nc_text(file, *id, "long_name", var->long_name, err));
    LAC_TRY(lac_nc_text(file, *id, "units", var->unit, err));
    LAC_TRY(lac_nc_text(file, *id, "standard_name", var->standard_name, err));
    LAC_TRY(lac_nc_text(file, *id, "cell_methods", var->cell_methods, err));
    LAC_TRY(lac_nc_text(file, *id, "coordinates", var->coordinates, err));
    LAC_TRY(lac_nc_text(file, *id, "comment", var->comment, err));
out:
    return status;
}

lac_status lac_nc_reals(const lac_nc *file, const lac_nc_var *var, int rank, const int *dims,
                        int deflate, const double *values, int *id, lac_error *err)
{
    int own = 0;
    id = id != NULL ? id : &own;
    lac_status status = lac_nc_define(file, var, rank, dims, NULL, deflate, id, err);
    if (status != LAC_OK) {
        return status;
    }
    errno = 0;
    return lac_nc_check(file->path, nc_put_var_double(file->id, *id, values), err, "write",
                        var->name);
}
