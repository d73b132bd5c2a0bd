// SPDX-License-Identifier: GPL-3.0-or-later
// Reading back. Nothing a file says is believed before it is bounded by the size of the file.
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/netcdf.h"
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
    if (code == NC_ENOTNC) {
        return lac_fail(err, LAC_EIO, "%s: is not a netCDF file", in->path);
    }
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
    if (exists && lac_nc_is_written(in->path)) {
        return lac_fail(err, LAC_EIO, "%s: another process is writing it", in->path);
    }
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

lac_status lac_input_open(lac_input *in, const char *path, lac_error *err)
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
    size_t length = 0;
    if (nc_inq_attlen(in->id, NC_GLOBAL, "lacuna_format_version", &length) != NC_NOERR) {
        return lac_fail(err, LAC_EIO, "%s: is not a file of Lacuna", path);
    }
    return LAC_OK;
}

bool lac_input_may_hold(const lac_input *in, size_t values)
{
    return values / DEFLATE_MAX <= in->size / sizeof(double);
}

static lac_status open_series(lac_input *in, const char *path, lac_error *err)
{
    lac_status status = lac_input_open(in, path, err);
    if (status != LAC_OK) {
        return status;
    }
    if (nc_inq_dimid(in->id, "time", &in->time) != NC_NOERR ||
        nc_inq_dimlen(in->id, in->time, &in->records) != NC_NOERR) {
        return lac_fail(err, LAC_EIO, "%s: holds no time series", path);
    }
    if (!lac_input_may_hold(in, in->records)) {
        return lac_fail(err, LAC_EIO, "%s: is damaged: %zu records in %zu bytes", path, in->records,
                        in->size);
    }
    return LAC_OK;
}

void lac_input_close(lac_input *in)
{
    if (in->open) {
        (void)nc_close(in->id);
        in->open = false;
    }
}

bool lac_input_number(const lac_input *in, int id, const char *name, double *value)
{
    size_t length = 0;
    return nc_inq_attlen(in->id, id, name, &length) == NC_NOERR && length == 1 &&
           nc_get_att_double(in->id, id, name, value) == NC_NOERR;
}

double lac_input_fill(const lac_input *in, int id, nc_type type)
{
    double fill = 0.0;
    if (lac_input_number(in, id, "_FillValue", &fill)) {
        return fill;
    }
    return type == NC_DOUBLE  ? NC_FILL_DOUBLE
           : type == NC_FLOAT ? (double)NC_FILL_FLOAT
           : type == NC_INT   ? (double)NC_FILL_INT
                              : (double)NC_FILL_INT64;
}

// The values of a variable over `time`, NaN where missing.
static lac_status read_variable(const lac_input *in, const char *name, double *values,
                                lac_error *err)
{
    int id = 0;
    int rank = 0;
    int dims[NC_MAX_VAR_DIMS];
    nc_type type = NC_NAT;
    if (nc_inq_varid(in->id, name, &id) != NC_NOERR) {
        return lac_fail(err, LAC_EIO, "%s: has no variable %s", in->path, name);
    }
    int code = nc_inq_varndims(in->id, id, &rank);
    if (code == NC_NOERR && rank == 1) {
        code = nc_inq_var(in->id, id, NULL, &type, NULL, dims, NULL);
    }
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    if (rank != 1 || dims[0] != in->time) {
        return lac_fail(err, LAC_EIO, "%s: %s does not run over time", in->path, name);
    }
    const size_t start = 0;
    if (in->records > 0) {
        code = nc_get_vara_double(in->id, id, &start, &in->records, values);
    }
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    double fill = lac_input_fill(in, id, type);
    for (size_t i = 0; i < in->records; i++) {
        values[i] = values[i] == fill ? NAN : values[i];
    }
    return LAC_OK;
}

bool lac_input_has_status(const lac_input *in, const char *status)
{
    char text[16] = "";
    size_t length = 0;
    if (nc_inq_attlen(in->id, NC_GLOBAL, "status", &length) != NC_NOERR || length >= sizeof text ||
        nc_get_att_text(in->id, NC_GLOBAL, "status", text) != NC_NOERR) {
        return false;
    }
    return strcmp(text, status) == 0;
}

// The last batch of a run that was killed may be torn, some variables without their values:
// shortens the series to the records of which everything is there.
static lac_status drop_torn(lac_input *in, lac_error *err)
{
    if (in->records == 0 || !lac_input_has_status(in, "running")) {
        return LAC_OK;
    }
    lac_status status = LAC_OK;
    double *values = malloc(in->records * sizeof *values);
    if (values == NULL) {
        return lac_fail_memory(err);
    }
    size_t whole = in->records;
    const lac_variable *column;
    for (size_t c = 0; (column = lac_run_column(c)) != NULL; c++) {
        if ((column->flags & LAC_MISSING) != 0) {
            continue;
        }
        LAC_TRY(read_variable(in, column->name, values, err));
        while (whole > 0 && isnan(values[whole - 1])) {
            whole--;
        }
    }
    in->records = whole;
out:
    free(values);
    return status;
}

