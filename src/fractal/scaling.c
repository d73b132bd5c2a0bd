// SPDX-License-Identifier: GPL-3.0-or-later
// Fractal dimension from the contact area, which shrinks as a surface is resolved more finely.
#include "base/rows.h"
#include "base/statistics.h"
#include "fractal/fractal.h"
#include "surface/surface.h"

enum { LEAST_POINTS = 3, FEW_CELLS = 100 };

const char *lac_coarsening_text(lac_coarsening coarsening)
{
    return coarsening == LAC_SAMPLE ? "point sampling" : "block means";
}

lac_scaling_def lac_scaling_default(void)
{
    return (lac_scaling_def){.coarsest = 64, .left_out = 1, .coarsening = LAC_SAMPLE};
}

static bool positive(double x) { return isfinite(x) && x > 0; }

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

// Delta_S of the slopes of the same resolutions: with A_r = kappa P / (E* h'_r) the area falls as
// the slope rises. NaN where one is not > 0.
static double dimension_of_slopes(const lac_scaling *s, const double *x, size_t n)
{
    double y[LAC_SCALING_POINTS];
    for (size_t i = 0; i < n; i++) {
        y[i] = log(1 / s->at[i].slope);
        if (!positive(s->at[i].slope)) {
            return NAN;
        }
    }
    const lac_line line = lac_line_fit(n, x, y);
    return 2 - lac_line_slope(&line);
}

