// SPDX-License-Identifier: GPL-3.0-or-later
// The fractal measures of a contact: one dimension each for boxes, clusters, resolutions and
// specimens, and what was fitted to them as attributes.
#include "store/contact_fractal.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>

enum { MOST_ROWS = 32 };

// One column of a table along a dimension.
typedef struct column {
    lac_nc_var var;
    double value[MOST_ROWS];
} column;

typedef struct attribute {
    const char *name;
    double value;
} attribute;

static lac_status put_columns(const lac_nc *file, const char *dimension, size_t n, column *columns,
                              size_t count, lac_error *err)
{
    lac_status status = LAC_OK;
    int dim = 0;
    LAC_TRY(lac_nc_dim(file, dimension, n, &dim, err));
    for (size_t i = 0; i < count; i++) {
        column *c = &columns[i];
        int id = 0;
        for (size_t k = 0; k < n && c->var.fill; k++) {
            c->value[k] = isfinite(c->value[k]) ? c->value[k] : NC_FILL_DOUBLE;
        }
        const size_t chunk[1] = {n};
        LAC_TRY(lac_nc_define(file, &c->var, 1, &dim, chunk, 0, &id, err));
        errno = 0;
        LAC_TRY(lac_nc_check(file->path, nc_put_var_double(file->id, id, c->value), err, "write",
                             c->var.name));
    }
out:
    return status;
}

static lac_status put_reals(const lac_nc *file, const attribute *reals, size_t count,
                            lac_error *err)
{
    lac_status status = LAC_OK;
    for (size_t i = 0; i < count; i++) {
        if (isfinite(reals[i].value)) {
            LAC_TRY(lac_nc_real(file, NC_GLOBAL, reals[i].name, reals[i].value, err));
        }
    }
out:
    return status;
}

static lac_status put_box_fit(const lac_nc *file, const lac_box_count *boxes, lac_error *err)
{
    bool ranged = boxes->fit_first < boxes->sizes && boxes->fit_last < boxes->sizes;
    const attribute reals[] = {
        {"d_box", boxes->dimension},
        {"d_box_error", boxes->error},
        {"d_box_regression_error", boxes->regression_error},
        {"d_box_fit_smallest_cells", ranged ? boxes->side[boxes->fit_first] : NAN},
        {"d_box_fit_largest_cells", ranged ? boxes->side[boxes->fit_last] : NAN},
    };
    lac_status status = LAC_OK;
    LAC_TRY(put_reals(file, reals, sizeof reals / sizeof reals[0], err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "d_box_few_cells", boxes->few_cells, err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "d_box_dense", boxes->dense, err));
out:
    return status;
}

static lac_status put_boxes(const lac_nc *file, const lac_box_count *boxes, lac_error *err)
{
    column table[] = {
        {{.name = "box_side", .unit = "1", .long_name = "side of a box, in cells"}, {0}},
        {{.name = "box_count",
          .unit = "1",
          .long_name = "boxes that hold a contact cell",
          .comment = "mean over random origins of the boxes",
          .coordinates = "box_side"},
         {0}},
        {{.name = "box_minimum",
          .unit = "1",
          .long_name = "least number of boxes that hold a contact cell",
          .comment = "least over random origins of the boxes",
          .coordinates = "box_side"},
         {0}},
        {{.name = "box_local_dimension",
          .unit = "1",
          .long_name = "box-counting dimension between this side and the next larger one",
          .coordinates = "box_side",
          .fill = true},
         {0}},
    };
    lac_status status = LAC_OK;
    LAC_TRY(put_box_fit(file, boxes, err));
    if (boxes->sizes == 0) {
        goto out;
    }
    for (size_t i = 0; i < boxes->sizes; i++) {
        table[0].value[i] = boxes->side[i];
        table[1].value[i] = boxes->count[i];
        table[2].value[i] = boxes->minimum[i];
        table[3].value[i] = i + 1 < boxes->sizes ? -boxes->slope[i] : (double)NAN;
    }
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        table[i].var.type = NC_DOUBLE;
    }
    LAC_TRY(put_columns(file, "box", boxes->sizes, table, sizeof table / sizeof table[0], err));
