// SPDX-License-Identifier: GPL-3.0-or-later
// Measured heights on the grid of the interface.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "surface/fit.h"
#include "surface/registry.h"

// The unit in force: the file's own, else the case's; both only where they agree.
static lac_status choose_unit(const lac_surface_file *p, const char *key, const char *in_file,
                              const char *in_case, const char **unit, lac_error *err)
{
    if (in_file[0] != '\0' && in_case != NULL && strcmp(in_file, in_case) != 0) {
        return lac_fail(err, LAC_EINPUT,
                        "%s: the file says %s, but %s is %s; leave %s out, or correct the file",
                        p->path, in_file, key, in_case, key);
    }
    *unit = in_file[0] != '\0' ? in_file : in_case;
    return LAC_OK;
}

static lac_status scale_of(const lac_surface_file *p, const lac_units *units, const char *what,
                           const char *unit, double *scale, lac_error *err)
{
    double offset = 0.0;
    *scale = 1.0;
    if (unit == NULL) {
        return LAC_OK;
    }
    lac_status status = lac_units_convert(units, unit, "m", scale, &offset, err);
    if (status != LAC_OK) {
        return lac_fail_within(err, status, "%s: %s: unit \"%s\"", p->path, what, unit);
    }
    return LAC_OK;
}

static lac_status scale_heights(const lac_surface_file *p, double scale, lac_height_map *map,
                                lac_error *err)
{
    for (size_t i = 0; i < map->nx * map->ny; i++) {
        map->heights[i] *= scale;
        if (fabs(map->heights[i]) > 1e9) {
            return lac_fail(err, LAC_EINPUT,
                            "%s: a height of %g m in column %zu of row %zu (from the smallest y); "
                            "must be within 1e9 m: a mark for no data, or a wrong unit?",
                            p->path, map->heights[i], i % map->nx + 1, i / map->nx + 1);
        }
    }
    return LAC_OK;
}

// Heights and spacings in metres.
static lac_status convert(const lac_surface_file *p, lac_height_map *map, lac_error *err)
{
    lac_status status;
    lac_units *units = NULL;
    const char *vertical = NULL;
    const char *lateral = NULL;
    double scale = 1.0;
    bool known = !isnan(map->dx) || !isnan(map->dy);
    LAC_TRY(choose_unit(p, "unit", map->height_unit, p->unit, &vertical, err));
    LAC_TRY(choose_unit(p, "lateral_unit", map->lateral_unit, p->lateral_unit, &lateral, err));
    LAC_TRY(lac_units_create(&units, err));
    LAC_TRY(scale_of(p, units, "heights", vertical, &scale, err));
    LAC_TRY(scale_heights(p, scale, map, err));
    if (known && !isnan(p->spacing)) {
        LAC_TRY(lac_fail(err, LAC_EINPUT,
                         "%s: the file has a spacing of its own, %g by %g; leave spacing out",
                         p->path, map->dx, map->dy));
    }
    if (known) {
        LAC_TRY(scale_of(p, units, "spacing", lateral != NULL ? lateral : vertical, &scale, err));
    }
    map->dx = known ? map->dx * scale : p->spacing;
    map->dy = known ? map->dy * scale : p->spacing;
out:
    lac_units_free(units);
    return status;
}

static lac_status fill(const lac_surface_file *p, lac_height_map *map, lac_error *err)
{
    if (map->masked > 0 && p->nodata == LAC_NODATA_NEAREST) {
        return lac_fill_nearest(map, err);
    }
    if (map->masked > 0 && p->nodata == LAC_NODATA_MEAN) {
        lac_fill_mean(map);
    }
    return LAC_OK;
}