void lac_scaling_fit(lac_scaling *s, size_t left_out)
{
    double x[LAC_SCALING_POINTS], y[LAC_SCALING_POINTS];
    for (size_t i = 0; i < s->n; i++) {
        x[i] = log(s->at[i].cell);
        y[i] = log(s->at[i].area);
    }
    for (size_t i = 0; i < s->n; i++) {
        s->at[i].local = i + 1 < s->n ? 2 - (y[i + 1] - y[i]) / (x[i + 1] - x[i]) : (double)NAN;
    }
    size_t fitted = s->n - left_out;
    lac_line line = lac_line_fit(fitted, x, y);
    s->left_out = left_out;
    s->dimension = 2 - lac_line_slope(&line);
    s->regression_error = lac_line_error(&line);
    s->error = hypot(s->regression_error, lac_line_range_spread(&line, x, y));
    check_load(s);
    s->from_slopes = dimension_of_slopes(s, x, fitted);
    s->few_cells = s->at[0].cells > 0 && s->at[0].cells < FEW_CELLS;
    s->fractal_area = exp(lac_line_at(&line, 0.0));
    s->fractal_pressure = s->load / s->fractal_area;
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

static lac_resolution observe(const lac_grid *grid, const double *heights, const double *pressure)
{
    double sum = 0;
    size_t cells = 0;
    for (size_t i = 0; i < lac_grid_cells(grid); i++) {
        sum += pressure[i];
        cells += pressure[i] > 0;
    }
    return (lac_resolution){.cell = sqrt(lac_grid_cell_area(grid)),
                            .area = (double)cells * lac_grid_cell_area(grid),
                            .pressure = sum / (double)cells,
                            .slope = hypot(lac_rms_slope(grid, heights, true, 1),
                                           lac_rms_slope(grid, heights, false, 1)),
                            .cells = cells};
}

// Solves one resolution: heights of blocks of m x m cells.
static lac_status solve(const lac_contact_def *fine, size_t m, lac_coarsening how, double *heights,
                        double *pressure, lac_resolution *at, lac_error *err)
{
    lac_contact_def def = *fine;
    lac_contact_stats report;
    def.grid.nx /= m;
    def.grid.ny /= m;
    def.grid.dx *= (double)m;
    def.grid.dy *= (double)m;
    def.heights = heights;
    def.start = NULL;
    coarsen(fine, m, how, heights);
    lac_status status = lac_contact_solve(&def, pressure, NULL, &report, err);
    LAC_TRY_RETURN(
        lac_fail_within(err, status, "area scaling, %zu x %zu cells", def.grid.nx, def.grid.ny));
    *at = observe(&def.grid, heights, pressure);
    return LAC_OK;
}

static size_t halvings(const lac_grid *grid, size_t coarsest)
{
    size_t nx = grid->nx, ny = grid->ny, n = 0;
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
    const size_t needed = LEAST_POINTS + def->left_out - 1;
    LAC_FAIL_IF(cells == 0 || def->coarsest == 0 || coarser >= LAC_SCALING_POINTS ||
                    coarser < needed,
                err, LAC_EINPUT,
                "area scaling: too few cells to see how the real area grows with resolution: %zu x "
                "%zu halve %zu times on the way to %zu a side, and %zu times are needed; take %zu "
                "a side, or that times 2, 4 ...",
                contact->grid.nx, contact->grid.ny, coarser, def->coarsest, needed,
                def->coarsest << needed);
    // Where the finest is known, the next one needs a quarter of the room.
    size_t room = def->finest != NULL && coarser > 0 ? cells / 4 : cells;
    double *heights = malloc(room * sizeof *heights);
    double *pressure = malloc(room * sizeof *pressure);
    LAC_TRY(heights != NULL && pressure != NULL ? LAC_OK : lac_fail_memory(err));
    for (size_t i = 0; i <= coarser; i++) {
        size_t m = (size_t)1 << (coarser - i);
        if (m == 1 && def->finest != NULL) {
            scaling->at[i] = observe(&contact->grid, contact->heights, def->finest);
            continue;
        }
        LAC_TRY(solve(contact, m, def->coarsening, heights, pressure, &scaling->at[i], err));
    }
    lac_scaling_fit(scaling, def->left_out);
out:
    free(heights);
    free(pressure);
    return status;
}

// Strength of specimens of another size, by the fractal dimension of the contact that was measured.

static lac_status check_size(const lac_size_def *def, lac_error *err)
{
    LAC_FAIL_IF(!(def->dimension > 0 && def->dimension <= 2), err, LAC_EINPUT,
                "size effect: a dimension of %g: it must be > 0 and at most 2", def->dimension);
    LAC_FAIL_IF(!(isfinite(def->error) && def->error >= 0), err, LAC_EINPUT,
                "size effect: an error of the dimension of %g", def->error);
    LAC_FAIL_IF(
        !(isfinite(def->size) && def->size > 0 && isfinite(def->pressure) && def->pressure > 0),
        err, LAC_EINPUT, "size effect: an interface of %g m under %g Pa: both must be > 0",
        def->size, def->pressure);
    return LAC_OK;
}

lac_status lac_size_effect(const lac_size_def *def, size_t n, const double *size,
                           lac_size_strength *rows, lac_error *err)
{
    LAC_TRY_RETURN(check_size(def, err));
    for (size_t i = 0; i < n; i++) {
        LAC_FAIL_IF(!(isfinite(size[i]) && size[i] > 0), err, LAC_EINPUT,
                    "size effect: a specimen of %g m: it must be > 0", size[i]);
        double ratio = size[i] / def->size;
        double relative = pow(ratio, def->dimension - 2);
        double spread = exp(fabs(def->error * log(ratio)));
        rows[i] = (lac_size_strength){.size = size[i],
                                      .pressure = def->pressure * relative,
                                      .relative = relative,
                                      .low = relative / spread,
                                      .high = relative * spread};
    }
    return LAC_OK;
}

// What has been published of the size effect on rock joints: statements of texts, not results.
#define BORRI_BRUNETTO "Borri-Brunetto, Carpinteri and Chiaia 2004, fig. 4: Bandis et al. 1981, "
#define CARPINTERI_PAGGI "Carpinteri and Paggi 2009, Chaos Solitons Fractals 39:540"

static const lac_size_exponent table[] = {
    {"shear strength", 0.23, 0.23, NAN, NAN, true, BORRI_BRUNETTO "first set"},
    {"shear strength", 0.39, 0.39, NAN, NAN, true, BORRI_BRUNETTO "second set"},
    {"shear strength", 0.34, 0.34, 0.05, 0.4, true, CARPINTERI_PAGGI ": replicas of Bandis"},
    {"friction coefficient", 0.28, 0.28, 0.05, 1000, true,
     CARPINTERI_PAGGI "; the longest length is about 1 km"},
    {"shear strength", 0.49, 0.66, 0.035, 0.19, false,
     "Korean granite at 0.29 to 2.65 MPa, abstract JAKO200614364641643; exponent derived"},
    {"shear strength", 0.03, 0.05, 0.05, 0.4, false,
     "Barton-Bandis scaling, JRC 5: JRC_n = JRC_0 (L/L_0)^(-0.02 JRC_0), JCS with 0.03, L_0 = 0.1 "
     "m"},
    {"shear strength", 0.13, 0.17, 0.05, 0.4, false, "Barton-Bandis scaling, JRC 10"},
    {"shear strength", 0.28, 0.44, 0.05, 0.4, false, "Barton-Bandis scaling, JRC 15"},
};

LAC_ROWS_AT(lac_size_exponent, lac_size_exponent_get, table)
