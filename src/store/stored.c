// SPDX-License-Identifier: GPL-3.0-or-later
#include "lacuna/store_file.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/netcdf.h"
#include "store/input.h"

struct lac_stored_file {
    lac_input in;
    char *path; // owned
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

void lac_stored_file_close(lac_stored_file *file)
{
    if (file != NULL) {
        lac_input_close(&file->in);
        free(file->path);
        free(file);
    }
}

static lac_status read_values(const lac_stored_file *file, const char *variable, ptrdiff_t row,
                              lac_stored_values *out, lac_error *err)
{
    *out = (lac_stored_values){0};
    const lac_status status = lac_input_values(&file->in, variable, row, out, err);
    if (status != LAC_OK) {
        lac_stored_values_clear(out);
    }
    return status;
}

lac_status lac_stored_file_values(const lac_stored_file *file, const char *variable,
                                  lac_stored_values *out, lac_error *err)
{
    return read_values(file, variable, LAC_INPUT_ALL, out, err);
}

lac_status lac_stored_file_row(const lac_stored_file *file, const char *variable, size_t row,
                               lac_stored_values *out, lac_error *err)
{
    *out = (lac_stored_values){0};
    return row <= PTRDIFF_MAX
               ? read_values(file, variable, (ptrdiff_t)row, out, err)
               : lac_fail(err, LAC_EINPUT, "%s: %s has no row %zu", file->path, variable, row);
}

void lac_stored_file_comment(const lac_stored_file *file, const char *variable, char *text,
                             size_t size)
{
    lac_stored_file_text(file, variable, "comment", text, size);
}

void lac_stored_file_text(const lac_stored_file *file, const char *variable, const char *attribute,
                          char *text, size_t size)
{
    int id = 0;
    text[0] = '\0';
    if (nc_inq_varid(file->in.id, variable, &id) == NC_NOERR) {
        lac_netcdf_text(file->in.id, id, attribute, text, size);
    }
}

double lac_stored_file_number(const lac_stored_file *file, const char *variable,
                              const char *attribute)
{
    int id = 0;
    double value = NAN;
    const bool found = nc_inq_varid(file->in.id, variable, &id) == NC_NOERR &&
                       lac_input_number(&file->in, id, attribute, &value);
    return found ? value : NAN;
}

bool lac_stored_file_variable(const lac_stored_file *file, size_t index, char *name, size_t size)
{
    char longest[NC_MAX_NAME + 1];
    if (index > INT_MAX || nc_inq_varname(file->in.id, (int)index, longest) != NC_NOERR ||
        strlen(longest) >= size) {
        return false;
    }
    (void)memcpy(name, longest, strlen(longest) + 1);
    return true;
}

lac_status lac_stored_file_attribute(const lac_stored_file *file, const char *name, char *text,
                                     size_t size, lac_error *err)
{
    text[0] = '\0';
    return lac_input_attribute(&file->in, name, text, size, err);
}
