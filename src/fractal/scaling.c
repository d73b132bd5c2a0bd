// SPDX-License-Identifier: GPL-3.0-or-later
#include <math.h>
#include <stdlib.h>

#include "fractal/line_fit.h"
#include "lacuna/fractal.h"

enum { LEAST_POINTS = 3 };

lac_scaling_def lac_scaling_default(void)
{
    return (lac_scaling_def){.coarsest = 64, .left_out = 1, .coarsening = LAC_SAMPLE};
}

static bool positive(double x) { return isfinite(x) && x > 0; }

static lac_status check(const lac_scaling *s, size_t left_out, lac_error *err)
{
    if (s->n > LAC_SCALING_POINTS || left_out > s->n || s->n - left_out < LEAST_POINTS) {
        return lac_fail(err, LAC_EINPUT,
                        "area scaling: %zu resolutions with %zu left out: between %d and %d must "
                        "stay to be fitted",
                        s->n, left_out, LEAST_POINTS, LAC_SCALING_POINTS);
    }
    for (size_t i = 0; i < s->n; i++) {
        const lac_resolution *at = &s->at[i];
        if (!positive(at->cell) || !positive(at->area) || !positive(at->pressure)) {
            return lac_fail(err, LAC_EINPUT,
                            "area scaling: a resolution of %g m with %g m2 in contact at %g Pa: "
                            "each must be > 0",
                            at->cell, at->area, at->pressure);
        }
        if (i > 0 && at->cell >= at[-1].cell) {
            return lac_fail(err, LAC_EINPUT,
                            "area scaling: a resolution of %g m after one of %g m: the coarsest "
                            "comes first",
                            at->cell, at[-1].cell);
        }
    }
    return LAC_OK;
}

// P = p_r A_r at every resolution.
static void check_load(lac_scaling *s)
{
    s->load = 0;
    s->load_error = 0;
    for (size_t i = 0; i < s->n; i++) {
        s->load += s->at[i].pressure * s->at[i].area / (double)s->n;
    }
    for (size_t i = 0; i < s->n; i++) {
        double off = fabs(s->at[i].pressure * s->at[i].area / s->load - 1);
        s->load_error = fmax(s->load_error, off);
    }
}

lac_status lac_scaling_fit(lac_scaling *s, size_t left_out, lac_error *err)
{
    double x[LAC_SCALING_POINTS];
    double y[LAC_SCALING_POINTS];
    lac_status status = check(s, left_out, err);
    if (status != LAC_OK) {
        return status;
    }
    for (size_t i = 0; i < s->n; i++) {
        x[i] = log(s->at[i].cell);
        y[i] = log(s->at[i].area);
    }
    for (size_t i = 0; i < s->n; i++) {
        s->at[i].local = i + 1 < s->n ? 2 - (y[i + 1] - y[i]) / (x[i + 1] - x[i]) : (double)NAN;
    }
    size_t fitted = s->n - left_out;
    lac_line line = lac_line_fit(x, y, fitted);
    s->left_out = left_out;
    s->dimension = 2 - line.slope;
    s->regression_error = line.error;
    s->error = hypot(line.error, lac_line_range_spread(x, y, fitted, line.slope));
    check_load(s);
    s->fractal_area = exp(line.intercept);
    s->fractal_pressure = s->load / s->fractal_area;
    return LAC_OK;
}

// Heights of blocks of m x m cells.
static void coarsen(const lac_contact_def *fine, size_t m, lac_coarsening how, double *heights)
{
    size_t nx = fine->grid.nx / m;
    for (size_t i = 0; i < nx * (fine->grid.ny / m); i++) {
        const double *corner = &fine->heights[i / nx * m * fine->grid.nx + i % nx * m];
        double sum = 0;
        for (size_t k = 0; k < m * m && how == LAC_BLOCK_MEAN; k++) {
            sum += corner[k / m * fine->grid.nx + k % m];
        }
        heights[i] = how == LAC_BLOCK_MEAN ? sum / (double)(m * m) : corner[0];
    }
}