lac_status lac_store_read(const char *path, const char *variable, double **values, size_t *n,
                          lac_error *err)
{
    *values = NULL;
    *n = 0;
    lac_input in;
    lac_status status = LAC_OK;
    LAC_TRY(open_series(&in, path, err));
    LAC_TRY(drop_torn(&in, err));
    *values = malloc((in.records > 0 ? in.records : 1) * sizeof **values);
    if (*values == NULL) {
        LAC_TRY(lac_fail_memory(err));
    }
    LAC_TRY(read_variable(&in, variable, *values, err));
    *n = in.records;
out:
    lac_input_close(&in);
    if (status != LAC_OK) {
        free(*values);
        *values = NULL;
    }
    return status;
}

static lac_status read_string(const lac_input *in, const char *name, char *text, size_t size,
                              lac_error *err)
{
    char *string = NULL;
    int code = nc_get_att_string(in->id, NC_GLOBAL, name, &string);
    if (code != NC_NOERR || string == NULL) {
        return lac_input_fail(in, code, err, name);
    }
    size_t length = strlen(string);
    if (length < size) {
        memcpy(text, string, length + 1);
    }
    (void)nc_free_string(1, &string);
    return length < size ? LAC_OK
                         : lac_fail(err, LAC_EIO, "%s: the attribute %s is longer than %zu bytes",
                                    in->path, name, size - 1);
}

static lac_status read_text(const lac_input *in, const char *name, size_t length, char *text,
                            size_t size, lac_error *err)
{
    if (length >= size || length > in->size) {
        return lac_fail(err, LAC_EIO, "%s: the attribute %s is longer than %zu bytes", in->path,
                        name, size - 1);
    }
    int code = nc_get_att_text(in->id, NC_GLOBAL, name, text);
    text[code == NC_NOERR ? length : 0] = '\0';
    return code == NC_NOERR ? LAC_OK : lac_input_fail(in, code, err, name);
}

static lac_status read_number(const lac_input *in, const char *name, char *text, size_t size,
                              lac_error *err)
{
    double value = 0.0;
    int code = nc_get_att_double(in->id, NC_GLOBAL, name, &value);
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    (void)snprintf(text, size, "%.17g", value);
    return LAC_OK;
}

lac_status lac_input_attribute(const lac_input *in, const char *name, char *text, size_t size,
                               lac_error *err)
{
    nc_type type = NC_NAT;
    size_t length = 0;
    if (nc_inq_att(in->id, NC_GLOBAL, name, &type, &length) != NC_NOERR) {
        return lac_fail(err, LAC_EIO, "%s: has no attribute %s", in->path, name);
    }
    if (type == NC_CHAR) {
        return read_text(in, name, length, text, size, err);
    }
    if (length != 1) {
        return lac_fail(err, LAC_EIO, "%s: the attribute %s is not one value", in->path, name);
    }
    return type == NC_STRING ? read_string(in, name, text, size, err)
                             : read_number(in, name, text, size, err);
}

lac_status lac_store_read_attribute(const char *path, const char *name, char *text, size_t size,
                                    lac_error *err)
{
    lac_input in;
    text[0] = '\0';
    lac_status status = lac_input_open(&in, path, err);
    if (status == LAC_OK) {
        status = lac_input_attribute(&in, name, text, size, err);
    }
    lac_input_close(&in);
    return status;
}

lac_status lac_input_must_be(const lac_input *in, const char *name, const char *unit,
                             lac_error *err)
{
    char found[32];
    int id = 0;
    if (nc_inq_varid(in->id, name, &id) != NC_NOERR) {
        return LAC_OK; // said where it is read
    }
    lac_netcdf_text(in->id, id, "units", found, sizeof found);
    if (strcmp(found, unit) != 0) {
        return lac_fail(err, LAC_EINPUT, "%s: its %s is in \"%s\": must be in %s", in->path, name,
                        found, unit);
    }
    return LAC_OK;
}

bool lac_stored_is_netcdf(const char *path)
{
    char head[4] = {0};
    struct stat about;
    // a pipe could keep us waiting for ever, and what is read from it is gone
    bool regular = stat(path, &about) == 0 && S_ISREG(about.st_mode);
    FILE *file = regular ? fopen(path, "rb") : NULL;
    size_t n = file != NULL ? fread(head, 1, sizeof head, file) : 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    return lac_netcdf_begins(head, n);
}
