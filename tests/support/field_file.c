// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/field_file.h"

#include <netcdf.h>
#include <stdbool.h>

#include "support/test.h"

static void good(int code) { assert_int_equal(code, NC_NOERR); }

void field_file_write(const char *path, size_t times, const double *values)
{
    static const char *const names[] = {"t", "y", "x"};
    static const double place[2][3] = {{0, 4, 13}, {-1, 3, 12}};
    const bool timed = times > 0;
    int id, dim[3], var[3], value;
    good(nc_create(path, NC_CLOBBER, &id));
    for (size_t k = timed ? 0 : 1; k < 3; k++) {
        good(nc_def_dim(id, names[k], k == 0 ? times : 3, &dim[k]));
        good(nc_def_var(id, names[k], NC_DOUBLE, 1, &dim[k], &var[k]));
        good(nc_put_att_text(id, var[k], "units", 1, k == 0 ? "s" : "m"));
    }
    good(nc_def_var(id, "v", NC_DOUBLE, timed ? 3 : 2, timed ? dim : dim + 1, &value));
    good(nc_put_att_text(id, value, "units", 3, "kPa"));
    good(nc_enddef(id));
    for (size_t i = 0; i < times; i++) {
        const double t = -5 + 4.3 * (double)i;
        good(nc_put_var1_double(id, var[0], &i, &t));
    }
    good(nc_put_var_double(id, var[1], place[0]));
    good(nc_put_var_double(id, var[2], place[1]));
    good(nc_put_var_double(id, value, values));
    good(nc_close(id));
}
