// SPDX-License-Identifier: GPL-3.0-or-later
// What a file says of itself: dimensions of its variables, texts as values, names of attributes.
#include "base/netcdf.h"
#include "store/input.h"

// Names and lengths of all dimensions. @param shape  room for LAC_STORED_RANK of them, and one more
static int read_dims(const lac_stored_file *in, int id, int *rank, lac_stored_dim *dim)
{
    int dims[NC_MAX_VAR_DIMS];
    int code = nc_inq_varndims(in->id, id, rank);
    code = code == NC_NOERR && *rank > LAC_STORED_RANK + 1 ? NC_EMAXDIMS : code;
    code = code == NC_NOERR ? nc_inq_vardimid(in->id, id, dims) : code;
    for (int i = 0; code == NC_NOERR && i < *rank; i++) {
        char name[NC_MAX_NAME + 1];
        code = nc_inq_dim(in->id, dims[i], name, &dim[i].length);
        code = code == NC_NOERR && strlen(name) >= sizeof dim[i].name ? NC_EMAXNAME : code;
        if (code == NC_NOERR) {
            memcpy(dim[i].name, name, strlen(name) + 1);
        }
    }
    return code;
}

lac_status lac_stored_file_shape(const lac_stored_file *in, const char *variable,
                                 lac_stored_shape *out, lac_error *err)
{
    lac_stored_dim dim[LAC_STORED_RANK + 1];
    nc_type type = NC_NAT;
    int id = 0, rank = 0;
    *out = (lac_stored_shape){.count = 1};
    int code = nc_inq_varid(in->id, variable, &id);
    code = code == NC_NOERR ? nc_inq_vartype(in->id, id, &type) : code;
    code = code == NC_NOERR ? read_dims(in, id, &rank, dim) : code;
    if (code == NC_NOERR && type == NC_CHAR && rank > 0) {
        out->width = dim[--rank].length;
    }
    code = code == NC_NOERR && rank > LAC_STORED_RANK ? NC_EMAXDIMS : code;
    out->text = type == NC_CHAR || type == NC_STRING;
    out->strings = type == NC_STRING;
    for (int i = 0; code == NC_NOERR && i < rank; i++) {
        out->dim[out->rank++] = dim[i];
        if (dim[i].length > 0 && out->count > SIZE_MAX / sizeof(double) / dim[i].length) {
            code = NC_EHDFERR;
        }
        out->count *= dim[i].length;
    }
    code = code == NC_NOERR && !lac_input_may_hold(in, out->count) ? NC_EHDFERR : code;
    return code == NC_NOERR ? LAC_OK : lac_input_fail(in, code, err, variable);
}

// Rows of characters, each ended here.
static int read_chars(const lac_stored_file *in, int id, const lac_stored_shape *shape, char *room,
                      char **text)
{
    const size_t width = shape->width;
    const int code = shape->count * width > 0 ? nc_get_var_text(in->id, id, room) : NC_NOERR;
    for (size_t i = shape->count;
         code == NC_NOERR && i-- > 0;) { // from behind: they grow by a byte
        text[i] = memmove(room + i * (width + 1), room + i * width, width);
        text[i][width] = '\0';
    }
    return code;
}

// @return to be freed as one piece; NULL with `code`, or for want of memory
static char **read_strings(const lac_stored_file *in, int id, size_t n, int *code)
{
    char **text = NULL, **own = calloc(n + 1, sizeof *own);
    size_t bytes = 0, used = 0;
    *code = own == NULL ? NC_ENOMEM : n > 0 ? nc_get_var_string(in->id, id, own) : NC_NOERR;
    if (*code == NC_NOERR) {
        for (size_t i = 0; i < n; i++) {
            bytes += own[i] != NULL ? strlen(own[i]) + 1 : 1;
        }
        text = malloc((n + 1) * sizeof *text + bytes);
        for (size_t i = 0; text != NULL && i < n; i++) {
            const char *one = own[i] != NULL ? own[i] : "";
            const size_t size = strlen(one) + 1;
            text[i] = memcpy((char *)(text + n + 1) + used, one, size);
            used += size;
        }
        (void)nc_free_string(n, own);
    }
    free(own);
    return text;
}

lac_status lac_stored_file_texts(const lac_stored_file *in, const char *variable,
                                 const lac_stored_shape *shape, char ***out, lac_error *err)
{
    const size_t n = shape->count, width = shape->width;
    int id = 0, code = nc_inq_varid(in->id, variable, &id);
    *out = NULL;
    if (code == NC_NOERR && shape->strings) {
        *out = read_strings(in, id, n, &code);
    } else if (code == NC_NOERR) {
        const bool may = width < SIZE_MAX / sizeof(double) / (n + 1) &&
                         lac_input_may_hold(in, n * width / sizeof(double));
        LAC_FAIL_IF(!may, err, LAC_EIO, "%s: cannot read %s: the file is damaged", in->path,
                    variable);
        *out = malloc((n + 1) * sizeof **out + n * (width + 1) + 1);
        code = *out == NULL ? NC_ENOMEM : read_chars(in, id, shape, (char *)(*out + n + 1), *out);
    }
    LAC_FAIL_MEMORY_IF(*out == NULL && (code == NC_NOERR || code == NC_ENOMEM), err);
    if (code != NC_NOERR) {
        free((void *)*out);
        *out = NULL;
        return lac_input_fail(in, code, err, variable);
    }
    return LAC_OK;
}

bool lac_stored_file_attribute(const lac_stored_file *in, const char *variable, size_t index,
                               char *name, size_t size)
{
    char own[NC_MAX_NAME + 1];
    int id = NC_GLOBAL;
    name[0] = '\0';
    if (in->recording != NULL || index > INT_MAX ||
        (variable != NULL && nc_inq_varid(in->id, variable, &id) != NC_NOERR) ||
        nc_inq_attname(in->id, id, (int)index, own) != NC_NOERR || strlen(own) >= size) {
        return false;
    }
    memcpy(name, own, strlen(own) + 1);
    return true;
}
