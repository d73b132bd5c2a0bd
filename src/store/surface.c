// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface is like, as global attributes.
#include <math.h>
#include <stdio.h>

#include "store/nc.h"

static lac_status put_reals(const lac_nc *file, const lac_surface_measures *m, lac_error *err)
{
    const struct {
        const char *name;
        double value;
    } reals[] = {
        {"surface_rms_height_m", m->rms_height},
        {"surface_rms_slope_x", m->rms_slope_x},
        {"surface_rms_slope_y", m->rms_slope_y},
        {"surface_hurst", m->hurst},
        {"surface_hurst_error", m->hurst_error},
        {"surface_hurst_misfit", m->hurst_misfit},
        {"surface_hurst_shortest_m", m->fit_shortest},
        {"surface_hurst_longest_m", m->fit_longest},
        {"surface_z2", m->z2},
        {"surface_z2_step_m", m->z2_step},
        {"surface_jrc", m->jrc},
    };
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof reals / sizeof reals[0]; i++) {
        if (isfinite(reals[i].value)) {
            LAC_TRY(lac_nc_real(file, NC_GLOBAL, reals[i].name, reals[i].value, err));
        }
    }
out:
    return status;
}

static lac_status put_file(const lac_nc *nc, const lac_file_report *file, const char *which,
                           lac_error *err)
{
    static const char *const fits[] = {"cropped", "padded", "resampled"};
    char name[40];
    char text[256];
    char apart[64] = "";
    lac_status status;
    (void)snprintf(name, sizeof name, "surface_%s_path", which);
    LAC_TRY(lac_nc_text(nc, NC_GLOBAL, name, file->path, err));
    (void)snprintf(name, sizeof name, "surface_%s", which);
    if (!isnan(file->dx) && !isnan(file->dy)) {
        (void)snprintf(apart, sizeof apart, " %g x %g m apart", file->dx, file->dy);
    }
    (void)snprintf(text, sizeof text,
                   "%s, %zu x %zu samples%s, heights in %s, %zu without height, %s", file->format,
                   file->nx, file->ny, apart, file->height_unit, file->masked, fits[file->fit]);
    LAC_TRY(lac_nc_text(nc, NC_GLOBAL, name, text, err));
out:
    return status;
}

lac_status lac_nc_surface(const lac_nc *file, const lac_surface_report *surface, lac_error *err)
{
    static const char *const measured[] = {"interface", "file", "part", "composite"};
    lac_status status;
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "surface_measured", measured[surface->measured], err));
    LAC_TRY(put_reals(file, &surface->measures, err));
    for (size_t i = 0; i < surface->files; i++) {
        const char *which = surface->files < 2 ? "file" : (i == 0 ? "upper" : "lower");
        LAC_TRY(put_file(file, &surface->file[i], which, err));
    }
out:
    return status;
}
