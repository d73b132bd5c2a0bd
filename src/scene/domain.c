// SPDX-License-Identifier: GPL-3.0-or-later
// The contact cells of a case that presses no surface: all, a random cascade, or those of a file.
#include "base/statistics.h"
#include "scene/internal.h"
#include "store/store_cells.h"

// How far what the pressures of a file carry may be from the load that the case states.
static const double same_load = 1e-6;

static bool nearly(double a, double b) { return fabs(a - b) <= same_load * fabs(b); }

static lac_status check_size(const char *path, size_t nx, size_t ny, const lac_grid *grid,
                             lac_error *err)
{
    LAC_FAIL_IF(nx != grid->nx || ny != grid->ny, err, LAC_EINPUT,
                "%s: has %zu x %zu cells, the interface %zu x %zu", path, nx, ny, grid->nx,
                grid->ny);
    return LAC_OK;
}

static lac_status read_stored(const char *path, const lac_grid *grid, double *pressure,
                              lac_error *err)
{
    lac_domain *domain = NULL;
    lac_status status;
    LAC_TRY(lac_stored_domain_read(path, &domain, err));
    LAC_TRY(check_size(path, domain->grid.nx, domain->grid.ny, grid, err));
    LAC_LEAVE_IF(!nearly(domain->grid.dx, grid->dx) || !nearly(domain->grid.dy, grid->dy), err,
                 LAC_EINPUT, "%s: its cells are %g m x %g m, those of the interface %g m x %g m",
                 path, domain->grid.dx, domain->grid.dy, grid->dx, grid->dy);
    for (size_t i = 0; i < domain->n; i++) {
        pressure[domain->index[i]] = domain->pressure[i];
    }
out:
    lac_domain_free(domain);
    return status;
}

// Numbers over the grid; where there is none nothing touches.
static lac_status read_grid(const char *path, const lac_grid *grid, double *pressure,
                            lac_error *err)
{
    lac_height_map *map = NULL;
    lac_status status;
    LAC_TRY(lac_height_map_read(path, &map, err));
    LAC_TRY(check_size(path, map->nx, map->ny, grid, err));
    for (size_t i = 0; i < lac_grid_cells(grid); i++) {
        pressure[i] = isnan(map->heights[i]) ? 0.0 : map->heights[i];
    }
out:
    lac_height_map_free(map);
    return status;
}

static lac_status load_cells(const lac_domain_file *file, double mean, lac_domain *domain,
                             lac_error *err)
{
    const double cells = (double)lac_grid_cells(&domain->grid);
    double carried = 0.0;
    for (size_t i = 0; i < domain->n; i++) {
        carried += domain->pressure[i] / cells;
    }
    LAC_FAIL_IF(file->pressures == LAC_PRESSURES_KEPT && !nearly(carried, mean), err, LAC_EINPUT,
                "%s: its pressures carry a mean of %.10g Pa, load.normal %.10g Pa: give that load, "
                "or pressures: scaled or equal",
                file->path, carried, mean);
    const double equal = mean * cells / (double)domain->n;
    for (size_t i = 0; file->pressures != LAC_PRESSURES_KEPT && i < domain->n; i++) {
        double scaled = domain->pressure[i] * (mean / carried);
        domain->pressure[i] = file->pressures == LAC_PRESSURES_EQUAL ? equal : scaled;
        LAC_FAIL_IF(!(domain->pressure[i] > 0.0 && isfinite(domain->pressure[i])), err, LAC_EINPUT,
                    "%s: its pressures cannot be scaled from %g Pa to %g Pa", file->path, carried,
                    mean);
    }
    return LAC_OK;
}

static lac_status from_file(const lac_case *c, const lac_grid *grid, double mean,
                            lac_domain **domain, lac_error *err)
{
    const lac_domain_file *file = c->domain.params;
    double *pressure = calloc(lac_grid_cells(grid), sizeof *pressure);
    lac_status status;
    LAC_TRY(pressure != NULL ? LAC_OK : lac_fail_memory(err));
    LAC_TRY(lac_stored_is_netcdf(file->path) ? read_stored(file->path, grid, pressure, err)
                                             : read_grid(file->path, grid, pressure, err));
    LAC_TRY(lac_fail_within(err, lac_domain_create(grid, pressure, domain, err), "%s", file->path));
    LAC_TRY(load_cells(file, mean, *domain, err));
out:
    free(pressure);
    return lac_fail_within(err, status, "interface.domain");
}

// The pressures of a domain's cells, spread about their mean; the load is held.
static lac_status spread_pressure(const lac_case *c, const lac_domain *domain, lac_error *err)
{
    const lac_heterogeneity_place place = {.domain = domain};
    double *p = domain->pressure;
    const double sum = lac_sum(domain->n, p);
    if (!lac_heterogeneity_has(&c->interface_spread, "pressure")) {
        return LAC_OK;
    }
    lac_status status =
        lac_heterogeneity_fill(&place, &c->interface_spread, "pressure", "Pa", p[0], p, err);
    LAC_TRY_RETURN(lac_fail_within(err, status, "interface.spread.pressure"));
    const double spread_sum = lac_sum(domain->n, p);
    for (size_t i = 0; i < domain->n; i++) {
        p[i] *= sum / spread_sum;
        LAC_FAIL_IF(!(isfinite(p[i]) && p[i] > 0.0), err, LAC_EINPUT,
                    "interface.spread.pressure: makes the pressure of cell %zu %g Pa: must be "
                    "finite and > 0",
                    i, p[i]);
    }
    return LAC_OK;
}

lac_status lac_scene_domain_create(const lac_case *c, lac_domain **out, lac_error *err)
{
    const double mean = lac_case_pressure(c);
    const lac_grid grid = lac_interface_grid(&c->interface);
    lac_status status;
    *out = NULL;
    if (c->domain.info == NULL) {
        return lac_domain_create(&grid, &mean, out, err);
    }
    if (c->domain.info == &lac_domain_from_file.info) {
        LAC_TRY(from_file(c, &grid, mean, out, err));
    } else {
        LAC_TRY(lac_domain_from_source(&c->domain, &grid, mean, out, err));
    }
    LAC_TRY(spread_pressure(c, *out, err));
out:
    LAC_MADE(status, out, lac_domain_free);
}
