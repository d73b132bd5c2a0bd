// SPDX-License-Identifier: GPL-3.0-or-later
// One measured face from its file: heights in metres, and gaps filled where the case wants it.

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "surface/fit.h"

// The unit in force: the file's own, else the case's; both only where they agree.
static lac_status choose_unit(const lac_face_def *def, const char *key, const char *in_file,
                              const char *in_case, const char *otherwise, const char **unit,
                              lac_error *err)
{
    LAC_FAIL_IF(in_file[0] != '\0' && in_case != NULL && strcmp(in_file, in_case) != 0, err,
                LAC_EINPUT, "%s: the file says %s, but %s is %s; leave %s out, or correct the file",
                def->path, in_file, key, in_case, key);
    *unit = in_file[0] != '\0' ? in_file : (in_case != NULL ? in_case : otherwise);
    return LAC_OK;
}

static lac_status scale_of(const lac_face_def *def, const lac_units *units, const char *what,
                           const char *unit, double *scale, lac_error *err)
{
    double offset = 0.0;
    *scale = 1.0;
    if (unit == NULL) {
        return LAC_OK;
    }
    lac_status status = lac_units_convert(units, unit, "m", scale, &offset, err);
    if (status != LAC_OK) {
        return lac_fail_within(err, status, "%s: %s: unit \"%s\"", def->path, what, unit);
    }
    return LAC_OK;
}

static lac_status scale_heights(const char *path, double scale, lac_height_map *map, lac_error *err)
{
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        map->heights[i] *= scale;
        LAC_FAIL_IF(fabs(map->heights[i]) > 1e9, err, LAC_EINPUT,
                    "%s: a height of %g m in column %zu of row %zu (from the smallest y); must be "
                    "within 1e9 m: a mark for no data, or a wrong unit?",
                    path, map->heights[i], i % map->nx + 1, i / map->nx + 1);
    }
    return LAC_OK;
}

static void keep_unit(char *text, size_t size, const char *unit)
{
    (void)snprintf(text, size, "%s", unit != NULL ? unit : "m");
}

// Heights and lengths in metres.
static lac_status convert(const lac_face_def *def, lac_height_map *map, lac_file_report *report,
                          lac_error *err)
{
    lac_status status;
    lac_units *units = NULL;
    const char *vertical = NULL;
    const char *lateral = NULL;
    double scale = 1.0;
    bool known = !isnan(map->dx) || !isnan(map->dy);
    LAC_TRY(choose_unit(def, "unit", map->height_unit, def->unit, def->other, &vertical, err));
    LAC_TRY(choose_unit(def, "lateral_unit", map->lateral_unit, def->lateral_unit,
                        def->other_lateral, &lateral, err));
    lateral = lateral != NULL ? lateral : vertical;
    LAC_TRY(lac_units_create(&units, err));
    LAC_TRY(scale_of(def, units, "heights", vertical, &scale, err));
    LAC_TRY(scale_heights(def->path, scale, map, err));
    if (known && !isnan(def->spacing)) {
        LAC_TRY(lac_fail(err, LAC_EINPUT,
                         "%s: the file has a spacing of its own, %g by %g; leave spacing out",
                         def->path, map->dx, map->dy));
    }
    if (known) {
        LAC_TRY(scale_of(def, units, "spacing", lateral, &scale, err));
    }
    double spacing = isnan(def->spacing) ? def->other_spacing : def->spacing;
    map->dx = known ? map->dx * scale : spacing;
    map->dy = known ? map->dy * scale : spacing;
    map->x *= scale;
    map->y *= scale;
    keep_unit(report->height_unit, sizeof report->height_unit, vertical);
    keep_unit(report->lateral_unit, sizeof report->lateral_unit, known ? lateral : NULL);
out:
    lac_units_free(units);
    return status;
}

static lac_status fill(int nodata, lac_height_map *map, lac_error *err)
{
    if (map->masked > 0 && nodata == LAC_NODATA_NEAREST) {
        return lac_fill_nearest(map, err);
    }
    if (map->masked > 0 && nodata == LAC_NODATA_MEAN) {
        lac_fill_mean(map);
    }
    return LAC_OK;
}

lac_status lac_face_read(const lac_face_def *def, lac_height_map **out, lac_file_report *report,
                         lac_error *err)
{
    lac_height_map *map = NULL;
    lac_status status;
    *out = NULL;
    *report = (lac_file_report){.path = def->path};
    LAC_TRY(lac_height_map_read(def->path, &map, err));
    report->format = map->format;
    report->nx = map->nx;
    report->ny = map->ny;
    report->masked = map->masked;
    LAC_TRY(convert(def, map, report, err));
    report->dx = map->dx;
    report->dy = map->dy;
    LAC_TRY(fill(def->nodata, map, err));
    *out = map;
    map = NULL;
out:
    lac_height_map_free(map);
    return status;
}