out:
    return status;
}

static lac_status put_clusters(const lac_nc *file, const lac_cluster_summary *clusters,
                               lac_error *err)
{
    const attribute reals[] = {
        {"largest_cluster_extent_m", clusters->largest_extent},
        {"widest_cluster_m", clusters->widest},
        {"mean_cluster_cells", clusters->mean},
        {"weighted_mean_cluster_cells", clusters->weighted},
    };
    column table[] = {
        {{.name = "cluster_size",
          .unit = "1",
          .long_name = "cells of a cluster, least of its octave",
          .comment = "an octave reaches from this size to one less than twice this size",
          .type = NC_DOUBLE},
         {0}},
        {{.name = "cluster_count",
          .unit = "1",
          .long_name = "clusters of contact cells in an octave of sizes",
          .comment = "cells that touch by a side or a corner are of one cluster",
          .coordinates = "cluster_size",
          .type = NC_DOUBLE},
         {0}},
        {{.name = "cluster_cells",
          .unit = "1",
          .long_name = "contact cells in the clusters of an octave of sizes",
          .coordinates = "cluster_size",
          .type = NC_DOUBLE},
         {0}},
    };
    for (size_t i = 0; i < clusters->octaves; i++) {
        table[0].value[i] = ldexp(1, (int)i);
        table[1].value[i] = (double)clusters->count[i];
        table[2].value[i] = (double)clusters->cells_of[i];
    }
    lac_status status = LAC_OK;
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "clusters", (long long)clusters->n, err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "largest_cluster_cells", (long long)clusters->largest,
                           err));
    LAC_TRY(put_reals(file, reals, sizeof reals / sizeof reals[0], err));
    LAC_TRY(put_columns(file, "cluster_octave", clusters->octaves, table,
                        sizeof table / sizeof table[0], err));
out:
    return status;
}

static lac_status put_scaling_fit(const lac_nc *file, const lac_scaling *s, lac_error *err)
{
    const attribute reals[] = {
        {"delta_s", s->dimension},
        {"delta_s_error", s->error},
        {"delta_s_regression_error", s->regression_error},
        {"delta_s_smooth", s->smooth},
        {"delta_s_from_slopes", s->from_slopes},
        {"load_N", s->load},
        {"load_spread", s->load_error},
        {"fractal_area", s->fractal_area},
        {"fractal_pressure", s->fractal_pressure},
    };
    char area[32];
    char pressure[32];
    (void)snprintf(area, sizeof area, "m^%.3f", s->dimension);
    (void)snprintf(pressure, sizeof pressure, "N m^-%.3f", s->dimension);
    lac_status status = LAC_OK;
    LAC_TRY(put_reals(file, reals, sizeof reals / sizeof reals[0], err));
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "fractal_area_unit", area, err));
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "fractal_pressure_unit", pressure, err));
    LAC_TRY(lac_nc_text(file, NC_GLOBAL, "coarsening",
                        s->coarsening == LAC_SAMPLE ? "point sampling" : "block means", err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "delta_s_few_cells", s->few_cells, err));
    LAC_TRY(lac_nc_integer(file, NC_GLOBAL, "delta_s_left_out", (long long)s->left_out, err));
out:
    return status;
}

