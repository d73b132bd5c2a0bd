// SPDX-License-Identifier: GPL-3.0-or-later
// Reading back, from a file or from a run that is still in memory. Nothing a file says is believed
// before it is bounded by the size of the file.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/need.h"
#include "base/netcdf.h"
#include "base/temp_file.h"
#include "run/describe.h"
#include "store/input.h"
#include "store/store_cells.h"

// deflate packs at most this many bytes into one.
enum { DEFLATE_MAX = 1032 };

lac_status lac_input_fail(const lac_stored_file *in, int code, lac_error *err, const char *name)
{
    return lac_fail(err, LAC_EIO, "%s: cannot read %s: %s", in->path, name,
                    code == NC_EHDFERR ? "the file is damaged" : nc_strerror(code));
}

// What can be said of a file before HDF5 opens it.
// @param copy  of a file that was not closed, to be opened in its place and removed
static lac_status inspect(lac_stored_file *in, char **copy, lac_error *err)
{
    struct stat info = {0};
    bool exists = false;
    int fd = -1;
    lac_status status;
    LAC_TRY_RETURN(lac_nc_path(in->path, &exists, err));
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
    LAC_LEAVE_IF(fd < 0 || fstat(fd, &info) != 0, err, LAC_EIO, "%s: %s", in->path,
                 strerror(errno));
    in->size = (size_t)info.st_size;
    lac_seal seal = lac_nc_seal_state(fd, in->size);
    if (seal == LAC_SEAL_BROKEN) {
        LAC_TRY(lac_fail(err, LAC_EIO, "%s: is damaged: differs from its checksum", in->path));
    } else if (seal == LAC_SEAL_NONE) {
        LAC_TRY(lac_nc_heap(in->path, fd, in->size, err));
    }
out:
    lac_temp_file_close(fd);
    return status;
}

// The first bytes of a file; of a pipe none, as what is read from it is gone and may never come.
static size_t read_head(const char *path, char head[4])
{
    struct stat info;
    bool regular = path != NULL && stat(path, &info) == 0 && S_ISREG(info.st_mode);
    FILE *file = regular ? fopen(path, "rb") : NULL;
    size_t n = file != NULL ? fread(head, 1, 4, file) : 0;
    if (file != NULL) {
        (void)fclose(file);
    }
    return n;
}

