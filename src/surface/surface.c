// SPDX-License-Identifier: GPL-3.0-or-later
// A surface by whichever source a case names.
#include "surface/surface.h"

lac_status lac_surface_share(const lac_model *model, const lac_grid *grid, lac_team *team,
                             double *heights, lac_surface_stats *report, lac_error *err)
{
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
