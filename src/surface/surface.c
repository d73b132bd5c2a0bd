// SPDX-License-Identifier: GPL-3.0-or-later
// A surface by whichever source a case names, once its parameters and the grid are checked.
#include "surface/surface.h"

static double number(const lac_param *param, const void *params)
{
    const void *at = (const char *)params + param->offset;
    return param->type == LAC_REAL ? *(const double *)at : (double)*(const int64_t *)at;
}

static lac_status check_params(const lac_model_info *info, const void *params, lac_error *err)
{
    for (size_t i = 0; i < info->param_count; i++) {
        const lac_param *param = &info->params[i];
        bool numeric = param->type == LAC_REAL || param->type == LAC_INTEGER;
        bool given = lac_param_given(param, params);
        LAC_FAIL_IF(!given && (param->flags & LAC_OPTIONAL) == 0, err, LAC_EINPUT,
                    "%s: %s must be given", info->name, param->key);
        char why[120];
        LAC_FAIL_IF(given && numeric &&
                        !lac_param_allows(param, number(param, params), why, sizeof why),
                    err, LAC_EINPUT, "%s: %s %s", info->name, param->key, why);
    }
    return LAC_OK;
}

static lac_status check_grid(const lac_grid *grid, lac_error *err)
{
    LAC_FAIL_IF(grid->nx == 0 || grid->ny == 0, err, LAC_EINPUT,
                "a grid of %zu x %zu cells holds no surface", grid->nx, grid->ny);
    LAC_FAIL_IF(!(grid->dx > 0.0 && grid->dy > 0.0) || !isfinite(lac_grid_area(grid)), err,
                LAC_EINPUT, "cells of %g x %g m are not possible", grid->dx, grid->dy);
    return LAC_OK;
}

static lac_status check(const lac_model *model, const lac_grid *grid, lac_error *err)
{
    LAC_FAIL_IF(model->info == NULL, err, LAC_EINPUT, "no surface was chosen");
    LAC_TRY_RETURN(check_grid(grid, err));
    LAC_TRY_RETURN(check_params(model->info, model->params, err));
    const char *fault = model->info->validate != NULL ? model->info->validate(model->params) : NULL;
    LAC_FAIL_IF(fault != NULL, err, LAC_EINPUT, "%s: %s", model->info->name, fault);
    return LAC_OK;
}

lac_status lac_surface_share(const lac_model *model, const lac_grid *grid, lac_team *team,
                             double *heights, lac_surface_stats *report, lac_error *err)
{
    LAC_TRY_RETURN(check(model, grid, err));
    const lac_surface_source *source = (const void *)model->info;
    const bool whole = team != NULL && (!source->shared || grid->nx == 1 || grid->ny == 1);
    double *made = whole ? malloc(lac_grid_cells(grid) * sizeof *made) : heights;
    if (report != NULL) {
        *report = (lac_surface_stats){.measured = LAC_MEASURED_INTERFACE};
    }
    const lac_status status =
        made != NULL ? source->generate(model->params, grid, whole ? NULL : team, made, report, err)
                     : lac_fail_memory(err);
    if (whole && status == LAC_OK) {
        const lac_strip rows = lac_strip_rows(team, grid->ny);
        memcpy(heights, made + rows.first * grid->nx, rows.n * grid->nx * sizeof *made);
    }
    free(whole ? made : NULL);
    return lac_team_agree(team, status, err);
}

lac_status lac_surface_look(const lac_model *model, const lac_grid *grid, const double *heights,
                            lac_surface_stats *report, lac_error *err)
{
    const lac_surface_source *source = (const void *)model->info;
    if (report == NULL || report->files > 0) {
        return LAC_OK;
    }
    const lac_wave_range range =
        source->waves != NULL ? source->waves(model->params, grid) : (lac_wave_range){NAN, NAN};
    return lac_surface_measure(grid, heights, &range, &report->measures, err);
}

lac_status lac_surface_generate(const lac_model *model, const lac_grid *grid, double *heights,
                                lac_surface_stats *report, lac_error *err)
{
    LAC_TRY_RETURN(lac_surface_share(model, grid, NULL, heights, report, err));
    return lac_surface_look(model, grid, heights, report, err);
}