static lac_status put_scaling(const lac_nc *file, const lac_scaling *s, lac_error *err)
{
    column table[] = {
        {{.name = "resolution", .unit = "m", .long_name = "side of a cell, coarsest first"}, {0}},
        {{.name = "resolution_area", .unit = "m2", .long_name = "real area of contact"}, {0}},
        {{.name = "resolution_pressure",
          .unit = "Pa",
          .long_name = "mean pressure over the real area of contact"},
         {0}},
        {{.name = "resolution_cells", .unit = "1", .long_name = "cells in contact"}, {0}},
        {{.name = "resolution_boundary",
          .unit = "m",
          .long_name = "length of the sides of cells that part contact from none"},
         {0}},
        {{.name = "resolution_slope",
          .unit = "1",
          .long_name = "rms slope of the heights between neighbouring cells"},
         {0}},
        {{.name = "resolution_local_dimension",
          .unit = "1",
          .long_name = "Delta_S between this resolution and the next finer one",
          .fill = true},
         {0}},
    };
    enum { COLUMNS = sizeof table / sizeof table[0] };
    for (size_t i = 0; i < s->n; i++) {
        const lac_resolution *at = &s->at[i];
        const double row[COLUMNS] = {at->cell,     at->area,  at->pressure, (double)at->cells,
                                     at->boundary, at->slope, at->local};
        for (size_t k = 0; k < COLUMNS; k++) {
            table[k].value[i] = row[k];
        }
    }
    for (size_t k = 0; k < COLUMNS; k++) {
        table[k].var.type = NC_DOUBLE;
    }
    lac_status status = LAC_OK;
    LAC_TRY(put_scaling_fit(file, s, err));
    LAC_TRY(put_columns(file, "resolution", s->n, table, COLUMNS, err));
out:
    return status;
}

static lac_status put_sizes(const lac_nc *file, const lac_size_strength *size, size_t n,
                            lac_error *err)
{
    column table[] = {
        {{.name = "specimen_size", .unit = "m", .long_name = "side of a specimen"}, {0}},
        {{.name = "specimen_strength",
          .unit = "1",
          .long_name = "strength of a specimen over that of this interface",
          .comment = "(b / b_0)^(delta_s - 2)"},
         {0}},
        {{.name = "specimen_strength_low",
          .unit = "1",
          .long_name = "lower of its values at delta_s a standard error away"},
         {0}},
        {{.name = "specimen_strength_high",
          .unit = "1",
          .long_name = "higher of its values at delta_s a standard error away"},
         {0}},
        {{.name = "specimen_pressure",
          .unit = "Pa",
          .long_name = "apparent mean pressure of a specimen at the same fractal pressure"},
         {0}},
    };
    enum { COLUMNS = sizeof table / sizeof table[0] };
    for (size_t i = 0; i < n; i++) {
        const double row[COLUMNS] = {size[i].size, size[i].relative, size[i].low, size[i].high,
                                     size[i].pressure};
        for (size_t k = 0; k < COLUMNS; k++) {
            table[k].value[i] = row[k];
        }
    }
    for (size_t k = 0; k < COLUMNS; k++) {
        table[k].var.type = NC_DOUBLE;
        table[k].var.coordinates = k > 0 ? "specimen_size" : NULL;
    }
    return put_columns(file, "specimen", n, table, COLUMNS, err);
}

lac_status lac_nc_fractal(const lac_nc *file, const lac_contact_view *contact, lac_error *err)
{
    lac_status status = LAC_OK;
    if (contact->sizes > MOST_ROWS) {
        return lac_fail(err, LAC_EINPUT, "%s: %zu specimens; at most %d are written", file->path,
                        contact->sizes, MOST_ROWS);
    }
    if (contact->boxes != NULL) {
        LAC_TRY(put_boxes(file, contact->boxes, err));
    }
    if (contact->blocks != NULL && isfinite(contact->blocks->dimension)) {
        LAC_TRY(lac_nc_real(file, NC_GLOBAL, "d_blocks", contact->blocks->dimension, err));
    }
    if (contact->clusters != NULL && contact->clusters->octaves > 0) {
        LAC_TRY(put_clusters(file, contact->clusters, err));
    }
    if (contact->scaling != NULL && contact->scaling->n > 0) {
        LAC_TRY(put_scaling(file, contact->scaling, err));
    }
    if (contact->sizes > 0) {
        LAC_TRY(put_sizes(file, contact->size, contact->sizes, err));
    }
out:
    return status;
}