// h'^2 = <(dh/dx)^2> + <(dh/dy)^2> from neighbours, round the edges.
static double rms_slope(const lac_grid *grid, const double *h)
{
    double sum = 0;
    for (size_t i = 0; i < lac_grid_cells(grid); i++) {
        size_t x = i % grid->nx;
        size_t y = i / grid->nx;
        double right = h[y * grid->nx + (x + 1) % grid->nx];
        double above = h[(y + 1) % grid->ny * grid->nx + x];
        sum += (right - h[i]) * (right - h[i]) / (grid->dx * grid->dx);
        sum += (above - h[i]) * (above - h[i]) / (grid->dy * grid->dy);
    }
    return sqrt(sum / (double)lac_grid_cells(grid));
}

// Solves one resolution: heights of blocks of m x m cells.
static lac_status solve(const lac_contact_def *fine, size_t m, lac_coarsening how, double *heights,
                        double *pressure, lac_resolution *at, lac_error *err)
{
    lac_contact_def def = *fine;
    lac_contact_report report;
    def.grid.nx /= m;
    def.grid.ny /= m;
    def.grid.dx *= (double)m;
    def.grid.dy *= (double)m;
    def.heights = heights;
    coarsen(fine, m, how, heights);
    lac_status status = lac_contact_solve(&def, pressure, NULL, &report, err);
    if (status != LAC_OK) {
        return lac_fail_within(err, status, "area scaling, %zu x %zu cells", def.grid.nx,
                               def.grid.ny);
    }
    double sum = 0;
    for (size_t i = 0; i < lac_grid_cells(&def.grid); i++) {
        sum += pressure[i];
    }
    *at = (lac_resolution){.cell = sqrt(lac_grid_cell_area(&def.grid)),
                           .area = (double)report.n_cells * lac_grid_cell_area(&def.grid),
                           .pressure = sum / (double)report.n_cells,
                           .slope = rms_slope(&def.grid, heights),
                           .cells = report.n_cells};
    return LAC_OK;
}

// How often the finest grid is halved.
static size_t halvings(const lac_grid *grid, size_t coarsest)
{
    size_t nx = grid->nx;
    size_t ny = grid->ny;
    size_t n = 0;
    while ((nx < ny ? nx : ny) > coarsest && nx % 2 == 0 && ny % 2 == 0) {
        nx /= 2;
        ny /= 2;
        n++;
    }
    return n;
}

lac_status lac_scaling_measure(const lac_contact_def *contact, const lac_scaling_def *def,
                               lac_scaling *scaling, lac_error *err)
{
    lac_status status = LAC_OK;
    size_t cells = lac_grid_cells(&contact->grid);
    size_t coarser = halvings(&contact->grid, def->coarsest);
    *scaling = (lac_scaling){.n = coarser + 1, .coarsening = def->coarsening};
    if (cells == 0 || def->coarsest == 0 || coarser >= LAC_SCALING_POINTS ||
        coarser + 1 < LEAST_POINTS + def->left_out) {
        return lac_fail(err, LAC_EINPUT,
                        "area scaling: a grid of %zu x %zu cells gives %zu resolutions down to "
                        "%zu cells, %zu of them left out: at least %d must stay",
                        contact->grid.nx, contact->grid.ny, coarser + 1, def->coarsest,
                        def->left_out, LEAST_POINTS);
    }
    double *heights = malloc(cells * sizeof *heights);
    double *pressure = malloc(cells * sizeof *pressure);
    if (heights == NULL || pressure == NULL) {
        status = lac_fail_memory(err);
        goto out;
    }
    for (size_t i = 0; i <= coarser; i++) {
        size_t m = (size_t)1 << (coarser - i);
        LAC_TRY(solve(contact, m, def->coarsening, heights, pressure, &scaling->at[i], err));
    }
    LAC_TRY(lac_scaling_fit(scaling, def->left_out, err));
out:
    free(heights);
    free(pressure);
    return status;
}
