// SPDX-License-Identifier: GPL-3.0-or-later
// What all readers of other people's netCDF files need: attributes, missing values, packed numbers.
#include "base/netcdf.h"

#include <netcdf.h>

bool lac_netcdf_begins(const void *head, size_t size)
{
    static const char magic[][5] = {"\x89HDF", "CDF\x01", "CDF\x02", "CDF\x05"};
    for (size_t i = 0; size >= 4 && i < sizeof magic / sizeof magic[0]; i++) {
        if (memcmp(head, magic[i], 4) == 0) {
            return true;
        }
    }
    return false;
}

lac_status lac_netcdf_check(const char *path, int code, const char *what, lac_error *err)
{
    if (code == NC_NOERR) {
        return LAC_OK;
    }
    LAC_FAIL_MEMORY_IF(code == NC_ENOMEM, err);
    return lac_fail(err, LAC_EINPUT, "%s: netCDF cannot read %s: %s", path, what,
                    nc_strerror(code));
}

lac_status lac_netcdf_find(const char *path, int id, const char *name, int *var, lac_error *err)
{
    char all[256] = "", one[NC_MAX_NAME + 1];
    int count = 0;
    if (nc_inq_varid(id, name, var) == NC_NOERR) {
        return LAC_OK;
    }
    (void)nc_inq_nvars(id, &count);
    for (int v = 0; v < count && nc_inq_varname(id, v, one) == NC_NOERR; v++) {
        const bool fits = strlen(all) + strlen(one) + 30 < sizeof all; // a part is no name
        lac_append(all, sizeof all, "%s%s", v > 0 ? ", " : "; its variables are ",
                   fits ? one : "...");
        count = fits ? count : v;
    }
    return lac_fail(err, LAC_EINPUT, "%s: has no variable \"%s\"%s", path, name, all);
}

static bool is_number(nc_type type)
{
    return type != NC_CHAR && type != NC_STRING && type <= NC_MAX_ATOMIC_TYPE;
}

bool lac_netcdf_runs_over(int id, int var, int rank, int *dims)
{
    int found = 0;
    nc_type type = NC_NAT;
    return nc_inq_varndims(id, var, &found) == NC_NOERR && found == rank &&
           nc_inq_vartype(id, var, &type) == NC_NOERR && is_number(type) &&
           nc_inq_vardimid(id, var, dims) == NC_NOERR;
}

bool lac_netcdf_axis(int id, int dim, char *name, int *var)
{
    int rank = 0, over = -1;
    return nc_inq_dimname(id, dim, name) == NC_NOERR && nc_inq_varid(id, name, var) == NC_NOERR &&
           nc_inq_varndims(id, *var, &rank) == NC_NOERR && rank == 1 &&
           nc_inq_vardimid(id, *var, &over) == NC_NOERR && over == dim;
}

bool lac_netcdf_text(int id, int var, const char *name, char *text, size_t size)
{
    size_t length = 0;
    nc_type type = NC_NAT;
    char *string = NULL;
    bool whole = false;
    text[0] = '\0';
    if (nc_inq_att(id, var, name, &type, &length) != NC_NOERR) {
        return false;
    }
    if (type == NC_CHAR && length < size && nc_get_att_text(id, var, name, text) == NC_NOERR) {
        text[length] = '\0';
        whole = true;
    }
    if (type == NC_STRING && length == 1 && nc_get_att_string(id, var, name, &string) == NC_NOERR &&
        string != NULL) {
        whole = strlen(string) < size;
        if (whole) {
            memcpy(text, string, strlen(string) + 1);
        }
        (void)nc_free_string(1, &string);
    }
    return whole;
}

double lac_netcdf_number(int id, int var, const char *name, double fallback)
{
    size_t length = 0;
    nc_type type = NC_NAT;
    double value = fallback;
    bool good = nc_inq_att(id, var, name, &type, &length) == NC_NOERR && length == 1 &&
                is_number(type) && nc_get_att_double(id, var, name, &value) == NC_NOERR;
    return good ? value : fallback;
}

// Bytes have no such value by themselves.
double lac_netcdf_fill(int id, int var)
{
    static const struct {
        nc_type type;
        double fill;
    } fills[] = {
        {NC_SHORT, NC_FILL_SHORT},         {NC_INT, NC_FILL_INT},
        {NC_FLOAT, (double)NC_FILL_FLOAT}, {NC_DOUBLE, NC_FILL_DOUBLE},
        {NC_USHORT, NC_FILL_USHORT},       {NC_UINT, NC_FILL_UINT},
        {NC_INT64, (double)NC_FILL_INT64}, {NC_UINT64, (double)NC_FILL_UINT64},
    };
    nc_type type = NC_NAT;
    double fill = (double)NAN;
    (void)nc_inq_vartype(id, var, &type);
    for (size_t i = 0; i < sizeof fills / sizeof *fills; i++) {
        if (fills[i].type == type) {
            fill = fills[i].fill;
        }
    }
    return lac_netcdf_number(id, var, "_FillValue", fill);
}

void lac_netcdf_unpack(int id, int var, double *x, size_t n)
{
    const double fill = lac_netcdf_fill(id, var);
    const double missing = lac_netcdf_number(id, var, "missing_value", (double)NAN);
    const double scale = lac_netcdf_number(id, var, "scale_factor", 1.0);
    const double offset = lac_netcdf_number(id, var, "add_offset", 0.0);
    for (size_t i = 0; i < n; i++) {
        bool none = x[i] == fill || x[i] == missing;
        x[i] = none ? (double)NAN : scale * x[i] + offset;
    }
}

lac_status lac_netcdf_values(const char *path, int id, int var, const char *name, size_t n,
                             double *x, lac_error *err)
{
    LAC_TRY_RETURN(lac_netcdf_check(path, nc_get_var_double(id, var, x), name, err));
    lac_netcdf_unpack(id, var, x, n);
    return LAC_OK;
}
