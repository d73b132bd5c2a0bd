// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "lacuna/store_events.h"
#include "store/input.h"

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
    if (code == NC_NOERR && !lac_input_may_hold(in, out->n * out->width)) {
        code = NC_EHDFERR;
    }
    return code == NC_NOERR ? LAC_OK : lac_input_fail(in, code, err, name);
}

static lac_status read_all(const lac_input *in, const char *name, lac_stored_values *out,
                           lac_error *err)
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
    const size_t count = out->n * out->width;
    out->value = malloc((count > 0 ? count : 1) * sizeof *out->value);
    if (out->value == NULL) {
        return lac_fail_memory(err);
    }
    int code = nc_inq_vartype(in->id, id, &type);
    if (code == NC_NOERR && count > 0) {
        code = nc_get_var_double(in->id, id, out->value);
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

lac_status lac_store_read_values(const char *path, const char *variable, lac_stored_values *out,
                                 lac_error *err)
{
    lac_input in;
    *out = (lac_stored_values){0};
    lac_status status = lac_input_open(&in, path, err);
    if (status == LAC_OK) {
        status = read_all(&in, variable, out, err);
    }
    lac_input_close(&in);
    if (status != LAC_OK) {
        lac_stored_values_clear(out);
    }
    return status;
}

void lac_stored_values_clear(lac_stored_values *values)
{
    free(values->value);
    *values = (lac_stored_values){0};
}
