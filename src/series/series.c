// SPDX-License-Identifier: GPL-3.0-or-later
// Monitoring files, text or netCDF as their first bytes say; how fine their numbers are.
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/ask.h"
#include "base/units.h"
#include "series/text.h"

lac_status lac_series_check(const lac_series_def *def, lac_error *err)
{
    LAC_FAIL_IF(def->displacement == NULL && def->velocity == NULL && def->value == NULL, err,
                LAC_EINPUT, "%s: no column of values was named", def->path);
    return LAC_OK;
}

static lac_status resolve(const lac_series *s, const double *x, double *digit, lac_error *err)
{
    return x != NULL ? lac_series_resolve(s->n, s->time, x, digit, err) : LAC_OK;
}

lac_status lac_series_read(const lac_series_def *def, const struct lac_units *units,
                           lac_series **out, lac_error *err)
{
    *out = NULL;
    FILE *stream = fopen(def->path, "rbe");
    LAC_FAIL_IF(stream == NULL, err, LAC_EIO, "%s: %s", def->path, strerror(errno));
    bool is_netcdf = lac_series_is_netcdf(stream);
    lac_status status = is_netcdf ? lac_series_read_netcdf(def, units, out, err)
                                  : lac_series_read_stream(stream, def, units, out, err);
    (void)fclose(stream);
    LAC_TRY(status);
    LAC_TRY(resolve(*out, (*out)->displacement, &(*out)->displacement_digit, err));
    LAC_TRY(resolve(*out, (*out)->velocity, &(*out)->velocity_digit, err));
out:
    if (status != LAC_OK) {
        lac_series_free(*out);
        *out = NULL;
    }
    return status;
}

lac_status lac_series_create(const lac_series_def *def, lac_series **out, lac_error *err)
{
    lac_series_def own = lac_series_def_default();
    lac_units *units = NULL;
    lac_status status;
    LAC_TRY(LAC_NEED(err, def, out));
    *out = NULL;
    LAC_TRY(lac_take_options("lac_series_def", def, &own, sizeof own, err));
    LAC_TRY(own.path != NULL ? LAC_OK : lac_fail(err, LAC_EINPUT, "a series without a path"));
    LAC_TRY(lac_series_check(&own, err));
    LAC_TRY(own.value == NULL || own.value_si != NULL
                ? LAC_OK
                : lac_fail(err, LAC_EINPUT, "%s: value_si must say the unit of %s", own.path,
                           own.value));
    LAC_TRY(lac_units_create(&units, err));
    status = lac_series_read(&own, units, out, err);
out:
    lac_units_free(units);
    return status;
}

void lac_series_free(lac_series *series)
{
    if (series == NULL) {
        return;
    }
    free(series->time);
    free(series->displacement);
    free(series->velocity);
    free(series->value);
    free(series->sigma);
    free(series->line);
    free(series->attribution);
    free(series);
}
