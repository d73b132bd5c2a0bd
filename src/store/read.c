// SPDX-License-Identifier: GPL-3.0-or-later
// Reading back. Nothing a file says is believed before it is bounded by the size of the file.
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/netcdf.h"
#include "run/describe.h"
#include "store/input.h"
#include "store/store_cells.h"

// deflate packs at most this many bytes into one.
enum { DEFLATE_MAX = 1032 };

lac_status lac_input_fail(const lac_input *in, int code, lac_error *err, const char *name)
{
    return lac_fail(err, LAC_EIO, "%s: cannot read %s: %s", in->path, name,
                    code == NC_EHDFERR ? "the file is damaged" : nc_strerror(code));
}

static lac_status fail_open(const lac_input *in, int code, lac_error *err)
{
    LAC_FAIL_IF(code == NC_ENOTNC, err, LAC_EIO, "%s: is not a netCDF file", in->path);
    const char *why = code == NC_EHDFERR ? "is damaged" : nc_strerror(code);
    return lac_fail(err, LAC_EIO, "%s: %s", in->path, why);
}

// What can be said of a file before HDF5 opens it.
// @param copy  of a file that was not closed, to be opened in its place and removed
static lac_status inspect(lac_input *in, char **copy, lac_error *err)
{
    struct stat info = {0};
    bool exists = false;
    int fd = -1;
    lac_status status = lac_nc_path(in->path, &exists, err);
    if (status != LAC_OK) {
        return status;
    }
    // What is half written would seem damaged.
    LAC_FAIL_IF(exists && lac_nc_is_written(in->path), err, LAC_EIO,
                "%s: another process is writing it", in->path);
    LAC_TRY(lac_nc_mended_copy(in->path, false, copy, &in->loss, err));
    if (*copy != NULL && in->loss.damaged && in->loss.own >= (int64_t)in->loss.records) {
        (void)unlink(*copy);
        free(*copy);
        *copy = NULL;
    }
    fd = open(*copy != NULL ? *copy : in->path, O_RDONLY | O_CLOEXEC);
    if (fd < 0 || fstat(fd, &info) != 0) {
        LAC_TRY(lac_fail(err, LAC_EIO, "%s: %s", in->path, strerror(errno)));
    }
    in->size = (size_t)info.st_size;
    lac_seal seal = lac_nc_seal_state(fd, in->size);
    if (seal == LAC_SEAL_BROKEN) {
        LAC_TRY(lac_fail(err, LAC_EIO, "%s: is damaged: differs from its checksum", in->path));
    } else if (seal == LAC_SEAL_NONE) {
        LAC_TRY(lac_nc_heap(in->path, fd, in->size, err));
    }
out:
    if (fd >= 0) {
        (void)close(fd);
    }
    return status;
}

lac_status lac_input_open_any(lac_input *in, const char *path, lac_error *err)
{
    char *copy = NULL;
    int code = NC_NOERR;
    *in = (lac_input){.path = path};
    lac_status status = inspect(in, &copy, err);
    if (status == LAC_OK) {
        code = nc_open(copy != NULL ? copy : path, NC_NOWRITE, &in->id);
    }
    if (copy != NULL) {
        (void)unlink(copy); // it lasts while it is open
        free(copy);
    }
    if (status != LAC_OK) {
        return status;
    }
    if (code != NC_NOERR) {
        return fail_open(in, code, err);
    }
    in->open = true;
    return LAC_OK;
}

lac_status lac_input_open(lac_input *in, const char *path, lac_error *err)
{
    int id = 0;
    const lac_status status = lac_input_open_any(in, path, err);
    return status != LAC_OK ||
                   nc_inq_attid(in->id, NC_GLOBAL, "lacuna_format_version", &id) == NC_NOERR
               ? status
               : lac_fail(err, LAC_EIO, "%s: is not a file of Lacuna", path);
}

bool lac_input_may_hold(const lac_input *in, size_t values)
{
    return values / DEFLATE_MAX <= in->size / sizeof(double);
}

void lac_input_close(lac_input *in)
{
    if (in->open) {
        (void)nc_close(in->id);
        in->open = false;
    }
}

double lac_input_fill(const lac_input *in, int id, nc_type type)
{
    return lac_netcdf_number(in->id, id, "_FillValue",
                             type == NC_DOUBLE  ? NC_FILL_DOUBLE
                             : type == NC_FLOAT ? (double)NC_FILL_FLOAT
                             : type == NC_INT   ? (double)NC_FILL_INT
                                                : (double)NC_FILL_INT64);
}

// Lengths of a variable's dimensions, and how many values there are in all.
static lac_status measure(const lac_input *in, int id, const char *name, size_t *length,
                          lac_stored_values *out, lac_error *err)
{
    int rank = 0;
    int dims[NC_MAX_VAR_DIMS];
    int code = nc_inq_varndims(in->id, id, &rank);
    code = code == NC_NOERR ? nc_inq_vardimid(in->id, id, dims) : code;
    out->n = 1;
    out->width = 1;
    for (int i = 0; code == NC_NOERR && i < rank; i++) {
        code = nc_inq_dimlen(in->id, dims[i], &length[i]);
        if (length[i] > 0 && out->n * out->width > SIZE_MAX / sizeof(double) / length[i]) {
            code = NC_EHDFERR;
        }
        out->n = i == 0 ? length[i] : out->n;
        out->width *= i == 0 ? 1 : length[i];
    }
    out->n = out->width > 0 ? out->n : 0; // rows of nothing are none
    if (code == NC_NOERR && !lac_input_may_hold(in, out->n * out->width)) {
        code = NC_EHDFERR;
    }
    return code == NC_NOERR ? LAC_OK : lac_input_fail(in, code, err, name);
}