lac_status lac_stored_file_open_any(const char *path, lac_stored_file **out, lac_error *err)
{
    char *copy = NULL;
    lac_stored_file *in = *out = calloc(1, sizeof *in);
    lac_status status;
    LAC_FAIL_MEMORY_IF(in == NULL, err);
    in->path = path != NULL ? strdup(path) : NULL;
    LAC_TRY(in->path != NULL || path == NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(inspect(in, &copy, err));
    LAC_TRY(lac_need_netcdf(err));
    const int code = nc_open(copy != NULL ? copy : path, NC_NOWRITE, &in->id);
    LAC_LEAVE_IF(code != NC_NOERR, err, LAC_EIO, "%s: %s", path,
                 code == NC_ENOTNC    ? "is not a netCDF file"
                 : code == NC_EHDFERR ? "is damaged"
                                      : nc_strerror(code));
    in->open = true;
out:
    if (copy != NULL) {
        (void)unlink(copy); // it lasts while it is open
        free(copy);
    }
    LAC_MADE(status, out, lac_stored_file_close);
}

lac_status lac_stored_file_open(const char *path, lac_stored_file **out, lac_error *err)
{
    int id = 0;
    char head[4];
    *out = NULL;
    // No run is netCDF-3, of which netCDF takes whatever memory a header asks for.
    LAC_FAIL_IF(read_head(path, head) == 4 && memcmp(head, "CDF", 3) == 0, err, LAC_EIO,
                "%s: is not a file of Lacuna", path);
    LAC_TRY_RETURN(lac_stored_file_open_any(path, out, err));
    if (nc_inq_attid((*out)->id, NC_GLOBAL, "lacuna_format_version", &id) == NC_NOERR) {
        return LAC_OK;
    }
    lac_stored_file_close(*out);
    *out = NULL;
    return lac_fail(err, LAC_EIO, "%s: is not a file of Lacuna", path);
}

lac_status lac_stored_file_of(const lac_recording *recording, lac_stored_file **out, lac_error *err)
{
    *out = calloc(1, sizeof **out);
    LAC_FAIL_MEMORY_IF(*out == NULL, err);
    (*out)->recording = recording;
    return LAC_OK;
}

void lac_stored_file_close(lac_stored_file *in)
{
    if (in != NULL) {
        if (in->open) {
            (void)nc_close(in->id);
        }
        free(in->path);
        free(in);
    }
}

bool lac_input_may_hold(const lac_stored_file *in, size_t values)
{
    return values / DEFLATE_MAX <= in->size / sizeof(double);
}

// A variable of a run in memory, or one place of it.
static lac_status copy_values(const lac_dataset *kept, const char *variable, ptrdiff_t row,
                              lac_stored_values *out, lac_error *err)
{
    const double *values = lac_dataset_array(kept, variable);
    const size_t count = lac_dataset_count(kept, variable);
    size_t n = 0;
    if (count == 0) {
        return LAC_OK;
    }
    n = lac_dataset_dim(kept, variable, 0, &n) != NULL ? n : 1;
    LAC_FAIL_IF(row >= 0 && (size_t)row >= n, err, LAC_EINPUT, "%s has no row %td", variable, row);
    const size_t width = count / n, first = row >= 0 ? (size_t)row : 0, rows = row >= 0 ? 1 : n;
    double *value = malloc(rows * width * sizeof *value);
    LAC_FAIL_MEMORY_IF(value == NULL, err);
    memcpy(value, values + first * width, rows * width * sizeof *value);
    *out = (lac_stored_values){value, rows, width};
    return LAC_OK;
}

lac_status lac_stored_file_row(const lac_stored_file *in, const char *name, ptrdiff_t row,
                               lac_stored_values *out, lac_error *err)
{
    size_t start[LAC_STORED_RANK + 1] = {0}, length[LAC_STORED_RANK + 1] = {0};
    lac_stored_values read = {.n = 1, .width = 1};
    lac_stored_shape shape;
    int id = 0;
    *out = (lac_stored_values){0};
    if (in->recording != NULL) {
        return copy_values(lac_recording_dataset(in->recording), name, row, out, err);
    }
    if (nc_inq_varid(in->id, name, &id) != NC_NOERR) {
        return LAC_OK;
    }
    LAC_TRY_RETURN(lac_stored_file_shape(in, name, &shape, err));
    for (size_t d = 0; d < shape.rank; d++) {
        length[d] = shape.dim[d].length;
        *(d == 0 ? &read.n : &read.width) *= length[d];
    }
    read.n = read.width > 0 ? read.n : 0; // rows of nothing are none
    if (row != LAC_INPUT_ALL) {
        LAC_FAIL_IF((size_t)row >= read.n, err, LAC_EINPUT, "%s: %s has no row %td, but %zu",
                    in->path, name, row, read.n);
        start[0] = (size_t)row;
        read.n = length[0] = 1;
    }
    const size_t count = read.n * read.width;
    read.value = malloc((count > 0 ? count : 1) * sizeof *read.value);
    LAC_FAIL_MEMORY_IF(read.value == NULL, err);
    const int code =
        count > 0 ? nc_get_vara_double(in->id, id, start, length, read.value) : NC_NOERR;
    if (code != NC_NOERR) {
        free(read.value);
        return lac_input_fail(in, code, err, name);
    }
    const double fill = lac_netcdf_fill(in->id, id);
    for (size_t i = 0; i < count; i++) {
        read.value[i] = read.value[i] == fill ? NAN : read.value[i];
    }
    *out = read;
    return LAC_OK;
}

lac_status lac_stored_file_values(const lac_stored_file *in, const char *name,
                                  lac_stored_values *out, lac_error *err)
{
    return lac_stored_file_row(in, name, LAC_INPUT_ALL, out, err);
}

void lac_stored_values_clear(lac_stored_values *values)
{
    free(values->value);
    *values = (lac_stored_values){0};
}

// The values of a variable over a dimension, NaN where missing.
static lac_status read_over(const lac_stored_file *in, int time, const char *name,
                            lac_stored_values *out, lac_error *err)
{
    int id = 0, rank = 0, dim = -1;
    LAC_FAIL_IF(nc_inq_varid(in->id, name, &id) != NC_NOERR, err, LAC_EIO, "%s: has no variable %s",
                in->path, name);
    LAC_FAIL_IF(nc_inq_varndims(in->id, id, &rank) != NC_NOERR || rank != 1 ||
                    nc_inq_vardimid(in->id, id, &dim) != NC_NOERR || dim != time,
                err, LAC_EIO, "%s: %s does not run over time", in->path, name);
    return lac_stored_file_values(in, name, out, err);
}

bool lac_input_says(const lac_stored_file *in, const char *name, const char *expected)
{
    char text[16];
    return lac_netcdf_text(in->id, NC_GLOBAL, name, text, sizeof text) &&
           strcmp(text, expected) == 0;
}

// The last batch of a run that was killed may be torn, some variables without their values:
// shortens the series to the records of which everything is there.
static lac_status drop_torn(const lac_stored_file *in, int time, size_t *records, lac_error *err)
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

lac_status lac_stored_file_series(const lac_stored_file *in, const char *name,
                                  lac_stored_values *out, lac_error *err)
{
    size_t records = 0;
    int time = 0;
    *out = (lac_stored_values){0};
    if (in->recording != NULL) {
        return lac_stored_file_values(in, name, out, err);
    }
    LAC_FAIL_IF(nc_inq_dimid(in->id, "time", &time) != NC_NOERR ||
                    nc_inq_dimlen(in->id, time, &records) != NC_NOERR,
                err, LAC_EIO, "%s: holds no time series", in->path);
    LAC_FAIL_IF(!lac_input_may_hold(in, records), err, LAC_EIO,
                "%s: is damaged: %zu records in %zu bytes", in->path, records, in->size);
    LAC_TRY_RETURN(drop_torn(in, time, &records, err));
    LAC_TRY_RETURN(read_over(in, time, name, out, err));
    out->n = records;
    return LAC_OK;
}

// An attribute of what is in memory; NULL where there is none.
static const char *text_of(const lac_recording *recording, const char *variable,
                           const char *attribute)
{
    lac_item item;
    if (variable == NULL) {
        return lac_recording_text_of(recording, attribute);
    }
    if (!lac_dataset_find(lac_recording_dataset(recording), variable, &item)) {
        return NULL;
    }
    return strcmp(attribute, "units") == 0       ? (item.unit != NULL ? item.unit : "1")
           : strcmp(attribute, "long_name") == 0 ? item.long_name
           : strcmp(attribute, "comment") == 0   ? item.row->comment
                                                 : NULL;
}

static bool fits(const char *found, char *text, size_t size)
{
    const bool whole = found != NULL && strlen(found) < size;
    (void)memcpy(text, whole ? found : "", whole ? strlen(found) + 1 : 1);
    return whole;
}

bool lac_stored_file_text(const lac_stored_file *in, const char *variable, const char *attribute,
                          char *text, size_t size)
{
    int id = NC_GLOBAL;
    text[0] = '\0';
    if (in->recording != NULL) {
        return fits(text_of(in->recording, variable, attribute), text, size);
    }
    return (variable == NULL || nc_inq_varid(in->id, variable, &id) == NC_NOERR) &&
           lac_netcdf_text(in->id, id, attribute, text, size);
}

double lac_stored_file_number(const lac_stored_file *in, const char *variable,
                              const char *attribute)
{
    int id = NC_GLOBAL;
    if (in->recording != NULL) {
        const char *text = text_of(in->recording, variable, attribute);
        return text != NULL ? strtod(text, NULL) : NAN;
    }
    return variable == NULL || nc_inq_varid(in->id, variable, &id) == NC_NOERR
               ? lac_netcdf_number(in->id, id, attribute, NAN)
               : NAN;
}

bool lac_stored_file_variable(const lac_stored_file *in, size_t index, char *name, size_t size)
{
    char own[NC_MAX_NAME + 1];
    const char *found = own;
    if (in->recording != NULL) {
        found = lac_dataset_name(lac_recording_dataset(in->recording), index);
    } else if (index > INT_MAX || nc_inq_varname(in->id, (int)index, own) != NC_NOERR) {
        return false;
    }
    return fits(found, name, size);
}

lac_status lac_store_read_attribute(const char *path, const char *name, char *text, size_t size,
                                    lac_error *err)
{
    lac_stored_file *in = NULL;
    lac_status status = lac_stored_file_open(path, &in, err);
    text[0] = '\0';
    if (status == LAC_OK && !lac_stored_file_text(in, NULL, name, text, size)) {
        const double value = lac_stored_file_number(in, NULL, name);
        LAC_LEAVE_IF(isnan(value), err, LAC_EIO,
                     "%s: has no attribute %s of one number or at most %zu bytes", path, name,
                     size - 1);
        (void)snprintf(text, size, "%.17g", value);
    }
out:
    lac_stored_file_close(in);
    return status;
}

bool lac_stored_is_netcdf(const char *path)
{
    char head[4];
    return lac_netcdf_begins(head, read_head(path, head));
}
