// SPDX-License-Identifier: GPL-3.0-or-later
// Values and attributes put into a netCDF-4 file; its errors in words.
#include "store/nc.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

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
    LAC_FAIL_MEMORY_IF(code == NC_ENOMEM || code == ENOMEM, err);
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

char *lac_nc_text_of(int file, const char *name, size_t bound)
{
    size_t length = 0;
    nc_type type = NC_NAT;
    bool there = nc_inq_att(file, NC_GLOBAL, name, &type, &length) == NC_NOERR && type == NC_CHAR &&
                 length <= bound;
    char *text = calloc((there ? length : 0) + 1, 1);
    if (text != NULL && there && nc_get_att_text(file, NC_GLOBAL, name, text) != NC_NOERR) {
        text[0] = '\0';
    }
    return text;
}
