// SPDX-License-Identifier: GPL-3.0-or-later
// One way to read a run, whether it is in a file or still in memory.
#include "store/store_file.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/netcdf.h"
#include "store/input.h"

struct lac_stored_file {
    lac_input in;
    char *path;                     // owned
    const lac_recording *recording; // read instead of a file; NULL: a file
};

lac_status lac_stored_file_open(const char *path, lac_stored_file **out, lac_error *err)
{
    lac_stored_file *file = calloc(1, sizeof *file);
    lac_status status;
    *out = file;
    LAC_TRY(file != NULL ? LAC_OK : lac_fail_memory(err));
    file->path = strdup(path);
    LAC_TRY(file->path != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_input_open(&file->in, file->path, err));
out:
    if (status != LAC_OK) {
        lac_stored_file_close(file);
        *out = NULL;
    }
    return status;
}

lac_status lac_stored_file_of(const lac_recording *recording, lac_stored_file **out, lac_error *err)
{
    *out = calloc(1, sizeof **out);
    LAC_FAIL_MEMORY_IF(*out == NULL, err);
    (*out)->recording = recording;
    return LAC_OK;
}

void lac_stored_file_close(lac_stored_file *file)
{
    if (file != NULL) {
        if (file->recording == NULL) {
            lac_input_close(&file->in);
        }
        free(file->path);
        free(file);
    }
}

// A variable of a recording, or one place of it.
static lac_status copy_values(const lac_recording *recording, const char *variable, ptrdiff_t row,
                              lac_stored_values *out, lac_error *err)
{
    const lac_column *c = lac_recording_find(recording, variable);
    *out = (lac_stored_values){0};
    if (c == NULL || c->values == NULL) {
        return LAC_OK;
    }
    const size_t n = c->along != LAC_ONCE ? c->count / c->item.count
                     : c->item.rank > 0   ? c->item.length[0]
                                          : 1;
    const size_t width = n > 0 ? c->count / n : 0;
    LAC_FAIL_IF(row >= 0 && (size_t)row >= n, err, LAC_EINPUT, "%s has no row %td", variable, row);
    const size_t first = row >= 0 ? (size_t)row : 0, rows = row >= 0 ? 1 : n;
    double *value = malloc((rows * width + 1) * sizeof *value);
    LAC_FAIL_MEMORY_IF(value == NULL, err);
    memcpy(value, c->values + first * width, rows * width * sizeof *value);
    *out = (lac_stored_values){value, rows, width};
    return LAC_OK;
}

lac_status lac_stored_file_row(const lac_stored_file *file, const char *variable, ptrdiff_t row,
                               lac_stored_values *out, lac_error *err)
{
    return file->recording != NULL ? copy_values(file->recording, variable, row, out, err)
                                   : lac_input_values(&file->in, variable, row, out, err);
}

lac_status lac_stored_file_values(const lac_stored_file *file, const char *variable,
                                  lac_stored_values *out, lac_error *err)
{
    return lac_stored_file_row(file, variable, LAC_INPUT_ALL, out, err);
}

lac_status lac_stored_file_series(const lac_stored_file *file, const char *variable,
                                  lac_stored_values *out, lac_error *err)
{
    *out = (lac_stored_values){0};
    return file->recording != NULL ? copy_values(file->recording, variable, LAC_INPUT_ALL, out, err)
                                   : lac_input_series(&file->in, variable, out, err);
}

// An attribute of a recording's variable; NULL where there is none.
static const char *text_of(const lac_recording *recording, const char *variable,
                           const char *attribute)
{
    const lac_column *c = lac_recording_find(recording, variable);
    if (c == NULL) {
        return NULL;
    }
    return strcmp(attribute, "units") == 0       ? (c->item.unit != NULL ? c->item.unit : "1")
           : strcmp(attribute, "long_name") == 0 ? c->item.long_name
           : strcmp(attribute, "comment") == 0   ? c->item.comment
                                                 : NULL;
}

bool lac_stored_file_text(const lac_stored_file *file, const char *variable, const char *attribute,
                          char *text, size_t size)
{
    int id = NC_GLOBAL;
    text[0] = '\0';
    if (file->recording != NULL) {
        const char *found = variable != NULL ? text_of(file->recording, variable, attribute)
                                             : lac_recording_text_of(file->recording, attribute);
        const bool fits = found != NULL && strlen(found) < size;
        (void)memcpy(text, fits ? found : "", fits ? strlen(found) + 1 : 1);
        return fits;
    }
    return (variable == NULL || nc_inq_varid(file->in.id, variable, &id) == NC_NOERR) &&
           lac_netcdf_text(file->in.id, id, attribute, text, size);
}

double lac_stored_file_number(const lac_stored_file *file, const char *variable,
                              const char *attribute)
{
    char text[64];
    int id = NC_GLOBAL;
    if (file->recording != NULL) {
        return lac_stored_file_text(file, variable, attribute, text, sizeof text)
                   ? strtod(text, NULL)
                   : NAN;
    }
    return variable == NULL || nc_inq_varid(file->in.id, variable, &id) == NC_NOERR
               ? lac_netcdf_number(file->in.id, id, attribute, NAN)
               : NAN;
}

bool lac_stored_file_variable(const lac_stored_file *file, size_t index, char *name, size_t size)
{
    char longest[NC_MAX_NAME + 1];
    const bool kept = file->recording != NULL;
    const lac_column *c = kept ? lac_recording_get(file->recording, index) : NULL;
    const char *found = c != NULL ? c->item.name : longest;
    if (kept ? c == NULL
             : index > INT_MAX || nc_inq_varname(file->in.id, (int)index, longest) != NC_NOERR) {
        return false;
    }
    if (strlen(found) >= size) {
        return false;
    }
    (void)memcpy(name, found, strlen(found) + 1);
    return true;
}
