// SPDX-License-Identifier: GPL-3.0-or-later
// The file of a solved contact: maps of heights, gaps and pressures.
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "store/contact_fractal.h"
#include "store/nc.h"

enum { ROW_CHUNK_CELLS = 1 << 18 }; // cells a chunk: whole rows, about 2 MB

typedef struct lac_map {
    lac_nc_var var;
    const double *values;
} lac_map;

static lac_status put_axis(const lac_nc *file, const char *name, const char *long_name, size_t n,
                           double step, int *dim, lac_error *err)
{
    const lac_nc_var var = {.name = name, .unit = "m", .long_name = long_name, .type = NC_DOUBLE};
    const char axis[2] = {name[0] == 'x' ? 'X' : 'Y', '\0'};
    int id = 0;
    lac_status status = LAC_OK;
    double *values = malloc(n * sizeof *values);
    if (values == NULL) {
        return lac_fail_memory(err);
    }
    for (size_t i = 0; i < n; i++) {
        values[i] = ((double)i + 0.5) * step;
    }
    LAC_TRY(lac_nc_dim(file, name, n, dim, err));
    LAC_TRY(lac_nc_define(file, &var, 1, dim, NULL, 0, &id, err));
    LAC_TRY(lac_nc_text(file, id, "axis", axis, err));
    LAC_TRY(lac_nc_check(file->path, nc_put_var_double(file->id, id, values), err, "write", name));
out:
    free(values);
    return status;
}

static lac_status put_maps(const lac_nc *file, const lac_grid *grid, const lac_map *maps,
                           size_t count, lac_error *err)
{
    lac_status status = LAC_OK;
    int dims[2] = {0, 0};
    LAC_TRY(put_axis(file, "y", "position of the cell's centre along y", grid->ny, grid->dy,
                     &dims[0], err));
    LAC_TRY(put_axis(file, "x", "position of the cell's centre along x, the direction of slip",
                     grid->nx, grid->dx, &dims[1], err));
    size_t rows = ROW_CHUNK_CELLS / grid->nx;
    rows = rows < 1 ? 1 : rows;
    const size_t chunk[2] = {rows < grid->ny ? rows : grid->ny,
                             grid->nx < ROW_CHUNK_CELLS ? grid->nx : ROW_CHUNK_CELLS};
    for (size_t i = 0; i < count; i++) {
        int id = 0;
        if (maps[i].values == NULL) {
            continue;
        }
        LAC_TRY(lac_nc_define(file, &maps[i].var, 2, dims, chunk, 1, &id, err));
        errno = 0;
        LAC_TRY(lac_nc_check(file->path, nc_put_var_double(file->id, id, maps[i].values), err,
                             "write", maps[i].var.name));
    }
out:
    return status;
}

static lac_status put_report(const lac_nc *file, const lac_grid *grid,
                             const lac_contact_report *report, lac_error *err)
{
    const struct {
        const char *name;
        double value;
    } reals[] = {
        {"contact_fraction", (double)report->n_cells / (double)lac_grid_cells(grid)},
        {"complementarity_error", report->complementarity_error},
        {"penetration_m", report->penetration},
        {"load_error", report->load_error},
        {"mean_pressure_Pa", report->mean_pressure},
        {"max_pressure_Pa", report->max_pressure},
        {"approach_m", report->approach},
    };
    lac_status status = LAC_OK;
    for (size_t i = 0; i < sizeof reals / sizeof reals[0]; i++) {
        if (isfinite(reals[i].value)) {
            LAC_TRY(lac_nc_real(file, NC_GLOBAL, reals[i].name, reals[i].value, err));
        }
    }
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "n_cells", (long long)report->n_cells, err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "iterations", report->iterations, err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "operator_products", report->products, err));
out:
    return status;
}

lac_status lac_nc_contact(const lac_nc *file, const lac_contact_view *contact, lac_error *err)
{
    const lac_map maps[] = {
        {{.name = "heights",
          .unit = "m",
          .long_name = "composite height of the two surfaces",
          .comment = "peaks up; contact of the sum on a flat",
          .type = NC_DOUBLE},
         contact->heights},
        {{.name = "gap",
          .unit = "m",
          .long_name = "gap between the surfaces under load",
          .comment = "zero in contact, within the solver's tolerance",
          .type = NC_DOUBLE},
         contact->gap},
        {{.name = "pressure",
          .unit = "Pa",
          .long_name = "normal contact pressure",
          .comment = "exactly zero outside the contact",
          .type = NC_DOUBLE},
         contact->pressure},
    };
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "boundary", contact->grid->periodic ? "periodic" : "free",
                        err));
    LAC_TRY(put_maps(file, contact->grid, maps, sizeof maps / sizeof maps[0], err));
    if (contact->report != NULL) {
        LAC_TRY(put_report(file, contact->grid, contact->report, err));
    }
    if (contact->surface != NULL) {
        LAC_TRY(lac_nc_surface(file, contact->surface, err));
    }
    LAC_TRY(lac_nc_fractal(file, contact, err));
out:
    return status;
}

static lac_status put_all(const lac_nc *file, void *contact, lac_error *err)
{
    lac_status status = lac_nc_contact(file, contact, err);
    return status == LAC_OK ? lac_nc_text(file, NC_GLOBAL, "status", "complete", err) : status;
}

lac_status lac_store_contact(const char *path, bool force, const lac_provenance *provenance,
                             const lac_contact_view *contact, lac_error *err)
{
    lac_contact_view view = *contact;
    return lac_nc_write(path, force, provenance,
                        "Contact of a rough rock joint under normal load: maps over the "
                        "interface, and the fractal measures of the contact domain.",
                        put_all, &view, err);
}