static lac_status check_complete(const lac_surface_file *p, const lac_height_map *map,
                                 const lac_grid *grid, const double *heights, lac_error *err)
{
    size_t missing = 0;
    size_t n = lac_grid_cells(grid);
    for (size_t i = 0; i < n; i++) {
        missing += isnan(heights[i]) ? 1 : 0;
    }
    return missing == 0
               ? LAC_OK
               : lac_fail(err, LAC_EINPUT,
                          "%s: %zu of the %zu cells of the interface have no height (no data in "
                          "%zu samples of the file); choose a smaller interface, or use `nodata: "
                          "nearest` or `nodata: mean`",
                          p->path, missing, n, map->masked);
}

static lac_status generate(const void *params, const lac_grid *grid, double *heights,
                           lac_error *err)
{
    const lac_surface_file *p = params;
    lac_height_map *map = NULL;
    lac_status status;
    LAC_TRY(lac_height_map_read(p->path, &map, err));
    LAC_TRY(convert(p, map, err));
    LAC_TRY(fill(p, map, err));
    LAC_TRY(lac_fit_map(p->path, map, p->fit, grid, heights, err));
    LAC_TRY(check_complete(p, map, grid, heights, err));
    lac_detrend(p->detrend, grid, heights);
    lac_taper(p->taper, grid, heights);
    if (p->taper > 0.0 && p->detrend != LAC_DETREND_NONE) {
        lac_detrend(LAC_DETREND_MEAN, grid, heights);
    }
out:
    lac_height_map_free(map);
    return status;
}

#define FIELD(name) offsetof(lac_surface_file, name)

static const char *const nodata_words[] = {"refuse", "nearest", "mean", NULL};
static const char *const fit_words[] = {"crop", "pad", "resample", NULL};
static const char *const detrend_words[] = {"none", "mean", "plane", NULL};

static const lac_param file_params[] = {
    {"path", "1", NAN, 0.0, 0.0, FIELD(path),
     ".npy, ESRI ASCII grid .asc, gridded .xyz, Gwyddion .gsf, ISO 25178-71 .sdf or netCDF; told "
     "by its content",
     .type = LAC_PATH},
    {"unit", "1", NAN, 0.0, 0.0, FIELD(unit),
     "of the heights where the file says none; m if absent", .type = LAC_TEXT,
     .flags = LAC_OPTIONAL},
    {"lateral_unit", "1", NAN, 0.0, 0.0, FIELD(lateral_unit),
     "of the file's spacing where the file says none; that of the heights if absent",
     .type = LAC_TEXT, .flags = LAC_OPTIONAL},
    {"spacing", "m", NAN, 0.0, 1e9, FIELD(spacing),
     "of the samples where the file says none; if absent they are cells of the interface, or with "
     "`fit: resample` cover it",
     .flags = LAC_OPTIONAL | LAC_ABOVE_MIN},
    {"nodata", "1", LAC_NODATA_REFUSE, 0.0, 2.0, FIELD(nodata),
     "samples without a height: refuse them, or take the nearest height or the mean of all",
     .type = LAC_CHOICE, .choices = nodata_words},
    {"fit", "1", LAC_FIT_CROP, 0.0, 2.0, FIELD(fit),
     "the middle of the file on the cells as they are (crop), its edges going on where it is "
     "smaller (pad), or interpolated bilinearly at the centres of the cells (resample)",
     .type = LAC_CHOICE, .choices = fit_words},
    {"detrend", "1", LAC_DETREND_MEAN, 0.0, 2.0, FIELD(detrend),
     "taken off the heights of the interface: nothing, their mean, or the plane of least squares",
     .type = LAC_CHOICE, .choices = detrend_words},
    {"taper", "1", 0.0, 0.0, 0.5, FIELD(taper),
     "part of each side over which the heights fade to zero at either end, after detrending",
     .type = LAC_REAL},
};

const lac_surface_source lac_surface_from_file = {
    .about =
        {
            .name = "file",
            .summary = "measured heights, read from a file",
            .reference = "",
            .params = file_params,
            .param_count = sizeof file_params / sizeof file_params[0],
            .params_size = sizeof(lac_surface_file),
        },
    .generate = generate,
};
