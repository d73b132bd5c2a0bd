// SPDX-License-Identifier: GPL-3.0-or-later
// A variable of any shape as rows of doubles, unless it claims more than its file can hold.
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include "store/input.h"
#include "store/store_events.h"

static lac_status measure(const lac_input *in, int id, const char *name, lac_stored_values *out,
                          lac_error *err)
{
    int rank = 0;
    int dims[NC_MAX_VAR_DIMS];
    int code = nc_inq_varndims(in->id, id, &rank);
    if (code == NC_NOERR) {
        code = nc_inq_vardimid(in->id, id, dims);
    }
    out->n = 1;
    out->width = 1;
    for (int i = 0; code == NC_NOERR && i < rank; i++) {
        size_t length = 0;
        code = nc_inq_dimlen(in->id, dims[i], &length);
        if (length > 0 && out->n * out->width > SIZE_MAX / sizeof(double) / length) {
            code = NC_EHDFERR;
        }
        out->n = i == 0 ? length : out->n;
        out->width *= i == 0 ? 1 : length;
    }
    out->n = out->width > 0 ? out->n : 0; // rows of nothing are none
    if (code == NC_NOERR && !lac_input_may_hold(in, out->n * out->width)) {
        code = NC_EHDFERR;
    }
    return code == NC_NOERR ? LAC_OK : lac_input_fail(in, code, err, name);
}

static int get(const lac_input *in, int id, ptrdiff_t row, double *values)
{
    size_t start[NC_MAX_VAR_DIMS] = {0};
    size_t count[NC_MAX_VAR_DIMS];
    int dims[NC_MAX_VAR_DIMS];
    int rank = 0;
    if (row == LAC_INPUT_ALL) {
        return nc_get_var_double(in->id, id, values);
    }
    int code = nc_inq_varndims(in->id, id, &rank);
    code = code == NC_NOERR ? nc_inq_vardimid(in->id, id, dims) : code;
    for (int i = 0; code == NC_NOERR && i < rank; i++) {
        code = nc_inq_dimlen(in->id, dims[i], &count[i]);
    }
    start[0] = (size_t)row;
    count[0] = 1;
    return code == NC_NOERR ? nc_get_vara_double(in->id, id, start, count, values) : code;
}

lac_status lac_input_values(const lac_input *in, const char *name, ptrdiff_t row,
                            lac_stored_values *out, lac_error *err)
{
    int id = 0;
    nc_type type = NC_NAT;
    if (nc_inq_varid(in->id, name, &id) != NC_NOERR) {
        return LAC_OK;
    }
    lac_status status = measure(in, id, name, out, err);
    if (status != LAC_OK) {
        return status;
    }
    if (row != LAC_INPUT_ALL) {
        if ((size_t)row >= out->n) {
            return lac_fail(err, LAC_EINPUT, "%s: %s has no row %td, but %zu", in->path, name, row,
                            out->n);
        }
        out->n = 1;
    }
    const size_t count = out->n * out->width;
    out->value = malloc((count > 0 ? count : 1) * sizeof *out->value);
    if (out->value == NULL) {
        return lac_fail_memory(err);
    }
    int code = nc_inq_vartype(in->id, id, &type);
    if (code == NC_NOERR && count > 0) {
        code = get(in, id, row, out->value);
    }
    if (code != NC_NOERR) {
        return lac_input_fail(in, code, err, name);
    }
    const double fill = lac_input_fill(in, id, type);
    for (size_t i = 0; i < count; i++) {
        out->value[i] = out->value[i] == fill ? NAN : out->value[i];
    }
    return LAC_OK;
}

void lac_stored_values_clear(lac_stored_values *values)
{
    free(values->value);
    *values = (lac_stored_values){0};
}