lac_status lac_input_values(const lac_input *in, const char *name, ptrdiff_t row,
                            lac_stored_values *out, lac_error *err)
{
    size_t start[NC_MAX_VAR_DIMS] = {0}, length[NC_MAX_VAR_DIMS] = {0};
    lac_stored_values read = {0};
    int id = 0;
    nc_type type = NC_NAT;
    *out = read;
    if (nc_inq_varid(in->id, name, &id) != NC_NOERR) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(measure(in, id, name, length, &read, err));
    if (row != LAC_INPUT_ALL) {
        LAC_FAIL_IF((size_t)row >= read.n, err, LAC_EINPUT, "%s: %s has no row %td, but %zu",
                    in->path, name, row, read.n);
        start[0] = (size_t)row;
        read.n = length[0] = 1;
    }
    const size_t count = read.n * read.width;
    read.value = malloc((count > 0 ? count : 1) * sizeof *read.value);
    LAC_FAIL_MEMORY_IF(read.value == NULL, err);
    int code = nc_inq_vartype(in->id, id, &type);
    if (code == NC_NOERR && count > 0) {
        code = nc_get_vara_double(in->id, id, start, length, read.value);
    }
    if (code != NC_NOERR) {
        free(read.value);
        return lac_input_fail(in, code, err, name);
    }
    const double fill = lac_input_fill(in, id, type);
    for (size_t i = 0; i < count; i++) {
        read.value[i] = read.value[i] == fill ? NAN : read.value[i];
    }
    *out = read;
    return LAC_OK;
}

void lac_stored_values_clear(lac_stored_values *values)
{
    free(values->value);
    *values = (lac_stored_values){0};
}

// The values of a variable over a dimension, NaN where missing.
static lac_status read_over(const lac_input *in, int time, const char *name, lac_stored_values *out,
                            lac_error *err)
{
    int id = 0, rank = 0, dim = -1;
    LAC_FAIL_IF(nc_inq_varid(in->id, name, &id) != NC_NOERR, err, LAC_EIO, "%s: has no variable %s",
                in->path, name);
    LAC_FAIL_IF(nc_inq_varndims(in->id, id, &rank) != NC_NOERR || rank != 1 ||
                    nc_inq_vardimid(in->id, id, &dim) != NC_NOERR || dim != time,
                err, LAC_EIO, "%s: %s does not run over time", in->path, name);
    return lac_input_values(in, name, LAC_INPUT_ALL, out, err);
}

bool lac_input_says(const lac_input *in, const char *name, const char *expected)
{
    char text[16];
    return lac_netcdf_text(in->id, NC_GLOBAL, name, text, sizeof text) &&
           strcmp(text, expected) == 0;
}

// The last batch of a run that was killed may be torn, some variables without their values:
// shortens the series to the records of which everything is there.
static lac_status drop_torn(const lac_input *in, int time, size_t *records, lac_error *err)
{
    lac_status status = LAC_OK;
    const bool running = lac_input_says(in, "status", "running");
    lac_stored_values values = {0};
    const lac_variable *column;
    for (size_t c = 0; running && (column = lac_run_column(c)) != NULL; c++) {
        int id = 0; // a file of an earlier version lacks what was added since
        if ((column->flags & LAC_MISSING) != 0 ||
            nc_inq_varid(in->id, column->name, &id) != NC_NOERR) {
            continue;
        }
        lac_stored_values_clear(&values);
        LAC_TRY(read_over(in, time, column->name, &values, err));
        while (*records > 0 && isnan(values.value[*records - 1])) {
            --*records;
        }
    }
out:
    lac_stored_values_clear(&values);
    return status;
}

lac_status lac_input_series(const lac_input *in, const char *name, lac_stored_values *out,
                            lac_error *err)
{
    size_t records = 0;
    int time = 0;
    lac_status status;
    LAC_FAIL_IF(nc_inq_dimid(in->id, "time", &time) != NC_NOERR ||
                    nc_inq_dimlen(in->id, time, &records) != NC_NOERR,
                err, LAC_EIO, "%s: holds no time series", in->path);
    LAC_FAIL_IF(!lac_input_may_hold(in, records), err, LAC_EIO,
                "%s: is damaged: %zu records in %zu bytes", in->path, records, in->size);
    LAC_TRY(drop_torn(in, time, &records, err));
    LAC_TRY(read_over(in, time, name, out, err));
    out->n = records;
out:
    return status;
}

lac_status lac_store_read_attribute(const char *path, const char *name, char *text, size_t size,
                                    lac_error *err)
{
    lac_input in;
    lac_status status = lac_input_open(&in, path, err);
    text[0] = '\0';
    if (status == LAC_OK && !lac_netcdf_text(in.id, NC_GLOBAL, name, text, size)) {
        const double value = lac_netcdf_number(in.id, NC_GLOBAL, name, NAN);
        status = isnan(value)
                     ? lac_fail(err, LAC_EIO,
                                "%s: has no attribute %s of one number or at most %zu bytes", path,
                                name, size - 1)
                     : LAC_OK;
        if (status == LAC_OK) {
            (void)snprintf(text, size, "%.17g", value);
        }
    }
    lac_input_close(&in);
    return status;
}

bool lac_stored_is_netcdf(const char *path)
{
    char head[4] = {0};
    struct stat info;
    // a pipe could keep us waiting for ever, and what is read from it is gone
    bool regular = stat(path, &info) == 0 && S_ISREG(info.st_mode);
    FILE *file = regular ? fopen(path, "rb") : NULL;
    size_t n = file != NULL ? fread(head, 1, sizeof head, file) : 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    return lac_netcdf_begins(head, n);
}
