// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "contact/tangential_state.h"
#include "lacuna/contact.h"

// Both methods on one grid
typedef struct comparison {
    lac_tangential_def def;
    double *heights; // [cells] those of def
    double *pressure;
    lac_tangential *direct, *superposed;
} comparison;

static bool can_halve(size_t n, size_t largest) { return n > largest && n % 2 == 0; }

// Means of 2 x 2 cells, in place; a coarse cell is never written before it is read.
static void halve(lac_grid *grid, double *heights)
{
    const size_t nx = grid->nx / 2;
    const size_t ny = grid->ny / 2;
    for (size_t j = 0; j < ny; j++) {
        for (size_t i = 0; i < nx; i++) {
            const double *low = &heights[2 * j * grid->nx + 2 * i];
            const double *high = low + grid->nx;
            heights[j * nx + i] = 0.25 * (low[0] + low[1] + high[0] + high[1]);
        }
    }
    *grid = (lac_grid){nx, ny, 2.0 * grid->dx, 2.0 * grid->dy, grid->periodic};
}

static lac_status coarsen(const lac_tangential_def *def, size_t largest, comparison *c,
                          lac_error *err)
{
    const size_t cells = lac_grid_cells(&def->grid);
    c->def = *def;
    c->heights = malloc(cells * sizeof *c->heights);
    c->pressure = calloc(cells, sizeof *c->pressure);
    if (c->heights == NULL || c->pressure == NULL) {
        return lac_fail_memory(err);
    }
    memcpy(c->heights, def->heights, cells * sizeof *c->heights);
    c->def.heights = c->heights;
    lac_grid *grid = &c->def.grid;
    while (largest > 0 && can_halve(grid->nx, largest) && can_halve(grid->ny, largest)) {
        halve(grid, c->heights);
    }
    return LAC_OK;
}

static lac_status press(const comparison *c, double mean_pressure, lac_error *err)
{
    lac_contact_def normal = lac_contact_default();
    normal.grid = c->def.grid;
    normal.heights = c->heights;
    normal.e_star = c->def.e_star;
    normal.mean_pressure = mean_pressure;
    normal.tolerance = c->def.tolerance;
    normal.max_iterations = c->def.max_iterations;
    return lac_contact_solve(&normal, c->pressure, NULL, NULL, err);
}

static lac_status shear(comparison *c, lac_shear_method method, const double load[2],
                        lac_tangential **t, lac_tangential_report *report, lac_error *err)
{
    lac_status status;
    lac_tangential_target target = {{LAC_SHEAR_LOAD, LAC_SHEAR_LOAD}, {load[0], load[1]}};
    c->def.method = method;
    LAC_TRY(lac_tangential_create(&c->def, t, err));
    LAC_TRY(lac_tangential_step(*t, c->pressure, &target, report, err));
out:
    return status;
}

// rms of the difference over the rms of the direct one
static double traction_error(const comparison *c)
{
    const size_t cells = lac_grid_cells(&c->def.grid);
    double difference = 0.0;
    double size = 0.0;
    for (int axis = 0; axis < 2; axis++) {
        const double *exact = lac_tangential_traction(c->direct, axis);
        const double *q = lac_tangential_traction(c->superposed, axis);
        for (size_t i = 0; i < cells; i++) {
            difference = hypot(difference, q[i] - exact[i]);
            size = hypot(size, exact[i]);
        }
    }
    return difference / size;
}

lac_status lac_superposed_measure(const lac_tangential_def *def, double mean_pressure,
                                  const double load[2], size_t largest, lac_superposed_error *error,
                                  lac_error *err)
{
    lac_status status;
    comparison c = {0};
    lac_tangential_report exact;
    lac_tangential_report r;
    *error = (lac_superposed_error){0};
    LAC_TRY(lac_tangential_check(def, err));
    if (def->heights == NULL || !(hypot(load[0], load[1]) > 0.0)) {
        status = lac_fail(err, LAC_EINPUT,
                          "to measure the error of superposed shear takes heights and a load, not "
                          "(%g, %g) Pa",
                          load[0], load[1]);
        goto out;
    }
    LAC_TRY(coarsen(def, largest, &c, err));
    LAC_TRY(press(&c, mean_pressure, err));
    LAC_TRY(shear(&c, LAC_SHEAR_DIRECT, load, &c.direct, &exact, err));
    LAC_TRY(shear(&c, LAC_SHEAR_SUPERPOSED, load, &c.superposed, &r, err));
    double stick = (double)r.stick_cells - (double)exact.stick_cells;
    double along = exact.shift[0] * load[0] + exact.shift[1] * load[1];
    *error = (lac_superposed_error){
        .nx = c.def.grid.nx,
        .ny = c.def.grid.ny,
        .traction = traction_error(&c),
        .stick_area = stick / (double)exact.contact_cells,
        .stick_nominal = stick / (double)lac_grid_cells(&c.def.grid),
        .shift = (r.shift[0] * load[0] + r.shift[1] * load[1]) / along - 1.0,
    };
out:
    lac_tangential_free(c.direct);
    lac_tangential_free(c.superposed);
    free(c.heights);
    free(c.pressure);
    return status;
}
